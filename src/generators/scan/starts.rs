//! Where ways along the bark of a scan start.

use glam::DVec3;

use super::foot::Foot;
use super::trunk::Trunk;

/// The feet of stems, and trunks that are followed already.
pub(super) struct Starts<'a> {
    feet: &'a [Foot],
    /// The point that is nearest to each foot.
    nearest: Vec<Option<DVec3>>,
    trunks: &'a [(DVec3, Trunk)],
}

impl<'a> Starts<'a> {
    /// Of some feet and the trunks that stand on them, among the points that ways lead through.
    pub fn new(feet: &'a [Foot], trunks: &'a [(DVec3, Trunk)], points: &[DVec3]) -> Self {
        let nearest = feet.iter().map(|foot| {
            let away = |p: &DVec3| p.distance_squared(foot.root);
            points.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b)))
        });
        Self { feet, nearest: nearest.collect(), trunks }
    }

    /// How long the way to a point that one starts at is already, metres; `None` of all other points. Ways start all around
    /// each stem, so that sections lie across it from the start.
    pub fn along_m(&self, p: DVec3) -> Option<f64> {
        // On the bark of a trunk whose axis is known the way is as long as that.
        let along = self.trunks.iter().find_map(|(_, trunk)| trunk.place(p));
        let height = |(foot, nearest): (&Foot, &Option<DVec3>)| {
            let up = (p.y - foot.root.y).max(0.0);
            let away = DVec3::new(p.x - foot.root.x, 0.0, p.z - foot.root.z).length();
            let is_foot = away <= foot.radius_m && up <= foot.ground_m;
            (is_foot || Some(p) == *nearest).then_some(up)
        };
        along.map(|(_, along_m)| along_m).or_else(|| self.feet.iter().zip(&self.nearest).find_map(height))
    }
}
