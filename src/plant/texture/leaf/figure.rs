//! What a picture is made of: pieces, from the lowest to the uppermost.
//!
//! A figure has its foot at the origin and grows along +Y; one unit is its whole length. A piece is
//! one blade, petiole, needle or fruit, with its outline, its veins and the numbers of its skin.

use glam::{Affine2, Mat2, Vec2, Vec3};

use linden_base::memory::bytes_of;

/// How much more veins show on the under side of a leaf.
const UNDER_VEINS: f32 = 1.3;

/// A drawn thing as lines: what [`super::paint`] makes pixels of.
#[derive(Clone, Debug, Default)]
pub(super) struct Figure {
    /// From the lowest to the uppermost.
    pub pieces: Vec<Piece>,
    /// The middle of a spot that has the colour of stalks, where one is drawn for its own sake.
    pub stalk: Option<Vec2>,
}

impl Figure {
    /// Bytes on the heap.
    pub fn bytes(&self) -> u64 {
        let of = |piece: &Piece| {
            let lines: u64 = piece.veins.iter().map(|vein| bytes_of::<Vec2>(vein.points.capacity())).sum();
            bytes_of::<Vec2>(piece.outline.capacity()) + bytes_of::<Vein>(piece.veins.capacity()) + lines
        };
        bytes_of::<Piece>(self.pieces.capacity()) + self.pieces.iter().map(of).sum::<u64>()
    }
}

/// One part with an outline of its own.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Corners without crossings, in either direction; not closed.
    pub outline: Vec<Vec2>,
    pub veins: Vec<Vein>,
    /// From the piece's own coordinates (x across, y from 0 at its foot to 1 at its tip) to the figure's.
    pub frame: Affine2,
    /// The midrib is x = bend · y² in the piece's coordinates.
    pub bend: f32,
    /// From side to side, about: how far its shadow and its ribs reach follows from it.
    pub breadth: f32,
    pub skin: Skin,
}

/// A line that gets thinner.
#[derive(Clone, Debug)]
pub(super) struct Vein {
    pub points: Vec<Vec2>,
    /// Half its width where it begins and where it ends.
    pub radius: [f32; 2],
    /// Whether the blade bulges between it and its like.
    pub is_rib: bool,
}

/// Colours (linear light) and relief of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Skin {
    /// Where nothing else is.
    pub color: Vec3,
    /// The colour of what autumn has reached: away from the ribs first.
    pub patch: Vec3,
    /// How much it has reached, 0..1.
    pub patch_share: f32,
    pub vein: Vec3,
    /// How much veins differ from the blade, 0..1.
    pub vein_strength: f32,
    /// Towards the foot: pale petals have a deep throat, leaves a lighter base.
    pub foot: Vec3,
    /// How far up that reaches, in lengths of the piece.
    pub foot_reach: f32,
    /// Random light and dark, as a share.
    pub mottle: f32,
    /// Slope of both halves up from the midrib.
    pub fold: f32,
    /// Slope at the tip, downwards; 0 at the foot.
    pub droop: f32,
    /// Slope beside ribs: how much the blade bulges between them.
    pub pillow: f32,
    /// Width over which the edge is rounded off, in units of the figure; 0 is a sheet of paper.
    pub bevel: f32,
    /// Where the piece as a whole looks: what is added to its normals.
    pub lean: Vec2,
    /// How dark it makes what is under it beside its edge, 0..1.
    pub shadow: f32,
    /// Where it lies in the noise.
    pub place: Vec2,
}

impl Default for Skin {
    fn default() -> Self {
        Self {
            color: Vec3::splat(0.2),
            patch: Vec3::splat(0.2),
            patch_share: 0.0,
            vein: Vec3::splat(0.3),
            vein_strength: 0.0,
            foot: Vec3::splat(0.2),
            foot_reach: 0.0,
            mottle: 0.1,
            fold: 0.0,
            droop: 0.0,
            pillow: 0.0,
            bevel: 0.0,
            lean: Vec2::ZERO,
            shadow: 0.0,
            place: Vec2::ZERO,
        }
    }
}

