//! The barks of a plant, as materials.

use linden_base::color::linear;
use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_skeleton::{AxisKind, NO_PARENT, Skeleton};

use super::{DEAD, DressError};
use crate::Specimen;
use crate::foot_bark;
use crate::moss;
use crate::scene::{Material, Wrap};
use crate::settings::{LIMBS, TWIGS};
use crate::surface::relief::Heights;
use crate::texture::{self, Bark, BarkError, BarkPictures};

/// Bark scatters light in all directions; nothing on it shines.
const BARK_ROUGHNESS: f32 = 0.9;

/// A bark of the trunk, bare and under more and more moss, where any grows.
#[derive(Clone)]
pub(super) struct Coat {
    pub bark: Material,
    pub mossy: Vec<Material>,
}

impl Coat {
    /// With its moss.
    fn new(bark: Material, specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<Self, DressError> {
        let mossy = moss::materials(specimen, &bark, monitor)?;
        Ok(Self { bark, mossy })
    }

    /// Bytes of all pictures.
    pub fn bytes(&self) -> u64 {
        picture_bytes(&self.bark) + moss::bytes(&self.mossy)
    }
}

/// Bytes of a bark's pictures.
pub(super) fn picture_bytes(bark: &Material) -> u64 {
    let pictures = [&bark.base_color_picture, &bark.normal_picture].into_iter().flatten();
    pictures.map(|picture| picture.rgba().len() as u64).sum()
}

/// What the trunk wears: its own bark; that of its foot and of the edge above that.
pub(super) fn coats(specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<(Coat, Vec<Coat>), DressError> {
    let trunk = Coat::new(bark(specimen, monitor)?, specimen, monitor)?;
    let foot = foot_bark::materials(specimen, monitor)?;
    let foot = foot.into_iter().map(|bark| Coat::new(bark, specimen, monitor)).collect::<Result<_, _>>()?;
    Ok((trunk, foot))
}

/// The bark, with pictures that are drawn or given by the user.
pub(super) fn bark(specimen: &Specimen<'_>, monitor: &dyn Monitor) -> Result<Material, DressError> {
    let look = &specimen.dressing.bark;
    let drawn = look.bark();
    if !specimen.wanted.colors {
        return Ok(bark_material("bark".to_owned(), drawn.color, None));
    }
    let find = |knob, file: &Option<String>| match file {
        None => Ok(None),
        Some(file) => match specimen.picture(file) {
            Some(picture) => Ok(Some(picture)),
            None => Err(DressError::NoPicture { knob, file: file.clone() }),
        },
    };
    let (color, normal) = (find("bark_picture", &look.picture)?, find("bark_normal", &look.normal)?);
    let (base_color, mean) = match color {
        Some(found) => (Some(texture::opaque(&found.picture)), found.mean_color),
        None => (None, drawn.color),
    };
    let normal = normal.map(|found| texture::opaque(&found.picture));
    let BarkPictures { base_color, normal } = match (base_color, normal) {
        (Some(base_color), Some(normal)) => BarkPictures { base_color, normal },
        (Some(base_color), None) => {
            let normal = specimen.drawn.relief(&base_color, drawn.relief, monitor)?;
            BarkPictures { base_color, normal }
        }
        (None, Some(normal)) => BarkPictures { normal, ..specimen.drawn.bark(&drawn, monitor)? },
        (None, None) => specimen.drawn.bark(&drawn, monitor)?,
    };
    let [n, p] = [&normal, &base_color].map(|picture| [picture.width(), picture.height()]);
    // To a pixel of the larger one's side.
    let [n_area, p_area] = [[n[0], p[1]], [p[0], n[1]]].map(|[w, h]| u64::from(w) * u64::from(h));
    if n_area.abs_diff(p_area) > u64::from(n[0].max(n[1]).max(p[0]).max(p[1])) {
        return Err(DressError::Proportions { normal: n, picture: p });
    }
    Ok(bark_material("bark".to_owned(), mean, Some(BarkPictures { base_color, normal })))
}

/// The barks of limbs and twigs, where they have one of their own.
pub(super) fn thin_barks(
    specimen: &Specimen<'_>,
    monitor: &dyn Monitor,
) -> Result<Vec<(&'static str, f32, Material)>, BarkError> {
    let barks = specimen.dressing.bark.thin_barks();
    let drawn = barks.into_iter().map(|(name, radius_m, bark)| {
        let pictures = specimen.wanted.colors.then(|| specimen.drawn.bark(&bark, monitor)).transpose()?;
        Ok((name, radius_m, bark_material(format!("bark_{name}"), bark.color, pictures)))
    });
    drawn.collect()
}

pub(crate) fn bark_material(name: String, mean: [u8; 3], pictures: Option<BarkPictures>) -> Material {
    let (base_color_picture, normal_picture) =
        pictures.map(|BarkPictures { base_color, normal }| (base_color, normal)).unzip();
    Material {
        name,
        base_color: linear(mean),
        base_color_picture,
        normal_picture,
        roughness: BARK_ROUGHNESS,
        double_sided: false,
        cutout: None,
        wrap: Wrap::Repeat,
        translucency: None,
        passing_picture: None,
    }
}

/// Values a row of the bark's heights: more than a mesh shows.
const HEIGHTS: usize = 256;

/// What is laid on the wood: drawn barks, that of the trunk and that of its foot, on the only level of a tree that stands
/// still.
pub(super) fn heights(specimen: &Specimen<'_>, is_blown: bool) -> Option<(Heights, Option<Heights>)> {
    let (look, detail) = (&specimen.dressing.bark, &specimen.dressing.detail);
    let is_whole = detail.levels() == 1 && detail.finest() == 0;
    let is_laid = look.relief_height_m > 0.0 && look.is_drawn() && is_whole && !is_blown;
    let of = |bark: Bark| Heights { values: bark.heights(HEIGHTS), side: HEIGHTS, relief: bark.relief };
    is_laid.then(|| (of(look.bark()), specimen.dressing.foot_bark().map(of)))
}

/// Height of the lowest foot of a stem, metres.
pub(super) fn foot_m(skeleton: &Skeleton) -> f32 {
    let stems = skeleton.axes.iter().filter(|axis| axis.parent == NO_PARENT);
    let feet = stems.filter_map(|axis| skeleton.nodes_of(axis).first());
    feet.map(|&foot| skeleton.positions[foot as usize].y).fold(f32::INFINITY, f32::min)
}

/// Of a scene's materials the bark of the thinnest living wood, and that of dead wood where there is any: what is seen of
/// wood from so far that it is lines.
pub fn thinnest_barks(materials: &[Material]) -> [Option<&Material>; 2] {
    let named = |ending: &str| {
        materials
            .iter()
            .find(|material| material.name.strip_prefix("bark_").is_some_and(|name| name == ending))
    };
    let living = named(TWIGS).or_else(|| named(LIMBS)).or(materials.first());
    [living, named(DEAD)]
}

/// Whether there are dead twigs.
pub(super) fn has_dead(skeleton: &Skeleton) -> bool {
    (0..skeleton.axes.len()).any(|axis| skeleton.kind_of(axis) == AxisKind::Dead)
}

/// Lays a bark that is not square on as it is: [`crate::surface::Tubes::bark_tile_m`] is its width.
pub(super) fn stretch(wood: &mut Mesh, bark: &Material) {
    let Some(picture) = &bark.base_color_picture else { return };
    if picture.width() != picture.height() {
        let aspect = picture.width() as f32 / picture.height() as f32;
        wood.uvs.iter_mut().for_each(|uv| uv.y *= aspect);
    }
}
