//! Which axes have joints, where these are, how they turn, and what each place of the wood is bound to.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::{Quat, Vec3};

use super::bones::{Binding, BoneSettings, Bones, INFLUENCES, Joint};
use super::field::Field;
use super::moment::Swing;
use super::sway::Sway;
use linden_skeleton::{NO_PARENT, Skeleton};

/// The most joints of one axis. Between two the wood follows a parabola within an eighth of what the part between them
/// bends.
pub(super) const MOST_OF_AXIS: u32 = 6;
/// What of an axis' swing is lost with one joint; with more, it goes with the square of their number. The joint's wood
/// is straight where the model's is a parabola.
const LOST_WITH_ONE: f32 = 0.35;
/// Shorter axes have no joints, metres.
const LEAST_M: f32 = 1e-4;

/// What of each axis is bound to what.
pub(super) struct Rig {
    pub bones: Arc<Bones>,
    /// By axis.
    holds: Vec<Hold>,
}

/// What an axis is bound to.
#[derive(Clone, Copy)]
struct Hold {
    /// What its foot is bound to: that of the axis which bears it.
    foot: Shares,
    /// Its joints, with consecutive numbers; none where it goes as its foot does.
    first: u32,
    count: u32,
    tip: Vec3,
}

/// Joints and their shares, whose sum is 1; the largest first.
type Shares = [(u16, f32); INFLUENCES];

/// To the ground.
const STILL: Shares = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];

impl Rig {
    /// The joints of a tree: the more there are on an axis, the more swings with it.
    pub fn new(field: &Field<'_>, settings: BoneSettings, sway: &Arc<Sway>) -> Self {
        let whole = field.whole;
        let counts = counts(field, settings);
        let ground = (0..whole.axes.len())
            .filter(|&axis| whole.axes[axis].parent == NO_PARENT)
            .map(|axis| field.axes[axis].pivot)
            .reduce(|low, foot| if foot.y < low.y { foot } else { low });
        let place = ground.unwrap_or_default();
        let root = Joint { name: "joint".to_owned(), parent: None, place, order: 0 };
        let bones = Bones { joints: vec![root], sway: Arc::clone(sway), turns: Vec::new() };
        let mut rig = Self { bones: Arc::new(bones.clone()), holds: Vec::with_capacity(counts.len()) };
        let mut joints = bones.joints;
        // Where the wind model moves what a joint looks at.
        let mut looks = vec![(Vec3::ZERO, [Vec3::ZERO; 3])];
        for (axis, &count) in counts.iter().enumerate() {
            let foot = match whole.axes[axis].parent {
                NO_PARENT => STILL,
                node => rig.shares(&joints, field.axis_of[node as usize] as usize, field.axes[axis].pivot),
            };
            let (places, tip) = places(field, axis, count);
            rig.holds.push(Hold { foot, first: joints.len() as u32, count, tip });
            for (number, &place) in places.iter().enumerate() {
                let parent = if number == 0 { usize::from(foot[0].0) } else { joints.len() - 1 };
                let name = format!("joint_{axis}_{number}");
                joints.push(Joint { name, parent: Some(parent), place, order: whole.axes[axis].order });
                let next = places.get(number + 1).copied().unwrap_or(tip);
                looks.push((next, field.axes[axis].moved(next)));
            }
        }
        let turns = turns(&joints, &looks, sway);
        rig.bones = Arc::new(Bones { joints, turns, sway: Arc::clone(sway) });
        rig
    }

    /// What a place of an axis is bound to.
    pub fn bind(&self, axis: usize, place: Vec3) -> Binding {
        let shares = self.shares(&self.bones.joints, axis, place);
        let mut binding = Binding { joints: [0; INFLUENCES], weights: [0; INFLUENCES] };
        let mut rest = 255;
        for (i, (joint, share)) in shares.into_iter().enumerate().skip(1) {
            // Cut off, so that the first stays the largest.
            let weight = ((share * 255.0) as u8).min(rest);
            if weight > 0 {
                (binding.joints[i], binding.weights[i]) = (joint, weight);
                rest -= weight;
            }
        }
        (binding.joints[0], binding.weights[0]) = (shares[0].0, rest);
        binding
    }

