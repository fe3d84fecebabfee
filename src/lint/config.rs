//! Which rules are on, and what their limits are: a profile, and a document in TOML over it.
//!
//! ```toml
//! profile = "mobile"
//! [rules]
//! triangles = { level = "error", max = 8000 }
//! uv-overlap = "off"
//! ```

use std::collections::BTreeMap;

use linden_base::knob::{did_you_mean, excerpt, nearest};
use serde::Deserialize;

use crate::finding::Severity;
use crate::profile::{PROFILES, Profile};
use crate::rules::{Limits, RULES, Rule};

/// Which rules are on, and what their limits are.
#[derive(Clone, Debug)]
pub struct Config {
    profile: &'static Profile,
    severities: BTreeMap<&'static str, Severity>,
    limits: BTreeMap<(&'static str, &'static str), f64>,
}

/// What is wrong with a configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// No TOML, or a value of another type.
    #[error("{0}")]
    Document(String),
    /// No profile of that name.
    /// No profile of that name.
    #[error("no profile is called '{}'{}; there are: {}", excerpt(.typed), did_you_mean(*.nearest), profiles())]
    Profile {
        /// As it was typed.
        typed: String,
        /// What may have been meant.
        nearest: Option<&'static str>,
    },
    /// No rule of that name.
    /// No rule of that name.
    #[error("no rule is called '{}'{}; 'linden lint --rules' lists them", excerpt(.typed), did_you_mean(*.nearest))]
    Rule {
        /// As it was typed.
        typed: String,
        /// What may have been meant.
        nearest: Option<&'static str>,
    },
    /// No limit of that name.
    /// No limit of that name.
    #[error("rule {rule}: there is no '{}'{}; it has: {known}", excerpt(.typed), did_you_mean(*.nearest))]
    Limit {
        /// The rule.
        rule: &'static str,
        /// As it was typed.
        typed: String,
        /// What may have been meant.
        nearest: Option<&'static str>,
        /// What there is.
        known: String,
    },
    /// No word for a level.
    /// No word for a level.
    #[error("rule {rule}: '{}' is no level; take off, info, warn or error", excerpt(.typed))]
    Level {
        /// The rule.
        rule: &'static str,
        /// As it was typed.
        typed: String,
    },
    /// No number that a limit can be.
    /// No number that a limit can be.
    #[error("rule {rule}: {limit} = {value} is no number of at least 0")]
    Value {
        /// The rule.
        rule: &'static str,
        /// The limit.
        limit: &'static str,
        /// The number.
        value: f64,
    },
}

fn profiles() -> String {
    PROFILES.iter().map(|profile| profile.id).collect::<Vec<_>>().join(", ")
}

/// The document.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    profile: Option<String>,
    #[serde(default)]
    rules: BTreeMap<String, RuleEntry>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RuleEntry {
    Level(String),
    Limits(BTreeMap<String, Entry>),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(f64),
    Word(String),
}

impl Default for Config {
    fn default() -> Self {
        Self { profile: &PROFILES[0], severities: BTreeMap::new(), limits: BTreeMap::new() }
    }
}

impl Config {
    /// A profile as it is.
    ///
    /// # Errors
    /// [`ConfigError::Profile`].
    pub fn of_profile(id: &str) -> Result<Self, ConfigError> {
        let ids = || PROFILES.iter().map(|profile| profile.id);
        let profile = PROFILES.iter().find(|profile| profile.id == id);
        let profile = profile
            .ok_or_else(|| ConfigError::Profile { typed: id.to_owned(), nearest: nearest(id, ids()) })?;
        Ok(Self { profile, ..Self::default() })
    }

