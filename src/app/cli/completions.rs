//! `linden completions`: what a shell needs to complete the command line.
//!
//! The scripts ask the program what may follow, so that presets, knobs and their values are completed as
//! they are now. [`answer`] is the program's side of it.

use anyhow::Context;
use clap::Args;
use clap_complete::env::Shells;
use clap_complete::{CompleteEnv, Shell};

/// The variable by which a script asks. Its value is the shell's name.
pub const VARIABLE: &str = "LINDEN_COMPLETE";

/// Print completions for a shell
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Completions {
    /// bash, zsh, fish, elvish or powershell
    shell: Shell,
}

const AFTER_HELP: &str = "\
They complete commands and options, presets, knobs and their values, formats and files:
  bash         echo 'source <(linden completions bash)' >> ~/.bashrc
  zsh          echo 'source <(linden completions zsh)' >> ~/.zshrc      (after compinit)
  fish         linden completions fish > ~/.config/fish/completions/linden.fish
  elvish       echo 'eval (linden completions elvish | slurp)' >> ~/.config/elvish/rc.elv
  powershell   linden completions powershell | Out-String | Invoke-Expression";

impl Completions {
    pub fn run(self) -> anyhow::Result<()> {
        if self.shell == Shell::Bash {
            return super::print(BASH);
        }
        let name = self.shell.to_string();
        let shells = Shells::builtins();
        let shell =
            shells.completer(&name).with_context(|| format!("there are no completions for {name}"))?;
        let mut text = Vec::new();
        shell.write_registration(VARIABLE, "linden", "linden", "linden", &mut text)?;
        super::print(&String::from_utf8(text)?)
    }
}

/// Answers a shell that asks, and ends then; comes back when none does.
pub fn answer(command: fn() -> clap::Command) {
    CompleteEnv::with_factory(command).var(VARIABLE).complete();
}

/// Bash takes words apart at `=` and `:`, which stand in `--set crown=cone` and `oak:2`. What no blank
/// parts is one word for the program, and of its answers bash is given what follows the last such sign.
const BASH: &str = r#"# Completions of linden for bash: source <(linden completions bash)
_linden() {
    local IFS=$'\013' rest=$COMP_LINE part index glued= count=0
    local -a words=()
    for ((index = 0; index <= COMP_CWORD; index++)); do
        part=${COMP_WORDS[index]}
        if [[ -n $glued ]]; then
            words[count - 1]+=$part
        else
            words[count++]=$part
        fi
        rest=${rest#*"$part"}
        if [[ -z $rest || $rest == [[:blank:]]* ]]; then glued=; else glued=1; fi
    done
    COMPREPLY=($(
        _CLAP_IFS="$IFS" _CLAP_COMPLETE_INDEX=$((count - 1)) _CLAP_COMPLETE_COMP_TYPE=$COMP_TYPE \
            _CLAP_COMPLETE_SPACE=false LINDEN_COMPLETE=bash "${words[0]}" -- "${words[@]}" 2>/dev/null
    ))
    local typed=${words[count - 1]}
    if [[ $COMP_WORDBREAKS == *=* && $typed == *=* || $COMP_WORDBREAKS == *:* && $typed == *:* ]]; then
        COMPREPLY=("${COMPREPLY[@]#"${typed%"${typed##*[=:]}"}"}")
    fi
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=/:.] ]]; then
        compopt -o nospace 2>/dev/null
    fi
    COMPREPLY=("${COMPREPLY[@]// /\\ }")
}
complete -o bashdefault -o nosort -F _linden linden 2>/dev/null || complete -o bashdefault -F _linden linden
"#;
