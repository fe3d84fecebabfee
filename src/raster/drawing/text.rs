//! Text as outlines of the embedded font, `DejaVu` Sans.

use std::sync::LazyLock;

use glam::Vec2;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, OutlineBuilder};

/// The font, which is embedded; `None` never.
static FACE: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).ok());

/// The outlines of a line of text, and how wide it is, pixels: its base line begins at `at`, its capitals
/// are `height` high. Characters that the font has not are boxes.
pub(crate) fn outlines(text: &str, at: Vec2, height: f32) -> (Option<Path>, f32) {
    let Some(face) = FACE.as_ref() else { return (None, 0.0) };
    let capitals = face.capital_height().filter(|&units| units > 0).unwrap_or(1493);
    let scale = height / f32::from(capitals);
    let mut pen = Pen { builder: PathBuilder::new(), at, scale };
    for c in text.chars() {
        let glyph = face.glyph_index(c).unwrap_or(ttf_parser::GlyphId(0));
        face.outline_glyph(glyph, &mut pen);
        pen.at.x += f32::from(face.glyph_hor_advance(glyph).unwrap_or(0)) * scale;
    }
    let width = pen.at.x - at.x;
    (pen.builder.finish(), width)
}

/// Font units, y up → pixels, y down.
struct Pen {
    builder: PathBuilder,
    at: Vec2,
    scale: f32,
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> Vec2 {
        self.at + Vec2::new(x, -y) * self.scale
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let p = self.place(x, y);
        self.builder.move_to(p.x, p.y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let p = self.place(x, y);
        self.builder.line_to(p.x, p.y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (a, p) = (self.place(x1, y1), self.place(x, y));
        self.builder.quad_to(a.x, a.y, p.x, p.y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (a, b, p) = (self.place(x1, y1), self.place(x2, y2), self.place(x, y));
        self.builder.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}
