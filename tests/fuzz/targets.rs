//! What is fed with anything, and what must hold then. A target panics when something does not; it
//! gives a line that says what became of the input (the kind of error, or of success), so that inputs
//! which lead to a new line are worth keeping.

use std::sync::atomic::{AtomicU64, Ordering};

use linden::dress::dress;
use linden::grow::outline;
use linden::grow::{GrowError, grow};
use linden::input::read_picture;
use linden::input::{
    Cloud, TreeColumn, read_e57, read_geotiff, read_grid, read_las, read_obj, read_pcd, read_ply, read_ptx,
    read_xyz, sniff,
};
use linden::lsystem::{Grammar, TurtleSettings, derive_string, forecast, text};
use linden::monitor::Phase;
use linden::preset::{Colonization, KNOBS, Preset, QsmSettings, ScanSettings, Space, builtin_file};
use linden::recipe::{Geometry, Input, Recipe};
use linden::skeleton::{NO_PARENT, Skeleton, SkeletonError};
use linden::surface::topology;
use linden::{Monitor, Quiet};
use linden_exporters::{Bundle, ExportError, Options, REGISTRY};
use linden_lint::{Config, NoFiles, lint, read};
use linden_terminal::input::Parser;

use crate::words;

/// Something that takes bytes from outside.
pub struct Target {
    /// Its folder in the corpus.
    pub name: &'static str,
    /// Runs it once.
    pub run: fn(&[u8]) -> String,
    /// Mutations of the corpus in the ordinary tests: a second or two.
    pub rounds: u64,
    /// What its language is made of: spliced into inputs.
    pub words: &'static [&'static str],
}

/// All of them.
pub const TARGETS: &[Target] = &[
    Target { name: "grammar", run: grammar, rounds: 6000, words: words::GRAMMAR },
    Target { name: "text", run: grammar_file, rounds: 6000, words: words::TEXT },
    Target { name: "preset", run: preset, rounds: 1500, words: words::PRESET },
    Target { name: "recipe", run: recipe, rounds: 1500, words: words::RECIPE },
    Target { name: "parameters", run: parameters, rounds: 3000, words: words::PARAMETERS },
    Target { name: "obj", run: obj, rounds: 3000, words: words::INPUT },
    Target { name: "ply", run: ply, rounds: 3000, words: words::INPUT },
    Target { name: "xyz", run: xyz, rounds: 3000, words: words::INPUT },
    Target { name: "cloud", run: cloud, rounds: 3000, words: words::INPUT },
    Target { name: "usd", run: usd, rounds: 3000, words: words::USD },
    Target { name: "picture", run: picture, rounds: 3000, words: words::PICTURE },
    Target { name: "knob", run: knob, rounds: 6000, words: words::KNOB },
    Target { name: "terminal", run: terminal, rounds: 10_000, words: words::TERMINAL },
    Target { name: "scan", run: scan, rounds: 150, words: words::INPUT },
    Target { name: "tree", run: tree, rounds: 250, words: words::PRESET },
];

impl Target {
    /// Whether whole trees are grown of its inputs.
    pub fn is_grown(&self) -> bool {
        matches!(self.name, "tree" | "scan")
    }
}

/// Cancels after a number of looks: a budget of work that is the same on every machine.
pub struct Budget {
    looks: AtomicU64,
    memory_bytes: u64,
}

impl Budget {
    /// For one input.
    pub fn new(looks: u64, memory_bytes: u64) -> Self {
        Self { looks: AtomicU64::new(looks), memory_bytes }
    }
}

impl Monitor for Budget {
    fn is_cancelled(&self) -> bool {
        self.looks.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.memory_bytes
    }
}

/// An error as people would see it: one screen of printable text.
fn said(error: &impl std::fmt::Display) -> String {
    let text = error.to_string();
    assert!(!text.trim().is_empty(), "an error that says nothing");
    let hidden = |c: char| {
        c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
    };
    assert!(!text.chars().any(hidden), "an error that could drive the terminal: {text:?}");
    assert!(
        text.len() < 4000,
        "an error of {} bytes: {}…",
        text.len(),
        &text.chars().take(200).collect::<String>()
    );
    text
}

