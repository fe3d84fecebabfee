//! The export dialog: keys, the mouse, how it is painted; and what the footer says of the export under way.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crossterm::event::{KeyEvent, MouseButton, MouseEvent, MouseEventKind};
use linden::knob::{Kind, Value};
use linden_exporters::Estimate;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Span;
use unicode_width::UnicodeWidthStr;

use super::current;
use super::dialog::{self, ExportDialog, ExportSpot, FormatChoice, StartState, Typing};
use super::knobs::ExportKnobs;
use crate::config::theme::Theme;
use crate::figures::{length, thousands};
use crate::jobs::{TargetFinding, WHOLE};
use crate::tui::chrome::popup::{popup, scrollbar};
use crate::tui::chrome::prompt;
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::forest::ForestOnScreen;
use crate::tui::growth;
use crate::tui::layout::{Target, View, centered, first_row};
use crate::tui::model::Model;
use crate::wrap::{clipped, wrapped, wrapped_within};

/// Columns of the dialog, where there is room.
const COLUMNS: u16 = 92;
/// Rows below the list: a line, and what is to be said of the row at the cursor. A question has as many as it takes, up
/// to half of all.
const ABOUT: u16 = 4;
/// The same where the list is longer than its room.
const LEAST_ABOUT: u16 = 3;
/// Rows of the dialog from which its heading may take two.
const WITH_HEADING: u16 = 14;
/// Columns from which a row says how large its file will be, and two rows say enough of it.
const WIDE: u16 = 60;
/// Columns of a format's id, the longest being `ply-skeleton`.
const ID: usize = 13;
/// Columns before what belongs to a format.
const INDENT: u16 = 4;
/// Columns of an option's name.
const NAME: usize = 10;
/// Columns of the name of a knob that is turned here.
const KNOB_NAME: u16 = 14;
/// Columns of the footer's bar.
const BAR: u64 = 10;
/// Columns of a name in the footer.
const SHORT: usize = 18;

/// What the list of seasons is for, and how it is typed.
const SEASONS: &str = "several seasons at once: in one file where the format holds them, else a file each";
const SEASONS_HOW: &str = "summer,autumn or spring=0.05,bare or all; empty: as it is on screen";
/// What the list of ages is for, and how it is typed.
const AGES: &str = "several ages at once, a file each; in USD also one over them, with the ages as variants";
const AGES_HOW: &str = "names that the plant has for them (all), shares of its growth like half=0.5, years like 10y; empty: as it is on screen";
/// What the switch is for.
const SCENE: &str = "with a camera that frames it, sun, sky and ground, in formats that hold them";

/// What the footer says of the export under way, in so many columns: where they are few, without the bar.
pub fn status(model: &Model, room: u16) -> Vec<Span<'static>> {
    let Some(running) = &model.exporting.running else { return Vec::new() };
    let theme = &model.config.theme;
    let full = (running.done * BAR / WHOLE) as usize;
    let doing = running.doing.map_or("exporting", |stage| stage.words().0);
    let percent = format!(" {} % ", running.done * 100 / WHOLE);
    let waiting = match model.exporting.waiting.len() {
        0 => String::new(),
        waiting => format!("+{waiting} "),
    };
    let words = doing.width() + 2 + percent.width() + waiting.width();
    let left = usize::from(room).saturating_sub(words);
    let name = clipped(&running.name, SHORT.min(left));
    let has_bar = left > name.width() + BAR as usize;
    let mut spans = vec![Span::styled(format!(" {doing} "), theme.busy), Span::styled(name, theme.text)];
    if has_bar {
        spans.extend([
            Span::raw(" "),
            Span::styled("█".repeat(full), theme.gauge),
            Span::styled("░".repeat(BAR as usize - full), theme.gauge_track),
        ]);
    }
    spans.extend([Span::styled(percent, theme.text), Span::styled(waiting, theme.dim)]);
    spans
}

impl Dialog<Model> for ExportDialog {
    fn context(&self) -> Context {
        if self.line.is_some() { dialog::LINE } else { dialog::CONTEXT }
    }

    fn paint(&self, model: &Model, _body: Rect, buffer: &mut Buffer, view: &mut View) {
        paint(model, self, model.popup_body(), buffer, view);
    }

    fn key(&mut self, _model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        self.typed(key);
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.pasted(text);
        After::Stays
    }

