//! What stands around a module in a bracketed string (ABOP, section 1.8).
//!
//! A string with brackets is an axial tree. To the left, towards the root, a module has one
//! neighbour: finished branches are passed over, and before the first module of a branch stands what
//! the branch leaves from. To the right stands what goes on along the same axis, past branches; a
//! context looks into a branch where it has brackets itself, and need not follow the branch to its
//! end. ABOP's example: `BC < S > G[H]M` finds the S of `ABC[DE][SG[HI[JK]L]MNO]`.

use rayon::join;

use super::command::Command;
use super::program::{Contexts, Entry, Group, Program, Sought};

/// Where nothing stands.
const NOTHING: u32 = u32::MAX;

/// The neighbours of every module of a string.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    /// Towards the root.
    left: Vec<u32>,
    /// Along the axis; of a `[`, the first inside of the branch.
    right: Vec<u32>,
    /// Of each `[`, its `]`; of each ignored module, the next that is not.
    close: Vec<u32>,
    /// Branches that are open, as seen from either end of the string.
    stacks: [Vec<u32>; 2],
    /// By module identifier.
    parts: Vec<Part>,
}

/// A string, as contexts look at it.
pub(super) trait Modules: Sync {
    /// The module's identifier in [`Program::modules`].
    fn id(&self, index: usize) -> u32;
    fn entry(&self, index: usize) -> &Entry;
    fn arguments(&self, index: usize) -> &[f64];
    fn count(&self) -> usize;
}

/// What a module is in the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Open,
    Close,
    Ignored,
    Seen,
}

fn part(entry: &Entry) -> Part {
    match entry.symbol {
        '[' => Part::Open,
        ']' => Part::Close,
        _ if entry.is_ignored => Part::Ignored,
        _ => Part::Seen,
    }
}

impl Neighbours {
    /// Bytes for a module of a string at most; those of open branches count as modules of their own.
    pub(super) fn bytes_a_module(program: &Program) -> u64 {
        let Contexts { left, right } = program.contexts;
        (u64::from(left) + 2 * u64::from(right)) * size_of::<u32>() as u64
    }

    /// Looks through a string whose brackets balance, as far as the rules of a program need it.
    pub(super) fn find(&mut self, program: &Program, string: &impl Modules) {
        let count = |is_asked: bool| if is_asked { string.count() } else { 0 };
        let Self { left, right, close, stacks: [from_left, from_right], parts } = self;
        parts.clear();
        parts.extend(program.modules.iter().map(part));
        // Entries that are not read may be of the step before.
        fit(left, count(program.contexts.left), NOTHING);
        fit(right, count(program.contexts.right), NOTHING);
        fit(close, count(program.contexts.right), NOTHING);
        let part = |i: usize| parts[string.id(i) as usize];
        join(|| find_left(left, part, from_left), || find_right(right, close, part, from_right));
    }

    /// Whether the contexts of a group stand around a module. Their arguments, and those of the module,
    /// are then in `parameters`, which has room for them. Neighbours that are looked at are counted in `work`.
    #[inline]
    pub(super) fn surround(
        &self,
        group: &Group,
        string: &impl Modules,
        index: usize,
        parameters: &mut [f64],
        work: &mut u64,
    ) -> bool {
        put(parameters, group.arguments_at, string.arguments(index));
        let mut at = index as u32;
        for &sought in &group.left {
            at = self.left[at as usize];
            if !is_found(sought, string, at, parameters) {
                return false;
            }
        }
        at = index as u32;
        for (i, &sought) in group.right.iter().enumerate() {
            if !matches!(sought, Sought::Module { .. }) {
                return self.follows(&group.right[i..], string, at, parameters, work);
            }
            at = self.right[at as usize];
            if !is_found(sought, string, at, parameters) {
                return false;
            }
        }
        true
    }

