//! The session, restored at the next start: `session.toml` in the state directory.
//!
//! It is written whole or not at all, and only when it says something new. Two processes keep what each of them
//! changed: before a file is written it is read again, and marks, tags and changed trees of the other one stay; of
//! what is on screen the last to write has the word. A file that is not of this version is kept beside the new one.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use linden::preset::TextPlace;
use serde::{Deserialize, Serialize};

use super::files::{self, Existing, Readers};
use super::{Complaint, dirs};

/// Raised whenever an older linden would misread what a newer one writes. A key that it does not know it
/// leaves out.
const VERSION: u32 = 1;

/// A grammar of that size is not edited in a terminal.
const MAX_BYTES: u64 = 16 << 20;
/// Changed trees that are kept: the newest.
const MOST_TREES: usize = 100;
/// What they take together, at most.
const MOST_TREE_BYTES: usize = 8 << 20;
/// How often another process is waited for that writes, and how long each time.
const TURNS: (u32, Duration) = (20, Duration::from_millis(10));

/// What was there last time. All of it is from outside: names may be gone, and texts are shown
/// through `printable`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Session {
    /// SOURCE: a preset's id, or an absolute path; `None` before anything was chosen, and for a path
    /// that is not Unicode.
    pub source: Option<String>,
    /// How the tree is drawn: skeleton, surface, …
    pub look: String,
    /// The pane that had the focus.
    pub focus: String,
    /// What the list was filtered by.
    pub filter: String,
    /// Marked presets: ids of built-in ones, paths of files.
    pub favourites: Vec<String>,
    /// Groups of the list whose presets are hidden.
    pub folded: Vec<String>,
    /// Hints that need not be given again.
    pub hints_seen: Vec<String>,
    /// Tags that the user gave, by what favourites are remembered by; the documents' are not among them.
    pub tags: BTreeMap<String, Vec<String>>,
    /// From where the tree was looked at.
    pub camera: Camera,
    /// What was exported last.
    pub export: ExportChoices,
    /// Trees and forests that differ from their documents, those changed last at the end.
    pub trees: Vec<ChangedTree>,
}

/// How a tree, or a forest, differs from its document.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChangedTree {
    /// SOURCE: a preset's id, or an absolute path.
    pub source: String,
    /// The whole recipe, where knobs cannot say it: its grammar was edited.
    pub grammar: Option<String>,
    /// Knobs that were turned, as `--set` takes them: name and value.
    pub knobs: Vec<(String, String)>,
}

/// Where sessions had the changes of the tree on screen before they had those of all trees.
#[derive(Deserialize, Default)]
#[serde(default)]
struct FormerChanges {
    grammar: Option<String>,
    knobs: Vec<(String, String)>,
}

/// From where the tree was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Camera {
    /// Around the vertical, degrees.
    pub yaw_deg: f64,
    /// Above the horizon, degrees, -90 to 90.
    pub pitch_deg: f64,
    /// 1 shows the whole tree, 2 half of it; above 0.
    pub zoom: f64,
    /// How far the tree was moved right and up, in heights of the picture.
    pub pan: [f64; 2],
}

/// What was exported last.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExportChoices {
    /// Files that were written to.
    pub targets: Vec<String>,
    /// Ids of formats.
    pub formats: Vec<String>,
    /// Options that are not as they are by default, as `--set` takes them: FORMAT.OPTION and value.
    pub options: Vec<(String, String)>,
}

impl Default for Session {
    fn default() -> Self {
        Self {
            source: None,
            look: "usual".to_owned(),
            focus: String::new(),
            filter: String::new(),
            favourites: Vec::new(),
            folded: Vec::new(),
            hints_seen: Vec::new(),
            tags: BTreeMap::new(),
            camera: Camera::default(),
            export: ExportChoices::default(),
            trees: Vec::new(),
        }
    }
}

impl Session {
    /// This session as it is written over `theirs`, which another process may have kept since this one knew `base`:
    /// marks, tags and changed trees that this process did not touch are theirs.
    fn over(&self, base: &Self, theirs: &Self) -> Self {
        let of =
            |session: &Self, source: &str| session.trees.iter().find(|tree| tree.source == source).cloned();
        let is_ours = |tree: &&ChangedTree| of(self, &tree.source) != of(base, &tree.source);
        let not_ours = theirs.trees.iter().filter(|tree| !is_ours(tree));
        let mut tags = theirs.tags.clone();
        for key in base.tags.keys().chain(self.tags.keys()) {
            match (self.tags.get(key), base.tags.get(key)) {
                (ours, before) if ours == before => {}
                (Some(ours), _) => drop(tags.insert(key.clone(), ours.clone())),
                (None, _) => drop(tags.remove(key)),
            }
        }
        Self {
            favourites: marks_over(&self.favourites, &base.favourites, &theirs.favourites),
            folded: marks_over(&self.folded, &base.folded, &theirs.folded),
            hints_seen: marks_over(&self.hints_seen, &base.hints_seen, &theirs.hints_seen),
            tags,
            trees: not_ours.chain(self.trees.iter().filter(is_ours)).cloned().collect(),
            ..self.clone()
        }
    }

