//! What was asked for and changes nothing is named on standard error; pictures show what was asked for.

use crate::program::{Folder, Said};

fn notes(said: &Said) -> Vec<String> {
    said.err.lines().filter_map(|line| line.strip_prefix("note: ")).map(str::to_owned).collect()
}

/// With small pictures, where there are any.
fn run(folder: &Folder, args: &[&str]) -> Said {
    let leaves: &[&str] = if args[1].starts_with("dressed") { &["--set", "leaf_size=32"] } else { &[] };
    folder.run(&[args, &["--set", "bark_size=32"], leaves].concat())
}

/// Done, whatever was noted.
fn fine(said: Said) -> Said {
    assert_eq!(said.code, Some(0), "{}", said.err);
    said
}

#[test]
fn a_knob_that_changes_nothing_is_named_with_what_it_waits_for() {
    let folder = Folder::new();
    for (args, note) in [
        (
            &["stats", "abop-a", "--set", "segment_width=0.2"][..],
            "segment_width changes nothing: the grammar has no !; with width=grammar all its wood has this width",
        ),
        (&["stats", "abop-a", "--set", "stems=3"], "stems changes nothing: it is for habit=shrub"),
        (
            &["export", "simple", "-o", "x.glb", "--lod-ratio", "0.5"],
            "lod_ratio changes nothing: there is one level",
        ),
        (
            &["export", "simple", "-o", "x.ply", "--wind=sway"],
            "ply holds no wind: wind is left out; gltf, glb, usda, usdc, usdz and html hold it",
        ),
        (
            &["export", "simple", "-o", "x.csv", "--lods", "3"],
            "qsm holds the skeleton alone: bark_size and lods change nothing in it",
        ),
        (
            &["export", "simple", "-o", "x.csv", "--scene", "--set", "flare=1"],
            "qsm holds the skeleton alone: flare, bark_size and scene change nothing in it",
        ),
        (
            &["export", "dressed-simple", "-o", "x.organs.csv", "--scene", "--set", "leaf_normals=dome"],
            "organs holds no surface: bark_size, leaf_normals and scene change nothing in it",
        ),
        (
            &["export", "simple", "-o", "x.organs.csv"],
            "organs: nothing grows on the wood, so that the table is its header alone",
        ),
        (
            &["export", "simple", "-o", "x.obj", "--scene"],
            "obj holds no camera, sun, sky and ground: scene is left out",
        ),
        (
            &["export", "simple", "-o", "x.glb", "--instances"],
            "instances: nothing on this plant stands in many places",
        ),
        (
            &["export", "simple", "-o", "x.glb", "--quantize", "--wind=sway"],
            "quantize is left out: the sway loop",
        ),
        (
            &[
                "export",
                "simple",
                "-o",
                "x.glb",
                "--wind",
                "--set",
                "glb.wind_as=packed",
                "--set",
                "glb.lightmap_uv=true",
            ],
            "lightmap_uv is left out: wind_as=packed has TEXCOORD_1",
        ),
        (
            &[
                "export",
                "simple",
                "-o",
                "x.usda",
                "--set",
                "points=60",
                "--set",
                "junction_detail=16",
                "--set",
                "junction=watertight",
                "--set",
                "usda.lightmap_uv=true",
            ],
            "lightmap_uv: ",
        ),
    ] {
        let said = fine(run(&folder, args));
        assert!(notes(&said).iter().any(|line| line.starts_with(note)), "{args:?}: {}", said.err);
    }
    let said = fine(run(
        &folder,
        &["stats", "abop-a", "--set", "segment_width=0.2", "--set", "width=grammar", "--json"],
    ));
    assert_eq!(notes(&said), [""; 0]);
    let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert!((json["trunk_diameter_m"].as_f64().unwrap() - 0.2).abs() < 1e-6, "{}", said.out);
}

#[test]
fn what_a_nanite_assembly_leaves_out_is_said() {
    let folder = Folder::new();
    for (args, note) in [
        (
            &["export", "simple", "-o", "x.usda", "--wind=bones", "--set", "usda.nanite=static"][..],
            "nanite=static: wind is left out",
        ),
        (
            &["export", "simple", "-o", "x.usda", "--lods", "2", "--set", "usda.nanite=static"],
            "nanite: the finest level alone",
        ),
        (
            &[
                "export",
                "simple",
                "-o",
                "x.usda",
                "--set",
                "usda.nanite=static",
                "--set",
                "usda.collision=hull",
            ],
            "collision is left out: a Nanite assembly",
        ),
        (
            &["export", "simple", "-o", "x.usda", "--set", "usda.nanite=skeletal"],
            "nanite=skeletal: there are no joints, and it is written as nanite=static; add --wind=bones",
        ),
    ] {
        let said = fine(run(&folder, args));
        assert!(notes(&said).iter().any(|line| line.starts_with(note)), "{args:?}: {}", said.err);
    }
}

