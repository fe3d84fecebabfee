//! The facts about a format: everything that the rest of the program knows of it.

use std::path::Path;

use linden_pipeline::Wanted;

use crate::{Amounts, OptionSpec, Options};

/// What a format is called and can do: feeds the command line, its help, the workbench's form, the
/// estimates of bytes and seconds, and the notes about what is left out.
///
/// Every field has to be given, so that a new format answers every question. A field that is added here is
/// a question to all of them.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// What scripts call it: `glb`.
    pub id: &'static str,
    /// What people call it.
    pub name: &'static str,
    /// Endings that mean this format, without the dot, lower case; the first is the usual one.
    pub extensions: &'static [&'static str],
    /// The media type (IANA's where one is registered).
    pub media_type: &'static str,
    /// Whether everything is in one file, so that nothing is lost on standard output.
    pub self_contained: bool,
    /// One line: what it is good for.
    pub help: &'static str,
    /// Settings of this format.
    pub options: &'static [OptionSpec],
    /// What of a stage is in its files. An exporter notes what it has to leave out (`fit`).
    pub holds: Holds,
    /// What becomes of levels of detail with these options; `None` where none of them changes what `holds` says.
    pub levels_by: Option<fn(&Options) -> LooksIn>,
    /// How its bytes are made with these options: they take as long as that.
    pub encoding: fn(&Options) -> Encoding,
    /// Bytes of its files, those beside the main one included, with these options; `None` where that is not
    /// known. Within 30 % is near enough.
    pub estimate: Option<fn(&Amounts, &Options) -> u64>,
}

impl Format {
    /// What becomes of a plant's levels of detail.
    pub const fn levels(&self) -> LooksIn {
        self.holds.levels
    }

    /// The same with these options: some formats may have a file for each, where the option `lods` says so.
    pub fn levels_with(&self, options: &Options) -> LooksIn {
        self.levels_by.map_or(self.holds.levels, |levels| levels(options))
    }

    /// The longest of its endings that a file's name has, in any case.
    pub fn ending_of(&self, path: &Path) -> Option<&'static str> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        // A name that begins with a dot has no ending; one may be all of a double ending.
        let ends = |ending: &&str| {
            let stem = name.strip_suffix(*ending);
            stem.is_some_and(|stem| {
                stem.len() > 1 && stem.ends_with('.') || stem.is_empty() && ending.contains('.')
            })
        };
        self.extensions.iter().copied().filter(ends).max_by_key(|ending| ending.len())
    }

    /// What becomes of a plant's seasons.
    pub const fn seasons(&self) -> LooksIn {
        self.holds.seasons
    }

    /// The ending of a file that nobody has named: the usual one; of a second flavour of another format (`ply-skeleton`), that
    /// one's.
    pub fn usual_ending(&self) -> &'static str {
        let of_flavour = || self.id.split_once('-').map_or(self.id, |(of, _)| of);
        self.extensions.first().copied().unwrap_or_else(of_flavour)
    }
}

/// How bytes are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Encoding {
    /// Numbers as decimal text.
    Text,
    /// Numbers as they lie in memory.
    Binary,
    /// Meshes are compressed triangle by triangle.
    Packed,
}

/// Where a format has levels of detail, or seasons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LooksIn {
    /// All in one file.
    One,
    /// It holds one: each takes a file of its own.
    Files,
    /// Nothing in it depends on them.
    Nothing,
}

/// What a format holds beside the axial tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each is a fact for itself, none follows from another")]
pub struct Holds {
    /// The surface, with what covers it: leaves.
    pub surface: bool,
    /// Where there is no surface: leaves and other organs, one by one.
    pub organs: bool,
    /// What the surface looks like: colours, or pictures of them.
    pub colors: bool,
    /// Pictures, in the file or beside it.
    pub pictures: bool,
    /// Pictures of normals: how deep the bark is.
    pub normals: bool,
    /// What passes through leaves.
    pub translucency: bool,
    /// Levels of detail.
    pub levels: LooksIn,
    /// Seasons.
    pub seasons: LooksIn,
    /// How the plant moves in the wind.
    pub wind: bool,
    /// Camera, sun, sky and ground.
    pub setting: bool,
    /// One mesh in many places.
    pub instances: bool,
    /// The recipe, so that the tree can be grown again from the file.
    pub recipe: bool,
}

