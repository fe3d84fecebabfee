//! The lowest row: a message, or what can be done here.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use ratatui::widgets::{Clear, Widget as _};
use unicode_width::UnicodeWidthStr;

use super::page;
use crate::tui::command::Context;
use crate::tui::layout::{Target, View};
use crate::tui::model::{Command, HELP, Message, Model, Weight};
use crate::wrap::{clipped_in_paths, wrapped, wrapped_within};

/// Hints from this place on have their room before all others: the ways to other panes, to help and out.
const RESERVED: u8 = 89;
/// Between two hints.
const GAP: u16 = 2;

/// Paints the row, with the state of what is under way at its right end. A message that is longer takes the one above
/// as well, where there is one.
pub fn view(model: &Model, status: Line<'_>, [above, area]: [Rect; 2], buffer: &mut Buffer, view: &mut View) {
    if area.is_empty() {
        return;
    }
    // What is said is read now, and perhaps answered; how far an export is can be read when that has gone.
    let is_cut = |message: &Message| message.text.width() + status.width() + 2 > area.width.into();
    let is_hidden = model.message.as_ref().is_some_and(is_cut);
    let width = if is_hidden { 0 } else { (status.width() as u16).min(area.width / 2) };
    status.render(Rect { x: area.right() - width, width, ..area }, buffer);
    let area = Rect { width: area.width - width, ..area };
    if model.message.is_some() {
        message(model, above, area, buffer, view);
    } else {
        let hints = hints(model);
        paint(model, &fitting(&hints, area.width.saturating_sub(1)), area, buffer, view);
    }
}

/// What was said last; when it is longer than its rows, the key that shows all of it.
fn message(model: &Model, above: Rect, area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    let Some(message) = &model.message else { return };
    let style = match message.weight {
        Weight::Note => theme.info,
        Weight::Warning => theme.warning,
        Weight::Error => theme.error,
    };
    let mut room = area.width.saturating_sub(1);
    let rows = wrapped(&message.text, room.into()).len();
    let takes_two = rows > 1 && !above.is_empty();
    let mut places = vec![area];
    if takes_two {
        places.insert(0, above);
        for place in &places {
            Clear.render(*place, buffer);
            buffer.set_style(*place, theme.popup);
        }
        view.covers.push(above);
        view.regions.push((above, Target::Dialog(None)));
    }
    if rows > places.len()
        && let Some(more) = hint(model, "messages")
    {
        let width = more.width();
        if room > 3 * width {
            room -= width + GAP;
            let place = Rect { x: area.right() - width - 1, width: width + 1, ..area };
            paint(model, &[more], place, buffer, view);
        }
    }
    let rows = if takes_two {
        wrapped_within(&message.text, room.into(), places.len())
    } else {
        vec![clipped_in_paths(&message.text, room.into())]
    };
    let style = if takes_two { theme.popup.patch(style) } else { style };
    for (row, place) in rows.iter().zip(places) {
        buffer.set_stringn(place.x + 1, place.y, row, room.into(), style);
    }
}

/// What whoever opens the workbench for the first time is told.
pub fn welcome(model: &Model) -> String {
    let ways = [
        ("help", "all keys"),
        ("preset-next", "another tree"),
        ("shape", "its knobs"),
        ("export", "export it"),
    ];
    let key = |id| model.config.keymap.keys_of(id).first().map(|key| key_label(model, &key.to_string()));
    let ways = ways.into_iter().filter_map(|(id, what)| Some(format!("{} {what}", key(id)?)));
    format!("Welcome to linden: {}", ways.collect::<Vec<_>>().join(", "))
}

/// A command that the footer offers, with the key that runs it.
pub struct Hint {
    /// The command.
    pub command: &'static Command,
    /// Its key as people know it.
    pub key: String,
    /// What it is called here.
    pub label: &'static str,
}

impl Hint {
    fn width(&self) -> u16 {
        (self.key.width() + 1 + self.label.width()) as u16
    }
}

/// What can be done here: the commands that can be used, what matters most first, each with its
/// first key.
pub fn hints(model: &Model) -> Vec<Hint> {
    let here = model.context();
    let outer: &[Context] = if model.dialogs.is_empty() { &[Context::GLOBAL, Context::ALWAYS] } else { &[] };
    let mut found: Vec<&Command> = model
        .commands()
        .filter(|command| {
            let is_help = command.id == HELP && !here.is_typed() && here != page::CONTEXT;
            command.context == here || outer.contains(&command.context) || is_help
        })
        .filter(|command| command.hint.is_some() && (command.hindrance)(model).is_none())
        .collect();
    found.sort_by_key(|command| command.hint);
    found.into_iter().filter_map(|command| hint(model, command.id)).collect()
}

/// A command with its first key that is not taken by another one here.
fn hint(model: &Model, id: &str) -> Option<Hint> {
    let command = model.command(id)?;
    let runs_it = |key: &&linden_terminal::input::Shortcut| model.command_of(**key) == Some(command.id);
    let key = model.config.keymap.keys_of(id).iter().find(runs_it)?;
    // A pane by its name says more than 'next'.
    let label = if id == "focus-next" { model.focus.next(1).title() } else { command.title };
    Some(Hint { command, key: key_label(model, &key.to_string()), label })
}

