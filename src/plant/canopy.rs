//! The leaves of a tree, measured as they are dressed: numbers, areas, inclinations, heights.
//!
//! An organ's area is that of one side of its triangles, as far as its picture leaves them opaque: what light meets.
//! Sheets that cross (`leaf_form` cross, twig, tuft) are all counted; [`Crop::sheets`] says how often each leaf is
//! drawn. Blossom, fruit and berries are counted as organs; they have no part in the numbers of leaves.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use linden_base::hull::HullSolid;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::organs::{LeafShape, OrganClass, Organs, PROTOTYPES};
use rayon::prelude::*;

use crate::Specimen;
use crate::dress::covers;
use crate::foliage::{Cover, FoliageError, Shaper, opaque_shares};
use crate::settings::{Cluster, Form, LeafKind};

/// Organs that one task measures.
const PER_TASK: usize = 2048;
/// Points that a task keeps before it takes their hull: users' meshes have thousands.
const MOST_CORNERS: usize = 1 << 14;
/// Classes of inclination from level to upright, a tenth of a degree each.
pub const INCLINATIONS: usize = 900;
/// Layers of equal thickness.
pub const LAYERS: usize = 10;

/// The organs of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Crop {
    /// Of a kind of the foliage: its outline, or `mesh` or `picture` for the user's; of a grammar's: `polygon`, or
    /// the name of its prototype.
    pub name: String,
    /// Whether they are leaves: no blossom, no fruit.
    pub is_leaf: bool,
    /// Places where one stands.
    pub organs: usize,
    /// Leaves that an organ shows: those of a twig card, otherwise 1.
    pub leaves_each: u32,
    /// How often an organ draws each of its leaves, on sheets that cross.
    pub sheets: u32,
    /// The opaque part of all, one side of each sheet, square metres.
    pub area_m2: f64,
}

/// What grows on a tree, measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Canopy {
    /// The kinds of which there are organs, those of a grammar first.
    pub crops: Vec<Crop>,
    /// Vertices of all meshes.
    pub vertices: usize,
    /// Triangles of all meshes.
    pub triangles: usize,
    /// Points of the meshes whose convex hull is that of all, metres.
    pub corners: Vec<DVec3>,
    /// Height at which the lowest leaf is attached, metres; `None` where there is no leaf.
    pub lowest_leaf_m: Option<f64>,
    /// Area of leaves, each drawn once, by the angle between the blade and the level, in [`INCLINATIONS`] classes of equal
    /// width from 0 to 90 degrees, square metres. Of sheets that cross in a leaf the first is its blade; the two of a twig
    /// are rolled as far to one side as to the other, and count half each.
    pub inclinations_m2: Vec<f64>,
    /// Area of leaves, each counted once as in [`Canopy::leaf_area_once_m2`], in [`LAYERS`] layers of equal thickness from
    /// `floor_m` to `top_m`, from the lowest, by the middles of triangles, square metres.
    pub layers_m2: Vec<f64>,
    /// Where the lowest layer begins, metres.
    pub floor_m: f64,
    /// Where the highest layer ends, metres: the highest point of leaves.
    pub top_m: f64,
}

impl Canopy {
    /// Leaves, where a card of 13 counts as 13.
    pub fn leaves(&self) -> usize {
        self.leafy().map(|crop| crop.organs * crop.leaves_each as usize).sum()
    }

    /// The opaque part of all leaves, one side, square metres.
    pub fn leaf_area_m2(&self) -> f64 {
        self.leafy().fold(0.0, |sum, crop| sum + crop.area_m2)
    }

    /// The same with each leaf counted once, however many sheets of an organ show it, square metres.
    pub fn leaf_area_once_m2(&self) -> f64 {
        self.leafy().fold(0.0, |sum, crop| sum + crop.area_m2 / f64::from(crop.sheets))
    }

    fn leafy(&self) -> impl Iterator<Item = &Crop> {
        self.crops.iter().filter(|crop| crop.is_leaf)
    }
}

/// A mesh of which there are many.
struct Stamp<'a> {
    mesh: &'a Mesh,
    /// The opaque share of each triangle.
    shares: Vec<f64>,
    /// Of each triangle, how much it counts for the inclination of its leaf.
    facing: Vec<f64>,
    /// Index of its crop.
    crop: usize,
}

/// What one task found.
#[derive(Default)]
struct Part {
    /// Per crop: organs and square metres.
    crops: Vec<(usize, f64)>,
    vertices: usize,
    triangles: usize,
    corners: Vec<DVec3>,
    lowest_leaf_m: Option<f64>,
    top_m: Option<f64>,
    inclinations_m2: Vec<f64>,
    layers_m2: Vec<f64>,
}