    fn click(&mut self, model: &mut Model, row: usize, mouse: MouseEvent, _effects: &mut Effects) -> After {
        if mouse.kind == MouseEventKind::Down(MouseButton::Left) {
            self.click_row(model, row);
        }
        After::Stays
    }

    /// What was set is there again when it opens on the same.
    fn cancel(&mut self, model: &mut Model, _effects: &mut Effects) {
        model.exporting.kept = model.place().cloned().map(|place| self.kept(place));
    }

    /// The wheel moves the cursor.
    fn wheel(&mut self, _model: &mut Model, row: Option<usize>, down: bool) {
        if row.is_some() && self.line.is_none() {
            self.step(if down { 1 } else { -1 });
        }
    }
}

/// Paints the dialog.
fn paint(model: &Model, dialog: &ExportDialog, body: Rect, buffer: &mut Buffer, view: &mut View) {
    let spots = dialog.spots();
    // The frame, a heading, the rows, and what is said of one.
    let height = (spots.len() as u16).saturating_add(3 + ABOUT);
    // In a pane it takes all of the room.
    let air = if body == model.dialog_body() { 2 } else { 0 };
    let outer = centered(COLUMNS, height.min(body.height.saturating_sub(air).max(body.height.min(8))), body);
    let of_forest = model.forest.as_ref().map_or("", |forest| forest.wanted().id.as_str());
    let name = model.tree.as_ref().map_or(of_forest, |tree| tree.wanted().preset.id.as_str());
    let title = clipped(&format!("Export {name}"), usize::from(outer.width).saturating_sub(4));
    let area = popup(model, &title, outer, buffer, view);
    if area.is_empty() {
        return;
    }
    let shown = model.tree.as_ref().and_then(current);
    let estimate = shown.and_then(|shown| dialog.estimate(shown));
    let (text, style) = heading(model, dialog, shown.is_some(), estimate);
    let most = match area.height {
        ..8 => 0,
        8..WITH_HEADING => 1,
        _ => 2,
    };
    let rows = wrapped_within(&text, usize::from(area.width).saturating_sub(1), most);
    let heading = (rows.len() as u16).min(most as u16);
    for (row, y) in rows.iter().zip(area.y..area.y + heading) {
        buffer.set_stringn(area.x + 1, y, row, usize::from(area.width).saturating_sub(1), style);
    }
    let said = said(model, dialog);
    let about = match area.height {
        ..8 => 0,
        height if dialog.start == StartState::Asking => {
            let rows = wrapped(&said.0, area.width.into()).len() as u16;
            (rows + 1).max(LEAST_ABOUT).min(height / 2)
        }
        height if usize::from(height - heading - ABOUT) < spots.len() && area.width >= WIDE => LEAST_ABOUT,
        _ => ABOUT,
    };
    let list = Rect { y: area.y + heading, height: area.height - heading - about, ..area };
    let at = spots.iter().position(|spot| *spot == dialog.cursor).unwrap_or(0);
    let first = first_row(at, spots.len(), list.height.into());
    for (y, (i, spot)) in (list.y..list.bottom()).zip(spots.iter().enumerate().skip(first)) {
        let row = Rect { y, height: 1, ..list };
        view.regions.push((row, Target::Dialog(Some(i))));
        let painter = RowPainter { model, dialog, estimate, chosen: i == at, area: row };
        painter.paint(*spot, buffer, view);
    }
    if outer != area && spots.len() > list.height.into() {
        scrollbar(model, Rect { x: list.right(), width: 1, ..list }, first, spots.len(), buffer);
    }
    if about > 0 {
        explain(model, said, Rect { y: list.bottom(), height: about, ..area }, buffer);
    }
}

/// What will be written: what is set for it alone, or what it amounts to.
fn heading(
    model: &Model,
    dialog: &ExportDialog,
    has_grown: bool,
    estimate: Option<&Estimate>,
) -> (String, Style) {
    let theme = &model.config.theme;
    if let Some(forest) = &model.forest {
        return (of_forest(forest), theme.popup_dim);
    }
    if dialog.is_another_tree() {
        return (set_here(dialog), theme.modified);
    }
    if let Some(warning) = growth::warning(model) {
        return (warning, theme.warning);
    }
    let text = match estimate {
        _ if !has_grown => "the tree is still growing; sizes are told when it has".to_owned(),
        None => "estimating …".to_owned(),
        Some(estimate) => {
            format!("about {} vertices, {} triangles", count(estimate.vertices), count(estimate.triangles))
        }
    };
    (text, theme.popup_dim)
}

