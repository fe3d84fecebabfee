//! A folder of entries, a file each: `KEY.picture`.
//!
//! An entry is written under another name and renamed, so that it is whole or not there, whatever other programs do
//! meanwhile. It begins with what it is, its key, its length and its sum (XXH3): whatever has become of it, what is
//! given is what was put. Its time is when it was last asked for: the oldest give way.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

use linden::picture::{PictureKey, PictureStore};
use xxhash_rust::xxh3::Xxh3;

/// What an entry begins with; the digit is the format's.
const MAGIC: [u8; 8] = *b"linden1\n";
/// Bytes before the content: magic, key, length, sum.
const HEAD: usize = 8 + 16 + 8 + 16;
/// How names of entries end.
const ENDING: &str = "picture";
/// How names of what is being written begin.
const UNFINISHED: &str = ".unfinished-";
/// What was being written so long ago will not be finished.
const ABANDONED: Duration = Duration::from_hours(1);
/// One run fills at most this share of the room: a batch of a thousand trees leaves what others keep.
const SHARE_OF_A_RUN: u64 = 4;
/// How much of the room is left once the oldest have given way, in eighths.
const LEFT_EIGHTHS: u64 = 7;

/// Pictures in a folder.
#[derive(Debug)]
pub struct FolderStore {
    folder: PathBuf,
    room: u64,
    hits: AtomicU64,
    misses: AtomicU64,
    /// What this run has put there, bytes.
    put: AtomicU64,
    /// What is there, bytes, as far as this run knows; `None` before it looked.
    held: Mutex<Option<u64>>,
}

/// How often a store had what it was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub hits: u64,
    pub misses: u64,
}

/// What is in a folder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    pub entries: u64,
    pub bytes: u64,
}

impl FolderStore {
    /// At most so many bytes in a folder, which is made when it is needed.
    pub const fn new(folder: PathBuf, room: u64) -> Self {
        Self {
            folder,
            room,
            hits: AtomicU64::new(0),
            misses: AtomicU64::new(0),
            put: AtomicU64::new(0),
            held: Mutex::new(None),
        }
    }

    /// At most so many bytes are kept.
    pub const fn room(&self) -> u64 {
        self.room
    }

    /// Since it was opened.
    pub fn counts(&self) -> Counts {
        let [hits, misses] = [&self.hits, &self.misses].map(|count| count.load(Ordering::Relaxed));
        Counts { hits, misses }
    }

    /// What is there.
    ///
    /// # Errors
    /// What reading the folder says; one that is not there is empty.
    pub fn contents(folder: &Path) -> io::Result<Contents> {
        let mut contents = Contents::default();
        for entry in entries(folder)?.iter().filter(|entry| !entry.is_unfinished) {
            contents.entries += 1;
            contents.bytes += entry.bytes;
        }
        Ok(contents)
    }

