//! The export dialog, and the exports that run while one goes on.
//!
//! The dialog asks nothing of a disk itself: what it wants to know is [`wanted`], which the runtime
//! hands to [`look`](crate::jobs::look) on a lane, and the answer comes as news. One export runs at a
//! time; others wait in line.

mod ages;
mod client;
mod commands;
mod dialog;
mod knobs;
mod view;

use std::path::PathBuf;
use std::sync::Arc;

pub use commands::COMMANDS;
#[cfg(test)]
pub use dialog::CONTEXT as EXPORT_CONTEXT;
pub use view::status;

use self::dialog::{ExportDialog, ExportSpot, FormatChoice, StartState};
use self::knobs::ExportKnobs;
use super::effect::{Effect, Effects};
use super::library;
use super::model::{ExportReport, Exporting, Model, NamedFiles, RunningExport};
use super::tree::Tree;
use crate::jobs::{
    ExportNews, ExportOrder, ExportSubject, FOREST_PITCH_DEG, FOREST_YAW_DEG, Inquiry, PictureLook,
    ShownTree, WHOLE,
};
use crate::paths::{expand, show};
use crate::portrait::{self, FOREST_PNG, PITCH_DEG};
use crate::triangles;
use linden_exporters::{Exporter, Registry, USUAL};
use linden_raster::{Camera, Paint};

/// Exports that may wait; each keeps a tree in memory.
const MOST_WAITING: usize = 8;
/// Exports that the page of files tells of.
const MOST_REPORTS: usize = 20;

/// What can be exported to: linden's formats, pictures, and those of plug-ins.
pub fn formats() -> Vec<&'static dyn Exporter> {
    portrait::formats().exporters()
}

/// What a forest can be exported to. It has no flat drawing, and no sheet of several.
fn formats_of_forests() -> Vec<&'static dyn Exporter> {
    Registry::new().with(FOREST_PNG).with_plugins().exporters()
}

/// What the dialog wants to know, `None` without a dialog. To be asked whenever it differs from what
/// was asked last; answered by [`ExportNews::Found`].
pub fn wanted(model: &Model) -> Option<Inquiry> {
    let dialog = model.dialogs.find::<ExportDialog>()?;
    if let Some(forest) = &model.forest {
        let kinds = forest.wanted().kinds.iter();
        let levels = kinds.map(|kind| kind.recipe.preset.dressing.detail.levels()).max().unwrap_or(1);
        return Some(dialog.inquiry(None, levels, forest.files().to_vec()));
    }
    let tree = model.tree.as_ref()?;
    let levels = tree.wanted().preset.dressing.detail.levels();
    Some(dialog.inquiry(current(tree), levels, tree.files()))
}

/// The tree as it grew, `None` while what is on screen is an older one.
fn current(tree: &Tree) -> Option<&Arc<ShownTree>> {
    tree.shown.as_ref().filter(|shown| Arc::ptr_eq(&shown.recipe, tree.wanted()))
}

/// An export's progress or end, or what was found out for the dialog.
pub fn news(model: &mut Model, news: ExportNews, effects: &mut Effects) {
    match news {
        ExportNews::Progress { doing, done } => {
            if let Some(running) = &mut model.exporting.running {
                running.doing = Some(doing);
                running.done = done.min(WHOLE);
            }
        }
        ExportNews::Done { number, files, triangles, notes } => {
            let triangles = triangles::told(&triangles);
            model.say(done(&files, triangles.as_deref()));
            model.exporting.reports.push_front(ExportReport { files, triangles, notes });
            model.exporting.reports.truncate(MOST_REPORTS);
            ended(model, number, effects);
        }
        ExportNews::Failed { number, why } => {
            // The footer has room for one line, and the reason is what is to be read.
            model.say_error(format!("{why}; the export failed, nothing was written"));
            ended(model, number, effects);
        }
        ExportNews::Cancelled { number } => {
            model.say("the export was cancelled, nothing was written");
            ended(model, number, effects);
        }
        ExportNews::Broken(why) => {
            model.say_error(format!(
                "exporting failed, which is a fault in linden: {why}; nothing was written; please report it"
            ));
            if let Some(RunningExport { number, .. }) = model.exporting.running {
                ended(model, number, effects);
            }
        }
        ExportNews::Estimated(shown, estimate) => {
            if let Some(dialog) = dialog(model) {
                dialog.take_estimate(shown, estimate);
            }
        }
        ExportNews::Found(findings) => {
            let Some(findings) = library::found(model, *findings) else { return };
            if dialog(model).is_some_and(|dialog| dialog.take(findings)) {
                decide(model, effects);
            }
        }
    }
}

