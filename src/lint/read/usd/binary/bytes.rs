//! Bytes that are read one after the other, and the memory that may be taken for what they unpack to.

use linden_base::monitor::Monitor;

use super::super::{ReadError, broken};
use crate::read::{ADVICE, READING};

/// Bytes that are read one after the other.
pub(super) struct Bytes<'a> {
    rest: &'a [u8],
    /// For messages: `the section TOKENS`.
    what: &'static str,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], what: &'static str) -> Self {
        Self { rest: bytes, what }
    }

    /// What begins at a place of a file.
    pub fn at(file: &'a [u8], place: u64, what: &'static str) -> Result<Self, ReadError> {
        let rest = usize::try_from(place).ok().and_then(|place| file.get(place..));
        let rest = rest.ok_or_else(|| broken(format!("{what} begins behind the end of the file")))?;
        Ok(Self { rest, what })
    }

    pub fn take(&mut self, count: usize) -> Result<&'a [u8], ReadError> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or_else(|| self.short())?;
        self.rest = rest;
        Ok(taken)
    }

    /// `count` elements of `size` bytes each.
    pub fn elements(&mut self, count: usize, size: usize) -> Result<&'a [u8], ReadError> {
        self.take(count.checked_mul(size).ok_or_else(|| self.short())?)
    }

    pub fn numbers<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or_else(|| self.short())?;
        self.rest = rest;
        Ok(*taken)
    }

    pub fn word(&mut self) -> Result<u64, ReadError> {
        self.numbers().map(u64::from_le_bytes)
    }

    /// A count of 64 bits. What it counts has still to be held against what is there.
    pub fn count(&mut self) -> Result<usize, ReadError> {
        usize::try_from(self.word()?).map_err(|_| self.short())
    }

    /// Bytes behind how many they are.
    pub fn counted(&mut self) -> Result<&'a [u8], ReadError> {
        let count = self.count()?;
        self.take(count)
    }

    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    pub fn short(&self) -> ReadError {
        self.broken("is shorter than it says; the file is damaged or cut off: write it again")
    }

    pub fn broken(&self, problem: &str) -> ReadError {
        broken(format!("{} {problem}", self.what))
    }
}

/// The memory that a file may take.
pub(in crate::read::usd) struct Room<'m> {
    used: u64,
    most: u64,
    monitor: &'m dyn Monitor,
}

/// Layers of trees unpack to three times their bytes. What is small has room for its names at any rate.
const MOST_TIMES: u64 = 128;
const LEAST: u64 = 4 << 20;

impl<'m> Room<'m> {
    /// For a file of so many bytes.
    pub fn new(bytes: usize, monitor: &'m dyn Monitor) -> Self {
        Self { used: 0, most: MOST_TIMES.saturating_mul(bytes as u64).saturating_add(LEAST), monitor }
    }

    /// Counts `count` elements of `size` bytes that are about to be unpacked.
    ///
    /// # Errors
    /// Where all together is more than the file may take, or than the monitor admits; where nobody wants it any more.
    pub fn take(&mut self, count: usize, size: usize) -> Result<(), ReadError> {
        self.used = self.used.saturating_add((count as u64).saturating_mul(size as u64));
        if self.used > self.most {
            return Err(broken(format!(
                "it unpacks to more than {MOST_TIMES} times its bytes, which no model does; write it again"
            )));
        }
        self.monitor.check()?;
        // Meshes are made of it, while it is there.
        self.monitor.admit(READING, self.used.saturating_mul(2), ADVICE)?;
        Ok(())
    }
}
