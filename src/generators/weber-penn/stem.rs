//! One stem: its wood, the places of its children, its leaves.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3, Vec3};
use linden_base::random::Key;
use linden_skeleton::Edge;
use linden_skeleton::organs::{PlacedOrgans, prototype};

use crate::WeberPenn;
use crate::course::{Limb, Line, Start};
use crate::leaf;
use crate::level::Level;
use crate::taper::{bends, tapered};

/// A parent that lies outside: the node that the stem leaves from.
pub(crate) const OUTSIDE: u32 = u32::MAX;

/// Stems that the envelope leaves less of are not there.
const LEAST_LEFT: f64 = 0.05;
/// Steps of the search for the length that fits: to 1/256.
const HALVINGS: u32 = 8;
/// Nodes that are nearer, in segments, are one.
const NEAREST: f64 = 1e-3;

/// A tree as far as it is drawn once.
pub(crate) struct Tree<'a> {
    pub settings: &'a WeberPenn,
    pub levels: Vec<Level>,
    /// Metres.
    pub scale_m: f64,
    /// Metres from the foot along the wood for one step of births.
    pub birth_m: f64,
}

/// A stem that is to grow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stem {
    pub key: Key,
    pub level: usize,
    /// Z up, metres.
    pub origin: DVec3,
    pub frame: DQuat,
    /// Before the envelope shortens it.
    pub length_m: f64,
    /// What was drawn for all children of its parent: length ÷ parent's.
    pub length_share: f64,
    pub parent: Parent,
    /// The node that it leaves from; of a piece first, then of the tree.
    pub node: u32,
    /// From the foot of the tree to its origin along the wood.
    pub way_m: f64,
}

/// What a stem knows of its parent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parent {
    pub length_m: f64,
    /// At its base.
    pub radius_m: f64,
    /// Where the stem leaves.
    pub radius_there_m: f64,
    /// Where the stem leaves, as a share of its length.
    pub along: f64,
}

/// What grew of some stems, nodes counted from 0.
#[derive(Default)]
pub(crate) struct Piece {
    pub positions: Vec<Vec3>,
    pub parents: Vec<u32>,
    pub births: Vec<u32>,
    pub radii: Vec<f32>,
    pub edges: Vec<Edge>,
    pub children: Vec<Stem>,
    pub leaves: PlacedOrgans,
    /// How many limbs split from the stem.
    pub clones: u32,
}

/// A stem's measures.
struct Body {
    length_m: f64,
    radius_m: f64,
    taper: f64,
    segment_m: f64,
}

impl Body {
    fn radius_at(&self, offset_m: f64) -> f64 {
        tapered(self.taper, self.radius_m, self.length_m, offset_m / self.length_m)
    }
}

/// Something that leaves a limb.
#[derive(Clone, Copy)]
struct Place {
    offset_m: f64,
    /// About the limb, radians.
    azimuth: f64,
}

