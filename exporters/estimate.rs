//! How large files will be, from the skeleton alone: told before anything is dressed or written.
//!
//! Triangles and vertices are counted, bytes follow from these and from what each format was measured to
//! need. A test holds the sum for every built-in preset and format within 30 % of the real files.

use std::collections::BTreeSet;

use linden::detail::share_of_wood;
use linden::foliage::{Organs, PROTOTYPES};
use linden::forecast::Sample;
use linden::grow::Grown;
use linden::monitor::{Cancelled, Monitor};
use linden::preset::{BarkLook, DetailLook, Preset};
use linden::recipe::{Geometry, Recipe};
use linden::surface::{self, Junction, SurfaceError, Tubes};
use linden::texture::BarkStyle;
use linden::wind::Wind;

use crate::{Format, LooksIn, Options};

/// What an export of a tree will amount to, about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Estimate {
    /// Vertices of the finest level.
    pub vertices: u64,
    /// Triangles of the finest level.
    pub triangles: u64,
    /// All levels of triangles, the finest first.
    levels: Vec<Amount>,
    /// Materials of the foliage.
    foliage_colors: u64,
    nodes: u64,
    axes: u64,
    /// The recipe's line.
    recipe_bytes: u64,
    /// All pictures as PNG but those of the billboard.
    picture_bytes: u64,
    /// Those of the billboard.
    billboard_bytes: u64,
    wind: Wind,
    /// Without a budget.
    all_triangles: u64,
    /// Of leaves.
    kinds: BTreeSet<u8>,
}

/// What a level of detail amounts to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Amount {
    vertices: u64,
    triangles: u64,
    /// The leaves' and organs' part of these.
    leaf_vertices: u64,
    leaf_triangles: u64,
    /// Vertices of what has no pictures.
    plain_vertices: u64,
    /// What instances leave out and put in its place.
    instanced: Instanced,
}

impl Amount {
    /// What is left of it within so many triangles.
    fn within(&self, budget: u64) -> Self {
        if budget >= self.triangles {
            return *self;
        }
        let wood = self.triangles - self.leaf_triangles;
        let for_wood = share_of_wood(budget, wood, self.leaf_triangles);
        let part = |share: u64, all: u64| {
            move |count: u64| (count as f64 * (share as f64 / all.max(1) as f64)) as u64
        };
        let (of_wood, of_leaves) = (part(for_wood, wood), part(budget - for_wood, self.leaf_triangles));
        let leaf_vertices = of_leaves(self.leaf_vertices);
        let instanced = self.instanced;
        let left = |all: u64, copies: u64| of_leaves(all).saturating_sub(all - copies);
        Self {
            vertices: of_wood(self.vertices - self.leaf_vertices) + leaf_vertices,
            triangles: budget,
            leaf_vertices,
            leaf_triangles: budget - for_wood,
            plain_vertices: of_leaves(self.plain_vertices),
            // One of each shape is written however few there are.
            instanced: Instanced {
                vertices: left(self.leaf_vertices, instanced.vertices),
                triangles: left(self.leaf_triangles, instanced.triangles),
                plain_vertices: left(self.plain_vertices, instanced.plain_vertices),
                copies: of_leaves(instanced.copies),
            },
        }
    }

    fn and(self, other: Self) -> Self {
        let (a, b) = (self.instanced, other.instanced);
        Self {
            vertices: self.vertices + other.vertices,
            triangles: self.triangles + other.triangles,
            plain_vertices: self.plain_vertices + other.plain_vertices,
            leaf_vertices: self.leaf_vertices + other.leaf_vertices,
            leaf_triangles: self.leaf_triangles + other.leaf_triangles,
            instanced: Instanced {
                vertices: a.vertices + b.vertices,
                triangles: a.triangles + b.triangles,
                plain_vertices: a.plain_vertices + b.plain_vertices,
                copies: a.copies + b.copies,
            },
        }
    }

    /// What is left to be written of it as it is, if instances are.
    fn without_instances(self) -> Self {
        Self {
            vertices: self.vertices - self.instanced.vertices,
            triangles: self.triangles - self.instanced.triangles,
            plain_vertices: self.plain_vertices - self.instanced.plain_vertices,
            ..self
        }
    }
}

