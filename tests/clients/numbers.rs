//! The numbers of a report, computed again by numpy and trimesh from exported files.

use std::fs;

use linden::Quiet;
use linden::dress::dress;
use linden::grow::grow;
use linden::preset::builtin;
use linden::report::Report;
use linden_tests::fixtures::export;
use linden_tests::presets::recipe;

use crate::outside::{exported, run};

/// Both generators; leaves as cards, twigs, curved blades, fans and tufts, of grammars, and none; wood with flare
/// and collars, in steps, with ends of all kinds.
const PLANTS: [(&str, &[(&str, &str)]); 12] = [
    ("abop-b", &[("width_steps", "cylinder")]),
    ("abop-honda-a", &[("width_steps", "cylinder"), ("ends", "cut")]),
    ("abop-aono-a", &[("width_smoothing", "0")]),
    // No number counts roots and stubs, which meshes have.
    (
        "oak",
        &[
            ("leaf_keep", "0.02"),
            ("flare", "0.8"),
            ("flare_height", "2.5"),
            ("flare_ridges", "5"),
            ("surface_roots", "0"),
            ("stubs", "0"),
            // It cuts the wood into parts, which are measured whole.
            ("moss", "0"),
        ],
    ),
    ("dressed-honda-a", &[]),
    ("dressed-simple", &[]),
    ("simple", &[]),
    ("fir", &[("points", "400"), ("leaf_form", "tuft"), ("leaf_outline", "spruce"), ("leaves_per_m", "5")]),
    ("cypress", &[("leaf_form", "twig"), ("leaves_per_m", "3")]),
    ("sphere", &[("leaf_form", "curved"), ("leaves_per_m", "10"), ("leaf_outline", "palmate")]),
    ("date-palm", &[]),
    ("male-fern", &[]),
];

#[test]
fn reports_are_what_the_files_hold() {
    let dir = exported("numbers");
    for (id, settings) in PLANTS {
        let folder = dir.join(id);
        fs::create_dir_all(&folder).unwrap();
        let mut recipe = recipe(builtin(id).unwrap());
        for &(knob, value) in [("bark_size", "16"), ("sides", "64")].iter().chain(settings) {
            recipe.preset.set(knob, value).unwrap();
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        export(&scene, "glb", &[], &folder.join("tree.glb")).unwrap();
        export(&scene, "qsm", &[], &folder.join("tree.csv")).unwrap();
        let report = Report::of(&recipe, &grown, &Quiet).unwrap();
        fs::write(folder.join("report.json"), serde_json::to_string(&report).unwrap()).unwrap();
        // It is read back as it was.
        let json = fs::read_to_string(folder.join("report.json")).unwrap();
        assert_eq!(serde_json::from_str::<Report>(&json).unwrap(), report, "{id}");
    }
    run("measured.py", &dir);
}
