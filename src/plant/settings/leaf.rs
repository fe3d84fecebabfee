//! The knobs of leaves. One table of rows serves the first kind, all further ones, the command line, the
//! schema and the workbench.

use linden_base::field;
use linden_base::knob::{Field, FieldValue, Kind, Value, integer, names, real, real_or_auto};

use super::bloom::BLOOM_KNOBS;
use super::foliage::{Arrangement, Edge, FoliageSettings, Form, LeafKind, Normals};
use super::lod::LOD_KNOBS;
use crate::season::SEASON_WORDS;
use crate::texture::leaf::Outline;
use linden_skeleton::organs::OrganClass;

/// The most colours that one kind of organ has.
pub(super) const MOST_COLORS: usize = 32;

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

/// The keys of a kind of organ, beside its name and the files `leaf_mesh` and `leaf_picture`.
pub const LEAF_KNOBS: [Field<LeafKind>; LOOKS.len() + BLOOM_KNOBS.len() + LOD_KNOBS.len() + 1] = {
    let mut all = [SHARE; LOOKS.len() + BLOOM_KNOBS.len() + LOD_KNOBS.len() + 1];
    let parts: [&[Field<LeafKind>]; 3] = [&LOOKS, &BLOOM_KNOBS, &LOD_KNOBS];
    let (mut at, mut part) = (0, 0);
    while part < parts.len() {
        let mut row = 0;
        while row < parts[part].len() {
            all[at] = parts[part][row];
            row += 1;
            at += 1;
        }
        part += 1;
    }
    all
};

/// For further kinds alone.
const SHARE: Field<LeafKind> = field!(
    "share",
    real(0.0, 1.0),
    "",
    "for a further kind: how many places of the first kind it takes; 0: it has places of its own",
    share,
    see_also(&["leaf_keep"])
);

