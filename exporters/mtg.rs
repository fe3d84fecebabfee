//! A multiscale tree graph as text: what `OpenAlea` and `AMAPmod` read (Godin & Caraglio 1998, "A multiscale model of plant
//! topological structures").
//!
//! Three scales: the plant `P`, its axes `A`, their internodes `I`, joined by `/` (is made of), `<` (succeeds) and `+`
//! (branches). An internode's place is its upper end, the plant's its foot; what leaves the very foot of a stem is an
//! axis of the plant that nothing bears, as a second stem is. Z is up, as those programs have it.
//!
//! The recipe is the comment that starts with `# recipe: `.

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::skeleton::{Axis, NO_PARENT, Skeleton};
use linden_pipeline::stage::Stage;

use crate::options::Options;
use crate::writing::records::{self, Text};
use crate::writing::{fit, memory, validate};
use crate::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Readable, recipe};

/// A multiscale tree graph.
pub(crate) struct Mtg;

static FORMAT: Format = Format {
    id: "mtg",
    name: "Multiscale tree graph",
    extensions: &["mtg"],
    media_type: "text/plain",
    self_contained: true,
    help: "plant, axes and internodes with / < + between them, for OpenAlea and other plant models; Z up",
    options: &[],
    holds: Holds::SKELETON,
    encoding: |_| Encoding::Text,
    estimate: Some(|amounts, _| 75 * amounts.nodes + amounts.recipe_bytes + 700),
};

/// A lateral stands a column to the right of what bears it, so that lines grow with the order.
const MOST_ORDERS: u32 = 250;

const HEAD: &str = "CODE:\tFORM-A\n\n\
CLASSES:\n\
SYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n\
$\t0\tFREE\tFREE\tIMPLICIT\n\
P\t1\tFREE\tFREE\tEXPLICIT\n\
A\t2\tFREE\tFREE\tEXPLICIT\n\
I\t3\tFREE\tFREE\tEXPLICIT\n\n\
DESCRIPTION:\n\
LEFT\tRIGHT\tRELTYPE\tMAX\n\
A\tA\t+\t?\n\
I\tI\t<\t1\n\
I\tI\t+\t?\n\n\
FEATURES:\n\
NAME\tTYPE\n\
XX\tREAL\n\
YY\tREAL\n\
ZZ\tREAL\n\
radius\tREAL\n\
length\tREAL\n\
order\tINT\n\
birth\tINT\n\
node\tINT\n\n\
MTG:\n\
ENTITY-CODE";

/// A line of the graph.
#[derive(Clone, Copy)]
enum Row {
    Plant,
    /// Begins, `+` where another axis bears it.
    Axis(u32),
    /// The internode of an axis with a number, from 1.
    Internode(u32, u32),
}

impl Exporter for Mtg {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_comments(file)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        _: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let stage = &fit(stage, &FORMAT, bundle);
        let scene = validate::single_tree(stage, FORMAT.id, monitor)?;
        let skeleton = &*scene.skeleton;
        let most = skeleton.axes.iter().map(|axis| axis.order).max().unwrap_or(0);
        if most > MOST_ORDERS {
            let amount = format!("axes of order {most}");
            let advice = "take another format, like qsm";
            return Err(ExportError::TooLarge { format: FORMAT.id, amount, limit: "order 250", advice });
        }
        let (nodes, axes) = (skeleton.positions.len(), skeleton.axes.len());
        let more = bytes_of::<(Row, u32)>(nodes + axes + 1)
            + bytes_of::<[u32; 5]>(axes)
            + records::bytes(nodes + axes)
            + u64::from(most) * 8192;
        memory::admit(stage, &[], more, monitor)?;
        let rows = rows(skeleton);
        let columns = most as usize + 2;
        let (name, recipe) = recipe::of_stage(stage);
        let head = format!(
            "{}{HEAD}{}XX\tYY\tZZ\tradius\tlength\torder\tbirth\tnode\n",
            recipe::comments(name, recipe, "metres; up axis: Z"),
            "\t".repeat(columns)
        );
        bundle.write_main(None, monitor, |out| {
            out.write(head.as_bytes())?;
            records::write(out, rows.len(), |text, range| {
                for &(row, depth) in &rows[range] {
                    write_row(text, skeleton, row, depth, columns);
                }
            })
        })
    }
}

