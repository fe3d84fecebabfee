//! `linden cite`: what a paper says of a tree, so that others grow the same.

mod changes;

use clap::{Args, ValueEnum};
use linden::knob::printable;
use linden::preset::Preset;
use linden::provenance::{Provenance, hash_text};
use linden::recipe::{Input, Recipe, VERSION};
use linden::skeleton::publication::Publication;
use serde::Serialize;

use self::changes::Changes;
use super::GrowArgs;
use super::forest::resolved;
use crate::progress::Progress;
use crate::source::forest::{ForestFile, turn};
use crate::source::{self, MissingFile};

/// Who wrote the program, as its license names them.
const AUTHORS: &str = "The linden developers";

/// Say what to put into a paper about a tree or a forest
///
/// The program with its version and commit, where the preset and the method are from, the seed, hashes of the recipe
/// and of the tree that it grows, and a command that grows it again: 'linden stats' says the same hashes, if it is
/// the same tree. Of a forest, which is not grown, the hash of its recipe and the sources of each kind.
#[derive(Args)]
pub struct Cite {
    #[command(flatten)]
    growing: GrowArgs,

    /// For people, for a list of references, or for scripts
    #[arg(long, value_enum, default_value_t)]
    format: CitationFormat,
}

#[derive(Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
enum CitationFormat {
    #[default]
    Text,
    Bibtex,
    Json,
}

/// The names of `--format json`: scripts rely on them.
#[derive(Serialize)]
struct Citation {
    program: Program,
    source: String,
    seed: u64,
    hash: Hashes,
    /// One, or the kinds of a forest.
    trees: Vec<CitedTree>,
    publications: Vec<Publication>,
    /// For a shell.
    command: String,
    recipe: serde_json::Value,
}

#[derive(Serialize)]
struct Program {
    name: &'static str,
    version: &'static str,
    license: &'static str,
}

/// Hexadecimal; null of what was not grown.
#[derive(Serialize)]
struct Hashes {
    recipe: String,
    skeleton: Option<String>,
    organs: Option<String>,
}

#[derive(Serialize)]
struct CitedTree {
    id: String,
    name: String,
    /// Where the preset is from; may be empty.
    origin: String,
    generator: &'static str,
    /// What people call that.
    #[serde(skip)]
    method: &'static str,
    #[serde(flatten)]
    changes: Changes,
    inputs: Vec<CitedInput>,
}

/// A file that the preset names.
#[derive(Serialize)]
struct CitedInput {
    file: String,
    xxh3: String,
}

impl CitedTree {
    /// `flags` are those that turned it.
    fn of(recipe: &Recipe, flags: Option<&GrowArgs>) -> anyhow::Result<Self> {
        let Preset { id, name, source, .. } = &recipe.preset;
        let cited =
            |(file, input): (&str, &Input)| CitedInput { file: printable(file), xxh3: input.hash_text() };
        Ok(Self {
            id: printable(id),
            name: printable(if name.trim().is_empty() { id } else { name }),
            origin: printable(source),
            generator: recipe.preset.grows_by().id(),
            method: recipe.preset.grows_by().name(),
            changes: Changes::of(&recipe.preset, flags)?,
            inputs: recipe.inputs.iter().map(cited).collect(),
        })
    }
}

