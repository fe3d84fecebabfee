//! What completes the values of arguments: presets, knobs and their values, formats, words.
//!
//! Shells ask this program itself while a command line is typed (see [`super::completions`]). It answers from its
//! tables, the folder of the user's presets, and the directory that is typed; nothing is grown or read.

use std::collections::BTreeSet;
use std::ffi::OsStr;

use clap_complete::engine::{
    ArgValueCandidates, ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter,
};
use linden::forest::{FOREST_KNOBS, builtin_forests};
use linden::knob::{Kind, Knob};
use linden::lsystem::Grammar;
use linden::preset::{KNOBS, LSystem, PresetKnob, Section, builtin, builtins};
use linden::season::SEASON_WORDS;
use linden_exporters::{PROFILES, REGISTRY};

use crate::config::dirs::Dirs;
use crate::config::presets::ids;

/// SOURCE: presets and files.
pub fn sources() -> ArgValueCompleter {
    ArgValueCompleter::new(|typed: &OsStr| with_files(presets(), typed))
}

/// What `linden show` takes: presets, forests and files.
pub fn shown() -> ArgValueCompleter {
    ArgValueCompleter::new(|typed: &OsStr| with_files(presets().chain(forests()), typed))
}

/// `KNOB=VALUE`, and `FORMAT.OPTION=VALUE` where files are written.
pub fn settings() -> ArgValueCompleter {
    ArgValueCompleter::new(setting)
}

/// `NAME=` of the constants of the grammar that stands on the line.
pub fn constants() -> ArgValueCandidates {
    ArgValueCandidates::new(|| {
        let preset = typed_line().iter().find_map(|word| builtin(word).ok()?.load().ok());
        let grammar =
            preset.as_ref().and_then(|preset| preset.settings::<LSystem>()).map(|settings| &settings.grammar);
        let constants = grammar.map_or_else(Vec::new, Grammar::constants);
        constants.iter().map(|(name, written, _)| candidate(&format!("{name}="), written)).collect()
    })
}

/// Ids of formats.
pub fn formats() -> ArgValueCandidates {
    ArgValueCandidates::new(|| {
        let formats = crate::formats::exporters().into_iter().map(linden_exporters::Exporter::format);
        formats.map(|format| candidate(format.id, format.help)).collect()
    })
}

/// Programs that files are for.
pub fn clients() -> ArgValueCandidates {
    ArgValueCandidates::new(|| PROFILES.iter().map(|profile| candidate(profile.id, profile.name)).collect())
}

/// Some words.
pub fn words(words: impl Fn() -> Vec<String> + Send + Sync + 'static) -> ArgValueCandidates {
    ArgValueCandidates::new(move || words().into_iter().map(CompletionCandidate::new).collect())
}

/// Names of knobs.
pub fn knobs() -> ArgValueCandidates {
    ArgValueCandidates::new(|| {
        let mut seen = BTreeSet::new();
        let knobs = KNOBS.iter().map(|row| row.knob).filter(|knob| seen.insert(knob.name));
        knobs.map(|knob| candidate(knob.name, knob.help)).collect()
    })
}

/// Words of the knob of this name.
pub fn values_of(knob: &'static str) -> ArgValueCandidates {
    words(move || {
        let found = KNOBS.iter().find(|row| row.knob.name == knob);
        found.map_or_else(Vec::new, |row| values(&row.knob.kind))
    })
}

/// Values of an option that formats have.
pub fn values_of_option(option: &'static str) -> ArgValueCandidates {
    words(move || {
        let mut options = REGISTRY.iter().flat_map(|exporter| exporter.format().options);
        let found = options.find(|spec| spec.knob.name == option);
        found.map_or_else(Vec::new, |spec| values(&spec.knob.kind))
    })
}

/// Seasons, and all of them.
pub fn seasons() -> ArgValueCandidates {
    words(|| SEASON_WORDS.iter().map(|(name, _)| (*name).to_owned()).chain(["all".to_owned()]).collect())
}

/// Groups of presets.
pub fn groups() -> ArgValueCandidates {
    words(|| {
        let mut groups: Vec<String> = headings().map(|(_, heading)| heading.group).collect();
        groups.dedup();
        groups
    })
}

