//! What the dialog offers: formats, their options, and where each goes. All of it is made from the
//! exporters' registry; nothing here knows a format.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossterm::event::KeyEvent;
use linden::knob::{Kind, Value};
use linden::preset::PresetKnob;
use linden::season::Season;
use linden_exporters::{Estimate, Exporter, OptionSpec, Options, Profile, USUAL};
use tui_input::Input;

use super::ages::age_turned;
use super::knobs::ExportKnobs;
use crate::config::session;
use crate::jobs::{Findings, Inquiry, ShownTree, TargetFinding};
use crate::paths;
use crate::tui::chrome::prompt::{common_start, edit, paste};
use crate::tui::command::Context;
use crate::tui::model::KeptExport;
use crate::tui::shape::nudge::{Nudge, nudged};
use crate::tui::tree::{Tree, TreePlace};
use linden_exporters::{Output, default_name};

/// How the session's file calls it that camera, sun, sky and ground go along.
const SCENE: &str = "scene";
/// How it calls the seasons that are written.
const SEASONS: &str = "seasons";
/// How it calls the program that files are for.
const CLIENT: &str = "for";
/// The option that formats have which show one view.
const YAW: &str = "yaw";
/// Where the dialog's keys are listened to.
pub const CONTEXT: Context = Context::new(50, "export", "While exporting");
/// Where the keys of a line in the dialog are listened to.
pub const LINE: Context = Context::new(51, "export-line", "While typing where to export to").typed();

/// What the dialog offers.
pub struct ExportDialog {
    /// As many as the registry has, in its order.
    pub formats: Vec<FormatChoice>,
    /// Where the cursor is; by what it is on, so that it stays when rows come and go.
    pub cursor: ExportSpot,
    /// The line that is typed, at the cursor.
    pub line: Option<Typing>,
    /// How far the start is.
    pub start: StartState,
    /// The program that files are for.
    pub client: Option<&'static Profile>,
    /// Whether camera, sun, sky and ground go along.
    pub scene: bool,
    /// The seasons that are written, as they were typed; empty: the one that the tree is in.
    pub seasons: String,
    /// The ages that the tree is written at, as they were typed; empty: the one that it has.
    pub ages: String,
    /// The knob that says how old the tree is, where it was turned.
    pub age_turned: Option<&'static str>,
    /// Knobs of the tree that are turned for this export; none of a forest.
    pub knobs: Option<ExportKnobs>,
    /// Options that are set as the picture on screen is: format and option by their places, and the value.
    as_on_screen: Vec<(usize, usize, Value)>,
    /// What was found out about targets, and where they are from the root on, by their format and what was typed.
    findings: BTreeMap<(&'static str, String), (TargetFinding, PathBuf)>,
    /// What the tree will amount to.
    estimate: Option<(Arc<ShownTree>, Estimate)>,
    /// Raised whenever everything is to be found out anew.
    round: u32,
    id: String,
}

/// A format, chosen or not.
pub struct FormatChoice {
    /// The format.
    pub exporter: &'static dyn Exporter,
    /// Whether it is written.
    pub chosen: bool,
    /// Its options.
    pub options: Options,
    /// Where, as it was typed.
    pub target: String,
}

/// What a row is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportSpot {
    /// A format, by its place in the registry.
    Format(usize),
    /// An option of a chosen format.
    Option(usize, usize),
    /// Where a chosen format goes.
    Target(usize),
    /// The program that files are for.
    Client,
    /// A knob of the tree, by its place among those that are turned here.
    Knob(usize),
    /// In which seasons the tree is written.
    Seasons,
    /// At which ages the tree is written.
    Ages,
    /// Whether camera, sun, sky and ground go along.
    Scene,
    /// The button.
    Start,
}

/// How far the start is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartState {
    /// Nothing was pressed.
    Idle,
    /// The button was pressed, and the targets are looked at.
    Looking,
    /// Files would be replaced: yes or no.
    Asking,
}

/// A line that is typed.
pub struct Typing {
    /// What was typed.
    pub input: Input,
    /// What is wrong with it.
    pub problem: Option<String>,
    /// What it may go on to be, where that is more than one.
    pub offers: Vec<String>,
    /// What is being completed: what stood before the cursor.
    completes: Option<String>,
}

impl Typing {
    fn new(text: &str) -> Self {
        Self { input: Input::new(text.to_owned()), problem: None, offers: Vec::new(), completes: None }
    }

