//! Every parser, and whole recipes, fed with a kept corpus and with what chance makes of it.
//!
//! The ordinary test takes seconds and the same inputs each time. `tests/fuzz/run SECONDS [TARGET]`
//! goes on with other ones for as long, keeps what leads somewhere new while it runs, and makes what
//! fails as small as it can: into `target/fuzz`, from where it is moved to the corpus once it is mended.
//! What takes too much time or memory for its bytes fails, and what does not end ends the run, with its
//! name. `fuzz/run` feeds the same targets with what a compiler's instrumentation leads to.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on fails")]

mod endless;
mod mutate;
mod targets;
mod watch;
mod words;

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use linden::preset::builtins;
use linden::random::Key;
use mutate::{Dice, mutated, turned};
use peak_alloc::PeakAlloc;
use targets::{TARGETS, TREE_BYTES, Target};
use watch::Watch;

/// Looks at how long each input takes.
static WATCH: LazyLock<Watch> =
    LazyLock::new(|| Watch::start(|target, bytes| kept(target, "endless", bytes)));

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Bytes that an input may make a parser hold: some for each byte of the input, and a constant. The largest
/// is a mesh: 6 bytes of text can be a point of 24, in a list that moves to a larger place. The constant is for what
/// is not asked for beforehand: the largest are leaves of 1024 pixels while their pictures are encoded.
const BYTES_PER_BYTE: usize = 64;
const CONSTANT_BYTES: usize = 28 << 20;

fn corpus(target: &Target) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target.name);
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

/// The corpus, and for documents the built-in presets.
fn seeds(target: &Target) -> Vec<Vec<u8>> {
    let mut seeds: Vec<Vec<u8>> = corpus(target).into_iter().map(|(_, bytes)| bytes).collect();
    if matches!(target.name, "preset" | "tree") {
        seeds
            .extend(builtins().iter().map(|builtin| builtin.load().unwrap().to_toml().unwrap().into_bytes()));
    }
    if target.name == "recipe" {
        let line = |builtin: &linden::preset::Builtin| {
            linden::recipe::Recipe::new(builtin.load().unwrap()).to_line().into_bytes()
        };
        seeds.extend(builtins().iter().map(line));
    }
    seeds
}

/// What is wrong with an input.
enum Wrong {
    /// It ends badly, and so may a part of it.
    Fails(String),
    /// It takes too long: to look for the part that does would take longer.
    Slow(String),
}

/// Runs one input. What became of it, or what is wrong.
fn tried(target: &'static Target, bytes: &[u8]) -> Result<String, Wrong> {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let running = WATCH.begin(target, bytes);
    let done = catch_unwind(AssertUnwindSafe(|| (target.run)(bytes)));
    let slow = running.end();
    let peak = ALLOCATOR.peak_usage().saturating_sub(before);
    let said = done.map_err(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|message| (*message).to_owned()));
        Wrong::Fails(text.unwrap_or_default())
    })?;
    if let Some(slow) = slow {
        return Err(Wrong::Slow(slow));
    }
    let for_trees = if target.is_grown() { TREE_BYTES as usize } else { 0 };
    if peak > for_trees + bytes.len() * BYTES_PER_BYTE + CONSTANT_BYTES {
        return Err(Wrong::Fails(format!("{peak} bytes of memory for {} of input", bytes.len())));
    }
    Ok(shape(&said))
}

/// What an outcome has in common with others: no numbers, and nothing that is quoted.
fn shape(said: &str) -> String {
    let unquoted: String = said.split('\'').step_by(2).collect();
    unquoted.chars().filter(|c| !c.is_ascii_digit()).take(160).collect()
}

/// The smallest part of an input that still fails.
fn minimised(target: &'static Target, bytes: &[u8]) -> Vec<u8> {
    let mut smallest = bytes.to_vec();
    let mut piece = smallest.len() / 2;
    while piece > 0 {
        let mut at = 0;
        while at < smallest.len() {
            let mut shorter = smallest.clone();
            shorter.drain(at..(at + piece).min(shorter.len()));
            if tried(target, &shorter).is_err() { smallest = shorter } else { at += piece }
        }
        piece /= 2;
    }
    smallest
}

