//! Pictures: each says what it was drawn from, so that one that is out of date is found without drawing it.
//!
//! `presets/pictures/list.txt` has the pictures and the commands that draw them. `presets/pictures/drawn.txt`
//! has, for each, a hash of what it was drawn from and a hash of the picture. Drawn from: the command, the
//! documents of its trees, the trees themselves, and a few small pictures, which are drawn here and stand for
//! the code that draws. `presets/pictures/draw` and `presets/pictures/workbench` bring pictures and hashes up
//! to date.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use linden::Quiet;
use linden::dress::dress;
use linden::forest::{TreeSource, builtin_forest};
use linden::grow::grow;
use linden::preset::{Builtin, KNOBS, Preset, builtins};
use linden::recipe::Recipe;
use linden_raster::drawing::label::Label;
use linden_raster::{Camera, Size, Style, Surface, draw_flat, draw_skeleton, draw_surface};
use linden_tests::presets::recipe;
use xxhash_rust::xxh3::xxh3_128;

use crate::{read, root};

const DRAWN: &str = "presets/pictures/drawn.txt";
const FILM: &str = "presets/pictures/workbench-film.png";
const WORKBENCH: &str = "presets/pictures/workbench.png";

/// Options of `linden preview` and `linden sheet` that take no value.
const FLAGS: [&str; 3] = ["--outline", "--points", "--person"];

fn hash(bytes: &[u8]) -> String {
    format!("{:032x}", xxh3_128(bytes))
}

/// A text with the line ends that it has in the repository.
fn unix(text: &str) -> String {
    text.replace("\r\n", "\n")
}

/// The pictures and the commands that draw them.
fn list() -> Vec<(String, String)> {
    let text = read("presets/pictures/list.txt");
    let mut all = Vec::new();
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (path, command) = line.split_once(' ').unwrap_or_else(|| panic!("no command: {line}"));
        if path.contains("{id}") {
            all.extend(
                builtins()
                    .iter()
                    .map(|builtin| (path.replace("{id}", builtin.id), command.replace("{id}", builtin.id))),
            );
        } else {
            all.push((path.to_owned(), command.to_owned()));
        }
    }
    all
}

/// What a command draws.
#[derive(Debug, Default, PartialEq)]
struct Drawing {
    sources: Vec<String>,
    sets: Vec<(String, String)>,
    groups: Vec<String>,
}

fn drawing(command: &str) -> Drawing {
    let mut drawing = Drawing::default();
    let mut words = command.split_whitespace().skip(1);
    while let Some(word) = words.next() {
        if FLAGS.contains(&word) {
            continue;
        }
        if !word.starts_with('-') {
            drawing.sources.push(word.to_owned());
            continue;
        }
        let value = words.next().unwrap_or_else(|| panic!("{word} without a value: {command}"));
        match word {
            "--set" => {
                let (name, value) = value.split_once('=').unwrap();
                drawing.sets.push((name.to_owned(), value.to_owned()));
            }
            "--group" => drawing.groups.push(value.to_lowercase()),
            _ => {}
        }
    }
    drawing
}

/// The trees of the built-in presets, as the tests of the presets keep them.
fn golden() -> BTreeMap<String, String> {
    let text = read("tests/presets/trees.txt");
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.map(|row| (row.split(' ').next().unwrap_or_default().to_owned(), row.to_owned())).collect()
}

/// Grows a tree with knobs turned: its hash.
fn tree(mut recipe: Recipe, sets: &[(String, String)]) -> String {
    for (name, value) in sets {
        recipe.preset.set(name, value).unwrap_or_else(|error| panic!("{name}={value}: {error}"));
    }
    format!("{:032x}", grow(&recipe, &Quiet).unwrap().skeleton.hash())
}

/// Whether a knob leaves the wood as it is.
fn covers(name: &str) -> bool {
    KNOBS.iter().any(|knob| knob.knob.name == name && knob.section.covers())
}

