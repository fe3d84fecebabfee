//! help, man, schema, and what explains a knob.

use std::collections::BTreeSet;
use std::path::Path;

use crate::program::Folder;

const COMMANDS: [&str; 23] = [
    "open",
    "list",
    "show",
    "stats",
    "sweep",
    "calibrate",
    "batch",
    "bench",
    "preview",
    "sheet",
    "export",
    "impostor",
    "scan",
    "recipe",
    "verify",
    "lint",
    "cite",
    "forest",
    "doctor",
    "cache",
    "completions",
    "man",
    "schema",
];

#[test]
fn help_names_every_command_and_every_command_has_help_and_a_manual() {
    let folder = Folder::new();
    let help = folder.run(&["--help"]).done().out;
    for command in COMMANDS {
        assert!(help.lines().any(|line| line.trim_start().starts_with(command)), "{command} in {help}");
        let page = folder.run(&[command, "--help"]).done().out;
        assert!(page.contains(&format!("Usage: linden {command}")), "{page}");
        let manual = folder.run(&["man", command]).done().out;
        assert!(manual.contains(&format!(".TH linden-{command}")), "{manual}");
    }
    assert!(folder.run(&["--version"]).done().out.starts_with("linden 0."));
}

#[test]
fn without_a_command_it_is_a_matter_of_usage() {
    let said = Folder::new().run(&[]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("linden export fir -o fir.glb"), "{}", said.err);
}

/// All names of variables that stand in the program's code as text, apart from tests and what builds it.
fn variables() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("..")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && name != "tests" {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "rs")
                && !name.contains("tests")
                && name != "build.rs"
            {
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let texts = code.split('"').skip(1).step_by(2);
                found.extend(
                    texts
                        .filter(|text| {
                            let is_name = |c: char| c.is_ascii_uppercase() || c == '_';
                            text.strip_prefix("LINDEN_").is_some_and(|rest| rest.chars().all(is_name))
                        })
                        .map(str::to_owned),
                );
            }
        }
    }
    found
}

#[test]
fn the_manual_has_formats_knobs_variables_files_and_a_page_for_each_reference() {
    let folder = Folder::new();
    // As a reader sees it: dashes are escaped in roff.
    let manual = folder.run(&["man"]).done().out.replace('\\', "");
    for format in folder.run(&["list", "--exporters", "--json"]).done().json().as_array().unwrap() {
        let id = format["id"].as_str().unwrap();
        assert!(manual.contains(&format!("fB{id}fR")), "{id}");
    }
    for source in ["oak", "abop-a", "fir"] {
        for knob in folder.run(&["show", source, "--json"]).done().json()["knobs"].as_array().unwrap() {
            let name = knob["name"].as_str().unwrap();
            assert!(manual.contains(&format!("fB{name}fR")), "{name}");
        }
    }
    let variables = variables();
    assert!(variables.len() >= 6, "{variables:?}");
    for name in variables {
        assert!(manual.contains(&name), "{name}");
    }
    for text in ["config.toml", "session.toml", ".SH FORMATS", ".SH KNOBS", ".SH ENVIRONMENT", ".SH FILES"] {
        assert!(manual.contains(text), "{text}");
    }
    assert!(manual.contains(".SH \"EXIT STATUS\""), "{manual}");
    // Every page that is referred to is written.
    folder.run(&["man", "-o", "man1"]).done();
    let mut names: Vec<String> = std::fs::read_dir(folder.file("man1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let mut expected: Vec<String> = COMMANDS.iter().map(|command| format!("linden-{command}.1")).collect();
    expected.push("linden.1".to_owned());
    expected.sort();
    assert_eq!(names, expected);
    for command in COMMANDS {
        assert!(manual.contains(&format!("linden-{command}(1)")), "{command}");
        let page = String::from_utf8(folder.read(&format!("man1/linden-{command}.1"))).unwrap();
        assert_eq!(page, folder.run(&["man", command]).done().out, "{command}");
    }
}

#[test]
fn a_knob_is_explained_by_its_name() {
    let folder = Folder::new();
    let text = folder.run(&["list", "--knobs", "kill"]).done().out;
    for part in ["kill  [colonization] [scan]", "to reach it", "Runions et al. 2007", "see also: influence"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let pages = folder.run(&["list", "--knobs", "tropism", "--json"]).done().json();
    let sections: Vec<&serde_json::Value> =
        pages.as_array().unwrap().iter().map(|page| &page["sections"][0]).collect();
    assert_eq!(sections, ["lsystem", "colonization"], "two knobs of one name");
    assert!(pages[0]["details"].as_str().unwrap().contains("ABOP"));

    let all = folder.run(&["list", "--knobs"]).done().out;
    let rows = folder.run(&["list", "--knobs", "--json"]).done().json();
    for row in rows.as_array().unwrap() {
        assert!(all.contains(&format!("  {} ", row["name"].as_str().unwrap())), "{row}");
    }
    let said = folder.run(&["list", "--knobs", "kil"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("did you mean 'kill'?"), "{}", said.err);

    let schema = folder.run(&["schema"]).done().json();
    let described = &schema["properties"]["scan"]["properties"]["kill"]["description"];
    assert!(described.as_str().unwrap().contains("Runions et al. 2007"), "{described}");
}

#[test]
fn the_schema_fits_the_documents_that_show_writes() {
    let folder = Folder::new();
    let schema = folder.run(&["schema"]).done().json();
    for id in ["fir", "cypress", "heart", "abop-d"] {
        let document = folder.run(&["show", id, "--json"]).done().json()["recipe"].clone();
        for (section, keys) in document.as_object().unwrap() {
            if ["linden", "hash", "inputs"].contains(&section.as_str()) {
                continue;
            }
            let described = &schema["properties"][section];
            assert!(described.is_object(), "{section}");
            for key in keys.as_object().into_iter().flatten().map(|(key, _)| key) {
                assert!(described["properties"][key].is_object(), "{section}.{key}");
            }
        }
    }
    assert!(schema["$defs"]["export options"]["properties"]["obj"].is_object());
}

/// In documents and by their schema.
#[test]
fn one_number_is_a_list_of_one() {
    let folder = Folder::new();
    let hash = |angle: &str| {
        let head = "id = \"x\"\nname = \"X\"\ngroup = \"mine\"\nsummary = \"x\"\nsource = \"x\"\n";
        folder.write("x.toml", format!("{head}[self-organizing]\nyears = 6\nbranching_angle = {angle}\n"));
        let stats = folder.run(&["stats", "x.toml", "--json"]).done().json();
        stats["skeleton_hash"].as_str().unwrap().to_owned()
    };
    assert!(hash("35") == hash("[35]") && hash("35.0") == hash("[35]") && hash("35") != hash("[35, 70]"));
    let schema = folder.run(&["schema"]).done().json();
    let forms = &schema["properties"]["self-organizing"]["properties"]["branching_angle"]["anyOf"];
    let types: Vec<&str> =
        forms.as_array().unwrap().iter().filter_map(|form| form["type"].as_str()).collect();
    assert_eq!(types, ["number", "array"]);
}
