//! Stools: several stems that rise where one tree would stand.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use linden_base::random::Key;

use crate::SelfOrganizing;

/// The most stems of a stool.
pub(crate) const MOST_STEMS: u32 = 100;

/// Between neighbours in a spiral that fills a disc evenly, radians: the golden angle (Vogel 1979, A better way to
/// construct the sunflower head).
const GOLDEN_ANGLE: f64 = PI * (3.0 - 2.236_067_977_499_79);

/// How far a stem's lean differs from that of its place, as a share.
const LEAN_SPREAD: f64 = 0.25;

/// A seedling, or a rod of a stool.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stem {
    /// On the ground, metres.
    pub foot: DVec2,
    /// Where it begins to grow, of length 1.
    pub direction: DVec3,
    /// What is drawn of it.
    pub key: Key,
}

/// The stems on a tree's foot, metres: one that is upright, or several on a disc about it, which lean outwards the
/// further they are from its middle.
pub(crate) fn stems(
    settings: &SelfOrganizing,
    foot: DVec2,
    key: Key,
) -> impl Iterator<Item = Stem> + use<'_> {
    let count = settings.stems;
    let first = key.named("stool").unit();
    (0..count).map(move |number| {
        if count == 1 {
            return Stem { foot, direction: DVec3::Y, key };
        }
        let key = key.named("stem").child(number.into());
        let outwards = libm::sqrt((f64::from(number) + 0.5) / f64::from(count));
        let (sin, cos) = libm::sincos(2.0 * PI * first + GOLDEN_ANGLE * f64::from(number));
        let drawn = 1.0 + LEAN_SPREAD * key.named("lean").between(-1.0, 1.0);
        let lean = (settings.stem_lean_deg * outwards * drawn).to_radians();
        let (out, up) = libm::sincos(lean);
        Stem {
            foot: foot + DVec2::new(cos, sin) * (settings.stool_m * outwards),
            direction: DVec3::new(cos * out, up, sin * out),
            key,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_skeleton::NO_PARENT;

    use crate::{Barriers, LightModel, Planted, grow, grow_among};

    fn hazel() -> SelfOrganizing {
        SelfOrganizing {
            stems: 12,
            stool_m: 0.4,
            stem_lean_deg: 30.0,
            years: 8,
            shed: 0.0,
            ..SelfOrganizing::default()
        }
    }

    fn feet(settings: &SelfOrganizing) -> Vec<glam::Vec3> {
        let branching = grow(settings, Key::new(3), &Quiet).unwrap().branching;
        let is_foot = |node: &usize| branching.parents[*node] == NO_PARENT;
        (0..branching.parents.len()).filter(is_foot).map(|node| branching.positions[node]).collect()
    }

    #[test]
    fn stems_stand_on_the_stool_apart_and_fill_it() {
        let settings = hazel();
        let feet = feet(&settings);
        assert_eq!(feet.len(), 12);
        let out: Vec<f32> = feet.iter().map(|foot| foot.length()).collect();
        assert!(feet.iter().all(|foot| foot.y == 0.0) && out.iter().all(|&out| out < 0.4), "{out:?}");
        // A disc of half the area holds half of them.
        assert_eq!(out.iter().filter(|&&out| out < 0.4 / f32::sqrt(2.0)).count(), 6);
        for (number, foot) in feet.iter().enumerate() {
            // Twelve of them take a circle of 0.115 m each.
            let nearest = feet[..number].iter().map(|other| foot.distance(*other)).fold(1.0, f32::min);
            assert!(nearest > 0.1, "{number}: {nearest}");
        }
    }

    #[test]
    fn stems_lean_outwards_by_what_is_asked() {
        let all: Vec<Stem> = stems(&hazel(), DVec2::new(5.0, -2.0), Key::new(9)).collect();
        for stem in &all {
            let place = stem.foot - DVec2::new(5.0, -2.0);
            let across = DVec2::new(stem.direction.x, stem.direction.z);
            assert!((stem.direction.length() - 1.0).abs() < 1e-12);
            assert!(across.perp_dot(place).abs() < 1e-12 && across.dot(place) > 0.0);
            let lean = libm::acos(stem.direction.y).to_degrees();
            let wanted = 30.0 * place.length() / 0.4;
            assert!((0.75 * wanted..=1.25 * wanted).contains(&lean), "{lean} of {wanted}");
        }
        let upright = SelfOrganizing { stem_lean_deg: 0.0, ..hazel() };
        assert!(stems(&upright, DVec2::ZERO, Key::new(9)).all(|stem| stem.direction == DVec3::Y));
    }

    /// So many stems that those of a small stool die.
    fn crowded(stool_m: f64) -> SelfOrganizing {
        SelfOrganizing {
            stems: 60,
            stool_m,
            stem_lean_deg: 0.0,
            years: 20,
            light: LightModel::Sky,
            shade: 0.35,
            shed: 0.3,
            ..hazel()
        }
    }

    #[test]
    fn the_stems_of_a_stool_thin_themselves_in_each_others_shade() {
        let died = [0.1, 0.2, 10.0].map(|stool_m| grow(&crowded(stool_m), Key::new(3), &Quiet).unwrap().died);
        assert!(died[0] >= died[1] && died[1] > 0 && died[2] == 0, "{died:?}");
        assert_eq!(feet(&crowded(0.2)).len(), 60 - died[1]);
    }

    /// The second of three stools is felled, and some rods of the others die.
    #[test]
    fn each_foot_says_which_stool_it_is_of() {
        let settings = crowded(0.2);
        let at = [-6.0, 0.0, 6.0].map(|x| glam::Vec3::new(x, 0.0, 0.0));
        let planted = at.map(|foot| Planted { foot, felled_in: if foot.x == 0.0 { 12 } else { 0 } });
        let grown = grow_among(&settings, &planted, &Barriers::default(), Key::new(3), &Quiet).unwrap();
        assert!(grown.died > 0);
        let parents = &grown.branching.parents;
        let feet: Vec<usize> = (0..parents.len()).filter(|&node| parents[node] == NO_PARENT).collect();
        assert_eq!(feet.len(), grown.trees.len());
        for (&foot, &tree) in feet.iter().zip(&grown.trees) {
            assert!(grown.branching.positions[foot].distance(at[tree as usize]) < 0.25, "{foot}: {tree}");
        }
        assert!(grown.trees.contains(&0) && grown.trees.contains(&2) && !grown.trees.contains(&1));
        // One stool is one tree, of which nothing is to be said.
        assert!(grow(&hazel(), Key::new(3), &Quiet).unwrap().trees.is_empty());
    }
}
