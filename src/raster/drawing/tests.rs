//! Drawings against geometry, and against each other.

use glam::Vec3;
use linden_pipeline::picture::Picture;
use linden_pipeline::{Quiet, Skeleton};

use super::Drawing;
use crate::skeleton::sample::{self, stem};
use crate::{Background, Camera, RasterError, Size, Style};

fn size(width: u32, height: u32) -> Size {
    Size::new(width, height).unwrap()
}

fn drawn(skeleton: &Skeleton, style: &Style, size: Size) -> Drawing {
    Drawing::new(skeleton, &Camera::front(), style, size, &Quiet).unwrap()
}

/// Ink on white paper, in pixels that are wholly covered.
fn ink(picture: &Picture) -> f64 {
    let style = Style::paper();
    let full = 255.0 - f64::from(style.ink[0]);
    picture.rgba().as_chunks::<4>().0.iter().map(|p| (255.0 - f64::from(p[0])) / full).sum()
}

#[test]
fn a_tubes_area_is_what_geometry_says() {
    // Small: no room for a scale.
    let size = size(150, 158);
    for radius in [0.06_f32, 0.15, 0.4] {
        for lean in [0.0_f32, 0.4, 2.0] {
            let tip = Vec3::new(lean, 4.0, 0.0);
            let tube = stem(&[(Vec3::ZERO, radius), (tip / 2.0, radius), (tip, radius)]);
            let view = Camera::front().view(Style::paper().extent(&tube).unwrap(), size);
            let (foot, tip) = (view.project(Vec3::ZERO), view.project(tip));
            let width = f64::from(radius * (foot.scale + tip.scale));
            let cap = std::f64::consts::PI * width * width / 8.0;
            let length = f64::from(foot.at.distance(tip.at));
            let expected = length * width + cap;
            let found = ink(&drawn(&tube, &Style::paper(), size).picture(&Quiet).unwrap());
            // tiny-skia counts quarters of a pixel: each side may be off by an eighth.
            assert!((found - expected).abs() < 0.25 * length, "{radius} {lean}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_bend_is_round_and_has_no_hole() {
    let size = size(150, 150);
    let corner = stem(&[(Vec3::ZERO, 0.3), (Vec3::Y * 3.0, 0.3), (Vec3::new(2.5, 0.8, 0.0), 0.3)]);
    let picture = drawn(&corner, &Style::paper(), size).picture(&Quiet).unwrap();
    let view = Camera::front().view(Style::paper().extent(&corner).unwrap(), size);
    let at = |p: Vec3| {
        let seen = view.project(p).at;
        picture.rgba()[((seen.y as u32 * 150 + seen.x as u32) * 4) as usize]
    };
    // All round the joint within the radius, and the outer side as far out as a disc reaches.
    for degrees in (0..360).step_by(15) {
        let (sin, cos) = libm::sincosf((degrees as f32).to_radians());
        let inside = at(Vec3::new(0.26 * cos, 3.0 + 0.26 * sin, 0.0));
        assert_eq!(inside, Style::paper().ink[0], "{degrees}°");
    }
    assert_eq!(at(Vec3::new(-0.2, 3.35, 0.0)), 255, "a mitre would reach here");
}

#[test]
fn svg_says_the_same_shapes() {
    let tree = sample::tree(3, 2);
    let drawing = drawn(&tree, &Style::paper(), size(300, 400));
    let svg = drawing.svg(Some("{\"id\":\"a<b\"}"));
    assert!(svg.contains("linden recipe: {&quot;id&quot;:&quot;a&lt;b&quot;}"));
    assert_eq!(svg.matches("<path ").count(), drawing.shapes.len());
    let rings = svg.matches('M').count();
    // Every line begins once; the text has no capital M.
    assert_eq!(rings, drawing.ends.len());
    assert!(svg.ends_with("</svg>\n"));
}

/// An SVG as another program draws it, over white.
fn by_resvg(svg: &str) -> resvg::tiny_skia::Pixmap {
    let tree = resvg::usvg::Tree::from_str(svg, &resvg::usvg::Options::default()).unwrap();
    let size = tree.size().to_int_size();
    let mut pixels = resvg::tiny_skia::Pixmap::new(size.width(), size.height()).unwrap();
    resvg::render(&tree, resvg::tiny_skia::Transform::identity(), &mut pixels.as_mut());
    pixels
}

#[test]
fn another_program_draws_the_svg_as_we_do() {
    let tree = sample::tree(3, 2);
    // Without a scale: its letters are those of whatever fonts there are.
    let size = size(159, 500);
    let drawing = drawn(&tree, &Style::paper(), size);
    let (ours, theirs) = (drawing.picture(&Quiet).unwrap(), by_resvg(&drawing.svg(None)));
    assert_eq!((theirs.width(), theirs.height()), (159, 500));
    let off: Vec<u8> =
        ours.rgba().iter().zip(theirs.data()).map(|(ours, theirs)| ours.abs_diff(*theirs)).collect();
    // Hairs are drawn a little stronger as pixels; everything else is the same but for hundredths of a pixel.
    let mean = off.iter().map(|&d| f64::from(d)).sum::<f64>() / off.len() as f64;
    let dark = ours.rgba().as_chunks::<4>().0.iter().zip(theirs.data().as_chunks::<4>().0);
    let torn = dark.filter(|(ours, theirs)| ours[0] < 60 && theirs[0] > 120).count();
    assert!(mean < 1.5, "{mean}");
    assert_eq!(torn, 0, "solid here, and not there");
    assert!(ink(&ours) > 500.0, "there is something to compare");
}

#[test]
fn what_cannot_be_drawn_is_an_error_and_what_is_odd_is_drawn() {
    let fails = |skeleton: &Skeleton| {
        Drawing::new(skeleton, &Camera::front(), &Style::paper(), size(8, 8), &Quiet).unwrap_err()
    };
    assert_eq!(fails(&Skeleton::default()), RasterError::Empty);
    assert_eq!(fails(&stem(&[(Vec3::ZERO, 0.1), (Vec3::NAN, 0.1)])), RasterError::NotFinite(1));
    let odd = [
        stem(&[(Vec3::ONE, 0.1)]),
        stem(&[(Vec3::ONE, 0.1), (Vec3::ONE, 0.1)]),
        stem(&[(Vec3::ZERO, 0.0), (Vec3::Y, 0.0)]),
        stem(&[(Vec3::ZERO, 1e3), (Vec3::Y * 1e7, 1e2)]),
    ];
    for skeleton in &odd {
        for (w, h) in [(1, 1), (1, 50), (200, 170)] {
            let picture = drawn(skeleton, &Style::paper(), size(w, h)).picture(&Quiet).unwrap();
            assert_eq!(picture.rgba().len(), (w * h * 4) as usize);
        }
    }
}

#[test]
fn transparent_where_nothing_is() {
    let tree = sample::tree(1, 1);
    let style = Style { background: Background::Transparent, ..Style::paper() };
    let picture = drawn(&tree, &style, size(90, 120)).picture(&Quiet).unwrap();
    assert_eq!(&picture.rgba()[..4], &[0; 4]);
    let pixels = picture.rgba().as_chunks::<4>().0;
    assert!(pixels.iter().any(|p| p[3] == 255));
    // Where it is half covered the ink is the ink, not darker, but for what eight bits lose in each layer.
    let off = |p: &[u8; 4]| u32::from(p[0].abs_diff(style.ink[0])) * u32::from(p[3]) / 255;
    assert!(pixels.iter().filter(|p| p[3] > 40).all(|p| off(p) <= 4));
}

#[test]
fn letters_are_as_high_as_they_are_to_be() {
    let (path, width) = super::text::outlines("H", glam::Vec2::new(5.0, 50.0), 20.0);
    let bounds = path.unwrap().bounds();
    assert!((bounds.height() - 20.0).abs() < 0.2 && (bounds.bottom() - 50.0).abs() < 0.1, "{bounds:?}");
    assert!(width > 15.0 && width < 30.0);
}
