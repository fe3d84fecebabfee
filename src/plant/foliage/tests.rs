//! Leaves against the definitions of what knobs say.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;

use super::*;
use crate::testing::Subject;
use glam::Vec3;
use linden_base::monitor::Monitor;
use linden_base::monitor::Quiet;
use linden_pipeline::preset::Preset;
use linden_pipeline::recipe::{Input, Recipe};
use linden_skeleton::{Branching, NO_PARENT, Skeleton, Wood};

/// A recipe whose `[foliage]` says this. Without jitter, spread and terminal leaves.
fn recipe(foliage: &str) -> Subject {
    let plain = "leaf_jitter = 0\nleaf_size_spread = 0\nleaf_terminal = false\nleaf_droop = 0\nleaf_level = 0\nleaf_size = 32";
    let first = foliage.lines().take_while(|line| !line.starts_with('['));
    let keys: Vec<&str> = first.map(|line| line.split('=').next().unwrap_or("").trim()).collect();
    let kept = plain.lines().filter(|line| !keys.contains(&line.split('=').next().unwrap().trim()));
    let plain: Vec<&str> = kept.collect();
    let text =
        format!("id = \"a\"\n[colonization]\ncrown = \"sphere\"\n[foliage]\n{}\n{foliage}", plain.join("\n"));
    let preset = Preset::from_toml(&text).unwrap_or_else(|fault| panic!("{fault}: {text}"));
    Subject::of(Recipe::new(preset))
}

fn built(positions: Vec<Vec3>, parents: Vec<u32>, radii: Vec<f32>) -> Skeleton {
    let births = (0..positions.len() as u32).collect();
    let branching = Branching { positions, parents, births, radii: Some(radii), edges: None };
    Skeleton::build(branching, &Wood::default()).unwrap()
}

/// Twigs of a centimetre that stand apart and lean: each of `segments` segments of 0.1 m.
fn twigs(count: u32, segments: u32) -> Skeleton {
    let (mut positions, mut parents) = (Vec::new(), Vec::new());
    for twig in 0..count {
        let lean = Vec3::new(0.6, 0.8, 0.0);
        for node in 0..=segments {
            parents.push(if node == 0 { NO_PARENT } else { positions.len() as u32 - 1 });
            positions.push(Vec3::Z * twig as f32 * 5.0 + lean * (0.1 * node as f32));
        }
    }
    let radii = vec![0.01; positions.len()];
    built(positions, parents, radii)
}

/// An axis that bends and tapers, with a lateral; each segment divided into `pieces`.
fn bent(pieces: u32) -> Skeleton {
    let main = [(0., 0., 0.), (0.1, 1., 0.), (0.5, 1.8, 0.3), (1.3, 2.2, 0.4), (2.2, 2.3, 0.1)];
    let side = [(0.5, 1.8, 0.3), (0.3, 2.3, 1.1), (0.6, 2.4, 2.0)];
    let (mut positions, mut parents) = (vec![Vec3::from(main[0])], vec![NO_PARENT]);
    let mut radii = vec![0.05_f32];
    let mut births = vec![0];
    let mut grow = |line: &[(f32, f32, f32)], mut from: u32, thick: f32, first_birth: u32| {
        let mut last = from;
        for (i, pair) in line.windows(2).enumerate() {
            let (a, b) = (Vec3::from(pair[0]), Vec3::from(pair[1]));
            let radius = |t: f32| thick * (1.0 - 0.2 * (i as f32 + t));
            for piece in 1..=pieces {
                let t = piece as f32 / pieces as f32;
                parents.push(from);
                positions.push(a.lerp(b, t));
                radii.push(if last == 0 || i > 0 || thick > 0.04 { radius(t) } else { thick * 0.8 });
                births.push(first_birth + i as u32);
                from = positions.len() as u32 - 1;
            }
            last = from;
        }
    };
    grow(&main, 0, 0.05, 1);
    grow(&side, 2 * pieces, 0.02, 5);
    let branching = Branching { positions, parents, births, radii: Some(radii), edges: None };
    Skeleton::build(branching, &Wood::default()).unwrap()
}

fn sprout(
    subject: &Subject,
    skeleton: &Skeleton,
    given: &Arc<Organs>,
    monitor: &dyn Monitor,
) -> Result<Arc<Organs>, FoliageError> {
    subject.with(|specimen| super::sprout(specimen, skeleton, given, monitor))
}

fn grown(recipe: &Subject, skeleton: &Skeleton) -> Arc<Organs> {
    sprout(recipe, skeleton, &Arc::default(), &Quiet).unwrap()
}

/// What identifies a leaf, whatever its size and variant.
fn poses(organs: &Organs) -> BTreeSet<[u32; 9]> {
    let placed = &organs.placed;
    let bits = |v: Vec3| v.to_array().map(f32::to_bits);
    (0..placed.len())
        .map(|i| {
            let [p, h, u] = [placed.positions[i], placed.headings[i], placed.ups[i]].map(bits);
            [p[0], p[1], p[2], h[0], h[1], h[2], u[0], u[1], u[2]]
        })
        .collect()
}