impl Holds {
    /// The axial tree alone.
    pub const SKELETON: Self = Self {
        surface: false,
        organs: false,
        colors: false,
        pictures: false,
        normals: false,
        translucency: false,
        levels: LooksIn::Nothing,
        seasons: LooksIn::Nothing,
        wind: false,
        setting: false,
        instances: false,
        recipe: true,
    };

    /// The axial tree with what grows on it in one season.
    pub const ORGANS: Self = Self { organs: true, seasons: LooksIn::Files, ..Self::SKELETON };

    /// One plant in one look with its pictures, at rest.
    pub const MESH: Self = Self {
        surface: true,
        colors: true,
        pictures: true,
        normals: true,
        levels: LooksIn::Files,
        seasons: LooksIn::Files,
        ..Self::SKELETON
    };

    /// Everything in one file.
    pub const SCENE: Self = Self {
        translucency: true,
        levels: LooksIn::One,
        seasons: LooksIn::One,
        wind: true,
        setting: true,
        instances: true,
        ..Self::MESH
    };

    /// What has to be made of a plant for it.
    pub const fn wanted(&self) -> Wanted {
        Wanted { surface: self.surface, organs: self.organs, colors: self.colors }
    }
}

#[cfg(test)]
mod tests {
    use linden_pipeline::dress::levels;
    use linden_pipeline::forest::{Forest, GrownForest, GrownTree, Plan};
    use linden_pipeline::grow::grow;
    use linden_pipeline::preset::builtin;
    use linden_pipeline::recipe::Recipe;
    use linden_pipeline::stage::Stage;
    use linden_pipeline::{Quiet, Wanted};

    use crate::{Bundle, Options, REGISTRY};

    #[test]
    fn every_format_has_a_usual_ending_that_is_its_own_or_its_kinds() {
        for format in REGISTRY.iter().map(|exporter| exporter.format()) {
            let ending = format.usual_ending();
            let of = crate::for_path(std::path::Path::new(&format!("tree.{ending}"))).unwrap().format();
            assert!(format.extensions.contains(&ending) || format.extensions.is_empty(), "{}", format.id);
            assert!(format.id == of.id || format.id.starts_with(of.id), "{} {ending} {}", format.id, of.id);
        }
        assert_eq!(crate::find("ply-skeleton").unwrap().format().usual_ending(), "ply");
    }

    #[test]
    fn levels_are_where_the_options_of_a_format_say() {
        use crate::LooksIn::{Files, Nothing, One};
        let cases = [
            ("glb", "lods", "msft", One),
            ("gltf", "lods", "siblings", One),
            ("glb", "lods", "files", Files),
            ("usda", "lods", "variants", One),
            ("usdz", "lods", "files", Files),
            ("usdc", "nanite", "static", Nothing),
            ("usda", "nanite", "skeletal", Nothing),
            ("usda", "nanite", "none", One),
        ];
        for (id, name, word, expected) in cases {
            let format = crate::find(id).unwrap().format();
            let mut options = Options::new(format);
            options.set(name, word).unwrap();
            assert_eq!(format.levels_with(&options), expected, "{id} {name}={word}");
        }
        // Files of their own, of an assembly too.
        let format = crate::find("usda").unwrap().format();
        let mut options = Options::new(format);
        options.set("lods", "files").unwrap();
        options.set("nanite", "static").unwrap();
        assert_eq!(format.levels_with(&options), Files);
        for format in REGISTRY.iter().map(|exporter| exporter.format()) {
            assert_eq!(format.levels_with(&Options::new(format)), format.levels(), "{}", format.id);
        }
    }

    /// Bytes of all files, by name.
    fn written(stage: &Stage<'_>, exporter: &dyn crate::Exporter) -> Vec<(String, Vec<u8>)> {
        let folder = tempfile::tempdir().unwrap();
        let mut bundle = Bundle::create(&folder.path().join("tree.any")).unwrap();
        exporter.write(stage, &Options::new(exporter.format()), &mut bundle, &Quiet).unwrap();
        let files = bundle.commit().unwrap();
        let name = |path: &std::path::Path| path.file_name().unwrap().to_string_lossy().into_owned();
        files.iter().map(|file| (name(&file.path), std::fs::read(&file.path).unwrap())).collect()
    }

