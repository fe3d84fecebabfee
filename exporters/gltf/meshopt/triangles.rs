//! Triangles: most share an edge with a recent one, and their third corner is the next that nobody has
//! named; those take a byte.

use linden_pipeline::Monitor;

use crate::ExportError;

const HEADER: u8 = 0xe1;
/// Recent edges and vertices that can be named.
const RECENT: usize = 16;
/// Pairs of corners that have a code of their own.
const PAIRS: usize = 14;
/// Triangles between two materials at the monitor.
const PER_CHECK: usize = 1 << 16;
/// No vertex: what is recent at first.
const NONE: u32 = u32::MAX;

/// Encodes triangles of vertices below `u32::MAX`. They come back in their order, each beginning with
/// any of its corners.
pub(super) fn encode(triangles: &[[u32; 3]], monitor: &dyn Monitor) -> Result<Vec<u8>, ExportError> {
    let mut encoder = Encoder::new();
    encoder.codes.reserve(triangles.len());
    for some in triangles.chunks(PER_CHECK) {
        monitor.check()?;
        for &triangle in some {
            encoder.triangle(triangle);
        }
    }
    Ok(encoder.finish())
}

/// The latest few of something, the latest first.
#[derive(Clone, Copy)]
struct Fifo<T> {
    items: [T; RECENT],
    next: usize,
}

impl<T: Copy> Fifo<T> {
    fn new(item: T) -> Self {
        Self { items: [item; RECENT], next: 0 }
    }

    fn push(&mut self, item: T) {
        self.items[self.next] = item;
        self.next = (self.next + 1) % RECENT;
    }

    /// How long ago the first of the latest `most` was that is wanted.
    fn find(&self, most: usize, is_wanted: impl Fn(T) -> bool) -> Option<usize> {
        (0..most).find(|age| is_wanted(self.items[(self.next + RECENT - 1 - age) % RECENT]))
    }
}

struct Encoder {
    codes: Vec<u8>,
    data: Vec<u8>,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
    /// The vertex that comes next where each is new.
    next: u32,
    /// The vertex that was spelled out last.
    last: u32,
    /// How often each pair was there.
    counts: [u64; 256],
    /// Where each of them stands: its triangle's place among the codes, and its byte's in the data.
    places: Vec<[usize; 2]>,
}

impl Encoder {
    fn new() -> Self {
        Self {
            codes: Vec::new(),
            data: Vec::new(),
            edges: Fifo::new([NONE; 2]),
            vertices: Fifo::new(NONE),
            next: 0,
            last: 0,
            counts: [0; 256],
            places: Vec::new(),
        }
    }

    /// The stream. Which pairs are frequent is known now: these become codes, and their bytes are left out.
    fn finish(mut self) -> Vec<u8> {
        let pairs = self.frequent_pairs();
        let mut stream = Vec::with_capacity(1 + self.codes.len() + self.data.len() + RECENT);
        stream.push(HEADER);
        let mut left_out = Vec::new();
        for &[triangle, byte] in &self.places {
            if let Some(place) = pairs[..PAIRS].iter().position(|&pair| pair == self.data[byte]) {
                self.codes[triangle] = 0xf0 | place as u8;
                left_out.push(byte);
            }
        }
        stream.append(&mut self.codes);
        let mut kept = 0;
        for byte in left_out {
            stream.extend_from_slice(&self.data[kept..byte]);
            kept = byte + 1;
        }
        stream.extend_from_slice(&self.data[kept..]);
        stream.extend_from_slice(&pairs);
        stream
    }

    /// The pairs to give codes to: that of three new vertices first, which has no other code, then the
    /// most frequent ones (of equals the smaller).
    fn frequent_pairs(&self) -> [u8; RECENT] {
        // The table holds no corner that is spelled out.
        let is_short = |pair: u8| pair > 0 && pair >> 4 < 0xf && pair & 0xf < 0xf;
        let mut found: Vec<u8> =
            (0..=u8::MAX).filter(|&pair| is_short(pair) && self.counts[usize::from(pair)] > 0).collect();
        found.sort_by_key(|&pair| std::cmp::Reverse(self.counts[usize::from(pair)]));
        let mut pairs = [0; RECENT];
        for (place, pair) in pairs[1..PAIRS].iter_mut().zip(found) {
            *place = pair;
        }
        pairs
    }