/// Those that have room, whole, in their order: the reserved ones first, then of the others what fits before them.
fn fitting(hints: &[Hint], width: u16) -> Vec<&Hint> {
    let is_reserved = |hint: &Hint| hint.command.hint.is_some_and(|place| place >= RESERVED);
    let mut left = width;
    let mut takes = |hint: &Hint| {
        // The last one needs no gap behind it.
        let fits = hint.width() <= left;
        if fits {
            left = left.saturating_sub(hint.width() + GAP);
        }
        fits
    };
    let mut kept: Vec<usize> = Vec::new();
    for (i, hint) in hints.iter().enumerate().filter(|(_, hint)| is_reserved(hint)) {
        if takes(hint) {
            kept.push(i);
        }
    }
    for (i, hint) in hints.iter().enumerate().filter(|(_, hint)| !is_reserved(hint)) {
        if takes(hint) {
            kept.push(i);
        }
    }
    kept.sort_unstable();
    kept.into_iter().map(|i| &hints[i]).collect()
}

fn paint<'h>(
    model: &Model,
    hints: &[impl std::borrow::Borrow<Hint> + 'h],
    area: Rect,
    buffer: &mut Buffer,
    view: &mut View,
) {
    let theme = &model.config.theme;
    let mut x = area.x + 1;
    for hint in hints.iter().map(std::borrow::Borrow::borrow) {
        let place = Rect { x, width: hint.width(), ..area };
        buffer.set_string(x, area.y, &hint.key, theme.key);
        buffer.set_string(x + hint.key.width() as u16 + 1, area.y, hint.label, theme.hint);
        view.regions.push((place, Target::Command(hint.command.id)));
        x += hint.width() + GAP;
    }
}

/// A key as people know it: `^R`, and arrows as arrows, `Shift-→`, `Alt-←`, or as words on a terminal of ASCII, which
/// would show them as the keys `<` and `>`.
pub fn key_label(model: &Model, key: &str) -> String {
    label_of(key, model.terminal.unicode.value)
}

/// The same of a terminal that has arrows, or has none.
pub fn label_of(key: &str, has_arrows: bool) -> String {
    let mut label = String::new();
    let mut rest = key;
    let mut is_ctrl = false;
    while let Some((held, after)) = rest.split_once('-').filter(|(_, after)| !after.is_empty()) {
        match held {
            "ctrl" => is_ctrl = true,
            "alt" => label.push_str("Alt-"),
            "shift" => label.push_str("Shift-"),
            _ => break,
        }
        rest = after;
    }
    let named = match rest {
        "left" if !has_arrows => "Left",
        "right" if !has_arrows => "Right",
        "up" if !has_arrows => "Up",
        "down" if !has_arrows => "Down",
        "left" => "←",
        "right" => "→",
        "up" => "↑",
        "down" => "↓",
        "enter" => "Enter",
        "esc" => "Esc",
        "tab" => "Tab",
        "space" => "Space",
        "home" => "Home",
        "end" => "End",
        "pageup" => "PgUp",
        "pagedown" => "PgDn",
        "backspace" => "Backspace",
        "delete" => "Del",
        "insert" => "Ins",
        other => other,
    };
    let is_function = named.len() > 1 && named.starts_with('f') && named[1..].parse::<u8>().is_ok();
    match (is_ctrl, named.chars().count()) {
        (true, 1) => label + "^" + &named.to_uppercase(),
        (true, _) => format!("Ctrl-{label}{named}"),
        (false, _) if is_function => label + &named.to_uppercase(),
        (false, _) => label + named,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::config::keymap::Keymap;
    use crate::tui::testing::Bench;

    #[test]
    fn a_welcome_names_keys_as_they_are() {
        let mut bench = Bench::new(90, 24).without_pictures();
        let said = welcome(&bench.model);
        assert_eq!(said, "Welcome to linden: ? all keys, j another tree, o its knobs, e export it");
        let keymap = "[keys]\npreset-next = \"n\"\n";
        let (keymap, _) = Keymap::read(Path::new("keymap.toml"), keymap, &crate::tui::commands::key_table());
        bench.model.config.keymap = keymap;
        assert!(welcome(&bench.model).starts_with("Welcome to linden: ? all keys, n another tree"));
    }

    #[test]
    fn keys_are_called_what_people_call_them() {
        let expected = [
            ("j", "j"),
            ("G", "G"),
            ("-", "-"),
            ("ctrl-r", "^R"),
            ("ctrl-left", "^←"),
            ("ctrl-enter", "Ctrl-Enter"),
            ("shift-right", "Shift-→"),
            ("alt-left", "Alt-←"),
            ("shift-tab", "Shift-Tab"),
            ("f1", "F1"),
            ("f", "f"),
            ("pagedown", "PgDn"),
            ("ctrl--", "^-"),
        ];
        for (key, label) in expected {
            assert_eq!(label_of(key, true), label);
        }
        for (key, label) in [("left", "Left"), ("ctrl-up", "Ctrl-Up"), ("shift-right", "Shift-Right")] {
            assert_eq!(label_of(key, false), label, "ASCII has no arrows");
        }
    }
}