impl Tree<'_> {
    /// Grows a stem; `None`: there are more nodes than there may be.
    pub fn grow(&self, stem: &Stem, most_nodes: usize) -> Option<Piece> {
        let settings = self.settings;
        let level = &self.levels[stem.level];
        let base_splits = if stem.level == 0 { base_splits(settings.base_splits, stem.key) } else { 0 };
        let start = Start {
            key: stem.key,
            origin: stem.origin,
            frame: stem.frame,
            level,
            base_splits,
            attraction: if stem.level >= 2 { settings.attraction_up } else { 0.0 },
            most_segments: most_nodes,
        };
        let length_m = self.pruned(stem, &start)?;
        let mut piece = Piece::default();
        if length_m < LEAST_LEFT * stem.length_m {
            return Some(piece);
        }
        let body = Body {
            length_m,
            radius_m: self.radius_m(stem, length_m),
            taper: level.taper,
            segment_m: length_m / f64::from(level.segments),
        };
        let limbs = start.trace(length_m)?;
        piece.clones = limbs.len() as u32 - 1;
        let mut bears = Bearing::of(self, stem, &body);
        // Of each limb: the node that ends each of its segments.
        let mut ends: Vec<Vec<u32>> = Vec::with_capacity(limbs.len());
        for limb in &limbs {
            let line = Line::new(limb, level, body.segment_m, settings.smooth);
            let foot = match limb.parent {
                Some(parent) => ends[parent][(limb.first - 1 - limbs[parent].first) as usize],
                None => OUTSIDE,
            };
            ends.push(self.limb(stem, (limb, &line), &body, &mut bears, foot, &mut piece));
            if piece.positions.len() > most_nodes {
                return None;
            }
        }
        Some(piece)
    }

    /// At its base, metres.
    fn radius_m(&self, stem: &Stem, length_m: f64) -> f64 {
        let WeberPenn { ratio, ratio_power, trunk_scale, trunk_scale_spread, .. } = *self.settings;
        if stem.level == 0 {
            let drawn = trunk_scale + trunk_scale_spread * stem.key.named("girth").between(-1.0, 1.0);
            return length_m * ratio * drawn.max(0.1 * trunk_scale);
        }
        let Parent { length_m: parent_m, radius_m, radius_there_m, .. } = stem.parent;
        (radius_m * libm::pow(length_m / parent_m, ratio_power)).min(radius_there_m)
    }

    /// How long the envelope leaves a stem. `None`: it has too many limbs.
    fn pruned(&self, stem: &Stem, start: &Start<'_>) -> Option<f64> {
        let ratio = self.settings.prune_ratio;
        let fits = |length_m: f64| -> Option<bool> {
            let limbs = start.trace(length_m)?;
            Some(limbs.iter().all(|limb| limb.points[1..].iter().all(|&point| self.is_inside(point))))
        };
        if ratio == 0.0 || stem.level == 0 || fits(stem.length_m)? {
            return Some(stem.length_m);
        }
        let (mut inside_m, mut outside_m) = (0.0, stem.length_m);
        for _ in 0..HALVINGS {
            let middle_m = f64::midpoint(inside_m, outside_m);
            if fits(middle_m)? {
                inside_m = middle_m;
            } else {
                outside_m = middle_m;
            }
        }
        Some(stem.length_m * (1.0 - ratio) + inside_m * ratio)
    }

    /// Whether a place is in the envelope.
    fn is_inside(&self, place: DVec3) -> bool {
        let WeberPenn { envelope, base_size, .. } = self.settings;
        let height = (self.scale_m - place.z) / (self.scale_m * (1.0 - base_size)).max(f64::MIN_POSITIVE);
        libm::hypot(place.x, place.y) / self.scale_m < envelope.width * envelope.ratio(height)
    }

    /// Adds the nodes of a limb, and what it bears. The node that ends each of its segments.
    fn limb(
        &self,
        stem: &Stem,
        (limb, line): (&Limb, &Line<'_>),
        body: &Body,
        bears: &mut Bearing,
        foot: u32,
        piece: &mut Piece,
    ) -> Vec<u32> {
        let is_stem = limb.parent.is_none();
        let first_m = f64::from(limb.first) * body.segment_m;
        let children =
            bears.children.as_mut().map(|crop| crop.places(limb, body.segment_m)).unwrap_or_default();
        let leaves = bears.leaves.as_mut().map(|crop| crop.places(limb, body.segment_m)).unwrap_or_default();
        let mut cuts: Vec<f64> = Vec::new();
        let segments = limb.frames.len();
        for segment in 0..segments {
            cuts.extend(line.between(segment));
            cuts.push(f64::from(limb.first + segment as u32 + 1) * body.segment_m);
        }
        cuts.extend(children.iter().map(|place| place.offset_m));
        let bends = bends(body.taper, body.radius_m, body.length_m);
        cuts.extend(bends.iter().map(|share| share * body.length_m).filter(|&offset_m| offset_m > first_m));
        if is_stem && stem.level > 0 {
            // Where it comes out of its parent's bark, it is as thick as at its base.
            cuts.push(stem.parent.radius_there_m.min(0.3 * body.segment_m));
        }
        cuts.sort_unstable_by(f64::total_cmp);
        let nearest_m = NEAREST * body.segment_m;
        cuts.dedup_by(|next, kept| *next - *kept < nearest_m);
        cuts.retain(|&cut| cut - first_m >= nearest_m && cut <= body.length_m + nearest_m);
        let mut last = foot;
        if is_stem && stem.level == 0 {
            last = self.node(piece, stem, body, (stem.origin, 0.0), OUTSIDE, Edge::Succeeds);
        }
        let first = piece.positions.len() as u32;
        for (i, &cut) in cuts.iter().enumerate() {
            let edge = if i == 0 && !(is_stem && stem.level == 0) { Edge::Branches } else { Edge::Succeeds };
            last = self.node(piece, stem, body, (line.at(cut).0, cut), last, edge);
        }
        // The node at an offset, or the first behind it.
        let node_at = |offset_m: f64| {
            let at = cuts.partition_point(|&cut| cut < offset_m - nearest_m);
            first + at.min(cuts.len() - 1) as u32
        };
        for (number, place) in children.iter().enumerate() {
            let key = limb.key.named("stem").child(number as u64);
            let node = node_at(place.offset_m);
            piece.children.extend(self.child(stem, body, (key, place, node), line.at(place.offset_m)));
        }
        if let Some(crop) = &bears.leaves {
            let key = limb.key.named("leaf");
            for (number, place) in leaves.iter().enumerate() {
                let node = node_at(place.offset_m);
                let at = line.at(place.offset_m);
                let key = key.child(number as u64);
                self.leaf(piece, (key, place, node), at, body.radius_at(place.offset_m), crop);
            }
        }
        (1..=segments).map(|i| node_at(f64::from(limb.first + i as u32) * body.segment_m)).collect()
    }

    fn node(
        &self,
        piece: &mut Piece,
        stem: &Stem,
        body: &Body,
        (place, offset_m): (DVec3, f64),
        parent: u32,
        edge: Edge,
    ) -> u32 {
        piece.positions.push(y_up(place));
        piece.parents.push(parent);
        piece.births.push(libm::ceil((stem.way_m + offset_m) / self.birth_m) as u32);
        piece.radii.push(body.radius_at(offset_m) as f32);
        piece.edges.push(edge);
        piece.positions.len() as u32 - 1
    }

    /// The stem that leaves from a place of another.
    fn child(
        &self,
        stem: &Stem,
        body: &Body,
        (key, place, node): (Key, &Place, u32),
        (origin, along): (DVec3, DQuat),
    ) -> Option<Stem> {
        let (settings, number) = (self.settings, stem.level + 1);
        let level = &self.levels[number];
        let offset_m = place.offset_m;
        let length_share = length_share(stem.key, level);
        let from_tip = body.length_m - offset_m;
        let base_m = if stem.level == 0 { settings.base_size * self.scale_m } else { 0.0 };
        let ratio = from_tip / (body.length_m - base_m).max(f64::MIN_POSITIVE);
        let length_m = if stem.level == 0 {
            body.length_m * length_share * settings.shape_ratio(settings.shape, ratio)
        } else {
            length_share * (body.length_m - 0.6 * offset_m)
        };
        // What Arbaro's conical crown has at its top is no branch.
        if !(length_m > 1e-5 * self.scale_m) {
            return None;
        }
        let down = self.down_angle(level, ratio, key);
        let frame = along * DQuat::from_rotation_z(place.azimuth) * DQuat::from_rotation_x(down);
        let parent = Parent {
            length_m: body.length_m,
            radius_m: body.radius_m,
            radius_there_m: body.radius_at(offset_m),
            along: offset_m / body.length_m,
        };
        let way_m = stem.way_m + offset_m;
        Some(Stem { key, level: number, origin, frame, length_m, length_share, parent, node, way_m })
    }

    /// Radians; by where the stem leaves, 1 at the base of the crown, where the spread is below 0.
    fn down_angle(&self, level: &Level, ratio: f64, key: Key) -> f64 {
        let spread = level.down_angle_spread;
        if spread < 0.0 {
            let share = self.settings.shape_ratio(crate::CrownShape::Conical, ratio);
            return level.down_angle + spread * (1.0 - 2.0 * share);
        }
        level.down_angle + spread * key.named("down").between(-1.0, 1.0)
    }

    fn leaf(
        &self,
        piece: &mut Piece,
        (key, place, node): (Key, &Place, u32),
        (origin, along): (DVec3, DQuat),
        radius_m: f64,
        crop: &Crop,
    ) {
        let settings = self.settings;
        let level = &crop.level;
        let down = level.down_angle + level.down_angle_spread.abs() * key.named("down").between(-1.0, 1.0);
        let about = if crop.is_fan {
            DQuat::from_rotation_y(place.azimuth)
        } else {
            DQuat::from_rotation_z(place.azimuth)
        };
        let stalk = along * about * DQuat::from_rotation_x(down);
        let drawn = 1.0 + settings.leaf_scale_spread * key.named("size").between(-1.0, 1.0);
        let size_m = settings.leaf_scale_m * drawn / settings.leaf_quality.sqrt();
        let foot = origin + stalk * DVec3::Z * (radius_m + settings.leaf_stem * size_m);
        let turned = leaf::bent(stalk, foot, settings.leaf_bend);
        let leaves = &mut piece.leaves;
        leaves.prototypes.push(prototype('L').unwrap_or_default());
        leaves.positions.push(y_up(foot));
        leaves.headings.push(y_up(turned * DVec3::Z).normalize_or(Vec3::Y));
        leaves.ups.push(y_up(turned * DVec3::Y).normalize_or(Vec3::Z));
        leaves.sizes_m.push(size_m as f32);
        leaves.growth.nodes.push(node);
        leaves.growth.colors.push(0);
        leaves.growth.births.push(piece.births[node as usize]);
    }
}

