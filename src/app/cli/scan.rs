//! `linden scan`: what a laser scanner would measure on a tree or in a forest, and what each point lies on.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use linden::grow::grow;
use linden::knob::printable;
use linden::preset::Preset;
use linden::scanner::sizes::TreeSizes;
use linden::scanner::{self, ScannerError, ScannerSettings, Target, laz, ply};
use linden::surface::Tubes;
use linden::{Skeleton, Vec3};
use linden_exporters::commit_all;

use super::GrowArgs;
use super::outputs::list;
use super::placing::{Placing, as_sole_output, explained, is_dash, is_folder};
use crate::exit::usage;
use crate::progress::Progress;
use crate::source::Source;
use crate::source::forest::{ForestFile, ForestSource, turn};

/// Sides of the thickest rings that are scanned: with fewer, a mesh holds less wood than the cylinders of its tree.
const SIDES: u32 = 64;

/// The same of each tree of a forest, which is as large as many.
const SIDES_IN_A_FOREST: u32 = 16;

/// Points that are written at once.
const POINTS_PER_PIECE: usize = 1 << 16;

/// Scan a tree or a forest as a laser scanner would
///
/// Grows it, sets up a scanner at several places around it and sends pulses at its wood; what stands behind
/// something is not seen. The file is a binary PLY, Y up, or a LAZ, Z up, in metres: of each point the place as measured, and in truth the
/// tree, the part (0 ground, 1 wood, 2 leaf), the axis and its order, the stand and the echo. 'linden export scan.ply -o
/// back.glb' grows a tree into it.
///
/// The wood is scanned with 64 sides, neither tapering twigs nor smoothed widths, so that it is what its cylinders are
/// ('linden export SOURCE -o truth.csv' has them), unless --set turns these.
///
/// A forest (its id or document) is scanned from stands among its trees, with 16 sides; its points say which tree they
/// lie on. 'linden export scan.laz -o trees/' grows each.
#[derive(Args)]
pub struct Scan {
    #[command(flatten)]
    growing: GrowArgs,

    /// Write the points to this file, .ply or .laz, or as PLY into this directory; - is standard output
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Write the true height, diameter at breast height, length and volume of the tree, also by classes of diameter, to
    /// this CSV file
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,

    /// Stands, evenly round the tree or spread among the trees of a forest: 1 to 64
    #[arg(long, value_name = "N", default_value_t = ScannerSettings::default().positions)]
    positions: u32,

    /// From the tree to each stand, in heights of the tree: 0.1 to 20; 0.8 when not given. Not for several trees
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    distance: Option<f64>,

    /// Of the instrument above the foot of the tree, metres
    #[arg(long, value_name = "M", default_value_t = ScannerSettings::default().height_m, allow_negative_numbers = true)]
    height: f64,

    /// Between neighbouring pulses, degrees: 0.001 to 10
    #[arg(long, value_name = "DEG", default_value_t = ScannerSettings::default().step_deg, allow_negative_numbers = true)]
    step: f64,

    /// Standard deviation of a range, millimetres
    #[arg(long, value_name = "MM", default_value_t = 1e3 * ScannerSettings::default().noise_m, allow_negative_numbers = true)]
    noise: f64,

    /// How far the beam opens, milliradians: what it meets within 0.3 m is measured as one mean point. 0: rays
    /// without width, and every point lies on a surface
    #[arg(long, value_name = "MRAD", default_value_t = 1e3 * ScannerSettings::default().beam_rad, allow_negative_numbers = true)]
    beam: f64,

    /// Standard deviation of a stand's place as it was registered, along each axis, millimetres; stands are turned in
    /// proportion, by 0.02° for 3 mm
    #[arg(long, value_name = "MM", default_value_t = 1e3 * ScannerSettings::default().registration_m, allow_negative_numbers = true)]
    registration: f64,

    /// Scan leaves, blossom and fruit too
    #[arg(long)]
    leaves: bool,

    /// Scan the ground too
    #[arg(long)]
    ground: bool,

    /// The ground, and what stands on it, rises along x by so many degrees: -60 to 60
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_negative_numbers = true)]
    slope: f64,

    /// The root of the scanner's random choices; the tree's is --seed
    #[arg(long = "scan-seed", value_name = "N", default_value_t = ScannerSettings::default().seed)]
    drawn_from: u64,

    #[command(flatten)]
    placing: Placing,
}

