//! Synthetic scans of a tree whose axes are known.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use linden::grow::{Grown, grow};
use linden::input::Up;
use linden::preset::Preset;
use linden::random::Key;
use linden::recipe::{Geometry, Input, Recipe};
use linden::scan::{Scan, ScanError, ScanRule, point_spacing_m, prepare};
use linden::{Cancelled, DVec3, Monitor, Quiet};

use crate::shapes::in_box;

/// A limb: a straight cone frustum.
struct Limb {
    from: DVec3,
    to: DVec3,
    radius: (f64, f64),
}

const STEM_RADIUS_M: f64 = 0.15;

fn limbs() -> Vec<Limb> {
    let limb = |from: [f64; 3], to: [f64; 3], radius| Limb { from: from.into(), to: to.into(), radius };
    vec![
        limb([0.0, 0.0, 0.0], [0.2, 4.0, 0.1], (STEM_RADIUS_M, 0.10)),
        limb([0.2, 4.0, 0.1], [0.3, 7.5, 0.0], (0.10, 0.02)),
        limb([0.15, 3.0, 0.07], [2.4, 5.0, 0.6], (0.06, 0.02)),
        limb([0.2, 3.9, 0.1], [-2.0, 6.0, -0.4], (0.06, 0.02)),
        limb([0.2, 4.4, 0.1], [0.4, 6.4, 2.2], (0.05, 0.02)),
    ]
}

/// Points on the bark, about 2.5 cm apart, a little noisy.
fn bark(limbs: &[Limb], key: Key) -> Vec<DVec3> {
    let mut points = Vec::new();
    for (l, limb) in limbs.iter().enumerate() {
        let axis = limb.to - limb.from;
        let along = axis.normalize();
        let (u, v) = along.any_orthonormal_pair();
        let count = (axis.length() * TAU * 0.5 * (limb.radius.0 + limb.radius.1) / (0.025 * 0.025)) as u64;
        for i in 0..count {
            let key = key.child(l as u64).child(i);
            let (t, turn) = (key.child(0).unit(), key.child(1).unit() * TAU);
            let radius =
                limb.radius.0 + (limb.radius.1 - limb.radius.0) * t + key.child(2).between(-4e-3, 4e-3);
            points.push(limb.from + axis * t + radius * (u * libm::cos(turn) + v * libm::sin(turn)));
        }
    }
    points
}

pub fn scan() -> Vec<DVec3> {
    bark(&limbs(), Key::new(1))
}

