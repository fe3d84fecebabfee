//! The turtle in the plane, without copies.
//!
//! A module that becomes few symbols is not walked symbol by symbol: which segment starts at the end of which
//! other, and how far it is turned from the heading at the module's begin, is found once, and is the same wherever
//! the module stands.

use glam::DVec2;

use super::super::derive::Sink;
use super::super::error::LsystemError;
use super::super::program::Word;
use super::{Action, Flat};
use linden_base::memory::{bytes_grown, bytes_of};
use linden_base::monitor::Monitor;
use linden_skeleton::{Branching, Edge, NO_PARENT};

/// Where the turtle is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    /// Metres.
    pub position: DVec2,
    /// Parts of the circle.
    pub heading: u32,
    /// The node here.
    pub node: u32,
    /// How the next segment is joined to it.
    pub edge: Edge,
}

impl Pen {
    /// At the foot, looking up.
    pub const START: Self = Self { position: DVec2::ZERO, heading: 0, node: 0, edge: Edge::Succeeds };
}

/// An empty structure with room for all segments and the foot, which is there. Only what draws
/// something is flat.
///
/// # Errors
/// Too little memory for it beside `more` bytes, and a pen for each open branch.
pub(super) fn begin(flat: &Flat<'_>, more: u64, monitor: &dyn Monitor) -> Result<Branching, LsystemError> {
    let nodes = flat.segments + 1;
    let bytes = Branching::bytes_for(nodes) + bytes_of::<Edge>(nodes) + bytes_grown::<Pen>(flat.depth) + more;
    monitor.admit("drawing the L-system", bytes, "use fewer derivations")?;
    let mut branching = Branching {
        positions: Vec::with_capacity(nodes),
        parents: Vec::with_capacity(nodes),
        births: Vec::with_capacity(nodes),
        radii: None,
        edges: Some(Vec::with_capacity(nodes)),
    };
    put(&mut branching, DVec2::ZERO, NO_PARENT, Edge::Succeeds, 0);
    Ok(branching)
}

/// The foot is born with its first segment.
pub(super) fn end(mut branching: Branching) -> Branching {
    if let &[_, first, ..] = &branching.births[..] {
        branching.births[0] = first;
    }
    branching
}

/// Adds a node and gives its number.
#[inline]
pub(super) fn put(branching: &mut Branching, position: DVec2, parent: u32, edge: Edge, birth: u32) -> u32 {
    branching.positions.push(position.as_vec2().extend(0.0));
    branching.parents.push(parent);
    branching.births.push(birth);
    if let Some(edges) = &mut branching.edges {
        edges.push(edge);
    }
    branching.positions.len() as u32 - 1
}

/// The most symbols whose brackets and turns are resolved together, and the most strokes in all.
const LONGEST: u64 = 1 << 9;
const MOST_STROKES: usize = 1 << 14;

/// A segment of a [`Drawing`].
#[derive(Clone, Copy, Debug)]
struct Stroke {
    /// Where it starts: 0 is where the drawing begins, k the end of its k-th stroke.
    from: u32,
    /// Its heading, in parts of the circle from the pen's where the drawing begins.
    turn: u32,
    /// Derivation steps before the last in which it was written.
    age: u32,
    /// How it is joined to its start; `None`: as the pen says with which the drawing begins.
    edge: Option<Edge>,
}

/// What becomes of a module, its brackets and turns resolved: where each segment starts and how far it is
/// turned, wherever and at whatever heading the turtle stands.
struct Drawing {
    strokes: Vec<Stroke>,
    /// As another stroke would be drawn at the end.
    exit: Stroke,
}

impl Drawing {
    /// Of a word written in the `age`-th step before the last. `inner` are the drawings of its modules; `None`
    /// where one of them has none.
    fn of<'d>(
        flat: &Flat<'_>,
        word: Word,
        age: u32,
        inner: impl Fn(u32) -> Option<&'d Self>,
    ) -> Option<Self> {
        let mut pen = Stroke { from: 0, turn: 0, age, edge: None };
        let mut stack = Vec::new();
        let mut strokes = Vec::new();
        for &id in flat.program.word(word) {
            if age > 0 && id < flat.program.first_kept {
                let Self { strokes: added, exit } = inner(id)?;
                let before = strokes.len() as u32;
                let moved = |stroke: &Stroke| Stroke {
                    from: if stroke.from == 0 { pen.from } else { before + stroke.from },
                    turn: flat.circle.turned(pen.turn, stroke.turn),
                    age: stroke.age,
                    edge: stroke.edge.or(pen.edge),
                };
                strokes.extend(added.iter().map(moved));
                pen = Stroke { age, ..moved(exit) };
                continue;
            }
            match flat.actions[id as usize] {
                Action::Nothing => {}
                Action::Draw => {
                    strokes.push(pen);
                    pen = Stroke { from: strokes.len() as u32, edge: Some(Edge::Succeeds), ..pen };
                }
                Action::Turn(parts) => pen.turn = flat.circle.turned(pen.turn, parts),
                Action::Push => {
                    stack.push(pen);
                    pen.edge = Some(Edge::Branches);
                }
                Action::Pop => pen = stack.pop().unwrap_or(pen),
            }
        }
        Some(Self { strokes, exit: pen })
    }

    /// Of all modules that become few symbols, by derivations that are left (from 1 on) and module.
    fn all(flat: &Flat<'_>) -> Vec<Option<Self>> {
        let rewritten = flat.program.first_kept;
        let mut drawings: Vec<Option<Self>> = Vec::new();
        let mut held = 0;
        for left in 1..=flat.derivations {
            let before = drawings.len() - if left == 1 { 0 } else { rewritten as usize };
            for id in 0..rewritten {
                let known = |id: u32| drawings[before + id as usize].as_ref();
                let word = flat.successors[id as usize].filter(|_| flat.size(id, left).symbols <= LONGEST);
                let drawing = word.and_then(|word| Self::of(flat, word, left - 1, known));
                held += drawing.as_ref().map_or(0, |drawing| drawing.strokes.len());
                drawings.push(drawing);
            }
            if held > MOST_STROKES {
                break;
            }
        }
        drawings
    }
}

