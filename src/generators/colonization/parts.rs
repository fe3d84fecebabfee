//! The parts of a crown, from what a preset says to solids that stand.

use std::sync::Arc;

use glam::DVec3;

use crate::crown::clumps::Clumps;
use crate::crown::compound::{Compound, CompoundError, Operation, Piece};
use crate::crown::envelope::{Envelope, EnvelopeError};
use crate::crown::favor::{Favor, Favored};
use crate::crown::placed::PlacedCrown;
use crate::crown::uneven::Uneven;
use crate::crown::{self, Crown, CrownError};
use linden_base::input::{Geometry, Inputs};
use linden_base::mesh::Bounds;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;
use linden_growth::site::{Stem, crown_base_m};

use crate::ColonizationError;
use crate::obstacles::{Obstacle, Shade, inside};
use crate::part::{CrownPart, Role, Solid};
use crate::settings::Colonization;
use crate::standing::Standing;

/// Distance of clumps by default, in the longest sides of the crown.
const CLUMP_PER_SIZE: f64 = 0.2;

/// Why a part of a crown cannot be had.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// Its shape.
    #[error(transparent)]
    Crown(#[from] CrownError),
    /// Its mesh.
    #[error(transparent)]
    Envelope(EnvelopeError),
    /// It takes the crown away.
    #[error("next to nothing is left of the crown; move it or make it smaller")]
    Nothing,
    /// Nobody wants it any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

linden_base::from_cancellable!(PartError: EnvelopeError => Envelope);

/// A tree as it is put together.
struct Tree {
    /// Each with the number of its part; 0 for the crown that the preset itself names.
    pieces: Vec<(usize, Piece)>,
    root: DVec3,
    trunk_m: Option<f64>,
}

impl Tree {
    /// Its crown, of one piece or several.
    fn crown(
        &mut self,
        parts: &[CrownPart],
        monitor: &dyn Monitor,
    ) -> Result<Box<dyn Crown>, ColonizationError> {
        let (numbers, mut pieces): (Vec<usize>, Vec<Piece>) = self.pieces.drain(..).unzip();
        if pieces.len() == 1
            && let Some(only) = pieces.pop()
        {
            return Ok(only.crown);
        }
        match Compound::new(pieces, monitor) {
            Ok(compound) => Ok(Box::new(compound)),
            Err(CompoundError::Cancelled(cancelled)) => Err(cancelled.into()),
            Err(CompoundError::Nothing { piece }) => {
                Err(about(numbers.get(piece).copied().unwrap_or(0), parts, PartError::Nothing))
            }
            // The first piece always adds.
            Err(CompoundError::NoPiece) => Err(about(0, parts, PartError::Nothing)),
        }
    }
}

/// An error with the part that it is about.
fn about(number: usize, parts: &[CrownPart], problem: PartError) -> ColonizationError {
    let what = number.checked_sub(1).and_then(|i| parts.get(i)).map(CrownPart::describe).unwrap_or_default();
    match problem {
        PartError::Cancelled(cancelled) => cancelled.into(),
        problem => ColonizationError::Part { number, what, problem },
    }
}

/// What becomes of a crown that is whole: its outline is dented, and points gather where the settings want them.
struct Finish<'a> {
    settings: &'a Colonization,
    seed: u64,
    monitor: &'a dyn Monitor,
}

impl Finish<'_> {
    /// The crown of a tree, which has dents of its own by its number.
    fn crown(&self, crown: Box<dyn Crown>, tree: u64) -> Result<Box<dyn Crown>, Cancelled> {
        self.favored(self.dented(crown, tree)?)
    }

    fn dented(&self, crown: Box<dyn Crown>, tree: u64) -> Result<Box<dyn Crown>, Cancelled> {
        let unevenness = self.settings.unevenness;
        if unevenness == 0.0 {
            return Ok(crown);
        }
        let key = Key::new(self.seed).named("unevenness").child(tree);
        Ok(Box::new(Uneven::new(crown, unevenness, key, self.monitor)?))
    }

    fn favored(&self, crown: Box<dyn Crown>) -> Result<Box<dyn Crown>, Cancelled> {
        let favor = Favor { shell: self.settings.shell_density, top: self.settings.top_density };
        let clumps = self.clumps(&*crown);
        if favor == Favor::default() && clumps.is_none() {
            return Ok(crown);
        }
        Ok(Box::new(Favored::new(crown, favor, clumps, self.monitor)?))
    }

    fn clumps(&self, crown: &dyn Crown) -> Option<Clumps> {
        let share = self.settings.clumps;
        let auto = || CLUMP_PER_SIZE * f64::from(crown.bounds().size().max_element());
        let size_m = self.settings.clump_size_m.unwrap_or_else(auto);
        (share > 0.0).then(|| Clumps { share, size_m, key: Key::new(self.seed).named("clumps") })
    }
}

