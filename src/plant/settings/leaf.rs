//! The knobs of leaves. One table of rows serves the first kind, all further ones, the command line, the
//! schema and the workbench.

use linden_base::field;
use linden_base::knob::{Field, FieldValue, Kind, Value, integer, names, real, real_or_auto};

use super::foliage::{Arrangement, Edge, FoliageSettings, Form, LeafKind, Normals};
use crate::season::SEASONS;
use crate::texture::leaf::Outline;

/// The most colours that one kind of organ has.
const MOST_COLORS: usize = 32;

/// The names of all outlines.
const OUTLINES: [&str; Outline::ALL.len()] = names(&Outline::ALL);

impl FieldValue for Outline {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, outline, _)| outline == self).map_or("", |(name, _, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        String::from_value(value).and_then(|name| Self::named(&name))
    }
}

/// The keys of a kind of organ, beside the files `leaf_mesh` and `leaf_picture`.
pub const LEAF_KNOBS: [Field<LeafKind>; 33] = [
    field!(
        "leaf_form",
        Kind::Choice(Form::WORDS),
        "",
        "what leaves are made of: nothing, one card, two crossed, a curved blade, a card with a whole twig, a fan of leaflets, a tuft of needles, the mesh of leaf_mesh",
        form
    ),
    field!(
        "leaf_outline",
        Kind::Choice(&OUTLINES),
        "",
        "shape of the drawn picture, of one leaf or of a shoot",
        outline
    ),
    field!(
        "leaf_length",
        real(5e-4, 10.0),
        "m",
        "length of a leaf from the foot of its stalk to its tip",
        length_m
    ),
    field!(
        "leaf_width",
        real_or_auto(5e-3, 4.0),
        "",
        "width of a blade / its length; auto: as usual for its outline",
        width
    ),
    field!(
        "leaf_size_spread",
        real(0.0, 0.95),
        "",
        "how much leaves differ in length: 0.2 is 0.8 to 1.2 times",
        size_spread
    ),
    field!(
        "leaf_lobes",
        integer(0, 400),
        "",
        "lobes, leaflets or needles of a leaf, as its outline counts them; 0: as usual",
        lobes
    ),
    field!(
        "leaf_lobe_depth",
        real_or_auto(0.0, 1.0),
        "",
        "how deep the bays between lobes are: 1 down to the midrib; auto: as usual for its outline",
        lobe_depth
    ),
    field!(
        "leaf_margin",
        Kind::Choice(Edge::WORDS),
        "",
        "the edge of a blade: without teeth, with pointed or with rounded ones; auto: as usual for its outline",
        margin
    ),
    field!(
        "leaf_petiole",
        real_or_auto(0.0, 0.9),
        "",
        "the stalk's share of the length; auto: as usual for its outline",
        petiole
    ),
    field!(
        "twig_length",
        real_or_auto(1e-3, 20.0),
        "m",
        "for leaf_form=twig: length of the card; auto: four leaves",
        twig_length_m
    ),
    field!("twig_leaves", integer(1, 200), "", "for leaf_form=twig: leaves on the card", twig_leaves),
    field!(
        "leaf_arrangement",
        Kind::Choice(Arrangement::WORDS),
        "",
        "how leaves stand round a twig: left and right in turn, pairs in one plane, pairs each square to the last, whorls of leaf_whorl, a spiral of 137.5 degrees",
        arrangement
    ),
    field!("leaf_whorl", integer(1, 64), "", "for leaf_arrangement=whorled: leaves a node", whorl),
    field!("leaves_per_m", real(0.0, 1e5), "1/m", "leaves a metre of twig, all together", per_m),
    field!(
        "leaf_count",
        integer(1, 64),
        "",
        "leaves that spring from one place; more of them are fewer places",
        count
    ),
    field!(
        "leaf_max_radius",
        real_or_auto(1e-6, 100.0),
        "m",
        "leaves grow only on wood that is thinner; auto: three times the mean radius of tips",
        max_radius_m
    ),
    field!(
        "leaf_max_age",
        real(0.0, 1.0),
        "",
        "leaves grow only on wood of the last share of growth; 1: of any age",
        max_age
    ),
    field!(
        "leaf_tip",
        real(0.0, 1.0),
        "",
        "how much rarer leaves are at a twig's base than at its tip: 0 not at all, 1 none there",
        tip
    ),
    field!("leaf_terminal", Kind::Switch, "", "whether each twig ends with a leaf", terminal),
    field!(
        "leaf_grid",
        Kind::Reals { min: 0.0, max: 256.0, most: 2 },
        "",
        "the older style: so many leaves along and so many round each segment, in place of leaves_per_m; 0: off",
        grid
    ),
    field!("leaf_angle", real(0.0, 180.0), "deg", "angle of a leaf off its twig", angle_deg),
    field!("leaf_droop", real(-90.0, 90.0), "deg", "how far leaves hang; less than 0: rise", droop_deg),
    field!(
        "leaf_level",
        real(0.0, 1.0),
        "",
        "how far blades turn level: 0 facing the twig's tip, 1 facing the sky",
        level
    ),
    field!("leaf_up", real(-1.0, 1.0), "", "how far leaves point up, less than 0: down", up),
    field!(
        "leaf_jitter",
        real(0.0, 180.0),
        "deg",
        "each leaf is turned by up to so much, at random",
        jitter_deg
    ),
    field!("leaf_offset", real(0.0, 10.0), "m", "distance of a leaf's foot off the bark", offset_m),
    field!(
        "leaf_normals",
        Kind::Choice(Normals::WORDS),
        "",
        "normals off each leaf's own face, or mostly out of the crown: softer shading",
        normals
    ),
    field!(
        "leaf_colors",
        Kind::Colors { most: MOST_COLORS, auto: true },
        "sRGB",
        "colours of the upper side in summer; of a grammar's polygons and organs: index 0 of ' has the first, the last repeats; auto: as usual",
        colors
    ),
    field!(
        "autumn_colors",
        Kind::Colors { most: MOST_COLORS, auto: true },
        "sRGB",
        "colours in autumn, from the first change to the last; auto: as usual for its outline",
        autumn_colors
    ),
    field!("leaf_tint_spread", real(0.0, 1.0), "", "how much leaves differ in tint", tint_spread),
    field!("evergreen", Kind::Switch, "", "whether the season leaves colour and number alone", evergreen),
    field!(
        "leaf_keep",
        real(0.0, 1.0),
        "",
        "the share of leaves that is kept: what a lower share keeps, a higher one keeps too",
        keep
    ),
    field!(
        "share",
        real(0.0, 1.0),
        "",
        "for a further kind: how many places of the first kind it takes; 0: it has places of its own",
        share
    ),
];

impl LeafKind {
    /// The knobs that the first kind has: all but the last, `share`.
    pub const FIELDS: &[Field<Self>] = LEAF_KNOBS.split_at(LEAF_KNOBS.len() - 1).0;
}

impl FoliageSettings {
    /// What is said once for all kinds.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "season",
            Kind::Real { min: 0.0, max: 1.0, auto: false, names: &SEASONS },
            "",
            "0 flush: small and light; 0.35 summer; 0.55 to 0.8 autumn colours; leaves fall from 0.75 on; 1 bare",
            season
        ),
        field!("leaf_size", integer(16, 4096), "px", "side of the drawn pictures of leaves", size_px),
    ];
}
