//! The gallery as a dialog: the mouse, and how it is painted.

use crossterm::event::MouseEvent;
use linden::knob::Value;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, BorderType, Paragraph, Widget, Wrap};
use unicode_width::UnicodeWidthStr;

use super::grid::Grid;
use super::sweep::SEED;
use super::{CONTEXT, Gallery, GalleryPage, label};
use crate::jobs::{SmallPicture, Thumbnail};
use crate::tui::chrome::footer::key_label;
use crate::tui::chrome::popup::popup;
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::figures::{metres, thousands};
use crate::tui::layout::{Target, View};
use crate::tui::model::Model;
use crate::wrap::clipped;

/// The commands that choose a picture, from the first on.
const PICKS: [&str; 9] = [
    "gallery-first",
    "gallery-second",
    "gallery-third",
    "gallery-fourth",
    "gallery-fifth",
    "gallery-sixth",
    "gallery-seventh",
    "gallery-eighth",
    "gallery-ninth",
];

impl Dialog<Model> for Gallery {
    fn context(&self) -> Context {
        CONTEXT
    }

    fn paint(&self, model: &Model, body: Rect, buffer: &mut Buffer, view: &mut View) {
        paint(model, self, body, buffer, view);
    }

    /// The first click chooses a picture, the second takes it.
    fn click(&mut self, model: &mut Model, cell: usize, _mouse: MouseEvent, _effects: &mut Effects) -> After {
        if self.page(model).is_ok_and(|page| page.chosen == cell) {
            return self.take(model);
        }
        self.choose(model, cell);
        After::Stays
    }

    /// The wheel turns pages.
    fn wheel(&mut self, model: &mut Model, cell: Option<usize>, down: bool) {
        if cell.is_some() {
            self.turn_page(model, down);
        }
    }
}

/// Paints the gallery over everything but the footer.
fn paint(model: &Model, gallery: &Gallery, area: Rect, buffer: &mut Buffer, view: &mut View) {
    // The picture beneath is covered, and the footer's hints are the gallery's.
    view.order = linden_terminal::Order::default();
    let hints: Vec<_> =
        view.regions.iter().filter(|(_, target)| matches!(target, Target::Command(_))).copied().collect();
    match gallery.page(model) {
        Ok(page) => {
            let title = clipped(&title(model, gallery, &page), usize::from(area.width).saturating_sub(4));
            popup(model, &title, area, buffer, view);
            let mut is_next = true;
            for index in 0..page.grid.len() {
                let thumbnail = gallery.picture(model, &page.values[index]);
                cell(model, &page, index, thumbnail, is_next, buffer, view);
                is_next &= thumbnail.is_some();
            }
        }
        Err(why) => {
            let inner = popup(model, "Gallery", area, buffer, view);
            Paragraph::new(linden::knob::printable(&why)).wrap(Wrap { trim: true }).render(inner, buffer);
        }
    }
    view.regions.extend(hints);
}

/// What varies, from where to where, and how far it is.
fn title(model: &Model, gallery: &Gallery, page: &GalleryPage) -> String {
    let what = match page.values.as_slice() {
        [from, .., to] if page.knob.name == SEED => format!("Seeds {from} to {to}"),
        [from, .., to] if matches!(from, Value::Real(_) | Value::Steps(_) | Value::Integer(_)) => {
            format!("Sweep: {} to {to}", label(&page.knob, from))
        }
        _ if page.knob.name == SEED => "Seeds".to_owned(),
        _ => format!("Sweep: {}", page.knob.name),
    };
    let scale = if gallery.one_scale { "" } else { " · each in its own scale" };
    let (there, all) = gallery.progress(model, page);
    let progress = if there < all { format!(" · {there} of {all}") } else { String::new() };
    format!("{what}{scale}{progress}")
}

/// One picture with its frame and words.
fn cell(
    model: &Model,
    page: &GalleryPage,
    index: usize,
    thumbnail: Option<&Thumbnail>,
    is_next: bool,
    buffer: &mut Buffer,
    view: &mut View,
) {
    let theme = &model.config.theme;
    let area = page.grid.cell(index);
    view.regions.push((area, Target::Dialog(Some(index))));
    let parts = Grid::parts(area);
    let value = &page.values[index];
    let is_chosen = index == page.chosen;
    let now = if *value == page.current { " · now" } else { "" };
    let name = format!("{}{now}", label(&page.knob, value));
    let facts = match thumbnail.map(|thumbnail| &thumbnail.result) {
        Some(Ok(picture)) => facts(picture),
        Some(Err(_)) | None => vec![String::new()],
    };
    let style = if is_chosen { theme.popup_title } else { theme.popup };
    if parts.framed {
        let room = usize::from(area.width).saturating_sub(4);
        let pick = PICKS.get(index).and_then(|id| model.config.keymap.keys_of(id).first());
        let pick = pick.map(|key| format!(" {}", key_label(&key.to_string()))).unwrap_or_default();
        let name = clipped(&name, room.saturating_sub(pick.width()));
        let top = Line::from(vec![Span::styled(pick, theme.key), Span::styled(format!(" {name} "), style)]);
        // What is chosen must be seen without colours too.
        let (kind, lines) = if is_chosen {
            (BorderType::Thick, theme.popup_border)
        } else {
            (BorderType::Rounded, theme.border)
        };
        let mut block = Block::bordered().border_type(kind).border_style(lines).title(top);
        let facts = fitting(facts, room);
        if !facts.is_empty() {
            let line = Line::styled(format!(" {facts} "), theme.popup_dim).right_aligned();
            block = block.title_bottom(line);
        }
        block.render(area, buffer);
    } else {
        let all: Vec<String> =
            facts.iter().map(|facts| format!("{name} · {facts}")).chain([name.clone()]).collect();
        let width = usize::from(parts.words.width);
        let text = if thumbnail.is_some() { fitting(all, width) } else { clipped(&name, width) };
        if !parts.words.is_empty() {
            buffer.set_stringn(parts.words.x, parts.words.y, text, width, style);
        }
    }
    match thumbnail.map(|thumbnail| &thumbnail.result) {
        Some(Ok(picture)) => {
            view.order.late.push(parts.picture);
            picture.cells.put(buffer, parts.picture);
        }
        Some(Err(why)) => {
            let why = linden::knob::printable(why);
            Paragraph::new(why).style(theme.error).wrap(Wrap { trim: true }).render(parts.picture, buffer);
        }
        None if is_next => middle("growing …", parts.picture, theme.busy, buffer),
        None => middle("…", parts.picture, theme.popup_dim, buffer),
    }
}

/// What is said of a tree: as much as may be, and less where there is less room.
fn facts(picture: &SmallPicture) -> Vec<String> {
    let (nodes, height) = (thousands(picture.nodes as u64), metres(picture.height_m));
    vec![format!("{nodes} nodes · {height} m"), format!("{nodes} · {height} m"), format!("{height} m")]
}

/// The first text that fits, or the last one cut.
fn fitting(texts: Vec<String>, width: usize) -> String {
    let last = texts.last().map(|text| clipped(text, width)).unwrap_or_default();
    texts.into_iter().find(|text| text.width() <= width).unwrap_or(last)
}

fn middle(text: &str, area: Rect, style: Style, buffer: &mut Buffer) {
    if area.is_empty() {
        return;
    }
    let text = clipped(text, area.width.into());
    let x = area.x + (area.width - text.width() as u16) / 2;
    buffer.set_stringn(x, area.y + area.height / 2, text, area.width.into(), style);
}
