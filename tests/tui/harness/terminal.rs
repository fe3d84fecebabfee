//! A terminal behind a link: it shows what comes, and may answer what it is asked.

use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use super::{Shared, Shown, Token, tokens};

/// What a terminal says when it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answers {
    /// Nothing.
    Mute,
    /// What it can do, which is text in 256 colours.
    Plain,
    /// The same in 24 bits.
    TrueColor,
    /// That it has kitty's graphics, and 24 bits.
    Kitty,
    /// That it has sixels, and 24 bits.
    Sixel,
    /// That it is `WezTerm`, which has iTerm2's pictures, and 24 bits.
    Iterm2,
}

/// A link to a terminal on another machine.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    pub bytes_per_second: f64,
    pub round_trip: Duration,
}

impl Link {
    /// What `bytes` bytes take.
    pub fn time_of(&self, bytes: usize) -> Duration {
        Duration::from_secs_f64(bytes as f64 / self.bytes_per_second)
    }

    /// The most bytes that are shown at once: what the link takes in four milliseconds.
    fn piece(&self) -> usize {
        ((self.bytes_per_second * 0.004) as usize).max(1)
    }
}

/// The keys on their way to the program.
pub struct Keyboard {
    sender: Sender<(Instant, Vec<u8>)>,
    delay: Duration,
}

impl Keyboard {
    pub fn new(mut program: Box<dyn Write + Send>, link: Option<Link>) -> Self {
        let delay = link.map_or(Duration::ZERO, |link| link.round_trip / 2);
        let (sender, pressed) = channel::<(Instant, Vec<u8>)>();
        std::thread::spawn(move || {
            for (arrives, bytes) in pressed {
                std::thread::sleep(arrives.saturating_duration_since(Instant::now()));
                if program.write_all(&bytes).is_err() {
                    return;
                }
            }
        });
        Self { sender, delay }
    }

    pub fn press(&self, bytes: &[u8]) {
        // The program may be gone.
        let _ = self.sender.send((Instant::now() + self.delay, bytes.to_owned()));
    }
}

/// What came, and what of it is shown.
struct State {
    stream: Vec<u8>,
    /// When each piece came: its end in the stream.
    came: Vec<(Instant, usize)>,
    /// When each piece was shown.
    seen: Vec<(Instant, usize)>,
    shown: usize,
    parser: vt100::Parser,
    /// Counts what changed.
    generation: u64,
    ended: bool,
}

struct Inner {
    state: Mutex<State>,
    changed: Condvar,
    stop: AtomicBool,
}

impl Inner {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// The screen, and what came to it.
pub struct Monitor(Shared<Inner>);

fn cells(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).unwrap()
}

impl Monitor {
    pub fn new(
        program: Box<dyn Read + Send>,
        (columns, rows): (u16, u16),
        answers: Answers,
        link: Option<Link>,
        keyboard: &Keyboard,
    ) -> Self {
        let state = State {
            stream: Vec::new(),
            came: Vec::new(),
            seen: Vec::new(),
            shown: 0,
            parser: vt100::Parser::new(cells(rows), cells(columns), 0),
            generation: 0,
            ended: false,
        };
        let inner = Shared::new(Inner {
            state: Mutex::new(state),
            changed: Condvar::new(),
            stop: AtomicBool::new(false),
        });
        let of_reader = Shared::clone(&inner);
        std::thread::spawn(move || read(&of_reader, program));
        let (of_screen, replies) = (Shared::clone(&inner), keyboard.sender.clone());
        let delay = keyboard.delay;
        std::thread::spawn(move || {
            show(&of_screen, answers, link, |reply| {
                let _ = replies.send((Instant::now() + delay, reply));
            });
        });
        Self(inner)
    }

    pub fn screen(&self) -> Shown {
        Shown::new(self.0.lock().parser.screen().clone())
    }

    pub fn generation(&self) -> u64 {
        self.0.lock().generation
    }

    pub fn wait_for_change(&self, generation: u64, at_most: Duration) {
        let state = self.0.lock();
        let _ = self.0.changed.wait_timeout_while(state, at_most, |state| state.generation == generation);
    }

    pub fn sent(&self, from: usize) -> Vec<u8> {
        self.0.lock().stream[from..].to_owned()
    }

    pub fn sent_count(&self) -> usize {
        self.0.lock().stream.len()
    }

    pub fn queued(&self) -> usize {
        let state = self.0.lock();
        state.stream.len() - state.shown
    }

    pub fn pieces(&self, from: usize) -> Vec<(Instant, usize)> {
        let state = self.0.lock();
        let mut start = from;
        let pieces = state.came.iter().filter(|(_, end)| *end > from).map(|(at, end)| {
            let bytes = end - start;
            start = *end;
            (*at, bytes)
        });
        pieces.collect()
    }

