//! What is fed with anything, and what must hold then. A target panics when something does not; it
//! gives a line that says what became of the input (the kind of error, or of success), so that inputs
//! which lead to a new line are worth keeping.

use std::sync::atomic::{AtomicU64, Ordering};

use linden::colonization::outline;
use linden::dress::dress;
use linden::grow::{GrowError, grow};
use linden::input::{read_obj, read_ply, read_xyz, sniff};
use linden::lsystem::{Grammar, Settings, derive_string, forecast, text};
use linden::monitor::Phase;
use linden::preset::{KNOBS, Preset, builtin_file, shape_knobs};
use linden::recipe::{Geometry, Input, Recipe};
use linden::skeleton::{NO_PARENT, Skeleton, SkeletonError};
use linden::surface::topology;
use linden::{Monitor, Quiet};
use linden_exporters::{Bundle, ExportError, Options, REGISTRY};
use linden_terminal::input::Parser;

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
    Target { name: "grammar", run: grammar, rounds: 6000, words: GRAMMAR },
    Target { name: "text", run: grammar_file, rounds: 6000, words: TEXT },
    Target { name: "preset", run: preset, rounds: 1500, words: PRESET },
    Target { name: "recipe", run: recipe, rounds: 1500, words: RECIPE },
    Target { name: "input", run: input, rounds: 6000, words: INPUT },
    Target { name: "knob", run: knob, rounds: 6000, words: KNOB },
    Target { name: "terminal", run: terminal, rounds: 10_000, words: TERMINAL },
    Target { name: "tree", run: tree, rounds: 250, words: PRESET },
];

const GRAMMAR: &[&str] = &[
    "->",
    "→",
    "=",
    "F",
    "G",
    "f",
    "+",
    "-",
    "&",
    "^",
    "\\",
    "/",
    "|",
    "$",
    "[",
    "]",
    "%",
    "!",
    "'",
    "(",
    ")",
    "(90)",
    "(-1e308)",
    "(0.5)",
    "<",
    ">",
    ":",
    "#define r 0.9",
    "#ignore",
    "*",
    "{",
    "}",
    ".",
    "~L",
    ",",
    "A(x,y)",
    "x/y",
    "x^y",
    "&&",
    "||",
    "==",
    "!=",
    "<=",
    ">=",
    "sqrt(",
    "random(",
    "\n",
    "\t",
    " ",
    "é",
    "\u{202e}",
    "1e999",
    "NaN",
];
const TEXT: &[&str] = &[
    "axiom=",
    "angle=",
    "number of derivations=",
    "F=",
    "F=(0.5)",
    "\n",
    "\r\n",
    "=",
    "90",
    "-360",
    "1e9",
    "10000",
    "99999999999",
    "#",
    "//",
    "[",
    "]",
    "+",
    "-",
    "F",
    "(0.3333)",
    "é",
    "\u{feff}",
];
const PRESET: &[&str] = &[
    "[lsystem]\n",
    "[colonization]\n",
    "[wood]\n",
    "[surface]\n",
    "[bark]\n",
    "[[colonization.part]]\n",
    "axiom = ",
    "rules = [",
    "]\n",
    "id = \"x\"\n",
    "seed = ",
    "18446744073709551615",
    "-1",
    "1e308",
    "nan",
    "inf",
    "-inf",
    "\"auto\"",
    "\"17D\"",
    "true",
    "false",
    "\"#0a80ff\"",
    "[0, 0, 0]",
    "[[0, 1], [1, 0]]",
    "\"none\"",
    "crown = \"",
    "envelope = \"heart.obj\"\n",
    "scan = \"heart.obj\"\n",
    "0x10",
    "1979-05-27",
    "'''",
    "\"\"\"",
    "\\u001b",
    "\n",
    "=",
    ".",
    ",",
];
const RECIPE: &[&str] = &[
    "{",
    "}",
    "[",
    "]",
    ":",
    ",",
    "\"",
    "\"lsystem\":{",
    "\"colonization\":{",
    "\"id\":\"x\"",
    "\"seed\":",
    "1e999",
    "-0",
    "null",
    "true",
    "18446744073709551616",
    "\"\\ud800\"",
    "\"\\u001b[2J\"",
    "\"input\":{",
    "\"linden\":\"0.1.0\"",
    "0.30000000000000004",
];
const INPUT: &[&str] = &[
    "ply\n",
    "format ascii 1.0\n",
    "format binary_little_endian 1.0\n",
    "format binary_big_endian 1.0\n",
    "element vertex 3\n",
    "element face 1\n",
    "element vertex 4294967295\n",
    "element vertex 18446744073709551615\n",
    "property float x\n",
    "property double z\n",
    "property list uchar int vertex_indices\n",
    "property list uint uint vertex_index\n",
    "end_header\n",
    "comment ",
    "v 0 0 0\n",
    "f 1 2 3\n",
    "f -1 -2 -3\n",
    "f 1/1/1 2//2 3\n",
    "f 99999999999 0 1\n",
    "1 2 3\n",
    "1e308,2;3\n",
    "nan",
    "inf",
    "-",
    "e",
    "\r",
    "\r\n",
    "\u{0}",
    "#",
    "//",
    "\u{feff}",
    "\\\n",
    "obj",
    "o x\n",
    "vn 0 1 0\n",
    "vt 0 0\n",
];
const KNOB: &[&str] = &[
    "auto",
    "inf",
    "-inf",
    "nan",
    "17D",
    "0D",
    "1e308D",
    "none",
    "true",
    "false",
    "#0a80ff",
    "#0A80FFF",
    "#é",
    "0,1,2",
    "0,1; 1,0",
    ";",
    ",",
    " ",
    "\n",
    "e",
    "18446744073709551615",
    "18446744073709551616",
    "-0",
    "0x1p3",
    "1_000",
    "٣",
];
const TERMINAL: &[&str] = &[
    "\x1b[",
    "\x1bO",
    "\x1b]",
    "\x1bP",
    "\x1b_G",
    "\x1b\\",
    "\x07",
    "\x1b\x1b",
    "\x1b[200~",
    "\x1b[201~",
    "\x1b[<0;1;1M",
    "\x1b[<64;99999;99999m",
    "\x1b[M   ",
    "\x1b[?62;4c",
    "\x1b[4;600;800t",
    "\x1b[6;20;10t",
    "\x1b]11;rgb:ffff/0000/8080\x1b\\",
    "\x1bP>|xterm(390)\x1b\\",
    "\x1bP1$r0m\x1b\\",
    "\x1b_Gi=31;OK\x1b\\",
    "\x1b[97;5u",
    "\x1b[1;5A",
    "\x1b[18446744073709551616;1R",
    "q",
    "é",
    "\u{1f333}",
    ";",
    ":",
    "?",
    "$y",
    "\x18",
    "\x1a",
    "\x00",
    "\x7f",
    "\x1b[I",
    "\x1b[O",
];

