//! What a cited tree has otherwise than the preset that it is called after: its age, knobs, constants, edits.

use std::collections::BTreeMap;

use linden::knob::printable;
use linden::preset::{Age, LSystem, Preset, builtin};
use serde::Serialize;

use crate::cli::GrowArgs;

/// What was changed; nothing of a preset as it is.
#[derive(Default, Serialize)]
pub struct Changes {
    /// As `--age` takes it: the name that the preset has for it, a share of its growth, or years.
    age: Option<String>,
    /// What else differs: knobs by their names, constants of a grammar as `define.NAME`.
    changed: BTreeMap<String, String>,
    /// Edits of the wood that were added, in short.
    edits: Vec<String>,
}

impl Changes {
    /// Compares a preset, as it grows, with the one of the program that has its id: also what comes from a file is called
    /// after that. What was grown from points or cylinders is compared with what these give with no knob turned. Of all else
    /// nothing is known of what the document was, but that flags turned it.
    pub(super) fn of(preset: &Preset, flags: Option<&GrowArgs>) -> anyhow::Result<Self> {
        let built_in = builtin(&preset.id).ok().and_then(|found| found.load().ok());
        let is_alike = |base: &Preset| base.grows_by().id() == preset.grows_by().id();
        if let Some(base) = built_in.filter(is_alike) {
            return Ok(Self::from_base(preset, &base));
        }
        let of_input =
            of_input(preset).into_iter().filter(is_alike).map(|base| Self::from_base(preset, &base));
        match (of_input.min_by_key(|changes| changes.changed.len()), flags) {
            (Some(changes), _) => Ok(changes),
            (None, Some(flags)) => Self::by_flags(preset, flags),
            (None, None) => Ok(Self::default()),
        }
    }

    fn from_base(preset: &Preset, base: &Preset) -> Self {
        let mut changed = differences(preset, base);
        let mut age = None;
        // As near as one of its ages comes, with fewer changes besides, it is of that age.
        for known in base.ages() {
            let Ok(aged) = base.at_age(known) else { continue };
            let besides = differences(preset, &aged);
            if besides.len() < changed.len() {
                (changed, age) = (besides, Some(named(known)));
            }
        }
        let age = age.or_else(|| changed.remove("age").or_else(|| Some(changed.remove("years")? + "y")));
        let before = base.edits.len();
        let is_added = preset.edits.get(..before) == Some(&base.edits[..]);
        let edits = if is_added { &preset.edits[before..] } else { &preset.edits[..] };
        Self { age, changed, edits: edits.iter().map(|edit| printable(&edit.to_string())).collect() }
    }

    /// What was asked for on the command line, of a document of the user's.
    fn by_flags(preset: &Preset, flags: &GrowArgs) -> anyhow::Result<Self> {
        let mut changed = BTreeMap::new();
        for (name, typed) in flags.pairs()? {
            let row = preset.find_knob(&name);
            if row.is_none_or(|row| row.knob.name != "seed") {
                let value = row.and_then(|row| preset.text_of(&row)).unwrap_or(typed);
                changed.insert(printable(&name), printable(&value));
            }
        }
        for (name, value) in crate::cli::defines(&flags.defines)? {
            changed.insert(format!("define.{}", printable(&name)), printable(&value));
        }
        let share = || {
            let row = preset.find_knob("age").filter(|row| preset.differs(row, &preset.plain()))?;
            preset.text_of(&row)
        };
        let age = flags.age.clone().or_else(|| changed.remove("age")).or_else(share);
        let edits = flags.edits.iter().map(|edit| printable(edit)).collect();
        Ok(Self { age: age.map(|age| printable(&age)), changed, edits })
    }

    /// A row for each.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let age = self.age.iter().map(|age| ("age", age.clone()));
        let changed = self.changed.iter().map(|(name, value)| ("changed", format!("{name}={value}")));
        age.chain(changed).chain(self.edits.iter().map(|edit| ("edited", edit.clone()))).collect()
    }
}

/// What a file of points or cylinders becomes by itself. Cylinders may or may not have had a radius for each end.
fn of_input(preset: &Preset) -> Vec<Preset> {
    let Preset { id, .. } = preset;
    let files = preset.files();
    let Some(file) = files.first() else { return Vec::new() };
    vec![
        Preset::of_points(id, file),
        Preset::of_cylinders(id, file, true),
        Preset::of_cylinders(id, file, false),
    ]
}

/// An age with what it turns: `young (age=0.3, bark=smooth)`.
fn named(age: &Age) -> String {
    let turns: Vec<String> = age.turns().map(|(knob, to)| format!("{knob}={to}")).collect();
    printable(&format!("{} ({})", age.name, turns.join(", ")))
}

/// Knobs and constants that are not as in the other preset. The seed is said by itself.
fn differences(preset: &Preset, base: &Preset) -> BTreeMap<String, String> {
    let knobs = preset.all_knobs().into_iter().map(|(row, _)| row);
    let differing = knobs.filter(|row| row.knob.name != "seed" && preset.differs(row, base));
    let mut all: BTreeMap<String, String> = differing
        .filter_map(|row| Some((printable(row.knob.name), printable(&preset.text_of(&row)?))))
        .collect();
    let constants = |preset: &Preset| {
        let settings = preset.settings::<LSystem>();
        let constants = settings.map_or_else(Vec::new, |settings| settings.grammar.constants());
        constants.into_iter().map(|(name, written, _)| (name.to_owned(), written)).collect::<Vec<_>>()
    };
    let before = constants(base);
    for constant in constants(preset) {
        // Those that are knobs are named as such.
        if !before.contains(&constant) && preset.find_knob(&constant.0).is_none() {
            all.insert(format!("define.{}", printable(&constant.0)), printable(&constant.1));
        }
    }
    all
}
