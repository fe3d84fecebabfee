//! What leaves are made of: a mesh for each variant of a kind's picture.
//!
//! A form is one unit long along +Y from its foot at the origin and shows its upper side to +Z, as the
//! organs of a grammar do. Cards are as large as what is drawn on them, so that a picture is never
//! stretched.

use glam::{Mat3, Vec2, Vec3};

use super::cluster;
use super::look::Cover;
use super::mesh::FoliageError;
use linden_base::input::TriangleMesh;
use linden_skeleton::organs::LeafShape;

use crate::settings::{Cluster, Form, LeafKind, LodForm, Normals};
use crate::texture::leaf::Cell;
use linden_base::mesh::{Bounds, Mesh};

/// The most triangles of a user's mesh: there will be thousands of it.
pub(super) const MAX_TRIANGLES: usize = 20_000;

/// The variants of the `index`-th kind, one for each cell of its picture, with those of levels of detail.
///
/// # Errors
/// [`FoliageError`]: a user's mesh that cannot be used.
pub(super) fn shapes(
    (index, kind): (usize, &LeafKind),
    lods: &[LodForm],
    Cover { cells, backs, .. }: &Cover,
    users_mesh: Option<&TriangleMesh>,
) -> Result<Vec<LeafShape>, FoliageError> {
    let made = |kind: &LeafKind, variant: usize, cell: &Cell| {
        let users =
            users_mesh.filter(|_| kind.form == Form::Mesh).map(|mesh| users(mesh, cell)).transpose()?;
        let upper = match (kind.cluster, users) {
            (_, None) if kind.form == Form::Mesh => Mesh::default(),
            (Cluster::None, Some(mesh)) => mesh,
            (Cluster::None, None) => single(kind, cell),
            (_, users) => cluster::cluster(kind, variant, cells, users.as_ref())?,
        };
        Ok::<_, FoliageError>(match backs.get(variant) {
            Some(back) => with_back(upper, back.attach - cell.attach),
            None => upper,
        })
    };
    let lods: Vec<LeafKind> = lods.iter().map(|lod| in_form(kind, index, *lod)).collect::<Result<_, _>>()?;
    let shape = |(variant, cell): (usize, &Cell)| {
        let mesh = made(kind, variant, cell)?;
        let sketch = sketch(kind, cell, &mesh);
        let is_dome = kind.normals == Normals::Dome;
        let lods = lods.iter().map(|kind| made(kind, variant, cell)).collect::<Result<_, _>>()?;
        let faces = if backs.is_empty() { 1 } else { 2 };
        Ok(LeafShape { kind: index as u8, mesh, sketch, color: cell.color, is_dome, faces, lods })
    };
    cells.iter().enumerate().map(shape).collect()
}

/// How far the under side lies below the upper one, in lengths of the leaf: less than it is thick, and enough that rays, and
/// from near depth buffers, tell the two where both sides of everything are drawn.
const FACE_GAP: f32 = 1e-3;

/// A leaf of two faces, each seen from its own side: the second is the first turned over, with what lies `moved` from it
/// in the picture.
fn with_back(mut upper: Mesh, moved: Vec2) -> Mesh {
    let first = upper.positions.len() as u32;
    let below = |(&p, &n): (&Vec3, &Vec3)| p - n * FACE_GAP;
    upper.positions.extend(upper.positions.iter().zip(&upper.normals).map(below).collect::<Vec<_>>());
    upper.normals.extend_from_within(..);
    upper.normals[first as usize..].iter_mut().for_each(|normal| *normal = -*normal);
    upper.uvs.extend_from_within(..);
    upper.uvs[first as usize..].iter_mut().for_each(|uv| *uv += moved);
    let turned = |&[a, b, c]: &[u32; 3]| [a, c, b].map(|vertex| first + vertex);
    upper.triangles.extend(upper.triangles.iter().map(turned).collect::<Vec<_>>());
    upper
}

/// Forms that can stand for each other, with the same picture.
const EXCHANGEABLE: [Form; 4] = [Form::Card, Form::Cross, Form::Tuft, Form::Curved];

/// The `index`-th kind as a level of detail has it.
fn in_form(kind: &LeafKind, index: usize, lod: LodForm) -> Result<LeafKind, FoliageError> {
    let form = match lod {
        // Cards show it as it is.
        LodForm::BranchCard => kind.form,
        LodForm::Leaves(form) => form,
    };
    let can_change = kind.form == Form::Twig || EXCHANGEABLE.contains(&kind.form);
    if form != kind.form && !(can_change && EXCHANGEABLE.contains(&form)) {
        return Err(FoliageError::LodForm { kind: index + 1, form: kind.form.word(), wanted: form.word() });
    }
    Ok(LeafKind { form, ..kind.clone() })
}

