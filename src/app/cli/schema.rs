//! `linden schema`: a JSON Schema of preset documents and of the formats' options, from the same
//! tables that read them.

use clap::Args;
use linden::generators;
use linden::knob::{FARTHEST, Kind, Knob};
use linden::preset::{
    AGES, BarkSettings, EDIT_OPERATION, EDITS, FileKey, KIND_NAME, KIND_NAME_HELP, KNOBS, LEAF_KNOBS,
    LeafKind, MOST_AGES, MOST_KINDS, MOST_TAGS, Section,
};
use linden::report::{NUMBERS, Number};
use linden::skeleton::edit::{EDIT_KNOBS, EDIT_PATHS, Edit, MOST_EDITS, Operation};
use linden::skeleton::generator::{Generator, KeyContent, TableKey, Tables};
use linden_exporters::REGISTRY;
use serde_json::{Map, Value, json};

/// Print a JSON Schema of preset documents and export options, or the definitions of all numbers
#[derive(Args)]
pub struct Schema {
    /// Print the numbers of 'linden stats' and 'linden sweep' instead: of each name, unit, definition, what is
    /// included, and source
    #[arg(long)]
    stats: bool,
}

impl Schema {
    pub fn run(self) -> anyhow::Result<()> {
        super::print_json(&if self.stats { numbers() } else { document() })
    }
}

/// The table of numbers.
fn numbers() -> Value {
    let row = |number: &Number| {
        let Number { name, label, group, unit, of, meaning, source, .. } = number;
        json!({
            "name": name, "label": label, "group": group, "unit": unit, "definition": meaning, "of": of,
            "includes": of.includes(), "source": source,
        })
    };
    NUMBERS.iter().map(row).collect()
}

fn document() -> Value {
    let mut properties = Map::new();
    for (key, help) in [
        ("id", "what scripts call it"),
        ("name", "what people call it"),
        ("group", "where it is listed"),
        ("summary", "one line: what it is"),
        ("about", "a paragraph: what to look for"),
        ("source", "where it comes from"),
    ] {
        properties.insert(key.to_owned(), json!({ "type": "string", "description": help }));
    }
    properties.insert(
        "tags".to_owned(),
        json!({
            "type": "array", "items": { "type": "string" }, "maxItems": MOST_TAGS,
            "description": "words that it is found by: small letters, digits, - and _",
        }),
    );
    // What a recipe has besides.
    properties.insert(
        "linden".to_owned(),
        json!({ "type": "string", "description": "version that made the recipe" }),
    );
    properties.insert(
        "inputs".to_owned(),
        json!({
            "type": "array",
            "items": { "type": "object" },
            "description": "files that the recipe was made with, in the order in which the preset names them",
        }),
    );
    properties.insert(
        "input".to_owned(),
        json!({ "type": "object", "description": "the one file of an older recipe" }),
    );
    for section in Section::all() {
        let mut keys: Map<String, Value> = KNOBS
            .iter()
            .filter(|knob| knob.section == section)
            .map(|knob| (knob.knob.name.to_owned(), of_drawn(&knob.knob, section)))
            .collect();
        match section {
            Section::Tree => {
                properties.append(&mut keys);
                continue;
            }
            Section::Generator(id) => {
                let others = generators::find(id).map_or(&[][..], |generator| generator.keys());
                keys.extend(others.iter().map(|key| (key.name.to_owned(), of_key(key))));
            }
            Section::Bark => keys.extend(files(&BarkSettings::FILES)),
            Section::Foliage => {
                let kind = json!({
                    "type": "object",
                    "required": ["leaf_form"],
                    "properties": leaf_keys(),
                    "additionalProperties": false,
                });
                keys.extend(files(&LeafKind::FILES));
                keys.insert(KIND_NAME.to_owned(), kind_name());
                keys.insert(
                    "also".to_owned(),
                    json!({ "type": "array", "items": kind, "maxItems": MOST_KINDS - 1 }),
                );
            }
            _ => {}
        }
        let others = match section {
            Section::Generator(id) if generators::find(id).is_some_and(Generator::takes_declared_knobs) => {
                declared_knob()
            }
            _ => json!(false),
        };
        let table = json!({ "type": "object", "properties": keys, "additionalProperties": others });
        properties.insert(section.key().to_owned(), table);
    }
    properties.insert(EDITS.to_owned(), edits());
    properties.insert(AGES.to_owned(), ages());
    let one_of: Vec<Value> =
        generators::all().iter().map(|generator| json!({ "required": [generator.id()] })).collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "linden preset",
        "type": "object",
        "required": ["id"],
        "oneOf": one_of,
        "properties": properties,
        "additionalProperties": false,
        "$defs": definitions(),
    })
}

