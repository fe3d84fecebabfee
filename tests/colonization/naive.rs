//! Space colonization written straight from its definition, as slow as that is: every iteration
//! looks at every pair of a live point and a node. What the library's growth must equal bit for bit.
//! The definition is the documentation of `linden::colonization::growth`.

use linden::growth::{Attraction, GrowthHabit, GrowthRule, Meet, Obstacle, Stop};
use linden::{Branching, DVec3, NO_PARENT, Vec3};

/// What a tree has grown to, and why it stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    pub branching: Branching,
    pub iterations: u32,
    pub unreached: usize,
    pub stop: Stop,
    /// Nodes that ever had or killed a point, ascending.
    pub captured: Vec<usize>,
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
#[allow(clippy::too_many_lines, reason = "the definition is read in one piece")]
pub fn grow(
    points: &[Vec3],
    start: &Branching,
    rule: &GrowthRule,
    obstacles: &[Obstacle],
    nearest: Nearest,
) -> Grown {
    let habit = &rule.habit;
    let mut tree = start.clone();
    let wave_of = |index: usize| index * habit.waves as usize / points.len();
    let mut dormant: Vec<Vec<Vec3>> = Vec::new();
    for wave in 0..habit.waves as usize {
        dormant.push((0..points.len()).filter(|&i| wave_of(i) == wave).map(|i| points[i]).collect());
    }
    dormant.retain(|wave| !wave.is_empty());
    let mut live = dormant.remove(0);
    let mut since_wave = 0;

    let kill2 = rule.kill * rule.kill;
    let influence2 = rule.influence * rule.influence;
    let mut iterations = 0;
    let mut cut = false;
    let mut previous: Vec<Vec<Vec3>> = Vec::new();
    // Nodes whose set changed since they were last asked to grow.
    let mut due: Vec<bool> = Vec::new();
    let mut captured = vec![false; tree.positions.len()];

    let stop = loop {
        // Kill, and influence of those that live.
        let nodes = tree.positions.len();
        captured.resize(nodes, false);
        let mut felt_by = vec![Vec::new(); nodes];
        let mut survivors = Vec::new();
        for (&s, (v, d2)) in live.iter().zip(nearest(&live, &tree.positions)) {
            if d2 > kill2 {
                survivors.push(s);
                if d2 <= influence2 {
                    felt_by[v].push(s);
                    captured[v] = true;
                }
            } else {
                captured[v] = true;
            }
        }
        live = survivors;
        if live.is_empty() && dormant.is_empty() {
            break Stop::AllReached;
        }
        if cut {
            break Stop::MaxNodes;
        }
        let interval_is_over = habit.wave_interval > 0 && since_wave >= habit.wave_interval;
        if !dormant.is_empty() && (live.is_empty() || interval_is_over) {
            live.extend(dormant.remove(0));
            since_wave = 0;
            continue;
        }

        // What pulls.
        let sets: Vec<Vec<Vec3>> = match habit.attraction {
            Attraction::Nearest => felt_by.clone(),
            Attraction::All => (0..nodes)
                .map(|v| {
                    let felt = |&&s: &&Vec3| distance2(s, tree.positions[v]) <= influence2;
                    if felt_by[v].is_empty() {
                        Vec::new()
                    } else {
                        live.iter().filter(felt).copied().collect()
                    }
                })
                .collect(),
        };
        previous.resize(nodes, Vec::new());
        due.resize(nodes, false);

        // Growth.
        let axes = axes(&tree);
        let mut children = Vec::new();
        let mut waiting = Vec::new();
        for v in 0..nodes {
            due[v] |= sets[v] != previous[v];
            if due[v] && !sets[v].is_empty() && waits(&tree, &axes, v, iterations, habit) {
                waiting.push(v);
            } else if std::mem::take(&mut due[v]) && !sets[v].is_empty() {
                children.extend(pulled(&tree, &axes, v, &sets[v], rule, obstacles).map(|child| (v, child)));
            }
        }
        if children.is_empty() {
            for v in waiting {
                due[v] = false;
                children.extend(pulled(&tree, &axes, v, &sets[v], rule, obstacles).map(|child| (v, child)));
            }
        }
        previous = sets;
        // Rescue.
        let mut blocked = false;
        if children.is_empty() {
            for (v, set) in felt_by.iter().enumerate() {
                let nearest = set.iter().copied().min_by(|&a, &b| {
                    let (da, db) = (distance2(a, tree.positions[v]), distance2(b, tree.positions[v]));
                    da.total_cmp(&db)
                        .then(a.x.total_cmp(&b.x))
                        .then(a.y.total_cmp(&b.y))
                        .then(a.z.total_cmp(&b.z))
                });
                if let Some(s) = nearest {
                    let offset = s.as_dvec3() - tree.positions[v].as_dvec3();
                    match child(&tree, v, offset / length(offset), rule, obstacles) {
                        Ok(grown) => children.extend(grown.map(|c| (v, c))),
                        Err(Blocked) => blocked = true,
                    }
                }
            }
        }
        if children.is_empty() && !dormant.is_empty() {
            live.extend(dormant.remove(0));
            since_wave = 0;
            continue;
        }
        if children.is_empty() {
            break match felt_by.iter().all(Vec::is_empty) {
                true => Stop::NothingInReach,
                false if blocked => Stop::Blocked,
                false => Stop::Stalled,
            };
        }
        if iterations == rule.max_iterations {
            break Stop::MaxIterations;
        }
        let room = (rule.max_nodes as usize).saturating_sub(nodes);
        if room == 0 {
            break Stop::MaxNodes;
        }
        iterations += 1;
        since_wave += 1;
        cut = children.len() > room;
        for &(v, child) in children.iter().take(room) {
            tree.positions.push(child);
            tree.parents.push(v as u32);
            tree.births.push(iterations);
        }
    };
    let unreached = live.len() + dormant.iter().map(Vec::len).sum::<usize>();
    let captured = (0..captured.len()).filter(|&v| captured[v]).collect();
    Grown { branching: tree, iterations, unreached, stop, captured }
}

