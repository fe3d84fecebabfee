//! Where a plug-in works: a temporary folder, which goes with it however we end.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::system::{Guard, with_process_group};

/// A plug-in's folder, which goes when this is dropped, or when we end in any other way.
pub(super) struct Workplace {
    // In this order: the guard is dismissed when the folder is gone.
    folder: tempfile::TempDir,
    guard: Option<Guard>,
}

impl Workplace {
    /// Makes the folder. Without a shell there is no guard.
    pub fn new() -> io::Result<Self> {
        let mut guard = Guard::start();
        let folder = tempfile::Builder::new().prefix("linden-").tempdir()?;
        // A line holds no other.
        let path: PathBuf = folder.path().to_owned();
        guard = guard.filter(|_| !path.as_os_str().as_encoded_bytes().contains(&b'\n'));
        if let Some(guard) = &mut guard {
            guard.tell(path.as_os_str().as_encoded_bytes());
        }
        Ok(Self { folder, guard })
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Starts a program. What it says goes to the file `said`, and whatever it starts ends with us.
    ///
    /// # Errors
    /// The file `said` cannot be made.
    pub fn command(&self, program: &Path, arguments: [&Path; 2], said: &Path) -> io::Result<Command> {
        let log = File::create(said)?;
        let mut command = match self.guard.as_ref().and_then(|guard| guard.launcher(program, said)) {
            Some(launcher) => launcher,
            None => {
                let mut command = Command::new(program);
                command.stdout(log.try_clone()?);
                command
            }
        };
        command.stderr(log).args(arguments);
        with_process_group(&mut command);
        Ok(command)
    }
}
