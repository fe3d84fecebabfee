//! What is left of limbs that a trunk has shed: short dead snags, and the swellings that have closed over them.
//!
//! They are tubes of their stem like surface roots, laid against its bark in a fillet, and no wood of the skeleton.

use std::f32::consts::TAU;
use std::sync::Arc;

use super::features::{Ends, Flare};
use super::path::{self, Ring, Station};
use super::roots::{Host, Laid, Root};
use linden_base::random::Key;
use linden_skeleton::{NO_PARENT, Skeleton};

/// What is left of shed limbs on the bole of each stem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stubs {
    /// How many there are on a metre of it.
    pub per_m: f32,
    /// Mean length of a snag, metres; 0: all have healed.
    pub length_m: f32,
    /// Thinner ones are left out, radius in metres: levels of detail do that.
    pub smallest_m: f32,
}

impl Default for Stubs {
    fn default() -> Self {
        Self { per_m: 0.0, length_m: 0.15, smallest_m: 0.0 }
    }
}

/// More than these a stem has not, however long it is.
pub(super) const MOST: usize = 256;
/// Rings of one at most.
pub(super) const MOST_RINGS: usize = 10;
/// Rings of the stem that one is laid against.
pub(super) const HOST_RINGS: usize = 4;
/// Below this height over the foot, in radii of the trunk, there are none: there it is too thick and too old.
const LOWEST: f32 = 2.2;
/// How far they go into the crown, as a share of its height: there dead limbs are among living ones.
const INTO_CROWN: f32 = 0.2;
/// Radii, in radii of the trunk there.
const RADII: [f64; 2] = [0.05, 0.13];
/// How many have healed, where snags have a length.
const HEALED: f64 = 0.4;
/// Fillets, in radii of the stub: bark closes round a snag in a collar, and a healed one is a wide swelling.
const FILLETS: [f32; 2] = [0.7, 1.6];
/// Radius of a healed one, in radii of the limb: bark closes over more than the wound.
const BOSS: f32 = 1.8;
/// From one to the next round the trunk: the golden angle, as branches stood.
const DIVERGENCE: f32 = 2.399_963;

/// The bole of a stem.
pub(super) struct Bole<'a> {
    pub rings: &'a [Ring],
    pub flare: Option<Flare>,
    /// Where limbs begin, along the stem, metres.
    pub crown_m: f32,
    /// Of the stem at its foot.
    pub radius_m: f32,
    pub key: Key,
}

