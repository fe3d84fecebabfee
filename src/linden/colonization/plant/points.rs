//! Points that somebody measured.

use glam::DVec3;

use super::site::{Grove, Site, Suggested};
use crate::colonization::growth::GrowthError;
use crate::colonization::{scan, scatter};
use crate::grow::GrowError;
use crate::input::{Up, recenter};
use crate::monitor::Monitor;
use crate::preset::{Colonization, Length};
use crate::random::Key;

/// Points that somebody measured, moved near the origin.
pub(super) fn at_points(
    settings: &Colonization,
    points: &[DVec3],
    up: Up,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Site, GrowError> {
    let mut points = points.to_vec();
    up.to_y_up(&mut points);
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let origin = if points.is_empty() { DVec3::ZERO } else { ((low + high) * 0.5).round() };
    recenter(&mut points, origin);
    let given_root = settings.given_root(up).map(|root| root - origin);
    if settings.contract {
        let scan = scan::prepare(&points, settings.step_m, monitor)?;
        return Ok(Site {
            points: scan.points,
            root: given_root.unwrap_or(scan.root),
            grove: Grove::default(),
            origin,
            suggested: Suggested {
                step: scan.step_m,
                kill: Length::Metres(scan.kill_m),
                influence: Length::Metres(scan.influence_m),
            },
            moves_to_root: true,
            notes: scan_notes(&scan.report),
        });
    }
    let spacing_m = scan::point_spacing_m(&points).unwrap_or(1.0);
    let root = match given_root {
        Some(root) => root,
        None => scan::foot(&points).ok_or(GrowthError::NoPoints)?,
    };
    // Lattices and mirrored models make pulls cancel.
    scatter::jitter(&mut points, spacing_m * 1e-3, key.named("jitter"));
    Ok(Site {
        points,
        root,
        grove: Grove::default(),
        origin,
        suggested: Suggested::for_volume(spacing_m),
        moves_to_root: true,
        notes: Vec::new(),
    })
}

fn scan_notes(report: &scan::ScanReport) -> Vec<String> {
    let mut notes = Vec::new();
    if report.ground_points > 0 {
        notes.push(format!("{} points were taken for ground and left out", report.ground_points));
    }
    if report.bridges > 0 {
        notes.push(format!(
            "the scan has {} gaps, the longest {:.2} m; branches were led across them",
            report.bridges, report.longest_bridge_m
        ));
    }
    notes
}
