//! Draws the pictures that are wanted, and keeps what the next one may need.

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use linden::Skeleton;
use linden::dress::{DetailError, DressError, dress, levels};
use linden::foliage::Organs;
use linden::grow::Colonized;
use linden::monitor::Holding;
use linden::picture::Picture;
use linden::preset::Preset;
use linden::recipe::Recipe;
use linden::scene::{Mesh, Part, Scene};
use linden::wind::{Blow, Wind, blown};
use linden_raster::{Drawing, Paint, RasterError, Size, Slice, Style, Surface, draw_stage, draw_surface};
use linden_terminal::graphics::Protocol;

use super::draw::{
    DRAFT_BYTES, DRAFT_CELLS_BYTES, Detail, DrawRequest, FULL_BYTES, FULL_CELLS_BYTES, Medium, Painted,
    PictureLook, exact_pixels, pixels,
};
use super::grow::Plant;
use super::{DerivedWord, ShownForest, ShownTree, Subject, Watcher};

/// Sixels of one picture: a screen of 5K. A terminal that claims more shows characters.
const MOST_SIXELS: u64 = 16 << 20;
/// Sides of the thickest tube, and pixels of the bark's side, on a screen.
const MOST_SIDES: u32 = 12;
pub(super) const MOST_BARK_PX: u32 = 256;
/// Of the side of a picture of leaves, which holds several.
pub(super) const MOST_LEAF_PX: u32 = 256;

/// Draws pictures, one after the other, and keeps what the next one may need.
#[derive(Default)]
pub struct Painter {
    scene: Option<(Arc<ShownTree>, Option<usize>, Scene)>,
    stage: Option<(Arc<ShownTree>, u32, Option<Plant>)>,
}

impl Painter {
    /// Draws a picture; `None` when it was cancelled.
    pub fn paint(&mut self, request: DrawRequest, watcher: &Watcher<'_>) -> Option<Result<Painted, String>> {
        match self.paint_or_stop(request, watcher) {
            Ok(painted) => Some(Ok(painted)),
            Err(None) => None,
            Err(Some(why)) => Some(Err(why)),
        }
    }

    /// `Err(None)` when it was cancelled.
    fn paint_or_stop(
        &mut self,
        request: DrawRequest,
        watcher: &Watcher<'_>,
    ) -> Result<Painted, Option<String>> {
        let start = Instant::now();
        let medium = request.medium;
        let area = request.area;
        // Sixels cannot be stretched, so that a coarse draft would not fill its area.
        let sixels = medium.graphics == Some(Protocol::Sixel);
        let (wide, high) = exact_pixels(area, medium.cell_px);
        let can_be_exact = request.detail == Detail::Full
            && wide.max(high) <= linden_raster::MAX_SIDE
            && u64::from(wide) * u64::from(high) <= MOST_SIXELS;
        let protocol = medium.graphics.filter(|_| !sixels || can_be_exact);
        let (width, height) = match protocol {
            None => medium.pixels_of_cells(area.width, area.height),
            Some(Protocol::Sixel) => (wide, high),
            Some(_) => pixels(area, medium.cell_px, request.detail),
        };
        let size = Size::new(width, height).map_err(|error| Some(error.to_string()))?;
        let picture = self.draw(&request, size, watcher)?;
        let budget = match (request.detail, medium.remote) {
            (Detail::Draft, true) => DRAFT_BYTES,
            (Detail::Full, true) => FULL_BYTES,
            (_, false) => usize::MAX,
        };
        let graphic = Medium { graphics: protocol, ..medium }.graphic(&picture, area, budget)?;
        // Cells of full pictures stay within their budget at home too: the difference is not seen.
        // Those that only stand until the pixels come, or below a dialog, are a draft.
        let for_cells = match (request.detail, medium.remote) {
            (_, false) => FULL_BYTES,
            (Detail::Full, true) if graphic.is_none() => FULL_CELLS_BYTES,
            (_, true) => DRAFT_CELLS_BYTES,
        };
        let cells = medium.cells(&picture, size, (area.width, area.height), for_cells)?;
        let cut = request.slice.zip(request.subject.tree());
        let view = match cut {
            Some((slice, shown)) => slice.view(&shown.grown.skeleton, &request.camera, size),
            None => request.subject.extent().map(|extent| request.camera.view(extent, size)),
        };
        let scale = view.map_or(0.0, |view| view.scale_at_target());
        let columns_per_m = scale * f32::from(area.width) / width as f32;
        let shows_person = request.camera.extent.is_some_and(|extent| extent.person.is_some());
        let legend = legend(&request);
        let level = request.level.zip(self.triangles(&request));
        let cut = cut.map(|(slice, shown)| told(slice, shown));
        Ok(Painted {
            level,
            cut,
            legend,
            cells,
            graphic,
            columns_per_m,
            shows_person,
            took: start.elapsed(),
            request,
        })
    }