/// Length of the children of a parent ÷ that of the parent, drawn once for all of them.
fn length_share(parent: Key, level: &Level) -> f64 {
    let drawn = level.length_spread * parent.named("length").between(-1.0, 1.0);
    (level.length + drawn).max(0.0)
}

/// What a stem bears.
struct Bearing {
    children: Option<Crop>,
    leaves: Option<Crop>,
}

impl Bearing {
    fn of(tree: &Tree<'_>, stem: &Stem, body: &Body) -> Self {
        let settings = tree.settings;
        let last = settings.levels as usize - 1;
        // Above the bare trunk; out of the parent's bark.
        let from_m = if stem.level == 0 {
            settings.base_size * tree.scale_m
        } else {
            stem.parent.radius_there_m.min(0.5 * body.length_m)
        };
        if stem.level < last {
            let level = tree.levels[stem.level + 1];
            let most = level.branches.abs();
            let count = match stem.level {
                0 => most,
                1 => {
                    let whole_m = stem.parent.length_m * stem.length_share;
                    most * (0.2 + 0.8 * body.length_m / whole_m.max(f64::MIN_POSITIVE))
                }
                _ => most * (1.0 - 0.5 * stem.parent.along),
            };
            // Sums of shares come out a little below whole numbers.
            let count = libm::floor(count + 1e-9);
            let crop = Crop::new(tree, body, (from_m, count), level, level.branches < 0.0, true, 0.0);
            return Self { children: Some(crop), leaves: None };
        }
        if stem.level == 0 || settings.leaves == 0.0 {
            return Self { children: None, leaves: None };
        }
        let share = settings.shape_ratio(settings.leaf_dist, stem.parent.along);
        let count = settings.leaves.abs() * share * settings.leaf_quality;
        let level = Level { branch_dist: 1.0, ..tree.levels[settings.levels as usize] };
        // A number with a fraction: what rounding leaves over begins anywhere, so that the mean is right.
        let error = stem.key.named("leaves").between(-0.5, 0.5);
        let crop = Crop::new(tree, body, (from_m, count), level, settings.leaves < 0.0, false, error);
        Self { children: None, leaves: Some(crop) }
    }
}

