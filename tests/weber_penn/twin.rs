//! The paper's formulas once more, as plainly as they can be said: the lengths of all stems of a tree whose
//! parameters do not vary, by recursion from stem to stem. No code of linden's is in it.

/// Parameters that decide lengths and numbers.
pub struct Twin {
    pub scale: f64,
    pub base_size: f64,
    pub levels: usize,
    pub shape: fn(f64) -> f64,
    pub length: [f64; 4],
    pub branches: [f64; 4],
    pub ratio: f64,
    pub ratio_power: f64,
}

/// A stem of a level: its length and its radius at its base.
pub type Stem = (usize, f64, f64);

impl Twin {
    /// All stems.
    pub fn stems(&self) -> Vec<Stem> {
        let mut stems = Vec::new();
        let trunk = self.scale * self.length[0];
        self.grow(0, (trunk, trunk * self.ratio), (1.0, trunk, 0.0, 0.0), &mut stems);
        stems
    }

    /// A stem of a length and a radius; of its parent: the length, how far along the stem leaves, and the parent's
    /// radius there.
    fn grow(
        &self,
        level: usize,
        (length, radius): (f64, f64),
        (_, parent, offset, bark): (f64, f64, f64, f64),
        stems: &mut Vec<Stem>,
    ) {
        stems.push((level, length, radius));
        if level + 1 == self.levels {
            return;
        }
        let most = self.branches[level + 1];
        let count = match level {
            0 => most,
            1 => (most * (0.2 + 0.8 * (length / parent) / self.length[1])).floor(),
            _ => (most * (1.0 - 0.5 * offset / parent)).floor(),
        };
        let bare = if level == 0 { self.base_size * self.scale } else { bark.min(length / 2.0) };
        for child in 0..count as usize {
            let place = bare + (child as f64 + 0.5) / count * (length - bare);
            let longer = if level == 0 {
                let ratio = (length - place) / (length - self.base_size * self.scale);
                length * self.length[1] * (self.shape)(ratio)
            } else {
                self.length[level + 1] * (length - 0.6 * place)
            };
            // A cone.
            let there = radius * (1.0 - place / length);
            let thick = (radius * (longer / length).powf(self.ratio_power)).min(there);
            self.grow(level + 1, (longer, thick), (0.0, length, place, there), stems);
        }
    }
}
