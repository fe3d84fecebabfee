//! Tells when files change: the configuration, and what the current tree was read from.
//!
//! The operating system is asked to tell; nothing is polled and no thread wakes while nothing changes.
//! Directories are watched, never files: editors save by renaming a new file over the old one. A
//! directory that does not exist yet is waited for at the nearest one above it that does. Links are
//! followed, to directories as well as to files. Changes that come close together are told together.
//!
//! Where the system cannot tell (its limits are reached, a network drive) linden works without; only
//! reading again is then the user's to ask for.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use notify::event::{AccessKind, AccessMode};
use notify::{ErrorKind, Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use super::Complaint;

/// Changes are told when so long nothing more has changed: an editor's save is several changes.
const QUIET: Duration = Duration::from_millis(100);
/// Where something changes all the time, changes are told this long after the first.
const AT_MOST: Duration = Duration::from_secs(1);
/// How far below a directory is watched: `presets/GROUP/`.
const DEPTH: usize = 2;
/// The most directories that are watched; a link to a whole disk must not use up what the system has.
const MAX_DIRECTORIES: usize = 500;
/// The most entries of a directory that are looked at for links and directories.
const MAX_ENTRIES: usize = 10_000;

/// Watches until it is dropped.
#[derive(Debug)]
pub struct Watch {
    state: Arc<Mutex<State>>,
    sender: Sender<WatchMessage>,
}

/// What the thread is told.
enum WatchMessage {
    /// Something happened, or watching failed.
    Happened(notify::Result<Event>),
    /// The end.
    Stop,
}

/// What is watched, shared by [`Watch`] and its thread.
#[derive(Debug, Default)]
struct State {
    /// `None` where the system cannot tell, and after the end.
    watcher: Option<RecommendedWatcher>,
    /// Directories whose content matters.
    roots: Vec<PathBuf>,
    /// Files that matter wherever they are.
    files: Vec<PathBuf>,
    /// Watched directories by their real path, and what of them matters.
    watched: BTreeMap<PathBuf, BTreeSet<Interest>>,
    /// What could not be watched and has not been told.
    complaints: Vec<Complaint>,
    /// Directories that were complained about; once is enough.
    refused: BTreeSet<PathBuf>,
}

/// What matters in a directory, and what it is called there.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Interest {
    /// Everything, under this name of the directory.
    All(PathBuf),
    /// One entry: its name there, and the path that is told when it changes.
    One(OsString, PathBuf),
}

impl Watch {
    /// Watches directories, and those below them to a depth of two; none of them needs to exist.
    ///
    /// `on_change` is called on another thread with the paths that changed, sorted, each once, as
    /// they lie below the given ones; a directory among them stands for all that is in it.
    pub fn new(
        directories: &[PathBuf],
        on_change: impl Fn(Vec<PathBuf>) + Send + 'static,
    ) -> (Self, Vec<Complaint>) {
        let (sender, receiver) = mpsc::channel();
        let happened = sender.clone();
        let watcher = notify::recommended_watcher(move |event| {
            // There is nothing left to tell when this fails.
            let _ = happened.send(WatchMessage::Happened(event));
        });
        let mut state = State { roots: directories.to_vec(), ..State::default() };
        match watcher {
            Ok(watcher) => state.watcher = Some(watcher),
            Err(error) => {
                let first = directories.first().map_or(Path::new("."), PathBuf::as_path);
                state.complaints.push(cannot_watch(first, &error));
            }
        }
        state.arrange();
        let state = Arc::new(Mutex::new(state));
        let shared = Arc::clone(&state);
        let thread = std::thread::Builder::new().name("watch".to_owned());
        if let Err(error) = thread.spawn(move || run(&shared, &receiver, &on_change)) {
            let mut state = lock(&state);
            state.watcher = None;
            let complaint = cannot_watch(Path::new("."), &notify::Error::io(error));
            state.complaints.push(complaint);
        }
        let watch = Self { state, sender };
        let complaints = watch.complaints();
        (watch, complaints)
    }

