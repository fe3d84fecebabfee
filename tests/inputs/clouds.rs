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
    let input = Input::read("cloud.txt", &std::fs::read(path).unwrap(), &Quiet).unwrap();
    assert_eq!(input.up, Up::Z);
    let Geometry::Points(cloud) = input.geometry else { panic!("{name} holds no points") };
    cloud.as_ref().clone()
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
