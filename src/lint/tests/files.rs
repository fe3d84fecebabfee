//! Files: what formats say, what they cannot, and what is broken in them.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod model;

use std::collections::BTreeMap;

use linden_base::monitor::{Monitor, Phase, Quiet};
use linden_lint::{Alpha, Aspect, Beside, Config, NoFiles, ReadError, lint, read};
use model::Model;
use serde_json::{Value, json};

/// Files by their names.
struct Files(BTreeMap<&'static str, Vec<u8>>);

impl Beside for Files {
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String> {
        if name.contains("..") { Err("it lies outside".to_owned()) } else { Ok(self.0.get(name).cloned()) }
    }
}

fn no_files() -> Files {
    Files(BTreeMap::new())
}

const OBJ: &str = "mtllib a.mtl\no trunk_LOD0\nv 0 0 0\nv 1 0 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl bark\n\
                   f 1/1/1 2/2/1 3/3/1\no leaf_LOD1\nusemtl green\nf 1/1/1 2/2/1 3/3/1\no UCX_trunk\nf 1 2 3\n";

#[test]
fn an_obj_has_materials_pictures_levels_and_colliders() {
    let mut files = no_files();
    let mtl = "newmtl bark\nmap_Kd -s 2 2 2 bark.png\nmap_bump up/../../normal.png\nnewmtl green\nmap_Kd leaf.tga\nmap_d leaf.tga\n";
    files.0.insert("a.mtl", mtl.into());
    files.0.insert("leaf.tga", vec![1, 2, 3]);
    let asset = read("a.obj", OBJ.as_bytes(), &files, &Quiet).unwrap();
    let names: Vec<&str> = asset.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!((names.as_slice(), asset.materials[1].is_cut), (&["bark", "green"][..], true));
    assert_eq!((asset.levels.len(), asset.levels[1].number, asset.colliders.len()), (2, 1, 1));
    let problems: Vec<(&str, Option<&str>)> =
        asset.textures.iter().map(|texture| (texture.name.as_str(), texture.problem.as_deref())).collect();
    assert!(problems.contains(&("bark.png", Some("it is not there"))), "{problems:?}");
    assert!(asset.unseen.iter().any(|unseen| unseen.aspect == Aspect::Alpha));
    let missing = read("a.obj", OBJ.as_bytes(), &no_files(), &Quiet).unwrap();
    assert!(
        missing
            .unseen
            .iter()
            .any(|unseen| unseen.aspect == Aspect::Materials && unseen.why.contains("a.mtl"))
    );
}

#[test]
fn strips_fans_and_quantized_vertices_are_read() {
    let document = |mode: u32, count: usize| {
        let bytes: Vec<u8> = [[0_i16, 0, 0], [100, 0, 0], [0, 100, 0], [100, 100, 0], [200, 50, 0]]
            .iter()
            .flat_map(|at| at.iter().chain([&0]).flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())
            .collect();
        let uri = format!(
            "data:;base64,{}",
            base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bytes)
        );
        let document = json!({
            "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": [0.01, 0.01, 0.01]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": mode}]}],
            "accessors": [{"bufferView": 0, "componentType": 5122, "type": "VEC3", "count": count}],
            "bufferViews": [{"buffer": 0, "byteLength": 40, "byteStride": 8}],
            "buffers": [{"byteLength": 40, "uri": uri}], "extensionsRequired": ["KHR_mesh_quantization", "X_unknown"],
        });
        read("a.gltf", &serde_json::to_vec(&document).unwrap(), &NoFiles, &Quiet)
    };
    for (mode, expected) in [
        (4, vec![[0, 1, 2]]),
        (5, vec![[0, 1, 2], [2, 1, 3], [2, 3, 4]]),
        (6, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
    ] {
        let asset = document(mode, 5).unwrap();
        assert_eq!(asset.meshes[0].geometry.as_ref().unwrap().triangles, expected, "mode {mode}");
        let height = lint(&asset, &Config::default()).numbers.height_m.unwrap();
        assert!((height - 1.0).abs() < 1e-6, "{height}");
    }
    assert!(document(4, 6).unwrap_err().to_string().contains("not enough bytes"));
    assert!(document(0, 5).unwrap_err().to_string().contains("no triangles"));
}

#[test]
fn levels_by_extension_and_instances_are_counted() {
    let mut model = Model::clean();
    model.parts.truncate(4);
    for part in &mut model.parts {
        part.name = part.name.replace("_LOD", "_");
    }
    model.edit = |document| {
        // The second pair is the coarser level of a root over the first; a tree stands in two places.
        document["scenes"] = json!([{"nodes": [4]}]);
        let nodes = document["nodes"].as_array_mut().unwrap();
        nodes.push(json!({"name": "oak", "children": [0, 1], "extensions": {"MSFT_lod": {"ids": [5]}}}));
        nodes.push(json!({"name": "oak far", "children": [2, 3]}));
        let places = document["accessors"].as_array().unwrap().len();
        let view = document["bufferViews"].as_array().unwrap().len();
        document["accessors"]
            .as_array_mut()
            .unwrap()
            .push(json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 2}));
        document["bufferViews"].as_array_mut().unwrap().push(json!({"buffer": 0, "byteLength": 24}));
        document["nodes"][1]["extensions"] =
            json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    };
    let asset = model.read();
    let report = lint(&asset, &Config::default());
    assert_eq!(
        (report.numbers.triangles.as_slice(), report.numbers.draw_calls.as_slice()),
        (&[12 + 2 * 20, 12 + 4][..], &[2, 2][..])
    );
    assert_eq!(asset.materials[1].alpha, Some(Alpha::Mask));
}

