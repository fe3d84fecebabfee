use std::fs;
use std::io::{self, Write};
use std::path::Path;

use linden_pipeline::Quiet;

use super::*;
use crate::writing::records;

fn staged(target: &Path, content: &str) -> Bundle {
    let mut bundle = Bundle::create(target).unwrap();
    fill(&mut bundle, content).unwrap();
    bundle
}

fn fill(bundle: &mut Bundle, content: &str) -> Result<(), ExportError> {
    bundle.write_main(None, &Quiet, |out| out.write(content.as_bytes()))
}

fn side(bundle: &mut Bundle, suffix: &str, content: &str) {
    bundle.write_side(suffix, None, &Quiet, |out| out.write(content.as_bytes())).unwrap();
}

/// Names in a directory with what the files hold.
fn listing(dir: &Path) -> Vec<(String, String)> {
    let mut files: Vec<_> = fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            (entry.file_name().to_string_lossy().into_owned(), fs::read_to_string(entry.path()).unwrap())
        })
        .collect();
    files.sort();
    files
}

fn pairs<const N: usize>(files: [(&str, &str); N]) -> Vec<(String, String)> {
    files.map(|(name, content)| (name.to_owned(), content.to_owned())).to_vec()
}

#[test]
fn committed_files_are_there_and_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let mut bundle = staged(&dir.path().join("fir.obj"), "mesh");
    side(&mut bundle, ".mtl", "material");
    assert!(!dir.path().join("fir.obj").exists());
    let written = bundle.commit().unwrap();
    assert_eq!(
        written,
        [("fir.obj", 4), ("fir.mtl", 8)].map(|(name, bytes)| Written {
            path: dir.path().join(name),
            bytes,
            kept: false
        })
    );
    assert_eq!(listing(dir.path()), pairs([("fir.mtl", "material"), ("fir.obj", "mesh")]));
}

#[test]
fn nothing_remains_of_a_bundle_that_is_dropped_or_fails() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("fir.obj");
    fs::write(&target, "before").unwrap();
    let mut bundle = staged(&target, "mesh");
    side(&mut bundle, ".mtl", "material");
    drop(bundle);
    let mut bundle = Bundle::create(&target).unwrap();
    let failed = bundle.write_side("_x", None, &Quiet, |out| {
        out.write(b"half")?;
        Err(linden_pipeline::Cancelled.into())
    });
    assert!(failed.is_err());
    drop(bundle);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    assert_eq!(listing(dir.path()), pairs([("fir.obj", "before")]));
}

#[test]
fn an_unfinished_bundle_is_not_committed() {
    let dir = tempfile::tempdir().unwrap();
    let mut bundle = Bundle::create(&dir.path().join("fir.obj")).unwrap();
    let _ = bundle.write_main(None, &Quiet, |_| Err(linden_pipeline::Cancelled.into()));
    assert!(bundle.commit().is_err());
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn what_was_there_is_put_back_when_a_later_file_cannot_be_placed() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["fir.obj", "fir.mtl", "oak.ply"] {
        fs::write(dir.path().join(name), "before").unwrap();
    }
    let mut fir = staged(&dir.path().join("fir.obj"), "mesh");
    side(&mut fir, ".mtl", "material");
    side(&mut fir, "_bark.png", "picture");
    let oak = staged(&dir.path().join("oak.ply"), "mesh");
    let elm = staged(&dir.path().join("zelkova.ply"), "mesh");
    // Somebody makes a directory where the last main file should go.
    fs::create_dir(dir.path().join("zelkova.ply")).unwrap();
    let said = commit_all(vec![fir, oak, elm]).unwrap_err().to_string();
    assert!(said.contains("zelkova.ply") && said.contains("directory"), "{said}");
    assert_eq!(
        listing(dir.path()),
        pairs([("fir.mtl", "before"), ("fir.obj", "before"), ("oak.ply", "before")])
    );
}

