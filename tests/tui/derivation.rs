//! The debugger of grammars, through the real program: its words are those that the command line derives.

use std::process::Command;

use crate::harness::{Home, Setup};

/// The word of a preset after some steps, as the command line prints it into a pipe.
fn word(preset: &str, steps: &str) -> String {
    let program = env!("CARGO_BIN_EXE_linden");
    let output = Command::new(program).args(["show", preset, "--derive", steps]).output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap().trim_end().to_owned()
}

#[test]
fn words_are_those_of_the_command_line_step_by_step() {
    let home = Home::new();
    let workbench = Setup::new(120, 40).args(&["open", "abop-d", "--set", "derivations=2"]).start(&home);
    workbench.wait_for_text("nodes");
    workbench.settle();
    workbench.keys("d");
    for (step, key) in [("2", ","), ("1", "."), ("2", "."), ("3", ")")] {
        let word = word("abop-d", step);
        let place = if step == "3" { "3, past 2".to_owned() } else { format!("{step} of 2") };
        let title = format!("Derivation {place} · {} modules", word.len());
        workbench.wait_for_text(&title);
        // As much of it as stands in the first line, which the pane holds.
        workbench.wait_for_text(&word[..word.len().min(30)]);
        workbench.keys(key);
    }
    workbench.wait_for_text("Derivation 2 of 2");
    workbench.keys("q");
    workbench.wait_for_text("segment_length");
}
