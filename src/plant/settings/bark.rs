//! `[bark]`: how it looks.

use linden_base::document::{FileKey, NamesFiles};
use linden_base::knob::{Field, FieldValue, Kind, Value, integer, names, real, real_or_auto};
use linden_base::random::Key;
use linden_base::{field, file_key};

use super::moss::{MOSS_FIELDS, MossSettings};
use crate::texture::{Bark, BarkStyle};

/// What the wood of limbs and that of twigs are called, after `wood`, and their barks, after `bark`.
pub(crate) const LIMBS: &str = "limbs";
pub(crate) const TWIGS: &str = "twigs";

/// How bark looks.
#[derive(Clone, Debug, PartialEq)]
pub struct BarkSettings {
    /// What kind of bark.
    pub style: BarkStyle,
    /// Mean colour, sRGB; `None`: the style's own.
    pub color: Option<[u8; 3]>,
    /// Depth of furrows as a share of the picture's side; `None`: the style's own.
    pub relief: Option<f32>,
    /// How high over the foot the relief is in the mesh too, metres; 0: nowhere.
    pub relief_height_m: f32,
    /// Strength of the grain; 1 is usual.
    pub grain: f32,
    /// How many lenticels lie across it: 0 those of its style alone, 1 in dense rows.
    pub lenticels: f32,
    /// The bark of wood that is thinner than the trunk.
    pub limbs: ThinBark,
    /// That of wood that is thinner still.
    pub twigs: ThinBark,
    /// That of the trunk near the ground.
    pub foot: FootBark,
    /// Colour of dead twigs, sRGB.
    pub dead_color: [u8; 3],
    /// Moss on it.
    pub moss: MossSettings,
    /// Side of the drawn pictures, pixels.
    pub size_px: u32,
    /// The number that the pictures are drawn by.
    pub seed: u64,
    /// A picture of the user's in place of the drawn one: the file, relative to the preset's. It is as
    /// wide as [`crate::surface::Tubes::bark_tile_m`] and continues across its edges.
    pub picture: Option<String>,
    /// Normals of the user's: the file, relative to the preset's. `None`: they are drawn, those of `picture`
    /// by its lightness.
    pub normal: Option<String>,
}

linden_base::words! {
    /// The kind of bark of wood that has one of its own.
    #[derive(Default)]
    BarkChoice {
        /// Smooth on limbs and twigs, as young bark is; ridged at the foot, as old bark is.
        #[default]
        Auto = "auto",
        /// [`BarkStyle::Ridged`]
        Ridged = "ridged",
        /// [`BarkStyle::Smooth`]
        Smooth = "smooth",
        /// [`BarkStyle::Plated`]
        Plated = "plated",
        /// [`BarkStyle::Birch`]
        Birch = "birch",
        /// [`BarkStyle::Peeling`]
        Peeling = "peeling",
        /// [`BarkStyle::Ribbon`]
        Ribbon = "ribbon",
        /// [`BarkStyle::Culm`]
        Culm = "culm",
        /// [`BarkStyle::Palm`]
        Palm = "palm",
    }
}

/// The bark of wood up to a thickness.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ThinBark {
    /// The thickest wood that has it, metres; 0: none has.
    pub radius_m: f64,
    /// What kind of bark.
    pub style: BarkChoice,
    /// Mean colour, sRGB; `None`: that of the trunk.
    pub color: Option<[u8; 3]>,
}

/// The bark of the trunk near the ground, up to [`crate::surface::Features::foot_height_m`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FootBark {
    /// What kind of bark.
    pub style: BarkChoice,
    /// Mean colour, sRGB; `None`: that of the trunk.
    pub color: Option<[u8; 3]>,
}

impl Default for BarkSettings {
    fn default() -> Self {
        Self {
            style: BarkStyle::default(),
            color: None,
            relief: None,
            relief_height_m: 0.0,
            grain: 1.0,
            lenticels: 0.0,
            limbs: ThinBark::default(),
            twigs: ThinBark::default(),
            foot: FootBark::default(),
            dead_color: [104, 98, 90],
            moss: MossSettings::default(),
            size_px: 512,
            seed: 1,
            picture: None,
            normal: None,
        }
    }
}

impl BarkSettings {
    /// Whether anything says what bark it is: its kind, a colour, or a picture.
    pub fn is_described(&self) -> bool {
        self.style != BarkStyle::default() || self.color.is_some() || self.picture.is_some()
    }

