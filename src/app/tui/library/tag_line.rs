//! The tags of a preset, typed.

use crossterm::event::KeyEvent;
use linden::preset::{MOST_TAGS, check_tag};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::chrome::prompt::{self, Prompt};
use crate::tui::command::Context;
use crate::tui::dialog::{After, Dialog};
use crate::tui::effect::Effects;
use crate::tui::layout::View;
use crate::tui::model::Model;

/// The line of a preset's tags.
pub struct TagLine {
    prompt: Prompt,
}

impl TagLine {
    /// With the tags that the user gave it.
    pub fn new(model: &Model) -> Self {
        let given = model.library.given_tags().join(" ");
        Self { prompt: Prompt::new(&given) }
    }

    fn read(&self) -> Result<Vec<String>, String> {
        let typed = self.prompt.text().split([' ', ',']).filter(|tag| !tag.is_empty());
        let mut tags: Vec<String> = Vec::new();
        for tag in typed.map(|tag| tag.trim_start_matches('#').to_lowercase()) {
            check_tag(&tag)?;
            if !tags.contains(&tag) {
                tags.push(tag);
            }
        }
        let many = || format!("{} tags are more than the {MOST_TAGS} that a preset may have", tags.len());
        if tags.len() > MOST_TAGS { Err(many()) } else { Ok(tags) }
    }

    fn judge(&mut self) {
        self.prompt.problem = self.read().err();
    }
}

impl Dialog<Model> for TagLine {
    fn context(&self) -> Context {
        prompt::CONTEXT
    }

    fn is_prompt(&self) -> bool {
        true
    }

    fn paint(&self, model: &Model, screen: Rect, buffer: &mut Buffer, view: &mut View) {
        let entry = model.library.entry();
        let of_document = entry.map_or(&[][..], |entry| entry.tags.as_slice());
        let remark = match &self.prompt.problem {
            Some(problem) => prompt::Remark { text: problem.clone(), warns: true },
            None if of_document.is_empty() => prompt::Remark {
                text: "words that the preset is found by: /#hedge and 'linden list --tag hedge'".to_owned(),
                warns: false,
            },
            None => prompt::Remark {
                text: format!("besides those that its document has: {}", of_document.join(" ")),
                warns: false,
            },
        };
        let id = entry.map_or_else(String::new, |entry| linden::knob::excerpt(&entry.id));
        self.prompt.paint_at_bottom(model, &format!("tags of {id}"), Some(&remark), screen, buffer, view);
    }

    fn key(&mut self, _model: &mut Model, key: KeyEvent, _effects: &mut Effects) -> After {
        if self.prompt.key(key) {
            self.judge();
        }
        After::Stays
    }

    fn paste(&mut self, _model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.prompt.paste(text);
        self.judge();
        After::Stays
    }

    fn accept(&mut self, model: &mut Model, _effects: &mut Effects) -> After {
        match self.read() {
            Ok(tags) => {
                let said = if tags.is_empty() {
                    "no tags of yours".to_owned()
                } else {
                    format!("tagged #{}", tags.join(" #"))
                };
                model.library.tag(tags);
                model.say(said);
                After::Closes
            }
            Err(why) => {
                self.prompt.problem = Some(why);
                After::Stays
            }
        }
    }

    fn leave(&mut self, model: &mut Model, effects: &mut Effects) -> After {
        self.take_or_give_up(model, effects)
    }
}
