//! Files and directories: names that are completed, what is there already, what cannot be written.

use super::*;

#[test]
fn files_that_are_there_are_asked_about() {
    let mut bench = ExportBench::new();
    fs::write(bench.at("older-c.glb"), "before").unwrap();
    bench.keys("e");
    assert!(bench.text(100, 30).contains("replaces a file"));
    assert!(bench.keys("x").is_empty());
    assert_eq!(bench.dialog().start, StartState::Asking);
    let text = bench.text(100, 30);
    assert!(text.contains("Replace the file?") && text.contains("y yes") && text.contains("n no"), "{text}");
    // Enter, which is pressed without reading, is no answer.
    assert!(bench.keys("enter").is_empty());
    assert!(bench.keys("n").is_empty());
    assert_eq!((bench.dialog().start, bench.is_open()), (StartState::Idle, true));
    assert!(bench.keys("y").is_empty(), "nothing is asked any more");
    assert!(bench.keys("x esc").is_empty());
    assert!(bench.is_open(), "Esc is no, and the dialog stays");
    // Moving away takes the question back.
    assert!(bench.keys("x k y").is_empty());
    let order = ExportBench::order(bench.keys("x y"));
    assert_eq!(order.replaces, [Path::new(&bench.at("older-c.glb"))]);
}

#[test]
fn the_answer_is_of_the_moment_that_the_button_was_pressed() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let dialog = bench.dialog();
    assert_eq!(dialog.finding(&dialog.formats[place_of("glb")]), Some(&crate::jobs::TargetFinding::Free));
    fs::write(bench.at("older-c.glb"), "meanwhile").unwrap();
    assert!(bench.keys("x").is_empty());
    assert_eq!(bench.dialog().start, StartState::Asking);
}

#[test]
fn targets_that_cannot_be_written_are_said_in_place() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let glb = place_of("glb");
    bench.go_to(ExportSpot::Target(glb));
    bench.keys("enter");
    fs::write(bench.at("file"), "").unwrap();
    let missing = bench.at("file/none/fir.glb");
    bench.retype(&missing);
    assert!(bench.text(100, 30).contains("is a file, not a directory"), "while it is typed");
    bench.keys("enter g");
    assert!(bench.keys("x").is_empty());
    assert_eq!(bench.dialog().cursor, ExportSpot::Target(glb), "the cursor goes where the fault is");
    let (weight, text) = bench.said();
    assert!(weight == Weight::Warning && text.contains("not a directory"), "{text}");
    // A directory is taken as where the file goes.
    bench.keys("enter");
    let directory = format!("{}/", bench.dir.path().to_str().unwrap());
    bench.retype(&directory);
    bench.keys("enter");
    assert_eq!(bench.dialog().formats[glb].target, bench.at("older-c.glb"));
    // Without its separator it is a file of that name, which cannot be.
    bench.keys("enter");
    bench.retype(directory.trim_end_matches('/'));
    bench.keys("enter x");
    assert!(bench.said().1.contains("is a directory"), "{}", bench.said().1);
    bench.keys("enter");
    bench.retype("");
    bench.keys("enter x");
    assert!(bench.said().1.contains("type where"), "{}", bench.said().1);
}

#[test]
fn a_missing_directory_is_asked_about_and_made() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    let missing = bench.at("not/yet/fir.glb");
    bench.retype(&missing);
    assert!(bench.text(100, 30).contains("would be made"), "while it is typed");
    bench.keys("enter");
    assert!(bench.text(100, 30).contains("in a new directory"));
    assert!(bench.keys("x").is_empty());
    assert!(bench.text(100, 30).contains("Make the directory?"));
    assert!(bench.keys("n").is_empty());
    let order = ExportBench::order(bench.keys("x y"));
    assert!(order.makes_folders && order.replaces.is_empty());
    assert!(!Path::new(&bench.at("not")).exists(), "not before it is exported");
}

#[test]
fn two_formats_cannot_go_to_one_file() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Format(place_of("ply")));
    bench.keys("space");
    bench.go_to(ExportSpot::Format(place_of("ply-skeleton")));
    bench.keys("space");
    bench.go_to(ExportSpot::Target(place_of("ply-skeleton")));
    bench.keys("enter");
    let taken = bench.at("older-c.ply");
    bench.retype(&taken);
    bench.keys("enter");
    assert!(bench.keys("x").is_empty());
    assert!(bench.said().1.contains("another format"), "{}", bench.said().1);
}

#[test]
fn names_are_completed_and_offered() {
    let mut bench = ExportBench::new();
    fs::create_dir_all(bench.dir.path().join("forest/old")).unwrap();
    fs::write(bench.at("fork.glb"), "").unwrap();
    bench.keys("e");
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    let start = bench.at("f");
    bench.retype(&start);
    bench.keys("tab");
    let line = |bench: &ExportBench| bench.dialog().line.as_ref().unwrap().input.value().to_owned();
    assert_eq!(line(&bench), bench.at("for"));
    assert_eq!(bench.dialog().line.as_ref().unwrap().offers, [bench.at("forest/"), bench.at("fork.glb")]);
    assert!(bench.text(100, 30).contains("forest/, fork.glb"), "{}", bench.text(100, 30));
    bench.type_text("e");
    assert!(bench.dialog().line.as_ref().unwrap().offers.is_empty());
    bench.keys("tab");
    assert_eq!(line(&bench), bench.at("forest/"));
    bench.keys("tab");
    assert_eq!(line(&bench), bench.at("forest/old/"));
    bench.type_text("zz");
    bench.keys("tab");
    assert!(bench.dialog().line.as_ref().unwrap().problem.as_ref().unwrap().contains("no name"));
    // What stands behind the cursor stays.
    let start = bench.at("fores");
    bench.retype(&format!("{start}#"));
    bench.keys("left tab");
    assert_eq!(line(&bench), format!("{}#", bench.at("forest/")));
}

#[test]
fn seasons_are_written_again_after_a_question() {
    let mut bench = ExportBench::new();
    let preset = linden::preset::builtin("silver-birch").unwrap().load().unwrap();
    bench.model.tree = Some(Tree::new(TreePlace::Builtin("silver-birch"), Recipe::new(preset)));
    let begin = |bench: &mut ExportBench| {
        bench.keys("e");
        bench.go_to(ExportSpot::Format(place_of("glb")));
        bench.keys("space");
        bench.go_to(ExportSpot::Format(place_of("obj")));
        bench.keys("space");
        bench.go_to(ExportSpot::Seasons);
        bench.keys("enter");
        bench.retype("summer,autumn");
        bench.keys("enter")
    };
    begin(&mut bench);
    let names = ["silver-birch_summer.obj", "silver-birch_autumn.obj"].map(|name| bench.at(name));
    for name in &names {
        fs::write(name, "before").unwrap();
    }
    assert!(bench.keys("x").is_empty());
    assert_eq!(bench.dialog().start, StartState::Asking);
    let text = bench.text(100, 40);
    assert!(text.contains("silver-birch_summer.obj, ") && text.contains("Replace these files?"), "{text}");
    let order = ExportBench::order(bench.keys("y"));
    assert_eq!(order.replaces, names.each_ref().map(Path::new));
}

#[test]
fn a_missing_directory_is_what_is_asked_about() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    let target = bench.at("new/fir.glb");
    bench.retype(&target);
    bench.keys("enter x");
    let text = bench.text(100, 30);
    assert!(text.contains("Make the directory?") && text.contains("would be made"), "{text}");
    assert!(!text.contains("there already"), "{text}");
}
