//! The new name of a preset of the user's, typed.

use std::path::PathBuf;

use crossterm::event::KeyEvent;
use linden::knob::excerpt;
use linden::preset::builtin;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::config::presets;
use crate::tui::chrome::prompt::{self, Prompt, Remark};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::{Effect, Effects};
use crate::tui::layout::View;
use crate::tui::model::Model;
use crate::tui::tree::TreePlace;

/// Why a name is not taken that another one has.
const TAKEN: &str = "there is one of that name, or what you changed of it; choose another name";

/// The line of the name.
pub struct RenameLine {
    prompt: Prompt,
    /// What it is called now.
    id: String,
    path: PathBuf,
}

impl RenameLine {
    /// For the selected entry; `None` where that is none of the user's presets and grammars, was removed, or its file is
    /// gone.
    pub fn new(model: &Model) -> Option<Self> {
        let entry = model.library.entry().filter(|entry| !entry.is_gone)?;
        let TreePlace::File(path) = &entry.place else { return None };
        let is_own = model.config.dirs.presets().is_some_and(|dir| path.starts_with(dir))
            && presets::has_ending(path)
            && presets::before_put_away(path).is_none();
        is_own.then(|| Self { prompt: Prompt::new(&entry.id), id: entry.id.clone(), path: path.clone() })
    }

    fn judge(&mut self, model: &Model) {
        let typed = self.prompt.text();
        let why = presets::check_id(typed).err().or_else(|| self.is_taken(model, typed).then_some(TAKEN));
        self.prompt.problem = why
            .map(|why| format!("'{}' cannot be the name of '{}': {why}", excerpt(typed), excerpt(&self.id)));
    }

    /// Whether another preset has that name, or changes of one whose file is gone. Files that nothing here knows are
    /// seen when it is renamed.
    fn is_taken(&self, model: &Model, id: &str) -> bool {
        let place = TreePlace::File(presets::renamed_path(&self.path, id));
        id != self.id
            && (model.library.knows(&place)
                || model.place() == Some(&place)
                || model.loading.as_ref() == Some(&place))
    }

    fn remark(&self) -> Remark {
        let (text, warns) = match &self.prompt.problem {
            Some(problem) => (problem.clone(), true),
            None if builtin(self.prompt.text()).is_ok() => (
                "a built-in preset has that name; on a command line it means the built-in one".to_owned(),
                true,
            ),
            None => (format!("forests and scripts that say '{}' do not follow", excerpt(&self.id)), false),
        };
        Remark { text, warns }
    }
}

impl Dialog<Model> for RenameLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let label = format!("rename '{}' to", excerpt(&self.id));
        self.prompt.paint_at_bottom(model, &label, Some(&self.remark()), screen, buffer, view);
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        if self.prompt.key(key) {
            self.judge(model);
        }
        After::Stays
    }

    fn paste(&mut self, model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.judge(model);
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.judge(model);
        if self.prompt.problem.is_some() {
            return After::Stays;
        }
        let id = self.prompt.text().to_owned();
        if id != self.id {
            effects.push(Effect::Rename { path: self.path.clone(), id });
        }
        After::Closes
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