/// What other parts of the schema refer to, and what editors of export options need.
fn definitions() -> Value {
    let formats: Map<String, Value> = REGISTRY
        .iter()
        .map(|exporter| exporter.format())
        .map(|format| {
            let options: Map<String, Value> = format
                .options
                .iter()
                .map(|spec| {
                    let mut schema = of(&spec.knob);
                    schema["default"] = json!(spec.default);
                    (spec.knob.name.to_owned(), schema)
                })
                .collect();
            let schema = json!({ "description": format.help, "type": "object", "properties": options });
            (format.id.to_owned(), schema)
        })
        .collect();
    json!({
        "export options": { "type": "object", "properties": formats },
        "spread": {
            "type": "string", "pattern": SPREAD_PATTERN,
            "description": "what each seed draws the number from: mean ± standard deviation, or low..high; in a list, \
                            of each number",
        },
    })
}

/// Edits of the wood: for each operation the keys that it has.
fn edits() -> Value {
    let item = |word: &&str| {
        let edit = Edit::named(word)?;
        let mut keys: Map<String, Value> = EDIT_KNOBS
            .iter()
            .filter(|row| row.is_of(&edit.operation))
            .map(|row| (row.knob.name.to_owned(), of(&row.knob)))
            .collect();
        let mut required = vec![EDIT_OPERATION];
        for row in EDIT_PATHS.iter().filter(|row| row.is_of(&edit.operation)) {
            let pattern = "^(stem|new)([1-9][0-9]*)?(/[1-9][0-9]*)*$";
            let schema = json!({ "type": "string", "pattern": pattern, "description": row.help });
            keys.insert(row.name.to_owned(), schema);
            required.push(row.name);
        }
        if *word == "curve" {
            required.push("points");
        }
        keys.insert(EDIT_OPERATION.to_owned(), json!({ "const": word }));
        Some(json!({
            "type": "object",
            "required": required,
            "properties": keys,
            "additionalProperties": false,
        }))
    };
    let items: Vec<Value> = Operation::WORDS.iter().filter_map(item).collect();
    json!({
        "type": "array",
        "items": { "oneOf": items },
        "maxItems": MOST_EDITS,
        "description": "edits of single axes of the grown tree, in their order",
    })
}

/// Ages that have names: for each the knobs that it turns.
fn ages() -> Value {
    let knobs = KNOBS.iter().filter(|row| row.knob.name != "seed");
    let keys: Map<String, Value> =
        knobs.map(|row| (row.knob.name.to_owned(), of_drawn(&row.knob, row.section))).collect();
    json!({
        "type": "object",
        "propertyNames": { "pattern": "^[a-z][a-z0-9_]{0,31}$", "not": { "const": "all" } },
        "maxProperties": MOST_AGES,
        "additionalProperties": {
            "type": "object",
            "properties": keys,
            // Of further kinds of foliage, by what those are called, and knobs that the document declares.
            "additionalProperties": { "anyOf": [{ "type": "object" }, declared_knob()] },
        },
        "description": "ages of the plant that have names, with the knobs that are turned then",
    })
}

/// A knob that the document itself declares.
fn declared_knob() -> Value {
    json!({ "type": ["number", "string"], "pattern": SPREAD_PATTERN })
}

/// Keys of a kind of leaves: knobs, and the files that it may need.
fn leaf_keys() -> Map<String, Value> {
    let section = Section::Foliage;
    let knobs = LEAF_KNOBS.iter().map(|row| (row.knob.name.to_owned(), of_drawn(&row.knob, section)));
    knobs.chain(files(&LeafKind::FILES)).chain([(KIND_NAME.to_owned(), kind_name())]).collect()
}

/// What a kind is called.
fn kind_name() -> Value {
    json!({ "type": "string", "pattern": "^[a-z][a-z0-9_-]{0,31}$", "description": KIND_NAME_HELP })
}

/// Keys that name files.
fn files<T>(rows: &[FileKey<T>]) -> Map<String, Value> {
    let schema = |help| json!({ "type": "string", "description": help });
    rows.iter().map(|row| (row.key.to_owned(), schema(row.help))).collect()
}

/// A key of a generator's table that is no knob.
fn of_key(key: &TableKey) -> Value {
    let text = json!({ "type": "string" });
    let mut schema = match &key.content {
        KeyContent::Text | KeyContent::File => text,
        KeyContent::Texts => json!({ "type": "array", "items": text }),
        KeyContent::Tables(tables) => of_tables(tables),
    };
    schema["description"] = json!(key.help);
    schema
}