    #[test]
    fn formats_write_the_same_of_what_they_want_alone() {
        let cases: [(&str, &[(&str, &str)]); 4] = [
            ("dressed-fir", &[]),
            ("drawn-oak", &[("points", "400"), ("triangles", "3000")]),
            ("drawn-oak", &[("points", "300"), ("lods", "2"), ("billboard", "2"), ("wind", "attributes")]),
            ("abop-f", &[]),
        ];
        let mut less = 0;
        for (id, knobs) in cases {
            let mut preset = builtin(id).unwrap().load().unwrap();
            let small = [("leaf_size", "64"), ("bark_size", "64"), ("billboard_size", "128")];
            for (knob, value) in small.iter().chain(knobs) {
                preset.set(knob, value).unwrap();
            }
            let recipe = Recipe::new(preset);
            let grown = grow(&recipe, &Quiet).unwrap();
            let all = levels(&recipe, &grown, &Quiet).unwrap();
            for exporter in REGISTRY {
                let wanted = exporter.format().holds.wanted();
                let some = levels(&recipe.clone().wanting(wanted), &grown, &Quiet).unwrap();
                // What falls from one level's triangles to the next's is told where triangles are wanted.
                let notes: Vec<&String> = all
                    .notes
                    .iter()
                    .filter(|note| wanted.surface || !note.starts_with("billboard"))
                    .collect();
                assert_eq!(some.notes.iter().collect::<Vec<_>>(), notes);
                let is_less = some.levels[0].scene.parts.len() < all.levels[0].scene.parts.len();
                assert_eq!(is_less, !wanted.surface);
                less += u32::from(wanted != Wanted::ALL);
                // Of one level, as formats that hold no more are given it.
                let of_one = |levels: &linden_pipeline::dress::Levels| {
                    written(&Stage::of(&levels.levels[0].scene), *exporter)
                };
                assert!(of_one(&some) == of_one(&all), "{id} {knobs:?}: {}", exporter.format().id);
            }
        }
        assert!(less > 12, "{less}");
    }

    /// Budgets are those of the forest, of which files without leaves know nothing, and that of a tree.
    #[test]
    fn forests_are_dressed_as_far_as_formats_want_and_files_are_the_same() {
        let small = [("points", "300"), ("leaf_size", "64"), ("bark_size", "64"), ("card_size", "128")];
        let recipe = |id: &str, knobs: &[(&str, &str)]| {
            let mut preset = builtin(id).unwrap().load().unwrap();
            for (knob, value) in small.iter().chain(knobs) {
                preset.set(knob, value).unwrap();
            }
            Recipe::new(preset)
        };
        let kinds = || vec![recipe("drawn-oak", &[]), recipe("dressed-fir", &[("triangles", "3000")])];
        let alone = || vec![recipe("drawn-oak", &[])];
        for (kinds, places, trees) in [(kinds(), "scattered", 5), (alone(), "given", 1)] {
            let mut forest = Forest::of(kinds);
            for (knob, value) in [("area", "24"), ("spacing", "6"), ("trees", "5"), ("triangles", "2000")] {
                forest.layout.set(knob, value).unwrap();
            }
            forest.layout.set("places", places).unwrap();
            let plan = forest.plan(&Quiet).unwrap();
            let grown = |plan: Plan| GrownForest::grow(&forest, plan, &Quiet, &mut |_| ()).unwrap();
            let all = grown(plan.clone());
            assert_eq!(all.places.len(), trees);
            let is_dressed = |tree: &GrownTree| !tree.levels.levels[0].scene.parts.is_empty();
            assert!(all.trees.iter().all(is_dressed));
            for exporter in REGISTRY {
                let format = exporter.format();
                let wanted = format.holds.wanted();
                if wanted.surface {
                    continue;
                }
                let some = grown(plan.clone().wanting(wanted));
                assert!(!some.trees.iter().any(is_dressed), "{}", format.id);
                let files = [&some, &all].map(|forest| written(&forest.stage(), *exporter));
                assert!(files[0] == files[1], "{places}: {}", format.id);
            }
        }
    }
}
