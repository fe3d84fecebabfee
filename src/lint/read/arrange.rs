//! Pieces into levels of detail and colliders, by what formats say and what nodes are called.

use glam::Affine3A;

use crate::asset::{Asset, Level, Piece};

/// A mesh in its places.
pub(super) struct Drawn {
    pub mesh: usize,
    pub node: String,
    pub places: Vec<Affine3A>,
    /// As the format says it; `None`: names may.
    pub level: Option<u32>,
    /// The names of the nodes above it, the nearest first.
    pub above: Vec<String>,
}

/// Beginnings of names: Unreal's.
const BEGINNINGS: [&str; 4] = ["ucx_", "ubx_", "ucp_", "usp_"];
/// Ends of names: Godot's, and common ones.
const ENDS: [&str; 6] = ["-col", "-colonly", "-convcol", "-convcolonly", "_collider", "_collision"];

fn is_collider(name: &str) -> bool {
    let name = name.to_lowercase();
    BEGINNINGS.iter().any(|beginning| name.starts_with(beginning))
        || ENDS.iter().any(|end| name.ends_with(end))
}

/// `oak_LOD2` is level 2, `Oak_LOD0_leaves` level 0.
pub(super) fn level_of(name: &str) -> Option<u32> {
    let name = name.to_lowercase();
    let (before, after) = name.rsplit_once("lod")?;
    if before.ends_with(|c: char| c.is_alphanumeric()) {
        return None;
    }
    let after = after.trim_start_matches(['_', '-', ' ']);
    let digits = after.find(|c: char| !c.is_ascii_digit()).map_or(after, |end| &after[..end]);
    digits.parse().ok()
}

/// Puts pieces into the asset. Those without a level are in all of them.
pub(super) fn arrange(asset: &mut Asset, drawn: Vec<Drawn>) {
    let (mut common, mut levels): (Vec<Piece>, Vec<Level>) = (Vec::new(), Vec::new());
    for drawn in drawn.into_iter().filter(|drawn| !drawn.places.is_empty()) {
        let names = || std::iter::once(&drawn.node).chain(&drawn.above);
        let is_collider = names().any(|name| is_collider(name));
        let level = drawn.level.or_else(|| names().find_map(|name| level_of(name)));
        let piece = Piece { mesh: drawn.mesh, node: drawn.node, places: drawn.places };
        match level {
            _ if is_collider => asset.colliders.push(piece),
            None => common.push(piece),
            Some(number) => match levels.iter_mut().find(|level| level.number == number) {
                Some(level) => level.pieces.push(piece),
                None => levels.push(Level { number, pieces: vec![piece] }),
            },
        }
    }
    levels.sort_by_key(|level| level.number);
    if levels.is_empty() {
        levels.push(Level::default());
    }
    for level in &mut levels {
        level.pieces.extend(common.iter().cloned());
    }
    asset.levels = levels;
}
