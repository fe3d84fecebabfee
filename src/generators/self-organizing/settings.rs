//! The settings: how buds compete, how shoots grow, what is shed.

use linden_base::words;

use crate::obstacle::Obstacle;
use crate::stand::Neighbour;

/// The deepest order of axes.
pub const MAX_ORDERS: u32 = 16;

words! {
    /// How a tree shares what its light is worth among its buds.
    Sharing {
        /// Fork by fork, between the axis and its laterals: Borchert & Honda 1984.
        BorchertHonda = "borchert-honda",
        /// Axis by axis, the apex first, then laterals by their light: Pałubicki et al. 2009, section 4.3.
        Priority = "priority"
    }
}

words! {
    /// How light is worked out.
    LightModel {
        /// Each node shades a pyramid of voxels below it: Pałubicki et al. 2009, section 4.2.1.
        Shadow = "shadow",
        /// Light from all of the sky, through the leaves in its way: Monsi & Saeki 1953.
        Sky = "sky"
    }
}

words! {
    /// Where lateral buds are.
    Phyllotaxis {
        /// One at each node, turned by the divergence angle from the one before.
        Spiral = "spiral",
        /// One at each node, on alternating sides.
        Alternate = "alternate",
        /// Two at each node, across those before.
        Opposite = "opposite",
        /// A ring at the end of each year's shoot, none below it.
        Whorled = "whorled"
    }
}

/// Trees whose buds compete for light. Lists have a number for each order of axes, the stem first; the last holds
/// for all further ones.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SelfOrganizing {
    /// Further trees: they grow with the first one, which stands at the origin, and all take each other's light.
    pub stand: Vec<Neighbour>,
    /// Solids that nothing grows into, and that take the light.
    pub obstacles: Vec<Obstacle>,
    /// Stems of each tree: more than one for a shrub.
    pub stems: u32,
    /// Radius of the stool that the stems of a shrub rise from, metres.
    pub stool_m: f64,
    /// How far the stems at the edge of the stool lean outwards, degrees from upright.
    pub stem_lean_deg: f64,
    /// Years that the tree grows.
    pub years: u32,
    /// The share of them that it has behind it.
    pub age: f64,
    /// Length of an internode in a shoot that gets a whole number, metres: the edge of a voxel of light.
    pub internode_m: f64,
    /// Internodes that a bud in full light may grow in a year: α.
    pub vigor: f64,
    /// The age up to which vigor stays, years.
    pub decline_from: u32,
    /// Years in which the vigor of older trees halves.
    pub decline_years: Option<f64>,
    /// How light is shared.
    pub sharing: Sharing,
    /// λ of Borchert & Honda: the weight of an axis against its laterals.
    pub leader: Vec<f64>,
    /// λ of mature trees.
    pub mature_leader: Option<f64>,
    /// The year from which λ changes.
    pub mature_from: u32,
    /// The year in which it has changed.
    pub mature_to: u32,
    /// The weight of the darkest laterals ÷ the apex'.
    pub priority_least: f64,
    /// The share of an axis' laterals over which weights fall.
    pub priority_share: f64,
    /// How light is worked out.
    pub light: LightModel,
    /// Shade of a node where it is ÷ full light; from the sky, the optical depth of its leaves over a square of an
    /// internode.
    pub shade: f64,
    /// Years for which a node has leaves, which take the light of the sky.
    pub leaf_years: u32,
    /// The factor by which shade gets weaker from layer to layer.
    pub shade_falloff: f64,
    /// Layers of shade below a node, internodes.
    pub shade_depth: u32,
    /// Where light comes from, tilted by 45° at most.
    pub light_from: [f64; 3],
    /// How far shoots turn to the light: ξ.
    pub light_pull: f64,
    /// How far shoots turn up, below 0 down: η.
    pub upward: Vec<f64>,
    /// How far shoots turn level.
    pub sideways: Vec<f64>,
    /// Where lateral buds are.
    pub phyllotaxis: Phyllotaxis,
    /// From a bud to the next one about a shoot, degrees; below 0 the other way round.
    pub divergence_deg: f64,
    /// Buds of a whorl.
    pub whorl: u32,
    /// How far laterals leave from their parent, degrees.
    pub branching_angle_deg: Vec<f64>,
    /// How far directions are drawn off, as a share of the internode.
    pub jitter: f64,
    /// The most internodes of a shoot.
    pub longest_shoot: f64,
    /// The deepest order of axes: 0 a stem alone.
    pub max_order: u32,
    /// Whether the apex dies at the end of each shoot, and laterals take over.
    pub sympodial: bool,
    /// Years for which lateral buds wait.
    pub bud_years: u32,
    /// Buds that waited for so many years grow as stems; 0: none.
    pub reiteration: u32,
    /// Branches with less light than this for each of their internodes are shed, as a share of full light.
    pub shed: f64,
    /// Years for which a branch is not shed.
    pub shed_grace: u32,
    /// Years in a row for which a branch must be too dark.
    pub shed_patience: u32,
    /// Years for which a branch that died stays; 0: it falls at once.
    pub dead_years: u32,
    /// Height below which no branch grows, metres, up to a third of the tree's: browsed or pruned. Stems do.
    pub bole_m: f64,
    /// Limbs below a longer stretch of bare trunk are shed, metres, where they are a small part of the tree; 0: they stay.
    pub crown_gap_m: f64,
    /// Diameter of the last internodes, metres.
    pub twig_diameter_m: f64,
    /// n of the pipe model.
    pub pipe_exponent: f64,
    /// How far branches bend under their weight: 1 as green wood does, 0 not at all.
    pub sag: f64,
    /// How far branches that sank raise themselves again: 1 as reaction wood does, 0 not at all.
    pub righting: f64,
    /// Weight of the leaves of a node, kilograms.
    pub leaf_weight_kg: f64,
    /// Larger trees are refused.
    pub max_nodes: u32,
}

