//! Kinds of foliage by their names: set, added, taken away, saved.

use super::{Form, KindError, LEAF_KNOBS, LeafKind, MOST_KINDS, Section, is_kind_knob};
use crate::preset::Preset;

const APPLE: &str = r#"id = "apple" # mine

[colonization]
crown = "sphere"

[foliage]
leaf_form = "curved"

[[foliage.also]] # in May
leaf_form = "card"
leaf_outline = "blossom"
leaf_keep = 0.5 # half of them

[[foliage.also]] # in October
name = "apples"
leaf_form = "cross"
leaf_outline = "fruit"

[[foliage.also]] # dry ones
leaf_form = "tuft"
leaf_length = 0.02
"#;

fn apple() -> Preset {
    Preset::from_toml(APPLE).unwrap()
}

#[test]
fn kinds_are_called_by_name_outline_or_number() {
    let mut preset = apple();
    // The last one's outline, ovate, is the first kind's too.
    assert_eq!(preset.kind_labels(), ["blossom", "apples", "also.3"]);
    preset.dressing.foliage.also[2].outline = preset.dressing.foliage.also[0].outline;
    assert_eq!(preset.kind_labels(), ["also.1", "apples", "also.3"]);
}

#[test]
fn a_name_a_label_and_a_number_turn_the_same_knob() {
    for name in ["also.1.leaf_keep", "blossom.leaf_keep"] {
        let mut preset = apple();
        preset.set(name, "0").unwrap();
        let keeps: Vec<f64> = preset.dressing.foliage.kinds().map(|kind| kind.keep).collect();
        assert_eq!(keeps, [1.0, 0.0, 1.0, 1.0], "{name}");
    }
    let mut preset = apple();
    preset.set("leaf_keep", "0.25").unwrap();
    assert_eq!((preset.dressing.foliage.first.keep, preset.dressing.foliage.also[0].keep), (0.25, 0.5));
}

#[test]
fn every_knob_of_every_kind_is_reached_by_its_address() {
    let preset = apple();
    let all = preset.kind_knobs();
    assert_eq!(all.len(), 3 * LEAF_KNOBS.len());
    for (row, value) in all {
        assert!(is_kind_knob(row.knob.name));
        assert_eq!(preset.find_knob(row.knob.name).map(|found| found.knob), Some(row.knob));
        let Section::Kind(kind) = row.section else { panic!("{}: {:?}", row.knob.name, row.section) };
        let read = preset.dressing.foliage.also[kind].knobs();
        let own = read.iter().find(|(knob, _)| knob.name == row.short_name()).unwrap();
        assert_eq!(own.1, value, "{}", row.knob.name);
        let mut same = preset.clone();
        same.set(row.knob.name, &value.to_string()).unwrap();
        assert_eq!(same, preset);
    }
}

#[test]
fn what_is_no_kind_and_no_knob_is_said_with_what_there_is() {
    let mut preset = apple();
    for (name, value, expected) in [
        (
            "blosom.leaf_keep",
            "0",
            "no kind of foliage 'blosom' (did you mean 'blossom'?); 'apple' has: blossom (also.1), apples (also.2), also.3",
        ),
        ("also.4.leaf_keep", "0", "no kind of foliage 'also.4'"),
        ("also.0.leaf_keep", "0", "no kind of foliage 'also.0'"),
        ("also.1.leaf_kep", "0", "a kind of foliage has no knob 'leaf_kep' (did you mean 'leaf_keep'?)"),
        ("also.1.leaf_keep", "2", "knob 'also.1.leaf_keep': 2 is outside the range: 0 to 1"),
        ("apples.leaf_form", "none", "'none' is not card | cross"),
    ] {
        let said = preset.set(name, value).unwrap_err().to_string();
        assert!(said.contains(expected), "{name}: {said}");
    }
    assert_eq!(preset, apple());
    let mut bare = Preset::from_toml("id = \"a\"\n[colonization]\ncrown = \"sphere\"").unwrap();
    let said = bare.set("blossom.leaf_keep", "0").unwrap_err().to_string();
    assert!(said.contains("'a' has one kind alone"), "{said}");
}

