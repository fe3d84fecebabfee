//! The colours of one leaf, by variant and season.

use glam::{Vec2, Vec3};

use super::LeafLook;
use super::figure::Skin;
use linden_base::color::linear;
use linden_base::random::Key;

/// Young leaves: light, yellow-green.
const FLUSH: [u8; 3] = [158, 186, 84];

/// When leaves that unfold at season 0 are full-grown and dark.
const SUMMER: f32 = 0.25;

/// One leaf's colours, linear light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tint {
    pub blade: Vec3,
    /// The colour of what the change has reached.
    pub patch: Vec3,
    pub patch_share: f32,
    pub vein: Vec3,
    pub stalk: Vec3,
}

impl Tint {
    /// The tint of a variant, or of one leaf on a twig, which `key` tells from others.
    pub fn new(look: &LeafLook, variant: u32, key: Key) -> Self {
        let spread = look.color_spread;
        let vary = |name: &str| key.named(name).between(-1.0, 1.0) as f32 * spread;
        let summers = if look.colors.is_empty() { &[[90, 120, 60]][..] } else { &look.colors[..] };
        // In their order where they have one, otherwise in turn.
        let index = if look.shade > 0.0 {
            variant as usize * summers.len() / look.variants.max(1) as usize
        } else {
            variant as usize
        };
        let summer = Vec3::from(linear(summers[index % summers.len()]));
        // Lighter or darker, and more or less yellow.
        let summer = summer * (1.0 + 0.22 * vary("light")) * Vec3::new(1.0 + 0.16 * vary("warm"), 1.0, 1.0);
        // From shade to sun, -1 to 1.
        let place = 2.0 * variant as f32 / look.variants.saturating_sub(1).max(1) as f32 - 1.0;
        let sun = if look.variants > 1 { look.shade * place } else { 0.0 };
        let summer = summer * (1.0 + 0.25 * sun) * Vec3::new(1.0 + 0.12 * sun, 1.0, 1.0 - 0.12 * sun);
        let season = look.season;
        let young = 1.0 - look.ripeness.unwrap_or(season / SUMMER).min(1.0);
        let is_green = summer.y > summer.x;
        let green = match look.young_colors.len() {
            0 if is_green => summer.lerp(Vec3::from(linear(FLUSH)), 0.75 * young),
            0 => summer,
            youngs => summer.lerp(Vec3::from(linear(look.young_colors[variant as usize % youngs])), young),
        };
        // Leaves turn one after another.
        let late = 0.28 * (0.35 + spread) * key.named("late").between(-1.0, 1.0) as f32;
        let [first, last] = look.turning;
        let turned = (season - first) / (last - first).max(1e-3);
        let turned =
            if turned > 0.0 { (turned + late * (4.0 * turned).min(1.0)).clamp(0.0, 1.0) } else { 0.0 };
        let ramp = |at: f32| -> Vec3 {
            let stops = look.autumn_colors.len();
            let at = at.clamp(0.0, 1.0) * stops as f32;
            let stop = |i: usize| {
                if i == 0 {
                    green
                } else {
                    Vec3::from(linear(look.autumn_colors[i - 1])) * (1.0 + 0.15 * vary("autumn"))
                }
            };
            let low = (at as usize).min(stops.saturating_sub(1));
            if stops == 0 { green } else { stop(low).lerp(stop(low + 1), at - low as f32) }
        };
        let blade = ramp(turned);
        let patch = ramp(turned + 0.3 * (turned * 4.0).min(1.0));
        let vein = look.vein_color.map_or_else(
            // Paler; yellow in the end.
            || (ramp(turned * 0.7) * 1.5 + Vec3::new(0.045, 0.055, 0.018)).min(Vec3::splat(0.8)),
            |color| Vec3::from(linear(color)),
        );
        let stalk = (vein * 0.8).lerp(Vec3::from(linear([150, 84, 56])), 0.25);
        Self { blade, patch, patch_share: (turned * 3.0).min(0.55), vein, stalk }
    }

    /// A blade's skin.
    pub fn blade(&self, look: &LeafLook, key: Key) -> Skin {
        let place = Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32);
        Skin {
            color: self.blade,
            patch: self.patch,
            patch_share: self.patch_share,
            vein: self.vein,
            vein_strength: 0.62 * look.vein_strength,
            foot: self.blade.lerp(self.vein, 0.3),
            foot_reach: 0.25,
            mottle: 0.13,
            fold: 0.16,
            droop: 0.25,
            pillow: 0.34,
            bevel: 0.004,
            lean: Vec2::ZERO,
            shadow: 0.4,
            place,
        }
    }

    /// The skin of petioles and of the rachis.
    pub fn stalk(&self, key: Key) -> Skin {
        let place = Vec2::new(key.named("u").unit() as f32, key.named("v").unit() as f32);
        Skin { color: self.stalk, patch: self.stalk, mottle: 0.1, shadow: 0.3, place, ..Skin::default() }
    }
}
