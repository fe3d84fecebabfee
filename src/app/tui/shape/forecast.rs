//! A forecast of how much an L-system grows, in one line.

use linden::lsystem::Forecast;
use linden::preset::{LSystem, Preset};

use crate::figures::thousands;

/// Modules of a grammar's text that are looked through for a forecast on screen; more would hold up a frame.
const MOST_MODULES: usize = 20_000;

/// One line on how much a preset's L-system gives; `None` for what is none, and for a grammar that is
/// a book.
pub fn line(preset: &Preset) -> Option<String> {
    let lsystem = preset.settings::<LSystem>()?;
    let rules = lsystem.grammar.productions().iter().map(|rule| rule.successor.len() + 1);
    if lsystem.grammar.axiom().len() + rules.sum::<usize>() > MOST_MODULES {
        return None;
    }
    let forecast = lsystem.forecast().ok()?;
    let about = match forecast {
        Forecast { at_least: true, .. } => "at least ",
        Forecast { exact: true, .. } => "",
        _ => "about ",
    };
    let mut line = format!(
        "{about}{} symbols, {} segments, {} branches deep after {} derivations",
        count(forecast.symbols),
        count(forecast.segments),
        thousands(forecast.depth),
        lsystem.derivations_grown()
    );
    if forecast.symbols > lsystem.symbol_limit.into() {
        line += &format!(": more than the symbol_limit of {}", thousands(lsystem.symbol_limit));
    }
    Some(line)
}

fn count(n: u128) -> String {
    match u64::try_from(n) {
        Ok(n) if n < 1_000_000_000_000 => thousands(n),
        _ if n == u128::MAX => "more than 3e38".to_owned(),
        _ => format!("{:.1e}", n as f64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn abops_tree_is_counted() {
        let mut preset = linden::preset::builtin("abop-a").unwrap().load().unwrap();
        // F -> F[+F]F[-F]F: 5^5 segments, and six other symbols for each F that was rewritten: 781.
        assert_eq!(
            line(&preset).unwrap(),
            "7 811 symbols, 3 125 segments, 5 branches deep after 5 derivations"
        );
        preset.set("derivations", "20").unwrap();
        assert!(line(&preset).unwrap().ends_with("more than the symbol_limit of 50 000 000"));
        preset.set("derivations", "10000").unwrap();
        assert!(line(&preset).unwrap().starts_with("more than 3e38 symbols"));
        // A shrub is as many plants as it has stems.
        for (knob, value) in [("derivations", "5"), ("habit", "shrub"), ("stems", "3")] {
            preset.set(knob, value).unwrap();
        }
        assert!(line(&preset).unwrap().starts_with("23 433 symbols, 9 375 segments, 5 branches"));
        assert_eq!(line(&linden::preset::builtin("fir").unwrap().load().unwrap()), None);
    }
}
