//! Branches that get too little light are shed.

use linden_skeleton::NO_PARENT;

use crate::SelfOrganizing;
use crate::gap::Lone;
use crate::light::FULL_LIGHT;
use crate::sums::Sums;
use crate::tree::{APEX, DEAD, LATERAL, Nodes, SHED};

/// The least light of a tree in a stand for each of its internodes ÷ that of a branch. A stem bears the bare wood of its
/// bole: old oaks in the open have about as little as a branch may have, the last trees below a canopy a quarter of it.
const OF_A_TREE: f64 = 0.5;

/// What a year took.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lost {
    /// Nodes that are marked [`SHED`].
    pub nodes: usize,
    /// Those, and what died, that had leaves and buds until now; without feet.
    pub leafless: Vec<u32>,
}

/// Marks the branches that are shed this year, [`SHED`], and those that die and stay, [`DEAD`].
///
/// A branch goes when for [`SelfOrganizing::shed_patience`] years in a row, and after its grace, the light of its
/// buds ÷ its internodes was below [`SelfOrganizing::shed`] (Pałubicki et al. 2009, section 4.5). It is judged by the
/// light at the beginning of the year; its buds do not grow in the year in which it goes, and what they would have
/// got is lost. Its tips stay in the pipes of the node that bore it.
///
/// With [`SelfOrganizing::dead_years`] it dies first, and is shed so many years later; what it bears, after half of them.
///
/// Where several trees stand, one dies, its foot included, when it gets no light at all, or for as long less than
/// [`OF_A_TREE`] of what a branch must have. A lone tree stays whatever its light.
///
/// A foot that is marked already takes its tree with it: it is felled.
///
/// A branch that begins below the height of the bole, in internodes, is cut off whatever its light. Of what then is left
/// limbs go that are [`Lone`].
pub(crate) fn shed(nodes: &mut Nodes, sums: &Sums, settings: &SelfOrganizing, year: u32, bole: f32) -> Lost {
    let mut lost = Lost::default();
    let is_felled = |node| nodes.is_foot(node) && nodes.is(node, SHED);
    if settings.shed == 0.0 && bole == 0.0 && settings.crown_gap_m == 0.0 && !(0..nodes.len()).any(is_felled)
    {
        return lost;
    }
    let is_stand = nodes.parents.iter().filter(|&&parent| parent == NO_PARENT).nth(1).is_some();
    let mut pipes = Vec::new();
    for node in 0..nodes.len() {
        if nodes.is_foot(node) {
            let least = OF_A_TREE * settings.shed;
            let is_dark = || sums.total(node) == 0 && settings.shed > 0.0;
            if nodes.is(node, SHED)
                || is_stand && (is_dark() || is_too_dark(nodes, node, sums, settings, least, year))
            {
                nodes.flags[node] |= SHED;
                lost.nodes += 1;
            }
            continue;
        }
        let fate = fate(nodes, node, sums, settings, year, bole);
        lost.take(nodes, node, fate, &mut pipes);
    }
    let lone = Lone::of(nodes, settings);
    if !lone.is_empty() {
        for node in 0..nodes.len() {
            let fate = fate_of_lone(nodes, node, &lone, settings);
            lost.take(nodes, node, fate, &mut pipes);
        }
    }
    lost
}

impl Lost {
    /// Marks a node whose fate is known. `pipes` are those before anything was shed, worked out when they are needed.
    fn take(&mut self, nodes: &mut Nodes, node: usize, fate: Fate, pipes: &mut Vec<u32>) {
        let was_dead = nodes.is(node, DEAD);
        match fate {
            Fate::Stays => return,
            Fate::Dies => {
                nodes.flags[node] = nodes.flags[node] & !APEX | DEAD;
                nodes.buds[node] = 0;
                nodes.dark_years[node] = 0;
            }
            Fate::Goes => {
                let parent = nodes.parents[node] as usize;
                if !nodes.is(parent, SHED) {
                    if pipes.is_empty() {
                        *pipes = nodes.pipes();
                    }
                    nodes.shed_tips[parent] = nodes.shed_tips[parent].saturating_add(pipes[node]);
                }
                nodes.flags[node] |= SHED;
                self.nodes += 1;
            }
        }
        if !was_dead {
            self.leafless.push(node as u32);
        }
    }
}

