//! A table of cylinders (CSV), one row per segment: what forestry calls a quantitative structure model.
//!
//! Columns as `TreeQSM` (Raumonen et al. 2013) gives them, named with their units: identifiers count from
//! 1 and a parent of 0 is none; parents stand before children, the cylinders of a branch one after
//! another. Branch 1 is the stem, its order 0. Length and the volume `π r² l` add up to what
//! `linden stats` says. `node` and `parent_node` are the segment's nodes, numbered from 0: what leaves the foot
//! of a stem has no cylinder below, but its node. The radii at both ends are those of the frustum that holds as
//! much as the cylinder. `tree` counts the trees of a forest from 1 ([`trees`]); ids, branches and nodes begin again in each,
//! so that the rows of one are a table for themselves.
//!
//! Trees that were measured on a scan have five columns more, of the upper end of each cylinder: the points that a
//! circle went through, their median distance from it, how much of the turn they cover, the standard error of the
//! radius, and its source: `measured`, `carried` on between measured ones, or `guessed` by the wood that it bears.
//!
//! The recipe is the one line that starts with `# recipe: `, before the header; readers that know no
//! comments get a bare table with `comments=false`, and the recipe is then lost.
//!
//! Without the crate csv: its fields are numbers, which need no quotes, and [`records`] formats them on all cores.

mod dialects;
mod mat;

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::knob::Value;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::skeleton::{Cylinder, Forks, RadiusFit};
use linden_pipeline::stage::{Place, Stage};

pub(crate) use self::mat::Mat;

use self::dialects::{Dialect, Sheet, Taken, WORDS};
use crate::options::{OptionSpec, Options};
use crate::writing::records::{self, Text};
use crate::writing::trees::NumberedTree;
use crate::writing::{fit, mean_digits, memory, trees, validate};
use crate::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Readable, Traces, recipe};

/// A table of cylinders.
pub(crate) struct Qsm;

static FORMAT: Format = Format {
    id: "qsm",
    name: "Cylinder table (QSM)",
    extensions: &["csv"],
    media_type: "text/csv",
    self_contained: true,
    help: "one cylinder per segment for measuring: start, axis, length, radius, parent, branch, order",
    options: &[
        OptionSpec::switch(
            "comments",
            true,
            "lines with # before the header: recipe and units; off for readers that know no comments",
        ),
        OptionSpec::choice(
            "dialect",
            WORDS,
            "whose columns: ours (Y up), or those of another program (Z up)",
        ),
    ],
    holds: Holds::SKELETON,
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(|amounts, options| {
        let comments = if options.is_on("comments") { amounts.recipe_bytes + 150 } else { 0 };
        // Flat trees have fewer digits than round ones.
        let dialect = match options.value("dialect") {
            Some(Value::Word(word)) => Dialect::of(word),
            _ => None,
        };
        let (fixed, digits) = match dialect {
            None => (95.0, 6.0),
            Some(Dialect::SimpleForest) => (200.0, 8.0),
            Some(Dialect::TreeQsm) => (95.0, 5.0),
            Some(Dialect::Raycloudtools) => (40.0, 1.0),
            Some(Dialect::Archi) => (105.0, 7.0),
        };
        let row = fixed + digits * mean_digits(amounts.nodes);
        (row * amounts.nodes as f64) as u64 + comments + 150
    }),
};

const HEADER: &str = "id,parent,branch,branch_order,position_in_branch,start_x_m,start_y_m,start_z_m,\
                      axis_x,axis_y,axis_z,length_m,radius_m,birth,node,parent_node,start_radius_m,end_radius_m,tree";

/// And where a tree was measured on points.
const FIT_HEADER: &str = ",inliers,mad_m,arc_deg,se_m,source";

