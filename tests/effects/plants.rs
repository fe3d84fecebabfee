//! Small plants of every generator, and such that knobs which hang on others have something to hang on.

use linden::Quiet;
use linden::preset::Preset;
use linden::recipe::{Input, Recipe};

/// A plant to turn knobs of.
pub struct Plant {
    pub name: &'static str,
    pub recipe: Recipe,
}

/// Pictures so small that they are drawn in no time.
const SMALL: &[(&str, &str)] = &[("bark_size", "16"), ("leaf_size", "32"), ("sides", "5")];

const LEAVES: &[(&str, &str)] = &[("leaf_form", "card"), ("leaves_per_m", "6"), ("leaf_length", "0.15")];

/// A grammar without widths, organs and polygons.
const PLAIN: &str = "id = \"plain\"\n[lsystem]\naxiom = \"F\"\nrules = [\"F -> F[+FF]F[-F]\"]\n\
                     derivations = 2\nangle = 25\nsegment_length = 0.3\n";

/// One with all of them.
const RICH: &str = "id = \"rich\"\n[lsystem]\naxiom = \"F[-A]F\"\n\
                    rules = [\"A -> !F[+(30)&B~L]['{+F-F|F}]A\", \"B -> !F~N\"]\n\
                    derivations = 4\nangle = 35\nsegment_length = 0.4\n";

const CROWN: &str = "id = \"crown\"\n[colonization]\ncrown = \"ellipsoid\"\npoints = 60\n";

const FILLED: &str =
    "id = \"filled\"\n[colonization]\nenvelope = \"hull.obj\"\npoints = 60\ninfluence = inf\n";

const SCANNED: &str = "id = \"scanned\"\n[colonization]\nscan = \"scan.xyz\"\n";

/// Three levels of stems with leaves, in an envelope.
const STEMS: &str = "id = \"stems\"\n[weber-penn]\nscale = 4\nbranches = [1, 6, 4]\ncurve_res = [4, 3, 2]\n\
                     curve = [0, -40, 20]\ncurve_v = [30, 40, 40]\nseg_splits = [0.5, 0.3, 0]\nsplit_angle = [20, 20, 20]\n\
                     leaves = 5\nprune_ratio = 0.5\nprune_width = 0.3\nattraction_up = 0.5\nshape = \"envelope\"\n";

/// Two levels without leaves.
const POLE: &str = "id = \"pole\"\n[weber-penn]\nlevels = 2\nscale = 3\ncurve_v = [60, 60]\nbase_splits = 1\nsplit_angle = [30]\n";

/// Nine years in the light; and of buds by priority, in whorls, that bend and grow up again from old buds.
const LIT: &str = "id = \"lit\"\n[self-organizing]\nyears = 9\nvigor = 1.7\nleader = [0.6]\nshed = 0.3\nshed_patience = 1\nmature_leader = 0.5\n\
                   mature_from = 3\nmature_to = 6\nbud_years = 0\nmax_nodes = 20000\n";

const WHORLS: &str = "id = \"whorls\"\n[self-organizing]\nyears = 8\nvigor = 2.4\nsharing = \"priority\"\nphyllotaxis = \"whorled\"\nwhorl = 3\n\
                      upward = [0.3, 0]\nreiteration = 2\nbranching_angle = 70\nsag = 3\nleaf_weight = 0.01\npriority_least = 0.8\npriority_share = 0.9\nmax_nodes = 20000\n";

const HULL: &str = "v 0 1 0\nv 3 1 0\nv 1.5 1 2.5\nv 1.5 4 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";

/// A stem with a branch, as a scanner sees them: points on two tubes, Z up.
fn scan() -> String {
    let mut text = String::new();
    let mut tube = |foot: [f64; 3], tip: [f64; 3], radius: f64, rings: u32| {
        for ring in 0..=rings {
            let t = f64::from(ring) / f64::from(rings);
            let at = |axis: usize| foot[axis] + t * (tip[axis] - foot[axis]);
            for side in 0..10 {
                let (sin, cos) = libm::sincos(f64::from(side) * 0.6283 + 0.3 * t);
                text += &format!("{:.4} {:.4} {:.4}\n", at(0) + radius * cos, at(1) + radius * sin, at(2));
            }
        }
    };
    tube([0.0, 0.0, 0.0], [0.1, 0.0, 3.0], 0.12, 60);
    tube([0.05, 0.0, 1.6], [1.0, 0.3, 2.6], 0.06, 30);
    // A bird.
    text += "1.4 -0.9 2.9\n1.41 -0.9 2.9\n";
    text
}