#[test]
fn there_are_as_many_leaves_a_metre_as_asked_for() {
    let tree = twigs(400, 7);
    for arrangement in ["alternate", "opposite", "decussate", "whorled", "spiral"] {
        for count in [1, 2] {
            let subject = recipe(&format!(
                "leaf_form = \"card\"\nleaf_arrangement = \"{arrangement}\"\nleaves_per_m = 50\nleaf_count = {count}"
            ));
            let leaves = grown(&subject, &tree).len() as f64;
            // 280 m; each twig rounds up or down, by chance.
            assert!((leaves / (280.0 * 50.0) - 1.0).abs() < 0.02, "{arrangement} x {count}: {leaves}");
        }
    }
    assert_eq!(grown(&recipe("leaf_form = \"card\"\nleaves_per_m = 0"), &tree).len(), 0);
    let tips = recipe("leaf_form = \"card\"\nleaves_per_m = 0\nleaf_terminal = true");
    assert_eq!(grown(&tips, &tree).len(), 400);
}

#[test]
fn an_axis_that_is_divided_more_finely_has_the_same_leaves() {
    let subject =
        recipe("leaf_form = \"card\"\nleaf_jitter = 20\nleaf_size_spread = 0.3\nleaf_terminal = true");
    let (coarse, fine) = (bent(1), bent(4));
    assert_eq!(fine.axes.len(), 2);
    let (a, b) = (grown(&subject, &coarse), grown(&subject, &fine));
    assert!(a.len() > 30);
    assert_eq!(a.placed.prototypes, b.placed.prototypes);
    assert_eq!(a.placed.sizes_m, b.placed.sizes_m);
    for i in 0..a.len() {
        assert!(a.placed.positions[i].distance(b.placed.positions[i]) < 1e-4, "leaf {i}");
        assert!(a.placed.headings[i].distance(b.placed.headings[i]) < 1e-3, "leaf {i}");
        assert!(a.placed.ups[i].distance(b.placed.ups[i]) < 1e-3, "leaf {i}");
    }
}

