//! Knobs, programs and ages that are chosen for one export, and the command that does the same.

use crate::tui::layout::Pane;

use super::*;

#[test]
fn knobs_are_turned_for_one_export_and_its_size_is_not_promised() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    assert!(bench.text(100, 50).contains(" vertices, "));
    bench.go_to(ExportSpot::Knob(0));
    bench.keys("enter");
    bench.retype("90x");
    bench.keys("enter");
    assert!(bench.dialog().line.as_ref().unwrap().problem.is_some(), "that is no number");
    bench.retype("90");
    bench.keys("enter");
    let text = bench.text(100, 50);
    assert!(text.contains("●triangles") && text.contains("90") && !text.contains(" vertices, "), "{text}");
    let tree = bench.model.tree.as_ref().unwrap();
    assert!(!tree.is_modified(), "the tree on screen is as it was");
    let target = bench.at("few.glb");
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    bench.retype(&target);
    bench.keys("enter");
    let order = ExportBench::order(bench.keys("x"));
    let (recipe, shown) = tree_of(&order);
    assert_eq!((recipe.preset.dressing.detail.triangles, shown.is_none()), (90, true));
    assert!(order.turned.contains(&"triangles"));
    // What is set back is the tree again.
    bench.keys("e");
    bench.go_to(ExportSpot::Knob(0));
    bench.keys("enter");
    bench.retype("0");
    bench.keys("enter");
    let text = bench.text(100, 50);
    assert!(!text.contains('●') && text.contains(" vertices, "), "{text}");
    bench.go_to(ExportSpot::Knob(1));
    bench.keys("right");
    assert!(bench.text(100, 50).contains("●lods"));
    bench.keys("left");
    assert!(!bench.text(100, 50).contains('●'));
}

/// The place of an option of a format.
fn option_of(format: &str, name: &str) -> ExportSpot {
    let place = place_of(format);
    let options = crate::tui::export::formats()[place].format().options;
    ExportSpot::Option(place, options.iter().position(|spec| spec.knob.name == name).unwrap())
}

fn value_of(bench: &ExportBench, format: &str, name: &str) -> String {
    let ExportSpot::Option(i, k) = option_of(format, name) else { panic!() };
    bench.dialog().formats[i].option(k).unwrap().1.to_string()
}

#[test]
fn a_picture_is_seen_as_on_screen_where_that_was_turned() {
    let mut bench = ExportBench::new();
    let shown = bench.model.tree.as_ref().unwrap().shown.clone().unwrap();
    crate::tui::picture::first_look(&mut bench.model, &shown);
    let seen = |bench: &ExportBench| {
        ["yaw", "pitch", "zoom", "look", "color"].map(|name| value_of(bench, "png", name))
    };
    bench.keys("e");
    assert_eq!(seen(&bench), ["auto", "8", "1", "surface", "wood"], "nothing was turned");
    bench.keys("esc tab right up + c");
    assert_eq!(bench.model.focus, Pane::Picture);
    let camera = bench.model.picture.camera;
    bench.keys("e");
    let [yaw, pitch, zoom, look, color] = seen(&bench);
    assert_eq!((yaw, pitch), (camera.yaw_deg.to_string(), camera.pitch_deg.to_string()));
    assert_eq!((zoom.as_str(), look.as_str(), color.as_str()), ("1.2", "skeleton", "order"));
    bench.go_to(ExportSpot::Format(place_of("png")));
    bench.keys("space");
    bench.go_to(option_of("png", "zoom"));
    assert!(bench.text(100, 50).contains("as on screen"));
    // What is typed counts, and what was only seen is not kept for next time.
    bench.keys("enter");
    bench.retype("3");
    bench.keys("enter x");
    let export = bench.model.exporting.to_session();
    assert_eq!(export.options, [("png.zoom".to_owned(), "3".to_owned())]);
}

