//! From rings to triangles: bands between rings. What closes them is in `ends`.

use std::f32::consts::{FRAC_1_SQRT_2, TAU};

use glam::Vec2;

use super::ends;
use super::path::Ring;
use super::target::{Amount, PlacedRing, Target};
use super::tube_form::{Roundness, TubeForm};

/// Pictures round the girth between two rings. They follow the radius; where their number changes,
/// the ring stands twice, with the coordinates of either side.
fn band_wraps(ring: &Ring, next: &Ring, tile_m: f32) -> f32 {
    wraps(f32::midpoint(ring.radius, next.radius), tile_m)
}

/// How much [`sweep`] writes for the same rings.
pub(super) fn amount(rings: &[Ring], form: &TubeForm, roundness: &Roundness, tile_m: f32) -> Amount {
    let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return Amount::default() };
    let sides = |ring: &Ring| form.circle(ring, roundness).len() - 1;
    let mut amount = ends::base_amount(sides(base), form).and(ends::tip_amount(sides(apex), form.ends));
    let mut before = None;
    for pair in rings.windows(2) {
        let wraps = band_wraps(&pair[0], &pair[1], tile_m);
        let (bottom, top) = (sides(&pair[0]), sides(&pair[1]));
        if before != Some(wraps) {
            amount.vertices += bottom + 1;
        }
        amount.vertices += top + 1;
        amount.triangles += bottom + top;
        before = Some(wraps);
    }
    amount
}

/// How much of a collar's fillet is laid, from the first that folds nothing: wood that turns within its
/// own thickness leaves no room for more.
const EASES: [f32; 4] = [1.0, 0.6, 0.3, 0.0];

/// Writes the tube over some rings (none or at least two).
pub(super) fn sweep(
    rings: &[Ring],
    form: &TubeForm,
    roundness: &Roundness,
    tile_m: f32,
    target: &mut Target<'_>,
) {
    let before = target.done;
    for ease in EASES {
        target.done = before;
        sweep_eased(rings, Eased { form, ease }, roundness, tile_m, target);
        if form.collar.is_none() || !target.is_folded(before.triangles) {
            break;
        }
    }
}

/// A form and the share of its collar that is laid.
#[derive(Clone, Copy)]
struct Eased<'a> {
    form: &'a TubeForm,
    ease: f32,
}

fn sweep_eased(
    rings: &[Ring],
    Eased { form, ease }: Eased<'_>,
    roundness: &Roundness,
    tile_m: f32,
    target: &mut Target<'_>,
) {
    let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return };
    ends::close_base(base, form, form.circle(base, roundness), tile_m, target);
    let place = |i: usize, wraps: f32, target: &mut Target<'_>| {
        let circle = form.circle(&rings[i], roundness);
        let is_featured = form.flare.is_some_and(|flare| rings[i].along < flare.height_m)
            || form.collar.as_ref().is_some_and(|collar| collar.shapes(rings[i].along));
        if is_featured {
            place_featured(rings, i, Eased { form, ease }, circle, wraps, tile_m, target)
        } else {
            place(&rings[i], slope(rings, i, |ring| ring.radius), circle, wraps, tile_m, target)
        }
    };
    let mut below: Option<(PlacedRing, f32)> = None;
    for (i, pair) in rings.windows(2).enumerate() {
        let wraps = band_wraps(&pair[0], &pair[1], tile_m);
        let bottom = match below.take() {
            Some((placed, same)) if same == wraps => placed,
            _ => place(i, wraps, target),
        };
        let top = place(i + 1, wraps, target);
        join(&bottom, &top, target);
        below = Some((top, wraps));
    }
    if let Some((rim, wraps)) = below {
        ends::close_tip(apex, form, &rim, wraps, tile_m, target);
    }
}

/// Pictures round the girth: a whole number, below one a power of two.
pub(super) fn wraps(radius_m: f32, tile_m: f32) -> f32 {
    let exact = TAU * radius_m / tile_m;
    if exact >= 1.0 {
        return exact.round();
    }
    let mut fraction = 1.0;
    // The geometric middle between neighbours; 2^-20 of a picture is less than a texel.
    while exact < fraction * FRAC_1_SQRT_2 && fraction > 1e-6 {
        fraction *= 0.5;
    }
    fraction
}

