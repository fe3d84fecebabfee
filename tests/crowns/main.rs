//! Crowns in parts, from document to tree.

#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

#[path = "../colonization/naive.rs"]
#[allow(dead_code, reason = "shared with the tests of growth")]
mod naive;

use linden::colonization::ColonizationError;
use linden::grow::{GrowError, Grown, grow};
use linden::growth::{GrowthHabit, GrowthRule, Meet, Obstacle};
use linden::preset::{Preset, builtin, builtin_file};
use linden::recipe::{Input, Recipe};
use linden::skeleton::Skeleton;
use linden::{Branching, DVec3, NO_PARENT, Quiet, Vec3};

/// A ball of radius 2 on a trunk of 1 m, with its growth said in full, and what `more` adds.
fn document(more: &str) -> String {
    format!(
        "id = \"test\"\n[colonization]\ncrown = \"sphere\"\ncrown_radius = 2\npoints = 400\nstep = 0.25\n\
         influence = 4\nkill = 0.5\ntrunk = 1\n{more}"
    )
}

fn recipe(text: &str) -> Recipe {
    let preset = Preset::from_toml(text).unwrap();
    let read = |file: &str| Input::read(file, builtin_file(file)?, &Quiet).ok();
    let inputs = preset.files().into_iter().filter_map(|file| Some((file, read(file)?))).collect();
    Recipe::with_files(preset, inputs)
}

fn grown(more: &str) -> Grown {
    grow(&recipe(&document(more)), &Quiet).unwrap()
}

fn refused(more: &str) -> GrowError {
    grow(&recipe(&document(more)), &Quiet).unwrap_err()
}

fn points(grown: &Grown) -> &[Vec3] {
    &grown.colonized.as_ref().unwrap().points
}

/// The nodes that growth began with, and what the definition grows from them.
fn as_defined(grown: &Grown, obstacles: &[Obstacle]) -> naive::Grown {
    let Skeleton { positions, parents, births, .. } = &*grown.skeleton;
    let old = births.iter().take_while(|&&birth| birth == 0).count();
    let start = Branching {
        positions: positions[..old].to_vec(),
        parents: parents[..old].to_vec(),
        births: births[..old].to_vec(),
        radii: None,
        edges: None,
    };
    let rule = GrowthRule {
        step: 0.25,
        influence: 4.0,
        kill: 0.5,
        tropism: Vec3::ZERO,
        max_iterations: 100_000,
        max_nodes: 1_000_000,
        habit: GrowthHabit::default(),
    };
    naive::grow(points(grown), &start, &rule, obstacles, naive::each_pair)
}

const TWO_MORE: &str = r#"
[[colonization.part]]
role = "tree"
crown = "sphere"
crown_radius = 1.5
root = [2.5, 0, 0]
trunk = 0.5
[[colonization.part]]
role = "tree"
crown = "cone"
crown_height = 3
crown_radius = 1.5
root = [0, 0.5, -9]
"#;

#[test]
fn a_grove_grows_as_the_definition_from_all_its_roots() {
    let grown = grown(TWO_MORE);
    let expected = as_defined(&grown, &[]);
    let skeleton = &grown.skeleton;
    assert_eq!(skeleton.positions, expected.branching.positions);
    assert_eq!(skeleton.parents, expected.branching.parents);
    assert!(skeleton.positions.len() > 200);

    // Three stems, each where it was put.
    let is_root = |i: &usize| skeleton.parents[*i] == NO_PARENT;
    let roots: Vec<usize> = (0..skeleton.parents.len()).filter(is_root).collect();
    let places: Vec<Vec3> = roots.iter().map(|&i| skeleton.positions[i]).collect();
    assert_eq!(places, [Vec3::ZERO, Vec3::new(2.5, 0.0, 0.0), Vec3::new(0.0, 0.5, -9.0)]);
    // The third stands apart: it, and no other tree, is in its crown.
    let mut root_of: Vec<usize> = Vec::new();
    for (i, &parent) in skeleton.parents.iter().enumerate() {
        root_of.push(if parent == NO_PARENT { i } else { root_of[parent as usize] });
    }
    for (i, place) in skeleton.positions.iter().enumerate() {
        assert_eq!(place.z < -6.0, root_of[i] == roots[2], "{place}");
    }
    for root in roots {
        assert!(root_of.iter().filter(|&&of_node| of_node == root).count() > 20, "each tree grows");
    }
}

