//! Does the effects that an update asks for.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use linden::Quiet;
use linden::knob::excerpt;

use super::{End, Happening, Runtime, memory, setup};
use crate::config::presets;
use crate::config::session::Session;
use crate::jobs::THREAD_PREFIX;
use crate::trust;
use crate::tui::chrome::footer;
use crate::tui::effect::Effect;
use crate::tui::forest;
use crate::tui::model::Config;
use crate::tui::shape::save;
use crate::tui::tree::{Changes, TreePlace};
use crate::tui::update::Msg;

/// Terminals drop longer clipboards.
const LONGEST_COPY: usize = 74_000;

/// What is seen by whoever opens the workbench for the first time.
const FIRST_TREE: &str = "oak";

impl Runtime {
    pub(super) fn act(&mut self, effect: Effect) {
        match effect {
            Effect::Quit => self.quit(),
            Effect::Suspend => self.suspend(),
            Effect::Redraw => {
                self.resize();
                self.display.invalidate(Instant::now());
            }
            Effect::Load(place) => self.desk.load(place),
            Effect::Copy(text) => self.copy(&text),
            Effect::Save { dir: Some(dir), id, from, recipe, base, overwrite, makes_folder: false }
                if is_missing(&dir) =>
            {
                let folder = dir.clone();
                let (dir, makes_folder) = (Some(dir), true);
                let order = Effect::Save { dir, id, from, recipe, base, overwrite, makes_folder };
                self.update(Msg::NoFolder(folder, Box::new(order)));
            }
            Effect::SaveForest { dir: Some(dir), id, from, forest, overwrite, makes_folder: false }
                if is_missing(&dir) =>
            {
                let folder = dir.clone();
                let (dir, makes_folder) = (Some(dir), true);
                let order = Effect::SaveForest { dir, id, from, forest, overwrite, makes_folder };
                self.update(Msg::NoFolder(folder, Box::new(order)));
            }
            Effect::Save { dir, id, from, recipe, base, overwrite, .. } => {
                let saved = self.folder(dir).and_then(|dir| {
                    let recipe = save::over(&dir, &id, &from, &base, &recipe)?;
                    save::write(&dir, &id, &from, &recipe, overwrite)
                });
                self.update(Msg::Saved(saved));
            }
            Effect::SaveForest { dir, id, from, forest, overwrite, .. } => {
                let saved = self
                    .folder(dir)
                    .and_then(|dir| forest::save::write(&dir, &id, &from, &forest, overwrite));
                self.update(Msg::ForestSaved(saved));
            }
            Effect::Edit(text) => {
                let edited = self.edit(&text);
                self.update(Msg::Edited(edited));
            }
            Effect::EditFile(path) => self.open_in_editor(&path),
            Effect::WriteBack { path, recipe } => {
                let saved = save::write_back(&path, &recipe);
                let is_saved = saved.is_ok();
                self.update(Msg::Saved(saved));
                if is_saved {
                    self.open_in_editor(&path);
                }
            }
            Effect::Remove(path) => {
                let removed = presets::put_away(&path).map_err(|complaint| complaint.to_string());
                self.update(Msg::Removed(removed.map(|kept| (path, kept))));
            }
            Effect::Rename { path, id } => {
                let renamed = presets::rename(&path, &id).map_err(|complaint| complaint.to_string());
                self.update(Msg::Renamed(renamed.map(|to| (path, to))));
            }
            Effect::PutBack { kept, path } => {
                let back = presets::put_back(&kept, &path).map_err(|complaint| complaint.to_string());
                self.update(Msg::PutBack(back.map(|()| path)));
            }
            Effect::Export(order) => self.desk.export(order),
            Effect::CancelExport => self.desk.cancel_export(),
            Effect::Reconfigure => self.reconfigure(),
            Effect::ApplySettings => self.apply_settings(),
        }
    }

