//! What a module is in the picture, and the module of a place there.

use glam::{Vec2, Vec3};
use linden::lsystem::TracedModule;
use linden_raster::View;

use crate::jobs::DerivedWord;
use crate::tui::picture;

/// Half a cross, as a share of what is framed.
const CROSS: f32 = 0.012;

/// Polylines for a module, metres: its segment; of a bracket, its branch; of a brace, its outline; a cross where the
/// turtle stands, where that is nothing or hard to find.
pub fn of(word: &DerivedWord, module: usize) -> Vec<Vec<Vec3>> {
    let modules = &word.traced.modules;
    let Some(at) = modules.get(module).and_then(|module| module.at) else { return Vec::new() };
    let mut lines = match modules[module].symbol {
        '[' | ']' => match bracket(modules, module) {
            Some(other) => segments(modules, module.min(other), module.max(other)),
            None => Vec::new(),
        },
        '{' | '}' => match brace(modules, module) {
            Some(other) => vec![outline(modules, module.min(other), module.max(other))],
            None => Vec::new(),
        },
        _ => segments(modules, module, module + 1),
    };
    let half_m = word.extent.map_or(0.0, |extent| {
        let wide = 2.0 * extent.radii.iter().copied().fold(0.0, f32::max);
        CROSS * wide.max(extent.top - extent.bottom)
    });
    // What is too short to be found is crossed, too.
    if length_m(&lines) < 2.0 * half_m {
        lines.extend(Vec3::AXES.iter().map(|axis| vec![at - axis * half_m, at + axis * half_m]));
    }
    lines
}

fn length_m(lines: &[Vec<Vec3>]) -> f32 {
    let of_line = |line: &Vec<Vec3>| line.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f32>();
    lines.iter().map(of_line).sum()
}

/// Where the turtle stood before a module.
pub fn before(modules: &[TracedModule], module: usize) -> Vec3 {
    module.checked_sub(1).and_then(|before| modules[before].at).unwrap_or(Vec3::ZERO)
}

/// The segments that some modules drew, end to end where they are.
fn segments(modules: &[TracedModule], from: usize, to: usize) -> Vec<Vec<Vec3>> {
    let mut lines: Vec<Vec<Vec3>> = Vec::new();
    for module in from..to {
        let Some(end) = modules[module].at.filter(|_| !modules[module].nodes.is_empty()) else { continue };
        let start = before(modules, module);
        match lines.last_mut().filter(|line| line.last() == Some(&start)) {
            Some(line) => line.push(end),
            None => lines.push(vec![start, end]),
        }
    }
    lines
}

/// The way of the turtle between two braces, closed.
fn outline(modules: &[TracedModule], from: usize, to: usize) -> Vec<Vec3> {
    let mut line: Vec<Vec3> = modules[from..to].iter().filter_map(|module| module.at).collect();
    line.extend(line.first().copied());
    line
}

/// The bracket that belongs to one; from elsewhere, the one that began the branch.
pub fn bracket(modules: &[TracedModule], module: usize) -> Option<usize> {
    if modules.get(module)?.symbol == '[' {
        partner(modules.iter().enumerate().skip(module + 1), '[', ']')
    } else {
        partner(modules[..module].iter().enumerate().rev(), ']', '[')
    }
}

fn brace(modules: &[TracedModule], module: usize) -> Option<usize> {
    if modules.get(module)?.symbol == '{' {
        partner(modules.iter().enumerate().skip(module + 1), '{', '}')
    } else {
        partner(modules[..module].iter().enumerate().rev(), '}', '{')
    }
}

/// The first of some modules that closes what was open before them.
fn partner<'a>(
    modules: impl Iterator<Item = (usize, &'a TracedModule)>,
    opens: char,
    closes: char,
) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, module) in modules {
        if module.symbol == opens {
            depth += 1;
        } else if module.symbol == closes {
            if depth == 0 {
                return Some(at);
            }
            depth -= 1;
        }
    }
    None
}

/// The module whose segment is drawn nearest to a pixel.
pub fn nearest(word: &DerivedWord, view: &View, place: Vec2) -> Option<usize> {
    let modules = &word.traced.modules;
    let drawn = (0..modules.len()).filter(|&module| !modules[module].nodes.is_empty());
    let with_distance = drawn.filter_map(|module| {
        let (from, to) = (before(modules, module), modules[module].at?);
        Some((module, picture::distance_px(place, view.project(from).at, view.project(to).at)))
    });
    with_distance.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(module, _)| module)
}
