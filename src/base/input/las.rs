//! Reads LAS 1.0 to 1.4 and LAZ, by the crate las: points of surveys and scanners.
//!
//! What the file itself says is no point is left out: records that are withheld, and the classes 7 (low point) and 18 (high
//! noise). Class 2 is ground. Coordinates are raw · scale + offset in `f64`, so that those of a survey keep their millimetres.
//!
//! The crate believes a header's number of chunks, and indexes by what it decompresses; the number is held against the file
//! before, and what panics on damaged data becomes an error.

use std::io::{Cursor, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::DVec3;
use las::{PointDataBuilder, Reader};

use super::cloud::is_read;
use super::gather::Gathering;
use super::{Cloud, InputError, MapUnits, READING, READING_ADVICE, in_range};
use crate::memory::bytes_of;
use crate::monitor::{Monitor, Phase};

/// Points that are decompressed at once.
const POINTS_PER_PIECE: u64 = 1 << 16;
/// And bytes of their records, of which some files claim many.
const BYTES_PER_PIECE: u64 = 1 << 24;

/// Classes of the format's table that are noise.
const NOISE: [u8; 2] = [7, 18];

/// The class of the ground.
const GROUND: u8 = 2;

/// Reads the points of a LAS or LAZ file; Z is up. Extra bytes whose names say so tell the trees apart (`treeID`,
/// `PredInstance` …).
///
/// # Errors
/// [`InputError`]: a header that is none or announces more than the file holds, damaged data with the number of the
/// record, no points; no memory; cancelled.
pub fn read_las(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    thin_las(bytes, None, monitor)
}

/// The same; of each cube with sides `cube` one point is kept.
pub(super) fn thin_las(bytes: &[u8], cube: Option<f64>, monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    // The crate's reader owns what it reads.
    let held = bytes_of::<u8>(bytes.len());
    monitor.admit(READING, held, READING_ADVICE)?;
    read_held(Cursor::new(bytes.to_vec()), held, cube, monitor)
}

/// The same of a stream, which is never held whole.
pub(super) fn stream_las(
    stream: impl Read + Seek + Send + Sync + 'static,
    cube: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Cloud, InputError> {
    read_held(stream, 0, cube, monitor)
}

fn read_held(
    mut stream: impl Read + Seek + Send + Sync + 'static,
    held: u64,
    cube: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Cloud, InputError> {
    check_header(&mut stream)?;
    let read = || read_all(stream, Gathering::new([], cube, monitor).holding(held));
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(whole("its data are damaged; export it anew")))
}

fn read_all(
    stream: impl Read + Seek + Send + Sync + 'static,
    mut points: Gathering<'_>,
) -> Result<Cloud, InputError> {
    let monitor = points.monitor();
    let mut reader = Reader::new(stream).map_err(|error| whole(&format!("its header: {error}")))?;
    let total = reader.header().number_of_points();
    // Of each record the byte of flags and the class: see the format's tables of point records.
    let is_extended = reader.header().point_format().is_extended;
    let extra = ExtraBytes::of(reader.header());
    points.set_columns(extra.iter().map(|extra| extra.name.clone()));
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
            let (point, value) = (DVec3::new(x, y, z), |column: usize| extra[column].value(record));
            if class == GROUND {
                points.push_ground(point, value)?;
            } else {
                points.push(point, value)?;
            }
        }
        done += found;
        monitor.advance(Phase::Read, done, Some(total));
    }
    match (total, points.came()) {
        (0, _) => Err(whole("it holds no points: its header announces 0 records; export it anew")),
        (_, 0) => Err(whole(&format!("all of its {total} records are withheld or noise (classes 7 and 18)"))),
        _ => Ok(Cloud { units: units(reader.header()), is_z_up: true, ..points.finish() }),
    }
}

/// The units that records of the coordinate system name; its text counts more than its keys.
fn units(header: &las::Header) -> Option<MapUnits> {
    let all = || header.vlrs().iter().chain(header.evlrs()).filter(|vlr| vlr.user_id == "LASF_Projection");
    let data = |id: u16| all().find(|vlr| vlr.record_id == id).map(|vlr| &vlr.data[..]);
    let keys = |bytes: &[u8]| {
        let numbers = bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
        MapUnits::of_keys(&numbers.collect::<Vec<u16>>())
    };
    match data(2112) {
        Some(text) => MapUnits::of_text(&String::from_utf8_lossy(text)),
        None => data(34735).and_then(keys),
    }
}

/// One of the further values of each record, which the format calls extra bytes and describes in a record of its own
/// (LAS 1.4, table 24).
struct ExtraBytes {
    name: String,
    /// The number of its type in the format's table, 1 to 10.
    kind: u8,
    /// Where it ends, from the end of the record.
    from_end: usize,
    no_data: Option<f64>,
    scale: f64,
    offset: f64,
}

