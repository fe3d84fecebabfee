//! The plants are of the size that their sources give: grown ten times, each time from another seed.
//!
//! The ranges are those of the documents' own comments, in which the sources stand by letters; where a
//! source describes the largest trees or several sizes, the range is for one of this height.

use linden::Quiet;
use linden::foliage::{Organs, PROTOTYPES};
use linden::grow::grow;
use linden::preset::{Cluster, FoliageSettings, Form, LeafKind, builtins};
use linden_tests::presets::recipe;
use rayon::prelude::*;

/// What a plant measures, metres.
struct Facts {
    id: &'static str,
    height_m: [f64; 2],
    crown_width_m: [f64; 2],
    /// At 1.3 m; `None`: what has no trunk.
    trunk_diameter_m: Option<[f64; 2]>,
    /// Of the first kind, from the foot of the petiole to the tip; of conifers, of a shoot with its
    /// needles.
    leaf_length_m: [f64; 2],
}

const fn facts(
    id: &'static str,
    height_m: [f64; 2],
    crown_width_m: [f64; 2],
    trunk_diameter_m: Option<[f64; 2]>,
    leaf_length_m: [f64; 2],
) -> Facts {
    Facts { id, height_m, crown_width_m, trunk_diameter_m, leaf_length_m }
}

const PLANTS: [Facts; 32] = [
    facts("apple", [5.0, 6.5], [5.5, 7.0], Some([0.18, 0.45]), [0.045, 0.12]),
    facts("ash", [20.0, 35.0], [11.0, 15.0], Some([0.45, 0.7]), [0.2, 0.35]),
    facts("avenue-lime", [10.5, 14.5], [5.0, 7.5], Some([0.25, 0.42]), [0.05, 0.15]),
    facts("bamboo", [7.0, 11.0], [2.5, 8.0], None, [0.08, 0.2]),
    facts("beech", [22.0, 30.0], [15.0, 25.0], Some([0.6, 1.0]), [0.05, 0.1]),
    facts("blue-gum", [22.0, 28.0], [9.0, 14.0], Some([0.5, 0.9]), [0.1, 0.3]),
    facts("box", [0.9, 1.3], [0.9, 1.3], None, [0.015, 0.03]),
    facts("cedar-of-lebanon", [15.0, 25.0], [12.0, 21.0], Some([0.8, 1.5]), [0.1, 0.4]),
    facts("date-palm", [10.0, 16.0], [6.0, 10.0], Some([0.3, 0.5]), [0.2, 0.5]),
    facts("douglas-fir", [21.0, 30.0], [7.0, 11.0], Some([0.4, 0.8]), [0.05, 0.3]),
    facts("european-larch", [18.0, 30.0], [6.0, 10.0], Some([0.3, 0.6]), [0.1, 0.5]),
    facts("hazel", [3.0, 6.0], [3.0, 6.0], None, [0.06, 0.14]),
    facts("horse-chestnut", [15.0, 22.0], [13.0, 20.0], Some([0.6, 0.9]), [0.25, 0.48]),
    facts("italian-cypress", [12.2, 21.3], [1.5, 3.0], Some([0.2, 0.4]), [0.05, 0.3]),
    facts("kanzan-cherry", [5.5, 10.0], [6.5, 10.0], Some([0.2, 0.4]), [0.1, 0.2]),
    facts("linden", [18.0, 24.0], [11.0, 18.0], Some([0.4, 0.8]), [0.05, 0.12]),
    facts("lombardy-poplar", [18.0, 27.0], [3.0, 4.6], Some([0.5, 0.9]), [0.05, 0.15]),
    facts("london-plane", [20.0, 30.0], [12.0, 20.0], Some([0.7, 1.1]), [0.13, 0.3]),
    facts("magnolia", [4.5, 7.0], [4.5, 8.5], None, [0.07, 0.2]),
    facts("male-fern", [0.6, 1.2], [0.9, 1.6], None, [0.1, 0.26]),
    facts("norway-maple", [15.0, 21.0], [11.0, 16.5], Some([0.44, 0.63]), [0.1, 0.25]),
    facts("norway-spruce", [18.0, 24.0], [5.0, 8.0], Some([0.3, 0.5]), [0.05, 0.3]),
    facts("oak", [15.0, 20.0], [15.0, 20.0], Some([0.63, 0.83]), [0.05, 0.14]),
    facts("olive", [5.0, 8.0], [5.0, 8.0], Some([0.25, 0.6]), [0.04, 0.1]),
    facts("rowan", [8.0, 12.0], [3.5, 6.0], Some([0.15, 0.4]), [0.12, 0.25]),
    facts("scots-pine", [14.0, 20.0], [6.0, 10.0], Some([0.35, 0.6]), [0.1, 0.3]),
    facts("silver-birch", [15.0, 25.0], [6.5, 10.5], Some([0.22, 0.4]), [0.03, 0.09]),
    facts("sunflower", [2.0, 3.0], [0.15, 1.5], Some([0.02, 0.06]), [0.12, 0.6]),
    facts("umbrella-thorn", [5.0, 12.0], [8.0, 14.0], Some([0.25, 0.5]), [0.025, 0.07]),
    facts("weeping-birch", [15.0, 25.0], [6.0, 9.0], Some([0.22, 0.4]), [0.03, 0.09]),
    facts("weeping-willow", [9.0, 15.0], [9.0, 15.0], Some([0.5, 0.9]), [0.07, 0.15]),
    facts("wild-cherry", [12.0, 18.0], [6.0, 9.0], Some([0.25, 0.5]), [0.05, 0.18]),
];

