//! How many colours a terminal shows, and the nearest of them.

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
    /// 5. `TERM` with `256`: 256. Without `TERM`: none on a terminal nobody has described.
    ///    Anything else: 16.
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
            Self::None => Color::Default,
            Self::Ansi16 => Color::Indexed(nearest_16(srgb)),
            Self::Ansi256 => Color::Indexed(nearest_256(srgb)),
            Self::True => Color::Rgb(srgb),
        }
    }
}

/// A colour as a terminal is told it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Color {
    /// The terminal's own.
    Default,
    /// An entry of the palette.
    Indexed(u8),
    /// sRGB.
    Rgb([u8; 3]),
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

/// The levels of the 6×6×6 cube, entries 16 to 231.
const CUBE: [u8; 6] = [0, 95, 135, 175, 215, 255];

fn distance(a: [u8; 3], b: [u8; 3]) -> u32 {
    (0..3).map(|i| u32::from(a[i].abs_diff(b[i])).pow(2)).sum()
}

fn nearest_16(srgb: [u8; 3]) -> u8 {
    (0..16).min_by_key(|&i| distance(srgb, ANSI_16[i as usize])).unwrap_or(0)
}

/// Among the entries 16 to 255. Squared distance adds up over the channels, so the nearest corner of
/// the cube is the nearest level of each channel, and the nearest grey the one nearest to the mean.
fn nearest_256(srgb: [u8; 3]) -> u8 {
    let level = srgb.map(|c| (0..6).min_by_key(|&i| c.abs_diff(CUBE[i as usize])).unwrap_or(0_u8));
    let corner = level.map(|i| CUBE[usize::from(i)]);
    // Greys 232 to 255 are 8, 18, … 238. Their nearest to three channels is the nearest to the
    // mean: 3 (g - 8) / 10, rounded, without a fraction.
    let sum: u32 = srgb.iter().map(|&c| u32::from(c)).sum();
    let step = (sum.saturating_sub(24) + 15) / 30;
    let step = step.min(23) as u8;
    if distance(srgb, [8 + 10 * step; 3]) < distance(srgb, corner) {
        232 + step
    } else {
        16 + 36 * level[0] + 6 * level[1] + level[2]
    }
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

    /// The palette as xterm's 256colres.pl computes it.
    fn palette(i: u8) -> [u8; 3] {
        if i >= 232 {
            return [(i - 232) * 10 + 8; 3];
        }
        let i = i - 16;
        [i / 36, i / 6 % 6, i % 6].map(|v| if v == 0 { 0 } else { v * 40 + 55 })
    }

    #[test]
    fn no_entry_of_the_palette_is_nearer() {
        for r in (0..=255_u8).step_by(5) {
            for g in (0..=255_u8).step_by(5) {
                for b in (0..=255_u8).step_by(5) {
                    let c = [r, g, b];
                    let best = (16..=255).map(|i| distance(c, palette(i))).min().unwrap();
                    let found = nearest_256(c);
                    assert_eq!(distance(c, palette(found)), best, "{c:?} became {found}");
                }
            }
        }
    }

    #[test]
    fn greys_are_found_too() {
        for g in 0..=255_u8 {
            let best = (16..=255).map(|i| distance([g; 3], palette(i))).min().unwrap();
            assert_eq!(distance([g; 3], palette(nearest_256([g; 3]))), best, "{g}");
        }
    }

    #[test]
    fn sixteen_colors_keep_their_own() {
        for (i, c) in ANSI_16.into_iter().enumerate() {
            assert_eq!(usize::from(nearest_16(c)), i);
        }
    }
}
