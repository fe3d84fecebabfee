//! Contact sheets: several trees on one picture, each with what tells it from the others.

use indicatif::HumanCount;
use linden::Monitor;
use linden::grow::Grown;
use linden::knob::printable;
use linden::picture::Picture;
use linden::recipe::Recipe;
use linden_raster::drawing::label::Label;
use linden_raster::{Background, Camera, Extent, Size, Style};

use super::PITCH_DEG;
use super::sitter::{PreviewLook, Say, Sitter};
use crate::exit::usage;
use crate::viewpoint::{around, broad_side};

/// What a sheet is to show.
#[derive(Clone, Copy)]
pub struct SheetPlan {
    /// Trees of each source, with its seed and those that follow.
    pub seeds: u64,
    /// Whether each is shown in all its levels of detail.
    pub lods: bool,
    /// Of each tree, pixels.
    pub size: (u32, u32),
    /// Trees in a row; `None`: a sheet that is a little wider than high, or a tree a row in all its levels.
    pub columns: Option<u32>,
    /// How they are drawn; `None`: as is usual for each.
    pub look: Option<PreviewLook>,
    /// Whether each has its name below.
    pub names: bool,
}

/// A sheet that is being drawn.
pub struct SheetDrawing {
    plan: SheetPlan,
    levels: u64,
    count: u32,
    columns: u32,
    /// Lines of a label, the height of its capitals, and rows that it takes.
    lines: u32,
    capitals: f32,
    below: u32,
    cell: Size,
    whole: Size,
    style: Style<'static>,
    /// What all pictures frame; `None`: each its tree.
    frame: Option<Extent>,
    mosaic: Mosaic,
    place: u32,
}

impl SheetDrawing {
    /// An empty sheet for so many sources, of which the one with most has so many levels of detail.
    ///
    /// # Errors
    /// A size that no picture has.
    pub fn new(plan: SheetPlan, sources: usize, levels: usize) -> anyhow::Result<Self> {
        let levels = if plan.lods { levels as u64 } else { 1 };
        let count = u32::try_from(sources as u64 * plan.seeds * levels).unwrap_or(u32::MAX);
        let (width, height) = plan.size;
        let columns = plan.columns.unwrap_or_else(|| match levels {
            1 => columns(count, plan.size),
            // A tree a row.
            levels => levels as u32,
        });
        let columns = columns.min(count);
        let rows = count.div_ceil(columns);
        let lines = if plan.names { 1 + u32::from(plan.seeds > 1) + u32::from(plan.lods) } else { 0 };
        let capitals = capitals(width);
        let below = Label::rows(lines, capitals);
        let high = height.saturating_add(below);
        let whole = Size::new(columns.saturating_mul(width), rows.saturating_mul(high)).map_err(usage)?;
        let cell = Size::new(width, height).map_err(usage)?;
        let style = if plan.look == Some(PreviewLook::Turtle) { Style::paper() } else { Style::studio() };
        // Its pixels are taken when the first tree is laid, after they were asked for.
        let mosaic = Mosaic { width: whole.width(), height: whole.height(), rgba: Vec::new() };
        Ok(Self {
            plan,
            levels,
            count,
            columns,
            lines,
            capitals,
            below,
            cell,
            whole,
            style,
            frame: None,
            mosaic,
            place: 0,
        })
    }

    /// All trees in one scale: each picture frames what holds all of these.
    #[must_use]
    pub fn in_one_scale(self, extents: &[Extent]) -> Self {
        Self { frame: (!extents.is_empty()).then(|| around(extents)), ..self }
    }

    /// Levels of detail of each tree that have a place.
    pub const fn levels(&self) -> u64 {
        self.levels
    }

    /// Places.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Places that are filled.
    pub const fn drawn(&self) -> u32 {
        self.place
    }

    /// Pixels of the sheet.
    pub const fn size(&self) -> Size {
        self.whole
    }

    /// Bytes of them.
    pub fn bytes(&self) -> u64 {
        u64::from(self.whole.width()) * u64::from(self.whole.height()) * 4
    }

