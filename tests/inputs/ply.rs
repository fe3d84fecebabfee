//! PLY in its three encodings, well made, foreign and lying.

use linden::input::{InputError, InputKind, read_ply, sniff};
use linden::monitor::{Monitor, Phase};
use linden::random::Key;
use linden::{DVec3, Quiet};

fn whole_problem(bytes: &[u8]) -> String {
    match read_ply(bytes, &Quiet).unwrap_err() {
        InputError::Whole { format: "PLY", problem } => problem,
        other => panic!("{other}"),
    }
}

fn problem(bytes: &[u8]) -> String {
    read_ply(bytes, &Quiet).unwrap_err().to_string()
}

const POSITIONS: [DVec3; 4] =
    [DVec3::ZERO, DVec3::new(1.5, -2.0, 0.25), DVec3::new(3.0, 4.0, -5.0), DVec3::new(0.0, 0.0, 7.0)];

/// A header with extra elements and properties, lists among them, before, between and behind.
fn header(format: &str) -> Vec<u8> {
    format!(
        "ply\r\nformat {format} 1.0\r\ncomment gr\u{fc}n\r\nobj_info x\r\nelement camera 1\r\n\
         property list uchar double path\r\nproperty short id\r\nelement vertex 4\r\nproperty uchar red\r\n\
         property double x\r\nproperty list ushort float tags\r\nproperty float y\r\nproperty int z_fixed\r\n\
         property float32 z\r\nelement nothing 5\r\nelement face 2\r\nproperty int8 kind\r\n\
         property list uint8 int32 vertex_indices\r\nproperty list uchar float texcoord\r\nend_header\r\n"
    )
    .chars()
    // Latin-1, as some writers' comments are.
    .map(|c| c as u8)
    .collect()
}

fn binary(big: bool) -> Vec<u8> {
    let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" });
    let mut put = |little: &[u8]| {
        let mut value = little.to_vec();
        if big {
            value.reverse();
        }
        bytes.extend(value);
    };
    put(&[2]);
    put(&1.0_f64.to_le_bytes());
    put(&2.0_f64.to_le_bytes());
    put(&(-7_i16).to_le_bytes());
    for (i, p) in POSITIONS.iter().enumerate() {
        put(&[200]);
        put(&p.x.to_le_bytes());
        put(&(i as u16).to_le_bytes());
        for _ in 0..i {
            put(&9.5_f32.to_le_bytes());
        }
        put(&(p.y as f32).to_le_bytes());
        put(&77_i32.to_le_bytes());
        put(&(p.z as f32).to_le_bytes());
    }
    for polygon in [&[0_i32, 1, 2][..], &[0, 1, 2, 3]] {
        put(&[1]);
        put(&[polygon.len() as u8]);
        for v in polygon {
            put(&v.to_le_bytes());
        }
        put(&[1]);
        put(&0.5_f32.to_le_bytes());
    }
    bytes
}

fn ascii() -> Vec<u8> {
    let mut bytes = header("ascii");
    bytes.extend(
        b"2 1 2 -7\r\n200 0 0 0 77 0\r\n200 1.5 1 9.5 -2. 77 .25\r\n200 3e0 2 9.5 9.5 +4 77 -5\r\n\
          200 0 3 1 2 3 0 77 7.0\r\n1 3 0 1 2 1 .5\r\n1 4 0 1 2 3 1 .5",
    );
    bytes
}

#[test]
fn all_encodings_give_the_same() {
    for bytes in [ascii(), binary(false), binary(true)] {
        let data = read_ply(&bytes, &Quiet).unwrap();
        assert_eq!(data.positions, POSITIONS);
        assert_eq!(data.faces, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
        assert_eq!(sniff(&bytes, ""), Ok(InputKind::PlyMesh));
    }
}

#[test]
fn every_cut_is_an_error_and_no_cut_panics() {
    for bytes in [ascii(), binary(false), binary(true)] {
        // Cutting the last value of a text in two cannot be seen.
        for end in 0..bytes.len() - 2 {
            assert!(read_ply(&bytes[..end], &Quiet).is_err(), "{end}");
            let _ = sniff(&bytes[..end], "");
        }
    }
}

#[test]
fn lying_counts_are_refused_before_memory_is_taken() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for count in ["4000000000", "18446744073709551615", "9"] {
            let text = format!(
                "ply\nformat {format} 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n"
            );
            assert!(whole_problem(text.as_bytes()).contains("cut off"), "{text}");
        }
        // Rows of nothing take nothing, however many.
        let text = format!(
            "ply\nformat {format} 1.0\nelement void 18446744073709551615\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        );
        assert!(whole_problem(text.as_bytes()).contains("no vertices"));
    }
    let mut list = b"ply\nformat binary_little_endian 1.0\nelement a 1\nproperty list uint double b\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n".to_vec();
    list.extend(u32::MAX.to_le_bytes());
    assert!(problem(&list).contains("announces 4294967295 values"), "{}", problem(&list));
    let face = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n4000000000 0 0 0\n";
    assert!(problem(face.as_bytes()).contains("the data ends here"), "{}", problem(face.as_bytes()));
}

