//! A grammar made ready for running: symbols as numbers, words as ranges, arithmetic as formulas.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;

use super::command::Command;
use super::error::Short;
use super::expression::code::{Formula, Inputs, Library, is_true};
use super::grammar::{Expression, Grammar, Module, Pattern, Production, groups};
use crate::random::Key;

/// A compiled [`Grammar`]. Holds no `%`: what a `%` cuts inside its own word is left out here, and
/// what it cuts beyond is [`Word::cuts`].
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
        let list: Vec<String> = arguments.iter().map(|own| Short(*own).to_string()).collect();
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
    /// What computing costs beyond one symbol's worth of work, in symbols.
    pub cost: u32,
}

/// What may become of the modules of one symbol with so many arguments.
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
    /// Where the module's own arguments stand among the parameters, and how many of these there are.
    pub own: usize,
    pub parameters: usize,
    pub condition: Option<Formula>,
    /// What looking at it costs beyond one symbol's worth of work, in symbols.
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
    pub(super) fn compile(grammar: &Grammar) -> Self {
        Compiler::new(grammar).compile(grammar)
    }

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

    pub(super) fn groups(&self, rewrite: &Rewrite) -> &[Group] {
        &self.groups[rewrite.groups.start as usize..rewrite.groups.end as usize]
    }

    pub(super) fn alternatives(&self, group: &Group) -> &[Alternative] {
        &self.alternatives[group.alternatives.start as usize..group.alternatives.end as usize]
    }

    /// The alternative of a group that is chosen at a place, as an index into [`Self::alternatives`].
    pub(super) fn choose(&self, group: &Group, place: Key) -> usize {
        let Range { start, end } = group.alternatives;
        if end - start == 1 {
            return start as usize;
        }
        let unit = place.unit();
        let found = self.alternatives(group).iter().position(|alternative| unit < alternative.up_to);
        // Probabilities may sum to a hair less than 1; the last alternative has what is left.
        found.map_or(end as usize - 1, |i| start as usize + i)
    }

    /// Whether the condition of a group holds in a derivation step.
    pub(super) fn holds(&self, group: &Group, parameters: &[f64], place: Key, step: u32) -> bool {
        let Some(condition) = group.condition else { return true };
        let key = if group.is_random { place.named("condition").child(step.into()) } else { place };
        is_true(self.library.evaluate(condition, Inputs { parameters, key }))
    }

    /// The turtle's command of each module and its constant arguments, by identifier. Modules whose
    /// arguments are computed have none here.
    pub(super) fn commands(&self) -> impl Iterator<Item = (Command, &[f64])> {
        self.modules
            .iter()
            .map(|entry| (Command::of(entry.symbol).unwrap_or(Command::Silent), &entry.constants[..]))
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

/// What makes two modules the same one: symbol, number of arguments and their bits; `None` for
/// arguments that are computed.
type Name = (char, usize, Option<Vec<u64>>);

struct Compiler<'a> {
    /// Symbols and numbers of arguments with rules, in the order of the first rule of each.
    classes: BTreeMap<(char, usize), u32>,
    kinds: BTreeMap<(char, usize), u32>,
    ignored: BTreeSet<char>,
    ids: BTreeMap<Name, u32>,
    /// Identifiers in here are those of the first meeting; [`Self::compile`] sorts them.
    modules: Vec<Entry>,
    code: Vec<u32>,
    ordinals: Vec<u32>,
    calls: Vec<Call>,
    formulas: Vec<Formula>,
    library: Library,
    grouped: Vec<Vec<&'a Production>>,
}

impl<'a> Compiler<'a> {
    fn new(grammar: &'a Grammar) -> Self {
        let productions = grammar.productions();
        let grouped: Vec<Vec<&Production>> = groups(productions)
            .into_iter()
            .map(|group| group.into_iter().map(|i| &productions[i]).collect())
            .collect();
        let mut classes = BTreeMap::new();
        for group in &grouped {
            let next = classes.len() as u32;
            classes.entry(group[0].predecessor.class()).or_insert(next);
        }
        Self {
            classes,
            kinds: BTreeMap::new(),
            ignored: grammar.ignored().iter().copied().collect(),
            ids: BTreeMap::new(),
            modules: Vec::new(),
            code: Vec::new(),
            ordinals: Vec::new(),
            calls: Vec::new(),
            formulas: Vec::new(),
            library: Library::default(),
            grouped,
        }
    }

