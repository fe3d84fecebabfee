//! How large a tree or a forest will be, as `linden show` says it.

use std::collections::BTreeMap;

use linden::memory::Bytes;
use linden::recipe::Recipe;
use linden_exporters::{Options, REGISTRY};
use serde::Serialize;

use crate::forecast::{ForestOutlook, Outlook, round, time};

/// What grows, and what is written of it.
#[derive(Serialize)]
pub(super) struct SizeRow {
    /// Whether these are exact: the tree was grown as it is.
    #[serde(skip)]
    is_whole: bool,
    nodes: f64,
    leaves: f64,
    /// Of the finest level.
    triangles: f64,
    /// Of all files, by format, with its usual options.
    bytes: BTreeMap<&'static str, u64>,
    /// From the recipe to a GLB, about; on another machine it may be several times as long.
    seconds: f64,
}

/// What pages say the size of.
const USUAL: &str = "glb";

impl Outlook {
    pub(super) fn size(&self, recipe: &Recipe) -> SizeRow {
        let formats = REGISTRY.iter().map(|exporter| exporter.format());
        let glb = formats.clone().find(|format| format.id == USUAL);
        let seconds = glb.map_or(0.0, |glb| self.export_s(recipe, &[(glb, &Options::new(glb))], 1));
        SizeRow {
            is_whole: self.sample.is_whole(),
            nodes: self.sample.nodes().round(),
            leaves: self.sample.leaves().round(),
            triangles: self.estimate.triangles as f64,
            bytes: formats.map(|own| (own.id, self.estimate.bytes(own, &Options::new(own)))).collect(),
            seconds,
        }
    }
}

impl ForestOutlook {
    /// Each different tree once.
    pub(super) fn size(&self) -> SizeRow {
        let formats = REGISTRY.iter().map(|exporter| exporter.format());
        let glb = formats.clone().find(|format| format.id == USUAL);
        SizeRow {
            is_whole: false,
            nodes: self.nodes().round(),
            leaves: self.leaves().round(),
            triangles: self.triangles(),
            bytes: formats.map(|own| (own.id, self.bytes(own) as u64)).collect(),
            seconds: glb.map_or(0.0, |glb| self.export_s(&[(glb, &Options::new(glb))])),
        }
    }
}

impl SizeRow {
    /// For the page. What is not exact is said to two digits.
    pub(super) fn lines(&self) -> String {
        let is_exact = self.is_whole;
        let shown = |n: f64| count(if is_exact { n } else { round(n) as f64 });
        let about = if is_exact { "" } else { "about " };
        let mut text = format!("  {about}{} nodes", shown(self.nodes));
        if self.leaves > 0.0 {
            text.push_str(&format!(", {} leaves", shown(self.leaves)));
        }
        text.push_str(&format!(", {} triangles\n", shown(self.triangles)));
        if let Some(&bytes) = self.bytes.get(USUAL) {
            text.push_str(&format!("  about {} as {USUAL}, in about {}\n", Bytes(bytes), time(self.seconds)));
        }
        text
    }
}

/// A count; in powers of ten where it is too long to read digit by digit.
pub(super) fn count(n: f64) -> String {
    if n < 1e12 { indicatif::HumanCount(n as u64).to_string() } else { format!("{n:.1e}") }
}
