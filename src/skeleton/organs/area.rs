//! The area of organs.

use linden_base::mesh::Mesh;

use super::{Organs, PROTOTYPES};

/// One side of all triangles, square units.
fn mesh_area(mesh: &Mesh) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.triangles.iter().map(of).sum()
}

impl Organs {
    /// The area of each organ, square metres: one side of its triangles, of cards the whole (what a picture cuts
    /// out included). The polygons come first, then the organs of `placed`.
    ///
    /// The area of a polygon is the length of its vector area (for one that is not flat: of its projection where
    /// that is largest).
    ///
    /// ```
    /// use glam::Vec3;
    /// use linden_skeleton::organs::{Organs, Polygons};
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 2.0, 0.0), Vec3::Y * 2.0];
    /// let organs = Organs { polygons: Polygons { corners, ends: vec![4], ..Polygons::default() }, ..Organs::default() };
    /// assert_eq!(organs.areas_m2(), [2.0]);
    /// assert_eq!(organs.area_m2(), 2.0);
    /// ```
    pub fn areas_m2(&self) -> Vec<f64> {
        let polygons = (0..self.polygons.ends.len()).map(|polygon| {
            let corners = self.corners_of(polygon);
            let Some(first) = corners.first().map(|corner| corner.as_dvec3()) else { return 0.0 };
            let fan = corners.windows(2).map(|edge| {
                let [a, b] = [edge[0], edge[1]].map(|corner| corner.as_dvec3() - first);
                a.cross(b)
            });
            fan.sum::<glam::DVec3>().length() / 2.0
        });
        let shapes: Vec<f64> = PROTOTYPES
            .iter()
            .map(|prototype| mesh_area(prototype.mesh()))
            .chain(self.shapes.iter().map(|shape| mesh_area(&shape.mesh) / f64::from(shape.faces)))
            .collect();
        let placed = self.placed.prototypes.iter().zip(&self.placed.sizes_m).map(|(&prototype, &size_m)| {
            let prototype = usize::from(prototype);
            // A shape that is not given is drawn as one of the table.
            let area = shapes.get(prototype).unwrap_or(&shapes[prototype % PROTOTYPES.len()]);
            area * f64::from(size_m) * f64::from(size_m)
        });
        polygons.chain(placed).collect()
    }

    /// The area of all organs, as [`Organs::areas_m2`] has that of each, square metres.
    pub fn area_m2(&self) -> f64 {
        self.areas_m2().iter().sum()
    }
}
