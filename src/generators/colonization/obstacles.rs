//! Solids that branches do not enter, and places where points are taken away.

use std::sync::Arc;

use glam::DVec3;
use linden_base::monitor::{Cancelled, Monitor};
use linden_base::random::Key;
use linden_growth::Meet;
use linden_growth::site::{Barrier, Inside};
use rayon::prelude::*;

use crate::ColonizationError;
use crate::crown::{Crown, shells};

/// A solid that branches do not enter.
pub(crate) struct Obstacle {
    pub solid: Arc<dyn Crown>,
    pub meet: Meet,
}

impl Obstacle {
    /// As growth has it.
    pub fn barrier(self) -> Barrier {
        Barrier { solid: inside(self.solid), meet: self.meet }
    }
}

/// A place where points are taken away.
pub(crate) struct Shade {
    pub solid: Box<dyn Crown>,
    /// Of 1.
    pub share: f64,
}

/// A crown as growth has it.
pub(crate) fn inside(crown: Arc<dyn Crown>) -> Arc<dyn Inside> {
    Arc::new(shells::Filled(crown))
}

/// Takes away the points in obstacles and, each by its own chance, those in shade; point `i` by
/// `key.child(i)`, so that fewer points are still a prefix of more.
pub(crate) fn clear(
    mut points: Vec<DVec3>,
    obstacles: &[Obstacle],
    shades: &[Shade],
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Vec<DVec3>, ColonizationError> {
    if obstacles.is_empty() && shades.is_empty() {
        return Ok(points);
    }
    let scattered = points.len();
    let stays = |(i, p): (usize, &DVec3)| {
        monitor.check()?;
        let chance = |number: usize| key.child(i as u64).child(number as u64).unit();
        let is_free = obstacles.iter().all(|obstacle| !obstacle.solid.contains(*p));
        let is_lit =
            |(number, shade): (usize, &Shade)| chance(number) >= shade.share || !shade.solid.contains(*p);
        Ok(is_free && shades.iter().enumerate().all(is_lit))
    };
    let kept: Vec<bool> = points.par_iter().enumerate().map(stays).collect::<Result<_, Cancelled>>()?;
    let mut kept = kept.into_iter();
    points.retain(|_| kept.next() == Some(true));
    if points.is_empty() {
        return Err(ColonizationError::NoRoom { points: scattered });
    }
    Ok(points)
}