/// Texts that are not UTF-8 are refused before anything is parsed.
fn utf8(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes)
        .unwrap_or_else(|error| std::str::from_utf8(&bytes[..error.valid_up_to()]).unwrap_or_default())
}

/// An axiom, and a rule a line.
fn grammar(bytes: &[u8]) -> String {
    let mut lines = utf8(bytes).split('\n');
    let axiom = lines.next().unwrap_or_default();
    let rules: Vec<&str> = lines.collect();
    match Grammar::new(axiom, &rules) {
        Ok(grammar) => sound_grammar(&grammar),
        Err(error) => {
            assert!(error.column >= 1);
            said(&error)
        }
    }
}

fn sound_grammar(grammar: &Grammar) -> String {
    let written = text::write_grammar(grammar);
    let again = text::parse_grammar(&written).map_err(|error| error.to_string());
    assert_eq!(again.as_ref(), Ok(grammar), "written as {written:?}");
    for derivations in [0, 1, 7, 10_000] {
        let forecast = forecast(grammar, derivations).expect("these are allowed");
        assert!(forecast.segments <= forecast.symbols || !forecast.exact, "{forecast:?}");
    }
    let settings = TurtleSettings { derivations: 3, symbol_limit: 20_000, ..TurtleSettings::default() };
    let derived = match derive_string(grammar, &settings) {
        Ok(string) => {
            let expected = forecast(grammar, 3).expect("three are allowed");
            format!("{} {}", expected.exact, string.len().min(9))
        }
        Err(error) => said(&error),
    };
    match linden::lsystem::grow(grammar, &settings, &Budget::new(1000, 64 << 20)) {
        Ok(grown) => assert_eq!(
            grown
                .branching
                .validate()
                .map_err(|e| e.to_string())
                .err()
                .filter(|e| !e.contains("at least one segment")),
            None
        ),
        Err(error) => drop(said(&error)),
    }
    derived
}

/// The older text format, and the same with rules alone.
fn grammar_file(bytes: &[u8]) -> String {
    let source = utf8(bytes);
    if let Ok(grammar) = text::parse_grammar(source) {
        sound_grammar(&grammar);
    }
    match text::parse(source) {
        Ok(document) => sound_grammar(&document.grammar),
        Err(error) => {
            assert!(error.line >= 1 && error.column >= 1);
            said(&error)
        }
    }
}

fn preset(bytes: &[u8]) -> String {
    match Preset::from_toml(utf8(bytes)) {
        Ok(preset) => sound_preset(preset),
        Err(fault) => said(&fault),
    }
}

fn recipe(bytes: &[u8]) -> String {
    match Preset::from_json(utf8(bytes)) {
        Ok(preset) => sound_preset(preset),
        Err(fault) => said(&fault),
    }
}

/// Parameters of Arbaro, Sapling and tree-gen.
fn parameters(bytes: &[u8]) -> String {
    match Preset::of_tree_parameters("tree", utf8(bytes)) {
        Ok((preset, notes)) => {
            for note in &notes {
                said(note);
            }
            let settings = preset.settings::<linden::preset::WeberPenn>().expect("that is how it grows");
            let expected = linden::weber_penn::forecast(settings);
            assert!(expected.nodes() >= 0.0 && expected.leaves() >= 0.0, "{expected:?}");
            sound_preset(preset)
        }
        Err(fault) => said(&fault),
    }
}

