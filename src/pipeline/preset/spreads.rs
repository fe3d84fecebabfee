//! Knobs that each tree draws for itself: a preset says `"4 ± 0.6"`, and each seed has its own value.
//!
//! The settings of a preset always hold the values of its seed, so that nothing that reads them knows of spreads.
//! Documents and recipes have the spread. A setting that was changed by another way than its knob, as by dragging a
//! crown, is no draw any more: its value counts, and the spread is gone.

use linden_base::knob::{Spread, Value};
use linden_base::random::Key;

use super::Preset;
use super::knobs::PresetKnob;

/// A knob, its distribution, and what the preset's seed drew.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct KnobSpread {
    /// The row's name: of a further kind of foliage, its address.
    pub name: &'static str,
    spread: Spread,
    drawn: Value,
}

impl Preset {
    /// The root of all random choices.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Gives it another seed, which draws the knobs anew that have a spread.
    ///
    /// ```
    /// let mut fir = linden_pipeline::preset::builtin("fir")?.load()?;
    /// fir.set("crown_height", "9 ± 1")?;
    /// let row = fir.find_knob("crown_height").ok_or("no such knob")?;
    /// let before = row.read(&fir);
    /// fir.set_seed(7);
    /// assert_ne!(row.read(&fir), before);
    /// assert_eq!(fir.text_of(&row).as_deref(), Some("9 ± 1"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_seed(&mut self, seed: u64) {
        self.keep_drawn();
        self.seed = seed;
        self.redraw();
    }

    /// The distribution that a knob's value is drawn from, where it has one.
    pub fn spread(&self, row: &PresetKnob) -> Option<&Spread> {
        if self.spreads.is_empty() {
            return None;
        }
        self.spread_of(row, &row.read(self)?)
    }

    /// Whether some knob has a spread, so that plants of several seeds differ by it.
    pub fn has_spreads(&self) -> bool {
        self.spreads.iter().any(|known| self.is_drawn(known))
    }

    /// What a document says of a knob: its spread, or its value. `None` where the preset has no such knob.
    pub fn text_of(&self, row: &PresetKnob) -> Option<String> {
        let value = row.read(self)?;
        Some(self.spread_of(row, &value).map_or_else(|| value.to_string(), Spread::to_string))
    }

    /// Whether a document of the other preset would say something else of a knob.
    pub fn differs(&self, row: &PresetKnob, other: &Self) -> bool {
        if self.spreads.is_empty() && other.spreads.is_empty() {
            row.read(self) != row.read(other)
        } else {
            self.text_of(row) != other.text_of(row)
        }
    }

    /// The spread of a row that has this value: none where the value was not drawn from it.
    pub(super) fn spread_of(&self, row: &PresetKnob, value: &Value) -> Option<&Spread> {
        let found = self.spreads.iter().find(|known| known.name == row.knob.name)?;
        (found.drawn == *value).then_some(&found.spread)
    }

    /// Gives a knob a spread, and draws from it.
    pub(super) fn put_spread(&mut self, row: &PresetKnob, spread: Spread) {
        self.drop_spread(row);
        let drawn = self.draw(row.knob.name, &spread);
        row.write(self, drawn.clone());
        self.spreads.push(KnobSpread { name: row.knob.name, spread, drawn });
        // In one order, whatever was turned first.
        self.spreads.sort_by_key(|row| row.name);
    }

    /// Of a knob that gets a value.
    pub(super) fn drop_spread(&mut self, row: &PresetKnob) {
        self.spreads.retain(|known| known.name != row.knob.name);
    }

    /// Draws all knobs that have a spread for the seed that it has.
    pub(super) fn redraw(&mut self) {
        let mut spreads = std::mem::take(&mut self.spreads);
        for known in &mut spreads {
            known.drawn = self.draw(known.name, &known.spread);
            if let Some(row) = self.find_knob(known.name) {
                row.write(self, known.drawn.clone());
            }
        }
        self.spreads = spreads;
    }

    /// Forgets spreads whose knobs have other values than were drawn.
    fn keep_drawn(&mut self) {
        let mut spreads = std::mem::take(&mut self.spreads);
        spreads.retain(|known| self.is_drawn(known));
        self.spreads = spreads;
    }

    /// Whether a knob has the value that was drawn for it.
    fn is_drawn(&self, known: &KnobSpread) -> bool {
        self.find_knob(known.name).and_then(|row| row.read(self)).is_some_and(|value| value == known.drawn)
    }

    fn draw(&self, name: &str, spread: &Spread) -> Value {
        spread.draw(Key::new(self.seed).named("spread").named(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::builtin;
    use crate::recipe::Recipe;

    fn fir() -> Preset {
        builtin("fir").unwrap().load().unwrap()
    }

    fn value(preset: &Preset, name: &str) -> String {
        preset.find_knob(name).unwrap().read(preset).unwrap().to_string()
    }

    #[test]
    fn each_seed_draws_its_own_and_the_same_again() {
        let mut tree = fir();
        tree.set("crown_height", "9 ± 1").unwrap();
        let of = |tree: &mut Preset, seed| {
            tree.set_seed(seed);
            value(tree, "crown_height")
        };
        let first = of(&mut tree, 1);
        assert_ne!(of(&mut tree, 2), first);
        assert_eq!(of(&mut tree, 1), first);
        tree.set("seed", "2").unwrap();
        assert_ne!(value(&tree, "crown_height"), first, "the knob 'seed' draws, too");
    }

    #[test]
    fn documents_have_the_spread_and_grow_the_same_tree() {
        let mut tree = fir();
        tree.set("crown_height", "9 ± 1").unwrap();
        tree.set("points", "400..500").unwrap();
        tree.set("seed", "77").unwrap();
        let toml = tree.to_toml().unwrap();
        assert!(
            toml.contains("crown_height = \"9 ± 1\"") && toml.contains("points = \"400..500\""),
            "{toml}"
        );
        assert_eq!(Preset::from_toml(&toml).unwrap(), tree);
        let line = Recipe::new(tree.clone()).to_line();
        assert_eq!(Preset::from_json(&line).unwrap(), tree);
        let short = tree.to_toml_changed().unwrap();
        assert_eq!(Preset::from_toml(&short).unwrap(), tree);
        assert!(short.contains("9 ± 1"), "{short}");
    }

    #[test]
    fn the_seed_may_stand_behind_the_spread() {
        let text = "[colonization]\ncrown = \"sphere\"\npoints = \"400..900\"\n";
        let seeded = |seed: &str| {
            Preset::from_toml(&format!("id = \"a\"\n{seed}{text}"))
                .map(|tree| value(&tree, "points"))
                .unwrap()
        };
        let json = |seed: &str| {
            let text = format!(
                "{{\"id\":\"a\",\"colonization\":{{\"crown\":\"sphere\",\"points\":\"400..900\"}}{seed}}}"
            );
            value(&Preset::from_json(&text).unwrap(), "points")
        };
        assert_eq!(seeded("seed = 9\n"), json(",\"seed\":9"));
        assert_ne!(seeded("seed = 9\n"), json(""));
    }

    #[test]
    fn a_value_takes_a_spread_away() {
        let mut tree = fir();
        tree.set("crown_height", "9 ± 1").unwrap();
        assert!(tree.has_spreads());
        tree.set("crown_height", "9.5").unwrap();
        assert!(!tree.has_spreads());
        tree.set_seed(5);
        assert_eq!(value(&tree, "crown_height"), "9.5");
    }

    #[test]
    fn what_was_changed_otherwise_stays() {
        let mut tree = fir();
        tree.set("width", "0.3 ± 0.05").unwrap_err();
        tree.set("flare", "0.3 ± 0.05").unwrap();
        tree.dressing.tubes.features.flare = 2.0;
        assert!(!tree.has_spreads());
        assert!(tree.to_toml().unwrap().contains("flare = 2.0"));
        tree.set_seed(99);
        assert_eq!(value(&tree, "flare"), "2");
    }

    #[test]
    fn further_kinds_of_foliage_have_spreads_too() {
        let mut apple = builtin("apple").unwrap().load().unwrap();
        let before = apple.clone();
        apple.set("blossom.leaf_length", "0.02..0.05").unwrap();
        let row = apple.find_knob("blossom.leaf_length").unwrap();
        assert_eq!(apple.text_of(&row).as_deref(), Some("0.02..0.05"));
        assert!(apple.differs(&row, &before) && !apple.differs(&row, &apple.clone()));
        let toml = apple.to_toml().unwrap();
        assert_eq!(Preset::from_toml(&toml).unwrap(), apple);
        apple.set_seed(apple.seed() + 1);
        assert_ne!(value(&apple, "blossom.leaf_length"), value(&before, "blossom.leaf_length"));
    }

    #[test]
    fn faults_name_the_knob_and_the_line() {
        let mut tree = fir();
        let said = tree.set("points", "9..2").unwrap_err().to_string();
        assert_eq!(
            said,
            "knob 'points' (in points): '9..2' is empty: the first number must be the smaller one"
        );
        assert_eq!(tree, fir(), "unchanged");
        let said = tree.set("seed", "1..5").unwrap_err().to_string();
        assert!(said.contains("seed") && said.contains("draws"), "{said}");
        let text = "id = \"a\"\n[colonization]\ncrown = \"sphere\"\npoints = \"9..2\"\n";
        let fault = Preset::from_toml(text).unwrap_err();
        assert_eq!(fault.place.map(|place| place.line), Some(4));
        assert!(fault.message.contains("'points'") && fault.message.contains("empty"), "{}", fault.message);
    }
}
