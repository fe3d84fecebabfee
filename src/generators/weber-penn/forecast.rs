//! How many stems, nodes and leaves a tree will have, before it grows: in closed form.

use crate::grow::MAX_LEAVES;
use crate::level::Level;
use crate::{WeberPenn, WeberPennError};

/// What is expected of one level of stems.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelForecast {
    /// Without clones.
    pub stems: f64,
    /// Limbs that split from them.
    pub clones: f64,
    /// Stems of the next level.
    pub children: f64,
    /// Nodes.
    pub nodes: f64,
    /// Leaves.
    pub leaves: f64,
}

/// What is expected of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// The trunk first.
    pub levels: Vec<LevelForecast>,
}

/// Parts of a parent over which means are taken.
const PARTS: u32 = 32;

/// The numbers that settings lead to, the envelope aside, which leaves fewer. The spread of lengths and of the
/// number of clones cancels out; numbers of children are rounded down stem by stem.
pub fn forecast(settings: &WeberPenn) -> Forecast {
    let settings = &*settings.at_age();
    let levels: Vec<Level> = (0..=settings.levels as usize).map(|level| settings.level(level)).collect();
    let last = settings.levels as usize - 1;
    let mut stems = libm::round(levels[0].branches.abs()).max(1.0);
    let mut forecast = Vec::new();
    for (number, level) in levels[..=last].iter().enumerate() {
        let splits = if number == 0 { libm::round(settings.base_splits.abs()) } else { 0.0 };
        let [limbs, segments] = limbs(level, splits);
        let children = if number == last {
            0.0
        } else {
            children(settings, number, stems, levels[number + 1].branches.abs())
        };
        let leaves = if number == last && number > 0 {
            let mean = mean(|along| settings.shape_ratio(settings.leaf_dist, along));
            stems * settings.leaves.abs() * settings.leaf_quality * mean * segments
                / f64::from(level.segments)
        } else {
            0.0
        };
        let nodes = stems * (segments * pieces(settings, level) + limbs) + children;
        forecast.push(LevelForecast { stems, clones: stems * (limbs - 1.0), children, nodes, leaves });
        stems = children;
    }
    Forecast { levels: forecast }
}

/// Limbs that a stem ends in, and segments of all of them.
fn limbs(level: &Level, base_splits: f64) -> [f64; 2] {
    let (mut limbs, mut segments) = (1.0, 0.0);
    for segment in 0..level.segments {
        segments += limbs;
        if segment + 1 < level.segments {
            limbs *=
                if segment == 0 && base_splits > 0.0 { 1.0 + base_splits } else { 1.0 + level.seg_splits };
        }
    }
    [limbs, segments]
}

/// Pieces that segments are drawn in, about.
fn pieces(settings: &WeberPenn, level: &Level) -> f64 {
    if level.helix().is_some() {
        return 6.0;
    }
    if !settings.smooth || level.segments == 1 {
        return 1.0;
    }
    // Bends by the curve and, by the root of their squares' mean, by what is drawn; none before the first joint.
    let curve =
        if level.curve_back == 0.0 { level.curve.abs() } else { level.curve.abs() + level.curve_back.abs() };
    let joints = f64::from(level.segments - 1) / f64::from(level.segments);
    let bend = libm::hypot(curve, 0.4 * level.curve_spread) / f64::from(level.segments) * joints
        + level.split_angle.abs() * level.seg_splits;
    (0.5 + bend.to_degrees() / 12.0).clamp(1.0, 6.0)
}

/// Stems on all parents of a level.
fn children(settings: &WeberPenn, parent: usize, parents: f64, most: f64) -> f64 {
    match parent {
        0 if settings.base_size >= settings.level(0).length => 0.0,
        0 => parents * libm::floor(most),
        1 => {
            // Parents stand evenly along the crown.
            let count = libm::floor(settings.level(1).branches.abs()).max(1.0);
            let parts = count.min(4096.0);
            let of = |i: u32| {
                let ratio = 1.0 - (f64::from(i) + 0.5) / parts;
                libm::floor(most * (0.2 + 0.8 * settings.shape_ratio(settings.shape, ratio)) + 1e-9)
            };
            parents * (0..parts as u32).map(of).sum::<f64>() / parts
        }
        _ => parents * mean(|along| libm::floor(most * (1.0 - 0.5 * along))),
    }
}

/// The mean over a parent's length.
fn mean(of: impl Fn(f64) -> f64) -> f64 {
    (0..PARTS).map(|i| of((f64::from(i) + 0.5) / f64::from(PARTS))).sum::<f64>() / f64::from(PARTS)
}

impl Forecast {
    /// Nodes of all levels.
    pub fn nodes(&self) -> f64 {
        self.levels.iter().map(|level| level.nodes).sum()
    }

    /// Leaves.
    pub fn leaves(&self) -> f64 {
        self.levels.iter().map(|level| level.leaves).sum()
    }

    /// Whether the tree is not too large.
    ///
    /// # Errors
    /// [`WeberPennError::TooManyNodes`], [`WeberPennError::TooManyLeaves`].
    pub(crate) fn check(&self, settings: &WeberPenn) -> Result<(), WeberPennError> {
        let thinned = settings.thinned;
        let share = 1.0 / thinned.every as f64;
        let of = |part: fn(&LevelForecast) -> f64| {
            let each = self.levels.iter().enumerate();
            each.map(|(i, level)| part(level) * if i >= thinned.level { share } else { 1.0 }).sum::<f64>()
        };
        let (nodes, leaves) = (of(|level| level.nodes), of(|level| level.leaves));
        if !(nodes <= 1.5 * f64::from(settings.max_nodes)) {
            return Err(WeberPennError::TooManyNodes { expected: nodes, limit: settings.max_nodes });
        }
        if !(leaves <= 1.5 * MAX_LEAVES as f64) {
            return Err(WeberPennError::TooManyLeaves { expected: leaves, limit: MAX_LEAVES });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limbs_multiply_as_counted_by_hand() {
        let settings = WeberPenn { curve_res: vec![4.0], seg_splits: vec![1.0], ..WeberPenn::default() };
        // 1, 2, 4, 8 segments side by side.
        assert_eq!(limbs(&settings.level(0), 0.0), [8.0, 15.0]);
        // 1, 3, 6, 12.
        assert_eq!(limbs(&settings.level(0), 2.0), [12.0, 22.0]);
    }
}
