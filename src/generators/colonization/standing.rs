//! A crown, a shape or a mesh, where it is to stand, and filled with points.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::crown::envelope::Envelope;
use crate::crown::shells::Shell;
use crate::crown::{self, Crown};
use crate::scatter;
use linden_base::input::{Geometry, Inputs, TriangleMesh, Up, recenter};
use linden_base::knob::Value;
use linden_base::memory::bytes_of;
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_growth::site::{Grove, Site, Stem, Suggested, crown_base_m};

use crate::ColonizationError;
use crate::obstacles::{Obstacle, Shade, clear};
use crate::part::Role;
use crate::settings::{Colonization, Space};

/// A shell that would hold fewer points bears no tree.
const LEAST_POINTS: f64 = 10.0;

/// How the note about several shells ends.
const SHELLS_NOTE: &str =
    "shells that stand apart: a tree grows in each; root=x,y,z makes one tree of them, rooted there";

/// Where a tree stands whose crown has its base's centre at `foot`, `base_m` above the ground of its file. A
/// crown that hangs over the ground stands on a trunk; one that sits on it, or is nowhere near it, grows from
/// its base.
fn below(foot: DVec3, base_m: f64, height_m: f64) -> DVec3 {
    let clearance_m = if (0.0..=height_m).contains(&base_m) { base_m } else { 0.0 };
    foot - DVec3::Y * clearance_m
}

/// A crown, and where it is to stand.
pub(crate) struct Standing {
    pub crown: Box<dyn Crown>,
    /// From the crown's coordinates to those of the [`Site`]: up, metres.
    pub lift: f64,
    /// As in [`Site`].
    pub root: DVec3,
    /// Where the tree stands that fills the whole crown, though a mesh has several shells.
    pub foot: DVec3,
    /// As in [`Site`].
    pub origin: DVec3,
    /// As in [`Site`].
    pub grove: Grove,
    /// What branches do not enter.
    pub obstacles: Vec<Obstacle>,
    pub shades: Vec<Shade>,
    pub notes: Vec<String>,
}

impl Standing {
    fn of(crown: Box<dyn Crown>, lift: f64, root: DVec3, origin: DVec3) -> Self {
        let (obstacles, shades) = (Vec::new(), Vec::new());
        Self {
            crown,
            lift,
            root,
            foot: root,
            origin,
            grove: Grove::default(),
            obstacles,
            shades,
            notes: Vec::new(),
        }
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

    /// The crown with all its parts.
    pub fn new(
        settings: &Colonization,
        seed: u64,
        inputs: &Inputs,
        monitor: &dyn Monitor,
    ) -> Result<Self, ColonizationError> {
        let alone = match &settings.space {
            Space::Shape { shape, dimensions } => Self::shape(settings, shape, dimensions)?,
            Space::Envelope { file } => {
                let input = inputs.get(file).map(|input| (&input.geometry, input.up));
                let Some((Geometry::Mesh(mesh), up)) = input else {
                    return Err(ColonizationError::WrongInput { file: file.clone(), expected: "a mesh" });
                };
                Self::envelope(settings, mesh, settings.growth.up(up), monitor)?
            }
        };
        alone.furnished(settings, seed, inputs, monitor)
    }

    /// A crown shape on top of the trunk.
    pub fn shape(
        settings: &Colonization,
        shape: &str,
        dimensions: &[(&'static str, Value)],
    ) -> Result<Self, ColonizationError> {
        let crown = crown::shape(shape)?.of(dimensions)?;
        let height = f64::from(crown.bounds().max.y);
        let lift = crown_base_m(settings.crown_base_m.or(settings.growth.trunk_m), height);
        let origin = settings.growth.given_root(Up::Y).unwrap_or(DVec3::ZERO);
        Ok(Self::of(crown, lift, DVec3::ZERO, origin))
    }

    /// A mesh, which stands where its file has it.
    fn envelope(
        settings: &Colonization,
        mesh: &TriangleMesh,
        up: Up,
        monitor: &dyn Monitor,
    ) -> Result<Self, ColonizationError> {
        let mut mesh = mesh.clone();
        up.to_y_up(&mut mesh.positions);
        let envelope = Envelope::new(&mesh, monitor)?;
        let foot = envelope.foot();
        let height = f64::from(envelope.bounds().max.y);
        let root = settings
            .growth
            .given_root(up)
            .map_or_else(|| below(DVec3::ZERO, foot.y, height), |root| root - foot);
        let notes = envelope.report().warnings();
        let shells = envelope.shells(monitor)?;
        let standing = Self { notes, ..Self::of(Box::new(envelope), 0.0, root, foot) };
        // One place that is given is one stem.
        Ok(if settings.growth.root.is_some() { standing } else { standing.with_shells(shells, settings) })
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
            Stem { root, trunk_m: settings.growth.trunk_m, crown: Some(Arc::new(shell)) }
        };
        let mut stems = shells.into_iter().map(stem);
        if let Some(first) = stems.next() {
            self.root = first.root;
            self.grove.first = first.crown;
        }
        self.grove.others = stems.collect();
        self
    }

    /// Fills it with points: for each tree of a mesh with several shells as many as for one.
    pub fn fill(
        self,
        settings: &Colonization,
        key: Key,
        monitor: &dyn Monitor,
    ) -> Result<Site, ColonizationError> {
        let shells = if settings.parts.iter().any(|part| part.role == Role::Tree) { 1 } else { self.trees() };
        let Self { crown, lift, root, foot: _, origin, mut grove, obstacles, shades, notes } = self;
        let count = (settings.points as usize).saturating_mul(shells);
        // Where none of them is taken away again, growth will ask for all; why draw them for nothing?
        if obstacles.is_empty() && shades.is_empty() {
            linden_growth::admit_points(count, bytes_of::<(DVec3, Vec3)>(count), monitor)?;
        }
        let mut points = scatter::scatter(&*crown, count, key.named("points"), monitor)?;
        if lift != 0.0 {
            recenter(&mut points, -DVec3::Y * lift);
        }
        let points = clear(points, &obstacles, &shades, key.named("shade"), monitor)?;
        let spacing_m = libm::cbrt(crown.volume_m3() / count as f64);
        let suggested = Suggested::for_volume(spacing_m);
        grove.obstacles = obstacles.into_iter().map(Obstacle::barrier).collect();
        Ok(Site { points, held_bytes: 0, root, grove, origin, suggested, moves_to_root: false, notes })
    }
}
