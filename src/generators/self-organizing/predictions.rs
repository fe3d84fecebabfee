//! What the method predicts, tested on small trees: by definition, by brute force, by exact identities.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};
use linden_base::monitor::Quiet;
use linden_base::random::Key;
use linden_skeleton::{Axis, Branching, Edge, NO_PARENT, Skeleton, Wood};

use crate::grow::Growth;
use crate::light::FULL_LIGHT;
use crate::shadow::{LightGrid, Shadow};
use crate::share::Shares;
use crate::sums::Sums;
use crate::tree::{APEX, LATERAL};
use crate::{
    Barriers, Grown, LightModel, Phyllotaxis, Planted, SelfOrganizing, SelfOrganizingError, Sharing, grow,
    grow_among, grow_stand,
};

/// The settings of most measurements.
fn measured() -> SelfOrganizing {
    SelfOrganizing { shed: 0.3, shed_patience: 1, ..SelfOrganizing::default() }
}

/// Those of the sweep over λ.
fn denser(leader: f64) -> SelfOrganizing {
    SelfOrganizing { years: 18, leader: vec![leader], shade: 0.1, shade_falloff: 1.5, ..measured() }
}

fn hash(grown: Grown) -> u128 {
    Skeleton::build(grown.branching, &Wood::default()).unwrap().hash()
}

fn grown(settings: &SelfOrganizing, seed: u64) -> Grown {
    grow(settings, Key::new(seed), &Quiet).unwrap()
}

fn height_m(grown: &Grown) -> f64 {
    grown.branching.positions.iter().map(|place| f64::from(place.y)).fold(0.0, f64::max)
}

/// Grows a seedling at a place, in voxels, year by year.
fn seedling(settings: &SelfOrganizing, place: DVec3, side: DVec3) -> Growth<'_> {
    let mut growth = Growth::new(settings);
    growth.plant(place, DVec3::Y, side, Key::new(5));
    growth
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

#[test]
fn light_after_growth_shedding_and_bending_is_that_of_the_living_nodes_in_every_voxel() {
    let settings = SelfOrganizing { light_from: [0.4, 1.0, 0.1], sag: 1.0, ..measured() };
    let mut growth = seedling(&settings, DVec3::new(0.5, 0.0, 0.5), DVec3::X);
    (0..18).for_each(|_| growth.grow_year(&Quiet).unwrap());
    assert!(growth.shed > 100, "{}", growth.shed);
    let Shadow { grid, pyramid } = growth.light.shadow().clone();
    let mut anew = LightGrid::default();
    for node in (0..growth.nodes.len()).rev().filter(|&node| !growth.nodes.is_foot(node)) {
        anew.add(growth.nodes.voxel(node), &pyramid, &Quiet).unwrap();
    }
    let mut shaded = 0;
    for x in -60..60 {
        for y in 0..120 {
            for z in -60..60 {
                assert_eq!(grid.shade([x, y, z]), anew.shade([x, y, z]), "{x} {y} {z}");
                shaded += u32::from(anew.shade([x, y, z]) > 0);
            }
        }
    }
    assert!(shaded > 5000, "{shaded}");
}

#[test]
fn any_number_of_threads_grows_the_same_tree() {
    let shadow = SelfOrganizing { years: 24, ..SelfOrganizing::default() };
    let sky = SelfOrganizing { light: LightModel::Sky, shade: 0.2, sag: 0.3, ..shadow.clone() };
    for settings in [shadow, sky] {
        let [one, eight] = [1, 8].map(|threads| on_threads(threads, || grown(&settings, 3)));
        assert!(one.branching.positions.len() > 4096, "chunks of nodes: {}", one.branching.positions.len());
        assert_eq!(hash(one), hash(eight));
    }
}

