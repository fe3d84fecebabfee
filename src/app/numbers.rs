//! The numbers of a tree for people: what `linden stats` prints and the workbench shows.

use linden::report::{Corners, Number, Reading, Report};

/// A number for people, its name first; `None` where it does not apply. `is_solid`: whether all wood is one
/// surface.
pub fn line(number: &Number, report: &Report, is_solid: bool) -> Option<(&'static str, String)> {
    line_with(number, report, is_solid, |count| indicatif::HumanCount(count).to_string())
}

/// The same with counts as they are written elsewhere around it.
pub fn line_with(
    number: &Number,
    report: &Report,
    is_solid: bool,
    counted: impl Fn(u64) -> String,
) -> Option<(&'static str, String)> {
    let unit = |text: String| if number.unit.is_empty() { text } else { format!("{text} {}", number.unit) };
    let reading = (number.reading)(report);
    // As without, on a bare tree.
    let is_bare = report.leaves == 0 && number.name.contains("with_leaves");
    if reading.is_nothing() || is_bare {
        return None;
    }
    let shown = match reading {
        Reading::Count(count) => unit(counted(count)),
        Reading::Real(real) => unit(rounded(real)),
        Reading::Yes(true) if number.name == "watertight" && is_solid => "yes: one solid".to_owned(),
        Reading::Yes(true) if number.name == "watertight" => "yes: each axis is closed".to_owned(),
        Reading::Yes(true) if number.name == "canopy" => {
            "a canopy without a stem: all radii are guessed".to_owned()
        }
        Reading::Yes(is_so) => if is_so { "yes" } else { "no" }.to_owned(),
        Reading::Text(text) => text,
        Reading::Counts(list) => {
            let counts: Vec<_> = list.iter().map(|&n| counted(n)).collect();
            counts.join(", ")
        }
        Reading::Reals(list) => unit(list.iter().map(|&x| rounded(x)).collect::<Vec<_>>().join(", ")),
        Reading::Texts(list) => list.join(", "),
        Reading::Corners(Corners { min, max }) => {
            let place = |[x, y, z]: [f32; 3]| format!("({x:.2} {y:.2} {z:.2})");
            unit(format!("{} to {}", place(min), place(max)))
        }
        _ => return None,
    };
    Some((number.label, shown))
}

/// Four digits that count, no more than six after the point.
pub fn rounded(real: f64) -> String {
    if real == 0.0 {
        return "0".to_owned();
    }
    let magnitude = real.abs().log10().floor();
    format!("{real:.*}", (3.0 - magnitude).clamp(0.0, 6.0) as usize)
}