    /// Leaves out the oldest changed trees that have no room.
    fn bound(&mut self) {
        let bytes = |tree: &ChangedTree| {
            let knobs: usize = tree.knobs.iter().map(|(name, value)| name.len() + value.len()).sum();
            tree.source.len() + tree.grammar.as_ref().map_or(0, String::len) + knobs
        };
        let mut room = MOST_TREE_BYTES;
        let mut kept = 0;
        let mut trees = std::mem::take(&mut self.trees);
        trees.reverse();
        trees.retain(|tree| {
            let left = room.checked_sub(bytes(tree)).filter(|_| kept < MOST_TREES);
            (room, kept) = left.map_or((room, kept), |left| (left, kept + 1));
            left.is_some()
        });
        trees.reverse();
        self.trees = trees;
    }
}

/// A list of marks with those that another process set and took off meanwhile.
fn marks_over(ours: &[String], base: &[String], theirs: &[String]) -> Vec<String> {
    let is_taken_off = |mark: &String| base.contains(mark) && !ours.contains(mark);
    let is_new = |mark: &&String| !base.contains(mark) && !theirs.contains(mark);
    let stay = theirs.iter().filter(|mark| !is_taken_off(mark));
    stay.chain(ours.iter().filter(is_new)).cloned().collect()
}

impl Default for Camera {
    fn default() -> Self {
        Self { yaw_deg: 30.0, pitch_deg: 10.0, zoom: 1.0, pan: [0.0; 2] }
    }
}

impl Camera {
    /// Whether a picture can be drawn from there.
    fn is_sound(&self) -> bool {
        self.yaw_deg.is_finite()
            && (-90.0..=90.0).contains(&self.pitch_deg)
            && (1e-6..=1e6).contains(&self.zoom)
            && self.pan.iter().all(|shift| shift.abs() <= 1e6)
    }
}

/// The file that a session is kept in.
#[derive(Debug)]
pub struct SessionFile {
    path: Option<PathBuf>,
    /// What this process read or wrote last: what differs from it is what it changed.
    known: Option<Session>,
}

/// Only the number that every version has.
#[derive(Deserialize)]
struct Versioned {
    version: Option<u32>,
}

/// The document: the number first, then the session.
#[derive(Serialize)]
struct SessionDocument<'s> {
    version: u32,
    #[serde(flatten)]
    session: &'s Session,
}

/// What a file says, and what is wrong with it.
type Found = (Session, Vec<Complaint>);

impl SessionFile {
    /// Reads the session in a file ([`dirs::Dirs::session`]); defaults where there is none.
    pub fn load(path: Option<PathBuf>) -> (Self, Session, Vec<Complaint>) {
        let mut file = Self { path, known: None };
        let Some(path) = file.path.as_deref() else { return (file, Session::default(), Vec::new()) };
        match read(path) {
            Ok(None) => (file, Session::default(), Vec::new()),
            Ok(Some((session, complaints))) => {
                file.known = Some(session.clone());
                (file, session, complaints)
            }
            Err(complaint) => {
                let kept = aside(path);
                let kept = kept.file_name().unwrap_or_default().to_string_lossy();
                let message =
                    format!("{}; beginning anew, and keeping this file as {kept}", complaint.message);
                (file, Session::default(), vec![Complaint { message, ..complaint }])
            }
        }
    }

