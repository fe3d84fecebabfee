//! Draws the tree on screen, and encodes the pixels for the terminal.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec3;
use linden::dress::{DressError, dress};
use linden::foliage::Organs;
use linden::monitor::Holding;
use linden::picture::Picture;
use linden::preset::Preset;
use linden::scene::{Mesh, Part, Scene};
use linden::wind::{Blow, Wind, blown};
use linden::{Monitor, Skeleton};
use linden_raster::{
    Camera, Paint, RasterError, Size, Style, Surface, draw_flat, draw_skeleton, draw_stage, draw_surface,
};
use linden_terminal::cells::{CellPicture, square_pixels};
use linden_terminal::graphics::{Encoded, Protocol, encode};
use linden_terminal::probe::{Capabilities, Graphics};
use linden_terminal::{CellStyle, ColorDepth, Glyphs, Image};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::grow::Plant;
use super::{ShownForest, ShownTree, Subject, Watcher};
use crate::config::settings::Scenery;

/// Most bytes of a draft, and of a full picture, over a network.
pub(super) const DRAFT_BYTES: usize = 16_000;
pub(super) const FULL_BYTES: usize = 100_000;
/// The same of characters: both come for each preset that the list's cursor passes.
pub(super) const DRAFT_CELLS_BYTES: usize = 3_500;
pub(super) const FULL_CELLS_BYTES: usize = 9_000;
/// The longer side of a picture that a terminal shows as pixels.
const LONGEST_PX: u32 = 1400;
/// Sixels of one picture: a screen of 5K. A terminal that claims more shows characters.
const MOST_SIXELS: u64 = 16 << 20;
/// How many times coarser a draft in pixels is.
const DRAFT_SCALE: u32 = 2;
/// Sides of the thickest tube, and pixels of the bark's side, on a screen.
const MOST_SIDES: u32 = 12;
pub(super) const MOST_BARK_PX: u32 = 256;
/// Of the side of a picture of leaves, which holds several.
pub(super) const MOST_LEAF_PX: u32 = 256;
/// A cell's pixels where a terminal does not tell: what most fonts come near.
const USUAL_CELL_PX: (u16, u16) = (10, 20);

/// What is drawn of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureLook {
    /// Its axes as strokes.
    Skeleton(Paint),
    /// Its surface, shaded.
    Surface,
    /// Flat, as in a book.
    Turtle,
}

impl PictureLook {
    /// Draws a skeleton so.
    pub fn draw(
        self,
        skeleton: &Skeleton,
        camera: &Camera,
        style: &Style<'_>,
        size: Size,
        monitor: &dyn Monitor,
    ) -> Result<Picture, RasterError> {
        match self {
            Self::Turtle => draw_flat(skeleton, camera, style, size, monitor),
            Self::Skeleton(_) | Self::Surface => draw_skeleton(skeleton, camera, style, size, monitor),
        }
    }
}

/// How carefully.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// At once, while keys come.
    Draft,
    /// As well as it can be.
    Full,
}

/// An axis that is marked in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PickedAxis {
    /// The axis; `None` while another tree is on its way.
    pub axis: Option<u32>,
    /// Whether wood alone is drawn, so that axes can be told apart.
    pub bare: bool,
}

/// A picture that should be on screen.
#[derive(Clone, Debug)]
pub struct DrawRequest {
    /// What of.
    pub subject: Subject,
    /// The step of growth that is drawn, `None` for the grown tree.
    pub stage: Option<u32>,
    /// The frame of the wind's loop that the grown tree is drawn at, `None` for a calm.
    pub wind: Option<u32>,
    /// From where.
    pub camera: Camera,
    /// What of it.
    pub look: PictureLook,
    /// With its attraction points.
    pub points: bool,
    /// With its crown's outline.
    pub outline: bool,
    /// With a person beside it.
    pub person: bool,
    /// What is marked of it, while its wood is edited.
    pub pick: Option<PickedAxis>,
    /// The cells that it fills.
    pub area: Rect,
    /// What shows it.
    pub medium: Medium,
    /// How carefully.
    pub detail: Detail,
}

/// What a terminal shows pictures with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// A protocol for pixels, `None` for characters.
    pub graphics: Option<Protocol>,
    /// Characters.
    pub glyphs: Glyphs,
    /// Colours.
    pub colors: ColorDepth,
    /// What is behind, sRGB.
    pub background: [u8; 3],
    /// Whether that is dark.
    pub dark: bool,
    /// Pixels of a cell, across and down.
    pub cell_px: (u16, u16),
    /// Whether each byte goes over a network.
    pub remote: bool,
    /// Whether the tree stands in a landscape, not before the terminal's background.
    pub landscape: bool,
}

