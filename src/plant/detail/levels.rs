//! A recipe's chain of levels: the tree as its knobs want it, and what stands for it from afar.

use std::borrow::Cow;
use std::sync::Arc;

use super::billboard::{Billboard, kept_billboard};
use super::cards::Cards;
use super::exposure::Exposure;
use super::forms::in_level;
use super::{Detail, DetailError, Simplified, Simplifier};
use crate::dress::{DressError, Wardrobe};
use crate::foliage::{Calendar, Organs, sprout};
use crate::scene::Scene;
use crate::season::Season;
use crate::settings::{BarkSettings, DetailSettings, Dressing, FoliageSettings, Form, LeafKind};
use crate::stage::{self, Stage};
use crate::surface::{Tubes, bends};
use crate::wind::{Blown, Field};
use crate::wood_parts::Cuts;
use crate::{Body, Specimen};
use linden_base::monitor::Holding;
use linden_base::monitor::Monitor;
use linden_skeleton::{Skeleton, WidthSteps};

/// Levels of detail of one tree.
#[derive(Debug)]
pub struct Levels {
    /// Finest first; at least one.
    pub levels: Vec<Level>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl Levels {
    /// What exporters take.
    pub fn stage(&self) -> Stage<'_> {
        // There is one at least.
        Stage::of_levels(&self.levels[0].scene, self.levels.iter().map(Level::on_stage).collect())
    }
}

/// A tree in one level of detail.
#[derive(Debug)]
pub struct Level {
    /// How it looks. Its skeleton is the whole tree's.
    pub scene: Scene,
    /// The level serves while the tree takes at least this share of the picture's height; 0 for the last.
    pub coverage: f32,
}

impl Level {
    /// What exporters take.
    pub const fn on_stage(&self) -> stage::Level<'_> {
        stage::Level { scene: &self.scene, coverage: self.coverage }
    }
}

/// The finest level serves down to this share of the picture's height.
const NEAR: f32 = 0.5;

/// Dresses a tree in all levels that its preset asks for: `triangles` for the finest, `lods` of them
/// (each `lod_ratio` of the triangles before) or one for each of `lod_triangles`, and a last one of
/// `billboard` planes.
///
/// # Errors
/// [`DetailError`]: a budget that is too small, memory, cancelled, whatever dressing finds.
pub fn levels(specimen: &Specimen<'_>, body: Body<'_>, monitor: &dyn Monitor) -> Result<Levels, DetailError> {
    let mut notes = Vec::new();
    let plan = Plan::new(specimen.dressing, body, &mut notes, monitor)?;
    let dressing = plan.dressing(specimen.dressing);
    let wardrobe = Wardrobe::new(&specimen.with(&dressing), body.organs, monitor)?;
    let levels = plan.dress(specimen, body, &wardrobe, monitor)?;
    notes.extend(note_on_billboard(&specimen.dressing.detail, &levels));
    notes.extend(plan.unmet(&levels));
    Ok(Levels { levels, notes })
}

/// One tree through the year, in all levels that its preset asks for.
#[derive(Debug)]
pub struct Year {
    /// At least one; first the one that is shown where there is no choice. All have as many levels.
    pub seasons: Vec<(Season, Vec<Level>)>,
    /// What the user should know.
    pub notes: Vec<String>,
    /// Of the tree as it was asked for, where `seasons` may have others.
    recipe: String,
}

impl Year {
    /// What exporters take.
    pub fn stage(&self) -> Stage<'_> {
        // There is one at least, with one level.
        let mut stage = Stage::of(&self.seasons[0].1[0].scene);
        stage.recipe.clone_from(&self.recipe);
        let seasons = self.seasons.iter().map(|(season, levels)| stage::Season {
            name: season.name.clone(),
            levels: levels.iter().map(Level::on_stage).collect(),
        });
        stage.plants[0].seasons = seasons.collect();
        stage
    }
}

