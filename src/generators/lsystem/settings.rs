//! A grammar and how it is drawn: the settings of the generator.

use std::collections::BTreeMap;

use linden_base::knob::{Field, Kind, integer, real};
use linden_base::{field, words};
use linden_skeleton::generator::Steps;
use linden_skeleton::{Width, Wood};

use crate::{
    DefineError, Exposed, Forecast, Grammar, LsystemError, MAX_DERIVATIONS, MAX_STEMS, MAX_SYMBOLS,
    Production, Stems, TurtleSettings, Variation, forecast,
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
    /// Constants of the grammar that are knobs. See [`LSystem::expose`].
    pub exposed: Vec<Exposed>,
    /// What some of them were set to, by name, that the grammar cannot have: growing says so.
    pub unfit: BTreeMap<&'static str, DefineError>,
    /// Turn of `+` and the like, degrees.
    pub angle_deg: f64,
    /// Rewriting steps.
    pub derivations: u32,
    /// The share of them that the plant has behind it.
    pub age: f64,
    /// Length of an `F`, metres.
    pub segment_length_m: f64,
    /// Derivations that give more symbols are refused.
    pub symbol_limit: u64,
    /// Diameter of a `!(1)`, metres.
    pub segment_width_m: f64,
    /// The factor of the width at each `!`.
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
            exposed: Vec::new(),
            unfit: BTreeMap::new(),
            angle_deg: 25.0,
            derivations: 4,
            age: 1.0,
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

    /// The derivations that the plant has behind it at its age.
    ///
    /// ```
    /// use linden_lsystem::{Grammar, LSystem};
    /// let grammar = Grammar::new("F", &["F -> FF"])?;
    /// assert_eq!(LSystem { derivations: 8, age: 0.3, ..LSystem::of(grammar) }.derivations_grown(), 3);
    /// # Ok::<(), linden_lsystem::GrammarError>(())
    /// ```
    pub fn derivations_grown(&self) -> u32 {
        Steps::after(self.age, self.derivations)
    }

    /// How much it gives, all stems of a shrub together.
    ///
    /// # Errors
    /// Those of [`forecast`](crate::forecast()).
    pub fn forecast(&self) -> Result<Forecast, LsystemError> {
        let one = forecast(&self.grammar, self.derivations_grown())?;
        let stems = if self.habit == StemHabit::Shrub { self.stems.into() } else { 1 };
        let [symbols, segments] = [one.symbols, one.segments].map(|count| count.saturating_mul(stems));
        Ok(Forecast { symbols, segments, ..one })
    }

    /// The settings of its derivation and its turtle.
    pub fn turtle(&self, seed: u64) -> TurtleSettings {
        TurtleSettings {
            derivations: self.derivations_grown(),
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
            derivations,
            details(
                "n of ABOP. The string grows by a factor with each, of 2 to 8 for most grammars, so this is \
                 the coarsest knob for size and detail: 4 to 8 is usual. 0 draws the axiom. linden show \
                 says before anything is derived how many symbols and segments there will be. Where rules \
                 lengthen the plant, it gets larger as well as finer: see segment_length."
            ),
            see_also(&["segment_length", "symbol_limit", "age"])
        ),
        field!(
            "age",
            real(0.0, 1.0),
            "",
            "how far growth has come: the young plant after this share of all derivations; 1: the whole plant",
            age,
            details(
                "At 0.4 of 10 derivations the rules are applied 4 times, once at least; whatever the grammar makes \
                 longer, thicker or drops with time is as it was then."
            ),
            see_also(&["derivations"])
        ),
        field!(
            "angle",
            real(-360.0, 360.0),
            "deg",
            "turn of + - & ^ \\ /",
            angle_deg,
            details(
                "δ of ABOP, for all turns that name no angle; those of +(45) stay. Figures 1.24 a to f of \
                 ABOP have 20 to 25.7 degrees: less draws slender brooms, more spreads the plant, 90 makes \
                 squares."
            ),
            see_also(&["angle_jitter", "branch_roll"])
        ),
        field!(
            "segment_length",
            real(1e-4, 1e3),
            "m",
            "length of an F",
            segment_length_m,
            details(
                "F(2) is twice as long. It scales all lengths of the plant but not widths that the grammar \
                 sets with !, which have their unit in segment_width."
            ),
            see_also(&["segment_width", "derivations", "length_jitter"])
        ),
        field!(
            "symbol_limit",
            integer(1, MAX_SYMBOLS),
            "symbols",
            "derivations that would give more are refused",
            symbol_limit,
            see_also(&["derivations", "stems"])
        ),
        field!(
            "segment_width",
            real(1e-5, 1e3),
            "m",
            "diameter of !(1), and before the first !",
            segment_width_m,
            details(
                "The unit of widths in a grammar: !(3) draws wood three times as thick. Only for radii of \
                 the grammar (width=auto or grammar), and base_radius, where it is given, decides instead."
            ),
            see_also(&["width_ratio", "width", "base_radius"])
        ),
        field!(
            "width_ratio",
            real(0.01, 10.0),
            "",
            "a ! without a number multiplies the width by it",
            width_ratio,
            details(
                "0.7 is about the square root of a half, which leaves the cross-section as it was where a \
                 branch forks in two (w_r = 0.707 in ABOP, figure 2.6). 0.5 makes twigs thin fast, 0.9 \
                 keeps them stout."
            ),
            see_also(&["segment_width", "radius_exponent"])
        ),
        field!(
            "tropism",
            Kind::Vector { auto: false },
            "",
            "where branches bend to, when susceptibility is not 0; its length counts",
            tropism,
            details(
                "T of ABOP (section 2.1): after each segment the heading H turns towards it by e·|H×T|, \
                 with susceptibility for e. 0,-1,0 lets branches hang, 0,1,0 lifts them; one at a slant, as \
                 -0.61,0.77,-0.19 in ABOP's figure 2.8 d, draws the tree to a side."
            ),
            see_also(&["susceptibility"])
        ),
        field!(
            "susceptibility",
            real(-10.0, 10.0),
            "rad",
            "e of ABOP: how much each segment bends where it is square to tropism",
            susceptibility,
            details(
                "Figures 2.8 of ABOP have 0.14 to 0.4. It works segment by segment: the more of them a \
                 branch has, the farther it bends. At 0.1 boughs arch a little, at 1 they hang after two or \
                 three segments; below 0 they turn away from tropism."
            ),
            see_also(&["tropism", "derivations"])
        ),
        field!(
            "angle_jitter",
            real(0.0, 180.0),
            "deg",
            "each turn is by up to so much more or less, at random",
            angle_jitter_deg,
            details(
                "Takes the ruler out of a grammar: 5 looks grown, 30 dissolves the pattern. Each turn draws \
                 for itself, keyed by its branch, so that an edit in one branch leaves the others as they \
                 are."
            ),
            see_also(&["branch_roll", "length_jitter", "angle"])
        ),
        field!(
            "branch_roll",
            real(0.0, 180.0),
            "deg",
            "each branch is rolled by up to so much, at random: makes flat trees spatial",
            branch_roll_deg,
            details(
                "At each [ the turtle rolls about its heading. Plants as flat as those of ABOP's figure \
                 1.24 spread into space at 180; 20 only loosens a plant that is spatial already."
            ),
            see_also(&["angle_jitter", "angle"])
        ),
        field!(
            "length_jitter",
            real(0.0, 0.95),
            "",
            "each segment is longer or shorter by up to this share, at random",
            length_jitter,
            see_also(&["angle_jitter", "segment_length"])
        ),
        field!(
            "habit",
            Kind::Choice(StemHabit::WORDS),
            "",
            "one upright stem, or several that lean",
            habit,
            details(
                "shrub draws the whole plant several times from one foot, each rolled on by 137.5 degrees \
                 and leaning by lean; each makes its own choices where the grammar leaves any to chance."
            ),
            see_also(&["stems", "lean"])
        ),
        field!(
            "stems",
            integer(1, MAX_STEMS as u64),
            "",
            "how many a shrub has: the plant as often, each with its own chance",
            stems,
            details(
                "Each takes as many symbols as the plant alone, and all together must stay within \
                 symbol_limit. 3 to 5 look like a hazel, a dozen hide one another."
            ),
            see_also(&["habit", "lean", "symbol_limit"])
        ),
        field!(
            "lean",
            real(-180.0, 180.0),
            "deg",
            "how far each stem of a shrub leans",
            lean_deg,
            details(
                "0 stands all stems upright in one another, which shows only where chance tells them apart; \
                 10 to 20 is an upright shrub, 60 one that lies."
            ),
            see_also(&["habit", "stems"])
        ),
    ];

    /// Whether it says itself how thick its wood is, where the wood's rule is `width`.
    pub(crate) fn gives_radii(&self, wood: &Wood) -> bool {
        wood.width == Width::Grammar || self.writes("!", false)
    }

    /// Why a knob changes nothing as these settings stand, and what would let it.
    pub(crate) fn why_idle(&self, knob: &str, wood: &Wood) -> Option<&'static str> {
        let is_ruled = matches!(wood.width, Width::Pipe | Width::Order | Width::Taper);
        match knob {
            "derivations" | "age" if self.grammar.productions().is_empty() => {
                Some("the grammar has no rules")
            }
            "age" if self.derivations <= 1 => Some("derivations is 0 or 1"),
            "angle" if !self.writes(TURNS, true) => Some("each turn of the grammar names its angle"),
            "width_steps" | "width_smoothing" if wood.width == Width::Grammar && !self.writes("!", false) => {
                Some("the grammar has no !: all its wood has one radius")
            }
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
