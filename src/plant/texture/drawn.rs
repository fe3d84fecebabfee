//! Pictures that were drawn already, so that trees which look alike share them.

use std::sync::{Arc, Mutex, PoisonError};

use super::bark::normals_by_lightness;
use super::kept::{Album, CardPictures};
use super::leaf::{LeafError, LeafLook, LeafPictures, TwigLook};
use super::{Bark, BarkError, BarkPictures, Moss, Torn};
use linden_base::monitor::Monitor;
use linden_base::picture::{Picture, PictureKey, PictureStore};
use linden_base::random::Key;

/// Pictures by all that decides them: what was drawn once is not drawn or compressed again while there is room.
/// The pictures are the same bit for bit. Those that nobody asked for the longest give way.
///
/// It may be asked from any number of threads. Two that want the same at the same moment both draw it, and both
/// get the one that was kept.
#[derive(Debug)]
pub struct DrawnPictures {
    barks: Shelf<Bark, BarkPictures>,
    reliefs: Shelf<Made<f32>, Arc<Picture>>,
    mosses: Shelf<Made<Moss>, Arc<Picture>>,
    torn: Shelf<(Bark, Bark, Torn), BarkPictures>,
    leaves: Shelf<Leaves, LeafPictures>,
    album: Album,
}

impl Default for DrawnPictures {
    /// Room for 64 MiB.
    fn default() -> Self {
        Self::new(64 << 20)
    }
}

impl DrawnPictures {
    /// With room for so many bytes, of pixels and of files that were made of them.
    pub const fn new(bytes: u64) -> Self {
        let room = bytes / 4;
        let small = room / 2;
        Self {
            barks: Shelf::new(room),
            reliefs: Shelf::new(small),
            mosses: Shelf::new(small),
            torn: Shelf::new(room),
            leaves: Shelf::new(bytes - 3 * room),
            album: Album(None),
        }
    }

    /// What is not here is looked for in a store, and what is drawn is put there, for other runs of a program: the
    /// same pictures, in less time.
    #[must_use]
    pub fn kept_in(self, store: Arc<dyn PictureStore>) -> Self {
        Self { album: Album(Some(store)), ..self }
    }

    /// [`Bark::draw`].
    pub(crate) fn bark(&self, bark: &Bark, monitor: &dyn Monitor) -> Result<BarkPictures, BarkError> {
        self.barks.get(bark, || self.album.get("bark", bark, None, monitor, || bark.draw(monitor)))
    }

    /// [`normals_by_lightness`].
    pub(crate) fn relief(
        &self,
        of: &Arc<Picture>,
        depth: f32,
        monitor: &dyn Monitor,
    ) -> Result<Arc<Picture>, BarkError> {
        let wanted = Made { of: Arc::clone(of), how: depth };
        self.reliefs.get(&wanted, || {
            let draw = || normals_by_lightness(of, depth, monitor);
            self.album.get("relief", &depth, Some(of), monitor, draw)
        })
    }

    /// [`Moss::grow_on`].
    pub(crate) fn mossy(
        &self,
        of: &Arc<Picture>,
        moss: Moss,
        monitor: &dyn Monitor,
    ) -> Result<Arc<Picture>, BarkError> {
        let wanted = Made { of: Arc::clone(of), how: moss };
        self.mosses.get(&wanted, || {
            let draw = || Ok(Arc::new(moss.grow_on(of, monitor)?));
            self.album.get("moss", &moss, Some(of), monitor, draw)
        })
    }

    /// [`Torn::over`] two barks that are drawn.
    pub(crate) fn torn(
        &self,
        (upper, lower): (&Bark, &Bark),
        torn: Torn,
        monitor: &dyn Monitor,
    ) -> Result<BarkPictures, BarkError> {
        let wanted = (*upper, *lower, torn);
        self.torn.get(&wanted, || {
            let draw = || torn.over(&self.bark(upper, monitor)?, &self.bark(lower, monitor)?, monitor);
            self.album.get("torn", &wanted, None, monitor, draw)
        })
    }

