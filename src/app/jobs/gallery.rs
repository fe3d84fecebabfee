//! Small pictures of one tree with one knob turned many ways: a gallery of seeds, a sweep.
//!
//! A picture is given as soon as its tree has grown, from the first to the last: as strokes, in the
//! scale that is known by then. What can be better when all have grown (a surface, the scale that is
//! common to all) is given once more. So there is something to see early, and no tree waits for the
//! largest. Where the terminal shows pixels each picture has its own; over a network only the last of a tree.

use std::sync::Arc;

use linden::dress::{DressError, dress};
use linden::foliage::FoliageError;
use linden::grow::{GrowError, Grown, grow, sprout};
use linden::knob::Value;
use linden::lsystem::LsystemError;
use linden::picture::Picture;
use linden::preset::{PresetKnob, Section};
use linden::recipe::Recipe;
use linden::skeleton::Measures;
use linden::skeleton::generator::SampleSize;
use linden::{Cancelled, Monitor};
use linden_raster::{Camera, Extent, RasterError, Size, Style, Surface, draw_surface};
use linden_terminal::Encoded;
use linden_terminal::cells::CellPicture;
use ratatui::layout::Rect;

use super::draw::{DRAFT_BYTES, FULL_BYTES, exact_pixels};
use super::grow::Plant;
use super::{Framed, Medium, PictureLook, ShownTree};
use crate::viewpoint::around;

/// Larger trees are not grown for a small picture. A tree that is on screen already is drawn whatever
/// its size.
const MOST_SYMBOLS: u64 = 5_000_000;
const MOST_POINTS: usize = 1_000_000;
const MOST_NODES: u32 = 1_000_000;
/// Grown trees are kept until all have grown, as long as they have no more nodes than this together
/// (some 40 bytes each); others are grown again if they have to be drawn again.
const KEPT_NODES: usize = 500_000;
/// Side of the pictures of bark, pixels: what a picture of a few dozen pixels shows of it is its mean.
const BARK_PX: u32 = 64;
/// Of leaves: what it shows of them is their outline at best.
const LEAF_PX: u32 = 128;

/// Pictures that should be on screen.
#[derive(Clone, Debug)]
pub struct GalleryRequest {
    /// The tree that is varied.
    pub base: Arc<Recipe>,
    /// The knob that is turned.
    pub knob: &'static str,
    /// To what, for each picture.
    pub values: Vec<Value>,
    /// The base, where it has grown already.
    pub known: Option<Arc<ShownTree>>,
    /// From where; each tree is framed whole.
    pub camera: Camera,
    /// What of it.
    pub look: PictureLook,
    /// Whether all are in one scale, or each fills its picture.
    pub one_scale: bool,
    /// Columns and rows of each picture.
    pub cells: (u16, u16),
    /// What shows it.
    pub medium: Medium,
}

/// One picture of a gallery, or why there is none.
#[derive(Debug)]
pub struct Thumbnail {
    /// What was asked for.
    pub request: Arc<GalleryRequest>,
    /// Which of its values.
    pub index: usize,
    /// The picture, or a few words on why there is none.
    pub result: Result<SmallPicture, String>,
}

/// A small picture of a tree.
#[derive(Debug)]
pub struct SmallPicture {
    /// The picture as characters.
    pub cells: CellPicture,
    /// As pixels.
    pub graphic: Option<Arc<Encoded>>,
    /// Nodes of the tree.
    pub nodes: usize,
    /// Its size.
    pub size: TreeSize,
}

/// How large a tree is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeSize {
    /// Metres.
    pub height_m: f64,
    /// Metres.
    pub width_m: f64,
    /// Leaves and other organs.
    pub leaves: usize,
}

impl TreeSize {
    /// Of a tree's wood, and the number of its organs.
    pub fn of(measures: &Measures, leaves: usize) -> Self {
        Self { height_m: measures.height_m, width_m: measures.crown_width_m, leaves }
    }
}

