//! Options whose value may be left out: what stands behind one is its value, or the next argument.
//!
//! A parser takes every word behind such an option for its value, the source in `linden export --ages hazel` too. Where
//! such a word names a source and is no value of the option, all sources are put right behind the command's name: what
//! stands there is the value of no option, whichever await one.

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

/// The arguments, with all sources in their order before all options where an option would take one for its value.
pub fn apart(program: &Command, arguments: Vec<OsString>, taking: Taking) -> Vec<OsString> {
    let Some((at, command)) = command_of(program, &arguments) else { return arguments };
    let (mut sources, mut options) = (Vec::new(), Vec::new());
    let mut was_taken = false;
    let mut rest = arguments[at + 1..].iter();
    while let Some(word) = rest.as_slice().first().filter(|word| *word != "--") {
        rest.next();
        if is_plain(word) {
            sources.push(word);
            continue;
        }
        options.push(word);
        let Some(behind) = rest.as_slice().first() else { break };
        match value_behind(command, word) {
            Value::Needed if is_plain(behind) => options.extend(rest.next()),
            Value::Optional(is_value) if is_plain(behind) => {
                if is_value.is_some_and(|is_value| is_source(behind, is_value, taking)) {
                    was_taken = true;
                } else {
                    options.extend(rest.next());
                }
            }
            _ => {}
        }
    }
    if !was_taken {
        return arguments;
    }
    let before = arguments[..=at].iter();
    before.chain(sources).chain(options).chain(rest).cloned().collect()
}

/// The first of these options that took a word for its value, and the word.
pub fn taken(program: &Command, arguments: &[OsString]) -> Option<(String, String)> {
    let (_, command) = command_of(program, arguments)?;
    let before = arguments.iter().take_while(|word| *word != "--");
    let pairs = before.zip(arguments.iter().skip(1));
    let mut pairs = pairs.filter(|(option, word)| {
        matches!(value_behind(command, option), Value::Optional(Some(_))) && is_plain(word)
    });
    pairs.next().map(|(option, word)| {
        let shown = |text: &OsStr| linden::knob::printable(&text.to_string_lossy());
        (shown(option), shown(word))
    })
}

/// The command, where it takes sources, and where it stands.
fn command_of<'a>(program: &'a Command, arguments: &[OsString]) -> Option<(usize, &'a Command)> {
    let mut words = arguments.iter().enumerate().skip(1);
    let (at, command) = words.find_map(|(at, word)| Some((at, program.find_subcommand(word.to_str()?)?)))?;
    command.get_positionals().next().is_some().then_some((at, command))
}

/// Whether a word is a source, or a value, and no option.
fn is_plain(word: &OsStr) -> bool {
    word == "-" || !word.as_encoded_bytes().starts_with(b"-")
}

/// What of an option stands in the word behind it.
enum Value {
    /// Nothing: it has no value, or has it in the same word.
    None,
    Needed,
    /// Its value, or nothing; of [`OPTIONS`] what tells.
    Optional(Option<IsValue>),
}

/// Whether an argument may have its value behind it, or none.
fn may_have_value_behind(argument: &Arg) -> bool {
    let is_optional =
        argument.get_num_args().is_some_and(|values| values.min_values() == 0 && values.max_values() == 1);
    is_optional && !argument.is_require_equals_set() && !argument.is_positional()
}

/// What of an option stands in the word behind it.
fn value_behind(command: &Command, word: &OsStr) -> Value {
    let Some(argument) = word.to_str().and_then(|word| last_option(command, word)) else {
        return Value::None;
    };
    if may_have_value_behind(argument) {
        let name = argument.get_long();
        let known = OPTIONS.iter().find(|(known, _)| Some(*known) == name);
        return Value::Optional(known.map(|(_, is_value)| *is_value));
    }
    let is_needed = argument.get_num_args().is_some_and(|values| values.min_values() > 0);
    if is_needed && !argument.is_require_equals_set() { Value::Needed } else { Value::None }
}

