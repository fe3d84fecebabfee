//! The gallery as a dialog: the mouse, and how it is painted.

use std::sync::Arc;

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
use super::{CONTEXT, Gallery, GalleryPage};
use crate::figures::{metres, thousands};
use crate::jobs::{SmallPicture, Thumbnail, TreeSize};
use crate::tui::chrome::footer::key_label;
use crate::tui::chrome::popup::popup;
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
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
            format!("Sweep: {} to {to}", page.label(from))
        }
        _ if page.knob.name == SEED => "Seeds".to_owned(),
        _ => format!("Sweep: {}", page.called),
    };
    let scale = if gallery.one_scale { " · in one scale" } else { "" };
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
    let name = format!("{}{now}", page.label(value));
    let (sizes, amounts) = match thumbnail.map(|thumbnail| &thumbnail.result) {
        Some(Ok(picture)) => (sizes(picture.size, size_set(model, page)), amounts(picture)),
        Some(Err(_)) | None => Default::default(),
    };
    let style = if is_chosen { theme.popup_title } else { theme.popup };
    if parts.framed {
        let room = usize::from(area.width).saturating_sub(4);
        let pick = PICKS.get(index).and_then(|id| model.config.keymap.keys_of(id).first());
        let pick = pick.map(|key| format!(" {}", key_label(model, &key.to_string()))).unwrap_or_default();
        let name = clipped(&name, room.saturating_sub(pick.width()));
        let top = Line::from(vec![Span::styled(pick, theme.key), Span::styled(format!(" {name} "), style)]);
        // What is chosen must be seen without colours too.
        let (kind, lines) = if is_chosen {
            (BorderType::Thick, theme.popup_border)
        } else {
            (BorderType::Rounded, theme.border)
        };
        let mut block = Block::bordered().border_type(kind).border_style(lines).title(top);
        let below = fitting(if parts.words.is_empty() { sizes.clone() } else { amounts }, room);
        if !below.is_empty() {
            let line = Line::styled(format!(" {below} "), theme.popup_dim).right_aligned();
            block = block.title_bottom(line);
        }
        block.render(area, buffer);
        if !parts.words.is_empty() {
            let width = usize::from(parts.words.width).saturating_sub(2);
            buffer.set_stringn(parts.words.x + 1, parts.words.y, fitting(sizes, width), width, theme.popup);
        }
    } else {
        let all: Vec<String> =
            sizes.iter().map(|size| format!("{name} · {size}")).chain([name.clone()]).collect();
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

/// The size of the tree with what is set now, where that is known.
fn size_set(model: &Model, page: &GalleryPage) -> Option<TreeSize> {
    let tree = model.tree.as_ref()?;
    let shown = tree.shown.as_ref().filter(|shown| Arc::ptr_eq(&shown.recipe, tree.recipe()));
    let seen = || {
        let gallery = model.dialogs.find::<Gallery>()?;
        gallery.picture(model, &page.current)?.result.as_ref().ok().map(|picture| picture.size)
    };
    shown.map(|shown| TreeSize::of(&shown.measures, shown.grown.organs.len())).or_else(seen)
}

/// How much larger or smaller a tree is than the one that is set; its size where that is not known. As much as
/// may be, and less where there is less room.
fn sizes(size: TreeSize, set: Option<TreeSize>) -> Vec<String> {
    let absolute = || {
        let (height, width) = (metres(size.height_m), metres(size.width_m));
        vec![format!("{height} m tall · {width} m wide"), format!("{height} m tall"), format!("{height} m")]
    };
    let Some(set) = set.filter(|set| *set != size) else { return absolute() };
    let more_m = size.height_m - set.height_m;
    // Steps of a hundredth or so of the tree.
    let digits = match set.height_m {
        m if m >= 3.0 => 1,
        m if m >= 0.3 => 2,
        _ => 3,
    };
    let taller = match format!("{:.digits$}", more_m.abs()) {
        none if none.trim_start_matches(['0', '.']).is_empty() => "as tall".to_owned(),
        more => format!("{more} m {}", if more_m < 0.0 { "lower" } else { "taller" }),
    };
    let percent = ((size.width_m / set.width_m.max(1e-9) - 1.0) * 100.0).round();
    let wider = match percent {
        _ if !percent.is_finite() => return vec![taller],
        0.0 => "as wide".to_owned(),
        more if more > 0.0 => format!("{more} % wider"),
        less => format!("{} % narrower", -less),
    };
    vec![format!("{taller} · {wider}"), taller.clone(), format!("{} m", metres(size.height_m))]
}

/// What there is most of.
fn amounts(picture: &SmallPicture) -> Vec<String> {
    let nodes = format!("{} nodes", thousands(picture.nodes as u64));
    match picture.size.leaves {
        0 => vec![nodes],
        1 => vec!["1 organ".to_owned()],
        organs => vec![format!("{} organs", thousands(organs as u64))],
    }
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
