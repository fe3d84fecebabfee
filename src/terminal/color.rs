//! How many colours a terminal shows, and the nearest of them.

use std::sync::LazyLock;

use ratatui::style::Color;

use crate::grid::decode;

/// How colours are said to a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColorDepth {
    /// Not at all: no escape sequence is written.
    None,
    /// The 16 colours of the user's theme.
    Ansi16,
    /// xterm's 256 colours.
    Ansi256,
    /// 24 bits.
    True,
}

impl ColorDepth {
    /// What the environment says. In this order:
    ///
    /// 1. `NO_COLOR` that is not empty: none (<https://no-color.org>).
    /// 2. `FORCE_COLOR` = 0..3, `CLICOLOR_FORCE` that is neither empty nor `0`: colours even
    ///    where no terminal is; `FORCE_COLOR`'s number is the depth.
    /// 3. No terminal, `TERM=dumb`, or `CLICOLOR=0`: none.
    /// 4. `COLORTERM` = `truecolor` or `24bit`; `TERM` that ends in `-direct`; `WT_SESSION`: 24 bits.
    /// 5. `TERM` with `256`: 256. Without `TERM`: none, since the terminal is unknown. Anything else: 16.
    pub fn detect(lookup: impl Fn(&str) -> Option<String>, is_terminal: bool) -> Self {
        let set = |name: &str| lookup(name).filter(|v| !v.is_empty());
        if set("NO_COLOR").is_some() {
            return Self::None;
        }
        let forced = match set("FORCE_COLOR").as_deref() {
            Some("0" | "false") => return Self::None,
            Some("1") => return Self::Ansi16,
            Some("2") => return Self::Ansi256,
            Some("3") => return Self::True,
            Some(_) => true,
            None => set("CLICOLOR_FORCE").is_some_and(|v| v != "0"),
        };
        let term = set("TERM");
        if !forced {
            let unwanted = set("CLICOLOR").is_some_and(|v| v == "0");
            if !is_terminal || unwanted || term.as_deref() == Some("dumb") {
                return Self::None;
            }
        }
        let color_term = set("COLORTERM").is_some_and(|v| matches!(v.as_str(), "truecolor" | "24bit"));
        match term.as_deref() {
            _ if color_term || set("WT_SESSION").is_some() => Self::True,
            Some(t) if t.ends_with("-direct") => Self::True,
            Some(t) if t.contains("256") => Self::Ansi256,
            None if !forced => Self::None,
            _ => Self::Ansi16,
        }
    }

    /// The nearest colour that this depth has.
    pub(crate) fn nearest(self, srgb: [u8; 3]) -> Color {
        match self {
            Self::None => Color::Reset,
            Self::Ansi16 => Color::Indexed(nearest_16(srgb)),
            Self::Ansi256 => Color::Indexed(nearest_256(srgb)),
            Self::True => Color::Rgb(srgb[0], srgb[1], srgb[2]),
        }
    }

    /// The nearest colour that this depth has: [`Color::Reset`], [`Color::Indexed`] or [`Color::Rgb`].
    /// The names of the 16 become their entries.
    pub(crate) fn map(self, color: Color) -> Color {
        let entry = match color {
            Color::Reset => return Color::Reset,
            _ if self == Self::None => return Color::Reset,
            Color::Rgb(r, g, b) => return self.nearest([r, g, b]),
            Color::Indexed(entry) if entry >= 16 && self == Self::Ansi16 => nearest_16(xterm(entry)),
            Color::Indexed(entry) => entry,
            Color::Black => 0,
            Color::Red => 1,
            Color::Green => 2,
            Color::Yellow => 3,
            Color::Blue => 4,
            Color::Magenta => 5,
            Color::Cyan => 6,
            Color::Gray => 7,
            Color::DarkGray => 8,
            Color::LightRed => 9,
            Color::LightGreen => 10,
            Color::LightYellow => 11,
            Color::LightBlue => 12,
            Color::LightMagenta => 13,
            Color::LightCyan => 14,
            Color::White => 15,
        };
        Color::Indexed(entry)
    }
}

/// Appends the parameters of "select graphic rendition" for a colour (ECMA-48 8.3.117; ISO 8613-6
/// for 38 and 48). `base` is 30 for ink, 40 for paper. The colour is one that [`ColorDepth`] gave.
pub(crate) fn push_color(out: &mut Vec<u8>, color: Color, base: u8) {
    match color {
        Color::Indexed(entry @ 0..8) => push_number(out, (base + entry).into()),
        Color::Indexed(entry @ 8..16) => push_number(out, (base + 52 + entry).into()),
        Color::Indexed(entry) => {
            push_number(out, (base + 8).into());
            out.extend_from_slice(b";5;");
            push_number(out, entry.into());
        }
        Color::Rgb(r, g, b) => {
            push_number(out, (base + 8).into());
            out.extend_from_slice(b";2;");
            push_number(out, r.into());
            out.push(b';');
            push_number(out, g.into());
            out.push(b';');
            push_number(out, b.into());
        }
        _ => push_number(out, (base + 9).into()),
    }
}

