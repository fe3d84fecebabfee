//! How much a derivation would give, without deriving.

use super::error::LsystemError;
use super::grammar::Grammar;
use super::grow::check_derivations;
use super::program::{Program, Word};
use crate::skeleton::Skeleton;

/// How much a derivation gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forecast {
    /// The length of the string: symbols with their brackets, an argument not counted. Saturates at
    /// `u128::MAX`.
    pub symbols: u128,
    /// Segments drawn: `F` and `G`. Saturates at `u128::MAX`.
    pub segments: u128,
    /// Most branches open at once; for a stochastic system, the most that is possible. A lower bound
    /// when `symbols` is saturated.
    pub depth: u64,
    /// Whether the counts are exact. Those of a stochastic system are expectations, rounded; the
    /// standard deviation of one tree is often a third of them.
    pub exact: bool,
}

impl Forecast {
    /// Bytes that nodes and skeleton take while the skeleton is built, about: how many axes there will
    /// be is not known; a third of the nodes is taken for one. `None` beyond what can be counted.
    pub fn skeleton_bytes(&self) -> Option<u64> {
        Skeleton::build_bytes(usize::try_from(self.segments.checked_add(1)?).ok()?)
    }
}

/// Counts what `derivations` steps give.
///
/// The counts of every symbol after k + 1 steps follow from those of its successors after k (ABOP,
/// section 1.2; the growth matrix applied from the left). Takes time in proportion to derivations
/// × rules, less when the counts saturate, and no memory that depends on the result.
///
/// # Errors
/// [`LsystemError::Setting`] when `derivations` is above [`MAX_DERIVATIONS`](super::MAX_DERIVATIONS).
pub fn forecast(grammar: &Grammar, derivations: u32) -> Result<Forecast, LsystemError> {
    check_derivations(derivations)?;
    let program = Program::compile(grammar);
    Ok(of_program(&program, derivations))
}

pub(super) fn of_program(program: &Program, derivations: u32) -> Forecast {
    if program.stochastic {
        Growth::<f64>::after(program, derivations).forecast(false)
    } else {
        Growth::<u128>::after(program, derivations).forecast(true)
    }
}

/// The most derivations below `derivations` up to which no forecast passes `limit`.
pub(super) fn most_within(program: &Program, derivations: u32, limit: u64) -> Option<u32> {
    if program.stochastic {
        Growth::<f64>::new(program).most_within(derivations, limit)
    } else {
        Growth::<u128>::new(program).most_within(derivations, limit)
    }
}

/// A count: exact and saturating, or an expectation.
trait Count: Copy + PartialEq {
    const ZERO: Self;
    const ONE: Self;
    /// Where counting stops.
    const MOST: Self;
    fn plus(self, other: Self) -> Self;
    /// Counted with a probability. Where counts are exact, probabilities are 0 or 1.
    fn weighed(self, probability: f64) -> Self;
    fn whole(self) -> u128;
}

impl Count for u128 {
    const ZERO: Self = 0;
    const ONE: Self = 1;
    const MOST: Self = Self::MAX;

    fn plus(self, other: Self) -> Self {
        self.saturating_add(other)
    }

    fn weighed(self, probability: f64) -> Self {
        if probability > 0.0 { self } else { 0 }
    }

    fn whole(self) -> u128 {
        self
    }
}

impl Count for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const MOST: Self = Self::MAX;

    fn plus(self, other: Self) -> Self {
        // Stays finite, so that nothing times an overflow is nothing.
        (self + other).min(Self::MAX)
    }

    fn weighed(self, probability: f64) -> Self {
        self * probability
    }

    /// Rounded, but what is possible is never none.
    fn whole(self) -> u128 {
        if self > 0.0 { (self.round() as u128).max(1) } else { 0 }
    }
}

/// What one module, or one word, gives.
#[derive(Clone, Copy, PartialEq)]
struct Tally<C> {
    symbols: C,
    segments: C,
    depth: u64,
    /// The probability that it cuts what follows it in its branch.
    cuts: f64,
}

impl<C: Count> Tally<C> {
    const NOTHING: Self = Self { symbols: C::ZERO, segments: C::ZERO, depth: 0, cuts: 0.0 };

