//! How much light reaches a place in a crown: which leaves are leaves of the sun, and which of the shade.
//!
//! Twigs stand for the leaves that they may bear, so that the light on a leaf depends on no other leaf: not on the
//! season, nor on those that are left out. Five ways out of the crown are looked along, straight up and slanting to
//! four sides; light is lost along each by the metres of twig in it (Beer's law, as in Monsi & Saeki 1953), in units
//! of what lies over the middle twig of the crown.

use glam::Vec3;

use super::axis::Young;
use linden_skeleton::{NO_PARENT, Skeleton, WidthSteps};

/// Cells along the crown's longest side.
const ACROSS: f32 = 32.0;
/// The ways out: cells to the side for one up, and the share of the sky's light that comes along each.
const WAYS: [([isize; 2], f32); 5] =
    [([0, 0], 0.4), ([1, 0], 0.15), ([-1, 0], 0.15), ([0, 1], 0.15), ([0, -1], 0.15)];

/// The light in a crown, by cells of equal size.
pub(super) struct Sunlight {
    low: Vec3,
    cell_m: f32,
    cells: [usize; 3],
    /// 0 to 1, along X, then Z, then Y from the ground up.
    light: Vec<f32>,
}

impl Sunlight {
    /// Where the twigs of a skeleton leave it. However finely its axes are divided, it is the same.
    pub fn of(skeleton: &Skeleton, young: Young) -> Self {
        let (low, high) = skeleton
            .positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &node| (low.min(node), high.max(node)));
        if !low.is_finite() || !high.is_finite() {
            return Self { low: Vec3::ZERO, cell_m: 1.0, cells: [1; 3], light: vec![1.0] };
        }
        let size = high - low;
        let cell_m = (size.max_element() / ACROSS).max(1e-6);
        let cells = size.to_array().map(|side| (side / cell_m) as usize + 1);
        let mut crown = Self { low, cell_m, cells, light: vec![1.0; cells.iter().product()] };
        let mut twig_m = vec![0.0_f64; crown.light.len()];
        for axis in &skeleton.axes {
            let nodes = skeleton.nodes_of(axis);
            let Some(&first) = nodes.first() else { continue };
            let at = |node: u32| (skeleton.positions[node as usize], skeleton.radii[node as usize]);
            // As the surface has it: a lateral is as thick at its root as at its first node.
            let root = if axis.parent == NO_PARENT { first } else { axis.parent };
            let mut last = (at(root).0, at(first).1);
            for &node in nodes {
                let next = at(node);
                let start = if skeleton.width_steps == WidthSteps::Cylinder { next.1 } else { last.1 };
                if let Some([from, to]) = thinner([(last.0, start), next], young.max_radius_m) {
                    crown.lay(from, to, &mut twig_m);
                }
                last = next;
            }
        }
        crown.shine(&twig_m.iter().map(|&length_m| length_m as f32).collect::<Vec<_>>());
        crown
    }

    /// Adds a twig's length to the cells that it runs through.
    fn lay(&self, from: Vec3, to: Vec3, twig_m: &mut [f64]) {
        let length_m = f64::from(from.distance(to));
        let [a, b] = [from, to].map(|end| ((end - self.low) / self.cell_m).as_dvec3().to_array());
        // Shares of the way at which it passes from one cell into another.
        let mut passes = vec![0.0, 1.0];
        for (a, b) in a.into_iter().zip(b) {
            let (low, high) = (a.min(b), a.max(b));
            let mut wall = libm::floor(low) + 1.0;
            while wall < high {
                passes.push((wall - a) / (b - a));
                wall += 1.0;
            }
        }
        passes.sort_by(f64::total_cmp);
        for pair in passes.windows(2) {
            let middle = from.lerp(to, f64::midpoint(pair[0], pair[1]) as f32);
            twig_m[self.cell(middle)] += length_m * (pair[1] - pair[0]);
        }
    }

    /// The light that reaches a place: 1 on the outside, 0 in the dark.
    pub fn at(&self, place: Vec3) -> f32 {
        self.light[self.cell(place)]
    }

    fn cell(&self, place: Vec3) -> usize {
        let at = ((place - self.low) / self.cell_m).to_array();
        // What is outside counts as the nearest cell: leaves reach beyond their twigs.
        let [x, y, z] = [0, 1, 2].map(|axis| (at[axis].max(0.0) as usize).min(self.cells[axis] - 1));
        (y * self.cells[2] + z) * self.cells[0] + x
    }

    fn shine(&mut self, twig_m: &[f32]) {
        let [across, up, deep] = self.cells;
        let layer = across * deep;
        // Metres of twig over each cell, half of its own included, along each way.
        let over: Vec<Vec<f32>> = WAYS
            .iter()
            .map(|([dx, dz], _)| {
                let mut over = vec![0.0_f32; twig_m.len()];
                for y in (0..up).rev() {
                    for (z, x) in (0..deep).flat_map(|z| (0..across).map(move |x| (z, x))) {
                        let at = y * layer + z * across + x;
                        let (nx, nz) = (x.checked_add_signed(*dx), z.checked_add_signed(*dz));
                        let above = match (nx, nz) {
                            (Some(nx), Some(nz)) if y + 1 < up && nx < across && nz < deep => {
                                let next = (y + 1) * layer + nz * across + nx;
                                over[next] + 0.5 * twig_m[next]
                            }
                            _ => 0.0,
                        };
                        over[at] = above + 0.5 * twig_m[at];
                    }
                }
                over
            })
            .collect();
        let (mut sum, mut all) = (0.0, 0.0);
        for (at, &length) in twig_m.iter().enumerate() {
            let mean: f32 = over.iter().zip(WAYS).map(|(over, (_, share))| share * over[at]).sum();
            sum += f64::from(mean) * f64::from(length);
            all += f64::from(length);
        }
        let usual = (sum / all) as f32;
        if !(usual > 0.0) {
            return;
        }
        for (at, light) in self.light.iter_mut().enumerate() {
            let along = over.iter().zip(WAYS).map(|(over, (_, share))| share * libm::expf(-over[at] / usual));
            *light = along.sum();
        }
    }
}

