//! What a picture is painted with.

use glam::Vec3;
use linden_pipeline::Skeleton;
use linden_pipeline::foliage::Organs;
use linden_pipeline::grow::Obstruction;

use crate::Extent;
use crate::color::{linear, ramp};

/// The quantity that the colour of the wood shows.
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
    /// How much of the sky it sees.
    Light,
    /// Where the radius of a scanned tree comes from.
    Source,
    /// How far a scanned tree is from the points, up to [`Paint::FAR_M`].
    Distance,
}

impl Paint {
    /// Every way to paint: its name for users, and what it shows.
    pub const ALL: [(&'static str, Self, &'static str); 7] = [
        ("wood", Self::Wood, "the colour of bark"),
        ("order", Self::Order, "branching order, dark stem to bright twigs"),
        ("radius", Self::Radius, "thickness, dark thin to bright thick"),
        ("birth", Self::Birth, "when it grew, dark early to bright late"),
        ("light", Self::Light, "how much of the sky it sees, dark in the shade to bright in the open"),
        (
            "source",
            Self::Source,
            "of a scan: whether its thickness was measured (bright), carried on or guessed (dark)",
        ),
        ("distance", Self::Distance, "of a scan: how far bark and points are apart, dark 0 to bright 10 cm"),
    ];

    /// From this distance on all have the same colour in [`Paint::Distance`], metres.
    pub const FAR_M: f32 = 0.1;

    /// Why a skeleton has nothing that it could show; `None` where it has.
    pub fn hindrance(self, skeleton: &Skeleton) -> Option<&'static str> {
        let is_of_scans = matches!(self, Self::Source | Self::Distance);
        (is_of_scans && skeleton.fits.is_empty())
            .then_some("it is for trees whose radii were measured on a scan, as they grew")
    }

    /// The way to paint that a user means.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(n, _, _)| *n == name).map(|&(_, paint, _)| paint)
    }
}

/// The background of a picture. Colours are sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Whatever the picture is laid over.
    Transparent,
    /// One colour.
    Plain([u8; 3]),
    /// From the picture's upper edge to its lower one.
    Gradient([u8; 3], [u8; 3]),
    /// Level ground below a sky, as the camera sees them.
    Landscape(Landscape),
}

/// Level ground that fades into a sky. Colours are sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Landscape {
    /// High above.
    pub sky: [u8; 3],
    /// Where sky and ground meet.
    pub horizon: [u8; 3],
    /// Below the tree.
    pub ground: [u8; 3],
}

impl Landscape {
    /// A bright studio.
    pub const STUDIO: Self = Self { sky: [176, 203, 228], horizon: [240, 240, 236], ground: [206, 203, 190] };

    /// Dusk over a dark terminal, or a bright day over a light one, in keeping with its background.
    pub fn over(background: [u8; 3], dark: bool) -> Self {
        let near = |color: [u8; 3], share: f32| {
            let mixed = |i: usize| f32::from(background[i]) * share + f32::from(color[i]) * (1.0 - share);
            std::array::from_fn(|i| mixed(i).round() as u8)
        };
        if dark {
            Self {
                sky: near([22, 32, 54], 0.45),
                horizon: near([84, 96, 116], 0.3),
                ground: near([58, 58, 54], 0.3),
            }
        } else {
            Self {
                sky: near([166, 198, 230], 0.25),
                horizon: near([243, 243, 240], 0.5),
                ground: near([206, 203, 190], 0.2),
            }
        }
    }
}

/// A place in a picture that can be taken hold of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle {
    /// Metres.
    pub at: Vec3,
    /// Whether it is the one that moves.
    pub is_picked: bool,
}

