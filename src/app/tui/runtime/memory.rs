//! Keeps the session while it goes on and at its end, and restores it at the next start.
//!
//! A thread of its own writes: a disk may be slow, or hang. It is told a moment after something changed, so that
//! little is lost when the program is killed.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use glam::Vec2;

use super::Happening;
use crate::config::Complaint;
use crate::config::session::{Camera, ChangedTree, Session, SessionFile};
use crate::jobs::{PictureLook, THREAD_PREFIX};
use crate::tui::forest::ForestOnScreen;
use crate::tui::layout::Pane;
use crate::tui::model::{Config, Model};
use crate::tui::tree::{Changes, Tree, TreePlace};
use crate::tui::update::Msg;

/// How long after a change the session is written: all that is changed meanwhile is written at once.
const DELAY: Duration = Duration::from_secs(2);
/// How long the end waits for the disk.
const PATIENCE: Duration = Duration::from_secs(3);
/// Within this a second key leaves for good.
const LEAVING: Duration = Duration::from_secs(8);

/// What is known of the session's file, and the thread that writes it.
pub struct Memory {
    orders: Sender<Order>,
    /// What was remembered and is handed on as it was: what this session has no say in.
    rest: Session,
    is_on: bool,
    /// What was handed to the thread last.
    handed: Option<Session>,
    /// What is in the file, as far as this process has to do with it.
    written: Session,
    /// When to write.
    due: Option<Instant>,
    /// When the user asked to leave last.
    leave_asked: Option<Instant>,
    /// What was said of the file last.
    said: Option<Complaint>,
}

/// A session to be written.
struct Order {
    session: Box<Session>,
    why: Why,
}

/// What a session is written for.
enum Why {
    /// Something changed.
    Change,
    /// The user wants to leave.
    Leaving,
    /// The program ends, and waits for the answer.
    End(Sender<Option<Complaint>>),
}

/// A session was written, or why not.
pub struct Kept {
    session: Box<Session>,
    is_leaving: bool,
    complaint: Option<Complaint>,
}

/// What follows from an answer of the thread, or from the wish to leave.
pub enum Verdict {
    /// Nothing.
    Goes,
    /// The program can be left.
    Leaves,
    /// This has to be said.
    Says(String),
}

impl Memory {
    /// Reads what was kept. Where `wanted` is false nothing of it is used that says what is on screen; when the
    /// settings say so, nothing at all.
    ///
    /// # Errors
    /// When the system refuses a thread.
    pub fn load(
        config: &Config,
        wanted: bool,
        sender: &Sender<Happening>,
    ) -> std::io::Result<(Self, Session, Vec<String>)> {
        let path = config.dirs.session().filter(|_| config.settings.restore);
        let is_on = path.is_some();
        let (file, session, complaints) = SessionFile::load(path);
        let used = if wanted {
            session.clone()
        } else {
            Session {
                export: session.export.clone(),
                favourites: session.favourites.clone(),
                folded: session.folded.clone(),
                tags: session.tags.clone(),
                trees: session.trees.clone(),
                ..Session::default()
            }
        };
        let (orders, received) = channel();
        let sender = sender.clone();
        let thread = std::thread::Builder::new().name(format!("{THREAD_PREFIX}session"));
        thread.spawn(move || follow(file, &received, &sender))?;
        let memory = Self {
            orders,
            rest: session.clone(),
            is_on,
            handed: None,
            written: session,
            due: None,
            leave_asked: None,
            said: None,
        };
        Ok((memory, used, complaints.iter().map(ToString::to_string).collect()))
    }

    /// Something may have changed.
    pub fn touch(&mut self, now: Instant) {
        if self.is_on {
            self.due.get_or_insert(now + DELAY);
        }
    }

    /// When to write.
    pub fn wake_at(&self) -> Option<Instant> {
        self.due
    }

    /// Has the session written when it is time to, and it says something new.
    pub fn tick(&mut self, model: &Model, now: Instant) {
        if self.due.is_some_and(|due| due <= now) {
            self.due = None;
            let session = remembered(model, &self.rest);
            if self.handed.as_ref() != Some(&session) {
                self.hand_over(session, Why::Change);
            }
        }
    }

    /// The user wants to leave: the session is written first, and [`heard`](Self::heard) says whether that went well.
    /// Who asks again a moment later has it at once.
    pub fn leave(&mut self, model: &Model, now: Instant) -> Verdict {
        let asked = self.leave_asked.replace(now);
        let is_again = asked.is_some_and(|at| now.saturating_duration_since(at) < LEAVING);
        if !self.is_on || is_again || !self.hand_over(remembered(model, &self.rest), Why::Leaving) {
            return Verdict::Leaves;
        }
        Verdict::Goes
    }

