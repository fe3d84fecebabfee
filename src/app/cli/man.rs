//! `linden man`: the manual, made from the tables that the program itself reads.

use std::fs;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use clap_mangen::Man as Page;
use clap_mangen::roff::{Roff, bold, italic, roman};
use linden::knob::Knob;
use linden::preset::{KNOBS, Section};
use linden_exporters::REGISTRY;

use super::complete;
use crate::exit::usage;
use crate::paths::show;

/// Print a page of the manual (roff): linden man | man -l -
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Man {
    /// Print the page of one command
    #[arg(conflicts_with = "output", add = complete::words(|| super::command_names()))]
    command: Option<String>,

    /// Write all pages into this directory, which is made: linden.1 and one a command
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

const AFTER_HELP: &str = "\
  linden man | man -l -                          formats, knobs, variables, files, exit codes
  linden man export | man -l -                   one command
  linden man -o ~/.local/share/man/man1          from now on 'man linden' and 'man linden-export'";

/// Variables, and what they say.
const ENVIRONMENT: &[(&str, &str)] = &[
    ("LINDEN_MEMORY", "the most memory that work may hold, like 4G, or auto; as --memory"),
    ("LINDEN_CACHE", "how much of drawn pictures is kept, like 2G, auto, or off; as cache in config.toml"),
    ("LINDEN_GRAPHICS", "how terminals are shown pictures; as --graphics"),
    ("LINDEN_COLORS", "how many colours the terminal has; as --colors"),
    ("LINDEN_LOG", "the file into which the workbench writes what happens; as --log"),
    ("LINDEN_LOG_LEVEL", "how much of it: error, warn, info, debug or trace"),
    ("LINDEN_CONFIG_DIR", "where settings, keys, themes and presets are, instead of XDG_CONFIG_HOME/linden"),
    ("LINDEN_STATE_DIR", "where the session is kept, instead of XDG_STATE_HOME/linden"),
    ("LINDEN_CACHE_DIR", "where drawn pictures are kept, instead of XDG_CACHE_HOME/linden"),
    (complete_variable(), "set by the scripts of 'linden completions', to the shell's name"),
    ("XDG_CONFIG_HOME, XDG_STATE_HOME, XDG_CACHE_HOME", "~/.config, ~/.local/state, ~/.cache where not set"),
    ("NO_COLOR, CLICOLOR, CLICOLOR_FORCE, FORCE_COLOR, COLORTERM", "colours in the terminal, as elsewhere"),
    ("COLUMNS, LINES", "the size of a preview in the terminal, before what the terminal says"),
    ("VISUAL, EDITOR", "what the workbench edits documents in"),
    ("RAYON_NUM_THREADS", "how many threads work; files are the same for any number"),
    ("PATH", "where programs linden-export-FORMAT are looked for"),
];

/// What is read and kept.
const FILES: &[(&str, &str)] = &[
    ("~/.config/linden/config.toml", "settings; 'linden doctor --example config' is one to begin with"),
    ("~/.config/linden/keymap.toml", "keys of the workbench; 'linden doctor --example keymap'"),
    ("~/.config/linden/themes/NAME.toml", "colours of the workbench; 'linden doctor --example theme'"),
    ("~/.config/linden/presets/", "presets and grammars of your own; folders are groups"),
    ("~/.local/state/linden/session.toml", "where the workbench was left"),
    (
        "~/.cache/linden/pictures/",
        "pictures that were drawn, for the next time; 'linden cache' says how many",
    ),
];

/// How the program ends.
const EXIT_STATUS: &[(&str, &str)] = &[
    ("0", "done"),
    ("1", "it was tried and failed; no file was written or replaced"),
    ("2", "the command line names something that does not exist or cannot be"),
    ("130", "interrupted; for other signals 128 and the signal's number"),
];

const fn complete_variable() -> &'static str {
    super::completions::VARIABLE
}

impl Man {
    pub fn run(self, command: clap::Command) -> anyhow::Result<()> {
        if let Some(folder) = &self.output {
            return write_all(command, folder);
        }
        let page = match self.command {
            None => whole(command)?,
            Some(name) => {
                let found = command.get_subcommands().find(|command| command.get_name() == name).cloned();
                let shown = linden::knob::printable(&name);
                of_command(found.ok_or_else(|| {
                    usage(format!("there is no command '{shown}'; 'linden help' lists them"))
                })?)?
            }
        };
        super::print(&String::from_utf8(page)?)
    }
}

