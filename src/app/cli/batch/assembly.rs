//! One file over those of all trees of a batch.

use std::path::{Component, Path, PathBuf};

use anyhow::Context;
use linden::Vec3;
use linden::scene::Bounds;
use linden_exporters::{Assembly, Bundle, Member, WindLoop, ensure_spared};

use super::part::say_left_out;
use super::rows::Row;
use super::table::Table;
use crate::cli::placing::explained;
use crate::exit::usage;
use crate::paths::show;
use crate::progress::Progress;

/// What an assembly is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AssemblyKind {
    /// A USD layer over USD files.
    Usd,
    /// A tileset over glTF files.
    Tiles,
}

impl AssemblyKind {
    const fn flag(self) -> &'static str {
        match self {
            Self::Usd => "--usd",
            Self::Tiles => "--tiles",
        }
    }

    /// Endings of the assembly's own file.
    const fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Usd => &["usda", "usd"],
            Self::Tiles => &["json"],
        }
    }

    /// Endings of trees' files that it names, the best first; they are the formats that write them.
    const fn of_trees(self) -> &'static [&'static str] {
        match self {
            Self::Usd => &["usda", "usdc", "usdz"],
            Self::Tiles => &["glb", "gltf"],
        }
    }
}

/// An assembly that is to be written.
pub struct Assembled {
    kind: AssemblyKind,
    bundle: Bundle,
    shown: String,
    assembly: Assembly,
}

impl Assembled {
    /// Tries the place, and puts the files of a folder together.
    pub fn new(
        kind: AssemblyKind,
        path: &Path,
        out: &Path,
        rows: &[&Row],
        table: Option<&Table>,
        sources: &[PathBuf],
    ) -> anyhow::Result<Self> {
        let (flag, shown) = (kind.flag(), show(path));
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
        if !ending.is_some_and(|ending| kind.endings().contains(&ending.as_str())) {
            let name = show(&path.with_extension(kind.endings()[0]));
            return Err(usage(format!("{flag} {shown}: name it like {name}")));
        }
        let way = way(path, out)?;
        let (mut members, mut without, mut unseen) = (Vec::new(), Vec::new(), Vec::new());
        for row in rows {
            match (row.main_file(kind.of_trees()), row.bounds_m) {
                (Some(file), Some([min, max])) => members.push(Member {
                    index: row.index as u64,
                    source: row.source.clone(),
                    seed: row.seed,
                    file: format!("{way}{file}"),
                    bounds: Bounds { min: Vec3::from(min), max: Vec3::from(max) },
                    wind: row
                        .wind_loop
                        .map(|[frames, rate]| WindLoop { frames, frames_per_second: rate.max(1) }),
                }),
                (Some(_), None) => unseen.push(row.index),
                (None, _) => without.push(row.index),
            }
        }
        let formats = kind.of_trees().join(" or ");
        if members.is_empty() {
            return Err(usage(format!(
                "{flag} names the trees' files of {formats}, and no tree has one: add \"{}\" to the formats of the \
                 manifest, and run the batch",
                kind.of_trees()[0]
            )));
        }
        say_left_out(flag, &without, &format!("not written as {formats}"));
        say_left_out(flag, &unseen, "of which nothing is to be seen");
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let name = linden::knob::printable(&name);
        let assembly = match table {
            None => Assembly::side_by_side(name, members),
            Some(table) => {
                let places = table.places(&members);
                Assembly { name, members, places }
            }
        };
        let bundle = Bundle::create(path).map_err(explained)?;
        ensure_spared(std::slice::from_ref(&bundle), sources).map_err(explained)?;
        Ok(Self { kind, bundle, shown, assembly })
    }

    /// Writes the file; gives what to tell.
    pub fn write(mut self, progress: &Progress) -> anyhow::Result<String> {
        match self.kind {
            AssemblyKind::Usd => self.assembly.write_usd(&mut self.bundle, progress),
            AssemblyKind::Tiles => self.assembly.write_tileset(&mut self.bundle, progress),
        }
        .map_err(explained)?;
        self.bundle.commit().map_err(explained)?;
        Ok(format!("{} trees in {}\n", self.assembly.places.len(), self.shown))
    }
}

/// From the folder of a file to another one, with slashes and one at the end: `./`, `./trees/`, `../`.
fn way(file: &Path, folder: &Path) -> anyhow::Result<String> {
    let from = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let whole = |path: &Path| path.canonicalize().with_context(|| format!("looking for {}", show(path)));
    let (from, to) = (whole(from)?, whole(folder)?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let is_apart = |part: Component<'_>| matches!(part, Component::Prefix(_));
    if to.components().skip(shared).any(is_apart) {
        return Err(usage(format!(
            "{} cannot name files in {}: put both on one drive",
            show(file),
            show(folder)
        )));
    }
    let up = from.components().skip(shared).map(|_| Path::new(".."));
    let down: Vec<PathBuf> = up
        .map(Path::to_owned)
        .chain(to.components().skip(shared).map(|part| PathBuf::from(part.as_os_str())))
        .collect();
    let mut way = if down.first().is_some_and(|part| part == Path::new("..")) {
        String::new()
    } else {
        "./".to_owned()
    };
    for part in &down {
        let name = part.to_str().with_context(|| {
            format!("{} cannot be named in a file: its name is not Unicode; rename it", show(part))
        })?;
        way += name;
        way.push('/');
    }
    Ok(way)
}

#[cfg(test)]
mod tests {
    #[test]
    fn ways_are_relative() {
        let root = tempfile::tempdir().unwrap();
        for folder in ["out/deep", "other"] {
            std::fs::create_dir_all(root.path().join(folder)).unwrap();
        }
        let way = |file: &str, folder: &str| {
            super::way(&root.path().join(file), &root.path().join(folder)).unwrap()
        };
        assert_eq!(way("out/a.usda", "out"), "./");
        assert_eq!(way("a.usda", "out"), "./out/");
        assert_eq!(way("out/deep/a.usda", "out"), "../");
        assert_eq!(way("other/a.usda", "out/deep"), "../out/deep/");
        assert!(super::way(&root.path().join("none/a.usda"), root.path()).is_err());
    }
}
