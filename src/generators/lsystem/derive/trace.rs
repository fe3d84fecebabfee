//! A word with the origin of each module, and what the turtle draws for it.
//!
//! Derived breadth first, as the definition has it: the choices of the last step say which module
//! became which. Only who asks pays for it; growing keeps nothing of the kind.

use std::fmt;
use std::ops::Range;

use super::buffers::{Buffer, DROP, Lists, Step, Text, axiom};
use super::{Outlet, Sink};
use crate::command::Command;
use crate::context::Modules;
use crate::error::{LsystemError, Short};
use crate::grammar::Grammar;
use crate::program::Program;
use crate::turtle::Turtle;
use crate::turtle_settings::TurtleSettings;
use glam::Vec3;
use linden_base::monitor::Monitor;
use linden_base::random::Key;

/// The most modules that [`trace`] lists, in the word and in each one on the way to it.
pub const MAX_TRACED: u64 = 1_000_000;

/// The word after some derivation steps, module by module.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Traced {
    /// From first to last. A `%` and what it cuts are not part of the word.
    pub modules: Vec<TracedModule>,
    /// Why the turtle cannot draw this word, where it cannot: then no module has drawn anything.
    pub undrawn: Option<LsystemError>,
}

/// A module of a derived word, and where it comes from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TracedModule {
    /// The symbol, one character.
    pub symbol: char,
    /// Numbers that are finite.
    pub arguments: Vec<f64>,
    /// The derivation step that wrote it; 0 for the axiom.
    pub birth: u32,
    /// The module of the word one step before that it was, or that was rewritten to it, from 0; none
    /// in the axiom.
    pub parent: Option<u32>,
    /// The rule that wrote it in the last step, as a place in [`Grammar::productions`]; none in the
    /// axiom, and where the module was kept.
    pub rule: Option<u32>,
    /// The rule that rewrites it in the next step; none where it is kept, or cut by a `%`.
    pub next_rule: Option<u32>,
    /// The nodes of [`Drawn::branching`](crate::Drawn::branching) that the turtle left for it: one at
    /// the far end of the segment that it drew, and before it the foot of a stem that begins there.
    pub nodes: Range<u32>,
    /// The polygon that it filled, as a place in [`Organs::polygons`](linden_skeleton::organs::Organs).
    pub polygon: Option<u32>,
    /// The organ that it placed, as a place in [`Organs::placed`](linden_skeleton::organs::Organs).
    pub placed: Option<u32>,
    /// Where the turtle stood after it, metres; it begins at the origin. None where nothing was drawn.
    pub at: Option<Vec3>,
}