/// Appends a decimal number.
pub(crate) fn push_number(out: &mut Vec<u8>, number: u16) {
    let mut divisor = 10_000;
    while divisor > 1 && number < divisor {
        divisor /= 10;
    }
    while divisor > 0 {
        out.push(b'0' + (number / divisor % 10) as u8);
        divisor /= 10;
    }
}

/// xterm's first 16 colours. Themes change them, so they are used only where there are no others.
const ANSI_16: [[u8; 3]; 16] = [
    [0, 0, 0],
    [205, 0, 0],
    [0, 205, 0],
    [205, 205, 0],
    [0, 0, 238],
    [205, 0, 205],
    [0, 205, 205],
    [229, 229, 229],
    [127, 127, 127],
    [255, 0, 0],
    [0, 255, 0],
    [255, 255, 0],
    [92, 92, 255],
    [255, 0, 255],
    [0, 255, 255],
    [255, 255, 255],
];

/// xterm's entries from 16 on: a 6×6×6 cube, then 24 greys. Themes leave them alone.
fn xterm(entry: u8) -> [u8; 3] {
    const LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];
    if entry >= 232 {
        return [8 + 10 * (entry - 232); 3];
    }
    let at = usize::from(entry.saturating_sub(16));
    [LEVELS[at / 36], LEVELS[at / 6 % 6], LEVELS[at % 6]]
}

/// Whether a colour is one of the bright half of the 16.
pub(crate) const fn is_bright(color: Color) -> bool {
    matches!(color, Color::Indexed(8..16))
}

/// How a colour looks that [`ColorDepth`] gave; `None` for the terminal's default, which may be any.
pub(crate) fn look(color: Color) -> Option<[u8; 3]> {
    match color {
        Color::Rgb(r, g, b) => Some([r, g, b]),
        Color::Indexed(entry @ 0..16) => Some(ANSI_16[usize::from(entry)]),
        Color::Indexed(entry) => Some(xterm(entry)),
        _ => None,
    }
}

/// A palette by how its colours look.
struct Palette {
    first: u8,
    looks: Vec<[f32; 3]>,
}

impl Palette {
    fn new(first: u8, colors: Vec<[u8; 3]>) -> Self {
        Self { first, looks: colors.into_iter().map(oklab).collect() }
    }

    /// The entry that looks nearest. In sRGB the nearest of few colours is often of another hue, and
    /// bark turns into patches of green and pink.
    fn nearest(&self, srgb: [u8; 3]) -> u8 {
        let wanted = oklab(srgb);
        let (mut best, mut least) = (0, f32::INFINITY);
        for (i, &look) in self.looks.iter().enumerate() {
            let distance = difference(wanted, look);
            if distance < least {
                (best, least) = (i, distance);
            }
        }
        self.first + best as u8
    }
}

/// How much more a difference in hue and chroma counts than one in lightness.
pub(crate) const HUE_WEIGHT: f32 = 2.0;

/// How much two colours differ to the eye, squared; both as [`oklab_of_light`] gives them.
pub(crate) fn difference(one: [f32; 3], other: [f32; 3]) -> f32 {
    let [l, a, b]: [f32; 3] = std::array::from_fn(|i| one[i] - other[i]);
    l * l + HUE_WEIGHT * (a * a + b * b)
}

/// How the entries of a palette look: all 16, or those of the 256 that themes leave alone; none where any colour can
/// be had.
pub(crate) fn palette(colors: ColorDepth) -> Vec<[u8; 3]> {
    match colors {
        ColorDepth::Ansi16 => ANSI_16.to_vec(),
        ColorDepth::Ansi256 => (16..=255).map(xterm).collect(),
        ColorDepth::None | ColorDepth::True => Vec::new(),
    }
}

fn nearest_16(srgb: [u8; 3]) -> u8 {
    static PALETTE: LazyLock<Palette> = LazyLock::new(|| Palette::new(0, palette(ColorDepth::Ansi16)));
    PALETTE.nearest(srgb)
}

fn nearest_256(srgb: [u8; 3]) -> u8 {
    static PALETTE: LazyLock<Palette> = LazyLock::new(|| Palette::new(16, palette(ColorDepth::Ansi256)));
    PALETTE.nearest(srgb)
}

/// Lightness, green-red and blue-yellow (Björn Ottosson 2020, "A perceptual color space for image
/// processing").
fn oklab(srgb: [u8; 3]) -> [f32; 3] {
    static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| decode(i as f32 / 255.0)));
    oklab_of_light(srgb.map(|c| LIGHT[usize::from(c)]))
}

