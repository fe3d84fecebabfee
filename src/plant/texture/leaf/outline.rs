//! The table of leaf outlines: their names, and the usual leaf of each.

/// The shape of a leaf, as it is seen from far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outline {
    /// Egg-shaped, widest below the middle: beech, pear.
    #[default]
    Ovate,
    /// Egg-shaped, widest above the middle: alder, magnolia.
    Obovate,
    /// Widest in the middle: an ellipse.
    Elliptic,
    /// Long, widest in the lower third, drawn out into its tip: willow, peach.
    Lanceolate,
    /// Long with parallel edges: rosemary, bamboo.
    Linear,
    /// A heart: lime (Tilia), Judas tree.
    Cordate,
    /// Round: aspen, hazel.
    Orbicular,
    /// A rhombus: silver birch.
    Rhombic,
    /// A triangle: black poplar.
    Deltoid,
    /// Rounded lobes on both sides of a midrib: oak. `lobes` are those of one side.
    Lobed,
    /// Pointed lobes around the petiole: maple, plane. `lobes` are all of them.
    Palmate,
    /// Leaflets around the petiole: horse chestnut. `lobes` are the leaflets.
    Fan,
    /// Leaflets along a rachis and one at its end: ash, walnut. `lobes` are the pairs.
    Pinnate,
    /// Fine leaflets along the branches of a rachis: acacia, jacaranda. `lobes` are the branches of a
    /// side.
    Bipinnate,
    /// A long feather of narrow leaflets: palm. `lobes` are the pairs.
    Palm,
    /// A frond of pinnae that are lobed themselves: fern. `lobes` are the pairs.
    Fern,
    /// One needle.
    Needle,
    /// The end of a shoot with long needles in pairs: pine. `lobes` are the needles.
    Pine,
    /// A shoot with short needles on all sides: spruce, fir. `lobes` are the needles.
    Spruce,
    /// A shoot with tufts of needles on short shoots: larch, cedar. `lobes` are the tufts.
    Larch,
    /// A flat spray of scales: cypress, thuja. `lobes` are its branches.
    Scale,
    /// A flower seen from above. `lobes` are its petals.
    Blossom,
    /// Round fruit on stalks: cherry, apple. `lobes` are how many.
    Fruit,
    /// One petal: clusters of them are flowers that are seen from all sides, magnolia, tulip.
    Petal,
}

impl Outline {
    /// Whether [`super::LeafLook::lobes`] are drawn.
    pub fn has_lobes(self) -> bool {
        self.usual().lobes > 0 && self != Self::Needle
    }

    /// Whether [`super::LeafLook::lobe_depth`] is drawn.
    pub fn has_bays(self) -> bool {
        self.usual().lobe_depth > 0.0
    }

    /// Whether [`super::LeafLook::margin`] is drawn: leaflets of a few outlines have one of their kind.
    pub const fn has_margin(self) -> bool {
        !matches!(
            self,
            Self::Bipinnate
                | Self::Palm
                | Self::Fern
                | Self::Needle
                | Self::Pine
                | Self::Spruce
                | Self::Larch
                | Self::Scale
                | Self::Blossom
                | Self::Fruit
                | Self::Petal
        )
    }

    /// Whether [`super::LeafLook::petiole`] is drawn.
    pub const fn has_petiole(self) -> bool {
        !matches!(self, Self::Needle | Self::Pine | Self::Spruce | Self::Larch | Self::Scale)
    }

    /// The usual share of scattered light that leaves on the other side. Broad leaves transmit about as much
    /// as they reflect; needles are thicker (Hovi, Raitio & Rautiainen 2017, Silva Fennica 51:7753: albedo and
    /// transmittance of leaves and needles of 25 boreal species), and scales lie on a twig.
    pub const fn translucency(self) -> f32 {
        match self {
            Self::Needle | Self::Pine | Self::Spruce => 0.2,
            Self::Larch => 0.3,
            Self::Scale => 0.1,
            Self::Fruit => 0.0,
            _ => 0.45,
        }
    }
}

/// The shape of a blade's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Margin {
    /// Without teeth.
    #[default]
    Entire,
    /// Teeth that point to the tip.
    Serrate,
    /// Teeth with smaller ones on their backs: birch, elm, cherry.
    Doubly,
    /// Rounded teeth.
    Crenate,
}

