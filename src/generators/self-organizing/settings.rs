//! The settings: how buds compete, how shoots grow, what is shed.

use linden_base::knob::{Field, Kind, integer, real, real_or_auto};
use linden_base::{field, words};

use crate::tree::MOST_BUDS;

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
    /// Years that the tree grows.
    pub years: u32,
    /// Length of an internode in a shoot that gets a whole number, metres: the edge of a voxel of light.
    pub internode_m: f64,
    /// Internodes that a bud in full light may grow in a year: α.
    pub vigor: f64,
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
    /// Shade of a node where it is ÷ full light.
    pub shade: f64,
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
    /// Diameter of the last internodes, metres.
    pub twig_diameter_m: f64,
    /// n of the pipe model.
    pub pipe_exponent: f64,
    /// How far branches bend under their weight: 1 as green wood does, 0 not at all.
    pub sag: f64,
    /// Weight of the leaves of a node, kilograms.
    pub leaf_weight_kg: f64,
    /// Larger trees are refused.
    pub max_nodes: u32,
}

/// A list with a number for each order.
const fn per_order(min: f64, max: f64) -> Kind {
    Kind::Reals { min, max, most: MAX_ORDERS as usize }
}

impl SelfOrganizing {
    /// The knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "years",
            integer(1, 1000),
            "years",
            "how long the tree grows",
            years,
            see_also(&["vigor", "internode", "max_nodes"])
        ),
        field!(
            "internode",
            real(0.001, 10.0),
            "m",
            "length of an internode: the unit of growth, and the edge of a voxel of light",
            internode_m,
            details(
                "A shoot that gets 3.4 has three internodes of 3.4 / 3 times this length. All lengths follow: \
                 a tree with twice the internode is twice as large, with as many nodes."
            ),
            see_also(&["vigor", "longest_shoot"])
        ),
        field!(
            "vigor",
            real(0.1, 20.0),
            "internodes",
            "internodes that a bud in full light may grow in a year",
            vigor,
            details(
                "The tree gets its buds' light times this, and shares it. 1 or less nearly stops after some \
                 years; above 3 shade wins and crowns get sparse."
            ),
            see_also(&["shade", "leader", "longest_shoot"])
        ),
        field!(
            "sharing",
            Kind::Choice(Sharing::WORDS),
            "",
            "how growth is shared among buds: fork by fork, or along axes by the light of laterals",
            sharing,
            details(
                "borchert-honda goes by leader, priority by priority_least and priority_share. With leader=0.5, \
                 and with priority_least=1, both give each bud what its light is worth."
            ),
            see_also(&["leader", "priority_least"])
        ),
        field!(
            "leader",
            per_order(0.01, 0.99),
            "",
            "weight of an axis against its laterals, for each order: above 0.5 a leader, below a bush",
            leader,
            details(
                "Lambda of Borchert and Honda. 0.46 a bush, 0.5 no preference, 0.54 an oak, 0.6 a conifer. \
                 Height is not limited: from 0.58 on leaders run away in few years."
            ),
            see_also(&["mature_leader", "sharing", "longest_shoot"])
        ),
        field!(
            "mature_leader",
            real_or_auto(0.01, 0.99),
            "",
            "leader of all orders of a mature tree: lower values round the crown; auto: as before",
            mature_leader,
            see_also(&["mature_from", "mature_to", "leader"])
        ),
        field!(
            "mature_from",
            integer(0, 1000),
            "years",
            "age from which leader moves to mature_leader",
            mature_from,
            see_also(&["mature_leader", "mature_to"])
        ),
        field!(
            "mature_to",
            integer(0, 1000),
            "years",
            "age in which leader is mature_leader",
            mature_to,
            see_also(&["mature_leader", "mature_from"])
        ),
        field!(
            "priority_least",
            real(0.0, 1.0),
            "",
            "weight of the darkest laterals of an axis; its apex has 1",
            priority_least,
            see_also(&["sharing", "priority_share"])
        ),
        field!(
            "priority_share",
            real(0.01, 1.0),
            "",
            "share of an axis' laterals, brightest first, over which weights fall to priority_least",
            priority_share,
            see_also(&["sharing", "priority_least"])
        ),
        field!(
            "shade",
            real(0.0, 1.0),
            "",
            "light that the leaves of a node take where it is, of full light",
            shade,
            details("0.05 to 0.2. With more, only the outer shell of the crown lives."),
            see_also(&["shade_falloff", "shade_depth", "shed"])
        ),
        field!(
            "shade_falloff",
            real(1.0, 10.0),
            "",
            "factor by which shade gets weaker with each internode below",
            shade_falloff,
            details("Near 1 shade reaches far: sparse crowns and clear boles. 2: dense crowns."),
            see_also(&["shade", "shade_depth"])
        ),
        field!(
            "shade_depth",
            integer(0, 16),
            "internodes",
            "how far down shade reaches",
            shade_depth,
            see_also(&["shade", "shade_falloff"])
        ),
        field!(
            "light_from",
            Kind::Vector { auto: false },
            "",
            "direction to the light, tilted by 45 degrees at most",
            light_from,
            see_also(&["light_pull"])
        ),
        field!(
            "light_pull",
            real(0.0, 5.0),
            "",
            "how far shoots turn to where less shade is",
            light_pull,
            see_also(&["upward", "shade"])
        ),
        field!(
            "upward",
            per_order(-5.0, 5.0),
            "",
            "how far shoots turn up, for each order; below 0 down",
            upward,
            details("0.1 to 0.2 for most; from 0.4 on crowns stay poor."),
            see_also(&["sideways", "light_pull"])
        ),
        field!(
            "sideways",
            per_order(0.0, 5.0),
            "",
            "how far shoots turn level, for each order: branches of firs",
            sideways,
            see_also(&["upward"])
        ),
        field!(
            "phyllotaxis",
            Kind::Choice(Phyllotaxis::WORDS),
            "",
            "where lateral buds are on a shoot",
            phyllotaxis,
            details(
                "alternate: elm, beech, lime. spiral: oak, poplar. opposite: maple, ash. whorled: pine, spruce; \
                 buds stand at the ends of shoots alone."
            ),
            see_also(&["divergence", "whorl", "branching_angle"])
        ),
        field!(
            "divergence",
            real(-180.0, 180.0),
            "degrees",
            "from a bud to the next about the shoot, with phyllotaxis=spiral",
            divergence_deg,
            see_also(&["phyllotaxis"])
        ),
        field!(
            "whorl",
            integer(2, MOST_BUDS as u64),
            "buds",
            "buds at the end of a shoot, with phyllotaxis=whorled",
            whorl,
            see_also(&["phyllotaxis"])
        ),
        field!(
            "branching_angle",
            per_order(0.0, 180.0),
            "degrees",
            "from an axis to its laterals, for each order of the axis",
            branching_angle_deg,
            see_also(&["upward", "sideways"])
        ),
        field!(
            "jitter",
            real(0.0, 1.0),
            "",
            "how far each internode is drawn off its direction",
            jitter,
            see_also(&["light_pull"])
        ),
        field!(
            "longest_shoot",
            real(1.0, 200.0),
            "internodes",
            "the most that a shoot grows in a year",
            longest_shoot,
            see_also(&["vigor", "leader"])
        ),
        field!(
            "max_order",
            integer(0, MAX_ORDERS as u64 - 1),
            "",
            "the deepest order of axes: 0 is a stem alone",
            max_order,
            see_also(&["leader"])
        ),
        field!(
            "sympodial",
            Kind::Switch,
            "",
            "whether the apex dies at the end of each shoot, and laterals take over",
            sympodial,
            see_also(&["phyllotaxis"])
        ),
        field!(
            "bud_years",
            integer(0, 1000),
            "years",
            "how long a lateral bud that did not grow waits for light",
            bud_years,
            see_also(&["reiteration"])
        ),
        field!(
            "reiteration",
            integer(0, 1000),
            "years",
            "buds that waited for so long grow as stems do; 0: none",
            reiteration,
            see_also(&["bud_years"])
        ),
        field!(
            "shed",
            real(0.0, 1.0),
            "",
            "branches with less light for each of their internodes are shed, of full light; 0: none",
            shed,
            details(
                "0.2 clears the inside of a crown. There is a cliff: at 0.3 a tree may stand, at 0.45 a pole."
            ),
            see_also(&["shed_grace", "shed_patience", "shade"])
        ),
        field!(
            "shed_grace",
            integer(0, 255),
            "years",
            "for how long a young branch is not shed",
            shed_grace,
            see_also(&["shed"])
        ),
        field!(
            "shed_patience",
            integer(1, 255),
            "years",
            "for how many years in a row a branch must be too dark to be shed",
            shed_patience,
            details("With 1, the first dark year kills; one lost limb then leads to one-sided crowns."),
            see_also(&["shed"])
        ),
        field!(
            "twig_diameter",
            real(0.0001, 1.0),
            "m",
            "diameter of the last internodes",
            twig_diameter_m,
            see_also(&["pipe_exponent"])
        ),
        field!(
            "pipe_exponent",
            real(1.0, 5.0),
            "",
            "n of the pipe model: diameter is that of a twig times the tips above to the power of 1/n",
            pipe_exponent,
            details("Tips that were shed count: wood does not get thinner when branches die."),
            see_also(&["twig_diameter"])
        ),
        field!(
            "sag",
            real(0.0, 100.0),
            "",
            "how far branches bend under their weight: 1 as green wood does, 0 not at all",
            sag,
            details(
                "Laterals are beams of 8 GPa and 900 kg/m3, bent each year by what came upon them; nothing springs \
                 back. Limbs arch, and with upward above 0 their tips rise. Stems stay upright."
            ),
            see_also(&["leaf_weight", "twig_diameter", "upward"])
        ),
        field!(
            "leaf_weight",
            real(0.0, 10.0),
            "kg",
            "weight of the leaves of a node",
            leaf_weight_kg,
            see_also(&["sag"])
        ),
        field!(
            "max_nodes",
            integer(2, 100_000_000),
            "nodes",
            "larger trees are refused",
            max_nodes,
            see_also(&["years", "vigor"])
        ),
    ];

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub(crate) fn why_idle(&self, knob: &str) -> Option<&'static str> {
        let is_priority = self.sharing == Sharing::Priority;
        match knob {
            "leader" | "mature_leader" if is_priority => Some("sharing is priority"),
            "priority_least" | "priority_share" if !is_priority => Some("sharing is borchert-honda"),
            "mature_from" | "mature_to" if is_priority || self.mature_leader.is_none() => {
                Some("leader does not change: mature_leader is auto, or sharing priority")
            }
            "divergence" if self.phyllotaxis != Phyllotaxis::Spiral => Some("phyllotaxis is not spiral"),
            "whorl" if self.phyllotaxis != Phyllotaxis::Whorled => Some("phyllotaxis is not whorled"),
            "shed_grace" | "shed_patience" if self.shed == 0.0 => Some("shed is 0"),
            "leaf_weight" if self.sag == 0.0 => Some("sag is 0"),
            "shade_falloff" | "shade_depth" | "light_from" | "light_pull" if self.shade == 0.0 => {
                Some("shade is 0")
            }
            "reiteration" if self.reiteration > self.bud_years + 1 => {
                Some("no bud waits for so long: see bud_years")
            }
            "reiteration" if !self.tells_orders() => {
                Some("all orders are alike: leader, upward, sideways and branching_angle have one number")
            }
            _ => None,
        }
    }
}

impl SelfOrganizing {
    /// Whether stems differ from other axes.
    fn tells_orders(&self) -> bool {
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
            years: 20,
            internode_m: 0.1,
            vigor: 2.0,
            sharing: Sharing::BorchertHonda,
            leader: vec![0.54],
            mature_leader: None,
            mature_from: 7,
            mature_to: 14,
            priority_least: 0.006,
            priority_share: 0.5,
            shade: 0.05,
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
            twig_diameter_m: 0.002,
            pipe_exponent: 2.5,
            sag: 0.0,
            leaf_weight_kg: 0.001,
            max_nodes: 10_000_000,
        }
    }
}