/// What a preset is written as gives it back. A dimension that is not set and one that is set to its
/// default are the same: so what is written is compared, and the knobs.
fn sound_preset(preset: Preset) -> String {
    let toml = preset.to_toml().expect("a preset can be written");
    let knobs = |preset: &Preset| -> Vec<_> {
        preset.knobs().into_iter().map(|(knob, value)| (knob.knob.name, value)).collect()
    };
    for (knob, value) in preset.knobs() {
        assert_eq!(knob.knob.kind.check(&value), Ok(()), "{}", knob.knob.name);
    }
    let id = preset.grows_by().id().to_owned();
    let turned = knobs(&preset);
    let line = Recipe::new(preset).to_line();
    assert!(line.bytes().all(|byte| (b' '..=b'~').contains(&byte)), "{line:?}");
    for (written, again) in [(&toml, Preset::from_toml(&toml)), (&line, Preset::from_json(&line))] {
        let again = again.unwrap_or_else(|fault| panic!("{fault}, written as {written}"));
        assert_eq!(knobs(&again), turned, "written as {written}");
        assert_eq!(again.to_toml().as_ref(), Ok(&toml));
        assert_eq!(Recipe::new(again).to_line(), line);
    }
    id
}

/// Meshes as text.
fn obj(bytes: &[u8]) -> String {
    match read_obj(bytes, &reading()) {
        Ok(mesh) => sound_mesh(&mesh.positions, &mesh.triangles),
        Err(error) => drop(said(&error)),
    }
    told_by_content(bytes)
}

/// Meshes and points, as text and binary.
fn ply(bytes: &[u8]) -> String {
    match read_ply(bytes, &reading()) {
        Ok(data) => {
            sound_mesh(&data.positions, &data.faces);
            sound_trees(&data.trees, data.positions.len());
        }
        Err(error) => drop(said(&error)),
    }
    told_by_content(bytes)
}

/// Points as text.
fn xyz(bytes: &[u8]) -> String {
    match read_xyz(bytes, &reading()) {
        Ok(cloud) => sound_cloud(&cloud),
        Err(error) => drop(said(&error)),
    }
    told_by_content(bytes)
}

/// Finite points, and the number of a tree for each.
fn sound_cloud(cloud: &Cloud) {
    sound_mesh(&cloud.positions, &[]);
    sound_trees(&cloud.trees, cloud.positions.len());
}

fn sound_trees(trees: &[TreeColumn], count: usize) {
    assert!(trees.iter().all(|column| column.numbers.len() == count));
}

/// Points of scanners and surveys: the first byte of what a file opens with says of which format.
fn cloud(bytes: &[u8]) -> String {
    let cloud = match bytes.first() {
        Some(b'L') => read_las(bytes, &reading()),
        Some(b'A') => read_e57(bytes, &reading()),
        Some(b'#') => read_pcd(bytes, &reading()),
        Some(b'n') => read_grid(bytes, &reading()),
        Some(b'I' | b'M') => read_geotiff(bytes, &reading()),
        _ => read_ptx(bytes, &reading()),
    };
    match cloud {
        Ok(cloud) => sound_cloud(&cloud),
        Err(error) => drop(said(&error)),
    }
    told_by_content(bytes)
}

/// Layers that are looked at for faults, text and binary, and packages of them.
fn usd(bytes: &[u8]) -> String {
    match read("tree.usdz", bytes, &NoFiles, &Budget::new(u64::MAX, 64 << 20)) {
        Ok(asset) => {
            for mesh in &asset.meshes {
                let geometry = mesh.geometry.as_ref().expect("USD has geometry");
                let count = geometry.positions.len();
                assert!(geometry.triangles.iter().flatten().all(|&corner| (corner as usize) < count));
            }
            let report = lint(&asset, &Config::default());
            for finding in &report.findings {
                said(&finding.message);
            }
            format!("{} findings", report.findings.len().min(9))
        }
        Err(error) => said(&error),
    }
}