#[test]
fn feet_lie_on_the_bark_and_only_young_wood_bears() {
    let tree = bent(2);
    let offset = 0.003;
    let subject = recipe(&format!(
        "leaf_form = \"card\"\nleaf_max_radius = 0.035\nleaf_offset = {offset}\nleaves_per_m = 200\nleaf_jitter = 30"
    ));
    let organs = grown(&subject, &tree);
    assert!(organs.len() > 200);
    for (foot, &node) in organs.placed.positions.iter().zip(&organs.placed.growth.nodes) {
        let parent = tree.parents[node as usize];
        let (a, b) = (tree.positions[parent as usize], tree.positions[node as usize]);
        let share = ((*foot - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        let distance = foot.distance(a.lerp(b, share));
        let is_base = tree.axes.iter().any(|axis| tree.nodes_of(axis)[0] == node);
        let thick = tree.radii[if is_base { node } else { parent } as usize];
        let radius = thick + (tree.radii[node as usize] - thick) * share;
        assert!((distance - radius - offset).abs() < 1e-4, "{distance} from wood of {radius}");
        assert!(radius <= 0.035 + 1e-6);
    }
    // Of six births the last third: the lateral.
    let young = recipe("leaf_form = \"card\"\nleaf_max_age = 0.34\nleaf_max_radius = 1");
    let young = grown(&young, &tree);
    assert!(!young.is_empty() && young.placed.growth.births.iter().all(|&birth| birth >= 4));
}

#[test]
fn leaves_stand_round_a_twig_as_their_arrangement_has_it() {
    let tree = twigs(1, 20);
    let axis = Vec3::new(0.6, 0.8, 0.0);
    let azimuths = |arrangement: &str, more: &str| -> Vec<f64> {
        let subject = recipe(&format!(
            "leaf_form = \"card\"\nleaf_arrangement = \"{arrangement}\"\nleaf_angle = 90\n{more}"
        ));
        let organs = grown(&subject, &tree);
        let heading = |h: &Vec3| {
            let (x, y) = (h.dot(axis.cross(Vec3::Z)), h.dot(Vec3::Z));
            assert!(h.dot(axis).abs() < 1e-5, "square to the twig");
            f64::from(libm::atan2f(y, x)).to_degrees()
        };
        organs.placed.headings.iter().map(heading).collect()
    };
    // Either way round.
    let turn = |a: f64, b: f64| (b - a).rem_euclid(360.0);
    let near = |a: f64, b: f64| (a - b).abs().min((a - b + 360.0).abs()).min((a - b - 360.0).abs()) < 0.01;
    let whorled = |a: f64, b: f64| near(turn(a, b), 72.0) || near(turn(b, a), 72.0);
    let all = azimuths("alternate", "");
    assert!(all.windows(2).all(|pair| near(turn(pair[0], pair[1]), 180.0)));
    assert!(all.iter().all(|a| near(a.abs(), 90.0)), "to the left and the right of a leaning twig");
    let all = azimuths("opposite", "");
    assert!(all.chunks(2).all(|pair| near(turn(pair[0], pair[1]), 180.0)));
    assert!(all.chunks(2).all(|pair| near(pair[0], all[0])), "in one plane");
    let all = azimuths("decussate", "");
    assert!(all.chunks(2).all(|pair| near(turn(pair[0], pair[1]), 180.0)));
    assert!(all.windows(3).step_by(2).all(|three| near(turn(three[0], three[2]) % 180.0, 90.0)));
    let all = azimuths("whorled", "leaf_whorl = 5");
    assert!(all.chunks(5).all(|whorl| whorl.windows(2).all(|pair| whorled(pair[0], pair[1]))));
    assert!(all.len() > 20 && near(turn(all[0], all[5]) % 72.0, 36.0), "in the gaps");
    // Sunflowers: 360 / φ², the other way round.
    let golden = 360.0 * (3.0 - 5.0_f64.sqrt()) / 2.0;
    let all = azimuths("spiral", "");
    let step = turn(all[0], all[1]);
    assert!(near(step, golden) || near(step, 360.0 - golden), "{step}");
    assert!(all.windows(2).all(|pair| near(turn(pair[0], pair[1]), step)));
}

#[test]
fn angle_droop_level_and_up_are_what_they_say() {
    let tree = twigs(1, 30);
    let axis = Vec3::new(0.6, 0.8, 0.0);
    let with = |more: &str| grown(&recipe(&format!("leaf_form = \"card\"\n{more}")), &tree);
    let angle = |a: Vec3, b: Vec3| libm::acos(f64::from(a.dot(b)).clamp(-1.0, 1.0)).to_degrees();
    let plain = with("leaf_angle = 35");
    assert!(plain.placed.headings.iter().all(|&h| (angle(h, axis) - 35.0).abs() < 0.01));
    // The upper side looks to the apex.
    assert!(plain.placed.ups.iter().all(|up| up.dot(axis) > 0.5));
    let hanging = with("leaf_angle = 35\nleaf_droop = 20");
    for (before, after) in plain.placed.headings.iter().zip(&hanging.placed.headings) {
        let (before, after) = (angle(*before, Vec3::NEG_Y), angle(*after, Vec3::NEG_Y));
        assert!((before - after - 20.0).abs() < 0.01, "{before} {after}");
    }
    let level = with("leaf_angle = 60\nleaf_level = 1");
    for (h, up) in level.placed.headings.iter().zip(&level.placed.ups) {
        // No direction square to the heading is steeper.
        let steepest = (1.0 - h.y * h.y).sqrt();
        assert!((up.y - steepest).abs() < 1e-4 || steepest < 0.3, "{up}");
    }
    let up = with("leaf_angle = 60\nleaf_up = 1");
    assert!(up.placed.headings.iter().all(|h| h.y > 0.9999));
    let down = with("leaf_angle = 60\nleaf_up = -0.5");
    let mean =
        |organs: &Organs| organs.placed.headings.iter().map(|h| h.y).sum::<f32>() / organs.len() as f32;
    assert!(mean(&down) < mean(&with("leaf_angle = 60")) - 0.3);
    for organs in
        [&plain, &hanging, &level, &up, &down, &with("leaf_jitter = 90\nleaf_droop = 45\nleaf_level = 0.5")]
    {
        for (h, up) in organs.placed.headings.iter().zip(&organs.placed.ups) {
            assert!((h.length() - 1.0).abs() < 1e-5 && (up.length() - 1.0).abs() < 1e-5);
            assert!(h.dot(*up).abs() < 1e-4);
        }
    }
}

#[test]
fn seasons_hide_and_shrink_leaves_and_move_none() {
    let tree = bent(1);
    let at = |season: &str, more: &str| {
        let subject = recipe(&format!(
            "leaf_form = \"card\"\nleaves_per_m = 300\nleaf_jitter = 20\nseason = {season}\n{more}"
        ));
        grown(&subject, &tree)
    };
    let summer = at("0.35", "");
    let mut last = poses(&summer);
    for season in ["0.8", "0.9", "0.95", "1"] {
        let shown = poses(&at(season, ""));
        assert!(shown.is_subset(&last) && shown.len() < last.len(), "{season}");
        last = shown;
    }
    assert!(last.is_empty(), "bare");
    assert!(poses(&at("0.75", "")) == poses(&summer));
    let flush = at("0", "");
    assert!(poses(&flush) == poses(&summer));
    assert!(flush.placed.sizes_m[0] < 0.5 * summer.placed.sizes_m[0]);
    assert!(at("1", "evergreen = true").placed.positions == summer.placed.positions);
    let half = poses(&at("0.35", "leaf_keep = 0.5"));
    let share = half.len() as f64 / summer.len() as f64;
    assert!(half.is_subset(&poses(&summer)) && (share - 0.5).abs() < 0.06, "{share}");
    assert!(poses(&at("0.35", "leaf_keep = 0.25")).is_subset(&half));
    // Nor do looks move any.
    for more in [
        "leaf_length = 0.3",
        "leaf_size_spread = 0.9",
        "leaf_colors = [\"#ff0000\"]",
        "leaf_outline = \"palmate\"",
    ] {
        assert!(poses(&at("0.35", more)) == poses(&summer), "{more}");
    }
}

#[test]
fn kinds_have_calendars_of_their_own() {
    let tree = bent(1);
    let at = |season: f64| {
        let subject = recipe(&format!(
            "leaf_form = \"card\"\nleaves_per_m = 60\nseason_range = [0.1, 1]\nseason = {season}\n\
             [[foliage.also]]\nleaf_form = \"card\"\nleaf_outline = \"blossom\"\nleaves_per_m = 40\n\
             season_range = [0, 0.15]\n\
             [[foliage.also]]\nleaf_form = \"card\"\nleaf_outline = \"fruit\"\nleaves_per_m = 20\n\
             season_range = [0.4, 0.9]"
        ));
        let organs = grown(&subject, &tree);
        let mut counts = [0; 3];
        for &prototype in &organs.placed.prototypes {
            let shape = usize::from(prototype) - PROTOTYPES.len();
            counts[usize::from(organs.shapes[shape].kind)] += 1;
        }
        (counts, organs)
    };
    let [blossom, both, summer, late, bare] = [0.05, 0.14, 0.3, 0.6, 1.0].map(|season| at(season).0);
    assert!(blossom[0] == 0 && blossom[1] > 0 && blossom[2] == 0, "{blossom:?}");
    assert!(both[0] > 0 && both[1] > 0 && both[1] < blossom[1], "{both:?}");
    assert!(summer[0] > both[0] && summer[1..] == [0, 0], "{summer:?}");
    assert!(late[0] == summer[0] && late[2] > 0, "{late:?}");
    assert_eq!(bare, [0; 3]);
    // What is there in two seasons is in the same place, and nothing is drawn for what is not there.
    assert!(poses(&at(0.35).1).is_subset(&poses(&at(0.6).1)));
    assert!(at(0.05).1.shapes.iter().all(|shape| shape.kind == 1));
}

#[test]
fn clusters_bear_as_many_as_they_are_told() {
    let tree = twigs(2, 4);
    for cluster in ["umbel", "corymb", "raceme", "panicle", "pompom"] {
        let of = |count: u32, form: &str| {
            let subject = recipe(&format!(
                "leaf_form = \"{form}\"\nleaf_outline = \"blossom\"\nleaf_length = 0.03\nleaves_per_m = 9\n\
                 cluster = \"{cluster}\"\ncluster_count = {count}\ncluster_stalk = 0.05\ncluster_length = 0.1"
            ));
            grown(&subject, &tree)
        };
        let triangles = |organs: &Organs| organs.shapes[0].mesh.triangles.len();
        let [one, two, three] = [10, 20, 30].map(|count| triangles(&of(count, "card")));
        assert_eq!(two - one, three - two, "{cluster}: each member is as much");
        assert!(two > one);
        let organs = of(12, "curved");
        for shape in organs.shapes.iter() {
            let mesh = &shape.mesh;
            assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4), "{cluster}");
            assert!(mesh.uvs.iter().all(|uv| (uv - 0.5).abs().max_element() <= 0.5));
            assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
            // One unit is the cluster's height: nothing stands far beyond.
            let farthest = mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
            assert!((0.5..2.0).contains(&farthest), "{cluster}: {farthest}");
        }
    }
}

