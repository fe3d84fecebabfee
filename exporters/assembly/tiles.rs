//! An assembly of glTF files as a tileset of 3D Tiles 1.1 (OGC 22-025r4).
//!
//! A quadtree over the ground: what is within a node is not loaded before it would be larger than a few pixels.
//! Inner nodes are empty. glTF is Y up and tiles are Z up; readers turn the files as they load them, so (x, y, z)
//! becomes (x, -z, y).

use glam::DVec3;
use linden_pipeline::Monitor;
use serde_json::json;

use super::{Assembly, Box3, MemberPlace};
use crate::gltf::percent_encoded;
use crate::{Bundle, ExportError, GENERATOR, Sink};

/// The most plants of a node that is not divided.
const MOST_IN_NODE: usize = 8;
/// The most divisions: plants at the same place are not to be told apart.
const MOST_LEVELS: usize = 32;
/// What a box is wider than what it holds, by its diagonal: quantized vertices and turned leaves are not exactly
/// where they were measured.
const MARGIN: f64 = 1e-3;

/// What a plant takes while a tileset is written, rather more than less: its line and how it is made.
const LEAF_BYTES: u64 = 2048;

/// A plant at its place.
struct Leaf<'a> {
    place: &'a MemberPlace,
    /// Around the plant where it stands, Z up.
    around: Box3,
    /// The tile's line.
    tile: String,
}

pub(super) fn write(
    assembly: &Assembly,
    bundle: &mut Bundle,
    monitor: &dyn Monitor,
) -> Result<(), ExportError> {
    let bytes = LEAF_BYTES.saturating_mul(assembly.places.len() as u64);
    monitor.admit("writing a tileset", bytes, "take fewer trees")?;
    let leaves: Vec<Leaf<'_>> = assembly
        .placed()
        .map(|(place, member)| {
            let bounds = widened(Box3::from(member.bounds));
            let around = turned_up(place.around(bounds));
            let tile = json!({
                "boundingVolume": { "box": volume(turned_up(bounds)) },
                "geometricError": 0,
                "transform": transform(place),
                "content": { "uri": uri(&member.file) },
                "extras": { "index": member.index, "source": member.source, "seed": member.seed },
            });
            Leaf { place, around, tile: tile.to_string() }
        })
        .collect();
    bundle.write_main(None, monitor, |out| {
        let all: Vec<&Leaf<'_>> = leaves.iter().collect();
        let asset = json!({ "version": "1.1", "generator": GENERATOR, "extras": { "name": assembly.name } });
        let error = error_of(&all);
        out.write(format!("{{\"asset\":{asset},\"geometricError\":{error},\"root\":\n").as_bytes())?;
        write_node(out, all, 0)?;
        out.write(b"\n}\n")
    })
}

fn write_node(out: &mut Sink<'_>, leaves: Vec<&Leaf<'_>>, level: usize) -> Result<(), ExportError> {
    let nothing = Box3 { min: DVec3::ZERO, max: DVec3::ZERO };
    let around = leaves.iter().map(|leaf| leaf.around).reduce(Box3::union).unwrap_or(nothing);
    let (volume, error) = (json!(volume(around)), error_of(&leaves));
    let refine = if level == 0 { ",\"refine\":\"ADD\"" } else { "" };
    out.write(
        format!("{{\"boundingVolume\":{{\"box\":{volume}}},\"geometricError\":{error}{refine}").as_bytes(),
    )?;
    // A list of children is not empty.
    if leaves.is_empty() {
        return out.write(b"}");
    }
    out.write(b",\"children\":[")?;
    let mut is_first = true;
    let mut next = |out: &mut Sink<'_>| {
        let between: &[u8] = if is_first { b"\n" } else { b",\n" };
        is_first = false;
        out.write(between)
    };
    match quarters(&leaves, level) {
        None => {
            for leaf in leaves {
                next(out)?;
                out.write(leaf.tile.as_bytes())?;
            }
        }
        Some(quarters) => {
            for quarter in quarters.into_iter().filter(|quarter| !quarter.is_empty()) {
                next(out)?;
                write_node(out, quarter, level + 1)?;
            }
        }
    }
    out.write(b"]}")
}

/// The plants of a node by the quarter of its ground that they stand on; `None` for few, or all at one place.
fn quarters<'a, 'b>(leaves: &[&'a Leaf<'b>], level: usize) -> Option<[Vec<&'a Leaf<'b>>; 4]> {
    if leaves.len() <= MOST_IN_NODE || level >= MOST_LEVELS {
        return None;
    }
    let point = |leaf: &Leaf<'_>| Box3 { min: leaf.place.position, max: leaf.place.position };
    let middle = leaves.iter().map(|leaf| point(leaf)).reduce(Box3::union)?.middle();
    let mut quarters: [Vec<&Leaf<'_>>; 4] = Default::default();
    for leaf in leaves {
        let at = leaf.place.position;
        quarters[usize::from(at.x > middle.x) + 2 * usize::from(at.z > middle.z)].push(leaf);
    }
    quarters.iter().all(|quarter| quarter.len() < leaves.len()).then_some(quarters)
}

/// How far from the truth it is to leave these plants out: as far as the largest of them reaches.
fn error_of(leaves: &[&Leaf<'_>]) -> f64 {
    leaves.iter().map(|leaf| (leaf.around.max - leaf.around.min).length()).fold(0.0, f64::max)
}

/// From Y up to Z up.
fn turned_up(Box3 { min, max }: Box3) -> Box3 {
    Box3 { min: DVec3::new(min.x, -max.z, min.y), max: DVec3::new(max.x, -min.z, max.y) }
}

fn widened(Box3 { min, max }: Box3) -> Box3 {
    let margin = DVec3::splat(MARGIN * (max - min).length());
    Box3 { min: min - margin, max: max + margin }
}

/// The middle and three half axes.
fn volume(around: Box3) -> [f64; 12] {
    let middle = around.middle();
    let half = (around.max - around.min) / 2.0;
    [middle.x, middle.y, middle.z, half.x, 0.0, 0.0, 0.0, half.y, 0.0, 0.0, 0.0, half.z]
}

/// Where a plant stands, column by column.
fn transform(place: &MemberPlace) -> [f64; 16] {
    let (sin, cos) = libm::sincos(place.turn_rad);
    let (sin, cos, scale) = (sin * place.scale, cos * place.scale, place.scale);
    let DVec3 { x, y, z } = place.position;
    [cos, sin, 0.0, 0.0, -sin, cos, 0.0, 0.0, 0.0, 0.0, scale, 0.0, x, -z, y, 1.0]
}

/// A path as a URI reference.
fn uri(path: &str) -> String {
    let names: Vec<String> = path.trim_start_matches("./").split('/').map(percent_encoded).collect();
    names.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_uris() {
        assert_eq!(uri("./ab/cdef.glb"), "ab/cdef.glb");
        assert_eq!(uri("../my trees #1/é.glb"), "../my%20trees%20%231/%C3%A9.glb");
    }

    #[test]
    fn transforms_are_those_of_the_place_seen_from_z_up() {
        let position = DVec3::new(3.0, 0.5, -7.0);
        let place = MemberPlace { member: 0, position, turn_rad: 1.1, scale: 1.5 };
        let up = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
        let matrix = glam::DMat4::from_cols_array(&transform(&place));
        for point in [DVec3::X, DVec3::Y, DVec3::new(0.3, 2.0, -4.0)] {
            let expected = position + glam::DQuat::from_rotation_y(1.1) * (point * 1.5);
            assert!(matrix.transform_point3(up(point)).distance(up(expected)) < 1e-12);
        }
    }
}
