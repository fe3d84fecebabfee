//! kitty's graphics protocol (<https://sw.kovidgoyal.net/kitty/graphics-protocol/>).
//!
//! Every command asks for silence (`q=2`) but one: the placement of a picture on a screen that is ours, whose reply
//! says whether it is there. Outside of it a reply that comes late would be typed.
//!
//! No command goes into a synchronized update (private mode 2026): what kitty holds back during one it reads again
//! afterwards, and now and then fails at a picture (seen in 0.26.5; the picture is gone then).

use ratatui::layout::Rect;

/// The most that a chunk may carry.
const LARGEST_CHUNK: usize = 4096;
/// Less is not worth a chunk's frame.
const SMALLEST_CHUNK: usize = 256;
/// What is around a chunk, at most.
const FRAME: usize = 40;

/// A picture that is being sent. Between its chunks nothing else of this protocol may be said.
#[derive(Debug)]
pub(super) struct Transmission {
    pub id: u32,
    pub generation: u64,
    sent: usize,
}

impl Transmission {
    pub fn new(id: u32, generation: u64) -> Self {
        Self { id, generation, sent: 0 }
    }

    /// Sends as many chunks as are allowed of a picture in base64. Whether it is finished.
    pub fn send(&mut self, base64: &[u8], allowed: usize, out: &mut Vec<u8>) -> bool {
        let end = out.len().saturating_add(allowed);
        while self.sent < base64.len() {
            let left = base64.len() - self.sent;
            let room = end.saturating_sub(out.len() + FRAME).min(LARGEST_CHUNK);
            if room < left.min(SMALLEST_CHUNK) {
                return false;
            }
            // All chunks but the last are multiples of 4: base64's groups stay whole.
            let size = if left <= room { left } else { room / 4 * 4 };
            let more = u8::from(left > size);
            let head = if self.sent == 0 {
                format!("\x1b_Ga=t,f=100,t=d,i={},q=2,m={more};", self.id)
            } else {
                format!("\x1b_Gq=2,m={more};")
            };
            out.extend_from_slice(head.as_bytes());
            out.extend_from_slice(&base64[self.sent..self.sent + size]);
            out.extend_from_slice(b"\x1b\\");
            self.sent += size;
        }
        true
    }

    /// Ends it before it is finished: the terminal throws the broken picture away.
    pub fn abandon(&self, out: &mut Vec<u8>) {
        if self.sent > 0 {
            out.extend_from_slice(b"\x1b_Gq=2,m=0;\x1b\\");
            delete(self.id, out);
        }
    }
}

/// Shows a picture over some cells, from the cursor on, which stays. The same picture in another
/// place is moved: its placement keeps its number.
pub(super) fn place(id: u32, area: Rect, reply: PlaceReply, out: &mut Vec<u8>) {
    let (columns, rows) = (area.width, area.height);
    let quiet = match reply {
        PlaceReply::Wanted => "",
        PlaceReply::None => ",q=2",
    };
    out.extend_from_slice(format!("\x1b_Ga=p,i={id},p=1,c={columns},r={rows},C=1{quiet}\x1b\\").as_bytes());
}

/// Whether the terminal is to say what became of a placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlaceReply {
    Wanted,
    None,
}

/// Takes a picture off the screen; the terminal keeps its data.
pub(super) fn hide(id: u32, out: &mut Vec<u8>) {
    out.extend_from_slice(format!("\x1b_Ga=d,d=i,i={id},q=2\x1b\\").as_bytes());
}

/// Deletes a picture and its data.
pub(super) fn delete(id: u32, out: &mut Vec<u8>) {
    out.extend_from_slice(format!("\x1b_Ga=d,d=I,i={id},q=2\x1b\\").as_bytes());
}
