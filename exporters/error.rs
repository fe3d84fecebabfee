//! What can go wrong, in words that say what to do next.

use std::io;
use std::path::PathBuf;

use linden_pipeline::Cancelled;
use linden_pipeline::knob::{did_you_mean, printable};
use linden_pipeline::memory::OverMemory;

/// Why an export failed. Nothing is left behind then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The result was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Writing would take more memory than there may be.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// No format has this id.
    #[error(
        "no export format is called '{}'{}{}; there are: {}",
        printable(typed),
        did_you_mean(*nearest),
        foreign(typed),
        known.join(", ")
    )]
    UnknownFormat {
        /// What was asked for.
        typed: String,
        /// The id that was probably meant.
        nearest: Option<&'static str>,
        /// All ids.
        known: Vec<&'static str>,
    },
    /// No program that files are for has this id.
    #[error(
        "no program is called '{}'{}; there are: {}",
        printable(typed),
        did_you_mean(*nearest),
        known.join(", ")
    )]
    UnknownProfile {
        /// What was asked for.
        typed: String,
        /// The id that was probably meant.
        nearest: Option<&'static str>,
        /// All ids.
        known: Vec<&'static str>,
    },
    /// No format claims this ending.
    #[error(
        "cannot tell the format of {} from its name: {}{}{}; known endings: .{}; or name the format",
        printable(&path.to_string_lossy()),
        path.extension().map_or_else(
            || "it has no ending".to_owned(),
            |e| format!("the ending '.{}' is unknown", printable(&e.to_string_lossy()))
        ),
        did_you_mean(nearest.map(|ending| format!(".{ending}")).as_deref()),
        path.extension().map(|ending| foreign(&ending.to_string_lossy())).unwrap_or_default(),
        known.join(", .")
    )]
    UnknownExtension {
        /// The file that was asked for.
        path: PathBuf,
        /// The ending that was probably meant, without the dot.
        nearest: Option<&'static str>,
        /// All endings, without the dot.
        known: Vec<&'static str>,
    },
    /// The format has no such option.
    #[error(
        "format {format} has no option '{}'{}; {}",
        printable(typed),
        did_you_mean(*nearest),
        if known.is_empty() { "it has none at all".to_owned() } else { format!("it has: {}", known.join(", ")) }
    )]
    UnknownOption {
        /// The format's id.
        format: &'static str,
        /// What was asked for.
        typed: String,
        /// The option that was probably meant.
        nearest: Option<&'static str>,
        /// All options of the format.
        known: Vec<&'static str>,
    },
    /// The option does not take this value.
    #[error("option {option} of format {format}: {problem}")]
    OptionValue {
        /// The format's id.
        format: &'static str,
        /// The option's name.
        option: &'static str,
        /// What was expected instead.
        problem: String,
    },
    /// The target cannot be a file.
    #[error("cannot write {}: {problem}", printable(&path.to_string_lossy()))]
    Target {
        /// The target as it was given.
        path: PathBuf,
        /// What is in the way, and what to do.
        problem: String,
    },
    /// The target's folder is not there. [`make_folders`](crate::make_folders) makes it.
    #[error(
        "cannot write {}: the directory {} does not exist; create it first (mkdir -p)",
        printable(&path.to_string_lossy()),
        printable(&folder.to_string_lossy())
    )]
    NoFolder {
        /// The target as it was given.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// Two outputs would be the same file.
    #[error(
        "two outputs are the same file, {}: give each its own name",
        printable(&path.to_string_lossy())
    )]
    SameTarget {
        /// The file in question.
        path: PathBuf,
    },
    /// A file beside the main one would replace one that a file of another export refers to.
    #[error(
        "cannot replace {}: {other} refers to it and would look different; write both in one export, choose \
         another name, or remove {other} first",
        printable(&path.to_string_lossy()),
        other = printable(&by.to_string_lossy())
    )]
    Referred {
        /// The file beside the main one.
        path: PathBuf,
        /// The file that refers to it.
        by: PathBuf,
    },
    /// The operating system refused.
    #[error("{doing} {what} failed: {source}{}", advice(source))]
    Io {
        /// `writing`, …
        doing: &'static str,
        /// The file as shown to people, or `standard output`.
        what: String,
        /// What the operating system said.
        source: io::Error,
    },
    /// The scene breaks a promise of its types, so that any file of it would be broken too.
    #[error("cannot export {what}: {problem}; this is a fault in the tree's surface, not in the file")]
    Scene {
        /// `part 'wood'`, `material 'bark'`, …
        what: String,
        /// What is wrong there.
        problem: String,
    },
    /// The format cannot hold what is on the stage.
    #[error("{format} cannot hold {what}: {advice}")]
    Holds {
        /// The format's id.
        format: &'static str,
        /// `several trees`, …
        what: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// A plug-in failed.
    #[error("the plug-in {program} failed: {problem}{}{}", if said.is_empty() { "" } else { "; it said:\n  " }, said)]
    Plugin {
        /// The program's name.
        program: &'static str,
        /// What went wrong.
        problem: String,
        /// The end of what it said, printable, over several lines.
        said: String,
    },
    /// The format cannot hold so much.
    #[error("{format} cannot hold {amount}: its limit is {limit}; {advice}")]
    TooLarge {
        /// The format's id.
        format: &'static str,
        /// How much there is.
        amount: String,
        /// How much there may be.
        limit: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// A layer has what its binary form has no words for here: a fault of linden's.
    #[error(
        "cannot write USD as binary: linden has no words for '{}'; write .usda instead, and please report this",
        printable(statement)
    )]
    Statement {
        /// As text has it.
        statement: String,
    },
}

