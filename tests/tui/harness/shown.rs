//! A screen as tests look at it.

use vt100::Screen;

/// What a screen shows at a moment.
#[derive(Clone)]
pub struct Shown {
    screen: Screen,
}

impl Shown {
    pub fn new(screen: Screen) -> Self {
        Self { screen }
    }

    /// Columns and rows.
    pub fn size(&self) -> (u16, u16) {
        let (rows, columns) = self.screen.size();
        (columns.get(), rows.get())
    }

    /// A row of text.
    pub fn row(&self, row: u16) -> String {
        self.screen.rows(0, self.size().0).nth(row.into()).unwrap_or_default()
    }

    /// All rows.
    pub fn rows(&self) -> Vec<String> {
        self.screen.rows(0, self.size().0).collect()
    }

    /// The rows of text, one below the other.
    pub fn text(&self) -> String {
        self.rows().join("\n")
    }

    /// The row of the form that has a knob, from its name on.
    pub fn knob(&self, name: &str) -> String {
        let begins = |row: &String| Some(row[row.rfind(&format!("{name} "))?..].to_owned());
        self.rows().iter().find_map(begins).unwrap_or_default()
    }

    /// The colour of the first letter of a text, where that is one of 24 bits.
    pub fn ink(&self, text: &str) -> Option<[u8; 3]> {
        let (row, at) = (0..).zip(self.rows()).find_map(|(y, row)| Some((y, row.find(text)?)))?;
        let column = self.row(row)[..at].chars().count();
        match self.screen.cell(row, u16::try_from(column).ok()?)?.fgcolor() {
            vt100::Color::Rgb(r, g, b) => Some([r, g, b]),
            _ => None,
        }
    }

    /// The lowest row.
    pub fn footer(&self) -> String {
        self.row(self.size().1 - 1)
    }

    /// The rows between some columns.
    pub fn columns(&self, from: u16, to: u16) -> Vec<String> {
        self.screen.rows(from, to - from).collect()
    }

    /// The row of the form that the cursor is on.
    pub fn form_cursor(&self) -> Option<u16> {
        form_cursor(&self.screen)
    }

    /// Cells between some columns and rows that are not blank: how much of a picture is there.
    pub fn painted(&self, columns: std::ops::Range<u16>, rows: std::ops::Range<u16>) -> usize {
        let is_painted = |column: u16, row: u16| {
            self.screen.cell(row, column).is_some_and(|cell| !cell.contents().trim().is_empty())
        };
        rows.map(|row| columns.clone().filter(|column| is_painted(*column, row)).count()).sum()
    }

    pub fn is_alternate(&self) -> bool {
        self.screen.alternate_screen()
    }

    pub fn hides_cursor(&self) -> bool {
        self.screen.hide_cursor()
    }

    pub fn pastes_in_brackets(&self) -> bool {
        self.screen.bracketed_paste()
    }

    pub fn hears_mouse(&self) -> bool {
        self.screen.mouse_protocol_mode() != vt100::MouseProtocolMode::None
    }
}

/// The row of the form that the cursor is on: the one with another background.
pub fn form_cursor(screen: &Screen) -> Option<u16> {
    cursor_at(screen, screen.size().1.get() - 10)
}

/// The id of the preset that the cursor of the list is on, as far as it has been written.
pub fn list_cursor(screen: &Screen) -> Option<String> {
    let row = cursor_at(screen, 4)?;
    Some(screen.rows(3, 12).nth(row.into())?.trim().to_owned())
}

/// The row that is lit in a column.
fn cursor_at(screen: &Screen, column: u16) -> Option<u16> {
    let rows = screen.size().0;
    let background = |row| screen.cell(row, column).map(vt100::Cell::bgcolor);
    (2..rows.get().saturating_sub(8)).find(|row| background(*row) != background(0))
}
