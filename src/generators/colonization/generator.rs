//! Space colonization as a generator.

use glam::{DVec3, Vec3};
use linden_base::document::{Entry, Fault, Table};
use linden_base::input::{Geometry, Input, Inputs};
use linden_base::knob::{Knob, Value};
use linden_base::monitor::{Monitor, Quiet};
use linden_growth::Origin;
use linden_growth::stand::grow_at;
use linden_skeleton::Wood;
use linden_skeleton::generator::{
    Asked, Branched, Generator, GeneratorError, KeyContent, Obstruction, Obstructs, Passage, SampleSize,
    Sampler, Settings, TableKey, Tables, Task, Traits, Written,
};
use linden_skeleton::publication::{Publication, SPACE_COLONIZATION};

use crate::ColonizationError;
use crate::crown::envelope::Envelope;
use crate::crown::skin::Skin;
use crate::crown::solid::{all_dimensions, means_mesh};
use crate::crown::{self, compound::dashed};
use crate::part::{self, CrownPart, MOST_PARTS, PART, PART_CROWN, PART_KNOBS, Role};
use crate::sample::Smaller;
use crate::settings::{Colonization, Space};
use crate::standing::Standing;

/// Space colonization.
pub const GENERATOR: &dyn Generator = &SpaceColonization;

struct SpaceColonization;

/// For a mesh that was taken for a shape of crowns.
const ENVELOPE_INSTEAD: &str =
    "a mesh that the crown fills is named in place of a shape: envelope = \"crown.obj\"";

const KEYS: &[TableKey] = &[
    TableKey {
        name: "envelope",
        help: "a mesh that the crown fills, relative to the preset",
        content: KeyContent::File,
    },
    TableKey {
        name: PART,
        help: "pieces of the crown, other trees, obstacles, shade",
        content: KeyContent::Tables(Tables {
            knobs: part_knobs,
            required: &["role"],
            one_of: &["crown", "mesh"],
            files: &[("mesh", "in place of crown: a mesh, relative to the preset")],
            most: MOST_PARTS,
        }),
    },
];

fn part_knobs() -> Vec<Knob> {
    PART_KNOBS.iter().map(|row| row.field.knob).chain([PART_CROWN]).chain(all_dimensions()).collect()
}

impl Generator for SpaceColonization {
    fn id(&self) -> &'static str {
        "colonization"
    }

    fn name(&self) -> &'static str {
        "Colonization"
    }

    fn help(&self) -> &'static str {
        "branches compete for points in a crown: a shape, a mesh, or several"
    }

    fn publications(&self) -> &'static [Publication] {
        &[SPACE_COLONIZATION]
    }

    fn knobs(&self) -> Vec<Knob> {
        Colonization::all_knobs()
    }

    fn keys(&self) -> &'static [TableKey] {
        KEYS
    }

    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        let space = match (table.find("crown"), table.text("envelope")?) {
            // The knob `crown` names the shape; until it is read any will do.
            (Some(_), None) => Space::Shape { shape: "dome".to_owned(), dimensions: Vec::new() },
            (None, Some(file)) => Space::Envelope { file: file.to_owned() },
            (None, None) => {
                // What was written instead says best what was meant.
                if let Some(entry) = table.find("mesh") {
                    return Err(Fault::new(
                        entry.place,
                        format!("there is no 'mesh' here; {ENVELOPE_INSTEAD}"),
                    ));
                }
                return Err(Fault::new(
                    table.place,
                    "[colonization] has neither 'crown' (a shape) nor 'envelope' (a mesh); points go into [scan]",
                ));
            }
            (Some(_), Some(_)) => {
                let mut given: Vec<&Entry> =
                    ["crown", "envelope"].iter().filter_map(|key| table.find(key)).collect();
                given.sort_by_key(|entry| entry.place.map(|place| (place.line, place.column)));
                let names: Vec<String> = given.iter().map(|entry| format!("'{}'", entry.key)).collect();
                let message =
                    format!("[colonization] has {}; a crown is one of them: keep one", names.join(" and "));
                return Err(Fault::new(given.last().and_then(|entry| entry.place).or(table.place), message));
            }
        };
        let mut settings = Colonization::of(space);
        if let Some(entry) = table.find(PART) {
            settings.parts = part::read(&entry.node)?;
        }
        Ok(Box::new(settings))
    }

    /// Those of scans.
    fn former_knobs(&self) -> &'static [&'static str] {
        &["contract", "scan_radius", "noise_filter", "stems", "scale"]
    }

    fn value_hint(&self, knob: &str, typed: &str, asked: Asked) -> Option<&'static str> {
        (knob == "crown" && means_mesh(typed)).then_some(match asked {
            Asked::Directly => "a mesh is a SOURCE of its own, like crown.obj",
            Asked::InDocument => ENVELOPE_INSTEAD,
        })
    }

    fn key_hint(&self, key: &str) -> Option<&'static str> {
        match key {
            "mesh" | "crown_mesh" | "obj" => Some(ENVELOPE_INSTEAD),
            "scan" => Some("points have a table of their own: [scan] with file = \"points.ply\""),
            _ => None,
        }
    }
}

