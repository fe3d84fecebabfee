//! What habits are for: the forms that they give, and that growth ends whatever they ask.

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use linden::growth::{
    Attraction, Growth, GrowthError, GrowthHabit, GrowthRule, Meet, Obstacle, Stop, grow, grow_among,
};
use linden::random::Key;
use linden::{Branching, DVec3, NO_PARENT, Quiet, Vec3};

fn rule(habit: GrowthHabit) -> GrowthRule {
    GrowthRule {
        step: 0.1,
        influence: 1.2,
        kill: 0.25,
        tropism: Vec3::ZERO,
        max_iterations: 10_000,
        max_nodes: 100_000,
        habit,
    }
}

fn root(at: Vec3) -> Branching {
    Branching { positions: vec![at], parents: vec![NO_PARENT], births: vec![0], radii: None, edges: None }
}

/// Uniform in a cone with its base on the ground, four metres high.
fn cone(points: usize) -> Vec<Vec3> {
    let key = Key::new(8).named("cone");
    (0..)
        .map(|i| {
            let k = key.child(i);
            let across = |axis| k.child(axis).between(-1.5, 1.5) as f32;
            Vec3::new(across(0), k.child(1).between(0.4, 4.0) as f32, across(2))
        })
        .filter(|p| p.x.hypot(p.z) <= 1.5 * (4.0 - p.y) / 3.6)
        .take(points)
        .collect()
}

fn grown(points: &[Vec3], habit: GrowthHabit) -> Growth {
    grow(points, &root(Vec3::ZERO), &rule(habit), &Quiet).unwrap()
}

/// The chain of first children from the root.
fn leader(branching: &Branching) -> Vec<Vec3> {
    let mut at = 0;
    let mut chain = vec![branching.positions[0]];
    while let Some(next) = branching.parents.iter().position(|&parent| parent == at) {
        chain.push(branching.positions[next]);
        at = next as u32;
    }
    chain
}

/// The height of the tree when iteration `birth` is over.
fn height_of(branching: &Branching, birth: u32) -> f32 {
    let born = branching.births.iter().zip(&branching.positions).filter(|(b, _)| **b <= birth);
    born.map(|(_, p)| p.y).fold(0.0, f32::max)
}

#[test]
fn apical_control_lets_the_leader_go_ahead() {
    let points = cone(3_000);
    let laterals_below = |control: f32| {
        let habit = GrowthHabit { apical_control: control, ..GrowthHabit::PLAIN };
        let growth = grown(&points, habit);
        assert_eq!(growth.stop, Stop::AllReached);
        let tree = growth.branching;
        // The height of the tree when the first lateral leaves.
        let parents = &tree.parents;
        let lateral = (1..parents.len()).find(|&v| parents[..v].contains(&parents[v])).unwrap();
        (height_of(&tree, tree.births[lateral] - 1), leader(&tree).last().unwrap().y)
    };
    let (at_once, _) = laterals_below(0.0);
    let (late, _) = laterals_below(0.6);
    let (last, top) = laterals_below(1.0);
    assert!(at_once < late && late < last, "{at_once} {late} {last}");
    assert!((last - top).abs() < 0.11, "laterals left at {last} m, the leader ended at {top} m");
}

/// The first internode that grows from a stem of three nodes towards a point beside its middle, or
/// above its tip.
fn first_internode(point: Vec3, habit: GrowthHabit) -> Vec3 {
    let stem = Branching {
        positions: vec![Vec3::ZERO, Vec3::Y, 2.0 * Vec3::Y],
        parents: vec![NO_PARENT, 0, 1],
        births: vec![0; 3],
        radii: None,
        edges: None,
    };
    let growth = grow(&[point], &stem, &rule(habit), &Quiet).unwrap();
    (growth.branching.positions[3] - growth.branching.positions[growth.branching.parents[3] as usize]) / 0.1
}

#[test]
fn tropisms_by_order_turn_stems_and_branches_apart() {
    let (beside, above) = (Vec3::new(0.9, 1.0, 0.0), Vec3::new(0.9, 2.0, 0.0));
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-4, "{a} {b}");
    let down = || GrowthHabit { gravitropism: vec![0.0, -1.0], ..GrowthHabit::PLAIN };
    near(first_internode(beside, down()), Vec3::new(1.0, -1.0, 0.0).normalize());
    near(first_internode(above, down()), Vec3::X);
    let up = || GrowthHabit { gravitropism: vec![1.0, 0.0], ..GrowthHabit::PLAIN };
    near(first_internode(beside, up()), Vec3::X);
    near(first_internode(above, up()), Vec3::new(1.0, 1.0, 0.0).normalize());

    // One number holds for all orders; the light's distance does not matter.
    let light = || GrowthHabit { phototropism: vec![2.0], light: 5.0 * Vec3::Z, ..GrowthHabit::PLAIN };
    for point in [beside, above] {
        near(first_internode(point, light()), Vec3::new(1.0, 0.0, 2.0).normalize());
    }
}

