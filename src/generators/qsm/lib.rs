//! Real trees: tables of cylinders that other programs, or this one, made of a tree (QSM) become its skeleton.
//!
//! Nothing grows: each cylinder is a segment, its parent's end its beginning. Where a cylinder begins away from both ends of
//! the one below (`TreeQSM` lets branches begin on the bark), a segment of its own radius joins them. Branch numbers say which
//! cylinder goes on and which is a lateral; without them the thickest goes on.
//!
//! Places are in the table's axes; [`linden_base::input::Up`] turns them. Radii are those of the table: with
//! `width_steps = cylinder` each segment is the table's cylinder, with `taper` radii go from end to end.

mod nodes;

use glam::DVec3;
use linden_base::document::{Fault, Table};
use linden_base::field;
use linden_base::input::{CylinderRow, CylinderTable, Geometry, Inputs, Up, unit_name};
use linden_base::knob::{Field, Kind, Knob, Value, integer, printable, set, values};
use linden_base::monitor::Monitor;
use linden_skeleton::generator::{
    Branched, Generator, GeneratorError, InputTrees, KeyContent, Passage, RadiiFrom, Settings, TableKey,
    Task, Traits, Written,
};
use linden_skeleton::publication::{Publication, PublicationKind};
use linden_skeleton::{AxisRule, Wood};

use nodes::Builder;

/// Trees that are given as cylinders.
pub const GENERATOR: &dyn Generator = &Qsms;

/// Precision models of trees as cylinders.
const RAUMONEN: Publication = Publication {
    key: "raumonen2013",
    kind: PublicationKind::Article,
    authors: &["Raumonen, Pasi", "Kaasalainen, Mikko", "others"],
    title: "Fast Automatic Precision Tree Models from Terrestrial Laser Scanner Data",
    year: 2013,
    venue: "Remote Sensing",
    volume: "5",
    number: "2",
    pages: "491-520",
};

/// The key of the file with the cylinders.
const FILE: &str = "file";

struct Qsms;

/// A table of cylinders, and what is taken of it.
#[derive(Clone, Debug, PartialEq)]
pub struct QsmSettings {
    /// The file.
    pub file: String,
    /// Which tree of the table, from 1; 0: all.
    pub table_tree: u32,
    /// Whether the tree stays where the table has it.
    pub table_place: bool,
}

/// Why a table gives no tree.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QsmError {
    /// The file is missing or holds something else.
    #[error("the recipe is made of '{}', which must hold a table of cylinders", printable(.file))]
    WrongInput {
        /// As the settings name it.
        file: String,
    },
    /// There are not so many trees.
    #[error("table_tree = {asked}: '{}' has {trees} trees; take a number up to that, or 0 for all", printable(.file))]
    NoSuchTree {
        /// As the settings name it.
        file: String,
        /// From 1.
        asked: u32,
        /// How many there are.
        trees: usize,
    },
}

impl QsmSettings {
    /// Its knobs.
    pub const FIELDS: &[Field<Self>] = &[
        field!(
            "table_tree",
            integer(0, 1_000_000),
            "",
            "which tree of a table of cylinders, from 1 in the order of the file; 0: all of them, which tables number again; of several models of one tree the first",
            table_tree
        ),
        field!(
            "table_place",
            Kind::Switch,
            "",
            "trees stay where the table of cylinders has them; off: the first is moved to stand on 0,0,0, the others with it",
            table_place
        ),
    ];

    /// All trees of a file.
    pub fn of(file: impl Into<String>) -> Self {
        Self { file: file.into(), table_tree: 0, table_place: false }
    }

    fn table<'a>(&self, inputs: &'a Inputs) -> Result<(&'a CylinderTable, Up), QsmError> {
        match inputs.get(&self.file).map(|input| (&input.geometry, input.up)) {
            Some((Geometry::Cylinders(table), up)) => Ok((table, up)),
            _ => Err(QsmError::WrongInput { file: self.file.clone() }),
        }
    }
}

impl Generator for Qsms {
    fn id(&self) -> &'static str {
        "qsm"
    }

    fn name(&self) -> &'static str {
        "Cylinders"
    }

    fn help(&self) -> &'static str {
        "a table of cylinders (QSM) is the tree: of linden, TreeQSM, SimpleForest, rTwig, aRchi, raycloudtools"
    }

    fn publications(&self) -> &'static [Publication] {
        &[RAUMONEN]
    }

    fn knobs(&self) -> Vec<Knob> {
        QsmSettings::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[TableKey {
            name: FILE,
            help: "the table of cylinders, relative to the preset",
            content: KeyContent::File,
        }]
    }

    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        match table.text(FILE)? {
            Some(file) => Ok(Box::new(QsmSettings::of(file))),
            None => Err(Fault::new(
                table.place,
                "[qsm] has no 'file': name the table of cylinders, like file = \"tree.csv\"",
            )),
        }
    }
}

