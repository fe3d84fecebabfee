//! Jobs for programs that spread work over machines: printed, to be edited and submitted as they are.

use std::path::Path;

use clap::ValueEnum;
use linden::knob::printable;

use crate::paths::show;

/// What runs a batch on many machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// Open Job Description 2023-09 (openjd run; AWS Deadline Cloud)
    Openjd,
    /// A job array of Slurm (sbatch)
    Slurm,
    /// An indexed job of Kubernetes (kubectl apply)
    Kubernetes,
    /// GNU parallel, on this machine or several
    Parallel,
}

/// What a job is about.
pub struct Job<'a> {
    pub manifest: &'a Path,
    pub out: &'a Path,
    /// How many trees there are, 1 or more.
    pub trees: usize,
    /// Into how many parts engines divide them that number parts.
    pub shards: usize,
}

/// An argument of a shell.
fn shell(text: &str) -> String {
    shell_words::quote(text).into_owned()
}

/// A string of YAML, which are those of JSON.
fn yaml(text: &str) -> String {
    serde_json::to_string(text).unwrap_or_default()
}

impl Engine {
    /// The job as it stands in `templates`, with `@words@` for what differs.
    const fn template(self) -> &'static str {
        match self {
            Self::Openjd => include_str!("templates/openjd.yaml"),
            Self::Slurm => include_str!("templates/slurm.sh"),
            Self::Kubernetes => include_str!("templates/kubernetes.yaml"),
            Self::Parallel => include_str!("templates/parallel.sh"),
        }
    }

    /// The job's text.
    pub fn print(self, job: &Job<'_>) -> String {
        let (manifest, out) = (show(job.manifest), show(job.out));
        let merge = format!("linden batch {} --out {} --merge", shell(&manifest), shell(&out));
        let words = [
            ("manifest_plain", printable(&manifest)),
            ("manifest_json", yaml(&manifest)),
            ("out_json", yaml(&out)),
            ("manifest_sh", shell(&manifest)),
            ("out_sh", shell(&out)),
            // GNU parallel hands its words to a shell once more.
            ("manifest_twice", shell(&shell(&manifest))),
            ("out_twice", shell(&shell(&out))),
            ("merge_sh", shell(&merge)),
            ("last_tree", (job.trees - 1).to_string()),
            ("shards", job.shards.to_string()),
            ("last", (job.shards - 1).to_string()),
            ("at_once", job.shards.min(10).to_string()),
        ];
        // One pass: a path may hold what looks like a word.
        let mut parts = self.template().split('@');
        let mut text = parts.next().unwrap_or_default().to_owned();
        while let (Some(word), Some(plain)) = (parts.next(), parts.next()) {
            let found = words.iter().find(|(name, _)| *name == word);
            text += found.map_or(word, |(_, value)| value);
            text += plain;
        }
        text
    }
}
