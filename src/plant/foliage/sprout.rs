//! Leaves on the wood: from a preset's kinds and a skeleton to organs.
//!
//! Each kind is walked for by itself, axis by axis. What is drawn at random has a key of its own: the
//! kind, the axis, the place on it, the leaf there. So the season, the share that is kept, sizes and
//! angles move no other leaf, and of a leaf that is there in autumn there was one in summer.

use std::sync::Arc;

use rayon::prelude::*;

use super::Calendar;
use super::axis::{Place, Spaced, Walk, Young};
use super::bare::bare_below;
use super::form::shapes;
use super::look::{Cover, cover, length_m};
use super::mesh::FoliageError;
use super::pose::{Phyllotaxis, Pose, pose};
use super::sunlight::Sunlight;
use super::{Organs, PROTOTYPES, PlacedOrgans, prototype};
use crate::Specimen;
use crate::settings::{Form, LeafKind};
use linden_base::input::Geometry;
use linden_base::monitor::Holding;
use linden_base::monitor::{Cancelled, Monitor, Phase};
use linden_base::random::Key;
use linden_skeleton::organs::LeafShape;
use linden_skeleton::{Forks, Skeleton};

/// The most leaves: a hundred times what a large tree has.
const MOST_LEAVES: u64 = 50_000_000;
/// For messages about memory.
pub const GROWING: &str = "growing leaves";
/// Axes that one task walks.
const AXES_PER_TASK: usize = 256;
/// Places between two looks at the monitor.
const PLACES_PER_CHECK: u64 = 4096;
/// Side of pictures that are drawn for their cells and mean colours alone, pixels.
const SMALL_PX: u32 = 96;

/// Everything that grows on a skeleton: what its generator left there, and the leaves of the preset.
/// Without a kind that has a form it is the same `given`, but for leaves that need one ([`Organs::need_form`]).
///
/// Where the first kind has a form, the leaves and needles that a generator placed have it too: the season unfolds
/// them and lets them fall, and `leaf_keep` thins them out, as it does with those of the kind's places. Where it has
/// none, those that need one are not there.
///
/// # Errors
/// [`FoliageError`]: files that are missing, too many leaves, too little memory, or cancelled.
pub fn sprout(
    specimen: &Specimen<'_>,
    skeleton: &Skeleton,
    given: &Arc<Organs>,
    monitor: &dyn Monitor,
) -> Result<Arc<Organs>, FoliageError> {
    let foliage = &specimen.dressing.foliage;
    let goes_bare = given.need_form && foliage.first.form == Form::None;
    if foliage.kinds().all(|kind| kind.form == Form::None) && !goes_bare {
        return Ok(Arc::clone(given));
    }
    let monitor = &Holding::new(monitor, given.bytes());
    let mut organs = Organs::clone(given);
    let small = foliage.size_px.min(SMALL_PX);
    let mut all = Vec::new();
    let mut crops = Vec::new();
    for (index, kind) in foliage.kinds().enumerate() {
        let first = (PROTOTYPES.len() + all.len()) as u8;
        let is_there = Calendar::of(kind).is_there(foliage.season as f32);
        // Nothing is drawn for what is out of season.
        if kind.form != Form::None && is_there {
            let cover = cover(specimen, index, kind, small, monitor)?;
            all.extend(kind_shapes(specimen, index, kind, &cover)?);
        }
        let variants = (PROTOTYPES.len() + all.len()) as u8 - first;
        crops.push(Crop::new(kind, first, variants, foliage.season as f32));
    }
    organs.shapes = Arc::from(all);
    let key = specimen.key().named("leaves");
    let forks = Forks::new(skeleton);
    let sunlight = crops
        .iter()
        .find(|crop| crop.shade > 0.0 && crop.kind.form != Form::None)
        .map(|crop| Sunlight::of(skeleton, young(crop.kind, skeleton, &forks)));
    if let Some(first) = crops.first().filter(|crop| crop.kind.form != Form::None) {
        if first.variants > 0 {
            take_over(&mut organs.placed, first, sunlight.as_ref(), key.named("grammar"));
        } else {
            organs.placed = without_leaves(&organs.placed);
        }
    } else if goes_bare {
        organs.placed = without_leaves(&organs.placed);
    }
    let (first, also) = crops.split_at(1);
    let takers: Vec<&Crop> = also.iter().filter(|crop| crop.kind.share > 0.0).collect();
    let mut fields = Vec::new();
    if first[0].variants > 0 || !takers.is_empty() {
        fields.push(Field { crop: &first[0], takers, key: key.child(0), sunlight: sunlight.as_ref() });
    }
    for (i, crop) in also.iter().enumerate().filter(|(_, crop)| crop.kind.share == 0.0 && crop.variants > 0) {
        let key = key.child(i as u64 + 1);
        fields.push(Field { crop, takers: Vec::new(), key, sunlight: sunlight.as_ref() });
    }
    for field in fields {
        field.grow(skeleton, &forks, &mut organs.placed, monitor)?;
    }
    Ok(Arc::new(organs))
}