#[test]
fn the_trunk_of_a_young_tree_is_bare_below_its_branches() {
    // A stem of 3 m as thin as its two branches, and a shoot that runs up along it from 0.4 m.
    let mut positions: Vec<Vec3> = (0..=30).map(|i| Vec3::Y * (0.1 * i as f32)).collect();
    let mut parents: Vec<u32> = std::iter::once(NO_PARENT).chain(0..30).collect();
    let mut branch = |from: u32, way: Vec3, off: Vec3, count: u32| {
        let mut last = from;
        for i in 1..=count {
            positions.push(Vec3::Y * (0.1 * from as f32) + off + way * (0.1 * i as f32));
            parents.push(last);
            last = positions.len() as u32 - 1;
        }
    };
    branch(15, Vec3::new(0.9, 0.4, 0.0).normalize(), Vec3::ZERO, 8);
    branch(20, Vec3::new(-0.9, 0.4, 0.2).normalize(), Vec3::ZERO, 8);
    branch(4, Vec3::Y, Vec3::X * 0.03, 9);
    let radii = vec![0.012; positions.len()];
    let tree = built(positions, parents, radii);
    let lowest = |more: &str| {
        let subject = recipe(&format!("leaf_form = \"card\"\nleaves_per_m = 40\n{more}"));
        let organs = grown(&subject, &tree);
        organs.placed.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min)
    };
    assert!((lowest("") - 1.5).abs() < 0.1, "{}", lowest(""));
    assert!(lowest("leaf_from = 0") < 0.1);
    assert!(lowest("leaf_from = 2.2") < 0.6, "branches are not the trunk");
    // A stem without branches is a shoot.
    let subject = recipe("leaf_form = \"card\"\nleaves_per_m = 40");
    assert!(grown(&subject, &twigs(1, 8)).placed.positions.iter().any(|p| p.y < 0.1));
}