/// What one leaf is and where it stands.
const LOOKS: [Field<LeafKind>; 38] = [
    field!(
        "leaf_form",
        Kind::Choice(Form::WORDS),
        "",
        "what leaves are made of: nothing, one card, two crossed, a curved blade, a card with a whole twig, a fan of leaflets, a tuft of needles, the mesh of leaf_mesh",
        form,
        details(
            "What a leaf costs: card 2 triangles, cross 4, tuft 6, curved 12; twig 16 for a whole card of \
             leaves. Take curved where leaves are seen from near, twig for large crowns, cross or tuft for \
             needles, fan with leaf_outline=fan. none leaves the wood bare but for the organs of a grammar, which have shapes of their \
             own; leaves of a Weber-Penn tree have none."
        ),
        see_also(&["leaf_outline", "twig_leaves", "leaves_per_m", "triangles"])
    ),
    field!(
        "leaf_outline",
        Kind::Choice(&OUTLINES),
        "",
        "shape of the drawn picture, of one leaf or of a shoot",
        outline,
        details(
            "Besides the outline it says what is usual: width, lobes, edge, stalk and colours, which their \
             knobs keep at auto or 0. pine, spruce, larch and scale are shoots, blossom and fruit are for \
             further kinds of organs."
        ),
        see_also(&["leaf_form", "leaf_width", "leaf_lobes", "leaf_margin", "leaf_colors"])
    ),
    field!(
        "leaf_length",
        real(5e-4, 10.0),
        "m",
        "length of a leaf from the foot of its stalk to its tip",
        length_m,
        details(
            "0.08 m is a beech's leaf. For outlines that are shoots it is the whole shoot, for compound \
             leaves the whole leaf with its leaflets. While leaves unfold (season below 0.2) they are \
             smaller, down to 0.35 of it. For large crowns fewer and larger leaves look much the same."
        ),
        see_also(&["leaf_width", "leaf_size_spread", "leaves_per_m", "twig_length"])
    ),
    field!(
        "leaf_width",
        real_or_auto(5e-3, 4.0),
        "",
        "width of a blade / its length; auto: as usual for its outline",
        width,
        details(
            "Usual are 0.17 for lanceolate, 0.5 for elliptic, 0.62 for ovate, 1 for orbicular and 1.15 for \
             palmate."
        ),
        see_also(&["leaf_length", "leaf_outline"])
    ),
    field!(
        "leaf_size_spread",
        real(0.0, 0.95),
        "",
        "how much leaves differ in length: 0.2 is 0.8 to 1.2 times",
        size_spread,
        see_also(&["leaf_length", "leaf_jitter"])
    ),
    field!(
        "leaf_lobes",
        integer(0, 400),
        "",
        "lobes, leaflets or needles of a leaf, as its outline counts them; 0: as usual",
        lobes,
        details(
            "Lobes of one side for lobed, all of them for palmate; leaflets for fan; pairs for pinnate, \
             palm and fern; branches of one side for bipinnate; needles for pine and spruce; tufts for \
             larch; petals of a row for blossom; how many for fruit. Other outlines have none."
        ),
        aliases(&["petals"]),
        see_also(&["leaf_lobe_depth", "leaf_outline", "petal_rows"])
    ),
    field!(
        "leaf_lobe_depth",
        real_or_auto(0.0, 1.0),
        "",
        "how deep the bays between lobes are: 1 down to the midrib; auto: as usual for its outline",
        lobe_depth,
        details(
            "For lobed and palmate, where 0.5 is usual. 0.2 makes a scalloped edge, 0.9 a leaf cut nearly \
             to its midrib."
        ),
        see_also(&["leaf_lobes", "leaf_outline"])
    ),
    field!(
        "leaf_margin",
        Kind::Choice(Edge::WORDS),
        "",
        "the edge of a blade: without teeth, with pointed or with rounded ones; auto: as usual for its outline",
        margin,
        see_also(&["leaf_outline"])
    ),
    field!(
        "leaf_petiole",
        real_or_auto(0.0, 0.9),
        "",
        "the stalk's share of the length; auto: as usual for its outline",
        petiole,
        details(
            "0.12 is usual, 0.35 for leaves on long stalks, as orbicular (aspen) and palmate. Needles and \
             shoots have none."
        ),
        see_also(&["leaf_length", "leaf_outline"])
    ),
    field!(
        "twig_length",
        real_or_auto(1e-3, 20.0),
        "m",
        "for leaf_form=twig: length of the card; auto: four leaves",
        twig_length_m,
        details(
            "The card replaces a small twig with its leaves. 0.3 to 0.7 m suits broad leaves; longer cards \
             are lighter, and look flat from near."
        ),
        see_also(&["twig_leaves", "leaf_length", "leaves_per_m"])
    ),
    field!(
        "twig_leaves",
        integer(1, 200),
        "",
        "for leaf_form=twig: leaves on the card",
        twig_leaves,
        details(
            "leaves_per_m then counts cards: with 12 leaves on each a twelfth of them gives as many leaves. 10 to 25 that \
             leave gaps make a finer crown than twice as many close together."
        ),
        see_also(&["twig_length", "leaves_per_m", "leaf_form"])
    ),
    field!(
        "twig_tuft",
        real(0.0, 1.0),
        "",
        "for leaf_form=twig: how far leaves gather at the card's end; 0: evenly along it",
        twig_tuft,
        details(
            "Oaks bear their leaves in tufts at the ends of their shoots (0.5 to 0.8), so that their crowns look \
             coarse and full of holes; limes and beeches spread them in one plane (0)."
        ),
        see_also(&["twig_leaves", "leaf_arrangement"])
    ),
    field!(
        "twig_shoots",
        integer(0, 24),
        "",
        "for leaf_form=twig: side shoots on the card, which share its leaves; 0: one straight shoot",
        twig_shoots,
        details(
            "A straight shoot with leaves left and right looks like one long leaf from afar. 2 side shoots suit most trees \
             (oak, birch), 4 to 6 those whose sprays are broad (lime, beech). Give them room: where leaves cover \
             each other on the card, the whole card looks like one leaf. A side shoot has two leaves or more: fewer are drawn \
             where there are not enough for all."
        ),
        see_also(&["twig_leaves", "twig_length", "leaves_per_m"])
    ),
    field!(
        "leaf_arrangement",
        Kind::Choice(Arrangement::WORDS),
        "",
        "how leaves stand round a twig: left and right in turn, pairs in one plane, pairs each square to the last, whorls of leaf_whorl, a spiral of 137.5 degrees",
        arrangement,
        details(
            "Phyllotaxis. alternate is a beech or an elm, decussate a maple or an ash, whorled an oleander, \
             spiral an oak or a cherry: 137.5 degrees, the golden angle, so that no leaf is straight above \
             another. Leaves of slanting twigs begin at the sides, except for whorled and spiral, which \
             begin anywhere."
        ),
        see_also(&["leaf_whorl", "leaf_count", "leaves_per_m"])
    ),
    field!(
        "leaf_whorl",
        integer(1, 64),
        "",
        "for leaf_arrangement=whorled: leaves a node",
        whorl,
        see_also(&["leaf_arrangement"])
    ),
    field!(
        "leaves_per_m",
        real(0.0, 1e5),
        "1/m",
        "leaves a metre of twig, all together",
        per_m,
        details(
            "Counted along the length of twigs, so that a smaller step or more rings change nothing. 10 to \
             30 is an open to a full crown of broad leaves, 60 to 80 a dense one, 300 single needles. \
             Leaves that one place bears (leaf_count) and those of a pair or whorl are all counted. More \
             than 50 million are refused."
        ),
        see_also(&["leaf_max_radius", "leaf_count", "leaf_keep", "triangles"])
    ),
    field!(
        "leaf_count",
        integer(1, 64),
        "",
        "leaves that spring from one place; more of them are fewer places",
        count,
        details(
            "2 and more stand as a rosette round the way out, opened by leaf_angle: short shoots of a \
             larch, leaves at the ends of a magnolia's twigs."
        ),
        see_also(&["leaves_per_m", "leaf_angle"])
    ),
    field!(
        "leaf_max_radius",
        real_or_auto(1e-6, 100.0),
        "m",
        "leaves grow only on wood that is thinner; auto: three times the mean radius of tips",
        max_radius_m,
        details(
            "With radius_exponent=2 auto is wood that bears nine tips or fewer. A smaller radius keeps \
             leaves to the outermost twigs; a larger one lets them sprout from limbs, as after pollarding."
        ),
        see_also(&["leaf_max_age", "leaves_per_m", "tip_radius"])
    ),
    field!(
        "leaf_from",
        real_or_auto(0.0, 1000.0),
        "m",
        "no leaves grow on a trunk below this height; auto: below its lowest branch",
        from_m,
        details(
            "A young tree's trunk is as thin as twigs are, and bears no leaves all the same. A stem without \
             a branch has leaves all along under auto. 0 gives suckers and water shoots the whole trunk."
        ),
        see_also(&["leaf_max_radius", "leaf_max_age"])
    ),
    field!(
        "leaf_max_age",
        real(0.0, 1.0),
        "",
        "leaves grow only on wood of the last share of growth; 1: of any age",
        max_age,
        details(
            "0.1 is wood of the last tenth of growth, of iterations or derivations: a green shell. Together \
             with leaf_max_radius both must hold."
        ),
        see_also(&["leaf_max_radius", "age"])
    ),
    field!(
        "leaf_tip",
        real(0.0, 1.0),
        "",
        "how much rarer leaves are at a twig's base than at its tip: 0 not at all, 1 none there",
        tip,
        see_also(&["leaf_terminal", "leaves_per_m"])
    ),
    field!(
        "leaf_terminal",
        Kind::Switch,
        "",
        "whether each twig ends with a leaf",
        terminal,
        see_also(&["leaf_tip"])
    ),
    field!(
        "leaf_grid",
        Kind::Reals { min: 0.0, max: 256.0, most: 2 },
        "",
        "the older style: so many leaves along and so many round each segment, in place of leaves_per_m; 0: off",
        grid,
        see_also(&["leaves_per_m"])
    ),
    field!(
        "leaf_angle",
        real(0.0, 180.0),
        "deg",
        "angle of a leaf off its twig",
        angle_deg,
        details(
            "0 lies along the twig, 45 to 60 is usual, 90 stands off square, more points back to the trunk. \
             The leaf at a twig's end goes straight on. For rosettes (leaf_count) it is how far they open."
        ),
        see_also(&["leaf_droop", "leaf_up", "leaf_jitter"])
    ),
    field!(
        "leaf_droop",
        real(-90.0, 90.0),
        "deg",
        "how far leaves hang; less than 0: rise",
        droop_deg,
        details(
            "The last turn, after leaf_angle, leaf_jitter and leaf_up, and never past straight down: 10 \
             looks alive, 60 and more is a weeping tree or one in drought."
        ),
        see_also(&["leaf_angle", "leaf_up", "leaf_level"])
    ),
    field!(
        "leaf_level",
        real(0.0, 1.0),
        "",
        "how far blades turn level: 0 facing the twig's tip, 1 facing the sky",
        level,
        details("1 turns all upper sides to the sky, in layers, as leaves in shade do."),
        see_also(&["leaf_droop", "leaf_normals"])
    ),
    field!(
        "leaf_up",
        real(-1.0, 1.0),
        "",
        "how far leaves point up, less than 0: down",
        up,
        details(
            "1 makes all leaves point straight up, -1 straight down, 0.3 a little up. leaf_droop comes \
             after it."
        ),
        see_also(&["leaf_angle", "leaf_droop"])
    ),
    field!(
        "leaf_jitter",
        real(0.0, 180.0),
        "deg",
        "each leaf is turned by up to so much, at random",
        jitter_deg,
        details(
            "About each of three axes. 10 to 20 takes away the pattern of the arrangement from far, and \
             leaves it to be seen from near; 90 is a heap."
        ),
        see_also(&["leaf_angle", "leaf_size_spread", "leaf_tint_spread"])
    ),
    field!(
        "leaf_offset",
        real(0.0, 10.0),
        "m",
        "distance of a leaf's foot off the bark",
        offset_m,
        see_also(&["leaf_angle"])
    ),
    field!(
        "leaf_normals",
        Kind::Choice(Normals::WORDS),
        "",
        "normals off each leaf's own face, or mostly out of the crown: softer shading",
        normals,
        details(
            "flat shades each leaf for itself: lively from near, noisy from far. dome turns normals out of \
             the crown, so that it is shaded as one soft body, as games like it."
        ),
        see_also(&["leaf_level"])
    ),
    field!(
        "leaf_colors",
        Kind::Colors { most: MOST_COLORS, auto: true },
        "sRGB",
        "colours of the upper side in summer; of a grammar's polygons and organs: index 0 of ' has the first, the last repeats; auto: as usual",
        colors,
        details(
            "All that a leaf scatters, to both sides (leaf_translucency): lighter than a leaf that lies on a \
             table. Several mix over the crown: each variant of the picture has one. In spring they start as \
             young_colors, by default lighter and yellower, in autumn they turn to autumn_colors."
        ),
        see_also(&["young_colors", "autumn_colors", "leaf_tint_spread", "season"])
    ),
    field!(
        "back_colors",
        Kind::Colors { most: MOST_COLORS, auto: true },
        "sRGB",
        "colours of the under side in summer; auto: as the upper side",
        back_colors,
        details(
            "Silver under olives and white poplars, rust under some magnolias. Each leaf then has two faces, a hair apart, \
             of which each is seen from its own side: twice as many triangles, and no light passes both \
             (leaf_translucency), so it suits thick leaves. The picture shares its room between the two. In autumn the under \
             side turns with the upper one. Leaves of a picture or a mesh of yours have none."
        ),
        see_also(&["leaf_colors", "leaf_translucency"])
    ),
    field!(
        "autumn_colors",
        Kind::Colors { most: MOST_COLORS, auto: true },
        "sRGB",
        "colours in autumn, from the first change to the last; auto: as usual for its outline",
        autumn_colors,
        details(
            "Leaves go through them in this order, one leaf earlier than another, from season 0.54 on; at 1 \
             they have reached the last. turn_range says it otherwise: for fruit that ripens in summer, for \
             petals that fade. Most outlines turn yellow and brown, lobed and palmate orange and red."
        ),
        see_also(&["season", "turn_range", "leaf_colors", "evergreen"])
    ),
    field!(
        "leaf_tint_spread",
        real(0.0, 1.0),
        "",
        "how much leaves differ in tint",
        tint_spread,
        details(
            "0 paints all leaves alike. 1 varies how light and how yellow they are, and how early they turn \
             in autumn."
        ),
        see_also(&["leaf_colors", "autumn_colors", "season"])
    ),
    field!(
        "leaf_shade",
        real_or_auto(0.0, 1.0),
        "",
        "how far leaves inside and low in the crown are darker than those in the sun; auto: 0.5, blossom and fruit 0",
        shade,
        details(
            "Leaves of the shade are darker and bluer, leaves of the sun lighter and yellower. The variants of the \
             picture are ordered by it and leaf_colors from the darkest to the lightest, and the twigs above a leaf \
             say which of them it likely is: in every format, without a vertex more. 0 mixes all over the crown, 1 \
             leaves nothing to chance."
        ),
        see_also(&["leaf_colors", "leaf_tint_spread", "leaf_translucency"])
    ),
    field!(
        "leaf_translucency",
        real_or_auto(0.0, 0.9),
        "",
        "the share of the light scattered by a leaf that comes out on its other side; auto: as usual for its outline",
        translucency,
        details(
            "Leaves glow where the sun stands behind them, and crowns are lighter inside. Usual are 0.45 for \
             broad leaves, 0.2 for needles and 0 for fruit and meshes of yours. USD says it in MaterialX \
             surfaces, glTF with glb.translucency=true; other formats have no word for it."
        ),
        see_also(&["leaf_colors", "leaf_normals"])
    ),
    field!(
        "evergreen",
        Kind::Switch,
        "",
        "whether the season leaves colour and number alone",
        evergreen,
        see_also(&["season"])
    ),
    field!(
        "leaf_keep",
        real(0.0, 1.0),
        "",
        "the share of leaves that is kept: what a lower share keeps, a higher one keeps too",
        keep,
        see_also(&["leaves_per_m", "season", "triangles"])
    ),
];