    /// [`LeafLook::draw`], or [`LeafLook::draw_twig`] where there is one.
    pub(crate) fn leaves(
        &self,
        look: LeafLook,
        twig: Option<TwigLook>,
        key: Key,
        monitor: &dyn Monitor,
    ) -> Result<LeafPictures, LeafError> {
        let wanted = Leaves { look, twig, key };
        self.leaves.get(&wanted, || {
            self.album.get("leaves", &wanted, None, monitor, || match &wanted.twig {
                Some(twig) => wanted.look.draw_twig(twig, key, monitor),
                None => wanted.look.draw(key, monitor),
            })
        })
    }
}

impl DrawnPictures {
    /// Colours, normals and what passes of branch cards, by a key of all that is seen on them: they are of one tree, and kept
    /// nowhere but in a store.
    pub(crate) fn cards<E>(
        &self,
        decided_by: impl FnOnce() -> PictureKey,
        monitor: &dyn Monitor,
        draw: impl FnOnce() -> Result<CardPictures, E>,
    ) -> Result<CardPictures, E> {
        self.album.get_by("cards", decided_by, monitor, draw)
    }
}

impl DrawnPictures {
    /// The same of a billboard.
    pub(crate) fn billboard<E>(
        &self,
        decided_by: impl FnOnce() -> PictureKey,
        monitor: &dyn Monitor,
        draw: impl FnOnce() -> Result<CardPictures, E>,
    ) -> Result<CardPictures, E> {
        self.album.get_by("billboard", decided_by, monitor, draw)
    }
}

/// What is made of a picture: normals that follow it to a depth, moss on it.
#[derive(Clone, Debug)]
struct Made<H> {
    of: Arc<Picture>,
    how: H,
}

impl<H: PartialEq> PartialEq for Made<H> {
    fn eq(&self, other: &Self) -> bool {
        self.how == other.how && Arc::ptr_eq(&self.of, &other.of)
    }
}

/// An atlas of leaves or twigs.
#[derive(Clone, Debug, PartialEq)]
struct Leaves {
    look: LeafLook,
    twig: Option<TwigLook>,
    key: Key,
}

/// What takes memory.
trait Held {
    fn bytes(&self) -> u64;
}

impl Held for Arc<Picture> {
    fn bytes(&self) -> u64 {
        Picture::bytes(self)
    }
}

impl Held for BarkPictures {
    fn bytes(&self) -> u64 {
        self.base_color.bytes() + self.normal.bytes()
    }
}

impl Held for LeafPictures {
    fn bytes(&self) -> u64 {
        self.base_color.bytes() + self.normal.bytes()
    }
}

/// Pictures of a kind, those that were asked for last at the end.
#[derive(Debug)]
struct Shelf<W, P> {
    kept: Mutex<Vec<(W, P)>>,
    room: u64,
}

impl<W: Clone + PartialEq, P: Clone + Held> Shelf<W, P> {
    const fn new(room: u64) -> Self {
        Self { kept: Mutex::new(Vec::new()), room }
    }

    /// What is wanted, drawn where it is not here. Nobody is kept waiting for another's drawing: who waits may be
    /// the thread that draws for the other.
    fn get<E>(&self, wanted: &W, draw: impl FnOnce() -> Result<P, E>) -> Result<P, E> {
        if let Some(found) = self.take(wanted) {
            return Ok(found);
        }
        let drawn = draw()?;
        // Meanwhile another may have drawn it.
        if let Some(found) = self.take(wanted) {
            return Ok(found);
        }
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push((wanted.clone(), drawn.clone()));
        let mut bytes: u64 = kept.iter().map(|(_, pictures)| pictures.bytes()).sum();
        let too_many = kept.iter().take_while(|(_, pictures)| {
            let gives_way = bytes > self.room;
            bytes -= pictures.bytes();
            gives_way
        });
        let too_many = too_many.count();
        kept.drain(..too_many);
        Ok(drawn)
    }

