//! How long plants sway: what a layer over their files says about time.

use linden_pipeline::stage::Stage;
use linden_pipeline::wind::{PartWind, Sway};

/// A loop of wind: from frame 0 to the last one, which is as the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindLoop {
    /// The last frame.
    pub frames: u32,
    /// Frames in a second, at least 1.
    pub frames_per_second: u32,
}

impl WindLoop {
    /// The loop of the plants on a stage; where they have several, the longest.
    pub fn of_stage(stage: &Stage<'_>) -> Option<Self> {
        let seasons = stage.plants.iter().flat_map(|plant| &plant.seasons);
        let scenes = seasons.flat_map(|season| &season.levels).map(|level| level.scene);
        let winds = scenes.flat_map(|scene| &scene.parts).filter_map(|part| part.wind.as_ref());
        Self::longest(winds.filter_map(swaying).map(Self::from))
    }

    /// The one of some loops that takes the most seconds.
    pub fn longest(loops: impl IntoIterator<Item = Self>) -> Option<Self> {
        let seconds_over = |a: &Self, b: &Self| u64::from(a.frames) * u64::from(b.frames_per_second);
        loops.into_iter().max_by(|a, b| seconds_over(a, b).cmp(&seconds_over(b, a)))
    }
}

impl From<&Sway> for WindLoop {
    fn from(sway: &Sway) -> Self {
        Self { frames: sway.frames(), frames_per_second: sway.frames_per_second() }
    }
}

/// The loop of a part that has one, by joints or by targets.
pub(crate) fn swaying(wind: &PartWind) -> Option<&Sway> {
    wind.bones.as_ref().map(|bones| &*bones.sway).or(wind.sway.as_deref())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_loop_is_that_of_the_most_seconds() {
        let of = |frames, frames_per_second| WindLoop { frames, frames_per_second };
        assert_eq!(WindLoop::longest([of(160, 24), of(100, 12), of(180, 24)]), Some(of(100, 12)));
        assert_eq!(WindLoop::longest([]), None);
    }
}
