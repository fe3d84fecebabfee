//! Subtrees that are interpreted once and placed wherever they come up again.
//!
//! The tree of rewritings is walked from the axiom down to modules of which only a few hundred symbols
//! become. Such a module, with the derivations that it has left and the heading it begins with, always
//! draws the same nodes relative to where it begins: a block. The first time it is walked, then and
//! later its block is placed. Blocks are small enough to stay in the cache and to be worth their
//! making after two or three placements; where there are too many of them for that, as in a spiral
//! that never comes back to a heading, the rest is walked.

use std::collections::BTreeMap;

use glam::DVec2;

use super::super::error::LsystemError;
use super::super::program::Word;
use super::walk::{Pen, begin, end, put};
use super::{Action, Flat};
use linden_base::memory::{bytes_grown, bytes_of};
use linden_base::monitor::{Monitor, Phase};
use linden_skeleton::{Branching, Edge};

/// The most symbols of a block.
const BLOCK: u64 = 512;
/// The most nodes of all blocks together, two megabytes; and the most blocks.
const MOST_NODES: usize = 1 << 16;
const MOST_BLOCKS: usize = 1 << 12;
/// Work between two looks at the monitor, in modules: about a millisecond.
const PATIENCE: usize = 1 << 16;
/// Nodes that are placed while one module is walked, about.
const PLACED: usize = 8;
/// The node at which a block begins, as seen from within.
const ENTRY: u32 = u32::MAX;

/// What a module draws, relative to where it begins.
struct Block {
    positions: Vec<DVec2>,
    /// Numbered from the block's first node; of `roots`, anything.
    parents: Vec<u32>,
    births: Vec<u32>,
    /// Of a root that is not in brackets of the block, that of the pen.
    edges: Vec<Edge>,
    /// The nodes that grow from where the block begins.
    roots: Vec<u32>,
    /// Where the turtle is at its end.
    exit: Pen,
}

/// A word whose modules are being looked at.
struct Open {
    word: Word,
    next: usize,
    birth: u32,
}

/// What the turtle draws on.
trait Paper {
    fn draw(&mut self, position: DVec2, parent: u32, edge: Edge, birth: u32) -> u32;

    /// Draws what becomes of a module written in a step, if that is known. Gives how much work it was.
    fn place(&mut self, flat: &mut Flat<'_>, id: u32, birth: u32, pen: &mut Pen) -> Option<usize>;
}

impl Paper for Block {
    fn draw(&mut self, position: DVec2, parent: u32, edge: Edge, birth: u32) -> u32 {
        let node = self.positions.len() as u32;
        if parent == ENTRY {
            self.roots.push(node);
        }
        self.positions.push(position);
        self.parents.push(parent);
        self.births.push(birth);
        self.edges.push(edge);
        node
    }

    fn place(&mut self, _: &mut Flat<'_>, _: u32, _: u32, _: &mut Pen) -> Option<usize> {
        None
    }
}

/// The whole tree, and the blocks it is made of.
struct Tree {
    branching: Branching,
    blocks: Vec<Block>,
    /// By module, birth and heading.
    known: BTreeMap<[u32; 3], usize>,
    /// Nodes of all blocks.
    held: usize,
}

impl Paper for Tree {
    fn draw(&mut self, position: DVec2, parent: u32, edge: Edge, birth: u32) -> u32 {
        put(&mut self.branching, position, parent, edge, birth)
    }

    fn place(&mut self, flat: &mut Flat<'_>, id: u32, birth: u32, pen: &mut Pen) -> Option<usize> {
        if flat.size(id, flat.derivations - birth).symbols > BLOCK {
            return None;
        }
        let key = [id, birth, pen.heading];
        let (index, made) = match self.known.get(&key) {
            Some(&index) => (index, 0),
            None if self.held > MOST_NODES || self.blocks.len() >= MOST_BLOCKS => return None,
            None => {
                let block = Block::of(flat, id, birth, pen.heading);
                self.held += block.positions.len();
                self.known.insert(key, self.blocks.len());
                self.blocks.push(block);
                (self.blocks.len() - 1, BLOCK as usize)
            }
        };
        let block = &self.blocks[index];
        block.place(&mut self.branching, pen);
        Some(made + block.positions.len() / PLACED)
    }
}

impl Block {
    /// Walks what becomes of a module.
    fn of(flat: &mut Flat<'_>, id: u32, birth: u32, heading: u32) -> Self {
        let exit = Pen { position: DVec2::ZERO, heading, node: ENTRY, edge: Edge::Succeeds };
        let mut block = Self {
            positions: Vec::new(),
            parents: Vec::new(),
            births: Vec::new(),
            edges: Vec::new(),
            roots: Vec::new(),
            exit,
        };
        if let Some(word) = flat.successors[id as usize] {
            let mut walk = Walk::new(word, birth + 1, exit);
            while walk.go(flat, &mut block) {}
            block.exit = walk.pen;
        }
        block
    }