    /// Writes a session, with what other processes kept meanwhile, unless it is what this one read or wrote last;
    /// returns whether it wrote.
    ///
    /// # Errors
    /// Why it could not, and where to; what was there before is still there.
    pub fn save(&mut self, session: &Session) -> Result<bool, Complaint> {
        let Some(path) = self.path.as_deref() else {
            return Err(Complaint::new(Path::new("session.toml"), dirs::NO_STATE));
        };
        if self.known.as_ref() == Some(session) {
            return Ok(false);
        }
        let failed = |what: &str, error: &dyn std::fmt::Display| {
            Complaint::new(path, format!("{what}: {error}; the session is not kept"))
        };
        let _turn = turn(path);
        let mut written = match read(path) {
            Ok(Some((theirs, _))) => {
                session.over(self.known.as_ref().unwrap_or(&Session::default()), &theirs)
            }
            Ok(None) => session.clone(),
            Err(_) => {
                fs::rename(path, aside(path)).map_err(|error| failed("cannot be renamed", &error))?;
                session.clone()
            }
        };
        written.bound();
        let document = SessionDocument { version: VERSION, session: &written };
        let text = toml::to_string(&document).map_err(|error| failed("cannot be written", &error))?;
        files::write(path, text.as_bytes(), Readers::Owner, Existing::Replace)
            .map_err(|error| failed("cannot be written", &error))?;
        self.known = Some(session.clone());
        Ok(true)
    }
}

/// Keeps other processes from writing the file between reading and writing it here, as long as what is returned
/// lives. Where directories cannot be locked, or another one takes long, it is done without.
fn turn(path: &Path) -> Option<File> {
    let directory = File::open(path.parent()?).ok()?;
    let (times, pause) = TURNS;
    for _ in 0..times {
        match directory.try_lock() {
            Ok(()) => return Some(directory),
            Err(fs::TryLockError::WouldBlock) => thread::sleep(pause),
            Err(fs::TryLockError::Error(_)) => return None,
        }
    }
    None
}

/// What a file says; `None` where there is none.
fn read(path: &Path) -> Result<Option<Found>, Complaint> {
    let text = files::read_text(path, MAX_BYTES)?;
    text.map(|text| parse(path, &text)).transpose()
}

/// Where an old file is kept.
fn aside(path: &Path) -> PathBuf {
    path.with_extension("old.toml")
}

