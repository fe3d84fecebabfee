//! Skeleton and organs → shapes.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{Vec2, Vec3};
use linden_pipeline::foliage::Shaper;
use linden_pipeline::memory::{bytes_grown, bytes_of};
use linden_pipeline::scene::Mesh;
use linden_pipeline::skeleton::{Axis, Forks};
use linden_pipeline::{Monitor, NO_PARENT, Skeleton};

use super::outline::{Place, tapered};
use super::{Drawing, Kind, Shape};
use crate::color::{encoded, linear};
use crate::memory::Ledger;
use crate::strokes::trace::Colors;
use crate::{Paint, RasterError, Style, View};

/// Axes and organs between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 10;
/// Places of a line that are nearer are one, pixels.
const MERGE_PX: f32 = 0.6;
/// Narrower than this, pixels, an axis is lines of even widths.
const NARROW_PX: f32 = 1.6;
/// Widths of lines are powers of this: steps that nobody sees.
const STEP: f32 = 1.25;
/// With less ink than this, pixels, an axis is not drawn: under one step of 8 bits.
const INVISIBLE: f32 = 1.0 / 300.0;
/// Tones of leaves.
const TONES: f32 = 5.0;

/// Points of one shape: what is made of a shape to fill it takes memory, and is not cancelled.
const MOST_POINTS: usize = 1 << 14;

/// Lines of one colour, of the same width.
#[derive(Default)]
struct Bundle {
    points: Vec<Vec2>,
    ends: Vec<u32>,
}

impl Bundle {
    fn add(&mut self, part: &[Place]) {
        self.points.extend(part.iter().map(|place| place.at));
        self.ends.push(self.points.len() as u32);
    }
}

/// An axis that is drawn as rings.
struct ThickAxis {
    layer: u32,
    color: [u8; 3],
    line: Vec<Place>,
    is_lateral: bool,
}

/// The wood: for each colour the thin axes as lines, then the others as rings.
pub(super) fn wood(
    drawing: &mut Drawing,
    skeleton: &Skeleton,
    view: &View,
    style: &Style,
    ledger: &Ledger<'_>,
    monitor: &dyn Monitor,
) -> Result<(), RasterError> {
    let colors = Colors::new(skeleton, style);
    let present = style.until.map(|step| skeleton.born_by(step));
    let frame = Vec2::new(drawing.size.width() as f32, drawing.size.height() as f32);
    // In one ink nobody sees which lies above; what has colours is drawn stems first.
    let mut thin: BTreeMap<(u32, [u8; 3], i32), Bundle> = BTreeMap::new();
    let mut thick: Vec<ThickAxis> = Vec::new();
    let forks = Forks::new(skeleton);
    let (mut line, mut places_kept, mut bytes_held) = (Vec::new(), 0, 0);
    for (i, axis) in skeleton.axes.iter().enumerate() {
        if i % CHECK_EVERY == 0 {
            monitor.check()?;
            let bytes = bytes_grown::<Place>(places_kept) + bytes_grown::<ThickAxis>(thick.len());
            ledger.grow(&mut bytes_held, bytes)?;
        }
        let runs_on = forks.runs_on(i as u32);
        places(skeleton, (axis, runs_on), view, present.as_deref(), &mut line);
        let wide = line.iter().map(|place| place.half).fold(0.0, f32::max);
        let (low, high) = line.iter().fold((frame, Vec2::ZERO), |(low, high), place| {
            (low.min(place.at + wide), high.max(place.at - wide))
        });
        if line.is_empty() || low.cmpge(frame).any() || high.cmple(Vec2::ZERO).any() {
            continue;
        }
        let first = skeleton.nodes_of(axis)[0];
        let color = match style.paint {
            Paint::Wood => style.ink,
            _ => bytes(colors.of(first)),
        };
        let layer = if style.paint == Paint::Wood { 0 } else { axis.order };
        let narrow = 2.0 * wide < NARROW_PX && line.len() > 1;
        places_kept += line.len();
        if narrow {
            for (class, part) in even_parts(&line) {
                thin.entry((layer, color, class)).or_default().add(part);
            }
        } else {
            let is_lateral = axis.parent != NO_PARENT;
            thick.push(ThickAxis { layer, color, line: line.clone(), is_lateral });
        }
    }
    let bytes = bytes_grown::<Place>(places_kept) + bytes_grown::<ThickAxis>(thick.len());
    ledger.grow(&mut bytes_held, bytes)?;
    // Equal colours in one shape: fewer to draw, fewer to write.
    thick.sort_by_key(|axis| (axis.layer, axis.color));
    for ((_, color, class), bundle) in thin {
        let width = libm::powf(STEP, class as f32);
        let mut from = 0;
        for ends in parts(&bundle.ends) {
            let to = ends.last().copied().unwrap_or(from);
            drawing.shape(Kind::Lines { width }, color, 1.0, |drawing| {
                let before = drawing.points.len() as u32;
                drawing.points.extend_from_slice(&bundle.points[from as usize..to as usize]);
                drawing.ends.extend(ends.iter().map(|end| before + end - from));
            });
            from = to;
        }
    }
    for group in thick.chunk_by(|a, b| (a.layer, a.color) == (b.layer, b.color)) {
        monitor.check()?;
        let mut left = group.iter().peekable();
        while let Some(axis) = left.peek() {
            let (color, before) = (axis.color, drawing.points.len());
            drawing.shape(Kind::Rings, color, 1.0, |drawing| {
                while drawing.points.len() - before < MOST_POINTS
                    && let Some(axis) = left.next()
                {
                    tapered(drawing, &axis.line, axis.is_lateral);
                }
            });
        }
    }
    // Both are there at once, and the points were twice while their list grew the last time.
    let growing = drawing.bytes() / 2;
    ledger.take(drawing.bytes() + growing)?;
    ledger.give_back(bytes_held + growing);
    Ok(())
}

