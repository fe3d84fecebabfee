//! The pictures that are asked for and given, and what a terminal shows them with.

use std::sync::Arc;
use std::time::Duration;

use glam::Vec3;
use linden::picture::Picture;
use linden::{Monitor, Skeleton};
use linden_raster::{Camera, Handle, Paint, RasterError, Size, Slice, Style, draw_flat, draw_skeleton};
use linden_terminal::cells::{CellPicture, square_pixels};
use linden_terminal::graphics::{Encoded, Protocol, encode};
use linden_terminal::probe::{Capabilities, Graphics};
use linden_terminal::{CellStyle, ColorDepth, Glyphs, Image};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::Subject;
use crate::config::settings::Scenery;

/// Most bytes of a draft, and of a full picture, over a network.
pub(super) const DRAFT_BYTES: usize = 16_000;
pub(super) const FULL_BYTES: usize = 100_000;
/// The same of characters: both come for each preset that the list's cursor passes.
pub(super) const DRAFT_CELLS_BYTES: usize = 3_500;
pub(super) const FULL_CELLS_BYTES: usize = 9_000;
/// The longer side of a picture that a terminal shows as pixels.
const LONGEST_PX: u32 = 1400;
/// How many times coarser a draft in pixels is.
const DRAFT_SCALE: u32 = 2;
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

/// What is pointed at in a picture.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// Polylines, metres.
    pub lines: Arc<Vec<Vec<Vec3>>>,
    /// What can be taken hold of.
    pub handles: Arc<Vec<Handle>>,
    /// Whether wood alone is drawn, so that what is marked can be told apart.
    pub bare: bool,
}

impl PartialEq for Marks {
    fn eq(&self, other: &Self) -> bool {
        let has_same_lines = Arc::ptr_eq(&self.lines, &other.lines) || self.lines == other.lines;
        self.bare == other.bare && has_same_lines && self.handles == other.handles
    }
}

/// A picture that should be on screen.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "switches that have nothing to do with each other")]
pub struct DrawRequest {
    /// What of.
    pub subject: Subject,
    /// The step of growth that is drawn, `None` for the grown tree.
    pub stage: Option<u32>,
    /// The frame of the wind's loop that the grown tree is drawn at, `None` for a calm.
    pub wind: Option<u32>,
    /// The level of detail that is drawn as it is exported, the finest being 0; `None` for all that grew.
    pub level: Option<usize>,
    /// From where.
    pub camera: Camera,
    /// What of it.
    pub look: PictureLook,
    /// Where it is cut, for a picture of that alone.
    pub slice: Option<Slice>,
    /// With the points of its scan, or its attraction points.
    pub points: bool,
    /// With its crown's outline.
    pub outline: bool,
    /// With what stands in its way and what takes light from it.
    pub obstructions: bool,
    /// With a person beside it.
    pub person: bool,
    /// What is pointed at in it.
    pub marks: Option<Marks>,
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
    pub(super) columns_per_m: f32,
    /// Whether a person stands beside the tree.
    pub shows_person: bool,
    /// What the ends of the colours mean, where these show a quantity.
    pub legend: Option<[String; 2]>,
    /// Where the tree is cut, and how thick the thickest wood there is, for people.
    pub cut: Option<String>,
    /// The level of detail that it shows, with its triangles.
    pub level: Option<(usize, u64)>,
    /// How long drawing took.
    pub took: Duration,
}

impl DrawRequest {
    /// What can be taken hold of.
    pub(super) fn handles(&self) -> &[Handle] {
        self.marks.as_ref().map_or(&[], |marks| &marks.handles[..])
    }

    /// The polylines that are pointed at, and whether wood alone is drawn.
    pub(super) fn marked(&self) -> (&[Vec<Vec3>], bool) {
        self.marks.as_ref().map_or((&[], false), |marks| (&marks.lines[..], marks.bare))
    }

    /// Whether another request is for the same picture, whatever the detail.
    pub fn is_of(&self, other: &Self) -> bool {
        self.subject.is(&other.subject)
            && (self.stage, self.wind, self.level) == (other.stage, other.wind, other.level)
            && self.camera == other.camera
            && self.look == other.look
            && self.slice == other.slice
            && (self.points, self.outline, self.person) == (other.points, other.outline, other.person)
            && self.obstructions == other.obstructions
            && self.marks == other.marks
            && self.area == other.area
            && self.medium == other.medium
    }
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

/// Pixels of a picture that fills an area of cells one to one.
pub(super) fn exact_pixels(area: Rect, (wide, high): (u16, u16)) -> (u32, u32) {
    ((u32::from(area.width) * u32::from(wide)).max(1), (u32::from(area.height) * u32::from(high)).max(1))
}

/// Pixels of a picture over an area of cells: in the cells' proportions, not more than can be seen.
pub(super) fn pixels(area: Rect, cell_px: (u16, u16), detail: Detail) -> (u32, u32) {
    let (width, height) = exact_pixels(area, cell_px);
    let coarser = if detail == Detail::Draft { DRAFT_SCALE } else { 1 };
    let shrink = width.max(height).div_ceil(LONGEST_PX).max(1) * coarser;
    ((width / shrink).max(1), (height / shrink).max(1))
}
