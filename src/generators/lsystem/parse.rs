//! From an axiom and rules, as they are written, to a grammar.

use std::collections::BTreeSet;

use super::command::{Command, sign_of_rules};
use super::error::{GrammarError, GrammarPart, Problem};
use super::expression::parse::{Scope, condition, expression, no_operator};
use super::expression::{Expression, Function};
use super::grammar::{Definition, Grammar, Module, Pattern, Production, groups};
use super::reader::{Misread, Reader};
use super::turtle::LARGEST_ORGAN;
use linden_base::knob::excerpt;
use linden_skeleton::organs::prototype;

/// The most parameters of a rule, and arguments of a module.
const MAX_PARAMETERS: usize = 64;

/// How far the probabilities of one predecessor may be from 1 in sum: what thirds written with six
/// decimals need, and a hair for the rounding of the sum.
const PROBABILITY_TOLERANCE: f64 = 1e-6 + 1e-12;

impl Grammar {
    /// Reads an axiom and rules such as `F -> F[+F]F`.
    ///
    /// A rule is `left < predecessor > right : condition -> (probability) successor`; all but the
    /// predecessor and the arrow (`->`, `→`, or `=` where there is no condition) may be missing, and a `*` stands
    /// for a context or a condition that there is not. ABOP's labels `p1 :`, and `ω :` before the axiom, are passed over. The
    /// predecessor and the contexts name their parameters, `A(l,w)`; conditions and arguments are
    /// [expressions](Expression). Rules with a context come before those without one, else the first
    /// that matches is applied; several rules with the same left side make the system stochastic.
    /// What no rule matches is kept. Blanks count for nothing.
    ///
    /// Between the rules may stand `#define name value`, a constant for every rule and for the axiom,
    /// and `#ignore symbols`, which contexts pass over.
    ///
    /// ```
    /// use linden_lsystem::{Grammar, TurtleSettings, derive_string};
    /// // ABOP, section 1.10.2: a signal of growing age, and what it turns into.
    /// let rules = ["#define old 3", "A(x) : x < old -> A(x+1)", "A(x) : x >= old -> F(x^2)"];
    /// let settings = TurtleSettings { derivations: 3, ..TurtleSettings::default() };
    /// assert_eq!(derive_string(&Grammar::new("A(1)", &rules)?, &settings)?, "F(9)");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The first thing that cannot be understood, with its place: directives first, then the axiom,
    /// then the rules.
    pub fn new<R: AsRef<str>>(axiom: &str, rules: &[R]) -> Result<Self, GrammarError> {
        let mut context = Context::default();
        let mut definitions = Vec::new();
        let mut ignored = Vec::new();
        let lines = || rules.iter().map(AsRef::as_ref).enumerate();
        let words = || lines().map(|(_, line)| line).filter(|line| !is_directive(line)).chain([axiom]);
        context.cuts = words().any(|word| word.contains('%'));
        context.names_organs = words().any(|word| word.chars().any(|symbol| prototype(symbol).is_some()));
        for (i, line) in lines() {
            if !is_directive(line) {
                context.rewritten.extend(rewritten(line));
                continue;
            }
            match directive(line, &context).map_err(|e| e.within(GrammarPart::Rule(i), line))? {
                Directive::Define(definition, value) => {
                    context.constants.push((definition.name.clone(), value));
                    definitions.push(definition);
                }
                Directive::Ignore(symbols) => ignored.extend(symbols),
            }
        }
        let modules = self::axiom(axiom, &context).map_err(|e| e.within(GrammarPart::Axiom, axiom))?;
        let mut places = Vec::new();
        let mut productions = Vec::new();
        for (i, line) in lines().filter(|(_, line)| !is_directive(line)) {
            productions.push(rule(line, &context).map_err(|e| e.within(GrammarPart::Rule(i), line))?);
            places.push(i);
        }
        check_probabilities(&productions, &places)?;
        Ok(Self { axiom: modules, definitions, ignored, productions })
    }
}

