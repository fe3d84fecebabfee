//! Where an exporter's bytes go: buffered, counted, cancellable.

use std::io::{self, BufWriter, Write};

use linden_pipeline::Monitor;
use linden_pipeline::monitor::Phase;

use crate::ExportError;
use crate::writing::records::Text;

/// Small pieces are gathered to this; larger ones pass by the buffer.
const BUFFER: usize = 1 << 16;
/// Between two looks at the monitor: about a millisecond of a fast disk.
const PIECE: usize = 1 << 20;

/// An open file of a [`crate::Bundle`].
pub struct Sink<'a> {
    out: BufWriter<&'a mut (dyn Write + Send)>,
    what: String,
    written: u64,
    total: Option<u64>,
    monitor: &'a dyn Monitor,
    /// What comes next, in order, and is written while more is formatted.
    waiting: Vec<Text>,
    /// Empty ones that have their memory already.
    spare: Vec<Text>,
}

impl<'a> Sink<'a> {
    pub(super) fn new(
        out: &'a mut (dyn Write + Send),
        what: String,
        total: Option<u64>,
        monitor: &'a dyn Monitor,
    ) -> Self {
        let out = BufWriter::with_capacity(BUFFER, out);
        Self { out, what, written: 0, total, monitor, waiting: Vec::new(), spare: Vec::new() }
    }

    /// Writes all of `bytes`.
    ///
    /// # Errors
    /// [`ExportError::Io`] and [`ExportError::Cancelled`].
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        if let Some(last) = self.waiting.last_mut() {
            // A little is no reason to stop formatting for; much is to be written, not kept.
            if bytes.len() < BUFFER && last.written().len() + bytes.len() < PIECE {
                last.slice(bytes);
                return Ok(());
            }
            self.write_waiting()?;
        }
        self.write_now(bytes)
    }

    fn write_now(&mut self, bytes: &[u8]) -> Result<(), ExportError> {
        for piece in bytes.chunks(PIECE) {
            self.monitor.check()?;
            self.out.write_all(piece).map_err(|source| self.failed(source))?;
            self.written += piece.len() as u64;
            self.monitor.advance(Phase::Write, self.written, self.total);
        }
        Ok(())
    }

    /// Texts to be filled, for [`Sink::wait`].
    pub(crate) fn blank(&mut self, count: usize) -> Vec<Text> {
        let kept = self.spare.len().saturating_sub(count);
        let mut texts = self.spare.split_off(kept);
        texts.resize_with(count, Text::default);
        texts
    }

    /// Writes these after all else, when [`Sink::write_waiting`] is called or more is written.
    pub(crate) fn wait(&mut self, texts: Vec<Text>) {
        self.waiting.extend(texts);
    }

    /// Writes what waits.
    ///
    /// # Errors
    /// As [`Sink::write`].
    pub(crate) fn write_waiting(&mut self) -> Result<(), ExportError> {
        for mut text in std::mem::take(&mut self.waiting) {
            self.write_now(text.written())?;
            text.clear();
            self.spare.push(text);
        }
        Ok(())
    }

    /// Appends what `write` writes to bytes in memory.
    pub(crate) fn gather(
        what: &str,
        bytes: &mut Vec<u8>,
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Sink<'_>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let mut sink = Sink::new(bytes, what.to_owned(), None, monitor);
        write(&mut sink)?;
        sink.finish()?;
        Ok(())
    }

    /// Bytes that it was given so far.
    pub fn written(&self) -> u64 {
        self.written + self.waiting.iter().map(|text| text.written().len() as u64).sum::<u64>()
    }

    /// Hands the rest to the system; dropping a sink instead would swallow its last error.
    pub(super) fn finish(mut self) -> Result<u64, ExportError> {
        self.write_waiting()?;
        self.out.flush().map_err(|source| self.failed(source))?;
        Ok(self.written)
    }

    fn failed(&self, source: io::Error) -> ExportError {
        failed("writing", &self.what, source)
    }
}

/// What a writer's error means: it may be that of one that was cancelled while it waited.
pub(super) fn failed(doing: &'static str, what: &str, source: io::Error) -> ExportError {
    if super::pipe::is_cancelled(&source) {
        return linden_pipeline::Cancelled.into();
    }
    ExportError::Io { doing, what: what.to_owned(), source }
}
