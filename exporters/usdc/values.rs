//! Values, each different one once, and the names that they and everything else are told by.

use std::collections::BTreeMap;

use xxhash_rust::xxh3::xxh3_128;

use super::compress::integers;
use super::kind::{Kind, Scalar};
use super::literal::Literal;

/// From so many elements on, integers are compressed.
const LEAST_COMPRESSED: usize = 16;

const IS_ARRAY: u64 = 1 << 63;
const IS_INLINED: u64 = 1 << 62;
const IS_COMPRESSED: u64 = 1 << 61;

/// Types besides those of attributes.
pub(super) mod number {
    pub const INT: u8 = 3;
    pub const DICTIONARY: u8 = 31;
    pub const TOKEN_LIST: u8 = 32;
    pub const STRING_LIST: u8 = 33;
    pub const PATH_LIST: u8 = 34;
    pub const REFERENCE_LIST: u8 = 35;
    pub const TOKEN_VECTOR: u8 = 41;
    pub const SPECIFIER: u8 = 42;
    pub const VARIABILITY: u8 = 44;
    pub const VARIANT_SELECTION: u8 = 45;
    pub const TIME_SAMPLES: u8 = 46;
    pub const DOUBLE_VECTOR: u8 = 48;
    pub const PAYLOAD_LIST: u8 = 55;
}

/// Which items of a list operation follow its header.
#[derive(Clone, Copy)]
pub(super) enum Listed {
    /// All there are.
    Explicit,
    /// Before those of weaker layers.
    Prepended,
}

/// A value as fields have it.
pub(super) type Rep = u64;

/// The bytes of a crate file up to its sections.
pub(super) struct Values {
    pub bytes: Vec<u8>,
    pub tokens: Vec<String>,
    /// Tokens by number.
    pub strings: Vec<u32>,
    token_numbers: BTreeMap<String, u32>,
    string_numbers: BTreeMap<u32, u32>,
    /// Where values stand, by their type and a sum of their bytes that no two differing ones share.
    places: BTreeMap<(u64, u128), u64>,
}

impl Values {
    /// Behind a head that is filled in at last.
    pub fn behind(head: usize) -> Self {
        let mut values = Self {
            bytes: vec![0; head],
            tokens: Vec::new(),
            strings: Vec::new(),
            token_numbers: BTreeMap::new(),
            string_numbers: BTreeMap::new(),
            places: BTreeMap::new(),
        };
        // Paths have negative tokens where they end in a property: none may be 0.
        values.token("");
        values
    }

    pub fn token(&mut self, text: &str) -> u32 {
        if text.contains('\0') {
            // It would end the token.
            return self.token(&text.replace('\0', ""));
        }
        if let Some(&number) = self.token_numbers.get(text) {
            return number;
        }
        let number = self.tokens.len() as u32;
        self.tokens.push(text.to_owned());
        self.token_numbers.insert(text.to_owned(), number);
        number
    }

    pub fn string(&mut self, text: &str) -> u32 {
        let token = self.token(text);
        *self.string_numbers.entry(token).or_insert_with(|| {
            self.strings.push(token);
            self.strings.len() as u32 - 1
        })
    }

    /// A value that 32 bits hold.
    pub fn inlined(number: u8, bits: u32) -> Rep {
        IS_INLINED | u64::from(number) << 48 | u64::from(bits)
    }

    /// A value that stands among the others.
    pub fn stands(&mut self, number: u8, bytes: &[u8]) -> Rep {
        self.place(u64::from(number) << 48, bytes)
    }

    fn place(&mut self, rep: u64, bytes: &[u8]) -> Rep {
        let place = *self.places.entry((rep, xxh3_128(bytes))).or_insert_with(|| {
            // Readers map arrays into memory.
            self.bytes.resize(self.bytes.len().next_multiple_of(8), 0);
            let at = self.bytes.len();
            self.bytes.extend(bytes);
            at as u64
        });
        rep | place
    }

    /// An array, its elements as they lie in memory.
    pub fn array(&mut self, kind: Kind, count: usize, elements: &[u8]) -> Rep {
        let rep = IS_ARRAY | u64::from(kind.number) << 48;
        if count == 0 {
            return rep;
        }
        let mut bytes = (count as u64).to_le_bytes().to_vec();
        if kind.scalar != Scalar::Int || count < LEAST_COMPRESSED {
            bytes.extend(elements);
            return self.place(rep, &bytes);
        }
        let (numbers, _) = elements.as_chunks::<4>();
        let packed = integers(&numbers.iter().map(|bytes| i32::from_le_bytes(*bytes)));
        bytes.extend((packed.len() as u64).to_le_bytes());
        bytes.extend(packed);
        self.place(rep | IS_COMPRESSED, &bytes)
    }