    fn take(&self, wanted: &W) -> Option<P> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let found = kept.iter().position(|(of, _)| of == wanted)?;
        kept[found..].rotate_left(1);
        kept.last().map(|(_, pictures)| pictures.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stop;
    use crate::texture::BarkStyle;
    use linden_base::monitor::Quiet;

    fn bark(seed: u64) -> Bark {
        Bark { size_px: 64, ..Bark::new(BarkStyle::Plated, Key::new(seed)) }
    }

    #[test]
    fn what_was_drawn_is_shared_and_is_what_would_be_drawn() {
        let drawn = DrawnPictures::default();
        let [first, again] = [(); 2].map(|()| drawn.bark(&bark(1), &Quiet).unwrap());
        assert!(Arc::ptr_eq(&first.normal, &again.normal));
        assert_eq!(first, bark(1).draw(&Quiet).unwrap());
        let deeper = Bark { relief: 0.1, ..bark(1) };
        assert_ne!(drawn.bark(&deeper, &Quiet).unwrap(), first);
        assert_ne!(drawn.bark(&bark(2), &Quiet).unwrap(), first);
    }

    #[test]
    fn leaves_and_twigs_of_one_look_are_two_pictures() {
        use crate::texture::leaf::Outline;
        let drawn = DrawnPictures::default();
        let look = LeafLook { size_px: 32, ..LeafLook::new(Outline::Lobed) };
        let get =
            |twig: Option<TwigLook>, key| drawn.leaves(look.clone(), twig, Key::new(key), &Quiet).unwrap();
        let leaf = get(None, 1);
        assert!(Arc::ptr_eq(&leaf.base_color, &get(None, 1).base_color));
        assert_eq!(leaf, look.draw(Key::new(1), &Quiet).unwrap());
        assert_ne!(get(None, 2), leaf);
        let twig = TwigLook { leaves: 3, ..TwigLook::default() };
        assert_eq!(get(Some(twig.clone()), 1), look.draw_twig(&twig, Key::new(1), &Quiet).unwrap());
    }

    #[test]
    fn what_was_asked_for_last_stays_within_the_room() {
        // Two pictures of 64 × 64 pixels each: room for two of three barks.
        let each = 2 * 64 * 64 * 4;
        let shelf: Shelf<Bark, BarkPictures> = Shelf::new(2 * each + each / 2);
        let is_kept = |seed| shelf.take(&bark(seed)).is_some();
        let draw = |seed| shelf.get(&bark(seed), || bark(seed).draw(&Quiet)).unwrap();
        let (one, _) = (draw(1), draw(2));
        assert!(Arc::ptr_eq(&draw(1).normal, &one.normal));
        draw(3);
        assert!(is_kept(1) && !is_kept(2) && is_kept(3));
        // Files that were made of them count; what is larger than all the room is not kept at all.
        let small: Shelf<Bark, BarkPictures> = Shelf::new(each);
        let kept = small.get(&bark(1), || bark(1).draw(&Quiet)).unwrap();
        assert!(small.take(&bark(1)).is_some());
        kept.base_color.png().unwrap();
        small.get(&bark(2), || bark(2).draw(&Quiet)).unwrap();
        assert!(small.take(&bark(1)).is_none() && small.take(&bark(2)).is_some());
        let none: Shelf<Bark, BarkPictures> = Shelf::new(each - 1);
        none.get(&bark(1), || bark(1).draw(&Quiet)).unwrap();
        assert!(none.take(&bark(1)).is_none());
    }

    #[test]
    fn what_nobody_wanted_any_more_is_not_kept() {
        let drawn = DrawnPictures::default();
        assert!(matches!(drawn.bark(&bark(1), &Stop), Err(BarkError::Cancelled(_))));
        assert_eq!(drawn.bark(&bark(1), &Quiet), bark(1).draw(&Quiet));
    }
}
