//! OpenUSD in binary (`.usdc`): crate files, version 0.8.0, which OpenUSD reads since release 20.11.
//!
//! What is in a layer is written once, by [`usda`](crate::usda): its writers of prims hand on statements and arrays, and
//! [`Crate`] makes of them what text makes of them. Statements (declarations, single values) come as short text and are
//! taken apart by [`literal`]; arrays come as numbers.
//!
//! ```text
//! bootstrap    "PXR-USDC", version, where the table of contents is
//! values       arrays, dictionaries, samples …, each different one once
//! sections     TOKENS STRINGS FIELDS FIELDSETS PATHS SPECS
//! contents     where each section is
//! ```
//!
//! A value is 64 bits (`ValueRep`): its type, and itself where 32 bits hold it, otherwise where it stands. There is no
//! specification but the source of OpenUSD (`pxr/usd/sdf/crateFile.h`, `integerCoding.h`); usd-core reads what is
//! written here, and finds the same as in text (tests).

mod build;
mod compress;
mod kind;
mod layer;
mod literal;
mod read;
mod values;

pub(crate) use self::layer::Crate;
pub(crate) use self::read::Names;
