//! Says which code draws pictures, as a number: kept pictures are looked for under the number of the code that would
//! draw them.
//!
//! The number is of the files of this package, whatever their line ends, and of the versions of those crates by which
//! it calculates, where a lock file says them. What it needs of `linden-base` says `linden_base::picture`.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use xxhash_rust::xxh3::Xxh3;

/// Crates by which pictures are calculated.
const CALCULATES: [&str; 7] = ["earcut", "glam", "libm", "rand", "rand_distr", "rand_xoshiro", "xxhash-rust"];

fn main() -> Result<(), Box<dyn Error>> {
    let package = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let mut files = Vec::new();
    for entry in fs::read_dir(&package)? {
        let path = entry?.path();
        // Folders of what is built, and hidden ones, are no code.
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") && !is_hidden(&path) {
            collect(&path, &mut files)?;
        } else if is_code(&path) {
            files.push(path);
        }
    }
    // In an order that is the same on every system.
    let mut named: Vec<(String, PathBuf)> = files
        .into_iter()
        .map(|path| {
            let inside = path.strip_prefix(&package)?;
            let names: Vec<_> = inside.iter().map(|name| name.to_string_lossy()).collect();
            Ok((names.join("/"), path))
        })
        .collect::<Result<_, std::path::StripPrefixError>>()?;
    named.sort();
    let mut hasher = Xxh3::new();
    for (name, path) in named {
        let text = fs::read(&path)?;
        hasher.update(name.as_bytes());
        hasher.update(&[0]);
        for line in text.split(|byte| *byte == b'\n') {
            hasher.update(line.strip_suffix(b"\r").unwrap_or(line));
            hasher.update(b"\n");
        }
    }
    println!("cargo::rerun-if-changed={}", package.display());
    if let Some(lock) =
        package.ancestors().take(3).map(|folder| folder.join("Cargo.lock")).find(|lock| lock.is_file())
    {
        println!("cargo::rerun-if-changed={}", lock.display());
        hasher.update(versions(&fs::read_to_string(lock)?).as_bytes());
    }
    println!("cargo::rustc-env=DRAWING_SOURCE={}", hasher.digest());
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), std::io::Error> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if is_code(&path) {
            files.push(path);
        }
    }
    Ok(())
}

fn is_code(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "rs")
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

/// Lines of a lock file that say which versions of [`CALCULATES`] there are.
fn versions(lock: &str) -> String {
    let packages = lock.split("[[package]]").filter(|package| {
        let name = package.lines().find_map(|line| line.strip_prefix("name = "));
        name.is_some_and(|name| CALCULATES.contains(&name.trim().trim_matches('"')))
    });
    let lines = packages.flat_map(str::lines);
    let wanted =
        lines.map(str::trim).filter(|line| line.starts_with("name = ") || line.starts_with("version = "));
    wanted.flat_map(|line| [line, "\n"]).collect()
}
