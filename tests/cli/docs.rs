//! The commands that the documents print are ones that the program understands.

use linden::forest::{FOREST_KNOBS, builtin_forests};
use linden::knob::{Kind, Knob, Spread};
use linden::preset::{KNOBS, LEAF_KNOBS, Preset, ScanSettings, builtins};
use linden_exporters::REGISTRY;

use crate::program::linden;

/// Pages with commands, and the least number of them.
const PAGES: [(&str, usize); 11] = [
    ("README.md", 15),
    ("docs/tutorial.md", 7),
    ("docs/formats.md", 12),
    ("docs/farms.md", 5),
    ("docs/scans.md", 4),
    ("docs/ssh.md", 0),
    ("docs/workbench.md", 3),
    ("docs/crowns.md", 0),
    ("docs/choosing-a-generator.md", 6),
    ("docs/ages.md", 6),
    ("docs/impostors.md", 3),
];

/// The command lines of a page: lines of its `sh` blocks, and code in its text, that begin with the program's
/// name.
fn commands(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut language = None;
    for line in page.lines() {
        if let Some(fence) = line.trim_start().strip_prefix("```") {
            language = if language.is_none() { Some(fence) } else { None };
        } else if language == Some("sh") {
            let line = line
                .strip_prefix("cargo run --release -- ")
                .map_or(line.to_owned(), |rest| format!("linden {rest}"));
            found.extend(Some(line).filter(|line| line == "linden" || line.starts_with("linden ")));
        } else if language.is_none() {
            let code = line.split('`').skip(1).step_by(2);
            found.extend(
                code.filter(|code| code.starts_with("linden ") && !code.contains('…')).map(str::to_owned),
            );
        }
    }
    found
}

/// The arguments of a command line, without comment, pipe and redirection.
fn arguments(line: &str) -> Vec<String> {
    let line = line.split("  #").next().unwrap_or_default();
    let words = shell_words::split(line).unwrap_or_else(|error| panic!("{line}: {error}"));
    words.into_iter().skip(1).take_while(|word| !["|", "<", ">", "&&"].contains(&word.as_str())).collect()
}

/// Words that begin with a capital stand for what a reader puts there.
fn is_placeholder(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_uppercase())
}

fn knob(name: &str) -> Option<Knob> {
    if let Some((format, option)) = name.split_once('.') {
        let formats = || REGISTRY.iter().map(|exporter| exporter.format());
        return match formats().find(|found| found.id == format) {
            Some(format) => format.options.iter().map(|row| row.knob).find(|knob| knob.name == option),
            // A kind of foliage, by its name.
            None => LEAF_KNOBS.iter().map(|row| row.knob).find(|knob| knob.name == option),
        };
    }
    let of_presets =
        builtins().iter().filter_map(|builtin| builtin.load().ok()).flat_map(|preset| preset.knobs());
    // Those of crown shapes are in presets that have the shape.
    let mut all = KNOBS.iter().map(|row| row.knob).chain(of_presets.map(|(row, _)| row.knob));
    all.find(|knob| knob.name == name)
        .or_else(|| FOREST_KNOBS.iter().map(|row| row.knob).find(|knob| knob.name == name))
}

/// What is wrong with a command line, if anything.
fn fault(line: &str) -> Option<String> {
    let words = arguments(line);
    let help: Vec<&str> = words.iter().map(String::as_str).chain(["--help"]).collect();
    let said = linden().args(help).output().unwrap();
    if !said.status.success() {
        return Some(String::from_utf8_lossy(&said.stderr).into_owned());
    }
    for pair in words.windows(2).filter(|pair| pair[0] == "--set") {
        let (name, value) = pair[1].split_once('=')?;
        if is_placeholder(value) || is_placeholder(name) {
            continue;
        }
        // Of a list or range the first value.
        let is_swept = words.first().is_some_and(|command| command == "sweep");
        let value = if is_swept { value.split([',', ':']).next().unwrap_or_default() } else { value };
        match knob(name).map(|knob| knob.kind) {
            // A text, which is no knob.
            None if Preset::of("scan", ScanSettings::of("a.laz")).set(name, value).is_ok() => {}
            None => return Some(format!("no knob is called {name}")),
            Some(Kind::Choice(known)) if name == "crown" && known.contains(&value) => {}
            Some(kind) if Spread::is_meant(value) => {
                if let Err(problem) = Spread::parse(&kind, value) {
                    return Some(format!("{name}: {problem}"));
                }
            }
            Some(kind) => {
                if let Err(problem) = kind.parse(value) {
                    return Some(format!("{name}: {problem}"));
                }
            }
        }
    }
    let takes_source = [
        "show",
        "stats",
        "sweep",
        "calibrate",
        "preview",
        "export",
        "scan",
        "open",
        "sheet",
        "forest",
        "impostor",
    ];
    if let [command, source, ..] = &words[..]
        && takes_source.contains(&command.as_str())
    {
        let id = source.split(':').next().unwrap_or_default();
        let is_known = builtins().iter().any(|builtin| builtin.id == id)
            || builtin_forests().iter().any(|forest| forest.id == id)
            || source.contains('.')
            || source.starts_with('-')
            || is_placeholder(source);
        return (!is_known).then(|| format!("no preset is called {id}"));
    }
    None
}

#[test]
fn every_command_in_the_documents_is_understood() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for (path, least) in PAGES {
        let page = std::fs::read_to_string(root.join(path)).unwrap();
        let commands = commands(&page);
        assert!(commands.len() >= least, "{path} has {} commands", commands.len());
        for line in commands {
            if let Some(fault) = fault(&line) {
                panic!("{path}: {line}\n{fault}");
            }
        }
    }
}

#[test]
fn wrong_commands_are_found() {
    for line in [
        "linden exprt oak",
        "linden export oak --lots 3",
        "linden export oka -o oka.glb",
        "linden export oak --set kil=2D",
        "linden export oak --set kill=two",
        "linden export oak --set glb.quantise=true",
        "linden preview oak --look nothing",
    ] {
        assert!(fault(line).is_some(), "{line}");
    }
    assert_eq!(fault("linden export oak -o oak.glb --set kill=2D  # an oak"), None);
    assert_eq!(
        commands("```sh\nlinden\nls\n```\n```bash\nlinden x\n```\na `linden list` b\n"),
        ["linden", "linden list"]
    );
}
