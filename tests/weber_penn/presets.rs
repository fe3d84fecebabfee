//! The appendix: numbers of stems that need no program, and those that others have counted.

use linden::Quiet;
use linden::preset::{WeberPenn, builtin};
use linden::random::Key;
use linden::weber_penn::{Drawn, forecast, grow};

fn settings(id: &str) -> WeberPenn {
    builtin(id).unwrap().load().unwrap().settings::<WeberPenn>().unwrap().clone()
}

fn grown(id: &str, seed: u64) -> Drawn {
    grow(&settings(id), Key::new(seed), &Quiet).unwrap()
}

fn near(found: f64, expected: f64, share: f64, what: &str) {
    assert!((found / expected - 1.0).abs() <= share, "{what}: {found} for {expected}");
}

/// `Σ ⌊N2 (0.2 + 0.8 ShapeRatio(1 − (i + ½) / N1))⌋` over the branches, worked out by hand from the table.
#[test]
fn level_two_is_as_the_closed_form_has_it() {
    // The oak's forty stand on forks of the trunk, not quite evenly along it.
    for (id, first, second, share) in [
        ("wp-quaking-aspen", 50, 1177.0, 0.015),
        ("wp-black-tupelo", 50, 975.0, 0.015),
        ("wp-black-oak", 40, 3661.0, 0.04),
    ] {
        for seed in 1..4 {
            let drawn = grown(id, seed);
            assert_eq!(drawn.stems[..2], [1, first], "{id}");
            near(drawn.stems[2] as f64, second, share, id);
        }
    }
}

/// Counted in ten trees of Arbaro 1.9.9 with the same parameters: leaves 21 988 to 22 100 of the aspen; stems of
/// level 3 of the tupelo 8273 to 8290, leaves 37 169 to 37 248; clones of the oak 912 to 917.
#[test]
fn numbers_are_those_that_others_count() {
    let aspen = grown("wp-quaking-aspen", 1);
    near(aspen.organs.len() as f64, 22_040.0, 0.02, "leaves of the aspen");
    let tupelo = grown("wp-black-tupelo", 1);
    near(tupelo.stems[3] as f64, 8280.0, 0.015, "level 3 of the tupelo");
    near(tupelo.organs.len() as f64, 37_200.0, 0.02, "leaves of the tupelo");
    let clones: u64 = (1..9).map(|seed| grown("wp-black-oak", seed).clones.iter().sum::<u64>()).sum();
    near(clones as f64 / 8.0, 914.0, 0.1, "clones of the oak");
}

/// The forecast is near what grows, where nothing is pruned.
#[test]
fn forecasts_are_near() {
    for id in ["wp-quaking-aspen", "wp-black-tupelo", "wp-black-oak"] {
        let expected = forecast(&settings(id));
        let drawn = grown(id, 2);
        near(drawn.branching.positions.len() as f64, expected.nodes(), 0.25, id);
        near(drawn.organs.len() as f64, expected.leaves(), 0.05, id);
        for (level, count) in drawn.stems.iter().enumerate() {
            near(*count as f64, expected.levels[level].stems, 0.03, id);
        }
    }
}

#[test]
fn the_willow_keeps_off_the_ground() {
    let willow = grown("wp-weeping-willow", 1);
    assert_eq!(willow.stems[0], 1);
    let low = willow.branching.positions.iter().filter(|p| p.y < -0.01).count();
    assert_eq!(low, 0, "of {}", willow.branching.positions.len());
    let wide =
        willow.branching.positions.iter().map(|p| f64::from(p.x).hypot(p.z.into())).fold(0.0, f64::max);
    assert!(wide < 0.45 * willow.scale_m, "{wide} of {}", willow.scale_m);
}
