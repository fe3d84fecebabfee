//! From the points of a file to attraction points with a root.

use glam::DVec3;

use linden_base::input::{Up, recenter, unit_name};
use linden_base::knob::Length;
use linden_base::memory::bytes_of;
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_growth::GrowthError;
use linden_growth::site::{Grove, Site, Stem, Suggested, jitter};

use crate::ground::{self, Ground};
use crate::looks;
use crate::settings::ScanSettings;
use crate::{Distinct, Scan, ScanGrowthError, ScanReport, ScanRule, UpGuess, canopy};

/// What given points are taken for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum As {
    /// What the settings say: points on bark, or attraction points.
    Settings,
    /// A scan of a crown without a stem.
    Canopy,
    /// What fills a crown of a grid of heights above ground, metres by `scale`, Z up.
    Grid,
}

/// What a file has.
pub(crate) struct Given<'a> {
    pub points: &'a [DVec3],
    /// Whether each lies on a leaf, where the file says so.
    pub is_leaf: Option<&'a [bool]>,
    /// Points of the ground near them, where the file says which are.
    pub ground: &'a [DVec3],
    /// Other points near them that are of no tree: the ground may be among them.
    pub others: &'a [DVec3],
    /// The axis that points up in such files.
    pub up: Up,
    /// Whether the format itself says so.
    pub is_up_sure: bool,
    /// Metres for a unit, where that is known.
    pub scale: Option<f64>,
    /// Whether they may be those of several trees, which nobody has told apart.
    pub may_be_plot: bool,
}

/// Points that are ready to be grown into.
pub(crate) struct Prepared {
    pub site: Site,
    /// The points on bark, if they are.
    pub bark: Option<Vec<DVec3>>,
    /// Points that were taken for leaves.
    pub leaf_points: usize,
    pub axes: FileAxes,
}

/// How the file has what grows in metres, Y up.
#[derive(Clone, Copy)]
pub(crate) struct FileAxes {
    up: Up,
    /// Metres for a unit.
    scale: f64,
}

impl FileAxes {
    /// A place as the file would have it.
    pub fn of(self, place: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = place / self.scale;
        if self.up == Up::Z { DVec3::new(x, -z, y) } else { DVec3::new(x, y, z) }
    }
}

/// Attraction points with a root, and, where the points lie on bark, these; moved near the origin.
pub(crate) fn at_points(
    settings: &ScanSettings,
    given: &Given<'_>,
    key: Key,
    what: As,
    monitor: &dyn Monitor,
) -> Result<Prepared, ScanGrowthError> {
    let mut upright = upright(settings, given, what, monitor)?;
    let origin = middle(&upright.points);
    recenter(&mut upright.points, origin);
    recenter(&mut upright.ground, origin);
    let given_root = settings.growth.given_root(upright.axes.up).map(|root| root - origin);
    if settings.contract && what == As::Settings {
        on_bark(settings, upright, (origin, given_root), monitor)
    } else {
        in_volume(settings, upright, (origin, given_root), key, what, monitor)
    }
}

/// Points in metres, Y up, without what is no point of the tree.
struct Upright {
    points: Vec<DVec3>,
    is_leaf: Option<Vec<bool>>,
    /// Points of the ground below them.
    ground: Vec<DVec3>,
    axes: FileAxes,
    repeated: usize,
    no_returns: usize,
    far_points: usize,
    notes: Vec<String>,
}

