//! Where the picture is taken from.
//!
//! A [`Camera`] turns around the tree and looks at its middle; it becomes a [`View`] once the tree's
//! [`Extent`] and the picture's size are known. The extent is a solid of revolution, which looks the
//! same from every yaw: a turntable neither clips the tree nor changes its scale.

use glam::{Vec2, Vec3};

use crate::{Extent, Size};

/// Half of the angle over the picture's longer side, degrees: mild, as a long lens from across the
/// road. A tree gains depth and its trunk stays upright.
const HALF_ANGLE_DEG: f32 = 13.0;
/// Sine of the least angle between a ray and a plane on which it has a place.
const LEAST_STEEP: f32 = 0.2;
/// The same of somebody's eyes who stands before it, as a lens of 28 mm.
const EYE_HALF_ANGLE_DEG: f32 = 32.0;
/// From the upper edge down to the horizon that such eyes see, and how much of that trees may take.
const EYE_HORIZON: f32 = 0.78;
const EYE_FILL: f32 = 0.92;
/// What is wider than so many heights runs out of the picture on both sides, rather than being seen from far.
const EYE_WIDEST: f32 = 1.1;
/// How far the trees of a forest reach toward whoever looks at it, of its radius: its corners are farther.
const EYE_NEAREST: f32 = 0.8;
/// The share of the picture's half side that the tree may fill.
const FILL: f32 = 0.94;

/// An orbit camera with a mild perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Turns the camera around the tree, degrees: 0 looks from +Z, 90 from +X.
    pub yaw_deg: f32,
    /// Lifts the camera, degrees: 0 looks from the side, 90 from above. Clamped to -90..90.
    pub pitch_deg: f32,
    /// 1 frames the whole tree, 2 shows it twice as large. A longer lens, not a nearer place, so
    /// nothing ever comes behind the camera. Clamped to 0.01..1000.
    pub zoom: f32,
    /// Shifts the picture, in halves of its shorter side: right and up.
    pub pan: Vec2,
    /// Stands on the ground with eyes at this height, metres, and looks level, whatever the pitch; `None`: looks at
    /// the tree's middle.
    pub eye_m: Option<f32>,
    /// The extent to frame; `None` for the tree's. One extent for several pictures keeps the scale.
    pub extent: Option<Extent>,
}

impl Default for Camera {
    /// A little from above, turned so that depth shows.
    fn default() -> Self {
        Self::orbit(30.0, 8.0)
    }
}

impl Camera {
    /// From a direction, the whole tree in the frame.
    pub const fn orbit(yaw_deg: f32, pitch_deg: f32) -> Self {
        Self { yaw_deg, pitch_deg, zoom: 1.0, pan: Vec2::ZERO, eye_m: None, extent: None }
    }

    /// From +Z.
    pub const fn front() -> Self {
        Self::orbit(0.0, 0.0)
    }

    /// From +X.
    pub const fn side() -> Self {
        Self::orbit(90.0, 0.0)
    }

    /// From above, +Z at the lower edge.
    pub const fn top() -> Self {
        Self::orbit(0.0, 90.0)
    }

    /// Level, to the right in the picture; length 1.
    pub fn right(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = sincos_deg(finite_or(self.yaw_deg, 0.0));
        Vec3::new(cos_yaw, 0.0, -sin_yaw)
    }

    /// Upwards in the picture; length 1.
    pub fn up(&self) -> Vec3 {
        let (sin_pitch, cos_pitch) = sincos_deg(finite_or(self.pitch_deg, 0.0).clamp(-90.0, 90.0));
        // Across `right`, from upright to the way that the lens looks along the ground.
        Vec3::Y * cos_pitch + Vec3::Y.cross(self.right()) * sin_pitch
    }

