//! Keeps the session, and restores it at the next start.

use std::path::{Path, PathBuf};

use glam::Vec2;

use crate::config::session::{Camera, Session, SessionFile};
use crate::jobs::PictureLook;
use crate::tui::layout::Pane;
use crate::tui::model::{Config, Model};
use crate::tui::tree::TreePlace;

/// The file, and what it said.
pub struct Memory {
    file: SessionFile,
    /// What was remembered and is handed on as it was: what this session has no say in.
    rest: Session,
    is_on: bool,
}

impl Memory {
    /// Reads what was kept; nothing of it is used when `wanted` is false or the settings say so.
    pub fn load(config: &Config, wanted: bool) -> (Self, Session, Vec<String>) {
        let is_on = config.settings.restore;
        let path = config.dirs.session().filter(|_| is_on);
        let (file, session, complaints) = SessionFile::load(path);
        let used = if wanted {
            session.clone()
        } else {
            Session {
                export: session.export.clone(),
                favourites: session.favourites.clone(),
                folded: session.folded.clone(),
                tags: session.tags.clone(),
                ..Session::default()
            }
        };
        (Self { file, rest: session, is_on }, used, complaints.iter().map(ToString::to_string).collect())
    }

    /// Keeps what is on screen; a complaint when that cannot be.
    pub fn keep(&mut self, model: &Model) -> Option<String> {
        if !self.is_on || model.config.dirs.session().is_none() {
            return None;
        }
        let session = remembered(model, &self.rest);
        self.file.save(&session).err().map(|complaint| complaint.to_string())
    }
}

/// Puts back how things were looked at. The tree itself is loaded as any other.
pub fn restore(model: &mut Model, session: &Session) {
    if let Some(look) = PictureLook::named(&session.look) {
        (model.picture.look, model.picture.is_look_chosen) = (look, true);
    }
    if let Some(pane) = Pane::ALL.into_iter().find(|pane| pane.title().to_lowercase() == session.focus) {
        model.focus_on(pane);
    }
    if session.source.is_some() {
        let Camera { yaw_deg, pitch_deg, zoom, pan: [right, up] } = session.camera;
        model.picture.restore(
            yaw_deg as f32,
            pitch_deg as f32,
            zoom as f32,
            Vec2::new(right as f32, up as f32),
        );
    }
    model.library.favourites = session.favourites.iter().cloned().collect();
    model.library.folded = session.folded.iter().cloned().collect();
    model.library.tags = session.tags.clone();
    model.library.filter_by(&session.filter);
    model.exporting.remember(session);
}

/// What is on screen, as the file has it.
fn remembered(model: &Model, rest: &Session) -> Session {
    let camera = &model.picture.camera;
    let mut session = Session {
        look: if model.picture.is_look_chosen {
            model.picture.look.name().to_owned()
        } else {
            "usual".to_owned()
        },
        focus: model.focus.title().to_lowercase(),
        filter: model.library.filter.clone(),
        favourites: model.library.favourites.iter().cloned().collect(),
        folded: model.library.folded.iter().cloned().collect(),
        tags: model.library.tags.clone(),
        camera: Camera {
            yaw_deg: camera.yaw_deg.into(),
            pitch_deg: camera.pitch_deg.into(),
            zoom: camera.zoom.into(),
            pan: [camera.pan.x.into(), camera.pan.y.into()],
        },
        export: model.exporting.to_session(),
        source: None,
        grammar: None,
        knobs: Vec::new(),
        ..rest.clone()
    };
    let absolute = |path: &Path| std::path::absolute(path).ok()?.to_str().map(str::to_owned);
    session.source = match model.place() {
        Some(TreePlace::Builtin(id)) => Some((*id).to_owned()),
        Some(TreePlace::File(path)) => absolute(path),
        None => None,
    };
    if let Some(forest) = &model.forest {
        let knobs = forest.overrides().into_iter();
        session.knobs = knobs.map(|(name, value)| (name.to_owned(), value)).collect();
    }
    let Some(tree) = &model.tree else { return session };
    match tree.overrides() {
        Some(knobs) => {
            session.knobs = knobs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        }
        // What knobs cannot say: the whole preset.
        None => session.grammar = Some(tree.recipe().to_line()),
    }
    session
}

/// Where a source is that was remembered, or named on the command line.
pub fn place(source: &str) -> TreePlace {
    if let Ok(builtin) = linden::preset::builtin(source) {
        return TreePlace::Builtin(builtin.id);
    }
    if let Ok(builtin) = linden::forest::builtin_forest(source) {
        return TreePlace::Builtin(builtin.id);
    }
    // Which of several is meant is asked where the source is read.
    let users = crate::source::user_preset(Path::new(source)).ok().flatten();
    TreePlace::File(users.unwrap_or_else(|| PathBuf::from(source)))
}
