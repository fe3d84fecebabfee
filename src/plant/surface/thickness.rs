//! Wood by its thickness: which triangles are trunk, which limbs, which twigs.

use super::target::Amount;
use linden_base::mesh::Mesh;
use linden_base::monitor::{Cancelled, Monitor};
use linden_skeleton::{NO_PARENT, Skeleton};

/// Axes between two looks at the monitor.
const PER_CHECK: usize = 256;

/// The class of each triangle of tubes, which are `counts` one after another: 0 where the wood is thicker than all
/// `limits_m` (radii, the largest first), the number of the last one that holds where it is thinner.
///
/// How thick it is, the skeleton says: features of the surface, a flare say, do not count. The borders between
/// classes follow the rings.
pub(crate) fn classes(
    mesh: &Mesh,
    counts: &[Amount],
    skeleton: &Skeleton,
    limits_m: &[f32],
    monitor: &dyn Monitor,
) -> Result<Vec<u8>, Cancelled> {
    let mut all = Vec::with_capacity(mesh.triangles.len());
    let (mut vertex, mut triangle) = (0, 0);
    let mut radii = Vec::new();
    for (index, (axis, amount)) in skeleton.axes.iter().zip(counts).enumerate() {
        if index.is_multiple_of(PER_CHECK) {
            monitor.check()?;
        }
        let nodes = skeleton.nodes_of(axis);
        let parent = Some(axis.parent).filter(|&parent| parent != NO_PARENT);
        // A lateral is as thick at its root as at its first node.
        let root = parent.zip(nodes.first()).map(|(at, &first)| (at, first));
        let stations: Vec<_> = root
            .into_iter()
            .chain(nodes.iter().map(|&node| (node, node)))
            .map(|(at, thick)| (skeleton.positions[at as usize], skeleton.radii[thick as usize]))
            .collect();
        let mut near = 0;
        radii.clear();
        // Rings follow each other along the axis.
        let stubs_from = vertex + amount.vertices - amount.roots[0] - amount.stubs;
        for place in &mesh.positions[vertex..stubs_from.min(mesh.positions.len())] {
            let off = |i: usize| stations[i].0.distance_squared(*place);
            while near + 1 < stations.len() && off(near + 1) <= off(near) {
                near += 1;
            }
            radii.push(stations.get(near).map_or(0.0, |station| station.1));
        }
        // What is left of limbs is of the bole, and roots are wood of the foot, however thin.
        let foot_m = stations.first().map_or(0.0, |station| station.1);
        radii.extend(std::iter::repeat_n(foot_m, amount.stubs + amount.roots[0]));
        for corners in &mesh.triangles[triangle..(triangle + amount.triangles).min(mesh.triangles.len())] {
            let of = |corner: u32| radii.get((corner as usize).wrapping_sub(vertex)).copied().unwrap_or(0.0);
            let radius = corners.iter().map(|&corner| of(corner)).fold(0.0, f32::max);
            all.push(limits_m.iter().filter(|&&limit| radius <= limit).count() as u8);
        }
        vertex += amount.vertices;
        triangle += amount.triangles;
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::super::tests::gnarled;
    use super::super::{Tubes, count, sweep};
    use super::*;
    use linden_base::monitor::Quiet;

    #[test]
    fn each_triangle_has_the_class_of_the_nearest_wood() {
        let skeleton = gnarled(5);
        let (mesh, counts) = (
            sweep(&skeleton, &Tubes::default(), &Quiet).unwrap(),
            count(&skeleton, &Tubes::default(), &Quiet).unwrap(),
        );
        let thickest = skeleton.radii.iter().copied().fold(0.0, f32::max);
        let limits = [thickest * 0.6, thickest * 0.25];
        let found = classes(&mesh, &counts, &skeleton, &limits, &Quiet).unwrap();
        assert_eq!(found.len(), mesh.triangles.len());
        for class in 0..3 {
            assert!(found.contains(&class), "{class}");
        }
        // Coarser limits put nothing elsewhere, and no limit leaves all to the trunk.
        let first = classes(&mesh, &counts, &skeleton, &limits[..1], &Quiet).unwrap();
        assert!(found.iter().zip(&first).all(|(two, one)| (*two).min(1) == *one));
        assert!(classes(&mesh, &counts, &skeleton, &[], &Quiet).unwrap().iter().all(|&class| class == 0));
    }
}
