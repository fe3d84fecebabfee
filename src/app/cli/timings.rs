//! `--timings` and `--json`: what an export took and wrote, for reports of slowness and for scripts.

use std::time::{Duration, Instant};

use clap::Args;
use linden_exporters::Written;
use serde::Serialize;

use super::outputs::{list_with, say_kept};
use crate::cache;
use crate::exit::{say, usage};
use crate::system::{cpu_time, peak_memory};

/// What a command says of what it wrote, beside the list of files or in its place.
#[derive(Args)]
pub struct Telling {
    /// Say what each step took, with threads, bytes and memory, on standard error
    #[arg(long)]
    timings: bool,

    /// The files, and what each step took, on standard output, machine-readable, in place of the list of files
    #[arg(long)]
    json: bool,
}

impl Telling {
    /// Refuses the document where a file itself goes to standard output.
    pub fn ensure_free(&self, streams: usize) -> anyhow::Result<()> {
        if self.json && streams > 0 {
            return Err(usage("--json: the file itself is on standard output; write it with -o FILE"));
        }
        Ok(())
    }

    /// Tells what was written, where no file itself is on standard output; `told` stands behind the first file of the list.
    pub fn tell(
        &self,
        timings: &Timings,
        subject: &Subject,
        files: &[File],
        streams: usize,
        told: Option<&str>,
    ) -> anyhow::Result<()> {
        if self.json {
            return super::print(&timings.json(subject, files)?);
        }
        self.say_steps(timings, files);
        if streams == 0 { list_with(files, told) } else { Ok(()) }
    }

    /// The same where one line is in the place of a long list of files.
    pub fn tell_in_a_line(
        &self,
        timings: &Timings,
        subject: &Subject,
        files: &[File],
        line: &str,
    ) -> anyhow::Result<()> {
        if self.json {
            return super::print(&timings.json(subject, files)?);
        }
        self.say_steps(timings, files);
        say_kept(files);
        super::print(line)
    }

    fn say_steps(&self, timings: &Timings, files: &[File]) {
        if self.timings {
            say(timings.table(files).trim_end());
        }
    }
}

/// What was made into files.
#[derive(Default, Serialize)]
pub struct Subject {
    /// As it was typed, several with spaces between.
    pub source: String,
    /// Each by itself.
    pub sources: Vec<String>,
    /// Of a forest: how many trees stand there, and how many of them are grown: the others are copies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub places: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distinct: Option<usize>,
}

impl Subject {
    /// Some sources, printable.
    pub fn of(sources: impl IntoIterator<Item = String>) -> Self {
        let sources: Vec<String> = sources.into_iter().collect();
        Self { source: sources.join(" "), sources, ..Self::default() }
    }
}

/// A clock for the steps of a command.
pub struct Timings {
    started: Instant,
    /// When the step under way began, and what all threads had worked then.
    last: (Instant, Option<Duration>),
    steps: Vec<Step>,
    triangles: Vec<u64>,
    ages: Vec<AgeTriangles>,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Step {
    #[serde(rename = "step")]
    name: &'static str,
    /// Of several, the one that it was for.
    #[serde(skip_serializing_if = "Option::is_none")]
    age: Option<String>,
    seconds: f64,
    /// Of all threads; null where the system does not tell.
    cpu_seconds: Option<f64>,
}

/// What a run took so far. The names of `--json`: scripts rely on them.
#[derive(Serialize)]
pub struct Run {
    linden: &'static str,
    /// Threads that there may be.
    threads: usize,
    seconds: f64,
    /// Of all threads; null where the system does not tell.
    cpu_seconds: Option<f64>,
    /// Of the whole process; null where the system does not tell.
    peak_memory_bytes: Option<u64>,
    /// Pictures out of the cache; null where it is off.
    cache: Option<Kept>,
}

/// The names of `--json`: scripts rely on them.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    run: Run,
    #[serde(flatten)]
    subject: &'a Subject,
    /// In their order, one after the other: together they take as long as the whole.
    steps: &'a [Step],
    /// Of each level, finest first; of several ages those of the last.
    triangles: &'a [u64],
    /// Of each age, where there are several.
    #[serde(skip_serializing_if = "<[AgeTriangles]>::is_empty")]
    ages: &'a [AgeTriangles],
    files: &'a [File],
}

#[derive(Serialize)]
struct AgeTriangles {
    age: String,
    triangles: Vec<u64>,
}

