use std::fs;
use std::path::Path;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use crossterm::event::{Event, KeyCode, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use linden::Quiet;
use linden::monitor::Phase;
use linden::recipe::Recipe;
use linden_terminal::input::Shortcut;
use linden_terminal::probe::{Capabilities, Environment, Findings, Overrides};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use tempfile::TempDir;

use super::*;
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::session::{self, Session};
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::jobs::{Answer, Done, Lane, ShownTree, grow_shown, look, run_export};
use crate::tui::command::Context;
use crate::tui::commands;
use crate::tui::dialog::Dialog;
use crate::tui::layout::{Pane, Target, View};
use crate::tui::model::{Config, Weight};
use crate::tui::screen;
use crate::tui::testing::key_event;
use crate::tui::tree::{Tree, TreePlace};
use crate::tui::update::{Msg, update};

/// A workbench with a tree that has grown, and a directory to export to.
struct ExportBench {
    model: Model,
    dir: TempDir,
    asked: Option<Inquiry>,
}

fn grown(recipe: &Arc<Recipe>) -> Arc<ShownTree> {
    let (sender, answers) = mpsc::channel();
    let lane = Lane::start(
        "test",
        move |answer: Answer<Result<Arc<ShownTree>, String>>| drop(sender.send(answer.done)),
        |recipe: Arc<Recipe>, watcher, give| give(grow_shown(&recipe, watcher).unwrap()),
    )
    .unwrap();
    lane.submit(Arc::clone(recipe));
    let value = |said| if let Done::Value(shown) = said { Some(shown) } else { None };
    answers.iter().find_map(value).unwrap().unwrap()
}

fn empty_model() -> Model {
    let config = Config {
        dirs: Dirs::default(),
        theme: Theme::dark(),
        keymap: Keymap::defaults(&commands::key_table()),
        settings: Settings::default(),
        complaints: Vec::new(),
    };
    let terminal =
        Capabilities::conclude(&Findings::default(), &Environment::default(), &Overrides::default());
    Model::new(commands::ALL, config, terminal, (100, 30), Instant::now())
}

impl ExportBench {
    fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let mut model = empty_model();
        let preset = linden::preset::builtin("older-c").unwrap().load().unwrap();
        let mut tree = Tree::new(TreePlace::Builtin("older-c"), Recipe::new(preset));
        tree.shown = Some(grown(tree.wanted()));
        model.tree = Some(tree);
        let last = dir.path().join("last.glb").to_str().unwrap().to_owned();
        let export =
            session::ExportChoices { targets: vec![last], formats: vec!["glb".into()], options: vec![] };
        model.exporting.remember(&Session { export, ..Session::default() });
        Self { model, dir, asked: None }
    }

    fn send(&mut self, msg: Msg) -> Effects {
        let now = self.model.now;
        let mut effects = update(&mut self.model, msg, now);
        // As the runtime does: what the model wants to know is found out.
        while let Some(wanted) = wanted(&self.model)
            && self.asked.as_ref() != Some(&wanted)
        {
            self.asked = Some(wanted.clone());
            let said = std::cell::RefCell::new(Vec::new());
            look(wanted, &Quiet, &|news| said.borrow_mut().push(news));
            for news in said.into_inner() {
                effects.extend(update(&mut self.model, Msg::Export(news), now));
            }
        }
        effects
    }

    /// Presses keys, named as in keymaps, one after another.
    fn keys(&mut self, keys: &str) -> Effects {
        let mut effects = Effects::new();
        for key in keys.split_whitespace() {
            effects.extend(self.send(Msg::Input(key_event(key))));
        }
        effects
    }

    fn type_text(&mut self, text: &str) {
        for c in text.chars() {
            self.send(Msg::Input(Event::Key(KeyCode::Char(c).into())));
        }
    }

    /// Replaces what stands in the line.
    fn retype(&mut self, text: &str) {
        self.keys("ctrl-u");
        self.type_text(text);
    }

    fn dialog(&self) -> &ExportDialog {
        self.model.dialogs.top().expect("the dialog is open")
    }

    fn is_open(&self) -> bool {
        !self.model.dialogs.is_empty()
    }

    fn at(&self, name: &str) -> String {
        self.dir.path().join(name).to_str().unwrap().to_owned()
    }

    fn go_to(&mut self, wanted: ExportSpot) {
        self.keys("g");
        for _ in 0..90 {
            if self.dialog().cursor == wanted {
                return;
            }
            self.keys("j");
        }
        panic!("{wanted:?} is not in the list");
    }

    fn said(&self) -> (Weight, &str) {
        let message = self.model.message.as_ref().unwrap();
        (message.weight, &message.text)
    }

    /// The only order among some effects.
    fn order(mut effects: Effects) -> ExportOrder {
        assert_eq!(effects.len(), 1, "{effects:?}");
        match effects.remove(0) {
            Effect::Export(order) => order,
            other => panic!("{other:?}"),
        }
    }

    fn screen(&mut self, columns: u16, rows: u16) -> (Buffer, View) {
        self.send(Msg::Resized(columns, rows));
        let mut buffer = Buffer::empty(Rect::new(0, 0, columns, rows));
        let view = screen::view(&self.model, &mut buffer);
        self.model.regions.clone_from(&view.regions);
        (buffer, view)
    }

    fn text(&mut self, columns: u16, rows: u16) -> String {
        let text = text_of(&self.screen(columns, rows).0);
        // The directory has another name each time.
        text.replace(self.dir.path().to_str().unwrap(), "DIR")
    }

    fn click(&mut self, wanted: Target) -> Effects {
        let (_, view) = self.screen(100, 56);
        let (area, _) = *view.regions.iter().rev().find(|(_, target)| *target == wanted).unwrap();
        let kind = MouseEventKind::Down(MouseButton::Left);
        let (column, row) = (area.x + 1, area.y);
        let mouse = MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE };
        self.send(Msg::Input(Event::Mouse(mouse)))
    }

    fn click_spot(&mut self, spot: ExportSpot) -> Effects {
        let row = self.dialog().spots().iter().position(|other| *other == spot).unwrap();
        self.click(Target::Dialog(Some(row)))
    }
}