/// What a command's picture is drawn from.
fn origin(command: &str, code: &str, golden: &BTreeMap<String, String>) -> String {
    let drawing = drawing(command);
    let mut from = format!("{command}\n{code}\n");
    let grown = drawing.sets.iter().any(|(name, _)| !covers(name));
    let mut add = |builtin: &Builtin| {
        from += &unix(builtin.text);
        from += &if grown { tree(recipe(builtin), &drawing.sets) } else { golden[builtin.id].clone() };
    };
    for group in &drawing.groups {
        let of_group =
            builtins().iter().filter(|builtin| builtin.load().unwrap().group.to_lowercase() == *group);
        let before = of_group.map(&mut add).count();
        assert!(before > 0, "no preset is in the group {group}");
    }
    for source in &drawing.sources {
        if let Some(builtin) = builtins().iter().find(|builtin| builtin.id == *source) {
            add(builtin);
        }
    }
    let forests: Vec<_> = drawing.sources.iter().filter_map(|source| builtin_forest(source).ok()).collect();
    for forest in &forests {
        for tree in forest.load().unwrap().trees {
            let TreeSource::Named(id) = tree.source else { panic!("{} carries a recipe", forest.id) };
            add(builtins().iter().find(|builtin| builtin.id == id).unwrap());
        }
    }
    from.extend(forests.iter().map(|forest| unix(forest.text)));
    for source in drawing.sources.iter().filter(|source| source.contains('/')) {
        let text = unix(&read(source));
        let recipe =
            Recipe::new(Preset::from_toml(&text).unwrap_or_else(|fault| panic!("{source}: {fault}")));
        from += &text;
        from += &tree(recipe, &drawing.sets);
    }
    hash(from.as_bytes())
}

/// Small pictures of trees, leaves, organs, each kind of bark, a flat drawing and its label: another hash, and the code draws otherwise.
fn code() -> String {
    let mut said = String::new();
    let size = Size::new(40, 48).unwrap();
    let small = |id: &str, sets: &[(&str, &str)]| {
        let mut recipe = recipe(builtins().iter().find(|builtin| builtin.id == id).unwrap());
        for (name, value) in [("leaf_size", "32"), ("bark_size", "32")].iter().chain(sets) {
            recipe.preset.set(name, value).unwrap();
        }
        recipe
    };
    let barks = ["ridged", "smooth", "plated", "birch", "peeling", "palm"];
    let barks = barks.map(|bark| small("older-spatial", &[("bark", bark), ("base_radius", "0.4")]));
    let leaves = [small("sunflower", &[]), small("male-fern", &[]), small("dressed-simple", &[])];
    for recipe in barks.into_iter().chain(leaves) {
        let grown = grow(&recipe, &Quiet).unwrap();
        let scene = dress(&recipe, &grown, &Quiet).unwrap();
        let drawn =
            draw_surface(&Surface::from(&scene), &Camera::default(), &Style::studio(), size, &Quiet).unwrap();
        writeln!(said, "{}", hash(drawn.rgba())).unwrap();
    }
    let recipe = small("abop-flower", &[]);
    let grown = grow(&recipe, &Quiet).unwrap();
    let style = Style { organs: Some(&grown.organs), ..Style::studio() };
    let drawn = draw_skeleton(&grown.skeleton, &Camera::default(), &style, size, &Quiet).unwrap();
    writeln!(said, "{}", hash(drawn.rgba())).unwrap();
    let style = Style { organs: Some(&grown.organs), ..Style::paper() };
    let flat = draw_flat(&grown.skeleton, &Camera::default(), &style, size, &Quiet).unwrap();
    let label = Label { lines: vec!["Flower".to_owned()], height: 6.0, color: style.ink };
    writeln!(said, "{}", hash(label.below(&flat, Label::rows(1, 6.0), [255; 3]).rgba())).unwrap();
    said
}

/// What the picture of the workbench is drawn from: the script, the presets in the list, its first tree, and
/// the list as the workbench's tests keep it.
fn workbench(code: &str, golden: &BTreeMap<String, String>) -> String {
    let folder = root().join("src/app/tui/snapshots");
    let list = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let list = list.into_iter().find(|path| path.to_string_lossy().ends_with("__the_list.snap")).unwrap();
    let list = unix(&std::fs::read_to_string(list).unwrap());
    // Behind the head, which names the test.
    let view = list.splitn(3, "---\n").last().unwrap_or_default();
    let script = unix(&read("presets/pictures/workbench"));
    let mut from = format!("{script}\n{code}\n{view}\n{}\n", golden["oak"]);
    for builtin in builtins() {
        let preset = builtin.load().unwrap();
        writeln!(from, "{} {} {}", preset.group, preset.id, preset.name).unwrap();
    }
    hash(from.as_bytes())
}

