//! Python literals: dicts, lists, tuples, texts, numbers. Nothing is run, and what is no literal is refused.

use linden_base::document::{Fault, TextPlace};
use linden_base::knob::excerpt;

use super::place_at;

/// Deeper nesting is no parameters of a tree.
const DEEPEST: usize = 4;

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Literal {
    pub place: Option<TextPlace>,
    pub datum: Datum,
}

/// What stands there.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Datum {
    /// Keys, where they stand, and values.
    Dict(Vec<(String, Option<TextPlace>, Literal)>),
    /// A list or a tuple.
    List(Vec<Literal>),
    Text(String),
    Number(f64),
    Switch(bool),
    None,
}

/// Where the dict begins that is assigned to `params`, behind comments and a docstring.
pub(super) fn assigned(text: &str) -> Option<usize> {
    let mut reader = Reader { text, at: 0, depth: 0 };
    loop {
        reader.skip();
        let rest = reader.rest();
        if rest.starts_with(['"', '\'']) {
            reader.text_literal().ok()?;
            continue;
        }
        let behind = rest.strip_prefix("params")?.trim_start().strip_prefix('=')?.trim_start();
        return behind.starts_with('{').then(|| text.len() - behind.len());
    }
}

/// Reads the literal that begins at an offset; where it ends.
pub(super) fn read(text: &str, start: usize) -> Result<(Literal, usize), Fault> {
    let mut reader = Reader { text, at: start, depth: 0 };
    let literal = reader.literal()?;
    reader.skip();
    Ok((literal, reader.at))
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn place(&self) -> Option<TextPlace> {
        place_at(self.text, self.at)
    }

    /// Passes over blanks and comments.
    fn skip(&mut self) {
        loop {
            let rest = self.rest();
            let blank = rest.len() - rest.trim_start().len();
            self.at += blank;
            if !self.rest().starts_with('#') {
                return;
            }
            self.at += self.rest().find('\n').unwrap_or(self.rest().len());
        }
    }

    fn fault(&self, expected: &str) -> Fault {
        let rest = self.rest();
        let found: String = rest.lines().next().unwrap_or_default().chars().take(24).collect();
        let found = if rest.is_empty() { "the end".to_owned() } else { format!("'{}'", excerpt(&found)) };
        Fault::new(
            self.place(),
            format!(
                "expected {expected}, found {found}; parameters are numbers, texts, lists and tuples of them"
            ),
        )
    }

    fn takes(&mut self, sign: char) -> bool {
        self.skip();
        let is_there = self.rest().starts_with(sign);
        if is_there {
            self.at += sign.len_utf8();
        }
        is_there
    }

    fn literal(&mut self) -> Result<Literal, Fault> {
        self.skip();
        let place = self.place();
        if self.depth > DEEPEST {
            return Err(Fault::new(place, format!("lists in lists are nested more than {DEEPEST} deep")));
        }
        let datum = match self.rest().chars().next() {
            Some('{') => self.dict()?,
            Some('[') => self.list('[', ']')?,
            Some('(') => self.list('(', ')')?,
            Some('"' | '\'') => Datum::Text(self.text_literal()?),
            Some(c) if c.is_ascii_digit() || matches!(c, '+' | '-' | '.') => self.number()?,
            _ => self.word()?,
        };
        Ok(Literal { place, datum })
    }

    fn dict(&mut self) -> Result<Datum, Fault> {
        self.takes('{');
        self.depth += 1;
        let mut entries = Vec::new();
        while !self.takes('}') {
            self.skip();
            let place = self.place();
            if !self.rest().starts_with(['"', '\'']) {
                return Err(self.fault("a name in quotes"));
            }
            let key = self.text_literal()?;
            if !self.takes(':') {
                return Err(self.fault("':' behind a name"));
            }
            entries.push((key, place, self.literal()?));
            if !self.takes(',') {
                if self.takes('}') {
                    break;
                }
                return Err(self.fault("',' or '}'"));
            }
        }
        self.depth -= 1;
        Ok(Datum::Dict(entries))
    }

    fn list(&mut self, open: char, close: char) -> Result<Datum, Fault> {
        self.takes(open);
        self.depth += 1;
        let mut items = Vec::new();
        while !self.takes(close) {
            items.push(self.literal()?);
            if !self.takes(',') {
                if self.takes(close) {
                    break;
                }
                return Err(self.fault(&format!("',' or '{close}'")));
            }
        }
        self.depth -= 1;
        // Round brackets round one value are no tuple.
        Ok(Datum::List(items))
    }

    fn text_literal(&mut self) -> Result<String, Fault> {
        let rest = self.rest();
        let triple = ["\"\"\"", "'''"].into_iter().find(|quote| rest.starts_with(quote));
        let quote = triple.unwrap_or(&rest[..1]);
        let mut text = String::new();
        let mut rest = &rest[quote.len()..];
        loop {
            if let Some(behind) = rest.strip_prefix(quote) {
                self.at = self.text.len() - behind.len();
                return Ok(text);
            }
            let mut letters = rest.chars();
            match letters.next() {
                Some('\\') => text.extend(letters.next()),
                Some('\n') if triple.is_none() => return Err(self.fault("a text that ends in its line")),
                Some(letter) => text.push(letter),
                None => return Err(self.fault("a text that ends")),
            }
            rest = letters.as_str();
        }
    }

    fn number(&mut self) -> Result<Datum, Fault> {
        let rest = self.rest();
        let is_part = |(i, c): &(usize, char)| {
            c.is_ascii_alphanumeric()
                || matches!(c, '.' | '_')
                || (matches!(c, '+' | '-') && (*i == 0 || rest[..*i].ends_with(['e', 'E'])))
        };
        let length =
            rest.char_indices().take_while(is_part).map(|(i, c)| i + c.len_utf8()).last().unwrap_or(0);
        let number = rest[..length].replace('_', "").parse::<f64>().ok().filter(|x| x.is_finite());
        let Some(number) = number else { return Err(self.fault("a number")) };
        self.at += length;
        Ok(Datum::Number(number))
    }

    fn word(&mut self) -> Result<Datum, Fault> {
        let rest = self.rest();
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let datum = match &rest[..length] {
            "True" => Datum::Switch(true),
            "False" => Datum::Switch(false),
            "None" => Datum::None,
            _ => return Err(self.fault("a value")),
        };
        self.at += length;
        Ok(datum)
    }
}

impl Literal {
    /// As a number: switches are 0 and 1, and texts of digits are numbers, as Sapling writes choices.
    pub fn number(&self) -> Option<f64> {
        match &self.datum {
            Datum::Number(x) => Some(*x),
            Datum::Switch(on) => Some(f64::from(u8::from(*on))),
            Datum::Text(text) => text.trim().parse().ok().filter(|x: &f64| x.is_finite()),
            _ => None,
        }
    }

    /// As a list of numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match &self.datum {
            Datum::List(items) => items.iter().map(Self::number).collect(),
            _ => None,
        }
    }
}
