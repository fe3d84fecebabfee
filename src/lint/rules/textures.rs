//! Pictures: their sizes, and whether they are there.

use super::{Limits, Rule, limit};
use crate::asset::{Aspect, Asset};
use crate::finding::{Findings, Severity};

pub(super) const SIZE: Rule = Rule {
    id: "texture-size",
    checks: "pictures whose sides are no powers of two, or too long",
    why: "block compression and mipmaps need powers of two, and graphics cards have a longest side",
    mend: "scale the picture",
    severity: Severity::Warn,
    limits: &[
        limit("max", 4096.0, "pixels", "most pixels of a side"),
        limit("power_of_two", 1.0, "", "1: sides must be powers of two; 0: they need not"),
    ],
    needs: &[Aspect::Pictures],
    check: size,
};

pub(super) const MISSING: Rule = Rule {
    id: "texture-missing",
    checks: "pictures that a material names and that are not there, or cannot be read",
    why: "the material shows white, pink, or nothing",
    mend: "put the file beside the model, or correct the path; absolute paths work on one machine alone",
    severity: Severity::Error,
    limits: &[],
    needs: &[Aspect::Materials],
    check: missing,
};

fn size(asset: &Asset, limits: &Limits, found: &mut Findings<'_>) {
    let max = limits.of("max");
    for texture in &asset.textures {
        let Some([width, height]) = texture.size else { continue };
        let longest = f64::from(width.max(height));
        if longest > max {
            let message = format!("{width} x {height} pixels, more than {max}");
            found.over(Some(&texture.name), message, longest, max);
        }
        if limits.of("power_of_two") != 0.0 && !(width.is_power_of_two() && height.is_power_of_two()) {
            found.at(&texture.name, format!("{width} x {height} pixels: not powers of two"));
        }
    }
}

fn missing(asset: &Asset, _: &Limits, found: &mut Findings<'_>) {
    for texture in &asset.textures {
        if let Some(problem) = &texture.problem {
            found.at(&texture.name, problem.clone());
        }
    }
}
