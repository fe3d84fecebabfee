//! Self-organizing trees as a generator.

use glam::{DVec3, Vec3};
use linden_base::document::{Fault, Table};
use linden_base::input::Inputs;
use linden_base::knob::{Knob, Value, set, values};
use linden_base::monitor::Monitor;
use linden_crown::skin::Skin;
use linden_crown::solid::CROWN_KEY;
use linden_skeleton::generator::{
    Barred, Branched, Generator, GeneratorError, Obstruction, Obstructs, Passage, RadiiFrom, SampleSize,
    Sampler, Settings, Steps, TableKey, Task, Traits, Written,
};
use linden_skeleton::publication::{Publication, PublicationKind};
use linden_skeleton::{AxisRule, Wood};

use crate::obstacle::Obstacle;
use crate::sample::FirstTrees;
use crate::{Barriers, Grown, Neighbour, Planted, SelfOrganizing, grow_among, obstacle, stand};

/// Trees whose buds compete for light.
pub const GENERATOR: &dyn Generator = &SelfOrganizingTrees;

/// The paper.
const PALUBICKI: Publication = Publication {
    key: "palubicki2009",
    kind: PublicationKind::Article,
    authors: &[
        "Pałubicki, Wojciech",
        "Horel, Kipp",
        "Longay, Steven",
        "Runions, Adam",
        "Lane, Brendan",
        "Měch, Radomír",
        "Prusinkiewicz, Przemyslaw",
    ],
    title: "Self-organizing tree models for image synthesis",
    year: 2009,
    venue: "ACM Transactions on Graphics",
    volume: "28",
    number: "3",
    pages: "58:1-58:10",
};

/// Trees of a stand that a page lists.
const MOST_TOLD: usize = 12;

struct SelfOrganizingTrees;

impl Generator for SelfOrganizingTrees {
    fn id(&self) -> &'static str {
        "self-organizing"
    }

    fn name(&self) -> &'static str {
        "Self-organizing"
    }

    fn help(&self) -> &'static str {
        "buds compete for light year by year; what stays dark is shed"
    }

    fn publications(&self) -> &'static [Publication] {
        &[PALUBICKI]
    }

    fn knobs(&self) -> Vec<Knob> {
        SelfOrganizing::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn keys(&self) -> &'static [TableKey] {
        &[stand::TREES, obstacle::OBSTACLES]
    }

    fn read(&self, table: &Table<'_>) -> Result<Box<dyn Settings>, Fault> {
        let mut settings = SelfOrganizing::default();
        if let Some(entry) = table.find(stand::TREE) {
            settings.stand = stand::read(&entry.node)?;
        }
        if let Some(entry) = table.find(obstacle::OBSTACLE) {
            settings.obstacles = obstacle::read(&entry.node)?;
        }
        Ok(Box::new(settings))
    }
}

