//! From a preset's `[colonization]` to a branching: where the points are, where the tree stands, how
//! far it sees, and then growth.

use glam::{DVec3, Vec3};

use super::crown::envelope::Envelope;
use super::crown::{self, Crown};
use super::growth::{self, Growth, GrowthRule, Habit, Stop};
use super::{scan, scatter, trunk};
use crate::grow::GrowError;
use crate::input::{Up, recenter};
use crate::monitor::Monitor;
use crate::preset::{Colonization, Generator, Length, Origin, Space, UpAxis};
use crate::random::Key;
use crate::recipe::{Geometry, Input, Recipe};
use crate::skeleton::Branching;

/// Steps between neighbouring points where no step is given.
const STEPS_PER_SPACING: f64 = 3.0;
/// Kill distance where none is given: about the points' spacing.
const KILL_STEPS: f64 = 3.0;
/// Influence where none is given: the upper end of the range that RLP07 shows (8D to 17D).
const INFLUENCE_STEPS: f64 = 17.0;
/// Influence beyond this costs far more time than it changes.
const WIDE_INFLUENCE_STEPS: f64 = 20.0;
/// Height of a crown's base, in crown heights, where neither base nor trunk is given.
const BASE_PER_CROWN_HEIGHT: f64 = 0.25;

/// What grew into the crown.
pub(crate) struct Plant {
    /// Where the tree is to stand.
    pub branching: Branching,
    /// The attraction points, at the same place as the branching.
    pub points: Vec<Vec3>,
    /// Points that were not reached.
    pub unreached: usize,
    /// Iterations that placed nodes.
    pub iterations: u32,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Points and root in coordinates near the origin, where `f32` is precise.
struct Site {
    points: Vec<DVec3>,
    root: DVec3,
    /// Where these coordinates have their origin in the input's (turned to Y up).
    origin: DVec3,
    /// What suits these points where the user gives none.
    suggested: Suggested,
    /// Whether the tree is moved to stand on the origin unless the user says otherwise.
    moves_to_root: bool,
    notes: Vec<String>,
}

/// Distances in metres.
struct Suggested {
    step: f64,
    kill: Length,
    influence: Length,
}

impl Suggested {
    /// For points that fill a volume.
    fn for_volume(spacing_m: f64) -> Self {
        Self {
            step: spacing_m / STEPS_PER_SPACING,
            kill: Length::Steps(KILL_STEPS),
            influence: Length::Steps(INFLUENCE_STEPS),
        }
    }
}

pub(crate) fn plant(
    settings: &Colonization,
    input: Option<&Input>,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Plant, GrowError> {
    let site = match (&settings.space, input.map(|input| (&input.geometry, input.up))) {
        (Space::Shape { shape, dimensions }, _) => {
            Standing::shape(settings, shape, dimensions)?.fill(settings, key, monitor)?
        }
        (Space::Envelope { .. }, Some((Geometry::Mesh(mesh), up))) => {
            Standing::envelope(settings, mesh, settings.up(up), monitor)?.fill(settings, key, monitor)?
        }
        (Space::Points { .. }, Some((Geometry::Points(points), up))) => {
            at_points(settings, points, settings.up(up), key, monitor)?
        }
        (Space::Envelope { file }, _) => {
            return Err(GrowError::WrongInput { file: file.clone(), expected: "a mesh" });
        }
        (Space::Points { file }, _) => {
            return Err(GrowError::WrongInput { file: file.clone(), expected: "points" });
        }
    };
    let (rule, mut notes) = site.rule(settings);
    if !(rule.kill >= rule.step) {
        // Before a trunk is grown in such steps; growth itself would refuse as well.
        return Err(growth::GrowthError::KillBelowStep { kill: rule.kill, step: rule.step }.into());
    }
    let step_m = f64::from(rule.step);
    let start = match settings.trunk_m {
        Some(height_m) => {
            check_trunk(height_m / step_m, rule.max_nodes)?;
            trunk::straight(site.root, height_m, step_m)
        }
        None => {
            let reach = f64::from(rule.influence);
            // The way cannot be shorter than to the nearest point.
            let way_m =
                site.points.iter().map(|p| p.distance(site.root)).fold(f64::INFINITY, f64::min) - reach;
            if way_m.is_finite() {
                check_trunk(way_m / step_m, rule.max_nodes)?;
            }
            trunk::until_in_reach(site.root, &site.points, reach, step_m, rule.max_nodes as usize, monitor)?
        }
    };
    let mut points: Vec<Vec3> = site.points.iter().map(|p| p.as_vec3()).collect();
    let Growth { mut branching, iterations, unreached, stop, captured: _ } =
        growth::grow(&points, &start, &rule, monitor)?;
    if iterations == 0 {
        let (points, kill_m) = (points.len(), rule.kill);
        return Err(GrowError::NothingGrew { points, reached: points - unreached, kill_m });
    }
    notes.extend(stop_note(stop, unreached, points.len(), settings));
    notes.extend(site.notes);

    let shift = settings.shift(site.root, site.origin, site.moves_to_root);
    if settings.moves_to_root(site.moves_to_root) && (site.origin + site.root).length() > 0.0 {
        let DVec3 { x, y, z } = site.origin + site.root;
        notes.push(format!(
            "moved to the origin: the root was at {x:.3}, {y:.3}, {z:.3} (Y up); origin=keep leaves it there"
        ));
    }
    for position in branching.positions.iter_mut().chain(&mut points) {
        *position = (position.as_dvec3() + shift).as_vec3();
    }
    notes.extend(check_precision(site.root + shift, step_m)?);
    Ok(Plant { branching, points, unreached, iterations, notes })
}

/// Refuses a place where single precision, which all mesh formats have, cannot hold the tree, and
/// says so where it can but shows.
fn check_precision(root: DVec3, step_m: f64) -> Result<Option<String>, GrowError> {
    let farthest_m = root.abs().max_element();
    // Between neighbouring numbers of this size.
    let gap_m = farthest_m * f64::from(f32::EPSILON);
    if !(gap_m <= step_m / 8.0) {
        return Err(GrowError::TooFar { farthest_m, gap_m, step_m });
    }
    Ok((gap_m > step_m / 100.0).then(|| {
        format!("{farthest_m:.0} m from the origin, coordinates are rounded to {gap_m:.1e} m: origin=root is more exact")
    }))
}

/// Refuses a trunk of more segments than there may be nodes, before it is built.
fn check_trunk(segments: f64, max_nodes: u32) -> Result<(), GrowError> {
    if segments >= f64::from(max_nodes) {
        return Err(GrowError::TrunkTooLong { segments: segments.ceil(), max_nodes });
    }
    Ok(())
}

fn stop_note(stop: Stop, unreached: usize, points: usize, settings: &Colonization) -> Option<String> {
    let left = format!("{unreached} of {points} points were not reached");
    match stop {
        Stop::AllReached => None,
        Stop::NothingInReach => {
            // A few stragglers are usual; many mean that the crown is in pieces.
            (unreached * 20 > points)
                .then(|| format!("{left}: they lie beyond the influence distance; raise influence"))
        }
        Stop::Stalled => Some(format!("{left}: the step is too short for coordinates of this size")),
        Stop::Blocked => Some(format!("{left}: obstacles or max_children were in the way")),
        Stop::MaxIterations => {
            Some(format!("{left}: growth stopped at max_iterations={}", settings.max_iterations))
        }
        Stop::MaxNodes => Some(format!("{left}: growth stopped at max_nodes={}", settings.max_nodes)),
    }
}

impl Colonization {
    /// Whether the tree is moved to stand on the origin.
    fn moves_to_root(&self, unless_told: bool) -> bool {
        match self.origin {
            Origin::Root => true,
            Origin::Keep => false,
            Origin::Auto => unless_told,
        }
    }

    /// From the coordinates of the [`Site`] to where the tree is to stand.
    fn shift(&self, root: DVec3, origin: DVec3, moves_unless_told: bool) -> DVec3 {
        if self.moves_to_root(moves_unless_told) { -root } else { origin }
    }

    /// The axis that points up in an input file.
    fn up(&self, default: Up) -> Up {
        match self.up {
            UpAxis::Y => Up::Y,
            UpAxis::Z => Up::Z,
            UpAxis::Auto => default,
        }
    }

    /// The root that the user gave, turned to Y up.
    fn given_root(&self, up: Up) -> Option<DVec3> {
        self.root.map(|root| {
            let mut place = [DVec3::from_array(root)];
            up.to_y_up(&mut place);
            place[0]
        })
    }
}

impl Site {
    /// The rule in metres, and what to say about it.
    fn rule(&self, settings: &Colonization) -> (GrowthRule, Vec<String>) {
        let step = settings.step_m.unwrap_or(self.suggested.step);
        let metres = |length: Length, suggested: Length| match (length, suggested) {
            (Length::Metres(x), _) | (Length::Auto, Length::Metres(x)) => x,
            (Length::Steps(x), _) | (Length::Auto, Length::Steps(x)) => x * step,
            (Length::Auto, Length::Auto) => step,
        };
        let kill = metres(settings.kill, self.suggested.kill);
        let influence = metres(settings.influence, self.suggested.influence);
        let mut notes = Vec::new();
        if influence > WIDE_INFLUENCE_STEPS * step
            && settings.influence != Length::Auto
            && self.points.len() >= 100_000
        {
            notes.push("influence is beyond 20 steps, which costs much time and changes little".to_owned());
        }
        let rule = GrowthRule {
            step: step as f32,
            influence: influence as f32,
            kill: kill as f32,
            tropism: DVec3::from_array(settings.tropism).as_vec3(),
            max_iterations: settings.max_iterations,
            max_nodes: settings.max_nodes,
            habit: Habit::PLAIN,
        };
        (rule, notes)
    }
}

/// A crown, and where it is to stand.
struct Standing {
    crown: Box<dyn Crown>,
    /// From the crown's own coordinates to those of the [`Site`]: up, metres.
    lift: f64,
    /// As in [`Site`].
    root: DVec3,
    /// As in [`Site`].
    origin: DVec3,
    notes: Vec<String>,
}

impl Standing {
    /// A crown shape on top of the trunk.
    fn shape(
        settings: &Colonization,
        shape: &str,
        dimensions: &[(&'static str, crate::knob::Value)],
    ) -> Result<Self, GrowError> {
        let crown = crown::shape(shape)?.of(dimensions)?;
        let height = f64::from(crown.bounds().max.y);
        let lift = settings.crown_base_m.or(settings.trunk_m).unwrap_or(BASE_PER_CROWN_HEIGHT * height);
        let origin = settings.given_root(Up::Y).unwrap_or(DVec3::ZERO);
        Ok(Self { crown, lift, root: DVec3::ZERO, origin, notes: Vec::new() })
    }

    /// A mesh, which stands where its file has it.
    fn envelope(
        settings: &Colonization,
        mesh: &crate::input::TriangleMesh,
        up: Up,
        monitor: &dyn Monitor,
    ) -> Result<Self, GrowError> {
        let mut mesh = mesh.clone();
        up.to_y_up(&mut mesh.positions);
        let envelope = Envelope::new(&mesh, monitor)?;
        let foot = envelope.foot();
        let height = f64::from(envelope.bounds().max.y);
        // A crown that hangs over the ground of its file stands on a trunk; one that sits on it, or is
        // nowhere near it, grows from its own base.
        let clearance = if (0.0..=height).contains(&foot.y) { foot.y } else { 0.0 };
        let root = settings.given_root(up).map_or(DVec3::NEG_Y * clearance, |root| root - foot);
        let notes = envelope.report().warnings();
        Ok(Self { crown: Box::new(envelope), lift: 0.0, root, origin: foot, notes })
    }

    /// Fills it with points.
    fn fill(self, settings: &Colonization, key: Key, monitor: &dyn Monitor) -> Result<Site, GrowError> {
        let Self { crown, lift, root, origin, notes } = self;
        let mut points = scatter::scatter(&*crown, settings.points as usize, key.named("points"), monitor)?;
        if lift != 0.0 {
            recenter(&mut points, -DVec3::Y * lift);
        }
        let spacing_m = libm::cbrt(crown.volume_m3() / f64::from(settings.points));
        let suggested = Suggested::for_volume(spacing_m);
        Ok(Site { points, root, origin, suggested, moves_to_root: false, notes })
    }
}

/// Polylines that draw the crown of a recipe, metres, where the tree of [`crate::grow::grow`]
/// stands. None for L-systems and given points, which have no crown to draw.
///
/// ```
/// use linden::{Quiet, colonization::outline, preset::builtin, recipe::Recipe};
/// let preset = builtin("cypress").unwrap().load().map_err(|fault| fault.message)?;
/// assert!(!outline(&Recipe { preset, input: None }, &Quiet)?.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of growing that have to do with the crown: its dimensions, its mesh; cancelled.
pub fn outline(recipe: &Recipe, monitor: &dyn Monitor) -> Result<Vec<Vec<Vec3>>, GrowError> {
    let Generator::Colonization(settings) = &recipe.preset.generator else { return Ok(Vec::new()) };
    let standing = match (&settings.space, recipe.input.as_ref().map(|input| (&input.geometry, input.up))) {
        (Space::Shape { shape, dimensions }, _) => Standing::shape(settings, shape, dimensions)?,
        (Space::Envelope { .. }, Some((Geometry::Mesh(mesh), up))) => {
            Standing::envelope(settings, mesh, settings.up(up), monitor)?
        }
        (Space::Envelope { file }, _) => {
            return Err(GrowError::WrongInput { file: file.clone(), expected: "a mesh" });
        }
        (Space::Points { .. }, _) => return Ok(Vec::new()),
    };
    let shift = settings.shift(standing.root, standing.origin, false) + DVec3::Y * standing.lift;
    let mut lines = standing.crown.outline();
    for place in lines.iter_mut().flatten() {
        *place = (place.as_dvec3() + shift).as_vec3();
    }
    Ok(lines)
}

/// Points that somebody measured, moved near the origin.
fn at_points(
    settings: &Colonization,
    points: &[DVec3],
    up: Up,
    key: Key,
    monitor: &dyn Monitor,
) -> Result<Site, GrowError> {
    let mut points = points.to_vec();
    up.to_y_up(&mut points);
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let origin = if points.is_empty() { DVec3::ZERO } else { ((low + high) * 0.5).round() };
    recenter(&mut points, origin);
    let given_root = settings.given_root(up).map(|root| root - origin);
    if settings.contract {
        let scan = scan::prepare(&points, settings.step_m, monitor)?;
        return Ok(Site {
            points: scan.points,
            root: given_root.unwrap_or(scan.root),
            origin,
            suggested: Suggested {
                step: scan.step_m,
                kill: Length::Metres(scan.kill_m),
                influence: Length::Metres(scan.influence_m),
            },
            moves_to_root: true,
            notes: scan_notes(&scan.report),
        });
    }
    let spacing_m = scan::point_spacing_m(&points).unwrap_or(1.0);
    let root = match given_root {
        Some(root) => root,
        None => scan::foot(&points).ok_or(growth::GrowthError::NoPoints)?,
    };
    // Lattices and mirrored models make pulls cancel.
    scatter::jitter(&mut points, spacing_m * 1e-3, key.named("jitter"));
    Ok(Site {
        points,
        root,
        origin,
        suggested: Suggested::for_volume(spacing_m),
        moves_to_root: true,
        notes: Vec::new(),
    })
}

fn scan_notes(report: &scan::ScanReport) -> Vec<String> {
    let mut notes = Vec::new();
    if report.ground_points > 0 {
        notes.push(format!("{} points were taken for ground and left out", report.ground_points));
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
    use super::*;
    use crate::grow::grow;
    use crate::monitor::Quiet;
    use crate::preset::builtin;
    use crate::scene::Bounds;

    fn recipe(id: &str, settings: &[(&str, &str)]) -> Recipe {
        let row = builtin(id).unwrap();
        let mut preset = row.load().unwrap_or_else(|fault| panic!("{id}: {fault}"));
        for (knob, value) in settings {
            preset.set(knob, value).unwrap();
        }
        let input = preset
            .space()
            .and_then(|space| Some(Input::read(space.file()?, row.input(space)?, &Quiet).unwrap()));
        Recipe { preset, input }
    }

    #[test]
    fn the_outline_stands_where_the_points_are() {
        let cases: [(&str, &[(&str, &str)]); 7] = [
            ("fir", &[]),
            ("cypress", &[("crown_base", "3")]),
            ("sphere", &[("root", "5,2,-3")]),
            ("sphere", &[("root", "5,2,-3"), ("origin", "root")]),
            ("heart", &[]),
            ("heart", &[("origin", "root")]),
            ("simple", &[("origin", "keep")]),
        ];
        for (id, settings) in cases {
            let recipe = recipe(id, settings);
            let points = grow(&recipe, &Quiet).unwrap().colonized.unwrap().points;
            let lines = outline(&recipe, &Quiet).unwrap();
            let bounds = |places: &mut dyn Iterator<Item = Vec3>| Bounds::of(places).unwrap();
            let (inner, outer) = (bounds(&mut points.into_iter()), bounds(&mut lines.into_iter().flatten()));
            // Many points in a solid come near its box on all sides; cuts through a mesh miss its ends
            // by at most an eighth.
            let slack = outer.size().max_element() * 0.15;
            for (a, b) in [(inner.min, outer.min), (inner.max, outer.max)] {
                assert!((a - b).abs().max_element() < slack, "{id} {settings:?}: {a} {b}");
            }
        }
    }

    #[test]
    fn what_has_no_crown_has_no_outline() {
        assert_eq!(outline(&recipe("abop-c", &[]), &Quiet).unwrap(), Vec::<Vec<Vec3>>::new());
        let missing = Recipe { input: None, ..recipe("heart", &[]) };
        assert!(matches!(outline(&missing, &Quiet), Err(GrowError::WrongInput { .. })));
    }
}
