//! What the height of a tree says of the unit that it is in.

/// No tree is higher, metres: the highest known is 116 m.
pub const HIGHEST_TREE_M: f64 = 150.0;

/// Greatest height that can be in centimetres: above it must be millimetres.
const MOST_CM: f64 = 4000.0;

/// Metres for a unit of a tree of this height: 1, or what centimetres or millimetres are if no tree is so high in metres.
pub fn likely_scale(height: f64) -> f64 {
    match height {
        height if height <= HIGHEST_TREE_M => 1.0,
        height if height <= MOST_CM => CENTIMETRES,
        _ => MILLIMETRES,
    }
}

pub(super) const CENTIMETRES: f64 = 0.01;
const MILLIMETRES: f64 = 0.001;

/// The name of the unit of which one is so many metres, for scales of [`likely_scale`].
pub fn unit_name(scale: f64) -> &'static str {
    match scale {
        CENTIMETRES => "centimetres",
        MILLIMETRES => "millimetres",
        _ => "metres",
    }
}