    /// Removes all entries, and nothing else that is in the folder.
    ///
    /// # Errors
    /// What removing the first one that cannot be removed says.
    pub fn clear(folder: &Path) -> io::Result<Contents> {
        let mut removed = Contents::default();
        for entry in entries(folder)? {
            match fs::remove_file(&entry.path) {
                Ok(()) if !entry.is_unfinished => {
                    removed.entries += 1;
                    removed.bytes += entry.bytes;
                }
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
        Ok(removed)
    }

    fn path(&self, key: PictureKey) -> PathBuf {
        self.folder.join(format!("{:032x}.{ENDING}", key.bits()))
    }

    fn read(&self, key: PictureKey) -> io::Result<Vec<u8>> {
        let damaged = || io::Error::from(io::ErrorKind::InvalidData);
        let mut file = File::open(self.path(key))?;
        let mut head = [0; HEAD];
        file.read_exact(&mut head)?;
        let length = file.metadata()?.len().saturating_sub(HEAD as u64);
        if length > self.room {
            return Err(damaged());
        }
        // By the head, the length is what the file has: it is not believed before.
        let mut content = Vec::with_capacity(length as usize);
        Read::by_ref(&mut file).take(length).read_to_end(&mut content)?;
        if head != head_of(key, &[&content]) {
            return Err(damaged());
        }
        // Where that is refused, an entry only looks older than it is.
        let _ = file.set_modified(SystemTime::now());
        Ok(content)
    }

    fn write(&self, key: PictureKey, parts: &[&[u8]]) -> io::Result<()> {
        let bytes = (HEAD + parts.iter().map(|part| part.len()).sum::<usize>()) as u64;
        if self.put.fetch_add(bytes, Ordering::Relaxed) + bytes > self.room / SHARE_OF_A_RUN {
            return Ok(());
        }
        fs::create_dir_all(&self.folder)?;
        let mut file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(&self.folder)?;
        file.write_all(&head_of(key, parts))?;
        parts.iter().try_for_each(|part| file.write_all(part))?;
        file.persist(self.path(key)).map_err(|error| error.error)?;
        self.make_room(bytes)
    }

    /// Lets the oldest entries give way where there are too many bytes, now that so many came.
    fn make_room(&self, came: u64) -> io::Result<()> {
        let mut held = self.held.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(known) = *held
            && known + came <= self.room
        {
            *held = Some(known + came);
            return Ok(());
        }
        let mut entries = entries(&self.folder)?;
        let now = SystemTime::now();
        let age = |entry: &Entry| now.duration_since(entry.used).unwrap_or_default();
        entries.retain(|entry| {
            let is_abandoned = entry.is_unfinished && age(entry) > ABANDONED;
            if is_abandoned {
                let _ = fs::remove_file(&entry.path);
            }
            !entry.is_unfinished
        });
        let mut bytes: u64 = entries.iter().map(|entry| entry.bytes).sum();
        if bytes > self.room {
            entries.sort_by_key(|entry| entry.used);
            for entry in entries {
                if bytes <= self.room / 8 * LEFT_EIGHTHS {
                    break;
                }
                // Another program may have removed it.
                if fs::remove_file(&entry.path).is_ok() {
                    bytes -= entry.bytes;
                }
            }
        }
        *held = Some(bytes);
        Ok(())
    }
}

impl PictureStore for FolderStore {
    fn get(&self, key: PictureKey) -> Option<Vec<u8>> {
        let found = self.read(key).ok();
        let count = if found.is_some() { &self.hits } else { &self.misses };
        count.fetch_add(1, Ordering::Relaxed);
        found
    }

    fn put(&self, key: PictureKey, parts: &[&[u8]]) {
        if let Err(error) = self.write(key, parts) {
            tracing::debug!(%error, folder = %self.folder.display(), "a picture was not kept");
        }
    }
}

fn head_of(key: PictureKey, parts: &[&[u8]]) -> [u8; HEAD] {
    let mut sum = Xxh3::new();
    for part in parts {
        sum.update(part);
    }
    let length = parts.iter().map(|part| part.len() as u64).sum::<u64>();
    let mut head = [0; HEAD];
    head[..8].copy_from_slice(&MAGIC);
    head[8..24].copy_from_slice(&key.to_bytes());
    head[24..32].copy_from_slice(&length.to_le_bytes());
    head[32..].copy_from_slice(&sum.digest128().to_le_bytes());
    head
}

/// A file of a store's.
struct Entry {
    path: PathBuf,
    bytes: u64,
    used: SystemTime,
    is_unfinished: bool,
}

/// All that is a store's in a folder.
fn entries(folder: &Path) -> io::Result<Vec<Entry>> {
    let listed = match fs::read_dir(folder) {
        Ok(listed) => listed,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let mut entries = Vec::new();
    for entry in listed {
        let path = entry?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let is_unfinished = name.starts_with(UNFINISHED);
        let is_entry = name.strip_suffix(ENDING).and_then(|stem| stem.strip_suffix('.')).is_some_and(|key| {
            key.len() == 32 && key.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
        });
        if !is_entry && !is_unfinished {
            continue;
        }
        // Another program may have removed it meanwhile; links and folders are none of ours.
        let Ok(about) = fs::symlink_metadata(&path) else { continue };
        if about.is_file() {
            let used = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            entries.push(Entry { bytes: about.len(), used, is_unfinished, path });
        }
    }
    Ok(entries)
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
