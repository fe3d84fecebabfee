//! A fractal comb: a generator for tests, and all that a generator takes.
//!
//! A stem bears teeth at equal distances, and each tooth is a smaller comb.

use glam::Vec3;
use linden_base::document::{Fault, Table};
use linden_base::field;
use linden_base::knob::{Field, Knob, Value, integer, real, set, values};
use linden_base::monitor::Monitor;
use linden_skeleton::generator::{Branched, Generator, GeneratorError, Settings, TableKey, Task};
use linden_skeleton::{Branching, NO_PARENT};

/// Fractal combs.
pub const GENERATOR: &dyn Generator = &Combs;

struct Combs;

/// How a comb grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Comb {
    /// How often teeth bear teeth.
    pub depth: u32,
    /// Teeth of a stem.
    pub teeth: u32,
    /// Length of the stem, metres.
    pub length_m: f64,
    /// Length of a tooth / length of what bears it.
    pub ratio: f64,
}

impl Comb {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!("comb_depth", integer(0, 8), "", "how often teeth bear teeth", depth),
        field!("comb_teeth", integer(1, 100), "", "teeth of a stem", teeth, aliases(&["comb_prongs"])),
        field!("comb_length", real(0.01, 100.0), "m", "length of the stem", length_m),
        field!("comb_ratio", real(0.05, 0.9), "", "length of a tooth / length of what bears it", ratio),
    ];
}

impl Generator for Combs {
    fn id(&self) -> &'static str {
        "comb"
    }

    fn name(&self) -> &'static str {
        "Fractal comb"
    }

    fn help(&self) -> &'static str {
        "teeth bear teeth"
    }

    fn knobs(&self) -> Vec<Knob> {
        Comb::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[]
    }

    fn read(&self, _: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        Ok(Box::new(Comb { depth: 2, teeth: 6, length_m: 2.0, ratio: 0.4 }))
    }
}

impl Settings for Comb {
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
        Box::new(Self { depth: 2, teeth: 6, length_m: 2.0, ratio: 0.4 })
    }

    fn draws(&self) -> bool {
        false
    }

    fn grow(&self, _: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let mut branching = Branching {
            positions: vec![Vec3::ZERO],
            parents: vec![NO_PARENT],
            births: vec![0],
            radii: None,
            edges: None,
        };
        self.stem(0, 0, Vec3::Y, self.length_m as f32, &mut branching, monitor)?;
        Ok(Branched { branching, ..Branched::default() })
    }
}

impl Comb {
    fn stem(
        &self,
        level: u32,
        foot: u32,
        along: Vec3,
        length_m: f32,
        branching: &mut Branching,
        monitor: &dyn Monitor,
    ) -> Result<(), GeneratorError> {
        monitor.check()?;
        let across = if along.y.abs() > 0.5 { Vec3::X } else { Vec3::Y };
        let mut node = foot;
        let from = branching.positions[foot as usize];
        for tooth in 1..=self.teeth {
            branching.parents.push(node);
            branching.births.push(level * self.teeth + tooth);
            branching.positions.push(from + along * (length_m * tooth as f32 / self.teeth as f32));
            node = branching.positions.len() as u32 - 1;
            if level < self.depth {
                self.stem(level + 1, node, across, length_m * self.ratio as f32, branching, monitor)?;
            }
        }
        Ok(())
    }
}
