//! MATLAB's files of cylinders, read by scipy, are `TreeQSM`'s text.

use linden::stage::{Place, Plant, Stage};
use linden_tests::fixtures::export_stage;

use crate::instances::dressed;
use crate::outside::{exported, run};

#[test]
fn scipy_reads_models_of_cylinders() {
    let dir = exported("clients-mat");
    let both = |name: &str, stage: &Stage<'_>, options: &[(&str, &str)]| {
        export_stage(stage, "mat", options, &dir.join(format!("{name}.mat"))).unwrap();
        let text = [("dialect", "treeqsm"), ("comments", "false")];
        export_stage(stage, "qsm", &text, &dir.join(format!("{name}.txt"))).unwrap();
    };
    let scene = dressed(&[]).2;
    let one = Stage::of(&scene);
    both("one", &one, &[]);
    both("bare", &one, &[("recipe", "false")]);
    let other = dressed(&[("seed", "4")]).2;
    let mut wood = one.clone();
    wood.plants.push(Plant::of(&other));
    wood.places.push(Place { turn_rad: 1.0, scale: 1.5, ..Place::origin(1) });
    wood.places.push(Place::origin(0));
    both("wood", &wood, &[]);
    run("mat.py", &dir);
}