impl LeafKind {
    /// The knobs that the first kind has: all but the last, `share`.
    pub const FIELDS: &[Field<Self>] = LEAF_KNOBS.split_at(LEAF_KNOBS.len() - 1).0;

    /// What tables call it: its name, or else its outline, or `mesh` or `picture` for the user's.
    pub fn label(&self) -> String {
        if let Some(name) = &self.name {
            return name.clone();
        }
        match (self.form, &self.picture) {
            (Form::Mesh, _) => "mesh".to_owned(),
            (_, Some(_)) => "picture".to_owned(),
            _ => self.outline.to_value().to_string(),
        }
    }

    /// What its organs are, by its outline.
    pub const fn class(&self) -> OrganClass {
        match self.outline {
            Outline::Blossom | Outline::Petal => OrganClass::Blossom,
            Outline::Fruit => OrganClass::Fruit,
            _ => OrganClass::Leaf,
        }
    }
}

impl FoliageSettings {
    /// What is said once for all kinds.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "season",
            Kind::Real { min: 0.0, max: 1.0, auto: false, names: &SEASON_WORDS },
            "",
            "0 flush: small and light; 0.35 summer; 0.55 to 0.8 autumn colours; leaves fall from 0.75 on; 1 bare",
            season,
            details(
                "Leaves unfold from 0 to 0.2, light green and a third of their length at first; they begin \
                 to turn at 0.54 and fall from 0.75 to 1. The wood stays, and a leaf that is there in two \
                 seasons hangs at the same place. Evergreen kinds stay as in summer. season_range gives a \
                 kind, blossom say, its own part of the year."
            ),
            see_also(&["season_range", "evergreen", "autumn_colors", "leaf_keep"])
        ),
        field!(
            "leaf_size",
            integer(16, 4096),
            "px",
            "side of the drawn pictures of leaves",
            size_px,
            details(
                "Each kind of leaves has pictures of its own of this side; twice as many pixels take four \
                 times the memory and file. 256 to 512 serves trees that are seen from some metres."
            ),
            see_also(&["bark_size", "billboard_size", "leaf_outline"])
        ),
        field!(
            "leaf_seed",
            integer(0, u64::MAX),
            "",
            "another number, other pictures of the same kinds of leaves",
            picture_seed,
            details(
                "It is apart from seed, so that all trees of a kind share their pictures: a forest or a batch of \
                 them draws and holds them once."
            ),
            see_also(&["leaf_size", "bark_seed", "seed"])
        ),
    ];
}
