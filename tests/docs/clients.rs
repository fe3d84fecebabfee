//! What arrives in other programs: the page shows what `tests/matrix/run` found, its notes explain every loss, and no
//! option of a format is without a row.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use linden::knob::Kind;
use linden_exporters::REGISTRY;
use serde_json::Value as Json;
use toml::{Table, Value};

use crate::generated::check_block;
use crate::read;

const ROWS: &str = "tests/matrix/rows.toml";
const RESULTS: &str = "tests/matrix/results.json";
const RUN: &str = "tests/matrix/run finds it out";

/// Formats that a table shows together, below a heading.
const FAMILIES: [(&str, &[&str]); 4] = [
    ("glTF", &["glb", "gltf"]),
    ("USD", &["usda", "usdc", "usdz"]),
    ("Meshes and skeletons", &["obj", "ply", "ply-skeleton", "stl", "3mf"]),
    ("Tables and pages", &["qsm", "organs", "mat", "html"]),
];

fn rows_table() -> Table {
    read(ROWS).parse().unwrap_or_else(|error| panic!("{ROWS}: {error}"))
}

fn results() -> Json {
    serde_json::from_str(&read(RESULTS)).unwrap_or_else(|error| panic!("{RESULTS}: {error}"))
}

fn tables<'a>(all: &'a Table, name: &str) -> Vec<&'a Table> {
    all[name].as_array().unwrap().iter().map(|each| each.as_table().unwrap()).collect()
}

fn text<'a>(table: &'a Table, key: &str) -> &'a str {
    table[key].as_str().unwrap()
}

fn words<'a>(table: &'a Table, key: &str) -> Vec<&'a str> {
    let list = table.get(key).and_then(Value::as_array);
    list.into_iter().flatten().filter_map(Value::as_str).collect()
}

/// What the cell of a row and a program holds.
fn cell<'a>(results: &'a Json, row: &Table, client: &Table) -> &'a Json {
    &results["rows"][text(row, "id")][text(client, "id")]
}

/// The notes, numbered in the order in which the page first needs them.
struct Notes<'a> {
    known: Vec<&'a Table>,
    used: Vec<&'a Table>,
    unexplained: Vec<String>,
}

impl<'a> Notes<'a> {
    fn new(all: &'a Table) -> Self {
        Self { known: tables(all, "because"), used: Vec::new(), unexplained: Vec::new() }
    }

    /// The number of the note that explains a loss.
    fn number(&mut self, client: &str, row: &str, aspect: &str, said: &str) -> Option<usize> {
        let explains = |note: &&&Table| {
            let within = words(note, "in");
            words(note, "clients").contains(&client)
                && words(note, "lost").contains(&aspect)
                && (within.is_empty() || within.iter().any(|part| row.contains(part)))
        };
        let Some(note) = self.known.iter().find(explains).copied() else {
            self.unexplained.push(format!("{client}, {row}: {aspect}: {said}"));
            return None;
        };
        let place = self.used.iter().position(|used| std::ptr::eq(*used, note));
        let place = place.unwrap_or_else(|| {
            self.used.push(note);
            self.used.len() - 1
        });
        Some(place + 1)
    }
}

/// The mark of a cell, with the numbers of its notes.
fn mark(cell: &Json, client: &str, row: &str, notes: &mut Notes<'_>) -> String {
    let mark = match cell["reads"].as_str() {
        None => return String::new(),
        Some("yes") => "●",
        Some("part") => "◐",
        Some(_) => "○",
    };
    let lost = cell["lost"].as_object();
    let numbers: BTreeSet<usize> = lost
        .into_iter()
        .flatten()
        .filter_map(|(aspect, said)| notes.number(client, row, aspect, said.as_str().unwrap_or_default()))
        .collect();
    let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    format!("{mark} {}", numbers.join(" ")).trim_end().to_owned()
}

/// An id of a row as the page shows it: what is typed as code, what is not in brackets behind.
fn title(id: &str) -> String {
    match id.split_once(" (") {
        Some((code, rest)) => format!("`{code}` ({rest}"),
        None => format!("`{id}`"),
    }
}

fn programs(clients: &[&Table], results: &Json) -> String {
    let mut page = format!(
        "Found on {}, with rowans, hazels and maples of 2 000 to 30 000 triangles, in\n\n| program | version | opened by |\n|---|---|---|\n",
        results["date"].as_str().unwrap()
    );
    for client in clients {
        let version = results["clients"][text(client, "id")].as_str().unwrap_or_default();
        assert!(!version.is_empty(), "{} has not been run: {RUN}", text(client, "id"));
        writeln!(page, "| {} | {version} | {} |", text(client, "name"), text(client, "by")).unwrap();
    }
    page
}

