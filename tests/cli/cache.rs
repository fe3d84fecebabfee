//! The cache of drawn pictures: files are the same with it, without it, and with a damaged one.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::PathBuf;
use std::process::Stdio;

use crate::program::{Folder, Said, linden};

/// Small pictures of every kind: bark, moss, leaves, branch cards, a billboard.
const EXPORT: [&str; 11] = [
    "export",
    "drawn-oak",
    "--format=glb,usdz",
    "--set=points=300",
    "--set=bark_size=64",
    "--set=leaf_size=64",
    "--set=card_size=128",
    "--set=moss=0.4",
    "--lods=1500,400",
    "--billboard",
    "--set=billboard_size=64",
];

/// A folder in which the cache is on.
struct Cached(Folder);

impl Cached {
    fn new() -> Self {
        Self(Folder::new())
    }

    fn run(&self, args: &[&str], environment: &[(&str, &str)]) -> Said {
        let mut command = linden();
        command.args(args).current_dir(self.0.path()).stdin(Stdio::null());
        command.env("LINDEN_CONFIG_DIR", self.0.file("config"));
        command.env("LINDEN_CACHE", "").env("LINDEN_CACHE_DIR", self.0.file("cache"));
        command.envs(environment.iter().copied());
        Said::new(command.output().unwrap())
    }

    /// All entries and what they hold.
    fn entries(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let Ok(listed) = fs::read_dir(self.0.file("cache/pictures")) else { return BTreeMap::new() };
        listed
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), fs::read(path).unwrap()))
            .collect()
    }

    /// Exports into a folder: the files, and how many pictures were there and were made.
    fn export(&self, into: &str, more: &[&str], environment: &[(&str, &str)]) -> (Files, Option<[u64; 2]>) {
        fs::create_dir(self.0.file(into)).unwrap();
        let target = format!("{into}/");
        let args = [&EXPORT[..], &["--timings", "--json", "-o", &target], more].concat();
        let said = self.run(&args, environment);
        assert_eq!(said.code, Some(0), "{}", said.err);
        let counts = &said.json()["cache"];
        let counts =
            (!counts.is_null()).then(|| ["hits", "misses"].map(|name| counts[name].as_u64().unwrap()));
        let listed = fs::read_dir(self.0.file(into)).unwrap().map(|entry| entry.unwrap());
        let files = listed.map(|entry| (entry.file_name(), fs::read(entry.path()).unwrap())).collect();
        (files, counts)
    }
}

type Files = BTreeMap<OsString, Vec<u8>>;

#[test]
fn files_are_the_same_with_without_and_with_a_damaged_cache() {
    let cached = Cached::new();
    let (plain, counts) = cached.export("plain", &["--no-cache"], &[]);
    assert_eq!((plain.len(), counts), (2, None));
    assert_eq!(cached.entries().len(), 0);

    let (cold, counts) = cached.export("cold", &[], &[]);
    let [hits, misses] = counts.unwrap();
    let whole = cached.entries();
    // Two formats write the same pictures; what is compressed for one is in memory for the other.
    assert_eq!((hits, misses > 10, whole.len() > 10), (0, true, true), "{misses} {}", whole.len());
    assert!(cold == plain, "cold");

    let (warm, counts) = cached.export("warm", &[], &[]);
    assert_eq!(counts.map(|[hits, misses]| (hits > 10, misses)), Some((true, 0)));
    assert!(warm == plain, "warm");
    assert!(cached.entries() == whole);

    // Each entry is damaged in another way.
    for (index, (path, bytes)) in whole.iter().enumerate() {
        let mut damaged = bytes.clone();
        match index % 4 {
            0 => damaged.truncate(bytes.len() / 2),
            1 => damaged.clear(),
            2 => *damaged.last_mut().unwrap() ^= 1,
            _ => damaged[bytes.len() / 2] ^= 64,
        }
        fs::write(path, damaged).unwrap();
    }
    let (mended, counts) = cached.export("mended", &[], &[]);
    assert_eq!(counts.map(|[hits, _]| hits), Some(0));
    assert!(mended == plain, "damaged");
    assert!(cached.entries() == whole, "damaged entries were replaced");

    // A whole entry in another's place.
    let mut paths = whole.keys();
    fs::copy(paths.next().unwrap(), paths.next().unwrap()).unwrap();
    assert!(cached.export("swapped", &[], &[]).0 == plain, "swapped");
}

