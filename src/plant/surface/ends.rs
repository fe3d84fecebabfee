//! What closes a tube: a flat base, and a tip that is a bud, a cut or a break.

use glam::{Vec2, Vec3};

use super::features::Ends;
use super::path::Ring;
use super::target::{Amount, PlacedRing, Target};
use super::tube_form::{Circle, TubeForm};
use linden_base::random::Key;

/// How much [`close_base`] writes.
pub(super) fn base_amount(sides: usize, form: &TubeForm) -> Amount {
    if has_hollows(form) {
        return Amount::of(sides + 1, sides);
    }
    Amount::of(sides, sides - 2)
}

/// Whether the base is no convex polygon: then triangles meet in its middle.
fn has_hollows(form: &TubeForm) -> bool {
    form.flare.is_some_and(|flare| flare.has_ridges())
}

/// A flat disc that looks back along the axis, with vertices of its own (its edge is sharp).
pub(super) fn close_base(
    ring: &Ring,
    form: &TubeForm,
    circle: &Circle,
    reach: f32,
    tile_m: f32,
    target: &mut Target<'_>,
) {
    let sides = circle.sides();
    let across = ring.tangent.cross(ring.side);
    let first = target.next();
    for &corner in &circle.corners[..sides as usize] {
        let (cos, sin) = corner;
        let out = ring.side * cos + across * sin;
        // The seam of the first ring's wall, bit for bit.
        let radius = match form.flare {
            Some(flare) => ring.radius * reach * flare.ridge(ring.along, corner).0,
            None => ring.radius * reach,
        };
        let uv = Vec2::new(sin, cos) * (ring.radius / tile_m);
        target.vertex(ring.center + out * radius, -ring.tangent, uv);
    }
    if has_hollows(form) {
        let middle = target.next();
        target.vertex(ring.center, -ring.tangent, Vec2::ZERO);
        for k in 0..sides {
            target.triangle([middle, first + (k + 1) % sides, first + k]);
        }
        return;
    }
    for k in 1..sides - 1 {
        target.triangle([first, first + k + 1, first + k]);
    }
}

/// How much [`close_tip`] writes.
pub(super) const fn tip_amount(sides: usize, ends: Ends) -> Amount {
    match ends {
        Ends::Bud => Amount::of(sides, sides),
        Ends::Cut => Amount::of(sides, sides - 2),
        // Walls of the splinters, then facets down to the hollow's bottom.
        Ends::Broken => Amount::of(sides + 1 + 3 * sides, 3 * sides),
    }
}

/// Length and upper radius of the frustum that holds as much as an end, in radii of the last ring.
pub(super) const fn frustum(ends: Ends) -> Option<[f64; 2]> {
    match ends {
        Ends::Bud => Some([1.0, 0.0]),
        Ends::Cut => None,
        // Splinters are 1.375 radii high on average, over a hollow down to 0.5, and lean in.
        Ends::Broken => Some([1.08, 0.87]),
    }
}

/// Closes the upper end over its last ring.
pub(super) fn close_tip(
    ring: &Ring,
    form: &TubeForm,
    rim: &PlacedRing,
    wraps: f32,
    tile_m: f32,
    target: &mut Target<'_>,
) {
    match form.ends {
        Ends::Bud => bud(ring, rim, wraps, tile_m, target),
        Ends::Cut => cut(ring, rim, tile_m, target),
        Ends::Broken => broken(ring, form.axis, rim, wraps, tile_m, target),
    }
}

/// The last ring drawn together to a point one radius beyond the apex.
fn bud(ring: &Ring, rim: &PlacedRing, wraps: f32, tile_m: f32, target: &mut Target<'_>) {
    let point = ring.center + ring.tangent * ring.radius;
    let v = (ring.along + ring.radius) / tile_m;
    for k in 0..rim.sides {
        // A vertex per side, so that the picture is not pinched into the point.
        let tip = target.next();
        let u = wraps * (k as f32 + 0.5) / rim.sides as f32;
        target.vertex(point, ring.tangent, Vec2::new(u, v));
        target.triangle([rim.first + k, rim.first + k + 1, tip]);
    }
}

/// A flat disc across the axis, with vertices of its own.
fn cut(ring: &Ring, rim: &PlacedRing, tile_m: f32, target: &mut Target<'_>) {
    let first = target.next();
    for k in 0..rim.sides {
        let place = target.position(rim.first + k);
        target.vertex(place, ring.tangent, planar(ring, place, tile_m));
    }
    for k in 1..rim.sides - 1 {
        target.triangle([first, first + k, first + k + 1]);
    }
}

/// Splinters of uneven length round the rim, and within them facets, each flat, down to a hollow.
fn broken(ring: &Ring, axis: u32, rim: &PlacedRing, wraps: f32, tile_m: f32, target: &mut Target<'_>) {
    let key = Key::new(axis.into()).named("break");
    // A tree does not break straight across: one side tears out farther than the other.
    let lean = key.named("lean").between(0.0, std::f64::consts::TAU);
    let height = |k: u32| {
        let angle = f64::from(k) / f64::from(rim.sides) * std::f64::consts::TAU - lean;
        let torn = 0.8 + 0.7 * libm::cos(angle);
        (torn + key.child(k.into()).between(0.05, 1.1)) as f32 * ring.radius
    };
    let walls = target.next();
    for k in 0..=rim.sides {
        let below = rim.first + k;
        let up = height(k % rim.sides);
        let (base, normal) = (target.position(below), target.normal(below));
        // Splinters lean in a little, so that their rim is no sharp crown.
        let place = base + ring.tangent * up - (base - ring.center) * (0.12 * up / ring.radius).min(0.4);
        let uv = Vec2::new(wraps * k as f32 / rim.sides as f32, (ring.along + up) / tile_m);
        target.vertex(place, normal, uv);
    }
    for k in 0..rim.sides {
        target.triangle([rim.first + k, rim.first + k + 1, walls + k]);
        target.triangle([rim.first + k + 1, walls + k + 1, walls + k]);
    }
    let bottom = ring.center + ring.tangent * (0.5 * ring.radius);
    for k in 0..rim.sides {
        let corners = [target.position(walls + k), target.position(walls + k + 1), bottom];
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(ring.tangent);
        let first = target.next();
        for place in corners {
            target.vertex(place, normal, planar(ring, place, tile_m));
        }
        target.triangle([first, first + 1, first + 2]);
    }
}

/// Coordinates of the picture, laid across the axis.
fn planar(ring: &Ring, place: Vec3, tile_m: f32) -> Vec2 {
    let across = ring.tangent.cross(ring.side);
    let from = place - ring.center;
    Vec2::new(from.dot(ring.side), from.dot(across)) / tile_m
}