/// Derives a word and lists its modules with their origins: for words that people look at.
///
/// Uses the derivations, the seed and the turtle of `settings`; of a plant with several stems, the first,
/// whose nodes come first. The word is that of [`derive_string`](crate::derive_string()).
///
/// Written out it is an axiom again: [`Traced`] shows itself as grammars are written. For a grammar without
/// chance, deriving that axiom goes on where the word stands. It does not where chance has a say, because
/// choices are keyed by the path from the first axiom, nor can it where the word is empty.
///
/// ```
/// use linden_base::monitor::Quiet;
/// use linden_lsystem::{Grammar, TurtleSettings, trace};
/// let weed = Grammar::new("X", &["X -> F[+X]", "F -> FF"])?;
/// let settings = TurtleSettings { derivations: 2, ..TurtleSettings::default() };
/// let word = trace(&weed, &settings, &Quiet)?;
/// assert_eq!(word.to_string(), "FF[+F[+X]]");
/// let (second, inner) = (&word.modules[1], &word.modules[4]);
/// assert_eq!((second.parent, second.rule, second.nodes.clone()), (Some(0), Some(1), 2..3));
/// assert_eq!((inner.parent, inner.rule, inner.next_rule), (Some(3), Some(0), Some(1)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`derive_string`](crate::derive_string()), and [`LsystemError::TooManyToTrace`]. What only the
/// turtle refuses is [`Traced::undrawn`].
pub fn trace(
    grammar: &Grammar,
    settings: &TurtleSettings,
    monitor: &dyn Monitor,
) -> Result<Traced, LsystemError> {
    let program = Program::compile(grammar);
    let limited = TurtleSettings { symbol_limit: settings.symbol_limit.min(MAX_TRACED), ..*settings };
    let is_ours = settings.symbol_limit > MAX_TRACED;
    let refused = |error| match error {
        LsystemError::TooManySymbols { derivations, fits, .. } if is_ours => {
            LsystemError::TooManyToTrace { derivations, limit: MAX_TRACED, fits }
        }
        LsystemError::GrewPastLimit { derivations, fits, .. } if is_ours => {
            LsystemError::TooManyToTrace { derivations, limit: MAX_TRACED, fits }
        }
        other => other,
    };
    limited.admit(&program).map_err(refused)?;
    let mut turtle = Turtle::new(&program, &limited, 0, 0, monitor)?;
    turtle.start(0.0, settings.stems().1, Key::new(settings.seed).named("turtle"));
    let mut drawing = Drawing { turtle, drawn: Vec::new() };
    let mut outlet = Outlet::new(&program, &limited, None, monitor, &mut drawing);
    let Rewritten { string, origins, writers } =
        rewrite(&mut outlet, usize::MAX).map_err(|error| refused(error).of(grammar))?;
    let next_rules = match next_rules(&program, &string, settings.derivations, monitor) {
        // What the next step cannot decide is no fault of this word.
        Err(LsystemError::Written { .. }) => vec![None; string.modules.len()],
        other => other?,
    };
    let text = Text { program: &program, buffer: &string };
    let undrawn = match draw(&mut outlet, &text) {
        Ok(()) => None,
        Err(LsystemError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(LsystemError::Memory(over)) => return Err(over.into()),
        Err(error) => {
            let culprit = culprit(&error, &text, outlet.sink.drawn.len());
            Some(match culprit.and_then(|index| writers.get(index)) {
                Some(&writer) => error.by(writer).of(grammar),
                None => error,
            })
        }
    };
    let drawn = if undrawn.is_none() { drawing.drawn } else { Vec::new() };
    let module = |index: usize| {
        let origin = origins.get(index);
        let watched = drawn.get(index).cloned();
        let at = watched.as_ref().map(|watched| watched.at);
        let [nodes, mut polygons, mut placed] = watched.map(|watched| watched.made).unwrap_or_default();
        TracedModule {
            symbol: text.entry(index).symbol,
            arguments: text.arguments(index).to_vec(),
            birth: string.births[index],
            parent: origin.map(|origin| origin.parent),
            rule: origin.and_then(|origin| origin.rule),
            next_rule: next_rules[index],
            nodes,
            polygon: polygons.next_back(),
            placed: placed.next_back(),
            at,
        }
    };
    Ok(Traced { modules: (0..text.count()).map(module).collect(), undrawn })
}

/// Where a module of a word comes from.
#[derive(Clone, Copy)]
struct Origin {
    parent: u32,
    rule: Option<u32>,
}

/// The word after all steps.
struct Rewritten {
    string: Buffer,
    /// Of its modules in the last step; empty without steps.
    origins: Vec<Origin>,
    /// The production that wrote each module, in whichever step; none for the axiom.
    writers: Vec<Option<u32>>,
}

/// Derives a word of which the words on the way have no more than `most` modules in sum.
fn rewrite<S: Sink>(outlet: &mut Outlet<'_, S>, most: usize) -> Result<Rewritten, LsystemError> {
    let program = outlet.program;
    let mut work = 0;
    let mut string = axiom(program, outlet.settings)?;
    let mut origins = Vec::new();
    let mut writers = vec![None; string.modules.len()];
    let mut lists = Lists::default();
    for number in 1..=outlet.settings.derivations {
        outlet.within_limit = Some(number - 1);
        outlet.monitor.check()?;
        let step = Step::choose(program, &string, &mut lists, number, outlet.monitor)?;
        origins = origins_of(program, step.choices);
        let next = step.apply(outlet)?;
        writers = origins.iter().map(|origin| origin.rule.or(writers[origin.parent as usize])).collect();
        lists.spare = std::mem::replace(&mut string, next);
        work += string.modules.len();
        if work > most {
            return Err(outlet.past_limit());
        }
    }
    Ok(Rewritten { string, origins, writers })
}

/// Modules that are derived anew in search of a rule: about a second.
const MOST_SEARCHED: usize = 50_000_000;

/// An error of a module with the rule that wrote the module, where deriving anew finds it: a word of up to
/// [`MAX_TRACED`] modules is derived with the rule of each, and drawn to where the error is.
#[cold]
pub(crate) fn with_writer(
    error: LsystemError,
    program: &Program,
    settings: &TurtleSettings,
    monitor: &dyn Monitor,
) -> LsystemError {
    use LsystemError::{
        OrganSize, PolygonTooLarge, PolygonUnclosed, PolygonUnopened, UnknownOrgan, Value, VertexOutside,
    };
    let is_of_module = matches!(
        error,
        Value { .. }
            | UnknownOrgan { .. }
            | OrganSize { .. }
            | PolygonUnopened
            | PolygonUnclosed
            | PolygonTooLarge { .. }
            | VertexOutside
    );
    if !is_of_module {
        return error;
    }
    met_again(&error, program, settings, monitor).unwrap_or(error)
}

/// The same error with its rule, if deriving anew leads to it.
fn met_again(
    error: &LsystemError,
    program: &Program,
    settings: &TurtleSettings,
    monitor: &dyn Monitor,
) -> Option<LsystemError> {
    let limited = TurtleSettings { symbol_limit: settings.symbol_limit.min(MAX_TRACED), ..*settings };
    let mut turtle = Turtle::new(program, &limited, 0, 0, monitor).ok()?;
    turtle.start(0.0, 0.0, Key::new(0));
    let mut drawing = Drawing { turtle, drawn: Vec::new() };
    let mut outlet = Outlet::new(program, &limited, None, monitor, &mut drawing);
    let Rewritten { string, writers, .. } = rewrite(&mut outlet, MOST_SEARCHED).ok()?;
    let text = Text { program, buffer: &string };
    let again = draw(&mut outlet, &text).err()?;
    let index = culprit(&again, &text, drawing.drawn.len()).filter(|_| again == *error)?;
    writers.get(index).map(|&writer| again.by(writer))
}

/// The module that is to blame for an error of the turtle, which obeyed `drawn` modules before.
fn culprit(error: &LsystemError, text: &Text<'_>, drawn: usize) -> Option<usize> {
    match error {
        // The `~` rather than what stands behind it.
        LsystemError::UnknownOrgan { .. } => drawn.checked_sub(1),
        LsystemError::PolygonUnclosed => {
            let mut open = Vec::new();
            for index in 0..text.count() {
                match Command::of(text.entry(index).symbol) {
                    Some(Command::PolygonBegin) => open.push(index),
                    Some(Command::PolygonEnd) => drop(open.pop()),
                    _ => {}
                }
            }
            open.pop()
        }
        _ => Some(drawn),
    }
}

/// For each module of the next word the one that it comes from.
fn origins_of(program: &Program, choices: &[u32]) -> Vec<Origin> {
    let of_module = |(parent, &choice): (u32, &u32)| {
        let (count, rule) = match program.alternatives.get(choice as usize) {
            Some(chosen) => (chosen.word.len(), Some(chosen.production)),
            None => (usize::from(choice != DROP), None),
        };
        std::iter::repeat_n(Origin { parent, rule }, count)
    };
    (0..).zip(choices).flat_map(of_module).collect()
}

/// The rule that one more step would apply to each module.
fn next_rules(
    program: &Program,
    string: &Buffer,
    step: u32,
    monitor: &dyn Monitor,
) -> Result<Vec<Option<u32>>, LsystemError> {
    let mut lists = Lists::default();
    let next = Step::choose(program, string, &mut lists, step + 1, monitor)?;
    let rule = |&choice: &u32| program.alternatives.get(choice as usize).map(|chosen| chosen.production);
    Ok(next.choices.iter().map(rule).collect())
}

fn draw(outlet: &mut Outlet<'_, Drawing<'_>>, text: &Text<'_>) -> Result<(), LsystemError> {
    for index in 0..text.count() {
        let (id, birth) = (text.buffer.modules[index], text.buffer.births[index]);
        if text.entry(index).is_computed() {
            outlet.apply(id, text.arguments(index), birth)?;
        } else {
            outlet.give(&[id], birth)?;
        }
    }
    outlet.sink.turtle.finish()
}

/// A turtle that is watched.
struct Drawing<'a> {
    turtle: Turtle<'a>,
    /// For each module.
    drawn: Vec<Watched>,
}

