//! What an export has to hold: what each format's estimate of its bytes is made from.

use linden_pipeline::wind::Wind;

use super::level::Instanced;

/// Counts of what an export has to hold, known before anything is dressed or written.
///
/// A format's [`estimate`](crate::Format::estimate) turns them into bytes.
///
/// ```
/// use linden_exporters::{Amounts, Options};
///
/// // 50 bytes for each triangle and a short header.
/// let estimate = |amounts: &Amounts, _: &Options| 84 + 50 * amounts.triangles;
/// let mut amounts = Amounts::default();
/// amounts.triangles = 12;
/// # let options = Options::new(linden_exporters::find("ply")?.format());
/// assert_eq!(estimate(&amounts, &options), 684);
/// # Ok::<(), linden_exporters::ExportError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Amounts {
    /// Vertices of all meshes.
    pub vertices: u64,
    /// Triangles of all meshes.
    pub triangles: u64,
    /// Vertices of leaves and other organs, baked.
    pub leaf_vertices: u64,
    /// Vertices of meshes whose material has no pictures.
    pub plain_vertices: u64,
    /// Places of foliage that is written as instances: see [`Amounts::instanced`].
    pub placements: u64,
    /// Leaves and other organs.
    pub organs: u64,
    /// Nodes of the skeleton.
    pub nodes: u64,
    /// Axes of the skeleton.
    pub axes: u64,
    /// The recipe as one line of JSON.
    pub recipe_bytes: u64,
    /// All pictures as PNG files.
    pub picture_bytes: u64,
    /// Those of them that nothing is cut out of: the bark's.
    pub opaque_picture_bytes: u64,
    /// Those of how much light passes, which formats with a word for it write besides.
    pub passing_picture_bytes: u64,
    /// Materials of the foliage; the bark's is one more.
    pub foliage_materials: u64,
    /// What the meshes say about the wind.
    pub wind: Wind,
    /// Joints that turn in the wind.
    pub joints: u64,
    /// Frames of the loop in which they turn.
    pub frames: u64,
    /// What [`Amounts::instanced`] leaves out.
    pub(super) saved: Instanced,
}

impl Amounts {
    /// The same with leaves as instances: each shape once, and [`placements`](Self::placements) of them. What moves in the
    /// wind is written one by one.
    #[must_use]
    pub const fn instanced(self) -> Self {
        if matches!(self.wind, Wind::Off) { self.in_parts() } else { self }
    }

    /// The same with leaves as instances whether they move or not.
    #[must_use]
    pub const fn in_parts(self) -> Self {
        Self {
            vertices: self.vertices - self.saved.vertices,
            triangles: self.triangles - self.saved.triangles,
            plain_vertices: self.plain_vertices - self.saved.plain_vertices,
            placements: self.saved.copies,
            saved: Instanced::NONE,
            ..self
        }
    }

    /// Vectors of four numbers that tell each vertex how it moves in the wind.
    pub fn wind_vectors(&self) -> u64 {
        if matches!(self.wind, Wind::Off | Wind::Bones) { 0 } else { 2 * self.vertices }
    }

    /// Vertices that are bound to joints.
    pub fn bound_vertices(&self) -> u64 {
        if self.wind == Wind::Bones { self.vertices } else { 0 }
    }

    /// Vectors of three numbers in all morph targets: leaves have each motion, wood all but those of leaves.
    pub fn target_vectors(&self) -> u64 {
        let wood = self.vertices.saturating_sub(self.leaf_vertices);
        if self.wind == Wind::Sway { 4 * wood + 6 * self.leaf_vertices } else { 0 }
    }
}

/// Decimal digits of an index, on average over `1..=count`: what text takes for it.
///
/// ```
/// // Nine numbers of one digit, and one of two.
/// assert_eq!(linden_exporters::writing::mean_digits(10), 1.1);
/// ```
pub fn mean_digits(count: u64) -> f64 {
    let (mut sum, mut power) = (0, 1);
    // Everything from a power of ten on has a digit more.
    while power <= count {
        sum += count - power + 1;
        power = power.saturating_mul(10);
    }
    sum as f64 / count.max(1) as f64
}
