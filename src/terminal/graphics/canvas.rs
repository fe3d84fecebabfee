//! Which picture a terminal shows, and which one is on its way.

use ratatui::layout::Rect;

use super::kitty::{self, PlaceReply, Transmission};
use super::{Graphic, Protocol};

/// So many times in a row may a picture be lost; then cells are shown instead.
const MOST_LOST: u32 = 3;

/// The pictures of a terminal.
#[derive(Debug, Default)]
pub(crate) struct Canvas {
    standing: Option<Standing>,
    /// kitty's: one that the terminal has and does not show.
    hidden: Option<Standing>,
    coming: Option<Transmission>,
    last_id: u32,
    /// kitty's pictures that were lost, of which the terminal may have parts.
    stale: Vec<u32>,
    /// Whether the terminal has ever said that a picture is there.
    confirms: bool,
    /// Pictures that were lost one after the other.
    lost: u32,
    /// The picture that was lost too often.
    given_up: Option<u64>,
}

/// A picture that is shown.
#[derive(Clone, Copy, Debug)]
struct Standing {
    generation: u64,
    area: Rect,
    /// kitty's number, for others 0.
    id: u32,
    /// Whether the terminal has said that it is there.
    is_confirmed: bool,
}

/// How far a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Placement {
    /// It is shown.
    Standing,
    /// There is more to send.
    Unfinished,
    /// All is there to [`Canvas::place`] it.
    Ready,
}

impl Canvas {
    /// The cells that are beneath a picture, once a graphic that only has to be placed is there.
    pub fn covered(&self, wanted: Option<&Graphic>) -> Option<Rect> {
        let placed = wanted.filter(|graphic| is_of(self.hidden, graphic)).map(|graphic| graphic.area);
        placed.or(self.standing.map(|standing| standing.area))
    }

    /// Whether a picture is shown where it should be.
    pub fn stands(&self, graphic: &Graphic) -> bool {
        is_of(self.standing, graphic) && self.standing.is_some_and(|s| s.area == graphic.area)
    }

    /// Whether a picture could not be shown, however often it was sent.
    pub fn has_given_up(&self, graphic: &Graphic) -> bool {
        self.given_up == Some(graphic.generation)
    }

    /// Ends what is no longer wanted. Gives the area whose cells must be painted to remove a picture.
    pub fn prepare(&mut self, wanted: Option<&Graphic>, out: &mut Vec<u8>) -> Option<Rect> {
        if let Some(coming) = &self.coming
            && wanted.is_none_or(|graphic| graphic.generation != coming.generation)
        {
            coming.abandon(out);
            self.coming = None;
        }
        // Between two pieces of a picture nothing else is said.
        if self.coming.is_none() {
            self.stale.drain(..).for_each(|id| kitty::delete(id, out));
            if let (Some(hidden), Some(graphic)) = (self.hidden, wanted)
                && hidden.generation != graphic.generation
            {
                kitty::delete(hidden.id, out);
                self.hidden = None;
            }
        }
        let standing = self.standing?;
        // In the same place the old picture stays until the new one is there; the same picture in
        // another place is moved.
        let stays = wanted.is_some_and(|graphic| {
            graphic.area == standing.area
                || standing.id != 0
                    && graphic.generation == standing.generation
                    && graphic.data.protocol == Protocol::Kitty
        });
        match wanted {
            _ if stays => None,
            // Something lies over it, and will go again.
            None if standing.id != 0 => {
                kitty::hide(standing.id, out);
                let before = std::mem::replace(&mut self.hidden, self.standing.take());
                if let Some(before) = before {
                    kitty::delete(before.id, out);
                }
                None
            }
            _ => self.remove(out),
        }
    }

    fn remove(&mut self, out: &mut Vec<u8>) -> Option<Rect> {
        let standing = self.standing.take()?;
        if standing.id != 0 {
            kitty::delete(standing.id, out);
            return None;
        }
        Some(standing.area)
    }