fn to_axis(p: DVec3) -> f64 {
    let away = |limb: &Limb| {
        let axis = limb.to - limb.from;
        let t = ((p - limb.from).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
        p.distance(limb.from + axis * t)
    };
    limbs().iter().map(away).fold(f64::INFINITY, f64::min)
}

fn prepared(points: &[DVec3]) -> Scan {
    prepare(points, &ScanRule::default(), &Quiet).unwrap()
}

/// What holds for every scan of the known tree.
fn assert_follows_the_axes(scan: &Scan) {
    let root_off = DVec3::new(scan.roots[0].x, 0.0, scan.roots[0].z).length();
    assert!(root_off < 0.5 * STEM_RADIUS_M && scan.roots[0].y.abs() < 0.1, "root {}", scan.roots[0]);
    let mut off: Vec<f64> = scan.points.iter().map(|&p| to_axis(p)).collect();
    off.sort_by(f64::total_cmp);
    let (middle, most) = (off[off.len() / 2], off[off.len() * 95 / 100]);
    assert!(middle < 0.03 && most < 0.12, "points lie {middle} (median), {most} (95 %) off the axes");
    for limb in limbs() {
        let reached = scan.points.iter().map(|p| p.distance(limb.to)).fold(f64::INFINITY, f64::min);
        assert!(reached < 0.25, "the tip at {} is {reached} away", limb.to);
    }
    // One strand: below the limbs the points are in the middle of the stem, not on its bark; less so
    // at the rim of a gap, where a section starts from the end of the bridge.
    let stem = scan.points.iter().filter(|p| (0.3..2.5).contains(&p.y));
    let mut off: Vec<f64> = stem.map(|&p| to_axis(p)).collect();
    off.sort_by(f64::total_cmp);
    assert!(off[off.len() / 2] < 0.3 * STEM_RADIUS_M, "the stem's points lie {off:?} off its axis");
    assert!(off[off.len() - 1] < 0.8 * STEM_RADIUS_M, "a strand of its own: {off:?}");
    // Without gaps: growth with the suggested influence always has a next point.
    let mut connected = vec![false; scan.points.len()];
    let mut queue = vec![scan.roots[0]];
    while let Some(at) = queue.pop() {
        for (i, p) in scan.points.iter().enumerate() {
            if !connected[i] && p.distance(at) <= 0.5 * scan.influence_m {
                connected[i] = true;
                queue.push(*p);
            }
        }
    }
    let cut_off = connected.iter().filter(|&&c| !c).count();
    assert_eq!(cut_off, 0, "of {} points", scan.points.len());
}

#[test]
fn a_clean_scan_becomes_its_axes() {
    let scan = prepared(&scan());
    assert_follows_the_axes(&scan);
    assert!(scan.kill_m >= scan.step_m && scan.influence_m > scan.kill_m);
    assert!(scan.report.spacing_m > 0.005 && scan.report.spacing_m < 0.025, "{:?}", scan.report);
}

#[test]
fn ground_strays_and_gaps_do_no_harm() {
    let mut points = scan();
    let key = Key::new(2);
    // Ground, 5 m wide; a stray far below and two high above; no stem between 1.0 and 1.6 m.
    points.extend(
        (0..6000).map(|i| in_box(key.child(i), DVec3::new(-2.5, -0.05, -2.5), DVec3::new(2.5, 0.03, 2.5))),
    );
    points.extend([DVec3::new(1.0, -8.0, 0.0), DVec3::new(-3.0, 12.0, 1.0), DVec3::new(3.0, 12.5, 1.0)]);
    points.retain(|p| !(1.0..1.6).contains(&p.y));
    let scan = prepared(&points);
    assert_follows_the_axes(&scan);
    assert!(scan.report.ground_points > 4000, "{:?}", scan.report);
    // The stem is led across its gap by its circles.
    assert!(scan.report.longest_bridge_m < 0.5, "{:?}", scan.report);
    let in_gap = scan.points.iter().filter(|p| (1.0..1.6).contains(&p.y)).count();
    assert!(in_gap >= 4, "{in_gap}");
}

#[test]
fn birds_and_far_dust_change_nothing_near() {
    let mut points = scan();
    points.extend([DVec3::new(0.0, 2000.0, 0.0), DVec3::new(900.0, 50.0, 3.0)]);
    let scan = prepared(&points);
    assert_follows_the_axes(&scan);
    assert!((scan.step_m - prepared(&self::scan()).step_m).abs() < 1e-3);
    // Too many for strays, and as far as coordinates go.
    points.extend((0..9).map(|i| DVec3::new(1e9, f64::from(i) * 0.01, 0.0)));
    assert!(prepared(&points).points.len() < 100 * points.len());
}

#[test]
fn a_branch_that_hangs_lower_than_the_foot_is_not_the_root() {
    let mut points = scan();
    let hanging = |from: [f64; 3], to: [f64; 3], radius| Limb { from: from.into(), to: to.into(), radius };
    points.extend(bark(
        &[
            hanging([2.4, 5.0, 0.6], [3.0, 4.0, 0.8], (0.02, 0.015)),
            hanging([3.0, 4.0, 0.8], [3.1, -0.3, 0.8], (0.015, 0.01)),
        ],
        Key::new(3),
    ));
    let scan = prepared(&points);
    assert!(
        DVec3::new(scan.roots[0].x, 0.0, scan.roots[0].z).length() < 0.5 * STEM_RADIUS_M,
        "{}",
        scan.roots[0]
    );
}

#[test]
fn a_stem_seen_from_one_side_is_one_strand() {
    let mut points = scan();
    points.retain(|p| p.y > 2.5 || p.x > 0.03 * p.y);
    let scan = prepared(&points);
    let strands = |y: f64| {
        let mut near: Vec<DVec3> =
            scan.points.iter().copied().filter(|p| (p.y - y).abs() < scan.step_m).collect();
        near.retain(|p| DVec3::new(p.x, 0.0, p.z).length() < 1.0);
        near.iter().map(|p| p.distance(near[0])).fold(0.0, f64::max)
    };
    for y in [0.5, 1.0, 1.5, 2.0] {
        assert!(strands(y) < 3.0 * scan.step_m, "{} wide at {y}", strands(y));
    }
}

#[test]
fn spacing_is_the_median_over_different_places() {
    let mut points: Vec<DVec3> = (0..100).map(|i| DVec3::new(0.1 * f64::from(i), 0.0, 0.0)).collect();
    points.extend(points.clone());
    points.push(DVec3::new(500.0, 0.0, 0.0));
    let spacing = |points: &[DVec3]| point_spacing_m(points, &Quiet).unwrap();
    assert!((spacing(&points).unwrap() - 0.1).abs() < 1e-9);
    assert_eq!(spacing(&[]), None);
    assert_eq!(spacing(&[DVec3::ONE; 9]), None);
}

#[test]
fn a_tree_of_another_size_is_the_same_tree() {
    let points = scan();
    // A power of two changes no significand.
    let large: Vec<DVec3> = points.iter().map(|p| *p * 16.0).collect();
    let (small, large) = (prepared(&points), prepared(&large));
    assert_eq!(small.points.iter().map(|p| *p * 16.0).collect::<Vec<_>>(), large.points);
    assert_eq!((small.roots[0] * 16.0, small.kill_m * 16.0), (large.roots[0], large.kill_m));
}

#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| prepared(&scan()))
    };
    assert_eq!(run(1), run(4));
}

