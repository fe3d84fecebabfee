//! `[foliage]`: what grows on the twigs, where and how it looks. The first kind's keys stand in the
//! section itself; each table of `[[foliage.also]]` is a further kind with the same keys.
//!
//! A new key is a field of [`LeafKind`] and a row of [`LEAF_KNOBS`].

use linden_base::document::{Entry, Fault, FileKey, List, NamesFiles, TextPlace};
use linden_base::knob::{Knob, Value, excerpt, values};
use linden_base::{file_key, words};

use super::leaf::LEAF_KNOBS;
use super::lod::LodForms;
use crate::foliage::Calendar;
use crate::texture::leaf::Outline;

/// More kinds would make a picture each.
pub const MOST_KINDS: usize = 8;

/// Letters of a kind's name.
const LONGEST_NAME: usize = 32;

/// Old leaves and young ones.
const TURTLE_COLORS: [[u8; 3]; 2] = [[74, 122, 48], [122, 154, 62]];

/// When leaves turn where nothing is said: the first and the last, seasons.
pub const TURNING: [f64; 2] = [0.54, 1.0];

/// The key of the list of further kinds in `[foliage]`.
pub const ALSO: &str = "also";

/// The key of a kind's name.
pub const KIND_NAME: &str = "name";

/// What [`KIND_NAME`] is, a line.
pub const KIND_NAME_HELP: &str = "what the kind is called: its knobs are then turned as blossom.leaf_keep; lower-case letters, digits, - and _";

words! {
    /// What a leaf is made of. Lengths are shares of its own.
    Form {
        /// Nothing grows but what a grammar places.
        None = "none",
        /// One flat rectangle with the picture.
        Card = "card",
        /// Two of them, square to each other.
        Cross = "cross",
        /// A blade that is bent along and folded across.
        Curved = "curved",
        /// A whole twig with many leaves on one bent card.
        Twig = "twig",
        /// Leaflets that spread from one point.
        Fan = "fan",
        /// Needles: cards crossed about the heading.
        Tuft = "tuft",
        /// The user's own.
        Mesh = "mesh"
    }
}

words! {
    /// How leaves stand round a twig: phyllotaxis.
    Arrangement {
        /// One a node, left and right in turn.
        Alternate = "alternate",
        /// Two a node, all in one plane.
        Opposite = "opposite",
        /// Two a node, each pair square to the last.
        Decussate = "decussate",
        /// Several a node, each whorl in the gaps of the last.
        Whorled = "whorled",
        /// One a node, the golden angle on.
        Spiral = "spiral"
    }
}

words! {
    /// What the edge of a blade is like.
    Edge {
        /// As usual for its outline.
        Auto = "auto",
        /// Without teeth.
        Entire = "entire",
        /// Teeth that point to the tip.
        Serrate = "serrate",
        /// Rounded teeth.
        Crenate = "crenate"
    }
}

words! {
    /// How the members of a cluster stand: flowers, fruit.
    Cluster {
        /// There is none: each stands alone.
        None = "none",
        /// All stalks from the end of a common one.
        Umbel = "umbel",
        /// Outer stalks longer, so that all end about level.
        Corymb = "corymb",
        /// Short stalks all along a common one.
        Raceme = "raceme",
        /// A cone: stalks along a common one, the longest at its foot.
        Panicle = "panicle",
        /// A ball.
        Pompom = "pompom"
    }
}

words! {
    /// Which way a leaf's normals point.
    Normals {
        /// Off its own face.
        Flat = "flat",
        /// Mostly out of the crown, so that it is shaded as one soft body.
        Dome = "dome"
    }
}

