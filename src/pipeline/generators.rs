//! The registry of generators: one line each.

use std::sync::{Mutex, OnceLock};

use linden_skeleton::generator::Generator;

/// The generators that linden brings. A new one is its crate and one line here.
const BUILTIN: &[&dyn Generator] = &[
    linden_lsystem::GENERATOR,
    linden_colonization::GENERATOR,
    linden_scan::GENERATOR,
    linden_qsm::GENERATOR,
    linden_weber_penn::GENERATOR,
    linden_self_organizing::GENERATOR,
];

/// Those that a program has added, until the registry is first read.
static ADDED: Mutex<Vec<&'static dyn Generator>> = Mutex::new(Vec::new());
static ALL: OnceLock<Vec<&'static dyn Generator>> = OnceLock::new();

/// Why a generator was not added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RegisterError {
    /// Documents were read already, or knobs listed.
    #[error("the generator '{0}' comes too late: register generators before anything else is done")]
    TooLate(&'static str),
    /// Its id is taken.
    #[error("there is a generator '{0}' already; give this one another id")]
    Taken(&'static str),
}

/// Adds a generator to those that linden brings: its table in documents, its knobs in every listing. For
/// programs with generators of their own, before they do anything else.
///
/// # Errors
/// [`RegisterError`]: too late, or an id that is taken.
pub fn register(generator: &'static dyn Generator) -> Result<(), RegisterError> {
    let mut added = ADDED.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if ALL.get().is_some() {
        return Err(RegisterError::TooLate(generator.id()));
    }
    if BUILTIN.iter().chain(added.iter()).any(|known| known.id() == generator.id()) {
        return Err(RegisterError::Taken(generator.id()));
    }
    added.push(generator);
    Ok(())
}

/// All generators, in the order of documents and listings.
///
/// ```
/// let ids: Vec<&str> = linden_pipeline::generators::all().iter().map(|generator| generator.id()).collect();
/// assert_eq!(ids, ["lsystem", "colonization", "scan", "qsm", "weber-penn", "self-organizing"]);
/// ```
pub fn all() -> &'static [&'static dyn Generator] {
    ALL.get_or_init(|| {
        let added = ADDED.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        BUILTIN.iter().copied().chain(added.iter().copied()).collect()
    })
}

/// The generator of an id.
pub fn find(id: &str) -> Option<&'static dyn Generator> {
    all().iter().copied().find(|generator| generator.id() == id)
}
