//! The path of a file, typed: what is in the directory is listed above, and what the list's cursor is on is shown.

use std::path::Path;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::widgets::{Clear, Widget as _};

use super::show_selected;
use crate::jobs::{Findings, Inquiry};
use crate::paths::{self, expand};
use crate::system::QUOTES_DROPPED;
use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::{Pane, View, first_row};
use crate::tui::model::Model;
use crate::tui::tree::TreePlace;
use crate::wrap::clipped;

/// Endings of files that trees grow from, which alone are listed beside directories.
const ENDINGS: [&str; 19] = [
    "toml", "json", "l", "txt", "obj", "ply", "glb", "gltf", "usda", "usdz", "xyz", "csv", "las", "laz",
    "e57", "pcd", "pts", "ptx", "asc",
];

/// The line of a path.
pub struct OpenLine {
    prompt: Prompt,
    /// What the path may go on to be, as far as it was found out.
    offers: Vec<String>,
    /// What the offers are for.
    asked: Option<String>,
    /// The offer that the cursor is on; `None` while it is in the line.
    at: Option<usize>,
    /// What was on screen, for Esc.
    before: Option<TreePlace>,
    /// Files that were only looked at.
    seen: Vec<TreePlace>,
}

impl OpenLine {
    /// From what is on screen.
    pub fn new(model: &Model) -> Self {
        Self {
            prompt: Prompt::new(""),
            offers: Vec::new(),
            asked: None,
            at: None,
            before: model.tree.as_ref().map(|tree| tree.place.clone()),
            seen: Vec::new(),
        }
    }

    /// What it wants to know of the disk.
    pub fn inquiry(&self) -> Inquiry {
        let typed = self.asked.as_deref().filter(|_| self.at.is_some()).unwrap_or(self.prompt.text());
        Inquiry {
            round: 0,
            targets: Vec::new(),
            levels: 1,
            seasons: Vec::new(),
            ages: Vec::new(),
            completes: Some(typed.to_owned()),
            shown: None,
            sources: Vec::new(),
        }
    }

    /// Takes what was found out.
    pub fn take(&mut self, findings: Findings) {
        if self.at.is_none() {
            self.asked = findings.inquiry.completes;
            self.offers = findings.completions.into_iter().filter(|offer| is_offered(offer)).collect();
        }
    }

    /// Moves to another offer and shows it.
    fn step(&mut self, model: &mut Model, down: bool, effects: &mut Effects) {
        if self.offers.is_empty() {
            return;
        }
        let last = self.offers.len() - 1;
        let to = match (self.at, down) {
            (None, true) => 0,
            (None, false) => last,
            (Some(at), true) => (at + 1).min(last),
            (Some(at), false) => at.saturating_sub(1),
        };
        self.at = Some(to);
        let offer = self.offers[to].clone();
        self.prompt.replace(&offer);
        if !is_folder(&offer) {
            self.show(model, &offer, effects);
        }
    }

    /// Puts a file on screen.
    fn show(&mut self, model: &mut Model, path: &str, effects: &mut Effects) {
        let Ok(path) = expand(path) else { return };
        let place = TreePlace::File(path);
        let is_listed = model.library.places().any(|(_, listed)| *listed == place);
        if !is_listed && !self.seen.contains(&place) {
            self.seen.push(place.clone());
        }
        load(model, place, effects);
    }

    /// Goes on as far as all offers agree.
    fn complete(&mut self) {
        self.at = None;
        let Some(common) = prompt::common_start(&self.offers) else { return };
        if common.len() > self.prompt.text().len() {
            self.prompt.replace(common);
        }
    }

    /// Forgets the files that were only looked at, but for one.
    fn tidy(&mut self, model: &mut Model, but: Option<&TreePlace>) {
        let seen = std::mem::take(&mut self.seen);
        model.library.forget(|place| seen.contains(place) && Some(place) != but);
    }
}

