//! Weber and Penn's trees as a generator.

use linden_base::document::{Fault, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value, set, values};
use linden_base::monitor::Monitor;
use linden_skeleton::generator::{
    Bears, Branched, Generator, GeneratorError, Passage, RadiiFrom, SampleSize, Sampler, Settings, Steps,
    TableKey, Task, Traits,
};
use linden_skeleton::organs::Organs;
use linden_skeleton::publication::{Publication, PublicationKind};
use linden_skeleton::{AxisRule, Wood};

use crate::forecast::forecast;
use crate::sample::Sparse;
use crate::{WeberPenn, grow};

/// The parametric trees of Weber and Penn.
pub const GENERATOR: &dyn Generator = &WeberPennTrees;

/// The paper.
const WEBER_PENN: Publication = Publication {
    key: "weber1995",
    kind: PublicationKind::InProceedings,
    authors: &["Weber, Jason", "Penn, Joseph"],
    title: "Creation and Rendering of Realistic Trees",
    year: 1995,
    venue: "Proceedings of SIGGRAPH 95",
    volume: "",
    number: "",
    pages: "119-128",
};

/// Steps in which a whole tree is shown to grow.
const PLAYED: u32 = 40;

struct WeberPennTrees;

impl Generator for WeberPennTrees {
    fn id(&self) -> &'static str {
        "weber-penn"
    }

    fn name(&self) -> &'static str {
        "Weber-Penn"
    }

    fn help(&self) -> &'static str {
        "stems bear stems, level by level, by lengths, angles and curves that parameters give"
    }

    fn publications(&self) -> &'static [Publication] {
        &[WEBER_PENN]
    }

    fn knobs(&self) -> Vec<Knob> {
        WeberPenn::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[]
    }

    fn read(&self, _: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        Ok(Box::new(WeberPenn::default()))
    }
}

impl Settings for WeberPenn {
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

    fn describe(&self, _: &Inputs) -> Vec<Passage> {
        let line = |(level, expected): (usize, &crate::LevelForecast)| {
            let clones = if expected.clones < 0.5 {
                String::new()
            } else {
                format!(" and {:.0} clones", expected.clones)
            };
            let leaves = if expected.leaves < 0.5 {
                String::new()
            } else {
                format!(", with about {:.0} leaves", expected.leaves)
            };
            let stems = if expected.stems < 1.5 { "stem" } else { "stems" };
            format!("level {level}: {:.0} {stems}{clones}{leaves}", expected.stems)
        };
        let lines = forecast(self).levels.iter().enumerate().map(line).collect();
        vec![Passage { heading: "stems that are expected", lines }]
    }

    fn idle(&self, knob: &str, _: &Wood) -> Option<&'static str> {
        self.why_idle(knob)
    }

    fn traits(&self, _: &Wood) -> Traits {
        Traits {
            radii: RadiiFrom::Generator,
            axes: AxisRule::Grammar,
            bears: if self.leaves != 0.0 && self.levels > 1 { Bears::Leaves } else { Bears::Nothing },
            ..Traits::default()
        }
    }

    fn steps(&self) -> Option<Steps> {
        Some(Steps { count: Steps::after(self.age, PLAYED), unit: "step" })
    }

    fn at_step(&self, step: u32) -> Option<Box<dyn Settings>> {
        let reached = f64::from(step) / f64::from(Steps::after(self.age, PLAYED));
        Some(Box::new(Self { age: (self.age * reached).clamp(0.0, 1.0), ..self.clone() }))
    }

    fn whole(&self) -> Option<Box<dyn Settings>> {
        (self.age < 1.0).then(|| Box::new(Self { age: 1.0, ..self.clone() }) as _)
    }

    fn limit(&mut self, _: &Inputs, size: &SampleSize) -> Result<bool, String> {
        self.max_nodes = self.max_nodes.min(size.nodes);
        Ok(false)
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let drawn = grow(self, task.key().named("weber-penn"), monitor)?;
        let (branching, organs) = (drawn.branching, Organs { need_form: true, ..drawn.organs });
        Ok(Branched { branching, organs, most_nodes: self.max_nodes.into(), ..Branched::default() })
    }

    fn sampler<'a>(
        &'a self,
        _: &Task<'a>,
        size: SampleSize,
        _: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(Sparse::new(self, size)))
    }
}
