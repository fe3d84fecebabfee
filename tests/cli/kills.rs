//! `kill -9` at any moment of an export over files that are there. `tests/kills/run 1000` does it a
//! thousand times and says what was found.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use ::linden::random::Key;
use ::linden::random::rand::RngExt;

use crate::program::{Folder, linden};

/// Kills of each kind of export, unless `LINDEN_KILLS` says how many there are of all.
const FEW: usize = 6;

/// Exports with files beside the main one, and one without.
const EXPORTS: [&[&str]; 4] = [
    &["-o", "tree.obj"],
    &["-o", "tree.gltf"],
    &["-o", "tree.usda"],
    &["-o", "tree.glb", "-o", "tree.obj", "-o", "tree.ply"],
];
/// Two trees with leaves and bark; what they write differs in every file that is not shared.
const TREES: [&[&str]; 2] =
    [&["--seed", "1", "--set", "bark=plated"], &["--seed", "2", "--set", "bark=birch"]];
const PRESET: &str = "simple";

type Files = BTreeMap<String, Vec<u8>>;

fn files(folder: &Folder) -> Files {
    folder.names().into_iter().map(|name| (name.clone(), folder.read(&name))).collect()
}

fn start(folder: &Folder, export: &[&str], tree: usize) -> Child {
    linden()
        .args([&["export", PRESET][..], TREES[tree], export].concat())
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// What was found after all kills.
#[derive(Debug, Default, PartialEq)]
struct Found {
    kills: usize,
    /// Exports that had ended before.
    came_too_late: usize,
    /// Files that were gone, or neither the old nor the new one.
    lost_files: usize,
    half_files: usize,
    /// Exports with old and new files, or temporary ones, until the next run in that folder; and then.
    mixed: usize,
    left: usize,
    mixed_for_good: usize,
    left_for_good: usize,
}

#[test]
fn a_kill_at_any_moment_loses_nothing_and_leaves_nothing() {
    let all = std::env::var("LINDEN_KILLS").ok().map(|text| text.parse::<usize>().unwrap());
    let each = all.map_or(FEW, |all| all.div_ceil(EXPORTS.len()));
    let mut found = Found::default();
    let mut chance = Key::new(12).rng();
    for export in EXPORTS {
        let folder = Folder::new();
        let mut whole = Vec::new();
        let mut takes = Duration::ZERO;
        for tree in [1, 0] {
            let begun = Instant::now();
            assert!(start(&folder, export, tree).wait().unwrap().success());
            takes = takes.max(begun.elapsed());
            whole.push(files(&folder));
        }
        whole.reverse();
        let names: Vec<&String> = whole[0].keys().collect();
        assert_eq!(names, whole[1].keys().collect::<Vec<_>>(), "both write the same names");
        let is_mixed = |now: &Files| {
            let is_all = |tree: &Files| names.iter().all(|name| now.get(*name) == tree.get(*name));
            !whole.iter().any(is_all)
        };
        for kill in 0..each {
            // What is there before is one of the two, whichever the last kill has left.
            let mut child = start(&folder, export, kill % 2);
            std::thread::sleep(takes.mul_f64(chance.random()));
            child.kill().unwrap();
            found.came_too_late += usize::from(child.wait().unwrap().success());
            found.kills += 1;
            let now = files(&folder);
            for name in &names {
                let is_one = whole.iter().any(|tree| now.get(*name) == tree.get(*name));
                found.lost_files += usize::from(!now.contains_key(*name));
                found.half_files += usize::from(now.contains_key(*name) && !is_one);
            }
            found.mixed += usize::from(is_mixed(&now));
            found.left += usize::from(now.len() > names.len());
            folder.run(&["export", "older-a", "-o", "next.csv"]).done();
            fs::remove_file(folder.file("next.csv")).unwrap();
            let now = files(&folder);
            found.mixed_for_good += usize::from(is_mixed(&now));
            found.left_for_good += usize::from(now.len() > names.len());
        }
    }
    if all.is_some() {
        eprintln!("{found:#?}");
    }
    let Found { lost_files, half_files, mixed_for_good, left_for_good, .. } = found;
    assert_eq!([lost_files, half_files, mixed_for_good, left_for_good], [0; 4]);
}