/// Takes a derived string and draws it, each segment for itself.
pub(in super::super) struct Walker<'a> {
    flat: Flat<'a>,
    /// By derivations that are left, from 1 on, and module.
    drawings: Vec<Option<Drawing>>,
    pen: Pen,
    stack: Vec<Pen>,
    branching: Branching,
    /// Where a drawing begins, and the ends of its strokes: room for the longest.
    places: Vec<DVec2>,
}

impl<'a> Walker<'a> {
    /// # Errors
    /// Too little memory.
    pub fn new(flat: Flat<'a>, monitor: &dyn Monitor) -> Result<Self, LsystemError> {
        let rewritten = flat.program.first_kept as usize;
        let held = bytes_grown::<Stroke>(MOST_STROKES + rewritten * LONGEST as usize);
        let branching = begin(&flat, held, monitor)?;
        let drawings = Drawing::all(&flat);
        let most = drawings.iter().flatten().map(|drawing| drawing.strokes.len()).max();
        let places = vec![DVec2::ZERO; most.unwrap_or(0) + 1];
        Ok(Self { flat, drawings, pen: Pen::START, stack: Vec::new(), branching, places })
    }

    pub fn into_branching(self) -> Branching {
        end(self.branching)
    }
}

impl Sink for Walker<'_> {
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        let Self { flat: Flat { actions, circle, .. }, stack, branching, .. } = self;
        // Apart, so that they stay in registers from module to module.
        let Pen { mut position, mut heading, mut node, mut edge } = self.pen;
        for &id in modules {
            match actions[id as usize] {
                Action::Nothing => {}
                Action::Draw => {
                    position += circle.step(heading);
                    node = put(branching, position, node, edge, birth);
                    edge = Edge::Succeeds;
                }
                Action::Turn(parts) => heading = circle.turned(heading, parts),
                Action::Push => {
                    stack.push(Pen { position, heading, node, edge });
                    edge = Edge::Branches;
                }
                Action::Pop => {
                    if let Some(pen) = stack.pop() {
                        Pen { position, heading, node, edge } = pen;
                    }
                }
            }
        }
        self.pen = Pen { position, heading, node, edge };
        Ok(())
    }

    fn take_all(&mut self, module: u32, birth: u32) -> Option<u64> {
        let Self { flat, drawings, branching, places, .. } = self;
        let last = flat.derivations;
        let left = last.checked_sub(birth + 1)? as usize;
        let drawing = drawings.get(left * flat.program.first_kept as usize + module as usize)?.as_ref()?;
        let symbols = flat.size(module, last - birth).symbols;
        let strokes = &drawing.strokes[..];
        let circle = &mut flat.circle;
        let Pen { position, heading, node, edge } = self.pen;
        let before = branching.positions.len() as u32 - 1;
        let places = &mut places[..=strokes.len()];
        places[0] = position;
        for (i, stroke) in strokes.iter().enumerate() {
            places[i + 1] = places[stroke.from as usize] + circle.step(circle.turned(heading, stroke.turn));
        }
        let node_at = |from: u32| if from == 0 { node } else { before + from };
        branching.positions.extend(places[1..].iter().map(|place| place.as_vec2().extend(0.0)));
        branching.parents.extend(strokes.iter().map(|stroke| node_at(stroke.from)));
        branching.births.extend(strokes.iter().map(|stroke| last - stroke.age));
        if let Some(edges) = &mut branching.edges {
            edges.extend(strokes.iter().map(|stroke| stroke.edge.unwrap_or(edge)));
        }
        let exit = &drawing.exit;
        self.pen.position = places[exit.from as usize];
        self.pen.heading = circle.turned(heading, exit.turn);
        self.pen.node = node_at(exit.from);
        self.pen.edge = exit.edge.unwrap_or(edge);
        Some(symbols)
    }

    fn apply(&mut self, module: u32, _arguments: &[f64], birth: u32) -> Result<(), LsystemError> {
        // No module of a flat system has arguments.
        self.take(&[module], birth)
    }
}
