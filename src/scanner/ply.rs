//! Points with their truth as PLY: binary, little-endian, Y up.
//!
//! Beside `x y z` (float) each vertex has `tree` (int, from 1; 0 ground), `part` (uchar: 0 ground, 1 wood, 2 leaf), `axis` and
//! `order` (int: of the wood, or of the wood that bears the leaf; -1 ground), `stand` (ushort) and `echo` (uchar), both from
//! 0. There is no recipe in it: it would be grown in place of the points.

use std::ops::Range;

use crate::Scan;

/// Bytes of a vertex.
pub const ROW: usize = 12 + 4 + 1 + 4 + 4 + 2 + 1;

/// Everything before the points. `comment` is one line.
pub fn header(scan: &Scan, comment: &str) -> String {
    let comment: String = comment.chars().filter(|letter| !letter.is_control()).collect();
    let mut text = "ply\nformat binary_little_endian 1.0\n".to_owned();
    text += &format!("comment {comment}\ncomment metres, up axis: Y; part 0 ground, 1 wood, 2 leaf\n");
    for (number, stand) in scan.stands.iter().enumerate() {
        let [x, y, z] = stand.eye.to_array();
        text += &format!("comment stand {number} at {x:.3} {y:.3} {z:.3}\n");
    }
    text += &format!("element vertex {}\n", scan.points.len());
    for property in [
        "float x",
        "float y",
        "float z",
        "int tree",
        "uchar part",
        "int axis",
        "int order",
        "ushort stand",
        "uchar echo",
    ] {
        text += &format!("property {property}\n");
    }
    text + "end_header\n"
}

/// Some of the points, [`ROW`] bytes each.
pub fn rows(scan: &Scan, range: Range<usize>) -> Vec<u8> {
    let points = scan.points.get(range).unwrap_or_default();
    let mut bytes = Vec::with_capacity(points.len() * ROW);
    for point in points {
        let truth = scan.truth(point);
        for x in point.position.to_array() {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend(truth.tree.to_le_bytes());
        bytes.push(truth.what.number());
        bytes.extend(truth.axis.to_le_bytes());
        bytes.extend(truth.order.to_le_bytes());
        bytes.extend(point.stand.to_le_bytes());
        bytes.push(point.echo);
    }
    bytes
}
