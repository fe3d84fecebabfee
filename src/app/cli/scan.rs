//! `linden scan`: what a laser scanner would measure on a tree, and what each point lies on.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use linden::grow::Grown;
use linden::knob::printable;
use linden::scanner::sizes::TreeSizes;
use linden::scanner::{self, ScannerError, ScannerSettings, Target, laz, ply};
use linden_exporters::commit_all;

use super::GrowArgs;
use super::outputs::list;
use super::placing::{Placing, as_sole_output, explained, is_dash, is_folder};
use crate::exit::usage;
use crate::progress::Progress;
use crate::source::Source;

/// Sides of the thickest rings that are scanned: with fewer, a mesh holds less wood than the cylinders of its tree.
const SIDES: u32 = 64;

/// Points that are written at once.
const POINTS_PER_PIECE: usize = 1 << 16;

/// Scan a source as a laser scanner would
///
/// Grows the tree, sets up a scanner at several places around it and sends pulses at its wood; what stands behind
/// something is not seen. The file is a binary PLY, Y up, or a LAZ, Z up, in metres: of each point the place as measured, and in truth the
/// tree, the part (0 ground, 1 wood, 2 leaf), the axis and its order, the stand and the echo. 'linden export scan.ply -o
/// back.glb' grows a tree into it.
///
/// The wood is scanned with 64 sides, neither tapering twigs nor smoothed widths, so that it is what its cylinders are
/// ('linden export SOURCE -o truth.csv' has them), unless --set turns these.
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

    /// Stands, evenly round the tree: 1 to 64
    #[arg(long, value_name = "N", default_value_t = ScannerSettings::default().positions)]
    positions: u32,

    /// From the tree to each stand, in heights of the tree: 0.1 to 20
    #[arg(long, value_name = "X", default_value_t = ScannerSettings::default().distance, allow_negative_numbers = true)]
    distance: f64,

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

    /// Level ground around the foot
    #[arg(long)]
    ground: bool,

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
        let source = self.growing.resolve_with(&pairs, &progress)?;
        let output = if is_folder(&self.output) {
            self.output.join(format!("{}-scan.ply", linden_exporters::plain_stem(&source.recipe.preset.id)))
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
        let mut points_file = self.placing.bundle(&output).map_err(explained)?;
        let mut truth_file =
            self.truth.as_deref().map(|path| self.placing.bundle(path)).transpose().map_err(explained)?;
        let grown = super::grown(&source, &progress)?;
        let scan = self.scanned(&source, &grown, &pairs, &settings, &progress)?;
        progress.clear();
        let comment = self.comment(&source);
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
            let text = truth_table(&source, &grown);
            let done =
                file.write_main(Some(text.len() as u64), &progress, |sink| sink.write(text.as_bytes()));
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
        settings.distance = self.distance;
        settings.height_m = self.height;
        settings.step_deg = self.step;
        settings.noise_m = 1e-3 * self.noise;
        settings.beam_rad = 1e-3 * self.beam;
        settings.registration_m = 1e-3 * self.registration;
        settings.ground = self.ground;
        settings.seed = self.drawn_from;
        settings
    }

    fn scanned(
        &self,
        source: &Source,
        grown: &Grown,
        pairs: &[(String, String)],
        settings: &ScannerSettings,
        progress: &Progress,
    ) -> anyhow::Result<scanner::Scan> {
        let is_turned = |knob: &str| pairs.iter().any(|(name, _)| name == knob);
        let mut tubes = source.recipe.preset.dressing.tubes;
        if !is_turned("sides") {
            tubes.sides = SIDES;
        }
        if !is_turned("twig_taper") {
            tubes.features.twig_taper = 0.0;
        }
        if !is_turned("width_smoothing") {
            tubes.width_smoothing = 0.0;
        }
        if self.leaves && grown.organs.is_empty() {
            super::notes(&[format!("{} has no leaves to scan", source.shown)], progress);
        }
        let mut target = Target::default();
        target.add(grown, &tubes, self.leaves, progress).with_context(|| source.shown.clone())?;
        scanner::scan(&target, settings, progress).with_context(|| source.shown.clone())
    }

    /// What the file says of itself.
    fn comment(&self, source: &Source) -> String {
        let Self { positions, distance, step, noise, beam, registration, drawn_from, .. } = self;
        format!(
            "linden scan {} seed {}: positions {positions}, distance {distance}, step {step} deg, noise {noise} mm, beam {beam} mrad, registration {registration} mm, scan-seed {drawn_from}",
            printable(&source.recipe.preset.id),
            source.recipe.preset.seed()
        )
    }
}

/// A row for each tree.
fn truth_table(source: &Source, grown: &Grown) -> String {
    // Ids of presets are words; what is not cannot be quoted wrongly either.
    let id: String =
        source.recipe.preset.id.chars().filter(|c| !matches!(c, ',' | '"' | '\n' | '\r')).collect();
    let seed = source.recipe.preset.seed();
    let sizes = TreeSizes::of(&grown.skeleton);
    format!("tree,source,seed,{}\n1,{id},{seed},{}\n", TreeSizes::header(), sizes.row())
}
