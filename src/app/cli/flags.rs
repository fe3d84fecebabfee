//! Flags that a command does not have: what is meant by them.

use clap::Command;
use clap::builder::StyledStr;
use linden::knob::nearest;
use linden::preset::KNOBS;

/// Flags that other commands have, or none, of which [`Here::meant_by`] knows something.
const MEANT: [&str; 4] = ["--season", "--seasons", "--ages", "--mkdir"];

/// What stands in a manifest, by the flags that other commands have for it.
const IN_MANIFESTS: [(&str, &str); 14] = [
    ("--set", "set = { bark_size = 256 }"),
    ("--triangles", "set = { triangles = 20000 }"),
    ("--wind", "set = { wind = \"sway\" }"),
    ("--lods", "set = { lods = 3 }"),
    ("--lod-ratio", "set = { lod_ratio = 0.4 }"),
    ("--billboard", "set = { billboard = 2 }"),
    ("--season", "set = { season = \"autumn\" }"),
    ("--seasons", "set = { season = [\"summer\", \"autumn\"] }"),
    ("--seed", "seed = 7"),
    ("--seeds", "seeds = \"1..50\""),
    ("--define", "define = { r1 = [0.8, 0.9] }"),
    ("--age", "ages = [\"10y\"]"),
    ("--ages", "ages = [\"young\", \"10y\"]"),
    ("--format", "formats = [\"glb\"]"),
];

/// What may be meant by a flag.
#[derive(Debug, PartialEq)]
pub enum Meant {
    /// One of the command's, which is spelt alike.
    Flag(String),
    /// What does it here, or which commands have it.
    Tips(Vec<String>),
    Nothing,
}

/// The command that was typed, with its flags.
struct Here<'a> {
    name: Option<&'a str>,
    command: &'a Command,
    flags: Vec<String>,
}

