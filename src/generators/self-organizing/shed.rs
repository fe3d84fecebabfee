//! Branches that get too little light are shed.

use linden_skeleton::NO_PARENT;

use crate::SelfOrganizing;
use crate::light::FULL_LIGHT;
use crate::sums::Sums;
use crate::tree::{LATERAL, Nodes, SHED};

/// Marks the branches that are shed this year, [`SHED`]; how many nodes that are.
///
/// A branch goes when for [`SelfOrganizing::shed_patience`] years in a row, and after its grace, the light of its
/// buds ÷ its internodes was below [`SelfOrganizing::shed`] (Pałubicki et al. 2009, section 4.5). It is judged by the
/// light at the beginning of the year; its buds do not grow in the year in which it goes, and what they would have
/// got is lost. Its tips stay in the pipes of the node that bore it.
///
/// Where several trees stand, one without any light falls, its foot included.
pub(crate) fn shed(nodes: &mut Nodes, sums: &Sums, settings: &SelfOrganizing, year: u32) -> usize {
    if settings.shed == 0.0 {
        return 0;
    }
    let is_stand = nodes.parents.iter().filter(|&&parent| parent == NO_PARENT).nth(1).is_some();
    let mut count = 0;
    let mut pipes = Vec::new();
    for node in 0..nodes.len() {
        if nodes.is_foot(node) {
            if is_stand && sums.total(node) == 0 {
                nodes.flags[node] |= SHED;
                count += 1;
            }
            continue;
        }
        let parent = nodes.parents[node] as usize;
        if nodes.is(parent, SHED) {
            nodes.flags[node] |= SHED;
            count += 1;
            continue;
        }
        if !nodes.is(node, LATERAL) || year - nodes.year(node) <= settings.shed_grace {
            continue;
        }
        let light = sums.total(node) as f64 / f64::from(FULL_LIGHT);
        if light >= settings.shed * f64::from(sums.internodes[node]) {
            nodes.dark_years[node] = 0;
            continue;
        }
        nodes.dark_years[node] = nodes.dark_years[node].saturating_add(1);
        if u32::from(nodes.dark_years[node]) >= settings.shed_patience {
            if pipes.is_empty() {
                pipes = nodes.pipes();
            }
            nodes.flags[node] |= SHED;
            nodes.shed_tips[parent] = nodes.shed_tips[parent].saturating_add(pipes[node]);
            count += 1;
        }
    }
    count
}
