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
        let mut deltas = Vec::new();
        for block in piece.chunks(items * stride) {
            differences(block, before, &mut deltas);
            (0..stride).for_each(|byte| encode_bytes(&deltas, stride, byte, &mut out));
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

/// Each byte of a block less the same byte of the item before; `before` is that of the first.
fn differences(block: &[u8], before: &[u8], deltas: &mut Vec<u8>) {
    let delta = |(byte, earlier): (&u8, &u8)| zigzag(byte.wrapping_sub(*earlier));
    deltas.clear();
    deltas.extend(block.iter().zip(before).map(delta));
    deltas.extend(block[before.len()..].iter().zip(block).map(delta));
}

/// One byte of each item of a block, by the differences of all.
fn encode_bytes(deltas: &[u8], stride: usize, byte: usize, out: &mut Vec<u8>) {
    let groups = (deltas.len() / stride).div_ceil(GROUP);
    let header = out.len();
    out.resize(header + groups.div_ceil(4), 0);
    for (group, items) in deltas.chunks(GROUP * stride).enumerate() {
        let mut some = [0; GROUP];
        for (delta, item) in some.iter_mut().zip(items.chunks_exact(stride)) {
            *delta = item[byte];
        }
        let mode = encode_group(&some, out);
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
    let above = |most: u8| usize::from(deltas.iter().map(|&delta| u8::from(delta >= most)).sum::<u8>());
    let (two, four) = (GROUP / 4 + above(3), GROUP / 2 + above(15));
    if above(1) == 0 {
        return 0;
    }
    if two <= four && two < GROUP {
        pack::<2>(deltas, out);
        1
    } else if four < GROUP {
        pack::<4>(deltas, out);
        2
    } else {
        out.extend_from_slice(deltas);
        3
    }
}

/// In so many bits each, and behind them those that are too large, in whole bytes.
fn pack<const BITS: usize>(deltas: &[u8; GROUP], out: &mut Vec<u8>) {
    let sentinel = (1_u8 << BITS) - 1;
    let packed = GROUP * BITS / 8;
    // Into room for all of them, without a decision at any.
    let mut bytes = [0; GROUP + GROUP / 2];
    let mut len = packed;
    for (byte, some) in bytes[..packed].iter_mut().zip(deltas.chunks_exact(8 / BITS)) {
        *byte = some.iter().fold(0, |byte, &delta| byte << BITS | delta.min(sentinel));
    }
    for &delta in deltas {
        bytes[len] = delta;
        len += usize::from(delta >= sentinel);
    }
    out.extend_from_slice(&bytes[..len]);
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