    pub fn times_of(&self, byte: usize) -> (Instant, Option<Instant>) {
        let state = self.0.lock();
        let of = |pieces: &[(Instant, usize)]| pieces.iter().find(|(_, end)| *end > byte).map(|(at, _)| *at);
        (of(&state.came).unwrap(), of(&state.seen))
    }

    pub fn resize(&self, columns: u16, rows: u16) {
        self.0.lock().parser.set_size(cells(rows), cells(columns));
    }

    pub fn stop_reading(&self) {
        self.0.stop.store(true, Ordering::Release);
    }

    #[track_caller]
    pub fn wait_for_end(&self) {
        super::eventually("the last byte", || {
            let state = self.0.lock();
            (state.ended && state.shown == state.stream.len()).then_some(())
        });
    }
}

/// Takes what the program sends, as fast as it comes: what is between the program and a slow link
/// (the kernel, sshd) holds more than any picture.
fn read(inner: &Inner, mut program: Box<dyn Read + Send>) {
    let mut bytes = vec![0; 1 << 16];
    while let Ok(count @ 1..) = program.read(&mut bytes) {
        let mut state = inner.lock();
        state.stream.extend_from_slice(&bytes[..count]);
        let end = state.stream.len();
        state.came.push((Instant::now(), end));
        drop(state);
        inner.changed.notify_all();
        if inner.stop.load(Ordering::Acquire) {
            break;
        }
    }
    drop(program);
    inner.lock().ended = true;
    inner.changed.notify_all();
}

/// Shows what came when the link has brought it, and answers.
fn show(inner: &Inner, answers: Answers, link: Option<Link>, reply: impl Fn(Vec<u8>)) {
    let mut link_is_free = Instant::now();
    let mut asked = Vec::new();
    loop {
        let mut state = inner.lock();
        while state.shown == state.stream.len() {
            if state.ended {
                return;
            }
            state = inner.changed.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner);
        }
        let from = state.shown;
        let came = state.came.iter().rev().take_while(|(_, end)| *end > from).last();
        let (came, until) = came.copied().unwrap_or((Instant::now(), state.stream.len()));
        let piece = match link {
            None => state.stream[from..].to_owned(),
            Some(link) => state.stream[from..until.min(from + link.piece())].to_owned(),
        };
        drop(state);
        if let Some(link) = link {
            link_is_free = link_is_free.max(came) + link.time_of(piece.len());
            let arrives = link_is_free + link.round_trip / 2;
            std::thread::sleep(arrives.saturating_duration_since(Instant::now()));
        }
        asked.extend_from_slice(&piece);
        let mut state = inner.lock();
        state.parser.process(&piece);
        state.shown = from + piece.len();
        let end = state.shown;
        state.seen.push((Instant::now(), end));
        state.generation += 1;
        let cursor = state.parser.screen().cursor_position();
        drop(state);
        inner.changed.notify_all();
        let (questions, whole) = tokens(&asked);
        let said: Vec<u8> = questions.iter().flat_map(|token| answer(answers, token, cursor)).collect();
        asked.drain(..whole);
        if !said.is_empty() {
            reply(said);
        }
    }
}

/// What a terminal answers to a token.
fn answer(answers: Answers, token: &Token<'_>, (row, column): (u16, u16)) -> Vec<u8> {
    if answers == Answers::Mute {
        return Vec::new();
    }
    let plain = answers == Answers::Plain;
    let text = match token {
        Token::Csi(b"5", b'n') => "\x1b[0n".to_owned(),
        Token::Csi(b"6", b'n') => format!("\x1b[{};{}R", row + 1, column + 1),
        Token::Csi(b"" | b"0", b'c') if answers == Answers::Sixel => "\x1b[?62;4;22c".to_owned(),
        Token::Csi(b"" | b"0", b'c') => "\x1b[?62;22c".to_owned(),
        Token::Csi(b">0" | b">", b'q') => {
            let name = match answers {
                Answers::Kitty => "kitty(0.45.0)",
                Answers::Iterm2 => "WezTerm 20260101",
                _ => "tester 1.0",
            };
            format!("\x1bP>|{name}\x1b\\")
        }
        Token::Csi(b"16", b't') => "\x1b[6;20;10t".to_owned(),
        Token::Csi(b"?2026$", b'p') => "\x1b[?2026;2$y".to_owned(),
        Token::String(b']', b"11;?") => "\x1b]11;rgb:1010/1010/1212\x1b\\".to_owned(),
        Token::String(b'P', b"$qm") if plain => "\x1bP1$r0;48;5;59m\x1b\\".to_owned(),
        Token::String(b'P', b"$qm") => "\x1bP1$r0;48:2::12:34:56m\x1b\\".to_owned(),
        Token::String(b'_', body) if answers == Answers::Kitty && super::find(body, b"a=q").is_some() => {
            "\x1b_Gi=31;OK\x1b\\".to_owned()
        }
        _ => return Vec::new(),
    };
    text.into_bytes()
}
