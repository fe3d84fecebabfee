//! Budgets for common targets: what a configuration begins with.

use crate::finding::Severity;

/// Limits and levels that differ from those of the rules.
#[derive(Clone, Copy, Debug)]
pub struct Profile {
    /// As configurations and reports name it.
    pub id: &'static str,
    /// In a line.
    pub help: &'static str,
    /// Rule, limit, value.
    pub limits: &'static [(&'static str, &'static str, f64)],
    /// Levels of rules.
    pub severities: &'static [(&'static str, Severity)],
}

/// All profiles, the usual one first. They are rules of thumb for one tree, and there to be changed.
pub static PROFILES: &[Profile] = &[
    Profile { id: "desktop", help: "a tree in a game on a PC or a console", limits: &[], severities: &[] },
    Profile {
        id: "mobile",
        help: "a tree in a game on a phone, or in a browser",
        limits: &[
            ("triangles", "max", 10_000.0),
            ("draw-calls", "max", 4.0),
            ("materials", "max", 3.0),
            ("texture-size", "max", 1024.0),
            ("lod-missing", "triangles", 2000.0),
        ],
        severities: &[("mesh-vertices", Severity::Warn)],
    },
    Profile {
        id: "hero",
        help: "a tree that is seen from near, with virtual geometry",
        limits: &[
            ("triangles", "max", 2_000_000.0),
            ("draw-calls", "max", 16.0),
            ("materials", "max", 8.0),
            ("texture-size", "max", 8192.0),
            ("texel-density", "max", 16_384.0),
        ],
        severities: &[("lod-missing", Severity::Off)],
    },
    Profile {
        id: "film",
        help: "a tree that is rendered off line: geometry and materials, no budgets",
        limits: &[("texture-size", "max", 16_384.0)],
        severities: &[
            ("triangles", Severity::Off),
            ("draw-calls", Severity::Off),
            ("materials", Severity::Off),
            ("mesh-vertices", Severity::Off),
            ("texel-density", Severity::Off),
            ("lod-missing", Severity::Off),
            ("alpha-blend", Severity::Off),
        ],
    },
];