#[test]
fn what_is_shared_is_vigor_times_the_light_of_all_buds() {
    for sharing in [Sharing::BorchertHonda, Sharing::Priority] {
        let settings = SelfOrganizing { sharing, phyllotaxis: Phyllotaxis::Opposite, ..measured() };
        let mut growth = seedling(&settings, DVec3::new(0.5, 0.0, 0.5), DVec3::X);
        for year in 1..15 {
            growth.grow_year(&Quiet).unwrap();
            let nodes = &growth.nodes;
            let sums = Sums::new(nodes, &growth.light);
            let shares = Shares::new(nodes, &sums, &settings, year);
            let bud = |node: usize| {
                let apex = if nodes.is(node, APEX) { shares.onward[node] } else { 0.0 };
                apex + shares.bud[node] * f64::from(nodes.buds[node].count_ones())
            };
            let light = |node: usize| {
                let buds = u32::from(nodes.is(node, APEX)) + nodes.buds[node].count_ones();
                u64::from(sums.light[node]) * u64::from(buds)
            };
            let given: f64 = (0..nodes.len()).map(bud).sum();
            let all: u64 = (0..nodes.len()).map(light).sum();
            let expected = settings.vigor_in(year) * all as f64 / f64::from(FULL_LIGHT);
            assert_eq!(all, sums.total(0));
            assert!((given / expected - 1.0).abs() < 1e-12, "{sharing:?} {given} {expected}");
        }
    }
}

#[test]
fn a_fork_loses_nothing() {
    let settings = measured();
    let mut growth = seedling(&settings, DVec3::new(0.5, 0.0, 0.5), DVec3::X);
    (0..12).for_each(|_| growth.grow_year(&Quiet).unwrap());
    let nodes = &growth.nodes;
    let sums = Sums::new(nodes, &growth.light);
    let shares = Shares::new(nodes, &sums, &settings, 12);
    let mut forks = 0;
    for node in (0..nodes.len()).filter(|&node| nodes.parents[node] != NO_PARENT && nodes.is(node, LATERAL)) {
        // With one lateral a node, it gets all that does not go on.
        let parent = nodes.parents[node] as usize;
        assert_eq!(shares.flow[node], shares.flow[parent] - shares.onward[parent]);
        forks += 1;
    }
    assert!(forks > 20, "{forks}");
}

#[test]
fn without_preference_each_bud_gets_what_its_light_is_worth() {
    let even = SelfOrganizing { leader: vec![0.5], ..denser(0.5) };
    let mut growth = seedling(&even, DVec3::new(0.5, 0.0, 0.5), DVec3::X);
    (0..14).for_each(|_| growth.grow_year(&Quiet).unwrap());
    let nodes = &growth.nodes;
    let sums = Sums::new(nodes, &growth.light);
    let shares = Shares::new(nodes, &sums, &even, 15);
    for node in 0..nodes.len() {
        let worth = even.vigor * f64::from(sums.light[node]) / f64::from(FULL_LIGHT);
        let got = [
            nodes.is(node, APEX).then_some(shares.onward[node]),
            (nodes.buds[node] > 0).then_some(shares.bud[node]),
        ];
        assert!(got.into_iter().flatten().all(|got| (got - worth).abs() < 1e-9), "{node}: {got:?} {worth}");
    }
    // So that both models grow the same tree.
    for phyllotaxis in [Phyllotaxis::Spiral, Phyllotaxis::Opposite] {
        let even = SelfOrganizing { phyllotaxis, ..even.clone() };
        let equal = SelfOrganizing { sharing: Sharing::Priority, priority_least: 1.0, ..even.clone() };
        let trees = [grown(&even, 2), grown(&equal, 2)];
        assert!(trees[0].branching.positions.len() > 100);
        let [one, other] = trees.map(hash);
        assert_eq!(one, other);
    }
}

/// The length of the main axis ÷ that of the longest lateral axis.
fn leader_ratio(grown: Grown) -> f64 {
    let tree = Skeleton::build(grown.branching, &Wood::default()).unwrap();
    let paths = tree.path_lengths_m();
    let length = |axis: &Axis| {
        let last = tree.nodes_of(axis).last().map_or(0.0, |&last| paths[last as usize]);
        last - if axis.parent == NO_PARENT { 0.0 } else { paths[axis.parent as usize] }
    };
    let stem = length(&tree.axes[0]);
    stem / tree.axes[1..].iter().map(length).fold(0.0, f64::max)
}