impl Scan {
    pub fn run(self) -> anyhow::Result<()> {
        let progress = Progress::new();
        let settings = self.settings();
        settings.check().map_err(|problem| match problem {
            ScannerError::Setting { name, value, expected } => {
                usage(format!("--{name} {value}: expected {expected}"))
            }
            other => other.into(),
        })?;
        let pairs = self.growing.pairs()?;
        let subject = self.subject(&pairs, &progress)?;
        let output = if is_folder(&self.output) {
            self.output.join(format!("{}-scan.ply", linden_exporters::plain_stem(subject.id())))
        } else {
            self.output.clone()
        };
        let has_ending = |ending: &str| output.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
        let is_laz = has_ending("laz");
        if !is_dash(&output) && !is_laz && !has_ending("ply") {
            let shown = crate::paths::show(&output);
            return Err(usage(format!("-o {shown}: scans are written as PLY or LAZ; name it like scan.ply")));
        }
        if self.truth.as_deref().is_some_and(|truth| is_dash(truth) && is_dash(&output)) {
            return Err(usage(
                "only one of -o and --truth can be standard output: name a file for the other",
            ));
        }
        // All places are tried before anything grows.
        let targets = std::iter::once(&output).chain(&self.truth).map(PathBuf::as_path);
        let folders = self.placing.folders(targets)?;
        let bundle = |path: &Path| self.placing.bundle_beside(path, subject.files()).map_err(explained);
        let mut points_file = bundle(&output)?;
        let mut truth_file = self.truth.as_deref().map(bundle).transpose()?;
        let (target, truth) = self.target(&subject, &pairs, &progress)?;
        let scan = scanner::scan(&target, &settings, &progress).with_context(|| subject.shown())?;
        drop(target);
        progress.clear();
        let comment = self.comment(&subject, &settings);
        let packed = is_laz.then(|| laz::file(&scan, &comment, &progress)).transpose()?;
        let header = ply::header(&scan, &comment);
        let bytes = packed.as_ref().map_or(header.len() + scan.points.len() * ply::ROW, Vec::len);
        let done = points_file.write_main(Some(bytes as u64), &progress, |sink| {
            if let Some(packed) = &packed {
                return sink.write(packed);
            }
            sink.write(header.as_bytes())?;
            (0..scan.points.len()).step_by(POINTS_PER_PIECE).try_for_each(|first| {
                let end = scan.points.len().min(first + POINTS_PER_PIECE);
                sink.write(&ply::rows(&scan, first..end))
            })
        });
        done.map_err(if is_dash(&output) { as_sole_output } else { explained })?;
        if let Some(file) = &mut truth_file {
            let done =
                file.write_main(Some(truth.len() as u64), &progress, |sink| sink.write(truth.as_bytes()));
            done.map_err(if self.truth.as_deref().is_some_and(is_dash) {
                as_sole_output
            } else {
                explained
            })?;
        }
        let written =
            commit_all(std::iter::once(points_file).chain(truth_file).collect()).map_err(explained)?;
        folders.into_iter().for_each(linden_exporters::MadeFolders::keep);
        progress.clear();
        let (points, stands) = (indicatif::HumanCount(scan.points.len() as u64), scan.stands.len());
        let s = if stands == 1 { "" } else { "s" };
        let pulses = indicatif::HumanCount(scan.pulses);
        super::notes(&[format!("{points} points of {pulses} pulses from {stands} stand{s}")], &progress);
        if is_dash(&output) || self.truth.as_deref().is_some_and(is_dash) {
            return Ok(());
        }
        list(&written)
    }

    fn settings(&self) -> ScannerSettings {
        let mut settings = ScannerSettings::default();
        settings.positions = self.positions;
        settings.distance = self.distance.unwrap_or(settings.distance);
        settings.height_m = self.height;
        settings.step_deg = self.step;
        settings.noise_m = 1e-3 * self.noise;
        settings.beam_rad = 1e-3 * self.beam;
        settings.registration_m = 1e-3 * self.registration;
        settings.ground = self.ground;
        settings.slope_deg = self.slope;
        settings.seed = self.drawn_from;
        settings
    }

    /// The tree or the forest, its knobs turned.
    fn subject(&self, pairs: &[(String, String)], progress: &Progress) -> anyhow::Result<Subject> {
        let named = self.growing.source.to_str();
        let Some(file) = named.map(|named| ForestFile::find(named, progress)).transpose()?.flatten() else {
            return Ok(Subject::Tree(Box::new(self.growing.resolve_with(pairs, progress)?)));
        };
        let shown = file.shown();
        let instead = "turn it in the forest's document";
        self.growing.without_defines(instead)?;
        self.growing.without_edits(instead)?;
        self.growing.without_age(instead)?;
        if self.distance.is_some() {
            return Err(usage(format!(
                "--distance is for one tree: the stands of {shown} are spread among its trees; --positions says how many"
            )));
        }
        let mut source = super::forest::resolved(file, progress)?;
        for (name, value) in pairs {
            turn(&mut source.forest, name, value)?;
        }
        Ok(Subject::Forest(Box::new(source)))
    }

