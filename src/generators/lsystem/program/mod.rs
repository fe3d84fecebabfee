//! A grammar made ready for running: symbols as numbers, words as ranges, arithmetic as formulas.

mod compile;

use std::fmt;
use std::ops::Range;

use super::command::Command;
use super::error::Short;
use super::expression::code::{Formula, Inputs, Library, is_true};
use linden_base::random::Key;

/// A compiled [`Grammar`]. Holds no `%`: what a `%` cuts inside the word that it stands in is left out
/// here, and what it cuts beyond is [`Word::cuts`].
pub(super) struct Program {
    /// The distinct modules, by identifier: first those that rules may rewrite, then those that are
    /// kept and whose arguments are computed, then the rest.
    pub modules: Vec<Entry>,
    /// The first identifier that no rule rewrites.
    pub first_kept: u32,
    /// The first identifier from which on modules are kept and constant.
    pub first_plain: u32,
    /// What the first modules are rewritten to: index into [`Self::rewrites`].
    classes: Vec<u32>,
    /// The words of the first modules that become one word whatever their arguments are.
    certain: Vec<Option<Word>>,
    /// By symbol and number of arguments.
    pub rewrites: Vec<Rewrite>,
    /// Of all rewrites, end to end.
    pub groups: Vec<Group>,
    /// Of all groups, end to end.
    pub alternatives: Vec<Alternative>,
    /// The identifiers of all words' modules, end to end.
    code: Vec<u32>,
    /// For each entry of `code`: how many rewritten modules stand before it in its word as written.
    /// The branch of the random path, which so survives edits to the turtle's symbols.
    ordinals: Vec<u32>,
    /// The modules of all words whose arguments are computed, end to end.
    calls: Vec<Call>,
    /// Of all calls, end to end.
    formulas: Vec<Formula>,
    pub library: Library,
    /// The axiom.
    pub axiom: Word,
    /// Whether chance can be met.
    pub random: bool,
    /// Whether it can be met in arguments.
    pub random_arguments: bool,
    /// Whether some rule looks at what stands before, or behind.
    pub contexts: Contexts,
    /// Whether some word cuts what follows it.
    pub cuts: bool,
}

/// Which neighbours rules look at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contexts {
    pub left: bool,
    pub right: bool,
}

/// A module as it stands in the string, or one of which the arguments are not known yet.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub symbol: char,
    pub arity: u32,
    /// Its arguments; empty when they are computed.
    pub constants: Vec<f64>,
    /// Stands for a symbol and a number of arguments, for contexts.
    pub kind: u32,
    /// Whether contexts pass over it.
    pub is_ignored: bool,
}

impl Entry {
    pub fn is_computed(&self) -> bool {
        self.arity as usize != self.constants.len()
    }

    /// With arguments.
    pub fn with(&self, arguments: &[f64]) -> String {
        let list: Vec<String> = arguments.iter().map(|argument| Short(*argument).to_string()).collect();
        if list.is_empty() { self.symbol.to_string() } else { format!("{}({})", self.symbol, list.join(",")) }
    }
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with(&self.constants))
    }
}

/// A string of modules, brackets balanced.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word {
    start: u32,
    end: u32,
    calls_start: u32,
    calls_end: u32,
    /// Computed arguments in all.
    pub values: u32,
    /// Whether it ends with a `%`: then the rest of the branch in which it stands is cut.
    pub cuts: bool,
}

/// A module of a word whose arguments are computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Call {
    /// Its place in the word.
    pub at: u32,
    start: u32,
    end: u32,
    /// Cost of computing it beyond one symbol's worth of work, in symbols.
    pub cost: u32,
}

/// What may become of the modules of one symbol with one number of arguments.
pub(super) struct Rewrite {
    /// In the order in which they are tried; not empty.
    groups: Range<u32>,
    /// The derivations after which nothing is left of it for certain; `u32::MAX` when that never
    /// happens. Keeps work in proportion to the result.
    pub vanishes_in: u32,
}

/// Productions that share out their probability.
pub(super) struct Group {
    /// Nearest first.
    pub left: Vec<Sought>,
    pub right: Vec<Sought>,
    /// The index of the module's first argument among the parameters: those of its left context come first.
    pub arguments_at: usize,
    /// How many parameters there are.
    pub parameters: usize,
    pub condition: Option<Formula>,
    /// Cost of looking at it beyond one symbol's worth of work, in symbols, each neighbour of its contexts once.
    pub cost: u32,
    /// Whether another step may decide otherwise about the same module.
    pub is_random: bool,
    alternatives: Range<u32>,
}

/// A part of a context.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sought {
    /// A module of a [kind](Entry::kind); its arguments go to the parameters from here on.
    Module {
        kind: u32,
        first: u32,
    },
    Open,
    Close,
}

/// One of the productions of a group.
pub(super) struct Alternative {
    /// The probability up to and including this one; more than of the one before.
    pub up_to: f64,
    pub word: Word,
    pub group: u32,
    /// Its place in [`Grammar::productions`](crate::Grammar::productions).
    pub production: u32,
}

impl Group {
    pub(super) fn has_context(&self) -> bool {
        !(self.left.is_empty() && self.right.is_empty())
    }

    /// Whether it takes every module that comes to it.
    pub(super) fn is_certain(&self) -> bool {
        self.condition.is_none() && !self.has_context()
    }
}

impl Program {
    pub(super) fn has_contexts(&self) -> bool {
        self.contexts.left || self.contexts.right
    }

