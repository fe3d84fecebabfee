use glam::{Mat4, Vec3};

use super::*;
use crate::detail;
use crate::scene::Scene;
use crate::testing::{Subject, body};
use linden_base::monitor::Quiet;
use linden_pipeline::grow::Grown;

/// The same tree with knobs turned.
fn dressed(id: &str, grown: &Grown, knobs: &[(&str, &str)]) -> Scene {
    let small = [("bark_size", "16"), ("leaf_size", "64")];
    Subject::builtin(id, &[&small[..], knobs].concat()).dress(grown)
}

/// Where bound vertices are, with matrices in place of turns and arms.
fn skinned(wind: &PartWind, positions: &[Vec3], frame: u32) -> Vec<Vec3> {
    let bones = wind.bones.as_ref().unwrap();
    let mut poses: Vec<Mat4> = Vec::new();
    for (index, joint) in bones.joints.iter().enumerate() {
        let (parent, origin) = match joint.parent {
            None => (Mat4::IDENTITY, Vec3::ZERO),
            Some(parent) => (poses[parent], bones.joints[parent].place),
        };
        let local = Mat4::from_rotation_translation(bones.turn(index, frame), joint.place - origin);
        poses.push(parent * local);
    }
    let unbind: Vec<Mat4> = bones.joints.iter().map(|joint| Mat4::from_translation(-joint.place)).collect();
    let moved = |(place, binding): (&Vec3, &Binding)| {
        let each = binding.joints.iter().zip(binding.weights);
        each.map(|(&joint, weight)| {
            let joint = usize::from(joint);
            (poses[joint] * unbind[joint]).transform_point3(*place) * (f32::from(weight) / 255.0)
        })
        .sum()
    };
    positions.iter().zip(&wind.bindings).map(moved).collect()
}

/// How far the joints are from the morph targets: the mean, that of 95 % and the largest, as shares of the largest way
/// that a vertex goes. Of wood, and of everything.
fn errors(id: &str, grown: &Grown, knobs: &[(&str, &str)]) -> [[f32; 3]; 2] {
    let sway = dressed(id, grown, &[&[("wind", "sway")], knobs].concat());
    let bones = dressed(id, grown, &[&[("wind", "bones")], knobs].concat());
    let (mut gaps, mut most) = ([Vec::new(), Vec::new()], 0.0_f32);
    for (swaying, turning) in sway.parts.iter().zip(&bones.parts) {
        assert_eq!(swaying.mesh, turning.mesh);
        let positions = &swaying.mesh.positions;
        let frames = swaying.wind.as_ref().unwrap().sway.as_ref().unwrap().frames();
        for frame in (0..frames).step_by(frames as usize / 7) {
            let wanted = swaying.wind.as_ref().unwrap().moved(positions, frame).unwrap();
            let found = skinned(turning.wind.as_ref().unwrap(), positions, frame);
            for ((wanted, found), rest) in wanted.iter().zip(&found).zip(positions) {
                most = most.max(wanted.distance(*rest));
                let gap = wanted.distance(*found);
                gaps[1].push(gap);
                if swaying.name.starts_with("wood") {
                    gaps[0].push(gap);
                }
            }
        }
    }
    gaps.map(|mut gaps| {
        gaps.sort_unstable_by(f32::total_cmp);
        let mean = gaps.iter().map(|gap| f64::from(*gap)).sum::<f64>() / gaps.len().max(1) as f64;
        let at = |share: f64| gaps.get((share * (gaps.len() as f64 - 1.0)) as usize).copied().unwrap_or(0.0);
        [mean as f32, at(0.95), at(1.0)].map(|gap| gap / most)
    })
}

#[test]
fn joints_follow_the_targets_the_better_the_more_there_are() {
    for id in ["fir", "abop-f"] {
        let grown = Subject::builtin(id, &[]).grow();
        let by =
            |most: &str, order: &str| errors(id, &grown, &[("bones", most), ("bone_order", order)])[0][0];
        let [few, some, many] = [by("16", "8"), by("64", "8"), by("256", "8")];
        assert!(many < 0.05 && many < some && some < few, "{id}: {few} {some} {many}");
        assert!(by("256", "0") > some, "{id}: stems alone are too few");
    }
}

