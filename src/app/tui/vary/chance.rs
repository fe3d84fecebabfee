//! Whether anything in a tree is left to chance: if not, another seed gives the same tree.

use linden::preset::Preset;

/// Whether another seed may give another skeleton. (Bark is drawn by chance too, and looks alike with
/// every seed.)
pub fn has_chance(preset: &Preset) -> bool {
    preset.generator.draws() || preset.has_spreads()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use linden::Quiet;
    use linden::grow::grow;
    use linden::recipe::Recipe;

    use super::*;

    #[test]
    fn a_spread_leaves_a_tree_to_chance() {
        let mut weed = linden::preset::builtin("abop-a").unwrap().load().unwrap();
        assert!(!has_chance(&weed));
        weed.set("angle", "25 ± 3").unwrap();
        assert!(has_chance(&weed));
    }

    #[test]
    fn trees_without_chance_are_the_same_from_every_seed_and_others_are_not() {
        let mut counts = [0; 2];
        for builtin in linden::preset::builtins() {
            let preset = builtin.load().unwrap();
            if !preset.files().is_empty() {
                continue;
            }
            let grown = |seed| {
                let mut preset = preset.clone();
                preset.set_seed(seed);
                Arc::clone(&grow(&Recipe::new(preset), &Quiet).unwrap().skeleton)
            };
            let first = grown(1);
            let differs = (2..6).any(|seed| grown(seed).positions != first.positions);
            assert_eq!(has_chance(&preset), differs, "{}", builtin.id);
            counts[usize::from(differs)] += 1;
        }
        assert!(counts[0] > 3 && counts[1] > 3, "{counts:?}");
    }
}
