//! `--age` and `--ages`: a source as a plant at one age, or at several.

use linden::knob::printable;
use linden::preset::{Age, AgeError, Preset};

use crate::exit::usage;
use crate::source::{OF_AGE, Source, is_file_key};

/// What a share by itself is called here.
const UNNAMED: &str = "at";

/// The source at the one age that `--age` names.
///
/// # Errors
/// As [`aged`]; several.
pub fn at(source: &Source, age: &str, turned: &[(String, String)]) -> anyhow::Result<Source> {
    let mut ages = of_flag(source, "--age", &with_name(age), turned)?;
    match ages.pop() {
        Some((_, aged)) if ages.is_empty() => Ok(aged),
        _ => Err(usage(format!("--age {}: expected one age; --ages takes several", printable(age)))),
    }
}

/// The ages that `--ages` names, with the source at each. What else was turned by hand holds at all of them.
///
/// # Errors
/// What is no list of ages; knobs of age that were turned by hand.
pub fn aged(
    source: &Source,
    list: &str,
    turned: &[(String, String)],
) -> anyhow::Result<Vec<(String, Source)>> {
    of_flag(source, "--ages", list, turned)
}

/// Refuses knobs of age that are turned by hand beside a flag that says the age.
pub fn ensure_one_age(flag: &str, turned: &[(String, String)]) -> anyhow::Result<()> {
    match turned.iter().find(|(name, _)| OF_AGE.contains(&name.as_str())) {
        Some((knob, value)) => {
            Err(usage(format!("--set {knob}={value} and {flag} both say how old it is: leave one out")))
        }
        None => Ok(()),
    }
}

/// A preset at the one age that `name` names; `key` is where that stands.
///
/// # Errors
/// As [`aged`]; several.
pub fn preset_at(preset: &Preset, key: &str, name: &str) -> anyhow::Result<Preset> {
    let ages = listed(preset, key, &with_name(name))?;
    match ages.as_slice() {
        [age] => Ok(preset.at_age(age)?),
        _ => Err(usage(format!("{key} {}: expected one age", printable(name)))),
    }
}

/// A share by itself needs no name where there is no file to name.
fn with_name(age: &str) -> String {
    let age = age.trim();
    if age.parse::<f64>().is_ok() { format!("{UNNAMED}={age}") } else { age.to_owned() }
}

/// What is meant by a number that is too large for a share: an end for the message.
fn or_years(preset: &Preset, list: &str) -> String {
    let share = list.rsplit('=').next().unwrap_or_default();
    let years = share.parse::<f64>().ok().filter(|years| *years > 1.0);
    match years {
        Some(years) if preset.find_knob("years").is_some() => {
            format!("; it is a share of its growth: years are {years:.0}y")
        }
        Some(_) => "; it is a share of its growth, and this plant does not grow by years".to_owned(),
        None => String::new(),
    }
}

/// The ages of a list that stands behind a flag or a key.
fn listed(preset: &Preset, flag: &str, list: &str) -> anyhow::Result<Vec<Age>> {
    preset.ages_of(list).map_err(|error| match error {
        AgeError::Knob { name, problem } if name == UNNAMED => {
            usage(format!("{flag} {problem}{}", or_years(preset, list)))
        }
        error => usage(format!("{flag}: {error}")),
    })
}

fn of_flag(
    source: &Source,
    flag: &str,
    list: &str,
    turned: &[(String, String)],
) -> anyhow::Result<Vec<(String, Source)>> {
    ensure_one_age(flag, turned)?;
    let preset = &source.recipe.preset;
    let ages = listed(preset, flag, list)?;
    let at = |age: &Age| {
        let mut aged = source.clone();
        aged.recipe.preset = preset.at_age(age)?;
        let knobs = turned.iter().filter(|(name, _)| !is_file_key(name));
        for (knob, value) in knobs {
            aged.recipe.preset.set(knob, value)?;
        }
        Ok((age.name.clone(), aged))
    };
    ages.iter().map(at).collect()
}
