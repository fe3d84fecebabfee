//! L-systems by their definition: whole strings rewritten breadth first, and a turtle that turns its
//! frame by rotation matrices. Slow, and shares no code with the library but the random keys.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::rc::Rc;

use linden::lsystem::TurtleSettings;
use linden::random::Key;
use linden::{Branching, DVec3, Edge, NO_PARENT};

/// Predecessor → (probability, successor).
pub type Rules = BTreeMap<char, Vec<(f64, String)>>;

/// A symbol of the string with the step that wrote it and the path of its choices.
#[derive(Clone, Copy)]
pub struct Letter {
    pub symbol: char,
    pub birth: u32,
    key: Key,
}

/// The rules as [`Grammar::new`](linden::lsystem::Grammar::new) takes them.
pub fn written(rules: &Rules) -> Vec<String> {
    let of = |(symbol, list): (&char, &Vec<(f64, String)>)| -> Vec<String> {
        list.iter().map(|(p, successor)| format!("{symbol} -> ({p}) {successor}")).collect()
    };
    rules.iter().flat_map(of).collect()
}

/// The string after some derivations.
pub fn derive(axiom: &str, rules: &Rules, settings: &TurtleSettings) -> Vec<Letter> {
    let mut string = word(axiom, rules, 0, Key::new(settings.seed).named("lsystem"));
    for step in 1..=settings.derivations {
        let mut next = Vec::new();
        for letter in without_cut(&string) {
            match rules.get(&letter.symbol) {
                None => next.push(letter),
                Some(list) => next.extend(word(choose(list, letter.key), rules, step, letter.key)),
            }
        }
        string = next;
    }
    without_cut(&string)
}

pub fn text(string: &[Letter]) -> String {
    string.iter().map(|letter| letter.symbol).collect()
}

fn word(text: &str, rules: &Rules, birth: u32, key: Key) -> Vec<Letter> {
    let mut ordinal = 0;
    text.chars()
        .map(|symbol| {
            let letter = Letter { symbol, birth, key: key.child(ordinal) };
            ordinal += u64::from(rules.contains_key(&symbol));
            letter
        })
        .collect()
}

fn choose(list: &[(f64, String)], key: Key) -> &str {
    let mut sum = 0.0;
    let unit = key.unit();
    for (probability, successor) in list {
        sum += probability;
        if unit < sum {
            return successor;
        }
    }
    // Only rounding leads here: to the last rule that is possible.
    list.iter().rev().find(|(p, _)| *p > 0.0).map(|(_, s)| s.as_str()).unwrap()
}

/// ABOP: `a[b%[cd]e[%f]]g[h[%i]j]k` becomes `a[b]g[h[]j]k`.
pub fn without_cut(string: &[Letter]) -> Vec<Letter> {
    let mut kept = Vec::new();
    let mut i = 0;
    while i < string.len() {
        if string[i].symbol == '%' {
            let mut depth = 0;
            while i < string.len() && (depth > 0 || string[i].symbol != ']') {
                depth += i32::from(string[i].symbol == '[') - i32::from(string[i].symbol == ']');
                i += 1;
            }
        } else {
            kept.push(string[i]);
            i += 1;
        }
    }
    kept
}

#[derive(Clone)]
struct State {
    position: DVec3,
    heading: DVec3,
    left: DVec3,
    up: DVec3,
    /// The node here, shared by all who stand here.
    node: Rc<Cell<Option<u32>>>,
    /// The bracket in which that node was drawn, by its place in the string; 0 outside all.
    bracket: usize,
}

impl State {
    /// Turns the frame about an axis, by Rodrigues' formula. An axis that is not quite a unit vector
    /// would make errors grow with every turn.
    fn turn(&mut self, axis: DVec3, degrees: f64) {
        let axis = axis.normalize();
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let turned = |v: DVec3| v * cos + axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos);
        (self.heading, self.left, self.up) = (turned(self.heading), turned(self.left), turned(self.up));
    }
}

/// Walks along a string.
pub fn draw(string: &[Letter], settings: &TurtleSettings) -> Branching {
    let mut drawn = Branching::default();
    let mut edges = Vec::new();
    let mut put = |at: DVec3, parent: u32, birth: u32, edge: Edge| {
        edges.push(edge);
        drawn.positions.push(at.as_vec3());
        drawn.parents.push(parent);
        drawn.births.push(birth);
        drawn.positions.len() as u32 - 1
    };
    let mut stack = Vec::new();
    let mut state = State {
        position: DVec3::ZERO,
        heading: DVec3::Y,
        left: DVec3::NEG_X,
        up: DVec3::Z,
        node: Rc::default(),
        bracket: 0,
    };
    let mut open = vec![0];
    let d = settings.angle_deg;
    for (place, letter) in string.iter().enumerate() {
        let here = open[open.len() - 1];
        match letter.symbol {
            'F' | 'G' => {
                let root = || put(state.position, NO_PARENT, letter.birth, Edge::Succeeds);
                let start = state.node.get().unwrap_or_else(root);
                state.node.set(Some(start));
                state.position += state.heading * settings.segment_m;
                let edge = if state.bracket == here { Edge::Succeeds } else { Edge::Branches };
                state.node = Rc::new(Cell::new(Some(put(state.position, start, letter.birth, edge))));
                state.bracket = here;
            }
            'f' => {
                state.position += state.heading * settings.segment_m;
                state.node = Rc::default();
                state.bracket = here;
            }
            '[' => {
                stack.push(state.clone());
                open.push(place + 1);
            }
            ']' => {
                state = stack.pop().unwrap();
                open.pop();
            }
            '+' => state.turn(state.up, d),
            '-' => state.turn(state.up, -d),
            '&' => state.turn(state.left, d),
            '^' => state.turn(state.left, -d),
            '\\' => state.turn(state.heading, -d),
            '/' => state.turn(state.heading, d),
            '|' => state.turn(state.up, 180.0),
            '$' => {
                let left = DVec3::Y.cross(state.heading);
                if left.length() > 1e-9 {
                    state.left = left.normalize();
                    state.up = state.heading.cross(state.left);
                }
            }
            _ => {}
        }
    }
    drawn.edges = Some(edges);
    drawn
}
