//! The text format of an older tree program, read unchanged.
//!
//! ```text
//! // tree A
//! axiom=F
//! angle=25.7
//! number of derivations=3
//! F=(1)F[+F]F[-F]F
//! ```
//!
//! A line is empty, a comment (`//` at its beginning: further on, `//` is two rolls), one of the
//! three keys, each exactly once, or a rule as [`Grammar::new`] reads it, its probability in
//! brackets. What stands between `/*` and `*/` is a comment anywhere, and `ω: F` an axiom, as ABOP has it.
//! Either line ending, a byte-order mark and blanks around anything are accepted.
//!
//! The same lines without the two numbers are a grammar as people edit it: [`write_grammar`] and
//! [`parse_grammar`].

use std::borrow::Cow;

use super::error::{GrammarPart, Problem};
use super::grammar::Grammar;
use super::reader::Reader;
use super::turtle_settings::{ANGLE_RANGE_DEG, MAX_DERIVATIONS};
use linden_base::knob::{excerpt, nearest};

/// The content of a file of the older format.
#[derive(Clone, Debug, PartialEq)]
pub struct TextGrammar {
    /// Axiom and rules.
    pub grammar: Grammar,
    /// Degrees.
    pub angle_deg: f64,
    /// Derivation steps.
    pub derivations: u32,
    /// The comments after `//`, trimmed, in order. From outside: show them through
    /// [`printable`](linden_base::knob::printable).
    pub comments: Vec<String>,
    /// What the text says and hardly means, with its line: for people.
    pub notes: Vec<String>,
}

/// A text that is not of the older format, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {problem}")]
pub struct ParseError {
    /// From 1.
    pub line: usize,
    /// In characters, from 1.
    pub column: usize,
    /// The mistake.
    #[source]
    pub problem: Problem,
}

/// A piece of a line, and where it stands.
#[derive(Clone, Copy)]
struct Piece<'a> {
    text: &'a str,
    line: usize,
    column: usize,
}

impl<'a> Piece<'a> {
    /// Without blanks around it.
    fn trim(self) -> Self {
        let text = self.text.trim_start();
        let blanks = self.text[..self.text.len() - text.len()].chars().count();
        Self { text: text.trim_end(), column: self.column + blanks, ..self }
    }

    /// The axiom of a line that gives one.
    fn axiom(self) -> Option<Piece<'a>> {
        self.value_of(AXIOM).or_else(|| self.labelled_axiom())
    }

    /// The axiom of the line `ω: F`. What has an arrow is a rule for ω under a condition.
    fn labelled_axiom(self) -> Option<Piece<'a>> {
        let has_arrow = self.text.contains("->") || self.text.contains(['→', '=']);
        (!has_arrow && Reader::new(self.text).eat_axiom_label()).then_some(self)
    }

    /// What to say of a rule that seems to end in a comment.
    fn comment_note(self) -> Option<String> {
        let (_, behind) = self.text.split_once("// ")?;
        let mut words = behind.split(|c: char| !c.is_lowercase());
        words.any(|word| word.chars().count() > 2).then(|| {
            format!(
                "line {}: '//' within a rule rolls twice; a comment stands on a line of its own",
                self.line
            )
        })
    }

    /// What stands after `=`, when the text before it is `key`.
    fn value_of(self, key: &str) -> Option<Piece<'a>> {
        let (before, after) = self.text.split_once('=')?;
        let column = self.column + before.chars().count() + 1;
        (before.trim_end() == key).then(|| Self { text: after, column, ..self }.trim())
    }

    fn error(self, problem: Problem) -> ParseError {
        ParseError { line: self.line, column: self.column, problem }
    }

    /// A number from `min` to `max`.
    fn real(self, [min, max]: [f64; 2]) -> Result<f64, ParseError> {
        match self.text.parse() {
            Ok(number) if min <= number && number <= max => Ok(number),
            Ok(_) => Err(self.out_of_range(min, max)),
            Err(_) => Err(self.expected("a number")),
        }
    }

    /// A whole number from 0 to `max`.
    fn whole(self, max: u32) -> Result<u32, ParseError> {
        let digits = self.text.strip_prefix('-').unwrap_or(self.text);
        if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
            return Err(self.expected("a whole number"));
        }
        let number = self.text.parse().ok().filter(|&number| number <= max);
        number.ok_or_else(|| self.out_of_range(0.0, max.into()))
    }

    fn expected(self, expected: &str) -> ParseError {
        let found = if self.text.is_empty() { "the end".into() } else { format!("'{}'", excerpt(self.text)) };
        self.error(Problem::Expected { expected: expected.into(), found })
    }

    fn out_of_range(self, min: f64, max: f64) -> ParseError {
        self.error(Problem::OutOfRange { number: excerpt(self.text), min, max })
    }
}