/// Dresses a tree in each of some seasons, as [`levels`] does in that of the recipe: the wood is the same
/// in all of them, level by level, and a leaf that is there in two hangs in the same place. A budget of
/// triangles is met where the tree has most leaves, and used up where its twigs are bare. First comes the season nearest
/// to the recipe's.
///
/// # Errors
/// As [`levels`]. Without any season there is that of the recipe.
pub fn year(
    specimen: &Specimen<'_>,
    body: Body<'_>,
    seasons: &[Season],
    monitor: &dyn Monitor,
) -> Result<Year, DetailError> {
    let recipe_season = specimen.dressing.foliage.season;
    let mut seasons = seasons.to_vec();
    if seasons.is_empty() {
        seasons.push(Season { name: "own".to_owned(), season: recipe_season });
    }
    let away = |at: usize| (seasons[at].season - recipe_season).abs();
    let first = (1..seasons.len()).fold(0, |best, at| if away(at) < away(best) { at } else { best });
    seasons[..=first].rotate_right(1);

    let mut looks: Vec<(Dressing, Arc<Organs>)> = Vec::with_capacity(seasons.len());
    let mut held = body.bytes();
    for season in &seasons {
        let mut dressing = specimen.dressing.clone();
        dressing.foliage.season = season.season;
        let holding = Holding::new(monitor, held);
        let sprouting = sprout(&specimen.with(&dressing), body.skeleton, body.given, &holding);
        let organs = sprouting.map_err(DressError::from).map_err(DetailError::from)?;
        held += organs.bytes();
        looks.push((dressing, organs));
    }
    let amount = |at: usize| looks[at].1.amount().1;
    let most = (1..looks.len()).fold(0, |best, at| if amount(at) > amount(best) { at } else { best });

    let mut notes = Vec::new();
    if !specimen.dressing.foliage.changes_with_seasons() {
        notes.push("seasons: nothing on this plant changes with them".to_owned());
    }
    notes.extend(missed(&specimen.dressing.foliage, &seasons));
    let fullest = Body { organs: &looks[most].1, ..body };
    let plan = Plan::new(specimen.dressing, fullest, &mut notes, monitor)?;
    let mut wardrobe: Option<Wardrobe> = None;
    let mut year = Vec::with_capacity(seasons.len());
    for (season, (dressing, organs)) in seasons.into_iter().zip(&looks) {
        let worn_in = plan.dressing(dressing);
        let (specimen, worn_in) = (specimen.with(dressing), specimen.with(&worn_in));
        let body = Body { organs, ..body };
        let holding = Holding::new(monitor, held);
        let worn = match &wardrobe {
            Some(before) => before.in_season(&worn_in, organs, &holding)?,
            None => Wardrobe::new(&worn_in, organs, &holding)?,
        };
        let levels = plan.dress(&specimen, body, &worn, &holding)?;
        held += levels.iter().map(|level| level.scene.bytes()).sum::<u64>();
        year.push((season, levels));
        wardrobe = Some(worn);
    }
    notes.extend(year.first().and_then(|(_, levels)| note_on_billboard(&specimen.dressing.detail, levels)));
    notes.extend(year.get(most).into_iter().flat_map(|(_, levels)| plan.unmet(levels)));
    Ok(Year { seasons: year, notes, recipe: (specimen.recipe)(specimen.dressing, body.organs) })
}

/// Notes about the kinds of organs that none of some seasons shows.
fn missed(foliage: &FoliageSettings, seasons: &[Season]) -> Vec<String> {
    let note = |(number, kind): (usize, &LeafKind)| {
        let calendar = Calendar::of(kind);
        let is_seen = seasons.iter().any(|season| calendar.is_there(season.season as f32));
        // As knobs address it: the first kind by its section, further ones by their numbers.
        let address = || if number == 0 { "foliage".to_owned() } else { format!("also.{number}") };
        let name = kind.name.clone().unwrap_or_else(address);
        let (from, to) = (kind.season_range.first()?, kind.season_range.get(1)?);
        let middle = if to < from { (from + to + 1.0) / 2.0 % 1.0 } else { f64::midpoint(*from, *to) };
        (!is_seen && kind.form != Form::None).then(|| {
            format!(
                "seasons: {name} is there from {from} to {to}, in none of these; a season more shows it, as \
                 --seasons all,bloom={middle:.2}"
            )
        })
    };
    foliage.kinds().enumerate().filter_map(note).collect()
}

/// The most triangles that a level has before a billboard, without a word about it: what is a few pixels high
/// looks alike in both.
const MOST_BEFORE_BILLBOARD: usize = 5000;