/// What becomes of foliage as few meshes in many places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Instanced {
    /// Vertices and triangles that are not written then, and those of the first that have no pictures.
    vertices: u64,
    triangles: u64,
    plain_vertices: u64,
    /// Places.
    copies: u64,
}

impl Instanced {
    /// With so many times the places.
    fn of(organs: &Organs, times: f64) -> Self {
        let mut own = Self::default();
        let mut seen = BTreeSet::new();
        for (organ, &prototype) in organs.placed.prototypes.iter().enumerate() {
            own.copies += 1;
            if !seen.insert(prototype) {
                let mesh = organs.mesh(organ);
                let vertices = mesh.positions.len() as u64;
                own.vertices += vertices;
                own.triangles += mesh.triangles.len() as u64;
                own.plain_vertices += if usize::from(prototype) < PROTOTYPES.len() { vertices } else { 0 };
            }
        }
        let of = |count: u64| (count as f64 * times) as u64;
        Self {
            vertices: of(own.vertices),
            triangles: of(own.triangles),
            plain_vertices: of(own.plain_vertices),
            copies: of(own.copies),
        }
    }
}

impl Estimate {
    /// Counts what the surface and the foliage of a tree will have, within its budget: exactly, but for
    /// `junction=watertight`, which is counted as tubes.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        Self::counted(recipe, grown, &recipe.preset.tubes, [1.0; 2], monitor)
    }

    /// What a tree that has not grown will have, from a sample of it.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn of_sample(recipe: &Recipe, sample: &Sample, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let times = [sample.wood_times, sample.leaf_times];
        Self::counted(recipe, &sample.grown, &sample.recipe.preset.tubes, times, monitor)
    }

    /// Counts a tree's wood and leaves, each so many times.
    fn counted(
        recipe: &Recipe,
        grown: &Grown,
        tubes: &Tubes,
        [wood_times, leaf_times]: [f64; 2],
        monitor: &dyn Monitor,
    ) -> Result<Self, Cancelled> {
        let Preset { foliage, detail, .. } = &recipe.preset;
        let of_wood = |count: u64| (count as f64 * wood_times) as u64;
        let of_leaves = |count: u64| (count as f64 * leaf_times) as u64;
        let skeleton = &grown.skeleton;
        let tubes = match tubes.junction {
            Junction::Watertight => Tubes { junction: Junction::Overlap, ..*tubes },
            _ => *tubes,
        };
        let (mut vertices, mut triangles) = (0, 0);
        match surface::count(skeleton, &tubes, monitor) {
            Ok(counts) => {
                vertices = of_wood(counts.iter().map(|own| own.vertices as u64).sum());
                triangles = of_wood(counts.iter().map(|own| own.triangles as u64).sum());
            }
            Err(SurfaceError::Cancelled(cancelled)) => return Err(cancelled),
            // Counting finds nothing else.
            Err(_) => {}
        }
        let (foliage_vertices, foliage_triangles) = grown.organs.amount();
        let (foliage_vertices, foliage_triangles) =
            (of_leaves(foliage_vertices), of_leaves(foliage_triangles));
        let last = foliage.turtle_colors().len().saturating_sub(1) as u64;
        let organs = &grown.organs;
        let wind = recipe.preset.wind.wind;
        let own = (0..organs.len()).filter(|&i| organs.color(i).is_none());
        let colors: BTreeSet<u64> = own.map(|i| last.min(organs.growth(i).color.into())).collect();
        let kinds: BTreeSet<u8> = organs.shapes.iter().map(|shape| shape.kind).collect();
        let leaves = kinds.iter().filter_map(|&kind| foliage.kinds().nth(kind.into()));
        let leaves = leaves.map(|kind| match &kind.picture {
            Some(file) => file_bytes(recipe, file),
            None => leaf_picture_bytes(foliage.size_px),
        });
        // What moves in the wind is written one by one.
        let instanced =
            if wind == Wind::Off { Instanced::of(organs, leaf_times) } else { Instanced::default() };
        let all = Amount {
            vertices: vertices + foliage_vertices,
            triangles: triangles + foliage_triangles,
            plain_vertices: of_leaves(organs.plain_amount().0),
            leaf_vertices: foliage_vertices,
            leaf_triangles: foliage_triangles,
            instanced,
        };
        let budgets = detail.budgets();
        let budget = if detail.finest() == 0 { u64::MAX } else { detail.finest() };
        let finest = all.within(budget);
        let of_level = |level: usize| {
            let share = libm::pow(detail.lod_ratio, level as f64);
            match budgets.get(level) {
                Some(&budget) => all.within(budget),
                None if level == 0 => finest,
                None => all.within((finest.triangles as f64 * share) as u64),
            }
        };
        Ok(Self {
            vertices: finest.vertices,
            triangles: finest.triangles,
            levels: (0..detail.triangle_levels()).map(of_level).collect(),
            foliage_colors: (colors.len() + kinds.len()) as u64,
            nodes: of_wood(skeleton.positions.len() as u64),
            axes: of_wood(skeleton.axes.len() as u64),
            recipe_bytes: recipe.to_line().len() as u64,
            picture_bytes: bark_bytes(recipe) + leaves.sum::<u64>(),
            billboard_bytes: billboard_bytes(detail),
            wind,
            all_triangles: all.triangles,
            kinds,
        })
    }

    /// Triangles of each level, the finest first.
    pub(crate) fn level_triangles(&self) -> impl Iterator<Item = f64> {
        self.levels.iter().map(|level| level.triangles as f64)
    }

    /// Triangles of the whole tree, whatever its budget.
    pub(crate) const fn unbudgeted_triangles(&self) -> f64 {
        self.all_triangles as f64
    }

    /// Kinds of leaves whose pictures are drawn.
    pub(crate) fn drawn_kinds(&self, recipe: &Recipe) -> f64 {
        let kinds = self.kinds.iter().filter_map(|&kind| recipe.preset.foliage.kinds().nth(kind.into()));
        kinds.filter(|kind| kind.picture.is_none()).count() as f64
    }

    /// Triangles that a format's files hold: none where it holds the skeleton alone.
    pub fn triangles_of(&self, format: &Format) -> u64 {
        if format.holds.surface { self.triangles } else { 0 }
    }

    /// Bytes of all files of a format with these options, all levels together. 0 for a format that nobody
    /// measured.
    pub fn bytes(&self, format: &Format, options: &Options) -> u64 {
        if format.levels() == LooksIn::Files {
            return (0..self.level_count()).map(|level| self.level_bytes(level, format, options)).sum();
        }
        let has_billboard = format.levels() == LooksIn::One && options.is_on("pictures");
        let billboard = if has_billboard { self.billboard_bytes } else { 0 };
        let all = self.levels.iter().copied().fold(Amount::default(), Amount::and);
        let around = LEVEL_BYTES * (self.level_count() as u64).saturating_sub(1);
        self.amount_bytes(all, format, options) + billboard + around
    }

    /// Bytes of the files of one level, where it has its own. The billboard is a level after all others.
    pub fn level_bytes(&self, level: usize, format: &Format, options: &Options) -> u64 {
        match self.levels.get(level) {
            Some(&own) => self.amount_bytes(own, format, options),
            None if options.is_on("pictures") => self.billboard_bytes + 2 * self.recipe_bytes,
            None => 2 * self.recipe_bytes,
        }
    }

    /// Vectors that each vertex has for the wind.
    fn wind_vectors(&self) -> u64 {
        if self.wind == Wind::Off { 0 } else { 2 }
    }

    /// Vectors of all morph targets: leaves have each motion, wood all but those of leaves.
    fn targets(&self, wood: u64, leaves: u64) -> u64 {
        if self.wind == Wind::Sway { 4 * wood + 6 * leaves } else { 0 }
    }

    fn level_count(&self) -> usize {
        self.levels.len() + usize::from(self.billboard_bytes > 0)
    }

    /// Text was measured over the built-in presets, in bytes a vertex or node without indices: those
    /// follow from the number of digits.
    fn amount_bytes(&self, amount: Amount, format: &Format, options: &Options) -> u64 {
        let Self { nodes, axes, recipe_bytes: recipe, .. } = *self;
        let is_instanced = options.is_on("instances") && !options.is_word("flavor", "ar");
        let amount = if is_instanced {
            amount.without_instances()
        } else {
            Amount { instanced: Instanced::default(), ..amount }
        };
        let Amount { vertices, triangles, plain_vertices, leaf_vertices, instanced: left_out, .. } = amount;
        let pictures = if options.is_on("pictures") { self.picture_bytes } else { 0 };
        let digits = mean_digits(vertices);
        let skeleton = |is_on: bool, bytes: f64| if is_on { bytes } else { 0.0 };
        let ascii = options.is_word("encoding", "ascii");
        let text = match format.id {
            "obj" => {
                // `f a/a/a b/b/b c/c/c`.
                let faces = triangles as f64 * (9.0 * digits + 11.0);
                let lines = skeleton(options.is_on("lines"), 35.0 * nodes as f64);
                87.0 * vertices as f64 + faces + lines + (recipe + 500) as f64
            }
            "usda" | "usdz" => {
                let materials = 900 * self.foliage_colors;
                // `3, ` and `a, b, c, `.
                let faces = triangles as f64 * (3.0 * digits + 9.0);
                let curves = skeleton(
                    options.is_on("skeleton") && !options.is_word("flavor", "ar"),
                    49.0 * (nodes + axes) as f64,
                );
                let places = 109.0 * left_out.copies as f64;
                let targets = self.targets(vertices - leaf_vertices.min(vertices), leaf_vertices);
                // Vectors of four and three numbers; the latter with the index of their vertex.
                let moved = USD_WIND * (vertices * self.wind_vectors()) as f64
                    + (USD_TARGET + digits) * targets as f64;
                85.0 * vertices as f64
                    + places
                    + moved
                    + faces
                    + curves
                    + (2 * recipe + 3000 + materials) as f64
            }
            "ply" if ascii => {
                94.0 * vertices as f64 + triangles as f64 * (3.0 * digits + 5.0) + (recipe + 500) as f64
            }
            "ply" => return vertices * 36 + triangles * 13 + recipe + 500,
            "ply-skeleton" if ascii => 50.0 * nodes as f64 + (recipe + 400) as f64,
            "ply-skeleton" => return nodes * 32 + recipe + 400,
            "qsm" => {
                let comments = if options.is_on("comments") { recipe + 150 } else { 0 };
                // Flat trees have fewer digits than round ones.
                let row = 74.0 + 4.0 * mean_digits(nodes);
                row * nodes as f64 + (comments + 150) as f64
            }
            "gltf" | "glb" => {
                let tangent = if pictures > 0 { 16 } else { 0 };
                let index = if u16::try_from(vertices).is_ok() { 2 } else { 4 };
                let tangents = tangent * (vertices - plain_vertices);
                let is_quantized = options.is_on("quantize") && self.wind != Wind::Sway;
                // Texture coordinates stay whole where no picture is seen.
                let plain = if pictures > 0 { plain_vertices } else { vertices };
                let meshes = if options.is_word("compress", "meshopt") {
                    // Measured over the built-in presets.
                    let (vertex, tangent) = if is_quantized { (9.0, 2.6) } else { (21.6, 9.6) };
                    let whole = if is_quantized { 2.5 * plain as f64 } else { 0.0 };
                    let tangents = tangent / 16.0 * tangents as f64;
                    let indices = 2.1 * triangles as f64;
                    (vertex * vertices as f64 + whole + tangents + indices) as u64 + 34 * left_out.copies
                } else {
                    let of_vertices = if is_quantized {
                        vertices * 16 + tangents / 4 + plain * 4
                    } else {
                        vertices * 32 + tangents
                    };
                    of_vertices + triangles * 3 * index + 40 * left_out.copies
                };
                let moved = vertices * self.wind_vectors() * 16
                    + 12 * self.targets(vertices - leaf_vertices.min(vertices), leaf_vertices);
                let is_packed = options.is_word("compress", "meshopt");
                let moved = if is_packed { (moved as f64 * MESHOPT_WIND) as u64 } else { moved };
                let buffer = meshes + moved + pictures;
                let buffer = if options.is_on("embed") { buffer.div_ceil(3) * 4 } else { buffer };
                return buffer + recipe + 1700 + 900 * self.foliage_colors;
            }
            _ => return 0,
        };
        text as u64 + pictures
    }
}

