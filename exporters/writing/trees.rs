//! The trees of a stage as tables number them: from 1, over all plants in the order of their places. A plant of several
//! trees (a stand whose trees compete, the trees of a table) is as many, in the order of their first feet; the stems of a
//! stool are one.
//!
//! Nodes, axes and organs are numbered from 0 in each tree, so that all tables of a stage say the same of them.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use linden_pipeline::foliage::{DressedOrgan, MeasuredOrgans};
use linden_pipeline::memory::bytes_of;
use linden_pipeline::scene::Scene;
use linden_pipeline::skeleton::{Skeleton, TreeIndex};
use linden_pipeline::stage::Place;

/// A tree where it stands.
#[derive(Clone, Debug)]
pub struct NumberedTree<'a> {
    /// From 1.
    pub number: u32,
    /// Where its plant stands.
    pub place: &'a Place,
    /// Its wood.
    pub skeleton: Cow<'a, Skeleton>,
    /// Of its plant.
    scene: &'a Scene,
    /// The organs of that, measured for all of its trees by the first that is asked for them.
    measured: Arc<OnceLock<MeasuredOrgans<'a>>>,
    /// What of the scene is this tree's; `None`: all.
    part: Option<Part>,
}

/// What of a scene is one tree's.
#[derive(Clone, Debug)]
struct Part {
    /// Indices of its organs.
    organs: Vec<u32>,
    /// Of the whole plant.
    index: Arc<TreeIndex>,
}

impl Part {
    /// The number that a node of the plant has in its tree.
    fn node(&self, node: u32) -> u32 {
        self.index.nodes.get(node as usize).map_or(node, |[_, number]| *number)
    }
}

/// All trees of some plants, as [`validate::trees`](super::validate::trees) gives them.
pub fn numbered<'a>(plants: &[(&'a Place, &'a Scene)]) -> impl Iterator<Item = NumberedTree<'a>> {
    let trees = plants.iter().flat_map(|&(place, scene)| of_plant(place, scene));
    (1..).zip(trees).map(|(number, tree)| NumberedTree { number, ..tree })
}

/// Bytes that [`numbered`] takes at once.
pub fn bytes(plants: &[(&Place, &Scene)]) -> u64 {
    let of_plant = |scene: &Scene| match scene.skeleton.split_bytes() {
        0 => 0,
        // Lists that grow are reserved twice as long.
        skeletons => skeletons + bytes_of::<[u32; 2]>(scene.organs.len()),
    };
    plants.iter().map(|(_, scene)| of_plant(scene)).max().unwrap_or(0)
}

/// The trees of a plant, each with the number 0.
fn of_plant<'a>(place: &'a Place, scene: &'a Scene) -> Vec<NumberedTree<'a>> {
    let skeleton = &*scene.skeleton;
    let Some(index) = skeleton.tree_index().map(Arc::new) else {
        let skeleton = Cow::Borrowed(skeleton);
        return vec![NumberedTree {
            number: 0,
            place,
            skeleton,
            scene,
            measured: Arc::default(),
            part: None,
        }];
    };
    let mut organs = vec![Vec::new(); index.count];
    for (organ, node) in (0..).zip(scene.organs.nodes()) {
        // What hangs on no node is the first tree's.
        let tree = index.nodes.get(node as usize).map_or(0, |[tree, _]| *tree);
        organs[tree as usize].push(organ);
    }
    let measured = Arc::default();
    let trees = skeleton.split(&index).into_iter().zip(organs);
    let tree = |(skeleton, organs)| {
        let part = Some(Part { organs, index: Arc::clone(&index) });
        let (skeleton, measured) = (Cow::Owned(skeleton), Arc::clone(&measured));
        NumberedTree { number: 0, place, skeleton, scene, measured, part }
    };
    trees.map(tree).collect()
}

impl NumberedTree<'_> {
    /// How many organs it bears.
    pub fn organs(&self) -> usize {
        self.part.as_ref().map_or_else(|| self.scene.organs.len(), |part| part.organs.len())
    }

    /// The node of its skeleton that each organ hangs on.
    pub fn organ_nodes(&self) -> Vec<u32> {
        let all: Vec<u32> = self.scene.organs.nodes().collect();
        let Some(part) = &self.part else { return all };
        part.organs.iter().map(|&organ| part.node(all[organ as usize])).collect()
    }

    /// Calls back with a range of its organs, in their order.
    pub fn each_organ(&self, range: Range<usize>, mut with: impl FnMut(usize, &DressedOrgan<'_>)) {
        let measured = self.measured.get_or_init(|| self.scene.organs.measured());
        let Some(part) = &self.part else { return measured.each(range, with) };
        for number in range {
            let organ = part.organs[number] as usize;
            measured.each(organ..organ + 1, |_, organ| {
                with(number, &DressedOrgan { node: part.node(organ.node), ..*organ });
            });
        }
    }
}
