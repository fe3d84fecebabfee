//! Grows the recipe of some files again, some recipes at a time.

use std::path::Path;
use std::sync::Arc;

use linden::Monitor;
use linden::dress::{DetailError, Levels, levels, year};
use linden::grow::{Grown, grow};
use linden::knob::excerpt;
use linden::monitor::Holding;
use linden::recipe::VERSION;
use linden::season::Season;
use linden::texture::DrawnPictures;

use super::bytes::{Bytes, compare};
use super::find::Group;
use super::looks::{SeasonFile, seasons_beside};
use super::row::{Outcome, Row};
use crate::cache;
use crate::cli::crew::{Crew, Share, room_for_pictures};
use crate::exit::sentence;
use crate::progress::Progress;
use crate::source::{self, Source};

/// Checks all files.
pub fn check(groups: &[Group], jobs: Option<usize>, progress: &Progress) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    let crew = Crew::of_threads(progress);
    let room = room_for_pictures(progress);
    let crew = Crew { jobs: jobs.unwrap_or(crew.jobs), memory: crew.memory - room, ..crew };
    let drawn = Arc::new(cache::pictures(DrawnPictures::new(room)));
    crew.run(
        0..groups.len(),
        |index, share| check_group(&groups[index], &drawn, share),
        |checked| {
            rows.extend(checked);
            Ok(true)
        },
    )?;
    Ok(rows)
}

fn check_group(group: &Group, drawn: &Arc<DrawnPictures>, share: &Share<'_>) -> Vec<Row> {
    let all = |outcome: Outcome, reason: &str| {
        group.files.iter().map(|path| Row::new(path, outcome).because(reason)).collect()
    };
    if source::is_forest(&group.json) {
        return all(Outcome::Unchecked, "a forest: its trees are not grown again; 'linden forest' does");
    }
    let Some(first) = group.files.first() else { return Vec::new() };
    match source::of_recipe(first, &group.json, share).and_then(|source| grown(source, drawn, share)) {
        Ok(tree) => group.files.iter().map(|path| tree.check(path, share)).collect(),
        Err(error) => all(Outcome::Failed, &sentence(&error).replace(['\n', '\r'], " ")),
    }
}

/// A tree that was grown again.
pub struct Tree {
    source: Source,
    grown: Grown,
    levels: Levels,
}

fn grown(mut source: Source, drawn: &Arc<DrawnPictures>, share: &Share<'_>) -> anyhow::Result<Tree> {
    source.recipe = source.recipe.drawn_into(drawn);
    let grown = grow(&source.recipe, share)?;
    let levels = levels(&source.recipe, &grown, share)?;
    Ok(Tree { source, grown, levels })
}

impl Tree {
    fn check(&self, path: &Path, share: &Share<'_>) -> Row {
        let provenance = self.source.provenance.as_ref();
        let now = self.grown.hash();
        let then = provenance.and_then(|provenance| provenance.tree);
        let mut row = Row::new(path, Outcome::Unchecked);
        row.version = provenance.and_then(|provenance| provenance.version.clone());
        row.skeleton = then.map(|then| then.skeleton == now.skeleton);
        row.organs = then.map(|then| then.organs == now.organs);
        let other = provenance.and_then(|provenance| provenance.other_version());
        let other = other.map(|other| format!("made by linden {}, this is {VERSION}", excerpt(other)));
        let what = match (row.skeleton, row.organs) {
            (Some(true), Some(true)) | (None, _) | (_, None) => None,
            (Some(false), Some(true)) => Some("its skeleton differs"),
            (Some(true), Some(false)) => Some("its organs differ"),
            (Some(false), Some(false)) => Some("its skeleton and its organs differ"),
        };
        if let Some(what) = what {
            let why = other.into_iter().chain(self.source.notes.iter().cloned());
            let why: Vec<String> = std::iter::once(what.to_owned()).chain(why).collect();
            row.outcome = Outcome::OtherTree;
            return row.because(why.join("; "));
        }
        if let Some(other) = other {
            if then.is_some() {
                row.outcome = Outcome::SameTree;
            }
            return row.because(other);
        }
        let holding = Holding::new(share, self.source.recipe.inputs.bytes());
        match self.compare(path, &holding) {
            Ok(bytes) => self.judge(row, bytes, then.is_some()),
            Err(error) => {
                row.outcome = Outcome::Failed;
                row.because(sentence(&error).replace(['\n', '\r'], " "))
            }
        }
    }

