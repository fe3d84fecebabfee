//! Views of buffers out of fewer bytes: `EXT_meshopt_compression`, and what of `KHR_meshopt_compression` is the same.
//!
//! The bitstreams of the extension's appendix A and the filters of its appendix B. Streams come from anywhere: whatever they
//! say, nothing is read beyond them, and what they give is no longer than 64 times what they are.
//!
//! <https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_meshopt_compression>

use serde::Deserialize;

/// What a packed view consists of, and where its bytes are.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Meshopt {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    #[serde(default)]
    byte_stride: u64,
    #[serde(default)]
    count: u64,
    #[serde(default)]
    mode: String,
    #[serde(default)]
    filter: Option<String>,
}

/// What became of a view.
pub enum Unpacked {
    Bytes(Vec<u8>),
    /// A mode, a version or a filter that is not known here.
    Unknown,
    Broken,
}

/// Items of a group, and the most bytes and items of a block.
const GROUP: usize = 16;
const BLOCK_BYTES: usize = 8192;
const BLOCK_ITEMS: usize = 256;
/// The shortest end of a stream of attributes.
const TAIL: usize = 32;

/// The bytes of a view.
pub fn unpack(packed: &Meshopt, stream: &[u8]) -> Unpacked {
    let (Ok(stride), Ok(count)) = (usize::try_from(packed.byte_stride), usize::try_from(packed.count)) else {
        return Unpacked::Broken;
    };
    let indices = |found: Option<Vec<u32>>| -> Option<Vec<u8>> {
        match (found?, stride) {
            (found, 2) => Some(found.iter().flat_map(|index| (*index as u16).to_le_bytes()).collect()),
            (found, 4) => Some(found.iter().flat_map(|index| index.to_le_bytes()).collect()),
            _ => None,
        }
    };
    let found = match (packed.mode.as_str(), stream.first()) {
        ("ATTRIBUTES", Some(0xa0)) => attributes(stream, stride, count),
        ("TRIANGLES", Some(0xe0 | 0xe1)) => indices(triangles(stream, count)),
        ("INDICES", Some(0xd0 | 0xd1)) => indices(sequence(stream, count)),
        ("ATTRIBUTES" | "TRIANGLES" | "INDICES", None) => None,
        _ => return Unpacked::Unknown,
    };
    let Some(mut bytes) = found else { return Unpacked::Broken };
    match packed.filter.as_deref() {
        None | Some("NONE") => {}
        Some("OCTAHEDRAL") if stride == 4 => octahedral_bytes(&mut bytes),
        Some("OCTAHEDRAL") if stride == 8 => octahedral_shorts(&mut bytes),
        Some("QUATERNION") if stride == 8 => quaternions(&mut bytes),
        Some("EXPONENTIAL") if stride.is_multiple_of(4) => exponentials(&mut bytes),
        Some(_) => return Unpacked::Unknown,
    }
    Unpacked::Bytes(bytes)
}

/// Each byte of an item as its difference to the same byte of the item before.
fn attributes(stream: &[u8], stride: usize, count: usize) -> Option<Vec<u8>> {
    if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
        return None;
    }
    let tail = stream.len().checked_sub(stride.max(TAIL)).filter(|&tail| tail > 0)?;
    let mut last = stream[stream.len() - stride..].to_vec();
    let mut data = &stream[1..tail];
    // Each group of sixteen has two bits for each byte of an item at least.
    let least = count.div_ceil(GROUP).div_ceil(4).checked_mul(stride)?;
    if least > data.len() {
        return None;
    }
    let mut items = vec![0; count.checked_mul(stride)?];
    let most = (BLOCK_BYTES / stride / GROUP * GROUP).min(BLOCK_ITEMS);
    for block in items.chunks_mut(most * stride) {
        let groups = (block.len() / stride).div_ceil(GROUP);
        for (byte, before) in last.iter_mut().enumerate() {
            let header = take(&mut data, groups.div_ceil(4))?;
            for (group, some) in block.chunks_mut(GROUP * stride).enumerate() {
                let deltas = deltas(&mut data, header[group / 4] >> (2 * (group % 4)) & 3)?;
                for (item, delta) in some.chunks_exact_mut(stride).zip(deltas) {
                    let delta = if delta & 1 == 0 { delta >> 1 } else { !(delta >> 1) };
                    *before = before.wrapping_add(delta);
                    item[byte] = *before;
                }
            }
        }
    }
    Some(items)
}

