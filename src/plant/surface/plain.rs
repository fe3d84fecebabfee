//! Tubes that need no look at their triangles one by one: plain ones, checked as they are laid.
//!
//! A tube is plain where nothing but rings shapes it: no flare, collar or root, no step of the radius, no bend that
//! could fold it, neighbouring rings of as many sides, a bud at its tip. What joins the vertices of such a tube is
//! said by the sides of its rings and by where they stand twice, its *joints*. So the first tube with some joints is
//! swept and its edges are counted; of all others with the same joints the places are computed, four corners at a
//! time, with the operations of the [sweep](super::tube) and so to the last bit. [`is_sound`] then looks at each
//! triangle.
//!
//! This only ever says yes. Whatever is not sound for certain is left to the check that looks at the mesh.

use std::collections::BTreeSet;

use glam::{Vec3, Vec4};

use super::Survey;
use super::features::Ends;
use super::path::Ring;
use super::tube::Wraps;
use super::tube_form::{Circle, Roundness, TubeForm};
use linden_base::mesh::Bounds;
use linden_base::topology::{SOUND, Topology, is_sound};

const LANES: usize = Circle::LANES;
/// Kinds of joints that are kept. Of further ones each tube is swept.
const MOST_KINDS: usize = 1 << 12;
/// Rings of the longest tube whose joints are kept.
const MOST_RINGS: usize = 1 << 8;

/// Vectors side by side, component by component.
type Vectors = [Vec4; 3];

/// Some neighbouring corners of a ring as the sweep places them.
#[derive(Clone, Copy, Debug, Default)]
struct Corners {
    places: Vectors,
    normals: Vectors,
}

/// Checks plain tubes.
#[derive(Debug, Default)]
pub(super) struct PlainTubes {
    /// Joints of tubes that were swept and found sound.
    proved: BTreeSet<Vec<u16>>,
    /// Of the tube that is looked at: the sides of each ring, and whether the next band begins with a ring of its
    /// own.
    joints: Vec<u16>,
    /// The ring that was laid last, and the one below it.
    rings: [Vec<Corners>; 2],
}

/// What was found of a tube.
pub(super) enum Found {
    /// It is sound: all that is to be known of it.
    Sound(Survey),
    /// It may be plain. If it is sound, [`PlainTubes::learn`] its joints.
    New(Survey),
    /// It has to be swept.
    Unknown,
}

impl PlainTubes {
    /// Looks at a tube.
    pub fn look(&mut self, rings: &[Ring], form: &TubeForm, roundness: &Roundness, tile_m: f32) -> Found {
        let Some(survey) = self.sound(rings, form, roundness, tile_m) else { return Found::Unknown };
        if self.proved.contains(&self.joints) { Found::Sound(survey) } else { Found::New(survey) }
    }

    /// Remembers the joints of the tube that was looked at last, of which `measured` was found on its mesh.
    pub fn learn(&mut self, looked: &Survey, measured: &Survey) {
        // What does not see the same as the mesh shows proves nothing.
        if looked == measured && self.proved.len() < MOST_KINDS {
            self.proved.insert(self.joints.clone());
        }
    }

    /// The tube, if all its triangles are sound and its joints do what such joints do.
    fn sound(
        &mut self,
        rings: &[Ring],
        form: &TubeForm,
        roundness: &Roundness,
        tile_m: f32,
    ) -> Option<Survey> {
        let shaped = form.flare.is_some() || form.collar.is_some() || form.root.is_some() || form.is_bent;
        let (base, apex) = (rings.first()?, rings.last()?);
        if shaped || form.ends != Ends::Bud || rings.len() > MOST_RINGS || base.mitre != Vec3::ZERO {
            return None;
        }
        let widest_m = rings.iter().fold(0.0_f32, |widest, ring| widest.max(ring.radius));
        let coordinates = [(apex.along + apex.radius) / tile_m, 1e3 * widest_m / tile_m];
        if rings.iter().any(Ring::steps) || !coordinates.iter().all(|x| x.is_finite()) {
            return None;
        }
        self.joints.clear();
        let (mut vertices, mut triangles) = (0, 0);
        let mut boxed = [[Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]];
        let (mut before, mut pictures) = (None, Wraps::default());
        let mut below = None;
        for (i, ring) in rings.iter().enumerate() {
            let circle = form.circle(ring, ring.radius, roundness);
            let sides = circle.sides() as usize;
            self.rings.swap(0, 1);
            let [above, under] = &mut self.rings;
            place(ring, slope(rings, i), circle, above, &mut boxed);
            match below.replace(sides) {
                None => {
                    vertices += sides;
                    triangles += sides - 2;
                    if !is_disc_sound(above, sides, -ring.tangent) {
                        return None;
                    }
                }
                Some(same) if same == sides => {
                    triangles += 2 * sides;
                    if !is_band_sound(under, above, sides) {
                        return None;
                    }
                }
                Some(_) => return None,
            }
            let wraps = rings.get(i + 1).map(|next| pictures.between(ring, next, form, tile_m));
            let stands_twice = i > 0 && wraps.is_some() && wraps != before;
            vertices += (sides + 1) * (1 + usize::from(stands_twice));
            self.joints.push((sides as u16) << 1 | u16::from(stands_twice));
            before = wraps;
        }
        let sides = below.filter(|_| rings.len() > 1)?;
        vertices += sides;
        triangles += sides;
        let point = apex.center + apex.tangent * apex.radius;
        if !is_bud_sound(&self.rings[0], sides, point, apex.tangent) {
            return None;
        }
        let bounds = Bounds {
            min: Vec3::from(boxed[0].map(Vec4::min_element)).min(point),
            max: Vec3::from(boxed[1].map(Vec4::max_element)).max(point),
        };
        Some(Survey { vertices, triangles, bounds: Some(bounds), topology: Topology::default() })
    }
}

