//! The years of a tree, or of trees that stand together.

use glam::{DVec2, DVec3, Vec3};
use linden_base::monitor::{Monitor, Phase};
use linden_base::random::Key;
use linden_skeleton::{Branching, Edge, NO_PARENT};

use crate::barriers::{Barriers, in_metres};
use crate::error::FARTHEST;
use crate::light::Light;
use crate::shadow::Change;
use crate::share::Shares;
use crate::shed::shed;
use crate::shoot::{Shoot, across, internodes};
use crate::stool::{self, Stem};
use crate::sums::Sums;
use crate::tree::{APEX, DEAD, LATERAL, NODE_BYTES, Node, Nodes, SHED};
use crate::{SelfOrganizing, SelfOrganizingError};

const DOING: &str = "growing by light";
const ADVICE: &str = "lower years or vigor, or raise shed or internode";

/// A tree, or several, with what became of them.
#[derive(Clone, Debug, Default)]
pub struct Grown {
    /// Nodes with radii, births (16 a year) and edges: shoots of an apex go on, those of lateral buds branch.
    pub branching: Branching,
    /// Nodes of branches and trees that were shed.
    pub shed: u64,
    /// Stems that died for want of light, of which nothing is left; a tree has [`SelfOrganizing::stems`].
    pub died: usize,
    /// Of each foot, in the order of the nodes, the number of its tree, from 0; empty where one was planted.
    pub trees: Vec<u32>,
}

/// A tree that is to grow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Planted {
    /// Where it stands, metres, y = 0.
    pub foot: Vec3,
    /// The year in which it is felled, before anything grows; 0: never.
    pub felled_in: u32,
}

impl Grown {
    /// All internodes that ever grew.
    pub fn ever(&self) -> u64 {
        self.branching.parents.iter().filter(|&&parent| parent != NO_PARENT).count() as u64 + self.shed
    }
}