    fn compile(mut self, grammar: &Grammar) -> Program {
        let axiom = self.word(grammar.axiom());
        // By class; rules that look around before those that do not (ABOP, section 1.8).
        let mut grouped = std::mem::take(&mut self.grouped);
        grouped.sort_by_key(|group| {
            let first = group[0];
            (self.classes[&first.predecessor.class()], first.left.is_empty() && first.right.is_empty())
        });
        let mut rewrites: Vec<Rewrite> = Vec::new();
        let mut groups = Vec::new();
        let mut alternatives: Vec<Alternative> = Vec::new();
        for productions in &grouped {
            let class = self.classes[&productions[0].predecessor.class()] as usize;
            let start = alternatives.len() as u32;
            let mut up_to = 0.0;
            for production in productions.iter().filter(|production| production.probability > 0.0) {
                let word = self.word(&production.successor);
                up_to += production.probability;
                alternatives.push(Alternative { up_to, word, group: groups.len() as u32 });
            }
            let index = groups.len() as u32;
            if rewrites.len() == class {
                rewrites.push(Rewrite { groups: index..index, vanishes_in: u32::MAX });
            }
            rewrites[class].groups.end = index + 1;
            let group = self.group(productions[0], start..alternatives.len() as u32);
            groups.push(group);
        }
        let is_random = |group: &Group| group.is_random || group.alternatives.len() > 1;
        let chance = |module: &Module| module.arguments.iter().any(Expression::is_random);
        let mut modules = grammar.productions().iter().flat_map(|p| &p.successor).chain(grammar.axiom());
        let random_arguments = modules.any(chance);
        let random = random_arguments || groups.iter().any(is_random);
        let cuts = axiom.cuts || alternatives.iter().any(|alternative| alternative.word.cuts);
        let mut program = Program {
            first_kept: 0,
            first_plain: 0,
            classes: Vec::new(),
            random,
            random_arguments,
            contexts: Contexts {
                left: groups.iter().any(|group| !group.left.is_empty()),
                right: groups.iter().any(|group| !group.right.is_empty()),
            },
            cuts,
            modules: self.modules,
            rewrites,
            groups,
            alternatives,
            code: self.code,
            ordinals: self.ordinals,
            calls: self.calls,
            formulas: self.formulas,
            library: self.library,
            axiom,
        };
        program.sort(&self.classes);
        program.find_vanishing();
        program
    }

    fn kind(&mut self, class: (char, usize)) -> u32 {
        let next = self.kinds.len() as u32;
        *self.kinds.entry(class).or_insert(next)
    }

    fn group(&mut self, first: &Production, alternatives: Range<u32>) -> Group {
        let count =
            |patterns: &[Pattern]| patterns.iter().map(|pattern| pattern.parameters.len()).sum::<usize>();
        let own = count(&first.left);
        let after = own + first.predecessor.parameters.len();
        let mut seek = |patterns: &[Pattern], mut next: usize| -> Vec<Sought> {
            let sought = |pattern: &Pattern| match pattern.symbol {
                '[' => Sought::Open,
                ']' => Sought::Close,
                _ => {
                    let first = next as u32;
                    next += pattern.parameters.len();
                    Sought::Module { kind: self.kind(pattern.class()), first }
                }
            };
            patterns.iter().map(sought).collect()
        };
        let mut left = seek(&first.left, 0);
        left.reverse();
        let right = seek(&first.right, after);
        let parameters = after + count(&first.right);
        let is_random = first.condition.as_ref().is_some_and(Expression::is_random);
        let condition = first.condition.as_ref().map(|condition| self.library.add(condition, &mut 0));
        let instructions = condition.map_or(0, |condition| self.library.instructions(condition).len());
        Group {
            left,
            right,
            own,
            parameters,
            is_random,
            condition,
            cost: (instructions / 16) as u32,
            alternatives,
        }
    }

