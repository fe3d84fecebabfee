//! What is said of how a scan was read, and what is grown of it: columns, rows, axes, units and classes.

use std::fmt::Write as _;

use linden::grow::{Grown, grow};
use linden::input::{Geometry, Input, Up};
use linden::preset::Preset;
use linden::random::Key;
use linden::recipe::Recipe;
use linden::{DVec3, Quiet};

use crate::scan::scan;
use crate::shapes::in_box;

/// The known tree with Z up, as surveys have it.
fn tree() -> Vec<DVec3> {
    scan().iter().map(|p| DVec3::new(p.x, -p.z, p.y)).collect()
}

/// A square of ground, 5 m wide, 3 cm thick, with Z up.
fn ground(height: f64) -> Vec<DVec3> {
    let key = Key::new(3);
    let low = DVec3::new(-2.5, -2.5, height - 0.03);
    (0..3000).map(|i| in_box(key.child(i), low, DVec3::new(2.5, 2.5, height))).collect()
}

/// A file as a command line grows it, with these knobs.
fn read_and_grown(bytes: &[u8], settings: &[(&str, &str)]) -> Result<Grown, String> {
    let input = Input::read("scan", bytes, &Quiet).unwrap();
    let mut preset = Preset::of_points("scan", "scan");
    for (knob, value) in settings {
        preset.set(knob, value).unwrap();
    }
    let recipe = Recipe::with_files(preset, [("scan", input)].into_iter().collect());
    grow(&recipe, &Quiet).map_err(|error| {
        let mut text = error.to_string();
        let mut source = std::error::Error::source(&error);
        while let Some(error) = source {
            let _ = write!(text, ": {error}");
            source = error.source();
        }
        text
    })
}

fn grown(text: &str, settings: &[(&str, &str)]) -> Grown {
    read_and_grown(text.as_bytes(), settings).unwrap()
}

/// Whether it is said.
fn says(grown: &Grown, said: &str) -> bool {
    grown.notes.iter().any(|note| note.contains(said))
}

/// Points, and what a column says of each by its number.
type Told<'a> = (&'a [DVec3], &'a dyn Fn(usize) -> String);

