//! The knobs of moss, in `[bark]`.

use linden_base::field;
use linden_base::knob::{Field, Kind, real, real_or_auto};

use super::bark::BarkSettings;

/// Moss and algae on the bark.
#[derive(Clone, Debug, PartialEq)]
pub struct MossSettings {
    /// How much there is, 0 to 1.
    pub amount: f32,
    /// Where it looks to, by the compass: degrees from north (-Z) over east (+X).
    pub side_deg: f64,
    /// The height over the foot at which it is half as dense, metres; `None`: eight radii of the foot.
    pub height_m: Option<f64>,
    /// Thinner wood has none, radius in metres; `None`: a seventh of that of the foot.
    pub radius_m: Option<f64>,
    /// Mean colour of cushions, sRGB.
    pub color: [u8; 3],
}

impl Default for MossSettings {
    /// None; where there is some, on the side away from the sun of the north.
    fn default() -> Self {
        Self { amount: 0.0, side_deg: 0.0, height_m: None, radius_m: None, color: [92, 106, 44] }
    }
}

/// Of the foot's radius, what wood must have for moss where nothing else is said.
const LEAST: f32 = 1.0 / 7.0;

impl MossSettings {
    /// Thinner wood has none, radius in metres, where the foot has a radius.
    pub(crate) fn least_radius_m(&self, foot_m: f32) -> f32 {
        self.radius_m.map_or(LEAST * foot_m, |radius_m| radius_m as f32)
    }
}

/// Its rows, in the order of a document.
pub(super) const MOSS_FIELDS: [Field<BarkSettings>; 5] = [
    field!(
        "moss",
        real(0.0, 1.0),
        "",
        "how much moss and algae there is on thick wood; 0: none",
        moss.amount,
        details(
            "It is densest at the foot, on the side away from the sun (moss_side) and on top of slanting limbs, and \
             thins out in four steps to bare bark: further pictures of the bark with the same normals, so that \
             every format and engine shows it, and no triangle more. Levels of detail have one of these steps, and \
             none below 5000 triangles. 0.2 to 0.4 suits trees in parks, 0.6 to 0.8 \
             those of damp woods. It grows on the trunk's bark: limbs with a bark of their own (limb_radius) have \
             none. Where a step ends follows the seed, the cushions follow bark_seed."
        ),
        see_also(&["moss_side", "moss_height", "moss_radius", "moss_color"])
    ),
    field!(
        "moss_side",
        real(0.0, 360.0),
        "deg",
        "the side that moss grows on, by the compass: 0 north (-Z), 90 east (+X), 180 south",
        moss.side_deg,
        details(
            "North is away from the sun where linden's suns stand (--sun, north of the tropics); 180 is its \
             counterpart in the south, 270 the weather side of western Europe."
        ),
        see_also(&["moss"])
    ),
    field!(
        "moss_height",
        real_or_auto(0.01, 100.0),
        "m",
        "height over the foot at which moss is half as dense; auto: eight radii of the foot",
        moss.height_m,
        see_also(&["moss"])
    ),
    field!(
        "moss_radius",
        real_or_auto(0.0, 10.0),
        "m",
        "radius of the thinnest wood that has moss; auto: a seventh of that of the foot",
        moss.radius_m,
        see_also(&["moss", "limb_radius"])
    ),
    field!(
        "moss_color",
        Kind::Color { auto: false },
        "sRGB",
        "mean colour of moss cushions",
        moss.color,
        see_also(&["moss", "bark_color"])
    ),
];