const AXIOM: &str = "axiom";
const ANGLE: &str = "angle";
const DERIVATIONS: &str = "number of derivations";
const LINES: &str = "'axiom=', 'angle=', 'number of derivations=', a comment '//' or a rule 'F -> …'";
const GRAMMAR_LINES: &str =
    "'axiom = …', a rule 'F -> …' or a comment '//' (angle and derivations are knobs of their own)";

/// Reads a text of the older format.
///
/// # Errors
/// The first thing that cannot be understood, with its place: an unknown line, a repeated or missing
/// key, a number out of range, or what [`Grammar::new`] refuses.
pub fn parse(text: &str) -> Result<TextGrammar, ParseError> {
    let mut axiom = None;
    let mut angle = None;
    let mut derivations = None;
    let mut rules = Vec::new();
    let mut comments = Vec::new();
    let mut notes = Vec::new();
    let mut last_line = 1;
    let text = without_comments(text)?;
    for line in lines(&text) {
        last_line = line.line;
        if let Some(comment) = line.text.strip_prefix("//") {
            comments.push(comment.trim().to_owned());
        } else if let Some(value) = line.axiom() {
            once(&mut axiom, AXIOM, line, value)?;
        } else if let Some(value) = line.value_of(ANGLE) {
            once(&mut angle, ANGLE, line, value)?;
        } else if let Some(value) = line.value_of(DERIVATIONS) {
            once(&mut derivations, DERIVATIONS, line, value)?;
        } else if !line.text.is_empty() {
            if is_word(line.text) {
                return Err(line.expected(&format!("{LINES}{}", key_meant(line.text))));
            }
            notes.extend(line.comment_note());
            rules.push(line);
        }
    }
    // What is wrong in a line comes before a line that is not there.
    let angle_deg = angle.map(|angle| angle.real(ANGLE_RANGE_DEG)).transpose()?;
    let count = derivations.map(|derivations| derivations.whole(MAX_DERIVATIONS)).transpose()?;
    let grammar = axiom.map(|axiom| grammar(axiom, &rules)).transpose()?;
    // All of them in one error: a file is mended once.
    let known = [grammar.is_some(), angle_deg.is_some(), count.is_some()];
    let (Some(grammar), Some(angle_deg), Some(derivations)) = (grammar, angle_deg, count) else {
        let all = [(AXIOM, "F"), (ANGLE, "25"), (DERIVATIONS, "4")];
        let keys = all.into_iter().zip(known).filter(|(_, known)| !known).map(|(key, _)| key).collect();
        return Err(ParseError { line: last_line, column: 1, problem: Problem::Missing { keys } });
    };
    Ok(TextGrammar { grammar, angle_deg, derivations, comments, notes })
}

/// What key may have been meant by a line that has none.
fn key_meant(line: &str) -> String {
    let typed = line.split('=').next().unwrap_or_default().trim();
    let of_steps = ["derivations", "derivation", "iterations", "steps", "n"];
    let near = if of_steps.contains(&typed) {
        Some(DERIVATIONS)
    } else {
        nearest(typed, [AXIOM, ANGLE, DERIVATIONS])
    };
    near.map(|key| format!(" (is '{key}=' meant?)")).unwrap_or_default()
}

/// A grammar as people edit it: `axiom = F`, then a rule a line.
///
/// ```
/// use linden_lsystem::{Grammar, text::{parse_grammar, write_grammar}};
/// let grammar = Grammar::new("X", &["X -> F[+X]F[-X]+X", "F -> FF"])?;
/// let text = write_grammar(&grammar);
/// assert_eq!(text, "axiom = X\nX -> F[+X]F[-X]+X\nF -> FF\n");
/// assert_eq!(parse_grammar(&text)?, grammar);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_grammar(grammar: &Grammar) -> String {
    format!("{AXIOM} = {grammar}")
}

