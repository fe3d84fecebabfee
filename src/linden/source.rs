//! Where trees come from: built-in presets, files, grammars in code.

use std::fs;
use std::path::Path;
use std::str;

use linden_pipeline::Quiet;
use linden_pipeline::document::Fault;
use linden_pipeline::input::{Input, InputKind, sniff};
use linden_pipeline::lsystem::{Grammar, text};
use linden_pipeline::preset::{Colonization, LSystem, Preset, ScanSettings, Space, builtin};
use linden_pipeline::recipe::Recipe;

use crate::{Error, Tree};

/// A built-in preset: `oak`, `abop-a`.
///
/// # Errors
/// [`Error::Unknown`], with the nearest id.
pub fn tree(id: &str) -> Result<Tree, Error> {
    Ok(Tree::of(builtin(id)?.recipe(&Quiet)?))
}

/// A tree from a file, told by its content: a preset (TOML), a recipe (JSON, as every file of linden's carries
/// it), a grammar, a mesh that a crown fills (OBJ, PLY), or points (PLY, XYZ). Files that a preset or recipe
/// names are looked for beside it.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// # let file = folder.path().join("weed.l");
/// std::fs::write(&file, "axiom=F\nangle=25.7\nnumber of derivations=5\nF=(1)F[+F]F[-F]F\n")?;
/// let weed = linden::read(&file)?.set("derivations", "3")?.grow()?;
/// assert_eq!(weed.skeleton().segments(), 125);
/// # Ok::<(), linden::Error>(())
/// ```
///
/// # Errors
/// A file that cannot be read, or is nothing that a tree grows from.
pub fn read(path: impl AsRef<Path>) -> Result<Tree, Error> {
    let path = path.as_ref();
    let bytes = load(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let id =
        Path::new(&name).file_stem().map_or_else(|| "tree".to_owned(), |stem| stem.to_string_lossy().into());
    let input = |error| Error::Input { path: path.to_owned(), error };
    let document = |fault| Error::Document { path: path.to_owned(), fault };
    let text = || {
        let not_utf8 = |_| Fault::new(None, "this is no UTF-8 text; save the file as UTF-8");
        str::from_utf8(&bytes).map_err(not_utf8).map_err(document)
    };
    let preset = match sniff(&bytes, &name).map_err(input)? {
        InputKind::Preset => return beside(path, Preset::from_toml(text()?).map_err(document)?),
        InputKind::Recipe => return beside(path, Preset::from_json(text()?).map_err(document)?),
        InputKind::Grammar => {
            let found = text::parse(text()?).map_err(|error| {
                let place = linden_pipeline::document::Place { line: error.line, column: error.column };
                document(Fault::new(Some(place), error.problem.to_string()))
            })?;
            Preset::of_grammar(&id, found.grammar, found.angle_deg, found.derivations)
        }
        InputKind::ObjMesh | InputKind::PlyMesh => {
            Preset::of(&id, Colonization::of(Space::Envelope { file: name.clone() }))
        }
        InputKind::PlyPoints | InputKind::XyzPoints => Preset::of(&id, ScanSettings::of(name.clone())),
    };
    let mut recipe = Recipe::new(preset);
    if recipe.preset.files().contains(&name.as_str()) {
        recipe.inputs.insert(name.clone(), Input::read(&name, &bytes, &Quiet).map_err(input)?);
    }
    Ok(Tree::of(recipe))
}

/// A tree from a grammar: an axiom and rules.
///
/// ```
/// let weed = linden::grammar("F", &["F -> F[+F]F[-F]F"])?.set("derivations", "5")?.grow()?;
/// assert_eq!(weed.skeleton().segments(), 3125); // ABOP, Fig. 1.24 a
/// # Ok::<(), linden::Error>(())
/// ```
///
/// # Errors
/// [`Error::Grammar`], with the place.
pub fn grammar<R: AsRef<str>>(axiom: &str, rules: &[R]) -> Result<Tree, Error> {
    Ok(Tree::of(Recipe::new(Preset::of("grammar", LSystem::of(Grammar::new(axiom, rules)?)))))
}

/// A preset with the files that stand beside its document.
fn beside(path: &Path, preset: Preset) -> Result<Tree, Error> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut recipe = Recipe::new(preset);
    for file in recipe.preset.files().into_iter().map(str::to_owned).collect::<Vec<_>>() {
        let path = folder.join(&file);
        let bytes = load(&path)?;
        let input = Input::read(&file, &bytes, &Quiet).map_err(|error| Error::Input { path, error })?;
        recipe.inputs.insert(file, input);
    }
    Ok(Tree::of(recipe))
}

fn load(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|error| Error::Read { path: path.to_owned(), error })
}
