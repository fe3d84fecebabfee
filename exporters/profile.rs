//! Programs that files are for: what each reads, and the options that suit it.
//!
//! One table, a row a program, from the documentation of each (those that the tests run are said in the docs). An
//! option is set in each format that has it, and whatever the user says about it holds.

use linden_pipeline::knob::{listed, nearest};

use crate::{ExportError, Format, Options};

/// A program that files are for.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Profile {
    /// What scripts call it.
    pub id: &'static str,
    /// What people call it.
    pub name: &'static str,
    /// The formats that it reads, the best first.
    pub formats: &'static [&'static str],
    /// Options of formats, and their values.
    pub options: &'static [(&'static str, &'static str)],
    /// Knobs of the plant, and their values.
    pub knobs: &'static [(&'static str, &'static str)],
    /// Values of options that it cannot read, and what becomes of them.
    pub unread: &'static [(&'static str, &'static str, &'static str)],
    /// How levels of detail arrive.
    pub levels: &'static str,
    /// How shapes for physics arrive.
    pub colliders: &'static str,
    /// What of the wind arrives.
    pub wind: &'static str,
    /// What of the light that passes through leaves arrives; empty where that is not known.
    pub leaves: &'static str,
    /// Its axis that points up, and its unit; importers turn and scale.
    pub axis: &'static str,
}

const NO_MESHOPT: (&str, &str, &str) = ("compress", "meshopt", "the file is refused");
const NO_INSTANCES: (&str, &str, &str) =
    ("instances", "true", "leaves are missing, or stand once at the origin");
const INSTANCES_REFUSED: (&str, &str, &str) = ("instances", "true", "the file is refused");
const NO_WEBP: (&str, &str, &str) = ("picture_format", "webp", "pictures are missing");
const NO_QUANTIZE: (&str, &str, &str) = ("quantize", "true", "the file is refused");
const SIBLINGS: (&str, &str, &str) = ("lods", "siblings", "all levels are seen at once");
const MSFT: (&str, &str, &str) = ("lods", "msft", "the finest level alone is seen");

