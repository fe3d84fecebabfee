//! Meshes whose inside is known from a formula.

use linden::DVec3;
use linden::input::TriangleMesh;
use linden::random::Key;
use std::f64::consts::TAU;

/// A surface of `rings` × `sides` quads that closes on itself both ways.
fn wrapped(rings: u32, sides: u32, at: impl Fn(f64, f64) -> DVec3) -> TriangleMesh {
    let positions = (0..rings * sides)
        .map(|i| {
            at(f64::from(i / sides) / f64::from(rings) * TAU, f64::from(i % sides) / f64::from(sides) * TAU)
        })
        .collect();
    let vertex = |i: u32, k: u32| (i % rings) * sides + k % sides;
    let quad = |i: u32, k: u32| {
        let (a, b, c, d) = (vertex(i, k), vertex(i, k + 1), vertex(i + 1, k + 1), vertex(i + 1, k));
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..rings).flat_map(|i| (0..sides).flat_map(move |k| quad(i, k))).collect();
    TriangleMesh { positions, triangles }
}

/// A torus around Y: the middle of the tube 3 m from the axis, the tube 1 m thick in radius.
pub fn torus(rings: u32, sides: u32) -> TriangleMesh {
    wrapped(rings, sides, |u, v| {
        let out = 3.0 + libm::cos(v);
        DVec3::new(out * libm::cos(u), libm::sin(v), out * libm::sin(u))
    })
}

/// A ball of latitudes and longitudes, faces looking outward.
pub fn ball(centre: DVec3, radius: f64, rings: u32, sides: u32) -> TriangleMesh {
    let at = |ring: u32, side: u32| {
        let (theta, phi) =
            (f64::from(ring) / f64::from(rings) * TAU / 2.0, f64::from(side) / f64::from(sides) * TAU);
        let out = libm::sin(theta);
        centre + radius * DVec3::new(out * libm::cos(phi), libm::cos(theta), out * libm::sin(phi))
    };
    let mut mesh = TriangleMesh::default();
    mesh.positions.push(at(0, 0));
    for ring in 1..rings {
        mesh.positions.extend((0..sides).map(|side| at(ring, side)));
    }
    mesh.positions.push(at(rings, 0));
    let bottom = mesh.positions.len() as u32 - 1;
    let vertex = |ring: u32, side: u32| match ring {
        0 => 0,
        r if r == rings => bottom,
        r => 1 + (r - 1) * sides + side % sides,
    };
    for ring in 0..rings {
        for side in 0..sides {
            let (a, b) = (vertex(ring, side), vertex(ring, side + 1));
            let (c, d) = (vertex(ring + 1, side + 1), vertex(ring + 1, side));
            mesh.triangles.extend([[a, b, c], [a, c, d]].iter().filter(|t| t[0] != t[1] && t[1] != t[2]));
        }
    }
    mesh
}

/// Both meshes in one.
pub fn together(mut a: TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let first = a.positions.len() as u32;
    a.positions.extend(&b.positions);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    a
}

/// The same surface, looking the other way.
pub fn inside_out(mut mesh: TriangleMesh) -> TriangleMesh {
    for t in &mut mesh.triangles {
        t.swap(1, 2);
    }
    mesh
}

/// A point uniform in a box.
pub fn in_box(key: Key, low: DVec3, high: DVec3) -> DVec3 {
    low + (high - low) * DVec3::from([0, 1, 2].map(|axis| key.child(axis).unit()))
}
