//! Specs, the fields that they have, and the sections that say so.

use std::collections::BTreeMap;

use super::compress::{blocks, integers};
use super::values::{Rep, Values};

/// Name, version, the place of the contents, and room that nobody uses.
pub(super) const BOOTSTRAP: usize = 88;
/// How a crate file begins.
pub(super) const MAGIC: &[u8; 8] = b"PXR-USDC";
const VERSION: [u8; 8] = [0, 8, 0, 0, 0, 0, 0, 0];
/// Ends a set of fields.
const END: u32 = u32::MAX;

/// What a spec is of (`SdfSpecType`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SpecKind {
    Attribute = 1,
    Prim = 6,
    Layer = 7,
    Relationship = 8,
    Variant = 10,
    VariantSet = 11,
}

/// A path, as what it adds to the one that it is under.
struct Path {
    parent: u32,
    /// A token; that of a property is negative.
    element: i32,
}

/// A crate file up to its sections.
pub(super) struct Build {
    pub values: Values,
    paths: Vec<Path>,
    path_numbers: BTreeMap<(u32, i32), u32>,
    fields: BTreeMap<(u32, Rep), u32>,
    /// `fields` in their order.
    field_list: Vec<(u32, Rep)>,
    sets: BTreeMap<Vec<u32>, u32>,
    /// All sets, each with its end.
    set_list: Vec<u32>,
    specs: Vec<(u32, u32, SpecKind)>,
}

/// The path of the layer itself.
pub(super) const ROOT: u32 = 0;

impl Build {
    pub fn new() -> Self {
        Self {
            values: Values::behind(BOOTSTRAP),
            paths: vec![Path { parent: ROOT, element: 0 }],
            path_numbers: BTreeMap::new(),
            fields: BTreeMap::new(),
            field_list: Vec::new(),
            sets: BTreeMap::new(),
            set_list: Vec::new(),
            specs: Vec::new(),
        }
    }

    /// The prim, variant (`{set=variant}`) or set (`{set=}`) below a path.
    pub fn child(&mut self, parent: u32, element: &str) -> u32 {
        let token = self.values.token(element) as i32;
        self.path(parent, token)
    }

    pub fn property(&mut self, parent: u32, name: &str) -> u32 {
        let token = self.values.token(name) as i32;
        self.path(parent, -token)
    }

    fn path(&mut self, parent: u32, element: i32) -> u32 {
        *self.path_numbers.entry((parent, element)).or_insert_with(|| {
            self.paths.push(Path { parent, element });
            self.paths.len() as u32 - 1
        })
    }

    /// An absolute path as text has it.
    pub fn path_of(&mut self, text: &str) -> Option<u32> {
        let (prims, property) = match text.split_once('.') {
            Some((prims, property)) => (prims, Some(property)),
            None => (text, None),
        };
        let mut path = ROOT;
        for prim in prims.strip_prefix('/')?.split('/').filter(|prim| !prim.is_empty()) {
            path = self.child(path, prim);
        }
        Some(property.map_or(path, |property| self.property(path, property)))
    }

    /// A spec with its fields by name.
    pub fn spec(&mut self, path: u32, kind: SpecKind, fields: &[(&str, Rep)]) {
        let mut set = Vec::with_capacity(fields.len() + 1);
        for &(name, value) in fields {
            let field = (self.values.token(name), value);
            set.push(*self.fields.entry(field).or_insert_with(|| {
                self.field_list.push(field);
                self.field_list.len() as u32 - 1
            }));
        }
        set.push(END);
        let at = match self.sets.get(&set) {
            Some(&at) => at,
            None => {
                let at = self.set_list.len() as u32;
                self.set_list.extend(&set);
                self.sets.insert(set, at);
                at
            }
        };
        self.specs.push((path, at, kind));
    }

