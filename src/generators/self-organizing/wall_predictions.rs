//! What obstacles do to trees, by plain geometry that knows nothing of how they are asked.

use glam::{DVec3, Vec3};
use linden_base::input::{Input, Inputs};
use linden_base::monitor::Quiet;
use linden_base::random::Key;
use linden_crown::solid::Solid;
use linden_growth::Meet;
use linden_skeleton::{Branching, NO_PARENT, Skeleton, Wood};

use crate::{
    Barriers, Grown, LightModel, Obstacle, ObstacleSolid, Planted, SelfOrganizing, SelfOrganizingError, grow,
    grow_among,
};

const LIGHTS: [LightModel; 2] = [LightModel::Shadow, LightModel::Sky];

fn settings(light: LightModel, obstacles: Vec<Obstacle>) -> SelfOrganizing {
    let shade = if light == LightModel::Sky { 0.3 } else { 0.05 };
    SelfOrganizing { light, shade, obstacles, years: 20, sag: 0.5, ..SelfOrganizing::default() }
}

fn grown(settings: &SelfOrganizing, inputs: &Inputs, seed: u64) -> Grown {
    let barriers = Barriers::new(settings, inputs, &Quiet).unwrap();
    grow_among(settings, &[Planted::default()], &barriers, Key::new(seed), &Quiet).unwrap()
}

fn hash(grown: Grown) -> u128 {
    Skeleton::build(grown.branching, &Wood::default()).unwrap().hash()
}

/// A wall of boxes' edges that stands there.
fn wall(size: [f64; 3], at: [f64; 3]) -> Obstacle {
    Obstacle { at: Some(at), ..Obstacle::of(ObstacleSolid::Box(size)) }
}

/// A pyramid with a square base of edge 2, as OBJ, its base's middle at a place.
fn pyramid([x, y, z]: [f64; 3]) -> Inputs {
    let corners = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 2.0, 0.0]];
    let corner = |[dx, dy, dz]: [f64; 3]| format!("v {} {} {}\n", x + dx, y + dy, z + dz);
    let faces = "f 1 2 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n";
    let text = corners.map(corner).concat() + faces;
    let mut inputs = Inputs::new();
    inputs.insert("rock.obj", Input::read("rock.obj", text.as_bytes(), &Quiet).unwrap());
    inputs
}

/// The parts of internodes in places: each looked at in 64 of them.
fn places(branching: &Branching) -> impl Iterator<Item = DVec3> {
    let ends = branching.positions.iter().zip(&branching.parents).filter(|(_, parent)| **parent != NO_PARENT);
    ends.flat_map(|(to, &from)| {
        let (from, to) = (branching.positions[from as usize].as_dvec3(), to.as_dvec3());
        (0..=64).map(move |i| from.lerp(to, f64::from(i) / 64.0))
    })
}

#[test]
fn nothing_grows_into_a_mesh_whatever_a_shoot_does_there() {
    let foot = DVec3::new(1.4, 1.0, -0.3);
    let inputs = pyramid(foot.to_array());
    // By the definition of the pyramid, its faces given a hair.
    let is_inside = |p: DVec3| {
        let p = p - foot;
        let half = 1.0 - 0.5 * p.y - 1e-4;
        (1e-4..2.0).contains(&p.y) && p.x.abs() < half && p.z.abs() < half
    };
    for light in LIGHTS {
        let rock = Obstacle::of(ObstacleSolid::Solid(Solid::Mesh { file: "rock.obj".to_owned() }));
        let free = grown(&settings(light, Vec::new()), &inputs, 3).branching;
        let entering = free.positions.iter().filter(|p| is_inside(p.as_dvec3())).count();
        assert!(entering > 50, "{light:?}: {entering} nodes of a free tree");
        let trees = [Meet::Around, Meet::Stop].map(|meet| {
            let settings = settings(light, vec![Obstacle { meet, ..rock.clone() }]);
            let tree = grown(&settings, &inputs, 3).branching;
            assert_eq!(
                tree.positions.iter().filter(|p| is_inside(p.as_dvec3())).count(),
                0,
                "{light:?} {meet:?}"
            );
            tree.positions.len()
        });
        assert!(trees[0] > 300 && trees[1] > 300, "{light:?} {trees:?}");
    }
}