/// What is set for this export alone, which may stand far below.
fn set_here(dialog: &ExportDialog) -> String {
    let knobs = dialog.knobs.iter().flat_map(ExportKnobs::turned);
    let mut set: Vec<String> = knobs.map(|(name, value)| format!("{name} {value}")).collect();
    if !dialog.seasons.is_empty() {
        set.push(format!("seasons {}", linden::knob::printable(&dialog.seasons)));
    }
    if !dialog.chosen_ages().is_empty() {
        set.push(format!("ages {}", linden::knob::printable(&dialog.ages)));
    }
    format!("● {}: its size is known when it is written", set.join(", "))
}

/// How many trees there will be; what that comes to is known when it is written.
fn of_forest(forest: &ForestOnScreen) -> String {
    let most = forest.wanted().layout.triangles;
    match &forest.shown {
        Some(shown) if most > 0 => {
            format!("{} trees, up to {} triangles each", thousands(shown.trees), thousands(most))
        }
        Some(shown) => format!("{} trees", thousands(shown.trees)),
        None => "the forest is still growing".to_owned(),
    }
}

/// An estimated number, to two digits: the others would promise too much.
fn count(n: u64) -> String {
    let unit = 10_u64.pow(n.max(1).ilog10().saturating_sub(1));
    thousands((n + unit / 2) / unit * unit)
}

/// A row that is painted.
struct RowPainter<'m> {
    model: &'m Model,
    dialog: &'m ExportDialog,
    estimate: Option<&'m Estimate>,
    /// Whether the cursor is on it.
    chosen: bool,
    area: Rect,
}

