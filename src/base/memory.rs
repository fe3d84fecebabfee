//! How much memory work takes, told before it is taken.
//!
//! A [`Monitor`] says how many bytes may be held at once ([`Monitor::memory_limit`]). Each stage
//! forecasts its peak, what it gives included, and asks [`Monitor::admit`] before it allocates; where the
//! peak cannot be known, it asks again whenever a list is about to move to a larger place. What a caller
//! keeps meanwhile counts too: it hands its stages a monitor that is [`Holding`] that many bytes.
//! Forecasts count what grows with the tree and leave out the rest ([`SLACK_BYTES`]).
//!
//! [`Monitor`]: crate::monitor::Monitor
//! [`Monitor::memory_limit`]: crate::monitor::Monitor::memory_limit
//! [`Monitor::admit`]: crate::monitor::Monitor::admit
//! [`Holding`]: crate::monitor::Holding

use std::fmt;

/// What a stage may hold beyond its forecast: stacks, tables of constants, lists of pieces, and the
/// scratch memory of threads. Does not grow with the tree.
pub const SLACK_BYTES: u64 = 4 << 20;

/// Work that was refused because it would hold more memory than it may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{doing} would take {}; {advice}, or raise the limit 'memory'",
    more(*needs_bytes, *limit_bytes)
)]
pub struct OverMemory {
    /// What was about to be done: `sweeping the surface`.
    pub doing: &'static str,
    /// All that would be held at once, what is there already included.
    pub needs_bytes: u64,
    /// What the monitor allows.
    pub limit_bytes: u64,
    /// What to turn down: `lower sides`.
    pub advice: &'static str,
}

/// How much is more than the limit; to the byte where fewer digits would say that it is as much.
fn more(needs_bytes: u64, limit_bytes: u64) -> String {
    let (needs, limit) = (Bytes(needs_bytes).to_string(), Bytes(limit_bytes).to_string());
    if needs == limit {
        return format!("{needs_bytes} B, more than the memory limit of {limit_bytes} B");
    }
    format!("{needs}, more than the memory limit of {limit}")
}

/// An amount of memory as people read it: three digits, powers of 1024.
///
/// ```
/// use linden_base::memory::Bytes;
/// assert_eq!(Bytes(999).to_string(), "999 B");
/// assert_eq!(Bytes(1_288_490_189).to_string(), "1.20 GiB");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut amount, mut unit) = (self.0 as f64, "B");
        for larger in ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"] {
            // What would be rounded to 1000 is said in the larger unit.
            if amount < 999.5 {
                break;
            }
            (amount, unit) = (amount / 1024.0, larger);
        }
        let decimals = match amount {
            _ if unit == "B" => 0,
            a if a < 9.995 => 2,
            a if a < 99.95 => 1,
            _ => 0,
        };
        write!(f, "{amount:.decimals$} {unit}")
    }
}

/// Bytes of `count` items of a type.
pub const fn bytes_of<T>(count: usize) -> u64 {
    (count as u64).saturating_mul(size_of::<T>() as u64)
}

/// Bytes that a list of `count` items holds at its worst when it grew one by one: it lives in two
/// places while it moves to one twice as large.
pub const fn bytes_grown<T>(count: usize) -> u64 {
    if count == 0 {
        return 0;
    }
    // No list starts with less than four.
    let places = if count < 4 { 4 } else { count.next_power_of_two() };
    bytes_of::<T>(places).saturating_add(bytes_of::<T>(places / 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_have_three_digits() {
        for (bytes, text) in [
            (0, "0 B"),
            (1023, "1.00 KiB"),
            (10_230, "9.99 KiB"),
            (10_240, "10.0 KiB"),
            (102_399, "100 KiB"),
            (1 << 20, "1.00 MiB"),
            (u64::MAX, "16.0 EiB"),
        ] {
            assert_eq!(Bytes(bytes).to_string(), text);
        }
    }

    #[test]
    fn what_is_refused_is_said_to_be_more_than_the_limit() {
        let refused = |needs_bytes| {
            OverMemory { doing: "growing", needs_bytes, limit_bytes: 1 << 20, advice: "use less" }.to_string()
        };
        let text = "growing would take 1048577 B, more than the memory limit of 1048576 B; use less, or raise the limit 'memory'";
        assert_eq!(refused((1 << 20) + 1), text);
        let text = "growing would take 2.00 MiB, more than the memory limit of 1.00 MiB; use less, or raise the limit 'memory'";
        assert_eq!(refused(2 << 20), text);
    }

    #[test]
    fn a_list_that_grows_one_by_one_takes_no_more_than_is_said() {
        let mut list: Vec<u64> = Vec::new();
        for count in 1..5000 {
            let before = list.capacity();
            list.push(0);
            let moving = if list.capacity() == before { 0 } else { before };
            assert!(bytes_of::<u64>(list.capacity() + moving) <= bytes_grown::<u64>(count), "{count}");
        }
    }
}
