//! What programs that were killed have left, tidied up.

use std::fs::File;
use std::io;
use std::path::Path;

use super::file_system::{FileSystem, again};
use super::record::complete;
use super::temporary::{PART, RECORD, is_at, is_known, is_ours};
use crate::system::TELLS_FILES_APART;

/// Tidies up what programs that were killed have left in a folder. What they were about to place together
/// is completed; then files with our temporary names go whose lock is free. What cannot be looked at is
/// left.
pub(super) fn sweep(system: &dyn FileSystem, folder: &Path) {
    let Ok(names) = again(|| system.names(folder)) else { return };
    let of_kind = |suffix: &'static str| {
        let ours = names.iter().filter(move |name| is_ours(name, suffix)).map(|name| folder.join(name));
        ours.filter(|path| !is_known(path))
    };
    for path in of_kind(RECORD) {
        match left(system, &path) {
            // What it speaks of is left for a system that can complete it.
            Left::Ours(_) if !TELLS_FILES_APART => return,
            Left::Ours(record) => {
                if complete(system, &record).is_err() {
                    return;
                }
                let _ = again(|| system.remove(&path));
            }
            Left::Nothing => {}
            // What it speaks of is not left: a program is at work, or tidies up.
            Left::InUse => return,
        }
    }
    for path in of_kind(PART) {
        if let Left::Ours(_locked) = left(system, &path) {
            let _ = again(|| system.remove(&path));
        }
    }
}

/// What a name of ours stands for.
enum Left {
    /// What a program that is gone has left, locked now.
    Ours(File),
    /// A file of a program that lives, or one that cannot be looked at.
    InUse,
    /// No file of ours, or none any more.
    Nothing,
}

fn left(system: &dyn FileSystem, path: &Path) -> Left {
    let file = match again(|| system.open(path)) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Left::Nothing,
        Err(_) => return Left::InUse,
    };
    if !file.metadata().is_ok_and(|meta| meta.is_file()) {
        return Left::Nothing;
    }
    match again(|| system.try_lock(&file)) {
        Ok(true) if is_at(system, &file, path).unwrap_or(false) => Left::Ours(file),
        Ok(true) => Left::Nothing,
        _ => Left::InUse,
    }
}