#[test]
fn crowns_have_their_shares_of_points_by_volume() {
    let grown = grown(&format!("{TWO_MORE}\n").replace("root = [2.5, 0, 0]", "root = [20, 0, 0]"));
    let (all, third) = (points(&grown), std::f64::consts::PI / 3.0);
    let volumes = [third * 4.0 * 8.0, third * 4.0 * 3.375, third * 2.25 * 3.0];
    let total: f64 = volumes.iter().sum();
    let is_in: [fn(&Vec3) -> bool; 3] = [|p| p.x < 10.0 && p.z > -5.0, |p| p.x > 10.0, |p| p.z < -5.0];
    for (volume, is_in) in volumes.into_iter().zip(is_in) {
        let share = volume / total;
        let count = all.iter().filter(|p| is_in(p)).count() as f64;
        let deviation = (400.0 * share * (1.0 - share)).sqrt();
        assert!((count - 400.0 * share).abs() < 4.0 * deviation, "{count} for {}", 400.0 * share);
    }
}

/// A post of radius 0.4 beside the trunk, and the same by hand.
fn in_post(p: DVec3) -> bool {
    (0.0..=6.0).contains(&p.y) && (p.x - 0.8) * (p.x - 0.8) + p.z * p.z <= 0.16
}

#[test]
fn branches_turn_aside_from_an_obstacle_or_end_there() {
    for (word, meet) in [("around", Meet::Around), ("stop", Meet::Stop)] {
        let grown = grown(&format!(
            "[[colonization.part]]\nrole = \"obstacle\"\ncrown = \"cylinder\"\ncrown_height = 6\n\
             crown_radius = 0.4\nat = [0.8, 0, 0]\nmeet = \"{word}\""
        ));
        let skeleton = &grown.skeleton;
        let expected = as_defined(&grown, &[Obstacle { contains: &in_post, meet }]);
        assert_eq!(skeleton.positions, expected.branching.positions, "{word}");
        assert!(points(&grown).len() < 400 && !points(&grown).iter().any(|p| in_post(p.as_dvec3())));
        assert!(!skeleton.positions.iter().any(|p| in_post(p.as_dvec3())), "{word}");
    }
}

#[test]
fn shade_takes_its_share_of_the_points() {
    // All points of the ball lie in the shade; the ones that stay are those that were there before.
    let shade = |share: f64| {
        format!(
            "[[colonization.part]]\nrole = \"shade\"\ncrown = \"cylinder\"\ncrown_height = 9\n\
             crown_radius = 5\nshare = {share}"
        )
    };
    let all: Vec<Vec3> = points(&grown("")).to_vec();
    assert_eq!(points(&grown(&shade(0.0))), all);
    let some = grown(&shade(0.3));
    let left = points(&some).len() as f64;
    assert!((left - 280.0).abs() < 4.0 * (400.0_f64 * 0.3 * 0.7).sqrt(), "{left}");
    assert!(points(&some).iter().all(|p| all.contains(p)));
    // More points begin with the fewer.
    let more = recipe(&document(&shade(0.3)).replace("points = 400", "points = 600"));
    let more = grow(&more, &Quiet).unwrap();
    assert_eq!(points(&more)[..points(&some).len()], *points(&some));
    let error = refused(&shade(1.0));
    assert!(matches!(error.generator(), Some(ColonizationError::NoRoom { points: 400 })));
    let said = refused(&shade(1.0)).to_string();
    assert!(said.contains("all 400 attraction points lie in obstacles or shade"), "{said}");
}

#[test]
fn what_cannot_be_is_said_of_the_part() {
    let part = |role: &str, what: &str| format!("[[colonization.part]]\nrole = \"{role}\"\n{what}\n");
    let bite = part("subtract", "crown = \"sphere\"\ncrown_radius = 0.5\nat = [0, 3, 0]");
    let all = part("subtract", "crown = \"cylinder\"\ncrown_height = 8\ncrown_radius = 4");
    let said = refused(&(bite + &all)).to_string();
    assert_eq!(
        said,
        "shaping the crown, part 2 (subtract cylinder): next to nothing is left of the crown; move it or make it \
         smaller"
    );
    let flat = "crown = \"revolution\"\nprofile_points = [[0, 1], [0, 2]]";
    let said = refused(&part("add", flat)).to_string();
    assert!(said.starts_with("shaping the crown, part 1 (add revolution): "), "{said}");
    assert!(said.contains("flat or a thread"), "{said}");
    let said = refused(&part("obstacle", "mesh = \"no-such.obj\"")).to_string();
    assert_eq!(said, "'test' needs the file 'no-such.obj', which was not given");
}

