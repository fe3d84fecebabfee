//! The organs that `~` places: a row each.

use std::f32::consts::{PI, TAU};
use std::sync::LazyLock;

use glam::{Vec2, Vec3};

use linden_base::mesh::Mesh;

/// What an organ is: leaves have numbers of their own, which blossom and fruit have no part in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrganClass {
    /// A leaf or a needle, alone or several on a card.
    Leaf,
    /// A flower.
    Blossom,
    /// A fruit or a cone.
    Fruit,
}

/// A shape that a letter after `~` stands for.
pub struct Prototype {
    /// The letter that grammars write after `~`.
    pub letter: char,
    /// The name of the shape.
    pub name: &'static str,
    /// What it is.
    pub class: OrganClass,
    /// One line: how it looks and what is one unit of it.
    pub help: &'static str,
    shape: LazyLock<Mesh>,
}

/// All prototypes.
///
/// Each is one unit long along +Y, which becomes the turtle's heading, begins at the origin, and shows
/// its upper side to +Z, which becomes the turtle's up.
pub static PROTOTYPES: [Prototype; 4] = [
    Prototype::new('L', "leaf", OrganClass::Leaf, "a pointed leaf blade, one unit long", leaf),
    Prototype::new(
        'K',
        "blossom",
        OrganClass::Blossom,
        "five petals round the heading, one unit across",
        blossom,
    ),
    Prototype::new('B', "berry", OrganClass::Fruit, "a round fruit, one unit thick", berry),
    Prototype::new('N', "needle", OrganClass::Leaf, "a needle, one unit long", needle),
];

/// The index in [`PROTOTYPES`] that a letter stands for.
pub fn prototype(letter: char) -> Option<u8> {
    PROTOTYPES.iter().position(|prototype| prototype.letter == letter).map(|index| index as u8)
}

impl Prototype {
    const fn new(
        letter: char,
        name: &'static str,
        class: OrganClass,
        help: &'static str,
        shape: fn() -> Mesh,
    ) -> Self {
        Self { letter, name, class, help, shape: LazyLock::new(shape) }
    }

    /// Its triangles, with normals and texture coordinates from 0 to 1.
    pub fn mesh(&self) -> &Mesh {
        &self.shape
    }
}

/// A blade that is folded along its midrib and hangs a little.
fn leaf() -> Mesh {
    /// Rows of three vertices between base and tip.
    const ROWS: u32 = 5;
    const HALF_WIDTH: f32 = 0.24;
    const FOLD: f32 = 0.35;
    const DROOP: f32 = 0.16;
    let mut mesh = Mesh::default();
    let midrib = |t: f32| Vec3::new(0.0, t, -DROOP * t * t);
    push(&mut mesh, midrib(0.0), Vec2::new(0.5, 0.0));
    for row in 1..=ROWS {
        let t = row as f32 / (ROWS + 1) as f32;
        // Widest below the middle.
        let half = HALF_WIDTH * libm::sinf(PI * libm::powf(t, 0.8));
        for side in [-1.0, 0.0, 1.0_f32] {
            let out = Vec3::new(side * half, 0.0, FOLD * half * side.abs());
            push(&mut mesh, midrib(t) + out, Vec2::new(0.5 + 0.5 * side * half / HALF_WIDTH, t));
        }
    }
    push(&mut mesh, midrib(1.0), Vec2::new(0.5, 1.0));
    let (first, last) = (1, 1 + 3 * (ROWS - 1));
    let tip = last + 3;
    mesh.triangles.extend([[0, first + 1, first], [0, first + 2, first + 1]]);
    for row in (first..last).step_by(3) {
        for (a, b) in [(row, row + 1), (row + 1, row + 2)] {
            mesh.triangles.extend([[a, b, b + 3], [a, b + 3, a + 3]]);
        }
    }
    mesh.triangles.extend([[last, last + 1, tip], [last + 1, last + 2, tip]]);
    mesh.with_smooth_normals()
}

/// Five petals that open towards the heading.
fn blossom() -> Mesh {
    const PETALS: u32 = 5;
    const LENGTH: f32 = 0.53;
    /// Above the plane square to the heading.
    const ELEVATION: f32 = 0.35;
    const CUP: f32 = 0.06;
    // Along the petal, and half as wide as it is there.
    const SECTIONS: [(f32, f32); 3] = [(0.0, 0.0), (0.55, 0.19), (1.0, 0.13)];
    let (rise, reach) = libm::sincosf(ELEVATION);
    let mut mesh = Mesh::default();
    for petal in 0..PETALS {
        let (sin, cos) = libm::sincosf(TAU * petal as f32 / PETALS as f32);
        let out = Vec3::new(sin * reach, rise, cos * reach);
        let across = Vec3::new(-cos, 0.0, sin);
        let up = across.cross(out);
        let base = mesh.positions.len() as u32;
        for (along, half) in SECTIONS {
            for side in [-1.0, 0.0, 1.0_f32] {
                if half == 0.0 && side != 0.0 {
                    continue;
                }
                // The notch at the petal's end.
                let along = if along == 1.0 && side == 0.0 { 0.93 } else { along };
                let cup = up * (CUP * side.abs() * half / 0.19);
                let at = out * (along * LENGTH) + across * (side * half) + cup;
                push(&mut mesh, at, Vec2::new(0.5 + side * half / 0.38, along));
            }
        }
        let (l, m, r) = (base + 1, base + 2, base + 3);
        mesh.triangles.extend([[base, m, l], [base, r, m]]);
        for (a, b) in [(l, m), (m, r)] {
            mesh.triangles.extend([[a, b, b + 3], [a, b + 3, a + 3]]);
        }
    }
    mesh.with_smooth_normals()
}

