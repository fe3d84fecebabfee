//! Positions and indices for a renderer of your own: `cargo run --example mesh`

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use linden::scene::Scene;

fn main() -> Result<(), linden::Error> {
    let tree = linden::tree("dressed-simple")?.set("triangles", "20000")?.grow()?;
    let levels = tree.levels()?;
    for level in &levels.levels {
        let (vertices, indices) = buffers(&level.scene);
        println!("{} floats a vertex × {}, {} indices", 8, vertices.len() / 8, indices.len());
        for material in &level.scene.materials {
            let picture = material.base_color_picture.as_ref();
            let pixels = picture.map_or((0, 0), |picture| (picture.width(), picture.height()));
            println!("  {}: {:?}, picture {} × {}", material.name, material.base_color, pixels.0, pixels.1);
        }
    }
    Ok(())
}

/// One interleaved vertex buffer (position, normal, texture coordinate) and its indices, of all parts.
fn buffers(scene: &Scene) -> (Vec<f32>, Vec<u32>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for part in &scene.parts {
        let first = (vertices.len() / 8) as u32;
        let mesh = &part.mesh;
        for ((position, normal), uv) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.uvs) {
            vertices.extend(position.to_array());
            vertices.extend(normal.to_array());
            vertices.extend(uv.to_array());
        }
        indices.extend(mesh.triangles.iter().flatten().map(|index| first + index));
    }
    (vertices, indices)
}
