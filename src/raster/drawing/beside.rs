//! What is drawn beside the plant: attraction points, the crown's outline, what is pointed at, a person, a scale.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use linden_pipeline::Monitor;

use super::outline::{Place, disc, tapered};
use super::trace::bytes;
use super::{Drawing, Kind, Word};
use crate::person::LIMBS;
use crate::strokes::handles::discs;
use crate::{Extent, RasterError, Style, View, nice_length_m};

/// Points between two looks at the monitor.
const CHECK_EVERY: usize = 1 << 14;
/// From this picture on, pixels of its shorter side, there is room for a scale.
const WITH_SCALE: u32 = 160;

/// Everything that the style lays over the plant, and the scale.
pub(super) fn trace(
    drawing: &mut Drawing,
    framed: &Extent,
    view: &View,
    style: &Style,
    monitor: &dyn Monitor,
) -> Result<(), RasterError> {
    let size = drawing.size;
    let least = size.width().min(size.height()) as f32;
    monitor.check()?;
    points(drawing, view, style, (least / 400.0).clamp(0.5, 3.0), monitor)?;
    let width = (least / 500.0).clamp(0.7, 2.0);
    drawing.shape(Kind::Lines { width }, style.line, 0.6, |drawing| {
        for line in style.outline {
            for part in line.split(|point| !point.is_finite()).filter(|part| part.len() > 1) {
                drawing.points.extend(part.iter().map(|&point| view.project(point).at));
                drawing.end_line();
            }
        }
    });
    let width = (least / 130.0).clamp(1.2, 7.0);
    drawing.shape(Kind::Lines { width }, style.mark, 0.9, |drawing| {
        for line in style.marked {
            for part in line.split(|point| !point.is_finite()).filter(|part| part.len() > 1) {
                drawing.points.extend(part.iter().map(|&point| view.project(point).at));
                drawing.end_line();
            }
        }
    });
    for handle in style.handles.iter().filter(|handle| handle.at.is_finite()) {
        let at = view.project(handle.at).at;
        for (color, radius_px) in discs(handle, style, least) {
            drawing.shape(Kind::Rings, color, 1.0, |drawing| disc(drawing, Place { at, half: radius_px }));
        }
    }
    if let Some(person) = framed.person.filter(|_| style.person) {
        let place = person.place(framed, view);
        let scale = view.project(place).scale;
        drawing.shape(Kind::Rings, style.person_color, 1.0, |drawing| {
            for limb in &LIMBS {
                let at = |k: usize| {
                    let p = limb.ends[k];
                    let at = view.project(place + view.right() * p.x + Vec3::Y * p.y).at;
                    Place { at, half: limb.radii[k] * scale }
                };
                tapered(drawing, &[at(0), at(1)], true);
            }
        });
    }
    if size.width().min(size.height()) >= WITH_SCALE {
        scale_bar(drawing, view, style);
    }
    Ok(())
}

/// The attraction points that are in sight, as dots.
fn points(
    drawing: &mut Drawing,
    view: &View,
    style: &Style,
    half: f32,
    monitor: &dyn Monitor,
) -> Result<(), RasterError> {
    let frame = Vec2::new(drawing.size.width() as f32, drawing.size.height() as f32);
    let color_of = style.point_colors();
    let mut by_color: BTreeMap<[u8; 3], Vec<Vec2>> = BTreeMap::new();
    for (i, point) in style.points.iter().enumerate() {
        if i % CHECK_EVERY == 0 {
            monitor.check()?;
        }
        let at = view.project(*point).at;
        if point.is_finite() && at.cmpge(Vec2::ZERO).all() && at.cmple(frame).all() {
            by_color.entry(bytes(color_of(i))).or_default().push(at);
        }
    }
    for (color, places) in by_color {
        for part in places.chunks(CHECK_EVERY) {
            monitor.check()?;
            drawing.shape(Kind::Rings, color, 0.85, |drawing| {
                for &at in part {
                    disc(drawing, Place { at, half });
                }
            });
        }
    }
    Ok(())
}

/// A bar of a round length at the lower left, with the length above it.
fn scale_bar(drawing: &mut Drawing, view: &View, style: &Style) {
    let (wide, high) = (drawing.size.width() as f32, drawing.size.height() as f32);
    let unit = wide.min(high) / 40.0;
    let Some((length_m, px)) = nice_length_m(wide / 5.0, view.scale_at_target()) else { return };
    let (left, right, y) = (unit * 1.5, unit * 1.5 + px, high - unit * 1.5);
    let tick = unit * 0.35;
    let width = (unit / 12.0).clamp(1.0, 3.0);
    drawing.shape(Kind::Lines { width }, style.ink, 1.0, |drawing| {
        let corners = [(left, y - tick), (left, y), (right, y), (right, y - tick)];
        drawing.points.extend(corners.map(Vec2::from));
        drawing.end_line();
    });
    let text = length(length_m);
    drawing.words.push(Word {
        text,
        at: Vec2::new(left, y - 2.2 * tick),
        height: unit * 0.75,
        color: style.ink,
    });
}

/// A round length with its unit.
fn length(metres: f32) -> String {
    let m = f64::from(metres);
    match m {
        _ if m >= 0.995 => format!("{} m", m.round()),
        _ if m >= 0.00995 => format!("{} cm", (m * 100.0).round()),
        _ if m >= 0.000_995 => format!("{} mm", (m * 1000.0).round()),
        _ => format!("{m:.0e} m"),
    }
}