impl GalleryRequest {
    /// Whether another request is for the same pictures, whatever is known of the base.
    pub fn is_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.base, &other.base)
            && (self.knob, &self.values) == (other.knob, &other.values)
            && self.camera == other.camera
            && (self.look, self.one_scale, self.cells) == (other.look, other.one_scale, other.cells)
            && self.medium == other.medium
    }

    /// The recipe of a picture: the base with its knob turned, the base itself where that changes
    /// nothing.
    ///
    /// # Errors
    /// What the knob does not take.
    pub fn recipe(&self, index: usize) -> Result<Arc<Recipe>, String> {
        let value = &self.values[index];
        if self.row().and_then(|row| row.read(&self.base.preset)).as_ref() == Some(value) {
            return Ok(Arc::clone(&self.base));
        }
        let mut preset = self.base.preset.clone();
        preset.set(self.knob, &value.to_string()).map_err(|error| error.to_string())?;
        Ok(Arc::new(self.base.with_preset(preset)))
    }

    fn row(&self) -> Option<PresetKnob> {
        self.base.preset.find_knob(self.knob)
    }

    /// Whether all trees have the base's skeleton: only what covers it differs.
    fn shares_skeleton(&self) -> bool {
        self.row().is_some_and(|row| row.section.covers())
    }
}

impl Thumbnail {
    /// What the knob was turned to.
    pub fn value(&self) -> &Value {
        &self.request.values[self.index]
    }
}

/// Paints the pictures of a gallery, and gives each as soon as it is there; some are given a second
/// time, better. Returns early when it was cancelled.
pub fn paint_gallery(request: GalleryRequest, monitor: &dyn Monitor, give: &dyn Fn(Thumbnail)) {
    let size = {
        let (columns, rows) = request.cells;
        let area = Rect::new(0, 0, columns, rows);
        let (width, height) = match request.medium.graphics {
            Some(_) => exact_pixels(area, request.medium.cell_px),
            None => request.medium.pixels_of_cells(columns, rows),
        };
        Size::new(width, height)
    };
    let request = Arc::new(request);
    let give = |index, result| give(Thumbnail { request: Arc::clone(&request), index, result });
    match size {
        Ok(size) => {
            // Cancelled: there is nothing to tell.
            let _ = Studio { request: &request, size, monitor }.paint_all(&give);
        }
        Err(error) => (0..request.values.len()).for_each(|index| give(index, Err(error.to_string()))),
    }
}

/// A tree that grew, as far as pictures need it.
#[derive(Clone)]
struct GallerySubject {
    recipe: Arc<Recipe>,
    plant: Plant,
    extent: Extent,
}

/// Why there is no picture.
enum NoPicture {
    Cancelled,
    Because(String),
}

impl From<Cancelled> for NoPicture {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

struct Studio<'a> {
    request: &'a GalleryRequest,
    size: Size,
    monitor: &'a dyn Monitor,
}

