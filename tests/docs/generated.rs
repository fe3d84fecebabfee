//! What documents say of knobs, formats, crown shapes and parts is made from the tables that the program
//! reads.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use linden::colonization::crown::SHAPES;
use linden::knob::Knob;
use linden::preset::{KNOBS, PART_KNOBS, Preset};
use linden::report::{Group, NUMBERS, Number, Of};
use linden_exporters::{Format, LooksIn, REGISTRY};
use linden_lint::{PROFILES, RULES};

use crate::{is_update, read, root};

const COMMAND: &str = "LINDEN_UPDATE=1 cargo test -p linden-tests --test docs";

/// Compares a file with what it should be, or writes it.
fn check(path: &str, wanted: &str) {
    if is_update() {
        std::fs::write(root().join(path), wanted).unwrap();
    }
    let found = read(path);
    for (i, (found, wanted)) in found.lines().zip(wanted.lines()).enumerate() {
        assert_eq!(found, wanted, "{path}:{} is old: {COMMAND}", i + 1);
    }
    assert_eq!(found.lines().count(), wanted.lines().count(), "{path} is old: {COMMAND}");
}

/// The same for what stands between two comments of a page.
pub fn check_block(path: &str, name: &str, wanted: &str) {
    let page = read(path);
    let (begin, end) = (format!("<!-- {name}: {COMMAND} -->\n"), format!("<!-- /{name} -->"));
    let (before, rest) = page.split_once(&begin).unwrap_or_else(|| panic!("{path} has no {begin}"));
    let (_, after) = rest.split_once(&end).unwrap_or_else(|| panic!("{path} has no {end}"));
    check(path, &format!("{before}{begin}{wanted}{end}{after}"));
}

/// Text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// What values a knob takes, with its unit.
fn values(knob: &Knob) -> String {
    let unit = if knob.unit.is_empty() { String::new() } else { format!(" ({})", knob.unit) };
    cell(&format!("{}{unit}", knob.kind))
}

/// A row of a table of knobs.
fn row(knob: &Knob, default: &str) -> String {
    format!("| `{}` | {} | {} | {} |\n", knob.name, cell(default), values(knob), cell(knob.help))
}

const HEAD: &str = "| knob | default | values | |\n|---|---|---|---|\n";

/// What knobs do at length, a paragraph each; nothing where one line says all of every knob.
fn at_length(knobs: &[Knob]) -> String {
    let mut text = String::new();
    for knob in knobs.iter().filter(|knob| !knob.details.is_empty()) {
        let others: Vec<String> = knob.see_also.iter().map(|name| format!("`{name}`")).collect();
        let see_also =
            if others.is_empty() { String::new() } else { format!(" See also {}.", others.join(", ")) };
        write!(text, "\n**`{}`** {}{see_also}\n", knob.name, knob.details).unwrap();
    }
    text
}

/// The simplest presets of each kind: all of their knobs have their defaults.
fn plain() -> Vec<Preset> {
    let tables = [
        "[lsystem]\naxiom = \"F\"\nrules = [\"F -> FF\"]",
        "[colonization]\ncrown = \"dome\"",
        "[colonization]\nscan = \"scan.xyz\"",
        "[weber-penn]",
        "[self-organizing]",
    ];
    tables.map(|table| Preset::from_toml(&format!("id = \"plain\"\n{table}\n")).unwrap()).to_vec()
}

/// What a table of a document is about.
fn about(table: &str) -> &'static str {
    match table {
        "" => "Before all tables of a document.",
        "lsystem" => {
            "How a [grammar](grammar.md) is derived and drawn. Chance is keyed by the place in the tree, so that an edit does not\n\
             reshuffle the rest."
        }
        "colonization" => "[Crowns and growth](crowns.md), and [scans](scans.md).",
        "qsm" => "Tables of cylinders, [which are trees already](scans.md#trees-that-are-cylinders-already).",
        "scan" => "[From a laser scan](scans.md).",
        "weber-penn" => {
            "[Weber and Penn's trees](weber-penn.md). Lists have a number for each level, the trunk's first."
        }
        "self-organizing" => {
            "[Trees that compete for light](self-organizing.md). Lists have a number for each order of axes, the stem's first."
        }
        "wood" => {
            "Radii (`width` is the rule for them), and `refine`, a list of steps that are applied to the axes after growth, as in\n\
             Runions, Lane & Prusinkiewicz 2007."
        }
        "surface" => {
            "The mesh of the wood. `junction=watertight` makes all wood one closed solid for printing and simulation."
        }
        "bark" => {
            "Bark is drawn by the program. Pictures of yours replace it: `bark_picture` tiles and is `bark_tile` metres wide."
        }
        "foliage" => {
            "Leaves, of any generator; the wood does not change with them. Each `[[foliage.also]]` is a further kind with the same knobs,\n\
             for blossom or fruit: `--set also.1.leaf_keep=0` turns those of the first of them, and so does its name (`name = \"blossom\"` in\n\
             its table), or its outline where no other kind has that: `--set blossom.leaf_keep=0`."
        }
        "detail" => "[Levels of detail](formats.md#levels-of-detail).",
        "wind" => "[Wind](formats.md#wind).",
        other => panic!("say in tests/docs/generated.rs what the table [{other}] is about"),
    }
}

