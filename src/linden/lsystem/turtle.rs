//! The turtle of ABOP, appendix C, drawing a branching structure.

use glam::DVec3;

use super::command::{Command, Sense};
use super::derive::Sink;
use super::error::LsystemError;
use super::grow::{MAX_NESTING, Settings};
use super::program::Program;
use crate::memory::{OverMemory, bytes_grown};
use crate::monitor::Monitor;
use crate::skeleton::{Branching, NO_PARENT};

/// Rotations between two re-orthonormalisations. Each rotation adds an error of about 1e-16 to the
/// frame; the error of so few stays below 1e-14.
const MAX_TURNS: u32 = 64;

/// A [`Command`] with its numbers, ready to be obeyed.
#[derive(Clone, Copy, Debug)]
enum Action {
    Nothing,
    Draw { length_m: f64 },
    Move { length_m: f64 },
    Push,
    Pop,
    Yaw(Turn),
    Pitch(Turn),
    Roll(Turn),
    Level,
}

/// Sine and cosine of an angle.
#[derive(Clone, Copy, Debug)]
struct Turn {
    sin: f64,
    cos: f64,
}

impl Turn {
    const HALF: Self = Self { sin: 0.0, cos: -1.0 };

    /// Exact for quarter turns, so that square shapes close.
    fn by_degrees(degrees: f64) -> Self {
        let reduced = degrees % 360.0;
        let (sin, cos) = match reduced {
            0.0 => (0.0, 1.0),
            90.0 | -270.0 => (1.0, 0.0),
            180.0 | -180.0 => return Self::HALF,
            270.0 | -90.0 => (-1.0, 0.0),
            _ => libm::sincos(reduced.to_radians()),
        };
        Self { sin, cos }
    }

    /// Turns two axes of a frame in their plane, the first towards the second.
    fn apply(self, first: &mut DVec3, second: &mut DVec3) {
        let (a, b) = (*first, *second);
        *first = a * self.cos + b * self.sin;
        *second = b * self.cos - a * self.sin;
    }
}

/// Where the next segment starts.
#[derive(Clone, Copy, Debug)]
enum Anchor {
    /// At a node.
    Node(u32),
    /// At a place without a node so far: an index into [`Turtle::feet`].
    Foot(u32),
}

/// What a bracket remembers.
#[derive(Clone, Copy, Debug)]
struct State {
    position: DVec3,
    /// H, L and U: right-handed, H × L = U.
    heading: DVec3,
    left: DVec3,
    up: DVec3,
    /// Rotations since the frame was orthonormal.
    turns: u32,
    anchor: Anchor,
}

impl State {
    /// At the origin, looking up, its left at −X.
    fn start() -> Self {
        Self {
            position: DVec3::ZERO,
            heading: DVec3::Y,
            left: DVec3::NEG_X,
            up: DVec3::Z,
            turns: 0,
            anchor: Anchor::Foot(0),
        }
    }

    fn count_turn(&mut self) {
        self.turns += 1;
        if self.turns == MAX_TURNS {
            self.turns = 0;
            self.heading = self.heading.normalize();
            self.left = (self.left - self.heading * self.left.dot(self.heading)).normalize();
            self.up = self.heading.cross(self.left);
        }
    }

    /// `$`: L = V × H / |V × H|, U = H × L with V straight up (ABOP, section 2.2.1). With H vertical
    /// every L is horizontal, and the turtle stays as it is.
    fn level(&mut self) {
        const VERTICAL: f64 = 1e-9;
        let left = DVec3::Y.cross(self.heading);
        let length = left.length();
        if length > VERTICAL {
            self.left = left / length;
            self.up = self.heading.cross(self.left);
        }
    }
}

/// For messages about memory.
const DOING: &str = "drawing the L-system";
const ADVICE: &str = "use fewer derivations";

/// Walks, and leaves nodes behind.
pub(super) struct Turtle<'a> {
    /// By module identifier.
    actions: Vec<Action>,
    state: State,
    stack: Vec<State>,
    branching: Branching,
    /// For each place where a stem may start: its node, once something has been drawn from there.
    /// Branches that start at one place share its node.
    feet: Vec<Option<u32>>,
    /// How many of `feet` a state on the stack may know; later ones are the turtle's own.
    shared_feet: usize,
    derivations: u32,
    monitor: &'a dyn Monitor,
}

impl<'a> Turtle<'a> {
    /// `segments` is how many segments there will be, 0 when nobody knows.
    ///
    /// # Errors
    /// [`OverMemory`] where so many would take too much.
    pub(super) fn new(
        program: &Program,
        settings: &Settings,
        segments: usize,
        depth: usize,
        monitor: &'a dyn Monitor,
    ) -> Result<Self, OverMemory> {
        let bytes = Branching::bytes_for(segments + 1) + bytes_grown::<State>(depth.min(MAX_NESTING));
        monitor.admit(DOING, bytes, ADVICE)?;
        let branching = Branching {
            positions: Vec::with_capacity(segments + 1),
            parents: Vec::with_capacity(segments + 1),
            births: Vec::with_capacity(segments + 1),
            radii: None,
        };
        Ok(Self {
            actions: program.commands().map(|(command, number)| action(command, number, settings)).collect(),
            state: State::start(),
            stack: Vec::new(),
            branching,
            feet: vec![None],
            shared_feet: 0,
            derivations: settings.derivations,
            monitor,
        })
    }

