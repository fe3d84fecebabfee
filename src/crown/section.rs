//! Cuts through a mesh by a plane.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::topology::Surface;

/// An edge of the mesh, by its vertices, the lower first.
type Edge = (u32, u32);

impl Surface {
    /// The lines in which the plane `p · normal = distance` cuts the surface: closed lines end where
    /// they begin; lines that end at holes come first.
    pub fn cut(&self, normal: DVec3, distance: f64) -> Vec<Vec<Vec3>> {
        let side = |v: u32| self.positions[v as usize].dot(normal) - distance;
        // Each triangle that is cut joins the two of its edges that are.
        let mut joins: Vec<[Edge; 2]> = Vec::new();
        let mut at_edge: BTreeMap<Edge, Vec<u32>> = BTreeMap::new();
        for &[a, b, c] in &self.triangles {
            let mut cut = [(a, b), (b, c), (c, a)]
                .into_iter()
                .map(|(v, w)| (v.min(w), v.max(w)))
                .filter(|&(v, w)| (side(v) < 0.0) != (side(w) < 0.0));
            if let (Some(first), Some(second)) = (cut.next(), cut.next()) {
                for edge in [first, second] {
                    at_edge.entry(edge).or_default().push(joins.len() as u32);
                }
                joins.push([first, second]);
            }
        }
        let place = |&(v, w): &Edge| {
            let (f, t) = (side(v), side(w));
            self.positions[v as usize].lerp(self.positions[w as usize], f / (f - t)).as_vec3()
        };
        let mut done = vec![false; joins.len()];
        let mut follow = |start: Edge| {
            let mut edges = vec![start];
            let mut at = start;
            let next = |at: &Edge, done: &[bool]| at_edge[at].iter().copied().find(|&j| !done[j as usize]);
            while let Some(join) = next(&at, &done) {
                done[join as usize] = true;
                let [first, second] = joins[join as usize];
                at = if first == at { second } else { first };
                edges.push(at);
            }
            (edges.len() > 1).then(|| edges.iter().map(place).collect::<Vec<Vec3>>())
        };
        let rims = at_edge.iter().filter(|(_, uses)| uses.len() == 1).map(|(&edge, _)| edge);
        let starts: Vec<Edge> = rims.chain(joins.iter().map(|join| join[0])).collect();
        starts.into_iter().filter_map(&mut follow).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of edge 2 around the origin, or without its lid.
    fn cube(closed: bool) -> Surface {
        let positions: Vec<DVec3> = (0..8)
            .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0)
            .collect();
        let quads = [[0, 4, 5, 1], [0, 2, 6, 4], [1, 5, 7, 3], [0, 1, 3, 2], [4, 6, 7, 5], [2, 3, 7, 6]];
        let kept = if closed { 6 } else { 5 };
        let triangles: Vec<[u32; 3]> =
            quads[..kept].iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        Surface::new(&positions, &triangles)
    }

    fn length(line: &[Vec3]) -> f32 {
        line.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    #[test]
    fn a_cut_through_a_box_is_a_square() {
        let lines = cube(true).cut(DVec3::Y, 0.25);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        assert!((length(&lines[0]) - 8.0).abs() < 1e-5);
        assert!(lines[0].iter().all(|p| (p.y - 0.25).abs() < 1e-6));
    }

    #[test]
    fn a_cut_through_an_open_box_ends_at_its_rim() {
        let lines = cube(false).cut(DVec3::X, 0.5);
        assert_eq!(lines.len(), 1);
        assert!((length(&lines[0]) - 6.0).abs() < 1e-5, "up, across and down, without the lid");
        assert_eq!([lines[0][0].y, lines[0].last().unwrap().y], [1.0, 1.0]);
    }

    #[test]
    fn two_bodies_give_two_lines() {
        let one = cube(true);
        let mut positions = one.positions.clone();
        positions.extend(one.positions.iter().map(|p| *p + DVec3::X * 5.0));
        let mut triangles = one.triangles.clone();
        triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + 8)));
        let lines = Surface::new(&positions, &triangles).cut(DVec3::Y, 0.0);
        assert_eq!(lines.len(), 2);
    }
}
