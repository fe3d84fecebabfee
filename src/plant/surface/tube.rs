//! From rings to triangles: bands between rings. What closes them is in `ends`.

use std::f32::consts::{FRAC_1_SQRT_2, TAU};

use glam::{Vec2, Vec3};

use super::ends;
use super::path::Ring;
use super::stretch::Stretch;
use super::target::{Amount, PlacedRing, Target};
use super::tube_form::{Circle, Roundness, TubeForm};

/// Pictures round the girth, from band to band. Where their number changes, a ring stands twice, with the coordinates of
/// either side, and the bark breaks off all round: they keep their number as long as they are not much too narrow or too wide.
///
/// Round a root they are halved as it gets thinner.
#[derive(Default)]
pub(super) struct Wraps {
    last: Option<f32>,
}

/// The widths at which pictures stay, as shares of a tile's.
const KEPT_WIDTHS: std::ops::RangeInclusive<f32> = 0.55..=1.5;

impl Wraps {
    /// Between a ring and the next one up.
    pub fn between(&mut self, ring: &Ring, next: &Ring, form: &TubeForm, tile_m: f32) -> f32 {
        if let Some(root) = &form.root {
            return root.wraps(f32::midpoint(ring.onward, next.radius), tile_m);
        }
        let radius_m = f32::midpoint(ring.onward, next.radius);
        // A flare widens the pictures: with more of them there was a seam all round the foot.
        let wider =
            form.flare.map_or(1.0, |flare| flare.wider(f32::midpoint(ring.along, next.along).max(0.0)));
        let radius_m = radius_m / wider;
        let width = |wraps: &f32| TAU * radius_m / tile_m / wraps;
        let kept = self.last.filter(|last| KEPT_WIDTHS.contains(&width(last)));
        let wraps = kept.unwrap_or_else(|| wraps(radius_m, tile_m));
        self.last = Some(wraps);
        wraps
    }
}

/// How much [`sweep`] writes for the same rings.
pub(super) fn amount(rings: &[Ring], form: &TubeForm, roundness: &Roundness, tile_m: f32) -> Amount {
    let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return Amount::default() };
    let sides = |ring: &Ring, radius_m: f32| form.circle(ring, radius_m, roundness).sides() as usize;
    let ends = [sides(base, base.onward), sides(apex, apex.radius)];
    let mut amount = ends::base_amount(ends[0], form).and(ends::tip_amount(ends[1], form.ends));
    let (mut before, mut pictures) = (None, Wraps::default());
    for pair in rings.windows(2) {
        let wraps = pictures.between(&pair[0], &pair[1], form, tile_m);
        let (bottom, top) = (sides(&pair[0], pair[0].onward), sides(&pair[1], pair[1].radius));
        if before != Some(wraps) {
            amount.vertices += bottom + 1;
        }
        amount.vertices += top + 1;
        amount.triangles += bottom + top;
        before = Some(wraps);
        if pair[1].steps() {
            let above = sides(&pair[1], pair[1].onward);
            amount.vertices += top + 1 + above + 1;
            amount.triangles += top + above;
            before = None;
        }
    }
    amount
}

/// How much of a collar's fillet is laid, from the first that folds nothing: wood that turns within its
/// own thickness leaves no room for more. At 0 rings are circles with their corners on them.
const EASES: [f32; 4] = [UNFOLDED, 0.6, 0.3, 0.0];
/// The ease of tubes that fold nothing as they are.
pub(super) const UNFOLDED: f32 = 1.0;

/// Writes the tube over some rings (none or at least two). Gives the ease that folded nothing.
pub(super) fn sweep(
    rings: &[Ring],
    form: &TubeForm,
    roundness: &Roundness,
    tile_m: f32,
    target: &mut Target<'_>,
) -> f32 {
    let before = target.done;
    let may_fold = may_fold(form);
    for ease in EASES {
        target.done = before;
        Wall { rings, form, roundness, tile_m, ease }.write(target);
        if !may_fold || !target.is_folded(before.triangles) {
            return ease;
        }
    }
    // Written with the last one, as it is.
    0.0
}

const fn may_fold(form: &TubeForm) -> bool {
    form.collar.is_some() || form.root.is_some() || form.is_bent
}