/// `exported /a/fir.glb and 2 more, 3.4 MiB, 19 964 / 6 700 triangles`.
fn done(files: &[(PathBuf, u64)], triangles: Option<&str>) -> String {
    let bytes = indicatif::BinaryBytes(files.iter().map(|(_, bytes)| bytes).sum());
    let triangles = triangles.map(|triangles| format!(", {triangles}")).unwrap_or_default();
    match files {
        [] => "exported".to_owned(),
        [(only, _)] => format!("exported {}, {bytes}{triangles}", show(only)),
        [(first, _), rest @ ..] => {
            format!("exported {} and {} more, {bytes}{triangles}", show(first), rest.len())
        }
    }
}

/// An order came to its end: the next one begins. What was cancelled has made way already.
fn ended(model: &mut Model, number: u64, effects: &mut Effects) {
    let exporting = &mut model.exporting;
    if exporting.running.as_ref().is_some_and(|running| running.number == number) {
        exporting.running = None;
        begin_next(exporting, effects);
    }
}

fn begin_next(exporting: &mut Exporting, effects: &mut Effects) {
    let Some(order) = exporting.waiting.pop_front() else { return };
    let name = order.outputs.first().and_then(|output| output.path.file_name()).unwrap_or_default();
    let mut name = linden::knob::printable(&name.to_string_lossy());
    if order.outputs.len() > 1 {
        name.push_str(&format!(" +{}", order.outputs.len() - 1));
    }
    exporting.running = Some(RunningExport { number: order.number, name, doing: None, done: 0 });
    effects.push(Effect::Export(order));
}

/// Stops the export under way. Its end need not be waited for: the lane does one thing at a time.
fn cancel(model: &mut Model, effects: &mut Effects) {
    if model.exporting.running.take().is_some() {
        effects.push(Effect::CancelExport);
        model.say("cancelling the export");
        begin_next(&mut model.exporting, effects);
    }
}

/// The dialog, if it is open.
fn dialog(model: &mut Model) -> Option<&mut ExportDialog> {
    model.dialogs.find_mut()
}

/// A dialog for what is on screen.
fn new_dialog(model: &Model) -> Option<ExportDialog> {
    let of_forest = model.forest.as_ref().map(|forest| forest.wanted().id.as_str());
    let id = model.tree.as_ref().map(|tree| tree.wanted().preset.id.as_str()).or(of_forest)?;
    let all = if model.forest.is_some() { formats_of_forests() } else { formats() };
    let kept = model.exporting.kept_of(model.place());
    let choices = kept.map_or(&model.exporting.last, |kept| &kept.choices);
    let mut dialog = ExportDialog::new(choices, id, &all, model.tree.as_ref());
    let named = model.exporting.named.as_ref().filter(|named| Some(&named.place) == model.place());
    if let Some(named) = named {
        dialog.name(&named.targets);
    }
    if let Some(kept) = kept {
        dialog.restore(kept);
    }
    dialog.see_as(&view_on_screen(model), kept.map_or(&[], |kept| &kept.choices.options));
    Some(dialog)
}

