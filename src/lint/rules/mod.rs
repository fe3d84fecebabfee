//! The rules: a module each, and a line each in one table.

mod alpha_blend;
mod budgets;
mod collider;
mod degenerate;
mod duplicates;
mod height;
mod lod_chain;
mod lod_missing;
mod manifold;
mod names;
mod normals;
mod pivot;
mod scale;
mod texel_density;
mod textures;
mod uv_missing;
mod uv_overlap;
mod winding;

use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

/// Looks for one kind of fault.
pub struct Rule {
    /// As configurations and reports name it.
    pub id: &'static str,
    /// What it looks for.
    pub checks: &'static str,
    /// Why that matters.
    pub why: &'static str,
    /// What to do about it.
    pub mend: &'static str,
    /// How grave it is where nothing else is said.
    pub severity: Severity,
    /// The numbers that can be set.
    pub limits: &'static [Limit],
    /// What it must know of an asset.
    pub(crate) needs: &'static [Aspect],
    pub(crate) check: fn(&Asset, &Limits, &mut Findings<'_>),
}

/// A number that a rule holds an asset against.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// As configurations name it.
    pub name: &'static str,
    /// Empty for a bare number.
    pub unit: &'static str,
    /// In the first profile.
    pub usual: f64,
    /// In a line.
    pub help: &'static str,
}

/// The limits of a rule, settled.
pub(crate) struct Limits(Vec<(&'static str, f64)>);

impl Limits {
    pub(crate) const fn new(values: Vec<(&'static str, f64)>) -> Self {
        Self(values)
    }

    /// A limit of the rule's row; the tests run all rules, so that none asks for another.
    pub(crate) fn of(&self, name: &str) -> f64 {
        self.0.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }
}

const fn limit(name: &'static str, usual: f64, unit: &'static str, help: &'static str) -> Limit {
    Limit { name, unit, usual, help }
}

/// All rules, in the order in which reports have them.
pub static RULES: &[Rule] = &[
    budgets::TRIANGLES,
    budgets::DRAW_CALLS,
    budgets::MATERIALS,
    budgets::MESH_VERTICES,
    lod_chain::RULE,
    lod_missing::RULE,
    degenerate::RULE,
    duplicates::RULE,
    manifold::NON_MANIFOLD,
    manifold::OPEN_EDGES,
    winding::RULE,
    normals::RULE,
    uv_missing::RULE,
    uv_overlap::COLOR,
    uv_overlap::LIGHTMAP,
    texel_density::RULE,
    textures::SIZE,
    textures::MISSING,
    alpha_blend::RULE,
    pivot::RULE,
    height::RULE,
    scale::RULE,
    names::RULE,
    collider::RULE,
];
