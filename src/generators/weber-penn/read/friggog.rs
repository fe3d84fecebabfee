//! tree-gen by friggog: a Python module of a docstring and `params = {…}`.

use linden_base::document::Fault;

use super::draft::{Draft, Said};
use super::literal::{Datum, Literal, assigned, read as read_literal};
use super::{ParameterFile, ParameterLook, Program};
use crate::{CrownShape, WeberPenn};

/// Names of tree-gen and the paper's: of a tree.
const OF_TREES: [(&str, &str); 17] = [
    ("shape", "Shape"),
    ("levels", "Levels"),
    ("g_scale", "Scale"),
    ("g_scale_v", "ScaleV"),
    ("ratio", "Ratio"),
    ("ratio_power", "RatioPower"),
    ("flare", "Flare"),
    ("base_splits", "0BaseSplits"),
    ("leaf_blos_num", "Leaves"),
    ("leaf_scale", "LeafScale"),
    ("leaf_scale_x", "LeafScaleX"),
    ("leaf_bend", "LeafBend"),
    ("prune_ratio", "PruneRatio"),
    ("prune_width", "PruneWidth"),
    ("prune_width_peak", "PruneWidthPeak"),
    ("prune_power_low", "PrunePowerLow"),
    ("prune_power_high", "PrunePowerHigh"),
];

/// Of levels.
const OF_LEVELS: [(&str, &str); 15] = [
    ("down_angle", "DownAngle"),
    ("down_angle_v", "DownAngleV"),
    ("rotate", "Rotate"),
    ("rotate_v", "RotateV"),
    ("branches", "Branches"),
    ("length", "Length"),
    ("length_v", "LengthV"),
    ("taper", "Taper"),
    ("seg_splits", "SegSplits"),
    ("split_angle", "SplitAngle"),
    ("split_angle_v", "SplitAngleV"),
    ("curve_res", "CurveRes"),
    ("curve", "Curve"),
    ("curve_back", "CurveBack"),
    ("curve_v", "CurveV"),
];

/// Outlines by the numbers of its leaf shapes.
const LEAF_SHAPES: [&str; 11] = [
    "elliptic",
    "ovate",
    "linear",
    "cordate",
    "palmate",
    "palmate",
    "lobed",
    "lobed",
    "elliptic",
    "orbicular",
    "deltoid",
];

/// What the parameters are that a file leaves out: an aspen, as tree-gen has it.
fn defaults() -> Draft {
    let settings = WeberPenn {
        shape: CrownShape::TendFlame,
        scale_m: 13.0,
        scale_spread_m: 3.0,
        ratio: 0.015,
        ratio_power: 1.2,
        base_size: 0.3,
        down_angle_deg: vec![0.0, 60.0, 45.0, 45.0],
        down_angle_spread_deg: vec![0.0, -50.0, 10.0, 10.0],
        rotate_deg: vec![0.0, 140.0, 140.0, 77.0],
        branches: vec![1.0, 50.0, 30.0, 10.0],
        length: vec![1.0, 0.3, 0.6, 0.0],
        split_angle_deg: vec![40.0, 0.0, 0.0, 0.0],
        split_angle_spread_deg: vec![5.0, 0.0, 0.0, 0.0],
        curve_res: vec![5.0, 5.0, 3.0, 1.0],
        curve_deg: vec![0.0, -40.0, -40.0, 0.0],
        curve_spread_deg: vec![20.0, 50.0, 75.0, 0.0],
        leaves: 25.0,
        leaf_scale_m: 0.17,
        leaf_bend: 0.0,
        attraction_up: 0.5,
        ..WeberPenn::default()
    };
    Draft::new(settings, ParameterLook { flare: 0.6, leaf_width: 1.0, ..ParameterLook::default() })
}