/// As [`Wall::slope`](super::tube) has it for rings that do not step.
fn slope(rings: &[Ring], i: usize) -> f32 {
    let between = |a: &Ring, b: &Ring| (a.radius - b.radius) / (b.along - a.along);
    let before = i.checked_sub(1).map(|below| between(&rings[below], &rings[i]));
    let after = rings.get(i + 1).map(|above| between(&rings[i], above));
    match (before, after) {
        (Some(x), Some(y)) => f32::midpoint(x, y),
        (one, other) => one.or(other).unwrap_or(0.0),
    }
}

fn splat(vector: Vec3) -> Vectors {
    vector.to_array().map(Vec4::splat)
}

fn add(a: Vectors, b: Vectors) -> Vectors {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn subtract(a: Vectors, b: Vectors) -> Vectors {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn scale(a: Vectors, by: Vec4) -> Vectors {
    a.map(|x| x * by)
}

fn dot(a: Vectors, b: Vectors) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vectors, b: Vectors) -> Vectors {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

/// Computes the corners of a ring, and widens a box by them.
fn place(ring: &Ring, slope: f32, circle: &Circle, corners: &mut Vec<Corners>, boxed: &mut [Vectors; 2]) {
    let upright = 1.0 / (1.0 + slope * slope).sqrt();
    let lean = splat(ring.tangent * (slope * upright));
    let [center, side, across] = [ring.center, ring.side, ring.tangent.cross(ring.side)].map(splat);
    let reach_m = Vec4::splat(ring.radius * circle.reach);
    let squared = ring.mitre.length_squared();
    let mitre = (squared != 0.0).then(|| (splat(ring.mitre), Vec4::splat(squared.sqrt())));
    corners.clear();
    for &[cosines, sines] in &circle.lanes {
        let out = add(scale(side, cosines), scale(across, sines));
        let at = match mitre {
            None => out,
            Some((mitre, widest)) => add(out, scale(mitre, dot(mitre, out) / widest)),
        };
        let places = add(center, scale(at, reach_m));
        let normals = add(scale(out, Vec4::splat(upright)), lean);
        for axis in 0..3 {
            boxed[0][axis] = boxed[0][axis].min(places[axis]);
            boxed[1][axis] = boxed[1][axis].max(places[axis]);
        }
        corners.push(Corners { places, normals });
    }
}

/// Corners of a ring, and of each the next one; how many of them are of the ring.
fn each(ring: &[Corners], sides: usize) -> impl Iterator<Item = (Corners, Corners, usize)> {
    let next = |here: Vectors, ahead: Vectors| -> Vectors {
        std::array::from_fn(|axis| {
            let ([_, b, c, d], e) = (here[axis].to_array(), ahead[axis].x);
            Vec4::new(b, c, d, e)
        })
    };
    ring.iter().enumerate().filter(move |(i, _)| i * LANES < sides).map(move |(i, here)| {
        // Behind the last corners none counts.
        let ahead = ring.get(i + 1).unwrap_or(here);
        let places = next(here.places, ahead.places);
        let normals = next(here.normals, ahead.normals);
        (*here, Corners { places, normals }, LANES.min(sides - i * LANES))
    })
}

/// Whether the first `count` of some triangles are sound, one a lane: [`is_sound`] of their corners and the sums of
/// their normals.
fn are_sound([p, q, r]: [Vectors; 3], leaning: Vectors, count: usize) -> bool {
    let (a, b) = (subtract(q, p), subtract(r, p));
    let (a2, b2) = (dot(a, a), dot(b, b));
    let facing = dot(cross(a, b), leaning);
    let [margin, least_squared, most_squared] = SOUND.map(Vec4::splat);
    let sound = a2.min(b2).cmpgt(least_squared)
        & dot(leaning, leaning).cmplt(most_squared)
        & facing.cmpgt(Vec4::ZERO)
        & (facing * facing).cmpgt(margin * (a2 * b2));
    let of_all = (1 << count) - 1;
    sound.bitmask() & of_all == of_all
}

/// The triangles that [`join`](super::tube) lays between two rings of as many sides.
fn is_band_sound(below: &[Corners], above: &[Corners], sides: usize) -> bool {
    each(below, sides).zip(each(above, sides)).all(|((a, a_next, count), (b, b_next, _))| {
        let lower = add(add(a.normals, a_next.normals), b.normals);
        let upper = add(add(a_next.normals, b_next.normals), b.normals);
        are_sound([a.places, a_next.places, b.places], lower, count)
            && are_sound([a_next.places, b_next.places, b.places], upper, count)
    })
}

/// Those of a flat base.
fn is_disc_sound(ring: &[Corners], sides: usize, normal: Vec3) -> bool {
    let place = |k: usize| {
        let Corners { places, .. } = &ring[k / LANES];
        Vec3::from(places.map(|component| component[k % LANES]))
    };
    (1..sides - 1).all(|k| is_sound([place(0), place(k + 1), place(k)], normal + normal + normal))
}

/// Those of a bud.
fn is_bud_sound(rim: &[Corners], sides: usize, point: Vec3, along: Vec3) -> bool {
    let (point, along) = (splat(point), splat(along));
    each(rim, sides).all(|(a, next, count)| {
        let leaning = add(add(a.normals, next.normals), along);
        are_sound([a.places, next.places, point], leaning, count)
    })
}

#[cfg(test)]
mod tests {
    use super::super::plan::{Course, Plan};
    use super::super::target::{Amount, Target};
    use super::super::tests::{gnarled, tree};
    use super::super::{Tubes, survey, sweep, topology, tube};
    use super::*;
    use linden_base::mesh::Mesh;
    use linden_base::monitor::Quiet;
    use linden_base::random::Key;
    use linden_skeleton::{NO_PARENT, Skeleton, Wood};

    /// What the mesh of a tube shows, all its edges counted.
    fn shown(rings: &[Ring], form: &TubeForm, roundness: &Roundness, tile_m: f32) -> Survey {
        let Amount { vertices, triangles, .. } = tube::amount(rings, form, roundness, tile_m);
        let mut mesh = Mesh::zeroed(vertices, triangles);
        let Mesh { positions, normals, uvs, triangles } = &mut mesh;
        let mut target = Target { positions, normals, uvs, triangles, first: 0, done: Amount::default() };
        tube::sweep(rings, form, roundness, tile_m, &mut target);
        Survey {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            bounds: mesh.bounds(),
            topology: topology(&mesh, &Quiet).unwrap(),
        }
    }

    /// A stem of many segments with a lateral on each but the last, all alike.
    fn comb(segments: u32) -> Skeleton {
        let (mut positions, mut parents) = (vec![Vec3::ZERO], vec![NO_PARENT]);
        let mut stem = 0;
        for i in 1..=segments {
            positions.push(Vec3::Y * i as f32);
            parents.push(stem);
            stem = positions.len() as u32 - 1;
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            for reach in [0.5, 1.0] {
                positions.push(Vec3::new(side * reach, i as f32 + reach, 0.0));
                parents.push(if reach == 0.5 { stem } else { positions.len() as u32 - 2 });
            }
        }
        tree(positions, parents, &Wood { tip_radius_m: Some(0.01), ..Wood::default() })
    }

    #[test]
    fn what_is_said_of_plain_tubes_is_what_their_meshes_show() {
        let (mut plain, mut all) = (0, 0);
        for seed in 0..60 {
            let skeleton = if seed == 0 { comb(300) } else { gnarled(seed) };
            let (sides, rings) = ([3, 4, 24, 100][seed as usize % 4], 1 + seed as u32 % 3);
            // Pictures of few centimetres: their number changes from ring to ring.
            let tubes = Tubes { sides, rings, bark_tile_m: 0.05, ..Tubes::default() };
            let course = Course::new(&skeleton, &tubes);
            let plan = Plan::new(&course, 0..skeleton.axes.len());
            let mut tubes = PlainTubes::default();
            for (rings, form) in plan.axes() {
                all += 1;
                if let Some(found) = tubes.sound(rings, form, &course.roundness, 0.05) {
                    plain += 1;
                    assert_eq!(found, shown(rings, form, &course.roundness, 0.05), "seed {seed}");
                }
            }
        }
        assert!(plain > all / 4 && plain < all, "{plain} of {all} tubes are plain");
    }

    /// Rings with something wrong: whatever is said to be sound must be.
    #[test]
    fn no_broken_tube_is_said_to_be_sound() {
        let skeleton = comb(41);
        let settings = Tubes { sides: 5, ..Tubes::default() };
        let course = Course::new(&skeleton, &settings);
        let plan = Plan::new(&course, 0..skeleton.axes.len());
        let mut tubes = PlainTubes::default();
        let mut seen = [0; 2];
        for seed in 0..4000 {
            let key = Key::new(seed);
            let index = 1 + (key.child(0).unit() * 40.0) as usize;
            let Some((rings, form)) = plan.axes().nth(index) else { panic!("no axis {index}") };
            let mut rings = rings.to_vec();
            let last = rings.len() - 1;
            let ring = (key.child(1).unit() * rings.len() as f64) as usize;
            let amount = key.child(2).between(-1.0, 1.0) as f32;
            let below = rings[ring.saturating_sub(1)].center;
            let here = &mut rings[ring];
            match seed % 10 {
                0 => here.center.y = f32::NAN,
                1 => (here.radius, here.onward) = (0.0, 0.0),
                2 => here.center = below,
                3 => here.side *= amount,
                4 => (here.radius, here.onward) = (-here.radius, -here.onward),
                5 => here.center += here.tangent * (2.0 * amount),
                6 => here.side = here.tangent,
                7 => here.tangent = -here.tangent,
                8 => here.mitre = here.side * amount,
                _ => (here.radius, here.onward) = (here.radius * 1e-9, here.onward * 1e-9),
            }
            let mesh = shown(&rings, form, &course.roundness, 0.5);
            let found = tubes.sound(&rings, form, &course.roundness, 0.5);
            assert!(found.is_none_or(|found| found == mesh), "seed {seed}, ring {ring} of {last}: {mesh:?}");
            seen[usize::from(mesh.topology == Topology::default())] += usize::from(found.is_none());
        }
        assert!(seen[0] > 2000, "{seen:?}: most of the damages make no sound tube");
    }

    #[test]
    fn joints_are_proved_by_a_mesh_that_is_sound_and_by_nothing_else() {
        let skeleton = comb(5);
        let settings = Tubes::default();
        let course = Course::new(&skeleton, &settings);
        let plan = Plan::new(&course, 0..skeleton.axes.len());
        let laterals: Vec<_> = plan.axes().skip(1).collect();
        let mut tubes = PlainTubes::default();
        let look = |tubes: &mut PlainTubes, i: usize| {
            let (rings, form) = laterals[i];
            match tubes.look(rings, form, &course.roundness, 0.5) {
                Found::Sound(_) => None,
                Found::New(survey) => Some(survey),
                Found::Unknown => panic!("a lateral is plain"),
            }
        };
        let first = look(&mut tubes, 0).unwrap();
        let with = |open_edges| Survey { topology: Topology { open_edges, ..Topology::default() }, ..first };
        // A sweep that left a hole, and one that wrote another vertex.
        tubes.learn(&first, &with(3));
        tubes.learn(&first, &Survey { vertices: first.vertices + 1, ..first });
        assert!(look(&mut tubes, 1).is_some());
        tubes.learn(&first, &with(0));
        assert!((1..4).all(|i| look(&mut tubes, i).is_none()));
    }

    #[test]
    fn one_broken_tube_among_many_alike_is_found() {
        for (what, broken) in [("endless", f32::INFINITY), ("as thick as numbers go", f32::MAX)] {
            let mut skeleton = comb(2000);
            let tubes = Tubes { sides: 3, ..Tubes::default() };
            let whole = survey(&skeleton, &tubes, &mut |_| (), &Quiet).unwrap();
            assert_eq!(whole.topology, Topology::default());
            let tip = skeleton.nodes_of(&skeleton.axes[1500])[1];
            skeleton.radii[tip as usize] = broken;
            let found = survey(&skeleton, &tubes, &mut |_| (), &Quiet).unwrap();
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            assert!(!found.topology.watertight(), "{what}: {found:?}");
            assert_eq!(found.topology, topology(&mesh, &Quiet).unwrap(), "{what}");
        }
    }
}
