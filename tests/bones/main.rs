//! Joints out of the bytes of a GLB: skinned here anew, they go where the morph targets of the same tree go.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::collections::BTreeMap;
use std::path::Path;

use glam::{Mat4, Quat, Vec3};
use gltf::animation::util::ReadOutputs;
use gltf::mesh::util::ReadJoints;
use linden::dress::{Level, levels};
use linden::grow::grow;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::stage::{Place, Stage};
use linden::{Quiet, dress};
use linden_tests::fixtures::{export, export_stage};

/// A file as readers of glTF see it.
struct Read {
    document: gltf::Document,
    buffers: Vec<gltf::buffer::Data>,
}

/// Where the vertices of a mesh are at rest and in each frame that was asked for.
struct Moved {
    rest: Vec<Vec3>,
    frames: Vec<Vec<Vec3>>,
}

impl Read {
    fn file(path: &Path) -> Self {
        let gltf = gltf::Gltf::open(path).unwrap();
        let document = gltf.document.clone();
        let buffers = gltf::import_buffers(&document, path.parent(), gltf.blob).unwrap();
        Self { document, buffers }
    }

    /// The loop: times, and the values of each node and path.
    fn channels(&self) -> (usize, BTreeMap<(usize, &'static str), Vec<f32>>) {
        let mut all = BTreeMap::new();
        let mut frames = 0;
        for channel in
            self.document.animations().flat_map(|animation| animation.channels().collect::<Vec<_>>())
        {
            let reader = channel.reader(|buffer| Some(&self.buffers[buffer.index()].0[..]));
            let times: Vec<f32> = reader.read_inputs().unwrap().collect();
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]) && times[0] == 0.0);
            frames = times.len() - 1;
            let node = channel.target().node().index();
            match reader.read_outputs().unwrap() {
                ReadOutputs::Rotations(turns) => {
                    let turns: Vec<[f32; 4]> = turns.into_f32().collect();
                    assert_eq!(turns.len(), times.len());
                    for turn in &turns {
                        assert!((Quat::from_array(*turn).length() - 1.0).abs() < 1e-4, "{turn:?}");
                    }
                    assert_eq!(turns[0], turns[frames], "a loop closes");
                    all.insert((node, "turn"), turns.concat());
                }
                ReadOutputs::MorphTargetWeights(weights) => {
                    all.insert((node, "weights"), weights.into_f32().collect());
                }
                _ => panic!("joints keep their places"),
            }
        }
        (frames, all)
    }

    /// The meshes by name.
    fn moved(&self, at: &[f32]) -> BTreeMap<String, Moved> {
        let (frames, channels) = self.channels();
        let parents: BTreeMap<usize, usize> = self
            .document
            .nodes()
            .flat_map(|node| {
                node.children().map(move |child| (child.index(), node.index())).collect::<Vec<_>>()
            })
            .collect();
        let local = |node: usize, frame: usize| {
            let (place, turn, scale) = self.document.nodes().nth(node).unwrap().transform().decomposed();
            let turn = channels
                .get(&(node, "turn"))
                .map_or(turn, |turns| [0, 1, 2, 3].map(|i| turns[4 * frame + i]));
            Mat4::from_scale_rotation_translation(scale.into(), Quat::from_array(turn), place.into())
        };
        let world = |node: usize, frame: usize| {
            let mut matrix = local(node, frame);
            let mut at = node;
            while let Some(&parent) = parents.get(&at) {
                matrix = local(parent, frame) * matrix;
                at = parent;
            }
            matrix
        };
        let mut all = BTreeMap::new();
        for node in self.document.nodes() {
            let Some(mesh) = node.mesh() else { continue };
            let mut moved = Moved { rest: Vec::new(), frames: vec![Vec::new(); at.len()] };
            for primitive in mesh.primitives() {
                let reader = primitive.reader(|buffer| Some(&self.buffers[buffer.index()].0[..]));
                let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
                let morphs: Vec<Vec<Vec3>> = reader
                    .read_morph_targets()
                    .map(|(offsets, ..)| offsets.unwrap().map(Vec3::from).collect())
                    .collect();
                if node.skin().is_none() {
                    moved.rest.extend(positions.iter().map(|p| world(node.index(), 0).transform_point3(*p)));
                } else {
                    assert!(!parents.contains_key(&node.index()), "a node that is bound is a root");
                    // At rest joints have no turns: inverse bind matrices and places take each other away.
                    moved.rest.extend(self.skinned(&node, &primitive, &positions, &|joint| {
                        let mut place = Mat4::IDENTITY;
                        let mut at = Some(joint);
                        while let Some(node) = at {
                            let (t, r, s) = self.document.nodes().nth(node).unwrap().transform().decomposed();
                            let here = Mat4::from_scale_rotation_translation(
                                s.into(),
                                Quat::from_array(r),
                                t.into(),
                            );
                            place = here * place;
                            at = parents.get(&node).copied();
                        }
                        place
                    }));
                }
                for (out, share) in moved.frames.iter_mut().zip(at) {
                    let frame = (share * frames as f32) as usize;
                    if node.skin().is_some() {
                        out.extend(self.skinned(&node, &primitive, &positions, &|joint| world(joint, frame)));
                        continue;
                    }
                    let weights = channels.get(&(node.index(), "weights"));
                    for (vertex, place) in positions.iter().enumerate() {
                        let mut place = *place;
                        for (target, offsets) in morphs.iter().enumerate() {
                            place += offsets[vertex] * weights.unwrap()[frame * morphs.len() + target];
                        }
                        out.push(world(node.index(), frame).transform_point3(place));
                    }
                }
            }
            all.insert(node.name().unwrap().to_owned(), moved);
        }
        all
    }

    fn skinned(
        &self,
        node: &gltf::Node<'_>,
        primitive: &gltf::Primitive<'_>,
        positions: &[Vec3],
        world: &dyn Fn(usize) -> Mat4,
    ) -> Vec<Vec3> {
        let skin = node.skin().unwrap();
        let joints: Vec<usize> = skin.joints().map(|joint| joint.index()).collect();
        let unbind: Vec<Mat4> = skin
            .reader(|buffer| Some(&self.buffers[buffer.index()].0[..]))
            .read_inverse_bind_matrices()
            .unwrap()
            .map(|matrix| Mat4::from_cols_array_2d(&matrix))
            .collect();
        assert_eq!(unbind.len(), joints.len());
        let carry: Vec<Mat4> =
            joints.iter().zip(&unbind).map(|(joint, unbind)| world(*joint) * *unbind).collect();
        let reader = primitive.reader(|buffer| Some(&self.buffers[buffer.index()].0[..]));
        let read = reader.read_joints(0).unwrap();
        assert_eq!(matches!(read, ReadJoints::U8(_)), joints.len() <= 256);
        let bound: Vec<[u16; 4]> = read.into_u16().collect();
        let weights: Vec<[u8; 4]> = reader.read_weights(0).unwrap().into_u8().collect();
        assert_eq!((bound.len(), weights.len()), (positions.len(), positions.len()));
        let place = |((place, bound), weights): ((&Vec3, &[u16; 4]), &[u8; 4])| {
            assert_eq!(weights.iter().map(|weight| u32::from(*weight)).sum::<u32>(), 255);
            let each = bound.iter().zip(weights);
            each.map(|(&joint, &weight)| {
                assert!(weight > 0 || joint == 0, "a joint without weight is the first");
                carry[usize::from(joint)].transform_point3(*place) * (f32::from(weight) / 255.0)
            })
            .sum()
        };
        positions.iter().zip(&bound).zip(&weights).map(place).collect()
    }
}