impl Bole<'_> {
    /// What is on it, from the foot up, and how each ends.
    pub fn stubs(&self, settings: &Stubs) -> Vec<(Laid, Ends)> {
        let Some(top) = self.rings.last().filter(|_| settings.per_m > 0.0) else { return Vec::new() };
        let highest_m = self.crown_m + INTO_CROWN * (top.along - self.crown_m).max(0.0);
        let turned = self.key.named("turn").between(0.0, f64::from(TAU)) as f32;
        let mut laid = Vec::new();
        for index in 0..MOST as u64 {
            let key = self.key.child(index);
            let along_m = LOWEST * self.radius_m
                + (index as f32 + key.named("place").between(0.1, 0.9) as f32) / settings.per_m;
            if along_m > highest_m {
                break;
            }
            let angle = turned + DIVERGENCE * index as f32 + key.named("aside").between(-0.6, 0.6) as f32;
            laid.extend(self.stub(key, along_m, angle, settings));
        }
        laid
    }

    fn stub(&self, key: Key, along_m: f32, angle: f32, settings: &Stubs) -> Option<(Laid, Ends)> {
        let above = self.rings.partition_point(|ring| ring.along < along_m).clamp(1, self.rings.len() - 1);
        let (from, to) = (&self.rings[above - 1], &self.rings[above]);
        let share = (along_m - from.along) / (to.along - from.along).max(f32::MIN_POSITIVE);
        let center = from.center.lerp(to.center, share);
        let trunk_m = from.onward + (to.radius - from.onward) * share;
        let radius_m = trunk_m * key.named("thickness").between(RADII[0], RADII[1]) as f32;
        if radius_m < settings.smallest_m {
            return None;
        }
        let healed = settings.length_m == 0.0 || key.named("healed").unit() < HEALED;
        let (sin, cos) = libm::sincosf(angle);
        let out = from.side * cos + from.tangent.cross(from.side) * sin;
        // Limbs that are shed stood at all angles, few of them steep.
        let rises = key.named("rises").between(-0.2, 0.7) as f32;
        let way = (out + from.tangent * if healed { 0.0 } else { rises }).normalize_or(out);
        let (first, last) =
            (above.saturating_sub(HOST_RINGS / 2), (above + HOST_RINGS / 2).min(self.rings.len()));
        let host = Host { rings: self.rings[first..last].to_vec(), flare: self.flare };
        let bark_m = host.reach_along_m(center, way);
        let start_m = bark_m - 1.5 * radius_m;
        let stations: Vec<Station> = if healed {
            // A boss: half a ball that is flatter than wide.
            let rises_m = radius_m * key.named("boss").between(0.4, 1.0) as f32;
            let boss = |t: f32| {
                let (sin, cos) = libm::sincosf(t * 0.25 * TAU);
                Station::new(center + way * (bark_m + rises_m * sin), radius_m * BOSS * cos.max(0.12))
            };
            let base = Station::new(center + way * start_m, radius_m * BOSS);
            std::iter::once(base).chain((0..=5).map(|i| boss(i as f32 / 5.0))).collect()
        } else {
            let length_m = settings.length_m * key.named("length").between(0.35, 1.65) as f32;
            let bend = from.tangent * (length_m * key.named("bend").between(-0.25, 0.1) as f32);
            let reach_m = length_m + bark_m - start_m;
            (0..=6)
                .map(|i| {
                    let t = i as f32 / 6.0;
                    // Dead wood without its bark is thinner than where the trunk holds it.
                    let radius = radius_m * (1.0 - 0.3 * t);
                    Station::new(center + way * (start_m + reach_m * t) + bend * (t * t), radius)
                })
                .collect()
        };
        let mut rings = Vec::new();
        let is_bent = path::rings(&stations, 0.0, |_| 1.2, &mut Vec::new(), &mut rings);
        let base_m = radius_m * if healed { BOSS } else { 1.0 };
        let clear_m = 1.5 * radius_m + if healed { f32::MAX } else { 3.0 * radius_m };
        let fillet_m = radius_m * FILLETS[usize::from(healed)];
        let root = Root::on(Arc::new(host), [fillet_m, clear_m, 0.1 * radius_m, base_m], key, &rings)?;
        let ends = match key.named("end").unit() {
            _ if healed => Ends::Bud,
            x if x < 0.6 => Ends::Broken,
            _ => Ends::Cut,
        };
        Some((Laid { rings, root, is_bent }, ends))
    }
}

/// A stem with a bole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trunk {
    axis: u32,
    /// At its foot.
    pub radius_m: f32,
    /// Where its limbs begin, along it, metres.
    pub crown_m: f32,
}

/// The stems of a plant that have boles.
#[derive(Clone, Debug, Default)]
pub(super) struct Boles {
    trunks: Vec<Trunk>,
}

/// No more stems than these have any.
const MOST_STEMS: usize = 64;
/// Stems of a smaller share of the thickest one's radius have none.
const THINNEST: f32 = 0.3;
/// A lateral of this share of the radius of its stem is a limb; thinner ones are twigs on the bole, and levels of
/// detail leave them out before they leave out stubs.
const LIMB: f32 = 0.2;