/// Says where there is nothing between a heavy level and the crossed planes behind it.
fn note_on_billboard(detail: &DetailSettings, levels: &[Level]) -> Option<String> {
    let [.., before, last] = levels else { return None };
    let (before, last) = (before.scene.triangles(), last.scene.triangles());
    (detail.billboard > 0 && before > MOST_BEFORE_BILLBOARD).then(|| {
        format!(
            "billboard: it has {last} triangles and the level before it {before}; budgets make levels between, like \
             --lods {},{},{}",
            rounded(before),
            rounded(before / 5),
            rounded(before / 25)
        )
    })
}

/// Triangles that a level was solved for.
#[derive(Clone, Copy, Debug)]
struct Budget {
    triangles: u64,
    /// How many the user asked for, which may be more than there are; levels that get a share of the finest have none.
    asked: Option<u64>,
}

impl Budget {
    /// Into which parts the trunk of a level is cut that has the whole tree or less.
    fn cuts(self, is_whole: bool) -> Cuts {
        match (is_whole, self.asked) {
            (true, Some(asked)) if asked >= BarkSettings::LEAST_TRIANGLES => Cuts::All,
            (true, None) => Cuts::All,
            (_, asked) => Cuts::within(asked.unwrap_or(self.triangles)),
        }
    }
}

/// A budget is met within this share of it, as the knob `triangles` says.
const NEAR_BUDGET: f64 = 0.05;

/// Says which budgets were not met. What is more than the whole tree has was made less before, and is said elsewhere.
fn unmet(budgets: &[Budget], found: impl IntoIterator<Item = usize>) -> Vec<String> {
    let asked = budgets.iter().zip(found).filter(|(budget, _)| budget.asked.is_some());
    asked
        .map(|(budget, found)| (budget.triangles, found as u64))
        .filter(|&(budget, found)| budget.abs_diff(found) as f64 > NEAR_BUDGET * budget as f64)
        .map(|(budget, found)| format!("a budget of {budget} triangles was not met: {found} are written"))
        .collect()
}

/// To two digits.
const fn rounded(number: usize) -> usize {
    let mut unit = 1;
    while number / unit >= 100 {
        unit *= 10;
    }
    number / unit * unit
}

/// Side of the pictures of leaves that cards are drawn with, pixels, or a quarter of `leaf_size`: a leaf is far
/// larger in it than on any card.
const LEAVES_ON_CARDS_PX: u32 = 256;

/// For notes.
const NO_CARDS: &str = "no level needs them, since enough leaves and twigs are left in each";

/// Which levels there are to be of a tree.
struct Plan {
    /// How much each has, finest first; `None`: one with everything.
    details: Option<Vec<Detail>>,
    /// What each was solved for.
    budgets: Vec<Budget>,
    /// What is seen past the foliage where there is most: in all seasons the same wood stays.
    exposure: Exposure,
}