/// How fast the radius shrinks at a ring: metres per metre, the mean of both sides.
fn slope(rings: &[Ring], i: usize, radius: impl Fn(&Ring) -> f32) -> f32 {
    let between = |a: &Ring, b: &Ring| (radius(a) - radius(b)) / (b.along - a.along);
    let before = (i > 0).then(|| between(&rings[i - 1], &rings[i]));
    let after = rings.get(i + 1).map(|next| between(&rings[i], next));
    match (before, after) {
        (Some(x), Some(y)) => f32::midpoint(x, y),
        (one, other) => one.or(other).unwrap_or(0.0),
    }
}

/// Writes a ring's vertices; normals lean toward the apex as much as the wood tapers.
fn place(
    ring: &Ring,
    slope: f32,
    circle: &[(f32, f32)],
    wraps: f32,
    tile_m: f32,
    target: &mut Target<'_>,
) -> PlacedRing {
    let (first, sides) = (target.next(), circle.len() as u32 - 1);
    let across = ring.tangent.cross(ring.side);
    let upright = 1.0 / (1.0 + slope * slope).sqrt();
    let lean = ring.tangent * (slope * upright);
    let v = ring.along / tile_m;
    for (k, &(cos, sin)) in circle.iter().enumerate() {
        let out = ring.side * cos + across * sin;
        let u = wraps * k as f32 / sides as f32;
        target.vertex(ring.center + out * ring.radius, out * upright + lean, Vec2::new(u, v));
    }
    PlacedRing { first, sides }
}

/// The same for a ring of a flare or a collar, whose vertices have places and normals of their own.
fn place_featured(
    rings: &[Ring],
    i: usize,
    Eased { form, ease }: Eased<'_>,
    circle: &[(f32, f32)],
    wraps: f32,
    tile_m: f32,
    target: &mut Target<'_>,
) -> PlacedRing {
    let ring = &rings[i];
    let (first, sides) = (target.next(), circle.len() as u32 - 1);
    let across = ring.tangent.cross(ring.side);
    let v = ring.along / tile_m;
    for (k, &corner) in circle.iter().enumerate() {
        let (cos, sin) = corner;
        let out = ring.side * cos + across * sin;
        let ridge = |ring: &Ring| form.flare.map_or((1.0, 0.0), |flare| flare.ridge(ring.along, corner));
        let (factor, by_angle) = ridge(ring);
        let radius = ring.radius * factor;
        let lean = ring.tangent * slope(rings, i, |ring| ring.radius * ridge(ring).0);
        let around = across * cos - ring.side * sin;
        let normal = (out + lean - around * (by_angle / factor)).normalize_or(out);
        let (place, normal) = match &form.collar {
            Some(collar) => collar.place(ring.center, out, radius, normal, ease),
            None => (ring.center + out * radius, normal),
        };
        target.vertex(place, normal, Vec2::new(wraps * k as f32 / sides as f32, v));
    }
    PlacedRing { first, sides }
}

/// Writes the band between two rings, also when their side counts differ: walks round both and
/// always advances over the edge whose middle comes first, so that each edge meets the vertex of the
/// other ring that is nearest to it.
fn join(below: &PlacedRing, above: &PlacedRing, target: &mut Target<'_>) {
    let (n, m) = (below.sides, above.sides);
    let (mut i, mut j) = (0, 0);
    while i < n || j < m {
        let (a, b) = (below.first + i, above.first + j);
        // Compares the angles (i + ½)/n and (j + ½)/m; the lower ring first where they are equal.
        if j == m || (i < n && (2 * i + 1) * m <= (2 * j + 1) * n) {
            target.triangle([a, a + 1, b]);
            i += 1;
        } else {
            target.triangle([a, b + 1, b]);
            j += 1;
        }
    }
}
