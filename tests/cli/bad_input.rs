//! Bad input: a clear message, the right code, and nothing written.

use crate::program::{Folder, fixture_picture};

/// Runs `linden export SOURCE -o out.glb` (and more arguments) on bad input and checks what is said.
fn refused(folder: &Folder, code: i32, args: &[&str], says: &[&str]) {
    let before = folder.content();
    let said = folder.run(args);
    assert_eq!(said.code, Some(code), "{args:?}: {}", said.err);
    assert_eq!(said.out, "", "{args:?}");
    for fragment in says {
        assert!(said.err.contains(fragment), "{args:?} does not say {fragment:?}: {}", said.err);
    }
    assert!(!said.err.contains("panicked"), "{args:?}: {}", said.err);
    assert!(said.err.trim_end().lines().count() <= 8, "a message, not a page: {}", said.err);
    let raw = said.err.chars().any(|c| c.is_control() && c != '\n');
    assert!(!raw, "{args:?}: raw control characters in {:?}", said.err);
    assert_eq!(folder.content(), before, "{args:?} wrote something");
}

/// A text that somebody wrote with a mistake, given as the source: to try it again is no use.
fn refused_document(name: &str, content: impl AsRef<[u8]>, says: &[&str]) {
    refused_source(2, name, content, says);
}

/// One bad file, given as the source.
fn refused_file(name: &str, content: impl AsRef<[u8]>, says: &[&str]) {
    refused_source(1, name, content, says);
}

fn refused_source(code: i32, name: &str, content: impl AsRef<[u8]>, says: &[&str]) {
    let folder = Folder::new();
    folder.write(name, content);
    refused(&folder, code, &["export", name, "-o", "out.glb"], says);
}

fn refused_usage(args: &[&str], says: &[&str]) {
    refused(&Folder::new(), 2, args, says);
}

#[test]
fn names_that_do_not_exist() {
    // A hint that is far off is worse than none: "abop-e" is three letters away.
    let said = Folder::new().run(&["export", "nope", "-o", "x.glb"]).err;
    assert!(said.contains("'nope'; 'linden list'") && !said.contains("did you mean"), "{said}");
    refused_usage(&["export", "fir", "-o", "x.fbx"], &["'.fbx' is unknown", "Unity", "read glb", ".usda"]);
    refused_usage(
        &["export", "fir", "-o", "x.glb", "--set", "points=1e9"],
        &["'points'", "1000000000 is outside the range: a whole number, 1 to 100000000"],
    );
    for command in ["export", "stats", "show", "preview"] {
        refused_usage(
            &[command, "fir", "--seed", "-1"],
            &["--seed <N>", "-1 is not a whole number from 0 to 18446744073709551615"],
        );
    }
    refused_usage(&["export", "fri", "-o", "x.glb"], &["'fri'", "did you mean 'fir'", "linden list"]);
    refused_usage(&["export", "fir", "-o", "x.glbb"], &["x.glbb", "did you mean '.glb'"]);
    refused_usage(&["export", "fir", "-o", "x.glb", "--format", "gtlf"], &["'gtlf'", "did you mean 'gltf'"]);
    refused_usage(&["export", "fir"], &["-o fir.glb"]);
    refused_usage(&["export", "fir", "-o", "-"], &["--format"]);
    refused_usage(&["exprot", "fir"], &["export"]);
    refused_usage(
        &["preview", "fir", "-o", "fir.gif"],
        &["fir.gif", "PNG (.png)", "JPEG (.jpg, .jpeg)", ".webp"],
    );
    refused_usage(&["sheet", "fir", "-o", "fir"], &["PNG (.png)"]);
    refused_usage(&["preview", "fir", "-o", "fir.png", "--size", "90000x1"], &["8192"]);
}

#[test]
fn flags_of_other_commands_are_told_what_does_it_here() {
    refused_usage(&["export", "oak", "--season", "autumn"], &["'--set season=autumn'", "--seasons"]);
    refused_usage(&["preview", "oak", "--seasons"], &["'--set season=autumn'"]);
    refused_usage(&["preview", "oak", "--ages=5y"], &["'--age 10y'", "'linden sheet SOURCE --ages"]);
    refused_usage(&["preview", "oak", "--sesons"], &["'--set season=autumn'"]);
    refused_usage(&["batch", "m.toml", "--mkdir"], &["makes the folder of --out", "linden batch [OPTIONS]"]);
    refused_usage(&["stats", "oak", "--mkdir"], &["--mkdir is a flag of", "'linden export'"]);
    refused_usage(&["export", "oak", "--mkdr"], &["a similar argument exists: '--mkdir'"]);
    refused_usage(&["export", "oak", "--trian", "5"], &["a similar argument exists: '--triangles'"]);
}

