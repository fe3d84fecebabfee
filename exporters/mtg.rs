//! A multiscale tree graph as text: what `OpenAlea` and `AMAPmod` read (Godin & Caraglio 1998, "A multiscale model of plant
//! topological structures").
//!
//! Three scales: plants `P`, one a tree ([`trees`]), their axes `A`, the internodes `I` of these, joined by `/` (is made of), `<` (succeeds) and `+`
//! (branches). Organs stand at the scale of internodes, each joined by `+` to the one that bears it: leaves and needles
//! `L`, blossom `B`, fruit `F`. An internode's place is its upper end, an organ's where it is attached, a plant's its foot;
//! what leaves the very foot of a stem is an axis of the plant that nothing bears, as a second stem is, and organs at a
//! foot are borne by the first internode above. An organ's length is the size of its shape, its `organ` the id that a
//! table of organs has it under. Z is up, as those programs have it.
//!
//! The recipe is the comment that starts with `# recipe: `.

use std::collections::BTreeSet;
use std::io;

use glam::Vec3;
use linden_pipeline::Monitor;
use linden_pipeline::foliage::OrganClass;
use linden_pipeline::memory::bytes_of;
use linden_pipeline::scene::Scene;
use linden_pipeline::skeleton::{Axis, NO_PARENT, Skeleton};
use linden_pipeline::stage::Stage;

use crate::options::{OptionSpec, Options};
use crate::writing::records::{self, Text};
use crate::writing::trees::{self, NumberedTree};
use crate::writing::{fit, memory, validate};
use crate::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Readable, Traces, recipe};

/// A multiscale tree graph.
pub(crate) struct Mtg;

static FORMAT: Format = Format {
    id: "mtg",
    name: "Multiscale tree graph",
    extensions: &["mtg"],
    media_type: "text/plain",
    self_contained: true,
    help: "plant, axes, internodes and organs with / < + between them, for OpenAlea and other plant models; Z up",
    options: &[OptionSpec::switch(
        "organs",
        true,
        "leaves, blossom and fruit too, on the internodes that bear them",
    )],
    holds: Holds::ORGANS,
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(|amounts, options| {
        let organs = if options.is_on("organs") { 165 * amounts.organs } else { 0 };
        75 * amounts.nodes + organs + amounts.recipe_bytes + 800
    }),
};

static WOOD: Format = Format { holds: Holds::SKELETON, ..FORMAT };

/// A lateral stands a column to the right of what bears it, so that lines grow with the order.
const MOST_ORDERS: u32 = 250;

const HEAD: &str = "CODE:\tFORM-A\n\n\
CLASSES:\n\
SYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n\
$\t0\tFREE\tFREE\tIMPLICIT\n\
P\t1\tFREE\tFREE\tEXPLICIT\n\
A\t2\tFREE\tFREE\tEXPLICIT\n\
I\t3\tFREE\tFREE\tEXPLICIT\n\
L\t3\tFREE\tFREE\tEXPLICIT\n\
B\t3\tFREE\tFREE\tEXPLICIT\n\
F\t3\tFREE\tFREE\tEXPLICIT\n\n\
DESCRIPTION:\n\
LEFT\tRIGHT\tRELTYPE\tMAX\n\
A\tA\t+\t?\n\
I\tI\t<\t1\n\
I\tI,L,B,F\t+\t?\n\n\
FEATURES:\n\
NAME\tTYPE\n\
XX\tREAL\n\
YY\tREAL\n\
ZZ\tREAL\n\
radius\tREAL\n\
length\tREAL\n\
order\tINT\n\
birth\tINT\n\
node\tINT\n\
area\tREAL\n\
kind\tSTRING\n\
organ\tINT\n\
dx\tREAL\n\
dy\tREAL\n\
dz\tREAL\n\
nx\tREAL\n\
ny\tREAL\n\
nz\tREAL\n\
red\tINT\n\
green\tINT\n\
blue\tINT\n\n\
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
    /// An organ and its number on its internode, from 1.
    Organ(u32, u32),
}

