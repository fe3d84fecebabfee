//! The camera, and what is drawn of the tree.

use std::time::Instant;

use glam::Vec2;
use linden_raster::{Camera, Extent, Paint};

use crate::jobs::{Painted, PictureLook, ShownTree};

impl PictureLook {
    /// All, in the order in which a key goes through them.
    pub const ALL: [Self; 9] = [
        Self::Skeleton(Paint::Wood),
        Self::Skeleton(Paint::Order),
        Self::Skeleton(Paint::Radius),
        Self::Skeleton(Paint::Birth),
        Self::Skeleton(Paint::Light),
        Self::Skeleton(Paint::Source),
        Self::Skeleton(Paint::Distance),
        Self::Surface,
        Self::Turtle,
    ];

    /// What it is called, here and in the session's file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Turtle => "turtle",
            Self::Skeleton(Paint::Wood) => "skeleton",
            Self::Skeleton(Paint::Order) => "order",
            Self::Skeleton(Paint::Radius) => "radius",
            Self::Skeleton(Paint::Birth) => "birth",
            Self::Skeleton(Paint::Light) => "light",
            Self::Skeleton(Paint::Source) => "source",
            Self::Skeleton(Paint::Distance) => "distance",
        }
    }

    /// What a tree is drawn as until another look is chosen: with leaves its surface, which has them as they
    /// are.
    pub fn usual(shown: &ShownTree) -> Self {
        if shown.grown.organs.shapes.is_empty() { Self::Skeleton(Paint::Wood) } else { Self::Surface }
    }

    /// Why a tree is not drawn so; `None` where it is.
    pub fn hindrance(self, shown: &ShownTree) -> Option<&'static str> {
        match self {
            Self::Skeleton(paint) => paint.hindrance(&shown.grown.skeleton),
            Self::Surface | Self::Turtle => None,
        }
    }

    /// The look of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|look| look.name() == name)
    }
}

/// The camera, and what is drawn of the tree.
#[expect(clippy::struct_excessive_bools, reason = "switches that have nothing to do with each other")]
pub struct PictureState {
    /// From where.
    pub camera: Camera,
    /// What is drawn.
    pub look: PictureLook,
    /// Whether the look was chosen; otherwise each tree has its usual one.
    pub is_look_chosen: bool,
    /// The level of detail that is looked at, the finest being 0; `None` for all that grew.
    pub level: Option<usize>,
    /// The height above the foot at which the tree is cut, metres; `None`: it is whole.
    pub slice_m: Option<f32>,
    /// Whether the points of its scan are, or attraction points.
    pub points: bool,
    /// Whether the crown's outline is.
    pub outline: bool,
    /// Whether what stands in its way and what takes light from it is.
    pub obstructions: bool,
    /// Whether a person stands beside it, and a scale bar below.
    pub scale: bool,
    /// When the turntable last moved; `None` when it stands.
    pub turning: Option<Instant>,
    /// What is on screen.
    pub painted: Option<Box<Painted>>,
    /// Whether that is of what was chosen before, until there is a picture of what is chosen now.
    pub is_of_before: bool,
    /// When what it shows was left for something else.
    pub left_at: Option<Instant>,
    /// Whether the last one that was asked for could not be drawn.
    pub has_failed: bool,
    /// What stays framed while something is dragged, which would run away from the pointer otherwise.
    pub frozen: Option<Extent>,
    /// Where the pointer was while a button is down.
    pub drag: Option<(u16, u16)>,
    /// Whether the next tree is looked at from where the camera is.
    pub keeps_camera: bool,
    /// Whether full pictures come fast enough to do without drafts.
    pub fast: bool,
}

impl Default for PictureState {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            look: PictureLook::Skeleton(Paint::Wood),
            is_look_chosen: false,
            level: None,
            slice_m: None,
            points: false,
            outline: false,
            obstructions: true,
            scale: true,
            turning: None,
            painted: None,
            is_of_before: false,
            left_at: None,
            has_failed: false,
            frozen: None,
            drag: None,
            keeps_camera: false,
            fast: false,
        }
    }
}

impl PictureState {
    /// Whether the turntable turns.
    pub fn is_turning(&self) -> bool {
        self.turning.is_some()
    }

    /// Starts or stops the turntable.
    pub fn turn(&mut self, now: Option<Instant>) {
        self.turning = now;
    }

    /// Looks from where it was looked from last time, also when the tree has grown.
    pub fn restore(&mut self, yaw_deg: f32, pitch_deg: f32, zoom: f32, pan: Vec2) {
        self.camera = Camera { yaw_deg, pitch_deg, zoom, pan, eye_m: None, extent: None };
        self.keeps_camera = true;
    }
}