fn text_of(buffer: &Buffer) -> String {
    let mut text = String::new();
    for y in 0..buffer.area.height {
        let mut line: String = (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect();
        line.truncate(line.trim_end().len());
        text += &line;
        text.push('\n');
    }
    text
}

fn place_of(format: &str) -> usize {
    super::formats().iter().position(|exporter| exporter.format().id == format).unwrap()
}

fn tree_of(order: &ExportOrder) -> (&Arc<Recipe>, Option<&Arc<ShownTree>>) {
    match &order.subject {
        ExportSubject::Tree { recipe, shown } => (recipe, shown.as_ref()),
        ExportSubject::Forest(forest) => panic!("{}", forest.id),
    }
}

fn formats(order: &ExportOrder) -> Vec<&'static str> {
    order.outputs.iter().map(|output| output.exporter.format().id).collect()
}

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
fn no_format_is_nothing_to_export() {
    let mut bench = ExportBench::new();
    bench.keys("e space");
    assert!(bench.keys("x").is_empty());
    assert!(bench.said().1.contains("no format is chosen"));
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
    assert!(bench.text(100, 30).contains("forest/  fork.glb"), "{}", bench.text(100, 30));
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
fn esc_leaves_the_line_and_then_the_dialog_and_nothing_is_kept() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let before = bench.model.exporting.to_session();
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    bench.retype("x q j k.glb");
    bench.keys("esc");
    assert_eq!(bench.dialog().formats[place_of("glb")].target, bench.at("older-c.glb"));
    bench.keys("esc");
    assert!(!bench.is_open());
    assert_eq!(bench.model.exporting.to_session(), before);
}

#[test]
fn pasted_text_goes_into_the_line_only() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    bench.send(Msg::Input(Event::Paste("x".into())));
    assert!(bench.is_open());
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter ctrl-u");
    bench.send(Msg::Input(Event::Paste("~/a\u{1b}b.glb\n".into())));
    bench.keys("enter");
    assert_eq!(bench.dialog().formats[place_of("glb")].target, "~/ab.glb");
}

