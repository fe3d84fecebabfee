//! From the skeleton to rings: the course of each axis, with its features.

use std::ops::Range;

use glam::Vec3;

use super::collar::{Collar, MOST_RINGS};
use super::curve::Fineness;
use super::features::{Ends, Flare, taper_twig};
use super::path::{self, Kept, Ring, Station};
use super::roots::{self, Laid, Stools};
use super::stubs::{self, Bole, Boles};
use super::target::Amount;
use super::tube;
use super::tube_form::{Roundness, TubeForm};
use super::{STOUT, Tubes, curve, spread};
use linden_base::memory::bytes_of;
use linden_skeleton::{Axis, Forks, NO_PARENT, Skeleton, WidthSteps};

/// The inputs that all axes of one skeleton share.
pub(super) struct Course<'a> {
    pub skeleton: &'a Skeleton,
    pub tubes: &'a Tubes,
    pub roundness: Roundness,
    pub fineness: Fineness,
    /// Where each node stands in [`Skeleton::axis_nodes`]; empty where no collar asks for it.
    places: Vec<u32>,
    forks: Forks,
    stools: Stools,
    boles: Boles,
    /// Height of the lowest foot, metres; infinite where stems are to stay as they are.
    ground_m: f32,
}

impl<'a> Course<'a> {
    pub fn new(skeleton: &'a Skeleton, tubes: &'a Tubes) -> Self {
        let mut places = Vec::new();
        if tubes.features.collar > 0.0 {
            places = vec![0; skeleton.axis_nodes.len()];
            for (place, &node) in (0..).zip(&skeleton.axis_nodes) {
                places[node as usize] = place;
            }
        }
        let thickest_m = skeleton.radii.iter().copied().fold(0.0, f32::max);
        let roundness = Roundness::new(tubes.sides, thickest_m);
        let stools = Stools::new(skeleton, &tubes.features.roots);
        let boles = Boles::new(skeleton, &tubes.features.stubs);
        let fineness = Fineness::of(skeleton, tubes);
        let forks = Forks::new(skeleton);
        let ground_m = match skeleton.width_steps {
            WidthSteps::Taper => ground_m(skeleton),
            WidthSteps::Cylinder => f32::INFINITY,
        };
        Self { skeleton, tubes, roundness, fineness, places, forks, stools, boles, ground_m }
    }

    fn station(&self, node: u32, thick: u32) -> Station {
        Station::new(self.skeleton.positions[node as usize], self.skeleton.radii[thick as usize])
    }

    /// Over how many radii changes of the radius are spread: steps that were asked for stay.
    fn softness(&self) -> f32 {
        match self.skeleton.width_steps {
            WidthSteps::Taper => self.tubes.width_smoothing,
            WidthSteps::Cylinder => 0.0,
        }
    }

    /// Puts the nodes of an axis where its tube is to pass, as thick as it is to be there.
    fn put_stations(&self, index: usize, stations: &mut Vec<Station>) {
        let axis = &self.skeleton.axes[index];
        let nodes = self.skeleton.nodes_of(axis);
        stations.clear();
        if axis.parent != NO_PARENT {
            // A lateral is as thick at its root inside the parent as at its first node.
            let thick = |&first| if self.forks.runs_on(index as u32) { axis.parent } else { first };
            stations.extend(nodes.first().map(|first| self.station(axis.parent, thick(first))));
        }
        stations.extend(nodes.iter().map(|&node| self.station(node, node)));
        if self.skeleton.width_steps == WidthSteps::Cylinder {
            path::step(stations);
        }
        // What was cut off ends as thick as it was there.
        let is_cut = nodes.last().is_some_and(|apex| self.skeleton.is_cut_at(*apex));
        taper_twig(stations, if is_cut { 0.0 } else { self.tubes.features.twig_taper });
        let least = if axis.parent == NO_PARENT { self.tubes.stem_sides } else { 0 };
        path::thicken(stations, |radius_m| self.roundness.sides(radius_m).max(least));
    }