impl Studio<'_> {
    fn paint_all(&self, give: &dyn Fn(usize, Result<SmallPicture, String>)) -> Result<(), Cancelled> {
        let Self { request, .. } = self;
        let give = |index, result| match result {
            Ok(picture) => {
                give(index, Ok(picture));
                Ok(())
            }
            Err(NoPicture::Because(why)) => {
                give(index, Err(why));
                Ok(())
            }
            Err(NoPicture::Cancelled) => Err(Cancelled),
        };
        let has_surface = request.look == PictureLook::Surface;
        let shares_skeleton = request.shares_skeleton();
        let mut extents: Vec<Extent> =
            request.known.iter().map(|known| known.extent(Framed::Tree, false)).collect();
        let mut shared = None;
        let mut kept_nodes = 0;
        // For each tree that grew: what its picture framed, and the tree itself while there is room.
        let mut drawn: Vec<Option<(Extent, Option<GallerySubject>)>> =
            Vec::with_capacity(request.values.len());
        for index in 0..request.values.len() {
            let sitter = match self.grow(index, shared.as_ref()) {
                Ok(sitter) => sitter,
                Err(why) => {
                    give(index, Err(why))?;
                    drawn.push(None);
                    continue;
                }
            };
            if !extents.contains(&sitter.extent) {
                extents.push(sitter.extent);
            }
            let frame = if request.one_scale { around(&extents) } else { sitter.extent };
            let is_last = !request.one_scale && !has_surface;
            give(index, self.strokes(&sitter, frame, is_last))?;
            if shares_skeleton {
                shared.get_or_insert_with(|| sitter.plant.clone());
            }
            let nodes = if shares_skeleton { 0 } else { sitter.plant.skeleton.positions.len() };
            let is_kept = (request.one_scale || has_surface) && kept_nodes + nodes <= KEPT_NODES;
            kept_nodes += if is_kept { nodes } else { 0 };
            drawn.push(Some((frame, is_kept.then_some(sitter))));
        }
        let common = around(&extents);
        for (index, drawn) in drawn.into_iter().enumerate() {
            let Some((frame, kept)) = drawn else { continue };
            let last = if request.one_scale { common } else { frame };
            // Over a network what was given first is characters alone.
            let has_pixels = request.medium.graphics.is_none() || !request.medium.remote;
            if last == frame && !has_surface && (!request.one_scale || has_pixels) {
                continue;
            }
            let sitter = kept.map_or_else(|| self.grow(index, shared.as_ref()), Ok);
            give(index, sitter.and_then(|sitter| self.best(&sitter, last)))?;
        }
        Ok(())
    }

    /// Grows one of the trees, unless it is too large for that.
    fn grow(&self, index: usize, shared: Option<&Plant>) -> Result<GallerySubject, NoPicture> {
        self.monitor.check()?;
        let recipe = self.request.recipe(index).map_err(NoPicture::Because)?;
        if let Some(known) = &self.request.known
            && (Arc::ptr_eq(&known.recipe, &recipe) || self.request.shares_skeleton())
        {
            let plant = self.leafed(&recipe, Plant::from(&known.grown))?;
            let extent = plant.extent().unwrap_or_else(|| known.extent(Framed::Tree, false));
            return Ok(GallerySubject { recipe, plant, extent });
        }
        let plant = match shared {
            Some(plant) => self.leafed(&recipe, plant.clone())?,
            None => grow_within_limits(&recipe, self.monitor)?,
        };
        let Some(extent) = plant.extent() else {
            return Err(NoPicture::Because(RasterError::Empty.to_string()));
        };
        Ok(GallerySubject { recipe, plant, extent })
    }

    /// A tree of another recipe with the leaves of this one.
    fn leafed(&self, recipe: &Recipe, plant: Plant) -> Result<Plant, NoPicture> {
        if self.request.row().is_none_or(|row| row.section != Section::Foliage) {
            return Ok(plant);
        }
        match sprout(recipe, &plant.skeleton, &plant.given, self.monitor) {
            Ok(organs) => Ok(Plant { organs, ..plant }),
            Err(FoliageError::Cancelled(_)) => Err(NoPicture::Cancelled),
            Err(other) => Err(NoPicture::Because(other.to_string())),
        }
    }

    /// A tree as well as it can be drawn.
    fn best(&self, sitter: &GallerySubject, frame: Extent) -> Result<SmallPicture, NoPicture> {
        if self.request.look != PictureLook::Surface {
            return self.strokes(sitter, frame, true);
        }
        let mut recipe = (*sitter.recipe).clone();
        recipe.preset.dressing.bark.size_px = recipe.preset.dressing.bark.size_px.min(BARK_PX);
        recipe.preset.dressing.foliage.size_px = recipe.preset.dressing.foliage.size_px.min(LEAF_PX);
        let Plant { skeleton, organs, given } = sitter.plant.clone();
        let grown = Grown::of(skeleton, recipe.preset.wood, organs, given);
        let scene = dress(&recipe, &grown, self.monitor).map_err(|error| match error {
            DressError::Cancelled(_) => NoPicture::Cancelled,
            other => NoPicture::Because(other.to_string()),
        })?;
        let surface = Surface::from(&scene);
        let camera = self.camera(frame);
        let drawn = draw_surface(&surface, &camera, &self.request.medium.style(), self.size, self.monitor);
        self.small(sitter, drawn, true)
    }

    /// A tree as strokes. `is_last`: nothing better follows.
    fn strokes(
        &self,
        sitter: &GallerySubject,
        frame: Extent,
        is_last: bool,
    ) -> Result<SmallPicture, NoPicture> {
        let base = self.request.medium.style();
        let paint = if let PictureLook::Skeleton(paint) = self.request.look { paint } else { base.paint };
        let style = Style {
            paint,
            organs: Some(&sitter.plant.organs),
            leaf_colors: sitter.recipe.preset.dressing.foliage.turtle_colors(),
            ..base
        };
        let (look, camera) = (self.request.look, self.camera(frame));
        let drawn = look.draw(&sitter.plant.skeleton, &camera, &style, self.size, self.monitor);
        self.small(sitter, drawn, is_last)
    }

    fn camera(&self, frame: Extent) -> Camera {
        Camera { extent: Some(frame), ..self.request.camera }
    }

    /// Pixels as cells, with what is said below them.
    fn small(
        &self,
        sitter: &GallerySubject,
        drawn: Result<Picture, RasterError>,
        is_last: bool,
    ) -> Result<SmallPicture, NoPicture> {
        let picture = drawn.map_err(|error| match error {
            RasterError::Cancelled(_) => NoPicture::Cancelled,
            other => NoPicture::Because(other.to_string()),
        })?;
        let GalleryRequest { medium, cells, values, .. } = self.request;
        // Together they cost no more than one large picture.
        let count = values.len().max(1);
        let area = Rect::new(0, 0, cells.0, cells.1);
        let most = if medium.remote { FULL_BYTES / count } else { usize::MAX };
        let graphic = if is_last || !medium.remote { medium.graphic(&picture, area, most) } else { Ok(None) };
        let graphic = graphic.map_err(NoPicture::Because)?;
        let budget = if medium.graphics.is_some() { DRAFT_BYTES } else { FULL_BYTES } / count;
        let cells = medium.cells(&picture, self.size, *cells, budget).map_err(NoPicture::Because)?;
        let Plant { skeleton, organs, .. } = &sitter.plant;
        let (nodes, size) = (skeleton.positions.len(), TreeSize::of(&skeleton.measures(), organs.len()));
        Ok(SmallPicture { cells, graphic, nodes, size })
    }
}