/// Measures the organs of a tree as [`dress`](crate::dress::dress()) shows them. Layers begin at `floor_m`.
///
/// # Errors
/// [`FoliageError`]: those of its pictures and meshes; cancelled.
pub fn canopy(
    specimen: &Specimen<'_>,
    organs: &Organs,
    floor_m: f64,
    monitor: &dyn Monitor,
) -> Result<Canopy, FoliageError> {
    let (covers, shapes) = covers(specimen, organs, monitor)?;
    // As dressing does with a recipe of other kinds than the organs grew by.
    let shapes = if shapes.len() == organs.shapes.len() { shapes } else { organs.shapes.to_vec() };
    let kinds: Vec<&LeafKind> = specimen.dressing.foliage.kinds().collect();
    let (mut crops, stamps) = (crops(&kinds), stamps(&kinds, &shapes, &covers));
    let measuring = Measuring { organs, stamps: &stamps, crops: &crops };
    let extents = measuring.extents(monitor)?;
    let top_m = extents.iter().filter_map(|part| part.top_m).fold(floor_m, f64::max);
    let areas = measuring.areas([floor_m, top_m], monitor)?;

    for part in &extents {
        crops.iter_mut().zip(&part.crops).for_each(|(crop, (organs, _))| crop.organs += organs);
    }
    for part in &areas {
        crops.iter_mut().zip(&part.crops).for_each(|(crop, (_, area))| crop.area_m2 += area);
    }
    crops.retain(|crop| crop.organs > 0);
    // In the order of the tasks: the same sums on any number of threads.
    let sum = |of: fn(&Part) -> &[f64], classes: usize| {
        let mut sums = vec![0.0; classes];
        for part in &areas {
            sums.iter_mut().zip(of(part)).for_each(|(sum, more)| *sum += more);
        }
        sums
    };
    let corners: Vec<DVec3> = extents.iter().flat_map(|part| part.corners.iter().copied()).collect();
    Ok(Canopy {
        crops,
        vertices: extents.iter().map(|part| part.vertices).sum(),
        triangles: extents.iter().map(|part| part.triangles).sum(),
        corners: HullSolid::of(&corners).corners,
        lowest_leaf_m: extents.iter().filter_map(|part| part.lowest_leaf_m).reduce(f64::min),
        inclinations_m2: sum(|part| &part.inclinations_m2, INCLINATIONS),
        layers_m2: sum(|part| &part.layers_m2, LAYERS),
        floor_m,
        top_m,
    })
}

/// A grammar's polygons, its organs, then the kinds: none of them yet.
fn crops(kinds: &[&LeafKind]) -> Vec<Crop> {
    let of_grammar = PROTOTYPES.iter().map(|it| plain(it.name, it.class == OrganClass::Leaf));
    let of_kinds = kinds.iter().map(|kind| crop_of(kind));
    std::iter::once(plain("polygon", true)).chain(of_grammar).chain(of_kinds).collect()
}

/// The meshes of a grammar's organs, then those of leaves, each with its crop among [`crops`].
fn stamps<'a>(kinds: &[&LeafKind], shapes: &'a [LeafShape], covers: &[Option<Cover>]) -> Vec<Stamp<'a>> {
    let whole = |mesh: &Mesh| vec![1.0; mesh.triangles.len()];
    let of_grammar = PROTOTYPES.iter().enumerate().map(|(i, prototype)| {
        let mesh = prototype.mesh();
        Stamp { mesh, shares: whole(mesh), facing: whole(mesh), crop: 1 + i }
    });
    let of_kinds = shapes.iter().map(|LeafShape { kind, mesh, faces, .. }| {
        let kind = usize::from(*kind).min(kinds.len() - 1);
        let mask = covers.get(kind).and_then(Option::as_ref).and_then(Cover::mask).map(AsRef::as_ref);
        let shares = opaque_shares(mesh, mask).into_iter().map(|share| share / f64::from(*faces));
        let facing = facing(kinds[kind], mesh.triangles.len(), usize::from(*faces));
        Stamp { mesh, shares: shares.collect(), facing, crop: 1 + PROTOTYPES.len() + kind }
    });
    of_grammar.chain(of_kinds).collect()
}

/// The class of a share, 0 to 1.
fn class(share: f64, classes: usize) -> usize {
    ((share.max(0.0) * classes as f64) as usize).min(classes - 1)
}

