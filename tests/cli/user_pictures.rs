//! The user's pictures in place of drawn ones, from the command line and from a preset.

use crate::program::{Folder, fixture_picture};

const SMALL: [&str; 6] = ["--set", "points=100", "--set", "bark_size=32", "--set", "leaf_size=32"];

/// A PNG of one colour with a stripe of another down its first column, half of it transparent.
fn striped(width: u32, height: u32) -> (Vec<u8>, Vec<u8>) {
    let pixel = |i: u32| if i.is_multiple_of(width) { [200, 40, 30, 128] } else { [30, 90, 160, 255] };
    let rgba: Vec<u8> = (0..width * height).flat_map(pixel).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(&rgba).unwrap();
    (bytes, rgba)
}

/// Width, height and bytes of a pixel of a picture, and its bytes.
fn pixels(png: &[u8]) -> ([u32; 2], usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    ([info.width, info.height], info.color_type.samples(), bytes)
}

/// From the least to the largest V of the wood's texture coordinates.
fn wood_v(obj: &str) -> f32 {
    let (mut low, mut high, mut is_wood) = (f32::MAX, f32::MIN, false);
    for line in obj.lines() {
        match line.split_once(' ') {
            Some(("o" | "g", part)) => is_wood = part.contains("wood"),
            Some(("vt", uv)) if is_wood => {
                let v: f32 = uv.split(' ').nth(1).unwrap().parse().unwrap();
                (low, high) = (low.min(v), high.max(v));
            }
            _ => {}
        }
    }
    high - low
}

/// The picture that a material of an .mtl shows.
fn map(folder: &Folder, mtl: &str, material: &str, key: &str) -> Vec<u8> {
    let text = String::from_utf8(folder.read(mtl)).unwrap();
    let section =
        text.split("newmtl ").find(|section| section.lines().next().unwrap().contains(material)).unwrap();
    let line =
        section.lines().find(|line| line.starts_with(key)).unwrap_or_else(|| panic!("{key} in {section}"));
    folder.read(line.split(' ').next_back().unwrap())
}

