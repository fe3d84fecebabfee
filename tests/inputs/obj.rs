//! OBJ against tobj on files that both read, and on mangled bytes.

use linden::input::{InputError, TriangleMesh, read_obj};
use linden::random::Key;
use linden::{DVec3, Quiet};

use crate::shapes::torus;

fn written(mesh: &TriangleMesh) -> String {
    let mut text = String::from("# torus\no torus\n");
    for p in &mesh.positions {
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    text += "vt 0 0\nvn 0 1 0\ng half\n";
    for (i, t) in mesh.triangles.iter().enumerate() {
        let count = mesh.positions.len() as i64;
        let [a, b, c] = t.map(|v| if i % 2 == 0 { i64::from(v) + 1 } else { i64::from(v) - count });
        text += &format!("f {a}/1/1 {b}/1/1 {c}/1/1\n");
    }
    text
}

#[test]
fn gives_the_same_triangles_as_tobj() {
    let mesh = torus(12, 8);
    let text = written(&mesh);
    let ours = read_obj(text.as_bytes(), &Quiet).unwrap();
    assert_eq!(ours, mesh);
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::GenericFailure);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials).unwrap();
    let theirs: Vec<[f32; 3]> = models
        .iter()
        .flat_map(|m| m.mesh.indices.iter().map(|&i| [0, 1, 2].map(|k| m.mesh.positions[3 * i as usize + k])))
        .collect();
    let corner = |v: u32| ours.positions[v as usize].to_array().map(|x| x as f32);
    assert_eq!(ours.triangles.iter().flatten().map(|&v| corner(v)).collect::<Vec<_>>(), theirs);
}

#[test]
fn gives_the_same_triangles_of_polygons_as_tobj() {
    // A prism with a pentagon below, one above and quads around.
    let mut text = String::new();
    for (height, order) in [(0, [0, 1, 2, 3, 4]), (1, [0, 1, 2, 3, 4])] {
        for (x, z) in order.map(|i| [(0, 0), (4, 0), (5, 3), (2, 5), (-1, 3)][i]) {
            text += &format!("v {x} {height} {z}\n");
        }
    }
    text += "f 1 2 3 4 5\nf -1 -2 -3 -4 -5\n";
    for i in 0..5 {
        let next = (i + 1) % 5;
        text += &format!("f {} {} {} {}\n", i + 1, i + 6, next + 6, next + 1);
    }
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::GenericFailure);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials).unwrap();
    let corner = |i: u32| [0, 1, 2].map(|k| f64::from(models[0].mesh.positions[3 * i as usize + k]));
    let theirs: Vec<[f64; 3]> = models[0].mesh.indices.iter().map(|&i| corner(i)).collect();
    // Ours passes over lines, which tobj takes for faces.
    let ours = read_obj(format!("{text}l 1 2 3 4\nl 5 6\n").as_bytes(), &Quiet).unwrap();
    let corners = ours.triangles.iter().flatten().map(|&v| ours.positions[v as usize].to_array());
    assert_eq!(corners.collect::<Vec<_>>(), theirs);
    assert_eq!(ours.triangles.len(), 2 * 3 + 5 * 2);
}

#[test]
fn mangled_files_give_a_value_or_an_error() {
    let text = written(&torus(5, 4)).into_bytes();
    let mut errors = 0;
    for i in 0..3000 {
        let key = Key::new(8).child(i);
        let mut bytes = text.clone();
        for k in 0..=key.bits() % 4 {
            let at = (key.child(k).named("at").unit() * bytes.len() as f64) as usize;
            bytes[at] = key.child(k).named("to").bits() as u8;
        }
        bytes.truncate((key.named("cut").between(0.5, 1.5) * bytes.len() as f64) as usize);
        match read_obj(&bytes, &Quiet) {
            Ok(mesh) => {
                let count = mesh.positions.len() as u32;
                assert!(mesh.triangles.iter().flatten().all(|&v| v < count));
                assert!(mesh.positions.iter().all(|p: &DVec3| p.is_finite()));
            }
            Err(InputError::Cancelled(_)) => panic!("nobody cancelled"),
            Err(_) => errors += 1,
        }
    }
    assert!(errors > 500, "{errors}");
}
