//! Exports: the one under way, those that wait, those that are done.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use linden::monitor::Phase;

use crate::config::session::{self, Session};
use crate::jobs::ExportOrder;
use crate::tui::tree::TreePlace;

/// Within this a second key leaves for good.
const LEAVING: Duration = Duration::from_secs(8);

/// The export under way, those that wait, those that are done, and what was chosen last.
#[derive(Debug, Default)]
pub struct Exporting {
    /// What was chosen last.
    pub last: session::ExportChoices,
    /// What is set in the dialog for what was exported last, or left it with Esc.
    pub kept: Option<KeptExport>,
    /// Where the files of what is on screen went last.
    pub named: Option<NamedFiles>,
    /// The one under way.
    pub running: Option<RunningExport>,
    /// Those that wait, the next one first.
    pub waiting: VecDeque<ExportOrder>,
    /// Those that are done, the newest first.
    pub reports: VecDeque<ExportReport>,
    /// Numbers that were given to orders.
    pub numbers: u64,
    leave_asked: Option<Instant>,
}

/// What was set in the dialog.
#[derive(Clone, Debug)]
pub struct KeptExport {
    /// What was on screen.
    pub place: TreePlace,
    /// Formats, options, and where they go.
    pub choices: session::ExportChoices,
    /// Knobs that were turned for this export.
    pub knobs: Vec<(&'static str, String)>,
    /// The ages that it is written at, as they were typed: names of ages are a plant's own, no other has them.
    pub ages: String,
}

/// Where the files of a tree or a forest went, for as long as it is open.
#[derive(Clone, Debug)]
pub struct NamedFiles {
    /// What was on screen.
    pub place: TreePlace,
    /// Where the file of each format went, as it was typed.
    pub targets: Vec<(&'static str, String)>,
}

/// The export under way.
#[derive(Debug)]
pub struct RunningExport {
    /// Its order's.
    pub number: u64,
    /// `fir.glb +2`.
    pub name: String,
    /// What is being done.
    pub doing: Option<Phase>,
    /// In parts of [`WHOLE`](crate::jobs::WHOLE).
    pub done: u64,
}

/// An export that is done.
#[derive(Debug)]
pub struct ExportReport {
    /// What was written, and how many bytes each has.
    pub files: Vec<(PathBuf, u64)>,
    /// `19 964 / 6 700 triangles`, where it is of a tree.
    pub triangles: Option<String>,
    /// What a format could not hold.
    pub notes: Vec<String>,
}

impl Exporting {
    /// Takes over what was chosen last time.
    pub fn remember(&mut self, session: &Session) {
        self.last = session.export.clone();
    }

    /// What was chosen last, for next time.
    pub fn to_session(&self) -> session::ExportChoices {
        self.last.clone()
    }

    /// What is set in the dialog for what comes from a place.
    pub fn kept_of(&self, place: Option<&TreePlace>) -> Option<&KeptExport> {
        self.kept.as_ref().filter(|kept| Some(&kept.place) == place)
    }

    /// What comes from `from` was saved as `to`: what was set for its export goes along.
    pub fn moved(&mut self, from: Option<&TreePlace>, to: &TreePlace) {
        let kept = self.kept.iter_mut().map(|kept| &mut kept.place);
        let named = self.named.iter_mut().map(|named| &mut named.place);
        for place in kept.chain(named).filter(|place| Some(&**place) == from) {
            *place = to.clone();
        }
    }

    /// Whether an export is under way.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Whether the workbench can be left without a question: no export runs, or the user was asked a
    /// moment ago. Otherwise this counts as asking.
    pub fn may_leave(&mut self, now: Instant) -> bool {
        if !self.is_running() {
            return true;
        }
        let asked = self.leave_asked.replace(now);
        asked.is_some_and(|at| now.saturating_duration_since(at) < LEAVING)
    }
}
