//! Which pictures a terminal shows, and which one is on its way.

use ratatui::layout::Rect;

use super::kitty::{self, PlaceReply, Transmission};
use super::{Graphic, Protocol};

/// So many times in a row may a picture be lost; then cells are shown instead.
const MOST_LOST: u32 = 3;

/// The pictures of a terminal.
#[derive(Debug, Default)]
pub(crate) struct Canvas {
    standing: Vec<Standing>,
    /// kitty's: those that the terminal has and does not show.
    hidden: Vec<Standing>,
    coming: Option<Transmission>,
    last_id: u32,
    /// kitty's pictures that were lost, of which the terminal may have parts.
    stale: Vec<u32>,
    /// Whether the terminal has ever said that a picture is there.
    confirms: bool,
    /// Pictures that were lost one after the other.
    lost: u32,
    /// The pictures that were lost too often.
    given_up: Vec<u64>,
}

/// A picture that is shown.
#[derive(Clone, Copy, Debug)]
struct Standing {
    generation: u64,
    area: Rect,
    layer: u8,
    /// kitty's number, for others 0.
    id: u32,
    /// Whether the terminal has said that it is there.
    is_confirmed: bool,
}

impl Standing {
    fn is_of(&self, graphic: &Graphic) -> bool {
        self.generation == graphic.generation
    }

    /// Whether it stays while a graphic is wanted. In the same place the old picture stays until the new one
    /// is there; the same picture in another place is moved.
    fn stays_for(&self, graphic: &Graphic) -> bool {
        graphic.area == self.area
            || self.id != 0 && self.is_of(graphic) && graphic.data.protocol == Protocol::Kitty
    }
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
    /// The cells that are beneath pictures, once those that only have to be placed are there.
    pub fn covered(&self, wanted: &[&Graphic]) -> Vec<Rect> {
        let placed = wanted.iter().filter(|graphic| self.hidden.iter().any(|hidden| hidden.is_of(graphic)));
        placed.map(|graphic| graphic.area).chain(self.standing.iter().map(|standing| standing.area)).collect()
    }

    /// Whether a picture is shown where it should be.
    pub fn stands(&self, graphic: &Graphic) -> bool {
        self.standing.iter().any(|standing| standing.is_of(graphic) && standing.area == graphic.area)
    }

    /// Whether a picture is on its way.
    pub fn is_coming(&self, graphic: &Graphic) -> bool {
        self.coming.as_ref().is_some_and(|coming| coming.generation == graphic.generation)
    }

    /// Whether a picture could not be shown, however often it was sent.
    pub fn has_given_up(&self, graphic: &Graphic) -> bool {
        self.given_up.contains(&graphic.generation)
    }

    /// Ends what is no longer wanted. Gives the areas whose cells must be painted to remove pictures.
    pub fn prepare(&mut self, wanted: &[&Graphic], out: &mut Vec<u8>) -> Vec<Rect> {
        let (staying, leaving): (Vec<_>, Vec<_>) = std::mem::take(&mut self.standing)
            .into_iter()
            .partition(|standing| wanted.iter().any(|graphic| standing.stays_for(graphic)));
        self.standing = staying;
        // Between two pieces of a picture nothing else is said.
        if let Some(coming) = &self.coming
            && (leaving.iter().any(|left| left.id != 0)
                || wanted.iter().all(|graphic| graphic.generation != coming.generation))
        {
            coming.abandon(out);
            self.coming = None;
        }
        if self.coming.is_none() {
            self.stale.drain(..).for_each(|id| kitty::delete(id, out));
            let is_over = |hidden: &mut Standing| {
                let same = wanted.iter().any(|graphic| graphic.layer == hidden.layer);
                let above = !wanted.is_empty() && wanted.iter().all(|graphic| graphic.layer < hidden.layer);
                (same || above) && wanted.iter().all(|graphic| !hidden.is_of(graphic))
            };
            self.hidden.extract_if(.., is_over).for_each(|hidden| kitty::delete(hidden.id, out));
        }
        let mut uncovered = Vec::new();
        for left in leaving {
            if left.id == 0 {
                uncovered.push(left.area);
            } else if wanted.iter().all(|graphic| graphic.layer > left.layer) {
                // Something lies over it, and will go again.
                kitty::hide(left.id, out);
                self.hidden.push(left);
            } else {
                kitty::delete(left.id, out);
            }
        }
        uncovered
    }

