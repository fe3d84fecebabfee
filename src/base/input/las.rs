//! Reads LAS 1.0 to 1.4 and LAZ, by the crate las: points of surveys and scanners.
//!
//! What the file itself says is no point is left out: records that are withheld, and the classes 7 (low point) and 18 (high
//! noise). Coordinates are raw · scale + offset in `f64`, so that those of a survey keep their millimetres.
//!
//! The crate believes a header's number of chunks, and indexes by what it decompresses; the number is held against the file
//! before, and what panics on damaged data becomes an error.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::DVec3;
use las::{PointDataBuilder, Reader};

use super::{InputError, READING, READING_ADVICE, in_range, make_room};
use crate::memory::bytes_of;
use crate::monitor::{Monitor, Phase};

/// Points that are decompressed at once.
const POINTS_PER_PIECE: u64 = 1 << 16;
/// And bytes of their records, of which some files claim many.
const BYTES_PER_PIECE: u64 = 1 << 24;

/// Classes of the format's table that are noise.
const NOISE: [u8; 2] = [7, 18];

/// Reads the points of a LAS or LAZ file; Z is up.
///
/// # Errors
/// [`InputError`]: a header that is none or announces more than the file holds, damaged data with the number of the
/// record, no points; no memory; cancelled.
pub fn read_las(bytes: &[u8], monitor: &dyn Monitor) -> Result<Vec<DVec3>, InputError> {
    check_header(bytes)?;
    // The crate's reader owns what it reads.
    monitor.admit(READING, bytes_of::<u8>(bytes.len()), READING_ADVICE)?;
    let read = || read_all(Cursor::new(bytes.to_vec()), bytes.len(), monitor);
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(whole("its data are damaged; export it anew")))
}

fn read_all(
    file: Cursor<Vec<u8>>,
    file_bytes: usize,
    monitor: &dyn Monitor,
) -> Result<Vec<DVec3>, InputError> {
    let held = bytes_of::<u8>(file_bytes);
    let mut reader = Reader::new(file).map_err(|error| whole(&format!("its header: {error}")))?;
    let total = reader.header().number_of_points();
    // Of each record the byte of flags and the class: see the format's tables of point records.
    let is_extended = reader.header().point_format().is_extended;
    let mut points = Vec::new();
    let mut piece = PointDataBuilder::new().for_header(reader.header()).build();
    let mut done = 0;
    while done < total {
        monitor.check()?;
        let damaged = |problem: &dyn std::fmt::Display| {
            whole(&format!("record {done} of {total} and those after it: {problem}; it may be cut off"))
        };
        let most = (BYTES_PER_PIECE / piece.record_len().max(1) as u64).clamp(1, POINTS_PER_PIECE);
        let found =
            reader.fill_points(most.min(total - done), &mut piece).map_err(|error| damaged(&error))?;
        if found == 0 {
            return Err(damaged(&"the data end"));
        }
        let records = piece.raw_bytes().chunks_exact(piece.record_len().max(1));
        for ((x, y), (z, record)) in piece.x().zip(piece.y()).zip(piece.z().zip(records)) {
            let (withheld, class) = match (record.get(15), record.get(16)) {
                (Some(flags), Some(class)) if is_extended => (flags & 0b100 != 0, *class),
                (Some(class), _) => (class & 0x80 != 0, class & 0x1f),
                _ => (false, 0),
            };
            if withheld || NOISE.contains(&class) {
                continue;
            }
            for coordinate in [x, y, z] {
                in_range(coordinate).map_err(|expected| damaged(&format!("expected {expected}")))?;
            }
            make_room(&points, points.capacity(), held, monitor)?;
            points.push(DVec3::new(x, y, z));
        }
        done += found;
        monitor.advance(Phase::Read, done, Some(total));
    }
    if points.is_empty() {
        return Err(whole(&format!(
            "none of its {total} records is a point that is not withheld and no noise"
        )));
    }
    Ok(points)
}

/// What the crate would believe: where the points begin, and how many chunks there are.
fn check_header(bytes: &[u8]) -> Result<(), InputError> {
    const SHORTEST: usize = 227;
    if bytes.len() < SHORTEST {
        return Err(whole("it ends within its header; it is cut off"));
    }
    let start = number(bytes, 96, 4).unwrap_or(u64::MAX);
    if start > bytes.len() as u64 {
        return Err(whole("its points begin behind its end; it is cut off"));
    }
    if start < SHORTEST as u64 {
        return Err(whole("its points begin within its header; it is damaged"));
    }
    let is_compressed = bytes[104] & 0xc0 != 0;
    if !is_compressed {
        // A record of each point, whatever the crate would make room for.
        let record = number(bytes, 105, 2).unwrap_or(0);
        let is_newest = bytes[25] >= 4;
        let long = if is_newest { number(bytes, 247, 8).unwrap_or(0) } else { 0 };
        let points = long.max(number(bytes, 107, 4).unwrap_or(0));
        if record.saturating_mul(points) > bytes.len() as u64 - start {
            return Err(whole(&format!("it announces {points} points and has fewer; it is cut off")));
        }
        return Ok(());
    }
    let end = bytes.len() as u64 - 8;
    let table = number(bytes, start, 8)
        .map(|at| if at == u64::MAX { number(bytes, end, 8).unwrap_or(at) } else { at });
    let chunks = table.and_then(|at| number(bytes, at.checked_add(4)?, 4));
    match chunks {
        // A chunk has a byte at least.
        Some(chunks) if chunks <= bytes.len() as u64 => Ok(()),
        _ => Err(whole("its table of chunks is missing or damaged; it may be cut off")),
    }
}

