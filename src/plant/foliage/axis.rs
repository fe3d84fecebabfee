//! Places along the axes: where on the twigs something grows, and how the wood stands there.
//!
//! Every axis is walked by its arc length, from where it leaves its parent to its apex. Nodes of leaves
//! stand at equal distances, wherever the skeleton's own nodes are: an axis that is divided more finely
//! has the same leaves. What a walk meets first does not change what it meets later.

use glam::{Quat, Vec3};

use linden_skeleton::{Axis, NO_PARENT, Skeleton, WidthSteps};

/// Wood on which leaves may grow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Young {
    /// It is no thicker, metres.
    pub max_radius_m: f32,
    /// It was born no earlier.
    pub first_birth: u32,
}

/// Where something grows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Number on its axis, whatever else grows there.
    pub number: u64,
    /// On the axis, metres.
    pub center: Vec3,
    /// Of the wood there, metres.
    pub radius_m: f32,
    /// Unit vector along the axis, towards the apex.
    pub tangent: Vec3,
    /// Unit vector square to it, carried along the axis without twist; level at the base of a slanting
    /// axis.
    pub side: Vec3,
    /// The node that ends the segment.
    pub node: u32,
    /// Share of the leafy length of the axis below it: 0 at its base, 1 at the apex.
    pub along: f32,
    /// Whether it is the apex.
    pub is_apex: bool,
}

/// An axis as a line with radii.
#[derive(Default)]
pub(super) struct Walk {
    stations: Vec<Station>,
    /// Whether segments are as thick all along as where they end.
    is_stepped: bool,
}

#[derive(Clone, Copy)]
struct Station {
    position: Vec3,
    radius_m: f32,
    /// The skeleton's node; for a lateral's foot, which is its parent's, the lateral's first.
    node: u32,
    /// Arc length from the base, metres.
    along_m: f64,
    /// Of the segment that ends here.
    tangent: Vec3,
    side: Vec3,
}

/// Segments shorter than this have no direction, metres.
const SHORTEST_M: f32 = 1e-9;
/// Axes steeper than this have no level side: the sine of the angle off the upright.
const UPRIGHT: f32 = 0.05;

impl Walk {
    /// Takes up an axis; `None` when it has no length. Gives whether it stands upright at its base, and
    /// the arc length at which it leaves its parent's wood.
    pub fn begin(&mut self, skeleton: &Skeleton, axis: &Axis) -> Option<Begun> {
        self.stations.clear();
        self.is_stepped = skeleton.width_steps == WidthSteps::Cylinder;
        let nodes = skeleton.nodes_of(axis);
        let &first = nodes.first()?;
        let at = |node: u32| skeleton.positions[node as usize];
        let start = if axis.parent == NO_PARENT { first } else { axis.parent };
        let mut last = Station {
            position: at(start),
            // As the surface has it: a lateral is as thick at its root as at its first node.
            radius_m: skeleton.radii[first as usize],
            node: first,
            along_m: 0.0,
            tangent: Vec3::ZERO,
            side: Vec3::ZERO,
        };
        self.stations.push(last);
        for &node in nodes.iter().skip(usize::from(axis.parent == NO_PARENT)) {
            let position = at(node);
            let length_m = last.position.distance(position);
            if !(length_m > SHORTEST_M) {
                continue;
            }
            let tangent = (position - last.position) / length_m;
            let side = if self.stations.len() == 1 { level(tangent) } else { carried(&last, tangent) };
            let along_m = last.along_m + f64::from(length_m);
            last =
                Station { position, radius_m: skeleton.radii[node as usize], node, along_m, tangent, side };
            self.stations.push(last);
        }
        let [_, second, ..] = self.stations[..] else { return None };
        let covered = if axis.parent == NO_PARENT { 0.0 } else { skeleton.radii[axis.parent as usize] };
        Some(Begun {
            is_upright: sine_off_upright(second.tangent) < UPRIGHT,
            covered_m: f64::from(covered).min(last.along_m),
            length_m: last.along_m,
        })
    }

