//! From a grammar to a program.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::{Alternative, Call, Contexts, Entry, Group, Program, Rewrite, Sought, Word};
use crate::command::Command;
use crate::expression::code::{Formula, Library};
use crate::grammar::{Expression, Grammar, Module, Pattern, Production, groups};

impl Program {
    pub(crate) fn compile(grammar: &Grammar) -> Self {
        Compiler::new(grammar).compile(grammar)
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
    /// With their places in the grammar.
    grouped: Vec<Vec<(u32, &'a Production)>>,
}

impl<'a> Compiler<'a> {
    fn new(grammar: &'a Grammar) -> Self {
        let productions = grammar.productions();
        let grouped: Vec<Vec<(u32, &Production)>> = groups(productions)
            .into_iter()
            .map(|group| group.into_iter().map(|i| (i as u32, &productions[i])).collect())
            .collect();
        let mut classes = BTreeMap::new();
        for group in &grouped {
            let next = classes.len() as u32;
            classes.entry(group[0].1.predecessor.class()).or_insert(next);
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
            let (_, first) = group[0];
            (self.classes[&first.predecessor.class()], first.left.is_empty() && first.right.is_empty())
        });
        let mut rewrites: Vec<Rewrite> = Vec::new();
        let mut groups = Vec::new();
        let mut alternatives: Vec<Alternative> = Vec::new();
        for productions in &grouped {
            let class = self.classes[&productions[0].1.predecessor.class()] as usize;
            let start = alternatives.len() as u32;
            let mut up_to = 0.0;
            for &(place, production) in productions.iter().filter(|(_, rule)| rule.probability > 0.0) {
                let word = self.word(&production.successor);
                up_to += production.probability;
                alternatives.push(Alternative { up_to, word, group: groups.len() as u32, production: place });
            }
            let index = groups.len() as u32;
            if rewrites.len() == class {
                rewrites.push(Rewrite { groups: index..index, vanishes_in: u32::MAX });
            }
            rewrites[class].groups.end = index + 1;
            let group = self.group(productions[0].1, start..alternatives.len() as u32);
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
            certain: Vec::new(),
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
        program.find_certain();
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
        let arguments_at = count(&first.left);
        let after = arguments_at + first.predecessor.parameters.len();
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
            arguments_at,
            parameters,
            is_random,
            condition,
            cost: (instructions / 16 + left.len() + right.len()) as u32,
            left,
            right,
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
