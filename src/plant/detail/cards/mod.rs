//! Branch cards: the twigs of a tree, leafy or bare, as pictures of a few of them, on crossed planes where they hang.
//!
//! Foliage is cut into pieces that hang together (`clusters`), as large as a budget of triangles asks for: twigs,
//! branches, limbs. A few pieces, each the one that is most like its group (`deck`), are drawn into one atlas as
//! they are seen from their own sides, leaves and thin wood alike (`draw`). The cards are organs like leaves
//! ([`Organs`]): exporters, instances and wind take them as such.

mod clusters;
mod deck;
mod draw;
mod frame;
mod grain;
mod laterals;
mod model;
mod sheet;
mod sight;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::Vec3;

use super::forms::LevelForms;
use super::{DetailError, Simplifier};
use crate::dress::Wardrobe;
use crate::foliage::Cover;
use crate::{Body, Specimen};
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::Skeleton;
use linden_skeleton::organs::{LeafShape, OrganOrigins, Organs, PROTOTYPES, PlacedOrgans};

pub(super) use clusters::{Burden, Cut};

use deck::Deck;
use grain::Grain;

/// Planes of a card.
const PLANES: usize = 2;
/// Triangles of a card.
pub(super) const TRIANGLES: u64 = 2 * PLANES as u64;
/// Different cards of the finest level that has any. The next ones, farther away, have fewer.
const MOST_CARDS: usize = 32;
/// The fewest of a level.
const FEWEST_CARDS: usize = 8;

/// An organ or a piece of thin wood in short: where it begins and ends, and how much it counts, square metres.
pub(super) struct Rod {
    node: u32,
    pub from: Vec3,
    pub to: Vec3,
    pub weight: f32,
}

/// Wood counts less than its outline: it is seen where there are no leaves.
const OF_WOOD: f32 = 0.5;
/// What has no size counts this much, square metres: sums of weights are divided by.
const LEAST_WEIGHT: f32 = 1e-12;

/// All that cards show.
fn rods<'a>(
    skeleton: &'a Skeleton,
    organs: &'a Organs,
    forms: &'a LevelForms,
    is_thin: &'a [bool],
) -> impl Iterator<Item = Rod> + 'a {
    let thin = (0..skeleton.positions.len()).filter(|node| is_thin[*node]).filter_map(move |node| {
        let parent = skeleton.parents[node];
        let from = *skeleton.positions.get(parent as usize)?;
        let to = skeleton.positions[node];
        let weight = (OF_WOOD * 2.0 * skeleton.radii[node] * from.distance(to)).max(LEAST_WEIGHT);
        Some(Rod { node: node as u32, from, to, weight })
    });
    organ_rods(organs, forms).chain(thin)
}

/// The organs that cards may show.
pub(super) fn organ_rods<'a>(organs: &'a Organs, forms: &'a LevelForms) -> impl Iterator<Item = Rod> + 'a {
    let polygons = organs.polygons.ends.len();
    let is_shown = move |organ: &usize| forms.may_be_on_cards(organs, *organ);
    let outlines = (0..polygons).filter(is_shown).filter_map(move |polygon| {
        let corners = organs.corners_of(polygon);
        let from = *corners.first()?;
        // Opposite to where it is attached.
        let to = corners[corners.len() / 2];
        let weight = from.distance_squared(to).max(LEAST_WEIGHT);
        Some(Rod { node: organs.polygons.growth.nodes[polygon], from, to, weight })
    });
    let placed = &organs.placed;
    let leaves = (0..placed.len()).filter(move |organ| is_shown(&(polygons + organ))).map(move |organ| {
        let (from, size_m) = (placed.positions[organ], placed.sizes_m[organ]);
        let to = from + placed.headings[organ] * size_m;
        Rod { node: placed.growth.nodes[organ], from, to, weight: (size_m * size_m).max(LEAST_WEIGHT) }
    });
    outlines.chain(leaves)
}

/// A level's pieces, with the wood that is not among them.
pub(super) struct Pieces {
    pub cut: Cut,
    /// For each node whether its piece of wood is thin: the cards show it.
    pub is_thin: Vec<bool>,
    /// Which organs the cards show.
    pub forms: LevelForms,
}

impl Pieces {
    /// The mean radius of its pieces, metres; `None` of none.
    fn radius_m(&self) -> Option<f32> {
        let pieces = &self.cut.pieces;
        let sum: f64 = pieces.iter().map(|(_, mass)| mass.radius_m()).sum();
        (!pieces.is_empty()).then(|| (sum / pieces.len() as f64) as f32)
    }
}

/// Branch cards of some levels.
pub(super) struct Cards {
    cover: Cover,
    shapes: Arc<[LeafShape]>,
    /// Those of each level.
    levels: Vec<PlacedOrgans>,
}

