//! What an exporter is given: plants at their places, in several levels of detail where there are such,
//! and on request what stands around them: camera, light, ground.
//!
//! A stage borrows its scenes: a forest of ten thousand places holds each distinct tree once.
//!
//! ```
//! use linden_pipeline::{Quiet, dress::dress, grow::grow, preset::builtin, recipe::Recipe, stage::Stage};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let recipe = Recipe::new(builtin("simple").unwrap().load()?);
//! let scene = dress(&recipe, &grow(&recipe, &Quiet)?, &Quiet)?;
//! let stage = Stage::of(&scene);
//! assert!(stage.is_plain());
//! assert_eq!(stage.triangles(), scene.parts[0].mesh.triangles.len() as u64);
//! # Ok(())
//! # }
//! ```

mod ground_cover;
mod setting;
mod sunshine;
mod surroundings;

use glam::{Quat, Vec3};

use crate::scene::Scene;
use linden_base::mesh::Bounds;

pub use ground_cover::{GroundCover, GroundPatch, UnknownGroundCover};
pub use setting::{Camera, Ground, Setting, Sky, Sun};
pub use sunshine::{Moment, SunError};
pub use surroundings::{Surroundings, SurroundingsError};

/// Plants at their places, and what stands around them.
#[derive(Clone, Debug)]
pub struct Stage<'a> {
    /// Its name, not empty; printable characters only. That of the tree where it is alone.
    pub name: String,
    /// Enough to make all of it again, one line of printable ASCII (JSON). The recipe of the tree where it is
    /// alone.
    pub recipe: String,
    /// The distinct plants; at least one.
    pub plants: Vec<Plant<'a>>,
    /// Where they stand; at least one.
    pub places: Vec<Place>,
    /// Ground, sky, sun and camera around them, on request.
    pub setting: Option<Setting>,
    /// The knobs that were turned for this export, by name: exporters note those whose effect their format
    /// cannot hold.
    pub turned: Vec<String>,
}

/// A plant as it looks in one or more seasons, each in one or more levels of detail.
#[derive(Clone, Debug)]
pub struct Plant<'a> {
    /// Printable, not empty.
    pub name: String,
    /// At least one; the first is what is shown where a format holds one only.
    pub seasons: Vec<Season<'a>>,
    /// Which level it is in, where that is one of several; `None`: those that there are.
    pub only: Option<OnlyLevel>,
}

/// Which of a plant's levels of detail a stage has, where it has [one](Stage::at_level).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnlyLevel {
    /// 0 is the finest.
    pub number: usize,
    /// How many the plant has.
    pub of: usize,
    /// The level serves from this share of the picture's height on: where the one before ends; 1 of the finest.
    pub from: f32,
}

/// A plant's look in one season. All seasons of a plant have as many levels.
#[derive(Clone, Debug)]
pub struct Season<'a> {
    /// Lower-case ASCII identifier, unique within the plant: `summer`.
    pub name: String,
    /// Finest first; at least one.
    pub levels: Vec<Level<'a>>,
}

/// A plant in one level of detail.
#[derive(Clone, Copy, Debug)]
pub struct Level<'a> {
    /// How it looks from as far as this level is for.
    pub scene: &'a Scene,
    /// The level serves while the plant takes at least this share of the picture's height (0 to 1, less
    /// from level to level).
    pub coverage: f32,
}

/// Where a plant stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index into [`Stage::plants`].
    pub plant: usize,
    /// Where its foot is, metres.
    pub position: Vec3,
    /// How far it is turned about the upward axis, counter-clockwise seen from above, radians.
    pub turn_rad: f32,
    /// How much larger it stands there than its scene has it; above 0.
    pub scale: f32,
}

impl Place {
    /// Where a plant stands alone: at the origin, as it is.
    pub const fn origin(plant: usize) -> Self {
        Self { plant, position: Vec3::ZERO, turn_rad: 0.0, scale: 1.0 }
    }

    /// Whether nothing is moved there.
    pub fn is_origin(&self) -> bool {
        *self == Self::origin(self.plant)
    }

    /// The turn as a unit quaternion.
    pub fn rotation(&self) -> Quat {
        let (sin, cos) = libm::sincosf(0.5 * self.turn_rad);
        Quat::from_xyzw(0.0, sin, 0.0, cos)
    }

