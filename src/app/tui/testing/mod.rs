//! A workbench without a terminal, threads or files, for tests.

pub mod form;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossterm::event::{Event, KeyCode, KeyEvent, KeyModifiers, MouseEvent, MouseEventKind};
use linden_terminal::input::Shortcut;
use linden_terminal::probe::{Environment, Findings, Overrides};
use linden_terminal::{Capabilities, CellPicture, CellStyle, Image};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};

use super::commands::{self, key_table};
use super::derivation;
use super::effect::Effect;
use super::layout::View;
use super::model::{Config, Model};
use super::picture;
use super::screen;
use super::tree::TreePlace;
use super::update::{Msg, update};
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::jobs::{Detail, Painter, Watcher, derive, grow_shown, grow_shown_forest};
use crate::source;
use crate::source::forest::AnySource;

/// From one message to the next.
const BETWEEN: Duration = Duration::from_millis(100);

/// A key by its name, pressed.
pub fn key_event(name: &str) -> Event {
    Event::Key(name.parse::<Shortcut>().unwrap().into())
}

/// A model, its clock, and the work of the runtime done on the spot.
pub struct Bench {
    /// The model.
    pub model: Model,
    /// What it asked for that was not done.
    pub effects: Vec<Effect>,
    now: Instant,
    painter: Option<Painter>,
    /// The screen is drawn after whatever happens, as in the program; otherwise when it is wanted.
    is_watched: bool,
    /// The last picture that was drawn; on the screen it is blank.
    pub drawn: CellPicture,
}

impl Bench {
    /// An empty workbench on a dark terminal with 24-bit colours.
    pub fn new(columns: u16, rows: u16) -> Self {
        Self::on(columns, rows, &[("COLORTERM", "truecolor")], "auto")
    }

