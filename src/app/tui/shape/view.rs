//! The form, painted.

use linden::knob::{Kind, Value};
use linden::preset::{Preset, PresetKnob, Section};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Paragraph, Widget, Wrap};
use unicode_width::UnicodeWidthStr;

use super::slider::Scale;
use super::value::ValueLine;
use super::{FormRow, called, complete, edit_lines, forecast, listed, resolved, spot};
use crate::tui::chrome::prompt::Prompt;
use crate::tui::forest::ForestOnScreen;
use crate::tui::layout::{Pane, Target, View, first_row};
use crate::tui::model::{FormSpot, Model};
use crate::tui::tree::{Tree, grammar_of};
use crate::wrap::{clipped, wrapped, wrapped_within};

/// Rows that explain what the cursor is on, where there is room: a third of the form, within these.
const ABOUT: [u16; 2] = [4, 9];
/// Cells of the bar that shows where a value stands in its range.
const SLIDER: usize = 20;
/// The fewest that tell anything.
const LEAST_SLIDER: usize = 6;
/// Columns of a knob's name.
const NAME: u16 = 18;
/// The marks of what differs from the document, of the same while the document is looked at, and of
/// what was refused.
const TURNED: &str = "●";
const ASIDE: &str = "○";
const REFUSED: &str = "✗";

/// What the pane's heading says beside its name.
pub fn heading(model: &Model) -> Vec<Span<'static>> {
    let theme = &model.config.theme;
    match &model.tree {
        Some(tree) if tree.compares => vec![Span::styled("○ as saved ", theme.warning)],
        Some(_) if model.form.only_turned => vec![Span::styled("● changed alone ", theme.modified)],
        Some(tree) if tree.is_modified() => vec![Span::styled("● modified ", theme.modified)],
        None if model.forest.as_ref().is_some_and(ForestOnScreen::is_modified) => {
            vec![Span::styled("● modified ", theme.modified)]
        }
        _ => Vec::new(),
    }
}

/// Paints the form.
pub fn view(model: &Model, area: Rect, buffer: &mut Buffer, view: &mut View) {
    let theme = &model.config.theme;
    if let Some(forest) = &model.forest {
        return crate::tui::forest::view::view(model, forest, area, buffer, view);
    }
    let Some(tree) = &model.tree else {
        let text = if model.loading.is_some() { "reading …" } else { "choose a preset" };
        buffer.set_stringn(area.x, area.y, text, area.width.into(), theme.dim);
        return;
    };
    let about = if area.height >= 12 { (area.height / 3).clamp(ABOUT[0], ABOUT[1]) } else { 0 };
    let list = Rect { height: area.height - about, ..area };
    let rows = listed(model, tree);
    let chosen = spot(model, &rows);
    let other = if tree.compares { tree.recipe() } else { tree.saved() };
    let form = FormView {
        model,
        tree,
        chosen,
        culprit: culprit(tree),
        other: &other.preset,
        other_rules: grammar_of(&other.preset)
            .map(|grammar| super::grammar::lines(grammar).0)
            .unwrap_or_default(),
        other_edits: edit_lines(&other.preset),
    };
    let at = rows.iter().position(|row| row.spot().is_some() && row.spot() == chosen).unwrap_or(0);
    if rows.is_empty() && !list.is_empty() {
        let text = clipped("nothing differs from the saved preset", list.width.into());
        buffer.set_stringn(list.x, list.y, text, list.width.into(), theme.dim);
    }
    let first = first_row(at, rows.len(), list.height.into());
    for (y, (i, row)) in (list.y..list.bottom()).zip(rows.iter().enumerate().skip(first)) {
        let place = Rect { y, height: 1, ..list };
        if i == at {
            view.answers(list, y);
        }
        if row.spot().is_some() {
            view.regions.push((place, Target::Knob(i)));
        }
        form.row(row, place, buffer, view);
    }
    let about = Rect { y: list.bottom(), height: about, ..area };
    if let Some(row) = rows.get(at) {
        form.explain(row, about, buffer);
    }
    // Without room to explain, what is wrong with what is typed still has to be said.
    if about.is_empty()
        && list.height >= 2
        && let Some(problem) = typed(model).and_then(|line| line.problem.as_ref())
    {
        let last = list.bottom() - 1;
        let y = if view.cursor.is_some_and(|(_, y)| y == last) { last - 1 } else { last };
        buffer.set_style(Rect { y, height: 1, ..list }, theme.error);
        let text = format!("{:<width$}", clipped(problem, list.width.into()), width = list.width.into());
        buffer.set_stringn(list.x, y, text, list.width.into(), theme.error);
    }
}

