//! What the dialog keeps for the next time.

use super::*;

#[test]
fn what_was_set_is_there_again_when_the_dialog_opens_on_the_same_tree() {
    let mut bench = ExportBench::new();
    let before = bench.model.exporting.to_session();
    bench.keys("e");
    let (glb, obj) = (place_of("glb"), place_of("obj"));
    bench.go_to(ExportSpot::Format(obj));
    bench.keys("space");
    let target = bench.at("other name.obj");
    bench.go_to(ExportSpot::Target(obj));
    bench.keys("enter");
    bench.retype(&target);
    bench.keys("enter");
    bench.go_to(ExportSpot::Knob(0));
    bench.keys("enter");
    bench.retype("1234");
    bench.keys("enter esc e");
    let dialog = bench.dialog();
    assert!(dialog.formats[obj].chosen && dialog.formats[glb].chosen);
    assert_eq!(dialog.formats[obj].target, target);
    let turned: Vec<_> = dialog.knobs.as_ref().unwrap().turned().collect();
    assert_eq!(turned, [("triangles", "1234".to_owned())]);
    assert_eq!(bench.model.exporting.to_session(), before, "only an export is remembered beyond that");
    bench.keys("ctrl-c");
    bench.model.tree.as_mut().unwrap().place = TreePlace::Builtin("fir");
    bench.keys("e");
    assert!(!bench.dialog().formats[obj].chosen, "another tree has none of it");
}

#[test]
fn the_name_of_a_file_is_kept_for_its_tree_and_is_that_of_the_copied_command() {
    let mut bench = ExportBench::new();
    let glb = place_of("glb");
    bench.keys("e");
    bench.go_to(ExportSpot::Target(glb));
    bench.keys("enter");
    let christmas = bench.at("christmas tree.glb");
    bench.retype(&christmas);
    let effects = bench.keys("enter x");
    let order = ExportBench::order(effects);
    assert_eq!(order.outputs[0].path.to_str(), Some(christmas.as_str()));
    bench.keys("e");
    assert_eq!(bench.dialog().formats[glb].target, christmas);
    bench.keys("esc");
    let effects = bench.keys("y");
    assert!(
        matches!(&effects[..], [Effect::Copy(line)] if line.contains(&format!("'{christmas}'"))),
        "{effects:?}"
    );
    // Another tree has a name of its own, in the same folder.
    let preset = linden::preset::builtin("fir").unwrap().load().unwrap();
    bench.model.tree = Some(Tree::new(TreePlace::Builtin("fir"), Recipe::new(preset)));
    bench.keys("e");
    assert_eq!(bench.dialog().formats[glb].target, bench.at("fir.glb"));
}

#[test]
fn what_was_set_stays_with_the_tree_after_an_export_until_it_is_reverted() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Knob(0));
    bench.keys("enter");
    bench.retype("1234");
    bench.keys("enter");
    assert!(bench.text(100, 30).contains("● triangles 1234: its size is known"), "{}", bench.text(100, 30));
    let triangles = |order: &ExportOrder| tree_of(order).0.preset.dressing.detail.triangles;
    for _ in 0..2 {
        let order = ExportBench::order(bench.keys("x"));
        assert_eq!(triangles(&order), 1234, "the next one is as small");
        bench.send(Msg::Export(ExportNews::Cancelled { number: order.number }));
        bench.keys("e");
    }
    // Saved as one of the user's it is the same tree.
    bench.keys("esc");
    let path = bench.dir.path().join("mine.toml");
    bench.send(Msg::Saved(Ok(("mine".to_owned(), path))));
    bench.keys("e");
    assert!(bench.text(100, 30).contains("● triangles 1234"));
    bench.keys("esc R e");
    assert!(bench.dialog().knobs.as_ref().unwrap().is_idle(), "R takes it back");
}
