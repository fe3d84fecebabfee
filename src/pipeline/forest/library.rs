//! The forests in the program.

use super::ForestDocument;
use crate::preset::Heading;
use linden_base::document::Fault;
use linden_base::knob::nearest;

/// A file of `presets/forests/`, as it was when the program was built.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinForest {
    /// The file's name without `.toml`.
    pub id: &'static str,
    /// The document.
    pub text: &'static str,
}

include!(concat!(env!("OUT_DIR"), "/forests.rs"));

/// All built-in forests.
pub fn builtin_forests() -> &'static [BuiltinForest] {
    FORESTS
}

/// A built-in forest by its id.
///
/// # Errors
/// The nearest id, if one may be meant.
pub fn builtin_forest(id: &str) -> Result<&'static BuiltinForest, Option<&'static str>> {
    FORESTS
        .iter()
        .find(|forest| forest.id == id)
        .ok_or_else(|| nearest(id, FORESTS.iter().map(|forest| forest.id)))
}

impl BuiltinForest {
    /// Reads the document.
    ///
    /// # Errors
    /// None that the tests let pass.
    pub fn load(&self) -> Result<ForestDocument, Fault> {
        ForestDocument::parse(self.text)
    }

    /// What a list shows of it: reads a few lines instead of the whole document.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn heading(&self) -> Result<Heading, Fault> {
        Heading::from_toml(self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::TreeSource;
    use crate::preset::builtin;

    #[test]
    fn every_forest_names_presets_that_there_are() {
        assert!(builtin_forests().len() >= 2);
        for forest in builtin_forests() {
            let document = forest.load().unwrap();
            assert!(!document.name.is_empty() && !document.summary.is_empty(), "{}", forest.id);
            let heading = forest.heading().unwrap();
            assert_eq!((&heading.name, &heading.summary), (&document.name, &document.summary));
            for tree in &document.trees {
                let TreeSource::Named(id) = &tree.source else { panic!("{}: a recipe", forest.id) };
                let mut preset = builtin(id).unwrap().load().unwrap();
                for (name, value) in &tree.set {
                    preset.set(name, value).unwrap();
                }
            }
            // An id means one thing.
            assert!(builtin(forest.id).is_err());
        }
        assert_eq!(builtin_forest("orchrad").err().flatten(), Some("orchard"));
    }
}
