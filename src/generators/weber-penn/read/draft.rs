//! Settings on their way from a file: parameters by the paper's names.

use linden_base::document::{Fault, TextPlace};
use linden_base::knob::{Value, did_you_mean, excerpt, nearest};

use super::{ParameterFile, ParameterLook, Program};
use crate::{CrownShape, WeberPenn};

/// Parameters of each level: the paper's name without the level, and the knob.
const OF_LEVELS: [(&str, &str); 16] = [
    ("DownAngle", "down_angle"),
    ("DownAngleV", "down_angle_v"),
    ("Rotate", "rotate"),
    ("RotateV", "rotate_v"),
    ("Branches", "branches"),
    ("BranchDist", "branch_dist"),
    ("Length", "length"),
    ("LengthV", "length_v"),
    ("Taper", "taper"),
    ("SegSplits", "seg_splits"),
    ("SplitAngle", "split_angle"),
    ("SplitAngleV", "split_angle_v"),
    ("CurveRes", "curve_res"),
    ("Curve", "curve"),
    ("CurveBack", "curve_back"),
    ("CurveV", "curve_v"),
];

/// Parameters of the trunk alone, and of the tree.
const OF_TREES: [(&str, &str); 24] = [
    ("0Scale", "trunk_scale"),
    ("0ScaleV", "trunk_scale_v"),
    ("0BaseSplits", "base_splits"),
    ("Shape", "shape"),
    ("BaseSize", "base_size"),
    ("Levels", "levels"),
    ("Scale", "scale"),
    ("ScaleV", "scale_v"),
    ("Ratio", "ratio"),
    ("RatioPower", "ratio_power"),
    ("Leaves", "leaves"),
    ("LeafScale", "leaf_scale"),
    ("LeafScaleV", "leaf_scale_v"),
    ("LeafBend", "leaf_bend"),
    ("LeafStemLen", "leaf_stem"),
    ("LeafDistrib", "leaf_dist"),
    ("LeafQuality", "leaf_quality"),
    ("AttractionUp", "attraction_up"),
    ("PruneRatio", "prune_ratio"),
    ("PruneWidth", "prune_width"),
    ("PruneWidthPeak", "prune_width_peak"),
    ("PrunePowerLow", "prune_power_low"),
    ("PrunePowerHigh", "prune_power_high"),
    ("Lobes", ""),
];

/// A parameter as a file writes it.
#[derive(Clone, Copy)]
pub struct Said<'a> {
    pub name: &'a str,
    pub place: Option<TextPlace>,
}

impl Said<'_> {
    /// What is wrong with it.
    pub fn fault(&self, problem: &str) -> Fault {
        Fault::new(self.place, format!("parameter '{}': {problem}", excerpt(self.name)))
    }

    /// A note on it.
    pub fn note(&self, problem: &str) -> String {
        let name = excerpt(self.name);
        match self.place {
            Some(place) => format!("line {}: parameter '{name}' {problem}", place.line),
            None => format!("parameter '{name}' {problem}"),
        }
    }
}

/// What has been read so far.
pub struct Draft {
    pub settings: WeberPenn,
    pub look: ParameterLook,
    pub notes: Vec<String>,
}

impl Draft {
    pub fn new(settings: WeberPenn, look: ParameterLook) -> Self {
        Self { settings, look, notes: Vec::new() }
    }

    pub fn finish(self, program: Program, species: Option<String>, seed: Option<u64>) -> ParameterFile {
        let Self { settings, look, notes } = self;
        ParameterFile { program, species, seed, settings, look, notes }
    }