/// The part of a tapering segment that is no thicker than a radius.
fn thinner([a, b]: [(Vec3, f32); 2], radius_m: f32) -> Option<[Vec3; 2]> {
    let share = if a.1 == b.1 { 0.0 } else { ((a.1 - radius_m) / (a.1 - b.1)).clamp(0.0, 1.0) };
    match (a.1 <= radius_m, b.1 <= radius_m) {
        (true, true) => Some([a.0, b.0]),
        (false, true) => Some([a.0.lerp(b.0, share), b.0]),
        (true, false) => Some([a.0, a.0.lerp(b.0, share)]),
        (false, false) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_skeleton::Axis;

    /// A forest of upright twigs, `side` × `side`, a metre apart, each in `steps` metres.
    fn thicket(side: u32, steps: u32) -> Skeleton {
        let mut skeleton = Skeleton::default();
        for stem in 0..side * side {
            for step in 0..=steps {
                let parent = if step == 0 { NO_PARENT } else { skeleton.positions.len() as u32 - 1 };
                let place = Vec3::new((stem % side) as f32, step as f32, (stem / side) as f32);
                skeleton.positions.push(place);
                skeleton.parents.push(parent);
                skeleton.radii.push(0.01);
                skeleton.births.push(0);
                skeleton.axis_nodes.push(skeleton.positions.len() as u32 - 1);
            }
            let first = stem * (steps + 1);
            skeleton.axes.push(Axis { order: 0, parent: NO_PARENT, first, len: steps + 1 });
        }
        skeleton
    }

    #[test]
    fn light_is_lost_downward_and_inward() {
        let young = Young { max_radius_m: 1.0, first_birth: 0 };
        let light = Sunlight::of(&thicket(9, 9), young);
        let middle = |y: f32| light.at(Vec3::new(4.0, y, 4.0));
        let heights = [0.5, 3.5, 6.5, 8.5].map(middle);
        assert!(heights.windows(2).all(|pair| pair[0] < pair[1]), "{heights:?}");
        assert!((0.0..=1.0).contains(&heights[0]) && heights[3] > 0.6, "{heights:?}");
        // At the rim slanting light comes in.
        assert!(light.at(Vec3::new(0.0, 2.0, 4.0)) > middle(2.0));
        // Far outside is the nearest cell.
        assert_eq!(light.at(Vec3::new(4.0, 99.0, 4.0)), middle(9.0));
        // All sides are alike, to a cell.
        let sides = [[0.0, 4.0], [8.0, 4.0], [4.0, 0.0], [4.0, 8.0]];
        let sides = sides.map(|[x, z]| light.at(Vec3::new(x, 2.0, z)));
        assert!(sides.iter().all(|side| (side - sides[0]).abs() < 0.02), "{sides:?}");
    }

    #[test]
    fn without_twigs_all_is_light() {
        let thick = Young { max_radius_m: 0.001, first_birth: 0 };
        assert_eq!(Sunlight::of(&thicket(2, 3), thick).at(Vec3::ONE), 1.0);
        assert_eq!(Sunlight::of(&Skeleton::default(), thick).at(Vec3::ZERO), 1.0);
    }
}
