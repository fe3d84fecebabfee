//! Chance that makes flat trees spatial, and shrubs.

use linden::lsystem::{Drawn, Grammar, LsystemError, Stems, TurtleSettings, Variation, grow};
use linden::{NO_PARENT, Quiet, Vec3};

use crate::{drawn_with, segments};

fn weed(change: impl FnOnce(&mut TurtleSettings)) -> Drawn {
    let grammar = Grammar::new("F", &["F -> F[+F]F[-F]F"]).unwrap();
    let mut settings = TurtleSettings { derivations: 3, segment_m: 1.0, ..TurtleSettings::default() };
    change(&mut settings);
    grow(&grammar, &settings, &Quiet).unwrap()
}

fn least_and_most(all: impl Iterator<Item = f32>) -> (f32, f32) {
    all.fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), x| (least.min(x), most.max(x)))
}

#[test]
fn without_variation_the_tree_is_flat_and_the_same_for_every_seed() {
    let plain = weed(|_| ());
    assert_eq!(weed(|s| s.seed = 5), plain);
    assert!(plain.branching.positions.iter().all(|p| p.z == 0.0));
}

#[test]
fn rolling_makes_a_flat_tree_spatial_and_keeps_its_lengths() {
    let plain = weed(|_| ());
    let rolled = weed(|s| s.variation.roll_deg = 180.0);
    assert_eq!(rolled.branching.parents, plain.branching.parents);
    assert_eq!(rolled.branching.births, plain.branching.births);
    let deepest = rolled.branching.positions.iter().map(|p| p.z.abs()).fold(0.0, f32::max);
    assert!(deepest > 3.0, "{deepest}");
    for (node, &parent) in rolled.branching.parents.iter().enumerate().filter(|(_, p)| **p != NO_PARENT) {
        let at = &rolled.branching.positions;
        assert!((at[node].distance(at[parent as usize]) - 1.0).abs() < 1e-5);
    }
    // The stem is in no bracket.
    assert_eq!(rolled.branching.positions[1], Vec3::Y);
}

#[test]
fn angles_and_lengths_vary_within_their_bounds_and_use_them() {
    let degrees = |seed| {
        let way = drawn_with("+F", |s| {
            (s.angle_deg, s.seed) = (30.0, seed);
            s.variation = Variation { angle_deg: 10.0, ..Variation::default() };
        });
        libm::atan2f(-way.branching.positions[1].x, way.branching.positions[1].y).to_degrees()
    };
    let (least, most) = least_and_most((0..200).map(degrees));
    assert!((19.99..21.0).contains(&least) && (39.0..40.01).contains(&most), "{least} {most}");
    let ends = drawn_with(&"F".repeat(300), |s| s.variation.length = 0.25).branching.positions;
    let all: Vec<f32> = ends.windows(2).map(|w| w[0].distance(w[1])).collect();
    let (least, most) = least_and_most(all.iter().copied());
    assert!((0.749..0.77).contains(&least) && (1.23..1.251).contains(&most), "{least} {most}");
    let mean = all.iter().sum::<f32>() / 300.0;
    assert!((mean - 1.0).abs() < 0.04, "{mean}");
}

#[test]
fn an_edit_in_one_branch_does_not_reshuffle_another() {
    let vary = |s: &mut TurtleSettings| {
        s.variation = Variation { angle_deg: 20.0, roll_deg: 90.0, length: 0.3 };
    };
    let before = drawn_with("F[+FF]F[-F&F]", vary).branching.positions;
    let after = drawn_with("F[+FF[+F]/F+F]F[-F&F]", vary).branching.positions;
    // The last three nodes are the second branch and the stem below it.
    assert_eq!(before[before.len() - 3..], after[after.len() - 3..]);
}

#[test]
fn outlines_keep_their_shape() {
    let vary = |s: &mut TurtleSettings| {
        s.angle_deg = 22.5;
        s.variation = Variation { angle_deg: 30.0, roll_deg: 180.0, length: 0.5 };
    };
    let leaf = drawn_with("F[+F{-f+f+f-|-f+f+f}]", vary).organs;
    let corners = leaf.corners_of(0);
    assert!(corners[0].distance(corners[6]) < 1e-5);
    assert!(corners.windows(2).all(|w| (w[0].distance(w[1]) - 1.0).abs() < 1e-5));
}

#[test]
fn a_shrub_is_the_plant_repeated_about_its_foot() {
    let one = weed(|_| ());
    let lean = 20.0_f32;
    let shrub = weed(|s| s.habit = Stems::Several { stems: 5, lean_deg: lean.into() });
    assert_eq!(shrub.symbols, 5 * one.symbols);
    let each = one.branching.positions.len();
    assert_eq!(segments(&shrub.branching), 5 * (each - 1));
    let azimuth = |stem: usize| {
        let way = shrub.branching.positions[stem * each + 1];
        libm::atan2f(way.x, way.z).to_degrees()
    };
    for stem in 0..5 {
        let nodes = &shrub.branching.positions[stem * each..(stem + 1) * each];
        assert_eq!(nodes[0], Vec3::ZERO);
        assert_eq!(shrub.branching.parents[stem * each], NO_PARENT);
        let leans = libm::acosf(nodes[1].y).to_degrees();
        assert!((leans - lean).abs() < 1e-2, "{leans}");
        if stem > 0 {
            // The same way round each time.
            let apart = (azimuth(stem) - azimuth(stem - 1)).rem_euclid(360.0);
            let first = (azimuth(1) - azimuth(0)).rem_euclid(360.0);
            assert!((apart - first).abs() < 0.01, "{apart}");
            assert!((apart.min(360.0 - apart) - 137.508).abs() < 0.01, "{apart}");
        }
    }
}

#[test]
fn each_stem_has_its_own_chance_and_the_first_is_the_trees() {
    let vary = |s: &mut TurtleSettings| s.variation.angle_deg = 15.0;
    let tree = weed(vary);
    let shrub = weed(|s| {
        vary(s);
        s.habit = Stems::Several { stems: 3, lean_deg: 0.0 };
    });
    let each = tree.branching.positions.len();
    assert_eq!(shrub.branching.positions[..each], tree.branching.positions);
    let reach = |stem: usize| {
        let nodes = &shrub.branching.positions[stem * each..(stem + 1) * each];
        nodes.iter().map(|p| p.length()).sum::<f32>()
    };
    let all = [0, 1, 2].map(reach);
    assert!((all[0] - all[1]).abs() > 0.1 && (all[1] - all[2]).abs() > 0.1, "{all:?}");
}

#[test]
fn stems_count_against_the_limit() {
    let grammar = Grammar::new("F", &["F -> FF"]).unwrap();
    let habit = Stems::Several { stems: 3, lean_deg: 0.0 };
    let settings = TurtleSettings { derivations: 3, symbol_limit: 20, habit, ..TurtleSettings::default() };
    let error = grow(&grammar, &settings, &Quiet).unwrap_err();
    assert_eq!(error, LsystemError::TooManyStems { stems: 3, symbols: 8, limit: 20 });
}
