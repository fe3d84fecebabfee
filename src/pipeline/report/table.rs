//! The table of numbers.
//!
//! A new number is a row here, and whatever it is read from in [`Figures`].

use serde::{Deserialize, Serialize};

use super::figures::Figures;
use super::{Corners, Reading};
use crate::provenance::hash_text;
use crate::recipe::VERSION;
use linden_skeleton::BREAST_HEIGHT_M;

/// Where a number stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Group {
    /// Which tree it is.
    Tree,
    /// How large it is.
    Size,
    /// Its stem.
    Stem,
    /// Its crown.
    Crown,
    /// Its wood.
    Wood,
    /// How it branches.
    Branching,
    /// Its leaves.
    Leaves,
    /// Its mesh.
    Surface,
    /// How it grew.
    Growth,
}

impl Group {
    /// All groups, in their order.
    pub const ALL: [Self; 9] = [
        Self::Tree,
        Self::Size,
        Self::Stem,
        Self::Crown,
        Self::Wood,
        Self::Branching,
        Self::Leaves,
        Self::Surface,
        Self::Growth,
    ];

    /// Its name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tree => "tree",
            Self::Size => "size",
            Self::Stem => "stem",
            Self::Crown => "crown",
            Self::Wood => "wood",
            Self::Branching => "branching",
            Self::Leaves => "leaves",
            Self::Surface => "surface",
            Self::Growth => "growth",
        }
    }
}

/// What a number is of, and so what must be made before it can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Of {
    /// The axial tree: nodes and their radii.
    Wood,
    /// Leaves as they are dressed, with their pictures.
    Leaves,
    /// Both.
    All,
    /// The mesh of the wood and of everything on it.
    Surface,
    /// How it grew.
    Growth,
}

