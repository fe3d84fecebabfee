//! Pictures that are kept from one run of a program to the next.

use std::fmt::Debug;
use std::sync::Arc;

use glam::Vec2;

use super::BarkPictures;
use super::leaf::{self, Cell, LeafPictures};
use linden_base::monitor::Monitor;
use linden_base::picture::{DRAWING_SOURCE, Picture, PictureKey, PictureStore};

/// The code that draws, as a number ([`DRAWING_SOURCE`] is that of the crate below).
const SOURCE: &str = env!("DRAWING_SOURCE");

/// Where drawn pictures are kept, if anywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Album(pub Option<Arc<dyn PictureStore>>);

impl Album {
    /// What is in the album, else what `draw` draws, which is put into it: the same bytes.
    ///
    /// `what` is the kind of picture. `how` is all that decides it, as [`Debug`] shows it: each field of what was
    /// derived, and numbers to the last bit. `of` is the picture that it is made of.
    pub fn get<P: Kept, E>(
        &self,
        what: &str,
        how: &dyn Debug,
        of: Option<&Picture>,
        monitor: &dyn Monitor,
        draw: impl FnOnce() -> Result<P, E>,
    ) -> Result<P, E> {
        let decided_by = || {
            let of = of.map(|picture| picture.content().to_bytes());
            PictureKey::of(&[format!("{how:?}").as_bytes(), of.as_ref().map_or(&[], |of| of)])
        };
        self.get_by(what, decided_by, monitor, draw)
    }

    /// The same by a key of all that decides it, besides the code that draws.
    pub fn get_by<P: Kept, E>(
        &self,
        what: &str,
        decided_by: impl FnOnce() -> PictureKey,
        monitor: &dyn Monitor,
        draw: impl FnOnce() -> Result<P, E>,
    ) -> Result<P, E> {
        let Some(store) = &self.0 else { return draw() };
        let base = DRAWING_SOURCE.to_le_bytes();
        let key = PictureKey::of(&[SOURCE.as_bytes(), &base, what.as_bytes(), &decided_by().to_bytes()]);
        let kept = P::get(store.as_ref(), key);
        // Where there is no memory for it, drawing says what to do.
        let kept = kept.filter(|kept| monitor.admit("reading kept pictures", kept.bytes(), "").is_ok());
        let mut pictures = match kept {
            Some(kept) => kept,
            None => {
                let drawn = draw()?;
                drawn.put(store.as_ref(), key);
                drawn
            }
        };
        for picture in pictures.each() {
            // What was just made is nowhere else yet.
            if let Some(picture) = Arc::get_mut(picture) {
                *picture = std::mem::replace(picture, Picture::new(0, 0, Vec::new())).kept_in(store);
            }
        }
        Ok(pictures)
    }
}

/// What can be kept: pictures, and what is to be known about them.
pub(super) trait Kept: Sized {
    fn get(store: &dyn PictureStore, key: PictureKey) -> Option<Self>;
    fn put(&self, store: &dyn PictureStore, key: PictureKey);
    fn each(&mut self) -> Vec<&mut Arc<Picture>>;

    /// Of the pixels.
    fn bytes(&self) -> u64;
}

impl Kept for Arc<Picture> {
    fn get(store: &dyn PictureStore, key: PictureKey) -> Option<Self> {
        let (picture, about) = Picture::get_from(store, key)?;
        about.is_empty().then(|| Arc::new(picture))
    }

    fn put(&self, store: &dyn PictureStore, key: PictureKey) {
        self.put_into(store, key, &[]);
    }

    fn each(&mut self) -> Vec<&mut Arc<Picture>> {
        vec![self]
    }

    fn bytes(&self) -> u64 {
        self.rgba().len() as u64
    }
}

/// Colours, normals, and what passes, of the same size, which are an entry each.
pub(super) type CardPictures = [Arc<Picture>; 3];

impl Kept for CardPictures {
    fn get(store: &dyn PictureStore, key: PictureKey) -> Option<Self> {
        let passing = Picture::get_from(store, third(key));
        let ([color, normal], _) = get_pair(store, key)?;
        let (passing, none) = passing?;
        let fits = none.is_empty() && [passing.width(), passing.height()] == [color.width(), color.height()];
        fits.then(|| [color, normal, Arc::new(passing)])
    }

    fn put(&self, store: &dyn PictureStore, key: PictureKey) {
        let [color, normal, passing] = self;
        put_pair([color, normal], &[], store, key);
        passing.put_into(store, third(key), &[]);
    }

    fn each(&mut self) -> Vec<&mut Arc<Picture>> {
        self.iter_mut().collect()
    }

    fn bytes(&self) -> u64 {
        self.iter().map(|picture| picture.rgba().len() as u64).sum()
    }
}