/// A picture, ready for the screen.
#[derive(Debug)]
pub struct Painted {
    /// What was asked for.
    pub request: DrawRequest,
    /// As characters: what is shown beneath dialogs, and where there is nothing else.
    pub cells: CellPicture,
    /// As pixels.
    pub graphic: Option<Arc<Encoded>>,
    /// Columns of cells a metre takes at the tree's axis.
    columns_per_m: f32,
    /// Whether a person stands beside the tree.
    pub shows_person: bool,
    /// What the ends of the colours mean, where these show a quantity.
    pub legend: Option<[String; 2]>,
    /// How long drawing took.
    pub took: Duration,
}

impl DrawRequest {
    /// Whether another request is for the same picture, whatever the detail.
    pub fn is_of(&self, other: &Self) -> bool {
        self.subject.is(&other.subject)
            && (self.stage, self.wind) == (other.stage, other.wind)
            && self.camera == other.camera
            && self.look == other.look
            && (self.points, self.outline, self.person) == (other.points, other.outline, other.person)
            && self.pick == other.pick
            && self.area == other.area
            && self.medium == other.medium
    }
}

/// An axis from where it leaves to its tip, metres.
fn line_of(skeleton: &Skeleton, axis: u32) -> Vec<Vec3> {
    let Some(axis) = skeleton.axes.get(axis as usize) else { return Vec::new() };
    let from = Some(axis.parent).filter(|parent| *parent != linden::skeleton::NO_PARENT);
    let nodes = from.into_iter().chain(skeleton.nodes_of(axis).iter().copied());
    nodes.map(|node| skeleton.positions[node as usize]).collect()
}

impl Painted {
    /// Puts the picture into an area; while the screen changes size, as much of it as fits.
    pub fn put(&self, area: Rect, buffer: &mut Buffer) {
        self.cells.put(buffer, area);
    }

    /// A round length in metres that takes at most `most_columns` columns, and its columns.
    pub fn scale_bar(&self, most_columns: f32) -> Option<(f32, f32)> {
        linden_raster::nice_length_m(most_columns, self.columns_per_m)
    }
}

impl Medium {
    /// What a terminal's capabilities come to.
    pub fn of(terminal: &Capabilities, scenery: Scenery) -> Self {
        let cell_px = terminal.cell_px.value;
        let (dark, colors) = (terminal.dark.value, terminal.colors.value);
        let usual = if dark { [16, 16, 18] } else { [250, 250, 250] };
        Self {
            graphics: match terminal.graphics.value {
                Graphics::Kitty => Some(Protocol::Kitty),
                Graphics::Sixel => Some(Protocol::Sixel),
                Graphics::Iterm2 => Some(Protocol::Iterm2),
                Graphics::Cells => None,
            },
            glyphs: match terminal.glyphs.value {
                Glyphs::Ascii => Glyphs::Ascii,
                _ if colors == ColorDepth::None => Glyphs::Braille,
                glyphs => glyphs,
            },
            colors,
            background: terminal.background.value.unwrap_or(usual),
            dark,
            cell_px: cell_px.unwrap_or(USUAL_CELL_PX),
            remote: terminal.remote.value,
            // A few colours show no landscape, only bands of it; and over a network its cells cost as much as the tree.
            landscape: scenery == Scenery::Lit
                && (terminal.graphics.value != Graphics::Cells
                    || colors == ColorDepth::True && !terminal.remote.value),
        }
    }

    /// What trees are painted with over this background.
    pub(super) fn style(&self) -> Style<'static> {
        match (self.landscape, self.dark) {
            (true, dark) => Style::landscape(self.background, dark),
            (false, true) => Style::over_dark(),
            (false, false) => Style::over_light(),
        }
    }

    /// Encodes pixels for an area, where the terminal shows such: `None` where it shows characters, and where
    /// that would take more bytes than the budget.
    pub(super) fn graphic(
        &self,
        picture: &Picture,
        area: Rect,
        budget: usize,
    ) -> Result<Option<Arc<Encoded>>, String> {
        let Some(protocol) = self.graphics else { return Ok(None) };
        // What frames the pieces in which it is sent comes on top.
        let (size, payload) = ((picture.width(), picture.height()), budget / 25 * 24);
        let encoded =
            encode(protocol, picture.rgba(), size, area, payload).map_err(|error| error.to_string())?;
        // Sixels cannot be made smaller at will: where they are too many bytes, cells show.
        Ok((encoded.len() <= budget).then(|| Arc::new(encoded)))
    }

    /// Pixels of a picture that an area of cells shows as characters.
    pub(super) fn pixels_of_cells(&self, columns: u16, rows: u16) -> (u32, u32) {
        let (wide, high) = self.cell_px;
        square_pixels(columns, rows, f32::from(wide) / f32::from(high.max(1)))
    }

    /// A picture as characters, in a number of columns and rows and about a number of bytes.
    pub(super) fn cells(
        &self,
        picture: &Picture,
        size: Size,
        (columns, rows): (u16, u16),
        budget: usize,
    ) -> Result<CellPicture, String> {
        let image =
            Image::new(size.width(), size.height(), picture.rgba()).map_err(|error| error.to_string())?;
        let style = CellStyle { glyphs: self.glyphs, colors: self.colors, background: self.background };
        Ok(CellPicture::draw(&image, columns, rows, &style, budget))
    }
}

