//! What shells complete: asked as bash asks, in bash.

use std::process::{Command, Stdio};

use crate::program::Folder;

/// What bash has after the program's script has completed words that bash itself took apart: at `=` and
/// `:`, as readline does.
fn completed(folder: &Folder, line: &str) -> Vec<String> {
    let program = env!("CARGO_BIN_EXE_linden");
    // Each word, sign and blank as readline parts them.
    let mut words: Vec<String> = vec![String::new()];
    for c in line.chars() {
        let last = words.last_mut().expect("there is one");
        match c {
            ' ' if last.is_empty() => {}
            ' ' => words.push(String::new()),
            '=' | ':' if last.is_empty() => {
                last.push(c);
                words.push(String::new());
            }
            '=' | ':' => words.extend([c.to_string(), String::new()]),
            _ => last.push(c),
        }
    }
    if words.last().is_some_and(String::is_empty) && !line.ends_with(' ') {
        // Behind a sign the word is the sign.
        words.pop();
    }
    let quoted: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
    let script = format!(
        "source <('{program}' completions bash)\n\
         linden() {{ '{program}' \"$@\"; }}\n\
         COMP_WORDS=({}); COMP_CWORD={}; COMP_LINE='{line}'; COMP_POINT={}; COMP_TYPE=9\n\
         _linden; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        quoted.join(" "),
        words.len() - 1,
        line.len(),
    );
    let mut command = Command::new("bash");
    command.args(["--norc", "--noprofile", "-c", &script]).current_dir(folder.path()).stdin(Stdio::null());
    command.env("LINDEN_CONFIG_DIR", folder.file("config"));
    let output = command.output().expect("bash is there");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

#[test]
fn bash_completes_commands_presets_knobs_values_and_formats() {
    let folder = Folder::new();
    folder.write("scan of mine.xyz", "0 0 0\n");
    let at = |line: &str| completed(&folder, line);
    let has = |line: &str, wanted: &str| {
        let found = at(line);
        assert!(found.iter().any(|word| word == wanted), "{line:?} has no {wanted:?}: {found:?}");
    };
    assert_eq!(at("linden exp"), ["export"]);
    assert_eq!(at("linden export norway-s"), ["norway-spruce"]);
    std::fs::create_dir_all(folder.file("config/presets")).unwrap();
    folder.write("config/presets/my-rowan.toml", "");
    assert_eq!(at("linden export my-r"), ["my-rowan"]);
    assert_eq!(at("linden export scan"), ["scan\\ of\\ mine.xyz"]);
    has("linden export fir --", "--billboard");
    assert_eq!(at("linden export fir --set poin"), ["points="]);
    // Of the preset that stands there: an L-system has no points.
    assert_eq!(at("linden export abop-a --set poin"), Vec::<String>::new());
    // Bash has taken these apart at '=': what follows it is completed, and nothing else.
    assert_eq!(at("linden export fir --set junction=w"), ["watertight"]);
    has("linden export fir --set junction=", "blend");
    assert_eq!(at("linden stats oak --set width=pi"), ["pipe"]);
    assert_eq!(at("linden export fir --set glb.quan"), ["glb.quantize="]);
    assert_eq!(at("linden sweep abop-honda-a --define r"), ["r1=", "r2="]);
    assert_eq!(at("linden export fir --set glb.quantize=t"), ["true"]);
    assert_eq!(at("linden export fir --format usd"), ["usda", "usdc", "usdz"]);
    assert_eq!(at("linden preview fir --graphics=si"), ["sixel"]);
    assert_eq!(at("linden preview fir --graphics si"), ["sixel"]);
    has("linden export fir --seasons ", "autumn");
    assert_eq!(at("linden man exp"), ["export"]);
    assert_eq!(at("linden completions po"), ["powershell"]);
}

#[test]
fn every_shell_has_a_script_that_asks_the_program() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = Folder::new().run(&["completions", shell]).done().out;
        assert!(text.contains("LINDEN_COMPLETE") && text.contains("linden"), "{shell}: {text}");
    }
}
