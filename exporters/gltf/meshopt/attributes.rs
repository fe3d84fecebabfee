//! Attributes: each byte of an item as its difference to the same byte of the item before, sixteen at a
//! time in as few bits as hold them.

use linden_pipeline::Monitor;
use rayon::prelude::*;

use crate::ExportError;

const HEADER: u8 = 0xa0;
/// Items of a group.
const GROUP: usize = 16;
/// The most bytes and the most items of a block.
const BLOCK_BYTES: usize = 8192;
const BLOCK_ITEMS: usize = 256;
/// The stream's end holds the item that the first one is a difference to.
const TAIL: usize = 32;
/// Blocks that one task encodes.
const PER_TASK: usize = 64;

/// Encodes items of `stride` bytes each, a multiple of four up to 256.
pub(super) fn encode(bytes: &[u8], stride: usize, monitor: &dyn Monitor) -> Result<Vec<u8>, ExportError> {
    let items = (BLOCK_BYTES / stride / GROUP * GROUP).min(BLOCK_ITEMS);
    let first = bytes.get(..stride).unwrap_or_default();
    let task = items * stride * PER_TASK;
    let tasks = bytes.par_chunks(task).enumerate().map(|(index, piece)| {
        monitor.check()?;
        let mut out = Vec::with_capacity(piece.len() / 2);
        let mut before =
            index.checked_mul(task).filter(|&at| at > 0).map_or(first, |at| &bytes[at - stride..at]);
        for block in piece.chunks(items * stride) {
            (0..stride).for_each(|byte| encode_bytes(block, before, byte, &mut out));
            before = &block[block.len() - stride..];
        }
        Ok(out)
    });
    let tasks = tasks.collect::<Result<Vec<Vec<u8>>, ExportError>>()?;
    let mut stream = Vec::with_capacity(1 + tasks.iter().map(Vec::len).sum::<usize>() + TAIL.max(stride));
    stream.push(HEADER);
    stream.extend(tasks.iter().flatten());
    stream.resize(stream.len() + TAIL.saturating_sub(stride), 0);
    stream.extend_from_slice(first);
    Ok(stream)
}

/// One byte of each item of a block.
fn encode_bytes(block: &[u8], before: &[u8], byte: usize, out: &mut Vec<u8>) {
    let stride = before.len();
    let groups = (block.len() / stride).div_ceil(GROUP);
    let header = out.len();
    out.resize(header + groups.div_ceil(4), 0);
    let mut last = before[byte];
    for (group, items) in block.chunks(GROUP * stride).enumerate() {
        let mut deltas = [0; GROUP];
        for (delta, item) in deltas.iter_mut().zip(items.chunks_exact(stride)) {
            *delta = zigzag(item[byte].wrapping_sub(last));
            last = item[byte];
        }
        let mode = encode_group(&deltas, out);
        out[header + group / 4] |= mode << (2 * (group % 4));
    }
}

/// Small numbers for small differences of either sign.
fn zigzag(delta: u8) -> u8 {
    (delta << 1) ^ if delta & 0x80 == 0 { 0 } else { 0xff }
}

/// In the shortest of four modes, which is given: nothing (all zero), 2 or 4 bits each with those that
/// are too large behind, or whole bytes.
fn encode_group(deltas: &[u8; GROUP], out: &mut Vec<u8>) -> u8 {
    let above = |most: u8| deltas.iter().filter(|&&delta| delta >= most).count();
    if deltas.iter().all(|&delta| delta == 0) {
        return 0;
    }
    let (two, four) = (GROUP / 4 + above(3), GROUP / 2 + above(15));
    let (mode, bits) = if two <= four && two < GROUP {
        (1, 2)
    } else if four < GROUP {
        (2, 4)
    } else {
        out.extend_from_slice(deltas);
        return 3;
    };
    let sentinel = (1_u8 << bits) - 1;
    for packed in deltas.chunks(8 / bits) {
        out.push(packed.iter().fold(0, |byte, &delta| byte << bits | delta.min(sentinel)));
    }
    out.extend(deltas.iter().filter(|&&delta| delta >= sentinel));
    mode
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the extension's text, one item after the other.
    fn decode(stream: &[u8], stride: usize, count: usize) -> Vec<u8> {
        let mut data = &stream[1..];
        assert_eq!(stream[0], 0xa0);
        let mut last = stream[stream.len() - stride..].to_vec();
        let mut items = vec![0; count * stride];
        let most = (8192 / stride / 16 * 16).min(256);
        for first in (0..count).step_by(most) {
            let block = most.min(count - first);
            for byte in 0..stride {
                let groups = block.div_ceil(16);
                let (header, rest) = data.split_at(groups.div_ceil(4));
                data = rest;
                let mut deltas = Vec::new();
                for group in 0..groups {
                    let bits = [0, 2, 4, 8][usize::from(header[group / 4] >> (2 * (group % 4)) & 3)];
                    let (packed, mut rest) = data.split_at(2 * bits);
                    for i in 0..16 {
                        let value = match bits {
                            0 => 0,
                            8 => packed[i],
                            _ => {
                                let per_byte = 8 / bits;
                                let shift = 8 - bits * (i % per_byte + 1);
                                let value = packed[i / per_byte] >> shift & ((1 << bits) - 1);
                                if value == (1 << bits) - 1 {
                                    let (first, behind) = rest.split_first().unwrap();
                                    rest = behind;
                                    *first
                                } else {
                                    value
                                }
                            }
                        };
                        deltas.push(if value & 1 == 0 { value >> 1 } else { !(value >> 1) });
                    }
                    data = rest;
                }
                for (i, delta) in deltas.into_iter().take(block).enumerate() {
                    last[byte] = last[byte].wrapping_add(delta);
                    items[(first + i) * stride + byte] = last[byte];
                }
            }
        }
        assert_eq!(data.len(), stride.max(32), "all is read but for the tail");
        items
    }

    #[test]
    fn items_come_back() {
        for stride in [4, 8, 12, 16, 64, 256] {
            for count in [1, 2, 15, 16, 17, 255, 256, 257, 1000, 40_000] {
                let byte = |i: usize| match i % 4 {
                    0 => (i / stride / 7) as u8,
                    1 => (i * 31 % 251) as u8,
                    2 => 200,
                    _ => (i / 64 * i) as u8,
                };
                let bytes: Vec<u8> = (0..count * stride).map(byte).collect();
                let stream = encode(&bytes, stride, &linden_pipeline::Quiet).unwrap();
                assert!(decode(&stream, stride, count) == bytes, "{count} of {stride}");
            }
        }
    }

    #[test]
    fn the_example_of_the_specification() {
        let deltas = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0_i8];
        let mut out = Vec::new();
        let mode = encode_group(&deltas.map(|delta| zigzag(delta as u8)), &mut out);
        assert_eq!((mode, out), (2, vec![0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5]));
    }

    #[test]
    fn each_mode_is_taken_where_it_is_the_shortest() {
        let with = |deltas: [u8; 16]| {
            let mut out = Vec::new();
            (encode_group(&deltas, &mut out), out.len())
        };
        let mut some = [1; 16];
        assert_eq!(with([0; 16]), (0, 0));
        assert_eq!(with(some), (1, 4));
        some[3] = 200;
        assert_eq!(with(some), (1, 5));
        assert_eq!(with([14; 16]), (2, 8));
        assert_eq!(with([15; 16]), (3, 16));
    }
}
