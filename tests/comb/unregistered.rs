//! A generator that the registry does not have grows, and says what is lost by it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use linden::preset::Preset;
use linden::recipe::Recipe;
use linden_comb::Comb;

#[test]
fn a_tree_of_it_says_that_its_recipe_is_not_read_again() {
    let preset = Preset::of("comb", Comb { depth: 2, teeth: 5, length_m: 2.0, ratio: 0.4 });
    let comb = linden::Tree::of(Recipe::new(preset)).grow().unwrap();
    assert!(comb.skeleton().segments() > 5);
    let said = comb.notes().join("\n");
    assert!(said.contains("'comb' is not registered") && said.contains("generators::register"), "{said}");
    assert!(Preset::from_json(&comb.recipe().to_line()).is_err(), "else the note is wrong");
}

#[test]
fn a_tree_that_is_refined_has_no_limit_of_nodes_unless_its_generator_says_one() {
    let preset = Preset::of("comb", Comb { depth: 2, teeth: 5, length_m: 2.0, ratio: 0.4 });
    let tree = linden::Tree::of(Recipe::new(preset)).set("refine", "subdivide").unwrap();
    let comb = tree.grow().unwrap();
    assert!(!comb.notes().iter().any(|note| note.contains("limit")), "{:?}", comb.notes());
}
