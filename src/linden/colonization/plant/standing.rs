//! A crown, a shape or a mesh, where it is to stand, and filled with points.

use glam::DVec3;

use super::parts::{Shade, clear};
use super::site::{Grove, Site, Suggested};
use crate::colonization::crown::envelope::Envelope;
use crate::colonization::crown::{self, Crown};
use crate::colonization::scatter;
use crate::grow::GrowError;
use crate::input::{TriangleMesh, Up, recenter};
use crate::knob::Value;
use crate::monitor::Monitor;
use crate::preset::{Colonization, Space};
use crate::random::Key;
use crate::recipe::{Geometry, Recipe};

/// Height of a crown's base, in crown heights, where neither base nor trunk is given.
const BASE_PER_CROWN_HEIGHT: f64 = 0.25;

/// Height of a crown's base above the root.
pub(super) fn crown_base(trunk_m: Option<f64>, crown_height_m: f64) -> f64 {
    trunk_m.unwrap_or(BASE_PER_CROWN_HEIGHT * crown_height_m)
}

/// A crown, and where it is to stand.
pub(super) struct Standing {
    pub crown: Box<dyn Crown>,
    /// From the crown's own coordinates to those of the [`Site`]: up, metres.
    pub lift: f64,
    /// As in [`Site`].
    pub root: DVec3,
    /// As in [`Site`].
    pub origin: DVec3,
    /// As in [`Site`].
    pub grove: Grove,
    pub shades: Vec<Shade>,
    pub notes: Vec<String>,
}

impl Standing {
    fn of(crown: Box<dyn Crown>, lift: f64, root: DVec3, origin: DVec3) -> Self {
        let (grove, shades) = (Grove::default(), Vec::new());
        Self { crown, lift, root, origin, grove, shades, notes: Vec::new() }
    }

    /// The crown of a recipe with all its parts; `None` for given points, which have none.
    pub fn new(
        settings: &Colonization,
        recipe: &Recipe,
        monitor: &dyn Monitor,
    ) -> Result<Option<Self>, GrowError> {
        let alone = match &settings.space {
            Space::Shape { shape, dimensions } => Self::shape(settings, shape, dimensions)?,
            Space::Envelope { file } => {
                let input = recipe.input(file).map(|input| (&input.geometry, input.up));
                let Some((Geometry::Mesh(mesh), up)) = input else {
                    return Err(GrowError::WrongInput { file: file.clone(), expected: "a mesh" });
                };
                Self::envelope(settings, mesh, settings.up(up), monitor)?
            }
            Space::Points { .. } => return Ok(None),
        };
        alone.furnished(settings, recipe, monitor).map(Some)
    }

    /// A crown shape on top of the trunk.
    fn shape(
        settings: &Colonization,
        shape: &str,
        dimensions: &[(&'static str, Value)],
    ) -> Result<Self, GrowError> {
        let crown = crown::shape(shape)?.of(dimensions)?;
        let height = f64::from(crown.bounds().max.y);
        let lift = crown_base(settings.crown_base_m.or(settings.trunk_m), height);
        let origin = settings.given_root(Up::Y).unwrap_or(DVec3::ZERO);
        Ok(Self::of(crown, lift, DVec3::ZERO, origin))
    }

    /// A mesh, which stands where its file has it.
    fn envelope(
        settings: &Colonization,
        mesh: &TriangleMesh,
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
        Ok(Self { notes, ..Self::of(Box::new(envelope), 0.0, root, foot) })
    }

    /// Fills it with points.
    pub fn fill(self, settings: &Colonization, key: Key, monitor: &dyn Monitor) -> Result<Site, GrowError> {
        let Self { crown, lift, root, origin, grove, shades, notes } = self;
        let mut points = scatter::scatter(&*crown, settings.points as usize, key.named("points"), monitor)?;
        if lift != 0.0 {
            recenter(&mut points, -DVec3::Y * lift);
        }
        let points = clear(points, &grove.obstacles, &shades, key.named("shade"), monitor)?;
        let spacing_m = libm::cbrt(crown.volume_m3() / f64::from(settings.points));
        let suggested = Suggested::for_volume(spacing_m);
        Ok(Site { points, bark: None, root, grove, origin, suggested, moves_to_root: false, notes })
    }
}
