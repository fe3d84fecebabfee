//! What of a tree bodies bump into: few shapes that physics engines are fast with, in place of its surface.
//!
//! Thick wood is chains of capsules, the crown one convex hull. What a format makes of them is told where it is
//! written: nodes with `OMI_physics_body`, meshes by the names that Unreal and Godot look for, or `UsdPhysics`.

mod capsules;
mod crown;
mod solid;

use linden_pipeline::scene::Scene;

pub(crate) use self::capsules::Capsule;
pub(crate) use self::solid::Solid;
use crate::{OptionSpec, Options};

/// Which shapes.
pub(crate) const COLLISION: OptionSpec = OptionSpec::choice(
    "collision",
    &["none", "capsules", "hull"],
    "shapes for physics: capsules along thick wood, within a quarter of its radius; or those of the trunk and one convex \
     hull of the crown",
)
.once_a_plant();

/// How many at most.
pub(crate) const MOST: OptionSpec = OptionSpec::count(
    "collision_most",
    (1, 1000),
    "64",
    "shapes of a plant at most: the thickest wood has them",
)
.once_a_plant();

/// The shapes of a plant, where it stands at the origin.
#[derive(Clone, Debug, Default)]
pub(crate) struct Colliders {
    /// Thick ones first.
    pub capsules: Vec<Capsule>,
    /// The crown.
    pub crown: Option<Solid>,
}

impl Colliders {
    /// Those that were asked for; none where that is nothing.
    pub fn of(scene: &Scene, options: &Options) -> Self {
        let most = options.number(MOST.knob.name);
        if options.is_word(COLLISION.knob.name, "capsules") {
            return Self { capsules: capsules::of(&scene.skeleton, u32::MAX, most), crown: None };
        }
        if !options.is_word(COLLISION.knob.name, "hull") {
            return Self::default();
        }
        let crown = crown::of(scene);
        let left = most - usize::from(crown.is_some() && most > 1);
        Self { capsules: capsules::of(&scene.skeleton, 0, left), crown }
    }
}

/// Whether any were asked for.
pub(crate) fn is_wanted(options: &Options) -> bool {
    options.value(COLLISION.knob.name).is_some() && !options.is_word(COLLISION.knob.name, "none")
}

/// The options in a few words, as files tell them: `capsules 64`.
pub(crate) fn told(options: &Options) -> Option<String> {
    let word = options.value(COLLISION.knob.name).filter(|_| is_wanted(options))?;
    Some(format!("{word} {}", options.number(MOST.knob.name)))
}

/// How many shapes a plant has, about: what its size is estimated by.
pub(crate) fn expected(axes: u64, options: &Options) -> u64 {
    if is_wanted(options) { (options.number(MOST.knob.name) as u64).min(2 * axes) } else { 0 }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use linden_pipeline::dress::dress;
    use linden_pipeline::grow::grow;
    use linden_pipeline::preset::builtin;
    use linden_pipeline::recipe::Recipe;
    use linden_pipeline::{DVec3, Quiet};

    use super::*;

    fn scene(id: &str) -> Scene {
        let recipe = Recipe::new(builtin(id).unwrap().load().unwrap());
        dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap()
    }

    fn options(words: &[(&str, &str)]) -> Options {
        let mut options = Options::new(crate::find("glb").unwrap().format());
        for (name, value) in words {
            options.set(name, value).unwrap();
        }
        options
    }

    /// By the divergence theorem, of closed meshes.
    fn volume(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let of = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            a.dot(b.cross(c)) / 6.0
        };
        triangles.iter().map(of).sum()
    }

    #[test]
    fn capsules_are_as_large_as_the_wood() {
        for id in ["simple", "fir"] {
            let scene = scene(id);
            let wood = &scene.parts[0].mesh;
            let points: Vec<DVec3> = wood.positions.iter().map(|point| point.as_dvec3()).collect();
            let wood = volume(&points, &wood.triangles);
            let colliders =
                Colliders::of(&scene, &options(&[("collision", "capsules"), ("collision_most", "1000")]));
            let length = |capsule: &Capsule| f64::from(capsule.from.distance(capsule.to));
            let sum: f64 = colliders
                .capsules
                .iter()
                .map(|capsule| PI * f64::from(capsule.radius_m * capsule.radius_m) * length(capsule))
                .sum();
            // Twigs have none.
            assert!((0.7..1.1).contains(&(sum / wood)), "{id}: {sum} of {wood} cubic metres");
        }
    }
}
