//! Depth first through the tree of rewritings, without a string.
//!
//! Each open word stands on an explicit stack, at most one per derivation step, with the parameters
//! that its formulas look at on a stack beside it; each module of the last string is handed on when
//! it is reached. Memory is in proportion to the derivations, and nothing is allocated per module.

use super::{Outlet, Sink, bad_condition, chance, compute, root};
use crate::error::LsystemError;
use crate::expression::code::Inputs;
use crate::program::{Program, Word};
use linden_base::random::Key;

/// A word whose modules are being rewritten.
struct Frame {
    word: Word,
    /// The module to look at next, and the next of those whose arguments are computed.
    next: usize,
    next_call: usize,
    /// The random path to the module that became this word.
    key: Key,
    /// Where the parameters begin.
    parameters: usize,
    birth: u32,
}

impl Frame {
    /// Passes over the rest of the branch; where that is the rest of the word, what follows the word
    /// is cut as well.
    fn cut(&mut self, program: &Program) {
        let modules = program.word(self.word);
        let mut depth = 0_usize;
        let mut end = None;
        for (i, &id) in modules.iter().enumerate().skip(self.next) {
            match program.modules[id as usize].symbol {
                '[' => depth += 1,
                ']' if depth == 0 => {
                    end = Some(i);
                    break;
                }
                ']' => depth -= 1,
                _ => {}
            }
        }
        self.next = end.unwrap_or(modules.len());
        self.word.cuts |= end.is_none();
        let passed =
            program.calls(self.word)[self.next_call..].partition_point(|c| (c.at as usize) < self.next);
        self.next_call += passed;
    }
}

pub(super) fn derive<S: Sink>(outlet: &mut Outlet<'_, S>) -> Result<(), LsystemError> {
    let program = outlet.program;
    let last = outlet.settings.derivations;
    let mut scratch = Vec::new();
    let key = root(outlet.settings);
    if last == 0 {
        return outlet.word(program.axiom, &[], key, 0, &mut scratch);
    }
    let mut values: Vec<f64> = Vec::new();
    let mut stack = vec![Frame { word: program.axiom, next: 0, next_call: 0, key, parameters: 0, birth: 0 }];
    while let Some(frame) = stack.last_mut() {
        let rest = &program.word(frame.word)[frame.next..];
        let kept = rest.iter().take_while(|&&id| id >= program.first_plain).count();
        let here = frame.next + kept;
        frame.next = here + 1;
        let birth = frame.birth;
        outlet.give(&rest[..kept], birth)?;
        let Some(&id) = rest.get(kept) else {
            let Frame { word, parameters, .. } = *frame;
            values.truncate(parameters);
            stack.pop();
            if word.cuts
                && let Some(below) = stack.last_mut()
            {
                below.cut(program);
            }
            continue;
        };
        if let Some(symbols) = outlet.sink.take_all(id, birth) {
            outlet.given += symbols;
            outlet.check_limit(outlet.given)?;
            outlet.spend(symbols)?;
            continue;
        }
        let Frame { word, key, parameters, .. } = *frame;
        let top = values.len();
        let entry = &program.modules[id as usize];
        if entry.is_computed() {
            let call = program.calls(word)[frame.next_call];
            frame.next_call += 1;
            outlet.spend(call.cost.into())?;
            values.resize(top + entry.arity as usize, 0.0);
            let (known, new) = values.split_at_mut(top);
            let inputs = Inputs { parameters: &known[parameters..], key: chance(program, key) };
            compute(program, (id, call), inputs, new, birth)
                .map_err(|error| error.by(program.production_of(word)))?;
        } else {
            values.extend_from_slice(&entry.constants);
        }
        // Without choices the keys are not used.
        let key = if program.random { key.child(program.ordinals(word)[here].into()) } else { key };
        let found = if program.rewrite(id).is_some_and(|rewrite| rewrite.vanishes_in <= last - birth) {
            values.truncate(top);
            continue;
        } else {
            successor(outlet, id, &values[top..], key, birth)?
        };
        let Some((step, word)) = found else {
            if entry.is_computed() {
                outlet.apply(id, &values[top..], birth)?;
            } else {
                outlet.give(&[id], birth)?;
            }
            values.truncate(top);
            continue;
        };
        if step < last {
            outlet.spend(1)?;
            stack.push(Frame { word, next: 0, next_call: 0, key, parameters: top, birth: step });
            continue;
        }
        outlet.word(word, &values[top..], key, step, &mut scratch)?;
        values.truncate(top);
        if word.cuts
            && let Some(frame) = stack.last_mut()
        {
            frame.cut(program);
        }
    }
    Ok(())
}

/// The step in which a module of a step is rewritten, and to what; `None` when it is kept to the end.
#[inline]
fn successor<S: Sink>(
    outlet: &mut Outlet<'_, S>,
    id: u32,
    arguments: &[f64],
    place: Key,
    birth: u32,
) -> Result<Option<(u32, Word)>, LsystemError> {
    let program = outlet.program;
    if let Some(word) = program.certain(id) {
        return Ok(Some((birth + 1, word)));
    }
    chosen(outlet, id, arguments, place, birth)
}

/// The same where conditions or chance decide.
fn chosen<S: Sink>(
    outlet: &mut Outlet<'_, S>,
    id: u32,
    arguments: &[f64],
    place: Key,
    birth: u32,
) -> Result<Option<(u32, Word)>, LsystemError> {
    let program = outlet.program;
    let Some(rewrite) = program.rewrite(id) else { return Ok(None) };
    let groups = program.groups(rewrite);
    // What is decided by the arguments alone is decided once; chance is asked in every step.
    let is_random = groups.iter().any(|group| group.is_random);
    let steps = birth + 1..=if is_random { outlet.settings.derivations } else { birth + 1 };
    for step in steps {
        for group in groups {
            match program.holds(group, arguments, place, step) {
                Some(true) => {
                    return Ok(Some((step, program.alternatives[program.choose(group, place)].word)));
                }
                Some(false) => {}
                None => return Err(bad_condition(program, group, (id, arguments), step)),
            }
            outlet.spend(1 + u64::from(group.cost))?;
        }
    }
    Ok(None)
}