/// The style of a picture. Colours are sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "switches that have nothing to do with each other")]
pub struct Style<'a> {
    /// The quantity that the wood's colour shows.
    pub paint: Paint,
    /// The background.
    pub background: Background,
    /// The trunk's colour in [`Paint::Wood`].
    pub trunk: [u8; 3],
    /// The thinnest twigs' colour in [`Paint::Wood`].
    pub twig: [u8; 3],
    /// The colour of wood in a flat drawing ([`crate::Drawing`]), and of its scale.
    pub ink: [u8; 3],
    /// The colour that distance fades to.
    pub haze: [u8; 3],
    /// How much of it the farthest node has, 0..1.
    pub haze_amount: f32,
    /// Whether the tree throws a soft shadow on the ground.
    pub ground_shadow: bool,
    /// Whether soft gradients of the background are dithered. Without, they take far fewer bytes.
    pub grain: bool,
    /// Attraction points, metres: drawn as dots.
    pub points: &'a [Vec3],
    /// The dots' colour.
    pub point: [u8; 3],
    /// How far each dot is from the bark, metres, or nothing: their colour in [`Paint::Distance`].
    pub point_gaps_m: &'a [f32],
    /// Polylines, metres, drawn as thin lines: the crown's outline.
    pub outline: &'a [Vec<Vec3>],
    /// The lines' colour.
    pub line: [u8; 3],
    /// What stands in the tree's way, and what takes light from it: solids that can be seen through.
    pub obstructions: &'a [Obstruction],
    /// The colour of what no branch enters.
    pub obstacle: [u8; 3],
    /// The colour of what takes light away.
    pub shade: [u8; 3],
    /// Polylines, metres, drawn over everything as thick lines: what is pointed at.
    pub marked: &'a [Vec<Vec3>],
    /// Places that can be taken hold of, drawn over everything as discs.
    pub handles: &'a [Handle],
    /// The colour of both.
    pub mark: [u8; 3],
    /// Whether a person stands beside the tree, for scale: see [`Extent::with_person`].
    pub person: bool,
    /// The person's colour.
    pub person_color: [u8; 3],
    /// Leaves and other organs on a skeleton. A surface has them as meshes.
    pub organs: Option<&'a Organs>,
    /// The colours of the organs in [`Paint::Wood`], by their index; the last is that of all higher
    /// ones. Elsewhere organs have the colour of the wood that they hang on.
    pub leaf_colors: &'a [[u8; 3]],
    /// Draws a skeleton as it was at this step: the nodes born by then that stand on others born by
    /// then, as thick as they are now. What is framed stays the same. A surface has no births: sweep
    /// [`Skeleton::until`] instead, which also has the radii of that time.
    pub until: Option<u32>,
    /// Draws less, fast: for a picture that is replaced in a moment. Of many fine twigs some stand
    /// for all, the same ones from every side.
    pub draft: bool,
    /// The light on surfaces: 1 before a bright backdrop, more where the picture is laid over
    /// something dark.
    pub exposure: f32,
}

