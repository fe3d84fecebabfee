//! Reads the geometry of Wavefront OBJ: `v` and `f`. Objects and groups become one mesh.
//!
//! Our own reader rather than the crate tobj 4.0.5, after trying that with hostile files: it turns a
//! polyline (`l`) into a face, refuses a comment behind a face and continued lines, overflows (a panic
//! in a debug build) on a relative texture index that is out of range, and none of its errors names
//! a line. Removing all that before calling it is longer than reading two statements. The tests
//! compare both on what both read.

use glam::DVec3;

use super::{
    InputError, READING, READING_ADVICE, ROWS_PER_CHECK, TriangleMesh, coordinate, fan, lines, make_room,
    quoted, text_of,
};
use crate::memory::{bytes_grown, bytes_of};
use crate::monitor::Monitor;

/// Reads vertices and faces; quads and larger polygons become fans, negative indices count from the last
/// vertex. Texture coordinates, normals, curves, points and materials are passed over, as are polygons of
/// fewer than three corners; lines (`l`) too: they are edges of no surface, and a file of nothing else is told so.
///
/// # Errors
/// [`InputError`] with the line: not UTF-8, a coordinate that is no finite number, an index that is
/// no whole number, 0 or of no vertex; no faces at all; no memory; cancelled.
pub fn read_obj(bytes: &[u8], monitor: &dyn Monitor) -> Result<TriangleMesh, InputError> {
    let mut reader = Reader::new(monitor);
    // A statement that goes on behind a backslash at the end of its line, and the line it starts in.
    let mut continued: Option<(usize, String)> = None;
    for (line, text) in lines(text_of(bytes)?) {
        if line % ROWS_PER_CHECK == 0 {
            monitor.check()?;
        }
        let statement = text.split('#').next().unwrap_or_default().trim_end();
        if let Some(part) = statement.strip_suffix('\\') {
            let (_, whole) = continued.get_or_insert_with(|| (line, String::new()));
            whole.push_str(part);
            whole.push(' ');
        } else if let Some((first, mut whole)) = continued.take() {
            whole.push_str(statement);
            reader.statement(first, &whole)?;
        } else {
            reader.statement(line, statement)?;
        }
    }
    if let Some((first, whole)) = continued {
        reader.statement(first, &whole)?;
    }
    reader.finish()
}

struct Reader<'a> {
    monitor: &'a dyn Monitor,
    mesh: TriangleMesh,
    polygon: Vec<u32>,
    /// The largest index that no vertex had when it was used, and its line: a later vertex may be meant.
    ahead: Option<(u32, usize)>,
    has_lines: bool,
}

impl<'a> Reader<'a> {
    fn new(monitor: &'a dyn Monitor) -> Self {
        Self { monitor, mesh: TriangleMesh::default(), polygon: Vec::new(), ahead: None, has_lines: false }
    }

    fn statement(&mut self, line: usize, statement: &str) -> Result<(), InputError> {
        let mut words = statement.split_ascii_whitespace();
        match words.next() {
            Some("v") => self.vertex(line, words),
            Some("f") => self.face(line, words),
            Some("l") => {
                self.has_lines = true;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// What follows the third number is passed over: a colour, or a weight that is for curves only.
    fn vertex<'w>(
        &mut self,
        line: usize,
        mut words: impl Iterator<Item = &'w str>,
    ) -> Result<(), InputError> {
        let mut position = [0.0; 3];
        for x in &mut position {
            let word = words.next().unwrap_or_default();
            *x = coordinate(word).map_err(|expected| error(line, expected, word))?;
        }
        let TriangleMesh { positions, triangles } = &mut self.mesh;
        let held = bytes_of::<[u32; 3]>(triangles.capacity());
        make_room(positions, positions.capacity(), held, self.monitor)?;
        positions.push(DVec3::from(position));
        Ok(())
    }

    fn face<'w>(&mut self, line: usize, words: impl Iterator<Item = &'w str>) -> Result<(), InputError> {
        self.polygon.clear();
        for word in words {
            let index = self.index(word).map_err(|expected| error(line, &expected, word))?;
            if index as usize >= self.mesh.positions.len() && self.ahead.is_none_or(|(most, _)| most < index)
            {
                self.ahead = Some((index, line));
            }
            self.polygon.push(index);
        }
        let TriangleMesh { positions, triangles } = &mut self.mesh;
        let held = bytes_of::<DVec3>(positions.capacity()) + bytes_of::<u32>(self.polygon.capacity());
        // A polygon is a triangle for each of its corners at most.
        let room = triangles.capacity().saturating_sub(self.polygon.len());
        if triangles.len() >= room {
            let all = bytes_grown::<[u32; 3]>(triangles.len() + self.polygon.len());
            self.monitor.admit(READING, all.saturating_add(held), READING_ADVICE)?;
        }
        fan(&self.polygon, triangles);
        Ok(())
    }

    /// The vertex index, from 0, of one corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn index(&self, corner: &str) -> Result<u32, String> {
        let vertex = corner.split('/').next().unwrap_or_default();
        let number: i64 = vertex.parse().map_err(|_| "a vertex index".to_owned())?;
        let count = self.mesh.positions.len();
        let index = match number {
            0 => return Err("a vertex index that is not 0 (they count from 1)".to_owned()),
            1.. => number - 1,
            _ => count as i64 + number,
        };
        u32::try_from(index).map_err(|_| format!("the index of a vertex ({count} so far)"))
    }

