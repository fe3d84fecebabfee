//! Counting by the growth matrix, step by step or by squaring.

use super::Forecast;
use super::graph::{Fate, Graph, Item, Span};

/// Items that may be tallied in each of the two attempts of a forecast: about a third of a millisecond.
const MOST_WORK: usize = 30_000;
/// Products of two counts that squaring may take: about as long.
const MOST_PRODUCTS: usize = 200_000;

/// A count: exact and saturating, or an expectation.
pub(super) trait Count: Copy + PartialEq {
    const ZERO: Self;
    const ONE: Self;
    /// Where counting stops.
    const MOST: Self;
    /// Whether counts are exact where nothing is unknown.
    const EXACT: bool;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// Counted with a probability. Where counts are exact, probabilities are 0 or 1.
    fn weighed(self, probability: f64) -> Self;
    fn whole(self) -> u128;
}

impl Count for u128 {
    const ZERO: Self = 0;
    const ONE: Self = 1;
    const MOST: Self = Self::MAX;
    const EXACT: bool = true;

    fn plus(self, other: Self) -> Self {
        self.saturating_add(other)
    }

    fn times(self, other: Self) -> Self {
        self.saturating_mul(other)
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
    const EXACT: bool = false;

    fn plus(self, other: Self) -> Self {
        // Stays finite, so that nothing times an overflow is nothing.
        (self + other).min(Self::MAX)
    }

    fn times(self, other: Self) -> Self {
        (self * other).min(Self::MAX)
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

    fn one(draws: bool) -> Self {
        Self { symbols: C::ONE, segments: if draws { C::ONE } else { C::ZERO }, ..Self::NOTHING }
    }

    /// What is certain of something unknown.
    fn unknown(lasts: bool, graph: &Graph) -> Self {
        Self {
            symbols: if lasts { C::ONE } else { C::ZERO },
            cuts: if graph.cuts { 1.0 } else { 0.0 },
            ..Self::NOTHING
        }
    }

    /// Whether nothing changes any more. The depth under a count beyond counting does not matter.
    fn settled_since(&self, before: &Self) -> bool {
        let depth_settled = self.depth == before.depth || self.symbols == C::MOST;
        depth_settled && Self { depth: before.depth, ..*self } == *before
    }
}

/// The tallies of all nodes after some number of derivations.
pub(super) struct Growth<'a, C> {
    graph: &'a Graph,
    tallies: Vec<Tally<C>>,
    next: Vec<Tally<C>>,
    /// For each open bracket of the span that is being tallied: the probability that the branch was
    /// not cut before it.
    open: Vec<f64>,
}

impl<'a, C: Count> Growth<'a, C> {
    /// No derivations: each module is itself.
    fn new(graph: &'a Graph) -> Self {
        Self::starting(graph, |node| Tally::one(graph.nodes[node].draws))
    }

    fn starting(graph: &'a Graph, tally: impl Fn(usize) -> Tally<C>) -> Self {
        let tallies: Vec<_> = (0..graph.nodes.len()).map(tally).collect();
        Self { graph, next: tallies.clone(), tallies, open: Vec::new() }
    }

    /// What the axiom gives.
    pub(super) fn forecast(graph: &'a Graph, derivations: u32) -> Forecast {
        let (tally, is_whole) = Self::after(graph, derivations);
        let at_least = graph.is_partial || !is_whole;
        Forecast {
            symbols: tally.symbols.whole(),
            segments: tally.segments.whole(),
            depth: tally.depth,
            exact: C::EXACT && !at_least,
            at_least,
        }
    }

    /// The axiom's tally after some derivations, or what is certain of it.
    fn after(graph: &'a Graph, derivations: u32) -> (Tally<C>, bool) {
        let steps = (MOST_WORK / graph.len().max(1)).max(1) as u32;
        if derivations > steps {
            return Self::after_many(graph, derivations, steps);
        }
        let mut growth = Self::new(graph);
        for _ in 0..derivations {
            if !growth.derive() {
                break;
            }
        }
        (growth.axiom(), true)
    }

