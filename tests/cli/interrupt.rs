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

/// Whether the program has a hidden file in the folder: without a name where the system has such files.
fn has_staged(folder: &Folder, child: &Child, before: usize) -> bool {
    let is_ours = |fd: std::fs::DirEntry| {
        std::fs::read_link(fd.path())
            .is_ok_and(|to| to.starts_with(folder.path()) && to.to_string_lossy().ends_with("(deleted)"))
    };
    let open = std::fs::read_dir(format!("/proc/{}/fd", child.id()));
    open.is_ok_and(|open| open.flatten().any(is_ours)) || folder.names().len() > before
}

/// Waits until the program has made its temporary file: then it is at work.
fn wait_until_at_work(folder: &Folder, child: &mut Child, before: usize) {
    let started = Instant::now();
    while !has_staged(folder, child, before) {
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

/// Sends Ctrl-C when the program has begun, and waits for its end.
fn interrupted(mut child: Child) -> std::process::Output {
    std::thread::sleep(Duration::from_millis(1500));
    assert!(child.try_wait().unwrap().is_none(), "it ended before it was interrupted");
    send("INT", &child);
    child.wait_with_output().unwrap()
}

#[test]
fn a_pipe_without_a_reader_is_waited_for_until_an_interrupt() {
    let folder = Folder::new();
    assert!(Command::new("mkfifo").arg(folder.file("pipe")).status().unwrap().success());
    for args in [
        &["export", "older-a", "--format", "glb", "-o", "pipe"][..],
        &["export", "older-a", "--format", "glb,obj", "-o", "pipe", "-o", "real.obj"],
        &["preview", "older-a", "-o", "pipe"],
        &["sheet", "older-a", "-o", "pipe"],
    ] {
        let output = interrupted(start(&folder, args));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{args:?}: {said}");
        assert!(said.contains("pipe is a pipe") && said.contains("waiting"), "{args:?}: {said}");
        assert_eq!(folder.names(), ["pipe"], "{args:?}");
    }
    // With a reader it is what the file would be.
    let reader = std::thread::spawn({
        let pipe = folder.file("pipe");
        move || std::fs::read(pipe).unwrap()
    });
    let child = start(&folder, &["export", "older-a", "--format", "glb", "-o", "pipe"]);
    assert!(child.wait_with_output().unwrap().status.success());
    folder.run(&["export", "older-a", "-o", "file.glb"]).done();
    assert!(reader.join().unwrap() == folder.read("file.glb"));
}

#[test]
fn a_reader_that_has_fallen_asleep_keeps_nobody_from_an_interrupt() {
    let folder = Folder::new();
    for args in [
        &["export", "fir", "-o", "-", "--format", "obj"][..],
        &["preview", "oak", "-o", "-", "--size", "1200x1200"],
    ] {
        let mut child = start(&folder, args);
        // Its other end stays open and is not read.
        let asleep = child.stdout.take();
        let output = interrupted(child);
        assert_eq!(output.status.code(), Some(130), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        drop(asleep);
    }
}

#[test]
fn a_limit_on_the_size_of_files_is_an_error_and_leaves_what_was_there() {
    let folder = Folder::new();
    folder.write("fir.glb", "an older file");
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 64; exec \"$0\" export fir -o fir.glb -o new.obj"])
        .arg(linden().get_program())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("ulimit -f"), "{said}");
    assert_eq!(folder.names(), ["fir.glb"]);
    assert_eq!(folder.read("fir.glb"), b"an older file");
}