// Of wind: characters of a vector of four numbers, those of a vector of three and its comma, and what
// meshopt leaves of both. Set by estimate; three plants bear them out within 30 % (test).
const USD_WIND: f64 = 38.0;
const USD_TARGET: f64 = 34.0;
const MESHOPT_WIND: f64 = 0.5;

/// Digits of an index, on average over `1..=count`.
fn mean_digits(count: u64) -> f64 {
    let (mut sum, mut power) = (0, 1);
    // Everything from a power of ten on has a digit more.
    while power <= count {
        sum += count - power + 1;
        power = power.saturating_mul(10);
    }
    sum as f64 / count.max(1) as f64
}

/// Both pictures of a bark as PNG, drawn or the user's own.
fn bark_bytes(recipe: &Recipe) -> u64 {
    let look = &recipe.preset.bark;
    match (&look.picture, &look.normal) {
        (None, None) => picture_bytes(look),
        // Normals follow the picture and take about twice as much (2.1 times for a ridged bark).
        (Some(file), None) => 3 * file_bytes(recipe, file),
        (None, Some(file)) => picture_bytes(look) / 2 + file_bytes(recipe, file),
        (Some(picture), Some(normal)) => file_bytes(recipe, picture) + file_bytes(recipe, normal),
    }
}

/// The pictures of a billboard as PNG: two, all planes beside each other in each.
fn billboard_bytes(detail: &DetailLook) -> u64 {
    let side = f64::from(detail.billboard_size_px);
    (f64::from(detail.billboard) * side * side * BILLBOARD_BYTES) as u64
}

