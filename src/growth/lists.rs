//! Lists of millions of nodes.

/// Fewer elements than this are cheaper to have room for than to move.
const MANY: usize = 1 << 18;

/// Room for `more`, growing by a quarter where there are many: at millions of nodes a doubling would
/// be the peak of memory.
pub(super) fn reserve<T>(all: &mut Vec<T>, more: usize) {
    if all.capacity() - all.len() < more {
        let growth = if all.len() < MANY { all.len() } else { all.len() / 4 };
        all.reserve_exact(more.max(growth).max(64));
    }
}
