//! The shells of a crown mesh: closed surfaces that stand apart.
//!
//! A file may hold a whole grove. Each closed surface in it that neither meets nor holds another is a shell.
//! Surfaces that overlap are one shell (modellers build crowns of balls that run into each other), and one
//! inside another belongs to it (a cavity, or the same again).

use glam::DVec3;

use super::Crown;
use super::entry::{Entry, entry};
use super::topology::Surface;
use super::winding::WindingTree;
use linden_base::monitor::{Cancelled, Monitor};
use linden_growth::site::Inside;

/// A closed part of a crown mesh, in the coordinates of the [`Envelope`](super::envelope::Envelope).
pub struct Shell {
    tree: WindingTree,
    low: DVec3,
    high: DVec3,
    volume_m3: f64,
}

impl Shell {
    /// Whether a place is inside.
    pub fn contains(&self, p: DVec3) -> bool {
        p.cmpge(self.low).all() && p.cmple(self.high).all() && self.tree.winding(p).abs() >= 0.5
    }

    /// Where its trunk enters it.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn entry(&self, monitor: &dyn Monitor) -> Result<Entry, Cancelled> {
        let middle =
            DVec3::new(0.5 * (self.low.x + self.high.x), self.low.y, 0.5 * (self.low.z + self.high.z));
        entry([self.low, self.high], middle, |p| self.contains(p), monitor)
    }

    /// From its lowest point to its highest.
    pub fn height_m(&self) -> f64 {
        self.high.y - self.low.y
    }

    /// About what it encloses: surfaces that overlap count twice where they do.
    pub fn volume_m3(&self) -> f64 {
        self.volume_m3
    }
}

/// A connected part of the surface.
struct Piece {
    triangles: Vec<[DVec3; 3]>,
    tree: WindingTree,
    low: DVec3,
    high: DVec3,
    /// Of the group that it is in; itself or an earlier one.
    group: usize,
}

impl Piece {
    fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let corners = || triangles.iter().flatten().copied();
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        Self { tree: WindingTree::new(triangles.clone()), triangles, low, high, group: 0 }
    }

    fn box_meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// Whether a corner of `other`, or the middle of one of its edges, is inside.
    fn holds_some_of(&self, other: &Self, monitor: &dyn Monitor) -> Result<bool, Cancelled> {
        for (i, &[a, b, c]) in other.triangles.iter().enumerate() {
            if i % 256 == 0 {
                monitor.check()?;
            }
            let places = [a, b, c, a.midpoint(b), b.midpoint(c), c.midpoint(a)];
            let in_box = |p: &&DVec3| p.cmpge(self.low).all() && p.cmple(self.high).all();
            if places.iter().filter(in_box).any(|&p| self.tree.winding(p).abs() >= 0.5) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// By the divergence theorem, below zero for a surface turned inside out.
    fn signed_volume_m3(&self) -> f64 {
        let about = self.low;
        let tetrahedron = |&[a, b, c]: &[DVec3; 3]| (a - about).dot((b - about).cross(c - about)) / 6.0;
        self.triangles.iter().map(tetrahedron).sum()
    }
}

/// The shells of a surface in the order of their first triangles; none where the surface has holes, for what
/// is inside of an open part is unknown.
pub(super) fn shells(surface: &Surface, monitor: &dyn Monitor) -> Result<Vec<Shell>, Cancelled> {
    if !surface.closed {
        return Ok(Vec::new());
    }
    let mut pieces = Vec::with_capacity(surface.components);
    for part in surface.parts() {
        monitor.check()?;
        let corners = |&t: &u32| surface.triangles[t as usize].map(|v| surface.positions[v as usize]);
        pieces.push(Piece::new(part.iter().map(corners).collect()));
    }
    // From left to right, so that only neighbours are compared.
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| pieces[a].low.x.total_cmp(&pieces[b].low.x).then(a.cmp(&b)));
    let mut group: Vec<usize> = (0..pieces.len()).collect();
    for (i, &a) in order.iter().enumerate() {
        let reach = pieces[a].high.x;
        for &b in order[i + 1..].iter().take_while(|&&b| pieces[b].low.x <= reach) {
            let (first, second) = (&pieces[a], &pieces[b]);
            if find(&group, a) != find(&group, b)
                && first.box_meets(second)
                && (first.holds_some_of(second, monitor)? || second.holds_some_of(first, monitor)?)
            {
                let (a, b) = (find(&group, a), find(&group, b));
                group[a.max(b)] = a.min(b);
            }
        }
    }
    for (i, piece) in pieces.iter_mut().enumerate() {
        piece.group = find(&group, i);
    }
    let mut found = Vec::new();
    for first in 0..pieces.len() {
        monitor.check()?;
        let members = || pieces.iter().filter(|piece| piece.group == first);
        if pieces[first].group != first {
            continue;
        }
        found.push(Shell {
            tree: WindingTree::new(members().flat_map(|piece| piece.triangles.iter().copied()).collect()),
            low: members().map(|piece| piece.low).fold(DVec3::INFINITY, DVec3::min),
            high: members().map(|piece| piece.high).fold(DVec3::NEG_INFINITY, DVec3::max),
            volume_m3: members().map(Piece::signed_volume_m3).sum::<f64>().abs(),
        });
    }
    Ok(found)
}

/// The first of a piece's group.
fn find(group: &[usize], mut i: usize) -> usize {
    while group[i] != i {
        i = group[i];
    }
    i
}

impl Inside for Shell {
    fn holds(&self, p: DVec3) -> bool {
        self.contains(p)
    }
}

/// A crown of any kind, for growth.
pub struct Filled(pub std::sync::Arc<dyn Crown>);

impl Inside for Filled {
    fn holds(&self, p: DVec3) -> bool {
        self.0.contains(p)
    }
}
