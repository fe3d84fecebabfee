//! L-systems as a generator.

use linden_base::document::{Datum, Fault, Node, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value, nearest, set, values};
use linden_base::monitor::Monitor;
use linden_skeleton::generator::{
    Bears, Branched, Generator, GeneratorError, KeyContent, Passage, RadiiFrom, SampleSize, Sampler,
    Settings, Steps, TableKey, Task, Traits, Written,
};
use linden_skeleton::publication::{ABOP, Publication};
use linden_skeleton::{AxisRule, Width, Wood};

use crate::chance::chooses;
use crate::sample::Fewer;
use crate::{Drawn, Grammar, GrammarPart, LSystem, LsystemError, grow};

/// L-systems.
pub const GENERATOR: &dyn Generator = &LSystems;

struct LSystems;

impl Generator for LSystems {
    fn id(&self) -> &'static str {
        "lsystem"
    }

    fn name(&self) -> &'static str {
        "L-system"
    }

    fn help(&self) -> &'static str {
        "rules rewrite a string of symbols, which a turtle draws"
    }

    fn publications(&self) -> &'static [Publication] {
        &[ABOP]
    }

    fn knobs(&self) -> Vec<Knob> {
        LSystem::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn takes_declared_knobs(&self) -> bool {
        true
    }

    fn keys(&self) -> &'static [TableKey] {
        &[
            TableKey {
                name: "axiom",
                help: "the string that derivation begins with",
                content: KeyContent::Text,
            },
            TableKey {
                name: "rules",
                help: "what symbols are rewritten to, one text a rule",
                content: KeyContent::Texts,
            },
            TableKey {
                name: KNOBS_KEY,
                help: "constants of the rules that are knobs, a text each: NAME LEAST..MOST UNIT: HELP",
                content: KeyContent::Texts,
            },
        ]
    }

    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        let missing = |what: &str| {
            let keys = table.entries.iter().map(|entry| entry.key.as_str());
            let hint = nearest(what, keys).map(|key| format!(": rename '{key}'"));
            Fault::new(table.place, format!("[lsystem] has no '{what}'{}", hint.unwrap_or_default()))
        };
        let axiom = &table.find("axiom").ok_or_else(|| missing("axiom"))?.node;
        let rules = &table.find("rules").ok_or_else(|| missing("rules"))?.node;
        let (items, texts) = texts_of(rules, "rules", "a list of texts like [\"F -> F[+F]F\"]")?;
        let axiom_text = axiom.text("axiom")?.to_owned();
        let grammar = Grammar::new(&axiom_text, &texts).map_err(|error| {
            let node = match error.part {
                GrammarPart::Axiom => axiom,
                GrammarPart::Rule(index) => items.get(index).unwrap_or(rules),
            };
            Fault::new(table.inside(node, error.column), format!("{}: {}", error.part, error.problem))
        })?;
        let mut settings = LSystem::of(grammar);
        if let Some(entry) = table.find(KNOBS_KEY) {
            let expected =
                "a list of texts like [\"limb_angle 20..80 deg: angle of the limbs to the trunk\"]";
            let (items, texts) = texts_of(&entry.node, KNOBS_KEY, expected)?;
            settings.expose(&texts).map_err(|(number, error)| {
                let place = items.get(number).unwrap_or(&entry.node).place;
                Fault::new(place, format!("{KNOBS_KEY}, text {}: {error}", number + 1))
            })?;
        }
        Ok(Box::new(settings))
    }
}

/// Rules that never apply are named up to this many.
const MOST_NOTES: usize = 8;

/// The key that declares constants as knobs.
const KNOBS_KEY: &str = "knobs";

/// A list of texts, and the places of each.
fn texts_of<'a>(list: &'a Node, key: &str, expected: &str) -> Result<(&'a [Node], Vec<String>), Fault> {
    let Datum::List(items) = &list.datum else { return Err(list.mismatch(key, expected)) };
    let texts = items.iter().map(|item| item.text(key).map(str::to_owned)).collect::<Result<_, _>>()?;
    Ok((items, texts))
}

impl From<LsystemError> for GeneratorError {
    fn from(error: LsystemError) -> Self {
        match error {
            LsystemError::Cancelled(cancelled) => cancelled.into(),
            other => Self::failed_while("growing the L-system: ", other),
        }
    }
}

