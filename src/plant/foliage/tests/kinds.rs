//! Kinds beside each other, their seasons, and leaves that generators place.

use super::*;

#[test]
fn seasons_hide_and_shrink_leaves_and_move_none() {
    let tree = bent(1);
    let at = |season: &str, more: &str| {
        let subject = recipe(&format!(
            "leaf_form = \"card\"\nleaves_per_m = 300\nleaf_jitter = 20\nseason = {season}\n{more}"
        ));
        grown(&subject, &tree)
    };
    let summer = at("0.35", "");
    let mut last = poses(&summer);
    for season in ["0.8", "0.9", "0.95", "1"] {
        let shown = poses(&at(season, ""));
        assert!(shown.is_subset(&last) && shown.len() < last.len(), "{season}");
        last = shown;
    }
    assert!(last.is_empty(), "bare");
    assert!(poses(&at("0.75", "")) == poses(&summer));
    let flush = at("0", "");
    assert!(poses(&flush) == poses(&summer));
    assert!(flush.placed.sizes_m[0] < 0.5 * summer.placed.sizes_m[0]);
    assert!(at("1", "evergreen = true").placed.positions == summer.placed.positions);
    let half = poses(&at("0.35", "leaf_keep = 0.5"));
    let share = half.len() as f64 / summer.len() as f64;
    assert!(half.is_subset(&poses(&summer)) && (share - 0.5).abs() < 0.06, "{share}");
    assert!(poses(&at("0.35", "leaf_keep = 0.25")).is_subset(&half));
    // Nor do looks move any.
    for more in [
        "leaf_length = 0.3",
        "leaf_size_spread = 0.9",
        "leaf_colors = [\"#ff0000\"]",
        "leaf_outline = \"palmate\"",
    ] {
        assert!(poses(&at("0.35", more)) == poses(&summer), "{more}");
    }
}

#[test]
fn kinds_have_calendars_of_their_own() {
    let tree = bent(1);
    let at = |season: f64| {
        let subject = recipe(&format!(
            "leaf_form = \"card\"\nleaves_per_m = 60\nseason_range = [0.1, 1]\nseason = {season}\n\
             [[foliage.also]]\nleaf_form = \"card\"\nleaf_outline = \"blossom\"\nleaves_per_m = 40\n\
             season_range = [0, 0.15]\n\
             [[foliage.also]]\nleaf_form = \"card\"\nleaf_outline = \"fruit\"\nleaves_per_m = 20\n\
             season_range = [0.4, 0.9]"
        ));
        let organs = grown(&subject, &tree);
        let mut counts = [0; 3];
        for &prototype in &organs.placed.prototypes {
            let shape = usize::from(prototype) - PROTOTYPES.len();
            counts[usize::from(organs.shapes[shape].kind)] += 1;
        }
        (counts, organs)
    };
    let [blossom, both, summer, late, bare] = [0.05, 0.14, 0.3, 0.6, 1.0].map(|season| at(season).0);
    assert!(blossom[0] == 0 && blossom[1] > 0 && blossom[2] == 0, "{blossom:?}");
    assert!(both[0] > 0 && both[1] > 0 && both[1] < blossom[1], "{both:?}");
    assert!(summer[0] > both[0] && summer[1..] == [0, 0], "{summer:?}");
    assert!(late[0] == summer[0] && late[2] > 0, "{late:?}");
    assert_eq!(bare, [0; 3]);
    // What is there in two seasons is in the same place, and nothing is drawn for what is not there.
    assert!(poses(&at(0.35).1).is_subset(&poses(&at(0.6).1)));
    assert!(at(0.05).1.shapes.iter().all(|shape| shape.kind == 1));
}

#[test]
fn a_further_kind_takes_places_or_has_its_own() {
    let tree = twigs(200, 8);
    let first = "leaf_form = \"card\"\nleaf_arrangement = \"spiral\"";
    let alone = grown(&recipe(first), &tree);
    let kinds = |organs: &Organs, kind: u8| {
        (0..organs.len())
            .filter(|&i| organs.shape(i).unwrap().kind == kind)
            .map(|i| organs.placed.positions[i])
            .collect::<Vec<_>>()
    };
    let blossom = "[[foliage.also]]\nleaf_form = \"cross\"\nleaf_outline = \"blossom\"\nleaf_jitter = 0\n";
    let both = grown(&recipe(&format!("{first}\n{blossom}share = 0.25")), &tree);
    assert_eq!(both.len(), alone.len());
    assert!(both.placed.positions == alone.placed.positions);
    let share = kinds(&both, 1).len() as f64 / both.len() as f64;
    assert!((share - 0.25).abs() < 0.02, "{share}");
    let apart = grown(&recipe(&format!("{first}\n{blossom}leaves_per_m = 10\nleaf_terminal = false")), &tree);
    assert!(kinds(&apart, 0) == alone.placed.positions);
    assert!((kinds(&apart, 1).len() as f64 / 1600.0 - 1.0).abs() < 0.05);
    // Blossom without leaves: places of a kind that has no form.
    let bare = grown(&recipe(&format!("{blossom}share = 0.25")), &tree);
    assert!(bare.placed.positions == kinds(&both, 1));
}

#[test]
fn leaves_of_a_grammar_take_the_form_of_the_first_kind() {
    let text = "id = \"a\"\n[lsystem]\naxiom = \"F~LF~BF\"\nrules = []\n[foliage]\nleaf_size = 32\nleaves_per_m = 0\nleaf_terminal = false\n";
    let grow = |more: &str| {
        let preset = Preset::from_toml(&format!("{text}{more}")).unwrap();
        linden_pipeline::grow::grow(&Recipe::new(preset), &Quiet).unwrap()
    };
    let (plain, formed) = (grow(""), grow("leaf_form = \"cross\""));
    assert_eq!(plain.skeleton, formed.skeleton);
    assert_eq!(plain.organs, plain.given);
    assert_eq!(formed.given, plain.given);
    assert_eq!(formed.organs.shape(0).map(|shape| shape.kind), Some(0));
    assert!(formed.organs.shape(1).is_none(), "a berry stays one");
    assert_eq!(formed.organs.placed.positions, plain.organs.placed.positions);
}

#[test]
fn leaves_of_weber_and_penn_are_there_only_with_a_form() {
    let grow = |foliage: &str| {
        let text = format!(
            "id = \"a\"\n[weber-penn]\nlevels = 2\nleaves = 12\n[foliage]\nleaf_size = 32\nleaves_per_m = 0\n\
             leaf_terminal = false\n{foliage}"
        );
        let preset = Preset::from_toml(&text).unwrap();
        linden_pipeline::grow::grow(&Recipe::new(preset), &Quiet).unwrap()
    };
    let (bare, formed) = (grow("leaf_form = \"none\""), grow("leaf_form = \"card\""));
    assert_eq!(bare.given, formed.given);
    assert_eq!(bare.organs.len(), 0);
    assert!(formed.organs.len() > 10, "{}", formed.organs.len());
    assert_eq!(formed.organs.len(), formed.given.len());
    let other = grow(
        "[[foliage.also]]\nname = \"b\"\nleaf_form = \"card\"\nleaves_per_m = 20\nleaf_max_radius = 5\nleaf_terminal = false",
    );
    assert!(!other.organs.is_empty());
    let mut kinds = (0..other.organs.len()).map(|organ| other.organs.shape(organ).map(|shape| shape.kind));
    assert!(kinds.all(|kind| kind == Some(1)), "only the further kind");
}
