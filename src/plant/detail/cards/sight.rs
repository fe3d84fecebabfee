//! From where pieces are looked at: the planes of their cards, and how much of a piece these show.

use glam::{Vec2, Vec3};
use linden_base::mesh::Bounds;
use linden_skeleton::Skeleton;

use super::PLANES;
use super::frame::Frame;
use super::model::Model;

/// Directions that a piece is looked at from, to tell how much of it is seen.
const VIEWS: usize = 8;

/// A plane of a card: its directions in the frame of the piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub right: Vec3,
    pub up: Vec3,
    pub toward: Vec3,
}

/// From above its plane, from its side, from its end.
const SEEN: [Plane; 3] = [
    Plane { right: Vec3::X, up: Vec3::Y, toward: Vec3::Z },
    Plane { right: Vec3::NEG_Z, up: Vec3::Y, toward: Vec3::X },
    Plane { right: Vec3::NEG_X, up: Vec3::Z, toward: Vec3::Y },
];

/// What is drawn in a cell.
#[derive(Debug)]
pub(super) struct Sight {
    pub model: usize,
    /// See [`Grain::share`].
    pub share: f32,
    pub plane: Plane,
    pub low: Vec2,
    pub high: Vec2,
}

impl Sight {
    pub fn size(&self) -> Vec2 {
        (self.high - self.low).max(Vec2::splat(1e-3))
    }
}

/// The planes that show most of a piece to who stands on the ground, and what they show.
pub(super) fn seen(model: usize, of: &Model, frame: &Frame) -> Vec<Sight> {
    let world = |v: Vec3| frame.side() * v.x + frame.heading * v.y + frame.up * v.z;
    let mut sights: Vec<(f32, Sight)> = SEEN
        .iter()
        .map(|&plane| {
            let places = of.parts.iter().flat_map(|(_, mesh)| &mesh.positions);
            let flat = places.map(|at| Vec3::new(at.dot(plane.right), at.dot(plane.up), 0.0));
            let bounds = Bounds::of(flat).unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
            let sight =
                Sight { model, share: 1.0, plane, low: bounds.min.truncate(), high: bounds.max.truncate() };
            let rise = world(plane.toward).y.abs();
            // The mean of |n·d| over level directions, and a little for those from above.
            let visible = std::f32::consts::FRAC_2_PI * (1.0 - rise * rise).max(0.0).sqrt() + 0.3 * rise;
            (sight.size().x * sight.size().y * visible, sight)
        })
        .collect();
    sights.sort_by(|a, b| b.0.total_cmp(&a.0));
    sights.into_iter().take(PLANES).map(|(_, sight)| sight).collect()
}

/// How many times more of the wood of a piece its card shows than is seen of it: both planes have all of it, seen from their
/// own sides.
pub(super) fn shown_to_seen(
    skeleton: &Skeleton,
    nodes: impl Iterator<Item = usize>,
    planes: &[Sight],
    frame: &Frame,
) -> f32 {
    let views = views(frame);
    let (mut cards, mut rods) = (0.0, 0.0);
    for node in nodes {
        let Some(&from) = skeleton.positions.get(skeleton.parents[node] as usize) else { continue };
        let rod = frame.turned(skeleton.positions[node] - from);
        let width_m = |toward: Vec3| skeleton.radii[node] * rod.cross(toward).length();
        rods += views.iter().map(|view| width_m(*view)).sum::<f32>();
        cards +=
            planes.iter().map(|sight| on_plane(sight, &views) * width_m(sight.plane.toward)).sum::<f32>();
    }
    if rods > 0.0 { cards / rods } else { 1.0 }
}

/// The area of the leaves of a piece, hidden or not, as its card shows it and as it is: the mean over views from a little
/// above the horizon.
pub(super) fn leaf_areas(model: &Model, frame: &Frame) -> (f64, f64) {
    let planes = seen(0, model, frame);
    let views = views(frame);
    let on_plane: Vec<f32> = planes.iter().map(|sight| on_plane(sight, &views)).collect();
    let (mut cards, mut leaves) = (0.0, 0.0);
    for (_, mesh) in model.parts.iter().skip(model.barks) {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            leaves += views.iter().map(|view| f64::from(normal.dot(*view).abs())).sum::<f64>();
            let shown =
                planes.iter().zip(&on_plane).map(|(sight, seen)| seen * normal.dot(sight.plane.toward).abs());
            cards += f64::from(shown.sum::<f32>());
        }
    }
    (cards, leaves)
}