#[test]
fn leaders_rise_with_lambda_from_bushes_to_conifers() {
    let mean = |leader| (0..5).map(|seed| leader_ratio(grown(&denser(leader), seed))).sum::<f64>() / 5.0;
    let ratios = [0.46, 0.50, 0.54, 0.58].map(mean);
    println!("ratios {ratios:?}");
    assert!(ratios.is_sorted(), "{ratios:?}");
    assert!(ratios[0] < 0.8, "{ratios:?}");
    assert!((0.8..1.2).contains(&ratios[1]), "{ratios:?}");
    assert!(ratios[2] > 1.25 && ratios[3] > 1.7, "{ratios:?}");
}

/// Trees 5 × 5 some metres apart, the inner one first, so that its key is the same at any distance.
fn stand(spacing_m: f32, seed: u64) -> Branching {
    let at = |i: i32| (i - 2) as f32 * spacing_m;
    let mut feet = vec![Vec3::ZERO];
    feet.extend((0..25).filter(|&i| i != 12).map(|i| Vec3::new(at(i % 5), 0.0, at(i / 5))));
    let settings = SelfOrganizing { years: 16, ..measured() };
    grow_stand(&settings, &feet, Key::new(seed), &Quiet).unwrap().branching
}

/// For each node of a stand the number of its tree, and whether it is on a lateral.
fn trees_of(stand: &Branching) -> Vec<(usize, bool)> {
    let mut of: Vec<(usize, bool)> = Vec::new();
    let mut feet = 0;
    for (&parent, &edge) in stand.parents.iter().zip(stand.edges.as_ref().unwrap()) {
        if parent == NO_PARENT {
            of.push((feet, false));
            feet += 1;
        } else {
            let (tree, is_lateral) = of[parent as usize];
            of.push((tree, is_lateral || edge == Edge::Branches));
        }
    }
    of
}

fn quantile(mut values: Vec<f32>, share: f64) -> f64 {
    values.sort_by(f32::total_cmp);
    values.get((values.len() as f64 * share) as usize).map_or(0.0, |&value| f64::from(value))
}

/// Of the inner tree: the base of its crown ÷ its height, living internodes, crown radius, radius of its foot.
fn inner(spacing_m: f32, seed: u64) -> [f64; 4] {
    let stand = stand(spacing_m, seed);
    let of = trees_of(&stand);
    let places = |is_wanted: fn(&(usize, bool)) -> bool| -> Vec<Vec3> {
        of.iter().zip(&stand.positions).filter(|(of, _)| is_wanted(of)).map(|(_, place)| *place).collect()
    };
    let (all, laterals) = (places(|of| of.0 == 0), places(|of| *of == (0, true)));
    let height = all.iter().map(|place| place.y).fold(0.0, f32::max);
    let base = quantile(laterals.iter().map(|place| place.y / height).collect(), 0.05);
    let radius = quantile(laterals.iter().map(|place| place.x.hypot(place.z)).collect(), 0.95);
    let foot = f64::from(stand.radii.as_ref().unwrap()[0]);
    [base, all.len() as f64, radius, foot]
}

#[test]
fn a_close_stand_lifts_its_crowns_and_a_wide_one_does_not() {
    let mean = |spacing_m| {
        let of: Vec<[f64; 4]> = (0..4).map(|seed| inner(spacing_m, seed)).collect();
        [0, 1, 2, 3].map(|i| of.iter().map(|each| each[i]).sum::<f64>() / 4.0)
    };
    let open = mean(40.0);
    // 1.8 and 0.7 radii of a crown in the open.
    let [wide, close] = [1.8, 0.7].map(|radii| mean((radii * open[2]) as f32));
    println!("open {open:?} wide {wide:?} close {close:?}");
    assert!((wide[1] / open[1] - 1.0).abs() < 0.1, "{open:?} {wide:?}");
    assert!((wide[2] / open[2] - 1.0).abs() < 0.1, "{open:?} {wide:?}");
    assert!(close[0] > open[0] + 0.3, "{open:?} {close:?}");
    assert!(close[1] < open[1] / 3.0, "{open:?} {close:?}");
    assert!(close[3] < open[3], "{open:?} {close:?}");
}

#[test]
fn crowns_keep_apart() {
    for spacing_m in [2.0, 1.4, 1.0] {
        let stand = stand(spacing_m, 1);
        let mut trees: BTreeMap<[i32; 3], BTreeSet<usize>> = BTreeMap::new();
        for (place, (tree, _)) in stand.positions.iter().zip(trees_of(&stand)) {
            trees.entry((*place * 5.0).floor().to_array().map(|v| v as i32)).or_default().insert(tree);
        }
        let shared = trees.values().filter(|trees| trees.len() > 1).count();
        println!("{spacing_m} m: {shared} of {}", trees.len());
        assert!(shared * 50 < trees.len(), "{spacing_m} m: {shared} of {}", trees.len());
    }
}

