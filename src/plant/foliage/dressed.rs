//! Organs as a scene shows them: each with its place, its kind, its area and its colour.

use std::ops::Range;
use std::sync::Arc;

use super::fallen::{FallenLeaf, ShedLeaf};
use super::{LeafShape, Organs, PROTOTYPES, Placement, Shaper, opaque_shares};
use crate::texture::leaf::LeafError;
use linden_base::mesh::Mesh;
use linden_base::monitor::Monitor;
use linden_base::picture::Picture;
use linden_skeleton::organs::OrganClass;

/// All organs of a scene with what they are dressed in. Copies share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DressedOrgans {
    pub(super) organs: Arc<Organs>,
    /// As dressed, which are finer than those of the organs.
    pub(super) shapes: Arc<[LeafShape]>,
    /// By [`LeafShape::kind`].
    kinds: Arc<[DressedKind]>,
    /// Of a grammar's organs by their colour index, sRGB.
    colors: Arc<[[u8; 3]]>,
}

/// A kind of the preset's foliage, dressed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DressedKind {
    pub name: String,
    pub class: OrganClass,
    /// The picture that cuts its shapes out.
    pub mask: Option<Arc<Picture>>,
    /// A single leaf, where its shapes are drawn.
    pub shed: Option<ShedLeaf>,
}

/// An organ of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DressedOrgan<'a> {
    /// What it is.
    pub class: OrganClass,
    /// Of a kind of the foliage: its outline, or `mesh` or `picture` for the user's; of a grammar's: `polygon`, or
    /// the name of its prototype.
    pub kind: &'a str,
    /// Which of its kind's shapes it has, counted from 1; 0 for what a grammar places.
    pub variant: u32,
    /// The node of the skeleton that it hangs on.
    pub node: u32,
    /// Where it is attached, how it is turned, and how large one unit of its shape is. The shape begins at the origin,
    /// points along +Y and shows its upper side to +Z. A polygon has no shape: its scale is 1.
    pub placement: Placement,
    /// One side of its triangles, as far as its picture leaves them opaque, square metres.
    pub area_m2: f64,
    /// The derivation step in which it appeared.
    pub birth: u32,
    /// The mean colour of its shape, or what its grammar colours it with, sRGB.
    pub color: [u8; 3],
}

impl DressedOrgans {
    pub(crate) fn new(
        organs: Arc<Organs>,
        shapes: Arc<[LeafShape]>,
        kinds: Vec<DressedKind>,
        colors: &[[u8; 3]],
    ) -> Self {
        Self { organs, shapes, kinds: kinds.into(), colors: colors.into() }
    }

    /// How many there are: the polygons are counted first.
    pub fn len(&self) -> usize {
        self.organs.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.organs.is_empty()
    }

    /// Bytes that it holds on to, pictures and shapes aside.
    pub fn bytes(&self) -> u64 {
        self.organs.bytes()
    }

    /// The node that each organ hangs on.
    pub fn nodes(&self) -> impl Iterator<Item = u32> {
        let Organs { polygons, placed, .. } = &*self.organs;
        polygons.growth.nodes.iter().chain(&placed.growth.nodes).copied()
    }

    pub(crate) fn shapes(&self) -> &[LeafShape] {
        &self.shapes
    }

    /// Those of a grammar by their colour index, sRGB.
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// The organs as they grew.
    pub fn as_grown(&self) -> &Organs {
        &self.organs
    }

    /// The index of the colour that an organ of a grammar is drawn in.
    pub(super) fn color_slot(&self, color: u32) -> usize {
        (color as usize).min(self.colors.len().max(1) - 1)
    }

