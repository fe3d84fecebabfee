//! What is left of us when we are killed: a shell that waits at a pipe. When the pipe breaks, it ends the
//! plug-in with all that it started and removes its folder. Nobody can kill a program so suddenly that
//! the system does not close its pipes.

use std::io::Write as _;
use std::os::fd::AsFd as _;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process_group};

/// Reads the folder, then the plug-in's process group, then `done`; what comes instead of a line is our
/// end. The plug-in is asked to end before it is made to.
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
const LAUNCH: &str = r#"said=$1; shift; echo "$$"; exec "$@" >>"$said" 2>&1"#;

/// Between two looks at a program that was asked to end.
const LOOK: Duration = Duration::from_millis(10);

/// A shell that outlives us.
pub(crate) struct Guard {
    shell: Child,
    pipe: Option<ChildStdin>,
}

impl Guard {
    /// Starts it; `None` without a shell.
    pub fn start() -> Option<Self> {
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
    pub fn launcher(&self, program: &Path, said: &Path) -> Option<Command> {
        let pipe = self.pipe.as_ref()?.as_fd().try_clone_to_owned().ok()?;
        let mut command = Command::new("/bin/sh");
        command.args(["-c", LAUNCH, "linden-plugin"]).arg(said).arg(program).stdout(pipe);
        Some(command)
    }

    /// A guard that hears nothing any more cannot be helped.
    pub fn tell(&mut self, line: &[u8]) {
        if let Some(pipe) = &mut self.pipe {
            let _ = pipe.write_all(&[line, b"\n"].concat());
        }
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        self.tell(b"done");
        self.pipe = None;
        let _ = self.shell.wait();
    }
}

/// A program that is started gets a group of its own, so that what it starts can be ended with it.
pub(crate) fn with_process_group(command: &mut Command) {
    command.process_group(0);
}

/// Asks a program to end, with all that it started, waits for it, and then makes them.
pub(crate) fn ask_to_end(program: &mut Child, within: Duration) {
    signal(program, Signal::TERM);
    let asked = Instant::now();
    while asked.elapsed() < within && matches!(program.try_wait(), Ok(None)) {
        std::thread::sleep(LOOK);
    }
    signal(program, Signal::KILL);
}

fn signal(program: &Child, signal: Signal) {
    if let Some(group) = i32::try_from(program.id()).ok().and_then(Pid::from_raw) {
        // Whoever is gone already cannot be told.
        let _ = kill_process_group(group, signal);
    }
}