/// Grows a tree at the origin.
///
/// ```
/// use linden_base::monitor::Quiet;
/// use linden_base::random::Key;
/// use linden_self_organizing::{SelfOrganizing, grow};
///
/// let tree = grow(&SelfOrganizing::default(), Key::new(7), &Quiet)?;
/// let height_m = tree.branching.positions.iter().map(|place| place.y).fold(0.0, f32::max);
/// assert!((3.0..15.0).contains(&height_m));
/// # Ok::<(), linden_self_organizing::SelfOrganizingError>(())
/// ```
///
/// # Errors
/// [`SelfOrganizingError`]: too many nodes, too little memory or light, cancelled.
pub fn grow(
    settings: &SelfOrganizing,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Grown, SelfOrganizingError> {
    grow_stand(settings, &[Vec3::ZERO], key, monitor)
}

/// Grows a tree on each foot, metres, y = 0; they shade each other, and grow year by year at the same time.
///
/// [`SelfOrganizing::obstacles`] are left out: [`grow_among`] takes them as they stand.
///
/// A tree's random choices follow from its number and the key, not from the other trees. A tree that gets too little
/// light for years dies, but for [`SelfOrganizing::shed`] = 0: there may be fewer trees than feet.
///
/// # Errors
/// As [`grow`].
pub fn grow_stand(
    settings: &SelfOrganizing,
    feet: &[Vec3],
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Grown, SelfOrganizingError> {
    let trees: Vec<Planted> = feet.iter().map(|&foot| Planted { foot, felled_in: 0 }).collect();
    grow_among(settings, &trees, &Barriers::default(), key, monitor)
}

/// As [`grow_stand`], among solids that nothing grows into and that take the light. Trees may be felled: from then on
/// their light is the others'.
///
/// # Errors
/// As [`grow`], and a foot in a solid.
pub fn grow_among(
    settings: &SelfOrganizing,
    trees: &[Planted],
    barriers: &Barriers,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Grown, SelfOrganizingError> {
    let stems = stems_on(settings, trees, barriers, key)?;
    let mut growth = Growth { barriers, ..Growth::new(settings) };
    let places: Vec<Vec3> = stems.iter().map(|(stem, _)| in_space(stem.foot).as_vec3()).collect();
    growth.light.stand_behind(barriers, settings, &places, monitor)?;
    for (number, (stem, felled_in)) in stems.iter().enumerate() {
        if trees.len() > 1 {
            growth.planted.push((stem.key, number as u32 / settings.stems));
        }
        growth.fellings.extend((*felled_in > 0).then_some((*felled_in, stem.key)));
        let turn = in_space(stem.key.named("turn").on_circle());
        growth.plant(in_space(stem.foot) / settings.internode_m + CENTRE, stem.direction, turn, stem.key);
    }
    let years = settings.years_grown();
    while growth.year < years {
        growth.grow_year(monitor)?;
        monitor.advance(Phase::Age, growth.year.into(), Some(years.into()));
    }
    let felled = growth.felled;
    let grown = growth.finish(monitor)?;
    let standing = grown.branching.parents.iter().filter(|&&parent| parent == NO_PARENT).count();
    Ok(Grown { died: stems.len() - standing - felled, ..grown })
}

/// The stems of all trees, each outside of all solids, and when they are felled.
fn stems_on(
    settings: &SelfOrganizing,
    trees: &[Planted],
    barriers: &Barriers,
    key: Key,
) -> Result<Vec<(Stem, u32)>, SelfOrganizingError> {
    let farthest = FARTHEST * settings.internode_m;
    let mut all = Vec::with_capacity(trees.len() * settings.stems as usize);
    for (number, &Planted { foot: Vec3 { x, y, z }, felled_in }) in trees.iter().enumerate() {
        for stem in stool::stems(settings, DVec2::new(x.into(), z.into()), key.child(number as u64)) {
            let DVec2 { x, y: z } = stem.foot;
            if y != 0.0 || !(x.abs() <= farthest && z.abs() <= farthest) {
                return Err(SelfOrganizingError::Foot { number, x: x as f32, y, z: z as f32 });
            }
            // The ground may be the base of a solid.
            if barriers.hold(DVec3::new(x, 0.5 * settings.internode_m, z)) {
                return Err(SelfOrganizingError::FootInside { number, x: x as f32, z: z as f32 });
            }
            all.push((stem, felled_in));
        }
    }
    Ok(all)
}

/// A place on the ground.
fn in_space(place: DVec2) -> DVec3 {
    DVec3::new(place.x, 0.0, place.y)
}

/// A foot at the origin is in the middle of its voxel, so that shade falls evenly about it.
pub(crate) const CENTRE: DVec3 = DVec3::new(0.5, 0.0, 0.5);

/// Trees in a year of their growth, and their light.
pub(crate) struct Growth<'a> {
    pub settings: &'a SelfOrganizing,
    pub barriers: &'a Barriers,
    pub nodes: Nodes,
    pub light: Light,
    /// The last one that passed.
    pub year: u32,
    pub shed: u64,
    /// The year in which a stem is felled, and the key of its foot.
    fellings: Vec<(u32, Key)>,
    /// Stems that were felled.
    felled: usize,
    /// The keys of all feet, in their order, with the numbers of their trees; empty where there is one tree.
    planted: Vec<(Key, u32)>,
}

impl<'a> Growth<'a> {
    pub fn new(settings: &'a SelfOrganizing) -> Self {
        /// In the open.
        static NONE: Barriers = Barriers::none();
        let (nodes, light) = (Nodes::default(), Light::new(settings));
        let (fellings, planted) = (Vec::new(), Vec::new());
        Self { settings, barriers: &NONE, nodes, light, year: 0, shed: 0, fellings, felled: 0, planted }
    }

    /// Adds a seedling: a foot, in voxels, where its apex looks, and the side of its first bud.
    pub fn plant(&mut self, place: DVec3, direction: DVec3, side: DVec3, key: Key) {
        let side = across(side, direction);
        let (parent, birth, order, flags, buds) = (NO_PARENT, 0, 0, APEX, 0);
        self.nodes.push(&Node { parent, place, direction, side, key, birth, order, flags, buds });
    }

    /// One year: light, shares, what is shed, shoots, bending.
    pub fn grow_year(&mut self, monitor: &dyn Monitor) -> Result<(), SelfOrganizingError> {
        monitor.check()?;
        self.year += 1;
        self.drop_old_buds();
        self.light.begin(&self.nodes, self.year, monitor)?;
        let sums = Sums::new(&self.nodes, &self.light);
        let shares = Shares::new(&self.nodes, &sums, self.settings, self.year);
        let bole = self.nodes.bole(self.settings);
        self.fell();
        let lost = shed(&mut self.nodes, &sums, self.settings, self.year, bole);
        drop(sums);
        let shoots = self.shoots(&shares);
        drop(shares);
        self.admit(&shoots, lost.nodes, monitor)?;
        let old = self.nodes.len();
        self.sprout(&shoots, bole.into(), monitor)?;
        let change = |node, is_gone| Change { voxel: self.nodes.voxel(node), is_gone };
        let mut changes: Vec<Change> =
            lost.leafless.iter().map(|&node| change(node as usize, true)).collect();
        changes.extend((old..self.nodes.len()).map(|node| change(node, false)));
        self.light.change(&mut changes, monitor)?;
        if lost.nodes > 0 {
            self.nodes.compact();
            self.shed += lost.nodes as u64;
        }
        if self.settings.sag > 0.0 {
            self.bend(monitor)?;
        }
        Ok(())
    }

    /// Marks the feet of what is felled this year.
    fn fell(&mut self) {
        let now: Vec<Key> =
            self.fellings.iter().filter(|(year, _)| *year == self.year).map(|(_, key)| *key).collect();
        if now.is_empty() {
            return;
        }
        for foot in 0..self.nodes.len() {
            // What died before is not there any more.
            if self.nodes.is_foot(foot) && now.contains(&self.nodes.keys[foot]) {
                self.nodes.flags[foot] |= SHED;
                self.felled += 1;
            }
        }
    }

    /// A bud may grow in the year after its shoot, and waits for some more.
    fn drop_old_buds(&mut self) {
        for node in 0..self.nodes.len() {
            if self.nodes.buds[node] != 0 && self.year - self.nodes.year(node) > self.settings.bud_years + 1 {
                self.nodes.buds[node] = 0;
            }
        }
    }

    /// The buds that grow, in the order of nodes, the apex first. All light is read before any of them casts shade.
    fn shoots(&self, shares: &Shares) -> Vec<Shoot> {
        let mut shoots = Vec::new();
        for node in (0..self.nodes.len()).filter(|&node| !self.nodes.is(node, SHED)) {
            let apex =
                self.nodes.is(node, APEX).then(|| internodes(shares.onward[node], self.settings)).flatten();
            let buds = self.nodes.buds[node];
            let lateral = if buds == 0 { None } else { internodes(shares.bud[node], self.settings) };
            if apex.is_none() && lateral.is_none() {
                continue;
            }
            let brighter = self.light.brighter(&self.nodes, node);
            let shoot =
                |bud, (internodes, length)| Shoot { node: node as u32, bud, internodes, length, brighter };
            shoots.extend(apex.map(|size| shoot(None, size)));
            let numbers = (0..u8::BITS).filter(|bit| buds & (1 << bit) != 0);
            shoots.extend(
                lateral.into_iter().flat_map(|size| numbers.clone().map(move |bit| shoot(Some(bit), size))),
            );
        }
        shoots
    }

    /// Asks whether the year's shoots may grow.
    fn admit(
        &self,
        shoots: &[Shoot],
        shed_nodes: usize,
        monitor: &dyn Monitor,
    ) -> Result<(), SelfOrganizingError> {
        let new: u64 = shoots.iter().map(|shoot| u64::from(shoot.internodes)).sum();
        let (there, limit) = (self.nodes.len() as u64, self.settings.max_nodes);
        let nodes = there - shed_nodes as u64 + new;
        if nodes > limit.into() {
            let (year, years) = (self.year, self.settings.years_grown());
            return Err(SelfOrganizingError::TooManyNodes { year, years, nodes, limit });
        }
        let bytes = (there + new).saturating_mul(NODE_BYTES) + self.light.bytes();
        Ok(monitor.admit(DOING, bytes, ADVICE)?)
    }

    fn sprout(
        &mut self,
        shoots: &[Shoot],
        bole: f64,
        monitor: &dyn Monitor,
    ) -> Result<(), SelfOrganizingError> {
        self.nodes.reserve(shoots.iter().map(|shoot| shoot.internodes as usize).sum());
        for (number, shoot) in shoots.iter().enumerate() {
            if number % 1024 == 0 {
                monitor.check()?;
            }
            let first = self.nodes.len() as u32;
            let grown = shoot.grow(&self.nodes, first, self.year, bole, self.settings, self.barriers);
            let node = shoot.node as usize;
            match shoot.bud {
                None => self.nodes.flags[node] &= !APEX,
                Some(bud) => self.nodes.buds[node] &= !(1 << bud),
            }
            for node in &grown {
                self.nodes.push(node);
            }
        }
        Ok(())
    }

    /// Takes out the seedlings of a stand that never sprouted, where any did.
    fn drop_seedlings(&mut self) {
        let nodes = &mut self.nodes;
        let mut has_sprouted = vec![false; nodes.len()];
        for &parent in nodes.parents.iter().filter(|&&parent| parent != NO_PARENT) {
            has_sprouted[parent as usize] = true;
        }
        let seedlings: Vec<usize> =
            (0..nodes.len()).filter(|&node| nodes.is_foot(node) && !has_sprouted[node]).collect();
        if seedlings.is_empty() || seedlings.len() == nodes.len() {
            return;
        }
        for node in seedlings {
            nodes.flags[node] |= SHED;
        }
        nodes.compact();
    }

    /// The trees in metres.
    pub fn finish(mut self, monitor: &dyn Monitor) -> Result<Grown, SelfOrganizingError> {
        self.drop_seedlings();
        let trees = self.trees();
        let Self { settings, barriers, nodes, light, shed, .. } = self;
        drop(light);
        monitor.admit(DOING, nodes.len() as u64 * (NODE_BYTES + 32), ADVICE)?;
        let pipes = nodes.pipes();
        let is_root = |&node: &usize| !nodes.is_foot(node);
        if !(0..nodes.len()).any(|node| is_root(&node)) {
            let (years, vigor) = (settings.years_grown(), settings.vigor);
            if !barriers.is_empty() && vigor >= 1.0 {
                return Err(SelfOrganizingError::NoLight { years });
            }
            return Err(SelfOrganizingError::NothingGrew { years, vigor });
        }
        let radius = |&pipes: &u32| (0.5 * settings.diameter_m(pipes)) as f32;
        let place = |place: &Vec3| in_metres(*place, settings.internode_m);
        let edge = |flags: &u8| match flags & (LATERAL | DEAD) {
            LATERAL => Edge::Branches,
            flags if flags & LATERAL != 0 => Edge::Dies,
            _ => Edge::Succeeds,
        };
        let branching = Branching {
            positions: nodes.places.iter().map(place).collect(),
            radii: Some(pipes.iter().map(radius).collect()),
            edges: Some(nodes.flags.iter().map(edge).collect()),
            parents: nodes.parents,
            births: nodes.births,
        };
        Ok(Grown { branching, shed, died: 0, trees })
    }

    /// The tree of each foot that is still there. Feet keep their order.
    fn trees(&self) -> Vec<u32> {
        if self.planted.is_empty() {
            return Vec::new();
        }
        let mut planted = self.planted.iter();
        let feet = (0..self.nodes.len()).filter(|&node| self.nodes.is_foot(node));
        let tree =
            |foot: usize| planted.find(|(key, _)| *key == self.nodes.keys[foot]).map(|(_, tree)| *tree);
        feet.map_while(tree).collect()
    }
}