/// Draws pictures, one after the other, and keeps what the next one may need.
#[derive(Default)]
pub struct Painter {
    scene: Option<(Arc<ShownTree>, Scene)>,
    stage: Option<(Arc<ShownTree>, u32, Option<Plant>)>,
}

impl Painter {
    /// Draws a picture; `None` when it was cancelled.
    pub fn paint(&mut self, request: DrawRequest, watcher: &Watcher<'_>) -> Option<Result<Painted, String>> {
        match self.paint_or_stop(request, watcher) {
            Ok(painted) => Some(Ok(painted)),
            Err(None) => None,
            Err(Some(why)) => Some(Err(why)),
        }
    }

    /// `Err(None)` when it was cancelled.
    fn paint_or_stop(
        &mut self,
        request: DrawRequest,
        watcher: &Watcher<'_>,
    ) -> Result<Painted, Option<String>> {
        let start = Instant::now();
        let medium = request.medium;
        let area = request.area;
        // Sixels cannot be stretched, so that a coarse draft would not fill its area.
        let sixels = medium.graphics == Some(Protocol::Sixel);
        let (wide, high) = exact_pixels(area, medium.cell_px);
        let can_be_exact = request.detail == Detail::Full
            && wide.max(high) <= linden_raster::MAX_SIDE
            && u64::from(wide) * u64::from(high) <= MOST_SIXELS;
        let protocol = medium.graphics.filter(|_| !sixels || can_be_exact);
        let (width, height) = match protocol {
            None => medium.pixels_of_cells(area.width, area.height),
            Some(Protocol::Sixel) => (wide, high),
            Some(_) => pixels(area, medium.cell_px, request.detail),
        };
        let size = Size::new(width, height).map_err(|error| Some(error.to_string()))?;
        let picture = self.draw(&request, size, watcher)?;
        let budget = match (request.detail, medium.remote) {
            (Detail::Draft, true) => DRAFT_BYTES,
            (Detail::Full, true) => FULL_BYTES,
            (_, false) => usize::MAX,
        };
        let graphic = Medium { graphics: protocol, ..medium }.graphic(&picture, area, budget)?;
        // Cells of full pictures stay within their budget at home too: the difference is not seen.
        // Those that only stand until the pixels come, or below a dialog, are a draft.
        let for_cells = match (request.detail, medium.remote) {
            (_, false) => FULL_BYTES,
            (Detail::Full, true) if graphic.is_none() => FULL_CELLS_BYTES,
            (_, true) => DRAFT_CELLS_BYTES,
        };
        let cells = medium.cells(&picture, size, (area.width, area.height), for_cells)?;
        let view = request.subject.extent().map(|extent| request.camera.view(extent, size));
        let scale = view.map_or(0.0, |view| view.scale_at_target());
        let columns_per_m = scale * f32::from(area.width) / width as f32;
        let shows_person = request.camera.extent.is_some_and(|extent| extent.person.is_some());
        let legend = legend(&request);
        Ok(Painted { legend, cells, graphic, columns_per_m, shows_person, took: start.elapsed(), request })
    }

