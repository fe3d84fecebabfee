//! `EXT_meshopt_compression`: views of the buffer in fewer bytes, without loss but for which corner a
//! triangle begins with.
//!
//! The bitstreams are those of the extension's appendix A: version 0 of the attributes' and version 1
//! of the triangles', which every decoder reads. Filters, which lose precision, are not used:
//! [`quantize`](super::quantize) does that. There is no uncompressed copy for readers without it.
//!
//! <https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression>

mod attributes;
mod triangles;

use linden_pipeline::Monitor;

use super::byte_sink::ByteSink;
use super::document::{BufferView, Compressed, Mode, ViewExtensions};
use crate::ExportError;

/// What readers need.
pub(super) const EXTENSION: &str = "EXT_meshopt_compression";

/// What a view consists of, where that is known.
#[derive(Clone, Copy)]
pub(super) struct Items {
    pub mode: Mode,
    /// Bytes of each.
    pub stride: u64,
    pub count: usize,
}

/// A buffer with compressed views.
pub(super) struct Packed {
    /// One after the other, each beginning at a multiple of four.
    pieces: Vec<Vec<u8>>,
    /// Of all.
    pub bytes: u64,
    /// The length of the buffer that compressed views are said to be in.
    pub stands_for: u64,
}

impl Packed {
    pub fn write(&self, out: &mut impl ByteSink) -> Result<(), ExportError> {
        for piece in &self.pieces {
            out.put(piece)?;
            out.put(&[0; 3][..piece.len().next_multiple_of(4) - piece.len()])?;
        }
        Ok(())
    }
}

/// Takes the buffer as it would be written, and makes that of the compressed one.
pub(super) struct Packer<'a> {
    /// As they lie in what is taken.
    views: &'a [BufferView],
    /// By view.
    items: &'a [Option<Items>],
    monitor: &'a dyn Monitor,
    /// How much was taken.
    taken: u64,
    /// The view whose bytes come next, and what is there of it.
    view: usize,
    pending: Vec<u8>,
    /// By view: what is written of it, and whether it is compressed.
    packed: Vec<(Vec<u8>, bool)>,
}

impl<'a> Packer<'a> {
    pub fn new(views: &'a [BufferView], items: &'a [Option<Items>], monitor: &'a dyn Monitor) -> Self {
        let (pending, packed) = (Vec::new(), Vec::with_capacity(views.len()));
        Self { views, items, monitor, taken: 0, view: 0, pending, packed }
    }

    /// The views as they lie in the compressed buffer, and that.
    pub fn finish(self) -> (Vec<BufferView>, Packed) {
        let (mut at, mut length) = (0, 0);
        let mut views = Vec::with_capacity(self.views.len());
        for ((view, items), (bytes, is_compressed)) in self.views.iter().zip(self.items).zip(&self.packed) {
            let (byte_offset, byte_length) = (at, bytes.len() as u64);
            at = (at + byte_length).next_multiple_of(4);
            views.push(match *items {
                Some(Items { mode, stride, count }) if *is_compressed => {
                    let view = BufferView { buffer: 1, byte_offset: length, ..view.clone() };
                    length = (length + view.byte_length).next_multiple_of(4);
                    let compressed =
                        Compressed { buffer: 0, byte_offset, byte_length, byte_stride: stride, mode, count };
                    BufferView { extensions: Some(ViewExtensions { compressed }), ..view }
                }
                _ => BufferView { byte_offset, ..view.clone() },
            });
        }
        let pieces = self.packed.into_iter().map(|(bytes, _)| bytes).collect();
        (views, Packed { pieces, bytes: at, stands_for: length })
    }

    fn pack(&mut self) -> Result<(), ExportError> {
        let bytes = std::mem::take(&mut self.pending);
        let encoded = match self.items[self.view] {
            None => None,
            Some(Items { mode: Mode::Attributes, stride, .. }) => {
                Some(attributes::encode(&bytes, stride as usize, self.monitor)?)
            }
            Some(Items { mode: Mode::Triangles, stride, .. }) => {
                Some(triangles::encode(&corners(&bytes, stride), self.monitor)?)
            }
        };
        // Noise does not get shorter.
        let encoded = encoded.filter(|encoded| encoded.len() < bytes.len());
        self.packed.push(match encoded {
            Some(encoded) => (encoded, true),
            None => (bytes, false),
        });
        self.view += 1;
        Ok(())
    }
}

/// The corners of triangles whose indices have so many bytes.
fn corners(bytes: &[u8], stride: u64) -> Vec<[u32; 3]> {
    if stride == 2 {
        let short = |pair: &[u8; 2]| u32::from(u16::from_le_bytes(*pair));
        bytes.as_chunks::<6>().0.iter().map(|six| [0, 2, 4].map(|i| short(&[six[i], six[i + 1]]))).collect()
    } else {
        let long =
            |six: &[u8; 12], i: usize| u32::from_le_bytes([six[i], six[i + 1], six[i + 2], six[i + 3]]);
        bytes.as_chunks::<12>().0.iter().map(|six| [0, 4, 8].map(|i| long(six, i))).collect()
    }
}

impl ByteSink for Packer<'_> {
    fn put(&mut self, mut bytes: &[u8]) -> Result<(), ExportError> {
        while let Some(view) = self.views.get(self.view) {
            // Between views there are zeros.
            let gap = view.byte_offset.saturating_sub(self.taken).min(bytes.len() as u64);
            self.pending.reserve(if gap > 0 { 0 } else { view.byte_length as usize - self.pending.len() });
            let missing = view.byte_length - self.pending.len() as u64;
            let take = if gap > 0 { gap } else { missing.min(bytes.len() as u64) };
            let (front, rest) = bytes.split_at(take as usize);
            if gap == 0 {
                self.pending.extend_from_slice(front);
            }
            self.taken += take;
            bytes = rest;
            if gap == 0 && take == missing {
                self.pack()?;
            } else if bytes.is_empty() {
                break;
            }
        }
        Ok(())
    }
}