/// What stands around the meshes of a further level.
const LEVEL_BYTES: u64 = 1500;

/// For each pixel of a square as high as a plane: both pictures. Between an oak (0.8) and a fir, whose
/// needles say more (1.9).
const BILLBOARD_BYTES: f64 = 1.25;

/// Of a picture of the user's.
fn file_bytes(recipe: &Recipe, file: &str) -> u64 {
    match recipe.input(file).map(|input| &input.geometry) {
        Some(Geometry::Picture(own)) => own.file_bytes,
        _ => 0,
    }
}

/// Both pictures of a bark as PNG.
///
/// Measured at 512 pixels with the usual grain; a pixel of a larger picture says less that its
/// neighbours have not said, and takes 0.73 times as much for each doubling of the side.
fn picture_bytes(look: &BarkLook) -> u64 {
    let (color, normal, relief) = match look.style {
        BarkStyle::Ridged => (0.79, 1.80, 0.045),
        BarkStyle::Smooth => (0.53, 0.54, 0.006),
        BarkStyle::Plated => (0.92, 1.90, 0.035),
        BarkStyle::Birch => (0.73, 1.2, 0.008),
        BarkStyle::Peeling => (0.68, 0.43, 0.012),
    };
    let side = f64::from(look.size_px.max(1));
    let coarseness = libm::pow(side / 512.0, -0.45);
    let grain = 0.84 + 0.16 * libm::sqrt(f64::from(look.grain.clamp(0.0, 3.0)));
    // Without any relief all normals are the same.
    let depth = libm::pow(look.relief.map_or(1.0, |own| f64::from(own) / relief).clamp(0.0, 50.0), 0.15);
    (side * side * coarseness * grain * (color + normal * depth)) as u64
}