    /// Compares bytes. A budget is met in that of several seasons that has most leaves, and the others have its wood: a
    /// file of one of them is what its recipe grows together with theirs.
    fn compare(&self, path: &Path, monitor: &dyn Monitor) -> anyhow::Result<Bytes> {
        let recipe = &self.source.recipe;
        let bytes = compare(path, &self.levels, monitor)?;
        let Bytes::Other { format, place } = &bytes else { return Ok(bytes) };
        if recipe.preset.dressing.detail.is_whole() {
            return Ok(bytes);
        }
        let Some(others) = seasons_beside(path, format, monitor)? else { return Ok(bytes) };
        let holding = Holding::new(monitor, self.levels.levels.iter().map(|level| level.scene.bytes()).sum());
        let own = SeasonFile { season: recipe.preset.dressing.foliage.season, path: None };
        let mut changed = None;
        for other in &others {
            // Of two with as many leaves it is met in the one that comes first.
            for pair in [[other, &own], [&own, other]] {
                let Some(mut dressed) = self.in_seasons(pair.map(|file| file.season), &holding)? else {
                    continue;
                };
                if pair[0].season == own.season {
                    dressed.reverse();
                }
                let [of_other, of_own] = dressed;
                let together = compare(path, &of_own, &holding)?;
                if matches!(together, Bytes::Same { .. }) {
                    return Ok(together);
                }
                // Then no other season counted for that one, and this one was changed.
                let Some(whole) = &other.path else { continue };
                if matches!(compare(whole, &of_other, &holding), Ok(Bytes::Same { .. })) {
                    changed = Some(together);
                }
            }
        }
        let elsewhere = || format!("{place}; or its budget was met in a season that is not beside it");
        Ok(changed.unwrap_or_else(|| Bytes::Other { format, place: elsewhere() }))
    }

    /// The tree in two seasons within one budget; `None` where it cannot be met in them.
    fn in_seasons(&self, pair: [f64; 2], monitor: &dyn Monitor) -> anyhow::Result<Option<[Levels; 2]>> {
        let named = |name: &str, season| Season { name: name.to_owned(), season };
        let seasons = [named("first", pair[0]), named("second", pair[1])];
        let recipe = &self.source.recipe;
        let mut preset = recipe.preset.clone();
        preset.dressing.foliage.season = pair[0];
        let dressed = year(&recipe.with_preset(preset), &self.grown, &seasons, monitor);
        let dressed = match dressed {
            Ok(dressed) => dressed,
            Err(DetailError::TooFew { .. } | DetailError::NotFewer { .. }) => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        let levels: Vec<Levels> =
            dressed.seasons.into_iter().map(|(_, levels)| Levels { levels, notes: Vec::new() }).collect();
        Ok(levels.try_into().ok())
    }

    fn judge(&self, mut row: Row, bytes: Bytes, is_known: bool) -> Row {
        const CHANGED: &str = "its recipe was changed, or says no hashes";
        match bytes {
            Bytes::Same { format, options, beside } => {
                row.outcome = Outcome::SameBytes;
                (row.format, row.options, row.beside) = (Some(format), options, beside);
                row
            }
            Bytes::NotCompared(reason) => {
                row.outcome = if is_known { Outcome::SameTree } else { Outcome::Unchecked };
                row.because(if is_known { reason } else { CHANGED.to_owned() })
            }
            Bytes::Other { place: reason, .. } => {
                row.outcome = if is_known { Outcome::OtherBytes } else { Outcome::Unchecked };
                let notes = self.source.notes.iter();
                let why = std::iter::once(if is_known { reason.as_str() } else { CHANGED });
                let why: Vec<&str> = why.chain(notes.map(String::as_str)).collect();
                row.because(why.join("; "))
            }
        }
    }
}
