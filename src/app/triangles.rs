//! The triangles that were written, level by level.

use linden::stage::Stage;

use crate::figures::thousands;

/// The triangles of each level of the first plant of a stage in its first season, finest first.
pub fn of_levels(stage: &Stage<'_>) -> Vec<u64> {
    let season = stage.plants.first().and_then(|plant| plant.seasons.first());
    let levels = season.into_iter().flat_map(|season| &season.levels);
    levels.map(|level| level.scene.triangles() as u64).collect()
}

/// `19 964 / 6 700 / 2 200 triangles`; nothing of none.
pub fn told(levels: &[u64]) -> Option<String> {
    let noun = if levels == [1] { "triangle" } else { "triangles" };
    let text = levels.iter().map(|&triangles| thousands(triangles)).collect::<Vec<_>>().join(" / ");
    (!levels.is_empty()).then(|| format!("{text} {noun}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_told_from_the_finest() {
        assert_eq!(told(&[19_964, 6700, 8]).as_deref(), Some("19 964 / 6 700 / 8 triangles"));
        assert_eq!(told(&[]), None);
    }
}
