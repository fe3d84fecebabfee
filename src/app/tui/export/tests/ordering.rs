//! What is ordered when the button is pressed, in which turn, and what is told of it.

use std::time::Duration;

use crate::jobs::run_export;

use super::*;

#[test]
fn without_a_tree_the_command_says_why() {
    let mut model = empty_model();
    let now = model.now;
    update(&mut model, Msg::Input(Event::Key(KeyCode::Char('e').into())), now);
    assert!(model.dialogs.is_empty());
    assert_eq!(model.message.unwrap().text, "Export: no preset is chosen");
}

#[test]
fn the_first_time_one_file_goes_to_the_current_directory() {
    let mut bench = ExportBench::new();
    bench.model.exporting = Exporting::default();
    bench.keys("e");
    let chosen: Vec<_> = bench.dialog().chosen().map(|choice| choice.target.clone()).collect();
    assert_eq!(chosen, ["older-c.glb"]);
    assert_eq!(bench.dialog().cursor, ExportSpot::Format(place_of("glb")));
}

#[test]
fn two_formats_an_option_and_a_target_are_ordered_as_chosen() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let (ply, glb) = (place_of("ply"), place_of("glb"));
    bench.go_to(ExportSpot::Format(ply));
    bench.keys("space j j right k enter");
    assert_eq!(bench.dialog().context(), dialog::LINE);
    let target = bench.at("q x/jk.ply");
    fs::create_dir(bench.dir.path().join("q x")).unwrap();
    bench.retype(&target);
    assert_eq!(bench.dialog().formats[ply].target, bench.at("older-c.ply"), "not yet");
    bench.keys("enter");
    bench.go_to(ExportSpot::Option(glb, 0));
    bench.keys("space");
    let order = ExportBench::order(bench.keys("G enter"));
    assert!(!bench.is_open());

    assert_eq!(formats(&order), ["ply", "glb"]);
    assert_eq!(order.outputs[0].path, Path::new(&target));
    assert_eq!(order.outputs[1].path, Path::new(&bench.at("older-c.glb")));
    let values =
        |i: usize| order.outputs[i].options.iter().map(|(n, v)| format!("{n}={v}")).collect::<Vec<_>>();
    assert_eq!(values(0), ["encoding=ascii"]);
    // All others as they are by themselves.
    let usual = order.outputs[1].exporter.format().options.iter().map(|option| match option.knob.name {
        "pictures" => "pictures=false".to_owned(),
        name => format!("{name}={}", option.default),
    });
    assert_eq!(values(1), usual.collect::<Vec<_>>());
    let tree = bench.model.tree.as_ref().unwrap();
    let (recipe, shown) = tree_of(&order);
    assert!(Arc::ptr_eq(recipe, tree.wanted()));
    assert!(Arc::ptr_eq(shown.unwrap(), tree.shown.as_ref().unwrap()));
    assert!(order.replaces.is_empty());

    // What was chosen is there next time, also through a session.
    let export = bench.model.exporting.to_session();
    assert_eq!(export.formats, ["ply", "glb"]);
    assert_eq!(export.targets, [target.clone(), bench.at("older-c.glb")]);
    let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    assert_eq!(export.options, [pair("ply.encoding", "ascii"), pair("glb.pictures", "false")]);
    bench.model.exporting = Exporting::default();
    bench.model.exporting.remember(&Session { export: export.clone(), ..Session::default() });
    bench.keys("e");
    assert_eq!(bench.dialog().formats[ply].target, bench.at("q x/older-c.ply"), "its own directory");
    assert_eq!(bench.dialog().choices().options, export.options);
    assert_eq!(bench.dialog().choices().formats, export.formats);
}

#[test]
fn a_tree_that_still_grows_is_ordered_without_one_that_is_older() {
    let mut bench = ExportBench::new();
    bench.model.tree.as_mut().unwrap().set("seed", "99", Instant::now()).unwrap();
    bench.keys("e");
    let order = ExportBench::order(bench.keys("x"));
    let (recipe, shown) = tree_of(&order);
    assert!(shown.is_none());
    assert_eq!(recipe.preset.seed(), 99);
}

#[test]
fn no_format_is_nothing_to_export() {
    let mut bench = ExportBench::new();
    bench.keys("e space");
    assert!(bench.keys("x").is_empty());
    assert!(bench.said().1.contains("no format is chosen"));
}

/// Carries an order out as its lane does.
fn carried_out(order: ExportOrder) -> Msg {
    let said = std::cell::RefCell::new(Vec::new());
    run_export(order, &Quiet, &|news| said.borrow_mut().push(news));
    Msg::Export(said.into_inner().pop().unwrap())
}

#[test]
fn what_is_done_is_told_and_listed() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.go_to(ExportSpot::Format(place_of("obj")));
    bench.keys("space");
    assert!(bench.model.command_of(Shortcut::char('X')).is_none(), "a dialog is open");
    let order = ExportBench::order(bench.keys("x"));
    assert!(bench.model.exporting.is_running());
    let number = order.number;
    bench.send(Msg::Export(ExportNews::Progress { doing: Phase::Write, done: 420 }));
    let text = bench.text(100, 30);
    assert!(text.contains("writing older-c.obj +1 ████░░░░░░ 42 %"), "{text}");
    bench.send(carried_out(order));
    assert!(!bench.model.exporting.is_running() && status(&bench.model, 50).is_empty());
    let (weight, text) = bench.said();
    assert_eq!(weight, Weight::Note);
    assert!(text.contains(&bench.at("older-c.obj")) && text.contains("and 4 more"), "{text}");
    bench.keys("F");
    let text = bench.text(100, 30);
    assert!(text.contains("Exported files") && text.contains("5 files"), "{text}");
    for name in ["older-c.obj", "older-c.mtl", "older-c_bark.png", "older-c.glb"] {
        assert!(text.contains(&format!("DIR/{name}")), "{text}");
        assert!(Path::new(&bench.at(name)).exists());
    }
    // News of an order that has ended change nothing.
    bench.send(Msg::Export(ExportNews::Cancelled { number }));
    assert!(!bench.model.exporting.is_running());
}

