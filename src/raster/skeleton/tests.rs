use glam::{Vec2, Vec3};
use linden_pipeline::picture::Picture;
use linden_pipeline::skeleton::Axis;
use linden_pipeline::{Monitor, NO_PARENT, Quiet, Skeleton};

use super::sample::stem;
use super::{draw_skeleton, sample};
use crate::strokes::trace::HAIR_PX;
use crate::{Background, Camera, Extent, MAX_SIDE, Paint, RasterError, Size, Style};

fn size(width: u32, height: u32) -> Size {
    Size::new(width, height).unwrap()
}

fn draw(skeleton: &Skeleton, camera: &Camera, style: &Style, size: Size) -> Picture {
    draw_skeleton(skeleton, camera, style, size, &Quiet).unwrap()
}

fn alpha(picture: &Picture, x: u32, y: u32) -> u8 {
    picture.rgba()[((y * picture.width() + x) * 4 + 3) as usize]
}

/// The summed coverage of a row, pixels.
fn ink(picture: &Picture, y: u32) -> f32 {
    (0..picture.width()).map(|x| f32::from(alpha(picture, x, y)) / 255.0).sum()
}

#[test]
fn a_thick_stem_covers_what_geometry_says() {
    let thick = stem(&[(Vec3::ZERO, 0.5), (Vec3::new(0.0, 4.0, 0.0), 0.5)]);
    let (w, h) = (200, 300);
    let camera = Camera::front();
    let picture = draw(&thick, &camera, &Style::over_dark(), size(w, h));
    // Independent of the outline code: a pixel's middle is inside where its ray passes the stem's
    // axis closer than the radius. Similar triangles, in the plane of the axis.
    let view = camera.view(Extent::of(&thick, &[]).unwrap(), size(w, h));
    let (foot, head) = (view.project(Vec3::ZERO), view.project(Vec3::Y * 4.0));
    let metres_per_px = 4.0 / foot.at.distance(head.at);
    let mut inside = 0;
    for y in 0..h {
        for x in 0..w {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let away_m = (p.x - foot.at.x).abs() * metres_per_px;
            // Above the head the stroke ends in a half disc.
            let over_m = ((head.at.y - p.y) * metres_per_px).max(0.0);
            let from_edge_px = (0.5 - away_m.hypot(over_m)) / metres_per_px;
            let above_foot_px = foot.at.y - p.y;
            let expected = from_edge_px.min(above_foot_px);
            if expected > 1.0 {
                assert_eq!(alpha(&picture, x, y), 255, "{x} {y} is inside");
                inside += 1;
            } else if expected < -1.0 {
                assert_eq!(alpha(&picture, x, y), 0, "{x} {y} is outside");
            }
        }
    }
    assert!(inside > 10_000, "the stem should fill much of the picture: {inside}");
}

#[test]
fn width_follows_the_radius() {
    let cone = stem(&[(Vec3::ZERO, 0.4), (Vec3::Y * 2.0, 0.2), (Vec3::Y * 4.0, 0.1)]);
    let picture = draw(&cone, &Camera::front(), &Style::over_dark(), size(200, 400));
    let view = Camera::front().view(Extent::of(&cone, &[]).unwrap(), size(200, 400));
    for (y_m, radius_m) in [(0.5, 0.35), (1.0, 0.3), (1.5, 0.25), (3.0, 0.15), (3.5, 0.125)] {
        let p = view.project(Vec3::Y * y_m);
        let expected = 2.0 * radius_m * p.scale;
        let found = ink(&picture, p.at.y as u32);
        assert!((found - expected).abs() < 0.05 * expected + 0.5, "{y_m} m: {found} px, not {expected}");
    }
}