#[test]
fn what_is_no_tree_is_refused() {
    for points in [vec![], vec![DVec3::ONE], vec![DVec3::ONE; 500], vec![DVec3::X, DVec3::Y, DVec3::Z]] {
        assert!(matches!(prepare(&points, &ScanRule::default(), &Quiet), Err(ScanError::TooFew { .. })));
    }
    let mut points = scan();
    points[7].y = f64::INFINITY;
    assert_eq!(prepare(&points, &ScanRule::default(), &Quiet), Err(ScanError::NotFinite { index: 7 }));
    // Flat, straight, huge: odd, but nothing breaks.
    for scale in [DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 0.0), DVec3::splat(1e6), DVec3::splat(1e-6)]
    {
        let odd: Vec<DVec3> = scan().iter().map(|p| *p * scale).collect();
        if let Ok(scan) = prepare(&odd, &ScanRule::default(), &Quiet) {
            assert!(scan.points.iter().all(|p| p.is_finite()) && scan.step_m > 0.0);
        }
    }
}

#[test]
fn a_chosen_step_decides_the_detail() {
    let coarse = prepare(&scan(), &ScanRule { step_m: Some(0.2), ..ScanRule::default() }, &Quiet).unwrap();
    assert_eq!(coarse.step_m, 0.2);
    assert!(coarse.points.len() * 2 < prepared(&scan()).points.len());
}

/// The tree that grows from points, as a command line grows it.
fn grown_from(points: Vec<DVec3>) -> Grown {
    let mut recipe = Recipe::new(Preset::of("mine", linden::preset::ScanSettings::of("mine.xyz")));
    let geometry = Geometry::Points(Arc::new(points.into()));
    recipe.inputs.insert("mine.xyz", Input { hash: 0, up: Up::Y, geometry });
    grow(&recipe, &Quiet).unwrap()
}

