//! L-systems as a generator.

use linden_base::document::{Datum, Fault, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value, set, values};
use linden_base::monitor::Monitor;
use linden_skeleton::generator::{
    Branched, Generator, GeneratorError, KeyContent, Passage, RadiiFrom, SampleSize, Sampler, Settings,
    Steps, TableKey, Task, Traits, Written,
};
use linden_skeleton::publication::{ABOP, Publication};
use linden_skeleton::{AxisRule, Width, Wood};

use crate::chance::chooses;
use crate::sample::Fewer;
use crate::{Drawn, Grammar, GrammarPart, LSystem, LsystemError, grow};

/// L-systems.
pub const GENERATOR: &dyn Generator = &LSystems;

struct LSystems;

impl Generator for LSystems {
    fn id(&self) -> &'static str {
        "lsystem"
    }

    fn name(&self) -> &'static str {
        "L-system"
    }

    fn help(&self) -> &'static str {
        "rules rewrite a string of symbols, which a turtle draws"
    }

    fn publications(&self) -> &'static [Publication] {
        &[ABOP]
    }

    fn knobs(&self) -> Vec<Knob> {
        LSystem::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[
            TableKey {
                name: "axiom",
                help: "the string that derivation begins with",
                content: KeyContent::Text,
            },
            TableKey {
                name: "rules",
                help: "what symbols are rewritten to, one text a rule",
                content: KeyContent::Texts,
            },
        ]
    }

    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        let missing = |what: &str| Fault::new(table.place, format!("[lsystem] has no '{what}'"));
        let axiom = &table.find("axiom").ok_or_else(|| missing("axiom"))?.node;
        let rules = &table.find("rules").ok_or_else(|| missing("rules"))?.node;
        let Datum::List(items) = &rules.datum else {
            return Err(rules.mismatch("rules", "a list of texts like [\"F -> F[+F]F\"]"));
        };
        let axiom_text = axiom.text("axiom")?.to_owned();
        let texts =
            items.iter().map(|item| item.text("rules").map(str::to_owned)).collect::<Result<Vec<_>, _>>()?;
        let grammar = Grammar::new(&axiom_text, &texts).map_err(|error| {
            let node = match error.part {
                GrammarPart::Axiom => axiom,
                GrammarPart::Rule(index) => items.get(index).unwrap_or(rules),
            };
            Fault::new(table.inside(node, error.column), format!("{}: {}", error.part, error.problem))
        })?;
        Ok(Box::new(LSystem::of(grammar)))
    }
}

/// An L-system's error as a generator's.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("growing the L-system: {0}")]
pub struct GrowingError(#[source] pub LsystemError);

impl From<LsystemError> for GeneratorError {
    fn from(error: LsystemError) -> Self {
        match error {
            LsystemError::Cancelled(cancelled) => cancelled.into(),
            other => Self::failed(GrowingError(other)),
        }
    }
}

impl Settings for LSystem {
    fn generator(&self) -> &'static dyn Generator {
        GENERATOR
    }

    fn knobs(&self) -> Vec<(Knob, Value)> {
        values(Self::FIELDS, self)
    }

    fn set(&mut self, knob: &str, value: Value) -> bool {
        set(Self::FIELDS, self, knob, value)
    }

    fn written(&self) -> Vec<(&'static str, Written)> {
        // The grammar shows its axiom, then its rules, a line each.
        let text = self.grammar.to_string();
        let mut lines = text.lines();
        let axiom = lines.next().unwrap_or_default().to_owned();
        vec![("axiom", Written::Text(axiom)), ("rules", Written::Texts(lines.map(str::to_owned).collect()))]
    }

    fn describe(&self, _: &Inputs) -> Vec<Passage> {
        let lines = self.grammar.to_string().lines().map(str::to_owned).collect();
        let mut passages = vec![Passage { heading: "grammar", lines }];
        let constants = self.grammar.constants();
        if !constants.is_empty() {
            let line = |(name, written, number): &(&str, String, f64)| {
                let value = number.to_string();
                if *written == value {
                    format!("{name} = {value}")
                } else {
                    format!("{name} = {written} = {value}")
                }
            };
            let lines = constants.iter().map(line).collect();
            passages.push(Passage { heading: "constants (--define NAME=VALUE)", lines });
        }
        passages
    }

    fn plain(&self) -> Box<dyn Settings> {
        Box::new(Self::of(self.grammar.clone()))
    }

    fn idle(&self, knob: &str, wood: &Wood) -> Option<&'static str> {
        self.why_idle(knob, wood)
    }

    fn traits(&self, wood: &Wood) -> Traits {
        Traits {
            radii: if self.gives_radii(wood) { RadiiFrom::Generator } else { RadiiFrom::Rule },
            axes: AxisRule::Grammar,
            places_organs: self.writes("{~", false),
            knows_use: false,
            tells_age: self.derivations_grown() == 0 || !self.rewrites_all_wood(),
        }
    }

    fn draws(&self) -> bool {
        [self.angle_jitter_deg, self.branch_roll_deg, self.length_jitter].iter().any(|&most| most > 0.0)
            || chooses(&self.grammar, self.derivations_grown())
    }

    fn steps(&self) -> Option<Steps> {
        Some(Steps { count: self.derivations_grown(), unit: "derivation" })
    }

    fn at_step(&self, derivations: u32) -> Option<Box<dyn Settings>> {
        let (derivations, age) = Steps::at(derivations, self.derivations);
        Some(Box::new(Self { derivations, age, ..self.clone() }))
    }

    fn whole(&self) -> Option<Box<dyn Settings>> {
        (self.derivations_grown() < self.derivations)
            .then(|| Box::new(Self { age: 1.0, ..self.clone() }) as _)
    }

    fn limit(&mut self, _: &Inputs, size: &SampleSize) -> Result<bool, String> {
        self.symbol_limit = self.symbol_limit.min(size.symbols);
        Ok(false)
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let Drawn { mut branching, organs, symbols } = grow(&self.grammar, &self.turtle(task.seed), monitor)?;
        // Without a '!' the turtle's width is the same everywhere.
        if task.wood.width == Width::Grammar && branching.radii.is_none() {
            let radius_m = (0.5 * self.segment_width_m) as f32;
            branching.radii = Some(vec![radius_m; branching.positions.len()]);
        }
        let most_nodes = self.symbol_limit;
        Ok(Branched { branching, organs, most_nodes, symbols: Some(symbols), ..Branched::default() })
    }

    fn sampler<'a>(
        &'a self,
        _: &Task<'a>,
        size: SampleSize,
        monitor: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(Fewer::new(self, size, monitor)?))
    }
}
