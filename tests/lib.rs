//! What the tests and benchmarks across crates share.

pub mod fixtures;

/// The built-in presets as recipes.
pub mod presets {
    use linden::Quiet;
    use linden::preset::Builtin;
    use linden::recipe::Recipe;

    /// The recipe of a built-in preset, with the files that it needs.
    ///
    /// # Panics
    /// When a built-in document or its file is broken.
    pub fn recipe(builtin: &Builtin) -> Recipe {
        builtin.recipe(&Quiet).unwrap_or_else(|error| panic!("{}: {error}", builtin.id))
    }
}

/// The examples of `docs/library.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryPage;