    /// The same on a terminal of which the environment says more, with a theme.
    pub fn on(columns: u16, rows: u16, says: &[(&'static str, &str)], theme: &str) -> Self {
        let pairs = [("TERM", "xterm-256color")].into_iter().chain(says.iter().copied());
        let environment = Environment::from_pairs(pairs);
        let terminal = Capabilities::conclude(&Findings::default(), &environment, &Overrides::default());
        let home = |name: &str| Some(PathBuf::from("/nowhere").join(name));
        let dirs = Dirs { config: home("config"), state: home("state"), cache: None };
        let (theme, complaints) = Theme::load(&dirs, theme, !terminal.dark.value, terminal.colors.value);
        assert!(complaints.is_empty(), "{complaints:?}");
        let keymap = Keymap::defaults(&key_table());
        let config = Config { dirs, theme, keymap, settings: Settings::default(), complaints };
        let now = Instant::now();
        let model = Model::new(commands::ALL, config, terminal, (columns, rows), now);
        let nothing = Image::new(1, 1, &[0; 4]).unwrap();
        let drawn = CellPicture::draw(&nothing, 1, 1, &CellStyle::default(), usize::MAX);
        let painter = Some(Painter::default());
        Self { model, effects: Vec::new(), now, painter, is_watched: true, drawn }
    }

    /// Draws no pictures from now on: for tests that make hundreds of workbenches.
    pub fn without_pictures(self) -> Self {
        Self { painter: None, ..self }
    }

    /// Draws no screen either until [`Bench::look`]: drawing it is most of a test's time.
    pub fn unwatched(self) -> Self {
        Self { painter: None, is_watched: false, ..self }
    }

    /// Draws the screen, and from now on after whatever happens.
    pub fn look(&mut self) {
        self.is_watched = true;
        self.see();
    }

    /// The mouse, and how far a grammar is scrolled, mean what was last seen.
    fn see(&mut self) {
        if self.is_watched {
            self.model.regions = self.paint().1.regions;
        }
    }

    /// A workbench with a small tree on screen: ABOP's first, derived twice.
    pub fn grown(columns: u16, rows: u16) -> Self {
        Self::new(columns, rows).with_tree()
    }

    /// Puts that tree on screen.
    pub fn with_tree(self) -> Self {
        self.with("abop-a")
    }

    /// Puts an L-system's tree on screen, derived twice.
    pub fn with(self, id: &'static str) -> Self {
        self.with_set(id, &[("derivations".to_owned(), "2".to_owned())])
    }

    /// Puts any tree on screen.
    pub fn with_plain(self, id: &'static str) -> Self {
        self.with_set(id, &[])
    }

    fn with_set(mut self, id: &'static str, set: &[(String, String)]) -> Self {
        let place = TreePlace::Builtin(id);
        self.model.library.select_place(&place);
        self.model.loading = Some(place.clone());
        let source = source::resolve(Path::new(id), set, &linden::Quiet).unwrap();
        self.msg(Msg::Loaded(place, Ok(AnySource::Tree(Box::new(source)))));
        self.settle();
        self
    }

    /// A message, a moment after the last.
    pub fn msg(&mut self, msg: Msg) {
        self.now += BETWEEN;
        let effects = update(&mut self.model, msg, self.now);
        self.effects.extend(effects);
        self.see();
    }

    /// Time passes, and what waits for it happens.
    pub fn wait(&mut self, time: Duration) {
        self.now += time;
        self.msg(Msg::Tick);
    }

    /// Keys by their names, one after the other: `j j enter`.
    pub fn keys(&mut self, keys: &str) -> &mut Self {
        for key in keys.split(' ').filter(|key| !key.is_empty()) {
            self.msg(Msg::Input(key_event(key)));
        }
        self
    }

    /// A key.
    pub fn press(&mut self, key: KeyEvent) {
        self.msg(Msg::Input(Event::Key(key)));
    }

    /// The letters of a text as keys.
    pub fn types(&mut self, text: &str) -> &mut Self {
        for c in text.chars() {
            self.press(KeyCode::Char(c).into());
        }
        self
    }

    /// The mouse.
    pub fn mouse(&mut self, kind: MouseEventKind, column: u16, row: u16) {
        let mouse = MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE };
        self.msg(Msg::Input(Event::Mouse(mouse)));
    }

    /// Runs a command as its key does.
    pub fn run(&mut self, id: &str) {
        self.now += BETWEEN;
        (self.model.now, self.model.last_input) = (self.now, self.now);
        let mut effects = Vec::new();
        let command = self.model.command(id).unwrap();
        self.model.run(command, &mut effects);
        self.effects.extend(effects);
        self.see();
    }

    /// Reads what is to be read.
    pub fn load(&mut self) {
        for effect in std::mem::take(&mut self.effects) {
            match effect {
                Effect::Load(place) => {
                    let path = match &place {
                        TreePlace::Builtin(id) => PathBuf::from(id),
                        TreePlace::File(path) => path.clone(),
                    };
                    let source = AnySource::read(&path, &linden::Quiet);
                    let source = source.map_err(|error| crate::exit::sentence(&error));
                    self.msg(Msg::Loaded(place, source));
                }
                other => self.effects.push(other),
            }
        }
    }

    /// Reads, grows and draws until nothing is left to do.
    pub fn settle(&mut self) -> &mut Self {
        self.load();
        if let Some(tree) = &self.model.tree
            && !tree.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(&shown.recipe, tree.wanted()))
        {
            let recipe = Arc::clone(tree.wanted());
            let grown = grow_shown(&recipe, &Watcher::idle()).unwrap();
            self.msg(Msg::Grown(grown));
        }
        if let Some(forest) = &self.model.forest
            && !forest.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(&shown.forest, forest.wanted()))
        {
            let wanted = Arc::clone(forest.wanted());
            let grown = grow_shown_forest(&wanted, &Watcher::idle()).unwrap();
            self.msg(Msg::ForestGrown(grown));
        }
        while let Some(wanted) = derivation::wanted(&self.model) {
            let derivation = derive(wanted, &Watcher::idle()).unwrap();
            self.msg(Msg::Derived(Box::new(derivation)));
        }
        // Nothing is done for so long that the picture is wanted in full.
        self.wait(Duration::from_secs(1));
        // A draft, and then the full picture of the same.
        let mut is_first = true;
        while let Some(painter) = &mut self.painter
            && let Some(wanted) = picture::wanted(&self.model)
        {
            let painted = self.model.picture.painted.as_ref().map(|painted| &painted.request);
            let is_of_it = painted.is_some_and(|painted| painted.is_of(&wanted));
            let is_full = painted.is_some_and(|painted| painted.detail == Detail::Full);
            if (is_of_it && (is_full || wanted.detail == Detail::Draft)) || !(is_first || is_of_it) {
                break;
            }
            is_first = false;
            let mut painted = painter.paint(wanted, &Watcher::idle()).unwrap().unwrap();
            // As on a machine that is neither fast nor slow.
            painted.took = Duration::from_millis(50);
            self.drawn = painted.cells.clone();
            // What pictures show is other tests' business: here they are blank.
            let nothing = Image::new(1, 1, &[0; 4]).unwrap();
            let area = painted.request.area;
            painted.cells =
                CellPicture::draw(&nothing, area.width, area.height, &CellStyle::default(), usize::MAX);
            self.msg(Msg::Painted(Box::new(painted)));
        }
        self
    }

    /// The screen, and what lies where on it.
    pub fn paint(&self) -> (Buffer, View) {
        let mut buffer = Buffer::empty(Rect::new(0, 0, self.model.size.0, self.model.size.1));
        let view = screen::view(&self.model, &mut buffer);
        (buffer, view)
    }

    /// The screen as text.
    pub fn screen(&self) -> String {
        let (buffer, _) = self.paint();
        let mut text = String::new();
        for y in 0..buffer.area.height {
            let mut row = String::new();
            let mut skip = 0;
            for x in 0..buffer.area.width {
                if skip > 0 {
                    skip -= 1;
                    continue;
                }
                let symbol = buffer[(x, y)].symbol();
                skip = unicode_width::UnicodeWidthStr::width(symbol).saturating_sub(1);
                row.push_str(symbol);
            }
            text.push_str(row.trim_end());
            text.push('\n');
        }
        text
    }

    /// The styles of the screen: for each row its runs, a letter for each style and how far it goes,
    /// and what the letters stand for.
    pub fn styles(&self) -> String {
        let (buffer, _) = self.paint();
        let mut known: Vec<Style> = Vec::new();
        let mut text = String::new();
        for y in 0..buffer.area.height {
            let mut runs: Vec<(usize, u16)> = Vec::new();
            for x in 0..buffer.area.width {
                let cell = &buffer[(x, y)];
                let style = Style { add_modifier: cell.modifier, ..Style::new().fg(cell.fg).bg(cell.bg) };
                let at = known.iter().position(|at| *at == style).unwrap_or_else(|| {
                    known.push(style);
                    known.len() - 1
                });
                match runs.last_mut() {
                    Some((last, length)) if *last == at => *length += 1,
                    _ => runs.push((at, 1)),
                }
            }
            let runs = runs.iter().map(|(at, n)| format!("{}{n}", letter(*at)));
            text += &runs.collect::<Vec<_>>().join(" ");
            text.push('\n');
        }
        for (i, style) in known.iter().enumerate() {
            let _ = writeln!(text, "{} = {}", letter(i), described(style));
        }
        text
    }
}

fn letter(i: usize) -> char {
    let letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
    letters.chars().nth(i).unwrap_or('?')
}

fn described(style: &Style) -> String {
    let mut words = Vec::new();
    for (name, color) in [("", style.fg), ("on ", style.bg)] {
        if let Some(color) = color.filter(|color| *color != Color::Reset) {
            words.push(format!("{name}{color}"));
        }
    }
    if style.add_modifier != Modifier::empty() {
        words.push(format!("{:?}", style.add_modifier).to_lowercase());
    }
    if words.is_empty() { "plain".to_owned() } else { words.join(", ") }
}