fn recipe(id: &str, knobs: &[(&str, &str)]) -> Recipe {
    let mut recipe = builtin(id).unwrap().recipe(&Quiet).unwrap();
    for (knob, value) in [("bark_size", "16"), ("leaf_size", "64")].iter().chain(knobs) {
        recipe.preset.set(knob, value).unwrap();
    }
    recipe
}

/// Mean gap between two ways to move a tree, as a share of the largest way of a vertex.
fn gap(by_joints: &BTreeMap<String, Moved>, by_targets: &BTreeMap<String, Moved>, of: &str) -> f64 {
    let (mut sum, mut count, mut most) = (0.0, 0, 0.0_f32);
    assert_eq!(by_joints.len(), by_targets.len());
    for (name, joints) in by_joints {
        let targets = &by_targets[name];
        assert_eq!(joints.rest.len(), targets.rest.len(), "{name}");
        for (a, b) in joints.rest.iter().zip(&targets.rest) {
            assert!(a.distance(*b) < 2e-3, "{name} at rest: {a} and {b}");
        }
        for (a, b) in joints.frames.iter().zip(&targets.frames) {
            for ((a, b), rest) in a.iter().zip(b).zip(&targets.rest) {
                most = most.max(b.distance(*rest));
                if name.contains(of) {
                    sum += f64::from(a.distance(*b));
                    count += 1;
                }
            }
        }
    }
    assert!(count > 100 && most > 0.01, "{count} vertices of {of} go {most} m");
    sum / f64::from(count) / f64::from(most)
}

