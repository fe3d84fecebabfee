//! What a cloud looks like that is no scan of one tree in metres: a plot, a wall, a thing of another size.

use glam::{DMat3, DVec3};
use linden_base::monitor::Monitor;

use crate::ScanError;
use crate::frame::{range, sample};
use crate::plot::stems_of;
use crate::surface::eigen;

/// No scanned tree is lower, metres: a seedling on a table is, and a tree in kilometres.
const LOWEST_M: f64 = 0.3;

/// One tree is hardly wider than high by more than this.
const WIDE: f64 = 1.2;

/// Stems that are farther apart than this part of the height are of several trees.
const APART_PER_HEIGHT: f64 = 0.25;

/// The sides of the cubes in which points are held against a plane, metres; fewer points are not.
const CUBE_M: f64 = 1.0;
const LEAST_IN_CUBE: usize = 30;

/// Points lie on a plane where the least eigenvalue of their covariance is this part of the middle one: a wall is rough by some
/// centimetres, bark of a metre across is rounder.
const FLAT: f64 = 0.003;

/// A plane whose normal is farther off the level than this is no wall but ground.
const LEVEL: f64 = 0.2;

/// The share of points in cubes of walls from which on a cloud is one.
const LEAST_WALLS: f64 = 0.5;

/// All that is to be said of points that are taken for one tree; they and those of the ground are metres, Y up.
pub(crate) fn notes(
    points: &[DVec3],
    ground: &[DVec3],
    may_be_plot: bool,
    monitor: &dyn Monitor,
) -> Result<Vec<String>, ScanError> {
    let heights_m = || points.iter().map(|p| p.y);
    let height_m = heights_m().fold(f64::NEG_INFINITY, f64::max) - heights_m().fold(f64::INFINITY, f64::min);
    let plot = if may_be_plot { plot_note(points, ground, monitor)? } else { None };
    Ok([size_note(height_m), wall_note(points), plot].into_iter().flatten().collect())
}

/// What is said of a height that no tree has.
fn size_note(height_m: f64) -> Option<String> {
    (height_m > 0.0 && height_m < LOWEST_M).then(|| {
        format!(
            "the points are {height_m:.4} m high in all, as no scanned tree is: are they in kilometres or degrees? scale= says how many \
             metres a unit has"
        )
    })
}