impl ExtraBytes {
    /// Bytes of a description.
    const ROW: usize = 192;
    /// Bytes of the types 1 to 10.
    const SIZES: [usize; 10] = [1, 1, 2, 2, 4, 4, 8, 8, 4, 8];

    /// Those that tell trees apart.
    fn of(header: &las::Header) -> Vec<Self> {
        let total = usize::from(header.point_format().extra_bytes);
        let mut all = header.vlrs().iter().chain(header.evlrs());
        let Some(table) = all.find(|vlr| vlr.user_id == "LASF_Spec" && vlr.record_id == 4) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        let mut at = 0;
        for row in table.data.chunks_exact(Self::ROW) {
            let (kind, options) = (row[2], row[3]);
            let bytes = match kind {
                0 => usize::from(options),
                1..=10 => Self::SIZES[usize::from(kind) - 1],
                // The old pairs and triples.
                11..=20 => 2 * Self::SIZES[usize::from(kind) - 11],
                21..=30 => 3 * Self::SIZES[usize::from(kind) - 21],
                _ => break,
            };
            if at + bytes > total {
                break;
            }
            let name = String::from_utf8_lossy(&row[4..36]);
            let name = name.trim_end_matches('\0').trim();
            if (1..=10).contains(&kind) && is_read(name) {
                let number = |at: usize| row[at..at + 8].try_into().map_or(0.0, f64::from_le_bytes);
                let has = |bit: u8| options & (1 << bit) != 0;
                // It is written in the widest type of its kind.
                let wide = match kind {
                    1 | 3 | 5 | 7 => 7,
                    2 | 4 | 6 | 8 => 8,
                    _ => 10,
                };
                found.push(Self {
                    name: name.to_owned(),
                    kind,
                    from_end: total - at,
                    no_data: has(0).then(|| decoded(wide, &row[40..48])),
                    scale: if has(3) { number(112) } else { 1.0 },
                    offset: if has(4) { number(136) } else { 0.0 },
                });
            }
            at += bytes;
        }
        found
    }

    /// Its value in a record; NaN where there is none.
    fn value(&self, record: &[u8]) -> f64 {
        let start = record.len().saturating_sub(self.from_end);
        let raw = decoded(self.kind, &record[start..]);
        if self.no_data == Some(raw) { f64::NAN } else { raw * self.scale + self.offset }
    }
}

/// A number of one of the types 1 to 10 at the beginning of some bytes; NaN where these end before.
fn decoded(kind: u8, bytes: &[u8]) -> f64 {
    fn first<const N: usize>(bytes: &[u8]) -> Option<[u8; N]> {
        bytes.first_chunk().copied()
    }
    let value = match kind {
        1 => first(bytes).map(|[byte]| f64::from(byte)),
        2 => first(bytes).map(|b| f64::from(i8::from_le_bytes(b))),
        3 => first(bytes).map(|b| f64::from(u16::from_le_bytes(b))),
        4 => first(bytes).map(|b| f64::from(i16::from_le_bytes(b))),
        5 => first(bytes).map(|b| f64::from(u32::from_le_bytes(b))),
        6 => first(bytes).map(|b| f64::from(i32::from_le_bytes(b))),
        7 => first(bytes).map(|b| u64::from_le_bytes(b) as f64),
        8 => first(bytes).map(|b| i64::from_le_bytes(b) as f64),
        9 => first(bytes).map(|b| f64::from(f32::from_le_bytes(b))),
        _ => first(bytes).map(f64::from_le_bytes),
    };
    value.unwrap_or(f64::NAN)
}