    /// The keys that name files.
    pub const FILES: [FileKey<Self>; 2] = [
        file_key!(
            "bark_picture",
            "in place of the drawn picture: a PNG, JPEG, WebP or TGA file that tiles, relative to the preset's",
            picture
        ),
        file_key!(
            "bark_normal",
            "in place of the drawn normals: such a file, OpenGL convention; without it those of bark_picture follow its lightness, bark_relief deep",
            normal
        ),
    ];

    /// The bark to draw.
    pub fn bark(&self) -> Bark {
        let usual = Bark::new(self.style, Key::new(self.seed).named("bark"));
        Bark {
            color: self.color.unwrap_or(usual.color),
            relief: self.relief.unwrap_or(usual.relief),
            roughness: self.grain,
            lenticels: self.lenticels,
            size_px: self.size_px,
            ..usual
        }
    }

    /// Whether both of its pictures are drawn, none given.
    pub fn is_drawn(&self) -> bool {
        self.picture.is_none() && self.normal.is_none()
    }

    /// A level of detail within a budget of fewer triangles has one bark on all of its trunk: neither moss nor the bark of
    /// the foot.
    pub const LEAST_TRIANGLES: u64 = 5000;

    /// The barks of limbs and of twigs, and the largest radius of the wood that has them, metres; the thicker
    /// first. Their pictures are a half and a quarter as large: less is seen of them.
    pub fn thin_barks(&self) -> Vec<(&'static str, f32, Bark)> {
        let trunk = self.bark();
        let of = |name: &'static str, thin: &ThinBark, size_px: u32| {
            let style = BarkStyle::named(thin.style.word()).unwrap_or(BarkStyle::Smooth);
            let usual = Bark::new(style, Key::new(self.seed).named(name));
            let bark = Bark {
                color: thin.color.unwrap_or(trunk.color),
                size_px: size_px.max(16).min(self.size_px),
                roughness: self.grain,
                lenticels: self.lenticels,
                ..usual
            };
            (name, thin.radius_m as f32, bark)
        };
        let all = [(LIMBS, &self.limbs, self.size_px / 2), (TWIGS, &self.twigs, self.size_px / 4)];
        all.into_iter()
            .filter(|(_, thin, _)| thin.radius_m > 0.0)
            .map(|(name, thin, size_px)| of(name, thin, size_px))
            .collect()
    }
}

impl NamesFiles for BarkSettings {
    const FILES: &'static [FileKey<Self>] = &Self::FILES;
}

/// The names of all kinds of bark.
const STYLES: [&str; BarkStyle::ALL.len()] = names(&BarkStyle::ALL);

impl FieldValue for BarkStyle {
    fn to_value(&self) -> Value {
        let name = Self::ALL.iter().find(|(_, style, _)| style == self).map_or("", |(name, _, _)| name);
        Value::Word(name.to_owned())
    }

    fn from_value(value: Value) -> Option<Self> {
        String::from_value(value).and_then(|name| Self::named(&name))
    }
}

