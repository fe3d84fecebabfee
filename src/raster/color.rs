//! Colour: linear light, Oklab, and the ramp that shows quantities.
//!
//! Shading multiplies in linear light. The ramp walks evenly through Oklab (Björn Ottosson 2020,
//! "A perceptual color space for image processing"), from blue over green to yellow with rising
//! lightness: read by lightness alone, and free of the red-green distinction.

use glam::Vec3;
use linden_pipeline::color::encode;

/// An sRGB byte triple in linear light, 0..1.
pub fn linear(srgb: [u8; 3]) -> Vec3 {
    Vec3::from(linden_pipeline::color::linear(srgb))
}

/// Linear light as sRGB 0..1, clamped.
pub fn encoded(linear: Vec3) -> Vec3 {
    Vec3::from(linear.to_array().map(|c| encode(c.clamp(0.0, 1.0))))
}

/// Lightness, green-red and blue-yellow in linear light.
fn from_oklab(lab: Vec3) -> Vec3 {
    let l = lab.x + 0.396_337_78 * lab.y + 0.215_803_76 * lab.z;
    let m = lab.x - 0.105_561_346 * lab.y - 0.063_854_17 * lab.z;
    let s = lab.x - 0.089_484_18 * lab.y - 1.291_485_5 * lab.z;
    let (l, m, s) = (l * l * l, m * m * m, s * s * s);
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

/// Knots of the ramp in Oklab. Lightness rises in proportion to the way between them.
const RAMP: [Vec3; 5] = [
    Vec3::new(0.45, -0.010, -0.140),
    Vec3::new(0.55, -0.050, -0.085),
    Vec3::new(0.66, -0.085, 0.000),
    Vec3::new(0.78, -0.075, 0.095),
    Vec3::new(0.90, -0.020, 0.150),
];

/// A quantity `t` in 0..1 as a colour in linear light: even steps look evenly far apart.
pub fn ramp(t: f32) -> Vec3 {
    let lengths: [f32; 4] = std::array::from_fn(|i| (RAMP[i + 1] - RAMP[i]).length());
    let mut way = t.clamp(0.0, 1.0) * lengths.iter().sum::<f32>();
    for (i, length) in lengths.into_iter().enumerate() {
        if way <= length || i == 3 {
            let lab = RAMP[i].lerp(RAMP[i + 1], (way / length).min(1.0));
            return from_oklab(lab).clamp(Vec3::ZERO, Vec3::ONE);
        }
        way -= length;
    }
    from_oklab(RAMP[4])
}

/// Relative luminance of linear light (Rec. 709 primaries).
pub fn luminance(linear: Vec3) -> f32 {
    linear.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oklab_of_the_published_examples() {
        // The table in Ottosson's article gives XYZ = (0.950, 1.000, 1.089), white, as Lab (1, 0, 0).
        assert!((from_oklab(Vec3::X) - Vec3::ONE).abs().max_element() < 1e-3);
        // sRGB red is Oklab (0.628, 0.225, 0.126) in every implementation of the CSS Color 4 draft.
        let red = from_oklab(Vec3::new(0.627_96, 0.224_86, 0.125_85));
        assert!((red - Vec3::X).abs().max_element() < 1e-3, "{red}");
    }

    /// CIE L*a*b* differences, a metric that the ramp was not made with.
    #[test]
    fn steps_are_even_and_lightness_rises() {
        let lab = |t: f32| {
            let c = ramp(t);
            let xyz = [
                c.dot(Vec3::new(0.4124, 0.3576, 0.1805)) / 0.9505,
                c.dot(Vec3::new(0.2126, 0.7152, 0.0722)),
                c.dot(Vec3::new(0.0193, 0.1192, 0.9505)) / 1.089,
            ];
            let [x, y, z] = xyz.map(libm::cbrtf);
            Vec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
        };
        let steps: Vec<Vec3> = (0..=16).map(|i| lab(i as f32 / 16.0)).collect();
        let far: Vec<f32> = steps.windows(2).map(|w| (w[1] - w[0]).length()).collect();
        let (least, most) = far.iter().fold((f32::MAX, 0.0_f32), |(a, b), &d| (a.min(d), b.max(d)));
        assert!(most / least < 2.0, "{far:?}");
        assert!(steps.windows(2).all(|w| w[1].x > w[0].x + 2.0), "{steps:?}");
    }

    #[test]
    fn the_ramp_lies_inside_srgb() {
        for knot in RAMP {
            let c = from_oklab(knot);
            assert!(c.min_element() > -0.02 && c.max_element() < 1.02, "{knot} is {c}");
        }
    }
}
