//! Lists the files of `presets/`, so that adding a preset is adding a file. Those in `forests/` are
//! documents of forests, all others of trees.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
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
    println!("cargo::rerun-if-changed={}", presets.display());
    let sizes = sizes(&presets.join("sizes.txt"))?;
    let mut table = String::from("static BUILTINS: &[Builtin] = &[\n");
    let mut forests = String::from("static FORESTS: &[BuiltinForest] = &[\n");
    for folder in sorted(&presets)?.iter().filter(|path| path.is_dir()) {
        println!("cargo::rerun-if-changed={}", folder.display());
        let files = sorted(folder)?;
        let (documents, others): (Vec<&PathBuf>, Vec<&PathBuf>) =
            files.iter().partition(|path| path.extension().is_some_and(|e| e == "toml"));
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

/// What was measured of each preset, as Rust has it: lines of an id, metres and leaves.
fn sizes(path: &Path) -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let mut sizes = BTreeMap::new();
    for line in fs::read_to_string(path)?.lines().filter(|line| !line.starts_with('#')) {
        let [id, height, leaves] = line.split(' ').collect::<Vec<_>>()[..] else {
            return Err(format!("{}: '{line}' is not an id and two numbers", path.display()).into());
        };
        let (height, leaves): (f64, u64) = (height.parse()?, leaves.parse()?);
        let size = format!("Some(BuiltinSize {{ height_m: {height:?}, leaves: {leaves} }})");
        sizes.insert(id.to_owned(), size);
    }
    Ok(sizes)
}

fn sorted(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut paths =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, std::io::Error>>()?;
    paths.sort();
    Ok(paths)
}
