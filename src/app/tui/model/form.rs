//! The cursor in the form of knobs.

/// Where the cursor is in the form.
#[derive(Debug, Default)]
pub struct Form {
    /// The row that it is on.
    pub selected: Option<FormSpot>,
    /// Whether only what differs from the document is listed.
    pub only_turned: bool,
}

/// A row that the cursor can be on. By name, so that it stays when a choice brings other knobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormSpot {
    /// A knob.
    Knob(&'static str),
    /// The grammar's axiom (0) or one of its rules (from 1).
    Rule(usize),
    /// An edit of the wood.
    Edit(usize),
    /// A further kind of foliage, by its number from 0.
    Kind(usize),
}

impl Form {
    /// To the first knob of another tree.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