    /// The pixels; `Err(None)` when it was cancelled.
    fn draw(
        &mut self,
        request: &DrawRequest,
        size: Size,
        watcher: &Watcher<'_>,
    ) -> Result<Picture, Option<String>> {
        let base = request.medium.style();
        let shown = match &request.subject {
            Subject::Tree(shown) => shown,
            Subject::Forest(forest) => return stand(forest, request, base, size, watcher),
            Subject::Word(word) => return written(word, request, base, size, watcher),
        };
        let points = points(request, shown);
        let (marked, bare) = request.marked();
        let look = if bare { PictureLook::Skeleton(Paint::Wood) } else { request.look };
        let style = Style {
            marked,
            handles: request.handles(),
            paint: if let PictureLook::Skeleton(paint) = look { paint } else { base.paint },
            points: &points.places,
            point_gaps_m: &points.gaps_m,
            outline: if request.outline { &shown.outline[..] } else { &[] },
            obstructions: if request.obstructions { &shown.obstructions[..] } else { &[] },
            person: request.person,
            leaf_colors: shown.recipe.preset.dressing.foliage.turtle_colors(),
            draft: request.detail == Detail::Draft,
            ..base
        };
        let draw = |skeleton: &Skeleton, style: &Style<'_>| match request.slice {
            Some(slice) => Drawing::of_slice(skeleton, slice, &request.camera, style, size, watcher)
                .and_then(|drawing| drawing.picture(watcher)),
            None => look.draw(skeleton, &request.camera, style, size, watcher),
        };
        let drawn = match (look, request.stage) {
            // Until the surface is there, its skeleton is: a draft does not wait.
            (PictureLook::Surface, None)
                if request.slice.is_none()
                    && (request.detail == Detail::Full || self.has_scene(shown, request.level)) =>
            {
                let Some(frame) = request.wind else {
                    let scene = self.scene(shown, request.level, false, watcher)?;
                    return surface(&Surface::from(scene), request, &style, size, watcher);
                };
                let (skeleton, _) = blown_at(shown, frame, watcher)?;
                let scene = self.scene(shown, None, true, watcher)?;
                let parts = moved(&scene.parts, frame);
                let materials = &scene.materials;
                let blown = Surface { parts: &parts, materials, skeleton: &skeleton };
                return surface(&blown, request, &style, size, watcher);
            }
            (_, None) => {
                let blown = request.wind.map(|frame| blown_at(shown, frame, watcher)).transpose()?;
                let calm = (&*shown.grown.skeleton, &*shown.grown.organs);
                let (skeleton, organs) = blown.as_ref().map_or(calm, |(wood, leaves)| (wood, leaves));
                draw(skeleton, &Style { organs: (!bare).then_some(organs), ..style })
            }
            (_, Some(step)) => {
                let Some(Plant { skeleton, organs, .. }) = self.stage(shown, step, watcher)? else {
                    return Ok(blank(size));
                };
                draw(&skeleton, &Style { organs: Some(&organs), ..style })
            }
        };
        drawn.map_err(unless_cancelled)
    }

    fn has_scene(&self, shown: &Arc<ShownTree>, level: Option<usize>) -> bool {
        self.scene.as_ref().is_some_and(|(of, at, _)| Arc::ptr_eq(of, shown) && *at == level)
    }

    /// The triangles of the surface that a request shows, once that is there.
    fn triangles(&self, request: &DrawRequest) -> Option<u64> {
        let shown = request.subject.tree()?;
        let (.., scene) = self.scene.as_ref().filter(|_| self.has_scene(shown, request.level))?;
        Some(scene.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum())
    }

    /// The surface of a tree, no finer than a screen shows: exports have all of it; or one of its levels of
    /// detail. `sways`: with what moves it.
    fn scene(
        &mut self,
        shown: &Arc<ShownTree>,
        level: Option<usize>,
        sways: bool,
        watcher: &Watcher<'_>,
    ) -> Result<&Scene, Option<String>> {
        let can_sway = |scene: &Scene| scene.parts.iter().all(|part| part.wind.is_some());
        let is_there = self.has_scene(shown, level)
            && (!sways || self.scene.as_ref().is_some_and(|(.., scene)| can_sway(scene)));
        if !is_there {
            self.scene = None;
            let scene = match level {
                Some(level) => at_level(shown, level, watcher)?,
                None => {
                    dress(&for_screen(shown, sways), &shown.grown, watcher).map_err(|error| match error {
                        DressError::Cancelled(_) => None,
                        other => Some(other.to_string()),
                    })?
                }
            };
            self.scene = Some((Arc::clone(shown), level, scene));
        }
        // It has just been put there.
        self.scene.as_ref().map(|(.., scene)| scene).ok_or(None)
    }

    /// A tree as it was at a step; `None` while there is nothing of it.
    fn stage(
        &mut self,
        shown: &Arc<ShownTree>,
        step: u32,
        watcher: &Watcher<'_>,
    ) -> Result<Option<Plant>, Option<String>> {
        if let Some((of, at, plant)) = &self.stage
            && Arc::ptr_eq(of, shown)
            && *at == step
        {
            return Ok(plant.clone());
        }
        let plant = super::grow::stage(shown, step, watcher)?;
        self.stage = Some((Arc::clone(shown), step, plant.clone()));
        Ok(plant)
    }
}