#[test]
fn tips_are_of_the_command_that_was_typed() {
    let tips = |args: &[&str]| {
        let said = Folder::new().run(args);
        assert_eq!(said.code, Some(2), "{args:?}");
        let tips = said.err.lines().filter_map(|line| line.trim().strip_prefix("tip: ").map(str::to_owned));
        tips.collect::<Vec<_>>().join("; ")
    };
    for (args, expected) in [
        (
            &["batch", "m.toml", "--set", "points=3"][..],
            "the manifest says it, of each of its [[trees]]: set =",
        ),
        (&["batch", "m.toml", "--seed", "3"], "[[trees]]: seed = 7"),
        (&["batch", "m.toml", "--wind"], "[[trees]]: set = { wind = "),
        (&["batch", "m.toml", "--lods", "3"], "[[trees]]: set = { lods = 3 }"),
        (&["batch", "m.toml", "--season=autumn"], "[[trees]]: set = { season = \"autumn\" }"),
        (&["batch", "m.toml", "--seasons"], "set = { season = [\"summer\", \"autumn\"] }"),
        (&["batch", "m.toml", "--ages"], "ages = [\"young\""),
        (&["open", "oak", "--lods", "3"], "'--set lods=VALUE' turns a knob of that name"),
        (&["impostor", "oak", "--triangles", "9", "-o", "a.json"], "'--set triangles=VALUE'"),
        (&["cache", "--clear"], "it is no flag: 'linden cache clear'"),
        (&["forest", "oak", "--ages"], "'--set age=0.5'; several on a picture"),
        (&["export", "oak", "-lods", "3"], "a similar argument exists: '--lods'"),
        (&["export", "oak", "-triangles=9"], "a similar argument exists: '--triangles'"),
        (&["list", "oak"], "'linden show oak' describes it"),
    ] {
        let found = tips(args);
        assert!(found.contains(expected), "{args:?}: {found}");
    }
    // What is far off is worse than none.
    for args in [
        &["export", "oak", "--force"][..],
        &["export", "oak", "--scalar", "2"],
        &["export", "oak", "-x", "3"],
        &["export", "oak", "-j3"],
        &["list", "aok"],
    ] {
        assert_eq!(tips(args), "", "{args:?}");
    }
    let verify = tips(&["verify", "a.glb", "--season", "autumn"]);
    assert!(!verify.contains("--set") && verify.contains("linden export"), "{verify}");
}

/// A flag is no source: what is passed as one behind `--` would not be found.
#[test]
fn no_flag_is_advised_to_be_a_source() {
    let folder = Folder::new();
    for command in
        ["batch", "lint", "recipe", "export", "stats", "show", "verify", "cite", "sheet", "preview"]
    {
        let said = folder.run(&[command, "x", "--glorp"]);
        assert_eq!(said.code, Some(2), "{command}: {}", said.err);
        assert!(
            said.err.contains("'--glorp'") && !said.err.contains("-- --glorp"),
            "{command}: {}",
            said.err
        );
    }
}

#[test]
fn a_source_in_the_place_of_a_command_is_told_which_commands_take_it() {
    for preset in ["oak", "mixed-wood"] {
        let open = format!("'linden open {preset}' shows it in the workbench");
        refused_usage(&[preset], &["unrecognized subcommand", &open, &format!("'linden preview {preset}'")]);
    }
    let folder = Folder::new();
    folder.write("my.toml", "id = \"my\"\n");
    refused(&folder, 2, &["my.toml"], &["'linden open my.toml'"]);
    let said = folder.run(&["oakk"]);
    assert!(said.code == Some(2) && !said.err.contains("linden open"), "{}", said.err);
}