/// One kind of organ: leaves, needles, flowers, fruit.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafKind {
    /// What people and scripts call it: `blossom`. See [`check_kind_name`].
    pub name: Option<String>,
    /// What it is made of.
    pub form: Form,
    /// For [`Form::Mesh`]: the file, relative to the preset's.
    pub mesh: Option<String>,
    /// A picture of the user's in place of the drawn one: the file, relative to the preset's.
    pub picture: Option<String>,
    /// The shape of its picture.
    pub outline: Outline,
    /// From its foot to its tip, metres.
    pub length_m: f64,
    /// Width ÷ length; `None`: as usual for its outline.
    pub width: Option<f64>,
    /// How much lengths differ: 0.2 is 0.8 to 1.2 times.
    pub size_spread: f64,
    /// Lobes, leaflets or needles; 0: as usual for its outline.
    pub lobes: u32,
    /// How deep the bays between lobes are; `None`: as usual for its outline.
    pub lobe_depth: Option<f64>,
    /// What its edge is like.
    pub margin: Edge,
    /// The stalk's share of the length; `None`: as usual for its outline.
    pub petiole: Option<f64>,
    /// Length of a twig card, metres; `None`: four leaves.
    pub twig_length_m: Option<f64>,
    /// Leaves on a twig card.
    pub twig_leaves: u32,
    /// How far they gather at its end, 0 to 1.
    pub twig_tuft: f64,
    /// Side shoots that they stand on as well.
    pub twig_shoots: u32,
    /// How they stand round a twig.
    pub arrangement: Arrangement,
    /// Leaves a node, where they are whorled.
    pub whorl: u32,
    /// Leaves a metre of twig, all together.
    pub per_m: f64,
    /// Leaves that spring from one place.
    pub count: u32,
    /// None grow on wood that is thicker, metres; `None`: on twigs.
    pub max_radius_m: Option<f64>,
    /// None grow on wood that is older, as a share of all births; 1 is any age.
    pub max_age: f64,
    /// How much rarer they are at a twig's base than at its tip: 0 not at all, 1 none there.
    pub tip: f64,
    /// Whether each twig ends with one.
    pub terminal: bool,
    /// Places along and round each segment, the older style; 0 or one number: no grid.
    pub grid: Vec<f64>,
    /// Off the twig's axis, degrees.
    pub angle_deg: f64,
    /// How far they hang, degrees.
    pub droop_deg: f64,
    /// How far blades turn level, 0 to 1.
    pub level: f64,
    /// How far headings turn up (1) or down (-1).
    pub up: f64,
    /// How far each is turned at random, degrees.
    pub jitter_deg: f64,
    /// Off the bark, metres.
    pub offset_m: f64,
    /// Which way normals point.
    pub normals: Normals,
    /// sRGB: the upper side in summer; `None`: as usual for its outline. See [`FoliageSettings::turtle_colors`].
    pub colors: Option<Vec<[u8; 3]>>,
    /// sRGB: the under side in summer; `None`: as the upper one.
    pub back_colors: Option<Vec<[u8; 3]>>,
    /// sRGB, from the first change to the last; `None`: as usual for its outline.
    pub autumn_colors: Option<Vec<[u8; 3]>>,
    /// How much leaves differ in tint, 0 to 1.
    pub tint_spread: f64,
    /// How far leaves of the shade are darker than those of the sun; `None`: as usual for its outline.
    pub shade: Option<f64>,
    /// The share of scattered light that leaves on the other side; `None`: as usual for its outline.
    pub translucency: Option<f64>,
    /// Whether the season leaves them alone.
    pub evergreen: bool,
    /// The seasons in which it begins and ends, 0 to 1; the first larger than the second: over the winter.
    pub season_range: Vec<f64>,
    /// Over which share of the year it opens, and falls; `None`: as [`Calendar`](crate::foliage::Calendar) has it.
    pub season_fade: Option<f64>,
    /// sRGB: the upper side when it has just opened; `None`: green ones are lighter and yellower.
    pub young_colors: Option<Vec<[u8; 3]>>,
    /// The seasons from which and to which it turns to its autumn colours.
    pub turn_range: Vec<f64>,
    /// Rows of petals, of [`LeafKind::lobes`] each.
    pub petal_rows: u32,
    /// How several of it stand together in one place.
    pub cluster: Cluster,
    /// How many do.
    pub cluster_count: u32,
    /// The common stalk, from the twig to its end, metres; `None`: by what is on it.
    pub cluster_length_m: Option<f64>,
    /// The longest stalk of a member, metres; `None`: as much as gives all of them room.
    pub cluster_stalk_m: Option<f64>,
    /// Where members look: 0 out along their stalks, 1 all along the common one, -1 back; `None`: as usual.
    pub cluster_facing: Option<f64>,
    /// None grow on the trunk below this height, metres; `None`: below its lowest branch.
    pub from_m: Option<f64>,
    /// The share that is kept.
    pub keep: f64,
    /// What it is made of in each level of detail.
    pub lod_forms: LodForms,
    /// How much longer it stays than others where levels leave leaves out.
    pub lod_weight: f64,
    /// For a further kind: how many places of the first it takes, of 1; 0: it has its own places.
    pub share: f64,
}