#[test]
fn the_same_target_twice_is_refused_however_it_is_written() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("sub")).unwrap();
    let a = staged(&dir.path().join("fir.obj"), "a");
    let b = staged(&dir.path().join("sub/../fir.obj"), "b");
    let bundles = vec![a, b];
    assert!(matches!(ensure_distinct(&bundles), Err(ExportError::SameTarget { .. })));
    assert!(commit_all(bundles).is_err());
    assert!(listing(dir.path()).is_empty());
}

#[test]
fn bundles_share_a_picture_only_when_it_is_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let both = |obj: &str, gltf: &str| {
        let mut a = staged(&dir.path().join("fir.obj"), "a");
        side(&mut a, "_bark.png", obj);
        let mut b = staged(&dir.path().join("fir.gltf"), "b");
        side(&mut b, "_bark.png", gltf);
        commit_all(vec![a, b])
    };
    assert!(both("red", "green").unwrap_err().to_string().contains("fir_bark.png"));
    assert!(listing(dir.path()).is_empty());
    both("red", "red").unwrap();
    assert_eq!(listing(dir.path()), pairs([("fir.gltf", "b"), ("fir.obj", "a"), ("fir_bark.png", "red")]));
}

#[test]
fn a_folder_of_pictures_holds_each_once_whoever_writes_it() {
    let dir = tempfile::tempdir().unwrap();
    let pictures = dir.path().join("pictures");
    fs::create_dir(dir.path().join("a")).unwrap();
    let write = |name: &str, picture: &[u8]| {
        let mut bundle = Bundle::create(&dir.path().join("a").join(name))
            .unwrap()
            .with_pictures_in(&pictures, "../pictures");
        let way = bundle.write_picture("_bark.png", picture, &Quiet).unwrap();
        fill(&mut bundle, name).unwrap();
        (way, bundle.commit().unwrap())
    };
    let (one, written) = write("one.obj", b"bark");
    let there = pictures.join(one.strip_prefix("../pictures/").unwrap());
    assert_eq!(fs::read(&there).unwrap(), b"bark");
    let [main, picture] = written.as_slice() else { panic!("{written:?}") };
    assert_eq!((main.bytes, &picture.path, picture.bytes), (7, &there, 4));
    let made = fs::metadata(&there).unwrap().modified().unwrap();
    // The same again is listed and left alone, another is another.
    let (two, listed) = write("two.obj", b"bark");
    assert_eq!((&two, &listed[1]), (&one, &Written { kept: true, ..picture.clone() }));
    assert_eq!(fs::metadata(&there).unwrap().modified().unwrap(), made);
    let (three, _) = write("three.obj", b"birch");
    assert_ne!(three, one);
    // What was cut off is written anew.
    fs::write(&there, b"ba").unwrap();
    write("one.obj", b"bark");
    assert_eq!(fs::read(&there).unwrap(), b"bark");
    assert_eq!((listing(&pictures).len(), listing(&dir.path().join("a")).len()), (2, 3));
}

#[test]
fn a_side_file_is_never_somebody_elses_main_file() {
    let dir = tempfile::tempdir().unwrap();
    let mut a = staged(&dir.path().join("fir.obj"), "a");
    side(&mut a, ".mtl", "x");
    let b = staged(&dir.path().join("fir.mtl"), "x");
    assert!(matches!(commit_all(vec![a, b]), Err(ExportError::SameTarget { .. })));
    assert!(listing(dir.path()).is_empty());
}

#[test]
fn targets_that_cannot_be_files_say_what_to_do() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("file"), "").unwrap();
    let locked = dir.path().join("locked.obj");
    fs::write(&locked, "").unwrap();
    let mut permissions = fs::metadata(&locked).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&locked, permissions).unwrap();
    let said = |target: &str| {
        let path = dir.path().join(target);
        let said = Bundle::create(&path).err().unwrap().to_string();
        assert_eq!(examine(&path).unwrap_err().to_string(), said, "looking says it too");
        assert!(said.contains(dir.path().to_str().unwrap()), "{said}");
        said
    };
    assert!(said(".").contains("is a directory; name a file in it"));
    assert!(said("file/").contains("is a directory"));
    assert!(said("none/fir.obj").contains("none does not exist; create it first"));
    assert!(said("file/fir.obj").contains("not a directory"));
    assert!(said("locked.obj").contains("write-protected; allow writing"));
    assert!(Bundle::create(Path::new("")).is_err());
    assert!(Bundle::create(Path::new("/")).is_err());
    assert!(Bundle::create(Path::new("..")).is_err());
}

