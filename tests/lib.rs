//! What the tests and benchmarks across crates share.

pub mod fixtures;

/// The built-in presets as recipes.
pub mod presets {
    use linden::Quiet;
    use linden::preset::Builtin;
    use linden::recipe::{Input, Recipe};

    /// The recipe of a built-in preset, with the file that it needs.
    ///
    /// # Panics
    /// When a built-in document or its file is broken.
    pub fn recipe(builtin: &Builtin) -> Recipe {
        let preset = builtin.load().unwrap_or_else(|fault| panic!("{}: {fault}", builtin.id));
        let input = preset.space().and_then(|space| {
            let bytes = builtin.input(space)?;
            let read = Input::read(space.file()?, bytes, &Quiet);
            Some(read.unwrap_or_else(|error| panic!("{}: {error}", builtin.id)))
        });
        Recipe { preset, input }
    }
}