impl Boles {
    pub fn new(skeleton: &Skeleton, settings: &Stubs) -> Self {
        if settings.per_m == 0.0 {
            return Self::default();
        }
        let radius_m = |node: u32| skeleton.radii[node as usize];
        let stems = (0..).zip(&skeleton.axes).filter(|(_, axis)| axis.parent == NO_PARENT && axis.len > 1);
        let mut stems: Vec<(u32, &[u32])> =
            stems.map(|(index, axis)| (index, skeleton.nodes_of(axis))).collect();
        stems.sort_by(|a, b| radius_m(b.1[0]).total_cmp(&radius_m(a.1[0])).then(a.0.cmp(&b.0)));
        stems.truncate(MOST_STEMS);
        let thickest_m = stems.first().map_or(0.0, |(_, nodes)| radius_m(nodes[0]));
        stems.retain(|(_, nodes)| radius_m(nodes[0]) >= THINNEST * thickest_m);
        // The lowest limb of each, by its place along the stem.
        let mut at: Vec<(u32, usize, usize)> = Vec::new();
        for (stem, (_, nodes)) in stems.iter().enumerate() {
            at.extend(nodes.iter().enumerate().map(|(place, &node)| (node, stem, place)));
        }
        at.sort_unstable();
        let mut lowest: Vec<usize> = stems.iter().map(|(_, nodes)| nodes.len() - 1).collect();
        for axis in &skeleton.axes {
            let Ok(found) = at.binary_search_by_key(&axis.parent, |&(node, ..)| node) else { continue };
            let (node, stem, place) = at[found];
            let is_limb = skeleton
                .nodes_of(axis)
                .first()
                .is_some_and(|&first| radius_m(first) >= LIMB * radius_m(node));
            if is_limb {
                lowest[stem] = lowest[stem].min(place);
            }
        }
        let length_m = |nodes: &[u32]| -> f32 {
            let place = |node: u32| skeleton.positions[node as usize];
            nodes.windows(2).map(|pair| place(pair[0]).distance(place(pair[1]))).sum()
        };
        let trunk = |((axis, nodes), lowest): ((u32, &[u32]), usize)| Trunk {
            axis,
            radius_m: radius_m(nodes[0]),
            crown_m: length_m(&nodes[..=lowest]),
        };
        Self { trunks: stems.into_iter().zip(lowest).map(trunk).collect() }
    }

    /// How many stems have any at most, whatever stands there.
    pub const fn most(stems: usize) -> usize {
        if stems < MOST_STEMS { stems } else { MOST_STEMS }
    }