/// `places` are the lines of the productions.
fn check_probabilities(productions: &[Production], places: &[usize]) -> Result<(), GrammarError> {
    for group in groups(productions) {
        let sum: f64 = group.iter().map(|&i| productions[i].probability).sum();
        if (sum - 1.0).abs() > PROBABILITY_TOLERANCE {
            let predecessor = excerpt(&productions[group[0]].head());
            let another = group.get(1).map(|&i| excerpt(&productions[i].to_string()));
            let is_unwritten = group.len() > 1
                && group.iter().all(|&i| productions[i].probability == 1.0)
                && group.iter().all(|&i| productions[i].written_probability.is_none());
            let unwritten = if is_unwritten { group.len() } else { 0 };
            return Err(GrammarError {
                part: GrammarPart::Rule(places[group[0]]),
                offset: 0,
                column: 1,
                problem: Problem::Probabilities { predecessor, sum, another, unwritten },
            });
        }
    }
    Ok(())
}

/// What a grammar's strings may refer to.
#[derive(Default)]
pub(super) struct Context {
    /// Names and values of the `#define`s so far.
    pub constants: Vec<(String, f64)>,
    /// Symbols and numbers of parameters that some rule rewrites: their arguments are in range when
    /// they are drawn, and not before.
    pub rewritten: BTreeSet<(char, usize)>,
    /// Whether a `%` stands anywhere, which may take away what is wrong before it is drawn.
    pub cuts: bool,
    /// Whether the letter of an organ stands anywhere.
    pub names_organs: bool,
}

impl Context {
    /// Whether a symbol stays as it is, wherever it stands.
    fn stays(&self, symbol: char, arguments: usize) -> bool {
        !self.cuts && !self.rewritten.contains(&(symbol, arguments))
    }

    fn scope<'a>(&'a self, parameters: &'a [String]) -> Scope<'a> {
        Scope { parameters, constants: &self.constants }
    }
}

/// A line that begins with `#`.
pub(super) enum Directive {
    Define(Definition, f64),
    Ignore(Vec<char>),
}

/// Whether a line is a directive rather than a rule.
pub(super) fn is_directive(text: &str) -> bool {
    text.trim_start().starts_with('#')
}

/// Reads an axiom: at least one module.
pub(super) fn axiom(text: &str, context: &Context) -> Result<Vec<Module>, Misread> {
    let mut reader = Reader::new(text);
    reader.eat_axiom_label();
    let modules = reader.modules(context, &[])?;
    match modules.last() {
        None => Err(reader.misread(Problem::expected("a symbol", None))),
        Some(last) if last.symbol == '~' && context.stays('~', 0) => {
            Err(reader.misread(Problem::NoOrgan { found: None }))
        }
        Some(_) => Ok(modules),
    }
}

/// Reads `left < predecessor > right : condition -> (probability) successor`.
pub(super) fn rule(text: &str, context: &Context) -> Result<Production, Misread> {
    let mut reader = Reader::new(text);
    let head = reader.head()?;
    let mut parameters: Vec<String> = Vec::new();
    for (offset, name) in head.names {
        if parameters.contains(&name) {
            return Err(Misread { offset, problem: Problem::Redefined { name } });
        }
        parameters.push(name);
    }
    if parameters.len() > MAX_PARAMETERS {
        return Err(reader.misread(Problem::TooManyParameters { limit: MAX_PARAMETERS }));
    }
    let condition = if reader.eat(":") { reader.condition(context.scope(&parameters))? } else { None };
    let found = reader.peek();
    reader.check_arrow()?;
    if !reader.eat_arrow() {
        return Err(reader.misread(Problem::expected("'->' or '→'", found)));
    }
    let (probability, written_probability) = reader.probability(context)?;
    let successor = reader.modules(context, &parameters)?;
    let Head { left, predecessor, right } = head.patterns;
    Ok(Production { left, predecessor, right, condition, probability, written_probability, successor })
}

/// The symbol and the number of parameters of what a rule rewrites; `None` when that cannot be read.
pub(super) fn rewritten(text: &str) -> Option<(char, usize)> {
    let head = Reader::new(text).head().ok()?;
    Some(head.patterns.predecessor.class())
}

