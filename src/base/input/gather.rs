//! Points as they come out of a file: memory is asked for, and of each cube of a grid one is kept where that is wanted.

use std::collections::HashMap;

use foldhash::fast::FixedState;
use glam::DVec3;

use super::cloud::{Columns, Thinned, Told};
use super::{Cloud, LeafColumn, READING, READING_ADVICE, TreeColumn};
use crate::memory::{OverMemory, bytes_grown, bytes_of};
use crate::monitor::{Cancelled, Monitor};

/// The cubes of a grid that a point was seen in. The grid begins at 0 0 0, whatever is in it.
struct Cubes {
    side: f64,
    /// Blocks of four cubes each way, with a bit for each that was seen. A scan shows surfaces: a dozen cubes of a block.
    seen: HashMap<[i32; 3], u64, FixedState>,
}

impl Cubes {
    /// A block, and the byte that tables of hashes keep beside it.
    const BYTES: u64 = bytes_of::<([i32; 3], u64)>(1) + 1;

    fn new(side: f64) -> Self {
        // Where the hashes of blocks lie changes nothing but the time.
        Self { side, seen: HashMap::with_hasher(FixedState::default()) }
    }

    /// Whether this is the first point in its cube.
    fn is_first(&mut self, point: DVec3) -> bool {
        let cube = (point / self.side).floor().to_array().map(|x| x as i64);
        // Blocks 2^32 apart count as one: sixteen thousand kilometres of millimetres.
        let block = cube.map(|x| (x >> 2) as i32);
        let [x, y, z] = cube.map(|x| x & 3);
        let bit = 1_u64 << (x | y << 2 | z << 4);
        let bits = self.seen.entry(block).or_default();
        let is_first = *bits & bit == 0;
        *bits |= bit;
        is_first
    }

    /// Whether another block may need a larger table.
    fn is_full(&self) -> bool {
        self.seen.len() == self.seen.capacity()
    }

    /// What the table takes when one more comes: while it moves it is there twice, the new one half empty.
    fn bytes(&self) -> u64 {
        if self.is_full() {
            return (self.seen.capacity() as u64 + 4) * 8 / 7 * 3 * Self::BYTES;
        }
        self.seen.capacity() as u64 * 8 / 7 * Self::BYTES
    }
}

/// Points that are being read, with what tells trees apart and leaves from wood.
pub(super) struct Gathering<'m> {
    positions: Vec<DVec3>,
    columns: Columns,
    /// Which are on the ground; empty until one is.
    is_ground: Vec<bool>,
    cubes: Option<Cubes>,
    /// Points that came.
    came: u64,
    /// And rows without a place.
    placeless: u64,
    /// Bytes that are held beside.
    held: u64,
    monitor: &'m dyn Monitor,
}

impl<'m> Gathering<'m> {
    /// None yet, with columns of these names. Of each cube with sides `cube` the first point is kept; of 0 or without, all.
    pub fn new(names: impl IntoIterator<Item = String>, cube: Option<f64>, monitor: &'m dyn Monitor) -> Self {
        let cubes = cube.filter(|&side| side > 0.0).map(Cubes::new);
        let columns = Columns::new(names);
        let (positions, is_ground) = (Vec::new(), Vec::new());
        Self { positions, columns, is_ground, cubes, came: 0, placeless: 0, held: 0, monitor }
    }

    /// The same while so many bytes are held beside.
    pub fn holding(self, held: u64) -> Self {
        Self { held, ..self }
    }

    /// Gives it other columns, before any point came.
    pub fn set_columns(&mut self, names: impl IntoIterator<Item = String>) {
        self.columns = Columns::new(names);
    }

