//! Pieces of a graph of points, and the bridges between them.

use std::cmp::Reverse;

use glam::DVec3;

use super::links::LinkedTo;
use super::neighbours::Neighbours;
use linden_base::monitor::{Cancelled, Monitor};

/// Other pieces that a point is linked to at most.
const BRIDGES: usize = 6;

/// Bridges beyond the spanning tree's are looked for within this many reaches.
const BRIDGE_REACH: f64 = 10.0;

/// Links beyond those with the nearest, in both directions, that make all points one piece.
pub(super) fn bridges(
    points: &[DVec3],
    nearest: &[LinkedTo],
    reach: f64,
    monitor: &dyn Monitor,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    let mut pieces = Pieces::new(points.len());
    for (from, nearest) in (0..).zip(nearest) {
        for &to in nearest {
            pieces.join(from, to);
        }
    }
    let mut bridges = Vec::new();
    if pieces.is_one() {
        return Ok(bridges);
    }
    let tree = Neighbours::new(points, monitor)?;
    other_bridges(points, &tree, &mut pieces, reach, &mut bridges, monitor)?;
    loop {
        let shortest = shortest_bridges(points, &tree, &mut pieces, monitor)?;
        if shortest.is_empty() {
            break;
        }
        for (_, from, to) in shortest {
            if pieces.join(from, to) {
                bridges.extend([(from, to), (to, from)]);
            }
        }
    }
    bridges.sort_unstable();
    bridges.dedup();
    Ok(bridges)
}

/// Links each point outside the largest piece to the nearest point of several other pieces.
fn other_bridges(
    points: &[DVec3],
    tree: &Neighbours,
    pieces: &mut Pieces,
    reach: f64,
    links: &mut Vec<(u32, u32)>,
    monitor: &dyn Monitor,
) -> Result<(), Cancelled> {
    let (labels, largest) = pieces.labels();
    let of_ranges = tree.labels(&labels);
    let limit = (BRIDGE_REACH * reach) * (BRIDGE_REACH * reach);
    let mut nearest: Vec<(f64, u32, u32)> = Vec::new();
    for (from, &p) in (0..).zip(points) {
        if from % 256 == 0 {
            monitor.check()?;
        }
        if labels[from as usize] == largest {
            continue;
        }
        nearest.clear();
        tree.search_other(p, limit, (labels[from as usize], &of_ranges), |to, squared| {
            let label = labels[to as usize];
            match nearest.iter_mut().find(|other| other.2 == label) {
                Some(other) if (squared, to) < (other.0, other.1) => *other = (squared, to, label),
                Some(_) => {}
                None => nearest.push((squared, to, label)),
            }
            nearest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            nearest.truncate(BRIDGES);
            if nearest.len() == BRIDGES { nearest[BRIDGES - 1].0.next_up().min(limit) } else { limit }
        });
        links.extend(nearest.iter().flat_map(|&(_, to, _)| [(from, to), (to, from)]));
    }
    Ok(())
}

/// For each piece but the largest, its shortest link to another (one round of Borůvka 1926).
fn shortest_bridges(
    points: &[DVec3],
    tree: &Neighbours,
    pieces: &mut Pieces,
    monitor: &dyn Monitor,
) -> Result<Vec<(f64, u32, u32)>, Cancelled> {
    let (labels, largest) = pieces.labels();
    // A piece's points lie together: without passing over its ranges at once, each of them would look at all.
    let of_ranges = tree.labels(&labels);
    let mut best = vec![(f64::INFINITY, 0, 0); points.len()];
    for (from, &p) in (0..).zip(points) {
        if from % 1024 == 0 {
            monitor.check()?;
        }
        let label = labels[from as usize];
        if label == largest {
            continue;
        }
        let best = &mut best[label as usize];
        tree.search_other(p, best.0, (label, &of_ranges), |to, squared| {
            if (squared, from, to) < *best {
                *best = (squared, from, to);
            }
            best.0
        });
    }
    best.retain(|bridge| bridge.0.is_finite());
    best.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    Ok(best)
}

/// Which points hang together (disjoint sets, Tarjan 1975).
pub(super) struct Pieces(Vec<u32>);

impl Pieces {
    /// Each point by itself.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn is_one(&mut self) -> bool {
        (0..self.0.len() as u32).all(|i| self.of(i) == 0)
    }

    /// The piece that a point is in: its lowest point.
    pub fn of(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    /// The piece of each point, and the largest piece (the first of equals).
    fn labels(&mut self) -> (Vec<u32>, u32) {
        let labels: Vec<u32> = (0..self.0.len() as u32).map(|i| self.of(i)).collect();
        let mut sizes = vec![0_u32; labels.len()];
        for &label in &labels {
            sizes[label as usize] += 1;
        }
        let largest = (0..labels.len() as u32).max_by_key(|&i| (sizes[i as usize], Reverse(i)));
        (labels, largest.unwrap_or(0))
    }

    /// Whether they hung apart. The lower index names the piece.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linden_base::monitor::Quiet;

    #[test]
    fn pieces_far_apart_are_bridged_without_looking_at_all_pairs() {
        // Two walls of 60 by 60 points, 50 m apart.
        let wall = |x: f64| {
            (0..3600_u16).map(move |i| DVec3::new(x, 0.1 * f64::from(i / 60), 0.1 * f64::from(i % 60)))
        };
        let points: Vec<DVec3> = wall(0.0).chain(wall(50.0)).collect();
        let tree = Neighbours::new(&points, &Quiet).unwrap();
        let mut pieces = Pieces::new(points.len());
        for i in 1..3600 {
            pieces.join(0, i);
            pieces.join(3600, 3600 + i);
        }
        let bridges = shortest_bridges(&points, &tree, &mut pieces, &Quiet).unwrap();
        assert_eq!(bridges, [(2500.0, 3600, 0)]);
        // 3600 times 7200 are 26 million.
        assert!(tree.looks() < 400_000, "{}", tree.looks());
    }
}
