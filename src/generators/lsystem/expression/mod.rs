//! Arithmetic: arguments, conditions and constants.
//!
//! An expression is kept in postfix order, which needs no tree of boxes: parsing, writing, compiling
//! and evaluating are loops, so that no text is deep enough to exhaust the call stack.

pub(super) mod code;
pub(super) mod parse;

use std::fmt;

/// Operands that may wait for their operators at once: more than any hand nests brackets.
pub(super) const MAX_OPERANDS: usize = 32;

/// Signs, brackets, functions and operators that may be open at once. Each of them is one more pass
/// over its operand when the expression is written: a million signs would take a million passes.
pub(super) const MAX_PENDING: usize = 256;

/// An arithmetic expression, as it was written: numbers, parameters, constants of `#define`,
/// operators and functions.
///
/// Comparisons and `&&`, `||`, `!` give 1 or 0; what is not 0 counts as true. Angles are in degrees.
/// Two expressions are equal when they are written alike, blanks and needless brackets apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// In postfix order.
    pub(super) tokens: Vec<Token>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    /// Which of the rule's parameters (left context, predecessor, right context), and its name.
    Parameter(u16, Box<str>),
    /// The value and the name of a `#define`.
    Constant(f64, Box<str>),
    Unary(Unary),
    Binary(Binary),
    Call(Function),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Minus,
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Or,
    And,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

impl Binary {
    /// Longer signs first, so that the first that fits is the one that is meant.
    pub(super) const ALL: [Self; 13] = [
        Self::Or,
        Self::And,
        Self::LessOrEqual,
        Self::GreaterOrEqual,
        Self::Equal,
        Self::Unequal,
        Self::Less,
        Self::Greater,
        Self::Plus,
        Self::Minus,
        Self::Times,
        Self::Over,
        Self::Power,
    ];

    pub(super) fn sign(self) -> &'static str {
        match self {
            Self::Or => "||",
            Self::And => "&&",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
            Self::Equal => "==",
            Self::Unequal => "!=",
            Self::Plus => "+",
            Self::Minus => "-",
            Self::Times => "*",
            Self::Over => "/",
            Self::Power => "^",
        }
    }

    /// How strongly it binds.
    pub(super) fn strength(self) -> u8 {
        match self {
            Self::Or => 1,
            Self::And => 2,
            Self::Plus | Self::Minus => 4,
            Self::Times | Self::Over => 5,
            Self::Power => 7,
            _ => COMPARISON,
        }
    }
}

/// The strength of comparisons, which do not follow on each other.
pub(super) const COMPARISON: u8 = 3;
/// The strength of a sign or `!` before an operand: `-a^2` is `-(a^2)`, as in mathematics.
pub(super) const PREFIX: u8 = 6;
/// The strength of what needs no brackets.
const ATOM: u8 = 8;

macro_rules! functions {
    ($($variant:ident $name:literal $arity:literal;)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Function { $($variant),* }

        impl Function {
            pub(super) const ALL: &[Self] = &[$(Self::$variant),*];

            pub(super) fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            pub(super) fn arity(self) -> usize {
                match self { $(Self::$variant => $arity),* }
            }
        }
    };
}

functions! {
    Abs "abs" 1;
    Floor "floor" 1;
    Ceil "ceil" 1;
    Sqrt "sqrt" 1;
    Exp "exp" 1;
    Log "log" 1;
    Sin "sin" 1;
    Cos "cos" 1;
    Tan "tan" 1;
    Min "min" 2;
    Max "max" 2;
    Pow "pow" 2;
    Ran "ran" 1;
    Nran "nran" 2;
}

impl Function {
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|function| function.name() == name)
    }

    pub(super) fn is_random(self) -> bool {
        matches!(self, Self::Ran | Self::Nran)
    }
}

impl Expression {
    /// A number as it stands.
    pub fn number(number: f64) -> Self {
        Self { tokens: vec![Token::Number(number)] }
    }

    /// The number, when it is nothing but one.
    pub fn as_number(&self) -> Option<f64> {
        if let [Token::Number(number)] = self.tokens[..] { Some(number) } else { None }
    }

    /// Its value, when it needs neither parameters nor chance.
    pub fn constant(&self) -> Option<f64> {
        let depends = |token: &Token| match token {
            Token::Parameter(..) => true,
            Token::Call(function) => function.is_random(),
            _ => false,
        };
        (!self.tokens.iter().any(depends)).then(|| code::constant(self))
    }

    /// Whether it computes the same of the same parameters, whatever they are called.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let same = |(a, b): (&Token, &Token)| match (a, b) {
            (Token::Parameter(a, _), Token::Parameter(b, _)) => a == b,
            // 0 and -0 are written otherwise.
            (Token::Number(a), Token::Number(b)) => a.to_bits() == b.to_bits(),
            _ => a == b,
        };
        self.tokens.len() == other.tokens.len() && self.tokens.iter().zip(&other.tokens).all(same)
    }

    /// Whether chance has a say.
    pub fn is_random(&self) -> bool {
        self.tokens.iter().any(|token| matches!(token, Token::Call(function) if function.is_random()))
    }
}

impl fmt::Display for Expression {
    /// With as few brackets as will be read back as the same expression.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // What is written so far, and how strongly it holds together.
        let mut parts: Vec<(String, u8)> = Vec::new();
        for token in &self.tokens {
            let part = match token {
                Token::Number(number) => {
                    (number.to_string(), if number.is_sign_negative() { PREFIX } else { ATOM })
                }
                Token::Parameter(_, name) | Token::Constant(_, name) => (name.to_string(), ATOM),
                Token::Unary(unary) => {
                    let operand = parts.pop().unwrap_or_default();
                    let sign = if *unary == Unary::Minus { "-" } else { "!" };
                    (format!("{sign}{}", within(operand, PREFIX)), PREFIX)
                }
                Token::Binary(binary) => {
                    let strength = binary.strength();
                    let right = parts.pop().unwrap_or_default();
                    let left = parts.pop().unwrap_or_default();
                    // Equal strengths hold together from the left, powers from the right; comparisons
                    // not at all. A sign before the right side of a power needs no brackets.
                    let [least_left, least_right] = match strength {
                        7 => [ATOM, PREFIX],
                        COMPARISON => [COMPARISON + 1; 2],
                        _ => [strength, strength + 1],
                    };
                    let mut written = within(left, least_left);
                    written.push_str(binary.sign());
                    written.push_str(&within(right, least_right));
                    (written, strength)
                }
                Token::Call(function) => {
                    let first = parts.len().saturating_sub(function.arity());
                    let list: Vec<String> = parts.drain(first..).map(|(written, _)| written).collect();
                    (format!("{}({})", function.name(), list.join(",")), ATOM)
                }
            };
            parts.push(part);
        }
        f.write_str(&parts.pop().unwrap_or_default().0)
    }
}

/// In brackets, unless it holds together at least so strongly.
fn within((written, strength): (String, u8), least: u8) -> String {
    if strength >= least { written } else { format!("({written})") }
}
