//! The picture's pane, painted.

use glam::Vec2;
use linden::grow::Obstructs;
use linden_raster::Handle;
use linden_raster::color::{encoded, ramp};
use linden_terminal::{ColorDepth, Glyphs};
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::{Color, Modifier};
use ratatui::text::Span;
use unicode_width::UnicodeWidthStr;

use super::{beside, is_grey, seen, split, standing};
use crate::figures::thousands;
use crate::jobs::{HowFar, Painted};
use crate::tui::layout::{Pane, Target, View};
use crate::tui::model::Model;
use crate::tui::screen::NOT_GROWN;
use crate::wrap::{clipped, wrapped_within};

/// What the pane's heading says beside its name.
pub fn heading(model: &Model) -> Vec<Span<'static>> {
    let theme = &model.config.theme;
    let picture = &model.picture;
    let fault = model.tree.as_ref().map(|tree| (tree.shown.is_some(), tree.fault.is_some()));
    let fault =
        fault.or(model.forest.as_ref().map(|forest| (forest.shown.is_some(), forest.fault.is_some())));
    if fault == Some((true, true)) {
        // The picture is that of before.
        return vec![Span::styled(format!("{NOT_GROWN} "), theme.error)];
    }
    let mut words = Vec::new();
    if picture.is_look_chosen {
        words.push(picture.look.name());
    }
    let level = picture.painted.as_ref().and_then(|painted| painted.level);
    if let Some((level, triangles)) = level.filter(|(level, _)| picture.level == Some(*level)) {
        let text = format!("· level {level}: {} triangles ", thousands(triangles));
        return vec![Span::styled(text, theme.dim)];
    }
    let cut = picture.painted.as_ref().and_then(|painted| painted.cut.as_ref());
    if let Some(cut) = cut.filter(|_| picture.slice_m.is_some()) {
        return vec![Span::styled(format!("· {cut} "), theme.dim)];
    }
    let has = |effect| picture.obstructions && beside(model).iter().any(|one| one.effect == effect);
    for (on, word) in [
        (picture.points, "points"),
        (picture.outline, "crown"),
        (has(Obstructs::Branches), "obstacle"),
        (has(Obstructs::Light), "shade"),
        (picture.is_turning(), "turning"),
        (model.wind.is_blowing(), "wind"),
    ] {
        if on {
            words.push(word);
        }
    }
    if words.is_empty() {
        Vec::new()
    } else {
        vec![Span::styled(format!("· {} ", words.join(" · ")), theme.dim)]
    }
}

/// What a dialog says that is about the picture: in the place of its heading, or on the picture's last row. The mouse
/// means the dialog all over the picture.
pub fn banner(model: &Model, words: &str, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let layout = model.layout();
    if let Some(area) = super::area(model) {
        view.regions.push((area, Target::Dialog(Some(0))));
    }
    let heading = layout.headings[Pane::Picture as usize];
    let below = layout.pane(Pane::Picture).unwrap_or(layout.title);
    let row = if heading.is_empty() {
        Rect { y: below.bottom().saturating_sub(1), height: 1.min(below.height), ..below }
    } else {
        heading
    };
    if row.is_empty() {
        return;
    }
    let text = clipped(&format!(" {words} "), row.width.into());
    buffer.set_style(row, theme.popup);
    buffer.set_stringn(row.x, row.y, &text, row.width.into(), theme.selected);
    let rest = " ".repeat(usize::from(row.width).saturating_sub(text.width()));
    buffer.set_string(row.x + text.width() as u16, row.y, rest, theme.popup);
    view.order.first.push(row);
}

/// Paints the picture, or why there is none.
pub fn view(model: &Model, inner: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let (area, scale) = split(inner);
    if let Some(painted) = standing(model) {
        view.order.late.push(area);
        painted.put(area, buffer);
        if is_grey(model) {
            grey(area, buffer);
        }
        handles(model, painted, area, buffer);
        // Where panes have no headings, the bar to scrub takes the row.
        let is_taken =
            model.growth.step().is_some() && model.layout().headings[Pane::Picture as usize].is_empty();
        let has_room = !scale.is_empty() && !is_taken;
        if model.picture.is_of_before {
            // Of a scale that is another tree's nothing could be read.
            if has_room {
                buffer.set_stringn(scale.x, scale.y, "drawing …", scale.width.into(), theme.busy);
            }
        } else if model.picture.scale && model.config.settings.scale_bar && has_room {
            scale_bar(model, painted, scale, buffer);
        }
        if let Some(ends) = &painted.legend
            && painted.request.medium.colors != ColorDepth::None
        {
            legend(model, ends, scale, buffer);
        }
    }
    let say = |buffer: &mut Buffer, y: u16, text: &str, style| {
        let text = clipped(text, area.width.into());
        let x = area.x + (area.width - text.width() as u16) / 2;
        buffer.set_stringn(x, y, text, area.width.into(), style);
    };
    let on_screen = (
        model.tree.as_ref().map(|tree| (tree.shown.is_some(), &tree.fault, &tree.growing)),
        model.forest.as_ref().map(|forest| (forest.shown.is_some(), &forest.fault, &forest.growing)),
    );
    let Some((has_grown, fault, growing)) = on_screen.0.or(on_screen.1) else {
        let fault = model.library.entry().and_then(|entry| entry.fault.as_deref());
        match fault.filter(|_| model.loading.is_none()) {
            _ if area.is_empty() => {}
            Some(fault) => {
                let lines = wrapped_within(fault, area.width.into(), area.height.into());
                let top = area.y + (area.height - lines.len() as u16) / 2;
                for (line, y) in lines.iter().zip(top..) {
                    say(buffer, y, line, theme.error);
                }
            }
            None => {
                let text = if model.loading.is_some() { "reading …" } else { "choose a preset" };
                say(buffer, area.y + area.height / 2, text, theme.dim);
            }
        }
        return;
    };
    if area.is_empty() {
        return;
    }
    if let Some(fault) = fault.as_ref().filter(|_| !has_grown) {
        let lines = wrapped_within(fault, area.width.into(), area.height.into());
        let top = area.y + (area.height - lines.len() as u16) / 2;
        for (line, y) in lines.iter().zip(top..) {
            say(buffer, y, line, theme.error);
        }
    } else if let Some(growing) = growing {
        say(buffer, area.y, &words(growing), theme.busy);
    } else if standing(model).is_none() && (!has_grown || !model.picture.has_failed) {
        let text = if has_grown { "drawing …" } else { "growing …" };
        say(buffer, area.y + area.height / 2, text, theme.dim);
    }
}