/// The sixteen numbers of a group in one of four modes.
fn deltas(data: &mut &[u8], mode: u8) -> Option<[u8; GROUP]> {
    let mut deltas = [0; GROUP];
    let bits = match mode {
        0 => return Some(deltas),
        3 => {
            deltas.copy_from_slice(take(data, GROUP)?);
            return Some(deltas);
        }
        mode => 2 * usize::from(mode),
    };
    let packed = take(data, GROUP * bits / 8)?;
    let sentinel = (1_u8 << bits) - 1;
    for (i, delta) in deltas.iter_mut().enumerate() {
        let shift = 8 - bits * (i % (8 / bits) + 1);
        *delta = packed[i * bits / 8] >> shift & sentinel;
        if *delta == sentinel {
            *delta = take(data, 1)?[0];
        }
    }
    Some(deltas)
}

fn take<'a>(data: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (front, rest) = data.split_at_checked(count)?;
    *data = rest;
    Some(front)
}

/// A difference to the index before, in groups of seven bits, the lowest first.
fn spelled(data: &mut &[u8]) -> Option<u32> {
    let mut value = 0_u32;
    for shift in (0..35).step_by(7) {
        let byte = take(data, 1)?[0];
        value |= u32::from(byte & 0x7f).wrapping_shl(shift);
        if byte < 0x80 {
            return Some(value);
        }
    }
    None
}

/// The difference that a spelled number stands for.
const fn signed(value: u32) -> u32 {
    if value & 1 == 0 { value >> 1 } else { !(value >> 1) }
}

/// Indices one after another, by the one of two before them that is nearer.
fn sequence(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    let mut data = &stream[1..stream.len().checked_sub(4).filter(|&end| end > 0)?];
    if count > data.len() {
        return None;
    }
    let mut last = [0_u32; 2];
    (0..count)
        .map(|_| {
            let value = spelled(&mut data)?;
            let base = &mut last[(value & 1) as usize];
            *base = base.wrapping_add(signed(value >> 1));
            Some(*base)
        })
        .collect()
}

/// The latest few of something.
struct Recent<T> {
    items: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    const fn new(item: T) -> Self {
        Self { items: [item; 16], next: 0 }
    }

    const fn push(&mut self, item: T) {
        self.items[self.next] = item;
        self.next = (self.next + 1) % 16;
    }

    /// The one that was pushed so many before the latest.
    const fn back(&self, age: usize) -> T {
        self.items[(self.next + 15 - age % 16) % 16]
    }
}