/// What leaves a stem all along it.
struct Crop {
    level: Level,
    /// Where it begins, metres.
    from_m: f64,
    length_m: f64,
    count: f64,
    is_fan: bool,
    /// Whether clones share what there is with their stem.
    is_shared: bool,
    is_arbaro: bool,
    /// What rounding the number on the limbs before left over.
    error: f64,
}

impl Crop {
    fn new(
        tree: &Tree<'_>,
        body: &Body,
        (from_m, count): (f64, f64),
        level: Level,
        is_fan: bool,
        is_shared: bool,
        error: f64,
    ) -> Self {
        let is_arbaro = tree.settings.dialect == crate::Dialect::Arbaro;
        Self { level, from_m, length_m: body.length_m, count, is_fan, is_shared, is_arbaro, error }
    }

    /// Where on a limb.
    fn places(&mut self, limb: &Limb, segment_m: f64) -> Vec<Place> {
        if self.is_fan {
            return self.fan(limb);
        }
        let per_m = self.count / (self.length_m - self.from_m);
        if !(per_m > 0.0 && per_m.is_finite()) {
            return Vec::new();
        }
        let mut places = Vec::new();
        // The error of rounding goes on from segment to segment, and from the stem to its clones.
        let mut due = self.error;
        let mut spiral = Spiral::new(&self.level, limb, self.is_arbaro);
        for (i, &share) in limb.shares.iter().enumerate() {
            let start_m = f64::from(limb.first + i as u32) * segment_m;
            let (from_m, to_m) = (start_m.max(self.from_m), start_m + segment_m);
            if from_m >= to_m {
                continue;
            }
            let more = per_m * (to_m - from_m) * if self.is_shared { share } else { 1.0 };
            let after = due + more;
            // The k-th stands where k + ½ of them are due.
            let mut next = places.len() as f64 + 0.5;
            while next <= after {
                let along = from_m + (next - due).max(0.0) / more * (to_m - from_m);
                let offset_m = from_m + (along - from_m) * self.level.branch_dist;
                places.push(Place { offset_m, azimuth: spiral.next() });
                next += 1.0;
            }
            due = after;
        }
        self.error = due - places.len() as f64;
        places
    }