#[test]
fn a_hair_fades_but_stays() {
    let mut last = f32::INFINITY;
    for radius in [1e-2, 4e-3, 2e-3, 1e-3, 3e-4] {
        let picture = draw(
            &stem(&[(Vec3::ZERO, radius), (Vec3::Y, radius)]),
            &Camera::front(),
            &Style::over_dark(),
            size(50, 50),
        );
        let found = ink(&picture, 25);
        assert!(found > 0.01 && found < last, "radius {radius}: {found}, before {last}");
        last = found;
    }
    assert!(last < HAIR_PX / 4.0);
}

#[test]
fn the_whole_tree_stays_in_the_frame() {
    let tree = sample::tree(3, 2);
    for (w, h) in [(90, 120), (160, 60)] {
        for yaw in [0.0, 37.0, 90.0, 200.0, 333.0] {
            for pitch in [-80.0, -20.0, 0.0, 8.0, 30.0, 60.0, 90.0] {
                let picture = draw(&tree, &Camera::orbit(yaw, pitch), &Style::over_dark(), size(w, h));
                let rim = (0..w)
                    .flat_map(|x| [(x, 0), (x, h - 1)])
                    .chain((0..h).flat_map(|y| [(0, y), (w - 1, y)]));
                for (x, y) in rim {
                    assert_eq!(alpha(&picture, x, y), 0, "{w}x{h} yaw {yaw} pitch {pitch}: {x} {y}");
                }
                assert!((0..h).map(|y| ink(&picture, y)).sum::<f32>() > 50.0);
            }
        }
    }
}

#[test]
fn an_internode_across_rings_stays_in_the_frame() {
    // The middle of the long internode lies at heights where only the thin stem has nodes.
    let mut gallows = stem(&[(Vec3::ZERO, 0.05), (Vec3::Y * 2.5, 0.05), (Vec3::Y * 5.0, 0.05)]);
    gallows.positions.push(Vec3::new(4.0, 0.0, 0.0));
    gallows.parents.push(2);
    gallows.radii.push(0.05);
    gallows.births.push(3);
    gallows.axes.push(Axis { order: 1, parent: 2, first: 3, len: 1 });
    gallows.axis_nodes.push(3);
    for yaw in [0.0, 45.0, 180.0] {
        let picture = draw(&gallows, &Camera::orbit(yaw, 10.0), &Style::over_dark(), size(60, 100));
        assert!((0..100).all(|y| alpha(&picture, 0, y) == 0 && alpha(&picture, 59, y) == 0), "{yaw}");
    }
}

#[test]
fn the_same_bytes_again() {
    let tree = sample::tree(5, 2);
    let once = || draw(&tree, &Camera::default(), &Style::studio(), size(120, 160));
    assert_eq!(once(), once());
}

#[test]
fn tiles_show_no_seam() {
    // Wider than one tile of 2048 drawn pixels at twice the size: the same tree in a frame that is
    // one tile wide must have the same pixels where both show it.
    let tree = sample::tree(5, 2);
    let extent = Extent::of(&tree, &[]);
    let camera = Camera { extent, ..Camera::default() };
    let wide = draw(&tree, &camera, &Style::over_dark(), size(2000, 400));
    let seam = 1024 * 4;
    // The stroke pieces left and right of the seam are covered alike: no column is empty or doubled.
    let column = |x: usize| -> f32 {
        wide.rgba().chunks_exact(2000 * 4).map(|row| f32::from(row[x * 4 + 3])).sum::<f32>() / 255.0
    };
    let (left, right) = (column(seam / 4 - 1), column(seam / 4));
    let inside = (column(seam / 4 - 2), column(seam / 4 + 1));
    assert!((left - right).abs() <= 3.0 + (inside.0 - inside.1).abs(), "{left} {right} {inside:?}");
    assert!(left > 0.0 && right > 0.0, "the seam should cut the tree");
}

