//! Growth against what the crown and the scan say.

use super::*;
use crate::preset::builtin;
use glam::Vec3;
use linden_base::mesh::Bounds;
use linden_base::monitor::Quiet;
use linden_colonization::ColonizationError;

fn recipe(id: &str, settings: &[(&str, &str)]) -> Recipe {
    let row = builtin(id).unwrap();
    let mut preset = row.load().unwrap_or_else(|fault| panic!("{id}: {fault}"));
    for (knob, value) in settings {
        preset.set(knob, value).unwrap();
    }
    Recipe::with_files(preset, row.recipe(&Quiet).unwrap().inputs)
}

#[test]
fn the_outline_stands_where_the_points_are() {
    let cases: [(&str, &[(&str, &str)]); 7] = [
        ("fir", &[]),
        ("cypress", &[("crown_base", "3")]),
        ("sphere", &[("root", "5,2,-3")]),
        ("sphere", &[("root", "5,2,-3"), ("origin", "root")]),
        ("heart", &[]),
        ("heart", &[("origin", "root")]),
        ("simple", &[("origin", "keep")]),
    ];
    for (id, settings) in cases {
        let recipe = recipe(id, settings);
        let points = grow(&recipe, &Quiet).unwrap().colonized.unwrap().points;
        let lines = outline(&recipe, &Quiet).unwrap();
        let bounds = |places: &mut dyn Iterator<Item = Vec3>| Bounds::of(places).unwrap();
        let (inner, outer) = (bounds(&mut points.into_iter()), bounds(&mut lines.into_iter().flatten()));
        // Many points in a solid come near its box on all sides; cuts through a mesh miss its ends
        // by at most an eighth.
        let slack = outer.size().max_element() * 0.15;
        for (a, b) in [(inner.min, outer.min), (inner.max, outer.max)] {
            assert!((a - b).abs().max_element() < slack, "{id} {settings:?}: {a} {b}");
        }
    }
}

/// Whether a place is inside of triangles: a ray crosses them an odd number of times.
fn is_inside(solid: &Obstruction, place: Vec3) -> bool {
    let way = Vec3::new(0.83, 0.41, 0.377);
    let crosses = |triangle: &u32| {
        let [a, b, c] = solid.corners(*triangle);
        let (ab, ac) = (b - a, c - a);
        let across = way.cross(ac);
        let (det, from) = (ab.dot(across), place - a);
        let u = from.dot(across) / det;
        let v = way.dot(from.cross(ab)) / det;
        let t = ac.dot(from.cross(ab)) / det;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0
    };
    (0..solid.triangles.len() as u32).filter(crosses).count() % 2 == 1
}

#[test]
fn obstructions_stand_where_growth_meets_them() {
    let cases: [(&str, &[(&str, &str)]); 4] = [
        ("around-the-stone", &[("points", "1500")]),
        ("around-the-stone", &[("points", "1500"), ("root", "5,2,-3")]),
        ("street-lamp", &[("points", "1500")]),
        ("street-lamp", &[("points", "1500"), ("root", "5,2,-3"), ("origin", "root")]),
    ];
    for (id, settings) in cases {
        let recipe = recipe(id, settings);
        let grown = grow(&recipe, &Quiet).unwrap();
        let all = obstructions(&recipe, &Quiet).unwrap();
        assert_eq!(all.len(), 1, "{id}");
        let solid = &all[0];
        let wanted = if id == "street-lamp" { Obstructs::Light } else { Obstructs::Branches };
        assert_eq!(solid.effect, wanted);
        // No point is in either; nor is wood in the stone, which it comes near.
        let points = grown.colonized.unwrap().points;
        let wood = if wanted == Obstructs::Branches { &grown.skeleton.positions[..] } else { &[] };
        let entered = points.iter().chain(wood).filter(|place| is_inside(solid, **place)).count();
        assert!(entered <= points.len() / 500, "{id} {settings:?}: {entered} places are inside");
        let bounds = Bounds::of(solid.positions.iter().copied()).unwrap();
        let near = points.iter().filter(|p| p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()).count();
        assert!(near > 10, "{id} {settings:?}: {near} points are around it");
    }
    assert_eq!(obstructions(&recipe("fir", &[]), &Quiet).unwrap(), []);
}

