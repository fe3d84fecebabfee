//! A level cut through a tree, from above: where it goes through wood, and the points of a scan near it.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use linden_pipeline::skeleton::Cylinder;
use linden_pipeline::{Monitor, Skeleton};

use super::trace::bytes;
use super::{Drawing, Kind, beside};
use crate::memory::{Ledger, picture_bytes};
use crate::skeleton::check;
use crate::strokes::trace::Colors;
use crate::{Camera, Extent, Paint, RasterError, Size, Style, View};

/// Corners of an ellipse.
const CORNERS: u32 = 72;
/// How many times as long as wide a cut through lying wood may be.
const LONGEST: f32 = 6.0;
/// Axes between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 10;
/// How much of what is behind it a cut through wood hides.
const WOOD_ALPHA: f32 = 0.3;
/// Room round what is cut, of its size.
const ROOM: f32 = 0.12;

/// Where a tree is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// The height of its middle, metres, where the tree stands.
    pub height_m: f32,
    /// Metres from its lower side to the upper one: points between them are in it. Wood is cut in the middle.
    pub thickness_m: f32,
}

/// A cut through wood: an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Metres.
    pub middle: Vec3,
    /// Of the wood there, metres: half of the ellipse's width.
    pub radius_m: f32,
    /// Half of its length with the way that it runs, metres.
    pub long: Vec3,
    /// The node above.
    pub node: u32,
}

impl Cut {
    /// Corners of the ellipse.
    fn outline(&self) -> impl Iterator<Item = Vec3> {
        let across = Vec3::Y.cross(self.long).normalize_or(Vec3::X) * self.radius_m;
        (0..CORNERS).map(move |corner| {
            let (sin, cos) = libm::sincosf(TAU * corner as f32 / CORNERS as f32);
            self.middle + self.long * cos + across * sin
        })
    }
}

impl Slice {
    /// Whether a point is in it.
    pub fn holds(&self, point: Vec3) -> bool {
        (point.y - self.height_m).abs() <= 0.5 * self.thickness_m
    }

    /// How a picture of it by this camera shows places; `None` where it cuts nothing.
    pub fn view(&self, skeleton: &Skeleton, camera: &Camera, size: Size) -> Option<View> {
        extent(&self.cuts(skeleton)).map(|extent| seen(extent, camera, size))
    }

    /// Where its middle goes through a skeleton's wood, each segment as a cylinder that tapers.
    pub fn cuts(&self, skeleton: &Skeleton) -> Vec<Cut> {
        let cut = |one: &Cylinder| {
            let [from, to] = [one.parent_node, one.node].map(|node| skeleton.positions[node as usize]);
            // One of its ends belongs to it, so that a stem is cut once.
            if (from.y < self.height_m) == (to.y < self.height_m) {
                return None;
            }
            let along = ((self.height_m - from.y) / (to.y - from.y)).clamp(0.0, 1.0);
            let [lower_m, upper_m] = one.end_radii_m;
            let radius_m = lower_m + (upper_m - lower_m) * along;
            let level = Vec3::new(one.direction.x, 0.0, one.direction.z);
            let long_m = radius_m / one.direction.y.abs().max(1.0 / LONGEST);
            let long = level.try_normalize().unwrap_or(Vec3::Z) * long_m;
            let middle = from.lerp(to, along).with_y(self.height_m);
            Some(Cut { middle, radius_m, long, node: one.node })
        };
        skeleton.cylinders().iter().filter_map(cut).collect()
    }
}

impl Drawing {
    /// Draws a slice of a tree from above, with those of [`Style::points`] that lie in it and a scale where there is
    /// room. The camera's yaw, zoom and shift hold; all that is cut is framed. Where nothing is cut there is the background.
    ///
    /// # Errors
    /// Those of [`crate::draw_skeleton`].
    pub fn of_slice(
        skeleton: &Skeleton,
        slice: Slice,
        camera: &Camera,
        style: &Style,
        size: Size,
        monitor: &dyn Monitor,
    ) -> Result<Self, RasterError> {
        monitor.check()?;
        let style = &style.suited(skeleton);
        check(skeleton)?;
        let ledger = Ledger::new(monitor);
        ledger.take(picture_bytes(size))?;
        let mut drawing = Self::empty(size, style.background);
        let cuts = slice.cuts(skeleton);
        let Some(extent) = extent(&cuts) else { return Ok(drawing) };
        let view = seen(extent, camera, size);
        let is_in = |i: &usize| slice.holds(style.points[*i]);
        let within: Vec<usize> = (0..style.points.len()).filter(is_in).collect();
        let points: Vec<Vec3> = within.iter().map(|&i| style.points[i].with_y(slice.height_m)).collect();
        let gaps_m: Vec<f32> = within.iter().filter_map(|&i| style.point_gaps_m.get(i)).copied().collect();
        let colors = Colors::new(skeleton, style);
        let width = (size.width().min(size.height()) as f32 / 260.0).clamp(1.0, 4.0);
        for (i, cut) in cuts.iter().enumerate() {
            if i % CHECK_EVERY == 0 {
                monitor.check()?;
            }
            let color = if style.paint == Paint::Wood { style.ink } else { bytes(colors.of(cut.node)) };
            let ring: Vec<Vec2> = cut.outline().map(|corner| view.project(corner).at).collect();
            for (kind, alpha) in [(Kind::Rings, WOOD_ALPHA), (Kind::Lines { width }, 1.0)] {
                drawing.shape(kind, color, alpha, |drawing| {
                    drawing.points.extend(&ring);
                    if kind != Kind::Rings {
                        drawing.points.push(ring[0]);
                    }
                    drawing.end_line();
                });
            }
        }
        let laid = Style {
            points: &points,
            point_gaps_m: &gaps_m,
            outline: &[],
            marked: &[],
            handles: &[],
            person: false,
            ..*style
        };
        let mut over = Self::empty(size, style.background);
        beside::trace(&mut over, &extent, &view, &laid, monitor)?;
        ledger.take(drawing.bytes() + 2 * over.bytes())?;
        drawing.append(over);
        Ok(drawing)
    }
}