fn headings() -> impl Iterator<Item = (&'static str, linden::preset::Heading)> {
    builtins().iter().filter_map(|builtin| Some((builtin.id, builtin.heading().ok()?)))
}

fn presets() -> impl Iterator<Item = CompletionCandidate> {
    let of_user = Dirs::of_environment().presets().map_or_else(Vec::new, |folder| ids(&folder));
    let of_user = of_user.into_iter().filter(|id| builtin(id).is_err());
    let built_in = headings().map(|(id, heading)| candidate(id, &heading.summary));
    built_in.chain(of_user.map(|id| candidate(&id, "a preset of yours")))
}

fn forests() -> impl Iterator<Item = CompletionCandidate> {
    builtin_forests().iter().map(|builtin| candidate(builtin.id, "a forest"))
}

fn with_files(named: impl Iterator<Item = CompletionCandidate>, typed: &OsStr) -> Vec<CompletionCandidate> {
    let mut all = beginning_with(named, typed);
    all.extend(PathCompleter::file().complete(typed));
    all
}

fn beginning_with(all: impl Iterator<Item = CompletionCandidate>, typed: &OsStr) -> Vec<CompletionCandidate> {
    let typed = typed.as_encoded_bytes();
    all.filter(|word| word.get_value().as_encoded_bytes().starts_with(typed)).collect()
}

fn candidate(value: &str, help: &str) -> CompletionCandidate {
    CompletionCandidate::new(value).help(Some(help.to_owned().into()))
}

/// What is typed: behind `--` and the word that calls the program, whose name is a preset's, too.
fn typed_line() -> Vec<String> {
    std::env::args().skip_while(|word| word != "--").skip(2).collect()
}

/// A knob or an option: what is before `=`, its kind, its help.
type Named = (String, Kind, &'static str);

fn setting(typed: &OsStr) -> Vec<CompletionCandidate> {
    let line = typed_line();
    let known = known(&line);
    let all: Vec<_> = match typed.to_string_lossy().split_once('=') {
        None => known.iter().map(|(name, _, help)| candidate(&format!("{name}="), help)).collect(),
        Some((name, _)) => {
            let found = known.iter().find(|(other, ..)| other == name);
            let values = found.map_or_else(Vec::new, |(_, kind, _)| values(kind));
            values.into_iter().map(|value| CompletionCandidate::new(format!("{name}={value}"))).collect()
        }
    };
    beginning_with(all.into_iter(), typed)
}

/// What can be set on a command line: by the preset that stands there, else by any; and options of formats
/// where files are written.
fn known(line: &[String]) -> Vec<Named> {
    let preset = line.iter().find_map(|word| builtin(word).ok()?.load().ok());
    let named = |knob: Knob| (knob.name.to_owned(), knob.kind, knob.help);
    let mut all: Vec<Named> = match preset {
        Some(preset) => {
            let labels = preset.kind_labels();
            let of_kind = |(row, _): (PresetKnob, _)| match row.section {
                Section::Kind(kind) => {
                    (format!("{}.{}", labels[kind], row.short_name()), row.knob.kind, row.knob.help)
                }
                _ => named(row.knob),
            };
            preset.all_knobs().into_iter().map(of_kind).collect()
        }
        None => KNOBS.iter().map(|row| named(row.knob)).collect(),
    };
    let is = |command: &str| line.iter().any(|word| word == command);
    if is("forest") {
        let of_forests = FOREST_KNOBS.iter().map(|row| &row.knob);
        all.extend(of_forests.map(|knob| (knob.name.to_owned(), knob.kind, knob.help)));
    }
    if is("export") || is("forest") {
        for format in REGISTRY.iter().map(|exporter| exporter.format()) {
            let option = |knob: &Knob| (format!("{}.{}", format.id, knob.name), knob.kind, knob.help);
            all.extend(format.options.iter().map(|spec| option(&spec.knob)));
        }
    }
    all
}

/// The words that a kind takes; none for numbers.
fn values(kind: &Kind) -> Vec<String> {
    let words = match kind {
        Kind::Words(words) | Kind::Sequence { words, .. } => words.to_vec(),
        Kind::Colors { auto: true, .. } => vec!["auto"],
        other => other.words(),
    };
    words.into_iter().map(str::to_owned).collect()
}
