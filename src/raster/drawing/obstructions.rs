//! What stands beside the plant, below it: its silhouette as a thin wash, its edges as lines.

use linden_pipeline::Monitor;
use linden_pipeline::grow::Obstructs;

use super::{Drawing, Kind};
use crate::strokes::obstructions::{dashes, is_facing, lines};
use crate::{Extent, RasterError, Style, View};

/// How much the wash hides, of what no branch enters and of what takes light away.
const WASH: [f32; 2] = [0.3, 0.16];

/// All obstructions of the style.
pub(super) fn trace(
    drawing: &mut Drawing,
    framed: &Extent,
    view: &View,
    style: &Style,
    monitor: &dyn Monitor,
) -> Result<(), RasterError> {
    let least = drawing.size.width().min(drawing.size.height()) as f32;
    let width = (least / 420.0).clamp(0.8, 2.5);
    let dash_m = framed.height().max(2.0 * framed.radius()).max(1e-6) / 40.0;
    for solid in style.obstructions {
        monitor.check()?;
        let (color, wash) = match solid.effect {
            Obstructs::Branches => (style.obstacle, WASH[0]),
            Obstructs::Light => (style.shade, WASH[1]),
        };
        drawing.shape(Kind::Rings, color, wash, |drawing| {
            for triangle in (0..solid.triangles.len() as u32).filter(|t| is_facing(solid, *t, view)) {
                drawing.points.extend(solid.corners(triangle).map(|place| view.project(place).at));
                drawing.end_line();
            }
        });
        drawing.shape(Kind::Lines { width }, color, 0.8, |drawing| {
            for line in lines(solid, view) {
                let dash_m = if solid.effect == Obstructs::Light { dash_m } else { f32::INFINITY };
                let pieces = dashes(line, dash_m).take(if dash_m.is_finite() { usize::MAX } else { 0 });
                let whole = (!dash_m.is_finite()).then_some(line);
                for piece in pieces.chain(whole) {
                    drawing.points.extend(piece.map(|place| view.project(place).at));
                    drawing.end_line();
                }
            }
        });
    }
    Ok(())
}
