//! The whole screen, painted into a buffer.

use std::sync::Arc;

use linden::forest::Places;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::Widget;
use unicode_width::UnicodeWidthStr;

use super::chrome::footer;
use super::dialog::Dialog;
use super::forest::ForestOnScreen;
use super::layout::{Layout, Pane, Target, View};
use super::model::Model;
use super::{export, growth, library, picture, shape};
use crate::figures::{metres, thousands};
use crate::wrap::clipped;

/// What is said where the picture is of a tree before the last change, which did not grow.
pub const NOT_GROWN: &str = "✗ did not grow";

/// Rows above the footer from which a message may take one of them.
const LEAST_ABOVE: u16 = 8;

/// Paints everything.
pub fn view(model: &Model, buffer: &mut Buffer) -> View {
    let mut view = View::default();
    let layout = model.layout();
    buffer.set_style(buffer.area, model.config.theme.text);
    title(model, layout.title, buffer);
    tabs(model, layout.tabs, buffer, &mut view);
    frame(model, &layout, buffer);
    for pane in Pane::ALL {
        let (Some(area), Some(text)) = (layout.pane(pane), layout.text(pane)) else { continue };
        view.regions.extend([layout.headings[pane as usize], area].map(|part| (part, Target::Pane(pane))));
        heading(model, pane, &layout, buffer, &mut view);
        match pane {
            Pane::Presets => library::view::view(model, text, buffer, &mut view),
            Pane::Picture => picture::view::view(model, text, buffer, &mut view),
            Pane::Shape => shape::view::view(model, text, buffer, &mut view),
        }
    }
    let (screen, body) = (Rect::new(0, 0, model.size.0, model.size.1), model.dialog_body());
    let status = Line::from(export::status(model, layout.footer.width / 2));
    if model.dialogs.last().is_some_and(Dialog::is_prompt) {
        // A line that no pane shows is typed over the footer.
        footer::view(model, status, [Rect::default(), layout.footer], buffer, &mut view);
        dialogs(model, screen, body, buffer, &mut view);
    } else {
        dialogs(model, screen, body, buffer, &mut view);
        // A message may take the row above: that of a picture's scale.
        let height = u16::from(layout.footer.y >= LEAST_ABOVE);
        let above = Rect { y: layout.footer.y - height, height, ..layout.footer };
        footer::view(model, status, [above, layout.footer], buffer, &mut view);
    }
    view
}

/// The open dialogs, the topmost last.
fn dialogs(model: &Model, screen: Rect, body: Rect, buffer: &mut Buffer, view: &mut View) {
    for dialog in model.dialogs.iter() {
        dialog.paint(model, if dialog.is_prompt() { screen } else { body }, buffer, view);
    }
}

/// Draws the rules: one above the panes, one between two of them.
fn frame(model: &Model, layout: &Layout, buffer: &mut Buffer) {
    let style = model.config.theme.border;
    for heading in layout.headings {
        for x in heading.left()..heading.right() {
            buffer.set_string(x, heading.y, "─", style);
        }
    }
    let is_headed = layout.headings.iter().any(|heading| !heading.is_empty());
    for rule in layout.rules {
        for place in rule.positions() {
            let symbol = match (rule.width, is_headed && place.y == rule.y) {
                (1, true) => "┬",
                (1, false) => "│",
                _ => "─",
            };
            buffer.set_string(place.x, place.y, symbol, style);
        }
    }
}

