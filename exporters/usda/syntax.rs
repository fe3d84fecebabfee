//! Names and strings as USD text takes them.

use std::collections::BTreeSet;

/// A prim's name from any name: ASCII letters, digits and `_`, no digit first (releases before 24.03
/// know no other letters).
pub(super) fn identifier(name: &str) -> String {
    let mut identifier: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if identifier.starts_with(|c: char| c.is_ascii_digit()) || identifier.is_empty() {
        identifier.insert(0, '_');
    }
    identifier
}

/// Siblings' names.
#[derive(Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// An identifier that no sibling has had.
    pub fn unique(&mut self, name: &str) -> String {
        let plain = identifier(name);
        let mut unique = plain.clone();
        let mut number = 2;
        while !self.0.insert(unique.clone()) {
            unique = format!("{plain}_{number}");
            number += 1;
        }
        unique
    }
}

/// A string literal.
pub(crate) fn quoted(text: &str) -> String {
    let mut literal = String::with_capacity(text.len() + 2);
    literal.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => literal.extend(['\\', c]),
            '\n' => literal.push_str("\\n"),
            c if c.is_ascii_control() => literal.push_str(&format!("\\x{:02x}", c as u32)),
            c => literal.push(c),
        }
    }
    literal.push('"');
    literal
}

/// The inverse of [`quoted`].
pub(crate) fn unquoted(literal: &str) -> Option<String> {
    let inside = literal.trim_end().strip_prefix('"')?.strip_suffix('"')?;
    let mut text = String::with_capacity(inside.len());
    let mut letters = inside.chars();
    while let Some(c) = letters.next() {
        text.push(match c {
            '\\' => match letters.next()? {
                'n' => '\n',
                'x' => {
                    let digits = [letters.next()?, letters.next()?];
                    let [high, low] = digits.map(|digit| digit.to_digit(16));
                    char::from_u32(16 * high? + low?)?
                }
                c => c,
            },
            c => c,
        });
    }
    Some(text)
}

/// `(x, y, z)`.
pub(super) fn tuple(numbers: [f32; 3]) -> String {
    let [x, y, z] = numbers;
    format!("({x}, {y}, {z})")
}

/// A side file as an asset path from the layer on: without a dot in front USD looks in its search path. Names of side
/// files, and the way to them, hold nothing that ends or changes one; see `Bundle::side_name`.
pub(super) fn beside(file: &str) -> String {
    if file.starts_with("../") { format!("@{file}@") } else { format!("@./{file}@") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_quoted_comes_back() {
        for text in ["", "{\"a\":\"\\u00f6 \\\\ \\\"\"}", "plain"] {
            assert_eq!(unquoted(&quoted(text)).as_deref(), Some(text));
        }
        assert_eq!([unquoted("a"), unquoted("\"a"), unquoted("\"a\\\"")], [None, None, None]);
    }

    #[test]
    fn every_name_becomes_an_identifier() {
        for (name, expected) in [
            ("fir", "fir"),
            ("Tilia × europaea", "Tilia___europaea"),
            ("3rd", "_3rd"),
            ("松", "_"),
            ("a\"b", "a_b"),
        ] {
            assert_eq!(identifier(name), expected);
        }
    }

    #[test]
    fn siblings_differ() {
        let mut names = Names::default();
        let given = ["a b", "a_b", "a_b_2", "a-b"].map(|name| names.unique(name));
        assert_eq!(given, ["a_b", "a_b_2", "a_b_2_2", "a_b_3"]);
    }

    #[test]
    fn strings_cannot_be_left() {
        assert_eq!(quoted(r#"a"b\c"#), r#""a\"b\\c""#);
        assert_eq!(quoted("a\n\u{1}é"), "\"a\\n\\x01é\"");
    }
}
