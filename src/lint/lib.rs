//! Faults in 3D assets of trees, whoever made them: what a game's engine, its artists and its players would stumble on.
//!
//! Takes the bytes of a file ([`read`]), gives an [`Asset`] that is the same whatever format it was in, and for that a
//! [`Report`] ([`lint`]). It opens no files itself: what lies beside one it asks the caller for ([`Beside`]). It repairs
//! nothing.
//!
//! A rule is a module below `rules` and a line in [`RULES`]: from that table come the configuration, the help and the
//! manual. What a file cannot say, or what cannot be read of it, is in the report as not looked at, and never passes
//! for good.
//!
//! ```
//! use linden_lint::{Config, NoFiles, lint, read};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let card = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\n";
//! let asset = read("card.obj", card, &NoFiles, &linden_base::monitor::Quiet)?;
//! let report = lint(&asset, &Config::default());
//! assert!(report.findings.iter().any(|finding| finding.rule == "degenerate"));
//! # Ok(())
//! # }
//! ```

mod asset;
mod config;
mod finding;
mod mesh;
mod profile;
mod read;
mod rules;

pub use asset::{
    Alpha, Aspect, Asset, FileFormat, Geometry, Level, Material, Mesh, Piece, Texture, TextureUse, Unseen,
};
pub use config::{Config, ConfigError};
pub use finding::{Finding, NotLooked, Numbers, Report, Severity};
pub use profile::{PROFILES, Profile};
pub use read::{Beside, ENDINGS, NoFiles, ReadError, read};
pub use rules::{Limit, RULES, Rule};

/// Applies all rules that a configuration has on.
pub fn lint(asset: &Asset, config: &Config) -> Report {
    finding::report(asset, config)
}
