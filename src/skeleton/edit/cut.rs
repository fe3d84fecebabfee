//! Taking wood away.

use super::workpiece::SAME;
use super::{Along, Bench, Left, is_stem};

impl Bench<'_> {
    /// Takes an axis away, with all that it bears.
    pub(super) fn remove(&mut self, axis: u32) -> Result<(), Left> {
        if is_stem(&self.work, axis) {
            let mut others = (0..self.work.axes.len() as u32).filter(|&other| other != axis);
            if !others.any(|other| is_stem(&self.work, other) && !self.work.axes[other as usize].is_gone) {
                return Err("nothing would be left of the tree; cut it instead".to_owned());
            }
        }
        self.work.take_away(axis);
        Ok(())
    }

    /// Ends an axis at a place. Laterals that leave there or beyond go.
    pub(super) fn cut(&mut self, axis: u32, at: Along) -> Result<(), Left> {
        let length_m = self.work.length_m(axis);
        let along_m = at.of(length_m);
        if along_m >= length_m * (1.0 - SAME) {
            return Err(format!(
                "the axis is {length_m:.3} m long, so that nothing is cut off at {along_m:.3} m"
            ));
        }
        if along_m <= length_m * SAME {
            if is_stem(&self.work, axis) {
                return Err(
                    "nothing would be left of a stem that is cut at its foot; cut it higher".to_owned()
                );
            }
            self.work.take_away(axis);
            return Ok(());
        }
        let end = self.work.split(axis, along_m, 0.0);
        let nodes = &self.work.axes[axis as usize].nodes;
        let Some(place) = nodes.iter().position(|&node| node == end) else { return Ok(()) };
        let beyond = nodes[place..].to_vec();
        for node in beyond {
            for lateral in self.work.laterals_at(axis, node) {
                self.work.take_away(lateral);
            }
        }
        let axis = &mut self.work.axes[axis as usize];
        axis.nodes.truncate(place + 1);
        axis.is_cut = true;
        Ok(())
    }
}
