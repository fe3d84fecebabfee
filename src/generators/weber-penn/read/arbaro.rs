//! Arbaro: XML of `<param name="1DownAngle" value="60"/>`, and lines like `1DownAngle=60`.

use linden_base::document::{Fault, TextPlace};
use linden_base::knob::{excerpt, printable};

use super::draft::{Draft, Said, knows, paper_names};
use super::{ParameterFile, ParameterLook, Program, place_at};
use crate::{Dialect, WeberPenn};

/// Beginnings of the names of leaf shapes, and outlines that are like them.
const LEAF_SHAPES: [(&str, &str); 9] = [
    ("disc1", "orbicular"),
    ("disc2", "elliptic"),
    ("disc3", "deltoid"),
    ("disc4", "rhombic"),
    ("disc5", "palmate"),
    ("disc", "elliptic"),
    ("palm", "palm"),
    ("square", "orbicular"),
    ("sphere", "fruit"),
];

fn draft() -> Draft {
    Draft::new(WeberPenn { dialect: Dialect::Arbaro, ..WeberPenn::default() }, ParameterLook::default())
}

pub(super) fn read_xml(text: &str) -> Result<ParameterFile, Fault> {
    // What Arbaro writes has no document type, and one could make a short file long.
    let document = roxmltree::Document::parse(text).map_err(|error| {
        // The parser gives no place of its own where the text ends too early.
        let place = if matches!(
            error,
            roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode
        ) {
            place_at(text, text.trim_end().len())
        } else {
            let place = error.pos();
            Some(TextPlace { line: place.row as usize, column: place.col as usize })
        };
        Fault::new(
            place,
            format!("this XML is broken: {}; save the species anew in Arbaro", printable(&error.to_string())),
        )
    })?;
    let mut draft = draft();
    let species = document.descendants().find(|node| node.has_tag_name("species"));
    let params = || document.descendants().filter(|node| node.has_tag_name("param"));
    if document.root_element().tag_name().name() != "arbaro" && params().next().is_none() {
        return Err(Fault::new(None, "this XML holds no <param> of a species; Arbaro's files do"));
    }
    for param in params() {
        let place = place_at(text, param.range().start);
        let Some(name) = param.attribute("name") else {
            return Err(Fault::new(place, "a <param> has no name"));
        };
        let said = Said { name, place };
        let value = param.attribute("value").ok_or_else(|| said.fault("it has no value"))?;
        take(&mut draft, &said, value)?;
    }
    Ok(draft.finish(
        Program::Arbaro,
        species.and_then(|node| node.attribute("name")).map(str::to_owned),
        None,
    ))
}

pub(super) fn read_lines(text: &str) -> Result<ParameterFile, Fault> {
    let mut draft = draft();
    let mut species = None;
    for (number, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        let place = Some(TextPlace { line: number + 1, column: 1 });
        let Some((name, value)) = content.split_once('=') else {
            let problem = format!("expected a line like 1DownAngle=60, found '{}'", excerpt(content));
            return Err(Fault::new(place, problem));
        };
        let (name, value) = (name.trim(), value.trim());
        if name.eq_ignore_ascii_case("species") {
            species = Some(value.to_owned());
            continue;
        }
        take(&mut draft, &Said { name, place }, value)?;
    }
    Ok(draft.finish(Program::Arbaro, species, None))
}

/// Takes a parameter.
fn take(draft: &mut Draft, said: &Said<'_>, value: &str) -> Result<(), Fault> {
    match said.name {
        "LeafShape" => {
            let known = LEAF_SHAPES.iter().find(|(start, _)| value.starts_with(start));
            if let Some((_, outline)) = known {
                draft.look.leaf_outline = outline;
            } else if value != "0" {
                draft.notes.push(said.note(&format!(
                    "is '{}', which linden does not know; it draws ellipses",
                    excerpt(value)
                )));
            }
            return Ok(());
        }
        "Smooth" | "0ClosedBase" => {
            draft.notes.push(said.note("is of Arbaro's mesh and left out: sides and rings are for it"));
            return Ok(());
        }
        _ => {}
    }
    let number = value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let Some(number) = number else {
        if knows(said.name) {
            return Err(said.fault(&format!("'{}' is no number", excerpt(value))));
        }
        // Text of a parameter that nothing is known of is no fault.
        draft.unknown(said, &paper_names());
        return Ok(());
    };
    let is_known = match level_of(said.name) {
        Some((0, "Scale" | "ScaleV" | "BaseSplits")) | None => draft.tree(said.name, number, said)?,
        Some((level, name)) => draft.level(name, level, number, said)?,
    };
    if !is_known {
        draft.unknown(said, &paper_names());
    }
    Ok(())
}

/// The level before a name, and the name.
fn level_of(name: &str) -> Option<(usize, &str)> {
    let digit = name.chars().next()?.to_digit(10)?;
    Some((digit as usize, &name[1..]))
}