impl RowPainter<'_> {
    fn paint(&self, spot: ExportSpot, buffer: &mut Buffer, view: &mut View) {
        let theme = &self.model.config.theme;
        let base = if self.chosen { theme.selected } else { theme.popup };
        buffer.set_style(self.area, base);
        match spot {
            ExportSpot::Format(i) => self.format(&self.dialog.formats[i], base, buffer),
            ExportSpot::Option(i, k) => self.option(i, k, base, buffer, view),
            ExportSpot::Target(i) => self.target(&self.dialog.formats[i], base, buffer, view),
            ExportSpot::Client => self.client(base, buffer),
            ExportSpot::Knob(row) => self.knob(row, base, buffer, view),
            ExportSpot::Seasons => self.list("seasons", &self.dialog.seasons, SEASONS, base, buffer, view),
            ExportSpot::Ages => self.list("ages", &self.dialog.ages, AGES, base, buffer, view),
            ExportSpot::Scene => self.scene(base, buffer),
            ExportSpot::Start => self.start(buffer, view),
        }
    }

    /// The typed line, where this row is being typed.
    fn line(&self, x: u16, buffer: &mut Buffer, view: &mut View) -> bool {
        let Some(line) = self.dialog.line.as_ref().filter(|_| self.chosen) else { return false };
        let area = Rect { x, width: self.area.right().saturating_sub(x), ..self.area };
        prompt::paint(&line.input, area, buffer, view, &self.model.config.theme);
        true
    }

    /// Text from a column on, cut where the row or `end` is reached; gives where it stops.
    fn text(&self, x: u16, end: u16, text: &str, style: Style, buffer: &mut Buffer) -> u16 {
        let room = usize::from(end.min(self.area.right()).saturating_sub(x));
        let text = clipped(text, room);
        if room > 0 {
            buffer.set_stringn(x, self.area.y, &text, room, style);
        }
        x + text.width() as u16
    }

    /// Text at the right end; gives where it begins.
    fn right(&self, text: &str, style: Style, buffer: &mut Buffer) -> u16 {
        let width = (text.width() as u16).min(self.area.width);
        let x = self.area.right() - width;
        self.text(x, self.area.right(), text, style, buffer);
        x
    }

    fn format(&self, choice: &FormatChoice, base: Style, buffer: &mut Buffer) {
        let theme = &self.model.config.theme;
        let format = choice.exporter.format();
        let tick = if choice.chosen { "[x]" } else { "[ ]" };
        let end = match self.estimate.filter(|_| choice.chosen && self.area.width >= WIDE) {
            Some(estimate) => {
                let bytes = match estimate.bytes(format, &choice.options) {
                    Some(bytes) => format!("about {}", length(bytes)),
                    None => "size unknown".to_owned(),
                };
                let triangles = match estimate.triangles_of(format) {
                    0 => String::new(),
                    triangles => format!("{} triangles, ", count(triangles)),
                };
                self.right(&format!(" {triangles}{bytes} "), base.patch(theme.value), buffer)
            }
            None => self.area.right(),
        };
        let mark = if choice.chosen { base.patch(theme.accent) } else { base };
        let x = self.text(self.area.x + 1, end, tick, mark, buffer);
        self.text(x + 1, end, format.id, mark, buffer);
        let x = x + 1 + ID as u16;
        let about = if choice.chosen { format.name } else { format.help };
        self.text(x, end, about, if self.chosen { base } else { theme.popup_dim }, buffer);
    }

    fn option(&self, format: usize, index: usize, base: Style, buffer: &mut Buffer, view: &mut View) {
        let Some((spec, value)) = self.dialog.formats[format].option(index) else { return };
        let theme = &self.model.config.theme;
        let end = self.area.right();
        let x = self.area.x + 1 + INDENT;
        if let (Kind::Switch, Value::Switch(on)) = (spec.knob.kind, value) {
            let x = self.text(x, end, if *on { "[x] " } else { "[ ] " }, base.patch(theme.value), buffer);
            let named = self.text(x, end, spec.knob.name, base, buffer);
            self.about(named.max(x + NAME as u16) + 1, spec.knob.help, base, buffer);
            return;
        }
        let x = self.text(x, end, spec.knob.name, base, buffer) + 1;
        if self.line(x, buffer, view) {
            return;
        }
        let text = match spec.knob.kind {
            Kind::Choice(_) => format!("‹ {value} ›"),
            _ => format!("{value} {}", spec.knob.unit),
        };
        let x = self.text(x, end, &text, base.patch(theme.value), buffer);
        let help = if self.dialog.is_as_on_screen(format, index) { "as on screen" } else { spec.knob.help };
        self.about(x + 2, help, base, buffer);
    }

    /// What an option does, where there is room to say it.
    fn about(&self, x: u16, help: &str, base: Style, buffer: &mut Buffer) {
        if self.area.right().saturating_sub(x) >= 16 {
            let dim = self.model.config.theme.popup_dim;
            self.text(x, self.area.right(), help, if self.chosen { base } else { dim }, buffer);
        }
    }

    /// A knob that is turned for this export.
    fn knob(&self, row: usize, base: Style, buffer: &mut Buffer, view: &mut View) {
        let Some((knob, value, differs)) = self.dialog.knobs.as_ref().and_then(|knobs| knobs.row(row)) else {
            return;
        };
        let (theme, end) = (&self.model.config.theme, self.area.right());
        if differs {
            self.text(self.area.x, end, "●", base.patch(theme.modified), buffer);
        }
        let x =
            self.text(self.area.x + 1, end, knob.knob.name, base, buffer).max(self.area.x + KNOB_NAME) + 1;
        if self.line(x, buffer, view) {
            return;
        }
        let text = match knob.knob.kind {
            Kind::Choice(_) => format!("‹ {value} ›"),
            _ => format!("{value} {}", knob.knob.unit),
        };
        let x = self.text(x, end, &text, base.patch(theme.value), buffer);
        self.about(x + 2, knob.knob.help, base, buffer);
    }

    /// The program that the files are for.
    fn client(&self, base: Style, buffer: &mut Buffer) {
        let (theme, end) = (&self.model.config.theme, self.area.right());
        let x = self.text(self.area.x + 1, end, "for", base, buffer).max(self.area.x + KNOB_NAME) + 1;
        let name = self.dialog.client.map_or("any program", |client| client.id);
        let x = self.text(x, end, &format!("‹ {name} ›"), base.patch(theme.value), buffer);
        match self.dialog.unread().first() {
            Some(why) => {
                self.text(x + 2, end, &format!("! {why}"), base.patch(theme.warning), buffer);
            }
            None => self.about(x + 2, &self.dialog.client_about(), base, buffer),
        }
    }

    /// In which seasons, or at which ages, it is written.
    fn list(&self, name: &str, list: &str, about: &str, base: Style, buffer: &mut Buffer, view: &mut View) {
        let (theme, end) = (&self.model.config.theme, self.area.right());
        if !list.is_empty() {
            self.text(self.area.x, end, "●", base.patch(theme.modified), buffer);
        }
        let x = self.text(self.area.x + 1, end, name, base, buffer).max(self.area.x + KNOB_NAME) + 1;
        if self.line(x, buffer, view) {
            return;
        }
        let shown = if list.is_empty() { "as it is" } else { list };
        let x = self.text(x, end, &linden::knob::printable(shown), base.patch(theme.value), buffer);
        self.about(x + 2, about, base, buffer);
    }

    fn scene(&self, base: Style, buffer: &mut Buffer) {
        let theme = &self.model.config.theme;
        let tick = if self.dialog.scene { "[x] " } else { "[ ] " };
        let x = self.text(self.area.x + 1, self.area.right(), tick, base.patch(theme.value), buffer);
        self.text(x, self.area.right(), "scene", base, buffer);
        self.about(x + ID as u16, SCENE, base, buffer);
    }

    fn target(&self, choice: &FormatChoice, base: Style, buffer: &mut Buffer, view: &mut View) {
        let theme = &self.model.config.theme;
        let x = self.text(self.area.x + 1 + INDENT, self.area.right(), "to ", base, buffer);
        if self.line(x, buffer, view) {
            return;
        }
        let (told, style) = match self.dialog.finding(choice) {
            Some(TargetFinding::Replaces(files)) => match files.len() {
                1 => ("replaces a file".to_owned(), theme.warning),
                files => (format!("replaces {files} files"), theme.warning),
            },
            Some(TargetFinding::NewFolder) => ("in a new directory".to_owned(), theme.warning),
            Some(TargetFinding::Unfit(why)) => (format!("! {why}"), theme.error),
            Some(TargetFinding::Free) | None => (String::new(), base),
        };
        // Half of the row at most says what is wrong; all of it stands below when the cursor is here.
        let told = clipped(&told, usize::from(self.area.width / 2));
        let end = if told.is_empty() {
            self.area.right()
        } else {
            self.right(&format!("{told} "), base.patch(style), buffer).saturating_sub(1)
        };
        // The name matters most: a long path loses its beginning.
        let room = usize::from(end.saturating_sub(x));
        self.text(x, end, &end_of(&choice.target, room), base.patch(theme.path), buffer);
    }

    fn start(&self, buffer: &mut Buffer, view: &mut View) {
        let theme = &self.model.config.theme;
        let row = self.area;
        buffer.set_style(row, theme.popup);
        let count = self.dialog.chosen().count();
        if self.dialog.start == StartState::Asking {
            let question = match (self.dialog.replaced().len(), self.dialog.makes_folders()) {
                (0, _) => " Make the directory?",
                (1, false) => " Replace the file?",
                (1, true) => " Replace the file, make the directory?",
                (_, false) => " Replace these files?",
                (_, true) => " Replace these files, make the directory?",
            };
            let answers = [("export-yes", "yes"), ("export-no", "no")].map(|(id, words)| {
                let key = self.model.config.keymap.keys_of(id).first().map(ToString::to_string);
                (id, format!(" {} {words} ", key.unwrap_or_default()))
            });
            // What it is about stands below; the answers are whole.
            let taken: u16 = answers.iter().map(|(_, words)| words.width() as u16 + 1).sum();
            let end = row.right().saturating_sub(taken);
            let mut x = self.text(row.x, end, question, theme.warning, buffer) + 1;
            for (id, words) in answers {
                let end = self.text(x, row.right(), &words, theme.button, buffer);
                if end > x && end <= row.right() {
                    view.regions.push((Rect { x, width: end - x, ..row }, Target::Command(id)));
                }
                x = end + 1;
            }
            return;
        }
        let words = match (self.dialog.start, count) {
            (StartState::Looking, _) => " looking at the targets … ".to_owned(),
            (_, 0) => " Export: no format is ticked ".to_owned(),
            (_, count) => {
                let noun = if count == 1 { "format" } else { "formats" };
                let about = self.estimate.map(|estimate| {
                    let of =
                        |choice: &FormatChoice| estimate.bytes(choice.exporter.format(), &choice.options);
                    let bytes: Option<u64> = self.dialog.chosen().map(of).sum();
                    bytes.map_or_else(
                        || ", size unknown".to_owned(),
                        |bytes| format!(", about {}", length(bytes)),
                    )
                });
                let about = about.unwrap_or_default();
                format!(" Export {count} {noun}{about} ")
            }
        };
        let style = match (self.chosen, count) {
            (_, 0) => theme.disabled,
            (true, _) => theme.button_focused,
            (false, _) => theme.button,
        };
        self.text(row.x + 1, row.right(), &format!("[{words}]"), style, buffer);
    }
}