#[test]
fn where_seedlings_stand_close_few_are_left() {
    let settings = SelfOrganizing { years: 24, ..measured() };
    let feet: Vec<Vec3> =
        (0..400).map(|i| Vec3::new((i % 20) as f32 * 0.2, 0.0, (i / 20) as f32 * 0.2)).collect();
    let trees = |years| {
        let settings = SelfOrganizing { years, ..settings.clone() };
        let stand = grow_stand(&settings, &feet, Key::new(1), &Quiet).unwrap().branching;
        let is_foot = |(parent, _): &(&u32, &f32)| **parent == NO_PARENT;
        let radii: Vec<f64> = stand
            .parents
            .iter()
            .zip(stand.radii.as_ref().unwrap())
            .filter(is_foot)
            .map(|(_, &radius)| f64::from(radius))
            .collect();
        (radii.len(), radii.iter().sum::<f64>() / radii.len() as f64)
    };
    let years = [4, 8, 12, 16, 24].map(trees);
    println!("{years:?}");
    assert!(years.is_sorted_by(|a, b| a.0 >= b.0 && a.1 < b.1), "{years:?}");
    assert!(years[0].0 == 400 && years[4].0 < 200, "{years:?}");
}

#[test]
fn more_is_shed_and_less_lives_as_the_threshold_rises() {
    let of = |shed| {
        let trees: Vec<Grown> =
            (0..3).map(|seed| grown(&SelfOrganizing { shed, ..measured() }, seed)).collect();
        let living: usize = trees.iter().map(|tree| tree.branching.positions.len() - 1).sum();
        let shed: u64 = trees.iter().map(|tree| tree.shed).sum();
        (living, shed as f64 / (shed as f64 + living as f64))
    };
    let steps = [0.0, 0.1, 0.2, 0.3, 0.4].map(of);
    println!("{steps:?}");
    assert_eq!(steps[0].1, 0.0, "a threshold of 0 sheds nothing");
    assert!(steps.is_sorted_by(|a, b| a.0 > b.0), "{steps:?}");
    assert!(steps[..4].is_sorted_by(|a, b| a.1 < b.1), "{steps:?}");
}

#[test]
fn what_shades_never_brightens_and_trees_keep_out_of_the_dark() {
    let settings = measured();
    let mut growth = seedling(&settings, DVec3::new(0.5, 0.0, 0.5), DVec3::X);
    (0..12).for_each(|_| growth.grow_year(&Quiet).unwrap());
    let before = Sums::new(&growth.nodes, &growth.light);
    let Shadow { grid, pyramid } = growth.light.shadow();
    grid.add([3, 30, 2], pyramid, &Quiet).unwrap();
    grid.add([-2, 14, 0], pyramid, &Quiet).unwrap();
    let after = Sums::new(&growth.nodes, &growth.light);
    assert!(before.light.iter().zip(&after.light).all(|(before, after)| after <= before));
    assert!(after.total(0) < before.total(0));

    let (mut dark, mut lit) = (0, 0);
    for seed in 0..4 {
        let mut growth = Growth::new(&settings);
        growth
            .light
            .shadow()
            .grid
            .add_box([-120, 0, -120], [-1, 240, 120], FULL_LIGHT * 6 / 10, &Quiet)
            .unwrap();
        growth.plant(DVec3::new(0.5, 0.0, 0.5), DVec3::Y, DVec3::X, Key::new(seed));
        (0..20).for_each(|_| growth.grow_year(&Quiet).unwrap());
        let in_dark = growth.nodes.places.iter().filter(|place| place.x < 0.0).count();
        dark += in_dark;
        lit += growth.nodes.len() - in_dark;
    }
    println!("dark {dark} lit {lit}");
    assert!(3 * dark <= lit, "{dark} {lit}");
}

