//! `linden show --derive`: the word of a grammar after some steps, as text or with the origin of each module.

use std::io::IsTerminal as _;

use linden::lsystem::{Grammar, LSystem, Traced, TracedModule, TurtleSettings, derive_string, trace};
use linden::preset::Preset;
use serde::Serialize;
use unicode_width::UnicodeWidthStr as _;

use crate::exit::usage;
use crate::progress::Progress;

/// Prints the word of a preset's grammar.
pub(super) fn show(preset: &Preset, steps: u32, as_json: bool, progress: &Progress) -> anyhow::Result<()> {
    let Some(lsystem) = preset.settings::<LSystem>() else {
        let generator = preset.grows_by().id();
        return Err(usage(format!("--derive is for grammars, and {} grows by {generator}", preset.id)));
    };
    let settings = TurtleSettings { derivations: steps, ..lsystem.turtle(preset.seed()) };
    if as_json {
        let traced = trace(&lsystem.grammar, &settings, progress)?;
        return super::print_json(&Word::of(&lsystem.grammar, steps, lsystem.derivations_grown(), traced));
    }
    let word = derive_string(&lsystem.grammar, &settings)?;
    // What reads a pipe wants the word; people want lines that end between modules.
    let columns = std::io::stdout().is_terminal().then(|| crossterm::terminal::size().ok()).flatten();
    super::print(&match columns {
        Some((columns, _)) => broken(&word, columns.into()),
        None => word + "\n",
    })
}

/// In lines of at most `width` cells that end between modules; a longer module has a line of its own.
fn broken(word: &str, width: usize) -> String {
    let mut text = String::with_capacity(word.len() + word.len() / width.max(1) + 1);
    let mut used = 0;
    let mut rest = word;
    while !rest.is_empty() {
        let (module, behind) = rest.split_at(first_module(rest));
        if used > 0 && used + module.width() > width {
            text.push('\n');
            used = 0;
        }
        text.push_str(module);
        used += module.width();
        rest = behind;
    }
    text.push('\n');
    text
}

/// The bytes of the first module of a word.
fn first_module(word: &str) -> usize {
    let symbol = word.chars().next().map_or(0, char::len_utf8);
    match word[symbol..].strip_prefix('(').and_then(|arguments| arguments.find(')')) {
        Some(end) => symbol + 1 + end + 1,
        None => symbol,
    }
}

/// A word, module by module. Modules, rules and what they refer to are counted from 0.
#[derive(Serialize)]
struct Word {
    steps: u32,
    /// With which the tree of the source grows.
    derivations: u32,
    axiom: String,
    rules: Vec<RuleRow>,
    modules: Vec<ModuleRow>,
    /// Why the turtle cannot draw this word; `null` where it can.
    undrawn: Option<String>,
}

#[derive(Serialize)]
struct RuleRow {
    /// In the grammar as `linden show` prints it, the axiom being line 1.
    line: usize,
    rule: String,
}

#[derive(Serialize)]
struct ModuleRow {
    symbol: char,
    arguments: Vec<f64>,
    /// The step that wrote it; 0 is the axiom.
    birth: u32,
    /// In the word one step before; `null` in the axiom.
    parent: Option<u32>,
    /// The rule that wrote it in the last step; `null` where it was kept.
    rule: Option<u32>,
    /// The rule that rewrites it in the next step; `null` where it stays.
    next_rule: Option<u32>,
    /// The node at the far end of the segment that the turtle drew for it, as the turtle numbers nodes.
    node: Option<u32>,
    /// The polygon, or the placed organ.
    polygon: Option<u32>,
    organ: Option<u32>,
    /// Where the turtle stood after it, metres.
    at: Option<[f32; 3]>,
}

impl Word {
    fn of(grammar: &Grammar, steps: u32, derivations: u32, traced: Traced) -> Self {
        let axiom = grammar.to_string().lines().next().unwrap_or_default().to_owned();
        let rule = |(index, rule)| RuleRow { line: grammar.line_of(index), rule: format!("{rule}") };
        let rules = grammar.productions().iter().enumerate().map(rule).collect();
        let Traced { modules, undrawn, .. } = traced;
        let modules = modules.into_iter().map(ModuleRow::from).collect();
        Self { steps, derivations, axiom, rules, modules, undrawn: undrawn.map(|error| error.to_string()) }
    }
}

impl From<TracedModule> for ModuleRow {
    fn from(module: TracedModule) -> Self {
        let TracedModule {
            symbol,
            arguments,
            birth,
            parent,
            rule,
            next_rule,
            nodes,
            polygon,
            placed,
            at,
            ..
        } = module;
        let (node, at) = (nodes.last(), at.map(Into::into));
        Self { symbol, arguments, birth, parent, rule, next_rule, node, polygon, organ: placed, at }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_between_modules() {
        assert_eq!(broken("F(1,2)[+F]A", 6), "F(1,2)\n[+F]A\n");
        assert_eq!(broken("AF(0.25)F", 3), "A\nF(0.25)\nF\n", "what is too long has a line of its own");
        assert_eq!(broken("FFFF", 4), "FFFF\n");
        assert_eq!(broken("", 4), "\n");
        for width in 0..12 {
            let word = "!(0.1)F[&(45)F(-2)]/(137.5)\\+A";
            assert_eq!(broken(word, width).replace('\n', ""), word);
        }
    }
}
