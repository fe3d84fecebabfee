//! From a number of triangles to the detail that has as many.

use super::cards::TRIANGLES;
use super::leaves::Which;
use super::{Detail, DetailError, Simplifier};
use crate::settings::BarkSettings;
use crate::surface::Tubes;
use linden_base::monitor::Monitor;

/// Wood loses more than leaves do when both get less: `share^WOOD_FIRST` of it stays. From afar a crown
/// is its leaves.
const WOOD_FIRST: f64 = 1.25;

/// Where more of the leaves' triangles are left than this share, leaves are thinned out: some fewer are not missed.
const LEAVES_AS_THEY_ARE: f64 = 0.7;
/// Cards are pieces of several sites, at least here and there: no more than this share of them.
const MOST_SITES: f64 = 0.9;
/// Where less than this share of what is seen of a tree would be left without its twigs, cards show these.
const WOOD_AS_IT_IS: f64 = 0.7;
/// The share of a budget that is for wood beside cards of twigs alone.
const TWIGLESS: f64 = 0.35;
/// The least share of a budget that the wood has beside cards, as far as there is any: with less, limbs that are seen
/// through the crown are left out, and what hangs on them floats in the air (an olive of 5000 triangles).
const LIMBS: f64 = 0.22;
/// What a budget of triangles is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shares {
    /// Triangles of the wood; all others are those of leaves, or of cards.
    pub wood: u64,
    /// Whether branch cards are to stand for leaves and thin wood.
    pub in_cards: bool,
}

/// A tree, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Amount {
    /// Triangles of its wood.
    pub wood: u64,
    /// Triangles of its leaves and other organs.
    pub leaves: u64,
    /// Nodes that bear any of these. There are no more cards than these.
    pub sites: u64,
}

/// How `budget` triangles are spent on a tree, `with_cards` where these may stand for leaves. Whether twigs need cards is
/// decided by [`Simplifier::within`].
pub fn shares(budget: u64, tree: Amount, with_cards: bool) -> Shares {
    let Amount { wood, leaves, sites } = tree;
    let for_wood = share_of_wood(budget, wood, leaves);
    let left = budget.saturating_sub(for_wood);
    // What cards cannot use goes to the wood, as far as there is any.
    let for_cards = left.min(TRIANGLES * (MOST_SITES * sites as f64) as u64);
    let beside_cards = budget.saturating_sub(for_cards);
    let are_many_left = left as f64 >= LEAVES_AS_THEY_ARE * leaves as f64;
    let in_cards = with_cards && !are_many_left && for_cards > 0 && beside_cards < wood;
    let for_limbs = ((LIMBS * budget as f64) as u64).min(wood);
    Shares { wood: if in_cards { beside_cards.max(for_limbs) } else { for_wood }, in_cards }
}

/// How many of `budget` triangles are the wood's beside cards of twigs.
fn beside_twigs(budget: u64) -> u64 {
    (TWIGLESS * budget as f64) as u64
}

/// How many of `budget` triangles are the wood's where leaves are thinned out.
fn share_of_wood(budget: u64, wood: u64, leaves: u64) -> u64 {
    let share = budget as f64 / (wood + leaves).max(1) as f64;
    let for_wood = (libm::pow(share.min(1.0), WOOD_FIRST) * wood as f64) as u64;
    // What leaves cannot use goes to the wood.
    for_wood.max(budget.saturating_sub(leaves)).min(wood)
}

/// From which budget on stems have so many sides at least, where they are stout: what stands beside a person is looked at
/// from near, however much of the budget is in the crown.
const STEM_SIDES: [(u64, u32); 5] = [(15_000, 10), (5000, 8), (1500, 6), (0, 5), (0, 4)];
/// As long as the stems alone are no more than this share of the budget.
const STEMS: f64 = 0.15;
/// A stem counts that is no thinner than this share of the thickest.
const STEM_FROM: f32 = 0.3;
/// Nothing hides roots and buttresses: they are left out below this share of the radius of limbs that are.
const AT_FOOT: f32 = 0.5;
/// But not where they are larger than one of these shares of the thickest radius, the first of which all of them are no
/// more than so much of the budget: a stem that has buttresses in one level has them in the next.
const AT_FOOT_FROM: [f32; 10] = [0.02, 0.06, 0.12, 0.18, 0.24, 0.28, 0.32, 0.36, 0.4, 0.44];
const RIDGES: f64 = 0.07;
const ROOTS: f64 = 0.06;
/// As near as this share of the budget is near enough.
const NEAR: f64 = 0.01;
/// The count is promised to be within this share of the budget.
const PROMISED: f64 = 0.05;
/// Halvings of the scale from all to nothing: it ends at a millionth of it.
const HALVINGS: u32 = 20;
/// From this share of the tree's size on nothing but the stem is left.
const COARSEST: f32 = 1.0;
/// The finest deviation that anybody would see, as a share of the tree's size.
const FINEST: f32 = 1e-6;

