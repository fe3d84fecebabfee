//! Reads `GeoTIFF` (OGC 19-008r4), by the crate tiff: heights of a canopy above ground on a square grid, as airborne surveys
//! have them.
//!
//! The first image counts, of one band of whole numbers or floats; overviews and masks behind it are passed over. Where
//! cells lie follows from the pixels' scale and a tie point, or from a matrix without rotation. Cells of `GDAL_NODATA`, NaN,
//! and infinities have no height. Pieces are decoded one by one: what is held is what is kept.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::DVec3;
use tiff::TiffError;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

use super::{Cloud, InputError, MapUnits, READING, READING_ADVICE, in_range};
use crate::memory::{bytes_grown, bytes_of};
use crate::monitor::{Monitor, Phase};

/// What such files open with: byte orders, and the numbers of TIFF and of `BigTIFF`.
const OPENINGS: [&[u8]; 4] = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];

/// Keys of the directory (`GeoTIFF`, annex B) and what counts of their values.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
const RASTER_TYPE: u16 = 1025;
const PIXEL_IS_POINT: u16 = 2;

/// The most bytes of a piece; surveys have some hundred kilobytes.
const MOST_PIECE_BYTES: usize = 256 << 20;

/// Whether bytes are those of a TIFF file that says where its pixels lie on the ground.
pub(super) fn is_geotiff(bytes: &[u8]) -> bool {
    let is_placed = || {
        let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?;
        let mut has = |tag| decoder.find_tag(tag).is_ok_and(|found| found.is_some());
        Some(has(Tag::ModelPixelScaleTag) || has(Tag::ModelTransformationTag))
    };
    let has_opening = OPENINGS.iter().any(|opening| bytes.starts_with(opening));
    has_opening && catch_unwind(AssertUnwindSafe(is_placed)).is_ok_and(|placed| placed == Some(true))
}

/// Reads the cells that have a height, as points at their middles; Z is up.
///
/// # Errors
/// [`InputError`]: a file that is none or is cut off, several bands, cells in degrees, cells that are not square or turned,
/// no heights at all; no memory; cancelled.
pub fn read_geotiff(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    // The crate is careful, but says of nothing that it cannot panic.
    catch_unwind(AssertUnwindSafe(|| read_all(bytes, monitor)))
        .unwrap_or_else(|_| Err(whole("its data are damaged; export it anew")))
}

fn read_all(bytes: &[u8], monitor: &dyn Monitor) -> Result<Cloud, InputError> {
    let broken = |error: TiffError| whole(&advised(&error));
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(broken)?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MOST_PIECE_BYTES;
    decoder = decoder.with_limits(limits);
    let (columns, rows) = decoder.dimensions().map_err(broken)?;
    let bands = decoder.find_tag_unsigned::<u16>(Tag::SamplesPerPixel).map_err(broken)?.unwrap_or(1);
    if bands != 1 {
        return Err(whole(&format!(
            "it has {bands} bands; heights of a canopy are one: export that band alone"
        )));
    }
    let place = Placing::read(&mut decoder)?;
    let no_data = no_data(&mut decoder);
    let (wide, high) = decoder.chunk_dimensions();
    if wide == 0 || high == 0 {
        return Err(whole("its pieces have no size; it is damaged"));
    }
    let across = columns.div_ceil(wide);
    let pieces = u64::from(across) * u64::from(rows.div_ceil(high));
    let mut positions: Vec<DVec3> = Vec::new();
    for piece in 0..pieces {
        monitor.check()?;
        monitor.advance(Phase::Read, piece, Some(pieces));
        let number = u32::try_from(piece).map_err(|_| whole("it has more pieces than any file"))?;
        let piece_bytes = bytes_of::<f64>(1).saturating_mul(u64::from(wide) * u64::from(high));
        monitor.admit(READING, bytes_of::<DVec3>(positions.capacity()) + piece_bytes, READING_ADVICE)?;
        let data = decoder
            .read_chunk(number)
            .map_err(|error| whole(&format!("piece {piece} of {pieces}: {}", advised(&error))))?;
        let (data_wide, data_high) = decoder.chunk_data_dimensions(number);
        let (left, top) = (number % across * wide, number / across * high);
        for row in 0..data_high {
            for column in 0..data_wide {
                let at = row as usize * data_wide as usize + column as usize;
                let height = value(&data, at).ok_or_else(|| {
                    whole(&format!(
                        "piece {piece} of {pieces} has fewer cells than it announces; it is damaged"
                    ))
                })?;
                if !height.is_finite() || no_data.is_some_and(|none| is_none(height, none)) {
                    continue;
                }
                let height = in_range(height)
                    .map_err(|expected| whole(&format!("a cell of {height}: expected {expected}")))?;
                if positions.len() == positions.capacity() {
                    let bytes = bytes_grown::<DVec3>(positions.len() + 1).saturating_add(piece_bytes);
                    monitor.admit(READING, bytes, READING_ADVICE)?;
                }
                positions.push(place.of(left + column, top + row).extend(height));
            }
        }
    }
    if positions.is_empty() {
        return Err(whole(&format!("none of its {columns} × {rows} cells has a height")));
    }
    let directory = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
    let units = MapUnits::of_keys(&directory);
    Ok(Cloud { positions, cell: Some(place.cell), units, ..Cloud::default() })
}

