//! preview, sheet: pictures of trees, in files and in the terminal.

use crate::program::Folder;

/// A picture's width and height, and its pixels.
pub fn pixels(png: &[u8]) -> ((u32, u32), Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    ((info.width, info.height), bytes)
}

#[test]
fn a_sheet_is_made_of_the_previews_of_its_trees() {
    let folder = Folder::new();
    let sheet =
        ["sheet", "fir", "older-shrub", "--seeds", "2", "--size", "60x70", "--columns", "3", "-o", "s.png"];
    folder.run(&[&sheet[..], &["--labels", "none"]].concat()).done();
    let (size, whole) = pixels(&folder.read("s.png"));
    assert_eq!(size, (180, 140));
    let channels = whole.len() / (180 * 140);
    for (place, (id, seed)) in
        [("fir", "1"), ("fir", "2"), ("older-shrub", "1"), ("older-shrub", "2")].iter().enumerate()
    {
        let png = folder.run(&["preview", id, "--seed", seed, "--size", "60x70", "-o", "-"]).done().bytes;
        let (size, preview) = pixels(&png);
        assert_eq!((size, preview.len()), ((60, 70), 60 * 70 * channels));
        let (left, top) = (place % 3 * 60, place / 3 * 70);
        for (row, line) in preview.chunks(60 * channels).enumerate() {
            let at = ((top + row) * 180 + left) * channels;
            assert_eq!(&whole[at..at + line.len()], line, "{id} {seed}, row {row}");
        }
    }
    let last = &whole[((70 * 180) + 120) * channels..][..3];
    assert_eq!(last, [255; 3], "nothing lies there");

    // With labels each picture is the same, and has letters below it: a name, and a seed.
    folder.run(&sheet).done();
    let ((wide, high), labelled) = pixels(&folder.read("s.png"));
    let below = high as usize / 2 - 70;
    assert!(wide == 180 && high % 2 == 0 && below > 12, "{wide}x{high}");
    let line = 180 * channels;
    assert_eq!(labelled[..70 * line], whole[..70 * line]);
    assert_eq!(labelled[(70 + below) * line..][..70 * line], whole[70 * line..]);
    for place in 0..3 {
        let inked = |rows: std::ops::Range<usize>| {
            let columns = place * 60..(place + 1) * 60;
            rows.flat_map(|y| columns.clone().map(move |x| (y * 180 + x) * channels))
                .filter(|&at| labelled[at] < 110)
                .count()
        };
        let middle = 70 + below / 2;
        assert!(inked(70..middle) > 5 && inked(middle..70 + below) > 5, "two lines below tree {place}");
    }

    let said = folder.run(&["sheet", "--group", "Weeds", "-o", "w.png"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("Weeds") && said.err.contains("linden list"), "{}", said.err);
    let said = folder.run(&["sheet", "fir", "--seeds", "900", "-o", "w.png"]);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert_eq!(folder.names(), ["s.png"]);
}

/// What stands at a place of a sheet with pictures of 60 x 70 pixels.
fn picture_at(((wide, high), bytes): &((u32, u32), Vec<u8>), place: usize) -> Vec<u8> {
    let (wide, high) = (*wide as usize, *high as usize);
    let channels = bytes.len() / (wide * high);
    let (left, top) = (place % (wide / 60) * 60, place / (wide / 60) * 70);
    let row = |y: usize| &bytes[(y * wide + left) * channels..][..60 * channels];
    (top..top + 70).flat_map(row).copied().collect()
}

#[test]
fn the_seeds_of_a_sheet_count_on_from_the_one_that_was_asked_for() {
    let folder = Folder::new();
    let sheet = |seed: &[&str]| {
        let words = ["sheet", "fir", "older-shrub", "--seeds", "2", "--columns", "2", "--size", "60x70"];
        folder.run(&[&words[..], seed, &["--labels", "none", "-o", "s.png"]].concat()).done();
        folder.read("s.png")
    };
    let png = sheet(&["--set", "seed=3", "--seed", "5"]);
    let sheet_of_5 = pixels(&png);
    for (place, (id, seed)) in
        [("fir", "5"), ("fir", "6"), ("older-shrub", "5"), ("older-shrub", "6")].iter().enumerate()
    {
        let preview = folder.run(&["preview", id, "--seed", seed, "--size", "60x70", "-o", "-"]).done().bytes;
        assert!(picture_at(&sheet_of_5, place) == pixels(&preview).1, "{id} {seed}");
    }
    assert!(png == sheet(&["--set", "seed=5"]), "the same as the knob");
}

#[test]
fn trees_of_a_sheet_are_in_one_scale_where_that_is_asked_for() {
    let folder = Folder::new();
    for (id, times) in [("low", 1.0), ("high", 4.0)] {
        let [height, radius, step, trunk] = [2.0, 1.0, 0.1, 0.5].map(|metres| metres * times);
        let text = format!(
            "id = \"{id}\"\n[colonization]\ncrown = \"cone\"\ncrown_height = {height:?}\ncrown_radius = {radius:?}\n\
             points = 60\nstep = {step:?}\ntrunk = {trunk:?}\n"
        );
        folder.write(&format!("{id}.toml"), text);
    }
    let sheet = ["sheet", "low.toml", "high.toml", "--columns", "2", "--size", "60x70", "--labels", "none"];
    // Rows in which a tree, and not its ground alone, is seen.
    let rows = |more: &[&str]| {
        folder.run(&[&sheet[..], more, &["-o", "s.png"]].concat()).done();
        let ((wide, high), whole) = pixels(&folder.read("s.png"));
        let channels = whole.len() / (wide * high) as usize;
        let is_inked = |x: usize, y: usize| whole[(y * wide as usize + x) * channels] < 110;
        [0..60, 60..120].map(|columns| (0..70).filter(|&y| columns.clone().any(|x| is_inked(x, y))).count())
    };
    let ([low, high], [low_of_one, high_of_one]) = (rows(&[]), rows(&["--one-scale"]));
    assert!(low.abs_diff(high) < 6, "each fills its picture: {low}, {high}");
    assert!(high_of_one.abs_diff(high) < 6 && 3 * low_of_one < high_of_one, "{low_of_one}, {high_of_one}");
}

#[test]
fn wood_whose_bark_is_described_is_shown_with_it() {
    let folder = Folder::new();
    let draw = |source: &str, more: &[&str]| {
        let words = ["preview", source, "--size", "60x80", "-o", "p.png"];
        assert_eq!(folder.run(&[&words[..], more].concat()).code, Some(0));
        folder.read("p.png")
    };
    let bare = ["--set", "leaf_form=none", "--set", "bark_size=32", "--set", "age=0.2"];
    let surface = [&bare[..], &["--look", "surface"]].concat();
    assert!(draw("silver-birch", &bare) == draw("silver-birch", &surface));
    folder.write("weed.l", "axiom=F\nangle=25.7\nnumber of derivations=3\nF=F[+F]F[-F]F\n");
    assert!(draw("weed.l", &[]) == draw("weed.l", &["--look", "skeleton"]));
}

#[test]
fn flat_drawings_are_pictures_and_svg() {
    let folder = Folder::new();
    // A plane weed of ABOP: every segment is drawn, and its thickness does not vary much.
    let flat = ["preview", "older-a", "--look", "turtle", "--size", "300x360"];
    folder.run(&[&flat[..], &["-o", "flat.png"]].concat()).done();
    let (size, rgb) = pixels(&folder.read("flat.png"));
    assert_eq!((size, rgb.len()), ((300, 360), 300 * 360 * 3), "on paper");
    assert_eq!(rgb[..3], [255; 3]);
    let svg = |args: &[&str]| {
        folder.run(&[&["preview", "older-a", "--size", "300x360", "-o", "a.svg"], args].concat()).done();
        String::from_utf8(folder.read("a.svg")).unwrap()
    };
    let (usual, named) = (svg(&[]), svg(&["--look", "turtle"]));
    assert_eq!(usual, named, "an SVG is a flat drawing");
    assert!(usual.starts_with("<svg xmlns=") && usual.contains("viewBox=\"0 0 300 360\""));
    assert!(usual.contains("<path ") && usual.contains("older-a"), "strokes, and the recipe");
    // Its quotes are letters that XML has for itself.
    let named = ["preview", "older-a", "--set", "derivations=3", "--set", "angle=21.5", "-o"];
    let recipe = |file: &str| {
        folder.run(&[&named[..], &[file]].concat()).done();
        folder.run(&["recipe", file]).done().out
    };
    assert_eq!(recipe("a.svg"), recipe("flat.png"), "the recipe comes back");
    // Other colours are other strokes.
    assert_ne!(usual, svg(&["--color", "order"]));
    for (args, expected) in [
        (&["preview", "older-a", "--look", "surface", "-o", "b.svg"][..], "--look turtle"),
        (&["preview", "fir", "--lod", "1", "-o", "b.svg"], "--lod is a level of the surface"),
        (&["sheet", "older-a", "-o", "b.svg"], "linden preview"),
        (&["preview", "older-a", "-o", "b.svgz"], ".svg"),
    ] {
        let said = folder.run(args);
        assert_eq!(said.code, Some(2), "{args:?}");
        assert!(said.err.contains(expected), "{args:?}: {}", said.err);
    }
    assert_eq!(folder.names(), ["a.svg", "flat.png"]);
}

#[test]
fn previews_have_the_size_and_the_background_that_was_asked_for() {
    let folder = Folder::new();
    folder
        .run(&["preview", "fir", "-o", "fir.png", "--size", "120x90", "--background", "transparent"])
        .done();
    let (size, rgba) = pixels(&folder.read("fir.png"));
    assert_eq!(size, (120, 90));
    let opaque = rgba.chunks(4).filter(|p| p[3] > 200).count();
    assert_eq!(rgba[3], 0, "the corner is empty");
    assert!((50..5000).contains(&opaque), "{opaque} pixels of tree");

    let turned = |yaw: &str| folder.run(&["preview", "fir", "-o", "-", "--yaw", yaw]).done().bytes;
    assert!(turned("0").starts_with(b"\x89PNG"));
    assert_ne!(turned("0"), turned("90"));
    assert_eq!(turned("45"), turned("45"), "the same picture again");
}

#[test]
fn a_preview_shows_what_stands_in_the_way_and_a_tree_alone_where_that_is_asked_for() {
    let folder = Folder::new();
    let draw = |id: &str, more: &[&str]| {
        let drawn = folder
            .run(&[&["preview", id, "--size", "80x96", "--set", "points=300", "-o", "-"], more].concat());
        assert_eq!(drawn.code, Some(0), "{}", drawn.err);
        (drawn.bytes, drawn.err)
    };
    for id in ["around-the-stone", "street-lamp"] {
        for look in ["skeleton", "surface", "turtle"] {
            let [(with, said), (without, _)] =
                [&["--look", look][..], &["--look", look, "--alone"]].map(|more| draw(id, more));
            assert_ne!(with, without, "{id} {look}");
            assert!(!said.contains("--alone"), "{said}");
        }
    }
    let [(with, _), (without, said)] = [&[][..], &["--alone"]].map(|more| draw("fir", more));
    assert_eq!(with, without);
    assert!(said.contains("--alone changes nothing"), "{said}");
}

#[test]
fn a_preview_is_in_the_format_of_its_ending_and_carries_its_recipe() {
    let folder = Folder::new();
    let preview = |file: &str, background: &str| {
        let size = ["--size", "60x70", "--background", background];
        folder.run(&[&["preview", "fir", "--seed", "3", "-o", file][..], &size].concat())
    };
    let read = |file: &str| {
        let found = linden::input::read_picture("", &folder.read(file), &linden::Quiet).unwrap();
        ([found.picture.width(), found.picture.height()], found.picture.rgba().to_vec())
    };
    let opening = |file: &str| folder.read(file)[..12].to_vec();
    for background in ["studio", "transparent"] {
        for file in ["a.png", "a.webp", "a.jpg", "a.JPEG"] {
            let said = preview(file, background);
            assert_eq!(said.code, Some(0), "{file}: {}", said.err);
            let said = said.err;
            let is_white = background == "transparent" && file.to_lowercase().contains("jp");
            assert_eq!(said.contains("the background is white"), is_white, "{file}: {said}");
        }
        let (png, jpeg) = (read("a.png"), read("a.jpg"));
        assert!(png == read("a.webp"), "without loss");
        assert!(opening("a.webp").starts_with(b"RIFF") && opening("a.jpg").starts_with(b"\xff\xd8\xff"));
        assert_eq!(folder.read("a.jpg"), folder.read("a.JPEG"));
        let over_white = |pixel: &[u8]| {
            let alpha = f64::from(pixel[3]) / 255.0;
            [0, 1, 2].map(|i| 255.0 + (f64::from(pixel[i]) - 255.0) * alpha)
        };
        let shown = png.1.chunks(4).flat_map(over_white);
        let off: f64 = shown
            .zip(jpeg.1.chunks(4).flat_map(|p| p[..3].to_vec()))
            .map(|(a, b)| (a - f64::from(b)).abs())
            .sum();
        assert_eq!(png.0, jpeg.0);
        assert!(off / 60.0 / 70.0 / 3.0 < 6.0, "{background}: off by {off}");
    }
    let recipe = folder.run(&["recipe", "a.png"]).done().out;
    assert!(recipe.contains("fir"));
    for file in ["a.jpg", "a.webp"] {
        assert_eq!(folder.run(&["recipe", file]).done().out, recipe, "{file}");
    }
    folder.run(&["sheet", "fir", "--size", "40x40", "--labels", "none", "-o", "sheet.webp"]).done();
    assert_eq!(read("sheet.webp").0, [40, 40]);
}

#[test]
fn a_preview_without_a_file_is_text_of_the_terminals_size() {
    let folder = Folder::new();
    let plain = folder.run(&["preview", "cypress", "--size", "40x20"]).done().out;
    assert!(!plain.contains('\u{1b}'), "no colours in a pipe");
    assert_eq!(plain.lines().count(), 20);
    assert!(plain.lines().all(|line| line.chars().count() <= 40));
    assert!(plain.chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count() > 40, "{plain}");
}

/// Flags of the terminal count before a command and behind it, where they mean something, and are
/// refused by name where they do not.
#[test]
fn flags_of_the_terminal_are_for_the_commands_that_show_pictures() {
    let folder = Folder::new();
    let preview = ["preview", "cypress", "--size", "20x10", "--colors", "256"];
    let shown =
        |before: &[&str], behind: &[&str]| folder.run(&[before, &preview, behind].concat()).done().bytes;
    let halves = shown(&[], &["--graphics", "halves"]);
    assert_eq!(shown(&["--graphics", "halves"], &[]), halves);
    assert_eq!(shown(&["--graphics=braille"], &["--graphics=halves"]), halves, "the nearer one counts");
    let text = String::from_utf8(halves.clone()).unwrap();
    assert!(text.contains('▀') && text.contains("\x1b[38;5;") && !text.contains('▙'), "{text}");
    assert_ne!(shown(&[], &["--graphics", "quadrants"]), halves);
    for (how, begins) in
        [("kitty", "\x1b_Ga=t,f=100"), ("iterm2", "\x1b]1337;File=inline=1"), ("sixel", "\x1bP")]
    {
        let bytes = shown(&["--graphics", how], &[]);
        let text = String::from_utf8_lossy(&bytes);
        // Room for it, the picture, and on from the line below.
        assert!(text.starts_with(&format!("{}\x1b[10A\x1b7{begins}", "\n".repeat(10))), "{text:.60}");
        assert!(text.ends_with("\x1b8\x1b[10B\r"), "{how}");
    }
    let colored = folder.run(&["--colors", "16", "doctor", "--json"]).json();
    let findings = colored["terminal"]["findings"].as_array().unwrap();
    assert!(findings.iter().any(|row| row["why"] == "--colors asks for it"), "{colored}");

    let said = |args: &[&str], fragment: &str| {
        let said = folder.run(args);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{args:?}");
        assert!(said.err.contains(fragment), "{args:?}: {}", said.err);
    };
    said(&["--graphics", "sixel", "list"], "--graphics has no effect here: it is for linden, linden open,");
    said(&["--stats", "export", "fir", "-o", "x.glb"], "--stats has no effect here");
    said(&["--log", "x", "doctor"], "--log has no effect here: it is for linden and linden open");
    said(&["list", "--graphics", "sixel"], "'--graphics'");
    said(&["--graphics", "crayons", "preview", "fir"], "--graphics: 'crayons' is none of kitty");
    said(&["preview", "fir", "-o", "x.png", "--graphics", "sixel"], "no effect on a file");
    assert_eq!(folder.run(&["--memory", "1G", "list"]).done().code, Some(0));
    assert!(folder.names().is_empty());
}
