//! Draws pieces of foliage as they are seen from their own sides, side by side on one picture.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::clusters::Cut;
use super::frame::Frame;
use super::grain::Grain;
use super::laterals::Laterals;
use super::{PLANES, Pieces};
use crate::detail::DetailError;
use crate::detail::drawing::{
    self, CUTOUT, Canvas, Drawn, Finished, MARGIN_PX, Pile, Pixels, Resolved, SAMPLES, Texture, View,
    light_within,
};
use crate::detail::leaves::selected;
use crate::dress::Wardrobe;
use crate::foliage::Cover;
use crate::scene::Material;
use crate::texture::leaf::Cell;
use crate::{Body, Specimen};
use linden_base::color::code;
use linden_base::memory::bytes_of;
use linden_base::mesh::{Bounds, Mesh};
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::picture::PictureKey;
use linden_skeleton::{NO_PARENT, Skeleton};

/// How much of their tilt leaves keep on a card, whose normals are the crown's already.
const RELIEF: f32 = 0.4;
/// Thicker wood than this share of a piece's radius is not shown on its card: what stands elsewhere has none of it.
const THICKEST: f32 = 0.07;
/// The same of a tree without leaves, whose cards show nothing else.
const THICKEST_BARE: f32 = 0.3;
/// Pixels that a twig is wide, at the least, from edge to edge, but where twigs cover too much (`laterals`); a prism of four
/// sides is seen as wide as 0.7 of that.
const TWIG_PX: f32 = 1.6;
/// Cells that are drawn before they are laid, at the most: for any number of cores that machines have.
const CELLS_AT_ONCE: usize = 16;
/// The share of all cells that are, so that few large ones do not take more memory than many small ones.
const SHARE_AT_ONCE: usize = 4;
/// Directions that a piece is looked at from, to tell how much of it is seen.
const VIEWS: usize = 8;
/// How much of the wood of bare pieces is shown, as a share of what is seen of it: twigs that are wider hide less of each
/// other. Fitted to birch, oak and ash as Cycles shows them in 10000 and 4000 triangles.
const WOOD_SHOWN: f32 = 0.93;
/// Sides of the wood on a card.
const SIDES: u32 = 4;

/// The drawn cards.
pub(super) struct DrawnCards {
    /// One for each model, in units of its radius, by its own directions.
    pub meshes: Vec<Mesh>,
    pub cover: Cover,
}

impl DrawnCards {
    /// The mean colour, sRGB.
    pub fn color(&self) -> [u8; 3] {
        self.cover.cells.first().map_or([0; 3], |cell| cell.color)
    }
}

/// A plane of a card: its directions in the frame of the piece.
#[derive(Clone, Copy, Debug)]
struct Plane {
    right: Vec3,
    up: Vec3,
    toward: Vec3,
}

/// From above its plane, from its side, from its end.
const SEEN: [Plane; 3] = [
    Plane { right: Vec3::X, up: Vec3::Y, toward: Vec3::Z },
    Plane { right: Vec3::NEG_Z, up: Vec3::Y, toward: Vec3::X },
    Plane { right: Vec3::NEG_X, up: Vec3::Z, toward: Vec3::Y },
];

/// What is drawn in a cell.
#[derive(Debug)]
struct Sight {
    model: usize,
    /// See [`Grain::share`].
    share: f32,
    plane: Plane,
    low: Vec2,
    high: Vec2,
}

impl Sight {
    fn size(&self) -> Vec2 {
        (self.high - self.low).max(Vec2::splat(1e-3))
    }
}

/// A piece that is to be drawn.
#[derive(Clone, Copy)]
pub(super) struct CardSubject<'a> {
    pub level: &'a Pieces,
    pub piece: u32,
    pub frame: &'a Frame,
    /// See [`Deck::densities`](super::deck::Deck::densities).
    pub density: f32,
}

/// A piece as it is, in its own frame.
struct Model {
    /// Each with its material, first the wood.
    parts: Vec<(usize, Mesh)>,
    /// How many of these are wood, by bark.
    barks: usize,
    /// Thicker wood than this is not shown, radius in metres.
    thickest_m: f32,
    /// How much of the light that is lost within it is drawn as lost.
    shade_share: f32,
}

