//! The leaves with fewer of them.

use std::sync::Arc;

use rayon::prelude::*;

use super::forms::LevelForms;
use super::wood::GOLDEN;
use super::{Detail, DetailError};
use crate::foliage::Shaper;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::organs::{OrganOrigins, Organs};

/// Organs that one task counts.
const PER_TASK: usize = 1024;

/// The leaves of a tree in a level, and how many triangles each has.
pub(super) struct Leaves<'a> {
    organs: &'a Organs,
    forms: LevelForms,
    triangles: Vec<u32>,
    total: u64,
}

/// Which leaves are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// All that there are.
    All,
    /// Those that branch cards may show.
    OnCards,
    /// Those that stay leaves beside branch cards.
    BesideCards,
}

/// Up to which share an organ is left out. Neighbours along a twig are neighbours by index; their ranks
/// are far apart, so that every share takes leaves evenly from everywhere.
fn rank(organ: usize) -> f64 {
    (organ as f64 * GOLDEN).fract()
}

impl<'a> Leaves<'a> {
    pub fn new(organs: &'a Organs, forms: LevelForms, monitor: &dyn Monitor) -> Result<Self, DetailError> {
        let tasks = organs.len().div_ceil(PER_TASK);
        let shaped = Organs { shapes: Arc::clone(forms.shapes()), ..Organs::default() };
        let counted = (0..tasks).into_par_iter().map(|task| {
            monitor.check()?;
            let mut shaper = Shaper::default();
            let mut mesh = Mesh::default();
            let range = task * PER_TASK..organs.len().min((task + 1) * PER_TASK);
            Ok(range
                .map(|organ| {
                    if let Some(placed) = organ.checked_sub(organs.polygons.ends.len()) {
                        let prototype = organs.placed.prototypes[placed];
                        return shaped.prototype_mesh(prototype).triangles.len() as u32;
                    }
                    mesh.triangles.clear();
                    mesh.positions.clear();
                    mesh.normals.clear();
                    mesh.uvs.clear();
                    shaper.add(organs, organ, &mut mesh);
                    mesh.triangles.len() as u32
                })
                .collect())
        });
        let triangles = counted.collect::<Result<Vec<Vec<u32>>, Cancelled>>()?.concat();
        let total = triangles.iter().map(|&count| u64::from(count)).sum();
        Ok(Self { organs, forms, triangles, total })
    }

    pub const fn forms(&self) -> &LevelForms {
        &self.forms
    }

    fn is_meant(&self, organ: usize, which: Which) -> bool {
        match which {
            Which::All => true,
            Which::OnCards => self.forms.may_be_on_cards(self.organs, organ),
            Which::BesideCards => !self.forms.may_be_on_cards(self.organs, organ),
        }
    }

    /// Up to which share an organ is left out, by the weight of its kind.
    fn rank(&self, organ: usize) -> f64 {
        let weight = self.forms.weight(self.organs, organ);
        if weight > 0.0 { rank(organ) / weight } else { f64::INFINITY }
    }

    /// Triangles of leaves, and the same by the weights of their kinds.
    pub fn total(&self, which: Which) -> (u64, f64) {
        if which == Which::BesideCards && self.forms.are_all_on_cards() {
            return (0, 0.0);
        }
        let meant = (0..self.triangles.len()).filter(|&organ| self.is_meant(organ, which));
        meant.fold((0, 0.0), |(sum, weighed), organ| {
            let count = self.triangles[organ];
            (sum + u64::from(count), weighed + f64::from(count) * self.forms.weight(self.organs, organ))
        })
    }

    /// Triangles of all leaves.
    pub const fn all(&self) -> u64 {
        self.total
    }

