//! How fine pictures lie on meshes.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset, Geometry, Piece, TextureUse};
use crate::finding::{Findings, Severity};
use crate::mesh::twice_area;

pub(super) const RULE: Rule = Rule {
    id: "texel-density",
    checks: "texels per metre of the picture of colours, over a mesh as a whole, in the finest level",
    why: "too few are blurred beside everything else in a scene; too many are memory that nobody sees",
    mend: "another size of the picture, or let it repeat more or less often",
    severity: Severity::Info,
    limits: &[
        limit("min", 64.0, "texels/m", "fewest texels of a metre"),
        limit("max", 8192.0, "texels/m", "most texels of a metre"),
    ],
    needs: &[Aspect::Pictures, Aspect::Uvs, Aspect::Geometry, Aspect::Places],
    check,
};

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let (min, max) = (limits.of("min"), limits.of("max"));
    for piece in asset.finest() {
        let mesh = &asset.meshes[piece.mesh];
        let (Some(geometry), Some(used)) =
            (&mesh.geometry, asset.material_of(mesh).and_then(|material| material.color))
        else {
            continue;
        };
        let size = asset.textures.get(used.texture).and_then(|texture| texture.size);
        let Some(density) = size.and_then(|size| density(piece, geometry, used, size)) else { continue };
        if !(min..=max).contains(&density) {
            let (than, limit) = if density < min { ("less", min) } else { ("more", max) };
            let message = format!("{density:.0} texels per metre, {than} than {limit}");
            found.over(Some(&mesh.name), message, density, limit);
        }
    }
}

/// The root of texels / m²; `None` where there is no area.
fn density(piece: &Piece, geometry: &Geometry, used: TextureUse, size: [u32; 2]) -> Option<f64> {
    let uvs = geometry.uvs.get(used.set)?.as_ref()?;
    let place = piece.places.first()?;
    let (mut texels, mut area) = (0.0, 0.0);
    for &triangle in &geometry.triangles {
        let corners = geometry.corners(triangle).map(|corner| place.transform_point3(corner));
        let [a, b, c] = triangle.map(|vertex| uvs[vertex as usize] * used.scale);
        area += f64::from(twice_area(corners).length());
        texels += f64::from((b - a).perp_dot(c - a).abs()) * f64::from(size[0]) * f64::from(size[1]);
    }
    (area > 0.0 && texels.is_finite()).then(|| (texels / area).sqrt())
}
