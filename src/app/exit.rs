//! Exit codes, and which error means which.

use std::error::Error;
use std::process::ExitCode;

use linden::Cancelled;
use linden::input::InputError;

use crate::source::MissingFile;
use crate::trust::NotAllowed;

/// 1: it was tried and failed.
const FAILED: u8 = 1;
/// 2: the command line names something that does not exist or cannot be, or a document has a mistake. The same again fails
/// again, which schedulers of jobs rely on.
const USAGE: u8 = 2;

/// An error of what the user wrote, as a command or a document: exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Usage(pub String);

/// The reader of standard output has seen enough (`linden list | head`), and nothing else was to be
/// written: that is no failure.
#[derive(Debug, thiserror::Error)]
#[error("the program that was reading standard output has stopped")]
pub struct ReaderGone;

/// For `?` on errors of the command line and of documents.
pub fn usage(error: impl std::fmt::Display) -> anyhow::Error {
    Usage(error.to_string()).into()
}

/// Says what went wrong on standard error, if there is anything to say, and with which code to end.
pub fn report(error: &anyhow::Error) -> ExitCode {
    if let Some(signal) = crate::signals::received() {
        // Whatever failed, failed because of it. Shells expect 128 + signal.
        return ExitCode::from(128 + signal);
    }
    if error.is::<ReaderGone>() {
        return ExitCode::SUCCESS;
    }
    let code = if error.chain().any(is_usage) { USAGE } else { FAILED };
    say(&format!("error: {}", sentence(error)));
    ExitCode::from(code)
}

/// Whether the same again fails again, whatever the machine does: a mistake in the command or in a document, a file that a
/// document names and that it may not, or that is not there, and text that is none.
fn is_usage(cause: &(dyn Error + 'static)) -> bool {
    cause.is::<Usage>()
        || cause.is::<NotAllowed>()
        || cause.is::<MissingFile>()
        || cause.downcast_ref().is_some_and(is_of_other_encoding)
}

/// Whether a file is text that is not UTF-8.
fn is_of_other_encoding(error: &InputError) -> bool {
    matches!(error, InputError::NotUtf8 { .. })
        || matches!(error, InputError::Unknown { looks } if looks.contains("UTF-16"))
}

/// A line on standard error. When even that is gone, there is nothing left to tell.
pub fn say(line: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// The chain of causes in one line, without causes that their effects already quote.
pub fn sentence(error: &anyhow::Error) -> String {
    let mut line = String::new();
    for cause in error.chain() {
        let text = cause.to_string();
        if cause.is::<Cancelled>() || line.contains(&text) {
            continue;
        }
        if !line.is_empty() {
            line.push_str(": ");
        }
        line.push_str(&text);
    }
    line
}
