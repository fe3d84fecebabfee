//! The pipe model: `r^n = Σ r_child^n` (Shinozaki et al. 1964; RLP07 section 4.3).
//!
//! A node's *pipes* are `r^n` in units of a tip's. By default each tip ends one pipe, so that a node
//! has as many as it carries tips. With an angle share, forks deal their pipes out unevenly: see
//! [`straight_on`]. Either way a fork has as many pipes above it as below, exactly.

use std::cmp::Ordering;

use glam::Vec3;
use rayon::prelude::*;

use super::{Wood, height};
use crate::NO_PARENT;
use crate::axes::straightness;

/// How many tips (nodes without children) each node carries, itself included when it is one.
pub fn count_tips(parents: &[u32]) -> Vec<u32> {
    let mut tips = vec![0_u32; parents.len()];
    for node in (0..parents.len()).rev() {
        tips[node] = tips[node].max(1);
        if parents[node] != NO_PARENT {
            tips[parents[node] as usize] += tips[node];
        }
    }
    tips
}

/// The pipes of each node.
pub(super) enum Pipes {
    /// One for each tip.
    Even(Vec<u32>),
    /// Dealt out by angle.
    ByAngle(Vec<f64>),
}

/// The fewest pipes that a tip is left with where no tip radius is given: for n = 2 it is a quarter
/// as thick as the mean then.
const FEWEST: f64 = 1.0 / 16.0;

/// Pipes that differ by no more than rounding, relatively: the angles come in single precision.
const SAME: f64 = 1e-5;

impl Pipes {
    pub fn new(positions: &[Vec3], parents: &[u32], wood: &Wood) -> Self {
        let tips = count_tips(parents);
        if wood.angle_share == 0.0 {
            return Self::Even(tips);
        }
        // A tip radius alone is that of one pipe, and nothing is thinner.
        let tip_decides = wood.tip_radius_m.is_some() && wood.base_radius_m.is_none();
        let fewest = if tip_decides { 1.0 } else { FEWEST };
        Self::ByAngle(shared(positions, parents, &tips, wood.angle_share, fewest))
    }

    fn most(&self) -> f64 {
        match self {
            Self::Even(tips) => f64::from(tips.par_iter().copied().max().unwrap_or(1)),
            Self::ByAngle(pipes) => pipes.par_iter().copied().reduce(|| 0.0, f64::max),
        }
    }

    /// Which of two nodes is thicker.
    pub fn compare(&self, a: u32, b: u32) -> Ordering {
        match self {
            Self::Even(tips) => tips[a as usize].cmp(&tips[b as usize]),
            Self::ByAngle(pipes) => {
                let (a, b) = (pipes[a as usize], pipes[b as usize]);
                if (a - b).abs() <= SAME * a.max(b) { Ordering::Equal } else { a.total_cmp(&b) }
            }
        }
    }
}

/// Deals a stem's pipes, as many as it carries tips, out from the foot upwards: at a fork in
/// proportion to each child's tips and to how [`straight_on`] it leads. Tips that are left with
/// fewer than `fewest` get as many; then the sums are taken from the tips down, so that no fork
/// gains or loses any.
fn shared(positions: &[Vec3], parents: &[u32], tips: &[u32], share: f64, fewest: f64) -> Vec<f64> {
    let mut pipes: Vec<f64> = (0..parents.len() as u32)
        .into_par_iter()
        .map(|node| {
            let tip_count = f64::from(tips[node as usize]);
            if parents[node as usize] == NO_PARENT {
                return tip_count;
            }
            tip_count * straight_on(f64::from(straightness(positions, parents, node)), share)
        })
        .collect();
    let mut claims = vec![0.0_f64; parents.len()];
    for (&parent, &claim) in parents.iter().zip(&pipes).filter(|(parent, _)| **parent != NO_PARENT) {
        claims[parent as usize] += claim;
    }
    for node in 0..parents.len() {
        if parents[node] != NO_PARENT {
            let parent = parents[node] as usize;
            pipes[node] *= pipes[parent] / claims[parent];
        }
    }
    for (pipe, &claimed) in pipes.iter_mut().zip(&claims) {
        *pipe = if claimed == 0.0 { pipe.max(fewest) } else { 0.0 };
    }
    for node in (0..parents.len()).rev() {
        if parents[node] != NO_PARENT {
            pipes[parents[node] as usize] += pipes[node];
        }
    }
    pipes
}

/// How much of its claim a child keeps that leaves at an angle of this cosine.
///
/// `(1 + cos θ) / 2` is 1 straight on, 1/2 at a right angle and 0 straight back. The direction is
/// Murray's (1926, "The physiological principle of minimum work applied to the angle of branching of
/// arteries"): where the vessels of least work fork, the thinner one turns more. His law itself,
/// `r1² : r2² = sin θ2 : sin θ1` in a plane, would leave nothing for a lateral of a straight axis
/// and says nothing of three children, so this is a rule of thumb of the same tendency.
fn straight_on(cosine: f64, share: f64) -> f64 {
    /// Wood that turns straight back is still wood.
    const LEAST: f64 = 1.0 / 64.0;
    (1.0 - share * (1.0 - cosine) * 0.5).clamp(LEAST, 1.0)
}