/// Where a tree is cut, and how thick the thickest wood there is.
fn told(slice: Slice, shown: &ShownTree) -> String {
    let skeleton = &shown.grown.skeleton;
    let height_m = shown.above_foot(slice);
    let cuts = slice.cuts(skeleton);
    let Some(thickest) = cuts.iter().max_by(|a, b| a.radius_m.total_cmp(&b.radius_m)) else {
        return format!("cut at {height_m:.2} m: no wood");
    };
    let fit = skeleton.fits.get(thickest.node as usize);
    let source = fit.map_or_else(String::new, |fit| format!(" {}", fit.source.word()));
    let more = if cuts.len() > 1 { format!(" · {} cuts", cuts.len()) } else { String::new() };
    format!("cut at {height_m:.2} m · Ø {:.1} cm{source}{more}", 200.0 * thickest.radius_m)
}

/// Points that are shown of a tree.
struct ShownPoints<'a> {
    places: Cow<'a, [Vec3]>,
    /// How far each is from the bark, metres; nothing where that is not known.
    gaps_m: Cow<'a, [f32]>,
}

/// Every one of so many.
fn thinned<T: Copy>(all: &[T], stride: usize) -> Cow<'_, [T]> {
    if stride == 1 { Cow::Borrowed(all) } else { all.iter().step_by(stride).copied().collect() }
}

/// The points that a request shows: of a scan not more than can be told apart, unless it is cut.
fn points<'a>(request: &DrawRequest, shown: &'a ShownTree) -> ShownPoints<'a> {
    let colonized = shown.grown.colonized.as_ref();
    let is_cut_scan = request.slice.is_some() && colonized.is_some_and(|colonized| colonized.scan.is_some());
    let all = colonized.filter(|_| request.points || is_cut_scan).map_or(&[][..], Colonized::seen);
    let most = match request.detail {
        _ if request.slice.is_some() => usize::MAX,
        Detail::Draft => DRAFT_POINTS,
        Detail::Full => FULL_POINTS,
    };
    let stride = all.len().div_ceil(most).max(1);
    let scan = colonized.and_then(|colonized| colonized.scan.as_ref()).filter(|_| !all.is_empty());
    let gaps_m = scan.map_or(&[][..], |scan| &scan.gaps_m);
    ShownPoints { places: thinned(all, stride), gaps_m: thinned(gaps_m, stride) }
}

/// Points of a scan that a draft and a full picture show: more would hide each other.
const DRAFT_POINTS: usize = 20_000;
const FULL_POINTS: usize = 250_000;

/// What the darkest and the brightest colour of a look mean.
fn legend(request: &DrawRequest) -> Option<[String; 2]> {
    let PictureLook::Skeleton(paint) = request.look else { return None };
    let shown = request.subject.tree()?;
    let skeleton = &shown.grown.skeleton;
    let thickness = |radius_m: f32| match radius_m * 2.0 {
        m if m >= 1.0 => format!("{m:.1} m"),
        m if m >= 0.01 => format!("{:.0} cm", m * 100.0),
        m => format!("{:.1} mm", m * 1000.0),
    };
    match paint {
        Paint::Wood => None,
        Paint::Order => Some(["order 0".to_owned(), shown.measures.max_order.to_string()]),
        Paint::Radius => {
            let thick = skeleton.radii.iter().copied().filter(|&radius| radius > 0.0);
            let (least, most) = thick.fold((f32::INFINITY, 0.0_f32), |(a, b), r| (a.min(r), b.max(r)));
            least.is_finite().then(|| [format!("{} thick", thickness(least)), thickness(most)])
        }
        // In what growth is played in.
        Paint::Birth => Some(match shown.recipe.preset.generator.steps() {
            Some(steps) => [format!("{} 0", steps.unit), steps.count.to_string()],
            None => ["step 0".to_owned(), shown.steps.to_string()],
        }),
        Paint::Light => Some(["shade".to_owned(), "open sky".to_owned()]),
        _ if paint.hindrance(skeleton).is_some() => None,
        Paint::Source => Some(["guessed".to_owned(), "measured".to_owned()]),
        Paint::Distance => Some(["at the points".to_owned(), "10 cm off".to_owned()]),
    }
}

