use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc;

use linden::Quiet;
use linden::dress::dress;
use linden_exporters::{Options, REGISTRY, find};

use super::*;
use crate::jobs::{Answer, Lane};
use linden_exporters::default_name;

fn recipe(id: &str) -> Arc<Recipe> {
    Arc::new(Recipe::new(linden::preset::builtin(id).unwrap().load().unwrap()))
}

fn order(dir: &Path, formats: &[&str]) -> ExportOrder {
    let output = |id: &&str| {
        let exporter = find(id).unwrap();
        let path = dir.join(default_name("tree", exporter));
        Output::new(exporter, Options::new(exporter.format()), path)
    };
    ExportOrder {
        number: 7,
        subject: ExportSubject::Tree { recipe: recipe("older-c"), shown: None },
        scene: false,
        seasons: Vec::new(),
        ages: Vec::new(),
        outputs: formats.iter().map(output).collect(),
        replaces: Vec::new(),
        makes_folders: false,
        sources: Vec::new(),
        turned: Vec::new(),
    }
}

fn ran(order: ExportOrder, watcher: &dyn Monitor) -> ExportNews {
    let said = RefCell::new(Vec::new());
    run(order, watcher, &|news| said.borrow_mut().push(news));
    let mut said = said.into_inner();
    assert_eq!(said.len(), 1, "{said:?}");
    said.remove(0)
}

/// Everything in a directory, hidden files too.
fn listing(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let entry = |entry: std::io::Result<fs::DirEntry>| {
        let entry = entry.unwrap();
        (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap_or_default())
    };
    fs::read_dir(dir).unwrap().map(entry).collect()
}

fn failed(news: ExportNews) -> String {
    match news {
        ExportNews::Failed { number: 7, why } => why,
        other => panic!("{other:?}"),
    }
}

#[test]
fn files_are_those_that_each_exporter_writes_alone() {
    let (ours, alone) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let ids: Vec<_> = REGISTRY.iter().map(|exporter| exporter.format().id).collect();
    let mut whole = order(ours.path(), &ids);
    whole.outputs[1].options.set("encoding", "ascii").unwrap();
    let outputs = whole.outputs.clone();
    let ExportNews::Done { number: 7, files, .. } = ran(whole, &Quiet) else { panic!() };

    let recipe = recipe("older-c");
    let scene = dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap();
    for output in outputs {
        let mut bundle = Bundle::create(&alone.path().join(output.path.file_name().unwrap())).unwrap();
        output
            .exporter
            .write(&linden::stage::Stage::of(&scene), &output.options, &mut bundle, &Quiet)
            .unwrap();
        bundle.commit().unwrap();
    }
    let (ours_listed, alone_listed) = (listing(ours.path()), listing(alone.path()));
    assert!(ours_listed == alone_listed, "{:?}\n{:?}", ours_listed.keys(), alone_listed.keys());
    assert_eq!(files.len(), ours_listed.len(), "each file is told once");
    for (path, bytes) in files {
        assert!(path.is_absolute());
        assert_eq!(bytes, fs::metadata(path).unwrap().len());
    }
}

/// Cancels when it has been asked that many times.
struct Until(AtomicU64, u64);

impl Monitor for Until {
    fn is_cancelled(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) >= self.1
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
}

#[test]
fn cancelled_anywhere_nothing_is_left() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("tree.obj"), "before").unwrap();
    let wanted = || {
        let mut order = order(dir.path(), &["ply", "obj", "glb"]);
        order.replaces = vec![dir.path().join("tree.obj")];
        order
    };
    let before = listing(dir.path());
    // How often the whole asks.
    let count = Until(AtomicU64::new(0), u64::MAX);
    let other = tempfile::tempdir().unwrap();
    assert!(matches!(ran(order(other.path(), &["ply", "obj", "glb"]), &count), ExportNews::Done { .. }));
    let asks = count.0.into_inner();
    assert!(asks > 20, "{asks}");
    for at in (0..asks - 1).step_by((asks / 40).max(1) as usize) {
        let news = ran(wanted(), &Until(AtomicU64::new(0), at));
        assert!(matches!(news, ExportNews::Cancelled { number: 7 }), "{at} of {asks}: {news:?}");
        assert_eq!(listing(dir.path()), before, "cancelled at {at} of {asks}");
    }
}