impl Settings for SelfOrganizing {
    fn generator(&self) -> &'static dyn Generator {
        GENERATOR
    }

    fn knobs(&self) -> Vec<(Knob, Value)> {
        values(Self::FIELDS, self)
    }

    fn set(&mut self, knob: &str, value: Value) -> bool {
        set(Self::FIELDS, self, knob, value)
    }

    fn written(&self) -> Vec<(&'static str, Written)> {
        let trees: Vec<_> = self.stand.iter().map(Neighbour::written).collect();
        let obstacles: Vec<_> = self.obstacles.iter().map(Obstacle::written).collect();
        let all = [(stand::TREE, trees), (obstacle::OBSTACLE, obstacles)].into_iter();
        all.filter(|(_, tables)| !tables.is_empty()).map(|(key, all)| (key, Written::Tables(all))).collect()
    }

    fn plain(&self) -> Box<dyn Settings> {
        let (stand, obstacles) = (self.stand.clone(), self.obstacles.iter().map(Obstacle::plain).collect());
        Box::new(Self { stand, obstacles, ..Self::default() })
    }

    fn inputs(&self) -> Vec<&str> {
        self.obstacles.iter().filter_map(Obstacle::file).collect()
    }

    fn rename_inputs(&mut self, renamed: &dyn Fn(&str) -> Option<String>) {
        for file in self.obstacles.iter_mut().filter_map(Obstacle::file_mut) {
            if let Some(name) = renamed(file) {
                *file = name;
            }
        }
    }

    fn describe(&self, inputs: &Inputs) -> Vec<Passage> {
        let tree = |(number, tree): (usize, &Neighbour)| format!("{number} {}", tree.describe());
        let more = self.stand.len().saturating_sub(MOST_TOLD);
        let trees = (2..).zip(&self.stand).take(MOST_TOLD).map(tree);
        let trees = trees.chain((more > 0).then(|| format!("and {more} more"))).collect();
        let obstacle = |(number, obstacle): (usize, &Obstacle)| {
            let input = obstacle.file().and_then(|file| inputs.get(file));
            let extent = input.map_or_else(String::new, |input| format!(": {}", input.extent()));
            let knobs = obstacle.knobs().into_iter().filter(|(knob, _)| knob.name != CROWN_KEY);
            let knobs: Vec<String> = knobs.map(|(knob, value)| format!("{} {value}", knob.name)).collect();
            [format!("{number} {}{extent}", obstacle.describe()), format!("  {}", knobs.join("  "))]
        };
        let obstacles = (1..).zip(&self.obstacles).flat_map(obstacle).collect();
        let all = [("further trees", trees), ("obstacles", obstacles)];
        let passage = |(heading, lines): (&'static str, Vec<String>)| {
            (!lines.is_empty()).then_some(Passage { heading, lines })
        };
        all.into_iter().filter_map(passage).collect()
    }

    fn idle(&self, knob: &str, _: &Wood) -> Option<&'static str> {
        self.why_idle(knob)
    }

    fn traits(&self, _: &Wood) -> Traits {
        Traits { radii: RadiiFrom::Generator, axes: AxisRule::Grammar, ..Traits::default() }
    }

    /// A younger tree has branches that the older one shed, which births do not tell.
    fn steps(&self) -> Option<Steps> {
        Some(Steps { count: self.years_grown(), unit: "year" })
    }

    fn at_step(&self, years: u32) -> Option<Box<dyn Settings>> {
        let (years, age) = Steps::at(years.max(1), self.years);
        Some(Box::new(Self { years, age, ..self.clone() }))
    }

    fn whole(&self) -> Option<Box<dyn Settings>> {
        (self.years_grown() < self.years).then(|| Box::new(Self { age: 1.0, ..self.clone() }) as _)
    }

    fn limit(&mut self, _: &Inputs, size: &SampleSize) -> Result<bool, String> {
        self.max_nodes = self.max_nodes.min(size.nodes);
        Ok(false)
    }

    fn sampler<'a>(
        &'a self,
        _: &Task<'a>,
        _: SampleSize,
        _: &'a dyn Monitor,
    ) -> Result<Box<dyn Sampler + 'a>, GeneratorError> {
        Ok(Box::new(FirstTrees::new(self)))
    }

    fn grow(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Branched, GeneratorError> {
        let neighbour = |&Neighbour { at: [x, z], felled_in }: &Neighbour| Planted {
            foot: DVec3::new(x, 0.0, z).as_vec3(),
            felled_in,
        };
        let trees: Vec<Planted> =
            [Planted::default()].into_iter().chain(self.stand.iter().map(neighbour)).collect();
        let barriers = Barriers::new(self, task.inputs, monitor)?;
        let grown = grow_among(self, &trees, &barriers, task.key().named("self-organizing"), monitor)?;
        let shade = if barriers.is_empty() { "of others" } else { "of others or of obstacles" };
        let what = if self.stems == 1 { "trees" } else { "stems" };
        let all = trees.len() * self.stems as usize;
        let note = || format!("{} of {all} {what} died in the shade {shade}", grown.died);
        let mut notes = barriers.notes.clone();
        notes.extend((grown.died > 0).then(note));
        // At whatever age the stand is shown.
        let late = self.stand.iter().filter(|tree| tree.felled_in > self.years).count();
        let note =
            || format!("felled changes nothing for {late} of the trees: the last year is {}", self.years);
        notes.extend((late > 0).then(note));
        let barred =
            (!barriers.is_empty()).then(|| -> Barred { Box::new(move |p| barriers.hold(p.as_dvec3())) });
        let most_nodes = self.max_nodes.into();
        let Grown { branching, trees, .. } = grown;
        Ok(Branched { branching, most_nodes, barred, trees, notes, ..Branched::default() })
    }

    /// The obstacles.
    fn outline(&self, task: &Task<'_>, monitor: &dyn Monitor) -> Result<Vec<Vec<Vec3>>, GeneratorError> {
        Ok(Barriers::new(self, task.inputs, monitor)?.outline())
    }

    fn obstructions(
        &self,
        task: &Task<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Obstruction>, GeneratorError> {
        let solid =
            |Skin { positions, triangles }| Obstruction::new(Obstructs::Branches, positions, triangles);
        Ok(Barriers::new(self, task.inputs, monitor)?.skins().into_iter().map(solid).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::knob::Kind;
    use linden_base::memory::OverMemory;
    use linden_base::monitor::{Cancelled, Phase, Quiet};
    use linden_skeleton::Skeleton;

    fn task(inputs: &Inputs) -> Task<'_> {
        Task { seed: 4, inputs, wood: Wood::default() }
    }

    #[test]
    fn every_knob_takes_its_value_back_and_points_to_knobs_that_there_are() {
        let mut settings = SelfOrganizing::default();
        let knobs = Settings::knobs(&settings);
        let names: Vec<&str> = knobs.iter().map(|(knob, _)| knob.name).collect();
        for (knob, value) in knobs {
            assert!(Settings::set(&mut settings, knob.name, value.clone()), "{}", knob.name);
            assert_eq!(knob.kind.parse(&value.to_string()), Ok(value), "{}", knob.name);
            assert!(knob.see_also.iter().all(|other| names.contains(other)), "{}", knob.name);
            assert!(matches!(knob.kind, Kind::Switch) || !knob.help.is_empty());
        }
        assert_eq!(settings, SelfOrganizing::default());
    }

    fn hash(settings: &SelfOrganizing) -> u128 {
        let branched = Settings::grow(settings, &task(&Inputs::new()), &Quiet).unwrap();
        Skeleton::build(branched.branching, &Wood::default()).unwrap().hash()
    }

    fn shedding() -> SelfOrganizing {
        SelfOrganizing { years: 16, shed: 0.3, shed_patience: 1, ..SelfOrganizing::default() }
    }

    #[test]
    fn gaps_of_crowns_shed_where_nothing_else_does_but_not_on_sympodial_stems() {
        let gaps = SelfOrganizing { shed: 0.0, crown_gap_m: 0.05, ..shedding() };
        assert_eq!(gaps.why_idle("dead_years"), None);
        assert_ne!(hash(&SelfOrganizing { dead_years: 4, ..gaps.clone() }), hash(&gaps));
        let sympodial = SelfOrganizing { sympodial: true, ..shedding() };
        let gaps = SelfOrganizing { crown_gap_m: 0.05, ..sympodial.clone() };
        assert!(gaps.why_idle("crown_gap").is_some());
        assert_eq!(hash(&gaps), hash(&sympodial));
    }

    #[test]
    fn each_knob_that_is_not_idle_changes_the_tree() {
        let base = shedding();
        let plain = hash(&base);
        for (knob, text) in [
            ("stems", "3"),
            ("years", "15"),
            ("internode", "0.2"),
            ("vigor", "2.2"),
            ("decline", "10"),
            ("sharing", "priority"),
            ("leader", "0.54 0.5"),
            ("mature_leader", "0.48"),
            ("light", "sky"),
            ("shade", "0.1"),
            ("shade_falloff", "1.5"),
            ("shade_depth", "4"),
            ("light_from", "1,1,0"),
            ("light_pull", "0.1"),
            ("upward", "0.15 0"),
            ("sideways", "0 0.3"),
            ("phyllotaxis", "opposite"),
            ("divergence", "120"),
            ("branching_angle", "40"),
            ("jitter", "0"),
            ("longest_shoot", "2.5"),
            ("max_order", "1"),
            ("sympodial", "true"),
            ("bud_years", "0"),
            ("shed", "0.1"),
            ("shed_grace", "1"),
            ("shed_patience", "3"),
            ("dead_years", "4"),
            ("bole", "0.8"),
            ("crown_gap", "0.05"),
            ("twig_diameter", "0.01"),
            ("pipe_exponent", "2"),
            ("sag", "1"),
        ] {
            let field = SelfOrganizing::FIELDS.iter().find(|field| field.knob.name == knob).unwrap();
            let mut settings = base.clone();
            assert_eq!(settings.why_idle(knob), None, "{knob}");
            (field.write)(&mut settings, field.knob.kind.parse(text).unwrap());
            assert_ne!(hash(&settings), plain, "{knob}");
        }
        let shrub = SelfOrganizing { stems: 4, ..base.clone() };
        for other in [
            SelfOrganizing { stool_m: 0.5, ..shrub.clone() },
            SelfOrganizing { stem_lean_deg: 5.0, ..shrub.clone() },
        ] {
            assert_ne!(hash(&other), hash(&shrub), "{other:?}");
        }
        let priority = SelfOrganizing { sharing: crate::Sharing::Priority, ..base.clone() };
        for other in [
            SelfOrganizing { priority_least: 0.1, ..priority.clone() },
            SelfOrganizing { priority_share: 1.0, ..priority.clone() },
        ] {
            assert_ne!(hash(&other), hash(&priority), "{other:?}");
        }
        let whorled = SelfOrganizing { phyllotaxis: crate::Phyllotaxis::Whorled, ..base.clone() };
        assert_ne!(hash(&SelfOrganizing { whorl: 3, ..whorled.clone() }), hash(&whorled));
        let heavy = SelfOrganizing { sag: 1.0, ..base.clone() };
        assert_ne!(hash(&SelfOrganizing { leaf_weight_kg: 0.02, ..heavy.clone() }), hash(&heavy));
        assert_ne!(hash(&SelfOrganizing { righting: 0.5, ..heavy.clone() }), hash(&heavy));
        let by_order = SelfOrganizing { upward: vec![0.3, 0.0], ..base.clone() };
        assert_ne!(hash(&SelfOrganizing { reiteration: 2, ..by_order.clone() }), hash(&by_order));
        let sky = SelfOrganizing { light: crate::LightModel::Sky, shade: 0.3, shed: 0.2, ..base.clone() };
        for other in [
            SelfOrganizing { leaf_years: 1, ..sky.clone() },
            SelfOrganizing { shade: 0.4, ..sky.clone() },
            SelfOrganizing { light_from: [1.0, 1.0, 0.0], ..sky.clone() },
            SelfOrganizing { light_pull: 0.1, ..sky.clone() },
        ] {
            assert_ne!(hash(&other), hash(&sky), "{other:?}");
        }
        // What is called idle changes nothing.
        let idle = SelfOrganizing { shade_falloff: 2.0, shade_depth: 2, ..sky.clone() };
        assert!(["shade_falloff", "shade_depth"].iter().all(|knob| idle.why_idle(knob).is_some()));
        assert_eq!(hash(&idle), hash(&sky));
        let idle = SelfOrganizing {
            stool_m: 1.0,
            stem_lean_deg: 5.0,
            whorl: 3,
            leaf_years: 1,
            righting: 1.0,
            priority_share: 1.0,
            mature_from: 3,
            decline_from: 3,
            reiteration: 2,
            ..base.clone()
        };
        assert_eq!(hash(&idle), plain);
    }

    #[test]
    fn a_younger_tree_is_the_same_tree_in_that_year() {
        let inputs = Inputs::new();
        let old = SelfOrganizing { years: 14, ..SelfOrganizing::default() };
        let young = old.at_step(9).unwrap();
        let grow = |settings: &dyn Settings| settings.grow(&task(&inputs), &Quiet).unwrap().branching;
        let (old, young) = (grow(&old), grow(&*young));
        // What stands of it is where it was: nodes are not moved.
        let is_there = |place: &glam::Vec3| young.positions.contains(place);
        let kept = old.births.iter().zip(&old.positions).filter(|(birth, _)| **birth < 10 * 16);
        let (there, all) = kept
            .fold((0, 0_usize), |(there, all), (_, place)| (there + usize::from(is_there(place)), all + 1));
        assert!(all > 50 && there == all, "{there} of {all}");
        assert!(young.positions.len() >= all);
    }

    #[test]
    fn a_felling_behind_the_last_year_is_told() {
        let inputs = Inputs::new();
        let notes = |felled_in, age| {
            let stand = vec![Neighbour { at: [2.0, 0.0], felled_in }, Neighbour::at([-2.0, 0.0])];
            let settings = SelfOrganizing { stand, years: 9, age, ..SelfOrganizing::default() };
            Settings::grow(&settings, &task(&inputs), &Quiet).unwrap().notes
        };
        assert_eq!(notes(10, 1.0), ["felled changes nothing for 1 of the trees: the last year is 9"]);
        // A young stand has its felling ahead.
        assert!(notes(9, 1.0).is_empty() && notes(9, 0.5).is_empty());
    }

    struct Watched {
        cancelled_after: u64,
        memory: u64,
        year: std::sync::atomic::AtomicU64,
    }

    impl Monitor for Watched {
        fn is_cancelled(&self) -> bool {
            self.year.load(std::sync::atomic::Ordering::Relaxed) >= self.cancelled_after
        }

        fn advance(&self, _: Phase, done: u64, _: Option<u64>) {
            self.year.store(done, std::sync::atomic::Ordering::Relaxed);
        }

        fn memory_limit(&self) -> u64 {
            self.memory
        }
    }

    #[test]
    fn it_stops_when_cancelled_and_before_it_takes_too_much_memory() {
        let inputs = Inputs::new();
        let grow = |cancelled_after, memory| {
            let watched = Watched { cancelled_after, memory, year: 0.into() };
            let refused = Settings::grow(&SelfOrganizing::default(), &task(&inputs), &watched).err();
            (refused.unwrap(), watched.year.into_inner())
        };
        let (refused, year) = grow(5, u64::MAX);
        assert!(matches!(refused, GeneratorError::Cancelled(Cancelled)) && year == 5);
        let (refused, _) = grow(1000, 600_000);
        assert!(matches!(refused, GeneratorError::Memory(OverMemory { limit_bytes: 600_000, .. })));
    }
}