#[test]
fn names_are_kept_in_documents_and_no_two_are_the_same() {
    let preset = apple();
    for text in [preset.to_toml().unwrap(), preset.to_toml_changed().unwrap()] {
        assert_eq!(Preset::from_toml(&text).unwrap(), preset, "{text}");
    }
    assert_eq!(Preset::from_json(&serde_json::to_string(&preset).unwrap()).unwrap(), preset);
    let named = |name: &str| {
        Preset::from_toml(&APPLE.replacen(
            "leaf_form = \"tuft\"",
            &format!("leaf_form = \"tuft\"\nname = \"{name}\""),
            1,
        ))
    };
    assert_eq!(named("dry-1").unwrap().kind_labels()[2], "dry-1");
    for (name, said) in [
        ("apples", "two kinds of foliage are called 'apples'"),
        ("Apples", "lower-case letters"),
        ("also", "stands for all further kinds"),
        ("a.b", "lower-case letters"),
        ("", "lower-case letters"),
    ] {
        let message = named(name).unwrap_err().to_string();
        assert!(message.contains(said), "{name}: {message}");
    }
    let mut preset = apple();
    assert!(matches!(preset.name_kind(0, "apples"), Err(KindError::Name { .. })));
    preset.name_kind(0, "may").unwrap();
    preset.name_kind(1, "").unwrap();
    assert_eq!(preset.kind_labels(), ["may", "fruit", "also.3"]);
    assert_eq!(preset.name_kind(3, "x"), Err(KindError::Unknown(4)));
}

#[test]
fn kinds_are_added_up_to_the_most() {
    let mut preset = apple();
    let kind = LeafKind { form: Form::Card, ..LeafKind::default() };
    for number in 3..MOST_KINDS - 1 {
        assert_eq!(preset.add_kind(kind.clone()), Ok(number));
    }
    assert_eq!(preset.add_kind(kind), Err(KindError::TooMany));
    assert_eq!(Preset::from_toml(&preset.to_toml().unwrap()).unwrap(), preset);
}

#[test]
fn saving_leaves_what_was_written_of_the_kinds_that_stay() {
    let mut preset = apple();
    preset.add_kind(LeafKind { form: Form::Card, keep: 0.25, ..LeafKind::default() }).unwrap();
    preset.set("blossom.leaf_keep", "0.75").unwrap();
    let more = preset.edit_toml(APPLE).unwrap();
    let expected = APPLE.replace("leaf_keep = 0.5 #", "leaf_keep = 0.75 #")
        + "\n[[foliage.also]]\nleaf_form = \"card\"\nleaf_keep = 0.25\n";
    assert_eq!(more, expected);
    // One that is taken away goes with its comments; those behind it keep theirs.
    for gone in 0..3 {
        let mut preset = apple();
        preset.remove_kind(gone).unwrap();
        let less = preset.edit_toml(APPLE).unwrap();
        assert_eq!(Preset::from_toml(&less).unwrap(), preset);
        for (i, comment) in ["# in May", "# in October", "# dry ones"].iter().enumerate() {
            assert_eq!(less.contains(comment), i != gone, "{gone}: {less}");
        }
    }
}

#[test]
fn a_knob_of_a_kind_that_changes_nothing_is_said() {
    let mut preset = apple();
    let said = |preset: &Preset, knob| preset.idle(knob).unwrap_or_default().to_owned();
    assert_eq!(said(&preset, "blossom.leaf_keep"), "");
    assert_eq!(said(&preset, "blossom.twig_leaves"), "it is for leaf_form=twig");
    assert_eq!(said(&preset, "also.1.leaves_per_m"), "");
    preset.set("blossom.share", "0.5").unwrap();
    assert!(said(&preset, "also.1.leaves_per_m").contains("share=0"));
    // What counts beside other kinds has others beside it.
    assert!(said(&preset, "blossom.lod_weight").contains("there is one level"));
    preset.set("triangles", "5000").unwrap();
    assert_eq!(said(&preset, "blossom.lod_weight"), "");
}

#[test]
fn files_of_a_kind_are_given_by_its_name() {
    let mut preset = apple();
    assert!(Preset::is_file_key("apples.leaf_picture") && !Preset::is_file_key("apples.leaf_keep"));
    assert!(
        preset.put_file("apples.leaf_picture", "a.png") && !preset.put_file("pears.leaf_picture", "b.png")
    );
    assert_eq!(preset.kind_files(1), [("leaf_picture", "a.png")]);
    assert!(preset.check_kind_of("apples.leaf_picture").is_ok());
    assert!(preset.check_kind_of("pears.leaf_picture").is_err());
}