impl Standing {
    /// Adds the parts of the preset and lets points gather where it wants them. Without either, the
    /// crown is what it was.
    pub fn furnished(
        mut self,
        settings: &Colonization,
        seed: u64,
        inputs: &Inputs,
        monitor: &dyn Monitor,
    ) -> Result<Self, ColonizationError> {
        let finish = Finish { settings, seed, monitor };
        let parts = &settings.parts;
        if parts.is_empty() {
            self.crown = finish.crown(self.crown, 0)?;
            return Ok(self);
        }
        if parts.iter().any(|part| matches!(part.role, Role::Add | Role::Subtract)) && self.trees() > 1 {
            self.as_one_crown();
        }
        let trees_of_shells = self.trees() - 1;
        let Self { crown, lift, root: foot, origin, mut grove, mut obstacles, mut shades, mut notes, .. } =
            self;
        let first = Piece {
            operation: Operation::Add,
            crown: Box::new(PlacedCrown::new(crown, DVec3::Y * lift, 0.0, 1.0)),
        };
        let mut trees = vec![Tree { pieces: vec![(0, first)], root: foot, trunk_m: settings.growth.trunk_m }];
        let mut meshes = Vec::new();
        let mut standing_about: Vec<(usize, Bounds)> = Vec::new();
        for (i, part) in parts.iter().enumerate() {
            monitor.check()?;
            let (solid, warnings) =
                solid(part, &mut meshes, settings, inputs, monitor).map_err(|error| match error {
                    SolidError::Part(problem) => about(i + 1, parts, problem),
                    SolidError::Other(error) => error,
                })?;
            notes.extend(warnings.into_iter().map(|note| format!("part {}: {note}", i + 1)));
            let (at, root) = place(part, &solid, foot, origin);
            let crown: Box<dyn Crown> =
                Box::new(PlacedCrown::new(solid.crown, at, part.turn_deg, part.scale));
            let operation = if part.role == Role::Subtract { Operation::Subtract } else { Operation::Add };
            match part.role {
                Role::Add | Role::Subtract => {
                    if let Some(tree) = trees.last_mut() {
                        tree.pieces.push((i + 1, Piece { operation, crown }));
                    }
                }
                Role::Tree => trees.push(Tree {
                    pieces: vec![(i + 1, Piece { operation, crown })],
                    root,
                    trunk_m: part.trunk_m,
                }),
                Role::Obstacle => {
                    standing_about.push((i + 1, crown.bounds()));
                    obstacles.push(Obstacle { solid: Arc::from(crown), meet: part.meet });
                }
                Role::Shade => shades.push(Shade { solid: crown, share: part.share }),
            }
        }
        let mut crowns: Vec<Arc<dyn Crown>> = Vec::with_capacity(trees.len());
        for (number, tree) in (0..).zip(&mut trees) {
            crowns.push(Arc::from(finish.crown(tree.crown(parts, monitor)?, number)?));
        }
        if crowns.len() > 1 {
            if trees_of_shells == 0 {
                grove.first = crowns.first().cloned().map(inside);
            }
            let other = |(tree, crown): (&Tree, &Arc<dyn Crown>)| Stem {
                root: tree.root,
                trunk_m: tree.trunk_m,
                crown: Some(inside(Arc::clone(crown))),
            };
            grove.others.extend(trees.iter().zip(&crowns).skip(1).map(other));
        }
        let crown = together(crowns, monitor)?;
        let feet = trees.iter().map(|tree| tree.root.as_vec3());
        let reach = feet.fold(crown.bounds(), |reach, foot| Bounds {
            min: reach.min.min(foot),
            max: reach.max.max(foot),
        });
        notes.extend(
            standing_about.into_iter().filter_map(|(number, solid)| out_of_reach(number, &solid, &reach)),
        );
        Ok(Self { crown, lift: 0.0, grove, obstacles, shades, notes, ..self })
    }
}