#[test]
fn a_recipe_names_all_its_files_and_grows_the_same_tree_again() {
    let more = "[[colonization.part]]\nrole = \"obstacle\"\nmesh = \"standing-stone.obj\"\nscale = 0.5\n\
                at = [1, 0, 1]\n[[colonization.part]]\nrole = \"subtract\"\nmesh = \"heart.obj\"\nscale = 0.2\n\
                at = [-1.5, 2, 0]\n[[colonization.part]]\nrole = \"obstacle\"\nmesh = \"standing-stone.obj\"\n\
                scale = 0.3\nat = [-1, 0, -1]";
    let first = recipe(&document(more));
    assert_eq!(first.preset.files(), ["standing-stone.obj", "heart.obj"], "each once");
    let line = first.to_line();
    let json: serde_json::Value = serde_json::from_str(&line).unwrap();
    let names: Vec<&str> =
        json["inputs"].as_array().unwrap().iter().map(|input| input["file"].as_str().unwrap()).collect();
    assert_eq!(names, first.preset.files());
    assert!(json["inputs"][1]["xxh3"].as_str().is_some_and(|hash| hash.len() == 32));
    let preset = Preset::from_json(&line).unwrap();
    let again = first.with_preset(preset);
    let tree = grow(&first, &Quiet).unwrap();
    assert_eq!(tree.skeleton.hash(), grow(&again, &Quiet).unwrap().skeleton.hash());
}

#[test]
fn no_branch_of_the_tree_around_the_stone_is_in_the_stone() {
    use linden::colonization::crown::{Crown, envelope::Envelope, placed::PlacedCrown};
    use linden::input::read_obj;
    let grown = grow(&builtin("around-the-stone").unwrap().recipe(&Quiet).unwrap(), &Quiet).unwrap();
    let mesh = read_obj(builtin_file("standing-stone.obj").unwrap(), &Quiet).unwrap();
    let stone = Envelope::new(&mesh, &Quiet).unwrap();
    assert!(stone.report().closed && stone.report().warnings().is_empty());
    let stone = PlacedCrown::new(Box::new(stone), DVec3::new(1.5, 0.0, 0.5), 20.0, 1.0);
    assert!(!grown.skeleton.positions.iter().any(|p| stone.contains(p.as_dvec3())));
    // It is in the way: the box around it has branches on all sides.
    let (low, high) = (stone.bounds().min, stone.bounds().max);
    let around = |side: fn(Vec3, Vec3, Vec3) -> bool| {
        grown.skeleton.positions.iter().filter(|p| side(**p, low, high)).count()
    };
    for side in [
        |p: Vec3, low: Vec3, _: Vec3| p.x < low.x,
        |p: Vec3, _: Vec3, high: Vec3| p.x > high.x,
        |p: Vec3, low: Vec3, _: Vec3| p.z < low.z,
        |p: Vec3, _: Vec3, high: Vec3| p.z > high.z,
    ] {
        assert!(around(side) > 300);
    }
}

#[test]
fn points_gather_in_shell_and_top() {
    let mean = |more: &str, of: &dyn Fn(DVec3) -> f64| {
        let grown = grown(more);
        points(&grown).iter().map(|p| of(p.as_dvec3())).sum::<f64>() / points(&grown).len() as f64
    };
    let out = |p: DVec3| (p - DVec3::Y * 3.0).length() / 2.0;
    // In a ball the mean of r/R is 3/4; with a density of 1 - 0.95 (1 - (r/R)³) it is
    // (0.05/4 + 0.95/7) / (0.05/3 + 0.95/6).
    let expected = (0.05 / 4.0 + 0.95 / 7.0) / (0.05 / 3.0 + 0.95 / 6.0);
    assert!((mean("", &out) - 0.75).abs() < 0.04);
    let found = mean("shell_density = 1", &out);
    assert!((found - expected).abs() < 0.03, "{found} for {expected}");
    assert!(mean("top_density = 1", &|p| p.y) > mean("", &|p| p.y) + 0.4);
}
