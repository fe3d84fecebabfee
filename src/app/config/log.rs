//! The log file, on request: `--log FILE` or `LINDEN_LOG=FILE`, and `LINDEN_LOG_LEVEL`.
//!
//! Without a request nothing is logged, and nothing ever goes to the terminal. Each event is one line,
//! written at once in one piece, so that a log ends with the last thing that happened and two processes
//! may share a file. Lines are printable whatever they quote.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use linden::knob::{did_you_mean, excerpt, nearest, printable};
use tracing::level_filters::LevelFilter;
use tracing::subscriber::{Subscriber, set_global_default};
use tracing_subscriber::fmt::MakeWriter;

use super::Complaint;

/// A log that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// Where to.
    pub file: PathBuf,
    /// What goes into it: this level and the graver ones.
    pub level: LevelFilter,
}

const LEVELS: [(&str, LevelFilter); 5] = [
    ("error", LevelFilter::ERROR),
    ("warn", LevelFilter::WARN),
    ("info", LevelFilter::INFO),
    ("debug", LevelFilter::DEBUG),
    ("trace", LevelFilter::TRACE),
];

impl Request {
    /// What the command line (`flag`) or the environment asks for; `None` for no log.
    pub fn new(
        flag: Option<PathBuf>,
        lookup: impl Fn(&str) -> Option<OsString>,
    ) -> (Option<Self>, Vec<Complaint>) {
        let set = |name: &str| lookup(name).filter(|value| !value.is_empty());
        let Some(file) = flag.or_else(|| set("LINDEN_LOG").map(PathBuf::from)) else {
            return (None, Vec::new());
        };
        let mut complaints = Vec::new();
        let mut level = LevelFilter::DEBUG;
        if let Some(word) = set("LINDEN_LOG_LEVEL") {
            let word = word.to_string_lossy();
            match LEVELS.iter().find(|(known, _)| word.eq_ignore_ascii_case(known)) {
                Some((_, found)) => level = *found,
                None => {
                    let names = LEVELS.map(|(name, _)| name);
                    let message = format!(
                        "LINDEN_LOG_LEVEL is '{}'{}; expected {}; logging debug",
                        excerpt(&word),
                        did_you_mean(nearest(&word, names)),
                        names.join(", ")
                    );
                    complaints.push(Complaint::new(&file, message));
                }
            }
        }
        (Some(Self { file, level }), complaints)
    }

    /// Logs from now on, for the rest of the process.
    ///
    /// # Errors
    /// The file cannot be written, is no file, or there is a log already.
    pub fn start(&self) -> Result<(), Complaint> {
        let failed = |problem: String| Complaint::new(&self.file, format!("cannot be logged to: {problem}"));
        let file = open(&self.file).map_err(|error| failed(error.to_string()))?;
        set_global_default(subscriber(file, self.level)).map_err(|error| failed(error.to_string()))
    }
}

/// Opens a file to append to. Pipes can block, and a terminal is where the workbench is drawn.
fn open(path: &Path) -> io::Result<File> {
    if fs::metadata(path).is_ok_and(|about| !about.is_file()) {
        return Err(io::Error::other("it is not a regular file; name one, or one that does not exist yet"));
    }
    OpenOptions::new().create(true).append(true).open(path)
}

/// What turns events into lines.
fn subscriber(file: File, level: LevelFilter) -> impl Subscriber + Send + Sync {
    let writer = Lines(Arc::new(file));
    tracing_subscriber::fmt().with_max_level(level).with_ansi(false).with_writer(writer).finish()
}

/// Writes each event as one printable line.
#[derive(Clone)]
struct Lines(Arc<File>);

impl Write for Lines {
    /// Takes a whole event: the formatter gives each one in one piece.
    fn write(&mut self, event: &[u8]) -> io::Result<usize> {
        let text = String::from_utf8_lossy(event);
        let line = printable(text.trim_end_matches('\n')) + "\n";
        (&*self.0).write_all(line.as_bytes())?;
        Ok(event.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<'a> MakeWriter<'a> for Lines {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(flag: Option<&str>, environment: &[(&str, &str)]) -> (Option<Request>, Vec<Complaint>) {
        let lookup = |name: &str| environment.iter().find(|(known, _)| *known == name).map(|(_, v)| v.into());
        Request::new(flag.map(PathBuf::from), lookup)
    }

    #[test]
    fn nothing_is_logged_without_a_request() {
        assert_eq!(request(None, &[]), (None, vec![]));
        assert_eq!(request(None, &[("LINDEN_LOG", ""), ("LINDEN_LOG_LEVEL", "x")]), (None, vec![]));
    }

    #[test]
    fn the_flag_goes_before_the_environment() {
        let environment = [("LINDEN_LOG", "b.log"), ("LINDEN_LOG_LEVEL", "Warn")];
        let expect = |file: &str, level| (Some(Request { file: file.into(), level }), vec![]);
        assert_eq!(request(Some("a.log"), &environment), expect("a.log", LevelFilter::WARN));
        assert_eq!(request(None, &environment), expect("b.log", LevelFilter::WARN));
        assert_eq!(request(Some("a.log"), &[]), expect("a.log", LevelFilter::DEBUG));
    }

    #[test]
    fn a_level_that_is_none_is_complained_about() {
        let (found, complaints) = request(Some("a.log"), &[("LINDEN_LOG_LEVEL", "wran")]);
        assert_eq!(found.unwrap().level, LevelFilter::DEBUG);
        assert!(complaints[0].message.contains("did you mean 'warn'"), "{}", complaints[0]);
    }

    #[test]
    fn events_are_appended_as_printable_lines() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("linden.log");
        fs::write(&path, "before\n").unwrap();
        let log = subscriber(open(&path).unwrap(), LevelFilter::INFO);
        tracing::subscriber::with_default(log, || {
            tracing::info!(name = "a\u{1b}[2J", "read \u{202e}\u{9b}2J\r\nnot a line of its own");
            tracing::debug!("not asked for");
            tracing::error!("last");
        });
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3, "{text}");
        assert_eq!(lines[0], "before");
        assert!(lines[1].contains("INFO") && lines[2].contains("ERROR"), "{text}");
        assert!(!text.chars().any(|c| c != '\n' && c.is_control()), "{text:?}");
        assert!(!text.contains('\u{202e}') && lines[1].contains("not a line of its own"), "{text:?}");
    }

    #[test]
    fn a_process_has_one_log() {
        let dir = tempfile::tempdir().unwrap();
        let request = Request { file: dir.path().join("linden.log"), level: LevelFilter::WARN };
        request.start().unwrap();
        tracing::warn!("now");
        assert!(fs::read_to_string(&request.file).unwrap().contains("WARN"));
        assert!(request.start().unwrap_err().message.contains("cannot be logged to"));
    }

    #[test]
    fn what_is_no_file_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        for path in [dir.path(), Path::new("/dev/tty"), Path::new("/dev/null")] {
            let request = Request { file: path.to_owned(), level: LevelFilter::DEBUG };
            assert!(request.start().unwrap_err().message.contains("cannot be logged to"), "{path:?}");
        }
    }
}