/// Draws the pieces of some levels.
///
/// # Errors
/// [`DetailError`]: memory, or cancelled.
pub(super) fn draw<'a>(
    models: impl Iterator<Item = CardSubject<'a>>,
    specimen: &Specimen<'_>,
    body: Body<'_>,
    wardrobe: &Wardrobe,
    (size_px, grain): (u32, Grain),
    monitor: &dyn Monitor,
) -> Result<DrawnCards, DetailError> {
    let plain = |bark: &Material| Material {
        base_color_picture: None,
        normal_picture: None,
        passing_picture: None,
        ..bark.clone()
    };
    // Among leaves, barks look alike.
    let (limits_m, mut materials): (Vec<f32>, Vec<Material>) = if grain.is_bare {
        wardrobe.barks().map(|(most_m, bark)| (most_m, plain(bark))).unzip()
    } else {
        (vec![f32::INFINITY], vec![plain(wardrobe.twig_bark())])
    };
    let models: Vec<CardSubject<'_>> = models.collect();
    let (mut drawn, sights) =
        built(&models, specimen, body, wardrobe, (&mut materials, &limits_m, grain), monitor)?;
    let sheet = Sheet::new(&sights, size_px);
    // Where nothing else is shown, fewer wide twigs cover what all thin ones do.
    let laterals = grain.is_bare.then(|| Laterals::of(body.skeleton));
    thicken(&mut drawn, &models, (&sights, sheet.scale), body.skeleton, &limits_m, laterals.as_ref());
    let size = Pixels::new(size_px, size_px);
    // Of the cells that are drawn at once, samples and what becomes of them.
    let mut largest: Vec<usize> = sights.iter().map(|sight| sheet.pixels(sight).area()).collect();
    largest.sort_unstable_by(|a, b| b.cmp(a));
    let cells_at_once = (sights.len() / SHARE_AT_ONCE).clamp(1, CELLS_AT_ONCE);
    let at_once: usize = largest.iter().take(cells_at_once).sum();
    let bytes = bytes_of::<Drawn>(at_once * (SAMPLES * SAMPLES) as usize)
        + Resolved::bytes(at_once)
        + Pile::bytes(size)
        + materials.iter().map(Texture::bytes_of).sum::<u64>();
    monitor.admit("drawing branch cards", bytes, "lower card_size").map_err(DetailError::from)?;
    let corners: Vec<Pixels> =
        sheet.cells.iter().map(|first| Pixels::new(first.x + MARGIN_PX, first.y + MARGIN_PX)).collect();
    let mut meshes = vec![Mesh::default(); drawn.len()];
    for (sight, corner) in sights.iter().zip(&corners) {
        add_plane(&mut meshes[sight.model], sight, *corner, sheet.scale * sight.share, size_px);
    }
    let decided_by = || decided_by(&drawn, &sights, &materials, size_px);
    // Mostly of leaves, where there are any.
    let translucency = materials.iter().find_map(|material| material.translucency);
    let [color, normal, passing] = specimen.drawn.cards(decided_by, monitor, || {
        let textures: Vec<Option<Texture>> = materials.par_iter().map(Texture::of).collect();
        let drawn_cell = |sight: &Sight| {
            let cell = sheet.pixels(sight);
            let inner = Pixels::new(cell.x - 2 * MARGIN_PX, cell.y - 2 * MARGIN_PX).times(SAMPLES);
            let Plane { right, up, toward } = sight.plane;
            let view = View {
                origin: Vec3::ZERO,
                right,
                up,
                toward,
                relief: RELIEF,
                cuts_whole: false,
                corner: Vec2::new(sight.low.x, sight.high.y),
                scale: sheet.scale * sight.share * SAMPLES as f32,
                first: Pixels::new(0, 0),
                size: inner,
            };
            let mut canvas = Canvas::new(inner);
            for (material, mesh) in &drawn[sight.model].parts {
                let texture = textures[*material].as_ref();
                drawing::draw(&mut canvas, &view, mesh, &materials[*material], texture, monitor)?;
            }
            let cell = Resolved::of(&canvas, SAMPLES);
            let lost = Vec3::ONE - light_within(canvas.layers(), cell.mean_color());
            Ok((cell, Vec3::ONE - drawn[sight.model].shade_share * lost))
        };
        let mut pile = Pile::new(size, SAMPLES);
        let placed: Vec<(&Sight, &Pixels)> = sights.iter().zip(&corners).collect();
        for some in placed.chunks(cells_at_once) {
            let cells = some.par_iter().map(|(sight, _)| drawn_cell(sight));
            let cells = cells.collect::<Result<Vec<(Resolved, Vec3)>, Cancelled>>()?;
            for ((_, corner), (cell, light)) in some.iter().zip(cells) {
                pile.lay(&cell, **corner, light);
            }
        }
        let Finished { color, normal, passing } = pile.finish(CUTOUT, true, monitor)?;
        Ok::<_, DetailError>([color, normal, passing].map(Arc::new))
    })?;
    let mean = drawing::mean(&color).map(code);
    let whole = Cell {
        min: Vec2::ZERO,
        max: Vec2::ONE,
        attach: Vec2::splat(0.5),
        unit: Vec2::ONE,
        outline: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        color: mean,
        stalk: Vec2::splat(0.5),
    };
    let cover = Cover {
        base_color: color,
        normal: Some(normal),
        cutout: Some(CUTOUT),
        cells: vec![whole],
        backs: Vec::new(),
        translucency,
        passing: translucency.map(|_| passing),
    };
    Ok(DrawnCards { meshes, cover })
}

