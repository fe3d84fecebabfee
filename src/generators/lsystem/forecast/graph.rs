//! What can come up in a derivation, and what it becomes.

use std::collections::BTreeMap;
use std::ops::Range;

use super::lasting;
use crate::command::Command;
use crate::expression::code::Inputs;
use crate::program::{Group, Program, Word};
use linden_base::random::Key;

/// Modules of successors that are looked at while arguments are followed.
const MOST_WORK: usize = 3000;

/// A part of a span.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Item {
    /// An index into [`Graph::nodes`].
    Node(u32),
    /// Kept; whether it draws.
    Kept(bool),
    Open,
    Close,
}

/// Modules of which no rule tells one from the other, now or later.
pub(super) struct Node {
    pub draws: bool,
    /// Whether something is left of it for certain, however often it is rewritten.
    pub lasts: bool,
    pub fate: Fate,
}

pub(super) enum Fate {
    /// Rewritten in every step: the probability up to and including each alternative.
    Rewritten(Vec<(f64, Span)>),
    Kept,
    /// Nobody has looked.
    Unknown,
}

/// A word.
#[derive(Clone)]
pub(super) struct Span {
    items: Range<usize>,
    pub cuts: bool,
}

pub(super) struct Graph {
    pub nodes: Vec<Node>,
    items: Vec<Item>,
    pub axiom: Span,
    pub stochastic: bool,
    /// Whether something may cut what follows it.
    pub cuts: bool,
    /// Whether some node that a derivation rewrites is unknown.
    pub is_partial: bool,
}

impl Graph {
    /// What can come up within `derivations`.
    pub(super) fn of(program: &Program, derivations: u32) -> Self {
        let mut search = Search {
            program,
            is_blind: blind(program),
            lasting: lasting(program),
            known: BTreeMap::new(),
            front: Vec::new(),
            graph: Self {
                nodes: Vec::new(),
                items: Vec::new(),
                axiom: Span { items: 0..0, cuts: false },
                stochastic: false,
                cuts: program.cuts,
                is_partial: false,
            },
            work: 0,
        };
        search.graph.axiom = search.span(program.axiom, &[]);
        for _ in 0..derivations {
            let front = std::mem::take(&mut search.front);
            if front.is_empty() {
                break;
            }
            for state in front {
                search.expand(&state);
            }
        }
        search.graph
    }

    pub(super) fn span(&self, span: &Span) -> &[Item] {
        &self.items[span.items.clone()]
    }

    /// Items that one step looks at.
    pub(super) fn len(&self) -> usize {
        self.items.len() + self.nodes.len()
    }
}

/// By rewrite: whether neither conditions nor chance look at its arguments, or at those of anything
/// that comes of it.
fn blind(program: &Program) -> Vec<bool> {
    let first = |class: usize| program.groups(&program.rewrites[class]).first();
    let count = program.rewrites.len();
    let mut blind: Vec<bool> = (0..count).map(|class| first(class).is_some_and(Group::is_certain)).collect();
    loop {
        let mut changed = false;
        for class in 0..count {
            let sees = |id: &u32| program.class(*id).is_some_and(|class| !blind[class]);
            let words = || first(class).into_iter().flat_map(|group| program.alternatives(group));
            if blind[class] && words().any(|choice| program.word(choice.word).iter().any(sees)) {
                blind[class] = false;
                changed = true;
            }
        }
        if !changed {
            return blind;
        }
    }
}

/// A module that was met and not yet expanded.
struct State {
    node: usize,
    class: usize,
    arguments: Vec<f64>,
    /// Whether the arguments are known.
    is_known: bool,
}

struct Search<'a> {
    program: &'a Program,
    is_blind: Vec<bool>,
    lasting: Vec<bool>,
    /// By rewrite and the bits of the arguments; without arguments where no rule looks at them.
    known: BTreeMap<(usize, Vec<u64>), u32>,
    front: Vec<State>,
    graph: Graph,
    work: usize,
}

impl Search<'_> {
    /// The items of a word whose formulas look at `parameters`.
    fn span(&mut self, word: Word, parameters: &[f64]) -> Span {
        let program = self.program;
        let mut calls = program.calls(word).iter().peekable();
        let mut items = Vec::with_capacity(word.len());
        for (i, &id) in program.word(word).iter().enumerate() {
            let call = calls.next_if(|call| call.at as usize == i);
            let entry = &program.modules[id as usize];
            let command = Command::of(entry.symbol).unwrap_or(Command::Silent);
            let Some(class) = program.class(id) else {
                items.push(match command {
                    Command::Push => Item::Open,
                    Command::Pop => Item::Close,
                    _ => Item::Kept(command.draws()),
                });
                continue;
            };
            let mut arguments = Vec::new();
            let mut is_known = true;
            if !self.is_blind[class] {
                match call {
                    None => arguments.extend_from_slice(&entry.constants),
                    Some(&call) => {
                        let inputs = Inputs { parameters, key: Key::new(0) };
                        let formulas = program.formulas(call);
                        is_known = !formulas.iter().any(|&formula| program.library.is_random(formula));
                        arguments.extend(
                            formulas.iter().map(|&formula| program.library.evaluate(formula, inputs)),
                        );
                        is_known &= arguments.iter().all(|argument| argument.is_finite());
                    }
                }
            }
            items.push(Item::Node(self.node(State { node: 0, class, arguments, is_known }, command.draws())));
        }
        let start = self.graph.items.len();
        self.work += items.len();
        self.graph.items.extend(items);
        Span { items: start..self.graph.items.len(), cuts: word.cuts }
    }

    /// The node of a state.
    fn node(&mut self, state: State, draws: bool) -> u32 {
        let next = self.graph.nodes.len();
        if state.is_known {
            let bits = state.arguments.iter().map(|argument| argument.to_bits()).collect();
            let node = *self.known.entry((state.class, bits)).or_insert(next as u32);
            if (node as usize) < next {
                return node;
            }
        }
        self.graph.nodes.push(Node { draws, lasts: self.lasting[state.class], fate: Fate::Unknown });
        self.front.push(State { node: next, ..state });
        next as u32
    }

    fn expand(&mut self, state: &State) {
        let program = self.program;
        let groups = program.groups(&program.rewrites[state.class]);
        // Without a look at arguments it costs no more than the text of the rules.
        let is_affordable = self.is_blind[state.class] || self.work < MOST_WORK;
        if !state.is_known || !is_affordable || groups.iter().any(|group| group.is_random) {
            self.graph.is_partial = true;
            return;
        }
        self.work += groups.len();
        let place = Key::new(0);
        let mut taking = None;
        for group in groups {
            match program.holds(group, &state.arguments, place, 0) {
                Some(true) => {
                    taking = Some(group);
                    break;
                }
                Some(false) => {}
                // Growing says so.
                None => {
                    self.graph.is_partial = true;
                    return;
                }
            }
        }
        let fate = match taking {
            None => Fate::Kept,
            Some(group) => {
                let alternatives = program.alternatives(group);
                self.graph.stochastic |= alternatives.len() > 1;
                // Formulas whose values are not needed may look at parameters that are not there.
                let missing = vec![f64::NAN; group.parameters];
                let parameters = if state.arguments.is_empty() { &missing } else { &state.arguments };
                let spans =
                    alternatives.iter().map(|choice| (choice.up_to, self.span(choice.word, parameters)));
                Fate::Rewritten(spans.collect())
            }
        };
        self.graph.nodes[state.node].fate = fate;
    }
}
