//! Which trees are grown, and where they stand.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::compete::Stand;
use super::error::ForestError;
use super::planned::{Plan, PlannedTree};
use super::{Forest, ForestKind, Places, poisson_disc};
use crate::recipe::Recipe;
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_plant::stage::Place;

/// More trees than this are refused: every format lists each of them.
pub const MOST_PLACES: u64 = 1_000_000;

/// Poisson-disc points by the square of the spacing, at most: where no other disc fits.
const DENSITY: f64 = 0.7;

impl Forest {
    /// Lays the forest out.
    ///
    /// # Errors
    /// [`ForestError`].
    pub fn plan(&self, monitor: &dyn Monitor) -> Result<Plan, ForestError> {
        let layout = &self.layout;
        if self.kinds.is_empty() {
            return Err(ForestError::Empty);
        }
        layout.check()?;
        let is_sound = |x: f64| x.is_finite() && x > 0.0;
        if let Some(kind) = self.kinds.iter().find(|kind| !is_sound(kind.share) || !is_sound(kind.size)) {
            let (share, size) = (kind.share, kind.size);
            return Err(ForestError::Kind {
                kind: linden_base::knob::printable(&kind.recipe.preset.id),
                share,
                size,
            });
        }
        if layout.places == Places::Given {
            return self.where_they_are();
        }
        let (area_m, spacing_m) = (layout.area_m, layout.spacing_m);
        if spacing_m > area_m && layout.trees != Some(1) {
            return Err(ForestError::Alone { spacing_m, area_m });
        }
        let about = (DENSITY * (area_m / spacing_m) * (area_m / spacing_m)) as u64;
        if about > MOST_PLACES {
            return Err(ForestError::TooMany { about, spacing_m, area_m });
        }
        // Grid, points, list of active ones, places.
        monitor.admit("laying out the forest", about.saturating_mul(160), "take a smaller area")?;
        let key = Key::new(layout.seed).named("forest");
        let points = poisson_disc(area_m, spacing_m, key.named("spacing"), monitor)?;
        let fitting = points.len() as u64;
        let asked = layout.trees.unwrap_or(fitting);
        if asked > fitting {
            return Err(ForestError::Room { asked, fitting, spacing_m, area_m });
        }
        // A random order: which of them stay, and which kind each is, has nothing to do with where.
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_key(|&i| (key.named("order").child(i as u64).bits(), i));
        order.truncate(asked as usize);
        let mut places = Vec::with_capacity(order.len());
        let counts = self.counts(order.len());
        let mut next = order.into_iter();
        for (kind, count) in counts.into_iter().enumerate() {
            for point in next.by_ref().take(count) {
                places.push((point, self.place(kind, point, points[point], key)));
            }
        }
        // Listed as they were found, each beside its neighbours.
        places.sort_by_key(|(point, _)| *point);
        let mut trees = self.trees(key);
        let mut places: Vec<Place> = places.into_iter().map(|(_, place)| place).collect();
        if layout.compete {
            return self.competing(&trees, places);
        }
        drop_unused(&mut trees, &mut places);
        Ok(Plan { trees, places })
    }

    /// Each kind once, as it is and where it is.
    fn where_they_are(&self) -> Result<Plan, ForestError> {
        let mut trees: Vec<PlannedTree> = Vec::new();
        let mut stand: Vec<(String, [f64; 3])> = Vec::new();
        for (index, kind) in self.kinds.iter().enumerate() {
            let mut recipe = kind.recipe.clone();
            let preset = &mut recipe.preset;
            let id = linden_base::knob::printable(&preset.id);
            // A mesh or a scan stands where its file has it, anything else where its root is.
            let place = preset.generator.stay();
            if let Some(place) = place {
                if let Some((first, _)) = stand.iter().find(|(_, other)| *other == place) {
                    return Err(ForestError::SamePlace { first: first.clone(), second: id });
                }
                stand.push((id, place));
            }
            let name = kind_name(&kind.recipe);
            let before =
                self.kinds[..index].iter().filter(|earlier| kind_name(&earlier.recipe) == name).count();
            let name = if before == 0 { name } else { format!("{name} {}", before + 1) };
            trees.push(PlannedTree { name, kind: index, recipe, stems: 1, notes: Vec::new() });
        }
        let place = |(plant, kind): (usize, &ForestKind)| Place {
            plant,
            position: Vec3::ZERO,
            turn_rad: 0.0,
            scale: kind.size as f32,
        };
        Ok(Plan { trees, places: self.kinds.iter().enumerate().map(place).collect() })
    }