/// What a level keeps of its stems and their feet, however coarse it is.
#[derive(Clone, Copy, Debug)]
struct Floor {
    /// See [`Detail::stem_sides`].
    sides: u32,
    /// The most that [`Detail::smallest_ridge_m`] may be.
    ridge_m: f32,
    /// The most that [`Detail::smallest_root_m`] may be.
    root_m: f32,
    /// See [`Detail::foot_edge`].
    foot_edge: bool,
}

impl Floor {
    const NONE: Self = Self { sides: 0, ridge_m: f32::INFINITY, root_m: f32::INFINITY, foot_edge: false };
}

impl Simplifier<'_> {
    /// Triangles of the whole tree.
    ///
    /// # Errors
    /// [`DetailError::Cancelled`].
    pub fn full_triangles(&self, monitor: &dyn Monitor) -> Result<u64, DetailError> {
        self.triangles(&Detail::full(&self.tubes), monitor)
    }

    /// The fewest triangles that the tree can do with: its stem, and a leaf if it has leaves.
    ///
    /// # Errors
    /// [`DetailError::Cancelled`].
    pub fn least_triangles(&self, monitor: &dyn Monitor) -> Result<u64, DetailError> {
        Ok(self.wood_triangles(&self.coarse(1.0, 1, Floor::NONE), monitor)? + self.leaves.least())
    }

    /// Whether what changes where the bark of a foot ends is in a level of so many triangles: small ones have none.
    fn has_foot_edge(&self, budget: u64) -> bool {
        self.tubes.foot_edge().is_none() || budget >= BarkSettings::LEAST_TRIANGLES
    }

    /// What a budget of the whole tree keeps of its stems.
    fn floor(&self, budget: u64, monitor: &dyn Monitor) -> Result<Floor, DetailError> {
        let stems = self.wood.stems(STEM_FROM) as f64;
        let cost = |floor| {
            let triangles = self.wood_triangles(&self.coarse(1.0, 1, floor), monitor)?;
            Ok::<_, DetailError>(triangles as f64 * stems)
        };
        let mut floor = Floor { foot_edge: self.has_foot_edge(budget), ..Floor::NONE };
        for (_, sides) in STEM_SIDES.into_iter().filter(|(from, _)| budget >= *from) {
            let kept = Floor { sides: sides.min(self.tubes.sides), ..floor };
            if cost(kept)? <= STEMS * budget as f64 {
                floor = kept;
                break;
            }
        }
        let thickest_m = self.wood.thickest_m();
        let with_ridges = |floor, ridge_m| Floor { ridge_m, ..floor };
        let with_roots = |floor, root_m| Floor { root_m, ..floor };
        for (with, most) in [(with_ridges as fn(Floor, f32) -> Floor, RIDGES), (with_roots, ROOTS)] {
            let before = cost(floor)?;
            for share in AT_FOOT_FROM {
                let kept = with(floor, share * thickest_m);
                if cost(kept)? - before <= most * budget as f64 {
                    floor = kept;
                    break;
                }
            }
        }
        Ok(floor)
    }

    /// The detail with `budget` triangles, or all where the tree has no more.
    ///
    /// Wood and leaves share the budget; `with_cards`, branch cards stand for leaves and twigs where many would be left
    /// out. The count is within 5 % of it for every tree of more than a few
    /// tubes (a tube alone changes by whole rings and sides); with leaves it is exact to one of them.
    ///
    /// # Errors
    /// [`DetailError::TooFew`] below [`Self::least_triangles`]; [`DetailError::Cancelled`].
    pub fn within(
        &self,
        budget: u64,
        with_cards: bool,
        monitor: &dyn Monitor,
    ) -> Result<Detail, DetailError> {
        let all = Detail { foot_edge: self.has_foot_edge(budget), ..Detail::full(&self.tubes) };
        let wood = self.wood_triangles(&all, monitor)?;
        let leaves = self.leaves.all();
        let is_whole = wood + leaves <= budget;
        if is_whole && !(with_cards && self.leaves.forms().wants_cards) {
            return Ok(all);
        }
        let least = self.least_triangles(monitor)?;
        if budget < least {
            return Err(DetailError::TooFew { budget, least });
        }
        let floor = self.floor(budget, monitor)?;
        if with_cards && let Some(detail) = self.in_cards(budget, [wood, leaves], floor, monitor)? {
            return Ok(detail);
        }
        if is_whole {
            return Ok(all);
        }
        let thinned = self.thinned_within(budget, [wood, leaves], floor, monitor)?;
        let are_missed = with_cards && self.silhouette.share_with(&self.wood, &thinned) < WOOD_AS_IT_IS;
        let in_cards = if are_missed { self.twigs_in_cards(budget, wood, floor, monitor)? } else { None };
        Ok(in_cards.unwrap_or(thinned))
    }

    /// The detail with `budget` triangles and no cards.
    fn thinned_within(
        &self,
        budget: u64,
        [wood, leaves]: [u64; 2],
        floor: Floor,
        monitor: &dyn Monitor,
    ) -> Result<Detail, DetailError> {
        // Each needs its least.
        let most = budget - self.leaves.least();
        let for_wood = share_of_wood(budget, wood, leaves).max(self.least_wood(floor, monitor)?).min(most);
        let mut detail = self.wood_within(for_wood, floor, monitor)?;
        let used = self.wood_triangles(&detail, monitor)?;
        detail.leaf_share = self.leaves.share_within(budget.saturating_sub(used), Which::All);
        Ok(detail)
    }

    /// Whether branch cards would stand for leaves or twigs within this budget.
    ///
    /// # Errors
    /// As [`Self::within`].
    pub fn is_in_cards(&self, budget: u64, monitor: &dyn Monitor) -> Result<bool, DetailError> {
        Ok(self.within(budget, true, monitor)?.card_m > 0.0)
    }

    /// The detail with `budget` triangles and branch cards; `None` where these are not wanted, or cannot meet it.
    fn in_cards(
        &self,
        budget: u64,
        [wood, leaves]: [u64; 2],
        floor: Floor,
        monitor: &dyn Monitor,
    ) -> Result<Option<Detail>, DetailError> {
        let forms = self.leaves.forms();
        let leaf_share = self.share_beside_cards(budget.saturating_sub(share_of_wood(budget, wood, leaves)));
        let beside = self.leaves.triangles(leaf_share, Which::BesideCards);
        let (on_cards, _) = self.leaves.total(Which::OnCards);
        let left = budget.saturating_sub(beside);
        let shares = shares(left, Amount { wood, leaves: on_cards, sites: self.sites() }, true);
        if on_cards == 0 || !(shares.in_cards || forms.wants_cards) {
            return Ok(None);
        }
        // What stems keep is not taken from the limbs.
        let least_wood = self.least_wood(floor, monitor)?;
        let kept = least_wood.saturating_sub(self.least_wood(Floor::NONE, monitor)?);
        let most_wood = if self.silhouette.is_mostly_wood() { beside_twigs(left) } else { u64::MAX };
        let for_wood = (shares.wood.min(most_wood) + kept).min(wood).clamp(least_wood, left.max(least_wood));
        let detail = Detail { leaf_share, ..self.wood_within(for_wood, floor, monitor)? };
        let (detail, found) = self.filled_up(&detail, budget, monitor)?;
        let is_met = forms.wants_cards || within(PROMISED, found, budget);
        Ok((detail.card_m > 0.0 && is_met).then_some(detail))
    }

    /// The detail with `budget` triangles and cards of twigs, with what grows on them; `None` where cards cannot meet it.
    fn twigs_in_cards(
        &self,
        budget: u64,
        wood: u64,
        floor: Floor,
        monitor: &dyn Monitor,
    ) -> Result<Option<Detail>, DetailError> {
        let leaf_share =
            self.share_beside_cards(budget.saturating_sub(share_of_wood(budget, wood, self.leaves.all())));
        let left = budget.saturating_sub(self.leaves.triangles(leaf_share, Which::BesideCards));
        let for_wood = beside_twigs(left).max(self.least_wood(floor, monitor)?).min(left);
        let detail = Detail { leaf_share, ..self.wood_within(for_wood, floor, monitor)? };
        let (detail, found) = self.filled_up(&detail, budget, monitor)?;
        Ok((detail.card_m > 0.0 && within(PROMISED, found, budget)).then_some(detail))
    }

    /// The same wood, and leaves beside cards, with as many cards as a budget has room for, none where it has none for any;
    /// and how many triangles that is.
    fn filled_up(
        &self,
        detail: &Detail,
        budget: u64,
        monitor: &dyn Monitor,
    ) -> Result<(Detail, u64), DetailError> {
        let beside = self.leaves.triangles(detail.leaf_share, Which::BesideCards);
        let used = self.wood_triangles(detail, monitor)? + beside;
        let rest = budget.saturating_sub(used);
        let burden = self.burden(detail);
        let size_m = self.size_of_pieces(&burden, rest / TRIANGLES, monitor)?;
        let cards = TRIANGLES * burden.count(size_m, monitor)? as u64;
        let card_m = if (1..=rest).contains(&cards) { size_m } else { 0.0 };
        Ok((Detail { card_m, ..*detail }, used + cards))
    }

    /// A level of the fullest season as this tree has it, that is bare or nearly: the same wood, and cards that use what
    /// leaves do not.
    pub(super) fn with_twigs(
        &self,
        fullest: &Detail,
        budget: u64,
        monitor: &dyn Monitor,
    ) -> Result<Detail, DetailError> {
        // Where leaves are as they are, these leave room for cards, or the wood is all that there is.
        let is_room_for_cards = || {
            let has_room = 2 * self.wood_triangles(fullest, monitor)? <= budget;
            Ok::<_, DetailError>(has_room && self.silhouette.share_with(&self.wood, fullest) < WOOD_AS_IT_IS)
        };
        if !self.silhouette.is_mostly_wood() || !(fullest.card_m > 0.0 || is_room_for_cards()?) {
            return Ok(*fullest);
        }
        let (detail, _) = self.filled_up(fullest, budget, monitor)?;
        Ok(if detail.card_m > 0.0 { detail } else { *fullest })
    }

    /// The share of the leaves beside cards: they get of what all leaves may have what they are of these by weight.
    fn share_beside_cards(&self, for_leaves: u64) -> f64 {
        let (beside, weight) = self.leaves.total(Which::BesideCards);
        if beside == 0 {
            return 1.0;
        }
        let (_, others) = self.leaves.total(Which::OnCards);
        let part = weight / (weight + others).max(f64::MIN_POSITIVE);
        self.leaves.share_within((for_leaves as f64 * part) as u64, Which::BesideCards)
    }

    /// How many nodes bear what goes on cards.
    fn sites(&self) -> u64 {
        if self.leaves.forms().are_all_on_cards() {
            return self.organs.sites();
        }
        let mut nodes: Vec<u32> = (0..self.organs.len())
            .filter(|&organ| self.leaves.forms().may_be_on_cards(self.organs, organ))
            .map(|organ| self.organs.growth(organ).node)
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.len() as u64
    }

    /// The stem alone.
    fn least_wood(&self, floor: Floor, monitor: &dyn Monitor) -> Result<u64, DetailError> {
        self.wood_triangles(&self.coarse(1.0, 1, floor), monitor)
    }

    /// All deviations of the wood from one number: 0 is all of it, 1 the stem alone.
    fn coarse(&self, scale: f32, rings: u32, floor: Floor) -> Detail {
        let Tubes { sides, .. } = self.tubes;
        if scale <= 0.0 {
            return Detail { rings, foot_edge: floor.foot_edge, ..Detail::full(&self.tubes) };
        }
        let size_m = self.wood.size_m();
        // Evenly in the logarithm: as much as a viewer sees who goes away step by step.
        let error_m = size_m * FINEST * libm::powf(COARSEST / FINEST, scale);
        // A polygon of n sides is r (1 - cos π/n) from its circle.
        let radius_m = self.wood.thickest_m().max(f32::MIN_POSITIVE);
        let sagitta = 1.0 - libm::cosf(std::f32::consts::PI / sides as f32) + error_m / radius_m;
        let enough = std::f32::consts::PI / libm::acosf((1.0 - sagitta).max(-1.0));
        let smallest_radius_m = SMALLEST * error_m;
        Detail {
            // Limbs have sides in proportion.
            sides: (enough as u32).max(floor.sides).clamp(3, sides),
            stem_sides: floor.sides,
            rings,
            tolerance_m: TOLERANCE * error_m,
            smallest_radius_m,
            smallest_ridge_m: (AT_FOOT * smallest_radius_m).min(floor.ridge_m),
            smallest_root_m: (AT_FOOT * smallest_radius_m).min(floor.root_m),
            foot_edge: floor.foot_edge,
            leaf_share: 1.0,
            card_m: 0.0,
        }
    }

    /// The wood with about `budget` triangles, rather fewer than more.
    fn wood_within(&self, budget: u64, floor: Floor, monitor: &dyn Monitor) -> Result<Detail, DetailError> {
        // The fewest rings between nodes that leave something to be taken away.
        let mut rings = self.tubes.rings;
        while rings > 1 && self.wood_triangles(&self.coarse(0.0, rings - 1, floor), monitor)? >= budget {
            rings -= 1;
        }
        let whole = self.coarse(0.0, rings, floor);
        if self.wood_triangles(&whole, monitor)? <= budget {
            return Ok(whole);
        }
        let (over, under) =
            self.bracket(budget, whole, (0.0, 1.0), |scale| self.coarse(scale, rings, floor), monitor)?;
        if under.triangles > budget {
            return Ok(self.coarse(1.0, 1, floor));
        }
        if near(under.triangles, budget) {
            return Ok(under.detail);
        }
        // A jump: there many rings lose a side at once. With the sides from before it, nodes and axes go
        // one by one.
        let finer = |scale| Detail { sides: over.detail.sides, ..self.coarse(scale, rings, floor) };
        let (mut over, mut under) = self.bracket(budget, over.detail, (over.scale, 1.0), finer, monitor)?;
        if !within(PROMISED, under.triangles, budget) {
            // A limb goes with all that it bears. With all limbs from before it, only their nodes do.
            let Detail { sides, smallest_radius_m, .. } = over.detail;
            let finer = |scale| Detail { sides, smallest_radius_m, ..self.coarse(scale, rings, floor) };
            let (finer, coarser) = self.bracket(budget, over.detail, (over.scale, 1.0), finer, monitor)?;
            if coarser.triangles <= budget && coarser.triangles > under.triangles {
                (over, under) = (finer, coarser);
            }
        }
        let nearer = over.triangles - budget < budget.abs_diff(under.triangles);
        Ok(if nearer && self.leaves.all() == 0 { over.detail } else { under.detail })
    }

    /// Two neighbours on a path of details, between which the budget lies: `first`, at the path's
    /// begin, has more triangles than that.
    fn bracket(
        &self,
        budget: u64,
        first: Detail,
        (mut fine, mut coarse): (f32, f32),
        path: impl Fn(f32) -> Detail,
        monitor: &dyn Monitor,
    ) -> Result<(Found, Found), DetailError> {
        let found = |scale, detail: Detail| {
            let triangles = self.wood_triangles(&detail, monitor)?;
            Ok::<_, DetailError>(Found { scale, detail, triangles })
        };
        let mut over = found(fine, first)?;
        let mut under = found(coarse, path(coarse))?;
        for _ in 0..HALVINGS {
            if near(under.triangles, budget) {
                break;
            }
            let middle = f32::midpoint(fine, coarse);
            let next = found(middle, path(middle))?;
            if next.triangles > budget {
                (fine, over) = (middle, next);
            } else {
                (coarse, under) = (middle, next);
            }
        }
        Ok((over, under))
    }
}