impl Settings for QsmSettings {
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
        vec![(FILE, Written::Text(self.file.clone()))]
    }

    fn plain(&self) -> Box<dyn Settings> {
        Box::new(Self::of(self.file.clone()))
    }

    fn inputs(&self) -> Vec<&str> {
        vec![&self.file]
    }

    fn rename_inputs(&mut self, renamed: &dyn Fn(&str) -> Option<String>) {
        if let Some(name) = renamed(&self.file) {
            self.file = name;
        }
    }

    fn describe(&self, inputs: &Inputs) -> Vec<Passage> {
        let extent = inputs.get(&self.file).map(|input| format!(": {}", input.extent()));
        let line = format!("{}{}", self.file, extent.unwrap_or_default());
        let several = self.table(inputs).ok().and_then(|(table, _)| Several::of(table));
        vec![Passage {
            heading: "cylinders",
            lines: std::iter::once(line).chain(several.map(Several::line)).collect(),
        }]
    }

    fn trees(&self, inputs: &Inputs, _: &dyn Monitor) -> Result<Option<InputTrees>, GeneratorError> {
        // What is wrong with a table is said by who grows it.
        let of_table = |(table, _): (&CylinderTable, _)| {
            let counts = firsts(table).into_iter().map(|tree| (tree as u32 + 1, table.trees[tree].len()));
            let (told_by, numbers) = (printable(&self.file), counts.collect());
            InputTrees { knob: "table_tree", told_by, made_of: "cylinders", numbers }
        };
        let trees = self.table(inputs).ok().filter(|_| self.table_tree == 0).map(of_table);
        Ok(trees.filter(|trees| trees.numbers.len() > 1))
    }

    fn traits(&self, _: &Wood) -> Traits {
        Traits { radii: RadiiFrom::Generator, axes: AxisRule::Grammar, ..Traits::default() }
    }

    fn draws(&self) -> bool {
        false
    }

    fn stay(&mut self) -> Option<[f64; 3]> {
        (!self.table_place).then_some([0.0; 3])
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let (table, up) = self.table(task.inputs).map_err(GeneratorError::failed)?;
        let chosen: Vec<&[CylinderRow]> = match (self.table_tree as usize).checked_sub(1) {
            None => firsts(table).into_iter().map(|tree| &table.trees[tree][..]).collect(),
            Some(index) => {
                let tree = table.trees.get(index).ok_or_else(|| {
                    GeneratorError::failed(QsmError::NoSuchTree {
                        file: self.file.clone(),
                        asked: self.table_tree,
                        trees: table.trees.len(),
                    })
                })?;
                vec![&tree[..]]
            }
        };
        // A link may join each cylinder to the one below.
        let most = 3 * chosen.iter().map(|tree| tree.len()).sum::<usize>() as u64;
        monitor.admit("making a tree of cylinders", most * nodes::BYTES_PER_NODE, "take a smaller table")?;
        let foot = chosen.iter().copied().flatten().next().map_or(DVec3::ZERO, |row| row.start);
        let shift = if self.table_place { DVec3::ZERO } else { foot };
        let mut builder = Builder::new(up, shift, task.wood.width_steps);
        for tree in &chosen {
            monitor.check()?;
            builder.add(tree);
        }
        let mut notes: Vec<String> = scale_note(table.scale).into_iter().collect();
        // As the table has it, without the digits that scaling leaves.
        let foot_in_file = if table.scale == 1.0 { foot } else { (foot / table.scale * 1e6).round() / 1e6 };
        if shift != DVec3::ZERO {
            let [x, y, z] = foot_in_file.to_array();
            notes.push(format!(
                "the foot at {x}, {y}, {z} of the table was moved to 0,0,0; table_place=true leaves it where it is"
            ));
        }
        notes.extend(builder.note());
        notes.extend(thin_note(&chosen));
        notes.extend(Several::of(table).filter(|_| self.table_tree == 0).map(|it| it.note(&self.file)));
        let trees = if chosen.len() > 1 { builder.trees().to_vec() } else { Vec::new() };
        Ok(Branched {
            branching: builder.finish(),
            trees,
            foot: (chosen.len() == 1).then_some(foot_in_file),
            most_nodes: u64::from(u32::MAX),
            notes,
            ..Branched::default()
        })
    }
}

