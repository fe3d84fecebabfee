//! Texts to expressions: operator precedence with a stack of its own.

use super::super::error::Problem;
use super::super::reader::{Misread, Reader};
use super::{Binary, COMPARISON, Expression, Function, MAX_OPERANDS, MAX_PENDING, PREFIX, Token, Unary};
use linden_base::knob::{did_you_mean, excerpt, nearest, printable};

/// What names mean: parameters first, then constants.
#[derive(Clone, Copy)]
pub(in super::super) struct Scope<'a> {
    /// Of the rule, in the order of their values.
    pub parameters: &'a [String],
    pub constants: &'a [(String, f64)],
}

impl Scope<'_> {
    fn token(&self, name: &str) -> Option<Token> {
        if let Some(index) = self.parameters.iter().position(|parameter| parameter == name) {
            return Some(Token::Parameter(index as u16, name.into()));
        }
        let found = self.constants.iter().find(|(constant, _)| constant == name);
        found.map(|(_, value)| Token::Constant(*value, name.into()))
    }

    fn unknown(&self, name: &str) -> Problem {
        let known = || {
            let constants = self.constants.iter().map(|(name, _)| name.as_str());
            self.parameters.iter().map(String::as_str).chain(constants)
        };
        // Of names of one letter each is near to every other.
        let near = nearest(name, known()).filter(|_| name.chars().nth(2).is_some());
        let hint = match near {
            Some(near) => did_you_mean(Some(near)),
            None => {
                let list: Vec<&str> = known().take(8).collect();
                if list.is_empty() {
                    String::new()
                } else {
                    format!(" (known: {})", printable(&list.join(", ")))
                }
            }
        };
        Problem::UnknownName { name: excerpt(name), hint }
    }
}

/// What waits for the end of its operand.
enum Pending {
    Unary(Unary),
    Binary(Binary),
    Bracket,
    /// A function, with the arguments begun so far.
    Call(Function, usize),
}

/// Reads an expression up to a `)` or `,` that is not its own, an arrow, or the end.
pub(in super::super) fn expression(reader: &mut Reader<'_>, scope: Scope<'_>) -> Result<Expression, Misread> {
    parsed(reader, scope, false)
}

/// The same of a condition, in which `=`, `&` and `|` compare and join, as ABOP prints them.
pub(in super::super) fn condition(reader: &mut Reader<'_>, scope: Scope<'_>) -> Result<Expression, Misread> {
    parsed(reader, scope, true)
}

fn parsed(reader: &mut Reader<'_>, scope: Scope<'_>, is_condition: bool) -> Result<Expression, Misread> {
    let mut parser = Parser { tokens: Vec::new(), pending: Vec::new(), operands: 0, is_condition };
    loop {
        parser.operand(reader, scope)?;
        if !parser.operator(reader)? {
            return Ok(Expression { tokens: parser.tokens });
        }
    }
}

/// Operators as ABOP prints them in conditions.
const PRINTED: [(Binary, &str); 6] = [
    (Binary::Equal, "="),
    (Binary::And, "&"),
    (Binary::Or, "|"),
    (Binary::LessOrEqual, "≤"),
    (Binary::GreaterOrEqual, "≥"),
    (Binary::Unequal, "≠"),
];

struct Parser {
    tokens: Vec<Token>,
    pending: Vec<Pending>,
    /// How many values an evaluation holds at this place.
    operands: usize,
    is_condition: bool,
}

impl Parser {
    /// One operand with the signs, brackets and functions that open before it.
    fn operand(&mut self, reader: &mut Reader<'_>, scope: Scope<'_>) -> Result<(), Misread> {
        loop {
            let token = match reader.peek() {
                Some(c) if c.is_ascii_digit() || c == '.' => Token::Number(number(reader)?),
                Some(c) if c.is_alphabetic() || c == '_' => {
                    let start = reader.clone();
                    let name = reader.name();
                    if reader.eat("(") {
                        let Some(function) = Function::named(name) else {
                            return Err(start.misread(unknown_function(name)));
                        };
                        self.open(reader, Pending::Call(function, 1))?;
                        continue;
                    }
                    match scope.token(name) {
                        Some(token) => token,
                        None if Function::named(name).is_some() => {
                            return Err(reader.misread(no_bracket(name, reader.clone().peek())));
                        }
                        None => return Err(start.misread(scope.unknown(name))),
                    }
                }
                Some('-') => {
                    reader.eat("-");
                    self.open(reader, Pending::Unary(Unary::Minus))?;
                    continue;
                }
                Some('!') => {
                    reader.eat("!");
                    self.open(reader, Pending::Unary(Unary::Not))?;
                    continue;
                }
                Some('(') => {
                    reader.eat("(");
                    self.open(reader, Pending::Bracket)?;
                    continue;
                }
                found => return Err(reader.misread(Problem::expected("a number", found))),
            };
            self.operands += 1;
            if self.operands > MAX_OPERANDS {
                return Err(reader.misread(Problem::TooDeep { limit: MAX_OPERANDS }));
            }
            self.tokens.push(token);
            return Ok(());
        }
    }

