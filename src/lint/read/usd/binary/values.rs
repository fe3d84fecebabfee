//! Values, as far as models are looked at.

use std::collections::HashMap;

use openusd::gf::{
    Matrix4d, Quatd, Quatf, Quath, Vec2d, Vec2f, Vec2h, Vec2i, Vec3d, Vec3f, Vec3h, Vec3i, Vec4d, Vec4f,
    Vec4h, Vec4i, f16,
};
use openusd::sdf::{AssetPath, ListOp, Path, Payload, Value};

use super::super::{ReadError, broken};
use super::bytes::{Bytes, Room};
use super::element::{Element, Scalar};
use super::packed::integers;
use super::sections::Names;

/// A value as fields have it: its type, and itself or where it stands.
#[derive(Clone, Copy)]
pub(super) struct Rep(pub u64);

impl Rep {
    const IS_ARRAY: u64 = 1 << 63;
    const IS_INLINED: u64 = 1 << 62;
    const IS_COMPRESSED: u64 = 1 << 61;
    /// Bits of newer versions: an array with one of them is a change of another array.
    const IS_OTHER: u64 = 31 << 56;

    fn has(self, bit: u64) -> bool {
        self.0 & bit != 0
    }

    fn kind(self) -> u8 {
        (self.0 >> 48) as u8
    }

    /// Where it stands.
    fn place(self) -> u64 {
        self.0 & ((1 << 48) - 1)
    }

    fn bits(self) -> u32 {
        self.0 as u32
    }
}

/// The values of a file.
pub(super) struct Values<'a> {
    /// The whole file.
    pub bytes: &'a [u8],
    /// The second number of its version.
    pub minor: u8,
    pub names: &'a Names,
    pub paths: &'a [Path],
}

const ARRAY: &str = "an array";
const VALUE: &str = "a value";
const LIST: &str = "a list of paths";
const PAYLOADS: &str = "a list of payloads";
/// The version from which on payloads have an offset and a scale in time.
const WITH_OFFSETS: u8 = 8;
/// Shorter arrays are never compressed.
const LEAST_COMPRESSED: usize = 16;
/// A string or path besides its letters.
const NAME_BYTES: usize = 32;

/// A list operation: bits that say which lists follow, each of which `read` reads.
fn list_op<'a, T: Default + Clone + PartialEq>(
    bytes: &mut Bytes<'a>,
    mut read: impl FnMut(&mut Bytes<'a>) -> Result<Vec<T>, ReadError>,
) -> Result<ListOp<T>, ReadError> {
    let [bits] = bytes.numbers()?;
    let mut items = |bit: u8| if bits & bit == 0 { Ok(Vec::new()) } else { read(bytes) };
    Ok(ListOp {
        explicit: bits & 1 != 0,
        explicit_items: items(2)?,
        added_items: items(4)?,
        prepended_items: items(32)?,
        appended_items: items(64)?,
        deleted_items: items(8)?,
        ordered_items: items(16)?,
    })
}