    /// The thread wrote a session, or could not.
    pub fn heard(&mut self, model: &Model, kept: Kept) -> Verdict {
        let Kept { session, is_leaving, complaint } = kept;
        let Some(complaint) = complaint else {
            self.written = *session;
            self.said = None;
            return if is_leaving { Verdict::Leaves } else { Verdict::Goes };
        };
        // The next change tries again.
        self.handed = None;
        if is_leaving {
            let lost = self.lost(model);
            if lost.is_empty() {
                return Verdict::Leaves;
            }
            // What to do first: the footer may have no room for more.
            let why = format!("once more leaves without {lost}: {complaint}");
            self.said = Some(complaint);
            return Verdict::Says(why);
        }
        if self.said.replace(complaint.clone()).as_ref() == Some(&complaint) {
            return Verdict::Goes;
        }
        Verdict::Says(complaint.to_string())
    }

    /// What somebody made that is in no file.
    fn lost(&self, model: &Model) -> String {
        let now = remembered(model, &self.rest);
        let trees = now.trees.iter().filter(|tree| !self.written.trees.contains(tree)).count();
        let mut lost = Vec::new();
        match trees {
            0 => {}
            1 => lost.push("the changes of a tree".to_owned()),
            n => lost.push(format!("the changes of {n} trees")),
        }
        if now.favourites != self.written.favourites {
            lost.push("favourites".to_owned());
        }
        if now.tags != self.written.tags {
            lost.push("tags".to_owned());
        }
        lost.join(", ")
    }

    /// Keeps what is on screen at the end; a complaint when that cannot be.
    pub fn finish(&mut self, model: &Model) -> Option<String> {
        if !self.is_on {
            return None;
        }
        let (answer, answered) = channel();
        if !self.hand_over(remembered(model, &self.rest), Why::End(answer)) {
            return None;
        }
        match answered.recv_timeout(PATIENCE) {
            Ok(complaint) => complaint.map(|complaint| complaint.to_string()),
            Err(_) => Some("the disk takes too long; the session is not kept".to_owned()),
        }
    }

    fn hand_over(&mut self, session: Session, why: Why) -> bool {
        self.handed = Some(session.clone());
        // The thread is there until this is dropped.
        self.orders.send(Order { session: Box::new(session), why }).is_ok()
    }
}

/// Writes what is handed over, in turn.
fn follow(mut file: SessionFile, orders: &Receiver<Order>, sender: &Sender<Happening>) {
    for Order { session, why } in orders {
        let complaint = file.save(&session).err();
        let is_leaving = matches!(why, Why::Leaving);
        match why {
            Why::End(answer) => drop(answer.send(complaint)),
            // The loop is deaf only when the program ends.
            Why::Change | Why::Leaving => {
                drop(sender.send(Happening::Kept(Kept { session, is_leaving, complaint })));
            }
        }
    }
}

/// Whether a message may change what is kept: what the user does, and what comes of documents.
pub fn is_kept(msg: &Msg) -> bool {
    matches!(
        msg,
        Msg::Input(_)
            | Msg::Loaded(..)
            | Msg::Gone(..)
            | Msg::Saved(_)
            | Msg::ForestSaved(_)
            | Msg::Removed(_)
            | Msg::Renamed(_)
            | Msg::PutBack(_)
            | Msg::Edited(_)
    )
}

/// Puts back how things were looked at. The tree itself is loaded as any other.
pub fn restore(model: &mut Model, session: &Session) {
    if let Some(look) = PictureLook::named(&session.look) {
        (model.picture.look, model.picture.is_look_chosen) = (look, true);
    }
    if let Some(pane) = Pane::ALL.into_iter().find(|pane| pane.title().to_lowercase() == session.focus) {
        model.focus_on(pane);
    }
    if session.source.is_some() {
        let Camera { yaw_deg, pitch_deg, zoom, pan: [right, up] } = session.camera;
        model.picture.restore(
            yaw_deg as f32,
            pitch_deg as f32,
            zoom as f32,
            Vec2::new(right as f32, up as f32),
        );
    }
    model.library.favourites = session.favourites.iter().cloned().collect();
    model.library.folded = session.folded.iter().cloned().collect();
    model.library.tags = session.tags.clone();
    model.library.filter_by(&session.filter);
    model.exporting.remember(session);
    for ChangedTree { source, grammar, knobs } in session.trees.clone() {
        model.library.expect(unread_place(&source), Changes { knobs, whole: grammar });
    }
}