impl Margin {
    /// Every margin: its name for users, and what it looks like.
    pub const ALL: [(&'static str, Self, &'static str); 4] = [
        ("entire", Self::Entire, "without teeth"),
        ("serrate", Self::Serrate, "teeth that point to the tip"),
        ("doubly", Self::Doubly, "teeth on teeth, as birch and elm"),
        ("crenate", Self::Crenate, "rounded teeth"),
    ];
}

/// How veins run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Veins {
    /// From a midrib to both sides.
    #[default]
    Pinnate,
    /// From the petiole into the lobes.
    Palmate,
    /// Side by side from foot to tip.
    Parallel,
    /// None that shows.
    None,
}

impl Veins {
    /// All patterns: the name for users, and what it looks like.
    pub const ALL: [(&'static str, Self, &'static str); 4] = [
        ("pinnate", Self::Pinnate, "from a midrib to both sides"),
        ("palmate", Self::Palmate, "from the petiole into the lobes"),
        ("parallel", Self::Parallel, "side by side from foot to tip"),
        ("none", Self::None, "none that shows"),
    ];
}

/// The usual leaf of an outline. See [`super::LeafLook`].
pub(super) struct Usual {
    pub width: f32,
    pub lobes: u32,
    pub lobe_depth: f32,
    pub margin: Margin,
    pub teeth: u32,
    pub tooth_depth: f32,
    pub petiole: f32,
    pub veins: Veins,
    pub colors: &'static [[u8; 3]],
    pub autumn_colors: &'static [[u8; 3]],
}

// A leaf's colour is all that it scatters, to both sides (`Translucency`): for green leaves some 9, 23 and 5 % of
// red, green and blue light (Hovi, Raitio & Rautiainen 2017), about twice what its upper side alone reflects.
/// Broad leaves in summer.
const GREENS: &[[u8; 3]] = &[[86, 124, 60], [98, 136, 66], [78, 115, 58], [109, 142, 70]];
/// Needles.
const DARK_GREENS: &[[u8; 3]] = &[[60, 95, 58], [69, 106, 64], [53, 88, 58], [78, 113, 66]];
/// Yellow that goes brown: most trees.
const YELLOWS: &[[u8; 3]] = &[[188, 176, 52], [214, 168, 40], [176, 120, 44], [122, 84, 48]];
/// Orange and red that go brown.
const REDS: &[[u8; 3]] = &[[206, 164, 44], [212, 106, 36], [176, 52, 34], [112, 60, 42]];

/// White with a breath of pink.
const PETALS: &[[u8; 3]] = &[[250, 240, 240], [252, 232, 236]];
const CHERRIES: &[[u8; 3]] = &[[150, 20, 26], [176, 30, 30]];

/// What most leaves share.
const LEAF: Usual = Usual {
    width: 0.6,
    lobes: 0,
    lobe_depth: 0.0,
    margin: Margin::Entire,
    teeth: 20,
    tooth_depth: 0.02,
    petiole: 0.12,
    veins: Veins::Pinnate,
    colors: GREENS,
    autumn_colors: YELLOWS,
};

/// What most conifers share.
const NEEDLES: Usual =
    Usual { colors: DARK_GREENS, autumn_colors: &[], veins: Veins::None, petiole: 0.0, ..LEAF };

impl Outline {
    /// Every outline: its name for users, and what it looks like.
    pub const ALL: [(&'static str, Self, &'static str); 24] = [
        ("ovate", Self::Ovate, "egg-shaped, widest below the middle, as beech and pear"),
        ("obovate", Self::Obovate, "egg-shaped, widest above the middle, as alder"),
        ("elliptic", Self::Elliptic, "an ellipse"),
        ("lanceolate", Self::Lanceolate, "long, drawn out into a tip, as willow and peach"),
        ("linear", Self::Linear, "long with parallel edges, as bamboo"),
        ("cordate", Self::Cordate, "a heart, as lime (Tilia)"),
        ("orbicular", Self::Orbicular, "round, as aspen and hazel"),
        ("rhombic", Self::Rhombic, "a rhombus, as silver birch"),
        ("deltoid", Self::Deltoid, "a triangle, as black poplar"),
        ("lobed", Self::Lobed, "rounded lobes on both sides, as oak"),
        ("palmate", Self::Palmate, "pointed lobes around the petiole, as maple and plane"),
        ("fan", Self::Fan, "leaflets around the petiole, as horse chestnut"),
        ("pinnate", Self::Pinnate, "leaflets along a rachis, as ash and walnut"),
        ("bipinnate", Self::Bipinnate, "fine leaflets along the branches of a rachis, as acacia"),
        ("palm", Self::Palm, "a long feather of narrow leaflets"),
        ("fern", Self::Fern, "a frond of lobed pinnae"),
        ("needle", Self::Needle, "one needle"),
        ("pine", Self::Pine, "the end of a shoot with long needles in pairs"),
        ("spruce", Self::Spruce, "a shoot with short needles, as spruce and fir"),
        ("larch", Self::Larch, "a shoot with tufts of needles, as larch and cedar"),
        ("scale", Self::Scale, "a flat spray of scales, as cypress"),
        ("blossom", Self::Blossom, "a flower seen from above"),
        ("fruit", Self::Fruit, "round fruit on stalks, as cherry and apple"),
        (
            "petal",
            Self::Petal,
            "one petal, for flowers made of them, as magnolia, and for the scales of cones",
        ),
    ];

