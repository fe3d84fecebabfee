//! `~`: organs of the table.

use linden::foliage::{Look, PROTOTYPES, meshes};
use linden::lsystem::{Grammar, TurtleSettings, grow};
use linden::{Quiet, Vec3};

use crate::drawn_with;

#[test]
fn an_organ_stands_in_the_turtles_frame() {
    let organs = drawn_with("F+''~LF", |s| (s.angle_deg, s.segment_m) = (90.0, 0.5)).organs;
    let placed = &organs.placed;
    assert_eq!(placed.prototypes.len(), 1);
    assert_eq!(PROTOTYPES[placed.prototypes[0] as usize].letter, 'L');
    assert!(placed.positions[0].distance(Vec3::new(0.0, 0.5, 0.0)) < 1e-6);
    assert!(placed.headings[0].distance(Vec3::NEG_X) < 1e-6);
    assert!(placed.ups[0].distance(Vec3::Z) < 1e-6);
    assert_eq!(placed.sizes_m, [0.5]);
    assert_eq!((placed.growth.nodes[0], placed.growth.colors[0]), (1, 2));
}

#[test]
fn a_leaf_reaches_one_segment_along_the_heading() {
    for prototype in &PROTOTYPES {
        let axiom = format!("F/(30)&(50)~{}", prototype.letter);
        let organs = drawn_with(&axiom, |s| s.segment_m = 0.2).organs;
        let foliage = meshes(&organs, 1, &Quiet).unwrap();
        let heading = organs.placed.headings[0];
        let along = |p: &Vec3| (*p - Vec3::Y * 0.2).dot(heading) / 0.2;
        let (unit, mesh) = (prototype.mesh().bounds().unwrap(), &foliage[0].mesh);
        let reach = mesh.positions.iter().map(along).fold(f32::MIN, f32::max);
        assert!((reach - unit.max.y).abs() < 1e-5, "{}: {reach}", prototype.name);
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    }
}

#[test]
fn only_the_letter_behind_the_sign_is_an_organ() {
    let organs = drawn_with("FLBN~LL~BN", |_| ()).organs;
    let letter = |&i: &u8| PROTOTYPES[i as usize].letter;
    assert_eq!(organs.placed.prototypes.iter().map(letter).collect::<String>(), "LB");
}

#[test]
fn an_unknown_letter_is_named_with_the_table() {
    // What a rule may rewrite is looked at when it is drawn.
    let said = |axiom: &str| {
        let grammar = Grammar::new(axiom, &["X -> X", "A ->"]).unwrap();
        let settings = TurtleSettings { derivations: 1, ..TurtleSettings::default() };
        grow(&grammar, &settings, &Quiet).unwrap_err().to_string()
    };
    let error = said("F~X");
    assert!(error.contains("'X'") && error.contains("L (leaf)") && error.contains("K (blossom)"), "{error}");
    assert!(said("F~A").contains("nothing"));
    assert!(said("F[~A]L").contains("']'"));
}

#[test]
fn each_colour_is_a_mesh_and_the_last_repeats() {
    let organs = drawn_with("F~L'''~L'(1)~B{f+f+f}", |_| ()).organs;
    let foliage = meshes(&organs, 3, &Quiet).unwrap();
    assert_eq!(foliage.iter().map(|foliage| foliage.look).collect::<Vec<_>>(), [0, 1, 2].map(Look::Color));
    let triangles = |letter: char| {
        PROTOTYPES.iter().find(|prototype| prototype.letter == letter).unwrap().mesh().triangles.len()
    };
    let counts: Vec<usize> = foliage.iter().map(|foliage| foliage.mesh.triangles.len()).collect();
    assert_eq!(counts, [triangles('L'), triangles('B') + 2, triangles('L')]);
    assert_eq!(meshes(&organs, 1, &Quiet).unwrap().len(), 1);
}

#[test]
fn any_number_of_threads_gives_the_same_foliage() {
    let grammar = Grammar::new("FA", &["A -> [+F~LA][-'F{f+f+f}A]/(137.5)FA"]).unwrap();
    let settings = TurtleSettings { derivations: 7, ..TurtleSettings::default() };
    let organs = grow(&grammar, &settings, &Quiet).unwrap().organs;
    assert!(organs.len() > 2000);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| meshes(&organs, 3, &Quiet).unwrap())
    };
    let all = on(1);
    assert_eq!(all, on(3));
    let (vertices, triangles) = organs.amount();
    assert_eq!(all.iter().map(|foliage| foliage.mesh.positions.len() as u64).sum::<u64>(), vertices);
    assert_eq!(all.iter().map(|foliage| foliage.mesh.triangles.len() as u64).sum::<u64>(), triangles);
}
