//! A crown, a shape or a mesh, where it is to stand, and filled with points.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::parts::{Shade, clear};
use super::site::{Grove, Site, Stem, Suggested};
use crate::colonization::crown::envelope::Envelope;
use crate::colonization::crown::shells::Shell;
use crate::colonization::crown::{self, Crown};
use crate::colonization::{growth, scatter};
use crate::grow::GrowError;
use crate::input::{TriangleMesh, Up, recenter};
use crate::knob::Value;
use crate::memory::bytes_of;
use crate::monitor::Monitor;
use crate::preset::{Colonization, Role, Space};
use crate::random::Key;
use crate::recipe::{Geometry, Recipe};

/// Height of a crown's base, in crown heights, where neither base nor trunk is given.
const BASE_PER_CROWN_HEIGHT: f64 = 0.25;

/// Height of a crown's base above the root.
pub(super) fn crown_base(trunk_m: Option<f64>, crown_height_m: f64) -> f64 {
    trunk_m.unwrap_or(BASE_PER_CROWN_HEIGHT * crown_height_m)
}

/// A shell that would hold fewer points bears no tree.
const LEAST_POINTS: f64 = 10.0;

/// How the note about several shells ends.
const SHELLS_NOTE: &str =
    "shells that stand apart: a tree grows in each; root=x,y,z makes one tree of them, rooted there";

/// Where a tree stands whose crown has its base's centre at `foot`, `base_m` above the ground of its file. A crown
/// that hangs over the ground stands on a trunk; one that sits on it, or is nowhere near it, grows from its own base.
fn below(foot: DVec3, base_m: f64, height_m: f64) -> DVec3 {
    let clearance_m = if (0.0..=height_m).contains(&base_m) { base_m } else { 0.0 };
    foot - DVec3::Y * clearance_m
}

/// A crown, and where it is to stand.
pub(super) struct Standing {
    pub crown: Box<dyn Crown>,
    /// From the crown's own coordinates to those of the [`Site`]: up, metres.
    pub lift: f64,
    /// As in [`Site`].
    pub root: DVec3,
    /// Where the tree stands that fills the whole crown, though a mesh has several shells.
    pub foot: DVec3,
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
        Self { crown, lift, root, foot: root, origin, grove, shades, notes: Vec::new() }
    }

    /// How many trees stand here that no part adds.
    pub fn trees(&self) -> usize {
        1 + self.grove.others.len()
    }

    /// Takes the shells of a mesh for one crown after all.
    pub fn as_one_crown(&mut self) {
        let shells = self.trees();
        self.notes.retain(|note| !note.ends_with(SHELLS_NOTE));
        self.notes.push(format!(
            "the envelope has {shells} shells that stand apart; its parts add to or take from all of them, so they are the crown of one tree"
        ));
        self.grove = Grove::default();
        self.root = self.foot;
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
        let root =
            settings.given_root(up).map_or_else(|| below(DVec3::ZERO, foot.y, height), |root| root - foot);
        let notes = envelope.report().warnings();
        let shells = envelope.shells(monitor)?;
        let standing = Self { notes, ..Self::of(Box::new(envelope), 0.0, root, foot) };
        // One place that is given is one stem.
        Ok(if settings.root.is_some() { standing } else { standing.with_shells(shells, settings) })
    }

    /// A tree in each shell of a mesh, if there are several.
    fn with_shells(mut self, mut shells: Vec<Shell>, settings: &Colonization) -> Self {
        let found = shells.len();
        let volume_m3: f64 = shells.iter().map(Shell::volume_m3).sum();
        let points = f64::from(settings.points) * found as f64;
        shells.retain(|shell| points * shell.volume_m3() >= LEAST_POINTS * volume_m3);
        let small = found - shells.len();
        if small > 0 {
            let (s, bear) = if small == 1 { ("", "bears") } else { ("s", "bear") };
            self.notes.push(format!(
                "{small} of the envelope's {found} shells would hold less than {LEAST_POINTS} points and {bear} no tree{s}; raise points"
            ));
        }
        if shells.len() < 2 {
            return self;
        }
        let count = shells.len();
        self.notes.push(format!("the envelope has {count} {SHELLS_NOTE}"));
        let base_m = self.origin.y;
        let stem = |shell: Shell| {
            let foot = shell.foot();
            let root = below(foot, base_m + foot.y, shell.height_m());
            Stem { root, trunk_m: settings.trunk_m, crown: Some(Arc::new(shell)) }
        };
        let mut stems = shells.into_iter().map(stem);
        if let Some(first) = stems.next() {
            self.root = first.root;
            self.grove.own = first.crown;
        }
        self.grove.others = stems.collect();
        self
    }

    /// Fills it with points: for each tree of a mesh with several shells as many as for one.
    pub fn fill(self, settings: &Colonization, key: Key, monitor: &dyn Monitor) -> Result<Site, GrowError> {
        let shells = if settings.parts.iter().any(|part| part.role == Role::Tree) { 1 } else { self.trees() };
        let Self { crown, lift, root, foot: _, origin, grove, shades, notes } = self;
        let count = (settings.points as usize).saturating_mul(shells);
        // Where none of them is taken away again, growth will ask for all; why draw them for nothing?
        if grove.obstacles.is_empty() && shades.is_empty() {
            growth::admit_points(count, bytes_of::<(DVec3, Vec3)>(count), monitor)?;
        }
        let mut points = scatter::scatter(&*crown, count, key.named("points"), monitor)?;
        if lift != 0.0 {
            recenter(&mut points, -DVec3::Y * lift);
        }
        let points = clear(points, &grove.obstacles, &shades, key.named("shade"), monitor)?;
        let spacing_m = libm::cbrt(crown.volume_m3() / count as f64);
        let suggested = Suggested::for_volume(spacing_m);
        Ok(Site { points, bark: None, root, grove, origin, suggested, moves_to_root: false, notes })
    }
}
