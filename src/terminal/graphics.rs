//! Pictures of pixels: how they are said to terminals that have them, and which one stands.
//!
//! [`encode`] is the work, and is done away from the main thread. What it gives is sent by
//! [`Screen`](crate::Screen): kitty's in pieces of any size, between which text may go; iTerm2's and
//! sixels in one piece, so they are sent only where the link takes them at once.
//!
//! The cells of a picture's area are blank as long as it stands, so that nothing shines through its
//! transparent parts. A new picture of kitty's is placed before the old one is deleted. One that something
//! lies over is taken off the screen and kept by the terminal. What kitty says it could not show, or
//! says nothing of where it did before, is sent again. There may be several at once, side by side.

mod canvas;
mod kitty;
mod pixels;

use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ratatui::layout::Rect;

use kitty::{PlaceReply, Transmission};
use pixels::Pixels;

pub(crate) use canvas::{Canvas, Placement};

use crate::grid::{Image, ImageError};

/// How pictures are said to a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// kitty's graphics protocol, with PNG.
    Kitty,
    /// iTerm2's inline pictures (OSC 1337), with PNG.
    Iterm2,
    /// DEC's sixels, 256 colours.
    Sixel,
}

/// A picture as a protocol says it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Encoded {
    protocol: Protocol,
    /// kitty: base64 of a PNG. Else a whole escape sequence.
    bytes: Vec<u8>,
    opaque: bool,
    width: u32,
    height: u32,
}

/// A picture of pixels over some cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graphic {
    /// Tells one picture from another.
    pub generation: u64,
    /// The cells that it covers.
    pub area: Rect,
    /// Pictures of a higher layer lie over those of lower ones, which the terminal keeps meanwhile, unseen.
    pub layer: u8,
    /// The picture.
    pub data: Arc<Encoded>,
}

/// A picture that could not be encoded.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// The pixels are not what the size says.
    #[error(transparent)]
    Size(#[from] ImageError),
    /// The PNG could not be written.
    #[error(
        "a picture of {width}×{height} pixels cannot be written as PNG: {source}; show it in cells instead"
    )]
    Png {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// What went wrong.
        source: png::EncodingError,
    },
    /// The sixels could not be made.
    #[error(
        "a picture of {width}×{height} pixels cannot be written as sixels: {source}; show it in cells instead"
    )]
    Sixel {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// What went wrong.
        source: icy_sixel::SixelError,
    },
}

impl Encoded {
    /// Bytes that showing it costs, without the few of its placement.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Whether there are none, which is never.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// How it is said.
    pub const fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// Pixels of the picture as it is sent: fewer than were given where the budget asked for it.
    pub const fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Bytes that show it in `area` from the cursor's line on, outside of a [`Screen`](crate::Screen);
    /// the cursor is on the line below then. `id` is kitty's number for it: an earlier picture of the same
    /// number vanishes.
    pub fn at_cursor(&self, id: u32, area: Rect) -> Vec<u8> {
        let rows = area.height;
        // Room first: a picture at the last line would scroll away, or be cut.
        let mut bytes = "\n".repeat(usize::from(rows)).into_bytes();
        bytes.extend_from_slice(format!("\x1b[{rows}A\x1b7").as_bytes());
        match self.protocol {
            Protocol::Kitty => {
                Transmission::new(id, 0).send(&self.bytes, usize::MAX, &mut bytes);
                kitty::place(id, area, PlaceReply::None, &mut bytes);
            }
            Protocol::Iterm2 | Protocol::Sixel => bytes.extend_from_slice(&self.bytes),
        }
        bytes.extend_from_slice(format!("\x1b8\x1b[{rows}B\r").as_bytes());
        bytes
    }

    /// Whether it comes in pieces, or in one that is not too large.
    pub(crate) fn may_be_sent(&self, atomic: usize) -> bool {
        self.protocol == Protocol::Kitty || self.bytes.len() <= atomic
    }
}

