//! The knobs of bloom and fruit: when in the year a kind is there and in which colours, and how several of
//! it stand together. All kinds have them, leaves too.

use linden_base::field;
use linden_base::knob::{Field, Kind, integer, real_or_auto};

use super::foliage::{Cluster, LeafKind};
use super::leaf::MOST_COLORS;

/// Rows of [`LEAF_KNOBS`](super::LEAF_KNOBS).
pub(super) const BLOOM_KNOBS: [Field<LeafKind>; 10] = [
    field!(
        "season_range",
        Kind::Reals { min: 0.0, max: 1.0, most: 2 },
        "",
        "the seasons in which this kind begins and ends; 0 1: all the year",
        season_range,
        details(
            "0 0.15 is blossom before the leaves, where these have 0.1 1; 0.35 0.95 fruit from summer on. The \
             larger number first goes over the winter: 0.8 0.1. Outside of it nothing of the kind is there."
        ),
        see_also(&["season", "season_fade", "turn_range"])
    ),
    field!(
        "season_fade",
        real_or_auto(0.0, 0.5),
        "",
        "the share of the year in which this kind opens, and in which it falls; auto: a third of its season_range, a fifth and a quarter at most",
        season_fade,
        details(
            "Organs open one after another and grow meanwhile, and fall one after another. At season 0 blossom \
             and fruit whose season_range begins there have opened already; leaves unfold."
        ),
        see_also(&["season_range"])
    ),
    field!(
        "young_colors",
        Kind::Colors { most: MOST_COLORS, auto: true },
        "sRGB",
        "colours when it has just opened; auto: those of green leaves, lighter and yellower",
        young_colors,
        details(
            "Bronze for the young leaves of many cherries and maples, deep pink for the buds of blossom that \
             fades. They have gone to leaf_colors a quarter of the year after season_range begins, or when two \
             fifths of it have passed."
        ),
        see_also(&["leaf_colors", "season_range", "autumn_colors"])
    ),
    field!(
        "turn_range",
        Kind::Reals { min: 0.0, max: 1.0, most: 2 },
        "",
        "the seasons from which and to which this kind goes through its autumn_colors",
        turn_range,
        details(
            "0.54 1 is autumn. Berries that are red in August have 0.3 0.5 with green leaf_colors; blossom \
             that pales while it is open has the end of its season_range."
        ),
        see_also(&["autumn_colors", "season_range"])
    ),
    field!(
        "petal_rows",
        integer(1, 8),
        "",
        "for leaf_outline=blossom: rows of petals, each smaller and within the last; 2 and more are double flowers",
        petal_rows,
        details(
            "leaf_lobes (petals) are those of one row: 3 rows of 9 are a Kanzan cherry, 5 of 12 a camellia or \
             a rose. Double flowers hide their stamens."
        ),
        see_also(&["leaf_lobes", "leaf_outline", "cluster"])
    ),
    field!(
        "cluster",
        Kind::Choice(Cluster::WORDS),
        "",
        "how several stand together in one place: alone, stalks from one point, level, along a common stalk, in a cone, in a ball",
        cluster,
        details(
            "umbel is a cherry or ivy, corymb a rowan or elder, raceme a laburnum or bird cherry, panicle a \
             horse chestnut or lilac, pompom a snowball. leaf_length is then that of a member; leaves_per_m \
             counts clusters. leaf_up=-1 lets them hang, 1 stands them upright."
        ),
        see_also(&["cluster_count", "cluster_stalk", "cluster_length", "leaf_up"])
    ),
    field!(
        "cluster_count",
        integer(1, 200),
        "",
        "members of a cluster",
        cluster_count,
        details(
            "Each is as many triangles as leaf_form makes of it: 3 for a card, 9 for cross, 6 for a curved \
             flower, 12 for a double one, 8 for a berry, and up to four for its stalk. Some dozens do for what has hundreds."
        ),
        see_also(&["cluster", "leaf_form", "triangles"])
    ),
    field!(
        "cluster_length",
        real_or_auto(0.0, 10.0),
        "m",
        "length of a cluster's common stalk, from the twig to its end; auto: room for all members",
        cluster_length_m,
        see_also(&["cluster", "cluster_stalk"])
    ),
    field!(
        "cluster_stalk",
        real_or_auto(0.0, 10.0),
        "m",
        "length of the longest stalk of a member; of a pompom its radius; auto: room for all members",
        cluster_stalk_m,
        details(
            "Long ones let a cherry's blossoms hang clear of the twig, 0 sets flowers on the common stalk \
             itself, as catkins and spikes have them."
        ),
        see_also(&["cluster", "cluster_length", "cluster_facing"])
    ),
    field!(
        "cluster_facing",
        real_or_auto(-1.0, 1.0),
        "",
        "where members look: 0 out along their own stalks, 1 all along the common one, -1 back to the twig; auto: as usual for the cluster",
        cluster_facing,
        details(
            "Their stalks bend there. auto is 0.8 for corymb, whose flowers make a plate, 0.35 for umbel and 0 \
             for others. -1 nods, as the flowers of an upright raceme may."
        ),
        see_also(&["cluster", "leaf_up"])
    ),
];
