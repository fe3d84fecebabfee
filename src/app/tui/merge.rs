//! What a user changed of a document, made to the document as others have changed it meanwhile.

use linden::preset::{LSystem, Preset};

use super::tree::grammar_of;

/// The document `theirs` with what makes `ours` of `base`; `None` where that does not go together, or knobs cannot
/// say it.
pub fn merged(base: &Preset, ours: &Preset, theirs: &Preset) -> Option<Preset> {
    // What leads from the document to what is on screen is known to lead there.
    (changed(base, base, ours)? == *ours).then(|| changed(theirs, base, ours))?
}

/// A preset with what differs between two others.
fn changed(preset: &Preset, base: &Preset, ours: &Preset) -> Option<Preset> {
    let mut preset = preset.clone();
    if grammar_of(base) != grammar_of(ours) {
        let (ours, lsystem) = (ours.settings::<LSystem>()?, preset.settings_mut::<LSystem>()?);
        lsystem.grammar = ours.grammar.clone();
        lsystem.unfit = ours.unfit.clone();
    }
    for (row, _) in ours.all_knobs() {
        if base.differs(&row, ours) {
            preset.set(row.knob.name, &ours.text_of(&row)?).ok()?;
        }
    }
    if base.edits != ours.edits {
        preset.edits.clone_from(&ours.edits);
    }
    Some(preset)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fir(turned: &[(&str, &str)]) -> Preset {
        let mut preset = linden::preset::builtin("fir").unwrap().load().unwrap();
        for (name, value) in turned {
            preset.set(name, value).unwrap();
        }
        preset
    }

    #[test]
    fn knobs_that_were_not_touched_are_those_of_the_file() {
        let (base, theirs) = (fir(&[]), fir(&[("points", "1080"), ("seed", "7")]));
        let ours = fir(&[("top_density", "0.35"), ("seed", "9")]);
        let wanted = fir(&[("points", "1080"), ("top_density", "0.35"), ("seed", "9")]);
        assert!(merged(&base, &ours, &theirs).is_some_and(|merged| merged == wanted));
        assert!(merged(&base, &base, &theirs).is_some_and(|merged| merged == theirs));
    }

    #[test]
    fn a_knob_that_the_file_has_no_more_is_said() {
        let other = linden::preset::builtin("abop-a").unwrap().load().unwrap();
        assert!(merged(&fir(&[]), &fir(&[("points", "900")]), &other).is_none());
    }
}