/// Points of a file set upright, in metres, and cleaned of what its scanner saw beside the tree.
fn upright(
    settings: &ScanSettings,
    &Given { points, is_leaf, ground, others, up: usual, is_up_sure, scale, may_be_plot }: &Given<'_>,
    what: As,
    monitor: &dyn Monitor,
) -> Result<Upright, ScanGrowthError> {
    let mut notes = Vec::new();
    // First of all: rows that are no points would have a say in what is up, in metres and in the middle.
    let given = points;
    let Distinct { mut points, repeated, no_returns } = crate::distinct(given, settings.contract, monitor)?;
    let mut is_leaf = is_leaf.map(|is_leaf| of_kept(given, is_leaf, &points));
    notes.extend(row_notes(repeated, no_returns));
    // A scanner's file: what it says of itself is not sure.
    let is_scan = settings.contract && what != As::Grid;
    let (up, said) = match settings.growth.given_up().filter(|_| what != As::Grid) {
        Some(up) => (up, None),
        // Who tells ground apart knows what is up.
        None if is_scan && ground.is_empty() => guessed_up(&points, usual, is_up_sure, monitor)?,
        None => (usual, None),
    };
    notes.extend(said);
    let [mut ground, mut others] = [ground, others].map(<[DVec3]>::to_vec);
    for points in [&mut points, &mut ground, &mut others] {
        up.to_y_up(points);
    }
    let scale = scale.unwrap_or_else(|| {
        let scale = if is_scan { crate::likely_scale(&points) } else { 1.0 };
        notes.extend(scale_note(scale));
        scale
    });
    if scale != 1.0 {
        for p in points.iter_mut().chain(&mut ground).chain(&mut others) {
            *p *= scale;
        }
    }
    let axes = FileAxes { up, scale };
    let far_points = if is_scan { drop_far(&mut points, is_leaf.as_mut(), monitor)? } else { 0 };
    notes.extend(far_note(far_points));
    if is_scan && what == As::Settings && ground.is_empty() {
        let note = take_ground(&mut points, is_leaf.as_mut(), (&mut ground, &others), monitor)?;
        notes.extend(note);
    }
    if is_scan && what == As::Settings {
        notes.extend(looks::notes(&points, &ground, may_be_plot, monitor)?);
    }
    Ok(Upright { points, is_leaf, ground, axes, repeated, no_returns, far_points, notes })
}

/// A scan of bark, ready to be grown along. The root is given where it is known.
fn on_bark(
    settings: &ScanSettings,
    upright: Upright,
    (origin, given_root): (DVec3, Option<DVec3>),
    monitor: &dyn Monitor,
) -> Result<Prepared, ScanGrowthError> {
    let Upright { points, is_leaf, ground, axes, repeated, no_returns, far_points, mut notes } = upright;
    let rule = rule_of(settings, given_root.is_some());
    let mut scan = crate::prepare_distinct(&points, is_leaf.as_deref(), &ground, &rule, monitor)?;
    scan.report = ScanReport { repeated_points: repeated, no_returns, far_points, ..scan.report };
    notes.extend(scan_notes(&scan, &rule));
    let mut roots = given_root.map_or(scan.roots, |root| vec![root]).into_iter();
    let root = roots.next().unwrap_or_default();
    let others = roots.map(|root| Stem { root, trunk_m: settings.growth.trunk_m, crown: None }).collect();
    let site = Site {
        points: scan.points,
        held_bytes: bytes_of::<DVec3>(scan.bark.capacity()),
        root,
        grove: Grove { others, ..Grove::default() },
        origin,
        suggested: Suggested {
            step_m: scan.step_m,
            kill: Length::Metres(scan.kill_m),
            influence: Length::Metres(scan.influence_m),
            trunk_m: None,
        },
        moves_to_root: true,
        notes,
    };
    let leaf_points = scan.report.leaf_points;
    Ok(Prepared { site, bark: Some(scan.bark), leaf_points, axes })
}

/// Points that fill a crown, ready to be grown into.
fn in_volume(
    settings: &ScanSettings,
    upright: Upright,
    (origin, given_root): (DVec3, Option<DVec3>),
    key: Key,
    what: As,
    monitor: &dyn Monitor,
) -> Result<Prepared, ScanGrowthError> {
    let Upright { mut points, ground, axes, mut notes, .. } = upright;
    let mut ground_m = None;
    if what == As::Canopy {
        let before = points.len();
        ground_m = canopy::drop_ground(&mut points).or_else(|| canopy::ground_below(&points, &ground));
        notes.extend(ground_note(before - points.len()));
    }
    let spacing_m = crate::point_spacing_m(&points, monitor)?.unwrap_or(1.0);
    let root = match (given_root, what) {
        (Some(root), _) => root,
        (None, As::Canopy | As::Grid) => {
            canopy::root_below(&points, ground_m, origin, settings).ok_or(GrowthError::NoPoints)?
        }
        (None, As::Settings) => crate::foot(&points).ok_or(GrowthError::NoPoints)?,
    };
    if what == As::Canopy {
        notes.push(canopy::note(points.len(), root + origin, given_root.is_some()));
    }
    // Lattices and mirrored models make pulls cancel.
    jitter(&mut points, spacing_m * 1e-3, key.named("jitter"));
    let site = Site {
        points,
        held_bytes: 0,
        root,
        grove: Grove::default(),
        origin,
        suggested: Suggested::for_volume(spacing_m),
        moves_to_root: true,
        notes,
    };
    Ok(Prepared { site, bark: None, leaf_points: 0, axes })
}

