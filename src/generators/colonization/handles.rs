//! A crown shape by its handles: places of its profile that can be moved, and what the knobs are then.
//!
//! Places are heights above the base of the crown and distances from its axis. A shape needs nothing of its own: its
//! handles follow from its dimensions, by the names that all shapes share and by what kind of value they are.

use glam::{DVec3, Vec3};
use linden_base::knob::{Kind, Knob, Value};
use linden_growth::site::crown_base_m;

use crate::ColonizationError;
use crate::crown::solid::dimensions_of;
use crate::crown::{self, Shape};
use crate::settings::{Colonization, Space};
use crate::standing::Standing;

/// Handles as fine as this share of the crown's size: no hand is steadier, and knobs stay short.
const GRAIN: f64 = 0.005;
/// Points of a profile at this share of the widest one's distance from the axis are as wide.
const AS_WIDE: f64 = 1.0 - 1e-6;

/// A crown shape as it can be dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct CrownDraft {
    /// Where the centre of the crown's base stands, metres, where the tree grows.
    pub base: DVec3,
    /// Heights above the base and distances from the axis of a line that turns about the axis, metres.
    pub profile: Vec<[f64; 2]>,
    /// What can be moved.
    pub handles: Vec<CrownHandle>,
}

/// A place of a crown that can be moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrownHandle {
    /// The knob that it turns.
    pub knob: &'static str,
    /// Of a list of pairs, the one that it is.
    pub pair: Option<usize>,
    /// Height above the base, metres.
    pub height_m: f64,
    /// Distance from the axis, metres.
    pub radius_m: f64,
    /// Which ways it moves.
    pub moves: HandleMoves,
}

/// Which ways a handle moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandleMoves {
    /// Up and down.
    Upright,
    /// Away from the axis and towards it.
    Across,
    /// All of these.
    Both,
}

/// Why a crown has no handles.
pub const MESH_HAS_NO_PROFILE: &str =
    "this crown is a mesh and has no profile; another crown has one, like crown=revolution";

impl Colonization {
    /// The crown shape as it can be dragged. With parts, the one that the others add to and cut.
    ///
    /// # Errors
    /// [`MESH_HAS_NO_PROFILE`], or why the crown cannot be had.
    pub fn crown_draft(&self) -> Result<CrownDraft, String> {
        let Space::Shape { shape: id, dimensions } = &self.space else {
            return Err(MESH_HAS_NO_PROFILE.to_owned());
        };
        let said = |error: ColonizationError| error.to_string();
        let shape = crown::shape(id).map_err(|error| error.to_string())?;
        let standing = Standing::shape(self, id, dimensions).map_err(said)?;
        let base = self.growth.shift(standing.root, standing.origin, false) + DVec3::Y * standing.lift;
        // The first line that draws a solid of revolution is its profile.
        let lines = standing.crown.outline();
        let pair = |place: &Vec3| [f64::from(place.y), libm::hypot(f64::from(place.x), f64::from(place.z))];
        let line: Vec<[f64; 2]> = lines.first().into_iter().flatten().map(pair).collect();
        let on_axis = |pair: Option<&[f64; 2]>| pair.filter(|pair| pair[1] > 0.0).map(|pair| [pair[0], 0.0]);
        let ends = [on_axis(line.first()), on_axis(line.last())];
        let profile: Vec<[f64; 2]> = ends[0].into_iter().chain(line).chain(ends[1]).collect();
        let handles = handles(shape, dimensions, &profile);
        Ok(CrownDraft { base, profile, handles })
    }

    /// What a handle's knob is when the handle is moved to a place: no farther than the knob goes, and in steps of
    /// about a two-hundredth of the crown.
    pub fn dragged(&self, draft: &CrownDraft, handle: usize, height_m: f64, radius_m: f64) -> Option<Value> {
        let handle = draft.handles.get(handle)?;
        let grain = draft.grain_m();
        let height_m =
            if handle.moves == HandleMoves::Across { handle.height_m } else { snapped(height_m, grain) };
        let radius_m =
            if handle.moves == HandleMoves::Upright { handle.radius_m } else { snapped(radius_m, grain) };
        if handle.knob == BASE {
            let Space::Shape { .. } = self.space else { return None };
            let now = self.base_m(draft);
            return Some(Value::Real(snapped(now + height_m, grain).clamp(0.0, 1e3)));
        }
        let (knob, value) = self.dimension(handle.knob)?;
        match (value, handle.pair, knob.kind) {
            (Value::Profile(mut pairs), Some(pair), _) => {
                let limit = crown::SIZE_LIMIT_M;
                *pairs.get_mut(pair)? = [height_m.clamp(-limit, limit), radius_m.clamp(0.0, limit)];
                Some(Value::Profile(pairs))
            }
            (_, None, Kind::Real { min, max, .. }) => {
                let length = if handle.moves == HandleMoves::Upright { height_m } else { radius_m };
                Some(Value::Real(length.clamp(min, max)))
            }
            _ => None,
        }
    }

