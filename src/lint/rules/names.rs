//! What things are called.

use std::collections::BTreeMap;

use super::{Limits, Rule};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const RULE: Rule = Rule {
    id: "names",
    checks: "materials and nodes without a name, of the same name, or with the name that a modeller gives by itself",
    why: "scripts, material slots and reimports go by names",
    mend: "name them by what they are: oak_bark, oak_leaves",
    severity: Severity::Info,
    limits: &[],
    needs: &[Aspect::Names],
    check,
};

/// Names that modellers give by themselves, but for numbers behind them.
const GIVEN: [&str; 19] = [
    "default",
    "material",
    "mesh",
    "node",
    "object",
    "cube",
    "plane",
    "cylinder",
    "sphere",
    "icosphere",
    "cone",
    "circle",
    "group",
    "geometry",
    "lambert",
    "phong",
    "blinn",
    "standardsurface",
    "untitled",
];

fn check(asset: &Asset, _: &Limits, found: &mut Findings<'_>) {
    let mut materials = asset.materials_by_name();
    for unused in asset.unused_materials() {
        *materials.entry(unused.name.trim()).or_default() += 1;
    }
    look("material", &materials, found);
    // A node of several materials is a piece of each.
    let mut nodes: Vec<(&str, usize)> = Vec::new();
    for (level, piece) in
        asset.levels.iter().flat_map(|level| level.pieces.iter().map(move |piece| (level, piece)))
    {
        let node = (piece.node.as_str(), level.number as usize);
        if !nodes.contains(&node) && nodes.len() < MOST {
            nodes.push(node);
        }
    }
    let nodes: std::collections::BTreeSet<&str> = nodes.into_iter().map(|(name, _)| name).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for name in nodes {
        *counts.entry(name.trim()).or_default() += 1;
    }
    look("node", &counts, found);
}

/// Nodes that are looked at.
const MOST: usize = 1000;

fn look(what: &str, counts: &BTreeMap<&str, usize>, found: &mut Findings<'_>) {
    for (&name, &count) in counts {
        let plain =
            name.trim_end_matches(|c: char| c.is_ascii_digit() || "._- ()".contains(c)).to_lowercase();
        if name.is_empty() {
            found.over(None, format!("{count} {what}(s) without a name"), count as f64, 0.0);
        } else if plain.is_empty() || GIVEN.contains(&plain.as_str()) {
            found.at(name, format!("a {what} is called by what a program calls it by itself"));
        }
        if !name.is_empty() && count > 1 {
            found.over(Some(name), format!("{count} {what}s are called so"), count as f64, 1.0);
        }
    }
}
