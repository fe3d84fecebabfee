//! `--timings`: what an export took, for reports of slowness.

use std::time::{Duration, Instant};

use linden_exporters::Written;
use serde::Serialize;

use crate::cache;
use crate::system::{cpu_time, peak_memory};

/// A clock for the steps of a command.
pub struct Timings {
    started: Instant,
    /// When the step under way began, and what all threads had worked then.
    last: (Instant, Option<Duration>),
    steps: Vec<Step>,
    triangles: Vec<u64>,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Step {
    #[serde(rename = "step")]
    name: &'static str,
    seconds: f64,
    /// Of all threads; null where the system does not tell.
    cpu_seconds: Option<f64>,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Report<'a> {
    linden: &'static str,
    source: &'a str,
    /// Threads that there may be.
    threads: usize,
    seconds: f64,
    /// Of all threads; null where the system does not tell.
    cpu_seconds: Option<f64>,
    /// Of the whole process; null where the system does not tell.
    peak_memory_bytes: Option<u64>,
    /// Pictures out of the cache; null where it is off.
    cache: Option<Kept>,
    /// In their order, one after the other: together they take as long as the whole.
    steps: &'a [Step],
    /// Of each level, finest first.
    triangles: &'a [u64],
    files: Vec<File>,
}

/// Pictures, and files of pictures, that were asked for.
#[derive(Serialize)]
struct Kept {
    /// They were there.
    hits: u64,
    /// They were drawn or compressed.
    misses: u64,
}

#[derive(Serialize)]
struct File {
    path: String,
    bytes: u64,
}

impl Timings {
    /// Starts the clock.
    pub fn new() -> Self {
        let now = Instant::now();
        Self { started: now, last: (now, cpu_time()), steps: Vec::new(), triangles: Vec::new() }
    }

    /// The step that is over now.
    pub fn lap(&mut self, name: &'static str) {
        let (now, worked) = (Instant::now(), cpu_time());
        let cpu_seconds = worked.zip(self.last.1).map(|(now, then)| now.saturating_sub(then).as_secs_f64());
        self.steps.push(Step { name, seconds: (now - self.last.0).as_secs_f64(), cpu_seconds });
        self.last = (now, worked);
    }

    /// The triangles of each level that is written, finest first.
    pub fn count(&mut self, triangles: Vec<u64>) {
        self.triangles = triangles;
    }

    /// What was counted.
    pub fn triangles(&self) -> &[u64] {
        &self.triangles
    }

    fn report<'a>(&'a self, source: &'a str, written: &[Written]) -> Report<'a> {
        let file = |written: &Written| File { path: crate::paths::show(&written.path), bytes: written.bytes };
        Report {
            linden: linden::recipe::VERSION,
            source,
            threads: rayon::current_num_threads(),
            seconds: (self.last.0 - self.started).as_secs_f64(),
            cpu_seconds: self.steps.iter().map(|step| step.cpu_seconds).sum(),
            peak_memory_bytes: peak_memory(),
            cache: cache::counts().map(|cache::Counts { hits, misses }| Kept { hits, misses }),
            steps: &self.steps,
            triangles: &self.triangles,
            files: written.iter().map(file).collect(),
        }
    }

    /// For scripts.
    ///
    /// # Errors
    /// None that is known of.
    pub fn json(&self, source: &str, written: &[Written]) -> anyhow::Result<String> {
        Ok(serde_json::to_string_pretty(&self.report(source, written))? + "\n")
    }

    /// For people.
    pub fn table(&self, source: &str, written: &[Written]) -> String {
        let report = self.report(source, written);
        let cpu =
            |seconds: Option<f64>| seconds.map_or_else(|| format!("{:>9}", "-"), |s| format!("{s:9.3}"));
        let mut text = format!("{:12}{:>9} {:>9}\n", "step", "seconds", "CPU");
        for Step { name, seconds, cpu_seconds } in report.steps {
            text += &format!("{name:12}{seconds:9.3} {}\n", cpu(*cpu_seconds));
        }
        text += &format!("{:12}{:9.3} {}\n", "all", report.seconds, cpu(report.cpu_seconds));
        let bytes = report.files.iter().map(|file| file.bytes).sum();
        let peak = report.peak_memory_bytes.map_or_else(String::new, |bytes| {
            format!(", at most {} of memory", indicatif::BinaryBytes(bytes))
        });
        let files = if report.files.len() == 1 { "file" } else { "files" };
        text += &format!(
            "{} {files} of {}, {} threads{peak}\n",
            report.files.len(),
            indicatif::BinaryBytes(bytes),
            report.threads
        );
        text += &match report.cache {
            Some(Kept { hits, misses }) => format!("pictures: {hits} out of the cache, {misses} made\n"),
            None => "pictures: all made, without the cache\n".to_owned(),
        };
        text
    }
}