/// What came with a module.
#[derive(Clone)]
struct Watched {
    /// Nodes, polygons and placed organs.
    made: [Range<u32>; 3],
    /// Where the turtle stood then.
    at: Vec3,
}

impl Drawing<'_> {
    fn watch(
        &mut self,
        walk: impl FnOnce(&mut Turtle<'_>) -> Result<(), LsystemError>,
    ) -> Result<(), LsystemError> {
        let before = self.turtle.counts();
        walk(&mut self.turtle)?;
        let after = self.turtle.counts();
        let made = std::array::from_fn(|i| before[i] as u32..after[i] as u32);
        self.drawn.push(Watched { made, at: self.turtle.stands_at() });
        Ok(())
    }
}

impl Sink for Drawing<'_> {
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        modules.iter().try_for_each(|id| self.watch(|turtle| turtle.take(std::slice::from_ref(id), birth)))
    }

    fn apply(&mut self, module: u32, arguments: &[f64], birth: u32) -> Result<(), LsystemError> {
        self.watch(|turtle| turtle.apply(module, arguments, birth))
    }

    fn bytes(&self) -> u64 {
        self.turtle.bytes()
    }
}

impl Traced {
    /// The module for which the turtle left a node of [`Drawn::branching`](crate::Drawn::branching), as a place in
    /// [`Self::modules`]; none for a node of a further stem, and where nothing was drawn.
    pub fn module_of(&self, node: u32) -> Option<usize> {
        // Nodes come in the order of the word, so the ends of their ranges only rise.
        let at = self.modules.partition_point(|module| module.nodes.end <= node);
        (at < self.modules.len()).then_some(at)
    }
}

impl TracedModule {
    /// What the turtle does there, in words: `turns left`.
    pub fn action(&self) -> &'static str {
        // A word holds symbols alone.
        Command::of(self.symbol).map_or("", Command::words)
    }
}

impl fmt::Display for Traced {
    /// The modules end to end.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.modules.iter().try_for_each(|module| module.fmt(f))
    }
}

impl fmt::Display for TracedModule {
    /// As grammars are written: `F(0.5)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.symbol)?;
        for (i, argument) in self.arguments.iter().enumerate() {
            write!(f, "{}{}", if i == 0 { '(' } else { ',' }, Short(*argument))?;
        }
        if self.arguments.is_empty() { Ok(()) } else { f.write_str(")") }
    }
}