    /// The pixels; `Err(None)` when it was cancelled.
    fn draw(
        &mut self,
        request: &DrawRequest,
        size: Size,
        watcher: &Watcher<'_>,
    ) -> Result<Picture, Option<String>> {
        let base = request.medium.style();
        let shown = match &request.subject {
            Subject::Tree(shown) => shown,
            Subject::Forest(forest) => return stand(forest, request, base, size, watcher),
        };
        let points = shown.grown.colonized.as_ref().map_or(&[][..], |colonized| &colonized.points);
        let bare = request.pick.is_some_and(|pick| pick.bare);
        let look = if bare { PictureLook::Skeleton(Paint::Wood) } else { request.look };
        let marked: Vec<Vec<Vec3>> = request
            .pick
            .and_then(|pick| pick.axis)
            .into_iter()
            .map(|axis| line_of(&shown.grown.skeleton, axis))
            .collect();
        let style = Style {
            marked: &marked,
            paint: if let PictureLook::Skeleton(paint) = look { paint } else { base.paint },
            points: if request.points { points } else { &[] },
            outline: if request.outline { &shown.outline } else { &[] },
            person: request.person,
            leaf_colors: shown.recipe.preset.dressing.foliage.turtle_colors(),
            draft: request.detail == Detail::Draft,
            ..base
        };
        let drawn = match (look, request.stage) {
            // Until the surface is there, its skeleton is: a draft does not wait.
            (PictureLook::Surface, None) if request.detail == Detail::Full || self.has_scene(shown) => {
                let Some(frame) = request.wind else {
                    let scene = self.scene(shown, false, watcher)?;
                    return surface(&Surface::from(scene), request, &style, size, watcher);
                };
                let (skeleton, _) = blown_at(shown, frame, watcher)?;
                let scene = self.scene(shown, true, watcher)?;
                let parts = moved(&scene.parts, frame);
                let materials = &scene.materials;
                let blown = Surface { parts: &parts, materials, skeleton: &skeleton };
                return surface(&blown, request, &style, size, watcher);
            }
            (_, None) => {
                let blown = request.wind.map(|frame| blown_at(shown, frame, watcher)).transpose()?;
                let calm = (&*shown.grown.skeleton, &*shown.grown.organs);
                let (skeleton, organs) = blown.as_ref().map_or(calm, |(wood, leaves)| (wood, leaves));
                let style = Style { organs: (!bare).then_some(organs), ..style };
                look.draw(skeleton, &request.camera, &style, size, watcher)
            }
            (_, Some(step)) => {
                let Some(Plant { skeleton, organs, .. }) = self.stage(shown, step, watcher)? else {
                    let bytes = size.width() as usize * size.height() as usize * 4;
                    return Ok(Picture::new(size.width(), size.height(), vec![0; bytes]));
                };
                let style = Style { organs: Some(&organs), ..style };
                look.draw(&skeleton, &request.camera, &style, size, watcher)
            }
        };
        drawn.map_err(unless_cancelled)
    }

    fn has_scene(&self, shown: &Arc<ShownTree>) -> bool {
        self.scene.as_ref().is_some_and(|(of, _)| Arc::ptr_eq(of, shown))
    }

    /// The surface of a tree, no finer than a screen shows: exports have all of it. `sways`: with what
    /// moves it.
    fn scene(
        &mut self,
        shown: &Arc<ShownTree>,
        sways: bool,
        watcher: &Watcher<'_>,
    ) -> Result<&Scene, Option<String>> {
        let can_sway = |scene: &Scene| scene.parts.iter().all(|part| part.wind.is_some());
        let is_there = self.has_scene(shown)
            && (!sways || self.scene.as_ref().is_some_and(|(_, scene)| can_sway(scene)));
        if !is_there {
            self.scene = None;
            let mut recipe = (*shown.recipe).clone();
            recipe.preset.dressing.wind.wind = if sways { Wind::Sway } else { Wind::Off };
            recipe.preset.dressing.wind.blow.strength = wind_strength(&recipe.preset);
            recipe.preset.dressing.tubes.sides = recipe.preset.dressing.tubes.sides.min(MOST_SIDES);
            recipe.preset.dressing.bark.size_px = recipe.preset.dressing.bark.size_px.min(MOST_BARK_PX);
            recipe.preset.dressing.foliage.size_px = recipe.preset.dressing.foliage.size_px.min(MOST_LEAF_PX);
            let scene = dress(&recipe, &shown.grown, watcher).map_err(|error| match error {
                DressError::Cancelled(_) => None,
                other => Some(other.to_string()),
            })?;
            self.scene = Some((Arc::clone(shown), scene));
        }
        // It has just been put there.
        self.scene.as_ref().map(|(_, scene)| scene).ok_or(None)
    }

    /// A tree as it was at a step; `None` while there is nothing of it.
    fn stage(
        &mut self,
        shown: &Arc<ShownTree>,
        step: u32,
        watcher: &Watcher<'_>,
    ) -> Result<Option<Plant>, Option<String>> {
        if let Some((of, at, plant)) = &self.stage
            && Arc::ptr_eq(of, shown)
            && *at == step
        {
            return Ok(plant.clone());
        }
        let plant = super::grow::stage(shown, step, watcher)?;
        self.stage = Some((Arc::clone(shown), step, plant.clone()));
        Ok(plant)
    }
}