    pub fn monitor(&self) -> &'m dyn Monitor {
        self.monitor
    }

    /// How many points came, kept or not.
    pub fn came(&self) -> u64 {
        self.came
    }

    /// Counts a row that says no place.
    pub fn pass_over(&mut self) {
        self.placeless += 1;
    }

    /// How many rows said no place.
    pub fn placeless(&self) -> u64 {
        self.placeless
    }

    /// Adds a point on the ground.
    pub fn push_ground(&mut self, point: DVec3, value: impl Fn(usize) -> f64) -> Result<(), OverMemory> {
        let before = self.positions.len();
        self.push(point, value)?;
        if self.positions.len() > before {
            self.is_ground.resize(before, false);
            self.is_ground.push(true);
        }
        Ok(())
    }

    /// Adds a point; `value` has what its columns say, by their numbers.
    pub fn push(&mut self, point: DVec3, value: impl Fn(usize) -> f64) -> Result<(), OverMemory> {
        self.came += 1;
        let is_kept = self.make_room(point)?;
        for column in 0..self.columns.count() {
            self.columns.take(column, value(column), is_kept);
        }
        if is_kept {
            self.positions.push(point);
        }
        Ok(())
    }

    /// Whether the point is kept; then there is room for it.
    fn make_room(&mut self, point: DVec3) -> Result<bool, OverMemory> {
        let mut of_cubes = 0;
        if let Some(cubes) = &mut self.cubes {
            of_cubes = cubes.bytes();
            if cubes.is_full() {
                let list = bytes_of::<DVec3>(self.positions.capacity()) + self.columns.bytes();
                self.monitor.admit(READING, self.held + list + of_cubes, READING_ADVICE)?;
            }
            if !cubes.is_first(point) {
                return Ok(false);
            }
        }
        if self.positions.len() == self.positions.capacity() {
            let count = self.positions.len() + 1;
            let columns = bytes_grown::<u32>(count).saturating_mul(self.columns.count() as u64);
            let marks = if self.is_ground.is_empty() { 0 } else { bytes_grown::<bool>(count) };
            let bytes = bytes_grown::<DVec3>(count).saturating_add(columns).saturating_add(marks);
            let all = bytes.saturating_add(self.held).saturating_add(of_cubes);
            self.monitor.admit(READING, all, READING_ADVICE)?;
        }
        Ok(true)
    }

    /// All that came and was kept.
    pub fn finish(self) -> Cloud {
        let Self { positions, columns, mut is_ground, cubes, came, placeless, .. } = self;
        let has_others = is_ground.len() < positions.len() || is_ground.contains(&false);
        is_ground.resize(if is_ground.is_empty() { 0 } else { positions.len() }, false);
        let is_ground = Some(is_ground).filter(|marks| !marks.is_empty() && has_others);
        let thinned = cubes.map(|cubes| Thinned { cube: cubes.side, of: came });
        let Told { trees, classes, unnumbered, leaves } = columns.finish(&positions, is_ground.as_deref());
        let placeless_rows = placeless;
        Cloud {
            positions,
            trees,
            classes,
            unnumbered,
            leaves,
            is_ground,
            placeless_rows,
            thinned,
            ..Cloud::default()
        }
    }
}

impl Cloud {
    /// The first point of each cube with sides `cube`, as if the file had been read so. The grid begins at 0 0 0 of the file.
    ///
    /// # Errors
    /// No memory; cancelled.
    pub fn thin(&self, cube: f64, monitor: &dyn Monitor) -> Result<Self, ThinError> {
        let numbered: Vec<&TreeColumn> = self.trees.iter().chain(&self.classes).collect();
        let is_class = |leaves: &&LeafColumn| self.classes.iter().any(|column| column.name == leaves.name);
        let leaves = self.leaves.as_ref().filter(|leaves| !is_class(leaves));
        let names = numbered.iter().map(|column| column.name.clone());
        let names = names.chain(leaves.map(|column| column.name.clone()));
        let mut kept = Gathering::new(names, Some(cube), monitor).holding(self.bytes());
        for (at, &point) in self.positions.iter().enumerate() {
            if at % super::ROWS_PER_CHECK == 0 {
                monitor.check()?;
            }
            let value = |column: usize| match (numbered.get(column), leaves) {
                (Some(column), _) => f64::from(column.numbers[at]),
                (None, Some(leaves)) => f64::from(leaves.number(at)),
                (None, None) => f64::NAN,
            };
            if self.is_ground.as_ref().is_some_and(|marks| marks[at]) {
                kept.push_ground(point, value)?;
            } else {
                kept.push(point, value)?;
            }
        }
        Ok(Self {
            cell: self.cell,
            unnamed: self.unnamed.clone(),
            unnumbered: self.unnumbered.clone(),
            units: self.units,
            is_z_up: self.is_z_up,
            placeless_rows: self.placeless_rows,
            has_row_numbers: self.has_row_numbers,
            ..kept.finish()
        })
    }
}