/// Triangles, most of which share an edge with a recent one.
fn triangles(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    // Before version 1 the last two codes of what is on an edge were recent vertices.
    let recents = if stream[0] == 0xe0 { 15 } else { 13 };
    let (codes, rest) = stream[1..].split_at_checked(count / 3)?;
    let (mut data, table) = rest.split_at_checked(rest.len().checked_sub(16)?)?;
    let (mut next, mut last) = (0_u32, 0_u32);
    let (mut edges, mut vertices) = (Recent::new([0_u32; 2]), Recent::new(0_u32));
    let mut indices = Vec::with_capacity(3 * codes.len());
    for &code in codes {
        let (x, y) = (usize::from(code >> 4), usize::from(code & 0xf));
        if x < 15 {
            let [a, b] = edges.back(x);
            let c = match y {
                0 => fresh(&mut next),
                y if y < recents => vertices.back(y),
                13 => step(&mut last, u32::MAX),
                14 => step(&mut last, 1),
                _ => step(&mut last, signed(spelled(&mut data)?)),
            };
            if y == 0 || y >= recents {
                vertices.push(c);
            }
            edges.push([c, b]);
            edges.push([a, c]);
            indices.extend([a, b, c]);
            continue;
        }
        let pair = if y < 14 { table[y] } else { take(&mut data, 1)?[0] };
        // All begins anew.
        if y >= 14 && pair == 0 {
            next = 0;
        }
        let a = if y == 15 { None } else { Some(fresh(&mut next)) };
        let mut of = |code: u8| match code {
            0 => Some(fresh(&mut next)),
            15 => None,
            _ => Some(vertices.back(usize::from(code) - 1)),
        };
        let (b, c) = (of(pair >> 4), of(pair & 0xf));
        let mut known = |vertex: Option<u32>| match vertex {
            Some(vertex) => Some(vertex),
            None => Some(step(&mut last, signed(spelled(&mut data)?))),
        };
        let (a, b, c) = (known(a)?, known(b)?, known(c)?);
        let is_pushed = |code: u8| code == 0 || code == 15;
        vertices.push(a);
        if is_pushed(pair >> 4) {
            vertices.push(b);
        }
        if is_pushed(pair & 0xf) {
            vertices.push(c);
        }
        for edge in [[b, a], [c, b], [a, c]] {
            edges.push(edge);
        }
        indices.extend([a, b, c]);
    }
    Some(indices)
}

const fn fresh(next: &mut u32) -> u32 {
    *next = next.wrapping_add(1);
    next.wrapping_sub(1)
}

const fn step(last: &mut u32, by: u32) -> u32 {
    *last = last.wrapping_add(by);
    *last
}

/// A unit vector of two numbers on an octahedron, as a share of the third.
fn octahedral([x, y, one]: [f32; 3], most: f32) -> [f32; 3] {
    let (x, y) = (x / one.max(1.0), y / one.max(1.0));
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let scale = most / (x * x + y * y + z * z).sqrt().max(f32::MIN_POSITIVE);
    [x * scale, y * scale, z * scale].map(f32::round)
}

fn octahedral_bytes(bytes: &mut [u8]) {
    for [x, y, z, _] in bytes.as_chunks_mut::<4>().0 {
        let found = octahedral([*x, *y, *z].map(|byte| f32::from(byte.cast_signed())), 127.0);
        [*x, *y, *z] = found.map(|number| (number as i8).cast_unsigned());
    }
}

fn shorts(bytes: [u8; 8]) -> [i16; 4] {
    [0, 2, 4, 6].map(|at| i16::from_le_bytes([bytes[at], bytes[at + 1]]))
}

fn octahedral_shorts(bytes: &mut [u8]) {
    for item in bytes.as_chunks_mut::<8>().0 {
        let [x, y, one, _] = shorts(*item);
        let found = octahedral([x, y, one].map(f32::from), 32_767.0);
        for (at, number) in item.chunks_exact_mut(2).zip(found) {
            at.copy_from_slice(&(number as i16).to_le_bytes());
        }
    }
}

/// Turns of three numbers; which one is left out stands in the fourth, with what is 1.
fn quaternions(bytes: &mut [u8]) {
    for item in bytes.as_chunks_mut::<8>().0 {
        let numbers = shorts(*item);
        let one = f32::from(numbers[3] | 3);
        let [x, y, z] = [0, 1, 2].map(|i| f32::from(numbers[i]) / one * std::f32::consts::FRAC_1_SQRT_2);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let left_out = (numbers[3] & 3) as usize;
        for (i, number) in [w, x, y, z].into_iter().enumerate() {
            let at = 2 * ((left_out + i) % 4);
            let whole = (number * 32_767.0).round() as i16;
            item[at..at + 2].copy_from_slice(&whole.to_le_bytes());
        }
    }
}

/// Numbers of 24 bits, and by which power of two.
fn exponentials(bytes: &mut [u8]) {
    for item in bytes.as_chunks_mut::<4>().0 {
        let whole = i32::from_le_bytes(*item);
        let power = f64::from(whole >> 24).exp2();
        *item = ((f64::from(whole << 8 >> 8) * power) as f32).to_le_bytes();
    }
}

#[cfg(test)]
mod tests;
