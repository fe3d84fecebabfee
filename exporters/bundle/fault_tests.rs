//! Every call of the operating system fails in turn, in every way that matters: there are the old files
//! then or the new ones, and nothing else.
#![cfg(all(unix, not(linden_portable)))]

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use linden_pipeline::Quiet;
use rustix::io::Errno;

use super::file_system::{FileSystem, System};
use super::folders::make_folders_on;
use super::*;

/// A file system on which one call fails, or all from one on.
struct Faulty {
    knows: Knows,
    calls: AtomicUsize,
    /// The number of the call that fails, from 0.
    fails: usize,
    /// Whether those after it fail too.
    for_good: bool,
    how: Errno,
    called: Mutex<BTreeSet<&'static str>>,
}

/// What a file system can do beyond the plainest.
#[derive(Clone, Copy, Debug)]
struct Knows {
    unnamed: bool,
    exchange: bool,
    links: bool,
}

const KNOWS: [Knows; 4] = [
    Knows { unnamed: true, exchange: true, links: true },
    Knows { unnamed: false, exchange: true, links: true },
    Knows { unnamed: false, exchange: false, links: true },
    Knows { unnamed: false, exchange: false, links: false },
];

impl Faulty {
    fn leaked(knows: Knows, fails: usize, for_good: bool, how: Errno) -> &'static Self {
        let (calls, called) = (AtomicUsize::new(0), Mutex::default());
        Box::leak(Box::new(Self { knows, calls, fails, for_good, how, called }))
    }

    fn turn(&self, name: &'static str) -> io::Result<()> {
        self.called.lock().unwrap().insert(name);
        let number = self.calls.fetch_add(1, Ordering::Relaxed);
        let is_hit = number == self.fails || (self.for_good && number > self.fails);
        if is_hit { Err(self.how.into()) } else { Ok(()) }
    }

    fn able(&self, known: bool) -> io::Result<()> {
        let _ = self;
        if known { Ok(()) } else { Err(Errno::OPNOTSUPP.into()) }
    }
}

/// Methods that take their turn and then do what the system does.
macro_rules! in_turn {
    ($($(($knows:ident))? $name:ident($($arg:ident: $type:ty),*) -> $gives:ty;)*) => {$(
        fn $name(&self, $($arg: $type),*) -> io::Result<$gives> {
            self.turn(stringify!($name))?;
            $(self.able(self.knows.$knows)?;)?
            System.$name($($arg),*)
        }
    )*};
}

impl FileSystem for Faulty {
    in_turn! {
        metadata(path: &Path) -> Metadata;
        symlink_metadata(path: &Path) -> Metadata;
        read_link(path: &Path) -> PathBuf;
        canonicalize(path: &Path) -> PathBuf;
        names(folder: &Path) -> Vec<OsString>;
        create_folder(path: &Path) -> ();
        remove_folder(path: &Path) -> ();
        (unnamed) create_unnamed(folder: &Path, mode: u32) -> File;
        create(path: &Path, mode: u32) -> File;
        open(path: &Path) -> File;
        open_folder(path: &Path) -> File;
        try_lock(file: &File) -> bool;
        write(file: &File, bytes: &[u8]) -> usize;
        read_at(file: &File, bytes: &mut [u8], offset: u64) -> usize;
        set_mode(file: &File, mode: u32) -> ();
        (unnamed) link_unnamed(file: &File, path: &Path) -> ();
        (links) link(from: &Path, to: &Path) -> ();
        rename(from: &Path, to: &Path) -> ();
        (exchange) exchange(one: &Path, other: &Path) -> ();
        remove(path: &Path) -> ();
    }

    /// Thousands of rounds need not wait for the disk.
    fn sync(&self, _: &File) -> io::Result<()> {
        self.turn("sync")
    }
}

/// What is at a path, links being links.
type Listing = Vec<(PathBuf, String)>;