fn page(all: &Table, results: &Json) -> (String, Vec<String>) {
    let (clients, rows) = (tables(all, "client"), tables(all, "row"));
    let mut notes = Notes::new(all);
    let mut page = programs(&clients, results);
    for (heading, formats) in FAMILIES {
        let rows: Vec<&Table> =
            rows.iter().copied().filter(|row| formats.contains(&text(row, "format"))).collect();
        let clients: Vec<&Table> = clients
            .iter()
            .copied()
            .filter(|client| words(client, "reads").iter().any(|format| formats.contains(format)))
            .collect();
        let names: Vec<&str> = clients.iter().map(|client| text(client, "name")).collect();
        write!(
            page,
            "\n## {heading}\n\n| written as | {} |\n|---|{}\n",
            names.join(" | "),
            "---|".repeat(names.len())
        )
        .unwrap();
        for row in rows {
            let id = text(row, "id");
            let mut shown = title(id);
            let also = words(row, "also");
            if !also.is_empty() {
                write!(shown, ", {}", also.join(", ")).unwrap();
            }
            let marks: Vec<String> = clients
                .iter()
                .map(|client| mark(cell(results, row, client), text(client, "id"), id, &mut notes))
                .collect();
            writeln!(page, "| {shown} | {} |", marks.join(" | ")).unwrap();
        }
    }
    page += "\n## Notes\n\n";
    for (i, note) in notes.used.iter().enumerate() {
        let names: Vec<&str> = clients
            .iter()
            .filter(|client| words(note, "clients").contains(&text(client, "id")))
            .map(|client| text(client, "name"))
            .collect();
        writeln!(page, "{}. **{}**: {}", i + 1, names.join(", "), text(note, "text")).unwrap();
    }
    let unused = notes.known.iter().filter(|note| !notes.used.iter().any(|used| std::ptr::eq(*used, **note)));
    let unused = unused.map(|note| format!("no cell needs the note '{}'", text(note, "text")));
    let faults = notes.unexplained.iter().cloned().chain(unused).collect();
    (page, faults)
}

#[test]
fn clients_page_is_what_was_found() {
    let (all, results) = (rows_table(), results());
    let (page, faults) = page(&all, &results);
    check_block("docs/clients.md", "clients", &page);
    assert!(faults.is_empty(), "a note [[because]] of {ROWS} explains each loss:\n{}", faults.join("\n"));
}

#[test]
fn clients_were_all_asked() {
    let (all, results) = (rows_table(), results());
    for row in tables(&all, "row") {
        for client in tables(&all, "client") {
            let is_for_it = words(client, "reads").contains(&text(row, "format"));
            let cell = cell(&results, row, client);
            assert_eq!(is_for_it, cell.is_object(), "{}, {}: {RUN}", text(row, "id"), text(client, "id"));
        }
    }
    let known = results["rows"].as_object().unwrap().len();
    assert_eq!(known, tables(&all, "row").len(), "{RESULTS} has other rows than {ROWS}: {RUN}");
}

/// `FORMAT` and each `FORMAT.OPTION=VALUE` that a row or a reason stands for.
fn covered(all: &Table) -> BTreeSet<String> {
    let mut covered = BTreeSet::new();
    for row in tables(all, "row") {
        let formats = words(row, "also").into_iter().chain([text(row, "format")]);
        let set = row.get("set").and_then(Value::as_table);
        for format in formats {
            let values = set.into_iter().flatten();
            covered.extend(
                values.map(|(option, value)| format!("{format}.{option}={}", value.as_str().unwrap())),
            );
        }
        covered.insert(text(row, "format").to_owned());
    }
    covered
        .extend(tables(all, "untried").iter().flat_map(|reason| words(reason, "options")).map(str::to_owned));
    covered
}

#[test]
fn clients_have_a_row_for_every_option() {
    let covered = covered(&rows_table());
    let mut missing = Vec::new();
    for exporter in REGISTRY {
        let format = exporter.format();
        if !covered.contains(format.id) {
            missing.push(format.id.to_owned());
        }
        for option in format.options {
            let name = format!("{}.{}", format.id, option.knob.name);
            let other = |value: &&str| *value != option.default;
            let values: Vec<String> = match option.knob.kind {
                Kind::Switch => {
                    ["true", "false"].iter().copied().filter(|v| other(v)).map(str::to_owned).collect()
                }
                Kind::Choice(values) => {
                    values.iter().copied().filter(|v| other(v)).map(str::to_owned).collect()
                }
                // Any other number stands for all.
                _ => {
                    let begin = format!("{name}=");
                    if !covered.iter().any(|each| each.starts_with(&begin)) {
                        missing.push(format!("{name}=…"));
                    }
                    continue;
                }
            };
            let names = values.iter().map(|value| format!("{name}={value}"));
            missing.extend(names.filter(|each| !covered.contains(each)));
        }
    }
    assert!(missing.is_empty(), "{ROWS} has no row for {missing:?}; then {RUN}");
    let known: BTreeSet<String> = REGISTRY.iter().map(|exporter| exporter.format().id.to_owned()).collect();
    for each in &covered {
        let format = each.split(['.', '=']).next().unwrap();
        assert!(known.contains(format), "{ROWS} names {each}, which no format has");
    }
}