#[test]
fn knobs_turned_wrong() {
    let fir = |setting: &'static str| ["export", "fir", "-o", "x.glb", "--set", setting];
    refused_usage(
        &fir("pionts=3"),
        &["'pionts'", "did you mean 'points' (in points): a whole number, 1 to 100000000"],
    );
    refused_usage(&fir("points=0"), &["'points'", "1 to 100000000"]);
    refused_usage(&fir("step=-1"), &["'step'", "in m", "0.00001 to 1000"]);
    refused_usage(&fir("step=nan"), &["'step'"]);
    refused_usage(&fir("root=1,2"), &["'root'", "x,y,z"]);
    refused_usage(&fir("root=1,inf,2"), &["'root'"]);
    refused_usage(&fir("angle=20"), &["no knob 'angle'"]);
    refused_usage(&fir("points"), &["KNOB=VALUE"]);
    refused_usage(&fir("step=5cm"), &["'step'", "'5cm' is not", "write the number alone, in m"]);
    refused_usage(&fir("obj.lines=true"), &["obj"]);
    refused_usage(&fir("glb.lines=true"), &["glb", "'lines'"]);
    refused_usage(&fir("root=0,1e60,0"), &["'root'", "outside the range: x,y,z within ±1e9"]);
    refused_usage(&fir("crown=cube"), &["'crown'", "cone"]);
    refused_usage(
        &fir("crown=mesh"),
        &["'crown'", "'mesh' is not cone", "SOURCE of its own, like crown.obj"],
    );
    refused_usage(&["export", "fir", "--instances", "-o", "x.obj"], &["--instances", "glb", "usda"]);
    refused_usage(&["export", "fir", "--quantize", "-o", "x.usda"], &["--quantize", "gltf, glb"]);
    refused_usage(&["export", "fir", "--compress", "zip", "-o", "x.glb"], &["'zip'", "meshopt"]);
}

#[test]
fn growth_that_cannot_be() {
    let folder = Folder::new();
    let fir = |settings: &[&'static str], says: &[&str]| {
        let mut args = vec!["export", "fir", "-o", "x.glb"];
        args.extend(settings.iter().flat_map(|setting| ["--set", setting]));
        refused(&folder, 1, &args, says);
    };
    fir(&["kill=0.1"], &["0.1 m", "0.2 m", "kill", "step"]);
    // The crown hangs 100 m above a bare root that sees 1 m.
    fir(&["trunk=0", "crown_base=100", "influence=1"], &["m away", "influence", "trunk"]);
    fir(&["root=1e8,0,0"], &["100000000 m", "origin=root"]);
    fir(&["root=1e9,0,0"], &["origin=root"]);
    fir(&["step=1000", "kill=3D"], &["nothing grew", "1000 of 1000 points", "kill"]);
    fir(&["base_radius=0.01", "tip_radius=0.02"], &["base_radius", "tip_radius"]);
    fir(&["trunk=900", "step=0.00002", "kill=3D", "max_nodes=1000"], &["trunk", "max_nodes=1000"]);
}

#[test]
fn rules_that_explode_are_refused_at_once() {
    let folder = Folder::new();
    folder.write("boom.txt", "axiom=F\nangle=20\nnumber of derivations=60\nF=(1)FF\n");
    let started = std::time::Instant::now();
    refused(&folder, 1, &["export", "boom.txt", "-o", "x.glb"], &["50000000", "symbols", "25 derivations"]);
    // 2^60 symbols would take years; this is no measurement.
    assert!(started.elapsed().as_secs() < 20);
}

#[test]
fn grammars_with_mistakes() {
    let grammar = |rules: &str| format!("axiom=F\nangle=20\nnumber of derivations=2\n{rules}\n");
    refused_document("g.txt", grammar("F=(0.5)FF\nF=(0.4)F"), &["g.txt", "'F'", "0.9"]);
    refused_document("g.txt", grammar("F=(1)F[+F"), &["g.txt:4:7", "never closed"]);
    refused_document("g.txt", grammar("F=(1)F]F"), &["g.txt:4:7", "never opened"]);
    refused_document("g.txt", "axiom=F\nangle=twenty\nnumber of derivations=2\n", &["g.txt:2:7", "twenty"]);
    refused_document(
        "g.txt",
        b"axiom=F\nangle=20\xff\nnumber of derivations=2\n",
        &["g.txt", "line 2", "UTF-8"],
    );
}

