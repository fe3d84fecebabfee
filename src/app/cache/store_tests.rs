use std::sync::Arc;

use super::*;

fn key(number: u64) -> PictureKey {
    PictureKey::of(&[&number.to_le_bytes()])
}

fn store(folder: &Path, room: u64) -> FolderStore {
    FolderStore::new(folder.join("a/pictures"), room)
}

#[test]
fn what_was_put_is_there_for_another_run() {
    let folder = tempfile::tempdir().unwrap();
    let first = store(folder.path(), 1 << 20);
    assert_eq!(first.get(key(1)), None);
    assert!(!first.folder.exists(), "asking makes nothing");
    first.put(key(1), &[b"bark", b"", b" and moss"]);
    let second = store(folder.path(), 1 << 20);
    assert_eq!(second.get(key(1)).unwrap(), b"bark and moss");
    assert_eq!(second.get(key(2)), None);
    assert_eq!(second.counts(), Counts { hits: 1, misses: 1 });
    let bytes = (HEAD + 13) as u64;
    assert_eq!(FolderStore::contents(&second.folder).unwrap(), Contents { entries: 1, bytes });
}

#[test]
fn a_damaged_entry_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path(), 1 << 20);
    store.put(key(1), &[b"bark"]);
    let path = store.path(key(1));
    let whole = fs::read(&path).unwrap();
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 4;
        fs::write(&path, &damaged).unwrap();
        assert_eq!(store.get(key(1)), None, "byte {at}");
        fs::write(&path, &whole[..at]).unwrap();
        assert_eq!(store.get(key(1)), None, "cut to {at}");
    }
    fs::write(&path, [whole.as_slice(), b"x"].concat()).unwrap();
    assert_eq!(store.get(key(1)), None, "longer");
    // An entry under another's name.
    fs::write(store.path(key(2)), &whole).unwrap();
    assert_eq!(store.get(key(2)), None);
    store.put(key(1), &[b"bark"]);
    assert_eq!(store.get(key(1)).unwrap(), b"bark", "and is replaced");
}

#[test]
fn the_oldest_give_way() {
    let folder = tempfile::tempdir().unwrap();
    // Room for 40 entries; a run puts a quarter of them.
    let each = 1000 - HEAD;
    let content = vec![7; each];
    for run in 0..5_u64 {
        let store = store(folder.path(), 40_000);
        for number in 0..10 {
            store.put(key(run * 10 + number), &[&content]);
            // Entries of the same moment are as old as each other.
            let file = File::options().append(true).open(store.path(key(run * 10 + number))).unwrap();
            let age = Duration::from_secs(1000 - run * 100 - number);
            file.set_modified(SystemTime::now() - age).unwrap();
        }
        // Somebody asks for the first one again and again.
        assert!(store.get(key(0)).is_some(), "run {run}");
        assert!(FolderStore::contents(&store.folder).unwrap().bytes <= 40_000);
    }
    let store = store(folder.path(), 40_000);
    let is_there = |number| store.path(key(number)).exists();
    assert!(!is_there(1) && !is_there(2), "the oldest");
    assert!((40..50).all(is_there), "those that came last");
}

#[test]
fn one_run_fills_a_share_of_the_room() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path(), 40_000);
    for number in 0..100 {
        store.put(key(number), &[&[7; 1000]]);
    }
    let contents = FolderStore::contents(&store.folder).unwrap();
    assert!(contents.bytes <= 10_000 && contents.entries >= 9, "{contents:?}");
}

#[test]
fn clearing_removes_what_is_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path(), 1 << 20);
    assert_eq!(FolderStore::clear(&store.folder).unwrap(), Contents::default());
    store.put(key(1), &[b"bark"]);
    let foreign = ["letter.txt", "0.picture", "FEDCBA9876543210FEDCBA9876543210.picture"];
    for name in foreign {
        fs::write(store.folder.join(name), "dear").unwrap();
    }
    fs::write(store.folder.join(format!("{UNFINISHED}x")), "ba").unwrap();
    fs::create_dir(store.folder.join(format!("{:032x}.{ENDING}", 5))).unwrap();
    assert_eq!(FolderStore::clear(&store.folder).unwrap().entries, 1);
    assert!(foreign.iter().all(|name| store.folder.join(name).exists()));
    assert_eq!(fs::read_dir(&store.folder).unwrap().count(), foreign.len() + 1);
}

#[test]
fn what_was_abandoned_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path(), 1 << 20);
    fs::create_dir_all(&store.folder).unwrap();
    let [old, new] = ["old", "new"].map(|name| store.folder.join(format!("{UNFINISHED}{name}")));
    for (path, age) in [(&old, 2 * ABANDONED), (&new, ABANDONED / 2)] {
        fs::write(path, "ba").unwrap();
        File::options().append(true).open(path).unwrap().set_modified(SystemTime::now() - age).unwrap();
    }
    store.put(key(1), &[b"bark"]);
    assert!(!old.exists() && new.exists());
}

#[test]
fn many_may_put_and_get_the_same_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    // Two stores are as two programs: they share the folder alone.
    let stores = [(); 2].map(|()| Arc::new(store(folder.path(), 8 << 20)));
    let content = |number: u64| vec![number as u8; 20_000];
    std::thread::scope(|scope| {
        for store in stores.iter().chain(&stores) {
            scope.spawn(move || {
                for round in 0..20 {
                    for number in 0..5 {
                        if let Some(found) = store.get(key(number)) {
                            assert_eq!(found, content(number), "round {round}");
                        }
                        store.put(key(number), &[&content(number)]);
                    }
                }
            });
        }
    });
    for number in 0..5 {
        assert_eq!(stores[0].get(key(number)), Some(content(number)));
    }
    let left = fs::read_dir(&stores[0].folder).unwrap().count();
    assert_eq!(left, 5, "and nothing unfinished");
}

#[test]
fn a_folder_that_cannot_be_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), "a file").unwrap();
    let store = store(folder.path(), 1 << 20);
    store.put(key(1), &[b"bark"]);
    assert_eq!(store.get(key(1)), None);
}
