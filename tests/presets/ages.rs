//! Plants that are younger: smaller, thinner, in leaf, and the same in all else.

use linden::Quiet;
use linden::grow::grow;
use linden::preset::{Colonization, ScanSettings, builtins};
use linden_tests::presets::recipe;
use rayon::prelude::*;

/// At a quarter of its age no plant of light, of a grammar or of Weber and Penn is nearly as high as when it is grown, and
/// none is thicker.
#[test]
fn young_plants_are_low_and_slender() {
    builtins().par_iter().for_each(|builtin| {
        let whole = recipe(builtin);
        let preset = &whole.preset;
        if preset.settings::<Colonization>().is_some() || preset.settings::<ScanSettings>().is_some() {
            return;
        }
        let Some(steps) = preset.generator.steps() else { panic!("{} grows in no steps", builtin.id) };
        let at = |age: &str| {
            let mut preset = preset.clone();
            preset.set("age", age).unwrap_or_else(|error| panic!("{}: {error}", builtin.id));
            preset.dressing.foliage = linden::preset::FoliageSettings::default();
            let mut recipe = whole.clone();
            recipe.preset = preset;
            grow(&recipe, &Quiet).map(|grown| grown.skeleton)
        };
        let grown = at("1").unwrap();
        let is_plant = builtin.heading().unwrap().group == "Plants";
        let Ok(young) = at("0.25") else {
            assert!(!is_plant, "{} is not there yet", builtin.id);
            return;
        };
        let (young_m, grown_m) = (young.measures(), grown.measures());
        let thickest = |skeleton: &linden::Skeleton| skeleton.radii.iter().copied().fold(0.0, f32::max);
        assert!(thickest(&young) <= thickest(&grown) * 1.001, "{}: thicker", builtin.id);
        assert!(young.positions.len() <= grown.positions.len(), "{}: more wood", builtin.id);
        assert!(young_m.height_m <= grown_m.height_m * 1.05, "{}: higher", builtin.id);
        // Where there is growth enough to tell.
        if is_plant && steps.count >= 12 {
            let share = young_m.height_m / grown_m.height_m;
            assert!(share < 0.8, "{}: {share:.2} of its height at a quarter of its age", builtin.id);
        }
    });
}

/// Each age that a preset names can be grown, they rise in size, and young ones are in leaf.
#[test]
fn ages_that_have_names_rise() {
    let named: Vec<_> =
        builtins().iter().filter(|builtin| !recipe(builtin).preset.ages().is_empty()).collect();
    assert!(named.len() >= 20, "{}", named.len());
    named.par_iter().for_each(|builtin| {
        let whole = recipe(builtin);
        let mut before = 0.0;
        for age in whole.preset.ages() {
            let mut recipe = whole.clone();
            recipe.preset = whole.preset.at_age(age).unwrap();
            let grown = grow(&recipe, &Quiet).unwrap();
            let height_m = grown.skeleton.measures().height_m;
            assert!(height_m > before * 0.999, "{}: {} is {height_m:.2} m high", builtin.id, age.name);
            assert!(!grown.organs.is_empty(), "{}: {} is bare", builtin.id, age.name);
            before = height_m;
        }
        let last = whole.preset.ages().last().unwrap();
        assert_eq!(last.turns().count(), 0, "{}: the last is the plant as it is", builtin.id);
    });
}
