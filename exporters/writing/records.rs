//! Long arrays, formatted in parallel and written in order, as text or as bytes.
//!
//! The bytes of a record depend on its index alone, so they are the same for any number of threads.

use std::ops::Range;

use rayon::prelude::*;

use super::decimal;
use super::recent::{RecentFloats, RecentIntegers};
use crate::{ExportError, Sink};

pub use super::decimal::Digits;

/// Records per piece of parallel work: a hundred kilobytes of text, a fraction of a millisecond.
const CHUNK: usize = 2048;
/// Chunks between two meetings of all threads: enough that a thread that other programs hold up does
/// not hold up the rest.
const CHUNKS_PER_THREAD: usize = 8;
/// Bounds memory on machines with many threads: two batches of this many chunks, some 20 MB.
const MOST_CHUNKS: usize = 96;

/// Bytes that a record takes in a text that has doubled when it was a little too short, about.
const BYTES_PER_RECORD: u64 = 160;

/// The chunks of a batch, when there are so many records.
fn batch(count: usize) -> usize {
    let batch = (rayon::current_num_threads() * CHUNKS_PER_THREAD).min(MOST_CHUNKS);
    batch.min(count.div_ceil(CHUNK)).max(1)
}

/// Bytes that [`write()`] holds at once for so many records: see [`memory::admit`](super::memory::admit).
pub fn bytes(count: usize) -> u64 {
    (2 * batch(count) * CHUNK.min(count)) as u64 * BYTES_PER_RECORD
}

/// Writes `count` records: `format` appends those of a range to the text, for one range after another
/// on any thread. Formatting goes on while earlier chunks are being written: the last ones wait in `out` until more
/// comes, of these records or of others.
///
/// ```
/// use linden_pipeline::Quiet;
/// use linden_exporters::{Bundle, writing::records};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let folder = tempfile::tempdir()?;
/// let mut bundle = Bundle::create(&folder.path().join("squares.txt"))?;
/// bundle.write_main(None, &Quiet, |out| {
///     records::write(out, 3, |text, range| {
///         for i in range {
///             text.integer(i as u32);
///             text.byte(b' ');
///             text.float((i * i) as f32 / 2.0);
///             text.byte(b'\n');
///         }
///     })
/// })?;
/// let path = bundle.commit()?.remove(0).path;
/// assert_eq!(std::fs::read_to_string(path)?, "0 0\n1 0.5\n2 2\n");
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`ExportError::Io`] and [`ExportError::Cancelled`].
pub fn write(
    out: &mut Sink<'_>,
    count: usize,
    format: impl Fn(&mut Text, Range<usize>) + Sync,
) -> Result<(), ExportError> {
    let batch = batch(count);
    // The scope enters the pool once, not once a batch.
    rayon::scope(|_| {
        for first in (0..count).step_by(batch * CHUNK) {
            let mut texts = out.blank(batch.min((count - first).div_ceil(CHUNK)));
            let fill = |texts: &mut [Text]| {
                texts.par_iter_mut().enumerate().for_each(|(i, text)| {
                    let from = first + i * CHUNK;
                    format(text, from..(from + CHUNK).min(count));
                });
            };
            let (written, ()) = rayon::join(|| out.write_waiting(), || fill(&mut texts));
            written?;
            out.wait(texts);
        }
        Ok(())
    })
}

/// What stands before, between and behind the numbers of a tuple.
type Around<'a, const A: usize, const B: usize, const C: usize> = (&'a [u8; A], &'a [u8; B], &'a [u8; C]);

/// Bytes of a file that is being formatted.
///
/// Numbers are short, and a call of `memcpy` for each costs as much as formatting it: everything here
/// is copied in pieces of a length that the compiler knows, into room that is there already.
#[derive(Default)]
pub struct Text {
    /// The first `len` bytes are the text.
    buffer: Vec<u8>,
    len: usize,
}

impl Text {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    pub(crate) fn written(&self) -> &[u8] {
        &self.buffer[..self.len]
    }

    /// The next `N` bytes, of which any number may be used.
    #[inline]
    fn room<const N: usize>(&mut self) -> &mut [u8; N] {
        piece(self.stretch(N), 0)
    }