/// How much each of some triangles counts for the inclination of a leaf of a kind, whose sheets come one after the other,
/// in each of its faces.
fn facing(kind: &LeafKind, triangles: usize, faces: usize) -> Vec<f64> {
    let Crop { sheets, .. } = crop_of(kind);
    let in_face = triangles / faces.max(1);
    let in_sheet = in_face / sheets as usize;
    let of_triangle = |i: usize| match kind.form {
        Form::Cross | Form::Tuft if sheets > 1 => f64::from(u8::from(i % in_face.max(1) < in_sheet)),
        _ => 1.0 / f64::from(sheets),
    };
    (0..triangles).map(of_triangle).collect()
}

/// A grammar's organs.
fn plain(name: &str, is_leaf: bool) -> Crop {
    Crop { name: name.to_owned(), is_leaf, organs: 0, leaves_each: 1, sheets: 1, area_m2: 0.0 }
}

fn crop_of(kind: &LeafKind) -> Crop {
    if kind.cluster != Cluster::None {
        let leaves_each = kind.cluster_count;
        return Crop { leaves_each, ..plain(&kind.label(), kind.class() == OrganClass::Leaf) };
    }
    let (leaves_each, sheets) = match kind.form {
        Form::Twig => (kind.twig_leaves, 2),
        Form::Cross => (1, 2),
        Form::Tuft => (1, 3),
        Form::None | Form::Card | Form::Curved | Form::Fan | Form::Mesh => (1, 1),
    };
    Crop { leaves_each, sheets, ..plain(&kind.label(), kind.class() == OrganClass::Leaf) }
}

/// The organs of a tree while they are measured.
struct Measuring<'a> {
    organs: &'a Organs,
    stamps: &'a [Stamp<'a>],
    crops: &'a [Crop],
}

