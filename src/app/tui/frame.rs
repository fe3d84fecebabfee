//! Where the panes are, and the whole screen painted into a buffer.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, BorderType, Widget};
use unicode_width::UnicodeWidthStr;

use super::model::{Layer, Model, Pane, Target};
use super::{around, export, growth, library, picture, shape, vary};

/// Three panes from here.
const THREE: u16 = 110;
/// Two panes from here; below, one, with tabs.
const TWO: u16 = 72;

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

/// What the terminal needs to know beside the cells.
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

    /// The layout of a model.
    pub fn of(model: &Model) -> Self {
        Self::new(model.size.0, model.size.1, model.focus, model.side)
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

/// The cells of the picture itself, `None` when it is not on screen.
pub fn picture_area(model: &Model) -> Option<Rect> {
    let inner = inside(Layout::of(model).pane(Pane::Picture)?);
    let (picture, _) = picture::view::split(inner);
    Some(picture).filter(|area| !area.is_empty())
}

/// Paints everything.
pub fn view(model: &Model, buffer: &mut Buffer) -> View {
    let mut view = View::default();
    let layout = Layout::of(model);
    buffer.set_style(buffer.area, model.config.theme.text);
    title(model, layout.title, buffer);
    tabs(model, layout.tabs, buffer, &mut view);
    for pane in Pane::ALL {
        let Some(area) = layout.pane(pane) else { continue };
        view.regions.push((area, Target::Pane(pane)));
        let inner = border(model, pane, area, buffer, &mut view);
        match pane {
            Pane::Presets => library::view::view(model, inner, buffer, &mut view),
            Pane::Picture => picture::view::view(model, inner, buffer, &mut view),
            Pane::Shape => shape::view::view(model, inner, buffer, &mut view),
        }
    }
    let (screen, body) = (Rect::new(0, 0, model.size.0, model.size.1), dialog_body(model));
    let is_line = matches!(model.layers.last(), Some(Layer::Line(_)));
    if is_line {
        // A line without a place of its own is typed in the footer.
        around::footer::view(model, layout.footer, buffer, &mut view);
    }
    for layer in &model.layers {
        match layer {
            Layer::Page(page) => around::view::page(model, page, body, buffer, &mut view),
            Layer::Palette(palette) => around::view::palette(model, palette, body, buffer, &mut view),
            Layer::Line(line) => around::view::line(model, line, screen, buffer, &mut view),
            Layer::Gallery(gallery) => vary::view::view(model, gallery, body, buffer, &mut view),
            Layer::Export(dialog) => export::view::view(model, dialog, body, buffer, &mut view),
            Layer::Grammar(editor) => shape::editor::view(model, editor, body, buffer, &mut view),
        }
    }
    if !is_line {
        around::footer::view(model, layout.footer, buffer, &mut view);
    }
    view
}

/// Where dialogs may lie: above the footer, which has their hints.
pub fn dialog_body(model: &Model) -> Rect {
    let footer = Layout::of(model).footer.height;
    Rect::new(0, 0, model.size.0, model.size.1 - footer)
}

/// Draws a pane's border with its title; gives the inside.
fn border(model: &Model, pane: Pane, area: Rect, buffer: &mut Buffer, view: &mut View) -> Rect {
    let inner = inside(area);
    if inner == area {
        return inner;
    }
    let theme = &model.config.theme;
    let focused = model.focus == pane && model.layers.is_empty();
    let style = if focused { theme.border_focused } else { theme.border };
    let name = if focused { theme.title_focused } else { theme.title };
    let mut top = vec![Span::styled(format!(" {} ", pane.title()), name)];
    match pane {
        Pane::Presets => top.extend(library::view::heading(model)),
        Pane::Picture => top.extend(picture::view::heading(model)),
        Pane::Shape => top.extend(shape::view::heading(model)),
    }
    let block = Block::bordered().border_type(BorderType::Rounded).border_style(style).title(Line::from(top));
    block.render(area, buffer);
    if pane == Pane::Picture {
        let row = Rect { y: area.bottom() - 1, height: 1, ..inner };
        growth::view::bar(model, row, buffer, view);
    }
    inner
}

/// What is on screen, in one line: as many of the figures as have room.
fn title(model: &Model, area: Rect, buffer: &mut Buffer) {
    if area.is_empty() {
        return;
    }
    let theme = &model.config.theme;
    let stats = model.stats.as_deref().unwrap_or_default();
    let right = (stats.width() as u16).min(area.width);
    buffer.set_stringn(area.right() - right, area.y, stats, right.into(), theme.dim);
    let mut row = Row { x: area.x + 1, end: area.right() - right, y: area.y, buffer };
    row.put("linden", theme.title_focused, 2);
    let Some(tree) = &model.tree else { return };
    let preset = &tree.wanted().preset;
    let name = if preset.name.is_empty() { &preset.id } else { &preset.name };
    // A name of any length leaves room for what follows.
    row.put(&clipped(name, usize::from(area.width / 3).max(12)), theme.accent, 2);
    if tree.compares {
        row.put("as saved", theme.warning, 2);
    } else if tree.is_modified() {
        row.put("● modified", theme.modified, 2);
    }
    let mut figures = vec![format!("seed {}", preset.seed)];
    if let Some(shown) = &tree.shown {
        let m = &shown.measures;
        figures.push(format!("{} nodes", thousands(shown.grown.skeleton.positions.len() as u64)));
        figures.push(format!("{} m tall", metres(m.height_m)));
        figures.push(format!("crown {} m", metres(m.crown_width_m)));
        figures.push(format!("order {}", m.max_order));
    }
    for (i, figure) in figures.iter().enumerate() {
        let text = if i == 0 { figure.clone() } else { format!("· {figure}") };
        if !row.put(&text, theme.dim, 1) {
            break;
        }
    }
}

/// A row that is filled from the left.
struct Row<'b> {
    x: u16,
    end: u16,
    y: u16,
    buffer: &'b mut Buffer,
}