impl Piece {
    /// A tapered line with round flanks: petioles, twigs, needles.
    pub fn stroke(points: &[Vec2], radius: [f32; 2], skin: Skin) -> Self {
        let count = points.len().max(2) - 1;
        let side = |sign: f32| {
            points.iter().enumerate().map(move |(i, &p)| {
                let (before, after) = (points[i.saturating_sub(1)], points[(i + 1).min(count)]);
                let along = (after - before).normalize_or(Vec2::Y);
                let share = i as f32 / count as f32;
                p + along.perp() * (sign * (radius[0] + (radius[1] - radius[0]) * share))
            })
        };
        let mut outline: Vec<Vec2> = side(-1.0).collect();
        // A tip of three corners is round enough at the width of strokes.
        if let [.., before, tip] = *points {
            outline.push(tip + (tip - before).normalize_or(Vec2::Y) * radius[1]);
        }
        outline.extend(side(1.0).collect::<Vec<_>>().into_iter().rev());
        let (foot, tip) =
            (points.first().copied().unwrap_or_default(), points.last().copied().unwrap_or_default());
        Self {
            outline,
            veins: Vec::new(),
            frame: frame(foot, tip - foot, 1.0),
            bend: 0.0,
            breadth: radius[0] + radius[1],
            skin: Skin { bevel: radius[0].max(radius[1]), ..skin },
        }
    }

    /// A round thing that bulges: fruit, anthers, buds.
    pub fn ball(center: Vec2, radius: f32, skin: Skin) -> Self {
        let outline = (0..40)
            .map(|i| {
                let (s, c) = libm::sincosf(i as f32 / 40.0 * std::f32::consts::TAU);
                center + Vec2::new(c, s) * radius
            })
            .collect();
        let frame = frame(center - Vec2::new(0.0, radius), Vec2::new(0.0, 2.0 * radius), 1.0);
        Self {
            outline,
            veins: Vec::new(),
            frame,
            bend: 0.0,
            breadth: 2.0 * radius,
            skin: Skin { bevel: radius, ..skin },
        }
    }

    /// Moves it.
    fn transform(&mut self, by: &Affine2) {
        let scale = libm::sqrtf(by.matrix2.determinant().abs());
        self.outline.iter_mut().for_each(|p| *p = by.transform_point2(*p));
        for vein in &mut self.veins {
            vein.points.iter_mut().for_each(|p| *p = by.transform_point2(*p));
            vein.radius = vein.radius.map(|r| r * scale);
        }
        self.frame = *by * self.frame;
        self.skin.bevel *= scale;
        self.breadth *= scale;
    }
}

impl Figure {
    /// Adds another figure, moved.
    pub fn add(&mut self, other: &Self, by: &Affine2) {
        self.pieces.extend(other.pieces.iter().cloned().map(|mut piece| {
            piece.transform(by);
            piece
        }));
    }

    /// The same from behind, as it would be seen through it: what was uppermost is lowest, what bulged is hollow, and
    /// veins stand out.
    pub fn turned_over(mut self) -> Self {
        self.pieces.reverse();
        for Skin { vein_strength, fold, droop, pillow, lean, .. } in
            self.pieces.iter_mut().map(|piece| &mut piece.skin)
        {
            *vein_strength = (*vein_strength * UNDER_VEINS).min(1.0);
            (*fold, *droop, *pillow, *lean) = (-*fold, -*droop, -*pillow, -*lean);
        }
        self
    }

    /// The corners of the box around it.
    pub fn bounds(&self) -> (Vec2, Vec2) {
        self.points().fold((Vec2::ZERO, Vec2::ZERO), |(min, max), p| (min.min(p), max.max(p)))
    }

    /// All corners of all outlines.
    pub fn points(&self) -> impl Iterator<Item = Vec2> {
        self.pieces.iter().flat_map(|piece| piece.outline.iter().copied())
    }
}

/// Places a piece: takes its coordinates to others, where (0, 0) goes to `foot` and (0, 1) to
/// `foot + along`; what is across is scaled by `across` more.
pub(super) fn frame(foot: Vec2, along: Vec2, across: f32) -> Affine2 {
    Affine2::from_mat2_translation(Mat2::from_cols(-along.perp() * across, along), foot)
}

/// A direction from an angle to the right of +Y, radians.
pub(super) fn heading(angle_rad: f32) -> Vec2 {
    let (s, c) = libm::sincosf(angle_rad);
    Vec2::new(s, c)
}
