//! The session, restored at the next start: `session.toml` in the state directory.
//!
//! It is written whole or not at all, and only when it says something new; of two processes the last
//! to write wins. A file that is not of this version is kept beside the new one.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use linden::preset::TextPlace;
use serde::{Deserialize, Serialize};

use super::files::{self, Existing, Readers};
use super::{Complaint, dirs};

/// Raised whenever an older linden would misread what a newer one writes. A key that it does not know it
/// leaves out.
const VERSION: u32 = 1;

/// A grammar of that size is not edited in a terminal.
const MAX_BYTES: u64 = 16 << 20;

/// What was there last time. All of it is from outside: names may be gone, and texts are shown
/// through `printable`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Session {
    /// SOURCE: a preset's id, or an absolute path; `None` before anything was chosen, and for a path
    /// that is not Unicode.
    pub source: Option<String>,
    /// The grammar's text, if it was edited.
    pub grammar: Option<String>,
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
    /// Knobs that were turned, as `--set` takes them: name and value.
    pub knobs: Vec<(String, String)>,
    /// Tags that the user gave, by what favourites are remembered by; the documents' are not among them.
    pub tags: BTreeMap<String, Vec<String>>,
    /// From where the tree was looked at.
    pub camera: Camera,
    /// What was exported last.
    pub export: ExportChoices,
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
            grammar: None,
            look: "usual".to_owned(),
            focus: String::new(),
            filter: String::new(),
            favourites: Vec::new(),
            folded: Vec::new(),
            hints_seen: Vec::new(),
            tags: BTreeMap::new(),
            knobs: Vec::new(),
            camera: Camera::default(),
            export: ExportChoices::default(),
        }
    }
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
    /// What the file says, as far as this process knows.
    text: Option<String>,
    /// Whether the file that is there must not be lost.
    keep_old: bool,
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

impl SessionFile {
    /// Reads the session in a file ([`dirs::Dirs::session`]); defaults where there is none.
    pub fn load(path: Option<PathBuf>) -> (Self, Session, Vec<Complaint>) {
        let mut file = Self { path, text: None, keep_old: false };
        let Some(path) = file.path.as_deref() else { return (file, Session::default(), Vec::new()) };
        let found = files::read_text(path, MAX_BYTES)
            .and_then(|text| text.map(|text| parse(path, &text).map(|read| (text, read))).transpose());
        match found {
            Ok(None) => (file, Session::default(), Vec::new()),
            Ok(Some((text, (session, complaints)))) => {
                file.text = Some(text);
                (file, session, complaints)
            }
            Err(complaint) => {
                let kept = aside(path);
                let kept = kept.file_name().unwrap_or_default().to_string_lossy();
                let message =
                    format!("{}; beginning anew, and keeping this file as {kept}", complaint.message);
                file.keep_old = true;
                (file, Session::default(), vec![Complaint { message, ..complaint }])
            }
        }
    }

    /// Writes a session, unless the file says the same already; returns whether it wrote.
    ///
    /// # Errors
    /// Why it could not, and where to; what was there before is still there.
    pub fn save(&mut self, session: &Session) -> Result<bool, Complaint> {
        let Some(path) = self.path.as_deref() else {
            return Err(Complaint::new(Path::new("session.toml"), dirs::NO_STATE));
        };
        let failed = |what: &str, error: &dyn std::fmt::Display| {
            Complaint::new(path, format!("{what}: {error}; the session is not kept"))
        };
        let document = SessionDocument { version: VERSION, session };
        let text = toml::to_string(&document).map_err(|error| failed("cannot be written", &error))?;
        if self.text.as_ref() == Some(&text) {
            return Ok(false);
        }
        if self.keep_old {
            fs::rename(path, aside(path)).map_err(|error| failed("cannot be renamed", &error))?;
            self.keep_old = false;
        }
        files::write(path, text.as_bytes(), Readers::Owner, Existing::Replace)
            .map_err(|error| failed("cannot be written", &error))?;
        self.text = Some(text);
        Ok(true)
    }
}

/// Where an old file is kept.
fn aside(path: &Path) -> PathBuf {
    path.with_extension("old.toml")
}

/// Reads a document of this version.
fn parse(path: &Path, text: &str) -> Result<(Session, Vec<Complaint>), Complaint> {
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
    Ok((session, complaints))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session() -> Session {
        Session {
            source: Some("/home/a b/\u{fc}.toml".into()),
            grammar: Some("axiom=F\nangle=20\r\n\"'''\\ \u{1b}".into()),
            look: "surface".into(),
            focus: "form".into(),
            filter: "fi\"r".into(),
            favourites: vec!["oak".into(), "/home/a b/\u{fc}.toml".into()],
            folded: vec!["crowns".into()],
            hints_seen: vec!["orbit".into(), "yank".into()],
            tags: BTreeMap::from([("oak".into(), vec!["hedge".into(), "old".into()])]),
            knobs: vec![("points".into(), "500".into()), ("kill".into(), "3D".into())],
            camera: Camera { yaw_deg: -12.5, pitch_deg: 90.0, zoom: 0.3, pan: [0.1, -2e-7] },
            export: ExportChoices {
                targets: vec!["fir.glb".into()],
                formats: vec!["gltf".into(), "usda".into()],
                options: vec![("gltf.embed".into(), "true".into())],
            },
        }
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
    fn of_two_processes_the_last_one_wins_and_readers_see_whole_files() {
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
