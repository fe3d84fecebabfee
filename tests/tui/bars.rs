//! Bars of commands that take a while, on a terminal.

use crate::harness::{End, Home, Setup, find};

/// All that a command says on a terminal.
fn said(home: &Home, args: &[&str]) -> Vec<u8> {
    let mut command = Setup::new(120, 30).env("LINDEN_CACHE", "off").args(args).start(home);
    assert_eq!(command.wait_exit(), End::Code(0), "{}", command.screen().text());
    command.bytes()
}

#[test]
fn a_forests_bars_say_which_tree_they_are_at_and_the_list_of_files_has_no_bar() {
    let home = Home::new();
    let file = home.file("oaks.glb").display().to_string();
    let args = ["forest", "oak", "--area", "20", "--triangles", "4000", "-o", &file];
    let bytes = said(&home, &args);
    // The first of them may be there before any bar.
    let text = String::from_utf8_lossy(&bytes).into_owned();
    assert!((2..9).any(|tree| text.contains(&format!("tree {tree} of "))), "{text}");
    let list = text.rsplit('\r').find(|line| line.contains("oaks.glb")).unwrap();
    assert!(!list.contains("tree "), "{list}");
}

#[test]
fn the_bar_of_many_trees_is_there_before_the_first_of_them() {
    let home = Home::new();
    let table = home.write("measured.csv", "height_m\n20\n22\n19\n").display().to_string();
    let bytes = said(&home, &["calibrate", "beech", "--against", &table, "--seeds", "2"]);
    let text = String::from_utf8_lossy(&bytes);
    let bar = find(&bytes, b"0/2 trees").unwrap_or_else(|| panic!("{text}"));
    let line = &bytes[bar..];
    let line = &line[..line.iter().position(|&byte| byte == b'\r').unwrap_or(line.len())];
    // Nobody knows yet how fast it goes.
    assert!(find(line, b"left").is_none() && find(line, b"/s").is_none(), "{text}");
}