    fn changed(&mut self) {
        self.problem = None;
        self.offers.clear();
        self.completes = None;
    }
}

impl FormatChoice {
    /// An option's row of the format's table, and its value.
    pub fn option(&self, index: usize) -> Option<(&'static OptionSpec, &Value)> {
        let spec = self.exporter.format().options.get(index)?;
        Some((spec, self.options.iter().nth(index)?.1))
    }
}

impl ExportDialog {
    /// The dialog for an id and what it can be written in, with what was chosen last.
    pub fn new(
        last: &session::ExportChoices,
        id: &str,
        all: &[&'static dyn Exporter],
        tree: Option<&Tree>,
    ) -> Self {
        let client = last.options.iter().find(|(name, _)| name == CLIENT);
        let client = client.and_then(|(_, id)| Profile::find(id).ok());
        let known = |format: &str| all.iter().any(|exporter| exporter.format().id == format);
        let is_first = !last.formats.iter().any(|format| known(format));
        let choice = |exporter: &&'static dyn Exporter| {
            let format = exporter.format();
            let suited = client.and_then(|client| client.options(format).ok());
            let mut options = suited.unwrap_or_else(|| Options::new(format));
            for (name, value) in &last.options {
                // What another version had is left out.
                if let Some((_, name)) = name.split_once('.').filter(|(of, _)| *of == format.id) {
                    let _ = options.set(name, value);
                }
            }
            let at_place = last.formats.iter().position(|known| known == format.id);
            let before = at_place.and_then(|at| last.targets.get(at)).or(last.targets.first());
            let directory = before.map_or("", |target| directory_of(target));
            FormatChoice {
                exporter: *exporter,
                chosen: at_place.is_some() || (is_first && format.id == USUAL.format().id),
                options,
                target: in_directory(directory, &default_name(id, *exporter)),
            }
        };
        let formats: Vec<_> = all.iter().map(choice).collect();
        let cursor = formats.iter().position(|choice| choice.chosen).unwrap_or(0);
        let mut dialog = Self {
            formats,
            cursor: ExportSpot::Format(cursor),
            line: None,
            start: StartState::Idle,
            client: None,
            scene: last.options.iter().any(|(name, value)| name == SCENE && value == "true"),
            seasons: last.options.iter().find(|(name, _)| name == SEASONS).map_or_else(
                String::new,
                |(_, list)| {
                    if seasons_of(list).is_ok() { list.clone() } else { String::new() }
                },
            ),
            ages: String::new(),
            age_turned: tree.and_then(age_turned),
            knobs: tree.map(|tree| ExportKnobs::new(tree.wanted(), tree.turned())),
            as_on_screen: Vec::new(),
            findings: BTreeMap::new(),
            estimate: None,
            round: 0,
            id: id.to_owned(),
        };
        dialog.take_client(client);
        dialog
    }

    /// Ticks a format, and puts the cursor on it.
    pub fn choose(&mut self, format: &str) {
        if let Some(i) = self.formats.iter().position(|choice| choice.exporter.format().id == format) {
            self.formats[i].chosen = true;
            self.cursor = ExportSpot::Format(i);
        }
    }

    /// The rows from the top.
    pub fn spots(&self) -> Vec<ExportSpot> {
        let mut spots = Vec::new();
        for (i, choice) in self.formats.iter().enumerate() {
            spots.push(ExportSpot::Format(i));
            if choice.chosen {
                spots.push(ExportSpot::Target(i));
                spots.extend((0..choice.exporter.format().options.len()).map(|k| ExportSpot::Option(i, k)));
            }
        }
        spots.push(ExportSpot::Client);
        spots.extend(self.knobs.as_ref().map(|_| ExportSpot::Ages));
        spots.extend((0..self.knobs.as_ref().map_or(0, ExportKnobs::len)).map(ExportSpot::Knob));
        spots.extend(self.knobs.as_ref().map(|_| ExportSpot::Seasons));
        spots.extend([ExportSpot::Scene, ExportSpot::Start]);
        spots
    }