    /// Whether a right context follows a module.
    ///
    /// A pattern in brackets takes the first branch that holds it, the next one takes a later branch:
    /// no other choice finds more.
    #[inline(never)] // It is long, and few contexts have branches.
    fn follows(
        &self,
        sought: &[Sought],
        string: &impl Modules,
        index: u32,
        parameters: &mut [f64],
        work: &mut u64,
    ) -> bool {
        /// A branch that is being looked into.
        struct Branch {
            /// The bracket of the pattern, and of the string.
            pattern: usize,
            open: usize,
            /// Where the axis stands that it leaves from.
            axis: u32,
        }
        let mut open: Vec<Branch> = Vec::new();
        // What the next module is the right neighbour of, and from where the next branch is looked for.
        let mut axis = index;
        let mut branches = index as usize + 1;
        let mut i = 0;
        while let Some(&wanted) = sought.get(i) {
            *work += 1;
            let found = match wanted {
                Sought::Module { .. } => {
                    let at = self.right[axis as usize];
                    let found = is_found(wanted, string, at, parameters);
                    if found {
                        axis = at;
                        branches = at as usize + 1;
                    }
                    found
                }
                Sought::Open => match self.branch(string, branches) {
                    Some(bracket) => {
                        open.push(Branch { pattern: i, open: bracket, axis });
                        axis = bracket as u32;
                        branches = bracket + 1;
                        true
                    }
                    None => false,
                },
                Sought::Close => {
                    if let Some(branch) = open.pop() {
                        axis = branch.axis;
                        branches = self.close[branch.open] as usize + 1;
                    }
                    true
                }
            };
            if found {
                i += 1;
                continue;
            }
            // The innermost branch that is open was the wrong one: look for it further on.
            let Some(branch) = open.pop() else { return false };
            axis = branch.axis;
            branches = self.close[branch.open] as usize + 1;
            i = branch.pattern;
        }
        true
    }

    /// The next branch that leaves from the same place.
    fn branch(&self, string: &impl Modules, from: usize) -> Option<usize> {
        let is = |at: usize, wanted: Part| at < string.count() && part(string.entry(at)) == wanted;
        let at = if is(from, Part::Ignored) { self.close[from] as usize } else { from };
        is(at, Part::Open).then_some(at)
    }
}

/// What stands towards the root of each module.
fn find_left(left: &mut [u32], part: impl Fn(usize) -> Part, open: &mut Vec<u32>) {
    open.clear();
    let mut last = NOTHING;
    for (i, left) in left.iter_mut().enumerate() {
        *left = last;
        match part(i) {
            Part::Open => open.push(last),
            Part::Close => last = open.pop().unwrap_or(NOTHING),
            Part::Seen => last = i as u32,
            Part::Ignored => {}
        }
    }
}

/// What stands along the axis of each module, and where branches end.
fn find_right(right: &mut [u32], close: &mut [u32], part: impl Fn(usize) -> Part, open: &mut Vec<u32>) {
    open.clear();
    let (mut next, mut ahead) = (NOTHING, NOTHING);
    for (i, (right, close)) in right.iter_mut().zip(close).enumerate().rev() {
        *right = next;
        let part = part(i);
        if part == Part::Ignored {
            *close = ahead;
        } else {
            ahead = i as u32;
        }
        match part {
            // Two entries for each branch: its end, and what follows it.
            Part::Close => {
                open.extend([i as u32, next]);
                next = NOTHING;
            }
            Part::Open => {
                next = open.pop().unwrap_or(NOTHING);
                *close = open.pop().unwrap_or(NOTHING);
            }
            Part::Seen => next = i as u32,
            Part::Ignored => {}
        }
    }
}

/// Makes a list this long, in no larger a place than that takes or was there. What it held may be gone.
pub(super) fn fit<T: Clone>(list: &mut Vec<T>, count: usize, value: T) {
    if list.capacity() < count {
        *list = Vec::new();
        list.reserve_exact(count);
    }
    list.resize(count, value);
}

#[expect(
    clippy::inline_always,
    reason = "asked for each neighbour of each module: a call takes as long again"
)]
#[inline(always)]
fn is_found(sought: Sought, string: &impl Modules, at: u32, parameters: &mut [f64]) -> bool {
    let Sought::Module { kind, first } = sought else { return false };
    if at == NOTHING {
        return false;
    }
    let is_found = string.entry(at as usize).kind == kind;
    if is_found {
        put(parameters, first as usize, string.arguments(at as usize));
    }
    is_found
}

/// Puts a module's arguments among the parameters. Most have one or two: a call that copies takes longer than these.
#[inline]
fn put(parameters: &mut [f64], first: usize, arguments: &[f64]) {
    match *arguments {
        [] => {}
        [only] => parameters[first] = only,
        [one, other] => [parameters[first], parameters[first + 1]] = [one, other],
        _ => parameters[first..first + arguments.len()].copy_from_slice(arguments),
    }
}

/// How many modules of a string a cut at `index` takes: up to the end of the branch.
pub(super) fn rest_of_branch(string: &impl Modules, index: usize) -> usize {
    let mut depth = 0_usize;
    for i in index..string.count() {
        match Command::of(string.entry(i).symbol) {
            Some(Command::Push) => depth += 1,
            Some(Command::Pop) if depth == 0 => return i - index,
            Some(Command::Pop) => depth -= 1,
            _ => {}
        }
    }
    string.count() - index
}