#[test]
fn gravity_bends_what_is_far_from_the_root() {
    let points: Vec<Vec3> = (1..20).map(|i| Vec3::new(0.3 * i as f32, 0.0, 0.0)).collect();
    let lowest = |gravity| {
        let rule =
            GrowthRule { kill: 1.0, influence: 3.0, ..rule(GrowthHabit { gravity, ..GrowthHabit::PLAIN }) };
        let growth = grow(&points, &root(Vec3::ZERO), &rule, &Quiet).unwrap();
        growth.branching.positions.iter().map(|p| p.y).fold(0.0, f32::min)
    };
    assert!(lowest(0.0) > -1e-3);
    assert!(lowest(0.2) < lowest(0.1) && lowest(0.1) < -0.05);
}

#[test]
fn a_node_has_no_more_children_than_it_may() {
    for most in 1..4 {
        let growth = grown(&cone(1_000), GrowthHabit { max_children: most, ..GrowthHabit::PLAIN });
        let mut children = vec![0; growth.branching.parents.len()];
        for &parent in &growth.branching.parents[1..] {
            children[parent as usize] += 1;
        }
        assert_eq!(children.iter().max(), Some(&most));
    }
    let chain = grown(&cone(1_000), GrowthHabit { max_children: 1, ..GrowthHabit::PLAIN });
    assert_eq!(chain.stop, Stop::Blocked);
    assert!(chain.unreached > 0);
}

#[test]
fn all_points_in_reach_pull_and_growth_still_ends() {
    let all = || GrowthHabit { attraction: Attraction::All, ..GrowthHabit::PLAIN };
    let growth = grown(&cone(1_000), all());
    assert_eq!(growth.stop, Stop::AllReached);
    // The node is between three points, where the sum of all pulls vanishes.
    let triangle: Vec<Vec3> =
        [(1.0, 0.0), (-0.5, 0.866_025_4), (-0.5, -0.866_025_4)].map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec();
    for at in [Vec3::ZERO, Vec3::new(0.07, 0.0, 0.02), -0.3 * Vec3::Y] {
        let growth = grow(&triangle, &root(at), &rule(all()), &Quiet).unwrap();
        assert_eq!(growth.stop, Stop::AllReached);
        assert!(growth.branching.positions.len() < 200, "{}", growth.branching.positions.len());
    }
    for mirrored in [vec![Vec3::X, -Vec3::X], vec![Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z]] {
        let growth = grow(&mirrored, &root(Vec3::ZERO), &rule(all()), &Quiet).unwrap();
        assert_eq!(growth.stop, Stop::AllReached);
    }
}

#[test]
fn waves_are_reached_one_after_the_other() {
    // The lower half, then the upper.
    let mut points = cone(2_000);
    points.sort_by(|a, b| a.y.total_cmp(&b.y));
    let boundary = points[1_000].y;
    let highest_when = |wave_interval: u32, iteration: u32| {
        let habit = GrowthHabit { waves: 2, wave_interval, ..GrowthHabit::PLAIN };
        let growth = grown(&points, habit);
        assert_eq!(growth.stop, Stop::AllReached);
        height_of(&growth.branching, iteration)
    };
    assert!(highest_when(0, 15) < boundary + 0.1);
    assert!(highest_when(1, 30) > boundary + 0.5);

    // The second wave is used up where it appears, the third is out of reach.
    let points = [Vec3::Y, 0.5 * Vec3::Y, 50.0 * Vec3::Y];
    let growth = grown(&points, GrowthHabit { waves: 3, ..GrowthHabit::PLAIN });
    assert_eq!((growth.stop, growth.unreached), (Stop::NothingInReach, 1));
    // More waves than points; only the second point is in reach of the root.
    let points = [9.0 * Vec3::Y, Vec3::Y];
    let growth = grown(&points, GrowthHabit { waves: 1000, ..GrowthHabit::PLAIN });
    assert_eq!((growth.stop, growth.unreached), (Stop::NothingInReach, 1));
}

fn around(contains: &(dyn Fn(DVec3) -> bool + Sync), meet: Meet) -> Obstacle<'_> {
    Obstacle { contains, meet }
}

