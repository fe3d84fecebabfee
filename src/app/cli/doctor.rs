//! `linden doctor`: what was found of the terminal, the directories and the files of the user, and how
//! to say otherwise.

use std::env::consts::{ARCH, OS};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, ValueEnum};
use linden_terminal::probe::{Environment, Findings, ask};
use linden_terminal::tty::OpenError;
use linden_terminal::{Capabilities, ColorDepth, Tty};
use serde::Serialize;

use super::workbench::TerminalLook;
use crate::cache;
use crate::config::dirs::Dirs;
use crate::config::keymap::{self, Keymap};
use crate::config::settings::{self, SETTINGS, Settings};
use crate::config::theme::{self, Theme};
use crate::config::{Complaint, presets};
use crate::paths::show;
use crate::progress::Progress;
use crate::tui::key_table;

/// What is in the cache's directory.
const PICTURES: &str = "drawn pictures";

/// How long a terminal may take to answer, as in the workbench.
const PATIENCE: Duration = Duration::from_millis(1500);

/// Show what was found of terminal, directories and files, and how to force it; 1 when something is broken
#[derive(Args)]
#[command(
    after_help = "Exits with 0, and with 1 when something of yours cannot be used: a setting, a key, a theme,\n\
    a preset, a directory that cannot be written to."
)]
pub struct Doctor {
    /// Machine-readable
    #[arg(long)]
    json: bool,

    /// Print a file to begin with, all of it commented out, and nothing else
    #[arg(long, value_name = "FILE", value_enum)]
    example: Option<Example>,

    #[command(flatten)]
    pub(super) look: TerminalLook,
}

/// A file that the user may write.
#[derive(Clone, Copy, ValueEnum)]
enum Example {
    /// config.toml
    Config,
    /// keymap.toml
    Keymap,
    /// themes/NAME.toml
    Theme,
}

/// The names and meanings of `--json`: scripts rely on them.
#[derive(Serialize)]
struct DoctorReport {
    linden: &'static str,
    system: String,
    threads: usize,
    terminal: TerminalReport,
    directories: Vec<Directory>,
    settings: Vec<Set>,
    theme: String,
    presets: Presets,
    cache: Cache,
    complaints: Vec<Trouble>,
}

#[derive(Serialize)]
struct TerminalReport {
    /// Why the terminal was not asked, `null` when it was.
    not_asked: Option<String>,
    columns: Option<u16>,
    rows: Option<u16>,
    findings: Vec<TerminalFinding>,
}

#[derive(Serialize)]
struct TerminalFinding {
    what: &'static str,
    value: String,
    why: String,
    /// How to force it; `null` where nothing depends on it that one would.
    force: Option<&'static str>,
}

#[derive(Serialize)]
struct Directory {
    what: &'static str,
    path: Option<String>,
    exists: bool,
    /// `false` when it could not be made, either.
    writable: bool,
}

#[derive(Serialize)]
struct Set {
    name: &'static str,
    value: String,
    is_default: bool,
}

#[derive(Serialize)]
struct Presets {
    builtin: usize,
    #[serde(rename = "own")]
    users: usize,
    broken: usize,
}

/// Pictures that were drawn in other runs.
#[derive(Serialize)]
struct Cache {
    entries: u64,
    bytes: u64,
    /// 0: nothing is kept.
    limit_bytes: u64,
}

#[derive(Serialize)]
struct Trouble {
    file: Option<String>,
    line: Option<usize>,
    column: Option<usize>,
    message: String,
}

impl Trouble {
    fn of(complaint: &Complaint) -> Self {
        let (line, column) = complaint.place.unzip();
        Self { file: Some(show(&complaint.file)), line, column, message: complaint.message.clone() }
    }

    fn said(message: impl Into<String>) -> Self {
        Self { file: None, line: None, column: None, message: message.into() }
    }
}

impl Doctor {
    pub fn run(self) -> anyhow::Result<()> {
        match self.example {
            Some(Example::Config) => return super::print(&settings::example()),
            Some(Example::Keymap) => return super::print(&keymap::example(&key_table())),
            Some(Example::Theme) => return super::print(&theme::example()),
            None => {}
        }
        let (report, capabilities) = self.examine()?;
        if self.json {
            super::print_json(&report)?;
        } else {
            // Colours are for terminals; what was forced for one is not for a file.
            let is_shown = report.terminal.not_asked.is_none();
            let depth = if is_shown { capabilities.colors.value } else { ColorDepth::None };
            super::print(&report.text(&sample(depth)))?;
        }
        match report.complaints.len() {
            0 => Ok(()),
            1 => anyhow::bail!("something of yours cannot be used as it is"),
            n => anyhow::bail!("{n} things of yours cannot be used as they are"),
        }
    }

