//! Space colonization written straight from its definition, as slow as that is: every iteration
//! looks at every pair of a live point and a node. What the library's growth must equal bit for bit.
//! The definition is the documentation of `linden::colonization::growth`.

use linden::colonization::{GrowthRule, Stop};
use linden::{Branching, DVec3, Vec3};

/// What a tree has grown to, and why it stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    pub branching: Branching,
    pub iterations: u32,
    pub unreached: usize,
    pub stop: Stop,
}

/// Finds for each point the nearest node, of equally near ones the one with the lowest index, and
/// the squared distance. A parameter, so that benchmarks can put a faster search in its place.
pub type Nearest = fn(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)>;

/// Looks at each pair.
pub fn each_pair(points: &[Vec3], nodes: &[Vec3]) -> Vec<(usize, f32)> {
    points
        .iter()
        .map(|&s| {
            let mut best = (0, f32::INFINITY);
            for (v, &node) in nodes.iter().enumerate() {
                let d2 = distance2(s, node);
                if d2 < best.1 {
                    best = (v, d2);
                }
            }
            best
        })
        .collect()
}

pub fn distance2(a: Vec3, b: Vec3) -> f32 {
    let (x, y, z) = (a.x - b.x, a.y - b.y, a.z - b.z);
    x * x + y * y + z * z
}

/// Grows as defined. Points must be fit for use and the rule consistent.
pub fn grow(points: &[Vec3], start: &Branching, rule: &GrowthRule, nearest: Nearest) -> Grown {
    let mut tree = start.clone();
    let mut live = points.to_vec();
    let kill2 = rule.kill * rule.kill;
    let influence2 = rule.influence * rule.influence;
    let mut iterations = 0;
    let mut cut = false;
    let mut previous: Vec<Vec<Vec3>> = Vec::new();

    let stop = loop {
        // Kill, and influence of those that live.
        let mut sets = vec![Vec::new(); tree.positions.len()];
        let mut survivors = Vec::new();
        for (&s, (v, d2)) in live.iter().zip(nearest(&live, &tree.positions)) {
            if d2 > kill2 {
                survivors.push(s);
                if d2 <= influence2 {
                    sets[v].push(s);
                }
            }
        }
        live = survivors;
        if live.is_empty() {
            break Stop::AllReached;
        }
        if cut {
            break Stop::MaxNodes;
        }
        previous.resize(sets.len(), Vec::new());

        // Growth.
        let mut children = Vec::new();
        for v in 0..sets.len() {
            if !sets[v].is_empty() && sets[v] != previous[v] {
                children.extend(pulled(&tree, v, &sets[v], rule).map(|child| (v, child)));
            }
        }
        // Rescue.
        if children.is_empty() {
            for (v, set) in sets.iter().enumerate() {
                let nearest = set.iter().copied().min_by(|&a, &b| {
                    let (da, db) = (distance2(a, tree.positions[v]), distance2(b, tree.positions[v]));
                    da.total_cmp(&db)
                        .then(a.x.total_cmp(&b.x))
                        .then(a.y.total_cmp(&b.y))
                        .then(a.z.total_cmp(&b.z))
                });
                if let Some(s) = nearest {
                    let offset = s.as_dvec3() - tree.positions[v].as_dvec3();
                    children.extend(child(&tree, v, offset / length(offset), rule.step).map(|c| (v, c)));
                }
            }
        }
        if children.is_empty() {
            let none = sets.iter().all(Vec::is_empty);
            break if none { Stop::NothingInReach } else { Stop::Stalled };
        }
        if iterations == rule.max_iterations {
            break Stop::MaxIterations;
        }
        let room = (rule.max_nodes as usize).saturating_sub(tree.positions.len());
        if room == 0 {
            break Stop::MaxNodes;
        }
        iterations += 1;
        cut = children.len() > room;
        for &(v, child) in children.iter().take(room) {
            tree.positions.push(child);
            tree.parents.push(v as u32);
            tree.births.push(iterations);
        }
        previous = sets;
    };
    Grown { branching: tree, iterations, unreached: live.len(), stop }
}

/// The child that the points of `set` pull from node `v`.
fn pulled(tree: &Branching, v: usize, set: &[Vec3], rule: &GrowthRule) -> Option<Vec3> {
    let mut sum = [0_i64; 3];
    for &s in set {
        let offset = s - tree.positions[v];
        let scale = 1_073_741_824_f32 / distance2(s, tree.positions[v]).max(1e-30).sqrt();
        for axis in 0..3 {
            sum[axis] += (offset[axis] * scale) as i64;
        }
    }
    if sum == [0; 3] {
        return None;
    }
    let sum = DVec3::new(sum[0] as f64, sum[1] as f64, sum[2] as f64);
    let bent = sum / length(sum) + rule.tropism.as_dvec3();
    if bent.abs().max_element() <= 1e-9 {
        return None;
    }
    child(tree, v, bent / length(bent), rule.step)
}

/// One step from node `v`, unless nothing new would come of it.
fn child(tree: &Branching, v: usize, direction: DVec3, step: f32) -> Option<Vec3> {
    let from = tree.positions[v];
    let child = (from.as_dvec3() + f64::from(step) * direction).as_vec3();
    let known = (0..tree.positions.len()).any(|c| tree.parents[c] == v as u32 && tree.positions[c] == child);
    (child != from && !known).then_some(child)
}

fn length(v: DVec3) -> f64 {
    (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}