/// The ends of lines, cut into parts with no more points than one shape may have, but for a single line.
fn parts(ends: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut from = 0;
    ends.chunk_by(move |&last, &next| {
        let fits = (next - from) as usize <= MOST_POINTS;
        if !fits {
            from = last;
        }
        fits
    })
}

/// The places of an axis that are there, from where it leaves its parent.
fn places(
    skeleton: &Skeleton,
    (axis, runs_on): (&Axis, bool),
    view: &View,
    present: Option<&[bool]>,
    line: &mut Vec<Place>,
) {
    line.clear();
    let nodes = skeleton.nodes_of(axis);
    let there = present
        .map_or(nodes.len(), |present| nodes.iter().take_while(|&&node| present[node as usize]).count());
    let nodes = &nodes[..there];
    let (Some(&first), Some(&apex)) = (nodes.first(), nodes.last()) else { return };
    let place = |node: u32, radius_m: f32| {
        let seen = view.project(skeleton.positions[node as usize]);
        Place { at: seen.at, half: radius_m.max(0.0) * seen.scale }
    };
    if axis.parent != NO_PARENT {
        let parent_m = skeleton.radii[axis.parent as usize];
        let radius_m = if runs_on { parent_m } else { parent_m.min(skeleton.radii[first as usize]) };
        line.push(place(axis.parent, radius_m));
    }
    for &node in nodes {
        let next = place(node, skeleton.radii[node as usize]);
        let is_near = line.last().is_some_and(|last| last.at.distance(next.at) < MERGE_PX);
        if !is_near || node == apex {
            line.push(next);
        }
    }
}

/// Cuts a thin line where its width changes by a step; each part with its width as a power of [`STEP`].
/// Parts that nobody would see are left out.
fn even_parts(line: &[Place]) -> Vec<(i32, &[Place])> {
    let class = |pair: &[Place]| {
        let width = (pair[0].half + pair[1].half).max(1e-4);
        (libm::logf(width) / libm::logf(STEP)).round() as i32
    };
    let classes: Vec<i32> = line.windows(2).map(class).collect();
    let mut from = 0;
    let mut parts = Vec::new();
    for run in classes.chunk_by(|a, b| a == b) {
        let part = &line[from..=from + run.len()];
        from += run.len();
        let length: f32 = part.windows(2).map(|pair| pair[0].at.distance(pair[1].at)).sum();
        if libm::powf(STEP, run[0] as f32).min(1.0) * length.min(1.0) >= INVISIBLE {
            parts.push((run[0], part));
        }
    }
    parts
}

/// An organ's triangles, how far it is and its colour.
struct Leaf {
    depth_m: f32,
    color: [u8; 3],
    triangles: Range<usize>,
}