/// What a tube over some rings holds, between each two of them and beyond the last; `ease` is what [`sweep`] gave.
pub(super) fn stretches<'a>(
    rings: &'a [Ring],
    form: &'a TubeForm,
    roundness: &'a Roundness,
    ease: f32,
) -> impl Iterator<Item = Stretch> + 'a {
    let wall = Wall { rings, form, roundness, tile_m: 1.0, ease };
    let end = rings.last().zip(ends::frustum(form.ends)).map(|(apex, [length, upper])| {
        let radius_m = f64::from(apex.radius);
        let radii_m = [radius_m, radius_m * upper];
        Stretch { axis: form.axis, length_m: radius_m * length, radii_m, is_end: true }
    });
    let between = rings.windows(2).enumerate().map(move |(i, pair)| Stretch {
        axis: form.axis,
        // What is in the ground is not counted.
        length_m: f64::from(pair[1].along.max(0.0) - pair[0].along.max(0.0)),
        radii_m: [wall.mean_radius_m(i, Of::Above), wall.mean_radius_m(i + 1, Of::Below)],
        is_end: false,
    });
    between.chain(end)
}

/// Which wood a ring is an end of: where it steps, the two differ.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Below,
    Above,
}

/// A tube on its way into the mesh.
struct Wall<'a> {
    rings: &'a [Ring],
    form: &'a TubeForm,
    roundness: &'a Roundness,
    tile_m: f32,
    /// The share of the collar that is laid; at 0 rings are as narrow as they can be.
    ease: f32,
}

