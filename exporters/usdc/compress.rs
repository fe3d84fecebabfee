//! The compression of crate files: blocks of LZ4, and integers as differences before that.

/// What an LZ4 block may take in (`LZ4_MAX_INPUT_SIZE`).
const BLOCK: usize = 0x7e00_0000;

/// Bytes as crate files have them: how many blocks, 0 for a single one without its size before it, and the blocks.
pub(super) fn blocks(bytes: &[u8]) -> Vec<u8> {
    if bytes.len() <= BLOCK {
        let mut out = vec![0];
        out.extend(lz4_flex::block::compress(bytes));
        return out;
    }
    let mut out = vec![bytes.len().div_ceil(BLOCK) as u8];
    for block in bytes.chunks(BLOCK) {
        let block = lz4_flex::block::compress(block);
        out.extend((block.len() as u32).to_le_bytes());
        out.extend(block);
    }
    out
}

/// What [`blocks`] made of `size` bytes; `None` where it is broken, or of several blocks, which no table of names is.
pub(super) fn unpacked(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    // LZ4 makes a byte of 255 at most: what claims more is broken, and no memory is taken for it.
    let (&0, block) = packed.split_first()? else { return None };
    if size / 256 > block.len() {
        return None;
    }
    lz4_flex::block::decompress(block, size).ok().filter(|bytes| bytes.len() == size)
}

/// Integers of 32 bits: the commonest difference, two bits each that say how wide the difference to the one before is
/// (0: the commonest; 1, 2, 3: of 8, 16, 32 bits), those differences; and all that as [`blocks`].
pub(super) fn integers(values: &(impl Iterator<Item = i32> + Clone)) -> Vec<u8> {
    let differences = || {
        let mut before = 0_i32;
        values.clone().map(move |value| value.wrapping_sub(std::mem::replace(&mut before, value)))
    };
    // Any would do; those beyond eight bits hardly ever repeat.
    let mut counts = [0_usize; 256];
    for narrow in differences().filter_map(|difference| i8::try_from(difference).ok()) {
        counts[usize::from(narrow as u8)] += 1;
    }
    let commonest = (0..=u8::MAX).max_by_key(|&byte| counts[usize::from(byte)]).unwrap_or_default();
    let common = i32::from(commonest as i8);
    let mut codes = Vec::new();
    let mut wide = Vec::new();
    for (i, difference) in differences().enumerate() {
        let code = if difference == common {
            0
        } else if let Ok(narrow) = i8::try_from(difference) {
            wide.extend(narrow.to_le_bytes());
            1
        } else if let Ok(narrow) = i16::try_from(difference) {
            wide.extend(narrow.to_le_bytes());
            2
        } else {
            wide.extend(difference.to_le_bytes());
            3
        };
        if i % 4 == 0 {
            codes.push(0);
        }
        if let Some(last) = codes.last_mut() {
            *last |= code << (2 * (i % 4));
        }
    }
    let mut encoded = common.to_le_bytes().to_vec();
    encoded.append(&mut codes);
    encoded.append(&mut wide);
    blocks(&encoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverse, from the words of the format alone.
    fn decoded(packed: &[u8], count: usize) -> Vec<i32> {
        let encoded = lz4_flex::block::decompress(&packed[1..], 4 + count + 4 * count).unwrap();
        let common = i32::from_le_bytes(encoded[..4].try_into().unwrap());
        let (codes, mut wide) = encoded[4..].split_at(count.div_ceil(4));
        let mut take = |n: usize| {
            let (bytes, rest) = wide.split_at(n);
            wide = rest;
            bytes
        };
        let mut value = 0_i32;
        (0..count)
            .map(|i| {
                let difference = match (codes[i / 4] >> (2 * (i % 4))) & 3 {
                    0 => common,
                    1 => i32::from(take(1)[0] as i8),
                    2 => i32::from(i16::from_le_bytes(take(2).try_into().unwrap())),
                    _ => i32::from_le_bytes(take(4).try_into().unwrap()),
                };
                value = value.wrapping_add(difference);
                value
            })
            .collect()
    }

    #[test]
    fn integers_come_back() {
        let mixed: Vec<i32> = (0..1000).map(|i: i32| i.wrapping_mul(i).wrapping_mul(i * 7919)).collect();
        for values in [vec![], vec![7], vec![i32::MIN, i32::MAX, 0, -1], (0..99).collect(), mixed] {
            assert_eq!(decoded(&integers(&values.iter().copied()), values.len()), values);
        }
    }

    #[test]
    fn blocks_come_back_and_false_sizes_take_no_memory() {
        let bytes = b"points points points points points".as_slice();
        let packed = blocks(bytes);
        assert_eq!(unpacked(&packed, bytes.len()).as_deref(), Some(bytes));
        for size in [0, bytes.len() - 1, bytes.len() + 1, usize::MAX] {
            assert_eq!(unpacked(&packed, size), None);
        }
        assert_eq!(unpacked(&[], 1), None);
        assert_eq!(unpacked(&[2, 1, 1], 1), None);
    }
}