    /// The brackets that close and the operator that follows; `false` at the end of the expression.
    fn operator(&mut self, reader: &mut Reader<'_>) -> Result<bool, Misread> {
        loop {
            let found = reader.peek();
            match found {
                Some(')') => {
                    self.reduce(0);
                    match self.pending.pop() {
                        None => return Ok(false),
                        Some(Pending::Call(function, given)) if given != function.arity() => {
                            return Err(reader.misread(arguments_missing(function, given)));
                        }
                        Some(Pending::Call(function, _)) => self.emit(Token::Call(function)),
                        Some(_) => {}
                    }
                    reader.eat(")");
                    continue;
                }
                Some(',') => {
                    self.reduce(0);
                    match self.pending.last_mut() {
                        None => return Ok(false),
                        Some(Pending::Call(function, given)) => {
                            if *given == function.arity() {
                                return Err(reader.misread(arguments_missing(*function, *given + 1)));
                            }
                            *given += 1;
                        }
                        Some(_) => return Err(reader.misread(Problem::expected("')'", found))),
                    }
                    reader.eat(",");
                    return Ok(true);
                }
                _ => {}
            }
            reader.check_arrow()?;
            if found.is_none() || reader.at_arrow() {
                self.reduce(0);
                return match self.pending.last() {
                    None => Ok(false),
                    Some(_) => Err(reader.misread(Problem::expected("')'", found))),
                };
            }
            let Some((binary, sign)) = self.sign(reader.rest()) else {
                return Err(reader.misread(no_operator(found)));
            };
            let strength = binary.strength();
            // A power is computed from the right.
            self.reduce(if binary == Binary::Power {
                strength + 1
            } else {
                strength + u8::from(strength == COMPARISON)
            });
            if strength == COMPARISON
                && let Some(Pending::Binary(before)) = self.pending.last()
                && before.strength() == COMPARISON
            {
                let expected = match sign {
                    "=" => "'->' (behind ':' a '=' compares)",
                    _ => "one comparison (join two with '&&')",
                };
                return Err(reader.misread(Problem::expected(expected, found)));
            }
            reader.eat(sign);
            self.open(reader, Pending::Binary(binary))?;
            return Ok(true);
        }
    }

    /// The operator that a text begins with, and how it is written there.
    fn sign(&self, rest: &str) -> Option<(Binary, &'static str)> {
        let of_book: &[(Binary, &str)] = if self.is_condition { &PRINTED } else { &[] };
        let mut signs =
            Binary::ALL.map(|binary| (binary, binary.sign())).into_iter().chain(of_book.iter().copied());
        signs.find(|(_, sign)| rest.starts_with(sign))
    }

    /// Begins what waits for the end of its operand.
    fn open(&mut self, reader: &Reader<'_>, pending: Pending) -> Result<(), Misread> {
        if self.pending.len() == MAX_PENDING {
            return Err(reader.misread(Problem::TooManyOpen { limit: MAX_PENDING }));
        }
        self.pending.push(pending);
        Ok(())
    }

    /// Ends the operators that bind at least so strongly, back to the last open bracket.
    fn reduce(&mut self, least: u8) {
        while let Some(pending) = self.pending.last() {
            let token = match *pending {
                Pending::Unary(unary) if PREFIX >= least => Token::Unary(unary),
                Pending::Binary(binary) if binary.strength() >= least => Token::Binary(binary),
                _ => return,
            };
            self.pending.pop();
            self.emit(token);
        }
    }

    fn emit(&mut self, token: Token) {
        self.operands -= match token {
            Token::Binary(_) => 1,
            Token::Call(function) => function.arity() - 1,
            _ => 0,
        };
        // A negative number is a number.
        if token == Token::Unary(Unary::Minus)
            && let Some(Token::Number(number)) = self.tokens.last_mut()
            && number.is_sign_positive()
        {
            *number = -*number;
            return;
        }
        self.tokens.push(token);
    }
}

/// Digits, a point, an exponent.
fn number(reader: &mut Reader<'_>) -> Result<f64, Misread> {
    let rest = reader.rest();
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let mut length = digits(rest);
    if rest[length..].starts_with('.') {
        length += 1 + digits(&rest[length + 1..]);
    }
    if rest[length..].starts_with(['e', 'E']) {
        let sign = usize::from(rest[length + 1..].starts_with(['+', '-']));
        let exponent = digits(&rest[length + 1 + sign..]);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    match rest[..length].parse::<f64>() {
        Ok(number) if number.is_finite() => {
            reader.skip(length);
            Ok(number)
        }
        Ok(value) => Err(reader.misread(Problem::NotFinite { written: excerpt(&rest[..length]), value })),
        Err(_) => Err(reader.misread(Problem::expected("a number", rest.chars().next()))),
    }
}

/// What to say of a function without its brackets.
fn no_bracket(function: &str, found: Option<char>) -> Problem {
    Problem::expected(format!("'(' after the function '{function}', as in {function}(x)"), found)
}

fn unknown_function(name: &str) -> Problem {
    let names = || Function::ALL.iter().map(|function| function.name());
    let hint = match nearest(name, names()) {
        Some(near) => did_you_mean(Some(near)),
        None => format!(" (known: {})", names().collect::<Vec<_>>().join(", ")),
    };
    Problem::UnknownFunction { name: excerpt(name), hint }
}

fn arguments_missing(function: Function, found: usize) -> Problem {
    Problem::WrongArguments { name: function.name(), expected: function.arity(), found }
}

/// What to say where an operator should stand.
pub(in super::super) fn no_operator(found: Option<char>) -> Problem {
    let expected = match found {
        Some('=') => "an operator ('==' compares; behind a condition the arrow is '->')",
        Some('&') => "an operator (is '&&' meant?)",
        Some('|') => "an operator (is '||' meant?)",
        Some('−' | '–') => "an operator (is '-' meant?)",
        Some('·' | '×') => "an operator (is '*' meant?)",
        Some('≤') => "an operator (is '<=' meant?)",
        Some('≥') => "an operator (is '>=' meant?)",
        Some('≠') => "an operator (is '!=' meant?)",
        _ => "an operator, ',' or ')'",
    };
    Problem::expected(expected, found)
}