/// The pieces of some levels and what is drawn of each, leaves as large as [`leaf_scale`] says of their level.
fn built(
    models: &[CardSubject<'_>],
    specimen: &Specimen<'_>,
    body: Body<'_>,
    wardrobe: &Wardrobe,
    (materials, limits_m, grain): (&mut Vec<Material>, &[f32], Grain),
    monitor: &dyn Monitor,
) -> Result<(Vec<Model>, Vec<Sight>), DetailError> {
    let thickest = if grain.is_bare { THICKEST_BARE } else { THICKEST };
    let (mut drawn, mut sights) = (Vec::new(), Vec::new());
    for (number, level) in models.chunk_by(|a, b| std::ptr::eq(a.level, b.level)).enumerate() {
        let mut build = |scale: f32| {
            let build = |subject: &CardSubject<'_>| {
                monitor.check()?;
                model(*subject, (scale, thickest, limits_m), specimen, body, wardrobe, materials, monitor)
            };
            level.iter().map(build).collect::<Result<Vec<Model>, DetailError>>()
        };
        let mut built = build(1.0)?;
        let shown = built.iter().zip(level).map(|(model, subject)| leaf_areas(model, subject.frame));
        let (cards, leaves) = shown.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
        let scale = leaf_scale(cards, leaves);
        if scale > 1.0 {
            built = build(scale)?;
        }
        for (model, subject) in built.into_iter().zip(level) {
            let share = grain.share(number);
            sights.extend(
                seen(drawn.len(), &model, subject.frame).into_iter().map(|sight| Sight { share, ..sight }),
            );
            drawn.push(model);
        }
    }
    Ok((drawn, sights))
}

/// All that is seen on the cards: a key of it.
fn decided_by(drawn: &[Model], sights: &[Sight], materials: &[Material], size_px: u32) -> PictureKey {
    let bytes_of_mesh = |mesh: &Mesh| {
        let Mesh { positions, normals, uvs, triangles } = mesh;
        let [positions, normals] = [positions, normals].map(|of| bytemuck::cast_slice(of));
        PictureKey::of(&[positions, normals, bytemuck::cast_slice(uvs), bytemuck::cast_slice(triangles)])
            .to_bytes()
    };
    let parts: Vec<Vec<(usize, [u8; 16])>> = drawn
        .par_iter()
        .map(|model| model.parts.iter().map(|(material, mesh)| (*material, bytes_of_mesh(mesh))).collect())
        .collect();
    let looks: Vec<_> = materials
        .iter()
        .map(|material| {
            let pictures = [&material.base_color_picture, &material.normal_picture];
            let pictures = pictures.map(|picture| picture.as_ref().map(|picture| picture.content()));
            (Material { base_color_picture: None, normal_picture: None, ..material.clone() }, pictures)
        })
        .collect();
    let shades: Vec<f32> = drawn.iter().map(|model| model.shade_share).collect();
    PictureKey::of(&[format!("{size_px} {parts:?} {sights:?} {looks:?} {shades:?}").as_bytes()])
}