    fn triangle(&mut self, [a, b, c]: [u32; 3]) {
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        // The oldest edge has no code.
        let known = self.edges.find(RECENT - 1, |edge| turns.iter().any(|turn| turn[..2] == edge));
        match known {
            Some(age) => {
                let edge = self.edges.items[(self.edges.next + RECENT - 1 - age) % RECENT];
                let turn = turns.into_iter().find(|turn| turn[..2] == edge).unwrap_or(turns[0]);
                self.on_edge(age as u8, turn);
            }
            None => {
                let turn = turns.into_iter().find(|turn| turn[0] == self.next).unwrap_or(turns[0]);
                self.free(turn);
            }
        }
    }

    /// A triangle on the edge that was pushed so many edges ago.
    fn on_edge(&mut self, age: u8, [a, b, c]: [u32; 3]) {
        /// Recent vertices that have codes here; the latest has none.
        const VERTICES: usize = 13;
        let recent = self.vertices.find(VERTICES, |vertex| vertex == c).filter(|&age| age > 0);
        let third = match recent {
            Some(age) => age as u8,
            None if c == self.next => {
                self.next += 1;
                0
            }
            None if self.last.checked_sub(1) == Some(c) => {
                self.last = c;
                0xd
            }
            None if self.last + 1 == c => {
                self.last = c;
                0xe
            }
            None => {
                self.spell(c);
                0xf
            }
        };
        self.codes.push(age << 4 | third);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if recent.is_none() {
            self.vertices.push(c);
        }
    }

    /// A triangle without a recent edge; it begins with the next vertex, if it has that.
    fn free(&mut self, [a, b, c]: [u32; 3]) {
        const SPELLED: u8 = 0xf;
        // What is looked up is recent before any of the three is.
        let recent = self.vertices;
        let code = |vertex: u32, next: &mut u32| match recent.find(PAIRS, |known| known == vertex) {
            Some(age) => age as u8 + 1,
            None if vertex == *next => {
                *next += 1;
                0
            }
            None => SPELLED,
        };
        let is_next = a == self.next;
        self.next += u32::from(is_next);
        let mut next = self.next;
        let (second, third) = (code(b, &mut next), code(c, &mut next));
        self.next = next;
        let pair = second << 4 | third;
        if is_next {
            self.counts[usize::from(pair)] += 1;
            self.places.push([self.codes.len(), self.data.len()]);
        }
        self.codes.push(if is_next { 0xfe } else { 0xff });
        self.data.push(pair);
        for (vertex, is_spelled) in [(a, !is_next), (b, second == SPELLED), (c, third == SPELLED)] {
            if is_spelled {
                self.spell(vertex);
            }
        }
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        for (vertex, code) in [(a, 0), (b, second), (c, third)] {
            if matches!(code, 0 | SPELLED) {
                self.vertices.push(vertex);
            }
        }
    }

