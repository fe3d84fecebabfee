//! How thick the wood is: the rules, one file each, and the choice between them.
//!
//! Whatever the rule, radii are finite and above zero, and nothing is thinner than the tip radius.
//! Wood never thickens from a parent to its child, but where a generator gave the radii.

pub(super) mod by_axis;
mod girth;
mod given;
pub(super) mod pipe;

use std::cmp::Ordering;

use glam::Vec3;

use self::by_axis::Ends;
use self::pipe::{Pipes, Thickness};
use super::axes::decompose;
use super::{Axis, Branching, Edge, Skeleton};
use linden_base::mesh::Bounds;
use linden_base::random::Key;

pub use self::girth::Girth;

linden_base::words! {
    /// Which rule decides the radii.
    Width {
        /// What the generator gave, where it gave radii, else the pipe model.
        Auto = "auto",
        /// The pipe model `r^n = Σ r_child^n` (Shinozaki et al. 1964; RLP07 section 4.3).
        Pipe = "pipe",
        /// The same all along an axis, and a fixed share of it in the next branching order.
        Order = "order",
        /// Each axis tapers from a share of its parent to a share of its own base, both drawn.
        Taper = "taper",
        /// What the generator gave (a grammar's `!`, a scan's bark); the pipe model where it gave none.
        Grammar = "grammar",
    }
}

linden_base::words! {
    /// Which child of a node continues its axis.
    AxisRule {
        /// The one that the generator names, where it names them (a grammar), else the thickest.
        Auto = "auto",
        /// The one outside brackets; where all are bracketed, none. The thickest without a grammar.
        Grammar = "grammar",
        /// The thickest, then the straightest.
        Thickest = "thickest",
    }
}

linden_base::words! {
    /// How the radius goes from node to node.
    #[derive(Default)]
    WidthSteps {
        /// Evenly, from the one's radius to the other's.
        #[default]
        Taper = "taper",
        /// In a step at each node: a segment has the radius of the node that it ends in all along.
        Cylinder = "cylinder",
    }
}

/// Shares that are drawn uniformly; a `min` above `max` is taken as below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Least.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

/// How thick the wood is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wood {
    /// The rule.
    pub width: Width,
    /// Which child of a node continues its axis.
    pub axes: AxisRule,
    /// How the radius goes from node to node.
    pub width_steps: WidthSteps,
    /// Metres at the thickest stem's foot; `None`: follows from the tips where the pipe model knows
    /// them, else from the height.
    pub base_radius_m: Option<f64>,
    /// Metres at the tips; `None`: follows from the base. Nothing is thinner.
    pub tip_radius_m: Option<f64>,
    /// Height ÷ diameter at the foot of the thickest stem, where the height decides: 30–50 for trees that
    /// stand in the open, 80–100 in dense stands.
    pub slenderness: f64,
    /// `n` of the pipe model. Measured trees 1.8–2.3; the programs before this one 2.05 and 2.5.
    pub radius_exponent: f64,
    /// How much of the pipe model's sharing at forks goes by angle: 0, none, all tips have equal
    /// pipes; 1, a child that turns back gets next to nothing.
    pub angle_share: f64,
    /// For [`Width::Order`]: radius of a lateral ÷ radius of the axis it leaves.
    pub order_ratio: f64,
    /// For [`Width::Taper`]: least and largest radius of a lateral's base ÷ that of its parent there.
    pub taper_base: Span,
    /// For [`Width::Taper`]: least and largest radius of an axis' tip ÷ that of its base.
    pub taper_tip: Span,
}

impl Default for Wood {
    /// Leonardo's rule: the cross-section is the same above and below a fork.
    fn default() -> Self {
        Self {
            width: Width::Auto,
            axes: AxisRule::Auto,
            width_steps: WidthSteps::Taper,
            base_radius_m: None,
            tip_radius_m: None,
            slenderness: 30.0,
            radius_exponent: 2.0,
            angle_share: 0.0,
            order_ratio: 0.5,
            taper_base: Span { min: 0.5, max: 0.9 },
            taper_tip: Span { min: 0.1, max: 0.3 },
        }
    }
}

/// Where no tip radius is given and none follows: the thinnest wood ÷ the thickest. Thinner twigs
/// could not be told from a line where single precision holds the thickest.
const THINNEST_PER_BASE: f64 = 1e-3;

impl Wood {
    /// The same with what is left to the generator settled: what a tree was built with, depending on
    /// whether its generator gave radii and edges.
    #[must_use]
    pub fn settled(&self, radii_are_given: bool, edges_are_given: bool) -> Self {
        let width = match self.width {
            Width::Auto | Width::Grammar if radii_are_given => Width::Grammar,
            Width::Auto | Width::Grammar => Width::Pipe,
            other => other,
        };
        let axes = match self.axes {
            AxisRule::Auto | AxisRule::Grammar if edges_are_given => AxisRule::Grammar,
            _ => AxisRule::Thickest,
        };
        Self { width, axes, ..*self }
    }

    /// The radius at the foot, metres, where the height decides.
    fn base_of_height(&self, height_m: f64) -> f64 {
        height_m * (1.0 / (2.0 * self.slenderness))
    }
}

/// What is less than this share as high as it is long lies.
const LYING: f32 = 0.1;

/// How high a tree is, metres, from its lowest node to its highest; of one that lies, how long it is.
pub(super) fn height(positions: &[Vec3]) -> f64 {
    Bounds::of(positions.iter().copied()).map_or(0.0, |bounds| {
        let size = bounds.size();
        let length = size.max_element();
        f64::from(if size.y < LYING * length { length } else { size.y })
    })
}

