//! Files come back as the scene that went in, read by crates that share nothing with the writers.

use std::fs;
use std::path::Path;

use linden::scene::{Mesh, Scene};
use linden_exporters::writing::identifier;
use linden_tests::fixtures::{RECIPE, export, large, scene};

fn obj(path: &Path) -> (Vec<tobj::Model>, Vec<tobj::Material>) {
    let (models, materials) = tobj::load_obj(path, &tobj::LoadOptions::default()).unwrap();
    (models, materials.unwrap())
}

/// What files call something of a plant.
fn named(scene: &Scene, what: &str) -> String {
    format!("{}_{what}", identifier(&scene.name))
}

fn floats(of: &[impl bytemuck::NoUninit]) -> Vec<f32> {
    bytemuck::cast_slice::<_, f32>(of).to_vec()
}

#[test]
fn tobj_reads_the_same_meshes_and_materials() {
    let dir = tempfile::tempdir().unwrap();
    let scene = scene(20, 16);
    let target = dir.path().join("tree.obj");
    export(&scene, "obj", &[], &target).unwrap();
    let (models, materials) = obj(&target);
    assert_eq!(models.len(), scene.parts.len());
    for (model, part) in models.iter().zip(&scene.parts) {
        // tobj numbers vertices by their first use, so corners are compared.
        let corners = part.mesh.triangles.concat();
        assert_eq!(model.mesh.indices.len(), corners.len());
        assert_eq!(model.mesh.positions.len(), 3 * part.mesh.positions.len());
        for (&read, &corner) in model.mesh.indices.iter().zip(&corners) {
            let (read, corner) = (read as usize, corner as usize);
            assert_eq!(model.mesh.positions[3 * read..][..3], part.mesh.positions[corner].to_array());
            assert_eq!(model.mesh.normals[3 * read..][..3], part.mesh.normals[corner].to_array());
            assert_eq!(model.mesh.texcoords[2 * read..][..2], part.mesh.uvs[corner].to_array());
        }
        let material = &scene.materials[part.material].name;
        assert_eq!(materials[model.mesh.material_id.unwrap()].name, named(&scene, material));
    }
    assert_eq!(materials[0].diffuse_texture.as_deref(), Some("tree_bark.png"));
    // Blender reads the one, assimp the other.
    let library = fs::read_to_string(dir.path().join("tree.mtl")).unwrap();
    for line in ["norm tree_bark_normal.png", "map_Bump -bm 1 tree_bark_normal.png"] {
        assert_eq!(library.lines().filter(|read| *read == line).count(), 1, "{line}");
    }
    assert_eq!(materials[0].diffuse, Some([1.0; 3]));
    assert_eq!(materials[1].diffuse, Some(scene.materials[1].base_color));
    assert!(dir.path().join("tree_bark.png").is_file());
    let text = fs::read_to_string(&target).unwrap();
    assert!(text.lines().any(|line| line.strip_prefix("# recipe: ") == Some(RECIPE)));
}

#[test]
fn obj_lines_are_the_axes() {
    let dir = tempfile::tempdir().unwrap();
    let scene = scene(3, 5);
    let target = dir.path().join("tree.obj");
    export(&scene, "obj", &[("lines", "true"), ("pictures", "false")], &target).unwrap();
    let text = fs::read_to_string(&target).unwrap();
    let surface: usize = scene.parts.iter().map(|part| part.mesh.positions.len()).sum();
    let lines: Vec<Vec<usize>> = text
        .lines()
        .filter_map(|line| line.strip_prefix("l "))
        .map(|line| line.split(' ').map(|n| n.parse::<usize>().unwrap() - 1 - surface).collect())
        .collect();
    assert_eq!(lines, [vec![0, 1, 2, 3, 4, 5, 6, 7], vec![4, 8, 9, 10, 11], vec![9, 12]]);
    let vertices = text.lines().filter(|line| line.starts_with("v ")).count();
    assert_eq!(vertices, surface + scene.skeleton.positions.len());
    assert!(!dir.path().join("tree_bark.png").exists());
    assert!(obj(&target).1[0].diffuse_texture.is_none());
}