impl Style<'_> {
    /// Everything that a picture of a skeleton shows, which is what it frames when the camera has no
    /// extent: the tree, the points, the outline, what stands in the way, and the person if there is to be one and the plant
    /// is large enough ([`Extent::person`] tells). `None` when there is nothing at all.
    pub fn extent(&self, skeleton: &Skeleton) -> Option<Extent> {
        let extent = self.extent_without_person(skeleton)?;
        Some(match foot(skeleton).filter(|_| self.person) {
            Some(foot) => extent.with_person(foot.y),
            None => extent,
        })
    }

    pub(crate) fn extent_without_person(&self, skeleton: &Skeleton) -> Option<Extent> {
        let organs = self.organs.filter(|organs| !organs.is_empty());
        if self.outline.is_empty() && organs.is_none() && self.obstructions.is_empty() {
            return Extent::of(skeleton, self.points);
        }
        let given = self.points.iter().chain(self.outline.iter().flatten()).copied();
        let mut all: Vec<Vec3> = given.chain(organs.into_iter().flat_map(Organs::hull)).collect();
        let tree = Extent::of(skeleton, &all)?;
        if self.obstructions.is_empty() {
            return Some(tree);
        }
        all.extend(tree.in_reach(self.obstructions));
        Extent::of(skeleton, &all)
    }

    /// For a picture file: a bright landscape and a soft shadow.
    pub const fn studio() -> Self {
        Self {
            paint: Paint::Wood,
            background: Background::Landscape(Landscape::STUDIO),
            trunk: [112, 86, 64],
            twig: [120, 84, 54],
            ink: [44, 36, 30],
            haze: [196, 204, 208],
            haze_amount: 0.26,
            ground_shadow: true,
            grain: true,
            points: &[],
            point: [40, 122, 184],
            point_gaps_m: &[],
            outline: &[],
            line: [70, 128, 150],
            obstructions: &[],
            obstacle: [150, 148, 146],
            shade: [78, 84, 132],
            marked: &[],
            handles: &[],
            mark: [255, 166, 48],
            person: false,
            person_color: [150, 157, 166],
            organs: None,
            leaf_colors: &[],
            until: None,
            draft: false,
            exposure: 1.2,
        }
    }

    /// The same for a skeleton: wood, where it has nothing that the colour could show.
    pub(crate) fn suited(&self, skeleton: &Skeleton) -> Self {
        let paint = if self.paint.hindrance(skeleton).is_some() { Paint::Wood } else { self.paint };
        Self { paint, ..*self }
    }

    /// The linear colour of each dot.
    pub(crate) fn point_colors(&self) -> impl Fn(usize) -> Vec3 + use<'_> {
        let plain = linear(self.point);
        let gaps_m = if self.paint == Paint::Distance { self.point_gaps_m } else { &[] };
        move |point| gaps_m.get(point).map_or(plain, |gap_m| ramp((gap_m / Paint::FAR_M).min(1.0)))
    }

    /// The sRGB colour of an organ: of its kind, or else the one of [`Style::leaf_colors`] that it names.
    pub(crate) fn organ_color(&self, organs: &Organs, organ: usize) -> Option<[u8; 3]> {
        organs.color(organ).or_else(|| {
            let last = self.leaf_colors.len().saturating_sub(1);
            self.leaf_colors.get((organs.growth(organ).color as usize).min(last)).copied()
        })
    }

    /// For a flat drawing in a file: ink on white paper.
    pub const fn paper() -> Self {
        Self { background: Background::Plain([255; 3]), ground_shadow: false, ..Self::studio() }
    }

    /// To be laid over something dark: a terminal.
    pub const fn over_dark() -> Self {
        Self {
            paint: Paint::Wood,
            background: Background::Transparent,
            trunk: [176, 142, 112],
            twig: [206, 182, 142],
            ink: [214, 194, 158],
            haze: [74, 84, 104],
            haze_amount: 0.4,
            ground_shadow: false,
            grain: false,
            points: &[],
            point: [96, 176, 232],
            point_gaps_m: &[],
            outline: &[],
            line: [94, 150, 170],
            obstructions: &[],
            obstacle: [150, 152, 160],
            shade: [132, 140, 214],
            marked: &[],
            handles: &[],
            mark: [255, 166, 48],
            person: false,
            person_color: [98, 108, 126],
            organs: None,
            leaf_colors: &[],
            until: None,
            draft: false,
            exposure: 1.3,
        }
    }

    /// For a terminal with a background: the tree in a landscape that is in keeping with it.
    pub fn landscape(background: [u8; 3], dark: bool) -> Self {
        let base = if dark { Self::over_dark() } else { Self::over_light() };
        let landscape = Landscape::over(background, dark);
        Self {
            background: Background::Landscape(landscape),
            haze: landscape.horizon,
            ground_shadow: true,
            ..base
        }
    }

    /// To be laid over something bright.
    pub const fn over_light() -> Self {
        Self {
            background: Background::Transparent,
            ground_shadow: false,
            grain: false,
            haze_amount: 0.26,
            ..Self::studio()
        }
    }
}

/// The node that the tree stands on.
pub(crate) fn foot(skeleton: &Skeleton) -> Option<Vec3> {
    skeleton.positions.iter().copied().reduce(|a, b| if b.y < a.y { b } else { a })
}
