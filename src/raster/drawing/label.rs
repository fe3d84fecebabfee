//! Labels on finished pictures: names below the trees of a sheet.

use glam::Vec2;
use linden_pipeline::picture::Picture;
use tiny_skia::{FillRule, PixmapMut, Transform};

use super::paint::ink;
use super::text;

/// Lines of text below each other, each in the middle of a picture's width.
///
/// What is too wide is cut, and ends with an ellipsis.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The lines, the uppermost first.
    pub lines: Vec<String>,
    /// The height of capitals, pixels.
    pub height: f32,
    /// sRGB.
    pub color: [u8; 3],
}

/// The distance of base lines, in heights of capitals.
const LEADING: f32 = 1.9;
/// What is free above and below all lines, in heights of capitals.
const MARGIN: f32 = 0.9;

impl Label {
    /// The rows that lines of a height take, with what is free above and below.
    pub fn rows(lines: u32, height: f32) -> u32 {
        if lines == 0 {
            return 0;
        }
        (height * (1.0 + 2.0 * MARGIN + LEADING * (lines - 1) as f32)).ceil() as u32
    }

    /// An opaque picture with the label below it, on `paper`; `rows` are added.
    pub fn below(&self, picture: &Picture, rows: u32, paper: [u8; 3]) -> Picture {
        let (width, height) = (picture.width(), picture.height() + rows);
        let mut rgba = picture.rgba().to_vec();
        let [r, g, b] = paper;
        let missing = width as usize * rows as usize;
        rgba.extend(std::iter::repeat_n([r, g, b, 255], missing).flatten());
        if let Some(mut pixels) = PixmapMut::from_bytes(&mut rgba, width, height) {
            let room = width as f32 - 2.0 * MARGIN * self.height;
            for (i, line) in self.lines.iter().enumerate() {
                let base = picture.height() as f32 + self.height * (1.0 + MARGIN + LEADING * i as f32);
                let (line, wide) = fitting(line, self.height, room);
                let at = Vec2::new((width as f32 - wide) / 2.0, base);
                if let (Some(path), _) = text::outlines(&line, at, self.height) {
                    let paint = ink(self.color, 1.0);
                    pixels.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
                }
            }
        }
        Picture::new(width, height, rgba)
    }
}

/// As much of a line as fits, and how wide that is.
fn fitting(line: &str, height: f32, room: f32) -> (String, f32) {
    let width = |text: &str| text::outlines(text, Vec2::ZERO, height).1;
    let mut shown = line.to_owned();
    let mut letters = line.chars().count();
    while width(&shown) > room && letters > 1 {
        letters -= 1;
        shown = line.chars().take(letters).chain(['…']).collect();
    }
    let wide = width(&shown);
    (shown, wide)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_below_its_picture_and_leaves_it_as_it_was() {
        let picture = Picture::new(60, 20, [200, 210, 220, 255].repeat(60 * 20));
        let label = Label { lines: vec!["fir".into(), "seed 7".into()], height: 8.0, color: [0; 3] };
        let rows = Label::rows(2, 8.0);
        let found = label.below(&picture, rows, [255; 3]);
        assert_eq!((found.width(), found.height()), (60, 20 + rows));
        assert_eq!(found.rgba()[..picture.rgba().len()], *picture.rgba());
        let below = &found.rgba()[picture.rgba().len()..];
        let dark: Vec<usize> = (0..below.len() / 4).filter(|i| below[i * 4] < 80).collect();
        // Something in each half of the rows, nothing at the edges.
        assert!(
            dark.iter().any(|i| i / 60 < rows as usize / 2)
                && dark.iter().any(|i| i / 60 > rows as usize / 2)
        );
        assert!(dark.iter().all(|i| (2..58).contains(&(i % 60))), "{dark:?}");
        assert!(dark.iter().all(|i| i / 60 > 2 && i / 60 + 2 < rows as usize));
    }

    #[test]
    fn what_is_too_wide_is_cut() {
        let (short, wide) = fitting("a name that no picture is wide enough for", 10.0, 80.0);
        assert!(short.ends_with('…') && wide <= 80.0, "{short}");
        assert_eq!(fitting("fir", 10.0, 80.0).0, "fir");
    }
}