impl Dialog<Model> for OpenLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let theme = &model.config.theme;
        let remark = match &self.prompt.problem {
            Some(problem) => Some(prompt::Remark { text: problem.clone(), warns: true }),
            None => self.offers.is_empty().then(|| prompt::Remark {
                text: "a preset, a grammar, a mesh, a scan, or an export; a path of a file".to_owned(),
                warns: false,
            }),
        };
        self.prompt.paint_at_bottom(model, "open", remark.as_ref(), screen, buffer, view);
        // Below the title and the panes' names, where those have room.
        let most = screen.height.saturating_sub(if screen.height >= 8 { 3 } else { 2 });
        let rows = u16::try_from(self.offers.len()).unwrap_or(u16::MAX).min(most);
        let longest = self.offers.iter().map(|offer| name_of(offer).chars().count()).max().unwrap_or(0);
        // All of the pane that it lies on, no half of whose rows is left.
        let pane = model.layout().pane(Pane::Presets).map_or(0, |pane| pane.width);
        let width = (longest as u16 + 3).clamp(16, 48).max(pane).min(screen.width);
        let list = Rect::new(screen.x, screen.bottom().saturating_sub(1 + rows), width, rows);
        view.covers.push(list);
        Clear.render(list, buffer);
        let first = first_row(self.at.unwrap_or(0), self.offers.len(), rows.into());
        for (y, (i, offer)) in (list.y..list.bottom()).zip(self.offers.iter().enumerate().skip(first)) {
            let row = Rect { y, height: 1, ..list };
            let style = if self.at == Some(i) { theme.selected } else { theme.popup };
            buffer.set_style(row, style);
            let text = clipped(&format!(" {}", linden::knob::printable(name_of(offer))), row.width.into());
            buffer.set_stringn(row.x, row.y, text, row.width.into(), style);
        }
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        match key.code {
            KeyCode::Down => self.step(model, true, effects),
            KeyCode::Up => self.step(model, false, effects),
            KeyCode::Tab => self.complete(),
            _ => {
                if self.prompt.key(key) {
                    (self.at, self.prompt.problem) = (None, None);
                }
            }
        }
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(&dropped(text));
        (self.at, self.prompt.problem) = (None, None);
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        let path = self.prompt.text().trim().to_owned();
        if path.is_empty() {
            self.tidy(model, None);
            return After::Closes;
        }
        if is_folder(&path) {
            // Into the folder.
            self.at = None;
            return After::Stays;
        }
        let path = match expand(&path) {
            Ok(path) => path,
            Err(why) => {
                self.prompt.problem = Some(why);
                return After::Stays;
            }
        };
        let place = TreePlace::File(path);
        self.tidy(model, Some(&place));
        load(model, place, effects);
        After::Closes
    }

    fn cancel(&mut self, model: &mut Model, effects: &mut Effects) {
        self.tidy(model, None);
        if let Some(before) = self.before.take()
            && model.library.select_place(&before)
        {
            show_selected(model, effects);
        }
    }

    /// Enter alone opens.
    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.cancel(model, effects);
        After::Closes
    }
}

/// Reads a file and shows it, or says why its path is none.
pub fn open_path(model: &mut Model, path: &str, effects: &mut Effects) {
    match expand(path) {
        Ok(path) => load(model, TreePlace::File(path), effects),
        Err(why) => model.say_warning(why),
    }
}

/// The path in what a terminal pastes when a file is dropped on it, `None` where that is no path: quoted or with
/// escapes as shells take it, or a URL.
pub fn dropped_path(text: &str) -> Option<String> {
    let path = dropped(text);
    let is_path = path.starts_with('/') || path.starts_with("~/") || Path::new(&path).is_absolute();
    is_path.then_some(path)
}

fn dropped(text: &str) -> String {
    let path = unquoted(text);
    // Terminals drop whole paths, in which a dollar is one.
    if Path::new(&path).is_absolute() { paths::typed(&path) } else { path }
}

fn unquoted(text: &str) -> String {
    let text = text.trim();
    if let Some(rest) = text.strip_prefix("file://") {
        // Behind the host, which is empty or this machine.
        return unescaped(&rest[rest.find('/').unwrap_or(0)..]);
    }
    match shell_words::split(text).as_deref() {
        Ok([only]) if QUOTES_DROPPED => only.clone(),
        _ => text.to_owned(),
    }
}

