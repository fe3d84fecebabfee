//! What the tests and benchmarks across crates share.

pub mod fixtures;