#[test]
fn a_forest_draws_what_its_files_hold_and_nothing_else() {
    let cached = Cached::new();
    let forest = ["forest", "drawn-oak", "--area=16", "--trees=2", "--distinct=2", "--triangles=1500"];
    let small = ["--set=points=300", "--set=bark_size=64", "--set=leaf_size=64", "--set=card_size=128"];
    let drawn = |formats: &str, into: &str| {
        fs::create_dir(cached.0.file(into)).unwrap();
        let said = cached.run(&[&forest[..], &small, &["--format", formats, "-o", into]].concat(), &[]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        cached.entries().len()
    };
    // Leaves grow in the outlines of their pictures, which both trees share: colours and normals.
    let leaves = drawn("qsm,mat,ply-skeleton", "wood/");
    assert!(leaves <= 2, "{leaves}");
    assert_eq!(drawn("mtg,organs", "organs/"), leaves);
    // Barks and branch cards, as they are and compressed.
    let all = drawn("glb", "all/");
    assert!(all > leaves + 8, "{leaves} {all}");
}

#[test]
fn a_cache_that_cannot_be_written_is_no_error() {
    let cached = Cached::new();
    cached.0.write("cache", "a file");
    let (files, counts) = cached.export("out", &[], &[]);
    assert_eq!((files.len(), counts.map(|[hits, _]| hits)), (2, Some(0)));
    let doctor = cached.run(&["doctor", "--json"], &[]).done().json();
    let rows = doctor["directories"].as_array().unwrap();
    let row = rows.iter().find(|row| row["what"] == "drawn pictures").unwrap();
    assert_eq!((row["writable"].as_bool(), doctor["complaints"].as_array().unwrap().len()), (Some(false), 0));
}

#[test]
fn two_programs_fill_one_cache_at_a_time() {
    let cached = Cached::new();
    let (plain, _) = cached.export("plain", &["--no-cache"], &[]);
    std::thread::scope(|scope| {
        let runs = ["a", "b", "c"].map(|name| {
            let cached = &cached;
            scope.spawn(move || cached.export(name, &[], &[]).0)
        });
        for run in runs {
            assert!(run.join().unwrap() == plain);
        }
    });
    let names = cached.entries().into_keys().map(|path| path.file_name().unwrap().to_owned());
    assert!(names.into_iter().all(|name| name.to_string_lossy().ends_with(".picture")), "nothing unfinished");
    assert_eq!(cached.export("d", &[], &[]).1.map(|[_, misses]| misses), Some(0));
}

#[test]
fn it_is_shown_cleared_and_turned_off() {
    let cached = Cached::new();
    let report = |environment: &[(&str, &str)]| cached.run(&["cache", "--json"], environment).done().json();
    let empty = report(&[]);
    assert_eq!(
        (empty["path"].as_str(), empty["entries"].as_u64(), empty["limit_bytes"].as_u64()),
        (cached.0.file("cache/pictures").to_str(), Some(0), Some(512 << 20))
    );
    assert!(!cached.0.file("cache").exists(), "looking makes nothing");
    // A picture of the tree fills it too.
    let preview =
        ["preview", "abop-a", "--set=bark_size=32", "-o", "a.png", "--size=40x40", "--look=surface"];
    cached.run(&preview, &[("LINDEN_CACHE", "off")]);
    assert_eq!(cached.entries().len(), 0, "off by the variable");
    assert_eq!(cached.run(&preview, &[]).code, Some(0));
    let entries = cached.entries();
    assert!(!entries.is_empty());
    let full = report(&[]);
    let bytes: usize = entries.values().map(Vec::len).sum();
    assert_eq!(
        (full["entries"].as_u64(), full["bytes"].as_u64()),
        (Some(entries.len() as u64), Some(bytes as u64))
    );
    let text = cached.run(&["cache"], &[]).done().out;
    assert!(text.contains(&format!("{} entries", entries.len())) && text.contains("512.00 MiB"), "{text}");
    let doctor = cached.run(&["doctor"], &[]).done().out;
    assert!(doctor.contains("linden cache") && doctor.contains("512.00 MiB"), "{doctor}");

    let cleared = cached.run(&["cache", "clear"], &[]).done().out;
    assert!(cleared.contains("removed"), "{cleared}");
    assert_eq!(cached.entries().len(), 0);

    // The variable comes before the file.
    fs::create_dir(cached.0.file("config")).unwrap();
    cached.0.write("config/config.toml", "cache = \"off\"\n");
    assert_eq!(report(&[])["limit_bytes"].as_u64(), Some(0));
    assert_eq!(report(&[("LINDEN_CACHE", "64M")])["limit_bytes"].as_u64(), Some(64 << 20));
    cached.run(&preview, &[]);
    assert_eq!(cached.entries().len(), 0, "off by the file");
    let wrong = cached.run(&["cache"], &[("LINDEN_CACHE", "much")]);
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.err.contains("LINDEN_CACHE: 'much': expected off, auto"), "{}", wrong.err);
    assert!(!wrong.err.contains("LINDEN_CACHE_DIR"), "{}", wrong.err);
    let folder = cached.run(&["cache"], &[("LINDEN_CACHE", "/some/dir")]);
    assert!(folder.code == Some(2) && folder.err.contains("LINDEN_CACHE_DIR"), "{}", folder.err);
}
