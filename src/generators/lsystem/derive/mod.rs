//! Derivation, and those who take what is derived.
//!
//! Systems without contexts are derived [depth first](stream), without a string in memory; systems
//! with contexts [breadth first](buffers), between two buffers. Random choices are keyed by the path
//! to the module (which rewritten module of the axiom, which of its successor, …), so that both ways
//! choose the same, on any number of threads.

mod buffers;
mod slot;
mod stream;
pub(super) mod trace;

use super::command::Command;
use super::error::LsystemError;
use super::expression::code::Inputs;
use super::grammar::Grammar;
use super::program::{Call, Group, Program, Word};
use super::turtle_settings::TurtleSettings;
use linden_base::monitor::{Monitor, Phase, Quiet};
use linden_base::random::Key;

pub(super) use buffers::{Trial, count};
pub(super) use trace::with_writer;

/// How much is done between two looks at the monitor: about a millisecond.
const PATIENCE: u64 = 1 << 16;

/// Takes the modules of the derived string, from first to last.
pub(super) trait Sink {
    /// Some consecutive modules that came into being in the same derivation step, by their
    /// identifiers in [`Program::modules`]. Their arguments, if any, are constants and part of the
    /// identified module ([`Program::commands`]).
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError>;

    /// All that becomes of a module written in the step `birth`: how many modules these are, where the sink
    /// knows them and has taken them. Only asked where nothing is computed from what stands around.
    fn take_all(&mut self, _module: u32, _birth: u32) -> Option<u64> {
        None
    }

    /// One module whose arguments were computed: all finite, at least one, the first in the range of
    /// the turtle's command. A length may be so short, or 0, that there is nothing to draw.
    fn apply(&mut self, module: u32, arguments: &[f64], birth: u32) -> Result<(), LsystemError>;

    /// Bytes that it holds itself.
    fn bytes(&self) -> u64 {
        0
    }

    /// Says how many bytes derivation holds from now on, until it is over.
    fn hold_beside(&mut self, _bytes: u64) {}
}

/// How a string is derived and drawn. All ways give the same, to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// Drawn by macros where that is exact ([`grow_by`](super::grow_by())), else module by module, depth
    /// first where no rule looks at its context.
    #[default]
    Best,
    /// Without copies of what was drawn: depth first where no rule looks at its context, else breadth first.
    Walk,
    /// Whole strings in memory, step by step, in parallel.
    BreadthFirst,
}

/// A derived string.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Derived {
    /// The modules end to end, computed arguments as numbers.
    pub text: String,
    /// For each module the derivation step that wrote it.
    pub births: Vec<u32>,
}

/// Derives a string: for small systems, to look at. [`grow`](super::grow()) keeps none in memory where
/// it can.
///
/// Uses the derivations, the seed and the symbol limit of `settings`. A `%` and what it cuts are not
/// part of the string in which the `%` stands.
///
/// # Errors
/// As [`grow`](super::grow()), except that a string that draws nothing is a string, too.
///
/// ```
/// use linden_lsystem::{Grammar, TurtleSettings, derive_string};
/// let anabaena = Grammar::new("b", &["a -> ab", "b -> a"])?; // ABOP, section 1.2
/// let settings = TurtleSettings { derivations: 5, ..TurtleSettings::default() };
/// assert_eq!(derive_string(&anabaena, &settings)?, "abaababa");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive_string(grammar: &Grammar, settings: &TurtleSettings) -> Result<String, LsystemError> {
    Ok(derive_by(grammar, settings, Way::Best)?.text)
}

/// As [`derive_string`], by a way of one's choice, and with the births.
///
/// # Errors
/// As [`derive_string`].
pub fn derive_by(grammar: &Grammar, settings: &TurtleSettings, way: Way) -> Result<Derived, LsystemError> {
    let program = Program::compile(grammar);
    let forecast = settings.admit(&program)?;
    let names = program.modules.iter().map(ToString::to_string).collect();
    let mut written = Written { program: &program, names, derived: Derived::default() };
    let total = forecast.exact.then_some(forecast.symbols as u64);
    derive(&program, settings, way, total, &Quiet, &mut written)
        .map_err(|error| with_writer(error, &program, settings, &Quiet).of(grammar))?;
    Ok(written.derived)
}

struct Written<'a> {
    program: &'a Program,
    names: Vec<String>,
    derived: Derived,
}

impl Sink for Written<'_> {
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        self.derived.text.extend(modules.iter().map(|&id| self.names[id as usize].as_str()));
        self.derived.births.extend(modules.iter().map(|_| birth));
        Ok(())
    }

    fn apply(&mut self, module: u32, arguments: &[f64], birth: u32) -> Result<(), LsystemError> {
        self.derived.text.push_str(&self.program.modules[module as usize].with(arguments));
        self.derived.births.push(birth);
        Ok(())
    }
}

/// Hands the derived string to `sink` and says how long it was. `total` is its length when known.
pub(super) fn derive<S: Sink>(
    program: &Program,
    settings: &TurtleSettings,
    way: Way,
    total: Option<u64>,
    monitor: &dyn Monitor,
    sink: &mut S,
) -> Result<u64, LsystemError> {
    let mut outlet = Outlet::new(program, settings, total, monitor, sink);
    if way == Way::BreadthFirst || program.has_contexts() {
        buffers::derive(&mut outlet)?;
    } else {
        stream::derive(&mut outlet)?;
    }
    outlet.sink.hold_beside(0);
    monitor.advance(Phase::Turtle, outlet.given, total);
    Ok(outlet.given)
}

/// The key of the axiom.
fn root(settings: &TurtleSettings) -> Key {
    Key::new(settings.seed).named("lsystem")
}

