//! Single files of the program's: settings, sessions, presets.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use super::file_system::{FileSystem, System, again, synced};
use super::staged::Staged;
use super::sweep::sweep;
use super::target::Location;
use super::temporary::placing;
use crate::system::refused;

/// Writes a whole file or nothing, as a [`Bundle`](super::Bundle) does: to the disk, and into its place in
/// one moment. A file that is there is replaced (a link is followed, and stays), or with
/// `replaces = false` left alone. `mode` is less the umask.
///
/// # Errors
/// What the operating system says; [`io::ErrorKind::AlreadyExists`] where the file is left alone.
pub fn write_file(path: &Path, bytes: &[u8], mode: u32, replaces: bool) -> io::Result<()> {
    write_file_on(&System, path, bytes, mode, replaces)
}

pub(super) fn write_file_on(
    system: &'static dyn FileSystem,
    path: &Path,
    bytes: &[u8],
    mode: u32,
    replaces: bool,
) -> io::Result<()> {
    let path = match again(|| system.canonicalize(path)) {
        Ok(target) if replaces => target,
        Err(error) if replaces && error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => path.to_owned(),
    };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    if let Some(problem) = refused(name) {
        return Err(io::Error::new(io::ErrorKind::InvalidFilename, problem));
    }
    let location = located(folder, name);
    sweep(system, folder);
    let mut staged = Staged::with_mode(system, location, mode)?;
    staged.fill(bytes)?;
    staged.sync()?;
    staged.name()?;
    {
        let _guard = placing();
        if replaces {
            again(|| system.rename(staged.temp_path(), &path))?;
            staged.placed();
        } else {
            place_new(system, staged, &path)?;
        }
    }
    synced(again(|| system.open_folder(folder)).and_then(|open| again(|| system.sync(&open))))
}

fn located(folder: &Path, name: &OsStr) -> Location {
    let folder: PathBuf = folder.to_owned();
    Location { shown_folder: folder.clone(), folder, name: name.to_owned() }
}

/// Gives a file its name if that is not taken. A link tells that and makes it in one moment.
fn place_new(system: &dyn FileSystem, staged: Staged, path: &Path) -> io::Result<()> {
    use io::ErrorKind::{PermissionDenied, Unsupported};
    match again(|| system.link(staged.temp_path(), path)) {
        // The words of file systems without links.
        Err(error) if matches!(error.kind(), PermissionDenied | Unsupported) => {}
        done => return done,
    }
    if again(|| system.symlink_metadata(path)).is_ok() {
        return Err(io::ErrorKind::AlreadyExists.into());
    }
    again(|| system.rename(staged.temp_path(), path))?;
    staged.placed();
    Ok(())
}
