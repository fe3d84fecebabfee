//! How much a derivation would give, without deriving.
//!
//! Three ways, none of which takes longer than about a millisecond, by counting its work:
//!
//! - rules that look at no arguments: by the growth matrix over symbols (ABOP, section 1.2);
//! - rules with conditions: by the growth matrix over the modules with their arguments that can come
//!   up, as far as these can be found;
//! - rules with contexts: by deriving, as far as that goes; where chance has a say, one tree.
//!
//! Where the work allowed is not enough, what is certain already is a lower bound.

mod graph;
mod growth;

use super::command::Command;
use super::derive::{Trial, count};
use super::error::LsystemError;
use super::grammar::Grammar;
use super::program::{Group, Program};
use super::turtle_settings::check_derivations;
use graph::Graph;
use growth::Growth;
use linden_skeleton::Skeleton;

/// How much a derivation gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forecast {
    /// The length of the string: symbols with their brackets, arguments not counted. Saturates at
    /// `u128::MAX`.
    pub symbols: u128,
    /// Segments drawn: `F` and `G`. Saturates at `u128::MAX`.
    pub segments: u128,
    /// Most branches open at once; for a stochastic system, the most that is possible.
    pub depth: u64,
    /// Whether the counts are exact. Those of a stochastic system are expectations, rounded; the
    /// standard deviation of one tree is often a third of them. Where it looks at contexts, they are
    /// those of one tree, of seed 0.
    pub exact: bool,
    /// Whether there may be more: counting to the end would have taken too long. Then neither the
    /// counts nor the depth are exact.
    pub at_least: bool,
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
/// Takes time in proportion to the text of the grammar and a millisecond at most beyond that, however
/// many derivations there are, and no memory that depends on the result.
///
/// ```
/// use linden_lsystem::{Grammar, forecast};
/// let rules = ["A(t) : t < 3 -> F[+A(t+1)]A(t+1)", "A(t) : t >= 3 -> F"];
/// let counted = forecast(&Grammar::new("A(0)", &rules)?, 100)?;
/// assert_eq!((counted.segments, counted.exact), (15, true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LsystemError::Setting`] when `derivations` is above [`MAX_DERIVATIONS`](super::MAX_DERIVATIONS).
pub fn forecast(grammar: &Grammar, derivations: u32) -> Result<Forecast, LsystemError> {
    check_derivations(derivations)?;
    let program = Program::compile(grammar);
    Ok(of_program(&program, derivations))
}

pub(super) fn of_program(program: &Program, derivations: u32) -> Forecast {
    if program.has_contexts() {
        return of_trial(program, derivations);
    }
    let graph = Graph::of(program, derivations);
    if graph.stochastic {
        Growth::<f64>::forecast(&graph, derivations)
    } else {
        Growth::<u128>::forecast(&graph, derivations)
    }
}

/// The most derivations below `derivations` of which it is known that no forecast up to there passes
/// `limit`.
pub(super) fn most_within(program: &Program, derivations: u32, limit: u64) -> Option<u32> {
    if program.has_contexts() {
        return None;
    }
    let graph = Graph::of(program, derivations);
    if graph.stochastic {
        Growth::<f64>::most_within(&graph, derivations, limit)
    } else {
        Growth::<u128>::most_within(&graph, derivations, limit)
    }
}

/// What a derivation gave that went as far as its work was allowed to.
fn of_trial(program: &Program, derivations: u32) -> Forecast {
    let Trial { modules, is_complete } = count(program, derivations);
    let lasting = lasting(program);
    let (mut symbols, mut segments, mut depth, mut open) = (0, 0, 0, 0_u64);
    // A module that is rewritten further on may cut what follows it.
    let mut sure_to = modules.len();
    if !is_complete && program.cuts {
        sure_to = modules.iter().position(|&id| id < program.first_kept).unwrap_or(modules.len());
    }
    for &id in &modules[..sure_to] {
        let command = Command::of(program.modules[id as usize].symbol).unwrap_or(Command::Silent);
        match command {
            Command::Push => open += 1,
            Command::Pop => open -= 1,
            _ => {}
        }
        depth = open.max(depth);
        let is_kept = is_complete || id >= program.first_kept;
        symbols += u128::from(is_kept || program.class(id).is_some_and(|class| lasting[class]));
        segments += u128::from(is_kept && command.draws());
    }
    Forecast { symbols, segments, depth, exact: is_complete && !program.random, at_least: !is_complete }
}

/// For each rewrite whether something of it is left for certain, however often it is rewritten.
fn lasting(program: &Program) -> Vec<bool> {
    let mut lasting = vec![!program.cuts; program.rewrites.len()];
    // Settles what may vanish in one step, then what may in one more; each pass settles one at least.
    loop {
        let mut changed = false;
        for (class, rewrite) in program.rewrites.iter().enumerate() {
            let words =
                || program.groups(rewrite).iter().flat_map(|group: &Group| program.alternatives(group));
            let lasts = |id: &u32| program.class(*id).is_none_or(|class| lasting[class]);
            if lasting[class] && !words().all(|choice| program.word(choice.word).iter().any(lasts)) {
                lasting[class] = false;
                changed = true;
            }
        }
        if !changed {
            return lasting;
        }
    }
}