    /// Appends the rings of an axis, and says how they become its tube.
    fn lay(&self, index: usize, scratch: &mut Scratch, rings: &mut Vec<Ring>) -> TubeForm {
        let Scratch { stations, kept } = scratch;
        let (axis, features) = (&self.skeleton.axes[index], &self.tubes.features);
        let runs_on = self.forks.runs_on(index as u32);
        let nodes = self.skeleton.nodes_of(axis);
        let is_cut = nodes.last().is_some_and(|apex| self.skeleton.is_cut_at(*apex));
        self.put_stations(index, stations);
        curve::subdivide(stations, self.fineness);
        path::prepare(stations, self.softness());
        let is_stem = axis.parent == NO_PARENT;
        let mut form = TubeForm { axis: index as u32, is_stem, ..TubeForm::default() };
        let (Some(&base), Some(&apex)) = (stations.first(), stations.last()) else { return form };
        let is_tip = nodes.last().is_none_or(|apex| !self.forks.ends_at(*apex));
        if apex.radius > features.ends_above_m && is_tip {
            form.ends = features.ends;
        }
        // Where wood was cut off there is no bud.
        if form.ends == Ends::Bud && is_cut {
            form.ends = Ends::Cut;
        }
        if is_stem {
            form.stout = (self.tubes.stem_sides, STOUT * base.radius);
            form.flare = Flare::new(features, base.radius);
            if let Some(flare) = &form.flare {
                flare.widen(stations);
            }
            if let Some(edge) = self.tubes.foot_edge().filter(|_| self.stands(&base)) {
                // Stems change their bark at rings.
                spread::insert(stations, edge.map(|tiles| tiles as f32 * self.tubes.bark_tile_m).into_iter());
            }
        } else if features.collar > 0.0 && !runs_on {
            form.collar = self.collar(axis, base.radius, stations).map(Box::new);
        }
        let sinks = is_stem && self.stands(&base);
        let below_m = if sinks { path::sink(stations, features.foot_depth, features.fall()) } else { 0.0 };
        form.is_bent = path::rings(stations, below_m, |radius_m| self.roundness.reach(radius_m), kept, rings);
        form
    }

    /// Whether a stem with such a base stands on the ground.
    fn stands(&self, base: &Station) -> bool {
        base.position.y - self.ground_m <= base.radius
    }

    fn collar(&self, axis: &Axis, radius_m: f32, stations: &mut Vec<Station>) -> Option<Collar> {
        let node = axis.parent;
        let parents_radius_m = self.skeleton.radii[node as usize];
        let fillet_m = self.tubes.collar_m(parents_radius_m, radius_m);
        let (spine, up) = self.spine(node, 4.0 * (parents_radius_m + fillet_m));
        let sides = self.roundness.sides(radius_m + 0.5 * fillet_m);
        Collar::new(spine, up, stations, fillet_m, sides, self.tubes.features.collar)
    }

    /// The axis through a node as its tube has it, as far as `reach_m` both ways, base to apex; and its
    /// direction at the node.
    fn spine(&self, node: u32, reach_m: f32) -> (Vec<Station>, Vec3) {
        let Skeleton { positions, parents, axis_nodes, .. } = self.skeleton;
        let here = positions[node as usize];
        let place = self.places[node as usize] as usize;
        let follows = |place: usize| parents[axis_nodes[place] as usize] == axis_nodes[place - 1];
        // Above a foot with a flare, down to the foot: the flare is measured from there.
        let flare_m = self.flare_m();
        let (mut first, mut along) = (place, 0.0);
        while first > 0 && along < reach_m.max(flare_m) && follows(first) {
            let below = positions[axis_nodes[first - 1] as usize];
            along += below.distance(positions[axis_nodes[first] as usize]);
            first -= 1;
        }
        let (mut last, mut along) = (place, 0.0);
        while last + 1 < axis_nodes.len() && along < reach_m && follows(last + 1) {
            let above = positions[axis_nodes[last + 1] as usize];
            along += above.distance(positions[axis_nodes[last] as usize]);
            last += 1;
        }
        let mut spine = Vec::with_capacity(last - first + 2);
        let base = axis_nodes[first];
        let is_base = first == 0 || !follows(first);
        let root = parents[base as usize];
        if is_base && root != NO_PARENT {
            spine.push(self.station(root, base));
        }
        spine.extend(axis_nodes[first..=last].iter().map(|&node| self.station(node, node)));
        let below = spine.iter().rfind(|station| station.position != here && station.position.is_finite());
        let up = {
            let at = place - first + usize::from(is_base && root != NO_PARENT);
            let before = if at > 0 { spine[at - 1].position } else { here };
            let after = spine.get(at + 1).map_or(here, |station| station.position);
            let fallback = below.map_or(Vec3::Y, |station| (here - station.position).normalize_or(Vec3::Y));
            ((here - before).normalize_or_zero() + (after - here).normalize_or_zero()).normalize_or(fallback)
        };
        if self.skeleton.width_steps == WidthSteps::Cylinder {
            path::step(&mut spine);
        }
        curve::subdivide(&mut spine, self.fineness);
        path::prepare(&mut spine, self.softness());
        if is_base
            && root == NO_PARENT
            && let Some(flare) = spine.first().and_then(|foot| Flare::new(&self.tubes.features, foot.radius))
        {
            flare.widen(&mut spine);
        }
        (spine, up)
    }