/// Reads `#define name value` or `#ignore symbols`.
pub(super) fn directive(text: &str, context: &Context) -> Result<Directive, Misread> {
    let mut reader = Reader::new(text);
    reader.eat("#");
    let start = reader.clone();
    match reader.name() {
        "define" => {
            reader.peek();
            let place = reader.clone();
            let name = reader.name();
            if name.is_empty() {
                let found = reader.peek();
                return Err(reader.misread(Problem::expected("a name, as in '#define r 0.9'", found)));
            }
            if Function::named(name).is_some() {
                return Err(place.misread(Problem::expected(
                    format!("a name of your own ('{name}' is a function)"),
                    name.chars().next(),
                )));
            }
            if context.constants.iter().any(|(known, _)| known == name) {
                return Err(place.misread(Problem::Redefined { name: name.to_owned() }));
            }
            reader.peek();
            let value_place = reader.clone();
            let value = expression(&mut reader, context.scope(&[]))?;
            if let Some(found) = reader.peek() {
                return Err(reader.misread(Problem::expected("the end of the line", Some(found))));
            }
            let number = value_place.constant(&value, &reader, [f64::MIN, f64::MAX])?;
            Ok(Directive::Define(Definition { name: name.to_owned(), value }, number))
        }
        "ignore" => {
            // ABOP writes it with a colon.
            reader.eat(":");
            let mut symbols = Vec::new();
            while let Some(symbol) = reader.peek() {
                reader.rewritable(symbol, "a symbol that can be ignored (brackets and '%' cannot)")?;
                reader.skip(symbol.len_utf8());
                symbols.push(symbol);
            }
            Ok(Directive::Ignore(symbols))
        }
        name => {
            let found = excerpt(&format!("#{name}"));
            let expected = match name {
                "consider" => "'#ignore' with the symbols that contexts pass over, all but those to consider",
                _ => "'#define name value' or '#ignore symbols'",
            }
            .to_owned();
            Err(Misread {
                offset: start.offset - 1,
                problem: Problem::Expected { expected, found: format!("'{found}'") },
            })
        }
    }
}

/// The left side of a rule, up to its condition.
struct Head {
    left: Vec<Pattern>,
    predecessor: Pattern,
    right: Vec<Pattern>,
}

struct ReadHead {
    patterns: Head,
    /// All parameters in order, and where they stand.
    names: Vec<(usize, String)>,
}

