//! `[lsystem]`: a grammar and how it is drawn.

use super::knobs::{PresetKnob, integer, real, row};
use super::{Generator, Preset};
use crate::lsystem::{Grammar, MAX_DERIVATIONS, MAX_SYMBOLS};

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
}

impl LSystem {
    /// A grammar with everything else as it is when nobody says.
    pub(super) fn of(grammar: Grammar) -> Self {
        Self { grammar, angle_deg: 25.0, derivations: 4, segment_length_m: 0.1, symbol_limit: 50_000_000 }
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
];

impl Preset {
    pub(super) fn lsystem(&self) -> Option<&LSystem> {
        if let Generator::LSystem(own) = &self.generator { Some(own) } else { None }
    }

    pub(super) fn lsystem_mut(&mut self) -> Option<&mut LSystem> {
        if let Generator::LSystem(own) = &mut self.generator { Some(own) } else { None }
    }
}
