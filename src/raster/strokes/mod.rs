//! Strokes: whatever is drawn as a line or a dot; and leaves, which lie among them.
//!
//! A stroke is tapered and lies in the picture's plane. Strokes that follow each other along a line
//! make a run; runs are drawn far to near. Within a run nothing is counted twice: where the parts
//! of a polyline meet, the pixel shows the line, not a knot.
//!
//! Ours, where flat drawings ([`crate::drawing`]) are tiny-skia's: a stroke has a depth, light across it and
//! an exact coverage in linear light, and lies among the samples of a surface too. A crown is mostly twigs
//! that are half a pixel wide; quarters of a pixel in eight bits, as tiny-skia counts, would show as steps.

mod coverage;
mod draft;
pub(crate) mod handles;
pub(crate) mod leaves;
#[cfg(test)]
mod obstruction_tests;
pub(crate) mod obstructions;
pub(crate) mod overlay;
pub(crate) mod paint;
pub(crate) mod trace;

use glam::{Vec2, Vec3};
use linden_pipeline::memory::{OverMemory, bytes_of};

use crate::light::Bar;
use crate::memory::Ledger;

/// A tapered stroke.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    /// Ends, pixels. The same point for a dot.
    pub ends: [Vec2; 2],
    /// Half widths there, pixels.
    pub half_widths: [f32; 2],
    /// From the lens, metres.
    pub depth_m: f32,
    /// How much of what is behind it hides.
    pub alpha: f32,
    /// Linear light; before the light of `bar` falls on it where there is one.
    pub color: Vec3,
    /// For thick strokes of wood: the light across.
    pub bar: Option<Bar>,
    pub caps: [Cap; 2],
}

/// How a stroke ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cap {
    /// In a half disc: where thick wood ends or bends.
    Round,
    /// Across.
    Cut,
    /// Across, up to half a pixel farther: where another run takes over. Two half covered pixels over
    /// each other would let through a quarter of what is behind.
    Seam,
}

/// How the strokes of a run are covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Cut ends that add up where two strokes meet.
    Thin,
    /// Round ends; where strokes overlap, the one that covers more counts.
    Thick,
    /// Not strokes but facets: triangles that add up where they meet.
    Facets,
}

/// Consecutive strokes that are drawn as one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub first: u32,
    pub len: u32,
    pub kind: Kind,
    /// Of the middle, from the lens, metres.
    pub depth_m: f32,
    /// Rows that it touches, pixels.
    pub rows: [f32; 2],
}

/// Strokes in one run: enough for any twig, few enough to be sorted by depth and to be cancelled.
const LONGEST_RUN: u32 = 256;
/// Cosine of the bend up to which thick wood may be cut across at a seam.
const STRAIGHT: f32 = 0.995;

/// A triangle of a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    /// Pixels.
    pub corners: [Vec2; 3],
    /// Linear light.
    pub color: Vec3,
    /// How much of what is behind it hides.
    pub alpha: f32,
}

/// Runs and their strokes and facets.
#[derive(Debug, Default)]
pub(crate) struct Runs {
    pub strokes: Vec<Stroke>,
    pub facets: Vec<Facet>,
    pub sequence: Vec<Run>,
}

impl Runs {
    /// Bytes that they take, reserved places included.
    pub fn bytes(&self) -> u64 {
        bytes_of::<Stroke>(self.strokes.capacity())
            + bytes_of::<Facet>(self.facets.capacity())
            + bytes_of::<Run>(self.sequence.capacity())
    }

    /// Adds a stroke that continues no other.
    pub fn begin(&mut self, kind: Kind, stroke: Stroke) {
        let first = self.strokes.len() as u32;
        self.sequence.push(Run { first, len: 1, kind, depth_m: stroke.depth_m, rows: rows(&stroke) });
        self.strokes.push(stroke);
    }

    /// Adds a stroke that starts where the last one ends: to its run where both are of a kind and,
    /// within `slice_m`, of a depth.
    pub fn follow(&mut self, kind: Kind, mut stroke: Stroke, slice_m: f32) {
        let last = self.sequence.last().filter(|run| run.kind != Kind::Facets);
        let begun = last.map(|run| self.strokes[run.first as usize].depth_m);
        if let (Some(run), Some(begun)) = (self.sequence.last_mut(), begun) {
            let near = (stroke.depth_m - begun).abs() <= slice_m;
            if near && run.kind == kind && run.len < LONGEST_RUN {
                run.len += 1;
                let [top, bottom] = rows(&stroke);
                run.rows = [run.rows[0].min(top), run.rows[1].max(bottom)];
                run.depth_m = f32::midpoint(begun, stroke.depth_m);
                self.strokes.push(stroke);
                return;
            }
            if kind == Kind::Thick && run.kind == Kind::Thin {
                stroke.caps[0] = Cap::Round;
            }
            let straight =
                kind == Kind::Thin || self.strokes.last().is_some_and(|last| is_straight(last, &stroke));
            if kind == run.kind && straight {
                stroke.caps[0] = Cap::Seam;
                if let (Kind::Thick, Some(last)) = (kind, self.strokes.last_mut()) {
                    last.caps[1] = Cap::Cut;
                }
            }
        }
        self.begin(kind, stroke);
    }

    /// Adds facets that are drawn as one.
    pub fn facets(&mut self, facets: &[Facet], depth_m: f32) {
        let ys = || facets.iter().flat_map(|facet| facet.corners).map(|corner| corner.y);
        let rows = [ys().fold(f32::INFINITY, f32::min), ys().fold(f32::NEG_INFINITY, f32::max)];
        let first = self.facets.len() as u32;
        self.sequence.push(Run { first, len: facets.len() as u32, kind: Kind::Facets, depth_m, rows });
        self.facets.extend_from_slice(facets);
    }

    /// All of some, one after the other.
    pub fn together(parts: Vec<Self>, ledger: &Ledger<'_>) -> Result<Self, OverMemory> {
        let sum = |count: fn(&Self) -> usize| parts.iter().map(count).sum::<usize>();
        let (strokes, facets) = (sum(|runs| runs.strokes.len()), sum(|runs| runs.facets.len()));
        let sequence = sum(|runs| runs.sequence.len());
        ledger.take(bytes_of::<Stroke>(strokes) + bytes_of::<Facet>(facets) + bytes_of::<Run>(sequence))?;
        let mut all = Self {
            strokes: Vec::with_capacity(strokes),
            facets: Vec::with_capacity(facets),
            sequence: Vec::with_capacity(sequence),
        };
        for part in parts {
            ledger.give_back(part.bytes());
            all.append(&part);
        }
        Ok(all)
    }

    /// Adds all of another.
    fn append(&mut self, other: &Self) {
        let (strokes, facets) = (self.strokes.len() as u32, self.facets.len() as u32);
        self.strokes.extend_from_slice(&other.strokes);
        self.facets.extend_from_slice(&other.facets);
        self.sequence.extend(other.sequence.iter().map(|run| {
            let shift = if run.kind == Kind::Facets { facets } else { strokes };
            Run { first: run.first + shift, ..*run }
        }));
    }
}

fn is_straight(first: &Stroke, second: &Stroke) -> bool {
    let way = |stroke: &Stroke| (stroke.ends[1] - stroke.ends[0]).normalize_or_zero();
    way(first).dot(way(second)) > STRAIGHT
}

fn rows(stroke: &Stroke) -> [f32; 2] {
    let reach = stroke.half_widths[0].max(stroke.half_widths[1]) + 1.5;
    let [a, b] = stroke.ends.map(|p| p.y);
    [a.min(b) - reach, a.max(b) + reach]
}