#[test]
fn headers_that_are_none() {
    let vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    for (header, part) in [
        ("plx\n".to_owned(), "expected 'ply'"),
        ("ply\nformat ascii 1.0\n".to_owned(), "end_header"),
        (format!("ply\n{vertex}end_header\n0 0 0\n"), "no line 'format'"),
        (format!("ply\nformat utf8 1.0\n{vertex}end_header\n"), "line 2: expected ascii"),
        (format!("ply\nformat ascii 2.0\n{vertex}end_header\n"), "line 2"),
        ("ply\nformat ascii 1.0\nproperty float x\nend_header\n".to_owned(), "line 3: expected an element"),
        ("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n".to_owned(), "a whole number"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n".to_owned(), "line 4: expected a type"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float float x\nend_header\n".to_owned(), "line 4"),
        (format!("ply\nformat ascii 1.0\n{vertex}{vertex}end_header\n"), "not there before"),
        ("ply\nformat ascii 1.0\nelement face 0\nend_header\n".to_owned(), "no element 'vertex'"),
        (format!("ply\nformat ascii 1.0\n{vertex}element tristrips 1\nend_header\n0 0 0\n"), "no list 'vertex_indices'"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n".to_owned(),
            "no property 'z'",
        ),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty list uchar float y\nproperty float z\nend_header\n0 1 0 0\n".to_owned(),
            "'y' is a list",
        ),
        (
            format!("ply\nformat ascii 1.0\n{vertex}element face 1\nproperty int vertex_indices\nend_header\n0 0 0\n0\n"),
            "no list 'vertex_indices'",
        ),
        (
            format!("ply\nformat ascii 1.0\nelement vertex 1\n{}end_header\n", "property int a\n".repeat(2)),
            "not there before",
        ),
    ] {
        let said = problem(header.as_bytes());
        assert!(said.contains(part), "{said}");
    }
    let many: String = (0..5000).map(|i| format!("property int p{i}\n")).collect();
    let many = format!("ply\nformat ascii 1.0\nelement vertex 1\n{many}end_header\n");
    assert!(problem(many.as_bytes()).contains("4096"));
}

#[test]
fn numbers_that_are_none() {
    let row = |row: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n{row}\n"
        )
    };
    for (bad, part) in [
        ("1 nan 2", "row 1 of 2: property 'y': expected a finite number (line 9)"),
        ("1 2 inf", "finite"),
        ("1 2 x\u{1b}", "expected a number, found 'x\\u{1b}'"),
        ("1e20 0 0", "±1e9"),
    ] {
        let said = problem(row(bad).as_bytes());
        assert!(said.contains(part), "{said}");
    }
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nend_header\n".to_vec();
    bytes.extend([1.0_f64, f64::NAN, 1.0].iter().flat_map(|x| x.to_be_bytes()));
    assert!(problem(&bytes).contains("'vertex', row 0 of 1: property 'y'"), "{}", problem(&bytes));
}

#[test]
fn faces_must_name_vertices() {
    for (face, part) in [
        ("3 0 1 9", "names vertex 9"),
        ("3 0 1 -1", "found -1"),
        ("-3 0 1 2", "announces -3"),
        ("3 0 1 0.5", "found 0.5"),
    ] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list int int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n{face}\n"
        );
        assert!(problem(text.as_bytes()).contains(part), "{}", problem(text.as_bytes()));
    }
}

