//! Single blades: an outline and its veins, in the blade's own coordinates.
//!
//! The blade's foot is at (0, 0), its tip at (0, 1); x is in the same units. Outlines run from the
//! foot up the right side to the tip and down the left side.

mod lobed;
mod margin;
mod palmate;
mod simple;
mod veins;

use glam::{Affine2, Vec2};

use super::LeafLook;
use super::figure::{Piece, Skin, Vein};
use super::outline::{Margin, Outline, Veins};
use linden_base::random::Key;

/// The look of a blade to make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BladeLook {
    pub outline: Outline,
    pub width: f32,
    pub lobes: u32,
    pub lobe_depth: f32,
    pub margin: Margin,
    pub teeth: u32,
    pub tooth_depth: f32,
    pub tip: f32,
    pub veins: Veins,
    /// How much one blade differs from the next: 0 all alike, 1 usual.
    pub variation: f32,
}

/// A blade as lines.
#[derive(Clone, Debug)]
pub(super) struct Blade {
    pub outline: Vec<Vec2>,
    pub veins: Vec<Vein>,
    pub bend: f32,
    /// Its width.
    pub breadth: f32,
}

impl BladeLook {
    /// Of a leaf that has such a look, with another outline.
    pub fn of(look: &LeafLook, outline: Outline) -> Self {
        Self {
            outline,
            width: look.width,
            lobes: look.lobes,
            lobe_depth: look.lobe_depth,
            margin: look.margin,
            teeth: look.teeth,
            tooth_depth: look.tooth_depth,
            tip: look.tip,
            veins: look.veins,
            variation: 1.0,
        }
    }

    /// The blade of a key.
    pub fn blade(&self, key: Key) -> Blade {
        let vary =
            |purpose: &str, by: f32| 1.0 + self.variation * by * key.named(purpose).between(-1.0, 1.0) as f32;
        let look = Self { width: self.width * vary("width", 0.1), ..*self };
        let (outline, lobes) = match look.outline {
            Outline::Lobed => lobed::outline(&look, key.named("lobes")),
            Outline::Palmate => palmate::outline(&look, key.named("lobes")),
            _ => (simple::outline(&look, key.named("sides")), Vec::new()),
        };
        // A maple's teeth belong to its lobes.
        let outline = match look.outline {
            Outline::Palmate => outline,
            _ => margin::toothed(&outline, look.margin, look.teeth, look.tooth_depth, key.named("teeth")),
        };
        let veins = veins::veins(&look, &outline, &lobes, key.named("veins"));
        let bend = 0.09 * self.variation * key.named("bend").between(-1.0, 1.0) as f32;
        let mut blade = Blade { outline, veins, bend, breadth: look.width };
        let bent = |p: &mut Vec2| p.x += bend * p.y * p.y;
        blade.outline.iter_mut().for_each(bent);
        blade.veins.iter_mut().flat_map(|vein| &mut vein.points).for_each(bent);
        blade
    }
}

impl Blade {
    /// The blade in a figure.
    pub fn piece(&self, frame: Affine2, skin: Skin) -> Piece {
        let scale = frame.matrix2.y_axis.length();
        let moved = |points: &[Vec2]| points.iter().map(|&p| frame.transform_point2(p)).collect();
        let veins = self.veins.iter().map(|vein| Vein {
            points: moved(&vein.points),
            radius: vein.radius.map(|r| r * scale),
            is_rib: vein.is_rib,
        });
        Piece {
            outline: moved(&self.outline),
            veins: veins.collect(),
            frame,
            bend: self.bend,
            breadth: self.breadth * scale,
            skin,
        }
    }
}

/// A curve through points (Catmull and Rom 1974), `each` steps between two.
fn curve(points: &[Vec2], each: usize) -> Vec<Vec2> {
    let at = |i: isize| points[i.clamp(0, points.len() as isize - 1) as usize];
    let mut out = Vec::with_capacity(points.len() * each);
    for i in 0..points.len() as isize - 1 {
        let [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
        for step in 0..each {
            let t = step as f32 / each as f32;
            let bend = (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t + (3.0 * (b - c) + d - a) * t * t * t;
            out.push(0.5 * (2.0 * b + (c - a) * t + bend));
        }
    }
    out.extend(points.last());
    out
}