#[test]
fn what_a_killed_program_left_is_swept_and_what_lives_is_not() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    // Process numbers are below 2^22 on Linux.
    for name in [".linden-99999999-0.part", ".linden-99999999-1.part", ".linden-new.part", "fir.part"] {
        fs::write(at(name), "left").unwrap();
    }
    let alive = fs::File::open(at(".linden-99999999-1.part")).unwrap();
    alive.lock().unwrap();
    drop(Bundle::create(&at("fir.obj")).unwrap());
    let names: Vec<_> = listing(dir.path()).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, [".linden-99999999-1.part", ".linden-new.part", "fir.part"]);
    drop(alive);
    drop(Bundle::create(&at("fir.obj")).unwrap());
    assert!(!at(".linden-99999999-1.part").exists());
}

#[test]
fn folders_are_made_and_go_again_unless_they_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("a/b/fir.obj");
    assert!(matches!(Bundle::create(&target), Err(ExportError::NoFolder { .. })));
    let made = make_folders(&target).unwrap();
    drop(Bundle::create(&target).unwrap());
    drop(made);
    assert!(!dir.path().join("a").exists());
    let made = make_folders(&target).unwrap();
    staged(&target, "mesh").unsynced().commit().unwrap();
    // Even then, what holds something stays.
    drop(made);
    assert_eq!(fs::read(&target).unwrap(), b"mesh");
    make_folders(&target).unwrap().keep();
    fs::write(dir.path().join("file"), "").unwrap();
    let said = make_folders(&dir.path().join("file/c/fir.obj")).err().unwrap().to_string();
    assert!(said.starts_with("making the directory") && said.contains("file/c"), "{said}");
}

