//! The knobs of what a kind of organ becomes in coarser levels of detail.

use linden_base::field;
use linden_base::knob::{Field, FieldValue, Kind, Value, real};

use super::detail::MOST_LODS;
use super::foliage::{Form, LeafKind};

/// What a kind is made of in one level of detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LodForm {
    /// Leaves of this form.
    Leaves(Form),
    /// Branch cards show it.
    BranchCard,
}

const BRANCH_CARD: &str = "branch-card";

impl LodForm {
    /// The words of all.
    pub const WORDS: &[&'static str] = &{
        let mut words = [BRANCH_CARD; Form::WORDS.len()];
        let mut at = 1;
        // The first form is none.
        while at < words.len() {
            words[at - 1] = Form::WORDS[at];
            at += 1;
        }
        words
    };

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Leaves(form) => form.word(),
            Self::BranchCard => BRANCH_CARD,
        }
    }

    fn named(word: &str) -> Option<Self> {
        if word == BRANCH_CARD { Some(Self::BranchCard) } else { Form::named(word).map(Self::Leaves) }
    }
}

/// What a kind is made of in each level, finest first, the last in all further ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LodForms(pub Vec<LodForm>);

impl LodForms {
    /// In a level, 0 for the finest; `None`: as the kind is, and on branch cards where the budget asks for them.
    pub fn in_level(&self, level: usize) -> Option<LodForm> {
        self.0.get(level).or(self.0.last()).copied()
    }
}

impl FieldValue for LodForms {
    fn to_value(&self) -> Value {
        Value::Words(self.0.iter().map(|form| form.word().to_owned()).collect())
    }

    fn from_value(value: Value) -> Option<Self> {
        let Value::Words(words) = value else { return None };
        words.iter().map(|word| LodForm::named(word)).collect::<Option<_>>().map(Self)
    }
}

/// Rows of [`LEAF_KNOBS`](super::LEAF_KNOBS).
pub(super) const LOD_KNOBS: [Field<LeafKind>; 2] = [
    field!(
        "lod_form",
        Kind::Sequence { words: LodForm::WORDS, most: MOST_LODS },
        "",
        "what leaves are made of in each level of detail, finest first, the last for all further ones; none: leaf_form, and branch cards where the budget asks for them",
        lod_forms,
        details(
            "curved card branch-card has bent leaves in the first level, flat ones in the second and pictures of \
             leafy twigs from the third on. card, cross, tuft and curved can stand for each other and for twig, with \
             the same picture; fan and mesh stay as they are or go on branch cards. A kind that has leaves in a level \
             keeps them where others are on branch cards: red fruit, say."
        ),
        see_also(&["lod_weight", "leaf_form", "lods", "branch_cards"])
    ),
    field!(
        "lod_weight",
        real(0.0, 1000.0),
        "",
        "how much longer this kind stays where levels of detail leave leaves out: 2 keeps twice the share of a kind with 1",
        lod_weight,
        details(
            "Numbers count by their ratios: of a plant with one kind they change nothing. Blossom at 10 is seen from \
             as far as the tree. 0 leaves the kind out wherever any leaf is. Branch cards show all that they stand for."
        ),
        see_also(&["lod_form", "triangles", "lods"])
    ),
];