    /// Reads a document.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn parse(text: &str) -> Result<Self, ConfigError> {
        let document: Document = toml::from_str(text)
            .map_err(|error| ConfigError::Document(error.to_string().trim_end().to_owned()))?;
        let mut config = match &document.profile {
            Some(id) => Self::of_profile(id)?,
            None => Self::default(),
        };
        for (id, entry) in document.rules {
            match entry {
                RuleEntry::Level(level) => config.set_level(&id, &level)?,
                RuleEntry::Limits(entries) => {
                    for (name, entry) in entries {
                        match entry {
                            Entry::Word(level) if name == "level" => config.set_level(&id, &level)?,
                            Entry::Number(value) if name != "level" => config.set_limit(&id, &name, value)?,
                            _ => {
                                let rule = find(&id)?.id;
                                return Err(ConfigError::Document(format!(
                                    "rule {rule}: level is a word, and limits are numbers: '{}' is neither",
                                    excerpt(&name)
                                )));
                            }
                        }
                    }
                }
            }
        }
        Ok(config)
    }

    /// The same with another profile below it.
    ///
    /// # Errors
    /// [`ConfigError::Profile`].
    pub fn with_profile(self, id: &str) -> Result<Self, ConfigError> {
        Ok(Self { profile: Self::of_profile(id)?.profile, ..self })
    }

    /// Sets how grave what a rule finds is: `off`, `info`, `warn` or `error`.
    ///
    /// # Errors
    /// [`ConfigError::Rule`], [`ConfigError::Level`].
    pub fn set_level(&mut self, id: &str, level: &str) -> Result<(), ConfigError> {
        let rule = find(id)?.id;
        let severity = Severity::ALL.into_iter().find(|severity| severity.word() == level);
        let severity = severity.ok_or_else(|| ConfigError::Level { rule, typed: level.to_owned() })?;
        self.severities.insert(rule, severity);
        Ok(())
    }

    /// Sets a limit of a rule.
    ///
    /// # Errors
    /// [`ConfigError::Rule`], [`ConfigError::Limit`], [`ConfigError::Value`].
    pub fn set_limit(&mut self, id: &str, name: &str, value: f64) -> Result<(), ConfigError> {
        let rule = find(id)?;
        let names = || rule.limits.iter().map(|limit| limit.name);
        let known = || names().chain(["level"]).collect::<Vec<_>>().join(", ");
        let limit =
            rule.limits.iter().find(|limit| limit.name == name).ok_or_else(|| ConfigError::Limit {
                rule: rule.id,
                typed: name.to_owned(),
                nearest: nearest(name, names()),
                known: known(),
            })?;
        if !(value >= 0.0 && value.is_finite()) {
            return Err(ConfigError::Value { rule: rule.id, limit: limit.name, value });
        }
        self.limits.insert((rule.id, limit.name), value);
        Ok(())
    }

    /// The profile's id.
    pub fn profile(&self) -> &'static str {
        self.profile.id
    }

    /// How grave what a rule finds is.
    pub fn severity(&self, rule: &Rule) -> Severity {
        let of_profile =
            || self.profile.severities.iter().find(|(id, _)| *id == rule.id).map(|(_, severity)| *severity);
        self.severities.get(rule.id).copied().or_else(of_profile).unwrap_or(rule.severity)
    }

    /// A limit of a rule.
    pub fn limit(&self, rule: &Rule, name: &str) -> f64 {
        self.limits(rule).of(name)
    }

    pub(crate) fn limits(&self, rule: &Rule) -> Limits {
        let value = |name: &'static str, usual: f64| {
            let of_profile = || {
                self.profile
                    .limits
                    .iter()
                    .find(|(id, limit, _)| *id == rule.id && *limit == name)
                    .map(|row| row.2)
            };
            self.limits.get(&(rule.id, name)).copied().or_else(of_profile).unwrap_or(usual)
        };
        Limits::new(rule.limits.iter().map(|limit| (limit.name, value(limit.name, limit.usual))).collect())
    }
}

fn find(id: &str) -> Result<&'static Rule, ConfigError> {
    let ids = || RULES.iter().map(|rule| rule.id);
    RULES
        .iter()
        .find(|rule| rule.id == id)
        .ok_or_else(|| ConfigError::Rule { typed: id.to_owned(), nearest: nearest(id, ids()) })
}
