//! What a tree's thickness at the foot goes by, to make it that of a younger one.

use crate::{Branching, NO_PARENT, Wood};

use super::pipe::count_tips;
use super::{Width, height};

/// What the thickness of a tree's foot goes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Girth {
    /// Of the stem that bears most.
    tips: u32,
    height_m: f64,
    /// The thickest radius that the generator gave, if it gave any, metres.
    given_m: Option<f64>,
}

impl Girth {
    /// That of a tree as a generator leaves it.
    pub fn of(branching: &Branching) -> Self {
        let Branching { positions, parents, radii, .. } = branching;
        let tips = count_tips(parents);
        let feet = parents.iter().zip(&tips).filter(|(parent, _)| **parent == NO_PARENT);
        let thickest = radii.as_ref().map(|radii| radii.iter().copied().fold(0.0, f32::max));
        Self {
            tips: feet.map(|(_, &tips)| tips).max().unwrap_or(1).max(1),
            height_m: height(positions),
            given_m: thickest.filter(|thickest| *thickest > 0.0).map(f64::from),
        }
    }
}

impl Wood {
    /// The wood of a younger tree: where the radius at the foot is given, that is of the whole one. By the pipe model twigs
    /// are as thick as the whole tree's; by order and taper the foot is as thick as the tree has reached of its height;
    /// radii that the generator gives have the scale of the whole tree's.
    ///
    /// ```
    /// use glam::Vec3;
    /// use linden_skeleton::{Branching, Girth, NO_PARENT, Wood};
    /// let fork = Branching {
    ///     positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::X + Vec3::Y],
    ///     parents: vec![NO_PARENT, 0, 1, 1],
    ///     births: vec![0, 1, 2, 2],
    ///     radii: None,
    ///     edges: None,
    /// };
    /// let mut shoot = fork.clone();
    /// shoot.positions.truncate(2);
    /// shoot.parents.truncate(2);
    /// let wood = Wood { base_radius_m: Some(0.2), radius_exponent: 2.0, ..Wood::default() };
    /// let young = wood.when_young(&Girth::of(&fork), &Girth::of(&shoot));
    /// assert!((young.base_radius_m.unwrap() - 0.2 / 2.0_f64.sqrt()).abs() < 1e-12); // one tip of two
    /// ```
    #[must_use]
    pub fn when_young(&self, whole: &Girth, young: &Girth) -> Self {
        let Some(base_m) = self.base_radius_m else { return *self };
        let ratio = |young: f64, whole: f64| if whole > 0.0 { (young / whole).min(1.0) } else { 1.0 };
        let share = match (self.width, young.given_m.zip(whole.given_m)) {
            (Width::Auto | Width::Grammar, Some((young_m, whole_m))) => ratio(young_m, whole_m),
            (Width::Order | Width::Taper, _) => ratio(young.height_m, whole.height_m),
            _ => {
                let tips = ratio(f64::from(young.tips), f64::from(whole.tips));
                libm::pow(tips, 1.0 / self.radius_exponent)
            }
        };
        let least_m = self.tip_radius_m.unwrap_or(0.0).min(base_m);
        Self { base_radius_m: Some((base_m * share).max(least_m)), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use linden_base::random::Key;

    use super::*;
    use crate::Skeleton;

    /// A stem that forks at each node, as high as there are levels.
    fn bush(levels: u32) -> Branching {
        let mut all = Branching {
            positions: vec![Vec3::ZERO],
            parents: vec![NO_PARENT],
            births: vec![0],
            ..Branching::default()
        };
        let mut ends = vec![0_u32];
        for level in 1..=levels {
            let mut next = Vec::new();
            for &end in &ends {
                for side in [-1.0, 1.0] {
                    let at = all.positions[end as usize] + Vec3::new(side / f32::from(level as u8), 1.0, 0.0);
                    next.push(all.positions.len() as u32);
                    all.positions.push(at);
                    all.parents.push(end);
                    all.births.push(level);
                }
            }
            ends = next;
        }
        all
    }

    #[test]
    fn a_tree_that_is_grown_again_is_as_thick_as_one_that_was_cut_back() {
        for width in [Width::Pipe, Width::Order] {
            let wood = Wood { width, base_radius_m: Some(0.4), ..Wood::default() };
            let (whole, young) = (bush(7), bush(4));
            let again = wood.when_young(&Girth::of(&whole), &Girth::of(&young));
            let again = Skeleton::build(young, &again).unwrap();
            let cut =
                Skeleton::build(whole, &wood).unwrap().until(4, &wood.settled(false, false), Key::new(0));
            assert_eq!(again.positions, cut.positions);
            for (a, b) in again.radii.iter().zip(&cut.radii) {
                assert!((a / b - 1.0).abs() < 1e-5, "{width:?}: {a} {b}");
            }
            assert!(again.radii[0] < 0.25, "{}", again.radii[0]);
        }
    }

    #[test]
    fn radii_that_are_given_keep_the_scale_of_the_whole_tree() {
        let wood = Wood { base_radius_m: Some(0.4), ..Wood::default() };
        let (mut whole, mut young) = (bush(3), bush(2));
        whole.radii = Some(vec![0.2; whole.positions.len()]);
        young.radii = Some(vec![0.05; young.positions.len()]);
        let again = wood.when_young(&Girth::of(&whole), &Girth::of(&young));
        assert!((again.base_radius_m.unwrap() - 0.1).abs() < 1e-9);
        let thick = Wood { tip_radius_m: Some(0.3), ..wood };
        assert_eq!(thick.when_young(&Girth::of(&whole), &Girth::of(&young)).base_radius_m, Some(0.3));
        let free = Wood { base_radius_m: None, ..wood };
        assert_eq!(free.when_young(&Girth::of(&whole), &Girth::of(&young)), free);
    }
}