#[test]
fn what_is_packed_is_counted_and_not_passed() {
    let mut model = Model::clean();
    model.edit = |document| {
        for view in document["bufferViews"].as_array_mut().unwrap() {
            view["extensions"] = json!({"EXT_meshopt_compression": {"buffer": 0, "byteLength": 1}});
        }
    };
    let asset = model.read();
    let report = lint(&asset, &Config::default());
    assert_eq!((report.numbers.triangles.as_slice(), report.numbers.height_m), (&[32, 16][..], None));
    for rule in ["degenerate", "normals", "pivot", "winding"] {
        assert!(report.not_looked_at.iter().any(|unseen| unseen.rule == rule), "{rule}");
    }
}

/// The crate gltf as another reader.
#[test]
fn another_reader_finds_the_same() {
    // That crate reads no pictures out of text.
    let model = Model { pictures: Vec::new(), materials: vec![json!({}), json!({})], ..Model::clean() };
    let bytes = model.gltf();
    let asset = read("a.gltf", &bytes, &NoFiles, &Quiet).unwrap();
    let (document, buffers, _) = gltf::import_slice(&bytes).unwrap();
    for (mesh, ours) in document.meshes().zip(&asset.meshes) {
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        let geometry = ours.geometry.as_ref().unwrap();
        let positions: Vec<[f32; 3]> = geometry.positions.iter().map(glam::Vec3::to_array).collect();
        assert_eq!(reader.read_positions().unwrap().collect::<Vec<_>>(), positions);
        let normals: Vec<[f32; 3]> = geometry.normals.iter().flatten().map(glam::Vec3::to_array).collect();
        assert_eq!(reader.read_normals().unwrap().collect::<Vec<_>>(), normals);
        let indices: Vec<u32> = geometry.triangles.iter().flatten().copied().collect();
        assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), indices);
        for set in [0, 1] {
            let theirs = reader.read_tex_coords(set).map(|uvs| uvs.into_f32().collect::<Vec<_>>());
            let ours = geometry.uvs[set as usize]
                .as_ref()
                .map(|uvs| uvs.iter().map(glam::Vec2::to_array).collect::<Vec<_>>());
            assert_eq!(theirs, ours);
        }
    }
}