/// All programs.
#[rustfmt::skip]
pub const PROFILES: [Profile; 9] = [
    Profile { id: "blender", name: "Blender 4.5 and newer", formats: &["glb", "gltf", "usda", "usdc", "obj", "ply", "stl"], options: &[("lods", "files")], knobs: &[], unread: &[NO_MESHOPT, SIBLINGS, MSFT], levels: "a file each", colliders: "none are read", wind: "wind=bones as an armature with an action, wind=sway as shape keys; _WIND as an attribute", leaves: "opaque; a script lets light through: docs/formats.md, Into Blender", axis: "Z up, metres" },
    Profile { id: "godot", name: "Godot 4", formats: &["glb", "gltf", "obj"], options: &[("lods", "files"), ("wind_as", "packed"), ("collision", "capsules"), ("collision_most", "4"), ("collision_as", "godot")], knobs: &[], unread: &[NO_MESHOPT, NO_QUANTIZE, INSTANCES_REFUSED, SIBLINGS, MSFT], levels: "made by Godot itself, or a file each", colliders: "convex meshes called NAME-convcolonly become bodies", wind: "wind=bones (a Skeleton3D) and wind=sway in the AnimationPlayer; wind=attributes packed into COLOR, UV2 and CUSTOM0", leaves: "", axis: "Y up, metres" },
    Profile { id: "unity", name: "Unity 2022 and newer, with glTFast and com.unity.meshopt.decompress", formats: &["glb", "gltf", "obj"], options: &[("lods", "siblings"), ("wind_as", "packed"), ("quantize", "true"), ("compress", "meshopt"), ("picture_format", "jpeg")], knobs: &[], unread: &[NO_WEBP, MSFT], levels: "NAME_LOD0, NAME_LOD1 side by side: children for a LOD Group", colliders: "none are read; a mesh of --set glb.collision=hull serves a Mesh Collider", wind: "wind=bones as a skinned mesh, wind=sway as blend shapes; wind=attributes packed into the vertex colour and UV1, UV2", leaves: "", axis: "Y up, metres" },
    Profile { id: "unreal", name: "Unreal 5", formats: &["glb", "gltf", "usda", "usdc", "obj"], options: &[("lods", "siblings"), ("wind_as", "packed"), ("collision", "capsules"), ("collision_most", "4"), ("collision_as", "unreal")], knobs: &[], unread: &[NO_MESHOPT, NO_WEBP, MSFT], levels: "NAME_LOD0, NAME_LOD1 side by side", colliders: "meshes called UCX_MESH_00 become simple collision", wind: "wind=bones as a skeletal mesh, wind=sway as morph targets; wind=attributes packed into the vertex colour and UV1, UV2, or by --set glb.wind_as=pivot-painter as texels for Pivot Painter 2", leaves: "", axis: "Z up, centimetres: the importer turns and scales" },
    Profile { id: "three", name: "three.js", formats: &["glb", "gltf"], options: &[("lods", "files"), ("quantize", "true"), ("compress", "meshopt")], knobs: &[], unread: &[SIBLINGS, MSFT], levels: "a file each, into THREE.LOD", colliders: "none are read; OMI extensions arrive in userData", wind: "wind=bones and wind=sway by AnimationMixer; the attributes _wind and _windpivot", leaves: "", axis: "Y up, metres" },
    Profile { id: "babylon", name: "Babylon.js", formats: &["glb", "gltf"], options: &[("lods", "files"), ("wind_as", "packed"), ("quantize", "true"), ("compress", "meshopt")], knobs: &[], unread: &[SIBLINGS], levels: "a file each, for addLODLevel; MSFT_lod is read too", colliders: "none are read", wind: "wind=bones and wind=sway as animation groups; wind=attributes packed into COLOR, UV2 and UV3", leaves: "", axis: "Y up, metres; scene.useRightHandedSystem = true takes files as they are" },
    Profile { id: "bevy", name: "Bevy", formats: &["glb", "gltf"], options: &[("lods", "files")], knobs: &[], unread: &[NO_MESHOPT, NO_QUANTIZE, NO_INSTANCES, SIBLINGS, MSFT], levels: "a file each", colliders: "none are read", wind: "wind=bones as joints (256 at most), wind=sway as morph targets", leaves: "", axis: "Y up, metres" },
    Profile { id: "omniverse", name: "Omniverse", formats: &["usda", "usdc", "usdz"], options: &[("lods", "variants"), ("collision", "capsules")], knobs: &[], unread: &[], levels: "variants of the set lod", colliders: "UsdPhysics: capsules, a convex hull", wind: "wind=bones as UsdSkel joints, wind=sway as blend shapes; primvars:wind", leaves: "", axis: "as the file says: Y up, metres" },
    Profile { id: "print", name: "slicers for 3D printers", formats: &["3mf", "stl"], options: &[("unit", "mm")], knobs: &[("junction", "watertight"), ("leaf_keep", "0")], unread: &[("unit", "m", "a tree of metres is a few millimetres high")], levels: "a file each", colliders: "none", wind: "none", leaves: "", axis: "Z up, millimetres" },
];