impl Values<'_> {
    /// A value; `None` where it is of a type that nobody looks at.
    pub fn read(&self, rep: Rep, room: &mut Room<'_>) -> Result<Option<Value>, ReadError> {
        macro_rules! of {
            ($type:ty, $one:ident, $many:ident, $array:ident) => {
                if rep.has(Rep::IS_ARRAY) {
                    Value::$many(self.$array::<$type>(rep, room)?)
                } else {
                    Value::$one(self.one::<$type>(rep)?)
                }
            };
        }
        if rep.has(Rep::IS_OTHER) {
            return Ok(None);
        }
        let is_array = rep.has(Rep::IS_ARRAY);
        // Numbers of types: `crateDataTypes.h` of OpenUSD.
        Ok(Some(match rep.kind() {
            1 if is_array => {
                Value::BoolVec(self.array::<u8>(rep, room)?.into_iter().map(|byte| byte != 0).collect())
            }
            1 => Value::Bool(self.one::<u8>(rep)? != 0),
            2 => of!(u8, Uchar, UcharVec, array),
            3 => of!(i32, Int, IntVec, whole),
            4 => of!(u32, Uint, UintVec, whole),
            5 => of!(i64, Int64, Int64Vec, whole),
            6 => of!(u64, Uint64, Uint64Vec, whole),
            7 => of!(f16, Half, HalfVec, real),
            8 => of!(f32, Float, FloatVec, real),
            9 => of!(f64, Double, DoubleVec, real),
            10 if !is_array => {
                let text = self.names.string(self.one(rep)?)?;
                room.take(text.len(), 1)?;
                Value::String(text.to_owned())
            }
            11 if is_array => Value::TokenVec(self.tokens(&self.array(rep, room)?, room)?),
            11 => Value::Token(self.token(self.one(rep)?, room)?.into()),
            12 if !is_array => Value::AssetPath(AssetPath::new(self.token(self.one(rep)?, room)?)),
            15 => of!(Matrix4d, Matrix4d, Matrix4dVec, array),
            16 => of!(Quatd, Quatd, QuatdVec, array),
            17 => of!(Quatf, Quatf, QuatfVec, array),
            18 => of!(Quath, Quath, QuathVec, array),
            19 => of!(Vec2d, Vec2d, Vec2dVec, array),
            20 => of!(Vec2f, Vec2f, Vec2fVec, array),
            21 => of!(Vec2h, Vec2h, Vec2hVec, array),
            22 => of!(Vec2i, Vec2i, Vec2iVec, array),
            23 => of!(Vec3d, Vec3d, Vec3dVec, array),
            24 => of!(Vec3f, Vec3f, Vec3fVec, array),
            25 => of!(Vec3h, Vec3h, Vec3hVec, array),
            26 => of!(Vec3i, Vec3i, Vec3iVec, array),
            27 => of!(Vec4d, Vec4d, Vec4dVec, array),
            28 => of!(Vec4f, Vec4f, Vec4fVec, array),
            29 => of!(Vec4h, Vec4h, Vec4hVec, array),
            30 => of!(Vec4i, Vec4i, Vec4iVec, array),
            34 => self.path_list(rep, room)?,
            40 => Value::PathVec(self.paths(&mut self.at(rep, LIST)?, room)?),
            41 => Value::TokenVec(self.tokens(&listed(&mut self.at(rep, VALUE)?, room)?, room)?),
            45 => self.selection(rep, room)?,
            47 => Value::Payload(self.payload(&mut self.at(rep, PAYLOADS)?, room)?),
            51 => Value::ValueBlock,
            55 => self.payload_list(rep, room)?,
            _ => return Ok(None),
        }))
    }

    fn at(&self, rep: Rep, what: &'static str) -> Result<Bytes<'_>, ReadError> {
        if rep.has(Rep::IS_INLINED) {
            return Err(broken(format!("{what} stands where a number should")));
        }
        Bytes::at(self.bytes, rep.place(), what)
    }

    fn one<T: Element>(&self, rep: Rep) -> Result<T, ReadError> {
        if rep.has(Rep::IS_INLINED) {
            return T::inlined(rep.bits()).ok_or_else(|| broken("a value stands in fewer bits than it has"));
        }
        Ok(T::read(Bytes::at(self.bytes, rep.place(), VALUE)?.take(T::SIZE)?))
    }

    /// How many elements an array has, and its bytes; `None` where it is empty.
    fn counted(&self, rep: Rep) -> Result<Option<(usize, Bytes<'_>)>, ReadError> {
        if rep.place() == 0 {
            return Ok(None);
        }
        let mut bytes = self.at(rep, ARRAY)?;
        if self.minor < 5 {
            // The number of dimensions, which is 1.
            bytes.numbers::<4>()?;
        }
        let count =
            if self.minor < 7 { u32::from_le_bytes(bytes.numbers()?) as usize } else { bytes.count()? };
        Ok(Some((count, bytes)))
    }

    /// An array that is as it is in memory.
    fn array<T: Element>(&self, rep: Rep, room: &mut Room<'_>) -> Result<Vec<T>, ReadError> {
        let Some((count, mut bytes)) = self.counted(rep)? else { return Ok(Vec::new()) };
        if rep.has(Rep::IS_COMPRESSED) && count >= LEAST_COMPRESSED {
            return Err(bytes.broken("is compressed that is of no numbers"));
        }
        plain(count, &mut bytes, room)
    }

    /// An array of integers, as it is or compressed.
    fn whole<T: Scalar>(&self, rep: Rep, room: &mut Room<'_>) -> Result<Vec<T>, ReadError> {
        match self.counted(rep)? {
            None => Ok(Vec::new()),
            Some((count, mut bytes)) if rep.has(Rep::IS_COMPRESSED) && count >= LEAST_COMPRESSED => {
                integers(bytes.counted()?, count, ARRAY, room)
            }
            Some((count, mut bytes)) => plain(count, &mut bytes, room),
        }
    }

    /// An array of floats, as it is or compressed: as integers, or as indices into a table.
    fn real<T: Scalar>(&self, rep: Rep, room: &mut Room<'_>) -> Result<Vec<T>, ReadError> {
        let Some((count, mut bytes)) = self.counted(rep)? else { return Ok(Vec::new()) };
        if !rep.has(Rep::IS_COMPRESSED) || count < LEAST_COMPRESSED {
            return plain(count, &mut bytes, room);
        }
        let [code] = bytes.numbers()?;
        match code {
            b'i' => {
                let whole = integers::<i32>(bytes.counted()?, count, ARRAY, room)?;
                room.take(count, T::SIZE)?;
                Ok(whole.into_iter().map(|number| T::of(number.into())).collect())
            }
            b't' => {
                let size = u32::from_le_bytes(bytes.numbers()?) as usize;
                let table: Vec<T> = plain(size, &mut bytes, room)?;
                let indices = integers::<u32>(bytes.counted()?, count, ARRAY, room)?;
                room.take(count, T::SIZE)?;
                let numbers: Option<Vec<T>> =
                    indices.into_iter().map(|index| table.get(index as usize).copied()).collect();
                numbers.ok_or_else(|| bytes.broken("names a number that is not in its table"))
            }
            _ => Err(bytes.broken("is compressed in a way that is not known; write the file again")),
        }
    }

    fn token(&self, number: u32, room: &mut Room<'_>) -> Result<&str, ReadError> {
        let token = self.names.token(number)?;
        room.take(token.len(), 1)?;
        Ok(token)
    }

    fn tokens<T: for<'t> From<&'t str>>(
        &self,
        numbers: &[u32],
        room: &mut Room<'_>,
    ) -> Result<Vec<T>, ReadError> {
        room.take(numbers.len(), NAME_BYTES)?;
        numbers.iter().map(|number| Ok(self.token(*number, room)?.into())).collect()
    }

    fn paths(&self, bytes: &mut Bytes<'_>, room: &mut Room<'_>) -> Result<Vec<Path>, ReadError> {
        let numbers = listed(bytes, room)?;
        room.take(numbers.len(), NAME_BYTES)?;
        let path = |number: u32| {
            let path = self.paths.get(number as usize);
            let path = path.ok_or_else(|| bytes.broken("has one that is not in the section PATHS"))?;
            room.take(path.as_str().len(), 1)?;
            Ok(path.clone())
        };
        numbers.into_iter().map(path).collect()
    }

    fn path_list(&self, rep: Rep, room: &mut Room<'_>) -> Result<Value, ReadError> {
        let mut bytes = self.at(rep, LIST)?;
        Ok(Value::PathListOp(list_op(&mut bytes, |bytes| self.paths(bytes, room))?))
    }

    fn payload_list(&self, rep: Rep, room: &mut Room<'_>) -> Result<Value, ReadError> {
        let mut bytes = self.at(rep, PAYLOADS)?;
        Ok(Value::PayloadListOp(list_op(&mut bytes, |bytes| self.payloads(bytes, room))?))
    }

    fn payloads(&self, bytes: &mut Bytes<'_>, room: &mut Room<'_>) -> Result<Vec<Payload>, ReadError> {
        (0..bytes.count()?).map(|_| self.payload(bytes, room)).collect()
    }

    /// The file of a payload; the prim is taken to be the one that the file begins with.
    fn payload(&self, bytes: &mut Bytes<'_>, room: &mut Room<'_>) -> Result<Payload, ReadError> {
        let file = self.names.string(u32::from_le_bytes(bytes.numbers()?))?;
        let _prim = bytes.numbers::<4>()?;
        if self.minor >= WITH_OFFSETS {
            let _in_time = bytes.numbers::<16>()?;
        }
        room.take(file.len() + NAME_BYTES, 1)?;
        Ok(Payload { asset_path: file.to_owned(), ..Payload::default() })
    }

    /// Sets of variants, and which one of each is chosen.
    fn selection(&self, rep: Rep, room: &mut Room<'_>) -> Result<Value, ReadError> {
        let mut bytes = self.at(rep, VALUE)?;
        let count = bytes.count()?;
        let (pairs, _) = bytes.elements(count, 8)?.as_chunks::<8>();
        let mut chosen = HashMap::new();
        for [a, b, c, d, e, f, g, h] in pairs {
            let set = self.names.string(u32::from_le_bytes([*a, *b, *c, *d]))?;
            let variant = self.names.string(u32::from_le_bytes([*e, *f, *g, *h]))?;
            room.take(set.len() + variant.len() + 2 * NAME_BYTES, 1)?;
            chosen.insert(set.to_owned(), variant.to_owned());
        }
        Ok(Value::VariantSelectionMap(chosen))
    }
}

/// Elements as they are in memory.
fn plain<T: Element>(count: usize, bytes: &mut Bytes<'_>, room: &mut Room<'_>) -> Result<Vec<T>, ReadError> {
    let elements = bytes.elements(count, T::SIZE)?;
    room.take(count, T::SIZE)?;
    Ok(elements.chunks_exact(T::SIZE).map(T::read).collect())
}

/// Numbers behind how many they are.
fn listed(bytes: &mut Bytes<'_>, room: &mut Room<'_>) -> Result<Vec<u32>, ReadError> {
    let count = bytes.count()?;
    plain(count, bytes, room)
}