    /// The identifier of a module, and the formulas of its arguments when they are computed.
    fn identify(&mut self, module: &Module, randoms: &mut u32) -> (u32, Vec<Formula>) {
        let arity = module.arguments.len();
        let class = (module.symbol, arity);
        let constants: Option<Vec<f64>> = module.arguments.iter().map(Expression::constant).collect();
        // What may be drawn and is out of the turtle's range is left to be found when it is drawn.
        let range = Command::of(module.symbol).and_then(Command::argument_range);
        let is_drawable = |list: &Vec<f64>| match (list.first(), range) {
            (Some(first), Some([min, max])) => min <= *first && *first <= max,
            _ => true,
        };
        let constants = constants.filter(is_drawable);
        let formulas = match constants {
            Some(_) => Vec::new(),
            None => module.arguments.iter().map(|argument| self.library.add(argument, randoms)).collect(),
        };
        let bits = constants.as_ref().map(|list| list.iter().map(|number| number.to_bits()).collect());
        let kind = self.kind(class);
        let modules = &mut self.modules;
        let is_ignored = self.ignored.contains(&module.symbol);
        let id = *self.ids.entry((module.symbol, arity, bits)).or_insert_with(|| {
            modules.push(Entry {
                symbol: module.symbol,
                arity: arity as u32,
                constants: constants.unwrap_or_default(),
                kind,
                is_ignored,
            });
            modules.len() as u32 - 1
        });
        (id, formulas)
    }

    fn word(&mut self, modules: &[Module]) -> Word {
        let start = self.code.len() as u32;
        let calls_start = self.calls.len() as u32;
        let mut ordinal = 0;
        let mut randoms = 0;
        let mut values = 0;
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
            let (id, formulas) = self.identify(module, &mut randoms);
            if cut.is_none() {
                if !formulas.is_empty() {
                    let at = self.code.len() as u32 - start;
                    let instructions: usize =
                        formulas.iter().map(|&f| self.library.instructions(f).len()).sum();
                    let formulas_start = self.formulas.len() as u32;
                    values += formulas.len() as u32;
                    self.formulas.extend(formulas);
                    let end = self.formulas.len() as u32;
                    self.calls.push(Call {
                        at,
                        start: formulas_start,
                        end,
                        cost: (instructions / 16) as u32,
                    });
                }
                self.code.push(id);
                self.ordinals.push(ordinal);
            }
            ordinal += u32::from(self.classes.contains_key(&(module.symbol, module.arguments.len())));
        }
        let (end, calls_end) = (self.code.len() as u32, self.calls.len() as u32);
        Word { start, end, calls_start, calls_end, values, cuts: cut.is_some() }
    }
}

impl Program {
    /// Puts the modules into the order of [`Self::modules`].
    fn sort(&mut self, classes: &BTreeMap<(char, usize), u32>) {
        let class = |entry: &Entry| classes.get(&(entry.symbol, entry.arity as usize)).copied();
        let rank =
            |entry: &Entry| if class(entry).is_some() { 0 } else { 1 + u8::from(!entry.is_computed()) };
        let mut order: Vec<usize> = (0..self.modules.len()).collect();
        order.sort_by_key(|&i| rank(&self.modules[i]));
        let mut places = vec![0; order.len()];
        for (place, &i) in order.iter().enumerate() {
            places[i] = place as u32;
        }
        for id in &mut self.code {
            *id = places[*id as usize];
        }
        self.modules = order.iter().map(|&i| self.modules[i].clone()).collect();
        self.classes = self.modules.iter().map_while(class).collect();
        self.first_kept = self.classes.len() as u32;
        self.first_plain = self.modules.partition_point(|entry| rank(entry) < 2) as u32;
    }
}
