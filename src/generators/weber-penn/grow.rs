//! All stems, level by level.

use glam::{DQuat, DVec3};
use linden_base::memory::bytes_of;
use linden_base::monitor::{Monitor, Phase};
use linden_base::random::{GOLDEN_ANGLE, Key};
use linden_skeleton::organs::{Organs, PlacedOrgans};
use linden_skeleton::{Branching, Edge, NO_PARENT};
use rayon::prelude::*;

use crate::forecast::{Forecast, forecast};
use crate::stem::{OUTSIDE, Parent, Piece, Stem, Tree};
use crate::{WeberPenn, WeberPennError};

/// The most leaves: a hundred times what a large tree has.
pub const MAX_LEAVES: u64 = 50_000_000;

/// Stems that grow at once, between two looks at memory and the monitor.
const BATCH: usize = 2048;
/// Births of the longest way from the foot, about.
const BIRTHS: f64 = 100.0;

/// For messages about memory.
const DOING: &str = "growing stems";
const ADVICE: &str = "lower branches, leaves or levels";

/// A tree as the paper's parameters give it.
#[derive(Clone, Debug, Default)]
pub struct Drawn {
    /// Nodes at the ends of segments, between them where stems bend, and where others leave; with radii, and
    /// with edges: a stem goes on, its children and its clones branch. A node's birth goes with its way along the
    /// wood from the foot.
    pub branching: Branching,
    /// Leaves.
    pub organs: Organs,
    /// Stems of each level, without clones.
    pub stems: Vec<u64>,
    /// Clones of each level.
    pub clones: Vec<u64>,
    /// The drawn size of the tree, metres.
    pub scale_m: f64,
}

/// Grows a tree.
///
/// Every stem draws by its own key (its parent's key and its number), so that any number of threads gives the
/// same tree.
///
/// # Errors
/// [`WeberPennError`]: too many nodes or leaves, too little memory, cancelled.
pub fn grow(settings: &WeberPenn, key: Key, monitor: &dyn Monitor) -> Result<Drawn, WeberPennError> {
    let settings = &*settings.at_age();
    let expected = forecast(settings);
    expected.check(settings)?;
    let scale_m = drawn_scale(settings, key);
    let levels = (0..=settings.levels as usize).map(|level| settings.level(level)).collect();
    let tree = Tree { settings, levels, scale_m, birth_m: 2.0 * scale_m / BIRTHS };
    let mut drawn = Drawn {
        branching: Branching { radii: Some(Vec::new()), edges: Some(Vec::new()), ..Branching::default() },
        scale_m,
        ..Drawn::default()
    };
    let mut stems = trunks(&tree, key);
    for level in 0..settings.levels {
        if settings.thinned.level == level as usize && settings.thinned.every > 1 {
            stems = stems.into_iter().step_by(settings.thinned.every).collect();
        }
        stems = grow_level(&tree, level, &stems, &expected, &mut drawn, monitor)?;
    }
    Ok(drawn)
}