#[test]
fn the_copied_command_makes_the_files_of_the_dialog() {
    let mut bench = ExportBench::new();
    bench.model.tree.as_mut().unwrap().set("seed", "7", Instant::now()).unwrap();
    bench.keys("e");
    bench.go_to(ExportSpot::Format(place_of("ply-skeleton")));
    bench.keys("space");
    bench.go_to(option_of("glb", "pictures"));
    bench.keys("space");
    bench.go_to(ExportSpot::Knob(0));
    bench.keys("enter");
    bench.retype("1234");
    bench.keys("enter");
    bench.go_to(ExportSpot::Seasons);
    bench.keys("enter");
    bench.retype("summer,bare");
    bench.keys("enter");
    // Above the button, behind more rows than `go_to` goes along.
    bench.keys("G k space esc");
    let effects = bench.keys("y");
    let [Effect::Copy(line)] = &effects[..] else { panic!("{effects:?}") };
    let words = shell_words::split(line).unwrap();
    let skeleton = bench.at(&linden_exporters::default_name(
        "older-c",
        crate::tui::export::formats()[place_of("ply-skeleton")],
    ));
    let glb = bench.at("older-c.glb");
    let mut wanted = vec!["linden", "export", "older-c", "-o", &glb, "-o", &skeleton];
    // In the order of the registry.
    if place_of("ply-skeleton") < place_of("glb") {
        (wanted[4], wanted[6]) = (&skeleton, &glb);
    }
    wanted.extend(["--set", "seed=7", "--set", "triangles=1234", "--set", "glb.pictures=false"]);
    wanted.extend(["--seasons", "summer,bare", "--scene"]);
    let plain: Vec<&str> = words.iter().map(String::as_str).filter(|word| *word != "--format").collect();
    let plain: Vec<&str> =
        plain.into_iter().filter(|word| !word.contains("glb,") && !word.contains(",glb")).collect();
    assert_eq!(plain, wanted);
}

#[test]
fn a_program_sets_what_suits_it_and_the_copied_command_says_so() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let glb = place_of("glb");
    let value = |bench: &ExportBench, name: &str| {
        bench.dialog().formats[glb].options.value(name).map(ToString::to_string).unwrap()
    };
    bench.go_to(option_of("glb", "pictures"));
    bench.keys("space");
    bench.go_to(ExportSpot::Client);
    assert!(bench.text(100, 30).contains("‹ any program ›"), "{}", bench.text(100, 30));
    bench.keys("right right");
    assert_eq!(bench.dialog().client.map(|client| client.id), Some("godot"));
    assert_eq!((value(&bench, "lods"), value(&bench, "wind_as")), ("files".to_owned(), "packed".to_owned()));
    // What is set by hand holds against it, and is told; what suits it is not.
    bench.go_to(option_of("glb", "lods"));
    bench.keys("right");
    let by_hand = value(&bench, "lods");
    bench.keys("esc");
    let effects = bench.keys("y");
    let [Effect::Copy(line)] = &effects[..] else { panic!("{effects:?}") };
    assert!(line.contains("--for godot") && line.contains("glb.pictures=false"), "{line}");
    assert!(line.contains(&format!("glb.lods={by_hand}")) && !line.contains("wind_as"), "{line}");
    // Opened again it is there; without a program only that is left which was set by hand.
    bench.keys("e");
    bench.go_to(ExportSpot::Client);
    bench.keys("left left");
    assert!(bench.dialog().client.is_none());
    assert_eq!((value(&bench, "lods"), value(&bench, "pictures")), (by_hand, "false".to_owned()));
    assert_ne!(value(&bench, "wind_as"), "packed");
    // Of slicers the plant is told, and that they do not read what is ticked.
    bench.keys("left");
    assert!(bench.text(100, 30).contains("not known to read glb: write 3mf"), "{}", bench.text(100, 30));
    let order = ExportBench::order(bench.keys("x"));
    let knobs = tree_of(&order).0.preset.knobs();
    let junction =
        knobs.iter().find(|(row, _)| row.knob.name == "junction").map(|(_, value)| value.to_string());
    assert_eq!(junction.as_deref(), Some("watertight"));
}