/// How settings want a scan to be made ready; one place that is given is one stem.
fn rule_of(settings: &ScanSettings, is_root_given: bool) -> ScanRule {
    let stems = settings.stems.map(|n| libm::round(n) as usize);
    ScanRule {
        step_m: settings.growth.step_m,
        noise_filter: settings.noise_filter,
        leaf_points: settings.leaf_points,
        stems: if is_root_given { Some(1) } else { stems },
    }
}

/// Takes the points of the ground out, where it shows in them and in `others`; places on it, and what is said of it.
fn take_ground(
    points: &mut Vec<DVec3>,
    is_leaf: Option<&mut Vec<bool>>,
    (ground, others): (&mut Vec<DVec3>, &[DVec3]),
    monitor: &dyn Monitor,
) -> Result<Option<String>, ScanGrowthError> {
    let count = points.len();
    let all = [&points[..], others].concat();
    monitor.admit(
        "looking for the ground",
        all.len() as u64 * ground::BYTES_PER_POINT,
        "thin the points out",
    )?;
    let Some(mut found) = Ground::find(&all, monitor)? else { return Ok(None) };
    found.marks.truncate(count);
    crate::retain_unmarked(points, &found.marks);
    if let Some(is_leaf) = is_leaf {
        crate::retain_unmarked(is_leaf, &found.marks);
    }
    *ground = found.points;
    let rises = libm::atan(found.rise).to_degrees();
    Ok(Some(format!(
        "the ground was found by a cloth below the points; it rises by {rises:.0}°. {} points on it were left out, and the tree \
         stands on it",
        count - points.len()
    )))
}

/// Whole metres near the middle of the box around some points.
fn middle(points: &[DVec3]) -> DVec3 {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    if points.is_empty() { DVec3::ZERO } else { ((low + high) * 0.5).round() }
}

/// Leaves out single far points, and what is known of them; how many.
fn drop_far(
    points: &mut Vec<DVec3>,
    is_leaf: Option<&mut Vec<bool>>,
    monitor: &dyn Monitor,
) -> Result<usize, ScanGrowthError> {
    let Some(is_leaf) = is_leaf else { return Ok(crate::drop_far(points, monitor)?) };
    let before = points.clone();
    let far_points = crate::drop_far(points, monitor)?;
    if far_points > 0 {
        *is_leaf = of_kept(&before, is_leaf, points);
    }
    Ok(far_points)
}

/// What is known of some places, of those that are left of them in their order.
fn of_kept(given: &[DVec3], known: &[bool], kept: &[DVec3]) -> Vec<bool> {
    let mut rows = given.iter().zip(known);
    kept.iter().filter_map(|place| rows.find(|(given, _)| *given == place).map(|(_, known)| *known)).collect()
}

/// What is said of rows that are no points.
fn row_notes(repeated: usize, no_returns: usize) -> Vec<String> {
    let mut notes = Vec::new();
    if repeated > 0 {
        let (are, s) = if repeated == 1 { ("is", "") } else { ("are", "s") };
        notes.push(format!("{repeated} point{s} {are} where another is; each place counts once"));
    }
    if no_returns > 0 {
        let (were, s) = if no_returns == 1 { ("was", "") } else { ("were", "s") };
        notes.push(format!(
            "{no_returns} row{s} 0 0 0, which scanners write where nothing came back, {were} left out"
        ));
    }
    notes
}