pub(super) fn read(text: &str) -> Result<ParameterFile, Fault> {
    let start = assigned(text).ok_or_else(|| Fault::new(None, "there is no params = {…}"))?;
    let (literal, end) = read_literal(text, start)?;
    let Datum::Dict(entries) = &literal.datum else {
        return Err(Fault::new(literal.place, "expected a dict of parameters"));
    };
    let mut draft = defaults();
    if end < text.len() {
        draft.notes.push("what stands behind the dict is left out".to_owned());
    }
    for (key, place, value) in entries {
        take(&mut draft, &Said { name: key, place: *place }, value)?;
    }
    Ok(draft.finish(Program::TreeGen, species(text), None))
}

/// The first docstring, as a name.
fn species(text: &str) -> Option<String> {
    let text = text.trim_start();
    let quote = ["\"\"\"", "'''"].into_iter().find(|quote| text.starts_with(quote))?;
    let name = text[quote.len()..].split(quote).next()?.trim();
    (!name.is_empty() && name.len() < 80 && !name.contains('\n')).then(|| name.to_lowercase())
}

fn take(draft: &mut Draft, said: &Said<'_>, value: &Literal) -> Result<(), Fault> {
    let number = || value.number().ok_or_else(|| said.fault("expected a number"));
    let numbers =
        || value.numbers().ok_or_else(|| said.fault("expected a list of numbers, one for each level"));
    let is_plain = |list: &[f64], plain: f64| list.iter().all(|&x| x == plain);
    match said.name {
        "base_size" => {
            let list = numbers()?;
            draft.tree("BaseSize", list.first().copied().unwrap_or(0.25), said)?;
            // 0.02 is what all files of the program have.
            if list.iter().skip(1).any(|&share| share > 0.02) {
                draft.notes.push(said.note("leaves the feet of branches bare, too; only the trunk's is"));
            }
        }
        "radius_mod" => {
            let list = numbers()?;
            draft.tree("0Scale", list.first().copied().unwrap_or(1.0), said)?;
            if !is_plain(list.get(1..).unwrap_or_default(), 1.0) {
                draft
                    .notes
                    .push(said.note("is of the trunk alone; the factors of its branches are left out"));
            }
        }
        "tropism" => {
            let list = numbers()?;
            draft.tree("AttractionUp", list.get(2).copied().unwrap_or(0.0), said)?;
            if list.iter().take(2).any(|&x| x != 0.0) {
                draft
                    .notes
                    .push(said.note("draws to a side, too; only its third number is taken, up or down"));
            }
        }
        "branch_dist" => {
            let list = numbers()?;
            if list.iter().any(|&x| x.abs() >= 1.0) {
                draft.notes.push(
                    said.note("sets opposite branches or whorls, which linden does not; they are spread"),
                );
            }
        }
        "bend_v" => {
            if !is_plain(&numbers()?, 0.0) {
                draft
                    .notes
                    .push(said.note("bends stems sideways, which the paper does not, and is left out"));
            }
        }
        "leaf_shape" => {
            let shape = number()?.abs() as usize;
            draft.look.leaf_outline = LEAF_SHAPES.get(shape).copied().unwrap_or("elliptic");
        }
        "blossom_shape" | "blossom_scale" | "blossom_rate" => {
            if number()? != 0.0 {
                draft
                    .notes
                    .push(said.note("is of blossoms and left out: a further kind of foliage draws them"));
            }
        }
        "floor_splits" => {
            draft.level("Branches", 0, number()?.abs() + 1.0, said)?;
        }
        name => {
            if let Some((_, name)) = OF_TREES.iter().find(|(known, _)| *known == name) {
                draft.tree(name, number()?, said)?;
            } else if let Some((_, name)) = OF_LEVELS.iter().find(|(known, _)| *known == name) {
                for (level, item) in numbers()?.into_iter().enumerate() {
                    // Minus zero is what the program writes where there is nothing.
                    draft.level(name, level, if item == 0.0 { 0.0 } else { item }, said)?;
                }
            } else {
                let known = OF_TREES.iter().chain(&OF_LEVELS).map(|(name, _)| *name).collect::<Vec<_>>();
                draft.unknown(said, &known);
            }
        }
    }
    Ok(())
}
