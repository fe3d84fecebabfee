//! From rings to triangles: bands between rings. What closes them is in `ends`.

use std::f32::consts::{FRAC_1_SQRT_2, PI, TAU};

use glam::{Vec2, Vec3};

use super::collar::Collar;
use super::ends;
use super::features::{Ends, Flare};
use super::path::Ring;

/// Side counts that rings take. Few distinct ones, so that neighbouring rings mostly agree.
const SIDES: [u32; 14] = [3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 128];

/// How many sides a radius deserves, and a circle for each such number: equal absolute deviation from
/// the circle on thick and thin wood, set by the sides of the thickest.
#[derive(Clone, Debug)]
pub(super) struct Roundness {
    pub thickest_m: f32,
    circles: Vec<Circle>,
}

#[derive(Clone, Debug)]
struct Circle {
    /// Thicker rings deviate too far from it.
    largest_radius_m: f32,
    /// Unit vectors `(cos, sin)` at equal angles, the first one again at the end: the seam.
    corners: Vec<(f32, f32)>,
}

impl Roundness {
    /// Circles of up to `sides` sides for radii, and of more for those who need them.
    pub(super) fn new(sides: u32, thickest_m: f32) -> Self {
        // Between circle and polygon, in radii.
        let sagitta = |sides: u32| 1.0 - libm::cosf(PI / sides as f32);
        let circle = |n: u32| Circle {
            // The last one takes whatever is left, however it was rounded.
            largest_radius_m: if n >= sides {
                f32::INFINITY
            } else {
                thickest_m * sagitta(sides) / sagitta(n)
            },
            corners: (0..=n)
                .map(|k| {
                    let (sin, cos) = libm::sincosf(TAU * (k % n) as f32 / n as f32);
                    (cos, sin)
                })
                .collect(),
        };
        let fewer = SIDES.into_iter().filter(|&n| n < sides);
        let more = SIDES.into_iter().filter(|&n| n > sides);
        Self { thickest_m, circles: fewer.chain([sides]).chain(more).map(circle).collect() }
    }

    /// The circle for a radius, with at least `least_sides` sides where there is one.
    fn circle(&self, radius_m: f32, least_sides: u32) -> &[(f32, f32)] {
        let is_enough = |circle: &&Circle| {
            radius_m <= circle.largest_radius_m && circle.corners.len() as u32 > least_sides
        };
        let enough = self.circles.iter().find(is_enough).or(self.circles.last());
        enough.map_or(&[], |circle| &circle.corners)
    }

    pub(super) fn sides(&self, radius_m: f32) -> u32 {
        self.circle(radius_m, 0).len() as u32 - 1
    }
}

/// What turns the rings of one axis into its tube.
#[derive(Clone, Debug, Default)]
pub(super) struct Form {
    /// Of a stem.
    pub flare: Option<Flare>,
    /// Of a lateral.
    pub collar: Option<Box<Collar>>,
    pub ends: Ends,
    /// Which axis of the skeleton it is: splinters differ from one to the next.
    pub axis: u32,
    /// Whether it stands on the ground.
    pub is_stem: bool,
}

impl Form {
    fn circle<'a>(&self, ring: &Ring, roundness: &'a Roundness) -> &'a [(f32, f32)] {
        let least = self.flare.map_or(0, |flare| flare.least_sides(ring.along));
        let wider = match &self.collar {
            Some(collar) if collar.shapes(ring.along) => 0.5 * collar.fillet_m,
            _ => 0.0,
        };
        roundness.circle(ring.radius + wider, least)
    }
}

/// How much a piece of surface is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Amount {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
}

impl Amount {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { vertices: self.vertices + other.vertices, triangles: self.triangles + other.triangles }
    }
}

/// Where a tube is written: slices of exactly its [`Amount`].
pub(super) struct Target<'a> {
    pub positions: &'a mut [Vec3],
    pub normals: &'a mut [Vec3],
    pub uvs: &'a mut [Vec2],
    pub triangles: &'a mut [[u32; 3]],
    /// Index of the slices' first vertex in the whole mesh.
    pub first: u32,
    pub done: Amount,
}

impl Target<'_> {
    /// Index of the next vertex.
    pub fn next(&self) -> u32 {
        self.first + self.done.vertices as u32
    }

    pub fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) {
        let i = self.done.vertices;
        self.positions[i] = position;
        self.normals[i] = normal;
        self.uvs[i] = uv;
        self.done.vertices = i + 1;
    }

    /// Of a vertex that was written.
    pub fn position(&self, index: u32) -> Vec3 {
        self.positions[(index - self.first) as usize]
    }

    /// Of a vertex that was written.
    pub fn normal(&self, index: u32) -> Vec3 {
        self.normals[(index - self.first) as usize]
    }

    /// Whether a triangle, from the given one on, faces away from its vertices' normals.
    fn is_folded(&self, first: usize) -> bool {
        self.triangles[first..self.done.triangles].iter().any(|&corners| {
            let [a, b, c] = corners.map(|i| self.position(i));
            let normals = corners.map(|i| self.normal(i)).iter().sum::<Vec3>();
            (b - a).cross(c - a).dot(normals) < 0.0
        })
    }

    pub fn triangle(&mut self, corners: [u32; 3]) {
        self.triangles[self.done.triangles] = corners;
        self.done.triangles += 1;
    }
}

/// A ring as it stands in the mesh.
pub(super) struct Placed {
    /// Index of the vertex at angle 0; `sides + 1` vertices follow, the last one closes the seam.
    pub first: u32,
    pub sides: u32,
}

/// Pictures round the girth between two rings. They follow the radius; where their number changes,
/// the ring stands twice, with the coordinates of either side.
fn band_wraps(ring: &Ring, next: &Ring, tile_m: f32) -> f32 {
    wraps(f32::midpoint(ring.radius, next.radius), tile_m)
}

/// How much [`sweep`] writes for the same rings.
pub(super) fn amount(rings: &[Ring], form: &Form, roundness: &Roundness, tile_m: f32) -> Amount {
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
    form: &Form,
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
    form: &'a Form,
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
    let mut below: Option<(Placed, f32)> = None;
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
) -> Placed {
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
    Placed { first, sides }
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
) -> Placed {
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
    Placed { first, sides }
}

/// Writes the band between two rings, also when their side counts differ: walks round both and
/// always advances over the edge whose middle comes first, so that each edge meets the vertex of the
/// other ring that is nearest to it.
fn join(below: &Placed, above: &Placed, target: &mut Target<'_>) {
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