    /// All places as one tree, that of the place nearest to the middle.
    fn competing(&self, trees: &[PlannedTree], mut places: Vec<Place>) -> Result<Plan, ForestError> {
        if self.kinds.len() > 1 {
            return Err(ForestError::Mixed { kinds: self.kinds.len() });
        }
        let from_middle = |place: &Place| place.position.length_squared();
        places.sort_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
        let (Some(tree), Some(&first)) = (trees.first(), places.first()) else {
            return Err(ForestError::Empty);
        };
        let Stand { tree, scale } = Stand::new(tree, &places, &self.kinds[0], &self.layout)?;
        Ok(Plan { trees: vec![tree], places: vec![Place { plant: 0, turn_rad: 0.0, scale, ..first }] })
    }

    /// How many trees of each kind: by largest remainders, so that the shares are kept as exactly as
    /// whole trees can.
    fn counts(&self, trees: usize) -> Vec<usize> {
        let sum: f64 = self.kinds.iter().map(|kind| kind.share).sum();
        let exact: Vec<f64> = self.kinds.iter().map(|kind| kind.share / sum * trees as f64).collect();
        let mut counts: Vec<usize> = exact.iter().map(|x| x.floor() as usize).collect();
        let mut by_remainder: Vec<usize> = (0..counts.len()).collect();
        by_remainder.sort_by(|&a, &b| {
            let rest = |i: usize| exact[i] - exact[i].floor();
            rest(b).total_cmp(&rest(a)).then(a.cmp(&b))
        });
        let missing = trees.saturating_sub(counts.iter().sum());
        for i in by_remainder.into_iter().cycle().take(missing) {
            counts[i] += 1;
        }
        counts
    }

    fn place(&self, kind: usize, point: usize, [x, z]: [f64; 2], key: Key) -> Place {
        let Self { layout, kinds, .. } = self;
        let place_key = key.named("place").child(point as u64);
        let which = (place_key.named("which").unit() * layout.distinct as f64) as usize;
        let spread = place_key.named("size").between(1.0 - layout.size_spread, 1.0 + layout.size_spread);
        Place {
            plant: kind * layout.distinct as usize + which,
            position: DVec3::new(x, 0.0, z).as_vec3(),
            turn_rad: (place_key.named("turn").unit() * TAU) as f32,
            scale: (kinds[kind].size * spread) as f32,
        }
    }

    /// All distinct trees, each with another seed.
    fn trees(&self, key: Key) -> Vec<PlannedTree> {
        let mut trees: Vec<PlannedTree> = Vec::new();
        for (index, kind) in self.kinds.iter().enumerate() {
            let kind_name = kind_name(&kind.recipe);
            // The same preset may be there twice, with other settings.
            let before = self.kinds[..index]
                .iter()
                .filter(|earlier| self::kind_name(&earlier.recipe) == kind_name)
                .count();
            for number in 0..self.layout.distinct {
                let mut recipe = kind.recipe.clone();
                // 32 bits, so that people can type it.
                recipe.preset.set_seed(key.named("tree").child(index as u64).child(number).bits() >> 32);
                let number = before as u64 * self.layout.distinct + number + 1;
                trees.push(PlannedTree {
                    name: format!("{kind_name} {number}"),
                    kind: index,
                    recipe,
                    stems: 1,
                    notes: Vec::new(),
                });
            }
        }
        trees
    }
}