impl BarkSettings {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "bark",
            Kind::Choice(&STYLES),
            "",
            "kind of bark",
            style,
            details(
                "ridged has long ridges that part and meet, as oak and ash; smooth is thin with lenticels, \
                 as beech; plated flakes between fissures, as pine; birch is white with dark marks; peeling \
                 has patches, as plane; ribbon is shed in long strips, as blue gum; culm is the stem of a grass, as bamboo; palm has the bases of shed leaves in overlapping rows. Each has a usual colour and relief, and bark_seed varies it."
            ),
            see_also(&["bark_color", "bark_relief", "bark_tile", "bark_grain"])
        ),
        field!(
            "bark_color",
            Kind::Color { auto: true },
            "sRGB",
            "mean colour of the drawn picture; auto: the usual one of its kind",
            color,
            see_also(&["bark", "leaf_colors"])
        ),
        field!(
            "bark_relief",
            real_or_auto(0.0, 0.5),
            "",
            "depth of the furrows, as a share of the picture's side; auto: the usual one of its kind",
            relief,
            details(
                "Usual are 0.055 for palm, 0.045 for ridged, 0.032 for plated, 0.008 for birch and ribbon, 0.006 for smooth, 0.004 \
                 for peeling and 0.002 for culm. It is in the normals that light falls on; the mesh keeps its shape, but for \
                 bark_relief_height."
            ),
            see_also(&["bark", "bark_grain", "bark_tile", "bark_relief_height"])
        ),
        field!(
            "bark_relief_height",
            real(0.0, 20.0),
            "m",
            "how high over its foot wood has the relief of its bark in the mesh too; 0: nowhere",
            relief_height_m,
            details(
                "For trunks that are seen from near: 3 is what a person sees beside them. Edges of all wood there that is thicker than an eighth \
                 of bark_tile are halved down to a 24th of it, and vertices moved by the drawn bark: the 310 000 \
                 triangles of an oak's wood become 640 000. For one level of detail without a budget of triangles, and without wind."
            ),
            see_also(&["bark_relief", "bark_tile", "sides", "triangles"])
        ),
        field!(
            "bark_grain",
            real(0.0, 3.0),
            "",
            "strength of the grain: 0 polished, 1 usual",
            grain,
            see_also(&["bark", "bark_relief"])
        ),
        field!(
            "bark_lenticels",
            real(0.0, 1.0),
            "",
            "how many lenticels lie across the bark: 0 only those of its kind, 1 dense rows of bands",
            lenticels,
            details(
                "0.6 and more is a cherry, 0.2 a rowan or a young apple. They are rusty on dark bark and dark on \
                 light bark; limbs and twigs with a bark of their own have them too."
            ),
            see_also(&["bark", "limb_radius", "twig_radius"])
        ),
        field!(
            "limb_radius",
            real(0.0, 10.0),
            "m",
            "wood up to this radius has the bark of limbs: limb_bark and limb_color; 0: all has that of the trunk",
            limbs.radius_m,
            details(
                "Bark is older and rougher the thicker the wood is. 0.06 leaves ridges or plates to the trunk and \
                 to great limbs. The wood is then written in parts, each with a material: wood, wood_limbs, \
                 wood_twigs."
            ),
            see_also(&["twig_radius", "limb_bark", "limb_color", "bark"])
        ),
        field!(
            "limb_bark",
            Kind::Choice(BarkChoice::WORDS),
            "",
            "kind of bark on limbs; auto: smooth",
            limbs.style,
            see_also(&["limb_radius", "bark"])
        ),
        field!(
            "limb_color",
            Kind::Color { auto: true },
            "sRGB",
            "mean colour of the bark of limbs; auto: that of the trunk",
            limbs.color,
            see_also(&["limb_radius", "bark_color"])
        ),
        field!(
            "twig_radius",
            real(0.0, 10.0),
            "m",
            "wood up to this radius has the bark of twigs: twig_bark and twig_color; 0: none has",
            twigs.radius_m,
            details(
                "0.01 is the shoots of the last years, which are green, red or yellow in many kinds: willow, \
                 dogwood, maple, lime in winter."
            ),
            see_also(&["limb_radius", "twig_bark", "twig_color", "bark"])
        ),
        field!(
            "twig_bark",
            Kind::Choice(BarkChoice::WORDS),
            "",
            "kind of bark on twigs; auto: smooth",
            twigs.style,
            see_also(&["twig_radius", "bark"])
        ),
        field!(
            "twig_color",
            Kind::Color { auto: true },
            "sRGB",
            "mean colour of the bark of twigs; auto: that of the trunk",
            twigs.color,
            see_also(&["twig_radius", "bark_color"])
        ),
        field!(
            "foot_bark",
            Kind::Choice(BarkChoice::WORDS),
            "",
            "kind of bark at the foot; auto: ridged",
            foot.style,
            see_also(&["foot_height", "bark"])
        ),
        field!(
            "foot_color",
            Kind::Color { auto: true },
            "sRGB",
            "mean colour of the bark at the foot; auto: that of the trunk",
            foot.color,
            see_also(&["foot_height", "bark_color"])
        ),
        field!(
            "dead_color",
            Kind::Color { auto: false },
            "sRGB",
            "colour of dead twigs (dead_twigs), which have lost their bark",
            dead_color,
            see_also(&["dead_twigs", "bark_color"])
        ),
        MOSS_FIELDS[0],
        MOSS_FIELDS[1],
        MOSS_FIELDS[2],
        MOSS_FIELDS[3],
        MOSS_FIELDS[4],
        field!(
            "bark_size",
            integer(16, 4096),
            "px",
            "side of the drawn pictures",
            size_px,
            details(
                "Twice as many pixels take four times the memory and file. With a bark_tile of 0.5 m 512 is \
                 a millimetre a pixel, enough unless a camera comes close: 1024 and more have finer grain as well. With \
                 bark_relief_height the furrows stand out of the mesh too."
            ),
            see_also(&["bark_tile", "bark_relief_height", "leaf_size", "billboard_size"])
        ),
        field!(
            "bark_seed",
            integer(0, u64::MAX),
            "",
            "another number, another bark of the same kind",
            seed,
            details(
                "It is apart from seed, so that all trees of a kind share one picture: a forest or a batch of them \
                 draws and holds it once."
            ),
            see_also(&["bark", "leaf_seed", "seed"])
        ),
    ];
}