/// A list of tables.
fn of_tables(tables: &Tables) -> Value {
    let mut properties: Map<String, Value> =
        (tables.knobs)().iter().map(|knob| (knob.name.to_owned(), of(knob))).collect();
    for (key, help) in tables.files {
        properties.insert((*key).to_owned(), json!({ "type": "string", "description": help }));
    }
    let mut item = json!({
        "type": "object",
        "required": tables.required,
        "properties": properties,
        "additionalProperties": false,
    });
    if !tables.one_of.is_empty() {
        item["oneOf"] = tables.one_of.iter().map(|key| json!({ "required": [key] })).collect();
    }
    json!({ "type": "array", "items": item, "maxItems": tables.most })
}

/// What tells a spread from other text.
const SPREAD_PATTERN: &str = "[.][.]|±|[+]/?-";

/// The same for a knob of a tree: numbers may be spreads, from which each seed draws.
fn of_drawn(knob: &Knob, section: Section) -> Value {
    let mut schema = of(knob);
    let is_number = matches!(
        knob.kind,
        Kind::Real { .. } | Kind::Integer { .. } | Kind::Length { .. } | Kind::Reals { .. }
    );
    if section == Section::Tree || !is_number {
        return schema;
    }
    // Limits are for numbers, patterns for text.
    if let Some(number @ ("number" | "integer")) = schema["type"].as_str() {
        schema["type"] = json!([number, "string"]);
        schema["pattern"] = json!(SPREAD_PATTERN);
        return schema;
    }
    let description = schema["description"].take();
    if let Value::Object(keys) = &mut schema {
        keys.remove("description");
    }
    let mut values = match &mut schema["anyOf"] {
        Value::Array(values) => std::mem::take(values),
        _ => vec![schema],
    };
    values.push(json!({ "$ref": "#/$defs/spread" }));
    json!({ "anyOf": values, "description": description })
}

/// A knob's values as documents have them.
fn of(knob: &Knob) -> Value {
    let number = |min: f64, max: f64| {
        let mut schema = json!({ "type": "number", "minimum": min });
        if max.is_finite() {
            schema["maximum"] = json!(max);
        }
        schema
    };
    let place = || number(-FARTHEST, FARTHEST);
    let or_auto = |auto: bool, schema: Value| {
        if auto { json!({ "anyOf": [schema, { "const": "auto" }] }) } else { schema }
    };
    let mut schema = match knob.kind {
        Kind::Real { min, max, auto, names: [] } => or_auto(auto, number(min, max)),
        Kind::Real { min, max, auto, names } => {
            let words: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
            or_auto(auto, json!({ "anyOf": [number(min, max), { "enum": words }] }))
        }
        Kind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Length { min, max, auto } => {
            let text = json!({ "type": "string", "pattern": "^(inf|[0-9]+([.][0-9]+)?D)$" });
            or_auto(auto, json!({ "anyOf": [number(min, max), text] }))
        }
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Switch => json!({ "type": "boolean" }),
        Kind::Vector { auto } => {
            let vector = json!({ "type": "array", "items": place(), "minItems": 3, "maxItems": 3 });
            or_auto(auto, vector)
        }
        Kind::Color { auto } => or_auto(auto, json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" })),
        Kind::Profile { least, most } => {
            let pair = json!({ "type": "array", "items": place(), "minItems": 2, "maxItems": 2 });
            json!({ "type": "array", "items": pair, "minItems": least, "maxItems": most })
        }
        Kind::Reals { min, max, most } => {
            let list = json!({ "type": "array", "items": number(min, max), "minItems": 1, "maxItems": most });
            json!({ "anyOf": [number(min, max), list] })
        }
        Kind::Words(words) => json!({ "type": "array", "items": { "enum": words }, "uniqueItems": true }),
        Kind::Sequence { words, most } => {
            json!({ "type": "array", "items": { "enum": words }, "maxItems": most })
        }
        Kind::Colors { most, auto } => {
            let color = json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" });
            or_auto(auto, json!({ "type": "array", "items": color, "minItems": 1, "maxItems": most }))
        }
    };
    let unit = if knob.unit.is_empty() { String::new() } else { format!(" ({})", knob.unit) };
    let details = if knob.details.is_empty() { String::new() } else { format!("\n\n{}", knob.details) };
    schema["description"] = json!(format!("{}{unit}{details}", knob.help));
    schema
}
