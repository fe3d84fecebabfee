//! What growth starts from: a root, or a bare trunk, of each tree.

use glam::DVec3;

use crate::error::StandError;
use crate::site::{Inside, Site, Stem};
use crate::trunk;
use crate::{GrowthRule, GrowthSettings};
use linden_base::monitor::Monitor;
use linden_skeleton::{Branching, NO_PARENT};

/// The stems of all trees of a site, the first tree's first.
pub(super) fn start(
    site: &Site,
    settings: &GrowthSettings,
    rule: &GrowthRule,
    monitor: &dyn Monitor,
) -> Result<Branching, StandError> {
    let mut room = Room { step_m: f64::from(rule.step), max_nodes: rule.max_nodes, segments: 0.0 };
    let reach_m = f64::from(rule.influence);
    let mut grow = |root: DVec3, trunk_m: Option<f64>, crown: Option<&dyn Inside>| match trunk_m {
        Some(height_m) => {
            room.take(height_m)?;
            Ok(trunk::straight(root, height_m, room.step_m))
        }
        None => {
            let held: Vec<DVec3>;
            let points = match crown {
                Some(crown) => {
                    held = site.points.iter().copied().filter(|p| crown.holds(*p)).collect();
                    &held
                }
                None => &site.points,
            };
            // The way cannot be shorter than to the nearest point.
            let nearest_m = points.iter().map(|p| p.distance(root)).fold(f64::INFINITY, f64::min);
            if nearest_m.is_finite() {
                room.take(nearest_m - reach_m)?;
            }
            let most_nodes = rule.max_nodes as usize;
            Ok::<_, StandError>(trunk::until_in_reach(
                root,
                points,
                reach_m,
                room.step_m,
                most_nodes,
                monitor,
            )?)
        }
    };
    let mut all = grow(site.root, settings.trunk_m.or(site.suggested.trunk_m), site.grove.first.as_deref())?;
    for Stem { root, trunk_m, crown } in &site.grove.others {
        let Branching { positions, parents, births, .. } = grow(*root, *trunk_m, crown.as_deref())?;
        let before = all.positions.len() as u32;
        all.positions.extend(positions);
        all.parents.extend(parents.iter().map(|&p| if p == NO_PARENT { NO_PARENT } else { p + before }));
        all.births.extend(births);
    }
    Ok(all)
}

/// How many nodes trunks may have, before they are built.
struct Room {
    step_m: f64,
    max_nodes: u32,
    /// Of all trunks so far.
    segments: f64,
}

impl Room {
    fn take(&mut self, length_m: f64) -> Result<(), StandError> {
        self.segments += (length_m / self.step_m).max(0.0);
        if self.segments >= f64::from(self.max_nodes) {
            let segments = self.segments.ceil();
            return Err(StandError::TrunkTooLong { segments, max_nodes: self.max_nodes });
        }
        Ok(())
    }
}