impl Exporter for Mtg {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_comments(file)
    }

    fn traces(&self, _file: &mut dyn Readable) -> io::Result<Traces> {
        Ok(Traces::none(&FORMAT).with_either("organs"))
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let with_organs = options.is_on("organs");
        let stage = &fit(stage, if with_organs { &FORMAT } else { &WOOD }, bundle);
        let plants = validate::trees(stage, monitor)?;
        let axes = plants.iter().flat_map(|(_, scene)| &scene.skeleton.axes);
        let most = axes.map(|axis| axis.order).max().unwrap_or(0);
        if most > MOST_ORDERS {
            let amount = format!("axes of order {most}");
            let advice = "take another format, like qsm";
            return Err(ExportError::TooLarge { format: FORMAT.id, amount, limit: "order 250", advice });
        }
        let organs = |scene: &Scene| if with_organs { scene.organs.len() } else { 0 };
        let bytes = plants.iter().map(|(_, scene)| {
            let (nodes, axes) = (scene.skeleton.positions.len(), scene.skeleton.axes.len());
            let rows = nodes + axes + 1 + organs(scene);
            bytes_of::<(Row, u32)>(rows)
                + bytes_of::<[u32; 5]>(axes)
                + bytes_of::<[u32; 3]>(organs(scene))
                + records::bytes(rows)
        });
        let bytes = trees::bytes(&plants) + bytes.max().unwrap_or(0);
        memory::admit(stage, &[], bytes + u64::from(most) * 8192, monitor)?;
        // Of plants, axes, and what they bear.
        let columns = most as usize + 2 + usize::from(plants.iter().any(|(_, scene)| organs(scene) > 0));
        let (name, recipe) = recipe::of_stage(stage);
        let head = format!(
            "{}{}{HEAD}{}XX\tYY\tZZ\tradius\tlength\torder\tbirth\tnode\tarea\tkind\torgan\tdx\tdy\tdz\tnx\tny\tnz\tred\tgreen\tblue\n",
            recipe::comments(name, recipe, "metres; up axis: Z"),
            recipe::foot_comment(stage, "#"),
            "\t".repeat(columns)
        );
        if !with_organs && plants.iter().all(|(_, scene)| scene.organs.is_empty()) {
            bundle.note("mtg: organs=false changes nothing where nothing grows on the wood");
        }
        let mut left_out = 0;
        bundle.write_main(None, monitor, |out| {
            out.write(head.as_bytes())?;
            for tree in trees::numbered(&plants) {
                let nodes = if with_organs { tree.organ_nodes() } else { Vec::new() };
                let mut borne: Vec<(u32, u32)> = nodes.into_iter().zip(0..).collect();
                borne.sort_unstable();
                let rows = rows(&tree.skeleton, &borne);
                left_out +=
                    borne.len() - rows.iter().filter(|(row, _)| matches!(row, Row::Organ(..))).count();
                drop(borne);
                let plant = Plant { tree: &tree, columns };
                records::write(out, rows.len(), |text, range| {
                    for &(row, depth) in &rows[range] {
                        plant.write(text, row, depth);
                    }
                })?;
            }
            Ok(())
        })?;
        if left_out > 0 {
            bundle.note(format!(
                "mtg: no internode bears {left_out} of the organs; the table of organs has them"
            ));
        }
        Ok(())
    }
}

/// The graph's lines with how many axes bear theirs, depth first: an internode, its organs, its laterals, the next one.
/// `organs` are in the order of the nodes that they hang on.
fn rows(skeleton: &Skeleton, organs: &[(u32, u32)]) -> Vec<(Row, u32)> {
    // Laterals by the node that bears them, in order.
    let mut laterals: Vec<(u32, u32)> =
        (0..).zip(&skeleton.axes).map(|(index, axis)| (axis.parent, index)).collect();
    laterals.sort_unstable();
    let is_foot = |node: u32| node == NO_PARENT || skeleton.parents[node as usize] == NO_PARENT;
    let mut rows = Vec::with_capacity(skeleton.positions.len() + skeleton.axes.len() + 1 + organs.len());
    rows.push((Row::Plant, 0));
    let mut feet = BTreeSet::new();
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
            let foot = skeleton.parents[node as usize];
            let at_foot = (is_foot(foot) && feet.insert(foot)).then_some(foot);
            let hanging = at_foot.into_iter().chain([node]).flat_map(|bearer| on_node(organs, bearer));
            rows.extend((1..).zip(hanging).map(|(number, organ)| (Row::Organ(organ, number), depth + 1)));
            open.push((index, done + 1, depth));
            let first = open.len();
            open.extend(on_node(&laterals, node).map(|lateral| (lateral, 0, depth + 1)));
            open[first..].reverse();
        }
    }
    rows
}