    fn finish(self) -> Result<TriangleMesh, InputError> {
        let count = self.mesh.positions.len();
        if let Some((index, line)) = self.ahead.filter(|&(index, _)| index as usize >= count) {
            let expected = format!("the index of a vertex (the file has {count})");
            return Err(error(line, &expected, &(u64::from(index) + 1).to_string()));
        }
        if self.mesh.triangles.is_empty() {
            let lines = if self.has_lines { ", only lines" } else { "" };
            let problem = format!(
                "it has {count} vertices and no faces{lines}; crowns, parts and leaves are made of faces"
            );
            return Err(InputError::Whole { format: "OBJ", problem });
        }
        Ok(self.mesh)
    }
}

fn error(line: usize, expected: &str, found: &str) -> InputError {
    InputError::Line { format: "OBJ", line, expected: expected.to_owned(), found: quoted(found) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Quiet;

    fn read(text: &str) -> Result<TriangleMesh, InputError> {
        read_obj(text.as_bytes(), &Quiet)
    }

    fn line_of(text: &str) -> usize {
        match read(text).unwrap_err() {
            InputError::Line { line, .. } => line,
            other => panic!("{other}"),
        }
    }

    #[test]
    fn reads_polygons_relative_indices_comments_and_continued_lines() {
        let text = "# cube side\r\nmtllib x.mtl\r\nv 0 0 0 0.5 0.5 0.5\r\nv 1 0 0\r\nv 1 1 0 # corner\r\nv 0 1 0\r\n\
                    vt 0 0\r\nvn 0 0 1\r\ng a\r\nf 1/1/1 2/1/1 3//1 \\\r\n 4 # all\r\nl 1 2 3 4\r\nf -4 -3 -2\r\nf 1 2\r\n";
        let mesh = read(text).unwrap();
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    }

    #[test]
    fn a_face_may_stand_before_its_vertices() {
        assert_eq!(read("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap().triangles, [[0, 1, 2]]);
    }

    #[test]
    fn errors_name_the_line() {
        let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        for (bad, line) in [
            ("f 1 2 4\n", 4),
            ("f 0 1 2\n", 4),
            ("f -4 1 2\n", 4),
            ("f 1 2 99999999999999999999\n", 4),
            ("f 1 2 4000000000\n", 4),
            ("f 1 2 x\n", 4),
            ("f 1 2 9223372036854775807\n", 4),
            ("f 1 2 -9223372036854775808\n", 4),
            ("\nv 1 nan 2\n", 5),
            ("v 1 2\n", 4),
            ("v 1 inf 2\n", 4),
            ("v 1 1e400 2\n", 4),
            ("v 1 1e30 2\n", 4),
            ("v a b c\n", 4),
        ] {
            assert_eq!(line_of(&format!("{three}{bad}f 1 2 3\n")), line, "{bad}");
        }
    }

    #[test]
    fn texture_indices_are_not_looked_at() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/-9 2/-9 3/77\n";
        assert_eq!(read(text).unwrap().triangles, [[0, 1, 2]]);
    }

    #[test]
    fn without_faces_it_is_no_crown() {
        let error = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n").unwrap_err();
        assert!(error.to_string().contains("no faces, only lines;"), "{error}");
        assert_eq!(read(""), Err(InputError::Empty));
        assert!(matches!(read_obj(b"v 0 0 \xfe\n", &Quiet), Err(InputError::NotUtf8 { line: 1, .. })));
    }
}
