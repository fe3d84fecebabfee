//! A grammar made ready for running: symbols as numbers, words as ranges.

use std::collections::BTreeMap;
use std::ops::Range;

use super::command::Command;
use super::grammar::{Expression, Grammar, Module, Production};
use crate::random::Key;

/// A compiled [`Grammar`]. Holds no `%`: what a `%` cuts inside its own word is left out here, and
/// what it cuts beyond is [`Word::cuts`].
pub(super) struct Program {
    /// The distinct modules, by identifier; those that are rewritten come first.
    pub modules: Vec<Module>,
    /// Their arguments.
    constants: Vec<Vec<f64>>,
    /// How the first modules are rewritten.
    pub rewrites: Vec<Rewrite>,
    /// The identifiers of all words' modules, end to end.
    code: Vec<u32>,
    /// For each entry of `code`: how many rewritten modules stand before it in its word as written.
    /// The branch of the random path, which so survives edits to the turtle's symbols.
    ordinals: Vec<u32>,
    /// The axiom.
    pub axiom: Word,
    /// Whether a random choice can be met.
    pub stochastic: bool,
}

/// A string of modules, brackets balanced.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word {
    start: u32,
    end: u32,
    /// Whether it ends with a `%`: then the rest of the branch in which it stands is cut.
    pub cuts: bool,
}

/// What may become of a module.
pub(super) struct Rewrite {
    /// Successors of positive probability, with the probability up to and including each; not empty.
    pub alternatives: Vec<(f64, Word)>,
    /// The derivations after which nothing is left of it for certain; `u32::MAX` when that never
    /// happens. Keeps work in proportion to the result.
    pub vanishes_in: u32,
}

impl Rewrite {
    /// The alternative that is chosen at a place.
    pub(super) fn choose(&self, place: Key) -> Word {
        if let [(_, only)] = self.alternatives[..] {
            return only;
        }
        let unit = place.unit();
        let found = self.alternatives.iter().find(|(up_to, _)| unit < *up_to);
        // Probabilities may sum to a hair less than 1; the last alternative has what is left.
        found.or(self.alternatives.last()).map_or(Word::EMPTY, |&(_, word)| word)
    }
}

impl Program {
    pub(super) fn compile(grammar: &Grammar) -> Self {
        let possible: Vec<&Production> =
            grammar.productions().iter().filter(|production| production.probability > 0.0).collect();
        let mut compiler = Compiler::default();
        for production in &possible {
            compiler.identify(&Module { symbol: production.predecessor.symbol, arguments: Vec::new() });
        }
        compiler.rewritten = compiler.modules.len() as u32;

        let axiom = compiler.word(grammar.axiom());
        let mut alternatives = vec![Vec::new(); compiler.modules.len()];
        for production in &possible {
            let word = compiler.word(&production.successor);
            let id = compiler.ids[&Compiler::name(production.predecessor.symbol, None)];
            let list: &mut Vec<(f64, Word)> = &mut alternatives[id as usize];
            let before = list.last().map_or(0.0, |&(up_to, _)| up_to);
            list.push((before + production.probability, word));
        }
        alternatives.truncate(compiler.rewritten as usize);
        let stochastic = alternatives.iter().any(|list| list.len() > 1);
        let rewrites =
            alternatives.into_iter().map(|alternatives| Rewrite { alternatives, vanishes_in: u32::MAX });
        let mut program = Self {
            rewrites: rewrites.collect(),
            constants: compiler.modules.iter().map(|m| argument_of(m).into_iter().collect()).collect(),
            modules: compiler.modules,
            code: compiler.code,
            ordinals: compiler.ordinals,
            axiom,
            stochastic,
        };
        program.find_vanishing();
        program
    }

    pub(super) fn word(&self, word: Word) -> &[u32] {
        &self.code[word.range()]
    }

    pub(super) fn ordinals(&self, word: Word) -> &[u32] {
        &self.ordinals[word.range()]
    }

