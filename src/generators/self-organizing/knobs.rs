//! The knobs: their ranges, their help, and where they do nothing.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real, real_or_auto};
use linden_skeleton::generator::Steps;

use crate::stool::MOST_STEMS;
use crate::tree::MOST_BUDS;
use crate::{LightModel, MAX_ORDERS, Phyllotaxis, SelfOrganizing, Sharing};

/// The largest limit of nodes.
pub const MOST_NODES: u32 = 100_000_000;

/// A list with a number for each order.
const fn per_order(min: f64, max: f64) -> Kind {
    Kind::Reals { min, max, most: MAX_ORDERS as usize }
}

impl SelfOrganizing {
    /// The years that the tree has behind it at its age.
    pub fn years_grown(&self) -> u32 {
        Steps::after(self.age, self.years)
    }

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
            "age",
            real(0.0, 1.0),
            "",
            "how far growth has come: the young tree after this share of its years; 1: the whole tree",
            age,
            details(
                "The tree of that year, with the branches that it shed later. At 0.25 a tree of 40 years is 10 years \
                 old; one year is the least."
            ),
            see_also(&["years"])
        ),
        field!(
            "stems",
            integer(1, MOST_STEMS as u64),
            "stems",
            "stems that rise from one stool and take each other's light: more than 1 for a shrub",
            stems,
            details(
                "Each has random choices of its own. Where shed is above 0 those that stay in the dark die, a crowded \
                 stool thins itself, and what died is said."
            ),
            see_also(&["stool", "stem_lean", "shed"])
        ),
        field!(
            "stool",
            real(0.0, 100.0),
            "m",
            "radius of the stool that the stems of a shrub rise from",
            stool_m,
            see_also(&["stems", "stem_lean"])
        ),
        field!(
            "stem_lean",
            real(0.0, 85.0),
            "degrees",
            "how far the stems at the edge of the stool lean outwards at their feet; the inner ones less",
            stem_lean_deg,
            details("A quarter more or less by chance. With upward above 0 they rise further up."),
            see_also(&["stems", "stool", "upward"])
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
            "decline",
            real_or_auto(1.0, 1e4),
            "years",
            "time in which the vigor of a tree older than decline_from halves; auto: it stays",
            decline_years,
            details(
                "Height has no limit of its own, and a birch of 80 years would stand 60 m high. Trees slow down as \
                 they get tall; with vigor near 1 what grows hardly makes up for what is shed."
            ),
            see_also(&["decline_from", "vigor", "years"])
        ),
        field!(
            "decline_from",
            integer(0, 1000),
            "years",
            "age from which vigor declines",
            decline_from,
            see_also(&["decline", "vigor"])
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
            "light",
            Kind::Choice(LightModel::WORDS),
            "",
            "shadow: a pyramid of shade hangs below each node; sky: what passes the leaves between a bud and the sky",
            light,
            details(
                "Pyramids end, and below them it is as bright as above: crowns get storeys with sky between. The sky's \
                 light is taken by all leaves in its way: heads and domes, dark inside."
            ),
            see_also(&["shade", "leaf_years"])
        ),
        field!(
            "shade",
            real(0.0, 1.0),
            "",
            "light that the leaves of a node take where it is, of full light",
            shade,
            details(
                "With light=shadow 0.05 to 0.2, with light=sky 0.1 to 0.5. With more, only the outer shell of the \
                 crown lives."
            ),
            see_also(&["light", "shade_falloff", "shade_depth", "shed"])
        ),
        field!(
            "leaf_years",
            integer(1, 1000),
            "years",
            "for how long a node has leaves, which take the light of the sky",
            leaf_years,
            details("1 to 3 for broadleaves, 3 to 10 for conifers. Bare wood takes no light."),
            see_also(&["light", "shade"])
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
            details("0.1 to 0.2 for most; from 0.4 on shoots crowd round the stem, and crowns stay poor."),
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
            "dead_years",
            integer(0, 254),
            "years",
            "how long branches that died stay, bare and brittle; 0: they fall at once",
            dead_years,
            details(
                "What a dead branch bears falls after half of them: a bare pole is left, as below the crowns of pines."
            ),
            see_also(&["shed"])
        ),
        field!(
            "bole",
            real(0.0, 1000.0),
            "m",
            "height below which no branch grows: browsed by cattle, or pruned",
            bole_m,
            details(
                "At most a third of the tree's height: crowns of young trees are raised bit by bit. Stems grow there: the \
                 first axis, and buds that grow as stems by reiteration."
            ),
            see_also(&["shed", "max_order", "crown_gap"])
        ),
        field!(
            "crown_gap",
            real(0.0, 1000.0),
            "m",
            "limbs below a longer stretch of bare trunk are shed; 0: they stay",
            crown_gap_m,
            details(
                "The crown then ends where it is no longer closed, and no limb hangs alone below it. 4 or 5 internodes are \
                 usual, more than a year's shoot where phyllotaxis is whorled: whorls are so far apart. A limb counts with a \
                 thousandth of what its stem bears; what hangs below a gap and has more than a fifth of it stays as a storey."
            ),
            see_also(&["shed", "bole"])
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
            see_also(&["righting", "leaf_weight", "twig_diameter", "upward"])
        ),
        field!(
            "righting",
            real(0.0, 10.0),
            "",
            "how far branches that sank raise themselves again by reaction wood: 1 as trees do, 0 not at all",
            righting,
            details(
                "1 as it does in trees, where a year's wood strains by 0.2 % more on one side; as much as an internode is off the \
                 direction in which it grew, and the less the thicker it is: the ends of limbs rise sooner than their bases."
            ),
            see_also(&["sag", "upward"])
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
            integer(2, MOST_NODES as u64),
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
            "decline_from" if self.decline_years.is_none() => Some("decline is auto: vigor stays"),
            "divergence" if self.phyllotaxis != Phyllotaxis::Spiral => Some("phyllotaxis is not spiral"),
            "whorl" if self.phyllotaxis != Phyllotaxis::Whorled => Some("phyllotaxis is not whorled"),
            "shed_grace" | "shed_patience" if self.shed == 0.0 => Some("shed is 0"),
            "dead_years" if self.shed == 0.0 && (self.crown_gap_m == 0.0 || self.sympodial) => {
                Some("shed is 0, and no crown_gap takes limbs")
            }
            "stool" | "stem_lean" if self.stems == 1 => {
                Some("stems is 1: the stem stands upright on its foot")
            }
            "bole" | "crown_gap" if self.max_order == 0 => Some("max_order is 0: there are no branches"),
            "crown_gap" if self.sympodial => Some("sympodial is true: the trunk ends with its first shoot"),
            "leaf_weight" | "righting" if self.sag == 0.0 => Some("sag is 0"),
            "shade_falloff" | "shade_depth" | "light_from" | "light_pull" | "leaf_years"
                if self.shade == 0.0 =>
            {
                Some("shade is 0")
            }
            "shade_falloff" | "shade_depth" if self.light == LightModel::Sky => Some("light is sky"),
            "leaf_years" if self.light == LightModel::Shadow => Some("light is shadow"),
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
