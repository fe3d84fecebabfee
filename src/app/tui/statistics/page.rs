//! What the page of numbers says.

use linden::report::{Group, NUMBERS};
use linden::surface::Junction;
use linden_exporters::{Options, exporters};

use super::of;
use crate::jobs::{MeasuredFigures, ShownTree};
use crate::numbers::line;
use crate::tui::chrome::PageLine;
use crate::tui::figures::length;
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

fn measured(shown: &ShownTree, figures: &MeasuredFigures) -> Vec<PageLine> {
    let is_solid = shown.recipe.preset.dressing.tubes.junction == Junction::Watertight;
    let mut lines = Vec::new();
    for group in Group::ALL {
        let rows = NUMBERS.iter().filter(|number| number.group == group);
        let mut rows = rows.filter_map(|number| line(number, &figures.report, is_solid)).peekable();
        if rows.peek().is_some() {
            lines.push(PageLine::Heading(capital(group.name())));
            lines.extend(rows.map(|(label, value)| PageLine::Keys(label.to_owned(), value)));
        }
    }
    let mut put = |label: &str, value: String| lines.push(PageLine::Keys(label.to_owned(), value));
    put("", String::new());
    put("memory", format!("{} for the tree as it grew", length(shown.grown.bytes())));
    let (grow_s, measure_s) = (shown.took.as_secs_f64(), figures.took.as_secs_f64());
    put("time", format!("{grow_s:.3} s to grow, {measure_s:.3} s to measure"));
    lines.push(PageLine::Heading("Files, with the usual options".to_owned()));
    for exporter in exporters() {
        let format = exporter.format();
        if let Some(bytes) = figures.estimate.bytes(format, &Options::new(format)) {
            lines.push(PageLine::Keys(format.id.to_owned(), format!("about {}", length(bytes))));
        }
    }
    lines
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