#[test]
fn leaves_gather_at_tips() {
    let tree = twigs(300, 10);
    let along = |organs: &Organs| {
        let lengths = organs.placed.positions.iter().map(|p| p.with_z(0.0).length());
        lengths.sum::<f32>() / organs.len() as f32
    };
    let even = grown(&recipe("leaf_form = \"card\""), &tree);
    let tips = grown(&recipe("leaf_form = \"card\"\nleaf_tip = 1"), &tree);
    // The mean of a density that rises linearly from 0 to 1 lies at two thirds.
    assert!((along(&even) - 0.5).abs() < 0.01 && (along(&tips) - 2.0 / 3.0).abs() < 0.01);
    assert!(poses(&tips).is_subset(&poses(&even)));
}

#[test]
fn a_further_kind_takes_places_or_has_its_own() {
    let tree = twigs(200, 8);
    let first = "leaf_form = \"card\"\nleaf_arrangement = \"spiral\"";
    let alone = grown(&recipe(first), &tree);
    let kinds = |organs: &Organs, kind: u8| {
        (0..organs.len())
            .filter(|&i| organs.shape(i).unwrap().kind == kind)
            .map(|i| organs.placed.positions[i])
            .collect::<Vec<_>>()
    };
    let blossom = "[[foliage.also]]\nleaf_form = \"cross\"\nleaf_outline = \"blossom\"\nleaf_jitter = 0\n";
    let both = grown(&recipe(&format!("{first}\n{blossom}share = 0.25")), &tree);
    assert_eq!(both.len(), alone.len());
    assert!(both.placed.positions == alone.placed.positions);
    let share = kinds(&both, 1).len() as f64 / both.len() as f64;
    assert!((share - 0.25).abs() < 0.02, "{share}");
    let apart = grown(&recipe(&format!("{first}\n{blossom}leaves_per_m = 10\nleaf_terminal = false")), &tree);
    assert!(kinds(&apart, 0) == alone.placed.positions);
    assert!((kinds(&apart, 1).len() as f64 / 1600.0 - 1.0).abs() < 0.05);
    // Blossom without leaves: places of a kind that has no form.
    let bare = grown(&recipe(&format!("{blossom}share = 0.25")), &tree);
    assert!(bare.placed.positions == kinds(&both, 1));
}

#[test]
fn a_grid_stands_on_every_segment() {
    let tree = twigs(3, 5);
    let organs = grown(&recipe("leaf_form = \"card\"\nleaf_grid = [4, 3]"), &tree);
    assert_eq!(organs.len(), 3 * 5 * 4 * 3);
    assert_eq!(grown(&recipe("leaf_form = \"card\"\nleaf_grid = [2]"), &tree).len(), 3 * 5 * 2);
}

const FORMS: [&str; 6] = ["card", "cross", "curved", "twig", "fan", "tuft"];

#[test]
fn every_form_is_a_sound_mesh_of_one_unit() {
    let tree = twigs(1, 1);
    for form in FORMS {
        for outline in ["ovate", "lobed", "palmate", "pine", "blossom"] {
            let subject =
                recipe(&format!("leaf_form = \"{form}\"\nleaf_outline = \"{outline}\"\nleaf_size = 64"));
            let organs = grown(&subject, &tree);
            assert_eq!(organs.shapes.len(), 4, "{form}");
            for shape in organs.shapes.iter() {
                for mesh in [&shape.mesh, &shape.sketch] {
                    assert!(!mesh.triangles.is_empty(), "{form}");
                    for triangle in &mesh.triangles {
                        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
                        let normal = (b - a).cross(c - a);
                        assert!(normal.length() > 1e-7, "{form} {outline}: a triangle without area");
                        for &v in triangle {
                            assert!(
                                mesh.normals[v as usize].dot(normal) > 0.0,
                                "{form}: winding and normals"
                            );
                        }
                    }
                    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{form}");
                    let outside = mesh.uvs.iter().find(|uv| uv.min_element() < 0.0 || uv.max_element() > 1.0);
                    assert!(outside.is_none(), "{form} {outline}: {outside:?}");
                }
                let bounds = shape.mesh.bounds().unwrap();
                assert!((0.7..1.2).contains(&bounds.max.y), "{form} {outline}: {bounds:?}");
                assert!(bounds.min.y > -0.6, "{form} {outline}: {bounds:?}");
            }
        }
    }
}

/// Mean of triangles' areas times normals tells which side is up.
#[test]
fn blades_show_their_upper_side() {
    let tree = twigs(1, 1);
    for form in ["card", "curved", "twig", "fan"] {
        let organs = grown(&recipe(&format!("leaf_form = \"{form}\"")), &tree);
        let mesh = &organs.shapes[0].mesh;
        let sum: Vec3 = mesh.normals.iter().copied().sum();
        assert!(sum.normalize().z > 0.7, "{form}");
    }
}