    /// All at the tip, side by side.
    fn fan(&self, limb: &Limb) -> Vec<Place> {
        let count = libm::floor(self.count + limb.key.named("first").unit()) as u32;
        let spread = limb.key.named("turn");
        let place = |i: u32| {
            let drawn = self.level.rotate_spread * spread.child(i.into()).between(-1.0, 1.0);
            let at = (f64::from(i) + 0.5) / f64::from(count) - 0.5;
            Place { offset_m: self.length_m, azimuth: at * self.level.rotate.abs() + drawn }
        };
        (0..count).map(place).collect()
    }
}

/// Azimuths of what leaves a limb, one after the other, radians.
struct Spiral<'a> {
    level: &'a Level,
    key: Key,
    azimuth: f64,
    count: u64,
}

impl<'a> Spiral<'a> {
    fn new(level: &'a Level, limb: &Limb, is_arbaro: bool) -> Self {
        let key = limb.key.named("turn");
        let first = if is_arbaro { 0.0 } else { TAU * key.named("first").unit() };
        let azimuth = first + PI * f64::from(limb.half_turns % 2);
        Self { level, key, azimuth, count: 0 }
    }

    fn next(&mut self) -> f64 {
        let drawn = self.level.rotate_spread * self.key.child(self.count).between(-1.0, 1.0);
        self.count += 1;
        if self.level.rotate >= 0.0 {
            self.azimuth = (self.azimuth + self.level.rotate + drawn) % TAU;
            return self.azimuth;
        }
        let side = PI + self.level.rotate + drawn;
        if self.count.is_multiple_of(2) { -side } else { side }
    }
}

/// Clones at the end of the trunk's first segment; up to as many where the number is below 0.
fn base_splits(splits: f64, key: Key) -> u32 {
    let most = libm::round(splits.abs());
    if splits >= 0.0 { most as u32 } else { (key.named("base splits").unit() * (most + 1.0)) as u32 }
}

/// From Z up to Y up.
fn y_up(v: DVec3) -> Vec3 {
    DVec3::new(v.x, v.z, -v.y).as_vec3()
}
