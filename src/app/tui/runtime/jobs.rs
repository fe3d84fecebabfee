//! The lanes of the workbench, and what it wants of them.
//!
//! What has to be grown and drawn follows from the model, whatever led there: after each round of
//! messages [`Desk::sync`] compares what the model wants with what was asked for last.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use linden::Monitor;
use linden::forest::Forest;
use linden::recipe::Recipe;

use super::Happening;
use crate::exit;
use crate::jobs::{
    Answer, Derivation, Done, DrawRequest, ExportNews, ExportOrder, GalleryRequest, Grower, Inquiry, Lane,
    Measured, Painted, Painter, Relay, ShownForest, ShownTree, Thumbnail, Watcher, WordRequest, derive,
    grow_shown_forest, look, measure, paint_gallery, run_export,
};
use crate::source::forest::AnySource;
use crate::tui::derivation;
use crate::tui::export;
use crate::tui::library;
use crate::tui::model::Model;
use crate::tui::picture;
use crate::tui::statistics;
use crate::tui::tree::TreePlace;
use crate::tui::update::Msg;
use crate::tui::vary;

/// Growing that is younger than this may finish though another tree is wanted meanwhile.
const GROWING_PATIENCE: Duration = Duration::from_millis(250);
/// The same for drawing.
const DRAWING_PATIENCE: Duration = Duration::from_millis(120);
/// How long an export that is cancelled at the end may take to take its files away.
const EXPORT_PATIENCE: Duration = Duration::from_secs(2);
/// Trees that are kept for undo and comparison: as many as have this number of nodes and attraction points
/// together (some 40 and 12 bytes each).
const KEPT_NODES: usize = 2_000_000;
/// What a tree counts at the least: its recipe and its outline take room however small it is.
const LEAST_NODES: usize = 1_000;

/// A preset that was read, or why not.
type Read = (TreePlace, Result<AnySource, String>);

/// What a lane said.
pub enum News {
    Load(Answer<Read>),
    Grow(Answer<Result<Arc<ShownTree>, String>>),
    Forest(Answer<Result<Arc<ShownForest>, String>>),
    Draw(Answer<Result<Box<Painted>, String>>),
    Gallery(Answer<Thumbnail>),
    Measure(Answer<Box<Measured>>),
    Derive(Answer<Box<Derivation>>),
    Export(Answer<ExportNews>),
    Look(Answer<ExportNews>),
}

/// The lanes.
pub struct Desk {
    load: Lane<TreePlace>,
    /// The number of the preset that was asked for last: of a file that changes twice, the first
    /// reading must not pass for the second.
    asked_load: u64,
    grow: Relay<Arc<Recipe>>,
    forest: Lane<Arc<Forest>>,
    /// The forest that was asked for last.
    asked_forest: Option<(u64, Arc<Forest>)>,
    draw: Relay<DrawRequest>,
    gallery: Asked<GalleryRequest>,
    measure: Asked<Arc<ShownTree>>,
    derive: Asked<WordRequest>,
    export: Lane<ExportOrder>,
    look: Asked<Inquiry>,
    /// The recipe that was asked for last.
    asked_recipe: Option<Arc<Recipe>>,
    /// The picture that was asked for last.
    asked_picture: Option<DrawRequest>,
    /// Trees that grew lately, the newest last.
    kept: Vec<Arc<ShownTree>>,
}

/// A lane that is asked once for what the model wants.
struct Asked<R> {
    lane: Lane<R>,
    /// What was asked for last.
    last: Option<R>,
    is_same: fn(&R, &R) -> bool,
}

impl<R: Clone + Send + 'static> Asked<R> {
    fn new(lane: Lane<R>, is_same: fn(&R, &R) -> bool) -> Self {
        Self { lane, last: None, is_same }
    }

    /// Asks, unless that was asked for last; drops what was asked for when nothing is wanted any more.
    fn want(&mut self, wanted: Option<R>) {
        match (wanted, &self.last) {
            (Some(wanted), Some(last)) if (self.is_same)(last, &wanted) => {}
            (Some(wanted), _) => {
                self.last = Some(wanted.clone());
                self.lane.submit(wanted);
            }
            (None, Some(_)) => {
                self.last = None;
                self.lane.cancel();
            }
            (None, None) => {}
        }
    }
}

