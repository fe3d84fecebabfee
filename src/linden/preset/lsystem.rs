//! `[lsystem]`: a grammar and how it is drawn.

use super::knobs::{PresetKnob, integer, real, row};
use super::{Generator, Habit, Preset};
use crate::knob::Kind;
use crate::lsystem::{
    self, Forecast, Grammar, LsystemError, MAX_DERIVATIONS, MAX_STEMS, MAX_SYMBOLS, Settings, Variation,
};

/// An L-system and how it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct LSystem {
    /// Axiom and rules.
    pub grammar: Grammar,
    /// Turn of `+` and the like, degrees.
    pub angle_deg: f64,
    /// Rewriting steps.
    pub derivations: u32,
    /// Length of an `F`, metres.
    pub segment_length_m: f64,
    /// Derivations that give more symbols are refused.
    pub symbol_limit: u64,
    /// Diameter of a `!(1)`, metres.
    pub segment_width_m: f64,
    /// What `!` multiplies the width by.
    pub width_ratio: f64,
    /// Where branches bend to.
    pub tropism: [f64; 3],
    /// How much they bend.
    pub susceptibility: f64,
    /// Each turn is by up to so much more or less, degrees.
    pub angle_jitter_deg: f64,
    /// Each branch is rolled by up to so much to either side, degrees.
    pub branch_roll_deg: f64,
    /// Each segment is longer or shorter by up to this share.
    pub length_jitter: f64,
    /// One stem or several.
    pub habit: Habit,
    /// How many a shrub has.
    pub stems: u32,
    /// How far each of them leans, degrees.
    pub lean_deg: f64,
}

impl LSystem {
    /// A grammar with everything else as it is when nobody says.
    pub(super) fn of(grammar: Grammar) -> Self {
        Self {
            grammar,
            angle_deg: 25.0,
            derivations: 4,
            segment_length_m: 0.1,
            symbol_limit: 50_000_000,
            segment_width_m: 0.01,
            width_ratio: 0.7,
            tropism: [0.0, -1.0, 0.0],
            susceptibility: 0.0,
            angle_jitter_deg: 0.0,
            branch_roll_deg: 0.0,
            length_jitter: 0.0,
            habit: Habit::Tree,
            stems: 4,
            lean_deg: 15.0,
        }
    }

    /// How much it gives, all stems of a shrub together.
    ///
    /// # Errors
    /// Those of [`lsystem::forecast`].
    pub fn forecast(&self) -> Result<Forecast, LsystemError> {
        let one = lsystem::forecast(&self.grammar, self.derivations)?;
        let stems = if self.habit == Habit::Shrub { self.stems.into() } else { 1 };
        let [symbols, segments] = [one.symbols, one.segments].map(|count| count.saturating_mul(stems));
        Ok(Forecast { symbols, segments, ..one })
    }

    /// The settings of its derivation and its turtle.
    pub(crate) fn settings(&self, seed: u64) -> Settings {
        Settings {
            derivations: self.derivations,
            angle_deg: self.angle_deg,
            segment_m: self.segment_length_m,
            symbol_limit: self.symbol_limit,
            seed,
            segment_width_m: self.segment_width_m,
            width_ratio: self.width_ratio,
            tropism: self.tropism,
            susceptibility: self.susceptibility,
            variation: Variation {
                angle_deg: self.angle_jitter_deg,
                roll_deg: self.branch_roll_deg,
                length: self.length_jitter,
            },
            habit: match self.habit {
                Habit::Tree => lsystem::Habit::Tree,
                Habit::Shrub => lsystem::Habit::Shrub { stems: self.stems, lean_deg: self.lean_deg },
            },
        }
    }
}

/// The section's knobs.
pub(super) const KNOBS: &[PresetKnob] = &[
    row!(
        LSystem,
        "derivations",
        integer(0, MAX_DERIVATIONS as u64),
        "",
        "how often the rules are applied",
        lsystem.derivations
    ),
    row!(LSystem, "angle", real(-360.0, 360.0), "deg", "turn of + - & ^ \\ /", lsystem.angle_deg),
    row!(LSystem, "segment_length", real(1e-4, 1e3), "m", "length of an F", lsystem.segment_length_m),
    row!(
        LSystem,
        "symbol_limit",
        integer(1, MAX_SYMBOLS),
        "symbols",
        "derivations that would give more are refused",
        lsystem.symbol_limit
    ),
    row!(
        LSystem,
        "segment_width",
        real(1e-5, 1e3),
        "m",
        "diameter of !(1), and before the first !",
        lsystem.segment_width_m
    ),
    row!(
        LSystem,
        "width_ratio",
        real(0.01, 10.0),
        "",
        "a ! without a number multiplies the width by it",
        lsystem.width_ratio
    ),
    row!(
        LSystem,
        "tropism",
        Kind::Vector { auto: false },
        "",
        "where branches bend to, when susceptibility is not 0; its length counts",
        lsystem.tropism
    ),
    row!(
        LSystem,
        "susceptibility",
        real(-10.0, 10.0),
        "rad",
        "e of ABOP: how much each segment bends where it is square to tropism",
        lsystem.susceptibility
    ),
    row!(
        LSystem,
        "angle_jitter",
        real(0.0, 180.0),
        "deg",
        "each turn is by up to so much more or less, at random",
        lsystem.angle_jitter_deg
    ),
    row!(
        LSystem,
        "branch_roll",
        real(0.0, 180.0),
        "deg",
        "each branch is rolled by up to so much, at random: makes flat trees spatial",
        lsystem.branch_roll_deg
    ),
    row!(
        LSystem,
        "length_jitter",
        real(0.0, 0.95),
        "",
        "each segment is longer or shorter by up to this share, at random",
        lsystem.length_jitter
    ),
    row!(
        LSystem,
        "habit",
        Kind::Choice(Habit::WORDS),
        "",
        "one upright stem, or several that lean",
        lsystem.habit
    ),
    row!(
        LSystem,
        "stems",
        integer(1, MAX_STEMS as u64),
        "",
        "how many a shrub has: the plant as often, each with its own chance",
        lsystem.stems
    ),
    row!(LSystem, "lean", real(-180.0, 180.0), "deg", "how far each stem of a shrub leans", lsystem.lean_deg),
];

impl Preset {
    pub(super) fn lsystem(&self) -> Option<&LSystem> {
        if let Generator::LSystem(own) = &self.generator { Some(own) } else { None }
    }

    pub(super) fn lsystem_mut(&mut self) -> Option<&mut LSystem> {
        if let Generator::LSystem(own) = &mut self.generator { Some(own) } else { None }
    }
}