/// Axes with their nodes, and a radius for each node.
pub(super) struct Built {
    pub axes: Vec<Axis>,
    pub axis_nodes: Vec<u32>,
    pub radii: Vec<f32>,
}

/// A whole tree's axes and radii.
pub(super) fn build(
    positions: &[Vec3],
    parents: &[u32],
    given: Option<Vec<f32>>,
    edges: Option<&[Edge]>,
    wood: &Wood,
    key: Key,
) -> Built {
    let given = given.filter(|radii| radii.iter().any(|&radius| radius > 0.0));
    match (wood.settled(given.is_some(), edges.is_some()).width, given) {
        (Width::Grammar, Some(radii)) => of_given(positions, parents, edges, given::within(radii, wood)),
        (Width::Order | Width::Taper, _) => {
            let (axes, axis_nodes) = axes_by_tips(positions, parents, edges);
            let ends = Ends::new(height(positions), wood);
            let radii = if wood.width == Width::Order {
                by_axis::by_order(&axes, &axis_nodes, wood.order_ratio, &ends)
            } else {
                let keys = by_axis::keys(&axes, &axis_nodes, key);
                by_axis::tapered(positions, parents, (&axes, &axis_nodes), &keys, wood, &ends)
            };
            Built { axes, axis_nodes, radii }
        }
        _ => {
            let pipes = Pipes::new(positions, parents, wood);
            let thickness = Thickness::new(positions, &pipes, wood);
            of_pipes(positions, parents, edges, pipes, &thickness)
        }
    }
}

/// The radius of each node of a branching that may change yet, metres.
pub(super) fn provisional(branching: &Branching, wood: &Wood, key: Key) -> Vec<f32> {
    let Branching { positions, parents, radii, edges, .. } = branching;
    build(positions, parents, radii.clone(), edges.as_deref(), wood, key).radii
}

/// The axes and radii of some of a tree's nodes, `nodes`, as thick as fits the whole.
pub(super) fn build_young(
    whole: &Skeleton,
    nodes: &[u32],
    positions: &[Vec3],
    parents: &[u32],
    wood: &Wood,
    key: Key,
) -> Built {
    let edges = (wood.axes == AxisRule::Grammar).then(|| whole.edges_of(nodes));
    let edges = edges.as_deref();
    match wood.width {
        Width::Grammar => of_given(positions, parents, edges, given::when_young(whole, nodes, parents)),
        Width::Order | Width::Taper => {
            let (axes, axis_nodes) = axes_by_tips(positions, parents, edges);
            let (now, then) = (height(positions), height(&whole.positions));
            let ends = Ends::new(then, wood).when_grown(if then > 0.0 { now / then } else { 1.0 });
            let radii = if wood.width == Width::Order {
                by_axis::by_order(&axes, &axis_nodes, wood.order_ratio, &ends)
            } else {
                // What was drawn for an axis of the whole tree holds for it from the start.
                let drawn = by_axis::keys(&whole.axes, &whole.axis_nodes, key);
                let axis_of = by_axis::axis_of(&whole.axes, &whole.axis_nodes);
                let base = |axis: &Axis| nodes[axis_nodes[axis.first as usize] as usize];
                let keys: Vec<Key> =
                    axes.iter().map(|axis| drawn[axis_of[base(axis) as usize] as usize]).collect();
                by_axis::tapered(positions, parents, (&axes, &axis_nodes), &keys, wood, &ends)
            };
            Built { axes, axis_nodes, radii }
        }
        Width::Auto | Width::Pipe => {
            let all = Pipes::new(&whole.positions, &whole.parents, wood);
            let thickness = Thickness::new(&whole.positions, &all, wood);
            drop(all);
            of_pipes(positions, parents, edges, Pipes::new(positions, parents, wood), &thickness)
        }
    }
}

fn of_pipes(
    positions: &[Vec3],
    parents: &[u32],
    edges: Option<&[Edge]>,
    pipes: Pipes,
    thickness: &Thickness,
) -> Built {
    let radii = thickness.radii(&pipes);
    let (axes, axis_nodes) = decompose(positions, parents, edges, move |a, b| pipes.compare(a, b));
    Built { axes, axis_nodes, radii }
}

/// Of radii that differ by less, relatively, neither is thicker: what a scan measures is noisy.
const AS_THICK: f32 = 1.0 / 8.0;

/// The child that carries more continues the axis, among equals one that is clearly thicker.
fn of_given(positions: &[Vec3], parents: &[u32], edges: Option<&[Edge]>, radii: Vec<f32>) -> Built {
    let tips = pipe::count_tips(parents);
    let thicker = |a: u32, b: u32| -> Ordering {
        let (a, b) = (a as usize, b as usize);
        let alike = (radii[a] - radii[b]).abs() <= AS_THICK * radii[a].max(radii[b]);
        let by_radius = if alike { Ordering::Equal } else { radii[a].total_cmp(&radii[b]) };
        tips[a].cmp(&tips[b]).then(by_radius)
    };
    let (axes, axis_nodes) = decompose(positions, parents, edges, thicker);
    Built { axes, axis_nodes, radii }
}

/// Axes of a branching without radii: of several children the one that succeeds its parent continues the
/// axis; without edges the one that bears most tips.
pub fn axes_by_tips(positions: &[Vec3], parents: &[u32], edges: Option<&[Edge]>) -> (Vec<Axis>, Vec<u32>) {
    let tips = pipe::count_tips(parents);
    decompose(positions, parents, edges, move |a, b| tips[a as usize].cmp(&tips[b as usize]))
}
