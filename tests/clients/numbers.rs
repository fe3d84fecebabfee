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

/// A preset, on how many sheets that cross a leaf of it is drawn, and knobs that are turned.
type Plant = (&'static str, u32, &'static [(&'static str, &'static str)]);

/// Both generators; leaves as cards, twigs, curved blades, fans and tufts, of grammars, and none; wood with flare
/// and collars, in steps, with ends of all kinds.
const PLANTS: [Plant; 12] = [
    ("abop-b", 1, &[("width_steps", "cylinder")]),
    ("abop-honda-a", 1, &[("width_steps", "cylinder"), ("ends", "cut")]),
    ("abop-aono-a", 1, &[("width_smoothing", "0")]),
    // No number counts roots and stubs, which meshes have.
    (
        "oak",
        2,
        &[
            ("leaf_keep", "0.02"),
            ("flare", "0.8"),
            ("flare_height", "2.5"),
            ("flare_ridges", "5"),
            ("surface_roots", "0"),
            ("stubs", "0"),
            // They cut the wood into parts, which are measured whole.
            ("moss", "0"),
            ("twig_radius", "0"),
        ],
    ),
    ("dressed-honda-a", 2, &[]),
    ("dressed-simple", 2, &[]),
    ("simple", 1, &[]),
    (
        "fir",
        3,
        &[("points", "400"), ("leaf_form", "tuft"), ("leaf_outline", "spruce"), ("leaves_per_m", "5")],
    ),
    ("cypress", 2, &[("leaf_form", "twig"), ("leaves_per_m", "3")]),
    ("sphere", 1, &[("leaf_form", "curved"), ("leaves_per_m", "10"), ("leaf_outline", "palmate")]),
    ("date-palm", 1, &[("twig_radius", "0")]),
    ("male-fern", 1, &[]),
];

#[test]
fn reports_are_what_the_files_hold() {
    let dir = exported("numbers");
    for (id, sheets, settings) in PLANTS {
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
        let mut told: serde_json::Value = serde_json::from_str(&json).unwrap();
        told["_sheets"] = sheets.into();
        // The sheets of a tuft that cross the first are turned by how it is drawn, and are no blades.
        told["_first_is_blade"] = settings.contains(&("leaf_form", "tuft")).into();
        fs::write(folder.join("report.json"), told.to_string()).unwrap();
    }
    run("measured.py", &dir);
}