impl Default for LeafKind {
    /// Nothing grows; leaves of a hand's length when a form is chosen.
    fn default() -> Self {
        Self {
            name: None,
            form: Form::None,
            mesh: None,
            picture: None,
            outline: Outline::Ovate,
            length_m: 0.08,
            width: None,
            size_spread: 0.2,
            lobes: 0,
            lobe_depth: None,
            margin: Edge::Auto,
            petiole: None,
            twig_length_m: None,
            twig_leaves: 12,
            twig_tuft: 0.0,
            twig_shoots: 0,
            arrangement: Arrangement::Spiral,
            whorl: 3,
            per_m: 40.0,
            count: 1,
            max_radius_m: None,
            max_age: 1.0,
            tip: 0.0,
            terminal: true,
            grid: vec![0.0],
            angle_deg: 50.0,
            droop_deg: 10.0,
            level: 0.4,
            up: 0.0,
            jitter_deg: 15.0,
            offset_m: 0.0,
            normals: Normals::Flat,
            colors: None,
            back_colors: None,
            autumn_colors: None,
            tint_spread: 0.5,
            shade: None,
            translucency: None,
            evergreen: false,
            season_range: vec![0.0, 1.0],
            season_fade: None,
            young_colors: None,
            turn_range: TURNING.to_vec(),
            petal_rows: 1,
            cluster: Cluster::None,
            cluster_count: 7,
            cluster_length_m: None,
            cluster_stalk_m: None,
            cluster_facing: None,
            from_m: None,
            keep: 1.0,
            lod_forms: LodForms::default(),
            lod_weight: 1.0,
            share: 0.0,
        }
    }
}

impl LeafKind {
    /// The keys that name files.
    pub const FILES: [FileKey<Self>; 2] = [
        file_key!(
            "leaf_mesh",
            "for leaf_form=mesh: an OBJ file, relative to the preset's; it points along +Y from its foot, its upper side to +Z, and is made leaf_length high",
            mesh
        ),
        file_key!(
            "leaf_picture",
            "in place of the drawn picture: a PNG, JPEG, WebP or TGA file, relative to the preset's; its alpha cuts the leaf out; it shows summer, and is drawn over with young_colors and autumn_colors, where they are given",
            picture
        ),
    ];
}

impl NamesFiles for LeafKind {
    const FILES: &'static [FileKey<Self>] = &Self::FILES;
}

/// Everything that grows on the wood.
#[derive(Clone, Debug, PartialEq)]
pub struct FoliageSettings {
    /// 0 flush, 0.35 summer, 0.75 autumn, 1 bare.
    pub season: f64,
    /// The side of the drawn pictures, pixels.
    pub size_px: u32,
    /// How many times wider and fewer needles are in these; 1: as they are. No key: branch cards set it for their pictures.
    pub needle_scale: f32,
    /// The number that pictures are drawn by.
    pub picture_seed: u64,
    /// What stands in the section itself.
    pub first: LeafKind,
    /// Further kinds.
    pub also: Vec<LeafKind>,
}

impl Default for FoliageSettings {
    fn default() -> Self {
        Self {
            season: 0.35,
            size_px: 1024,
            needle_scale: 1.0,
            picture_seed: 1,
            first: LeafKind::default(),
            also: Vec::new(),
        }
    }
}

impl FoliageSettings {
    /// All kinds, the first one first.
    pub fn kinds(&self) -> impl Iterator<Item = &LeafKind> {
        std::iter::once(&self.first).chain(&self.also)
    }

    /// Whether something of it is another in another season.
    pub fn changes_with_seasons(&self) -> bool {
        self.kinds().any(|kind| kind.form != Form::None && Calendar::of(kind).changes())
    }

    /// What organs of a grammar and polygons are coloured with, sRGB: the i-th is that of the turtle's
    /// colour index i, the last that of all higher ones.
    pub fn turtle_colors(&self) -> &[[u8; 3]] {
        self.first.colors.as_deref().unwrap_or(&TURTLE_COLORS)
    }

