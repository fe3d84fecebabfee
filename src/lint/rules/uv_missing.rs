//! Pictures without a place on the mesh.

use super::{Limits, Rule};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const RULE: Rule = Rule {
    id: "uv-missing",
    checks: "meshes whose material has a picture, and that have no texture coordinates, or broken ones",
    why: "the picture shows one pixel everywhere",
    mend: "unwrap the mesh",
    severity: Severity::Error,
    limits: &[],
    needs: &[Aspect::Uvs, Aspect::Materials, Aspect::Geometry],
    check,
};

fn check(asset: &Asset, _: &Limits, found: &mut Findings<'_>) {
    for (mesh, geometry) in asset.drawn() {
        let Some(material) = asset.material_of(mesh) else { continue };
        let sets = [0, 1].map(|set| material.uses().any(|used| used.set == set));
        for (set, is_used) in sets.into_iter().enumerate() {
            match &geometry.uvs[set] {
                None if is_used => found.at(
                    &mesh.name,
                    format!(
                        "its material has a picture on set {set} of texture coordinates, which it has not"
                    ),
                ),
                Some(uvs) => {
                    let broken = uvs.iter().filter(|uv| !uv.is_finite()).count();
                    if broken > 0 {
                        found.over(
                            Some(&mesh.name),
                            format!("{broken} texture coordinates are no numbers"),
                            broken as f64,
                            0.0,
                        );
                    }
                }
                None => {}
            }
        }
    }
}
