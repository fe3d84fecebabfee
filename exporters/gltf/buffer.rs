//! The binary buffer: where each array lies, and writing it without holding it.

use linden_pipeline::scene::{Bounds, Mesh};
use linden_pipeline::stage::Stage;
use linden_pipeline::wind::{Motion, PartWind};
use linden_pipeline::{Monitor, Vec2};

use super::byte_sink::ByteSink;
use super::document::{Accessor, Attributes, BufferView, ComponentType, Mode};
use super::meshopt::{Items, Packed, Packer};
use super::quantize::{self, Cube, Quanta, Range};
use super::tangents::tangents;
use super::wind::{self, WindArrays, WindAs};
use crate::ExportError;
use crate::collision::Solid;
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::pictures::{self, NamedPicture};

const ARRAY_BUFFER: u16 = 34962;
const ELEMENT_ARRAY_BUFFER: u16 = 34963;

/// Where everything lies: the meshes' arrays in order, then the pictures. Every view starts at a
/// multiple of four, which suits every component type used, and zeros fill the gaps.
pub(super) struct Layout {
    pub views: Vec<BufferView>,
    pub accessors: Vec<Accessor>,
    /// As many as [`DistinctMeshes::parts`].
    pub primitives: Vec<PrimitiveArrays>,
    /// By primitive: the one whose arrays it has, itself or an earlier one.
    arrays_of: Vec<usize>,
    /// Where vertices are in fewer bits.
    pub quanta: Option<Quanta>,
    /// By view: what it consists of.
    items: Vec<Option<Items>>,
    blobs: Vec<Vec<u8>>,
    /// All bytes, where they are compressed.
    packed: Option<Packed>,
    bytes: u64,
    /// How vertices are told the wind.
    pub wind_as: WindAs,
}

/// Accessors of a mesh.
#[derive(Clone)]
pub(super) struct PrimitiveArrays {
    first: usize,
    with_tangents: bool,
    /// The second set of texture coordinates.
    lightmap: Option<usize>,
    /// What its vertices are told in, where they are in fewer bits.
    packing: Option<Packing>,
    pub indices: usize,
    pub wind: WindArrays,
    /// The cube of packed pivots, where there are some.
    wind_cube: Option<Cube>,
    /// The plant that it is part of.
    plant: Option<usize>,
}

/// The cube of positions, the range of texture coordinates.
type Packing = (Cube, Option<Range>);

impl PrimitiveArrays {
    /// The cube that positions are told in.
    pub fn cube(&self) -> Option<Cube> {
        self.packing.map(|(cube, _)| cube)
    }

    /// What packed pivots mean, in the units of the stored positions.
    pub fn wind_cube(&self) -> Option<[f32; 4]> {
        let Cube { corner, side } = self.wind_cube.filter(|_| self.wind.packed.is_some())?;
        // Positions are in the same cube.
        if self.packing.is_some() {
            Some([0.0, 0.0, 0.0, 1.0])
        } else {
            Some([corner.x, corner.y, corner.z, side])
        }
    }

    pub fn attributes(&self) -> Attributes {
        Attributes {
            position: self.first,
            normal: Some(self.first + 1),
            texcoord_0: Some(self.first + 2),
            tangent: self.with_tangents.then_some(self.first + 3),
            color_0: self.wind.packed.map(|[motions, ..]| motions),
            texcoord_1: self.lightmap.or(self.wind.texels).or(self.wind.packed.map(|[_, flat, _]| flat)),
            texcoord_2: self.wind.packed.map(|[.., high]| high),
            joints_0: self.wind.bindings.map(|[joints, _]| joints),
            weights_0: self.wind.bindings.map(|[_, weights]| weights),
            wind: self.wind.attributes.map(|[wind, _]| wind),
            wind_pivot: self.wind.attributes.map(|[_, pivot]| pivot),
        }
    }
}