fn hash_of_picture(path: &str) -> String {
    std::fs::read(root().join(path)).map_or_else(|_| "missing".to_owned(), |bytes| hash(&bytes))
}

#[test]
fn pictures_show_what_the_program_draws() {
    let (code, golden) = (code(), golden());
    let mut now: Vec<(String, String)> =
        list().into_iter().map(|(path, command)| (path, origin(&command, &code, &golden))).collect();
    now.push((WORKBENCH.to_owned(), workbench(&code, &golden)));
    // The scripts say what they have drawn: pictures whose path begins with this.
    let drawn_now = std::env::var("LINDEN_DRAWN").ok();
    let text = read(DRAWN);
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    let then: BTreeMap<&str, (&str, &str)> = rows
        .filter_map(|row| {
            let mut words = row.split(' ');
            Some((words.next()?, (words.next()?, words.next()?)))
        })
        .collect();
    let mut page =
        "# Picture, hash of what it was drawn from, hash of the picture: see tests/docs/pictures.rs.\n"
            .to_owned();
    let mut old = Vec::new();
    for (path, from) in &now {
        let (mut row, shown) = (then.get(path.as_str()).copied().unwrap_or(("", "")), hash_of_picture(path));
        if drawn_now.as_ref().is_some_and(|begin| path.starts_with(begin.as_str())) {
            row = (from, &shown);
        }
        if row != (from.as_str(), shown.as_str()) {
            let why = if row.0 == from { "is not the one that was drawn" } else { "is out of date" };
            old.push(format!("{path} {why}"));
        }
        writeln!(page, "{path} {} {}", row.0, row.1).unwrap();
    }
    if drawn_now.is_some() {
        std::fs::write(root().join(DRAWN), page).unwrap();
    } else {
        assert_eq!(then.len(), now.len(), "pictures came or went: presets/pictures/draw");
    }
    assert!(
        old.is_empty(),
        "presets/pictures/draw (or presets/pictures/workbench) draws them again:\n{}",
        old.join("\n")
    );
}

#[test]
fn pictures_in_documents_are_drawn_by_a_script() {
    // Rendered with Blender: tests/render. Filmed in a terminal: presets/pictures/film.
    let rendered = ["presets/pictures/plants-cycles.png", "presets/pictures/cycles.png", WORKBENCH, FILM];
    let drawn: Vec<String> = list().into_iter().map(|(path, _)| path).collect();
    for folder in
        ["presets/pictures", "presets/pictures/gallery", "presets/pictures/seasons", "docs/pictures"]
    {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().to_string_lossy().into_owned();
            let path = format!("{folder}/{name}");
            let is_picture = Path::new(&name).extension().is_some_and(|ending| ending == "png");
            let is_known = drawn.contains(&path) || rendered.contains(&path.as_str());
            assert!(!is_picture || is_known, "{path} is in no line of presets/pictures/list.txt");
        }
    }
}

#[test]
fn another_tree_or_command_is_another_origin() {
    let golden = golden();
    let origin = |command: &str, code: &str| origin(command, code, &golden);
    let fir = origin("preview simple --set kill=3D --size 2x2", "a");
    assert_eq!(fir, origin("preview simple --set kill=3D --size 2x2", "a"));
    assert_ne!(fir, origin("preview simple --set kill=4D --size 2x2", "a"));
    assert_ne!(fir, origin("preview simple --set kill=3D --size 2x2", "b"));
    let mut other = self::golden();
    other.insert("simple".to_owned(), "simple 1 1 0".to_owned());
    assert_ne!(origin("preview simple", "a"), self::origin("preview simple", "a", &other));
    assert_eq!(drawing("sheet --group plants x --outline").sources, ["x"]);
}
