//! How large files will be, from the skeleton alone: told before anything is dressed or written.
//!
//! Counts follow from how the surface is swept (a ring per node, with as many sides as its radius
//! deserves); bytes follow from counts and from what each format was measured to need. A test holds
//! the sum for every built-in preset and format within 30 % of the real files.

use std::collections::BTreeSet;
use std::f32::consts::PI;

use linden::foliage::{Organs, PROTOTYPES};
use linden::grow::Grown;
use linden::monitor::{Cancelled, Monitor};
use linden::preset::{BarkLook, Preset};
use linden::recipe::Recipe;
use linden::skeleton::NO_PARENT;
use linden::texture::BarkStyle;
use linden::wind::Wind;

use crate::{Format, Options};

/// What an export of a tree will amount to, about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Estimate {
    /// Vertices of the surface.
    pub vertices: u64,
    /// Triangles of the surface.
    pub triangles: u64,
    /// Vertices of what has no pictures.
    plain_vertices: u64,
    /// What instances leave out and put in its place.
    instanced: Instanced,
    /// Materials of the foliage.
    foliage_colors: u64,
    nodes: u64,
    axes: u64,
    /// The recipe's line.
    recipe_bytes: u64,
    /// All pictures as PNG.
    picture_bytes: u64,
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
    fn of(organs: &Organs) -> Self {
        let mut own = Self::default();
        let mut seen = BTreeSet::new();
        for (organ, &prototype) in organs.placed.prototypes.iter().enumerate() {
            own.copies += 1;
            // The first of each is what the others are copies of.
            if !seen.insert(prototype) {
                let mesh = organs.mesh(organ);
                let vertices = mesh.positions.len() as u64;
                own.vertices += vertices;
                own.triangles += mesh.triangles.len() as u64;
                own.plain_vertices += if usize::from(prototype) < PROTOTYPES.len() { vertices } else { 0 };
            }
        }
        own
    }
}

/// Axes between two looks at the monitor.
const AXES_PER_CHECK: usize = 4096;

impl Estimate {
    /// Counts what the surface and the foliage of a tree will have. Takes about 10 ns a node.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn new(recipe: &Recipe, grown: &Grown, monitor: &dyn Monitor) -> Result<Self, Cancelled> {
        let Preset { tubes, bark, foliage, .. } = &recipe.preset;
        let skeleton = &grown.skeleton;
        let thickest_m = skeleton.radii.iter().copied().fold(0.0, f32::max);
        let sides = Sides::new(tubes.sides, thickest_m);
        let (mut vertices, mut triangles) = (0, 0);
        for axes in skeleton.axes.chunks(AXES_PER_CHECK) {
            monitor.check()?;
            for axis in axes {
                let own = skeleton.nodes_of(axis);
                let (Some(&base), Some(&tip)) = (own.first(), own.last()) else { continue };
                let of = |node: u32| sides.of(skeleton.radii[node as usize]);
                let (base, tip) = (of(base), of(tip));
                // A lateral has a ring in its parent, as thick as its first own one.
                let foot = if axis.parent == NO_PARENT { 0 } else { base };
                let mut rings = own.len() as u64 + u64::from(foot > 0);
                let mut around = own.iter().map(|&node| of(node)).sum::<u64>() + foot;
                if tubes.rings > 1 {
                    let extra = u64::from(tubes.rings - 1);
                    around += foot * extra + between(own, tubes.rings, &skeleton.radii, &sides);
                    rings += (rings - 1) * extra;
                }
                if foot > 0 && tubes.has_collars() {
                    let [root, first] = [axis.parent, own[0]].map(|node| skeleton.radii[node as usize]);
                    let wider = sides.of(first + 0.5 * tubes.collar_m(root, first));
                    let more = wider.clamp(4, 14) + 1;
                    around += more * wider;
                    rings += more;
                }
                // Each ring has a seam; the tip and the base have vertices of their own.
                vertices += around + rings + base + tip;
                // Two triangles a side, one at the two ends; then the tip's and the base's.
                triangles += (2 * around).saturating_sub(if foot > 0 { foot } else { base } + tip);
                triangles += base.saturating_sub(2) + tip;
            }
        }
        let (foliage_vertices, foliage_triangles) = grown.organs.amount();
        let last = foliage.turtle_colors().len().saturating_sub(1) as u64;
        let organs = &grown.organs;
        let is_still = recipe.preset.wind.wind == Wind::Off;
        let own = (0..organs.len()).filter(|&i| organs.color(i).is_none());
        let colors: BTreeSet<u64> = own.map(|i| last.min(organs.growth(i).color.into())).collect();
        let kinds: BTreeSet<u8> = organs.shapes.iter().map(|shape| shape.kind).collect();
        Ok(Self {
            vertices: vertices + foliage_vertices,
            triangles: triangles + foliage_triangles,
            plain_vertices: grown.organs.plain_amount().0,
            // What moves in the wind is written one by one.
            instanced: if is_still { Instanced::of(organs) } else { Instanced::default() },
            foliage_colors: (colors.len() + kinds.len()) as u64,
            nodes: skeleton.positions.len() as u64,
            axes: skeleton.axes.len() as u64,
            recipe_bytes: recipe.to_line().len() as u64,
            picture_bytes: picture_bytes(bark) + kinds.len() as u64 * leaf_picture_bytes(foliage.size_px),
        })
    }

    /// Triangles that a format's files hold: none where it holds the skeleton alone.
    pub fn triangles_of(&self, format: &Format) -> u64 {
        if matches!(format.id, "ply-skeleton" | "qsm") { 0 } else { self.triangles }
    }

    /// Bytes of all files of a format with these options. 0 for a format that nobody measured.
    ///
    /// Text was measured over the built-in presets, in bytes a vertex or node without indices:
    /// those follow from the number of digits.
    pub fn bytes(&self, format: &Format, options: &Options) -> u64 {
        let Self { nodes, axes, recipe_bytes: recipe, .. } = *self;
        let is_instanced = options.is_on("instances") && !options.is_word("flavor", "ar");
        let left_out = if is_instanced { self.instanced } else { Instanced::default() };
        let (vertices, triangles) = (self.vertices - left_out.vertices, self.triangles - left_out.triangles);
        let plain_vertices = self.plain_vertices - left_out.plain_vertices;
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
                85.0 * vertices as f64 + places + faces + curves + (2 * recipe + 3000 + materials) as f64
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
                let is_quantized = options.is_on("quantize");
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
                let buffer = meshes + pictures;
                let buffer = if options.is_on("embed") { buffer.div_ceil(3) * 4 } else { buffer };
                return buffer + recipe + 1700 + 900 * self.foliage_colors;
            }
            _ => return 0,
        };
        text as u64 + pictures
    }
}

