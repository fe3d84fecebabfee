//! Pieces as they are drawn: their leaves and thin wood, each in its own frame.

use std::sync::Arc;

use glam::Vec2;
use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_skeleton::{NO_PARENT, Skeleton};

use super::clusters::Cut;
use super::frame::Frame;
use super::grain::Grain;
use super::laterals::Laterals;
use super::sight::{Sight, leaf_areas, leaf_scale, seen, shown_to_seen};
use super::{PLANES, Pieces};
use crate::detail::DetailError;
use crate::detail::leaves::selected;
use crate::dress::Wardrobe;
use crate::scene::Material;
use crate::{Body, Specimen};

/// Thicker wood than this share of a piece's radius is not shown on its card: what stands elsewhere has none of it.
const THICKEST: f32 = 0.07;

/// The same of a tree without leaves, whose cards show nothing else.
const THICKEST_BARE: f32 = 0.3;

/// Pixels that a twig is wide, at the least, from edge to edge, but where twigs cover too much (`laterals`); a prism of four
/// sides is seen as wide as 0.7 of that.
const TWIG_PX: f32 = 1.6;

/// How much of the wood of bare pieces is shown, as a share of what is seen of it: twigs that are wider hide less of each
/// other. Fitted to birch, oak and ash as Cycles shows them in 10000 and 4000 triangles.
const WOOD_SHOWN: f32 = 0.93;

/// Sides of the wood on a card.
const SIDES: u32 = 4;

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
pub(super) struct Model {
    /// Each with its material, first the wood.
    pub parts: Vec<(usize, Mesh)>,
    /// How many of these are wood, by bark.
    pub barks: usize,
    /// Thicker wood than this is not shown, radius in metres.
    pub thickest_m: f32,
    /// How much of the light that is lost within it is drawn as lost.
    pub shade_share: f32,
}

/// The pieces of some levels and what is drawn of each, leaves as large as [`leaf_scale`] says of their level.
pub(super) fn built(
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
pub(super) fn thicken(
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::Simplifier;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;

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
}