impl Desk {
    /// Starts the lanes.
    pub fn start(sender: &Sender<Happening>) -> std::io::Result<Self> {
        let load = Lane::start("read", send(sender, News::Load), read)?;
        let mut grower = Grower::default();
        let grow =
            Lane::start("grow", send(sender, News::Grow), move |recipe: Arc<Recipe>, watcher, give| {
                if let Some(grown) = grower.grow(&recipe, watcher) {
                    give(grown);
                }
            })?;
        let forest =
            Lane::start("forest", send(sender, News::Forest), |forest: Arc<Forest>, watcher, give| {
                if let Some(grown) = grow_shown_forest(&forest, watcher) {
                    give(grown);
                }
            })?;
        let mut painter = Painter::default();
        let draw = Lane::start("draw", send(sender, News::Draw), move |request, watcher, give| {
            if let Some(painted) = painter.paint(request, watcher) {
                give(painted.map(Box::new));
            }
        })?;
        let gallery = Lane::start("gallery", send(sender, News::Gallery), |request, watcher, give| {
            paint_gallery(request, watcher, give);
        })?;
        let measure = Lane::start("measure", send(sender, News::Measure), |shown, watcher, give| {
            if let Some(measured) = measure(shown, watcher) {
                give(Box::new(measured));
            }
        })?;
        let derive = Lane::start("derive", send(sender, News::Derive), |request, watcher, give| {
            if let Some(derivation) = derive(request, watcher) {
                give(Box::new(derivation));
            }
        })?;
        let export = Lane::start("export", send(sender, News::Export), |order, watcher, give| {
            run_export(order, watcher, give);
        })?;
        let look = Lane::start("look", send(sender, News::Look), |inquiry, watcher, give| {
            look(inquiry, watcher, give);
        })?;
        Ok(Self {
            measure: Asked::new(measure, Arc::ptr_eq),
            derive: Asked::new(derive, PartialEq::eq),
            export,
            look: Asked::new(look, PartialEq::eq),
            gallery: Asked::new(gallery, GalleryRequest::is_of),
            load,
            asked_load: 0,
            forest,
            asked_forest: None,
            grow: Relay::new(grow, GROWING_PATIENCE),
            draw: Relay::new(draw, DRAWING_PATIENCE),
            asked_recipe: None,
            asked_picture: None,
            kept: Vec::new(),
        })
    }

    /// Reads a preset.
    pub fn load(&mut self, place: TreePlace) {
        self.asked_load = self.load.submit(place);
    }

    /// Exports.
    pub fn export(&self, order: ExportOrder) {
        self.export.submit(order);
    }

    /// Ends. An export that is under way takes its files away first.
    pub fn finish(self) {
        self.export.finish(EXPORT_PATIENCE);
    }

    /// Stops the export that is under way.
    pub fn cancel_export(&self) {
        self.export.cancel();
    }

    /// What a lane said, as a message for the model.
    pub fn hear(&mut self, news: News, now: Instant) -> Option<Msg> {
        match news {
            News::Load(answer) if answer.number != self.asked_load => None,
            News::Load(answer) => match answer.done {
                Done::Value((TreePlace::File(path), Err(why))) if is_missing(&path) => {
                    Some(Msg::Gone(TreePlace::File(path), why))
                }
                Done::Value((place, source)) => Some(Msg::Loaded(place, source)),
                Done::Broken(why) => Some(Msg::Broken("reading", why)),
                Done::Progress(_) | Done::Finished => None,
            },
            News::Grow(Answer { number, done }) => match done {
                Done::Finished => {
                    self.grow.finished(number, now);
                    None
                }
                _ if !self.grow.is_current(number) => None,
                Done::Progress(how_far) => Some(Msg::Growing(how_far)),
                Done::Value(grown) => {
                    if let Ok(shown) = &grown {
                        self.keep(Arc::clone(shown));
                    }
                    Some(Msg::Grown(grown))
                }
                Done::Broken(why) => Some(Msg::Broken("growing", why)),
            },
            News::Forest(Answer { number, .. })
                if self.asked_forest.as_ref().is_none_or(|(asked, _)| *asked != number) =>
            {
                None
            }
            News::Forest(answer) => match answer.done {
                Done::Progress(how_far) => Some(Msg::Growing(how_far)),
                Done::Value(grown) => Some(Msg::ForestGrown(grown)),
                Done::Broken(why) => Some(Msg::Broken("growing the forest", why)),
                Done::Finished => None,
            },
            News::Draw(Answer { number, done }) => match done {
                Done::Finished => {
                    self.draw.finished(number, now);
                    None
                }
                Done::Value(Ok(painted)) => Some(Msg::Painted(painted)),
                Done::Value(Err(why)) => Some(Msg::NotPainted(why)),
                Done::Broken(why) => Some(Msg::Broken("drawing", why)),
                Done::Progress(_) => None,
            },
            News::Export(answer) => ExportNews::heard(answer.done).map(Msg::Export),
            News::Look(answer) => match answer.done {
                Done::Value(news) => Some(Msg::Export(news)),
                Done::Broken(why) => Some(Msg::Broken("looking at targets", why)),
                Done::Progress(_) | Done::Finished => None,
            },
            News::Measure(answer) => match answer.done {
                Done::Value(measured) => Some(Msg::Measured(measured)),
                Done::Broken(why) => Some(Msg::Broken("measuring", why)),
                Done::Progress(_) | Done::Finished => None,
            },
            News::Derive(answer) => match answer.done {
                Done::Value(derivation) => Some(Msg::Derived(derivation)),
                Done::Broken(why) => Some(Msg::Broken("deriving", why)),
                Done::Progress(_) | Done::Finished => None,
            },
            News::Gallery(answer) => match answer.done {
                Done::Value(thumbnail) => Some(Msg::Thumbnail(Box::new(thumbnail))),
                Done::Broken(why) => Some(Msg::Broken("drawing the gallery", why)),
                Done::Progress(_) | Done::Finished => None,
            },
        }
    }

