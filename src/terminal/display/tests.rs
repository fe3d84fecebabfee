use std::io::Write;
use std::sync::{Arc, Mutex, mpsc};

use ratatui::style::{Color, Style};

use super::*;
use crate::graphics::{Protocol, encode};

/// What the writer thread has written.
#[derive(Clone, Default)]
struct Sink(Arc<Mutex<Vec<u8>>>);

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// A display before a terminal that reads when it is told, and a clock.
struct Rig {
    display: Display,
    sink: Sink,
    done: mpsc::Receiver<()>,
    terminal: vt100::Parser,
    now: Instant,
    /// Bytes that were written since the last [`Rig::read`].
    writes: Vec<usize>,
}

const SETTINGS: Settings =
    Settings { colors: ColorDepth::True, synchronized: false, remote: true, erases_in_color: true };
const PICTURE: Rect = Rect::new(28, 1, 64, 36);

impl Rig {
    fn new(settings: Settings) -> Self {
        let (tell, done) = mpsc::channel();
        let sink = Sink::default();
        let output = Output::new(sink.clone(), move || tell.send(()).unwrap()).unwrap();
        Self {
            display: Display::new((120, 40), output, settings),
            sink,
            done,
            terminal: vt100::Parser::new(40.try_into().unwrap(), 120.try_into().unwrap(), 0),
            now: Instant::now(),
            writes: Vec::new(),
        }
    }

    fn present(&mut self, buffer: &Buffer) {
        self.display.present(
            buffer.clone(),
            None,
            Order { first: Vec::new(), late: vec![PICTURE] },
            Vec::new(),
            self.now,
        );
    }

    /// Lets the writer finish, and the display go on, until nothing more is sent.
    fn settle(&mut self) {
        loop {
            while !self.display.output().is_idle() {
                self.done.recv_timeout(Duration::from_mins(1)).expect("a write ends");
            }
            let bytes = std::mem::take(&mut *self.sink.0.lock().unwrap());
            if bytes.is_empty() {
                return;
            }
            self.writes.push(bytes.len());
            self.terminal.process(&bytes);
            self.display.written(self.now);
        }
    }

    /// The status queries that the terminal has to answer.
    fn text(&self) -> String {
        self.terminal.screen().contents()
    }
}

fn frame(word: &str, seed: u32) -> Buffer {
    let mut buffer = Buffer::empty(Rect::new(0, 0, 120, 40));
    buffer.set_string(0, 0, word, Style::new());
    let mut state = seed;
    for (x, y) in
        (PICTURE.left()..PICTURE.right()).flat_map(|x| (PICTURE.top()..PICTURE.bottom()).map(move |y| (x, y)))
    {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let [r, g, b, _] = state.to_be_bytes();
        buffer[(x, y)]
            .set_symbol("▀")
            .set_style(Style::new().fg(Color::Rgb(r, g, b)).bg(Color::Rgb(g, b, r)));
    }
    buffer
}

#[test]
fn text_goes_at_once_and_the_picture_waits_for_replies() {
    let mut rig = Rig::new(SETTINGS);
    rig.present(&frame("first", 1));
    rig.settle();
    assert!(rig.text().starts_with("first"));
    let sent: usize = rig.writes.iter().sum();
    assert!(sent < 4000, "no more than the first window: {sent}");
    assert!(rig.display.wake_at().is_some(), "a reply may be lost");
    // A key, while the picture waits.
    rig.writes.clear();
    rig.present(&frame("second", 1));
    rig.settle();
    assert!(rig.text().starts_with("second"));
    assert!(rig.writes.iter().sum::<usize>() < 100, "{:?}", rig.writes);
    // Each reply brings more of it, until all is there.
    for _ in 0..10_000 {
        rig.now += Duration::from_millis(20);
        rig.display.acked(rig.now);
        rig.settle();
        if rig.display.wake_at().is_none() {
            break;
        }
    }
    let stats = rig.display.stats();
    assert!(stats.written.picture > 50_000 && stats.frames == 2, "{stats:?}");
    for (x, y) in [(28, 1), (91, 36), (60, 20)] {
        let wanted = frame("", 1)[(x, y)].fg;
        let Some(vt100::Color::Rgb(r, g, b)) = rig.terminal.screen().cell(y, x).map(vt100::Cell::fgcolor)
        else {
            panic!("no colour at {x}, {y}");
        };
        let blank = rig.terminal.screen().cell(y, x).unwrap().contents() == "▄";
        assert!(blank || wanted == Color::Rgb(r, g, b));
    }
}

#[test]
fn nothing_is_sent_and_nobody_is_woken_when_all_is_shown() {
    let mut rig = Rig::new(Settings { remote: false, ..SETTINGS });
    rig.present(&frame("still", 1));
    rig.settle();
    while rig.display.wake_at().is_some() {
        rig.now += Duration::from_millis(1);
        rig.display.acked(rig.now);
        rig.settle();
    }
    rig.writes.clear();
    rig.present(&frame("still", 1));
    rig.display.pump(rig.now);
    rig.settle();
    assert!(rig.writes.is_empty() && rig.display.wake_at().is_none());
}

#[test]
fn newest_wins_while_the_writer_is_busy() {
    let mut rig = Rig::new(SETTINGS);
    for n in 0..50 {
        rig.present(&frame(&format!("frame {n}"), n));
    }
    rig.settle();
    assert!(rig.text().starts_with("frame 49"));
    assert!(rig.display.stats().written.writes < 60);
}

