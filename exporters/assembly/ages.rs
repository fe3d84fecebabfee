//! Files of one plant at several ages, put together.

use linden_pipeline::Monitor;
use linden_pipeline::scene::Bounds;

use crate::usda::ages;
use crate::{Bundle, ExportError};

/// Files of one plant at several ages.
#[derive(Clone, Debug, PartialEq)]
pub struct AgeSet {
    /// For people. The first prim of each file is called by it.
    pub name: String,
    /// From the youngest on; the last is the one that is seen first.
    pub ages: Vec<AgeFile>,
}

/// A file of a plant at an age.
#[derive(Clone, Debug, PartialEq)]
pub struct AgeFile {
    /// Lower-case ASCII identifier: `young`.
    pub age: String,
    /// As the set names it: relative to its folder, with slashes, `./` before it.
    pub file: String,
    /// A box around all that the file holds, Y up.
    pub bounds: Option<Bounds>,
}

impl AgeSet {
    /// Writes an OpenUSD layer in which ages are the variants of the set `age`, each with its file as a payload: as
    /// text, or in binary.
    ///
    /// ```
    /// use linden_exporters::{AgeFile, AgeSet, Bundle};
    /// use linden_pipeline::Quiet;
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let file = |age: &str| AgeFile { age: age.to_owned(), file: format!("./ash_{age}.usda"), bounds: None };
    /// let ages = AgeSet { name: "ash".to_owned(), ages: vec![file("young"), file("old")] };
    /// let folder = tempfile::tempdir()?;
    /// let mut bundle = Bundle::create(&folder.path().join("ash.usda"))?;
    /// ages.write_usd(false, &mut bundle, &Quiet)?;
    /// let files = bundle.commit()?;
    /// assert!(std::fs::read_to_string(&files[0].path)?.contains("variantSet \"age\""));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`ExportError::Io`] and [`ExportError::Cancelled`].
    pub fn write_usd(
        &self,
        is_binary: bool,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        ages::write(self, is_binary, bundle, monitor)
    }
}