/// A table of points with what stands in one more column.
fn table(column: &str, rows: &[Told<'_>]) -> String {
    let mut text = format!("x,y,z,{column}\n");
    for (points, value) in rows {
        for (i, p) in points.iter().enumerate() {
            let _ = writeln!(text, "{},{},{},{}", p.x, p.y, p.z, value(i));
        }
    }
    text
}

#[test]
fn one_numbered_tree_is_grown_without_the_points_of_none() {
    let (tree, others) = (tree(), in_neighbour());
    let of_tree: &dyn Fn(usize) -> String = &|_| "7".to_owned();
    let alone = grown(&table("treeID", &[(&tree, of_tree)]), &[]);
    assert!(!says(&alone, "treeID"), "{:?}", alone.notes);
    for none in ["0", "nan", "-1", ""] {
        let text = table("treeID", &[(&others, &|_| none.to_owned()), (&tree, of_tree)]);
        let one = grown(&text, &[]);
        assert_eq!(one.skeleton.hash(), alone.skeleton.hash(), "{none}");
        let said =
            format!("{} of {} points are of no tree by 'treeID'", others.len(), others.len() + tree.len());
        assert!(says(&one, &said) && says(&one, "instance=none"), "{:?}", one.notes);
        let all = grown(&text, &[("instance", "none")]);
        assert_ne!(all.skeleton.hash(), alone.skeleton.hash());
        assert!(!says(&all, "treeID"), "{:?}", all.notes);
    }
    // Numbers that tell nothing apart.
    let plain = grown(&table("intensity", &[(&tree, &|_| "5".to_owned())]), &[]);
    for value in ["0", "nan", "1"] {
        let same = grown(&table("treeID", &[(&tree, &|_| value.to_owned())]), &[]);
        assert_eq!(same.skeleton.hash(), plain.skeleton.hash(), "{value}");
        assert!(!says(&same, "treeID"), "{:?}", same.notes);
    }
}

/// Points of another tree 4 m away.
fn in_neighbour() -> Vec<DVec3> {
    tree().iter().step_by(2).map(|p| *p + DVec3::new(4.0, 4.0, 0.0)).collect()
}

#[test]
fn what_cannot_number_trees_is_ignored_and_said() {
    let (tree, others) = (tree(), in_neighbour());
    for (value, said) in [
        ("1.5", "'treeID' numbers no trees: it holds 1.5, which is no whole number"),
        (
            "10000000000",
            "'treeID' numbers no trees: it holds 10000000000, which is too large (at most 4294967295)",
        ),
    ] {
        let text = table("treeID", &[(&tree, &|_| value.to_owned()), (&others, &|_| "3".to_owned())]);
        let found = grown(&text, &[]);
        assert!(says(&found, said) && says(&found, "it was ignored"), "{:?}", found.notes);
        for knobs in [&[("tree", "3")][..], &[("instance", "treeID")]] {
            let error = read_and_grown(text.as_bytes(), knobs).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}

#[test]
fn numbers_that_lie_among_each_other_are_classes() {
    // Leaves all over the tree's limbs, above its trunk.
    let wood = tree();
    let key = Key::new(8);
    let leaves: Vec<DVec3> = (0..9000_u64)
        .map(|i| wood[i as usize * 7919 % wood.len()] + 0.25 * key.child(i).in_ball())
        .filter(|p| p.z > 3.0)
        .collect();
    let text = |column: &str, numbers: [&str; 2]| {
        table(column, &[(&wood, &|_| numbers[0].to_owned()), (&leaves, &|_| numbers[1].to_owned())])
    };
    let known = grown(&text("wood_leaf", ["1", "2"]), &[]);
    let labelled = grown(&text("scalar_label", ["1", "2"]), &[]);
    assert_eq!(labelled.skeleton.hash(), known.skeleton.hash());
    assert!(
        says(&labelled, "'scalar_label' lie at the same places") && says(&labelled, "wood (1) and leaf (2)")
    );
    let zero = grown(&text("label", ["0", "1"]), &[]);
    assert!(
        says(&zero, "'label' lie at the same places") && says(&zero, "it was ignored"),
        "{:?}",
        zero.notes
    );
    let forced = grown(&text("label", ["1", "2"]), &[("instance", "label"), ("tree", "1")]);
    assert!(says(&forced, "1 and 2 of 'label' lie at the same places"), "{:?}", forced.notes);
    // A name that says trees is believed.
    let trees = grown(&text("treeID", ["1", "2"]), &[]);
    assert!(says(&trees, "'treeID' of scan tells 2 trees apart") && says(&trees, "1 and 2 of 'treeID' lie"));
    // Two trees beside each other are two.
    let others = in_neighbour();
    let two = table("label", &[(&wood, &|_| "1".to_owned()), (&others, &|_| "2".to_owned())]);
    let two = grown(&two, &[]);
    assert!(
        says(&two, "'label' of scan tells 2 trees apart") && !says(&two, "same places"),
        "{:?}",
        two.notes
    );
}

#[test]
fn rows_without_a_place_and_row_numbers_change_nothing() {
    let rows: Vec<String> = tree().iter().map(|p| format!("{:.4} {:.4} {:.4}", p.x, p.y, p.z)).collect();
    let plain = grown(&rows.join("\n"), &[]);
    let mut with = rows.clone();
    with.insert(40, "nan nan nan".to_owned());
    with.insert(900, "1.5 NA 2.5".to_owned());
    let found = grown(&with.join("\n"), &[]);
    assert_eq!(found.skeleton.hash(), plain.skeleton.hash());
    assert!(
        says(&found, "2 rows without a coordinate (empty, NA or NaN) were left out"),
        "{:?}",
        found.notes
    );
    let numbered: String = rows.iter().enumerate().map(|(i, row)| format!("{} {row}\n", i + 1)).collect();
    let found = grown(&numbered, &[]);
    assert_eq!(found.skeleton.hash(), plain.skeleton.hash());
    assert!(says(&found, "the first of four columns counts rows"), "{:?}", found.notes);
}

#[test]
fn coarse_coordinates_far_from_the_origin_are_said() {
    let ply = |offset: DVec3, kind: &str| {
        let points = tree();
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n\
             end_header\n",
            points.len()
        )
        .into_bytes();
        for p in points {
            for x in (p + offset).to_array() {
                if kind == "float" {
                    bytes.extend((x as f32).to_le_bytes());
                } else {
                    bytes.extend(x.to_le_bytes());
                }
            }
        }
        bytes
    };
    let survey = DVec3::new(448_123.0, 5_428_000.0, 300.0);
    for (offset, kind, is_said) in [
        (survey, "float", true),
        (survey, "double", false),
        (DVec3::ZERO, "float", false),
        (DVec3::new(120.0, 80.0, 300.0), "float", false),
    ] {
        let knobs = [("up", "z"), ("max_nodes", "2000")];
        let notes = read_and_grown(&ply(offset, kind), &knobs).unwrap().notes;
        let said =
            notes.iter().any(|note| note.contains("single precision") && note.contains("lie 0.5 apart"));
        assert_eq!(said, is_said, "{offset} {kind}: {notes:?}");
    }
}

/// LAS 1.2, format 0, by the format's table: points with their classes, coordinates in thousandths, and one record of the
/// coordinate system.
fn las(points: &[(DVec3, u8)], system: Option<(u16, &[u8])>) -> Vec<u8> {
    let mut bytes = b"LASF".to_vec();
    bytes.resize(24, 0);
    bytes.extend([1, 2]);
    bytes.resize(94, 0);
    let record = system.map_or(0, |(_, data)| 54 + data.len() as u32);
    bytes.extend(227_u16.to_le_bytes());
    bytes.extend((227 + record).to_le_bytes());
    bytes.extend(u32::from(record > 0).to_le_bytes());
    bytes.push(0);
    bytes.extend(20_u16.to_le_bytes());
    bytes.extend((points.len() as u32).to_le_bytes());
    bytes.extend([0; 20]);
    for x in [0.001_f64, 0.001, 0.001, 0.0, 0.0, 0.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([0; 48]);
    if let Some((id, data)) = system {
        bytes.extend([0, 0]);
        bytes.extend(b"LASF_Projection\0");
        bytes.extend(id.to_le_bytes());
        bytes.extend((data.len() as u16).to_le_bytes());
        bytes.extend([0; 32]);
        bytes.extend(data);
    }
    for (p, class) in points {
        for x in p.to_array() {
            bytes.extend(((x * 1000.0).round() as i32).to_le_bytes());
        }
        bytes.extend([0, 0, 0b1001, *class, 0, 0, 0, 0]);
    }
    bytes
}

#[test]
fn feet_become_metres() {
    const FEET: f64 = 3937.0 / 1200.0;
    let of = |by: f64| tree().iter().map(|p| (*p * by, 5)).collect::<Vec<(DVec3, u8)>>();
    let height = |grown: &Grown| grown.skeleton.measures().height_m;
    let metres = read_and_grown(&las(&of(1.0), None), &[]).unwrap();
    let text = br#"PROJCS["Maryland",UNIT["US survey foot",0.304800609601219]]"#;
    let feet = read_and_grown(&las(&of(FEET), Some((2112, text))), &[]).unwrap();
    assert!((height(&feet) / height(&metres) - 1.0).abs() < 0.01, "{} {}", height(&feet), height(&metres));
    assert!(
        says(&feet, "US survey feet") && says(&feet, "scale=1 takes them for metres"),
        "{:?}",
        feet.notes
    );
    let forced = read_and_grown(&las(&of(FEET), Some((2112, text))), &[("scale", "1")]).unwrap();
    assert!((height(&forced) / height(&metres) / FEET - 1.0).abs() < 0.02 && !says(&forced, "survey feet"));
    let mixed =
        br#"COMPD_CS["",PROJCS["",UNIT["US survey foot",0.304800609601219]],VERT_CS["",UNIT["metre",1]]]"#;
    let mixed = read_and_grown(&las(&of(1.0), Some((2112, mixed))), &[]).unwrap();
    assert!(says(&mixed, "heights in metres") && says(&mixed, "nothing was converted"), "{:?}", mixed.notes);
}

#[test]
fn ground_of_the_file_is_left_out_and_bears_the_foot() {
    // The lowest 40 cm of the trunk went with the ground, as filters of airborne surveys have it.
    let all = tree();
    let points: Vec<(DVec3, u8)> = all
        .iter()
        .map(|p| (*p, if p.z < 0.4 { 2 } else { 5 }))
        .chain(ground(0.0).into_iter().map(|p| (p, 2)))
        .collect();
    let seen: Vec<(DVec3, u8)> = points.iter().copied().filter(|(_, class)| *class == 5).collect();
    let height = |points: &[(DVec3, u8)]| {
        let grown = read_and_grown(&las(points, None), &[]).unwrap();
        let foot = grown.foot.unwrap();
        (grown.skeleton.measures().height_m, foot.z, grown)
    };
    let (tall, foot, grown) = height(&points);
    let (short, _, of_short) = height(&seen);
    assert!(foot.abs() < 0.06, "{foot}");
    assert!((tall - short - 0.4).abs() < 0.1, "{tall} {short}: {:?}", of_short.notes);
    assert!(
        says(&grown, "points that the file classes as ground (class 2) were left out"),
        "{:?}",
        grown.notes
    );
    // All of one class tell nothing.
    let same: Vec<(DVec3, u8)> = all.iter().map(|p| (*p, 2)).collect();
    let (whole, _, grown) = height(&same);
    assert!((whole - tall).abs() < 0.15 && !says(&grown, "class 2"), "{whole} {tall}");
}

#[test]
fn a_spire_in_a_ply_with_z_up_stands() {
    // Boughs to the ground: no bare stem says what is up.
    let key = Key::new(5);
    let mut points: Vec<DVec3> = Vec::new();
    for i in 0..24_000 {
        let [t, turn, out] = [0, 1, 2].map(|k| key.child(i).child(k).unit());
        let (height, turn) = (0.3 + 14.5 * t, std::f64::consts::TAU * turn);
        let reach = if i % 4 == 0 { 0.16 * (1.0 - t) } else { 2.2 * (1.0 - t) * out + 0.05 };
        // Boughs: twelve to a storey of half a metre.
        let (turn, height) = if i % 4 == 0 {
            (turn, height)
        } else {
            ((turn * 2.0).floor() / 2.0, (height * 2.0).floor() / 2.0 + 0.3)
        };
        points.push(DVec3::new(reach * libm::cos(turn), reach * libm::sin(turn), height));
    }
    let grown_along = |z_up: bool| {
        let mut text = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
            points.len()
        );
        for p in &points {
            let p = if z_up { *p } else { DVec3::new(p.x, p.z, -p.y) };
            let _ = writeln!(text, "{} {} {}", p.x, p.y, p.z);
        }
        assert_eq!(Input::read("a.ply", text.as_bytes(), &Quiet).unwrap().up, Up::Y);
        read_and_grown(text.as_bytes(), &[("max_nodes", "4000")]).unwrap()
    };
    let (z_up, y_up) = (grown_along(true), grown_along(false));
    for (grown, is_said) in [(&z_up, true), (&y_up, false)] {
        let points = &grown.colonized.as_ref().unwrap().points;
        let span = |axis: usize| {
            let (low, high) = points
                .iter()
                .fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
            high - low
        };
        assert!(span(1) > 2.0 * span(0).max(span(2)), "{} {} {}", span(0), span(1), span(2));
        assert_eq!(says(grown, "the tree stands along z"), is_said, "{:?}", grown.notes);
    }
}

#[test]
fn grids_of_other_units_are_said() {
    let grid = |height: u32| {
        let rows: String = (0..12).map(|_| format!("{} 0 {height} 0 0 0\n", height / 2)).collect();
        format!("ncols 6\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 1\n{rows}")
    };
    let error = read_and_grown(grid(2193).as_bytes(), &[]).unwrap_err();
    assert!(error.contains("2193 m") && error.contains("centimetres"), "{error}");
    assert!(matches!(
        Input::read("a", grid(20).as_bytes(), &Quiet).unwrap().geometry,
        Geometry::Points(cloud) if cloud.units.is_none()
    ));
}