    /// A profile with another pair behind that of a handle, half of the way to the next one (of the last: to the one
    /// before); `None` where it may have no more. The pair's place in the profile comes with it.
    pub fn with_pair(&self, handle: &CrownHandle) -> Option<(Value, usize)> {
        let (Knob { kind: Kind::Profile { most, .. }, .. }, Value::Profile(mut pairs)) =
            self.dimension(handle.knob)?
        else {
            return None;
        };
        let at = handle.pair.filter(|_| pairs.len() < most && pairs.len() > 1)?;
        let at = at.min(pairs.len() - 2);
        let new = [0, 1].map(|axis| f64::midpoint(pairs[at][axis], pairs[at + 1][axis]));
        pairs.insert(at + 1, new);
        Some((Value::Profile(pairs), at + 1))
    }

    /// A profile without the pair of a handle; `None` where it must have as many.
    pub fn without_pair(&self, handle: &CrownHandle) -> Option<Value> {
        let (Knob { kind: Kind::Profile { least, .. }, .. }, Value::Profile(mut pairs)) =
            self.dimension(handle.knob)?
        else {
            return None;
        };
        let at = handle.pair.filter(|&at| pairs.len() > least && at < pairs.len())?;
        pairs.remove(at);
        Some(Value::Profile(pairs))
    }

    /// A dimension of the crown shape and its value.
    fn dimension(&self, name: &str) -> Option<(Knob, Value)> {
        let Space::Shape { shape, dimensions } = &self.space else { return None };
        dimensions_of(shape, dimensions).into_iter().find(|(knob, _)| knob.name == name)
    }

    /// Height of the crown's base above the root, metres.
    fn base_m(&self, draft: &CrownDraft) -> f64 {
        let top_m = draft.profile.iter().map(|pair| pair[0]).fold(0.0, f64::max);
        crown_base_m(self.crown_base_m.or(self.growth.trunk_m), top_m)
    }
}

impl CrownDraft {
    /// The step by which handles move, metres: 1, 2 or 5 of some decimal.
    pub fn grain_m(&self) -> f64 {
        let size_m = self.profile.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs())).max(1e-3);
        let ideal = size_m * GRAIN;
        let decimal = libm::pow(10.0, libm::floor(libm::log10(ideal)));
        [5.0, 2.0].into_iter().map(|n| n * decimal).find(|&step| step <= ideal).unwrap_or(decimal)
    }
}

/// The knob of the crown's base, which is a dimension of no shape.
const BASE: &str = "crown_base";