#[test]
fn the_knobs_are_those_of_the_program() {
    let presets = plain();
    let default = |name: &str| {
        let mut all = presets.iter().flat_map(Preset::knobs);
        let found = all.find(|(knob, _)| knob.knob.name == name);
        found.map(|(_, value)| value.to_string()).unwrap_or_default()
    };
    // These are with their shapes.
    let dimensions: Vec<&str> =
        SHAPES.iter().flat_map(|shape| shape.knobs).map(|dimension| dimension.knob.name).collect();
    let knobs = || KNOBS.iter().filter(|row| !dimensions.contains(&row.knob.name));
    let mut tables: Vec<&str> = knobs().map(|row| row.section.key()).collect();
    tables.dedup();
    let mut page = format!(
        "# Knobs\n\n\
         Generated from the tables of the program: `{COMMAND}`.\n\n\
         Turned by `--set KNOB=VALUE`, in the workbench, or in a preset's document, in the table that a section is called \
         by.\nLengths are metres. `17D` is seventeen steps. The dimensions of crowns are with their\n\
         [shapes](crowns.md#shapes), what a part may have with the [parts](crowns.md#parts).\n\
         `linden show SOURCE` lists the knobs of one source with their values, `linden list --knobs KNOB` says of one what \
         stands here.\n\n\
         ## Spreads\n\n\
         A knob of numbers may say what each seed draws its value from instead: `\"9 ± 1\"` is a normal distribution by its \
         mean and\nstandard deviation (cut at three of them, and at the knob's range), `\"7..12\"` is uniform. `+-` and `+/-` \
         are read as `±`. In a list, each number may\nhave one: `\"45±5 60 50..70\"`; one number is a list of one.\n\n\
         ```sh\nlinden sheet fir --seeds 6 --set crown_height='9 ± 1' -o firs.png\n\
         linden forest fir:40 --set 'crown_height=7..12' -o wood.glb --area 60 --scene\n```\n\n\
         The same seed draws the same value, on every machine; each knob draws for itself. Files and recipes keep the \
         spread, and `linden show SOURCE` says\nwhat was drawn from which. A value that is given takes the spread away.\n"
    );
    let mut explained: Vec<Knob> = Vec::new();
    for table in tables {
        let heading = if table.is_empty() { "tree" } else { table };
        write!(page, "\n## {heading}\n\n{}\n\n{HEAD}", about(table)).unwrap();
        for entry in knobs().filter(|entry| entry.section.key() == table) {
            page += &row(&entry.knob, &default(entry.knob.name));
        }
        for (_, key, help) in Preset::file_keys().filter(|(section, _, _)| section.key() == table) {
            writeln!(page, "| `{key}` | none | the name of a file | {} |", cell(help)).unwrap();
        }
        // What a table before this one has, too, was explained there.
        let rows = KNOBS.iter().filter(|own| own.section.key() == table);
        let new: Vec<Knob> = rows.map(|own| own.knob).filter(|knob| !explained.contains(knob)).collect();
        page += &at_length(&new);
        explained.extend(new);
    }
    check("docs/knobs.md", &page);
}

#[test]
fn crown_shapes_and_parts_are_those_of_the_program() {
    let mut text =
        "| `crown` | | dimensions, and what they are when nothing is said |\n|---|---|---|\n".to_owned();
    for shape in SHAPES {
        let dimensions: Vec<String> = shape
            .knobs
            .iter()
            .map(|dimension| {
                let unit = if dimension.knob.unit.is_empty() {
                    String::new()
                } else {
                    format!(" {}", dimension.knob.unit)
                };
                format!(
                    "`{}` {}{unit}: {}",
                    dimension.knob.name,
                    cell(&(dimension.default)().to_string()),
                    cell(dimension.knob.help)
                )
            })
            .collect();
        writeln!(text, "| `{}` | {} | {} |", shape.id, cell(shape.help), dimensions.join("<br>")).unwrap();
    }
    // One test for both, so that they do not write over each other.
    check_block("docs/crowns.md", "crowns", &text);
    check_block("docs/crowns.md", "parts", &parts());
}

/// The keys of parts.
fn parts() -> String {
    let mut text = "| key of a part | values | |\n|---|---|---|\n".to_owned();
    for part_knob in PART_KNOBS {
        let knob = &part_knob.field.knob;
        writeln!(text, "| `{}` | {} | {} |", knob.name, values(knob), cell(knob.help)).unwrap();
    }
    text
}

/// Where a format has levels, or seasons.
fn looks(place: LooksIn) -> &'static str {
    match place {
        LooksIn::One => "in one file",
        LooksIn::Files => "a file each",
        LooksIn::Nothing => "",
    }
}

