//! Tangents for normal textures.
//!
//! The specification (3.7.2.1) lets readers compute them, but readers differ there; written ones look
//! the same everywhere. As `MikkTSpace` does for vertices that are shared as they are here (split at
//! seams): the direction of growing U, made square to the normal, and the side on which V grows.

use glam::{Vec3, Vec4};
use linden_pipeline::scene::Mesh;

/// The squared sine of the least angle to the normal at which a direction counts.
const LEAST_SLOPE: f32 = 1e-4;

/// One tangent per vertex: a unit vector, and 1 or -1 for the side of the bitangent
/// (`cross(normal, tangent) * w` points to the picture's upper edge).
///
/// Sums over triangles as in Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh"
/// (Terathon, 2001), weighted by area in texture space.
pub(super) fn tangents(mesh: &Mesh) -> Vec<Vec4> {
    let mut sums = vec![Vec4::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex as usize);
        let (p, q) = (mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
        let (s, t) = (mesh.uvs[b] - mesh.uvs[a], mesh.uvs[c] - mesh.uvs[a]);
        let side = s.perp_dot(t).signum();
        let along_u = (p * t.y - q * s.y) * side;
        let sum = along_u.extend(side);
        for vertex in [a, b, c] {
            sums[vertex] += sum;
        }
    }
    for (sum, &normal) in sums.iter_mut().zip(&mesh.normals) {
        let along_u = sum.truncate().reject_from(normal);
        // What is left of a direction that is the normal's own is rounding, and lies anywhere.
        let is_clear = along_u.length_squared() > LEAST_SLOPE * sum.truncate().length_squared();
        // A vertex whose texture does not stretch anywhere: any direction in the surface will do.
        let tangent = along_u
            .try_normalize()
            .filter(|_| is_clear)
            .unwrap_or_else(|| normal.any_orthogonal_vector().normalize_or(Vec3::X));
        *sum = tangent.extend(if sum.w < 0.0 { -1.0 } else { 1.0 });
    }
    sums
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    /// A square in the plane of `x` and `y`, facing `normal`.
    fn square(x: Vec3, y: Vec3, normal: Vec3, uvs: [Vec2; 4]) -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, x, x + y, y],
            normals: vec![normal; 4],
            uvs: uvs.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        }
    }

    const UPRIGHT: [Vec2; 4] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];

    #[test]
    fn the_tangent_is_where_u_grows_and_the_side_where_v_does() {
        for tangent in tangents(&square(Vec3::X, Vec3::Y, Vec3::Z, UPRIGHT)) {
            assert_eq!(tangent, Vec4::new(1.0, 0.0, 0.0, 1.0));
            assert_eq!(Vec3::Z.cross(tangent.truncate()) * tangent.w, Vec3::Y);
        }
        let mirrored = UPRIGHT.map(|uv| Vec2::new(1.0 - uv.x, uv.y));
        for tangent in tangents(&square(Vec3::X, Vec3::Y, Vec3::Z, mirrored)) {
            assert_eq!(tangent, Vec4::new(-1.0, 0.0, 0.0, -1.0));
            assert_eq!(Vec3::Z.cross(tangent.truncate()) * tangent.w, Vec3::Y);
        }
        let turned = UPRIGHT.map(|uv| Vec2::new(uv.y, -uv.x));
        for tangent in tangents(&square(Vec3::X, Vec3::Y, Vec3::Z, turned)) {
            assert_eq!(tangent, Vec4::new(0.0, 1.0, 0.0, 1.0));
        }
    }

    #[test]
    fn always_a_unit_vector_in_the_surface() {
        let slanted = Vec3::new(0.3, 0.2, 1.0).normalize();
        for uvs in [UPRIGHT, [Vec2::ONE; 4], [Vec2::ZERO, Vec2::X, Vec2::X, Vec2::ZERO]] {
            for tangent in tangents(&square(Vec3::X * 1e-3, Vec3::Y * 1e-3, slanted, uvs)) {
                assert!((tangent.truncate().length() - 1.0).abs() < 1e-6, "{tangent}");
                assert!(tangent.truncate().dot(slanted).abs() < 1e-6);
                assert!(tangent.w.abs() == 1.0);
            }
        }
    }
}
