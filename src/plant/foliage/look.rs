//! A kind of leaves → its picture.

use std::sync::Arc;

use glam::Vec2;

use super::Calendar;
use super::cluster::Layout;
use super::mesh::FoliageError;
use crate::Specimen;
use crate::scene::Translucency;
use crate::settings::{Arrangement, Cluster, Edge, Form, LeafKind, TURNING};
use crate::texture::leaf::{self, Cell, LeafLook, LeafPictures, Margin, Outline, TwigLook};
use linden_base::input::A_PICTURE;
use linden_base::monitor::Monitor;
use linden_base::picture::Picture;
use linden_base::random::Key;

/// The pictures that cover the organs of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    /// sRGB; with alpha where something is to be cut out.
    pub base_color: Arc<Picture>,
    /// Tangent-space normals, OpenGL convention.
    pub normal: Option<Arc<Picture>>,
    /// The alpha of the picture below which nothing is drawn: see [`Material::cutout`](crate::scene::Material::cutout).
    pub cutout: Option<f32>,
    /// Where each variant of the organ is in the picture; at least one.
    pub cells: Vec<Cell>,
    /// Where the under side of each is, in the same order; empty where it looks like the upper one.
    pub backs: Vec<Cell>,
    /// What passes through the organ.
    pub translucency: Option<Translucency>,
    /// How much of that passes where: see [`Material::passing_picture`](crate::scene::Material::passing_picture).
    pub passing: Option<Arc<Picture>>,
}

impl Cover {
    /// The picture whose alpha says what is cut out; `None`: all is opaque.
    pub(crate) fn mask(&self) -> Option<&Arc<Picture>> {
        self.cutout.map(|_| &self.base_color)
    }
}

/// The alpha at the rim of a leaf. What has to be seen from afar is cut lower: see [`Cover::cutout`].
pub const RIM: f32 = 0.5;
/// Side of one colour of a palette, pixels: enough that smaller copies of the picture do not mix two.
const SWATCH_PX: u32 = 16;
/// How far leaves of the shade are darker where nothing is said.
const USUAL_SHADE: f32 = 0.5;
/// The season that evergreens are always in.
const SUMMER: f32 = 0.35;

/// The cover of the `index`-th kind, its drawn pictures of `size_px` pixels a side.
///
/// # Errors
/// [`FoliageError`]: a file that is missing or no picture, too little memory, or cancelled.
pub fn cover(
    specimen: &Specimen<'_>,
    index: usize,
    kind: &LeafKind,
    size_px: u32,
    monitor: &dyn Monitor,
) -> Result<Cover, FoliageError> {
    let translucency = translucency(kind);
    if let Some(file) = &kind.picture {
        let Some(found) = specimen.picture(file) else {
            return Err(FoliageError::WrongInput { file: file.clone(), expected: A_PICTURE });
        };
        // What an outline turns to is not known of a picture: it has the colours that were asked for.
        let look = look(kind, specimen.dressing.foliage.season as f32, size_px);
        let autumn_colors = if kind.autumn_colors.is_some() { look.autumn_colors } else { Vec::new() };
        let bytes = found.picture.bytes();
        monitor.admit("drawing a picture in its season", bytes, "take a smaller picture")?;
        let turned = LeafLook { autumn_colors, ..look }.in_season(&found.picture);
        return Ok(Cover {
            base_color: turned.map_or_else(|| Arc::clone(&found.picture), Arc::new),
            normal: None,
            cutout: found.has_alpha.then(|| leaf::cutout(&found.picture)),
            cells: vec![Cell::whole(found)],
            backs: Vec::new(),
            translucency,
            passing: None,
        });
    }
    let season = specimen.dressing.foliage.season as f32;
    let needle_scale = specimen.dressing.foliage.needle_scale;
    let look = LeafLook { needle_scale, ..look(kind, season, size_px) }.from_shade_to_sun();
    if kind.form == Form::Mesh {
        // No outline has usual colours for it: it has those that were asked for.
        let autumn_colors = if kind.autumn_colors.is_some() { look.autumn_colors } else { Vec::new() };
        let cover = palette(&LeafLook { autumn_colors, ..look }.plain_colors());
        return Ok(Cover { translucency, ..cover });
    }
    let key = Key::new(specimen.dressing.foliage.picture_seed).named("leaf pictures").child(index as u64);
    let twig = (kind.form == Form::Twig).then(|| twig(kind));
    let LeafPictures { base_color, cutout, normal, cells, backs } =
        specimen.drawn.leaves(look, twig, key, monitor)?;
    let (normal, cutout) = (Some(normal), Some(cutout));
    // What passes one face would be lost behind the other: both reflect all of it.
    let translucency = translucency.filter(|_| backs.is_empty());
    Ok(Cover { base_color, normal, cutout, cells, backs, translucency, passing: None })
}

fn translucency(kind: &LeafKind) -> Option<Translucency> {
    // The user's mesh may be of any thickness.
    let usual = if kind.form == Form::Mesh { 0.0 } else { kind.outline.translucency() };
    let share = kind.translucency.map_or(usual, |share| share as f32);
    let is_green = !matches!(kind.outline, Outline::Blossom | Outline::Fruit);
    let tint = if is_green { Translucency::LEAF_TINT } else { [1.0; 3] };
    Translucency::leaf(share).map(|leaf| Translucency { tint, ..leaf })
}

/// How far leaves of the shade differ from those of the sun.
pub(super) fn shade(kind: &LeafKind) -> f32 {
    let usual = if matches!(kind.outline, Outline::Blossom | Outline::Fruit) { 0.0 } else { USUAL_SHADE };
    kind.shade.map_or(usual, |shade| shade as f32)
}

