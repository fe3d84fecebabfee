//! What the page of numbers says.

use linden::report::{Group, NUMBERS};
use linden::surface::Junction;
use linden_exporters::Options;

use super::of;
use crate::figures::{length, thousands};
use crate::jobs::{MeasuredFigures, ShownTree};
use crate::numbers::line_with;
use crate::tui::chrome::PageLine;
use crate::tui::model::{Model, Weight};

/// The lines for the tree on screen: as far as it was measured.
pub fn lines(model: &Model) -> Vec<PageLine> {
    let Some(tree) = &model.tree else { return vec![say("no preset is chosen")] };
    let Some(shown) = &tree.shown else {
        return vec![match &tree.fault {
            Some(fault) => PageLine::Text(Weight::Error, fault.clone()),
            None => say("growing …"),
        }];
    };
    match of(model, shown).map(|measured| &measured.figures) {
        None => vec![say("measuring …")],
        Some(Err(why)) => vec![PageLine::Text(Weight::Error, why.clone())],
        Some(Ok(figures)) => measured(shown, figures),
    }
}

fn say(text: &str) -> PageLine {
    PageLine::Text(Weight::Note, text.to_owned())
}

/// The groups of numbers: what an artist asks for first, hashes last.
const GROUPS: [Group; 9] = [
    Group::Size,
    Group::Surface,
    Group::Leaves,
    Group::Wood,
    Group::Stem,
    Group::Crown,
    Group::Branching,
    Group::Growth,
    Group::Tree,
];

fn measured(shown: &ShownTree, figures: &MeasuredFigures) -> Vec<PageLine> {
    let is_solid = shown.recipe.preset.dressing.tubes.junction == Junction::Watertight;
    let (grow_s, measure_s) = (shown.took.as_secs_f64(), figures.took.as_secs_f64());
    let mut lines = vec![
        PageLine::Heading("Cost".to_owned()),
        row("memory", format!("{} for the tree as it grew", length(shown.grown.bytes()))),
        row("time", format!("{grow_s:.3} s to grow, {measure_s:.3} s to measure")),
    ];
    for group in GROUPS {
        let rows = NUMBERS.iter().filter(|number| number.group == group);
        let mut rows =
            rows.filter_map(|number| line_with(number, &figures.report, is_solid, thousands)).peekable();
        if rows.peek().is_some() {
            lines.push(PageLine::Heading(capital(group.name())));
            lines.extend(rows.map(|(label, value)| row(label, value)));
        }
        if group == Group::Leaves {
            lines.push(PageLine::Heading("Files, with the usual options".to_owned()));
            lines.extend(crate::formats::exporters().into_iter().filter_map(|exporter| {
                let format = exporter.format();
                let bytes = figures.estimate.bytes(format, &Options::new(format))?;
                Some(row(format.id, format!("about {}", length(bytes))))
            }));
        }
    }
    lines
}

fn row(label: &str, value: String) -> PageLine {
    PageLine::Keys(label.to_owned(), value)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