impl Cite {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let citation = self.citation(&progress)?;
        progress.clear();
        match self.format {
            CitationFormat::Text => super::print(&citation.text()),
            CitationFormat::Bibtex => super::print(&citation.bibtex()),
            CitationFormat::Json => super::print_json(&citation),
        }
    }

    fn citation(&self, progress: &Progress) -> anyhow::Result<Citation> {
        let program = Program { name: "linden", version: VERSION, license: env!("CARGO_PKG_LICENSE") };
        if let Some(named) = self.growing.source.to_str()
            && let Some(described) = ForestFile::find(named, progress)?
        {
            self.growing.without_defines("a forest has several trees")?;
            self.growing.without_edits("a forest has several trees")?;
            self.growing.without_age("a forest has several trees")?;
            let source = described.shown();
            let mut forest = resolved(described, progress)?.forest;
            for (name, value) in self.growing.pairs()? {
                turn(&mut forest, &name, &value)?;
            }
            let recipes: Vec<&Recipe> = forest.kinds.iter().map(|kind| &kind.recipe).collect();
            return Ok(Citation {
                program,
                source,
                seed: forest.layout.seed,
                hash: Hashes { recipe: hash_text(forest.hash()), skeleton: None, organs: None },
                trees: recipes
                    .iter()
                    .map(|recipe| CitedTree::of(recipe, None))
                    .collect::<anyhow::Result<_>>()?,
                publications: publications(&recipes),
                command: self.command("forest") + " -o again.glb",
                recipe: serde_json::from_str(&forest.to_line())?,
            });
        }
        let source = match self.growing.resolve(progress) {
            Err(error) if error.is::<MissingFile>() => return self.of_carried(program, error, progress),
            resolved => resolved?,
        };
        let tree = super::grown(&source, progress)?.hash();
        let recipe = &source.recipe;
        Ok(Citation {
            program,
            seed: recipe.preset.seed(),
            hash: Hashes {
                recipe: hash_text(recipe.hash()),
                skeleton: Some(hash_text(tree.skeleton)),
                organs: Some(hash_text(tree.organs)),
            },
            trees: vec![CitedTree::of(recipe, Some(&self.growing))?],
            publications: publications(&[recipe]),
            command: self.command("stats"),
            recipe: serde_json::from_str(&recipe.to_line_of(tree))?,
            source: source.shown,
        })
    }

    /// What a file says of its tree, where one that the tree is grown from is not there.
    fn of_carried(
        &self,
        program: Program,
        missing: anyhow::Error,
        progress: &Progress,
    ) -> anyhow::Result<Citation> {
        let GrowArgs { source, settings, defines, edits, age, seed } = &self.growing;
        let lists = [settings, defines, edits];
        let is_as_written = lists.iter().all(|list| list.is_empty()) && age.is_none() && seed.is_none();
        let carried = if is_as_written { source::carried_recipe(source, progress)? } else { None };
        let Some(json) = carried else { return Err(missing) };
        let shown = crate::paths::show(source);
        let preset = Preset::from_json(&json).map_err(|fault| source::locate(&shown, &fault))?;
        let recipe = Recipe::new(preset);
        let provenance = Provenance::of(&json, &recipe);
        let document: serde_json::Value = serde_json::from_str(&json)?;
        // Hashes of a recipe that was changed since are of another.
        let (Some(tree), Some(hash)) = (provenance.tree, document["hash"]["recipe"].as_str()) else {
            return Err(missing);
        };
        let note = format!("{missing}. Cited is what {shown} says; nothing was grown to compare it with");
        let version = provenance.version_note().map(|note| format!("{shown}: {note}"));
        super::notes(&[note].into_iter().chain(version).collect::<Vec<_>>(), progress);
        let inputs = document["inputs"].as_array().into_iter().flatten().filter_map(|input| {
            let text = |key: &str| input[key].as_str().map(printable);
            Some(CitedInput { file: text("file")?, xxh3: text("xxh3")? })
        });
        let cited = CitedTree { inputs: inputs.collect(), ..CitedTree::of(&recipe, Some(&self.growing))? };
        Ok(Citation {
            program,
            seed: recipe.preset.seed(),
            hash: Hashes {
                recipe: hash.to_owned(),
                skeleton: Some(hash_text(tree.skeleton)),
                organs: Some(hash_text(tree.organs)),
            },
            trees: vec![cited],
            publications: publications(&[&recipe]),
            command: self.command("stats"),
            recipe: document,
            source: shown,
        })
    }

    /// The command line that does something else with the same source.
    fn command(&self, command: &str) -> String {
        let GrowArgs { source, settings, defines, edits, age, seed } = &self.growing;
        let mut words = vec!["linden".to_owned(), command.to_owned(), crate::paths::show(source)];
        for (flag, pairs) in [("--set", settings), ("--define", defines), ("--edit", edits)] {
            words.extend(pairs.iter().flat_map(|pair| [flag.to_owned(), printable(pair)]));
        }
        words.extend(age.iter().flat_map(|age| ["--age".to_owned(), printable(age)]));
        words.extend(seed.iter().flat_map(|seed| ["--seed".to_owned(), seed.to_string()]));
        shell_words::join(words)
    }
}