/// All that is below a folder, hidden or not.
fn listing(folder: &Path) -> Listing {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let kind = fs::symlink_metadata(&path).unwrap().file_type();
        if kind.is_dir() {
            found.extend(listing(&path));
        } else if kind.is_symlink() {
            found.push((path.clone(), format!("-> {}", fs::read_link(&path).unwrap().display())));
        } else {
            found.push((path.clone(), fs::read_to_string(&path).unwrap()));
        }
    }
    found.sort();
    found
}

/// Files of an export before: two bundles' main files, one behind a link, and side files, one behind a
/// link into another folder. Made anew in place, so that each round begins alike.
fn old_files(folder: &Path) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_folder = fs::symlink_metadata(&path).unwrap().is_dir();
        if is_folder { fs::remove_dir_all(path) } else { fs::remove_file(path) }.unwrap();
    }
    fs::create_dir(folder.join("far")).unwrap();
    for name in ["fir.obj", "far/fir.mtl", "fir_bark.png", "oak.gltf"] {
        fs::write(folder.join(name), format!("old {name}")).unwrap();
    }
    symlink("far/fir.mtl", folder.join("fir.mtl")).unwrap();
    symlink("oak.gltf", folder.join("link.gltf")).unwrap();
}

/// An export over them: some files are replaced, some are new, a picture is shared, a folder is made.
fn export(system: &'static dyn FileSystem, folder: &Path) -> Result<Vec<Written>, ExportError> {
    fn out(text: &str) -> impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError> {
        |out| out.write(text.as_bytes())
    }
    let new = folder.join("new/er/elm.usda");
    let made = make_folders_on(system, &new)?;
    let mut fir = Bundle::create_on(system, &folder.join("fir.obj"))?;
    let mut gltf = Bundle::create_on(system, &folder.join("link.gltf"))?;
    let mut also = Bundle::create_on(system, &folder.join("fir.gltf"))?;
    let mut elm = Bundle::create_on(system, &new)?;
    let source = folder.join("far/fir.mtl.source");
    ensure_spared(std::slice::from_ref(&fir), &[source])?;
    fir.write_side(".mtl", None, &Quiet, out("new mtl"))?;
    fir.write_side("_bark.png", None, &Quiet, out("new bark"))?;
    fir.write_main(None, &Quiet, out("new obj"))?;
    gltf.write_side(".bin", None, &Quiet, out("new bin"))?;
    gltf.write_main(None, &Quiet, out("new gltf"))?;
    also.write_side("_bark.png", None, &Quiet, out("new bark"))?;
    also.write_main(None, &Quiet, out("new fir gltf"))?;
    elm.write_main(None, &Quiet, out("new elm"))?;
    let written = commit_all(vec![fir, gltf, also, elm])?;
    made.keep();
    Ok(written)
}

/// The state before and after, and how many calls lie between.
fn whole(folder: &Path, knows: Knows) -> (Listing, Listing, &'static Faulty) {
    old_files(folder);
    let before = listing(folder);
    let system = Faulty::leaked(knows, usize::MAX, false, Errno::IO);
    export(system, folder).unwrap();
    (before, listing(folder), system)
}

#[test]
fn whichever_call_fails_there_are_all_old_files_or_all_new_ones() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    for knows in KNOWS {
        let (before, after, system) = whole(folder, knows);
        assert_ne!(before, after);
        let count = system.calls.load(Ordering::Relaxed);
        let (mut olds, mut news) = (0, 0);
        for how in [Errno::NOSPC, Errno::IO, Errno::ACCESS, Errno::INTR] {
            for fails in 0..count {
                old_files(folder);
                let done = export(Faulty::leaked(knows, fails, false, how), folder);
                let found = listing(folder);
                let case =
                    format!("{knows:?}, {how:?} of call {fails} of {count}: {:?}", done.as_ref().err());
                assert!(found == before || found == after, "{case}\n{found:#?}");
                if found == before {
                    olds += 1;
                } else {
                    news += 1;
                }
                match done {
                    Ok(_) => assert_eq!(found, after, "{case}"),
                    // All files were in their places when the folder could not be synced.
                    Err(error) if found == after => {
                        let told = error.to_string();
                        assert!(told.starts_with("syncing the directory of"), "{case}");
                    }
                    Err(error) => assert!(!error.to_string().contains(".linden"), "{case}"),
                }
                assert!(how != Errno::INTR || found == after, "an interrupted call is made again: {case}");
            }
        }
        assert!(olds > count && news > count, "{knows:?}: {olds} {news}");
    }
}

