//! Nodes: what stands where, at which level of detail.

use std::collections::{BTreeMap, BTreeSet};

use glam::{Affine3A, Mat4, Quat, Vec3};

use super::accessor::Buffers;
use super::document::{Document, Node};
use super::{ReadError, beyond, broken};
use crate::asset::{Aspect, Asset};
use crate::read::MOST_PLACES;
use crate::read::arrange::{Drawn, arrange};

/// `pieces` are the asset's meshes of each mesh of the document.
pub(super) fn read(
    asset: &mut Asset,
    document: &Document,
    buffers: &Buffers<'_>,
    pieces: &[Vec<usize>],
) -> Result<(), ReadError> {
    let levels: BTreeSet<usize> = document
        .nodes
        .iter()
        .filter_map(|node| node.extensions.lod.as_ref())
        .flat_map(|lod| lod.ids.clone())
        .collect();
    let above = |(index, node): (usize, &Node)| {
        node.children.iter().map(move |child| (*child, index)).collect::<Vec<_>>()
    };
    let parents = document.nodes.iter().enumerate().flat_map(above).collect();
    let mut walk = Walk {
        document,
        buffers,
        pieces,
        parents,
        levels,
        visited: BTreeSet::new(),
        drawn: Vec::new(),
        left: MOST_PLACES,
    };
    let scene = document.scenes.get(document.scene.unwrap_or(0));
    let roots: Vec<usize> = match scene {
        Some(scene) => scene.nodes.clone(),
        None => {
            let children: BTreeSet<usize> =
                document.nodes.iter().flat_map(|node| node.children.clone()).collect();
            (0..document.nodes.len()).filter(|node| !children.contains(node)).collect()
        }
    };
    for root in roots {
        walk.from(asset, root)?;
    }
    let drawn = walk.drawn;
    arrange(asset, drawn);
    Ok(())
}

struct Walk<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    pieces: &'a [Vec<usize>],
    /// The node above each that has one.
    parents: BTreeMap<usize, usize>,
    /// Nodes that are a coarser level of another.
    levels: BTreeSet<usize>,
    visited: BTreeSet<usize>,
    drawn: Vec<Drawn>,
    /// Places that there may still be.
    left: usize,
}

/// A node that is to be looked at.
struct Next {
    node: usize,
    place: Affine3A,
    level: Option<u32>,
    above: Vec<String>,
}

/// Names above a node that count.
const MOST_ABOVE: usize = 8;

