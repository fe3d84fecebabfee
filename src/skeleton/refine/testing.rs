//! Trees to refine.

use glam::Vec3;

use super::{Refinement, Room, refine};
use crate::{Branching, NO_PARENT};
use linden_base::monitor::Quiet;
use linden_base::random::Key;

pub fn tree(positions: Vec<Vec3>, parents: &[u32]) -> Branching {
    let births = (0..parents.len() as u32).collect();
    Branching { positions, parents: parents.to_vec(), births, radii: None, edges: None }
}

pub fn refined(all: Branching, refinement: &Refinement) -> Branching {
    let done = refine(all, None, &mut [], refinement, Room::open(1 << 20), &Quiet).unwrap();
    done.validate().unwrap();
    done
}

/// Random walks with forks: a node hangs below the one before it with a chance of `onward`, else
/// below any earlier one; two stems.
pub fn random_tree(seed: u64, len: u32, onward: f64) -> Branching {
    let key = Key::new(seed);
    let mut positions = vec![Vec3::ZERO, Vec3::X * 9.0];
    let mut parents = vec![NO_PARENT; 2];
    for i in 2..len {
        let k = key.child(i.into());
        let parent =
            if k.child(0).unit() < onward { i - 1 } else { (k.child(1).unit() * f64::from(i)) as u32 };
        let step = Vec3::from([2, 3, 4].map(|n| k.child(n).between(-0.5, 0.5) as f32)) + Vec3::Y * 0.6;
        positions.push(positions[parent as usize] + step);
        parents.push(parent);
    }
    tree(positions, &parents)
}

/// A stem along Y with uneven segments and, on (0, 4, 0), a lateral along X.
pub fn straight_with_lateral() -> Branching {
    let stem = [0.0, 1.0, 4.0, 4.5, 9.0, 9.1].map(|y| Vec3::Y * y);
    let lateral = [1.0, 1.5, 4.0].map(|x| Vec3::new(x, 4.0, 0.0));
    tree(stem.into_iter().chain(lateral).collect(), &[NO_PARENT, 0, 1, 2, 3, 4, 2, 6, 7])
}

/// Births of feet, numbers of children of forks in the order of the forks, births of tips: births
/// name nodes in these trees.
pub fn topology(b: &Branching) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let mut children = vec![0; b.parents.len()];
    for &parent in b.parents.iter().filter(|&&parent| parent != NO_PARENT) {
        children[parent as usize] += 1;
    }
    let births = |wanted: &dyn Fn(usize) -> bool| -> Vec<u32> {
        (0..b.parents.len()).filter(|&node| wanted(node)).map(|node| b.births[node]).collect()
    };
    let feet = births(&|node| b.parents[node] == NO_PARENT);
    let tips = births(&|node| children[node] == 0);
    (feet, children.into_iter().filter(|&count| count > 1).collect(), tips)
}

/// The sum of all turns of only children against their parents, radians per node.
pub fn bending(b: &Branching) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (node, &parent) in b.parents.iter().enumerate() {
        if parent == NO_PARENT || b.parents[parent as usize] == NO_PARENT {
            continue;
        }
        let siblings = b.parents.iter().filter(|&&other| other == parent).count();
        if siblings == 1 {
            let below = b.positions[b.parents[parent as usize] as usize];
            let before = b.positions[parent as usize] - below;
            sum += f64::from(before.angle_between(b.positions[node] - b.positions[parent as usize]));
            count += 1.0;
        }
    }
    sum / count
}