impl Reader<'_> {
    /// Refuses what no rule can rewrite and no context can hold.
    fn rewritable(&self, symbol: char, expected: &str) -> Result<Command, Misread> {
        match Command::of(symbol) {
            Some(Command::Push | Command::Pop | Command::Cut) => {
                Err(self.misread(Problem::expected(expected, Some(symbol))))
            }
            Some(command) => Ok(command),
            None => Err(self.misread(stray(symbol, "a symbol"))),
        }
    }

    fn head(&mut self) -> Result<ReadHead, Misread> {
        self.eat_rule_label();
        let Some(first) = self.peek() else {
            return Err(self.misread(Problem::expected("a symbol and an arrow, as in 'F -> FF'", None)));
        };
        let mut names = Vec::new();
        let (left, predecessor) = if self.eat_empty_left() {
            (Vec::new(), self.predecessor(&mut names)?)
        } else {
            self.rewritable(first, "a symbol that can be rewritten (brackets and '%' cannot)")?;
            // The first symbols are the left context where a '<' follows, else the predecessor alone.
            let mut patterns = vec![self.pattern(&mut names)?];
            let after_first = self.clone();
            while !self.arrow_ahead()
                && self.peek().is_some_and(|c| Command::of(c).is_some() && !matches!(c, '[' | ']' | '%'))
            {
                patterns.push(self.pattern(&mut names)?);
            }
            if self.eat("<") {
                (patterns, self.predecessor(&mut names)?)
            } else {
                if patterns.len() > 1 {
                    *self = after_first;
                }
                (Vec::new(), patterns.swap_remove(0))
            }
        };
        let right =
            if !self.arrow_ahead() && self.eat(">") { self.right_context(&mut names)? } else { Vec::new() };
        let found = self.peek();
        self.check_arrow()?;
        if !self.arrow_ahead() && found != Some(':') {
            let problem = match found {
                Some(sign @ ('<' | '>')) => stray(sign, "an arrow"),
                _ => Problem::expected(format!("'->', '→' or '=' after '{}'", predecessor.symbol), found),
            };
            return Err(self.misread(problem));
        }
        Ok(ReadHead { patterns: Head { left, predecessor, right }, names })
    }

    fn arrow_ahead(&mut self) -> bool {
        self.clone().eat_arrow()
    }

    /// Passes over `* <`: any left context (ABOP).
    fn eat_empty_left(&mut self) -> bool {
        let mut ahead = self.clone();
        let found = ahead.eat("*") && ahead.eat("<");
        if found {
            *self = ahead;
        }
        found
    }

    /// What stands behind the `<` of a left context.
    fn predecessor(&mut self, names: &mut Vec<(usize, String)>) -> Result<Pattern, Misread> {
        let Some(symbol) = self.peek() else {
            return Err(self.misread(Problem::expected("the symbol to rewrite", None)));
        };
        self.rewritable(symbol, "the symbol to rewrite (brackets and '%' cannot)")?;
        self.pattern(names)
    }

    /// Patterns with balanced brackets, up to a condition or an arrow; none for a `*` alone (ABOP).
    fn right_context(&mut self, names: &mut Vec<(usize, String)>) -> Result<Vec<Pattern>, Misread> {
        let mut ahead = self.clone();
        if ahead.eat("*") && (ahead.peek() == Some(':') || ahead.arrow_ahead()) {
            *self = ahead;
            return Ok(Vec::new());
        }
        let mut patterns = Vec::new();
        let mut open = Vec::new();
        while let Some(symbol) = self.peek() {
            if symbol == ':' || self.arrow_ahead() {
                break;
            }
            match symbol {
                '[' => open.push(self.offset),
                ']' if open.pop().is_none() => return Err(self.misread(Problem::Unopened)),
                ']' => {}
                _ => {
                    self.rewritable(symbol, "a symbol of the right context")?;
                }
            }
            patterns.push(self.pattern(names)?);
        }
        if let Some(offset) = open.pop() {
            return Err(Misread { offset, problem: Problem::Unclosed });
        }
        if patterns.is_empty() {
            let found = self.peek();
            return Err(self.misread(Problem::expected("the right context", found)));
        }
        Ok(patterns)
    }

    /// A symbol with the names of its parameters.
    fn pattern(&mut self, names: &mut Vec<(usize, String)>) -> Result<Pattern, Misread> {
        let Some(symbol) = self.peek() else {
            return Err(self.misread(Problem::expected("a symbol", None)));
        };
        let command = Command::of(symbol).unwrap_or(Command::Silent);
        self.offset += symbol.len_utf8();
        let mut parameters = Vec::new();
        if self.peek() == Some('(') {
            self.takes_arguments(symbol, command)?;
            self.offset += 1;
            loop {
                let found = self.peek();
                let place = self.offset;
                let name = self.name();
                if name.is_empty() {
                    return Err(self.misread(Problem::expected("the name of a parameter", found)));
                }
                if Function::named(name).is_some() {
                    let expected = format!("the name of a parameter ('{name}' is a function)");
                    return Err(Misread { offset: place, problem: Problem::expected(expected, found) });
                }
                names.push((place, name.to_owned()));
                parameters.push(name.to_owned());
                if !self.eat(",") {
                    break;
                }
            }
            self.close()?;
        }
        Ok(Pattern { symbol, parameters })
    }

    fn close(&mut self) -> Result<(), Misread> {
        if self.eat(")") {
            return Ok(());
        }
        let found = self.peek();
        Err(self.misread(Problem::expected("')'", found)))
    }

    fn takes_arguments(&self, symbol: char, command: Command) -> Result<(), Misread> {
        if command.takes_arguments() {
            return Ok(());
        }
        Err(self.misread(Problem::expected(format!("no number after '{symbol}'"), Some('('))))
    }

    /// What stands behind the colon; `*` is always true (ABOP).
    fn condition(&mut self, scope: Scope<'_>) -> Result<Option<Expression>, Misread> {
        let mut ahead = self.clone();
        if ahead.eat("*") {
            let found = ahead.peek();
            if found.is_none() || ahead.at_arrow() {
                *self = ahead;
                return Ok(None);
            }
            ahead.check_arrow()?;
            if found == Some('=') {
                return Err(ahead.misread(no_operator(found)));
            }
        }
        self.peek();
        let place = self.clone();
        let condition = condition(self, scope)?;
        if let Some(found @ (')' | ',')) = self.peek() {
            return Err(self.misread(Problem::expected("'->' or '→'", Some(found))));
        }
        if condition.constant().is_some() {
            place.constant(&condition, self, [f64::MIN, f64::MAX])?;
        }
        Ok(Some(condition))
    }

    /// The probability in brackets before a successor, 1 when there is none; and how it was written.
    fn probability(&mut self, context: &Context) -> Result<(f64, Option<Expression>), Misread> {
        if !self.eat("(") {
            return Ok((1.0, None));
        }
        self.peek();
        let place = self.clone();
        let written = expression(self, context.scope(&[]))?;
        let value = place.constant(&written, self, [0.0, 1.0])?;
        self.close()?;
        let plain = written.as_number().is_some();
        Ok((value, (!plain).then_some(written)))
    }

    /// The value of an expression that was read from here up to `end`, within a range.
    fn constant(&self, expression: &Expression, end: &Self, [min, max]: [f64; 2]) -> Result<f64, Misread> {
        let written = excerpt(self.text[self.offset..end.offset].trim_end());
        let Some(value) = expression.constant() else {
            return Err(self.misread(Problem::NotConstant { written }));
        };
        if min <= value && value <= max {
            return Ok(value);
        }
        if !value.is_finite() {
            return Err(self.misread(Problem::NotFinite { written, value }));
        }
        let plain = expression.as_number().is_some();
        let number = if plain { written } else { format!("{written} = {value}") };
        Err(self.misread(Problem::OutOfRange { number, min, max }))
    }

    /// Modules to the end of the text, their brackets balanced.
    fn modules(&mut self, context: &Context, parameters: &[String]) -> Result<Vec<Module>, Misread> {
        let mut modules = Vec::new();
        let mut open = Vec::new();
        // Whether a `~` stands before that is drawn as it is.
        let mut is_placing = false;
        while let Some(symbol) = self.peek() {
            let Some(command) = Command::of(symbol) else {
                return Err(self.misread(stray(symbol, "a symbol")));
            };
            match command {
                Command::Push => open.push(self.offset),
                Command::Pop if open.pop().is_none() => return Err(self.misread(Problem::Unopened)),
                _ => {}
            }
            let place = self.offset;
            self.offset += symbol.len_utf8();
            let is_organ = is_placing && prototype(symbol).is_some();
            let range = if is_organ { Some([0.0, LARGEST_ORGAN]) } else { command.argument_range() };
            let arguments = self.arguments(symbol, (command, range), context, parameters)?;
            if is_placing && !is_organ && context.stays(symbol, arguments.len()) {
                return Err(Misread { offset: place, problem: Problem::NoOrgan { found: Some(symbol) } });
            }
            is_placing = command == Command::Organ && context.stays(symbol, 0);
            modules.push(Module { symbol, arguments });
        }
        match open.pop() {
            Some(offset) => Err(Misread { offset, problem: Problem::Unclosed }),
            None if is_placing && !context.names_organs => {
                Err(self.misread(Problem::NoOrgan { found: None }))
            }
            None => Ok(modules),
        }
    }

    /// What stands in brackets after a symbol. `range` is that of the first where it is drawn.
    fn arguments(
        &mut self,
        symbol: char,
        (command, range): (Command, Option<[f64; 2]>),
        context: &Context,
        parameters: &[String],
    ) -> Result<Vec<Expression>, Misread> {
        if self.peek() != Some('(') {
            return Ok(Vec::new());
        }
        self.takes_arguments(symbol, command)?;
        self.offset += 1;
        let mut arguments = Vec::new();
        let mut places = Vec::new();
        loop {
            self.peek();
            let start = self.clone();
            arguments.push(expression(self, context.scope(parameters))?);
            places.push((start, self.clone()));
            if arguments.len() > MAX_PARAMETERS {
                return Err(self.misread(Problem::TooManyParameters { limit: MAX_PARAMETERS }));
            }
            if !self.eat(",") {
                break;
            }
        }
        self.close()?;
        for (i, ((start, end), argument)) in places.iter().zip(&arguments).enumerate() {
            if argument.constant().is_none() {
                continue;
            }
            let is_drawn = i == 0 && !context.rewritten.contains(&(symbol, arguments.len()));
            let range = range.filter(|_| is_drawn);
            start.constant(argument, end, range.unwrap_or([f64::MIN, f64::MAX]))?;
        }
        Ok(arguments)
    }
}

/// What to say about a character that is no symbol.
fn stray(found: char, expected: &str) -> Problem {
    match (sign_of_rules(found), found) {
        (Some(what), _) => Problem::Misplaced { sign: found, what },
        (None, '−' | '–') => Problem::expected(format!("{expected} (is '-' meant?)"), Some(found)),
        (None, '’' | '‘' | '´' | '`') => {
            Problem::expected(format!("{expected} (is ''' meant?)"), Some(found))
        }
        (None, _) => Problem::expected(expected, Some(found)),
    }
}