#[test]
fn what_is_nearer_hides_what_is_farther() {
    // Two stems with the colours of their orders, one behind the other, seen from both sides.
    let near = Vec3::new(0.0, 0.0, 1.0);
    let mut pair = stem(&[(near, 0.3), (near + Vec3::Y * 3.0, 0.3)]);
    let other = stem(&[(-near, 0.3), (-near + Vec3::Y * 3.0, 0.3)]);
    pair.positions.extend(other.positions);
    pair.parents.extend([NO_PARENT, 2]);
    pair.radii.extend(other.radii);
    pair.births.extend([9, 9]);
    pair.axes.push(Axis { order: 0, parent: NO_PARENT, first: 2, len: 2 });
    pair.axis_nodes.extend([2, 3]);
    let style = Style { paint: Paint::Birth, haze_amount: 0.0, ..Style::over_dark() };
    let middle = |yaw| {
        let p = draw(&pair, &Camera::orbit(yaw, 0.0), &style, size(60, 60));
        let at = (30 * 60 + 30) * 4;
        [p.rgba()[at], p.rgba()[at + 2]].map(i32::from)
    };
    let ([red_near, blue_near], [red_far, blue_far]) = (middle(0.0), middle(180.0));
    assert!(blue_near > red_near && red_far > blue_far, "early is blue, late is yellow");
}

#[test]
fn transparent_where_nothing_is_and_opaque_over_a_backdrop() {
    let tree = sample::tree(1, 1);
    let clear = draw(&tree, &Camera::front(), &Style::over_light(), size(40, 40));
    assert_eq!(&clear.rgba()[..4], &[0; 4]);
    let plain = Style { background: Background::Plain([10, 200, 30]), ..Style::over_light() };
    let picture = draw(&tree, &Camera::front(), &plain, size(40, 40));
    assert!(picture.rgba().chunks_exact(4).all(|p| p[3] == 255));
    for (c, expected) in picture.rgba()[..3].iter().zip([10_u8, 200, 30]) {
        assert!(c.abs_diff(expected) <= 1, "{c} {expected}");
    }
}

