//! Finding out what the export dialog wants to know. Looking at a disk may take its time, or for
//! ever where a network is gone: so it has a separate lane, and the newest question wins.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use linden::season::Season;
use linden::{Cancelled, Monitor};
use linden_exporters::{Estimate, Existing, ExportError, Output, examine};

use super::export::{NO_STREAM, files_of};
use super::{ExportNews, ShownTree};
use crate::paths::{self, expand, expand_with, is_one_of};
use crate::portrait;
use crate::system;

/// What the export dialog wants to know.
#[derive(Clone, Debug)]
pub struct Inquiry {
    /// Raised when all of it is to be found out anew.
    pub round: u32,
    /// What is to be written, each with its path as it was typed.
    pub targets: Vec<Output>,
    /// The levels of detail that it is written in.
    pub levels: usize,
    /// The seasons that it is written in; none: the one that it is in.
    pub seasons: Vec<Season>,
    /// The names of the ages that it is written at; none: the one that it has.
    pub ages: Vec<String>,
    /// A path that is being typed, up to the cursor, to be completed.
    pub completes: Option<String>,
    /// A tree to be estimated.
    pub shown: Option<Arc<ShownTree>>,
    /// Files that must not be replaced.
    pub sources: Vec<PathBuf>,
}

impl PartialEq for Inquiry {
    /// Trees are compared by where they are.
    fn eq(&self, other: &Self) -> bool {
        self.round == other.round
            && self.targets.len() == other.targets.len()
            && self.targets.iter().zip(&other.targets).all(|(one, another)| is_same(one, another))
            && self.levels == other.levels
            && self.seasons == other.seasons
            && self.ages == other.ages
            && self.completes == other.completes
            && self.sources == other.sources
            && self.shown.as_ref().map(Arc::as_ptr) == other.shown.as_ref().map(Arc::as_ptr)
    }
}

/// Whether the same is written to the same place.
fn is_same(one: &Output, other: &Output) -> bool {
    one.path == other.path
        && one.exporter.format().id == other.exporter.format().id
        && one.options.iter().eq(other.options.iter())
}

/// What was found out.
#[derive(Debug)]
pub struct Findings {
    /// What was asked.
    pub inquiry: Inquiry,
    /// For each target.
    pub targets: Vec<TargetFinding>,
    /// Where each would be from the root on, as it was typed where it is no path.
    pub places: Vec<PathBuf>,
    /// Lines that what is being typed may go on to be, directories with a separator at their end.
    pub completions: Vec<String>,
}

/// What was found out about a target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TargetFinding {
    /// A file there will be new.
    Free,
    /// These files would be replaced: the one that was named, or those of single seasons and levels that are written in
    /// its place.
    Replaces(Vec<PathBuf>),
    /// A file there will be new, and so will its directory.
    NewFolder,
    /// No file can be written there, and why.
    Unfit(String),
}

/// Entries of a directory that are looked at to complete a name: more than anybody has, few enough
/// to be over soon.
const MOST_ENTRIES: usize = 20_000;
/// Names that are given back.
const MOST_COMPLETIONS: usize = 500;

/// Finds out what is asked, on its lane. What takes no disk is said first.
pub fn look(inquiry: Inquiry, watcher: &dyn Monitor, say: &dyn Fn(ExportNews)) {
    let _: Result<(), Cancelled> = find_out(inquiry, watcher, say);
}

fn find_out(inquiry: Inquiry, watcher: &dyn Monitor, say: &dyn Fn(ExportNews)) -> Result<(), Cancelled> {
    if let Some(shown) = &inquiry.shown {
        let estimate = Estimate::new(&shown.recipe, &shown.grown, watcher)?;
        say(ExportNews::Estimated(Arc::clone(shown), estimate));
    }
    let targets = findings(&inquiry, watcher)?;
    let places = inquiry.targets.iter().map(|target| whole(&target.path)).collect();
    let completions = match &inquiry.completes {
        Some(typed) => completions(typed, std::env::home_dir().as_deref(), watcher)?,
        None => Vec::new(),
    };
    say(ExportNews::Found(Box::new(Findings { inquiry, targets, places, completions })));
    Ok(())
}

