//! Numbers out of buffers. Each length is held against the bytes that are there before anything is reserved.

use glam::{Vec2, Vec3};
use linden_base::monitor::Monitor;

use super::document::{Accessor, BufferView, Document};
use super::meshopt::{Unpacked, unpack};
use super::{ADVICE, READING, ReadError, broken};

/// A document with the content of its buffers.
pub struct Buffers<'a> {
    pub document: &'a Document,
    pub sources: &'a [Option<Vec<u8>>],
    /// By view: its bytes, where it was in fewer.
    unpacked: Vec<Option<Vec<u8>>>,
}

/// Rows of numbers.
pub struct Values {
    pub count: usize,
    width: usize,
    numbers: Vec<f32>,
}

impl Values {
    pub fn vectors(&self) -> Vec<Vec3> {
        let row = |row: &[f32]| {
            Vec3::new(row[0], row.get(1).copied().unwrap_or(0.0), row.get(2).copied().unwrap_or(0.0))
        };
        self.rows().map(row).collect()
    }

    pub fn pairs(&self) -> Vec<Vec2> {
        self.rows().map(|row| Vec2::new(row[0], row.get(1).copied().unwrap_or(0.0))).collect()
    }

    pub fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.numbers.chunks_exact(self.width)
    }
}

impl<'a> Buffers<'a> {
    /// With all views unpacked that can be.
    pub fn new(
        document: &'a Document,
        sources: &'a [Option<Vec<u8>>],
        monitor: &dyn Monitor,
    ) -> Result<Self, ReadError> {
        let mut unpacked = Vec::with_capacity(document.buffer_views.len());
        let mut held = 0;
        for (index, view) in document.buffer_views.iter().enumerate() {
            monitor.check()?;
            let extensions = &view.extensions;
            let Some(packed) = extensions.meshopt.as_ref().or(extensions.khr_meshopt.as_ref()) else {
                unpacked.push(None);
                continue;
            };
            let problem = || broken(format!("buffer view {index} cannot be unpacked"));
            let stream = bytes(sources, packed.buffer, packed.byte_offset, packed.byte_length);
            let stream = stream.ok_or_else(problem)?;
            // No stream gives more.
            held += view.byte_length.min(64 * stream.len() as u64);
            monitor.admit(READING, held, ADVICE)?;
            unpacked.push(match unpack(packed, stream) {
                Unpacked::Bytes(bytes) => Some(bytes),
                Unpacked::Unknown => None,
                Unpacked::Broken => return Err(problem()),
            });
        }
        Ok(Self { document, sources, unpacked })
    }
}

/// A piece of a buffer.
fn bytes(sources: &[Option<Vec<u8>>], buffer: usize, offset: u64, length: u64) -> Option<&[u8]> {
    let bytes = sources.get(buffer)?.as_ref()?;
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(start..end)
}