impl Walk<'_> {
    fn from(&mut self, asset: &mut Asset, root: usize) -> Result<(), ReadError> {
        let mut next = vec![Next { node: root, place: Affine3A::IDENTITY, level: None, above: Vec::new() }];
        while let Some(Next { node: index, place, level, above }) = next.pop() {
            // A coarser level may stand among the children, too.
            if level.is_none() && self.levels.contains(&index) {
                continue;
            }
            let node =
                self.document.nodes.get(index).ok_or_else(|| broken(format!("there is no node {index}")))?;
            if !self.visited.insert(index) {
                return Err(broken(format!("node {index} is in the scene twice")));
            }
            let at = place * transform(node);
            let lod = node.extensions.lod.as_ref().filter(|_| level.is_none());
            let level = if lod.is_some() { Some(0) } else { level };
            self.draw(asset, node, at, level, &above)?;
            for (number, &id) in (1..).zip(lod.iter().flat_map(|lod| &lod.ids)) {
                next.push(Next { node: id, place, level: Some(number), above: above.clone() });
            }
            let name = node.name.clone().unwrap_or_default();
            let below: Vec<String> = std::iter::once(name).chain(above).take(MOST_ABOVE).collect();
            for &child in node.children.iter().rev() {
                next.push(Next { node: child, place: at, level, above: below.clone() });
            }
        }
        Ok(())
    }

    fn draw(
        &mut self,
        asset: &mut Asset,
        node: &Node,
        at: Affine3A,
        level: Option<u32>,
        above: &[String],
    ) -> Result<(), ReadError> {
        let Some(mesh) = node.mesh else { return Ok(()) };
        let meshes = self.pieces.get(mesh).ok_or_else(|| broken(format!("there is no mesh {mesh}")))?;
        let too_many = || beyond(format!("its meshes have more than {MOST_PLACES} places"));
        let bound = node.skin.map(|skin| self.bound(skin)).transpose()?.flatten();
        let places = match &node.extensions.instancing {
            None => vec![bound.unwrap_or(at)],
            Some(instancing) => {
                let of = |name: &str| instancing.attributes.get(name).copied();
                let attributes = ["TRANSLATION", "ROTATION", "SCALE"].map(of);
                let count = attributes.into_iter().flatten().next();
                let count = count.map_or(Ok(1), |index| self.buffers.count(index))?;
                let all = count.saturating_mul(meshes.len().max(1));
                self.left = self.left.checked_sub(all).ok_or_else(too_many)?;
                let packed = attributes.into_iter().flatten().find_map(|index| self.buffers.packed(index));
                match packed {
                    None => self.instances(attributes)?.into_iter().map(|instance| at * instance).collect(),
                    Some(packed) => {
                        asset.note(Aspect::Places, format!("{packed} is not unpacked"));
                        // As many as there are, for the count of triangles.
                        vec![at; count]
                    }
                }
            }
        };
        for &mesh in meshes {
            let node = node.name.clone().unwrap_or_default();
            self.drawn.push(Drawn { mesh, node, places: places.clone(), level, above: above.to_vec() });
        }
        Ok(())
    }

    /// Where a mesh is that is bound to joints, at rest: where the first of them is, wherever its own node stands.
    fn bound(&self, skin: usize) -> Result<Option<Affine3A>, ReadError> {
        let nodes = &self.document.nodes;
        let skin = self.document.skins.get(skin).ok_or_else(|| broken(format!("there is no skin {skin}")))?;
        let Some(&joint) = skin.joints.first() else { return Ok(None) };
        let mut unbind = Affine3A::IDENTITY;
        if let Some(matrices) = skin.inverse_bind_matrices {
            if self.buffers.packed(matrices).is_some() {
                return Ok(None);
            }
            let values = self.buffers.values(matrices)?;
            let matrix = values.rows().next().and_then(|row| row.first_chunk::<16>());
            unbind = matrix.map_or(unbind, |matrix| Affine3A::from_mat4(Mat4::from_cols_array(matrix)));
        }
        let (mut place, mut at) = (Affine3A::IDENTITY, Some(joint));
        // No way up is longer than there are nodes.
        for _ in 0..nodes.len() {
            let Some(index) = at else { break };
            let node = nodes.get(index).ok_or_else(|| broken(format!("there is no node {index}")))?;
            place = transform(node) * place;
            at = self.parents.get(&index).copied();
        }
        Ok(Some(place * unbind))
    }

    fn instances(
        &self,
        [translation, rotation, scale]: [Option<usize>; 3],
    ) -> Result<Vec<Affine3A>, ReadError> {
        let vectors = |index: Option<usize>| {
            index
                .map(|index| self.buffers.values(index))
                .transpose()
                .map(|values| values.map(|values| values.vectors()))
        };
        let (translations, scales) = (vectors(translation)?, vectors(scale)?);
        let rotations = rotation.map(|index| self.buffers.values(index)).transpose()?;
        let rotations: Option<Vec<Quat>> = rotations.map(|values| {
            values
                .rows()
                .map(|row| if let &[x, y, z, w] = row { Quat::from_xyzw(x, y, z, w) } else { Quat::IDENTITY })
                .collect()
        });
        let lengths = [
            translations.as_ref().map(Vec::len),
            rotations.as_ref().map(Vec::len),
            scales.as_ref().map(Vec::len),
        ];
        let count = lengths.into_iter().flatten().next().unwrap_or(1);
        if lengths.into_iter().flatten().any(|length| length != count) {
            return Err(broken("instances have places, turns and scales of other numbers"));
        }
        let of = |i: usize| {
            let scale = scales.as_ref().map_or(Vec3::ONE, |list| list[i]);
            let rotation = rotations.as_ref().map_or(Quat::IDENTITY, |list| list[i]);
            let translation = translations.as_ref().map_or(Vec3::ZERO, |list| list[i]);
            Affine3A::from_scale_rotation_translation(scale, rotation, translation)
        };
        Ok((0..count).map(of).collect())
    }
}

fn transform(node: &Node) -> Affine3A {
    match node.matrix {
        Some(matrix) => Affine3A::from_mat4(Mat4::from_cols_array(&matrix)),
        None => Affine3A::from_scale_rotation_translation(
            node.scale.map_or(Vec3::ONE, Vec3::from),
            node.rotation.map_or(Quat::IDENTITY, Quat::from_array),
            node.translation.map_or(Vec3::ZERO, Vec3::from),
        ),
    }
}