/// Both pictures of a kind of leaves as PNG, about: measured at 512 and 1024 pixels over all outlines.
fn leaf_picture_bytes(size_px: u32) -> u64 {
    let side = f64::from(size_px);
    (side * side * libm::pow(side / 1024.0, -0.3)) as u64
}

#[cfg(test)]
mod tests {
    use linden::Quiet;
    use linden::detail::levels;
    use linden::dress::dress;
    use linden::grow::grow;
    use linden::preset::builtins;
    use linden::stage::Stage;
    use rayon::prelude::*;

    use super::*;
    use crate::{Bundle, REGISTRY};

    /// Says what is off by more than 30 %.
    fn off(what: &str, estimated: u64, real: u64) -> Option<String> {
        let ratio = estimated as f64 / real as f64;
        (!(0.7..=1.3).contains(&ratio)).then(|| format!("{what}: {estimated} is {ratio:.2} of {real}"))
    }

    fn within(what: &str, estimated: u64, real: u64) {
        assert_eq!(off(what, estimated, real), None);
    }

    /// Every choice of a switch or word that a format has, one at a time.
    fn all_options(format: &'static Format) -> Vec<Options> {
        let plain = Options::new(format);
        let mut all = vec![plain.clone()];
        for spec in format.options {
            let values: Vec<&str> = match spec.knob.kind {
                linden::knob::Kind::Switch => vec!["false", "true"],
                linden::knob::Kind::Choice(words) => words.to_vec(),
                _ => vec![spec.default],
            };
            let with = |options: &Options, value: &str| {
                let mut options = options.clone();
                options.set(spec.knob.name, value).unwrap();
                options
            };
            let others = values.into_iter().filter(|value| *value != spec.default);
            all.extend(others.map(|value| with(&plain, value)));
        }
        // Without pictures, of which little else would be seen.
        let mut smallest = plain;
        let turned =
            [("pictures", "false"), ("instances", "true"), ("quantize", "true"), ("compress", "meshopt")];
        for (name, value) in turned {
            if format.options.iter().any(|spec| spec.knob.name == name) {
                smallest.set(name, value).unwrap();
                all.push(smallest.clone());
            }
        }
        all
    }