#[test]
fn a_tubes_area_is_what_geometry_says() {
    // Leaning tubes of many widths, hairs among them: the silhouette is a quadrilateral and a half
    // disc at the tip.
    for radius in [0.02_f32, 0.08, 0.3, 0.5] {
        for lean in [0.0_f32, 0.3, 1.7, 4.0] {
            let tip = Vec3::new(lean, 4.0, 0.0);
            let tube = stem(&[(Vec3::ZERO, radius), (tip / 2.0, radius), (tip, radius)]);
            let camera = Camera::front();
            let picture = draw(&tube, &camera, &Style::over_dark(), size(200, 240));
            let view = camera.view(Extent::of(&tube, &[]).unwrap(), size(200, 240));
            let (foot, tip) = (view.project(Vec3::ZERO), view.project(tip));
            let width = radius * (foot.scale + tip.scale);
            let cap = std::f32::consts::PI * width * width / 8.0;
            let expected = foot.at.distance(tip.at) * width + if width > 2.5 { cap } else { 0.0 };
            let found: f32 = (0..240).map(|y| ink(&picture, y)).sum();
            assert!((found / expected - 1.0).abs() < 0.012, "{radius} {lean}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_line_of_many_nodes_looks_like_one_of_two() {
    for radius in [0.004, 0.012, 0.03, 0.4] {
        let node = |i: u32, n: u32| (Vec3::new(0.7, 5.0, -2.0) * (i as f32 / n as f32), radius);
        let [two, many] = [1, 700].map(|n| stem(&(0..=n).map(|i| node(i, n)).collect::<Vec<_>>()));
        let [two, many] =
            [two, many].map(|s| draw(&s, &Camera::default(), &Style::over_dark(), size(90, 300)));
        let places = (0..300).flat_map(|y| (0..90).map(move |x| (x, y)));
        let most = places.map(|(x, y)| (alpha(&two, x, y).abs_diff(alpha(&many, x, y)), x, y)).max();
        // At the edge of a seam between two runs a fifth may be too much.
        assert!(most <= Some((56, 90, 300)), "{radius}: {most:?}");
        let [two, many] = [two, many].map(|p| (0..300).map(|y| ink(&p, y)).sum::<f32>());
        assert!((two / many - 1.0).abs() < 0.01, "{radius}: {two} {many}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let tree = sample::tree(5, 3);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw(&tree, &Camera::default(), &Style::studio(), size(120, 200)))
    };
    let one = with(1);
    assert!([2, 3, 8].into_iter().all(|threads| with(threads) == one));
}

/// Rows of the column range in which anything is.
fn rows_with(picture: &Picture, columns: std::ops::Range<u32>) -> Vec<u32> {
    (0..picture.height()).filter(|&y| columns.clone().any(|x| alpha(picture, x, y) > 127)).collect()
}

#[test]
fn the_person_is_as_tall_as_a_person() {
    let tree = stem(&[(Vec3::ZERO, 0.1), (Vec3::Y * 9.0, 0.05)]);
    let style = Style { person: true, ..Style::over_dark() };
    for (w, h) in [(60, 90), (300, 500)] {
        for yaw in [0.0, 77.0, 200.0] {
            let camera = Camera::orbit(yaw, 0.0);
            let picture = draw(&tree, &camera, &style, size(w, h));
            let extent = style.extent(&tree).unwrap();
            assert!(extent.person.is_some());
            let view = camera.view(extent, size(w, h));
            let trunk = view.project(Vec3::ZERO).at.x;
            let right = (trunk + 0.2 * view.scale_at_target()).ceil() as u32;
            let rows = rows_with(&picture, right..w);
            let expected = 1.75 * view.scale_at_target();
            assert!(
                (rows.len() as f32 - expected).abs() <= 1.5,
                "{w}x{h}: {} px, not {expected}",
                rows.len()
            );
            // The feet are on the tree's ground.
            let ground = view.project(Vec3::ZERO).at.y;
            assert!((*rows.last().unwrap() as f32 + 1.0 - ground).abs() <= 1.5);
            // Nobody is cut off.
            assert!((0..h).all(|y| alpha(&picture, w - 1, y) == 0));
        }
    }
}

#[test]
fn tiny_plants_have_no_person() {
    let style = Style { person: true, ..Style::over_dark() };
    for (height_m, expected) in [(0.3, false), (0.5, false), (0.7, true), (3.0, true)] {
        let plant = stem(&[(Vec3::ZERO, 0.01), (Vec3::Y * height_m, 0.01)]);
        let extent = style.extent(&plant).unwrap();
        assert_eq!(extent.person.is_some(), expected, "{height_m} m");
        // Taken into the frame where there is one, and the frame is the plant's where there is none.
        let top_m = if expected { f32::max(1.75, height_m) } else { height_m };
        assert!((extent.top - top_m).abs() < 0.02);
        let lone = Style::over_dark();
        let same = draw(&plant, &Camera::front(), &style, size(40, 60))
            == draw(&plant, &Camera::front(), &lone, size(40, 60));
        assert_eq!(same, !expected);
    }
}

#[test]
fn the_outline_is_framed_and_dimmer_behind() {
    let tree = stem(&[(Vec3::ZERO, 0.02), (Vec3::Y * 2.0, 0.02)]);
    let line = |z: f32| vec![Vec3::new(-3.0, 1.0, z), Vec3::new(3.0, 1.0, z)];
    let lines = [line(3.0), line(-3.0)];
    let style = Style { outline: &lines, haze_amount: 0.0, ..Style::over_dark() };
    let (w, h) = (120, 80);
    let camera = Camera::orbit(0.0, 10.0);
    let picture = draw(&tree, &camera, &style, size(w, h));
    let view = camera.view(style.extent(&tree).unwrap(), size(w, h));
    let at = |z: f32| {
        let p = view.project(Vec3::new(1.0, 1.0, z)).at;
        // The line may lie between two rows.
        let rows = [p.y - 1.0, p.y, p.y + 1.0].map(|y| u32::from(alpha(&picture, p.x as u32, y as u32)));
        rows.iter().sum::<u32>()
    };
    assert!(at(3.0) > at(-3.0) + 20 && at(-3.0) > 20, "{} {}", at(3.0), at(-3.0));
    let rim = (0..w).flat_map(|x| [(x, 0), (x, h - 1)]).chain((0..h).flat_map(|y| [(0, y), (w - 1, y)]));
    for (x, y) in rim {
        assert_eq!(alpha(&picture, x, y), 0, "{x} {y}");
    }
    // Turned round, the other one is in front: still in the frame.
    let turned = draw(&tree, &Camera::orbit(137.0, 10.0), &style, size(w, h));
    assert!((0..h).all(|y| alpha(&turned, 0, y) == 0 && alpha(&turned, w - 1, y) == 0));
}

#[test]
fn until_a_step_nothing_later_is_drawn_and_the_frame_stays() {
    let mut tree = sample::tree(5, 2);
    for births in [false, true] {
        if births {
            // Births that do not rise: what stands on nothing is not drawn either.
            for (i, birth) in tree.births.iter_mut().enumerate() {
                *birth = (i as u32).wrapping_mul(2_654_435_761) >> 28;
            }
        }
        let step = 9;
        let there = tree.born_by(step);
        // What is gone has no width, which draws nothing.
        let mut rest = tree.clone();
        for axis in &mut rest.axes {
            let nodes = &tree.axis_nodes[axis.first as usize..(axis.first + axis.len) as usize];
            axis.len = nodes.iter().take_while(|&&n| there[n as usize]).count() as u32;
        }
        let style = Style { until: Some(step), ..Style::over_dark() };
        let young = draw(&tree, &Camera::default(), &style, size(80, 100));
        assert_eq!(young, draw(&rest, &Camera::default(), &Style::over_dark(), size(80, 100)));
        let whole = Style { until: Some(u32::MAX), ..style };
        let full = draw(&tree, &Camera::default(), &Style::over_dark(), size(80, 100));
        assert_eq!(draw(&tree, &Camera::default(), &whole, size(80, 100)), full);
        assert_ne!(young, full);
    }
}

#[test]
fn a_draft_looks_like_the_tree() {
    let tree = sample::tree(2, 4);
    assert!(tree.positions.len() > 100_000);
    let draft = Style { draft: true, ..Style::over_dark() };
    for yaw in [0.0, 50.0] {
        let camera = Camera::orbit(yaw, 8.0);
        let full = draw(&tree, &camera, &Style::over_dark(), size(64, 72));
        let quick = draw(&tree, &camera, &draft, size(64, 72));
        // Blocks of 8 × 8 pixels are as full.
        for by in 0..9 {
            for bx in 0..8 {
                let block = |p: &Picture| -> f32 {
                    let inside = (0..64).map(|i| alpha(p, bx * 8 + i % 8, by * 8 + i / 8));
                    inside.map(|a| f32::from(a) / 255.0).sum::<f32>() / 64.0
                };
                let (a, b) = (block(&full), block(&quick));
                assert!((a - b).abs() < 0.15, "yaw {yaw}, block {bx} {by}: {a} {b}");
            }
        }
    }
}

#[test]
fn points_are_dots() {
    let one = stem(&[(Vec3::ZERO, 0.01), (Vec3::Y, 0.01)]);
    let points = [Vec3::new(0.5, 0.5, 0.0)];
    let style = Style { points: &points, point: [255, 0, 0], haze_amount: 0.0, ..Style::over_dark() };
    let picture = draw(&one, &Camera::front(), &style, size(400, 400));
    let at = Camera::front().view(Extent::of(&one, &points).unwrap(), size(400, 400)).project(points[0]).at;
    let start = ((at.y as u32 * 400 + at.x as u32) * 4) as usize;
    let [r, g, _, a] = picture.rgba()[start..start + 4] else { panic!() };
    assert!(r > 200 && g < 40 && a > 100, "{r} {g} {a}");
}

#[test]
fn degenerate_skeletons_are_drawn() {
    let at = Vec3::new(2.0, 3.0, 4.0);
    let cases = [
        ("one node", stem(&[(at, 0.1)])),
        ("all in one place", stem(&[(at, 0.1), (at, 0.1), (at, 0.05)])),
        ("without any width", stem(&[(at, 0.0), (at, 0.0)])),
        ("a horizontal line", stem(&[(Vec3::ZERO, 0.1), (Vec3::X * 9.0, 0.1)])),
        ("toward the lens", stem(&[(Vec3::ZERO, 0.1), (Vec3::Z * 9.0, 0.1)])),
        ("huge", stem(&[(Vec3::ZERO, 1e3), (Vec3::Y * 1e7, 1e2)])),
        ("tiny", stem(&[(Vec3::ZERO, 1e-7), (Vec3::Y * 1e-6, 1e-7)])),
    ];
    for (name, skeleton) in cases {
        for (w, h) in [(1, 1), (1, 50), (33, 20)] {
            let picture = draw(&skeleton, &Camera::default(), &Style::studio(), size(w, h));
            assert_eq!(picture.rgba().len(), (w * h * 4) as usize, "{name}");
        }
        let picture = draw(&skeleton, &Camera::front(), &Style::over_dark(), size(33, 21));
        let total: f32 = (0..21).map(|y| ink(&picture, y)).sum();
        let nothing_to_see = name == "without any width";
        assert!(total > 0.1 || nothing_to_see, "{name}: {total}");
    }
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let fails = |skeleton: &Skeleton| {
        draw_skeleton(skeleton, &Camera::default(), &Style::studio(), size(8, 8), &Quiet).unwrap_err()
    };
    assert_eq!(fails(&Skeleton::default()), RasterError::Empty);
    assert_eq!(fails(&stem(&[(Vec3::ZERO, 0.1), (Vec3::NAN, 0.1)])), RasterError::NotFinite(1));
    let mut short = stem(&[(Vec3::ZERO, 0.1), (Vec3::Y, 0.1)]);
    short.radii.pop();
    assert_eq!(fails(&short), RasterError::Inconsistent(1));
    let mut late = stem(&[(Vec3::ZERO, 0.1), (Vec3::Y, 0.1)]);
    late.parents[1] = 1;
    assert_eq!(fails(&late), RasterError::Inconsistent(1));
    let mut stray = stem(&[(Vec3::ZERO, 0.1), (Vec3::Y, 0.1)]);
    stray.axis_nodes[1] = 77;
    assert_eq!(fails(&stray), RasterError::Inconsistent(77));

    let error = Size::new(MAX_SIDE + 1, 5).unwrap_err();
    assert!(error.to_string().contains("8193") && error.to_string().contains("8192"), "{error}");
    assert!(Size::new(0, 5).is_err());
}

#[test]
fn the_largest_picture_is_drawn() {
    let tree = stem(&[(Vec3::ZERO, 0.1), (Vec3::Y * 5.0, 0.05)]);
    let picture = draw(&tree, &Camera::front(), &Style::over_dark(), size(MAX_SIDE, 24));
    assert!(alpha(&picture, MAX_SIDE / 2, 12) > 0 && alpha(&picture, 5, 12) == 0);
}

#[test]
fn a_cancelled_monitor_stops_the_work() {
    struct Stop;
    impl Monitor for Stop {
        fn is_cancelled(&self) -> bool {
            true
        }
        fn advance(&self, _: linden_pipeline::monitor::Phase, _: u64, _: Option<u64>) {}
    }
    let result = draw_skeleton(&sample::tree(1, 2), &Camera::default(), &Style::studio(), size(8, 8), &Stop);
    assert_eq!(result, Err(linden_pipeline::Cancelled.into()));
}
