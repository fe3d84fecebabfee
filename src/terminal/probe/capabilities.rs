//! What follows from what is known of a terminal.

use std::fmt;

use super::environment::{Environment, Multiplexer, printable};
use super::findings::Findings;
use super::overrides::Overrides;
use crate::cells::Glyphs;
use crate::color::ColorDepth;

/// How pictures get to the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Graphics {
    /// kitty's protocol.
    Kitty,
    /// Sixel.
    Sixel,
    /// iTerm2's inline images.
    Iterm2,
    /// As characters.
    Cells,
}

impl fmt::Display for Graphics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Kitty => "kitty",
            Self::Sixel => "sixel",
            Self::Iterm2 => "iterm2",
            Self::Cells => "cells",
        })
    }
}

/// A conclusion and its reason, which is safe to show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Told<T> {
    /// The conclusion.
    pub value: T,
    /// From what.
    pub why: String,
}

impl<T> Told<T> {
    fn new(value: T, why: impl Into<String>) -> Self {
        Self { value, why: why.into() }
    }
}

/// The capabilities of a terminal, and how each is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Its name and version, safe to show.
    pub name: Told<String>,
    /// How pictures get there.
    pub graphics: Told<Graphics>,
    /// Which characters pictures are made of, where they are made of characters.
    pub glyphs: Told<Glyphs>,
    /// Whether it shows more than ASCII.
    pub unicode: Told<bool>,
    /// How many colours it has.
    pub colors: Told<ColorDepth>,
    /// Its background, sRGB, if it says.
    pub background: Told<Option<[u8; 3]>>,
    /// Whether its background is dark.
    pub dark: Told<bool>,
    /// Pixels of a cell, across and down, if known.
    pub cell_px: Told<Option<(u16, u16)>>,
    /// Whether it shows a frame at once when asked to (mode 2026).
    pub synchronized: Told<bool>,
    /// Whether it is at the other end of a network.
    pub remote: Told<bool>,
    /// The multiplexer between us and the terminal.
    pub multiplexer: Told<Option<Multiplexer>>,
}

impl Capabilities {
    /// Concludes from all that is known. Before any answer these are capabilities to rely on.
    pub fn conclude(findings: &Findings, environment: &Environment, overrides: &Overrides) -> Self {
        let known = Known::new(findings, environment);
        let colors = overrides.colors.clone().unwrap_or_else(|| known.colors());
        let (graphics, forced_glyphs) = match &overrides.graphics {
            Some(forced) => {
                let (graphics, glyphs) = forced.value;
                let glyphs = glyphs.map(|glyphs| Told::new(glyphs, forced.why.clone()));
                (Told::new(graphics, forced.why.clone()), glyphs)
            }
            None if colors.value == ColorDepth::None => {
                (Told::new(Graphics::Cells, "pictures have colours, and there are to be none"), None)
            }
            None => (known.graphics(), None),
        };
        let unicode = match &forced_glyphs {
            Some(forced) => Told::new(forced.value != Glyphs::Ascii, forced.why.clone()),
            None => known.unicode(),
        };
        let glyphs = forced_glyphs.unwrap_or_else(|| known.glyphs(colors.value, &unicode));
        Self {
            name: known.name(),
            graphics,
            glyphs,
            unicode,
            colors,
            background: known.background(),
            dark: known.dark(),
            cell_px: known.cell_px(),
            synchronized: known.synchronized(),
            remote: known.remote(),
            multiplexer: known.multiplexer.clone(),
        }
    }

    /// The lines of a report: each a capability, the conclusion and its reason.
    pub fn rows(&self) -> [(&'static str, String, &str); 11] {
        let glyphs = match self.glyphs.value {
            Glyphs::Quadrants => "quadrants",
            Glyphs::Halves => "halves",
            Glyphs::Braille => "braille",
            Glyphs::Ascii => "ascii",
        };
        let colors = match self.colors.value {
            ColorDepth::True => "truecolor",
            ColorDepth::Ansi256 => "256",
            ColorDepth::Ansi16 => "16",
            ColorDepth::None => "none",
        };
        let yes_no = |yes| if yes { "yes" } else { "no" }.to_owned();
        let unknown = || "unknown".to_owned();
        let background = self.background.value.map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
        let cell = self.cell_px.value.map(|(width, height)| format!("{width}×{height} px"));
        let multiplexer = self.multiplexer.value.map(|multiplexer| multiplexer.to_string());
        [
            ("terminal", self.name.value.clone(), &self.name.why),
            ("multiplexer", multiplexer.unwrap_or_else(|| "none".to_owned()), &self.multiplexer.why),
            ("remote", yes_no(self.remote.value), &self.remote.why),
            ("pictures", self.graphics.value.to_string(), &self.graphics.why),
            ("characters", glyphs.to_owned(), &self.glyphs.why),
            ("unicode", yes_no(self.unicode.value), &self.unicode.why),
            ("colours", colors.to_owned(), &self.colors.why),
            ("background", background.unwrap_or_else(unknown), &self.background.why),
            ("dark", yes_no(self.dark.value), &self.dark.why),
            ("cell", cell.unwrap_or_else(unknown), &self.cell_px.why),
            ("synchronized", yes_no(self.synchronized.value), &self.synchronized.why),
        ]
    }
}

/// A program that is known by its name.
struct Program {
    /// How XTVERSION or the environment begin, in lower case.
    prefix: &'static str,
    /// Whether it has 24-bit colours in every version that says its name.
    true_color: bool,
    /// Whether it has iTerm2's inline images.
    inline_images: bool,
}

/// What answers, or sets variables, by these names.
const PROGRAMS: [Program; 13] = {
    const fn program(prefix: &'static str, true_color: bool, inline_images: bool) -> Program {
        Program { prefix, true_color, inline_images }
    }
    [
        program("contour", true, false),
        program("foot", true, false),
        program("ghostty", true, false),
        // `iTerm2 3.5` and `iTerm.app`.
        program("iterm", true, true),
        program("kitty", true, false),
        program("konsole", true, false),
        program("mintty", true, true),
        program("rio", true, true),
        program("vscode", true, false),
        program("vte", true, false),
        program("wezterm", true, true),
        program("windows terminal", true, false),
        program("xterm.js", true, false),
    ]
};

fn program(name: &str) -> Option<&'static Program> {
    let name = name.to_ascii_lowercase();
    PROGRAMS.iter().find(|program| name.starts_with(program.prefix))
}