/// Grows a tree, unless it would be larger than small pictures are worth. A tree that is cut off at a
/// limit of ours is no tree of the recipe's, so it is refused.
fn grow_within_limits(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Plant, NoPicture> {
    let too_large = |what: String| NoPicture::Because(format!("too large for a small picture: {what}"));
    let mut limited = recipe.clone();
    let size = SampleSize { points: MOST_POINTS, nodes: MOST_NODES, symbols: MOST_SYMBOLS, halvings: 0 };
    let limits_nodes = limited.preset.generator.limit(&recipe.inputs, &size).map_err(too_large)?;
    match grow(&limited, monitor) {
        Ok(grown) if limits_nodes && grown.skeleton.positions.len() >= MOST_NODES as usize => {
            Err(too_large(format!("over {MOST_NODES} nodes")))
        }
        Ok(grown) => Ok(Plant::from(&grown)),
        Err(GrowError::Cancelled(_)) => Err(NoPicture::Cancelled),
        Err(error) => Err(match error.generator() {
            Some(LsystemError::TooManySymbols { symbols, limit, .. }) => {
                let count = if *symbols > u128::from(u32::MAX) {
                    format!("{:.0e}", *symbols as f64)
                } else {
                    symbols.to_string()
                };
                if *limit == MOST_SYMBOLS {
                    too_large(format!("{count} symbols"))
                } else {
                    NoPicture::Because(format!("{count} symbols, over its limit of {limit}"))
                }
            }
            _ => NoPicture::Because(first_clause(&error.to_string())),
        }),
    }
}

/// What is wrong, without what to do about it: a small picture has room for no more.
fn first_clause(text: &str) -> String {
    text.split("; ").next().unwrap_or(text).to_owned()
}

#[cfg(test)]
#[path = "gallery_tests.rs"]
mod tests;