    /// How high the highest flare reaches, metres.
    fn flare_m(&self) -> f32 {
        let thickest_m = self.roundness.thickest_m;
        Flare::new(&self.tubes.features, thickest_m).map_or(0.0, |flare| flare.height_m)
    }
}

/// The height of the lowest foot.
fn ground_m(skeleton: &Skeleton) -> f32 {
    let stems = skeleton.axes.iter().filter(|axis| axis.parent == NO_PARENT);
    let feet = stems.filter_map(|axis| skeleton.nodes_of(axis).first());
    feet.map(|&foot| skeleton.positions[foot as usize].y).fold(f32::INFINITY, f32::min)
}

/// Memory that the axes of a plan are laid in, one after the other.
#[derive(Default)]
struct Scratch {
    stations: Vec<Station>,
    kept: Vec<Kept>,
}

/// The rings of some axes, and how large their tubes will be.
pub(super) struct Plan {
    rings: Vec<Ring>,
    /// Where each axis' rings end, and what is made of them.
    axes: Vec<(usize, TubeForm)>,
    pub amount: Amount,
}

impl Plan {
    pub fn new(course: &Course<'_>, axes: Range<usize>) -> Self {
        let nodes: usize = course.skeleton.axes[axes.clone()].iter().map(|axis| axis.len as usize + 1).sum();
        let mut plan = Self {
            rings: Vec::with_capacity(nodes * course.tubes.rings.max(1) as usize),
            axes: Vec::with_capacity(axes.len()),
            amount: Amount::default(),
        };
        let mut scratch = Scratch::default();
        for index in axes {
            let first = plan.rings.len();
            let form = course.lay(index, &mut scratch, &mut plan.rings);
            let tile_m = course.tubes.bark_tile_m;
            plan.amount =
                plan.amount.and(tube::amount(&plan.rings[first..], &form, &course.roundness, tile_m));
            let flare = form.flare;
            plan.axes.push((plan.rings.len(), form));
            let stem = first..plan.rings.len();
            plan.add_stubs(course, index as u32, &stem, flare);
            plan.add_roots(course, index as u32, &stem, flare);
        }
        plan
    }

    /// Adds a tube of a stem that is no axis.
    fn add(&mut self, course: &Course<'_>, form: TubeForm, laid: Laid, count: impl Fn(Amount) -> Amount) {
        let Laid { rings, root, is_bent } = laid;
        let form = TubeForm { root: Some(Box::new(root)), is_bent, ..form };
        let amount = tube::amount(&rings, &form, &course.roundness, course.tubes.bark_tile_m);
        self.amount = self.amount.and(count(amount));
        self.rings.extend(rings);
        self.axes.push((self.rings.len(), form));
    }

    /// Adds what is left of limbs on a stem whose rings are these.
    fn add_stubs(&mut self, course: &Course<'_>, axis: u32, rings: &Range<usize>, flare: Option<Flare>) {
        let Some(stem) = course.boles.stem(axis) else { return };
        let key = roots::stem_key(course.skeleton, axis).named("stubs");
        let bole = Bole {
            rings: above_ground(&self.rings[rings.clone()]),
            flare,
            crown_m: stem.crown_m,
            radius_m: stem.radius_m,
            key,
        };
        for (number, (laid, ends)) in (0..).zip(bole.stubs(&course.tubes.features.stubs)) {
            // Splinters differ from one to the next.
            let form = TubeForm { axis: key.child(number).bits() as u32, ends, ..TubeForm::default() };
            self.add(course, form, laid, |amount| Amount { stubs: amount.vertices, ..amount });
        }
    }

    /// Adds the roots of a stem whose rings are these.
    fn add_roots(&mut self, course: &Course<'_>, axis: u32, rings: &Range<usize>, flare: Option<Flare>) {
        let Tubes { sides, ref features, .. } = *course.tubes;
        let stem = above_ground(&self.rings[rings.clone()]);
        let all = course.stools.roots_of(course.skeleton, axis, stem, flare, (features, sides));
        for laid in all {
            let form = TubeForm { axis, ..TubeForm::default() };
            self.add(course, form, laid, |amount| Amount {
                roots: [amount.vertices, amount.triangles],
                ..amount
            });
        }
    }

    /// Rings of all tubes.
    pub fn rings(&self) -> usize {
        self.rings.len()
    }

