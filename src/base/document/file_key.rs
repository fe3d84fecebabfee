//! Keys that name files beside a preset: a row each. Documents, the schema and recipes are made from
//! the rows.

use super::{Entry, Fault};

/// A key of `T` that names a file, relative to the preset's.
#[derive(Clone, Copy)]
pub struct FileKey<T: 'static> {
    /// As documents have it.
    pub key: &'static str,
    /// One line: what the file is.
    pub help: &'static str,
    /// The file that it names.
    pub of: fn(&T) -> Option<&str>,
    /// Gives it a file.
    pub put: fn(&mut T, String),
}

/// Makes a [`FileKey`](crate::document::FileKey): key, help, field.
#[macro_export]
macro_rules! file_key {
    ($key:literal, $help:literal, $field:ident) => {
        $crate::document::FileKey {
            key: $key,
            help: $help,
            of: |settings| settings.$field.as_deref(),
            put: |settings, file| settings.$field = Some(file),
        }
    };
}

/// What may name files.
pub trait NamesFiles: Sized + 'static {
    /// All keys that do.
    const FILES: &'static [FileKey<Self>];

    /// The files by their keys.
    fn named_files(&self) -> impl Iterator<Item = (&'static str, &str)> {
        Self::FILES.iter().filter_map(|row| Some((row.key, (row.of)(self)?)))
    }

    /// Gives each file the name that `renamed` has for it.
    fn rename(&mut self, renamed: &impl Fn(&str) -> Option<String>) {
        for row in Self::FILES {
            if let Some(name) = (row.of)(self).and_then(renamed) {
                (row.put)(self, name);
            }
        }
    }

    /// Gives a key a file; whether there is such a key.
    fn put_file(&mut self, key: &str, file: &str) -> bool {
        let row = Self::FILES.iter().find(|row| row.key == key);
        row.inspect(|row| (row.put)(self, file.to_owned())).is_some()
    }

    /// Takes a file's name; whether the entry was one.
    ///
    /// # Errors
    /// [`Fault`]: something else than a name.
    fn take_file(&mut self, entry: &Entry) -> Result<bool, Fault> {
        let key = &entry.key;
        if Self::FILES.iter().all(|row| row.key != key) {
            return Ok(false);
        }
        let file = entry.node.text(key)?.trim();
        if file.is_empty() {
            let problem = format!("'{key}' is empty; name a file, or take the line out");
            return Err(Fault::new(entry.node.place, problem));
        }
        Ok(self.put_file(key, file))
    }
}