    /// The value of an attribute.
    pub fn attribute(&mut self, kind: Kind, is_array: bool, value: &Literal<'_>) -> Option<Rep> {
        if is_array {
            let Literal::List(values) = value else { return None };
            let mut elements = Vec::new();
            for value in values {
                match kind.scalar {
                    Scalar::String | Scalar::Token | Scalar::Asset => {
                        elements.extend(self.name(kind.scalar, value)?.to_le_bytes());
                    }
                    _ => kind.push(&mut elements, value)?,
                }
            }
            return Some(self.array(kind, values.len(), &elements));
        }
        if matches!(kind.scalar, Scalar::String | Scalar::Token | Scalar::Asset) {
            return Some(Self::inlined(kind.number, self.name(kind.scalar, value)?));
        }
        let mut bytes = Vec::new();
        kind.push(&mut bytes, value)?;
        Some(if bytes.len() <= 4 {
            bytes.resize(4, 0);
            Self::inlined(kind.number, bytes.first_chunk().map_or(0, |bits| u32::from_le_bytes(*bits)))
        } else {
            self.stands(kind.number, &bytes)
        })
    }

    pub fn token_of(&mut self, value: &Literal<'_>) -> Option<u32> {
        self.name(Scalar::Token, value)
    }

    fn name(&mut self, scalar: Scalar, value: &Literal<'_>) -> Option<u32> {
        match (scalar, value) {
            (Scalar::String, Literal::Text(text)) => Some(self.string(text)),
            (Scalar::Token, Literal::Text(text)) => Some(self.token(text)),
            (Scalar::Asset, Literal::Asset(path)) => Some(self.token(path)),
            _ => None,
        }
    }

    pub fn token_value(&mut self, text: &str) -> Rep {
        let token = self.token(text);
        Self::inlined(11, token)
    }

    pub fn string_value(&mut self, text: &str) -> Rep {
        let string = self.string(text);
        Self::inlined(10, string)
    }

    pub fn token_vector(&mut self, tokens: &[u32]) -> Rep {
        let bytes = counted(tokens);
        self.stands(number::TOKEN_VECTOR, &bytes)
    }

    /// A list operation on tokens, strings or paths.
    pub fn list(&mut self, number: u8, listed: Listed, items: &[u32]) -> Rep {
        let mut bytes = vec![listed.header()];
        bytes.extend(counted(items));
        self.stands(number, &bytes)
    }

    /// References to prims of the layer itself, before others.
    pub fn references(&mut self, paths: &[u32]) -> Rep {
        let mut bytes = vec![Listed::Prepended.header()];
        bytes.extend((paths.len() as u64).to_le_bytes());
        let this = self.string("");
        for path in paths {
            bytes.extend(this.to_le_bytes());
            bytes.extend(path.to_le_bytes());
            // Times as they are: offset and scale; no `customData`.
            bytes.extend([0.0_f64, 1.0].iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend(0_u64.to_le_bytes());
        }
        self.stands(number::REFERENCE_LIST, &bytes)
    }

    /// A payload: a prim of another layer, before other payloads.
    pub fn payload(&mut self, layer: &str, prim: u32) -> Rep {
        let mut bytes = vec![Listed::Prepended.header()];
        bytes.extend(1_u64.to_le_bytes());
        bytes.extend(self.string(layer).to_le_bytes());
        bytes.extend(prim.to_le_bytes());
        // Times as they are: offset and scale.
        bytes.extend([0.0_f64, 1.0].iter().flat_map(|x| x.to_le_bytes()));
        self.stands(number::PAYLOAD_LIST, &bytes)
    }

    /// A dictionary, keys in their order.
    pub fn dictionary(&mut self, entries: &[(u32, Rep)]) -> Rep {
        let mut bytes = (entries.len() as u64).to_le_bytes().to_vec();
        for (key, value) in entries {
            bytes.extend(key.to_le_bytes());
            bytes.extend(value_follows());
            bytes.extend(value.to_le_bytes());
        }
        self.stands(number::DICTIONARY, &bytes)
    }

    pub fn selection(&mut self, chosen: &[(u32, u32)]) -> Rep {
        let mut bytes = (chosen.len() as u64).to_le_bytes().to_vec();
        bytes.extend(
            chosen.iter().flat_map(|(set, variant)| [set.to_le_bytes(), variant.to_le_bytes()]).flatten(),
        );
        self.stands(number::VARIANT_SELECTION, &bytes)
    }

    pub fn samples(&mut self, times: &[f64], values: &[Rep]) -> Rep {
        let mut bytes = (times.len() as u64).to_le_bytes().to_vec();
        bytes.extend(times.iter().flat_map(|time| time.to_le_bytes()));
        let times = self.stands(number::DOUBLE_VECTOR, &bytes);
        let mut bytes = value_follows().to_vec();
        bytes.extend(times.to_le_bytes());
        bytes.extend(value_follows());
        bytes.extend((values.len() as u64).to_le_bytes());
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        self.stands(number::TIME_SAMPLES, &bytes)
    }
}

impl Listed {
    /// The bits of a list operation (`Sdf_CrateFile::_ListOpHeader`).
    fn header(self) -> u8 {
        match self {
            Self::Explicit => 1 | 2,
            Self::Prepended => 32,
        }
    }
}

/// How far it is to a nested value, from this number on: it is next, since what it needs stands before.
fn value_follows() -> [u8; 8] {
    8_u64.to_le_bytes()
}

fn counted(numbers: &[u32]) -> Vec<u8> {
    let mut bytes = (numbers.len() as u64).to_le_bytes().to_vec();
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}
