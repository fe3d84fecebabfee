//! The whole language by its definition: strings as trees of branches, contexts matched by recursion
//! with every way back, arithmetic on trees. Slow, and shares no code with the library but the random
//! keys. [`Random`] grammars of it are compared with the library.

use std::fmt::Write as _;

use linden::random::Key;

/// Symbols that contexts pass over in every grammar here.
pub const IGNORED: &str = "+-";

#[derive(Clone, Debug)]
pub enum Expr {
    Number(f64),
    /// An index into the rule's parameters.
    Parameter(usize),
    Binary(&'static str, Box<[Expr; 2]>),
    Minus(Box<Expr>),
    Ran(Box<Expr>),
}

impl Expr {
    fn text(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Parameter(index) => format!("p{index}"),
            Self::Binary("min", sides) => format!("min({}, {})", sides[0].text(), sides[1].text()),
            Self::Binary(sign, sides) => format!("({}) {sign} ({})", sides[0].text(), sides[1].text()),
            Self::Minus(inner) => format!("-({})", inner.text()),
            Self::Ran(inner) => format!("ran({})", inner.text()),
        }
    }

    /// `site` counts the random numbers.
    fn value(&self, parameters: &[f64], key: Key, site: &mut u64) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Parameter(index) => parameters[*index],
            Self::Minus(inner) => -inner.value(parameters, key, site),
            Self::Ran(inner) => {
                let most = inner.value(parameters, key, site);
                *site += 1;
                most * key.child(*site - 1).unit()
            }
            Self::Binary(sign, sides) => {
                let a = sides[0].value(parameters, key, site);
                let b = sides[1].value(parameters, key, site);
                let truth = |is: bool| if is { 1.0 } else { 0.0 };
                match *sign {
                    "+" => a + b,
                    "-" => a - b,
                    "*" => a * b,
                    "min" => a.min(b),
                    "<" => truth(a < b),
                    ">=" => truth(a >= b),
                    "==" => truth(a == b),
                    "&&" => truth(a != 0.0 && b != 0.0),
                    "||" => truth(a != 0.0 || b != 0.0),
                    _ => panic!("{sign}"),
                }
            }
        }
    }
}

/// A symbol with a number of parameters, or a branch of such.
#[derive(Clone, Debug)]
pub enum Sought {
    Module(char, usize),
    Branch(Vec<Sought>),
}

/// What a rule writes: symbols with their arguments.
pub type Successor = Vec<(char, Vec<Expr>)>;

#[derive(Clone, Debug)]
pub struct Group {
    pub left: Vec<Sought>,
    pub symbol: char,
    pub arity: usize,
    pub right: Vec<Sought>,
    pub condition: Option<Expr>,
    pub alternatives: Vec<(f64, Successor)>,
}

pub struct Definition {
    pub axiom: Successor,
    pub groups: Vec<Group>,
}

#[derive(Clone, Debug)]
pub struct Letter {
    pub symbol: char,
    pub arguments: Vec<f64>,
    pub birth: u32,
    key: Key,
}