fn plant(name: &'static str, document: &str, settings: &[&[(&str, &str)]]) -> Plant {
    let mut recipe = Recipe::new(Preset::from_toml(document).unwrap());
    for (knob, value) in SMALL.iter().chain(settings.iter().copied().flatten()) {
        recipe.preset.set(knob, value).unwrap();
    }
    for file in recipe.preset.files().into_iter().map(str::to_owned).collect::<Vec<_>>() {
        let content = if file == "hull.obj" { HULL.to_owned() } else { scan() };
        recipe.inputs.insert(file.as_str(), Input::read(&file, content.as_bytes(), &Quiet).unwrap());
    }
    Plant { name, recipe }
}

/// All of them.
pub fn plants() -> Vec<Plant> {
    let all_steps: &[(&str, &str)] = &[("refine", "prune decimate relocate smooth subdivide")];
    let shaped: &[(&str, &str)] = &[
        ("flare", "1"),
        ("flare_ridges", "4"),
        ("flare_depth", "0.6"),
        ("surface_roots", "3"),
        ("stubs", "2"),
        ("moss", "0.5"),
        ("foot_height", "0.3"),
        ("epicormic", "1"),
        ("dead_twigs", "2"),
        ("ends", "cut"),
        ("junction", "blend"),
        ("waves", "3"),
        ("phototropism", "0.3"),
        ("clumps", "0.6"),
        ("unevenness", "0.5"),
        ("season", "0.7"),
    ];
    let windy: &[(&str, &str)] = &[("wind", "sway")];
    let levels: &[(&str, &str)] = &[("lods", "2"), ("billboard", "2"), ("billboard_size", "64")];
    vec![
        plant("plain grammar", PLAIN, &[LEAVES]),
        plant("bare grammar", PLAIN, &[]),
        plant(
            "grammar in widths",
            PLAIN,
            &[&[("width", "grammar"), ("habit", "shrub"), ("susceptibility", "0.2")], all_steps],
        ),
        plant("rich grammar", RICH, &[LEAVES]),
        plant("rich grammar by pipes", RICH, &[&[("width", "pipe"), ("leaf_form", "twig")]]),
        plant("crown", CROWN, &[LEAVES]),
        plant("bare", CROWN, &[]),
        plant("everything", CROWN, &[LEAVES, all_steps, shaped, windy, levels]),
        plant("windy", CROWN, &[LEAVES, &[("wind", "attributes")]]),
        plant("jointed", CROWN, &[LEAVES, &[("wind", "bones"), ("bones", "12")]]),
        plant(
            "orders",
            CROWN,
            &[&[
                ("width", "order"),
                ("leaf_form", "fan"),
                ("leaf_outline", "lobed"),
                ("leaf_arrangement", "whorled"),
            ]],
        ),
        plant(
            "tapers",
            CROWN,
            &[&[("width", "taper"), ("leaf_form", "curved"), ("leaf_grid", "2 3"), ("evergreen", "true")]],
        ),
        plant(
            "thick",
            CROWN,
            &[&[("base_radius", "0.1"), ("leaf_form", "tuft"), ("lod_triangles", "1200 300")]],
        ),
        plant(
            "stems on stems",
            STEMS,
            &[&[("leaf_form", "card"), ("trunk_lobes", "4"), ("season", "0.6"), ("leaf_max_radius", "1")]],
        ),
        plant("bare stems", POLE, &[&[("twig_taper", "0.3")]]),
        plant("in the light", LIT, &[LEAVES]),
        plant("whorls in the light", WHORLS, &[]),
        plant("filled", FILLED, &[LEAVES]),
        plant("scanned", SCANNED, &[LEAVES]),
        plant("points", SCANNED, &[&[("contract", "false")]]),
    ]
}
