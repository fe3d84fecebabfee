//! The documents: what is made from tables is as the tables are, links lead somewhere, examples are
//! understood, and pictures show what the program draws.
//!
//! `LINDEN_UPDATE=1 cargo test -p linden-tests --test docs` writes what is generated.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod clients;
mod examples;
mod generated;
mod links;
mod pictures;

use std::path::{Path, PathBuf};

/// The folder of the whole project.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The text of a file of the project.
fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Whether files are to be written instead of compared.
fn is_update() -> bool {
    std::env::var_os("LINDEN_UPDATE").is_some()
}

/// All documents, relative to the project's folder, in order.
fn pages() -> Vec<String> {
    let mut pages = Vec::new();
    let mut folders = vec![root()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && !path.is_symlink() {
                if !name.starts_with('.') && !["target", "node_modules"].contains(&name.as_str()) {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|ending| ending == "md") {
                let relative = path.strip_prefix(root()).unwrap();
                pages.push(relative.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    pages.sort_unstable();
    pages
}

/// The fenced blocks of a page in one language, with the line (from 1) that each begins in.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<(usize, &'a str)> {
    let fence = format!("```{language}\n");
    let mut found = Vec::new();
    let mut from = 0;
    while let Some(at) = page[from..].find(&fence).map(|at| from + at) {
        let start = at + fence.len();
        let end = page[start..].find("```").map_or(page.len(), |end| start + end);
        if at == 0 || page[..at].ends_with('\n') {
            found.push((page[..start].matches('\n').count() + 1, &page[start..end]));
        }
        from = end + 3;
    }
    found
}

#[test]
fn the_readme_is_one_page() {
    let lines = read("README.md").lines().count();
    assert!(lines <= 150, "README.md has {lines} lines; what is more belongs into docs/");
}

/// The README's first command names no program.
#[test]
fn cargo_run_means_linden() {
    let asked = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version=1", "--offline"])
        .current_dir(root())
        .output()
        .unwrap();
    let said: serde_json::Value = serde_json::from_slice(&asked.stdout).unwrap();
    let default = said["workspace_default_members"].as_array().unwrap();
    let packages =
        said["packages"].as_array().unwrap().iter().filter(|package| default.contains(&package["id"]));
    let targets = packages.flat_map(|package| package["targets"].as_array().unwrap());
    let programs =
        targets.filter(|target| target["kind"].as_array().unwrap().iter().any(|kind| kind == "bin"));
    assert_eq!(programs.map(|program| program["name"].as_str().unwrap()).collect::<Vec<_>>(), ["linden"]);
}

#[test]
fn there_are_documents_and_blocks() {
    let pages = pages();
    assert!(pages.contains(&"README.md".to_owned()) && pages.contains(&"docs/tutorial.md".to_owned()));
    assert!(pages.iter().all(|page| !page.contains("target/")), "{pages:?}");
    assert_eq!(blocks("a\n```sh\nx\ny\n```\n```toml\nz\n```\n", "toml"), [(7, "z\n")]);
}

#[test]
fn the_minimum_rust_is_the_same_everywhere() {
    let manifest = read("Cargo.toml");
    let (_, rest) = manifest.split_once("rust-version = \"").unwrap();
    let (minimum, _) = rest.split_once('"').unwrap();
    for path in ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", ".github/workflows/ci.yml"] {
        assert!(read(path).contains(minimum), "{path} does not say that the minimum Rust is {minimum}");
    }
}