/// What is wrong, and what to do.
fn advised(error: &TiffError) -> String {
    match error {
        TiffError::UnsupportedError(_) => {
            format!("{error}; pack it otherwise (gdal_translate -co COMPRESS=DEFLATE)")
        }
        _ => format!("{error}; it may be cut off"),
    }
}

/// Where cells lie.
struct Placing {
    /// The middle of the first cell.
    first: glam::DVec2,
    cell: f64,
}

impl Placing {
    fn of(&self, column: u32, row: u32) -> glam::DVec2 {
        self.first + self.cell * glam::DVec2::new(f64::from(column), -f64::from(row))
    }

    fn read(decoder: &mut Decoder<Cursor<&[u8]>>) -> Result<Self, InputError> {
        if key(decoder, MODEL_TYPE) == Some(GEOGRAPHIC) {
            return Err(whole(
                "its cells are in degrees; reproject it to metres first (gdalwarp -t_srs, say to UTM)",
            ));
        }
        let numbers = |decoder: &mut Decoder<_>, tag| decoder.get_tag_f64_vec(tag).unwrap_or_default();
        let scale = numbers(decoder, Tag::ModelPixelScaleTag);
        let tie = numbers(decoder, Tag::ModelTiepointTag);
        let matrix = numbers(decoder, Tag::ModelTransformationTag);
        // The corner of the first pixel, and how far the next column and row are.
        let (corner, across, down) = match (&scale[..], &tie[..], &matrix[..]) {
            ([across, down, ..], [column, row, _, x, y, _, ..], _) => {
                (glam::DVec2::new(x - column * across, y + row * down), *across, *down)
            }
            (_, _, [across, 0.0, _, x, 0.0, down, _, y, ..]) => (glam::DVec2::new(*x, *y), *across, -down),
            (_, _, [_, _, _, _, ..]) => {
                return Err(whole("its cells are turned; resample it to the north first (gdalwarp)"));
            }
            _ => {
                return Err(whole("it does not say where its cells lie (ModelPixelScale and ModelTiepoint)"));
            }
        };
        let is_square = across > 0.0 && (across - down).abs() <= 1e-6 * across;
        if !is_square || in_range(across).is_err() {
            return Err(whole(&format!(
                "its cells are {across} × {down}; resample it to square ones first (gdalwarp -tr)"
            )));
        }
        for x in corner.to_array() {
            in_range(x).map_err(|expected| whole(&format!("its corner at {x}: expected {expected}")))?;
        }
        let is_point = key(decoder, RASTER_TYPE) == Some(PIXEL_IS_POINT);
        let middle = if is_point { 0.0 } else { 0.5 * across };
        Ok(Self { first: corner + glam::DVec2::new(middle, -middle), cell: across })
    }
}

/// The value of a key of the directory that stands there itself.
fn key(decoder: &mut Decoder<Cursor<&[u8]>>, id: u16) -> Option<u16> {
    let directory = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).ok()?;
    let entries = directory.chunks_exact(4).skip(1);
    entries.into_iter().find(|entry| entry[0] == id && entry[1] == 0).map(|entry| entry[3])
}

fn no_data(decoder: &mut Decoder<Cursor<&[u8]>>) -> Option<f64> {
    let text = decoder.get_tag_ascii_string(Tag::GdalNodata).ok()?;
    text.trim_matches(['\0', ' ', '\n']).parse().ok()
}

/// Whether a height is the one that stands for none; single precision keeps less of it than the text says.
fn is_none(height: f64, none: f64) -> bool {
    height == none || height as f32 == none as f32
}