    /// Asks for what the model wants and was not asked for yet; gives what is there already.
    pub fn sync(&mut self, model: &Model, now: Instant) -> Option<Msg> {
        self.grow.advance(now);
        self.draw.advance(now);
        if let Some(tree) = &model.tree {
            let wanted = tree.wanted();
            if !self.asked_recipe.as_ref().is_some_and(|asked| Arc::ptr_eq(asked, wanted)) {
                let last = self.asked_recipe.replace(Arc::clone(wanted));
                if let Some(shown) = self.kept.iter().find(|shown| Arc::ptr_eq(&shown.recipe, wanted)) {
                    let shown = Arc::clone(shown);
                    self.grow.cancel();
                    return Some(Msg::Grown(Ok(shown)));
                }
                // A tree on the way to the wanted one may finish; that of another preset is of no use.
                if last.is_some_and(|last| last.preset.id != wanted.preset.id) {
                    self.grow.cancel();
                }
                self.grow.want(Arc::clone(wanted), now);
            }
        } else if self.asked_recipe.take().is_some() {
            self.grow.cancel();
        }
        match (&model.forest, &self.asked_forest) {
            (Some(forest), asked)
                if !asked.as_ref().is_some_and(|(_, asked)| Arc::ptr_eq(asked, forest.wanted())) =>
            {
                let wanted = Arc::clone(forest.wanted());
                self.asked_forest = Some((self.forest.submit(Arc::clone(&wanted)), wanted));
            }
            (None, Some(_)) => {
                self.asked_forest = None;
                self.forest.cancel();
            }
            _ => {}
        }
        self.look.want(library::wanted(model).or_else(|| export::wanted(model)));
        self.measure.want(statistics::wanted(model));
        self.derive.want(derivation::wanted(model));
        self.gallery.want(vary::wanted(model));
        if let Some(wanted) = picture::wanted(model) {
            let is_there = |have: &DrawRequest| have.is_of(&wanted) && have.detail >= wanted.detail;
            let is_painted = model.picture.painted.as_ref().is_some_and(|painted| is_there(&painted.request));
            if !is_painted && !self.asked_picture.as_ref().is_some_and(is_there) {
                self.asked_picture = Some(wanted.clone());
                self.draw.want(wanted, now);
            } else if is_painted && self.asked_picture.as_ref().is_some_and(|asked| !asked.is_of(&wanted)) {
                // What was asked for after it is not wanted any more. If it comes all the same, because
                // it was done already, the wanted one is asked for again.
                self.asked_picture = None;
                self.draw.cancel();
            }
        }
        None
    }

    /// When to look again though nothing happens.
    pub fn wake_at(&self) -> Option<Instant> {
        [self.grow.wake_at(), self.draw.wake_at()].into_iter().flatten().min()
    }

    fn keep(&mut self, shown: Arc<ShownTree>) {
        self.kept.push(shown);
        let mut nodes = 0;
        let fitting = self.kept.iter().rev().take_while(|shown| {
            let points = shown.grown.colonized.as_ref().map_or(0, |colonized| colonized.points.len());
            nodes += (shown.grown.skeleton.positions.len() + points).max(LEAST_NODES);
            nodes <= KEPT_NODES
        });
        // The newest in any case.
        let count = fitting.count().max(1);
        self.kept.drain(..self.kept.len() - count);
    }
}

/// A way for a lane to say things to the loop. It is deaf only when the program ends.
fn send<T>(
    sender: &Sender<Happening>,
    wrap: fn(Answer<T>) -> News,
) -> impl Fn(Answer<T>) + Send + Sync + use<T> {
    let sender = sender.clone();
    move |answer| drop(sender.send(Happening::Job(wrap(answer))))
}

/// Reads a preset, on its lane.
fn read(place: TreePlace, watcher: &Watcher<'_>, give: &dyn Fn(Read)) {
    let path = match &place {
        TreePlace::Builtin(id) => PathBuf::from(id),
        TreePlace::File(path) => path.clone(),
    };
    let read = AnySource::read(&path, watcher);
    if !watcher.is_cancelled() {
        give((place, read.map_err(|error| exit::sentence(&error))));
    }
}
/// Whether there is no file at a path.
fn is_missing(path: &Path) -> bool {
    std::fs::metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound)
}
