//! Reading a string symbol by symbol.

use super::error::{GrammarError, GrammarPart, Problem};

/// A problem at a byte offset of the string that was read.
#[derive(Debug)]
pub(super) struct Misread {
    pub offset: usize,
    pub problem: Problem,
}

impl Misread {
    /// The same, with the place that a reader looks for.
    pub(super) fn within(self, part: GrammarPart, text: &str) -> GrammarError {
        let column = 1 + text.char_indices().take_while(|&(i, _)| i < self.offset).count();
        GrammarError { part, offset: self.offset, column, problem: self.problem }
    }
}

/// Reads symbol by symbol, past blanks.
#[derive(Clone)]
pub(super) struct Reader<'a> {
    pub text: &'a str,
    pub offset: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, offset: 0 }
    }

    pub(super) fn rest(&self) -> &'a str {
        &self.text[self.offset..]
    }

    /// The next character that is not blank; the reader then stands before it.
    pub(super) fn peek(&mut self) -> Option<char> {
        self.offset = self.text.len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    pub(super) fn eat(&mut self, wanted: &str) -> bool {
        self.peek();
        let found = self.rest().starts_with(wanted);
        if found {
            self.offset += wanted.len();
        }
        found
    }

    pub(super) fn skip(&mut self, bytes: usize) {
        self.offset += bytes;
    }

    /// A letter or `_`, and the letters, digits and `_` that follow; empty when there is none.
    pub(super) fn name(&mut self) -> &'a str {
        let rest = self.rest();
        let is_first = |c: char| c.is_alphabetic() || c == '_';
        if !rest.starts_with(is_first) {
            return "";
        }
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        self.offset += end;
        &rest[..end]
    }

    /// Whether an arrow stands here that can be no part of an expression.
    pub(super) fn at_arrow(&self) -> bool {
        self.rest().starts_with("->") || self.rest().starts_with('→')
    }

    /// Passes over the label that ABOP gives a rule, `p12 :`. No rule begins so: `p` alone may have a condition, and
    /// `p1` be a context.
    pub(super) fn eat_rule_label(&mut self) {
        let mut ahead = self.clone();
        if !ahead.eat("p") {
            return;
        }
        let digits = ahead.rest().bytes().take_while(u8::is_ascii_digit).count();
        ahead.skip(digits);
        if digits > 0 && ahead.eat(":") {
            *self = ahead;
        }
    }

    /// Passes over the label that ABOP gives the axiom, `ω :`, and says whether there was one. No axiom holds a colon.
    pub(super) fn eat_axiom_label(&mut self) -> bool {
        ["ω", "omega"].into_iter().any(|label| {
            let mut ahead = self.clone();
            let found = ahead.eat(label) && ahead.eat(":");
            if found {
                *self = ahead;
            }
            found
        })
    }

    /// Refuses what looks like an arrow and is none.
    pub(super) fn check_arrow(&self) -> Result<(), Misread> {
        const ALIKE: [&str; 7] = ["-->", "==>", "=>", "⇒", "⟶", "::=", ":="];
        match ALIKE.into_iter().find(|arrow| self.rest().starts_with(arrow)) {
            None => Ok(()),
            Some(arrow) => {
                let (expected, found) = ("the arrow '->'".to_owned(), format!("'{arrow}'"));
                Err(self.misread(Problem::Expected { expected, found }))
            }
        }
    }

    pub(super) fn eat_arrow(&mut self) -> bool {
        self.eat("->") || self.eat("→") || self.eat("=")
    }

    pub(super) fn misread(&self, problem: Problem) -> Misread {
        Misread { offset: self.offset, problem }
    }
}