/// Why points were not thinned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ThinError {
    /// No memory.
    #[error(transparent)]
    Memory(#[from] OverMemory),
    /// Nobody wants them any more.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fmt::Write as _;
    use std::io::Cursor;

    use super::*;
    use crate::input::{Geometry, Input, InputError};
    use crate::monitor::{Phase, Quiet};
    use crate::random::Key;

    /// Points on both sides of zero, many to a cube of a tenth, in no order.
    fn points(count: u64) -> Vec<DVec3> {
        let at = |i: u64, axis: &'static str| Key::new(7).named(axis).child(i).unit() * 2.0 - 1.0;
        (0..count).map(|i| DVec3::new(at(i, "x"), at(i, "y"), 0.5 * at(i, "z"))).collect()
    }

    /// What is kept, by the definition.
    fn first_of_cubes(points: &[DVec3], side: f64) -> Vec<usize> {
        let mut seen = BTreeSet::new();
        let cube = |p: &DVec3| p.to_array().map(|x| (x / side).floor() as i64);
        (0..points.len()).filter(|&i| seen.insert(cube(&points[i]))).collect()
    }

    /// The same as a table, with trees, leaves, and a column with a single fraction.
    fn table(points: &[DVec3]) -> String {
        let mut text = "x,y,z,treeID,part,label\n".to_owned();
        for (i, p) in points.iter().enumerate() {
            let label = if i == points.len() - 1 { 0.5 } else { 3.0 };
            writeln!(text, "{},{},{},{},{},{label}", p.x, p.y, p.z, i % 5, 1 + i % 2).unwrap();
        }
        text
    }

    fn cloud(input: &Input) -> &Cloud {
        let Geometry::Points(cloud) = &input.geometry else { panic!("no points") };
        cloud
    }

    #[test]
    fn the_first_point_of_each_cube_is_kept_with_what_is_said_of_it() {
        let points = points(20_000);
        let text = table(&points);
        let whole = Input::read("a.csv", text.as_bytes(), &Quiet).unwrap();
        for side in [0.1, 0.37, 5.0, 1e-4] {
            let kept = first_of_cubes(&points, side);
            assert!(side < 1e-3 || kept.len() < points.len() / 2, "{side}: {}", kept.len());
            let read = Input::read_thinned("a.csv", text.as_bytes(), Some(side), &Quiet).unwrap();
            let thin = cloud(&read);
            assert_eq!(thin.positions, kept.iter().map(|&i| points[i]).collect::<Vec<_>>());
            assert_eq!(thin.thinned, Some(Thinned { cube: side, of: 20_000 }));
            let of = |name: &str| thin.trees.iter().find(|column| column.name == name);
            let numbers: Vec<u32> = kept.iter().map(|&i| i as u32 % 5).collect();
            assert_eq!(
                of("treeID").map(|column| &column.numbers),
                Some(&numbers).filter(|n| n.iter().any(|&n| n > 0))
            );
            // Not whole, though the row that tells is not kept.
            assert!(of("label").is_none());
            // Afterwards, or as a stream, it is the same.
            assert_eq!(&cloud(&whole).thin(side, &Quiet).unwrap(), thin);
            let stream = Cursor::new(text.clone().into_bytes());
            let streamed = Input::stream("a.csv", stream, Some(side), &Quiet).unwrap();
            assert_eq!((streamed.hash, cloud(&streamed)), (whole.hash, thin));
        }
        let leaves = cloud(&whole).thin(0.1, &Quiet).unwrap().leaves.unwrap();
        let kept = first_of_cubes(&points, 0.1);
        assert_eq!(leaves.is_leaf, kept.iter().map(|i| i % 2 == 1).collect::<Vec<_>>());
    }

    #[test]
    fn what_is_kept_is_all_the_memory_that_is_asked_for() {
        struct Watching(std::sync::atomic::AtomicU64);
        impl Monitor for Watching {
            fn is_cancelled(&self) -> bool {
                false
            }
            fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
            fn admit(&self, _: &'static str, bytes: u64, _: &'static str) -> Result<(), OverMemory> {
                self.0.fetch_max(bytes, std::sync::atomic::Ordering::Relaxed);
                Ok(())
            }
        }
        let most = |side: Option<f64>| {
            let watching = Watching(0.into());
            let stream = Cursor::new(table(&points(50_000)).into_bytes());
            let read = Input::stream("a.csv", stream, side, &watching).unwrap();
            (watching.0.into_inner(), cloud(&read).positions.len() as u64)
        };
        let ((all, every), (thin, kept)) = (most(None), most(Some(0.2)));
        assert!(kept * 20 < every && thin * 20 < all, "{kept} of {every} in {thin} of {all} bytes");
        // A place, three columns, and the table of blocks, each while it moves.
        assert!(thin >= kept * (24 + 12) && thin <= 5 * kept * (24 + 12 + 4), "{kept}: {thin}");
    }

    #[test]
    fn a_stream_says_where_it_is_wrong() {
        let stream = |text: &[u8]| {
            Input::stream("a.xyz", Cursor::new(text.to_vec()), None, &Quiet)
                .map(|input| cloud(&input).clone())
        };
        for text in ["1 2 3\n4 5 6\n", "\u{feff}1 2 3\r\n4 5 6", "# a\n\n1 2 3\n4 5 6\n\n"] {
            let whole = Input::read("a.xyz", text.as_bytes(), &Quiet).unwrap();
            assert_eq!(&stream(text.as_bytes()).unwrap(), cloud(&whole), "{text:?}");
        }
        // Behind what a file is told by.
        let many = "1 2 3\n".repeat(5000);
        for (opening, end) in
            [("", &b"4 5 x\n"[..]), ("\u{feff}", b"7 8 9\n7 \xe4\n"), ("9999\n", b"4 5 6\n")]
        {
            let text = [opening.as_bytes(), many.as_bytes(), end].concat();
            assert_eq!(stream(&text).unwrap_err(), Input::read("a.xyz", &text, &Quiet).unwrap_err());
        }
        let mut long = b"1 2 3\n".to_vec();
        long.resize(3 << 20, b' ');
        assert!(matches!(stream(&long), Err(InputError::Line { line: 2, .. })));
        assert!(matches!(stream(b"v 1 2 3\nf 1 1 1\n"), Err(InputError::Unknown { .. })));
    }
}
