//! From the points of a file to attraction points with a root.

use glam::DVec3;

use linden_base::input::{Up, recenter, unit_name};
use linden_base::knob::Length;
use linden_base::memory::bytes_of;
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_growth::GrowthError;
use linden_growth::site::{Grove, Site, Stem, Suggested, jitter};

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
    &Given { points, is_leaf, ground, up: usual, is_up_sure, scale, may_be_plot }: &Given<'_>,
    key: Key,
    what: As,
    monitor: &dyn Monitor,
) -> Result<Prepared, ScanGrowthError> {
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
        None if is_scan && ground.is_empty() => guessed_up(&points, usual, is_up_sure),
        None => (usual, None),
    };
    notes.extend(said);
    let mut ground = ground.to_vec();
    up.to_y_up(&mut points);
    up.to_y_up(&mut ground);
    let scale = scale.unwrap_or_else(|| {
        let scale = if is_scan { crate::likely_scale(&points) } else { 1.0 };
        notes.extend(scale_note(scale));
        scale
    });
    if scale != 1.0 {
        for p in points.iter_mut().chain(&mut ground) {
            *p *= scale;
        }
    }
    let axes = FileAxes { up, scale };
    let far_points = if is_scan { drop_far(&mut points, is_leaf.as_mut(), monitor)? } else { 0 };
    notes.extend(far_note(far_points));
    if is_scan && what == As::Settings {
        notes.extend(looks::notes(&points, &ground, may_be_plot, monitor)?);
    }
    let origin = middle(&points);
    recenter(&mut points, origin);
    recenter(&mut ground, origin);
    let given_root = settings.growth.given_root(up).map(|root| root - origin);
    if settings.contract && what == As::Settings {
        let rule = ScanRule {
            step_m: settings.growth.step_m,
            noise_filter: settings.noise_filter,
            leaf_points: settings.leaf_points,
            // One place that is given is one stem.
            stems: if given_root.is_some() {
                Some(1)
            } else {
                settings.stems.map(|n| libm::round(n) as usize)
            },
        };
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
        return Ok(Prepared { site, bark: Some(scan.bark), leaf_points, axes });
    }
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
fn guessed_up(points: &[DVec3], usual: Up, is_sure: bool) -> (Up, Option<String>) {
    match crate::guess_up(points, usual) {
        UpGuess::Usual => (usual, None),
        UpGuess::Other(up) if is_sure => (usual, Some(lying_note(usual, up))),
        UpGuess::Undecided if is_sure => (usual, None),
        UpGuess::Other(up) => (up, Some(up_note(up))),
        UpGuess::Undecided => (usual, Some(doubt_note(usual))),
    }
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
