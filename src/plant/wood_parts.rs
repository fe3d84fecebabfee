//! The wood in parts, each with the bark of its thickness.

use linden_base::mesh::Mesh;

use crate::scene::Part;
use crate::wind::{PartWind, Target};

/// Cuts a part into parts by the class of each triangle; vertices between two classes are in both. The first keeps
/// the name and the material, others have the name of their class behind it and the materials after that one, in
/// the order of `names`. Classes without triangles are left out, but for the first.
pub(crate) fn cut(whole: &Part, classes: &[u8], names: &[&str]) -> Vec<Part> {
    let mut parts = Vec::with_capacity(names.len() + 1);
    let mut index = vec![u32::MAX; whole.mesh.positions.len()];
    for class in 0..=names.len() as u8 {
        let of_class = || whole.mesh.triangles.iter().zip(classes).filter(|(_, of)| **of == class);
        let mut vertices = Vec::new();
        let mut triangles = Vec::with_capacity(of_class().count());
        index.fill(u32::MAX);
        for (corners, _) in of_class() {
            triangles.push(corners.map(|vertex| {
                let new = &mut index[vertex as usize];
                if *new == u32::MAX {
                    *new = vertices.len() as u32;
                    vertices.push(vertex as usize);
                }
                *new
            }));
        }
        if triangles.is_empty() && class > 0 {
            continue;
        }
        let mesh = Mesh {
            positions: taken(&whole.mesh.positions, &vertices),
            normals: taken(&whole.mesh.normals, &vertices),
            uvs: taken(&whole.mesh.uvs, &vertices),
            triangles,
        };
        let name = match class.checked_sub(1) {
            None => whole.name.clone(),
            Some(thin) => format!("{}_{}", whole.name, names[usize::from(thin)]),
        };
        let mut part = Part::new(name, whole.material + usize::from(class), mesh);
        part.wind = whole.wind.as_ref().map(|wind| blown(wind, &vertices));
        parts.push(part);
    }
    // A tree of twigs alone has no trunk; the first part is the wood's all the same.
    if parts.len() > 1 && parts[0].mesh.triangles.is_empty() {
        parts.remove(0);
    }
    parts
}

fn taken<T: Copy>(all: &[T], vertices: &[usize]) -> Vec<T> {
    vertices.iter().filter_map(|&vertex| all.get(vertex).copied()).collect()
}

fn blown(wind: &PartWind, vertices: &[usize]) -> PartWind {
    let target =
        |target: &Target| Target { motion: target.motion, offsets: taken(&target.offsets, vertices) };
    PartWind {
        motions: taken(&wind.motions, vertices),
        pivots: taken(&wind.pivots, vertices),
        targets: wind.targets.iter().map(target).collect(),
        sway: wind.sway.clone(),
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3};

    use super::*;

    #[test]
    fn parts_hold_all_triangles_of_the_whole() {
        let corner = |x: f32| Vec3::new(x, x * x, 0.0);
        let mesh = Mesh {
            positions: (0..6).map(|i| corner(i as f32)).collect(),
            normals: vec![Vec3::Z; 6],
            uvs: (0..6).map(|i| Vec2::splat(i as f32)).collect(),
            triangles: vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 5]],
        };
        let corners = |mesh: &Mesh| -> Vec<[Vec3; 3]> {
            mesh.triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize])).collect()
        };
        let mut whole = Part::new("wood", 0, mesh.clone());
        whole.wind =
            Some(PartWind { motions: (0..6).map(|i| [i as f32; 4]).collect(), ..PartWind::default() });
        let parts = cut(&whole, &[0, 0, 2, 1], &["limbs", "twigs"]);
        let names: Vec<(&str, usize)> =
            parts.iter().map(|part| (part.name.as_str(), part.material)).collect();
        assert_eq!(names, [("wood", 0), ("wood_limbs", 1), ("wood_twigs", 2)]);
        let all = corners(&mesh);
        assert_eq!(corners(&parts[0].mesh), all[..2]);
        assert_eq!(corners(&parts[1].mesh), all[3..]);
        assert_eq!(corners(&parts[2].mesh), all[2..3]);
        // What stands at a vertex stays with it.
        for part in &parts {
            let motions = &part.wind.as_ref().unwrap().motions;
            assert!(part.mesh.uvs.iter().zip(motions).all(|(uv, motion)| uv.x == motion[0]));
        }
        let twigs = cut(&whole, &[2; 4], &["limbs", "twigs"]);
        assert_eq!((twigs.len(), twigs[0].name.as_str()), (1, "wood_twigs"));
    }
}