/// Draws a pane's name and what is to be said of it into the rule above it.
fn heading(model: &Model, pane: Pane, layout: &Layout, buffer: &mut Buffer, view: &mut View) {
    let area = layout.headings[pane as usize];
    if pane == Pane::Picture && area.is_empty() {
        // Without a heading the bar to scrub lies on the picture's last row.
        let picture = layout.panes[pane as usize];
        let row = Rect { y: picture.bottom().saturating_sub(1), height: 1.min(picture.height), ..picture };
        return growth::bar::view(model, row, buffer, view);
    }
    if area.width < 4 || area.is_empty() {
        return;
    }
    let theme = &model.config.theme;
    let focused = model.focus == pane && model.dialogs.is_empty();
    let name = if focused { theme.title_focused } else { theme.title };
    if focused {
        buffer.set_style(area, theme.border_focused);
    }
    let mut words = vec![Span::styled(format!(" {} ", pane.title()), name)];
    words.extend(match pane {
        Pane::Presets => library::view::heading(model),
        Pane::Picture => picture::view::heading(model),
        Pane::Shape => shape::view::heading(model),
    });
    let room = Rect { x: area.x + 1, width: area.width - 2, ..area };
    let words = Line::from(words);
    let width = (words.width() as u16).min(room.width);
    words.render(Rect { width, ..room }, buffer);
    if pane == Pane::Picture {
        growth::bar::view(model, Rect { x: room.x + width, width: room.width - width, ..room }, buffer, view);
    }
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
    let mut row = TitleRow { x: area.x + 1, end: area.right() - right, y: area.y, buffer };
    row.put("linden", theme.title_focused, 2);
    if let Some(forest) = &model.forest {
        return forest_title(model, forest, area.width, &mut row);
    }
    let Some(tree) = &model.tree else { return };
    let preset = &tree.wanted().preset;
    let name = if preset.name.is_empty() { &preset.id } else { &preset.name };
    // A name of any length leaves room for what follows.
    row.put(&clipped(name, usize::from(area.width / 3).max(12)), theme.accent, 2);
    if tree.fault.is_some() {
        row.put(NOT_GROWN, theme.error, 2);
    }
    if tree.compares {
        row.put("as saved", theme.warning, 2);
    } else if tree.is_modified() {
        row.put("● modified", theme.modified, 2);
    }
    let mut figures = vec![format!("seed {}", preset.seed())];
    // What grew from other knobs says nothing of these.
    if let Some(shown) = tree.shown.as_ref().filter(|shown| Arc::ptr_eq(&shown.recipe, tree.wanted())) {
        let m = &shown.measures;
        // What is on screen while growth is played has not been measured.
        let of_which = if model.growth.step().is_some() { "grown: " } else { "" };
        figures.push(format!("{of_which}{} nodes", thousands(shown.grown.skeleton.positions.len() as u64)));
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

/// The same of a forest.
fn forest_title(model: &Model, forest: &ForestOnScreen, width: u16, row: &mut TitleRow<'_>) {
    let theme = &model.config.theme;
    row.put(&clipped(&forest.wanted().name, usize::from(width / 3).max(12)), theme.accent, 2);
    if forest.fault.is_some() {
        row.put(NOT_GROWN, theme.error, 2);
    }
    if forest.is_modified() {
        row.put("● modified", theme.modified, 2);
    }
    let layout = &forest.wanted().layout;
    let mut figures = vec![format!("seed {}", layout.seed)];
    if let Some(shown) = forest.shown.as_ref().filter(|shown| Arc::ptr_eq(&shown.forest, forest.wanted())) {
        figures.push(format!("{} trees", thousands(shown.trees)));
        let grown = shown.grown.trees.len() as u64;
        if grown < shown.trees {
            figures.push(format!("{} of them grown", thousands(grown)));
        }
        if layout.places == Places::Scattered {
            figures.push(format!("{} m × {} m", layout.area_m, layout.area_m));
        }
    }
    for (i, figure) in figures.iter().enumerate() {
        let text = if i == 0 { figure.clone() } else { format!("· {figure}") };
        if !row.put(&text, theme.dim, 1) {
            break;
        }
    }
}

/// A row that is filled from the left.
struct TitleRow<'b> {
    x: u16,
    end: u16,
    y: u16,
    buffer: &'b mut Buffer,
}

impl TitleRow<'_> {
    /// Puts a text and `air` empty cells behind it, if it has room; whether it had.
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