#[test]
fn a_shoot_turns_aside_as_little_as_it_can_or_ends() {
    let turned = |meet| {
        let wall = Obstacle { meet, ..wall([0.2, 8.0, 12.0], [1.0, 0.0, 0.0]) };
        let barriers = Barriers::new(&settings(LightModel::Sky, vec![wall]), &Inputs::new(), &Quiet).unwrap();
        // In internodes: half of one before the wall, a metre above the ground.
        let from = DVec3::new(9.0, 10.0, 0.5);
        [DVec3::X, DVec3::NEG_X, DVec3::Y].map(|direction| barriers.turned(from, direction, 1.0))
    };
    let [into, away, along] = turned(Meet::Around);
    let into = into.unwrap();
    // Half an internode is left: cos 60°.
    assert!((into.x - 0.5).abs() < 1e-9 && into.y > 0.8, "{into}");
    assert_eq!((away, along), (Some(DVec3::NEG_X), Some(DVec3::Y)));
    assert_eq!(turned(Meet::Stop), [None, away, along]);
}

#[test]
fn a_thin_wall_is_not_grown_through_and_the_tree_is_narrower_there() {
    // Two internodes thick, a metre from the stem, and the same turned by a right angle.
    let wide = wall([0.2, 8.0, 12.0], [1.0, 0.0, 0.0]);
    let turned = Obstacle { turn_deg: 90.0, ..wall([12.0, 8.0, 0.2], [1.0, 0.0, 0.0]) };
    for light in LIGHTS {
        let trees = |obstacles: &[Obstacle]| {
            let settings = settings(light, obstacles.to_vec());
            let of: Vec<Branching> =
                (0..4).map(|seed| grown(&settings, &Inputs::new(), seed).branching).collect();
            of
        };
        let (free, walled, other) =
            (trees(&[]), trees(std::slice::from_ref(&wide)), trees(std::slice::from_ref(&turned)));
        let in_wall = |p: DVec3| p.x > 0.9 + 1e-4 && p.x < 1.1 - 1e-4 && p.y < 8.0 && p.z.abs() < 6.0;
        let entered = |trees: &[Branching]| trees.iter().flat_map(places).filter(|&p| in_wall(p)).count();
        assert!(entered(&free) > 100, "{light:?}");
        assert_eq!([entered(&walled), entered(&other)], [0, 0], "{light:?}");
        // Behind it, and on the other side; where the middle of the crown is.
        let all = |trees: &[Branching]| -> Vec<f64> {
            trees.iter().flat_map(|tree| &tree.positions).map(|p| f64::from(p.x)).collect()
        };
        let mean = |trees: &[Branching]| {
            let all = all(trees);
            all.iter().sum::<f64>() / all.len() as f64
        };
        let behind = |trees: &[Branching]| {
            let all = all(trees);
            all.iter().filter(|&&x| x > 1.0).count() as f64 / all.len() as f64
        };
        let [free, walled] = [&free, &walled].map(|trees| (mean(trees), behind(trees)));
        println!("{light:?}: free {free:?} walled {walled:?}");
        assert!(walled.0 < free.0 - 0.15, "{light:?}: {free:?} {walled:?}");
        assert!(walled.1 < 0.2 * free.1, "{light:?}: {free:?} {walled:?}");
    }
}