impl Profile {
    /// The program that scripts call `id`.
    ///
    /// ```
    /// use linden_exporters::Profile;
    /// assert_eq!(Profile::find("godot")?.formats[0], "glb");
    /// assert!(Profile::find("godto").unwrap_err().to_string().contains("did you mean 'godot'?"));
    /// # Ok::<(), linden_exporters::ExportError>(())
    /// ```
    ///
    /// # Errors
    /// [`ExportError::UnknownProfile`] with the nearest name and the list.
    pub fn find(id: &str) -> Result<&'static Self, ExportError> {
        let ids = || PROFILES.iter().map(|profile| profile.id);
        PROFILES.iter().find(|profile| profile.id == id).ok_or_else(|| ExportError::UnknownProfile {
            typed: id.to_owned(),
            nearest: nearest(&id.to_lowercase(), ids()),
            known: ids().collect(),
        })
    }

    /// A format's options as this program wants them.
    ///
    /// # Errors
    /// None for the formats of this crate: a test sets all of them.
    pub fn options(&self, format: &'static Format) -> Result<Options, ExportError> {
        let mut options = Options::new(format);
        for (name, value) in self.options_of(format) {
            options.suit(name, value)?;
        }
        Ok(options)
    }

    /// What it sets of a format: the options that the format has, with values that it knows.
    pub fn options_of(&self, format: &'static Format) -> impl Iterator<Item = (&'static str, &'static str)> {
        let has = |(name, value): &(&str, &str)| {
            format.options.iter().any(|spec| spec.knob.name == *name && spec.knob.kind.parse(value).is_ok())
        };
        self.options.iter().copied().filter(has)
    }

    /// What it cannot read of a file with these options: a sentence each.
    pub fn unread(&self, format: &Format, options: &Options, levels: usize) -> Vec<String> {
        let mut said = Vec::new();
        if !self.formats.contains(&format.id) {
            said.push(format!(
                "{} is not known to read {}: write {}",
                self.name,
                format.id,
                self.formats.join(", ")
            ));
        }
        for (name, value, becomes) in self.unread {
            let is_set = options.value(name).is_some_and(|set| set.to_string() == *value);
            // Of one level there is nothing to say.
            if is_set && (*name != "lods" || levels > 1) {
                let way = if *name == "lods" { self.way_of_levels(format, value) } else { String::new() };
                said.push(format!(
                    "{}={value} is not read by {}: {becomes}{way}",
                    name_of(format, name),
                    self.name
                ));
            }
        }
        said
    }
}

impl Profile {
    /// Which programs read levels that are told so, and how this one has them told: behind what becomes of them here.
    fn way_of_levels(&self, format: &Format, value: &str) -> String {
        let reads = |profile: &&Self| {
            let mut unread = profile.unread.iter();
            profile.formats.contains(&format.id)
                && unread.all(|(name, other, _)| (*name, *other) != ("lods", value))
        };
        let readers: Vec<&str> = PROFILES.iter().filter(reads).map(|profile| profile.name).collect();
        let readers = match readers.as_slice() {
            [] => String::new(),
            [one] => format!(" ({one} reads it)"),
            several => format!(" ({} read it)", listed(several, "and")),
        };
        let own = self.options.iter().find(|(name, _)| *name == "lods");
        let own = own.map(|(_, own)| format!("; --lods-as {own} writes what it reads")).unwrap_or_default();
        readers + &own
    }
}

fn name_of(format: &Format, option: &str) -> String {
    format!("{}.{option}", format.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::find;

    #[test]
    fn every_profile_sets_what_its_best_format_has() {
        for profile in &PROFILES {
            let formats: Vec<&'static Format> =
                profile.formats.iter().map(|id| find(id).unwrap().format()).collect();
            for (name, value) in profile.options {
                let is_known =
                    formats.iter().any(|format| profile.options_of(format).any(|set| set == (*name, *value)));
                assert!(is_known, "{}: {name}={value}", profile.id);
            }
            for format in formats {
                let options = profile.options(format).unwrap();
                assert_eq!(profile.unread(format, &options, 3), [""; 0], "{}", profile.id);
            }
        }
    }

    #[test]
    fn what_is_not_read_is_said() {
        let glb = find("glb").unwrap().format();
        let said = |id: &str, words: &[(&str, &str)], levels| {
            let profile = Profile::find(id).unwrap();
            let mut options = profile.options(glb).unwrap();
            for (name, value) in words {
                options.set(name, value).unwrap();
            }
            profile.unread(glb, &options, levels)
        };
        assert_eq!(said("three", &[], 1), [""; 0]);
        assert_eq!(
            said("bevy", &[("quantize", "true")], 1),
            ["glb.quantize=true is not read by Bevy: the file is refused"]
        );
        assert_eq!(said("godot", &[("lods", "msft")], 1), [""; 0]);
        assert_eq!(
            said("godot", &[("lods", "msft")], 3),
            [
                "glb.lods=msft is not read by Godot 4: the finest level alone is seen (Babylon.js reads it); --lods-as files \
              writes what it reads"
            ]
        );
        assert!(said("print", &[], 1)[0].contains("not known to read glb"));
    }
}
