//! How large files will be, from the skeleton alone: told before anything is dressed or written.
//!
//! Triangles and vertices are counted, bytes follow from these and from what each format was measured to
//! need. A test holds them within 30 % of real files, of which it writes a sample: each built-in preset (of those of more than
//! 300,000 triangles every third) in every eighth of all formats with one option turned, other eighths for the next preset;
//! trees of more than 30,000 triangles without options. Files of less than 32 KiB are not compared.

mod amounts;
mod level;
mod pictures;
mod seconds;

use std::collections::BTreeSet;

use linden_pipeline::Skeleton;
use linden_pipeline::forecast::Sample;
use linden_pipeline::grow::Grown;
use linden_pipeline::monitor::{Cancelled, Monitor};
use linden_pipeline::provenance::TreeHash;
use linden_pipeline::recipe::Recipe;
use linden_pipeline::settings::{Dressing, WindSettings};
use linden_pipeline::surface::{self, Junction, SurfaceError, Tubes};
use linden_pipeline::wind::{Sway, Wind, most_joints};

use self::level::{Instanced, LevelAmounts};
use self::pictures::{PASSING, bark_bytes, billboard_bytes, card_bytes, file_bytes, leaf_picture_bytes};
use crate::{Format, LooksIn, Options};

pub use self::amounts::{Amounts, mean_digits};

/// What an export of a tree will amount to, about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Estimate {
    /// Vertices of the finest level.
    pub vertices: u64,
    /// Triangles of the finest level.
    pub triangles: u64,
    /// All levels of triangles, the finest first.
    levels: Vec<LevelAmounts>,
    /// Materials of the foliage.
    foliage_materials: u64,
    nodes: u64,
    axes: u64,
    /// The recipe's line.
    recipe_bytes: u64,
    /// Pictures as PNG: of the bark, of leaves, of branch cards.
    bark_bytes: u64,
    leaf_bytes: u64,
    card_bytes: u64,
    /// Those of the billboard.
    billboard_bytes: u64,
    wind: Wind,
    /// That turn, and in how many frames.
    joints: u64,
    frames: u64,
    /// Without a budget.
    all_triangles: u64,
    /// Of leaves.
    kinds: BTreeSet<u8>,
}

