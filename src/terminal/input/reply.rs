//! Replies that are strings: DCS, OSC, APC.

use super::Reply;

/// The strings of ECMA-48, by what introduces them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StringKind {
    /// `ESC ]`
    Osc,
    /// `ESC P`
    Dcs,
    /// `ESC _`
    Apc,
    /// PM `ESC ^` and SOS `ESC X`, whichever introduced it: nothing in them is for us.
    Other(u8),
}

impl StringKind {
    pub fn introduced_by(byte: u8) -> Option<Self> {
        Some(match byte {
            b']' => Self::Osc,
            b'P' => Self::Dcs,
            b'_' => Self::Apc,
            b'^' | b'X' => Self::Other(byte),
            _ => return None,
        })
    }

    pub fn introducer(self) -> u8 {
        match self {
            Self::Osc => b']',
            Self::Dcs => b'P',
            Self::Apc => b'_',
            Self::Other(byte) => byte,
        }
    }
}

/// What a string says, without its introducer and terminator.
pub(super) fn decode(kind: StringKind, body: &[u8]) -> Option<Reply> {
    match kind {
        StringKind::Osc => background(body),
        StringKind::Dcs => device_control(body),
        StringKind::Apc => graphics(body),
        StringKind::Other(_) => None,
    }
}

/// XTVERSION `> | text` and DECRQSS `1 $ r … m` (xterm ctlseqs, "Device-Control functions").
fn device_control(body: &[u8]) -> Option<Reply> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if let Some(version) = body.strip_prefix(b">|") {
        return Some(Reply::Version(text(version)));
    }
    let rendition = body.strip_prefix(b"1$r")?.strip_suffix(b"m")?;
    Some(Reply::Rendition(text(rendition)))
}

/// OSC 11 as XParseColor(3) writes colours: `rgb:` with one to four hexadecimal digits each.
fn background(body: &[u8]) -> Option<Reply> {
    let color = std::str::from_utf8(body.strip_prefix(b"11;")?).ok()?;
    let (rgb, channels) = match (color.strip_prefix("rgb:"), color.strip_prefix("rgba:")) {
        (Some(rgb), _) => (rgb, 3),
        (None, Some(rgba)) => (rgba, 4),
        _ => return None,
    };
    let values: Vec<u8> = rgb.split('/').map(channel).collect::<Option<_>>()?;
    (values.len() == channels).then(|| Reply::Background([values[0], values[1], values[2]]))
}

/// A channel of as many digits as there are, as 8 bits.
fn channel(digits: &str) -> Option<u8> {
    if !matches!(digits.len(), 1..=4) || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let value = u32::from_str_radix(digits, 16).ok()?;
    let most = (1_u32 << (4 * digits.len())) - 1;
    Some(((value * 255 + most / 2) / most) as u8)
}

/// `Gi=31,p=1;OK`, or a reason instead of OK
/// (<https://sw.kovidgoyal.net/kitty/graphics-protocol/#querying-support-and-available-transmission-mediums>).
fn graphics(body: &[u8]) -> Option<Reply> {
    let body = body.strip_prefix(b"G")?;
    let message = body.iter().position(|byte| *byte == b';')?;
    let keys = std::str::from_utf8(&body[..message]).ok()?;
    let id = keys.split(',').find_map(|key| key.strip_prefix("i=")?.parse().ok()).unwrap_or_default();
    Some(Reply::KittyGraphics { id, ok: &body[message + 1..] == b"OK" })
}
