//! Exporters that are programs of their own.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, Said, linden};

/// A folder to work in, and one with a plug-in `linden-export-foo`.
struct Workshop {
    work: Folder,
    programs: Folder,
}

impl Workshop {
    fn new(script: &str) -> Self {
        let workshop = Self { work: Folder::new(), programs: Folder::new() };
        workshop.add("linden-export-foo", script);
        workshop
    }

    fn add(&self, name: &str, script: &str) {
        self.programs.write(name, format!("#!/bin/sh\n{script}\n"));
        let all = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(self.programs.file(name), all).unwrap();
    }

    fn command(&self, args: &[&str]) -> Command {
        let path = std::env::var("PATH").unwrap();
        let mut command = linden();
        command
            .args(args)
            .current_dir(self.work.path())
            .env("PATH", format!("{}:{path}", self.programs.path().display()))
            .stdin(Stdio::null());
        command
    }

    fn run(&self, args: &[&str]) -> Said {
        Said::new(self.command(args).output().unwrap())
    }

    /// A small tree.
    fn export(&self, more: &[&str]) -> Said {
        self.run(&[&["export", "older-a"][..], more].concat())
    }
}

#[test]
fn a_plugin_is_given_the_tree_and_its_recipe() {
    let shop = Workshop::new(
        r#"head -c 4 "$1" > "$2"; cat >> "$2"; printf '%s' "$LINDEN_NAME" > "${2%.foo}_name.txt"; echo unheard"#,
    );
    let said = shop.export(&["-o", "a tree.foo"]).done();
    assert!(said.out.contains("a tree.foo"), "{}", said.out);
    assert!(!said.out.contains("unheard"));
    let names = shop.work.names();
    assert_eq!(names.len(), 2, "{names:?}");
    let file = String::from_utf8(shop.work.read("a tree.foo")).unwrap();
    let recipe: serde_json::Value = serde_json::from_str(file.strip_prefix("glTF").unwrap()).unwrap();
    assert_eq!(recipe["id"], "older-a");
    let side = names.iter().find(|name| name.ends_with("_name.txt")).unwrap();
    assert!(!shop.work.read(side).is_empty());
    // By its name, without an ending, and beside a format of our own.
    shop.export(&["--format", "foo,obj"]).done();
    assert!(shop.work.names().contains(&"older-a.foo".to_owned()));
    // A stream holds one file.
    let piped = shop.export(&["--format", "foo", "-o", "-"]);
    assert_eq!(piped.code, Some(1), "{}", piped.err);
    assert!(piped.err.contains("_name.txt") && piped.out.is_empty(), "{}", piped.err);
    shop.add("linden-export-magic", r#"head -c 4 "$1" > "$2""#);
    let piped = shop.export(&["--format", "magic", "-o", "-"]).done();
    assert_eq!(piped.out, "glTF");
}

#[test]
fn what_a_plugin_does_wrong_is_said_and_leaves_nothing() {
    for (script, expected) in [
        (
            "echo 'no licence for trees' >&2; echo half > \"$2\"; exit 3",
            &["exit status: 3", "no licence"][..],
        ),
        ("exit 0", &["wrote nothing"]),
        ("mkdir \"$2\"", &["wrote nothing"]),
        ("ln -s /etc/passwd \"$2\"", &["wrote nothing"]),
        ("echo x > \"$2\"; echo y > stray.txt", &["left 'stray.txt'"]),
        ("kill -9 $$", &["signal: 9"]),
        ("printf '\\033[2Jgarbage\\377\\n' >&2; exit 1", &["garbage"]),
    ] {
        let shop = Workshop::new(script);
        shop.work.write("old.foo", "an older file");
        let said = shop.export(&["-o", "old.foo", "-o", "new.obj"]);
        assert_eq!(said.code, Some(1), "{script}: {}", said.err);
        for part in expected {
            assert!(said.err.contains(part), "{script}: {} lacks {part}", said.err);
        }
        assert!(said.err.contains("linden-export-foo") && !said.err.contains('\u{1b}'), "{}", said.err);
        assert_eq!(shop.work.names(), ["old.foo"], "{script}");
        assert_eq!(shop.work.read("old.foo"), b"an older file");
    }
}

#[test]
fn plugins_are_listed_beside_our_own_and_never_instead() {
    let shop = Workshop::new("exit 0");
    shop.add("linden-export-obj", "exit 1");
    shop.add("linden-export-Bad Name", "exit 1");
    shop.programs.write("linden-export-plain", "not to be run");
    let listed = shop.run(&["list", "--exporters", "--json"]).done().json();
    let ids: Vec<&str> = listed.as_array().unwrap().iter().map(|row| row["id"].as_str().unwrap()).collect();
    assert!(ids.contains(&"foo") && ids.contains(&"glb"), "{ids:?}");
    assert_eq!(ids.iter().filter(|id| **id == "obj").count(), 1);
    assert!(!ids.contains(&"plain") && ids.iter().all(|id| !id.contains("Bad")), "{ids:?}");
    shop.export(&["-o", "a.obj"]).done();
    let said = shop.export(&["-o", "a.plain"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains(".plain"), "{}", said.err);
}

/// A plug-in at work, and what it has started.
struct AtWork {
    child: std::process::Child,
    sleeper: u32,
    /// Where temporary folders are made.
    temporary: Folder,
}

impl AtWork {
    /// Runs a plug-in that writes the number of a process that it has started to `$LINDEN_TEST_PID`.
    fn start(shop: &Workshop) -> Self {
        let (pid, temporary) = (shop.programs.file("pid"), Folder::new());
        let mut child = shop
            .command(&["export", "older-a", "-o", "a.foo"])
            .env("LINDEN_TEST_PID", &pid)
            .env("TMPDIR", temporary.path())
            .stderr(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        let sleeper = loop {
            let text = std::fs::read_to_string(&pid).unwrap_or_default();
            if let Some(id) = text.strip_suffix('\n').and_then(|text| text.parse::<u32>().ok()) {
                break id;
            }
            assert!(child.try_wait().unwrap().is_none(), "it ended before it was interrupted");
            assert!(begun.elapsed() < Duration::from_mins(1), "it never began");
            std::thread::sleep(Duration::from_millis(10));
        };
        assert_eq!(temporary.names().len(), 1);
        Self { child, sleeper, temporary }
    }

    fn send(&self, signal: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &id]).status().unwrap().success());
    }

    /// The code that linden ends with; what the plug-in has started and its folder end soon.
    fn end(self) -> Option<i32> {
        let output = self.child.wait_with_output().unwrap();
        let begun = Instant::now();
        // Its process may wait to be collected by init; it does not run any more.
        let stat = || std::fs::read_to_string(format!("/proc/{}/stat", self.sleeper)).unwrap_or_default();
        let runs = || Path::new("/proc/self/stat").exists() && !stat().is_empty() && !stat().contains(") Z ");
        while runs() || !self.temporary.names().is_empty() {
            let left = self.temporary.names();
            assert!(begun.elapsed() < Duration::from_mins(1), "it goes on: {} {left:?}", stat());
            std::thread::sleep(Duration::from_millis(10));
        }
        output.status.code()
    }
}

