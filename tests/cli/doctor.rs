//! doctor: what it finds, what it finds broken, and the files to begin with.

use crate::program::{Folder, Said, linden};

/// Runs it with this folder as all that the user has.
fn doctor(folder: &Folder, args: &[&str], environment: &[(&str, &str)]) -> Said {
    let mut command = linden();
    command.arg("doctor").args(args).current_dir(folder.path()).stdin(std::process::Stdio::null());
    for name in ["LINDEN_GRAPHICS", "LINDEN_COLORS", "TMUX", "STY", "ZELLIJ", "TERM_PROGRAM"] {
        command.env_remove(name);
    }
    command.env("TERM", "xterm-256color");
    command.env("LINDEN_CONFIG_DIR", folder.file("config")).env("LINDEN_STATE_DIR", folder.file("state"));
    command.envs(environment.iter().copied());
    Said::new(command.output().unwrap())
}

fn finding(report: &serde_json::Value, what: &str) -> (String, String) {
    let findings = report["terminal"]["findings"].as_array().unwrap();
    let row = findings.iter().find(|row| row["what"] == what).unwrap_or_else(|| panic!("no {what}"));
    let text = |key: &str| row[key].as_str().unwrap().to_owned();
    (text("value"), text("why"))
}

#[test]
fn without_a_terminal_it_says_so_and_reports_the_rest() {
    let folder = Folder::new();
    let text = doctor(&folder, &[], &[]).done().out;
    assert!(text.contains("It was not asked: standard input is not a terminal"), "{text}");
    assert!(text.contains("the terminal was not asked") && !text.contains("in time"), "{text}");
    for what in [
        "multiplexer",
        "pictures",
        "colours",
        "LINDEN_GRAPHICS",
        "--colors",
        &format!("{} built in, 0 of yours", linden::preset::builtins().len()),
        "made when needed",
        "all at their defaults",
        "▚▞",
        "threads",
    ] {
        assert!(text.contains(what), "{what} in {text}");
    }
    assert!(!text.contains('\u{1b}'), "no colours in a pipe: {text}");
    assert!(folder.names().is_empty(), "looking changes nothing");
}

#[test]
fn what_is_forced_is_told_with_who_forces_it() {
    let folder = Folder::new();
    std::fs::create_dir(folder.file("config")).unwrap();
    folder.write("config/config.toml", "graphics = \"halves\"\ncolors = 16\n");
    let report = |args: &[&str], environment: &[(&str, &str)]| {
        doctor(&folder, &[&["--json"], args].concat(), environment).done().json()
    };
    let found = report(&[], &[]);
    assert_eq!(finding(&found, "characters"), ("halves".into(), "config.toml asks for it".into()));
    assert_eq!(finding(&found, "colours"), ("16".into(), "config.toml asks for it".into()));
    // The environment comes before the file, the command line before both.
    let environment = [("LINDEN_GRAPHICS", "sixel"), ("LINDEN_COLORS", "256")];
    let found = report(&[], &environment);
    assert_eq!(finding(&found, "pictures"), ("sixel".into(), "LINDEN_GRAPHICS asks for it".into()));
    let found = report(&["--graphics", "kitty"], &environment);
    assert_eq!(finding(&found, "pictures"), ("kitty".into(), "--graphics asks for it".into()));
    assert_eq!(finding(&found, "colours"), ("256".into(), "LINDEN_COLORS asks for it".into()));
    let said = doctor(&folder, &["--graphics", "holograms"], &[]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("quadrants"), "{}", said.err);
}

#[test]
fn everything_that_is_broken_is_listed_with_its_place() {
    let folder = Folder::new();
    for dir in ["config", "config/presets", "config/themes"] {
        std::fs::create_dir(folder.file(dir)).unwrap();
    }
    folder.write("config/config.toml", "theme = \"moor\"\nmouse = \"maybe\"\n");
    folder.write("config/keymap.toml", "[keys]\nundoo = \"z\"\n");
    folder.write("config/themes/moor.toml", "key = \"blurple\"\n");
    folder.write("config/presets/good.toml", doctor_preset());
    folder.write("config/presets/bad\u{1b}[2J.toml", "points = = 3\n");
    let said = doctor(&folder, &[], &[("LINDEN_COLORS", "seven")]);
    assert_eq!(said.code, Some(1), "{}", said.out);
    for place in [
        "LINDEN_COLORS: 'seven'",
        "config.toml:2:9: ",
        "keymap.toml:2:1: ",
        "moor.toml:1:7: ",
        "bad\\u{1b}[2J.toml:1:",
        "2 of yours, 1 of them broken",
    ] {
        assert!(said.out.contains(place), "{place} in {}", said.out);
    }
    assert!(!said.out.replace("\u{1b}[0m", "").contains("\u{1b}[2J"));
    assert!(said.err.contains("5 things of yours"), "{}", said.err);
    let report = doctor(&folder, &["--json"], &[]).json();
    let complaints = report["complaints"].as_array().unwrap();
    assert_eq!(complaints.len(), 4);
    assert!(
        complaints.iter().all(|complaint| complaint["line"].is_u64() && complaint["file"].is_string()),
        "{complaints:?}"
    );
    assert_eq!(
        report["presets"],
        serde_json::json!({"builtin": linden::preset::builtins().len(), "own": 2, "broken": 1})
    );
}

fn doctor_preset() -> String {
    Folder::new().run(&["show", "fir", "--toml"]).done().out
}

#[cfg(unix)]
#[test]
fn a_directory_that_cannot_be_written_is_broken() {
    let folder = Folder::new();
    // A file where the directory would be: also root cannot write into it.
    folder.write("config", "");
    let said = doctor(&folder, &[], &[]);
    assert_eq!(said.code, Some(1));
    assert!(said.out.contains("(cannot be written)"), "{}", said.out);
}

#[test]
fn the_examples_are_files_without_a_fault() {
    let folder = Folder::new();
    for dir in ["config", "config/themes"] {
        std::fs::create_dir(folder.file(dir)).unwrap();
    }
    for (name, file) in [
        ("config", "config/config.toml"),
        ("keymap", "config/keymap.toml"),
        ("theme", "config/themes/own.toml"),
    ] {
        let text = doctor(&folder, &["--example", name], &[]).done().out;
        assert!(text.starts_with('#') && text.lines().count() > 20, "{text}");
        folder.write(file, &text);
    }
    doctor(&folder, &[], &[]).done();
    // Commented out they count for nothing; the one that names the theme reads the other.
    folder.write("config/config.toml", "theme = \"own\"\n");
    assert_eq!(doctor(&folder, &["--json"], &[]).done().json()["theme"], "own");
}
