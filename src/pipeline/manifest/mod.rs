//! Many trees: sources, seeds and values of knobs, multiplied out into numbered items.
//!
//! ```
//! use linden_pipeline::manifest::Manifest;
//! let manifest = Manifest::parse(
//!     r#"
//!     formats = ["glb"]
//!     [[trees]]
//!     source = "oak"
//!     seeds = "1..3"
//!     set = { season = [0.2, 0.8], bole = "2..3.5" }
//!     "#,
//! )?;
//! assert_eq!(manifest.len(), 6);
//! let item = manifest.item(4).expect("there are six");
//! assert_eq!((item.seed, item.set[1].1.as_str()), (Some(2), "0.8")); // knobs in the order of their names
//! # Ok::<(), linden_pipeline::document::Fault>(())
//! ```
//!
//! Items are numbered from 0, in the order of the document: its `[[trees]]`, within these the product of all lists
//! (the last knob's values fastest), then `samples`, then seeds, then ages. The same number is the same tree in whatever parts a
//! manifest is worked on. What is drawn is drawn with a key of the item's place in its own `[[trees]]`, so that trees
//! that are added before or behind change nothing.

mod document;
mod draw;
pub mod values;

use std::collections::BTreeMap;

use linden_base::knob::Spread;
use linden_base::random::Key;

/// Many trees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Manifest {
    /// Identifiers of formats in which each tree is written that names none itself.
    pub formats: Vec<String>,
    /// Options of formats: `FORMAT.OPTION` and value.
    pub options: BTreeMap<String, String>,
    /// Decides what is drawn.
    pub seed: u64,
    /// Kinds of trees.
    pub trees: Vec<TreeKind>,
}

/// Trees of one source.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeKind {
    /// A preset's id, or a file beside the manifest.
    pub source: String,
    /// As [`Manifest::formats`], for these trees; empty: those.
    pub formats: Vec<String>,
    /// The first seed and how many there are; `None`: the source's own.
    pub seeds: Option<Seeds>,
    /// Ages at which each tree is grown, as `--age` names one; empty: the source's.
    pub ages: Vec<String>,
    /// How many trees of each combination, with other draws.
    pub samples: u64,
    /// How values are drawn over the samples.
    pub sampling: Sampling,
    /// Knobs in the order of their names.
    pub set: Vec<Varied>,
    /// Constants of the grammar.
    pub define: Vec<Varied>,
}

/// Seeds of trees.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seeds {
    /// From the first to the last, both included.
    Range(u64, u64),
    /// One by one.
    List(Vec<u64>),
}

linden_base::words! {
    /// How values are drawn over the samples of a kind.
    #[derive(Default)]
    Sampling {
        /// Each by itself.
        #[default]
        Random = "random",
        /// Latin hypercube (McKay, Beckman & Conover 1979): of N samples each has another Nth of every range.
        Latin = "latin",
    }
}

/// A knob or a constant with what it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// Its name.
    pub name: String,
    /// What it is given.
    pub values: Values,
}

/// What a knob is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Each of them.
    Each(Vec<String>),
    /// One that is drawn.
    Drawn(Spread),
}

/// One tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Item<'a> {
    /// From 0.
    pub number: usize,
    /// A preset's id, or a file beside the manifest.
    pub source: &'a str,
    /// Identifiers of the formats that it is written in.
    pub formats: &'a [String],
    /// `None`: the source's own.
    pub seed: Option<u64>,
    /// Its age, as `--age` names one; `None`: the source's.
    pub age: Option<&'a str>,
    /// Knobs and values.
    pub set: Vec<(&'a str, String)>,
    /// Constants of the grammar and values.
    pub define: Vec<(&'a str, String)>,
}

impl Seeds {
    fn len(&self) -> usize {
        match self {
            Self::Range(first, last) => usize::try_from(last - first).unwrap_or(usize::MAX).saturating_add(1),
            Self::List(list) => list.len(),
        }
    }

    fn at(&self, index: usize) -> u64 {
        match self {
            Self::Range(first, _) => first + index as u64,
            Self::List(list) => list[index],
        }
    }
}

impl TreeKind {
    /// How many trees there are.
    pub fn count(&self) -> usize {
        let seeds = self.seeds.as_ref().map_or(1, Seeds::len);
        let samples = usize::try_from(self.samples).unwrap_or(usize::MAX);
        let lists = self.varied().map(|varied| match &varied.values {
            Values::Each(values) => values.len(),
            Values::Drawn(_) => 1,
        });
        let trees = lists.fold(seeds.saturating_mul(samples), usize::saturating_mul);
        trees.saturating_mul(self.ages.len().max(1))
    }

    fn varied(&self) -> impl DoubleEndedIterator<Item = &Varied> {
        self.set.iter().chain(&self.define)
    }

    /// The tree at a place of this kind.
    fn item(&self, place: usize, number: usize, key: Key) -> Item<'_> {
        // All ages of a tree have the same draws, which are those without ages.
        let (place, age) = (place / self.ages.len().max(1), place % self.ages.len().max(1));
        let seeds = self.seeds.as_ref().map_or(1, Seeds::len);
        let (rest, seed) = (place / seeds, place % seeds);
        let (mut rest, sample) = (rest / self.samples as usize, rest % self.samples as usize);
        let mut values: Vec<String> = self
            .varied()
            .rev()
            .map(|varied| match &varied.values {
                Values::Each(list) => {
                    let value = list[rest % list.len()].clone();
                    rest /= list.len();
                    value
                }
                Values::Drawn(spread) => {
                    let of_knob = key.named(&varied.name);
                    let share = |number: usize| {
                        // Each number of a list is a dimension; the first has the key that one number has.
                        let key =
                            if number == 0 { of_knob } else { of_knob.named("number").child(number as u64) };
                        match self.sampling {
                            Sampling::Random => key.child(place as u64).unit(),
                            // Each combination and seed has a hypercube of its own.
                            Sampling::Latin => {
                                let cube =
                                    key.child((place / seeds / self.samples as usize * seeds + seed) as u64);
                                draw::stratum(cube, sample as u64, self.samples)
                            }
                        }
                    };
                    spread.quantile(share).to_string()
                }
            })
            .collect();
        values.reverse();
        let define = values.split_off(self.set.len());
        Item {
            number,
            source: &self.source,
            formats: &self.formats,
            seed: self.seeds.as_ref().map(|seeds| seeds.at(seed)),
            age: self.ages.get(age).map(String::as_str),
            set: self.set.iter().map(|varied| varied.name.as_str()).zip(values).collect(),
            define: self.define.iter().map(|varied| varied.name.as_str()).zip(define).collect(),
        }
    }
}

impl Manifest {
    /// How many trees there are.
    pub fn len(&self) -> usize {
        self.trees.iter().fold(0, |sum: usize, kind| sum.saturating_add(kind.count()))
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The tree with a number, from 0.
    pub fn item(&self, number: usize) -> Option<Item<'_>> {
        let mut place = number;
        for kind in &self.trees {
            if place < kind.count() {
                let key = Key::new(self.seed).named("batch").named(&kind.source);
                let mut item = kind.item(place, number, key);
                if item.formats.is_empty() {
                    item.formats = &self.formats;
                }
                return Some(item);
            }
            place -= kind.count();
        }
        None
    }
}