#[test]
fn looking_at_a_target_tells_what_is_there_and_leaves_it() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("fir.obj"), "before").unwrap();
    assert_eq!(examine(&dir.path().join("fir.obj")).unwrap(), Existing::File);
    assert_eq!(examine(&dir.path().join("oak.obj")).unwrap(), Existing::Nothing);
    #[cfg(unix)]
    assert_eq!(examine(Path::new("/dev/null")).unwrap(), Existing::Stream);
    assert_eq!(listing(dir.path()), pairs([("fir.obj", "before")]));
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn permissions_are_those_of_any_new_file_or_of_the_one_before() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("ordinary"), "").unwrap();
        staged(&dir.path().join("new.obj"), "").commit().unwrap();
        assert_eq!(mode(&dir.path().join("new.obj")), mode(&dir.path().join("ordinary")));
        let old = dir.path().join("old.obj");
        fs::write(&old, "").unwrap();
        fs::set_permissions(&old, fs::Permissions::from_mode(0o640)).unwrap();
        staged(&old, "new").commit().unwrap();
        assert_eq!(mode(&old), 0o640);
        assert_eq!(fs::read_to_string(&old).unwrap(), "new");
    }

    #[test]
    fn a_link_is_written_through_and_side_files_lie_beside_the_file() {
        let dir = tempfile::tempdir().unwrap();
        let far = dir.path().join("far");
        fs::create_dir(&far).unwrap();
        for (there, content) in [("there.obj", Some("before")), ("not_yet.obj", None)] {
            if let Some(content) = content {
                fs::write(far.join(there), content).unwrap();
            }
            let link = dir.path().join(format!("link_to_{there}"));
            symlink(Path::new("far").join(there), &link).unwrap();
            let mut bundle = staged(&link, "new");
            side(&mut bundle, ".mtl", "m");
            bundle.commit().unwrap();
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            assert_eq!(fs::read_to_string(far.join(there)).unwrap(), "new");
            assert!(far.join(there).with_extension("mtl").exists());
        }
        let circle = dir.path().join("circle.obj");
        symlink("circle.obj", &circle).unwrap();
        assert!(Bundle::create(&circle).err().unwrap().to_string().contains("circle"));
    }

    #[test]
    fn a_link_and_its_file_are_the_same_target() {
        let dir = tempfile::tempdir().unwrap();
        symlink("fir.obj", dir.path().join("link.obj")).unwrap();
        let bundles =
            vec![staged(&dir.path().join("fir.obj"), "a"), staged(&dir.path().join("link.obj"), "b")];
        assert!(matches!(ensure_distinct(&bundles), Err(ExportError::SameTarget { .. })));
    }

    #[test]
    fn side_files_are_treated_as_main_ones() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("far")).unwrap();
        fs::write(at("far/shared.mtl"), "before").unwrap();
        symlink("far/shared.mtl", at("fir.mtl")).unwrap();
        let mut bundle = staged(&at("fir.obj"), "mesh");
        side(&mut bundle, ".mtl", "material");
        bundle.commit().unwrap();
        assert!(fs::symlink_metadata(at("fir.mtl")).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(at("far/shared.mtl")).unwrap(), "material");

        fs::write(at("oak.mtl"), "before").unwrap();
        fs::set_permissions(at("oak.mtl"), fs::Permissions::from_mode(0o444)).unwrap();
        fs::create_dir(at("oak_bark.png")).unwrap();
        rustix::fs::mknodat(
            rustix::fs::CWD,
            at("oak_leaf.png"),
            rustix::fs::FileType::Fifo,
            rustix::fs::Mode::from_raw_mode(0o600),
            0,
        )
        .unwrap();
        let mut bundle = staged(&at("oak.obj"), "mesh");
        for (suffix, told) in
            [(".mtl", "write-protected"), ("_bark.png", "is a directory"), ("_leaf.png", "is a pipe")]
        {
            let said = bundle.write_side(suffix, None, &Quiet, |_| Ok(())).unwrap_err().to_string();
            assert!(said.contains(told) && said.contains(&format!("oak{suffix}")), "{said}");
        }
        drop(bundle);
        assert_eq!(fs::read_to_string(at("oak.mtl")).unwrap(), "before");
    }

    /// Wants nothing any more after so many questions.
    struct Impatient(std::sync::atomic::AtomicUsize);

    impl linden_pipeline::Monitor for Impatient {
        fn is_cancelled(&self) -> bool {
            let left = self.0.load(std::sync::atomic::Ordering::Relaxed);
            self.0.store(left.saturating_sub(1), std::sync::atomic::Ordering::Relaxed);
            left == 0
        }

        fn advance(&self, _: linden_pipeline::monitor::Phase, _: u64, _: Option<u64>) {}
    }

    fn fifo(dir: &Path) -> std::path::PathBuf {
        let path = dir.join("pipe.obj");
        let mode = rustix::fs::Mode::from_raw_mode(0o600);
        rustix::fs::mknodat(rustix::fs::CWD, &path, rustix::fs::FileType::Fifo, mode, 0).unwrap();
        path
    }

    #[test]
    fn a_pipe_is_waited_for_as_long_as_somebody_wants_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = fifo(dir.path());
        // Without a reader.
        let mut bundle = Bundle::create(&path).unwrap();
        let write = |bundle: &mut Bundle, content: &[u8], questions: usize| {
            bundle.write_main(None, &Impatient(questions.into()), |out| out.write(content))
        };
        assert!(matches!(write(&mut bundle, b"mesh", 3), Err(ExportError::Cancelled(_))));
        // With one that does not read.
        let reader = fs::File::options().read(true).write(true).open(&path).unwrap();
        let full = vec![b'x'; 1 << 20];
        assert!(matches!(write(&mut bundle, &full, 40), Err(ExportError::Cancelled(_))));
        drop((reader, bundle));
        // With one that comes late.
        let mut bundle = Bundle::create(&path).unwrap();
        let reader = std::thread::spawn({
            let path = path.clone();
            move || {
                std::thread::sleep(std::time::Duration::from_millis(100));
                fs::read(path).unwrap()
            }
        });
        write(&mut bundle, &full, usize::MAX).unwrap();
        drop(bundle);
        assert!(reader.join().unwrap() == full);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_says_so() {
        let mut bundle = Bundle::create(Path::new("/dev/full")).unwrap();
        assert!(!bundle.takes_side_files());
        let said = fill(&mut bundle, "mesh").unwrap_err().to_string();
        assert!(said.contains("/dev/full") && said.contains("free some space"), "{said}");
        let mut bundle = Bundle::create(Path::new("/dev/null")).unwrap();
        fill(&mut bundle, "mesh").unwrap();
        assert!(bundle.commit().unwrap().is_empty());
        assert!(!Path::new("/dev/null").is_file());
    }
}

