//! Standard input and output in pipes.

use std::io::Read;
use std::process::Stdio;

use crate::program::{Folder, linden};

#[test]
fn a_dash_reads_standard_input_and_writes_standard_output() {
    let folder = Folder::new();
    let grammar = b"axiom=F\nangle=20\nnumber of derivations=2\nF=(1)F[+F]F\n";
    let obj = folder.run_with(grammar, &["export", "-", "-o", "-", "--format", "obj"]);
    assert_eq!(obj.code, Some(0), "{}", obj.err);
    assert!(obj.out.lines().any(|line| line.starts_with("f ")));
    assert!(!obj.out.contains("mtllib"), "no file can lie beside a pipe");

    let glb = folder.run(&["export", "simple", "-o", "-", "--format", "glb"]).done();
    assert!(glb.bytes.starts_with(b"glTF"));
    let length = u32::from_le_bytes(glb.bytes[8..12].try_into().unwrap());
    assert_eq!(length as usize, glb.bytes.len(), "nothing but the file on standard output");
    assert!(folder.names().is_empty());
}

#[test]
fn a_reader_that_stops_early_is_no_failure() {
    for args in [&["list"][..], &["show", "fir"], &["export", "sphere", "-o", "-", "--format", "obj"]] {
        let mut child = linden().args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut out = child.stdout.take().unwrap();
        out.read_exact(&mut [0; 8]).unwrap();
        drop(out);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_reader_that_stops_early_is_a_failure_where_more_was_to_be_written() {
    let folder = Folder::new();
    let run = |args: &[&str]| {
        let mut child = linden()
            .args(args)
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, said) = run(&["export", "simple", "-o", "real.glb", "-o", "-", "--format", "glb,obj"]);
    assert!(code == Some(1) && said.contains("standard output") && said.contains("has stopped"), "{said}");
    assert!(folder.names().is_empty(), "all outputs or none");
    let (code, said) = run(&["export", "simple", "-o", "-", "--format", "obj"]);
    assert_eq!((code, said.as_str()), (Some(0), ""));
    let (code, said) = run(&["preview", "simple", "-o", "-"]);
    assert_eq!((code, said.as_str()), (Some(0), ""));
}

#[cfg(unix)]
#[test]
fn a_reader_of_a_named_pipe_that_stops_is_a_failure() {
    let folder = Folder::new();
    assert!(std::process::Command::new("mkfifo").arg(folder.file("pipe")).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = folder.file("pipe");
        move || std::fs::File::open(pipe).unwrap().read_exact(&mut [0; 8]).unwrap()
    });
    let said = folder.run(&["export", "simple", "-o", "pipe", "--format", "obj"]);
    reader.join().unwrap();
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.err.contains("pipe") && said.err.contains("has stopped"), "{}", said.err);
}

#[test]
fn nothing_is_said_on_the_way_when_standard_error_is_a_pipe() {
    let said =
        Folder::new().run(&["stats", "sphere", "--set", "points=300000", "--set", "step=0.02", "--json"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""), "no bar, no colours");
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_name_that_is_not_unicode_is_a_file_name() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = Folder::new();
    let name = OsStr::from_bytes(b"b\xe4um.txt");
    std::fs::write(folder.path().join(name), "axiom=F\nangle=20\nnumber of derivations=2\nF=(1)F[+F]F\n")
        .unwrap();
    let output =
        linden().arg("export").arg(name).args(["-o", "x.obj"]).current_dir(folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.read("x.obj").len() > 1000);
}
