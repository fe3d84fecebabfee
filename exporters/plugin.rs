//! Exporters without recompiling: a format `foo` that nobody here knows is the program
//! `linden-export-foo` on the search path, as git finds its commands.
//!
//! ```text
//! linden-export-foo GLB TARGET < RECIPE
//! ```
//!
//! It is given a GLB of the tree, where its file is to be written, and the recipe as JSON on standard
//! input. It works in a temporary folder. `LINDEN_NAME` is the tree's name and `LINDEN_VERSION` ours.
//! What it writes goes to its place when it has ended well, and so do files beside `TARGET` whose names
//! begin with the target's stem. What it says is shown when it fails; nothing is left behind then. When
//! linden is killed, the plug-in ends too and its folder goes ([`Workplace`]).

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus};
use std::sync::Mutex;
use std::time::Duration;

use linden_pipeline::Monitor;
use linden_pipeline::knob::printable;
use linden_pipeline::stage::Stage;

use crate::gltf::Glb;
use crate::workplace::Workplace;
use crate::{Bundle, Encoding, ExportError, Exporter, Format, GENERATOR, Holds, Options, Readable, system};

/// What programs' names begin with.
const PREFIX: &str = "linden-export-";
/// The longest id.
const LONGEST_ID: usize = 32;
/// How much of what a program says is shown: its end.
const MOST_SAID: usize = 2000;
/// Between two looks at a program at work.
const LOOK: Duration = Duration::from_millis(10);
/// How long a program that is asked to end may take to do so.
const GRACE: Duration = Duration::from_secs(2);

/// A program that writes a format.
struct Plugin {
    format: &'static Format,
    program: PathBuf,
}

/// Those that were found, by id: formats live as long as the process.
static KNOWN: Mutex<BTreeMap<String, &'static Plugin>> = Mutex::new(BTreeMap::new());

/// The plug-in for a format, if there is such a program on the search path.
pub(crate) fn find(id: &str) -> Option<&'static dyn Exporter> {
    find_in(&search_path(), id)
}

/// All plug-ins on the search path, by id, as they were there when they were first asked for.
pub(crate) fn all() -> Vec<&'static dyn Exporter> {
    static LISTING: Listing = Listing(Mutex::new(None));
    LISTING.of(search_path())
}

/// The plug-ins of a search path: its folders hold thousands of programs, and dialogs ask for formats with every key.
struct Listing(Mutex<Option<Listed>>);

/// What was found in some folders.
struct Listed {
    folders: Vec<PathBuf>,
    plugins: Vec<&'static dyn Exporter>,
}

impl Listing {
    /// Those of some folders, which are looked through once.
    fn of(&self, folders: Vec<PathBuf>) -> Vec<&'static dyn Exporter> {
        let mut last = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        match &*last {
            Some(listed) if listed.folders == folders => listed.plugins.clone(),
            _ => {
                let plugins = all_in(&folders);
                *last = Some(Listed { folders, plugins: plugins.clone() });
                plugins
            }
        }
    }
}

fn find_in(folders: &[PathBuf], id: &str) -> Option<&'static dyn Exporter> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if id.is_empty() || id.len() > LONGEST_ID || !id.chars().all(plain) {
        return None;
    }
    Some(known(id, program_in(folders, &format!("{PREFIX}{id}"))?))
}

fn all_in(folders: &[PathBuf]) -> Vec<&'static dyn Exporter> {
    let mut ids = Vec::new();
    for entry in folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten() {
        let name = entry.file_name();
        let Some(rest) = name.to_str().and_then(|name| name.strip_prefix(PREFIX)) else { continue };
        let id = rest.strip_suffix(std::env::consts::EXE_SUFFIX).unwrap_or(rest);
        ids.push(id.to_owned());
    }
    ids.sort_unstable();
    ids.dedup();
    ids.iter().filter_map(|id| find_in(folders, id)).collect()
}

/// A program on the search path. [`std::process::Command`] would find those in relative folders too.
pub fn program_on_path(name: &str) -> Option<PathBuf> {
    program_in(&search_path(), name)
}

fn program_in(folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    folders.iter().map(|folder| folder.join(&file)).find(|path| is_program(path))
}

/// Relative folders are left out: what runs must not depend on where it is run.
fn search_path() -> Vec<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).filter(|folder| folder.is_absolute()).collect()
}

fn is_program(path: &Path) -> bool {
    let Ok(meta) = fs::metadata(path) else { return false };
    system::is_program(&meta)
}

fn known(id: &str, program: PathBuf) -> &'static Plugin {
    let mut known = KNOWN.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let leaked = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    known.entry(id.to_owned()).or_insert_with(|| {
        let id = leaked(id.to_owned());
        let format = Format {
            id,
            name: leaked(format!("{PREFIX}{id}")),
            extensions: Box::leak(Box::new([id])),
            media_type: "application/octet-stream",
            self_contained: false,
            help: leaked(format!("plug-in {}", printable(&program.to_string_lossy()))),
            options: &[],
            // It is given a GLB, and what it makes of that is not known.
            holds: Holds { recipe: false, ..Glb.format().holds },
            // How it writes, and how much, is not known either.
            levels_by: None,
            encoding: |_| Encoding::Binary,
            estimate: None,
        };
        Box::leak(Box::new(Plugin { format: Box::leak(Box::new(format)), program }))
    })
}

