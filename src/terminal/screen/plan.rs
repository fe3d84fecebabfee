//! In what order the cells of a frame are sent.

use std::ops::Range;

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;

use super::Frame;

/// Which cells come when, and which are beneath a picture of pixels.
pub(super) struct Plan {
    /// By place in the buffer.
    pub late: Vec<bool>,
    /// By place in the buffer; empty where nothing is.
    covered: Vec<bool>,
    /// The rows that have late cells.
    pub late_rows: Range<u16>,
}

impl Plan {
    pub fn new(frame: &Frame<'_>, covered: Option<Rect>) -> Self {
        let area = frame.buffer.area;
        let mut plan =
            Self { late: vec![false; frame.buffer.content.len()], covered: Vec::new(), late_rows: 0..0 };
        for &rect in frame.late {
            let rect = rect.intersection(area);
            if rect.is_empty() {
                continue;
            }
            mark(&mut plan.late, frame.buffer, rect);
            plan.late_rows = if plan.late_rows.is_empty() {
                rect.top()..rect.bottom()
            } else {
                plan.late_rows.start.min(rect.top())..plan.late_rows.end.max(rect.bottom())
            };
        }
        if let Some(rect) = covered {
            plan.cover(frame.buffer, rect);
        }
        plan
    }

    /// The cells beneath a picture alone.
    pub fn beneath(buffer: &Buffer, area: Rect) -> Self {
        let mut late = vec![false; buffer.content.len()];
        mark(&mut late, buffer, area);
        Self { covered: late.clone(), late, late_rows: area.top()..area.bottom() }
    }

    fn cover(&mut self, buffer: &Buffer, rect: Rect) {
        self.covered.resize(buffer.content.len(), false);
        mark(&mut self.covered, buffer, rect.intersection(buffer.area));
    }

    /// The cell that should be shown at a place.
    pub fn cell<'a>(&self, buffer: &'a Buffer, at: usize) -> &'a Cell {
        const BLANK: &Cell = &Cell::EMPTY;
        if self.covered.get(at) == Some(&true) { BLANK } else { &buffer.content[at] }
    }
}

fn mark(marks: &mut [bool], buffer: &Buffer, rect: Rect) {
    for row in rect.top()..rect.bottom() {
        let from = buffer.index_of(rect.x, row);
        marks[from..from + usize::from(rect.width)].fill(true);
    }
}
