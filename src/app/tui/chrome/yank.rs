//! The command line and the recipe of what is on screen.

use crate::tui::tree::{Tree, TreePlace};

/// A command line that exports what is on screen, for a shell.
pub fn command_line(tree: &Tree) -> String {
    let id = &tree.preset().id;
    let stem: String = id
        .chars()
        .map(|c| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' })
        .collect();
    let target = format!("{stem}.glb");
    // A path that a terminal would obey is not pasted into one.
    let is_safe = match &tree.place {
        TreePlace::Builtin(_) => true,
        TreePlace::File(path) => path.to_str().is_some_and(|path| linden::knob::printable(path) == path),
    };
    let Some(overrides) = tree.overrides().filter(|_| is_safe) else {
        // What knobs cannot say goes along as a whole.
        let recipe = tree.recipe().to_line();
        return format!("linden export - -o {target} <<'END'\n{recipe}\nEND");
    };
    let source = match &tree.place {
        TreePlace::Builtin(id) => (*id).to_owned(),
        TreePlace::File(path) => path.to_string_lossy().into_owned(),
    };
    let mut words = vec!["linden".to_owned(), "export".to_owned(), source, "-o".to_owned(), target];
    for (name, value) in overrides {
        words.push("--set".to_owned());
        words.push(format!("{name}={value}"));
    }
    shell_words::join(words)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use linden::recipe::Recipe;

    use super::*;

    #[test]
    fn a_shell_reads_the_line_as_it_was_meant() {
        let preset = linden::preset::builtin("cypress").unwrap().load().unwrap();
        let mut tree = Tree::new(TreePlace::File("my trees/c.toml".into()), Recipe::new(preset));
        tree.set("profile", "0,1; 2,2; 6,1; 9,0", Instant::now()).unwrap();
        let words = shell_words::split(&command_line(&tree)).unwrap();
        assert_eq!(
            words,
            [
                "linden",
                "export",
                "my trees/c.toml",
                "-o",
                "cypress.glb",
                "--set",
                "profile=0,1; 2,2; 6,1; 9,0"
            ]
        );
    }

    #[test]
    fn a_path_that_a_terminal_would_obey_is_not_copied() {
        let preset = linden::preset::builtin("fir").unwrap().load().unwrap();
        let tree = Tree::new(TreePlace::File("a\u{1b}[201~\nrm -r x.toml".into()), Recipe::new(preset));
        let line = command_line(&tree);
        assert!(!line.contains('\u{1b}') && !line.contains("rm -r"), "{line}");
        assert!(line.starts_with("linden export - -o fir.glb <<'END'\n"));
    }

    #[test]
    fn what_knobs_cannot_say_goes_along_as_a_recipe() {
        let preset = linden::preset::builtin("abop-a").unwrap().load().unwrap();
        let mut tree = Tree::new(TreePlace::Builtin("abop-a"), Recipe::new(preset.clone()));
        let mut other = preset;
        if let Some(lsystem) = other.settings_mut::<linden::preset::LSystem>() {
            lsystem.grammar = linden::lsystem::Grammar::new("F", &["F -> F[+F]F"]).unwrap();
        }
        tree.replace(other);
        let line = command_line(&tree);
        let document = line.lines().nth(1).unwrap();
        let read = linden::preset::Preset::from_json(document).unwrap();
        assert!(read == *tree.preset());
        assert!(line.starts_with("linden export - -o abop-a.glb <<'END'\n") && line.ends_with("\nEND"));
    }
}
