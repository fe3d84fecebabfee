//! What a file is to a preset: a document that says one, or data that come without.

use linden_base::input::InputKind;

use super::Preset;

/// What a file that trees are grown from is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A preset: TOML.
    Preset,
    /// A recipe: JSON.
    Recipe,
    /// A grammar in the older text format.
    Grammar,
    /// Parameters of a tree by Weber and Penn.
    TreeParameters,
    /// What a generator takes as it is.
    Data(DataKind),
}

/// Data that come without a preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataKind {
    /// A closed mesh.
    Mesh,
    /// Points, or heights of a canopy.
    Points,
    /// A table of cylinders.
    Cylinders {
        /// Whether it has a radius for each end.
        tapered: bool,
    },
}

impl From<InputKind> for SourceKind {
    fn from(kind: InputKind) -> Self {
        match kind {
            InputKind::Preset => Self::Preset,
            InputKind::Recipe => Self::Recipe,
            InputKind::Grammar => Self::Grammar,
            InputKind::TreeParameters => Self::TreeParameters,
            InputKind::ObjMesh | InputKind::PlyMesh => Self::Data(DataKind::Mesh),
            InputKind::Cylinders { tapered } => Self::Data(DataKind::Cylinders { tapered }),
            InputKind::PlyPoints
            | InputKind::XyzPoints
            | InputKind::LasPoints
            | InputKind::E57Points
            | InputKind::PcdPoints
            | InputKind::PtxPoints
            | InputKind::HeightGrid => Self::Data(DataKind::Points),
        }
    }
}

impl Preset {
    /// The preset for data that come without one.
    pub fn of_data(id: &str, file: &str, kind: DataKind) -> Self {
        match kind {
            DataKind::Mesh => Self::of_mesh(id, file),
            DataKind::Points => Self::of_points(id, file),
            DataKind::Cylinders { tapered } => Self::of_cylinders(id, file, tapered),
        }
    }
}