    /// Triangles of a large tree.
    const LARGE: u64 = 30_000;

    /// Writes a tree in all formats, with all options if it is small, and says which estimates are off.
    fn all_off(what: &str, recipe: &Recipe) -> Vec<String> {
        let mut faults = Vec::new();
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("tree.any");
        // What grows in a mesh needs its file.
        let Ok(grown) = grow(recipe, &Quiet) else { return faults };
        let estimate = Estimate::new(recipe, &grown, &Quiet).unwrap();
        let levels = levels(recipe, &grown, &Quiet).unwrap();
        let finest = &levels.levels[0].scene;
        let vertices = finest.parts.iter().map(|part| part.mesh.positions.len() as u64).sum();
        let triangles = finest.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum();
        faults.extend(off(what, estimate.vertices, vertices));
        faults.extend(off(what, estimate.triangles, triangles));
        let is_counted = recipe.preset.detail.finest() == 0
            && recipe.preset.tubes.junction != Junction::Watertight
            && grown.organs.polygons.ends.is_empty();
        if is_counted && (estimate.vertices, estimate.triangles) != (vertices, triangles) {
            faults.push(format!("{what}: {estimate:?} is not {vertices} vertices, {triangles} triangles"));
        }
        for exporter in REGISTRY {
            let format = exporter.format();
            // Of large trees the usual files, for the time that all take.
            let most = if triangles > LARGE { 1 } else { usize::MAX };
            for options in all_options(format).into_iter().take(most) {
                let write = |stage: &Stage<'_>| -> u64 {
                    let mut bundle = Bundle::create(&target).unwrap();
                    exporter.write(stage, &options, &mut bundle, &Quiet).unwrap();
                    bundle.commit().unwrap().iter().map(|file| file.bytes).sum()
                };
                let real = match format.levels() {
                    LooksIn::Files => levels.levels.iter().map(|own| write(&Stage::of(&own.scene))).sum(),
                    _ => write(&levels.stage()),
                };
                // A file of a few pages is mostly what stands around the tree.
                if real > 32_768 {
                    let values: Vec<String> = options.iter().map(|(_, v)| v.to_string()).collect();
                    let what = format!("{what} as {} {}", format.id, values.join(" "));
                    faults.extend(off(&what, estimate.bytes(format, &options), real));
                }
            }
        }
        faults
    }

    #[test]
    fn estimates_are_near_the_real_files() {
        let faults = builtins()
            .par_iter()
            .flat_map_iter(|builtin| all_off(builtin.id, &Recipe::new(builtin.load().unwrap())));
        assert_eq!(faults.collect::<Vec<_>>(), [""; 0]);
    }

    #[test]
    fn budgets_levels_and_wind_are_estimated_too() {
        let cases: [&[(&str, &str)]; 6] = [
            &[("triangles", "12000")],
            &[("lods", "3"), ("triangles", "20000")],
            &[("lods", "2"), ("lod_ratio", "0.6"), ("billboard", "2"), ("triangles", "9000")],
            &[("billboard", "3"), ("billboard_size", "256"), ("triangles", "20000")],
            &[("wind", "attributes"), ("triangles", "15000")],
            &[("wind", "sway"), ("lods", "2"), ("triangles", "20000")],
        ];
        let all = ["oak", "dressed-fir", "box"].into_iter().flat_map(|id| cases.map(|knobs| (id, knobs)));
        let faults = all.collect::<Vec<_>>().into_par_iter().flat_map_iter(|(id, knobs)| {
            let mut preset = linden::preset::builtin(id).unwrap().load().unwrap();
            for (knob, value) in knobs {
                preset.set(knob, value).unwrap();
            }
            all_off(&format!("{id} {knobs:?}"), &Recipe::new(preset))
        });
        assert_eq!(faults.collect::<Vec<_>>(), [""; 0]);
    }

    #[test]
    fn other_surfaces_and_barks_are_estimated_too() {
        for (knob, value) in [
            ("sides", "3"),
            ("sides", "8"),
            ("sides", "96"),
            ("rings", "2"),
            ("rings", "7"),
            ("bark_size", "128"),
            ("bark_size", "1024"),
            ("bark", "smooth"),
            ("bark", "plated"),
            ("bark_grain", "3"),
            ("bark_grain", "0"),
        ] {
            let mut preset = linden::preset::builtin("older-f").unwrap().load().unwrap();
            preset.set(knob, value).unwrap();
            let recipe = Recipe::new(preset);
            let grown = grow(&recipe, &Quiet).unwrap();
            let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
            let scene = dress(&recipe, &grown, &Quiet).unwrap();
            let what = format!("{knob}={value}");
            within(&what, estimate.triangles, scene.parts[0].mesh.triangles.len() as u64);
            within(&what, estimate.vertices, scene.parts[0].mesh.positions.len() as u64);
            let stage = Stage::of(&scene);
            let cast = crate::cast::Cast::of(&stage, &Quiet).unwrap();
            let pictures = crate::picture::pictures(&cast.looks);
            let real: usize = crate::picture::compress(&pictures).unwrap().iter().map(|png| png.len()).sum();
            within(&what, estimate.picture_bytes, real as u64);
        }
    }

    #[test]
    fn bark_of_ones_own_is_estimated_by_its_file() {
        let preset = linden::preset::builtin("older-f").unwrap().load().unwrap();
        let key = linden::random::Key::new(3);
        for style in [BarkStyle::Ridged, BarkStyle::Plated, BarkStyle::Birch] {
            let mut recipe = Recipe::new(preset.clone());
            let photograph = linden::texture::Bark::new(style, key).draw(&Quiet).unwrap().base_color;
            let png = photograph.png().unwrap();
            let input = linden::recipe::Input::read("my.png", png, &Quiet).unwrap();
            assert!(recipe.put_file("bark_picture", "my.png", &input));
            let grown = grow(&recipe, &Quiet).unwrap();
            let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
            let scene = dress(&recipe, &grown, &Quiet).unwrap();
            let stage = Stage::of(&scene);
            let cast = crate::cast::Cast::of(&stage, &Quiet).unwrap();
            let pictures = crate::picture::pictures(&cast.looks);
            let real: usize = crate::picture::compress(&pictures).unwrap().iter().map(|png| png.len()).sum();
            within(&format!("{style:?}"), estimate.picture_bytes, real as u64);
        }
    }

    #[test]
    fn digits_are_counted() {
        for count in [1, 9, 10, 11, 99, 100, 4321] {
            let sum: usize = (1..=count).map(|n: u64| n.to_string().len()).sum();
            assert!((mean_digits(count) - sum as f64 / count as f64).abs() < 1e-12, "{count}");
        }
    }
}
