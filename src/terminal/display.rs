//! Frames → the terminal: the newest frame, its text at once, its pictures as the link takes them.
//!
//! Nothing here waits, and nothing is done without a cause: [`Display::pump`] sends what may be sent,
//! and is called after a frame ([`Display::present`] does), when a write is done, when a reply has
//! come, and at [`Display::wake_at`].

use std::time::{Duration, Instant};

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::color::ColorDepth;
use crate::graphics::Graphic;
use crate::output::{Busy, Counts, Output};
use crate::pacing::{Pacer, QUERY};
use crate::screen::{Allowance, Frame, Screen, ScreenOptions};

/// Properties of the terminal, as far as they are known; more may become known later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How many colours it shows.
    pub colors: ColorDepth,
    /// Whether it has synchronized output (private mode 2026).
    pub synchronized: bool,
    /// Whether it is on another machine.
    pub remote: bool,
    /// Whether erasing takes the background that is set (all but GNU screen).
    pub erases_in_color: bool,
}

/// Measurements of what was sent, and of the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stats {
    /// Bytes, and what they were.
    pub written: Counts,
    /// Frames that were presented.
    pub frames: u64,
    /// Bytes of pictures that may be unanswered.
    pub window: usize,
    /// The last round trip, queues included.
    pub round_trip: Option<Duration>,
    /// The shortest of late.
    pub shortest_round_trip: Option<Duration>,
    /// Bytes a second.
    pub rate: Option<f64>,
    /// Whether the terminal answers no queries.
    pub mute: bool,
}

/// A terminal that shows frames.
#[derive(Debug)]
pub struct Display {
    output: Output,
    screen: Screen,
    pacer: Pacer,
    size: (u16, u16),
    wanted: Option<Wanted>,
    /// Whether the newest frame is not yet all sent.
    rest: bool,
    /// Whether a status was asked for after the picture was placed.
    asked_behind_picture: bool,
    frames: u64,
    /// Bytes that are no part of the screen.
    beside: Vec<u8>,
}

/// A frame that owns its parts.
#[derive(Debug)]
struct Wanted {
    buffer: Buffer,
    cursor: Option<(u16, u16)>,
    first: Vec<Rect>,
    late: Vec<Rect>,
    graphics: Vec<Graphic>,
}

/// When the cells of a frame are sent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Order {
    /// Before all others: the row that a key has moved to.
    pub first: Vec<Rect>,
    /// After the text, as the link takes them: pictures.
    pub late: Vec<Rect>,
}

impl Settings {
    const fn screen(self) -> ScreenOptions {
        let Self { colors, synchronized, erases_in_color, .. } = self;
        ScreenOptions { colors, synchronized, erases_in_color }
    }
}

impl Display {
    /// A terminal of `size`, columns and rows, of which it is unknown what it shows.
    pub fn new(size: (u16, u16), output: Output, settings: Settings) -> Self {
        Self {
            output,
            screen: Screen::new(settings.screen()),
            pacer: Pacer::new(settings.remote),
            size,
            wanted: None,
            rest: false,
            asked_behind_picture: false,
            frames: 0,
            beside: Vec::new(),
        }
    }

    /// Shows a frame from now on. One of another size than the terminal's is dropped: it was drawn before a
    /// resize, and the next one follows.
    pub fn present(
        &mut self,
        buffer: Buffer,
        cursor: Option<(u16, u16)>,
        order: Order,
        graphics: Vec<Graphic>,
        now: Instant,
    ) {
        if buffer.area != Rect::new(0, 0, self.size.0, self.size.1) {
            return;
        }
        self.frames += 1;
        let Order { first, late } = order;
        self.wanted = Some(Wanted { buffer, cursor, first, late, graphics });
        self.rest = true;
        self.pump(now);
    }