/// The variants of a kind.
///
/// # Errors
/// [`FoliageError`]: a mesh that is missing or cannot be used.
pub(crate) fn kind_shapes(
    specimen: &Specimen<'_>,
    index: usize,
    kind: &LeafKind,
    cover: &Cover,
) -> Result<Vec<LeafShape>, FoliageError> {
    let mesh = match (kind.form, &kind.mesh) {
        (Form::Mesh, None) => return Err(FoliageError::NoMesh),
        (Form::Mesh, Some(file)) => match specimen.inputs.get(file).map(|input| &input.geometry) {
            Some(Geometry::Mesh(mesh)) => Some(mesh),
            _ => return Err(FoliageError::WrongInput { file: file.clone(), expected: "a mesh (OBJ)" }),
        },
        _ => None,
    };
    let lods = if specimen.dressing.detail.is_whole() { &[] } else { &kind.lod_forms.0[..] };
    shapes((index, kind), lods, cover, mesh.map(|mesh| &**mesh))
}

/// A kind and what is the same for all its leaves.
struct Crop<'a> {
    kind: &'a LeafKind,
    /// The first of its variants, as [`PlacedOrgans::prototypes`] has them.
    first: u8,
    variants: u8,
    /// The share that the season and the user leave.
    kept: f64,
    /// Before the size of each leaf varies it, metres.
    size_m: f64,
    /// Of the whole size, the season's share.
    unfolded: f32,
    /// How far light chooses the variant, 0 to 1: the first ones are those of the shade.
    shade: f32,
}

impl<'a> Crop<'a> {
    fn new(kind: &'a LeafKind, first: u8, variants: u8, season: f32) -> Self {
        let calendar = Calendar::of(kind);
        let (kept, size_m) = (kind.keep * calendar.share(season), length_m(kind) * calendar.size(season));
        let unfolded = calendar.size(season) as f32;
        Self { kind, first, variants, kept, size_m, unfolded, shade: super::look::shade(kind) }
    }

    /// Whether a leaf is there at all. A key's number is below `kept` for no smaller share.
    fn is_kept(&self, key: Key, along: f32) -> bool {
        key.child(KEEP).unit() < self.kept
            && key.child(TIP).unit() >= self.kind.tip * f64::from(1.0 - along)
            && self.variants > 0
    }

    fn size_m(&self, key: Key) -> f32 {
        (self.size_m * (1.0 + self.kind.size_spread * key.child(SIZE).between(-1.0, 1.0))) as f32
    }

    fn variant(&self, key: Key) -> u8 {
        self.first + (key.child(VARIANT).bits() % u64::from(self.variants.max(1))) as u8
    }