    /// Watches these files too, instead of those that were given before: what the current tree was
    /// read from. Others beside them are not told of.
    pub fn also(&self, files: &[PathBuf]) -> Vec<Complaint> {
        let mut state = lock(&self.state);
        files.clone_into(&mut state.files);
        state.arrange();
        std::mem::take(&mut state.complaints)
    }

    /// What could not be watched since this was last asked; limits may be reached at any time.
    pub fn complaints(&self) -> Vec<Complaint> {
        std::mem::take(&mut lock(&self.state).complaints)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.sender.send(WatchMessage::Stop);
        // Not under the lock: its thread may be calling us.
        let watcher = lock(&self.state).watcher.take();
        drop(watcher);
    }
}

/// A panic elsewhere leaves the state as usable as any other moment does.
fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Waits for changes, gathers them, tells them.
fn run(state: &Mutex<State>, receiver: &Receiver<WatchMessage>, on_change: &impl Fn(Vec<PathBuf>)) {
    while let Ok(WatchMessage::Happened(event)) = receiver.recv() {
        let mut changed = lock(state).note(event);
        if changed.is_empty() {
            continue;
        }
        let end = Instant::now() + AT_MOST;
        let mut quiet_from = Instant::now() + QUIET;
        loop {
            let wait = quiet_from.min(end).saturating_duration_since(Instant::now());
            match receiver.recv_timeout(wait) {
                Ok(WatchMessage::Happened(event)) => {
                    let more = lock(state).note(event);
                    if !more.is_empty() {
                        quiet_from = Instant::now() + QUIET;
                        changed.extend(more);
                    }
                }
                Err(RecvTimeoutError::Timeout) => break,
                Ok(WatchMessage::Stop) | Err(RecvTimeoutError::Disconnected) => return,
            }
        }
        // Directories may have come or gone.
        lock(state).arrange();
        on_change(changed.into_iter().collect());
    }
}

impl State {
    /// What an event says about what matters; empty for anything else.
    fn note(&mut self, event: notify::Result<Event>) -> BTreeSet<PathBuf> {
        let event = match event {
            Ok(event) => event,
            Err(error) => {
                let path = error.paths.first().cloned().unwrap_or_default();
                self.complain(&path, &error);
                return BTreeSet::new();
            }
        };
        if event.need_rescan() {
            // Changes were lost: anything may have changed.
            return self.roots.iter().chain(&self.files).cloned().collect();
        }
        // That linden reads is no change.
        if matches!(event.kind, EventKind::Access(kind) if kind != AccessKind::Close(AccessMode::Write)) {
            return BTreeSet::new();
        }
        event.paths.iter().flat_map(|path| self.meant(path)).collect()
    }

    /// The paths that are told when this one changes.
    fn meant(&self, path: &Path) -> BTreeSet<PathBuf> {
        let mut meant = BTreeSet::new();
        // A watched directory itself: it went, or its permissions changed.
        for interest in self.watched.get(path).into_iter().flatten() {
            meant.insert(match interest {
                Interest::All(told) | Interest::One(_, told) => told.clone(),
            });
        }
        let (Some(dir), Some(name)) = (path.parent(), path.file_name()) else { return meant };
        for interest in self.watched.get(dir).into_iter().flatten() {
            match interest {
                Interest::All(told) if !is_passing(name) => {
                    meant.insert(told.join(name));
                }
                Interest::One(file, told) if file == name => {
                    meant.insert(told.clone());
                }
                _ => {}
            }
        }
        meant
    }

    /// Watches what is to be watched now, and nothing else.
    fn arrange(&mut self) {
        let Some(mut watcher) = self.watcher.take() else { return };
        let wanted = self.wanted();
        for gone in self.watched.keys().filter(|dir| !wanted.contains_key(*dir)) {
            // It fails where the directory itself is gone, and its watch with it.
            let _ = watcher.unwatch(gone);
        }
        let mut watched = BTreeMap::new();
        for (dir, interests) in wanted {
            // Also what is watched already: a directory that was replaced has lost its watch.
            match watcher.watch(&dir, RecursiveMode::NonRecursive) {
                Ok(()) => {
                    watched.insert(dir, interests);
                }
                Err(error) => self.complain(&dir, &error),
            }
        }
        self.watched = watched;
        self.watcher = Some(watcher);
    }

