//! What is left of us when we are killed: a shell that waits at a pipe. When the pipe breaks, it ends the
//! plug-in with all that it started and removes its folder. Nobody can kill a program so suddenly that
//! the system does not close its pipes.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
#[cfg(unix)]
use std::process::Stdio;

/// Reads the folder, then the plug-in's process group, then `done`; what comes instead of a line is our
/// end. The plug-in is asked to end before it is made to.
#[cfg(unix)]
const SCRIPT: &str = r#"
trap '' HUP INT TERM
IFS= read -r folder || exit 0
group=
while IFS= read -r line; do
  [ "$line" = done ] && exit 0
  group=$line
done
if [ -n "$group" ]; then
  kill -s TERM -- "-$group"
  tries=0
  while [ $tries -lt 20 ] && kill -s 0 -- "-$group"; do
    sleep 0.1
    tries=$((tries + 1))
  done
  kill -s KILL -- "-$group"
fi
rm -rf -- "$folder"
"#;

/// Starts the plug-in. The guard is told of its group before there is anything to end, by a shell that
/// then becomes the plug-in: while it has not told, it holds the pipe, which does not break.
#[cfg(unix)]
const LAUNCH: &str = r#"said=$1; shift; echo "$$"; exec "$@" >>"$said" 2>&1"#;

/// A plug-in's folder, which goes when this is dropped, or when we end in any other way.
pub(super) struct Workplace {
    // In this order: the guard is dismissed when the folder is gone.
    folder: tempfile::TempDir,
    guard: Option<Guard>,
}

impl Workplace {
    /// Makes the folder. Without a shell there is no guard.
    pub fn new() -> std::io::Result<Self> {
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
    pub fn command(&self, program: &Path, arguments: [&Path; 2], said: &Path) -> std::io::Result<Command> {
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
        // A group of its own, so that what it starts can be ended with it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        Ok(command)
    }
}

#[cfg(unix)]
struct Guard {
    shell: std::process::Child,
    pipe: Option<std::process::ChildStdin>,
}

#[cfg(unix)]
impl Guard {
    fn start() -> Option<Self> {
        use std::os::unix::process::CommandExt;
        let shell = Command::new("/bin/sh")
            .args(["-c", SCRIPT, "linden-plugin-guard"])
            .current_dir("/")
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            // What is sent to our group is not for it.
            .process_group(0)
            .spawn();
        let mut shell = shell.ok()?;
        let pipe = shell.stdin.take();
        Some(Self { shell, pipe })
    }

    /// The shell that tells of its group, and then becomes the program.
    fn launcher(&self, program: &Path, said: &Path) -> Option<Command> {
        use std::os::fd::AsFd;
        let pipe = self.pipe.as_ref()?.as_fd().try_clone_to_owned().ok()?;
        let mut command = Command::new("/bin/sh");
        command.args(["-c", LAUNCH, "linden-plugin"]).arg(said).arg(program).stdout(pipe);
        Some(command)
    }

    /// A guard that hears nothing any more cannot be helped.
    fn tell(&mut self, line: &[u8]) {
        use std::io::Write;
        if let Some(pipe) = &mut self.pipe {
            let _ = pipe.write_all(&[line, b"\n"].concat());
        }
    }
}

#[cfg(unix)]
impl Drop for Guard {
    fn drop(&mut self) {
        self.tell(b"done");
        self.pipe = None;
        let _ = self.shell.wait();
    }
}

/// Elsewhere there is none.
#[cfg(not(unix))]
struct Guard;

#[cfg(not(unix))]
impl Guard {
    fn start() -> Option<Self> {
        None
    }

    fn tell(&mut self, _: &[u8]) {}

    fn launcher(&self, _: &Path, _: &Path) -> Option<Command> {
        None
    }
}