    /// The difference to the one before, in groups of seven bits, the lowest first.
    fn spell(&mut self, vertex: u32) {
        let delta = vertex.wrapping_sub(self.last) as i32;
        let mut rest = ((delta << 1) ^ (delta >> 31)) as u32;
        while rest > 0x7f {
            self.data.push(rest as u8 | 0x80);
            rest >>= 7;
        }
        self.data.push(rest as u8);
        self.last = vertex;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the extension's text.
    fn decode(stream: &[u8], count: usize) -> Vec<[u32; 3]> {
        assert_eq!(stream[0], 0xe1);
        let (codes, rest) = stream[1..].split_at(count);
        let (mut data, table) = rest.split_at(rest.len() - 16);
        assert!(table[14..] == [0, 0] && table.iter().all(|code| code >> 4 != 0xf && code & 0xf != 0xf));
        let (mut next, mut last) = (0, 0_u32);
        let (mut edges, mut vertices) = (vec![[u32::MAX; 2]; 16], vec![u32::MAX; 16]);
        let byte = |data: &mut &[u8]| {
            let (first, rest) = data.split_first().unwrap();
            *data = rest;
            *first
        };
        let index = |data: &mut &[u8], last: &mut u32| {
            let (mut value, mut shift) = (0, 0);
            loop {
                let next = byte(data);
                value |= u32::from(next & 0x7f) << shift;
                shift += 7;
                if next < 0x80 {
                    break;
                }
            }
            *last = last.wrapping_add(if value & 1 == 0 { value >> 1 } else { !(value >> 1) });
            *last
        };
        let mut triangles = Vec::new();
        for &code in codes {
            let (x, y) = (usize::from(code >> 4), usize::from(code & 0xf));
            if x < 15 {
                let [a, b] = edges[x];
                let c = match y {
                    0 => {
                        next += 1;
                        next - 1
                    }
                    1..13 => vertices[y],
                    13 | 14 => {
                        last = if y == 13 { last - 1 } else { last + 1 };
                        last
                    }
                    _ => index(&mut data, &mut last),
                };
                edges.splice(0..0, [[a, c], [c, b]]);
                if !(1..13).contains(&y) {
                    vertices.insert(0, c);
                }
                triangles.push([a, b, c]);
            } else {
                let pair = if y < 14 { table[y] } else { byte(&mut data) };
                assert!(y < 14 || pair != 0, "no restarts");
                let mut fresh = || {
                    next += 1;
                    next - 1
                };
                let a = if y == 15 { index(&mut data, &mut last) } else { fresh() };
                let mut of = |code: u8| match code {
                    0 => fresh(),
                    15 => index(&mut data, &mut last),
                    _ => vertices[usize::from(code) - 1],
                };
                let (b, c) = (of(pair >> 4), of(pair & 0xf));
                edges.splice(0..0, [[a, c], [c, b], [b, a]]);
                let is_pushed = |code: u8| code == 0 || code == 15;
                vertices.insert(0, a);
                if is_pushed(pair >> 4) {
                    vertices.insert(0, b);
                }
                if is_pushed(pair & 0xf) {
                    vertices.insert(0, c);
                }
                triangles.push([a, b, c]);
            }
        }
        assert!(data.is_empty());
        triangles
    }

    /// Beginning with its smallest corner.
    fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
    }

    fn there_and_back(triangles: &[[u32; 3]]) -> usize {
        let stream = encode(triangles, &linden_pipeline::Quiet).unwrap();
        let back = decode(&stream, triangles.len());
        assert!(back.iter().zip(triangles).all(|(&here, &there)| turned(here) == turned(there)));
        stream.len()
    }

    #[test]
    fn strips_cards_and_noise_come_back() {
        let grid = |width: u32, height: u32| -> Vec<[u32; 3]> {
            let at = |x, y| y * (width + 1) + x;
            let cells = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            cells
                .flat_map(|(x, y)| {
                    let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                    [[a, b, c], [a, c, d]]
                })
                .collect()
        };
        for (width, height) in [(1, 1), (1, 40), (7, 40), (40, 7)] {
            there_and_back(&grid(width, height));
        }
        let cards: Vec<[u32; 3]> =
            (0..1000).flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]).collect();
        assert!(there_and_back(&cards) <= cards.len() + 17, "a byte each");
        // Corners that repeat within a triangle, too.
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 8
        };
        for most in [2, 3, 5, 17, 40, 1000, 1 << 24] {
            let noise: Vec<[u32; 3]> = (0..5000).map(|_| [0; 3].map(|_| random() % most)).collect();
            there_and_back(&noise);
        }
        there_and_back(&[[u32::MAX - 1, 0, u32::MAX / 2], [3, 2, 1], [0, 1, 2], [1, 2, 3]]);
        there_and_back(&[]);
    }
}