/// Where the words of a place take their random numbers from.
fn chance(program: &Program, place: Key) -> Key {
    if program.random_arguments { place.named("random") } else { place }
}

/// Computes the arguments of a call onto the end of `values`.
#[inline]
fn compute(
    program: &Program,
    (id, call): (u32, Call),
    inputs: Inputs<'_>,
    values: &mut [f64],
    birth: u32,
) -> Result<(), LsystemError> {
    let mut is_finite = true;
    for (value, &formula) in values.iter_mut().zip(program.formulas(call)) {
        *value = program.library.evaluate(formula, inputs);
        is_finite &= value.is_finite();
    }
    if is_finite { Ok(()) } else { Err(bad_value(program, id, values, birth)) }
}

/// What to say about the condition of a group that comes to no number for a module.
#[cold]
fn bad_condition(
    program: &Program,
    group: &Group,
    (id, arguments): (u32, &[f64]),
    derivation: u32,
) -> LsystemError {
    let module = program.modules[id as usize].with(arguments);
    LsystemError::Condition { module, derivation }.by(program.first_production(group))
}

/// What to say about an argument that is no number, or out of the turtle's range.
#[cold]
fn bad_value(program: &Program, id: u32, arguments: &[f64], derivation: u32) -> LsystemError {
    let entry = &program.modules[id as usize];
    let range = Command::of(entry.symbol).and_then(Command::argument_range);
    let (value, expected) = match (arguments.iter().find(|value| !value.is_finite()), range) {
        (Some(&value), _) => (value, "a finite number".to_owned()),
        (None, Some([min, max])) => (arguments[0], format!("{min} to {max}")),
        (None, None) => (arguments[0], String::new()),
    };
    LsystemError::Value { module: entry.with(arguments), value, derivation, expected }
}

/// Counts and checks what is handed on, and looks at the monitor now and then.
struct Outlet<'a, S> {
    program: &'a Program,
    settings: &'a TurtleSettings,
    total: Option<u64>,
    monitor: &'a dyn Monitor,
    /// Of the first argument, by module.
    ranges: Vec<Option<[f64; 2]>>,
    sink: &'a mut S,
    given: u64,
    /// Work since the last look at the monitor, in symbols.
    spent: u64,
    /// The last step whose string is known to be within the limit.
    within_limit: Option<u32>,
}

impl<'a, S: Sink> Outlet<'a, S> {
    fn new(
        program: &'a Program,
        settings: &'a TurtleSettings,
        total: Option<u64>,
        monitor: &'a dyn Monitor,
        sink: &'a mut S,
    ) -> Self {
        let ranges = program.commands().map(|(command, _)| Command::argument_range(command)).collect();
        Self { program, settings, total, monitor, ranges, sink, given: 0, spent: 0, within_limit: None }
    }

    /// Modules with constant arguments.
    #[inline]
    fn give(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        if modules.len() as u64 > PATIENCE {
            return self.give_many(modules, birth);
        }
        self.given += modules.len() as u64;
        self.check_limit(self.given)?;
        self.sink.take(modules, birth)?;
        self.spend(modules.len() as u64)
    }

    #[cold]
    fn give_many(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        modules.chunks(PATIENCE as usize).try_for_each(|some| self.give(some, birth))
    }

    /// A module with computed arguments.
    fn apply(&mut self, module: u32, arguments: &[f64], birth: u32) -> Result<(), LsystemError> {
        self.given += 1;
        self.check_limit(self.given)?;
        if let Some([min, max]) = self.ranges[module as usize]
            && !(min <= arguments[0] && arguments[0] <= max)
        {
            return Err(bad_value(self.program, module, arguments, birth));
        }
        self.sink.apply(module, arguments, birth)?;
        self.spend(1)
    }

    /// A whole word that is not rewritten any more, of a module at `place`.
    #[inline]
    fn word(
        &mut self,
        word: Word,
        parameters: &[f64],
        place: Key,
        birth: u32,
        scratch: &mut Vec<f64>,
    ) -> Result<(), LsystemError> {
        let program = self.program;
        let modules = program.word(word);
        if word.values == 0 {
            return self.give(modules, birth);
        }
        let inputs = Inputs { parameters, key: chance(program, place) };
        let mut next = 0;
        for &call in program.calls(word) {
            let at = call.at as usize;
            self.give(&modules[next..at], birth)?;
            let id = modules[at];
            self.spend(call.cost.into())?;
            scratch.resize(program.modules[id as usize].arity as usize, 0.0);
            compute(program, (id, call), inputs, scratch, birth)
                .map_err(|error| error.by(program.production_of(word)))?;
            self.apply(id, scratch, birth)?;
            next = at + 1;
        }
        self.give(&modules[next..], birth)
    }

    #[inline]
    fn check_limit(&self, symbols: u64) -> Result<(), LsystemError> {
        if symbols > self.settings.symbol_limit { Err(self.past_limit()) } else { Ok(()) }
    }

    #[cold]
    fn past_limit(&self) -> LsystemError {
        let TurtleSettings { derivations, seed, symbol_limit: limit, .. } = *self.settings;
        let seed = self.program.random.then_some(seed);
        LsystemError::GrewPastLimit { derivations, seed, limit, fits: self.within_limit }
    }

    #[inline]
    fn spend(&mut self, symbols: u64) -> Result<(), LsystemError> {
        self.spent += symbols;
        if self.spent >= PATIENCE { self.look_up() } else { Ok(()) }
    }

    #[cold]
    fn look_up(&mut self) -> Result<(), LsystemError> {
        self.spent = 0;
        self.monitor.check()?;
        self.monitor.advance(Phase::Turtle, self.given, self.total);
        Ok(())
    }
}