/// The second entry of a key.
fn second(key: PictureKey) -> PictureKey {
    PictureKey::of(&[b"normal", &key.to_bytes()])
}

/// The third.
fn third(key: PictureKey) -> PictureKey {
    PictureKey::of(&[b"passing", &key.to_bytes()])
}

fn get_pair(store: &dyn PictureStore, key: PictureKey) -> Option<([Arc<Picture>; 2], Vec<u8>)> {
    // Both are asked for, so that a store counts as many that are missing as are made.
    let found = [key, second(key)].map(|key| Picture::get_from(store, key));
    let [Some((color, about)), Some((normal, none))] = found else { return None };
    let is_pair = none.is_empty() && [normal.width(), normal.height()] == [color.width(), color.height()];
    is_pair.then(|| ([Arc::new(color), Arc::new(normal)], about))
}

fn put_pair([color, normal]: [&Picture; 2], about: &[u8], store: &dyn PictureStore, key: PictureKey) {
    color.put_into(store, key, about);
    normal.put_into(store, second(key), &[]);
}

impl Kept for BarkPictures {
    fn get(store: &dyn PictureStore, key: PictureKey) -> Option<Self> {
        let ([base_color, normal], about) = get_pair(store, key)?;
        about.is_empty().then_some(Self { base_color, normal })
    }

    fn put(&self, store: &dyn PictureStore, key: PictureKey) {
        put_pair([&self.base_color, &self.normal], &[], store, key);
    }

    fn each(&mut self) -> Vec<&mut Arc<Picture>> {
        vec![&mut self.base_color, &mut self.normal]
    }

    fn bytes(&self) -> u64 {
        (self.base_color.rgba().len() + self.normal.rgba().len()) as u64
    }
}

impl Kept for LeafPictures {
    fn get(store: &dyn PictureStore, key: PictureKey) -> Option<Self> {
        let ([base_color, normal], about) = get_pair(store, key)?;
        let (cells, backs) = read_cells(&about)?;
        Some(Self { cutout: leaf::cutout(&base_color), base_color, normal, cells, backs })
    }

    fn put(&self, store: &dyn PictureStore, key: PictureKey) {
        put_pair([&self.base_color, &self.normal], &write_cells(&self.cells, &self.backs), store, key);
    }

    fn each(&mut self) -> Vec<&mut Arc<Picture>> {
        vec![&mut self.base_color, &mut self.normal]
    }

    fn bytes(&self) -> u64 {
        (self.base_color.rgba().len() + self.normal.rgba().len()) as u64
    }
}

/// How many cells are backs, then all cells, backs last: five places, a colour, the number of corners, and the corners.
fn write_cells(cells: &[Cell], backs: &[Cell]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut put = |places: &[Vec2]| {
        bytes.extend(places.iter().flat_map(|at| [at.x.to_le_bytes(), at.y.to_le_bytes()]).flatten());
    };
    put(&[Vec2::new(backs.len() as f32, 0.0)]);
    for cell in cells.iter().chain(backs) {
        let [r, g, b] = cell.color.map(f32::from);
        let corners = Vec2::new(cell.outline.len() as f32, b);
        put(&[cell.min, cell.max, cell.attach, cell.unit, cell.stalk, Vec2::new(r, g), corners]);
        put(&cell.outline);
    }
    bytes
}

