//! Leaves from meshes that users bring.

use linden_pipeline::recipe::Input;

use super::*;

/// A pyramid two metres high on y = 1.
const PYRAMID: &str = "v 0 1 0\nv 1 1 0\nv 0 1 1\nv 0 3 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn with_mesh(text: &str) -> Subject {
    let mut subject =
        recipe("leaf_form = \"mesh\"\nleaf_mesh = \"a.obj\"\nleaf_colors = [\"#ff0000\", \"#00ff00\"]");
    subject.recipe.inputs.insert("a.obj", Input::read("a.obj", text.as_bytes(), &Quiet).unwrap());
    subject
}

#[test]
fn a_mesh_of_the_users_stands_on_its_foot_one_unit_high() {
    let organs = grown(&with_mesh(PYRAMID), &twigs(1, 3));
    assert_eq!(organs.shapes.len(), 2, "a variant for each colour");
    let mesh = &organs.shapes[0].mesh;
    assert_eq!(mesh.positions[0], Vec3::ZERO);
    assert_eq!(mesh.positions[3], Vec3::Y);
    assert_eq!(mesh.positions[1], Vec3::X / 2.0);
    let recipe = with_mesh(PYRAMID);
    let first = &recipe.dressing.foliage.first;
    let cover = recipe.with(|specimen| cover(specimen, 0, first, 64, &Quiet)).unwrap();
    assert_eq!(cover.cutout, None);
    let pixel = |cell: &crate::texture::leaf::Cell| {
        let at = (cell.min + cell.max) / 2.0;
        let (w, h) = (cover.base_color.width() as f32, cover.base_color.height() as f32);
        let i = ((1.0 - at.y) * h) as usize * w as usize + (at.x * w) as usize;
        cover.base_color.rgba().as_chunks::<4>().0[i]
    };
    assert_eq!(cover.cells.iter().map(pixel).collect::<Vec<_>>(), [[255, 0, 0, 255], [0, 255, 0, 255]]);
}

#[test]
fn a_mesh_that_lies_on_its_side_is_noted() {
    let blade = |text: &str| {
        let input = Input::read("a.obj", text.as_bytes(), &Quiet).unwrap();
        match input.geometry {
            linden_base::input::Geometry::Mesh(mesh) => mesh_note("a.obj", &mesh),
            _ => panic!("no mesh"),
        }
    };
    // Along Z, as Blender has it before its exporter turns it.
    let lying = blade("v -0.2 0 0\nv 0.2 0 0\nv 0 0.1 1\nf 1 2 3\n").unwrap();
    assert!(
        lying.starts_with("leaf_mesh: 'a.obj'") && lying.contains("10.0 times as long along Z"),
        "{lying}"
    );
    assert_eq!(blade("v -0.2 0 0\nv 0.2 0 0\nv 0 1 0.1\nf 1 2 3\n"), None);
    // A bowl is wider than high, and may be meant so.
    assert_eq!(blade("v -0.5 0 0\nv 0.5 0 0\nv 0 0.5 0.5\nf 1 2 3\n"), None);
}

#[test]
fn what_is_wrong_with_a_leafs_file_is_said() {
    let tree = twigs(1, 3);
    let said = |subject: &Subject| sprout(subject, &tree, &Arc::default(), &Quiet).unwrap_err().to_string();
    assert!(said(&recipe("leaf_form = \"mesh\"")).contains("leaf_mesh = "));
    assert!(
        said(&recipe("leaf_form = \"mesh\"\nleaf_mesh = \"a.obj\""))
            .contains("'a.obj', which must hold a mesh")
    );
    assert!(
        said(&recipe("leaf_form = \"card\"\nleaf_picture = \"a.png\""))
            .contains("'a.png', which must hold a picture")
    );
    assert!(said(&with_mesh("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")).contains("no height"));
    let many = format!("{PYRAMID}{}", "f 1 2 4\n".repeat(20_000));
    assert!(said(&with_mesh(&many)).contains("20004 triangles, more than the limit of 20000"));
    let error = Input::read("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", &Quiet).unwrap_err().to_string();
    assert!(error.contains("no faces"), "{error}");
    let error = Input::read("a.png", b"\x89PNG\r\n\x1a\nnonsense", &Quiet).unwrap_err().to_string();
    assert!(error.contains("PNG"), "{error}");
}