    /// What is scanned, and the table of what it truly is.
    fn target(
        &self,
        subject: &Subject,
        pairs: &[(String, String)],
        progress: &Progress,
    ) -> anyhow::Result<(Target, String)> {
        let mut target = Target::default();
        let mut truth = format!("tree,source,seed,foot_x_m,foot_y_m,foot_z_m,{}\n", TreeSizes::header());
        match subject {
            Subject::Tree(source) => {
                let grown = super::grown(source, progress)?;
                if self.leaves && grown.organs.is_empty() {
                    super::notes(&[format!("{} has no leaves to scan", source.shown)], progress);
                }
                let tubes = tubes(pairs, &source.recipe.preset, SIDES);
                target.add(&grown, &tubes, self.leaves, progress).with_context(|| source.shown.clone())?;
                let trees = target.feet().len();
                if trees > 1 && self.distance.is_some() {
                    return Err(usage(format!(
                        "--distance is for one tree: {} has {trees}, among which the stands are spread; --positions says how many",
                        source.shown
                    )));
                }
                truth += &truth_rows(target.feet(), 0, &source.recipe.preset, &grown.skeleton, 1.0);
            }
            Subject::Forest(source) => {
                let forest = &source.forest;
                let plan = forest.plan(progress).with_context(|| forest.id.clone())?;
                let mut grown = Vec::new();
                for tree in &plan.trees {
                    let one = grow(&tree.recipe, progress).with_context(|| tree.name.clone())?;
                    let about: Vec<String> =
                        one.notes.iter().map(|note| format!("{}: {note}", tree.name)).collect();
                    super::notes(&about, progress);
                    grown.push(one);
                }
                let settings = self.settings();
                for place in &plan.places {
                    let (preset, one) = (&plan.trees[place.plant].recipe.preset, &grown[place.plant]);
                    let tubes = tubes(pairs, preset, SIDES_IN_A_FOREST);
                    let before = target.feet().len();
                    target
                        .add_at(&settings.on_slope(*place), one, &tubes, self.leaves, progress)
                        .with_context(|| plan.trees[place.plant].name.clone())?;
                    truth += &truth_rows(target.feet(), before, preset, &one.skeleton, place.scale);
                }
            }
        }
        Ok((target, truth))
    }

    /// What the file says of itself.
    fn comment(&self, subject: &Subject, settings: &ScannerSettings) -> String {
        let Self { positions, step, noise, beam, registration, drawn_from, slope, .. } = self;
        let (id, seed) = (printable(subject.id()), subject.seed());
        let distance = match subject {
            Subject::Tree(_) => format!(" distance {},", settings.distance),
            Subject::Forest(_) => String::new(),
        };
        let slope = if *slope == 0.0 { String::new() } else { format!(" slope {slope} deg,") };
        format!(
            "linden scan {id} seed {seed}: positions {positions},{distance}{slope} step {step} deg, noise {noise} mm, beam {beam} mrad, registration {registration} mm, scan-seed {drawn_from}"
        )
    }
}

/// What is scanned.
enum Subject {
    Tree(Box<Source>),
    Forest(Box<ForestSource>),
}

impl Subject {
    /// The files that it was read from.
    fn files(&self) -> &[PathBuf] {
        match self {
            Self::Tree(source) => &source.files,
            Self::Forest(source) => &source.files,
        }
    }

    fn id(&self) -> &str {
        match self {
            Self::Tree(source) => &source.recipe.preset.id,
            Self::Forest(source) => &source.forest.id,
        }
    }

    fn seed(&self) -> u64 {
        match self {
            Self::Tree(source) => source.recipe.preset.seed(),
            Self::Forest(source) => source.forest.layout.seed,
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::Tree(source) => source.shown.clone(),
            Self::Forest(source) => source.forest.id.clone(),
        }
    }
}

/// The surface of wood that is what its cylinders are, but for the knobs that were turned.
fn tubes(turned: &[(String, String)], preset: &Preset, sides: u32) -> Tubes {
    let is_turned = |knob: &str| turned.iter().any(|(name, _)| name == knob);
    let mut tubes = preset.dressing.tubes;
    if !is_turned("sides") {
        tubes.sides = sides;
    }
    if !is_turned("twig_taper") {
        tubes.features.twig_taper = 0.0;
    }
    if !is_turned("width_smoothing") {
        tubes.width_smoothing = 0.0;
    }
    tubes
}

/// The rows of a plant's trees, which came behind so many others. `feet` are those of all.
fn truth_rows(feet: &[Vec3], before: usize, preset: &Preset, skeleton: &Skeleton, scale: f32) -> String {
    // Ids of presets are words; what is not cannot be quoted wrongly either.
    let id: String = preset.id.chars().filter(|c| !matches!(c, ',' | '"' | '\n' | '\r')).collect();
    let mut rows = String::new();
    let trees = feet.iter().enumerate().skip(before).zip(TreeSizes::of_trees(skeleton, scale));
    for ((index, foot), sizes) in trees {
        let place = format!("{:.4},{:.4},{:.4}", foot.x, foot.y, foot.z);
        rows += &format!("{},{id},{},{place},{}\n", index + 1, preset.seed(), sizes.row());
    }
    rows
}