/// What the crate would believe: where the points begin, and how many chunks there are. Leaves the stream at its beginning.
fn check_header(stream: &mut (impl Read + Seek)) -> Result<(), InputError> {
    const SHORTEST: usize = 227;
    /// Where headers of the newest version have the number of points.
    const NEWEST: usize = 255;
    let failed = |error: std::io::Error| whole(&error.to_string());
    let length = stream.seek(SeekFrom::End(0)).map_err(failed)?;
    stream.rewind().map_err(failed)?;
    let mut header = Vec::new();
    stream.by_ref().take(NEWEST as u64).read_to_end(&mut header).map_err(failed)?;
    if header.len() < SHORTEST {
        return Err(whole("it ends within its header; it is cut off"));
    }
    let start = little_endian(&header[96..100]);
    if start > length {
        return Err(whole("its points begin behind its end; it is cut off"));
    }
    if start < SHORTEST as u64 {
        return Err(whole("its points begin within its header; it is damaged"));
    }
    let is_compressed = header[104] & 0xc0 != 0;
    if is_compressed {
        let mut number = |at: u64, bytes: usize| {
            let mut number = [0; 8];
            let is_there = at.checked_add(bytes as u64).is_some_and(|end| end <= length);
            let read = stream.seek(SeekFrom::Start(at)).and_then(|_| stream.read_exact(&mut number[..bytes]));
            (is_there && read.is_ok()).then(|| little_endian(&number[..bytes]))
        };
        let table = match number(start, 8) {
            Some(u64::MAX) => number(length - 8, 8),
            table => table,
        };
        let chunks = table.and_then(|at| number(at.checked_add(4)?, 4));
        // A chunk has a byte at least.
        if chunks.is_none_or(|chunks| chunks > length) {
            return Err(whole("its table of chunks is missing or damaged; it may be cut off"));
        }
    } else {
        // A record of each point, whatever the crate would make room for.
        let record = little_endian(&header[105..107]);
        let is_newest = header[25] >= 4;
        let long = if is_newest { header.get(247..NEWEST).map_or(0, little_endian) } else { 0 };
        let points = long.max(little_endian(&header[107..111]));
        if record.saturating_mul(points) > length - start {
            return Err(whole(&format!("it announces {points} points and has fewer; it is cut off")));
        }
    }
    stream.rewind().map_err(failed)
}

