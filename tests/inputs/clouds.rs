//! Point clouds that other programs wrote (`tests/fixtures/clouds/make.py` says which).

use linden::input::{Cloud, Geometry, Input, Up};
use linden::{DVec3, Quiet};

/// The points of all files, as `make.py` has them.
fn points() -> Vec<DVec3> {
    (0..60_u32)
        .map(|i| {
            let n = f64::from(i);
            DVec3::new(0.125 * n, 10.0 - 0.25 * n, 0.5 * f64::from(i * i % 17))
        })
        .collect()
}

fn read(name: &str) -> Cloud {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/clouds").join(name);
    // The name says nothing.
    let bytes = std::fs::read(&path).unwrap();
    let input = Input::read("cloud.txt", &bytes, &Quiet).unwrap();
    assert_eq!(input.up, Up::Z);
    if name.starts_with("laspy") || name.starts_with("pye57") {
        assert!(Input::is_streamed("cloud.txt", &bytes[..1000]), "{name}");
        for cube in [None, Some(1.0)] {
            let file = std::fs::File::open(&path).unwrap();
            let streamed = Input::stream("cloud.txt", file, cube, &Quiet).unwrap();
            let thinned = Input::read_thinned("cloud.txt", &bytes, cube, &Quiet).unwrap();
            assert_eq!((streamed.hash, streamed.up), (input.hash, Up::Z), "{name}");
            assert_eq!(cloud_of(&streamed), cloud_of(&thinned), "{name}");
            assert_eq!(cloud_of(&streamed).positions.len() < 60, cube.is_some(), "{name}");
        }
    }
    cloud_of(&input).clone()
}

fn cloud_of(input: &Input) -> &Cloud {
    let Geometry::Points(cloud) = &input.geometry else { panic!("no points") };
    cloud
}

#[test]
fn grids_of_another_program_are_what_a_text_says() {
    let mut text = "ncols 40\nnrows 24\nxllcorner 600000\nyllcorner 5399976\ncellsize 1\n".to_owned();
    for row in 0..24 {
        let cells = (0..40).map(|x| if x == 9 { "-9999".to_owned() } else { (x + 100 * row).to_string() });
        text.extend(cells.flat_map(|cell| [cell, " ".to_owned()]));
        text.push('\n');
    }
    // Row by row: tiles come one after another.
    let sorted = |cloud: &Cloud| {
        let mut cells: Vec<[f64; 3]> = cloud.positions.iter().map(DVec3::to_array).collect();
        cells.sort_by(|a, b| b[1].total_cmp(&a[1]).then(a[0].total_cmp(&b[0])));
        (cloud.cell, cells)
    };
    let expected = Input::read("heights.txt", text.as_bytes(), &Quiet).unwrap();
    let expected = sorted(cloud_of(&expected));
    assert_eq!(expected.1.len(), 39 * 24);
    for name in ["tifffile-tiles.tif", "tifffile-strips.tif", "tifffile-big.tif"] {
        assert_eq!(sorted(&read(name)), expected, "{name}");
    }
}

#[test]
fn clouds_of_other_programs_are_read_to_the_last_digit() {
    let surveyed = DVec3::new(446_000.0, 5_428_000.0, 300.0);
    for (name, offset) in [
        ("laspy-1.2.las", surveyed),
        ("laspy-1.2.laz", surveyed),
        ("laspy-1.4.las", surveyed),
        ("laspy-1.4.laz", surveyed),
        ("pye57.e57", DVec3::ZERO),
        ("pypcd4-ascii.pcd", DVec3::ZERO),
        ("pypcd4-binary.pcd", DVec3::ZERO),
        ("pypcd4-binary_compressed.pcd", DVec3::ZERO),
    ] {
        let cloud = read(name);
        let found = cloud.positions;
        assert_eq!(found.len(), points().len(), "{name}");
        for (found, point) in found.iter().zip(points()) {
            assert!(found.distance(point + offset) < 2e-9, "{name}: {found} is not {point}");
        }
        // Twenty points a number, of which 0 is no tree's.
        let trees: Vec<_> = cloud.trees.iter().map(|column| (&*column.name, column.counts())).collect();
        let expected =
            if name.starts_with("laspy") { vec![("PredInstance", vec![(1, 20), (2, 20)])] } else { vec![] };
        assert_eq!(trees, expected, "{name}");
    }
}