/// Reads a grammar as people edit it: an axiom, rules, comments and empty lines in any order.
///
/// # Errors
/// The first thing that cannot be understood, with its place: an unknown line, a repeated or missing
/// axiom, or what [`Grammar::new`] refuses.
pub fn parse_grammar(text: &str) -> Result<Grammar, ParseError> {
    let mut axiom = None;
    let mut rules = Vec::new();
    let text = without_comments(text)?;
    for line in lines(&text) {
        if line.text.is_empty() || line.text.starts_with("//") {
            continue;
        }
        if let Some(value) = line.axiom() {
            once(&mut axiom, AXIOM, line, value)?;
        } else if is_word(line.text) {
            return Err(line.expected(GRAMMAR_LINES));
        } else {
            rules.push(line);
        }
    }
    let missing = ParseError { line: 1, column: 1, problem: Problem::Missing { keys: vec![(AXIOM, "F")] } };
    grammar(axiom.ok_or(missing)?, &rules)
}

/// The lines of a text without the blanks around them.
fn lines(text: &str) -> impl Iterator<Item = Piece<'_>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.lines().enumerate().map(|(i, text)| Piece { text, line: i + 1, column: 1 }.trim())
}

/// A text with blanks in place of what stands between `/*` and `*/`, so that all places stay what they are.
fn without_comments(text: &str) -> Result<Cow<'_, str>, ParseError> {
    if !text.contains("/*") {
        return Ok(text.into());
    }
    let mut blanked = String::with_capacity(text.len());
    // Where the comment began that is open.
    let mut open: Option<Piece<'_>> = None;
    for (number, line) in text.split_inclusive('\n').enumerate() {
        let mut rest = line;
        loop {
            let is_open = open.is_some();
            let is_remark = !is_open && line.trim_start().starts_with("//");
            let sign = if is_open { "*/" } else { "/*" };
            let Some((before, behind)) = rest.split_once(sign).filter(|_| !is_remark) else {
                blank(&mut blanked, rest, is_open);
                break;
            };
            blank(&mut blanked, before, is_open);
            blanked.push_str("  ");
            let column = line[..line.len() - behind.len() - sign.len()].chars().count() + 1;
            open = (!is_open).then_some(Piece { text: sign, line: number + 1, column });
            rest = behind;
        }
    }
    match open {
        Some(begin) => Err(begin.error(Problem::expected("a '*/' that ends the comment", None))),
        None => Ok(blanked.into()),
    }
}

/// Adds a piece of a text, as blanks where it is in a comment.
fn blank(blanked: &mut String, piece: &str, is_comment: bool) {
    let shown = |c: char| if is_comment && c != '\n' { ' ' } else { c };
    blanked.extend(piece.chars().map(shown));
}

/// Keeps a key's value, unless it has one.
fn once<'a>(
    slot: &mut Option<Piece<'a>>,
    key: &'static str,
    line: Piece<'a>,
    value: Piece<'a>,
) -> Result<(), ParseError> {
    match slot.replace(value) {
        None => Ok(()),
        Some(first) => Err(line.error(Problem::Repeated { key, first_line: first.line })),
    }
}

/// Whether a line is an unknown key, `leaves=3`, or plain words: not a rule.
fn is_word(line: &str) -> bool {
    let (first, sign) = match line.find(['=', '→', '(', '<', '>', ':']) {
        Some(end) => line.split_at(end),
        None => (line, ""),
    };
    let first = first.trim_end();
    // 'F FF' lacks an arrow.
    if sign.is_empty() && first.chars().nth(1) == Some(' ') {
        return false;
    }
    // What else of a rule comes before a sign is a context or an arrow.
    matches!(sign.chars().next(), None | Some('='))
        && first.chars().count() > 1
        && first.chars().all(|c| c.is_alphanumeric() || c == ' ')
}

fn grammar(axiom: Piece<'_>, rules: &[Piece<'_>]) -> Result<Grammar, ParseError> {
    let texts: Vec<&str> = rules.iter().map(|rule| rule.text).collect();
    Grammar::new(axiom.text, &texts).map_err(|error| {
        let piece = match error.part {
            GrammarPart::Axiom => axiom,
            GrammarPart::Rule(index) => rules[index],
        };
        ParseError { line: piece.line, column: piece.column + error.column - 1, problem: error.problem }
    })
}
