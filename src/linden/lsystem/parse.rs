//! Strings to modules and productions.

use super::command::{Command, unsupported_sign};
use super::error::{GrammarError, Part, Problem};
use super::grammar::{Expression, Module, Predecessor, Production};
use crate::knob::excerpt;

/// A problem at a byte offset of the string that was read.
#[derive(Debug)]
pub(super) struct Misread {
    offset: usize,
    problem: Problem,
}

impl Misread {
    /// The same, with the place that a reader looks for.
    pub(super) fn within(self, part: Part, text: &str) -> GrammarError {
        let column = 1 + text.char_indices().take_while(|&(i, _)| i < self.offset).count();
        GrammarError { part, offset: self.offset, column, problem: self.problem }
    }
}

/// Reads an axiom: at least one module.
pub(super) fn axiom(text: &str) -> Result<Vec<Module>, Misread> {
    let modules = Reader::new(text).modules()?;
    if modules.is_empty() {
        return Err(Misread { offset: text.len(), problem: Problem::expected("a symbol", None) });
    }
    Ok(modules)
}

/// Reads `predecessor arrow (probability) successor`.
pub(super) fn rule(text: &str) -> Result<Production, Misread> {
    let mut reader = Reader::new(text);
    let predecessor = reader.predecessor()?;
    let probability = reader.probability()?;
    let successor = reader.modules()?;
    Ok(Production { predecessor, probability, successor })
}

/// Reads symbol by symbol, past blanks.
struct Reader<'a> {
    text: &'a str,
    offset: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, offset: 0 }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.offset..]
    }

    /// The next character that is not blank, and where the reader then stands before it.
    fn peek(&mut self) -> Option<char> {
        self.offset = self.text.len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    fn eat(&mut self, wanted: &str) -> bool {
        self.peek();
        let found = self.rest().starts_with(wanted);
        if found {
            self.offset += wanted.len();
        }
        found
    }

    fn misread(&self, problem: Problem) -> Misread {
        Misread { offset: self.offset, problem }
    }

    fn predecessor(&mut self) -> Result<Predecessor, Misread> {
        let found = self.peek();
        let Some(symbol) = found else {
            return Err(self.misread(Problem::expected("a symbol and an arrow, as in 'F -> FF'", None)));
        };
        match Command::of(symbol) {
            Some(Command::Push | Command::Pop | Command::Cut) => {
                let expected = "a symbol that can be rewritten (brackets and '%' cannot)";
                return Err(self.misread(Problem::expected(expected, found)));
            }
            Some(_) => self.offset += symbol.len_utf8(),
            None => return Err(self.misread(self.stray(symbol, "a symbol"))),
        }
        if self.eat("->") || self.eat("→") || self.eat("=") {
            return Ok(Predecessor { symbol });
        }
        let problem = match self.peek() {
            Some('(') => Problem::unsupported("a rule with parameters", self.rest()),
            Some(sign @ ('<' | '>' | ':')) => self.stray(sign, "an arrow"),
            other => Problem::expected(format!("'->', '→' or '=' after '{symbol}'"), other),
        };
        Err(self.misread(problem))
    }

    /// The probability in brackets before a successor, 1 when there is none.
    fn probability(&mut self) -> Result<f64, Misread> {
        if self.eat("(") { self.number([0.0, 1.0]) } else { Ok(1.0) }
    }

    /// Modules to the end of the text, their brackets balanced.
    fn modules(&mut self) -> Result<Vec<Module>, Misread> {
        let mut modules = Vec::new();
        let mut open = Vec::new();
        while let Some(symbol) = self.peek() {
            let Some(command) = Command::of(symbol) else {
                return Err(self.misread(self.stray(symbol, "a symbol")));
            };
            match command {
                Command::Push => open.push(self.offset),
                Command::Pop if open.pop().is_none() => return Err(self.misread(Problem::Unopened)),
                _ => {}
            }
            self.offset += symbol.len_utf8();
            let arguments = self.arguments(symbol, command)?;
            modules.push(Module { symbol, arguments });
        }
        match open.pop() {
            Some(offset) => Err(Misread { offset, problem: Problem::Unclosed }),
            None => Ok(modules),
        }
    }

    /// What stands in brackets after a symbol.
    fn arguments(&mut self, symbol: char, command: Command) -> Result<Vec<Expression>, Misread> {
        if self.peek() != Some('(') {
            return Ok(Vec::new());
        }
        let Some(range) = command.argument_range() else {
            return Err(self.misread(if command == Command::Silent {
                Problem::unsupported("a symbol with parameters", &format!("{symbol}{}", self.rest()))
            } else {
                Problem::expected(format!("no number after '{symbol}'"), Some('('))
            }));
        };
        self.offset += 1;
        Ok(vec![Expression::Number(self.number(range)?)])
    }

    /// A number and its closing bracket.
    fn number(&mut self, [min, max]: [f64; 2]) -> Result<f64, Misread> {
        self.peek();
        let Some((inside, _)) = self.rest().split_once(')') else {
            let end = Misread { offset: self.text.len(), problem: Problem::expected("')'", None) };
            return Err(end);
        };
        let written = inside.trim_end();
        let number = match written.parse::<f64>() {
            Ok(number) if min <= number && number <= max => number,
            Ok(_) => {
                let number = excerpt(written);
                return Err(self.misread(Problem::OutOfRange { number, min, max }));
            }
            Err(_) => return Err(self.misread(no_number(written))),
        };
        self.offset += inside.len() + 1;
        Ok(number)
    }

    /// What to say about a character that is no symbol.
    fn stray(&self, found: char, expected: &str) -> Problem {
        match (unsupported_sign(found), found) {
            (Some(what), '#') => Problem::unsupported(what, self.rest()),
            (Some(what), _) => Problem::unsupported(what, &found.to_string()),
            (None, '−' | '–') => Problem::expected(format!("{expected} (is '-' meant?)"), Some(found)),
            (None, '’' | '‘' | '´' | '`') => {
                Problem::expected(format!("{expected} (is ''' meant?)"), Some(found))
            }
            (None, _) => Problem::expected(expected, Some(found)),
        }
    }
}

/// What to say about a text in brackets that is no number.
fn no_number(written: &str) -> Problem {
    let arithmetic = |c: char| c.is_alphabetic() || matches!(c, '+' | '-' | '*' | '/' | '^' | '(');
    if written.contains(',') {
        Problem::unsupported("a list of parameters", written)
    } else if written.contains(arithmetic) {
        Problem::unsupported("arithmetic", written)
    } else {
        Problem::expected("a number", written.chars().next().or(Some(')')))
    }
}