/// Reads a document of this version.
fn parse(path: &Path, text: &str) -> Result<Found, Complaint> {
    let fault = |error: &toml::de::Error| {
        let place = error.span().map(|span| TextPlace::at(text, span.start));
        Complaint::at(path, place, error.message().trim().replace('\n', ", "))
    };
    let found: Versioned = toml::from_str(text).map_err(|error| fault(&error))?;
    match found.version {
        Some(VERSION) => {}
        Some(newer) if newer > VERSION => {
            let message = format!("is of a newer linden (version {newer}; this one reads {VERSION})");
            return Err(Complaint::new(path, message));
        }
        Some(older) => {
            let message = format!("is of an older linden (version {older}; this one reads {VERSION})");
            return Err(Complaint::new(path, message));
        }
        None => return Err(Complaint::new(path, "says no version")),
    }
    let mut session: Session = toml::from_str(text).map_err(|error| fault(&error))?;
    let mut complaints = Vec::new();
    if !session.camera.is_sound() {
        complaints.push(Complaint::new(path, "[camera] stands where nothing can be seen; using its start"));
        session.camera = Camera::default();
    }
    if let (Some(source), true) = (&session.source, session.trees.is_empty()) {
        let FormerChanges { grammar, knobs } = toml::from_str(text).map_err(|error| fault(&error))?;
        if grammar.is_some() || !knobs.is_empty() {
            session.trees.push(ChangedTree { source: source.clone(), grammar, knobs });
        }
    }
    Ok((session, complaints))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session() -> Session {
        Session {
            source: Some("/home/a b/\u{fc}.toml".into()),
            look: "surface".into(),
            focus: "form".into(),
            filter: "fi\"r".into(),
            favourites: vec!["oak".into(), "/home/a b/\u{fc}.toml".into()],
            folded: vec!["crowns".into()],
            hints_seen: vec!["orbit".into(), "yank".into()],
            tags: BTreeMap::from([("oak".into(), vec!["hedge".into(), "old".into()])]),
            camera: Camera { yaw_deg: -12.5, pitch_deg: 90.0, zoom: 0.3, pan: [0.1, -2e-7] },
            export: ExportChoices {
                targets: vec!["fir.glb".into()],
                formats: vec!["gltf".into(), "usda".into()],
                options: vec![("gltf.embed".into(), "true".into())],
            },
            trees: vec![
                changed("fir", &[("points", "500"), ("kill", "3D")]),
                ChangedTree {
                    source: "/home/a b/\u{fc}.toml".into(),
                    grammar: Some("axiom=F\nangle=20\r\n\"'''\\ \u{1b}".into()),
                    knobs: Vec::new(),
                },
            ],
        }
    }

    fn changed(source: &str, knobs: &[(&str, &str)]) -> ChangedTree {
        let knobs = knobs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
        ChangedTree { source: source.to_owned(), grammar: None, knobs: knobs.collect() }
    }

    fn at(dir: &tempfile::TempDir) -> PathBuf {
        dir.path().join("state/linden/session.toml")
    }

    fn names(dir: &tempfile::TempDir) -> Vec<String> {
        let read = fs::read_dir(at(dir).parent().unwrap()).unwrap();
        let mut names: Vec<_> = read.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_is_kept_is_restored_and_written_only_when_it_changed() {
        let dir = tempfile::tempdir().unwrap();
        let (mut file, first, complaints) = SessionFile::load(Some(at(&dir)));
        assert_eq!((first, complaints), (Session::default(), vec![]));
        assert_eq!(file.save(&session()), Ok(true));
        assert_eq!(file.save(&session()), Ok(false));
        let (mut again, restored, complaints) = SessionFile::load(Some(at(&dir)));
        assert_eq!((restored, complaints), (session(), vec![]));
        assert_eq!(again.save(&session()), Ok(false));
        assert_eq!(again.save(&Session::default()), Ok(true));
        assert_eq!(names(&dir), ["session.toml"]);
    }

    #[test]
    fn other_versions_and_broken_files_are_kept_aside() {
        for (text, place, word) in [
            ("version = 2\nwhat = 1\n", None, "newer"),
            ("version = 0\n", None, "older"),
            ("source = \"fir\"\n", None, "no version"),
            ("version = 1\nsource = = 3\n", Some(2), "keeping"),
            ("version = 1\nsource = 3\n", Some(2), "keeping"),
            ("version = 1\n\n[camera]\nyaw_deg = 1.0\npan = [1.0]\n", Some(5), "keeping"),
            ("version = \"1\"\n", Some(1), "keeping"),
        ] {
            let dir = tempfile::tempdir().unwrap();
            fs::create_dir_all(at(&dir).parent().unwrap()).unwrap();
            fs::write(at(&dir), text).unwrap();
            let (mut file, read, complaints) = SessionFile::load(Some(at(&dir)));
            assert_eq!(read, Session::default(), "{text}");
            assert_eq!(complaints.len(), 1, "{text}");
            assert_eq!(complaints[0].place.map(|(line, _)| line), place, "{}", complaints[0]);
            assert!(complaints[0].message.contains(word), "{}", complaints[0]);
            // Reading changes nothing on disk.
            assert_eq!(names(&dir), ["session.toml"]);
            assert_eq!(file.save(&session()), Ok(true));
            assert_eq!(names(&dir), ["session.old.toml", "session.toml"]);
            assert_eq!(fs::read_to_string(aside(&at(&dir))).unwrap(), text);
            assert_eq!(SessionFile::load(Some(at(&dir))).1, session());
        }
    }

    #[test]
    fn keys_of_a_later_linden_are_left_out() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(at(&dir).parent().unwrap()).unwrap();
        fs::write(at(&dir), "version = 1\nfilter = \"x\"\nsounds = true\n[export]\ncloud = 1\n").unwrap();
        let (_, read, complaints) = SessionFile::load(Some(at(&dir)));
        assert_eq!((read.filter.as_str(), complaints), ("x", vec![]));
    }

    #[test]
    fn numbers_that_no_camera_takes_are_replaced() {
        for camera in ["zoom = 0.0", "yaw_deg = nan", "pan = [inf, 0.0]", "pitch_deg = 91.0"] {
            let dir = tempfile::tempdir().unwrap();
            fs::create_dir_all(at(&dir).parent().unwrap()).unwrap();
            fs::write(at(&dir), format!("version = 1\nfilter = \"x\"\n[camera]\n{camera}\n")).unwrap();
            let (_, read, complaints) = SessionFile::load(Some(at(&dir)));
            assert_eq!((read.camera, read.filter.as_str()), (Camera::default(), "x"), "{camera}");
            assert_eq!(complaints.len(), 1, "{camera}");
        }
    }

    #[test]
    fn what_two_processes_changed_is_kept_of_both() {
        let dir = tempfile::tempdir().unwrap();
        SessionFile::load(Some(at(&dir))).0.save(&session()).unwrap();
        let [(mut a, first, _), (mut b, second, _)] = [(), ()].map(|()| SessionFile::load(Some(at(&dir))));
        let mut of_a = Session { filter: "a".into(), ..first };
        of_a.favourites.push("ash".into());
        of_a.folded.clear();
        of_a.tags.insert("fir".into(), vec!["tall".into()]);
        of_a.trees[0] = changed("fir", &[("points", "600")]);
        of_a.trees.push(changed("ash", &[("seed", "2")]));
        a.save(&of_a).unwrap();
        let mut of_b = Session { filter: "b".into(), ..second };
        of_b.favourites.retain(|mark| mark != "oak");
        of_b.tags.remove("oak");
        of_b.trees.push(changed("oak", &[("seed", "3")]));
        b.save(&of_b).unwrap();
        let (_, both, _) = SessionFile::load(Some(at(&dir)));
        assert_eq!(both.favourites, ["/home/a b/\u{fc}.toml", "ash"]);
        assert!(both.folded.is_empty());
        assert_eq!(both.tags.keys().collect::<Vec<_>>(), ["fir"]);
        let trees = |session: &Session| {
            session
                .trees
                .iter()
                .map(|tree| (tree.source.clone(), tree.knobs.clone()))
                .collect::<BTreeMap<_, _>>()
        };
        let mut expected = trees(&of_a);
        expected.extend(trees(&of_b).into_iter().filter(|(source, _)| source == "oak"));
        assert_eq!(trees(&both), expected);
        assert_eq!(both.filter, "b", "what is on screen is said by the last one");
        // What the other one did is not undone by what follows here.
        of_b.filter.clear();
        b.save(&of_b).unwrap();
        assert!(SessionFile::load(Some(at(&dir))).1.favourites.contains(&"ash".to_owned()));
        // And a tree that is as saved again is kept no longer.
        of_b.trees.retain(|tree| tree.source != "oak");
        b.save(&of_b).unwrap();
        assert_eq!(trees(&SessionFile::load(Some(at(&dir))).1), trees(&of_a));
    }

    #[test]
    fn the_changes_of_an_older_session_are_those_of_its_tree() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(at(&dir).parent().unwrap()).unwrap();
        fs::write(at(&dir), "version = 1\nsource = \"ash\"\nknobs = [[\"seed\", \"2\"]]\n").unwrap();
        assert_eq!(SessionFile::load(Some(at(&dir))).1.trees, [changed("ash", &[("seed", "2")])]);
    }

    #[test]
    fn of_many_changed_trees_the_newest_are_kept() {
        let mut session = Session::default();
        let whole = |bytes| Some("x".repeat(bytes));
        session.trees.push(ChangedTree { grammar: whole(MOST_TREE_BYTES), ..changed("large", &[]) });
        session.trees.extend((0..MOST_TREES).map(|i| changed(&i.to_string(), &[("seed", "2")])));
        session.bound();
        assert_eq!((session.trees.len(), session.trees[0].source.as_str()), (MOST_TREES, "0"));
        session.trees.push(changed("new", &[]));
        session.bound();
        assert_eq!(
            (session.trees[0].source.as_str(), session.trees.last().unwrap().source.as_str()),
            ("1", "new")
        );
        session.trees.push(ChangedTree { grammar: whole(MOST_TREE_BYTES), ..changed("large", &[]) });
        session.bound();
        assert!(session.trees.iter().all(|tree| tree.source != "large"), "no room for that one");
    }

    #[test]
    fn readers_see_whole_files_while_two_processes_write() {
        let dir = tempfile::tempdir().unwrap();
        let path = at(&dir);
        let mut first = SessionFile::load(Some(path.clone())).0;
        first.save(&Session::default()).unwrap();
        std::thread::scope(|scope| {
            for look in ["axes", "radius"] {
                let path = path.clone();
                scope.spawn(move || {
                    let mut memory = SessionFile::load(Some(path)).0;
                    for round in 0..40 {
                        let filter = look.repeat(round * 50);
                        memory.save(&Session { look: look.into(), filter, ..session() }).unwrap();
                    }
                });
            }
            for _ in 0..200 {
                let (_, _, complaints) = SessionFile::load(Some(path.clone()));
                assert_eq!(complaints, []);
            }
        });
        assert_eq!(names(&dir), ["session.toml"]);
    }

    #[test]
    fn without_a_place_there_is_a_reason() {
        let (mut file, read, complaints) = SessionFile::load(None);
        assert_eq!((read, complaints), (Session::default(), vec![]));
        assert!(file.save(&session()).unwrap_err().message.contains("LINDEN_STATE_DIR"));
        let (mut file, ..) = SessionFile::load(Some("/dev/null/linden/session.toml".into()));
        assert!(file.save(&session()).unwrap_err().message.contains("not kept"));
    }
}
