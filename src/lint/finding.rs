//! What the rules say of an asset.

use linden_base::knob::excerpt;
use serde::{Deserialize, Serialize};

use crate::asset::{Asset, FileFormat};
use crate::config::Config;
use crate::rules::RULES;

/// How grave something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The rule is not looked at.
    Off,
    /// Good to know.
    Info,
    /// To be mended.
    Warn,
    /// Not to be shipped.
    Error,
}

impl Severity {
    /// All, the gravest last.
    pub const ALL: [Self; 4] = [Self::Off, Self::Info, Self::Warn, Self::Error];

    /// As configurations and reports have it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Info => "info",
            Self::Warn => "warn",
            Self::Error => "error",
        }
    }
}

/// Something that a rule found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its id.
    pub rule: &'static str,
    /// How grave it is.
    pub severity: Severity,
    /// The mesh, material, picture or level; `None`: the whole asset.
    pub place: Option<String>,
    /// With numbers, for people.
    pub message: String,
    /// The number that was measured.
    pub measured: Option<f64>,
    /// What it was held against.
    pub limit: Option<f64>,
}

/// A rule that could not look.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotLooked {
    /// Its id.
    pub rule: &'static str,
    /// For people.
    pub why: String,
}

/// What an asset is made of, whatever the rules say.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Numbers {
    /// Of each level, the finest first.
    pub triangles: Vec<u64>,
    /// Of each level.
    pub draw_calls: Vec<usize>,
    /// Of the finest level, each mesh once a piece.
    pub vertices: u64,
    /// Triangles of one material each.
    pub meshes: usize,
    /// In the file, in use or not.
    pub materials: usize,
    /// Pictures.
    pub textures: usize,
    /// Of the finest level, along Y.
    pub height_m: Option<f64>,
}

/// All that is said of an asset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// As the caller names it.
    pub file: String,
    /// What it was read from.
    pub format: FileFormat,
    /// What it is made of.
    pub numbers: Numbers,
    /// In the order of the rules.
    pub findings: Vec<Finding>,
    /// Rules that could not look at all there is.
    pub not_looked_at: Vec<NotLooked>,
}

impl Report {
    /// How many findings are so grave.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.severity == severity).count()
    }
}

/// Takes what one rule finds.
pub(crate) struct Findings<'a> {
    rule: &'static str,
    severity: Severity,
    list: &'a mut Vec<Finding>,
}

impl Findings<'_> {
    /// Of the whole asset.
    pub fn add(&mut self, message: impl Into<String>) {
        self.push(None, message.into(), None);
    }

    /// Of something in it.
    pub fn at(&mut self, place: &str, message: impl Into<String>) {
        self.push(Some(place), message.into(), None);
    }

    /// With what was measured and what it was held against.
    pub fn over(&mut self, place: Option<&str>, message: impl Into<String>, measured: f64, limit: f64) {
        self.push(place, message.into(), Some((measured, limit)));
    }

    fn push(&mut self, place: Option<&str>, message: String, numbers: Option<(f64, f64)>) {
        self.list.push(Finding {
            rule: self.rule,
            severity: self.severity,
            place: place.map(excerpt),
            message,
            measured: numbers.map(|(measured, _)| measured),
            limit: numbers.map(|(_, limit)| limit),
        });
    }
}

pub(crate) fn report(asset: &Asset, config: &Config) -> Report {
    let (mut list, mut not_looked_at) = (Vec::new(), Vec::new());
    for rule in RULES {
        let severity = config.severity(rule);
        if severity == Severity::Off {
            continue;
        }
        let unseen = asset.unseen.iter().filter(|unseen| rule.needs.contains(&unseen.aspect));
        not_looked_at.extend(unseen.map(|unseen| NotLooked { rule: rule.id, why: unseen.why.clone() }));
        let mut findings = Findings { rule: rule.id, severity, list: &mut list };
        (rule.check)(asset, &config.limits(rule), &mut findings);
    }
    not_looked_at.dedup();
    Report {
        file: asset.name.clone(),
        format: asset.format,
        numbers: numbers(asset),
        findings: list,
        not_looked_at,
    }
}

fn numbers(asset: &Asset) -> Numbers {
    Numbers {
        triangles: asset.levels.iter().map(|level| asset.triangles_of(level)).collect(),
        draw_calls: asset.levels.iter().map(|level| level.pieces.len()).collect(),
        vertices: asset.finest().iter().map(|piece| asset.meshes[piece.mesh].vertices as u64).sum(),
        meshes: asset.meshes.len(),
        materials: asset.materials.len(),
        textures: asset.textures.len(),
        height_m: crate::mesh::bounds(asset, asset.finest()).map(|[low, high]| f64::from(high.y - low.y)),
    }
}