/// Pictures of leaves and bark. What has no mark of another format is read as TGA.
fn picture(bytes: &[u8]) -> String {
    match read_picture("leaf.tga", bytes, &Budget::new(10_000, PICTURE_BYTES)) {
        Ok(found) => {
            let (width, height) = (found.picture.width(), found.picture.height());
            assert_eq!(found.picture.rgba().len() as u64, u64::from(width) * u64::from(height) * 4);
            let written = found.picture.png().expect("what was read can be written");
            let again = read_picture("", written, &Quiet).expect("what was written can be read");
            assert_eq!((again.picture.rgba(), again.has_alpha), (found.picture.rgba(), found.has_alpha));
            format!("a picture, {}", found.has_alpha)
        }
        Err(error) => said(&error),
    }
}

/// The most that a picture may hold: what is written again comes on top.
const PICTURE_BYTES: u64 = 4 << 20;

/// What reading an input may take.
fn reading() -> Budget {
    Budget::new(10_000, 256 << 20)
}

/// An input whose kind nothing but its content tells.
fn told_by_content(bytes: &[u8]) -> String {
    if let Err(error) = sniff(bytes, "tree.any") {
        said(&error);
    }
    match Input::read("tree.any", bytes, &reading()) {
        Ok(input) => match input.geometry {
            Geometry::Mesh(_) => "mesh",
            Geometry::Points(_) => "points",
            Geometry::Cylinders(_) => "cylinders",
            Geometry::Picture(_) => "picture",
        }
        .to_owned(),
        Err(error) => said(&error),
    }
}

fn sound_mesh(positions: &[linden::DVec3], triangles: &[[u32; 3]]) {
    assert!(positions.iter().all(|p| p.is_finite()));
    assert!(triangles.iter().flatten().all(|&corner| (corner as usize) < positions.len()));
}

/// The value of each knob.
fn knob(bytes: &[u8]) -> String {
    let text = utf8(bytes);
    let mut taken = 0;
    for knob in KNOBS.iter().copied() {
        let kind = knob.knob.kind;
        match kind.parse(text) {
            Ok(value) => {
                taken += 1;
                assert_eq!(kind.check(&value), Ok(()), "{} = {text:?}", knob.knob.name);
                let shown = value.to_string();
                assert_eq!(
                    kind.parse(&shown),
                    Ok(value),
                    "{} = {text:?}, shown as {shown:?}",
                    knob.knob.name
                );
            }
            Err(problem) => drop(said(&problem)),
        }
    }
    format!("{taken} take it")
}

/// What a terminal says: the same events whichever way the bytes are cut.
fn terminal(bytes: &[u8]) -> String {
    let (mut whole, mut cut) = (Vec::new(), Vec::new());
    let mut parser = Parser::default();
    parser.feed(bytes, &mut whole);
    parser.flush(&mut whole);
    assert!(!parser.is_pending(), "nothing is pending after a silence");
    let mut parser = Parser::default();
    for piece in bytes.chunks(3) {
        parser.feed(piece, &mut cut);
    }
    parser.flush(&mut cut);
    assert_eq!(whole, cut);
    assert!(whole.len() <= 2 * bytes.len() + 1, "{} events of {} bytes", whole.len(), bytes.len());
    whole.first().map(|event| format!("{event:?}").chars().take(12).collect()).unwrap_or_default()
}

/// A whole recipe under small limits: document, tree, surface, files.
fn tree(bytes: &[u8]) -> String {
    match Preset::from_toml(utf8(bytes)) {
        Ok(preset) => grown(preset),
        Err(fault) => said(&fault),
    }
}

/// Points as from a scanner, or a crown's envelope, and the tree that grows in it.
fn scan(bytes: &[u8]) -> String {
    const FILE: &str = "scan.any";
    let input = match Input::read(FILE, bytes, &reading()) {
        Ok(input) => input,
        Err(error) => return said(&error),
    };
    let preset = within_limits(match input.geometry {
        Geometry::Points(_) => Preset::of("scan", ScanSettings::of(FILE)),
        Geometry::Mesh(_) => Preset::of("scan", Colonization::of(Space::Envelope { file: FILE.to_owned() })),
        Geometry::Cylinders(_) => Preset::of("scan", QsmSettings::of(FILE)),
        Geometry::Picture(_) => return "picture".to_owned(),
    });
    planted(&Recipe::with_files(preset, [(FILE, input)].into_iter().collect()))
}

