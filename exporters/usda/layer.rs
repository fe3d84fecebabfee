//! A layer as it is written: prims within prims. What writes them hands on statements and arrays, of which either text
//! or a crate file is made: the two hold the same.

use linden_pipeline::Monitor;

use crate::usdc::Crate;
use crate::writing::recent::{RecentFloats, RecentIntegers};
use crate::writing::records::{self, Text};
use crate::{ExportError, Sink};

/// Elements of an array in a line: editors and diff choke on one of a hundred megabytes.
const PER_LINE: usize = 64;
/// Of an array of one number: half a line is as long as records may be.
const PER_RECORD: usize = PER_LINE / 2;

/// A layer, up to some depth.
pub(super) struct Layer<'s, 'a>(Form<'s, 'a>);

enum Form<'s, 'a> {
    /// Each prim indented under its own.
    Text {
        out: &'s mut Sink<'a>,
        depth: usize,
    },
    Binary(&'s mut Crate<'a>),
}

impl<'s, 'a> Layer<'s, 'a> {
    pub fn new(out: &'s mut Sink<'a>) -> Self {
        Self(Form::Text { out, depth: 0 })
    }

    /// The bytes of the crate file of what `write` writes.
    pub fn binary(
        monitor: &dyn Monitor,
        write: impl FnOnce(&mut Layer<'_, '_>) -> Result<(), ExportError>,
    ) -> Result<Vec<u8>, ExportError> {
        let mut file = Crate::new(monitor);
        write(&mut Layer(Form::Binary(&mut file)))?;
        Ok(file.finish())
    }

    /// Whole lines, each indented; empty ones stay empty.
    pub fn lines(&mut self, text: &str) -> Result<(), ExportError> {
        let (out, depth) = match &mut self.0 {
            Form::Text { out, depth } => (out, *depth),
            Form::Binary(file) => return file.statements(text),
        };
        let mut indented = String::with_capacity(text.len() + 1024);
        for line in text.lines() {
            if !line.is_empty() {
                indented.extend(std::iter::repeat_n("    ", depth));
                indented.push_str(line);
            }
            indented.push('\n');
        }
        out.write(indented.as_bytes())
    }

    /// Begins what braces hold: `head` stands before them.
    pub fn open(&mut self, head: &str) -> Result<(), ExportError> {
        if let Form::Binary(file) = &mut self.0 {
            return file.statements(&format!("{head} {{"));
        }
        self.lines(head)?;
        self.lines("{")?;
        self.deepen();
        Ok(())
    }

    /// Begins a variant or a set of them, which have their brace in the line of their name.
    pub fn open_inline(&mut self, head: &str) -> Result<(), ExportError> {
        self.lines(&format!("{head} {{"))?;
        self.deepen();
        Ok(())
    }

    fn deepen(&mut self) {
        if let Form::Text { depth, .. } = &mut self.0 {
            *depth += 1;
        }
    }

    /// Ends what was opened last.
    pub fn close(&mut self) -> Result<(), ExportError> {
        if let Form::Text { depth, .. } = &mut self.0 {
            *depth -= 1;
        }
        self.lines("}")
    }

    /// An attribute of many elements: `item` gives one. `interpolation` is for primvars and the like.
    pub fn array<T: Element>(
        &mut self,
        declaration: &str,
        count: usize,
        interpolation: Option<&str>,
        item: impl Fn(usize) -> T + Sync,
    ) -> Result<(), ExportError> {
        self.array_of(declaration, count, (interpolation, 1), item)
    }

    /// As [`Self::array`], `size` elements for each vertex.
    pub fn elements<T: Element>(
        &mut self,
        declaration: &str,
        count: usize,
        size: u32,
        item: impl Fn(usize) -> T + Sync,
    ) -> Result<(), ExportError> {
        self.array_of(declaration, count, (Some("vertex"), size), item)
    }