impl Plan {
    /// Solves for the budgets that a preset sets.
    fn new(
        dressing: &Dressing,
        body: Body<'_>,
        notes: &mut Vec<String>,
        monitor: &dyn Monitor,
    ) -> Result<Self, DetailError> {
        let Dressing { detail, tubes, .. } = dressing;
        // Steps that were asked for have no curve, which is said of the knob.
        let is_asked = tubes.smooth_wood > 0.0 && body.skeleton.width_steps == WidthSteps::Taper;
        if is_asked && !bends(body.skeleton, tubes) {
            notes.push("smooth_wood: no wood of that thickness has a corner at a node".to_owned());
        }
        let budgets = detail.budgets();
        if let Some(pair) = budgets.windows(2).find(|pair| pair[0] <= pair[1]) {
            return Err(DetailError::NotFewer { before: pair[0], after: pair[1] });
        }
        if detail.is_whole() {
            return Ok(Self { details: None, budgets: Vec::new(), exposure: Exposure::default() });
        }
        let exposure = Exposure::of(body, monitor)?;
        let simplifier = Simplifier::with_exposure(tubes, body, &exposure, monitor)?;
        let foliage = &dressing.foliage;
        let full = simplifier.in_level(foliage, 0, monitor)?.full_triangles(monitor)?;
        let (mut details, mut solved) = (Vec::new(), Vec::new());
        let mut are_cards_missed = false;
        if !budgets.is_empty() {
            let most = budgets.iter().rposition(|&budget| budget >= full).unwrap_or(0);
            if budgets[0] > full {
                notes.push(format!("lod_triangles: the tree has no more than {full}"));
            }
            if most > 0 {
                notes.push(format!(
                    "lod_triangles: the first {} levels would be the whole tree; it is written once",
                    most + 1
                ));
            }
            for (number, &budget) in budgets[most..].iter().enumerate() {
                let simplifier = simplifier.in_level(foliage, number, monitor)?;
                details.push(simplifier.within(budget, detail.branch_cards, monitor)?);
                solved.push(Budget { triangles: budget.min(full), asked: Some(budget) });
                are_cards_missed |= !detail.branch_cards && simplifier.is_in_cards(budget, monitor)?;
                notes.extend(simplifier.note_on_cards(number, &details[number], detail.branch_cards));
            }
            return Ok(Self::of((details, solved), exposure, dressing, are_cards_missed, notes));
        }
        let least = simplifier.least_triangles(monitor)?;
        let mut budget = if detail.triangles == 0 { full } else { detail.triangles };
        if budget > full {
            notes.push(format!("triangles={budget}: the tree has no more than {full}"));
            budget = full;
        }
        for level in 0..detail.lods.max(1) {
            let simplifier = simplifier.in_level(foliage, level as usize, monitor)?;
            if level > 0 && budget < least {
                notes.push(format!(
                    "lods={}: after {level} levels nothing is left to leave out ({least} triangles)",
                    detail.lods
                ));
                break;
            }
            details.push(simplifier.within(budget, detail.branch_cards, monitor)?);
            let asked = (level == 0 && detail.triangles > 0).then_some(detail.triangles);
            solved.push(Budget { triangles: budget, asked });
            are_cards_missed |= !detail.branch_cards && simplifier.is_in_cards(budget, monitor)?;
            let number = level as usize;
            notes.extend(simplifier.note_on_cards(number, &details[number], detail.branch_cards));
            budget = (budget as f64 * detail.lod_ratio) as u64;
        }
        Ok(Self::of((details, solved), exposure, dressing, are_cards_missed, notes))
    }

    /// Levels of these details. Says what is asked for cards where no level has any.
    fn of(
        (details, budgets): (Vec<Detail>, Vec<Budget>),
        exposure: Exposure,
        dressing: &Dressing,
        are_cards_missed: bool,
        notes: &mut Vec<String>,
    ) -> Self {
        let DetailSettings { branch_cards, card_size_px, .. } = dressing.detail;
        let is_asked = branch_cards && card_size_px != DetailSettings::default().card_size_px;
        if is_asked && details.iter().all(|level| level.card_m == 0.0) {
            notes.push(format!("card_size: {NO_CARDS}"));
        }
        if !branch_cards && !are_cards_missed {
            notes.push(format!("branch_cards: {NO_CARDS}"));
        }
        Self { details: Some(details), budgets, exposure }
    }

    /// Says which budgets these levels do not meet; without a surface they have no triangles.
    fn unmet(&self, levels: &[Level]) -> Vec<String> {
        let found = levels.iter().map(|level| level.scene.triangles());
        unmet(&self.budgets, found.take_while(|triangles| *triangles > 0))
    }