#[test]
fn rows_that_are_no_points_of_the_tree_change_nothing() {
    // Somewhere off the scanner, which stands at the origin.
    let points: Vec<DVec3> = scan().iter().map(|p| *p + DVec3::new(-6.5, -1.4, 48.0)).collect();
    let clean = grown_from(points.clone());
    let hash = clean.skeleton.hash();
    let volume = clean.skeleton.measures().wood_volume_m3;
    assert!(clean.notes.iter().all(|note| !note.contains("0 0 0") && !note.contains("each place")));
    for rows in [1, 700, 4000, points.len() + 9, 80_000] {
        // As scanners write them: between the others.
        let mut with = points.clone();
        with.splice(100..100, std::iter::repeat_n(DVec3::ZERO, rows));
        let grown = grown_from(with);
        assert_eq!(grown.skeleton.hash(), hash, "{rows} rows");
        assert_eq!(grown.skeleton.measures().wood_volume_m3, volume);
        let said = format!("{rows} row");
        assert!(grown.notes.iter().any(|note| note.starts_with(&said)), "{:?}", grown.notes);
    }
    // Each place counts once, and a single point far from all others is none of the tree's.
    let mut with = points.clone();
    with.extend(points.iter().copied().filter(|p| p.y > 2.0).cycle().take(9000));
    with.push(DVec3::new(-9999.0, -9999.0, -9999.0));
    let grown = grown_from(with);
    assert_eq!(grown.skeleton.hash(), hash);
    for said in ["9000 points are where another is", "1 single point far from all others"] {
        assert!(grown.notes.iter().any(|note| note.contains(said)), "{:?}", grown.notes);
    }
}

#[test]
fn a_scan_of_nothing_but_one_place_says_how_many_it_has() {
    let rows = vec![DVec3::new(1.0, 2.0, 3.0); 500];
    let said = prepare(&rows, &ScanRule::default(), &Quiet).unwrap_err();
    assert_eq!(said, ScanError::TooFew { distinct: 1 });
    let said = prepare(&[DVec3::ZERO; 500], &ScanRule::default(), &Quiet).unwrap_err();
    assert_eq!(said, ScanError::TooFew { distinct: 0 });
}

/// Cancels at the `n`-th look.
struct After {
    looks: AtomicU32,
    most: u32,
}

impl Monitor for After {
    fn is_cancelled(&self) -> bool {
        self.looks.fetch_add(1, Ordering::Relaxed) >= self.most
    }

    fn advance(&self, _: linden::monitor::Phase, _: u64, _: Option<u64>) {}
}

#[test]
fn preparing_is_stopped_wherever_it_is() {
    let mut points = scan();
    points.extend(std::iter::repeat_n(DVec3::ZERO, 20_000));
    let prepare = |most: u32| {
        let monitor = After { looks: AtomicU32::new(0), most };
        let prepared = prepare(&points, &ScanRule::default(), &monitor);
        (prepared, monitor.looks.into_inner())
    };
    let (whole, looks) = prepare(u32::MAX);
    assert!(whole.is_ok());
    // One for the sample of the spacing, and for each cube at least.
    assert!(looks as usize > points.len() / 8, "{looks}");
    for most in (0..60).chain((60..looks).step_by(looks as usize / 40)) {
        assert_eq!(prepare(most).0, Err(ScanError::Cancelled(Cancelled)), "after {most} of {looks}");
    }
}

/// A dome seen from an aircraft: 758 points on a cap 4 m wide, from 6 to 9 m above the ground, Y up.
fn dome(seed: u64, ground_m: f64) -> Vec<DVec3> {
    let key = Key::new(seed);
    let mut points = Vec::new();
    for i in 0.. {
        let key = key.child(i);
        let [x, z] = [0, 1].map(|axis| key.child(axis).between(-4.0, 4.0));
        let out = libm::hypot(x, z);
        if out < 4.0 {
            let y = 6.0 + 3.0 * (1.0 - out * out / 16.0).sqrt() + key.child(2).between(-0.08, 0.08);
            points.push(DVec3::new(500.0 + x, y + ground_m, 700.0 + z));
        }
        if points.len() == 758 {
            break;
        }
    }
    points
}