    /// The same for more derivations than can be counted one by one; `affordable` can.
    fn after_many(graph: &'a Graph, derivations: u32, affordable: u32) -> (Tally<C>, bool) {
        let size = graph.nodes.len() + 2;
        let squarings = 32 - derivations.leading_zeros() as usize;
        let is_squarable = size.saturating_pow(3).saturating_mul(squarings) <= MOST_PRODUCTS;
        if is_squarable {
            // Until the same is cut in every step, the steps differ.
            let mut growth = Self::new(graph);
            for step in 1..=affordable {
                let before: Vec<f64> = growth.tallies.iter().map(|tally| tally.cuts).collect();
                if !growth.derive() {
                    return (growth.axiom(), true);
                }
                let is_settled = growth.tallies.iter().zip(&before).all(|(tally, cuts)| tally.cuts == *cuts);
                // Probabilities of cuts may creep on for ever; what they change by then is rounded away.
                if is_settled || (!C::EXACT && step == affordable) {
                    return (growth.power(derivations - step), true);
                }
            }
        }
        if let Some(tally) = Self::layered(graph, derivations) {
            return (tally, true);
        }
        let lasts = |node: usize| match graph.nodes[node].fate {
            Fate::Kept => Tally::one(graph.nodes[node].draws),
            _ => Tally::unknown(graph.nodes[node].lasts, graph),
        };
        let mut growth = Self::starting(graph, lasts);
        for _ in 0..affordable {
            growth.derive();
        }
        (growth.axiom(), false)
    }

    /// Tallies of those nodes alone that can stand in the string after each step; `None` when these
    /// are too many.
    fn layered(graph: &'a Graph, derivations: u32) -> Option<Tally<C>> {
        let mut work = 0;
        let mut seen = vec![u32::MAX; graph.nodes.len()];
        let mut layers: Vec<Vec<u32>> = Vec::new();
        let mut front = Vec::new();
        let mut meet = |span: &Span, layer: u32, front: &mut Vec<u32>, work: &mut usize| {
            for item in graph.span(span) {
                *work += 1;
                if let Item::Node(node) = *item
                    && seen[node as usize] != layer
                {
                    seen[node as usize] = layer;
                    front.push(node);
                }
            }
        };
        meet(&graph.axiom, 0, &mut front, &mut work);
        for layer in 1..=derivations {
            let mut next = Vec::new();
            for &node in &front {
                if let Fate::Rewritten(alternatives) = &graph.nodes[node as usize].fate {
                    for (_, span) in alternatives {
                        meet(span, layer, &mut next, &mut work);
                    }
                }
            }
            work += 4;
            if work > MOST_WORK {
                return None;
            }
            layers.push(std::mem::replace(&mut front, next));
        }
        let mut growth = Self::new(graph);
        for layer in layers.iter().rev() {
            for &node in layer {
                growth.next[node as usize] = growth.tally_of_node(node as usize);
            }
            for &node in layer {
                growth.tallies[node as usize] = growth.next[node as usize];
            }
        }
        Some(growth.axiom())
    }

    pub(super) fn most_within(graph: &'a Graph, derivations: u32, limit: u64) -> Option<u32> {
        let mut growth = Self::new(graph);
        let affordable = (16 * MOST_WORK / graph.len().max(1)).max(1) as u32;
        let mut fits = None;
        for step in 0..derivations.min(affordable) {
            if growth.axiom().symbols.whole() > u128::from(limit) {
                break;
            }
            fits = Some(step);
            growth.derive();
        }
        fits
    }

    fn axiom(&mut self) -> Tally<C> {
        let graph = self.graph;
        self.tally(&graph.axiom)
    }

    /// One derivation more. `false` when it changed nothing that counts, and so never will.
    fn derive(&mut self) -> bool {
        for i in 0..self.next.len() {
            self.next[i] = self.tally_of_node(i);
        }
        let changed = self.tallies.iter().zip(&self.next).any(|(old, new)| !new.settled_since(old));
        self.tallies.copy_from_slice(&self.next);
        changed
    }

    fn tally_of_node(&mut self, index: usize) -> Tally<C> {
        let graph = self.graph;
        let node = &graph.nodes[index];
        let alternatives = match &node.fate {
            Fate::Kept => return Tally::one(node.draws),
            Fate::Unknown => return Tally::unknown(node.lasts, graph),
            Fate::Rewritten(alternatives) => alternatives,
        };
        if let [(_, span)] = &alternatives[..] {
            return self.tally(span);
        }
        let mut sum = Tally::<C>::NOTHING;
        let mut before = 0.0;
        for (up_to, span) in alternatives {
            let tally = self.tally(span);
            let probability = up_to - before;
            before = *up_to;
            sum.symbols = sum.symbols.plus(tally.symbols.weighed(probability));
            sum.segments = sum.segments.plus(tally.segments.weighed(probability));
            sum.depth = sum.depth.max(tally.depth);
            sum.cuts += tally.cuts * probability;
        }
        sum
    }