#[test]
fn a_png_replaces_bark_and_leaves_and_comes_back_with_the_recipe() {
    let folder = Folder::new();
    let ((bark, rgba), (leaf, leaf_rgba)) = (striped(16, 32), striped(8, 8));
    folder.write("bark.png", &bark);
    folder.write("leaf.png", &leaf);
    let run = |args: &[&str]| folder.run(&[&["export"][..], args].concat()).done();
    run(&[&["dressed-simple", "-o", "drawn.obj"][..], &SMALL].concat());
    let settings = ["--set", "bark_picture=bark.png", "--set", "leaf_picture=leaf.png"];
    run(&[&["dressed-simple", "-o", "mine.obj"][..], &SMALL[..4], &settings].concat());

    // The bark as it is but for its holes, its normals drawn of it; the leaf with its holes.
    let (size, samples, kd) = pixels(&map(&folder, "mine.mtl", "bark", "map_Kd"));
    let colors = |bytes: &[u8], samples: usize| -> Vec<u8> {
        bytes.chunks(samples).flat_map(|pixel| pixel[..3].to_vec()).collect()
    };
    assert_eq!((size, colors(&kd, samples)), ([16, 32], colors(&rgba, 4)));
    assert!(samples == 3 || kd.chunks(4).all(|pixel| pixel[3] == 255), "bark has no holes");
    let (size, samples, normals) = pixels(&map(&folder, "mine.mtl", "bark", "norm"));
    assert_eq!(size, [16, 32]);
    let leaning = normals.chunks(samples).filter(|pixel| pixel[0].abs_diff(128) > 3).count();
    assert!((32..=4 * 32).contains(&leaning), "{leaning} of 512 lean: those beside the stripe");
    assert_eq!(pixels(&map(&folder, "mine.mtl", "leaves", "map_Kd")).2, leaf_rgba);

    // Twice as high as wide: half as many of them up the trunk.
    let text = |name: &str| String::from_utf8(folder.read(name)).unwrap();
    let (drawn, tall) = (wood_v(&text("drawn.obj")), wood_v(&text("mine.obj")));
    assert!((tall - drawn / 2.0).abs() < 1e-3 * drawn, "{drawn} {tall}");

    // A preset with the same, and the recipe in the file, give the same again.
    let recipe = text("mine.obj").lines().find_map(|line| Some(line[line.find("{\"linden\"")?..].to_owned()));
    folder.write("again.json", recipe.unwrap());
    run(&["again.json", "-o", "again.obj"]);
    let faces = |name: &str| {
        text(name).lines().filter(|line| !line.starts_with("mtllib")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(faces("again.obj") == faces("mine.obj"), "the recipe grows another tree");
    assert!(map(&folder, "again.mtl", "bark", "map_Kd") == map(&folder, "mine.mtl", "bark", "map_Kd"));
}

/// As `tests/fixtures/pictures/make.py` has them, in quarters.
const COLORS: [[u8; 3]; 4] = [[200, 40, 30], [40, 160, 60], [30, 60, 190], [230, 220, 90]];

/// What the material of the leaves shows in the middle of each quarter, with its alpha.
fn quarters(folder: &Folder, leaf: &str) -> [[u8; 4]; 4] {
    let picture = format!("leaf_picture={leaf}");
    let command = ["export", "dressed-simple", "-o", "leaf.obj", "--set", &picture];
    folder.run(&[&command[..], &SMALL[..4]].concat()).done();
    let (size, samples, bytes) = pixels(&map(folder, "leaf.mtl", "leaves", "map_Kd"));
    assert_eq!(size, [16, 12], "{leaf}");
    [(4, 3), (12, 3), (4, 9), (12, 9)].map(|(column, row)| {
        let pixel = &bytes[(row * 16 + column) * samples..][..samples];
        match *pixel {
            [grey] => [grey, grey, grey, 255],
            [grey, alpha] => [grey, grey, grey, alpha],
            [r, g, b] => [r, g, b, 255],
            _ => [pixel[0], pixel[1], pixel[2], pixel[3]],
        }
    })
}

#[test]
fn pictures_of_all_formats_are_read() {
    let folder = Folder::new();
    let grey = COLORS.map(|[r, ..]| [r; 3]);
    // How far a lossy picture may be off.
    for (file, colors, has_hole, off) in [
        ("baseline.jpg", COLORS, false, 3),
        ("subsampled.jpg", COLORS, false, 3),
        ("progressive.jpg", COLORS, false, 3),
        ("grey.jpg", grey, false, 2),
        ("turned.jpg", COLORS, false, 3),
        ("lossy.webp", COLORS, false, 6),
        ("lossy-alpha.webp", COLORS, true, 6),
        ("lossless.webp", COLORS, false, 0),
        ("lossless-alpha.webp", COLORS, true, 0),
        ("turned.webp", COLORS, false, 0),
        ("colors.tga", COLORS, false, 0),
        ("runs.tga", COLORS, true, 0),
        ("old.tga", COLORS, false, 0),
        ("palette.tga", COLORS, false, 0),
        ("grey.tga", grey, false, 0),
        ("grey.png", grey, false, 0),
        ("grey16.png", grey, false, 0),
        ("palette.png", COLORS, true, 0),
        ("turned.png", COLORS, false, 0),
    ] {
        folder.write(file, fixture_picture(file));
        let found = quarters(&folder, file);
        for (index, (pixel, color)) in found.into_iter().zip(colors).enumerate() {
            let is_hole = has_hole && index == 3;
            assert_eq!(pixel[3], if is_hole { 0 } else { 255 }, "{file}, quarter {index}");
            // What colour a hole has is for each format to say.
            let near = is_hole || (0..3).all(|i| pixel[i].abs_diff(color[i]) <= off);
            assert!(near, "{file}, quarter {index}: {pixel:?} for {color:?}");
        }
    }
    // The content counts, not the name, but for a TGA without a mark.
    folder.write("a.png", fixture_picture("baseline.jpg"));
    folder.write("b.jpg", fixture_picture("runs.tga"));
    assert_eq!(quarters(&folder, "a.png"), quarters(&folder, "baseline.jpg"));
    assert_eq!(quarters(&folder, "b.jpg"), quarters(&folder, "runs.tga"));
}

#[test]
fn normals_of_ones_own_must_lie_on_the_picture() {
    let folder = Folder::new();
    folder.write("bark.png", striped(16, 32).0);
    folder.write("normal.png", striped(32, 64).0);
    folder.write("wide.png", striped(64, 32).0);
    let with = |normal: &str| {
        let normal = format!("bark_normal={normal}");
        let command = ["export", "fir", "-o", "x.glb", "--set", "bark_picture=bark.png", "--set", &normal];
        folder.run(&command)
    };
    with("normal.png").done();
    assert!(folder.names().contains(&"x.glb".to_owned()));
    let refused = |normal: &str, code: i32, says: &[&str]| {
        let before = folder.content();
        let said = with(normal);
        assert_eq!(said.code, Some(code), "{}", said.err);
        assert!(says.iter().all(|part| said.err.contains(part)), "{}", said.err);
        assert_eq!(folder.content(), before);
    };
    refused("wide.png", 1, &["'bark_normal'", "64 × 32", "16 × 32", "same proportions"]);
    refused("none.png", 2, &["none.png", "bark_normal"]);
}

#[test]
fn a_preset_shows_which_pictures_it_takes() {
    let folder = Folder::new();
    folder.write("bark.png", striped(16, 32).0);
    let page = folder.run(&["show", "fir"]).done().out;
    assert!(page.lines().any(|line| line.trim_start().starts_with("bark_picture") && line.contains("none")));
    let page = folder.run(&["show", "fir", "--set", "bark_picture=bark.png"]).done().out;
    assert!(page.contains("bark.png: 16×32 pixels"), "{page}");
}

/// How much light passes the leaves on a branch card: gray, and in alpha for glTF's own words.
#[test]
fn cards_say_where_light_passes() {
    let folder = Folder::new();
    let args = ["export", "hazel", "--triangles", "8000", "--set", "card_size=256", "-o", "hazel.gltf"];
    folder.run(&[&args[..], &["--set", "gltf.translucency=true"]].concat()).done();
    let file: serde_json::Value = serde_json::from_slice(&folder.read("hazel.gltf")).unwrap();
    let named = |list: &str, name: &str| {
        let all = file[list].as_array().unwrap();
        all.iter().find(|item| item["name"].as_str().unwrap().ends_with(name)).unwrap().clone()
    };
    let through = &named("materials", "branches")["extensions"]["KHR_materials_diffuse_transmission"];
    let uri = |texture: &serde_json::Value| {
        let texture = &file["textures"][texture["index"].as_u64().unwrap() as usize];
        file["images"][texture["source"].as_u64().unwrap() as usize]["uri"].as_str().unwrap().to_owned()
    };
    let (passing, colored) =
        (uri(&through["diffuseTransmissionTexture"]), uri(&through["diffuseTransmissionColorTexture"]));
    assert_eq!((passing.as_str(), colored.as_str()), ("hazel_branches_passing.png", "hazel_branches.png"));
    let (size, samples, bytes) = pixels(&folder.read(&passing));
    assert_eq!((size, samples), ([256; 2], 2));
    let gray = bytes.as_chunks::<2>().0;
    assert!(gray.iter().all(|[value, alpha]| value == alpha));
    assert!(gray.iter().any(|[value, _]| *value > 250) && gray.iter().any(|[value, _]| *value < 30));
    // Nobody asked: no picture that nothing shows.
    folder.run(&[&args[..6], &["-o", "plain.gltf"]].concat()).done();
    assert!(!folder.names().iter().any(|name| name.starts_with("plain") && name.contains("passing")));
}

/// The mean colour of the opaque pixels of a picture.
fn mean(png: &[u8]) -> [f64; 3] {
    let (_, samples, bytes) = pixels(png);
    let opaque: Vec<&[u8]> = bytes.chunks(samples).filter(|pixel| samples == 3 || pixel[3] == 255).collect();
    [0, 1, 2].map(|c| opaque.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / opaque.len() as f64)
}

#[test]
fn a_leafs_picture_turns_with_the_colours_that_are_given_for_it() {
    let folder = Folder::new();
    // Green, one half of it lighter.
    let rgba: Vec<u8> =
        (0..64).flat_map(|i| if i % 8 < 4 { [60, 110, 40, 255] } else { [80, 140, 60, 255] }).collect();
    let leaf = linden::picture::Picture::new(8, 8, rgba).png().unwrap().to_vec();
    folder.write("leaf.png", &leaf);
    let leaf_in = |name: &str, season: &str, colors: &[&str]| {
        let file = format!("{name}.obj");
        let set = ["--set", "leaf_picture=leaf.png", "--set", season];
        let args = [&["export", "dressed-simple", "-o", &file][..], &SMALL, &set, colors].concat();
        let said = folder.run(&args);
        assert_eq!(said.code, Some(0), "{}", said.err);
        map(&folder, &format!("{name}.mtl"), "leaves", "map_Kd")
    };
    let red = ["--set", "autumn_colors=#c03020"];
    assert_eq!(mean(&leaf_in("summer", "season=0.4", &red)), mean(&leaf), "it shows summer");
    assert_eq!(mean(&leaf_in("plain", "season=0.9", &[])), mean(&leaf), "nobody said what it turns to");
    let autumn = leaf_in("autumn", "season=0.9", &red);
    let [r, g, b] = mean(&autumn);
    // Nearly #c03020.
    assert!(r > 160.0 && (45.0..80.0).contains(&g) && (b - 36.0).abs() < 10.0, "{r} {g} {b}");
    let (_, samples, bytes) = pixels(&autumn);
    assert!(bytes[4 * samples] > bytes[0], "the lighter half is lighter still");
    let [r, g, _] = mean(&leaf_in("turning", "season=0.62", &red));
    assert!(r > 75.0 && g > 55.0, "between: {r} {g}");
}
