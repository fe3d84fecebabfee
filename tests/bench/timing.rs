//! Seconds on the wall and of the processor.

use std::time::Instant;

/// What some work gave, and the seconds that it took.
pub struct Timed<T> {
    pub value: T,
    pub cpu: f64,
    pub wall: f64,
}

/// Does some work; `cpu` is meaningful where `work` stays on the calling thread.
pub fn timed<T>(work: impl FnOnce() -> T) -> Timed<T> {
    let (clock, started) = (cpu_seconds(), Instant::now());
    let value = work();
    let wall = started.elapsed().as_secs_f64();
    let cpu = clock.zip(cpu_seconds()).map_or(wall, |(before, after)| after - before);
    Timed { value, cpu, wall }
}

/// What the calling thread has used, where the system tells.
fn cpu_seconds() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(status.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}

pub fn median(mut some: Vec<f64>) -> f64 {
    some.sort_by(f64::total_cmp);
    some[some.len() / 2]
}