    /// How things move there, `None` where nothing does.
    pub fn motion(&self) -> Option<Motion> {
        let (sin, cos) = libm::sincosf(self.turn_rad);
        (!self.is_origin()).then_some(Motion { position: self.position, scale: self.scale, sin, cos })
    }
}

/// A [`Place`]'s turn, scale and position, ready for many points.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    position: Vec3,
    scale: f32,
    sin: f32,
    cos: f32,
}

impl Motion {
    /// Where a point of the plant's scene is.
    #[inline]
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.position + self.direction(point) * self.scale
    }

    /// Where a direction of the plant's scene points.
    #[inline]
    pub fn direction(&self, Vec3 { x, y, z }: Vec3) -> Vec3 {
        Vec3::new(self.cos * x + self.sin * z, y, self.cos * z - self.sin * x)
    }
}

impl<'a> Plant<'a> {
    /// A plant in a single level and season.
    pub fn of(scene: &'a Scene) -> Self {
        Self::in_levels(scene.name.clone(), vec![Level { scene, coverage: 0.0 }])
    }

    /// A plant in one season, finest level first.
    pub fn in_levels(name: String, levels: Vec<Level<'a>>) -> Self {
        Self { name, seasons: vec![Season { name: "summer".to_owned(), levels }], only: None }
    }

    /// The levels of the first season, finest first.
    pub fn levels(&self) -> &[Level<'a>] {
        self.seasons.first().map_or(&[], |season| &season.levels)
    }

    /// All its scenes: season by season, level by level.
    pub fn scenes(&self) -> impl Iterator<Item = &'a Scene> {
        self.seasons.iter().flat_map(|season| season.levels.iter().map(|level| level.scene))
    }
}

impl<'a> Stage<'a> {
    /// A tree alone, as it is.
    pub fn of(scene: &'a Scene) -> Self {
        Self::of_plant(Plant::of(scene), scene)
    }

    /// A tree alone in several levels of detail, finest first.
    pub fn of_levels(scene: &'a Scene, levels: Vec<Level<'a>>) -> Self {
        Self::of_plant(Plant::in_levels(scene.name.clone(), levels), scene)
    }