impl Layout {
    /// Lays out the meshes' arrays; `pictures` are those that will be written. With `quantize` the plants'
    /// vertices are in fewer bits; `wind_as` is what tells how they swing.
    pub fn of_meshes(
        stage: &Stage<'_>,
        distinct: &DistinctMeshes<'_>,
        pictures: &[NamedPicture<'_>],
        quantize: bool,
        wind_as: WindAs,
    ) -> Self {
        let wind_quanta = matches!(wind_as, WindAs::Packed).then(|| Quanta::new(distinct, &[]));
        let mut layout = Self {
            views: Vec::new(),
            accessors: Vec::new(),
            primitives: Vec::new(),
            arrays_of: distinct.first_alike(),
            quanta: quantize.then(|| Quanta::new(distinct, pictures)),
            items: Vec::new(),
            blobs: Vec::new(),
            packed: None,
            bytes: 0,
            wind_as,
        };
        let of_plants = (0..distinct.plants()).flat_map(|plant| {
            distinct.models_of(plant).iter().flat_map(|model| &model.parts).map(move |_| plant)
        });
        // What stands around belongs to none.
        let plants: Vec<Option<usize>> = of_plants.map(Some).collect();
        let plants = plants.into_iter().chain(std::iter::repeat(None));
        for ((piece, plant), motions) in distinct.parts().zip(plants).zip(wind::motions(stage, distinct)) {
            let earlier = layout.arrays_of[layout.primitives.len()];
            if let Some(same) = layout.primitives.get(earlier) {
                layout.primitives.push(same.clone());
                continue;
            }
            let MeshPart { mesh, bounds, material, wind, lightmap, .. } = piece;
            let first = layout.accessors.len();
            let count = mesh.positions.len();
            let quanta = layout.quanta.as_ref();
            let packing = plant.and_then(|plant| {
                quanta.map(|quanta| (quanta.cube_of(plant, piece), quanta.range(*material)))
            });
            let normal_picture = distinct.materials[*material].material.normal_picture.as_ref();
            let with_tangents = pictures::index_of(pictures, normal_picture).is_some();
            layout.push_geometry(count, *bounds, packing, with_tangents);
            let lightmap = lightmap.as_ref().map(|_| {
                if packing.is_some() {
                    layout.push_packed(count, "VEC2", ComponentType::U16, 4);
                } else {
                    layout.push_vertices(count, "VEC2", 8);
                }
                layout.accessors.len() - 1
            });
            let kind = index_type(mesh);
            let bytes = if kind == ComponentType::U16 { 2 } else { 4 };
            layout.push(mesh.triangles.len() * 3, "SCALAR", kind, bytes, ELEMENT_ARRAY_BUFFER);
            let indices = layout.accessors.len() - 1;
            let quanta = wind_quanta.as_ref();
            let wind_cube = plant.and_then(|plant| quanta.map(|quanta| quanta.cube_of(plant, piece)));
            let wind = wind.map(|wind| layout.push_wind(mesh, wind, motions, plant));
            let wind = wind.unwrap_or_default();
            layout.primitives.push(PrimitiveArrays {
                first,
                with_tangents,
                lightmap,
                packing,
                indices,
                wind,
                wind_cube,
                plant,
            });
        }
        layout
    }

    /// Lays out positions, normals, texture coordinates and tangents, in fewer bits where they are packed.
    fn push_geometry(&mut self, count: usize, bounds: Bounds, packing: Option<Packing>, with_tangents: bool) {
        let first = self.accessors.len();
        let extent = if let Some((cube, range)) = packing {
            self.push_packed(count, "VEC3", ComponentType::U16, 8);
            self.push_packed(count, "VEC3", ComponentType::I8, 4);
            if range.is_some() {
                self.push_packed(count, "VEC2", ComponentType::U16, 4);
            } else {
                self.push_vertices(count, "VEC2", 8);
            }
            if with_tangents {
                self.push_packed(count, "VEC4", ComponentType::I8, 4);
            }
            [bounds.min, bounds.max].map(|point| cube.steps(point).map(f32::from).to_vec())
        } else {
            self.push_vertices(count, "VEC3", 12);
            self.push_vertices(count, "VEC3", 12);
            self.push_vertices(count, "VEC2", 8);
            if with_tangents {
                self.push_vertices(count, "VEC4", 16);
            }
            [bounds.min, bounds.max].map(|point| point.to_array().to_vec())
        };
        let [min, max] = extent.map(Some);
        let positions = &mut self.accessors[first];
        (positions.min, positions.max) = (min, max);
    }

    /// Lays out a mesh's wind behind its other arrays, with targets for some motions: one that this part
    /// lacks is an accessor without a buffer, which is all zero.
    fn push_wind(
        &mut self,
        mesh: &Mesh,
        wind: &PartWind,
        motions: Vec<Motion>,
        plant: Option<usize>,
    ) -> WindArrays {
        let count = mesh.positions.len();
        let mut arrays = WindArrays::default();
        if let Some(bones) = &wind.bones {
            let (kind, stride) = wind::joint_type(bones);
            self.push(count, "VEC4", kind, stride, ARRAY_BUFFER);
            self.push_packed(count, "VEC4", ComponentType::U8, 4);
            arrays.bindings = Some([self.accessors.len() - 2, self.accessors.len() - 1]);
            return arrays;
        }
        if self.wind_as.pivots(plant, wind).is_some() {
            // Some readers take 16 bits for floats; who asks for fewer bits has readers that do not.
            if self.quanta.is_some() {
                self.push_packed(count, "VEC2", ComponentType::U16, 4);
            } else {
                self.push_vertices(count, "VEC2", 8);
            }
            arrays.texels = Some(self.accessors.len() - 1);
        } else if plant.is_some() && matches!(self.wind_as, WindAs::Packed) {
            let first = self.accessors.len();
            self.push_packed(count, "VEC4", ComponentType::U8, 4);
            self.push_packed(count, "VEC2", ComponentType::U16, 4);
            self.push_packed(count, "VEC2", ComponentType::U16, 4);
            arrays.packed = Some([first, first + 1, first + 2]);
        } else {
            let vectors = [self.push_vertices(count, "VEC4", 16), self.push_vertices(count, "VEC4", 16)];
            arrays.attributes = Some(vectors);
        }
        for &motion in &motions {
            let target = wind.targets.iter().find(|target| target.motion == motion);
            let accessor = match target {
                Some(target) => {
                    let bounds = Bounds::of(target.offsets.iter().copied());
                    let accessor = self.push_vertices(count, "VEC3", 12);
                    self.accessors[accessor].min = bounds.map(|bounds| bounds.min.to_array().to_vec());
                    self.accessors[accessor].max = bounds.map(|bounds| bounds.max.to_array().to_vec());
                    accessor
                }
                None => self.push_zeros(count),
            };
            arrays.targets.push(accessor);
        }
        WindArrays { motions, ..arrays }
    }

    fn push(&mut self, count: usize, shape: &'static str, kind: ComponentType, bytes: u64, target: u16) {
        let buffer_view = self.push_view(count as u64 * bytes, Some(target));
        let mode = if target == ELEMENT_ARRAY_BUFFER { Mode::Triangles } else { Mode::Attributes };
        self.items[buffer_view] = Some(Items { mode, stride: bytes, count });
        self.accessors.push(Accessor {
            buffer_view: Some(buffer_view),
            byte_offset: 0,
            component_type: kind,
            normalized: false,
            count,
            shape,
            min: None,
            max: None,
        });
    }

    /// Vertices of so many bytes each, padding included, whose integers mean 0 to 1 or -1 to 1.
    fn push_packed(&mut self, count: usize, shape: &'static str, kind: ComponentType, stride: u64) {
        self.push(count, shape, kind, stride, ARRAY_BUFFER);
        if let (Some(accessor), Some(view)) = (self.accessors.last_mut(), self.views.last_mut()) {
            accessor.normalized = true;
            view.byte_stride = Some(stride);
        }
    }

    fn push_view(&mut self, byte_length: u64, target: Option<u16>) -> usize {
        let byte_offset = self.bytes;
        self.bytes = (byte_offset + byte_length).next_multiple_of(4);
        self.views.push(BufferView {
            buffer: 0,
            byte_offset,
            byte_length,
            byte_stride: None,
            target,
            extensions: None,
        });
        self.items.push(None);
        self.views.len() - 1
    }

    /// A further array with an item per vertex; gives its accessor.
    fn push_vertices(&mut self, count: usize, shape: &'static str, bytes: u64) -> usize {
        self.push(count, shape, ComponentType::F32, bytes, ARRAY_BUFFER);
        self.accessors.len() - 1
    }

    /// Vectors that are all zero and take no place.
    fn push_zeros(&mut self, count: usize) -> usize {
        let zero = Some(vec![0.0; 3]);
        self.accessors.push(Accessor {
            buffer_view: None,
            byte_offset: 0,
            component_type: ComponentType::F32,
            normalized: false,
            count,
            shape: "VEC3",
            min: zero.clone(),
            max: zero,
        });
        self.accessors.len() - 1
    }

    /// Vectors behind everything else; gives their accessor.
    pub fn push_vectors<const N: usize>(&mut self, vectors: &[[f32; N]], shape: &'static str) -> usize {
        let view = self.push_blob(vectors.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect());
        let stride = size_of::<[f32; N]>() as u64;
        self.items[view] = Some(Items { mode: Mode::Attributes, stride, count: vectors.len() });
        self.accessors.push(Accessor {
            buffer_view: Some(view),
            byte_offset: 0,
            component_type: ComponentType::F32,
            normalized: false,
            count: vectors.len(),
            shape,
            min: None,
            max: None,
        });
        self.accessors.len() - 1
    }

    /// Turns of joints behind everything else, `count` of each; gives their accessors. In fewer bits where vertices are.
    pub fn push_turns(
        &mut self,
        joints: impl Iterator<Item = impl Iterator<Item = [f32; 4]>>,
        count: usize,
    ) -> std::ops::Range<usize> {
        let is_short = self.quanta.is_some();
        let short = |x: f32| (libm::roundf(x.clamp(-1.0, 1.0) * f32::from(i16::MAX)) as i16).to_le_bytes();
        let mut bytes = Vec::new();
        for number in joints.flatten().flatten() {
            if is_short {
                bytes.extend(short(number));
            } else {
                bytes.extend(number.to_le_bytes());
            }
        }
        let (component_type, stride) =
            if is_short { (ComponentType::I16, 8) } else { (ComponentType::F32, 16) };
        let turns = bytes.len() / stride;
        let view = self.push_blob(bytes);
        let items = Items { mode: Mode::Attributes, stride: stride as u64, count: turns };
        self.items[view] = Some(items);
        let first = self.accessors.len();
        self.accessors.extend((0..turns / count.max(1)).map(|joint| Accessor {
            buffer_view: Some(view),
            byte_offset: (joint * count * stride) as u64,
            component_type,
            normalized: is_short,
            count,
            shape: "VEC4",
            min: None,
            max: None,
        }));
        first..self.accessors.len()
    }

    /// Numbers behind everything else; gives their accessor.
    pub fn push_numbers(&mut self, numbers: &[f32], with_bounds: bool) -> usize {
        let view = self.push_blob(bytemuck::cast_slice(numbers).to_vec());
        let bound = |of: fn(f32, f32) -> f32| {
            with_bounds.then(|| numbers.iter().copied().reduce(of).into_iter().collect::<Vec<f32>>())
        };
        self.accessors.push(Accessor {
            buffer_view: Some(view),
            byte_offset: 0,
            component_type: ComponentType::F32,
            normalized: false,
            count: numbers.len(),
            shape: "SCALAR",
            min: bound(f32::min),
            max: bound(f32::max),
        });
        self.accessors.len() - 1
    }

    /// A shape behind everything else; gives the accessors of its points and its indices.
    pub fn push_solid(&mut self, solid: &Solid) -> (usize, usize) {
        let points: Vec<[f32; 3]> = solid.points.iter().map(glam::Vec3::to_array).collect();
        let position = self.push_vectors(&points, "VEC3");
        if let Some(Bounds { min, max }) = solid.bounds() {
            self.accessors[position].min = Some(min.to_array().to_vec());
            self.accessors[position].max = Some(max.to_array().to_vec());
        }
        // Few corners: two bytes hold them.
        let short = solid.triangles.iter().flatten().flat_map(|&corner| (corner as u16).to_le_bytes());
        let view = self.push_blob(short.collect());
        self.accessors.push(Accessor {
            buffer_view: Some(view),
            byte_offset: 0,
            component_type: ComponentType::U16,
            normalized: false,
            count: 3 * solid.triangles.len(),
            shape: "SCALAR",
            min: None,
            max: None,
        });
        (position, self.accessors.len() - 1)
    }

    /// Puts a file's bytes behind everything else; gives its view.
    pub fn push_blob(&mut self, bytes: Vec<u8>) -> usize {
        let view = self.push_view(bytes.len() as u64, None);
        self.blobs.push(bytes);
        view
    }

    /// The buffer's length, a multiple of four.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Compresses everything that has been laid out; nothing may be added afterwards.
    pub fn compress(
        &mut self,
        distinct: &DistinctMeshes<'_>,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        let mut packer = Packer::new(&self.views, &self.items, monitor);
        self.write(distinct, &mut packer)?;
        let (views, packed) = packer.finish();
        self.views = views;
        self.bytes = packed.bytes;
        self.packed = Some(packed);
        Ok(())
    }

    /// Bytes that compressing takes: what is compressed, and of one view after the other what goes in
    /// and comes out, four times as they are.
    pub fn compressing_bytes(&self) -> u64 {
        let largest = self.views.iter().map(|view| view.byte_length).max();
        self.bytes + 4 * largest.unwrap_or(0)
    }

    /// The length of the buffer that compressed views stand for.
    pub fn stands_for(&self) -> Option<u64> {
        self.packed.as_ref().map(|packed| packed.stands_for)
    }

    /// Writes the buffer.
    pub fn write(&self, distinct: &DistinctMeshes<'_>, out: &mut impl ByteSink) -> Result<(), ExportError> {
        if let Some(packed) = &self.packed {
            return packed.write(out);
        }
        for (index, (piece, primitive)) in distinct.parts().zip(&self.primitives).enumerate() {
            if self.arrays_of[index] != index {
                continue;
            }
            match primitive.packing {
                Some((cube, range)) => {
                    quantize::write(&piece.mesh, cube, range, primitive.with_tangents, out)?;
                }
                None => write_vertices(&piece.mesh, primitive.with_tangents, out)?,
            }
            if let Some(set) = &piece.lightmap {
                write_lightmap(set, primitive.packing.is_some(), out)?;
            }
            write_triangles(&piece.mesh, out)?;
            let cube = primitive.packing.map(|(cube, _)| cube);
            let Some(wind) = piece.wind else { continue };
            let pivots = self.wind_as.pivots(primitive.plant, wind);
            wind::write(wind, cube, primitive.wind_cube, pivots, out)?;
        }
        for blob in &self.blobs {
            out.put(blob)?;
            out.put(&[0; 3][..blob.len().next_multiple_of(4) - blob.len()])?;
        }
        Ok(())
    }
}

/// 16 bits where they reach; 65535 itself means "restart" to some hardware and is not allowed.
fn index_type(mesh: &Mesh) -> ComponentType {
    if u16::try_from(mesh.positions.len()).is_ok() { ComponentType::U16 } else { ComponentType::U32 }
}

fn write_vertices(mesh: &Mesh, with_tangents: bool, out: &mut impl ByteSink) -> Result<(), ExportError> {
    out.put(bytemuck::cast_slice(&mesh.positions))?;
    out.put(bytemuck::cast_slice(&mesh.normals))?;
    // V runs down in glTF: the origin is the upper left corner of the picture.
    let mut down = Vec::with_capacity(PIECE);
    for uvs in mesh.uvs.chunks(PIECE) {
        down.clear();
        down.extend(uvs.iter().map(|uv| [uv.x, 1.0 - uv.y]));
        out.put(bytemuck::cast_slice(&down))?;
    }
    if with_tangents {
        out.put(bytemuck::cast_slice(&tangents(mesh)))?;
    }
    Ok(())
}

/// V runs down, as in the first set.
fn write_lightmap(set: &[Vec2], is_short: bool, out: &mut impl ByteSink) -> Result<(), ExportError> {
    for piece in set.chunks(PIECE) {
        let down = piece.iter().map(|at| [at.x, 1.0 - at.y]);
        if is_short {
            let steps: Vec<[u16; 2]> = down.map(|at| at.map(quantize::step)).collect();
            out.put(bytemuck::cast_slice(&steps))?;
        } else {
            let plain: Vec<[f32; 2]> = down.collect();
            out.put(bytemuck::cast_slice(&plain))?;
        }
    }
    Ok(())
}

fn write_triangles(mesh: &Mesh, out: &mut impl ByteSink) -> Result<(), ExportError> {
    if index_type(mesh) == ComponentType::U32 {
        return out.put(bytemuck::cast_slice(&mesh.triangles));
    }
    let mut short: Vec<[u16; 3]> = Vec::with_capacity(PIECE.min(mesh.triangles.len()));
    for triangles in mesh.triangles.chunks(PIECE) {
        short.clear();
        short.extend(triangles.iter().map(|triangle| triangle.map(|vertex| vertex as u16)));
        out.put(bytemuck::cast_slice(&short))?;
    }
    out.put(&[0; 2][..mesh.triangles.len() % 2 * 2])
}

/// Records that are converted at a time.
const PIECE: usize = 1 << 15;