fn findings(inquiry: &Inquiry, watcher: &dyn Monitor) -> Result<Vec<TargetFinding>, Cancelled> {
    let known = portrait::formats();
    let ages: Vec<&str> = inquiry.ages.iter().map(String::as_str).collect();
    let mut taken = BTreeSet::<(PathBuf, OsString)>::new();
    let mut found = Vec::new();
    for target in &inquiry.targets {
        watcher.check()?;
        let typed = target.path.to_string_lossy();
        let format = target.exporter.format();
        if typed.is_empty() {
            found.push(TargetFinding::Unfit("type where the file is to be".to_owned()));
            continue;
        }
        let path = match expand(&typed) {
            Ok(path) => path,
            Err(why) => {
                found.push(TargetFinding::Unfit(why));
                continue;
            }
        };
        if let Some(other) = known.misnamed(format, &path) {
            let why =
                format!("that ending is of {}, and this is {}; choose another name", other.id, format.id);
            found.push(TargetFinding::Unfit(why));
            continue;
        }
        let output = Output::new(target.exporter, target.options.clone(), path);
        let files = files_of(output, &ages, &inquiry.seasons, inquiry.levels);
        let mut whole = TargetFinding::Free;
        for file in files {
            watcher.check()?;
            let twice = place_of(&file.path).is_some_and(|place| !taken.insert(place));
            let one = if twice {
                TargetFinding::Unfit("another format goes there too; give each its own name".to_owned())
            } else if is_one_of(&file.path, &inquiry.sources) {
                TargetFinding::Unfit("the tree is grown from that file; choose another name".to_owned())
            } else {
                finding(&file.path)
            };
            whole = whole.and(one);
        }
        found.push(whole);
    }
    Ok(found)
}

impl TargetFinding {
    /// Of two files that are written for one target.
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unfit(why), _) | (_, Self::Unfit(why)) => Self::Unfit(why),
            (Self::Replaces(mut files), Self::Replaces(more)) => {
                files.extend(more);
                Self::Replaces(files)
            }
            // Where a directory is missing, no file is there.
            (Self::Replaces(files), _) | (_, Self::Replaces(files)) => Self::Replaces(files),
            (Self::NewFolder, _) | (_, Self::NewFolder) => Self::NewFolder,
            (Self::Free, Self::Free) => Self::Free,
        }
    }
}

fn finding(path: &Path) -> TargetFinding {
    match examine(path) {
        Ok(Existing::Stream) => TargetFinding::Unfit(NO_STREAM.to_owned()),
        Ok(_) if !system::is_writable(directory_of(path)) => {
            TargetFinding::Unfit("you may not write to that directory; choose one of yours".to_owned())
        }
        Ok(Existing::Nothing) => TargetFinding::Free,
        Ok(Existing::File) => TargetFinding::Replaces(vec![path.to_owned()]),
        Err(ExportError::NoFolder { folder, .. }) if is_makeable(&folder) => TargetFinding::NewFolder,
        Err(error) => {
            // The path stands before it on the screen.
            let told = error.to_string();
            let shown = linden::knob::printable(&path.to_string_lossy());
            let why = told.split_once(shown.as_str()).and_then(|(_, after)| after.split_once(": "));
            TargetFinding::Unfit(why.map(|(_, why)| why.to_owned()).unwrap_or(told))
        }
    }
}

/// A path that was typed, from the root on.
fn whole(typed: &Path) -> PathBuf {
    let path = typed.to_str().and_then(|typed| expand(typed).ok());
    path.and_then(|path| std::path::absolute(path).ok()).unwrap_or_else(|| typed.to_owned())
}

fn directory_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether a missing directory can be made, as far as permissions tell: in the nearest one that is there.
fn is_makeable(folder: &Path) -> bool {
    let above = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    above
        .ancestors()
        .find(|path| fs::symlink_metadata(path).is_ok())
        .is_some_and(|nearest| nearest.is_dir() && system::is_writable(nearest))
}

/// A directory without links, and a name in it.
fn place_of(path: &Path) -> Option<(PathBuf, OsString)> {
    Some((fs::canonicalize(directory_of(path)).ok()?, path.file_name()?.to_owned()))
}

