//! Parameter files of three programs that grow trees by Weber and Penn: Arbaro (XML, and lines of names and
//! values), Blender's Sapling, and friggog's tree-gen (both Python literals, which are read and never run).
//!
//! A file is told by its content. What a program has beyond the paper and linden does not is said in
//! [`ParameterFile::notes`], name by name; what is no value of a parameter is a [`Fault`] with its place.

mod arbaro;
mod draft;
mod friggog;
mod literal;
mod sapling;

use linden_base::document::{Fault, TextPlace};

use crate::WeberPenn;

/// The most bytes of a file: a hundred times what such files have.
pub const MAX_BYTES: usize = 1 << 20;

/// Which program a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// Arbaro.
    Arbaro,
    /// Blender's Sapling and its descendants.
    Sapling,
    /// friggog's tree-gen.
    TreeGen,
}

impl Program {
    /// What people call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Arbaro => "Arbaro",
            Self::Sapling => "Sapling",
            Self::TreeGen => "tree-gen",
        }
    }
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterFile {
    /// The program it is for.
    pub program: Program,
    /// What it calls the tree.
    pub species: Option<String>,
    /// The seed that it was saved with.
    pub seed: Option<u64>,
    /// How the tree grows.
    pub settings: WeberPenn,
    /// How it looks, as far as the file says.
    pub look: ParameterLook,
    /// What is left out or read otherwise, a line each.
    pub notes: Vec<String>,
}

/// Parameters that have to do with looks and not with growth.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterLook {
    /// How much wider the foot is, as a share of the radius.
    pub flare: f64,
    /// Lobes round the trunk.
    pub lobes: f64,
    /// How far they stand out, as a share of the radius.
    pub lobe_depth: f64,
    /// Width ÷ length of leaves.
    pub leaf_width: f64,
    /// The outline of leaves, as the knob `leaf_outline` has it.
    pub leaf_outline: &'static str,
}

impl Default for ParameterLook {
    fn default() -> Self {
        Self { flare: 0.5, lobes: 0.0, lobe_depth: 0.0, leaf_width: 0.5, leaf_outline: "elliptic" }
    }
}

/// Reads a file.
///
/// ```
/// let xml = r#"<arbaro><species name="pole"><param name="1Branches" value="7"/></species></arbaro>"#;
/// let file = linden_weber_penn::read_parameters(xml)?;
/// assert_eq!(file.species.as_deref(), Some("pole"));
/// assert_eq!(file.settings.branches, [1.0, 7.0, 5.0, 5.0]);
/// assert!(linden_weber_penn::read_parameters("{'levels': grow()}").is_err());
/// # Ok::<(), linden_base::document::Fault>(())
/// ```
///
/// # Errors
/// [`Fault`]: what is wrong, and where; more than [`MAX_BYTES`].
pub fn read_parameters(text: &str) -> Result<ParameterFile, Fault> {
    if text.len() > MAX_BYTES {
        let problem =
            format!("{} bytes are too many for parameters of a tree; {MAX_BYTES} are allowed", text.len());
        return Err(Fault::new(None, problem));
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let start = text.trim_start();
    if start.starts_with('<') {
        arbaro::read_xml(text)
    } else if start.starts_with('{') {
        sapling::read(text)
    } else if literal::assigned(text).is_some() {
        friggog::read(text)
    } else {
        arbaro::read_lines(text)
    }
}

/// The place of a byte.
fn place_at(text: &str, offset: usize) -> Option<TextPlace> {
    let before = text.get(..offset)?;
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or(before).chars().count() + 1;
    Some(TextPlace { line, column })
}
