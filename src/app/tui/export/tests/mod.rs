//! The dialog of exports, as a user goes through it: a bench that finds out what the dialog wants to know, as the runtime does.

mod choices;
mod kept;
mod keys;
mod ordering;
mod painting;
mod targets;

use std::fs;
use std::path::Path;
use std::sync::mpsc;
use std::time::Instant;

use crossterm::event::{Event, KeyCode, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use linden::Quiet;
use linden::monitor::Phase;
use linden::recipe::Recipe;
use linden_terminal::input::Shortcut;
use linden_terminal::probe::{Capabilities, Environment, Findings, Overrides};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use tempfile::TempDir;

use super::*;
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::session::{self, Session};
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::jobs::{Answer, Done, Lane, ShownTree, grow_shown, look};
use crate::tui::dialog::Dialog;
use crate::tui::layout::{Target, View};
use crate::tui::model::{Config, Weight};
use crate::tui::testing::key_event;
use crate::tui::tree::{Tree, TreePlace};
use crate::tui::update::{Msg, update};
use crate::tui::{commands, screen};

/// A workbench with a tree that has grown, and a directory to export to.
struct ExportBench {
    model: Model,
    dir: TempDir,
    asked: Option<Inquiry>,
}

fn grown(recipe: &Arc<Recipe>) -> Arc<ShownTree> {
    let (sender, answers) = mpsc::channel();
    let lane = Lane::start(
        "test",
        move |answer: Answer<Result<Arc<ShownTree>, String>>| drop(sender.send(answer.done)),
        |recipe: Arc<Recipe>, watcher, give| give(grow_shown(&recipe, watcher).unwrap()),
    )
    .unwrap();
    lane.submit(Arc::clone(recipe));
    let value = |said| if let Done::Value(shown) = said { Some(shown) } else { None };
    answers.iter().find_map(value).unwrap().unwrap()
}

fn empty_model() -> Model {
    let config = Config {
        dirs: Dirs::default(),
        theme: Theme::dark(),
        keymap: Keymap::defaults(&commands::key_table()),
        settings: Settings::default(),
        complaints: Vec::new(),
    };
    let terminal =
        Capabilities::conclude(&Findings::default(), &Environment::default(), &Overrides::default());
    Model::new(commands::ALL, config, terminal, (100, 30), Instant::now())
}

impl ExportBench {
    fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let mut model = empty_model();
        let preset = linden::preset::builtin("older-c").unwrap().load().unwrap();
        let mut tree = Tree::new(TreePlace::Builtin("older-c"), Recipe::new(preset));
        tree.shown = Some(grown(tree.wanted()));
        model.tree = Some(tree);
        let last = dir.path().join("last.glb").to_str().unwrap().to_owned();
        let export =
            session::ExportChoices { targets: vec![last], formats: vec!["glb".into()], options: vec![] };
        model.exporting.remember(&Session { export, ..Session::default() });
        Self { model, dir, asked: None }
    }

    fn send(&mut self, msg: Msg) -> Effects {
        let now = self.model.now;
        let mut effects = update(&mut self.model, msg, now);
        // As the runtime does: what the model wants to know is found out.
        while let Some(wanted) = wanted(&self.model)
            && self.asked.as_ref() != Some(&wanted)
        {
            self.asked = Some(wanted.clone());
            let said = std::cell::RefCell::new(Vec::new());
            look(wanted, &Quiet, &|news| said.borrow_mut().push(news));
            for news in said.into_inner() {
                effects.extend(update(&mut self.model, Msg::Export(news), now));
            }
        }
        effects
    }

    /// Presses keys, named as in keymaps, one after another.
    fn keys(&mut self, keys: &str) -> Effects {
        let mut effects = Effects::new();
        for key in keys.split_whitespace() {
            effects.extend(self.send(Msg::Input(key_event(key))));
        }
        effects
    }

    fn type_text(&mut self, text: &str) {
        for c in text.chars() {
            self.send(Msg::Input(Event::Key(KeyCode::Char(c).into())));
        }
    }

    /// Replaces what stands in the line.
    fn retype(&mut self, text: &str) {
        self.keys("ctrl-u");
        self.type_text(text);
    }

    fn dialog(&self) -> &ExportDialog {
        self.model.dialogs.top().expect("the dialog is open")
    }

    fn is_open(&self) -> bool {
        !self.model.dialogs.is_empty()
    }

    fn at(&self, name: &str) -> String {
        self.dir.path().join(name).to_str().unwrap().to_owned()
    }

    fn go_to(&mut self, wanted: ExportSpot) {
        self.keys("g");
        for _ in 0..90 {
            if self.dialog().cursor == wanted {
                return;
            }
            self.keys("j");
        }
        panic!("{wanted:?} is not in the list");
    }

    fn said(&self) -> (Weight, &str) {
        let message = self.model.message.as_ref().unwrap();
        (message.weight, &message.text)
    }

    /// The only order among some effects.
    fn order(mut effects: Effects) -> ExportOrder {
        assert_eq!(effects.len(), 1, "{effects:?}");
        match effects.remove(0) {
            Effect::Export(order) => order,
            other => panic!("{other:?}"),
        }
    }

    fn screen(&mut self, columns: u16, rows: u16) -> (Buffer, View) {
        self.send(Msg::Resized(columns, rows));
        let mut buffer = Buffer::empty(Rect::new(0, 0, columns, rows));
        let view = screen::view(&self.model, &mut buffer);
        self.model.regions.clone_from(&view.regions);
        (buffer, view)
    }

    fn text(&mut self, columns: u16, rows: u16) -> String {
        let text = text_of(&self.screen(columns, rows).0);
        // The directory has another name each time.
        text.replace(self.dir.path().to_str().unwrap(), "DIR")
    }

    fn click(&mut self, wanted: Target) -> Effects {
        let (_, view) = self.screen(100, 56);
        let (area, _) = *view.regions.iter().rev().find(|(_, target)| *target == wanted).unwrap();
        let kind = MouseEventKind::Down(MouseButton::Left);
        let (column, row) = (area.x + 1, area.y);
        let mouse = MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE };
        self.send(Msg::Input(Event::Mouse(mouse)))
    }

    fn click_spot(&mut self, spot: ExportSpot) -> Effects {
        let row = self.dialog().spots().iter().position(|other| *other == spot).unwrap();
        self.click(Target::Dialog(Some(row)))
    }
}

fn text_of(buffer: &Buffer) -> String {
    let mut text = String::new();
    for y in 0..buffer.area.height {
        let mut line: String = (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect();
        line.truncate(line.trim_end().len());
        text += &line;
        text.push('\n');
    }
    text
}

fn place_of(format: &str) -> usize {
    super::formats().iter().position(|exporter| exporter.format().id == format).unwrap()
}

fn tree_of(order: &ExportOrder) -> (&Arc<Recipe>, Option<&Arc<ShownTree>>) {
    match &order.subject {
        ExportSubject::Tree { recipe, shown } => (recipe, shown.as_ref()),
        ExportSubject::Forest(forest) => panic!("{}", forest.id),
    }
}

fn formats(order: &ExportOrder) -> Vec<&'static str> {
    order.outputs.iter().map(|output| output.exporter.format().id).collect()
}
