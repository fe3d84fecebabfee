//! Clumps: points gather round centres, as leaves do at the ends of limbs, and leave gaps between them
//! that the light falls through.
//!
//! There is a centre in each cell of a grid, anywhere in it (Worley 1996, *A Cellular Texture Basis
//! Function*). The density at a place is that without clumps times
//!
//! ```text
//! 1 − 0.95 · share · s((d / size − 0.3) / 0.2),    s(t) = 3t² − 2t³ within 0 to 1
//! ```
//!
//! where `d` is the distance to the nearest centre and `size` the side of a cell.

use glam::DVec3;

use linden_base::random::Key;

/// How much of the density is taken away where it is least, at the full share: a twentieth remains.
pub(super) const STRENGTH: f64 = 0.95;
/// The clump around a centre is whole up to this distance, in cells …
const WHOLE: f64 = 0.3;
/// … and fades over this distance beyond, in cells.
const EDGE: f64 = 0.2;

/// Where the clumps of a crown are.
#[derive(Clone, Copy, Debug)]
pub struct Clumps {
    /// How far points gather: 0 not at all, 1 a twentieth of the density is left between clumps.
    pub share: f64,
    /// Mean distance of neighbouring centres, metres; above 0.
    pub size_m: f64,
    /// The key of the centres' random places.
    pub key: Key,
}

/// The cells around one, which is the thirteenth of them: by itself, by a side, by an edge, by a corner. What is
/// near is mostly found first, and what is too far away to matter is not looked at.
const NEAR_FIRST: [usize; 27] =
    [13, 4, 10, 12, 14, 16, 22, 1, 3, 5, 7, 9, 11, 15, 17, 19, 21, 23, 25, 0, 2, 6, 8, 18, 20, 24, 26];

impl Clumps {
    /// Density at a place, 1 in the clumps.
    pub fn density(&self, p: DVec3) -> f64 {
        let t = ((self.distance_m(p) / self.size_m - WHOLE) / EDGE).clamp(0.0, 1.0);
        1.0 - STRENGTH * self.share * t * t * (3.0 - 2.0 * t)
    }

    /// To the nearest centre, metres; exact up to a cell's side.
    fn distance_m(&self, p: DVec3) -> f64 {
        let place = p / self.size_m;
        let cell = place.floor();
        // To the nearest place of the cells before, of this one and of those after it, by axis.
        let inside = place - cell;
        let gaps = [inside, DVec3::ZERO, 1.0 - inside];
        let mut nearest = f64::INFINITY;
        for i in NEAR_FIRST {
            let away = [i % 3, i / 3 % 3, i / 9];
            let gap = DVec3::new(gaps[away[0]].x, gaps[away[1]].y, gaps[away[2]].z) * self.size_m;
            // Rounding is far below that.
            if gap.length_squared() * (1.0 - 1e-9) > nearest {
                continue;
            }
            let away = DVec3::from(away.map(|i| i as f64)) - 1.0;
            nearest = nearest.min(self.center(cell + away).distance_squared(p));
        }
        nearest.sqrt()
    }

    /// The centre in a cell.
    fn center(&self, cell: DVec3) -> DVec3 {
        // Cells below 0 are the last numbers.
        let key = cell.to_array().into_iter().fold(self.key, |key, index| key.child(index as i64 as u64));
        (cell + DVec3::new(key.child(0).unit(), key.child(1).unit(), key.child(2).unit())) * self.size_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_centre_is_the_nearest_of_all() {
        let clumps = Clumps { share: 1.0, size_m: 0.7, key: Key::new(3) };
        for i in 0..300 {
            let key = Key::new(9).child(i);
            let p = DVec3::new(key.child(0).unit(), key.child(1).unit(), key.child(2).unit()) * 8.0 - 4.0;
            let cell = (p / clumps.size_m).floor();
            let mut nearest = f64::INFINITY;
            for x in -3..=3 {
                for y in -3..=3 {
                    for z in -3..=3 {
                        let away = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                        nearest = nearest.min(clumps.center(cell + away).distance(p));
                    }
                }
            }
            // Beyond a cell's side a farther cell may have a nearer one; there it is a gap anyway.
            if nearest <= clumps.size_m {
                assert_eq!(clumps.distance_m(p), nearest, "{p}");
            }
            let expected = match nearest / clumps.size_m {
                d if d <= WHOLE => 1.0,
                d if d >= WHOLE + EDGE => 1.0 - STRENGTH,
                _ => continue,
            };
            assert!((clumps.density(p) - expected).abs() < 1e-12, "{p}");
        }
    }
}