    /// An attribute that is the same number again and again.
    pub fn repeated(&mut self, declaration: &str, count: usize, number: u32) -> Result<(), ExportError> {
        let Form::Text { out, depth } = &mut self.0 else {
            return self.array(declaration, count, None, |_| number);
        };
        let pad = "    ".repeat(*depth);
        out.write(format!("{pad}{declaration} = [").as_bytes())?;
        let half = vec![number.to_string(); PER_RECORD].join(", ");
        records::write(out, count.div_ceil(PER_RECORD), |text, range| {
            for record in range {
                match (record, record % 2) {
                    (0, _) => {}
                    (_, 0) => text.bytes(b",\n"),
                    _ => text.bytes(b", "),
                }
                let numbers = PER_RECORD.min(count - record * PER_RECORD);
                text.slice(&half.as_bytes()[..(half.len() + 2) / PER_RECORD * numbers - 2]);
            }
        })?;
        out.write(b"]\n")
    }

    fn array_of<T: Element>(
        &mut self,
        declaration: &str,
        count: usize,
        (interpolation, size): (Option<&str>, u32),
        item: impl Fn(usize) -> T + Sync,
    ) -> Result<(), ExportError> {
        let (out, depth) = match &mut self.0 {
            Form::Text { out, depth } => (out, *depth),
            Form::Binary(file) => {
                let mut bytes = Vec::with_capacity(count * size_of::<T>());
                (0..count).for_each(|i| item(i).append(&mut bytes));
                return file.array(declaration, count * T::ELEMENTS, (interpolation, size), bytes);
            }
        };
        let pad = "    ".repeat(depth);
        out.write(format!("{pad}{declaration} = [").as_bytes())?;
        records::write(out, count, |text, range| {
            let mut recent = T::Recent::default();
            for i in range {
                if i > 0 {
                    text.bytes(if i % PER_LINE == 0 { b",\n" } else { b", " });
                }
                item(i).format(text, &mut recent);
            }
        })?;
        let metadata = interpolation
            .map(|word| {
                let size = if size > 1 { format!("{pad}    elementSize = {size}\n") } else { String::new() };
                format!(" (\n{size}{pad}    interpolation = \"{word}\"\n{pad})")
            })
            .unwrap_or_default();
        out.write(format!("]{metadata}\n").as_bytes())
    }
}

/// What arrays are of.
pub(super) trait Element: Copy {
    /// Elements of the array that it is.
    const ELEMENTS: usize = 1;

    /// What was formatted lately, where it comes again.
    type Recent: Default;

    fn format(self, text: &mut Text, recent: &mut Self::Recent);

    /// Appends its numbers as they lie in memory.
    fn append(self, bytes: &mut Vec<u8>);
}

impl Element for u32 {
    type Recent = RecentIntegers;

    fn format(self, text: &mut Text, recent: &mut RecentIntegers) {
        text.recent_integers(recent, (b"", b"", b""), [self]);
    }

    fn append(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Element for f32 {
    type Recent = ();

    fn format(self, text: &mut Text, (): &mut ()) {
        text.float(self);
    }

    fn append(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

/// `(x, y, …)`. Two are texture coordinates, which stand in rows and columns.
impl<const N: usize> Element for [f32; N] {
    type Recent = RecentFloats;

    fn format(self, text: &mut Text, recent: &mut RecentFloats) {
        if N == 2 {
            text.recent_tuple(recent, (b"(", b", ", b")"), self);
        } else {
            text.tuple((b"(", b", ", b")"), self);
        }
    }

    fn append(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.iter().flat_map(|x| x.to_le_bytes()));
    }
}

/// The corners of a triangle.
impl Element for [u32; 3] {
    const ELEMENTS: usize = 3;
    type Recent = RecentIntegers;

    fn format(self, text: &mut Text, recent: &mut RecentIntegers) {
        text.recent_integers(recent, (b"", b", ", b""), self);
    }

    fn append(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.iter().flat_map(|corner| corner.to_le_bytes()));
    }
}