/// As [`oklab`], of linear light.
pub(crate) fn oklab_of_light([r, g, b]: [f32; 3]) -> [f32; 3] {
    let l = libm::cbrtf(0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b);
    let m = libm::cbrtf(0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b);
    let s = libm::cbrtf(0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b);
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(env: &[(&str, &str)], is_terminal: bool) -> ColorDepth {
        let lookup = |name: &str| env.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned());
        ColorDepth::detect(lookup, is_terminal)
    }

    #[test]
    fn environments() {
        use ColorDepth::{Ansi16, Ansi256, None, True};
        let xterm = ("TERM", "xterm-256color");
        for (env, is_terminal, expected) in [
            (&[xterm][..], true, Ansi256),
            (&[xterm], false, None),
            (&[xterm, ("COLORTERM", "truecolor")], true, True),
            (&[xterm, ("COLORTERM", "24bit")], true, True),
            (&[xterm, ("COLORTERM", "yes")], true, Ansi256),
            (&[xterm, ("COLORTERM", "truecolor"), ("NO_COLOR", "1")], true, None),
            (&[xterm, ("NO_COLOR", "")], true, Ansi256),
            (&[("NO_COLOR", "1"), ("FORCE_COLOR", "3")], true, None),
            (&[("FORCE_COLOR", "3")], false, True),
            (&[("FORCE_COLOR", "2")], false, Ansi256),
            (&[xterm, ("FORCE_COLOR", "0")], true, None),
            (&[xterm, ("CLICOLOR_FORCE", "1")], false, Ansi256),
            (&[xterm, ("CLICOLOR_FORCE", "0")], false, None),
            (&[("CLICOLOR_FORCE", "1")], false, Ansi16),
            (&[xterm, ("CLICOLOR", "0")], true, None),
            (&[("TERM", "dumb")], true, None),
            (&[("TERM", "linux")], true, Ansi16),
            (&[("TERM", "xterm-direct")], true, True),
            (&[("WT_SESSION", "6f")], true, True),
            (&[], true, None),
        ] {
            assert_eq!(depth(env, is_terminal), expected, "{env:?} {is_terminal}");
        }
    }

    /// CIE L*a*b* by its definition (white D65): the palette's choice is judged by another metric
    /// than the one that made it.
    fn lab(srgb: [u8; 3]) -> [f64; 3] {
        let [r, g, b] = srgb.map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
        });
        let f =
            |t: f64| if t > 216.0 / 24389.0 { libm::cbrt(t) } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
        let x = f((0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47);
        let y = f(0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b);
        let z = f((0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b) / 1.088_83);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    fn difference(a: [u8; 3], b: [u8; 3]) -> f64 {
        let (a, b) = (lab(a), lab(b));
        libm::sqrt((0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum())
    }

    /// The palette as xterm's 256colres.pl computes it.
    fn palette(i: u8) -> [u8; 3] {
        if i >= 232 {
            return [(i - 232) * 10 + 8; 3];
        }
        let i = i - 16;
        [i / 36, i / 6 % 6, i % 6].map(|v| if v == 0 { 0 } else { v * 40 + 55 })
    }

    #[test]
    fn the_palette_is_xterms() {
        for i in 16..=255 {
            assert_eq!(xterm(i), palette(i), "{i}");
            assert_eq!(palette(nearest_256(palette(i))), palette(i), "{i} is its own nearest");
        }
    }

    #[test]
    fn entries_look_nearest() {
        let (mut worst, mut excess, mut n) = (0.0_f64, 0.0, 0.0);
        for at in 0..16_u32.pow(3) {
            let c = [at / 256, at / 16 % 16, at % 16].map(|v| (v * 17) as u8);
            let best = (16..=255).map(|i| difference(c, palette(i))).fold(f64::INFINITY, f64::min);
            let found = difference(c, palette(nearest_256(c)));
            worst = worst.max(found - best);
            excess += found - best;
            n += 1.0;
        }
        // Two metrics of sight disagree somewhat; a wrong entry would be 20 to 100 away.
        assert!(excess / n < 2.5, "mean excess {}", excess / n);
        assert!(worst < 25.0, "worst excess {worst}");
    }

    #[test]
    fn oklab_of_known_colors() {
        // CSS Color 4, sample conversions: red and white.
        for (c, expected) in [([255, 0, 0], [0.627_96, 0.224_86, 0.125_85]), ([255; 3], [1.0, 0.0, 0.0])] {
            let found = oklab(c);
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-3), "{found:?}");
        }
    }

    #[test]
    fn sixteen_colors_keep_their_own() {
        for (i, c) in ANSI_16.into_iter().enumerate() {
            assert_eq!(usize::from(nearest_16(c)), i);
        }
    }
}