    /// The leaf that it sheds: of the kind that most of its leaves are; `None` without placed leaves.
    ///
    /// # Errors
    /// [`LeafError`]: cancelled.
    pub fn fallen_leaf(&self, monitor: &dyn Monitor) -> Result<Option<FallenLeaf>, LeafError> {
        let measured = self.measured();
        let kind_of = |shape: usize| {
            let shape = shape.checked_sub(PROTOTYPES.len()).and_then(|shape| self.shapes.get(shape));
            shape.map(|shape| usize::from(shape.kind))
        };
        // By kind, those of grammars first.
        let mut counts = vec![0_u32; 1 + self.kinds.len()];
        for &shape in &self.organs.placed.prototypes {
            let shape = usize::from(shape);
            let is_leaf = measured.shapes.get(shape).is_some_and(|shape| shape.class == OrganClass::Leaf);
            if let Some(count) = counts.get_mut(kind_of(shape).map_or(0, |kind| 1 + kind)).filter(|_| is_leaf)
            {
                *count += 1;
            }
        }
        let most = (0..counts.len()).max_by_key(|&kind| (counts[kind], usize::MAX - kind));
        let Some(most) = most.filter(|&kind| counts[kind] > 0) else { return Ok(None) };
        let kind = most.checked_sub(1).map(|kind| &self.kinds[kind]);
        if let Some(shed) = kind.and_then(|kind| kind.shed.as_ref()) {
            return shed.draw(monitor).map(Some);
        }
        let is_of = |&(shape, _): &(usize, &MeasuredShape<'_>)| kind_of(shape) == most.checked_sub(1);
        let simplest = measured
            .shapes
            .iter()
            .enumerate()
            .filter(is_of)
            .filter(|(_, shape)| shape.class == OrganClass::Leaf)
            .map(|(shape, _)| match shape.checked_sub(PROTOTYPES.len()) {
                None => PROTOTYPES[shape].mesh(),
                Some(shape) => &self.shapes[shape].mesh,
            })
            .min_by_key(|mesh| mesh.triangles.len());
        let sizes = self.organs.placed.prototypes.iter().zip(&self.organs.placed.sizes_m);
        let sizes = sizes.filter(|(shape, _)| kind_of(usize::from(**shape)) == most.checked_sub(1));
        let size_m = sizes.map(|(_, size_m)| f64::from(*size_m)).sum::<f64>() / f64::from(counts[most]);
        let picture = kind.and_then(|kind| kind.mask.clone());
        Ok(simplest.map(|mesh| FallenLeaf::of(vec![mesh.clone()], picture, size_m as f32)))
    }

    /// Measures each shape once, for [`MeasuredOrgans::each`].
    pub fn measured(&self) -> MeasuredOrgans<'_> {
        let plain = |prototype: &'static super::Prototype| MeasuredShape {
            class: prototype.class,
            kind: prototype.name,
            variant: 0,
            unit_m2: area(prototype.mesh(), None),
            color: None,
        };
        let of_kind = |(number, shape): (u32, &LeafShape)| {
            let first = self.shapes.iter().position(|other| other.kind == shape.kind).unwrap_or_default();
            let kind = self.kinds.get(usize::from(shape.kind)).or(self.kinds.last());
            MeasuredShape {
                class: kind.map_or(OrganClass::Leaf, |kind| kind.class),
                kind: kind.map_or("leaf", |kind| &kind.name),
                variant: number - first as u32,
                unit_m2: area(&shape.mesh, kind.and_then(|kind| kind.mask.as_deref()))
                    / f64::from(shape.faces),
                color: Some(shape.color),
            }
        };
        let shapes = PROTOTYPES.iter().map(plain).chain((1..).zip(&*self.shapes).map(of_kind));
        MeasuredOrgans { dressed: self, shapes: shapes.collect() }
    }
}

/// [`DressedOrgans`] whose shapes are measured.
#[derive(Debug)]
pub struct MeasuredOrgans<'a> {
    dressed: &'a DressedOrgans,
    /// By index of [`super::PlacedOrgans::prototypes`].
    shapes: Vec<MeasuredShape<'a>>,
}

/// What is the same for all organs of a shape.
#[derive(Debug)]
struct MeasuredShape<'a> {
    class: OrganClass,
    kind: &'a str,
    variant: u32,
    /// Of one that is a metre long.
    unit_m2: f64,
    /// `None`: the turtle's colour.
    color: Option<[u8; 3]>,
}

impl MeasuredOrgans<'_> {
    /// Calls back with the organs of a range, in their order.
    pub fn each(&self, range: Range<usize>, mut with: impl FnMut(usize, &DressedOrgan<'_>)) {
        let DressedOrgans { organs, colors, .. } = self.dressed;
        let Organs { polygons, placed, .. } = &**organs;
        let (mut shaper, mut mesh) = (Shaper::default(), Mesh::default());
        let outline =
            MeasuredShape { class: OrganClass::Leaf, kind: "polygon", variant: 0, unit_m2: 0.0, color: None };
        for organ in range {
            let hanging = organs.growth(organ);
            let (shape, placement, area_m2) = if let Some(i) = organ.checked_sub(polygons.ends.len()) {
                let prototype = usize::from(placed.prototypes[i]);
                // A shape that is not given is drawn as one of the table.
                let shape = self.shapes.get(prototype).unwrap_or(&self.shapes[prototype % PROTOTYPES.len()]);
                let size_m = f64::from(placed.sizes_m[i]);
                (shape, Placement::of_placed(placed, i), shape.unit_m2 * size_m * size_m)
            } else {
                mesh.positions.clear();
                mesh.normals.clear();
                mesh.uvs.clear();
                mesh.triangles.clear();
                shaper.add(organs, organ, &mut mesh);
                let foot = organs.corners_of(organ).first().copied().unwrap_or_default();
                let placement = Placement::new(foot, polygons.headings[organ], polygons.ups[organ], 1.0);
                (&outline, placement, area(&mesh, None))
            };
            let turtle = || colors.get(self.dressed.color_slot(hanging.color)).copied().unwrap_or_default();
            let MeasuredShape { class, kind, variant, color, .. } = *shape;
            let color = color.unwrap_or_else(turtle);
            let (node, birth) = (hanging.node, hanging.birth);
            with(organ, &DressedOrgan { class, kind, variant, node, placement, area_m2, birth, color });
        }
    }
}

/// One side of all triangles, as far as a picture leaves them opaque, square units.
pub(super) fn area(mesh: &Mesh, mask: Option<&Picture>) -> f64 {
    let of = |(triangle, share): (&[u32; 3], f64)| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a).length() / 2.0 * share
    };
    mesh.triangles.iter().zip(opaque_shares(mesh, mask)).map(of).sum()
}
