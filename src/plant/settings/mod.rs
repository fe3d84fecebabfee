//! How a plant looks: what covers its wood, how much of it is shown, how it moves.

mod bark;
mod bloom;
mod detail;
mod foliage;
mod leaf;
mod lod;
mod moss;
mod surface;
mod wind;

use crate::surface::Tubes;
use crate::texture::{Bark, BarkStyle};
use linden_base::random::Key;

pub use bark::{BarkChoice, BarkSettings, FootBark, ThinBark};
pub(crate) use bark::{LIMBS, TWIGS};
pub use detail::DetailSettings;
pub use foliage::{
    ALSO, Arrangement, Cluster, Edge, FoliageSettings, Form, KIND_NAME, KIND_NAME_HELP, LeafKind, MOST_KINDS,
    Normals, TURNING, check_kind_name, read,
};
pub use leaf::LEAF_KNOBS;
pub use lod::{LodForm, LodForms};
pub use moss::MossSettings;
pub use wind::WindSettings;

/// How a plant looks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dressing {
    /// How its surface is made.
    pub tubes: Tubes,
    /// How its bark looks.
    pub bark: BarkSettings,
    /// How its leaves look.
    pub foliage: FoliageSettings,
    /// How much of it is shown.
    pub detail: DetailSettings,
    /// How it moves.
    pub wind: WindSettings,
}

impl Dressing {
    /// The bark of the foot, where it has one of its own.
    pub fn foot_bark(&self) -> Option<Bark> {
        let (trunk, foot) = (self.bark.bark(), &self.bark.foot);
        let style = BarkStyle::named(foot.style.word()).unwrap_or(BarkStyle::Ridged);
        let usual = Bark::new(style, Key::new(self.bark.seed).named("foot"));
        self.tubes.foot_edge().is_some().then(|| Bark {
            color: foot.color.unwrap_or(trunk.color),
            size_px: trunk.size_px,
            roughness: trunk.roughness,
            ..usual
        })
    }
}