    /// How the tree is dressed in these levels: leaves that are seen on cards alone are small on them, and so may be
    /// their pictures.
    fn dressing<'a>(&self, asked: &'a Dressing) -> Cow<'a, Dressing> {
        let are_all_cards = self.details.iter().flatten().all(|level| level.card_m > 0.0);
        if self.details.is_none() || !are_all_cards {
            return Cow::Borrowed(asked);
        }
        let mut dressing = asked.clone();
        let size_px = &mut dressing.foliage.size_px;
        *size_px = (*size_px).min(LEAVES_ON_CARDS_PX.max(*size_px / 4));
        Cow::Owned(dressing)
    }

    /// These details in the season of simplifiers, one for each: twigs that are bare then are on cards, which use the whole budget.
    fn in_season(
        &self,
        details: &[Detail],
        simplifiers: &[Simplifier<'_>],
        has_cards: bool,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Detail>, DetailError> {
        if !has_cards {
            return Ok(details.to_vec());
        }
        let levels = simplifiers.iter().zip(details).zip(&self.budgets);
        levels
            .map(|((simplifier, level), budget)| simplifier.with_twigs(level, budget.triangles, monitor))
            .collect()
    }

    /// Dresses a tree in these levels, and in what stands for it from afar. The wardrobe is of [`Self::dressing`].
    fn dress(
        &self,
        specimen: &Specimen<'_>,
        body: Body<'_>,
        wardrobe: &Wardrobe,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Level>, DetailError> {
        // Files say how the tree was asked for.
        let recipe = (specimen.recipe)(specimen.dressing, body.organs);
        let dressing = self.dressing(specimen.dressing);
        let specimen = &specimen.with(&dressing);
        let detail = &specimen.dressing.detail;
        let field = Field::of(specimen, body.skeleton);
        let mut scenes = match &self.details {
            None => {
                let blown = field.as_ref().map(|field| Blown { field, axes: None });
                vec![wardrobe.dress(specimen, body, blown, monitor)?]
            }
            Some(details) => self.simplified(details, specimen, body, wardrobe, field.as_ref(), monitor)?,
        };
        for scene in &mut scenes {
            scene.recipe.clone_from(&recipe);
        }
        if detail.billboard > 0 && specimen.wanted.surface {
            let how = Billboard { planes: detail.billboard, size_px: detail.billboard_size_px };
            let held = Holding::new(monitor, scenes.iter().skip(1).map(Scene::bytes).sum());
            scenes.push(kept_billboard(&scenes[0], how, specimen.drawn, &held)?);
        }
        Ok(with_coverage(scenes, detail))
    }

    /// Dresses the tree as simplified as each of its levels asks for.
    fn simplified(
        &self,
        details: &[Detail],
        specimen: &Specimen<'_>,
        body: Body<'_>,
        wardrobe: &Wardrobe,
        field: Option<&Field>,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Scene>, DetailError> {
        let Dressing { detail, tubes, .. } = specimen.dressing;
        let simplifier = Simplifier::with_exposure(tubes, body, &self.exposure, monitor)?;
        let foliage = &specimen.dressing.foliage;
        let simplifiers = (0..details.len())
            .map(|number| simplifier.in_level(foliage, number, monitor))
            .collect::<Result<Vec<_>, _>>()?;
        let details = &self.in_season(details, &simplifiers, detail.branch_cards, monitor)?;
        let are_seen = specimen.wanted.surface;
        let mut pieces = Vec::new();
        for (simplifier, level) in simplifiers.iter().zip(details) {
            if are_seen && level.card_m > 0.0 {
                pieces.push(simplifier.pieces(level, monitor)?);
            }
        }
        let size_px = detail.card_size_px;
        let mut cards = (!pieces.is_empty())
            .then(|| Cards::new(&pieces, specimen, body, wardrobe, size_px, monitor))
            .transpose()?;
        drop(pieces);
        let (mut scenes, mut carded): (Vec<Scene>, usize) = (Vec::new(), 0);
        for (number, (simplifier, level)) in simplifiers.iter().zip(details).enumerate() {
            let held = Holding::new(monitor, scenes.iter().map(Scene::bytes).sum());
            let mut thin = simplifier.simplified(level, &held)?;
            let mut worn = wardrobe.with_shapes(in_level(wardrobe.shapes(), number));
            if let (Some(cards), true) = (&mut cards, level.card_m > 0.0) {
                (thin.organs, worn) = cards.beside(carded, thin.organs, &worn);
                carded += 1;
            }
            worn = worn.cut_into(self.budgets[number].cuts(*level == Detail::full(tubes)));
            let mut scene = dressed(thin, &worn, field, specimen, body, &held)?;
            if level.card_m > 0.0 {
                // Whatever stands for them, these are the tree's.
                scene.organs = wardrobe.organs(specimen, body.organs);
            }
            scenes.push(scene);
        }
        Ok(scenes)
    }
}

/// Scenes from the finest to the coarsest as levels, each with the least height on the screen that it is for.
fn with_coverage(scenes: Vec<Scene>, detail: &DetailSettings) -> Vec<Level> {
    // As many triangles per pixel in each: the height goes with the root of their number.
    let step = (detail.lod_ratio as f32).sqrt();
    let most = scenes[0].triangles().max(1) as f32;
    let is_listed = !detail.budgets().is_empty();
    let last = scenes.len() - 1;
    let mut coverage = NEAR / step;
    let level = |(index, scene): (usize, Scene)| {
        coverage *= step;
        let listed = NEAR * (scene.triangles() as f32 / most).sqrt();
        let threshold = if is_listed { listed } else { coverage };
        Level { scene, coverage: if index == last { 0.0 } else { threshold } }
    };
    scenes.into_iter().enumerate().map(level).collect()
}

impl Simplifier<'_> {
    /// What the user should know of a level where branch cards are wanted and none are.
    fn note_on_cards(&self, level: usize, detail: &Detail, with_cards: bool) -> Option<String> {
        let are_missing = with_cards && self.leaves.forms().wants_cards && detail.card_m == 0.0;
        are_missing.then(|| {
            format!(
                "lod_form: level {} has leaves in place of branch cards: its budget is too small for any, or nothing is \
                 left to be shown on them",
                level + 1
            )
        })
    }
}

/// The finest level of a tree, without its meshes.
#[derive(Clone, Debug)]
pub struct Finest {
    /// The axial tree.
    pub skeleton: Arc<Skeleton>,
    /// What grows on it; all that grows on the tree where branch cards stand for it.
    pub organs: Arc<Organs>,
    /// Vertices and triangles of those cards, and of the leaves beside them.
    pub cards: Option<[u64; 2]>,
    /// How its surface is made.
    pub tubes: Tubes,
}

/// The finest level's wood and leaves, as `triangles` has them, and how the wood is swept: what is
/// measured where nothing is to be dressed.
///
/// # Errors
/// [`DetailError`].
pub fn finest(dressing: &Dressing, body: Body<'_>, monitor: &dyn Monitor) -> Result<Finest, DetailError> {
    let Dressing { detail, tubes, .. } = dressing;
    let budget = detail.finest();
    if budget == 0 {
        return Ok(Finest {
            skeleton: Arc::clone(body.skeleton),
            organs: Arc::clone(body.organs),
            cards: None,
            tubes: *tubes,
        });
    }
    let simplifier = Simplifier::new(tubes, body, monitor)?.in_level(&dressing.foliage, 0, monitor)?;
    let chosen = simplifier.within(budget, detail.branch_cards, monitor)?;
    let Simplified { skeleton, organs, tubes, .. } = simplifier.simplified(&chosen, monitor)?;
    let cards = simplifier.cards(&chosen, monitor)?.map(|[vertices, triangles]| {
        let (beside_vertices, beside_triangles) = organs.amount();
        [vertices + beside_vertices, triangles + beside_triangles]
    });
    let organs = if cards.is_some() { Arc::clone(body.organs) } else { Arc::new(organs) };
    Ok(Finest { skeleton: Arc::new(skeleton), organs, cards, tubes })
}

/// Dresses a level.
fn dressed(
    Simplified { skeleton, axes, organs, tubes }: Simplified,
    wardrobe: &Wardrobe,
    field: Option<&Field<'_>>,
    specimen: &Specimen<'_>,
    body: Body<'_>,
    monitor: &dyn Monitor,
) -> Result<Scene, DetailError> {
    let dressing = Dressing { tubes, ..specimen.dressing.clone() };
    let (skeleton, organs) = (Arc::new(skeleton), Arc::new(organs));
    let thin = Body { skeleton: &skeleton, organs: &organs, ..body };
    let blown = field.map(|field| Blown { field, axes: Some(&axes) });
    let mut scene = wardrobe.dress(&specimen.with(&dressing), thin, blown, monitor)?;
    // Whatever is shown of it, this is the tree.
    scene.skeleton = Arc::clone(body.skeleton);
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_met_within_a_twentieth() {
        let asked = |triangles| Budget { triangles, asked: Some(triangles) };
        let shared = |triangles| Budget { triangles, asked: None };
        assert_eq!(unmet(&[asked(20_000), shared(5000)], [19_964, 6_700]), Vec::<String>::new());
        assert_eq!(unmet(&[asked(500)], [525]), Vec::<String>::new());
        assert_eq!(unmet(&[asked(500)], [640]), ["a budget of 500 triangles was not met: 640 are written"]);
        assert_eq!(unmet(&[shared(500_000)], [1_200_000]), Vec::<String>::new(), "none was asked for");
        assert_eq!(
            unmet(&[asked(4000), asked(1000)], [4000, 1500, 8]),
            ["a budget of 1000 triangles was not met: 1500 are written"],
            "planes have no budget"
        );
    }
}
