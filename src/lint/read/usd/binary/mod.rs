//! Binary layers (crate files, `PXR-USDC`) of any program: versions 0.4 to 0.16.
//!
//! ```text
//! bootstrap    "PXR-USDC", version, where the table of contents is
//! values       arrays, list operations …
//! sections     TOKENS STRINGS FIELDS FIELDSETS PATHS SPECS
//! contents     where each section is
//! ```
//!
//! A spec is a path and a set of fields, a field a name and a value of 64 bits: its type, and itself where 32 bits hold it,
//! otherwise where it stands. There is no specification but the source of OpenUSD (`pxr/usd/sdf/crateFile.cpp`,
//! `integerCoding.cpp`).
//!
//! A layer becomes what text becomes ([`Data`]): with the fields that [`Layer`](super::layer::Layer) asks for, and without
//! values of other types than it knows. Nothing that a file says of itself is trusted: places and counts are held against
//! its bytes, and all that is unpacked is counted by [`Room`] before memory is taken.

mod bytes;
mod element;
mod packed;
mod paths;
mod sections;
mod values;

use openusd::sdf::{Data, SpecType, Value};

use self::bytes::Bytes;
pub(super) use self::bytes::Room;
use self::sections::Sections;
use self::values::{Rep, Values};
use super::{ReadError, beyond, broken};

/// How a crate file begins.
pub(super) const MAGIC: &[u8] = b"PXR-USDC";
/// Before compression of sections (0.4), files were laid out otherwise.
const OLDEST: u8 = 4;
/// Of OpenUSD 26.11: newer ones may be laid out otherwise.
const NEWEST: u8 = 16;

/// Fields that are looked at.
const WANTED: &[&str] = &[
    "connectionPaths",
    "default",
    "interpolation",
    "metersPerUnit",
    "targetPaths",
    "typeName",
    "upAxis",
    "variantSelection",
];
/// Fields of which it is enough that they are there.
const NOTED: &[&str] = &["inheritPaths", "references", "subLayers"];
/// One that is looked at as far as it is of a type that is known.
const PAYLOAD: &str = "payload";

/// What a spec and a field take besides what is in them, and what a look at a field counts: roughly.
const SPEC_BYTES: usize = 128;
const FIELD_BYTES: usize = 224;
const STEP_BYTES: usize = 8;

/// Reads a layer.
///
/// # Errors
/// Where it is broken, of a version that is not known, or unpacks to more than there is room for.
pub(super) fn parse(bytes: &[u8], room: &mut Room<'_>) -> Result<Data, ReadError> {
    let mut bootstrap = Bytes::new(bytes, "the head of the file");
    bootstrap.take(MAGIC.len())?;
    let [major, minor, patch, ..] = bootstrap.numbers::<8>()?;
    if major != 0 || !(OLDEST..=NEWEST).contains(&minor) {
        return Err(beyond(format!(
            "its binary layer is of version {major}.{minor}.{patch}; 0.{OLDEST} to 0.{NEWEST} can be read; \
             'usdcat in.usdc -o out.usda' (usd-core) makes text of it"
        )));
    }
    let sections = Sections::read(bytes, bootstrap.word()?)?;
    let names = sections.names(room)?;
    let fields = sections.fields(&names, room)?;
    let sets = sections.field_sets(room)?;
    let paths = sections.paths(&names, room)?;
    let specs = sections.specs(room)?;
    let values = Values { bytes, minor, names: &names, paths: &paths };
    let mut data = Data::new();
    for [path, set, kind] in specs {
        let Some(kind) = SpecType::from_repr(kind).filter(|kind| *kind != SpecType::Unknown) else {
            return Err(broken(format!("a spec is of the unknown kind {kind}")));
        };
        let path = paths.get(path as usize).ok_or_else(|| broken("a spec has a path that is not there"))?;
        let set = sets.get(set as usize..).filter(|set| !set.is_empty());
        let set = set.ok_or_else(|| broken("a spec has fields that are not there"))?;
        room.take(path.as_str().len() + SPEC_BYTES, 1)?;
        let spec = data.create_spec(path.clone(), kind);
        for field in set.iter().take_while(|field| **field != sections::END) {
            // Sets may overlap: looking at them counts too.
            room.take(1, STEP_BYTES)?;
            let field = fields.get(*field as usize);
            let (name, rep) = *field.ok_or_else(|| broken("a set of fields has one that is not there"))?;
            if let Some(value) = value(name, rep, &values, room)? {
                room.take(FIELD_BYTES, 1)?;
                spec.add(name, value);
            }
        }
    }
    Ok(data)
}

/// The value of a field; `None` where nobody looks at it.
fn value(name: &str, rep: Rep, values: &Values<'_>, room: &mut Room<'_>) -> Result<Option<Value>, ReadError> {
    if WANTED.contains(&name) {
        values.read(rep, room)
    } else if name == PAYLOAD {
        Ok(Some(values.read(rep, room)?.unwrap_or(Value::None)))
    } else {
        Ok(NOTED.contains(&name).then_some(Value::None))
    }
}
