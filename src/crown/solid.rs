//! Solids as documents have them: a shape with its dimensions, or a mesh.

use linden_base::document::{Entry, Fault, TextPlace};
use linden_base::knob::{Kind, Knob, Value, excerpt};

use super::{SHAPES, Shape, ShapeKnob, shape};

/// The ids of all shapes.
pub const SHAPE_IDS: [&str; SHAPES.len()] = {
    let mut ids = [""; SHAPES.len()];
    let mut i = 0;
    while i < ids.len() {
        ids[i] = SHAPES[i].id;
        i += 1;
    }
    ids
};

/// The key that names a shape.
pub const CROWN_KEY: &str = "crown";

/// The key that names a mesh instead.
pub const MESH_KEY: &str = "mesh";

/// A solid of a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// One of [`SHAPES`], with the dimensions that were set.
    Shape {
        /// Its id.
        shape: String,
        /// What was set of its knobs.
        dimensions: Vec<(&'static str, Value)>,
    },
    /// The inside of a mesh.
    Mesh {
        /// The file, relative to the preset's.
        file: String,
    },
}

impl Solid {
    /// Reads which solid the `number`-th of several things (`one`: `part`) is, before its dimensions are set.
    /// `mesh_instead` is an end for the message where a mesh was taken for a shape.
    ///
    /// # Errors
    /// [`Fault`]: neither a shape nor a mesh, both, or an unknown shape.
    pub fn read(
        entries: &[Entry],
        place: Option<TextPlace>,
        (one, number): (&str, usize),
        mesh_instead: &str,
    ) -> Result<Self, Fault> {
        let find = |key: &str| entries.iter().find(|entry| entry.key == key);
        match (find(CROWN_KEY), find(MESH_KEY)) {
            (Some(entry), None) => {
                let id = entry.node.value(CROWN_KEY, &Kind::Choice(&SHAPE_IDS)).map_err(|fault| {
                    let word = entry.node.text(CROWN_KEY).unwrap_or_default();
                    let hint = if means_mesh(word) { mesh_instead } else { "" };
                    Fault { message: fault.message + hint, ..fault }
                })?;
                Ok(Self::Shape { shape: id.to_string(), dimensions: Vec::new() })
            }
            (None, Some(entry)) => Ok(Self::Mesh { file: entry.node.text(MESH_KEY)?.to_owned() }),
            (None, None) => {
                let message = format!("{one} {number} has neither 'crown' nor 'mesh': say what it is");
                Err(Fault::new(place, message))
            }
            (Some(_), Some(second)) => {
                let message = format!("{one} {number} has both 'crown' and 'mesh'; keep one");
                Err(Fault::new(second.place, message))
            }
        }
    }

    /// Sets the dimension that an entry names; whether it has such a dimension.
    ///
    /// # Errors
    /// [`Fault`]: a value that the dimension does not take.
    pub fn set(&mut self, entry: &Entry) -> Result<bool, Fault> {
        let Self::Shape { shape: id, dimensions } = self else { return Ok(false) };
        let Some(shape) = shape(id).ok() else { return Ok(false) };
        let Some(dimension) = shape.knobs.iter().find(|dimension| dimension.knob.name == entry.key) else {
            return Ok(false);
        };
        let value = entry.node.value(&entry.key, &dimension.knob.kind)?;
        dimensions.push((dimension.knob.name, value));
        *dimensions = shape.complete(dimensions);
        Ok(true)
    }

    /// The same with every dimension: what was set, else its default.
    #[must_use]
    pub fn complete(self) -> Self {
        match self {
            Self::Shape { shape: id, dimensions } => {
                let dimensions = shape(&id).map_or_else(|_| Vec::new(), |shape| shape.complete(&dimensions));
                Self::Shape { shape: id, dimensions }
            }
            mesh @ Self::Mesh { .. } => mesh,
        }
    }

    /// The same with every dimension at its default.
    #[must_use]
    pub fn plain(&self) -> Self {
        match self {
            Self::Shape { shape, .. } => {
                Self::Shape { shape: shape.clone(), dimensions: Vec::new() }.complete()
            }
            mesh @ Self::Mesh { .. } => mesh.clone(),
        }
    }

    /// The mesh that is needed beside the preset.
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::Shape { .. } => None,
            Self::Mesh { file } => Some(file),
        }
    }

    /// The same to change its name.
    pub fn file_mut(&mut self) -> Option<&mut String> {
        match self {
            Self::Shape { .. } => None,
            Self::Mesh { file } => Some(file),
        }
    }

    /// As messages have it: `sphere`, `'rock.obj'`.
    pub fn describe(&self) -> String {
        match self {
            Self::Shape { shape, .. } => excerpt(shape),
            Self::Mesh { file } => format!("'{}'", excerpt(file)),
        }
    }

    /// Its dimensions with their values; none of a mesh.
    pub fn dimensions(&self) -> Vec<(Knob, Value)> {
        match self {
            Self::Shape { shape, dimensions } => dimensions_of(shape, dimensions),
            Self::Mesh { .. } => Vec::new(),
        }
    }
}

/// The dimensions of a shape with their values.
pub fn dimensions_of(id: &str, set: &[(&'static str, Value)]) -> Vec<(Knob, Value)> {
    let knobs = shape(id).into_iter().flat_map(|shape: &Shape| shape.knobs);
    let value = |dimension: &ShapeKnob| {
        let found = set.iter().find(|(name, _)| *name == dimension.knob.name);
        found.map_or_else(dimension.default, |(_, value)| value.clone())
    };
    knobs.map(|dimension| (dimension.knob, value(dimension))).collect()
}

/// The dimensions of all shapes, each once.
pub fn all_dimensions() -> Vec<Knob> {
    let mut knobs: Vec<Knob> = Vec::new();
    for dimension in SHAPES.iter().flat_map(|shape| shape.knobs) {
        if knobs.iter().all(|knob| knob.name != dimension.knob.name) {
            knobs.push(dimension.knob);
        }
    }
    knobs
}

/// Whether a word that stands for a shape means a mesh.
pub fn means_mesh(word: &str) -> bool {
    let word = word.trim().to_ascii_lowercase();
    [".obj", ".ply"].iter().any(|ending| word.ends_with(ending))
        || ["mesh", "envelope", "file", "obj", "ply"].contains(&word.as_str())
}