impl Estimate {
    /// Counts what the surface and the foliage of a tree will have, within its budget: exactly, but for
    /// `junction=watertight`, which is counted as tubes, and for the rings where two barks meet, which count once.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        Self::counted(recipe, grown, &recipe.preset.dressing.tubes, [1.0; 2], monitor)
    }

    /// What a tree that has not grown will have, from a sample of it.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn of_sample(recipe: &Recipe, sample: &Sample, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let times = [sample.wood_times, sample.leaf_times];
        Self::counted(recipe, &sample.grown, &sample.recipe.preset.dressing.tubes, times, monitor)
    }

    /// Counts a tree's wood and leaves, each multiplied.
    fn counted(
        recipe: &Recipe,
        grown: &Grown,
        tubes: &Tubes,
        [wood_times, leaf_times]: [f64; 2],
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let Dressing { foliage, detail, .. } = &recipe.preset.dressing;
        let of_wood = |count: u64| (count as f64 * wood_times) as u64;
        let of_leaves = |count: u64| (count as f64 * leaf_times) as u64;
        let skeleton = &grown.skeleton;
        let [vertices, triangles] = amount_of_wood(skeleton, tubes, wood_times, monitor)?;
        let (foliage_vertices, foliage_triangles) = grown.organs.amount();
        let (foliage_vertices, foliage_triangles) =
            (of_leaves(foliage_vertices), of_leaves(foliage_triangles));
        let last = foliage.turtle_colors().len().saturating_sub(1) as u64;
        let organs = &grown.organs;
        let WindSettings { wind, blow, bones } = recipe.preset.dressing.wind;
        let (joints, frames) = match wind {
            Wind::Bones => (most_joints(skeleton, bones).into(), Sway::new(&blow).frames().into()),
            _ => (0, 0),
        };
        let tinted = (0..organs.len()).filter(|&i| organs.color(i).is_none());
        let colors: BTreeSet<u64> = tinted.map(|i| last.min(organs.growth(i).color.into())).collect();
        let kinds: BTreeSet<u8> = organs.shapes.iter().map(|shape| shape.kind).collect();
        let leaves = kinds.iter().filter_map(|&kind| foliage.kinds().nth(kind.into()));
        let leaves = leaves.map(|kind| match &kind.picture {
            Some(file) => file_bytes(recipe, file),
            None => leaf_picture_bytes(foliage.size_px),
        });
        let instanced = Instanced::of(organs, leaf_times);
        let all = LevelAmounts {
            vertices: vertices + foliage_vertices,
            triangles: triangles + foliage_triangles,
            plain_vertices: of_leaves(organs.plain_amount().0),
            leaf_vertices: foliage_vertices,
            leaf_triangles: foliage_triangles,
            organs: of_leaves(organs.len() as u64),
            sites: of_leaves(organs.sites()),
            in_cards: false,
            instanced,
        };
        let budgets = detail.budgets();
        let budget = if detail.finest() == 0 { u64::MAX } else { detail.finest() };
        let finest = all.within(budget, detail.branch_cards);
        let of_level = |level: usize| {
            let share = libm::pow(detail.lod_ratio, level as f64);
            match budgets.get(level) {
                Some(&budget) => all.within(budget, detail.branch_cards),
                None if level == 0 => finest,
                None => all.within((finest.triangles as f64 * share) as u64, detail.branch_cards),
            }
        };
        Ok(Self {
            vertices: finest.vertices,
            triangles: finest.triangles,
            levels: (0..detail.triangle_levels()).map(of_level).collect(),
            foliage_materials: (colors.len() + kinds.len()) as u64,
            nodes: of_wood(skeleton.positions.len() as u64),
            axes: of_wood(skeleton.axes.len() as u64),
            // As long as with its own hashes.
            recipe_bytes: recipe.to_line_of(TreeHash { skeleton: 0, organs: 0 }).len() as u64,
            bark_bytes: bark_bytes(recipe),
            leaf_bytes: leaves.sum::<u64>(),
            card_bytes: card_bytes(detail.card_size_px),
            billboard_bytes: billboard_bytes(detail),
            wind,
            joints,
            frames,
            all_triangles: all.triangles,
            kinds,
        })
    }

    /// The same where the pictures of bark and leaves are there already.
    #[must_use]
    pub fn without_pictures(&self) -> Self {
        Self { bark_bytes: 0, leaf_bytes: 0, ..self.clone() }
    }

    /// Triangles of each level, the finest first.
    pub(crate) fn level_triangles(&self) -> impl Iterator<Item = f64> {
        self.levels.iter().map(|level| level.triangles as f64)
    }

    /// Triangles of the whole tree, whatever its budget.
    pub(crate) const fn unbudgeted_triangles(&self) -> f64 {
        self.all_triangles as f64
    }

    /// Kinds of leaves whose pictures are drawn.
    pub(crate) fn drawn_kinds(&self, recipe: &Recipe) -> f64 {
        let kinds =
            self.kinds.iter().filter_map(|&kind| recipe.preset.dressing.foliage.kinds().nth(kind.into()));
        kinds.filter(|kind| kind.picture.is_none()).count() as f64
    }

    /// Triangles that a format's files hold: none where it holds the skeleton alone.
    pub fn triangles_of(&self, format: &Format) -> u64 {
        if format.holds.surface { self.triangles } else { 0 }
    }

    /// Bytes of all files of a format with these options, all levels together; `None` where the format
    /// has no estimate.
    pub fn bytes(&self, format: &Format, options: &Options) -> Option<u64> {
        let estimate = format.estimate?;
        Some(match format.levels_with(options) {
            LooksIn::Files => {
                let levels = 0..self.level_count();
                levels.map(|level| estimate(&self.level_amounts(level), options)).sum()
            }
            LooksIn::One => {
                let all = self.levels.iter().copied().fold(LevelAmounts::default(), LevelAmounts::and);
                let pictures = self.picture_bytes(&self.levels) + self.billboard_bytes;
                let drawn = self.shown_card_bytes(&self.levels) + self.billboard_bytes;
                let amounts = self.amounts(all, pictures, self.bark_bytes, drawn);
                estimate(&amounts, options) + LEVEL_BYTES * (self.level_count() as u64).saturating_sub(1)
            }
            LooksIn::Nothing => estimate(&self.level_amounts(0), options),
        })
    }

    /// Bytes of the files of one level, where each has its files. The billboard is a level after all others.
    pub fn level_bytes(&self, level: usize, format: &Format, options: &Options) -> Option<u64> {
        Some(format.estimate?(&self.level_amounts(level), options))
    }

    /// What a level alone amounts to; beyond those of triangles, the billboard.
    fn level_amounts(&self, level: usize) -> Amounts {
        match self.levels.get(level) {
            Some(&amounts) => {
                let drawn = self.shown_card_bytes(&[amounts]);
                self.amounts(amounts, self.picture_bytes(&[amounts]), self.bark_bytes, drawn)
            }
            None => self.amounts(LevelAmounts::default(), self.billboard_bytes, 0, self.billboard_bytes),
        }
    }

    /// Whether branch cards stand for leaves in any level.
    pub(crate) fn has_cards(&self) -> bool {
        self.levels.iter().any(|level| level.in_cards)
    }

    /// The pictures that some levels show.
    fn picture_bytes(&self, levels: &[LevelAmounts]) -> u64 {
        let leaves = if levels.iter().any(|level| !level.in_cards) { self.leaf_bytes } else { 0 };
        self.bark_bytes + leaves + self.shown_card_bytes(levels)
    }

    /// The pictures of branch cards that some levels show.
    fn shown_card_bytes(&self, levels: &[LevelAmounts]) -> u64 {
        if levels.iter().any(|level| level.in_cards) { self.card_bytes } else { 0 }
    }

    /// Of a level with its pictures, those of them that are opaque, and those that were drawn of the plant.
    fn amounts(
        &self,
        level: LevelAmounts,
        picture_bytes: u64,
        opaque_picture_bytes: u64,
        drawn_bytes: u64,
    ) -> Amounts {
        Amounts {
            vertices: level.vertices,
            triangles: level.triangles,
            leaf_vertices: level.leaf_vertices,
            plain_vertices: level.plain_vertices,
            placements: 0,
            organs: level.organs,
            nodes: self.nodes,
            axes: self.axes,
            recipe_bytes: self.recipe_bytes,
            picture_bytes,
            opaque_picture_bytes,
            passing_picture_bytes: (PASSING * drawn_bytes as f64) as u64,
            foliage_materials: self.foliage_materials,
            wind: self.wind,
            joints: self.joints,
            frames: self.frames,
            saved: level.instanced,
        }
    }

    fn level_count(&self) -> usize {
        self.levels.len() + usize::from(self.billboard_bytes > 0)
    }
}

/// Vertices and triangles of a skeleton's surface, multiplied.
fn amount_of_wood(
    skeleton: &Skeleton,
    tubes: &Tubes,
    times: f64,
    monitor: &dyn Monitor,
) -> Result<[u64; 2], Cancelled> {
    let tubes = match tubes.junction {
        Junction::Watertight => Tubes { junction: Junction::Overlap, ..*tubes },
        _ => *tubes,
    };
    let counts = match surface::count(skeleton, &tubes, monitor) {
        Ok(counts) => counts,
        Err(SurfaceError::Cancelled(cancelled)) => return Err(cancelled),
        // Counting finds nothing else.
        Err(_) => return Ok([0; 2]),
    };
    Ok([0, 1].map(|i| {
        // A larger tree has no more roots than its sample.
        let roots = counts.iter().map(|count| count.roots[i] as u64).sum::<u64>();
        let all = counts.iter().map(|count| [count.vertices, count.triangles][i] as u64).sum::<u64>();
        ((all - roots) as f64 * times) as u64 + roots
    }))
}

/// What stands around the meshes of a further level.
const LEVEL_BYTES: u64 = 1500;

#[cfg(test)]
mod tests;
