//! Growth against the twin, and what must hold whatever the parameters are.

use linden::Quiet;
use linden::random::Key;
use linden::skeleton::{NO_PARENT, Skeleton, Wood};
use linden::weber_penn::{CrownShape, Drawn, WeberPenn, WeberPennError, grow};

use crate::twin::Twin;

/// The length of a branch by where it leaves.
type Ratio = fn(f64) -> f64;

/// Straight stems without chance.
fn still() -> WeberPenn {
    let mut settings = WeberPenn::default();
    settings.scale_m = 12.0;
    settings.base_size = 0.3;
    settings.levels = 4;
    settings.length = vec![0.9, 0.4, 0.5, 0.3];
    settings.branches = vec![1.0, 21.0, 9.0, 5.0];
    settings.curve_res = vec![4.0, 3.0, 2.0, 1.0];
    settings.down_angle_deg = vec![0.0, 55.0, 40.0, 35.0];
    settings
}

fn grown(settings: &WeberPenn, seed: u64) -> Drawn {
    grow(settings, Key::new(seed), &Quiet).unwrap()
}

fn skeleton(drawn: &Drawn) -> Skeleton {
    Skeleton::build(drawn.branching.clone(), &Wood::default()).unwrap()
}

/// Level, length, radius at the base, sorted. Without clones an axis' order is its level.
fn stems(skeleton: &Skeleton) -> Vec<(u32, f64, f64)> {
    let stem = |axis: &linden::skeleton::Axis| {
        let nodes = skeleton.nodes_of(axis);
        let parent = (axis.parent != NO_PARENT).then_some(axis.parent);
        let line: Vec<_> =
            parent.iter().chain(nodes).map(|&node| skeleton.positions[node as usize].as_dvec3()).collect();
        let length: f64 = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        (axis.order, length, f64::from(skeleton.radii[nodes[0] as usize]))
    };
    let mut stems: Vec<_> = skeleton.axes.iter().map(stem).collect();
    stems.sort_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap());
    stems
}

#[test]
fn stems_are_as_many_and_as_long_as_the_twins() {
    let shapes: [(CrownShape, Ratio); 3] = [
        (CrownShape::Conical, |r| 0.2 + 0.8 * r),
        (CrownShape::TendFlame, |r| if r <= 0.7 { 0.5 + 0.5 * r / 0.7 } else { 0.5 + 0.5 * (1.0 - r) / 0.3 }),
        (CrownShape::Hemispherical, |r| 0.2 + 0.8 * (std::f64::consts::FRAC_PI_2 * r).sin()),
    ];
    for (shape, ratio) in shapes {
        let mut settings = still();
        settings.shape = shape;
        let twin = Twin {
            scale: 12.0,
            base_size: 0.3,
            levels: 4,
            shape: ratio,
            length: [0.9, 0.4, 0.5, 0.3],
            branches: [1.0, 21.0, 9.0, 5.0],
            ratio: 0.05,
            ratio_power: 1.0,
        };
        let mut expected = twin.stems();
        expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let drawn = grown(&settings, 3);
        let found = stems(&skeleton(&drawn));
        for level in 0..4 {
            let count = expected.iter().filter(|stem| stem.0 == level).count() as u64;
            assert_eq!(drawn.stems[level], count, "{shape:?} level {level}");
        }
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.0 as usize, expected.0);
            assert!((found.1 / expected.1 - 1.0).abs() < 1e-4, "{shape:?}: {found:?} for {expected:?}");
        }
        // Radii: the first node stands where a stem comes out of its parent, less than a third of a segment up.
        let sum = |level: u32, all: &mut dyn Iterator<Item = (u32, f64)>| -> f64 {
            all.filter(|stem| stem.0 == level).map(|stem| stem.1).sum()
        };
        for level in 0..4 {
            let radii = sum(level, &mut found.iter().map(|stem| (stem.0, stem.2)));
            let twins = sum(level, &mut expected.iter().map(|stem| (stem.0 as u32, stem.2)));
            assert!(
                (0.7..=1.0001).contains(&(radii / twins)),
                "{shape:?} level {level}: {radii} for {twins}"
            );
        }
    }
}

/// Without any spread seeds differ in which way the first branch looks, and in nothing else.
#[test]
fn without_spread_all_seeds_are_alike_but_for_turns() {
    let lengths = |seed: u64| stems(&skeleton(&grown(&still(), seed)));
    let (one, two) = (lengths(1), lengths(2));
    assert_eq!(one.len(), two.len());
    assert!(one.iter().zip(&two).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 2e-4));
    assert_ne!(grown(&still(), 1).branching.positions, grown(&still(), 2).branching.positions);
}

#[test]
fn any_number_of_threads_grows_the_same_tree() {
    let mut settings = still();
    settings.seg_splits = vec![0.3, 0.4, 0.2, 0.0];
    settings.split_angle_deg = vec![20.0];
    settings.curve_spread_deg = vec![60.0, 90.0, -20.0];
    settings.leaves = 6.0;
    settings.prune_ratio = 0.7;
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| grown(&settings, 5))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.branching, three.branching);
    assert_eq!(one.organs, three.organs);
    assert!(one.clones.iter().sum::<u64>() > 20 && one.organs.len() > 1000);
}