/// Where a changed tree's document is, without a look at the disk: sessions have ids of what is built in, and whole
/// paths.
fn unread_place(source: &str) -> TreePlace {
    builtin_place(source).unwrap_or_else(|| TreePlace::File(PathBuf::from(source)))
}

/// What is on screen, as the file has it.
fn remembered(model: &Model, rest: &Session) -> Session {
    let camera = &model.picture.camera;
    let mut session = Session {
        look: if model.picture.is_look_chosen {
            model.picture.look.name().to_owned()
        } else {
            "usual".to_owned()
        },
        focus: model.focus.title().to_lowercase(),
        filter: model.library.filter.clone(),
        favourites: model.library.favourites.iter().cloned().collect(),
        folded: model.library.folded.iter().cloned().collect(),
        tags: model.library.tags.clone(),
        camera: Camera {
            yaw_deg: camera.yaw_deg.into(),
            pitch_deg: camera.pitch_deg.into(),
            zoom: camera.zoom.into(),
            pan: [camera.pan.x.into(), camera.pan.y.into()],
        },
        export: model.exporting.to_session(),
        source: match model.place() {
            Some(place) => source_of(place),
            // What could not be read this time may be there the next time.
            None => rest.source.clone(),
        },
        trees: Vec::new(),
        ..rest.clone()
    };
    let library = &model.library;
    let unread = library.unread.iter().filter_map(|(place, changes)| {
        let Changes { knobs, whole } = changes.clone();
        Some(ChangedTree { source: source_of(place)?, grammar: whole, knobs })
    });
    let forests = library.forests.iter().chain(&model.forest).filter_map(changed_forest);
    let trees = library.shelf.iter().chain(&model.tree).filter_map(changed_tree);
    session.trees = unread.chain(forests).chain(trees).collect();
    session
}

/// How a tree differs from its document; `None` where it does not.
fn changed_tree(tree: &Tree) -> Option<ChangedTree> {
    let source = source_of(&tree.place).filter(|_| tree.is_modified())?;
    Some(match tree.overrides() {
        Some(knobs) => ChangedTree { source, grammar: None, knobs: owned(knobs) },
        // What knobs cannot say: the whole preset.
        None => ChangedTree { source, grammar: Some(tree.recipe().to_line()), knobs: Vec::new() },
    })
}

/// The same of a forest.
fn changed_forest(forest: &ForestOnScreen) -> Option<ChangedTree> {
    let source = source_of(&forest.place).filter(|_| forest.is_modified())?;
    Some(ChangedTree { source, grammar: None, knobs: owned(forest.overrides()) })
}