/// `%20` as a space.
fn unescaped(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = after.get(..2).filter(|_| *first == b'%').and_then(|hex| std::str::from_utf8(hex).ok());
        match hex.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn load(model: &mut Model, place: TreePlace, effects: &mut Effects) {
    if model.tree.as_ref().is_some_and(|tree| tree.place == place) {
        return;
    }
    model.loading = Some(place.clone());
    effects.push(Effect::Load(place));
}

fn is_folder(path: &str) -> bool {
    path.ends_with(std::path::is_separator)
}

/// Directories, and files that trees may grow from.
fn is_offered(offer: &str) -> bool {
    let ending = Path::new(offer).extension().and_then(|ending| ending.to_str());
    is_folder(offer)
        || ending.is_some_and(|ending| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// The last part of a path, a folder's with its separator.
fn name_of(path: &str) -> &str {
    let body = path.trim_end_matches(std::path::is_separator);
    body.rfind(std::path::is_separator).map_or(path, |at| &path[at + 1..])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::ExportNews;
    use crate::tui::library;
    use crate::tui::testing::Bench;
    use crate::tui::update::Msg;

    /// Answers what the line wants to know from the disk.
    fn answer(bench: &mut Bench) {
        let inquiry = library::wanted(&bench.model).unwrap();
        let found = std::cell::RefCell::new(None);
        crate::jobs::look(inquiry, &linden::Quiet, &|news| *found.borrow_mut() = Some(news));
        let Some(ExportNews::Found(findings)) = found.into_inner() else { panic!() };
        bench.msg(Msg::Export(ExportNews::Found(findings)));
    }

    #[test]
    fn files_are_listed_shown_as_one_goes_through_them_and_opened() {
        let dir = tempfile::tempdir().unwrap();
        let fir = linden::preset::builtin("fir").unwrap().text;
        for name in ["a.toml", "b.toml"] {
            std::fs::write(dir.path().join(name), fir).unwrap();
        }
        std::fs::write(dir.path().join("notes.doc"), "").unwrap();
        std::fs::create_dir(dir.path().join("c")).unwrap();
        let base = format!("{}/", dir.path().display());
        let mut bench = Bench::grown(100, 30).without_pictures();
        let before = bench.model.tree.as_ref().unwrap().place.clone();
        let listed = bench.model.library.len();
        bench.keys("ctrl-o").types(&base);
        answer(&mut bench);
        let screen = bench.screen();
        assert!(
            screen.contains(" a.toml") && screen.contains(" c/") && !screen.contains("notes"),
            "{screen}"
        );
        bench.keys("down down");
        let place = TreePlace::File(dir.path().join("b.toml"));
        assert!(
            bench.effects.iter().any(|e| matches!(e, Effect::Load(of) if *of == place)),
            "{:?}",
            bench.effects
        );
        bench.keys("esc");
        assert_eq!(bench.model.library.len(), listed, "what was only looked at is not listed");
        assert_eq!(bench.model.library.entry().map(|entry| entry.place.clone()), Some(before));
        bench.keys("ctrl-o").types(&format!("{base}b.toml")).keys("enter");
        assert!(bench.model.dialogs.is_empty());
        assert!(
            matches!(bench.effects.last(), Some(Effect::Load(of)) if *of == place),
            "{:?}",
            bench.effects
        );
    }

    #[test]
    fn what_is_dropped_is_a_path_however_it_is_quoted() {
        for (text, path) in [
            ("/a/b c.toml", None),
            ("'/a/b c.toml' ", Some("/a/b c.toml")),
            ("/a/b\\ c.toml", Some("/a/b c.toml")),
            ("'/a/$b.toml'", Some("/a/$$b.toml")),
            ("file:///a/b%20c.toml\n", Some("/a/b c.toml")),
            ("file://host/a.toml", Some("/a.toml")),
            ("season 0.8", None),
            ("/a.toml", Some("/a.toml")),
        ] {
            let found = dropped_path(text);
            match path {
                Some(path) => assert_eq!(found.as_deref(), Some(path), "{text}"),
                // A space that nothing quotes: as it stands.
                None => assert!(found.is_none() || found.as_deref() == Some(text), "{text} {found:?}"),
            }
        }
    }

    #[test]
    fn a_file_that_is_dropped_on_the_panes_is_opened() {
        let mut bench = Bench::grown(100, 30).without_pictures();
        bench.msg(Msg::Input(crossterm::event::Event::Paste("'/tmp/my oak.toml' ".to_owned())));
        let place = TreePlace::File("/tmp/my oak.toml".into());
        assert!(matches!(bench.effects.last(), Some(Effect::Load(of)) if *of == place));
    }
}