impl Row<'_> {
    /// Puts a text and so many cells of air behind it, if it has room; whether it had.
    fn put(&mut self, text: &str, style: Style, air: u16) -> bool {
        let width = text.width() as u16;
        if self.x + width > self.end {
            return false;
        }
        self.buffer.set_string(self.x, self.y, text, style);
        self.x += width + air;
        true
    }
}

/// The tabs of the three panes.
fn tabs(model: &Model, area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let mut x = area.x;
    for pane in Pane::ALL.into_iter().filter(|_| !area.is_empty()) {
        let text = format!(" {} ", pane.title());
        let width = (text.len() as u16).min(area.right().saturating_sub(x));
        if width == 0 {
            break;
        }
        let style = if model.focus == pane { theme.tab_active } else { theme.tab };
        buffer.set_stringn(x, area.y, &text, width.into(), style);
        view.regions.push((Rect::new(x, area.y, width, 1), Target::Pane(pane)));
        x += width + 1;
    }
}

/// Text from outside or of any length in so many cells: cut with an ellipsis.
pub fn clipped(text: &str, width: usize) -> String {
    let text = linden::knob::printable(text);
    if text.width() <= width {
        return text;
    }
    let mut kept = String::new();
    for c in text.chars() {
        if kept.width() + c.to_string().width() + 1 > width {
            break;
        }
        kept.push(c);
    }
    if width > 0 {
        kept.push('…');
    }
    kept
}

/// `12 345`.
pub fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            // A narrow no-break space would be typographically right; few terminal fonts have it.
            text.push(' ');
        }
        text.push(c);
    }
    text
}

/// Metres to three digits.
pub fn metres(m: f64) -> String {
    let digits = if m >= 100.0 {
        0
    } else if m >= 10.0 {
        1
    } else if m >= 1.0 {
        2
    } else {
        3
    };
    format!("{m:.digits$}")
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

/// A dialog's box with its title; gives the inside. What lies below it is not meant by the mouse.
pub fn dialog(model: &Model, title: &str, area: Rect, buffer: &mut Buffer, view: &mut View) -> Rect {
    let theme = &model.config.theme;
    view.regions.push((Rect::new(0, 0, model.size.0, model.size.1), Target::Dialog));
    ratatui::widgets::Clear.render(area, buffer);
    buffer.set_style(area, theme.popup);
    let inner = inside(area);
    if inner != area {
        Block::bordered()
            .border_type(BorderType::Rounded)
            .border_style(theme.popup_border)
            .title(Span::styled(format!(" {title} "), theme.popup_title))
            .render(area, buffer);
    }
    inner
}