/// A part of an axial tree.
enum GrammarPart<'a> {
    Letter(&'a Letter),
    Branch(Vec<GrammarPart<'a>>),
}

fn sought_text(sought: &[Sought], next: &mut usize) -> String {
    let mut text = String::new();
    for part in sought {
        match part {
            Sought::Module(symbol, arity) => {
                text.push(*symbol);
                let names: Vec<String> = (*next..*next + arity).map(|i| format!("p{i}")).collect();
                *next += arity;
                if !names.is_empty() {
                    let _ = write!(text, "({})", names.join(","));
                }
            }
            Sought::Branch(inner) => {
                let _ = write!(text, "[{}]", sought_text(inner, next));
            }
        }
    }
    text
}

pub fn word_text(word: &[(char, Vec<Expr>)]) -> String {
    let mut text = String::new();
    for (symbol, arguments) in word {
        text.push(*symbol);
        let list: Vec<String> = arguments.iter().map(Expr::text).collect();
        if !list.is_empty() {
            let _ = write!(text, "({})", list.join(", "));
        }
    }
    text
}

impl Group {
    /// The left side; rules with the same one share out their probability.
    pub fn head(&self) -> String {
        let mut next = 0;
        let left = sought_text(&self.left, &mut next);
        let symbol = sought_text(&[Sought::Module(self.symbol, self.arity)], &mut next);
        let right = sought_text(&self.right, &mut next);
        let mut text = if left.is_empty() { symbol } else { format!("{left} < {symbol}") };
        if !right.is_empty() {
            let _ = write!(text, " > {right}");
        }
        if let Some(condition) = &self.condition {
            let _ = write!(text, " : {}", condition.text());
        }
        text
    }
}

impl Definition {
    pub fn rules(&self) -> Vec<String> {
        let mut lines = vec![format!("#ignore {IGNORED}")];
        for group in &self.groups {
            for (probability, word) in &group.alternatives {
                lines.push(format!("{} -> ({probability}) {}", group.head(), word_text(word)));
            }
        }
        lines
    }

    /// The string after some derivations.
    pub fn derive(&self, derivations: u32, seed: u64) -> Vec<Letter> {
        let mut string = without_cut(self.word(&self.axiom, &[], 0, Key::new(seed).named("lsystem")));
        for step in 1..=derivations {
            let mut next = Vec::new();
            let mut place = 0;
            let tree = branches(&string, &mut place);
            self.step(&tree, &mut Vec::new(), step, &mut next);
            string = without_cut(next);
        }
        string
    }

    fn word(&self, word: &[(char, Vec<Expr>)], parameters: &[f64], birth: u32, place: Key) -> Vec<Letter> {
        let mut ordinal = 0;
        let mut site = 0;
        let mut letters = Vec::new();
        for (symbol, arguments) in word {
            let values = arguments.iter().map(|a| a.value(parameters, place.named("random"), &mut site));
            letters.push(Letter {
                symbol: *symbol,
                arguments: values.collect(),
                birth,
                key: place.child(ordinal),
            });
            let is_rewritten = |g: &Group| (g.symbol, g.arity) == (*symbol, arguments.len());
            ordinal += u64::from(self.groups.iter().any(is_rewritten));
        }
        letters
    }

    fn step<'a>(
        &self,
        parts: &[GrammarPart<'a>],
        path: &mut Vec<&'a Letter>,
        step: u32,
        next: &mut Vec<Letter>,
    ) {
        let bracket = |symbol| Letter { symbol, arguments: Vec::new(), birth: 0, key: Key::new(0) };
        for (i, part) in parts.iter().enumerate() {
            match part {
                GrammarPart::Branch(inner) => {
                    next.push(bracket('['));
                    self.step(inner, &mut path.clone(), step, next);
                    next.push(bracket(']'));
                }
                GrammarPart::Letter(letter) => {
                    match self.matching(letter, path, &parts[i + 1..], step) {
                        None => next.push((*letter).clone()),
                        Some((group, parameters)) => {
                            let word = choose(&group.alternatives, letter.key);
                            next.extend(self.word(word, &parameters, step, letter.key));
                        }
                    }
                    if !IGNORED.contains(letter.symbol) {
                        path.push(letter);
                    }
                }
            }
        }
    }

    /// The first group that takes a letter; those with contexts first.
    fn matching(
        &self,
        letter: &Letter,
        path: &[&Letter],
        after: &[GrammarPart<'_>],
        step: u32,
    ) -> Option<(&Group, Vec<f64>)> {
        let mut order: Vec<&Group> = self.groups.iter().collect();
        order.sort_by_key(|group| group.left.is_empty() && group.right.is_empty());
        order.into_iter().find_map(|group| {
            if (group.symbol, group.arity) != (letter.symbol, letter.arguments.len())
                || path.len() < group.left.len()
            {
                return None;
            }
            let mut parameters = Vec::new();
            for (sought, found) in group.left.iter().zip(&path[path.len() - group.left.len()..]) {
                if !is(sought, found) {
                    return None;
                }
                parameters.extend(&found.arguments);
            }
            parameters.extend(&letter.arguments);
            parameters.extend(follows(&group.right, after)?);
            let key = letter.key.named("condition").child(step.into());
            let holds = group.condition.as_ref().is_none_or(|c| c.value(&parameters, key, &mut 0) != 0.0);
            holds.then_some((group, parameters))
        })
    }
}

fn is(sought: &Sought, letter: &Letter) -> bool {
    matches!(sought, Sought::Module(symbol, arity) if (*symbol, *arity) == (letter.symbol, letter.arguments.len()))
}

/// The arguments that a right context finds, by every way there is.
fn follows(sought: &[Sought], parts: &[GrammarPart<'_>]) -> Option<Vec<f64>> {
    let Some((first, others)) = sought.split_first() else { return Some(Vec::new()) };
    for (i, part) in parts.iter().enumerate() {
        match (first, part) {
            (_, GrammarPart::Letter(letter)) if IGNORED.contains(letter.symbol) => {}
            (Sought::Module(..), GrammarPart::Branch(_)) => {}
            (Sought::Branch(_), GrammarPart::Letter(_)) => return None,
            (Sought::Module(..), GrammarPart::Letter(letter)) => {
                if !is(first, letter) {
                    return None;
                }
                let rest = follows(others, &parts[i + 1..])?;
                return Some([letter.arguments.clone(), rest].concat());
            }
            (Sought::Branch(wanted), GrammarPart::Branch(inner)) => {
                if let Some(found) = follows(wanted, inner)
                    && let Some(rest) = follows(others, &parts[i + 1..])
                {
                    return Some([found, rest].concat());
                }
            }
        }
    }
    None
}

/// The tree of a string, up to the end of the branch that begins at `place`.
fn branches<'a>(string: &'a [Letter], place: &mut usize) -> Vec<GrammarPart<'a>> {
    let mut parts = Vec::new();
    while *place < string.len() {
        let letter = &string[*place];
        *place += 1;
        match letter.symbol {
            '[' => parts.push(GrammarPart::Branch(branches(string, place))),
            ']' => return parts,
            _ => parts.push(GrammarPart::Letter(letter)),
        }
    }
    parts
}

fn choose(alternatives: &[(f64, Successor)], key: Key) -> &[(char, Vec<Expr>)] {
    let mut sum = 0.0;
    for (probability, word) in alternatives {
        sum += probability;
        if key.unit() < sum {
            return word;
        }
    }
    panic!("probabilities sum to 1")
}

fn without_cut(string: Vec<Letter>) -> Vec<Letter> {
    let mut kept = Vec::new();
    // How many branches are open since a cut.
    let mut cut: Option<usize> = None;
    for letter in string {
        match (cut, letter.symbol) {
            (None, '%') => cut = Some(0),
            (None, _) | (Some(0), ']') => {
                cut = None;
                kept.push(letter);
            }
            (Some(depth), '[') => cut = Some(depth + 1),
            (Some(depth), ']') => cut = Some(depth - 1),
            (Some(_), _) => {}
        }
    }
    kept
}

pub fn text(string: &[Letter]) -> String {
    let mut text = String::new();
    for letter in string {
        text.push(letter.symbol);
        let list: Vec<String> = letter.arguments.iter().copied().map(number).collect();
        if !list.is_empty() {
            let _ = write!(text, "({})", list.join(","));
        }
    }
    text
}

/// As derived strings show numbers: the shortest digits, very small and very large ones with an exponent.
fn number(number: f64) -> String {
    let plain = number == 0.0 || (1e-6..1e15).contains(&number.abs());
    if plain { number.to_string() } else { format!("{number:e}") }
}

/// Makes grammars up.
pub struct Random {
    key: Key,
    drawn: u64,
    /// Whether rules may look around.
    pub contexts: bool,
    /// Whether `ran` may be used.
    pub chance: bool,
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Self { key: Key::new(seed).named("grammar"), drawn: 0, contexts: true, chance: true }
    }

    fn below(&mut self, end: usize) -> usize {
        self.drawn += 1;
        (self.key.child(self.drawn).unit() * end as f64) as usize
    }

    fn expr(&mut self, parameters: usize, depth: usize) -> Expr {
        match self.below(if depth == 0 { 2 } else { 8 }) {
            0 => Expr::Number(self.below(4) as f64 / 2.0),
            1 if parameters > 0 => Expr::Parameter(self.below(parameters)),
            1 | 2 => Expr::Number(self.below(3) as f64),
            3 => Expr::Minus(Box::new(self.expr(parameters, depth - 1))),
            4 if self.chance => Expr::Ran(Box::new(self.expr(parameters, depth - 1))),
            _ => {
                let sign = ["+", "-", "*", "min"][self.below(4)];
                Expr::Binary(
                    sign,
                    Box::new([self.expr(parameters, depth - 1), self.expr(parameters, depth - 1)]),
                )
            }
        }
    }

    fn condition(&mut self, parameters: usize) -> Expr {
        let sign = ["<", ">=", "==", "&&", "||"][self.below(5)];
        Expr::Binary(sign, Box::new([self.expr(parameters, 1), self.expr(parameters, 1)]))
    }

    fn word(&mut self, parameters: usize, depth: usize) -> Vec<(char, Vec<Expr>)> {
        let mut word = Vec::new();
        for _ in 0..self.below(5) {
            match self.below(12) {
                0 if depth > 0 => {
                    word.push(('[', Vec::new()));
                    word.extend(self.word(parameters, depth - 1));
                    word.push((']', Vec::new()));
                }
                1 => word.push((['+', '-', 'F', '%', '+', '-'][self.below(6)], Vec::new())),
                _ => {
                    let symbol = ['A', 'B', 'C'][self.below(3)];
                    let arguments = (0..self.below(3)).map(|_| self.expr(parameters, 2)).collect();
                    word.push((symbol, arguments));
                }
            }
        }
        word
    }

    fn sought(&mut self, depth: usize) -> Vec<Sought> {
        let count = 1 + self.below(2);
        (0..count)
            .map(|_| {
                if depth > 0 && self.below(3) == 0 {
                    Sought::Branch(self.sought(depth - 1))
                } else {
                    Sought::Module(['A', 'B', 'C', 'F'][self.below(4)], self.below(2))
                }
            })
            .collect()
    }

    pub fn definition(&mut self) -> Definition {
        let mut groups: Vec<Group> = Vec::new();
        for _ in 0..2 + self.below(5) {
            let around = self.contexts;
            let left = if around && self.below(3) == 0 { self.sought(0) } else { Vec::new() };
            let right = if around && self.below(3) == 0 { self.sought(2) } else { Vec::new() };
            let (symbol, arity) = (['A', 'B', 'C', '+'][self.below(4)], self.below(3));
            let arity = if symbol == '+' { 0 } else { arity };
            let parameters = parameters_of(&left) + arity + parameters_of(&right);
            let condition = (self.below(2) == 0).then(|| self.condition(parameters));
            let shares: &[f64] = [&[1.0][..], &[0.25, 0.75], &[0.5, 0.0, 0.5]][self.below(3)];
            let alternatives = shares.iter().map(|&share| (share, self.word(parameters, 2))).collect();
            let group = Group { left, symbol, arity, right, condition, alternatives };
            if groups.iter().all(|other| other.head() != group.head()) {
                groups.push(group);
            }
        }
        let mut axiom = vec![('A', vec![Expr::Number(1.0)]), ('B', Vec::new())];
        axiom.extend(self.word(0, 2));
        axiom.extend(self.word(0, 2));
        Definition { axiom, groups }
    }
}

/// How many parameters a context binds.
fn parameters_of(sought: &[Sought]) -> usize {
    let of = |part: &Sought| match part {
        Sought::Module(_, arity) => *arity,
        Sought::Branch(inner) => parameters_of(inner),
    };
    sought.iter().map(of).sum()
}