/// As after `kill -9`: from one call on there are no others, and the locks are gone.
#[test]
fn after_a_sudden_end_at_any_call_the_next_run_tidies_up() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    for knows in KNOWS {
        let (before, after, system) = whole(folder, knows);
        for fails in 0..system.calls.load(Ordering::Relaxed) {
            old_files(folder);
            let _ = export(Faulty::leaked(knows, fails, true, Errno::IO), folder);
            let mut next = Bundle::create(&folder.join("fir.obj")).unwrap();
            next.write_side(".mtl", None, &Quiet, |_| Ok(())).unwrap();
            make_folders(&folder.join("new/er/elm.usda")).unwrap().keep();
            drop(Bundle::create(&folder.join("new/er/elm.usda")).unwrap());
            drop(next);
            let found = listing(folder);
            assert!(found == before || found == after, "{knows:?}, {fails}: {found:#?}");
        }
    }
}

#[test]
fn every_call_goes_through_the_file_system() {
    let dir = tempfile::tempdir().unwrap();
    let mut called = BTreeSet::new();
    for knows in KNOWS {
        called.extend(whole(dir.path(), knows).2.called.lock().unwrap().iter().copied());
    }
    // What only failures need.
    let on_failure = ["remove_folder"];
    let all = "metadata symlink_metadata read_link canonicalize names create_folder create_unnamed create open \
               open_folder try_lock write read_at set_mode sync link_unnamed link rename exchange remove";
    let all: BTreeSet<&str> = all.split_whitespace().collect();
    assert_eq!(called, all);
    let failed = Faulty::leaked(KNOWS[0], 8, false, Errno::ACCESS);
    old_files(dir.path());
    assert!(export(failed, dir.path()).is_err());
    assert!(on_failure.iter().all(|name| failed.called.lock().unwrap().contains(name)));
}

#[test]
fn a_single_file_is_the_old_one_or_the_new_one_whichever_call_fails() {
    let dir = tempfile::tempdir().unwrap();
    let (real, link) = (dir.path().join("real"), dir.path().join("link"));
    for (knows, replaces) in KNOWS.iter().flat_map(|knows| [(*knows, true), (*knows, false)]) {
        let mut fails = 0;
        loop {
            for path in [&real, &link] {
                let _ = fs::remove_file(path);
            }
            if replaces {
                fs::write(&real, "old").unwrap();
                symlink("real", &link).unwrap();
            }
            let before = listing(dir.path());
            let target = if replaces { &link } else { &real };
            let system = Faulty::leaked(knows, fails, false, [Errno::NOSPC, Errno::ACCESS][fails % 2]);
            let done = single::write_file_on(system, target, b"new", 0o600, replaces);
            let after = listing(dir.path());
            let is_new =
                fs::read_to_string(&real).is_ok_and(|text| text == "new") && after.len() >= before.len();
            assert!(after == before || is_new, "{knows:?}, {replaces}, {fails}: {after:?}");
            assert!(done.is_err() || is_new);
            assert!(after.len() <= 1 + usize::from(replaces), "{after:?}");
            if system.calls.load(Ordering::Relaxed) <= fails {
                assert!(done.is_ok());
                break;
            }
            fails += 1;
        }
        assert!(fails > 5);
        if !replaces {
            let kept = single::write_file_on(&System, &real, b"other", 0o600, false).unwrap_err();
            assert_eq!(kept.kind(), io::ErrorKind::AlreadyExists);
            assert_eq!(listing(dir.path()), [(real.clone(), "new".to_owned())]);
        }
    }
}