#[test]
fn what_a_program_sets_counts_as_set_by_nobody_and_what_a_user_set_before_holds() {
    let mut bench = ExportBench::new();
    bench.model.tree.as_mut().unwrap().set("junction", "blend", Instant::now()).unwrap();
    bench.keys("e");
    let glb = place_of("glb");
    bench.go_to(option_of("glb", "collision"));
    bench.keys("left");
    let by_hand = value_of(&bench, "glb", "collision");
    assert_ne!(by_hand, "capsules");
    bench.go_to(ExportSpot::Client);
    bench.keys("right right");
    let options = &bench.dialog().formats[glb].options;
    assert_eq!(value_of(&bench, "glb", "collision"), by_hand);
    assert!(options.is_asked("collision") && !options.is_asked("wind_as") && !options.is_asked("lods"));
    // Also when it is written, and the next time.
    let order = ExportBench::order(bench.keys("x"));
    let options = &order.outputs[0].options;
    assert!(options.is_word("wind_as", "packed") && !options.is_asked("wind_as"));
    let export = bench.model.exporting.to_session();
    let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    assert_eq!(export.options, [pair("for", "godot"), pair("glb.collision", &by_hand)]);
    bench.model.exporting = Exporting::default();
    bench.model.exporting.remember(&Session { export, ..Session::default() });
    bench.keys("e");
    let options = &bench.dialog().formats[glb].options;
    assert!(options.is_word("wind_as", "packed") && !options.is_asked("wind_as"));
    assert_eq!(value_of(&bench, "glb", "collision"), by_hand);
    // Of the plant, too: what is turned on screen holds.
    bench.go_to(ExportSpot::Client);
    bench.keys("left left left");
    assert_eq!(bench.dialog().client.map(|client| client.id), Some("print"));
    let knobs = bench.dialog().knobs.as_ref().unwrap();
    assert!(knobs.turned().all(|(name, _)| name != "junction"));
    assert!(!bench.dialog().formats[glb].options.is_word("wind_as", "packed"));
}

#[test]
fn ages_are_of_one_tree_and_go_when_its_age_is_turned() {
    let ages = |bench: &mut ExportBench| {
        bench.keys("e");
        let ages = bench.dialog().ages.clone();
        bench.keys("esc");
        ages
    };
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Ages);
    bench.keys("enter");
    bench.retype("half=0.5");
    bench.keys("enter");
    let order = ExportBench::order(bench.keys("x"));
    assert_eq!(order.ages.len(), 1);
    assert_eq!(ages(&mut bench), "half=0.5", "the same tree has them again");
    let kept = bench.model.exporting.kept.clone();
    bench.model.tree.as_mut().unwrap().place = TreePlace::Builtin("fir");
    assert_eq!(ages(&mut bench), "", "another has them not");
    bench.model.exporting.kept = kept;
    let tree = bench.model.tree.as_mut().unwrap();
    tree.place = TreePlace::Builtin("older-c");
    tree.set("derivations", "1", Instant::now()).unwrap();
    assert_eq!(ages(&mut bench), "", "nor is one shown that is not written");
}

#[test]
fn several_ages_are_written_and_copied() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Ages);
    bench.keys("enter");
    bench.retype("half");
    bench.keys("enter");
    assert!(bench.dialog().line.is_some(), "no age of this plant");
    bench.retype("half=0.5, whole=1");
    bench.keys("enter");
    assert!(bench.text(100, 30).contains("● ages half=0.5, whole=1"), "{}", bench.text(100, 30));
    fs::write(bench.at("older-c_half.glb"), "before").unwrap();
    bench.keys("esc");
    let effects = bench.keys("y");
    assert!(
        matches!(&effects[..], [Effect::Copy(line)] if line.contains("--ages 'half=0.5, whole=1'")),
        "{effects:?}"
    );
    bench.keys("e");
    let order = ExportBench::order(bench.keys("x y"));
    assert_eq!(order.replaces, [Path::new(&bench.at("older-c_half.glb"))]);
    let names: Vec<&str> = order.ages.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["half", "whole"]);
    assert!(order.ages[0].1.preset != order.ages[1].1.preset);
    // A tree whose age is turned cannot have several.
    bench.keys("R");
    bench.model.tree.as_mut().unwrap().set("derivations", "1", Instant::now()).unwrap();
    bench.keys("e");
    assert!(bench.dialog().chosen_ages().is_empty());
    bench.go_to(ExportSpot::Ages);
    bench.keys("enter");
    bench.retype("half=0.5");
    bench.keys("enter");
    assert!(bench.text(100, 30).contains("'derivations' is turned"), "{}", bench.text(100, 30));
}