#[test]
fn meshes_hold_every_leaf_where_it_is() {
    let tree = bent(1);
    let subject = recipe(
        "leaf_form = \"curved\"\nleaf_jitter = 40\nleaves_per_m = 3000\n[[foliage.also]]\nleaf_form = \"fan\"\nshare = 0.3",
    );
    let organs = grown(&subject, &tree);
    assert!(organs.len() > 4096, "several tasks");
    let all = meshes(&organs, 1, &Quiet).unwrap();
    assert_eq!(all.iter().map(|foliage| foliage.look).collect::<Vec<_>>(), [Look::Kind(0), Look::Kind(1)]);
    let (vertices, triangles) = organs.amount();
    assert_eq!(all.iter().map(|foliage| foliage.mesh.positions.len() as u64).sum::<u64>(), vertices);
    assert_eq!(all.iter().map(|foliage| foliage.mesh.triangles.len() as u64).sum::<u64>(), triangles);
    // One after the other, by the definition.
    for foliage in &all {
        let Look::Kind(kind) = foliage.look else { panic!("no grammar here") };
        let (mut at, mut corner) = (0, 0);
        for organ in (0..organs.len()).filter(|&i| usize::from(organs.shape(i).unwrap().kind) == kind) {
            let mesh = organs.mesh(organ);
            for (i, &local) in mesh.positions.iter().enumerate() {
                assert!(foliage.mesh.positions[at + i].distance(organs.place(organ, local)) < 1e-6);
                assert!(foliage.mesh.normals[at + i].distance(organs.turn(organ, mesh.normals[i])) < 1e-5);
                assert_eq!(foliage.mesh.uvs[at + i], mesh.uvs[i]);
            }
            for triangle in &mesh.triangles {
                assert_eq!(foliage.mesh.triangles[corner], triangle.map(|v| v + at as u32));
                corner += 1;
            }
            at += mesh.positions.len();
        }
        assert_eq!((at, corner), (foliage.mesh.positions.len(), foliage.mesh.triangles.len()));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_leaves() {
    let tree = twigs(1500, 6);
    let subject =
        recipe("leaf_form = \"curved\"\nleaf_jitter = 40\nleaf_normals = \"dome\"\nleaf_size_spread = 0.4");
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let organs = grown(&subject, &tree);
            let meshes = meshes(&organs, 1, &Quiet).unwrap();
            (organs, meshes)
        })
    };
    let one = on(1);
    assert!(one.0.len() > 30_000);
    assert!(one == on(3));
}

#[test]
fn instances_expand_to_what_is_baked() {
    let tree = twigs(20, 6);
    let mut subject =
        recipe("leaf_form = \"curved\"\nleaf_jitter = 40\nleaf_size_spread = 0.4\nleaf_up = -0.3");
    subject.recipe.preset.set_seed(5);
    let organs = grown(&subject, &tree);
    let baked = &meshes(&organs, 1, &Quiet).unwrap()[0];
    let dressed = DressedOrgans::new(Arc::clone(&organs), Arc::clone(&organs.shapes), Vec::new(), &[]);
    let instances = Instances::of(&dressed, baked.look);
    let copies = instances.copies();
    assert_eq!(copies.len(), organs.shapes.len());
    assert!(copies.len() > 1 && !instances.has_dome_normals());
    // Each variant's leaves in their order, as the baked ones are in that of all.
    let mut next = vec![0; copies.len()];
    let (mut vertex, mut triangle) = (0, 0);
    for &prototype in &organs.placed.prototypes {
        let variant = usize::from(prototype) - PROTOTYPES.len();
        let Copies { mesh, placements, .. } = &copies[variant];
        let placement = placements[next[variant]];
        next[variant] += 1;
        for (i, (&point, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
            let at = vertex + i;
            assert!(placement.point(point).distance(baked.mesh.positions[at]) < 2e-5);
            assert!((placement.rotation * normal).distance(baked.mesh.normals[at]) < 2e-6);
            assert_eq!(mesh.uvs[i], baked.mesh.uvs[at]);
        }
        for corners in &mesh.triangles {
            assert_eq!(corners.map(|v| v + vertex as u32), baked.mesh.triangles[triangle]);
            triangle += 1;
        }
        vertex += mesh.positions.len();
    }
    assert_eq!(vertex, baked.mesh.positions.len());
    assert!(copies.iter().zip(next).all(|(mesh_copies, count)| mesh_copies.placements.len() == count));
    let names: BTreeSet<&str> = copies.iter().map(|mesh_copies| mesh_copies.name.as_str()).collect();
    assert_eq!(names.len(), copies.len());
}

#[test]
fn dome_normals_and_the_fronts_of_leaves_point_out_of_the_crown() {
    let tree = twigs(300, 6);
    let subject = recipe("leaf_form = \"card\"\nleaf_jitter = 90\nleaf_normals = \"dome\"");
    let organs = grown(&subject, &tree);
    let mesh = &meshes(&organs, 1, &Quiet).unwrap()[0].mesh;
    let bounds = linden_base::mesh::Bounds::of(organs.placed.positions.iter().copied()).unwrap();
    let center = bounds.min.midpoint(bounds.max);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let face = (b - a).cross(c - a).normalize();
        let out = (a - center).normalize();
        let normal = mesh.normals[triangle[0] as usize];
        // Renderers turn the normals of backs round: what is seen from outside are fronts.
        assert!((normal.length() - 1.0).abs() < 1e-5 && normal.dot(out) > 0.5, "{}", normal.dot(out));
        assert!(face.dot(normal) > 0.0 && face.dot(out) > -0.3, "{face} {normal} {out}");
    }
}