/// What is known, and what is between us and the terminal, on which most conclusions hang.
struct Known<'a> {
    findings: &'a Findings,
    environment: &'a Environment,
    multiplexer: Told<Option<Multiplexer>>,
}

impl<'a> Known<'a> {
    fn new(findings: &'a Findings, environment: &'a Environment) -> Self {
        let version = findings.version.as_deref().unwrap_or_default();
        let says = |multiplexer| Told::new(Some(multiplexer), format!("it says {}", printable(version)));
        let multiplexer = if version.starts_with("tmux") {
            says(Multiplexer::Tmux)
        } else if version.to_ascii_lowercase().starts_with("zellij") {
            says(Multiplexer::Zellij)
        } else {
            match environment.multiplexer() {
                Some((multiplexer, why)) => Told::new(Some(multiplexer), why),
                None => Told::new(None, "neither the environment nor the terminal says so"),
            }
        };
        Self { findings, environment, multiplexer }
    }

    /// Why there is no answer.
    fn unanswered(&self) -> &'static str {
        if self.findings.has_asked_nothing() {
            "the terminal was not asked"
        } else if self.findings.is_complete() {
            "the terminal does not say"
        } else if self.findings.is_settled() {
            "the terminal did not answer in time"
        } else {
            "the terminal has not answered yet"
        }
    }

    fn name(&self) -> Told<String> {
        if let Some(version) = &self.findings.version {
            return Told::new(printable(version), "the terminal says so (XTVERSION)");
        }
        if let Some((name, why)) = self.environment.program() {
            return Told::new(printable(&name), why);
        }
        match self.environment.get("TERM") {
            Some(term) => Told::new(printable(term), "TERM"),
            None => Told::new("unknown".to_owned(), "TERM is not set"),
        }
    }

    /// The program whose protocols may be used, and how it is known: what answered, or what the
    /// environment names when the terminal answers but has no name.
    fn program(&self) -> Option<(&'static Program, String)> {
        if self.multiplexer.value.is_some() || !self.findings.is_complete() {
            return None;
        }
        match &self.findings.version {
            Some(version) => Some((program(version)?, format!("it says {}", printable(version)))),
            None => {
                let (name, why) = self.environment.program()?;
                Some((program(&name)?, why))
            }
        }
    }

    fn graphics(&self) -> Told<Graphics> {
        let sixel = || Told::new(Graphics::Sixel, "the terminal says so (DA1: 4)");
        if let Some(multiplexer) = self.multiplexer.value {
            // Of the three, screen has no sixel of its own, whatever comes through it.
            return if self.findings.has_sixel() && multiplexer != Multiplexer::Screen {
                Told::new(Graphics::Sixel, format!("{multiplexer} itself says so (DA1: 4)"))
            } else if self.findings.is_complete() {
                Told::new(Graphics::Cells, format!("{multiplexer} does not say that it passes pictures on"))
            } else {
                Told::new(Graphics::Cells, self.unanswered())
            };
        }
        if self.findings.kitty_graphics == Some(true) {
            return Told::new(Graphics::Kitty, "the terminal says so (kitty graphics query: OK)");
        }
        match self.program() {
            Some((program, why)) if program.inline_images => Told::new(Graphics::Iterm2, why),
            _ if self.findings.has_sixel() => sixel(),
            _ if self.findings.is_complete() => {
                Told::new(Graphics::Cells, "the terminal says of no protocol that it has it")
            }
            _ => Told::new(Graphics::Cells, self.unanswered()),
        }
    }

    /// Only what is said counts: where no variable is set, as in most containers, terminals show Unicode
    /// all the same.
    fn unicode(&self) -> Told<bool> {
        if self.environment.term() == "dumb" {
            return Told::new(false, self.environment.quote("TERM"));
        }
        let locale =
            ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find(|name| self.environment.get(name).is_some());
        let Some(name) = locale else { return Told::new(true, "no variable of the locale says otherwise") };
        let value = self.environment.get(name).unwrap_or_default();
        let charset = value.split_once('.').map(|(_, charset)| charset.split('@').next().unwrap_or_default());
        let shows = match charset {
            Some(charset) => charset.replace('-', "").eq_ignore_ascii_case("utf8"),
            None => !matches!(value, "C" | "POSIX"),
        };
        Told::new(shows, self.environment.quote(name))
    }

    fn glyphs(&self, colors: ColorDepth, unicode: &Told<bool>) -> Told<Glyphs> {
        if !unicode.value {
            Told::new(Glyphs::Ascii, unicode.why.clone())
        } else if colors == ColorDepth::None {
            Told::new(Glyphs::Braille, "without colours dots show most")
        } else if self.environment.term() == "linux" {
            Told::new(Glyphs::Halves, "the console's fonts have no quadrants")
        } else {
            Told::new(Glyphs::Quadrants, "nearly every font has them")
        }
    }

    fn colors(&self) -> Told<ColorDepth> {
        let environment = self.environment;
        let detected = ColorDepth::detect(|name| environment.get(name).map(str::to_owned), true);
        // What the user has said to all programs alike.
        if let Some(why) = environment.quote_first(&["NO_COLOR", "FORCE_COLOR"]) {
            return Told::new(detected, why);
        }
        match detected {
            ColorDepth::None => {
                let why = environment.quote_first(&["CLICOLOR"]);
                Told::new(detected, why.unwrap_or_else(|| environment.quote("TERM")))
            }
            ColorDepth::True if self.multiplexer.value == Some(Multiplexer::Screen) => Told::new(
                ColorDepth::Ansi256,
                "screen hands COLORTERM on from outside, whether or not it has the colours",
            ),
            ColorDepth::True => {
                let why = environment
                    .quote_first(&["COLORTERM"])
                    .filter(|_| matches!(environment.get("COLORTERM"), Some("truecolor" | "24bit")));
                let why =
                    why.or_else(|| environment.get("WT_SESSION").map(|_| "WT_SESSION is set".to_owned()));
                Told::new(detected, why.unwrap_or_else(|| environment.quote("TERM")))
            }
            _ if self.multiplexer.value.is_none() && self.findings.keeps_true_color() => {
                Told::new(ColorDepth::True, "the terminal keeps 24 bits (DECRQSS)")
            }
            _ => match self.program() {
                Some((program, why)) if program.true_color => Told::new(ColorDepth::True, why),
                _ => Told::new(detected, environment.quote("TERM")),
            },
        }
    }

    fn background(&self) -> Told<Option<[u8; 3]>> {
        match self.findings.background {
            Some(background) => Told::new(Some(background), "the terminal says so (OSC 11)"),
            None => Told::new(None, self.unanswered()),
        }
    }

    fn dark(&self) -> Told<bool> {
        if let Some([r, g, b]) = self.findings.background {
            // Rec. 601 luma, in thousandths.
            let luma = 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
            return Told::new(luma < 128_000, "its background");
        }
        // rxvt's `15;0` or `15;default;0`: entries of the palette, the last is the background.
        let entry =
            self.environment.get("COLORFGBG").and_then(|colors| colors.rsplit(';').next()?.parse().ok());
        match entry {
            Some(entry @ 0..=15) => {
                Told::new(matches!(entry, 0..=6 | 8), self.environment.quote("COLORFGBG"))
            }
            _ => Told::new(true, "most are, and this one does not say"),
        }
    }

    fn cell_px(&self) -> Told<Option<(u16, u16)>> {
        match (self.findings.cell_px, self.findings.window_cell_px) {
            (Some(cell), _) => Told::new(Some(cell), "the terminal says so (XTWINOPS 16)"),
            (None, Some(cell)) => Told::new(Some(cell), "the system knows the window's pixels (TIOCGWINSZ)"),
            (None, None) => Told::new(None, self.unanswered()),
        }
    }

    fn synchronized(&self) -> Told<bool> {
        match (self.multiplexer.value, self.findings.synchronized) {
            (Some(multiplexer), _) => {
                Told::new(false, format!("{multiplexer} would speak for the terminal outside"))
            }
            (None, Some(true)) => Told::new(true, "the terminal says so (DECRQM 2026)"),
            (None, Some(false)) => Told::new(false, "the terminal says so (DECRQM 2026)"),
            (None, None) => Told::new(false, self.unanswered()),
        }
    }

    fn remote(&self) -> Told<bool> {
        let variables = ["SSH_CONNECTION", "SSH_TTY", "SSH_CLIENT"];
        match variables.iter().find(|name| self.environment.get(name).is_some()) {
            Some(name) => Told::new(true, format!("{name} is set")),
            None => Told::new(false, "no variable of SSH is set"),
        }
    }
}
