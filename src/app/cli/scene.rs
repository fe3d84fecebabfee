//! `--scene` and what belongs to it: what stands around plants in a file.

use clap::Args;
use linden::stage::{GroundCover, Moment, Stage, Surroundings, SurroundingsError};

use crate::exit::usage;
use crate::progress::Progress;

/// What is written around the plants.
#[derive(Args, Clone, Debug)]
pub struct SceneFlags {
    /// With a camera that frames the plants, sun, sky and ground, in formats that hold them
    #[arg(long)]
    scene: bool,

    /// The sun of --scene at a latitude (degrees, north above 0), day of the year and hour of the sun's own
    /// time, like 52,172,15.5; when not given an afternoon's, behind the viewer
    #[arg(long, value_name = "LAT,DAY,HOUR", requires = "scene", allow_hyphen_values = true, value_parser = Moment::parse)]
    sun: Option<Moment>,

    /// What covers the ground of --scene: grass, litter (leaves of these plants that have fallen), or both,
    /// as a few patches in many places
    #[arg(long, value_name = "KIND,...", requires = "scene", value_delimiter = ',', value_parser = GroundCover::parse)]
    cover: Vec<GroundCover>,
}

impl SceneFlags {
    /// The stage with what was asked for around it; says which cover there is none of.
    pub fn around<'s>(&self, stage: Stage<'s>, progress: &Progress) -> anyhow::Result<Stage<'s>> {
        if !self.scene {
            return Ok(stage);
        }
        let mut cover = self.cover.clone();
        cover.sort_unstable();
        cover.dedup();
        let stage = match stage.surrounded(&Surroundings { sun: self.sun, cover }, progress) {
            Err(SurroundingsError::Sun(night)) => return Err(usage(night)),
            stage => stage?,
        };
        let lies = |kind: GroundCover| {
            let setting = stage.setting.as_ref();
            setting.is_none_or(|setting| setting.ground.cover.iter().any(|patch| patch.kind == kind))
        };
        if self.cover.contains(&GroundCover::Litter) && !lies(GroundCover::Litter) {
            let note = "cover: litter is left out, since no plant here has single leaves to shed".to_owned();
            super::notes(&[note], progress);
        }
        Ok(stage)
    }
}