    /// Ends and removes everything; cells are not painted.
    pub fn remove_all(&mut self, out: &mut Vec<u8>) {
        if let Some(coming) = self.coming.take() {
            coming.abandon(out);
        }
        let hidden = self.hidden.take().map(|hidden| hidden.id);
        self.stale.drain(..).chain(hidden).for_each(|id| kitty::delete(id, out));
        self.remove(out);
        (self.lost, self.given_up) = (0, None);
    }

    /// Sends what is allowed of a picture that comes in pieces.
    pub fn send(&mut self, graphic: &Graphic, allowed: usize, out: &mut Vec<u8>) -> Placement {
        if self.stands(graphic) {
            return Placement::Standing;
        }
        let is_there = is_of(self.standing.filter(|s| s.id != 0), graphic) || is_of(self.hidden, graphic);
        if graphic.data.protocol != Protocol::Kitty || is_there {
            return Placement::Ready;
        }
        let coming = self.coming.get_or_insert_with(|| {
            // Small numbers, of which none is in use: few are.
            self.last_id = self.last_id % 9_999 + 1;
            Transmission::new(self.last_id, graphic.generation)
        });
        if coming.send(&graphic.data.bytes, allowed, out) { Placement::Ready } else { Placement::Unfinished }
    }

    /// Whether what is beneath a picture must be painted anew so that the old one is gone.
    pub fn needs_fresh_cells(&self, graphic: &Graphic) -> bool {
        graphic.data.protocol != Protocol::Kitty && !graphic.data.opaque && self.standing.is_some()
    }

    /// Shows a picture, whose upper left cell the cursor is in, and deletes the one before.
    pub fn place(&mut self, graphic: &Graphic, out: &mut Vec<u8>) {
        let old = self.standing.take();
        let id = if graphic.data.protocol == Protocol::Kitty {
            let moved = old.filter(|old| old.generation == graphic.generation);
            let there =
                moved.or_else(|| self.hidden.take_if(|hidden| hidden.generation == graphic.generation));
            let there = there.map(|there| there.id);
            let id = there.or_else(|| self.coming.take().map(|coming| coming.id)).unwrap_or_default();
            kitty::place(id, graphic.area, PlaceReply::Wanted, out);
            id
        } else {
            out.extend_from_slice(&graphic.data.bytes);
            0
        };
        if let Some(old) = old.filter(|old| old.id != 0 && old.id != id) {
            kitty::delete(old.id, out);
        }
        let Graphic { generation, area, .. } = *graphic;
        self.standing = Some(Standing { generation, area, id, is_confirmed: id == 0 });
    }

    /// Takes the terminal's answer to a placement. Whether the picture is lost and has to be sent again.
    pub fn answered(&mut self, id: u32, ok: bool) -> bool {
        if let Some(standing) = self.standing.as_mut().filter(|standing| standing.id == id && id != 0) {
            if !ok {
                return self.lose();
            }
            standing.is_confirmed = true;
            (self.confirms, self.lost) = (true, 0);
        }
        false
    }

    /// The terminal has read all that was sent, the placement of the picture too: a terminal that answers has
    /// answered by now. Whether the picture is lost and has to be sent again.
    pub fn is_read(&mut self) -> bool {
        let is_silent = self.standing.is_some_and(|standing| !standing.is_confirmed);
        is_silent && self.confirms && self.lose()
    }

    /// Whether an answer is still to come.
    pub fn awaits(&self) -> bool {
        self.standing.is_some_and(|standing| !standing.is_confirmed)
    }

    fn lose(&mut self) -> bool {
        let Some(standing) = self.standing.take() else { return false };
        self.stale.push(standing.id);
        self.lost += 1;
        if self.lost >= MOST_LOST {
            self.given_up = Some(standing.generation);
        }
        true
    }
}

fn is_of(shown: Option<Standing>, graphic: &Graphic) -> bool {
    shown.is_some_and(|shown| shown.generation == graphic.generation)
}