fn format_row(format: &Format) -> String {
    let yes = |is_held: bool| if is_held { "yes" } else { "" };
    let endings: Vec<String> = format.extensions.iter().map(|ending| format!("`.{ending}`")).collect();
    let holds = &format.holds;
    format!(
        "| `{}` | {} | {} | {} | {} | {} | {} |\n",
        format.id,
        endings.join(" "),
        cell(format.help),
        looks(holds.levels),
        looks(holds.seasons),
        yes(holds.wind),
        yes(holds.setting),
    )
}

#[test]
fn the_formats_are_those_of_the_program() {
    let mut text =
        "| id | ending | | levels | seasons | wind | `--scene` |\n|---|---|---|---|---|---|---|\n".to_owned();
    let formats: Vec<&Format> = REGISTRY.iter().map(|exporter| exporter.format()).collect();
    for format in &formats {
        text += &format_row(format);
    }
    text += "| any other | | the program `linden-export-ID` on the PATH: [below](#formats-of-your-own) | | | | |\n";
    text += "\n| option (`--set`) | default | values | |\n|---|---|---|---|\n";
    for format in &formats {
        for option in format.options {
            let knob = &option.knob;
            let name = format!("{}.{}", format.id, knob.name);
            writeln!(text, "| `{name}` | {} | {} | {} |", option.default, values(knob), cell(knob.help))
                .unwrap();
        }
    }
    check_block("docs/formats.md", "formats", &text);
}

#[test]
fn the_numbers_are_those_of_the_program() {
    let mut page = format!(
        "# Numbers\n\n\
         Generated from the table of the program: `{COMMAND}`.\n\n\
         What `linden stats`, `linden sweep` and `GrownTree::report` of the [library](library.md) say of a tree. `linden schema\n\
         --stats` prints this table as JSON. What does not apply is null in JSON, an empty field in a table. Lists are one field,\n\
         their items joined by `;`. All numbers are of one tree: the whole, or, with a budget of triangles (`--triangles`), the\n\
         reduced one; `tree` says which.\n\n\
         Lengths are metres, Y is up, angles are degrees. Sums run in one order: the same recipe gives the same numbers to the\n\
         last digit, on any number of threads.\n\n\
         | of | includes |\n|---|---|\n"
    );
    for of in [Of::Wood, Of::Leaves, Of::All, Of::Surface, Of::Growth] {
        writeln!(page, "| {} | {} |", format!("{of:?}").to_lowercase(), of.includes()).unwrap();
    }
    for group in Group::ALL {
        let name = group.name();
        write!(page, "\n## {name}\n\n| name | unit | of | definition | source |\n|---|---|---|---|---|\n")
            .unwrap();
        for Number { name, unit, of, meaning, source, .. } in NUMBERS.iter().filter(|row| row.group == group)
        {
            let of = format!("{of:?}").to_lowercase();
            writeln!(page, "| `{name}` | {unit} | {of} | {} | {} |", cell(meaning), cell(source)).unwrap();
        }
    }
    check("docs/numbers.md", &page);
}

#[test]
fn every_number_has_a_name_of_its_own_and_the_unit_that_it_ends_in() {
    let names: BTreeSet<&str> = NUMBERS.iter().map(|number| number.name).collect();
    assert_eq!(names.len(), NUMBERS.len());
    for number in NUMBERS {
        let name = number.name;
        let ending = match number.unit {
            "m" => "_m",
            "m²" => "_m2",
            "m³" => "_m3",
            "m²/m³" => "_m2_per_m3",
            "°" => "_deg",
            "" => "",
            other => panic!("{name}: {other}"),
        };
        assert!(name.ends_with(ending) || name == "bounds", "{name}");
        assert!(!number.meaning.ends_with('.') && number.meaning.len() > 3, "{name}");
    }
}

#[test]
fn the_rules_of_lint_are_those_of_the_program() {
    let mut rules = "| rule | level | looks for | why | what to do |\n|---|---|---|---|---|\n".to_owned();
    let mut limits = "\n| limit | usual | |\n|---|---|---|\n".to_owned();
    for rule in RULES {
        let [checks, why, mend] = [rule.checks, rule.why, rule.mend].map(cell);
        writeln!(rules, "| `{}` | {} | {checks} | {why} | {mend} |", rule.id, rule.severity.word()).unwrap();
        for limit in rule.limits {
            let unit = if limit.unit.is_empty() { String::new() } else { format!(" {}", limit.unit) };
            writeln!(
                limits,
                "| `{}.{}` | {}{unit} | {} |",
                rule.id,
                limit.name,
                limit.usual,
                cell(limit.help)
            )
            .unwrap();
        }
    }
    check_block("docs/lint.md", "rules", &(rules + &limits));
    let mut profiles = "| profile | for | what differs |\n|---|---|---|\n".to_owned();
    for profile in PROFILES {
        let limits = profile.limits.iter().map(|(rule, limit, value)| format!("`{rule}.{limit}` {value}"));
        let severities =
            profile.severities.iter().map(|(rule, severity)| format!("`{rule}` {}", severity.word()));
        let differs: Vec<String> = limits.chain(severities).collect();
        writeln!(profiles, "| `{}` | {} | {} |", profile.id, profile.help, differs.join(", ")).unwrap();
    }
    check_block("docs/lint.md", "profiles", &profiles);
}
