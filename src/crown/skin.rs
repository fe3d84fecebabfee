//! The surface of a crown as triangles, for pictures.

use glam::Vec3;

use super::around;

/// Sides of what is turned about an axis: round enough for a picture, and few facets to sort.
const SIDES: u32 = 40;

/// Triangles that neighbours share corners of, so that edges can be told from seams.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Corners, metres.
    pub positions: Vec<Vec3>,
    /// Indices of `positions`, each in range.
    pub triangles: Vec<[u32; 3]>,
}

impl Skin {
    /// What a profile (height, radius) sweeps when it turns about the axis, closed by discs at its ends.
    pub(super) fn revolved(profile: &[(f64, f64)]) -> Self {
        let mut skin = Self::default();
        let (Some(&first), Some(&last)) = (profile.first(), profile.last()) else { return skin };
        let ends = [(first.0, 0.0), (last.0, 0.0)];
        let mut closed = Vec::with_capacity(profile.len() + 2);
        for place in ends[..1].iter().chain(profile).chain(&ends[1..]) {
            if closed.last() != Some(place) {
                closed.push(*place);
            }
        }
        // A place on the axis is one corner, any other a ring of them.
        let rings: Vec<(u32, bool)> = closed
            .iter()
            .map(|&(height, radius)| {
                let (start, is_tip) = (skin.positions.len() as u32, radius.abs() < 1e-9);
                let corners = if is_tip { 1 } else { SIDES };
                let corner = |i| around(height, radius, f64::from(i) / f64::from(SIDES)).as_vec3();
                skin.positions.extend((0..corners).map(corner));
                (start, is_tip)
            })
            .collect();
        for pair in rings.windows(2) {
            let at = |(start, is_tip): (u32, bool), i: u32| start + if is_tip { 0 } else { i % SIDES };
            for i in 0..SIDES {
                let [a, b] = [at(pair[0], i), at(pair[0], i + 1)];
                let [c, d] = [at(pair[1], i), at(pair[1], i + 1)];
                let facets = [[a, c, b], [b, c, d]];
                let has_area = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
                skin.triangles.extend(facets.into_iter().filter(has_area));
            }
        }
        skin
    }

    /// Several as one.
    pub(super) fn together(skins: impl Iterator<Item = Self>) -> Self {
        let mut all = Self::default();
        for skin in skins {
            let before = all.positions.len() as u32;
            all.positions.extend(skin.positions);
            all.triangles.extend(skin.triangles.into_iter().map(|t| t.map(|corner| corner + before)));
        }
        all
    }

    /// Each corner somewhere else.
    #[must_use]
    pub fn moved(mut self, to: impl Fn(Vec3) -> Vec3) -> Self {
        for place in &mut self.positions {
            *place = to(*place);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use crate::SHAPES;

    #[test]
    fn the_skin_of_every_shape_is_closed_and_encloses_its_volume() {
        for shape in SHAPES {
            let crown = shape.of(&[]).unwrap();
            let skin = crown.skin();
            let mut edges = BTreeMap::<(u32, u32), i32>::new();
            let mut volume = 0.0;
            for t in &skin.triangles {
                let [a, b, c] = t.map(|corner| skin.positions[corner as usize].as_dvec3());
                volume += a.dot(b.cross(c)) / 6.0;
                for (from, to) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                    *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|&sum| sum == 0), "{}: an edge is not passed both ways", shape.id);
            // A polygon of 40 sides has 99.6 % of a circle.
            let share = volume.abs() / crown.volume_m3();
            assert!((0.97..1.001).contains(&share), "{}: {share}", shape.id);
        }
    }
}
