//! Where leaves stand on the wood, and how they lie.

use std::f64::consts::PI;

use super::*;

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
fn a_grid_stands_on_every_segment() {
    let tree = twigs(3, 5);
    let organs = grown(&recipe("leaf_form = \"card\"\nleaf_grid = [4, 3]"), &tree);
    assert_eq!(organs.len(), 3 * 5 * 4 * 3);
    assert_eq!(grown(&recipe("leaf_form = \"card\"\nleaf_grid = [2]"), &tree).len(), 3 * 5 * 2);
}

#[test]
fn the_azimuth_of_a_spiral_is_exact_far_along() {
    let kind = crate::settings::LeafKind::default();
    let spiral = pose::Phyllotaxis::of(&kind);
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    for node in [0, 1, 7, 1000, 1_000_000] {
        let exact = (node as f64 * golden).rem_euclid(2.0 * PI);
        assert!((f64::from(spiral.azimuth(node, 0)) - exact).abs() < 0.2, "{node}");
    }
}
