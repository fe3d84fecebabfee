//! The compression of crate files: blocks of LZ4, and integers as differences within them.

use super::super::ReadError;
use super::bytes::{Bytes, Room};
use super::element::Scalar;

/// LZ4 makes a byte of 255 at most.
const MOST_OF_A_BYTE: usize = 255;

/// Unpacks at most `most` bytes: no memory is taken for more than the blocks can hold.
pub(super) fn blocks(
    packed: &[u8],
    most: usize,
    what: &'static str,
    room: &mut Room<'_>,
) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Bytes::new(packed, what);
    let most = most.min(packed.len().saturating_mul(MOST_OF_A_BYTE));
    room.take(most, 1)?;
    let mut out = vec![0; most];
    let broken = |_| Bytes::new(&[], what).broken("is not compressed as it should be; write the file again");
    let [count] = bytes.numbers()?;
    let mut at = 0;
    if count == 0 {
        at = lz4_flex::block::decompress_into(bytes.rest(), &mut out).map_err(broken)?;
    }
    for _ in 0..count {
        let size = u32::from_le_bytes(bytes.numbers()?) as usize;
        let block = bytes.take(size)?;
        at += lz4_flex::block::decompress_into(block, &mut out[at..]).map_err(broken)?;
    }
    out.truncate(at);
    Ok(out)
}

/// Integers: the commonest difference, two bits for each that say how wide its difference to the one before is (0: the
/// commonest; 1, 2, 3: a quarter, half, all of an integer's bytes), and those differences; all that as [`blocks`].
pub(super) fn integers<T: Scalar>(
    packed: &[u8],
    count: usize,
    what: &'static str,
    room: &mut Room<'_>,
) -> Result<Vec<T>, ReadError> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let codes = count.div_ceil(4);
    // Before memory is taken: each integer has two bits at least.
    if codes / MOST_OF_A_BYTE > packed.len() {
        return Err(Bytes::new(&[], what).short());
    }
    room.take(count, T::SIZE)?;
    let most = count.saturating_mul(T::SIZE).saturating_add(codes).saturating_add(T::SIZE);
    let unpacked = blocks(packed, most, what, room)?;
    let mut bytes = Bytes::new(&unpacked, what);
    let common = signed(bytes.take(T::SIZE)?);
    let codes = bytes.take(codes)?;
    let mut values = Vec::with_capacity(count);
    let mut value = 0_i64;
    for i in 0..count {
        let difference = match (codes[i / 4] >> (2 * (i % 4))) & 3 {
            0 => common,
            code => signed(bytes.take(T::SIZE >> (3 - code))?),
        };
        value = value.wrapping_add(difference);
        values.push(T::of(value));
    }
    Ok(values)
}

/// An integer of one to eight bytes.
fn signed(bytes: &[u8]) -> i64 {
    let is_negative = bytes.last().is_some_and(|last| *last > 127);
    let mut all = if is_negative { [255; 8] } else { [0; 8] };
    for (to, from) in all.iter_mut().zip(bytes) {
        *to = *from;
    }
    i64::from_le_bytes(all)
}