    fn of_plant(plant: Plant<'a>, scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            recipe: scene.recipe.clone(),
            plants: vec![plant],
            places: vec![Place::origin(0)],
            setting: None,
            turned: Vec::new(),
        }
    }

    /// The same, with the names of the knobs that were turned for it.
    #[must_use]
    pub fn turned_by<'k>(self, knobs: impl IntoIterator<Item = &'k str>) -> Self {
        Self { turned: knobs.into_iter().map(str::to_owned).collect(), ..self }
    }

    /// The same with a camera that frames it, sun, sky and ground.
    #[must_use]
    pub fn in_setting(self) -> Self {
        let setting = Setting::around(&self.outermost());
        Self { setting, ..self }
    }

    /// The same with its setting, where it has one, in the light of a moment.
    ///
    /// # Errors
    /// [`SunError::Night`].
    pub(crate) fn at_moment(mut self, moment: &Moment) -> Result<Self, SunError> {
        if let Some(setting) = &mut self.setting {
            let usual = setting.sun;
            setting.sun = moment.sun(&usual)?;
            // The sky gets its light from the sun, and loses less of it where that is low.
            let share = setting.sun.illuminance_lux * setting.sun.toward.y.max(0.1)
                / (usual.illuminance_lux * usual.toward.y);
            setting.sky.illuminance_lux *= libm::sqrtf(share);
        }
        Ok(self)
    }

    /// Whether it is a single tree in a single look and level with nothing around it.
    pub fn is_plain(&self) -> bool {
        self.is_single()
            && self.setting.is_none()
            && self.plants.iter().all(|plant| plant.scenes().count() == 1)
    }

    /// Whether it is a single plant that stands as its scene has it.
    pub fn is_single(&self) -> bool {
        self.plants.len() == 1 && matches!(self.places.as_slice(), [place] if place.is_origin())
    }

    /// How many levels of detail there are: the most that a plant has.
    pub fn levels(&self) -> usize {
        self.plants.iter().map(|plant| plant.levels().len()).max().unwrap_or(0)
    }

    /// The same with one level of each plant: the `level`-th, or the last that it has.
    #[must_use]
    pub fn at_level(&self, level: usize) -> Self {
        let mut stage = self.clone();
        for plant in &mut stage.plants {
            let levels = plant.levels();
            if levels.len() > 1 {
                let number = level.min(levels.len() - 1);
                let from = number.checked_sub(1).map_or(1.0, |before| levels[before].coverage);
                plant.only = Some(OnlyLevel { number, of: levels.len(), from });
            }
            for season in &mut plant.seasons {
                let last = season.levels.len().saturating_sub(1);
                season.levels = season.levels.get(level.min(last)).copied().into_iter().collect();
            }
        }
        stage
    }

    /// How many seasons there are: the most that a plant has.
    pub fn seasons(&self) -> usize {
        self.plants.iter().map(|plant| plant.seasons.len()).max().unwrap_or(0)
    }

    /// The same with one season of each plant: the `season`-th, or the last that it has. A single plant's
    /// recipe is then that of its season.
    #[must_use]
    pub fn in_season(&self, season: usize) -> Self {
        let mut stage = self.clone();
        if self.is_single() && self.seasons() > 1 {
            let shown = self.plants[0].seasons.get(season).or(self.plants[0].seasons.last());
            if let Some(level) = shown.and_then(|shown| shown.levels.first()) {
                stage.recipe.clone_from(&level.scene.recipe);
            }
        }
        for plant in &mut stage.plants {
            let last = plant.seasons.len().saturating_sub(1);
            plant.seasons = plant.seasons.get(season.min(last)).cloned().into_iter().collect();
        }
        stage
    }

    /// Places and the scenes that stand there, in the first season and the finest level.
    pub fn finest(&self) -> impl Iterator<Item = (&Place, &'a Scene)> {
        self.places
            .iter()
            .filter_map(|place| Some((place, self.plants.get(place.plant)?.levels().first()?.scene)))
    }

    /// Triangles that are seen from near.
    pub fn triangles(&self) -> u64 {
        self.finest().flat_map(|(_, scene)| &scene.parts).map(|part| part.mesh.triangles.len() as u64).sum()
    }

    /// Points of what is seen from near, the outermost in many directions among them: their hull is
    /// nearly that of all. In the first season.
    pub fn outermost(&self) -> Vec<Vec3> {
        // Half of the directions of a grid on a cube; the other half is opposite.
        let steps = || (-2_i8..=2).map(f32::from);
        let directions: Vec<Vec3> = steps()
            .flat_map(|x| steps().flat_map(move |y| steps().map(move |z| Vec3::new(x, y, z))))
            .filter(|d| d.abs().max_element() == 2.0)
            .collect();
        let of_plant = |plant: &Plant<'a>| -> Vec<Vec3> {
            let scene = plant.levels().first().map(|level| level.scene);
            let mut outermost = vec![(f32::NEG_INFINITY, Vec3::ZERO); directions.len()];
            for &point in scene.into_iter().flat_map(points_of) {
                for (direction, most) in directions.iter().zip(&mut outermost) {
                    let far = direction.dot(point);
                    if far > most.0 {
                        *most = (far, point);
                    }
                }
            }
            outermost.into_iter().filter(|(far, _)| far.is_finite()).map(|(_, point)| point).collect()
        };
        let hulls: Vec<Vec<Vec3>> = self.plants.iter().map(of_plant).collect();
        let placed = |place: &Place| {
            let motion = place.motion();
            let moved = move |&p: &Vec3| motion.map_or(p, |motion| motion.point(p));
            hulls.get(place.plant).map_or(&[][..], Vec::as_slice).iter().map(moved).collect::<Vec<_>>()
        };
        self.places.iter().flat_map(placed).collect()
    }

    /// Bytes that all distinct scenes take.
    pub fn bytes(&self) -> u64 {
        self.plants.iter().flat_map(Plant::scenes).map(Scene::bytes).sum::<u64>()
            + self.setting.iter().map(Setting::bytes).sum::<u64>()
    }

    /// Smallest box around everything that is seen from near, metres; `None` where nothing stands.
    pub fn bounds(&self) -> Option<Bounds> {
        let boxes: Vec<Option<Bounds>> = self.plants.iter().map(plant_bounds).collect();
        let placed = |place: &Place| {
            let bounds = boxes.get(place.plant).copied().flatten()?;
            let Some(motion) = place.motion() else { return Some(bounds) };
            Bounds::of(bounds.corners().map(|corner| motion.point(corner)))
        };
        self.places.iter().filter_map(placed).reduce(Bounds::union)
    }
}

fn plant_bounds(plant: &Plant<'_>) -> Option<Bounds> {
    let scene = plant.levels().first()?.scene;
    if scene.parts.is_empty() {
        return Bounds::of(points_of(scene).copied());
    }
    scene.parts.iter().filter_map(|part| part.mesh.bounds()).reduce(Bounds::union)
}

