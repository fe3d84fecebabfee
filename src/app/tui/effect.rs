//! Effects: what an update asks to be done. They are values; only the runtime acts.

use std::path::PathBuf;
use std::sync::Arc;

use linden::forest::Forest;
use linden::recipe::Recipe;

use super::tree::TreePlace;
use crate::jobs::ExportOrder;

/// One thing to be done outside of the model.
#[derive(Debug)]
pub enum Effect {
    /// Leave, with the terminal as it was.
    Quit,
    /// Stop as Ctrl-Z does, and come back.
    Suspend,
    /// Paint everything anew.
    Redraw,
    /// Read a preset; answered by `Msg::Loaded`.
    Load(TreePlace),
    /// Put text on the clipboard (OSC 52).
    Copy(String),
    /// Save a preset ([`super::shape::save::write`]); answered by `Msg::Saved`.
    Save {
        /// The folder; `None` for the user's.
        dir: Option<PathBuf>,
        /// Its id.
        id: String,
        /// Where its document was: what lies beside it comes along.
        from: TreePlace,
        /// What to save.
        recipe: Arc<Recipe>,
        /// As its document had it when it was read: what differs was changed here.
        base: Arc<Recipe>,
        /// Whether one of that id may be replaced.
        overwrite: bool,
        /// Whether a folder that is missing is made; else `Msg::NoFolder` asks.
        makes_folder: bool,
    },
    /// Save a forest ([`super::forest::save::write`]); answered by `Msg::ForestSaved`.
    SaveForest {
        /// The folder; `None` for the user's.
        dir: Option<PathBuf>,
        /// Its id.
        id: String,
        /// Where its document was.
        from: TreePlace,
        /// What to save.
        forest: Arc<Forest>,
        /// Whether one of that id may be replaced.
        overwrite: bool,
        /// Whether a folder that is missing is made; else `Msg::NoFolder` asks.
        makes_folder: bool,
    },
    /// Open text in `$EDITOR`; answered by `Msg::Edited`.
    Edit(String),
    /// Open a file in `$EDITOR`; what changes in it comes back through hot reload.
    EditFile(PathBuf),
    /// Write what was changed into a preset's file and open that in `$EDITOR`; the former is answered by `Msg::Saved`.
    WriteBack {
        /// The file.
        path: PathBuf,
        /// What it is to say.
        recipe: Arc<Recipe>,
    },
    /// Put a preset's file away ([`crate::config::presets::put_away`]); answered by `Msg::Removed`.
    Remove(PathBuf),
    /// Give a preset's file another name ([`crate::config::presets::rename`]); answered by `Msg::Renamed`.
    Rename {
        /// The file.
        path: PathBuf,
        /// Its id from then on.
        id: String,
    },
    /// Put a file back that was put away ([`crate::config::presets::put_back`]); answered by `Msg::PutBack`.
    PutBack {
        /// Where it is.
        kept: PathBuf,
        /// Where it was.
        path: PathBuf,
    },
    /// Export in the background; answered by `Msg::Export`.
    Export(ExportOrder),
    /// Stop the export that is under way.
    CancelExport,
    /// Put settings in force that were changed in the model.
    ApplySettings,
    /// Read the user's presets, theme, keymap and settings again; answered by `Msg::Configured`.
    Reconfigure,
}

/// What an update asks for, in order.
pub type Effects = Vec<Effect>;