#[test]
fn recipes_with_mistakes() {
    refused_document("r.json", "{\"id\": \"r\", \"id\": \"s\"}", &["r.json:1:", "'id' stands twice"]);
    refused_document("r.json", "{\"id\": null}", &["r.json:1:", "null"]);
    refused_document("r.json", "{\"id\": \"r\",", &["r.json:1:"]);
    refused_document(
        "r.json",
        "{\"id\": \"r\", \"lsystem\": {\"axiom\": \"F\", \"rules\": [\"F=F[\"]}}",
        &["r.json", "never closed"],
    );
}

#[test]
fn presets_with_mistakes() {
    refused_document(
        "p.toml",
        "id = \"p\"\n[colonization]\ncrown = \"cone\"\npionts = 3\n",
        &["p.toml:4:1", "did you mean 'points'"],
    );
    refused_document(
        "p.toml",
        "id = \"p\"\n[colonization]\ncrown = \"cone\"\npoints = -3\n",
        &["p.toml:4:10", "'points'"],
    );
    refused_document(
        "p.toml",
        "id = \"p\"\n[lsystem]\naxiom = \"F\"\nrules = [\"F -> F[+F\"]\n",
        &["p.toml:4:17", "never closed"],
    );
    refused_document("p.toml", "id = \"p\"\n[colonization\n", &["p.toml:2:"]);
    refused_document(
        "p.toml",
        "id = \"\"\n[colonization]\ncrown = \"cone\"\n",
        &["p.toml:1:6", "'id' is empty"],
    );
    refused_document("p.toml", "id = \"p\"\n", &["p.toml", "[lsystem]", "[colonization]"]);
    refused_document(
        "p.toml",
        "id = \"p\"\n[colonisation]\ncrown = \"cone\"\n",
        &["p.toml:2:2: a preset has no [colonisation] (did you mean 'colonization'?)"],
    );
    refused_document(
        "p.toml",
        "id = \"p\"\n[colonization]\ncrown = \"cone\"\n[foliage]\nleaf_length = \"8cm\"\n",
        &["p.toml:5:15: knob 'leaf_length'", "'8cm' is not", "write the number alone, in m"],
    );
    // A table that is no generator's either.
    refused_document(
        "p.toml",
        "id = \"p\"\n[foliag]\n",
        &["a preset has no [foliag] (did you mean 'foliage'?)"],
    );
}

#[test]
fn files_that_documents_name_and_cannot() {
    let crown = |file: &str| format!("id = \"p\"\n[colonization]\nenvelope = \"{file}\"\n");
    refused_document(
        "p.toml",
        crown("none.obj"),
        &["p.toml:3:1: 'envelope': reading none.obj", "--allow-path"],
    );
    refused_document("p.toml", crown("../none.obj"), &["p.toml:3:1: 'envelope'", "allow its folder"]);
    for content in [&b"v 0 0 0\nv \xff"[..], b"\xff\xfev\0"] {
        let folder = Folder::new();
        folder.write("p.toml", crown("crown.obj"));
        folder.write("crown.obj", content);
        refused(&folder, 2, &["export", "p.toml", "-o", "x.glb"], &["p.toml:3:1: 'envelope'", "as UTF-8"]);
        refused(&folder, 2, &["export", "crown.obj", "-o", "x.glb"], &["crown.obj", "as UTF-8"]);
    }
    let set = ["export", "fir", "-o", "x.glb", "--set", "bark_picture=none.png"];
    refused_usage(&set, &["reading none.png for 'bark_picture'"]);
    // What is there and broken may be mended where it is.
    let folder = Folder::new();
    folder.write("p.toml", crown("crown.obj"));
    folder.write("crown.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    refused(&folder, 1, &["export", "p.toml", "-o", "x.glb"], &["crown.obj"]);
}

#[test]
fn a_mistake_as_long_as_a_file_is_quoted_in_one_short_line() {
    let long = "A".repeat(20_000_000);
    let folder = Folder::new();
    for (name, content) in [
        ("p.toml", format!("id = \"p\"\n[colonization]\ncrown = \"cone\"\n{long} = 3\n")),
        ("p.toml", format!("id = \"p\"\n[colonization]\ncrown = \"{long}\"\n")),
    ] {
        folder.write(name, content);
        let said = folder.run(&["show", name]);
        assert_eq!(said.code, Some(2));
        assert!(said.err.len() < 600, "{} bytes", said.err.len());
        assert!(said.err.contains("AAA…"), "{}", said.err);
    }
}

#[test]
fn meshes_and_points_with_mistakes() {
    refused_file("m.obj", "", &["m.obj", "empty"]);
    refused_file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", &["m.obj"]);
    refused_file("m.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", &["m.obj", "line 2"]);
    // A flat sheet encloses nothing.
    refused_file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n", &["m.obj", "enclose"]);
    refused_file("p.xyz", "0 0 0\n1 1 inf\n", &["p.xyz", "line 2"]);
    refused_file("p.xyz", "1 1 1\n".repeat(20), &["p.xyz", "at least"]);
    refused_file("p.xyz", "0 0 0\n1 1\n", &["p.xyz", "line 2"]);

    let header = |vertices: &str, x: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty {x} x\nproperty float y\nproperty float z\nend_header\n"
        )
    };
    refused_file("p.ply", header("4000000000", "float") + "0123456789", &["p.ply", "4000000000"]);
    refused_file("p.ply", header("2", "list uchar float") + &"0".repeat(90), &["p.ply", "list"]);
    refused_file("p.ply", header("9", "float") + "0123456789ab0123456789ab", &["p.ply"]);
    refused_file("p.ply", header("1", "quaternion") + "0123456789ab", &["p.ply", "quaternion"]);
}