#[test]
fn the_mouse_ticks_turns_types_and_presses() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let ply = place_of("ply");
    bench.click_spot(ExportSpot::Format(ply));
    assert!(bench.dialog().formats[ply].chosen);
    bench.click_spot(ExportSpot::Option(ply, 0));
    assert_eq!(bench.dialog().formats[ply].option(0).unwrap().1.to_string(), "ascii");
    bench.click_spot(ExportSpot::Target(ply));
    let typed = bench.at("clicked.ply");
    bench.retype(&typed);
    // A click elsewhere takes what was typed.
    fs::write(&typed, "before").unwrap();
    assert!(bench.click_spot(ExportSpot::Start).is_empty());
    assert_eq!(bench.dialog().start, StartState::Asking);
    let order = ExportBench::order(bench.click(Target::Command("export-yes")));
    assert_eq!(order.outputs[0].path, Path::new(&typed));
    assert_eq!(order.replaces, [Path::new(&typed)]);
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
fn every_key_of_the_room_runs_its_command_in_its_place() {
    let mut bench = ExportBench::new();
    for command in COMMANDS {
        while bench.model.dialogs.take().is_some() {}
        if command.context != Context::GLOBAL {
            bench.keys("e");
        }
        if command.context == dialog::LINE {
            bench.go_to(ExportSpot::Target(place_of("glb")));
            bench.keys("enter");
        }
        for key in command.keys {
            assert_eq!(bench.model.command_of(key.parse().unwrap()), Some(command.id), "{key}");
        }
    }
    // While a line is typed all letters are letters.
    for c in ' '..='~' {
        assert_eq!(bench.model.command_of(Shortcut::char(c)), None, "{c}");
    }
    assert_eq!(bench.model.command_of(KeyCode::Left.into()), None);
}

#[test]
fn the_cursor_stays_on_what_it_is_on() {
    let mut bench = ExportBench::new();
    bench.keys("e G");
    assert_eq!(bench.dialog().cursor, ExportSpot::Start);
    bench.keys("k j j j");
    assert_eq!(bench.dialog().cursor, ExportSpot::Start);
    bench.keys("g k");
    assert_eq!(bench.dialog().cursor, ExportSpot::Format(0));
    bench.keys("space space j");
    assert_eq!(bench.dialog().cursor, ExportSpot::Format(1));
}

#[test]
fn the_dialog_at_80_by_24() {
    let mut bench = ExportBench::new();
    bench.model.exporting = Exporting::default();
    bench.keys("e");
    insta::assert_snapshot!(bench.text(80, 24));
}

#[test]
fn the_dialog_at_three_sizes_in_three_themes() {
    for theme in [Theme::dark(), Theme::light(), Theme::plain(false)] {
        let mut bench = ExportBench::new();
        bench.model.config.theme = theme;
        fs::write(bench.at("older-c.glb"), "").unwrap();
        bench.keys("e");
        for (columns, rows) in [(60, 16), (80, 24), (160, 50)] {
            let (buffer, view) = bench.screen(columns, rows);
            let text = text_of(&buffer);
            for words in ["Export older-c", "[x] glb", "to ", "older-c.glb", "replaces a file"] {
                assert!(text.contains(words), "{columns}×{rows} {words}\n{text}");
            }
            // The row at the cursor looks unlike the others, in any theme.
            let rows: Vec<_> =
                view.regions.iter().filter(|(_, target)| matches!(target, Target::Dialog(Some(_)))).collect();
            let at = bench.dialog().spots().iter().position(|spot| *spot == bench.dialog().cursor).unwrap();
            let looks = |wanted: bool| {
                let cell =
                    rows.iter().find(|(_, target)| (*target == Target::Dialog(Some(at))) == wanted).unwrap();
                let cell = &buffer[(cell.0.right() - 1, cell.0.y)];
                (cell.bg, cell.modifier.contains(Modifier::REVERSED))
            };
            assert_ne!(looks(true), looks(false), "{columns}×{rows:?}");
        }
        bench.keys("x");
        assert!(bench.text(80, 24).contains("Replace the file?"));
    }
}