#[test]
fn what_stands_far_away_changes_nothing() {
    for light in LIGHTS {
        let free = hash(grow(&settings(light, Vec::new()), Key::new(5), &Quiet).unwrap());
        for at in [[80.0, 0.0, 0.0], [-9000.0, 0.0, 70.0], [0.0, -9.0, 0.0]] {
            let settings = settings(light, vec![wall([1.0, 6.0, 40.0], at)]);
            assert_eq!(hash(grown(&settings, &Inputs::new(), 5)), free, "{light:?} {at:?}");
        }
    }
}

#[test]
fn any_number_of_threads_grows_the_same_tree_at_a_wall() {
    for light in LIGHTS {
        let settings = settings(light, vec![wall([0.2, 8.0, 12.0], [0.6, 0.0, 0.0])]);
        let [one, eight] = [1, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| hash(grown(&settings, &Inputs::new(), 8)))
        });
        assert_eq!(one, eight, "{light:?}");
    }
}

#[test]
fn below_a_roof_next_to_nothing_grows() {
    for light in LIGHTS {
        let roofed = settings(light, vec![wall([60.0, 0.3, 60.0], [0.0, 0.8, 0.0])]);
        let barriers = Barriers::new(&roofed, &Inputs::new(), &Quiet).unwrap();
        match grow_among(&roofed, &[Planted::default()], &barriers, Key::new(2), &Quiet) {
            // A pyramid of shade is six internodes deep, and the roof eight high.
            Ok(grown) => assert!(light == LightModel::Shadow && grown.branching.positions.len() < 100),
            Err(refused) => {
                assert!(matches!(refused, SelfOrganizingError::NoLight { years: 20 }), "{refused}");
                assert_eq!(light, LightModel::Sky);
            }
        }
    }
}

#[test]
fn seedlings_in_the_dark_are_no_trees() {
    let settings = settings(LightModel::Sky, vec![wall([2.0, 0.3, 2.0], [5.0, 0.3, 0.0])]);
    let barriers = Barriers::new(&settings, &Inputs::new(), &Quiet).unwrap();
    let feet = [Vec3::ZERO, Vec3::X * 5.0, Vec3::Z * 5.0];
    let grown = grow_among(
        &settings,
        &feet.map(|foot| Planted { foot, felled_in: 0 }),
        &barriers,
        Key::new(1),
        &Quiet,
    )
    .unwrap();
    assert_eq!(grown.died, 1);
    let parents = &grown.branching.parents;
    assert_eq!(parents.iter().filter(|&&parent| parent == NO_PARENT).count(), 2);
    assert!(
        (0..parents.len()).all(|node| { parents[node] != NO_PARENT || parents.contains(&(node as u32)) })
    );
}

#[test]
fn refusals_say_which_obstacle_and_what_to_do() {
    let refused = |obstacle: Obstacle, inputs: &Inputs| {
        let settings = settings(LightModel::Sky, vec![wall([1.0; 3], [9.0, 0.0, 0.0]), obstacle]);
        let barriers = Barriers::new(&settings, inputs, &Quiet);
        barriers
            .and_then(|barriers| grow_among(&settings, &[Planted::default()], &barriers, Key::new(1), &Quiet))
            .unwrap_err()
    };
    let said = refused(wall([1.0; 3], [0.4, 0.0, 0.0]), &Inputs::new());
    assert!(matches!(said, SelfOrganizingError::FootInside { number: 0, .. }), "{said}");
    assert!(said.to_string().contains("move one of them"), "{said}");
    let rock = Obstacle::of(ObstacleSolid::Solid(Solid::Mesh { file: "rock.obj".to_owned() }));
    let said = refused(rock.clone(), &Inputs::new()).to_string();
    assert!(said.contains("obstacle 2 ('rock.obj')") && said.contains("must hold a mesh"), "{said}");
    let mut open = Inputs::new();
    let sheet = b"v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n";
    open.insert("rock.obj", Input::read("rock.obj", sheet, &Quiet).unwrap());
    let said = refused(rock, &open).to_string();
    assert!(said.contains("obstacle 2 ('rock.obj')") && said.contains("enclose"), "{said}");
}
