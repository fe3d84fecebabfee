//! `[detail]`: how many triangles, and in how many levels.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real};

/// How much of the tree is shown from near and from far.
#[derive(Clone, Debug, PartialEq)]
pub struct DetailSettings {
    /// Triangles of the finest level; 0: all that there are.
    pub triangles: u64,
    /// Levels of triangles.
    pub lods: u32,
    /// Triangles of each level, finest first, in place of `triangles`, `lods` and `lod_ratio`; a single 0
    /// where these count.
    pub lod_triangles: Vec<f64>,
    /// Triangles of a level as a share of those of the one before.
    pub lod_ratio: f64,
    /// Whether branch cards stand for leaves where many would be left out.
    pub branch_cards: bool,
    /// Side of the cards' picture, pixels.
    pub card_size_px: u32,
    /// Upright planes of a last level, after those of triangles; 0: none.
    pub billboard: u32,
    /// Height of the planes' picture, pixels.
    pub billboard_size_px: u32,
}

impl DetailSettings {
    /// How many levels there will be at most, the planes included.
    pub fn levels(&self) -> usize {
        self.triangle_levels() + usize::from(self.billboard > 0)
    }

    /// How many levels of triangles there will be at most.
    pub fn triangle_levels(&self) -> usize {
        match self.budgets().len() {
            0 => self.lods.max(1) as usize,
            levels => levels,
        }
    }

    /// The budget of each level where each has one, finest first; else none.
    pub fn budgets(&self) -> Vec<u64> {
        let listed = self.lod_triangles.iter().any(|&budget| budget >= 1.0);
        if listed { self.lod_triangles.iter().map(|&budget| budget as u64).collect() } else { Vec::new() }
    }

    /// Whether there is one level of triangles, with everything.
    pub fn is_whole(&self) -> bool {
        self.finest() == 0 && self.triangle_levels() == 1
    }

    /// Takes back every budget of triangles, and with it all levels but one.
    pub fn ask_for_all(&mut self) {
        (self.triangles, self.lods, self.lod_triangles) = (0, 1, vec![0.0]);
    }

    /// The budget of the finest level; 0: all triangles that there are.
    pub fn finest(&self) -> u64 {
        self.budgets().first().copied().unwrap_or(self.triangles)
    }
}

impl Default for DetailSettings {
    /// One level, with everything.
    fn default() -> Self {
        Self {
            triangles: 0,
            lods: 1,
            lod_triangles: vec![0.0],
            lod_ratio: 0.33,
            branch_cards: true,
            card_size_px: 1024,
            billboard: 0,
            billboard_size_px: 1024,
        }
    }
}

/// The most levels of triangles.
pub(super) const MOST_LODS: usize = 8;

impl DetailSettings {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "triangles",
            integer(0, u32::MAX as u64),
            "",
            "budget of the finest level, met within 5 %; 0: all that there are",
            triangles,
            details(
                "Wood that is too thin to be seen goes first, then nodes and sides, and of the leaves an \
                 even share stays, enlarged to at most twice its size. Wood is thinned out more than \
                 leaves: from afar a crown is its leaves. Stems keep 10 sides from a budget of 15000 on, 8 from \
                 5000, 6 from 1500, else 5, as long as the sides knob is no lower. A budget below what the stem and one leaf need is \
                 refused. 50000 is a hero tree of a game, 5000 one of many."
            ),
            see_also(&["lods", "lod_triangles", "sides", "leaves_per_m"])
        ),
        field!(
            "lods",
            integer(1, MOST_LODS as u64),
            "",
            "levels of detail: the same tree with fewer triangles each time",
            lods,
            details(
                "All levels are the same tree, and the leaves of a coarser one are among those of the \
                 finer. Each has lod_ratio of the triangles before; where nothing is left to leave out \
                 there are fewer levels, and a note says so."
            ),
            see_also(&["lod_ratio", "lod_triangles", "triangles", "billboard"])
        ),
        field!(
            "lod_triangles",
            Kind::Reals { min: 0.0, max: u32::MAX as f64, most: MOST_LODS },
            "",
            "budget of each level, finest first, like 50000 15000 4000, in place of triangles, lods and lod_ratio; 0: as these say",
            lod_triangles,
            details("Numbers must fall. Levels that would be the whole tree are written once."),
            see_also(&["lods", "lod_ratio", "triangles"])
        ),
        field!(
            "lod_ratio",
            real(0.05, 0.9),
            "",
            "triangles of a level / triangles of the one before",
            lod_ratio,
            details(
                "0.33 makes each level a third of the one before. It also says when levels change: the \
                 first serves down to half of the picture's height, each further one down to the square \
                 root of the ratio times that, so that triangles a pixel stay about the same."
            ),
            see_also(&["lods", "triangles"])
        ),
        field!(
            "branch_cards",
            Kind::Switch,
            "",
            "pictures of twigs on crossed planes in place of leaves and twigs, where a budget would leave many of these out",
            branch_cards,
            details(
                "The tree's foliage is cut into pieces that hang together: twigs, branches or limbs, as large as the \
                 budget asks for. Some of them are drawn, with leaves and thin wood, into one picture with colour, \
                 alpha and normals, and stand for all. Without them leaves and twigs are left out evenly, and the leaves \
                 that stay are enlarged to at most twice their size."
            ),
            see_also(&["card_size", "triangles", "lods"])
        ),
        field!(
            "card_size",
            integer(128, 4096),
            "px",
            "side of the branch cards' picture, for all levels together",
            card_size_px,
            see_also(&["branch_cards", "leaf_size", "billboard_size"])
        ),
        field!(
            "billboard",
            integer(0, 4),
            "planes",
            "a last level of crossed planes with pictures of the tree; 0: none",
            billboard,
            details(
                "Upright planes through the trunk, with colours and normals of the tree drawn from the \
                 finest level; 1 vanishes when seen edge-on, 2 is the usual cross, 4 is fullest. It comes \
                 after all levels of triangles."
            ),
            see_also(&["billboard_size", "lods"])
        ),
        field!(
            "billboard_size",
            integer(64, 4096),
            "px",
            "height of the planes' picture",
            billboard_size_px,
            see_also(&["billboard", "leaf_size"])
        ),
    ];
}