/// Formats of the field that linden does not write, and what the programs that read them take instead.
const FOREIGN: [(&[&str], &str); 6] = [
    (&["fbx", "dae", "3ds"], "Blender, Unity, Unreal Engine, Maya and Houdini read glb or usda as well"),
    (&["blend"], "Blender reads glb and usda; the program linden-export-blend writes .blend files"),
    (
        &["png", "jpg", "jpeg", "webp", "svg", "gif"],
        "'linden preview' draws pictures: PNG, JPEG, WebP, and SVG of flat plants; 'linden sheet' several trees on one",
    ),
    (&["abc"], "what reads Alembic reads usda as well"),
    (&["amf"], "slicers read 3mf, stl, obj and ply; --set junction=watertight makes it one closed solid"),
    (&["las", "laz", "e57", "pcd"], "ply-skeleton and qsm hold what is measured of a scan"),
];

/// What to write instead of a format that is known elsewhere, with a separator before it.
fn foreign(typed: &str) -> String {
    let typed = typed.to_lowercase();
    let found = FOREIGN.iter().find(|(endings, _)| endings.contains(&typed.as_str()));
    found.map(|(_, instead)| format!(" ({instead})")).unwrap_or_default()
}

/// What to do about an error of the operating system, with a separator before it.
pub(crate) fn advice(error: &io::Error) -> &'static str {
    use io::ErrorKind::{
        BrokenPipe, FileTooLarge, InvalidFilename, NotFound, PermissionDenied, QuotaExceeded,
        ReadOnlyFilesystem, StorageFull,
    };
    match error.kind() {
        StorageFull => "; free some space there or write to another disk",
        QuotaExceeded => "; free some of your quota there or write to another disk",
        ReadOnlyFilesystem => "; that file system is read-only: write somewhere else",
        PermissionDenied => crate::system::DENIED,
        FileTooLarge => "; the file system or a limit (ulimit -f) allows no file of that size",
        NotFound => "; the directory is gone: create it again",
        InvalidFilename => "; the file system does not take that name: choose a shorter or plainer one",
        BrokenPipe => "; the program that was reading has stopped",
        _ => "",
    }
}
