//! The same layers in binary (`.usdc`).

use std::io;

use linden_pipeline::Monitor;
use linden_pipeline::stage::{Stage, Surroundings};

use super::layer::Layer;
use super::payload::{self, Split};
use super::{
    COLLISION, MOST, OPTIONS, ages, bones, estimate, flavored, levels_by, mesh, nanite, plant, write_beside,
    write_layer,
};
use crate::options::Options;
use crate::usdc::Names;
use crate::writing::distinct::MeshPart;
use crate::writing::lightmap::LIGHTMAP_UV;
use crate::{Bundle, Encoding, ExportError, Exporter, Format, Gatherer, Holds, Readable, Traces, UsdForm};

/// OpenUSD in binary.
pub(crate) struct Usdc;

static FORMAT: Format = Format {
    id: "usdc",
    name: "OpenUSD (binary)",
    extensions: &["usdc"],
    media_type: "model/vnd.usdc",
    self_contained: false,
    help: "what usda holds in a quarter of its bytes, which programs map into memory; pictures lie beside it",
    options: &OPTIONS,
    holds: Holds::SCENE,
    levels_by: Some(levels_by),
    encoding: |_| Encoding::Binary,
    estimate: Some(estimate::binary_bytes),
};

impl Exporter for Usdc {
    fn format(&self) -> &'static Format {
        &FORMAT
    }

    fn gatherer(&self) -> Option<Gatherer> {
        Some(|ages, bundle, monitor| ages.write_usd(UsdForm::Binary, bundle, monitor))
    }

    fn recipe(&self, file: &mut dyn Readable) -> io::Result<Option<String>> {
        Ok(Names::read(file)?.and_then(|names| names.recipe()))
    }

    fn traces(&self, file: &mut dyn Readable) -> io::Result<Traces> {
        Ok(Names::read(file)?.map_or_else(|| Traces::none(&FORMAT), |names| traces(&FORMAT, &names)))
    }

    fn write(
        &self,
        stage: &Stage<'_>,
        options: &Options,
        bundle: &mut Bundle,
        monitor: &dyn Monitor,
    ) -> Result<(), ExportError> {
        write_beside(&FORMAT, stage, options, bundle, monitor, |writing, bundle| {
            let split = Split::of(writing, "_payload.usdc", options, bundle);
            let bytes = match &split {
                Some(split) => Layer::binary(monitor, |layer| split.write_interface(layer, writing))?,
                None => Layer::binary(monitor, |layer| write_layer(layer, writing))?,
            };
            if let Some(split) = split {
                let bytes = Layer::binary(monitor, |layer| Split::write_payload(layer, writing))?;
                let length = Some(bytes.len() as u64);
                bundle.write_side(&split.suffix, length, monitor, |out| out.write(&bytes))?;
            }
            bundle.write_main(Some(bytes.len() as u64), monitor, |out| out.write(&bytes))
        })
    }
}

/// What the names in a layer show of how it was written.
pub(super) fn traces(format: &'static Format, names: &Names) -> Traces {
    if let Some(told) = names.strings().find(|text| text.starts_with(payload::TOLD_BEGINNING)) {
        return payload::traces(format, told);
    }
    let camera = names.has("Camera");
    let told = names.strings().find_map(|text| Surroundings::parse(text).ok());
    let setting = camera.then(|| told.unwrap_or_default());
    let traces = Traces::none(format)
        .with_switch("pictures", names.has("UsdUVTexture"))
        .with_switch("skeleton", names.has("BasisCurves"))
        .with_switch("proxy", names.has(plant::PROXY_PRIM))
        .with_switch(LIGHTMAP_UV.knob.name, names.has(mesh::LIGHTMAP));
    let traces = flavored(traces, format, names.has(plant::LABELS));
    let is_told = |(shapes, most): &(&str, &str)| {
        let mut options = Options::new(format);
        options.set(COLLISION.knob.name, shapes).and_then(|()| options.set(MOST.knob.name, most)).is_ok()
    };
    let told = names.strings().filter_map(|text| text.split_once(' ')).find(is_told);
    let traces = match told.filter(|_| names.has("PhysicsCollisionAPI")) {
        Some((shapes, most)) => traces.with(COLLISION.knob.name, shapes).with(MOST.knob.name, most),
        None => traces,
    };
    // Without leaves it does not show.
    let is_translucent = names.has("ND_standard_surface_surfaceshader");
    let traces = traces.with_shown("materialx", is_translucent);
    // What covers the ground is instanced whatever the options.
    let has_instances = names.has("PointInstancer");
    let traces = if has_instances && names.has_beginning("Ground_") {
        traces.with_either("instances")
    } else {
        traces.with_switch("instances", has_instances)
    };
    let mesh_types = ["staticMesh", "skeletalMesh"];
    let is_nanite = names.has(nanite::MESH_TYPE);
    let traces = nanite::traced(traces, mesh_types.into_iter().find(|name| is_nanite && names.has(name)));
    // A mesh may have an attribute that is called so.
    let is_of_ages = names.has(ages::SET) && !names.has("Mesh");
    Traces { setting, seasons: names.has("season") || is_of_ages, ..traces }
}

/// What a mesh takes in a crate file, rather more than less: vectors as they are, texture coordinates each once, indices
/// hardly compressed.
pub(super) fn mesh_bytes(piece: &MeshPart<'_>) -> u64 {
    let mesh = &piece.mesh;
    let (vertices, triangles) = (mesh.positions.len() as u64, mesh.triangles.len() as u64);
    let moved = piece.wind.map_or(0, |wind| {
        if wind.bones.is_some() {
            return 8 * bones::influences(&wind.bindings) as u64 * vertices;
        }
        let offsets = wind.targets.iter().map(|target| target.offsets.len() as u64).sum::<u64>();
        2 * 21 * vertices + 17 * offsets
    });
    let second = piece.lightmap.as_ref().map_or(0, |set| 8 * set.len() as u64 + 12 * triangles);
    4096 + 33 * vertices + 26 * triangles + moved + second
}

/// What a node of the skeleton takes.
pub(super) const BYTES_PER_NODE: u64 = 32;
/// What a copy's place takes.
pub(super) const PLACEMENT_BYTES: u64 = 40;