#[test]
fn pictures_are_formats_with_the_size_and_the_recipe_that_was_asked_for() {
    let mut bench = ExportBench::new();
    bench.keys("e space");
    for (format, options) in [("png", &["height", "width"][..]), ("svg", &["width"])] {
        let place = place_of(format);
        bench.go_to(ExportSpot::Format(place));
        bench.keys("space");
        for (option, pixels) in options.iter().zip(["50", "40"]) {
            let specs = bench.dialog().formats[place].exporter.format().options;
            let at = specs.iter().position(|spec| spec.knob.name == *option).unwrap();
            bench.go_to(ExportSpot::Option(place, at));
            bench.keys("enter");
            bench.retype(pixels);
            bench.keys("enter");
        }
    }
    assert!(bench.text(100, 60).contains("size unknown"), "{}", bench.text(100, 60));
    bench.go_to(ExportSpot::Option(place_of("png"), 1));
    bench.keys("right");
    let order = ExportBench::order(bench.keys("x"));
    assert_eq!(formats(&order), ["png", "svg"]);
    bench.send(carried_out(order));
    let report = &bench.model.exporting.reports[0];
    assert_eq!(report.notes, ["png.color changes nothing: it is for png.look=skeleton"]);
    let listed: Vec<_> = report.files.iter().map(|(path, _)| path.clone()).collect();
    assert_eq!(listed, ["older-c.png", "older-c.svg"].map(|name| bench.dir.path().join(name)));

    let shown = bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap();
    let recipe = shown.recipe.to_line_of(shown.grown.hash());
    for path in &listed {
        let mut file = std::io::BufReader::new(fs::File::open(path).unwrap());
        assert_eq!(linden_exporters::recipe_in(&mut file).unwrap().as_ref(), Some(&recipe));
    }
    let png = fs::read(&listed[0]).unwrap();
    let sides: Vec<u32> = png[16..24].chunks(4).map(|b| u32::from_be_bytes(b.try_into().unwrap())).collect();
    assert_eq!(sides, [40, 50]);
    let svg = fs::read_to_string(&listed[1]).unwrap();
    assert!(svg.lines().next().unwrap().contains("width=\"50\" height=\"1000\""), "{svg:.200}");
}

#[test]
fn exports_wait_in_line_and_cancelling_lets_the_next_one_go() {
    let mut bench = ExportBench::new();
    assert!(bench.keys("X").is_empty());
    assert!(bench.said().1.contains("nothing is being exported"));
    bench.keys("e");
    let first = ExportBench::order(bench.keys("x"));
    bench.keys("e");
    assert!(bench.keys("x").is_empty());
    assert!(!bench.is_open() && bench.said().1.contains("waits"));
    let effects = bench.keys("X");
    let [Effect::CancelExport, Effect::Export(second)] = &effects[..] else { panic!("{effects:?}") };
    assert!(second.number > first.number);
    // The first one says late that it ended, and the second is still under way.
    bench.send(Msg::Export(ExportNews::Cancelled { number: first.number }));
    assert!(bench.model.exporting.is_running());
    let news = ExportNews::Failed { number: second.number, why: "full".into() };
    assert!(bench.send(Msg::Export(news)).is_empty());
    assert!(!bench.model.exporting.is_running());
    assert_eq!(bench.said(), (Weight::Error, "full; the export failed, nothing was written"));

    for _ in 0..=MOST_WAITING {
        bench.keys("e x");
    }
    bench.keys("e x");
    assert!(bench.is_open() && bench.said().1.contains("wait already"));
    // Each end begins the next, a panic too.
    let effects = bench.send(Msg::Export(ExportNews::Broken("oops".into())));
    assert!(matches!(effects[..], [Effect::Export(_)]));
    assert!(bench.said().1.contains("fault in linden"));
}

#[test]
fn leaving_while_it_runs_is_asked_about() {
    let mut bench = ExportBench::new();
    assert!(matches!(bench.keys("q")[..], [Effect::Quit]));
    bench.keys("e x");
    assert!(bench.keys("q").is_empty());
    assert!(bench.said().1.contains("once more"));
    assert!(matches!(bench.keys("q")[..], [Effect::Quit]));
    assert!(matches!(bench.keys("ctrl-c")[..], [Effect::Quit]));
    bench.model.now += Duration::from_secs(8);
    assert!(bench.keys("ctrl-c").is_empty(), "asked too long ago");
}

#[test]
fn what_was_exported_says_its_triangles() {
    let mut bench = ExportBench::new();
    bench.keys("e x");
    let files = vec![("/a/fir.glb".into(), 1 << 20)];
    let triangles = vec![19_964, 6700];
    bench.send(Msg::Export(ExportNews::Done { number: 1, files, triangles, notes: Vec::new() }));
    assert_eq!(bench.said().1, "exported /a/fir.glb, 1.00 MiB, 19 964 / 6 700 triangles");
    bench.keys("F");
    assert!(bench.text(100, 30).contains("1 file, 1.00 MiB, 19 964 / 6 700 triangles"));
}
