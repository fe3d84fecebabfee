//! The pipe model: `r^n = Σ r_child^n` (Shinozaki et al. 1964; RLP07 section 4.3).

use glam::Vec3;

use super::NO_PARENT;
use crate::scene::Bounds;

/// How thick the wood is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wood {
    /// `n` of the pipe model. Measured trees 1.8–2.3; the programs before this one 2.05 and 2.5.
    pub radius_exponent: f64,
    /// Metres at the tips; `None`: follows from the base.
    pub tip_radius_m: Option<f64>,
    /// Metres at the thickest stem's foot; `None`: follows from the tips or, when they follow too,
    /// from the height.
    pub base_radius_m: Option<f64>,
}

/// Base radius ÷ height where neither end is given: a slenderness (height ÷ diameter) of 30, as of
/// trees that stand in the open (30–50; dense stands reach 80–100).
const BASE_PER_HEIGHT: f64 = 1.0 / 60.0;

impl Default for Wood {
    /// Leonardo's rule: the cross-section is the same above and below a fork.
    fn default() -> Self {
        Self { radius_exponent: 2.0, tip_radius_m: None, base_radius_m: None }
    }
}

/// How many tips (nodes without children) each node carries, itself included when it is one.
pub(crate) fn count_tips(parents: &[u32]) -> Vec<u32> {
    let mut tips = vec![0_u32; parents.len()];
    for node in (0..parents.len()).rev() {
        tips[node] = tips[node].max(1);
        if parents[node] != NO_PARENT {
            tips[parents[node] as usize] += tips[node];
        }
    }
    tips
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
    pub fn new(positions: &[Vec3], tips: &[u32], wood: &Wood) -> Self {
        let most = f64::from(tips.iter().copied().max().unwrap_or(1));
        let exponent = wood.radius_exponent;
        let from_base = |base: f64| base / libm::pow(most, 1.0 / exponent);
        let (unit, thinnest) = match (wood.tip_radius_m, wood.base_radius_m) {
            (Some(tip), None) => (tip, tip),
            (tip, Some(base)) => (from_base(base), tip.unwrap_or(0.0).min(base)),
            (None, None) => {
                let height =
                    Bounds::of(positions.iter().copied()).map_or(0.0, |b| f64::from(b.size().max_element()));
                (from_base(height * BASE_PER_HEIGHT), 0.0)
            }
        };
        Self { unit, thinnest, exponent }
    }

    /// Radii from the tip counts: with equal tips the pipe model is `r = r_tip · tips^(1/n)` exactly.
    pub fn radii(&self, tips: &[u32]) -> Vec<f32> {
        let of = |count: u32| {
            (self.unit * libm::pow(f64::from(count), 1.0 / self.exponent)).max(self.thinnest) as f32
        };
        // Most nodes carry few tips: pow is slow, a small table is not.
        let table: Vec<f32> = (0..4096).map(of).collect();
        tips.iter().map(|&count| table.get(count as usize).copied().unwrap_or_else(|| of(count))).collect()
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

    #[test]
    fn every_fork_obeys_the_pipe_model() {
        let tips = count_tips(&PARENTS);
        for exponent in [1.8, 2.0, 2.5, 3.0] {
            let wood = Wood { radius_exponent: exponent, tip_radius_m: Some(0.01), base_radius_m: None };
            let radii = Thickness::new(&positions(), &tips, &wood).radii(&tips);
            for node in 0..PARENTS.len() {
                let children: Vec<usize> =
                    (0..PARENTS.len()).filter(|&c| PARENTS[c] == node as u32).collect();
                let expected = if children.is_empty() {
                    libm::pow(0.01, exponent)
                } else {
                    children.iter().map(|&c| libm::pow(f64::from(radii[c]), exponent)).sum()
                };
                let own = libm::pow(f64::from(radii[node]), exponent);
                assert!((own / expected - 1.0).abs() < 1e-5, "node {node}: {own} against {expected}");
            }
        }
    }

    #[test]
    fn a_given_base_is_kept_and_a_given_tip_is_the_least() {
        let tips = count_tips(&PARENTS);
        let both = Wood { radius_exponent: 2.0, tip_radius_m: Some(0.4), base_radius_m: Some(0.5) };
        let radii = Thickness::new(&positions(), &tips, &both).radii(&tips);
        assert_eq!(radii[0], 0.5);
        assert!(radii.iter().all(|&r| r >= 0.4));
        let neither = Thickness::new(&positions(), &tips, &Wood::default()).radii(&tips);
        assert!((neither[0] - 3.0 / 60.0).abs() < 1e-6, "the height is 3 m");
    }
}