/// Where a node stands.
struct Place {
    order: usize,
    root: usize,
    /// Internodes from the base of the axis.
    rank: usize,
    /// The last node of the axis.
    tip: usize,
}

fn children(tree: &Branching, v: usize) -> impl Iterator<Item = usize> {
    (v + 1..tree.parents.len()).filter(move |&c| tree.parents[c] == v as u32)
}

fn axes(tree: &Branching) -> Vec<Place> {
    let mut first_child = vec![None; tree.parents.len()];
    for (c, &parent) in tree.parents.iter().enumerate() {
        if parent != NO_PARENT {
            first_child[parent as usize].get_or_insert(c);
        }
    }
    let mut places: Vec<Place> = Vec::new();
    for (v, &parent) in tree.parents.iter().enumerate() {
        let mut tip = v;
        while let Some(next) = first_child[tip] {
            tip = next;
        }
        let place = match places.get(parent as usize) {
            None => Place { order: 0, root: v, rank: 0, tip },
            Some(on) if first_child[parent as usize] == Some(v) => {
                Place { order: on.order, root: on.root, rank: on.rank + 1, tip }
            }
            Some(off) => Place { order: off.order + 1, root: off.root, rank: 1, tip },
        };
        places.push(place);
    }
    places
}

/// Whether apical control holds node `v` back.
fn waits(tree: &Branching, axes: &[Place], v: usize, iterations: u32, habit: &GrowthHabit) -> bool {
    let tip = axes[v].tip;
    let grows = iterations == 0 || tree.births[tip] == iterations;
    let free_share = 1.0 - f64::from(habit.apical_control);
    tip != v && grows && axes[v].rank as f64 > free_share * axes[tip].rank as f64
}

/// The child that the points of `set` pull from node `v`.
fn pulled(
    tree: &Branching,
    axes: &[Place],
    v: usize,
    set: &[Vec3],
    rule: &GrowthRule,
    obstacles: &[Obstacle],
) -> Option<Vec3> {
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
    let bent = sum / length(sum) + bend(tree, &axes[v], v, rule);
    if bent.abs().max_element() <= 1e-9 {
        return None;
    }
    child(tree, v, bent / length(bent), rule, obstacles).unwrap_or(None)
}

/// What is added to the pull at node `v`.
fn bend(tree: &Branching, place: &Place, v: usize, rule: &GrowthRule) -> DVec3 {
    let order = if place.tip == v { place.order } else { place.order + 1 };
    let by_order = |list: &[f32]| match list {
        [] => 0.0,
        _ => f64::from(list[order.min(list.len() - 1)]),
    };
    let light = rule.habit.light.as_dvec3();
    let mut bend = rule.tropism.as_dvec3() + light / length(light) * by_order(&rule.habit.phototropism);
    let offset = tree.positions[v].as_dvec3() - tree.positions[place.root].as_dvec3();
    let lever = (offset.x * offset.x + offset.z * offset.z).sqrt();
    bend.y += by_order(&rule.habit.gravitropism) - f64::from(rule.habit.gravity) * lever;
    bend
}

/// An obstacle or the number of children forbids it.
struct Blocked;

/// One step from node `v`, unless nothing new would come of it.
fn child(
    tree: &Branching,
    v: usize,
    direction: DVec3,
    rule: &GrowthRule,
    obstacles: &[Obstacle],
) -> Result<Option<Vec3>, Blocked> {
    if children(tree, v).count() >= rule.habit.max_children as usize {
        return Err(Blocked);
    }
    let from = tree.positions[v];
    let place = |n: DVec3| (from.as_dvec3() + f64::from(rule.step) * n).as_vec3();
    let hits = |obstacle: &Obstacle, to: Vec3| {
        (obstacle.contains)(to.as_dvec3()) || (obstacle.contains)((from.as_dvec3() + to.as_dvec3()) * 0.5)
    };
    let mut child = place(direction);
    let met: Vec<&Obstacle> = obstacles.iter().filter(|obstacle| hits(obstacle, child)).collect();
    if met.iter().any(|obstacle| obstacle.meet == Meet::Stop) {
        return Err(Blocked);
    }
    if !met.is_empty() {
        let side = if direction.y.abs() > 0.99 { DVec3::X } else { DVec3::Y };
        let u = (side - direction * direction.dot(side)).normalize();
        let w = direction.cross(u);
        let mut free = None;
        for t in (15..=90).step_by(15) {
            for a in [0, 45, -45, 90, -90, 135, -135, 180] {
                let [t, a] = [t, a].map(|degrees| f64::from(degrees) * std::f64::consts::PI / 180.0);
                let n = direction * libm::cos(t) + (u * libm::cos(a) + w * libm::sin(a)) * libm::sin(t);
                let to = place(n);
                if free.is_none() && !obstacles.iter().any(|obstacle| hits(obstacle, to)) {
                    free = Some(to);
                }
            }
        }
        child = free.ok_or(Blocked)?;
    }
    let known = children(tree, v).any(|c| tree.positions[c] == child);
    match child == from || known {
        false => Ok(Some(child)),
        true if met.is_empty() => Ok(None),
        true => Err(Blocked),
    }
}

fn length(v: DVec3) -> f64 {
    (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}