    pub fn len(&self) -> usize {
        self.axes.iter().filter(|(_, form)| form.root.is_none()).count()
    }

    /// The rings of each tube: an axis, or a root behind its stem, and what is made of them.
    pub fn axes(&self) -> impl Iterator<Item = (&[Ring], &TubeForm)> {
        let starts = std::iter::once(0).chain(self.axes.iter().map(|&(end, _)| end));
        starts.zip(&self.axes).map(|(start, (end, form))| (&self.rings[start..*end], form))
    }

    pub fn bytes(&self) -> u64 {
        let collars = self.axes.iter().filter_map(|(_, form)| form.collar.as_ref());
        bytes_of::<Self>(1)
            + bytes_of::<Ring>(self.rings.capacity())
            + bytes_of::<(usize, TubeForm)>(self.axes.capacity())
            + collars.map(|collar| collar.bytes()).sum::<u64>()
            + self
                .axes
                .iter()
                .filter_map(|(_, form)| form.root.as_ref())
                .map(|root| root.bytes())
                .sum::<u64>()
    }
}

/// The rings of a stem without the one that it ends with in the ground.
fn above_ground(rings: &[Ring]) -> &[Ring] {
    let in_ground = rings.first().is_some_and(|base| base.along < 0.0);
    &rings[usize::from(in_ground)..]
}

/// Whether smooth wood has rings between its nodes anywhere.
pub fn bends(skeleton: &Skeleton, tubes: &Tubes) -> bool {
    let course = Course::new(skeleton, tubes);
    let mut stations = Vec::new();
    (0..skeleton.axes.len()).any(|index| {
        course.put_stations(index, &mut stations);
        curve::segments(&stations, course.fineness).any(|rings| rings > tubes.rings)
    })
}

/// What plans take at most, with the lists of rings that grow one by one.
pub(super) fn planned_bytes(skeleton: &Skeleton, tubes: &Tubes) -> u64 {
    let places = if tubes.features.collar > 0.0 { bytes_of::<u32>(skeleton.positions.len()) } else { 0 };
    places
        + Forks::bytes_for(skeleton)
        + planned_bytes_of(skeleton, &skeleton.axes, tubes, Fineness::of(skeleton, tubes))
}

/// The same for some of its axes, without what is shared by all.
pub(super) fn planned_bytes_of(skeleton: &Skeleton, axes: &[Axis], tubes: &Tubes, fineness: Fineness) -> u64 {
    let stems = axes.iter().filter(|axis| axis.parent == NO_PARENT).count();
    // A ring for each node and one more for each lateral, and those between.
    let most = axes.iter().map(|axis| most_rings(skeleton, axis, fineness)).fold(0, usize::saturating_add);
    let axes = axes.len();
    let collars = if tubes.features.collar > 0.0 { axes } else { 0 };
    let roots = Stools::most(stems) * roots::most_roots(tubes.features.roots.count);
    let stubs = if tubes.features.stubs.per_m > 0.0 { Boles::most(stems) * stubs::MOST } else { 0 };
    let most = most + roots * roots::MOST_RINGS + stubs * stubs::MOST_RINGS;
    bytes_of::<Ring>(most + collars * MOST_RINGS).saturating_mul(2)
        + bytes_of::<(usize, TubeForm)>(axes + roots + stubs)
        // A fork has the rings of its root, a stub those around it.
        + bytes_of::<Ring>(roots * roots::MOST_RINGS + stubs * stubs::HOST_RINGS)
        + bytes_of::<roots::Root>(roots + stubs)
        + bytes_of::<Collar>(collars)
}

/// The most rings of an axis.
fn most_rings(skeleton: &Skeleton, axis: &Axis, fineness: Fineness) -> usize {
    // One more for a lateral's root, or a stem's end in the ground.
    let segments = axis.len as usize + 1;
    if fineness.smooth_radius_m == 0.0 {
        return segments.saturating_mul(fineness.rings as usize);
    }
    // A lateral's first segment is as thick as its parent at most.
    let nodes = skeleton.nodes_of(axis);
    let root = if axis.parent == NO_PARENT { nodes.first() } else { Some(&axis.parent) };
    // What is too thin for single precision is made thicker.
    let most = |&node: &u32| fineness.most(2.0 * skeleton.radii[node as usize]) as usize;
    // A segment is as thick as the thicker of its ends.
    let ends = root.into_iter().chain(nodes).map(most).fold(0, usize::saturating_add);
    ends.saturating_mul(2).min(segments.saturating_mul(fineness.most(f32::MAX) as usize))
}
