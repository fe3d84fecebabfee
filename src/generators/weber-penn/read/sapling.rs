//! Sapling: one Python dict on one line, as Blender saves it.

use linden_base::document::Fault;

use super::draft::{Draft, Said};
use super::literal::{Datum, Literal, read as read_literal};
use super::{ParameterFile, ParameterLook, Program};
use crate::WeberPenn;

/// Names of Sapling and the paper's: of a tree.
const OF_TREES: [(&str, &str); 21] = [
    ("shape", "Shape"),
    ("baseSize", "BaseSize"),
    ("levels", "Levels"),
    ("scale", "Scale"),
    ("scaleV", "ScaleV"),
    ("ratio", "Ratio"),
    ("ratioPower", "RatioPower"),
    ("rootFlare", "Flare"),
    ("scale0", "0Scale"),
    ("scaleV0", "0ScaleV"),
    ("baseSplits", "0BaseSplits"),
    ("leaves", "Leaves"),
    ("leafScale", "LeafScale"),
    ("leafScaleX", "LeafScaleX"),
    ("bend", "LeafBend"),
    ("leafDist", "LeafDistrib"),
    ("pruneRatio", "PruneRatio"),
    ("pruneWidth", "PruneWidth"),
    ("pruneWidthPeak", "PruneWidthPeak"),
    ("prunePowerLow", "PrunePowerLow"),
    ("prunePowerHigh", "PrunePowerHigh"),
];

/// Of levels.
const OF_LEVELS: [(&str, &str); 15] = [
    ("downAngle", "DownAngle"),
    ("downAngleV", "DownAngleV"),
    ("rotate", "Rotate"),
    ("rotateV", "RotateV"),
    ("branches", "Branches"),
    ("length", "Length"),
    ("lengthV", "LengthV"),
    ("taper", "Taper"),
    ("segSplits", "SegSplits"),
    ("splitAngle", "SplitAngle"),
    ("splitAngleV", "SplitAngleV"),
    ("curveRes", "CurveRes"),
    ("curve", "Curve"),
    ("curveBack", "CurveBack"),
    ("curveV", "CurveV"),
];

/// What is Blender's: its view, meshes, armatures and animation.
const OF_BLENDER: [&str; 25] = [
    "af1",
    "af2",
    "af3",
    "armAnim",
    "armLevels",
    "bevel",
    "bevelRes",
    "boneStep",
    "chooseSet",
    "frameRate",
    "gust",
    "gustF",
    "handleType",
    "leafAnim",
    "loopFrames",
    "makeMesh",
    "matIndex",
    "previewArm",
    "resU",
    "useArm",
    "wind",
    "windGust",
    "windSpeed",
    "do_update",
    "limitImport",
];

/// What is the tree's, and linden does not have: rules of Sapling's that the paper knows nothing of.
const OF_SAPLING_ALONE: [&str; 9] = [
    "autoTaper",
    "horzLeaves",
    "leafDupliObj",
    "leafangle",
    "minRadius",
    "nrings",
    "startCurv",
    "useOldDownAngle",
    "useParentAngle",
];

