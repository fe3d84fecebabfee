//! What a draft of a large tree leaves out.

use linden_pipeline::{NO_PARENT, Skeleton};

/// About as many nodes as a draft shows.
const DRAFT_NODES: f32 = 60_000.0;
/// Ink that those who stay add for those who are missing: 1 would be all of it, but wider twigs also
/// hide each other more.
const COMPENSATION: f32 = 0.7;
/// No twig is drawn wider than this many times.
const WIDEST: f32 = 4.0;

/// Which axes stand for all.
///
/// Each axis is kept with a chance in proportion to how many axes it carries, itself included, so
/// that boughs stay and twigs are thinned out evenly all over the crown; an axis that carries one
/// that is kept is kept too. It depends on the skeleton alone: as the camera turns, nothing comes or
/// goes.
pub(crate) struct Thinned {
    /// How much wider; 0 for axes that are left out.
    widen: Vec<f32>,
}

impl Thinned {
    /// `None` when all can be kept.
    pub fn new(skeleton: &Skeleton) -> Option<Self> {
        if skeleton.positions.len() as f32 <= DRAFT_NODES {
            return None;
        }
        let mut axis_of = vec![0_u32; skeleton.positions.len()];
        for (i, axis) in skeleton.axes.iter().enumerate() {
            for &node in skeleton.nodes_of(axis) {
                axis_of[node as usize] = i as u32;
            }
        }
        // Laterals come after the axes that they leave from.
        let carrier = |i: usize| match skeleton.axes[i].parent {
            NO_PARENT => None,
            parent => Some(axis_of[parent as usize] as usize).filter(|&carrier| carrier < i),
        };
        let mut carried = vec![1.0_f32; skeleton.axes.len()];
        for i in (0..skeleton.axes.len()).rev() {
            if let Some(carrier) = carrier(i) {
                carried[carrier] += carried[i];
            }
        }
        let share = share(skeleton, &carried);
        let mut widen: Vec<f32> = carried
            .iter()
            .enumerate()
            .map(|(i, &carried)| {
                let chance = (share * carried).min(1.0);
                let widen = libm::powf(chance, -COMPENSATION).min(WIDEST);
                if skeleton.axes[i].parent == NO_PARENT || scattered(i) < chance { widen } else { 0.0 }
            })
            .collect();
        for i in (0..widen.len()).rev() {
            if let Some(carrier) = carrier(i).filter(|&carrier| widen[i] > 0.0 && widen[carrier] == 0.0) {
                widen[carrier] = 1.0;
            }
        }
        Some(Self { widen })
    }

    /// How much wider an axis is drawn; `None` when it is left out.
    pub fn widening(&self, axis: usize) -> Option<f32> {
        Some(self.widen[axis]).filter(|&widen| widen > 0.0)
    }
}

/// The chance of an axis that carries no other, so that about as many nodes are kept as there may be.
fn share(skeleton: &Skeleton, carried: &[f32]) -> f32 {
    let kept = |share: f32| -> f32 {
        skeleton.axes.iter().zip(carried).map(|(axis, n)| axis.len as f32 * (share * n).min(1.0)).sum()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..12 {
        let middle = f32::midpoint(low, high);
        *if kept(middle) < DRAFT_NODES { &mut low } else { &mut high } = middle;
    }
    f32::midpoint(low, high)
}

/// Evenly over 0..1 for consecutive numbers: multiples of the golden ratio (Weyl's sequence).
fn scattered(i: usize) -> f32 {
    (i as u32).wrapping_mul(0x9E37_79B9) as f32 / 4_294_967_296.0
}