/// What becomes of a node in a year.
#[derive(Clone, Copy)]
enum Fate {
    /// As it was: alive or dead.
    Stays,
    Dies,
    Goes,
}

/// What becomes of a node above a foot, after that of its parent.
fn fate(
    nodes: &mut Nodes,
    node: usize,
    sums: &Sums,
    settings: &SelfOrganizing,
    year: u32,
    bole: f32,
) -> Fate {
    let (parent, is_dead) = (nodes.parents[node] as usize, nodes.is(node, DEAD));
    let is_borne_by_dead = nodes.is(parent, DEAD);
    if nodes.is(parent, SHED) {
        return Fate::Goes;
    }
    if !nodes.is(node, LATERAL) {
        return if is_borne_by_dead && !is_dead { Fate::Dies } else { Fate::Stays };
    }
    if nodes.orders[node] > 0 && nodes.places[parent].y < bole {
        return Fate::Goes;
    }
    if is_dead {
        let years = settings.dead_years;
        let most = if is_borne_by_dead { years.div_ceil(2) } else { years };
        nodes.dark_years[node] += 1;
        return if u32::from(nodes.dark_years[node]) >= most { Fate::Goes } else { Fate::Stays };
    }
    if is_borne_by_dead {
        return Fate::Dies;
    }
    match is_too_dark(nodes, node, sums, settings, settings.shed, year) {
        false => Fate::Stays,
        true if settings.dead_years == 0 => Fate::Goes,
        true => Fate::Dies,
    }
}

/// What becomes of a node once light has taken its share: it goes or dies with its lone limb, or stays.
fn fate_of_lone(nodes: &Nodes, node: usize, lone: &Lone, settings: &SelfOrganizing) -> Fate {
    let (is_dead, is_shed) = (nodes.is(node, DEAD), nodes.is(node, SHED));
    if nodes.is_foot(node) || is_shed {
        return Fate::Stays;
    }
    let parent = nodes.parents[node] as usize;
    let is_lone = lone.begins_with(node);
    if nodes.is(parent, SHED) || is_lone && settings.dead_years == 0 {
        Fate::Goes
    } else if is_dead || !is_lone && !nodes.is(parent, DEAD) {
        Fate::Stays
    } else {
        Fate::Dies
    }
}

