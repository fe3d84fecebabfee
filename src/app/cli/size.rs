//! How large a tree or a forest will be, as `linden show` says it.

use std::collections::BTreeMap;

use linden::memory::Bytes;
use linden::recipe::Recipe;
use linden_exporters::{Options, REGISTRY, USUAL};
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
    /// Of all files, by format, with its usual options; null where the format has no estimate.
    bytes: BTreeMap<&'static str, Option<u64>>,
    /// From the recipe to a file of the usual format, about; on another machine it may be several times as long.
    seconds: f64,
}

impl Outlook {
    pub(super) fn size(&self, recipe: &Recipe) -> SizeRow {
        let formats = REGISTRY.iter().map(|exporter| exporter.format());
        let usual = USUAL.format();
        SizeRow {
            is_whole: self.sample.is_whole(),
            nodes: self.sample.nodes().round(),
            leaves: self.sample.leaves().round(),
            triangles: self.estimate.triangles as f64,
            bytes: formats.map(|f| (f.id, self.estimate.bytes(f, &Options::new(f)))).collect(),
            seconds: self.export_s(recipe, &[(usual, &Options::new(usual))], 1),
        }
    }
}

impl ForestOutlook {
    /// Each different tree once.
    pub(super) fn size(&self) -> SizeRow {
        let formats = REGISTRY.iter().map(|exporter| exporter.format());
        let usual = USUAL.format();
        SizeRow {
            is_whole: false,
            nodes: self.nodes().round(),
            leaves: self.leaves().round(),
            triangles: self.triangles(),
            bytes: formats.map(|f| (f.id, self.bytes(f).map(|bytes| bytes as u64))).collect(),
            seconds: self.export_s(&[(usual, &Options::new(usual))]),
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
        let usual = USUAL.format().id;
        let bytes = self.bytes.get(usual).copied().flatten();
        let size =
            bytes.map_or_else(|| "of unknown size".to_owned(), |bytes| format!("about {}", Bytes(bytes)));
        text.push_str(&format!("  {size} as {usual}, in about {}\n", time(self.seconds)));
        text
    }
}

/// A count; in powers of ten where it is too long to read digit by digit.
pub(super) fn count(n: f64) -> String {
    if n < 1e12 { indicatif::HumanCount(n as u64).to_string() } else { format!("{n:.1e}") }
}