/// What leaves draw moves no wood, and what deeper levels draw does not move the upper ones.
#[test]
fn leaves_and_deeper_levels_leave_wood_alone() {
    let mut settings = still();
    settings.curve_spread_deg = vec![40.0];
    let bare = grown(&settings, 9);
    settings.leaves = 7.0;
    assert_eq!(grown(&settings, 9).branching, bare.branching);
    settings.levels = 2;
    let shallow = grown(&settings, 9);
    let deep: Vec<_> =
        stems(&skeleton(&bare)).into_iter().filter(|stem| stem.0 < 2).map(|stem| stem.1).collect();
    let two: Vec<_> = stems(&skeleton(&shallow)).into_iter().map(|stem| stem.1).collect();
    assert!(deep.iter().zip(&two).all(|(a, b)| (a / b - 1.0).abs() < 0.01), "{deep:?} {two:?}");
}

#[test]
fn a_trunk_alone_has_neither_branches_nor_leaves() {
    let mut settings = still();
    settings.levels = 1;
    settings.leaves = 50.0;
    let drawn = grown(&settings, 1);
    assert_eq!((drawn.stems, drawn.organs.len()), (vec![1], 0));
}

/// Every end of a segment is in the envelope where it prunes wholly, and nothing is pruned without it.
#[test]
fn the_envelope_holds_all_branches() {
    let mut settings = still();
    settings.smooth = false;
    settings.curve_spread_deg = vec![0.0, 80.0, 80.0];
    settings.prune_ratio = 1.0;
    settings.envelope =
        linden::weber_penn::Envelope { width: 0.22, width_peak: 0.4, power_low: 0.3, power_high: 0.8 };
    let pruned = grown(&settings, 4);
    let radius = |ratio: f64| {
        let peak = 0.4;
        if !(0.0..=1.0).contains(&ratio) {
            0.0
        } else if ratio < 1.0 - peak {
            (ratio / (1.0 - peak)).powf(0.8)
        } else {
            ((1.0 - ratio) / peak).powf(0.3)
        }
    };
    let skeleton = skeleton(&pruned);
    let mut tips = 0;
    for axis in skeleton.axes.iter().filter(|axis| axis.order > 0) {
        let tip = skeleton.positions[*skeleton.nodes_of(axis).last().unwrap() as usize].as_dvec3();
        let inside = 0.22 * 12.0 * radius((12.0 - tip.y) / (12.0 * 0.7));
        assert!(tip.x.hypot(tip.z) <= inside + 1e-4, "{tip} beyond {inside}");
        tips += 1;
    }
    assert!(tips > 100);
    settings.prune_ratio = 0.0;
    let whole = grown(&settings, 4);
    assert!(whole.stems[2] > pruned.stems[2], "{:?} {:?}", whole.stems, pruned.stems);
}

/// Leaves hang from the last stems, on nodes that are there, and turn to the sky as far as they are to.
#[test]
fn leaves_turn_to_the_sky() {
    let mut settings = still();
    settings.leaves = 10.0;
    let mean_up = |bend: f64| {
        let mut bent = settings.clone();
        bent.leaf_bend = bend;
        let drawn = grown(&bent, 2);
        let nodes = drawn.branching.positions.len() as u32;
        assert!(drawn.organs.placed.growth.nodes.iter().all(|&node| node < nodes));
        let ups = &drawn.organs.placed.ups;
        ups.iter().map(|up| f64::from(up.y)).sum::<f64>() / ups.len() as f64
    };
    let (none, half, all) = (mean_up(0.0), mean_up(0.5), mean_up(1.0));
    assert!(none < half && half < all && all > 0.999, "{none} {half} {all}");
    settings.leaves = -7.0;
    let fans = grown(&settings, 2);
    // Seven at the tip of each stem, where shares say so.
    assert!(fans.organs.len() as u64 <= 7 * fans.stems[3] && fans.organs.len() as u64 >= 3 * fans.stems[3]);
}

#[test]
fn what_is_too_large_is_refused_before_it_grows() {
    let mut settings = still();
    settings.branches = vec![1.0, 5000.0, 5000.0, 5000.0];
    let refused = grow(&settings, Key::new(1), &Quiet).unwrap_err();
    assert!(matches!(refused, WeberPennError::TooManyNodes { .. }), "{refused}");
    assert!(refused.to_string().contains("max_nodes=20000000; lower branches"));
    let mut settings = still();
    settings.max_nodes = 900;
    let refused = grow(&settings, Key::new(1), &Quiet).unwrap_err();
    assert!(refused.to_string().contains("max_nodes=900"), "{refused}");
    // Forks of forks of forks.
    let mut splitting = WeberPenn::default();
    splitting.seg_splits = vec![8.0];
    splitting.curve_res = vec![200.0];
    assert!(grow(&splitting, Key::new(1), &Quiet).is_err());
}

#[test]
fn growth_can_be_cancelled() {
    struct Impatient;
    impl linden::Monitor for Impatient {
        fn is_cancelled(&self) -> bool {
            true
        }
        fn advance(&self, _: linden::monitor::Phase, _: u64, _: Option<u64>) {}
    }
    assert!(matches!(grow(&still(), Key::new(1), &Impatient), Err(WeberPennError::Cancelled(_))));
}