/// How much of what leaves within a piece take from each other is drawn on its card. The cards of a crown shade each
/// other, too, and the more of them there are, the more of it they do; where normals point out of the crown they darken the side
/// that is off the light as well.
fn shade_share(pieces: usize, is_dome: bool) -> f32 {
    /// Fitted to six plants with such normals as Cycles shows them in 20000, 5000, 1000 and 500 triangles.
    const OF_FEW: f32 = 0.3;
    /// Without, to a spruce and a Douglas fir.
    const OF_FEW_FLAT: f32 = 0.4;
    const FEW: f32 = 250.0;
    let crowd = (pieces as f32 / FEW).max(1.0);
    (if is_dome { OF_FEW } else { OF_FEW_FLAT }) / crowd.sqrt().sqrt()
}

/// The leaves and the thin wood of a piece, the leaves larger by a factor, without wood that is thicker than a share of its
/// radius.
fn model(
    CardSubject { level, piece, frame, .. }: CardSubject<'_>,
    (scale, thickest, limits_m): (f32, f32, &[f32]),
    specimen: &Specimen<'_>,
    body: Body<'_>,
    wardrobe: &Wardrobe,
    materials: &mut Vec<Material>,
    monitor: &dyn Monitor,
) -> Result<Model, DetailError> {
    let Cut { piece_of, .. } = &level.cut;
    let is_in = |organ: usize| {
        piece_of.get(body.organs.growth(organ).node as usize) == Some(&piece)
            && level.forms.may_be_on_cards(body.organs, organ)
    };
    let organs = Arc::new(selected(body.organs, is_in, |_| scale));
    let thickest_m = frame.radius_m * thickest;
    let nodes: Vec<usize> = of_piece(level, piece).collect();
    let wood = wood(body.skeleton, &nodes, limits_m, [0.0, thickest_m], level);
    let barks = wood.len();
    let mut parts: Vec<(usize, Mesh)> = wood.into_iter().enumerate().collect();
    let (found, foliage) =
        wardrobe.foliage(specimen, &organs, monitor).map_err(crate::dress::DressError::from)?;
    for part in foliage {
        let material = found[part.material].clone();
        let known = materials.iter().position(|other| other.name == material.name);
        let at = known.unwrap_or_else(|| {
            materials.push(material);
            materials.len() - 1
        });
        parts.push((at, part.mesh));
    }
    for (_, mesh) in &mut parts {
        to_frame(mesh, frame);
    }
    let shade_share = shade_share(level.cut.pieces.len(), super::is_mostly_dome(&organs));
    Ok(Model { parts, barks, thickest_m, shade_share })
}