#[test]
fn joints_go_where_the_morph_targets_go() {
    let dir = tempfile::tempdir().unwrap();
    let cases: [(&str, &[(&str, &str)]); 4] = [
        ("drawn-oak", &[("points", "700")]),
        ("weeping-willow", &[]),
        ("norway-spruce", &[]),
        ("abop-f", &[]),
    ];
    for (id, knobs) in cases {
        let recipe = recipe(id, knobs);
        let grown = grow(&recipe, &Quiet).unwrap();
        let mut bytes = Vec::new();
        let mut read = |wind: &str, options: &[(&str, &str)]| {
            let mut recipe = recipe.clone();
            recipe.preset.set("wind", wind).unwrap();
            let scene = dress::dress(&recipe, &grown, &Quiet).unwrap();
            let path = dir.path().join(format!("{id}.glb"));
            export(&scene, "glb", options, &path).unwrap();
            bytes.push(std::fs::metadata(&path).unwrap().len());
            Read::file(&path).moved(&[0.0, 0.1, 0.23, 0.5, 0.71, 0.9])
        };
        let targets = read("sway", &[("pictures", "false")]);
        let joints = read("bones", &[("pictures", "false")]);
        let wood = gap(&joints, &targets, "_wood");
        println!("{id}: {:.2} %; {bytes:?}", 100.0 * wood);
        // Each of the willow's thousands of hanging shoots swings by itself: joints for all of them are too many.
        let bound = if id == "weeping-willow" { 0.09 } else { 0.05 };
        assert!(wood < bound, "{id}: {wood}");
        assert!(bytes[1] < bytes[0], "{id}: {bytes:?} bytes");
    }
}

#[test]
fn levels_share_joints_and_many_trees_have_their_own() {
    let dir = tempfile::tempdir().unwrap();
    let knobs = [("points", "400"), ("lods", "3"), ("billboard", "2"), ("wind", "bones"), ("bones", "40")];
    let recipe = recipe("drawn-oak", &knobs);
    let grown = grow(&recipe, &Quiet).unwrap();
    let all = levels(&recipe, &grown, &Quiet).unwrap().levels;
    let alone = Stage::of_levels(&all[0].scene, all.iter().map(Level::on_stage).collect());
    for lods in ["msft", "siblings"] {
        let path = dir.path().join(format!("{lods}.glb"));
        export_stage(&alone, "glb", &[("lods", lods)], &path).unwrap();
        let read = Read::file(&path);
        assert_eq!(
            (read.document.skins().count(), read.document.skins().next().unwrap().joints().count()),
            (1, 40)
        );
        let skinned = read.document.nodes().filter(|node| node.skin().is_some()).count();
        assert_eq!(
            (skinned, read.document.nodes().filter(|node| node.mesh().is_some()).count()),
            (3, 4),
            "{lods}"
        );
        let moved = read.moved(&[0.3]);
        for (name, moved) in &moved {
            let way =
                moved.frames[0].iter().zip(&moved.rest).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert_eq!(way > 0.01, !name.ends_with("LOD3"), "{name}: {way}");
        }
    }
    let scene = &all[0].scene;
    let mut two = Stage::of(scene);
    two.places = vec![Place::origin(0), Place { position: Vec3::X * 30.0, scale: 0.5, ..Place::origin(0) }];
    let path = dir.path().join("two.glb");
    export_stage(&two, "glb", &[("instances", "true")], &path).unwrap();
    let read = Read::file(&path);
    assert_eq!(read.document.skins().count(), 2);
    let moved: Vec<Moved> = read.moved(&[0.3]).into_values().collect();
    assert_eq!(moved.len(), 2);
    for (a, b) in moved[0].frames[0].iter().zip(&moved[1].frames[0]) {
        assert!((Vec3::X * 30.0 + *a * 0.5).distance(*b) < 1e-2, "{a} {b}");
    }
}

#[test]
fn the_same_joints_on_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    let recipe = recipe("drawn-oak", &[("points", "300"), ("wind", "bones")]);
    let written = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grown = grow(&recipe, &Quiet).unwrap();
            let scene = dress::dress(&recipe, &grown, &Quiet).unwrap();
            let path = dir.path().join(format!("{threads}.glb"));
            export(&scene, "glb", &[], &path).unwrap();
            std::fs::read(path).unwrap()
        })
    };
    assert!(written(1) == written(3));
}