/// What the darkest and the brightest colour of a look mean.
fn legend(request: &DrawRequest) -> Option<[String; 2]> {
    let PictureLook::Skeleton(paint) = request.look else { return None };
    let shown = request.subject.tree()?;
    let skeleton = &shown.grown.skeleton;
    let thickness = |radius_m: f32| match radius_m * 2.0 {
        m if m >= 1.0 => format!("{m:.1} m"),
        m if m >= 0.01 => format!("{:.0} cm", m * 100.0),
        m => format!("{:.1} mm", m * 1000.0),
    };
    match paint {
        Paint::Wood => None,
        Paint::Order => Some(["order 0".to_owned(), shown.measures.max_order.to_string()]),
        Paint::Radius => {
            let thick = skeleton.radii.iter().copied().filter(|&radius| radius > 0.0);
            let (least, most) = thick.fold((f32::INFINITY, 0.0_f32), |(a, b), r| (a.min(r), b.max(r)));
            least.is_finite().then(|| [format!("{} thick", thickness(least)), thickness(most)])
        }
        Paint::Birth => Some(["step 0".to_owned(), shown.steps.to_string()]),
        Paint::Light => Some(["shade".to_owned(), "open sky".to_owned()]),
    }
}

/// Draws a surface.
fn surface(
    surface: &Surface<'_>,
    request: &DrawRequest,
    style: &Style<'_>,
    size: Size,
    watcher: &Watcher<'_>,
) -> Result<Picture, Option<String>> {
    draw_surface(surface, &request.camera, style, size, watcher).map_err(unless_cancelled)
}

/// Draws a forest.
fn stand(
    forest: &ShownForest,
    request: &DrawRequest,
    base: Style<'_>,
    size: Size,
    watcher: &Watcher<'_>,
) -> Result<Picture, Option<String>> {
    let style = Style { draft: request.detail == Detail::Draft, ..base };
    let holding = Holding::new(watcher, forest.grown.bytes());
    draw_stage(&forest.grown.stage(), &request.camera, &style, size, &holding).map_err(unless_cancelled)
}

fn unless_cancelled(error: RasterError) -> Option<String> {
    if error == RasterError::Cancelled { None } else { Some(error.to_string()) }
}

/// The wind that is played: where a preset has none, a breeze.
pub fn wind_strength(preset: &Preset) -> f64 {
    let strength = preset.dressing.wind.blow.strength;
    if strength > 0.0 { strength } else { Blow::default().strength }
}

/// A tree's wood and leaves at a frame of the wind's loop.
fn blown_at(
    shown: &ShownTree,
    frame: u32,
    watcher: &Watcher<'_>,
) -> Result<(Skeleton, Organs), Option<String>> {
    let preset = &shown.recipe.preset;
    let blow = Blow { strength: wind_strength(preset), ..preset.dressing.wind.blow };
    blown(&blow, preset.seed, &shown.grown.skeleton, &shown.grown.organs, frame, watcher).map_err(|_| None)
}

/// The parts at a frame of their loop.
fn moved(parts: &[Part], frame: u32) -> Vec<Part> {
    let moved = |part: &Part| {
        let wind = part.wind.as_ref();
        let positions = wind.and_then(|wind| wind.moved(&part.mesh.positions, frame));
        let Mesh { normals, uvs, triangles, .. } = part.mesh.clone();
        let positions = positions.unwrap_or_else(|| part.mesh.positions.clone());
        Part::new(part.name.clone(), part.material, Mesh { positions, normals, uvs, triangles })
    };
    parts.iter().map(moved).collect()
}

/// Pixels of a picture that fills an area of cells one to one.
pub(super) fn exact_pixels(area: Rect, (wide, high): (u16, u16)) -> (u32, u32) {
    ((u32::from(area.width) * u32::from(wide)).max(1), (u32::from(area.height) * u32::from(high)).max(1))
}

/// Pixels of a picture over an area of cells: in the cells' proportions, not more than can be seen.
fn pixels(area: Rect, cell_px: (u16, u16), detail: Detail) -> (u32, u32) {
    let (width, height) = exact_pixels(area, cell_px);
    let coarser = if detail == Detail::Draft { DRAFT_SCALE } else { 1 };
    let shrink = width.max(height).div_ceil(LONGEST_PX).max(1) * coarser;
    ((width / shrink).max(1), (height / shrink).max(1))
}