fn far_note(far_points: usize) -> Option<String> {
    let (were, s) = if far_points == 1 { ("was", "") } else { ("were", "s") };
    (far_points > 0).then(|| format!("{far_points} single point{s} far from all others {were} left out"))
}

fn ground_note(points: usize) -> Option<String> {
    (points > 0).then(|| format!("{points} points were taken for ground and left out"))
}

/// The axis that is up, and what is said of it.
fn guessed_up(
    points: &[DVec3],
    usual: Up,
    is_sure: bool,
    monitor: &dyn Monitor,
) -> Result<(Up, Option<String>), ScanGrowthError> {
    let guess = crate::guess_up(points, usual);
    // A tree that stands on ground does not lie.
    if guess == UpGuess::Usual || shows_ground(points, usual, monitor)? {
        return Ok((usual, None));
    }
    Ok(match guess {
        UpGuess::Other(up) if is_sure => (usual, Some(lying_note(usual, up))),
        UpGuess::Other(up) => (up, Some(up_note(up))),
        UpGuess::Undecided if !is_sure => (usual, Some(doubt_note(usual))),
        UpGuess::Undecided | UpGuess::Usual => (usual, None),
    })
}

/// Whether ground is below points in the file's axes and units, where `up` is up.
fn shows_ground(points: &[DVec3], up: Up, monitor: &dyn Monitor) -> Result<bool, ScanGrowthError> {
    let mut points = points.to_vec();
    up.to_y_up(&mut points);
    let scale = crate::likely_scale(&points);
    for p in &mut points {
        *p *= scale;
    }
    Ok(Ground::find(&points, monitor)?.is_some())
}

fn up_note(up: Up) -> String {
    let [axis, other] = axes_of(up);
    format!(
        "the tree stands along {axis}, which was taken for up though {other} is usual in such files; up={other} forces that"
    )
}

/// Of a format that says which axis is up.
fn lying_note(usual: Up, found: Up) -> String {
    let ([axis, _], [other, _]) = (axes_of(usual), axes_of(found));
    format!(
        "the points look like a tree that lies along {other}; {axis} is up in files of this format and was taken: up={other} if the \
         file was written with another axis up"
    )
}

fn doubt_note(usual: Up) -> String {
    let [axis, other] = axes_of(usual);
    format!(
        "the points do not show whether {axis} or {other} is up; {axis} was taken, as is usual in such files: up={other} if the tree lies, \
         up={axis} if it stands"
    )
}

/// The name of an axis that may be up, and of the other one.
const fn axes_of(up: Up) -> [&'static str; 2] {
    match up {
        Up::Y => ["y", "z"],
        Up::Z => ["z", "y"],
    }
}

fn scale_note(scale: f64) -> Option<String> {
    let unit = unit_name(scale);
    (scale != 1.0).then(|| {
        format!("no tree is so high in metres: coordinates were taken for {unit} (scale={scale}); scale=1 takes them for metres")
    })
}

/// So much of a stem above the ground is seen badly beside most, metres: grass, roots, the angle of the scanner.
const USUALLY_UNSEEN_M: f64 = 0.35;

/// What is said of a stem whose lowest part shows no circles.
fn unseen_note(unseen_m: f64) -> Option<String> {
    (unseen_m > USUALLY_UNSEEN_M).then(|| {
        format!(
            "the lowest {unseen_m:.2} m of the stem show no circles, as where they are hidden: its axis was led straight down to the \
             ground, from which heights are counted"
        )
    })
}