/// Compares meshes and materials of a glTF in any packing.
fn assert_gltf_is(path: &Path, scene: &Scene, with_pictures: bool) {
    let (document, buffers, images) = gltf::import(path).unwrap();
    assert_eq!(document.meshes().len(), scene.parts.len());
    for (mesh, part) in document.meshes().zip(&scene.parts) {
        assert_eq!(mesh.name(), Some(named(scene, &part.name).as_str()));
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        let Mesh { positions, normals, uvs, triangles } = &part.mesh;
        assert!(reader.read_positions().unwrap().flatten().eq(floats(positions)));
        assert!(reader.read_normals().unwrap().flatten().eq(floats(normals)));
        let flipped = uvs.iter().flat_map(|uv| [uv.x, 1.0 - uv.y]);
        assert!(reader.read_tex_coords(0).unwrap().into_f32().flatten().eq(flipped));
        assert!(reader.read_indices().unwrap().into_u32().eq(triangles.concat()));
        let bounds = part.mesh.bounds().unwrap();
        assert_eq!(primitive.bounding_box().min, bounds.min.to_array());
        assert_eq!(primitive.bounding_box().max, bounds.max.to_array());
        let material = primitive.material();
        assert_eq!(material.name(), Some(named(scene, &scene.materials[part.material].name).as_str()));
        assert_eq!(material.double_sided(), scene.materials[part.material].double_sided);
    }
    if with_pictures {
        let source = scene.materials[0].base_color_picture.as_ref().unwrap();
        assert_eq!((images[0].width, images[0].height), (source.width(), source.height()));
        let rgb: Vec<u8> = source.rgba().chunks(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        assert!(images[0].pixels == rgb);
        assert!(document.materials().next().unwrap().normal_texture().is_some());
    } else {
        assert!(images.is_empty());
        let factor = document.materials().next().unwrap().pbr_metallic_roughness().base_color_factor();
        assert_eq!(factor[..3], scene.materials[0].base_color);
    }
    let root = document.default_scene().unwrap().nodes().next().unwrap();
    assert_eq!(root.name(), Some(scene.name.as_str()));
    let extras = root.extras().as_ref().unwrap().get();
    // The recipe keeps its letters; what follows is told of in levels.rs.
    assert!(extras.starts_with(&format!(r#"{{"linden":{RECIPE},"linden_tree":{{"level":0,"#)), "{extras}");
}

#[test]
fn gltf_reads_the_same_scene_in_every_packing() {
    let dir = tempfile::tempdir().unwrap();
    // An odd number of triangles and of PNG bytes, so that padding is needed somewhere.
    for sides in [7, 16] {
        let scene = scene(5, sides);
        for (name, format, options, pictures) in [
            ("a.glb", "glb", &[][..], true),
            ("b.glb", "glb", &[("pictures", "false")][..], false),
            ("c.gltf", "gltf", &[][..], true),
            ("d.gltf", "gltf", &[("embed", "true")][..], true),
            ("e.gltf", "gltf", &[("pictures", "false")][..], false),
        ] {
            let target = dir.path().join(name);
            let written = export(&scene, format, options, &target).unwrap();
            assert_gltf_is(&target, &scene, pictures);
            let files = if name == "c.gltf" {
                4
            } else if name == "e.gltf" {
                2
            } else {
                1
            };
            assert_eq!(written.len(), files, "{name}");
            assert!(written.iter().all(|file| fs::metadata(&file.path).unwrap().len() == file.bytes));
        }
    }
}

#[test]
fn gltf_stores_colors_in_the_format_that_was_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let scene = scene(5, 7);
    let color = scene.materials[0].base_color_picture.as_ref().unwrap();
    for (word, ending, off) in [("png", "png", 0), ("jpeg", "jpg", 12), ("webp", "webp", 0)] {
        let target = dir.path().join(format!("{word}.gltf"));
        export(&scene, "gltf", &[("picture_format", word)], &target).unwrap();
        let document: serde_json::Value = serde_json::from_slice(&fs::read(&target).unwrap()).unwrap();
        let uris: Vec<&str> = document["images"]
            .as_array()
            .unwrap()
            .iter()
            .map(|image| image["uri"].as_str().unwrap())
            .collect();
        assert_eq!(uris, [format!("{word}_bark.{ending}"), format!("{word}_bark_normal.png")]);
        assert_eq!(document["images"][0]["mimeType"], format!("image/{word}"));
        assert!(document["images"][0]["name"].as_str().unwrap().ends_with("_bark"));
        let is_webp = word == "webp";
        for key in ["extensionsUsed", "extensionsRequired"] {
            let named =
                document[key].as_array().is_some_and(|all| all.iter().any(|e| e == "EXT_texture_webp"));
            assert_eq!(named, is_webp, "{word}: {key}");
        }
        let texture = &document["textures"][0];
        assert_eq!(texture.get("source").is_none(), is_webp);
        let source =
            if is_webp { &texture["extensions"]["EXT_texture_webp"]["source"] } else { &texture["source"] };
        assert_eq!(source, 0);

        let file = fs::read(dir.path().join(uris[0])).unwrap();
        let found = linden::input::read_picture("", &file, &linden::Quiet).unwrap().picture;
        assert_eq!((found.width(), found.height()), (color.width(), color.height()));
        // Far from an edge of colours, where JPEG is near.
        let most = found.rgba().iter().zip(color.rgba()).map(|(a, b)| a.abs_diff(*b));
        let mean = most.map(u64::from).sum::<u64>() / found.rgba().len() as u64;
        assert!(mean <= off, "{word}: off by {mean}");
    }
    // The pictures inside the file are the same.
    for word in ["jpeg", "webp"] {
        let target = dir.path().join(format!("{word}.glb"));
        export(&scene, "glb", &[("picture_format", word)], &target).unwrap();
        let ending = if word == "jpeg" { "jpg" } else { word };
        let beside = fs::read(dir.path().join(format!("{word}_bark.{ending}"))).unwrap();
        let whole = fs::read(&target).unwrap();
        assert!(whole.windows(beside.len()).any(|bytes| bytes == beside), "{word}");
    }
}

#[test]
fn indices_are_short_where_they_fit_and_never_65535() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.glb");
    let mut scene = scene(3, 5);
    for (count, size) in [(65_535, gltf::accessor::DataType::U16), (65_536, gltf::accessor::DataType::U32)] {
        let mesh = &mut scene.parts[0].mesh;
        let last = mesh.positions.len() as u32 - 1;
        mesh.positions.resize(count, mesh.positions[last as usize]);
        mesh.normals.resize(count, mesh.normals[last as usize]);
        mesh.uvs.resize(count, mesh.uvs[last as usize]);
        mesh.triangles[0] = [0, 1, count as u32 - 1];
        export(&scene, "glb", &[], &target).unwrap();
        let document = gltf::Gltf::open(&target).unwrap();
        let indices = document.meshes().next().unwrap().primitives().next().unwrap().indices().unwrap();
        assert_eq!(indices.data_type(), size);
        assert_gltf_is(&target, &scene, true);
    }
}

#[test]
fn text_is_the_same_on_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    let scene = large(60_000);
    for (format, name, options) in [
        ("obj", "tree.obj", &[("lines", "true")][..]),
        ("usda", "tree.usda", &[]),
        ("usdc", "tree.usdc", &[]),
        ("ply", "tree.ply", &[("encoding", "ascii")]),
        ("ply-skeleton", "tree.ply", &[("encoding", "ascii")]),
        ("qsm", "tree.csv", &[]),
        ("mtg", "tree.mtg", &[]),
    ] {
        let bytes = [1, 3].map(|threads| {
            let target = dir.path().join(name);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| export(&scene, format, options, &target)).unwrap();
            fs::read(target).unwrap()
        });
        assert!(bytes[0] == bytes[1], "{format}");
    }
}