#[test]
fn under_the_sky_a_crown_has_no_storeys_and_a_bole_no_branches() {
    // Nodes in layers of an internode from a quarter of the height to three quarters: the thinnest ÷ the mean.
    let evenness = |settings: &SelfOrganizing| {
        let tree = grown(settings, 2);
        let height = height_m(&tree);
        let mut layers = [0.0_f64; 24];
        for place in &tree.branching.positions {
            let at = (f64::from(place.y) / height - 0.25) * 48.0;
            if (0.0..24.0).contains(&at) {
                layers[at as usize] += 1.0;
            }
        }
        layers.iter().copied().fold(f64::INFINITY, f64::min) * 24.0 / layers.iter().sum::<f64>()
    };
    let shadow = SelfOrganizing {
        years: 36,
        shade: 0.1,
        shade_falloff: 1.6,
        shade_depth: 10,
        leader: vec![0.55, 0.52],
        ..SelfOrganizing::default()
    };
    let sky = SelfOrganizing { light: LightModel::Sky, shade: 0.3, ..shadow.clone() };
    let [storeys, dome] = [evenness(&shadow), evenness(&sky)];
    println!("shadow {storeys:.2} sky {dome:.2}");
    assert!(dome > 1.3 * storeys, "{dome} {storeys}");

    let browsed = SelfOrganizing { bole_m: 1.5, years: 20, ..sky };
    let tree = grown(&browsed, 2).branching;
    let edges = tree.edges.unwrap();
    let low = (0..edges.len()).filter(|&node| edges[node] == Edge::Branches && tree.positions[node].y < 1.5);
    assert_eq!(low.count(), 0);
    assert!(edges.iter().filter(|&&edge| edge == Edge::Branches).count() > 100);
}

#[test]
fn mirrored_seedlings_grow_mirrored_trees() {
    let right = SelfOrganizing { jitter: 0.0, shed: 0.2, years: 16, ..measured() };
    let left = SelfOrganizing { divergence_deg: -right.divergence_deg, ..right.clone() };
    // Off the edges of voxels, which belong to one side.
    let (place, side) = (DVec3::new(0.37, 0.0, 0.21), DVec3::new(0.8, 0.0, 0.6));
    let mirror = DVec3::new(-1.0, 1.0, 1.0);
    let mut trees = [seedling(&right, place, side), seedling(&left, place * mirror, side * mirror)];
    for tree in &mut trees {
        (0..16).for_each(|_| tree.grow_year(&Quiet).unwrap());
    }
    let [right, left] = trees.map(|tree| tree.nodes);
    assert!(right.len() > 500, "{}", right.len());
    assert_eq!(right.parents, left.parents);
    let apart = right.places.iter().zip(&left.places).map(|(a, b)| (*a * mirror.as_vec3() - *b).length());
    assert!(apart.fold(0.0, f32::max) < 1e-4);
}

#[test]
fn branches_sink_under_their_weight_and_keep_their_lengths() {
    // The same tree without light to answer to: only bending differs.
    let straight = SelfOrganizing { light_pull: 0.0, shade: 0.0, shed: 0.0, years: 5, ..measured() };
    let mean = |grown: &Grown, sideways: bool| {
        let part = |place: &Vec3| f64::from(if sideways { place.x.hypot(place.z) } else { place.y });
        grown.branching.positions.iter().map(part).sum::<f64>() / grown.branching.positions.len() as f64
    };
    let trees: Vec<Grown> =
        [0.0, 0.3, 1.0].map(|sag| grown(&SelfOrganizing { sag, ..straight.clone() }, 6)).into();
    println!("{:?}", trees.iter().map(|tree| [mean(tree, false), mean(tree, true)]).collect::<Vec<_>>());
    let parents = |tree: &Grown| tree.branching.parents.clone();
    assert!(trees.iter().all(|tree| parents(tree) == parents(&trees[0])));
    assert!(trees.is_sorted_by(|a, b| mean(a, false) > mean(b, false)));
    let lengths = |tree: &Grown| -> Vec<f32> {
        let Branching { positions, parents, .. } = &tree.branching;
        let nodes = positions.iter().zip(parents).filter(|(_, parent)| **parent != NO_PARENT);
        nodes.map(|(place, &parent)| place.distance(positions[parent as usize])).collect()
    };
    let apart = lengths(&trees[0]).into_iter().zip(lengths(&trees[1])).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f32::max) < 1e-4);
}

