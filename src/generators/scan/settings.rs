//! How given points are taken for a tree.

use linden_base::knob::{Field, Kind, Knob, Value, real, real_or_auto, set, values};
use linden_base::{field, words};
use linden_growth::GrowthSettings;
use linden_skeleton::{Width, Wood};

words! {
    /// Where the radii of a scanned tree come from.
    ScanRadius {
        /// The points on its bark, where there are enough.
        Points = "points",
        /// The pipe model.
        Pipe = "pipe"
    }
}

words! {
    /// How the trees of a plot are told apart.
    Segmentation {
        /// By a column of the file that numbers them, where it has one.
        Column = "column",
        /// By the shortest ways from the stems that are found.
        Paths = "paths"
    }
}

words! {
    /// Which points of a scan lie on leaves.
    LeafPoints {
        /// What a column of the file says, if it has one.
        Auto = "auto",
        /// Those that are found in a tree in leaf.
        Paths = "paths",
        /// None: all lie on wood.
        None = "none"
    }
}

impl LeafPoints {
    /// Whether points on leaves are told from the others, in a file that has a column for it or none.
    pub(crate) fn are_told(self, has_column: bool) -> bool {
        match self {
            Self::Auto => has_column,
            Self::Paths => true,
            Self::None => false,
        }
    }
}

/// Given points, and how a tree grows into them.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanSettings {
    /// The file with the points.
    pub file: String,
    /// The file's column that tells trees apart; `None`: the likeliest by its name.
    pub instance: Option<String>,
    /// How trees are told apart.
    pub segmentation: Segmentation,
    /// The number of the tree, rounded; `None`: all points, whichever tree they belong to.
    pub tree: Option<f64>,
    /// How it grows into the points.
    pub growth: GrowthSettings,
    /// Whether the points lie on the surface of a tree, as a scanner's do, and are moved onto its axes first.
    pub contract: bool,
    /// Which points of a scan lie on leaves.
    pub leaf_points: LeafPoints,
    /// Where the radii of a scanned tree come from.
    pub scan_radius: ScanRadius,
    /// Whether points of a scan that hardly any others are near are left out.
    pub noise_filter: bool,
    /// How many stems a scan shows, rounded; `None`: as many as stand apart on the ground.
    pub stems: Option<f64>,
    /// Metres for a unit of given points; `None`: 1, or what makes a possible tree of a scan.
    pub scale: Option<f64>,
    /// The sides of the cubes of which one point each is kept, in the file's units; 0: all are.
    pub thin: f64,
}