    /// Sets a parameter of a level by the paper's name without the level; whether there is one.
    pub fn level(&mut self, name: &str, level: usize, value: f64, said: &Said<'_>) -> Result<bool, Fault> {
        let Some((_, knob)) = OF_LEVELS.iter().find(|(known, _)| *known == name) else { return Ok(false) };
        if level >= crate::MAX_LEVELS as usize {
            self.notes.push(said.note("is of a level beyond the last and left out"));
            return Ok(true);
        }
        let value = match *knob {
            // One trunk where a program counts none; a stem has a segment.
            "branches" if level == 0 => value.abs().max(1.0),
            "curve_res" => value.max(1.0),
            "rotate_v" | "length_v" | "split_angle_v" => value.abs(),
            _ => value,
        };
        let Some(field) = WeberPenn::FIELDS.iter().find(|field| field.knob.name == *knob) else {
            return Ok(false);
        };
        let Value::Reals(mut list) = (field.read)(&self.settings) else { return Ok(false) };
        let last = list.last().copied().unwrap_or(0.0);
        list.resize(list.len().max(level + 1).max(4), last);
        list[level] = value;
        self.turn(knob, Value::Reals(list), value, said)?;
        Ok(true)
    }

    /// Sets a parameter of the tree by the paper's name; whether there is one.
    pub fn tree(&mut self, name: &str, value: f64, said: &Said<'_>) -> Result<bool, Fault> {
        let within = |least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(value)
            } else {
                Err(said.fault(&format!("{value} is outside the range: {least} to {most}")))
            }
        };
        match name {
            "Lobes" => self.look.lobes = libm::round(within(0.0, 24.0)?),
            "LobeDepth" => self.look.lobe_depth = within(-0.5, 0.5)?.abs(),
            "Flare" => self.look.flare = within(-1.0, 4.0)?.max(0.0),
            "LeafScaleX" => self.look.leaf_width = within(0.001, 100.0)?.clamp(0.02, 4.0),
            "ZScale" | "ZScaleV" => {
                self.notes.push(said.note("is in the paper's table without a formula and left out"));
            }
            _ => {
                let Some((_, knob)) = OF_TREES.iter().find(|(known, _)| *known == name) else {
                    return Ok(false);
                };
                let typed = match *knob {
                    "shape" | "leaf_dist" => {
                        let shape = CrownShape::of_number(value)
                            .ok_or_else(|| said.fault(&format!("{value} is no shape: 0 to 8 are")))?;
                        Value::Word(shape.word().to_owned())
                    }
                    "levels" => {
                        if !((1.0..=f64::from(crate::MAX_LEVELS)).contains(&value) && value.fract() == 0.0) {
                            let most = crate::MAX_LEVELS;
                            return Err(
                                said.fault(&format!("{value} is not a whole number from 1 to {most}"))
                            );
                        }
                        Value::Integer(value as u64)
                    }
                    "scale_v" | "trunk_scale_v" => Value::Real(value.abs()),
                    _ => Value::Real(value),
                };
                self.turn(knob, typed, value, said)?;
            }
        }
        Ok(true)
    }

    fn turn(&mut self, knob: &str, value: Value, given: f64, said: &Said<'_>) -> Result<(), Fault> {
        let Some(field) = WeberPenn::FIELDS.iter().find(|field| field.knob.name == knob) else {
            return Ok(());
        };
        let unit = if field.knob.unit.is_empty() { String::new() } else { format!(" {}", field.knob.unit) };
        field.knob.kind.check(&value).map_err(|_| {
            let kind = field.knob.kind;
            said.fault(&format!("{given}{unit} is no value of {knob}: {kind}"))
        })?;
        (field.write)(&mut self.settings, value);
        Ok(())
    }

    /// Notes a parameter that nothing is known of, and what may have been meant.
    pub fn unknown(&mut self, said: &Said<'_>, known: &[&'static str]) {
        let meant = did_you_mean(nearest(said.name, known.iter().copied()));
        self.notes.push(said.note(&format!("is unknown and left out{meant}")));
    }
}

/// Whether a name is one of the paper's.
pub fn knows(name: &str) -> bool {
    let of_level = name.strip_prefix(|c: char| c.is_ascii_digit());
    paper_names().contains(&name)
        || of_level.is_some_and(|rest| OF_LEVELS.iter().any(|(known, _)| *known == rest))
}

/// Names of the paper, for what may have been meant.
pub fn paper_names() -> Vec<&'static str> {
    let others = ["LobeDepth", "Flare", "LeafScaleX", "LeafShape", "Smooth"];
    OF_TREES.iter().map(|(name, _)| *name).chain(others).collect()
}