    /// The whole file.
    pub fn finish(mut self) -> Vec<u8> {
        let mut bytes = std::mem::take(&mut self.values.bytes);
        let mut contents = Vec::new();
        let mut section = |name: &str, data: &[u8]| {
            let mut entry = name.as_bytes().to_vec();
            entry.resize(16, 0);
            entry.extend((bytes.len() as u64).to_le_bytes());
            entry.extend((data.len() as u64).to_le_bytes());
            contents.push(entry);
            bytes.extend(data);
        };
        section("TOKENS", &self.tokens());
        section("STRINGS", &self.strings());
        section("FIELDS", &self.fields());
        section("FIELDSETS", &self.sets());
        section("PATHS", &self.paths());
        section("SPECS", &self.specs());
        let at = bytes.len() as u64;
        bytes.extend((contents.len() as u64).to_le_bytes());
        bytes.extend(contents.concat());
        bytes[..8].copy_from_slice(MAGIC);
        bytes[8..16].copy_from_slice(&VERSION);
        bytes[16..24].copy_from_slice(&at.to_le_bytes());
        bytes
    }

    fn tokens(&self) -> Vec<u8> {
        let mut text = Vec::new();
        for token in &self.values.tokens {
            text.extend(token.as_bytes());
            text.push(0);
        }
        let packed = blocks(&text);
        [self.values.tokens.len(), text.len(), packed.len()]
            .iter()
            .flat_map(|count| (*count as u64).to_le_bytes())
            .chain(packed)
            .collect()
    }

    fn strings(&self) -> Vec<u8> {
        let strings = &self.values.strings;
        let numbers = strings.iter().flat_map(|token| token.to_le_bytes());
        (strings.len() as u64).to_le_bytes().into_iter().chain(numbers).collect()
    }

    fn fields(&self) -> Vec<u8> {
        let mut data = (self.field_list.len() as u64).to_le_bytes().to_vec();
        push(&mut data, &integers(&self.field_list.iter().map(|(name, _)| *name as i32)));
        let values: Vec<u8> = self.field_list.iter().flat_map(|(_, value)| value.to_le_bytes()).collect();
        push(&mut data, &blocks(&values));
        data
    }

    fn sets(&self) -> Vec<u8> {
        let mut data = (self.set_list.len() as u64).to_le_bytes().to_vec();
        push(&mut data, &integers(&self.set_list.iter().map(|field| *field as i32)));
        data
    }

    fn specs(&self) -> Vec<u8> {
        let mut data = (self.specs.len() as u64).to_le_bytes().to_vec();
        push(&mut data, &integers(&self.specs.iter().map(|(path, ..)| *path as i32)));
        push(&mut data, &integers(&self.specs.iter().map(|(_, fields, _)| *fields as i32)));
        push(&mut data, &integers(&self.specs.iter().map(|(.., kind)| *kind as i32)));
        data
    }

    /// The tree of paths, each before those below it. A jump says what is next: -2 neither a path below nor a sibling, -1
    /// only what is below, 0 only a sibling, otherwise both, and how far it is to the sibling.
    fn paths(&self) -> Vec<u8> {
        let mut below: Vec<Vec<u32>> = vec![Vec::new(); self.paths.len()];
        let mut sizes = vec![1_i32; self.paths.len()];
        // A path is listed behind the one that it is under.
        for (number, path) in self.paths.iter().enumerate().skip(1) {
            below[path.parent as usize].push(number as u32);
        }
        for (number, path) in self.paths.iter().enumerate().skip(1).rev() {
            sizes[path.parent as usize] += sizes[number];
        }
        let mut order = Vec::with_capacity(self.paths.len());
        let mut jumps = Vec::with_capacity(self.paths.len());
        let mut next = vec![(ROOT, false)];
        while let Some((number, has_sibling)) = next.pop() {
            let children = &below[number as usize];
            jumps.push(match (children.is_empty(), has_sibling) {
                (true, false) => -2,
                (false, false) => -1,
                (true, true) => 0,
                (false, true) => sizes[number as usize],
            });
            order.push(number);
            let last = children.last();
            next.extend(children.iter().rev().map(|child| (*child, Some(child) != last)));
        }
        let count = (self.paths.len() as u64).to_le_bytes();
        let mut data = [count, count].concat();
        push(&mut data, &integers(&order.iter().map(|number| *number as i32)));
        push(&mut data, &integers(&order.iter().map(|number| self.paths[*number as usize].element)));
        push(&mut data, &integers(&jumps.iter().copied()));
        data
    }
}

/// Appends what was compressed, its length before it.
fn push(data: &mut Vec<u8>, packed: &[u8]) {
    data.extend((packed.len() as u64).to_le_bytes());
    data.extend(packed);
}