/// The value that is being typed.
fn typed(model: &Model) -> Option<&Prompt> {
    model.dialogs.top::<ValueLine>().map(|line| &line.prompt)
}

/// The same where it is a knob's.
fn typed_of<'m>(model: &'m Model, knob: &str) -> Option<&'m Prompt> {
    typed(model).filter(|_| model.dialogs.top::<ValueLine>().is_some_and(|line| line.knob == knob))
}

/// The knob that a tree's fault is about: the first that the advice names, behind the last colon or
/// semicolon, else the first that is named at all.
pub fn culprit(tree: &Tree) -> Option<&'static str> {
    let fault = tree.fault.as_ref()?;
    let knobs = tree.wanted().preset.all_knobs();
    let first_in = |text: &str| {
        text.split(|c: char| !c.is_alphanumeric() && c != '_')
            .find_map(|word| knobs.iter().map(|(row, _)| row.knob.name).find(|name| *name == word))
    };
    let advice = fault.rsplit([':', ';']).next().unwrap_or(fault);
    first_in(advice).or_else(|| first_in(fault))
}

/// What rows are painted from.
struct FormView<'a> {
    model: &'a Model,
    tree: &'a Tree,
    chosen: Option<FormSpot>,
    culprit: Option<&'static str>,
    /// What is compared with: the saved preset, or the changed one while the saved one is looked at.
    other: &'a Preset,
    /// Its grammar, a line each.
    other_rules: Vec<String>,
    /// Its edits of the wood, a line each.
    other_edits: Vec<String>,
}