pub(super) fn read(text: &str) -> Result<ParameterFile, Fault> {
    let start = text.len() - text.trim_start().len();
    let (literal, end) = read_literal(text, start)?;
    let Datum::Dict(entries) = &literal.datum else {
        return Err(Fault::new(literal.place, "expected a dict of parameters"));
    };
    let mut draft =
        Draft::new(WeberPenn::default(), ParameterLook { flare: 0.0, ..ParameterLook::default() });
    if end < text.len() {
        draft.notes.push("what stands behind the dict is left out".to_owned());
    }
    let mut seed = None;
    let (mut of_blender, mut of_sapling) = (Vec::new(), Vec::new());
    // Descendants of Sapling have profiles of their own under the number 8.
    let is_descendant = entries.iter().any(|(key, ..)| key == "customShape");
    for (key, place, value) in entries {
        let said = Said { name: key, place: *place };
        if OF_BLENDER.contains(&key.as_str()) {
            of_blender.push(key.as_str());
        } else if OF_SAPLING_ALONE.contains(&key.as_str()) {
            of_sapling.push(key.as_str());
        } else if key == "seed" {
            seed = value
                .number()
                .filter(|seed| (0.0..=f64::from(u32::MAX)).contains(seed))
                .map(|seed| seed as u64);
        } else {
            take(&mut draft, &said, value, is_descendant)?;
        }
    }
    let is_off =
        |switch: &str| entries.iter().any(|(key, _, value)| key == switch && value.number() == Some(0.0));
    if is_off("prune") {
        draft.settings.prune_ratio = 0.0;
    }
    if is_off("showLeaves") && draft.settings.leaves != 0.0 {
        let leaves = std::mem::take(&mut draft.settings.leaves);
        draft
            .notes
            .push(format!("showLeaves is False: no leaves; leaves={leaves} would give those of the file"));
    }
    if !of_sapling.is_empty() {
        draft.notes.push(format!(
            "left out, for linden does not have them, so that the tree may differ: {}",
            of_sapling.join(", ")
        ));
    }
    if !of_blender.is_empty() {
        draft
            .notes
            .push(format!("left out, for they are Blender's and not the tree's: {}", of_blender.join(", ")));
    }
    Ok(draft.finish(Program::Sapling, None, seed))
}

fn take(draft: &mut Draft, said: &Said<'_>, value: &Literal, is_descendant: bool) -> Result<(), Fault> {
    let number =
        |literal: &Literal| literal.number().map(single).ok_or_else(|| said.fault("expected a number"));
    match said.name {
        "prune" | "showLeaves" => return Ok(()),
        "leafShape" => return leaf_shape(draft, said, value),
        "attractUp" => return attraction(draft, said, value),
        "shape" if is_descendant && number(value)? >= 8.0 => {
            draft
                .notes
                .push(said.note("is a profile of its own, which linden does not know; crown: cylindrical"));
            draft.tree("Shape", 3.0, said)?;
            return Ok(());
        }
        _ => {}
    }
    if let Some((_, name)) = OF_TREES.iter().find(|(known, _)| *known == said.name) {
        draft.tree(name, number(value)?, said)?;
    } else if let Some((_, name)) = OF_LEVELS.iter().find(|(known, _)| *known == said.name) {
        let list =
            value.numbers().ok_or_else(|| said.fault("expected a tuple of numbers, one for each level"))?;
        for (level, &item) in list.iter().enumerate() {
            // The number of branches of the trunk means nothing here.
            if *name != "Branches" || level > 0 {
                draft.level(name, level, single(item), said)?;
            }
        }
    } else {
        let known = OF_TREES.iter().chain(&OF_LEVELS).map(|(name, _)| *name).collect::<Vec<_>>();
        draft.unknown(said, &known);
    }
    Ok(())
}

fn leaf_shape(draft: &mut Draft, said: &Said<'_>, value: &Literal) -> Result<(), Fault> {
    let Datum::Text(shape) = &value.datum else { return Err(said.fault("expected a text like 'hex'")) };
    if shape != "hex" && shape != "rect" {
        draft
            .notes
            .push(said.note("is an object of Blender's, which linden does not have; it draws ellipses"));
    }
    Ok(())
}

/// One number, or one for each level, of which those of the trunk and its branches are not the paper's.
fn attraction(draft: &mut Draft, said: &Said<'_>, value: &Literal) -> Result<(), Fault> {
    let up = match value.numbers() {
        Some(list) => {
            if list.iter().take(2).any(|&up| up != 0.0) {
                draft.notes.push(said.note("turns up level 0 or 1, too; the paper does so from level 2 on"));
            }
            list.get(2).or(list.last()).copied()
        }
        None => value.number(),
    };
    let up = up.ok_or_else(|| said.fault("expected a number, or one for each level"))?;
    draft.tree("AttractionUp", single(up), said)?;
    Ok(())
}

/// Blender has single precision and prints it as double: 0.3 is 0.30000001192092896 in its files.
fn single(x: f64) -> f64 {
    let short = x as f32;
    if f64::from(short) == x { short.to_string().parse().unwrap_or(x) } else { x }
}