    /// Draws the next tree.
    ///
    /// # Errors
    /// Those of dressing and drawing.
    pub fn lay(
        &mut self,
        recipe: &Recipe,
        grown: &Grown,
        say: Say<'_>,
        monitor: &dyn Monitor,
    ) -> anyhow::Result<()> {
        let sitters = if self.plan.lods {
            Sitter::of_levels(recipe, grown, say, monitor)?
        } else {
            vec![Sitter::new(recipe, grown, self.plan.look, None, say, monitor)?]
        };
        if self.mosaic.rgba.is_empty() {
            self.mosaic = Mosaic::new(self.whole.width(), self.whole.height());
        }
        let (width, height) = self.plan.size;
        let high = height.saturating_add(self.below);
        let obstructions = linden::grow::obstructions(recipe, monitor)?;
        let camera = Camera { extent: self.frame, ..Camera::orbit(broad_side(&grown.skeleton), PITCH_DEG) };
        for ((level, at), sitter) in (self.place..).enumerate().zip(&sitters) {
            let style = Style { obstructions: &obstructions, ..sitter.styled(self.style) };
            let mut picture = sitter.draw(&camera, &style, self.cell, monitor)?;
            if self.lines > 0 {
                let lines = self.label(recipe, level, sitter);
                let label = Label { lines, height: self.capitals, color: self.style.ink };
                picture = label.below(&picture, self.below, paper(&self.style));
            }
            self.mosaic.lay(&picture, at % self.columns * width, at / self.columns * high);
        }
        self.place += self.levels as u32;
        Ok(())
    }

    /// The sheet.
    pub fn finish(self) -> Picture {
        self.mosaic.finish()
    }

    /// What stands below a tree: what it is, and what tells it from its neighbours.
    fn label(&self, recipe: &Recipe, level: usize, sitter: &Sitter<'_>) -> Vec<String> {
        let preset = &recipe.preset;
        let mut lines = vec![printable(&preset.name)];
        if self.plan.seeds > 1 {
            lines.push(format!("seed {}", preset.seed()));
        }
        if self.plan.lods {
            lines.push(format!("level {level}, {} triangles", HumanCount(sitter.triangles())));
        }
        lines
    }
}

/// Gives a tree that says nothing of them the usual levels of detail.
pub fn in_levels(recipe: &mut Recipe) {
    if recipe.preset.dressing.detail.levels() == 1 {
        recipe.preset.dressing.detail.lods = USUAL_LEVELS;
    }
}

/// Levels of detail of a tree that says nothing of them.
const USUAL_LEVELS: u32 = 4;

/// What labels stand on: the colour that pictures end with.
pub fn paper(style: &Style<'_>) -> [u8; 3] {
    match style.background {
        Background::Plain(color) | Background::Gradient(_, color) => color,
        Background::Landscape(landscape) => landscape.ground,
        Background::Transparent => [255; 3],
    }
}

/// The height of a label's capitals below pictures of a width, pixels.
pub fn capitals(width: u32) -> f32 {
    (width as f32 / 26.0).clamp(6.0, 24.0)
}

/// How many in a row give a sheet that is nearest to half as wide again as it is high.
pub fn columns(count: u32, (width, height): (u32, u32)) -> u32 {
    let aspect = |columns: u32| {
        let rows = count.div_ceil(columns);
        f64::from(columns) * f64::from(width) / (f64::from(rows) * f64::from(height))
    };
    let off = |columns: &u32| (aspect(*columns) - 1.5).abs();
    (1..=count.max(1)).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1)
}

/// A picture that is put together from others; white where none lies.
pub struct Mosaic {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Mosaic {
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, rgba: vec![255; width as usize * height as usize * 4] }
    }

    /// Copies a picture that fits, its upper left corner at a column and a row.
    pub fn lay(&mut self, picture: &Picture, column: u32, row: u32) {
        let bytes = picture.width() as usize * 4;
        for (line, pixels) in picture.rgba().chunks_exact(bytes).enumerate() {
            let at = ((row as usize + line) * self.width as usize + column as usize) * 4;
            self.rgba[at..at + bytes].copy_from_slice(pixels);
        }
    }

    pub fn finish(self) -> Picture {
        Picture::new(self.width, self.height, self.rgba)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_are_a_little_wider_than_high() {
        assert_eq!(columns(1, (240, 288)), 1);
        // 7 x 240 by 4 x 288 is 1.46.
        assert_eq!(columns(28, (240, 288)), 7);
        assert_eq!(columns(6, (100, 100)), 3);
    }

    #[test]
    fn pictures_lie_where_they_were_laid() {
        let mut sheet = Mosaic::new(3, 2);
        sheet.lay(&Picture::new(1, 2, vec![1, 2, 3, 4, 5, 6, 7, 8]), 2, 0);
        let rgba = sheet.finish().rgba().to_vec();
        assert_eq!((&rgba[8..12], &rgba[20..24]), (&[1, 2, 3, 4][..], &[5, 6, 7, 8][..]));
        assert!(rgba[..8].iter().chain(&rgba[12..20]).all(|&byte| byte == 255));
    }
}
