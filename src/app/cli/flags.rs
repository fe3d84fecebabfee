//! Flags that a command does not have: what is meant by them.

use clap::Command;
use clap::builder::StyledStr;
use linden::knob::nearest;

/// Flags that other commands have, or none, of which [`meant_by`] knows something.
const MEANT: [&str; 4] = ["--season", "--seasons", "--ages", "--mkdir"];

/// What does what a flag of other commands, or of none, asks for.
fn meant_by(command: Option<&str>, flag: &str) -> Option<&'static [&'static str]> {
    match flag {
        "--mkdir" if command == Some("batch") => {
            Some(&["'linden batch' makes the folder of --out, and those in it, without a flag"])
        }
        "--season" | "--seasons" => Some(&[
            "one season is a knob: '--set season=autumn'",
            "a file for each: 'linden export SOURCE --seasons'",
        ]),
        "--ages" => {
            Some(&["one age: '--age 10y'", "several on a picture: 'linden sheet SOURCE --ages -o ages.png'"])
        }
        _ => None,
    }
}

/// What may be meant by a flag.
#[derive(Debug, PartialEq)]
pub enum Meant {
    /// One of the command's, which is spelt alike.
    Flag(String),
    /// What does it here, or which commands have it.
    Tips(Vec<String>),
    Nothing,
}

impl Meant {
    /// What is meant by `typed`, which `command` of the built `program` does not have.
    pub fn by(typed: &str, command: Option<&str>, program: &Command) -> Self {
        let tips = |tips: &[&str]| Self::Tips(tips.iter().map(|tip| (*tip).to_owned()).collect());
        if let Some(known) = meant_by(command, typed) {
            return tips(known);
        }
        let here = command.and_then(|name| program.find_subcommand(name)).unwrap_or(program);
        let flags = flags_of(here);
        if let Some(flag) = spelt_alike(typed, &flags) {
            return Self::Flag(flag);
        }
        if let Some(known) = nearest(typed, MEANT).and_then(|flag| meant_by(command, flag)) {
            return tips(known);
        }
        let has_it = |command: &&Command| flags_of(command).iter().any(|flag| flag == typed);
        let of_others: Vec<String> = program
            .get_subcommands()
            .filter(has_it)
            .map(|command| format!("'linden {}'", command.get_name()))
            .collect();
        if of_others.is_empty() {
            return Self::Nothing;
        }
        Self::Tips(vec![format!("{typed} is a flag of {}", of_others.join(", "))])
    }
}

/// How a command is called, or the program without one.
pub fn usage(program: &mut Command, command: Option<&str>) -> StyledStr {
    match command.and_then(|name| program.find_subcommand_mut(name)) {
        Some(command) => command.render_usage(),
        None => program.render_usage(),
    }
}

fn flags_of(command: &Command) -> Vec<String> {
    let shown = command.get_arguments().filter(|argument| !argument.is_hide_set());
    shown.filter_map(|argument| Some(format!("--{}", argument.get_long()?))).collect()
}

/// The flag that is a few letters away, or that what was typed begins.
fn spelt_alike(typed: &str, flags: &[String]) -> Option<String> {
    // Three letters, with the dashes.
    const LEAST: usize = 5;
    let begun =
        || flags.iter().find(|flag| typed.len() >= LEAST && flag.starts_with(typed)).map(String::as_str);
    nearest(typed, flags.iter().map(String::as_str)).or_else(begun).map(str::to_owned)
}