#[test]
fn directories_are_made_when_that_was_agreed_to_and_go_with_a_failed_export() {
    let dir = tempfile::tempdir().unwrap();
    let mut agreed = order(dir.path(), &["ply", "obj"]);
    agreed.makes_folders = true;
    agreed.outputs[1].path = dir.path().join("not/yet/tree.obj");
    let asks = Until(AtomicU64::new(0), 30);
    let outputs = agreed.outputs.clone();
    assert!(matches!(ran(agreed, &asks), ExportNews::Cancelled { .. }));
    assert_eq!(listing(dir.path()), BTreeMap::new());
    let mut again = order(dir.path(), &["ply", "obj"]);
    (again.makes_folders, again.outputs) = (true, outputs);
    assert!(matches!(ran(again, &Quiet), ExportNews::Done { .. }));
    assert!(dir.path().join("not/yet/tree.obj").exists());
}

#[test]
fn a_target_that_fails_leaves_the_others_unwritten() {
    let dir = tempfile::tempdir().unwrap();
    let mut missing = order(dir.path(), &["ply", "obj", "glb"]);
    missing.outputs[2].path = dir.path().join("none/tree.glb");
    assert!(failed(ran(missing, &Quiet)).contains("does not exist; create it first"));
    let mut twice = order(dir.path(), &["ply", "obj"]);
    twice.outputs[1].path = twice.outputs[0].path.clone();
    assert!(failed(ran(twice, &Quiet)).contains("the same file"));
    let mut pipe = order(dir.path(), &["ply", "obj"]);
    pipe.outputs[1].path = "/dev/null".into();
    #[cfg(unix)]
    assert!(failed(ran(pipe, &Quiet)).contains("linden export"));
    assert_eq!(listing(dir.path()), BTreeMap::new());
}

#[test]
fn what_is_there_is_replaced_only_with_leave() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.ply");
    fs::write(&target, "before").unwrap();
    assert!(failed(ran(order(dir.path(), &["glb", "ply"]), &Quiet)).contains("there already"));
    assert_eq!(listing(dir.path()).len(), 1);
    assert_eq!(fs::read(&target).unwrap(), b"before");

    let mut source = order(dir.path(), &["ply"]);
    source.replaces = vec![target.clone()];
    source.sources = vec![target.clone()];
    assert!(failed(ran(source, &Quiet)).contains("grown from"));
    assert_eq!(fs::read(&target).unwrap(), b"before");

    let mut allowed = order(dir.path(), &["glb", "ply"]);
    allowed.replaces = vec![target.clone()];
    assert!(matches!(ran(allowed, &Quiet), ExportNews::Done { .. }));
    assert!(fs::read(&target).unwrap().starts_with(b"ply"));
}

/// Another program makes a file while the export writes.
struct Meanwhile(PathBuf);

impl Monitor for Meanwhile {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, stage: Phase, _: u64, _: Option<u64>) {
        if stage == Phase::Write {
            fs::write(&self.0, "theirs").unwrap();
        }
    }
}

#[test]
fn what_comes_to_be_there_meanwhile_is_not_replaced() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("tree.glb");
    let news = ran(order(dir.path(), &["ply", "glb"]), &Meanwhile(target.clone()));
    assert!(failed(news).contains("came to be there"));
    assert_eq!(listing(dir.path()), BTreeMap::from([("tree.glb".to_owned(), b"theirs".to_vec())]));
}

/// Keeps what was reported.
#[derive(Default)]
struct Reports(Mutex<Vec<(Phase, u64)>>);

impl Monitor for Reports {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, stage: Phase, done: u64, total: Option<u64>) {
        assert_eq!(total, Some(WHOLE));
        self.0.lock().unwrap().push((stage, done));
    }
}