/// Cancels after so many looks: a budget of work that is the same on every machine.
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
    let settings = Settings { derivations: 3, symbol_limit: 20_000, ..Settings::default() };
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
        Ok(own) => sound_grammar(&own.grammar),
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
    let id = preset.generator.id().to_owned();
    let own_knobs = knobs(&preset);
    let line = Recipe::new(preset).to_line();
    assert!(line.bytes().all(|byte| (b' '..=b'~').contains(&byte)), "{line:?}");
    for (written, again) in [(&toml, Preset::from_toml(&toml)), (&line, Preset::from_json(&line))] {
        let again = again.unwrap_or_else(|fault| panic!("{fault}, written as {written}"));
        assert_eq!(knobs(&again), own_knobs, "written as {written}");
        assert_eq!(again.to_toml().as_ref(), Ok(&toml));
        assert_eq!(Recipe::new(again).to_line(), line);
    }
    id
}

/// Meshes and points, by every reader.
fn input(bytes: &[u8]) -> String {
    let budget = || Budget::new(10_000, 256 << 20);
    if let Err(error) = sniff(bytes, "tree.any") {
        said(&error);
    }
    match read_obj(bytes, &budget()) {
        Ok(mesh) => sound_mesh(&mesh.positions, &mesh.triangles),
        Err(error) => drop(said(&error)),
    }
    match read_ply(bytes, &budget()) {
        Ok(data) => sound_mesh(&data.positions, &data.faces),
        Err(error) => drop(said(&error)),
    }
    match read_xyz(bytes, &budget()) {
        Ok(points) => sound_mesh(&points, &[]),
        Err(error) => drop(said(&error)),
    }
    match Input::read("tree.any", bytes, &budget()) {
        Ok(input) => match input.geometry {
            Geometry::Mesh(_) => "mesh",
            Geometry::Points(_) => "points",
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
    for knob in KNOBS.iter().copied().chain(shape_knobs()) {
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

/// The most that a whole recipe may hold.
pub const TREE_BYTES: u64 = 48 << 20;

fn grown(mut preset: Preset) -> String {
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
    // Whatever file a document names, there is none but the built-in presets' own.
    let heart = builtin_file("heart.obj").unwrap_or_default();
    let read = |file: &str| Input::read(file, builtin_file(file).unwrap_or(heart), &Quiet).ok();
    let inputs = preset.files().into_iter().filter_map(|file| Some((file, read(file)?))).collect();
    let recipe = Recipe { preset, inputs };
    let budget = Budget::new(100_000, TREE_BYTES);
    if let Err(error) = outline(&recipe, &budget) {
        said(&error);
    }
    let grown = match grow(&recipe, &budget) {
        Ok(grown) => grown,
        Err(error) => {
            let is_ours = matches!(&error, GrowError::Skeleton(own) if !matches!(own, SkeletonError::Empty));
            assert!(!is_ours, "a generator gave no tree: {error}");
            return said(&error);
        }
    };
    for note in &grown.notes {
        said(note);
    }
    sound_skeleton(&grown.skeleton);
    let scene = match dress(&recipe, &grown, &budget) {
        Ok(scene) => scene,
        Err(error) => return said(&error),
    };
    for part in &scene.parts {
        let found = topology(&part.mesh, &Quiet).expect("nobody cancels");
        assert_eq!(found.not_finite, 0, "part {}: {found:?}", part.name);
        assert!(part.name != "wood" || found.open_edges == 0, "the wood is open: {found:?}");
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
    format!("{} axes of {}", scene.skeleton.axes.len().min(3), recipe.preset.generator.id())
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
