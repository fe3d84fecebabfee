//! Formats long arrays in parallel and writes them in order.
//!
//! The bytes of a record depend on its index alone, so they are the same for any number of threads.

use std::ops::Range;

use rayon::prelude::*;

use crate::{ExportError, Sink};

/// Records per piece of parallel work: a few hundred kilobytes of text, some milliseconds.
const CHUNK: usize = 8192;

/// Writes `count` records: `format` appends those of a range to the text, for one range after another
/// on any thread. Formatting goes on while earlier chunks are being written.
///
/// Memory: two batches of two chunks per thread, whatever `count` is.
pub(crate) fn write(
    out: &mut Sink<'_>,
    count: usize,
    format: impl Fn(&mut Text, Range<usize>) + Sync,
) -> Result<(), ExportError> {
    let batch = (rayon::current_num_threads() * 2).min(count.div_ceil(CHUNK)).max(1);
    let mut writing: Vec<Text> = (0..batch).map(|_| Text::default()).collect();
    let mut formatting: Vec<Text> = (0..batch).map(|_| Text::default()).collect();
    let fill = |texts: &mut [Text], first: usize| {
        texts.par_iter_mut().enumerate().for_each(|(i, text)| {
            let from = (first + i * CHUNK).min(count);
            text.0.clear();
            format(text, from..(from + CHUNK).min(count));
        });
    };
    fill(&mut formatting, 0);
    for first in (0..count).step_by(batch * CHUNK) {
        std::mem::swap(&mut writing, &mut formatting);
        let (written, ()) = rayon::join(
            || writing.iter().try_for_each(|text| out.write(&text.0)),
            || fill(&mut formatting, first + batch * CHUNK),
        );
        written?;
    }
    Ok(())
}

/// Bytes of a file that is being formatted.
#[derive(Default)]
pub(crate) struct Text(Vec<u8>);

impl Text {
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub fn byte(&mut self, byte: u8) {
        self.0.push(byte);
    }

    /// The shortest decimals that read back as the same number; whole numbers without a point.
    pub fn float(&mut self, x: f32) {
        debug_assert!(x.is_finite());
        let mut buffer = zmij::Buffer::new();
        let text = buffer.format_finite(x).as_bytes();
        self.0.extend_from_slice(text.strip_suffix(b".0").unwrap_or(text));
    }

    /// Each with `between` before it, save the first.
    pub fn floats<const N: usize>(&mut self, numbers: [f32; N], between: &[u8]) {
        for (i, x) in numbers.into_iter().enumerate() {
            if i > 0 {
                self.0.extend_from_slice(between);
            }
            self.float(x);
        }
    }

    pub fn integer(&mut self, n: u32) {
        let mut buffer = [0; 10];
        self.0.extend_from_slice(digits(n, &mut buffer));
    }
}

/// Decimal digits of `n`: std's formatting machinery costs more than the digits here.
pub(crate) fn digits(n: u32, buffer: &mut [u8; 10]) -> &[u8] {
    let mut rest = n;
    let mut first = buffer.len();
    loop {
        first -= 1;
        buffer[first] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            return &buffer[first..];
        }
    }
}

#[cfg(test)]
mod tests {
    use linden::monitor::{Cancelled, Monitor, Stage};

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
                    bundle.write_main(None, &linden::Quiet, |out| write(out, count, lines)).unwrap();
                });
                assert!(output.bytes() == serial.0, "{count} lines on {threads} threads");
            }
        }
    }

    #[test]
    fn cancelled_between_chunks() {
        struct After(std::sync::atomic::AtomicU64);
        impl Monitor for After {
            fn is_cancelled(&self) -> bool {
                self.0.load(std::sync::atomic::Ordering::Relaxed) > 1_000_000
            }
            fn advance(&self, _: Stage, done: u64, _: Option<u64>) {
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
            let back: f32 = std::str::from_utf8(&text.0).unwrap().parse().unwrap();
            assert_eq!(back.to_bits(), x.to_bits());
        }
        for n in [0, 1, 9, 10, 99, 100, 12_345, u32::MAX] {
            assert_eq!(digits(n, &mut [0; 10]), n.to_string().as_bytes());
        }
    }
}