    /// Triangles of a share of leaves.
    pub fn triangles(&self, share: f64, which: Which) -> u64 {
        match which {
            Which::All if share >= 1.0 => return self.total,
            Which::BesideCards if self.forms.are_all_on_cards() => return 0,
            _ => {}
        }
        let meant = (0..self.triangles.len()).filter(|&organ| self.is_meant(organ, which));
        let kept = meant.filter(|&organ| share >= 1.0 || self.rank(organ) < share);
        kept.map(|organ| u64::from(self.triangles[organ])).sum()
    }

    /// The largest share with no more than `triangles`, exact to a leaf.
    pub fn share_within(&self, triangles: u64, which: Which) -> f64 {
        if which == Which::All && triangles >= self.total {
            return 1.0;
        }
        let meant = (0..self.triangles.len()).filter(|&organ| self.is_meant(organ, which));
        let mut ranked: Vec<(f64, u32)> =
            meant.map(|organ| (self.rank(organ), self.triangles[organ])).collect();
        ranked.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut sum = 0;
        for &(rank, count) in &ranked {
            sum += u64::from(count);
            if sum > triangles {
                // Everything of a lower rank stays. What has no rank goes before all others.
                return rank.min(BELOW_ALL);
            }
        }
        1.0
    }

    /// The fewest that there can be: one leaf, where there are any.
    pub fn least(&self) -> u64 {
        self.triangles.iter().find(|&&count| count > 0).map_or(0, |&count| count.into())
    }

    /// The organs that stay, of a level in cards those beside these.
    pub fn thinned(&self, detail: &Detail) -> Organs {
        let which = if detail.card_m > 0.0 { Which::BesideCards } else { Which::All };
        let share = detail.leaf_share;
        let stays = |organ: usize| self.is_meant(organ, which) && (share >= 1.0 || self.rank(organ) < share);
        let scale = |organ: usize| scale_of(share * self.forms.weight(self.organs, organ));
        let mut organs = match which {
            Which::BesideCards if self.forms.are_all_on_cards() => Organs::default(),
            Which::All if share >= 1.0 => self.organs.clone(),
            _ if share >= 1.0 => selected(self.organs, stays, |_| 1.0),
            _ => selected(self.organs, stays, scale),
        };
        organs.shapes = Arc::clone(self.forms.shapes());
        organs
    }
}

/// Leaves grow no larger than this: beyond it crowns look like balloons.
const LARGEST: f64 = 2.0;

/// How much larger the leaves are that stay of a share: as much as keeps the area of all, up to twice as long.
fn scale_of(share: f64) -> f32 {
    (1.0 / share.max(f64::MIN_POSITIVE)).sqrt().clamp(1.0, LARGEST) as f32
}

/// The largest share that leaves anything out.
const BELOW_ALL: f64 = 1.0 - f64::EPSILON;

/// Some of the organs, each larger: round the place where they are attached.
pub(super) fn selected(all: &Organs, stays: impl Fn(usize) -> bool, scale: impl Fn(usize) -> f32) -> Organs {
    let mut some = Organs { shapes: Arc::clone(&all.shapes), ..Organs::default() };
    let (polygons, new) = (&all.polygons, &mut some.polygons);
    for polygon in (0..polygons.ends.len()).filter(|&polygon| stays(polygon)) {
        let corners = all.corners_of(polygon);
        // An outline begins where it is attached.
        let foot = corners.first().copied().unwrap_or_default();
        let scale = scale(polygon);
        new.corners.extend(corners.iter().map(|&corner| foot + (corner - foot) * scale));
        new.ends.push(new.corners.len() as u32);
        new.headings.push(polygons.headings[polygon]);
        new.ups.push(polygons.ups[polygon]);
        push(&mut new.growth, &polygons.growth, polygon);
    }
    let (placed, new) = (&all.placed, &mut some.placed);
    let before = all.polygons.ends.len();
    for organ in (0..placed.prototypes.len()).filter(|&organ| stays(before + organ)) {
        new.prototypes.push(placed.prototypes[organ]);
        new.positions.push(placed.positions[organ]);
        new.headings.push(placed.headings[organ]);
        new.ups.push(placed.ups[organ]);
        new.sizes_m.push(placed.sizes_m[organ] * scale(before + organ));
        push(&mut new.growth, &placed.growth, organ);
    }
    some
}