/// A place on a path of details.
struct Found {
    scale: f32,
    detail: Detail,
    triangles: u64,
}

fn near(triangles: u64, budget: u64) -> bool {
    within(NEAR, triangles, budget)
}

fn within(share: f64, triangles: u64, budget: u64) -> bool {
    budget.abs_diff(triangles) as f64 <= share * budget as f64
}

/// How far an axis may move, in deviations of the bark.
const TOLERANCE: f32 = 3.0;
/// The thickest wood that is left out, in deviations of the bark.
const SMALLEST: f32 = 1.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;
    use linden_pipeline::preset::{Builtin, builtins};

    #[test]
    fn every_budget_is_met_by_every_tree() {
        let mut checked = 0;
        // Every second budget of each, by turns. Plants are large: one in seven, with a single one.
        let (plants, plain): (Vec<&Builtin>, Vec<&Builtin>) = builtins()
            .iter()
            .partition(|builtin| builtin.load().is_ok_and(|preset| preset.group == "Plants"));
        let turns = [[0.9, 0.3, 0.03], [0.5, 0.1, 0.01]];
        let plain = plain.into_iter().zip(turns.iter().cycle()).map(|(builtin, turn)| (builtin, &turn[..]));
        let plants = plants.into_iter().step_by(7).map(|builtin| (builtin, &turns[1][1..2]));
        for (builtin, shares) in plain.chain(plants) {
            let subject = Subject::of(builtin.recipe(&Quiet).unwrap());
            let grown = subject.grow();
            let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
            let full = simplifier.full_triangles(&Quiet).unwrap();
            for share in shares {
                let budget = (full as f64 * share) as u64;
                // A handful of tubes changes by whole rings.
                if budget < 300 {
                    continue;
                }
                let detail = simplifier.within(budget, true, &Quiet).unwrap();
                let found = simplifier.triangles(&detail, &Quiet).unwrap();
                let off = found as f64 / budget as f64 - 1.0;
                assert!(off.abs() <= 0.05, "{} {budget}: {found} ({detail:?})", builtin.id);
                checked += 1;
            }
        }
        assert!(checked > 60, "{checked}");
    }

    /// Thinned out, an oak of 4000 triangles in winter was half as high, and a bare tree of a grammar covered a third.
    #[test]
    fn twigs_go_on_cards_where_many_of_a_bare_tree_would_be_left_out() {
        for (id, knobs) in [
            ("abop-ternary-b", [].as_slice()),
            ("hazel", &[("season", "1")]),
            ("hazel", &[("season", "0.98")]),
        ] {
            let subject = Subject::builtin(id, knobs);
            let grown = subject.grow();
            let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
            let full = simplifier.full_triangles(&Quiet).unwrap();
            let share = |detail: &Detail| simplifier.silhouette.share_with(&simplifier.wood, detail);
            let detail = simplifier.within(4000, true, &Quiet).unwrap();
            let found = simplifier.triangles(&detail, &Quiet).unwrap();
            assert!(
                detail.card_m > 0.0 && (3800..=4000).contains(&found),
                "{id} {knobs:?}: {found} {detail:?}"
            );
            let thinned = simplifier.within(4000, false, &Quiet).unwrap();
            assert!(thinned.card_m == 0.0 && share(&thinned) < WOOD_AS_IT_IS, "{id} {knobs:?}");
            let fine = simplifier.within(full * 9 / 10, true, &Quiet).unwrap();
            assert!(fine.card_m == 0.0 && share(&fine) > WOOD_AS_IT_IS, "{id} {knobs:?}: {fine:?}");
        }
    }

    #[test]
    fn beside_cards_wood_has_its_least_share() {
        let tree = |wood| Amount { wood, leaves: 500_000, sites: 100_000 };
        let wood_of = |wood| {
            let shares = shares(5000, tree(wood), true);
            assert!(shares.in_cards);
            shares.wood
        };
        assert_eq!(wood_of(100_000), 1100, "22 %");
        assert_eq!(wood_of(900), 900, "no more than there is");
        assert!(
            shares(5000, tree(100_000), false).wood < 1100,
            "leaves that are thinned out take what they need"
        );
    }

    /// From where a forest is seen, a tree of a game has some hundreds.
    #[test]
    fn the_largest_plants_can_be_had_in_500_triangles() {
        for id in ["oak", "norway-spruce"] {
            let subject = Subject::builtin(id, &[]);
            let grown = subject.grow();
            let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
            let detail = simplifier.within(500, true, &Quiet).unwrap();
            let found = simplifier.triangles(&detail, &Quiet).unwrap();
            assert!((475..=525).contains(&found) && detail.card_m > 0.0, "{id}: {found} {detail:?}");
        }
    }

    #[test]
    fn the_least_is_met_and_less_is_refused() {
        let subject = Subject::builtin("fir", &[]);
        let grown = subject.grow();
        let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
        let least = simplifier.least_triangles(&Quiet).unwrap();
        assert!((10..200).contains(&least), "{least}");
        let detail = simplifier.within(least, true, &Quiet).unwrap();
        assert_eq!(simplifier.triangles(&detail, &Quiet).unwrap(), least);
        let said = simplifier.within(least - 1, true, &Quiet).unwrap_err().to_string();
        assert!(
            said.contains(&format!("triangles={}", least - 1)) && said.contains(&format!("{least} ")),
            "{said}"
        );
        let full = simplifier.full_triangles(&Quiet).unwrap();
        for budget in [full, full + 1, u64::MAX] {
            assert_eq!(
                simplifier.within(budget, true, &Quiet).unwrap(),
                Detail::full(&subject.dressing.tubes)
            );
        }
    }
}
