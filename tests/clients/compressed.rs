//! Compressed glTF, decoded by meshoptimizer's own decoder: the bytes of the plain file.

use std::fs;

use linden::stage::{Place, Stage};
use linden_tests::fixtures::{export, export_stage, scene};

use crate::foliage;
use crate::instances::dressed;
use crate::outside::{exported, run};

const ON: (&str, &str) = ("compress", "meshopt");

#[test]
fn compressed_files_decode_to_the_plain_ones() {
    let dir = exported("clients-compressed");
    let (_, _, leafy) = dressed(&[]);
    let (_, _, blown) = dressed(&[("wind", "sway")]);
    // Indices of 32 bits in one part, of 16 in the other.
    let tubes = scene(330, 200);
    let (quantize, instances) = (("quantize", "true"), ("instances", "true"));
    for (name, format, scene, options) in [
        ("tubes", "glb", &tubes, &[][..]),
        ("outlines", "gltf", &foliage::scene().2, &[("pictures", "false")]),
        ("embedded", "gltf", &tubes, &[("embed", "true"), quantize]),
        ("small", "gltf", &leafy, &[quantize]),
        ("instanced", "glb", &leafy, &[instances]),
        ("smallest", "glb", &leafy, &[instances, quantize]),
        ("blown", "glb", &blown, &[]),
    ] {
        let plain = dir.join(format!("{name}.{format}"));
        let packed = dir.join(format!("{name}_packed.{format}"));
        export(scene, format, options, &plain).unwrap();
        let options: Vec<_> = options.iter().copied().chain([ON]).collect();
        export(scene, format, &options, &packed).unwrap();
        if name != "blown" {
            // The same tree as in a format without any of it.
            export(scene, "obj", &[("pictures", "false")], &packed.with_extension("obj")).unwrap();
        }
    }
    let mut wood = Stage::of(&tubes).in_setting();
    wood.places.push(Place { position: glam::Vec3::X * 5.0, turn_rad: 1.0, ..Place::origin(0) });
    export_stage(&wood, "glb", &[quantize, instances], &dir.join("wood.glb")).unwrap();
    export_stage(&wood, "glb", &[quantize, instances, ON], &dir.join("wood_packed.glb")).unwrap();
    run("compressed.py", &dir);
    run("check.py", &dir);
}

#[test]
fn compression_gives_the_same_bytes_on_any_number_of_threads() {
    let tubes = scene(330, 200);
    let dir = tempfile::tempdir().unwrap();
    let with = |threads: usize| {
        let target = dir.path().join(format!("{threads}.glb"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| export(&tubes, "glb", &[ON, ("quantize", "true")], &target).unwrap());
        fs::read(target).unwrap()
    };
    assert!(with(1) == with(2));
}

#[test]
fn what_compression_lacks_memory_for_leaves_nothing_behind() {
    struct Poor(u64);
    impl linden::Monitor for Poor {
        fn is_cancelled(&self) -> bool {
            false
        }
        fn advance(&self, _: linden::monitor::Phase, _: u64, _: Option<u64>) {}
        fn memory_limit(&self) -> u64 {
            self.0
        }
    }
    let tubes = scene(330, 200);
    let stage = Stage::of(&tubes);
    let dir = tempfile::tempdir().unwrap();
    let write = |limit: u64, compress: &str| {
        let exporter = linden_exporters::find("gltf").unwrap();
        let mut options = linden_exporters::Options::new(exporter.format());
        options.set("compress", compress).unwrap();
        let mut bundle = linden_exporters::Bundle::create(&dir.path().join("tree.gltf")).unwrap();
        exporter.write(&stage, &options, &mut bundle, &Poor(limit)).map_err(|error| error.to_string())
    };
    let limit =
        (1..64).map(|i| stage.bytes() + (i << 20)).find(|&limit| write(limit, "none").is_ok()).unwrap();
    let said = write(limit, "meshopt").unwrap_err();
    assert!(said.contains("compressing") && said.contains("without compress"), "{said}");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}
