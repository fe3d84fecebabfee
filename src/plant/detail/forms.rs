//! What each kind of organ is in one level of detail: its shapes, whether branch cards may show it, and how long it
//! stays where leaves are left out.

use std::sync::Arc;

use crate::settings::{FoliageSettings, LodForm};
use linden_skeleton::organs::{LeafShape, Organs, PROTOTYPES};

/// The kinds of a plant's organs in one level.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LevelForms {
    /// By [`PlacedOrgans::prototypes`](linden_skeleton::organs::PlacedOrgans::prototypes); what is not there is as a
    /// grammar's organs are.
    standings: Vec<Standing>,
    /// Of a grammar's organs.
    plain: Standing,
    shapes: Arc<[LeafShape]>,
    /// Whether a kind is on branch cards whatever the budget.
    pub wants_cards: bool,
}

/// How a kind is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Standing {
    /// 1 for the kinds that go first.
    weight: f64,
    may_be_on_cards: bool,
}

impl LevelForms {
    /// All kinds as they are, alike.
    pub fn plain(organs: &Organs) -> Self {
        let plain = Standing { weight: 1.0, may_be_on_cards: true };
        Self { standings: Vec::new(), plain, shapes: Arc::clone(&organs.shapes), wants_cards: false }
    }

    /// Those of a level, 0 for the finest.
    pub fn of(foliage: &FoliageSettings, organs: &Organs, level: usize) -> Self {
        let kinds: Vec<(f64, Option<LodForm>)> =
            foliage.kinds().map(|kind| (kind.lod_weight, kind.lod_forms.in_level(level))).collect();
        let is_there = |kind: usize| organs.shapes.iter().any(|shape| usize::from(shape.kind) == kind);
        let of_kinds = (0..kinds.len()).filter(|&kind| is_there(kind)).map(|kind| kinds[kind].0);
        let least = of_kinds.filter(|weight| *weight > 0.0).fold(f64::INFINITY, f64::min);
        let standing = |(weight, form): (f64, Option<LodForm>)| Standing {
            // Where none has any, all are alike.
            weight: if least.is_finite() { weight / least } else { 1.0 },
            may_be_on_cards: !matches!(form, Some(LodForm::Leaves(_))),
        };
        let plain = Self::plain(organs);
        let of_shapes = organs
            .shapes
            .iter()
            .map(|shape| kinds.get(usize::from(shape.kind)).map_or(plain.plain, |kind| standing(*kind)));
        let standings = PROTOTYPES.iter().map(|_| plain.plain).chain(of_shapes).collect();
        let wants_cards =
            (0..kinds.len()).any(|kind| is_there(kind) && kinds[kind].1 == Some(LodForm::BranchCard));
        let forms = Self { standings, shapes: in_level(&organs.shapes, level), wants_cards, ..plain.clone() };
        if forms.changes_nothing(organs) { plain } else { forms }
    }

    /// Whether all kinds are as they are, alike.
    fn changes_nothing(&self, organs: &Organs) -> bool {
        !self.wants_cards
            && Arc::ptr_eq(&self.shapes, &organs.shapes)
            && self.standings.iter().all(|standing| *standing == self.plain)
    }

    /// The shapes of the level.
    pub const fn shapes(&self) -> &Arc<[LeafShape]> {
        &self.shapes
    }

    fn standing(&self, organs: &Organs, organ: usize) -> Standing {
        let placed = organ.checked_sub(organs.polygons.ends.len());
        let prototype = placed.map(|placed| usize::from(organs.placed.prototypes[placed]));
        prototype.and_then(|prototype| self.standings.get(prototype)).copied().unwrap_or(self.plain)
    }

    /// How much longer an organ stays than those of the kinds that go first.
    pub fn weight(&self, organs: &Organs, organ: usize) -> f64 {
        self.standing(organs, organ).weight
    }

