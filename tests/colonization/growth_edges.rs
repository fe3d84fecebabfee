//! Growth at its edges: ties, exact distances, limits, refusals, cancelling.

use std::sync::atomic::{AtomicU64, Ordering};

use linden::growth::{GrowthError, GrowthHabit, GrowthRule, Stop, grow};
use linden::monitor::Phase;
use linden::{Branching, Cancelled, Monitor, NO_PARENT, Quiet, Vec3};

const RULE: GrowthRule = GrowthRule {
    step: 0.25,
    influence: 4.0,
    kill: 0.5,
    tropism: Vec3::ZERO,
    max_iterations: 1000,
    max_nodes: 1000,
    habit: GrowthHabit::PLAIN,
};

fn roots(places: &[Vec3]) -> Branching {
    Branching {
        positions: places.to_vec(),
        parents: vec![NO_PARENT; places.len()],
        births: vec![0; places.len()],
        radii: None,
        edges: None,
    }
}

#[test]
fn a_point_at_exactly_the_influence_distance_is_felt() {
    let start = roots(&[Vec3::ZERO]);
    let growth = grow(&[4.0 * Vec3::Y], &start, &RULE, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.iterations), (Stop::AllReached, 14));

    let beyond = grow(&[4.0_f32.next_up() * Vec3::Y], &start, &RULE, &Quiet);
    assert_eq!(beyond, Err(GrowthError::NothingInReach { nearest_m: 4.0_f32.next_up(), influence_m: 4.0 }));
}

#[test]
fn a_point_at_exactly_the_kill_distance_of_the_start_dies_before_it_is_felt() {
    let start = roots(&[Vec3::ZERO]);
    let growth = grow(&[0.5 * Vec3::Y, 0.25 * Vec3::X], &start, &RULE, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.iterations, growth.unreached), (Stop::AllReached, 0, 0));
    assert_eq!(growth.branching, start);

    let growth = grow(&[0.5_f32.next_up() * Vec3::Y], &start, &RULE, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.iterations), (Stop::AllReached, 1));
}

#[test]
fn of_equally_near_nodes_the_first_has_the_point() {
    let growth = grow(&[Vec3::Y], &roots(&[Vec3::X, -Vec3::X, Vec3::X]), &RULE, &Quiet).unwrap();
    assert!(growth.branching.parents[3..].iter().all(|&parent| parent == 0 || parent >= 3));
    assert_eq!(growth.branching.parents[3], 0);
}

#[test]
fn max_nodes_cuts_an_iteration_in_the_order_of_parents() {
    let start = roots(&[Vec3::ZERO, 10.0 * Vec3::X]);
    let points = [Vec3::Y, 10.0 * Vec3::X + Vec3::Y];
    let growth = grow(&points, &start, &GrowthRule { max_nodes: 3, ..RULE }, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.iterations, growth.unreached), (Stop::MaxNodes, 1, 2));
    assert_eq!(growth.branching.parents, [NO_PARENT, NO_PARENT, 0]);
    assert_eq!(growth.branching.births, [0, 0, 1]);
}

/// The second root's child has no room, and its point dies by the first's: still it was the limit
/// that kept a node from growing.
#[test]
fn max_nodes_ends_growth_even_if_nothing_in_reach_is_left() {
    let start = roots(&[Vec3::ZERO, 1.2 * Vec3::X]);
    let points = [Vec3::new(0.55, 0.0, 0.0), Vec3::new(0.65, 0.2, 0.0), 100.0 * Vec3::X];
    let growth = grow(&points, &start, &GrowthRule { max_nodes: 3, ..RULE }, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.iterations, growth.unreached), (Stop::MaxNodes, 1, 1));
}

#[test]
fn a_limit_is_named_only_if_it_kept_something_from_growing() {
    let start = roots(&[Vec3::ZERO]);
    let grown = |max_iterations, max_nodes| {
        grow(&[Vec3::Y], &start, &GrowthRule { max_iterations, max_nodes, ..RULE }, &Quiet).unwrap().stop
    };
    assert_eq!(grown(2, 3), Stop::AllReached);
    assert_eq!(grown(1, 3), Stop::MaxIterations);
    assert_eq!(grown(2, 2), Stop::MaxNodes);
    assert_eq!(grown(0, 3), Stop::MaxIterations);
    assert_eq!(grown(2, 0), Stop::MaxNodes);
}

/// The naive rule never ends here: it grows the same two children again and again.
#[test]
fn two_symmetric_points_are_both_reached() {
    let points = [Vec3::new(2.0, 1.0, 0.0), Vec3::new(-2.0, 1.0, 0.0)];
    let growth = grow(&points, &roots(&[Vec3::ZERO]), &RULE, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.unreached), (Stop::AllReached, 0));
    assert!(growth.branching.positions.len() < 40, "{}", growth.branching.positions.len());
}