impl Exporter for Plugin {
    fn format(&self) -> &'static Format {
        self.format
    }

    /// What a program writes is for another program to read.
    fn recipe(&self, _: &mut dyn Readable) -> io::Result<Option<String>> {
        Ok(None)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        _: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let failed = |doing: &'static str| {
            let what = self.format.name.to_owned();
            move |source: io::Error| ExportError::Io { doing, what: what.clone(), source }
        };
        let folder = Workplace::new().map_err(failed("making a folder for"))?;
        let glb = folder.path().join("tree.glb");
        let mut whole = Bundle::create(&glb)?.unsynced();
        Glb.write(stage, &Options::new(Glb.format()), &mut whole, monitor)?;
        whole.notes().iter().for_each(|note| bundle.note(note.clone()));
        whole.commit()?;
        let recipe = folder.path().join("recipe.json");
        fs::write(&recipe, &stage.recipe).map_err(failed("writing the recipe for"))?;
        let out = folder.path().join("out");
        fs::create_dir(&out).map_err(failed("making a folder for"))?;
        let own_name = bundle.side_name("");
        let stem = if own_name.is_empty() { "tree".to_owned() } else { own_name };
        let target = out.join(format!("{stem}.{}", self.format.id));
        let said = folder.path().join("said.txt");
        let mut command =
            folder.command(&self.program, [&glb, &target], &said).map_err(failed("listening to"))?;
        command
            .current_dir(&out)
            .env("LINDEN_NAME", &stage.name)
            .env("LINDEN_VERSION", GENERATOR.trim_start_matches("linden "))
            .stdin(File::open(&recipe).map_err(failed("reading the recipe for"))?);
        let child = command.spawn().map_err(failed("starting"))?;
        let status = Running(child).wait(monitor)?.map_err(failed("waiting for"))?;
        let problem = |problem: String| ExportError::Plugin {
            program: self.format.name,
            problem,
            said: last_words(&said),
        };
        if !status.success() {
            return Err(problem(format!("it ended with {status}")));
        }
        if !fs::symlink_metadata(&target).is_ok_and(|meta| meta.is_file() && meta.len() > 0) {
            return Err(problem("it ended well, but wrote nothing to its target".to_owned()));
        }
        for entry in fs::read_dir(&out).map_err(failed("looking at the files of"))? {
            let entry = entry.map_err(failed("looking at the files of"))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if entry.path() == target {
                continue;
            }
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            let Some(suffix) = name.strip_prefix(&stem).filter(|_| is_file) else {
                return Err(problem(format!(
                    "it left '{}', which is no file whose name begins with '{stem}'",
                    printable(&name)
                )));
            };
            let path = entry.path();
            bundle.write_side(suffix, None, monitor, |out| copy(&path, &name, out))?;
        }
        bundle.write_main(None, monitor, |out| copy(&target, self.format.name, out))
    }
}

/// A file of the plug-in's, into its place.
fn copy(path: &Path, what: &str, out: &mut crate::Sink<'_>) -> Result<(), ExportError> {
    let reading = |source| ExportError::Io { doing: "reading", what: printable(what), source };
    let mut file = File::open(path).map_err(reading)?;
    let mut piece = vec![0; 1 << 20];
    loop {
        match file.read(&mut piece).map_err(reading)? {
            0 => return Ok(()),
            count => out.write(&piece[..count])?,
        }
    }
}

/// The end of what a program said, each line printable.
fn last_words(said: &Path) -> String {
    let bytes = fs::read(said).unwrap_or_default();
    let end = &bytes[bytes.len().saturating_sub(MOST_SAID)..];
    let text = String::from_utf8_lossy(end);
    let lines: Vec<String> =
        text.lines().map(str::trim_end).filter(|l| !l.is_empty()).map(printable).collect();
    lines.join("\n  ")
}

/// A program at work. Dropped before it ends, it is ended.
struct Running(Child);

impl Running {
    /// Waits until it ends, or until nobody wants the result any more: then it is asked to end, with
    /// all that it started.
    fn wait(mut self, monitor: &dyn Monitor) -> Result<io::Result<ExitStatus>, ExportError> {
        loop {
            match self.0.try_wait() {
                Ok(Some(status)) => return Ok(Ok(status)),
                Ok(None) => {}
                Err(error) => return Ok(Err(error)),
            }
            monitor.check()?;
            std::thread::sleep(LOOK);
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if !matches!(self.0.try_wait(), Ok(None)) {
            return;
        }
        system::ask_to_end(&mut self.0, GRACE);
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// This test itself as a plug-in: it is a program everywhere.
    fn add(folder: &Path, id: &str) {
        let program = folder.join(format!("{PREFIX}{id}{}", std::env::consts::EXE_SUFFIX));
        fs::copy(std::env::current_exe().unwrap(), program).unwrap();
    }

    #[test]
    fn folders_are_looked_through_once_for_each_search_path() {
        let [one, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let listing = Listing(Mutex::new(None));
        let found = |folders: &[&Path]| {
            let plugins = listing.of(folders.iter().map(|folder| folder.to_path_buf()).collect());
            plugins.iter().map(|plugin| plugin.format().id).collect::<Vec<_>>()
        };
        add(one.path(), "listed-a");
        assert_eq!(found(&[one.path()]), ["listed-a"]);
        add(one.path(), "listed-b");
        assert_eq!(found(&[one.path()]), ["listed-a"], "not looked for again");
        assert_eq!(found(&[one.path(), other.path()]), ["listed-a", "listed-b"], "another search path");
        add(other.path(), "listed-c");
        assert_eq!(found(&[other.path()]), ["listed-c"]);
        assert_eq!(found(&[]), [""; 0]);
    }
}