    pub(super) fn into_branching(self) -> Branching {
        self.branching
    }

    fn node(&mut self, position: DVec3, parent: u32, birth: u32) -> Result<u32, OverMemory> {
        if self.branching.positions.len() == self.branching.positions.capacity() {
            self.branching.make_room(DOING, ADVICE, self.monitor)?;
        }
        self.branching.positions.push(position.as_vec3());
        self.branching.parents.push(parent);
        self.branching.births.push(birth);
        Ok(self.branching.positions.len() as u32 - 1)
    }

    fn draw(&mut self, length_m: f64, birth: u32) -> Result<(), OverMemory> {
        let start = match self.state.anchor {
            Anchor::Node(node) => node,
            Anchor::Foot(foot) => self.stand(foot as usize, birth)?,
        };
        self.state.position += self.state.heading * length_m;
        self.state.anchor = Anchor::Node(self.node(self.state.position, start, birth)?);
        Ok(())
    }

    /// The node of the foot that the turtle stands at.
    fn stand(&mut self, foot: usize, birth: u32) -> Result<u32, OverMemory> {
        if let Some(node) = self.feet[foot] {
            return Ok(node);
        }
        let node = self.node(self.state.position, NO_PARENT, birth)?;
        self.feet[foot] = Some(node);
        Ok(node)
    }

    fn move_on(&mut self, length_m: f64) -> Result<(), OverMemory> {
        if length_m == 0.0 {
            return Ok(());
        }
        self.state.position += self.state.heading * length_m;
        // A foot that nobody else knows, and that nothing stands on, moves along.
        if let Anchor::Foot(foot) = self.state.anchor
            && foot as usize >= self.shared_feet
            && self.feet[foot as usize].is_none()
        {
            return Ok(());
        }
        if self.feet.len() == self.feet.capacity() {
            let feet = bytes_grown::<Option<u32>>(self.feet.len() + 1);
            self.monitor.admit(DOING, self.branching.bytes() + feet, ADVICE)?;
        }
        self.state.anchor = Anchor::Foot(self.feet.len() as u32);
        self.feet.push(None);
        Ok(())
    }

    fn push(&mut self) -> Result<(), LsystemError> {
        if self.stack.len() == MAX_NESTING {
            let derivations = self.derivations;
            return Err(LsystemError::NestedTooDeeply { derivations, limit: MAX_NESTING });
        }
        self.stack.push(self.state);
        self.shared_feet = self.feet.len();
        Ok(())
    }
}

impl Sink for Turtle<'_> {
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        for &id in modules {
            match self.actions[id as usize] {
                Action::Nothing => {}
                Action::Draw { length_m } => self.draw(length_m, birth)?,
                Action::Move { length_m } => self.move_on(length_m)?,
                Action::Push => self.push()?,
                // Grammars are balanced: there always is a state.
                Action::Pop => self.state = self.stack.pop().unwrap_or(self.state),
                Action::Yaw(turn) => {
                    turn.apply(&mut self.state.heading, &mut self.state.left);
                    self.state.count_turn();
                }
                Action::Pitch(turn) => {
                    turn.apply(&mut self.state.up, &mut self.state.heading);
                    self.state.count_turn();
                }
                Action::Roll(turn) => {
                    turn.apply(&mut self.state.up, &mut self.state.left);
                    self.state.count_turn();
                }
                Action::Level => self.state.level(),
            }
        }
        Ok(())
    }
}

fn action(command: Command, number: Option<f64>, settings: &Settings) -> Action {
    let length_m = settings.segment_m * number.unwrap_or(1.0);
    let degrees = number.unwrap_or(settings.angle_deg);
    let turn = |positive| Turn::by_degrees(if positive { degrees } else { -degrees });
    match command {
        Command::Draw => Action::Draw { length_m },
        Command::Move => Action::Move { length_m },
        Command::Push => Action::Push,
        Command::Pop => Action::Pop,
        Command::Yaw(sense) => Action::Yaw(turn(sense == Sense::Left)),
        Command::Pitch(sense) => Action::Pitch(turn(sense == Sense::Down)),
        Command::Roll(sense) => Action::Roll(turn(sense == Sense::Left)),
        Command::TurnAround => Action::Yaw(Turn::HALF),
        Command::Level => Action::Level,
        // A branching structure has no widths and no colours; `%` has done its work by now.
        Command::Width | Command::Colour | Command::Cut | Command::Silent => Action::Nothing,
    }
}
