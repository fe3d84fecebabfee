//! Random variation of what the turtle draws: flat systems become trees in space.

use linden_base::random::Key;

/// How much varies; 0 everywhere is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variation {
    /// The most by which a turn is wider or narrower, degrees.
    pub angle_deg: f64,
    /// The most by which a branch is rolled about its axis to either side, degrees.
    pub roll_deg: f64,
    /// Each segment is longer or shorter by up to this share, 0 to 0.95.
    pub length: f64,
}

impl Variation {
    /// Whether anything varies.
    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Where on the plant the turtle is, as random choices see it.
///
/// A choice is keyed by its branch (the path of brackets that lead to it, each counted within the
/// branch around it) and by how many choices of its kind the branch had before. So an edit in one
/// branch does not reshuffle another.
pub(super) struct Chance {
    variation: Variation,
    here: Branch,
    stack: Vec<Branch>,
}

#[derive(Clone, Copy)]
struct Branch {
    key: Key,
    brackets: u32,
    angles: u32,
    lengths: u32,
}

impl Branch {
    fn new(key: Key) -> Self {
        Self { key, brackets: 0, angles: 0, lengths: 0 }
    }
}

impl Chance {
    /// `None` when nothing is to vary.
    pub fn new(variation: Variation, key: Key) -> Option<Self> {
        (!variation.is_none()).then(|| Self { variation, here: Branch::new(key), stack: Vec::new() })
    }

    /// Begins a branch; gives the degrees that it is rolled by.
    pub fn push(&mut self) -> f64 {
        let key = self.here.key.child(self.here.brackets.into());
        self.here.brackets += 1;
        self.stack.push(self.here);
        self.here = Branch::new(key);
        symmetric(key.named("roll"), self.variation.roll_deg)
    }

    /// Ends a branch.
    pub fn pop(&mut self) {
        self.here = self.stack.pop().unwrap_or(self.here);
    }

    /// An angle, varied.
    pub fn angle_deg(&mut self, degrees: f64) -> f64 {
        let choice = self.here.key.named("angle").child(self.here.angles.into());
        self.here.angles += 1;
        degrees + symmetric(choice, self.variation.angle_deg)
    }

    /// A length, varied.
    pub fn length_m(&mut self, length_m: f64) -> f64 {
        let choice = self.here.key.named("length").child(self.here.lengths.into());
        self.here.lengths += 1;
        length_m * (1.0 + symmetric(choice, self.variation.length))
    }
}

/// Uniform from −most to most.
fn symmetric(choice: Key, most: f64) -> f64 {
    if most == 0.0 { 0.0 } else { choice.between(-most, most) }
}