fn kept(target: &Target, what: &str, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fuzz").join(target.name);
    std::fs::create_dir_all(&folder).unwrap();
    let hash = linden::random::Key::new(bytes.len() as u64);
    let hash = bytes.iter().fold(hash, |key, &byte| key.child(byte.into())).bits();
    let path = folder.join(format!("{what}-{hash:016x}"));
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Runs an input; a failure becomes a file and a line.
fn judged(target: &'static Target, bytes: &[u8], from: &str) -> Result<String, String> {
    tried(target, bytes).map_err(|wrong| {
        let (wrong, path) = match wrong {
            Wrong::Fails(wrong) => (wrong, kept(target, "fails", &minimised(target, bytes))),
            Wrong::Slow(wrong) => (wrong, kept(target, "slow", bytes)),
        };
        let shown: String = wrong.chars().take(600).collect();
        format!("{} ({from}): {shown}\n  the input: {}", target.name, path.display())
    })
}

fn next(target: &Target, seeds: &[Vec<u8>], key: Key) -> Vec<u8> {
    // Whole recipes die of a changed byte before anything grows: most get other knobs instead.
    let is_document = matches!(target.name, "preset" | "tree");
    let mut dice = Dice::new(key.named("way"));
    if is_document && dice.below(4) > 0 {
        let seed = String::from_utf8_lossy(&seeds[dice.below(seeds.len())]).into_owned();
        return turned(&seed, key);
    }
    mutated(seeds, target.words, key)
}

/// The corpus and `rounds` mutations of it, or as many as `time` allows.
fn run(target: &'static Target, time: Option<Duration>) -> Vec<String> {
    let mut failures = Vec::new();
    let mut known = BTreeSet::new();
    for (path, bytes) in corpus(target) {
        match judged(target, &bytes, &path.file_name().unwrap().to_string_lossy()) {
            Ok(said) => drop(known.insert(said)),
            Err(failure) => failures.push(failure),
        }
    }
    for (what, bytes) in endless::cases(target.name) {
        failures.extend(judged(target, &bytes, what).err());
    }
    let mut seeds = seeds(target);
    assert!(!seeds.is_empty(), "no corpus for {}", target.name);
    let started = Instant::now();
    let key = Key::new(if time.is_some() { started_at() } else { 1 }).named(target.name);
    for round in 0.. {
        let over = time.map_or(round >= target.rounds, |time| started.elapsed() >= time);
        if over || failures.len() >= 5 {
            break;
        }
        let bytes = next(target, &seeds, key.child(round));
        match judged(target, &bytes, &format!("round {round}")) {
            Ok(said) => {
                if known.insert(said) && time.is_some() {
                    kept(target, "new", &bytes);
                    seeds.push(bytes);
                }
            }
            Err(failure) => failures.push(failure),
        }
    }
    failures
}

/// Other inputs each time that somebody asks for more than the ordinary test.
fn started_at() -> u64 {
    std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_secs()
}

#[test]
fn nothing_that_is_read_can_do_harm() {
    let time = std::env::var("LINDEN_FUZZ_SECONDS").ok().map(|text| text.parse().expect("seconds"));
    let chosen = std::env::var("LINDEN_FUZZ_TARGET").ok().filter(|name| !name.is_empty());
    let chosen: Vec<&'static Target> =
        TARGETS.iter().filter(|target| chosen.as_deref().is_none_or(|name| name == target.name)).collect();
    assert!(!chosen.is_empty(), "the targets are {:?}", TARGETS.iter().map(|t| t.name).collect::<Vec<_>>());
    // Panics are caught and told in one line each.
    std::panic::set_hook(Box::new(|_| {}));
    let share = time.map(|seconds: u64| Duration::from_secs(seconds) / chosen.len() as u32);
    let failures: Vec<String> = chosen.into_iter().flat_map(|target| run(target, share)).collect();
    drop(std::panic::take_hook());
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}