fn value(data: &DecodingResult, at: usize) -> Option<f64> {
    match data {
        DecodingResult::U8(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::U16(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::U32(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::U64(all) => all.get(at).map(|&x| x as f64),
        DecodingResult::I8(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::I16(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::I32(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::I64(all) => all.get(at).map(|&x| x as f64),
        DecodingResult::F16(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::F32(all) => all.get(at).map(|&x| x.into()),
        DecodingResult::F64(all) => all.get(at).copied(),
    }
}

fn whole(problem: &str) -> InputError {
    InputError::Whole { format: "GeoTIFF", problem: problem.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{InputKind, sniff};
    use crate::monitor::Quiet;

    /// A small file of the crate's own, with these tags.
    fn small(scale: &[f64], tie: &[f64], keys: &[u16]) -> Vec<u8> {
        use tiff::encoder::{TiffEncoder, colortype::Gray16};
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
        let mut image = encoder.new_image::<Gray16>(3, 2).unwrap();
        let tags = image.encoder();
        if !scale.is_empty() {
            tags.write_tag(Tag::ModelPixelScaleTag, scale).unwrap();
        }
        tags.write_tag(Tag::ModelTiepointTag, tie).unwrap();
        let directory: Vec<u16> = [1, 1, 0, keys.len() as u16 / 2]
            .into_iter()
            .chain(keys.chunks(2).flat_map(|key| [key[0], 0, 1, key[1]]))
            .collect();
        tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..]).unwrap();
        image.write_data(&[1, 2, 3, 4, 5, 6]).unwrap();
        bytes.into_inner()
    }

    const TIE: [f64; 6] = [0.0, 0.0, 0.0, 100.0, 50.0, 0.0];

    #[test]
    fn a_tie_point_is_a_corner_or_a_middle() {
        let first =
            |keys: &[u16]| read_geotiff(&small(&[2.0, 2.0, 0.0], &TIE, keys), &Quiet).unwrap().positions[0];
        assert_eq!(sniff(&small(&[2.0, 2.0, 0.0], &TIE, &[]), "a.png.tif"), Ok(InputKind::HeightGrid));
        assert_eq!(first(&[]), DVec3::new(101.0, 49.0, 1.0));
        assert_eq!(first(&[MODEL_TYPE, 1, RASTER_TYPE, PIXEL_IS_POINT]), DVec3::new(100.0, 50.0, 1.0));
        // Of another pixel: the second column, the third row.
        let tie = [1.0, 2.0, 0.0, 100.0, 50.0, 0.0];
        let cloud = read_geotiff(&small(&[2.0, 2.0, 0.0], &tie, &[]), &Quiet).unwrap();
        assert_eq!(cloud.positions[0], DVec3::new(99.0, 53.0, 1.0));
    }

    #[test]
    fn a_map_in_feet_says_so_and_what_is_packed_in_unknown_ways_is_not_cut_off() {
        let units = |keys: &[u16]| read_geotiff(&small(&[2.0, 2.0, 0.0], &TIE, keys), &Quiet).unwrap().units;
        assert_eq!(units(&[MODEL_TYPE, 1, 3076, 9002]).and_then(|units| units.scale()), Some(0.3048));
        assert_eq!(units(&[MODEL_TYPE, 1, 3076, 9001]), None);
        // The entry of the directory for Compression (259), a short, of one value: 1, none. 50000 is Zstandard.
        let mut bytes = small(&[2.0, 2.0, 0.0], &TIE, &[]);
        let entry = [3, 1, 3, 0, 1, 0, 0, 0, 1, 0];
        let at = bytes.windows(entry.len()).position(|window| window == entry).unwrap();
        bytes[at + 8..at + 10].copy_from_slice(&50_000_u16.to_le_bytes());
        let said = read_geotiff(&bytes, &Quiet).unwrap_err().to_string();
        assert!(said.contains("COMPRESS=DEFLATE") && !said.contains("cut off"), "{said}");
    }

    #[test]
    fn what_cannot_be_placed_is_said() {
        for (scale, tie, keys, said) in [
            (&[2.0, 3.0, 0.0][..], &TIE[..], &[][..], "its cells are 2 × 3"),
            (&[0.0, 0.0, 0.0], &TIE, &[], "its cells are 0 × 0"),
            (&[1e-5, 1e-5, 0.0], &TIE, &[MODEL_TYPE, GEOGRAPHIC], "in degrees"),
            (&[2.0, 2.0, 0.0], &TIE[..3], &[], "does not say where"),
        ] {
            let error = read_geotiff(&small(scale, tie, keys), &Quiet).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        // A picture is none.
        let picture = small(&[], &TIE, &[]);
        let error = sniff(&picture, "a.tif").unwrap_err().to_string();
        assert!(error.contains("TIFF picture"), "{error}");
    }

    #[test]
    fn damage_is_said() {
        let whole = small(&[2.0, 2.0, 0.0], &TIE, &[MODEL_TYPE, 1]);
        let ends = (0..whole.len()).filter(|&end| read_geotiff(&whole[..end], &Quiet).is_ok());
        assert_eq!(ends.collect::<Vec<usize>>(), Vec::<usize>::new());
        for at in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[at] ^= 1 << bit;
                let _ = sniff(&bytes, "a.tif");
                if let Ok(cloud) = read_geotiff(&bytes, &Quiet) {
                    assert!(cloud.positions.iter().all(|p| p.is_finite()));
                }
            }
        }
    }
}
