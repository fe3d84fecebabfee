//! In what order the cells of a frame are sent.

use std::ops::Range;

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;

use super::Frame;

/// When a cell is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layer {
    /// Before all others: what answers a key.
    First,
    /// With the text.
    Text,
    /// After the text: pictures.
    Late,
}

/// Which cells come when, and which are beneath pictures of pixels.
pub(super) struct Plan {
    /// By place in the buffer.
    pub layers: Vec<Layer>,
    /// By place in the buffer; empty where nothing is.
    covered: Vec<bool>,
    /// The rows that have late cells.
    pub late_rows: Range<u16>,
}

impl Plan {
    pub fn new(frame: &Frame<'_>, covered: &[Rect]) -> Self {
        let area = frame.buffer.area;
        let layers = vec![Layer::Text; frame.buffer.content.len()];
        let mut plan = Self { layers, covered: Vec::new(), late_rows: 0..0 };
        for rect in frame.first {
            mark(&mut plan.layers, Layer::First, frame.buffer, rect.intersection(area));
        }
        for &rect in frame.late {
            let rect = rect.intersection(area);
            if rect.is_empty() {
                continue;
            }
            mark(&mut plan.layers, Layer::Late, frame.buffer, rect);
            plan.late_rows = if plan.late_rows.is_empty() {
                rect.top()..rect.bottom()
            } else {
                plan.late_rows.start.min(rect.top())..plan.late_rows.end.max(rect.bottom())
            };
        }
        for &rect in covered {
            plan.cover(frame.buffer, rect);
        }
        plan
    }

    /// The cells beneath a picture alone.
    pub fn beneath(buffer: &Buffer, area: Rect) -> Self {
        let mut layers = vec![Layer::Text; buffer.content.len()];
        mark(&mut layers, Layer::Late, buffer, area);
        let covered = layers.iter().map(|layer| *layer == Layer::Late).collect();
        Self { layers, covered, late_rows: area.top()..area.bottom() }
    }

    fn cover(&mut self, buffer: &Buffer, rect: Rect) {
        self.covered.resize(buffer.content.len(), false);
        mark(&mut self.covered, true, buffer, rect.intersection(buffer.area));
    }

    /// The cell that should be shown at a place.
    pub fn cell<'a>(&self, buffer: &'a Buffer, at: usize) -> &'a Cell {
        const BLANK: &Cell = &Cell::EMPTY;
        if self.covered.get(at) == Some(&true) { BLANK } else { &buffer.content[at] }
    }
}

fn mark<T: Copy>(marks: &mut [T], with: T, buffer: &Buffer, rect: Rect) {
    for row in rect.top()..rect.bottom() {
        let from = buffer.index_of(rect.x, row);
        marks[from..from + usize::from(rect.width)].fill(with);
    }
}