    /// The variant of a leaf that so much light reaches, 0 to 1.
    fn variant_in(&self, light: f32, key: Key) -> u8 {
        let chance = key.child(VARIANT).unit() as f32;
        let at = (chance + (light - chance) * self.shade) * f32::from(self.variants);
        self.first + (at.max(0.0) as u8).min(self.variants.saturating_sub(1))
    }
}

// What a leaf draws below its key, after the three numbers of its pose.
const SIZE: u64 = 3;
const KEEP: u64 = 4;
const TIP: u64 = 5;
const TAKER: u64 = 6;
const VARIANT: u64 = 7;

/// Gives the leaves and needles that a generator placed the variants of a kind, and takes those away that the
/// season and the user do not leave.
fn take_over(placed: &mut PlacedOrgans, crop: &Crop, sunlight: Option<&Sunlight>, key: Key) {
    let leafy: Vec<u8> = ['L', 'N'].into_iter().filter_map(prototype).collect();
    let is_gone = |i: usize| key.child(i as u64).child(KEEP).unit() >= crop.kept;
    let gone: Vec<bool> = placed
        .prototypes
        .iter()
        .enumerate()
        .map(|(i, prototype)| leafy.contains(prototype) && is_gone(i))
        .collect();
    let places = placed.prototypes.iter_mut().zip(&placed.positions).zip(&mut placed.sizes_m);
    for (i, ((prototype, &place), size_m)) in places.enumerate() {
        if leafy.contains(prototype) && crop.variants > 0 {
            let key = key.child(i as u64);
            *prototype = match sunlight.filter(|_| crop.shade > 0.0) {
                Some(sunlight) => crop.variant_in(sunlight.at(place), key),
                None => crop.variant(key),
            };
            *size_m *= crop.unfolded;
        }
    }
    if gone.contains(&true) {
        *placed = without(placed, |i| gone[i]);
    }
}

/// What a generator placed but leaves and needles: these are out of season, or without a form.
fn without_leaves(placed: &PlacedOrgans) -> PlacedOrgans {
    let leafy: Vec<u8> = ['L', 'N'].into_iter().filter_map(prototype).collect();
    without(placed, |i| leafy.contains(&placed.prototypes[i]))
}

/// The organs that are not gone.
fn without(placed: &PlacedOrgans, is_gone: impl Fn(usize) -> bool) -> PlacedOrgans {
    let mut others = PlacedOrgans::default();
    for i in (0..placed.len()).filter(|&i| !is_gone(i)) {
        others.prototypes.push(placed.prototypes[i]);
        others.positions.push(placed.positions[i]);
        others.headings.push(placed.headings[i]);
        others.ups.push(placed.ups[i]);
        others.sizes_m.push(placed.sizes_m[i]);
        others.growth.nodes.push(placed.growth.nodes[i]);
        others.growth.colors.push(placed.growth.colors[i]);
        others.growth.births.push(placed.growth.births[i]);
    }
    others
}

/// A walk over all axes.
struct Field<'a> {
    crop: &'a Crop<'a>,
    /// Kinds that take places from it.
    takers: Vec<&'a Crop<'a>>,
    key: Key,
    /// Where a kind has leaves of the sun and of the shade.
    sunlight: Option<&'a Sunlight>,
}

