//! `--ages`: a source as a plant at several ages.

use linden::preset::Age;

use crate::exit::usage;
use crate::source::{Source, is_file_key};

/// Knobs that say how old a plant is: `--ages` turns them.
const OF_AGE: [&str; 3] = ["age", "years", "derivations"];

/// The ages that `--ages` names, with the source at each. What else was turned by hand holds at all of them.
///
/// # Errors
/// What is no list of ages; knobs of age that were turned by hand.
pub fn aged(
    source: &Source,
    list: &str,
    turned: &[(String, String)],
) -> anyhow::Result<Vec<(String, Source)>> {
    if let Some((knob, value)) = turned.iter().find(|(name, _)| OF_AGE.contains(&name.as_str())) {
        return Err(usage(format!("--set {knob}={value} and --ages both say how old it is: leave one out")));
    }
    let preset = &source.recipe.preset;
    let ages = preset.ages_of(list).map_err(|error| usage(format!("--ages: {error}")))?;
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
