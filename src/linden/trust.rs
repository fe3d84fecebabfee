//! Which files a document may name: those beside it or below it, and those in folders that the user allows.
//!
//! A preset, a recipe or a forest may come from anywhere. It must not make a program read what its sender
//! could not, and show the beginning of that in a message.

use std::path::{Component, Path, PathBuf};

use linden_pipeline::knob::printable;

/// A file that a document may not name.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{}' lies neither beside the document nor below it{}", printable(.file), Via(.real.as_deref()))]
pub struct NotAllowed {
    /// As the document names it.
    pub file: String,
    /// Where a symbolic link leads.
    pub real: Option<PathBuf>,
    /// What to allow, if the document is trusted.
    pub folder: PathBuf,
}

struct Via<'a>(Option<&'a Path>);

impl std::fmt::Display for Via<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.map_or(Ok(()), |real| write!(f, " (a link leads to {})", printable(&real.to_string_lossy())))
    }
}

/// Where the file is that a document names (`None`: standard input, which stands in the working
/// directory). It lies beside the document, below it, or in one of the `allowed` folders, which are given as
/// [`std::fs::canonicalize`] gives them. There need not be such a file.
///
/// # Errors
/// [`NotAllowed`], which says nothing about whether there is one.
pub fn beside(document: Option<&Path>, file: &str, allowed: &[PathBuf]) -> Result<PathBuf, NotAllowed> {
    let folder = document.and_then(Path::parent).unwrap_or(Path::new(""));
    let path = folder.join(file);
    let refused = |real: Option<PathBuf>, named: &Path| NotAllowed {
        file: file.to_owned(),
        folder: named.parent().unwrap_or(named).to_owned(),
        real,
    };
    let (plain, here) = (plain(&path), plain(folder));
    let is_near = plain.starts_with(&here);
    if !is_near && !allowed.iter().any(|folder| plain.starts_with(folder)) {
        // A link in the way may still lead to an allowed folder; what lies elsewhere is not touched.
        let leads_there = !allowed.is_empty()
            && std::fs::canonicalize(&path)
                .is_ok_and(|real| allowed.iter().any(|folder| real.starts_with(folder)));
        return if leads_there { Ok(path) } else { Err(refused(None, &plain)) };
    }
    let Ok(real) = std::fs::canonicalize(&path) else { return Ok(path) };
    // The document itself may be a link: what lies beside the real one is beside it too.
    let real_document = document.and_then(|real| std::fs::canonicalize(real).ok());
    let homes =
        [std::fs::canonicalize(&here).ok(), real_document.and_then(|real| real.parent().map(Path::to_owned))];
    let is_inside = homes.iter().flatten().chain(allowed).any(|home| real.starts_with(home));
    if is_inside { Ok(real) } else { Err(refused(Some(real.clone()), &real)) }
}

/// An absolute path without `.` and `..`, by its letters alone: no file system is asked.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => drop(plain.pop()),
            component => plain.push(component),
        }
    }
    // The absolute form of nothing is an error, and means here.
    if plain.as_os_str().is_empty() { std::env::current_dir().unwrap_or_default() } else { plain }
}

#[cfg(all(test, unix))]
mod tests {
    use std::fs;
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn a_document_names_what_lies_beside_or_below_it() {
        let dir = tempfile::tempdir().unwrap();
        let dir = dir.path().canonicalize().unwrap();
        let at = |name: &str| dir.join(name);
        fs::create_dir_all(at("presets/pictures")).unwrap();
        fs::create_dir(at("elsewhere")).unwrap();
        for file in ["presets/my.toml", "presets/a.png", "presets/pictures/b.png", "elsewhere/c.png", "d.png"]
        {
            fs::write(at(file), "").unwrap();
        }
        symlink(at("elsewhere/c.png"), at("presets/out.png")).unwrap();
        symlink(at("elsewhere"), at("presets/far")).unwrap();
        symlink(at("presets/a.png"), at("presets/in.png")).unwrap();
        let document = at("presets/my.toml");
        let resolve = |file: &str, allowed: &[PathBuf]| beside(Some(&document), file, allowed);

        let absolute = at("presets/a.png");
        for file in ["a.png", "./a.png", "pictures/b.png", "pictures/../a.png", "in.png", "../presets/a.png"]
        {
            assert!(resolve(file, &[]).unwrap().is_file(), "{file}");
        }
        assert_eq!(resolve(absolute.to_str().unwrap(), &[]), Ok(absolute));
        // What is not there is for its reader to complain about.
        assert_eq!(resolve("none.png", &[]), Ok(at("presets/none.png")));

        let outside = at("elsewhere/c.png");
        let cases = [
            "../d.png",
            "../elsewhere/c.png",
            outside.to_str().unwrap(),
            "out.png",
            "far/c.png",
            "/etc/passwd",
            "..",
            "/",
        ];
        for file in cases {
            let said = resolve(file, &[]).unwrap_err().to_string();
            assert!(said.contains("lies neither beside"), "{file}: {said}");
        }
        let refused = resolve("out.png", &[]).unwrap_err();
        assert!(refused.to_string().contains("elsewhere/c.png)"), "{refused}");
        assert_eq!(refused.folder, at("elsewhere"));
        for file in ["../elsewhere/c.png", outside.to_str().unwrap(), "out.png", "far/c.png"] {
            assert!(resolve(file, &[at("elsewhere")]).unwrap().is_file(), "{file}");
        }
        assert!(resolve("../d.png", &[at("elsewhere")]).is_err());
        // Beginning with the same letters is not lying in it.
        fs::create_dir(at("presets-of-others")).unwrap();
        fs::write(at("presets-of-others/e.png"), "").unwrap();
        assert!(resolve("../presets-of-others/e.png", &[]).is_err());
    }

    #[test]
    fn a_refusal_does_not_tell_whether_there_is_such_a_file() {
        let dir = tempfile::tempdir().unwrap();
        let document = dir.path().join("my.toml");
        let said =
            |file: &str| beside(Some(&document), file, &[]).unwrap_err().to_string().replace(file, "X");
        assert_eq!(said("/etc/passwd"), said("/etc/no-such-file"));
    }

    #[test]
    fn what_a_link_to_a_document_leads_to_is_beside_it() {
        let dir = tempfile::tempdir().unwrap();
        let dir = dir.path().canonicalize().unwrap();
        fs::create_dir_all(dir.join("dotfiles")).unwrap();
        fs::create_dir_all(dir.join("presets")).unwrap();
        for file in ["my.toml", "my.obj"] {
            fs::write(dir.join("dotfiles").join(file), "").unwrap();
            symlink(dir.join("dotfiles").join(file), dir.join("presets").join(file)).unwrap();
        }
        let document = dir.join("presets/my.toml");
        assert_eq!(beside(Some(&document), "my.obj", &[]), Ok(dir.join("dotfiles/my.obj")));
    }
}
