//! The statements of a layer, of the text that the writers of prims hand on: declarations and single values. Long arrays
//! never are text here.

use crate::usda::unquoted;

/// A word, sign or value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Piece<'t> {
    /// A keyword, type or name; a number.
    Word(&'t str),
    /// `"…"`.
    Text(String),
    /// `@…@`.
    Asset(&'t str),
    /// `<…>`.
    Path(&'t str),
    /// One of `=(){}[],:`.
    Sign(u8),
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Literal<'t> {
    /// A number or a word.
    Word(&'t str),
    Text(String),
    Asset(&'t str),
    Path(&'t str),
    /// `[…]`.
    List(Vec<Literal<'t>>),
    /// `(…)`.
    Tuple(Vec<Literal<'t>>),
}

/// What of a text has not been read yet.
pub(super) struct Statements<'t> {
    pieces: Vec<Piece<'t>>,
    at: usize,
}

impl<'t> Statements<'t> {
    /// `None` for what has no end.
    pub fn of(text: &'t str) -> Option<Self> {
        let mut pieces = Vec::new();
        let mut rest = text.trim_start();
        while let Some(first) = rest.bytes().next() {
            let end = match first {
                b'"' => {
                    let end = end_of_text(rest)?;
                    pieces.push(Piece::Text(unquoted(&rest[..end])?));
                    end
                }
                b'@' => {
                    let end = rest[1..].find('@')? + 2;
                    pieces.push(Piece::Asset(&rest[1..end - 1]));
                    end
                }
                b'<' => {
                    let end = rest.find('>')? + 1;
                    pieces.push(Piece::Path(&rest[1..end - 1]));
                    end
                }
                // The layer's first line.
                b'#' => rest.find('\n').unwrap_or(rest.len()),
                _ if is_sign(first) => {
                    pieces.push(Piece::Sign(first));
                    1
                }
                _ => {
                    let is_end =
                        |c: char| c.is_whitespace() || (c != ':' && c.is_ascii() && is_sign(c as u8));
                    let end = rest.find(is_end).unwrap_or(rest.len());
                    // `0: value`: a name has no colon last.
                    let word = rest[..end].strip_suffix(':').unwrap_or(&rest[..end]);
                    pieces.push(Piece::Word(word));
                    word.len().max(1)
                }
            };
            rest = rest[end..].trim_start();
        }
        Some(Self { pieces, at: 0 })
    }

    pub fn is_empty(&self) -> bool {
        self.at >= self.pieces.len()
    }

    pub fn peek(&self) -> Option<&Piece<'t>> {
        self.pieces.get(self.at)
    }

    pub fn next(&mut self) -> Option<Piece<'t>> {
        let piece = self.pieces.get(self.at).cloned();
        self.at += 1;
        piece
    }

    /// Whether this sign is next; if so, it is read.
    pub fn takes(&mut self, sign: u8) -> bool {
        let takes = self.peek() == Some(&Piece::Sign(sign));
        self.at += usize::from(takes);
        takes
    }

    /// Whether this word is next; if so, it is read.
    pub fn takes_word(&mut self, word: &str) -> bool {
        let takes = self.peek() == Some(&Piece::Word(word));
        self.at += usize::from(takes);
        takes
    }

    pub fn word(&mut self) -> Option<&'t str> {
        let Piece::Word(word) = self.next()? else { return None };
        Some(word)
    }

    pub fn text(&mut self) -> Option<String> {
        let Piece::Text(text) = self.next()? else { return None };
        Some(text)
    }

    pub fn value(&mut self) -> Option<Literal<'t>> {
        Some(match self.next()? {
            Piece::Word(word) => Literal::Word(word),
            Piece::Text(text) => Literal::Text(text),
            Piece::Asset(path) => Literal::Asset(path),
            Piece::Path(path) => Literal::Path(path),
            Piece::Sign(b'[') => Literal::List(self.values(b']')?),
            Piece::Sign(b'(') => Literal::Tuple(self.values(b')')?),
            Piece::Sign(_) => return None,
        })
    }

    fn values(&mut self, end: u8) -> Option<Vec<Literal<'t>>> {
        let mut values = Vec::new();
        while !self.takes(end) {
            values.push(self.value()?);
            self.takes(b',');
        }
        Some(values)
    }
}

fn is_sign(byte: u8) -> bool {
    b"=(){}[],:\"@<".contains(&byte)
}

/// Behind the closing quote.
fn end_of_text(text: &str) -> Option<usize> {
    let mut is_escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return Some(i + 1),
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back_as_they_were() {
        for text in ["", "a\"b\\c", "a\n\u{1}é", "{\"a\":\"\\u00f6 \\\\ \\\"\"}"] {
            let literal = crate::usda::quoted(text);
            assert_eq!(Statements::of(&literal).unwrap().text().as_deref(), Some(text));
        }
    }

    #[test]
    fn statements_fall_into_pieces() {
        let mut read = Statements::of("float2 a:b.timeSamples = {\n    0: [(1, -2e-5)],\n}").unwrap();
        assert_eq!([read.word(), read.word()], [Some("float2"), Some("a:b.timeSamples")]);
        assert!(read.takes(b'=') && read.takes(b'{'));
        assert!(read.takes_word("0") && read.takes(b':'));
        let pair = Literal::Tuple(vec![Literal::Word("1"), Literal::Word("-2e-5")]);
        assert_eq!(read.value(), Some(Literal::List(vec![pair])));
        assert!(read.takes(b',') && read.takes(b'}') && read.is_empty());
        assert!(Statements::of("\"no end").is_none());
    }
}