#[test]
fn branches_that_sank_rise_again_thin_ones_more_than_thick_ones() {
    let straight = SelfOrganizing { sag: 0.5, ..measured() };
    // How far internodes of limbs that are as thick as so many twigs, at least and at most, have turned down since they
    // grew, the mean, radians.
    let sunk = |righting| {
        let settings = SelfOrganizing { righting, ..straight.clone() };
        let mut growth = seedling(&settings, DVec3::new(0.5, 0.0, 0.5), DVec3::X);
        (0..25).for_each(|_| growth.grow_year(&Quiet).unwrap());
        let nodes = &growth.nodes;
        let pipes = nodes.pipes();
        [[2, 8], [60, 100_000]].map(|[least, most]| {
            let limbs = (0..nodes.len()).filter(|&node| nodes.orders[node] > 0);
            let limbs = limbs.filter(|&node| (least..most).contains(&pipes[node]));
            let inclination = |rise: f32| libm::acos(f64::from(rise.clamp(-1.0, 1.0)));
            let away: Vec<f64> = limbs
                .map(|node| inclination(nodes.directions[node].y) - inclination(nodes.rises[node]))
                .collect();
            assert!(away.len() > 20, "{}", away.len());
            away.iter().sum::<f64>() / away.len() as f64
        })
    };
    let [none, some, more] = [0.0, 1.0, 2.0].map(sunk);
    println!("{none:?} {some:?} {more:?}");
    for thickness in [0, 1] {
        assert!(none[thickness] > some[thickness] && some[thickness] > more[thickness], "{thickness}");
    }
    assert!(some[0] / none[0] < 0.9 * some[1] / none[1], "{none:?} {some:?}");
    // What does not sink has nothing to right.
    let upright = |righting| hash(grown(&SelfOrganizing { sag: 0.0, righting, ..straight.clone() }, 6));
    assert_eq!(upright(0.0), upright(1.0));
}

#[test]
fn refusals_say_what_to_turn() {
    let settings = SelfOrganizing { max_nodes: 500, ..measured() };
    let refused = grow(&settings, Key::new(1), &Quiet).unwrap_err();
    assert!(matches!(refused, SelfOrganizingError::TooManyNodes { limit: 500, .. }), "{refused}");
    assert!(refused.to_string().contains("raise max_nodes"), "{refused}");
    let nan = Vec3::new(0.0, 0.0, f32::NAN);
    for foot in [Vec3::new(0.0, 1.0, 0.0), Vec3::new(2e5, 0.0, 0.0), nan] {
        let refused = grow_stand(&measured(), &[Vec3::ZERO, foot], Key::new(1), &Quiet).unwrap_err();
        assert!(matches!(refused, SelfOrganizingError::Foot { number: 1, .. }), "{refused}");
    }
    let settings = SelfOrganizing { vigor: 0.5, ..measured() };
    let refused = grow(&settings, Key::new(1), &Quiet).unwrap_err();
    assert!(refused.to_string().contains("vigor=0.5: raise vigor"), "{refused}");
}

#[test]
fn heights_and_sizes_are_near_those_of_another_program() {
    // The measured table: means of nine trees, year 20.
    let trees: Vec<Grown> = (0..9).map(|seed| grown(&measured(), seed)).collect();
    let height = trees.iter().map(height_m).sum::<f64>() / 9.0;
    let living = trees.iter().map(|tree| tree.branching.positions.len()).sum::<usize>() / 9;
    println!("{height} m, {living} nodes");
    assert!((5.5..9.5).contains(&height), "{height}");
    assert!((1000..4200).contains(&living), "{living}");
}

#[test]
fn vigor_halves_in_equal_times_and_old_trees_slow_down() {
    let settings = SelfOrganizing { decline_from: 20, decline_years: Some(15.0), ..measured() };
    for (year, share) in [(1, 1.0), (20, 1.0), (35, 0.5), (50, 0.25), (65, 0.125)] {
        assert!((settings.vigor_in(year) / settings.vigor - share).abs() < 1e-12, "{year}");
    }
    let height = |years: u32, settings: &SelfOrganizing| {
        let grown = grown(&SelfOrganizing { years, ..settings.clone() }, 3);
        grown.branching.positions.iter().map(|place| place.y).fold(0.0, f32::max)
    };
    let (from, to) = (20, 40);
    let (steady, declining) = (measured(), settings);
    assert_eq!(height(from, &steady), height(from, &declining), "the same tree until then");
    let [steady, declining] =
        [steady, declining].map(|settings| height(to, &settings) - height(from, &settings));
    assert!(declining > 0.0 && declining < 0.8 * steady, "{declining} m of {steady} m");
}

