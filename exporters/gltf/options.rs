//! The options of both kinds of files, and where they change nothing.

use linden_pipeline::stage::Stage;

use crate::options::{OptionSpec, Options};
use crate::writing::distinct::{DistinctMeshes, MeshPart};
use crate::writing::lightmap::LIGHTMAP_UV;
use crate::{Bundle, LooksIn};

pub const PICTURES: OptionSpec =
    OptionSpec::switch("pictures", true, "with bark pictures; without, one colour");

pub const INSTANCES: OptionSpec = OptionSpec::switch(
    "instances",
    false,
    "leaves (in a forest whole trees) as few meshes in many places, by EXT_mesh_gpu_instancing; fewer \
     programs read that",
);

pub const QUANTIZE: OptionSpec = OptionSpec::switch(
    "quantize",
    false,
    "vertices in fewer bits (KHR_mesh_quantization): half the size, positions to a 65535th of the height",
);

pub const COMPRESS: OptionSpec = OptionSpec::choice(
    "compress",
    &["none", "meshopt"],
    "meshopt: vertices and indices in fewer bytes, without loss (EXT_meshopt_compression); best together \
     with quantize; engines on the web read it, Blender does not",
);

pub const PICTURE_FORMAT: OptionSpec = OptionSpec::choice(
    "picture_format",
    &["png", "jpeg", "webp"],
    "jpeg: colours of bark in a fifth of the bytes, with some loss, directions of normals to a degree in two thirds; webp: those of leaves too, without loss, in \
     a tenth fewer bytes (EXT_texture_webp, which the reader must know); normals stay PNG",
);

pub const LODS: OptionSpec = OptionSpec::choice(
    "lods",
    &["msft", "siblings", "files"],
    "levels of detail: by MSFT_lod, of which many programs show the finest alone; as nodes NAME_LOD0, NAME_LOD1 side by \
     side, which Unity and Unreal group; a file each",
);

/// What becomes of levels.
pub fn levels_by(options: &Options) -> LooksIn {
    if options.is_word(LODS.knob.name, "files") { LooksIn::Files } else { LooksIn::One }
}

pub const WIND_AS: OptionSpec = OptionSpec::choice(
    "wind_as",
    &["attributes", "packed", "pivot-painter"],
    "how shaders are told the wind: _WIND and _WINDPIVOT; or packed, 12 bytes a vertex in COLOR_0, TEXCOORD_1 and \
     TEXCOORD_2, which engines import (viewers without a shader for it tint by COLOR_0); or pivot-painter, texels of two \
     pictures beside the file that TEXCOORD_1 names, for Unreal's functions of Pivot Painter 2",
);

/// Whether shaders are told the wind by packed numbers. The sway loop plays without a shader, and all that show it would tint the
/// tree by `COLOR_0`: there a profile's wish is passed over, that of a user is not.
pub fn is_wind_packed(options: &Options, sways: bool) -> bool {
    let name = WIND_AS.knob.name;
    options.is_word(name, "packed") && (options.is_asked(name) || !sways)
}

/// Whether something moves in a loop of targets.
pub fn sways(distinct: &DistinctMeshes<'_>) -> bool {
    distinct.parts().filter_map(|piece| piece.wind).any(|wind| !wind.targets.is_empty())
}

/// Says why there is no second set where one was asked for: its place is taken by wind.
pub fn with_lightmap(distinct: &DistinctMeshes<'_>, options: &Options, bundle: &mut Bundle) -> bool {
    let swings = |piece: &MeshPart<'_>| piece.wind.is_some_and(|wind| wind.bones.is_none());
    // Without files beside it there are no pictures to name texels of.
    let can_take = |word: &&str| *word != "pivot-painter" || bundle.takes_side_files();
    let taking = ["packed", "pivot-painter"].into_iter().filter(can_take);
    let is_so = |word: &&str| match *word {
        "packed" => is_wind_packed(options, sways(distinct)),
        word => options.is_word(WIND_AS.knob.name, word),
    };
    let taking = taking.into_iter().find(is_so);
    let is_taken = taking.is_some() && distinct.parts().any(swings);
    let is_asked = options.is_on(LIGHTMAP_UV.knob.name);
    if is_asked && is_taken {
        let word = taking.unwrap_or_default();
        bundle.note(format!(
            "lightmap_uv is left out: wind_as={word} has TEXCOORD_1; wind_as=attributes and wind=bones leave it free"
        ));
    }
    is_asked && !is_taken
}

pub const TRANSLUCENCY: OptionSpec = OptionSpec::switch(
    "translucency",
    false,
    "light passes through leaves (KHR_materials_diffuse_transmission, a release candidate: Babylon.js and path \
     tracers know it, others leave it out)",
);

/// Whether vertices are to be in fewer bits. Targets of the sway loop move positions by lengths, which the
/// bits of a cube cannot hold.
pub fn is_quantized(distinct: &DistinctMeshes<'_>, options: &Options, bundle: &mut Bundle) -> bool {
    let sways = sways(distinct);
    if options.is_on("quantize") && sways {
        bundle.note(
            "quantize is left out: the sway loop moves vertices by lengths that fewer bits cannot hold; \
             wind=attributes can be quantized",
        );
    }
    options.is_on("quantize") && !sways
}

/// Says where `translucency`, or the knob that is for it, changes nothing.
pub fn note_translucency(
    distinct: &DistinctMeshes<'_>,
    stage: &Stage<'_>,
    options: &Options,
    bundle: &mut Bundle,
) {
    let is_translucent = distinct.materials.iter().any(|named| named.material.translucency.is_some());
    match options.is_on("translucency") {
        true if !is_translucent => {
            bundle.note("translucency changes nothing: there are no leaves that light passes through");
        }
        false if stage.turned.iter().any(|name| name == "leaf_translucency") => {
            bundle.note(
                "leaf_translucency changes nothing in it: glTF says it with the option translucency=true",
            );
        }
        _ => {}
    }
}