/// The trees of a table, without further models of one of them.
fn firsts(table: &CylinderTable) -> Vec<usize> {
    let models_of = table.models_of();
    (0..models_of.len()).filter(|&tree| models_of[tree] == tree).collect()
}

/// How many trees and models a table has, where it has more than one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Several {
    trees: usize,
    models: usize,
}

impl Several {
    fn of(table: &CylinderTable) -> Option<Self> {
        let (trees, models) = (firsts(table).len(), table.trees.len());
        (models > 1).then_some(Self { trees, models })
    }

    /// As a page shows it.
    fn line(self) -> String {
        match self {
            Self { trees: 1, models } => {
                format!("{models} models of one tree; table_tree=N takes one, else the first is")
            }
            Self { trees, models } if models > trees => {
                format!("{trees} trees, {models} models of them; table_tree=N takes one")
            }
            Self { trees, .. } => format!("{trees} trees; table_tree=N takes one"),
        }
    }

    /// What is said where all are asked for.
    fn note(self, file: &str) -> String {
        let (file, Self { trees, models }) = (printable(file), self);
        let of_models = format!(
            "{file} has {models} models of {}, whose feet are at one place, as runs of TreeQSM leave them; the first was taken{}; \
             table_tree=N takes another",
            if trees == 1 { "one tree".to_owned() } else { format!("{trees} trees") },
            if trees == 1 { "" } else { " of each, and all trees for one plant" },
        );
        let of_trees = format!(
            "{file} tells {trees} trees apart, and all of its cylinders were taken for one plant; table_tree=N takes one of them, \
             'linden export {file} -o trees/' grows each"
        );
        if models > trees { of_models } else { of_trees }
    }
}

/// What is said of cylinders whose radius is 0: wood has one, and is made as thin as any may be.
fn thin_note(trees: &[&[CylinderRow]]) -> Option<String> {
    let count = trees.iter().copied().flatten().filter(|row| row.radius_m == 0.0).count();
    let (cylinders, have) = if count == 1 { ("cylinder", "has") } else { ("cylinders", "have") };
    (count > 0).then(|| {
        format!(
            "{count} {cylinders} of the table {have} a radius of 0 and were made a thousandth as thick as the thickest; give them \
             the radius that they have"
        )
    })
}

/// What is said of a table that was taken to be in another unit.
fn scale_note(scale: f64) -> Option<String> {
    let unit = unit_name(scale);
    (scale != 1.0).then(|| {
        format!(
            "no tree is so large in metres: the table was taken for {unit} (times {scale}); write it in metres if that is wrong"
        )
    })
}

#[cfg(test)]
mod tests {
    use linden_base::input::CylinderDialect;

    use super::*;

    /// Poles of 2 m at these places along x, the later the thicker.
    fn table(dialect: CylinderDialect, feet: &[f64]) -> CylinderTable {
        let pole = |(&x, number): (&f64, u32)| {
            let start = DVec3::new(x, 0.0, 0.0);
            vec![CylinderRow {
                parent: None,
                start,
                end: start + 2.0 * DVec3::Z,
                along: None,
                radius_m: 0.1 * f64::from(number),
                end_radii_m: None,
                branch: None,
                birth: None,
                nodes: None,
            }]
        };
        CylinderTable { dialect, scale: 1.0, trees: feet.iter().zip(1..).map(pole).collect() }
    }

    #[test]
    fn models_with_one_foot_are_runs_of_one_tree() {
        use CylinderDialect::{Raycloudtools, TreeQsm};
        let of = |dialect, feet: &[f64]| {
            let table = table(dialect, feet);
            (firsts(&table), Several::of(&table).map(|it| it.note("a.mat")))
        };
        assert_eq!(of(TreeQsm, &[5.0]), (vec![0], None));
        let (trees, note) = of(TreeQsm, &[5.0, 5.05, 4.97]);
        assert!(trees == [0] && note.unwrap().contains("3 models of one tree"));
        let (trees, note) = of(TreeQsm, &[5.0, 20.0, 5.1, 20.0]);
        assert!(trees == [0, 1] && note.unwrap().contains("4 models of 2 trees"));
        let (trees, note) = of(TreeQsm, &[5.0, 20.0]);
        assert!(trees == [0, 1] && note.unwrap().contains("tells 2 trees apart"));
        // A stool has several stems, and no runs.
        let (trees, note) = of(Raycloudtools, &[5.0, 5.1]);
        assert!(trees == [0, 1] && note.unwrap().contains("tells 2 trees apart"));
    }
}
