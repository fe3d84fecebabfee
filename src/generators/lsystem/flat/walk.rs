//! The turtle in the plane, module by module.

use glam::DVec2;

use super::super::derive::Sink;
use super::super::error::LsystemError;
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
pub(super) fn put(branching: &mut Branching, position: DVec2, parent: u32, edge: Edge, birth: u32) -> u32 {
    branching.positions.push(position.as_vec2().extend(0.0));
    branching.parents.push(parent);
    branching.births.push(birth);
    if let Some(edges) = &mut branching.edges {
        edges.push(edge);
    }
    branching.positions.len() as u32 - 1
}

/// Takes a derived string and draws it: the plain way.
pub(in super::super) struct Walker<'a> {
    flat: Flat<'a>,
    pen: Pen,
    stack: Vec<Pen>,
    branching: Branching,
}

impl<'a> Walker<'a> {
    /// # Errors
    /// Too little memory.
    pub fn new(flat: Flat<'a>, monitor: &dyn Monitor) -> Result<Self, LsystemError> {
        let branching = begin(&flat, 0, monitor)?;
        Ok(Self { flat, pen: Pen::START, stack: Vec::new(), branching })
    }

    pub fn into_branching(self) -> Branching {
        end(self.branching)
    }
}

impl Sink for Walker<'_> {
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        for &id in modules {
            match self.flat.actions[id as usize] {
                Action::Nothing => {}
                Action::Draw => {
                    self.pen.position += self.flat.circle.step(self.pen.heading);
                    let Pen { position, node, edge, .. } = self.pen;
                    self.pen.node = put(&mut self.branching, position, node, edge, birth);
                    self.pen.edge = Edge::Succeeds;
                }
                Action::Turn(parts) => {
                    self.pen.heading = self.flat.circle.turned(self.pen.heading, parts);
                }
                Action::Push => {
                    self.stack.push(self.pen);
                    self.pen.edge = Edge::Branches;
                }
                Action::Pop => self.pen = self.stack.pop().unwrap_or(self.pen),
            }
        }
        Ok(())
    }

    fn apply(&mut self, module: u32, _arguments: &[f64], birth: u32) -> Result<(), LsystemError> {
        // No module of a flat system has arguments.
        self.take(&[module], birth)
    }
}