    /// Sets up the projection for a tree and a size.
    pub fn view(&self, tree: Extent, size: Size) -> View {
        let extent = self.extent.unwrap_or(tree);
        if let Some(eye_m) = self.eye_m {
            return self.standing(eye_m, extent, size);
        }
        let (sin_yaw, cos_yaw) = sincos_deg(finite_or(self.yaw_deg, 0.0));
        let (sin_pitch, cos_pitch) = sincos_deg(finite_or(self.pitch_deg, 0.0).clamp(-90.0, 90.0));
        let right = self.right();
        let toward = Vec3::new(cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw);
        let up = toward.cross(right);

        let half = Vec2::new(size.width() as f32, size.height() as f32) / 2.0;
        let focal_px = half.max_element() / tan_deg(HALF_ANGLE_DEG);
        // How far a point may lie off the picture's axis for each metre in front of the lens.
        let slope = half * FILL / focal_px;
        let (distance, rise) = extent.fit(slope, sin_pitch, cos_pitch);
        let zoom = finite_or(self.zoom, 1.0).clamp(0.01, 1000.0);
        let pan = if self.pan.is_finite() { self.pan } else { Vec2::ZERO } * half.min_element();
        View {
            right,
            up,
            toward,
            target: extent.middle() + up * rise,
            distance,
            focal_px: focal_px * zoom,
            middle_px: half + Vec2::new(pan.x, -pan.y),
        }
    }
}

impl Camera {
    /// Eyes that look level keep trunks upright: the horizon is moved down in the picture instead. So near that the
    /// nearest trees are as high as the sky has room for.
    fn standing(&self, eye_m: f32, extent: Extent, size: Size) -> View {
        let (sin_yaw, cos_yaw) = sincos_deg(finite_or(self.yaw_deg, 0.0));
        let whole = Vec2::new(size.width() as f32, size.height() as f32);
        let focal_px = whole.max_element() / 2.0 / tan_deg(EYE_HALF_ANGLE_DEG);
        let height_m = extent.height().max(1e-6);
        // Nobody looks over what is smaller than they are.
        let eye_m = finite_or(eye_m, 1.65).clamp(0.05 * height_m, 0.55 * height_m);
        let (radius_m, widest_m) = (extent.radius(), EYE_WIDEST * height_m);
        let nearest = if radius_m > widest_m { EYE_NEAREST } else { 1.0 };
        // Each ring's nearest place has room below the upper edge, and the widest ring at the sides.
        let per_metre = focal_px / (EYE_HORIZON * EYE_FILL * whole.y);
        let below = extent.radii.iter().enumerate().map(|(ring, radius)| {
            let top_m = height_m * (ring + 1) as f32 / extent.radii.len() as f32;
            nearest * radius + (top_m - eye_m).max(0.0) * per_metre
        });
        let slope = FILL * whole.x / 2.0 / focal_px;
        let beside = radius_m.min(widest_m) * libm::sqrtf(1.0 + 1.0 / (slope * slope));
        let distance = below.fold(beside, f32::max);
        let zoom = finite_or(self.zoom, 1.0).clamp(0.01, 1000.0);
        let pan = if self.pan.is_finite() { self.pan } else { Vec2::ZERO } * whole.min_element() / 2.0;
        View {
            right: Vec3::new(cos_yaw, 0.0, -sin_yaw),
            up: Vec3::Y,
            toward: Vec3::new(sin_yaw, 0.0, cos_yaw),
            target: Vec3::new(extent.x, extent.bottom + eye_m, extent.z),
            distance,
            focal_px: focal_px * zoom,
            middle_px: Vec2::new(whole.x / 2.0 + pan.x, EYE_HORIZON * whole.y - pan.y),
        }
    }
}

/// A camera set up for one tree and one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    right: Vec3,
    up: Vec3,
    toward: Vec3,
    target: Vec3,
    distance: f32,
    focal_px: f32,
    middle_px: Vec2,
}

/// A point in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    /// Pixels from the upper left corner, right and down.
    pub at: Vec2,
    /// Metres from the lens along its axis; larger is farther.
    pub depth_m: f32,
    /// Pixels per metre there.
    pub scale: f32,
}

impl View {
    /// Where a point appears.
    pub fn project(&self, point: Vec3) -> Projected {
        let p = self.turn(point - self.target);
        // The fit keeps what is framed in front of the lens; what is not framed may lie behind.
        let depth_m = (self.distance - p.z).max(self.distance * 1e-3);
        let scale = self.focal_px / depth_m;
        Projected { at: self.middle_px + Vec2::new(p.x, -p.y) * scale, depth_m, scale }
    }

    /// A direction in the camera's axes: right, up, toward the lens.
    pub fn turn(&self, direction: Vec3) -> Vec3 {
        Vec3::new(direction.dot(self.right), direction.dot(self.up), direction.dot(self.toward))
    }

    /// A direction from the camera's axes back into the world.
    pub(crate) fn turned_back(&self, direction: Vec3) -> Vec3 {
        self.right * direction.x + self.up * direction.y + self.toward * direction.z
    }

