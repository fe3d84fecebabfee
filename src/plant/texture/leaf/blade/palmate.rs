//! Pointed lobes around the petiole: maple, plane.

use glam::Vec2;

use super::BladeLook;
use super::lobed::Lobe;
use crate::texture::leaf::figure::heading;
use crate::texture::leaf::outline::Margin;
use linden_base::random::Key;

/// The outline, and its lobes: the first is the middle one, then right and left in turn.
pub(super) fn outline(look: &BladeLook, key: Key) -> (Vec<Vec2>, Vec<Lobe>) {
    let count = look.lobes.clamp(1, 13) | 1;
    let each_side = (count / 2) as usize;
    let right = Side::new(look, each_side, key.named("right"));
    let left = Side::new(look, each_side, key.named("left"));
    let mut outline = right.points(look, 1.0, key.named("right"));
    outline.extend(left.points(look, -1.0, key.named("left")).into_iter().rev().skip(1));
    outline.pop();
    let mut lobes = vec![[Vec2::ZERO, Vec2::Y]];
    for lobe in 1..=each_side {
        for (side, sign) in [(&right, 1.0), (&left, -1.0)] {
            let tip = side.tips[lobe];
            lobes.push([Vec2::ZERO, Vec2::new(sign * tip.x, tip.y)]);
        }
    }
    (outline, lobes)
}

/// The lobes of one side, from the middle one to the lowest.
struct Side {
    /// Where each ends.
    tips: Vec<Vec2>,
    /// Where the bay below each is.
    bays: Vec<Vec2>,
}

impl Side {
    fn new(look: &BladeLook, each_side: usize, key: Key) -> Self {
        let uneven =
            |name: &str, i: usize| look.variation * key.named(name).child(i as u64).between(-1.0, 1.0) as f32;
        let widen = look.width.clamp(0.2, 2.0) / 1.15;
        let share = |i: usize| i as f32 / each_side.max(1) as f32;
        // Lobes spread to somewhat below the horizontal, the lowest about half as long as the middle.
        let angles: Vec<f32> = (0..=each_side)
            .map(|i| {
                share(i) * (if each_side > 1 { 1.88 } else { 1.05 })
                    + if i > 0 { 0.06 * uneven("angle", i) } else { 0.0 }
            })
            .collect();
        let lengths: Vec<f32> = (0..=each_side)
            .map(|i| {
                let s = share(i);
                let length = if each_side > 1 { 1.0 - 0.10 * s - 0.36 * s * s * s } else { 1.0 - 0.25 * s };
                length * if i > 0 { 1.0 + 0.06 * uneven("length", i) } else { 1.0 }
            })
            .collect();
        let stretch = |p: Vec2| Vec2::new(p.x * widen, p.y);
        let tips = angles.iter().zip(&lengths).map(|(&a, &l)| stretch(heading(a) * l)).collect();
        let depth = look.lobe_depth.clamp(0.0, 0.95);
        let bays = (0..each_side)
            .map(|i| {
                let angle = f32::midpoint(angles[i], angles[i + 1]);
                let between = f32::midpoint(lengths[i], lengths[i + 1]);
                stretch(heading(angle) * between * (0.86 - 0.74 * depth))
            })
            .collect();
        Self { tips, bays }
    }

    /// From the foot round all lobes to the tip of the middle one.
    fn points(&self, look: &BladeLook, sign: f32, key: Key) -> Vec<Vec2> {
        let last = self.tips.len() - 1;
        let mut out = vec![Vec2::ZERO];
        let lowest = self.tips[last];
        if last > 0 {
            // The base: a shallow heart whose lower edge runs to the lowest lobe's tip.
            let below = Vec2::new(lowest.x * 0.32, lowest.y * 0.32 - 0.09);
            flank(&mut out, Vec2::ZERO, lowest, Vec2::ZERO.midpoint(below), look, key.child(100));
        }
        for lobe in (0..=last).rev() {
            let tip = self.tips[lobe];
            if lobe < last {
                // Up from the bay below it.
                flank(&mut out, self.bays[lobe], tip, tip * 0.5, look, key.child(lobe as u64));
            }
            if lobe > 0 {
                // Down into the bay above it.
                let bay = self.bays[lobe - 1];
                let mut back = Vec::new();
                flank(&mut back, bay, tip, tip * 0.5, look, key.child(50 + lobe as u64));
                back.reverse();
                out.extend(back.into_iter().skip(1));
            }
        }
        out.into_iter().map(|p| Vec2::new(sign * p.x, p.y)).collect()
    }
}