    fn complain(&mut self, path: &Path, error: &notify::Error) {
        let is_gone = match &error.kind {
            ErrorKind::PathNotFound | ErrorKind::WatchNotFound => true,
            ErrorKind::Io(error) => error.kind() == std::io::ErrorKind::NotFound,
            _ => false,
        };
        // What went between looking and watching is found again when something else changes.
        if !is_gone && self.refused.insert(path.to_owned()) {
            self.complaints.push(cannot_watch(path, error));
        }
    }

    /// The directories to watch, by their real paths.
    fn wanted(&self) -> BTreeMap<PathBuf, BTreeSet<Interest>> {
        let mut wanted = Wanted(BTreeMap::new());
        for root in &self.roots {
            wanted.directory(root, DEPTH);
            // That it comes, or is replaced, is told by the one above it.
            wanted.one(root, root);
        }
        for file in &self.files {
            wanted.one(file, file);
            wanted.target(file);
        }
        wanted.0
    }
}

/// Collects directories to watch.
struct Wanted(BTreeMap<PathBuf, BTreeSet<Interest>>);

impl Wanted {
    fn add(&mut self, real: PathBuf, interest: Interest) {
        if self.0.len() < MAX_DIRECTORIES || self.0.contains_key(&real) {
            self.0.entry(real).or_default().insert(interest);
        }
    }

    /// All of a directory, and of those in it, to a depth.
    fn directory(&mut self, dir: &Path, depth: usize) {
        let Ok(real) = fs::canonicalize(dir) else { return };
        let Ok(read) = fs::read_dir(&real) else { return };
        self.add(real, Interest::All(dir.to_owned()));
        for entry in read.take(MAX_ENTRIES).flatten() {
            let Ok(kind) = entry.file_type() else { continue };
            if is_passing(&entry.file_name()) {
                continue;
            }
            let told = dir.join(entry.file_name());
            if depth > 0 && (kind.is_dir() || (kind.is_symlink() && told.is_dir())) {
                self.directory(&told, depth - 1);
            } else if kind.is_symlink() {
                self.target(&told);
            }
        }
    }

    /// One entry, in the directory it is in; where that does not exist, the nearest one above it that
    /// does, and of it the entry that leads there.
    fn one(&mut self, path: &Path, told: &Path) {
        let (Some(dir), Some(name)) = (path.parent(), path.file_name()) else { return };
        let dir = if dir.as_os_str().is_empty() { Path::new(".") } else { dir };
        match fs::canonicalize(dir) {
            Ok(real) => self.add(real, Interest::One(name.to_owned(), told.to_owned())),
            Err(_) => self.one(dir, told),
        }
    }

    /// The file that a link leads to.
    fn target(&mut self, link: &Path) {
        if let Ok(real) = fs::canonicalize(link)
            && let (Some(dir), Some(name)) = (real.parent(), real.file_name())
        {
            self.add(dir.to_owned(), Interest::One(name.to_owned(), link.to_owned()));
        }
    }
}

/// Whether a file is one that editors and we ourselves make beside the real one for a moment.
fn is_passing(name: &OsStr) -> bool {
    let name = name.as_encoded_bytes();
    // `4913` is how vim asks whether it may write in a directory.
    name.starts_with(b".") || name.ends_with(b"~") || name == b"4913"
}

fn cannot_watch(path: &Path, error: &notify::Error) -> Complaint {
    let limit = match &error.kind {
        ErrorKind::MaxFilesWatch => Some("fs.inotify.max_user_watches"),
        // EMFILE: of inotify_init it means the user's limit, 24 on every Unix.
        ErrorKind::Io(error) if error.raw_os_error() == Some(24) => Some("fs.inotify.max_user_instances"),
        _ => None,
    };
    let reason = match limit {
        Some(limit) => format!("the system's limit is reached; raise {limit}"),
        None => match &error.kind {
            ErrorKind::Io(error) => error.to_string(),
            ErrorKind::Generic(text) => text.clone(),
            other => format!("{other:?}"),
        },
    };
    Complaint::new(path, format!("is not watched for changes: {reason}; until then, read it again by hand"))
}

#[cfg(test)]
#[path = "watch_tests.rs"]
mod tests;
