//! Points as text: what is written is read again, and mangled bytes never panic.

use linden::input::{Up, read_xyz, recenter, sniff};
use linden::random::Key;
use linden::{DVec3, Quiet};

use crate::shapes::in_box;

fn points() -> Vec<DVec3> {
    (0..500).map(|i| in_box(Key::new(1).child(i), DVec3::splat(-9.0), DVec3::splat(4e5))).collect()
}

#[test]
fn every_bit_survives_whatever_the_separators() {
    for (separator, end) in [(" ", "\n"), ("\t", "\r\n"), (",", "\n"), (" ; ", "\r"), (", ", "\n\n")] {
        let row = |p: &DVec3| [p.x, p.y, p.z, 255.0].map(|x| x.to_string()).join(separator) + end;
        let text: String = points().iter().map(row).collect();
        assert_eq!(read_xyz(text.as_bytes(), &Quiet).unwrap().positions, points(), "{separator:?}");
    }
}

#[test]
fn a_survey_comes_near_the_origin_upright() {
    let cloud = read_xyz(b"446000.5 5428000.25 310.0\n446001.5 5428000.25 320.0\n", &Quiet).unwrap();
    let mut points = cloud.positions;
    let foot = points[0];
    recenter(&mut points, foot);
    Up::Z.to_y_up(&mut points);
    assert_eq!(points, [DVec3::ZERO, DVec3::new(1.0, 10.0, 0.0)]);
}

#[test]
fn mangled_files_give_a_value_or_an_error() {
    let text: String = points()[..20].iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    let mut errors = 0;
    for i in 0..3000 {
        let key = Key::new(2).child(i);
        let mut bytes = text.clone().into_bytes();
        for k in 0..=key.bits() % 3 {
            let at = (key.child(k).named("at").unit() * bytes.len() as f64) as usize;
            bytes[at] = key.child(k).named("to").bits() as u8;
        }
        let _ = sniff(&bytes, "x.xyz");
        match read_xyz(&bytes, &Quiet) {
            Ok(cloud) => assert!(cloud.positions.iter().all(|p| p.is_finite())),
            Err(_) => errors += 1,
        }
    }
    assert!(errors > 1000, "{errors}");
}