/// Takes most of the contrast from cells: what they show is of before.
fn grey(area: Rect, buffer: &mut Buffer) {
    let paler = |color: Color| match color {
        Color::Rgb(r, g, b) => {
            let [r, g, b] = [r, g, b].map(|c| ((u16::from(c) + 2 * 0x60) / 3) as u8);
            Color::Rgb(r, g, b)
        }
        other => other,
    };
    for place in area.intersection(buffer.area).positions() {
        let cell = &mut buffer[place];
        (cell.fg, cell.bg) = (paler(cell.fg), paler(cell.bg));
        cell.modifier |= Modifier::DIM;
    }
}

/// What can be taken hold of in a picture of characters: a letter each, which a few coarse pixels cannot be told from
/// the lines around them.
fn handles(model: &Model, painted: &Painted, area: Rect, buffer: &mut Buffer) {
    let request = &painted.request;
    let (Some(marks), None) = (&request.marks, request.medium.graphics) else { return };
    let Some(view) = seen(request) else { return };
    let signs = if request.medium.glyphs == Glyphs::Ascii { ["o", "@"] } else { ["○", "●"] };
    let (wide, high) = request.medium.cell_px;
    // The one that is picked lies over the others.
    let mut all: Vec<&Handle> = marks.handles.iter().collect();
    all.sort_by_key(|handle| handle.is_picked);
    for handle in all {
        let at = view.project(handle.at).at / Vec2::new(f32::from(wide), f32::from(high));
        let place =
            Position::new(request.area.x + at.x.max(0.0) as u16, request.area.y + at.y.max(0.0) as u16);
        if at.cmplt(Vec2::ZERO).any() || !area.contains(place) {
            continue;
        }
        // Before no colour of the picture, in which it would be lost.
        let style = model.config.theme.accent.bg(Color::Reset).add_modifier(Modifier::BOLD);
        let style = if handle.is_picked { style.add_modifier(Modifier::REVERSED) } else { style };
        buffer[(place.x, place.y)].set_symbol(signs[usize::from(handle.is_picked)]).set_style(style);
    }
}

/// How far the growing is, in words.
fn words(growing: &HowFar) -> String {
    let (doing, unit) = growing.stage.words();
    let done = match growing.total {
        Some(total) => format!("{doing} {} of {} {unit}", thousands(growing.done), thousands(total)),
        None => format!("{doing} {} {unit}", thousands(growing.done)),
    };
    match growing.among {
        Some((what, number, count)) => format!("{what} {number} of {count}: {done}"),
        None => done,
    }
}

/// Cells of the legend's bar of colours.
const LEGEND: u16 = 12;

/// `order 0 ████████ 5`, on the right: what the colours mean.
fn legend(model: &Model, [low, high]: &[String; 2], area: Rect, buffer: &mut Buffer) {
    let style = model.config.theme.scale_bar;
    let (before, after) = (format!(" {low} "), format!(" {high}"));
    let words = (before.width() + after.width()) as u16;
    // The scale bar has a third of the row, and its label.
    let room = area.width.saturating_sub(area.width / 3 + 8);
    if area.is_empty() || room < words + LEGEND / 2 {
        return;
    }
    let bar = LEGEND.min(room - words);
    let from = area.right() - words - bar;
    let (x, _) = buffer.set_stringn(from, area.y, &before, usize::from(before.width() as u16), style);
    for i in 0..bar {
        let light = ramp((f32::from(i) + 0.5) / f32::from(bar));
        let [r, g, b] = (encoded(light) * 255.0).round().to_array().map(|c| c as u8);
        buffer[(x + i, area.y)].set_char('█').set_fg(Color::Rgb(r, g, b));
    }
    buffer.set_stringn(x + bar, area.y, &after, after.width(), style);
}

/// `├────┤ 2 m`, as long as two metres are at the tree's axis.
fn scale_bar(model: &Model, painted: &Painted, area: Rect, buffer: &mut Buffer) {
    let theme = &model.config.theme;
    let most = f32::from(area.width) / 3.0;
    let Some((length_m, columns)) = painted.scale_bar(most) else { return };
    let columns = (columns.round() as usize).max(2);
    let label = if length_m >= 1.0 {
        format!("{length_m} m")
    } else if length_m >= 0.01 {
        format!("{} cm", (length_m * 100.0).round())
    } else {
        format!("{} mm", (length_m * 1000.0).round())
    };
    let bar = format!("├{}┤ {label}", "─".repeat(columns - 2));
    buffer.set_stringn(area.x, area.y, &bar, area.width.into(), theme.scale_bar);
    if painted.shows_person && painted.legend.is_none() {
        let text = "person 1.75 m";
        let width = text.width() as u16;
        if usize::from(area.width) > bar.width() + text.width() + 2 {
            buffer.set_stringn(area.right() - width, area.y, text, width.into(), theme.person);
        }
    }
}
