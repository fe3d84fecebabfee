//! Reading what the user configured.

use linden_terminal::probe::Overrides;
use linden_terminal::{Capabilities, Glyphs};

use super::probing::Probing;
use crate::config::Complaint;
use crate::config::dirs::Dirs;
use crate::config::keymap::{Keymap, Row};
use crate::config::settings::{Graphics, Settings};
use crate::config::theme::Theme;
use crate::tui::command;
use crate::tui::model::Config;

/// The table of commands as keymaps are read against.
pub fn key_table() -> Vec<Row> {
    command::all().map(|command| (command.id, command.context.id(), command.keys)).collect()
}

/// Reads settings, keymap and theme. What the command line says of the terminal comes before the
/// environment, that before the settings; complaints about the environment come beside.
pub fn configuration(probing: &mut Probing) -> (Config, Vec<String>) {
    let dirs = Dirs::of_environment();
    let (settings, mut complaints) = Settings::load(dirs.settings().as_deref());
    let mut told = Vec::new();
    let mut overrides = of_settings(&settings);
    match Overrides::from_environment(probing.environment()) {
        Ok(own) => overrides = own.or(overrides),
        Err(error) => told.push(error.to_string()),
    }
    probing.overrides = std::mem::take(&mut probing.overrides).or(overrides);
    let table = key_table();
    let (keymap, own) = Keymap::load(dirs.keymap().as_deref(), &table);
    complaints.extend(own);
    let mut config = Config { dirs, theme: Theme::dark(), keymap, settings, complaints };
    let capabilities = probing.conclude();
    let own = theme(&mut config, &capabilities);
    config.complaints.extend(own);
    (config, told)
}

/// Puts the theme in force that settings and terminal ask for.
pub fn theme(config: &mut Config, terminal: &Capabilities) -> Vec<Complaint> {
    let light = !terminal.dark.value;
    let (theme, complaints) = Theme::load(&config.dirs, &config.settings.theme, light, terminal.colors.value);
    config.theme = theme;
    complaints
}

/// What the settings say of the terminal.
fn of_settings(settings: &Settings) -> Overrides {
    const FILE: &str = "config.toml";
    let mut overrides = Overrides::default();
    let graphics = settings.graphics.map(|graphics| match graphics {
        Graphics::Kitty => "kitty",
        Graphics::Sixel => "sixel",
        Graphics::Iterm2 => "iterm2",
        Graphics::Cells(Glyphs::Quadrants) => "quadrants",
        Graphics::Cells(Glyphs::Halves) => "halves",
        Graphics::Cells(Glyphs::Braille) => "braille",
    });
    let colors = settings.colors.map(|depth| match depth {
        linden_terminal::ColorDepth::True => "truecolor",
        linden_terminal::ColorDepth::Ansi256 => "256",
        linden_terminal::ColorDepth::Ansi16 => "16",
        linden_terminal::ColorDepth::None => "none",
    });
    // The settings' own reader has checked the words.
    if let Some(word) = graphics {
        let _ = overrides.set_graphics(word, FILE);
    }
    if let Some(word) = colors {
        let _ = overrides.set_colors(word, FILE);
    }
    overrides
}