/// Pictures, and files of pictures, that were asked for.
#[derive(Serialize)]
struct Kept {
    /// They were there.
    hits: u64,
    /// They were drawn or compressed.
    misses: u64,
}

/// A file that was written, or left alone.
#[derive(Clone, Serialize)]
pub struct File {
    /// Printable.
    pub path: String,
    pub bytes: u64,
    /// Whether it was there with the same bytes, and was left alone.
    pub kept: bool,
}

impl From<&Written> for File {
    fn from(written: &Written) -> Self {
        Self { path: crate::paths::show(&written.path), bytes: written.bytes, kept: written.kept }
    }
}

impl File {
    /// Of all that was written.
    pub fn all(written: &[Written]) -> Vec<Self> {
        written.iter().map(Self::from).collect()
    }
}

impl Timings {
    /// Starts the clock.
    pub fn new() -> Self {
        let now = Instant::now();
        let (steps, triangles, ages) = (Vec::new(), Vec::new(), Vec::new());
        Self { started: now, last: (now, cpu_time()), steps, triangles, ages }
    }

    /// The step that is over now.
    pub fn lap(&mut self, name: &'static str) {
        self.lap_of(name, None);
    }

    /// The same of one of several ages.
    pub fn lap_of(&mut self, name: &'static str, age: Option<&str>) {
        let (now, worked) = (Instant::now(), cpu_time());
        let cpu_seconds = worked.zip(self.last.1).map(|(now, then)| now.saturating_sub(then).as_secs_f64());
        let seconds = (now - self.last.0).as_secs_f64();
        self.steps.push(Step { name, age: age.map(str::to_owned), seconds, cpu_seconds });
        self.last = (now, worked);
    }

    /// The triangles of each level that is written, finest first, of one of several ages.
    pub fn count(&mut self, age: Option<&str>, triangles: Vec<u64>) {
        if let Some(age) = age {
            self.ages.push(AgeTriangles { age: age.to_owned(), triangles: triangles.clone() });
        }
        self.triangles = triangles;
    }

    /// What was counted.
    pub fn triangles(&self) -> &[u64] {
        &self.triangles
    }

    /// What the run took up to the last step.
    pub fn run(&self) -> Run {
        Run {
            linden: linden::recipe::VERSION,
            threads: rayon::current_num_threads(),
            seconds: (self.last.0 - self.started).as_secs_f64(),
            cpu_seconds: self.steps.iter().map(|step| step.cpu_seconds).sum(),
            peak_memory_bytes: peak_memory(),
            cache: cache::counts().map(|cache::Counts { hits, misses }| Kept { hits, misses }),
        }
    }

    /// For scripts.
    fn json(&self, subject: &Subject, files: &[File]) -> anyhow::Result<String> {
        let Self { steps, triangles, ages, .. } = self;
        let report = Report { run: self.run(), subject, steps, triangles, ages, files };
        Ok(serde_json::to_string_pretty(&report)? + "\n")
    }

    /// For people.
    fn table(&self, files: &[File]) -> String {
        let run = self.run();
        let cpu =
            |seconds: Option<f64>| seconds.map_or_else(|| format!("{:>9}", "-"), |s| format!("{s:9.3}"));
        let mut text = format!("{:12}{:>9} {:>9}\n", "step", "seconds", "CPU");
        for Step { name, age, seconds, cpu_seconds } in &self.steps {
            let age = age.as_deref().map(|age| format!("  {age}")).unwrap_or_default();
            text += &format!("{name:12}{seconds:9.3} {}{age}\n", cpu(*cpu_seconds));
        }
        text += &format!("{:12}{:9.3} {}\n", "all", run.seconds, cpu(run.cpu_seconds));
        let bytes = files.iter().map(|file| file.bytes).sum();
        let peak = run.peak_memory_bytes.map_or_else(String::new, |bytes| {
            format!(", at most {} of memory", indicatif::BinaryBytes(bytes))
        });
        let noun = if files.len() == 1 { "file" } else { "files" };
        text += &format!(
            "{} {noun} of {}, {} threads{peak}\n",
            files.len(),
            indicatif::BinaryBytes(bytes),
            run.threads
        );
        text += &match run.cache {
            Some(Kept { hits, misses }) => format!("pictures: {hits} out of the cache, {misses} made\n"),
            None => "pictures: all made, without the cache\n".to_owned(),
        };
        text
    }
}