    /// Whether nothing changes any more. The depth under a count beyond counting does not matter.
    fn settled_since(&self, before: &Self) -> bool {
        let depth_settled = self.depth == before.depth || self.symbols == C::MOST;
        depth_settled && Self { depth: before.depth, ..*self } == *before
    }

    fn forecast(self, exact: bool) -> Forecast {
        Forecast { symbols: self.symbols.whole(), segments: self.segments.whole(), depth: self.depth, exact }
    }
}

/// The tallies of all modules after some number of derivations.
struct Growth<'a, C> {
    program: &'a Program,
    /// By module identifier.
    tallies: Vec<Tally<C>>,
    next: Vec<Tally<C>>,
    /// For each open bracket of the word that is being tallied: the probability that the branch was
    /// not cut before it.
    open: Vec<f64>,
}

impl<'a, C: Count> Growth<'a, C> {
    /// No derivations: each module is itself.
    fn new(program: &'a Program) -> Self {
        let alone = |(command, _): (super::command::Command, _)| Tally {
            symbols: C::ONE,
            segments: if command.draws() { C::ONE } else { C::ZERO },
            ..Tally::NOTHING
        };
        let tallies: Vec<_> = program.commands().map(alone).collect();
        let next = tallies[..program.rewrites.len()].to_vec();
        Self { program, tallies, next, open: Vec::new() }
    }

    /// The axiom's tally after some derivations.
    fn after(program: &'a Program, derivations: u32) -> Tally<C> {
        let mut growth = Self::new(program);
        for _ in 0..derivations {
            if !growth.derive() {
                break;
            }
        }
        growth.tally(program.axiom)
    }

    fn most_within(mut self, derivations: u32, limit: u64) -> Option<u32> {
        let mut fits = None;
        for step in 0..derivations {
            if self.tally(self.program.axiom).symbols.whole() > u128::from(limit) {
                break;
            }
            fits = Some(step);
            self.derive();
        }
        fits
    }

    /// One derivation more. `false` when it changed nothing that counts, and so never will.
    fn derive(&mut self) -> bool {
        for i in 0..self.next.len() {
            self.next[i] = self.tally_of_rewrite(i);
        }
        let old = &mut self.tallies[..self.next.len()];
        let changed = old.iter().zip(&self.next).any(|(old, new)| !new.settled_since(old));
        old.copy_from_slice(&self.next);
        changed
    }

    fn tally_of_rewrite(&mut self, index: usize) -> Tally<C> {
        let program = self.program;
        let alternatives = &program.rewrites[index].alternatives;
        if let [(_, word)] = alternatives[..] {
            return self.tally(word);
        }
        let mut sum = Tally::<C>::NOTHING;
        let mut before = 0.0;
        for &(up_to, word) in alternatives {
            let tally = self.tally(word);
            let probability = up_to - before;
            before = up_to;
            sum.symbols = sum.symbols.plus(tally.symbols.weighed(probability));
            sum.segments = sum.segments.plus(tally.segments.weighed(probability));
            sum.depth = sum.depth.max(tally.depth);
            sum.cuts += tally.cuts * probability;
        }
        sum
    }

    /// What a word gives. Its modules are rewritten independently of each other, so the probability
    /// that nothing before a module has cut its branch is a product.
    fn tally(&mut self, word: Word) -> Tally<C> {
        let mut sum = Tally::<C>::NOTHING;
        let mut uncut = 1.0;
        self.open.clear();
        for &id in self.program.word(word) {
            let tally = &self.tallies[id as usize];
            match self.program.modules[id as usize].symbol {
                '[' => {
                    self.open.push(uncut);
                    if uncut > 0.0 {
                        sum.depth = sum.depth.max(self.open.len() as u64);
                    }
                }
                ']' => uncut = self.open.pop().unwrap_or(uncut),
                _ if uncut > 0.0 => {
                    sum.depth = sum.depth.max(tally.depth.saturating_add(self.open.len() as u64));
                }
                _ => {}
            }
            sum.symbols = sum.symbols.plus(tally.symbols.weighed(uncut));
            sum.segments = sum.segments.plus(tally.segments.weighed(uncut));
            uncut *= 1.0 - tally.cuts;
        }
        sum.cuts = if word.cuts { 1.0 } else { 1.0 - uncut };
        sum
    }
}
