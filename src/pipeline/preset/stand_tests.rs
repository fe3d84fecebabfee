//! `[[self-organizing.tree]]` in documents.

use super::{Preset, SelfOrganizing};

fn document(trees: &str) -> String {
    format!("id = \"a\"\n[self-organizing]\nyears = 9\n{trees}")
}

#[test]
fn a_stand_survives_writing_and_reading() {
    let trees = "[[self-organizing.tree]]\nat = [3, 0, -1.5] # beside it\n[[self-organizing.tree]]\nat = \"-2,0,0.25\"\n";
    let text = document(trees);
    let preset = Preset::from_toml(&text).unwrap();
    let stand = |preset: &Preset| preset.settings::<SelfOrganizing>().unwrap().stand.clone();
    assert_eq!(stand(&preset), [[3.0, -1.5], [-2.0, 0.25]]);
    let written = preset.to_toml().unwrap();
    let again = Preset::from_toml(&written).unwrap_or_else(|fault| panic!("{fault}: {written}"));
    assert_eq!(again, preset);
    assert_eq!(Preset::from_json(&serde_json::to_string(&preset).unwrap()).unwrap(), preset);
    // Another knob leaves the trees as they were written; a tree of another age keeps its neighbours.
    let mut older = preset.clone();
    older.set("years", "12").unwrap();
    assert_eq!(older.edit_toml(&text).unwrap(), text.replace("years = 9", "years = 12"));
    let young = older.generator.at_step(4).unwrap();
    assert_eq!(young.downcast_ref::<SelfOrganizing>().unwrap().stand, stand(&preset));
}

#[test]
fn what_is_wrong_with_a_tree_of_a_stand_is_said_with_its_place() {
    for (trees, place, said) in [
        ("[[self-organizing.tree]]\n", "", "further tree 1 has no 'at': say where it stands"),
        (
            "[[self-organizing.tree]]\nat = [1, 2, 3]",
            "5:6",
            "at 1,2,3, but trees stand on the ground: y must be 0",
        ),
        ("[[self-organizing.tree]]\nat = [1, 2]", "5:6", "three numbers"),
        ("[[self-organizing.tree]]\nat = [1, 0, 2e9]", "5:6", "within ±1e9"),
        ("[[self-organizing.tree]]\nat = \"auto\"", "5:6", "'auto' is not"),
        ("[[self-organizing.tree]]\nta = [1, 0, 3]", "5:1", "no 'ta'; it may have: at"),
        ("tree = 3", "4:8", "expected tables, each headed [[self-organizing.tree]]"),
    ] {
        let message = Preset::from_toml(&document(trees)).unwrap_err().to_string();
        let is_there = place.is_empty() || message.starts_with(&format!("{place}: "));
        assert!(is_there && message.contains(said), "{trees}: {message}");
    }
    let many = "[[self-organizing.tree]]\nat = [1, 0, 3]\n".repeat(10_000);
    let message = Preset::from_toml(&document(&many)).unwrap_err().to_string();
    assert!(
        message.contains("10000 further trees are more than the 9999 that a stand may have"),
        "{message}"
    );
}