#[test]
fn a_lost_reply_is_waited_for_until_wake_at() {
    let mut rig = Rig::new(SETTINGS);
    rig.present(&frame("lost", 1));
    rig.settle();
    for _ in 0..3 {
        let wake = rig.display.wake_at().expect("there is more to send");
        assert!(wake > rig.now && wake < rig.now + Duration::from_secs(4));
        rig.writes.clear();
        rig.now = wake;
        rig.display.pump(rig.now);
        rig.settle();
        assert!(!rig.writes.is_empty(), "the picture goes on");
    }
    assert!(rig.display.stats().mute);
}

#[test]
fn frames_of_another_size_are_dropped() {
    let mut rig = Rig::new(SETTINGS);
    rig.display.resize(100, 30);
    rig.present(&frame("too large", 1));
    rig.settle();
    assert!(rig.writes.is_empty());
    let small = Buffer::with_lines(["fits"]);
    let mut whole = Buffer::empty(Rect::new(0, 0, 100, 30));
    whole.merge(&small);
    rig.present(&whole);
    rig.settle();
    assert!(rig.text().starts_with("fits"));
}

#[test]
fn a_repaint_shows_the_same() {
    let mut rig = Rig::new(Settings { remote: false, ..SETTINGS });
    rig.present(&frame("again", 1));
    rig.settle();
    let before = rig.terminal.screen().contents_formatted();
    rig.terminal.process(b"\x1b[2J\x1b[5;5Hsomething else");
    rig.display.invalidate(rig.now);
    rig.settle();
    for _ in 0..1000 {
        rig.now += Duration::from_millis(1);
        rig.display.acked(rig.now);
        rig.settle();
    }
    assert!(rig.text().starts_with("again") && !rig.text().contains("something"));
    assert_eq!(rig.terminal.screen().contents_formatted().len(), before.len());
}

#[test]
fn farewell_removes_pictures_and_sends_nothing_more() {
    let mut rig = Rig::new(Settings { remote: false, ..SETTINGS });
    let area = Rect::new(0, 0, 4, 2);
    let data = Arc::new(encode(Protocol::Kitty, &[200; 32 * 32 * 4], (32, 32), area, usize::MAX).unwrap());
    let graphic = Graphic { generation: 1, area, layer: 0, data };
    let buffer = Buffer::empty(Rect::new(0, 0, 120, 40));
    rig.display.present(buffer, None, Order { first: Vec::new(), late: vec![area] }, vec![graphic], rig.now);
    rig.settle();
    let bytes = String::from_utf8(rig.display.farewell()).unwrap();
    assert!(bytes.contains("a=d,d=I,i=1"), "{bytes:?}");
    rig.display.pump(rig.now);
    rig.display.acked(rig.now);
    rig.writes.clear();
    rig.settle();
    assert!(rig.writes.is_empty() && rig.display.wake_at().is_none());
}

#[test]
fn bytes_beside_the_frames_come_once_and_whole() {
    let mut rig = Rig::new(SETTINGS);
    rig.present(&frame("frame", 1));
    // The writer is busy with the frame, or has just finished it.
    rig.display.beside(b"\x1b]52;c;bGluZGVu\x07", rig.now);
    let mut all = Vec::new();
    loop {
        while !rig.display.output().is_idle() {
            rig.done.recv_timeout(Duration::from_mins(1)).expect("a write ends");
        }
        let bytes = std::mem::take(&mut *rig.sink.0.lock().unwrap());
        if bytes.is_empty() {
            break;
        }
        all.push(bytes);
        rig.display.written(rig.now);
    }
    let all = all.concat();
    let found = all.windows(16).filter(|window| *window == b"\x1b]52;c;bGluZGVu\x07").count();
    assert_eq!(found, 1, "{:?}", String::from_utf8_lossy(&all));
}

#[test]
fn long_bytes_beside_the_frames_are_asked_after_like_any_others() {
    let mut rig = Rig::new(SETTINGS);
    let copied = format!("\x1b]52;c;{}\x07", "QUJD".repeat(200));
    rig.display.beside(copied.as_bytes(), rig.now);
    while !rig.display.output().is_idle() {
        rig.done.recv_timeout(Duration::from_mins(1)).expect("a write ends");
    }
    let written = std::mem::take(&mut *rig.sink.0.lock().unwrap());
    assert_eq!(written, [copied.as_bytes(), QUERY].concat());
    // Its answer is the only one that comes: nothing is left that is given up later.
    rig.display.acked(rig.now + Duration::from_millis(50));
    rig.display.pump(rig.now + Duration::from_mins(1));
    assert!(!rig.display.stats().mute);
}

#[test]
fn what_was_copied_last_goes_out_with_the_farewell() {
    let mut rig = Rig::new(SETTINGS);
    rig.present(&frame("one", 1));
    // If the first frame is still being written, this waits; if not, it went out at once.
    rig.display.beside(b"\x1b]52;c;QUJD\x07", rig.now);
    let waiting = rig.display.farewell();
    while !rig.display.output().is_idle() {
        rig.done.recv_timeout(Duration::from_mins(1)).expect("a write ends");
    }
    let written = [std::mem::take(&mut *rig.sink.0.lock().unwrap()), waiting].concat();
    assert_eq!(written.windows(4).filter(|part| part == b"QUJD").count(), 1);
}

#[test]
fn a_query_that_uses_the_pen_costs_the_next_frame_no_colour() {
    let mut rig = Rig::new(SETTINGS);
    for text in ["red", "redder"] {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 120, 40));
        buffer.set_string(0, 0, text, Style::new().fg(Color::Red));
        rig.present(&buffer);
        rig.settle();
        rig.display.beside(b"\x1b[48;2;12;34;56m\x1b[m", rig.now);
        rig.settle();
    }
    let colors: Vec<_> = (0..6).map(|x| rig.terminal.screen().cell(0, x).unwrap().fgcolor()).collect();
    assert_eq!(colors, [colors[0]; 6]);
    assert!(colors[0] != vt100::Color::Default);
}