    /// The outline that a user means.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(word, _, _)| *word == name).map(|&(_, outline, _)| outline)
    }

    /// The usual leaf with this outline.
    pub(super) fn usual(self) -> Usual {
        let leaf = |width: f32, petiole: f32| Usual { width, petiole, ..LEAF };
        let toothed =
            |usual: Usual, margin, teeth, tooth_depth| Usual { margin, teeth, tooth_depth, ..usual };
        let lobed = |usual: Usual, lobes, lobe_depth| Usual { lobes, lobe_depth, ..usual };
        let parts = |usual: Usual, lobes| Usual { lobes, ..usual };
        let needles = |width: f32, lobes| Usual { width, lobes, ..NEEDLES };
        match self {
            Self::Ovate => leaf(0.62, 0.12),
            Self::Obovate => leaf(0.7, 0.12),
            Self::Elliptic => leaf(0.5, 0.12),
            Self::Lanceolate => toothed(leaf(0.17, 0.08), Margin::Serrate, 40, 0.003),
            Self::Linear => Usual { veins: Veins::Parallel, ..leaf(0.08, 0.03) },
            Self::Cordate => toothed(leaf(0.92, 0.3), Margin::Serrate, 28, 0.018),
            Self::Orbicular => toothed(leaf(1.0, 0.35), Margin::Crenate, 12, 0.02),
            Self::Rhombic => toothed(leaf(0.78, 0.25), Margin::Doubly, 10, 0.034),
            Self::Deltoid => toothed(leaf(0.95, 0.32), Margin::Crenate, 22, 0.012),
            Self::Lobed => Usual { autumn_colors: REDS, ..lobed(leaf(0.58, 0.05), 5, 0.5) },
            Self::Palmate => Usual {
                veins: Veins::Palmate,
                autumn_colors: REDS,
                ..toothed(lobed(leaf(1.15, 0.35), 5, 0.5), Margin::Serrate, 2, 0.1)
            },
            Self::Fan => toothed(parts(leaf(0.3, 0.35), 7), Margin::Doubly, 16, 0.014),
            Self::Pinnate => toothed(parts(leaf(0.32, 0.15), 5), Margin::Serrate, 18, 0.012),
            Self::Bipinnate => parts(leaf(0.3, 0.12), 9),
            Self::Palm => Usual { veins: Veins::Parallel, ..parts(leaf(0.05, 0.15), 40) },
            Self::Fern => parts(leaf(0.2, 0.12), 18),
            Self::Needle => needles(0.03, 1),
            Self::Pine => needles(0.025, 70),
            Self::Spruce => needles(0.08, 110),
            Self::Larch => Usual { autumn_colors: YELLOWS, colors: GREENS, ..needles(0.05, 9) },
            Self::Scale => needles(0.5, 9),
            Self::Blossom => Usual { colors: PETALS, autumn_colors: &[], ..parts(leaf(0.85, 0.0), 5) },
            Self::Petal => {
                Usual { colors: PETALS, autumn_colors: &[], veins: Veins::Parallel, ..leaf(0.55, 0.0) }
            }
            Self::Fruit => {
                Usual { colors: CHERRIES, veins: Veins::None, autumn_colors: &[], ..parts(leaf(0.9, 0.6), 2) }
            }
        }
    }
}