/// Takes some bytes and then fails, as a disk that fills up does.
struct Fills {
    room: usize,
    kind: io::ErrorKind,
}

impl Write for Fills {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.room == 0 {
            return Err(self.kind.into());
        }
        let taken = bytes.len().min(self.room);
        self.room -= taken;
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn every_refusal_of_the_system_names_the_file_and_what_to_do() {
    for (kind, advice) in [
        (io::ErrorKind::StorageFull, "free some space"),
        (io::ErrorKind::QuotaExceeded, "quota"),
        (io::ErrorKind::PermissionDenied, "choose a directory of yours"),
        (io::ErrorKind::ReadOnlyFilesystem, "write somewhere else"),
        (io::ErrorKind::FileTooLarge, "ulimit -f"),
        (io::ErrorKind::BrokenPipe, "has stopped"),
    ] {
        for room in [0, 1_000_000] {
            let mut bundle = Bundle::stream("standard output", Fills { room, kind });
            let said = bundle
                .write_main(None, &Quiet, |out| (0..100_000).try_for_each(|_| out.write(b"0123456789abcdef")))
                .unwrap_err()
                .to_string();
            assert!(said.starts_with("writing standard output failed: ") && said.contains(advice), "{said}");
            // The same of what waits until more comes, or the file ends.
            let mut bundle = Bundle::stream("standard output", Fills { room, kind });
            let lines = |out: &mut Sink<'_>| {
                records::write(out, 100_000, |text, range| {
                    range.for_each(|_| text.bytes(b"0123456789abcdef"));
                })
            };
            assert_eq!(bundle.write_main(None, &Quiet, lines).unwrap_err().to_string(), said);
        }
    }
}

#[test]
fn a_stream_holds_one_file() {
    let output = test_output::Output::default();
    let mut bundle = Bundle::stream("standard output", output.clone());
    fill(&mut bundle, "mesh").unwrap();
    assert_eq!(output.bytes(), b"mesh");
    let said = bundle.write_side(".mtl", None, &Quiet, |_| Ok(())).unwrap_err().to_string();
    assert!(said.contains("standard output") && said.contains("name a file instead"), "{said}");
    assert!(bundle.commit().unwrap().is_empty());
}

#[test]
fn a_side_file_that_a_file_of_another_export_refers_to_is_not_replaced_by_another() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let export = |name: &str, picture: &str| {
        let stem = name.split('.').next().unwrap();
        let mut bundle = staged(&path(name), &format!("of @./{stem}_bark.png@"));
        side(&mut bundle, "_bark.png", picture);
        bundle.commit()
    };
    export("oak.usda", "summer").unwrap();
    // Its own picture changes with it, and the same picture is shared.
    export("oak.usda", "autumn").unwrap();
    export("oak.gltf", "autumn").unwrap();
    let before = listing(dir.path());
    let said = export("oak.gltf", "winter").unwrap_err().to_string();
    assert!(said.contains(&format!("{}: ", path("oak_bark.png").display())), "{said}");
    assert!(said.contains(&format!("{} refers to it", path("oak.usda").display())), "{said}");
    assert_eq!(listing(dir.path()), before);
    // Both in one export, and a file that does not refer to it.
    let mut usda = staged(&path("oak.usda"), "@./oak_bark.png@");
    let mut gltf = staged(&path("oak.gltf"), "\"uri\":\"oak_bark.png\"");
    side(&mut usda, "_bark.png", "winter");
    side(&mut gltf, "_bark.png", "winter");
    commit_all(vec![usda, gltf]).unwrap();
    fs::write(path("oak.gltf"), "\"uri\":\"old_oak_bark.png\"").unwrap();
    export("oak.usda", "spring").unwrap();
}