/// One edge of a lobe, from its bay to its tip, bulging away from the lobe's own axis.
fn flank(out: &mut Vec<Vec2>, bay: Vec2, tip: Vec2, axis: Vec2, look: &BladeLook, key: Key) {
    let length = tip.length();
    let along = tip.normalize_or(Vec2::Y);
    // To the side of the axis on which the bay lies.
    let side = bay - along * bay.dot(along);
    let away = if side.length() > 1e-4 {
        side.normalize()
    } else {
        (axis - along * axis.dot(along)).normalize_or(along.perp())
    };
    let base = bay.dot(along);
    let wide = bay.dot(away).max(0.0);
    let fine = look.teeth > 4;
    let coarse = look.margin != Margin::Entire && !fine;
    // The edge without teeth: nearly parallel to the axis, then in to the tip.
    let bulge = if coarse { 0.02 } else { 0.055 } * length;
    let edge = |t: f32| -> Vec2 {
        let narrowing = 1.0 - libm::powf(t, if coarse { 1.7 } else { 2.2 });
        let rise = 4.0 * t * (1.0 - t);
        along * (base + (length - base) * t) + away * (wide * narrowing + bulge * rise * (1.0 - 0.4 * t))
    };
    out.push(bay);
    if !coarse {
        let steps = 40_usize;
        let teeth = if look.margin == Margin::Entire { 0.0 } else { look.teeth as f32 };
        for step in 1..steps {
            let t = step as f32 / steps as f32;
            let tooth = if teeth > 0.0 { (t * teeth).fract() * look.tooth_depth * length } else { 0.0 };
            let ends = (8.0 * t).min(6.0 * (1.0 - t)).min(1.0);
            out.push(edge(t) + (away + along * 0.4) * (tooth * ends));
        }
        out.push(tip);
        return;
    }
    // Few large teeth with long points; between them the edge hangs in arcs.
    let teeth = look.teeth.clamp(1, 4);
    let mut from = bay;
    for tooth in 0..=teeth {
        let to = if tooth == teeth {
            tip
        } else {
            let uneven = look.variation * key.child(u64::from(tooth)).between(-0.05, 0.05) as f32;
            // The first tooth is the largest: the lobe's shoulder.
            let t = 0.40 + 0.50 * (tooth as f32 / teeth as f32) + uneven;
            let size = look.tooth_depth * length * (1.25 - 0.5 * tooth as f32 / teeth as f32);
            edge(t) + (away * 0.9 + along * 0.75) * size
        };
        let way = to - from;
        let inwards = -(away - along * 0.0);
        // The arc up to a tooth bows in towards the axis; the first one, out of the bay, less so.
        let sag = way.length() * if tooth == 0 { 0.06 } else { 0.2 };
        let mid = from.midpoint(to) + inwards * sag - along * (sag * if tooth == 0 { 0.0 } else { 0.3 });
        for step in 1..=10 {
            let t = step as f32 / 10.0;
            out.push(from * ((1.0 - t) * (1.0 - t)) + mid * (2.0 * t * (1.0 - t)) + to * (t * t));
        }
        from = to;
        if tooth < teeth {
            // Behind a tooth the edge goes back to the lobe: the notch is the next arc's beginning.
            let t = 0.40 + 0.50 * (tooth as f32 / teeth as f32) + 0.055;
            from = edge(t) - away * (0.25 * look.tooth_depth * length);
            out.push(to.midpoint(from) - away * (0.02 * length));
            out.push(from);
        }
    }
}