/// How far tips may hang below the foot of a plant, metres: what touches the ground would lie on it.
const UNDERGROUND_M: f32 = 0.15;

/// Organs of a tree or a bush: fewer would be bare, more would be slow to render. A twig with its
/// leaves is one; of a cluster each flower is one, which are as small as needles.
const ORGANS: std::ops::RangeInclusive<usize> = 5_000..=160_000;

/// Seeds that are grown with their leaves: these differ less than the wood, and take longer.
const IN_LEAF: u64 = 2;

/// Organs, each member of a cluster for itself.
fn members(foliage: &FoliageSettings, organs: &Organs) -> usize {
    let kinds: Vec<&LeafKind> = foliage.kinds().collect();
    let each = |prototype: &u8| {
        let shape = usize::from(*prototype).checked_sub(PROTOTYPES.len());
        let kind =
            shape.and_then(|shape| organs.shapes.get(shape)).map(|shape| kinds[usize::from(shape.kind)]);
        kind.filter(|kind| kind.cluster != Cluster::None).map_or(1, |kind| kind.cluster_count as usize)
    };
    organs.polygons.ends.len() + organs.placed.prototypes.iter().map(each).sum::<usize>()
}

fn holds(id: &str, seed: u64, what: &str, measured: f64, [least, most]: [f64; 2]) {
    assert!(
        (least..=most).contains(&measured),
        "{id}, seed {seed}: {what} is {measured:.3} m, not {least} to {most}"
    );
}

#[test]
fn each_plant_is_of_the_size_that_its_sources_give() {
    PLANTS.par_iter().for_each(|plant| {
        let builtin = builtins().iter().find(|builtin| builtin.id == plant.id).unwrap();
        for seed in 1..=10 {
            let mut recipe = recipe(builtin);
            recipe.preset.set_seed(seed);
            if seed > IN_LEAF {
                recipe.preset.dressing.foliage = FoliageSettings::default();
            }
            let grown = grow(&recipe, &Quiet).unwrap();
            let skeleton = &grown.skeleton;
            let measures = skeleton.measures();
            let holds = |what, measured, range| holds(plant.id, seed, what, measured, range);
            holds("height", measures.height_m, plant.height_m);
            holds("crown width", measures.crown_width_m, plant.crown_width_m);
            if let Some(range) = plant.trunk_diameter_m {
                holds("trunk diameter", measures.trunk_diameter_m, range);
            }
            let lowest = skeleton.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
            assert!(lowest >= -UNDERGROUND_M, "{}, seed {seed}: {lowest} m below the ground", plant.id);
            let Some(leaves) = recipe.preset.dressing.foliage.kinds().find(|kind| kind.form != Form::None)
            else {
                assert!(seed > IN_LEAF, "{} has no leaves", plant.id);
                continue;
            };
            if leaves.per_m > 0.0 {
                holds("leaf length", leaves.length_m, plant.leaf_length_m);
                let organs = members(&recipe.preset.dressing.foliage, &grown.organs);
                assert!(ORGANS.contains(&organs), "{}, seed {seed}: {organs} organs", plant.id);
            } else {
                // Placed by the grammar, or one at each end: as large as they came out.
                let sizes = &grown.organs.placed.sizes_m;
                let largest = sizes.iter().copied().fold(0.0, f32::max);
                holds("largest leaf", largest.into(), plant.leaf_length_m);
            }
        }
    });
}

/// What is dressed is the tree of the older preset.
#[test]
fn dressed_presets_keep_the_wood_of_the_ones_before() {
    for (dressed, bare) in [
        ("dressed-aono-d", "abop-aono-d"),
        ("dressed-bush", "abop-bush"),
        ("dressed-cypress", "cypress"),
        ("dressed-fir", "fir"),
        ("dressed-honda-a", "abop-honda-a"),
        ("dressed-simple", "simple"),
    ] {
        let [dressed_wood, bare_wood] = [dressed, bare].map(|id| {
            let builtin = builtins().iter().find(|builtin| builtin.id == id).unwrap();
            grow(&recipe(builtin), &Quiet).unwrap().skeleton.hash()
        });
        assert_eq!(dressed_wood, bare_wood, "{dressed} is not {bare}");
    }
}
