//! Joins the model to the terminal and to the jobs.
//!
//! One thread owns the model. It sleeps until something happens: input, an answer of a job, a write
//! that is done, or a time that was asked for. All that has happened is taken in, then one frame
//! is painted: nothing is queued, the newest state is what is sent.

mod effects;
mod jobs;
mod memory;
mod probing;
mod setup;
mod stats;
mod watchdog;
mod watching;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use crossterm::event::Event;
use linden_terminal::input::{Reply, Said};
use linden_terminal::probe::Overrides;
use linden_terminal::session::install_panic_hook;
use linden_terminal::{
    Capabilities, Display, Encoded, Graphic, Incoming, Listener, Modes, Output, Session,
    Settings as DisplaySettings, Tty, listen,
};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use self::jobs::Desk;
use self::memory::Memory;
use self::probing::Probing;
use self::watchdog::Watchdog;
use self::watching::Watching;
use super::commands;
use super::model::Model;
use super::picture;
use super::screen;
use super::update::{Msg, update, wake_at};
use super::vary;
use crate::jobs::THREAD_PREFIX;
use crate::system;

/// How a workbench begins.
#[derive(Default)]
pub struct StartOptions {
    /// What to show first; what was on screen last time when `None`.
    pub source: Option<PathBuf>,
    /// Knobs to turn.
    pub set: Vec<(String, String)>,
    /// What the user says of the terminal.
    pub overrides: Overrides,
    /// Whether bytes and times are shown.
    pub stats: bool,
}

/// How a workbench ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The user left.
    Quit,
    /// A signal asks the process to end; it has to be raised again.
    Signal(i32),
    /// The terminal is gone.
    Hangup,
}

/// What wakes the loop.
enum Happening {
    Incoming(Incoming),
    Written,
    Job(jobs::News),
    Kept(memory::Kept),
    Msg(Box<Msg>),
}

/// The most happenings that are taken in before a frame is painted: a pasted page does not keep the
/// screen from showing where it is.
const MOST_AT_ONCE: usize = 256;
/// How long the last bytes may take when the program ends.
const FAREWELL: Duration = Duration::from_millis(300);

/// Everything that is not the model.
struct Runtime {
    model: Model,
    desk: Desk,
    display: Display,
    probing: Probing,
    session: Session,
    listener: Listener,
    tty: Tty,
    memory: Memory,
    watching: Watching,
    sender: Sender<Happening>,
    end: Option<End>,
    /// Whether the model may look different from the last frame.
    is_stale: bool,
    /// The number of the picture on screen, for terminals that show pixels.
    generation: u64,
    /// Pictures that were shown and may be again, by their generations.
    shown_pictures: Vec<(u64, Arc<Encoded>)>,
    keys: stats::Latency,
    watchdog: Watchdog,
}

/// Opens the workbench on a terminal and stays until it is left.
///
/// # Errors
/// When the terminal cannot be taken, or the system refuses a thread.
pub fn run(tty: Tty, start: StartOptions) -> anyhow::Result<End> {
    install_panic_hook(THREAD_PREFIX, |panic| tracing::error!(%panic, "a job panicked"));
    // Trees grow on all cores, but keys come first. When there is a pool already, that is no harm.
    let pool = rayon::ThreadPoolBuilder::new()
        .thread_name(|index| format!("{THREAD_PREFIX}pool-{index}"))
        .start_handler(|_| system::lower_priority());
    if let Err(error) = pool.build_global() {
        tracing::debug!(%error, "the thread pool");
    }
    let (sender, happenings) = channel();
    let mut runtime = Runtime::start(tty, start, &sender)?;
    runtime.paint();
    // Whatever takes time comes after the first frame.
    runtime.settle_in();
    runtime.follow(&happenings);
    Ok(runtime.leave())
}

impl Runtime {
    fn start(tty: Tty, start: StartOptions, sender: &Sender<Happening>) -> anyhow::Result<Self> {
        let now = Instant::now();
        let size = tty.size();
        let mut probing = Probing::new(start.overrides);
        let (config, overrides_told) = setup::configuration(&mut probing);
        probing.take_window(size);
        let capabilities = probing.conclude();
        let (memory, remembered, complaints) =
            Memory::load(&config, start.source.is_none() && start.set.is_empty(), sender)?;
        let mut model = Model::new(commands::ALL, config, capabilities, (size.columns, size.rows), now);
        for complaint in overrides_told.into_iter().chain(complaints) {
            model.say_error(complaint);
        }
        model.say_complaints();
        let session = Session::start(tty.clone(), Modes { mouse: model.config.settings.mouse })?;
        let to_loop = sender.clone();
        let watchdog = Watchdog::default();
        let watcher = watchdog.clone();
        let listener = listen(tty.clone(), move |incoming| {
            watcher.watch(&incoming);
            to_loop.send(Happening::Incoming(incoming)).is_ok()
        })?;
        let to_loop = sender.clone();
        let output = Output::new(tty.clone(), move || drop(to_loop.send(Happening::Written)))?;
        let display = Display::new(model.size, output, display_settings(&model.terminal));
        let desk = Desk::start(sender)?;
        memory::restore(&mut model, &remembered);
        let mut runtime = Self {
            model,
            desk,
            display,
            probing,
            session,
            listener,
            tty,
            memory,
            watching: Watching::start(sender)?,
            sender: sender.clone(),
            end: None,
            is_stale: true,
            generation: 0,
            shown_pictures: Vec::new(),
            keys: stats::Latency::new(start.stats),
            watchdog,
        };
        // Nobody told of what changed before somebody listened: windows are given their size as programs start in them.
        if runtime.tty.size() != size {
            runtime.resize();
        }
        runtime.open(start.source, start.set, &remembered);
        Ok(runtime)
    }