/// A recipe of as much as a screen shows. `sways`: with what moves it.
fn for_screen(shown: &ShownTree, sways: bool) -> Recipe {
    let mut recipe = (*shown.recipe).clone();
    let strength = wind_strength(&recipe.preset);
    let dressing = &mut recipe.preset.dressing;
    dressing.wind.wind = if sways { Wind::Sway } else { Wind::Off };
    dressing.wind.blow.strength = strength;
    dressing.tubes.sides = dressing.tubes.sides.min(MOST_SIDES);
    dressing.bark.size_px = dressing.bark.size_px.min(MOST_BARK_PX);
    dressing.foliage.size_px = dressing.foliage.size_px.min(MOST_LEAF_PX);
    recipe
}

/// A level of detail, or the coarsest that there is, triangle by triangle as it is exported.
fn at_level(shown: &ShownTree, level: usize, watcher: &Watcher<'_>) -> Result<Scene, Option<String>> {
    let mut recipe = (*shown.recipe).clone();
    recipe.preset.dressing.wind.wind = Wind::Off;
    recipe.preset.dressing.bark.size_px = recipe.preset.dressing.bark.size_px.min(MOST_BARK_PX);
    let mut all = levels(&recipe, &shown.grown, watcher).map_err(|error| match error {
        DetailError::Cancelled(_) => None,
        other => Some(other.to_string()),
    })?;
    let last = all.levels.len() - 1;
    Ok(all.levels.swap_remove(level.min(last)).scene)
}

/// Draws a surface.
fn surface(
    surface: &Surface<'_>,
    request: &DrawRequest,
    style: &Style<'_>,
    size: Size,
    watcher: &Watcher<'_>,
) -> Result<Picture, Option<String>> {
    draw_surface(surface, &request.camera, style, size, watcher).map_err(unless_cancelled)
}

/// Draws a forest.
fn stand(
    forest: &ShownForest,
    request: &DrawRequest,
    base: Style<'_>,
    size: Size,
    watcher: &Watcher<'_>,
) -> Result<Picture, Option<String>> {
    let obstructions = if request.obstructions { &forest.obstructions[..] } else { &[] };
    let style = Style { obstructions, draft: request.detail == Detail::Draft, ..base };
    let holding = Holding::new(watcher, forest.grown.bytes());
    draw_stage(&forest.grown.stage(), &request.camera, &style, size, &holding).map_err(unless_cancelled)
}

/// Draws what the turtle draws for a word.
fn written(
    word: &DerivedWord,
    request: &DrawRequest,
    base: Style<'_>,
    size: Size,
    watcher: &Watcher<'_>,
) -> Result<Picture, Option<String>> {
    let Some(Plant { skeleton, organs, .. }) = &word.plant else { return Ok(blank(size)) };
    let (marked, bare) = request.marked();
    let style = Style {
        marked,
        organs: (!bare).then_some(organs),
        leaf_colors: word.request.recipe.preset.dressing.foliage.turtle_colors(),
        draft: request.detail == Detail::Draft,
        ..base
    };
    request.look.draw(skeleton, &request.camera, &style, size, watcher).map_err(unless_cancelled)
}

/// A picture of nothing.
fn blank(size: Size) -> Picture {
    let bytes = size.width() as usize * size.height() as usize * 4;
    Picture::new(size.width(), size.height(), vec![0; bytes])
}

fn unless_cancelled(error: RasterError) -> Option<String> {
    if matches!(error, RasterError::Cancelled(_)) { None } else { Some(error.to_string()) }
}

/// The wind that is played: where a preset has none, a breeze.
pub fn wind_strength(preset: &Preset) -> f64 {
    let strength = preset.dressing.wind.blow.strength;
    if strength > 0.0 { strength } else { Blow::default().strength }
}

/// A tree's wood and leaves at a frame of the wind's loop.
fn blown_at(
    shown: &ShownTree,
    frame: u32,
    watcher: &Watcher<'_>,
) -> Result<(Skeleton, Organs), Option<String>> {
    let preset = &shown.recipe.preset;
    let blow = Blow { strength: wind_strength(preset), ..preset.dressing.wind.blow };
    blown(&blow, preset.seed(), &shown.grown.skeleton, &shown.grown.organs, frame, watcher).map_err(|_| None)
}

/// The parts at a frame of their loop.
fn moved(parts: &[Part], frame: u32) -> Vec<Part> {
    let moved = |part: &Part| {
        let wind = part.wind.as_ref();
        let positions = wind.and_then(|wind| wind.moved(&part.mesh.positions, frame));
        let Mesh { normals, uvs, triangles, .. } = part.mesh.clone();
        let positions = positions.unwrap_or_else(|| part.mesh.positions.clone());
        Part::new(part.name.clone(), part.material, Mesh { positions, normals, uvs, triangles })
    };
    parts.iter().map(moved).collect()
}
