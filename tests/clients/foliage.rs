//! Leaves in every format, before every client and read back.

use std::sync::Arc;

use linden::Quiet;
use linden::dress::dress;
use linden::grow::{Grown, grow};
use linden::picture::Picture;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden::scene::{Scene, Wrap};
use linden_exporters::{Estimate, Options, REGISTRY};
use linden_tests::fixtures::export;

use crate::outside::{exported, run};

/// A branch with outlines of three kinds and every organ, in four colours of which three are given.
pub fn scene() -> (Recipe, Grown, Scene) {
    let mut preset = builtin("abop-a").unwrap().load().unwrap();
    "Leafy".clone_into(&mut preset.name);
    let lsystem = preset.settings_mut::<linden::preset::LSystem>().unwrap();
    let rules = [
        "A -> FF[&+FEA]/////[&-F'~LA]///////F~NA",
        "E -> [^^{-f+f+f-|-f+f+f}''~K'~B{[++G.][+G.][G.][-G.]}{f++++++++f----f}]",
    ];
    lsystem.grammar = linden::lsystem::Grammar::new("A", &rules).unwrap();
    (lsystem.derivations, lsystem.angle_deg) = (5, 22.5);
    preset.set("leaf_colors", "#406020 #708030 #d04060").unwrap();
    let recipe = Recipe::new(preset);
    let grown = grow(&recipe, &Quiet).unwrap();
    let scene = dress(&recipe, &grown, &Quiet).unwrap();
    (recipe, grown, scene)
}

#[test]
fn every_client_takes_leaves() {
    let dir = exported("clients-foliage");
    let (_, _, scene) = scene();
    for exporter in REGISTRY {
        let format = exporter.format();
        let name = match format.extensions.first() {
            Some(ending) => format!("leafy.{ending}"),
            None => "leafy_skeleton.ply".to_owned(),
        };
        export(&scene, format.id, &[], &dir.join(name)).unwrap();
    }
    run("check.py", &dir);
}

#[test]
fn every_client_takes_bark_of_ones_own() {
    let dir = exported("clients-own-bark");
    let stripes = |width: u32, height: u32| {
        let pixels = (0..width * height)
            .flat_map(|i| if i % width < 3 { [70, 50, 40, 255] } else { [150, 130, 110, 255] });
        Picture::new(width, height, pixels.collect()).png().unwrap().to_vec()
    };
    // Twice as high as wide, its normals drawn or in another size.
    for (stem, normal) in [("lightness", None), ("normal", Some(stripes(32, 64)))] {
        let preset = builtin("dressed-simple").unwrap().load().unwrap();
        let mut recipe = Recipe::new(preset);
        // The bark is the user's, as large as that is.
        for (knob, value) in [("triangles", "6000"), ("leaf_size", "64"), ("card_size", "128")] {
            recipe.preset.set(knob, value).unwrap();
        }
        let files = [("bark_picture", Some(stripes(16, 32))), ("bark_normal", normal)];
        for (key, png) in files.into_iter().filter_map(|(key, png)| Some((key, png?))) {
            let file = format!("{key}.png");
            let input = linden::recipe::Input::read(&file, &png, &Quiet).unwrap();
            assert!(recipe.put_file(key, &file, &input));
        }
        let grown = grow(&recipe, &Quiet).unwrap();
        let levels = linden::dress::levels(&recipe, &grown, &Quiet).unwrap();
        for exporter in REGISTRY {
            let format = exporter.format();
            let ending = format.extensions.first().map_or("_skeleton.ply".to_owned(), |e| format!(".{e}"));
            export(&levels.levels[0].scene, format.id, &[], &dir.join(format!("{stem}{ending}"))).unwrap();
        }
    }
    run("check.py", &dir);
}

/// The leafy branch with a disc cut out of the first colour's leaves.
fn cut_out() -> Scene {
    let (_, _, mut scene) = scene();
    "Cut out".clone_into(&mut scene.name);
    let disc = (0..64 * 64_i32).flat_map(|i| {
        let (x, y) = (i % 64 - 32, i / 64 - 32);
        [90, 140, 40, if x * x + y * y < 900 { 255 } else { 0 }]
    });
    scene.materials[1].base_color_picture = Some(Arc::new(Picture::new(64, 64, disc.collect())));
    scene.materials[1].cutout = Some(0.5);
    scene
}

