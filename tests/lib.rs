//! What the tests and benchmarks across crates share.

pub mod fixtures;

/// The built-in presets as recipes.
pub mod presets {
    use std::sync::OnceLock;

    use linden::Quiet;
    use linden::grow::{Grown, grow};
    use linden::preset::{Builtin, builtins};
    use linden::recipe::Recipe;
    use rayon::prelude::*;

    /// The recipe of a built-in preset, with the files that it needs.
    ///
    /// # Panics
    /// When a built-in document or its file is broken.
    pub fn recipe(builtin: &Builtin) -> Recipe {
        builtin.recipe(&Quiet).unwrap_or_else(|error| panic!("{}: {error}", builtin.id))
    }

    /// A built-in preset, and what it grows as it is.
    pub struct Plant {
        /// The id of the preset.
        pub id: &'static str,
        /// What was grown.
        pub recipe: Recipe,
        /// What came of it.
        pub grown: Grown,
    }

    /// All built-in presets in their order, grown once in a program, however many of its tests look at them: they take 300 MB
    /// and 20 s of a core. To be asked for before threads are parted, which would wait for each other.
    ///
    /// # Panics
    /// When one does not grow.
    pub fn plants() -> &'static [Plant] {
        static ALL: OnceLock<Vec<Plant>> = OnceLock::new();
        ALL.get_or_init(|| {
            let plant = |builtin: &Builtin| {
                let recipe = recipe(builtin);
                let grown = grow(&recipe, &Quiet).unwrap_or_else(|error| panic!("{}: {error}", builtin.id));
                Plant { id: builtin.id, recipe, grown }
            };
            builtins().par_iter().map(plant).collect()
        })
    }
}

/// The examples of `docs/library.md`, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryPage;
