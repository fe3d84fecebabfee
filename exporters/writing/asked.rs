//! Options that were asked for and have nothing to act on, said by name.

use linden_pipeline::scene::Part;
use linden_pipeline::stage::{Plant, Stage};

use crate::collision::{self, COLLISION, MOST};
use crate::{Bundle, Options};

/// What is said of ways to write levels of one level.
pub(crate) const ONE_LEVEL: &str = "lods changes nothing: there is one level of detail; --lods 3 makes more";

/// Notes what was asked for by options of `format` and changes nothing on this stage: ways to write levels of one level, wind
/// of what stands still, shapes where none are written.
pub(crate) fn note_asked(stage: &Stage<'_>, options: &Options, bundle: &mut Bundle) {
    let is_asked = |name: &str| options.is_asked(name);
    if is_asked("lods") {
        let are_files = options.is_word("lods", "files");
        // Of levels in a file each, each is alone here.
        if are_files && stage.levels() > 1 {
            bundle.note("lods=files: all levels are in this one; only files that have names can be one for each level");
        } else if !are_files && stage.levels() < 2 {
            bundle.note(ONE_LEVEL);
        }
    }
    if is_asked("wind_as") && !parts(stage).any(|part| part.wind.is_some()) {
        bundle.note("wind_as changes nothing: nothing moves; --wind=attributes lets it");
    } else if is_asked("wind_as") && has_bones(stage) {
        bundle.note("wind_as changes nothing: joints move it; --wind=attributes tells shaders");
    }
    if has_bones(stage) && !stage.is_single() && options.is_on("instances") {
        bundle.note("instances: trees that move by joints stand one by one, because each has its own");
    }
    if !collision::is_wanted(options) {
        for name in [MOST.knob.name, "collision_as"] {
            if is_asked(name) {
                let shapes = COLLISION.knob.name;
                bundle.note(format!(
                    "{name} changes nothing: no shapes for physics were asked for ({shapes}=capsules)"
                ));
            }
        }
    }
}

/// Whether something moves by joints.
pub(crate) fn has_bones(stage: &Stage<'_>) -> bool {
    parts(stage).any(|part| part.wind.as_ref().is_some_and(|wind| wind.bones.is_some()))
}

fn parts<'a>(stage: &'a Stage<'_>) -> impl Iterator<Item = &'a Part> {
    stage.plants.iter().flat_map(Plant::scenes).flat_map(|scene| &scene.parts)
}
