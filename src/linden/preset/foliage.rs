//! `[foliage]`: how leaves and the like look.

use super::knobs::{Access, PresetKnob, Section};
use super::setting::{Setting, assign};
use crate::knob::{Kind, Knob};

/// The most colours that one plant's organs have.
const MOST_COLORS: usize = 32;

/// How leaves and the like look.
#[derive(Clone, Debug, PartialEq)]
pub struct FoliageLook {
    /// sRGB, at least one. Organs of colour index i have the i-th; the last is that of all higher ones.
    pub leaf_colors: Vec<[u8; 3]>,
}

impl Default for FoliageLook {
    /// Old leaves and young ones.
    fn default() -> Self {
        Self { leaf_colors: vec![[74, 122, 48], [122, 154, 62]] }
    }
}

/// The section's knobs. Only L-systems have organs so far.
pub(super) const KNOBS: &[PresetKnob] = &[PresetKnob {
    knob: Knob {
        name: "leaf_colors",
        kind: Kind::Colors { most: MOST_COLORS },
        unit: "sRGB",
        help: "colours of polygons and organs: index 0 of ' has the first, the last repeats",
    },
    section: Section::Foliage,
    access: Access::Field {
        read: |preset| preset.lsystem().map(|_| preset.foliage.leaf_colors.to_value()),
        write: |preset, value| assign(&mut preset.foliage.leaf_colors, value),
    },
}];