    fn examine(&self) -> anyhow::Result<(DoctorReport, Capabilities)> {
        let flags = self.look.overrides()?;
        let dirs = Dirs::of_environment();
        let environment = Environment::of_process();
        let (settings, mut complaints) = Settings::load(dirs.settings().as_deref());
        let mut troubles = Vec::new();
        let from_environment = linden_terminal::probe::Overrides::from_environment(&environment)
            .unwrap_or_else(|error| {
                troubles.push(Trouble::said(error.to_string()));
                linden_terminal::probe::Overrides::default()
            });
        let overrides = flags.or(from_environment).or(settings.overrides());
        let (findings, not_asked, size) = asked(&environment);
        let capabilities = Capabilities::conclude(&findings, &environment, &overrides);

        let (_, told) = Keymap::load(dirs.keymap().as_deref(), &key_table());
        complaints.extend(told);
        let light = !capabilities.dark.value;
        let (theme, told) = Theme::load(&dirs, &settings.theme, light, capabilities.colors.value);
        complaints.extend(told);
        let user_presets = dirs.presets().map_or_else(Vec::new, |dir| {
            let (found, told) = presets::list(&dir, &Progress::new());
            complaints.extend(told);
            found
        });
        let broken = user_presets.iter().filter_map(|preset| preset.state.as_ref().err());
        let count = broken.clone().count();
        troubles.extend(complaints.iter().chain(broken).map(Trouble::of));
        let directories = directories(&dirs);
        // Without pictures that are kept, all works.
        for dir in directories.iter().filter(|dir| !dir.writable && dir.what != PICTURES) {
            troubles.push(match &dir.path {
                Some(path) => Trouble {
                    file: Some(path.clone()),
                    ..Trouble::said(format!("{} cannot be written here; change its mode or owner", dir.what))
                },
                None => Trouble::said(format!("no directory for {}: set HOME", dir.what)),
            });
        }
        let force = |what| match what {
            "pictures" | "characters" => Some("--graphics, LINDEN_GRAPHICS, or graphics in config.toml"),
            "colours" => Some("--colors, LINDEN_COLORS, or colors in config.toml"),
            "background" | "dark" => Some("theme in config.toml"),
            _ => None,
        };
        let defaults = Settings::default();
        let report = DoctorReport {
            linden: linden::recipe::VERSION,
            system: format!("{OS} {ARCH}"),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            terminal: TerminalReport {
                not_asked,
                columns: size.map(|(columns, _)| columns),
                rows: size.map(|(_, rows)| rows),
                findings: capabilities
                    .rows()
                    .into_iter()
                    .map(|(what, value, why)| TerminalFinding {
                        what,
                        value,
                        why: why.to_owned(),
                        force: force(what),
                    })
                    .collect(),
            },
            directories,
            settings: SETTINGS
                .iter()
                .map(|setting| {
                    let value = setting.value(&settings);
                    let is_default = value == setting.value(&defaults);
                    Set { name: setting.name, value: linden::knob::printable(&value.to_string()), is_default }
                })
                .collect(),
            theme: linden::knob::printable(&theme.name),
            presets: Presets {
                builtin: linden::preset::builtins().len(),
                users: user_presets.len(),
                broken: count,
            },
            cache: kept(&dirs),
            complaints: troubles,
        };
        Ok((report, capabilities))
    }
}

/// What the terminal says, why it was not asked, and its columns and rows.
fn asked(environment: &Environment) -> (Findings, Option<String>, Option<(u16, u16)>) {
    let unasked = |why: String| {
        let mut findings = Findings::default();
        findings.ask_nothing();
        (findings, Some(why), None)
    };
    let tty = match Tty::open() {
        Ok(tty) => tty,
        Err(OpenError::NotATerminal(stream)) => {
            return unasked(format!(
                "{stream} is not a terminal; run 'linden doctor' in one, without a pipe"
            ));
        }
        Err(error) => return unasked(error.to_string()),
    };
    let size = tty.size();
    match ask(&tty, environment, PATIENCE) {
        Ok(findings) => (findings, None, Some((size.columns, size.rows))),
        Err(error) => unasked(format!("asking the terminal failed: {error}")),
    }
}

/// What is in the cache, as far as it can be read.
fn kept(dirs: &Dirs) -> Cache {
    let contents = dirs.pictures().and_then(|folder| cache::FolderStore::contents(&folder).ok());
    let contents = contents.unwrap_or_default();
    Cache { entries: contents.entries, bytes: contents.bytes, limit_bytes: cache::room() }
}

/// Where files are looked for and kept.
fn directories(dirs: &Dirs) -> Vec<Directory> {
    let all = [
        ("settings, keys", dirs.config.clone()),
        ("themes", dirs.themes()),
        ("presets", dirs.presets()),
        ("the session", dirs.state.clone()),
        (PICTURES, dirs.pictures()),
    ];
    all.into_iter()
        .map(|(what, path)| Directory {
            what,
            exists: path.as_deref().is_some_and(Path::is_dir),
            writable: path.as_deref().is_some_and(can_be_written),
            path: path.map(|path| show(&path)),
        })
        .collect()
}

/// Whether files can be put there, after making what is missing of the path.
fn can_be_written(path: &Path) -> bool {
    let mut at: PathBuf = path.to_owned();
    while std::fs::symlink_metadata(&at).is_err() {
        if !at.pop() {
            return false;
        }
    }
    at.is_dir() && crate::system::is_writable(&at)
}

