//! Foliage that is blended.

use super::{Limits, Rule};
use crate::asset::{Alpha, Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const RULE: Rule = Rule {
    id: "alpha-blend",
    checks: "materials that are blended (BLEND) where they could be cut out (MASK)",
    why: "blended leaves are drawn from back to front, without writing depth: they shine through each other, cast no shadow, \
          and cost several times as much",
    mend: "alpha mode MASK with a cutoff of about 0.5; alpha to coverage for soft edges",
    severity: Severity::Error,
    limits: &[],
    needs: &[Aspect::Alpha],
    check,
};

fn check(asset: &Asset, _: &Limits, found: &mut Findings<'_>) {
    for material in asset.materials.iter().filter(|material| material.alpha == Some(Alpha::Blend)) {
        found.at(&material.name, "its alpha mode is BLEND");
    }
}
