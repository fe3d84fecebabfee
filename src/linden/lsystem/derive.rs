//! Derivation: depth first through the tree of rewritings, without a string.
//!
//! Each open word stands on an explicit stack, at most one per derivation step, and each symbol of the
//! last string is handed on when it is reached. Random choices are keyed by the path to the symbol
//! (which rewritten symbol of the axiom, which of its successor, …), so that going breadth first
//! instead would choose the same.

use super::error::LsystemError;
use super::grammar::Grammar;
use super::grow::Settings;
use super::program::{Program, Word};
use crate::monitor::{Monitor, Quiet, Stage};
use crate::random::Key;

/// How much is done between two looks at the monitor: about a millisecond.
const PATIENCE: u64 = 1 << 16;

/// Takes the symbols of the derived string, from first to last.
pub(super) trait Sink {
    /// Some consecutive modules that came into being in the same derivation step, by their
    /// identifiers in [`Program::modules`]. Their arguments, if any, are constants and part of the
    /// identified module ([`Program::commands`]).
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError>;

    /// One module whose arguments were computed: all finite, at least one, the first in the range of
    /// the turtle's command. A length may be so short, or 0, that there is nothing to draw.
    #[expect(dead_code, reason = "rules compute no arguments yet")]
    fn apply(&mut self, module: u32, arguments: &[f64], birth: u32) -> Result<(), LsystemError>;
}

/// Derives a string: for small systems, to look at. [`grow`](super::grow) keeps none in memory.
///
/// Uses the derivations, the seed and the symbol limit of `settings`. A `%` and what it cuts are not
/// part of the string in which the `%` stands.
///
/// # Errors
/// As [`grow`](super::grow), except that a string that draws nothing is a string, too.
///
/// ```
/// use linden::lsystem::{Grammar, Settings, derive_string};
/// let anabaena = Grammar::new("b", &["a -> ab", "b -> a"])?; // ABOP, section 1.2
/// let settings = Settings { derivations: 5, ..Settings::default() };
/// assert_eq!(derive_string(&anabaena, &settings)?, "abaababa");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive_string(grammar: &Grammar, settings: &Settings) -> Result<String, LsystemError> {
    let program = Program::compile(grammar);
    let forecast = settings.admit(&program)?;
    let names = program.modules.iter().map(ToString::to_string).collect();
    let mut written = Written { names, text: String::new() };
    derive(&program, settings, forecast.exact.then_some(forecast.symbols as u64), &Quiet, &mut written)?;
    Ok(written.text)
}

struct Written {
    names: Vec<String>,
    text: String,
}

impl Sink for Written {
    fn take(&mut self, modules: &[u32], _: u32) -> Result<(), LsystemError> {
        self.text.extend(modules.iter().map(|&id| self.names[id as usize].as_str()));
        Ok(())
    }

    fn apply(&mut self, module: u32, arguments: &[f64], _: u32) -> Result<(), LsystemError> {
        self.text.push_str(&self.names[module as usize]);
        for (i, argument) in arguments.iter().enumerate() {
            self.text.push(if i == 0 { '(' } else { ',' });
            self.text.push_str(&argument.to_string());
        }
        self.text.push(')');
        Ok(())
    }
}

/// Hands the derived string to `sink` and says how long it was. `total` is its length when known.
pub(super) fn derive<S: Sink>(
    program: &Program,
    settings: &Settings,
    total: Option<u64>,
    monitor: &dyn Monitor,
    sink: &mut S,
) -> Result<u64, LsystemError> {
    let last = settings.derivations;
    // With no derivations left, the axiom's symbols are all kept.
    let rewritten = if last == 0 { 0 } else { program.rewrites.len() as u32 };
    let mut outlet = Outlet { settings, total, monitor, sink, given: 0, spent: 0 };
    let mut stack =
        vec![Frame { word: program.axiom, next: 0, key: Key::new(settings.seed).named("lsystem") }];
    while let Some(frame) = stack.last_mut() {
        let rest = &program.word(frame.word)[frame.next..];
        let kept = rest.iter().take_while(|&&id| id >= rewritten).count();
        let rewrite = rest.get(kept).and_then(|&id| program.rewrite(id));
        let here = frame.next + kept;
        frame.next = here + 1;
        let key = frame.key;
        let word = frame.word;
        // The stack holds one word for each derivation so far, and the axiom.
        let birth = stack.len() as u32 - 1;
        outlet.give(&rest[..kept], birth)?;
        let Some(rewrite) = rewrite else {
            stack.pop();
            if word.cuts
                && let Some(below) = stack.last_mut()
            {
                below.cut(program);
            }
            continue;
        };
        if rewrite.vanishes_in <= last - birth {
            continue;
        }
        // Without choices nobody looks at the keys.
        let key = if program.stochastic { key.child(program.ordinals(word)[here].into()) } else { key };
        let word = rewrite.choose(key);
        if birth + 1 < last {
            outlet.spend(1)?;
            stack.push(Frame { word, next: 0, key });
        } else {
            outlet.give(program.word(word), last)?;
            if word.cuts
                && let Some(frame) = stack.last_mut()
            {
                frame.cut(program);
            }
        }
    }
    monitor.advance(Stage::Turtle, outlet.given, total);
    Ok(outlet.given)
}

/// A word whose modules are being rewritten.
struct Frame {
    word: Word,
    /// The module to look at next.
    next: usize,
    /// The random path to the module that became this word.
    key: Key,
}

impl Frame {
    /// Passes over the rest of the branch; where that is the rest of the word, what follows the word
    /// is cut as well.
    fn cut(&mut self, program: &Program) {
        let modules = program.word(self.word);
        let mut depth = 0_usize;
        for (i, &id) in modules.iter().enumerate().skip(self.next) {
            match program.modules[id as usize].symbol {
                '[' => depth += 1,
                ']' if depth == 0 => {
                    self.next = i;
                    return;
                }
                ']' => depth -= 1,
                _ => {}
            }
        }
        self.next = modules.len();
        self.word.cuts = true;
    }
}

/// Counts what is handed on, and looks at the monitor now and then.
struct Outlet<'a, S> {
    settings: &'a Settings,
    total: Option<u64>,
    monitor: &'a dyn Monitor,
    sink: &'a mut S,
    given: u64,
    /// Work since the last look at the monitor, in symbols.
    spent: u64,
}

impl<S: Sink> Outlet<'_, S> {
    fn give(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        for some in modules.chunks(PATIENCE as usize) {
            self.given += some.len() as u64;
            let Settings { derivations, seed, symbol_limit: limit, .. } = *self.settings;
            if self.given > limit {
                return Err(LsystemError::GrewPastLimit { derivations, seed, limit });
            }
            self.sink.take(some, birth)?;
            self.spend(some.len() as u64)?;
        }
        Ok(())
    }

    fn spend(&mut self, symbols: u64) -> Result<(), LsystemError> {
        self.spent += symbols;
        if self.spent >= PATIENCE {
            self.spent = 0;
            self.monitor.check()?;
            self.monitor.advance(Stage::Turtle, self.given, self.total);
        }
        Ok(())
    }
}