/// The pipe model with its constants found.
pub(super) struct Thickness {
    /// Of a pipe, metres.
    unit: f64,
    /// Nothing is thinner, metres.
    thinnest: f64,
    exponent: f64,
}

impl Thickness {
    /// For a whole tree. With both ends given the base wins, and nothing is thinner than the tip
    /// radius.
    pub fn new(positions: &[Vec3], pipes: &Pipes, wood: &Wood) -> Self {
        let exponent = wood.radius_exponent;
        let from_base = |base: f64| base / libm::pow(pipes.most(), 1.0 / exponent);
        let (unit, thinnest) = match (wood.tip_radius_m, wood.base_radius_m) {
            (Some(tip), None) => (tip, tip),
            (tip, Some(base)) => (from_base(base), tip.unwrap_or(0.0).min(base)),
            (None, None) => (from_base(wood.base_of_height(height(positions))), 0.0),
        };
        Self { unit, thinnest, exponent }
    }

    /// Of a node, metres: with equal tips the pipe model is `r = r_tip · tips^(1/n)` exactly.
    fn radius(&self, pipes: f64) -> f32 {
        (self.unit * libm::pow(pipes, 1.0 / self.exponent)).max(self.thinnest) as f32
    }

    pub fn radii(&self, pipes: &Pipes) -> Vec<f32> {
        match pipes {
            Pipes::Even(tips) => {
                // Most nodes carry few tips: pow is slow, a small table is not.
                let table: Vec<f32> = (0..4096).map(|count| self.radius(f64::from(count))).collect();
                let of = |&count: &u32| {
                    table.get(count as usize).copied().unwrap_or_else(|| self.radius(f64::from(count)))
                };
                tips.par_iter().map(of).collect()
            }
            Pipes::ByAngle(pipes) => pipes.par_iter().map(|&pipes| self.radius(pipes)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stem of two nodes that forks into a lateral with two tips and a straight tip.
    const PARENTS: [u32; 6] = [NO_PARENT, 0, 1, 1, 2, 2];

    fn positions() -> Vec<Vec3> {
        [(0., 0.), (0., 1.), (1., 2.), (0., 3.), (2., 2.), (1., 3.)]
            .map(|(x, y)| Vec3::new(x, y, 0.0))
            .to_vec()
    }

    fn radii_by(wood: &Wood) -> Vec<f32> {
        let pipes = Pipes::new(&positions(), &PARENTS, wood);
        Thickness::new(&positions(), &pipes, wood).radii(&pipes)
    }

    #[test]
    fn every_fork_obeys_the_pipe_model() {
        for exponent in [1.8, 2.0, 2.5, 3.0] {
            let wood = Wood { radius_exponent: exponent, tip_radius_m: Some(0.01), ..Wood::default() };
            let radii = radii_by(&wood);
            for node in 0..PARENTS.len() {
                let children: Vec<usize> =
                    (0..PARENTS.len()).filter(|&c| PARENTS[c] == node as u32).collect();
                let expected = if children.is_empty() {
                    libm::pow(0.01, exponent)
                } else {
                    children.iter().map(|&c| libm::pow(f64::from(radii[c]), exponent)).sum()
                };
                let found = libm::pow(f64::from(radii[node]), exponent);
                assert!((found / expected - 1.0).abs() < 1e-5, "node {node}: {found} against {expected}");
            }
        }
    }

    #[test]
    fn a_given_base_is_kept_and_a_given_tip_is_the_least() {
        let both = Wood { tip_radius_m: Some(0.4), base_radius_m: Some(0.5), ..Wood::default() };
        let radii = radii_by(&both);
        assert_eq!(radii[0], 0.5);
        assert!(radii.iter().all(|&r| r >= 0.4));
        let neither = radii_by(&Wood::default());
        assert!((neither[0] - 3.0 / 60.0).abs() < 1e-6, "the height is 3 m");
    }

    /// The stem leads to (0, 1); from there a lateral at 45° carries two tips, (0, 3) goes straight
    /// on; the two that leave the lateral do so at 45° and 45°.
    #[test]
    fn forks_share_by_tips_and_by_angle_as_computed_by_hand() {
        let Pipes::ByAngle(pipes) =
            Pipes::new(&positions(), &PARENTS, &Wood { angle_share: 1.0, ..Wood::default() })
        else {
            panic!("shared by angle");
        };
        let half_right = f64::midpoint(1.0, libm::sqrt(0.5));
        let lateral = 3.0 * 2.0 * half_right / (2.0 * half_right + 1.0);
        let expected = [3.0, 3.0, lateral, 3.0 - lateral, lateral / 2.0, lateral / 2.0];
        for (pipe, expected) in pipes.iter().zip(expected) {
            assert!((pipe - expected).abs() < 1e-6, "{pipes:?}");
        }
    }

    /// A tip radius alone is the thinnest wood, and conservation holds with it.
    #[test]
    fn no_tip_is_left_without_a_pipe() {
        let wood = Wood { angle_share: 1.0, tip_radius_m: Some(0.01), ..Wood::default() };
        let radii = radii_by(&wood);
        assert!(radii.iter().all(|&radius| radius >= 0.01));
        assert!(radii[3] > radii[4], "what leads straight on is thicker");
        let square = |i: usize| radii[i] * radii[i];
        assert!((square(1) / (square(2) + square(3)) - 1.0).abs() < 1e-5);
    }
}