#[test]
fn the_gauge_fills_from_nothing_to_nearly_all() {
    let dir = tempfile::tempdir().unwrap();
    let reports = Reports::default();
    let mut several = order(dir.path(), &["obj", "ply", "gltf", "usda"]);
    several.subject = ExportSubject::Tree { recipe: recipe("fir"), shown: None };
    assert!(matches!(ran(several, &reports), ExportNews::Done { .. }));
    let reports = reports.0.into_inner().unwrap();
    let written: Vec<u64> =
        reports.iter().filter(|(stage, _)| *stage == Phase::Write).map(|(_, done)| *done).collect();
    assert!(written.is_sorted(), "{written:?}");
    let least = ((GROWING + (1.0 - GROWING) * DRESSING) * WHOLE as f64) as u64 - 1;
    assert!(written[0] >= least && written[0] < 3 * WHOLE / 4, "{written:?}");
    assert!((9 * WHOLE / 10..=WHOLE).contains(written.last().unwrap()), "{written:?}");
    assert!(reports.iter().any(|(stage, done)| *stage == Phase::Sweep && *done < least));
}

#[test]
fn on_its_lane_it_is_cancelled_by_the_lane() {
    let dir = tempfile::tempdir().unwrap();
    let (sender, answers) = mpsc::channel();
    let (entered, is_in) = mpsc::channel();
    let (go, gate) = mpsc::channel::<()>();
    let lane = Lane::start(
        "test",
        move |answer: Answer<ExportNews>| drop(sender.send(answer)),
        move |order: ExportOrder, watcher, give| {
            entered.send(()).unwrap();
            gate.recv().unwrap();
            run(order, watcher, give);
        },
    )
    .unwrap();
    lane.submit(order(dir.path(), &["obj", "glb"]));
    is_in.recv().unwrap();
    lane.cancel();
    go.send(()).unwrap();
    let heard = answers.iter().find_map(|answer| ExportNews::heard(answer.done)).unwrap();
    assert!(matches!(heard, ExportNews::Cancelled { number: 7 }), "{heard:?}");
    assert_eq!(listing(dir.path()), BTreeMap::new());
    go.send(()).unwrap();
    lane.submit(order(dir.path(), &["glb"]));
    let heard = answers.iter().find_map(|answer| match ExportNews::heard(answer.done) {
        Some(ExportNews::Progress { .. }) | None => None,
        Some(end) => Some(end),
    });
    assert!(matches!(heard, Some(ExportNews::Done { number: 7, .. })), "{heard:?}");
}

#[test]
fn triangles_of_all_levels_are_those_of_the_budget() {
    let dir = tempfile::tempdir().unwrap();
    let mut asked = order(dir.path(), &["glb"]);
    let mut preset = recipe("simple").preset.clone();
    for (name, value) in [("triangles", "4000"), ("lods", "2")] {
        preset.set(name, value).unwrap();
    }
    asked.subject = ExportSubject::Tree { recipe: Arc::new(Recipe::new(preset)), shown: None };
    let ExportNews::Done { triangles, notes, .. } = ran(asked, &Quiet) else { panic!() };
    assert_eq!(triangles.len(), 2);
    assert!((3800..=4200).contains(&triangles[0]) && triangles[1] < triangles[0] / 2, "{triangles:?}");
    assert!(notes.iter().all(|note| !note.contains("not met")), "{notes:?}");
}

#[test]
fn each_age_has_a_file_of_its_own() {
    let dir = tempfile::tempdir().unwrap();
    let tree = recipe("older-c");
    let at = |list: &str| {
        let age = tree.preset.ages_of(list).unwrap().remove(0);
        (age.name.clone(), Arc::new(tree.with_preset(tree.preset.at_age(&age).unwrap())))
    };
    let order = ExportOrder { ages: vec![at("half=0.5"), at("whole=1")], ..order(dir.path(), &["obj"]) };
    let ExportNews::Done { files, .. } = ran(order, &Quiet) else { panic!("it failed") };
    let names: Vec<_> = files.iter().map(|(path, _)| path.file_name().unwrap().to_owned()).collect();
    assert!(names.contains(&"tree_half.obj".into()) && names.contains(&"tree_whole.obj".into()), "{names:?}");
    let length = |name: &str| fs::metadata(dir.path().join(name)).unwrap().len();
    assert!(length("tree_half.obj") < length("tree_whole.obj") && !dir.path().join("tree.obj").exists());
}