    fn shares(&self, joints: &[Joint], axis: usize, place: Vec3) -> Shares {
        let Hold { foot, first, count, tip } = self.holds[axis];
        if count == 0 {
            return foot;
        }
        let own = &joints[first as usize..(first + count) as usize];
        // The nearest place of the line through the joints.
        let (mut nearest, mut piece, mut along) = (f32::INFINITY, 0, 0.0);
        for (i, joint) in own.iter().enumerate() {
            let to = own.get(i + 1).map_or(tip, |next| next.place) - joint.place;
            let t = ((place - joint.place).dot(to) / to.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let away = place.distance_squared(joint.place + to * t);
            if away < nearest {
                (nearest, piece, along) = (away, i, t);
            }
        }
        let number = |piece: usize| (first + piece as u32) as u16;
        let mut all = [(0, 0.0); INFLUENCES + 1];
        let mut len = 0;
        let mut add = |joint: u16, share: f32| match all[..len].iter_mut().find(|(known, _)| *known == joint)
        {
            Some((_, sum)) => *sum += share,
            None if share > 0.0 => {
                all[len] = (joint, share);
                len += 1;
            }
            None => {}
        };
        // From the middle of a piece to that of the next one joint hands on to the other; at its foot an axis goes
        // as what bears it.
        if along < 0.5 && piece == 0 {
            add(number(0), 2.0 * along);
            for (joint, share) in foot {
                add(joint, share * (1.0 - 2.0 * along));
            }
        } else if along < 0.5 {
            add(number(piece), 0.5 + along);
            add(number(piece - 1), 0.5 - along);
        } else if piece + 1 < own.len() {
            add(number(piece), 1.5 - along);
            add(number(piece + 1), along - 0.5);
        } else {
            add(number(piece), 1.0);
        }
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let sum: f32 = all[..INFLUENCES].iter().map(|(_, share)| share).sum();
        [0, 1, 2, 3].map(|i| (all[i].0, all[i].1 / sum.max(f32::MIN_POSITIVE)))
    }
}

/// How many joints a tree has at most, that of the ground among them.
pub fn most_joints(whole: &Skeleton, settings: BoneSettings) -> u32 {
    let axes = whole.axes.iter().filter(|axis| axis.order <= settings.order).count() as u64;
    (1 + axes * u64::from(MOST_OF_AXIS)).min(settings.most.into()) as u32
}

/// How many joints each axis has: one by one they go where most is won by them, but none to an axis on one that has
/// none. Strength and direction of the wind have no part in it.
fn counts(field: &Field<'_>, settings: BoneSettings) -> Vec<u32> {
    let whole = field.whole;
    let bearer = |axis: usize| match whole.axes[axis].parent {
        NO_PARENT => None,
        node => Some(field.axis_of[node as usize] as usize),
    };
    // Nodes of an axis and of all that it bears; how far all of them go with its swing.
    let mut borne: Vec<f32> = whole.axes.iter().map(|axis| axis.len as f32).collect();
    let mut swings = vec![0.0_f32; borne.len()];
    for axis in (0..borne.len()).rev() {
        let swing = &field.axes[axis];
        let nodes = whole.nodes_of(&whole.axes[axis]).iter();
        swings[axis] += nodes.map(|&node| swing.share(whole.positions[node as usize])).sum::<f32>();
        if let Some(bearer) = bearer(axis) {
            borne[bearer] += borne[axis];
            swings[bearer] += field.axes[bearer].share(swing.pivot) * borne[axis];
        }
    }
    let lost = |count: u32| if count == 0 { 1.0 } else { LOST_WITH_ONE / (count * count) as f32 };
    let gain = |axis: usize, count: u32| {
        let way = field.axes[axis].way() * swings[axis];
        // Of numbers that are not negative the bits are in the same order.
        ((way * (lost(count) - lost(count + 1))).max(0.0).to_bits(), Reverse(axis))
    };
    let mut children: Vec<(usize, usize)> =
        (0..borne.len()).filter_map(|axis| Some((bearer(axis)?, axis))).collect();
    children.sort_unstable();
    let may =
        |axis: usize| whole.axes[axis].order <= settings.order && length_m(whole, field, axis) > LEAST_M;
    let mut counts = vec![0; borne.len()];
    let stems = (0..borne.len()).filter(|&axis| bearer(axis).is_none() && may(axis));
    let mut next: BinaryHeap<_> = stems.map(|axis| gain(axis, 0)).collect();
    // One is the ground.
    for _ in 1..settings.most {
        let Some((_, Reverse(axis))) = next.pop() else { break };
        counts[axis] += 1;
        if counts[axis] < MOST_OF_AXIS {
            next.push(gain(axis, counts[axis]));
        }
        if counts[axis] == 1 {
            let from = children.partition_point(|(bearer, _)| *bearer < axis);
            let of_axis = children[from..].iter().take_while(|(bearer, _)| *bearer == axis);
            next.extend(of_axis.filter(|(_, child)| may(*child)).map(|(_, child)| gain(*child, 0)));
        }
    }
    counts
}

/// An axis from where it leaves what bears it.
fn line(whole: &Skeleton, field: &Field<'_>, axis: usize) -> impl Iterator<Item = Vec3> {
    let nodes = whole.nodes_of(&whole.axes[axis]).iter().map(|&node| whole.positions[node as usize]);
    std::iter::once(field.axes[axis].pivot).chain(nodes)
}

fn length_m(whole: &Skeleton, field: &Field<'_>, axis: usize) -> f32 {
    line(whole, field, axis).zip(line(whole, field, axis).skip(1)).map(|(a, b)| a.distance(b)).sum()
}

/// Where so many joints of an axis are, and its tip: evenly from where it begins to move, because a parabola bends
/// everywhere alike.
fn places(field: &Field<'_>, axis: usize, count: u32) -> (Vec<Vec3>, Vec3) {
    let whole = field.whole;
    let tip = line(whole, field, axis).last().unwrap_or_default();
    if count == 0 {
        return (Vec::new(), tip);
    }
    let length_m = length_m(whole, field, axis);
    let still_m = field.axes[axis].still_m.min(0.5 * length_m);
    let mut wanted = (0..count).map(|i| still_m + (length_m - still_m) * i as f32 / count as f32).peekable();
    let (mut places, mut before_m) = (Vec::with_capacity(count as usize), 0.0);
    for (from, to) in line(whole, field, axis).zip(line(whole, field, axis).skip(1)) {
        let piece_m = from.distance(to);
        while let Some(at_m) = wanted.next_if(|at_m| *at_m <= before_m + piece_m) {
            places.push(from.lerp(to, ((at_m - before_m) / piece_m.max(1e-12)).clamp(0.0, 1.0)));
        }
        before_m += piece_m;
    }
    places.extend(wanted.map(|_| tip));
    (places, tip)
}

/// The turns of all joints within their parents, frame by frame. Each looks, from where its parents carried it, to
/// where the wind model has moved the next joint of its axis.
fn turns(joints: &[Joint], looks: &[(Vec3, [Vec3; 3])], sway: &Sway) -> Vec<Quat> {
    let mut turns = Vec::with_capacity(joints.len() * sway.frames() as usize);
    let mut pose: Vec<(Quat, Vec3)> = Vec::with_capacity(joints.len());
    for frame in 0..sway.frames() {
        let swing = Swing::at(sway, frame);
        pose.clear();
        for (joint, &(next, moved)) in joints.iter().zip(looks) {
            let Some(parent) = joint.parent else {
                pose.push((Quat::IDENTITY, joint.place));
                turns.push(Quat::IDENTITY);
                continue;
            };
            let (carried, at) = pose[parent];
            let at = at + carried * (joint.place - joints[parent].place);
            let turn = arc(next - joint.place, next + swing.moved(moved) - at);
            pose.push((turn, at));
            turns.push((carried.inverse() * turn).normalize());
        }
    }
    turns
}

/// The shortest turn from one direction to another, good for small ones too.
fn arc(from: Vec3, to: Vec3) -> Quat {
    let (from, to) = (from.normalize_or_zero(), to.normalize_or_zero());
    let cos = from.dot(to);
    // Nothing turns by half a turn in a wind; a direction that is none turns nothing.
    if cos <= -0.9 || from == Vec3::ZERO || to == Vec3::ZERO {
        return Quat::IDENTITY;
    }
    let axis = from.cross(to);
    Quat::from_xyzw(axis.x, axis.y, axis.z, 1.0 + cos).normalize()
}