    /// What to say of kinds whose `leaves_per_m` counted twigs with many leaves each and counts leaves now, or the other way
    /// round, as it is what it was `before`.
    pub fn form_notes(&self, before: &Self) -> Vec<String> {
        let note = |(was, is): (&LeafKind, &LeafKind)| {
            let bears =
                |kind: &LeafKind| if kind.form == Form::Twig { f64::from(kind.twig_leaves) } else { 1.0 };
            let is_leafless = |kind: &LeafKind| kind.form == Form::None || kind.per_m == 0.0;
            let turned = was.form != is.form && [was.form, is.form].contains(&Form::Twig);
            if !turned || is_leafless(was) || is_leafless(is) || was.per_m != is.per_m {
                return None;
            }
            let kind = is.name.as_ref().map(|name| format!("{name}.")).unwrap_or_default();
            let as_many = was.per_m * bears(was) / bears(is);
            let [counted, counts] = [was, is].map(|kind| match kind.form {
                Form::Twig => format!("twigs of {} leaves", kind.twig_leaves),
                _ => "leaves".to_owned(),
            });
            Some(format!(
                "{kind}leaves_per_m={} counted {counted} and counts {counts} now; {kind}leaves_per_m={} gives as many \
                 leaves as before",
                is.per_m,
                (1e3 * as_many).round() / 1e3
            ))
        };
        before.kinds().zip(self.kinds()).filter_map(note).collect()
    }

    /// The same, to be changed.
    pub fn kinds_mut(&mut self) -> impl Iterator<Item = &mut LeafKind> {
        std::iter::once(&mut self.first).chain(&mut self.also)
    }
}

const LIST: List = List {
    key: ALSO,
    heading: "[[foliage.also]]",
    one: "kind",
    most: (MOST_KINDS - 1, "a plant beside its first"),
};

/// Reads what the section has beside knobs: further kinds and files. Whether the entry was one of these.
///
/// # Errors
/// [`Fault`]: what is wrong with it.
pub fn read(foliage: &mut FoliageSettings, entry: &Entry) -> Result<bool, Fault> {
    if entry.key == ALSO {
        foliage.also = LIST.read(&entry.node, read_kind)?;
    } else if !take_name(&mut foliage.first, entry)? {
        return foliage.first.take_file(entry);
    }
    let mut names: Vec<&str> = Vec::new();
    for name in foliage.kinds().filter_map(|kind| kind.name.as_deref()) {
        if names.contains(&name) {
            return Err(Fault::new(
                entry.place,
                format!("two kinds of foliage are called '{name}'; rename one"),
            ));
        }
        names.push(name);
    }
    Ok(true)
}

/// Takes a kind's name; whether the entry was one.
fn take_name(kind: &mut LeafKind, entry: &Entry) -> Result<bool, Fault> {
    if entry.key != KIND_NAME {
        return Ok(false);
    }
    let name = entry.node.text(KIND_NAME)?.trim();
    check_kind_name(name).map_err(|problem| {
        Fault::new(entry.node.place, format!("'{}' is no name of a kind: {problem}", excerpt(name)))
    })?;
    kind.name = Some(name.to_owned());
    Ok(true)
}

/// Whether a kind may be called so: lower-case letters, digits, `-` and `_`, beginning with a letter.
///
/// # Errors
/// What is wrong with the name.
pub fn check_kind_name(name: &str) -> Result<(), String> {
    let is_one = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    if name == ALSO {
        return Err(format!("'{ALSO}' stands for all further kinds"));
    }
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(is_one) {
        return Err("it takes lower-case letters, digits, - and _, a letter first".to_owned());
    }
    if name.len() > LONGEST_NAME { Err(format!("it is longer than {LONGEST_NAME} letters")) } else { Ok(()) }
}

fn read_kind(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<LeafKind, Fault> {
    let mut kind = LeafKind::default();
    for entry in entries {
        if take_name(&mut kind, entry)? || kind.take_file(entry)? {
            continue;
        }
        let Some(row) = LEAF_KNOBS.iter().find(|row| row.knob.is_called(&entry.key)) else {
            let rows = LEAF_KNOBS.iter().map(|row| row.knob.name);
            return Err(LIST.unknown(
                number,
                entry,
                &rows.chain(LeafKind::FILES.map(|row| row.key)).chain([KIND_NAME]).collect::<Vec<_>>(),
            ));
        };
        (row.write)(&mut kind, entry.node.value(&entry.key, &row.knob.kind)?);
    }
    if kind.form == Form::None {
        let words = Form::WORDS[1..].join(", ");
        return Err(Fault::new(place, format!("kind {number} has no 'leaf_form'; give it one of: {words}")));
    }
    Ok(kind)
}

impl LeafKind {
    /// All rows with their values, in the order of a document.
    pub fn knobs(&self) -> Vec<(Knob, Value)> {
        values(&LEAF_KNOBS, self)
    }
}
