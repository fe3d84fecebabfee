//! Signals while it works.
#![cfg(unix)]

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, linden};

/// Something that takes far longer than the test waits.
const LONG: [&str; 6] = ["export", "sphere", "--set", "points=20000000", "--set", "step=0.01"];

fn start(folder: &Folder, args: &[&str]) -> Child {
    linden()
        .args(args)
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Waits until the program has made its temporary file: then it is at work.
fn wait_until_at_work(folder: &Folder, child: &mut Child, before: usize) {
    let started = Instant::now();
    while folder.names().len() <= before {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was interrupted");
        assert!(started.elapsed() < Duration::from_mins(1), "it never began");
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(100));
}

#[test]
fn an_interrupted_export_leaves_what_was_there() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let folder = Folder::new();
        folder.write("old.glb", "an older file");
        let mut child = start(&folder, &[&LONG[..], &["-o", "old.glb", "-o", "new.obj"]].concat());
        wait_until_at_work(&folder, &mut child, 1);
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{signal}: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(folder.names(), ["old.glb"], "{signal}");
        assert_eq!(folder.read("old.glb"), b"an older file");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn an_interrupt_is_heard_while_nothing_comes_on_standard_input() {
    let folder = Folder::new();
    let mut child = linden()
        .args(["stats", "-"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let open_input = child.stdin.take();
    std::thread::sleep(Duration::from_millis(300));
    send("INT", &child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    drop(open_input);
}
