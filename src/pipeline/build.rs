//! Lists the files of `presets/`, so that adding a preset is adding a file. Those in `forests/` are
//! documents of forests, all others of trees. Says which version this is.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rustc-env=VERSION_AND_COMMIT={}", version()?);
    let out = env::var("OUT_DIR")?;
    if env::var_os("CARGO_FEATURE_PRESETS").is_none() {
        fs::write(Path::new(&out).join("builtins.rs"), "static BUILTINS: &[Builtin] = &[];\n")?;
        fs::write(Path::new(&out).join("forests.rs"), "static FORESTS: &[BuiltinForest] = &[];\n")?;
        return Ok(());
    }
    // In the repository a link to its top folder `presets`, in a published package the files themselves; where
    // links are checked out as text (Windows), the top folder.
    let package = env::var("CARGO_MANIFEST_DIR")?;
    let linked = Path::new(&package).join("presets");
    let presets = if linked.is_dir() { linked } else { Path::new(&package).join("../../presets") };
    let presets = presets.canonicalize()?;
    // Not the folder as a whole: pictures lie in it, which change more often and of which nothing is here. A new folder of
    // documents is seen when the sizes of its trees are written.
    println!("cargo::rerun-if-changed={}", presets.join("sizes.txt").display());
    let sizes = sizes(&presets.join("sizes.txt"))?;
    let mut table = String::from("static BUILTINS: &[Builtin] = &[\n");
    let mut forests = String::from("static FORESTS: &[BuiltinForest] = &[\n");
    for folder in sorted(&presets)?.iter().filter(|path| path.is_dir()) {
        let files = sorted(folder)?;
        let (documents, others): (Vec<&PathBuf>, Vec<&PathBuf>) =
            files.iter().partition(|path| path.extension().is_some_and(|e| e == "toml"));
        if !documents.is_empty() {
            println!("cargo::rerun-if-changed={}", folder.display());
        }
        let mut beside = String::new();
        for path in others.iter().filter(|path| path.extension().is_some_and(|e| e == "obj" || e == "ply")) {
            let name = path.file_name().ok_or("a file without a name")?.to_string_lossy();
            write!(beside, "({name:?}, include_bytes!({:?}).as_slice()), ", path.to_string_lossy())?;
        }
        for path in documents {
            let id = path.file_stem().ok_or("a file without a name")?.to_string_lossy();
            if folder.ends_with("forests") {
                let text = path.to_string_lossy();
                writeln!(forests, "BuiltinForest {{ id: {id:?}, text: include_str!({text:?}) }},")?;
                continue;
            }
            writeln!(
                table,
                "Builtin {{ id: {id:?}, text: include_str!({:?}), beside: &[{beside}], size: {} }},",
                path.to_string_lossy(),
                sizes.get(&*id).map_or("None", String::as_str)
            )?;
        }
    }
    table.push_str("];\n");
    forests.push_str("];\n");
    fs::write(Path::new(&out).join("builtins.rs"), table)?;
    fs::write(Path::new(&out).join("forests.rs"), forests)?;
    Ok(())
}

/// The package's version, and the commit behind it where that is known: `0.2.0 (abc1234)`.
fn version() -> Result<String, Box<dyn Error>> {
    let (version, package) = (env::var("CARGO_PKG_VERSION")?, env::var("CARGO_MANIFEST_DIR")?);
    println!("cargo::rerun-if-env-changed=LINDEN_COMMIT");
    let package = Path::new(&package);
    // Packagers say it, as there is no repository where they build. An empty one is none.
    let named = env::var("LINDEN_COMMIT").ok();
    let commit = named.or_else(|| commit_of_package(package)).or_else(|| commit_of_checkout(package));
    let commit = commit.map(|commit| commit.trim().chars().take(40).collect::<String>());
    let is_commit =
        |text: &String| !text.is_empty() && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
    Ok(match commit.filter(is_commit) {
        // A whole hash becomes what git shows of it.
        Some(commit) if commit.len() == 40 => format!("{version} ({})", &commit[..7]),
        Some(commit) => format!("{version} ({commit})"),
        None => version,
    })
}

/// What cargo notes in a package that it made.
fn commit_of_package(package: &Path) -> Option<String> {
    let note = fs::read_to_string(package.join(".cargo_vcs_info.json")).ok()?;
    let (_, rest) = note.split_once("\"sha1\"")?;
    rest.split('"').nth(1).map(str::to_owned)
}

/// That of the repository that this package is a folder of, and of no other around it.
fn commit_of_checkout(package: &Path) -> Option<String> {
    let root = package.parent()?.parent()?;
    if !package.ends_with("src/pipeline") || !root.join(".git").exists() {
        return None;
    }
    let git = |arguments: &[&str]| {
        let done = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
        let text = String::from_utf8(done.stdout).ok()?;
        done.status.success().then(|| text.trim_end().to_owned())
    };
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    // A commit moves its branch, and a branch that is packed only the log.
    for file in ["HEAD", "logs/HEAD", "packed-refs"].into_iter().chain(branch.as_deref()) {
        // A file that is not there would run this anew each time.
        if let Some(path) = git(&["rev-parse", "--git-path", file]).map(|path| root.join(path))
            && path.is_file()
        {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(&["rev-parse", "--short=7", "HEAD"])
}

/// What was measured of each preset, as Rust has it: lines of an id, metres and leaves.
fn sizes(path: &Path) -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let mut sizes = BTreeMap::new();
    for line in fs::read_to_string(path)?.lines().filter(|line| !line.starts_with('#')) {
        let [id, height, leaves] = line.split(' ').collect::<Vec<_>>()[..] else {
            return Err(format!("{}: '{line}' is not an id and two numbers", path.display()).into());
        };
        let (height, leaves): (f64, u64) = (height.parse()?, leaves.parse()?);
        let leaves = grouped(leaves);
        let size = format!("Some(BuiltinSize {{ height_m: {height:?}, leaves: {leaves} }})");
        sizes.insert(id.to_owned(), size);
    }
    Ok(sizes)
}

/// A number as code has it: `226_545`.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let is_gap = |i: usize| i > 0 && (digits.len() - i).is_multiple_of(3);
    digits.char_indices().flat_map(|(i, digit)| is_gap(i).then_some('_').into_iter().chain([digit])).collect()
}

fn sorted(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut paths =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, std::io::Error>>()?;
    paths.sort();
    Ok(paths)
}