    /// Shows what was asked for, or what was there last time, or the first of the list.
    pub(super) fn open(&mut self, source: Option<PathBuf>, set: Vec<(String, String)>, remembered: &Session) {
        let (place, changes) = match (source, &remembered.source) {
            (Some(source), _) => {
                let place = source.to_str().map_or_else(|| TreePlace::File(source.clone()), memory::place);
                if self.model.library.is_shelved(&place) {
                    self.model.say("as you left it: 'Revert all' takes what the document says");
                }
                (place, Changes { knobs: set, whole: None })
            }
            (None, Some(source)) => (memory::place(source), Changes { knobs: set, whole: None }),
            (None, None) => {
                let welcome = footer::welcome(&self.model);
                self.model.say(welcome);
                (TreePlace::Builtin(FIRST_TREE), Changes { knobs: set, whole: None })
            }
        };
        self.model.library.select_place(&place);
        self.model.loading = Some(place.clone());
        self.model.changes = Some((place.clone(), changes));
        self.desk.load(place);
    }

    /// Stops as Ctrl-Z does, and comes back.
    pub(super) fn suspend(&mut self) {
        self.display.output().flush(Duration::from_millis(200));
        self.listener.pause();
        let suspended = self.session.suspend();
        self.listener.resume();
        match suspended {
            Ok(true) => {}
            Ok(false) => self.model.say_warning("nothing could bring linden back: it runs without a shell"),
            Err(error) => self.model.say_error(format!("suspending: {error}")),
        }
        self.resize();
        self.display.invalidate(Instant::now());
    }

    /// Puts text on the clipboard of the terminal's machine.
    fn copy(&mut self, text: &str) {
        if text.len() > LONGEST_COPY {
            self.model.say_warning(format!(
                "{} bytes are more than terminals take into their clipboard; export and use the file's recipe",
                text.len()
            ));
            return;
        }
        if std::env::var_os("TMUX").is_some()
            && let Some(tmux) = trust::program("tmux")
        {
            // tmux keeps OSC 52 of programs to itself unless told otherwise, but has another way.
            let child = Command::new(tmux)
                .args(["load-buffer", "-w", "-"])
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn();
            if let Ok(mut child) = child {
                let text = text.to_owned();
                // It may hang; it is not waited for.
                aside("clipboard", move || {
                    if let Some(mut input) = child.stdin.take() {
                        let _ = input.write_all(text.as_bytes());
                    }
                    let _ = child.wait();
                });
            }
        }
        let bytes = format!("\u{1b}]52;c;{}\u{7}", BASE64_STANDARD.encode(text));
        self.display.beside(bytes.as_bytes(), Instant::now());
    }

    /// The folder that something is saved in: the user's where none is named.
    fn folder(&self, dir: Option<PathBuf>) -> Result<PathBuf, String> {
        let users = || self.model.config.dirs.presets();
        dir.or_else(users).ok_or_else(|| "there is no folder for presets".to_owned())
    }

    /// Edits text in the user's editor.
    fn edit(&mut self, text: &str) -> Result<String, String> {
        let failed = |error: std::io::Error| format!("handing text to the editor: {error}");
        let mut file =
            tempfile::Builder::new().prefix("linden-").suffix(".txt").tempfile().map_err(failed)?;
        file.write_all(text.as_bytes()).and_then(|()| file.flush()).map_err(failed)?;
        self.edit_file(file.path())?;
        // Editors may put another file in its place.
        std::fs::read_to_string(file.path()).map_err(|error| format!("reading the edited text: {error}"))
    }

    fn open_in_editor(&mut self, path: &std::path::Path) {
        if let Err(why) = self.edit_file(path) {
            self.model.say_error(why);
        }
    }

    /// Gives the terminal to the user's editor until it ends.
    fn edit_file(&mut self, path: &std::path::Path) -> Result<(), String> {
        let words = editor(self.model.config.settings.editor.as_deref())?;
        let program = trust::program(&words[0])
            .ok_or_else(|| format!("there is no program '{}' on the search path", excerpt(&words[0])))?;
        self.display.output().flush(Duration::from_millis(200));
        self.listener.pause();
        self.session.restore();
        let status = Command::new(program).args(&words[1..]).arg(path).status();
        let resumed = self.session.resume();
        self.listener.resume();
        self.resize();
        self.display.invalidate(Instant::now());
        if let Err(error) = resumed {
            tracing::debug!(%error, "taking the terminal again");
            self.end = Some(End::Hangup);
        }
        let name = linden::knob::printable(&words.join(" "));
        match status {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(format!("the editor '{name}' ended with {status}; nothing was taken over")),
            Err(error) => Err(format!(
                "starting the editor '{name}': {error}; set 'editor' in config.toml, VISUAL or EDITOR"
            )),
        }
    }