#[test]
fn a_file_of_levels_keeps_the_pictures_that_its_library_names() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("oak_LOD0.mtl"), "map_Kd oak_bark.png\n").unwrap();
    fs::write(dir.path().join("oak_bark.png"), "summer").unwrap();
    let mut bundle = staged(&dir.path().join("oak.usda"), "@./oak_bark.png@");
    side(&mut bundle, "_bark.png", "autumn");
    let said = bundle.commit().unwrap_err().to_string();
    assert!(said.contains("oak_LOD0.mtl refers to it"), "{said}");
    fs::write(dir.path().join("oak_LOD0.obj"), "mtllib oak_LOD0.mtl\n").unwrap();
    let mut bundle = staged(&dir.path().join("oak.usda"), "@./oak_bark.png@");
    side(&mut bundle, "_bark.png", "autumn");
    let said = bundle.commit().unwrap_err().to_string();
    assert!(said.contains("oak_LOD0.obj refers to it"), "{said}");
}

#[test]
fn names_of_files_are_found_wherever_they_stand() {
    let dir = tempfile::tempdir().unwrap();
    let far = "x".repeat((1 << 16) - 9);
    for (text, is_named) in [
        ("a.png".to_owned(), true),
        (format!("{far}/a.png"), true),
        (format!("{far}/a.png@ {far}"), true),
        (format!("{far}aa.png {far}"), false),
        (format!("/a.png_{far}"), false),
        (String::new(), false),
    ] {
        let path = dir.path().join("a.usda");
        fs::write(&path, &text).unwrap();
        assert_eq!(referring::refers(&System, &path, "a.png"), is_named, "{}", text.len());
    }
    let umlaut = dir.path().join("b.gltf");
    fs::write(&umlaut, "\"uri\":\"%C3%96_bark.png\"").unwrap();
    assert!(referring::refers(&System, &umlaut, "Ö_bark.png"));
}

#[test]
fn files_with_the_same_bytes_stay_where_that_is_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("fir.obj");
    let write = |mesh: &str, material: &str, spares: bool| {
        let bundle = Bundle::create(&target).unwrap();
        let mut bundle = if spares { bundle.sparing_same() } else { bundle };
        fill(&mut bundle, mesh).unwrap();
        side(&mut bundle, ".mtl", material);
        let written = bundle.commit().unwrap();
        let kept: Vec<bool> = written.iter().map(|file| file.kept).collect();
        let written: Vec<u64> = written.iter().map(|file| file.bytes).collect();
        assert_eq!(written, [mesh.len() as u64, material.len() as u64], "files are listed, written or not");
        // A time that no write gives.
        let old = std::time::SystemTime::UNIX_EPOCH;
        let stayed = [&target, &dir.path().join("fir.mtl")].map(|path| {
            let file = fs::File::options().append(true).open(path).unwrap();
            let is_old = file.metadata().unwrap().modified().unwrap() == old;
            file.set_modified(old).unwrap();
            is_old
        });
        assert_eq!(kept, stayed, "what stayed is said");
        stayed
    };
    assert_eq!(write("mesh", "material", true), [false, false], "there was nothing");
    assert_eq!(write("mesh", "material", true), [true, true]);
    assert_eq!(write("mash", "material", true), [false, true], "as long, with other bytes");
    assert_eq!(write("mash", "longer material", true), [true, false]);
    assert_eq!(write("mash", "longer material", false), [false, false], "nobody asked for it");
    assert_eq!(listing(dir.path()), pairs([("fir.mtl", "longer material"), ("fir.obj", "mash")]));
}