/// What is said of an obstacle that no branch can meet.
fn out_of_reach(number: usize, solid: &Bounds, reach: &Bounds) -> Option<String> {
    /// Branches may leave the crown so far, metres.
    const BEYOND_M: f32 = 1.0;
    let gap_m = (solid.min - reach.max).max(reach.min - solid.max).max_element();
    (gap_m > BEYOND_M).then(|| {
        format!(
            "part {number}: this obstacle is {gap_m:.1} m away from the crown, and nothing meets it; if its mesh is in other units \
             than metres, give 'scale'"
        )
    })
}

/// The crowns of all trees as one: where several reach, points are no denser.
fn together(
    mut crowns: Vec<Arc<dyn Crown>>,
    monitor: &dyn Monitor,
) -> Result<Box<dyn Crown>, ColonizationError> {
    if crowns.len() == 1
        && let Some(only) = crowns.pop()
    {
        return Ok(Box::new(only));
    }
    let add = |crown| Piece { operation: Operation::Add, crown: Box::new(crown) };
    match Compound::new(crowns.into_iter().map(add).collect(), monitor) {
        Ok(forest) => Ok(Box::new(forest)),
        Err(CompoundError::Cancelled(cancelled)) => Err(cancelled.into()),
        // Nothing is subtracted.
        Err(CompoundError::Nothing { .. } | CompoundError::NoPiece) => Err(about(0, &[], PartError::Nothing)),
    }
}

/// A part's solid, the centre of its base at the origin.
struct Raw {
    crown: Box<dyn Crown>,
    /// Where its file has it; `None` for a shape.
    foot: Option<DVec3>,
}

enum SolidError {
    Part(PartError),
    Other(ColonizationError),
}

impl<E: Into<PartError>> From<E> for SolidError {
    fn from(error: E) -> Self {
        Self::Part(error.into())
    }
}

/// The solid, and what the user should know of it. A mesh that several parts are is made ready once:
/// `meshes` keeps those that are.
fn solid(
    part: &CrownPart,
    meshes: &mut Vec<(String, Arc<Envelope>)>,
    settings: &Colonization,
    inputs: &Inputs,
    monitor: &dyn Monitor,
) -> Result<(Raw, Vec<String>), SolidError> {
    match &part.solid {
        Solid::Shape { shape, dimensions } => {
            let crown = crown::shape(shape)?.of(dimensions)?;
            Ok((Raw { crown, foot: None }, Vec::new()))
        }
        Solid::Mesh { file } => {
            if let Some((_, known)) = meshes.iter().find(|(name, _)| name == file) {
                let crown = Box::new(Arc::clone(known));
                return Ok((Raw { crown, foot: Some(known.foot()) }, Vec::new()));
            }
            let input = inputs.get(file).map(|input| (&input.geometry, input.up));
            let Some((Geometry::Mesh(mesh), up)) = input else {
                let error = ColonizationError::WrongInput { file: file.clone(), expected: "a mesh" };
                return Err(SolidError::Other(error));
            };
            let mut mesh = (**mesh).clone();
            settings.growth.up(up).to_y_up(&mut mesh.positions);
            let envelope = Arc::new(Envelope::new(&mesh, monitor)?);
            meshes.push((file.clone(), Arc::clone(&envelope)));
            let (foot, mut notes) = (Some(envelope.foot()), envelope.report().warnings());
            let shells = if part.role == Role::Tree { envelope.shells(monitor)?.len() } else { 0 };
            if shells > 1 {
                notes.push(format!(
                    "its mesh has {shells} shells that stand apart, and is the crown of one tree; give each a file and a part of its own"
                ));
            }
            Ok((Raw { crown: Box::new(envelope), foot }, notes))
        }
    }
}

/// Where a part's base centre stands and, for a tree, its root; `foot` is the first tree's root.
fn place(part: &CrownPart, solid: &Raw, foot: DVec3, origin: DVec3) -> (DVec3, DVec3) {
    let from_foot = |at: [f64; 3]| foot + DVec3::from_array(at);
    let given = part.at.map(from_foot).or_else(|| solid.foot.map(|given| given - origin));
    let on_ground = |at: DVec3| DVec3::new(at.x, at.y.min(foot.y), at.z);
    let root = part.root.map_or_else(|| on_ground(given.unwrap_or(foot)), from_foot);
    let on_trunk = || {
        let height = f64::from(solid.crown.bounds().max.y) * part.scale;
        root + DVec3::Y * crown_base_m(part.trunk_m, height)
    };
    let at = given.unwrap_or_else(|| if part.role == Role::Tree { on_trunk() } else { foot });
    (at, root)
}
