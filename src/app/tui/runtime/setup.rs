//! Reads what the user configured.

use linden_terminal::Capabilities;
use linden_terminal::probe::Overrides;

use super::probing::Probing;
use crate::config::Complaint;
use crate::config::dirs::Dirs;
use crate::config::keymap::Keymap;
use crate::config::settings::Settings;
use crate::config::theme::Theme;
use crate::tui::commands;
use crate::tui::model::Config;

/// Reads settings, keymap and theme. What the command line says of the terminal comes before the
/// environment, that before the settings; complaints about the environment come beside.
pub fn configuration(probing: &mut Probing) -> (Config, Vec<String>) {
    let dirs = Dirs::of_environment();
    let (settings, mut complaints) = Settings::load(dirs.settings().as_deref());
    let told = override_terminal(probing, &settings);
    let table = commands::key_table();
    let (keymap, found) = Keymap::load(dirs.keymap().as_deref(), &table);
    complaints.extend(found);
    let mut config = Config { dirs, theme: Theme::dark(), keymap, settings, complaints };
    let capabilities = probing.conclude();
    let found = theme(&mut config, &capabilities);
    config.complaints.extend(found);
    (config, told)
}

/// Puts what settings and the environment say of the terminal in the place of what is found; gives complaints about
/// the environment.
pub fn override_terminal(probing: &mut Probing, settings: &Settings) -> Vec<String> {
    let mut told = Vec::new();
    let mut overrides = settings.overrides();
    match Overrides::from_environment(probing.environment()) {
        Ok(named) => overrides = named.or(overrides),
        Err(error) => told.push(error.to_string()),
    }
    probing.take_overrides(overrides);
    told
}

/// Puts the theme in force that settings and terminal ask for.
pub fn theme(config: &mut Config, terminal: &Capabilities) -> Vec<Complaint> {
    let light = !terminal.dark.value;
    let (theme, complaints) = Theme::load(&config.dirs, &config.settings.theme, light, terminal.colors.value);
    config.theme = theme;
    complaints
}
