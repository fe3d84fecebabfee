//! Flat systems, drawn by macros.
//!
//! A deterministic system that only draws, branches and turns within the plane by one angle is *flat*.
//! Its turtle is made exact: the heading is a whole number of equal [parts of a circle](Circle), and
//! the step along each heading is rounded once to a grid of 2^-k m, so coarse that every sum of steps
//! up to the tree's reach fits into the 53 bits of an `f64`. Sums are then free of rounding and may be
//! taken in any order: a subtree that was [interpreted once](macros) and is placed by an addition has
//! the bits of one that was walked.
//!
//! Whether a system is flat depends on grammar and settings alone, never on the way it is drawn.

mod circle;
mod macros;
mod walk;

use super::command::{Command, Sense};
use super::error::LsystemError;
use super::forecast::Forecast;
use super::program::{Program, Word};
use super::turtle_settings::{Stems, TurtleSettings};
use circle::Circle;
use linden_base::monitor::Monitor;
use linden_skeleton::Branching;

pub(super) use walk::Walker;

/// The longest way from the foot to a tip, in segments. The ends of a segment then differ in single
/// precision: along one axis they are L/√2 apart at least, and singles as far out as 2^22 L lie L/2
/// apart at most.
const LONGEST_REACH: u64 = 1 << 22;
/// Modules of rules times derivations that are counted before anything is drawn: some tens of
/// microseconds, and little memory.
const MOST_COUNTED: usize = 1 << 15;

/// What a module tells the turtle in the plane.
#[derive(Clone, Copy, Debug)]
enum Action {
    Nothing,
    Draw,
    /// To the left by this number of parts of the circle.
    Turn(u32),
    Push,
    Pop,
}

/// How much a module becomes. Saturating.
#[derive(Clone, Copy, Debug)]
struct Size {
    symbols: u64,
    /// Segments from where it begins to where it ends, branches left out.
    through: u64,
    /// Segments from where it begins to its farthest tip.
    reach: u64,
}

/// A flat system, ready to be drawn.
pub(super) struct Flat<'a> {
    program: &'a Program,
    derivations: u32,
    /// By module.
    actions: Vec<Action>,
    /// By module: what it is rewritten to.
    successors: Vec<Option<Word>>,
    /// The sizes of all modules that are rewritten, by derivations that are left.
    sizes: Vec<Size>,
    circle: Circle,
    segments: usize,
    symbols: u64,
    /// The most branches open at once.
    depth: usize,
}

impl<'a> Flat<'a> {
    /// `None` for a system that is not flat.
    pub(super) fn of(program: &'a Program, settings: &TurtleSettings, forecast: &Forecast) -> Option<Self> {
        let chance = program.random || !settings.variation.is_none();
        let bends = settings.susceptibility != 0.0 || settings.habit != Stems::One;
        if !forecast.exact || program.has_contexts() || program.cuts || chance || bends {
            return None;
        }
        let (parts, turn) = circle::divide(settings.angle_deg)?;
        let mut actions = Vec::with_capacity(program.modules.len());
        let mut successors = Vec::with_capacity(program.modules.len());
        for (id, (entry, (command, _))) in (0..).zip(program.modules.iter().zip(program.commands())) {
            if entry.arity != 0 {
                return None;
            }
            actions.push(match command {
                Command::Silent => Action::Nothing,
                Command::Draw | Command::DrawUnrecorded => Action::Draw,
                Command::Yaw(Sense::Left) => Action::Turn(turn),
                Command::Yaw(_) => Action::Turn((parts - turn) % parts),
                Command::TurnAround => Action::Turn(parts / 2),
                Command::Push => Action::Push,
                Command::Pop => Action::Pop,
                _ => return None,
            });
            successors.push(match program.rewrite(id) {
                None => None,
                Some(_) => Some(program.certain(id)?),
            });
        }
        let (segments, symbols) =
            (usize::try_from(forecast.segments).ok()?, u64::try_from(forecast.symbols).ok()?);
        let mut flat = Self {
            program,
            derivations: settings.derivations,
            actions,
            successors,
            sizes: Vec::new(),
            circle: Circle::new(parts),
            segments,
            symbols,
            depth: usize::try_from(forecast.depth).ok()?,
        };
        let reach = flat.count()?;
        flat.circle.set_step(settings.segment_m, reach);
        Some(flat)
    }

    /// Fills in the sizes; gives the reach of the whole.
    fn count(&mut self) -> Option<u64> {
        let rewritten = self.program.first_kept as usize;
        let words = self.successors.iter().flatten().map(|word| word.len() + 1).sum::<usize>();
        if words.saturating_mul(self.derivations as usize) > MOST_COUNTED {
            return None;
        }
        for id in 0..rewritten {
            let size = self.size_of_kept(id as u32);
            self.sizes.push(size);
        }
        for left in 1..=self.derivations {
            for id in 0..rewritten {
                let word = self.successors[id]?;
                let size = self.size_of_word(word, left - 1);
                self.sizes.push(size);
            }
        }
        let Size { reach, .. } = self.size_of_word(self.program.axiom, self.derivations);
        (1..=LONGEST_REACH).contains(&reach).then_some(reach)
    }

    fn size_of_kept(&self, id: u32) -> Size {
        let drawn = u64::from(matches!(self.actions[id as usize], Action::Draw));
        Size { symbols: 1, through: drawn, reach: drawn }
    }

    /// The size of a module with `left` derivations to come.
    fn size(&self, id: u32, left: u32) -> Size {
        if id < self.program.first_kept {
            self.sizes[left as usize * self.program.first_kept as usize + id as usize]
        } else {
            self.size_of_kept(id)
        }
    }

    fn size_of_word(&self, word: Word, left: u32) -> Size {
        let mut whole = Size { symbols: 0, through: 0, reach: 0 };
        let mut branches = Vec::new();
        for &id in self.program.word(word) {
            match self.actions[id as usize] {
                Action::Push => branches.push(whole.through),
                Action::Pop => whole.through = branches.pop().unwrap_or(whole.through),
                _ => {}
            }
            let size = self.size(id, left);
            whole.symbols = whole.symbols.saturating_add(size.symbols);
            whole.reach = whole.reach.max(whole.through.saturating_add(size.reach));
            whole.through = whole.through.saturating_add(size.through);
        }
        whole
    }

    /// Draws by macros.
    ///
    /// # Errors
    /// Cancellation, or too little memory.
    pub(super) fn draw(self, monitor: &dyn Monitor) -> Result<Branching, LsystemError> {
        macros::draw(self, monitor)
    }
}