/// What a command line says that makes the files of the dialog.
#[derive(Debug, Default)]
pub struct ExportWords {
    /// Where to, and in which formats where the names of the files do not tell.
    pub outputs: Vec<String>,
    /// Knobs that the dialog turns.
    pub knobs: Vec<(&'static str, String)>,
    /// Options of formats, seasons, and what stands around.
    pub options: Vec<String>,
}

/// What the dialog would write of what is on screen, for a command line: the chosen formats that it has, or else the
/// usual one. Pictures are drawn by another command.
pub fn words(model: &Model) -> Option<ExportWords> {
    let dialog = new_dialog(model)?;
    let known = crate::formats::exporters();
    let is_known =
        |choice: &&FormatChoice| known.iter().any(|known| known.format().id == choice.exporter.format().id);
    let path_of = |choice: &FormatChoice| {
        let path = expand(choice.target.trim()).ok()?;
        path.to_str()
            .filter(|path| !path.is_empty() && linden::knob::printable(path) == **path)
            .map(str::to_owned)
    };
    let mut written: Vec<&FormatChoice> = dialog.chosen().filter(is_known).collect();
    if written.is_empty() {
        written.extend(dialog.formats.iter().find(|choice| choice.exporter.format().id == USUAL.format().id));
    }
    let mut words = ExportWords::default();
    let (mut formats, mut is_told) = (Vec::new(), true);
    for choice in written {
        let format = choice.exporter.format();
        let Some(path) = path_of(choice) else { continue };
        let of_name = crate::formats::for_path(std::path::Path::new(&path));
        is_told &= of_name.is_ok_and(|other| other.format().id == format.id);
        formats.push(format.id);
        words.outputs.extend(["-o".to_owned(), path]);
        for (name, value) in choice.turned(dialog.client) {
            words.options.extend(["--set".to_owned(), format!("{}.{name}={value}", format.id)]);
        }
    }
    if formats.is_empty() {
        return None;
    }
    if !is_told {
        words.outputs.extend(["--format".to_owned(), formats.join(",")]);
    }
    if let Some(client) = dialog.client {
        words.outputs.extend(["--for".to_owned(), client.id.to_owned()]);
    }
    if let Some(knobs) = &dialog.knobs {
        words.knobs.extend(knobs.turned());
        if !dialog.seasons.trim().is_empty() {
            words.options.extend(["--seasons".to_owned(), dialog.seasons.trim().to_owned()]);
        }
        if !dialog.chosen_ages().is_empty() {
            words.options.extend(["--ages".to_owned(), dialog.ages.trim().to_owned()]);
        }
    }
    if dialog.scene {
        words.options.push("--scene".to_owned());
    }
    Some(words)
}

/// How the picture on screen is seen, as options of pictures: what was turned or chosen there. What was not is left to
/// the format.
fn view_on_screen(model: &Model) -> Vec<(&'static str, String)> {
    let shown = model.tree.as_ref().and_then(|tree| tree.shown.as_ref());
    let usual = match (shown, &model.forest) {
        (_, Some(_)) => Camera::orbit(FOREST_YAW_DEG, FOREST_PITCH_DEG),
        (Some(shown), None) => Camera::orbit(shown.broad_side_deg(), PITCH_DEG),
        (None, None) => return Vec::new(),
    };
    let (camera, picture) = (&model.picture.camera, &model.picture);
    let short = |x: f32| (f64::from(x) * 100.0).round() / 100.0;
    let angles = [
        ("yaw", camera.yaw_deg, usual.yaw_deg),
        ("pitch", camera.pitch_deg, usual.pitch_deg),
        ("zoom", camera.zoom, usual.zoom),
    ];
    let turned = angles.into_iter().filter(|(_, now, usual)| short(*now) != short(*usual));
    let mut view: Vec<_> = turned.map(|(name, now, _)| (name, short(now).to_string())).collect();
    if picture.is_look_chosen && model.forest.is_none() {
        let look = match picture.look {
            PictureLook::Surface => "surface",
            PictureLook::Turtle => "turtle",
            PictureLook::Skeleton(paint) => {
                let name = Paint::ALL.into_iter().find(|(_, of, _)| *of == paint).map(|(name, ..)| name);
                view.extend(name.map(|name| ("color", name.to_owned())));
                "skeleton"
            }
        };
        view.push(("look", look.to_owned()));
    }
    view
}

/// Opens the dialog.
fn open(model: &mut Model) {
    model.end_comparison();
    if let Some(dialog) = new_dialog(model) {
        model.dialogs.open(dialog);
    }
}

/// Opens the dialog with a format ticked, the cursor on it.
pub fn open_with(model: &mut Model, format: &str) {
    model.end_comparison();
    if let Some(mut dialog) = new_dialog(model) {
        dialog.choose(format);
        model.dialogs.open(dialog);
    }
}

/// Why there is nothing to export.
fn has_nothing(model: &Model) -> Option<String> {
    if let Some(forest) = &model.forest {
        return forest.fault.as_ref().map(|fault| format!("the forest did not grow: {fault}"));
    }
    let Some(tree) = &model.tree else { return Some("no preset is chosen".to_owned()) };
    tree.fault.as_ref().map(|fault| format!("the tree did not grow: {fault}"))
}

/// Everything is known that the start waits for: it starts, asks, or says what is in the way.
fn decide(model: &mut Model, effects: &mut Effects) {
    let Some(dialog) = dialog(model) else { return };
    if let Some((format, why)) = dialog.unfit() {
        dialog.go_to(ExportSpot::Target(format));
        return model.say_warning(format!("Export: {why}"));
    }
    if dialog.replaced().is_empty() && !dialog.makes_folders() {
        start(model, effects);
    } else {
        dialog.start = StartState::Asking;
    }
}

/// What is on screen, the files that it was read from, and the knobs that were turned.
fn subject(model: &Model) -> Option<(ExportSubject, Vec<PathBuf>, Vec<&'static str>)> {
    if let Some(forest) = &model.forest {
        let turned = forest.overrides().into_iter().map(|(name, _)| name).collect();
        return Some((ExportSubject::Forest(Arc::clone(forest.wanted())), forest.files().to_vec(), turned));
    }
    let tree = model.tree.as_ref()?;
    let dialog = model.dialogs.find::<ExportDialog>()?;
    let (mut recipe, mut shown, mut turned) =
        (Arc::clone(tree.wanted()), current(tree).cloned(), tree.turned());
    for (name, value) in dialog.knobs.iter().flat_map(ExportKnobs::turned) {
        // Its document may have been read again, and have another value that this one goes with no more.
        Arc::make_mut(&mut recipe).preset.set(name, &value).ok()?;
        // The leaves may be others.
        shown = None;
        turned.extend((!turned.contains(&name)).then_some(name));
    }
    Some((ExportSubject::Tree { recipe, shown }, tree.files(), turned))
}

/// Hands the order in and closes the dialog.
fn start(model: &mut Model, effects: &mut Effects) {
    let Some(dialog) = model.dialogs.find::<ExportDialog>() else { return };
    let Some((subject, sources, turned)) = subject(model) else {
        let why = "Export: what is turned here does not go with the tree on screen any more; open it again";
        return model.say_warning(why);
    };
    let (outputs, replaces, scene) = (dialog.outputs(), dialog.replaced(), dialog.scene);
    let seasons = dialog.chosen_seasons();
    let ages = match &subject {
        ExportSubject::Tree { recipe, .. } => ages::at_ages(recipe, &dialog.chosen_ages(), &turned),
        ExportSubject::Forest(_) => Ok(Vec::new()),
    };
    let ages = match ages {
        Ok(ages) => ages,
        Err(why) => return model.say_warning(format!("Export: the ages '{}': {why}", dialog.ages)),
    };
    let (makes_folders, last) = (dialog.makes_folders(), dialog.choices());
    let targets = dialog.targets();
    let kept = model.place().cloned().map(|place| dialog.kept(place));
    let named = model.place().cloned().map(|place| NamedFiles { place, targets });
    let exporting = &mut model.exporting;
    exporting.named = named;
    exporting.last = last;
    exporting.kept = kept;
    exporting.numbers += 1;
    let number = exporting.numbers;
    exporting.waiting.push_back(ExportOrder {
        number,
        subject,
        scene,
        seasons,
        ages,
        outputs,
        replaces,
        makes_folders,
        sources,
        turned,
    });
    model.dialogs.close::<ExportDialog>();
    if model.exporting.is_running() {
        model.say("the export waits for the one before it");
    } else {
        begin_next(&mut model.exporting, effects);
    }
}

impl ExportDialog {
    /// The button was pressed: all targets are looked at before it starts.
    fn press_start(&mut self, model: &mut Model) {
        let why = has_nothing(model).or_else(|| {
            let is_full = model.exporting.waiting.len() >= MOST_WAITING;
            is_full.then(|| format!("{MOST_WAITING} exports wait already; let some finish"))
        });
        if let Some(why) = why {
            model.say_warning(format!("Export: {why}"));
        } else if self.chosen().next().is_none() {
            model.say_warning("Export: no format is chosen; Space ticks one");
        } else {
            self.press();
        }
    }

    /// Enter: ticks, turns, types or presses what is at the cursor.
    fn enter(&mut self, model: &mut Model) {
        match self.cursor {
            // The question is answered by keys of its own.
            ExportSpot::Start if self.start == StartState::Asking => {}
            ExportSpot::Start => self.press_start(model),
            ExportSpot::Target(_) | ExportSpot::Seasons | ExportSpot::Ages => self.begin_line(),
            ExportSpot::Format(_)
            | ExportSpot::Option(..)
            | ExportSpot::Client
            | ExportSpot::Knob(_)
            | ExportSpot::Scene => {
                if !self.toggle() {
                    self.begin_line();
                }
            }
        }
    }

    /// A click on a row does what Enter does there.
    fn click_row(&mut self, model: &mut Model, row: usize) {
        let Some(spot) = self.spots().get(row).copied() else { return };
        if self.line.is_some() {
            if self.cursor == spot {
                return;
            }
            // What was typed counts, as in any form.
            self.accept_line();
            if self.line.is_some() {
                return;
            }
        }
        self.go_to(spot);
        self.enter(model);
    }
}

#[cfg(test)]
mod tests;