#[test]
fn an_interrupt_ends_a_plugin_and_what_it_started() {
    let shop = Workshop::new("sleep 300 & echo $! > \"$LINDEN_TEST_PID\"; wait");
    let work = AtWork::start(&shop);
    work.send("INT");
    assert_eq!(work.end(), Some(130));
    assert_eq!(shop.work.names(), [""; 0]);
}

#[test]
fn a_second_interrupt_and_a_kill_end_even_a_plugin_that_hears_nothing() {
    let shop = Workshop::new("trap '' TERM; sleep 300 & echo $! > \"$LINDEN_TEST_PID\"; wait");
    let work = AtWork::start(&shop);
    work.send("INT");
    std::thread::sleep(Duration::from_millis(300));
    work.send("INT");
    assert_eq!(work.end(), Some(130));
    std::fs::remove_file(shop.programs.file("pid")).unwrap();
    let work = AtWork::start(&shop);
    work.send("KILL");
    assert_eq!(work.end(), None);
    assert_eq!(shop.work.names(), [""; 0]);
}

#[test]
fn the_shell_example_works() {
    let shop = Workshop::new("exit 1");
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../exporters/examples/linden-export-tgz");
    shop.add("linden-export-tgz", &std::fs::read_to_string(example).unwrap());
    shop.export(&["-o", "a.tgz"]).done();
    let listed = Command::new("tar").args(["-tzf", "a.tgz"]).current_dir(shop.work.path()).output().unwrap();
    let listed = String::from_utf8(listed.stdout).unwrap();
    assert!(listed.contains("a.glb") && listed.contains("recipe.json"), "{listed}");
}
