//! The command line and the recipe of what is on screen.

use crate::tui::export::ExportWords;
use crate::tui::forest::ForestOnScreen;
use crate::tui::tree::{Tree, TreePlace};

/// A command line that exports what is on screen, for a shell, as the dialog would; without one to a file of its id.
pub fn command_line(tree: &Tree, words: Option<ExportWords>) -> String {
    let words = words.unwrap_or_else(|| ExportWords::to(&tree.preset().id));
    let Some((overrides, source)) = tree.overrides().zip(source_word(&tree.place)) else {
        // What knobs cannot say goes along as a whole.
        let recipe = tree.recipe().to_line();
        return format!("{} <<'END'\n{recipe}\nEND", joined("export", "-".to_owned(), Vec::new(), words));
    };
    joined("export", source, overrides, words)
}

/// The command line that writes a forest; `None` where its file has a name that no terminal should be given.
pub fn forest_command_line(forest: &ForestOnScreen, words: Option<ExportWords>) -> Option<String> {
    let words = words.unwrap_or_else(|| ExportWords::to(&forest.wanted().id));
    Some(joined("forest", source_word(&forest.place)?, forest.overrides(), words))
}

fn joined(
    command: &str,
    source: String,
    overrides: Vec<(&'static str, String)>,
    said: ExportWords,
) -> String {
    let mut words = vec!["linden".to_owned(), command.to_owned(), source];
    words.extend(said.outputs);
    // What is turned for the export alone comes instead of what is on screen.
    let is_turned = |name: &str| said.knobs.iter().any(|(turned, _)| *turned == name);
    let kept = overrides.into_iter().filter(|(name, _)| !is_turned(name));
    for (name, value) in kept.chain(said.knobs.iter().cloned()) {
        words.extend(["--set".to_owned(), format!("{name}={value}")]);
    }
    words.extend(said.options);
    shell_words::join(words)
}

impl ExportWords {
    /// To a file of an id, as linden usually writes.
    fn to(id: &str) -> Self {
        Self { outputs: vec!["-o".to_owned(), format!("{}.glb", stem(id))], ..Self::default() }
    }
}

/// What names a place on a command line; `None` for a path that a terminal would obey.
fn source_word(place: &TreePlace) -> Option<String> {
    match place {
        TreePlace::Builtin(id) => Some((*id).to_owned()),
        TreePlace::File(path) => {
            path.to_str().filter(|path| linden::knob::printable(path) == *path).map(str::to_owned)
        }
    }
}

/// An id as the name of a file.
fn stem(id: &str) -> String {
    let kept = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    id.chars().map(|c| if kept(c) { c } else { '-' }).collect()
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
        let words = shell_words::split(&command_line(&tree, None)).unwrap();
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
        let line = command_line(&tree, None);
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
        let line = command_line(&tree, None);
        let document = line.lines().nth(1).unwrap();
        let read = linden::preset::Preset::from_json(document).unwrap();
        assert!(read == *tree.preset());
        assert!(line.starts_with("linden export - -o abop-a.glb <<'END'\n") && line.ends_with("\nEND"));
    }
}
