//! A layer as it is written: prims within prims, each indented under its own.

use crate::writing::records::{self, Text};
use crate::{ExportError, Sink};

/// The text of a layer, up to some depth.
pub(super) struct Layer<'s, 'a> {
    out: &'s mut Sink<'a>,
    depth: usize,
}

impl<'s, 'a> Layer<'s, 'a> {
    pub fn new(out: &'s mut Sink<'a>) -> Self {
        Self { out, depth: 0 }
    }

    /// Whole lines, each indented; empty ones stay empty.
    pub fn lines(&mut self, text: &str) -> Result<(), ExportError> {
        let mut indented = String::with_capacity(text.len() + 1024);
        for line in text.lines() {
            if !line.is_empty() {
                indented.extend(std::iter::repeat_n("    ", self.depth));
                indented.push_str(line);
            }
            indented.push('\n');
        }
        self.out.write(indented.as_bytes())
    }

    /// Begins what braces hold: `head` stands before them.
    pub fn open(&mut self, head: &str) -> Result<(), ExportError> {
        self.lines(head)?;
        self.lines("{")?;
        self.depth += 1;
        Ok(())
    }

    /// Begins a variant or a set of them, which have their brace in the line of their name.
    pub fn open_inline(&mut self, head: &str) -> Result<(), ExportError> {
        self.lines(&format!("{head} {{"))?;
        self.depth += 1;
        Ok(())
    }

    /// Ends what was opened last.
    pub fn close(&mut self) -> Result<(), ExportError> {
        self.depth -= 1;
        self.lines("}")
    }

    /// An attribute of many elements: `item` formats one. `interpolation` is for primvars and the like.
    pub fn array(
        &mut self,
        declaration: &str,
        count: usize,
        interpolation: Option<&str>,
        item: impl Fn(&mut Text, usize) + Sync,
    ) -> Result<(), ExportError> {
        // Editors and diff choke on a line of a hundred megabytes.
        const PER_LINE: usize = 64;
        let pad = "    ".repeat(self.depth);
        self.out.write(format!("{pad}{declaration} = [").as_bytes())?;
        records::write(self.out, count, |text, range| {
            for i in range {
                if i > 0 {
                    text.bytes(if i % PER_LINE == 0 { b",\n" } else { b", " });
                }
                item(text, i);
            }
        })?;
        let metadata = interpolation
            .map(|word| format!(" (\n{pad}    interpolation = \"{word}\"\n{pad})"))
            .unwrap_or_default();
        self.out.write(format!("]{metadata}\n").as_bytes())
    }
}

/// `(x, y, …)`.
pub(super) fn vector<const N: usize>(text: &mut Text, numbers: [f32; N]) {
    text.byte(b'(');
    text.floats(numbers, b", ");
    text.byte(b')');
}
