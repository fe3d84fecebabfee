//! How large the terminal is.

use crate::system::asked_size;

/// The most columns, and the most rows, that are used of a terminal: those of a screen of 8K in a tiny
/// font. What claims more has them left empty, since a grid of all that can be claimed (65535×65535)
/// would take more memory than there is.
pub const MAX_CELLS: u16 = 1000;

/// Columns and rows of characters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerminalSize {
    /// Characters per row, 1 to [`MAX_CELLS`].
    pub columns: u16,
    /// Rows, 1 to [`MAX_CELLS`].
    pub rows: u16,
    /// A character's width divided by its height.
    pub cell_aspect: f32,
}

impl Default for TerminalSize {
    /// The VT100's, with the proportions of most fonts.
    fn default() -> Self {
        Self { columns: 80, rows: 24, cell_aspect: 0.5 }
    }
}

impl TerminalSize {
    /// The terminal that the process has; `COLUMNS` and `LINES`
    /// come first, and 80×24 is what there is without a terminal.
    pub fn of_stdout() -> Self {
        Self::resolve(|name| std::env::var(name).ok(), asked_size())
    }

    /// The same from values: an environment, and what the terminal says (columns, rows).
    ///
    /// A variable that is not a number from 1 to 65535 counts as not set, as POSIX leaves it; more than
    /// [`MAX_CELLS`] count as that.
    pub fn resolve(lookup: impl Fn(&str) -> Option<String>, asked: Option<(u16, u16)>) -> Self {
        let given = |name| lookup(name)?.trim().parse().ok().filter(|&n: &u16| n > 0);
        let (columns, rows) = asked.map_or((None, None), |(c, r)| (Some(c), Some(r)));
        let fallback = Self::default();
        Self {
            columns: used(given("COLUMNS").or(columns.filter(|&n| n > 0)).unwrap_or(fallback.columns)),
            rows: used(given("LINES").or(rows.filter(|&n| n > 0)).unwrap_or(fallback.rows)),
            cell_aspect: fallback.cell_aspect,
        }
    }
}

/// Of columns or rows that are claimed, those that are used.
pub(crate) fn used(claimed: u16) -> u16 {
    claimed.min(MAX_CELLS)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(env: &[(&str, &str)], asked: Option<(u16, u16)>) -> (u16, u16) {
        let lookup = |name: &str| env.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned());
        let s = TerminalSize::resolve(lookup, asked);
        (s.columns, s.rows)
    }

    #[test]
    fn variables_then_the_terminal_then_the_default() {
        assert_eq!(size(&[], None), (80, 24));
        assert_eq!(size(&[], Some((132, 43))), (132, 43));
        assert_eq!(size(&[("COLUMNS", "100")], Some((132, 43))), (100, 43));
        assert_eq!(size(&[("COLUMNS", "100"), ("LINES", "7")], None), (100, 7));
    }

    #[test]
    fn nonsense_counts_as_not_set() {
        for bad in ["", "0", "-3", "many", "1e3", "99999999999"] {
            assert_eq!(size(&[("COLUMNS", bad)], Some((90, 30))), (90, 30), "{bad}");
        }
        assert_eq!(size(&[], Some((0, 0))), (80, 24), "a pseudo-terminal nobody has sized");
    }

    #[test]
    fn a_claim_that_no_screen_has_is_cut() {
        assert_eq!(size(&[], Some((u16::MAX, u16::MAX))), (MAX_CELLS, MAX_CELLS));
        assert_eq!(size(&[("LINES", "65535")], Some((90, 30))), (90, MAX_CELLS));
    }
}
