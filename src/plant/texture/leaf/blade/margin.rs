//! Teeth along an outline.

use glam::Vec2;

use crate::texture::leaf::outline::Margin;
use linden_base::random::Key;

/// Points to one tooth.
const PER_TOOTH: usize = 12;

/// The outline with teeth on both sides. It runs from the foot to the tip, where y is largest, and
/// back; teeth are as many on each side, and smaller at both ends.
pub(super) fn toothed(outline: &[Vec2], margin: Margin, teeth: u32, depth: f32, key: Key) -> Vec<Vec2> {
    if margin == Margin::Entire || teeth == 0 || depth <= 0.0 || outline.len() < 3 {
        return outline.to_vec();
    }
    let tip = (0..outline.len()).fold(0, |best, i| if outline[i].y > outline[best].y { i } else { best });
    let right = &outline[..=tip];
    let mut left: Vec<Vec2> = outline[tip..].iter().copied().chain(outline.first().copied()).collect();
    left.reverse();
    let mut out = side(right, 1.0, margin, teeth, depth, key.named("right"));
    let back = side(&left, -1.0, margin, teeth, depth, key.named("left"));
    out.extend(back.into_iter().rev().skip(1));
    out.pop();
    out
}

/// One side from foot to tip; `sign` is that of its x.
fn side(points: &[Vec2], sign: f32, margin: Margin, teeth: u32, depth: f32, key: Key) -> Vec<Vec2> {
    let mut ends = Vec::with_capacity(points.len());
    let mut length = 0.0;
    for (i, &p) in points.iter().enumerate() {
        length += if i == 0 { 0.0 } else { p.distance(points[i - 1]) };
        ends.push(length);
    }
    let at = |s: f32| -> (Vec2, Vec2) {
        let i = ends.partition_point(|&end| end < s).clamp(1, points.len() - 1);
        let (a, b) = (points[i - 1], points[i]);
        let share = ((s - ends[i - 1]) / (ends[i] - ends[i - 1]).max(1e-9)).clamp(0.0, 1.0);
        (a.lerp(b, share), (b - a).normalize_or(Vec2::Y))
    };
    // Where teeth end: unequal ways, in their order.
    let mut marks = vec![0.0];
    for tooth in 0..u64::from(teeth) {
        let way = key.child(tooth).between(0.75, 1.25) as f32;
        marks.push(marks[tooth as usize] + way);
    }
    let total = marks.last().copied().unwrap_or(1.0);
    let mut out = vec![points[0]];
    for tooth in 0..teeth as usize {
        let (from, to) = (marks[tooth] / total, marks[tooth + 1] / total);
        let larger = key.child(tooth as u64).named("size").between(0.8, 1.2) as f32;
        for step in 1..=PER_TOOTH {
            let t = step as f32 / PER_TOOTH as f32;
            let share = from + (to - from) * t;
            let (p, along) = at(share * length);
            let out_of = Vec2::new(along.y, -along.x) * sign;
            // Nothing at the foot and at the tip.
            let ends = (share * 8.0).min((1.0 - share) * 10.0).clamp(0.0, 1.0);
            let (rise, lead) = match margin {
                Margin::Crenate => (1.0 - (2.0 * t - 1.0) * (2.0 * t - 1.0), 0.0),
                Margin::Doubly => doubly(t),
                // Out slowly along a bulge, back at once: teeth point to the tip.
                _ => sawtooth(t),
            };
            let size = depth * larger * ends;
            out.push(p + out_of * (rise * size) + along * (lead * size));
        }
    }
    if let (Some(last), Some(&tip)) = (out.last_mut(), points.last()) {
        *last = tip;
    }
    out
}

/// How far out and ahead a tooth is on its way from one notch to the next.
fn sawtooth(t: f32) -> (f32, f32) {
    const TOP: f32 = 0.75;
    if t < TOP {
        let s = t / TOP;
        (s * (1.15 - 0.15 * s), 0.7 * s * s)
    } else {
        let s = (1.0 - t) / (1.0 - TOP);
        (s, 0.7 * s)
    }
}

/// A tooth with smaller ones on its back.
fn doubly(t: f32) -> (f32, f32) {
    let (rise, lead) = sawtooth(t);
    let (small, ahead) = sawtooth((t * 3.0).fract());
    (rise + 0.35 * small, lead + 0.35 * ahead)
}
