//! A contact sheet of a batch: the thumbnails of its trees, with what tells them apart below.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Context;
use linden::Monitor;
use linden::input::read_picture;
use linden::knob::printable;
use linden::monitor::Holding;
use linden_raster::drawing::label::Label;
use linden_raster::{Size, Style};

use super::part::say_left_out;
use super::rows::Row;
use super::thumbnail::SIZE;
use crate::cli::placing::{PictureTarget, Placing};
use crate::exit::{say, usage};
use crate::paths::show;
use crate::portrait::sheet::{Mosaic, capitals, columns, paper};
use crate::progress::Progress;

/// The most trees of a sheet: a picture of 15 million pixels.
const MOST: usize = 240;
/// The most knobs and constants below a tree.
const MOST_VARIED: usize = 4;

/// A sheet that is to be written.
pub struct Contact<'a> {
    target: PictureTarget,
    shown: String,
    /// A tree each with its thumbnail.
    trees: Vec<(&'a Row, &'a str)>,
    /// Of how many they were chosen.
    of: usize,
}

impl<'a> Contact<'a> {
    /// Tries the place, and chooses the trees.
    pub fn new(path: &Path, rows: &[&'a Row]) -> anyhow::Result<Self> {
        let target = PictureTarget::open(path, "sheet", &Placing::default())?;
        let with: Vec<_> = rows.iter().filter_map(|row| Some((*row, row.main_file(&["png"])?))).collect();
        if with.is_empty() {
            return Err(usage(
                "--sheet shows thumbnails, and no tree of this batch has one: add \"thumbnail\" to the formats of the \
                 manifest, and run the batch",
            ));
        }
        let without = rows.iter().filter(|row| row.main_file(&["png"]).is_none());
        say_left_out("--sheet", &without.map(|row| row.index).collect::<Vec<_>>(), "without thumbnail");
        let of = with.len();
        let trees = evenly(of).map(|index| with[index]).collect();
        Ok(Self { target, shown: show(path), trees, of })
    }

    /// Puts the thumbnails of a folder together; gives what to tell.
    pub fn write(self, out: &Path, progress: &Progress) -> anyhow::Result<String> {
        let Self { target, shown, trees, of } = self;
        let varied = Varied::of(&trees.iter().map(|(row, _)| *row).collect::<Vec<_>>());
        let style = Style::studio();
        let (width, height) = SIZE;
        let capitals = capitals(width);
        let below = Label::rows(2 + varied.lines(), capitals);
        let count = trees.len() as u32;
        let columns = columns(count, (width, height + below));
        let rows = count.div_ceil(columns);
        let whole = Size::new(columns * width, rows * (height + below)).map_err(usage)?;
        target.admit(whole, 0, progress)?;
        let holding = Holding::new(progress, u64::from(whole.width()) * u64::from(whole.height()) * 4);
        let mut sheet = Mosaic::new(whole.width(), whole.height());
        for (place, (row, file)) in (0..).zip(&trees) {
            progress.check()?;
            let path = out.join(file);
            let reading = || format!("reading the thumbnail {}", show(&path));
            let bytes = std::fs::read(&path).with_context(reading)?;
            let thumbnail = read_picture(file, &bytes, &holding).with_context(reading)?.picture;
            if (thumbnail.width(), thumbnail.height()) != SIZE {
                anyhow::bail!(
                    "{} is not the thumbnail that was written there; remove it and --resume",
                    show(&path)
                );
            }
            let lines = varied.label(row);
            let label = Label { lines, height: capitals, color: style.ink };
            let picture = label.below(&thumbnail, below, paper(&style));
            sheet.lay(&picture, place % columns * width, place / columns * (height + below));
        }
        target.write(&sheet.finish(), None, progress)?;
        if trees.len() < of {
            say(&format!(
                "note: {shown} shows {} of {of} trees, evenly chosen; --only chooses others",
                trees.len()
            ));
        }
        Ok(format!("{} trees on {shown}\n", trees.len()))
    }
}

/// At most [`MOST`] of a count, evenly, the first and the last with them.
fn evenly(count: usize) -> impl Iterator<Item = usize> {
    let shown = count.min(MOST);
    (0..shown).map(move |i| if shown < 2 { 0 } else { i * (count - 1) / (shown - 1) })
}

/// Knobs and constants that are not the same in all trees of a sheet.
struct Varied<'a>(Vec<&'a str>);

impl<'a> Varied<'a> {
    fn of(rows: &[&'a Row]) -> Self {
        let names: BTreeSet<&str> = rows.iter().flat_map(|row| values(row)).map(|(name, _)| name).collect();
        let of =
            |row: &'a Row, name: &str| values(row).find(|(other, _)| *other == name).map(|(_, value)| value);
        let differs = |name: &&str| {
            let mut found = rows.iter().map(|row| of(row, name));
            let first = found.next();
            found.any(|value| Some(value) != first)
        };
        Self(names.into_iter().filter(differs).collect())
    }

    /// Lines that they take below each tree.
    fn lines(&self) -> u32 {
        self.0.len().min(MOST_VARIED) as u32
    }

    fn label(&self, row: &Row) -> Vec<String> {
        let age = row.age.as_ref().map(|age| format!(" {age}")).unwrap_or_default();
        let mut lines =
            vec![printable(&format!("{} {}{age}", row.index, row.source)), format!("seed {}", row.seed)];
        let mut varied: Vec<String> = values(row)
            .filter(|(name, _)| self.0.contains(name))
            .map(|(name, value)| printable(&format!("{name} {value}")))
            .collect();
        if varied.len() > MOST_VARIED {
            let more = varied.len() - (MOST_VARIED - 1);
            varied.truncate(MOST_VARIED - 1);
            varied.push(format!("and {more} more"));
        }
        lines.extend(varied);
        lines
    }
}

fn values(row: &Row) -> impl Iterator<Item = (&str, &str)> {
    row.set.iter().chain(&row.define).map(|(name, value)| (name.as_str(), value.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_are_all_shown_and_many_evenly() {
        assert_eq!(evenly(0).count(), 0);
        assert_eq!(evenly(3).collect::<Vec<_>>(), [0, 1, 2]);
        let many: Vec<usize> = evenly(10_000).collect();
        assert_eq!((many.len(), many[0], many[239]), (240, 0, 9999));
        assert!(many.windows(2).all(|pair| (41..=42).contains(&(pair[1] - pair[0]))));
    }

    #[test]
    fn labels_say_what_differs_and_nothing_else() {
        let row = |index, set: &[(&str, &str)]| Row {
            index,
            source: "fir".into(),
            seed: 7,
            set: set.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect(),
            ..Row::default()
        };
        let rows = [row(0, &[("points", "9"), ("kill", "1D")]), row(1, &[("points", "8"), ("kill", "1D")])];
        let varied = Varied::of(&rows.each_ref());
        assert_eq!(
            (varied.lines(), varied.label(&rows[1])),
            (1, vec!["1 fir".into(), "seed 7".into(), "points 8".into()])
        );
        let many = [row(0, &[]), row(1, &[("a", "1"), ("b", "1"), ("c", "1"), ("d", "1"), ("e", "1")])];
        let varied = Varied::of(&many.each_ref());
        assert_eq!((varied.lines(), varied.label(&many[1]).len()), (4, 6));
        assert_eq!(varied.label(&many[1])[5], "and 2 more");
    }
}