/// A mesh of strips: as the scans of Stanford are, all in one list and each ended by −1, in a list each, and
/// beside plain faces.
fn strips(encoding: &str, lists: &[Vec<i32>]) -> Vec<u8> {
    let most = lists.iter().flatten().max().map_or(0, |&index| index + 1);
    let mut bytes = format!(
        "ply\nformat {encoding} 1.0\nelement tristrips {}\nproperty list int int vertex_indices\n\
         element vertex {most}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        lists.len()
    )
    .into_bytes();
    for list in lists {
        let numbers = std::iter::once(list.len() as i32).chain(list.iter().copied());
        match encoding {
            "ascii" => bytes.extend(numbers.flat_map(|n| format!("{n} ").into_bytes())),
            "binary_big_endian" => bytes.extend(numbers.flat_map(i32::to_be_bytes)),
            _ => bytes.extend(numbers.flat_map(i32::to_le_bytes)),
        }
    }
    for i in 0..most {
        let position = [i as f32, (i * i) as f32, 5.0];
        match encoding {
            "ascii" => bytes.extend(position.iter().flat_map(|x| format!("{x} ").into_bytes())),
            "binary_big_endian" => bytes.extend(position.iter().flat_map(|x| x.to_be_bytes())),
            _ => bytes.extend(position.iter().flat_map(|x| x.to_le_bytes())),
        }
    }
    bytes
}

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// By the definition: of the strip v0 v1 v2 …, triangle i is (vi, vi+1, vi+2), and for odd i (vi+1, vi, vi+2).
fn unstripped(lists: &[Vec<i32>]) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for strip in lists.iter().flat_map(|list| list.split(|&index| index == -1)) {
        for i in 2..strip.len() {
            let [a, b, c] = [i - 2, i - 1, i].map(|i| strip[i] as u32);
            if a != b && b != c && a != c {
                triangles.push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    triangles
}

#[test]
fn strips_are_the_triangles_of_their_definition() {
    for number in 0..200 {
        let key = Key::new(21).child(number);
        let draw = |key: Key, end: f64| (key.unit() * end) as i32;
        let lists: Vec<Vec<i32>> = (0..draw(key.named("lists"), 4.0) as u64)
            .map(|l| {
                let key = key.child(l);
                // One in seven is a −1.
                (0..draw(key.named("long"), 40.0) as u64).map(|i| draw(key.child(i), 7.0) - 1).collect()
            })
            .chain([vec![0, 1, 2]])
            .collect();
        for encoding in ENCODINGS {
            let bytes = strips(encoding, &lists);
            let data = read_ply(&bytes, &Quiet).unwrap();
            assert_eq!(data.faces, unstripped(&lists), "{lists:?}");
            assert_eq!(sniff(&bytes, ""), Ok(InputKind::PlyMesh));
        }
    }
}

#[test]
fn a_ball_of_strips_is_closed_and_looks_out() {
    // Between two rings of twelve, a strip; twelve triangles and a strip at each pole.
    let ring = |ring: i32, side: i32| match ring {
        0 => 0,
        _ => 1 + (ring - 1) * 12 + side % 12,
    };
    let mut list = Vec::new();
    for upper in 0..6 {
        for side in 0..=12 {
            // The lowest ring is the other pole's, one place for all sides.
            list.extend([ring(upper, side), if upper == 5 { ring(6, 0) } else { ring(upper + 1, side) }]);
        }
        list.push(-1);
    }
    let data = read_ply(&strips("ascii", &[list]), &Quiet).unwrap();
    // 12 at each pole, 24 between two rings.
    assert_eq!(data.faces.len(), 12 + 4 * 24 + 12);
    let mut edges: Vec<(u32, u32)> =
        data.faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    edges.sort_unstable();
    let one_way = edges.windows(2).all(|pair| pair[0] != pair[1]);
    assert!(one_way, "neighbours look to opposite sides");
    assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()), "it has holes");
}

#[test]
fn lying_strips_are_refused() {
    for encoding in ENCODINGS {
        let whole = strips(encoding, &[vec![0, 1, 2, 3, -1, 1, 2, 3], vec![]]);
        for end in 0..whole.len() - 2 {
            assert!(read_ply(&whole[..end], &Quiet).is_err(), "{encoding} {end}");
        }
        let said = problem(&strips(encoding, &[vec![0, 1, -2, 3]]));
        assert!(said.contains("'tristrips', row 0 of 1") && said.contains("found -2"), "{said}");
    }
    let text = String::from_utf8(strips("ascii", &[vec![0, 1, 2]])).unwrap();
    let said = problem(text.replace("3 0 1 2", "3 0 1 9").as_bytes());
    assert!(said.contains("names vertex 9"), "{said}");
    let said = problem(text.replace("3 0 1 2", "2000000000 0 1 2").as_bytes());
    assert!(said.contains("the data ends here"), "{said}");
}

#[test]
fn long_strips_ask_for_memory_and_can_be_cancelled() {
    struct Small;
    impl Monitor for Small {
        fn is_cancelled(&self) -> bool {
            false
        }
        fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
        fn memory_limit(&self) -> u64 {
            100_000
        }
    }
    let zigzag = vec![(0..60_000).map(|i| i % 5).collect::<Vec<i32>>()];
    let bytes = strips("binary_little_endian", &zigzag);
    assert_eq!(read_ply(&bytes, &Quiet).unwrap().faces.len(), 59_998);
    assert!(matches!(read_ply(&bytes, &Small), Err(InputError::Memory(_))));
}

#[test]
fn mangled_files_give_a_value_or_an_error() {
    let strip = |encoding| strips(encoding, &[vec![0, 1, 2, 3, -1, 4, 1, 2], vec![2, 3, 1]]);
    for (i, source) in
        [ascii(), binary(false), binary(true)].into_iter().chain(ENCODINGS.map(strip)).enumerate()
    {
        for k in 0..3000 {
            let key = Key::new(i as u64).child(k);
            let mut bytes: Vec<u8> = source.clone();
            for n in 0..=key.bits() % 4 {
                let at = (key.child(n).named("at").unit() * bytes.len() as f64) as usize;
                bytes[at] = key.child(n).named("to").bits() as u8;
            }
            let _ = sniff(&bytes, "");
            if let Ok(data) = read_ply(&bytes, &Quiet) {
                assert!(data.faces.iter().flatten().all(|&v| (v as usize) < data.positions.len()));
                assert!(data.positions.iter().all(|p| p.is_finite()));
            }
        }
    }
}