/// The option that a word ends with: `--output`, `-o`, `-qo`; none where its value is in the same word.
fn last_option<'a>(command: &'a Command, word: &str) -> Option<&'a Arg> {
    if let Some(name) = word.strip_prefix("--") {
        return command.get_arguments().find(|known| {
            known.get_long() == Some(name) || known.get_all_aliases().is_some_and(|all| all.contains(&name))
        });
    }
    let mut letters = word.strip_prefix('-')?.chars();
    loop {
        let letter = letters.next()?;
        let argument = command.get_arguments().find(|known| known.get_short() == Some(letter))?;
        if letters.as_str().is_empty() {
            return Some(argument);
        }
        if argument.get_num_args().is_some_and(|values| values.takes_values()) {
            return None;
        }
    }
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
    use clap::error::ErrorKind;
    use clap::parser::ValueSource;

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

    /// The sources and the values of [`OPTIONS`] that the parser finds in a line.
    fn parsed(line: &str) -> Result<String, clap::Error> {
        let program = program();
        let matches = Cli::command().try_get_matches_from(apart(&program, words(line), Taking::Unlike))?;
        let (name, matches) = matches.subcommand().unwrap();
        let command = program.find_subcommand(name).unwrap();
        let of = |argument: &Arg| -> Vec<String> {
            let id = argument.get_id().as_str();
            let is_typed = matches.value_source(id) == Some(ValueSource::CommandLine);
            let raw = matches.get_raw(id).filter(|_| is_typed).into_iter().flatten();
            raw.map(|word| word.to_string_lossy().into_owned()).collect()
        };
        let mut found = command.get_positionals().flat_map(of).collect::<Vec<_>>();
        for (name, _) in OPTIONS {
            let argument = command.get_arguments().find(|argument| argument.get_long() == Some(name));
            found.extend(argument.map(of).into_iter().flatten().map(|value| format!("{name}={value}")));
        }
        Ok(found.join(" "))
    }

    #[test]
    fn sources_behind_options_that_may_have_a_value_are_sources() {
        for (line, expected) in [
            ("linden export --ages hazel -o d.usda", "hazel ages=all"),
            ("linden export --wind fir", "fir wind=attributes"),
            ("linden export --billboard fir --wind oak -o a.glb", "fir oak billboard=2 wind=attributes"),
            ("linden export fir --ages --wind oak -o a.glb", "fir oak ages=all wind=attributes"),
            ("linden export fir --ages --wind sway oak", "fir oak ages=all wind=sway"),
            ("linden export --collision fir oak", "fir oak collision=capsules"),
            // What stands behind a source is one too.
            ("linden export --collision fir hull", "fir hull collision=capsules"),
            ("linden export oak --wind fir simple", "oak fir simple wind=attributes"),
            ("linden export -s points=9 --wind fir -o a.glb oak", "fir oak wind=attributes"),
            ("linden --memory 1G export --memory 4G --wind fir", "fir wind=attributes"),
            ("linden export -oa.glb --wind fir -- oak", "fir oak wind=attributes"),
            ("linden export --seasons - -o a.obj", "- seasons=all"),
            ("linden sheet --lods fir -o a.png", "fir lods="),
            ("linden forest --wind fir:3 oak", "fir:3 oak wind=attributes"),
            ("linden export oak --ages young -o a.glb", "oak ages=young"),
            ("linden export oak --ages young,half=0.5,10y -o a.glb", "oak ages=young,half=0.5,10y"),
            ("linden export --ages 10y oak", "oak ages=10y"),
            ("linden export --wind sway fir", "fir wind=sway"),
            ("linden export --billboard 3 fir", "fir billboard=3"),
            ("linden export --collision hull fir", "fir collision=hull"),
            ("linden export --seasons summer,spring=0.05 fir", "fir seasons=summer,spring=0.05"),
            ("linden sheet --lods 900,400 fir -o a.png", "fir lods=900,400"),
            ("linden export --ages=hazel fir", "fir ages=hazel"),
            // What names nothing is the option's, which says what is wrong with it.
            ("linden export --wind frr oak", "oak wind=frr"),
        ] {
            assert_eq!(parsed(line).unwrap_or_else(|error| panic!("{line}: {error}")), expected, "{line}");
        }
        for line in ["linden export oak -- --wind fir", "linden list --knobs points"] {
            assert_eq!(apart(&program(), words(line), Taking::Unlike), words(line));
        }
    }

    /// A source in the place of a file to write would be overwritten.
    #[test]
    fn no_source_becomes_the_value_of_another_option() {
        for line in [
            "linden export abop-a -o --wind oak",
            "linden export abop-a --output --ages oak",
            "linden export abop-a --set --billboard oak",
            "linden export abop-a -o --lods --wind oak",
            "linden sheet abop-a -o --ages oak",
        ] {
            let error = parsed(line).expect_err(line);
            assert_eq!(error.kind(), ErrorKind::InvalidValue, "{line}: {error}");
            assert!(error.to_string().contains("a value is required for"), "{line}: {error}");
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
