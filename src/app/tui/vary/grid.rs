//! The grid of a gallery: where its pictures are.

use ratatui::layout::Rect;

use crate::tui::layout::inside;

/// The smallest cell with its frame: less shows no tree.
const SMALLEST: (u16, u16) = (18, 9);
/// The most cells, across and down: more are more than one looks at, and too small for it.
const MOST: (u16, u16) = (4, 3);

/// From this height on, the room in a frame has a row of words below the picture.
const WITH_WORDS: u16 = 8;

/// Cells of one size, row by row from the upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// The first cell.
    first: Rect,
    /// Cells across.
    pub columns: usize,
    /// Cells.
    count: usize,
}

/// The parts of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Whether it has a frame, which carries the words.
    pub framed: bool,
    /// The picture; may be empty.
    pub picture: Rect,
    /// The row of words below the picture; empty where there is no room.
    pub words: Rect,
}

impl Grid {
    /// How many cells an area has room for; at least one.
    pub fn most(area: Rect) -> usize {
        let (columns, rows) = Self::room(area);
        usize::from(columns) * usize::from(rows)
    }

    fn room(area: Rect) -> (u16, u16) {
        ((area.width / SMALLEST.0).clamp(1, MOST.0), (area.height / SMALLEST.1).clamp(1, MOST.1))
    }

    /// `count` cells in an area, at most [`Self::most`], as large as can be.
    pub fn new(area: Rect, count: usize) -> Self {
        let (most_columns, most_rows) = Self::room(area);
        let count = count.clamp(1, Self::most(area));
        // The larger the shorter side of a picture, the better; then the fewer rows.
        let side = |columns: u16| {
            let rows = count.div_ceil(usize::from(columns)) as u16;
            (rows <= most_rows).then(|| (area.width / columns).min((area.height / rows).saturating_mul(2)))
        };
        let columns = (1..=most_columns).max_by_key(|&columns| side(columns)).unwrap_or(1);
        let rows = count.div_ceil(usize::from(columns)) as u16;
        let (width, height) = (area.width / columns, area.height / rows);
        // What is left over is left and right.
        let x = area.x + (area.width - width * columns) / 2;
        Self { first: Rect { x, y: area.y, width, height }, columns: columns.into(), count }
    }

    /// How many cells there are.
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Where a cell is, with its frame.
    pub fn cell(&self, index: usize) -> Rect {
        let (column, row) = (index % self.columns, index / self.columns);
        Rect {
            x: self.first.x + self.first.width * column as u16,
            y: self.first.y + self.first.height * row as u16,
            ..self.first
        }
    }

    /// The parts of a cell.
    pub fn parts(cell: Rect) -> Parts {
        let inner = inside(cell);
        let nothing = Rect { y: cell.bottom(), height: 0, ..cell };
        if inner != cell {
            if inner.height < WITH_WORDS {
                return Parts { framed: true, picture: inner, words: nothing };
            }
            let picture = Rect { height: inner.height - 1, ..inner };
            let words = Rect { y: picture.bottom(), height: 1, ..inner };
            return Parts { framed: true, picture, words };
        }
        if cell.height < 2 {
            return Parts { framed: false, picture: cell, words: nothing };
        }
        let picture = Rect { height: cell.height - 1, ..cell };
        Parts { framed: false, picture, words: Rect { y: picture.bottom(), height: 1, ..cell } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_lie_inside_and_beside_each_other_at_every_size() {
        for width in 0..=400 {
            for height in 0..=120 {
                let area = Rect { x: 1, y: 2, width, height };
                let most = Grid::most(area);
                assert!((1..=12).contains(&most));
                // All counts where they are few, else the borders.
                for count in [1, 2, 3, most / 2, most - 1, most] {
                    let count = count.clamp(1, most);
                    let grid = Grid::new(area, count);
                    assert_eq!(grid.len(), count);
                    let mut covered = std::collections::BTreeSet::new();
                    for index in 0..count {
                        let cell = grid.cell(index);
                        assert_eq!((cell.width, cell.height), (grid.first.width, grid.first.height));
                        assert!(
                            area.contains(cell.as_position()) || cell.is_empty(),
                            "{area} {count} {cell}"
                        );
                        assert_eq!(area.intersection(cell).area(), cell.area(), "{area} {count} {cell}");
                        // Of one size, so that different corners a cell's size apart do not overlap.
                        let place = (
                            (cell.x - grid.first.x).checked_div(cell.width),
                            (cell.y - grid.first.y).checked_div(cell.height),
                        );
                        assert!(cell.is_empty() || covered.insert(place), "{area} {count} {cell}");
                        if most > 1 {
                            assert!(
                                cell.width >= SMALLEST.0.min(width) && cell.height >= SMALLEST.1.min(height)
                            );
                        }
                        let parts = Grid::parts(cell);
                        assert_eq!(cell.intersection(parts.picture).area(), parts.picture.area());
                        assert!(parts.picture.intersection(parts.words).is_empty());
                    }
                }
            }
        }
    }

    #[test]
    fn few_cells_share_the_room_as_is_best_for_pictures() {
        let shape = |width, height, count| {
            let grid = Grid::new(Rect::new(0, 0, width, height), count);
            (grid.columns, count.div_ceil(grid.columns))
        };
        assert_eq!(shape(78, 21, 2), (2, 1));
        assert_eq!(shape(78, 21, 8), (4, 2));
        assert_eq!(shape(60, 100, 3), (1, 3));
        assert_eq!(shape(400, 118, 12), (4, 3));
        assert_eq!(Grid::most(Rect::new(0, 0, 78, 21)), 8);
        assert_eq!(Grid::most(Rect::new(0, 0, 1, 1)), 1);
        assert_eq!(Grid::most(Rect::new(0, 0, 118, 38)), 12);
        assert_eq!(Grid::most(Rect::new(0, 0, 398, 117)), 12);
    }
}
