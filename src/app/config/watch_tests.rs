use super::*;
use std::os::unix::fs::symlink;

/// Long enough for any machine; only a failing test waits so long.
const PATIENCE: Duration = Duration::from_secs(20);

struct Watched {
    dir: tempfile::TempDir,
    watch: Watch,
    told: Receiver<Vec<PathBuf>>,
}

impl Watched {
    /// Watches `config` in a directory that is prepared first.
    fn new(prepare: impl Fn(&Path)) -> Self {
        let dir = tempfile::tempdir().unwrap();
        prepare(dir.path());
        let (sender, told) = mpsc::channel();
        let (watch, complaints) = Watch::new(&[dir.path().join("config")], move |paths| {
            let _ = sender.send(paths);
        });
        assert_eq!(complaints, []);
        Self { dir, watch, told }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Waits until a path is told; returns all that was told until then.
    fn wait(&self, name: &str) -> BTreeSet<PathBuf> {
        let mut all = BTreeSet::new();
        while !all.contains(&self.at(name)) {
            all.extend(self.told.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("{name} after {all:?}")));
        }
        all
    }

    /// Makes a change that is told for certain and waits for it; returns what was told before and with it.
    fn settle(&self) -> BTreeSet<PathBuf> {
        fs::write(self.at("config/settled.toml"), "").unwrap();
        let mut all = self.wait("config/settled.toml");
        all.remove(&self.at("config/settled.toml"));
        fs::remove_file(self.at("config/settled.toml")).unwrap();
        self.wait("config/settled.toml");
        all
    }
}

fn config(dir: &Path) {
    fs::create_dir_all(dir.join("config/presets/moor")).unwrap();
    fs::write(dir.join("config/presets/moor/a.toml"), "").unwrap();
}

#[test]
fn a_save_is_told_however_an_editor_saves() {
    let watched = Watched::new(config);
    let file = watched.at("config/presets/moor/a.toml");
    fs::write(&file, "written over").unwrap();
    assert_eq!(watched.wait("config/presets/moor/a.toml"), BTreeSet::from([file.clone()]));
    // As vim does: the old one aside, the new one in its place.
    fs::write(watched.at("config/presets/moor/4913"), "").unwrap();
    fs::rename(&file, watched.at("config/presets/moor/a.toml~")).unwrap();
    fs::write(&file, "new").unwrap();
    fs::remove_file(watched.at("config/presets/moor/a.toml~")).unwrap();
    assert_eq!(watched.wait("config/presets/moor/a.toml"), BTreeSet::from([file.clone()]));
    // As most others: a new one beside it, renamed over it.
    fs::write(watched.at("config/presets/moor/.a.tmp"), "newer").unwrap();
    fs::rename(watched.at("config/presets/moor/.a.tmp"), &file).unwrap();
    assert_eq!(watched.wait("config/presets/moor/a.toml"), BTreeSet::from([file.clone()]));
    fs::remove_file(&file).unwrap();
    assert_eq!(watched.wait("config/presets/moor/a.toml"), BTreeSet::from([file]));
}

#[test]
fn reading_is_no_change() {
    let watched = Watched::new(config);
    for _ in 0..10 {
        fs::read(watched.at("config/presets/moor/a.toml")).unwrap();
        fs::read_dir(watched.at("config/presets")).unwrap().count();
    }
    assert_eq!(watched.settle(), BTreeSet::new());
}

#[test]
fn directories_are_waited_for() {
    let watched = Watched::new(|_| {});
    fs::create_dir_all(watched.at("config/presets")).unwrap();
    watched.wait("config");
    fs::write(watched.at("config/config.toml"), "").unwrap();
    watched.wait("config/config.toml");
    fs::create_dir(watched.at("config/presets/new")).unwrap();
    watched.wait("config/presets/new");
    fs::write(watched.at("config/presets/new/b.txt"), "").unwrap();
    watched.wait("config/presets/new/b.txt");
    // Gone and come again, as when a repository is checked out.
    fs::remove_dir_all(watched.at("config")).unwrap();
    watched.wait("config");
    fs::create_dir(watched.at("config")).unwrap();
    watched.wait("config");
    fs::write(watched.at("config/keymap.toml"), "").unwrap();
    watched.wait("config/keymap.toml");
}

#[test]
fn the_current_file_is_told_of_and_nothing_beside_it() {
    let watched = Watched::new(config);
    let (first, second) = (watched.at("trees/first.toml"), watched.at("trees/second.toml"));
    fs::create_dir(watched.at("trees")).unwrap();
    fs::write(&first, "").unwrap();
    fs::write(&second, "").unwrap();
    assert_eq!(watched.watch.also(std::slice::from_ref(&first)), []);
    fs::write(&second, "no matter").unwrap();
    fs::write(&first, "new").unwrap();
    assert_eq!(watched.wait("trees/first.toml"), BTreeSet::from([first.clone()]));
    assert_eq!(watched.watch.also(std::slice::from_ref(&second)), []);
    fs::write(&first, "no matter").unwrap();
    fs::write(&second, "new").unwrap();
    assert_eq!(watched.wait("trees/second.toml"), BTreeSet::from([second.clone()]));
    watched.watch.also(&[]);
    fs::write(&second, "no matter").unwrap();
    assert_eq!(watched.settle(), BTreeSet::new());
    assert_eq!(watched.watch.complaints(), []);
}

#[test]
fn links_are_followed_and_told_by_their_own_name() {
    let watched = Watched::new(|dir| {
        fs::create_dir_all(dir.join("dotfiles/moor")).unwrap();
        fs::create_dir_all(dir.join("config/presets")).unwrap();
        fs::write(dir.join("dotfiles/keymap.toml"), "").unwrap();
        symlink(dir.join("dotfiles/keymap.toml"), dir.join("config/keymap.toml")).unwrap();
        symlink(dir.join("dotfiles/moor"), dir.join("config/presets/moor")).unwrap();
        symlink(dir.join("config"), dir.join("config/presets/loop")).unwrap();
        symlink("circle", dir.join("config/circle")).unwrap();
    });
    fs::write(watched.at("dotfiles/keymap.toml"), "new").unwrap();
    watched.wait("config/keymap.toml");
    fs::write(watched.at("dotfiles/moor/b.toml"), "new").unwrap();
    watched.wait("config/presets/moor/b.toml");
    fs::write(watched.at("dotfiles/other.toml"), "no matter").unwrap();
    let told = watched.settle();
    assert!(!told.iter().any(|path| path.ends_with("other.toml")), "{told:?}");
}

#[test]
fn nothing_is_told_after_the_end() {
    let watched = Watched::new(config);
    let Watched { dir, watch, told } = watched;
    drop(watch);
    fs::write(dir.path().join("config/config.toml"), "").unwrap();
    // The thread ends, and with it the sender.
    assert_eq!(told.recv_timeout(PATIENCE), Err(RecvTimeoutError::Disconnected));
}

#[test]
fn limits_of_the_system_are_said_by_name() {
    let full = notify::Error::new(ErrorKind::MaxFilesWatch);
    assert!(cannot_watch(Path::new("x"), &full).message.contains("max_user_watches"));
    let none = notify::Error::io(std::io::Error::from_raw_os_error(24));
    assert!(cannot_watch(Path::new("x"), &none).message.contains("max_user_instances"));
    let mut state = State::default();
    state.note(Err(full.add_path("a".into())));
    state.note(Err(notify::Error::new(ErrorKind::MaxFilesWatch).add_path("a".into())));
    assert_eq!(state.complaints.len(), 1);
}
