//! Files of one look of several of a plant, an age or a season: what they are called, and which others lie beside them.

use std::path::{Path, PathBuf};

use anyhow::Context;
use linden::Monitor;
use linden::preset::Preset;
use linden::season::{Season, is_name};
use linden_exporters::Format;
use serde_json::Value;

use crate::paths::show;
use crate::reading::{self, Content};

/// The plant and the look that a name may be of, the shortest look first: names of looks have `_` in them too.
pub fn splits(stem: &str) -> impl Iterator<Item = (&str, &str)> {
    let at = stem.rmatch_indices('_').map(|(at, _)| (&stem[..at], &stem[at + 1..]));
    at.filter(|(plant, look)| !plant.is_empty() && is_name(look))
}

/// The name without its ending and its level.
fn stem(path: &Path, format: &Format) -> Option<String> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let (stem, _) = name.split_at_checked(name.len().checked_sub(format.ending_of(path)?.len() + 1)?)?;
    Some(stem.rsplit_once("_LOD").map_or(stem, |(stem, _)| stem).to_owned())
}

/// Whether it is one of several ages or seasons: named like those that `--seasons` has, or as `oak_young.obj` beside
/// `oak_grown.obj`, which holds the same plant with the same seed.
pub fn is_one_of_several(path: &Path, format: &Format, monitor: &dyn Monitor) -> anyhow::Result<bool> {
    let Some(stem) = stem(path, format) else { return Ok(false) };
    if is_named_season(&stem) {
        return Ok(true);
    }
    let own = individual(&recipe(path, monitor)?);
    for other in named_alike(path, &stem, format)? {
        if recipe(&other, monitor).is_ok_and(|other| individual(&other) == own) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// A season of a tree, and a file that holds it, if one is known.
pub struct SeasonFile {
    pub season: f64,
    pub path: Option<PathBuf>,
}

/// Files beside one that hold the same tree in other seasons, one of each season, then seasons that have a name;
/// `None` where it is not one of several seasons, by these files or by its name.
pub fn seasons_beside(
    path: &Path,
    format: &Format,
    monitor: &dyn Monitor,
) -> anyhow::Result<Option<Vec<SeasonFile>>> {
    let Some(stem) = stem(path, format) else { return Ok(None) };
    let of = |recipe: &Value| {
        let season = Preset::from_json(&recipe.to_string()).ok()?.dressing.foliage.season;
        Some((season, (individual(recipe), recipe.get("hash")?.get("skeleton")?.clone())))
    };
    let Some((own_season, own)) = of(&recipe(path, monitor)?) else { return Ok(None) };
    let mut found: Vec<SeasonFile> = Vec::new();
    for other in named_alike(path, &stem, format)? {
        let Some((season, wood)) = recipe(&other, monitor).ok().as_ref().and_then(of) else { continue };
        let is_known = season == own_season || found.iter().any(|known| known.season == season);
        if !is_known && wood == own {
            found.push(SeasonFile { season, path: Some(other) });
        }
    }
    if found.is_empty() && !is_named_season(&stem) {
        return Ok(None);
    }
    for Season { season, .. } in Season::all() {
        if season != own_season && found.iter().all(|known| known.season != season) {
            found.push(SeasonFile { season, path: None });
        }
    }
    Ok(Some(found))
}

fn is_named_season(stem: &str) -> bool {
    splits(stem).any(|(_, look)| Season::all().iter().any(|season| season.name == look))
}

/// The files in the same folder that may be of another look of the same plant.
fn named_alike(path: &Path, stem: &str, format: &Format) -> anyhow::Result<Vec<PathBuf>> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let reading = || format!("reading the folder {}", show(folder));
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(reading)? {
        let other = entry.with_context(reading)?.path();
        let is_alike = self::stem(&other, format).is_some_and(|other| {
            splits(stem)
                .any(|(plant, look)| splits(&other).any(|(name, other)| name == plant && other != look))
        });
        if is_alike {
            found.push(other);
        }
    }
    found.sort();
    Ok(found)
}

fn recipe(path: &Path, monitor: &dyn Monitor) -> anyhow::Result<Value> {
    let json = Content::File(reading::open_regular(path)?).recipe(monitor)?;
    Ok(json.and_then(|json| serde_json::from_str(&json).ok()).unwrap_or_default())
}

/// The preset and the seed that a recipe names.
fn individual(recipe: &Value) -> [Option<Value>; 2] {
    ["id", "seed"].map(|key| recipe.get(key).cloned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_look_may_have_several_words() {
        let of = |stem| splits(stem).collect::<Vec<_>>();
        assert_eq!(of("oak_half_grown"), [("oak_half", "grown"), ("oak", "half_grown")]);
        assert_eq!(of("fir_1"), [], "no age or season is called so");
        assert!(of("oak").is_empty() && of("_bare").is_empty());
    }
}
