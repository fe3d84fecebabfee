//! A plant at several ages is one USD file over those of the ages.

use linden::Quiet;
use linden::dress::levels;
use linden::grow::grow;
use linden::preset::builtin;
use linden::recipe::Recipe;
use linden_exporters::{Batch, Bundle, Options, Output, find};

use crate::outside::{exported, run};

#[test]
fn ages_are_variants() {
    let dir = exported("clients-ages");
    let mut preset = builtin("ash").unwrap().load().unwrap();
    let pictures = [("bark_size", "64"), ("leaf_size", "64"), ("card_size", "128")];
    for (knob, to) in pictures.into_iter().chain([("triangles", "4000"), ("lods", "2")]) {
        preset.set(knob, to).unwrap();
    }
    let ages = preset.ages_of("young=0.3,grown=0.6").unwrap();
    let names: Vec<&str> = ages.iter().map(|age| age.name.as_str()).collect();
    let outputs = ["usda", "usdc", "glb"].iter().flat_map(|format| {
        let exporter = find(format).unwrap();
        let options = Options::new(exporter.format());
        Output::new(exporter, options, dir.join(format!("ash.{format}"))).in_ages(&names).unwrap()
    });
    let outputs: Vec<Output> = outputs.collect();
    // A file for each age, and one over them where the format can name others.
    assert_eq!(outputs.len(), 3 * 2 + 2);
    let mut batch = Batch::open(outputs, Vec::new(), |output| Bundle::create(&output.path)).unwrap();
    for age in &ages {
        let recipe = Recipe::new(preset.at_age(age).unwrap());
        let grown = grow(&recipe, &Quiet).unwrap();
        let shapes = levels(&recipe, &grown, &Quiet).unwrap();
        batch.write_age(Some(&age.name), &shapes.stage(), &Quiet, |_| {}).unwrap();
    }
    batch.gather(&Quiet).unwrap();
    let written = batch.commit().unwrap();
    assert!(written.iter().any(|file| file.path.ends_with("ash.usda")));
    assert!(!dir.join("ash.glb").exists() && dir.join("ash_young.glb").exists());
    run("ages.py", &dir);
}