    /// All of the room behind the text, `more` bytes at least.
    #[inline]
    fn stretch(&mut self, more: usize) -> &mut [u8] {
        if self.buffer.len() < self.len + more {
            self.grow(more);
        }
        &mut self.buffer[self.len..]
    }

    #[cold]
    fn grow(&mut self, more: usize) {
        self.buffer.resize(2 * self.buffer.len() + more + 4096, 0);
    }

    /// Appends bytes as they are, a number of them that the compiler knows: a keyword, a record.
    #[inline]
    pub fn bytes<const N: usize>(&mut self, bytes: &[u8; N]) {
        *self.room() = *bytes;
        self.len += N;
    }

    /// Appends one byte.
    #[inline]
    pub fn byte(&mut self, byte: u8) {
        self.bytes(&[byte]);
    }

    /// Appends any number of bytes.
    pub fn slice(&mut self, bytes: &[u8]) {
        self.stretch(bytes.len())[..bytes.len()].copy_from_slice(bytes);
        self.len += bytes.len();
    }

    /// Appends what `fill` puts at the beginning of the next `N` bytes: it gives how many of them.
    #[inline]
    pub(crate) fn fill<const N: usize>(&mut self, fill: impl FnOnce(&mut [u8; N]) -> usize) {
        let used = fill(self.room());
        debug_assert!(used <= N);
        self.len += used;
    }

    /// Appends a finite number: the shortest decimals that read back as the same number; whole numbers without a point.
    #[inline]
    pub fn float(&mut self, x: f32) {
        self.fill(|room| decimal::float(x, room));
    }

    /// Appends finite numbers, with `between` before each save the first.
    #[inline]
    pub fn floats<const N: usize, const B: usize>(&mut self, numbers: [f32; N], between: &[u8; B]) {
        self.tuple((b"", between, b""), numbers);
    }

    /// Appends finite numbers, with something before, between and behind them.
    #[inline]
    pub(crate) fn tuple<const N: usize, const A: usize, const B: usize, const C: usize>(
        &mut self,
        around: Around<'_, A, B, C>,
        numbers: [f32; N],
    ) {
        self.list(around, numbers, decimal::float);
    }

    /// As [`Text::tuple`], for numbers of which many have been written shortly before.
    #[inline]
    pub(crate) fn recent_tuple<const N: usize, const A: usize, const B: usize, const C: usize>(
        &mut self,
        recent: &mut RecentFloats,
        around: Around<'_, A, B, C>,
        numbers: [f32; N],
    ) {
        self.list(around, numbers, |x, room| recent.put(x, room));
    }

    /// The same for integers.
    #[inline]
    pub(crate) fn recent_integers<const N: usize, const A: usize, const B: usize, const C: usize>(
        &mut self,
        recent: &mut RecentIntegers,
        around: Around<'_, A, B, C>,
        numbers: [u32; N],
    ) {
        self.list(around, numbers, |n, room| recent.put(n, room));
    }

    /// Appends numbers that `put` writes into the next `R` bytes each: it gives how many of them.
    ///
    /// There is room for all before the first one, and their lengths add up in a register.
    #[inline]
    fn list<T, const N: usize, const A: usize, const B: usize, const C: usize, const R: usize>(
        &mut self,
        (before, between, behind): Around<'_, A, B, C>,
        numbers: [T; N],
        mut put: impl FnMut(T, &mut [u8; R]) -> usize,
    ) {
        let room = self.stretch(A + N * (B + R) + C);
        *piece(room, 0) = *before;
        let mut len = A;
        for (i, number) in numbers.into_iter().enumerate() {
            if i > 0 {
                *piece(room, len) = *between;
                len += B;
            }
            len += put(number, piece(room, len));
        }
        *piece(room, len) = *behind;
        self.len += len + C;
    }

    /// Appends an integer in decimal.
    #[inline]
    pub fn integer(&mut self, n: u32) {
        self.digits(Digits::of(n));
    }

