//! When in the year a kind of organ is there, how large it is then, and how many are.
//!
//! The year is the knob `season`: 0 leaves unfold, 1 bare. A kind that says nothing is there all the year: its
//! leaves unfold from 0 to 0.2 and fall from 0.75 to 1, but for evergreens. One with a `season_range` of its own
//! opens where that begins and falls where it ends.

use linden_skeleton::organs::OrganClass;

use crate::settings::LeafKind;

/// How long leaves take to unfold, and to fall.
const UNFOLD: f32 = 0.2;
const FALL: f32 = 0.25;
/// How long young colours last.
const YOUNG: f32 = 0.25;
/// The most of its time that a kind opens, falls and is young, as shares.
const MOST_FADE: f32 = 1.0 / 3.0;
const MOST_YOUNG: f32 = 0.4;
/// The size of an organ that has just opened.
const YOUNG_SIZE: f32 = 0.35;

/// A kind's part of the year.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calendar {
    /// When it begins; it ends later, beyond 1 where it goes over the winter.
    from: f32,
    to: f32,
    unfold: f32,
    fall: f32,
    /// Whether it is there from the very beginning, grown.
    is_open: bool,
    /// Whether the season neither shrinks nor fells it.
    is_constant: bool,
}

impl Calendar {
    /// That of a kind.
    pub fn of(kind: &LeafKind) -> Self {
        let at =
            |i: usize, otherwise: f32| kind.season_range.get(i).map_or(otherwise, |&season| season as f32);
        let (from, to) = (at(0, 0.0), at(1, 1.0));
        let is_whole = from == 0.0 && to == 1.0;
        let to = if to < from { to + 1.0 } else { to };
        let fade = |most: f32| match kind.season_fade {
            Some(fade) => (fade as f32).min((to - from) / 2.0),
            None if is_whole => most,
            None => most.min(MOST_FADE * (to - from)),
        };
        Self {
            from,
            to,
            unfold: fade(UNFOLD),
            fall: fade(FALL),
            is_open: from == 0.0 && !is_whole && kind.class() != OrganClass::Leaf,
            is_constant: is_whole && kind.evergreen,
        }
    }

    /// A season, counted on into the next year where the kind's time does.
    fn moment(&self, season: f32) -> f32 {
        if self.to > 1.0 && season < self.from && season + 1.0 <= self.to { season + 1.0 } else { season }
    }

    /// Whether any of it may be there.
    pub fn is_there(&self, season: f32) -> bool {
        self.is_constant || (self.from..=self.to).contains(&self.moment(season))
    }

    /// Whether it is there at some time and not at another, or not always as large.
    pub const fn changes(&self) -> bool {
        !self.is_constant
    }

    /// The share that is there.
    pub fn share(&self, season: f32) -> f64 {
        if self.is_constant {
            return 1.0;
        }
        let now = self.moment(season);
        if !(self.from..=self.to).contains(&now) {
            return 0.0;
        }
        // Where the year ends leaves have fallen; other kinds stay up to their last moment.
        let left = 1.0 - over(now - (self.to - self.fall), self.fall);
        // They come out one after another, and all grow on.
        let out = if self.from == 0.0 { 1.0 } else { over(now - self.from, self.unfold / 2.0) };
        f64::from(left) * f64::from(out)
    }

    /// How large it is, as a share of its length.
    pub fn size(&self, season: f32) -> f64 {
        if self.is_constant || self.is_open {
            return 1.0;
        }
        let t = over(self.moment(season) - self.from, self.unfold);
        f64::from(YOUNG_SIZE + (1.0 - YOUNG_SIZE) * t * t * (3.0 - 2.0 * t))
    }

    /// How much of its youth is over, 0 to 1 and beyond.
    pub fn ripeness(&self, season: f32) -> f32 {
        let young =
            if self.to - self.from < 1.0 { YOUNG.min(MOST_YOUNG * (self.to - self.from)) } else { YOUNG };
        (self.moment(season) - self.from).max(0.0) / young
    }
}

/// How far a time is over, 0 to 1; one without length is over when it begins.
fn over(since: f32, time: f32) -> f32 {
    if time > 0.0 {
        (since / time).clamp(0.0, 1.0)
    } else if since > 0.0 {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::leaf::Outline;

    fn calendar(range: &[f64], outline: Outline) -> Calendar {
        Calendar::of(&LeafKind { season_range: range.to_vec(), outline, ..LeafKind::default() })
    }

    const YEAR: [f32; 21] = {
        let mut year = [0.0; 21];
        let mut i = 0;
        while i < 21 {
            year[i] = i as f32 / 20.0;
            i += 1;
        }
        year
    };

    #[test]
    fn outside_of_its_time_nothing_is_there() {
        for range in [[0.0, 0.15], [0.1, 1.0], [0.35, 0.95], [0.8, 0.1], [0.5, 0.5]] {
            let found = calendar(&range, Outline::Blossom);
            for season in YEAR {
                let at = f64::from(season);
                let [from, to] = range;
                let inside = if from <= to { (from..=to).contains(&at) } else { at >= from || at <= to };
                if !inside && (at - from).abs() > 1e-6 && (at - to).abs() > 1e-6 {
                    assert_eq!(found.share(season), 0.0, "{range:?} at {season}");
                    assert!(!found.is_there(season), "{range:?} at {season}");
                }
                assert!(found.share(season) == 0.0 || found.is_there(season));
            }
        }
    }

    #[test]
    fn a_kind_comes_grows_and_goes() {
        let berries = calendar(&[0.3, 0.9], Outline::Fruit);
        let shares: Vec<f64> = (30..=90).map(|i| berries.share(i as f32 / 100.0)).collect();
        let first = shares.iter().position(|&share| share == 1.0).unwrap();
        let last = shares.iter().rposition(|&share| share == 1.0).unwrap();
        assert!(shares[..first].is_sorted() && shares[last..].is_sorted_by(|a, b| a >= b));
        assert!(first > 0 && last < shares.len() - 1 && first < last);
        let sizes: Vec<f64> = (30..=90).map(|i| berries.size(i as f32 / 100.0)).collect();
        assert!(sizes.is_sorted() && sizes[0] < 0.4 && sizes[60] == 1.0);
        // Blossom that the year begins with is open; leaves unfold.
        assert_eq!(calendar(&[0.0, 0.15], Outline::Blossom).size(0.0), 1.0);
        assert!(calendar(&[0.0, 0.15], Outline::Ovate).size(0.0) < 0.4);
        // Over the winter: as much at the turn of the year on both sides.
        let catkins = calendar(&[0.7, 0.2], Outline::Fruit);
        assert_eq!(catkins.share(1.0), catkins.share(0.0));
        assert!(catkins.share(0.0) == 1.0 && catkins.share(0.15) < 1.0 && catkins.share(0.45) == 0.0);
    }

    #[test]
    fn a_kind_that_says_nothing_is_there_all_the_year() {
        let leaves = calendar(&[0.0, 1.0], Outline::Ovate);
        assert!(YEAR.iter().all(|&season| leaves.is_there(season)));
        assert_eq!((leaves.share(0.75), leaves.share(1.0), leaves.size(0.2)), (1.0, 0.0, 1.0));
        let evergreen = Calendar::of(&LeafKind { evergreen: true, ..LeafKind::default() });
        assert!(YEAR.iter().all(|&season| evergreen.share(season) == 1.0 && evergreen.size(season) == 1.0));
        assert!(!evergreen.changes() && leaves.changes());
    }
}