impl Cards {
    /// Draws the cards of some levels, finest first, on one picture of `size_px` pixels a side.
    ///
    /// # Errors
    /// [`DetailError`]: memory, or cancelled.
    pub fn new(
        levels: &[Pieces],
        specimen: &Specimen<'_>,
        body: Body<'_>,
        wardrobe: &Wardrobe,
        size_px: u32,
        monitor: &dyn Monitor,
    ) -> Result<Self, DetailError> {
        // Cards beside leaves are numbered behind these.
        let is_beside = levels.iter().any(|level| !level.forms.are_all_on_cards());
        let before = PROTOTYPES.len() + if is_beside { body.organs.shapes.len() } else { 0 };
        let room = usize::from(u8::MAX).saturating_sub(before) / levels.len().max(1);
        let grain = Grain::of(levels, specimen, body, size_px);
        let room = room / grain.faces();
        let mut most = grain.cards;
        let mut decks = Vec::with_capacity(levels.len());
        for level in levels {
            decks.push(Deck::new(
                level,
                body.skeleton,
                body.organs,
                (most.min(room), grain.is_fine),
                monitor,
            )?);
            most = grain::next(most);
        }
        let coarse = grain.dressing(specimen.dressing);
        let drawn_in = coarse.as_ref().map(|dressing| specimen.with(dressing));
        let redrawn = drawn_in
            .as_ref()
            .map(|drawn_in| wardrobe.in_season(drawn_in, body.organs, monitor))
            .transpose()?;
        let wardrobe = redrawn.as_ref().unwrap_or(wardrobe);
        let models =
            levels.iter().zip(&decks).flat_map(|(level, deck)| {
                deck.prototypes.iter().zip(&deck.densities).map(move |(&piece, &density)| {
                    model::CardSubject { level, piece, frame: &deck.frames[piece as usize], density }
                })
            });
        let drawn = draw::draw(models, specimen, body, wardrobe, (size_px, grain), monitor)?;
        let (color, is_dome) = (drawn.color(), is_mostly_dome(body.organs));
        let shape = |mesh: Mesh| LeafShape {
            kind: 0,
            sketch: mesh.clone(),
            mesh,
            color,
            is_dome,
            faces: 1,
            lods: Vec::new(),
        };
        let both = drawn.meshes.into_iter().flat_map(|mesh| {
            let mirrored = grain.is_fine.then(|| mirrored(&mesh));
            std::iter::once(mesh).chain(mirrored)
        });
        let shapes: Arc<[LeafShape]> = both.map(shape).collect();
        let mut first = PROTOTYPES.len();
        let mut organs = Vec::with_capacity(levels.len());
        for (level, deck) in levels.iter().zip(decks) {
            organs.push(placed(level, &deck, first, grain.faces()));
            first += grain.faces() * deck.prototypes.len();
        }
        Ok(Self { cover: drawn.cover, shapes, levels: organs })
    }

    /// The cards of the `index`-th of its levels, beside leaves that the level has, and what all of them wear. The
    /// wardrobe's leaves are those of the level.
    pub fn beside(&mut self, index: usize, leaves: Organs, wardrobe: &Wardrobe) -> (Organs, Wardrobe) {
        let mut cards = std::mem::take(&mut self.levels[index]);
        if leaves.is_empty() {
            let worn = wardrobe.with_cards(self.cover.clone(), Arc::clone(&self.shapes));
            let organs = Organs { placed: cards, shapes: Arc::clone(&self.shapes), ..Organs::default() };
            return (organs, worn);
        }
        let worn = wardrobe.with_leaves_and_cards(self.cover.clone(), &self.shapes);
        let before = leaves.shapes.len() as u8;
        cards.prototypes.iter_mut().for_each(|card| *card += before);
        let mut organs = Organs { shapes: Arc::clone(worn.shapes()), ..leaves };
        organs.placed.append(cards);
        (organs, worn)
    }
}

/// Whether most of the foliage is lit as a crown, by normals that point out of it: then so are cards.
fn is_mostly_dome(organs: &Organs) -> bool {
    let placed = &organs.placed;
    let dome_m2 = placed.prototypes.iter().zip(&placed.sizes_m).map(|(&prototype, size_m)| {
        let shape = usize::from(prototype).checked_sub(PROTOTYPES.len());
        let is_dome = shape.and_then(|shape| organs.shapes.get(shape)).is_some_and(|shape| shape.is_dome);
        f64::from(size_m * size_m) * if is_dome { 1.0 } else { -1.0 }
    });
    dome_m2.sum::<f64>() >= 0.0
}

/// The same card with its left and right changed, seen from the same sides.
fn mirrored(card: &Mesh) -> Mesh {
    let flip = |v: &Vec3| Vec3::new(-v.x, v.y, v.z);
    Mesh {
        positions: card.positions.iter().map(flip).collect(),
        normals: card.normals.iter().map(flip).collect(),
        uvs: card.uvs.clone(),
        triangles: card.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    }
}

/// A card for each piece.
fn placed(level: &Pieces, deck: &Deck, first: usize, faces: usize) -> PlacedOrgans {
    let nodes: Vec<u32> = level.cut.pieces.iter().map(|(node, _)| *node).collect();
    let frames = || deck.frames.iter();
    PlacedOrgans {
        prototypes: deck.card_of.iter().map(|card| (first + card.shape(faces)) as u8).collect(),
        positions: frames().map(|frame| frame.middle).collect(),
        headings: frames().map(|frame| frame.heading).collect(),
        ups: frames().map(|frame| frame.up).collect(),
        sizes_m: frames().map(|frame| frame.radius_m).collect(),
        growth: OrganOrigins { colors: vec![0; nodes.len()], births: vec![0; nodes.len()], nodes },
    }
}

impl Simplifier<'_> {
    /// The size of pieces, metres, of which there are at most `count`, and as few less as can be.
    pub(super) fn size_of_pieces(
        &self,
        burden: &Burden,
        count: u64,
        monitor: &dyn Monitor,
    ) -> Result<f32, Cancelled> {
        /// Halvings: a thousandth of the way.
        const STEPS: u32 = 24;
        let (mut fine, mut coarse) = (0.0_f32, self.wood.size_m().max(1e-3) * 2.0);
        for _ in 0..STEPS {
            let middle = if fine == 0.0 { coarse / 8.0 } else { (fine * coarse).sqrt() };
            let pieces = burden.count(middle, monitor)? as u64;
            if pieces > count {
                fine = middle;
            } else {
                coarse = middle;
                if pieces as f64 > count as f64 * 0.995 {
                    break;
                }
            }
        }
        Ok(coarse)
    }
}