#[test]
fn a_wall_is_shown_where_a_tree_that_grows_by_light_keeps_out_of_it() {
    let text = "id = \"walled\"\n[self-organizing]\nyears = 24\nsag = 0.4\nlight = \"sky\"\nshade = 0.3\n\
                [[self-organizing.obstacle]]\nbox = [0.3, 6, 9]\nat = [0.9, 0, 0]\nturn = 20\n";
    for refine in ["refine = []", "refine = [\"relocate\", \"smooth\", \"subdivide\"]\ngnarl = 1"] {
        let preset = Preset::from_toml(&format!("{text}[wood]\n{refine}\n")).unwrap();
        let recipe = Recipe::new(preset);
        let grown = grow(&recipe, &Quiet).unwrap();
        let all = obstructions(&recipe, &Quiet).unwrap();
        let [wall] = all.as_slice() else { panic!("{} obstructions", all.len()) };
        assert_eq!(wall.effect, Obstructs::Branches);
        let entered = grown.skeleton.positions.iter().filter(|place| is_inside(wall, **place)).count();
        assert_eq!(entered, 0, "{refine}: of {} nodes", grown.skeleton.positions.len());
        let bounds = Bounds::of(wall.positions.iter().copied()).unwrap();
        let lines = Bounds::of(outline(&recipe, &Quiet).unwrap().into_iter().flatten()).unwrap();
        assert!((lines.min - bounds.min).length() < 1e-4 && (lines.max - bounds.max).length() < 1e-4);
        assert!(grown.skeleton.positions.len() > 1000);
    }
}

/// A wire of 3 m with a fork: far thinner than its points are exact.
#[test]
fn a_scan_without_a_circle_says_that_all_is_guessed() {
    let key = linden_base::random::Key::new(4);
    let mut rows = String::new();
    for i in 0..3000_u64 {
        let along = i as f64 * 1e-3;
        let out = (along - 2.0).max(0.0) * if i % 2 == 0 { 0.5 } else { -0.5 };
        let [x, y] = ["x", "y"].map(|name| 2e-3 * key.named(name).child(i).normal());
        rows.push_str(&format!("{} {y} {along}\n", x + out));
    }
    let grown = |radius: &str| {
        let mut preset = Preset::of_points("wire", "wire.xyz");
        preset.set("scan_radius", radius).unwrap();
        let mut recipe = Recipe::new(preset);
        let input = crate::recipe::Input::read("wire.xyz", rows.as_bytes(), &Quiet).unwrap();
        recipe.inputs.insert("wire.xyz", input);
        let grown = grow(&recipe, &Quiet).unwrap();
        let report = crate::report::Report::of(&recipe, &grown, &Quiet).unwrap();
        let is_noted = grown.notes.iter().any(|note| note.contains("no circle was believed on the trunk"));
        (report.dbh_m.is_some(), report.dbh_source, report.measured_volume_share, is_noted)
    };
    let guessed = |is_noted| (true, Some("guessed".to_owned()), Some(0.0), is_noted);
    assert_eq!(grown("points"), guessed(true));
    // None was looked for.
    assert_eq!(grown("pipe"), guessed(false));
}

#[test]
fn what_has_no_crown_has_no_outline() {
    assert_eq!(outline(&recipe("abop-c", &[]), &Quiet).unwrap(), Vec::<Vec<Vec3>>::new());
    let missing = Recipe::new(recipe("heart", &[]).preset);
    let error = outline(&missing, &Quiet).unwrap_err();
    assert!(matches!(error.generator(), Some(ColonizationError::WrongInput { .. })));
}