/// Whatever is not what [`write_cells`] writes is `None`.
fn read_cells(bytes: &[u8]) -> Option<(Vec<Cell>, Vec<Cell>)> {
    let (numbers, []) = bytes.as_chunks::<4>() else { return None };
    let (places, []) = numbers.as_chunks::<2>() else { return None };
    let mut places = places.iter().map(|&[x, y]| Vec2::new(f32::from_le_bytes(x), f32::from_le_bytes(y)));
    let backs = places.next()?.x as usize;
    let mut cells = Vec::new();
    while let Some(min) = places.next() {
        let mut next = || places.next();
        let (max, attach, unit, stalk, red_green, corners) =
            (next()?, next()?, next()?, next()?, next()?, next()?);
        let outline: Vec<Vec2> = places.by_ref().take(corners.x as usize).collect();
        if outline.len() != corners.x as usize {
            return None;
        }
        let color = [red_green.x, red_green.y, corners.y].map(|code| code as u8);
        cells.push(Cell { min, max, attach, unit, outline, color, stalk });
    }
    let backs = cells.split_off(cells.len().checked_sub(backs)?);
    Some((cells, backs))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Mutex;

    use super::*;
    use crate::texture::leaf::{LeafLook, Outline, TwigLook};
    use crate::texture::{Bark, BarkStyle, DrawnPictures, Moss};
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    /// A store in memory.
    #[derive(Debug, Default)]
    struct Memory(Mutex<BTreeMap<PictureKey, Vec<u8>>>);

    impl PictureStore for Memory {
        fn get(&self, key: PictureKey) -> Option<Vec<u8>> {
            self.0.lock().unwrap().get(&key).cloned()
        }

        fn put(&self, key: PictureKey, parts: &[&[u8]]) {
            self.0.lock().unwrap().insert(key, parts.concat());
        }
    }

    impl Memory {
        fn entries(&self) -> usize {
            self.0.lock().unwrap().len()
        }
    }

    /// As a run of a program that begins with nothing in memory.
    fn run(store: &Arc<Memory>) -> (BarkPictures, [Arc<Picture>; 2], LeafPictures, LeafPictures) {
        let drawn = DrawnPictures::default().kept_in(store.clone());
        let bark = Bark { size_px: 64, ..Bark::new(BarkStyle::Birch, Key::new(3)) };
        let bark = drawn.bark(&bark, &Quiet).unwrap();
        let moss = Moss { share: 0.4, color: [90, 110, 60], halvings: 1, key: Key::new(5) };
        let mossy = drawn.mossy(&bark.base_color, moss, &Quiet).unwrap();
        let relief = drawn.relief(&bark.base_color, 0.03, &Quiet).unwrap();
        let look = LeafLook { size_px: 64, ..LeafLook::new(Outline::Lobed) };
        let [leaf, twig] = [None, Some(TwigLook { leaves: 3, ..TwigLook::default() })]
            .map(|twig| drawn.leaves(look.clone(), twig, Key::new(1), &Quiet).unwrap());
        (bark, [mossy, relief], leaf, twig)
    }

    #[test]
    fn a_second_run_has_what_the_first_one_drew() {
        let store = Arc::new(Memory::default());
        let first = run(&store);
        let plain = DrawnPictures::default();
        let bark = Bark { size_px: 64, ..Bark::new(BarkStyle::Birch, Key::new(3)) };
        assert_eq!(first.0, plain.bark(&bark, &Quiet).unwrap());
        let entries = store.entries();
        assert_eq!(entries, 2 + 2 + 2 + 2);
        assert_eq!(run(&store), first);
        assert_eq!(store.entries(), entries, "nothing was drawn again");
        first.2.normal.png().unwrap();
        assert_eq!(store.entries(), entries + 1, "its file is kept too");
    }

    #[test]
    fn what_is_damaged_is_drawn_again() {
        let store = Arc::new(Memory::default());
        let first = run(&store);
        let whole = store.0.lock().unwrap().clone();
        for length in [0, 3, 17, 4000] {
            for bytes in store.0.lock().unwrap().values_mut() {
                bytes.truncate(length);
            }
            assert_eq!(run(&store), first, "{length}");
            assert_eq!(*store.0.lock().unwrap(), whole, "{length}");
        }
    }

    #[test]
    fn whatever_decides_a_picture_decides_its_key() {
        let store = Arc::new(Memory::default());
        let drawn = DrawnPictures::default().kept_in(store.clone());
        let bark = Bark { size_px: 16, ..Bark::new(BarkStyle::Birch, Key::new(3)) };
        let others = [
            Bark { style: BarkStyle::Ridged, ..bark },
            Bark { color: [212, 208, 199], ..bark },
            Bark { roughness: 1.0_f32.next_up(), ..bark },
            Bark { lenticels: 0.1, ..bark },
            Bark { relief: 0.009, ..bark },
            Bark { size_px: 17, ..bark },
            Bark { key: Key::new(4), ..bark },
        ];
        for (index, bark) in [bark].iter().chain(&others).enumerate() {
            drawn.bark(bark, &Quiet).unwrap();
            assert_eq!(store.entries(), 2 * (index + 1), "{bark:?}");
        }
    }

    #[test]
    fn cells_come_back_to_the_last_bit() {
        for back_colors in [vec![], vec![[200, 210, 220]]] {
            let look = LeafLook { size_px: 64, variants: 5, back_colors, ..LeafLook::new(Outline::Palmate) };
            let LeafPictures { cells, backs, .. } = look.draw(Key::new(2), &Quiet).unwrap();
            let bytes = write_cells(&cells, &backs);
            assert!(read_cells(&bytes[..bytes.len() - 8]).is_none());
            assert!(read_cells(&bytes[..bytes.len() - 3]).is_none());
            assert_eq!(read_cells(&bytes), Some((cells, backs)));
        }
        assert_eq!(read_cells(&[]), None);
        // More backs than cells.
        assert_eq!(read_cells(&[0, 0, 128, 63, 0, 0, 0, 0]), None);
    }
}
