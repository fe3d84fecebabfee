//! The triangles that were written, level by level, and whether budgets of them were met.

use linden::stage::Stage;

use crate::tui::thousands;

/// A budget is met within this share of it, as the knob `triangles` says.
const NEAR: f64 = 0.05;

/// The triangles of each level of the first plant of a stage in its first season, finest first.
pub fn of_levels(stage: &Stage<'_>) -> Vec<u64> {
    let season = stage.plants.first().and_then(|plant| plant.seasons.first());
    let levels = season.into_iter().flat_map(|season| &season.levels);
    levels.map(|level| level.scene.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum()).collect()
}

/// `19 964 / 6 700 / 2 200 triangles`; nothing of none.
pub fn told(levels: &[u64]) -> Option<String> {
    let noun = if levels == [1] { "triangle" } else { "triangles" };
    let text = levels.iter().map(|&triangles| thousands(triangles)).collect::<Vec<_>>().join(" / ");
    (!levels.is_empty()).then(|| format!("{text} {noun}"))
}

/// What is to be said of budgets that were not met: those of the levels (`lod_triangles`), or else that of the finest.
pub fn unmet(levels: &[u64], triangles: u64, budgets: &[u64]) -> Vec<String> {
    let asked = if budgets.is_empty() { vec![triangles] } else { budgets.to_vec() };
    let is_near = |found: u64, budget: u64| (found as f64 - budget as f64).abs() <= NEAR * budget as f64;
    let pairs = asked.into_iter().zip(levels).filter(|(budget, _)| *budget > 0);
    pairs
        .filter(|(budget, found)| !is_near(**found, *budget))
        .map(|(budget, found)| {
            format!(
                "a budget of {} triangles was not met: {} are written",
                thousands(budget),
                thousands(*found)
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_met_within_a_twentieth() {
        assert_eq!(unmet(&[19_964, 6_700], 20_000, &[]), Vec::<String>::new());
        assert_eq!(unmet(&[525], 500, &[]), Vec::<String>::new());
        assert_eq!(unmet(&[640], 500, &[]), ["a budget of 500 triangles was not met: 640 are written"]);
        assert_eq!(unmet(&[1_200_000], 0, &[]), Vec::<String>::new(), "none was asked for");
        assert_eq!(
            unmet(&[4000, 1500, 8], 0, &[4000, 1000]),
            ["a budget of 1 000 triangles was not met: 1 500 are written"],
            "planes have no budget"
        );
    }

    #[test]
    fn levels_are_told_from_the_finest() {
        assert_eq!(told(&[19_964, 6700, 8]).as_deref(), Some("19 964 / 6 700 / 8 triangles"));
        assert_eq!(told(&[]), None);
    }
}