/// The graph's lines with how many axes bear theirs, depth first: an internode, what it bears, the next one.
fn rows(skeleton: &Skeleton) -> Vec<(Row, u32)> {
    // Laterals by the node that bears them, in order.
    let mut laterals: Vec<(u32, u32)> =
        (0..).zip(&skeleton.axes).map(|(index, axis)| (axis.parent, index)).collect();
    laterals.sort_unstable();
    let is_foot = |node: u32| node == NO_PARENT || skeleton.parents[node as usize] == NO_PARENT;
    let borne_by = |node: u32| {
        let from = laterals.partition_point(|&(parent, _)| parent < node);
        laterals[from..].iter().take_while(move |&&(parent, _)| parent == node).map(|&(_, axis)| axis)
    };
    let mut rows = vec![(Row::Plant, 0)];
    // Axes that are being walked, with how many internodes are done, and how many axes bear each.
    let mut open: Vec<(u32, u32, u32)> = Vec::new();
    for (stem, axis) in (0..).zip(&skeleton.axes) {
        if !is_foot(axis.parent) {
            continue;
        }
        open.push((stem, 0, 0));
        while let Some((index, done, depth)) = open.pop() {
            let axis = &skeleton.axes[index as usize];
            let Some(&node) = internodes(skeleton, axis).get(done as usize) else { continue };
            if done == 0 {
                rows.push((Row::Axis(index), depth));
            }
            rows.push((Row::Internode(index, done + 1), depth));
            open.push((index, done + 1, depth));
            let first = open.len();
            open.extend(borne_by(node).map(|lateral| (lateral, 0, depth + 1)));
            open[first..].reverse();
        }
    }
    rows
}

/// The nodes that end an axis' internodes: the foot of a stem ends none.
fn internodes<'a>(skeleton: &'a Skeleton, axis: &Axis) -> &'a [u32] {
    &skeleton.nodes_of(axis)[usize::from(axis.parent == NO_PARENT)..]
}

fn write_row(text: &mut Text, skeleton: &Skeleton, row: Row, depth: u32, columns: usize) {
    let mut column = 0;
    let mut tab = |text: &mut Text, to: usize| {
        while column < to {
            text.byte(b'\t');
            column += 1;
        }
    };
    let at = |text: &mut Text, node: u32| {
        let [x, y, z] = skeleton.positions[node as usize].to_array();
        // Turned about X, so that Y up becomes Z up; no zero has a sign.
        text.floats([x, 0.0 - z, y], b"\t");
    };
    match row {
        Row::Plant => {
            text.bytes(b"/P1");
            tab(text, columns);
            let foot = skeleton.axes.first().map_or(0, |axis| skeleton.nodes_of(axis)[0]);
            at(text, foot);
        }
        Row::Axis(index) => {
            tab(text, 1 + depth as usize);
            text.bytes(if depth > 0 { b"+A" } else { b"/A" });
            text.integer(index + 1);
        }
        Row::Internode(index, number) => {
            let axis = &skeleton.axes[index as usize];
            let node = internodes(skeleton, axis)[number as usize - 1];
            tab(text, 1 + depth as usize);
            text.bytes(if number == 1 { b"^/I" } else { b"^<I" });
            text.integer(number);
            tab(text, columns);
            at(text, node);
            text.byte(b'\t');
            let parent = skeleton.positions[skeleton.parents[node as usize] as usize];
            let length_m = skeleton.positions[node as usize].distance(parent);
            text.floats([skeleton.radii[node as usize], length_m], b"\t");
            for number in [axis.order, skeleton.births[node as usize], node] {
                text.byte(b'\t');
                text.integer(number);
            }
        }
    }
    text.byte(b'\n');
}
