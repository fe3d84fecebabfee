//! `linden completions`: what a shell needs to complete our command line.

use clap::Args;
use clap_complete::Shell;

/// Print completions for a shell
#[derive(Args)]
pub struct Completions {
    /// bash, zsh, fish, elvish or powershell
    shell: Shell,
}

impl Completions {
    pub fn run(self, command: &mut clap::Command) -> anyhow::Result<()> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, command, "linden", &mut text);
        super::print(&String::from_utf8(text)?)
    }
}