    /// What is done once the first frame is on its way.
    fn settle_in(&mut self) {
        let now = Instant::now();
        self.probing.begin(&mut self.display, &self.session, now);
        self.list_presets();
        self.watch_files();
    }

    /// Takes in what happens until the end.
    fn follow(&mut self, happenings: &Receiver<Happening>) {
        while self.end.is_none() {
            self.sync();
            if self.is_stale && self.display.output().is_idle() {
                self.paint();
            }
            let first = match self.wake_at() {
                None => happenings.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(at) => happenings.recv_timeout(at.saturating_duration_since(Instant::now())),
            };
            match first {
                Ok(first) => {
                    self.take(first);
                    for next in happenings.try_iter().take(MOST_AT_ONCE) {
                        self.take(next);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => self.end = Some(End::Hangup),
            }
            self.tick();
        }
    }

    /// When to wake though nothing happens; `None` sleeps.
    fn wake_at(&self) -> Option<Instant> {
        [wake_at(&self.model), self.display.wake_at(), self.desk.wake_at(), self.probing.wake_at()]
            .into_iter()
            .chain([self.memory.wake_at()])
            .flatten()
            .min()
    }

    /// What time brings.
    fn tick(&mut self) {
        let now = Instant::now();
        if wake_at(&self.model).is_some_and(|at| at <= now) {
            self.update(Msg::Tick);
        }
        if self.display.wake_at().is_some_and(|at| at <= now) {
            self.display.pump(now);
        }
        if self.probing.expire(&self.session, now) {
            self.know_terminal(now);
        }
        self.memory.tick(&self.model, now);
        // What can no longer be written to is gone.
        if self.display.output().error().is_some() {
            self.end.get_or_insert(End::Hangup);
        }
    }

    fn take(&mut self, happening: Happening) {
        let now = Instant::now();
        match happening {
            Happening::Written => self.display.written(now),
            Happening::Job(news) => {
                if let Some(msg) = self.desk.hear(news, now) {
                    self.update(msg);
                }
            }
            Happening::Kept(kept) => {
                let verdict = self.memory.heard(&self.model, kept);
                self.follow_memory(verdict);
            }
            Happening::Msg(msg) => self.update(*msg),
            Happening::Incoming(incoming) => match incoming {
                Incoming::Input(events) => {
                    for event in events {
                        self.input(event, now);
                    }
                }
                Incoming::Resized => self.resize(),
                Incoming::Continued => {
                    if self.session.resume().is_ok() {
                        self.resize();
                        self.display.invalidate(now);
                    }
                }
                Incoming::Suspend => self.suspend(),
                Incoming::Terminate(signal) => self.end = Some(End::Signal(signal)),
                Incoming::Hangup => self.end = Some(End::Hangup),
            },
        }
    }

    fn input(&mut self, said: Said, now: Instant) {
        let event = match said {
            Said::Event(event) => event,
            Said::Reply(Reply::Status) => return self.display.acked(now),
            Said::Reply(reply) => {
                if let Reply::KittyGraphics { id, ok } = reply {
                    self.display.answered(id, ok, now);
                }
                if self.probing.take(&reply, &self.session) {
                    self.know_terminal(now);
                }
                return;
            }
        };
        match event {
            // tmux and others lose pictures while the window is not seen.
            Event::FocusGained if self.model.terminal.multiplexer.value.is_some() => {
                self.display.invalidate(now);
            }
            Event::FocusGained | Event::FocusLost => {}
            Event::Resize(..) => self.resize(),
            Event::Key(_) | Event::Mouse(_) | Event::Paste(_) => {
                self.keys.pressed(now);
                self.update(Msg::Input(event));
            }
        }
    }

    /// Leaves, once what the user made is kept.
    fn quit(&mut self) {
        let verdict = self.memory.leave(&self.model, Instant::now());
        self.follow_memory(verdict);
    }

    fn follow_memory(&mut self, verdict: memory::Verdict) {
        match verdict {
            memory::Verdict::Goes => {}
            memory::Verdict::Leaves => self.end = Some(End::Quit),
            memory::Verdict::Says(why) => {
                self.model.now = Instant::now();
                self.model.say_error(why);
                self.is_stale = true;
            }
        }
    }

    /// Takes a message into the model and does what it asks for.
    fn update(&mut self, msg: Msg) {
        self.is_stale = true;
        if memory::is_kept(&msg) {
            self.memory.touch(Instant::now());
        }
        for effect in update(&mut self.model, msg, Instant::now()) {
            self.act(effect);
        }
        self.watch_source();
    }

    /// Asks the jobs for what the model wants.
    fn sync(&mut self) {
        // What is there already is a message, after which something else may be wanted.
        while let Some(msg) = self.desk.sync(&self.model, Instant::now()) {
            self.update(msg);
        }
    }

    fn resize(&mut self) {
        let size = self.tty.size();
        self.probing.take_window(size);
        self.display.resize(size.columns, size.rows);
        self.update(Msg::Resized(size.columns, size.rows));
    }

    /// More is known of the terminal.
    fn know_terminal(&mut self, now: Instant) {
        let capabilities = self.probing.conclude();
        if capabilities == self.model.terminal {
            return;
        }
        self.display.set_settings(display_settings(&capabilities), now);
        let complaints = setup::theme(&mut self.model.config, &capabilities);
        for complaint in complaints {
            self.model.say_error(complaint.to_string());
        }
        self.update(Msg::Terminal(Box::new(capabilities)));
    }

    /// Paints the model and hands the frame over.
    fn paint(&mut self) {
        // The model's clock stands: what waits for a time that passes here would not be woken for it.
        let now = Instant::now();
        self.model.stats = self.keys.line(&self.display.stats());
        let mut buffer = Buffer::empty(Rect::new(0, 0, self.model.size.0, self.model.size.1));
        let view = screen::view(&self.model, &mut buffer);
        if !self.model.terminal.unicode.value {
            linden_terminal::ascii::fold(&mut buffer);
        }
        self.model.regions = view.regions;
        let graphics = self.graphics(&view.covers);
        self.display.present(buffer, view.cursor, view.order, graphics, now);
        self.is_stale = false;
        self.keys.painted(now);
    }

    /// The pictures as pixels, where the terminal shows such and nothing lies over them: that of the tree, or
    /// those of a gallery. Below what `covers` a part of one its cells are shown instead.
    fn graphics(&mut self, covers: &[Rect]) -> Vec<Graphic> {
        let is_covered = self.model.dialogs.iter().any(|dialog| !dialog.is_prompt());
        let (layer, wanted) = match vary::graphics(&self.model) {
            Some(small) => (1, small),
            None if is_covered => (0, Vec::new()),
            None => (0, picture::graphic(&self.model).into_iter().collect()),
        };
        // What nothing else holds any more is not shown again.
        self.shown_pictures.retain(|(_, data)| Arc::strong_count(data) > 1);
        let mut graphics = Vec::with_capacity(wanted.len());
        let is_free = |(area, _): &(Rect, _)| covers.iter().all(|cover| !cover.intersects(*area));
        for (area, data) in wanted.into_iter().filter(is_free) {
            if data.protocol() == linden_terminal::graphics::Protocol::Kitty {
                self.session.expect_images(true);
            }
            let known = self.shown_pictures.iter().find(|(_, shown)| Arc::ptr_eq(shown, &data));
            let generation = known.map_or(self.generation + 1, |(generation, _)| *generation);
            if generation > self.generation {
                self.generation = generation;
                self.shown_pictures.push((generation, Arc::clone(&data)));
            }
            graphics.push(Graphic { generation, area, layer, data });
        }
        graphics
    }

    /// Gives the terminal back and keeps what is restored next time.
    fn leave(mut self) -> End {
        self.watchdog.heard();
        let end = self.end.unwrap_or(End::Quit);
        // In a terminal that is given back, Ctrl-C throws away what is about to be read: the read
        // would wait for a line, and the end for the read.
        self.listener.pause();
        if end != End::Hangup {
            // The last frame may still be on its way to a slow terminal.
            self.display.output().flush(FAREWELL);
            // What the terminal still says must not be typed where the shell reads.
            if let Some(within) = self.display.awaits() {
                self.session.expect_replies(Some(within));
            }
            let bytes = self.display.farewell();
            if self.display.output().send(bytes, 0).is_ok() {
                self.display.output().flush(FAREWELL);
            }
        }
        self.session.restore();
        let complaint = self.memory.finish(&self.model);
        self.desk.finish();
        if end == End::Quit {
            if let Some(complaint) = complaint {
                crate::exit::say(&format!("note: {complaint}"));
            }
            if let Some(stats) = self.keys.report(&self.display.stats()) {
                crate::exit::say(&stats);
            }
        }
        end
    }
}

/// What the display has to know of a terminal.
fn display_settings(terminal: &Capabilities) -> DisplaySettings {
    use linden_terminal::probe::Multiplexer;
    DisplaySettings {
        colors: terminal.colors.value,
        synchronized: terminal.synchronized.value,
        remote: terminal.remote.value,
        erases_in_color: terminal.multiplexer.value != Some(Multiplexer::Screen),
    }
}
