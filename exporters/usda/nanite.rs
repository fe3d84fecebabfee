//! Unreal's Nanite assemblies (5.7 and newer): a base mesh and foliage as parts in many places, which become one asset.
//!
//! ```text
//! /oak                         Xform, group, NaniteAssemblyRootAPI: which mesh, and its skeleton
//!     /Geometry                SkelRoot, component: the wood with the joints of wind=bones
//!     /leaves_instances        PointInstancer, NaniteAssemblySkelBindingAPI: the joints of each place
//!         /Prototypes/oak_leaf Xform: a SkelRoot of one joint
//!     /Materials
//! oak_wind.json                groups of joints, for the plug-in Dynamic Wind: see [`wind`](super::nanite_wind)
//! ```
//!
//! That is `skeletal`. Of `static` the wood is a part too, in one place; there are no joints and no wind, and prototypes are
//! an Xform with a mesh.
//!
//! Names, types and places of the schemas are as they stand in the schema that Epic's plug-in USD Core brings, quoted in the
//! notes of `XRFutureForests/growpy` (GitHub, `docs`), and in the contract of `VitalyVishnev/SpeedAssembly`
//! (`docs/ue_import_contract.md`, `docs/tutorial-reference-contract.md`), whose files were imported into 5.7; the latter
//! follows the example of Epic's tutorial *Nanite Assemblies in USD*. From it: metres with Y up, which the importer turns and
//! scales; the root a `group`; instancers right below it; parts of a skeletal assembly as skeletal meshes of one joint, which
//! Epic's `UNaniteAssemblySkeletalMeshBuilder::AddAssemblyPart` takes alone; the wood of a static one in an instancer. Joints
//! may be named by name or by path: names are shorter. The import itself was not tried.

use glam::{Quat, Vec3};
use linden_pipeline::foliage::Placement;
use linden_pipeline::stage::{Plant, Stage};
use linden_pipeline::wind::{Binding, Bones};

use super::bones;
use super::layer::Layer;
use crate::collision::COLLISION;
use crate::options::{OptionSpec, Options};
use crate::writing::distinct::{DistinctMeshes, MeshCopies};
use crate::writing::has_bones;
use crate::{Bundle, ExportError, Traces};

pub(super) const NANITE: OptionSpec = OptionSpec::choice(
    "nanite",
    &["none", "static", "skeletal"],
    "for Unreal 5.7 and newer: a Nanite assembly of wood and leaves; a skeletal one has the joints of wind=bones, and wind in STEM_wind.json",
);

/// How the line begins that says which assembly it is.
pub(super) const TRACE: &str = "uniform token unreal:naniteAssembly:meshType = ";
/// The attribute.
pub(super) const MESH_TYPE: &str = "unreal:naniteAssembly:meshType";
const BIND_JOINTS: &str = "primvars:unreal:naniteAssembly:bindJoints";
const BIND_WEIGHTS: &str = "primvars:unreal:naniteAssembly:bindJointWeights";

/// Which assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nanite {
    Static,
    Skeletal,
}

impl Nanite {
    /// What the schema calls its mesh, and what the option calls it.
    const ALL: [(Self, &'static str, &'static str); 2] =
        [(Self::Static, "staticMesh", "static"), (Self::Skeletal, "skeletalMesh", "skeletal")];

    /// What is asked for, whether it can be written or not.
    pub fn asked(options: &Options) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|(.., word)| options.is_word(NANITE.knob.name, word))
            .map(|(nanite, ..)| nanite)
    }

    /// The word of the option that a file was written with whose mesh is called `mesh_type`.
    pub fn word_of(mesh_type: &str) -> Option<&'static str> {
        Self::ALL.into_iter().find(|(_, name, _)| *name == mesh_type).map(|(.., word)| word)
    }

    /// What the schema calls its mesh.
    pub fn mesh_type(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// Which assembly is written of a stage, and what of the stage; what is left out is noted.
    pub fn fit<'a>(stage: Stage<'a>, options: &Options, bundle: &mut Bundle) -> (Option<Self>, Stage<'a>) {
        let Some(mut nanite) = Self::asked(options) else { return (None, stage) };
        if !stage.is_single() || stage.setting.is_some() {
            bundle.note(
                "nanite is left out: an assembly is one plant without a scene; export each plant alone",
            );
            return (None, stage);
        }
        if nanite == Self::Skeletal && !has_bones(&stage) {
            bundle.note(
                "nanite=skeletal: there are no joints, and it is written as nanite=static; add --wind=bones",
            );
            nanite = Self::Static;
        }
        let mut fitted = stage;
        if fitted.levels() > 1 {
            bundle.note("nanite: the finest level alone is in it, of which Nanite makes the others");
            fitted = fitted.at_level(0);
        }
        if fitted.seasons() > 1 {
            bundle.note("nanite: the first season alone is in it; export each season as an asset of its own");
            fitted = fitted.in_season(0);
        }
        let moves = fitted
            .plants
            .iter()
            .flat_map(Plant::scenes)
            .flat_map(|scene| &scene.parts)
            .any(|part| part.wind.is_some());
        if nanite == Self::Static && moves {
            bundle.note("nanite=static: wind is left out; nanite=skeletal with --wind=bones has it");
        }
        for (name, why) in [
            ("skeleton", "guide curves"),
            (COLLISION.knob.name, "shapes for physics"),
            ("payload", "a payload"),
        ] {
            if options.is_asked(name)
                && !(options.is_word(name, "none") || options.value(name).is_some_and(is_off))
            {
                bundle.note(format!("{name} is left out: a Nanite assembly has no {why}"));
            }
        }
        if options.is_asked("instances") && !options.is_on("instances") {
            bundle.note("instances=false changes nothing: the parts of a Nanite assembly are instances");
        }
        (Some(nanite), fitted)
    }

    /// Leaves the wind out of a static assembly and lets its wood be a part in one place.
    pub fn lay_out(self, distinct: &mut DistinctMeshes<'_>, bundle: &mut Bundle) {
        let parts = || distinct.models.iter().flat_map(|model| &model.parts);
        if self == Self::Skeletal {
            if parts().all(|part| part.copies.is_some()) {
                bundle.note(
                    "nanite=skeletal: there is no wood, and Unreal makes no assembly without a base mesh",
                );
            }
            return;
        }
        for model in &mut distinct.models {
            let scene = model.scene;
            for piece in &mut model.parts {
                piece.wind = None;
                let part = scene.parts.iter().find(|part| part.name == *piece.name);
                let Some(part) = part.filter(|_| piece.copies.is_none()) else { continue };
                let at = Placement { position: Vec3::ZERO, rotation: Quat::IDENTITY, scale: 1.0 };
                piece.copies = Some(MeshCopies {
                    part: &part.name,
                    placements: vec![at],
                    seen: piece.bounds,
                    bindings: Vec::new(),
                });
            }
        }
    }

    /// What the root says.
    pub fn of_root(self, root: &str) -> String {
        let skeleton = match self {
            Self::Static => String::new(),
            Self::Skeletal => format!("rel unreal:naniteAssembly:skeleton = <{root}/Geometry/WindRig>\n"),
        };
        format!("{TRACE}\"{}\"\n{skeleton}", self.mesh_type())
    }
}

