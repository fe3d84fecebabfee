//! Whatever a target is called, the files beside it are found; and what happens without any beside.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};

use linden::stage::Stage;
use linden_exporters::{Bundle, Options, REGISTRY};
use linden_tests::fixtures::{export, scene};

const STRANGE: [&str; 8] = [
    "two words",
    "number #1",
    "at @home",
    "it's \"quoted\"",
    "Ölbaum 松",
    "100% <UDIM>",
    "back\\slash",
    "line\nbreak",
];

#[test]
fn side_files_of_strangely_named_targets_are_found() {
    let dir = tempfile::tempdir().unwrap();
    let scene = scene(3, 5);
    for stem in STRANGE {
        let target = dir.path().join(format!("{stem}.obj"));
        export(&scene, "obj", &[], &target).unwrap();
        let (_, materials) = tobj::load_obj(&target, &tobj::LoadOptions::default()).unwrap();
        let picture = materials.unwrap()[0].diffuse_texture.clone().unwrap();
        assert!(dir.path().join(&picture).is_file(), "{picture}");
        assert!(!picture.contains(char::is_whitespace), "{picture}");

        let target = dir.path().join(format!("{stem}.gltf"));
        export(&scene, "gltf", &[], &target).unwrap();
        gltf::import(&target).unwrap();

        let target = dir.path().join(format!("{stem}.usda"));
        export(&scene, "usda", &[], &target).unwrap();
        let text = fs::read_to_string(&target).unwrap();
        let assets: Vec<_> = text.split('@').skip(1).step_by(2).collect();
        assert_eq!(assets.len(), 2);
        for asset in assets {
            assert!(asset.starts_with("./") && dir.path().join(asset).is_file(), "{asset}");
        }
    }
}

#[derive(Clone, Default)]
struct Output(Arc<Mutex<Vec<u8>>>);

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_single_stream_holds_a_whole_file_that_names_no_other() {
    let dir = tempfile::tempdir().unwrap();
    for exporter in REGISTRY {
        let format = exporter.format();
        let output = Output::default();
        let mut bundle = Bundle::stream("standard output", output.clone());
        exporter.write(&Stage::of(&scene(3, 5)), &Options::new(format), &mut bundle, &linden::Quiet).unwrap();
        // Everything is there, or the user is told what is not.
        // Nothing grows on this tree.
        let is_whole = format.self_contained && format.holds.recipe && format.id != "organs";
        assert_eq!(is_whole, bundle.notes().is_empty(), "{}", format.id);
        let file = dir.path().join(format!("alone.{}", format.id));
        fs::write(&file, &*output.0.lock().unwrap()).unwrap();
        match format.id {
            "gltf" | "glb" => assert_eq!(gltf::import(&file).unwrap().2.len(), 2),
            "obj" => {
                let (models, materials) = tobj::load_obj(&file, &tobj::LoadOptions::default()).unwrap();
                assert_eq!((models.len(), materials.unwrap().len()), (2, 0));
            }
            "usda" => {
                let text = fs::read_to_string(&file).unwrap();
                assert!(!text.contains('@') && text.contains("inputs:diffuseColor = (0.2, 0.12, 0.07)"));
            }
            "usdc" => assert!(fs::read(&file).unwrap().starts_with(b"PXR-USDC")),
            "usdz" | "3mf" => assert!(fs::read(&file).unwrap().starts_with(b"PK\x03\x04")),
            "html" => assert!(fs::read(&file).unwrap().to_ascii_lowercase().starts_with(b"<!doctype html>")),
            "stl" => {
                let bytes = fs::read(&file).unwrap();
                let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap());
                assert_eq!(bytes.len(), 84 + 50 * count as usize);
            }
            "qsm" => assert!(fs::read_to_string(&file).unwrap().contains("\nid,parent,branch,")),
            "organs" => assert!(fs::read_to_string(&file).unwrap().contains("\nid,node,kind,")),
            "mat" => assert!(fs::read(&file).unwrap().starts_with(b"MATLAB 5.0 MAT-file, ")),
            "mtg" => assert!(fs::read_to_string(&file).unwrap().contains("\nMTG:\nENTITY-CODE")),
            _ => assert!(fs::read(&file).unwrap().starts_with(b"ply\n")),
        }
    }
}

#[test]
fn the_formats_of_one_tree_share_their_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let scene = scene(3, 5);
    let bundles = ["obj", "gltf", "usda"].map(|id| {
        let exporter = linden_exporters::find(id).unwrap();
        let mut bundle = Bundle::create(&dir.path().join(format!("tree.{id}"))).unwrap().unsynced();
        let options = Options::new(exporter.format());
        exporter.write(&Stage::of(&scene), &options, &mut bundle, &linden::Quiet).unwrap();
        bundle
    });
    linden_exporters::commit_all(bundles.into()).unwrap();
    let mut names: Vec<_> =
        fs::read_dir(dir.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let expected = [
        "tree.bin",
        "tree.gltf",
        "tree.mtl",
        "tree.obj",
        "tree.usda",
        "tree_bark.png",
        "tree_bark_normal.png",
    ];
    assert_eq!(names, expected);
    assert!(Path::new(&dir.path().join("tree.obj")).is_file());
}
