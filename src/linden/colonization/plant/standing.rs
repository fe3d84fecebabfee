//! A crown, a shape or a mesh, where it is to stand, and filled with points.

use glam::DVec3;

use super::site::{Site, Suggested};
use crate::colonization::crown::envelope::Envelope;
use crate::colonization::crown::{self, Crown};
use crate::colonization::scatter;
use crate::grow::GrowError;
use crate::input::{Up, recenter};
use crate::monitor::Monitor;
use crate::preset::Colonization;
use crate::random::Key;

/// Height of a crown's base, in crown heights, where neither base nor trunk is given.
const BASE_PER_CROWN_HEIGHT: f64 = 0.25;

/// A crown, and where it is to stand.
pub(super) struct Standing {
    pub crown: Box<dyn Crown>,
    /// From the crown's own coordinates to those of the [`Site`]: up, metres.
    pub lift: f64,
    /// As in [`Site`].
    pub root: DVec3,
    /// As in [`Site`].
    pub origin: DVec3,
    pub notes: Vec<String>,
}

impl Standing {
    /// A crown shape on top of the trunk.
    pub fn shape(
        settings: &Colonization,
        shape: &str,
        dimensions: &[(&'static str, crate::knob::Value)],
    ) -> Result<Self, GrowError> {
        let crown = crown::shape(shape)?.of(dimensions)?;
        let height = f64::from(crown.bounds().max.y);
        let lift = settings.crown_base_m.or(settings.trunk_m).unwrap_or(BASE_PER_CROWN_HEIGHT * height);
        let origin = settings.given_root(Up::Y).unwrap_or(DVec3::ZERO);
        Ok(Self { crown, lift, root: DVec3::ZERO, origin, notes: Vec::new() })
    }

    /// A mesh, which stands where its file has it.
    pub fn envelope(
        settings: &Colonization,
        mesh: &crate::input::TriangleMesh,
        up: Up,
        monitor: &dyn Monitor,
    ) -> Result<Self, GrowError> {
        let mut mesh = mesh.clone();
        up.to_y_up(&mut mesh.positions);
        let envelope = Envelope::new(&mesh, monitor)?;
        let foot = envelope.foot();
        let height = f64::from(envelope.bounds().max.y);
        // A crown that hangs over the ground of its file stands on a trunk; one that sits on it, or is
        // nowhere near it, grows from its own base.
        let clearance = if (0.0..=height).contains(&foot.y) { foot.y } else { 0.0 };
        let root = settings.given_root(up).map_or(DVec3::NEG_Y * clearance, |root| root - foot);
        let notes = envelope.report().warnings();
        Ok(Self { crown: Box::new(envelope), lift: 0.0, root, origin: foot, notes })
    }

    /// Fills it with points.
    pub fn fill(self, settings: &Colonization, key: Key, monitor: &dyn Monitor) -> Result<Site, GrowError> {
        let Self { crown, lift, root, origin, notes } = self;
        let mut points = scatter::scatter(&*crown, settings.points as usize, key.named("points"), monitor)?;
        if lift != 0.0 {
            recenter(&mut points, -DVec3::Y * lift);
        }
        let spacing_m = libm::cbrt(crown.volume_m3() / f64::from(settings.points));
        let suggested = Suggested::for_volume(spacing_m);
        Ok(Site { points, bark: None, roots: vec![root], origin, suggested, moves_to_root: false, notes })
    }
}