impl Exporter for Qsm {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_comments(file)
    }

    /// The header is the first line that is no comment.
    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        let traces = Traces::none(&FORMAT);
        for line in recipe::lines(file) {
            let line = line?;
            if !line.starts_with(b"#") {
                return Ok(
                    match WORDS.iter().find(|word| Dialect::of(word).is_some_and(|it| it.heads(&line))) {
                        Some(word) => traces.with("dialect", word),
                        None => traces,
                    },
                );
            }
        }
        Ok(traces)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &FORMAT, bundle);
        let plants = validate::trees(stage, monitor)?;
        let dialect = match options.value("dialect") {
            Some(Value::Word(word)) => Dialect::of(word),
            _ => None,
        };
        let more = plants.iter().map(|(_, scene)| {
            let nodes = scene.skeleton.positions.len();
            // Rows are longer than most records.
            let text = records::bytes(nodes) * 3 / 2 + dialect.map_or(0, |_| Sheet::bytes(nodes));
            Forks::bytes_for(&scene.skeleton) + bytes_of::<(Cylinder, Option<u32>)>(nodes) + text
        });
        memory::admit(stage, &[], trees::bytes(&plants) + more.max().unwrap_or(0), monitor)?;
        let all = trees::numbered(&plants);
        if let Some(dialect) = dialect {
            return write_dialect(dialect, stage, all, options, bundle, monitor);
        }
        let mut head = String::new();
        if options.is_on("comments") {
            let (name, recipe) = recipe::of_stage(stage);
            head = recipe::comments(name, recipe, "metres, up axis: Y; parent 0: none")
                + &recipe::foot_comment(stage, "#");
        }
        head += HEADER;
        let is_measured = plants.iter().any(|(_, scene)| !scene.skeleton.fits.is_empty());
        if is_measured {
            head += FIT_HEADER;
        }
        head += "\n";
        bundle.write_main(None, monitor, |out| {
            out.write(head.as_bytes())?;
            for tree in all {
                let (skeleton, place) = (&tree.skeleton, tree.place);
                let cylinders = skeleton.cylinders();
                records::write(out, cylinders.len(), |text, range| {
                    for index in range {
                        let cylinder = placed(cylinders[index], place);
                        let order = skeleton.axes[cylinder.axis as usize].order;
                        row(text, index as u32, &cylinder, order, skeleton.births[cylinder.node as usize]);
                        text.byte(b',');
                        text.integer(tree.number);
                        if is_measured {
                            fit_columns(text, skeleton.fits.get(cylinder.node as usize), place.scale);
                        }
                        text.byte(b'\n');
                    }
                })?;
            }
            Ok(())
        })
    }
}

/// All trees as another program has them.
fn write_dialect<'t>(
    dialect: Dialect,
    stage: &Stage<'_>,
    all: impl Iterator<Item = NumberedTree<'t>>,
    options: &Options,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let mut head = String::new();
    if options.is_on("comments") {
        let (name, recipe) = recipe::of_stage(stage);
        head = recipe::comments(name, recipe, "metres, up axis: Z") + &recipe::foot_comment(stage, "#");
    }
    head += dialect.header();
    bundle.write_main(None, monitor, |out| {
        out.write(head.as_bytes())?;
        let mut taken = Taken::default();
        for NumberedTree { number, place, skeleton, .. } in all {
            let sheet = Sheet::new(&skeleton, place);
            if dialect == Dialect::Raycloudtools {
                let mut text = Text::default();
                sheet.lines(&skeleton, place, &mut text);
                out.write(text.written())?;
                continue;
            }
            records::write(out, sheet.len(), |text, range| {
                for index in range {
                    sheet.row(dialect, text, index, taken, number);
                }
            })?;
            taken = sheet.after(taken);
        }
        Ok(())
    })
}

/// What bears out the radius of the cylinder's upper end; empty fields where it was never measured.
fn fit_columns(text: &mut Text, fit: Option<&RadiusFit>, scale: f32) {
    let Some(fit) = fit else { return text.bytes(b",,,,,") };
    text.byte(b',');
    text.integer(fit.inliers);
    text.byte(b',');
    text.floats([fit.mad_m * scale, fit.arc_deg() as f32, fit.se_m * scale], b",");
    text.byte(b',');
    text.slice(fit.source.word().as_bytes());
}

/// A cylinder where its tree stands.
fn placed(cylinder: Cylinder, place: &Place) -> Cylinder {
    let Some(motion) = place.motion() else { return cylinder };
    Cylinder {
        start: motion.point(cylinder.start),
        direction: motion.direction(cylinder.direction),
        length_m: cylinder.length_m * place.scale,
        radius_m: cylinder.radius_m * place.scale,
        end_radii_m: cylinder.end_radii_m.map(|radius_m| radius_m * place.scale),
        ..cylinder
    }
}

/// All columns but the last.
fn row(text: &mut Text, index: u32, cylinder: &Cylinder, order: u32, birth: u32) {
    let parent = cylinder.parent.map_or(0, |parent| parent + 1);
    for n in [index + 1, parent, cylinder.axis + 1, order, cylinder.place + 1] {
        text.integer(n);
        text.byte(b',');
    }
    let ([x, y, z], [dx, dy, dz]) = (cylinder.start.to_array(), cylinder.direction.to_array());
    text.floats([x, y, z, dx, dy, dz, cylinder.length_m, cylinder.radius_m], b",");
    text.byte(b',');
    for n in [birth, cylinder.node, cylinder.parent_node] {
        text.integer(n);
        text.byte(b',');
    }
    text.floats(cylinder.end_radii_m, b",");
}