/// Grows the stems of a level; gives those of the next.
fn grow_level(
    tree: &Tree<'_>,
    level: u32,
    stems: &[Stem],
    expected: &Forecast,
    drawn: &mut Drawn,
    monitor: &dyn Monitor,
) -> Result<Vec<Stem>, WeberPennError> {
    let total = stems.len() as u64;
    let at = &expected.levels[level as usize];
    let each = |count: f64| count / at.stems.max(1.0);
    let mut next: Vec<Stem> = Vec::new();
    let (mut done, mut clones) = (0, 0);
    for batch in stems.chunks(BATCH) {
        monitor.check()?;
        let count = batch.len() as f64;
        // Pieces, which grow one by one, and where they go to.
        let nodes = 2.5 * count * each(at.nodes) * Branching::bytes_for(1) as f64;
        let leaves = 2.5 * count * each(at.leaves) * PlacedOrgans::BYTES_EACH as f64;
        let children = 3.0 * count * each(at.children) * size_of::<Stem>() as f64;
        let held =
            drawn.branching.bytes() + drawn.organs.bytes() + bytes_of::<Stem>(stems.len() + next.capacity());
        monitor.admit(DOING, held.saturating_add((nodes + leaves + children) as u64), ADVICE)?;
        let most = tree.settings.max_nodes as usize
            - drawn.branching.positions.len().min(tree.settings.max_nodes as usize);
        let pieces = batch
            .par_iter()
            .map(|stem| {
                monitor.check()?;
                let limit = tree.settings.max_nodes;
                tree.grow(stem, most).ok_or(WeberPennError::GrewPastLimit { level, limit })
            })
            .collect::<Result<Vec<Piece>, WeberPennError>>()?;
        for (stem, mut piece) in batch.iter().zip(pieces) {
            clones += u64::from(piece.clones);
            let first = append(&mut drawn.branching, stem.node, &piece, monitor)?;
            if drawn.branching.positions.len() > tree.settings.max_nodes as usize {
                return Err(WeberPennError::GrewPastLimit { level, limit: tree.settings.max_nodes });
            }
            next.extend(piece.children.drain(..).map(|child| Stem { node: first + child.node, ..child }));
            piece.leaves.growth.nodes.iter_mut().for_each(|node| *node += first);
            drawn.organs.placed.append(piece.leaves);
            if drawn.organs.placed.len() as u64 > MAX_LEAVES {
                let expected = drawn.organs.placed.len() as f64;
                return Err(WeberPennError::TooManyLeaves { expected, limit: MAX_LEAVES });
            }
        }
        done += batch.len() as u64;
        monitor.advance(Phase::Branch, done, Some(total));
    }
    drawn.stems.push(total);
    drawn.clones.push(clones);
    Ok(next)
}

/// Adds the nodes of a piece whose stem leaves from a node; the number of its first.
fn append(
    branching: &mut Branching,
    node: u32,
    piece: &Piece,
    monitor: &dyn Monitor,
) -> Result<u32, WeberPennError> {
    let first = branching.positions.len() as u32;
    while branching.positions.capacity() - branching.positions.len() < piece.positions.len() {
        branching.make_room(DOING, ADVICE, monitor)?;
        if branching.positions.capacity() - branching.positions.len() < piece.positions.len() {
            branching.positions.reserve_exact(piece.positions.len());
        }
    }
    branching.positions.extend_from_slice(&piece.positions);
    branching.births.extend_from_slice(&piece.births);
    let parent = |&parent: &u32| if parent == OUTSIDE { node } else { first + parent };
    branching.parents.extend(piece.parents.iter().map(parent));
    if let Some(radii) = &mut branching.radii {
        radii.extend_from_slice(&piece.radii);
    }
    if let Some(edges) = &mut branching.edges {
        edges.extend_from_slice(&piece.edges);
    }
    Ok(first)
}

/// The size that a seed gives: never below a tenth of what is asked for.
fn drawn_scale(settings: &WeberPenn, key: Key) -> f64 {
    let drawn = settings.scale_spread_m * key.named("scale").between(-1.0, 1.0);
    (settings.scale_m + drawn).max(0.1 * settings.scale_m)
}

/// The trunks; several stand round the first as leaves do round a twig.
fn trunks(tree: &Tree<'_>, key: Key) -> Vec<Stem> {
    let level = &tree.levels[0];
    let count = libm::round(level.branches.abs()).max(1.0) as u32;
    let trunk = |i: u32| {
        let key = key.named("trunk").child(i.into());
        let drawn = level.length_spread * key.named("length").between(-1.0, 1.0);
        let length_share = (level.length + drawn).max(0.1 * level.length).max(1e-3);
        let length_m = tree.scale_m * length_share;
        let radius_m = length_m * tree.settings.ratio * tree.settings.trunk_scale;
        // Far enough apart for their feet.
        let away_m = 3.0 * radius_m * f64::from(i).sqrt();
        let (sin, cos) = libm::sincos(GOLDEN_ANGLE * f64::from(i));
        let turn = key.named("turn").unit() * std::f64::consts::TAU;
        Stem {
            key,
            level: 0,
            origin: DVec3::new(away_m * cos, away_m * sin, 0.0),
            frame: DQuat::from_rotation_z(turn),
            length_m,
            length_share,
            parent: Parent { length_m: tree.scale_m, radius_m, radius_there_m: 0.0, along: 0.0 },
            node: NO_PARENT,
            way_m: 0.0,
        }
    };
    (0..count).map(trunk).collect()
}

const _: () = assert!(OUTSIDE == NO_PARENT && size_of::<Edge>() == 1);