impl FormView<'_> {
    fn row(&self, row: &FormRow, area: Rect, buffer: &mut Buffer, view: &mut View) {
        let theme = &self.model.config.theme;
        let chosen = row.spot().is_some() && row.spot() == self.chosen;
        let base = match (chosen, self.model.focus == Pane::Shape) {
            (true, true) => theme.selected,
            (true, false) => theme.selected_unfocused,
            (false, _) => theme.text,
        };
        match row {
            FormRow::Heading(section) => {
                buffer.set_stringn(area.x, area.y, section.title(), area.width.into(), theme.heading);
            }
            FormRow::MoreRules(more) => {
                let text = clipped(&format!(" … and {more} more rules"), area.width.into());
                buffer.set_stringn(area.x, area.y, text, area.width.into(), theme.dim);
            }
            FormRow::Edits => {
                buffer.set_stringn(area.x, area.y, "Edits of the wood", area.width.into(), theme.heading);
            }
            FormRow::Kind(_, text) => {
                let style = if chosen { base } else { theme.heading };
                if chosen {
                    buffer.set_style(area, base);
                }
                buffer.set_stringn(
                    area.x,
                    area.y,
                    clipped(text, area.width.into()),
                    area.width.into(),
                    style,
                );
            }
            FormRow::Rule(_, text) | FormRow::Edit(_, text) => {
                buffer.set_style(area, base);
                let is_other = !self.other_rules.contains(text) && !self.other_edits.contains(text);
                self.mark(
                    is_other.then_some(if self.tree.compares { ASIDE } else { TURNED }),
                    base,
                    area,
                    buffer,
                );
                let inner = Rect { x: area.x + 1, width: area.width.saturating_sub(1), ..area };
                let text = clipped(text, inner.width.into());
                buffer.set_stringn(inner.x, inner.y, text, inner.width.into(), base.patch(theme.value));
            }
            FormRow::Knob(row_knob, value) => {
                buffer.set_style(area, base);
                self.knob(row_knob, value, base, area, buffer, view);
            }
        }
    }

    fn mark(&self, mark: Option<&str>, base: Style, area: Rect, buffer: &mut Buffer) {
        let theme = &self.model.config.theme;
        let style = if mark == Some(REFUSED) { theme.error } else { theme.modified };
        buffer.set_stringn(area.x, area.y, mark.unwrap_or(" "), area.width.into(), base.patch(style));
    }

    fn knob(
        &self,
        row_knob: &PresetKnob,
        value: &Value,
        base: Style,
        area: Rect,
        buffer: &mut Buffer,
        view: &mut View,
    ) {
        let theme = &self.model.config.theme;
        let turned = self.tree.is_turned(row_knob);
        let refused = self.culprit == Some(row_knob.knob.name);
        let mark = if refused {
            Some(REFUSED)
        } else {
            turned.then_some(if self.tree.compares { ASIDE } else { TURNED })
        };
        self.mark(mark, base, area, buffer);
        let name_width = (area.width / 2).min(NAME);
        let name = clipped(row_knob.short_name(), usize::from(name_width));
        let name_style = if refused { base.patch(theme.error) } else { base };
        buffer.set_stringn(area.x + 1, area.y, name, name_width.into(), name_style);
        let x = area.x + 1 + name_width + 1;
        let field = Rect { x, width: area.right().saturating_sub(x), ..area };
        if let Some(line) = typed_of(self.model, row_knob.knob.name) {
            view.regions.push((area, Target::Dialog(None)));
            // What is longer than its field takes the name's place too.
            let long = line.text().width() + 1 > usize::from(field.width);
            let whole = Rect { x: area.x + 1, width: area.width.saturating_sub(1), ..area };
            line.paint(if long { whole } else { field }, buffer, view, theme);
            return;
        }
        let drawn_from = self.tree.wanted().preset.spread(row_knob);
        // What is set comes first: that is what is turned.
        let now = with_unit(row_knob, value);
        let text = drawn_from.map_or_else(|| now.clone(), |spread| format!("{spread}: {now}"));
        let text = clipped(&text, field.width.into());
        let style = base.patch(if turned && !self.tree.compares { theme.modified } else { theme.value });
        buffer.set_stringn(field.x, field.y, text, field.width.into(), style);
        if let (Kind::Color { .. }, Value::Color([r, g, b])) = (row_knob.knob.kind, value)
            && field.width >= 10
            && self.model.terminal.colors.value != linden_terminal::ColorDepth::None
        {
            buffer.set_string(field.x + 8, field.y, "  ", Style::new().bg(Color::Rgb(*r, *g, *b)));
        }
    }

    /// What the cursor's row is about: what is wrong, what it does, what it takes, what it was; where there
    /// is room, what it does at length.
    fn explain(&self, row: &FormRow, area: Rect, buffer: &mut Buffer) {
        if area.is_empty() {
            return;
        }
        let theme = &self.model.config.theme;
        let of_knob;
        let name = match row {
            FormRow::Knob(row_knob, _) => {
                of_knob = called(&self.tree.wanted().preset, row_knob);
                of_knob.as_str()
            }
            FormRow::Rule(0, _) => "axiom",
            FormRow::Edit(..) => "edit",
            FormRow::Kind(..) => "kind of foliage",
            _ => "rule",
        };
        let rule =
            format!("─ {name} {}", "─".repeat(usize::from(area.width).saturating_sub(name.width() + 3)));
        let mut lines = vec![Line::styled(clipped(&rule, area.width.into()), theme.border)];
        let line = typed(self.model);
        let problem = line.and_then(|line| line.problem.as_deref());
        if let Some(problem) = problem.or(self.tree.fault.as_deref()) {
            lines.push(Line::styled(linden::knob::printable(problem), theme.error));
        }
        match row {
            FormRow::Knob(row_knob, value) => {
                self.explain_knob(row_knob, value, area.width.into(), &mut lines);
            }
            FormRow::Rule(_, text) => {
                if text.width() + 1 > usize::from(area.width) {
                    lines.push(Line::styled(linden::knob::printable(text), theme.value));
                }
                lines.push(Line::styled("Enter edits the grammar; E opens it in $EDITOR", theme.text));
            }
            FormRow::Edit(index, text) => {
                if text.width() + 1 > usize::from(area.width) {
                    lines.push(Line::styled(linden::knob::printable(text), theme.value));
                }
                let remarks = self.tree.shown.iter().flat_map(|shown| &shown.grown.remarks);
                for remark in remarks.filter(|remark| remark.number == index + 1) {
                    lines.push(Line::styled(remark.why.clone(), theme.warning));
                }
                lines.push(Line::styled(
                    "Enter types it anew, Delete takes it away; docs/editing.md",
                    theme.text,
                ));
            }
            FormRow::Kind(kind, _) => {
                let preset = &self.tree.wanted().preset;
                let label = preset.kind_labels().into_iter().nth(*kind).unwrap_or_default();
                lines.push(Line::styled(
                    format!("Enter names it, Delete takes it away, + copies it; --set {label}.leaf_keep=0"),
                    theme.text,
                ));
                for (key, file) in preset.kind_files(*kind) {
                    lines.push(Line::styled(format!("{key} {}", linden::knob::printable(file)), theme.value));
                }
            }
            FormRow::Heading(_) | FormRow::MoreRules(_) | FormRow::Edits => {}
        }
        let is_grown_by = matches!(row, FormRow::Rule(..))
            || matches!(row, FormRow::Knob(PresetKnob { section: Section::Generator(_), .. }, _));
        if is_grown_by && let Some(line) = forecast::line(&self.as_typed()) {
            lines.push(Line::styled(line, theme.info));
        }
        if let FormRow::Knob(row_knob, value) = row
            && with_unit(row_knob, value).width() > usize::from(area.width.saturating_sub(NAME + 2))
        {
            lines.push(Line::styled(value.to_string(), theme.value));
        }
        if let FormRow::Knob(PresetKnob { knob, .. }, _) = row
            && !knob.details.is_empty()
        {
            // Last, so that they take no room but what is left.
            let width = usize::from(area.width);
            let used: usize = lines.iter().map(|line| wrapped(&line.to_string(), width).len()).sum();
            let left = usize::from(area.height).saturating_sub(used);
            if left > 0 {
                let details = wrapped_within(knob.details, width, left);
                lines.extend(details.into_iter().map(|line| Line::styled(line, theme.dim)));
            }
        }
        Paragraph::new(lines).wrap(Wrap { trim: true }).render(area, buffer);
    }

    fn explain_knob(
        &self,
        row_knob: &PresetKnob,
        value: &Value,
        width: usize,
        lines: &mut Vec<Line<'static>>,
    ) {
        let theme = &self.model.config.theme;
        lines.push(Line::styled(row_knob.knob.help, theme.text));
        let unit =
            if row_knob.knob.unit.is_empty() { String::new() } else { format!(" {}", row_knob.knob.unit) };
        let mut range = match row_knob.knob.kind {
            // The words, the one that is meant marked.
            Kind::Choice(words) => {
                let meant = typed(self.model).map_or_else(
                    || value.to_string(),
                    |line| complete::completed(row_knob.knob.name, line.text()).to_owned(),
                );
                let mut spans = Vec::new();
                for word in words {
                    let style = if *word == meant { theme.selected } else { theme.unit };
                    spans.extend([Span::styled(*word, style), Span::raw(" ")]);
                }
                spans
            }
            // No more than is needed: people do not count to 2^64.
            Kind::Integer { max: u64::MAX, .. } => vec![Span::styled("any whole number from 0", theme.unit)],
            kind @ (Kind::Real { .. } | Kind::Length { .. }) => {
                // The unit stands with the numbers: 0 to 10 m, or auto.
                let kind = kind.to_string();
                let (numbers, or) = kind.split_at(kind.find(", or ").unwrap_or(kind.len()));
                vec![Span::styled(format!("{numbers}{unit}{or}"), theme.unit)]
            }
            kind if unit.is_empty() => vec![Span::styled(kind.to_string(), theme.unit)],
            kind => vec![Span::styled(format!("{kind} ({})", row_knob.knob.unit), theme.unit)],
        };
        if self.tree.is_turned(row_knob)
            // The workbench shows wind whatever files are to hold.
            && row_knob.section != Section::Wind
            && let Some(why) = self.tree.wanted().preset.idle(row_knob.knob.name)
        {
            lines.push(Line::styled(format!("changes nothing: {why}"), theme.warning));
        }
        let usual = row_knob.read(&self.tree.saved().preset);
        let scale = Scale::new(&row_knob.knob.kind, usual.as_ref());
        if let Some((scale, share)) = scale.and_then(|scale| Some((scale, scale.share(value)?))) {
            lines.extend(self.slider(&scale, share, width));
        }
        if typed(self.model).is_some() && !complete::words(row_knob.knob.name).is_empty() {
            range.push(Span::styled(" · Tab completes", theme.dim));
        }
        if self.tree.is_turned(row_knob)
            && let Some(other) = row_knob.read(self.other)
        {
            let spread = self.other.spread(row_knob);
            let whose = if self.tree.compares { "yours" } else { "saved" };
            range.push(Span::styled(
                format!(
                    " · {whose}: {}",
                    spread.map_or_else(|| with_unit(row_knob, &other), ToString::to_string)
                ),
                theme.modified,
            ));
        }
        if let Some(spread) = self.tree.wanted().preset.spread(row_knob) {
            range.push(Span::styled(format!(" · each seed draws from {spread}"), theme.value));
        }
        if *value == Value::Auto
            && let Some(now) = resolved(self.tree, row_knob)
        {
            range.push(Span::styled(format!(" · now {}", with_unit(row_knob, &now)), theme.value));
        }
        lines.push(Line::from(range));
    }

    /// Where a value stands in its range: `0 ━━━━━●──── 10`, in one line; `None` where there is no room for a bar.
    fn slider(&self, scale: &Scale, share: f64, width: usize) -> Option<Line<'static>> {
        let (low, high) = (format!("{} ", scale.low), format!(" {}", scale.high));
        let bar = width.saturating_sub(low.width() + high.width()).min(SLIDER);
        if bar < LEAST_SLIDER {
            return None;
        }
        let theme = &self.model.config.theme;
        let at = (share * (bar - 1) as f64).round() as usize;
        Some(Line::from(vec![
            Span::styled(low, theme.unit),
            Span::styled("━".repeat(at), theme.gauge),
            Span::styled("●", theme.value),
            Span::styled("─".repeat(bar - 1 - at), theme.gauge_track),
            Span::styled(high, theme.unit),
        ]))
    }

    /// The preset as it would be with what is being typed.
    fn as_typed(&self) -> Preset {
        let mut preset = self.tree.wanted().preset.clone();
        if let Some(line) = self.model.dialogs.top::<ValueLine>() {
            // What is wrong with it is said elsewhere.
            let _ = preset.set(line.knob, line.prompt.text());
        }
        preset
    }
}

/// A value with its unit, where it has one.
fn with_unit(row_knob: &PresetKnob, value: &Value) -> String {
    match value {
        Value::Real(x) if x.is_finite() && !row_knob.knob.unit.is_empty() => {
            format!("{value} {}", row_knob.knob.unit)
        }
        Value::Integer(_) if row_knob.knob.unit == "px" => format!("{value} px"),
        _ => value.to_string(),
    }
}
