//! New inputs out of old ones: the same for the same key, on any machine.

use linden::knob::Kind;
use linden::preset::{Preset, PresetKnob};
use linden::random::Key;

/// Longer ones say nothing new and take their time.
const LONGEST: usize = 4096;

/// One to six changes to one of `corpus`. `words` are what the language is made of.
pub fn mutated(corpus: &[Vec<u8>], words: &[&str], key: Key) -> Vec<u8> {
    let mut dice = Dice::new(key);
    let mut bytes = corpus[dice.below(corpus.len())].clone();
    for _ in 0..=dice.below(6) {
        let at = dice.below(bytes.len() + 1);
        let end = (at + 1 + dice.below(12)).min(bytes.len());
        match dice.below(9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = dice.below(bytes.len() + 1);
                bytes.splice(to..to, piece);
            }
            3 => {
                // The start of this one and the end of another.
                let other = &corpus[dice.below(corpus.len())];
                bytes.truncate(at);
                bytes.extend_from_slice(&other[dice.below(other.len() + 1)..]);
            }
            4 => drop(bytes.splice(at..at, [dice.below(256) as u8])),
            5 => swap_lines(&mut bytes, &mut dice),
            6 => another_number(&mut bytes, &mut dice),
            _ if !words.is_empty() => {
                let word = words[dice.below(words.len())].bytes();
                let replaced = if dice.below(2) == 0 { at } else { end };
                bytes.splice(at..replaced, word);
            }
            _ => {}
        }
    }
    bytes.truncate(LONGEST);
    bytes
}

/// A document of which one to four knobs are turned: to the ends of their ranges, beyond, or to
/// something else altogether.
pub fn turned(document: &str, key: Key) -> Vec<u8> {
    let mut dice = Dice::new(key);
    let Ok(mut preset) = Preset::from_toml(document) else { return document.into() };
    for _ in 0..=dice.below(4) {
        let knobs = preset.knobs();
        let (knob, _) = &knobs[dice.below(knobs.len())];
        let text = value(knob, &mut dice);
        // What it does not take is a message, and worth as much.
        if let Err(error) = preset.set(knob.knob.name, &text) {
            let text = error.to_string();
            assert!(!text.chars().any(char::is_control), "{text:?}");
        }
    }
    preset.to_toml().map_or_else(|_| document.into(), String::into_bytes)
}

fn value(knob: &PresetKnob, dice: &mut Dice) -> String {
    let number = |min: f64, max: f64, dice: &mut Dice| match dice.below(8) {
        0 => min,
        1 => max,
        2 => min - 1.0,
        3 => max * 1.5 + 1.0,
        4 => f64::midpoint(min, max.min(1e6)),
        5 => min.max(1e-9),
        _ => {
            // Small numbers more often than large ones.
            let share = dice.unit();
            min + (max.min(100.0) - min) * share * share * share
        }
    };
    match knob.knob.kind {
        Kind::Real { min, max, .. } => match dice.below(10) {
            0 => "auto".to_owned(),
            1 => format!("{}..{}", number(min, max, dice), number(min, max, dice)),
            2 => format!("{} ± {}", number(min, max, dice), number(min, max, dice)),
            _ => number(min, max, dice).to_string(),
        },
        Kind::Integer { min, max } => match dice.below(5) {
            0 => min.to_string(),
            1 => max.to_string(),
            2 => max.saturating_add(1).to_string(),
            _ => (min + dice.below(40) as u64).to_string(),
        },
        Kind::Length { min, max, .. } => match dice.below(4) {
            0 => "auto".to_owned(),
            1 => format!("{}D", number(min, max.min(1e3), dice)),
            _ => number(min, max, dice).to_string(),
        },
        Kind::Choice(words) => words[dice.below(words.len())].to_owned(),
        Kind::Switch => ["true", "false", "maybe"][dice.below(3)].to_owned(),
        Kind::Vector { .. } => {
            let of = [0.0, -1.0, 1.0, 0.2, 1e9, -1e-9, 1e30];
            format!("{},{},{}", of[dice.below(7)], of[dice.below(7)], of[dice.below(7)])
        }
        Kind::Color { .. } => ["auto", "#000000", "#ffffff", "#12345"][dice.below(4)].to_owned(),
        Kind::Profile { least, most } => {
            let of = [0.0, 1.0, 0.5, 0.0, -1.0, 3.0, 1e6];
            let pairs = least + dice.below(most.min(least + 4) - least + 1);
            let pair = |_| format!("{},{}", of[dice.below(7)], of[dice.below(7)]);
            (0..pairs).map(pair).collect::<Vec<_>>().join("; ")
        }
        Kind::Reals { min, max, most } => {
            let count = 1 + dice.below(most.min(4));
            let one = |_| match dice.below(8) {
                0 => format!("{}±{}", number(min, max, dice), number(min, max, dice)),
                _ => number(min, max, dice).to_string(),
            };
            (0..count).map(one).collect::<Vec<_>>().join(" ")
        }
        Kind::Words(words) | Kind::Sequence { words, .. } => match dice.below(words.len() + 1) {
            0 => "none".to_owned(),
            first => format!("{} {}", words[first - 1], words[dice.below(words.len())]),
        },
        Kind::Colors { most, .. } => ["#000000", "#ffffff #00ff00"][dice.below(most.min(2))].to_owned(),
    }
}

fn swap_lines(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let mut lines: Vec<&[u8]> = bytes.split(|&byte| byte == b'\n').collect();
    let (a, b) = (dice.below(lines.len()), dice.below(lines.len()));
    lines.swap(a, b);
    *bytes = lines.join(&b'\n');
}

/// Puts another number where one stands.
fn another_number(bytes: &mut Vec<u8>, dice: &mut Dice) {
    const NUMBERS: [&str; 12] = [
        "0",
        "-1",
        "1e308",
        "-1e-308",
        "4294967295",
        "4294967296",
        "18446744073709551615",
        "1e-30",
        "0.5",
        "inf",
        "nan",
        "1000000",
    ];
    let starts: Vec<usize> = (0..bytes.len())
        .filter(|&at| bytes[at].is_ascii_digit() && (at == 0 || !bytes[at - 1].is_ascii_digit()))
        .collect();
    if starts.is_empty() {
        return;
    }
    let start = starts[dice.below(starts.len())];
    let length = bytes[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    bytes.splice(start..start + length, NUMBERS[dice.below(NUMBERS.len())].bytes());
}

/// Random choices, one after the other.
pub struct Dice {
    key: Key,
    thrown: u64,
}

impl Dice {
    pub fn new(key: Key) -> Self {
        Self { key, thrown: 0 }
    }

    /// 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        self.thrown += 1;
        self.key.child(self.thrown).unit()
    }

    /// 0 to below `count`; 0 for none.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count.saturating_sub(1))
    }
}
