//! A grammar and how it is drawn: the settings of the generator.

use linden_base::knob::{Field, Kind, integer, real};
use linden_base::{field, words};
use linden_skeleton::{Width, Wood};

use crate::{
    Forecast, Grammar, LsystemError, MAX_DERIVATIONS, MAX_STEMS, MAX_SYMBOLS, Production, Stems,
    TurtleSettings, Variation, forecast,
};

words! {
    /// How an L-system's plant stands.
    StemHabit {
        /// On one upright stem.
        Tree = "tree",
        /// On several that lean.
        Shrub = "shrub"
    }
}

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
    /// The most by which a turn is wider or narrower, degrees.
    pub angle_jitter_deg: f64,
    /// The most by which a branch is rolled to either side, degrees.
    pub branch_roll_deg: f64,
    /// Each segment is longer or shorter by up to this share.
    pub length_jitter: f64,
    /// One stem or several.
    pub habit: StemHabit,
    /// How many a shrub has.
    pub stems: u32,
    /// How far each of them leans, degrees.
    pub lean_deg: f64,
}

impl LSystem {
    /// A grammar with everything else at its default.
    pub fn of(grammar: Grammar) -> Self {
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
            habit: StemHabit::Tree,
            stems: 4,
            lean_deg: 15.0,
        }
    }

    /// How much it gives, all stems of a shrub together.
    ///
    /// # Errors
    /// Those of [`forecast`](crate::forecast()).
    pub fn forecast(&self) -> Result<Forecast, LsystemError> {
        let one = forecast(&self.grammar, self.derivations)?;
        let stems = if self.habit == StemHabit::Shrub { self.stems.into() } else { 1 };
        let [symbols, segments] = [one.symbols, one.segments].map(|count| count.saturating_mul(stems));
        Ok(Forecast { symbols, segments, ..one })
    }

    /// The settings of its derivation and its turtle.
    pub fn turtle(&self, seed: u64) -> TurtleSettings {
        TurtleSettings {
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
                StemHabit::Tree => Stems::One,
                StemHabit::Shrub => Stems::Several { stems: self.stems, lean_deg: self.lean_deg },
            },
        }
    }
}

impl LSystem {
    /// The knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "derivations",
            integer(0, MAX_DERIVATIONS as u64),
            "",
            "how often the rules are applied",
            derivations
        ),
        field!("angle", real(-360.0, 360.0), "deg", "turn of + - & ^ \\ /", angle_deg),
        field!("segment_length", real(1e-4, 1e3), "m", "length of an F", segment_length_m),
        field!(
            "symbol_limit",
            integer(1, MAX_SYMBOLS),
            "symbols",
            "derivations that would give more are refused",
            symbol_limit
        ),
        field!(
            "segment_width",
            real(1e-5, 1e3),
            "m",
            "diameter of !(1), and before the first !",
            segment_width_m
        ),
        field!(
            "width_ratio",
            real(0.01, 10.0),
            "",
            "a ! without a number multiplies the width by it",
            width_ratio
        ),
        field!(
            "tropism",
            Kind::Vector { auto: false },
            "",
            "where branches bend to, when susceptibility is not 0; its length counts",
            tropism
        ),
        field!(
            "susceptibility",
            real(-10.0, 10.0),
            "rad",
            "e of ABOP: how much each segment bends where it is square to tropism",
            susceptibility
        ),
        field!(
            "angle_jitter",
            real(0.0, 180.0),
            "deg",
            "each turn is by up to so much more or less, at random",
            angle_jitter_deg
        ),
        field!(
            "branch_roll",
            real(0.0, 180.0),
            "deg",
            "each branch is rolled by up to so much, at random: makes flat trees spatial",
            branch_roll_deg
        ),
        field!(
            "length_jitter",
            real(0.0, 0.95),
            "",
            "each segment is longer or shorter by up to this share, at random",
            length_jitter
        ),
        field!("habit", Kind::Choice(StemHabit::WORDS), "", "one upright stem, or several that lean", habit),
        field!(
            "stems",
            integer(1, MAX_STEMS as u64),
            "",
            "how many a shrub has: the plant as often, each with its own chance",
            stems
        ),
        field!("lean", real(-180.0, 180.0), "deg", "how far each stem of a shrub leans", lean_deg),
    ];

    /// Whether it says itself how thick its wood is, where the wood's rule is `width`.
    pub(crate) fn gives_radii(&self, wood: &Wood) -> bool {
        wood.width == Width::Grammar || self.writes("!", false)
    }

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub(crate) fn why_idle(&self, knob: &str, wood: &Wood) -> Option<&'static str> {
        let is_ruled = matches!(wood.width, Width::Pipe | Width::Order | Width::Taper);
        match knob {
            "derivations" if self.grammar.productions().is_empty() => Some("the grammar has no rules"),
            "angle" if !self.writes(TURNS, true) => Some("each turn of the grammar names its angle"),
            "segment_width" | "width_ratio" if is_ruled => Some("it is for width=grammar"),
            "segment_width" if wood.width == Width::Auto && !self.gives_radii(wood) => {
                Some("the grammar has no !; with width=grammar all its wood has this width")
            }
            "segment_width" if wood.base_radius_m.is_some() => {
                Some("base_radius decides how thick the wood is")
            }
            "width_ratio" if !self.writes("!", true) => Some("the grammar has no ! without a number"),
            "tropism" if self.susceptibility == 0.0 => Some("susceptibility is 0"),
            "susceptibility" if self.tropism == [0.0; 3] => Some("tropism is 0,0,0"),
            "angle_jitter" if !self.writes(TURNS, false) => Some("the grammar has no turns"),
            "branch_roll" if !self.writes("[", false) => Some("the grammar has no branches"),
            "stems" | "lean" if self.habit != StemHabit::Shrub => Some("it is for habit=shrub"),
            _ => None,
        }
    }

    /// Whether the axiom or a rule writes one of these symbols, `bare`: without arguments.
    pub(crate) fn writes(&self, symbols: &str, bare: bool) -> bool {
        let grammar = &self.grammar;
        let successors = grammar.productions().iter().flat_map(|production| &production.successor);
        let mut written = grammar.axiom().iter().chain(successors);
        written.any(|module| symbols.contains(module.symbol) && (!bare || module.arguments.is_empty()))
    }

    /// Whether every symbol that draws wood is rewritten in every derivation, so that none is older than the
    /// last one.
    pub(crate) fn rewrites_all_wood(&self) -> bool {
        let grammar = &self.grammar;
        let productions = grammar.productions();
        let written =
            || grammar.axiom().iter().chain(productions.iter().flat_map(|production| &production.successor));
        written().filter(|module| "FG".contains(module.symbol)).all(|module| {
            let fits = |production: &Production| {
                production.predecessor.symbol == module.symbol
                    && production.predecessor.parameters.len() == module.arguments.len()
                    && production.left.is_empty()
                    && production.right.is_empty()
                    && production.condition.is_none()
            };
            productions.iter().any(fits)
        })
    }
}

/// The symbols that turn.
const TURNS: &str = "+-&^\\/";