/// Every page in a file, and their names.
fn write_all(command: clap::Command, folder: &PathBuf) -> anyhow::Result<()> {
    let mut pages = Vec::new();
    for page in command.get_subcommands() {
        pages.push((format!("linden-{}.1", page.get_name()), of_command(page.clone())?));
    }
    pages.insert(0, ("linden.1".to_owned(), whole(command)?));
    fs::create_dir_all(folder).with_context(|| format!("making the directory {}", show(folder)))?;
    let mut names = String::new();
    for (name, page) in pages {
        let path = folder.join(name);
        fs::write(&path, page).with_context(|| format!("writing {}", show(&path)))?;
        names.push_str(&format!("{}\n", show(&path)));
    }
    super::print(&names)
}

/// The page of one command.
fn of_command(command: clap::Command) -> anyhow::Result<Vec<u8>> {
    let name = format!("linden-{}", command.get_name());
    let usage = format!("linden {}", command.get_name());
    let mut text = Vec::new();
    Page::new(command.name(name).bin_name(usage).disable_help_subcommand(true)).render(&mut text)?;
    Ok(text)
}

/// The page of the program: besides its options, all that commands have in common.
fn whole(command: clap::Command) -> anyhow::Result<Vec<u8>> {
    let page = Page::new(command.disable_help_subcommand(true));
    let mut text = Vec::new();
    page.render_title(&mut text)?;
    page.render_name_section(&mut text)?;
    page.render_synopsis_section(&mut text)?;
    page.render_description_section(&mut text)?;
    page.render_options_section(&mut text)?;
    page.render_subcommands_section(&mut text)?;
    page.render_extra_section(&mut text)?;
    let mut roff = Roff::new();
    formats(&mut roff);
    knobs(&mut roff);
    for (title, rows) in [("ENVIRONMENT", ENVIRONMENT), ("FILES", FILES), ("EXIT STATUS", EXIT_STATUS)] {
        roff.control("SH", [title]);
        for (name, help) in rows {
            item(&mut roff, name, "", help);
        }
    }
    roff.to_writer(&mut text)?;
    page.render_version_section(&mut text)?;
    Ok(text)
}

/// Formats and their options.
fn formats(roff: &mut Roff) {
    roff.control("SH", ["FORMATS"]);
    roff.text([roman("Written by "), bold("linden export"), roman(" and "), bold("linden forest"), roman(
        ": told by the ending of a file, or by --format. Options are set by --set FORMAT.OPTION=VALUE. Any \
         other format FOO is written by the program linden-export-FOO on the search path.",
    )]);
    for format in REGISTRY.iter().map(|exporter| exporter.format()) {
        item(roff, format.id, "", format.help);
        roff.control("RS", []);
        for spec in format.options {
            let name = format!("{}.{}={}", format.id, spec.knob.name, spec.default);
            item(roff, &name, &spec.knob.kind.to_string(), spec.knob.help);
        }
        roff.control("RE", []);
    }
}

/// All knobs of presets, section by section as documents have them.
fn knobs(roff: &mut Roff) {
    roff.control("SH", ["KNOBS"]);
    roff.text([
        roman(
            "Turned by --set KNOB=VALUE. Which of them a source has, and at which values they stand, says ",
        ),
        bold("linden show SOURCE"),
        roman("; what one does at length, "),
        bold("linden list --knobs KNOB"),
        roman("."),
    ]);
    for section in Section::all() {
        let rows = KNOBS.iter().filter(|row| row.section == section);
        let title = if section.key().is_empty() { "any tree" } else { section.key() };
        roff.control("SS", [title]);
        for Knob { name, kind, unit, help, .. } in rows.map(|row| row.knob) {
            let unit = if unit.is_empty() { String::new() } else { format!("{unit}: ") };
            item(roff, name, &format!("{unit}{kind}"), help);
        }
    }
}

/// A name, what it takes, and what it is.
fn item(roff: &mut Roff, name: &str, takes: &str, help: &str) {
    roff.control("TP", []);
    let between = if takes.is_empty() { "" } else { "  " };
    roff.text([bold(name), roman(between), italic(takes)]);
    roff.text([roman(help)]);
}
