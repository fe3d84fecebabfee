//! L-systems against the literature's figures, a rewriting by definition, and positions by hand.
#![expect(clippy::unwrap_used, reason = "what a test cannot unwrap fails it, in its helpers too")]

mod axes;
mod chance;
mod contexts;
mod definition;
mod figures;
mod flat;
mod habit;
mod language;
mod limits;
mod naive;
mod older;
mod organs;
mod parametric;
mod polygon;
mod presets;
mod properties;
mod trace;
mod tropism;
mod turtle;
mod whole;
mod width;

use linden::lsystem::{Drawn, Grammar, TurtleSettings, grow};
use linden::{Branching, NO_PARENT, Quiet};

/// Grows an axiom without rules, one metre a segment.
fn drawn(axiom: &str, angle_deg: f64) -> Branching {
    let grammar = Grammar::new::<&str>(axiom, &[]).unwrap();
    let settings = TurtleSettings { derivations: 0, angle_deg, segment_m: 1.0, ..TurtleSettings::default() };
    grow(&grammar, &settings, &Quiet).unwrap().branching
}

/// Grows an axiom without rules, with some settings changed.
fn drawn_with(axiom: &str, change: impl FnOnce(&mut TurtleSettings)) -> Drawn {
    let grammar = Grammar::new::<&str>(axiom, &[]).unwrap();
    let mut settings = TurtleSettings { derivations: 0, segment_m: 1.0, ..TurtleSettings::default() };
    change(&mut settings);
    grow(&grammar, &settings, &Quiet).unwrap()
}

/// What every branching structure keeps: arrays of one length, parents first, no segment without
/// length.
fn assert_sound(grown: &Drawn) {
    let Branching { positions, parents, births, .. } = &grown.branching;
    assert_eq!((positions.len(), positions.len()), (parents.len(), births.len()));
    for (node, &parent) in parents.iter().enumerate() {
        assert!(positions[node].is_finite());
        if parent != NO_PARENT {
            assert!((parent as usize) < node, "node {node} grows from {parent}");
            assert_ne!(positions[parent as usize], positions[node], "segment {node} has no length");
        }
    }
}

fn segments(branching: &Branching) -> usize {
    branching.parents.iter().filter(|&&parent| parent != NO_PARENT).count()
}