/// A pyramid two metres high on y = 1.
const PYRAMID: &str = "v 0 1 0\nv 1 1 0\nv 0 1 1\nv 0 3 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn with_mesh(text: &str) -> Subject {
    let mut subject =
        recipe("leaf_form = \"mesh\"\nleaf_mesh = \"a.obj\"\nleaf_colors = [\"#ff0000\", \"#00ff00\"]");
    subject.recipe.inputs.insert("a.obj", Input::read("a.obj", text.as_bytes(), &Quiet).unwrap());
    subject
}

#[test]
fn a_mesh_of_the_users_stands_on_its_foot_one_unit_high() {
    let organs = grown(&with_mesh(PYRAMID), &twigs(1, 3));
    assert_eq!(organs.shapes.len(), 2, "a variant for each colour");
    let mesh = &organs.shapes[0].mesh;
    assert_eq!(mesh.positions[0], Vec3::ZERO);
    assert_eq!(mesh.positions[3], Vec3::Y);
    assert_eq!(mesh.positions[1], Vec3::X / 2.0);
    let recipe = with_mesh(PYRAMID);
    let first = &recipe.dressing.foliage.first;
    let cover = recipe.with(|specimen| cover(specimen, 0, first, 64, &Quiet)).unwrap();
    assert_eq!(cover.cutout, None);
    let pixel = |cell: &crate::texture::leaf::Cell| {
        let at = (cell.min + cell.max) / 2.0;
        let (w, h) = (cover.base_color.width() as f32, cover.base_color.height() as f32);
        let i = ((1.0 - at.y) * h) as usize * w as usize + (at.x * w) as usize;
        cover.base_color.rgba().as_chunks::<4>().0[i]
    };
    assert_eq!(cover.cells.iter().map(pixel).collect::<Vec<_>>(), [[255, 0, 0, 255], [0, 255, 0, 255]]);
}

#[test]
fn a_mesh_that_lies_on_its_side_is_noted() {
    let blade = |text: &str| {
        let input = Input::read("a.obj", text.as_bytes(), &Quiet).unwrap();
        match input.geometry {
            linden_base::input::Geometry::Mesh(mesh) => mesh_note("a.obj", &mesh),
            _ => panic!("no mesh"),
        }
    };
    // Along Z, as Blender has it before its exporter turns it.
    let lying = blade("v -0.2 0 0\nv 0.2 0 0\nv 0 0.1 1\nf 1 2 3\n").unwrap();
    assert!(
        lying.starts_with("leaf_mesh: 'a.obj'") && lying.contains("10.0 times as long along Z"),
        "{lying}"
    );
    assert_eq!(blade("v -0.2 0 0\nv 0.2 0 0\nv 0 1 0.1\nf 1 2 3\n"), None);
    // A bowl is wider than high, and may be meant so.
    assert_eq!(blade("v -0.5 0 0\nv 0.5 0 0\nv 0 0.5 0.5\nf 1 2 3\n"), None);
}

#[test]
fn what_is_wrong_with_a_leafs_file_is_said() {
    let tree = twigs(1, 3);
    let said = |subject: &Subject| sprout(subject, &tree, &Arc::default(), &Quiet).unwrap_err().to_string();
    assert!(said(&recipe("leaf_form = \"mesh\"")).contains("leaf_mesh = "));
    assert!(
        said(&recipe("leaf_form = \"mesh\"\nleaf_mesh = \"a.obj\""))
            .contains("'a.obj', which must hold a mesh")
    );
    assert!(
        said(&recipe("leaf_form = \"card\"\nleaf_picture = \"a.png\""))
            .contains("'a.png', which must hold a picture")
    );
    assert!(said(&with_mesh("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")).contains("no height"));
    let many = format!("{PYRAMID}{}", "f 1 2 4\n".repeat(20_000));
    assert!(said(&with_mesh(&many)).contains("20004 triangles, more than the limit of 20000"));
    let error = Input::read("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", &Quiet).unwrap_err().to_string();
    assert!(error.contains("no faces"), "{error}");
    let error = Input::read("a.png", b"\x89PNG\r\n\x1a\nnonsense", &Quiet).unwrap_err().to_string();
    assert!(error.contains("PNG"), "{error}");
}

/// Grants eight mebibytes.
struct Small;
impl Monitor for Small {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: linden_base::monitor::Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        8 << 20
    }
}

#[test]
fn too_many_leaves_are_refused_before_they_grow() {
    let tree = twigs(2000, 10);
    let subject = recipe("leaf_form = \"card\"\nleaves_per_m = 100000");
    let error = sprout(&subject, &tree, &Arc::default(), &Quiet).unwrap_err();
    assert!(matches!(error, FoliageError::TooMany { .. }), "{error}");
    let subject = recipe("leaf_form = \"card\"\nleaves_per_m = 1000");
    let error = sprout(&subject, &tree, &Arc::default(), &Small).unwrap_err();
    assert!(matches!(error, FoliageError::Memory(_)), "{error}");
}

