//! Examples: presets, forests and grammars in the documents are read, and errors are what the documents say.

use linden::forest::ForestDocument;
use linden::knob::Value;
use linden::lsystem::Grammar;
use linden::lsystem::text::parse;
use linden::preset::Preset;

use crate::{blocks, is_update, pages, read, root};

#[test]
fn presets_and_forests_in_documents_are_read() {
    let mut count = 0;
    for path in pages() {
        let page = read(&path);
        for (line, block) in blocks(&page, "toml").into_iter().filter(|(_, block)| block.starts_with("id = "))
        {
            let read = if block.contains("[[tree]]") {
                ForestDocument::parse(block).map(drop)
            } else {
                Preset::from_toml(block).map(drop)
            };
            if let Err(fault) = read {
                panic!("{path}:{line}: {fault}");
            }
            count += 1;
        }
    }
    assert!(count >= 3, "{count}");
}

/// The tutorial's blocks make one file that grows; its folder has the file after each step.
#[test]
fn the_tutorial_s_steps_are_its_files() {
    let page = read("docs/tutorial.md");
    let steps = blocks(&page, "toml");
    assert_eq!(steps.len(), 4, "the page and its pictures have four steps");
    let mut file = String::new();
    for (i, (line, block)) in steps.into_iter().enumerate() {
        file += block;
        if let Err(fault) = Preset::from_toml(&file) {
            panic!("the step of docs/tutorial.md:{line}: {fault}");
        }
        let path = format!("docs/tutorial/{}.toml", i + 1);
        if is_update() {
            std::fs::write(root().join(&path), &file).unwrap();
        }
        assert_eq!(
            read(&path),
            file,
            "{path} is old: LINDEN_UPDATE=1 cargo test -p linden-tests --test docs"
        );
    }
}

#[test]
fn grammars_in_documents_are_read() {
    let page = read("docs/grammar.md");
    let rules: Vec<&str> = blocks(&page, "lsystem").iter().flat_map(|(_, block)| block.lines()).collect();
    assert!(rules.len() > 4);
    if let Err(error) = Grammar::new("A(1,1)", &rules) {
        panic!("docs/grammar.md: {error}");
    }
}

/// The page shows one weed as a preset and as a grammar file.
#[test]
fn both_forms_of_the_weed_are_the_same() {
    let page = read("docs/grammar.md");
    let preset = Preset::from_toml(blocks(&page, "toml")[0].1).unwrap();
    let file = parse(blocks(&page, "text")[0].1).unwrap();
    let value = |name: &str| {
        let mut knobs = preset.knobs().into_iter();
        knobs.find(|(knob, _)| knob.knob.name == name).map(|(_, value)| value)
    };
    assert_eq!(value("angle"), Some(Value::Real(file.angle_deg)));
    assert_eq!(value("derivations"), Some(Value::Integer(file.derivations.into())));
    let document: toml::Table = blocks(&page, "toml")[0].1.parse().unwrap();
    let rules: Vec<&str> =
        document["lsystem"]["rules"].as_array().unwrap().iter().filter_map(|rule| rule.as_str()).collect();
    let axiom = document["lsystem"]["axiom"].as_str().unwrap();
    assert_eq!(Grammar::new(axiom, &rules).unwrap(), file.grammar);
}

/// `…` in the page stands for anything.
fn says(said: &str, wanted: &str) -> bool {
    let parts: Vec<&str> = wanted.split("(known: …)").collect();
    said == wanted
        || parts.len() == 2 && said.starts_with(&format!("{}(known: ", parts[0])) && said.ends_with(parts[1])
}

#[test]
fn errors_are_what_the_page_says() {
    let page = read("docs/grammar.md");
    let (_, table) = page.split_once("| rule | what is said |\n|---|---|\n").unwrap();
    let mut count = 0;
    for row in table.lines().take_while(|line| line.starts_with("| `")) {
        let (rule, message) = row.trim_start_matches("| `").split_once("` | ").unwrap();
        let message = message.trim_end_matches(" |");
        let said = Grammar::new("F", &[rule]).expect_err(rule).to_string();
        assert!(says(&said, message), "{rule}: the page says\n{message}\nthe program\n{said}");
        count += 1;
    }
    assert!(count >= 10, "{count}");
}

#[test]
fn every_function_is_on_the_page() {
    let page = read("docs/grammar.md");
    let said = Grammar::new("F", &["F -> F(nothing(1))"]).unwrap_err().to_string();
    let (_, known) = said.split_once("(known: ").unwrap_or_else(|| panic!("{said}"));
    let names: Vec<&str> = known.trim_end_matches(')').split(", ").collect();
    assert!(names.len() > 10, "{said}");
    for name in names {
        assert!(page.contains(&format!("`{name}(")), "docs/grammar.md does not explain the function {name}");
    }
}
