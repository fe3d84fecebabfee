//! What a grammar is grown with, and the limits of that.

use super::error::{LsystemError, Short};
use super::variation::Variation;

/// The most derivation steps: far more than any tree has, few enough to walk through.
pub const MAX_DERIVATIONS: u32 = 10_000;
/// The most branches open at once: the turtle remembers a state for each.
pub const MAX_NESTING: usize = 100_000;
/// The highest [`TurtleSettings::symbol_limit`]: nodes are numbered in 32 bits, and a symbol makes at most
/// two of them.
pub const MAX_SYMBOLS: u64 = 1 << 30;

pub(super) const ANGLE_RANGE_DEG: [f64; 2] = [-360.0, 360.0];
const SEGMENT_RANGE_M: [f64; 2] = [1e-6, 1e6];
/// The most stems of a shrub.
pub const MAX_STEMS: u32 = 100;
/// How a grammar is grown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurtleSettings {
    /// Derivation steps, 0 to [`MAX_DERIVATIONS`]; 0 draws the axiom.
    pub derivations: u32,
    /// The turn of each rotation that names no angle, −360 to 360 degrees.
    pub angle_deg: f64,
    /// The length of `F`, `G` and `f`, and the unit of their arguments; 10⁻⁶ to 10⁶ m.
    pub segment_m: f64,
    /// Longer strings are refused; 1 to [`MAX_SYMBOLS`].
    pub symbol_limit: u64,
    /// The root of all random choices.
    pub seed: u64,
    /// The diameter that `!(1)` sets, 10⁻⁶ to 10⁶ m.
    pub segment_width_m: f64,
    /// The factor of the width at each `!`, 0.01 to 10.
    pub width_ratio: f64,
    /// T: where branches bend to. Its length counts; each component −10 to 10.
    pub tropism: [f64; 3],
    /// e: after each segment the turtle turns by e·|H × T| radians about H × T (ABOP, p. 58); −10 to 10.
    pub susceptibility: f64,
    /// How much chance changes.
    pub variation: Variation,
    /// One stem or several.
    pub habit: Stems,
}

/// How a plant stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stems {
    /// On one upright stem.
    One,
    /// On several: the plant is repeated about its foot, each time with other random choices.
    Several {
        /// How often, 1 to [`MAX_STEMS`].
        stems: u32,
        /// How far each leans, −180 to 180 degrees.
        lean_deg: f64,
    },
}

impl Default for TurtleSettings {
    /// Four derivations of decimetre segments, at 25.7 degrees, of up to 50 million symbols.
    fn default() -> Self {
        Self {
            derivations: 4,
            angle_deg: 25.7,
            segment_m: 0.1,
            symbol_limit: 50_000_000,
            seed: 0,
            segment_width_m: 0.01,
            width_ratio: 0.7,
            tropism: [0.0, -1.0, 0.0],
            susceptibility: 0.0,
            variation: Variation::default(),
            habit: Stems::One,
        }
    }
}

impl TurtleSettings {
    /// Checks that each is in its range.
    pub(super) fn check(&self) -> Result<(), LsystemError> {
        check_derivations(self.derivations)?;
        check_real("angle_deg", self.angle_deg, ANGLE_RANGE_DEG)?;
        check_real("segment_m", self.segment_m, SEGMENT_RANGE_M)?;
        check_whole("symbol_limit", self.symbol_limit, 1, MAX_SYMBOLS)?;
        check_real("segment_width_m", self.segment_width_m, SEGMENT_RANGE_M)?;
        check_real("width_ratio", self.width_ratio, [0.01, 10.0])?;
        for component in self.tropism {
            check_real("tropism", component, [-10.0, 10.0])?;
        }
        check_real("susceptibility", self.susceptibility, [-10.0, 10.0])?;
        let Variation { angle_deg, roll_deg, length } = self.variation;
        check_real("variation.angle_deg", angle_deg, [0.0, 180.0])?;
        check_real("variation.roll_deg", roll_deg, [0.0, 180.0])?;
        check_real("variation.length", length, [0.0, 0.95])?;
        let Stems::Several { stems, lean_deg } = self.habit else { return Ok(()) };
        check_whole("stems", stems.into(), 1, MAX_STEMS.into())?;
        check_real("lean_deg", lean_deg, [-180.0, 180.0])
    }
}

pub(super) fn check_derivations(derivations: u32) -> Result<(), LsystemError> {
    check_whole("derivations", derivations.into(), 0, MAX_DERIVATIONS.into())
}

fn check_whole(name: &'static str, value: u64, min: u64, max: u64) -> Result<(), LsystemError> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(LsystemError::Setting { name, value: value.to_string(), expected: format!("{min} to {max}") })
}

fn check_real(name: &'static str, value: f64, [min, max]: [f64; 2]) -> Result<(), LsystemError> {
    if (min..=max).contains(&value) {
        return Ok(());
    }
    Err(LsystemError::Setting { name, value: Short(value).to_string(), expected: format!("{min} to {max}") })
}