/// One leaf, or whatever stands alone.
fn single(kind: &LeafKind, cell: &Cell) -> Mesh {
    match kind.form {
        Form::None | Form::Mesh => Mesh::default(),
        Form::Card => card(cell),
        Form::Cross => crossed(cell, 2),
        Form::Tuft => crossed(cell, 3),
        Form::Curved => curved(cell),
        Form::Twig => twig(cell),
        Form::Fan => fan(kind, cell),
    }
}

/// A member of a cluster, one unit long, along +Y.
pub(super) fn member(kind: &LeafKind, cell: &Cell) -> Mesh {
    if cluster::is_round(kind) { cluster::round(kind, cell) } else { single(kind, cell) }
}

/// What is drawn in a cell, in units of the leaf: lower left and upper right corner.
fn extent(cell: &Cell) -> (Vec2, Vec2) {
    ((cell.min - cell.attach) / cell.unit, (cell.max - cell.attach) / cell.unit)
}

/// A sheet that shows a cell: a lattice at some places across and along, bent by `bend`.
fn sheet(cell: &Cell, across: &[f32], along: &[f32], bend: impl Fn(Vec2) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for &y in along {
        for &x in across {
            let at = Vec2::new(x, y);
            mesh.positions.push(bend(at));
            // Within the cell, whatever the rounding.
            mesh.uvs.push((cell.attach + at * cell.unit).clamp(cell.min, cell.max));
        }
    }
    let columns = across.len() as u32;
    for row in 0..along.len() as u32 - 1 {
        for column in 0..columns - 1 {
            let a = row * columns + column;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.with_smooth_normals()
}

fn card(cell: &Cell) -> Mesh {
    let (low, high) = extent(cell);
    sheet(cell, &[low.x, high.x], &[low.y, high.y], |at| at.extend(0.0))
}

/// A dry leaf, bent along and across.
pub(super) fn curled(cell: &Cell) -> Mesh {
    let (low, high) = extent(cell);
    let along = [low.y, 0.5 * (low.y + high.y), high.y];
    sheet(cell, &middle(low.x, high.x), &along, |at| hanging(at, -0.5, 0.5))
}

/// Cards about the heading.
fn crossed(cell: &Cell, cards: u32) -> Mesh {
    let mut all = Mesh::default();
    for i in 0..cards {
        let turn = Mat3::from_rotation_y(std::f32::consts::PI * i as f32 / cards as f32);
        append(&mut all, &card(cell), |p| turn * p);
    }
    all
}

/// How far a curved blade turns from its foot to its tip, radians.
const BEND: f32 = 0.65;
/// How much its halves rise off the midrib.
const FOLD: f32 = 0.22;

/// Two quads across and three along: hanging towards its tip, folded along its midrib.
fn curved(cell: &Cell) -> Mesh {
    let (low, high) = extent(cell);
    let along: Vec<f32> = (0..4).map(|i| low.y + (high.y - low.y) * i as f32 / 3.0).collect();
    sheet(cell, &middle(low.x, high.x), &along, |at| hanging(at, BEND, FOLD))
}

/// How far each card of a twig is rolled about the shoot, radians.
const ROLL: f32 = 0.6;

/// Two cards that hang a little and cross in the shoot, at an angle at which leaves stand round one: from
/// the side a level shoot shows leaves too.
fn twig(cell: &Cell) -> Mesh {
    let (low, high) = extent(cell);
    let along: Vec<f32> = (0..3).map(|i| low.y + (high.y - low.y) * i as f32 / 2.0).collect();
    let flat = sheet(cell, &middle(low.x, high.x), &along, |at| Vec3::new(at.x, at.y, 0.0));
    let mut all = Mesh::default();
    for roll in [ROLL, -ROLL] {
        let turn = Mat3::from_rotation_y(roll);
        append(&mut all, &flat, |p| turn * p);
    }
    for position in &mut all.positions {
        // The whole shoot hangs: what stands off its axis stays square to it.
        let bent = hanging(Vec2::new(0.0, position.y), 0.35, 0.0);
        let (sin, cos) = libm::sincosf(0.35 * position.y);
        *position = bent + Vec3::new(position.x, position.z * sin, position.z * cos);
    }
    all.with_smooth_normals()
}

/// From edge to edge over the midrib.
fn middle(left: f32, right: f32) -> Vec<f32> {
    if left < 0.0 && right > 0.0 {
        vec![left, 0.0, right]
    } else {
        vec![left, f32::midpoint(left, right), right]
    }
}

/// A point of a flat leaf where it is on one that bends down along a circle and whose halves rise.
fn hanging(at: Vec2, bend: f32, fold: f32) -> Vec3 {
    let (sin, cos) = libm::sincosf(bend * at.y);
    let upright = 1.0 / (1.0 + fold * fold).sqrt();
    let rise = fold * upright * at.x.abs();
    // Off the circle, along its radius.
    let along = sin / bend + rise * sin;
    Vec3::new(at.x * upright, along, (cos - 1.0) / bend + rise * cos)
}

/// Leaflets of a fan, where the settings give none.
const LEAFLETS: u32 = 5;
/// The stalk's share, where the settings give none.
const STALK: f32 = 0.3;
/// Half the angle over which a fan is spread, radians.
const SPREAD: f32 = 1.45;

/// Leaflets that spread from the end of a stalk, the middle one the longest.
fn fan(kind: &LeafKind, cell: &Cell) -> Mesh {
    let stalk = kind.petiole.map_or(STALK, |petiole| petiole as f32);
    let (low, high) = extent(cell);
    let half = 0.008;
    // The stalk shows the midrib of the leaf.
    let mut all = sheet(cell, &[-half, half], &[0.0, stalk], |at| at.extend(0.0));
    for uv in &mut all.uvs {
        uv.y = cell.attach.y + 0.3 * cell.unit.y;
    }
    let along = [low.y, low.y + 0.5 * (high.y - low.y), high.y];
    for (angle, length) in leaflets(kind) {
        let turn = Mat3::from_rotation_z(angle);
        let leaflet = sheet(cell, &[low.x, high.x], &along, |at| hanging(at, 0.8, 0.0));
        let length = length * (1.0 - stalk);
        append(&mut all, &leaflet, |p| turn * p * length);
        let first = all.positions.len() - leaflet.positions.len();
        for position in &mut all.positions[first..] {
            position.y += stalk;
        }
    }
    all
}

/// Where each leaflet of a fan points to, radians, and its share of the longest one's length.
fn leaflets(kind: &LeafKind) -> Vec<(f32, f32)> {
    let count = if kind.lobes == 0 { LEAFLETS } else { kind.lobes };
    let leaflet = |i: u32| {
        let place = if count > 1 { 2.0 * i as f32 / (count - 1) as f32 - 1.0 } else { 0.0 };
        (place * SPREAD, 1.0 - 0.4 * place * place)
    };
    (0..count).map(leaflet).collect()
}

/// A user's mesh: its lowest point at the origin, one unit high.
fn users(model: &TriangleMesh, cell: &Cell) -> Result<Mesh, FoliageError> {
    let triangles = model.triangles.len();
    if triangles > MAX_TRIANGLES {
        return Err(FoliageError::MeshTooLarge { triangles, limit: MAX_TRIANGLES });
    }
    let mut used = vec![false; model.positions.len()];
    model.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let corners = model.positions.iter().zip(&used).filter(|(_, used)| **used).map(|(p, _)| *p);
    let (low, high) = corners
        .fold(None, |box_, p| match box_ {
            None => Some((p, p)),
            Some((low, high)) => Some((p.min(low), p.max(high))),
        })
        .ok_or(FoliageError::MeshFlat)?;
    let size = high - low;
    if !(size.y > 1e-6 * size.max_element()) {
        return Err(FoliageError::MeshFlat);
    }
    // About the axis that it was modelled on, where that runs through it.
    let hangs = low.x <= 0.0 && high.x >= 0.0 && low.z <= 0.0 && high.z >= 0.0;
    let foot = if hangs { low.with_x(0.0).with_z(0.0) } else { (low + high).with_y(2.0 * low.y) / 2.0 };
    let mut index = vec![u32::MAX; used.len()];
    let mut mesh = Mesh::default();
    for (vertex, &position) in model.positions.iter().enumerate().filter(|(vertex, _)| used[*vertex]) {
        index[vertex] = mesh.positions.len() as u32;
        mesh.positions.push(((position - foot) / size.y).as_vec3());
        let share = (position - low) / size.max(glam::DVec3::splat(1e-12));
        let share = Vec2::new(share.x as f32, share.y as f32);
        mesh.uvs.push(cell.min + share * (cell.max - cell.min));
    }
    mesh.triangles = model.triangles.iter().map(|corners| corners.map(|v| index[v as usize])).collect();
    Ok(mesh.with_smooth_normals())
}

/// Longer across than along by this, a mesh lies on its side.
const LYING: f64 = 2.5;

/// What the user should know of a mesh of a leaf: that its longest side is not the one that leaves point along, as
/// in files from programs whose Z is up.
pub fn mesh_note(file: &str, model: &TriangleMesh) -> Option<String> {
    let corners = model.triangles.iter().flatten().filter_map(|&vertex| model.positions.get(vertex as usize));
    let (low, high) = corners.fold(None, |found: Option<(glam::DVec3, glam::DVec3)>, &p| {
        Some(found.map_or((p, p), |(low, high)| (low.min(p), high.max(p))))
    })?;
    let size = high - low;
    let (axis, longest) = if size.z > size.x { ("Z", size.z) } else { ("X", size.x) };
    (longest > LYING * size.y).then(|| {
        format!(
            "leaf_mesh: '{}' is {:.1} times as long along {axis} as along Y, which leaves point along from their foot \
             (upper side +Z); if it lies on its side, export it with Y up",
            linden_base::knob::printable(file),
            longest / size.y.max(f64::MIN_POSITIVE),
        )
    })
}

/// Adds a mesh, its vertices moved by a rotation and a uniform scale.
fn append(all: &mut Mesh, other: &Mesh, place: impl Fn(Vec3) -> Vec3) {
    let first = all.positions.len() as u32;
    all.positions.extend(other.positions.iter().map(|&p| place(p)));
    all.normals.extend(other.normals.iter().map(|&n| place(n).normalize_or(Vec3::Z)));
    all.uvs.extend_from_slice(&other.uvs);
    all.triangles.extend(other.triangles.iter().map(|t| t.map(|v| first + v)));
}

/// Leaves that are shown of a twig card at most.
const SKETCHED_LEAVES: u32 = 9;

/// Rhombs in place of leaves.
fn sketch(kind: &LeafKind, cell: &Cell, mesh: &Mesh) -> Mesh {
    if kind.cluster != Cluster::None && kind.form != Form::None {
        return cluster::sketch(kind, cell);
    }
    let (low, high) = extent(cell);
    let half = ((high.x - low.x) / 2.0).min(1.0);
    let mut all = Mesh::default();
    let mut rhomb = |foot: Vec2, angle: f32, length: f32, half: f32, turn: f32| {
        let heading = Mat3::from_rotation_z(angle);
        let turn = Mat3::from_rotation_y(turn);
        let first = all.positions.len() as u32;
        for (x, y) in [(0.0, 0.0), (half, 0.45), (0.0, 1.0), (-half, 0.45)] {
            let flat = heading * (Vec3::new(x, y, 0.0) * length) + foot.extend(0.0);
            all.positions.push(turn * flat);
            all.normals.push(turn * Vec3::Z);
            all.uvs.push(cell.attach);
        }
        all.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    let quarter = std::f32::consts::FRAC_PI_2;
    match kind.form {
        Form::None => {}
        Form::Card | Form::Curved => rhomb(Vec2::ZERO, 0.0, high.y, half, 0.0),
        Form::Cross => {
            for turn in [0.0, quarter] {
                rhomb(Vec2::ZERO, 0.0, high.y, half, turn);
            }
        }
        Form::Twig => {
            let shown = kind.twig_leaves.min(SKETCHED_LEAVES);
            let length = (kind.length_m / super::look::length_m(kind)) as f32;
            // Fewer leaves, larger ones.
            let length = length * (kind.twig_leaves as f32 / shown as f32).sqrt();
            for i in 0..shown {
                let along = (1.0 - length).max(0.0) * (i + 1) as f32 / shown as f32;
                let side = if i + 1 == shown { 0.0 } else { [0.9, -0.9][i as usize % 2] };
                rhomb(Vec2::Y * along, side, length, 0.3, 0.0);
            }
        }
        Form::Fan => {
            let stalk = kind.petiole.map_or(STALK, |petiole| petiole as f32);
            for (angle, length) in leaflets(kind) {
                rhomb(Vec2::Y * stalk, angle, length * (1.0 - stalk), half, 0.0);
            }
        }
        Form::Tuft => {
            for i in 0..6_u8 {
                let turn = f32::from(i) * quarter * 2.0 / 3.0;
                let along = 0.12 * f32::from(i);
                rhomb(Vec2::Y * along, [0.5, -0.5][usize::from(i % 2)], 0.5, 0.04, turn);
            }
        }
        Form::Mesh => {
            const SMALL: usize = 64;
            if mesh.triangles.len() <= SMALL {
                return mesh.clone();
            }
            if let Some(Bounds { min, max }) = mesh.bounds() {
                let half = (max - min).x.max((max - min).z) / 2.0;
                for turn in [0.0, quarter] {
                    rhomb(Vec2::ZERO, 0.0, 1.0, half, turn);
                }
            }
        }
    }
    all
}