    /// Sends what may be sent.
    pub fn pump(&mut self, now: Instant) {
        if !self.beside.is_empty() && self.output.is_idle() {
            // The output is idle: it takes them.
            // They may leave a plain pen behind (the queries do), so they start from one.
            let mut bytes = self.screen.put_pen_down();
            bytes.append(&mut self.beside);
            if self.pacer.asks(bytes.len()) {
                bytes.extend_from_slice(QUERY);
            }
            self.pacer.sent(bytes.len(), now);
            drop(self.output.send(bytes, 0));
        }
        let Some(wanted) = &self.wanted else { return };
        if !self.rest || !self.output.is_idle() {
            return;
        }
        let frame = Frame {
            buffer: &wanted.buffer,
            cursor: wanted.cursor,
            first: &wanted.first,
            late: &wanted.late,
            graphics: &wanted.graphics,
        };
        let paced = self.pacer.allowance(now);
        let allowance = Allowance {
            text: self.pacer.text_allowance(now),
            paced,
            atomic: self.pacer.atomic_allowance(now),
        };
        let composed = self.screen.compose(&frame, allowance);
        self.rest = composed.rest;
        if composed.bytes.is_empty() {
            return;
        }
        let mut bytes = composed.bytes;
        let asks = self.pacer.asks(bytes.len());
        if asks {
            bytes.extend_from_slice(QUERY);
        }
        self.asked_behind_picture = if composed.placed { asks } else { self.asked_behind_picture };
        self.pacer.sent(bytes.len(), now);
        // The output is idle: it takes them. If it did not, nothing of the screen would be known.
        if let Err(Busy(_)) = self.output.send(bytes, composed.picture) {
            self.screen.invalidate();
            self.rest = true;
        }
    }

    /// The output has written what it had.
    pub fn written(&mut self, now: Instant) {
        self.pump(now);
    }

    /// The terminal has answered a query of the [`Pacer`]'s.
    pub fn acked(&mut self, now: Instant) {
        self.pacer.acked(now);
        if self.asked_behind_picture && self.pacer.in_flight() == 0 {
            self.asked_behind_picture = false;
            self.rest |= self.screen.is_read();
        }
        // A picture in one piece may have been held back by what was known of the link.
        self.rest |= self.wanted.as_ref().is_some_and(|wanted| !wanted.graphics.is_empty());
        self.pump(now);
    }

    /// The terminal has said what became of a picture of kitty's that was placed. One that is not there is sent
    /// again.
    pub fn answered(&mut self, id: u32, ok: bool, now: Instant) {
        if self.screen.answered(id, ok) {
            self.rest = self.wanted.is_some();
            self.pump(now);
        }
    }

    /// How long an answer of the terminal may still take, if one is to come.
    pub fn awaits(&self) -> Option<Duration> {
        let is_asked = self.pacer.in_flight() > 0 || self.screen.awaits();
        let trip = self.pacer.shortest_round_trip().unwrap_or_default();
        (is_asked && !self.pacer.is_mute()).then(|| (trip * 3).max(Duration::from_millis(100)))
    }

    /// When [`Display::pump`] wants to be called if nothing else happens before.
    pub fn wake_at(&self) -> Option<Instant> {
        if self.rest && self.output.is_idle() { self.pacer.wake_at() } else { None }
    }

    /// The terminal's size has changed. The next frame must have it; all of it is sent.
    pub fn resize(&mut self, columns: u16, rows: u16) {
        self.size = (columns, rows);
        self.wanted = None;
        self.rest = false;
        self.screen.invalidate();
    }

    /// Forgets what the terminal shows: all is sent again. For use after a resumption, and when a window of
    /// tmux gets the focus.
    pub fn invalidate(&mut self, now: Instant) {
        self.screen.invalidate();
        self.rest = self.wanted.is_some();
        self.pump(now);
    }

    /// More is known of the terminal.
    pub fn set_settings(&mut self, settings: Settings, now: Instant) {
        self.screen.set_options(settings.screen());
        self.rest = self.wanted.is_some();
        self.pump(now);
    }

    /// Sends bytes that are no part of the screen (a clipboard, a query), as soon as the output takes
    /// them, between two frames.
    pub fn beside(&mut self, bytes: &[u8], now: Instant) {
        self.beside.extend_from_slice(bytes);
        self.pump(now);
    }

    /// Bytes to be written before the screen is given back: those that wait between frames, and those that
    /// remove pictures. Nothing is sent by the display afterwards until the next frame.
    pub fn farewell(&mut self) -> Vec<u8> {
        self.wanted = None;
        self.rest = false;
        // What was copied a moment ago is copied.
        let mut bytes = std::mem::take(&mut self.beside);
        bytes.extend_from_slice(&self.screen.farewell());
        bytes
    }

    /// The way to the terminal: for its state, and for bytes beside the frames.
    pub const fn output(&mut self) -> &mut Output {
        &mut self.output
    }

    /// Measurements of what was sent so far, and of the link.
    pub fn stats(&self) -> Stats {
        Stats {
            written: self.output.counts(),
            frames: self.frames,
            window: self.pacer.window(),
            round_trip: self.pacer.round_trip(),
            shortest_round_trip: self.pacer.shortest_round_trip(),
            rate: self.pacer.rate(),
            mute: self.pacer.is_mute(),
        }
    }
}

#[cfg(test)]
#[path = "display/tests.rs"]
mod tests;
