//! The lanes of the workbench, and what it wants of them.
//!
//! What has to be grown and drawn follows from the model, whatever led there: after each round of
//! messages [`Desk::sync`] compares what the model wants with what was asked for last.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use linden::recipe::Recipe;

use super::Happening;
use crate::jobs::{Answer, Done, DrawRequest, Lane, Painted, Painter, Relay, Shown, Watcher, grow_shown};
use crate::source::{self, Source};
use crate::tui::model::Model;
use crate::tui::picture;
use crate::tui::tree::{Growing, Place};
use crate::tui::update::Msg;

/// Growing that is younger than this may finish though another tree is wanted meanwhile.
const GROWING_PATIENCE: Duration = Duration::from_millis(250);
/// The same for drawing.
const DRAWING_PATIENCE: Duration = Duration::from_millis(120);
/// Trees that are kept for undo and comparison: as many as have so many nodes together.
const KEPT_NODES: usize = 2_000_000;

/// What a lane said.
pub enum News {
    Load(Answer<(Place, Result<Box<Source>, String>)>),
    Grow(Answer<Result<Arc<Shown>, String>>),
    Draw(Answer<Result<Box<Painted>, String>>),
}

/// A preset to read, with knobs to turn.
pub struct LoadRequest {
    pub place: Place,
    pub set: Vec<(String, String)>,
}

/// The lanes.
pub struct Desk {
    load: Lane<LoadRequest>,
    grow: Relay<Arc<Recipe>>,
    draw: Relay<DrawRequest>,
    /// The recipe that was asked for last.
    asked_recipe: Option<Arc<Recipe>>,
    /// The picture that was asked for last.
    asked_picture: Option<DrawRequest>,
    /// Trees that grew lately, the newest last.
    kept: Vec<Arc<Shown>>,
}

impl Desk {
    /// Starts the lanes.
    pub fn start(sender: &Sender<Happening>) -> std::io::Result<Self> {
        let send = |wrap: fn(_) -> News| {
            let sender = sender.clone();
            // Nobody listens only when the program ends.
            move |answer| drop(sender.send(Happening::Job(wrap(answer))))
        };
        let load = {
            let sender = sender.clone();
            Lane::start("read", move |answer| drop(sender.send(Happening::Job(News::Load(answer)))), read)?
        };
        let grow = Lane::start("grow", send(News::Grow), |recipe: Arc<Recipe>, watcher, give| {
            if let Some(grown) = grow_shown(&recipe, watcher) {
                give(grown);
            }
        })?;
        let draw = {
            let sender = sender.clone();
            let mut painter = Painter::default();
            Lane::start(
                "draw",
                move |answer| drop(sender.send(Happening::Job(News::Draw(answer)))),
                move |request: DrawRequest, watcher, give| {
                    if let Some(painted) = painter.paint(request, watcher) {
                        give(painted.map(Box::new));
                    }
                },
            )?
        };
        Ok(Self {
            load,
            grow: Relay::new(grow, GROWING_PATIENCE),
            draw: Relay::new(draw, DRAWING_PATIENCE),
            asked_recipe: None,
            asked_picture: None,
            kept: Vec::new(),
        })
    }

    /// Reads a preset.
    pub fn load(&self, request: LoadRequest) {
        self.load.submit(request);
    }

    /// What a lane said, as a message for the model.
    pub fn hear(&mut self, news: News, now: Instant) -> Option<Msg> {
        match news {
            News::Load(answer) => match answer.done {
                Done::Value((place, source)) => Some(Msg::Loaded(place, source)),
                Done::Broken(why) => Some(Msg::Broken("reading", why)),
                Done::Progress { .. } | Done::Finished => None,
            },
            News::Grow(Answer { number, done }) => match done {
                Done::Finished => {
                    self.grow.finished(number, now);
                    None
                }
                _ if !self.grow.is_current(number) => None,
                Done::Progress { stage, done, total } => Some(Msg::Growing(Growing { stage, done, total })),
                Done::Value(grown) => {
                    if let Ok(shown) = &grown {
                        self.keep(Arc::clone(shown));
                    }
                    Some(Msg::Grown(grown))
                }
                Done::Broken(why) => Some(Msg::Broken("growing", why)),
            },
            News::Draw(Answer { number, done }) => match done {
                Done::Finished => {
                    self.draw.finished(number, now);
                    None
                }
                Done::Value(Ok(painted)) => Some(Msg::Painted(painted)),
                Done::Value(Err(why)) => Some(Msg::NotPainted(why)),
                Done::Broken(why) => Some(Msg::Broken("drawing", why)),
                Done::Progress { .. } => None,
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
                self.asked_recipe = Some(Arc::clone(wanted));
                if let Some(shown) = self.kept.iter().find(|shown| Arc::ptr_eq(&shown.recipe, wanted)) {
                    let shown = Arc::clone(shown);
                    self.grow.cancel();
                    return Some(Msg::Grown(Ok(shown)));
                }
                self.grow.want(Arc::clone(wanted), now);
            }
        }
        if let Some(wanted) = picture::wanted(model) {
            let is_there = |have: &DrawRequest| have.is_of(&wanted) && have.detail >= wanted.detail;
            let is_painted = model.picture.painted.as_ref().is_some_and(|painted| is_there(&painted.request));
            if !is_painted && !self.asked_picture.as_ref().is_some_and(is_there) {
                self.asked_picture = Some(wanted.clone());
                self.draw.want(wanted, now);
            } else if is_painted {
                // Whatever was asked for after it is not wanted any more.
                self.asked_picture = model.picture.painted.as_ref().map(|painted| painted.request.clone());
            }
        }
        None
    }

    /// When to look again though nothing happens.
    pub fn wake_at(&self) -> Option<Instant> {
        [self.grow.wake_at(), self.draw.wake_at()].into_iter().flatten().min()
    }

    fn keep(&mut self, shown: Arc<Shown>) {
        self.kept.push(shown);
        let nodes = |shown: &Arc<Shown>| shown.grown.skeleton.positions.len();
        while self.kept.len() > 1 && self.kept.iter().map(nodes).sum::<usize>() > KEPT_NODES {
            self.kept.remove(0);
        }
    }
}

/// Reads a preset, on its lane.
fn read(request: LoadRequest, watcher: &Watcher<'_>, give: &dyn Fn((Place, Result<Box<Source>, String>))) {
    let path = match &request.place {
        Place::Builtin(id) => PathBuf::from(id),
        Place::File(path) => path.clone(),
    };
    let resolved = source::resolve(Path::new(&path), &request.set, watcher);
    if !linden::Monitor::is_cancelled(watcher) {
        give((request.place, resolved.map(Box::new).map_err(|error| format!("{error:#}"))));
    }
}
