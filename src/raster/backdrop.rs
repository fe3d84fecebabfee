//! What is behind the tree: nothing, a colour, or level ground that fades into a sky, with the tree's shadow.
//!
//! A row of the picture has one colour, but for the shadow: such a backdrop takes few bytes, in pixels and in
//! cells. The ground is where the camera sees it; it fades into the horizon a few heights of the tree away.

use glam::{Vec2, Vec3, Vec4};

use crate::canvas::Light;
use crate::shade::Shadow;
use crate::style::{Background, Landscape};
use crate::{Extent, Style, View};

/// How much light the deepest shadow swallows.
const SHADOW_DEPTH: f32 = 0.62;
/// Without grain a shadow has so many shades.
const SHADES: f32 = 40.0;
/// Where the ground begins to fade into the horizon and where it has, behind the tree, in its heights.
const FADES: [f32; 2] = [0.5, 2.6];
/// The elevations (sine) from which the sky is no longer, and is wholly, of its upper colour.
const RISES: [f32; 2] = [-0.16, 0.20];

/// What is behind the tree.
pub(crate) struct Backdrop<'a> {
    background: Background,
    grain: bool,
    view: &'a View,
    /// Where the tree stands.
    foot: Vec3,
    /// How large the tree is, metres.
    reach_m: f32,
    shadow: Option<Shadow>,
}

/// A row of it.
pub(crate) struct BackdropRow<'a> {
    /// sRGB, 0 to 1; `None` where nothing is.
    color: Option<Vec3>,
    shadow: Option<RowShadow<'a>>,
    /// For thresholds of rounding, `None` for plain rounding.
    grain: Option<u32>,
    is_soft: bool,
}

/// The ground that a row shows, where the shadow lies.
struct RowShadow<'a> {
    shadow: &'a Shadow,
    /// On the ground: the row's left end, and from one pixel to the next.
    from: Vec2,
    step: Vec2,
    /// How much of it is seen.
    share: f32,
}

impl<'a> Backdrop<'a> {
    /// `shadow` lies on the plane through `foot`, where the tree stands.
    pub fn new(style: &Style, view: &'a View, extent: &Extent, foot: Vec3, shadow: Option<Shadow>) -> Self {
        Self {
            background: style.background,
            grain: style.grain,
            view,
            foot,
            reach_m: extent.height().max(2.0 * extent.radius()).max(1e-6),
            shadow: shadow.filter(|_| view.is_above(foot.y)),
        }
    }

    /// The row that is `y` below the upper edge of a picture.
    pub fn row(&self, y: u32, height: u32) -> BackdropRow<'_> {
        let (left, way) = (self.view.ray(Vec2::new(0.5, y as f32 + 0.5)), self.view.right());
        // Rows are level: all of one has one height over the ground, and one way to it.
        let eye = self.view.eye();
        let way_m = (self.foot.y - eye.y) / left.y;
        let sees_ground = left.y < 0.0 && way_m > 0.0;
        let ground = if sees_ground { self.ground_share(eye, left, way_m) } else { 0.0 };
        // Gradients are even to the eye in sRGB.
        let color = match self.background {
            Background::Transparent => None,
            Background::Plain(color) => Some(coded(color)),
            Background::Gradient(top, bottom) => {
                let t = if height > 1 { y as f32 / (height - 1) as f32 } else { 0.5 };
                Some(coded(top).lerp(coded(bottom), t))
            }
            Background::Landscape(landscape) => Some(seen(landscape, left, ground)),
        };
        let shadow = self.shadow.as_ref().filter(|_| sees_ground).map(|shadow| {
            let from = eye + left * way_m;
            let step = way * (way_m / self.view.scale_at_nearness());
            let share = if matches!(self.background, Background::Landscape(_)) { ground } else { 1.0 };
            RowShadow { shadow, from: Vec2::new(from.x, from.z), step: Vec2::new(step.x, step.z), share }
        });
        BackdropRow { color, shadow, grain: self.grain.then_some(y), is_soft: self.grain }
    }

    /// How much of the ground is seen: less the farther it is behind the tree.
    fn ground_share(&self, eye: Vec3, ray: Vec3, way_m: f32) -> f32 {
        let front = self.view.right().cross(Vec3::Y);
        // Along the middle column: the same for all of a row.
        let place = eye + ray * way_m;
        let behind = (self.foot - place).dot(front) / self.reach_m;
        1.0 - smooth((behind - FADES[0]) / (FADES[1] - FADES[0]))
    }
}