    /// Reads the user's presets, off this thread: a home on a network may take its time.
    pub(super) fn list_presets(&mut self) {
        let Some(dir) = self.model.config.dirs.presets() else { return };
        let sender = self.sender.clone();
        aside("presets", move || {
            let (found, complaints) = presets::list(&dir, &Quiet);
            // The loop is deaf only when the program ends.
            drop(sender.send(Happening::Msg(Box::new(Msg::Presets(found, complaints)))));
        });
    }

    /// Watches the user's files from now on, if they want that.
    pub(super) fn watch_files(&mut self) {
        let config = &self.model.config;
        self.watching.directory(config.dirs.config.clone().filter(|_| config.settings.reload));
    }

    /// Watches what the tree on screen was read from.
    pub(super) fn watch_source(&mut self) {
        let of_forest = self.model.forest.as_ref().map(|forest| forest.files().to_vec());
        let of_tree = self.model.tree.as_ref().map(crate::tui::tree::Tree::files);
        let files = of_tree.or(of_forest).unwrap_or_default();
        self.watching.files(files);
    }

    /// Puts settings in force that were changed on screen.
    fn apply_settings(&mut self) {
        let settings = self.model.config.settings.clone();
        if let Err(error) = self.session.set_mouse(settings.mouse) {
            self.model.say_error(format!("switching the mouse: {error}"));
        }
        setup::override_terminal(&mut self.probing, &settings);
        self.watch_files();
        self.know_terminal(Instant::now());
        for complaint in setup::theme(&mut self.model.config, &self.probing.conclude()) {
            self.model.say_error(complaint.to_string());
        }
    }

    fn reconfigure(&mut self) {
        let (Config { theme, keymap, settings, complaints, dirs }, told) =
            setup::configuration(&mut self.probing);
        let reload_changes = settings.reload != self.model.config.settings.reload;
        let mouse_changes = settings.mouse != self.model.config.settings.mouse;
        if mouse_changes && let Err(error) = self.session.set_mouse(settings.mouse) {
            self.model.say_error(format!("switching the mouse: {error}"));
        }
        self.list_presets();
        for complaint in told {
            self.model.say_error(complaint);
        }
        let config = Config { dirs, theme, keymap, settings, complaints };
        self.update(Msg::Configured(Box::new(config)));
        if reload_changes {
            self.watch_files();
        }
        self.know_terminal(Instant::now());
    }
}

/// Does something small that may take its time. Without a thread it is not done: nothing depends on it.
fn aside(name: &str, work: impl FnOnce() + Send + 'static) {
    let spawned = std::thread::Builder::new().name(format!("{THREAD_PREFIX}{name}")).spawn(work);
    if let Err(error) = spawned {
        tracing::debug!(%error, name, "no thread");
    }
}

/// The user's editor as words.
fn editor(setting: Option<&str>) -> Result<Vec<String>, String> {
    let of = |name: &str| std::env::var(name).ok().filter(|value| !value.trim().is_empty());
    let line = setting
        .map(str::to_owned)
        .or_else(|| of("VISUAL"))
        .or_else(|| of("EDITOR"))
        .unwrap_or_else(|| "vi".to_owned());
    let words = shell_words::split(&line).map_err(|error| format!("the editor's command line: {error}"))?;
    if words.is_empty() { Err("the editor's command line is empty".to_owned()) } else { Ok(words) }
}

/// Whether a folder that was typed is not there.
fn is_missing(folder: &Path) -> bool {
    !folder.as_os_str().is_empty() && std::fs::symlink_metadata(folder).is_err()
}