#[test]
fn everything_is_bound_to_joints_that_are_there() {
    let grown = Subject::builtin("dressed-fir", &[]).grow();
    for (most, order) in [("2", "8"), ("40", "1"), ("1024", "8")] {
        let scene = dressed(
            "dressed-fir",
            &grown,
            &[("wind", "bones"), ("bones", most), ("bone_order", order), ("wind_strength", "1")],
        );
        let mut known = None;
        for part in &scene.parts {
            let wind = part.wind.as_ref().unwrap();
            let bones = wind.bones.as_ref().unwrap();
            assert!(known.get_or_insert(bones) == &bones, "all parts have the same");
            assert_eq!((wind.bindings.len(), wind.motions.len()), (part.mesh.positions.len(), 0));
            assert!(bones.joints.len() <= most.parse().unwrap() && bones.joints.len() > 1);
            for (index, joint) in bones.joints.iter().enumerate() {
                assert!(joint.parent.map_or(index == 0, |parent| parent < index), "parents come first");
            }
            let names: std::collections::BTreeSet<_> = bones.joints.iter().map(|joint| &joint.name).collect();
            assert_eq!(names.len(), bones.joints.len());
            for binding in &wind.bindings {
                assert_eq!(binding.weights.iter().map(|weight| u32::from(*weight)).sum::<u32>(), 255);
                assert!(binding.joints.iter().all(|joint| usize::from(*joint) < bones.joints.len()));
                assert!(binding.weights.is_sorted_by(|a, b| a >= b));
            }
            for frame in [0, 31, bones.sway.frames()] {
                assert!(bones.pose(frame)[0] == (glam::Quat::IDENTITY, bones.joints[0].place));
                let moved = wind.moved(&part.mesh.positions, frame).unwrap();
                let anew = skinned(wind, &part.mesh.positions, frame);
                assert!(moved.iter().zip(&anew).all(|(a, b)| a.distance(*b) < 1e-3));
            }
            assert_eq!(bones.pose(0), bones.pose(bones.sway.frames()), "a loop");
        }
    }
}

#[test]
fn the_foot_stands_still_and_an_axis_begins_where_it_is_borne() {
    let grown = Subject::builtin("fir", &[]).grow();
    let scene = dressed("fir", &grown, &[("wind", "bones"), ("wind_strength", "1")]);
    let (mesh, wind) = (&scene.parts[0].mesh, scene.parts[0].wind.as_ref().unwrap());
    let foot = wind.bones.as_ref().unwrap().joints[0].place;
    let moved = wind.moved(&mesh.positions, 20).unwrap();
    let mut most = 0.0_f32;
    for (place, moved) in mesh.positions.iter().zip(&moved) {
        most = most.max(place.distance(*moved));
        assert!(place.y > foot.y || place.distance(*moved) < 1e-5, "{place}");
    }
    assert!(most > 0.1, "{most}");
    // Triangles stay whole: no edge grows by more than a part of what moves.
    for corners in &mesh.triangles {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let [a, b] = [corners[a] as usize, corners[b] as usize];
            let [before, after] =
                [mesh.positions[a].distance(mesh.positions[b]), moved[a].distance(moved[b])];
            assert!(after < 1.5 * before + 0.05 * most, "{before} to {after}");
        }
    }
}

#[test]
fn all_levels_have_the_same_joints() {
    let knobs = [("bark_size", "16"), ("wind", "bones"), ("lods", "3"), ("lod_ratio", "0.2")];
    let subject = Subject::builtin("fir", &knobs);
    let grown = subject.grow();
    let all = subject.with(|specimen| detail::levels(specimen, body(&grown), &Quiet)).unwrap().levels;
    let bones = |level: usize| all[level].scene.parts[0].wind.as_ref().unwrap().bones.clone().unwrap();
    assert!(all.len() == 3 && std::sync::Arc::ptr_eq(&bones(0), &bones(2)));
}
