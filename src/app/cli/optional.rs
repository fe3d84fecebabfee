//! Options whose value may be left out: what stands behind one is its value, or the next argument.
//!
//! A parser takes every word behind such an option for its value, the source in `linden export --ages hazel` too. What
//! names a source and is no value of the option is put before it.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use clap::{Arg, Command};
use linden::forest::builtin_forest;
use linden::preset::{KNOBS, builtin};
use linden::season::{Season, is_name};
use linden_exporters::REGISTRY;

use crate::source;

/// What behind an option is its value for sure.
type IsValue = fn(&str) -> bool;

/// The options of commands that take sources, by their names.
const OPTIONS: [(&str, IsValue); 6] = [
    ("ages", is_ages),
    ("billboard", is_number),
    ("collision", is_collision),
    ("lods", is_number),
    ("seasons", is_seasons),
    ("wind", is_wind),
];

/// Which sources are put before an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taking {
    /// Those that are no value of it.
    Unlike,
    /// All: what the command line lacks is a source.
    All,
}

/// Whether one of these options is among some arguments.
pub fn are_among(arguments: &[OsString]) -> bool {
    let mut names = arguments.iter().filter_map(|word| word.to_str()?.strip_prefix("--"));
    names.any(|name| OPTIONS.iter().any(|(known, _)| *known == name))
}

/// The arguments, sources before options that would take them for their value.
pub fn apart(program: &Command, mut arguments: Vec<OsString>, taking: Taking) -> Vec<OsString> {
    let Some(command) = command_of(program, &arguments) else { return arguments };
    let mut at = 1;
    while at + 1 < arguments.len() && arguments[at] != "--" {
        let option = option_of(command, &arguments[at]);
        if option.is_some_and(|is_value| is_source(&arguments[at + 1], is_value, taking)) {
            arguments.swap(at, at + 1);
        }
        at += 1;
    }
    arguments
}

/// The first of these options that took a word for its value, and the word.
pub fn taken(program: &Command, arguments: &[OsString]) -> Option<(String, String)> {
    let command = command_of(program, arguments)?;
    let before = arguments.iter().take_while(|word| *word != "--");
    let pairs = before.zip(arguments.iter().skip(1));
    let mut pairs = pairs.filter(|(option, word)| {
        option_of(command, option).is_some() && !word.as_encoded_bytes().starts_with(b"-")
    });
    pairs.next().map(|(option, word)| {
        let shown = |text: &OsStr| linden::knob::printable(&text.to_string_lossy());
        (shown(option), shown(word))
    })
}

/// The command, where it takes sources.
fn command_of<'a>(program: &'a Command, arguments: &[OsString]) -> Option<&'a Command> {
    let mut words = arguments.iter().skip(1).filter_map(|word| word.to_str());
    let command = words.find_map(|word| program.find_subcommand(word))?;
    command.get_positionals().next().is_some().then_some(command)
}

/// Whether an argument may have its value behind it, or none.
fn may_have_value_behind(argument: &Arg) -> bool {
    let is_optional =
        argument.get_num_args().is_some_and(|values| values.min_values() == 0 && values.max_values() == 1);
    is_optional && !argument.is_require_equals_set() && !argument.is_positional()
}

/// What an argument of a command takes behind it, if it is one of these options.
fn option_of(command: &Command, argument: &OsStr) -> Option<IsValue> {
    let name = argument.to_str()?.strip_prefix("--")?;
    let found = command.get_arguments().find(|known| known.get_long() == Some(name))?;
    let (_, is_value) = OPTIONS.iter().find(|(known, _)| *known == name)?;
    may_have_value_behind(found).then_some(*is_value)
}

/// Whether a word behind an option is a source in place of its value.
fn is_source(word: &OsStr, is_value: IsValue, taking: Taking) -> bool {
    let is_value = word.to_str().is_some_and(is_value);
    if is_value && taking == Taking::Unlike {
        return false;
    }
    // A forest's kinds have their share behind a colon.
    let name =
        word.to_str().and_then(|text| text.rsplit_once(':')).map_or(word, |(name, _)| OsStr::new(name));
    word == "-" || [word, name].iter().any(|name| source::ensure_there(Path::new(name)).is_ok())
}