#[test]
fn every_client_takes_cut_out_leaves_and_is_told_where_they_end() {
    let dir = exported("clients-cut-out");
    let scene = cut_out();
    assert_eq!(scene.materials[1].wrap, Wrap::Clamp);
    for exporter in REGISTRY {
        let format = exporter.format();
        let name =
            format.extensions.first().map_or("cut_out_skeleton.ply".to_owned(), |e| format!("cut_out.{e}"));
        export(&scene, format.id, &[], &dir.join(name)).unwrap();
    }
    run("check.py", &dir);

    let (document, _, images) = gltf::import(dir.join("cut_out.glb")).unwrap();
    let leaves = document.materials().nth(1).unwrap();
    assert_eq!((leaves.alpha_mode(), leaves.alpha_cutoff()), (gltf::material::AlphaMode::Mask, Some(0.5)));
    let bark = document.materials().next().unwrap();
    assert_eq!(bark.alpha_mode(), gltf::material::AlphaMode::Opaque);
    let wrap = |material: &gltf::Material<'_>| {
        let texture = material.pbr_metallic_roughness().base_color_texture().unwrap().texture();
        (texture.sampler().wrap_s(), images[texture.source().index()].format)
    };
    assert_eq!(wrap(&leaves), (gltf::texture::WrappingMode::ClampToEdge, gltf::image::Format::R8G8B8A8));
    assert_eq!(wrap(&bark), (gltf::texture::WrappingMode::Repeat, gltf::image::Format::R8G8B8));

    let (_, materials) = tobj::load_obj(dir.join("cut_out.obj"), &tobj::GPU_LOAD_OPTIONS).unwrap();
    let file = materials.unwrap()[1].dissolve_texture.clone().unwrap();
    let mut mask = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(dir.join(&file)).unwrap()))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; mask.output_buffer_size().unwrap()];
    mask.next_frame(&mut pixels).unwrap();
    // A disc of radius 30 of 64, in every channel: that of all colours, and the alpha.
    assert_eq!(mask.info().color_type, png::ColorType::GrayscaleAlpha);
    let count = |wanted: [u8; 2]| pixels.as_chunks().0.iter().filter(|pixel| **pixel == wanted).count();
    assert!(count([255; 2]).abs_diff(2827) < 60 && count([255; 2]) + count([0; 2]) == 4096);

    let text = std::fs::read_to_string(dir.join("cut_out.usda")).unwrap();
    for said in [
        "inputs:opacity.connect = <",
        "inputs:opacityThreshold = 0.5",
        "wrapS = \"clamp\"",
        "float outputs:a",
    ] {
        assert!(text.contains(said), "{said}");
    }
}

#[test]
fn each_colour_is_a_double_sided_part_of_its_own() {
    let (_, grown, scene) = scene();
    let names: Vec<&str> = scene.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["wood", "leaves", "leaves_1", "leaves_2"]);
    for part in &scene.parts[1..] {
        let material = &scene.materials[part.material];
        assert_eq!(material.name, part.name);
        assert!(material.double_sided && material.base_color_picture.is_none());
    }
    assert!(grown.organs.len() > 100);
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("leafy.glb");
    export(&scene, "glb", &[], &target).unwrap();
    let (document, buffers, _) = gltf::import(&target).unwrap();
    let sides: Vec<bool> = document.materials().map(|material| material.double_sided()).collect();
    assert_eq!(sides, [false, true, true, true]);
    for (mesh, part) in document.meshes().zip(&scene.parts) {
        let name = format!("{}_{}", linden_exporters::writing::identifier(&scene.name), part.name);
        assert_eq!(mesh.name(), Some(name.as_str()));
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        assert_eq!(reader.read_positions().unwrap().count(), part.mesh.positions.len());
    }
    let target = dir.path().join("leafy.usda");
    export(&scene, "usda", &[], &target).unwrap();
    let text = std::fs::read_to_string(&target).unwrap();
    assert_eq!(text.matches("uniform bool doubleSided = 1").count(), 3);
}

#[test]
fn estimates_know_of_leaves() {
    let (recipe, grown, scene) = scene();
    let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
    let near = |what: &str, estimated: u64, real: u64| {
        let ratio = estimated as f64 / real as f64;
        assert!((0.7..1.3).contains(&ratio), "{what}: {estimated} of {real}");
    };
    let count = |of: fn(&linden::scene::Mesh) -> usize| {
        scene.parts.iter().map(|part| of(&part.mesh) as u64).sum::<u64>()
    };
    near("triangles", estimate.triangles, count(|mesh| mesh.triangles.len()));
    near("vertices", estimate.vertices, count(|mesh| mesh.positions.len()));
    let dir = tempfile::tempdir().unwrap();
    for exporter in REGISTRY {
        let format = exporter.format();
        let written = export(&scene, format.id, &[], &dir.path().join("leafy.any")).unwrap();
        let real = written.iter().map(|file| file.bytes).sum();
        near(format.id, estimate.bytes(format, &Options::new(format)).unwrap(), real);
    }
}