impl SelfOrganizing {
    /// Whether stems differ from other axes.
    pub(crate) fn tells_orders(&self) -> bool {
        let lists = [&self.leader, &self.upward, &self.sideways, &self.branching_angle_deg];
        let differs = |list: &Vec<f64>| list.iter().any(|number| Some(number) != list.first());
        self.max_order + 1 < MAX_ORDERS || lists.into_iter().any(differs)
    }
}

/// The number of a list for an order.
pub(crate) fn of_order(list: &[f64], order: u8) -> f64 {
    list.get(usize::from(order)).or(list.last()).copied().unwrap_or(0.0)
}

impl Default for SelfOrganizing {
    /// A broadleaf that grows in the open.
    fn default() -> Self {
        Self {
            stand: Vec::new(),
            obstacles: Vec::new(),
            stems: 1,
            stool_m: 0.25,
            stem_lean_deg: 20.0,
            years: 20,
            age: 1.0,
            internode_m: 0.1,
            vigor: 2.0,
            decline_from: 0,
            decline_years: None,
            sharing: Sharing::BorchertHonda,
            leader: vec![0.54],
            mature_leader: None,
            mature_from: 7,
            mature_to: 14,
            priority_least: 0.006,
            priority_share: 0.5,
            light: LightModel::Shadow,
            shade: 0.05,
            leaf_years: 3,
            shade_falloff: 1.3,
            shade_depth: 6,
            light_from: [0.0, 1.0, 0.0],
            light_pull: 0.3,
            upward: vec![0.15],
            sideways: vec![0.0],
            phyllotaxis: Phyllotaxis::Spiral,
            divergence_deg: 137.5,
            whorl: 5,
            branching_angle_deg: vec![50.0],
            jitter: 0.05,
            longest_shoot: 20.0,
            max_order: MAX_ORDERS - 1,
            sympodial: false,
            bud_years: 10,
            reiteration: 0,
            shed: 0.2,
            shed_grace: 3,
            shed_patience: 2,
            dead_years: 0,
            bole_m: 0.0,
            crown_gap_m: 0.0,
            twig_diameter_m: 0.002,
            pipe_exponent: 2.5,
            sag: 0.0,
            righting: 0.0,
            leaf_weight_kg: 0.001,
            max_nodes: 10_000_000,
        }
    }
}