/// What is said of points of several trees that were taken for one. `points` and those of the ground are metres, Y up. Where the
/// memory does not suffice nothing is looked for.
fn plot_note(points: &[DVec3], ground: &[DVec3], monitor: &dyn Monitor) -> Result<Option<String>, ScanError> {
    let sample = sample(points);
    let extent = |axis: usize| range(sample.iter().map(|p| p[axis])).map_or(0.0, |(low, high)| high - low);
    let (wide_m, height_m) = (extent(0).max(extent(2)), extent(1));
    if wide_m <= WIDE * height_m {
        return Ok(None);
    }
    let all = [points, ground].concat();
    let (count, apart_m) = match stems_of(&all, monitor) {
        Ok(found) => found,
        Err(ScanError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Err(_) => return Ok(None),
    };
    Ok((count > 1 && apart_m > APART_PER_HEIGHT * height_m).then(|| {
        format!(
            "it looks like a plot: {count} stems, up to {apart_m:.0} m apart, in points that are {wide_m:.0} m wide and {height_m:.0} m \
             high, and all of it was taken for one tree; segmentation=paths tells the trees apart"
        )
    }))
}

/// What is said of points that mostly lie on walls; metres, Y up.
fn wall_note(points: &[DVec3]) -> Option<String> {
    let mut sample: Vec<([i64; 3], DVec3)> = sample(points)
        .into_iter()
        .map(|p| (p.to_array().map(|x| libm::floor(x / CUBE_M) as i64), p))
        .collect();
    let count = sample.len();
    sample.sort_by_key(|(cube, _)| *cube);
    let cubes = sample.chunk_by(|a, b| a.0 == b.0).filter(|cube| cube.len() >= LEAST_IN_CUBE);
    let on_walls: usize = cubes.filter(|cube| is_wall(cube)).map(<[_]>::len).sum();
    (on_walls as f64 > LEAST_WALLS * count as f64).then(|| {
        format!(
            "{:.0} % of the points lie on upright planes, as of walls, and branches do not: what comes out is no tree",
            100.0 * on_walls as f64 / count as f64
        )
    })
}

/// Whether points lie on an upright plane, and not on a line.
fn is_wall(points: &[([i64; 3], DVec3)]) -> bool {
    let count = points.len() as f64;
    let mean = points.iter().map(|(_, p)| *p).sum::<DVec3>() / count;
    let product = |p: DVec3| DMat3::from_cols(p * p.x, p * p.y, p * p.z);
    let products = points.iter().map(|(_, p)| product(*p - mean)).fold(DMat3::ZERO, |sum, one| sum + one);
    let (values, vectors) = eigen(products * (1.0 / count));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let [least, middle, most] = order.map(|at| values[at]);
    least < FLAT * middle && middle > 0.05 * most && vectors.col(order[0]).y.abs() < LEVEL
}

#[cfg(test)]
mod tests {
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;

    use super::*;

    fn random(count: u64, name: &str, place: impl Fn(&[f64; 4]) -> DVec3) -> Vec<DVec3> {
        let key = Key::new(6).named(name);
        (0..count).map(|i| place(&[0, 1, 2, 3].map(|k| key.child(i).child(k).unit()))).collect()
    }

    /// A stem and a ball of spokes.
    fn tree(at: DVec3, name: &str) -> Vec<DVec3> {
        let mut points = random(8000, name, |[t, turn, ..]| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            at + DVec3::new(0.15 * cos, 8.0 * t, 0.15 * sin)
        });
        points.extend(random(6000, name, |[a, b, c, out]| {
            let way = DVec3::new(a - 0.5, b - 0.5, c - 0.5).normalize_or(DVec3::Y);
            at + DVec3::Y * 6.0 + 2.5 * out.sqrt() * way
        }));
        points
    }

    #[test]
    fn several_stems_in_a_wide_cloud_are_a_plot() {
        let one = tree(DVec3::ZERO, "a");
        assert_eq!(plot_note(&one, &[], &Quiet), Ok(None));
        let ground = random(20_000, "ground", |[x, z, ..]| DVec3::new(24.0 * x - 8.0, 0.0, 16.0 * z - 8.0));
        // Wide by its ground alone.
        assert_eq!(plot_note(&[&one[..], &ground].concat(), &[], &Quiet), Ok(None));
        let two = [&one[..], &tree(DVec3::X * 9.0, "b")].concat();
        let note = plot_note(&two, &ground, &Quiet).unwrap().unwrap();
        assert!(note.contains("2 stems, up to 9 m apart") && note.contains("segmentation=paths"), "{note}");
    }

    #[test]
    fn walls_are_noticed_and_trees_and_ground_are_none() {
        let rough = |x: f64| 0.02 * (x - 0.5);
        let wall = random(20_000, "wall", |[x, y, off, _]| DVec3::new(8.0 * x, 5.0 * y, rough(*off)));
        assert!(wall_note(&wall).unwrap().contains("upright planes"));
        let ground = random(20_000, "ground", |[x, z, off, _]| DVec3::new(8.0 * x, rough(*off), 8.0 * z));
        assert_eq!(wall_note(&ground), None);
        assert_eq!(wall_note(&tree(DVec3::ZERO, "a")), None);
        // A bole of a metre and a half across.
        let bole = random(20_000, "bole", |[turn, y, ..]| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            DVec3::new(0.75 * cos, 6.0 * y, 0.75 * sin)
        });
        assert_eq!(wall_note(&bole), None);
    }

    #[test]
    fn what_is_lower_than_trees_is_noticed() {
        assert!(size_note(0.0076).unwrap().contains("0.0076 m"));
        assert_eq!((size_note(0.5), size_note(0.0)), (None, None));
    }
}
