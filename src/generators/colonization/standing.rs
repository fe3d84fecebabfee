//! A crown, a shape or a mesh, where it is to stand, and filled with points.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::crown::entry::Entry;
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

/// Where a tree stands, and its trunk.
#[derive(Clone, Copy)]
pub(crate) struct Stance {
    root: DVec3,
    /// Height of the bare trunk, where that is known before it grows.
    trunk_m: Option<f64>,
}

impl Stance {
    /// For a crown that is entered from below, and whose box begins `base_m` above the ground of its file. A crown
    /// that hangs over the ground stands on a trunk; one that sits on it, or is nowhere near it, grows from its base.
    fn below(entry: Entry, base_m: f64, height_m: f64) -> Self {
        let clearance_m = if (0.0..=height_m).contains(&base_m) { base_m } else { 0.0 };
        let trunk_m = (entry.bare_m > 0.0).then_some(clearance_m + entry.bare_m);
        Self { root: entry.below - DVec3::Y * clearance_m, trunk_m }
    }
}

/// What to say of a mesh whose underside is so far above the ground of its file, y = 0, that no trunk leads to it, or
/// below it.
fn off_ground(base_m: f64, height_m: f64) -> Option<String> {
    // What a modeller calls 0, and a root that grips the ground.
    let sunk_m = (base_m < -0.01 * height_m).then_some(-base_m);
    let (from, way) = match sunk_m {
        Some(sunk_m) => (sunk_m, "below"),
        None if base_m > height_m => (base_m, "above"),
        None => return None,
    };
    Some(format!(
        "the envelope's lowest point is {from:.2} m {way} the ground of its file, and the tree stands at that height: origin=root moves it onto the ground, root=x,y,z names another place"
    ))
}

/// A crown, and where it is to stand.
pub(crate) struct Standing {
    pub crown: Box<dyn Crown>,
    /// From the crown's coordinates to those of the [`Site`]: up, metres.
    pub lift: f64,
    /// As in [`Site`].
    pub root: DVec3,
    /// As in [`Suggested`].
    pub trunk_m: Option<f64>,
    /// How the tree stands that fills the whole crown, though a mesh has several shells.
    pub whole: Stance,
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
            trunk_m: None,
            whole: Stance { root, trunk_m: None },
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
        Stance { root: self.root, trunk_m: self.trunk_m } = self.whole;
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
        let mut notes = envelope.report().warnings();
        if let Some(root) = settings.growth.given_root(up) {
            // One place that is given is one stem.
            return Ok(Self { notes, ..Self::of(Box::new(envelope), 0.0, root - foot, foot) });
        }
        if !settings.growth.moves_to_root(false) {
            notes.extend(off_ground(foot.y, height));
        }
        let whole = Stance::below(envelope.entry(monitor)?, foot.y, height);
        let Stance { root, trunk_m } = whole;
        let shells = envelope.shells(monitor)?;
        let standing = Self { trunk_m, whole, notes, ..Self::of(Box::new(envelope), 0.0, root, foot) };
        standing.with_shells(shells, settings, monitor)
    }

    /// A tree in each shell of a mesh, if there are several.
    fn with_shells(
        mut self,
        mut shells: Vec<Shell>,
        settings: &Colonization,
        monitor: &dyn Monitor,
    ) -> Result<Self, ColonizationError> {
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
            return Ok(self);
        }
        let count = shells.len();
        self.notes.push(format!("the envelope has {count} {SHELLS_NOTE}"));
        let base_m = self.origin.y;
        let mut stems = Vec::with_capacity(count);
        for shell in shells {
            let entry = shell.entry(monitor)?;
            let Stance { root, trunk_m } = Stance::below(entry, base_m + entry.below.y, shell.height_m());
            let trunk_m = settings.growth.trunk_m.or(trunk_m);
            stems.push(Stem { root, trunk_m, crown: Some(Arc::new(shell)) });
        }
        let mut stems = stems.into_iter();
        if let Some(first) = stems.next() {
            (self.root, self.trunk_m) = (first.root, first.trunk_m);
            self.grove.first = first.crown;
        }
        self.grove.others = stems.collect();
        Ok(self)
    }

    /// Fills it with points: for each tree of a mesh with several shells as many as for one.
    pub fn fill(
        self,
        settings: &Colonization,
        key: Key,
        monitor: &dyn Monitor,
    ) -> Result<Site, ColonizationError> {
        let shells = if settings.parts.iter().any(|part| part.role == Role::Tree) { 1 } else { self.trees() };
        let Self { crown, lift, root, trunk_m, whole: _, origin, mut grove, obstacles, shades, notes } = self;
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
        let suggested = Suggested { trunk_m, ..Suggested::for_volume(spacing_m) };
        grove.obstacles = obstacles.into_iter().map(Obstacle::barrier).collect();
        Ok(Site { points, held_bytes: 0, root, grove, origin, suggested, moves_to_root: false, notes })
    }
}

#[cfg(test)]
mod tests {
    use linden_base::input::Input;
    use linden_base::monitor::Quiet;
    use linden_growth::stand::{Stand, grow_at};