fn is_number(text: &str) -> bool {
    text.split(',').all(|number| number.trim().parse::<f64>().is_ok())
}

fn is_seasons(text: &str) -> bool {
    Season::parse_list(text).is_ok()
}

/// Plants name their ages as they like; what is a preset's id is none of these.
fn is_ages(text: &str) -> bool {
    let is_id = || builtin(text).is_ok() || builtin_forest(text).is_ok();
    text.contains(['=', ',']) || is_number(text.trim_end_matches('y')) || (is_name(text) && !is_id())
}

fn is_wind(text: &str) -> bool {
    KNOBS.iter().any(|row| row.knob.name == "wind" && row.knob.kind.parse(text).is_ok())
}

fn is_collision(text: &str) -> bool {
    let mut options = REGISTRY.iter().flat_map(|exporter| exporter.format().options);
    options.any(|spec| spec.knob.name == "collision" && spec.knob.kind.parse(text).is_ok())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Cli;

    fn program() -> Command {
        let mut program = Cli::command();
        program.build();
        program
    }

    fn words(line: &str) -> Vec<OsString> {
        line.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn every_option_that_may_have_its_value_behind_it_is_known() {
        let program = program();
        for command in program.get_subcommands().filter(|command| command.get_positionals().next().is_some())
        {
            for argument in command.get_arguments().filter(|argument| may_have_value_behind(argument)) {
                let name = argument.get_long().unwrap();
                let is_known = OPTIONS.iter().any(|(known, _)| *known == name);
                assert!(is_known, "{} --{name}", command.get_name());
            }
        }
    }

    #[test]
    fn sources_stand_before_options_that_may_have_a_value() {
        for (line, expected) in [
            ("linden export --ages hazel -o d.usda", "linden export hazel --ages -o d.usda"),
            ("linden export --wind fir", "linden export fir --wind"),
            (
                "linden export --billboard fir --wind oak -o a.glb",
                "linden export fir --billboard oak --wind -o a.glb",
            ),
            ("linden export --collision fir oak", "linden export fir oak --collision"),
            ("linden export --seasons - -o a.obj", "linden export - --seasons -o a.obj"),
            ("linden sheet --lods fir -o a.png", "linden sheet fir --lods -o a.png"),
            ("linden forest --wind fir:3 oak", "linden forest fir:3 oak --wind"),
        ] {
            assert_eq!(apart(&program(), words(line), Taking::Unlike), words(expected));
        }
        for line in [
            "linden export oak --ages young -o a.glb",
            "linden export oak --ages young,half=0.5,10y -o a.glb",
            "linden export --ages 10y oak",
            "linden export --wind sway fir",
            "linden export --billboard 3 fir",
            "linden export --collision hull fir",
            "linden export --seasons summer,spring=0.05 fir",
            "linden sheet --lods 900,400 fir -o a.png",
            "linden export --ages=hazel fir",
            "linden export oak -- --wind fir",
            "linden list --knobs points",
            // What names nothing is the option's, which says what is wrong with it.
            "linden export --wind frr oak",
        ] {
            assert_eq!(apart(&program(), words(line), Taking::Unlike), words(line));
        }
    }

    #[test]
    fn what_an_option_took_is_told() {
        let of = |line: &str| taken(&program(), &words(line));
        let pair = |option: &str, word: &str| Some((option.to_owned(), word.to_owned()));
        assert_eq!(of("linden export -o a.glb --ages hazle"), pair("--ages", "hazle"));
        assert_eq!(of("linden export --wind -o a.glb --billboard 3"), pair("--billboard", "3"));
        assert_eq!(of("linden export --wind -o a.glb"), None);
    }
}
