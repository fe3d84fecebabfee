//! Points with their truth as LAZ, by the crate las: LAS 1.4, record format 6, Z up, resolved to a tenth of a millimetre.
//!
//! Ground has class 2, wood and leaves 5. The truth is in extra bytes: `treeID`, `part`, `axis` and `order`, as in
//! [`ply`](crate::ply); the stand is the point's source, counted from 1. There is no date in the file: the same points
//! give the same bytes.

use std::io::Cursor;

use las::point::{Classification, Format};
use las::{Builder, Point, Transform, Vector, Vlr, Writer};
use linden_pipeline::Monitor;
use linden_pipeline::memory::bytes_of;

use crate::target::WhatIsHit;
use crate::{Scan, ScannerError};

/// Names and types of the extra bytes: the types' numbers and sizes are those of the format's table.
const EXTRA: [(&str, u8, u16); 4] = [("treeID", 6, 4), ("part", 1, 1), ("axis", 6, 4), ("order", 6, 4)];

/// Points between two looks at the monitor.
const POINTS_PER_CHECK: usize = 1 << 16;

/// The whole file.
///
/// # Errors
/// [`ScannerError`]: memory, cancelled, or points that the format cannot hold.
pub fn file(scan: &Scan, comment: &str, monitor: &dyn Monitor) -> Result<Vec<u8>, ScannerError> {
    // Compressed it is smaller.
    monitor.admit("writing LAZ", bytes_of::<[u8; 48]>(scan.points.len()), "write PLY")?;
    let failed = |error: las::Error| ScannerError::Laz(error.to_string());
    let mut builder = Builder::from((1, 4));
    let mut format = Format::new(6).map_err(failed)?;
    format.extra_bytes = EXTRA.iter().map(|(_, _, bytes)| bytes).sum();
    format.is_compressed = true;
    builder.point_format = format;
    builder.date = None;
    "linden scan".clone_into(&mut builder.system_identifier);
    "linden".clone_into(&mut builder.generating_software);
    let axis = Transform { scale: 1e-4, offset: 0.0 };
    builder.transforms = Vector { x: axis, y: axis, z: axis };
    builder.vlrs = vec![descriptors(), note(comment)];
    let header = builder.into_header().map_err(failed)?;
    let mut writer = Writer::new(Cursor::new(Vec::new()), header).map_err(failed)?;
    // The echoes of a pulse follow each other.
    let pulses = scan.points.chunk_by(|a, b| b.echo > a.echo);
    let returns = pulses.flat_map(|pulse| pulse.iter().map(|point| (point, pulse.len() as u8)));
    for (number, (point, number_of_returns)) in returns.enumerate() {
        if number.is_multiple_of(POINTS_PER_CHECK) {
            monitor.check()?;
        }
        let truth = scan.truth(point);
        let place = point.position.as_dvec3();
        let is_ground = truth.what == WhatIsHit::Ground;
        let mut extra_bytes = Vec::with_capacity(13);
        extra_bytes.extend(truth.tree.to_le_bytes());
        extra_bytes.push(truth.what.number());
        extra_bytes.extend(truth.axis.to_le_bytes());
        extra_bytes.extend(truth.order.to_le_bytes());
        let point = Point {
            x: place.x,
            y: -place.z,
            z: place.y,
            return_number: point.echo + 1,
            number_of_returns,
            classification: if is_ground { Classification::Ground } else { Classification::HighVegetation },
            point_source_id: point.stand + 1,
            gps_time: Some(0.0),
            extra_bytes,
            ..Point::default()
        };
        writer.write_point(point).map_err(failed)?;
    }
    writer.close().map_err(failed)?;
    Ok(writer.into_inner().map_err(failed)?.into_inner())
}

/// What the extra bytes are: 192 bytes each.
fn descriptors() -> Vlr {
    let mut data = Vec::new();
    for (name, kind, _) in EXTRA {
        let mut row = [0; 192];
        row[2] = kind;
        for (to, letter) in row[4..36].iter_mut().zip(name.bytes()) {
            *to = letter;
        }
        data.extend(row);
    }
    Vlr { user_id: "LASF_Spec".to_owned(), record_id: 4, description: "Extra Bytes".to_owned(), data }
}

/// The text area of the format: what the file is.
fn note(comment: &str) -> Vlr {
    let data = comment.bytes().chain([0]).collect();
    Vlr { user_id: "LASF_Spec".to_owned(), record_id: 3, description: "Text area".to_owned(), data }
}
