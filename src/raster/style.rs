//! What a picture is painted with.

use glam::Vec3;

/// What the colour of the wood says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paint {
    /// Nothing: wood, twigs a little lighter than the trunk.
    #[default]
    Wood,
    /// The axis' order: 0 for a stem.
    Order,
    /// The radius, on a logarithmic scale from the thinnest to the thickest.
    Radius,
    /// The birth step.
    Birth,
}

impl Paint {
    /// Every way to paint: its name for users, and what it shows.
    pub const ALL: [(&'static str, Self, &'static str); 4] = [
        ("wood", Self::Wood, "the colour of bark"),
        ("order", Self::Order, "branching order, dark stem to bright twigs"),
        ("radius", Self::Radius, "thickness, dark thin to bright thick"),
        ("birth", Self::Birth, "when it grew, dark early to bright late"),
    ];

    /// The way to paint that a user means.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(n, _, _)| *n == name).map(|&(_, paint, _)| paint)
    }
}

/// What is behind the tree. Colours are sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Whatever the picture is laid over.
    Transparent,
    /// One colour.
    Plain([u8; 3]),
    /// From the picture's upper edge to its lower one.
    Gradient([u8; 3], [u8; 3]),
}

/// What a picture is painted with. Colours are sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style<'a> {
    /// What the wood's colour says.
    pub paint: Paint,
    /// What is behind.
    pub background: Background,
    /// The trunk's colour in [`Paint::Wood`].
    pub trunk: [u8; 3],
    /// The thinnest twigs' colour in [`Paint::Wood`].
    pub twig: [u8; 3],
    /// What distance fades to.
    pub haze: [u8; 3],
    /// How much of it the farthest node has, 0..1.
    pub haze_amount: f32,
    /// Whether the tree throws a soft shadow on the ground.
    pub ground_shadow: bool,
    /// Attraction points, metres: drawn as dots.
    pub points: &'a [Vec3],
    /// The dots' colour.
    pub point: [u8; 3],
}

impl Style<'_> {
    /// For a picture file: a bright backdrop and a soft shadow.
    pub const fn studio() -> Self {
        Self {
            paint: Paint::Wood,
            background: Background::Gradient([214, 224, 232], [245, 241, 233]),
            trunk: [112, 86, 64],
            twig: [120, 84, 54],
            haze: [196, 204, 208],
            haze_amount: 0.42,
            ground_shadow: true,
            points: &[],
            point: [40, 122, 184],
        }
    }

    /// To be laid over something dark: a terminal.
    pub const fn over_dark() -> Self {
        Self {
            paint: Paint::Wood,
            background: Background::Transparent,
            trunk: [176, 142, 112],
            twig: [206, 182, 142],
            haze: [74, 84, 104],
            haze_amount: 0.5,
            ground_shadow: false,
            points: &[],
            point: [96, 176, 232],
        }
    }

    /// To be laid over something bright.
    pub const fn over_light() -> Self {
        Self { background: Background::Transparent, ground_shadow: false, ..Self::studio() }
    }
}
