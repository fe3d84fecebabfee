//! `[foliage]` in documents.

use super::{Form, LeafKind, MOST_KINDS};
use crate::preset::Preset;

fn document(foliage: &str) -> String {
    format!("id = \"a\"\n[colonization]\ncrown = \"sphere\"\n[foliage]\n{foliage}")
}

const APPLE: &str = r##"
    leaf_form = "curved"
    leaf_arrangement = "spiral"
    leaves_per_m = 25
    leaf_grid = [4, 3]
    leaf_picture = "apple.png"
    season = 0.1
    [[foliage.also]]
    leaf_form = "mesh"
    leaf_mesh = "blossom.obj"
    share = 0.25
    leaf_colors = ["#ffe8ee"]
    [[foliage.also]]
    leaf_form = "tuft"
"##;

#[test]
fn kinds_survive_writing_and_reading() {
    let preset = Preset::from_toml(&document(APPLE)).unwrap();
    let foliage = &preset.dressing.foliage;
    assert_eq!((foliage.first.form, foliage.first.per_m, foliage.season), (Form::Curved, 25.0, 0.1));
    assert_eq!(foliage.first.grid, [4.0, 3.0]);
    assert_eq!((foliage.also[0].form, foliage.also[0].share), (Form::Mesh, 0.25));
    assert_eq!(foliage.also[1], LeafKind { form: Form::Tuft, ..LeafKind::default() });
    assert_eq!(preset.files(), ["apple.png", "blossom.obj"]);
    let text = preset.to_toml().unwrap();
    let again = Preset::from_toml(&text).unwrap_or_else(|fault| panic!("{fault}: {text}"));
    assert_eq!(again, preset);
    let json = serde_json::to_string(&preset).unwrap();
    assert_eq!(Preset::from_json(&json).unwrap(), preset);
}

#[test]
fn kinds_have_names() {
    let text = "name = \"leaf\"\nleaf_form = \"card\"\n[[foliage.also]]\nleaf_form = \"card\"\n\
                leaf_outline = \"blossom\"\n[[foliage.also]]\nname = \"bud\"\nleaf_form = \"card\"\n\
                [[foliage.also]]\nleaf_form = \"card\"\nleaf_outline = \"blossom\"";
    let preset = Preset::from_toml(&document(text)).unwrap();
    // Two have one outline: these go by their numbers.
    assert_eq!(preset.kind_labels(), ["also.1", "bud", "also.3"]);
    let again = Preset::from_toml(&preset.to_toml().unwrap()).unwrap();
    assert_eq!(again, preset);
    let json = serde_json::to_string(&preset).unwrap();
    assert_eq!(Preset::from_json(&json).unwrap(), preset);
}

#[test]
fn petals_are_lobes_of_a_blossom() {
    let preset = Preset::from_toml(&document("leaf_outline = \"blossom\"\npetals = 9")).unwrap();
    assert_eq!(preset.dressing.foliage.first.lobes, 9);
}

#[test]
fn files_are_renamed_together() {
    let mut preset = Preset::from_toml(&document(APPLE)).unwrap();
    let names = [("apple.png", "x.png"), ("blossom.obj", "y.obj"), ("other.obj", "z.obj")];
    preset.rename_files(&names.map(|(from, to)| (from.to_owned(), to.to_owned())).into());
    assert_eq!(preset.files(), ["x.png", "y.obj"]);
}

#[test]
fn what_is_wrong_with_a_kind_is_said_with_its_place() {
    for (foliage, place, said) in [
        ("[[foliage.also]]\nshare = 0.1", "6:1", "kind 1 has no 'leaf_form'; give it one of: card"),
        ("[[foliage.also]]\nleaf_form = \"car\"", "6:13", "'car' is not none | card"),
        (
            "[[foliage.also]]\nleaf_form = \"card\"\nleaf_lenght = 2",
            "7:1",
            "kind 1 has no 'leaf_lenght' (did you mean 'leaf_length'?)",
        ),
        ("also = 3", "5:8", "expected tables, each headed [[foliage.also]]"),
        ("leaf_mesh = \" \"", "5:13", "'leaf_mesh' is empty"),
        ("share = 0.5", "5:1", "there is no 'share'"),
        ("leaf_length = 0", "5:15", "0.0005 to 10"),
        ("name = \"Leaf\"", "5:8", "'Leaf' is no name of a kind: it takes lower-case letters"),
        (
            "name = \"a\"\n[[foliage.also]]\nname = \"a\"\nleaf_form = \"card\"",
            "5:1",
            "two kinds of foliage are called 'a'",
        ),
    ] {
        let message = Preset::from_toml(&document(foliage)).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{place}: ")) && message.contains(said), "{foliage}: {message}");
    }
    let many = "[[foliage.also]]\nleaf_form = \"card\"\n".repeat(MOST_KINDS);
    let message = Preset::from_toml(&document(&many)).unwrap_err().to_string();
    assert!(message.contains("8 kinds are more than the 7"), "{message}");
}