/// The most that a whole recipe may hold.
pub const TREE_BYTES: u64 = 48 << 20;

/// The same, small.
fn within_limits(mut preset: Preset) -> Preset {
    for (name, most) in [
        ("symbol_limit", 20_000),
        ("points", 1500),
        ("max_nodes", 3000),
        ("max_iterations", 400),
        ("bark_size", 32),
        ("sides", 12),
    ] {
        let above = preset.knobs().iter().any(|(knob, value)| {
            knob.knob.name == name && value.to_string().parse().is_ok_and(|now: f64| now > f64::from(most))
        });
        if above {
            preset.set(name, &most.to_string()).expect("the limits are in the ranges");
        }
    }
    preset
}

fn grown(preset: Preset) -> String {
    let preset = within_limits(preset);
    // Whatever file a document names, there is none but the built-in presets' own.
    let heart = builtin_file("heart.obj").unwrap_or_default();
    let read = |file: &str| Input::read(file, builtin_file(file).unwrap_or(heart), &Quiet).ok();
    let inputs = preset.files().into_iter().filter_map(|file| Some((file, read(file)?))).collect();
    planted(&Recipe::with_files(preset, inputs))
}

/// Grows a recipe, gives it its surface, and writes it in every format.
fn planted(recipe: &Recipe) -> String {
    let budget = Budget::new(100_000, TREE_BYTES);
    if let Err(error) = outline(recipe, &budget) {
        said(&error);
    }
    let grown = match grow(recipe, &budget) {
        Ok(grown) => grown,
        Err(error) => {
            let is_ours =
                matches!(&error, GrowError::Skeleton(wrong) if !matches!(wrong, SkeletonError::Empty));
            assert!(!is_ours, "a generator gave no tree: {error}");
            return said(&error);
        }
    };
    for note in &grown.notes {
        said(note);
    }
    sound_skeleton(&grown.skeleton);
    let scene = match dress(recipe, &grown, &budget) {
        Ok(scene) => scene,
        Err(error) => return said(&error),
    };
    for part in &scene.parts {
        let found = topology(&part.mesh, &Quiet).expect("nobody cancels");
        assert_eq!(found.not_finite, 0, "part {}: {found:?}", part.name);
        // Wood in parts is open where bark of one kind meets that of another.
        let is_whole =
            part.name == "wood" && !scene.parts.iter().any(|other| other.name.starts_with("wood_"));
        assert!(!is_whole || found.open_edges == 0, "the wood is open: {found:?}");
    }
    for exporter in REGISTRY {
        let mut bundle = Bundle::stream("memory", std::io::sink());
        let options = Options::new(exporter.format());
        match exporter.write(&linden::stage::Stage::of(&scene), &options, &mut bundle, &budget) {
            Ok(()) => {}
            Err(error @ ExportError::Scene { .. }) => panic!("{}: {error}", exporter.format().id),
            Err(error) => drop(said(&error)),
        }
    }
    format!("{} axes of {}", scene.skeleton.axes.len().min(3), recipe.preset.grows_by().id())
}

/// Parents before children, every node in one axis, radii above zero.
fn sound_skeleton(skeleton: &Skeleton) {
    let nodes = skeleton.positions.len();
    assert!(skeleton.positions.iter().all(|p| p.is_finite()));
    assert!(skeleton.radii.iter().all(|radius| radius.is_finite() && *radius >= 0.0), "radii");
    for (node, &parent) in skeleton.parents.iter().enumerate() {
        assert!(parent == NO_PARENT || (parent as usize) < node);
    }
    let mut seen = vec![false; nodes];
    for axis in &skeleton.axes {
        for &node in skeleton.nodes_of(axis) {
            assert!(!std::mem::replace(&mut seen[node as usize], true), "node {node} stands in two axes");
        }
    }
    assert!(seen.iter().all(|seen| *seen), "a node stands in no axis");
}