    /// Appends an integer whose digits are there already.
    #[inline]
    pub fn digits(&mut self, digits: Digits) {
        *self.room() = digits.text;
        self.len += digits.len;
    }
}

/// `N` bytes of a room that is long enough, from a place on.
#[inline]
pub(crate) fn piece<const N: usize>(room: &mut [u8], at: usize) -> &mut [u8; N] {
    room[at..].first_chunk_mut().unwrap_or_else(|| unreachable!())
}

#[cfg(test)]
mod tests {
    use linden_pipeline::monitor::{Cancelled, Monitor, Phase};

    use super::*;
    use crate::Bundle;
    use crate::bundle::test_output::Output;

    fn lines(text: &mut Text, range: Range<usize>) {
        for i in range {
            text.integer(i as u32);
            text.byte(b' ');
            text.float(i as f32 / 7.0);
            text.byte(b'\n');
        }
    }

    #[test]
    fn parallel_bytes_are_the_serial_ones() {
        for count in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 9 * CHUNK + 17] {
            let mut serial = Text::default();
            lines(&mut serial, 0..count);
            for threads in [1, 2, 5] {
                let output = Output::default();
                let mut bundle = Bundle::stream("test", output.clone());
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    bundle.write_main(None, &linden_pipeline::Quiet, |out| write(out, count, lines)).unwrap();
                });
                assert!(output.bytes() == serial.written(), "{count} lines on {threads} threads");
            }
        }
    }

    #[test]
    fn what_is_written_between_records_is_between_them() {
        let numbers = |text: &mut Text, range: Range<usize>| range.for_each(|i| text.integer(i as u32));
        let long = vec![b'x'; 1 << 21];
        let output = Output::default();
        let mut bundle = Bundle::stream("test", output.clone());
        bundle
            .write_main(None, &linden_pipeline::Quiet, |out| {
                for piece in [&b"a"[..], &long, b"b"] {
                    write(out, 3, numbers)?;
                    out.write(piece)?;
                }
                write(out, 0, numbers)?;
                write(out, CHUNK + 1, |text, range| range.for_each(|_| text.byte(b'.')))?;
                assert_eq!(out.written(), (7 + long.len() + 4 + CHUNK + 1) as u64);
                write(out, 3, numbers)
            })
            .unwrap();
        let expected =
            ["012a012", std::str::from_utf8(&long).unwrap(), "012b", &".".repeat(CHUNK + 1), "012"];
        assert!(output.bytes() == expected.concat().as_bytes());
    }

    #[test]
    fn cancelled_between_chunks() {
        struct After(std::sync::atomic::AtomicU64);
        impl Monitor for After {
            fn is_cancelled(&self) -> bool {
                self.0.load(std::sync::atomic::Ordering::Relaxed) > 1_000_000
            }
            fn advance(&self, _: Phase, done: u64, _: Option<u64>) {
                self.0.store(done, std::sync::atomic::Ordering::Relaxed);
            }
        }
        let monitor = After(0.into());
        let output = Output::default();
        let mut bundle = Bundle::stream("test", output.clone());
        let result = bundle.write_main(None, &monitor, |out| write(out, 10_000_000, lines));
        assert!(matches!(result, Err(ExportError::Cancelled(Cancelled))));
        assert!((1_000_000..4_000_000).contains(&output.bytes().len()), "{}", output.bytes().len());
    }

    #[test]
    fn numbers_read_back() {
        for x in [0.0, -0.0, 1.0, -3.0, 0.1, 1e-7, 3.4e38, f32::MIN_POSITIVE, 16_777_216.0, 123_456.79] {
            let mut text = Text::default();
            text.float(x);
            let back: f32 = std::str::from_utf8(text.written()).unwrap().parse().unwrap();
            assert_eq!(back.to_bits(), x.to_bits());
        }
        for x in (0..100_000u32).map(|i| f32::from_bits(i.wrapping_mul(2_654_435_761))) {
            let mut text = Text::default();
            text.float(if x.is_finite() { x } else { 0.0 });
            let back: f32 = std::str::from_utf8(text.written()).unwrap().parse().unwrap();
            assert!(back == x || !x.is_finite(), "{x} as {back}");
        }
    }
}
