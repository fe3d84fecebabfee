//! Ages that the tree's preset names: shown by turning their knobs.

use linden::preset::{Age, KnobError, Preset};

use crate::tui::model::Model;

/// The ages of the tree, by name, with what each turns.
pub fn ages(preset: &Preset) -> Vec<(String, String)> {
    let turns = |age: &Age| {
        let turns: Vec<String> = age.turns().map(|(knob, to)| format!("{knob}={to}")).collect();
        if turns.is_empty() { "as it was opened".to_owned() } else { turns.join(" ") }
    };
    preset.ages().iter().map(|age| (age.name.clone(), turns(age))).collect()
}

/// Turns the knobs of an age; those of other ages get the values that they had when the tree was opened or saved.
pub fn show(model: &mut Model, name: &str) {
    let Some(tree) = &mut model.tree else { return };
    match at(tree.preset(), &tree.saved().preset, name) {
        Ok(preset) => {
            tree.replace(preset);
            model.say(format!("{name}; Undo takes it back"));
        }
        Err(why) => model.say_warning(why.to_string()),
    }
}

fn at(now: &Preset, saved: &Preset, name: &str) -> Result<Preset, KnobError> {
    let mut preset = now.clone();
    let ages = now.ages();
    for (knob, _) in ages.iter().flat_map(Age::turns) {
        if let Some(text) = saved.find_knob(knob).and_then(|row| saved.text_of(&row)) {
            preset.set(knob, &text)?;
        }
    }
    for (knob, to) in ages.iter().filter(|age| age.name == name).flat_map(Age::turns) {
        preset.set(knob, &to)?;
    }
    Ok(preset)
}
