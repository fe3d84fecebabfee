//! How much memory branchings and skeletons take.

use super::{Axis, Branching, Edge, NO_PARENT, RadiusFit, Skeleton, Width, Wood};
use linden_base::memory::{OverMemory, bytes_of};
use linden_base::monitor::Monitor;

impl Branching {
    /// Bytes that `nodes` nodes take without given radii.
    pub const fn bytes_for(nodes: usize) -> u64 {
        bytes_of::<([f32; 3], u32, u32)>(nodes)
    }

    /// Bytes that it takes, reserved places included.
    pub fn bytes(&self) -> u64 {
        let Self { positions, parents, births, radii, edges } = self;
        let radii = radii.as_ref().map_or(0, Vec::capacity);
        bytes_of::<[f32; 3]>(positions.capacity())
            + bytes_of::<u32>(parents.capacity() + births.capacity() + radii)
            + bytes_of::<Edge>(edges.as_ref().map_or(0, Vec::capacity))
    }

    /// Makes room for more nodes than there are by half, if there is memory for it. Without this, lists
    /// that grow one by one would double without asking the monitor.
    ///
    /// # Errors
    /// [`OverMemory`].
    #[cold]
    pub fn make_room(
        &mut self,
        doing: &'static str,
        advice: &'static str,
        monitor: &dyn Monitor,
    ) -> Result<(), OverMemory> {
        let nodes = self.positions.len();
        let more = (nodes / 2).max(64);
        // One list after the other moves; the positions' is the largest, and the first.
        let moving = self.bytes() + bytes_of::<[f32; 3]>(nodes + more);
        let moved = Self::bytes_for(nodes + more) + bytes_of::<(u32, Edge)>(nodes);
        monitor.admit(doing, moving.max(moved), advice)?;
        self.positions.reserve_exact(more);
        self.parents.reserve_exact(more);
        self.births.reserve_exact(more);
        if let Some(radii) = &mut self.radii {
            radii.reserve_exact(more);
        }
        if let Some(edges) = &mut self.edges {
            edges.reserve_exact(more);
        }
        Ok(())
    }

    /// Asks for the memory that [`Skeleton::build`] takes on its way, the branching included.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn admit_build(&self, wood: &Wood, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        monitor.admit("building the skeleton", self.build_bytes(wood), "grow a smaller tree")
    }

    /// The peak of [`Skeleton::build`]. The tips and pipes are gone when the axes are laid out.
    fn build_bytes(&self, wood: &Wood) -> u64 {
        let (nodes, axes) = (self.parents.len(), self.axes());
        let [word, long] = [bytes_of::<u32>(nodes), bytes_of::<f64>(nodes)];
        // Successors and nodes of axes.
        let laid_out = 2 * word + bytes_of::<Axis>(axes);
        self.bytes()
            + match wood.settled(self.radii.is_some(), self.edges.is_some()).width {
                // The radii are there; tips are needed to the end.
                Width::Grammar => word + laid_out,
                // Keys, counts of laterals, drawn shares; axes of nodes.
                Width::Order | Width::Taper => {
                    laid_out.max(word * 3 + bytes_of::<Axis>(axes) + bytes_of::<[f64; 4]>(axes))
                }
                Width::Auto | Width::Pipe if wood.angle_share == 0.0 => word + laid_out.max(2 * word),
                // Tips, pipes, claims; then pipes, successors.
                Width::Auto | Width::Pipe => (word + 2 * long).max(word + laid_out.max(word + long)),
            }
    }

    /// How many axes it may have: each ends in a node without children, or where all children branch.
    fn axes(&self) -> usize {
        if let Some(edges) = &self.edges {
            let stems = self.parents.iter().filter(|&&parent| parent == NO_PARENT).count();
            return edges.iter().filter(|edge| **edge != Edge::Succeeds).count() + stems;
        }
        let nodes = self.parents.len();
        let mut has_child = vec![false; nodes];
        for &parent in self.parents.iter().filter(|&&parent| parent != NO_PARENT) {
            if let Some(has_child) = has_child.get_mut(parent as usize) {
                *has_child = true;
            }
        }
        has_child.iter().filter(|has_child| !**has_child).count()
    }
}

impl Skeleton {
    /// The peak of [`Skeleton::build`] for `nodes` nodes of which a third end an axis.
    pub fn build_bytes(nodes: usize) -> Option<u64> {
        // Parents, births, radii, successors, and tips before the nodes of axes.
        let per_node = bytes_of::<([f32; 3], [u32; 5])>(1) + bytes_of::<Axis>(1).div_ceil(3);
        (nodes as u64).checked_mul(per_node)
    }

    /// Asks for the memory that [`Skeleton::until`] takes, this tree included. As with
    /// [`Branching::admit_build`], for all nodes: how many are left is what it finds out.
    ///
    /// # Errors
    /// [`OverMemory`].
    pub fn admit_until(&self, wood: &Wood, monitor: &dyn Monitor) -> Result<(), OverMemory> {
        let nodes = self.parents.len();
        let (word, long) = (bytes_of::<u32>(nodes), bytes_of::<f64>(nodes));
        // Marks, nodes and their new numbers; the young tree.
        let young = nodes as u64 + 2 * word + self.bytes();
        let scratch = match wood.width {
            // Tips of both.
            Width::Grammar => 4 * word,
            // Keys of the axes of both, and which axis each node is of.
            Width::Order | Width::Taper => 4 * word + bytes_of::<[f64; 6]>(self.axes.len()),
            // Tips, pipes, claims of one of both at a time.
            Width::Auto | Width::Pipe => 2 * word + 2 * long,
        };
        monitor.admit("showing a younger tree", self.bytes() + young + scratch, "grow a smaller tree")
    }

    /// Bytes that it takes, reserved places included.
    pub fn bytes(&self) -> u64 {
        let Self { positions, parents, radii, births, axes, axis_nodes, width_steps: _, marks, fits, trees } =
            self;
        bytes_of::<[f32; 3]>(positions.capacity())
            + bytes_of::<u32>(
                parents.capacity()
                    + radii.capacity()
                    + births.capacity()
                    + axis_nodes.capacity()
                    + trees.capacity(),
            )
            + bytes_of::<Axis>(axes.capacity())
            + marks.bytes()
            + bytes_of::<RadiusFit>(fits.capacity())
    }
}
