//! Self-organizing trees as a generator.

use linden_base::document::{Fault, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value, set, values};
use linden_base::monitor::Monitor;
use linden_skeleton::generator::{
    Branched, Generator, GeneratorError, RadiiFrom, SampleSize, Settings, TableKey, Task, Traits,
};
use linden_skeleton::publication::{Publication, PublicationKind};
use linden_skeleton::{AxisRule, Wood};

use crate::{SelfOrganizing, grow};

/// Trees whose buds compete for light.
pub const GENERATOR: &dyn Generator = &SelfOrganizingTrees;

/// The paper.
const PALUBICKI: Publication = Publication {
    key: "palubicki2009",
    kind: PublicationKind::Article,
    authors: &[
        "Pałubicki, Wojciech",
        "Horel, Kipp",
        "Longay, Steven",
        "Runions, Adam",
        "Lane, Brendan",
        "Měch, Radomír",
        "Prusinkiewicz, Przemyslaw",
    ],
    title: "Self-organizing tree models for image synthesis",
    year: 2009,
    venue: "ACM Transactions on Graphics 28(3)",
    pages: "58:1-58:10",
};

struct SelfOrganizingTrees;

impl Generator for SelfOrganizingTrees {
    fn id(&self) -> &'static str {
        "self-organizing"
    }

    fn name(&self) -> &'static str {
        "Self-organizing"
    }

    fn help(&self) -> &'static str {
        "buds compete for light year by year; what stays dark is shed"
    }

    fn publications(&self) -> &'static [Publication] {
        &[PALUBICKI]
    }

    fn knobs(&self) -> Vec<Knob> {
        SelfOrganizing::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[]
    }

    fn read(&self, _: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        Ok(Box::new(SelfOrganizing::default()))
    }
}

impl Settings for SelfOrganizing {
    fn generator(&self) -> &'static dyn Generator {
        GENERATOR
    }

    fn knobs(&self) -> Vec<(Knob, Value)> {
        values(Self::FIELDS, self)
    }

    fn set(&mut self, knob: &str, value: Value) -> bool {
        set(Self::FIELDS, self, knob, value)
    }

    fn plain(&self) -> Box<dyn Settings> {
        Box::new(Self::default())
    }

    fn idle(&self, knob: &str, _: &Wood) -> Option<&'static str> {
        self.why_idle(knob)
    }

    fn traits(&self, _: &Wood) -> Traits {
        Traits {
            radii: RadiiFrom::Generator,
            axes: AxisRule::Grammar,
            places_organs: false,
            knows_use: false,
            tells_age: true,
        }
    }

    /// Years: a younger tree has branches that the older one shed, which births do not tell.
    fn derivations(&self) -> Option<u32> {
        Some(self.years)
    }

    fn derived(&self, years: u32) -> Option<Box<dyn Settings>> {
        Some(Box::new(Self { years: years.max(1), ..self.clone() }))
    }

    fn limit(&mut self, _: &Inputs, size: &SampleSize) -> Result<bool, String> {
        self.cut_at = self.cut_at.min(size.nodes);
        Ok(false)
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let grown = grow(self, task.key().named("self-organizing"), monitor)?;
        Ok(Branched { branching: grown.branching, most_nodes: self.max_nodes.into(), ..Branched::default() })
    }
}