/// Says a picture (RGBA, sRGB, not premultiplied) in a protocol, for an area of cells.
///
/// Where more than `budget` bytes would be needed, a PNG gets 32 shades a channel, and if that is not
/// enough, fewer pixels, as many as fit: terminals stretch it over the area. Sixels cannot be stretched; they
/// get fewer colours, and may stay above the budget. Their height is cut to whole bands of 6, beyond which a
/// terminal would scroll.
///
/// # Errors
/// [`EncodeError`] when the pixels are not what the size says, or the encoder refuses them.
pub fn encode(
    protocol: Protocol,
    rgba: &[u8],
    (width, height): (u32, u32),
    area: Rect,
    budget: usize,
) -> Result<Encoded, EncodeError> {
    Image::new(width, height, rgba)?;
    let mut pixels = Pixels::new(width, height, rgba);
    let opaque = pixels.is_opaque();
    if protocol == Protocol::Sixel {
        let (bytes, height) = sixels(&pixels, budget)?;
        return Ok(Encoded { protocol, bytes, opaque, width, height });
    }
    let mut exact = true;
    loop {
        // Thin lines before nothing are best left unfiltered, soft gradients are not.
        let mut bytes = said(protocol, &pixels.png(png::Filter::NoFilter)?, area);
        if bytes.len() > budget && bytes.len() / 3 * 2 < budget {
            let filtered = said(protocol, &pixels.png(png::Filter::Adaptive)?, area);
            bytes = if filtered.len() < bytes.len() { filtered } else { bytes };
        }
        let (width, height) = (pixels.width, pixels.height);
        if bytes.len() <= budget || width.max(height) < 16 {
            return Ok(Encoded { protocol, bytes, opaque, width, height });
        }
        if !exact {
            // Thin lines become soft when they are reduced: bytes go down more slowly than the number
            // of pixels, about as its power 2/3.
            let share = budget as f64 / bytes.len() as f64;
            pixels = pixels.reduced(libm::pow(share, 0.75).clamp(0.2, 0.9))?;
        }
        pixels.coarsen();
        exact = false;
    }
}

/// A PNG as a protocol says it.
fn said(protocol: Protocol, png: &[u8], area: Rect) -> Vec<u8> {
    match protocol {
        Protocol::Iterm2 => inline_file(png, area),
        Protocol::Kitty | Protocol::Sixel => STANDARD.encode(png).into_bytes(),
    }
}

/// iTerm2's sequence (<https://iterm2.com/documentation-images.html>): the size in cells, stretched.
fn inline_file(png: &[u8], area: Rect) -> Vec<u8> {
    let mut bytes = format!(
        "\x1b]1337;File=inline=1;size={};width={};height={};preserveAspectRatio=0;doNotMoveCursor=1:",
        png.len(),
        area.width,
        area.height
    )
    .into_bytes();
    bytes.extend_from_slice(STANDARD.encode(png).as_bytes());
    bytes.push(b'\x07');
    bytes
}

/// The sequence, and how many rows of pixels it has.
fn sixels(pixels: &Pixels<'_>, budget: usize) -> Result<(Vec<u8>, u32), EncodeError> {
    const BAND: u32 = 6;
    let (width, height) = (pixels.width, (pixels.height / BAND * BAND).max(pixels.height.min(BAND)));
    let rows = &pixels.rgba[..width as usize * height as usize * 4];
    let refused = |source| EncodeError::Sixel { width, height, source };
    let image = icy_sixel::SixelImage::try_from_rgba(rows.to_vec(), width as usize, height as usize)
        .map_err(refused)?;
    let mut text = String::new();
    // Dithering breaks up the runs that sixels live from: less of it with fewer colours.
    for (max_colors, diffusion) in [(256, 0.5), (128, 0.0), (32, 0.0), (12, 0.0)] {
        let options = icy_sixel::EncodeOptions { max_colors, diffusion, ..Default::default() };
        text = image.encode_with(&options).map_err(refused)?;
        if text.len() <= budget {
            break;
        }
    }
    // The move to a next band would scroll a terminal whose last row the picture ends in.
    let cut = text.strip_suffix("$-\x1b\\").map(str::len);
    if let Some(kept) = cut {
        text.truncate(kept);
        text.push_str("\x1b\\");
    }
    Ok((text.into_bytes(), height))
}

#[cfg(test)]
#[path = "graphics/tests.rs"]
mod tests;