impl DoctorReport {
    fn text(&self, sample: &str) -> String {
        let mut text = format!("linden {}, {}, {} threads\n", self.linden, self.system, self.threads);
        text += "\nTerminal\n";
        if let Some(why) = &self.terminal.not_asked {
            text += &format!("  It was not asked: {why}.\n");
        }
        if let (Some(columns), Some(rows)) = (self.terminal.columns, self.terminal.rows) {
            text += &format!("  {:14}{columns}×{rows}\n", "size");
        }
        let widest =
            self.terminal.findings.iter().map(|finding| finding.value.chars().count()).max().unwrap_or(0);
        for finding in &self.terminal.findings {
            text += &format!("  {:14}{:widest$}  {}\n", finding.what, finding.value, finding.why);
        }
        text += "\n  To force it:\n";
        let mut told = Vec::new();
        for finding in &self.terminal.findings {
            if let Some(force) = finding.force.filter(|force| !told.contains(force)) {
                let words: Vec<_> =
                    self.terminal.findings.iter().filter(|other| other.force == Some(force)).collect();
                let words: Vec<_> = words.iter().map(|finding| finding.what).collect();
                text += &format!("  {:24}{force}\n", words.join(", "));
                told.push(force);
            }
        }
        text += &format!("\n  What your font has (a box or '?': choose another with --graphics):\n{sample}");

        text += "\nDirectories\n";
        for dir in &self.directories {
            let state = match (dir.exists, dir.writable) {
                (true, true) => "",
                (false, true) => "  (made when needed)",
                (_, false) => "  (cannot be written)",
            };
            text += &format!("  {:16}{}{state}\n", dir.what, dir.path.as_deref().unwrap_or("none"));
        }
        let Presets { builtin, users, broken } = self.presets;
        let broken = if broken > 0 { format!(", {broken} of them broken") } else { String::new() };
        text += &format!("\nPresets\n  {builtin} built in, {users} of yours{broken}\n");

        let Cache { entries, bytes, limit_bytes } = self.cache;
        let (entries, bytes) = (indicatif::HumanCount(entries), indicatif::BinaryBytes(bytes));
        text += "\nCache ('linden cache')\n  ";
        text += &match limit_bytes {
            0 => "off: all pictures are drawn anew\n".to_owned(),
            limit => format!("{entries} entries, {bytes} of at most {}\n", indicatif::BinaryBytes(limit)),
        };

        text += &format!(
            "\nSettings (config.toml; 'linden doctor --example config' shows all)\n  theme in use: {}\n",
            self.theme
        );
        for setting in self.settings.iter().filter(|setting| !setting.is_default) {
            text += &format!("  {} = {}\n", setting.name, setting.value);
        }
        if self.settings.iter().all(|setting| setting.is_default) {
            text += "  all at their defaults\n";
        }

        if !self.complaints.is_empty() {
            text += "\nBroken\n";
        }
        for complaint in &self.complaints {
            let mut place = complaint.file.clone().unwrap_or_default();
            if let (Some(line), Some(column)) = (complaint.line, complaint.column) {
                place += &format!(":{line}:{column}");
            }
            let between = if place.is_empty() { "" } else { ": " };
            text += &format!("  {place}{between}{}\n", complaint.message);
        }
        text
    }
}

/// Lines that show a person whether the font has what pictures and frames are made of, and how even
/// the colours are.
fn sample(depth: ColorDepth) -> String {
    const RAMP: u32 = 36;
    let mut text = "  quadrants     ▖▗▘▝ ▙▟▛▜ ▚▞    halves  ▀▄█    frames  ╭─┬─╮ ├┼┤ ╰─┴─╯ ━┃\n\
                    \x20 braille       ⠁⠃⠇⡇ ⡏⡟⡿⣿ ⢀⣀⣤⣶    marks   ● ▶ ‖ … · ← → ↑ ↓\n"
        .to_owned();
    if depth == ColorDepth::None {
        return text;
    }
    // From bark to leaf to sky, an inch of a picture.
    let stops = [[92.0, 68.0, 48.0], [122.0, 168.0, 84.0], [150.0, 200.0, 230.0]];
    let mut rgba = Vec::new();
    for i in 0..RAMP {
        let at = 2.0 * f64::from(i) / f64::from(RAMP - 1);
        let (from, share) = (stops[(at as usize).min(1)], at - f64::from((at as u32).min(1)));
        let to = stops[(at as usize).min(1) + 1];
        rgba.extend((0..3).map(|c| (from[c] + (to[c] - from[c]) * share) as u8));
        rgba.push(255);
    }
    if let Ok(image) = linden_terminal::Image::new(RAMP, 1, &rgba) {
        let style = linden_terminal::CellStyle {
            glyphs: linden_terminal::Glyphs::Halves,
            colors: depth,
            ..Default::default()
        };
        text += &format!("  colours       {}", linden_terminal::draw_cells(&image, RAMP as u16, 1, &style));
    }
    text
}