/// A ball that touches the turtle.
fn berry() -> Mesh {
    const ROUND: u32 = 10;
    const RINGS: u32 = 6;
    let mut mesh = Mesh::default();
    // From the stalk to the far end; each ring has a seam, the poles a vertex for each side.
    for ring in 0..=RINGS {
        let v = ring as f32 / RINGS as f32;
        let (radius, height) = match ring {
            0 => (0.0, -1.0),
            RINGS => (0.0, 1.0),
            _ => {
                let (sin, cos) = libm::sincosf(PI * v);
                (sin, -cos)
            }
        };
        for side in 0..=ROUND {
            // The seam's two ends are in the same place to the last bit.
            let (sin, cos) = libm::sincosf(TAU * (side % ROUND) as f32 / ROUND as f32);
            let normal = Vec3::new(sin * radius, height, cos * radius);
            push(&mut mesh, (normal + Vec3::Y) / 2.0, Vec2::new(side as f32 / ROUND as f32, v));
            mesh.normals.push(normal.normalize());
        }
    }
    for ring in 0..RINGS {
        for side in 0..ROUND {
            let a = ring * (ROUND + 1) + side;
            let b = a + ROUND + 1;
            if ring > 0 {
                mesh.triangles.push([a, a + 1, b + 1]);
            }
            if ring + 1 < RINGS {
                mesh.triangles.push([a, b + 1, b]);
            }
        }
    }
    compact(&mesh)
}

/// A pyramid of three sides, so that it is seen from each.
fn needle() -> Mesh {
    const RADIUS: f32 = 0.025;
    let mut mesh = Mesh::default();
    for side in 0..3_u8 {
        // From one edge to the next, and the tip between them: sides that shared an edge's foot alone
        // would be no manifold.
        for (corner, height) in [(0.0, 0.0), (1.0, 0.0), (0.5, 1.0)] {
            let turn = f32::from(side) + corner;
            let (sin, cos) = libm::sincosf(TAU * (turn % 3.0) / 3.0);
            let out = Vec3::new(sin, 0.0, cos);
            push(
                &mut mesh,
                out * (RADIUS * (1.0 - height)) + Vec3::Y * height,
                Vec2::new(turn / 3.0, height),
            );
            mesh.normals.push((out + Vec3::Y * (RADIUS * height)).normalize());
        }
    }
    mesh.triangles.extend([0, 3, 6].map(|a| [a, a + 1, a + 2]));
    mesh
}

fn push(mesh: &mut Mesh, position: Vec3, uv: Vec2) {
    mesh.positions.push(position);
    mesh.uvs.push(uv);
}

/// Without the vertices that no triangle has.
fn compact(mesh: &Mesh) -> Mesh {
    let mut kept = Mesh::default();
    let mut index = vec![None; mesh.positions.len()];
    let mut keep = |vertex: u32| {
        let old = vertex as usize;
        *index[old].get_or_insert_with(|| {
            kept.positions.push(mesh.positions[old]);
            kept.normals.push(mesh.normals[old]);
            kept.uvs.push(mesh.uvs[old]);
            kept.positions.len() as u32 - 1
        })
    };
    let triangles = mesh.triangles.iter().map(|triangle| triangle.map(&mut keep)).collect();
    Mesh { triangles, ..kept }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_base::topology::topology;

    #[test]
    fn every_prototype_is_a_sound_mesh_of_one_unit() {
        for prototype in &PROTOTYPES {
            let mesh = prototype.mesh();
            let name = prototype.name;
            assert_eq!(mesh.normals.len(), mesh.positions.len(), "{name}");
            assert_eq!(mesh.uvs.len(), mesh.positions.len(), "{name}");
            let mut used = vec![false; mesh.positions.len()];
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
                let normal = (b - a).cross(c - a);
                assert!(normal.length() > 1e-4, "{name}: a triangle without area");
                for &vertex in triangle {
                    used[vertex as usize] = true;
                    assert!(mesh.normals[vertex as usize].dot(normal) > 0.0, "{name}: winding and normals");
                }
            }
            assert!(used.iter().all(|&used| used), "{name}");
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{name}");
            assert!(
                mesh.uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()),
                "{name}"
            );
            let size = mesh.bounds().unwrap().size();
            let (extent, axis) = if prototype.letter == 'K' { (size.x, "across") } else { (size.y, "long") };
            assert!((extent - 1.0).abs() < 0.06, "{name} is {extent} {axis}");
        }
    }

    #[test]
    fn a_leaf_shows_its_upper_side_up_and_a_blossom_to_its_heading() {
        let mean = |letter: char| {
            let mesh = PROTOTYPES[prototype(letter).unwrap() as usize].mesh();
            mesh.normals.iter().copied().sum::<Vec3>().normalize()
        };
        assert!(mean('L').z > 0.9, "{}", mean('L'));
        assert!(mean('K').y > 0.9, "{}", mean('K'));
    }

    #[test]
    fn a_berry_is_a_closed_ball() {
        let mesh = PROTOTYPES[prototype('B').unwrap() as usize].mesh();
        assert!(topology(mesh, &Quiet).unwrap().watertight());
        let volume: f32 = mesh
            .triangles
            .iter()
            .map(|t| t.map(|v| mesh.positions[v as usize]))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum();
        // Of a ball of diameter 1: π/6, and a little less for an inscribed one.
        assert!((0.40..PI / 6.0).contains(&volume), "{volume}");
    }
}