/// The first child takes the upper points; what the lower ones pull afterwards is that child again.
#[test]
fn no_child_is_grown_twice() {
    let points = [-1.0, 1.0].map(|side| [Vec3::new(0.5 * side, 2.0, 0.0), Vec3::new(2.0 * side, 0.1, 0.0)]);
    let growth = grow(points.as_flattened(), &roots(&[Vec3::ZERO]), &RULE, &Quiet).unwrap();
    assert_eq!(growth.stop, Stop::AllReached);
    let places = &growth.branching.positions;
    for (i, place) in places.iter().enumerate() {
        assert!(!places[..i].contains(place), "node {i} is where another is: {place}");
    }
}

#[test]
fn pulls_that_cancel_do_not_stop_growth() {
    let opposite = [2.0 * Vec3::X, -2.0 * Vec3::X];
    let growth = grow(&opposite, &roots(&[Vec3::ZERO]), &RULE, &Quiet).unwrap();
    assert_eq!(growth.stop, Stop::AllReached);

    let against = GrowthRule { tropism: Vec3::NEG_Y, ..RULE };
    let growth = grow(&[2.0 * Vec3::Y], &roots(&[Vec3::ZERO]), &against, &Quiet).unwrap();
    assert_eq!(growth.stop, Stop::AllReached);
}

#[test]
fn a_step_that_rounding_loses_stalls() {
    let far = 1e6 * Vec3::X;
    let rule = GrowthRule { step: 1e-3, kill: 1e-3, ..RULE };
    let growth = grow(&[far + Vec3::X], &roots(&[far]), &rule, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.iterations, growth.unreached), (Stop::Stalled, 0, 1));
}

#[test]
fn points_out_of_reach_are_left_and_counted() {
    let growth = grow(&[Vec3::Y, 100.0 * Vec3::Y], &roots(&[Vec3::ZERO]), &RULE, &Quiet).unwrap();
    assert_eq!((growth.stop, growth.unreached), (Stop::NothingInReach, 1));
}

fn refused(points: &[Vec3], start: &Branching, rule: &GrowthRule) -> String {
    grow(points, start, rule, &Quiet)
        .map_or_else(|error| error.to_string(), |_| "nothing: it grew".to_owned())
}

#[test]
fn contradictory_rules_are_refused_by_their_numbers() {
    let start = roots(&[Vec3::ZERO]);
    let refused = |rule: GrowthRule| refused(&[Vec3::Y], &start, &rule);
    let said = refused(GrowthRule { kill: 0.2, ..RULE });
    assert!(said.contains("0.2 m") && said.contains("0.25 m"), "{said}");
    let said = refused(GrowthRule { influence: 0.5, ..RULE });
    assert!(said.contains("influence distance, 0.5 m") && said.contains("kill distance, 0.5 m"), "{said}");
    for bad in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        assert!(refused(GrowthRule { step: bad, ..RULE }).contains("step"));
        assert!(refused(GrowthRule { kill: bad, ..RULE }).contains("kill"));
        assert!(refused(GrowthRule { influence: bad, ..RULE }).contains("influence"));
    }
    assert!(refused(GrowthRule { step: f32::INFINITY, ..RULE }).contains("step"));
    assert!(refused(GrowthRule { tropism: Vec3::NAN, ..RULE }).contains("tropism"));
}

#[test]
fn unfit_points_and_starts_are_refused_by_their_index() {
    let start = roots(&[Vec3::ZERO]);
    for bad in [Vec3::new(0.0, f32::NAN, 0.0), Vec3::INFINITY, 2e9 * Vec3::X] {
        let said = refused(&[Vec3::Y, bad, Vec3::Y], &start, &RULE);
        assert!(said.contains("attraction point 1 "), "{said}");
        let said = refused(&[Vec3::Y], &roots(&[Vec3::ZERO, bad]), &RULE);
        assert!(said.contains("node 1 "), "{said}");
    }
    assert_eq!(grow(&[], &start, &RULE, &Quiet), Err(GrowthError::NoPoints));
    assert_eq!(grow(&[Vec3::Y], &Branching::default(), &RULE, &Quiet), Err(GrowthError::NoStart));

    let loops = Branching { parents: vec![0], ..start.clone() };
    assert!(refused(&[Vec3::Y], &loops, &RULE).contains("after its parent"));
    let short = Branching { births: vec![], ..start };
    assert!(refused(&[Vec3::Y], &short, &RULE).contains("lacks"));
}