/// Counts the years in which a branch, or a tree by its foot, gets less light than `least` for each of its internodes;
/// whether they were enough.
fn is_too_dark(
    nodes: &mut Nodes,
    node: usize,
    sums: &Sums,
    settings: &SelfOrganizing,
    least: f64,
    year: u32,
) -> bool {
    if settings.shed == 0.0 || year - nodes.year(node) <= settings.shed_grace {
        return false;
    }
    let light = sums.total(node) as f64 / f64::from(FULL_LIGHT);
    // A seedling that did not sprout has none.
    let is_dark = light < least * f64::from(sums.internodes[node].max(1));
    nodes.dark_years[node] = if is_dark { nodes.dark_years[node].saturating_add(1) } else { 0 };
    is_dark && u32::from(nodes.dark_years[node]) >= settings.shed_patience
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grow::Growth;
    use crate::tree::{Node, PARTS};
    use glam::DVec3;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    /// A foot, a node of its stem and, there, a branch of one node that grew in year 1.
    fn branch(settings: &SelfOrganizing) -> Nodes {
        let mut growth = Growth::new(settings);
        growth.plant(DVec3::ZERO, DVec3::Y, DVec3::X, Key::new(1));
        let mut nodes = growth.nodes;
        for (parent, flags) in [(0, 0), (1, LATERAL)] {
            let (place, direction, side, key) = (DVec3::Y, DVec3::Y, DVec3::X, Key::new(2));
            let (birth, order, buds) = (PARTS, 0, 0);
            nodes.push(&Node { parent, place, direction, side, key, birth, order, flags, buds });
        }
        nodes
    }

    /// The year from 1 on in which the branch goes, where its bud gets these parts of full light.
    fn goes(settings: &SelfOrganizing, light: &[f64]) -> Option<u32> {
        let mut nodes = branch(settings);
        (1..).zip(light).find_map(|(year, light)| {
            let light = (light * f64::from(FULL_LIGHT)) as u64;
            let sums = Sums {
                onward: vec![light; 3],
                lateral: vec![0; 3],
                internodes: vec![2, 2, 1],
                ..Sums::default()
            };
            (shed(&mut nodes, &sums, settings, year, 0.0).nodes > 0).then(|| {
                assert!(nodes.is(2, SHED) && !nodes.is(1, SHED));
                assert_eq!(nodes.shed_tips, [0, 1, 0]);
                year
            })
        })
    }

    #[test]
    fn a_branch_goes_after_its_grace_when_it_was_dark_for_years_in_a_row() {
        let settings =
            SelfOrganizing { shed: 0.3, shed_grace: 2, shed_patience: 2, ..SelfOrganizing::default() };
        // Years 1 to 3 are within the grace: it is not counted either.
        assert_eq!(goes(&settings, &[0.1; 9]), Some(5));
        assert_eq!(goes(&settings, &[0.9, 0.9, 0.9, 0.1, 0.4, 0.1, 0.4, 0.1, 0.2]), Some(9));
        assert_eq!(goes(&settings, &[0.31; 9]), None);
        assert_eq!(goes(&SelfOrganizing { shed_patience: 1, ..settings.clone() }, &[0.1; 9]), Some(4));
        assert_eq!(goes(&SelfOrganizing { shed: 0.0, ..settings }, &[0.0; 9]), None);
    }

    #[test]
    fn what_died_stays_for_its_years_and_what_it_bore_for_half_of_them() {
        let settings = SelfOrganizing {
            shed: 0.3,
            shed_grace: 0,
            shed_patience: 1,
            dead_years: 5,
            ..SelfOrganizing::default()
        };
        let mut nodes = branch(&settings);
        // A side twig of the branch, two nodes long.
        for (parent, flags) in [(2, LATERAL), (3, APEX)] {
            let (place, direction, side, key) = (DVec3::Y, DVec3::Y, DVec3::X, Key::new(3));
            let (birth, order, buds) = (PARTS, 1, 0);
            nodes.push(&Node { parent, place, direction, side, key, birth, order, flags, buds });
        }
        let sums = Sums {
            onward: vec![0; 5],
            lateral: vec![0; 5],
            internodes: vec![4, 4, 3, 2, 1],
            ..Sums::default()
        };
        // It gets dark in year 2.
        let lost: Vec<Lost> = (2..8)
            .map(|year| {
                let lost = shed(&mut nodes, &sums, &settings, year, 0.0);
                assert!((2..nodes.len()).all(|node| nodes.is(node, DEAD) && !nodes.is(node, APEX)));
                nodes.compact();
                lost
            })
            .collect();
        assert_eq!(lost[0].leafless, [2, 3, 4]);
        assert!(lost[1..].iter().all(|lost| lost.leafless.is_empty()));
        // Three years later its twig falls, five years later itself.
        assert_eq!(lost.iter().map(|lost| lost.nodes).collect::<Vec<_>>(), [0, 0, 0, 2, 0, 1]);
        assert_eq!((nodes.len(), nodes.shed_tips[1]), (2, 1));
        assert!(!nodes.is(1, DEAD));
    }

    /// Grown with and without dead wood, no living internode differs: dead wood takes no light, and gets none.
    #[test]
    fn dead_wood_changes_nothing_that_lives() {
        for light in [crate::LightModel::Shadow, crate::LightModel::Sky] {
            let grown = |dead_years| {
                let settings =
                    SelfOrganizing { light, shade: 0.15, shed: 0.3, dead_years, ..SelfOrganizing::default() };
                let mut growth = Growth::new(&settings);
                growth.plant(DVec3::new(0.5, 0.0, 0.5), DVec3::Y, DVec3::X, Key::new(3));
                (0..18).for_each(|_| growth.grow_year(&Quiet).unwrap());
                let nodes = &growth.nodes;
                let living: Vec<_> = (0..nodes.len())
                    .filter(|&node| !nodes.is(node, DEAD))
                    .map(|node| nodes.places[node])
                    .collect();
                (living, nodes.len(), nodes.pipes()[0])
            };
            let (living, all, pipes) = grown(0);
            assert_eq!(living.len(), all);
            let (with_dead, more, as_many) = grown(6);
            assert_eq!(living, with_dead);
            assert!(more > all + all / 50, "{more} {all}");
            assert_eq!(pipes, as_many);
            assert!(grown(2).1 < more);
        }
    }

    #[test]
    fn a_dark_tree_dies_in_a_stand_and_stays_where_it_is_alone() {
        let settings =
            SelfOrganizing { shed: 0.3, shed_grace: 2, shed_patience: 2, ..SelfOrganizing::default() };
        // Each foot bears a node; the second tree gets these parts of full light.
        let dies = |trees: u32, light: f64| {
            let mut growth = Growth::new(&settings);
            (0..trees).for_each(|i| growth.plant(DVec3::X * f64::from(i), DVec3::Y, DVec3::X, Key::new(1)));
            let mut nodes = growth.nodes;
            for parent in 0..trees {
                let (place, direction, side, key) = (DVec3::Y, DVec3::Y, DVec3::X, Key::new(2));
                let (birth, order, flags, buds) = (PARTS, 0, 0, 0);
                nodes.push(&Node { parent, place, direction, side, key, birth, order, flags, buds });
            }
            let last = trees as usize - 1;
            let mut onward = vec![u64::from(FULL_LIGHT); nodes.len()];
            onward[last] = (light * f64::from(FULL_LIGHT)) as u64;
            let lateral = vec![0; nodes.len()];
            let sums = Sums { onward, lateral, internodes: vec![1; nodes.len()], ..Sums::default() };
            (1..9).find(|&year| shed(&mut nodes, &sums, &settings, year, 0.0).nodes > 0).inspect(|_| {
                let shed: Vec<usize> = (0..nodes.len()).filter(|&node| nodes.is(node, SHED)).collect();
                assert_eq!(shed, [last, nodes.len() - 1], "the foot and what it bears");
            })
        };
        // Grace counts from year 0, that of the foot; then two dark years.
        assert_eq!([dies(2, 0.0), dies(2, 0.14), dies(2, 0.16)], [Some(1), Some(4), None]);
        assert_eq!([dies(1, 0.0), dies(1, 0.14)], [None, None]);
    }

    #[test]
    fn a_stem_never_gets_thinner() {
        let settings = SelfOrganizing { shed: 0.4, shed_patience: 1, ..SelfOrganizing::default() };
        let mut growth = Growth::new(&settings);
        growth.plant(DVec3::new(0.5, 0.0, 0.5), DVec3::Y, DVec3::X, Key::new(3));
        let mut before = 0;
        for _ in 0..25 {
            growth.grow_year(&Quiet).unwrap();
            let foot = growth.nodes.pipes()[0];
            assert!(foot >= before, "{before} {foot}");
            before = foot;
        }
        assert!(growth.shed > 1000, "{}", growth.shed);
    }
}
