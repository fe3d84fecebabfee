//! Reports and rules for people, and rules as JSON.

use indicatif::HumanCount;
use linden_lint::{Config, Finding, RULES, Report, Rule};
use serde::Serialize;

use crate::wrap::wrapped;

/// Columns of a line.
const WIDTH: usize = 110;

/// A block for each file.
pub fn table(reports: &[Report]) -> String {
    let blocks: Vec<String> = reports.iter().map(block).collect();
    blocks.join("\n")
}

fn block(report: &Report) -> String {
    let numbers = &report.numbers;
    let triangles: Vec<String> = numbers.triangles.iter().map(|&n| HumanCount(n).to_string()).collect();
    let calls = numbers.draw_calls.first().copied().unwrap_or(0);
    let height = numbers.height_m.map_or_else(String::new, |height| format!(", {height:.2} m high"));
    let mut text = format!(
        "{}: {}, {} triangles, {}, {}, {}{height}\n",
        linden::knob::printable(&report.file),
        report.format.name(),
        triangles.join(" / "),
        count(calls, "draw call"),
        count(numbers.materials, "material"),
        count(numbers.textures, "picture"),
    );
    for Finding { rule, severity, place, message, .. } in &report.findings {
        let place = place.as_ref().map_or_else(String::new, |place| format!("{place}: "));
        text.push_str(&format!("  {:6}{rule:18}{place}{message}\n", severity.word()));
    }
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for unseen in &report.not_looked_at {
        match reasons.iter_mut().find(|(why, _)| *why == unseen.why) {
            Some((_, rules)) => rules.push(unseen.rule),
            None => reasons.push((&unseen.why, vec![unseen.rule])),
        }
    }
    for (why, rules) in reasons {
        text.push_str(&format!("  not looked at, or not at all of it: {} ({why})\n", rules.join(", ")));
    }
    if report.findings.is_empty() {
        text.push_str("  nothing was found\n");
    }
    text
}

/// `3 errors`.
pub fn count(count: usize, what: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{} {what}{ending}", HumanCount(count as u64))
}

/// All rules, explained.
pub fn rules(config: &Config) -> String {
    let mut text = format!("Profile {}\n", config.profile());
    for rule in RULES {
        text.push_str(&format!("\n{} ({})\n", rule.id, config.severity(rule).word()));
        for line in
            [format!("{}.", rule.checks), format!("Why: {}.", rule.why), format!("Mend: {}.", rule.mend)]
        {
            for line in wrapped(&line, WIDTH - 2) {
                text.push_str(&format!("  {line}\n"));
            }
        }
        for limit in rule.limits {
            let value = config.limit(rule, limit.name);
            let unit = if limit.unit.is_empty() { String::new() } else { format!(" {}", limit.unit) };
            text.push_str(&format!("  {}.{} = {value}{unit}: {}\n", rule.id, limit.name, limit.help));
        }
    }
    text
}

/// A rule as it is with a configuration.
#[derive(Serialize)]
pub struct RuleRow {
    id: &'static str,
    level: &'static str,
    checks: &'static str,
    why: &'static str,
    mend: &'static str,
    limits: Vec<LimitRow>,
}

#[derive(Serialize)]
struct LimitRow {
    name: &'static str,
    value: f64,
    unit: &'static str,
    help: &'static str,
}

pub fn rules_json(config: &Config) -> Vec<RuleRow> {
    let limits = |rule: &'static Rule| {
        let limits = rule.limits.iter();
        let row = |limit: &linden_lint::Limit| LimitRow {
            name: limit.name,
            value: config.limit(rule, limit.name),
            unit: limit.unit,
            help: limit.help,
        };
        limits.map(row).collect()
    };
    let row = |rule: &'static Rule| RuleRow {
        id: rule.id,
        level: config.severity(rule).word(),
        checks: rule.checks,
        why: rule.why,
        mend: rule.mend,
        limits: limits(rule),
    };
    RULES.iter().map(row).collect()
}