impl Field<'_> {
    fn grow(
        &self,
        skeleton: &Skeleton,
        forks: &Forks,
        placed: &mut PlacedOrgans,
        monitor: &dyn Monitor,
    ) -> Result<(), FoliageError> {
        let young = young(self.crop.kind, skeleton, forks);
        let bare = bare_below(self.crop.kind, skeleton);
        self.admit(young, skeleton, placed.len(), monitor)?;
        let done = std::sync::atomic::AtomicU64::new(0);
        let chunks = skeleton.axes.par_chunks(AXES_PER_TASK).enumerate().map(|(chunk, axes)| {
            monitor.check()?;
            let (placed, walk) = (PlacedOrgans::default(), Walk::default());
            let mut task = Task { field: self, skeleton, forks, young, placed, walk };
            for (i, axis) in axes.iter().enumerate() {
                let index = chunk * AXES_PER_TASK + i;
                let bare_to = bare.get(&index).copied().unwrap_or(f32::NEG_INFINITY);
                task.axis(skeleton.axis_number(index).into(), axis, bare_to, monitor)?;
            }
            let before = done.fetch_add(axes.len() as u64, std::sync::atomic::Ordering::Relaxed);
            monitor.advance(Phase::Sprout, before + axes.len() as u64, Some(skeleton.axes.len() as u64));
            Ok(task.placed)
        });
        let pieces = chunks.collect::<Result<Vec<PlacedOrgans>, Cancelled>>()?;
        placed.reserve(pieces.iter().map(PlacedOrgans::len).sum());
        for piece in pieces {
            placed.append(piece);
        }
        Ok(())
    }

    /// Asks for room before anything grows.
    fn admit(
        &self,
        young: Young,
        skeleton: &Skeleton,
        there: usize,
        monitor: &dyn Monitor,
    ) -> Result<(), FoliageError> {
        let kind = self.crop.kind;
        let mut walk = Walk::default();
        let (mut metres, mut segments, mut tips) = (0.0, 0_u64, 0_u64);
        for (i, axis) in skeleton.axes.iter().enumerate() {
            if i % AXES_PER_TASK == 0 {
                monitor.check()?;
            }
            if walk.begin(skeleton, axis).is_some() {
                metres += walk.leafy_m(young, skeleton);
                segments += u64::from(axis.len);
                tips += u64::from(kind.terminal) * u64::from(kind.count);
            }
        }
        let most = match grid(kind) {
            Some((along, around)) => segments.saturating_mul(along * around) as f64,
            None => metres * kind.per_m,
        };
        let kept = self.takers.iter().map(|taker| taker.kept).fold(self.crop.kept, f64::max);
        let leaves = (most * (1.0 - kind.tip / 2.0) * kept).ceil() as u64 + tips;
        // Walking over places that nothing is kept of takes its time, too.
        if !(most < MOST_LEAVES as f64) {
            return Err(FoliageError::TooMany { leaves: most.min(1e18) as u64, limit: MOST_LEAVES });
        }
        // In pieces whose lists grow one by one, then as a whole.
        let bytes = (leaves * 5 / 2).saturating_add(there as u64) * PlacedOrgans::BYTES_EACH;
        monitor.admit(GROWING, bytes, "lower leaves_per_m, or take twig cards (leaf_form=twig)")?;
        Ok(())
    }

    /// What grows at a place of the first kind, if anything does.
    fn at(&self, key: Key) -> &Crop<'_> {
        let mut share = key.child(TAKER).unit();
        for taker in &self.takers {
            if share < taker.kind.share {
                return taker;
            }
            share -= taker.kind.share;
        }
        self.crop
    }
}

/// The wood that a kind grows on.
fn young(kind: &LeafKind, skeleton: &Skeleton, forks: &Forks) -> Young {
    let births = skeleton.births.iter().copied().max().unwrap_or(0);
    let first_birth = libm::ceil((1.0 - kind.max_age) * f64::from(births)) as u32;
    let max_radius_m = kind.max_radius_m.map_or_else(
        || {
            let tips = skeleton.grown_tips(forks);
            (AUTO_RADIUS * tips.radii_m / f64::from(tips.count)) as f32
        },
        |radius| radius as f32,
    );
    Young { max_radius_m, first_birth }
}

/// Most thickness of a twig, in that of tips: by the pipe model with exponent 2, what bears nine tips or
/// fewer.
const AUTO_RADIUS: f64 = 3.0;

