//! Paths as they are shown, typed and compared.

use std::path::{Path, PathBuf};

use linden::knob::printable;

/// A path in a message: what a terminal would obey in it is made visible.
pub fn show(path: &Path) -> String {
    printable(&path.to_string_lossy())
}

/// A path as it was typed: `~/` is the home directory, where one is known. (On a command line the
/// shell has done that.)
pub fn expand(typed: &str, home: Option<&Path>) -> PathBuf {
    match (typed.strip_prefix("~/"), home) {
        (Some(rest), Some(home)) => home.join(rest),
        (None, Some(home)) if typed == "~" => home.to_owned(),
        _ => PathBuf::from(typed),
    }
}

/// Whether a path leads to one of these files, however both are written. What is not there, or not any more, is none.
pub fn is_one_of(path: &Path, files: &[PathBuf]) -> bool {
    let Ok(real) = path.canonicalize() else { return false };
    files.iter().any(|file| file.canonicalize().is_ok_and(|file| file == real))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_leading_tilde_means_home() {
        let home = Some(Path::new("/h"));
        assert_eq!(expand("~/a b/fir.glb", home), Path::new("/h/a b/fir.glb"));
        assert_eq!(expand("~", home), Path::new("/h"));
        assert_eq!(expand("~x/fir.glb", home), Path::new("~x/fir.glb"));
        assert_eq!(expand("a/~/fir.glb", home), Path::new("a/~/fir.glb"));
        assert_eq!(expand("~/fir.glb", None), Path::new("~/fir.glb"));
    }
}
