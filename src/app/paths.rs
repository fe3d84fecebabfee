//! Paths as they are shown, typed and compared.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use linden::knob::{excerpt, printable};

/// A path in a message: what a terminal would obey in it is made visible.
pub fn show(path: &Path) -> String {
    printable(&path.to_string_lossy())
}

/// A path as it was typed: `~/` is the home directory, `$NAME` and `${NAME}` are variables of the environment, and `$$`
/// is a dollar. (On a command line the shell has done that.)
///
/// # Errors
/// What it names and is not known, as a sentence: nothing is to be written into a folder that is called `$HOME`.
pub fn expand(typed: &str) -> Result<PathBuf, String> {
    expand_with(typed, std::env::home_dir().as_deref(), &|name| std::env::var_os(name))
}

/// The same with a home directory and variables that are given.
///
/// # Errors
/// What it names and is not known.
pub fn expand_with(
    typed: &str,
    home: Option<&Path>,
    variable: &dyn Fn(&str) -> Option<OsString>,
) -> Result<PathBuf, String> {
    let Some(rest) = typed.strip_prefix('~') else { return Ok(with_variables(typed, variable)?.into()) };
    let user = &rest[..rest.find(std::path::is_separator).unwrap_or(rest.len())];
    if !user.is_empty() {
        let user = excerpt(user);
        return Err(format!(
            "~{user} would be another user's home, which linden does not look up; type its path, or ./~{user} for what is called so"
        ));
    }
    let Some(home) = home else {
        return Err("~ is the home directory, and there is none: HOME is not set".to_owned());
    };
    match rest.trim_start_matches(std::path::is_separator) {
        "" => Ok(home.to_owned()),
        rest => Ok(home.join(with_variables(rest, variable)?)),
    }
}

fn with_variables(typed: &str, variable: &dyn Fn(&str) -> Option<OsString>) -> Result<OsString, String> {
    let mut path = OsString::new();
    let mut rest = typed;
    while let Some((before, after)) = rest.split_once('$') {
        path.push(before);
        if let Some(after) = after.strip_prefix('$') {
            path.push("$");
            rest = after;
            continue;
        }
        let braced = after.strip_prefix('{').map(|inner| inner.split_once('}').unwrap_or((inner, "")));
        let (name, behind) = braced.unwrap_or_else(|| {
            after
                .split_at(after.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(after.len()))
        });
        if name.is_empty() && braced.is_none() {
            // Nothing that could be a name follows.
            path.push("$");
        } else {
            // Of an empty one the path would begin at the root.
            let value = variable(name).filter(|value| !value.is_empty());
            path.push(value.ok_or_else(|| {
                let name = excerpt(name);
                format!("the variable ${name} is not set; type what it stands for, or $${name} for what is called so")
            })?);
        }
        rest = behind;
    }
    path.push(rest);
    Ok(path)
}

/// What is to be typed for a path or a name to mean just that.
pub fn typed(path: &str) -> String {
    let path = path.replace('$', "$$");
    if path.starts_with('~') { format!("./{path}") } else { path }
}

/// Whether what is typed begins as paths do, and no name does.
pub fn begins_path(typed: &str) -> bool {
    ["/", "~", "$", "./", "../"].iter().any(|start| typed.starts_with(start))
        || Path::new(typed).is_absolute()
}

/// Whether a path leads to one of these files, however both are written. What is not there, or not any more, is none.
pub fn is_one_of(path: &Path, files: &[PathBuf]) -> bool {
    let Ok(real) = path.canonicalize() else { return false };
    files.iter().any(|file| file.canonicalize().is_ok_and(|file| file == real))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expanded(typed: &str, home: Option<&str>) -> Result<PathBuf, String> {
        let variable = |name: &str| match name {
            "TREES" => Some("/data/trees".into()),
            "EMPTY" => Some(OsString::new()),
            _ => None,
        };
        expand_with(typed, home.map(Path::new), &variable)
    }

    #[test]
    fn only_a_leading_tilde_means_home() {
        for (typed, path) in [
            ("~/a b/fir.glb", "/h/a b/fir.glb"),
            ("~", "/h"),
            ("~/", "/h"),
            ("a/~/fir.glb", "a/~/fir.glb"),
            ("./~x/fir.glb", "./~x/fir.glb"),
        ] {
            assert_eq!(expanded(typed, Some("/h")), Ok(path.into()), "{typed}");
        }
        assert!(expanded("~/fir.glb", None).unwrap_err().contains("HOME is not set"));
        for typed in ["~x/fir.glb", "~x"] {
            let why = expanded(typed, Some("/h")).unwrap_err();
            assert!(why.contains("~x would be another user's home") && why.contains("./~x"), "{why}");
        }
    }

    #[test]
    fn variables_are_what_they_say_and_those_that_are_not_set_are_refused() {
        for (typed, path) in [
            ("$TREES/fir.glb", "/data/trees/fir.glb"),
            ("${TREES}2/fir.glb", "/data/trees2/fir.glb"),
            ("~/$TREES", "/data/trees"),
            ("a/$$TREES/$", "a/$TREES/$"),
            ("a$ b/$.glb", "a$ b/$.glb"),
        ] {
            assert_eq!(expanded(typed, Some("/h")), Ok(path.into()), "{typed}");
        }
        for typed in ["$HOUSE/fir.glb", "a/${HOUSE}", "${HOUSE", "$HOUSE"] {
            let why = expanded(typed, Some("/h")).unwrap_err();
            assert!(
                why.contains("the variable $HOUSE is not set") && why.contains("$$HOUSE"),
                "{typed}: {why}"
            );
        }
        assert!(expanded("$EMPTY/fir.glb", None).is_err(), "that would be at the root");
        assert!(expanded("${}/fir.glb", None).is_err());
    }

    #[test]
    fn what_is_typed_for_a_name_means_that_name() {
        for name in ["fir.glb", "$HOME", "a$b$$c", "~x", "~", "~/x", "/a/$b"] {
            let path = expanded(&typed(name), Some("/h")).unwrap();
            assert_eq!(path.strip_prefix("./").unwrap_or(&path), Path::new(name), "{name}");
        }
    }
}
