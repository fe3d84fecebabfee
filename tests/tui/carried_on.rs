//! What goes on elsewhere: the next session, the command line, the figures at the end.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

use crate::harness::{End, Home, PROGRAM, Setup, Token, Workbench, tokens};

#[test]
fn the_next_session_begins_where_the_last_one_ended() {
    let home = Home::new();
    let mut first = Workbench::open(&home, 140, 40, &[]);
    // Another preset, a knob, a look, the camera.
    first.keys("/cyp\r");
    first.wait_for("the cypress", |screen| screen.row(0).contains("Cypress"));
    first.wait_for_tree();
    first.keys("\t\tjjjl");
    first.wait_for_text("modified");
    first.keys("c\x1b[Zll+");
    first.settle();
    // The message of the look has gone by then.
    first.wait_for("no message", |screen| !screen.footer().contains("drawn:"));
    first.keys("\x0c");
    first.settle();
    let before = first.screen();
    first.keys("q");
    assert_eq!(first.wait_exit(), End::Code(0));
    let second = Setup::new(140, 40).start(&home);
    second.wait_for("the cypress", |screen| {
        screen.row(0).contains("Cypress") && screen.row(0).contains("nodes")
    });
    second.settle();
    second.keys("\x0c");
    second.settle();
    let after = second.screen();
    // The cursor of the form is at its first knob again: its row and what is said about it differ.
    let (before_rows, after_rows) = (before.rows(), after.rows());
    assert_eq!(after_rows[0], before_rows[0]);
    assert_eq!(after.columns(0, 27), before.columns(0, 27), "the list, filtered");
    assert_eq!(after.columns(27, 102), before.columns(27, 102), "the picture");
    assert!(after.text().contains('●') && after_rows[0].contains("modified"), "{}", after.text());
    assert_eq!(after.footer(), before.footer(), "the focus");
}

#[test]
fn one_named_on_the_command_line_is_opened_whatever_was_there() {
    let home = Home::new();
    let mut first = Workbench::open(&home, 120, 40, &["open", "fir"]);
    first.keys("q");
    assert_eq!(first.wait_exit(), End::Code(0));
    let second = Workbench::open(&home, 120, 40, &["open", "sphere", "--set", "points=321"]);
    let screen = second.screen();
    assert!(screen.row(0).contains("Sphere") && screen.knob("points").contains("321"), "{}", screen.text());
}

#[test]
fn the_copied_command_line_exports_the_tree_on_screen() {
    let home = Home::new();
    let mut workbench = Workbench::open(&home, 140, 40, &["open", "fir"]);
    // Turned: the seed, and the points.
    workbench.keys("\t\tl");
    workbench.settle();
    workbench.keys("jjjl");
    workbench.wait_for_tree();
    let title = workbench.screen().row(0);
    workbench.keys("y");
    workbench.wait_for_text("copied");
    let bytes = workbench.bytes();
    let copied: Vec<String> = tokens(&bytes)
        .0
        .iter()
        .filter_map(|token| match token {
            Token::String(b']', body) => Some(body.strip_prefix(b"52;c;")?),
            _ => None,
        })
        .map(|payload| String::from_utf8(BASE64_STANDARD.decode(payload).unwrap()).unwrap())
        .collect();
    let [line] = &copied[..] else { panic!("{copied:?}") };
    assert!(line.starts_with("linden export fir -o fir.glb"), "{line}");
    // As somebody who pastes it into a shell.
    let bin = std::path::Path::new(PROGRAM).parent().unwrap();
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let folder = home.file("pasted");
    std::fs::create_dir(&folder).unwrap();
    let run = |line: &str| {
        let said = std::process::Command::new("sh")
            .args(["-c", line])
            .env("PATH", &path)
            .current_dir(&folder)
            .output()
            .unwrap();
        assert!(said.status.success(), "{line}: {}", String::from_utf8_lossy(&said.stderr));
        String::from_utf8(said.stdout).unwrap()
    };
    run(line);
    let glb = std::fs::read(folder.join("fir.glb")).unwrap();
    assert_eq!(&glb[..4], b"glTF");
    // It is the tree on screen: as many nodes.
    let knobs: String = line.split_once("fir.glb").unwrap().1.to_owned();
    let stats: serde_json::Value =
        serde_json::from_str(&run(&format!("linden stats fir --json {knobs}"))).unwrap();
    let nodes = stats["nodes"].as_u64().unwrap().to_string();
    assert!(title.replace(' ', "").contains(&format!("{nodes}nodes")), "{nodes} in {title}");
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
}

#[test]
fn figures_are_said_at_the_end_when_asked_for() {
    let home = Home::new();
    let mut workbench = Workbench::open(&home, 120, 40, &["open", "fir", "--stats"]);
    for key in ["j", "k", "j"] {
        workbench.keys(key);
        workbench.settle();
    }
    assert!(workbench.screen().row(0).contains(" KB"), "{}", workbench.screen().row(0));
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
    let screen = workbench.screen();
    for words in ["frames ", "writes ", "text ", "pictures ", "key to frame", " keys"] {
        let text = screen.text().replace('\n', "");
        assert!(text.contains(words), "{words}: {text}");
    }
    // Otherwise nothing is.
    let mut workbench = Workbench::open(&home, 120, 40, &["open", "fir"]);
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
    assert_eq!(workbench.screen().text().trim(), "");
}
