//! Pictures that several files refer to: those of a plant's levels and seasons, where each takes a file of its
//! own, and those of many exports in one folder.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use linden_pipeline::Monitor;
use xxhash_rust::xxh3::xxh3_128;

use super::commit::Written;
use super::file_system::again;
use super::folders::make_folders_on;
use super::staged::Staged;
use super::sweep::sweep;
use super::{Bundle, Place, located_file, stem};
use crate::ExportError;

/// The pictures of all bundles that are committed together: what is under which name.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// By folder and name a fingerprint of the bytes.
    taken: Arc<Mutex<BTreeMap<(PathBuf, OsString), u128>>>,
}

/// A bundle's part in them.
pub(super) struct Membership {
    pictures: Pictures,
    /// What names of pictures that others may refer to start with, most others first; at least one.
    pub(super) families: Vec<String>,
}

impl Pictures {
    /// The file of a family that holds a content.
    fn find(&self, dir: &Path, family: &str, fingerprint: u128) -> Option<String> {
        let taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let mut names = taken.iter().filter(|((folder, _), there)| folder == dir && **there == fingerprint);
        names.find_map(|((_, name), _)| {
            let name = name.to_str()?;
            name.strip_prefix(family)?.starts_with('_').then(|| name.to_owned())
        })
    }

    /// Whether a file of this content stands under a name, or may.
    fn take(&self, dir: &Path, name: &str, fingerprint: u128) -> Taken {
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (dir.to_owned(), OsString::from(name));
        match taken.get(&key) {
            Some(&there) if there == fingerprint => Taken::Same,
            Some(_) => Taken::Other,
            None => {
                taken.insert(key, fingerprint);
                Taken::Free
            }
        }
    }
}

/// A folder of pictures that are named by what they hold.
pub(super) struct PictureFolder {
    path: PathBuf,
    /// From the folder of the main file to it, with `/`.
    reference: String,
}

#[derive(PartialEq, Eq)]
enum Taken {
    /// It was free, and is taken now.
    Free,
    /// The same bytes are there.
    Same,
    /// Other bytes are there.
    Other,
}

impl Bundle {
    /// Lets a bundle share pictures with the others of an export. Those of one family, a path like
    /// `oak.obj` of which theirs are `oak_LOD0.obj` and `oak_LOD1.obj`, write each picture once, as
    /// `oak_bark.png`. There may be families within families: `oak_autumn.obj` of `oak_autumn_LOD0.obj`.
    /// All bundles of an export must be committed together.
    #[must_use]
    pub fn sharing(mut self, pictures: &Pictures, families: &[PathBuf]) -> Self {
        let families = families.iter().map(|family| stem::plain(family)).collect();
        self.membership = Some(Membership { pictures: pictures.clone(), families });
        self
    }

    /// Keeps pictures in a folder, named by their bytes: exports that have the same pictures, now or later and by
    /// any number of programs, share the files. The folder is made when it is needed. `reference` is the way to
    /// it from the main file's folder, like `../pictures`.
    #[must_use]
    pub fn with_pictures_in(mut self, folder: &Path, reference: &str) -> Self {
        self.picture_folder =
            Some(PictureFolder { path: folder.to_owned(), reference: reference.to_owned() });
        self
    }

    /// Writes a picture into the folder of all pictures, unless it is there; gives the way to it.
    fn write_into(
        &mut self,
        folder: &PictureFolder,
        ending: &str,
        bytes: &[u8],
        monitor: &dyn Monitor,
    ) -> Result<String, ExportError> {
        let name = format!("{:032x}.{ending}", xxh3_128(bytes));
        let path = folder.path.join(&name);
        make_folders_on(self.system, &path)?.keep();
        let location = located_file(self.system, &path)?;
        let Place::Files(files) = &mut self.place else { return Ok(name) };
        let length = bytes.len() as u64;
        let is_there =
            again(|| self.system.metadata(&location.path())).is_ok_and(|there| there.len() == length);
        if is_there {
            files.there.push(Written { path: location.shown_path(), bytes: length, kept: true });
        } else {
            sweep(self.system, &location.folder);
            let mut picture = Staged::create(self.system, location)?;
            picture.write(Some(length), monitor, |out| out.write(bytes))?;
            files.sides.push(picture);
        }
        Ok(format!("{}/{name}", folder.reference))
    }

    /// Writes a picture beside the main file or into the [folder of all pictures](Bundle::with_pictures_in),
    /// unless one with the same bytes that it may refer to is there; gives the name of the file, or the way to it
    /// from the main file's folder, with `/`.
    ///
    /// # Errors
    /// As [`Bundle::write_side`].
    pub fn write_picture(
        &mut self,
        suffix: &str,
        bytes: &[u8],
        monitor: &dyn Monitor,
    ) -> Result<String, ExportError> {
        let own_name = self.side_name(suffix);
        if let Some(folder) = self.picture_folder.take_if(|_| matches!(self.place, Place::Files(_))) {
            let ending = suffix.rsplit_once('.').map_or("png", |(_, ending)| ending);
            let written = self.write_into(&folder, ending, bytes, monitor);
            self.picture_folder = Some(folder);
            return written;
        }
        let beside = match &self.place {
            Place::Files(files) => Some((files.main.location.folder.as_path(), &files.stem)),
            Place::Memory(files) => Some((Path::new(""), &files.stem)),
            Place::Pipe { .. } | Place::Stream { .. } => None,
        };
        let (name, taken) = match (&self.membership, beside) {
            (Some(Membership { pictures, families }), Some((folder, own_stem))) => {
                let fingerprint = xxh3_128(bytes);
                let mut there = families.iter().map(|family| pictures.find(folder, family, fingerprint));
                if let Some(there) = there.find_map(|found| found) {
                    return Ok(there);
                }
                let plain = stem::plain_suffix(suffix);
                let (stem, ending) = plain.rsplit_once('.').unwrap_or((&plain, "png"));
                let numbered = (2..).map(|number| format!("{own_stem}{stem}_{number}.{ending}"));
                let of_families = families.iter().map(|family| format!("{family}{plain}"));
                let mut names = of_families.chain([own_name.clone()]).chain(numbered);
                let found = names.find_map(|name| match pictures.take(folder, &name, fingerprint) {
                    Taken::Other => None,
                    taken => Some((name, taken)),
                });
                found.unwrap_or((own_name, Taken::Free))
            }
            _ => (own_name, Taken::Free),
        };
        if taken != Taken::Same {
            self.write_named(&name, Some(bytes.len() as u64), monitor, |out| out.write(bytes))?;
        }
        Ok(name)
    }
}