/// Leaves, flowers and polygons, far to near, each in one tone.
pub(super) fn organs(
    drawing: &mut Drawing,
    skeleton: &Skeleton,
    view: &View,
    style: &Style,
    ledger: &Ledger<'_>,
    monitor: &dyn Monitor,
) -> Result<(), RasterError> {
    let Some(organs) = style.organs.filter(|organs| !organs.is_empty()) else { return Ok(()) };
    let present = style.until.map(|step| skeleton.born_by(step));
    let frame = Vec2::new(drawing.size.width() as f32, drawing.size.height() as f32);
    let (mut leaves, mut corners): (Vec<Leaf>, Vec<[Vec2; 3]>) = (Vec::new(), Vec::new());
    let (mut shaper, mut mesh) = (Shaper::default(), Mesh::default());
    let bytes_of_lists =
        |leaves: usize, corners: usize| bytes_grown::<Leaf>(leaves) + bytes_grown::<[Vec2; 3]>(corners);
    let mut bytes_held = 0;
    for organ in 0..organs.len() {
        if organ % CHECK_EVERY == 0 {
            monitor.check()?;
            ledger.grow(&mut bytes_held, bytes_of_lists(leaves.len(), corners.len()))?;
        }
        let hanging = organs.growth(organ);
        let node = hanging.node as usize;
        if node >= skeleton.positions.len() {
            return Err(RasterError::Inconsistent(node));
        }
        if style.until.is_some_and(|step| hanging.birth > step)
            || present.as_ref().is_some_and(|present| !present[node])
        {
            continue;
        }
        mesh.positions.clear();
        mesh.normals.clear();
        mesh.uvs.clear();
        mesh.triangles.clear();
        shaper.add(organs, organ, &mut mesh);
        let first = corners.len();
        let (mut depth_m, mut normal, mut shown) = (0.0, Vec3::ZERO, false);
        for triangle in &mesh.triangles {
            let seen = triangle.map(|corner| view.project(mesh.positions[corner as usize]));
            let [a, b, c] = seen.map(|seen| seen.at);
            shown |= a.max(b).max(c).cmpgt(Vec2::ZERO).all() && a.min(b).min(c).cmplt(frame).all();
            corners.push(if (b - a).perp_dot(c - a) > 0.0 { [a, c, b] } else { [a, b, c] });
            depth_m += seen[0].depth_m;
            normal += mesh.normals[triangle[0] as usize];
        }
        if !shown {
            corners.truncate(first);
            continue;
        }
        let tone = tone(view.turn(normal.normalize_or(Vec3::Y)));
        let color = bytes(linear(style.organ_color(organs, organ).unwrap_or(style.ink)) * tone);
        depth_m /= mesh.triangles.len().max(1) as f32;
        leaves.push(Leaf { depth_m, color, triangles: first..corners.len() });
    }
    ledger.grow(&mut bytes_held, bytes_of_lists(leaves.len(), corners.len()))?;
    leaves.sort_unstable_by(|a, b| {
        b.depth_m.total_cmp(&a.depth_m).then(a.triangles.start.cmp(&b.triangles.start))
    });
    // A shape, three points and an end for each triangle, in lists that are made once.
    let bytes = bytes_of::<Shape>(leaves.len())
        + bytes_of::<[Vec2; 3]>(corners.len())
        + bytes_of::<u32>(corners.len());
    // What the wood drew is there twice while it moves into them.
    let moving = drawing.bytes();
    ledger.take(bytes + moving)?;
    drawing.shapes.reserve_exact(leaves.len());
    drawing.points.reserve_exact(3 * corners.len());
    drawing.ends.reserve_exact(corners.len());
    for leaf in &leaves {
        drawing.shape(Kind::Rings, leaf.color, 1.0, |drawing| {
            for triangle in &corners[leaf.triangles.clone()] {
                drawing.points.extend_from_slice(triangle);
                drawing.end_line();
            }
        });
    }
    ledger.give_back(bytes_held + moving);
    Ok(())
}

/// One of a few tones by where a leaf faces in the camera's axes, so that one is told from the next: it is no
/// light, only as if some came over the left shoulder.
fn tone(normal: Vec3) -> f32 {
    let normal = if normal.z < 0.0 { -normal } else { normal };
    let facing = (normal.dot(Vec3::new(-0.527, 0.685, 0.503)) + 0.35) / 1.35;
    let facing = (0.24 + 0.10 * normal.y + 1.10 * facing.max(0.0)).clamp(0.0, 1.2) / 1.2;
    0.72 + 0.4 * (facing * TONES).round() / TONES
}

/// Linear light as bytes.
pub(super) fn bytes(light: Vec3) -> [u8; 3] {
    (encoded(light) * 255.0 + 0.5).to_array().map(|c| c as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_all_lines_in_order_and_none_too_many_points() {
        let most = MOST_POINTS as u32;
        for lines in
            [vec![], vec![5], vec![most + 7], vec![2; 20_000], vec![most / 2; 5], vec![1, most, 1, 3 * most]]
        {
            let ends: Vec<u32> = lines
                .iter()
                .scan(0, |end, line| {
                    *end += line;
                    Some(*end)
                })
                .collect();
            let found: Vec<&[u32]> = parts(&ends).collect();
            assert_eq!(found.concat(), ends);
            let mut from = 0;
            for part in found {
                let to = part[part.len() - 1];
                assert!(to - from <= most || part.len() == 1, "{from} {to}");
                from = to;
            }
        }
    }
}