/// How wide a kind's needles are, as a share of what stands at one place; `None`: it has none, or none that are drawn.
pub(crate) fn needle_width(kind: &LeafKind) -> Option<f32> {
    let is_drawn = kind.picture.is_none() && !matches!(kind.form, Form::None | Form::Mesh);
    let width = look(kind, SUMMER, 1).needle_width().filter(|_| is_drawn)?;
    Some(if kind.form == Form::Twig { width * (kind.length_m / card_m(kind)) as f32 } else { width })
}

/// What a kind's leaves look like in a season, in a picture of a size.
pub(super) fn look(kind: &LeafKind, season: f32, size_px: u32) -> LeafLook {
    let usual = LeafLook::new(kind.outline);
    let is_clustered_fruit = kind.cluster != Cluster::None && kind.outline == Outline::Fruit;
    LeafLook {
        width: kind.width.map_or(usual.width, |width| width as f32),
        lobes: match kind.lobes {
            // A cluster's fruit hang one by one, on stalks of the cluster's.
            _ if is_clustered_fruit => 1,
            0 => usual.lobes,
            lobes => lobes,
        },
        lobe_depth: kind.lobe_depth.map_or(usual.lobe_depth, |depth| depth as f32),
        margin: match kind.margin {
            Edge::Auto => usual.margin,
            Edge::Entire => Margin::Entire,
            Edge::Serrate => Margin::Serrate,
            Edge::Crenate => Margin::Crenate,
        },
        // The stalk of a fan bears all its leaflets, which have none of their own.
        petiole: match kind.form {
            _ if is_clustered_fruit => 0.05,
            Form::Fan => 0.02,
            _ => kind.petiole.map_or(usual.petiole, |petiole| petiole as f32),
        },
        colors: kind.colors.clone().unwrap_or(usual.colors),
        back_colors: kind.back_colors.clone().unwrap_or_default(),
        autumn_colors: if kind.evergreen {
            Vec::new()
        } else {
            kind.autumn_colors.clone().unwrap_or(usual.autumn_colors)
        },
        young_colors: if kind.evergreen { Vec::new() } else { kind.young_colors.clone().unwrap_or_default() },
        ripeness: (!kind.evergreen).then(|| Calendar::of(kind).ripeness(season)),
        turning: turning(kind),
        petal_rows: kind.petal_rows,
        has_stalk_color: kind.cluster != Cluster::None,
        color_spread: kind.tint_spread as f32,
        shade: shade(kind),
        season: if kind.evergreen { SUMMER } else { season },
        size_px,
        ..LeafLook::new(kind.outline)
    }
}

/// The seasons between which a kind turns, in their order.
fn turning(kind: &LeafKind) -> [f32; 2] {
    let at = |i: usize| kind.turn_range.get(i).copied().unwrap_or(TURNING[i]) as f32;
    [at(0).min(at(1)), at(0).max(at(1))]
}

fn twig(kind: &LeafKind) -> TwigLook {
    let leaf_length_m = kind.length_m as f32;
    TwigLook {
        leaves: kind.twig_leaves,
        arrangement: match kind.arrangement {
            Arrangement::Alternate => leaf::Arrangement::Alternate,
            Arrangement::Spiral => leaf::Arrangement::Spiral,
            _ => leaf::Arrangement::Opposite,
        },
        length_m: (card_m(kind) as f32 - leaf_length_m).max(leaf_length_m / 4.0),
        leaf_length_m,
        tuft: kind.twig_tuft as f32,
        shoots: kind.twig_shoots,
        ..TwigLook::default()
    }
}

/// Of what stands at one place: a leaf, a whole twig card or cluster, metres.
pub(super) fn length_m(kind: &LeafKind) -> f64 {
    if kind.cluster != Cluster::None {
        return Layout::of(kind).height_m();
    }
    match kind.form {
        Form::Twig => card_m(kind),
        _ => kind.length_m,
    }
}

/// Of a twig card, metres.
fn card_m(kind: &LeafKind) -> f64 {
    kind.twig_length_m.unwrap_or(4.0 * kind.length_m)
}

/// One colour for each cell: for what has a shape of its own.
fn palette(colors: &[[u8; 3]]) -> Cover {
    let columns = (1..=colors.len()).find(|n| n * n >= colors.len()).unwrap_or(1) as u32;
    let side = columns * SWATCH_PX;
    let mut rgba = Vec::with_capacity((side * side * 4) as usize);
    for y in 0..side {
        for x in 0..side {
            let swatch = (y / SWATCH_PX * columns + x / SWATCH_PX) as usize;
            let [r, g, b] = colors.get(swatch).or(colors.last()).copied().unwrap_or_default();
            rgba.extend([r, g, b, 255]);
        }
    }
    let cell = |(i, &color): (usize, &[u8; 3])| {
        let i = i as u32;
        // Rows run down and V up.
        let corner = Vec2::new((i % columns) as f32, (columns - 1 - i / columns) as f32);
        let middle = (corner + 0.5) / columns as f32;
        let half = Vec2::splat(0.25 / columns as f32);
        let (min, max) = (middle - half, middle + half);
        let outline = vec![min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)];
        let attach = Vec2::new(middle.x, min.y);
        Cell { min, max, attach, unit: half * 2.0, outline, color, stalk: middle }
    };
    Cover {
        base_color: Arc::new(Picture::new(side, side, rgba)),
        normal: None,
        cutout: None,
        cells: colors.iter().enumerate().map(cell).collect(),
        backs: Vec::new(),
        translucency: None,
        passing: None,
    }
}