/// What the methods of some trees are from, each once.
fn publications(recipes: &[&Recipe]) -> Vec<Publication> {
    let mut all: Vec<Publication> = Vec::new();
    for publication in recipes.iter().flat_map(|recipe| recipe.preset.generator.publications()) {
        if !all.contains(&publication) {
            all.push(publication);
        }
    }
    all
}

impl Citation {
    /// A row for each fact.
    fn rows(&self) -> Vec<(&'static str, String)> {
        let Program { name, version, license } = self.program;
        let mut rows = vec![("program", format!("{name} {version}, {license}"))];
        for tree in &self.trees {
            rows.push(("tree", format!("{} ({})", tree.name, tree.id)));
            rows.push(("from", tree.origin.clone()));
            rows.push(("method", tree.method.to_owned()));
            rows.extend(tree.changes.rows());
            rows.extend(tree.inputs.iter().map(|input| ("file", format!("{} {}", input.file, input.xxh3))));
        }
        rows.extend(self.publications.iter().map(|publication| ("method from", publication.to_string())));
        rows.push(("seed", self.seed.to_string()));
        rows.push(("recipe hash", self.hash.recipe.clone()));
        rows.extend(self.hash.skeleton.clone().map(|hash| ("skeleton hash", hash)));
        rows.extend(self.hash.organs.clone().map(|hash| ("organs hash", hash)));
        rows.push(("again", self.command.clone()));
        rows.retain(|(_, value)| !value.is_empty());
        rows
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for (label, value) in self.rows() {
            text.push_str(&format!("{label:13}  {value}\n"));
        }
        text
    }

    /// The program with the tree in its note, then what the method is from. An entry for each tree: several may be
    /// cited.
    fn bibtex(&self) -> String {
        let Program { name, version, license } = self.program;
        let mut text = String::new();
        let about: Vec<String> = self
            .rows()
            .into_iter()
            .filter(|(label, _)| !["program", "method from"].contains(label))
            .map(|(label, value)| format!("{label}: {}", tex(&value)))
            .collect();
        let ids: Vec<&str> = self.trees.iter().map(|tree| tree.id.as_str()).collect();
        let is_plain = |letter: char| letter.is_ascii_alphanumeric();
        let key = ids.join("-").replace(|letter| !is_plain(letter), "-");
        // No year: a version has none that is sure. The date of a build would differ from build to build, and a commit need
        // not be of a release. Styles that know no version print the note, which has it too.
        let fields = [
            ("author", format!("{{{AUTHORS}}}")),
            ("title", format!("{{{name}}}")),
            ("version", tex(version)),
            ("howpublished", format!("Computer program, {license}")),
            ("note", format!("version {}; {}", tex(version), about.join("; "))),
        ];
        text.push_str(&format!("@misc{{{name}-{key},\n"));
        for (field, value) in fields {
            text.push_str(&format!("  {field} = {{{value}}},\n"));
        }
        text.push_str("}\n");
        for publication in &self.publications {
            text.push_str(&format!("\n{}", publication.to_bibtex()));
        }
        text
    }
}

/// Text in which TeX finds nothing to obey.
fn tex(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            // A brace that stands alone would end the field.
            '{' => escaped.push_str("\\textbraceleft{}"),
            '}' => escaped.push_str("\\textbraceright{}"),
            '%' | '&' | '#' | '$' | '_' => escaped.extend(['\\', letter]),
            plain => escaped.push(plain),
        }
    }
    // Two hyphens would become a dash.
    escaped.replace("--", "-{}-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn braces_balance_whatever_is_cited() {
        let escaped = tex("a_b {100 %} \\x ~^ $&# --set");
        let count = |letter| escaped.matches(letter).count();
        assert_eq!(count('{'), count('}'));
        assert!(escaped.starts_with("a\\_b \\textbraceleft{}100 \\%\\textbraceright{} \\textbackslash{}x"));
        assert!(escaped.ends_with(" -{}-set"));
    }
}