#[test]
fn branches_grow_round_a_ball_and_end_at_a_wall() {
    let ball = |place: DVec3| (place - DVec3::Y).length() < 0.45;
    let points: Vec<Vec3> = cone(3_000).into_iter().filter(|p| !ball(p.as_dvec3())).collect();
    let rule = rule(GrowthHabit::PLAIN);
    let inside = |growth: &Growth| growth.branching.positions.iter().filter(|p| ball(p.as_dvec3())).count();
    let free = grow(&points, &root(Vec3::ZERO), &rule, &Quiet).unwrap();
    assert!(inside(&free) > 0, "the ball would be in the way");
    for meet in [Meet::Around, Meet::Stop] {
        let growth = grow_among(&points, &root(Vec3::ZERO), &rule, &[around(&ball, meet)], &Quiet).unwrap();
        assert_eq!(inside(&growth), 0);
        let reached = 1.0 - growth.unreached as f64 / points.len() as f64;
        assert!(reached > 0.95, "{meet:?}: {reached}");
    }

    let wall = |place: DVec3| (place.y - 1.5).abs() < 0.1;
    let growth = grow_among(&points, &root(Vec3::ZERO), &rule, &[around(&wall, Meet::Stop)], &Quiet).unwrap();
    assert_eq!(growth.stop, Stop::Blocked);
    assert!(growth.branching.positions.iter().all(|p| p.y <= 1.4));
}

#[test]
fn a_root_that_is_walled_in_ends_in_words() {
    let points = cone(500);
    let rule = rule(GrowthHabit::PLAIN);
    let buried = |place: DVec3| place.length() < 1.0;
    let shell = |place: DVec3| (0.4..0.8).contains(&place.length());
    for meet in [Meet::Around, Meet::Stop] {
        let error = grow_among(&points, &root(Vec3::ZERO), &rule, &[around(&buried, meet)], &Quiet);
        let said = error.unwrap_err().to_string();
        assert!(said.contains("node 0 of the start is inside an obstacle"), "{said}");

        let growth = grow_among(&points, &root(Vec3::ZERO), &rule, &[around(&shell, meet)], &Quiet).unwrap();
        assert_eq!(growth.stop, Stop::Blocked, "{meet:?}");
        assert!(growth.branching.positions.iter().all(|p| p.length() < 0.4));
        assert!(growth.branching.positions.len() < 500, "{}", growth.branching.positions.len());
    }
}

#[test]
fn barren_nodes_are_tips_and_as_many_as_measured() {
    let growth = grown(&cone(5_000), GrowthHabit::PLAIN);
    let nodes = growth.branching.positions.len();
    for &parent in &growth.branching.parents[1..] {
        assert!(growth.captured.contains(parent as usize), "what bears was of use");
    }
    let barren = nodes - growth.captured.len();
    assert!(barren > 0 && barren < nodes / 4, "{barren} of {nodes}");
    // Nobody misses them: every point has a node of use within the kill distance.
    for point in cone(5_000) {
        let near = |v: &usize| growth.branching.positions[*v].distance(point) <= 0.2501;
        assert!(growth.captured.iter().any(|v| near(&v)));
    }
}

#[test]
fn habits_out_of_range_are_refused_by_name() {
    let wrong = [
        ("light", GrowthHabit { light: Vec3::ZERO, ..GrowthHabit::PLAIN }),
        ("gravity", GrowthHabit { gravity: f32::NAN, ..GrowthHabit::PLAIN }),
        ("gravitropism", GrowthHabit { gravitropism: vec![0.0, f32::INFINITY], ..GrowthHabit::PLAIN }),
        ("phototropism", GrowthHabit { phototropism: vec![f32::NAN], ..GrowthHabit::PLAIN }),
        ("apical_control", GrowthHabit { apical_control: 1.5, ..GrowthHabit::PLAIN }),
        ("max_children", GrowthHabit { max_children: 0, ..GrowthHabit::PLAIN }),
        ("waves", GrowthHabit { waves: 0, ..GrowthHabit::PLAIN }),
    ];
    for (name, habit) in wrong {
        let error = grow(&[Vec3::Y], &root(Vec3::ZERO), &rule(habit), &Quiet).unwrap_err();
        assert!(matches!(error, GrowthError::GrowthHabit { knob, .. } if knob == name), "{error}");
    }
}

#[test]
fn each_knob_of_habits_changes_the_tree() {
    let grown = |settings: &[(&str, &str)]| {
        let mut preset = linden::preset::builtin("simple").unwrap().load().unwrap();
        for (knob, value) in settings {
            preset.set(knob, value).unwrap();
        }
        let recipe = linden::recipe::Recipe::new(preset);
        linden::grow::grow(&recipe, &Quiet)
            .map(|tree| tree.skeleton.positions.clone())
            .map_err(|e| e.to_string())
    };
    let plain = grown(&[]).unwrap();
    let settings: [&[(&str, &str)]; 7] = [
        &[("attraction", "all")],
        &[("gravitropism", "0 -0.5")],
        &[("phototropism", "0.4"), ("light", "1,1,0")],
        &[("gravity", "0.2")],
        &[("apical_control", "0.8")],
        &[("max_children", "2")],
        &[("waves", "4"), ("wave_interval", "5")],
    ];
    for some in settings {
        assert_ne!(grown(some).unwrap(), plain, "{some:?}");
    }
    assert_eq!(grown(&[("gravitropism", "0 0"), ("waves", "1")]).unwrap(), plain);
    assert!(grown(&[("light", "0,0,0")]).unwrap_err().contains("light"));
}