/// A little-endian number of some bytes.
fn number(bytes: &[u8], at: u64, count: usize) -> Option<u64> {
    let at = usize::try_from(at).ok()?;
    let part = bytes.get(at..at.checked_add(count)?)?;
    Some(part.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
}

fn whole(problem: &str) -> InputError {
    InputError::Whole { format: "LAS", problem: problem.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    /// LAS 1.2, format 0, by the format's table: written byte by byte. Each record: raw x y z, and the byte of its class.
    fn file(records: &[([i32; 3], u8)]) -> Vec<u8> {
        let mut bytes = b"LASF".to_vec();
        bytes.resize(24, 0);
        bytes.extend([1, 2]);
        bytes.resize(94, b' ');
        bytes[26..94].fill(0);
        bytes.extend(227_u16.to_le_bytes()); // header
        bytes.extend(227_u32.to_le_bytes()); // where points begin
        bytes.extend(0_u32.to_le_bytes()); // variable length records
        bytes.push(0); // format
        bytes.extend(20_u16.to_le_bytes());
        bytes.extend((records.len() as u32).to_le_bytes());
        bytes.extend([0; 20]);
        let (scale, offset) = ([0.001_f64; 3], [446_000.0_f64, 5_428_000.0, 0.0]);
        scale.iter().chain(&offset).for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes.extend([0; 48]);
        assert_eq!(bytes.len(), 227);
        for (raw, class) in records {
            for number in raw {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend([0, 0, 0b1001, *class, 0, 0, 0, 0]);
        }
        bytes
    }

    #[test]
    fn surveyed_points_keep_their_millimetres_and_noise_is_left_out() {
        let records = [([512, 7, 312_250], 2), ([1, 2, 3], 7), ([4, 5, 6], 0x80), ([-1000, 1000, 0], 5)];
        let points = read_las(&file(&records), &Quiet).unwrap();
        assert_eq!(points.len(), 2);
        assert!(points[0].distance(DVec3::new(446_000.512, 5_428_000.007, 312.25)) < 1e-8);
        assert!(points[1].distance(DVec3::new(445_999.0, 5_428_001.0, 0.0)) < 1e-8);
    }

    #[test]
    fn damage_is_said() {
        let whole = file(&[([1, 2, 3], 2); 40]);
        for length in [0, 4, 100, 226, 227, 240, whole.len() - 1] {
            let error = read_las(&whole[..length], &Quiet).unwrap_err().to_string();
            assert!(error.starts_with("reading LAS: "), "{error}");
        }
        let noise = read_las(&file(&[([1, 2, 3], 7)]), &Quiet).unwrap_err().to_string();
        assert!(noise.contains("none of its 1 records"), "{noise}");
        // Any byte may be anything.
        for at in 0..whole.len() {
            for to in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] = to;
                if let Ok(points) = read_las(&bytes, &Quiet) {
                    assert!(points.iter().all(|p| p.is_finite()));
                }
            }
        }
    }

    #[test]
    fn compressed_points_are_the_same() {
        let records: Vec<_> = (0..3000).map(|i| ([i * 7 % 1000, i * 3, i - 1500], 2)).collect();
        let plain = file(&records);
        let mut reader = Reader::new(Cursor::new(plain.clone())).unwrap();
        let mut builder = las::Builder::from(reader.header().clone());
        builder.point_format.is_compressed = true;
        let mut writer = las::Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
        for point in reader.read_all().unwrap().points() {
            writer.write_point(point.unwrap()).unwrap();
        }
        writer.close().unwrap();
        let packed = writer.into_inner().unwrap().into_inner();
        assert!(packed.len() < plain.len() / 2);
        assert_eq!(read_las(&packed, &Quiet).unwrap(), read_las(&plain, &Quiet).unwrap());
        for i in 0..2000_usize {
            let mut bytes = packed.clone();
            let at = i * 7919 % bytes.len();
            bytes[at] ^= 1 << (i % 8);
            let _ = read_las(&bytes, &Quiet);
            let _ = read_las(&packed[..at], &Quiet);
        }
    }
}