    /// Adds its nodes, and moves the pen to its end. Adding the same number to every parent and then
    /// naming the few others leaves nothing to decide within the loops.
    fn place(&self, branching: &mut Branching, pen: &mut Pen) {
        let base = branching.positions.len();
        let start = pen.position;
        branching.positions.extend(self.positions.iter().map(|&place| (start + place).as_vec2().extend(0.0)));
        branching.parents.extend(self.parents.iter().map(|parent| parent.wrapping_add(base as u32)));
        for &root in &self.roots {
            branching.parents[base + root as usize] = pen.node;
        }
        branching.births.extend_from_slice(&self.births);
        if let Some(edges) = &mut branching.edges {
            edges.extend_from_slice(&self.edges);
            if pen.edge == Edge::Branches {
                self.roots.iter().for_each(|&root| edges[base + root as usize] = Edge::Branches);
            }
        }
        let stays = self.exit.node == ENTRY;
        let (node, edge) =
            if stays { (pen.node, pen.edge) } else { (base as u32 + self.exit.node, self.exit.edge) };
        *pen = Pen { position: start + self.exit.position, heading: self.exit.heading, node, edge };
    }
}

/// A turtle on its way through the tree of rewritings.
struct Walk {
    open: Vec<Open>,
    branches: Vec<Pen>,
    pen: Pen,
}

impl Walk {
    fn new(word: Word, birth: u32, pen: Pen) -> Self {
        Self { open: vec![Open { word, next: 0, birth }], branches: Vec::new(), pen }
    }

    /// Goes on for about a millisecond; whether there is more to do.
    fn go<P: Paper>(&mut self, flat: &mut Flat<'_>, paper: &mut P) -> bool {
        let program = flat.program;
        let mut spent = 0;
        while spent < PATIENCE {
            let Some(top) = self.open.last_mut() else { return false };
            spent += 1;
            let Some(&id) = program.word(top.word).get(top.next) else {
                self.open.pop();
                continue;
            };
            top.next += 1;
            let birth = top.birth;
            if let Some(word) = flat.successors[id as usize].filter(|_| birth < flat.derivations) {
                // What vanishes is not followed.
                if flat.size(id, flat.derivations - birth).symbols == 0 {
                    continue;
                }
                match paper.place(flat, id, birth, &mut self.pen) {
                    Some(work) => spent += work,
                    None => self.open.push(Open { word, next: 0, birth: birth + 1 }),
                }
                continue;
            }
            match flat.actions[id as usize] {
                Action::Nothing => {}
                Action::Draw => {
                    self.pen.position += flat.circle.step(self.pen.heading);
                    let Pen { position, node, edge, .. } = self.pen;
                    self.pen.node = paper.draw(position, node, edge, birth);
                    self.pen.edge = Edge::Succeeds;
                }
                Action::Turn(parts) => self.pen.heading = flat.circle.turned(self.pen.heading, parts),
                Action::Push => {
                    self.branches.push(self.pen);
                    self.pen.edge = Edge::Branches;
                }
                Action::Pop => self.pen = self.branches.pop().unwrap_or(self.pen),
            }
        }
        true
    }
}

pub(super) fn draw(mut flat: Flat<'_>, monitor: &dyn Monitor) -> Result<Branching, LsystemError> {
    let held = bytes_grown::<(DVec2, [u32; 3], Edge)>(MOST_NODES.min(flat.segments) + BLOCK as usize)
        + bytes_of::<Block>(MOST_BLOCKS.min(flat.segments));
    let branching = begin(&flat, held, monitor)?;
    let mut tree = Tree { branching, blocks: Vec::new(), known: BTreeMap::new(), held: 0 };
    let mut walk = Walk::new(flat.program.axiom, 0, Pen::START);
    let total = Some(flat.symbols);
    while walk.go(&mut flat, &mut tree) {
        monitor.check()?;
        // Symbols come up in proportion to segments, about.
        let share = (tree.branching.positions.len() - 1) as f64 / flat.segments as f64;
        monitor.advance(Phase::Turtle, (share * flat.symbols as f64) as u64, total);
    }
    monitor.advance(Phase::Turtle, flat.symbols, total);
    Ok(end(tree.branching))
}