impl Settings for LSystem {
    fn generator(&self) -> &'static dyn Generator {
        GENERATOR
    }

    fn knobs(&self) -> Vec<(Knob, Value)> {
        let of_grammar = self.exposed_values().map(|(exposed, value)| (exposed.knob, Value::Real(value)));
        values(Self::FIELDS, self).into_iter().chain(of_grammar).collect()
    }

    fn is_written(&self, knob: &str) -> bool {
        self.exposed_values().any(|(exposed, value)| exposed.knob.name == knob && exposed.is_default(value))
    }

    fn set(&mut self, knob: &str, value: Value) -> bool {
        match value {
            Value::Real(number) if self.set_exposed(knob, number) => true,
            value => set(Self::FIELDS, self, knob, value),
        }
    }

    fn written(&self) -> Vec<(&'static str, Written)> {
        // The grammar shows its axiom, then its rules, a line each.
        let text = self.grammar_as_written().to_string();
        let mut lines = text.lines();
        let axiom = lines.next().unwrap_or_default().to_owned();
        let rules = lines.map(str::to_owned).collect();
        let mut written = vec![("axiom", Written::Text(axiom)), ("rules", Written::Texts(rules))];
        let knobs: Vec<String> = self.exposed_values().map(|(exposed, _)| exposed.to_string()).collect();
        if !knobs.is_empty() {
            written.push((KNOBS_KEY, Written::Texts(knobs)));
        }
        written
    }

    fn describe(&self, _: &Inputs) -> Vec<Passage> {
        let lines = self.grammar.to_string().lines().map(str::to_owned).collect();
        let mut passages = vec![Passage { heading: "grammar", lines }];
        let constants = self.grammar.constants();
        if !constants.is_empty() {
            let line = |(name, written, number): &(&str, String, f64)| {
                let value = number.to_string();
                if *written == value {
                    format!("{name} = {value}")
                } else {
                    format!("{name} = {written} = {value}")
                }
            };
            let lines = constants.iter().map(line).collect();
            passages.push(Passage { heading: "constants (--define NAME=VALUE)", lines });
        }
        passages
    }

    fn plain(&self) -> Box<dyn Settings> {
        Box::new(Self { exposed: self.exposed.clone(), ..Self::of(self.grammar_as_written()) })
    }

    fn idle(&self, knob: &str, wood: &Wood) -> Option<&'static str> {
        self.why_idle(knob, wood)
    }

    fn traits(&self, wood: &Wood) -> Traits {
        Traits {
            radii: if self.gives_radii(wood) { RadiiFrom::Generator } else { RadiiFrom::Rule },
            axes: AxisRule::Grammar,
            bears: if self.writes("{~", false) { Bears::Organs } else { Bears::Nothing },
            knows_use: false,
            tells_age: self.derivations_grown() == 0 || !self.rewrites_all_wood(),
        }
    }

    fn draws(&self) -> bool {
        [self.angle_jitter_deg, self.branch_roll_deg, self.length_jitter].iter().any(|&most| most > 0.0)
            || chooses(&self.grammar, self.derivations_grown())
    }

    fn steps(&self) -> Option<Steps> {
        Some(Steps { count: self.derivations_grown(), unit: "derivation" })
    }

    fn at_step(&self, derivations: u32) -> Option<Box<dyn Settings>> {
        let (derivations, age) = Steps::at(derivations, self.derivations);
        Some(Box::new(Self { derivations, age, ..self.clone() }))
    }

    fn whole(&self) -> Option<Box<dyn Settings>> {
        (self.derivations_grown() < self.derivations)
            .then(|| Box::new(Self { age: 1.0, ..self.clone() }) as _)
    }

    fn limit(&mut self, _: &Inputs, size: &SampleSize) -> Result<bool, String> {
        self.symbol_limit = self.symbol_limit.min(size.symbols);
        Ok(false)
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        if let Some(error) = self.unfit.values().next() {
            return Err(GeneratorError::failed(error.clone()));
        }
        let Drawn { mut branching, organs, symbols } = grow(&self.grammar, &self.turtle(task.seed), monitor)?;
        // Without a '!' the turtle's width is the same everywhere.
        if task.wood.width == Width::Grammar && branching.radii.is_none() {
            let radius_m = (0.5 * self.segment_width_m) as f32;
            branching.radii = Some(vec![radius_m; branching.positions.len()]);
        }
        let most_nodes = self.symbol_limit;
        let mut notes = self.grammar.unused();
        if notes.len() > MOST_NOTES {
            let more = notes.split_off(MOST_NOTES).len();
            notes.push(format!("{more} more rules never apply"));
        }
        Ok(Branched { branching, organs, most_nodes, symbols: Some(symbols), notes, ..Branched::default() })
    }

    fn sampler<'a>(
        &'a self,
        _: &Task<'a>,
        size: SampleSize,
        monitor: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(Fewer::new(self, size, monitor)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_that_is_nearly_right_is_named() {
        for (text, message) in [
            ("axiom = 'F'\nrule = ['F -> FF']", "[lsystem] has no 'rules': rename 'rule'"),
            ("axiom = 'F'", "[lsystem] has no 'rules'"),
        ] {
            let Datum::Table(entries) = Node::from_toml(text).unwrap().datum else { panic!("a table") };
            let table = Table { entries: &entries, place: None, text: None };
            assert_eq!(GENERATOR.read(&table).map(drop).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn rules_that_never_apply_are_noted() {
        let rules: Vec<String> = ('a'..='m').map(|symbol| format!("{symbol} -> F")).collect();
        let settings = LSystem::of(Grammar::new("F", &rules).unwrap());
        let task = Task { inputs: &Inputs::new(), seed: 1, wood: Wood::default() };
        let notes = settings.grow(&task, &linden_base::monitor::Quiet).unwrap().notes;
        assert_eq!(notes.len(), MOST_NOTES + 1);
        assert_eq!(notes[0], "rule 1 (a -> F) never applies: no a comes up");
        assert_eq!(notes[MOST_NOTES], "5 more rules never apply");
    }
}