fn little_endian(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
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
        let points = read_las(&file(&records), &Quiet).unwrap().positions;
        assert_eq!(points.len(), 2);
        assert!(points[0].distance(DVec3::new(446_000.512, 5_428_000.007, 312.25)) < 1e-8);
        assert!(points[1].distance(DVec3::new(445_999.0, 5_428_001.0, 0.0)) < 1e-8);
    }

    type Description<'a> = (&'a str, u8, u8, [u8; 8], f64, f64);

    /// [`file`] with extra bytes behind each record, described by rows of name, type, options, `no_data`, scale and offset.
    fn with_extra(rows: &[Description<'_>], records: &[Vec<u8>]) -> Vec<u8> {
        let plain = file(&vec![([1, 2, 3], 2); records.len()]);
        let mut table = Vec::new();
        for (name, kind, options, no_data, scale, offset) in rows {
            let mut row = vec![0, 0, *kind, *options];
            row.extend(name.bytes());
            row.resize(40, 0);
            row.extend(no_data);
            row.resize(112, 0);
            row.extend(scale.to_le_bytes());
            row.resize(136, 0);
            row.extend(offset.to_le_bytes());
            row.resize(192, 0);
            table.extend(row);
        }
        let mut bytes = plain[..227].to_vec();
        bytes.extend([0, 0]);
        bytes.extend(b"LASF_Spec\0\0\0\0\0\0\0");
        bytes.extend(4_u16.to_le_bytes());
        bytes.extend((table.len() as u16).to_le_bytes());
        bytes.extend([0; 32]);
        bytes.extend(table);
        let start = bytes.len() as u32;
        bytes[96..100].copy_from_slice(&start.to_le_bytes());
        bytes[100..104].copy_from_slice(&1_u32.to_le_bytes());
        bytes[105..107].copy_from_slice(&(20 + records[0].len() as u16).to_le_bytes());
        for (record, extra) in plain[227..].chunks_exact(20).zip(records) {
            bytes.extend(record);
            bytes.extend(extra);
        }
        bytes
    }

    #[test]
    fn extra_bytes_tell_trees_apart() {
        // Undocumented bytes, an old pair and a colour before it; then its own number of no tree.
        let none = i64::from(-7_i16).to_le_bytes();
        let rows = [
            ("", 0, 3, [0; 8], 0.0, 0.0),
            ("tree pair", 13, 0, [0; 8], 0.0, 0.0),
            ("red", 3, 0, [0; 8], 0.0, 0.0),
            ("PredInstance_SAT", 4, 1, none, 0.0, 0.0),
            ("treeID", 9, 0b1_1000, [0; 8], 2.0, 1.0),
        ];
        let record = |instance: i16, tree: f32| {
            let mut bytes = vec![9; 3 + 4 + 2];
            bytes.extend(instance.to_le_bytes());
            bytes.extend(tree.to_le_bytes());
            bytes
        };
        let records = [record(5, 1.0), record(-7, 2.0), record(300, f32::NAN), record(-1, -1.0)];
        let cloud = read_las(&with_extra(&rows, &records), &Quiet).unwrap();
        let columns: Vec<_> = cloud.trees.iter().map(|column| (&*column.name, &column.numbers[..])).collect();
        assert_eq!(columns, [("PredInstance_SAT", &[5, 0, 300, 0][..]), ("treeID", &[3, 5, 0, 0][..])]);
        // A table that says more than records have.
        let short = [vec![9; 9], vec![9; 9]];
        assert_eq!(read_las(&with_extra(&rows, &short), &Quiet).unwrap().trees, []);
    }

    #[test]
    fn class_2_is_ground_and_of_no_tree() {
        let record = |at: i32, class: u8| ([at, 0, 0], class);
        let some = file(&[record(1, 5), record(2, 2), record(3, 0b10_0000 | 2), record(4, 1)]);
        for (bytes, marks) in [
            (&some, Some(vec![false, true, true, false])),
            (&file(&[record(1, 5), record(2, 4)]), None),
            // What is everywhere tells nothing.
            (&file(&[record(1, 2), record(2, 2)]), None),
        ] {
            assert_eq!(read_las(bytes, &Quiet).unwrap().is_ground, marks);
        }
        let thin = thin_las(&some, Some(0.0004), &Quiet).unwrap();
        assert_eq!(thin.is_ground, Some(vec![false, true, true, false]));
        assert_eq!(read_las(&some, &Quiet).unwrap().thin(0.0004, &Quiet).unwrap(), thin);
        let mut numbered = with_extra(&[("treeID", 1, 0, [0; 8], 1.0, 0.0)], &[vec![1], vec![1], vec![2]]);
        // The class of the first: by its place from the end of the file.
        let class = numbered.len() - 3 * 21 + 15;
        numbered[class] = 5;
        assert_eq!(read_las(&numbered, &Quiet).unwrap().trees[0].numbers, [1, 0, 0]);
    }

    /// [`file`] with a record of variable length of this user, number and data.
    fn with_record(id: u16, data: &[u8]) -> Vec<u8> {
        let plain = file(&[([1, 2, 3], 1), ([2, 2, 3], 1)]);
        let mut bytes = plain[..227].to_vec();
        bytes.extend([0, 0]);
        bytes.extend(b"LASF_Projection\0");
        bytes.extend(id.to_le_bytes());
        bytes.extend((data.len() as u16).to_le_bytes());
        bytes.extend([0; 32]);
        bytes.extend(data);
        let start = bytes.len() as u32;
        bytes[96..100].copy_from_slice(&start.to_le_bytes());
        bytes[100..104].copy_from_slice(&1_u32.to_le_bytes());
        bytes.extend(&plain[227..]);
        bytes
    }

    #[test]
    fn feet_of_the_coordinate_system_are_told() {
        let keys: Vec<u8> =
            [1_u16, 1, 0, 1, 3076, 0, 1, 9003].iter().flat_map(|number| number.to_le_bytes()).collect();
        let text = br#"PROJCS["Maryland",UNIT["foot",0.3048]]"#;
        let scale = |bytes: &[u8]| read_las(bytes, &Quiet).unwrap().units.and_then(|units| units.scale());
        assert_eq!(scale(&with_record(34735, &keys)), Some(1200.0 / 3937.0));
        assert_eq!(scale(&with_record(2112, text)), Some(0.3048));
        assert_eq!(scale(&with_record(2112, br#"PROJCS["Lambert",UNIT["metre",1]]"#)), None);
        assert_eq!(scale(&file(&[([1, 2, 3], 1)])), None);
    }

    #[test]
    fn damage_is_said() {
        let whole = file(&[([1, 2, 3], 2); 40]);
        for length in [0, 4, 100, 226, 227, 240, whole.len() - 1] {
            let error = read_las(&whole[..length], &Quiet).unwrap_err().to_string();
            assert!(error.starts_with("reading LAS: "), "{error}");
        }
        let noise = read_las(&file(&[([1, 2, 3], 7)]), &Quiet).unwrap_err().to_string();
        assert!(noise.contains("all of its 1 records"), "{noise}");
        let none = read_las(&file(&[]), &Quiet).unwrap_err().to_string();
        assert!(none.contains("it holds no points"), "{none}");
        // Any byte may be anything.
        for at in 0..whole.len() {
            for to in [0, 1, 0x7f, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] = to;
                if let Ok(cloud) = read_las(&bytes, &Quiet) {
                    assert!(cloud.positions.iter().all(|p| p.is_finite()));
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
        for (bytes, cube) in [(&packed, None), (&packed, Some(0.05)), (&plain, Some(0.05))] {
            let streamed = stream_las(Cursor::new(bytes.clone()), cube, &Quiet).unwrap();
            assert_eq!(streamed, thin_las(bytes, cube, &Quiet).unwrap());
            assert_eq!(streamed.positions.len() < 2500, cube.is_some(), "{}", streamed.positions.len());
        }
        for i in 0..2000_usize {
            let mut bytes = packed.clone();
            let at = i * 7919 % bytes.len();
            bytes[at] ^= 1 << (i % 8);
            let _ = read_las(&bytes, &Quiet);
            let _ = read_las(&packed[..at], &Quiet);
        }
    }
}
