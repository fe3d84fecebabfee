//! What became of a file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::paths::show;

/// Whether a file is what its recipe grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Every byte of it, and of the files beside it.
    SameBytes,
    /// The tree, by its hashes; the bytes were not compared.
    SameTree,
    /// The tree is the same, the file is not.
    OtherBytes,
    /// Another tree grows.
    OtherTree,
    /// It says nothing that could be compared.
    Unchecked,
    /// An index lists it, and it is not there.
    Missing,
    /// It cannot be read, or does not grow.
    Failed,
}

impl Outcome {
    pub const ALL: [Self; 7] = [
        Self::SameBytes,
        Self::SameTree,
        Self::OtherBytes,
        Self::OtherTree,
        Self::Unchecked,
        Self::Missing,
        Self::Failed,
    ];

    /// In eleven letters at most.
    pub const fn word(self) -> &'static str {
        match self {
            Self::SameBytes => "same bytes",
            Self::SameTree => "same tree",
            Self::OtherBytes => "other bytes",
            Self::OtherTree => "OTHER TREE",
            Self::Unchecked => "unchecked",
            Self::Missing => "missing",
            Self::Failed => "failed",
        }
    }

    pub fn is_good(self, only_bytes: bool) -> bool {
        self == Self::SameBytes || (self == Self::SameTree && !only_bytes)
    }
}

/// A file with its outcome.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    #[serde(skip)]
    pub path: PathBuf,
    pub file: String,
    pub outcome: Outcome,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The version that wrote it.
    pub version: Option<String>,
    /// Whether these are the same; null where the file does not say its hashes.
    pub skeleton: Option<bool>,
    pub organs: Option<bool>,
    /// The format and its options that give these bytes.
    pub format: Option<&'static str>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub options: BTreeMap<&'static str, String>,
    /// Files beside it that were compared too.
    #[serde(skip)]
    pub beside: Vec<PathBuf>,
}

impl Row {
    pub fn new(path: &Path, outcome: Outcome) -> Self {
        Self {
            path: path.to_owned(),
            file: show(path),
            outcome,
            reason: None,
            version: None,
            skeleton: None,
            organs: None,
            format: None,
            options: BTreeMap::new(),
            beside: Vec::new(),
        }
    }

    pub fn because(mut self, reason: impl Into<String>) -> Self {
        self.reason = Some(reason.into());
        self
    }
}
