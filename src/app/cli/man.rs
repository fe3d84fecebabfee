//! `linden man`: the manual, made from the command line's own table.

use clap::Args;
use clap_mangen::Man as Page;

use crate::exit::usage;

/// Print the manual page (roff): linden man | man -l -
#[derive(Args)]
pub struct Man {
    /// Print the page of one command
    command: Option<String>,
}

impl Man {
    pub fn run(self, command: clap::Command) -> anyhow::Result<()> {
        let page = match self.command {
            None => command,
            Some(name) => {
                let found = command.get_subcommands().find(|own| own.get_name() == name).cloned();
                let shown = linden::knob::printable(&name);
                let found = found.ok_or_else(|| {
                    usage(format!("there is no command '{shown}'; 'linden help' lists them"))
                })?;
                found.name(format!("linden-{name}"))
            }
        };
        let mut text = Vec::new();
        Page::new(page).render(&mut text)?;
        super::print(&String::from_utf8(text)?)
    }
}