/// How much larger leaves are drawn whose cards show so much of them to who stands on the ground, where leaves themselves
/// would show so much: level ones are seen from their edges on upright planes, and by nobody else.
pub(super) fn leaf_scale(cards: f64, leaves: f64) -> f32 {
    /// Two planes show more than one, and lie before each other: as much as oaks and birches need.
    const SHOWN: f64 = 1.06;
    const MOST: f64 = 1.35;
    if cards <= 0.0 { 1.0 } else { (SHOWN * leaves / cards).sqrt().clamp(1.0, MOST) as f32 }
}

/// Directions from a piece to viewers all around it and a little above the horizon, in its own coordinates.
fn views(frame: &Frame) -> [Vec3; VIEWS] {
    const RISE: f32 = 0.15;
    std::array::from_fn(|view| {
        let (sin, cos) = libm::sincosf(std::f32::consts::TAU * view as f32 / VIEWS as f32);
        frame.turned(Vec3::new(sin, RISE, cos).normalize())
    })
}

/// How much of a plane is seen from some directions, in all.
fn on_plane(sight: &Sight, views: &[Vec3]) -> f32 {
    views.iter().map(|view| view.dot(sight.plane.toward).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::mesh::Mesh;
    use linden_skeleton::NO_PARENT;

    /// A piece of many leaves, squares that are tilted so far from level, all ways round.
    fn leaves(tilt: f32) -> (Model, Frame) {
        let frame = Frame { middle: Vec3::ZERO, heading: Vec3::Z, up: Vec3::Y, radius_m: 1.0 };
        let mut mesh = Mesh::default();
        for i in 0..300 {
            let key = linden_base::random::Key::new(5).child(i);
            let turn = glam::Quat::from_rotation_y(key.child(0).between(0.0, 6.3) as f32)
                * glam::Quat::from_rotation_x(tilt);
            let first = mesh.positions.len() as u32;
            let at = key.child(2).in_ball().as_vec3();
            for (x, z) in [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)] {
                mesh.positions.push(frame.local(at + turn * Vec3::new(x, 0.0, z)));
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        (
            Model {
                parts: vec![(0, Mesh::default()), (1, mesh)],
                barks: 1,
                thickest_m: 0.0,
                shade_share: 0.0,
            },
            frame,
        )
    }

    #[test]
    fn two_planes_show_twigs_twice_but_what_points_away_from_one() {
        let frame = Frame { middle: Vec3::ZERO, heading: Vec3::Z, up: Vec3::Y, radius_m: 1.0 };
        let seen_of = |tip: Vec3| {
            let skeleton = Skeleton {
                positions: vec![Vec3::ZERO, tip],
                radii: vec![0.01; 2],
                parents: vec![NO_PARENT, 0],
                ..Skeleton::default()
            };
            let sight =
                |plane: Plane| Sight { model: 0, share: 1.0, plane, low: Vec2::ZERO, high: Vec2::ONE };
            // Both upright.
            shown_to_seen(&skeleton, [1].into_iter(), &[sight(SEEN[1]), sight(SEEN[2])], &frame)
        };
        // Eight views, two of which are square to each plane, see (1 + √2)/4 of it in the mean.
        let of_plane = (1.0 + std::f32::consts::SQRT_2) / 4.0;
        assert!((seen_of(Vec3::Y) - 2.0 * of_plane).abs() < 0.01, "{}", seen_of(Vec3::Y));
        // One plane has nothing of what is level and square to it, and views from above have a little of its ends.
        assert!((seen_of(Vec3::X) - 0.926).abs() < 0.005, "{}", seen_of(Vec3::X));
    }

    #[test]
    fn leaves_that_lie_level_are_drawn_larger_as_upright_planes_show_less_of_them() {
        let scale = |tilt: f32| {
            let (model, frame) = leaves(tilt);
            let (cards, leaves) = leaf_areas(&model, &frame);
            leaf_scale(cards, leaves)
        };
        // Eight looks, two of which are square to each plane, see |cos| of it (1 + √2)/4 in the mean; a leaf that is turned
        // any way shows as much to a plane as to a look.
        let expected = 2.0 * (1.0 + std::f64::consts::SQRT_2) / 4.0;
        let (upright, level) = (leaves(std::f32::consts::FRAC_PI_2), leaves(0.05));
        let (cards, shown) = leaf_areas(&upright.0, &upright.1);
        assert!((cards / shown - expected).abs() < 0.03, "{}", cards / shown);
        let (cards, shown) = leaf_areas(&level.0, &level.1);
        assert!(cards / shown < 0.6, "{}", cards / shown);
        assert!(scale(1.5) == 1.0 && scale(0.05) > 1.3);
        assert!((leaf_scale(0.75, 1.0) - libm::sqrtf(1.06 / 0.75)).abs() < 1e-6);
        assert_eq!((leaf_scale(0.01, 1.0), leaf_scale(0.0, 0.0)), (1.35, 1.0));
    }
}
