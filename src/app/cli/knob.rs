//! `linden list --knobs`: what can be turned, and what one knob does at length.

use linden::knob::{Knob, did_you_mean, excerpt, nearest};
use linden::preset::KNOBS;
use serde::Serialize;

use crate::exit::usage;
use crate::wrap::wrapped;

/// Columns of a paragraph.
const COLUMN: usize = 96;

/// A knob, and the tables of documents that have it.
#[derive(Serialize)]
struct KnobPage {
    name: &'static str,
    /// Empty for what stands before all tables.
    sections: Vec<&'static str>,
    unit: &'static str,
    range: String,
    help: &'static str,
    details: &'static str,
    see_also: &'static [&'static str],
    aliases: &'static [&'static str],
    #[serde(skip)]
    knob: Knob,
}

/// All knobs, those that several tables share once, in the order of documents.
fn pages() -> Vec<KnobPage> {
    let mut pages: Vec<KnobPage> = Vec::new();
    for row in KNOBS.iter() {
        let (knob, section) = (row.knob, row.section.key());
        if let Some(page) = pages.iter_mut().find(|page| page.knob == knob) {
            page.sections.push(section);
            continue;
        }
        pages.push(KnobPage {
            name: knob.name,
            sections: vec![section],
            unit: knob.unit,
            range: knob.kind.to_string(),
            help: knob.help,
            details: knob.details,
            see_also: knob.see_also,
            aliases: knob.aliases,
            knob,
        });
    }
    pages
}

/// Prints all knobs, a line each.
///
/// # Errors
/// Where it cannot be printed.
pub fn all(json: bool) -> anyhow::Result<()> {
    let pages = pages();
    if json {
        return super::print_json(&pages);
    }
    let width = pages.iter().map(|page| page.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    let mut before = None;
    for page in &pages {
        if before != Some(&page.sections) {
            text.push_str(if before.is_none() { "" } else { "\n" });
            text.push_str(&format!("{}\n", tables(&page.sections)));
            before = Some(&page.sections);
        }
        text.push_str(&format!("  {:width$}  {}\n", page.name, page.help));
    }
    text.push_str("\n'linden list --knobs KNOB' says more of one, 'linden show SOURCE' has their values.\n");
    super::print(&text)
}

/// Prints what there is to say of the knobs of a name.
///
/// # Errors
/// Where there is none.
pub fn one(name: &str, json: bool) -> anyhow::Result<()> {
    let name = name.trim();
    let found: Vec<KnobPage> = pages().into_iter().filter(|page| page.knob.is_called(name)).collect();
    if found.is_empty() {
        let hint = did_you_mean(nearest(name, KNOBS.iter().map(|row| row.knob.name)));
        let name = excerpt(name);
        return Err(usage(format!(
            "there is no knob '{name}'{hint}; 'linden list --knobs' lists them, 'linden show SOURCE' those of its grammar too"
        )));
    }
    if json {
        return super::print_json(&found);
    }
    let pages: Vec<String> = found.iter().map(KnobPage::text).collect();
    super::print(&pages.join("\n"))
}

/// The tables as documents head them.
fn tables(sections: &[&str]) -> String {
    let heading =
        |section: &&str| if section.is_empty() { "tree".to_owned() } else { format!("[{section}]") };
    sections.iter().map(heading).collect::<Vec<_>>().join(" ")
}

impl KnobPage {
    fn text(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        let mut text = format!("{}  {}\n", self.name, tables(&self.sections));
        text.push_str(&paragraph(self.help));
        text.push_str(&format!("  {}{unit}\n", self.range));
        if !self.details.is_empty() {
            text.push_str(&format!("\n{}", paragraph(self.details)));
        }
        if !self.see_also.is_empty() {
            text.push_str(&format!("\n{}", paragraph(&format!("see also: {}", self.see_also.join(", ")))));
        }
        if !self.aliases.is_empty() {
            text.push_str(&format!("\n{}", paragraph(&format!("once called: {}", self.aliases.join(", ")))));
        }
        text
    }
}

/// Text in lines of [`COLUMN`], indented.
fn paragraph(text: &str) -> String {
    wrapped(text, COLUMN).into_iter().map(|line| format!("  {line}\n")).collect::<Vec<_>>().concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_knob_that_tables_share_is_one_page_and_another_of_its_name_is_not() {
        let of = |name: &str| -> Vec<Vec<&str>> {
            pages().into_iter().filter(|page| page.name == name).map(|page| page.sections).collect()
        };
        assert_eq!(of("kill"), [["colonization", "scan"]]);
        assert_eq!(of("tropism"), [vec!["lsystem"], vec!["colonization", "scan"]]);
        assert_eq!(of("seed"), [[""]]);
    }

    #[test]
    fn a_page_has_everything_within_its_column() {
        let page = pages().into_iter().find(|page| page.name == "kill").unwrap();
        let text = page.text();
        assert!(text.starts_with("kill  [colonization] [scan]\n  how near"), "{text}");
        for part in ["or in steps like 17D", "Runions et al. 2007", "\n\n  see also: influence, "] {
            assert!(text.contains(part), "{part} in {text}");
        }
        assert!(text.lines().skip(1).all(|line| line.is_empty() || line.starts_with("  ")), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= COLUMN + 2), "{text}");
    }

    #[test]
    fn a_name_that_is_none_is_refused_with_the_nearest() {
        let said = one("kil", false).unwrap_err().to_string();
        assert!(said.starts_with("there is no knob 'kil' (did you mean 'kill'?)"), "{said}");
    }
}