fn scan_notes(scan: &Scan, rule: &ScanRule) -> Vec<String> {
    let Scan { report, roots, .. } = scan;
    let mut notes = Vec::new();
    match (rule.stems, roots.len()) {
        (Some(wanted), found) if found < wanted => {
            notes.push(format!("stems={wanted}, but only {found} could be told apart near the ground"));
        }
        (None, found) if found > 1 => {
            notes.push(format!("{found} stems stand apart on the ground, each with a root of its own; stems=1 makes one tree of them"));
        }
        _ => {}
    }
    notes.extend(report.unseen_stem_m.and_then(unseen_note));
    notes.extend(ground_note(report.ground_points));
    if report.noise_points > 0 {
        let points = match report.noise_points {
            1 => "1 point with hardly any others near it was".to_owned(),
            count => format!("{count} points with hardly any others near them were"),
        };
        notes.push(format!("{points} left out as noise; noise_filter=false keeps them"));
    }
    if report.leaf_points > 0 {
        let all = report.leaf_points + scan.bark.len();
        notes.push(format!(
            "{} of {all} points were taken for leaves: twigs grow to them, and no radius is measured on them; \
             leaf_points=none takes all for wood",
            report.leaf_points
        ));
    }
    if report.bridges > 0 {
        notes.push(format!(
            "the scan has {} gaps, the longest {:.2} m; branches were led across them",
            report.bridges, report.longest_bridge_m
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;

    use super::*;

    /// Bark of a stem of 8 m with limbs, Z up, what is above `from_m` of it.
    fn tree(from_m: f64) -> Vec<DVec3> {
        let unit = |name: &str, i: u64| Key::new(5).named(name).child(i).unit();
        let stem = (0..12_000).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit("turn", i));
            let h = 8.0 * unit("up", i);
            let r = 0.15 - 0.015 * h;
            DVec3::new(r * cos, r * sin, h)
        });
        let limbs = (0..8000).map(|i| {
            let (sin, cos) = libm::sincos(2.4 * (i % 12) as f64);
            let (around, out) = (libm::sincos(7.0 * unit("turn", i)), 1.8 * unit("out", i));
            let h = 3.0 + 0.35 * (i % 12) as f64 + 0.5 * out;
            DVec3::new(out * cos + 0.03 * around.0, out * sin, h + 0.03 * around.1)
        });
        stem.chain(limbs).filter(|p| p.z > from_m).collect()
    }

    /// Ground around the origin that rises along y, with 2 cm of roughness.
    fn slope(degrees: f64) -> Vec<DVec3> {
        let unit = |name: &str, i: u64| Key::new(6).named(name).child(i).unit();
        let place = |i: u64| {
            let [x, y] = ["x", "y"].map(|axis| 10.0 * unit(axis, i) - 5.0);
            DVec3::new(x, y, y * libm::tan(degrees.to_radians()) + 0.02 * (unit("z", i) - 0.5))
        };
        (0..12_000).map(place).collect()
    }

    fn prepared(points: &[DVec3], others: &[DVec3]) -> (DVec3, Vec<String>) {
        let given = Given {
            points,
            is_leaf: None,
            ground: &[],
            others,
            up: Up::Z,
            is_up_sure: false,
            scale: Some(1.0),
            may_be_plot: true,
        };
        let settings = ScanSettings::of("tree.xyz".to_owned());
        let prepared = at_points(&settings, &given, Key::new(1), As::Settings, &Quiet).unwrap();
        let site = prepared.site;
        (prepared.axes.of(site.root + site.origin), site.notes)
    }

    #[test]
    fn a_tree_stands_on_the_ground_that_nobody_has_classed() {
        for (degrees, hidden_m) in
            [(0.0, 0.0), (15.0, 0.0), (25.0, 0.0), (30.0, 0.0), (0.0, 0.8), (20.0, 1.2)]
        {
            let points = [tree(hidden_m), slope(degrees)].concat();
            let (foot, notes) = prepared(&points, &[]);
            assert!(foot.length() < 0.03, "{degrees}°, {hidden_m}: {foot}");
            let said = notes.join("\n");
            assert!(said.contains(&format!("it rises by {degrees:.0}°")), "{said}");
            assert_eq!(said.contains("show no circles"), hidden_m > 0.0, "{hidden_m}: {said}");
            assert!(!said.contains("taken for up"), "{said}");
        }
    }

    #[test]
    fn the_ground_may_be_among_points_of_no_tree() {
        let (tree, slope) = (tree(0.5), slope(18.0));
        let (foot, _) = prepared(&tree, &slope);
        assert!(foot.length() < 0.03, "{foot}");
        let (foot, notes) = prepared(&tree, &[]);
        assert!((foot.z - 0.5).abs() < 0.05, "{foot}");
        assert!(!notes.join("\n").contains("ground"), "{notes:?}");
    }
}