    /// Where the camera stands.
    pub(crate) fn eye(&self) -> Vec3 {
        self.target + self.toward * self.distance
    }

    /// The direction in the world that a place of the picture shows, one metre of it along the lens' axis.
    pub(crate) fn ray(&self, at: Vec2) -> Vec3 {
        let off = (at - self.middle_px) / self.focal_px;
        self.turned_back(Vec3::new(off.x, -off.y, -1.0))
    }

    /// The place that a pixel shows at a depth, metres from the lens along its axis.
    pub fn place(&self, at: Vec2, depth_m: f32) -> Vec3 {
        self.eye() + self.ray(at) * depth_m
    }

    /// The place that a pixel shows of a plane; `None` where it is seen all but from its edge, or lies behind.
    pub fn on_plane(&self, at: Vec2, through: Vec3, normal: Vec3) -> Option<Vec3> {
        let ray = self.ray(at);
        let steep = ray.dot(normal) / (ray.length() * normal.length());
        let depth_m = (through - self.eye()).dot(normal) / ray.dot(normal);
        (steep.abs() > LEAST_STEEP && depth_m > 0.0).then(|| self.place(at, depth_m))
    }

    /// Pixels per metre at what the camera looks at, the tree's axis: what a scale bar shows.
    pub fn scale_at_target(&self) -> f32 {
        self.focal_px / self.distance
    }

    /// Pixels per metre one metre from the lens.
    pub(crate) fn scale_at_nearness(&self) -> f32 {
        self.focal_px
    }

    /// Level, to the right in the picture; length 1.
    pub const fn right(&self) -> Vec3 {
        self.right
    }

    /// Whether the camera stands above the horizontal plane at a height.
    pub fn is_above(&self, height_m: f32) -> bool {
        self.eye().y > height_m
    }
}

fn finite_or(x: f32, fallback: f32) -> f32 {
    if x.is_finite() { x } else { fallback }
}

fn sincos_deg(degrees: f32) -> (f32, f32) {
    libm::sincosf((degrees % 360.0).to_radians())
}