/// Makes thin wood as wide as its pixels ask for: in less than one it would be a row of dots.
fn thicken(
    drawn: &mut [Model],
    models: &[CardSubject<'_>],
    (sights, scale): (&[Sight], f32),
    skeleton: &Skeleton,
    limits_m: &[f32],
    laterals: Option<&Laterals>,
) {
    for planes in sights.chunks(PLANES) {
        let subject = models[planes[0].model];
        let CardSubject { level, piece, frame, density } = subject;
        let model = &mut drawn[planes[0].model];
        let thinnest_m = TWIG_PX / 2.0 * frame.radius_m / (scale * planes[0].share);
        let is_drawn = |node: usize| level.is_thin[node] && skeleton.radii[node] <= model.thickest_m;
        let (nodes, thinnest_m) = laterals.map_or_else(
            || (of_piece(level, piece).collect(), thinnest_m),
            |laterals| {
                let drawn = of_piece(level, piece).filter(|node| is_drawn(*node));
                let shown = shown_to_seen(skeleton, drawn, planes, frame);
                let share = WOOD_SHOWN * density / shown;
                laterals.thinned_out(skeleton, of_piece(level, piece), is_drawn, thinnest_m, share)
            },
        );
        let wood = wood(skeleton, &nodes, limits_m, [thinnest_m, model.thickest_m], level);
        for ((_, part), mut mesh) in model.parts.iter_mut().zip(wood) {
            to_frame(&mut mesh, frame);
            *part = mesh;
        }
    }
}

/// How many times more of the wood of a piece its card shows than is seen of it: both planes have all of it, seen from their
/// own sides.
fn shown_to_seen(
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

/// A mesh as a piece has it.
fn to_frame(mesh: &mut Mesh, frame: &Frame) {
    for position in &mut mesh.positions {
        *position = frame.local(*position);
    }
    for normal in &mut mesh.normals {
        *normal = frame.turned(*normal);
    }
}

/// The nodes of a piece.
fn of_piece(level: &Pieces, piece: u32) -> impl Iterator<Item = usize> {
    let pieces = level.cut.piece_of.iter().enumerate();
    pieces.filter(move |(_, of)| **of == piece).map(|(node, _)| node)
}

/// Thin wood as prisms without ends, no thinner than the first radius and without what is thicker than the other: a mesh
/// for each bark, of wood that is no thicker than its limit.
fn wood(
    skeleton: &Skeleton,
    nodes: &[usize],
    limits_m: &[f32],
    [thinnest_m, thickest_m]: [f32; 2],
    level: &Pieces,
) -> Vec<Mesh> {
    let mut meshes = vec![Mesh::default(); limits_m.len()];
    for &node in nodes {
        let (parent, radius_m) = (skeleton.parents[node], skeleton.radii[node]);
        if parent == NO_PARENT || !level.is_thin[node] || radius_m > thickest_m {
            continue;
        }
        let bark = limits_m.iter().position(|most_m| radius_m <= *most_m);
        let Some(mesh) = bark.and_then(|bark| meshes.get_mut(bark)) else { continue };
        let (from, to) = (skeleton.positions[parent as usize], skeleton.positions[node]);
        let Some(along) = (to - from).try_normalize() else { continue };
        let (u, v) = along.any_orthonormal_pair();
        // A lateral begins as thick as it goes on.
        let radii = [skeleton.radii[parent as usize].min(skeleton.radii[node] * 1.5), skeleton.radii[node]];
        let radii = radii.map(|radius_m| radius_m.max(thinnest_m));
        let first = mesh.positions.len() as u32;
        for (at, radius) in [from, to].into_iter().zip(radii) {
            for side in 0..SIDES {
                let (sin, cos) = libm::sincosf(std::f32::consts::TAU * side as f32 / SIDES as f32);
                let out = u * cos + v * sin;
                mesh.positions.push(at + out * radius);
                mesh.normals.push(out);
                mesh.uvs.push(Vec2::ZERO);
            }
        }
        for side in 0..SIDES {
            let (a, b) = (first + side, first + (side + 1) % SIDES);
            mesh.triangles.extend([[a, b, b + SIDES], [a, b + SIDES, a + SIDES]]);
        }
    }
    meshes
}

/// How much larger leaves are drawn whose cards show so much of them to who stands on the ground, where leaves themselves
/// would show so much: level ones are seen from their edges on upright planes, and by nobody else.
fn leaf_scale(cards: f64, leaves: f64) -> f32 {
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

/// The area of the leaves of a piece, hidden or not, as its card shows it and as it is: the mean over views from a little
/// above the horizon.
fn leaf_areas(model: &Model, frame: &Frame) -> (f64, f64) {
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

/// The planes that show most of a piece to who stands on the ground, and what they show.
fn seen(model: usize, of: &Model, frame: &Frame) -> Vec<Sight> {
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

/// Adds a rectangle with what is seen of it.
fn add_plane(mesh: &mut Mesh, sight: &Sight, inner: Pixels, scale: f32, size_px: u32) {
    let Plane { right, up, toward } = sight.plane;
    let first = mesh.positions.len() as u32;
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0_f32)] {
        let at = sight.low + sight.size() * Vec2::new(x, y);
        mesh.positions.push(right * at.x + up * at.y);
        mesh.normals.push(toward);
        let pixel = inner.to_vec2() + sight.size() * scale * Vec2::new(x, 1.0 - y);
        let uv = pixel / size_px as f32;
        mesh.uvs.push(Vec2::new(uv.x, 1.0 - uv.y));
    }
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// Where cells lie on a square: on shelves, the tallest first.
struct Sheet {
    /// Pixels of a radius.
    scale: f32,
    /// The upper left corner of each sight's cell.
    cells: Vec<Pixels>,
}

impl Sheet {
    /// In the largest scale in which all have room.
    fn new(sights: &[Sight], size_px: u32) -> Self {
        const STEPS: u32 = 20;
        let mut order: Vec<usize> = (0..sights.len()).collect();
        let tall = |at: usize| sights[at].size().y * sights[at].share;
        order.sort_by(|&a, &b| tall(b).total_cmp(&tall(a)).then(a.cmp(&b)));
        let (mut low, mut high) = (0.0, size_px as f32);
        let mut best = Self { scale: 1e-3, cells: vec![Pixels::new(0, 0); sights.len()] };
        for _ in 0..STEPS {
            let scale = f32::midpoint(low, high);
            match shelves(sights, &order, scale, size_px) {
                Some(cells) => (low, best) = (scale, Self { scale, cells }),
                None => high = scale,
            }
        }
        best
    }

    fn pixels(&self, sight: &Sight) -> Pixels {
        pixels(sight, self.scale)
    }
}

/// A cell with its margins.
fn pixels(sight: &Sight, scale: f32) -> Pixels {
    let size = (sight.size() * (scale * sight.share)).ceil();
    Pixels::new(size.x as u32 + 2 * MARGIN_PX, size.y as u32 + 2 * MARGIN_PX)
}

fn shelves(sights: &[Sight], order: &[usize], scale: f32, size_px: u32) -> Option<Vec<Pixels>> {
    let mut cells = vec![Pixels::new(0, 0); sights.len()];
    let (mut x, mut y, mut height) = (0, 0, 0);
    for &at in order {
        let size = pixels(&sights[at], scale);
        if size.x > size_px {
            return None;
        }
        if x + size.x > size_px {
            (x, y, height) = (0, y + height, 0);
        }
        height = height.max(size.y);
        if y + height > size_px {
            return None;
        }
        cells[at] = Pixels::new(x, y);
        x += size.x;
    }
    Some(cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::Simplifier;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;

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
    fn wood_has_the_bark_of_its_thickness() {
        let subject = Subject::builtin("hazel", &[("season", "1")]);
        let grown = subject.grow();
        let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
        let detail = simplifier.within(3000, true, &Quiet).unwrap();
        let level = simplifier.pieces(&detail, &Quiet).unwrap();
        let nodes: Vec<usize> = (0..grown.skeleton.positions.len()).collect();
        let triangles = |limits_m: &[f32]| -> Vec<usize> {
            let meshes = wood(&grown.skeleton, &nodes, limits_m, [0.0, 1.0], &level);
            meshes.iter().map(|mesh| mesh.triangles.len()).collect()
        };
        let [all, parts] = [&[f32::INFINITY][..], &[0.002, f32::INFINITY]].map(triangles);
        let is_thin = |node: &usize| level.is_thin[*node] && grown.skeleton.radii[*node] <= 0.002;
        let thin = nodes.iter().filter(|node| is_thin(node)).count() * 2 * SIDES as usize;
        assert!(parts[0].abs_diff(thin) <= thin / 100 && parts[1] > 0, "{parts:?}, {thin}");
        assert_eq!(parts[0] + parts[1], all[0]);
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