#[test]
fn out_of_reach_says_how_far_the_nearest_living_point_is() {
    // The first point dies at once; of the others the second root is 7 m from the nearest.
    let points = [0.1 * Vec3::Y, 100.0 * Vec3::Y, Vec3::new(20.0, 7.0, 0.0)];
    let error = grow(&points, &roots(&[Vec3::ZERO, 20.0 * Vec3::X]), &RULE, &Quiet).unwrap_err();
    assert_eq!(error, GrowthError::NothingInReach { nearest_m: 7.0, influence_m: 4.0 });
    let said = error.to_string();
    assert!(said.contains("7 m") && said.contains("4 m"), "{said}");
}

#[test]
fn the_start_is_kept_as_it_is() {
    let start = Branching {
        positions: vec![Vec3::ZERO, 0.5 * Vec3::Y],
        parents: vec![NO_PARENT, 0],
        births: vec![7, 9],
        radii: None,
        edges: None,
    };
    let growth = grow(&[3.0 * Vec3::Y], &start, &RULE, &Quiet).unwrap();
    assert_eq!(growth.branching.positions[..2], start.positions);
    assert_eq!(growth.branching.parents[..2], start.parents);
    assert_eq!(growth.branching.births[..4], [7, 9, 1, 2]);
}

/// Cancels at the `n`-th question, and counts what it is asked and told.
struct Watch {
    patience: u64,
    asked: AtomicU64,
    done: AtomicU64,
}

impl Watch {
    fn new(patience: u64) -> Self {
        Self { patience, asked: AtomicU64::new(0), done: AtomicU64::new(0) }
    }
}

impl Monitor for Watch {
    fn is_cancelled(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.patience
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        assert_eq!((stage, total), (Phase::Grow, Some(200_000)));
        assert!(self.done.swap(done, Ordering::Relaxed) <= done);
    }
}

/// A spiral that fills a cube: 200 000 points without drawing any.
fn cube() -> Vec<Vec3> {
    (0..200_000_u32)
        .map(|i| {
            // The plastic number's powers: a low-discrepancy sequence (Roberts 2018, R3).
            let [a, b, c] =
                [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|step: f64| (f64::from(i) * step).fract());
            Vec3::new(a as f32, b as f32, c as f32)
        })
        .collect()
}

#[test]
fn cancelling_is_noticed_wherever_growth_is() {
    let points = cube();
    let rule = GrowthRule { step: 0.05, influence: f32::INFINITY, kill: 0.1, max_nodes: 1_000_000, ..RULE };
    let start = roots(&[Vec3::ZERO]);
    let patient = Watch::new(u64::MAX);
    grow(&points, &start, &rule, &patient).unwrap();
    assert_eq!(patient.done.load(Ordering::Relaxed), 200_000);
    let questions = patient.asked.load(Ordering::Relaxed);
    assert!(questions > 500, "{questions}");

    for patience in (0..10).map(|i| questions * i / 10) {
        let watch = Watch::new(patience);
        let cancelled = grow(&points, &start, &rule, &watch);
        assert_eq!(cancelled, Err(GrowthError::Cancelled(Cancelled)));
        // Whoever is under way on another thread may ask once more.
        assert!(watch.asked.load(Ordering::Relaxed) <= patience + 64);
    }
}

/// New nodes come in batches: a point may change hands in each.
#[test]
fn a_long_trunk_hands_points_on_from_batch_to_batch() {
    let nodes = 3000_u16;
    let start = Branching {
        positions: (0..nodes).map(|i| Vec3::Y * (f32::from(i) * 0.01)).collect(),
        parents: (0..u32::from(nodes)).map(|i| i.checked_sub(1).unwrap_or(NO_PARENT)).collect(),
        births: vec![0; nodes.into()],
        radii: None,
        edges: None,
    };
    let top = f32::from(nodes) * 0.01;
    let points: Vec<Vec3> = (0..40_u8).map(|i| Vec3::new(f32::from(i) * 0.02, top + 1.0, 0.0)).collect();
    let rule = GrowthRule {
        step: 0.05,
        influence: f32::INFINITY,
        kill: 0.1,
        tropism: Vec3::ZERO,
        max_iterations: 1000,
        max_nodes: 100_000,
        habit: GrowthHabit::PLAIN,
    };
    let growth = grow(&points, &start, &rule, &Quiet).unwrap();
    assert_eq!(growth.stop, Stop::AllReached);
    // What grows leaves from the top alone.
    let laterals = growth.branching.parents[nodes.into()..].iter().filter(|&&p| p < u32::from(nodes) - 1);
    assert_eq!(laterals.count(), 0);
}