fn push(to: &mut OrganOrigins, from: &OrganOrigins, organ: usize) {
    to.nodes.push(from.nodes[organ]);
    to.colors.push(from.colors[organ]);
    to.births.push(from.births[organ]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use linden_base::monitor::Quiet;
    use linden_skeleton::organs::{PlacedOrgans, prototype};

    /// Leaves in a row, of two kinds.
    fn row(count: u32) -> Organs {
        let kinds = ['L', 'N'].map(|letter| prototype(letter).unwrap());
        let placed = PlacedOrgans {
            prototypes: (0..count).map(|i| kinds[i as usize % 2]).collect(),
            positions: (0..count).map(|i| Vec3::X * i as f32).collect(),
            headings: vec![Vec3::Y; count as usize],
            ups: vec![Vec3::Z; count as usize],
            sizes_m: vec![0.1; count as usize],
            growth: OrganOrigins {
                nodes: (0..count).collect(),
                colors: vec![0; count as usize],
                births: vec![0; count as usize],
            },
        };
        Organs { placed, ..Organs::default() }
    }

    fn with(share: f64) -> Detail {
        Detail { leaf_share: share, ..Detail::full(&crate::surface::Tubes::default()) }
    }

    #[test]
    fn the_leaves_of_a_coarser_level_are_among_those_of_every_finer_one() {
        let organs = row(5000);
        let leaves = Leaves::new(&organs, LevelForms::plain(&organs), &Quiet).unwrap();
        let mut before: Vec<u32> = (0..5000).collect();
        for share in [0.9, 0.5, 0.49, 0.2, 0.05, 0.01] {
            let thin = leaves.thinned(&with(share));
            let kept = &thin.placed.growth.nodes;
            assert!(kept.iter().all(|node| before.contains(node)), "{share}");
            assert!((kept.len() as f64 / 5000.0 - share).abs() < 0.001, "{share}: {}", kept.len());
            // Evenly: nowhere along the row are they missing for long.
            let longest = kept.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap();
            assert!(f64::from(longest) < 3.0 / share, "{share}: a gap of {longest}");
            before.clone_from(kept);
        }
    }

    #[test]
    fn fewer_leaves_are_larger_up_to_twice() {
        let organs = row(1000);
        let leaves = Leaves::new(&organs, LevelForms::plain(&organs), &Quiet).unwrap();
        for (share, scale) in [(1.0, 1.0), (0.64, 1.25), (0.25, 2.0), (0.01, 2.0)] {
            let thin = leaves.thinned(&with(share));
            assert!((thin.placed.sizes_m[0] / 0.1 - scale).abs() < 1e-6, "{share}");
            assert_eq!(thin.placed.positions[0], organs.placed.positions[0], "attached where it was");
        }
    }

    #[test]
    fn a_budget_of_leaves_is_met_to_a_leaf() {
        let organs = row(3000);
        let leaves = Leaves::new(&organs, LevelForms::plain(&organs), &Quiet).unwrap();
        let largest = leaves.triangles.iter().copied().max().unwrap();
        for budget in [0, 1, 10, 999, 5000, leaves.all() - 1, leaves.all(), u64::MAX] {
            let share = leaves.share_within(budget, Which::All);
            let found = leaves.triangles(share, Which::All);
            assert!(found <= budget);
            assert!(found + u64::from(largest) > budget.min(leaves.all()), "{budget}: {found}");
            let thin = leaves.thinned(&with(share));
            let made = crate::foliage::meshes(&thin, 1, &Quiet).unwrap();
            assert_eq!(made.iter().map(|foliage| foliage.mesh.triangles.len() as u64).sum::<u64>(), found);
        }
    }
}
