//! Two kinds of trees side by side in one file: `cargo run --example forest -- wood.glb`

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use std::env;

use linden::export::{Bundle, Options, for_path};
use linden::forest::Forest;
use linden::grow::grow;
use linden::stage::{Level, Plant, Stage};
use linden::{Quiet, dress::levels};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = env::args().nth(1).unwrap_or_else(|| "wood.glb".to_owned());
    let kinds = ["fir", "simple"].map(linden::tree).into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut forest = Forest::of(kinds.iter().map(|kind| kind.recipe().clone()).collect());
    for (knob, value) in [("trees", "12"), ("spacing", "5")] {
        forest.layout.set(knob, value)?;
    }
    // Few trees are grown, and stand in many places.
    let plan = forest.plan(&Quiet)?;
    let grown = plan
        .trees
        .iter()
        .map(|tree| Ok(levels(&tree.recipe, &grow(&tree.recipe, &Quiet)?, &Quiet)?))
        .collect::<Result<Vec<_>, Box<dyn std::error::Error>>>()?;
    let plants = plan.trees.iter().zip(&grown).map(|(tree, levels)| {
        let levels =
            levels.levels.iter().map(|level| Level { scene: &level.scene, coverage: level.coverage });
        Plant::in_levels(tree.name.clone(), levels.collect())
    });
    let stage = Stage {
        name: "wood".to_owned(),
        recipe: forest.to_line(),
        plants: plants.collect(),
        places: plan.places,
        setting: None,
        turned: Vec::new(),
    };
    let exporter = for_path(file.as_ref())?;
    let mut bundle = Bundle::create(file.as_ref())?;
    exporter.write(&stage, &Options::new(exporter.format()), &mut bundle, &Quiet)?;
    for written in bundle.commit()? {
        println!("{}  {} bytes", written.path.display(), written.bytes);
    }
    Ok(())
}