/// What a path that is being typed may go on to be, sorted. Hidden names only where their dot is typed;
/// names that are not Unicode cannot be typed.
fn completions(typed: &str, home: Option<&Path>, watcher: &dyn Monitor) -> Result<Vec<String>, Cancelled> {
    let end = typed.rfind(std::path::is_separator).map_or(0, |at| at + 1);
    let (before, start) = typed.split_at(end);
    if before.is_empty() && start == "~" && home.is_some() {
        return Ok(vec!["~/".to_owned()]);
    }
    let expanded = || expand_with(before, home, &|name| std::env::var_os(name)).ok();
    let directory = if before.is_empty() { Some(PathBuf::from(".")) } else { expanded() };
    let Some(Ok(entries)) = directory.map(fs::read_dir) else { return Ok(Vec::new()) };
    // As names are typed that have a dollar.
    let start = start.replace("$$", "$");
    let mut found = Vec::new();
    for entry in entries.take(MOST_ENTRIES) {
        watcher.check()?;
        let Ok(entry) = entry else { continue };
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|name| name.starts_with(&start)) else { continue };
        if name.starts_with('.') && !start.starts_with('.') {
            continue;
        }
        let is_directory = match entry.file_type() {
            Ok(kind) if kind.is_symlink() => entry.path().is_dir(),
            Ok(kind) => kind.is_dir(),
            Err(_) => false,
        };
        let name = if before.is_empty() { paths::typed(name) } else { name.replace('$', "$$") };
        found.push(format!("{before}{name}{}", if is_directory { "/" } else { "" }));
        if found.len() == MOST_COMPLETIONS {
            break;
        }
    }
    found.sort_unstable();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use linden::Quiet;
    use linden_exporters::{Options, find};

    use super::*;

    fn asked(targets: &[&str], completes: Option<&str>, sources: Vec<PathBuf>) -> Findings {
        let target = |path: &&str| {
            let exporter = portrait::formats().for_path(Path::new(path)).unwrap_or(linden_exporters::USUAL);
            Output::new(exporter, Options::new(exporter.format()), path.into())
        };
        let targets = targets.iter().map(target).collect();
        let completes = completes.map(str::to_owned);
        let (seasons, ages) = (vec![], vec![]);
        ask(Inquiry { round: 1, targets, levels: 1, seasons, ages, completes, shown: None, sources })
    }

    fn ask(inquiry: Inquiry) -> Findings {
        let said = RefCell::new(None);
        look(inquiry, &Quiet, &|news| *said.borrow_mut() = Some(news));
        match said.into_inner() {
            Some(ExportNews::Found(found)) => *found,
            other => panic!("{other:?}"),
        }
    }

    fn unfit(finding: &TargetFinding) -> &str {
        match finding {
            TargetFinding::Unfit(why) => why,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn targets_are_told_apart() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
        fs::write(at("old.obj"), "before").unwrap();
        fs::write(at("crown.obj"), "source").unwrap();
        fs::create_dir(at("sub")).unwrap();
        let names = ["new.glb", "old.obj", "sub", "none/fir.ply", "crown.obj", "sub/../new.glb"];
        let targets = names.map(at);
        let found = asked(&targets.each_ref().map(String::as_str), None, vec![at("crown.obj").into()]);
        let here = asked(&["old.obj"], None, Vec::new()).places.remove(0);
        assert_eq!(here, std::env::current_dir().unwrap().join("old.obj"));
        let there = TargetFinding::Replaces(vec![at("old.obj").into()]);
        assert_eq!(found.targets[..2], [TargetFinding::Free, there]);
        assert!(unfit(&found.targets[2]).starts_with("that is a directory"), "{found:?}");
        assert_eq!(found.targets[3], TargetFinding::NewFolder);
        assert!(unfit(&found.targets[4]).contains("grown from that file"), "{found:?}");
        assert!(unfit(&found.targets[5]).contains("another format"), "{found:?}");
        let found = asked(&["", "/dev/null"], None, Vec::new());
        assert!(unfit(&found.targets[0]).contains("type where"));
        let unknown = asked(&["$LINDEN_NEVER_SET/a.glb", "~nobody/a.glb"], None, Vec::new());
        assert!(unfit(&unknown.targets[0]).contains("$LINDEN_NEVER_SET is not set"));
        assert!(unfit(&unknown.targets[1]).contains("another user's home"));
        #[cfg(unix)]
        assert!(unfit(&found.targets[1]).contains("pipe or a device"));
        assert_eq!(fs::read_to_string(at("old.obj")).unwrap(), "before");
    }

    #[test]
    fn files_of_single_seasons_and_levels_are_looked_at_instead_of_the_one_that_was_named() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        for name in ["fir.obj", "fir_summer_LOD1.obj", "fir_autumn_LOD0.obj"] {
            fs::write(at(name), "").unwrap();
        }
        let obj = find("obj").unwrap();
        let inquiry = |seasons: &str, levels| Inquiry {
            round: 1,
            targets: vec![Output::new(obj, Options::new(obj.format()), at("fir.obj"))],
            levels,
            seasons: Season::parse_list(seasons).unwrap_or_default(),
            ages: Vec::new(),
            completes: None,
            shown: None,
            sources: Vec::new(),
        };
        let found = |seasons, levels| ask(inquiry(seasons, levels)).targets.remove(0);
        assert_eq!(found("", 1), TargetFinding::Replaces(vec![at("fir.obj")]));
        assert_eq!(found("summer,autumn", 1), TargetFinding::Free);
        let two = vec![at("fir_summer_LOD1.obj"), at("fir_autumn_LOD0.obj")];
        assert_eq!(found("summer,autumn", 2), TargetFinding::Replaces(two));
        assert!(inquiry("summer", 2) != inquiry("summer", 1) && inquiry("", 2) == inquiry("", 2));
        // At several ages each has a file of its name, and the one that was named stays.
        fs::write(at("fir_young.obj"), "").unwrap();
        let aged = Inquiry { ages: vec!["young".to_owned(), "old".to_owned()], ..inquiry("", 1) };
        assert!(aged != inquiry("", 1));
        assert_eq!(ask(aged).targets.remove(0), TargetFinding::Replaces(vec![at("fir_young.obj")]));
    }

    #[test]
    fn an_ending_of_another_format_is_unfit() {
        let dir = tempfile::tempdir().unwrap();
        let found = |format: &str, name: &str| {
            let exporter = portrait::formats().find(format).unwrap();
            let target = Output::new(exporter, Options::new(exporter.format()), dir.path().join(name));
            let (levels, seasons) = (1, Vec::new());
            let inquiry = Inquiry {
                round: 1,
                targets: vec![target],
                levels,
                seasons,
                ages: Vec::new(),
                completes: None,
                shown: None,
                sources: Vec::new(),
            };
            ask(inquiry).targets.remove(0)
        };
        for (format, name) in [("obj", "x.glb"), ("glb", "x.png"), ("svg", "x.obj")] {
            assert!(unfit(&found(format, name)).contains("that ending is of"), "{format} {name}");
        }
        for (format, name) in [
            ("png", "x.jpg"),
            ("png", "x.webp"),
            ("png-sheet", "x.jpg"),
            ("ply-skeleton", "x.ply"),
            ("obj", "x.tree"),
            ("obj", "x"),
        ] {
            assert_eq!(found(format, name), TargetFinding::Free, "{format} {name}");
        }
    }

    #[test]
    fn names_are_completed_with_directories_marked() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["fir.glb", "fig", ".hidden", "oak"] {
            fs::write(dir.path().join(name), "").unwrap();
        }
        fs::create_dir(dir.path().join("fields")).unwrap();
        let base = format!("{}/", dir.path().to_str().unwrap());
        let complete = |start: &str| -> Vec<String> {
            let found = asked(&[], Some(&format!("{base}{start}")), Vec::new()).completions;
            found.iter().map(|line| line.strip_prefix(&base).unwrap().to_owned()).collect()
        };
        assert_eq!(complete("fi"), ["fields/", "fig", "fir.glb"]);
        assert_eq!(complete(""), ["fields/", "fig", "fir.glb", "oak"]);
        assert_eq!(complete("."), [".hidden"]);
        // As it means that name, and no variable.
        fs::write(dir.path().join("$fir"), "").unwrap();
        assert_eq!((complete("$"), complete("$$f")), (vec!["$$fir".to_owned()], vec!["$$fir".to_owned()]));
        assert!(complete("x").is_empty());
        assert!(asked(&[], Some("/nowhere/at/all"), Vec::new()).completions.is_empty());
    }

    #[test]
    fn the_home_directory_keeps_its_short_name() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join("trees")).unwrap();
        let complete = |typed| completions(typed, Some(dir.path()), &Quiet).unwrap();
        assert_eq!(complete("~/t"), ["~/trees/"]);
        assert_eq!(complete("~"), ["~/"]);
    }

    #[test]
    fn a_directory_of_any_size_is_over_soon() {
        let dir = tempfile::tempdir().unwrap();
        for i in 0..MOST_COMPLETIONS + 50 {
            fs::write(dir.path().join(format!("{i:04}")), "").unwrap();
        }
        let typed = format!("{}/", dir.path().to_str().unwrap());
        assert_eq!(completions(&typed, None, &Quiet).unwrap().len(), MOST_COMPLETIONS);
    }

    #[test]
    fn the_reason_comes_without_the_path() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(format!("{}.glb", "x".repeat(300)));
        let found = asked(&[path.to_str().unwrap()], None, Vec::new());
        let TargetFinding::Unfit(why) = &found.targets[0] else { panic!("{:?}", found.targets) };
        assert!(!why.contains("xxx") && why.contains("too long"), "{why}");
    }
}
