//! Where the panes are, and what the mouse can mean on the screen.

use linden_terminal::Order;
use ratatui::layout::Rect;

use super::command::Context;

/// Three panes from here.
const THREE: u16 = 110;
/// Two panes from here; below, one above the other, with tabs.
const TWO: u16 = 56;
/// Columns of the list of presets, whatever it holds.
const LIST: [u16; 2] = [20, 34];
/// Rows from which one pane stands above the other where they have no room side by side.
const STACKED: u16 = 8;

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

    /// The pane that follows after so many steps to the right, round the corner.
    pub const fn next(self, by: usize) -> Self {
        Self::ALL[(self as usize + by) % Self::ALL.len()]
    }

    /// What its heading says.
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
    /// The row of tabs, where panes have no room side by side.
    pub tabs: Rect,
    /// The row above each pane: a rule with the pane's name; empty where there is none.
    pub headings: [Rect; 3],
    /// Each pane; empty for those that are not shown.
    pub panes: [Rect; 3],
    /// The rules between panes.
    pub rules: [Rect; 2],
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
    /// What lies over panes without hiding all of them: where it is on a picture of pixels, that cannot be shown.
    pub covers: Vec<Rect>,
    /// Which cells come before the others, as the answer to a key, and which may come later: pictures.
    pub order: Order,
}

impl View {
    /// The rows of a list that show that the cursor has moved, and where it was: sent before all others.
    pub fn answers(&mut self, list: Rect, y: u16) {
        let top = y.saturating_sub(1).max(list.y);
        let bottom = (y + 2).min(list.bottom());
        self.order.first.push(Rect { y: top, height: bottom.saturating_sub(top), ..list });
    }
}

impl Layout {
    /// The panes for a size. `focus` has keys; `side` is the last focused pane but the picture; `list` is the
    /// columns that the list of presets would fill.
    pub fn new(columns: u16, rows: u16, focus: Pane, side: Pane, list: u16) -> Self {
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
        let list = list.clamp(LIST[0], LIST[1]);
        if columns >= THREE {
            let form = if columns >= 150 { 46 } else { 38 };
            let list = list.min(columns / 4);
            let picture = columns - list - form - 2;
            layout.beside(body, &[(Pane::Presets, list), (Pane::Picture, picture), (Pane::Shape, form)]);
        } else if columns >= TWO {
            let left = if side == Pane::Shape { (columns / 2).min(38) } else { list.min(columns / 3) };
            layout.beside(body, &[(side, left), (Pane::Picture, columns - left - 1)]);
        } else {
            layout.stack(body, focus);
        }
        layout
    }

    /// Panes from left to right with their columns, a rule between two of them, each below its heading.
    fn beside(&mut self, body: Rect, panes: &[(Pane, u16)]) {
        let heading = u16::from(body.height >= 4);
        let mut x = body.x;
        for (i, &(pane, width)) in panes.iter().enumerate() {
            if i > 0 {
                self.rules[i - 1] = Rect { x: x - 1, width: 1, ..body };
            }
            let column = Rect { x, width, ..body };
            self.headings[pane as usize] = Rect { height: heading, ..column };
            self.panes[pane as usize] =
                Rect { y: column.y + heading, height: column.height - heading, ..column };
            x += width + 1;
        }
    }

    /// One column: tabs, and the picture above the pane that has the keys. So a preset and a knob are seen
    /// at work on the narrowest screen.
    fn stack(&mut self, mut body: Rect, focus: Pane) {
        if body.height >= 4 {
            self.tabs = Rect { height: 1, ..body };
            body.y += 1;
            body.height -= 1;
        }
        let lower = match focus {
            _ if body.height < STACKED => body.height,
            Pane::Picture => 0,
            Pane::Presets => (body.height / 3).max(3),
            Pane::Shape => body.height / 2,
        };
        let mut upper = body.height - lower;
        if focus == Pane::Picture {
            self.panes[Pane::Picture as usize] = body;
            return;
        }
        self.panes[focus as usize] = Rect { y: body.y + upper, height: lower, ..body };
        // The rule takes its row from the picture, where that can spare it.
        if upper > STACKED {
            upper -= 1;
            self.rules[0] = Rect { y: body.y + upper, height: 1, ..body };
        }
        self.panes[Pane::Picture as usize] = Rect { height: upper, ..body };
    }

    /// Where a pane is, `None` when it is not shown.
    pub fn pane(&self, pane: Pane) -> Option<Rect> {
        Some(self.panes[pane as usize]).filter(|area| !area.is_empty())
    }

    /// Where a pane's text is: within a column of air on both sides. The picture fills its pane.
    pub fn text(&self, pane: Pane) -> Option<Rect> {
        let area = self.pane(pane)?;
        let air = u16::from(pane != Pane::Picture && area.width >= 12);
        Some(Rect { x: area.x + air, width: area.width - 2 * air, ..area })
    }
}

/// The inside of a dialog's border. Dialogs too small for a border have none.
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