impl Of {
    /// What is included.
    pub const fn includes(self) -> &'static str {
        match self {
            Self::Wood => {
                "the wood: nodes and segments, and where it has a thickness the tubes that the surface makes of them; no leaves, no roots on the ground and no stubs"
            }
            Self::Leaves => {
                "leaves of the preset and leaves, needles and polygons of the grammar; no blossom, no fruit"
            }
            Self::All => {
                "the axial tree, and the meshes of leaves, blossom and fruit with what pictures cut out of them"
            }
            Self::Surface => "the mesh as it is exported: wood, leaves, blossom and fruit",
            Self::Growth => "how the tree grew",
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Number {
    /// As `--json`, columns and [`Report`] name it.
    pub name: &'static str,
    /// Its name for people, within its group.
    pub label: &'static str,
    /// Where it stands.
    pub group: Group,
    /// Empty for counts, shares and words.
    pub unit: &'static str,
    /// What is included.
    pub of: Of,
    /// Definition, with its formula.
    pub meaning: &'static str,
    /// Where the definition is from; empty for what needs none.
    pub source: &'static str,
    /// Its value in a report.
    #[serde(skip)]
    pub reading: fn(&Report) -> Reading,
}

macro_rules! numbers {
    ($($name:ident: $type:ty, $group:ident $label:literal [$unit:literal] $of:ident
       $meaning:literal ($source:literal) = |$figures:ident| $value:expr;)*) => {
        /// The numbers of one tree. What does not apply is `None`, null in JSON.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[non_exhaustive]
        pub struct Report {
            $(
                #[doc = concat!($meaning, ".")]
                pub $name: $type,
            )*
        }

        impl Report {
            pub(super) fn read(figures: &Figures<'_>) -> Self {
                $(
                    let $figures = figures;
                    let $name: $type = $value;
                )*
                Self { $($name),* }
            }
        }

        /// All numbers, in the order in which they are shown.
        pub const NUMBERS: &[Number] = &[$(
            Number {
                name: stringify!($name),
                label: $label,
                group: Group::$group,
                unit: $unit,
                of: Of::$of,
                meaning: $meaning,
                source: $source,
                reading: |report| (&report.$name).into(),
            },
        )*];
    };
}

numbers! {
    tree: String, Tree "shown" [""] Growth
        "which tree the numbers are of: whole, or reduced to its budget of triangles"
        ("") = |f| (if f.is_reduced { "reduced" } else { "whole" }).to_owned();
    skeleton_hash: String, Tree "skeleton hash" [""] Wood
        "XXH3 (128 bits) of the whole tree's nodes, parents, radii, births and axes, whatever budget it is shown with: equal for equal trees"
        ("") = |f| hash_text(f.grown.skeleton.hash());
    organs_hash: String, Tree "organs hash" [""] All
        "XXH3 (128 bits) of everything that grows on the whole tree, in its order: outlines, places, directions, sizes, shapes, nodes and births: equal for equal leaves and other organs"
        ("") = |f| hash_text(f.grown.organs.hash());
    recipe_hash: String, Tree "recipe hash" [""] Growth
        "XXH3 (128 bits) of the recipe as JSON without white space, keys sorted, without names and version: everything that decides the tree and its looks, files included"
        ("") = |f| hash_text(f.recipe_hash);
    linden_version: String, Tree "linden" [""] Growth
        "the version of linden, with the commit that it was built from where that is known"
        ("") = |_f| VERSION.to_owned();

    height_m: f64, Size "height" ["m"] Wood
        "the highest node above the lowest"
        ("") = |f| f.measures.height_m;
    height_with_leaves_m: f64, Size "with leaves" ["m"] All
        "the highest point of nodes and leaves above the lowest node"
        ("") = |f| f.height_with_leaves_m();
    total_length_m: f64, Size "total length" ["m"] Wood
        "the sum of all segments"
        ("") = |f| f.measures.total_length_m;
    path_length_mean_m: f64, Size "mean path" ["m"] Wood
        "the length of the wood from the foot to a tip, averaged over all tips"
        ("") = |f| f.path_mean_m;
    path_length_longest_m: f64, Size "longest path" ["m"] Wood
        "the greatest length of the wood from the foot to a tip"
        ("") = |f| f.path_longest_m;
    nodes: usize, Size "nodes" [""] Wood
        "nodes, feet of stems included"
        ("") = |f| f.skeleton.positions.len();
    segments: usize, Size "segments" [""] Wood
        "pairs of a node and its parent"
        ("") = |f| f.skeleton.segments();

    trunk_diameter_m: f64, Stem "diameter" ["m"] Wood
        "of the stem that is thickest at its foot, trunk_diameter_at_m above it, as its tube has it, with a flare that reaches there: of the circle with as much area; between two rings by linear interpolation. At breast height of a scan it is the measured radii's, as cylinders have them (format qsm), whatever surface lies on them"
        ("") = |f| f.dbh_m().unwrap_or(f.tubes.base_diameter_m);
    trunk_diameter_at_m: f64, Stem "measured at" ["m"] Wood
        "where trunk_diameter_m is measured, from the foot along the stem (straight from the foot on a scan, whose axis goes to and fro between buttresses) and, where a grammar ends that at a fork, along the thickest of what leaves there: 1.3, or 0 for a stem that is shorter"
        ("") = |f| f.dbh_m().map_or(0.0, |_| BREAST_HEIGHT_M);
    dbh_m: Option<f64>, Stem "at breast height" ["m"] Wood
        "diameter at breast height: trunk_diameter_m, with a flare that reaches there but for a scan, where that is at 1.3 m, null for a shorter stem"
        ("West 2015, Tree and Forest Measurement") = |f| f.dbh_m();
    dbh_se_m: Option<f64>, Stem "its standard error" ["m"] Wood
        "standard error of dbh_m: twice that of the radius at the nearest node, by the noise of its circle and the part of the turn that was seen, by how the circles above and below scatter, and by what no circle explains; null where that was not measured on a scan"
        ("Chernov 2010, Circular and Linear Regression") = |f| f.breast_fit.map(|fit| 2.0 * f64::from(fit.se_m));
    dbh_arc_deg: Option<f64>, Stem "seen of its turn" ["°"] Wood
        "how much of the turn the points of that circle cover; null where there is none"
        ("") = |f| f.breast_fit.map(|fit| fit.arc_deg());
    dbh_source: Option<String>, Stem "is" [""] Wood
        "where dbh_m of a scan is from: measured on points, carried on between nodes that were, or guessed by the wood that the stem bears, as all is where no circle is believed; null for what is no scan"
        ("") = |f| f.breast_source.map(|source| source.word().to_owned());
    stem_lean_deg: f64, Stem "lean" ["°"] Wood
        "the angle between the upright and the line from the foot of the stem that is thickest there to where it reaches half of the height of the tree, or to its top where that is lower"
        ("West 2015") = |f| f.stem_lean_deg();
    stem_volume_m3: f64, Stem "volume" ["m³"] Wood
        "wood_volume_m3 of the stem that is thickest at its foot, from there to its top"
        ("West 2015") = |f| f.tubes.stem_volume_m3;
    stem_count: usize, Stem "stems" [""] Wood
        "axes that nothing bears, wherever they begin"
        ("") = |f| f.stem_count();
    dbh_by_stem_m: Vec<f64>, Stem "of each stem" ["m"] Wood
        "diameter at breast height of each stem that reaches it, from the thickest to the thinnest, as cylinders have it (format qsm), without a flare: of a coppice, a shrub or several trees. Breast height is 1.3 m above the foot of each; at forks the thickest is followed"
        ("West 2015") = |f| f.stem_diameters_m.clone();
    base_diameter_m: f64, Stem "at the foot" ["m"] Wood
        "of the stem that is thickest at its foot, there, as its tube has it, with its flare"
        ("") = |f| f.tubes.base_diameter_m;

    crown_width_m: f64, Crown "width" ["m"] Wood
        "the distance of two parallel upright planes that enclose all nodes, averaged over all directions: perimeter of their convex hull seen from above ÷ π"
        ("Cauchy 1841; Santaló 2004, Integral Geometry and Geometric Probability") = |f| f.wood.plan.mean_width();
    crown_width_least_m: f64, Crown "least width" ["m"] Wood
        "the least of these distances"
        ("") = |f| f.wood.plan.least_width();
    crown_width_most_m: f64, Crown "greatest width" ["m"] Wood
        "the greatest of these distances"
        ("") = |f| f.wood.plan.most_width();
    crown_projection_m2: f64, Crown "projection" ["m²"] Wood
        "area of the convex hull of all nodes seen from above"
        ("Pretzsch 2009, Forest Dynamics, Growth and Yield") = |f| f.wood.plan.area();
    crown_volume_m3: f64, Crown "volume" ["m³"] Wood
        "volume of the convex hull of the nodes that are not below the crown's base"
        ("Zhu, Kleinn & Nölke 2021, Assessing tree crown volume: a review") = |f| f.wood.solid.volume();
    crown_width_with_leaves_m: f64, Crown "width with leaves" ["m"] All
        "as crown_width_m, of nodes and leaves"
        ("") = |f| f.all.plan.mean_width();
    crown_width_least_with_leaves_m: f64, Crown "least width with leaves" ["m"] All
        "as crown_width_least_m, of nodes and leaves"
        ("") = |f| f.all.plan.least_width();
    crown_width_most_with_leaves_m: f64, Crown "greatest width with leaves" ["m"] All
        "as crown_width_most_m, of nodes and leaves"
        ("") = |f| f.all.plan.most_width();
    crown_projection_with_leaves_m2: f64, Crown "projection with leaves" ["m²"] All
        "as crown_projection_m2, of nodes and leaves"
        ("") = |f| f.all.plan.area();
    crown_volume_with_leaves_m3: f64, Crown "volume with leaves" ["m³"] All
        "as crown_volume_m3, of these nodes and all leaves"
        ("") = |f| f.all.solid.volume();
    crown_base_m: Option<f64>, Crown "base" ["m"] All
        "height above the lowest node at which the lowest leaf is attached; of a tree without leaves, at which the lowest lateral of a stem leaves that is at least a twentieth of height_m long (of any length where none is); null where there is neither"
        ("US Forest Service, FIA Field Guide, uncompacted live crown ratio: the lowest live foliage") = |f| f.crown_base_m();

    wood_volume_m3: f64, Wood "volume" ["m³"] Wood
        "the sum of π r² l over the tubes of all axes between each two of their rings, as cylinders with the volume of the frustum, round, with flare, collars, smoothing, taper and ends, as the mesh has them; a lateral begins on its parent's centre line, and what overlaps at forks is counted twice"
        ("Raumonen et al. 2013, Fast automatic precision tree models from terrestrial laser scanner data") = |f| f.sum_of_orders(|order| order.volume_m3);
    cylinder_volume_m3: f64, Wood "volume of cylinders" ["m³"] Wood
        "the sum of π r² l over the cylinders of a table (format qsm), one for each segment: the skeleton alone, without flare, collars, smoothing and taper of twigs"
        ("Raumonen et al. 2013") = |f| f.measures.wood_volume_m3;
    wood_area_m2: f64, Wood "surface" ["m²"] Wood
        "the sum of 2 π r l over the same cylinders as wood_volume_m3"
        ("Raumonen et al. 2013") = |f| f.sum_of_orders(|order| order.area_m2);
    length_by_order_m: Vec<f64>, Wood "length by order" ["m"] Wood
        "total length of the axes of each order, from order 0 (stems) on"
        ("") = |f| f.tubes.by_order.iter().map(|order| order.length_m).collect();
    wood_volume_by_order_m3: Vec<f64>, Wood "volume by order" ["m³"] Wood
        "wood_volume_m3 of the axes of each order"
        ("") = |f| f.tubes.by_order.iter().map(|order| order.volume_m3).collect();
    wood_area_by_order_m2: Vec<f64>, Wood "surface by order" ["m²"] Wood
        "wood_area_m2 of the axes of each order"
        ("") = |f| f.tubes.by_order.iter().map(|order| order.area_m2).collect();
    wood_volume_by_diameter_m3: Vec<f64>, Wood "volume by diameter" ["m³"] Wood
        "wood_volume_m3 of cylinders of a diameter below 1, 2, 4, 7, 10, 20, 50 cm, and from 50 cm on: each class begins where the one before ends; from 7 cm on wood counts as merchantable"
        ("Pretzsch 2009") = |f| f.tubes.by_diameter_m3.clone();

    measured_volume_share: Option<f64>, Wood "share measured" [""] Wood
        "the share of cylinder_volume_m3 whose radii were measured on the points of a scan; the others were carried on or guessed; 0 of a scan without a measured one, null for what is no scan"
        ("Morales & MacFarlane 2024, Reducing tree volume overestimation in quantitative structure models") = |f| f.measured_volume_share();

    axes: usize, Branching "axes" [""] Wood
        "chains of segments from a base to an apex: stems and laterals; of a tree that was grown from a scan more than it has"
        ("Prusinkiewicz & Lindenmayer 1990, The Algorithmic Beauty of Plants, 1.6.1") = |f| f.skeleton.axes.len();
    max_order: u32, Branching "highest order" [""] Wood
        "the highest order of an axis: 0 is a stem, a lateral has one more than the axis that bears it"
        ("Prusinkiewicz & Lindenmayer 1990, 1.6.1") = |f| f.measures.max_order;
    tips: usize, Branching "tips" [""] Wood
        "nodes that end a segment and bear none"
        ("") = |f| f.tips;
    branching_angle_mean_deg: Option<f64>, Branching "angle" ["°"] Wood
        "the angle between a lateral's first segment and the segment of the parent axis that ends where it leaves, averaged over all laterals; 0 is straight on. Of a tree that was grown from a scan too large: the first segment leads out of the middle of what bears it"
        ("Raumonen et al. 2013") = |f| f.angles.mean;
    branching_angle_sd_deg: Option<f64>, Branching "spread of the angle" ["°"] Wood
        "standard deviation of that angle over all laterals, as of a sample (n − 1)"
        ("") = |f| f.angles.sd;
    laterals_by_order: Vec<usize>, Branching "laterals by order" [""] Wood
        "laterals whose angle is known, of each order from 1 on"
        ("") = |f| f.angles_by_order.iter().map(|angles| angles.count).collect();
    branching_angle_by_order_deg: Vec<f64>, Branching "angle by order" ["°"] Wood
        "branching_angle_mean_deg of the laterals of each order from 1 on; 0 where there is none"
        ("") = |f| f.angles_by_order.iter().map(|angles| angles.mean.unwrap_or(0.0)).collect();
    branching_angle_sd_by_order_deg: Vec<f64>, Branching "its spread by order" ["°"] Wood
        "branching_angle_sd_deg of the laterals of each order from 1 on; 0 for fewer than two"
        ("") = |f| f.angles_by_order.iter().map(|angles| angles.sd.unwrap_or(0.0)).collect();
    strahler_order: usize, Branching "Strahler order" [""] Wood
        "the highest order of Strahler of a segment: 1 for one that bears nothing, else the highest above it, and one more where two or more have that"
        ("Strahler 1957, Quantitative analysis of watershed geomorphology") = |f| f.streams.len();
    stream_counts: Vec<usize>, Branching "streams by Strahler order" [""] Wood
        "N_ω, chains of segments of the same order of Strahler ω, of each order from 1 on"
        ("Horton 1945, Erosional development of streams and their drainage basins") = |f| f.streams.iter().map(|stream| stream.count).collect();
    stream_lengths_m: Vec<f64>, Branching "mean length of streams" ["m"] Wood
        "L_ω, mean length of the streams of each order from 1 on"
        ("Horton 1945") = |f| f.streams.iter().map(|stream| stream.mean_length_m).collect();
    bifurcation_ratio: Option<f64>, Branching "bifurcation ratio" [""] Wood
        "R_B = exp(−b), b the slope of the regression of ln N_ω on ω over all orders; null for fewer than two"
        ("Horton 1945; Barker, Cumming & Horsfield 1973, Quantitative morphometry of the branching structure of trees") = |f| f.stream_ratios()[0];
    length_ratio: Option<f64>, Branching "length ratio" [""] Wood
        "R_L = exp(b), b the slope of the regression of ln L_ω on ω over all orders; null for fewer than two"
        ("Horton 1945; Barker, Cumming & Horsfield 1973") = |f| f.stream_ratios()[1];

    leaves: usize, Leaves "organs" [""] All
        "places where an organ stands: a leaf, a card with a whole twig, a blossom, a fruit"
        ("") = |f| f.organs;
    leaf_count: usize, Leaves "leaves" [""] Leaves
        "leaves, a card with a twig of twig_leaves as so many; a conifer's shoot and a frond count as one"
        ("") = |f| f.canopy.leaves();
    organ_kinds: Vec<String>, Leaves "kinds" [""] All
        "the kinds of organs that there are: of a preset's by the outline of their picture (mesh or picture for the user's), of a grammar's leaf, blossom, berry, needle and polygon"
        ("") = |f| f.canopy.crops.iter().map(|crop| crop.name.clone()).collect();
    organs_by_kind: Vec<usize>, Leaves "organs by kind" [""] All
        "leaves (the number of organs) of each of organ_kinds"
        ("") = |f| f.canopy.crops.iter().map(|crop| crop.organs).collect();
    leaf_count_by_kind: Vec<usize>, Leaves "leaves by kind" [""] Leaves
        "leaf_count of each of organ_kinds; 0 for blossom and fruit"
        ("") = |f| f.canopy.crops.iter().map(|crop| if crop.is_leaf { crop.organs * crop.leaves_each as usize } else { 0 }).collect();
    area_by_kind_m2: Vec<f64>, Leaves "area by kind" ["m²"] All
        "opaque area of each of organ_kinds, as leaf_area_m2"
        ("") = |f| f.canopy.crops.iter().map(|crop| crop.area_m2).collect();
    sheets_by_kind: Vec<u32>, Leaves "sheets by kind" [""] All
        "how often an organ of each of organ_kinds draws each of its leaves, on sheets that cross: area_by_kind_m2 ÷ this counts each leaf once"
        ("") = |f| f.canopy.crops.iter().map(|crop| crop.sheets).collect();
    leaf_area_m2: f64, Leaves "area" ["m²"] Leaves
        "one side of all triangles of leaves, as far as their picture leaves them opaque (alpha of one half and more, counted by pixels); twigs drawn on the picture and every one of crossing sheets are included"
        ("Watson 1947, Comparative physiological studies on the growth of field crops: one side") = |f| f.canopy.leaf_area_m2();
    leaf_area_once_m2: f64, Leaves "each leaf once" ["m²"] Leaves
        "leaf_area_m2 with the area of each kind divided by its sheets_by_kind: ÷ leaf_count it is the mean area of a leaf"
        ("") = |f| f.canopy.leaf_area_once_m2();
    leaf_area_index: Option<f64>, Leaves "area index" [""] Leaves
        "leaf_area_once_m2 ÷ crown_projection_with_leaves_m2; null without leaves"
        ("Watson 1947, over the ground that the crown covers") = |f| f.leaf_area_index();
    leaf_inclination_mean_deg: Option<f64>, Leaves "mean inclination" ["°"] Leaves
        "the angle between a blade and the level, averaged over leaf_area_once_m2: 0 level, 90 upright; of the crossing sheets of a leaf the first is the blade, the two of a twig (leaf_form=twig) stand for its leaves"
        ("Ross 1981, The radiation regime and architecture of plant stands") = |f| f.inclination_mean_deg();
    leaf_inclination_shares: Option<Vec<f64>>, Leaves "inclination, 10° classes" [""] Leaves
        "shares of leaf_area_once_m2 with an inclination of 0 to 10, 10 to 20, … 80 to 90 degrees: nine that add up to 1"
        ("Ross 1981") = |f| f.inclination_shares();
    g_function: Option<Vec<f64>>, Leaves "G, from 0° to 90°" [""] Leaves
        "G(θ), the mean projection of a unit of leaf area on a plane square to a direction θ off the upright, for θ of 0, 10, … 90 degrees, by the inclinations (classes of 0.1°) of leaves that face all compass directions alike"
        ("Ross 1981; Warren Wilson 1960, Inclined point quadrats") = |f| f.projections();
    leaf_layer_m: Option<f64>, Leaves "layer" ["m"] Leaves
        "a tenth of the height from the lowest node to the highest point of a leaf: the thickness of a layer"
        ("") = |f| f.layer_m();
    leaf_area_density_m2_per_m3: Option<Vec<f64>>, Leaves "area density by layer" ["m²/m³"] Leaves
        "leaf_area_once_m2 in each of ten layers of leaf_layer_m, from the lowest, ÷ (leaf_layer_m × crown_projection_with_leaves_m2); triangles belong where their middle is"
        ("Béland et al. 2014, On seeing the wood from the leaves and the role of voxel size") = |f| f.leaf_area_density();

    triangles: usize, Surface "triangles" [""] Surface
        "triangles of the mesh"
        ("") = |f| f.survey.triangles + f.canopy.triangles;
    vertices: usize, Surface "vertices" [""] Surface
        "vertices of the mesh; one stands twice where pictures meet"
        ("") = |f| f.survey.vertices + f.canopy.vertices;
    watertight: bool, Surface "closed" [""] Surface
        "whether every tube of wood is closed and consistently wound"
        ("") = |f| f.survey.topology.watertight();
    bounds: Corners, Surface "box" ["m"] Surface
        "the box around the mesh: its smallest and its largest x, y, z (y is up)"
        ("") = |f| f.bounds();

    symbols: Option<u64>, Growth "symbols" [""] Growth
        "length of the derived string; null for what is no L-system"
        ("") = |f| f.grown.symbols;
    points: Option<usize>, Growth "points" [""] Growth
        "attraction points; null for what grows without"
        ("") = |f| f.grown.colonized.as_ref().map(|colonized| colonized.points.len());
    points_unreached: Option<usize>, Growth "points not reached" [""] Growth
        "attraction points that no branch came near enough to"
        ("") = |f| f.grown.colonized.as_ref().map(|colonized| colonized.unreached);
    iterations: Option<u32>, Growth "iterations" [""] Growth
        "rounds of growth by space colonization"
        ("Runions, Lane & Prusinkiewicz 2007, Modeling trees with a space colonization algorithm") = |f| f.grown.colonized.as_ref().map(|colonized| colonized.iterations);
    canopy: Option<bool>, Growth "canopy" [""] Growth
        "whether a scan was a crown without a stem, so that all radii are guessed; null for what is no scan"
        ("") = |f| f.grown.colonized.as_ref()
            .filter(|colonized| colonized.is_canopy || colonized.scan.is_some())
            .map(|colonized| colonized.is_canopy);
}