impl BackdropRow<'_> {
    /// The finished pixel: what was drawn (premultiplied linear light), and this behind it.
    pub fn below(&self, drawn: Vec4, x: u32, curve: &Light) -> [u8; 4] {
        let (light, alpha) = (drawn.truncate(), drawn.w.clamp(0.0, 1.0));
        let shade = self.shadow.as_ref().filter(|_| alpha < 1.0).map_or(0.0, |row| {
            let dark = row.shadow.at(row.from + row.step * x as f32) * row.share * SHADOW_DEPTH;
            if self.is_soft { dark } else { (dark * SHADES).round() / SHADES }
        });
        let Some(plain) = self.color else {
            let whole = alpha + (1.0 - alpha) * shade;
            let color = if whole > 0.0 { curve.srgb(light / whole) } else { Vec3::ZERO };
            let [r, g, b] = (color * 255.0 + 0.5).to_array().map(|c| c as u8);
            return [r, g, b, (whole * 255.0 + 0.5) as u8];
        };
        let color = if alpha == 0.0 && shade == 0.0 {
            plain
        } else {
            curve.srgb(light + curve.linear(plain) * ((1.0 - alpha) * (1.0 - shade)))
        };
        let threshold = self.grain.map_or(0.5, |y| grain(x, y));
        let [r, g, b] = (color * 255.0 + threshold).to_array().map(|c| c as u8);
        [r, g, b, 255]
    }
}

/// What a row of a landscape shows, of which a share is ground.
fn seen(landscape: Landscape, ray: Vec3, ground: f32) -> Vec3 {
    let [sky, horizon, below] = [landscape.sky, landscape.horizon, landscape.ground].map(coded);
    let elevation = ray.y / ray.length();
    horizon.lerp(sky, smooth((elevation - RISES[0]) / (RISES[1] - RISES[0]))).lerp(below, ground)
}

fn coded(color: [u8; 3]) -> Vec3 {
    Vec3::from(color.map(f32::from)) / 255.0
}

/// From 0 to 1 without a corner.
fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Threshold 0..1 for rounding, "interleaved gradient noise" (Jimenez 2014, "Next generation
/// post-processing in Call of Duty", slide 123): neighbours differ much, areas little.
fn grain(x: u32, y: u32) -> f32 {
    let f = 0.067_110_56 * f64::from(x) + 0.005_837_15 * f64::from(y);
    let g = 52.982_918_9 * (f - f.floor());
    (g - g.floor()) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::compose;
    use crate::extent::RINGS;
    use crate::{Camera, Size};
    use linden_pipeline::Quiet;

    fn drawn(pitch: f32, style: &Style) -> Vec<Vec<[u8; 4]>> {
        let extent = Extent { x: 0.0, z: 0.0, bottom: 0.0, top: 9.0, radii: [4.0; RINGS], person: None };
        let size = Size::new(60, 80).unwrap();
        let view = Camera::orbit(40.0, pitch).view(extent, size);
        let backdrop = Backdrop::new(style, &view, &extent, Vec3::ZERO, None);
        let picture = compose(size, &backdrop, &Quiet, |_, _| Ok(())).unwrap();
        picture.rgba().chunks(60 * 4).map(|row| row.as_chunks::<4>().0.to_vec()).collect()
    }

    #[test]
    fn a_landscape_has_one_colour_a_row_and_its_horizon_where_the_camera_sees_it() {
        let style = Style::landscape([16, 16, 18], true);
        let Background::Landscape(landscape) = style.background else { panic!() };
        let is = |pixel: [u8; 4], color: [u8; 3]| (0..3).all(|i| pixel[i].abs_diff(color[i]) < 8);
        for pitch in [-40.0, 0.0, 8.0, 90.0] {
            let rows = drawn(pitch, &style);
            assert!(rows.iter().all(|row| row.iter().all(|pixel| *pixel == row[0])), "{pitch}");
        }
        // From above there is ground alone, from below sky.
        assert!(drawn(90.0, &style).iter().all(|row| is(row[0], landscape.ground)));
        assert!(drawn(-40.0, &style).iter().all(|row| is(row[0], landscape.sky)));
        let level = drawn(8.0, &style);
        assert!(is(level[79][0], landscape.ground) && !is(level[0][0], landscape.ground));
    }

    #[test]
    fn a_terminals_landscape_is_in_keeping_with_its_background() {
        let light = |color: [u8; 3]| color.iter().map(|&c| u32::from(c)).sum::<u32>() / 3;
        for (background, dark) in [([0, 43, 54], true), ([16, 16, 18], true), ([253, 246, 227], false)] {
            let Landscape { sky, horizon, ground } = Landscape::over(background, dark);
            for color in [sky, horizon, ground] {
                assert!(light(color).abs_diff(light(background)) < 80, "{color:?} over {background:?}");
                assert_eq!(light(color) < 128, dark);
            }
        }
    }
}