/// The signature, a header that says how large it is, a few pixels, the end.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[1, 2, 3, 255]).unwrap();
    drop(writer);
    // Behind the signature, the chunk's length and its name.
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&sum.to_be_bytes());
    bytes
}

/// As PNG has it (annex D of its specification).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(
            sum ^ u32::from(*byte),
            |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 },
        )
    })
}

#[test]
fn files_of_leaves_that_are_none() {
    let preset = |line: &str| {
        format!("id = \"p\"\n[colonization]\ncrown = \"cone\"\npoints = 60\n[foliage]\n{line}\n")
    };
    let with = |line: &str, file: &str, content: &[u8], says: &[&str]| {
        let folder = Folder::new();
        folder.write("p.toml", preset(line));
        folder.write(file, content);
        refused(&folder, 1, &["export", "p.toml", "-o", "x.glb", "-o", "x.obj"], says);
    };
    let mesh = "leaf_form = \"mesh\"\nleaf_mesh = \"leaf.obj\"";
    with(mesh, "leaf.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["leaf.obj", "3 vertices and no faces"]);
    with(mesh, "leaf.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", &["leaf.obj"]);
    let picture = "leaf_form = \"card\"\nleaf_picture = \"leaf.png\"";
    let barks = ["[bark]\nbark_picture = \"leaf.png\"", "[bark]\nbark_normal = \"leaf.png\""];
    for picture in [picture, barks[0], barks[1]] {
        let with = |content: &[u8], says: &[&str]| with(picture, "leaf.png", content, says);
        with(&png_of(40_000, 40_000), &["leaf.png", "40000×40000", "8192", "scale it down"]);
        with(&png_of(9_000, 10), &["leaf.png", "9000×10", "8192"]);
        with(b"hello, I am a picture\n", &["leaf.png", "not a picture that linden reads", "save it as PNG"]);
        with(b"\xff\xd8\xff\xe0\0\x10JFIF", &["leaf.png", "JPEG", "ends early"]);
        with(b"GIF89a\x01\0\x01\0", &["leaf.png", "GIF", "save it as PNG"]);
        with(&fixture_picture("cmyk.jpg"), &["leaf.png", "CMYK", "save it as RGB"]);
        with(&fixture_picture("animated.webp"), &["leaf.png", "animation"]);
        with(&png_of(64, 64), &["leaf.png", "damaged"]);
        with(b"", &["leaf.png"]);
    }
    let folder = Folder::new();
    folder.write("p.toml", preset(picture));
    refused(&folder, 2, &["export", "p.toml", "-o", "x.glb"], &["leaf.png", "p.toml"]);
    // A picture where a mesh must be, and the other way round.
    with(&mesh.replace("leaf.obj", "leaf.png"), "leaf.png", &png_of(1, 1), &["leaf.png", "mesh (OBJ)"]);
    let triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (picture, key) in [(picture, "leaves"), (barks[0], "bark_picture"), (barks[1], "bark_normal")] {
        let says = [key, "leaf.obj", "picture (PNG, JPEG, WebP or TGA)"];
        with(&picture.replace("leaf.png", "leaf.obj"), "leaf.obj", triangle, &says);
    }
}

#[test]
fn forests_that_cannot_be() {
    let folder = Folder::new();
    let forest = |args: &[&str], code: i32, says: &[&str]| {
        refused(&folder, code, &[&["forest", "-o", "x.glb"][..], args].concat(), says);
    };
    forest(&["fir", "--area", "10", "--spacing", "20"], 1, &["20 m apart", "10 m × 10 m", "smaller spacing"]);
    forest(&["fir", "--area", "20", "--trees", "5000"], 1, &["5000 trees", "find room", "fewer trees"]);
    forest(&["fir", "--area", "10000", "--spacing", "0.05"], 1, &["more than 1000000", "smaller area"]);
    forest(&["fir", "--spacing", "-1"], 2, &["'spacing'", "0.05 to 1000"]);
    forest(&["fir", "--area", "wide"], 2, &["'area'", "1 to 10000"]);
    forest(&["fir:0", "simple"], 2, &["fir:0", "above 0"]);
    forest(&["fir:-1"], 2, &["fir:-1", "above 0"]);
    forest(&["fir:inf"], 2, &["fir:inf", "not inf"]);
    forest(&["fri"], 2, &["'fri'", "did you mean 'fir'"]);
    forest(&["mixed-wod"], 2, &["did you mean 'mixed-wood'"]);
    forest(
        &["dressed-simple", "--triangles", "10"],
        1,
        &["Simple tree in leaf", "triangles=10", "ask for at least"],
    );
    folder.write("f.toml", "spacing = 3\n[[tree]]\npreset = \"fir\"\nsahre = 2\n");
    forest(&["f.toml"], 2, &["f.toml:4:1", "sahre"]);
    forest(&["fir", "--trees", "2.5"], 2, &["'trees'", "2.5 is not a whole number"]);
    folder.write("f.toml", "trees = 2.5\n[[tree]]\npreset = \"fir\"\n");
    forest(&["f.toml"], 2, &["f.toml:1:1", "2.5 is not a whole number"]);
    folder.write("f.toml", "spacing = 3\n[[tree]]\npreset = \"none.toml\"\n");
    forest(&["f.toml"], 2, &["none.toml"]);
}

#[test]
fn budgets_levels_and_seasons_that_cannot_be() {
    let folder = Folder::new();
    let simple = |args: &[&str], code: i32, says: &[&str]| {
        refused(
            &folder,
            code,
            &[&["export", "dressed-simple", "-o", "x.glb", "-o", "x.obj"][..], args].concat(),
            says,
        );
    };
    simple(&["--triangles", "10"], 1, &["triangles=10", "its stem and one leaf alone have", "at least"]);
    simple(&["--triangles", "few"], 2, &["'few'", "--triangles"]);
    simple(&["--lods", "0"], 2, &["'lods'", "1 to 8"]);
    simple(&["--lods", "99"], 2, &["'lods'", "1 to 8"]);
    simple(&["--lods", "many"], 2, &["'many'", "'lods'"]);
    simple(&["--lods", "900,many"], 2, &["'900,many'", "'lod_triangles'"]);
    simple(&["--lods", "900,900"], 2, &["'900,900'", "900 triangles follow 900"]);
    simple(&["--set", "lod_triangles=900 900"], 1, &["lod_triangles: 900 triangles follow 900"]);
    simple(&["--lods", "3", "--lod-ratio", "7"], 2, &["'lod_ratio'", "0.05 to 0.9"]);
    simple(&["--billboard", "9"], 2, &["'billboard'", "0 to 4"]);
    simple(&["--wind", "storm"], 2, &["'wind'", "sway"]);
    simple(&["--seasons", "atumn"], 2, &["'atumn'", "did you mean 'autumn'", "flush"]);
    simple(&["--seasons", "late=1.5"], 2, &["late", "'1.5'", "0 to 1"]);
    simple(&["--seasons", "a/b=0.5"], 2, &["'a/b'", "lower-case letter"]);
    simple(&["--seasons", "summer,summer"], 2, &["summer", "twice"]);
    simple(&["--seasons", ","], 2, &["no season is named"]);
}

#[test]
fn file_names_are_never_printed_raw() {
    let name = "evil\u{1b}]0;owned\u{7}\u{202e}.txt";
    refused_document(
        name,
        "axiom=F\nangle=20\nnumber of derivations=2\nF=(1)F[+F\n",
        &["\\u{1b}", "\\u{202e}", "never closed"],
    );
    refused_usage(&["export", name, "-o", "x.glb"], &["\\u{1b}"]);
    refused_usage(&["export", "fir", "-o", "x.glb", "--set", "a\u{1b}=1"], &["\\u{1b}"]);
    refused_usage(&["export", "fir", "-o", "x.glb", "--format", "\u{1b}[2J"], &["\\u{1b}"]);
}

#[cfg(unix)]
#[test]
fn places_that_cannot_be_written_to() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::new();
    std::fs::create_dir(folder.file("dir.glb")).unwrap();
    refused(&folder, 2, &["export", "fir", "-o", "dir.glb"], &["dir.glb", "directory", "--format"]);
    refused(&folder, 1, &["export", "fir", "-o", "none/x.glb"], &["none", "create it", "--mkdir"]);
    refused(&folder, 1, &["export", "fir", "-o", "none/", "--format", "glb"], &["none/fir.glb", "--mkdir"]);
    refused(&folder, 1, &["sheet", "fir", "-o", "none/x.png"], &["none", "--mkdir"]);
    refused(&folder, 1, &["export", "fir", "-o", "ok.obj", "-o", "none/x.glb"], &["none"]);
    refused(&folder, 2, &["export", "fir", "-o", "x.glb", "-o", "./x.glb"], &["x.glb", "same file"]);
    refused(&folder, 1, &["preview", "fir", "-o", "none/x.png"], &["none", "--mkdir"]);

    // Nobody, not even root, makes files there.
    if std::path::Path::new("/proc/self").exists() {
        refused(&folder, 1, &["export", "fir", "-o", "/proc/fir.glb"], &["/proc"]);
    }
    std::fs::create_dir(folder.file("locked")).unwrap();
    std::fs::set_permissions(folder.file("locked"), std::fs::Permissions::from_mode(0o555)).unwrap();
    // Root may write anywhere: then there is nothing to refuse.
    if std::fs::write(folder.file("locked/probe"), "").is_err() {
        refused(&folder, 1, &["export", "fir", "-o", "locked/x.glb"], &["locked"]);
    }
    std::fs::set_permissions(folder.file("locked"), std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn what_the_tree_grows_from_is_never_replaced() {
    let folder = Folder::new();
    let cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    folder.write("crown.obj", cube);
    folder.write("mine.toml", "id = \"mine\"\n[colonization]\nenvelope = \"crown.obj\"\n");
    let grown_from = "grown from that file";
    // Written in the format of a mesh, a mesh would have the name that it already has.
    refused(&folder, 1, &["export", "crown.obj", "--format", "obj"], &["crown.obj", grown_from]);
    refused(&folder, 1, &["export", "crown.obj", "-o", "./crown.obj"], &["crown.obj", grown_from]);
    refused(
        &folder,
        1,
        &["export", "mine.toml", "-o", "mine.toml", "--format", "obj"],
        &["mine.toml", grown_from],
    );
    refused(
        &folder,
        1,
        &["export", "mine.toml", "-o", "x.glb", "-o", "crown.obj"],
        &["crown.obj", grown_from],
    );
    refused(&folder, 2, &["preview", "fir", "-o", "mine.toml"], &["mine.toml", "PNG"]);
    // What a survey cost a day to make is not lost to a slip of the hand.
    let rows: Vec<String> = (0..400).map(|i| format!("0.0 {} 0.0", f64::from(i) * 0.01)).collect();
    folder.write("survey.xyz", rows.join("\n"));
    let survey = ["scan", "survey.xyz", "--positions", "1", "--step", "1"];
    for (name, args) in
        [("survey.xyz", &["-o", "x.ply", "--truth", "survey.xyz"][..]), ("copy.ply", &["-o", "./copy.ply"])]
    {
        let source = if name == "copy.ply" {
            let made = ["scan", "fir", "--set", "points=60", "--positions", "1", "--step", "1", "-o", name];
            assert_eq!(folder.run(&made).code, Some(0));
            ["scan", name, "--positions", "1", "--step", "1"]
        } else {
            survey
        };
        let before = folder.read(name);
        refused(&folder, 1, &[&source[..], args].concat(), &[name, grown_from]);
        assert_eq!(folder.read(name), before);
    }
    folder.run(&["preview", "fir", "-o", "bark.png", "--set", "points=60", "--size", "64x64"]).done();
    for command in ["preview", "sheet"] {
        let args = [command, "older-a", "--set", "bark_picture=bark.png", "-o", "bark.png"];
        refused(&folder, 1, &args, &["bark.png", grown_from]);
    }
    folder.run(&["export", "fir", "--set", "points=60", "-o", "table.csv"]).done();
    let args = ["sweep", "table.csv", "-o", "table.csv", "--overwrite"];
    refused(&folder, 2, &args, &["table.csv", grown_from]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_an_older_file_survives() {
    // The device that is always full.
    let folder = Folder::new();
    refused(
        &folder,
        1,
        &["export", "fir", "-o", "/dev/full", "--format", "glb"],
        &["/dev/full", "free some space"],
    );

    // A limit on file sizes fails in the middle of a file, as a full disk does.
    folder.write("old.obj", "an older file");
    let before = folder.content();
    let script =
        format!("ulimit -f 64; trap '' XFSZ; exec {} export fir -o old.obj", env!("CARGO_BIN_EXE_linden"));
    let output =
        std::process::Command::new("bash").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("writing old") && said.contains("ulimit"), "{said}");
    assert_eq!(folder.content(), before);
}

#[test]
fn places_too_far_for_growth_are_refused_where_they_stand() {
    let part = |keys: &str| {
        format!(
            "id = \"far\"\n[colonization]\ncrown = \"sphere\"\n[[colonization.part]]\nrole = \"tree\"\ncrown = \"sphere\"\n{keys}\n"
        )
    };
    refused_document(
        "far.toml",
        part("root = [3.6, 1e60, 0]"),
        &["far.toml:7:8: knob 'root'", "within ±1e9"],
    );
    refused_document("far.toml", part("root = [0, 0, 0]\nat = [-2e9, 0, 0]"), &["far.toml:8:6: knob 'at'"]);
    let crown =
        "id = \"far\"\n[colonization]\ncrown = \"revolution\"\nprofile_points = [[0, 1], [1e60, 1]]\n";
    refused_document("far.toml", crown, &["far.toml:4:18: knob 'profile_points'"]);
    // Within the range, but coarser than its steps: said before anything grows there.
    refused_file("far.toml", part("root = [0, 9e8, 0]\ntrunk = 2"), &["single precision"]);
    let folder = Folder::new();
    folder.write("wood.toml", "[[tree]]\npreset = \"fir\"\nsize = 1e60\n");
    refused(
        &folder,
        2,
        &["forest", "wood.toml", "-o", "x.glb"],
        &["wood.toml:3:8: knob 'size'", "0.001 to 1000"],
    );
}

#[test]
fn a_mesh_in_the_wrong_place_is_told_the_right_one() {
    let crown = |keys: &str| format!("id = \"a\"\n[colonization]\n{keys}\n");
    let right = "envelope = \"crown.obj\"";
    refused_document("a.toml", crown("crown = \"mesh\""), &["a.toml:3:9: knob 'crown'", right]);
    refused_document("a.toml", crown("crown = \"hull.obj\""), &["a.toml:3:9: knob 'crown'", right]);
    refused_document("a.toml", crown("mesh = \"hull.obj\""), &["a.toml:3:1", "no 'mesh'", right]);
    refused_document(
        "a.toml",
        crown("crown = \"dome\"\nmesh = \"hull.obj\""),
        &["a.toml:4:1", "no 'mesh'", right],
    );
    let both = crown("crown = \"dome\"\nenvelope = \"hull.obj\"");
    refused_document("a.toml", both, &["a.toml:4:1", "'crown' and 'envelope'", "keep one"]);
}

#[test]
fn levels_run_from_the_finest_to_the_coarsest() {
    refused_usage(
        &["export", "fir", "-o", "x.glb", "--lods", "4000,10000"],
        &["10000 triangles follow 4000"],
    );
    refused_usage(&["export", "fir", "-o", "x.glb", "--lods", "abc"], &["lods"]);
    refused_usage(&["export", "fir", "-o", "x.glb", "--lods", "abc,1"], &["lod_triangles"]);
}