impl Meant {
    /// What is meant by `typed`, which `command` of the built `program` does not have.
    pub fn by(typed: &str, command: Option<&str>, program: &Command) -> Self {
        let found = command.and_then(|name| program.find_subcommand(name)).unwrap_or(program);
        let here = Here { name: command, command: found, flags: flags_of(found) };
        let known = here.meant_by(typed);
        if !known.is_empty() {
            return Self::Tips(known);
        }
        if let Some(flag) = spelt_alike(typed, here.flags.iter().map(String::as_str)) {
            return Self::Flag(flag);
        }
        let known = spelt_alike(typed, MEANT).map(|flag| here.meant_by(&flag)).unwrap_or_default();
        if !known.is_empty() {
            return Self::Tips(known);
        }
        let tips: Vec<String> = here.word(typed).into_iter().chain(here.knob(typed)).collect();
        if !tips.is_empty() {
            return Self::Tips(tips);
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

    /// What is meant by the letters behind a single dash: a flag whose second dash is missing.
    pub fn by_letters(word: &str, command: Option<&str>, program: &Command) -> Self {
        let found = command.and_then(|name| program.find_subcommand(name)).unwrap_or(program);
        let flag = format!("-{word}");
        let flag = flag.split_once('=').map_or(flag.as_str(), |(flag, _)| flag);
        let is_flag = flags_of(found).iter().any(|known| known == flag);
        if is_flag { Self::Flag(flag.to_owned()) } else { Self::Nothing }
    }
}

impl Here<'_> {
    fn has(&self, flag: &str) -> bool {
        self.flags.iter().any(|known| known == flag)
    }

    /// What does here what a flag of other commands, or of none, asks for.
    fn meant_by(&self, flag: &str) -> Vec<String> {
        let mut tips: Vec<&str> = Vec::new();
        if self.name == Some("batch") {
            let in_manifest = IN_MANIFESTS.iter().find(|(known, _)| *known == flag);
            if let Some((_, line)) = in_manifest {
                return vec![format!("the manifest says it, of each of its [[trees]]: {line}")];
            }
            if flag == "--mkdir" {
                tips.push("'linden batch' makes the folder of --out, and those in it, without a flag");
            }
        }
        match flag {
            "--season" | "--seasons" => {
                if self.has("--set") {
                    tips.push("one season is a knob: '--set season=autumn'");
                }
                tips.push("a file for each: 'linden export SOURCE --seasons'");
            }
            "--ages" => {
                if self.has("--age") {
                    tips.push("one age: '--age 10y'");
                } else if self.has("--set") {
                    tips.push("an age is a knob: '--set age=0.5'");
                }
                tips.push("several on a picture: 'linden sheet SOURCE --ages -o ages.png'");
            }
            _ => {}
        }
        tips.into_iter().map(str::to_owned).collect()
    }

    /// The command with a word of its own in the place of the flag: `linden cache clear`.
    fn word(&self, typed: &str) -> Option<String> {
        let word = typed.strip_prefix("--")?;
        let name = self.name?;
        let is_value = self
            .command
            .get_positionals()
            .any(|argument| argument.get_possible_values().iter().any(|value| value.get_name() == word));
        let is_command = self.command.find_subcommand(word).is_some();
        (is_value || is_command).then(|| format!("it is no flag: 'linden {name} {word}'"))
    }

    /// The knob that is called like the flag, where knobs can be turned.
    fn knob(&self, typed: &str) -> Option<String> {
        let name = typed.strip_prefix("--")?.replace('-', "_");
        let is_knob = self.has("--set") && KNOBS.iter().any(|row| row.knob.is_called(&name));
        is_knob.then(|| format!("'--set {name}=VALUE' turns a knob of that name"))
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

/// The flag that is a few letters away, or that what was typed begins. Dashes, which all have, are no letters: `--force` is not
/// `--for`.
fn spelt_alike<'a>(typed: &str, flags: impl IntoIterator<Item = &'a str>) -> Option<String> {
    const LEAST: usize = 3;
    let letters = |flag: &'a str| flag.strip_prefix("--").unwrap_or(flag);
    let typed = typed.strip_prefix("--").unwrap_or(typed);
    let flags: Vec<&str> = flags.into_iter().map(letters).collect();
    let begun = || flags.iter().find(|flag| typed.len() >= LEAST && flag.starts_with(typed)).copied();
    nearest(typed, flags.iter().copied()).or_else(begun).map(|flag| format!("--{flag}"))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;
    use linden::manifest::Manifest;
    use linden::preset::builtin;

    use super::*;
    use crate::cli::Cli;

    #[test]
    fn lines_of_manifests_say_what_the_flag_says() {
        let mut program = Cli::command();
        program.build();
        for (flag, line) in IN_MANIFESTS {
            let told = Meant::by(flag, Some("batch"), &program);
            let Meant::Tips(tips) = told else { panic!("{flag}: {told:?}") };
            assert!(tips.len() == 1 && tips[0].ends_with(line), "{flag}: {tips:?}");
            let formats = if flag == "--format" { "" } else { "formats = [\"obj\"]\n" };
            let manifest = Manifest::parse(&format!("[[trees]]\nsource = \"oak\"\n{formats}{line}\n"));
            let manifest = manifest.unwrap_or_else(|fault| panic!("{line}: {fault}"));
            let mut preset = builtin("oak").unwrap().load().unwrap();
            let knob = flag.trim_start_matches('-').replace('-', "_");
            for number in 0..manifest.len() {
                let item = manifest.item(number).unwrap();
                for (name, value) in &item.set {
                    assert!(flag == "--set" || knob.starts_with(name), "{flag}: {line}");
                    preset.set(name, value).unwrap_or_else(|error| panic!("{line}: {error}"));
                }
                if let Some(age) = item.age {
                    assert_eq!(preset.ages_of(age).unwrap().len(), 1, "{line}");
                }
            }
        }
    }
}