    /// What a span gives. Its modules are rewritten independently of each other, so the probability
    /// that nothing before a module has cut its branch is a product.
    fn tally(&mut self, span: &Span) -> Tally<C> {
        let graph = self.graph;
        let mut sum = Tally::<C>::NOTHING;
        let mut uncut = 1.0;
        self.open.clear();
        for &item in graph.span(span) {
            let tally = match item {
                Item::Node(node) => self.tallies[node as usize],
                Item::Kept(draws) => Tally::one(draws),
                Item::Open => {
                    self.open.push(uncut);
                    Tally::one(false)
                }
                Item::Close => {
                    uncut = self.open.pop().unwrap_or(uncut);
                    Tally::one(false)
                }
            };
            if uncut > 0.0 && item != Item::Close {
                sum.depth = sum.depth.max(tally.depth.saturating_add(self.open.len() as u64));
            }
            sum.symbols = sum.symbols.plus(tally.symbols.weighed(uncut));
            sum.segments = sum.segments.plus(tally.segments.weighed(uncut));
            uncut *= 1.0 - tally.cuts;
        }
        sum.cuts = if span.cuts { 1.0 } else { 1.0 - uncut };
        sum
    }

    /// The axiom's tally after `steps` more derivations that all cut the same: by the power of the
    /// growth matrix, and of the matrix of depths in which sums are maxima and products are sums.
    fn power(mut self, mut steps: u32) -> Tally<C> {
        let size = self.graph.nodes.len() + 2;
        let mut row = self.row(&[(1.0, self.graph.axiom.clone())]);
        let mut matrix: Vec<Vec<Entry<C>>> = Vec::with_capacity(size);
        for i in 0..size {
            matrix.push(match self.graph.nodes.get(i).map(|node| &node.fate) {
                Some(Fate::Rewritten(alternatives)) => self.row(alternatives),
                _ => {
                    let mut row = vec![Entry::NOTHING; size];
                    row[i] = Entry { count: C::ONE, depth: Some(0) };
                    row
                }
            });
        }
        while steps > 0 {
            if steps % 2 == 1 {
                row = product(&row, &matrix);
            }
            steps /= 2;
            if steps > 0 {
                matrix = matrix.iter().map(|row| product(row, &matrix)).collect();
            }
        }
        let kept = [Tally::one(false), Tally::one(true)];
        let mut sum = Tally::<C>::NOTHING;
        for (entry, tally) in row.iter().zip(self.tallies.iter().chain(&kept)) {
            sum.symbols = sum.symbols.plus(entry.count.times(tally.symbols));
            sum.segments = sum.segments.plus(entry.count.times(tally.segments));
            sum.depth = sum.depth.max(entry.depth.map_or(0, |depth| depth + tally.depth));
        }
        sum
    }

    /// What a node becomes in one step, by node, then what is kept and does not draw, then what does.
    fn row(&mut self, alternatives: &[(f64, Span)]) -> Vec<Entry<C>> {
        let graph = self.graph;
        let nodes = graph.nodes.len();
        let mut row = vec![Entry::<C>::NOTHING; nodes + 2];
        let mut before = 0.0;
        for (up_to, span) in alternatives {
            let probability = up_to - before;
            before = *up_to;
            let probability = if alternatives.len() == 1 { 1.0 } else { probability };
            let mut uncut = 1.0;
            self.open.clear();
            for &item in graph.span(span) {
                let (place, cuts) = match item {
                    Item::Node(node) => (node as usize, self.tallies[node as usize].cuts),
                    Item::Kept(draws) => (nodes + usize::from(draws), 0.0),
                    Item::Open => {
                        self.open.push(uncut);
                        (nodes, 0.0)
                    }
                    Item::Close => {
                        uncut = self.open.pop().unwrap_or(uncut);
                        (nodes, 0.0)
                    }
                };
                let entry = &mut row[place];
                entry.count = entry.count.plus(C::ONE.weighed(uncut).weighed(probability));
                if uncut > 0.0 {
                    entry.depth = entry.depth.max(Some(self.open.len() as u64));
                }
                uncut *= 1.0 - cuts;
            }
        }
        row
    }
}

/// How often a module comes of another, and how deep at most.
#[derive(Clone, Copy)]
struct Entry<C> {
    count: C,
    depth: Option<u64>,
}

impl<C: Count> Entry<C> {
    const NOTHING: Self = Self { count: C::ZERO, depth: None };
}

fn product<C: Count>(row: &[Entry<C>], matrix: &[Vec<Entry<C>>]) -> Vec<Entry<C>> {
    let mut product = vec![Entry::<C>::NOTHING; row.len()];
    for (factor, other) in row.iter().zip(matrix) {
        let Some(depth) = factor.depth else { continue };
        for (sum, entry) in product.iter_mut().zip(other) {
            let Some(further) = entry.depth else { continue };
            sum.count = sum.count.plus(factor.count.times(entry.count));
            sum.depth = sum.depth.max(Some(depth + further));
        }
    }
    product
}
