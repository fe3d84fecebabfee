//! A knob's name, typed: the cursor goes to the best match at once.

use crossterm::event::{KeyCode, KeyEvent};
use linden::preset::Section;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::{FormRow, rows};
use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::{FormSpot, Model};
use crate::tui::ranking::Ranking;
use crate::tui::tree::Tree;

/// The line of a knob's name.
pub struct FindLine {
    prompt: Prompt,
    /// Where the cursor was, for Esc.
    before: Option<FormSpot>,
    /// Which of the knobs that match it is on, the best being 0.
    at: usize,
    /// How many match.
    found: usize,
}

impl FindLine {
    /// From where the cursor is.
    pub fn new(model: &Model) -> Self {
        Self { prompt: Prompt::new(""), before: model.form.selected, at: 0, found: 0 }
    }

    fn follow(&mut self, model: &mut Model) {
        let all = matching(model, self.prompt.text());
        self.at = self.at.min(all.len().saturating_sub(1));
        let found = all.get(self.at).copied();
        let is_typed = !self.prompt.text().trim().is_empty();
        self.found = if is_typed { all.len() } else { 0 };
        self.prompt.problem = (is_typed && found.is_none()).then(|| "no knob matches".to_owned());
        // What is looked for may be one that was not changed.
        model.form.only_turned &= !is_typed;
        model.form.selected = found.filter(|_| is_typed).or(self.before);
    }
}

/// The knobs that match by their names, or by those of their groups; the best first.
fn matching(model: &Model, typed: &str) -> Vec<FormSpot> {
    let Some(preset) = model.tree.as_ref().map(Tree::preset) else { return Vec::new() };
    let (rows, labels) = (rows(preset), preset.kind_labels());
    let mut ranking = Ranking::of(typed);
    let score = |row: &FormRow| {
        let FormRow::Knob(knob, _) = row else { return None };
        let name = ranking.score(knob.knob.name).map(|score| 2 * score);
        let section = match knob.section {
            Section::Kind(kind) => labels[kind].as_str(),
            section => section.title(),
        };
        let group = ranking.score(&format!("{section} {}", knob.short_name()));
        let closeness = ranking.closeness(knob.knob.name).max(ranking.closeness(knob.short_name()));
        Some(((closeness, name.into_iter().chain(group).max()?), knob.knob.name))
    };
    // The first of equals.
    let mut found: Vec<_> = rows.iter().filter_map(score).collect();
    found.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
    found.into_iter().map(|(_, name)| FormSpot::Knob(name)).collect()
}

impl Dialog<Model> for FindLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let position = || (self.found > 0).then(|| format!("{} of {}", self.at + 1, self.found));
        let problem = self.prompt.problem.clone().map(|text| prompt::Remark { text, warns: true });
        let remark = problem.or_else(|| position().map(|text| prompt::Remark { text, warns: false }));
        self.prompt.paint_at_bottom(model, "knob", remark.as_ref(), screen, buffer, view);
    }

    /// Down and Up go through all that match, and from the last one to the first.
    fn key(&mut self, model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        match key.code {
            KeyCode::Down | KeyCode::Up => {
                let by = if key.code == KeyCode::Down { 1 } else { -1 };
                let count = self.found.max(1) as isize;
                self.at = (self.at as isize + by).rem_euclid(count) as usize;
                self.follow(model);
            }
            _ if self.prompt.key(key) => {
                self.at = 0;
                self.follow(model);
            }
            _ => {}
        }
        After::Stays
    }

    fn paste(&mut self, model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.at = 0;
        self.follow(model);
        After::Stays
    }

    fn cancel(&mut self, model: &mut Model, _effects: &mut Effects) {
        model.form.selected = self.before;
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