    /// How a module is rewritten; `None` when it is kept.
    pub(super) fn rewrite(&self, id: u32) -> Option<&Rewrite> {
        self.rewrites.get(id as usize)
    }

    /// The turtle's command of each module and its constant arguments, by identifier. Modules whose
    /// arguments are computed have none here.
    pub(super) fn commands(&self) -> impl Iterator<Item = (Command, &[f64])> {
        self.modules.iter().zip(&self.constants).map(|(module, constants)| {
            (Command::of(module.symbol).unwrap_or(Command::Silent), &constants[..])
        })
    }

    /// A module vanishes in one step more than the slowest module of its successors. Settles what
    /// vanishes in one step, then what needs one more, until nothing is added.
    fn find_vanishing(&mut self) {
        let count = self.rewrites.len();
        // For each module the rewritten ones whose successors it stands in, and for each of these
        // how many modules of its successors are not known to vanish.
        let mut occurrences = vec![Vec::new(); count];
        let mut lasting = vec![0_usize; count];
        for (i, rewrite) in self.rewrites.iter().enumerate() {
            for &(_, word) in &rewrite.alternatives {
                // A word that cuts has an effect even when it is empty.
                lasting[i] += usize::from(word.cuts);
                for &id in self.word(word) {
                    lasting[i] += 1;
                    if let Some(list) = occurrences.get_mut(id as usize) {
                        list.push(i);
                    }
                }
            }
        }
        let mut gone: Vec<usize> = (0..count).filter(|&i| lasting[i] == 0).collect();
        let mut step = 0;
        while !gone.is_empty() {
            step += 1;
            let mut next = Vec::new();
            for i in gone {
                self.rewrites[i].vanishes_in = step;
                for &user in &occurrences[i] {
                    lasting[user] -= 1;
                    if lasting[user] == 0 {
                        next.push(user);
                    }
                }
            }
            gone = next;
        }
    }
}

impl Word {
    const EMPTY: Self = Self { start: 0, end: 0, cuts: false };

    fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The number after a symbol.
fn argument_of(module: &Module) -> Option<f64> {
    module.arguments.first().map(|Expression::Number(number)| *number)
}

#[derive(Default)]
struct Compiler {
    modules: Vec<Module>,
    ids: BTreeMap<(char, Option<u64>), u32>,
    code: Vec<u32>,
    ordinals: Vec<u32>,
    rewritten: u32,
}

impl Compiler {
    /// What makes two modules the same one. Numbers are compared by their bits.
    fn name(symbol: char, argument: Option<f64>) -> (char, Option<u64>) {
        (symbol, argument.map(f64::to_bits))
    }

    fn identify(&mut self, module: &Module) -> u32 {
        let modules = &mut self.modules;
        *self.ids.entry(Self::name(module.symbol, argument_of(module))).or_insert_with(|| {
            modules.push(module.clone());
            modules.len() as u32 - 1
        })
    }

    fn word(&mut self, modules: &[Module]) -> Word {
        let start = self.code.len() as u32;
        let mut ordinal = 0;
        let mut depth = 0_usize;
        // The depth of the branch that a `%` has cut.
        let mut cut: Option<usize> = None;
        for module in modules {
            let command = Command::of(module.symbol);
            match command {
                Some(Command::Push) => depth += 1,
                Some(Command::Pop) => {
                    if cut == Some(depth) {
                        cut = None;
                    }
                    depth = depth.saturating_sub(1);
                }
                Some(Command::Cut) => cut = cut.or(Some(depth)),
                _ => {}
            }
            if command == Some(Command::Cut) {
                continue;
            }
            let id = self.identify(module);
            if cut.is_none() {
                self.code.push(id);
                self.ordinals.push(ordinal);
            }
            ordinal += u32::from(id < self.rewritten);
        }
        Word { start, end: self.code.len() as u32, cuts: cut.is_some() }
    }
}