fn handles(shape: &Shape, dimensions: &[(&'static str, Value)], profile: &[[f64; 2]]) -> Vec<CrownHandle> {
    let widest_m = profile.iter().map(|pair| pair[1]).fold(0.0, f64::max);
    let as_wide = || profile.iter().filter(|pair| pair[1] >= widest_m * AS_WIDE).map(|pair| pair[0]);
    let ends = as_wide().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
    let mut all = Vec::new();
    for (knob, value) in dimensions_of(shape.id, dimensions) {
        let name = knob.name;
        let one =
            |height_m, radius_m, moves| CrownHandle { knob: name, pair: None, height_m, radius_m, moves };
        match (value, name) {
            (Value::Profile(pairs), _) => {
                all.extend(pairs.iter().enumerate().map(|(i, pair)| CrownHandle {
                    pair: Some(i),
                    ..one(pair[0], pair[1], HandleMoves::Both)
                }));
            }
            (Value::Real(height_m), "crown_height") => all.push(one(height_m, 0.0, HandleMoves::Upright)),
            (Value::Real(radius_m), "crown_radius") => {
                all.push(one(f64::midpoint(ends.0, ends.1), radius_m, HandleMoves::Across));
            }
            _ => {}
        }
    }
    all.push(CrownHandle {
        knob: BASE,
        pair: None,
        height_m: 0.0,
        radius_m: 0.0,
        moves: HandleMoves::Upright,
    });
    all
}

/// The nearest multiple of a step, written without noise of the last bits.
fn snapped(x: f64, step: f64) -> f64 {
    // Steps are 1, 2 or 5 of a decimal, so that ten thousandths of one are exact enough.
    let scale = libm::pow(10.0, (4.0 - libm::floor(libm::log10(step))).clamp(0.0, 12.0));
    libm::round(libm::round(x / step) * step * scale) / scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crown::SHAPES;

    fn of(shape: &Shape) -> Colonization {
        Colonization::of(Space::of_shape(shape))
    }

    #[test]
    fn every_shape_can_be_dragged_and_its_handles_lie_on_its_profile() {
        for shape in SHAPES {
            let settings = of(shape);
            let draft = settings.crown_draft().unwrap();
            let real = shape.knobs.iter().filter(|row| matches!(row.knob.kind, Kind::Real { .. })).count();
            let profiles = settings.dimension("profile").or_else(|| settings.dimension("profile_points"));
            let pairs = profiles.map_or(0, |(_, value)| match value {
                Value::Profile(pairs) => pairs.len(),
                _ => 0,
            });
            assert_eq!(draft.handles.len(), real + pairs + 1, "{}", shape.id);
            for handle in draft.handles.iter().filter(|handle| handle.pair.is_none() && handle.knob != BASE) {
                let away =
                    |pair: &[f64; 2]| libm::hypot(pair[0] - handle.height_m, pair[1] - handle.radius_m);
                let on_line = draft.profile.windows(2).any(|ends| {
                    let length = libm::hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
                    (away(&ends[0]) + away(&ends[1]) - length).abs() < 1e-5
                });
                assert!(on_line, "{} {handle:?}", shape.id);
            }
        }
    }

    #[test]
    fn a_handle_that_is_moved_is_then_where_it_was_moved_to() {
        for shape in SHAPES {
            let settings = of(shape);
            let draft = settings.crown_draft().unwrap();
            for (i, handle) in draft.handles.iter().enumerate() {
                let (up, out) = (handle.height_m + 0.3, handle.radius_m + 0.2);
                let value = settings.dragged(&draft, i, up, out).unwrap();
                let mut after = settings.clone();
                assert!(after.turn(handle.knob, value));
                let moved = after.crown_draft().unwrap();
                let [from, to] = [(&draft, handle), (&moved, &moved.handles[i])]
                    .map(|(draft, handle)| (draft.base.y + handle.height_m, handle.radius_m));
                let (up_m, out_m) = (to.0 - from.0, to.1 - from.1);
                let slack = draft.grain_m();
                // A ball grows about its base, and a crown without a trunk of its own is lifted with its height.
                let lifted = moved.base.y - draft.base.y;
                if handle.moves != HandleMoves::Across {
                    let lifted = if handle.knob == BASE { 0.0 } else { lifted };
                    assert!((up_m - lifted - 0.3).abs() <= slack, "{} {} {up_m}", shape.id, handle.knob);
                }
                if handle.moves != HandleMoves::Upright {
                    assert!((out_m - 0.2).abs() <= slack, "{} {} {out_m}", shape.id, handle.knob);
                }
            }
        }
    }

    #[test]
    fn no_handle_leaves_the_range_of_its_knob() {
        for shape in SHAPES {
            let settings = of(shape);
            let draft = settings.crown_draft().unwrap();
            for i in 0..draft.handles.len() {
                for (up, out) in [(1e9, 1e9), (-1e9, -1e9), (0.0, -3.0)] {
                    let value = settings.dragged(&draft, i, up, out).unwrap();
                    let name = draft.handles[i].knob;
                    let known = Colonization::all_knobs();
                    let knob = known.iter().find(|knob| knob.name == name).unwrap();
                    assert_eq!(knob.kind.check(&value), Ok(()), "{} {name} {value}", shape.id);
                }
            }
        }
    }

    #[test]
    fn pairs_come_and_go_where_a_profile_may_have_more_or_fewer() {
        let settings = of(crown::shape("revolution").unwrap());
        let draft = settings.crown_draft().unwrap();
        let (Value::Profile(more), at) = settings.with_pair(&draft.handles[1]).unwrap() else { panic!() };
        assert_eq!((at, more[2]), (2, [1.9, 3.1]));
        let Value::Profile(fewer) = settings.without_pair(&draft.handles[1]).unwrap() else { panic!() };
        assert_eq!(fewer[1], [3.0, 3.6]);
        let bezier = of(crown::shape("bezier").unwrap());
        let draft = bezier.crown_draft().unwrap();
        assert_eq!(
            (bezier.with_pair(&draft.handles[1]), bezier.without_pair(&draft.handles[1])),
            (None, None)
        );
    }

    #[test]
    fn a_mesh_says_that_it_has_no_profile() {
        let mesh = Colonization::of(Space::Envelope { file: "heart.obj".to_owned() });
        assert_eq!(mesh.crown_draft(), Err(MESH_HAS_NO_PROFILE.to_owned()));
    }

    #[test]
    fn steps_are_round_and_written_short() {
        assert_eq!(snapped(3.127, 0.05), 3.15);
        assert_eq!(snapped(0.1 + 0.2, 0.02).to_string(), "0.3");
        assert_eq!(snapped(123.4, 5.0), 125.0);
    }
}