fn is_off(value: &linden_pipeline::knob::Value) -> bool {
    *value == linden_pipeline::knob::Value::Switch(false)
}

/// What joints the copies of an instancer go with: as many for each.
pub(super) fn write_bindings(
    layer: &mut Layer<'_, '_>,
    bindings: &[Binding],
    bones: &Bones,
) -> Result<(), ExportError> {
    /// What stands in a line of text.
    const PER_LINE: usize = 32;
    let each = bones::influences(bindings);
    let mut joints = format!("uniform token[] {BIND_JOINTS} = [");
    let mut weights = format!("uniform float[] {BIND_WEIGHTS} = [");
    for (i, binding) in bindings.iter().enumerate() {
        for slot in 0..each {
            let between = match i * each + slot {
                0 => "",
                place if place % PER_LINE == 0 => ",\n",
                _ => ", ",
            };
            let weight = binding.weights[slot];
            // Where there are fewer, the first again with no weight.
            let joint = binding.joints[if weight > 0 { slot } else { 0 }];
            joints += &format!("{between}\"{}\"", bones.joints[usize::from(joint)].name);
            weights += &format!("{between}{}", f32::from(weight) / 255.0);
        }
    }
    let metadata = format!("] (\n    elementSize = {each}\n    interpolation = \"vertex\"\n)\n");
    layer.lines(&(joints + &metadata))?;
    layer.lines(&(weights + &metadata))
}

/// Bytes of the joints of all copies as text, rather more than less.
pub(super) fn bytes(distinct: &DistinctMeshes<'_>) -> u64 {
    /// Of one: four names with numbers of five digits, and four weights.
    const OF_COPY: u64 = 4 * (20 + 14);
    let copies = distinct.parts().filter_map(|part| part.copies.as_ref());
    OF_COPY * copies.map(|copies| copies.bindings.len() as u64).sum::<u64>()
}

/// What the name of its mesh shows of how a file was written.
pub(super) fn traced(traces: Traces, mesh_type: Option<&str>) -> Traces {
    match mesh_type.and_then(Nanite::word_of) {
        // Whatever these were set to.
        Some(word) => traces.with(NANITE.knob.name, word).with_either("instances").with_either("skeleton"),
        None => traces,
    }
}

/// The rig of a part: one joint at its foot, and an animation in which it rests.
pub(super) fn write_part_rig(layer: &mut Layer<'_, '_>, path: &str) -> Result<(), ExportError> {
    layer.open("def Skeleton \"Rig\" (\n    prepend apiSchemas = [\"SkelBindingAPI\"]\n)")?;
    let matrix = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))";
    layer.lines(&format!(
        "uniform matrix4d[] bindTransforms = [{matrix}]
uniform token[] jointNames = [\"part\"]
uniform token[] joints = [\"part\"]
uniform token purpose = \"guide\"
uniform matrix4d[] restTransforms = [{matrix}]
rel skel:animationSource = <{path}/Rest>"
    ))?;
    layer.close()?;
    layer.open("def SkelAnimation \"Rest\"")?;
    layer.lines(
        "uniform token[] joints = [\"part\"]\nquatf[] rotations = [(1, 0, 0, 0)]\nhalf3[] scales = [(1, 1, 1)]\nfloat3[] translations = [(0, 0, 0)]",
    )?;
    layer.close()
}

/// What binds a mesh of a part to its joint.
pub(super) fn write_part_binding(
    layer: &mut Layer<'_, '_>,
    vertices: usize,
    path: &str,
) -> Result<(), ExportError> {
    layer.elements("int[] primvars:skel:jointIndices", vertices, 1, |_| 0_u32)?;
    layer.elements("float[] primvars:skel:jointWeights", vertices, 1, |_| 1.0_f32)?;
    layer.lines(&format!(
        "matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
rel skel:skeleton = <{path}/Rig>"
    ))
}
