//! Where the panes are, and what the mouse can mean on the screen.

use ratatui::layout::Rect;

use super::command::Context;

/// Three panes from here.
const THREE: u16 = 110;
/// Two panes from here; below, one, with tabs.
const TWO: u16 = 72;

/// One of the three panes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pane {
    /// The list.
    Presets,
    /// The tree.
    Picture,
    /// The knobs.
    Shape,
}

impl Pane {
    /// From left to right.
    pub const ALL: [Self; 3] = [Self::Presets, Self::Picture, Self::Shape];

    /// What its border says.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Presets => "Presets",
            Self::Picture => "Picture",
            Self::Shape => "Shape",
        }
    }

    /// Where its keys are.
    pub const fn context(self) -> Context {
        match self {
            Self::Presets => Context::PRESETS,
            Self::Picture => Context::PICTURE,
            Self::Shape => Context::SHAPE,
        }
    }
}

/// Something on the screen that the mouse can mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A pane as a whole.
    Pane(Pane),
    /// A row of the list of presets, by its place in what is listed.
    Preset(usize),
    /// A row of the form.
    Knob(usize),
    /// A step of growth, in the bar to scrub.
    Growth(u32),
    /// A command, by its id: a hint of the footer.
    Command(&'static str),
    /// The topmost dialog: a spot in it, by the number that it painted there, or as a whole. What lies
    /// below it is not meant.
    Dialog(Option<usize>),
}

/// Where everything is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// The uppermost row: what is on screen.
    pub title: Rect,
    /// The row of tabs, where there is room for one pane only.
    pub tabs: Rect,
    /// Each pane with its border; empty for those that are not shown.
    pub panes: [Rect; 3],
    /// The lowest row: hints or a message.
    pub footer: Rect,
}

/// What the terminal needs to know besides the cells.
#[derive(Debug, Default)]
pub struct View {
    /// Where the cursor blinks.
    pub cursor: Option<(u16, u16)>,
    /// What lies where; the topmost last.
    pub regions: Vec<(Rect, Target)>,
    /// Cells that may come later than all others: pictures.
    pub late: Vec<Rect>,
}

impl Layout {
    /// The panes for a size. `focus` has keys; `side` is the last focused pane but the picture.
    pub fn new(columns: u16, rows: u16, focus: Pane, side: Pane) -> Self {
        let mut layout = Self::default();
        let mut body = Rect::new(0, 0, columns, rows);
        if body.is_empty() {
            return layout;
        }
        if rows >= 4 {
            layout.title = Rect { height: 1, ..body };
            body.y += 1;
            body.height -= 1;
        }
        if rows >= 3 {
            body.height -= 1;
            layout.footer = Rect::new(0, body.bottom(), columns, 1);
        }
        let [presets, middle, shape] = &mut layout.panes;
        if columns >= THREE {
            let (left, right) = if columns >= 150 { (34, 46) } else { (30, 38) };
            *presets = Rect { width: left, ..body };
            *shape = Rect { x: columns - right, width: right, ..body };
            *middle = Rect { x: left, width: columns - left - right, ..body };
        } else if columns >= TWO {
            let left = if side == Pane::Shape { 36 } else { 30 };
            *(if side == Pane::Shape { shape } else { presets }) = Rect { width: left, ..body };
            *middle = Rect { x: left, width: columns - left, ..body };
        } else {
            if body.height >= 4 {
                layout.tabs = Rect { height: 1, ..body };
                body.y += 1;
                body.height -= 1;
            }
            layout.panes[focus as usize] = body;
        }
        layout
    }

    /// Where a pane is, `None` when it is not shown.
    pub fn pane(&self, pane: Pane) -> Option<Rect> {
        Some(self.panes[pane as usize]).filter(|area| !area.is_empty())
    }
}

/// The inside of a pane's border. Panes too small for a border have none.
pub fn inside(area: Rect) -> Rect {
    if area.width < 4 || area.height < 3 {
        return area;
    }
    Rect { x: area.x + 1, y: area.y + 1, width: area.width - 2, height: area.height - 2 }
}

/// A rectangle in the middle of another.
pub fn centered(width: u16, height: u16, within: Rect) -> Rect {
    let (width, height) = (width.min(within.width), height.min(within.height));
    Rect {
        x: within.x + (within.width - width) / 2,
        y: within.y + (within.height - height) / 2,
        width,
        height,
    }
}

/// The first row of a list that is shown so that the cursor is in sight, with some rows around it.
pub fn first_row(cursor: usize, rows: usize, height: usize) -> usize {
    let most = rows.saturating_sub(height);
    cursor.saturating_sub(height / 2).min(most)
}