impl Buffers<'_> {
    fn accessor(&self, index: usize) -> Result<&Accessor, ReadError> {
        self.document.accessors.get(index).ok_or_else(|| broken(format!("there is no accessor {index}")))
    }

    /// How many rows an accessor announces; no more than a file could hold.
    pub fn count(&self, index: usize) -> Result<usize, ReadError> {
        let count = self.accessor(index)?.count;
        let count = u32::try_from(count).map_err(|_| broken(format!("accessor {index} has {count} rows")))?;
        Ok(count as usize)
    }

    /// The extension by which an accessor's bytes are packed.
    pub fn packed(&self, index: usize) -> Option<&'static str> {
        let accessor = self.document.accessors.get(index)?;
        if accessor.sparse.is_some() {
            return Some("a sparse accessor");
        }
        if self.unpacked.get(accessor.buffer_view?)?.is_some() {
            return None;
        }
        let extensions = &self.document.buffer_views.get(accessor.buffer_view?)?.extensions;
        let khronos = extensions.khr_meshopt.as_ref().map(|_| "KHR_meshopt_compression");
        extensions.meshopt.as_ref().map(|_| "EXT_meshopt_compression").or(khronos)
    }

    /// The bytes of a view.
    pub fn view(&self, index: usize) -> Option<&[u8]> {
        if let Some(unpacked) = self.unpacked.get(index)? {
            return Some(unpacked);
        }
        let BufferView { buffer, byte_offset, byte_length, .. } = self.document.buffer_views.get(index)?;
        bytes(self.sources, *buffer, *byte_offset, *byte_length)
    }

    /// The bytes of an accessor's rows.
    fn rows(&self, index: usize) -> Result<impl Iterator<Item = &[u8]>, ReadError> {
        let accessor = self.accessor(index)?;
        let problem = |what: &str| broken(format!("accessor {index} {what}"));
        let component = component_bytes(accessor.component_type)
            .ok_or_else(|| problem("has an unknown type of numbers"))?;
        let width = width(&accessor.kind).ok_or_else(|| problem("has an unknown shape"))?;
        let row = component * width;
        let view = accessor.buffer_view.ok_or_else(|| problem("has no buffer view"))?;
        let stride = self.document.buffer_views.get(view).and_then(|view| view.byte_stride);
        let stride = stride.and_then(|stride| usize::try_from(stride).ok()).unwrap_or(row);
        let bytes = self.view(view).ok_or_else(|| problem("is of a buffer view that is not there"))?;
        let offset = usize::try_from(accessor.byte_offset).unwrap_or(usize::MAX);
        let bytes = bytes.get(offset..).unwrap_or_default();
        let count = self.count(index)?;
        let needed = (count as u64).saturating_sub(1).saturating_mul(stride as u64) + row as u64;
        if stride < row || (count > 0 && needed > bytes.len() as u64) {
            return Err(problem(&format!("has {count} rows, for which there are not enough bytes")));
        }
        Ok((0..count).map(move |i| &bytes[i * stride..i * stride + row]))
    }

    /// Numbers as they are meant: whole ones as parts of their range where the file says so.
    pub fn values(&self, index: usize) -> Result<Values, ReadError> {
        let accessor = self.accessor(index)?;
        let (kind, normalized) = (accessor.component_type, accessor.normalized);
        let width = width(&accessor.kind).unwrap_or(1);
        let component = component_bytes(kind).unwrap_or(1);
        let mut numbers = Vec::new();
        let mut count = 0;
        for row in self.rows(index)? {
            count += 1;
            numbers.extend(row.chunks_exact(component).map(|bytes| number(bytes, kind, normalized)));
        }
        Ok(Values { count, width, numbers })
    }

    /// Whole numbers.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, ReadError> {
        let is_whole = matches!(self.accessor(index)?.component_type, 5121 | 5123 | 5125);
        if !is_whole {
            return Err(broken(format!("accessor {index} has indices that are no whole numbers")));
        }
        Ok(self
            .rows(index)?
            .map(|row| row.iter().rev().take(4).fold(0, |all, &byte| all << 8 | u32::from(byte)))
            .collect())
    }
}

const fn component_bytes(kind: u32) -> Option<usize> {
    match kind {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

fn width(kind: &str) -> Option<usize> {
    match kind {
        "SCALAR" => Some(1),
        "VEC2" => Some(2),
        "VEC3" => Some(3),
        "VEC4" => Some(4),
        "MAT4" => Some(16),
        _ => None,
    }
}

fn number(bytes: &[u8], kind: u32, normalized: bool) -> f32 {
    let byte = |at: usize| bytes.get(at).copied().unwrap_or(0);
    let (short, long) =
        (u16::from_le_bytes([byte(0), byte(1)]), u32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]));
    let (number, most) = match kind {
        5120 => (f32::from(byte(0).cast_signed()), 127.0),
        5121 => (f32::from(byte(0)), 255.0),
        5122 => (f32::from(short.cast_signed()), 32_767.0),
        5123 => (f32::from(short), 65_535.0),
        5125 => (long as f32, u32::MAX as f32),
        _ => return f32::from_bits(long),
    };
    if normalized { (number / most).max(-1.0) } else { number }
}