/// The JSON of a GLB.
fn document(folder: &Folder, name: &str) -> serde_json::Value {
    let bytes = folder.read(name);
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// What plays by itself is shown by programs that would tint it by the bytes for shaders.
#[test]
fn a_profile_packs_the_wind_of_shaders_alone() {
    let folder = Folder::new();
    let attributes = |name: &str, flags: &[&str]| {
        let export = ["export", "dressed-simple", "-o", name, "--set", "points=60"];
        fine(run(&folder, &[&export[..], flags].concat()));
        document(&folder, name)["meshes"][0]["primitives"][0]["attributes"].clone()
    };
    for program in ["godot", "unity", "unreal"] {
        let shader = attributes("shader.glb", &["--wind", "--for", program]);
        assert!(shader["COLOR_0"].is_u64() && shader["_WIND"].is_null(), "{program}: {shader}");
        let loops = attributes("loop.glb", &["--wind=sway", "--for", program]);
        assert!(loops["COLOR_0"].is_null() && loops["_WIND"].is_u64(), "{program}: {loops}");
    }
    let asked = attributes("asked.glb", &["--wind=sway", "--for", "godot", "--set", "glb.wind_as=packed"]);
    assert!(asked["COLOR_0"].is_u64(), "{asked}");
}

#[test]
fn bare_wind_is_the_attributes_and_can_be_quantized() {
    let folder = Folder::new();
    let tree = ["--set", "points=60"];
    for (name, flags) in [
        ("bare.glb", &["--wind"][..]),
        ("said.glb", &["--wind=attributes"]),
        ("packed.glb", &["--wind", "--quantize"]),
        ("sway.glb", &["--wind=sway"]),
    ] {
        let said =
            fine(run(&folder, &[&["export", "dressed-simple", "-o", name][..], flags, &tree].concat()));
        assert_eq!(notes(&said), [""; 0], "{name}");
    }
    let [bare, said, packed, sway] =
        ["bare.glb", "said.glb", "packed.glb", "sway.glb"].map(|name| document(&folder, name));
    assert_eq!(bare, said);
    let primitive =
        |document: &serde_json::Value, mesh: usize| document["meshes"][mesh]["primitives"][0].clone();
    for document in [&bare, &packed] {
        assert!(document.get("animations").is_none());
        assert!(primitive(document, 0).get("targets").is_none());
        assert!(primitive(document, 0)["attributes"]["_WIND"].is_u64());
    }
    assert!(packed["extensionsRequired"].to_string().contains("KHR_mesh_quantization"));
    // Wood has no targets for the motions of leaves, and none is without a buffer.
    let targets = |mesh: usize| primitive(&sway, mesh)["targets"].as_array().unwrap().clone();
    assert_eq!((targets(0).len(), targets(1).len()), (4, 6));
    for target in targets(0).iter().chain(&targets(1)) {
        let accessor = &sway["accessors"][target["POSITION"].as_u64().unwrap() as usize];
        assert!(accessor["bufferView"].is_u64(), "{accessor}");
    }
    // As many weights as targets, at each time.
    for channel in sway["animations"][0]["channels"].as_array().unwrap() {
        let sampler = &sway["animations"][0]["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        let count =
            |key: &str| sway["accessors"][sampler[key].as_u64().unwrap() as usize]["count"].as_u64().unwrap();
        let mesh =
            sway["nodes"][channel["target"]["node"].as_u64().unwrap() as usize]["mesh"].as_u64().unwrap();
        assert_eq!(count("output"), count("input") * targets(mesh as usize).len() as u64);
    }
}

#[test]
fn levels_have_the_budgets_that_are_listed() {
    let folder = Folder::new();
    let triangles = |name: &str| {
        let text = String::from_utf8(folder.read(name)).unwrap();
        text.lines().filter(|line| line.starts_with("f ")).count()
    };
    fine(run(&folder, &["export", "dressed-simple", "-o", "t.obj", "--lods", "9000,4000,1500"]));
    for (level, budget) in [9000, 4000, 1500].into_iter().enumerate() {
        let found = triangles(&format!("t_LOD{level}.obj"));
        assert!(found.abs_diff(budget) <= budget / 20, "{level}: {found}");
    }
    folder.write(
        "t.toml",
        "id = \"t\"\n[colonization]\ncrown = \"sphere\"\npoints = 100\n[detail]\nlod_triangles = [3000, 1000]\n",
    );
    fine(run(&folder, &["export", "t.toml", "-o", "d.obj"]));
    assert!(triangles("d_LOD0.obj").abs_diff(3000) <= 150 && triangles("d_LOD1.obj").abs_diff(1000) <= 50);
    let said = run(&folder, &["export", "t.toml", "-o", "e.obj", "--lods", "1000,3000"]);
    assert!(said.code == Some(2) && said.err.contains("3000 triangles follow 1000"), "{}", said.err);
    let said = run(&folder, &["export", "t.toml", "-o", "e.obj", "--lods", "1000,3"]);
    assert!(said.err.contains("triangles=3 is less than"), "{}", said.err);
}

#[test]
fn seasons_have_names_wherever_the_knob_is() {
    let folder = Folder::new();
    let recipe = |args: &[&str]| {
        let said = fine(folder.run(&[&["show", "dressed-simple", "--toml"], args].concat()));
        said.out
    };
    assert_eq!(recipe(&["--set", "season=autumn"]), recipe(&["--set", "season=0.75"]));
    folder.write("t.toml", "id = \"t\"\n[colonization]\ncrown = \"sphere\"\n[foliage]\nseason = \"bare\"\n");
    let said = fine(folder.run(&["show", "t.toml", "--toml"]));
    assert!(said.out.contains("season = 1.0"), "{}", said.out);
    let said = folder.run(&["show", "dressed-simple", "--set", "season=sumer"]);
    assert!(
        said.err.contains(
            "0 to 1, or flush | summer | autumn | bare | spring | fall | winter (did you mean 'summer'?)"
        ),
        "{}",
        said.err
    );
    let said = folder.run(&["show", "magnolia", "--set", "season=bloom"]);
    assert!(said.err.contains("blossom is there from 0 to 0.13, as at 0.07"), "{}", said.err);
    let said = folder.run(&["show", "magnolia", "--set", "leafs=2"]);
    assert!(said.err.contains("alike are leaf_") && said.err.contains(" more)"), "{}", said.err);
}

/// From a heavy level to two planes is a jump that is seen.
#[test]
fn a_billboard_behind_a_heavy_level_is_told() {
    let folder = Folder::new();
    for (triangles, is_told) in [("6000", true), ("3000", false)] {
        let args = ["--triangles", triangles, "--billboard", "--set", "bark_size=16", "-o", "t.glb"];
        let said = fine(
            folder.run(&[&["export", "dressed-simple", "--set", "billboard_size=64"], &args[..]].concat()),
        );
        assert_eq!(
            said.err.contains("budgets make levels between, like --lods"),
            is_told,
            "{triangles}: {}",
            said.err
        );
    }
}

#[test]
fn previews_show_budgets_and_levels() {
    let folder = Folder::new();
    let draw = |name: &str, args: &[&str]| {
        let all = [&["preview", "simple", "--size", "120x150", "-o", name, "--look", "surface"][..], args];
        fine(run(&folder, &all.concat()));
        // The recipe before the pixels says what was asked for.
        let png = folder.read(name);
        let pixels = png.windows(4).position(|chunk| chunk == b"IDAT").unwrap();
        png[pixels..].to_vec()
    };
    let full = draw("full.png", &[]);
    let budget = draw("budget.png", &["--triangles", "1500"]);
    assert_ne!(full, budget);
    let lods = ["--set", "lod_triangles=3000 1500", "--lod"];
    assert_eq!(draw("one.png", &[&lods[..], &["1"]].concat()), budget, "level 1 is the tree of that budget");
    assert_ne!(draw("nought.png", &[&lods[..], &["0"]].concat()), budget);
    let said = run(&folder, &["preview", "simple", "-o", "x.png", "--lod", "3"]);
    assert!(
        said.err.contains("--lod 3: this tree has one level of detail, 0; ask for more, like --set lods=4"),
        "{}",
        said.err
    );
    let said = run(&folder, &["preview", "simple", "-o", "x.png", "--lod", "0", "--points"]);
    assert!(said.err.contains("--lod is a level of the surface"), "{}", said.err);
    let said = fine(run(
        &folder,
        &["preview", "simple", "-o", "x.png", "--look", "skeleton", "--set", "triangles=1500"],
    ));
    assert!(
        notes(&said).iter().any(|note| note.starts_with("triangles changes nothing in a skeleton")),
        "{}",
        said.err
    );
}

#[test]
fn a_sheet_of_levels_has_a_tree_in_each_row() {
    let folder = Folder::new();
    let size = |name: &str| {
        let bytes = folder.read(name);
        [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
    };
    let sheet = |name: &str, args: &[&str]| {
        let all = [
            &["sheet", "simple", "--seeds", "2", "--size", "40x50", "--labels", "none", "-o", name][..],
            args,
        ];
        fine(run(&folder, &all.concat()));
        size(name)
    };
    assert_eq!(sheet("a.png", &["--lods", "3"]), [120, 100]);
    assert_eq!(sheet("b.png", &["--lods"]), [160, 100]);
    assert_eq!(sheet("c.png", &["--lods=4000,1500"]), [80, 100]);
}

#[test]
fn what_pivots_in_pictures_cannot_hold_is_said() {
    let folder = Folder::new();
    let pivots = "glb.wind_as=pivot-painter";
    for (args, part) in [
        (
            &["simple", "-o", "x.glb", "--wind", "--set", "glb.lightmap_uv=true"][..],
            "lightmap_uv is left out: wind_as=pivot-painter has TEXCOORD_1",
        ),
        (&["beech", "--triangles=3000", "-o", "x.glb", "--wind"], "reach beyond 20.48 m"),
        (&["simple", "-o", "x.glb"], "wind_as changes nothing: nothing moves"),
        (&["simple", "-o", "-", "--format", "glb", "--wind"], "a single stream has no pictures beside it"),
    ] {
        let said = folder.run(&[&["export"], args, &["--set", pivots]].concat());
        assert!(said.code == Some(0) && said.err.contains(part), "{args:?}: {}", said.err);
    }
}

#[test]
fn an_obstacle_that_nothing_meets_is_named() {
    let folder = Folder::new();
    let noted = |at: &str| {
        let part = format!(
            "role = \"obstacle\"\ncrown = \"cylinder\"\ncrown_height = 3\ncrown_radius = 1\nat = {at}\n"
        );
        let crown = "id = \"w\"\n[colonization]\ncrown = \"dome\"\ncrown_radius = 4\npoints = 200\n";
        folder.write("w.toml", format!("{crown}[[colonization.part]]\n{part}"));
        notes(&fine(run(&folder, &["stats", "w.toml"])))
    };
    assert!(noted("[3, 0, 0]").iter().all(|note| !note.contains("obstacle")), "within the crown");
    // By centimetres that are taken for metres: its near side is 295 m beyond the crown.
    let far = noted("[300, 0, 0]");
    assert!(far.iter().any(|note| note.contains("part 1: this obstacle is 295.")), "{far:?}");
}

/// Cards of twigs bear many leaves each, so that as many places bear few leaves of another form.
#[test]
fn leaves_of_another_form_than_twigs_are_fewer_and_it_is_said() {
    let folder = Folder::new();
    folder.write(
        "twigs.toml",
        "id = \"twigs\"\nname = \"T\"\ngroup = \"mine\"\nsummary = \"s\"\nsource = \"s\"\n\n[lsystem]\n\
         axiom = \"F\"\nrules = [\"F -> F[+F]F\"]\nderivations = 2\nangle = 25\n\n[foliage]\nleaf_form = \"twig\"\ntwig_leaves = 11\nleaves_per_m = 4\n",
    );
    let said = |settings: &[&str]| {
        let args: Vec<&str> = settings.iter().flat_map(|set| ["--set", set]).collect();
        fine(folder.run(&[&["stats", "twigs.toml"][..], &args].concat())).err
    };
    let note = "note: leaves_per_m=4 counted twigs of 11 leaves and counts leaves now; leaves_per_m=44 gives as many \
                leaves as before\n";
    assert_eq!(said(&["leaf_form=curved"]), note);
    for settings in [&["leaf_form=curved", "leaves_per_m=44"][..], &["leaf_form=none"], &["twig_leaves=5"]] {
        assert!(!said(settings).contains("counted"), "{settings:?}");
    }
}