    /// Ends and removes everything; cells are not painted.
    pub fn remove_all(&mut self, out: &mut Vec<u8>) {
        if let Some(coming) = self.coming.take() {
            coming.abandon(out);
        }
        let shown = self.standing.drain(..).chain(self.hidden.drain(..)).map(|standing| standing.id);
        let ids = self.stale.drain(..).chain(shown.filter(|&id| id != 0));
        ids.for_each(|id| kitty::delete(id, out));
        self.lost = 0;
        self.given_up.clear();
    }

    /// Sends what is allowed of a picture that comes in pieces. One that is coming must be finished before
    /// another is begun.
    pub fn send(&mut self, graphic: &Graphic, allowed: usize, out: &mut Vec<u8>) -> Placement {
        if self.stands(graphic) {
            return Placement::Standing;
        }
        let mut there = self.standing.iter().filter(|standing| standing.id != 0).chain(&self.hidden);
        if graphic.data.protocol != Protocol::Kitty || there.any(|there| there.is_of(graphic)) {
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
        let overlaps = |standing: &Standing| !standing.area.intersection(graphic.area).is_empty();
        graphic.data.protocol != Protocol::Kitty && !graphic.data.opaque && self.standing.iter().any(overlaps)
    }

    /// Shows a picture, whose upper left cell the cursor is in, and deletes the one before.
    pub fn place(&mut self, graphic: &Graphic, out: &mut Vec<u8>) {
        let Graphic { generation, area, layer, .. } = *graphic;
        let mut old: Vec<Standing> =
            self.standing.extract_if(.., |standing| standing.stays_for(graphic)).collect();
        let id = if graphic.data.protocol == Protocol::Kitty {
            old.extend(self.hidden.extract_if(.., |hidden| hidden.generation == generation));
            let there = old.iter().find(|old| old.generation == generation).map(|there| there.id);
            let id = there.or_else(|| self.coming.take().map(|coming| coming.id)).unwrap_or_default();
            kitty::place(id, area, PlaceReply::Wanted, out);
            id
        } else {
            out.extend_from_slice(&graphic.data.bytes);
            0
        };
        for old in old.into_iter().filter(|old| old.id != 0 && old.id != id) {
            kitty::delete(old.id, out);
        }
        self.standing.push(Standing { generation, area, layer, id, is_confirmed: id == 0 });
    }

    /// Takes the terminal's answer to a placement. Whether the picture is lost and has to be sent again.
    pub fn answered(&mut self, id: u32, ok: bool) -> bool {
        if let Some(standing) = self.standing.iter_mut().find(|standing| standing.id == id && id != 0) {
            if !ok {
                return self.lose(|standing| standing.id == id);
            }
            standing.is_confirmed = true;
            (self.confirms, self.lost) = (true, 0);
        }
        false
    }

    /// The terminal has read all that was sent, the placement of the pictures too: a terminal that answers has
    /// answered by now. Whether a picture is lost and has to be sent again.
    pub fn is_read(&mut self) -> bool {
        self.confirms && self.lose(|standing| !standing.is_confirmed)
    }

    /// Whether an answer is still to come.
    pub fn awaits(&self) -> bool {
        self.standing.iter().any(|standing| !standing.is_confirmed)
    }

    /// Whether there was any to lose.
    fn lose(&mut self, is_lost: impl Fn(&Standing) -> bool) -> bool {
        let lost: Vec<Standing> = self.standing.extract_if(.., |standing| is_lost(standing)).collect();
        self.lost += u32::from(!lost.is_empty());
        for standing in &lost {
            self.stale.push(standing.id);
            if self.lost >= MOST_LOST {
                self.given_up.push(standing.generation);
            }
        }
        !lost.is_empty()
    }
}
