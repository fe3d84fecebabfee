//! Lists the files of `presets/`, so that adding a preset is adding a file. Those in `forests/` are
//! documents of forests, all others of trees.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let presets = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../../presets").canonicalize()?;
    println!("cargo::rerun-if-changed={}", presets.display());
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
                "Builtin {{ id: {id:?}, text: include_str!({:?}), beside: &[{beside}] }},",
                path.to_string_lossy()
            )?;
        }
    }
    table.push_str("];\n");
    forests.push_str("];\n");
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join("builtins.rs"), table)?;
    fs::write(Path::new(&out).join("forests.rs"), forests)?;
    Ok(())
}

fn sorted(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut paths =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, std::io::Error>>()?;
    paths.sort();
    Ok(paths)
}