#[test]
fn estimates_are_on_screen_for_what_is_ticked() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let tree = bench.model.tree.as_ref().unwrap();
    let shown = tree.shown.as_ref().unwrap();
    let estimate = bench.dialog().estimate(shown).unwrap();
    let scene = linden::dress::dress(&shown.recipe, &shown.grown, &linden::Quiet).unwrap();
    let triangles = scene.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum::<u64>();
    assert_eq!(estimate.triangles, triangles);
    let text = bench.text(100, 30);
    // The table itself, and the pictures of the bark: what older files of this tree took, within a tenth.
    let said = text.lines().find_map(|line| line.split_once("2 500 triangles, about ")).map(|(_, rest)| rest);
    let size = said.and_then(|rest| rest.split_once(" KiB")).map(|(size, _)| size.to_owned());
    let kib: f64 = size.as_ref().and_then(|size| size.parse().ok()).unwrap_or_else(|| panic!("{text}"));
    assert!((700.0..860.0).contains(&kib), "{text}");
    // One of an older tree is not told.
    bench.model.tree.as_mut().unwrap().set("seed", "99", Instant::now()).unwrap();
    let text = bench.text(100, 30);
    assert!(text.contains("still growing") && !text.contains(&format!("about {kib} KiB")), "{text}");
}

#[test]
fn no_size_panics_and_the_cursor_stays_on_screen() {
    let mut bench = ExportBench::new();
    fs::write(bench.at("older-c.glb"), "").unwrap();
    let long = bench.at(&"木".repeat(70));
    let look = |bench: &mut ExportBench| {
        for columns in (1..24).chain([40, 79, 80, 111, 400]) {
            for rows in (1..14).chain([24, 120]) {
                let (buffer, view) = bench.screen(columns, rows);
                for (area, _) in &view.regions {
                    assert_eq!(buffer.area.intersection(*area), *area, "{columns}×{rows}");
                }
                if let Some(at) = view.cursor {
                    assert!(buffer.area.contains(at.into()), "{columns}×{rows} {at:?}");
                }
            }
        }
    };
    bench.keys("e");
    look(&mut bench);
    bench.keys("x");
    look(&mut bench);
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    bench.retype(&long);
    look(&mut bench);
    bench.keys("enter");
    look(&mut bench);
    bench.keys("x");
    look(&mut bench);
}

#[test]
fn text_from_outside_cannot_drive_the_terminal() {
    let mut bench = ExportBench::new();
    let mut last = bench.model.exporting.to_session();
    last.targets = vec![format!("{}\u{202e}/x.glb", bench.at("\u{1b}[2J"))];
    bench.model.exporting.remember(&Session { export: last, ..Session::default() });
    bench.keys("e j j");
    for keys in ["", "enter", "enter", "x"] {
        bench.keys(keys);
        let text = bench.text(160, 60);
        assert!(!text.contains('\u{1b}') && !text.contains('\u{202e}'), "{text}");
        assert!(text.contains("u{1b}"), "{text}");
    }
}

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
    let options = super::formats()[place].format().options;
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

#[test]
fn while_growth_is_paused_the_dialog_says_what_files_have() {
    let mut bench = ExportBench::new();
    bench.model.growth.step = Some(1);
    bench.keys("e");
    let text = bench.text(100, 30);
    assert!(text.contains("of the grown tree, not derivation 1 of 2: age=0.5 makes that one"), "{text}");
    bench.keys("esc y");
    assert!(
        bench.said().1.starts_with("copied, of the grown tree, not derivation 1 of 2"),
        "{:?}",
        bench.said()
    );
}

#[test]
fn a_list_that_is_longer_than_its_room_says_where_it_is() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    assert!(bench.text(100, 24).contains('┃'));
    assert!(!bench.text(100, 80).contains('┃'));
}

#[test]
fn the_footer_has_the_progress_whole() {
    let mut bench = ExportBench::new();
    bench.keys("e x");
    bench.send(Msg::Export(ExportNews::Progress { doing: Phase::Write, done: 420 }));
    for columns in [60, 80, 100] {
        assert!(bench.text(columns, 24).contains("42 %"), "{columns}");
    }
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
    let skeleton =
        bench.at(&linden_exporters::default_name("older-c", super::formats()[place_of("ply-skeleton")]));
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

#[test]
fn the_keys_that_matter_stay_in_the_smallest_window() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let text = bench.text(40, 12);
    let footer = text.lines().last().unwrap();
    assert!(footer.contains("x Export") && footer.contains("Esc Close"), "{text}");
    fs::write(bench.at("older-c.glb"), "before").unwrap();
    bench.keys("x");
    let text = bench.text(40, 12);
    let footer = text.lines().last().unwrap();
    for hint in ["y Yes", "n No", "Esc Close"] {
        assert!(footer.contains(hint), "{text}");
    }
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