/// Places along and round each segment, where there is a grid.
fn grid(kind: &LeafKind) -> Option<(u64, u64)> {
    let count = |i: usize| kind.grid.get(i).map(|&n| libm::round(n) as u64);
    let along = count(0).filter(|&along| along > 0)?;
    Some((along, count(1).unwrap_or(1).max(1)))
}

/// Some axes, walked one after the other.
struct Task<'a> {
    field: &'a Field<'a>,
    skeleton: &'a Skeleton,
    forks: &'a Forks,
    young: Young,
    placed: PlacedOrgans,
    walk: Walk,
}

impl Task<'_> {
    fn axis(
        &mut self,
        number: u64,
        axis: &linden_skeleton::Axis,
        bare_to: f32,
        monitor: &dyn Monitor,
    ) -> Result<(), Cancelled> {
        let Self { field, skeleton, forks, young, placed, walk } = self;
        let (kind, key) = (field.crop.kind, field.key.child(number));
        let Some(begun) = walk.begin(skeleton, axis) else { return Ok(()) };
        let phyllotaxis = Phyllotaxis::of(kind);
        let turn = if phyllotaxis.is_flat() && !begun.is_upright {
            0.0
        } else {
            key.named("turn").unit() as f32 * std::f32::consts::TAU
        };
        let mut seen = 0_u64;
        let mut each = |place: &Place, member: u32, azimuth: f32| {
            seen += 1;
            if seen.is_multiple_of(PLACES_PER_CHECK) {
                monitor.check()?;
            }
            if place.center.y < bare_to {
                return Ok(());
            }
            for copy in 0..kind.count {
                let leaf = u64::from(member) * u64::from(kind.count) + u64::from(copy);
                let key = key.child(place.number).child(leaf);
                let crop = field.at(key);
                if crop.is_kept(key, place.along) {
                    let lit = field.sunlight.filter(|_| crop.shade > 0.0);
                    let variant = match lit {
                        Some(sunlight) => crop.variant_in(sunlight.at(place.center), key),
                        None => crop.variant(key),
                    };
                    let pose = pose(crop.kind, place, azimuth, copy, key);
                    add(placed, (variant, crop.size_m(key)), &pose, place, skeleton);
                }
            }
            Ok::<(), Cancelled>(())
        };
        if let Some((along, around)) = grid(kind) {
            walk.each_segment(along, *young, skeleton, |place| {
                (0..around as u32).try_for_each(|member| {
                    let share = member as f32 / around as f32;
                    each(&place, member, turn + share * std::f32::consts::TAU)
                })
            })?;
        } else if kind.per_m > 0.0 {
            let spacing_m = f64::from(phyllotaxis.members) * f64::from(kind.count) / kind.per_m;
            let spaced = Spaced { spacing_m, phase: key.named("phase").unit(), from_m: begun.covered_m };
            walk.every(spaced, *young, skeleton, |place| {
                (0..phyllotaxis.members).try_for_each(|member| {
                    each(&place, member, turn + phyllotaxis.azimuth(place.number, member))
                })
            })?;
        }
        let is_tip = skeleton.nodes_of(axis).last().is_none_or(|apex| !forks.ends_at(*apex));
        let is_bare = begun.length_m <= begun.covered_m;
        if let Some(apex) = walk.apex(*young, skeleton).filter(|_| kind.terminal && is_tip && !is_bare) {
            each(&apex, 0, turn)?;
        }
        Ok(())
    }
}

/// Adds a leaf at a place: which variant, and how large, metres.
fn add(
    placed: &mut PlacedOrgans,
    (variant, size_m): (u8, f32),
    pose: &Pose,
    place: &Place,
    skeleton: &Skeleton,
) {
    placed.prototypes.push(variant);
    placed.positions.push(pose.foot);
    placed.headings.push(pose.heading);
    placed.ups.push(pose.up);
    placed.sizes_m.push(size_m);
    placed.growth.nodes.push(place.node);
    placed.growth.colors.push(0);
    placed.growth.births.push(skeleton.births[place.node as usize]);
}