#[test]
fn leaves_of_a_grammar_take_the_form_of_the_first_kind() {
    let text = "id = \"a\"\n[lsystem]\naxiom = \"F~LF~BF\"\nrules = []\n[foliage]\nleaf_size = 32\nleaves_per_m = 0\nleaf_terminal = false\n";
    let grow = |more: &str| {
        let preset = Preset::from_toml(&format!("{text}{more}")).unwrap();
        linden_pipeline::grow::grow(&Recipe::new(preset), &Quiet).unwrap()
    };
    let (plain, formed) = (grow(""), grow("leaf_form = \"cross\""));
    assert_eq!(plain.skeleton, formed.skeleton);
    assert_eq!(plain.organs, plain.given);
    assert_eq!(formed.given, plain.given);
    assert_eq!(formed.organs.shape(0).map(|shape| shape.kind), Some(0));
    assert!(formed.organs.shape(1).is_none(), "a berry stays one");
    assert_eq!(formed.organs.placed.positions, plain.organs.placed.positions);
}

#[test]
fn leaves_of_weber_and_penn_are_there_only_with_a_form() {
    let grow = |foliage: &str| {
        let text = format!(
            "id = \"a\"\n[weber-penn]\nlevels = 2\nleaves = 12\n[foliage]\nleaf_size = 32\nleaves_per_m = 0\n\
             leaf_terminal = false\n{foliage}"
        );
        let preset = Preset::from_toml(&text).unwrap();
        linden_pipeline::grow::grow(&Recipe::new(preset), &Quiet).unwrap()
    };
    let (bare, formed) = (grow("leaf_form = \"none\""), grow("leaf_form = \"card\""));
    assert_eq!(bare.given, formed.given);
    assert_eq!(bare.organs.len(), 0);
    assert!(formed.organs.len() > 10, "{}", formed.organs.len());
    assert_eq!(formed.organs.len(), formed.given.len());
    let other = grow(
        "[[foliage.also]]\nname = \"b\"\nleaf_form = \"card\"\nleaves_per_m = 20\nleaf_max_radius = 5\nleaf_terminal = false",
    );
    assert!(!other.organs.is_empty());
    let mut kinds = (0..other.organs.len()).map(|organ| other.organs.shape(organ).map(|shape| shape.kind));
    assert!(kinds.all(|kind| kind == Some(1)), "only the further kind");
}

#[test]
fn the_azimuth_of_a_spiral_is_exact_far_along() {
    let kind = crate::settings::LeafKind::default();
    let spiral = super::pose::Phyllotaxis::of(&kind);
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    for node in [0, 1, 7, 1000, 1_000_000] {
        let exact = (node as f64 * golden).rem_euclid(2.0 * PI);
        assert!((f64::from(spiral.azimuth(node, 0)) - exact).abs() < 0.2, "{node}");
    }
}

#[test]
fn no_knob_of_leaves_changes_the_wood() {
    use linden_base::knob::Kind;
    use linden_pipeline::grow::{GrowError, grow};
    use linden_pipeline::preset::{KNOBS, Section, builtin};
    let mut preset = builtin("sphere").unwrap().load().unwrap();
    for (knob, value) in [("points", "60"), ("leaf_form", "card"), ("leaf_size", "32"), ("leaves_per_m", "5")]
    {
        preset.set(knob, value).unwrap();
    }
    let hash = |preset: &Preset| {
        let recipe = Recipe::new(preset.clone());
        match grow(&recipe, &Quiet) {
            Ok(grown) => Some(grown.skeleton.hash()),
            // The mesh that is not there, and far too many leaves.
            Err(GrowError::Foliage(_)) => None,
            Err(other) => panic!("{other}"),
        }
    };
    let wood = hash(&preset).unwrap();
    let mut turned = 0;
    for knob in KNOBS.iter().filter(|knob| knob.section == Section::Foliage) {
        let values = match knob.knob.kind {
            Kind::Choice(words) => words.iter().map(|&word| word.to_owned()).collect(),
            Kind::Switch => vec!["true".to_owned(), "false".to_owned()],
            Kind::Real { min, max, .. } => vec![min.to_string(), (min + (max - min) * 0.1).to_string()],
            Kind::Integer { min, max } => vec![(min + 1).to_string(), (min + 20).min(max).to_string()],
            Kind::Reals { max, .. } => vec![if max < 3.0 { "0.2 0.6" } else { "2 3" }.to_owned()],
            Kind::Colors { .. } => vec!["#123456 #abcdef".to_owned()],
            Kind::Sequence { words, .. } => vec![words.join(" ")],
            other => panic!("a value of {other:?}"),
        };
        for value in values {
            let mut other = preset.clone();
            other.set(knob.knob.name, &value).unwrap();
            if let Some(hash) = hash(&other) {
                assert_eq!(hash, wood, "{}={value}", knob.knob.name);
                turned += 1;
            }
        }
    }
    assert!(turned > 60, "{turned}");
}