    use super::*;

    /// Boxes from corner to corner, as one mesh.
    fn boxes(corners: &[[[f64; 3]; 2]]) -> TriangleMesh {
        let mut mesh = TriangleMesh { positions: Vec::new(), triangles: Vec::new() };
        for &[low, high] in corners {
            let first = mesh.positions.len() as u32;
            let at = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| [low, high][i >> axis & 1][axis]));
            mesh.positions.extend((0..8).map(at));
            for [a, b, c, d] in
                [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
            {
                mesh.triangles.extend([[a, b, c], [a, c, d]].map(|corners| corners.map(|i: u32| first + i)));
            }
        }
        mesh
    }

    /// A body on four legs, from `base_m` up.
    fn cow(base_m: f64) -> TriangleMesh {
        let leg = |x: f64, z: f64| [[x - 0.15, base_m, z - 0.15], [x + 0.15, base_m + 1.5, z + 0.15]];
        let body = [[-1.5, base_m + 1.2, -0.5], [1.5, base_m + 2.2, 0.5]];
        boxes(&[body, leg(-1.2, -0.3), leg(-1.2, 0.3), leg(1.2, -0.3), leg(1.2, 0.3)])
    }

    fn grown(mesh: TriangleMesh, turn: impl FnOnce(&mut Colonization)) -> Stand {
        let mut inputs = Inputs::new();
        inputs.insert("cow.obj", Input { hash: 0, geometry: Geometry::Mesh(Arc::new(mesh)), up: Up::Y });
        let mut settings = Colonization::of(Space::Envelope { file: "cow.obj".to_owned() });
        settings.points = 1500;
        turn(&mut settings);
        let standing = Standing::new(&settings, 1, &inputs, &Quiet).unwrap();
        let site = standing.fill(&settings, Key::new(1), &Quiet).unwrap();
        grow_at(site, &settings.growth, &Quiet).unwrap()
    }

    /// How far the first stem rises straight up from its root.
    fn bare_m(stand: &Stand) -> f32 {
        let places = &stand.branching.positions;
        let root = places[0];
        let straight = places.iter().take_while(|p| (**p - root).with_y(0.0).length() < 1e-4);
        straight.fold(0.0, |highest, p| (p.y - root.y).max(highest))
    }

    #[test]
    fn under_a_body_on_legs_stands_a_trunk() {
        for (base_m, ground_m) in [(0.0, 0.0), (1.0, 0.0), (-1.0, -1.0), (9.0, 9.0)] {
            let stand = grown(cow(base_m), |_| ());
            let root = stand.branching.positions[0];
            assert!(root.distance(Vec3::Y * ground_m) < 1e-5, "{base_m}: {root}");
            let body_m = base_m as f32 + 1.2 - ground_m;
            assert!((body_m..body_m + 0.3).contains(&bare_m(&stand)), "{base_m}: {}", bare_m(&stand));
            let is_told = stand.notes.iter().any(|note| note.contains("the ground of its file"));
            assert_eq!(is_told, !(0.0..=2.2).contains(&base_m), "{base_m}: {:?}", stand.notes);
        }
        let moved = grown(cow(9.0), |settings| settings.growth.origin = linden_growth::Origin::Root);
        assert_eq!(moved.branching.positions[0], Vec3::ZERO);
        assert!(!moved.notes.iter().any(|note| note.contains("origin=root moves")), "{:?}", moved.notes);
        // What is given holds.
        let stand = grown(cow(0.0), |settings| settings.growth.trunk_m = Some(0.5));
        assert!(bare_m(&stand) < 1.2, "{}", bare_m(&stand));
    }

    #[test]
    fn a_tree_without_a_body_over_the_middle_stands_in_it() {
        // Four beams about a court.
        let ring = |x: f64| {
            [
                [[x - 3.0, 0.0, -3.0], [x + 3.0, 1.0, -2.0]],
                [[x - 3.0, 0.0, 2.0], [x + 3.0, 1.0, 3.0]],
                [[x - 3.0, 0.0, -3.0], [x - 2.0, 1.0, 3.0]],
                [[x + 2.0, 0.0, -3.0], [x + 3.0, 1.0, 3.0]],
            ]
        };
        let is_in = |root: Vec3, x: f32| {
            let away = (root.x - x).abs().max(root.z.abs());
            root.y == 0.0 && (2.0..3.0).contains(&away)
        };
        let alone = grown(boxes(&ring(0.0)), |_| ());
        assert!(is_in(alone.branching.positions[0], 0.0), "{}", alone.branching.positions[0]);
        // In a grove each.
        let two = grown(boxes(&[ring(0.0), ring(20.0)].concat()), |_| ());
        let roots: Vec<Vec3> = std::iter::zip(&two.branching.positions, &two.branching.parents)
            .filter(|(_, parent)| **parent == linden_skeleton::NO_PARENT)
            .map(|(place, _)| *place)
            .collect();
        assert!(roots.len() == 2 && is_in(roots[0], 0.0) && is_in(roots[1], 20.0), "{roots:?}");
    }
}