    pub fn stem(&self, axis: u32) -> Option<&Trunk> {
        self.trunks.iter().find(|trunk| trunk.axis == axis)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::plan::{Course, Plan};
    use super::super::tests::tree;
    use super::super::{Features, Topology, Tubes, classes, count, sweep, topology};
    use super::*;
    use linden_base::monitor::Quiet;
    use linden_skeleton::Wood;

    const RADIUS_M: f32 = 0.2;
    const LIMB_M: f32 = 6.0;

    /// A stem of 10 m with a limb at 6 m and a twig at 2 m.
    fn pole() -> Skeleton {
        let mut positions: Vec<Vec3> = (0..=20).map(|i| Vec3::Y * (0.5 * i as f32)).collect();
        let mut parents: Vec<u32> = (0..=20_u32).map(|i| if i == 0 { NO_PARENT } else { i - 1 }).collect();
        let mut radii = vec![RADIUS_M; 21];
        for (node, radius) in [(12, 0.5 * RADIUS_M), (4, 0.01)] {
            let from = positions[node as usize];
            positions.push(from + Vec3::new(2.0, 0.5, 0.0));
            parents.push(node);
            radii.push(radius);
        }
        let births = vec![0; positions.len()];
        let branching =
            linden_skeleton::Branching { positions, parents, births, radii: Some(radii), edges: None };
        Skeleton::build(branching, &Wood::default()).unwrap()
    }

    fn tubes(per_m: f32, length_m: f32) -> Tubes {
        let stubs = Stubs { per_m, length_m, smallest_m: 0.0 };
        Tubes { features: Features { stubs, ..Features::default() }, ..Tubes::default() }
    }

    fn found(skeleton: &Skeleton, tubes: &Tubes) -> Vec<(Vec<Ring>, Ends)> {
        let course = Course::new(skeleton, tubes);
        let plan = Plan::new(&course, 0..1);
        plan.axes()
            .filter(|(_, form)| form.root.is_some())
            .map(|(rings, form)| (rings.to_vec(), form.ends))
            .collect()
    }

    fn out_m(ring: &Ring) -> f32 {
        ring.center.with_y(0.0).length()
    }

    #[test]
    fn they_stand_on_the_bole_as_densely_and_as_far_as_asked() {
        for per_m in [0.5, 3.0, 10.0] {
            let all = found(&pole(), &tubes(per_m, 0.2));
            let (low, high) = (LOWEST * RADIUS_M, LIMB_M + INTO_CROWN * (10.0 - LIMB_M));
            let expected = (high - low) * per_m;
            assert!((all.len() as f32 - expected).abs() <= 1.0, "{}, not {expected}", all.len());
            for (rings, _) in &all {
                let (first, last) = (&rings[0], &rings[rings.len() - 1]);
                assert!(out_m(first) + first.radius < RADIUS_M * 1.1 && out_m(last) > RADIUS_M);
                assert!(first.center.y > low - 0.2 && first.center.y < high + 0.2);
            }
        }
        let all = found(&pole(), &tubes(20.0, 0.2));
        let snags: Vec<f32> = all
            .iter()
            .filter(|(_, ends)| *ends != Ends::Bud)
            .map(|(rings, _)| rings[rings.len() - 1].center.distance(rings[0].center))
            .collect();
        let mean = snags.iter().sum::<f32>() / snags.len() as f32;
        // With what is within the trunk.
        assert!((0.17..0.3).contains(&mean), "{mean}");
        assert!(snags.len() * 10 > all.len() * 4 && snags.len() * 10 < all.len() * 8);
    }

    #[test]
    fn healed_ones_are_swellings_of_the_bark() {
        let all = found(&pole(), &tubes(5.0, 0.0));
        assert!(all.len() > 20 && all.iter().all(|(_, ends)| *ends == Ends::Bud));
        assert!(all.iter().all(|(rings, _)| out_m(&rings[rings.len() - 1]) < 1.2 * RADIUS_M));
    }

    #[test]
    fn the_wood_stays_as_it_is_and_they_are_closed_and_counted() {
        let pole = pole();
        let [bare, stubby] = [tubes(0.0, 0.2), tubes(4.0, 0.2)];
        let [without, with] = [bare, stubby].map(|tubes| sweep(&pole, &tubes, &Quiet).unwrap());
        assert_eq!(topology(&with, &Quiet).unwrap(), Topology::default());
        let [before, after] = [bare, stubby].map(|tubes| count(&pole, &tubes, &Quiet).unwrap());
        assert_eq!(after[0].vertices - after[0].stubs, before[0].vertices);
        assert_eq!(after[1..], before[1..]);
        assert_eq!(with.positions[..before[0].vertices], without.positions[..before[0].vertices]);
        assert_eq!(with.positions[after[0].vertices..], without.positions[before[0].vertices..]);
        // They have the bark of the trunk, though they are as thin as what has another.
        let found = classes(&with, &after, &pole, &[0.15, 0.05], &Quiet).unwrap();
        assert!(found[..after[0].triangles].iter().all(|&class| class == 0));
    }

    #[test]
    fn levels_of_detail_drop_the_thin_ones_first() {
        let left = |smallest: f32| {
            let mut tubes = tubes(4.0, 0.2);
            tubes.features.stubs.smallest_m = smallest * RADIUS_M;
            found(&pole(), &tubes).len()
        };
        let counts = [0.0, 0.06, 0.09, 0.12, 0.14].map(left);
        assert!(counts.is_sorted_by(|a, b| a > b) && counts[4] == 0, "{counts:?}");
        assert!(
            found(&tree(vec![Vec3::ZERO, Vec3::Y], vec![NO_PARENT, 0], &Wood::default()), &tubes(0.0, 1.0))
                .is_empty()
        );
    }
}
