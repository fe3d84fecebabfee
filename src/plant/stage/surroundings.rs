//! What is asked for around plants, as a short text that files carry.

use std::fmt;

use crate::texture::leaf::LeafError;
use linden_base::monitor::Monitor;

use super::{GroundCover, Moment, Stage, SunError, UnknownGroundCover};

/// The choices of a setting beyond the usual one: in which light, and what covers the ground.
///
/// ```
/// use linden_pipeline::stage::{GroundCover, Surroundings};
/// let of = Surroundings::parse("sun=52,172,15.5 cover=grass,litter").unwrap();
/// assert_eq!(of.cover, [GroundCover::Grass, GroundCover::Litter]);
/// assert_eq!(of.to_string(), "sun=52,172,15.5 cover=grass,litter");
/// assert!(Surroundings::parse("").unwrap().is_usual());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// When the sun shines; `None`: in an afternoon, behind the viewer.
    pub sun: Option<Moment>,
    /// What covers the ground, each kind once.
    pub cover: Vec<GroundCover>,
}

/// A text that tells of no surroundings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurroundingsError {
    /// The sun.
    #[error(transparent)]
    Sun(#[from] SunError),
    /// The ground.
    #[error(transparent)]
    Cover(#[from] UnknownGroundCover),
    /// The leaves that lie on it.
    #[error(transparent)]
    Litter(#[from] LeafError),
    /// Something else.
    #[error("'{0}' is neither sun= nor cover=")]
    Word(String),
}

impl Surroundings {
    /// Whether nothing was chosen.
    pub fn is_usual(&self) -> bool {
        *self == Self::default()
    }

    /// Reads what its `Display` writes.
    ///
    /// # Errors
    /// [`SurroundingsError`].
    pub fn parse(text: &str) -> Result<Self, SurroundingsError> {
        let mut surroundings = Self::default();
        for word in text.split_ascii_whitespace() {
            match word.split_once('=') {
                Some(("sun", moment)) => surroundings.sun = Some(Moment::parse(moment)?),
                Some(("cover", names)) => surroundings.cover = GroundCover::parse_list(names)?,
                _ => return Err(SurroundingsError::Word(word.chars().take(40).collect())),
            }
        }
        Ok(surroundings)
    }
}

impl fmt::Display for Surroundings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sun, cover } = self;
        let sun = sun.map(|Moment { latitude_deg, day, hour }| format!("sun={latitude_deg},{day},{hour}"));
        let names: Vec<&str> = cover.iter().map(|kind| kind.name()).collect();
        let cover = (!names.is_empty()).then(|| format!("cover={}", names.join(",")));
        f.write_str(&sun.into_iter().chain(cover).collect::<Vec<_>>().join(" "))
    }
}

impl Stage<'_> {
    /// The same with a camera that frames it, sun, sky and ground as they were asked for.
    ///
    /// # Errors
    /// [`SurroundingsError`]: the sun is down, cancelled.
    pub fn surrounded(self, by: &Surroundings, monitor: &dyn Monitor) -> Result<Self, SurroundingsError> {
        let mut stage = self.in_setting();
        if let Some(moment) = &by.sun {
            stage = stage.at_moment(moment)?;
        }
        stage = stage.on_ground_of(&by.cover, monitor)?;
        if let Some(setting) = &mut stage.setting {
            setting.surroundings = by.clone();
        }
        Ok(stage)
    }
}