/// From above, the whole of it.
fn seen(extent: Extent, camera: &Camera, size: Size) -> View {
    Camera { pitch_deg: 90.0, eye_m: None, extent: Some(extent), ..*camera }.view(extent, size)
}

/// What frames all that is cut; `None` where nothing is.
fn extent(cuts: &[Cut]) -> Option<Extent> {
    let corners: Vec<Vec3> = cuts.iter().flat_map(Cut::outline).collect();
    let extent = Extent::of(&Skeleton::default(), &corners)?;
    Some(Extent { radii: extent.radii.map(|radius| radius * (1.0 + ROOM)), ..extent })
}

#[cfg(test)]
mod tests {
    use linden_pipeline::skeleton::{Branching, Wood};
    use linden_pipeline::{NO_PARENT, Quiet};

    use super::*;

    /// A leaning pole of 2 m, 0.2 m thick at the foot and 0.1 m at the top, with a lateral from its middle.
    fn pole() -> Skeleton {
        let branching = Branching {
            positions: vec![
                Vec3::ZERO,
                Vec3::new(0.0, 1.0, 1.0),
                Vec3::new(0.0, 2.0, 2.0),
                Vec3::new(1.0, 1.5, 1.0),
            ],
            parents: vec![NO_PARENT, 0, 1, 1],
            births: vec![0, 1, 2, 2],
            radii: Some(vec![0.1, 0.075, 0.05, 0.02]),
            edges: None,
        };
        Skeleton::build(branching, &Wood::default()).unwrap()
    }

    #[test]
    fn cuts_are_where_wood_goes_through_the_level() {
        let pole = pole();
        let at = |height_m: f32| Slice { height_m, thickness_m: 0.1 }.cuts(&pole);
        let [cut] = at(0.5)[..] else { panic!("{:?}", at(0.5)) };
        assert!(cut.middle.abs_diff_eq(Vec3::new(0.0, 0.5, 0.5), 1e-6), "{cut:?}");
        assert!((cut.radius_m - 0.0875).abs() < 1e-6, "{cut:?}");
        // It leans by 45 degrees along Z: the cylinder is cut that much longer.
        assert!(cut.long.abs_diff_eq(Vec3::Z * 0.0875 * 2.0_f32.sqrt(), 1e-5), "{cut:?}");
        for corner in cut.outline() {
            let way = Vec3::new(0.0, 1.0, 1.0).normalize();
            assert!((corner.reject_from(way).length() - 0.0875).abs() < 1e-4, "on the cylinder: {corner}");
            assert!((corner.y - 0.5).abs() < 1e-6);
        }
        let both = at(1.25);
        assert_eq!(both.iter().map(|cut| cut.node).collect::<Vec<_>>(), [2, 3]);
        assert!(
            (both[1].radius_m - 0.02).abs() < 1e-6,
            "a lateral is not as thick as what bears it: {both:?}"
        );
        // Through a node, once; above all, never.
        assert_eq!((at(1.0).len(), at(2.5).len(), at(-0.1).len()), (1, 0, 0));
    }

    #[test]
    fn a_slice_shows_its_wood_its_points_and_none_of_the_others() {
        let pole = pole();
        let size = Size::new(200, 200).unwrap();
        let slice = Slice { height_m: 0.5, thickness_m: 0.1 };
        let draw = |slice: Slice, points: &[Vec3]| {
            let style = Style { points, ..Style::paper() };
            let drawing = Drawing::of_slice(&pole, slice, &Camera::front(), &style, size, &Quiet).unwrap();
            drawing.picture(&Quiet).unwrap()
        };
        let plain = draw(slice, &[]);
        let pixel = |picture: &linden_pipeline::picture::Picture, x: usize, y: usize| {
            picture.rgba().as_chunks::<4>().0[200 * y + x]
        };
        assert_ne!(pixel(&plain, 100, 100), [255; 4], "wood in the middle");
        assert_eq!(pixel(&plain, 3, 3), [255; 4]);
        let inside = Vec3::new(0.0, 0.54, 0.5);
        assert_ne!(draw(slice, &[inside]), plain);
        assert_eq!(draw(slice, &[inside.with_y(0.56), inside.with_y(0.4)]), plain);
        let above = draw(Slice { height_m: 9.0, ..slice }, &[inside]);
        assert!(above.rgba().iter().all(|&byte| byte == 255), "nothing but paper");
    }
}
