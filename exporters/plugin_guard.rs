//! What is left of us when we are killed: a shell that waits at a pipe. When the pipe breaks, it ends the
//! plug-in with all that it started and removes its folder. Nobody can kill a program so suddenly that
//! the system does not close its pipes.

use std::path::{Path, PathBuf};

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

    /// The plug-in has begun, in a process group of this number.
    pub fn guard(&mut self, group: u32) {
        if let Some(guard) = &mut self.guard {
            guard.tell(group.to_string().as_bytes());
        }
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
        use std::process::{Command, Stdio};
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
}