/// The end of a text in at most `width` columns, with an ellipsis before it.
fn end_of(text: &str, width: usize) -> String {
    let text = linden::knob::printable(text);
    let mut rest = text.as_str();
    if rest.width() <= width {
        return text;
    }
    while rest.width() + 1 > width {
        let mut chars = rest.chars();
        if chars.next().is_none() {
            return String::new();
        }
        rest = chars.as_str();
    }
    format!("…{rest}")
}

/// What is to be said of the row at the cursor: what is wrong, what may follow, or what it is for.
fn explain(model: &Model, (text, style): (String, Style), area: Rect, buffer: &mut Buffer) {
    let width = usize::from(area.width);
    buffer.set_string(area.x, area.y, "─".repeat(width), model.config.theme.popup_border);
    let rows = wrapped_within(&text, width, usize::from(area.height).saturating_sub(1));
    for (row, y) in rows.iter().zip(area.y + 1..area.bottom()) {
        buffer.set_stringn(area.x, y, row, width, style);
    }
}

/// The names of files, which lie in one directory.
fn names(files: &[PathBuf]) -> String {
    let name = |path: &PathBuf| crate::paths::show(Path::new(path.file_name().unwrap_or_default()));
    files.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// The directory of the files of a format, from the root on, where that was found out.
fn directory(dialog: &ExportDialog, choice: &FormatChoice, target: &str) -> Option<String> {
    let place = dialog.place_at(choice, target)?;
    Some(crate::paths::show(place.parent().unwrap_or(place)))
}

/// Some of the chosen formats by their directories, what is to be told of each behind: `in /a: fir.glb, fir.obj`.
fn by_directory(dialog: &ExportDialog, told: impl Fn(&FormatChoice) -> Option<String>) -> String {
    let mut directories: Vec<(String, Vec<String>)> = Vec::new();
    for choice in dialog.chosen() {
        let Some(told) = told(choice) else { continue };
        let at = directory(dialog, choice, &choice.target).unwrap_or_default();
        match directories.iter_mut().find(|(other, _)| *other == at) {
            Some((_, all)) => all.push(told),
            None => directories.push((at, vec![told])),
        }
    }
    let line = |(at, told): &(String, Vec<String>)| format!("in {at}: {}", told.join(", "));
    directories.iter().map(line).collect::<Vec<_>>().join("; ")
}

/// What is said below the list, of the line that is typed or of what the cursor is on.
fn said(model: &Model, dialog: &ExportDialog) -> (String, Style) {
    let theme = &model.config.theme;
    if let Some(said) = dialog.line.as_ref().and_then(|line| said_of_line(line, theme)) {
        return said;
    }
    let typed = dialog.line.as_ref().map(|line| line.input.value());
    match dialog.cursor {
        ExportSpot::Format(i) => (dialog.formats[i].exporter.format().help.to_owned(), theme.popup),
        ExportSpot::Option(i, k) => match dialog.formats[i].option(k) {
            Some((spec, _)) if dialog.is_as_on_screen(i, k) => {
                (format!("as on screen: {} ({})", spec.knob.help, spec.knob.kind), theme.popup)
            }
            Some((spec, _)) => (format!("{} ({})", spec.knob.help, spec.knob.kind), theme.popup),
            None => (String::new(), theme.popup),
        },
        ExportSpot::Target(i) => {
            let choice = &dialog.formats[i];
            said_of_target(dialog, choice, typed.unwrap_or(&choice.target), theme).unwrap_or_else(|| {
                let at = directory(dialog, choice, typed.unwrap_or(&choice.target));
                let at = at.map(|at| format!("goes to {at}; ")).unwrap_or_default();
                let words = "files that belong to it lie beside it. Tab completes, ~/ is home";
                (format!("{at}{words}"), theme.popup_dim)
            })
        }
        ExportSpot::Knob(row) => match dialog.knobs.as_ref().and_then(|knobs| knobs.row(row)) {
            Some((knob, ..)) => {
                let text = format!("of this export alone: {} ({})", knob.knob.help, knob.knob.kind);
                (text, theme.popup)
            }
            None => (String::new(), theme.popup),
        },
        ExportSpot::Client => match dialog.unread() {
            unread if unread.is_empty() => (dialog.client_about(), theme.popup),
            unread => (unread.join("; "), theme.warning),
        },
        ExportSpot::Seasons => (format!("{SEASONS}; {SEASONS_HOW}"), theme.popup),
        ExportSpot::Ages => (format!("{AGES}; {AGES_HOW}"), theme.popup),
        ExportSpot::Scene => (SCENE.to_owned(), theme.popup),
        ExportSpot::Start => said_of_start(dialog, theme),
    }
}

/// What is wrong with a line, or how it may go on.
fn said_of_line(line: &Typing, theme: &Theme) -> Option<(String, Style)> {
    if let Some(problem) = &line.problem {
        return Some((problem.clone(), theme.error));
    }
    // Their directory stands in the line.
    let name = |offer: &String| {
        let name = offer.trim_end_matches('/');
        offer[name.rfind('/').map_or(0, |at| at + 1)..].to_owned()
    };
    let names: Vec<String> = line.offers.iter().map(name).collect();
    (!names.is_empty()).then(|| (names.join(", "), theme.popup))
}

fn no_directory(at: &str) -> String {
    format!("there is no directory {at}, and it would be made")
}

/// What is to be known of a place that files of a format are to go to.
fn said_of_target(
    dialog: &ExportDialog,
    choice: &FormatChoice,
    target: &str,
    theme: &Theme,
) -> Option<(String, Style)> {
    let at = directory(dialog, choice, target).unwrap_or_default();
    match dialog.finding_at(choice, target)? {
        TargetFinding::Unfit(why) => Some((why.clone(), theme.error)),
        TargetFinding::NewFolder => Some((no_directory(&at), theme.warning)),
        TargetFinding::Replaces(files) => {
            Some((format!("would be replaced in {at}: {}", names(files)), theme.warning))
        }
        TargetFinding::Free => None,
    }
}

/// What the button asks, or says of what it would do.
fn said_of_start(dialog: &ExportDialog, theme: &Theme) -> (String, Style) {
    if dialog.start == StartState::Asking {
        let there = by_directory(dialog, |choice| match dialog.finding(choice)? {
            TargetFinding::Replaces(files) => Some(names(files)),
            _ => None,
        });
        let missing =
            dialog.chosen().filter(|choice| dialog.finding(choice) == Some(&TargetFinding::NewFolder));
        let missing: BTreeSet<String> =
            missing.filter_map(|choice| directory(dialog, choice, &choice.target)).collect();
        let mut told = Vec::new();
        if !there.is_empty() {
            told.push(format!("there already {there}"));
        }
        told.extend(missing.iter().map(|at| no_directory(at)));
        return (told.join("; "), theme.warning);
    }
    match dialog.unfit() {
        Some((_, why)) => (why, theme.error),
        None => {
            let name = |choice: &FormatChoice| {
                let place = dialog.place_at(choice, &choice.target)?;
                Some(names(&[place.to_owned()]))
            };
            let targets = by_directory(dialog, name);
            let how = "all files appear together when all are written, or none does";
            let text = if targets.is_empty() { how.to_owned() } else { format!("{targets}; {how}") };
            (text, theme.popup_dim)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_promise_two_digits() {
        for (n, shown) in
            [(0, "0"), (7, "7"), (96, "96"), (995, "1 000"), (1914, "1 900"), (52_560, "53 000")]
        {
            assert_eq!(count(n), shown);
        }
        for (bytes, shown) in [
            (0, "0 B"),
            (999, "999 B"),
            (1000, "1.0 KiB"),
            (788_634, "770 KiB"),
            (1 << 20, "1.0 MiB"),
            (52_000_000, "50 MiB"),
            (3 << 40, "3.0 TiB"),
        ] {
            assert_eq!(length(bytes), shown);
        }
    }

    #[test]
    fn a_long_path_loses_its_beginning() {
        assert_eq!(end_of("/a/b/fir.glb", 20), "/a/b/fir.glb");
        assert_eq!(end_of("/a/b/fir.glb", 8), "…fir.glb");
        assert_eq!(end_of("木木木", 4), "…木");
        assert_eq!(end_of("fir", 0), "");
    }
}