#[test]
fn ply_is_what_its_header_says_in_both_encodings() {
    let dir = tempfile::tempdir().unwrap();
    let scene = scene(6, 7);
    for format in ["ply", "ply-skeleton"] {
        let read = |encoding| {
            let target = dir.path().join(encoding);
            export(&scene, format, &[("encoding", encoding)], &target).unwrap();
            fs::read(&target).unwrap()
        };
        let (binary, ascii) = (read("binary"), String::from_utf8(read("ascii")).unwrap());
        let end = b"end_header\n";
        let body = binary.windows(end.len()).position(|window| window == end).unwrap() + end.len();
        let (head, numbers) = ascii.split_once("end_header\n").unwrap();
        let recipe: String = head.lines().filter_map(|line| line.strip_prefix("comment recipe: ")).collect();
        assert_eq!(recipe, RECIPE);
        assert!(head.lines().all(|line| line.len() < 250));
        // Walk the binary body by the ascii one: every number of the text at its place, in its type.
        let mut at = body;
        let element_of = |row: usize| {
            let mut rows = row;
            for element in head.split("element ").skip(1) {
                let mut lines = element.lines();
                let count: usize = lines.next().unwrap().split(' ').nth(1).unwrap().parse().unwrap();
                if rows < count {
                    return lines.filter_map(|line| line.strip_prefix("property ")).collect::<Vec<_>>();
                }
                rows -= count;
            }
            panic!("more rows than the header says");
        };
        let take = |at: &mut usize, kind: &str| -> f64 {
            let size = if kind == "uchar" { 1 } else { 4 };
            let bytes = &binary[*at..*at + size];
            *at += size;
            match kind {
                "float" => f32::from_le_bytes(bytes.try_into().unwrap()).into(),
                "int" => i32::from_le_bytes(bytes.try_into().unwrap()).into(),
                _ => bytes[0].into(),
            }
        };
        for (row, line) in numbers.lines().enumerate() {
            let mut words = line.split(' ');
            for property in element_of(row) {
                let kinds: Vec<&str> = property.split(' ').collect();
                let mut expect = |kind: &str| {
                    let text = words.next().unwrap();
                    let number = if kind == "float" {
                        f64::from(text.parse::<f32>().unwrap())
                    } else {
                        text.parse().unwrap()
                    };
                    assert_eq!(take(&mut at, kind), number, "{format} row {row} {property}");
                    number
                };
                if kinds[0] == "list" {
                    let count = expect(kinds[1]);
                    (0..count as usize).for_each(|_| {
                        expect(kinds[2]);
                    });
                } else {
                    expect(kinds[0]);
                }
            }
            assert!(words.next().is_none());
        }
        assert_eq!(at, binary.len());
    }
}