    /// The arc length at which leaves begin on young wood; the whole length where there is none.
    pub fn leafy_from_m(&self, young: Young, skeleton: &Skeleton) -> f64 {
        for pair in self.stations.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if skeleton.births[b.node as usize] < young.first_birth {
                continue;
            }
            if a.radius_m <= young.max_radius_m {
                return a.along_m;
            }
            if b.radius_m <= young.max_radius_m {
                let share = (a.radius_m - young.max_radius_m) / (a.radius_m - b.radius_m);
                return a.along_m + f64::from(share) * (b.along_m - a.along_m);
            }
        }
        self.stations.last().map_or(0.0, |last| last.along_m)
    }

    /// Metres of young wood.
    pub fn leafy_m(&self, young: Young, skeleton: &Skeleton) -> f64 {
        let segments = self.stations.windows(2).filter(|pair| {
            pair[0].radius_m.min(pair[1].radius_m) <= young.max_radius_m
                && skeleton.births[pair[1].node as usize] >= young.first_birth
        });
        segments.map(|pair| pair[1].along_m - pair[0].along_m).sum()
    }

    /// Calls back with places at the arc lengths `(phase + k) · spacing` on young wood, `k` from 0, from
    /// `from_m` on.
    pub fn every<E>(
        &self,
        Spaced { spacing_m, phase, from_m }: Spaced,
        young: Young,
        skeleton: &Skeleton,
        mut each: impl FnMut(Place) -> Result<(), E>,
    ) -> Result<(), E> {
        let leafy_from = self.leafy_from_m(young, skeleton);
        for pair in self.stations.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let is_young = a.radius_m.min(b.radius_m) <= young.max_radius_m
                && skeleton.births[b.node as usize] >= young.first_birth;
            if !is_young {
                continue;
            }
            let start = libm::ceil((a.along_m.max(from_m)) / spacing_m - phase).max(0.0);
            let mut number = start as u64;
            loop {
                let along_m = (phase + number as f64) * spacing_m;
                if !(along_m < b.along_m) {
                    break;
                }
                let place = self.between(a, b, along_m, number, leafy_from);
                if along_m >= a.along_m && place.radius_m <= young.max_radius_m {
                    each(place)?;
                }
                number += 1;
            }
        }
        Ok(())
    }

    /// Calls back with `count` places on each segment of young wood, evenly.
    pub fn each_segment<E>(
        &self,
        count: u64,
        young: Young,
        skeleton: &Skeleton,
        mut each: impl FnMut(Place) -> Result<(), E>,
    ) -> Result<(), E> {
        let leafy_from = self.leafy_from_m(young, skeleton);
        for (segment, pair) in self.stations.windows(2).enumerate() {
            let (a, b) = (pair[0], pair[1]);
            for i in 0..count {
                let share = (i as f64 + 0.5) / count as f64;
                let along_m = a.along_m + share * (b.along_m - a.along_m);
                let place = self.between(a, b, along_m, segment as u64 * count + i, leafy_from);
                let birth = skeleton.births[b.node as usize];
                if place.radius_m <= young.max_radius_m && birth >= young.first_birth {
                    each(place)?;
                }
            }
        }
        Ok(())
    }

    /// The apex, where it is young.
    pub fn apex(&self, young: Young, skeleton: &Skeleton) -> Option<Place> {
        let last = *self.stations.last()?;
        let is_young = last.radius_m <= young.max_radius_m
            && skeleton.births[last.node as usize] >= young.first_birth
            && self.stations.len() > 1;
        is_young.then_some(Place {
            number: u64::MAX,
            center: last.position,
            radius_m: last.radius_m,
            tangent: last.tangent,
            side: last.side,
            node: last.node,
            along: 1.0,
            is_apex: true,
        })
    }

    fn between(&self, a: Station, b: Station, along_m: f64, number: u64, leafy_from: f64) -> Place {
        let share = ((along_m - a.along_m) / (b.along_m - a.along_m)) as f32;
        let length_m = self.stations.last().map_or(0.0, |last| last.along_m);
        let leafy = ((along_m - leafy_from) / (length_m - leafy_from)) as f32;
        Place {
            number,
            center: a.position.lerp(b.position, share),
            radius_m: if self.is_stepped {
                b.radius_m
            } else {
                a.radius_m + (b.radius_m - a.radius_m) * share
            },
            tangent: b.tangent,
            side: b.side,
            node: b.node,
            along: if leafy.is_finite() { leafy.clamp(0.0, 1.0) } else { 1.0 },
            is_apex: false,
        }
    }
}

/// What is known of an axis when its walk begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Begun {
    /// Whether no side of it is level.
    pub is_upright: bool,
    /// Metres that lie inside its parent.
    pub covered_m: f64,
    /// Arc length, metres.
    pub length_m: f64,
}

/// Places at equal distances.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spaced {
    /// From one to the next, metres.
    pub spacing_m: f64,
    /// Where the first would be, in spacings, 0 to 1.
    pub phase: f64,
    /// None are nearer to the base, metres.
    pub from_m: f64,
}

fn sine_off_upright(tangent: Vec3) -> f32 {
    (tangent.x * tangent.x + tangent.z * tangent.z).sqrt()
}

/// A unit vector square to a tangent: level where there is one.
fn level(tangent: Vec3) -> Vec3 {
    if sine_off_upright(tangent) < UPRIGHT {
        return tangent.any_orthonormal_vector();
    }
    tangent.cross(Vec3::Y).normalize_or(tangent.any_orthonormal_vector())
}

/// The side of a station, turned with the tangent by the smallest rotation.
fn carried(last: &Station, tangent: Vec3) -> Vec3 {
    let turned = Quat::from_rotation_arc(last.tangent, tangent) * last.side;
    turned.reject_from_normalized(tangent).normalize_or(tangent.any_orthonormal_vector())
}