    pub(super) fn word(&self, word: Word) -> &[u32] {
        &self.code[word.range()]
    }

    pub(super) fn ordinals(&self, word: Word) -> &[u32] {
        &self.ordinals[word.range()]
    }

    pub(super) fn calls(&self, word: Word) -> &[Call] {
        &self.calls[word.calls_start as usize..word.calls_end as usize]
    }

    pub(super) fn formulas(&self, call: Call) -> &[Formula] {
        &self.formulas[call.start as usize..call.end as usize]
    }

    /// How a module is rewritten; `None` when no rule is for it.
    pub(super) fn rewrite(&self, id: u32) -> Option<&Rewrite> {
        self.class(id).map(|class| &self.rewrites[class])
    }

    /// The index of a module's rewrite.
    pub(super) fn class(&self, id: u32) -> Option<usize> {
        self.classes.get(id as usize).map(|&class| class as usize)
    }

    /// The word that a module becomes in its next step, if that is the same always.
    #[inline]
    pub(super) fn certain(&self, id: u32) -> Option<Word> {
        self.certain.get(id as usize).copied().flatten()
    }

    pub(super) fn groups(&self, rewrite: &Rewrite) -> &[Group] {
        &self.groups[rewrite.groups.start as usize..rewrite.groups.end as usize]
    }

    pub(super) fn alternatives(&self, group: &Group) -> &[Alternative] {
        &self.alternatives[group.alternatives.start as usize..group.alternatives.end as usize]
    }

    /// The alternative of a group that is chosen at a place, as an index into [`Self::alternatives`].
    #[inline]
    pub(super) fn choose(&self, group: &Group, place: Key) -> usize {
        let Range { start, end } = group.alternatives;
        if end - start == 1 { start as usize } else { self.draw_lots(group, place) }
    }

    fn draw_lots(&self, group: &Group, place: Key) -> usize {
        let Range { start, end } = group.alternatives;
        let unit = place.unit();
        let found = self.alternatives(group).iter().position(|alternative| unit < alternative.up_to);
        // Probabilities may sum to a hair less than 1; the last alternative has what is left.
        found.map_or(end as usize - 1, |i| start as usize + i)
    }

    /// Whether the condition of a group holds in a derivation step; `None` where it comes to no number.
    #[inline]
    pub(super) fn holds(&self, group: &Group, parameters: &[f64], place: Key, step: u32) -> Option<bool> {
        match group.condition {
            None => Some(true),
            Some(condition) => self.comes_true(condition, group, parameters, (place, step)),
        }
    }

    fn comes_true(
        &self,
        condition: Formula,
        group: &Group,
        parameters: &[f64],
        (place, step): (Key, u32),
    ) -> Option<bool> {
        let key = if group.is_random { place.named("condition").child(step.into()) } else { place };
        is_true(self.library.evaluate(condition, Inputs { parameters, key }))
    }

    /// The production that a word belongs to, as a place in [`Grammar::productions`](crate::Grammar::productions); none
    /// for the axiom.
    pub(super) fn production_of(&self, word: Word) -> Option<u32> {
        // An empty word begins where another does, but nothing in it can be wrong.
        let found = self.alternatives.iter().find(|choice| choice.word.range() == word.range());
        found.map(|choice| choice.production)
    }

    /// The first production of a group.
    pub(super) fn first_production(&self, group: &Group) -> Option<u32> {
        self.alternatives(group).first().map(|choice| choice.production)
    }

    /// The turtle's command of each module and its constant arguments, by identifier. Modules whose
    /// arguments are computed have none here.
    pub(super) fn commands(&self) -> impl Iterator<Item = (Command, &[f64])> {
        self.modules
            .iter()
            .map(|entry| (Command::of(entry.symbol).unwrap_or(Command::Silent), &entry.constants[..]))
    }

    /// Whether some word begins a polygon or places an organ.
    pub(super) fn writes_organs(&self) -> bool {
        self.commands().any(|(command, _)| matches!(command, Command::PolygonBegin | Command::Organ))
    }

    /// Fills in what [`Self::certain`] gives.
    fn find_certain(&mut self) {
        let of_class = |&class: &u32| {
            let group = self.groups(&self.rewrites[class as usize]).first()?;
            match self.alternatives(group) {
                [alternative] if group.is_certain() => Some(alternative.word),
                _ => None,
            }
        };
        self.certain = self.classes.iter().map(of_class).collect();
    }

    /// A module vanishes in one step more than the slowest module of its successors. Settles what
    /// vanishes in one step, then what needs one more, until nothing is added.
    fn find_vanishing(&mut self) {
        let count = self.rewrites.len();
        // For each rewrite those whose successors hold a module of it, and for each of these how many
        // modules of its successors are not known to vanish.
        let mut occurrences = vec![Vec::new(); count];
        let mut lasting = vec![0_usize; count];
        for (i, rewrite) in self.rewrites.iter().enumerate() {
            let groups = self.groups(rewrite);
            lasting[i] += usize::from(!groups.iter().any(Group::is_certain));
            for word in groups.iter().flat_map(|group| self.alternatives(group)).map(|choice| choice.word) {
                // A word that cuts has an effect even when it is empty; one that computes may fail.
                lasting[i] += usize::from(word.cuts) + usize::from(word.values > 0);
                for &id in self.word(word) {
                    lasting[i] += 1;
                    if let Some(&class) = self.classes.get(id as usize) {
                        occurrences[class as usize].push(i);
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
    fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    pub(super) fn len(self) -> usize {
        self.range().len()
    }
}
