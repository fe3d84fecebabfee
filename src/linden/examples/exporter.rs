//! A format of your own: the axes of a tree as lines of comma-separated values.
//! `cargo run --example exporter -- fir.axes`

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use std::env;
use std::io;

use linden::Monitor;
use linden::export::{
    Bundle, Encoding, ExportError, Exporter, Format, Holds, Options, Readable, Registry, writing::fit,
};
use linden::stage::Stage;

struct Axes;

/// All that help, forms and forecasts say of it.
static FORMAT: Format = Format {
    id: "axes",
    name: "Axes",
    extensions: &["axes"],
    media_type: "text/csv",
    self_contained: true,
    help: "nodes of the axial tree, a line each, for spreadsheets",
    options: &[],
    holds: Holds::SKELETON,
    levels_by: None,
    encoding: |_| Encoding::Text,
    estimate: Some(|amounts, _| 40 * amounts.nodes),
};

impl Exporter for Axes {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn recipe(&self, _: &mut dyn Readable) -> io::Result<Option<String>> {
        Ok(None)
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        _: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        // Notes what was asked for and cannot be held.
        let stage = fit(stage, &FORMAT, bundle);
        bundle.write_main(None, monitor, |out| {
            out.write(b"axis,order,x,y,z,radius\n")?;
            for (_, scene) in stage.finest() {
                let skeleton = &scene.skeleton;
                for (number, axis) in skeleton.axes.iter().enumerate() {
                    for &node in skeleton.nodes_of(axis) {
                        let (place, radius) =
                            (skeleton.positions[node as usize], skeleton.radii[node as usize]);
                        let [x, y, z] = place.to_array();
                        out.write(format!("{number},{},{x},{y},{z},{radius}\n", axis.order).as_bytes())?;
                    }
                }
            }
            Ok(())
        })
    }
}

fn main() -> Result<(), linden::Error> {
    let file = env::args().nth(1).unwrap_or_else(|| "fir.axes".to_owned());
    let registry = Registry::new().with(&Axes);
    let exporter = registry.for_path(file.as_ref())?;
    let fir = linden::tree("fir")?.set("points", "500")?.grow()?;
    let written = fir.export_as(exporter, Options::new(exporter.format()), &file)?;
    println!("{} bytes", written.files[0].bytes);
    Ok(())
}
