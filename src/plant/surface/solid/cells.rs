//! How a surface passes through a cell of a lattice: which of the cell's edges belong to the same sheet.
//!
//! Corners are numbered by bits, x y z; edge `4 a + (b + 2 c)` runs along axis `a` at the coordinates
//! `b`, `c` of the two axes after it; face `2 a + s` lies across axis `a` on side `s`.

/// Edges without the surface.
pub(super) const NO_SHEET: u8 = u8::MAX;

/// The sheets of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sheets {
    pub count: u8,
    /// For each edge the sheet that it belongs to, or [`NO_SHEET`].
    pub of_edge: [u8; 12],
}

/// The two corners of an edge, the lower one first.
pub(super) const fn ends(edge: usize) -> [usize; 2] {
    let (a, rest) = (edge / 4, edge % 4);
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    let low = ((rest & 1) << b) | ((rest >> 1) << c);
    [low, low | (1 << a)]
}

/// The edge along an axis from a corner.
const fn edge_from(axis: usize, corner: usize) -> usize {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    4 * axis + ((corner >> b) & 1) + 2 * ((corner >> c) & 1)
}

/// A face's corners in turn, and the edges from each to the next.
pub(super) const fn face(index: usize) -> ([usize; 4], [usize; 4]) {
    let (a, side) = (index / 2, index % 2);
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    let base = side << a;
    let corners = [base, base | (1 << b), base | (1 << b) | (1 << c), base | (1 << c)];
    let edges = [
        edge_from(b, corners[0]),
        edge_from(c, corners[1]),
        edge_from(b, corners[3]),
        edge_from(c, corners[0]),
    ];
    (corners, edges)
}

/// Whether a face's corners are inside and outside in turn, so that it does not say which belong
/// together.
pub(super) fn is_ambiguous(inside: u8, index: usize) -> bool {
    let signs = face(index).0.map(|corner| (inside >> corner) & 1);
    signs[0] == signs[2] && signs[1] == signs[3] && signs[0] != signs[1]
}

/// The sheets of a cell with these corners inside (a bit each). On an ambiguous face the corners inside
/// belong together, on a `flipped` one (a bit each) those outside.
pub(super) fn sheets(inside: u8, flipped: u8) -> Sheets {
    let is_inside = |corner: usize| (inside >> corner) & 1 == 1;
    // For each edge with the surface, its neighbours on the sheet: one across either face.
    let mut links = [[NO_SHEET; 2]; 12];
    let mut link = |a: usize, b: usize| {
        for (from, to) in [(a, b), (b, a)] {
            let free = usize::from(links[from][0] != NO_SHEET);
            links[from][free] = to as u8;
        }
    };
    for index in 0..6 {
        let (corners, edges) = face(index);
        let crossed: Vec4 = Vec4::of(edges, |e| {
            let [a, b] = ends(e);
            is_inside(a) != is_inside(b)
        });
        match crossed.len {
            2 => link(crossed.items[0], crossed.items[1]),
            4 => {
                // Each link cuts one corner off.
                let cut_off = (flipped >> index) & 1 == 1;
                for k in 0..4 {
                    if is_inside(corners[k]) == cut_off {
                        link(edges[k], edges[(k + 3) % 4]);
                    }
                }
            }
            _ => {}
        }
    }
    let mut all = Sheets { count: 0, of_edge: [NO_SHEET; 12] };
    for start in 0..12 {
        if links[start][0] == NO_SHEET || all.of_edge[start] != NO_SHEET {
            continue;
        }
        let mut edge = start;
        loop {
            all.of_edge[edge] = all.count;
            let onward = links[edge].into_iter().map(usize::from).find(|&next| all.of_edge[next] == NO_SHEET);
            match onward {
                Some(next) => edge = next,
                None => break,
            }
        }
        all.count += 1;
    }
    all
}

/// Whether both lines of an ambiguous face lie on one sheet. Where that is so on either side, the two
/// cells' vertices would be joined twice, by an edge of four quads (Wenger 2013, *Isosurfaces*,
/// section 3.3): there the face is to be flipped.
pub(super) fn is_pinched(sheets: &Sheets, index: usize) -> bool {
    let edges = face(index).1;
    edges.iter().all(|&edge| sheets.of_edge[edge] == sheets.of_edge[edges[0]])
}

/// Up to four edges.
struct Vec4 {
    items: [usize; 4],
    len: usize,
}

impl Vec4 {
    fn of(all: [usize; 4], mut keep: impl FnMut(usize) -> bool) -> Self {
        let mut edges = Self { items: [0; 4], len: 0 };
        for item in all {
            if keep(item) {
                edges.items[edges.len] = item;
                edges.len += 1;
            }
        }
        edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_faces_are_those_of_a_cube() {
        for index in 0..6 {
            let (corners, edges) = face(index);
            for k in 0..4 {
                let mut pair = [corners[k], corners[(k + 1) % 4]];
                pair.sort_unstable();
                assert_eq!(ends(edges[k]), pair, "face {index}");
            }
        }
    }

    /// Each edge between inside and outside is on a sheet, a sheet has at least three edges, and the
    /// number of sheets of a cell without ambiguity is that of the connected groups of corners, of
    /// whichever side has more.
    #[test]
    fn all_cells_have_the_sheets_of_the_definition() {
        for inside in 0..=255_u8 {
            for flipped in [0, 0b11_1111] {
                let sheets = sheets(inside, flipped);
                for edge in 0..12 {
                    let [a, b] = ends(edge).map(|corner| (inside >> corner) & 1);
                    assert_eq!(sheets.of_edge[edge] != NO_SHEET, a != b);
                }
                for sheet in 0..sheets.count {
                    assert!(sheets.of_edge.iter().filter(|&&s| s == sheet).count() >= 3);
                }
                if (0..6).all(|index| !is_ambiguous(inside, index)) {
                    let groups = groups(inside).max(groups(!inside));
                    let expected = if inside == 0 || inside == 255 { 0 } else { groups };
                    assert_eq!(sheets.count, expected, "{inside:08b}");
                }
            }
        }
    }

    fn groups(inside: u8) -> u8 {
        let mut seen = 0_u8;
        let mut count = 0;
        for start in 0..8 {
            if (inside >> start) & 1 == 0 || (seen >> start) & 1 == 1 {
                continue;
            }
            count += 1;
            let mut stack = vec![start];
            while let Some(corner) = stack.pop() {
                if (seen >> corner) & 1 == 0 && (inside >> corner) & 1 == 1 {
                    seen |= 1 << corner;
                    stack.extend([corner ^ 1, corner ^ 2, corner ^ 4]);
                }
            }
        }
        count
    }
}