#[test]
fn broken_files_are_errors_that_say_so() {
    let said = |name: &str, bytes: &[u8]| read(name, bytes, &NoFiles, &Quiet).unwrap_err().to_string();
    assert!(said("a.glb", b"glTF\x02\0\0\0").contains("no document"));
    assert!(
        said("a.glb", b"glTF\x02\0\0\0\x20\0\0\0\xff\xff\xff\xffJSON{}").contains("longer than the file")
    );
    assert!(said("a.glb", b"glTF\x01\0\0\0").contains("version 1"));
    assert!(said("a.gltf", b"{\"nodes\": 3}").contains("its document"));
    assert!(said("a.gltf", b"{}").contains("no triangles"));
    assert!(said("a.fbx", b"Kaydara FBX Binary").contains("as GLB"));
    assert!(said("a.obj", b"v 1\n").starts_with("OBJ: "));
    assert!(
        said("a.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999\nproperty float x\nend_header\n")
            .starts_with("PLY: ")
    );
    assert!(said("a.txt", b"hello").contains("none of the formats"));
    let edited = |edit: fn(&mut Value)| {
        let model = Model { edit, ..Model::clean() };
        read("a.gltf", &model.gltf(), &NoFiles, &Quiet).unwrap_err().to_string()
    };
    for (expected, edit) in [
        (
            "4294967296 rows",
            (|document| document["accessors"][0]["count"] = (1_u64 << 32).into()) as fn(&mut Value),
        ),
        ("not enough bytes", |document| document["accessors"][0]["count"] = 4_000_000_000_u32.into()),
        ("buffer view that is not there", |document| document["accessors"][0]["bufferView"] = 999.into()),
        ("buffer view that is not there", |document| {
            document["bufferViews"][0]["byteOffset"] = u64::MAX.into();
        }),
        ("there is no accessor", |document| document["meshes"][0]["primitives"][0]["indices"] = 999.into()),
        ("an index names vertex", |document| document["accessors"][0]["count"] = 3.into()),
        ("in the scene twice", |document| document["nodes"][0]["children"] = json!([0])),
        ("no node 99", |document| document["nodes"][0]["children"] = json!([99])),
        ("no mesh 99", |document| document["nodes"][0]["mesh"] = 99.into()),
        ("is not there", |document| document["buffers"][0]["uri"] = "a%20b.bin".into()),
        ("no base64", |document| document["buffers"][0]["uri"] = "data:;base64,?".into()),
    ] {
        let said = edited(edit);
        assert!(said.contains(expected), "{expected}: {said}");
    }
}

const USDA: &str = include_str!("model/season.usda");

#[test]
fn usd_has_units_axes_variants_and_networks_of_shaders() {
    let asset = read("a.usda", USDA.as_bytes(), &no_files(), &Quiet).unwrap();
    let geometry = asset.meshes[0].geometry.as_ref().unwrap();
    // A square is two triangles; a corner is a vertex of its own where its texture coordinates are others.
    assert_eq!((asset.meshes.len(), asset.meshes[0].triangles, geometry.positions.len()), (1, 3, 5));
    assert_eq!(
        (asset.materials[0].alpha, asset.materials[0].color.map(|used| used.texture)),
        (Some(Alpha::Blend), Some(0))
    );
    assert_eq!(asset.textures[0].problem.as_deref(), Some("it is not there"));
    assert!(asset.unseen.iter().any(|unseen| unseen.why.contains("variants")), "{:?}", asset.unseen);
    let report = lint(&asset, &Config::default());
    // Centimetres with Z up: 2 m high, from 1 m on.
    assert!((report.numbers.height_m.unwrap() - 2.0).abs() < 1e-5);
    let pivot = report.findings.iter().find(|finding| finding.rule == "pivot").unwrap();
    assert!((pivot.measured.unwrap() - 50.0).abs() < 1e-3, "{pivot:?}");
    assert!(report.findings.iter().any(|finding| finding.rule == "alpha-blend"));
    let cut = USDA.replace(
        "float inputs:opacity.connect",
        "float inputs:opacityThreshold = 0.5\n float inputs:opacity.connect",
    );
    assert_eq!(
        read("a.usda", cut.as_bytes(), &no_files(), &Quiet).unwrap().materials[0].alpha,
        Some(Alpha::Mask)
    );
}

#[test]
fn usd_that_is_broken_is_an_error() {
    let said = |bytes: &[u8]| read("a.usdz", bytes, &NoFiles, &Quiet).unwrap_err().to_string();
    assert!(said(b"PK\x03\x04").contains("empty"));
    assert!(
        said(&[b"#usda 1.0\n".as_slice(), &b"def \"a\" {\n".repeat(100_000)].concat()).contains("deeper")
    );
    assert!(said(&[b"#usda 1.0\n(\n".as_slice(), &b"[".repeat(100_000)].concat()).contains("deeper"));
    assert!(said(b"#usda 1.0\ndef Mesh \"a\" { int[] faceVertexIndices = [0, 1, 9] }").contains("not there"));
    assert!(said(b"#usda 1.0\ndef {").starts_with("USD: "));
}

