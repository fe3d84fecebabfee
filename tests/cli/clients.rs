//! Files for a program: what `--for` sets, what holds against it, and what is said.

use crate::program::Folder;

const SMALL: [&str; 6] = ["export", "fir", "--set", "points=200", "--set", "bark_size=32"];

/// The document of a GLB.
fn document(bytes: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn a_program_gets_its_format_its_levels_and_its_shapes() {
    let folder = Folder::new();
    folder.run(&[&SMALL[..], &["--for", "unreal", "--lods", "2"]].concat()).done();
    let unreal = document(&folder.read("fir.glb"));
    assert!(unreal.get("extensionsRequired").is_none(), "{}", unreal["extensionsRequired"]);
    let names: Vec<&str> =
        unreal["nodes"].as_array().unwrap().iter().map(|node| node["name"].as_str().unwrap()).collect();
    for name in ["Fir_LOD0", "Fir_LOD1", "UCX_fir_wood_00"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    // Whatever else is said holds against it.
    folder
        .run(
            &[
                &SMALL[..],
                &["--for", "unreal", "-o", "plain.glb", "--collision=none", "--set", "glb.quantize=false"],
            ]
            .concat(),
        )
        .done();
    let plain = document(&folder.read("plain.glb"));
    assert!(!plain.to_string().contains("UCX_"));
    folder.run(&[&SMALL[..], &["--for", "omniverse", "--lods", "2"]].concat()).done();
    let usd = String::from_utf8(folder.read("fir.usda")).unwrap();
    assert!(usd.contains("variantSet \"lod\"") && usd.contains("PhysicsCollisionAPI"));
}

#[test]
fn levels_take_a_file_each_where_that_is_asked_for() {
    let folder = Folder::new();
    folder
        .run(&[&SMALL[..], &["-o", "a.glb", "-o", "a.usda", "--lods", "2", "--lods-as", "files"]].concat())
        .done();
    for file in ["a_LOD0.glb", "a_LOD1.glb", "a_LOD0.usda", "a_LOD1.usda"] {
        assert!(!folder.read(file).is_empty(), "{file}");
        folder.run(&["verify", file]).done();
    }
    let said = folder.run(&[&SMALL[..], &["-o", "a.stl", "--lods", "2", "--lods-as", "files"]].concat());
    assert!(said.code == Some(2) && said.err.contains("--lods-as: no output is written"), "{}", said.err);
}

#[test]
fn bodies_stand_in_the_finest_levels_file_alone_and_are_few_enough_for_lint() {
    let folder = Folder::new();
    folder
        .run(&[&SMALL[..], &["--for", "godot", "-o", "g.glb", "--lods", "2", "--billboard"]].concat())
        .done();
    let bodies = |file: &str| {
        let nodes = document(&folder.read(file))["nodes"].as_array().unwrap().clone();
        nodes.iter().filter(|node| node["name"].as_str().unwrap().ends_with("-convcolonly")).count()
    };
    assert!((1..=4).contains(&bodies("g_LOD0.glb")), "{}", bodies("g_LOD0.glb"));
    assert_eq!([bodies("g_LOD1.glb"), bodies("g_LOD2.glb")], [0, 0]);
    folder.run(&["verify", "g_LOD0.glb", "g_LOD1.glb", "g_LOD2.glb"]).done();
    let said = folder.run(&["lint", "g_LOD0.glb"]);
    assert!(!said.out.contains("collider"), "{}", said.out);
}

#[test]
fn what_a_program_does_not_read_is_said() {
    let folder = Folder::new();
    let said = folder.run(&[&SMALL[..], &["--for", "bevy", "-o", "a.glb", "--quantize"]].concat());
    assert_eq!(said.code, Some(0));
    assert!(said.err.contains("glb.quantize=true is not read by Bevy: the file is refused"), "{}", said.err);
    // Of levels also what reads them, and the way out.
    let levels = ["--for", "three", "-o", "b.glb", "--lods", "2", "--lods-as", "msft"];
    let said = folder.run(&[&SMALL[..], &levels].concat()).err;
    for part in
        ["glb.lods=msft is not read by three.js", "(Babylon.js reads it); --lods-as files writes what"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    let said = folder.run(&[&SMALL[..], &["--for", "unty"]].concat());
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("did you mean 'unity'?"), "{}", said.err);
}

/// A profile sets it without being asked, and says nothing.
#[test]
fn ways_to_write_levels_of_one_level_are_told_to_be_in_vain() {
    let folder = Folder::new();
    for way in ["files", "siblings"] {
        let said = folder.run(&[&SMALL[..], &["-o", "a.glb", "-o", "a.gltf", "--lods-as", way]].concat());
        assert_eq!(
            said.err.matches("lods changes nothing: there is one level").count(),
            1,
            "{way}: {}",
            said.err
        );
        assert!(said.err.contains("--lods 3 makes more"), "{}", said.err);
    }
    let none = folder.run(&[&SMALL[..], &["-o", "a.glb", "--for", "three"]].concat());
    assert!(!none.err.contains("lods"), "{}", none.err);
    let two = folder.run(&[&SMALL[..], &["-o", "a.glb", "--lods-as", "files", "--lods", "2"]].concat());
    assert!(!two.err.contains("changes nothing"), "{}", two.err);
}

#[test]
fn show_prints_what_a_program_reads() {
    let folder = Folder::new();
    let page = folder.run(&["show", "--for", "godot"]).out;
    for line in ["glb.collision_as=godot", "compress=meshopt: the file is refused"] {
        assert!(page.contains(line), "{line}: {page}");
    }
    let json = folder.run(&["show", "--for", "print", "--json"]).done().json();
    assert_eq!(json["formats"], serde_json::json!(["3mf", "stl"]));
    let said = folder.run(&["show"]);
    assert_eq!(said.code, Some(2), "without --for it needs a source");
}