#[test]
fn under_the_sky_trees_that_others_overtop_die_and_free_ones_do_not() {
    let settings = SelfOrganizing { light: LightModel::Sky, shade: 0.4, years: 24, shed: 0.25, ..measured() };
    let stand = |spacing_m: f32, settings: &SelfOrganizing| {
        let at = |i: i32| i as f32 * spacing_m;
        let feet: Vec<Vec3> = (0..36).map(|i| Vec3::new(at(i % 6), 0.0, at(i / 6))).collect();
        let grown = grow_stand(settings, &feet, Key::new(2), &Quiet).unwrap();
        let standing = grown.branching.parents.iter().filter(|&&parent| parent == NO_PARENT).count();
        assert_eq!(standing + grown.died, 36);
        grown.died
    };
    let died = [0.2, 0.4, 6.0].map(|spacing_m| stand(spacing_m, &settings));
    assert!(died[0] > 0 && died[1] > 0 && died[2] == 0, "{died:?}");
    assert_eq!(
        stand(0.2, &SelfOrganizing { shed: 0.0, ..settings }),
        0,
        "where nothing is shed, nothing dies"
    );
}

/// Trees about one that are felled when they are ten years old.
fn cleared(years: u32, felled_in: u32, settings: &SelfOrganizing) -> Grown {
    let settings = SelfOrganizing { years, ..settings.clone() };
    let at = |i: i32| (i - 1) as f32 * 1.2;
    let around = (0..9).filter(|&i| i != 4).map(|i| Vec3::new(at(i % 3), 0.0, at(i / 3)));
    let around = around.map(|foot| Planted { foot, felled_in });
    let trees: Vec<Planted> = [Planted::default()].into_iter().chain(around).collect();
    grow_among(&settings, &trees, &Barriers::default(), Key::new(6), &Quiet).unwrap()
}

#[test]
fn a_tree_spreads_where_its_neighbours_were_felled() {
    let first = |grown: &Grown| -> Vec<Vec3> {
        let of = trees_of(&grown.branching);
        of.iter()
            .zip(&grown.branching.positions)
            .filter(|(of, _)| of.0 == 0)
            .map(|(_, place)| *place)
            .collect()
    };
    for light in [LightModel::Shadow, LightModel::Sky] {
        let shade = if light == LightModel::Sky { 0.3 } else { measured().shade };
        let settings = SelfOrganizing { light, shade, ..measured() };
        let trees = |grown: &Grown| grown.branching.parents.iter().filter(|&&p| p == NO_PARENT).count();
        // Up to the year of the felling nobody knows of it.
        let (stand, before) = (cleared(9, 0, &settings), cleared(9, 10, &settings));
        assert_eq!((stand.branching.positions.len(), trees(&before)), (before.branching.positions.len(), 9));
        assert_eq!(stand.branching.positions, before.branching.positions);
        // In that year one stands, and what lies there is no death of shade.
        let after = cleared(10, 10, &settings);
        assert_eq!((trees(&after), after.died), (1, 0));
        let alone = grow(&SelfOrganizing { years: 20, ..settings.clone() }, Key::new(6), &Quiet).unwrap();
        let [stand, cleared] = [0, 10].map(|felled_in| first(&cleared(20, felled_in, &settings)));
        let spread = |places: &[Vec3]| {
            places.iter().map(|place| f64::from(place.x.hypot(place.z))).sum::<f64>() / places.len() as f64
        };
        assert!(cleared.len() * 2 > 3 * stand.len(), "{light:?}: {} of {}", cleared.len(), stand.len());
        assert!(
            spread(&cleared) > 1.1 * spread(&stand),
            "{light:?}: {} {}",
            spread(&cleared),
            spread(&stand)
        );
        assert!(cleared.len() < first(&alone).len(), "{light:?}: ten years of shade are not made good");
    }
}