fn owned(knobs: Vec<(&'static str, String)>) -> Vec<(String, String)> {
    knobs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// What a place is called in a session; `None` for a path that is not Unicode.
fn source_of(place: &TreePlace) -> Option<String> {
    match place {
        TreePlace::Builtin(id) => Some((*id).to_owned()),
        TreePlace::File(path) => std::path::absolute(path).ok()?.to_str().map(str::to_owned),
    }
}

/// Where a source is that was remembered, or named on the command line.
pub fn place(source: &str) -> TreePlace {
    if let Some(place) = builtin_place(source) {
        return place;
    }
    // Which of several is meant is asked where the source is read.
    let users = crate::source::user_preset(Path::new(source)).ok().flatten();
    TreePlace::File(users.unwrap_or_else(|| PathBuf::from(source)))
}

fn builtin_place(source: &str) -> Option<TreePlace> {
    let preset = linden::preset::builtin(source).ok().map(|builtin| builtin.id);
    let forest = || linden::forest::builtin_forest(source).ok().map(|builtin| builtin.id);
    preset.or_else(forest).map(TreePlace::Builtin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::testing::Bench;

    const MISSING: &str = "/nowhere/share/tree.toml";

    fn turned(source: &str, seed: &str) -> ChangedTree {
        let knobs = vec![("seed".to_owned(), seed.to_owned())];
        ChangedTree { source: source.to_owned(), grammar: None, knobs }
    }

    fn again(session: &Session) -> Bench {
        let mut bench = Bench::new(120, 40).without_pictures();
        restore(&mut bench.model, session);
        bench
    }

    fn shown(bench: &mut Bench, id: &'static str) {
        bench.model.library.select_place(&TreePlace::Builtin(id));
        let mut effects = Vec::new();
        crate::tui::library::show_selected(&mut bench.model, &mut effects);
        bench.effects.extend(effects);
        bench.load();
    }

    #[test]
    fn all_changed_trees_come_back_not_only_the_one_on_screen() {
        let mut first = Bench::new(120, 40).without_pictures();
        for id in ["fir", "orchard", "abop-a", "sphere"] {
            shown(&mut first, id);
            first.keys("n");
            if id == "abop-a" {
                let tree = first.model.tree.as_mut().unwrap();
                tree.set("derivations", "2", Instant::now()).unwrap();
            }
        }
        first.model.tree.as_mut().unwrap().undo();
        let session = remembered(&first.model, &Session::default());
        let sources: Vec<_> = session.trees.iter().map(|tree| tree.source.as_str()).collect();
        assert_eq!(sources, ["orchard", "fir", "abop-a"], "the sphere is as saved");
        // Nothing of it is lost before it is looked at.
        let mut second = again(&session);
        assert_eq!(remembered(&second.model, &session), session);
        shown(&mut second, "fir");
        let tree = second.model.tree.as_ref().unwrap();
        assert_eq!((tree.preset().seed(), tree.saved().preset.seed()), (2, 1));
        shown(&mut second, "orchard");
        assert!(second.model.forest.as_ref().unwrap().is_modified());
        shown(&mut second, "fir");
        second.keys("R");
        let left = remembered(&second.model, &session).trees;
        assert!(left.iter().all(|tree| tree.source != "fir") && left.len() == 2, "{left:?}");
    }

    #[test]
    fn a_source_that_cannot_be_read_is_kept_as_it_was() {
        let session = Session {
            source: Some(MISSING.to_owned()),
            trees: vec![turned(MISSING, "3")],
            ..Session::default()
        };
        let mut bench = again(&session);
        let place = unread_place(MISSING);
        assert!(bench.model.library.select_place(&place), "it is listed");
        bench.model.loading = Some(place.clone());
        bench.msg(Msg::Loaded(place, Err("there is no such file".to_owned())));
        let entry = bench.model.library.entry().unwrap();
        assert!(entry.fault.as_ref().is_some_and(|fault| fault.contains("is kept")), "{:?}", entry.fault);
        let kept = remembered(&bench.model, &session);
        assert_eq!((kept.source, kept.trees), (session.source.clone(), session.trees.clone()));
        // Another one is opened meanwhile.
        shown(&mut bench, "fir");
        let kept = remembered(&bench.model, &session);
        assert_eq!((kept.source.as_deref(), kept.trees), (Some("fir"), session.trees));
    }

    #[test]
    fn who_would_lose_something_is_asked_before_leaving() {
        let mut bench = Bench::new(80, 24).without_pictures();
        bench.model.config.dirs.state = Some("/dev/null/linden".into());
        let (sender, happenings) = channel();
        let now = Instant::now();
        let (mut memory, ..) = Memory::load(&bench.model.config, true, &sender).unwrap();
        let kept = || match happenings.recv() {
            Ok(Happening::Kept(kept)) => kept,
            _ => panic!("not what the thread says"),
        };
        shown(&mut bench, "fir");
        // Nothing was made yet.
        assert!(matches!(memory.leave(&bench.model, now), Verdict::Goes));
        assert!(matches!(memory.heard(&bench.model, kept()), Verdict::Leaves));
        bench.keys("n");
        let later = now + 2 * LEAVING;
        assert!(matches!(memory.leave(&bench.model, later), Verdict::Goes));
        let Verdict::Says(why) = memory.heard(&bench.model, kept()) else { panic!("it leaves") };
        assert!(why.starts_with("once more leaves without the changes of a tree: "), "{why}");
        assert!(matches!(memory.leave(&bench.model, later + LEAVING / 2), Verdict::Leaves));
        assert!(memory.finish(&bench.model).is_some_and(|complaint| complaint.contains("not kept")));
    }

    #[test]
    fn what_changed_is_written_a_moment_later_and_once() {
        let dir = tempfile::tempdir().unwrap();
        let mut bench = Bench::new(80, 24).without_pictures();
        bench.model.config.dirs.state = Some(dir.path().to_owned());
        let (sender, happenings) = channel();
        let start = Instant::now();
        let (mut memory, ..) = Memory::load(&bench.model.config, true, &sender).unwrap();
        shown(&mut bench, "fir");
        bench.keys("n");
        memory.touch(start);
        memory.touch(start + DELAY / 2);
        assert_eq!(memory.wake_at(), Some(start + DELAY));
        memory.tick(&bench.model, start + DELAY);
        let Ok(Happening::Kept(kept)) = happenings.recv() else { panic!("not written") };
        assert!(kept.complaint.is_none() && memory.wake_at().is_none());
        let path = bench.model.config.dirs.session();
        assert_eq!(SessionFile::load(path).1.trees, [turned("fir", "2")]);
        memory.touch(start + 2 * DELAY);
        memory.tick(&bench.model, start + 3 * DELAY);
        assert!(happenings.try_recv().is_err(), "nothing is new");
    }
}
