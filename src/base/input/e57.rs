//! Reads E57 (ASTM E2807), by the crate e57: the stands of a scanner in one file.
//!
//! All point clouds of the file are taken, each where its pose puts it; spherical coordinates become Cartesian ones. Points
//! without a valid place, where no echo came back, are left out. Metres, by the standard.

use std::io::{Cursor, Read, Seek};
use std::panic::{AssertUnwindSafe, catch_unwind};

use e57::{CartesianCoordinate, E57Reader};
use glam::DVec3;

use super::gather::Gathering;
use super::{Cloud, InputError, ROWS_PER_CHECK, in_range};
use crate::monitor::{Monitor, Phase};

/// Reads the points of an E57 file; Z is up.
///
/// # Errors
/// [`InputError`]: a file that is none or is cut off, damaged data with the number of cloud and point, no points; no
/// memory; cancelled.
pub fn read_e57(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    stream_e57(Cursor::new(bytes), bytes.len() as u64, None, monitor)
}

/// The same of a stream of so many bytes; of each cube with sides `cube` one point is kept.
pub(super) fn stream_e57(
    stream: impl Read + Seek,
    length: u64,
    cube: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Cloud, InputError> {
    // The crate is careful, but says of nothing that it cannot panic.
    let read = || read_all(stream, length, Gathering::new([], cube, monitor));
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(whole("its data are damaged; export it anew")))
}

fn read_all(stream: impl Read + Seek, length: u64, mut points: Gathering<'_>) -> Result<Cloud, InputError> {
    let monitor = points.monitor();
    let mut reader = E57Reader::new(stream).map_err(|error| whole(&format!("{error}; it may be cut off")))?;
    let clouds = reader.pointclouds();
    let announced = clouds.iter().fold(0_u64, |sum, cloud| sum.saturating_add(cloud.records));
    // A point takes a bit at least; what a header announces without any data would never end.
    if announced > length.saturating_mul(8) {
        return Err(whole(&format!(
            "it announces {announced} points, more than its {length} bytes can hold"
        )));
    }
    let mut done = 0;
    for (number, cloud) in (1..).zip(&clouds) {
        let damaged = |at: u64, problem: &dyn std::fmt::Display| {
            whole(&format!("cloud {number} of {}, point {at}: {problem}", clouds.len()))
        };
        let iterator = reader.pointcloud_simple(cloud).map_err(|error| damaged(0, &error))?;
        for (at, point) in (0..).zip(iterator) {
            if done % ROWS_PER_CHECK as u64 == 0 {
                monitor.check()?;
                monitor.advance(Phase::Read, done, Some(announced));
            }
            done += 1;
            let point = point.map_err(|error| damaged(at, &error))?;
            let CartesianCoordinate::Valid { x, y, z } = point.cartesian else { continue };
            for coordinate in [x, y, z] {
                in_range(coordinate).map_err(|expected| damaged(at, &format!("expected {expected}")))?;
            }
            points.push(DVec3::new(x, y, z), |_| f64::NAN)?;
        }
    }
    if points.came() == 0 {
        return Err(whole(&format!(
            "none of the {announced} points in its {} clouds has a place",
            clouds.len()
        )));
    }
    Ok(points.finish())
}

fn whole(problem: &str) -> InputError {
    InputError::Whole { format: "E57", problem: problem.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;
    use e57::{E57Writer, Quaternion, Record, RecordValue, Transform, Translation};

    /// Two stands, the second turned by a quarter about Z and moved; one point in three is none.
    fn file() -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let mut writer = E57Writer::new(&mut file, "file").unwrap();
        for stand in 0..2 {
            let prototype = vec![
                Record::CARTESIAN_X_F64,
                Record::CARTESIAN_Y_F64,
                Record::CARTESIAN_Z_F64,
                Record {
                    name: e57::RecordName::CartesianInvalidState,
                    data_type: e57::RecordDataType::Integer { min: 0, max: 2 },
                },
            ];
            let mut cloud = writer.add_pointcloud(&format!("stand{stand}"), prototype).unwrap();
            if stand == 1 {
                let half = std::f64::consts::FRAC_1_SQRT_2;
                cloud.set_transform(Some(Transform {
                    rotation: Quaternion { w: half, x: 0.0, y: 0.0, z: half },
                    translation: Translation { x: 100.0, y: 0.0, z: 5.0 },
                }));
            }
            for i in 0..30 {
                let state = if i % 3 == 0 { 2 } else { 0 };
                cloud
                    .add_point(vec![
                        RecordValue::Double(f64::from(i)),
                        RecordValue::Double(1.0),
                        RecordValue::Double(2.0),
                        RecordValue::Integer(state),
                    ])
                    .unwrap();
            }
            cloud.finalize().unwrap();
        }
        writer.finalize().unwrap();
        drop(writer);
        file.into_inner()
    }

    #[test]
    fn all_stands_are_put_where_their_poses_say() {
        let points = read_e57(&file(), &Quiet).unwrap().positions;
        assert_eq!(points.len(), 40);
        assert_eq!(points[0], DVec3::new(1.0, 1.0, 2.0));
        // (x, y) becomes (-y, x), then it is moved.
        assert!(points[20].distance(DVec3::new(99.0, 1.0, 7.0)) < 1e-9, "{}", points[20]);
    }

    #[test]
    fn damage_is_said() {
        let whole = file();
        for length in (0..whole.len()).step_by(97) {
            assert!(read_e57(&whole[..length], &Quiet).is_err(), "{length}");
        }
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x41;
            let _ = read_e57(&bytes, &Quiet);
        }
    }
}