/// The sides of all rings between an axis' nodes.
fn between(own: &[u32], rings: u32, radii: &[f32], sides: &Sides) -> u64 {
    let of = |pair: &[u32], k: u32| {
        let [from, to] = [pair[0], pair[1]].map(|node| radii[node as usize]);
        sides.of(from + (to - from) * (k as f32 / rings as f32))
    };
    own.windows(2).flat_map(|pair| (1..rings).map(move |k| of(pair, k))).sum()
}

/// How many sides rings get, as the surface decides it: as far from a circle as the thickest, in
/// metres, and then rounded up to a few counts.
struct Sides {
    /// The thickest wood that 3, 4, 5, … sides do for, metres.
    largest_radius_m: Vec<f32>,
}

impl Sides {
    fn new(most: u32, thickest_m: f32) -> Self {
        let sagitta = |sides: u32| 1.0 - libm::cosf(PI / sides as f32);
        let largest = |n| thickest_m * sagitta(most) / sagitta(n);
        Self { largest_radius_m: (3..most).map(largest).collect() }
    }

    fn of(&self, radius_m: f32) -> u64 {
        let enough = 3 + self.largest_radius_m.partition_point(|&largest| largest < radius_m) as u64;
        let most = 3 + self.largest_radius_m.len() as u64;
        // Rounding up starts at seven and takes an eighth on average.
        if enough > 6 { (enough + enough / 8).min(most) } else { enough }
    }
}

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
    use linden::dress::dress;
    use linden::grow::grow;
    use linden::preset::builtins;
    use linden::stage::Stage;

    use super::*;
    use crate::{Bundle, REGISTRY};

    fn within(what: &str, estimated: u64, real: u64) {
        let ratio = estimated as f64 / real as f64;
        assert!((0.7..=1.3).contains(&ratio), "{what}: {estimated} is {ratio:.2} of {real}");
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
    const LARGE: u64 = 100_000;

    #[test]
    fn estimates_are_near_the_real_files() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("tree.any");
        for builtin in builtins() {
            let recipe = Recipe { preset: builtin.load().unwrap(), inputs: Vec::new() };
            // What grows in a mesh needs its file.
            let Ok(grown) = grow(&recipe, &Quiet) else { continue };
            let estimate = Estimate::new(&recipe, &grown, &Quiet).unwrap();
            let scene = dress(&recipe, &grown, &Quiet).unwrap();
            let vertices = scene.parts.iter().map(|part| part.mesh.positions.len() as u64).sum();
            let triangles: u64 = scene.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum();
            within(builtin.id, estimate.vertices, vertices);
            within(builtin.id, estimate.triangles, triangles);
            for exporter in REGISTRY {
                let format = exporter.format();
                // Of large trees the usual files, for the time that all take.
                let most = if triangles > LARGE { 1 } else { usize::MAX };
                for options in all_options(format).into_iter().take(most) {
                    let mut bundle = Bundle::create(&target).unwrap();
                    exporter.write(&Stage::of(&scene), &options, &mut bundle, &Quiet).unwrap();
                    let real = bundle.commit().unwrap().iter().map(|file| file.bytes).sum();
                    // A file of a few pages is mostly what stands around the tree.
                    if real > 32_768 {
                        let values: Vec<String> = options.iter().map(|(_, v)| v.to_string()).collect();
                        let what = format!("{} as {} {}", builtin.id, format.id, values.join(" "));
                        within(&what, estimate.bytes(format, &options), real);
                    }
                }
            }
        }
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
            let recipe = Recipe { preset, inputs: Vec::new() };
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
    fn digits_are_counted() {
        for count in [1, 9, 10, 11, 99, 100, 4321] {
            let sum: usize = (1..=count).map(|n: u64| n.to_string().len()).sum();
            assert!((mean_digits(count) - sum as f64 / count as f64).abs() < 1e-12, "{count}");
        }
    }
}