impl ScanSettings {
    /// The knobs of scans themselves.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "tree",
            real_or_auto(1.0, 1e9),
            "",
            "the number of the tree in a scan whose points say which they belong to; auto: all points are one tree",
            tree,
            details(
                "Programs that segment scans of forests number the trees in a column of their own: extra bytes of LAS and \
                 LAZ, a property of PLY, a field of PCD, a column of a table with a header. It is told by its name, like \
                 PredInstance, treeID, tree, instance or label; where there are several, instance = \"NAME\" in the \
                 preset's [scan] picks one, and instance = \"none\" none. 0 and less is no tree: where one tree is numbered, such points \
                 are left out. linden show lists the numbers, and linden export \
                 PLOT -o FOLDER/ grows each tree."
            ),
            see_also(&["segmentation", "stems", "contract"])
        ),
        field!(
            "segmentation",
            Kind::Choice(Segmentation::WORDS),
            "",
            "how trees are told apart; column: by a column of the file, if it has one; paths: by ways from the stems it shows",
            segmentation,
            details(
                "paths is for plots that nobody has segmented: the ground is found, then stems by circles near breast \
                 height, and each point goes to the stem from which the way to it along other points is the shortest and \
                 straightest. Crowns in leaf that meet are told apart badly. Trees are numbered by their heights, the tallest is 1. linden show \
                 lists them, tree=N takes one, and linden export PLOT -o FOLDER/ grows each. What is lower than 2 m, \
                 and ground, is of no tree."
            ),
            see_also(&["tree", "stems"])
        ),
        field!(
            "contract",
            Kind::Switch,
            "",
            "for given points: they lie on bark, as a scanner's do, and are moved onto the axes of branches first",
            contract,
            details(
                "A scanner sees bark: grown as they are, the points of a thick stem pull up many parallel \
                 strands. With true they are thinned, sorted into sections by their way from the foot, \
                 drawn to the middle of these, and gaps are bridged. false takes the points as they are: \
                 positions of leaves, say, or attraction points of another program."
            ),
            see_also(&["scan_radius", "noise_filter", "stems", "step"])
        ),
        field!(
            "leaf_points",
            Kind::Choice(LeafPoints::WORDS),
            "",
            "points of a scan on leaves; auto: by a column of the file, if it has one; paths: found, for a tree in leaf; none: all are wood",
            leaf_points,
            details(
                "Twigs grow to points on leaves, but no radius is measured on them. paths finds them by their way from \
                 the foot: wood has long ways beyond it, is as thick as these let expect, and its bark is smooth. auto \
                 looks for a column part, semantic_seg or wood_leaf (1 wood, 2 leaf), or is_leaf (0, 1). paths is for trees \
                 in leaf alone: of a bare one it takes twigs for leaves."
            ),
            see_also(&["scan_radius", "noise_filter", "contract"])
        ),
        field!(
            "scan_radius",
            Kind::Choice(ScanRadius::WORDS),
            "",
            "radii of a scanned tree; points: from the points on its bark, where there are enough; pipe: as of any tree",
            scan_radius,
            details(
                "points puts circles through the points round each axis; between and beyond them radii follow from \
                 those measured and the length of wood that each place bears. In half of the synthetic scans that it was \
                 tried on the diameter at breast height came out within 0.6 %, the volume within 5 %. pipe helps where \
                 leaves or ivy thicken the wood. base_radius, where it is given, decides instead."
            ),
            see_also(&["width", "base_radius", "radius_exponent", "contract"])
        ),
        field!(
            "noise_filter",
            Kind::Switch,
            "",
            "points of a scan that hardly any others are near are left out",
            noise_filter,
            details(
                "Noise is what has fewer than three points within 2.5 steps, in a dense cloud fewer than 2 \
                 % of the median. A cloud that would lose more than one point in 25 is thin rather than \
                 noisy and stays whole. false keeps twigs that few pulses hit."
            ),
            see_also(&["contract", "step"])
        ),
        field!(
            "stems",
            real_or_auto(1.0, 1000.0),
            "stems",
            "stems of a scan, each with a root; auto: those that stand clearly apart on the ground",
            stems,
            details(
                "auto looks between 4.5 and 11 % of the height for slim columns of points that stand apart \
                 and have at least a fifth of the points of the strongest. Say 1 where a leaning limb is \
                 taken for a second stem; a larger number is the most that is looked for."
            ),
            see_also(&["root", "contract"])
        ),
        field!(
            "scale",
            real_or_auto(1e-6, 1e6),
            "m",
            "metres for a unit of given points; auto: 1, for a scan 0.01 or 0.001 where 1 would make it higher than trees are",
            scale,
            details(
                "Everything in linden is metres, while scanners also write centimetres and millimetres. \
                 auto takes the file's unit for a metre up to a height of 150, for a centimetre up to 4000, \
                 else for a millimetre, and says so in a note."
            ),
            see_also(&["up", "origin", "step"])
        ),
        field!(
            "thin",
            real(0.0, 1000.0),
            "",
            "the first point in each cube with sides of this length is kept, in the file's units; 0: all points are",
            thin,
            details(
                "For clouds that are larger than the memory: LAS, LAZ, E57 and tables of points are thinned while they are \
                 read, so that only what is kept is ever held. 0.01 (a centimetre, where the file is in metres) leaves most \
                 of what a scan from a distance shows; fine twigs thin out first. docs/scans.md says what it costs."
            ),
            see_also(&["step", "noise_filter", "scale"])
        ),
    ];

    /// Points of a file, with everything else at its default.
    pub fn of(file: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            instance: None,
            segmentation: Segmentation::Column,
            tree: None,
            growth: GrowthSettings::default(),
            contract: true,
            leaf_points: LeafPoints::Auto,
            scan_radius: ScanRadius::Points,
            noise_filter: true,
            stems: None,
            scale: None,
            thin: 0.0,
        }
    }

    pub(crate) fn all_knobs() -> Vec<Knob> {
        let growth = GrowthSettings::FIELDS.iter().map(|field| field.knob);
        let place = GrowthSettings::PLACE_FIELDS.iter().map(|field| field.knob);
        growth.chain(Self::FIELDS.iter().map(|field| field.knob)).chain(place).collect()
    }

    pub(crate) fn turned(&self) -> Vec<(Knob, Value)> {
        let mut all = values(GrowthSettings::FIELDS, &self.growth);
        all.extend(values(Self::FIELDS, self));
        all.extend(values(GrowthSettings::PLACE_FIELDS, &self.growth));
        all
    }

    pub(crate) fn turn(&mut self, name: &str, value: Value) -> bool {
        set(Self::FIELDS, self, name, value.clone())
            || set(GrowthSettings::FIELDS, &mut self.growth, name, value.clone())
            || set(GrowthSettings::PLACE_FIELDS, &mut self.growth, name, value)
    }

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub(crate) fn why_idle(&self, knob: &str, wood: &Wood) -> Option<&'static str> {
        let is_ruled = matches!(wood.width, Width::Pipe | Width::Order | Width::Taper);
        match knob {
            "noise_filter" | "stems" | "leaf_points" if !self.contract => {
                Some("contract=false: the points are no scan")
            }
            "scan_radius" if is_ruled => Some("it is for width=auto"),
            "scan_radius" if !self.contract => Some("contract=false: the points are no bark"),
            "scan_radius" if wood.base_radius_m.is_some() => {
                Some("base_radius decides how thick the wood is")
            }
            _ => self.growth.idle(knob),
        }
    }

    /// Whether the points on the bark may say how thick the wood is.
    pub(crate) fn measures(&self, wood: &Wood) -> bool {
        self.contract && self.scan_radius == ScanRadius::Points && wood.base_radius_m.is_none()
    }
}