impl Wall<'_> {
    fn write(&self, target: &mut Target<'_>) {
        let Self { rings, form, roundness, tile_m, .. } = *self;
        let (Some(base), Some(apex)) = (rings.first(), rings.last()) else { return };
        let circle = form.circle(base, base.onward, roundness);
        ends::close_base(base, form, circle, self.reach(circle), tile_m, target);
        let mut below: Option<(PlacedRing, f32)> = None;
        let mut pictures = Wraps::default();
        for (i, pair) in rings.windows(2).enumerate() {
            let wraps = pictures.between(&pair[0], &pair[1], form, tile_m);
            let bottom = match below.take() {
                Some((placed, same)) if same == wraps => placed,
                _ => self.ring(i, Of::Above, wraps, target),
            };
            let top = self.ring(i + 1, Of::Below, wraps, target);
            join(&bottom, &top, target);
            if pair[1].steps() {
                // The next band begins with a ring of its own.
                self.ledge(i + 1, wraps, target);
            } else {
                below = Some((top, wraps));
            }
        }
        if let Some((rim, wraps)) = below {
            ends::close_tip(apex, form, &rim, wraps, tile_m, target);
        }
    }

    fn reach(&self, circle: &Circle) -> f32 {
        if self.ease > 0.0 { circle.reach } else { 1.0 }
    }

    /// The direction out of a ring, and the place of a circle of radius 1 there.
    fn outward(&self, ring: &Ring, corner: (f32, f32)) -> (Vec3, Vec3) {
        if self.ease > 0.0 {
            return ring.outward(corner);
        }
        let (out, _) = ring.outward(corner);
        (out, out)
    }

    fn radius(ring: &Ring, of: Of) -> f32 {
        match of {
            Of::Below => ring.radius,
            Of::Above => ring.onward,
        }
    }

    /// How fast the radius, times a factor, shrinks at a ring: metres per metre, the mean of both sides
    /// where it does not step.
    fn slope(&self, i: usize, of: Of, factor: impl Fn(&Ring) -> f32) -> f32 {
        let ring = &self.rings[i];
        let between =
            |a: &Ring, b: &Ring| (a.onward * factor(a) - b.radius * factor(b)) / (b.along - a.along);
        let counts = |side: Of| of == side || !ring.steps();
        let before = (i > 0 && counts(Of::Below)).then(|| between(&self.rings[i - 1], ring));
        let after = self.rings.get(i + 1).filter(|_| counts(Of::Above)).map(|next| between(ring, next));
        match (before, after) {
            (Some(x), Some(y)) => f32::midpoint(x, y),
            (one, other) => one.or(other).unwrap_or(0.0),
        }
    }

    /// Writes a ring's vertices; normals lean toward the apex as much as the wood tapers.
    fn ring(&self, i: usize, of: Of, wraps: f32, target: &mut Target<'_>) -> PlacedRing {
        let Self { rings, form, roundness, tile_m, .. } = *self;
        let ring = &rings[i];
        let circle = form.circle(ring, Self::radius(ring, of), roundness);
        let (first, sides) = (target.next(), circle.sides());
        let v = ring.along / tile_m;
        let mut vertex = |k: usize, place: Vec3, normal: Vec3| {
            target.vertex(place, normal, Vec2::new(wraps * k as f32 / sides as f32, v));
        };
        if self.is_featured(ring) {
            for (k, &corner) in circle.corners.iter().enumerate() {
                let (place, normal) = self.featured(i, of, circle, corner);
                vertex(k, place, normal);
            }
        } else {
            let slope = self.slope(i, of, |_| 1.0);
            let upright = 1.0 / (1.0 + slope * slope).sqrt();
            let lean = ring.tangent * (slope * upright);
            let reach_m = Self::radius(ring, of) * self.reach(circle);
            for (k, &corner) in circle.corners.iter().enumerate() {
                let (out, at) = self.outward(ring, corner);
                vertex(k, ring.center + at * reach_m, out * upright + lean);
            }
        }
        PlacedRing { first, sides }
    }

    fn is_featured(&self, ring: &Ring) -> bool {
        self.form.root.is_some() && ring.along > 0.0
            || self.form.flare.is_some_and(|flare| flare.shapes(ring.along))
            || self.form.collar.as_ref().is_some_and(|collar| collar.shapes(ring.along))
    }

    /// Place and normal of a corner of a flare or a collar.
    fn featured(&self, i: usize, of: Of, circle: &Circle, corner: (f32, f32)) -> (Vec3, Vec3) {
        let Self { rings, form, ease, .. } = *self;
        let ring = &rings[i];
        let (cos, sin) = corner;
        let (out, at) = self.outward(ring, corner);
        if let Some(root) = &form.root {
            return root.place(ring, out, Self::radius(ring, of), self.slope(i, of, |_| 1.0), ease);
        }
        let ridge = |ring: &Ring| form.flare.map_or((1.0, 0.0), |flare| flare.ridge(ring.along, corner));
        let (factor, by_angle) = ridge(ring);
        let radius = Self::radius(ring, of) * self.reach(circle) * factor;
        let lean = ring.tangent * self.slope(i, of, |ring| ridge(ring).0);
        let around = ring.tangent.cross(ring.side) * cos - ring.side * sin;
        let normal = (out + lean - around * (by_angle / factor)).normalize_or(out);
        // What a mitre adds moves the corner's own centre.
        let center = ring.center + (at - out) * radius;
        match &form.collar {
            Some(collar) => collar.place(center, out, radius, normal, ease),
            None => (center + out * radius, normal),
        }
    }

    /// Of the circle that has as much area as what a ring goes round.
    fn mean_radius_m(&self, i: usize, of: Of) -> f64 {
        let ring = &self.rings[i];
        let radius_m = Self::radius(ring, of);
        if !self.is_featured(ring) {
            return radius_m.into();
        }
        let circle = self.form.circle(ring, radius_m, self.roundness);
        // A collar bends slowly round its lateral, and each look at it is a search.
        let apart = if self.form.collar.is_some() { (circle.sides() as usize / 8).max(1) } else { 1 };
        let corners = circle.corners[1..].iter().step_by(apart);
        let count = corners.len() as f64;
        let squared = |&corner: &(f32, f32)| {
            let (place, _) = self.featured(i, of, circle, corner);
            let (out, at) = self.outward(ring, corner);
            // A mitre is no more wood: the axis runs through it askew.
            let reach_m = f64::from((place - ring.center).dot(out) - (at.dot(out) - 1.0) * radius_m);
            reach_m * reach_m
        };
        let mean = corners.map(squared).sum::<f64>() / count;
        mean.sqrt() / f64::from(self.reach(circle))
    }

    /// The flat ring between the two radii of a step.
    fn ledge(&self, i: usize, wraps: f32, target: &mut Target<'_>) {
        let ring = &self.rings[i];
        let normal = if ring.onward < ring.radius { ring.tangent } else { -ring.tangent };
        let [below, above] = [Of::Below, Of::Above].map(|of| {
            let from = target.done.vertices;
            let placed = self.ring(i, of, wraps, target);
            let written = from..target.done.vertices;
            target.normals[written.clone()].fill(normal);
            if of == Of::Above {
                // The picture goes on over the ledge.
                let across = (ring.radius - ring.onward).abs() / self.tile_m;
                target.uvs[written].iter_mut().for_each(|uv| uv.y += across);
            }
            placed
        });
        join(&below, &above, target);
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
