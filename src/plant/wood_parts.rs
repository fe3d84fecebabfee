//! The wood in parts, each with the bark of its thickness.

use std::collections::BTreeMap;

use linden_base::memory::bytes_of;
use linden_base::mesh::Mesh;

use crate::scene::Part;
use crate::settings::BarkSettings;
use crate::wind::{PartWind, Target};

/// Into which parts the trunk is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Cuts {
    /// The foot with its edge, and a part for each step of moss.
    #[default]
    All,
    /// The foot with its edge, and the step with most moss and whatever is denser: none where these are few triangles.
    Few,
    /// None.
    None,
}

impl Cuts {
    /// Of a level of detail within a budget of triangles.
    pub const fn within(triangles: u64) -> Self {
        if triangles < BarkSettings::LEAST_TRIANGLES { Self::None } else { Self::Few }
    }
}

/// Cuts a part into parts by the class of each triangle; vertices between two classes are in both, and twice in one
/// whose triangles meet there alone, so that no part hangs together by a point. The first keeps
/// the name and the material, others have the name of their class behind it and the materials after that one, in
/// the order of `names`. Classes without triangles are left out, but for the first.
pub(crate) fn cut(whole: &Part, classes: &[u8], names: &[&str]) -> Vec<Part> {
    let mut parts = Vec::with_capacity(names.len() + 1);
    let mut index = vec![u32::MAX; whole.mesh.positions.len()];
    let is_border = borders(&whole.mesh, classes);
    for class in 0..=names.len() as u8 {
        let of_class = || whole.mesh.triangles.iter().zip(classes).filter(|(_, of)| **of == class);
        let mut vertices: Vec<u32> = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(of_class().count());
        triangles.extend(of_class().map(|(corners, _)| *corners));
        index.fill(u32::MAX);
        let fans = further_fans(&triangles, &is_border);
        let mut of_fans = BTreeMap::new();
        for (number, corners) in triangles.iter_mut().enumerate() {
            for (corner, vertex) in corners.iter_mut().enumerate() {
                let new = match fans.get(&(number, corner)) {
                    None => &mut index[*vertex as usize],
                    Some(&fan) => of_fans.entry((*vertex, fan)).or_insert(u32::MAX),
                };
                if *new == u32::MAX {
                    *new = vertices.len() as u32;
                    vertices.push(*vertex);
                }
                *vertex = *new;
            }
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

/// Bytes that cutting a part takes at most, the parts among them.
pub(crate) fn bytes_for(whole: &Part) -> u64 {
    let (vertices, triangles) = (whole.mesh.positions.len(), whole.mesh.triangles.len());
    // Which vertices a part takes, its own number for each, and where borders are; the class of a triangle.
    whole.bytes() + bytes_of::<([u32; 3], [u8; 3])>(vertices) + bytes_of::<u8>(triangles)
}

/// Whether triangles of several classes meet at a vertex.
fn borders(mesh: &Mesh, classes: &[u8]) -> Vec<bool> {
    let mut first: Vec<Option<u8>> = vec![None; mesh.positions.len()];
    let mut is_border = vec![false; first.len()];
    for (corners, &class) in mesh.triangles.iter().zip(classes) {
        for &vertex in corners {
            is_border[vertex as usize] |= *first[vertex as usize].get_or_insert(class) != class;
        }
    }
    is_border
}

/// The fan of each corner, by its triangle and its number there: triangles round a vertex that share an edge are a fan.
/// Corners of a vertex's first fan are left out, which is all that vertices within a class have.
fn further_fans(triangles: &[[u32; 3]], is_border: &[bool]) -> BTreeMap<(usize, usize), usize> {
    let mut around: BTreeMap<u32, Vec<(usize, usize)>> = BTreeMap::new();
    for (number, corners) in triangles.iter().enumerate() {
        for (corner, &vertex) in corners.iter().enumerate().filter(|(_, vertex)| is_border[**vertex as usize])
        {
            around.entry(vertex).or_default().push((number, corner));
        }
    }
    let share_edge =
        |a: usize, b: usize| triangles[a].iter().filter(|vertex| triangles[b].contains(vertex)).count() > 1;
    let mut further = BTreeMap::new();
    for corners in around.values() {
        let mut fans: Vec<usize> = (0..corners.len()).collect();
        for (i, j) in (0..corners.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let (from, to) = (fans[i].max(fans[j]), fans[i].min(fans[j]));
            if from != to && share_edge(corners[i].0, corners[j].0) {
                fans.iter_mut().filter(|fan| **fan == from).for_each(|fan| *fan = to);
            }
        }
        further.extend(corners.iter().copied().zip(fans).filter(|(_, fan)| *fan > 0));
    }
    further
}

fn taken<T: Copy>(all: &[T], vertices: &[u32]) -> Vec<T> {
    let mut taken = Vec::with_capacity(vertices.len().min(all.len()));
    taken.extend(vertices.iter().filter_map(|&vertex| all.get(vertex as usize).copied()));
    taken
}

fn blown(wind: &PartWind, vertices: &[u32]) -> PartWind {
    let target =
        |target: &Target| Target { motion: target.motion, offsets: taken(&target.offsets, vertices) };
    PartWind {
        motions: taken(&wind.motions, vertices),
        pivots: taken(&wind.pivots, vertices),
        axes: taken(&wind.axes, vertices),
        hierarchy: wind.hierarchy.clone(),
        targets: wind.targets.iter().map(target).collect(),
        sway: wind.sway.clone(),
        bindings: taken(&wind.bindings, vertices),
        bones: wind.bones.clone(),
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

    #[test]
    fn no_part_hangs_together_by_a_point() {
        // A wheel of six triangles round vertex 0.
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [0, 1 + i, 1 + (i + 1) % 6]).collect();
        let mesh = Mesh { positions: vec![Vec3::ZERO; 7], triangles, ..Mesh::default() };
        let whole = Part::new("wood", 0, mesh);
        // Opposite spokes are of one class: two fans of it meet at the hub, and those of the other, too.
        let parts = cut(&whole, &[0, 0, 1, 0, 1, 1], &["limbs"]);
        let hubs = |part: &Part| {
            let hubs: std::collections::BTreeSet<u32> =
                part.mesh.triangles.iter().map(|corners| corners[0]).collect();
            hubs.len()
        };
        assert_eq!([hubs(&parts[0]), hubs(&parts[1])], [2, 2]);
        // Three in a row, and what lies beside them: one fan each, with no vertex more.
        let parts = cut(&whole, &[0, 0, 0, 1, 1, 1], &["limbs"]);
        assert_eq!(parts.iter().map(|part| part.mesh.positions.len()).collect::<Vec<_>>(), [5, 5]);
    }
}