/// A small file may name the same numbers as often as it likes.
#[test]
fn what_is_named_again_and_again_stays_within_memory() {
    let mut model = Model::clean();
    model.pictures = vec![[8, 8], [8, 8]];
    model.edit = |document| {
        let mesh = document["meshes"][1].clone();
        document["meshes"] = json!(vec![mesh; 3000]);
    };
    assert!(matches!(read("a.gltf", &model.gltf(), &NoFiles, &Poor), Err(ReadError::Memory(_))));
    model.edit = |document| {
        let places = document["accessors"].as_array().unwrap().len();
        let accessor =
            json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000_u32, "sparse": {}});
        document["accessors"].as_array_mut().unwrap().push(accessor);
        document["nodes"][1]["extensions"] =
            json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    };
    let said = read("a.gltf", &model.gltf(), &NoFiles, &Quiet).unwrap_err().to_string();
    assert!(said.contains("2000000 places"), "{said}");
}

/// Allows few bytes.
struct Poor;

impl Monitor for Poor {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        1 << 22
    }
}

/// Bytes that were changed, cut and doubled end in an asset or in an error, and within memory.
#[test]
fn changed_bytes_are_never_a_panic() {
    let mut state = 1_u32;
    let mut number = move |below: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % below
    };
    let model = Model { pictures: vec![[8, 8], [8, 8]], ..Model::clean() };
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2\n";
    let files =
        [("a.gltf", model.gltf()), ("a.obj", OBJ.into()), ("a.ply", ply.into()), ("a.usda", USDA.into())];
    let (mut read_well, mut refused) = (0, 0);
    for (name, whole) in &files {
        for round in 0..1500 {
            let mut bytes = whole.clone();
            for _ in 0..=number(4) {
                let at = number(bytes.len());
                match number(4) {
                    0 => bytes[at] = number(256) as u8,
                    1 => bytes[at] = b"0123456789-.eE\"[]{}:,/ \n"[number(24)],
                    2 if round % 3 == 0 => bytes.truncate(at.max(1)),
                    _ => {
                        let end = (at + number(20)).min(bytes.len());
                        let piece = bytes[at..end].to_vec();
                        let to = number(bytes.len());
                        bytes.splice(to..to, piece);
                    }
                }
            }
            match read(name, &bytes, &no_files(), &Poor) {
                Ok(asset) => {
                    lint(&asset, &Config::default());
                    read_well += 1;
                }
                Err(ReadError::Cancelled(_)) => unreachable!("nobody cancels"),
                Err(_) => refused += 1,
            }
        }
    }
    assert!(read_well > 300 && refused > 300, "{read_well} {refused}");
}

#[test]
fn a_layer_over_others_is_its_payload() {
    let shell = |head: &str, within: &str| {
        format!("#usda 1.0\n(\n    metersPerUnit = 1\n)\ndef Xform \"oak\" (\n{head})\n{{\n{within}}}\n")
    };
    let mut files = no_files();
    files.0.insert("./sub/a.usda", USDA.into());
    files.0.insert("./sub/./b.usda", USDA.into());
    let one = shell("    prepend payload = @./b.usda@\n", "");
    files.0.insert("./sub/c.usda", one.into());
    let look = |text: &str| read("a.usda", text.as_bytes(), &files, &Quiet);
    let whole = read("a.usda", USDA.as_bytes(), &no_files(), &Quiet).unwrap();
    // A payload of a payload is looked for in the folder of the file that names it.
    for file in ["./sub/a.usda", "./sub/c.usda"] {
        let asset = look(&shell(&format!("    prepend payload = @{file}@\n"), "")).unwrap();
        assert_eq!(asset.meshes[0].triangles, whole.meshes[0].triangles, "{file}");
        assert!(asset.unseen.iter().all(|unseen| !unseen.why.contains("payload")), "{:?}", asset.unseen);
    }
    let said = |head: &str, within: &str| look(&shell(head, within)).unwrap_err();
    let none = said("    prepend payload = @./none.usda@\n", "");
    assert!(matches!(none, ReadError::Elsewhere { .. }));
    assert!(none.to_string().contains("its payload ./none.usda, which is not there"), "{none}");
    let moved = "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    let moved = said("    prepend payload = @./sub/a.usda@\n", moved).to_string();
    assert!(moved.contains("which it moves"), "{moved}");
    let two = said("    prepend payload = [@./sub/a.usda@, @./sub/b.usda@]\n", "").to_string();
    assert!(two.contains("and in others"), "{two}");
}
