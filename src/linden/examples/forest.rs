//! Two kinds of trees side by side in one file: `cargo run --example forest -- wood.glb`

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use std::env;

use linden::Quiet;
use linden::export::{Bundle, Options, for_path};
use linden::forest::{Forest, GrownForest};

fn main() -> Result<(), linden::Error> {
    let file = env::args().nth(1).unwrap_or_else(|| "wood.glb".to_owned());
    let kinds = ["fir", "simple"].map(linden::tree).into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut forest = Forest::of(kinds.iter().map(|kind| kind.recipe().clone()).collect());
    for (knob, value) in [("trees", "12"), ("spacing", "5"), ("triangles", "4000")] {
        forest.layout.set(knob, value)?;
    }
    // Few trees are grown, each within the budget of triangles, and stand in many places.
    let plan = forest.plan(&Quiet)?;
    let wood = GrownForest::grow(&forest, plan, &Quiet, &mut |tree| {
        for said in tree.said() {
            println!("{said}");
        }
    })?;
    for tree in &wood.trees {
        let parts = tree.levels.levels.iter().take(1).flat_map(|finest| &finest.scene.parts);
        let triangles: usize = parts.map(|part| part.mesh.triangles.len()).sum();
        println!("{}: {triangles} triangles", tree.name);
    }
    let exporter = for_path(file.as_ref())?;
    let mut bundle = Bundle::create(file.as_ref())?;
    exporter.write(&wood.stage(), &Options::new(exporter.format()), &mut bundle, &Quiet)?;
    for written in bundle.commit()? {
        println!("{}  {} bytes", written.path.display(), written.bytes);
    }
    Ok(())
}
