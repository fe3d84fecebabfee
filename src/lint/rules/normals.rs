//! Normals of vertices.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset, Geometry};
use crate::finding::{Findings, Severity};
use crate::mesh::{percent, twice_area};

pub(super) const RULE: Rule = Rule {
    id: "normals",
    checks: "normals that are missing, not of length 1, or against their face (not on foliage, whose normals may be the crown's)",
    why: "light is computed by them: wood turns black, flat, or too bright",
    mend: "recalculate normals, and normalise them after scaling",
    severity: Severity::Warn,
    limits: &[
        limit("length", 0.02, "", "most that a length may differ from 1"),
        limit("against", 0.5, "%", "most triangles of a mesh whose normals point to their back"),
    ],
    needs: &[Aspect::Normals, Aspect::Geometry, Aspect::Alpha],
    check,
};

fn check(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let (length, against) = (limits.of("length"), limits.of("against"));
    for (mesh, geometry) in asset.drawn() {
        let Some(normals) = &geometry.normals else {
            found.at(&mesh.name, "it has no normals");
            continue;
        };
        let is_other = |normal: &&glam::Vec3| !((f64::from(normal.length()) - 1.0).abs() <= length);
        let count = normals.iter().filter(is_other).count();
        if count > 0 {
            let worst = normals.iter().map(|normal| normal.length());
            let worst = worst.fold(1.0_f32, |worst, length| {
                if (length - 1.0).abs() > (worst - 1.0).abs() || length.is_nan() { length } else { worst }
            });
            let all = normals.len();
            let message = format!("{count} of {all} normals are not of length 1; the worst is {worst}");
            found.over(Some(&mesh.name), message, count as f64, 0.0);
        }
        if asset.is_foliage(mesh) {
            continue;
        }
        let count = facing_back(geometry, normals);
        let share = percent(count, geometry.triangles.len());
        if share > against {
            let all = geometry.triangles.len();
            let message =
                format!("{count} of {all} triangles have normals that point to their back ({share:.1} %)");
            found.over(Some(&mesh.name), message, share, against);
        }
    }
}

fn facing_back(geometry: &Geometry, normals: &[glam::Vec3]) -> usize {
    let is_back = |triangle: &&[u32; 3]| {
        let normal: glam::Vec3 = triangle.iter().map(|&vertex| normals[vertex as usize]).sum();
        twice_area(geometry.corners(**triangle)).dot(normal) < 0.0
    };
    geometry.triangles.iter().filter(is_back).count()
}