    /// Sets the options of pictures that say how they are seen, as names and values, but those that `set` has as
    /// `FORMAT.OPTION`.
    pub fn see_as(&mut self, view: &[(&'static str, String)], set: &[(String, String)]) {
        for (i, choice) in self.formats.iter_mut().enumerate() {
            let format = choice.exporter.format();
            // A sheet of several has its trees side by side.
            if format.options.iter().all(|spec| spec.knob.name != YAW) {
                continue;
            }
            for (k, spec) in format.options.iter().enumerate() {
                let name = format!("{}.{}", format.id, spec.knob.name);
                let seen = view.iter().find(|(option, _)| *option == spec.knob.name);
                if let Some((_, text)) = seen.filter(|_| set.iter().all(|(set, _)| *set != name))
                    && choice.options.set(spec.knob.name, text).is_ok()
                    && let Some((_, value)) = choice.options.iter().nth(k)
                {
                    self.as_on_screen.push((i, k, value.clone()));
                }
            }
        }
    }

    /// Whether an option of a format is as the picture on screen is.
    pub fn is_as_on_screen(&self, format: usize, option: usize) -> bool {
        let now = self.formats.get(format).and_then(|choice| choice.option(option));
        let seen = |(i, k, value): &(usize, usize, Value)| {
            (*i, *k) == (format, option) && now.is_some_and(|(_, now)| now == value)
        };
        self.as_on_screen.iter().any(seen)
    }

    /// What was set, for when it is opened again on the same.
    pub fn kept(&self, place: TreePlace) -> KeptExport {
        let turned = self.knobs.iter().flat_map(ExportKnobs::turned);
        KeptExport { place, choices: self.choices(), knobs: turned.collect(), ages: self.ages.clone() }
    }

    /// Sets what was kept and the choices do not say.
    pub fn restore(&mut self, kept: &KeptExport) {
        for (format, target) in kept.choices.formats.iter().zip(&kept.choices.targets) {
            let choice = self.formats.iter_mut().find(|choice| choice.exporter.format().id == format);
            if let Some(choice) = choice {
                choice.target.clone_from(target);
            }
        }
        if let Some(knobs) = &mut self.knobs {
            knobs.turn(&kept.knobs);
        }
        // They may not be allowed any more: its age was turned since.
        if self.ages_of(&kept.ages).is_ok() {
            self.ages.clone_from(&kept.ages);
        }
    }

    /// Where the files of each format go, as it was typed.
    pub fn targets(&self) -> Vec<(&'static str, String)> {
        self.formats.iter().map(|choice| (choice.exporter.format().id, choice.target.clone())).collect()
    }

    /// Lets the files of formats go where they went before.
    pub fn name(&mut self, targets: &[(&'static str, String)]) {
        for choice in &mut self.formats {
            if let Some((_, target)) = targets.iter().find(|(id, _)| *id == choice.exporter.format().id) {
                choice.target.clone_from(target);
            }
        }
    }

    /// Formats that are written.
    pub fn chosen(&self) -> impl Iterator<Item = &FormatChoice> {
        self.formats.iter().filter(|choice| choice.chosen)
    }

    /// Moves the cursor by a number of rows.
    pub fn step(&mut self, by: isize) {
        let spots = self.spots();
        let at = spots.iter().position(|spot| *spot == self.cursor).unwrap_or(0);
        self.go_to(spots[at.saturating_add_signed(by).min(spots.len() - 1)]);
    }

    /// Moves the cursor; a question that was asked is taken back.
    pub fn go_to(&mut self, spot: ExportSpot) {
        self.cursor = spot;
        self.start = StartState::Idle;
    }

    /// Ticks a format, turns a switch over, goes to the next choice; whether there was any of it.
    pub fn toggle(&mut self) -> bool {
        if let ExportSpot::Format(i) = self.cursor {
            self.formats[i].chosen = !self.formats[i].chosen;
            self.start = StartState::Idle;
            return true;
        }
        if self.cursor == ExportSpot::Scene {
            (self.scene, self.start) = (!self.scene, StartState::Idle);
            return true;
        }
        if self.cursor == ExportSpot::Client {
            return self.nudge(true);
        }
        if let Some((knob, ..)) = self.knob_row() {
            return is_toggled(&knob.knob.kind) && self.nudge(true);
        }
        let is_toggled = self.option().is_some_and(|(_, spec, _)| is_toggled(&spec.knob.kind));
        is_toggled && self.nudge(true)
    }

    /// Changes the option at the cursor by one; whether that can be.
    pub fn nudge(&mut self, up: bool) -> bool {
        if let (ExportSpot::Knob(row), Some(knobs)) = (self.cursor, &mut self.knobs) {
            self.start = StartState::Idle;
            return knobs.nudge(row, up);
        }
        if self.cursor == ExportSpot::Client {
            self.start = StartState::Idle;
            self.nudge_client(up);
            return true;
        }
        let Some((i, spec, value)) = self.option() else { return false };
        let Some(text) = nudged(&spec.knob.kind, value, up, Nudge::Usual) else { return false };
        self.start = StartState::Idle;
        // What a nudge gives is a value of its kind.
        self.formats[i].options.set(spec.knob.name, &text).is_ok()
    }

    /// The knob at the cursor that is turned for this export.
    fn knob_row(&self) -> Option<(&PresetKnob, Value, bool)> {
        let ExportSpot::Knob(row) = self.cursor else { return None };
        self.knobs.as_ref()?.row(row)
    }

    /// The option at the cursor: its format's place, its row, its value.
    fn option(&self) -> Option<(usize, &'static OptionSpec, &Value)> {
        let ExportSpot::Option(i, k) = self.cursor else { return None };
        let (spec, value) = self.formats.get(i)?.option(k)?;
        Some((i, spec, value))
    }

    /// Begins to type what is at the cursor, where that can be typed.
    pub fn begin_line(&mut self) {
        let text = match self.cursor {
            ExportSpot::Target(i) => self.formats[i].target.clone(),
            ExportSpot::Option(..) => {
                self.option().map(|(_, _, value)| value.to_string()).unwrap_or_default()
            }
            ExportSpot::Knob(_) => self.knob_row().map(|(_, value, _)| value.to_string()).unwrap_or_default(),
            ExportSpot::Seasons => self.seasons.clone(),
            ExportSpot::Ages => self.ages.clone(),
            ExportSpot::Format(_) | ExportSpot::Client | ExportSpot::Scene | ExportSpot::Start => return,
        };
        self.start = StartState::Idle;
        self.line = Some(Typing::new(&text));
    }

    /// Takes what was typed; a value that the option refuses stays, with the reason.
    pub fn accept_line(&mut self) {
        let Some(text) = self.line.as_ref().map(|line| line.input.value().trim().to_owned()) else { return };
        let ages = self.ages_of(&text);
        let Some(line) = &mut self.line else { return };
        match self.cursor {
            ExportSpot::Target(i) => {
                let choice = &mut self.formats[i];
                choice.target = text;
                // A directory is named: the file in it has its usual name.
                if choice.target.ends_with(std::path::is_separator) {
                    choice.target = in_directory(&choice.target, &default_name(&self.id, choice.exporter));
                }
            }
            ExportSpot::Option(i, k) => {
                let spec = &self.formats[i].exporter.format().options[k];
                if let Err(error) = self.formats[i].options.set(spec.knob.name, &text) {
                    line.problem = Some(error.to_string());
                    return;
                }
            }
            ExportSpot::Knob(row) => {
                if let Some(Err(problem)) = self.knobs.as_mut().map(|knobs| knobs.set(row, &text)) {
                    line.problem = Some(problem);
                    return;
                }
            }
            ExportSpot::Seasons => match seasons_of(&text) {
                Ok(_) => self.seasons = text,
                Err(problem) => {
                    line.problem = Some(problem);
                    return;
                }
            },
            ExportSpot::Ages => match ages {
                Ok(_) => self.ages = text,
                Err(problem) => {
                    line.problem = Some(problem);
                    return;
                }
            },
            ExportSpot::Format(_) | ExportSpot::Client | ExportSpot::Scene | ExportSpot::Start => {}
        }
        self.line = None;
    }

    /// A key for the line.
    pub fn typed(&mut self, key: KeyEvent) {
        if let Some(line) = &mut self.line
            && edit(&mut line.input, key)
        {
            line.changed();
        }
    }

    /// Pasted text for the line.
    pub fn pasted(&mut self, text: &str) {
        if let Some(line) = &mut self.line {
            paste(&mut line.input, text);
            line.changed();
        }
    }

    /// Whether the line that is typed is a path.
    pub fn types_path(&self) -> bool {
        self.line.is_some() && matches!(self.cursor, ExportSpot::Target(_))
    }

    /// Asks what the path before the cursor may go on to be.
    pub fn complete(&mut self) {
        let is_path = self.types_path();
        if let Some(line) = self.line.as_mut().filter(|_| is_path) {
            line.completes = Some(line.input.value().chars().take(line.input.cursor()).collect());
        }
    }

    /// The button: everything is looked at anew, and then it starts or asks.
    pub fn press(&mut self) {
        self.cursor = ExportSpot::Start;
        self.start = StartState::Looking;
        self.round = self.round.wrapping_add(1);
    }

    /// What has to be found out, `shown` being the tree on screen.
    ///
    /// `levels` are those of what is on screen.
    pub fn inquiry(&self, shown: Option<&Arc<ShownTree>>, levels: usize, sources: Vec<PathBuf>) -> Inquiry {
        let target = |(i, choice): (usize, &FormatChoice)| {
            let typed = match &self.line {
                Some(line) if self.cursor == ExportSpot::Target(i) => line.input.value().trim(),
                _ => choice.target.as_str(),
            };
            Output::new(choice.exporter, choice.options.clone(), PathBuf::from(typed))
        };
        let chosen = self.formats.iter().enumerate().filter(|(_, choice)| choice.chosen);
        Inquiry {
            round: self.round,
            targets: chosen.map(target).collect(),
            levels: self.knobs.as_ref().map_or(levels, ExportKnobs::levels),
            seasons: self.chosen_seasons(),
            ages: self.chosen_ages().into_iter().map(|age| age.name).collect(),
            completes: self.line.as_ref().and_then(|line| line.completes.clone()),
            shown: shown.filter(|shown| !self.is_another_tree() && self.estimate(shown).is_none()).cloned(),
            sources,
        }
    }

    /// Takes what was found out; gives whether everything is known that the start waits for.
    pub fn take(&mut self, findings: Findings) -> bool {
        let Findings { inquiry, targets, places, completions } = findings;
        if let Some(line) = &mut self.line
            && line.completes.is_some()
            && line.completes == inquiry.completes
        {
            complete(line, completions);
        }
        let place =
            |output: &Output| (output.exporter.format().id, output.path.to_string_lossy().into_owned());
        self.findings = inquiry.targets.iter().map(place).zip(targets.into_iter().zip(places)).collect();
        self.start == StartState::Looking && inquiry.round == self.round
    }

    /// Whether what is exported is not what is on screen: its size is not known.
    pub fn is_another_tree(&self) -> bool {
        let is_turned = self.knobs.as_ref().is_some_and(|knobs| !knobs.is_idle());
        is_turned || !self.chosen_seasons().is_empty() || !self.chosen_ages().is_empty()
    }

    /// The seasons that are written; none: the one that the tree is in.
    pub fn chosen_seasons(&self) -> Vec<Season> {
        if self.knobs.is_none() { Vec::new() } else { seasons_of(&self.seasons).unwrap_or_default() }
    }

    /// Takes what a tree will amount to.
    pub fn take_estimate(&mut self, shown: Arc<ShownTree>, estimate: Estimate) {
        self.estimate = Some((shown, estimate));
    }

    /// What a tree will amount to, once it is known.
    pub fn estimate(&self, shown: &Arc<ShownTree>) -> Option<&Estimate> {
        if self.is_another_tree() {
            return None;
        }
        self.estimate.as_ref().filter(|(of, _)| Arc::ptr_eq(of, shown)).map(|(_, estimate)| estimate)
    }

    /// What was found out about where a format goes.
    pub fn finding(&self, choice: &FormatChoice) -> Option<&TargetFinding> {
        self.finding_at(choice, &choice.target)
    }

    /// What was found out about what stands in a format's line.
    pub fn finding_at(&self, choice: &FormatChoice, target: &str) -> Option<&TargetFinding> {
        Some(&self.found_at(choice, target)?.0)
    }

    /// Where what stands in a format's line is from the root on, once that was found out.
    pub fn place_at(&self, choice: &FormatChoice, target: &str) -> Option<&Path> {
        Some(&self.found_at(choice, target)?.1)
    }

    fn found_at(&self, choice: &FormatChoice, target: &str) -> Option<&(TargetFinding, PathBuf)> {
        self.findings.get(&(choice.exporter.format().id, target.trim().to_owned()))
    }

    /// The first format that cannot be written where it should go, and why.
    pub fn unfit(&self) -> Option<(usize, String)> {
        let mut chosen = self.formats.iter().enumerate().filter(|(_, choice)| choice.chosen);
        let why = |(i, choice): (usize, &FormatChoice)| match self.finding(choice) {
            Some(TargetFinding::Unfit(why)) => Some((i, why.clone())),
            _ => None,
        };
        chosen.find_map(why)
    }

    /// Whether Space does something in the row at the cursor.
    pub fn can_toggle(&self) -> bool {
        match self.cursor {
            ExportSpot::Format(_) | ExportSpot::Scene | ExportSpot::Client => true,
            ExportSpot::Knob(_) => self.knob_row().is_some_and(|(knob, ..)| is_toggled(&knob.knob.kind)),
            ExportSpot::Option(..) => self.option().is_some_and(|(_, spec, _)| is_toggled(&spec.knob.kind)),
            ExportSpot::Target(_) | ExportSpot::Seasons | ExportSpot::Ages | ExportSpot::Start => false,
        }
    }

    /// Files that would be replaced.
    pub fn replaced(&self) -> Vec<PathBuf> {
        let there = |choice: &FormatChoice| match self.finding(choice) {
            Some(TargetFinding::Replaces(files)) => files.clone(),
            _ => Vec::new(),
        };
        self.chosen().flat_map(there).collect()
    }

    /// Whether a directory is missing for any of them, and can be made.
    pub fn makes_folders(&self) -> bool {
        self.chosen().any(|choice| self.finding(choice) == Some(&TargetFinding::NewFolder))
    }

    /// What is written where.
    pub fn outputs(&self) -> Vec<Output> {
        let output = |choice: &FormatChoice| {
            Output::new(choice.exporter, choice.options.clone(), PathBuf::from(&choice.target))
        };
        self.chosen().map(output).collect()
    }

    /// What was chosen, for next time.
    pub fn choices(&self) -> session::ExportChoices {
        let mut options = Vec::new();
        options.extend(self.client.map(|client| (CLIENT.to_owned(), client.id.to_owned())));
        if self.scene {
            options.push((SCENE.to_owned(), "true".to_owned()));
        }
        if !self.seasons.is_empty() {
            options.push((SEASONS.to_owned(), self.seasons.clone()));
        }
        for (i, choice) in self.formats.iter().enumerate() {
            let format = choice.exporter.format();
            // What the program sets it sets again.
            for (name, value) in choice.turned(self.client) {
                let row = format.options.iter().position(|spec| spec.knob.name == name);
                // How the picture is seen now is asked anew.
                if !row.is_some_and(|k| self.is_as_on_screen(i, k)) {
                    options.push((format!("{}.{name}", format.id), value));
                }
            }
        }
        session::ExportChoices {
            targets: self.chosen().map(|choice| choice.target.clone()).collect(),
            formats: self.chosen().map(|choice| choice.exporter.format().id.to_owned()).collect(),
            options,
        }
    }
}

/// Reads a list of seasons as `--seasons` does; an empty one is none.
fn seasons_of(text: &str) -> Result<Vec<Season>, String> {
    match text.trim() {
        "" => Ok(Vec::new()),
        "all" => Ok(Season::all()),
        list => Season::parse_list(list).map_err(|error| error.to_string()),
    }
}

/// Whether an option has so few values that keys go through them.
pub fn is_toggled(kind: &Kind) -> bool {
    matches!(kind, Kind::Switch | Kind::Choice(_))
}

/// A target's directory as it was typed, with the separator at its end; nothing for the current one.
fn directory_of(target: &str) -> &str {
    target.rfind(std::path::is_separator).map_or("", |at| &target[..=at])
}

/// A name in such a directory, as it is typed.
fn in_directory(directory: &str, name: &str) -> String {
    if directory.is_empty() { paths::typed(name) } else { format!("{directory}{}", name.replace('$', "$$")) }
}

/// Goes on with a line as far as all completions agree, and offers them.
fn complete(line: &mut Typing, completions: Vec<String>) {
    let Some(typed) = line.completes.take() else { return };
    let Some(common) = common_start(&completions) else {
        line.problem = Some("no name there begins like that".to_owned());
        return;
    };
    let cursor = common.chars().count();
    let behind: String = line.input.value().chars().skip(typed.chars().count()).collect();
    line.input = Input::new(format!("{common}{behind}")).with_cursor(cursor);
    line.problem = None;
    line.offers = if completions.len() > 1 { completions } else { Vec::new() };
}