/// What hangs on a node, out of a list in the order of nodes.
fn on_node(list: &[(u32, u32)], node: u32) -> impl Iterator<Item = u32> {
    let from = list.partition_point(|&(bearer, _)| bearer < node);
    list[from..].iter().take_while(move |&&(bearer, _)| bearer == node).map(|&(_, borne)| borne)
}

/// The nodes that end an axis' internodes: the foot of a stem ends none.
fn internodes<'a>(skeleton: &'a Skeleton, axis: &Axis) -> &'a [u32] {
    &skeleton.nodes_of(axis)[usize::from(axis.parent == NO_PARENT)..]
}

/// A tree where it stands.
struct Plant<'t, 'a> {
    tree: &'t NumberedTree<'a>,
    /// Before the first feature.
    columns: usize,
}

impl Plant<'_, '_> {
    fn write(&self, text: &mut Text, row: Row, depth: u32) {
        let NumberedTree { number: plant, skeleton, place, .. } = self.tree;
        let column = depth as usize + 1;
        match row {
            Row::Plant => {
                text.bytes(b"/P");
                text.integer(*plant);
                let foot = skeleton.axes.first().map_or(0, |axis| skeleton.nodes_of(axis)[0]);
                self.place(text, 0, skeleton.positions[foot as usize]);
            }
            Row::Axis(index) => {
                tabs(text, column);
                text.bytes(if depth > 0 { b"+A" } else { b"/A" });
                text.integer(index + 1);
            }
            Row::Internode(index, number) => {
                let axis = &skeleton.axes[index as usize];
                let node = internodes(skeleton, axis)[number as usize - 1];
                tabs(text, column);
                text.bytes(if number == 1 { b"^/I" } else { b"^<I" });
                text.integer(number);
                let position = skeleton.positions[node as usize];
                self.place(text, column, position);
                text.byte(b'\t');
                let parent = skeleton.positions[skeleton.parents[node as usize] as usize];
                let sizes_m = [skeleton.radii[node as usize], position.distance(parent)];
                text.floats(sizes_m.map(|size_m| size_m * place.scale), b"\t");
                for number in [axis.order, skeleton.births[node as usize], node] {
                    text.byte(b'\t');
                    text.integer(number);
                }
            }
            Row::Organ(index, number) => {
                self.tree.each_organ(index as usize..index as usize + 1, |_, organ| {
                    tabs(text, column);
                    text.bytes(match organ.class {
                        OrganClass::Leaf => b"+L",
                        OrganClass::Blossom => b"+B",
                        OrganClass::Fruit => b"+F",
                    });
                    text.integer(number);
                    self.place(text, column, organ.placement.position);
                    // Neither radius nor order.
                    text.bytes(b"\t\t");
                    text.float(organ.placement.scale * place.scale);
                    text.bytes(b"\t\t");
                    text.integer(organ.birth);
                    text.byte(b'\t');
                    text.integer(organ.node);
                    text.byte(b'\t');
                    text.float((organ.area_m2 * f64::from(place.scale) * f64::from(place.scale)) as f32);
                    text.byte(b'\t');
                    text.slice(organ.kind.as_bytes());
                    text.byte(b'\t');
                    text.integer(index);
                    text.byte(b'\t');
                    let turn = place.rotation() * organ.placement.rotation;
                    let [direction, face] = [turn * Vec3::Y, turn * Vec3::Z].map(z_up);
                    text.floats(direction, b"\t");
                    text.byte(b'\t');
                    text.floats(face, b"\t");
                    for channel in organ.color {
                        text.byte(b'\t');
                        text.integer(channel.into());
                    }
                });
            }
        }
        text.byte(b'\n');
    }

    /// The features of a place, after an entity in a column.
    fn place(&self, text: &mut Text, column: usize, position: Vec3) {
        tabs(text, self.columns - column);
        let moved = self.tree.place.motion().map_or(position, |motion| motion.point(position));
        text.floats(z_up(moved), b"\t");
    }
}

/// Turned about X, so that Y up becomes Z up; no zero has a sign.
fn z_up(at: Vec3) -> [f32; 3] {
    [at.x, 0.0 - at.z, at.y]
}

fn tabs(text: &mut Text, count: usize) {
    (0..count).for_each(|_| text.byte(b'\t'));
}