#[test]
fn a_canopy_without_a_stem_is_a_crown_on_a_trunk_and_never_a_stub() {
    for seed in 0..8 {
        let grown = grown_from(dome(seed, 0.0));
        let colonized = grown.colonized.as_ref().unwrap();
        assert!(colonized.is_canopy, "seed {seed}");
        assert!(
            colonized.unreached * 50 < colonized.points.len(),
            "seed {seed}: {} not reached",
            colonized.unreached
        );
        let measures = grown.skeleton.measures();
        assert!((8.7..9.4).contains(&measures.height_m), "seed {seed}: {} m", measures.height_m);
        assert!((7.0..8.6).contains(&measures.crown_width_m), "seed {seed}: {} m", measures.crown_width_m);
        let said = grown.notes.iter().find(|note| note.contains("no stem was found")).unwrap();
        assert!(said.contains("758 points") && said.contains("root=x,y,z"), "{said}");
        // Below its middle, on the ground: the tree was moved from there to the origin.
        let moved = grown.notes.iter().find(|note| note.contains("the root was at")).unwrap();
        let at: Vec<f64> = moved
            .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .filter_map(|word| word.parse().ok())
            .collect();
        assert!((at[0] - 500.0).abs() < 0.3 && at[1] == 0.0 && (at[2] - 700.0).abs() < 0.3, "{moved}");
    }
    // Heights above the sea say nothing of the ground: a trunk as long as crowns usually have.
    let grown = grown_from(dome(1, 480.0));
    let height_m = grown.skeleton.measures().height_m;
    assert!(grown.colonized.unwrap().is_canopy && (3.2..4.5).contains(&height_m), "{height_m}");
}

#[test]
fn ground_below_a_canopy_says_where_the_tree_stands() {
    for seed in 0..6 {
        // Heights above the sea, and a slope: the ground below the middle counts.
        let mut points = dome(seed, 480.0);
        let key = Key::new(seed).named("ground");
        points.extend((0..400).map(|i| {
            let [x, z, off] = [0, 1, 2].map(|axis| key.child(i).child(axis).between(-1.0, 1.0));
            DVec3::new(500.0 + 8.0 * x, 480.0 + 0.3 * x + 0.05 * off, 700.0 + 8.0 * z)
        }));
        let grown = grown_from(points);
        let colonized = grown.colonized.as_ref().unwrap();
        assert!(colonized.is_canopy && colonized.points.len() == 758, "seed {seed}: {:?}", grown.notes);
        let height_m = grown.skeleton.measures().height_m;
        assert!((8.6..9.5).contains(&height_m), "seed {seed}: {height_m} m");
        assert!(colonized.unreached < 20, "seed {seed}: {}", colonized.unreached);
        assert!(grown.notes.iter().any(|note| note.starts_with("400 points were taken for ground")));
    }
}

#[test]
fn no_scan_of_a_tree_is_taken_for_a_canopy() {
    let thin: Vec<DVec3> = scan().into_iter().step_by(9).collect();
    // So few that no ring of bark is seen.
    let thinner: Vec<DVec3> = scan().into_iter().step_by(60).collect();
    assert!(!grown_from(thinner).colonized.unwrap().is_canopy);
    let half: Vec<DVec3> = scan().into_iter().filter(|p| p.z > 0.0).collect();
    for points in [scan(), thin, half] {
        let grown = grown_from(points);
        assert!(!grown.colonized.as_ref().unwrap().is_canopy);
        assert!(grown.notes.iter().all(|note| !note.contains("scanned points lie")), "{:?}", grown.notes);
    }
}

#[test]
fn thinned_points_are_kept_as_the_recipe_says_or_refused() {
    let text: String = scan().iter().map(|p| format!("{} {} {}\n", p.x, -p.z, p.y)).collect();
    let recipe = |read: Option<f64>, thin: &str| {
        let mut preset = Preset::of_points("stem", "stem.xyz");
        preset.set("thin", thin).unwrap();
        let input = Input::read_thinned("stem.xyz", text.as_bytes(), read, &Quiet).unwrap();
        Recipe::with_files(preset, [("stem.xyz", input)].into_iter().collect())
    };
    let hash = |recipe: &Recipe| grow(recipe, &Quiet).unwrap().skeleton.positions.clone();
    let later = recipe(None, "0.05");
    assert_eq!(hash(&later), hash(&recipe(Some(0.05), "0.05")));
    assert_eq!(hash(&later), hash(&later), "out of what was kept");
    assert_ne!(hash(&later), hash(&recipe(None, "0")));
    for wanted in ["0", "0.02"] {
        let refused = grow(&recipe(Some(0.05), wanted), &Quiet).unwrap_err().to_string();
        let said = format!("thin={wanted}: the points of stem.xyz were read with thin=0.05");
        assert!(refused.contains(&said) && refused.contains("open the file again"), "{refused}");
    }
}