impl Measuring<'_> {
    /// How many organs there are of each crop, their meshes, and how far they reach.
    fn extents(&self, monitor: &dyn Monitor) -> Result<Vec<Part>, Cancelled> {
        self.in_tasks(monitor, |part, mesh, stamp, foot_m| {
            part.vertices += mesh.positions.len();
            part.triangles += mesh.triangles.len();
            part.corners.extend(mesh.positions.iter().map(|p| p.as_dvec3()));
            if part.corners.len() > MOST_CORNERS {
                part.corners = HullSolid::of(&part.corners).corners;
            }
            part.crops[stamp.crop].0 += 1;
            if self.crops[stamp.crop].is_leaf {
                let top_m = mesh.positions.iter().map(|p| f64::from(p.y)).reduce(f64::max);
                part.top_m = part.top_m.into_iter().chain(top_m).reduce(f64::max);
                part.lowest_leaf_m = Some(part.lowest_leaf_m.map_or(foot_m, |lowest| lowest.min(foot_m)));
            }
        })
    }

    /// The area of each crop, and that of leaves by inclination and in layers between two heights.
    fn areas(&self, [floor_m, top_m]: [f64; 2], monitor: &dyn Monitor) -> Result<Vec<Part>, Cancelled> {
        self.in_tasks(monitor, |part, mesh, stamp, _| {
            part.inclinations_m2.resize(INCLINATIONS, 0.0);
            part.layers_m2.resize(LAYERS, 0.0);
            for ((triangle, share), facing) in mesh.triangles.iter().zip(&stamp.shares).zip(&stamp.facing) {
                let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
                let normal = (b - a).cross(c - a);
                let area = normal.length() / 2.0 * share;
                part.crops[stamp.crop].1 += area;
                if area > 0.0 && self.crops[stamp.crop].is_leaf {
                    let level = DVec3::new(normal.x, 0.0, normal.z).length();
                    let inclination = libm::atan2(level, normal.y.abs()) / FRAC_PI_2;
                    part.inclinations_m2[class(inclination, INCLINATIONS)] += area * facing;
                    let height =
                        ((a.y + b.y + c.y) / 3.0 - floor_m) / (top_m - floor_m).max(f64::MIN_POSITIVE);
                    part.layers_m2[class(height, LAYERS)] += area / f64::from(self.crops[stamp.crop].sheets);
                }
            }
        })
    }

    /// Each task looks at some of the organs; what they find, in the order of the organs.
    fn in_tasks(
        &self,
        monitor: &dyn Monitor,
        look: impl Fn(&mut Part, &Mesh, &Stamp<'_>, f64) + Sync,
    ) -> Result<Vec<Part>, Cancelled> {
        let count = self.organs.len();
        let parts = (0..count.div_ceil(PER_TASK)).into_par_iter().map(|task| {
            monitor.check()?;
            let mut part = Part { crops: vec![(0, 0.0); self.crops.len()], ..Part::default() };
            let organs = task * PER_TASK..count.min((task + 1) * PER_TASK);
            self.visit(organs, |mesh, stamp, foot_m| look(&mut part, mesh, stamp, foot_m));
            // The points of all its organs, no longer than until their hull is known.
            part.corners = HullSolid::of(&part.corners).corners;
            Ok(part)
        });
        parts.collect()
    }

    /// Gives each of some organs as it stands: its mesh in its place, what it is a copy of, and the height of its
    /// foot.
    fn visit(&self, range: std::ops::Range<usize>, mut look: impl FnMut(&Mesh, &Stamp<'_>, f64)) {
        debug_assert!(self.stamps.iter().all(|stamp| stamp.crop < self.crops.len()));
        let mut shaper = Shaper::default();
        let mut mesh = Mesh::default();
        for organ in range {
            mesh.positions.clear();
            mesh.normals.clear();
            mesh.uvs.clear();
            mesh.triangles.clear();
            let Some(placed) = organ.checked_sub(self.organs.polygons.ends.len()) else {
                shaper.add(self.organs, organ, &mut mesh);
                let shares = vec![1.0; mesh.triangles.len()];
                let foot_m = self.organs.corners_of(organ).first().map_or(0.0, |foot| f64::from(foot.y));
                let facing = shares.clone();
                look(&mesh, &Stamp { mesh: &Mesh::default(), shares, facing, crop: 0 }, foot_m);
                continue;
            };
            let prototype = usize::from(self.organs.placed.prototypes[placed]);
            // A shape that is not given is drawn as one of the table.
            let stamp = self.stamps.get(prototype).unwrap_or(&self.stamps[prototype % PROTOTYPES.len()]);
            mesh.positions.extend(stamp.mesh.positions.iter().map(|&local| self.organs.place(placed, local)));
            mesh.triangles.extend_from_slice(&stamp.mesh.triangles);
            look(&mesh, stamp, f64::from(self.organs.placed.positions[placed].y));
        }
    }
}

/// The mean projection of leaf area on a plane square to a direction, as a share of the area: Ross' G function, for
/// leaves that face all compass directions alike (Ross 1981, *The radiation regime and architecture of plant stands*,
/// after Warren Wilson 1960, *Inclined point quadrats*). `zenith_rad` is the angle between the direction and the
/// upright, 0 to π/2; `None` where there is no area.
///
/// ```
/// use linden_plant::canopy::{INCLINATIONS, projection};
/// // As the faces of a sphere: one half from everywhere.
/// let sphere: Vec<f64> = (0..INCLINATIONS).map(|i| ((i as f64 + 0.5) * 0.1_f64.to_radians()).sin()).collect();
/// for zenith in [0.0_f64, 30.0, 57.5, 90.0] {
///     assert!((projection(&sphere, zenith.to_radians()).unwrap() - 0.5).abs() < 1e-3);
/// }
/// ```
pub fn projection(inclinations_m2: &[f64], zenith_rad: f64) -> Option<f64> {
    let total: f64 = inclinations_m2.iter().sum();
    let width = FRAC_PI_2 / inclinations_m2.len() as f64;
    let of = |(class, area): (usize, &f64)| area * projected((class as f64 + 0.5) * width, zenith_rad);
    (total > 0.0).then(|| inclinations_m2.iter().enumerate().map(of).sum::<f64>() / total)
}

/// The same of blades of one inclination.
fn projected(inclination_rad: f64, zenith_rad: f64) -> f64 {
    let (sin_leaf, cos_leaf) = libm::sincos(inclination_rad);
    let (sin_sun, cos_sun) = libm::sincos(zenith_rad);
    let (upright, level) = (cos_sun * cos_leaf, sin_sun * sin_leaf);
    // Where no blade is seen from below all have the same sign.
    if upright >= level {
        return upright;
    }
    let turn = libm::acos((upright / level).clamp(-1.0, 1.0));
    upright + 2.0 / std::f64::consts::PI * (level * libm::sin(turn) - upright * turn)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn projections_are_means_over_the_compass() {
        for inclination in [0.0_f64, 20.0, 57.0, 75.0, 90.0] {
            for zenith in [0.0_f64, 15.0, 45.0, 80.0, 90.0] {
                let (sin, cos) = libm::sincos(inclination.to_radians());
                let normal = Vec3::new(sin as f32, cos as f32, 0.0);
                let (sin, cos) = libm::sincos(zenith.to_radians());
                let mean = (0..3600)
                    .map(|i| {
                        let (east, north) = libm::sincos((f64::from(i) / 10.0).to_radians());
                        normal.as_dvec3().dot(DVec3::new(sin * north, cos, sin * east)).abs()
                    })
                    .sum::<f64>()
                    / 3600.0;
                let found = projected(inclination.to_radians(), zenith.to_radians());
                assert!((found - mean).abs() < 1e-5, "{inclination} {zenith}: {found} {mean}");
            }
        }
    }
}
