//! A table of organs (CSV), one row each: leaves, blossom and fruit of the preset at its season, and what a grammar
//! places itself.
//!
//! | column | is |
//! |---|---|
//! | `id` | counted from 0 in each tree |
//! | `node` | the node of the skeleton that it hangs on, as `qsm`, `mtg` and `ply-skeleton` number them |
//! | `kind` | of a kind of the preset its outline, or `mesh` or `picture` for the user's; of a grammar's `polygon`, or the shape's name |
//! | `variant` | which of the kind's shapes it has, from 1; 0 for a grammar's |
//! | `x_m`, `y_m`, `z_m` | where it is attached; of a polygon its first corner |
//! | `qx` .. `qw` | a unit quaternion that turns the shape to where it stands. The shape begins at the origin, points along +Y and shows its upper side to +Z |
//! | `size_m` | metres in one unit of the shape, which is about as long as the organ; 1 for a polygon, which has no shape |
//! | `area_m2` | one side of its triangles, as far as its picture leaves them opaque |
//! | `birth` | the step in which it appeared |
//! | `red`, `green`, `blue` | the mean colour of its shape, or that of the grammar: sRGB, 0 to 255. No `#`, which begins a comment |
//! | `tree` | counted from 1 ([`trees`]); other numbers begin again in each |
//!
//! The recipe is the one line that starts with `# recipe: `, before the header, as in a table of cylinders.

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::foliage::DressedOrgan;
use linden_pipeline::stage::{Place, Stage};

use crate::options::{OptionSpec, Options};
use crate::writing::records::{self, Text};
use crate::writing::{fit, mean_digits, memory, trees, validate};
use crate::{Bundle, Encoding, ExportError, Exporter, Format, Holds, Readable, recipe};

/// A table of organs.
pub(crate) struct Organs;

static FORMAT: Format = Format {
    id: "organs",
    name: "Organ table",
    extensions: &["organs.csv"],
    media_type: "text/csv",
    self_contained: true,
    help: "one row for each leaf, blossom and fruit: node, kind, place, turn, size, area, birth, colour",
    options: &[OptionSpec::switch(
        "comments",
        true,
        "lines with # before the header: recipe and units; off for readers that know no comments",
    )],
    holds: Holds::ORGANS,
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(|amounts, options| {
        let comments = if options.is_on("comments") { amounts.recipe_bytes + 150 } else { 0 };
        let row = 130.0 + mean_digits(amounts.organs) + mean_digits(amounts.nodes);
        (row * amounts.organs as f64) as u64 + comments + 120
    }),
};

const HEADER: &str =
    "id,node,kind,variant,x_m,y_m,z_m,qx,qy,qz,qw,size_m,area_m2,birth,red,green,blue,tree\n";

impl Exporter for Organs {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        recipe::in_comments(file)
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
        let most = plants.iter().map(|(_, scene)| scene.organs.len()).max().unwrap_or(0);
        if most == 0 {
            bundle.note("organs: nothing grows on the wood, so that the table is its header alone");
        }
        // Rows are twice as long as most records.
        memory::admit(stage, &[], trees::bytes(&plants) + 2 * records::bytes(most), monitor)?;
        let mut head = String::new();
        if options.is_on("comments") {
            let (name, recipe) = recipe::of_stage(stage);
            head = recipe::comments(name, recipe, "metres, up axis: Y") + &recipe::foot_comment(stage, "#");
        }
        head += HEADER;
        bundle.write_main(None, monitor, |out| {
            out.write(head.as_bytes())?;
            for tree in trees::numbered(&plants) {
                records::write(out, tree.organs(), |text, range| {
                    tree.each_organ(range, |id, organ| {
                        row(text, id as u32, organ, tree.place, tree.number);
                    });
                })?;
            }
            Ok(())
        })
    }
}

fn row(text: &mut Text, id: u32, organ: &DressedOrgan<'_>, place: &Place, tree: u32) {
    let DressedOrgan { kind, variant, node, placement, area_m2, birth, color: [red, green, blue], .. } =
        *organ;
    for n in [id, node] {
        text.integer(n);
        text.byte(b',');
    }
    text.slice(kind.as_bytes());
    text.byte(b',');
    text.integer(variant);
    text.byte(b',');
    let (position, turn) = match place.motion() {
        Some(motion) => {
            (motion.point(placement.position), (place.rotation() * placement.rotation).normalize())
        }
        None => (placement.position, placement.rotation),
    };
    text.floats(position.to_array(), b",");
    text.byte(b',');
    text.floats(turn.to_array(), b",");
    text.byte(b',');
    let area_m2 = (area_m2 * f64::from(place.scale) * f64::from(place.scale)) as f32;
    text.floats([placement.scale * place.scale, area_m2], b",");
    for n in [birth, red.into(), green.into(), blue.into(), tree] {
        text.byte(b',');
        text.integer(n);
    }
    text.byte(b'\n');
}
