//! Ages that the tree's preset names: shown by turning their knobs.

use linden::preset::{Age, KnobError, Preset};

use crate::source::OF_AGE;
use crate::tui::model::Model;

/// The ages of the tree, by name, with what each turns.
pub fn ages(preset: &Preset) -> Vec<(String, String)> {
    let turns = |age: &Age| {
        let turns: Vec<String> = age.turns().map(|(knob, to)| format!("{knob}={to}")).collect();
        if turns.is_empty() { "as it was opened".to_owned() } else { turns.join(" ") }
    };
    preset.ages().iter().map(|age| (age.name.clone(), turns(age))).collect()
}

/// Turns the knobs of an age, as `--age` has it: by its name, in years, or as a share; those of other ages get the
/// values that they had when the tree was opened or saved. Whether there is such an age; why not is said.
pub fn show(model: &mut Model, typed: &str) -> bool {
    let Some(tree) = &mut model.tree else { return false };
    let shown = typed_age(tree.preset(), typed).and_then(|age| {
        let preset = at(tree.preset(), &tree.saved().preset, &age).map_err(|why| why.to_string())?;
        tree.replace(preset);
        Ok(age.name)
    });
    let is_shown = shown.is_ok();
    match shown {
        Ok(name) => model.say(format!("{name}; Undo takes it back")),
        Err(why) => model.say_warning(why),
    }
    is_shown
}

/// The age that is meant by what was typed.
///
/// # Errors
/// Why there is none, and which there are.
pub fn typed_age(preset: &Preset, typed: &str) -> Result<Age, String> {
    let ages = preset.ages_of(typed).map_err(|why| why.to_string())?;
    let [age] = <[Age; 1]>::try_from(ages).map_err(|_| "one age is shown at a time".to_owned())?;
    Ok(age)
}

fn at(now: &Preset, saved: &Preset, age: &Age) -> Result<Preset, KnobError> {
    let mut preset = now.clone();
    let named = now.ages().iter().flat_map(Age::turns).map(|(knob, _)| knob);
    // Ages that were typed turn these, whatever the plant names.
    for knob in named.chain(OF_AGE) {
        if let Some(text) = saved.find_knob(knob).and_then(|row| saved.text_of(&row)) {
            preset.set(knob, &text)?;
        }
    }
    for (knob, to) in age.turns() {
        preset.set(knob, &to)?;
    }
    Ok(preset)
}