    /// Whether branch cards show an organ, where there are any.
    pub fn may_be_on_cards(&self, organs: &Organs, organ: usize) -> bool {
        self.standing(organs, organ).may_be_on_cards
    }

    /// Whether they show all organs.
    pub fn are_all_on_cards(&self) -> bool {
        self.standings.iter().all(|standing| standing.may_be_on_cards)
    }
}

/// The shapes of leaves as a level has them, 0 for the finest.
pub(super) fn in_level(shapes: &Arc<[LeafShape]>, level: usize) -> Arc<[LeafShape]> {
    if shapes.iter().all(|shape| shape.lods.is_empty()) {
        return Arc::clone(shapes);
    }
    let at = |shape: &LeafShape| match shape.lods.get(level).or(shape.lods.last()) {
        Some(mesh) => LeafShape { mesh: mesh.clone(), ..shape.clone() },
        None => shape.clone(),
    };
    shapes.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use crate::detail::{Level, levels};
    use crate::scene::Part;
    use crate::testing::{Subject, body};
    use linden_base::monitor::Quiet;
    use linden_pipeline::grow::Grown;

    const SMALL: [(&str, &str); 4] =
        [("leaf_size", "64"), ("bark_size", "64"), ("card_size", "128"), ("season", "0.4")];

    /// A cherry with fruit, in levels.
    fn cherry(knobs: &[(&str, &str)]) -> (Grown, Vec<Level>) {
        let subject = Subject::builtin("wild-cherry", &[&SMALL[..], knobs].concat());
        let grown = subject.grow();
        let levels = subject.with(|specimen| levels(specimen, body(&grown), &Quiet)).unwrap().levels;
        (grown, levels)
    }

    fn part<'a>(level: &'a Level, name: &str) -> Option<&'a Part> {
        level.scene.parts.iter().find(|part| part.name == name)
    }

    fn triangles(level: &Level, name: &str) -> usize {
        part(level, name).map_or(0, |part| part.mesh.triangles.len())
    }

    fn all(level: &Level) -> usize {
        level.scene.parts.iter().map(|part| part.mesh.triangles.len()).sum()
    }

    #[test]
    fn leaves_have_the_form_of_their_level() {
        let (grown, levels) = cherry(&[("lods", "3"), ("lod_ratio", "0.6"), ("lod_form", "curved card")]);
        let of_kind = |kind: u8| {
            let placed = &grown.organs.placed;
            (0..placed.len())
                .filter(|&i| grown.organs.shape(i).is_some_and(|shape| shape.kind == kind))
                .count()
        };
        assert_eq!(triangles(&levels[0], "leaves"), 12 * of_kind(0));
        // Flat, all of them fit into what the level may have: none is left out, and none is on a card.
        assert_eq!(triangles(&levels[1], "leaves"), 2 * of_kind(0));
        assert!(part(&levels[2], "branches").is_none() && triangles(&levels[2], "leaves") <= 2 * of_kind(0));
        // Fruit was not asked for: it stays as it is.
        assert_eq!(triangles(&levels[1], "leaves_1"), 4 * of_kind(1));
    }

    #[test]
    fn fruit_stays_beside_branch_cards() {
        let budget = ("triangles", "6000");
        let (_, cards) = cherry(&[budget]);
        let (grown, beside) = cherry(&[budget, ("fruit.lod_form", "cross"), ("fruit.lod_weight", "20")]);
        assert!(part(&cards[0], "branches").is_some() && part(&cards[0], "leaves_1").is_none());
        let fruit = part(&beside[0], "leaves_1").unwrap();
        assert!(part(&beside[0], "branches").is_some() && part(&beside[0], "leaves").is_none());
        assert!((5700..=6300).contains(&all(&beside[0])), "{}", all(&beside[0]));
        // Each hangs where one hung before.
        let placed = &grown.organs.placed;
        let there: Vec<_> = (0..placed.len())
            .filter(|&i| grown.organs.shape(i).is_some_and(|shape| shape.kind == 1))
            .map(|i| placed.positions[i])
            .collect();
        for corner in fruit.mesh.positions.iter().step_by(37) {
            let away = there.iter().map(|at| at.distance(*corner)).fold(f32::INFINITY, f32::min);
            assert!(away < 0.2, "{away}");
        }
        // What is said of it is said of the tree.
        assert_eq!(beside[0].scene.organs.len(), grown.organs.len());
    }

    #[test]
    fn a_kind_of_more_weight_stays_longer() {
        let knobs = [("triangles", "60000"), ("branch_cards", "false")];
        let share = |weight: &str| {
            let (_, levels) = cherry(&[&knobs[..], &[("fruit.lod_weight", weight)]].concat());
            let (_, whole) = cherry(&[("lods", "1")]);
            assert!((57_000..=63_000).contains(&all(&levels[0])), "{}", all(&levels[0]));
            ["leaves", "leaves_1"]
                .map(|name| triangles(&levels[0], name) as f64 / triangles(&whole[0], name) as f64)
        };
        let [leaves, fruit] = share("1");
        assert!((fruit / leaves - 1.0).abs() < 0.05, "{leaves} {fruit}");
        let [leaves, fruit] = share("3");
        assert!((fruit / leaves - 3.0).abs() < 0.2, "{leaves} {fruit}");
        let [leaves, fruit] = share("0.5");
        assert!((fruit / leaves - 0.5).abs() < 0.05, "{leaves} {fruit}");
        let [_, fruit] = share("0");
        assert!(fruit == 0.0, "{fruit}");
    }

    #[test]
    fn cards_are_there_from_the_level_that_wants_them() {
        let (_, levels) = cherry(&[("lods", "2"), ("lod_form", "curved branch-card")]);
        assert!(part(&levels[0], "branches").is_none() && part(&levels[0], "leaves").is_some());
        assert!(part(&levels[1], "branches").is_some() && part(&levels[1], "leaves").is_none());
        // Even where a budget would not ask for them.
        let (_, levels) = cherry(&[("triangles", "4000000"), ("lod_form", "branch-card")]);
        assert!(part(&levels[0], "branches").is_some() && part(&levels[0], "leaves").is_none());
    }

    #[test]
    fn where_no_card_can_be_that_is_said() {
        let notes = |knobs: &[(&str, &str)]| {
            let subject = Subject::builtin("wild-cherry", &[&SMALL[..], knobs].concat());
            let grown = subject.grow();
            subject.with(|specimen| levels(specimen, body(&grown), &Quiet)).unwrap().notes
        };
        let wanted = [("triangles", "6000"), ("lod_form", "branch-card")];
        let said =
            |notes: &[String]| notes.iter().filter(|note| note.starts_with("lod_form: level 1 ")).count();
        assert_eq!(said(&notes(&wanted)), 0);
        let bare = [("leaf_keep", "0"), ("fruit.leaf_keep", "0")];
        assert_eq!(said(&notes(&[&wanted[..], &bare].concat())), 0, "there are its twigs");
        let all = ("triangles", "9000000");
        assert_eq!(said(&notes(&[&[all, wanted[1]], &bare[..]].concat())), 1);
        assert_eq!(said(&notes(&[&[all], &bare[..]].concat())), 0, "no card was asked for");
    }

    #[test]
    fn forms_that_have_no_picture_are_refused() {
        for (leaf, form, said) in [
            ("fan", "card", "give it fan, branch-card"),
            ("curved", "twig", "give it curved, branch-card, card, cross, tuft or curved"),
        ] {
            let knobs = [("lods", "2"), ("leaf_form", leaf), ("lod_form", form)];
            let subject = Subject::builtin("wild-cherry", &knobs);
            let told = linden_pipeline::grow::grow(&subject.recipe, &Quiet).unwrap_err().to_string();
            assert!(told.contains(said), "{told}");
        }
    }
}