/// Where there is something of a plant: its surface, or its axes where nobody wanted a surface.
fn points_of(scene: &Scene) -> impl Iterator<Item = &Vec3> {
    let axes: &[Vec3] = if scene.parts.is_empty() { &scene.skeleton.positions } else { &[] };
    scene.parts.iter().flat_map(|part| &part.mesh.positions).chain(axes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Subject;

    fn scene() -> Scene {
        let subject = Subject::builtin("simple", &[("points", "50"), ("bark_size", "64")]);
        subject.dress(&subject.grow())
    }

    #[test]
    fn a_place_turns_as_its_quaternion_does() {
        let place = Place { plant: 0, position: Vec3::new(1.0, 2.0, 3.0), turn_rad: 0.7, scale: 1.5 };
        for point in [Vec3::X, Vec3::Y, Vec3::new(-0.3, 2.0, 5.0)] {
            let expected = place.position + place.rotation() * (point * place.scale);
            assert!(place.motion().unwrap().point(point).distance(expected) < 1e-5);
        }
        // Counter-clockwise seen from above: from the front (Z) to the right (X).
        let quarter = Place { turn_rad: std::f32::consts::FRAC_PI_2, ..Place::origin(0) };
        assert!(quarter.motion().unwrap().direction(Vec3::Z).distance(Vec3::X) < 1e-6);
        assert!(Place::origin(3).motion().is_none());
    }

    #[test]
    fn bounds_hold_every_vertex_of_every_place() {
        let scene = scene();
        let mut stage = Stage::of(&scene);
        assert_eq!(stage.bounds(), scene.parts[0].mesh.bounds());
        let far = Place { plant: 0, position: Vec3::new(20.0, 0.5, -7.0), turn_rad: 2.0, scale: 0.5 };
        stage.places.push(far);
        assert!(!stage.is_plain());
        let bounds = stage.bounds().unwrap();
        for place in &stage.places {
            for part in &scene.parts {
                let moved = |p: &Vec3| place.motion().map_or(*p, |motion| motion.point(*p));
                let part_bounds = Bounds::of(part.mesh.positions.iter().map(moved)).unwrap();
                let slack = Vec3::splat(1e-4);
                assert!(
                    part_bounds.min.cmpge(bounds.min - slack).all()
                        && part_bounds.max.cmple(bounds.max + slack).all()
                );
            }
        }
        assert_eq!(stage.triangles(), 2 * scene.parts[0].mesh.triangles.len() as u64);
    }

    #[test]
    fn a_season_is_its_own_or_the_last() {
        let (green, bare) = (scene(), scene());
        let season = |name: &str, scene| Season {
            name: name.to_owned(),
            levels: vec![Level { scene, coverage: 0.0 }],
        };
        let mut stage = Stage::of(&green);
        stage.plants[0].seasons = vec![season("summer", &green), season("bare", &bare)];
        assert_eq!(stage.seasons(), 2);
        for (asked, name) in [(0, "summer"), (1, "bare"), (9, "bare")] {
            let shown = stage.in_season(asked);
            assert_eq!((shown.seasons(), shown.plants[0].seasons[0].name.as_str()), (1, name));
        }
    }

    #[test]
    fn a_level_is_its_own_or_the_last() {
        let (fine, coarse) = (scene(), scene());
        let levels = [(&fine, 0.5), (&coarse, 0.1)].map(|(scene, coverage)| Level { scene, coverage });
        let stage = Stage::of_levels(&fine, levels.to_vec());
        assert_eq!(stage.levels(), 2);
        assert!(!stage.is_plain() && stage.is_single());
        let is = |level: usize, scene: &Scene| {
            std::ptr::eq(stage.at_level(level).plants[0].levels()[0].scene, scene)
        };
        assert!(is(0, &fine) && is(1, &coarse) && is(7, &coarse) && !is(1, &fine));
        let only = |level: usize| stage.at_level(level).plants[0].only.unwrap();
        assert_eq!(only(0), OnlyLevel { number: 0, of: 2, from: 1.0 });
        assert_eq!(only(7), OnlyLevel { number: 1, of: 2, from: 0.5 });
        assert_eq!((stage.plants[0].only, Stage::of(&fine).at_level(0).plants[0].only), (None, None));
        assert!(stage.at_level(1).is_plain());
    }
}
