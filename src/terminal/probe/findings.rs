//! What to ask a terminal, and what it answered.

use super::environment::{Environment, Multiplexer};
use crate::input::Reply;
use crate::system::ANSWERS;
use crate::tty::WindowSize;

/// Whether it takes kitty's graphics: one pixel, stored nowhere
/// (<https://sw.kovidgoyal.net/kitty/graphics-protocol/#querying-support-and-available-transmission-mediums>).
const KITTY_GRAPHICS: &str = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\";
/// XTVERSION: its name.
const VERSION: &str = "\x1b[>0q";
/// OSC 11: its background.
const BACKGROUND: &str = "\x1b]11;?\x1b\\";
/// A background of 24 bits is set, DECRQSS asks what is in force, and all is reset.
const TRUE_COLOR: &str = "\x1b[48;2;12;34;56m\x1bP$qm\x1b\\\x1b[m";
/// The channels that [`TRUE_COLOR`] sets.
const TRUE_COLOR_CHANNELS: [&str; 3] = ["12", "34", "56"];
/// XTWINOPS 16: pixels of a cell.
const CELL_PIXELS: &str = "\x1b[16t";
/// DECRQM: whether it knows synchronized output.
const SYNCHRONIZED: &str = "\x1b[?2026$p";
/// DA1: what it can do. Every terminal answers this, and answers are in order, so it comes last.
const ATTRIBUTES: &str = "\x1b[c";

/// The mode of synchronized output.
const SYNCHRONIZED_MODE: u16 = 2026;
/// DA1's number for sixel graphics.
const SIXEL_ATTRIBUTE: u16 = 4;

/// The queries for a terminal, to be sent in one piece between two frames, after the first one. They
/// leave the rendition reset and the cursor where it was.
///
/// A terminal is spared what it is known to misunderstand: it would print it, or take it for
/// something else. Empty when it would understand nothing, or its answers would not reach us.
pub fn queries(environment: &Environment) -> Vec<u8> {
    if !ANSWERS {
        return Vec::new();
    }
    let queries: &[&str] = match (environment.multiplexer(), environment.term()) {
        // screen hands DCS on to the terminal as text, and shows APC in its status line.
        (Some((Multiplexer::Screen, _)), _) => &[VERSION, ATTRIBUTES],
        // tmux makes APC the pane's title; 2026 and 24 bits it answers for the outer terminal.
        (Some(_), _) => &[VERSION, BACKGROUND, CELL_PIXELS, ATTRIBUTES],
        (None, "" | "dumb") => &[],
        // The console has no strings, and prints some of them.
        (None, "linux") => &[ATTRIBUTES],
        // Prints APC and what stands behind the intermediate bytes of CSI.
        _ if environment.get("TERM_PROGRAM") == Some("Apple_Terminal") => &[BACKGROUND, ATTRIBUTES],
        _ => &[KITTY_GRAPHICS, VERSION, BACKGROUND, TRUE_COLOR, CELL_PIXELS, SYNCHRONIZED, ATTRIBUTES],
    };
    queries.concat().into_bytes()
}

/// The answers of a terminal so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    pub(super) attributes: Option<Vec<u16>>,
    pub(super) version: Option<String>,
    pub(super) background: Option<[u8; 3]>,
    pub(super) kitty_graphics: Option<bool>,
    pub(super) synchronized: Option<bool>,
    pub(super) rendition: Option<String>,
    pub(super) cell_px: Option<(u16, u16)>,
    pub(super) window_cell_px: Option<(u16, u16)>,
    gave_up: bool,
    /// And nothing was asked for.
    asked_nothing: bool,
}

/// Puts it in if nothing is there; whether it did.
fn first<T>(slot: &mut Option<T>, value: T) -> bool {
    let is_new = slot.is_none();
    slot.get_or_insert(value);
    is_new
}

/// A cell that a font can have: up to 256 pixels, at most four times as high as wide or twice as wide as
/// high. Pictures are as large as cells claim to be, and what claims others knows nothing.
fn plausible((width, height): (u16, u16)) -> Option<(u16, u16)> {
    let is_one = (1..=256).contains(&width)
        && (1..=256).contains(&height)
        && height <= 4 * width
        && width <= 2 * height;
    is_one.then_some((width, height))
}

impl Findings {
    /// Takes a reply; whether it says something new. The first of a kind counts: a terminal whose
    /// colours change while we run is not followed, and later replies may be to somebody else.
    pub fn take(&mut self, reply: &Reply) -> bool {
        match reply {
            Reply::Attributes(attributes) => first(&mut self.attributes, attributes.clone()),
            Reply::Version(version) => first(&mut self.version, version.clone()),
            Reply::Background(background) => first(&mut self.background, *background),
            Reply::KittyGraphics { ok, .. } => first(&mut self.kitty_graphics, *ok),
            Reply::Mode { number: SYNCHRONIZED_MODE, known } => first(&mut self.synchronized, *known),
            Reply::Rendition(rendition) => first(&mut self.rendition, rendition.clone()),
            Reply::CellPixels { width, height } => {
                plausible((*width, *height)).is_some_and(|cell| first(&mut self.cell_px, cell))
            }
            Reply::Status | Reply::Mode { .. } => false,
        }
    }

    /// Takes what the system knows of the window: its pixels, where the terminal tells none.
    pub fn take_window(&mut self, size: WindowSize) {
        self.window_cell_px = size.cell_px().and_then(plausible);
    }

    /// The time for answers is over. Those that come later still count.
    pub fn give_up(&mut self) {
        self.gave_up = true;
    }

    /// The terminal is not asked at all.
    pub fn ask_nothing(&mut self) {
        self.asked_nothing = true;
        self.give_up();
    }

    /// Whether it was not asked.
    pub fn has_asked_nothing(&self) -> bool {
        self.asked_nothing
    }

    /// Whether all answers are in: the last has come.
    pub fn is_complete(&self) -> bool {
        self.attributes.is_some()
    }

    /// Whether nothing is awaited any more.
    pub fn is_settled(&self) -> bool {
        self.is_complete() || self.gave_up
    }

    /// Whether the terminal says that it has sixel graphics.
    pub(super) fn has_sixel(&self) -> bool {
        // The first number is the class of terminal, not something that it can do.
        self.attributes.as_deref().is_some_and(|all| all.iter().skip(1).any(|n| *n == SIXEL_ATTRIBUTE))
    }

    /// Whether the colour of 24 bits is still one: others name the nearest entry of a palette.
    /// Between `48 2` and the channels a colour space may stand, or its empty place.
    pub(super) fn keeps_true_color(&self) -> bool {
        let Some(rendition) = &self.rendition else { return false };
        let numbers: Vec<&str> = rendition.split([';', ':']).collect();
        let begins = numbers.windows(2).position(|pair| pair == ["48", "2"]);
        begins.is_some_and(|at| {
            let rest = &numbers[at + 2..];
            [0, 1]
                .iter()
                .any(|skipped| rest.get(*skipped..).is_some_and(|r| r.starts_with(&TRUE_COLOR_CHANNELS)))
        })
    }
}