impl Settings for Colonization {
    fn generator(&self) -> &'static dyn Generator {
        GENERATOR
    }

    fn knobs(&self) -> Vec<(Knob, Value)> {
        self.turned()
    }

    fn set(&mut self, knob: &str, value: Value) -> bool {
        self.turn(knob, value)
    }

    fn written(&self) -> Vec<(&'static str, Written)> {
        let envelope = self.space.file().map(|file| ("envelope", Written::Text(file.to_owned())));
        let parts = (!self.parts.is_empty())
            .then(|| (PART, Written::Tables(self.parts.iter().map(CrownPart::written).collect())));
        envelope.into_iter().chain(parts).collect()
    }

    fn plain(&self) -> Box<dyn Settings> {
        let shape = |id: &str| crown::shape(id).map_or_else(|_| Vec::new(), |shape| shape.complete(&[]));
        let space = match &self.space {
            Space::Shape { shape: id, .. } => Space::Shape { shape: id.clone(), dimensions: shape(id) },
            file @ Space::Envelope { .. } => file.clone(),
        };
        let plain = |part: &CrownPart| CrownPart::of(part.role, part.solid.plain());
        let parts = self.parts.iter().map(plain).collect();
        Box::new(Self { parts, ..Self::of(space) })
    }

    fn inputs(&self) -> Vec<&str> {
        self.space.file().into_iter().chain(self.parts.iter().filter_map(CrownPart::file)).collect()
    }

    fn rename_inputs(&mut self, renamed: &dyn Fn(&str) -> Option<String>) {
        let space = match &mut self.space {
            Space::Shape { .. } => None,
            Space::Envelope { file } => Some(file),
        };
        let parts = self.parts.iter_mut().filter_map(|part| part.solid.file_mut());
        for file in space.into_iter().chain(parts) {
            if let Some(name) = renamed(file) {
                *file = name;
            }
        }
    }

    fn describe(&self, inputs: &Inputs) -> Vec<Passage> {
        let extent = |file: &str| inputs.get(file).map(|input| format!(": {}", input.extent()));
        let envelope = self.space.file().map(|file| {
            let shells = inputs.get(file).filter(|_| self.growth.root.is_none()).map(shells);
            let line = [Some(file.to_owned()), extent(file), shells].into_iter().flatten().collect();
            Passage { heading: "crown envelope", lines: vec![line] }
        });
        let parts = (!self.parts.is_empty()).then(|| {
            let lines = self.parts.iter().enumerate().flat_map(|(i, part)| {
                let extent = part.file().and_then(extent).unwrap_or_default();
                // What the first line says.
                let said = ["role", "crown"];
                let knobs = part.knobs().into_iter().filter(|(knob, _)| !said.contains(&knob.name));
                let knobs: Vec<String> =
                    knobs.map(|(knob, value)| format!("{} {value}", knob.name)).collect();
                [format!("{} {}{extent}", i + 1, part.describe()), format!("  {}", knobs.join("  "))]
            });
            Passage { heading: "parts", lines: lines.collect() }
        });
        envelope.into_iter().chain(parts).collect()
    }

    fn idle(&self, knob: &str, _: &Wood) -> Option<&'static str> {
        self.why_idle(knob)
    }

    fn traits(&self, _: &Wood) -> Traits {
        Traits { knows_use: true, ..Traits::default() }
    }

    fn stay(&mut self) -> Option<[f64; 3]> {
        let is_kept = matches!(self.space, Space::Envelope { .. });
        if is_kept {
            self.growth.stay();
        }
        let is_moved = self.growth.origin == Origin::Root;
        (!is_kept || is_moved).then(|| self.growth.root.filter(|_| !is_moved).unwrap_or_default())
    }

    fn limit(&mut self, _: &Inputs, size: &SampleSize) -> Result<bool, String> {
        self.growth.limit(self.points as usize, size)
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let grow = || -> Result<Branched, ColonizationError> {
            let standing = Standing::new(self, task.seed, task.inputs, monitor)?;
            let site = standing.fill(self, task.key(), monitor)?;
            // A root is a tree: that of the crown, of a part, of a shell of the envelope.
            let roots = 1 + site.grove.others.len() as u32;
            let branched = grow_at(site, &self.growth, monitor)?.branched(&self.growth);
            Ok(Branched { trees: if roots > 1 { (0..roots).collect() } else { Vec::new() }, ..branched })
        };
        Ok(grow()?)
    }

    /// The crown and obstacles, and, dashed, what is subtracted or shaded.
    fn outline(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Vec<Vec<Vec3>>, GeneratorError> {
        let standing = Standing::new(self, task.seed, task.inputs, monitor)?;
        let shift = self.growth.shift(standing.root, standing.origin, false) + DVec3::Y * standing.lift;
        let mut lines = standing.crown.outline();
        // With parts, the crown stands where it is to, without a lift.
        lines.extend(standing.obstacles.iter().flat_map(|obstacle| obstacle.solid.outline()));
        lines.extend(standing.shades.iter().flat_map(|shade| dashed(&shade.solid.outline())));
        for place in lines.iter_mut().flatten() {
            *place = (place.as_dvec3() + shift).as_vec3();
        }
        Ok(lines)
    }

    fn obstructions(
        &self,
        task: &Task<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Obstruction>, GeneratorError> {
        if !self.parts.iter().any(|part| matches!(part.role, Role::Obstacle | Role::Shade)) {
            return Ok(Vec::new());
        }
        let standing = Standing::new(self, task.seed, task.inputs, monitor)?;
        // With parts, all stand where they are to, without a lift.
        let shift = self.growth.shift(standing.root, standing.origin, false);
        let solids = standing.obstacles.iter().map(|obstacle| (Obstructs::Branches, obstacle.solid.skin()));
        let shades = standing.shades.iter().map(|shade| (Obstructs::Light, shade.solid.skin()));
        let placed = |(effect, skin): (Obstructs, Skin)| {
            let Skin { positions, triangles } = skin.moved(|place| (place.as_dvec3() + shift).as_vec3());
            Obstruction::new(effect, positions, triangles)
        };
        Ok(solids.chain(shades).map(placed).collect())
    }

    fn sampler<'a>(
        &'a self,
        task: &Task<'a>,
        size: SampleSize,
        monitor: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(Smaller::new(self, task, size, monitor)?))
    }
}

/// How many trees grow in a crown envelope, where that is more than one.
fn shells(input: &Input) -> String {
    let Geometry::Mesh(mesh) = &input.geometry else { return String::new() };
    // What is wrong with it is said when it is to grow.
    let count =
        Envelope::new(mesh, &Quiet).and_then(|envelope| Ok(envelope.shells(&Quiet)?.len())).unwrap_or(0);
    if count > 1 { format!(", {count} shells that stand apart: a tree in each") } else { String::new() }
}
