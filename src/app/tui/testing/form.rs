//! A workbench without a terminal, for the tests of the form.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crossterm::event::{Event, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use linden::Quiet;
use linden_terminal::probe::{Capabilities, Environment, Findings, Overrides};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::jobs::{Answer, Done, Lane, grow_shown};
use crate::tui::commands;
use crate::tui::effect::Effects;
use crate::tui::layout::{Pane, View};
use crate::tui::model::{Config, FormSpot, Model};
use crate::tui::screen;
use crate::tui::shape::save_lines::SaveLine;
use crate::tui::shape::value::ValueLine;
use crate::tui::testing::key_event;
use crate::tui::tree::{Tree, TreePlace};
use crate::tui::update::{Msg, update};

/// A workbench, and what it asked for.
pub struct FormBench {
    pub model: Model,
    pub effects: Effects,
}

impl FormBench {
    /// With a built-in preset on screen and the form in focus.
    pub fn new(id: &'static str) -> Self {
        Self::at(TreePlace::Builtin(id), PathBuf::from("/nowhere"))
    }

    /// With the preset of a place, and a directory for the user's.
    pub fn at(place: TreePlace, config: PathBuf) -> Self {
        let config = Config {
            dirs: Dirs { config: Some(config), state: None, cache: None },
            theme: Theme::dark(),
            keymap: Keymap::defaults(&commands::key_table()),
            settings: Settings::default(),
            complaints: Vec::new(),
        };
        let environment = Environment::from_pairs([("TERM", "xterm-256color"), ("COLORTERM", "truecolor")]);
        let terminal = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
        let mut model = Model::new(commands::ALL, config, terminal, (100, 40), Instant::now());
        let path = match &place {
            TreePlace::Builtin(id) => PathBuf::from(id),
            TreePlace::File(path) => path.clone(),
        };
        let source = crate::source::resolve(&path, &[], &Quiet).unwrap();
        model.tree = Some(Tree::new(place, source.recipe));
        model.focus_on(Pane::Shape);
        Self { model, effects: Effects::new() }
    }

    /// Presses keys, a second between any two.
    pub fn keys(&mut self, names: &str) -> &mut Self {
        for name in names.split_whitespace() {
            self.send(Msg::Input(key_event(name)));
        }
        self
    }

    /// Types text, a line break as Enter.
    pub fn typed(&mut self, text: &str) -> &mut Self {
        for c in text.chars() {
            let code = if c == '\n' { "enter".to_owned() } else { c.to_string().replace(' ', "space") };
            self.send(Msg::Input(key_event(&code)));
        }
        self
    }

    pub fn send(&mut self, msg: Msg) {
        let now = self.model.now + Duration::from_secs(1);
        self.effects.extend(update(&mut self.model, msg, now));
    }

    /// Presses the mouse on a cell of the last frame.
    pub fn press(&mut self, column: u16, row: u16) {
        let kind = MouseEventKind::Down(MouseButton::Left);
        let mouse = MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE };
        self.send(Msg::Input(Event::Mouse(mouse)));
    }

    /// Paints a frame; the model knows where everything was, as it does after a real one.
    pub fn paint(&mut self, columns: u16, rows: u16) -> (Buffer, View) {
        self.model.size = (columns, rows);
        let mut buffer = Buffer::empty(Rect::new(0, 0, columns, rows));
        let view = screen::view(&self.model, &mut buffer);
        self.model.regions.clone_from(&view.regions);
        (buffer, view)
    }

    /// Grows what is on screen, as the job does.
    pub fn grow(&mut self) -> &mut Self {
        let wanted = self.tree().wanted().clone();
        let (sender, receiver) = std::sync::mpsc::channel();
        let send = move |answer: Answer<_>| drop(sender.send(answer.done));
        let lane = Lane::start("test", send, |wanted, watcher, give| {
            if let Some(grown) = grow_shown(&wanted, watcher) {
                give(grown);
            }
        });
        let lane = lane.unwrap();
        lane.submit(wanted);
        let grown =
            receiver.iter().find_map(|done| if let Done::Value(grown) = done { Some(grown) } else { None });
        self.send(Msg::Grown(grown.unwrap()));
        self
    }

    pub fn tree(&self) -> &Tree {
        self.model.tree.as_ref().unwrap()
    }

    /// A knob's value as text.
    pub fn value(&self, name: &str) -> String {
        let knobs = self.tree().preset().all_knobs();
        knobs.into_iter().find(|(row, _)| row.knob.name == name).unwrap().1.to_string()
    }

    /// Puts the form's cursor on a knob.
    pub fn on(&mut self, name: &'static str) -> &mut Self {
        self.model.form.selected = Some(FormSpot::Knob(name));
        self
    }

    /// What is wrong with the line that is being typed.
    pub fn problem(&self) -> Option<String> {
        let dialogs = &self.model.dialogs;
        let value = dialogs.top::<ValueLine>().map(|line| &line.prompt);
        let prompt = value.or(dialogs.top::<SaveLine>().map(|line| &line.prompt));
        prompt.and_then(|prompt| prompt.problem.clone())
    }

    /// What the footer says.
    pub fn said(&self) -> &str {
        self.model.message.as_ref().map_or("", |message| &message.text)
    }

    /// Takes a user's preset into the list.
    pub fn list(&mut self, dir: &std::path::Path) {
        self.model.library.set_user(crate::config::presets::list(dir, &Quiet).0, None);
    }
}

/// A buffer's text, without blanks at the ends of lines.
pub fn text(buffer: &Buffer) -> String {
    let mut text = String::new();
    for y in 0..buffer.area.height {
        let line: String = (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect();
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