/// What people call it.
fn kind_name(recipe: &Recipe) -> String {
    let preset = &recipe.preset;
    let name = if preset.name.trim().is_empty() { &preset.id } else { &preset.name };
    linden_base::knob::printable(name)
}

/// Leaves out trees that stand nowhere.
fn drop_unused(trees: &mut Vec<PlannedTree>, places: &mut [Place]) {
    let mut is_used = vec![false; trees.len()];
    for place in &*places {
        is_used[place.plant] = true;
    }
    let mut kept = 0;
    let renumbered: Vec<usize> = is_used
        .iter()
        .map(|&used| {
            kept += usize::from(used);
            kept.saturating_sub(1)
        })
        .collect();
    for place in places {
        place.plant = renumbered[place.plant];
    }
    let mut used = is_used.into_iter();
    trees.retain(|_| used.next().unwrap_or(false));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::{Layout, LayoutError};
    use crate::preset::{MOST_NODES, Neighbour, Preset, SelfOrganizing, builtin};
    use linden_base::monitor::Quiet;

    fn forest(settings: &[(&str, &str)]) -> Forest {
        let recipe = |id: &str| Recipe::new(builtin(id).unwrap().load().unwrap());
        let mut forest = Forest::of(vec![recipe("fir"), recipe("simple"), recipe("cypress")]);
        for (kind, share) in forest.kinds.iter_mut().zip([3.0, 2.0, 1.0]) {
            kind.share = share;
        }
        for (name, value) in settings {
            forest.layout.set(name, value).unwrap();
        }
        forest
    }

    #[test]
    fn shares_are_kept_and_trees_stand_apart() {
        let plan = forest(&[("trees", "60"), ("distinct", "2")]).plan(&Quiet).unwrap();
        assert_eq!(plan.places.len(), 60);
        assert_eq!(plan.trees.len(), 6);
        let of = |kind: usize| plan.places.iter().filter(|place| place.plant / 2 == kind).count();
        assert_eq!([of(0), of(1), of(2)], [30, 20, 10]);
        for (i, a) in plan.places.iter().enumerate() {
            assert!(plan.places[..i].iter().all(|b| a.position.distance(b.position) >= 4.9999));
            assert!((0.8..=1.2).contains(&a.scale));
        }
        let mut seeds: Vec<u64> = plan.trees.iter().map(|tree| tree.recipe.preset.seed()).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 6);
        let names: Vec<&str> = plan.trees.iter().map(|tree| tree.name.as_str()).collect();
        assert!(
            names.iter().all(|name| names.iter().filter(|other| *other == name).count() == 1),
            "{names:?}"
        );
    }

    #[test]
    fn trees_are_numbered_within_what_their_kind_is_called() {
        let unnamed = |id: &str| {
            let mut recipe = Recipe::new(builtin("fir").unwrap().load().unwrap());
            (recipe.preset.id, recipe.preset.name) = (id.to_owned(), " ".to_owned());
            recipe
        };
        let mut forest = Forest::of(vec![unnamed("a"), unnamed("b"), unnamed("a")]);
        for (knob, value) in [("trees", "30"), ("distinct", "1")] {
            forest.layout.set(knob, value).unwrap();
        }
        let names: Vec<String> =
            forest.plan(&Quiet).unwrap().trees.into_iter().map(|tree| tree.name).collect();
        assert_eq!(names, ["a 1", "b 1", "a 2"]);
    }

    #[test]
    fn trees_that_compete_are_one_growth_with_a_root_at_each_place() {
        let kind = |id: &str| Recipe::new(builtin(id).unwrap().load().unwrap());
        // A plain crown, one that is put together, and a tree that grows by light.
        for id in ["dressed-simple", "drawn-oak", "apple"] {
            let mut forest = Forest::of(vec![kind(id)]);
            for (knob, value) in [("area", "40"), ("spacing", "8"), ("trees", "5"), ("distinct", "1")] {
                forest.layout.set(knob, value).unwrap();
            }
            let apart = forest.plan(&Quiet).unwrap();
            forest.layout.set("compete", "true").unwrap();
            let plan = forest.plan(&Quiet).unwrap();
            let ([tree], [place]) = (plan.trees.as_slice(), plan.places.as_slice()) else { panic!("one") };
            assert_eq!(tree.stems, 5, "{id}");
            let grown = crate::grow::grow(&tree.recipe, &Quiet).unwrap();
            let skeleton = &grown.skeleton;
            let stems = skeleton.axes.iter().filter(|axis| axis.parent == linden_skeleton::NO_PARENT);
            let feet = stems.map(|axis| {
                let foot = skeleton.positions[skeleton.nodes_of(axis)[0] as usize];
                place.position + foot * place.scale
            });
            let in_cm = |places: Vec<glam::Vec3>| {
                let mut places: Vec<[i32; 2]> =
                    places.iter().map(|at| [at.x, at.z].map(|x| libm::roundf(x * 100.0) as i32)).collect();
                places.sort_unstable();
                places
            };
            let wanted = in_cm(apart.places.iter().map(|place| place.position).collect());
            assert_eq!(in_cm(feet.collect()), wanted, "{id}: a foot at each place, to a centimetre");
        }
        let refused = |ids: &[&str], settings: &[(&str, &str)]| {
            let mut forest = Forest::of(ids.iter().map(|id| kind(id)).collect());
            for (knob, value) in [("compete", "true")].iter().chain(settings) {
                forest.layout.set(knob, value).unwrap();
            }
            forest.plan(&Quiet).unwrap_err().to_string()
        };
        assert!(refused(&["fir", "oak"], &[]).contains("2 kinds"));
        assert!(refused(&["abop-a"], &[]).contains("'abop-a' does not compete: it grows by an L-system"));
        assert!(refused(&["grove"], &[]).contains("put together of trees"));
        assert!(refused(&["wp-black-oak"], &[]).contains("by Weber and Penn's parameters"));
        let said = refused(&["fir"], &[("area", "100"), ("spacing", "2")]);
        assert!(said.contains("more than the 257") && said.contains("trees=257"), "{said}");
        let said = refused(&["oak"], &[("area", "400"), ("spacing", "2")]);
        assert!(said.contains("more than the 10000") && said.contains("trees=10000"), "{said}");
        let stand = "id = \"stand\"\n[self-organizing]\n[[self-organizing.tree]]\nat = [3, 0, 0]\n";
        let mut forest = Forest::of(vec![Recipe::new(Preset::from_toml(stand).unwrap())]);
        forest.layout.compete = true;
        let said = forest.plan(&Quiet).unwrap_err().to_string();
        assert!(said.contains("several trees already") && said.contains("'oak'"), "{said}");
        // Obstacles are beside each tree, of which there are fewer then.
        let lamp = "id = \"lamp\"\n[self-organizing]\n[[self-organizing.obstacle]]\nbox = [1, 2, 3]\nat = [2, 0, 0]\n";
        let mut forest = Forest::of(vec![Recipe::new(Preset::from_toml(lamp).unwrap())]);
        forest.layout.compete = true;
        let plan = forest.plan(&Quiet).unwrap();
        let rules = plan.trees[0].recipe.preset.settings::<SelfOrganizing>().unwrap();
        assert_eq!(rules.obstacles.len(), rules.stand.len() + 1);
        let [x, z] = rules.stand[4].at;
        assert_eq!(rules.obstacles[5].at, Some([x + 2.0, 0.0, z]));
        forest.layout.set("area", "200").unwrap();
        let said = forest.plan(&Quiet).unwrap_err().to_string();
        assert!(said.contains("more than the 256 that compete"), "{said}");
    }

    #[test]
    fn trees_that_compete_for_light_grow_by_the_same_rules() {
        let mut forest = Forest::of(vec![Recipe::new(builtin("oak").unwrap().load().unwrap())]);
        forest.kinds[0].size = 2.0;
        for (knob, value) in [("area", "30"), ("spacing", "4"), ("trees", "12"), ("size_spread", "0.5")] {
            forest.layout.set(knob, value).unwrap();
        }
        let apart = forest.plan(&Quiet).unwrap();
        forest.layout.compete = true;
        let plan = forest.plan(&Quiet).unwrap();
        let ([tree], [place]) = (plan.trees.as_slice(), plan.places.as_slice()) else { panic!("one") };
        assert_eq!((tree.stems, place.scale, place.turn_rad), (12, 2.0, 0.0), "the size of the kind is kept");
        let rules = tree.recipe.preset.settings::<SelfOrganizing>().unwrap();
        let foot = |tree: &Neighbour| {
            let [x, z] = tree.at;
            place.position + DVec3::new(x, 0.0, z).as_vec3() * place.scale
        };
        let feet: Vec<Vec3> = rules.stand.iter().map(foot).chain([place.position]).collect();
        for wanted in apart.places {
            assert!(feet.iter().any(|foot| foot.distance(wanted.position) < 1e-4), "{}", wanted.position);
        }
        assert_eq!(rules.max_nodes, MOST_NODES, "as many nodes for each, up to what the knob takes");
        assert!(matches!(tree.notes.as_slice(), [note] if note.contains("size_spread")), "{:?}", tree.notes);
        forest.layout.size_spread = Layout::default().size_spread;
        assert!(forest.plan(&Quiet).unwrap().trees[0].notes.is_empty(), "nobody asked for it");
    }

    #[test]
    fn fields_out_of_their_knobs_ranges_are_refused() {
        let sound = Layout::default();
        for (knob, layout) in [
            ("distinct", Layout { distinct: 0, ..sound }),
            ("distinct", Layout { distinct: u64::MAX, ..sound }),
            ("area", Layout { area_m: f64::NAN, ..sound }),
            ("spacing", Layout { spacing_m: f64::NAN, ..sound }),
            ("spacing", Layout { spacing_m: 0.0, ..sound }),
            ("size_spread", Layout { size_spread: 5.0, ..sound }),
            ("trees", Layout { trees: Some(0), ..sound }),
        ] {
            let mut forest = forest(&[]);
            forest.layout = layout;
            let error = forest.plan(&Quiet).unwrap_err();
            let ForestError::Layout(LayoutError::Value { name, .. }) = &error else { panic!("{error}") };
            assert_eq!(*name, knob);
            assert!(error.to_string().contains("outside the range"), "{error}");
        }
    }

    #[test]
    fn a_tree_that_stands_nowhere_is_not_grown() {
        let plan = forest(&[("trees", "2"), ("distinct", "9")]).plan(&Quiet).unwrap();
        assert_eq!(plan.places.len(), 2);
        assert_eq!(plan.trees.len(), 2);
        assert!(plan.places.iter().all(|place| place.plant < 2));
    }

    #[test]
    fn more_than_fit_is_refused_with_both_figures() {
        let asking = forest(&[("area", "20"), ("trees", "500")]);
        let said = asking.plan(&Quiet).unwrap_err().to_string();
        let fitting = forest(&[("area", "20")]).plan(&Quiet).unwrap().places.len();
        assert!(said.contains("500 trees") && said.contains(&format!("where {fitting} find room")), "{said}");
        let said = forest(&[("area", "10000"), ("spacing", "0.05")]).plan(&Quiet).unwrap_err().to_string();
        assert!(said.contains("more than 1000000"), "{said}");
        let said = forest(&[("area", "20"), ("spacing", "21")]).plan(&Quiet).unwrap_err().to_string();
        assert!(said.contains("21 m apart on 20 m") && said.contains("trees=1"), "{said}");
        let alone = forest(&[("area", "20"), ("spacing", "21"), ("trees", "1")]);
        assert_eq!(alone.plan(&Quiet).unwrap().places.len(), 1);
        let mut none = forest(&[]);
        none.kinds[1].share = 0.0;
        assert!(none.plan(&Quiet).unwrap_err().to_string().contains("'simple'"));
        none.kinds.clear();
        assert!(matches!(none.plan(&Quiet), Err(ForestError::Empty)));
    }
}