fn tan_deg(degrees: f32) -> f32 {
    libm::tanf(degrees.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::RINGS;

    fn can() -> Extent {
        Extent { x: 3.0, z: -2.0, bottom: -0.5, top: 11.0, radii: [4.0; RINGS], person: None }
    }

    /// Points all over the cylinder's rims.
    fn rims(e: Extent) -> impl Iterator<Item = Vec3> {
        (0..720).flat_map(move |i| {
            let (s, c) = libm::sincosf((i as f32 / 2.0).to_radians());
            [e.bottom, e.top].map(|y| Vec3::new(e.x + e.radius() * c, y, e.z + e.radius() * s))
        })
    }

    #[test]
    fn eyes_see_the_horizon_level_and_the_nearest_trees_whole() {
        for (w, h) in [(1400, 900), (800, 1000)] {
            let size = Size::new(w, h).unwrap();
            let wide = Extent { radii: [60.0; RINGS], ..can() };
            for extent in [can(), wide] {
                let camera = Camera { eye_m: Some(1.65), ..Camera::orbit(17.0, 40.0) };
                let view = camera.view(extent, size);
                assert!((view.eye().y - (extent.bottom + 1.65)).abs() < 1e-4);
                // What is far at the eyes' height is on the horizon, whichever way.
                for far in [Vec3::new(-300.0, 0.0, -900.0), Vec3::new(500.0, 0.0, -700.0)] {
                    let seen = view.project(view.eye() + view.turned_back(far));
                    assert!((seen.at.y - EYE_HORIZON * h as f32).abs() < 0.1, "{}", seen.at);
                }
                // The whole height is inside at the nearest place, and takes most of the picture.
                let reach = extent.radius() * if extent == wide { EYE_NEAREST } else { 1.0 };
                let near = view.toward * reach + Vec3::new(extent.x, 0.0, extent.z);
                let [foot, top] = [extent.bottom, extent.top].map(|y| view.project(near.with_y(y)).at.y);
                assert!(0.0 < top && foot < h as f32 && top < foot, "{w}x{h}: {top} to {foot}");
                let across = rims(extent).map(|p| view.project(p).at.x);
                let inside = across.filter(|x| (0.0..=w as f32).contains(x)).count();
                assert!(extent == wide || inside == rims(extent).count(), "{inside}");
            }
        }
    }

    #[test]
    fn the_cylinder_stays_in_the_frame_and_touches_it() {
        for (w, h) in [(800, 1000), (1000, 300), (64, 72), (300, 2000)] {
            let size = Size::new(w, h).unwrap();
            for pitch in [-90.0, -35.0, 0.0, 8.0, 40.0, 75.0, 90.0] {
                let view = Camera::orbit(17.0, pitch).view(can(), size);
                let (mut x, mut y) = (0.0_f32, 0.0_f32);
                for p in rims(can()) {
                    let at = view.project(p).at / Vec2::new(w as f32, h as f32) * 2.0 - Vec2::ONE;
                    (x, y) = (x.max(at.x.abs()), y.max(at.y.abs()));
                }
                assert!(x <= FILL + 1e-3 && y <= FILL + 1e-3, "{w}x{h} pitch {pitch}: {x} {y}");
                assert!(x.max(y) > FILL - 2e-3, "{w}x{h} pitch {pitch} leaves room: {x} {y}");
            }
        }
    }

    #[test]
    fn a_turntable_keeps_the_scale() {
        let size = Size::new(640, 480).unwrap();
        let at = |yaw| Camera::orbit(yaw, 12.0).view(can(), size).project(Vec3::new(3.0, 11.0, -2.0));
        let first = at(0.0);
        for yaw in [1.0, 45.0, 133.0, 359.0, -720.0] {
            let other = at(yaw);
            assert!((other.at - first.at).length() < 0.01, "{yaw}: {other:?} {first:?}");
            assert!((other.scale / first.scale - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn directions_are_what_their_names_say() {
        let size = Size::new(100, 100).unwrap();
        let e = Extent { x: 0.0, z: 0.0, bottom: -1.0, top: 1.0, radii: [1.0; RINGS], person: None };
        let x = |c: Camera, p| c.view(e, size).project(p).at.x;
        let y = |c: Camera, p| c.view(e, size).project(p).at.y;
        assert!(x(Camera::front(), Vec3::X) > 60.0 && y(Camera::front(), Vec3::Y) < 40.0);
        assert!(x(Camera::side(), Vec3::NEG_Z) > 60.0);
        assert!(y(Camera::top(), Vec3::Z) > 60.0 && x(Camera::top(), Vec3::X) > 60.0);
        let near = Camera::front().view(e, size).project(Vec3::Z);
        let far = Camera::front().view(e, size).project(Vec3::NEG_Z);
        assert!(near.depth_m < far.depth_m && near.scale > far.scale);
    }

    #[test]
    fn the_scale_is_what_a_metre_measures_there() {
        let view = Camera::orbit(40.0, 20.0).view(can(), Size::new(300, 500).unwrap());
        let axis = Vec3::new(3.0, 5.25, -2.0);
        let metre = view.project(axis + view.right() / 2.0).at - view.project(axis - view.right() / 2.0).at;
        // The aim may lie above or below the axis' middle, in the plane of the picture: same depth.
        assert!((metre.length() / view.scale_at_target() - 1.0).abs() < 1e-4, "{metre}");
    }

    #[test]
    fn a_pixel_shows_the_place_that_appears_there() {
        let view =
            Camera { zoom: 1.7, ..Camera::orbit(40.0, 20.0) }.view(can(), Size::new(300, 500).unwrap());
        let place = Vec3::new(2.0, 6.5, -3.0);
        let seen = view.project(place);
        assert!(view.place(seen.at, seen.depth_m).distance(place) < 1e-4);
        let axis = Vec3::new(3.0, 0.0, -2.0);
        for normal in [Vec3::new(0.64, 0.0, 0.77), Vec3::Y] {
            let on = view.on_plane(seen.at, axis, normal).unwrap();
            assert!((on - axis).dot(normal).abs() < 1e-4 && view.project(on).at.distance(seen.at) < 0.02);
        }
        assert_eq!(view.on_plane(seen.at, axis, view.right()), None, "seen from its edge");
    }

    #[test]
    fn nonsense_is_harmless() {
        let camera = Camera {
            yaw_deg: f32::NAN,
            pitch_deg: 1e30,
            zoom: f32::INFINITY,
            pan: Vec2::NAN,
            ..Camera::default()
        };
        let p = camera.view(can(), Size::new(9, 9).unwrap()).project(Vec3::ZERO);
        assert!(p.at.is_finite() && p.scale.is_finite());
    }
}
