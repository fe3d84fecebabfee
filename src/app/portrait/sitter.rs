//! A tree as a picture's file shows it: its surface where that is wanted or usual, its strokes, or flat.

use clap::ValueEnum;
use linden::Monitor;
use linden::dress::{dress, levels};
use linden::grow::Grown;
use linden::monitor::Holding;
use linden::picture::Picture;
use linden::recipe::Recipe;
use linden::scene::Scene;
use linden_raster::{Camera, Size, Slice, Style};

use super::Portrait;
use crate::exit::usage;

/// Hears what the user should know.
pub type Say<'s> = &'s mut dyn FnMut(&[String]);

/// What is drawn.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PreviewLook {
    /// The skeleton's strokes.
    Skeleton,
    /// The surface.
    Surface,
    /// A flat drawing.
    Turtle,
}

/// A tree that is drawn.
pub struct Sitter<'a> {
    recipe: &'a Recipe,
    grown: &'a Grown,
    /// Dressed, where its surface is shown.
    scene: Option<Scene>,
    /// Whether it is drawn flat.
    is_flat: bool,
    slice: Option<Slice>,
}

impl<'a> Sitter<'a> {
    /// Dresses the tree where that is wanted, or usual: where leaves have pictures, the bark is described, a level of
    /// detail is asked for, or a budget of triangles.
    ///
    /// # Errors
    /// Those of dressing; no such level.
    pub fn new(
        recipe: &'a Recipe,
        grown: &'a Grown,
        look: Option<PreviewLook>,
        level: Option<usize>,
        say: Say<'_>,
        monitor: &dyn Monitor,
    ) -> anyhow::Result<Self> {
        let budget = recipe.preset.dressing.detail.finest() > 0;
        let shows_surface = Self::shows_surface(recipe, grown, look, level);
        if budget && !shows_surface {
            say(&["triangles changes nothing in a skeleton: it is for --look surface".into()]);
        }
        let scene = shows_surface.then(|| match level {
            None if !budget => dress(recipe, grown, monitor).map_err(Into::into),
            _ => at_level(recipe, grown, level, say, monitor),
        });
        let is_flat = look == Some(PreviewLook::Turtle);
        Ok(Self { recipe, grown, scene: scene.transpose()?, is_flat, slice: None })
    }

    /// A tree in each of its levels of detail, finest first.
    ///
    /// # Errors
    /// Those of dressing.
    pub fn of_levels(
        recipe: &'a Recipe,
        grown: &'a Grown,
        say: Say<'_>,
        monitor: &dyn Monitor,
    ) -> anyhow::Result<Vec<Self>> {
        let all = levels(recipe, grown, monitor)?;
        say(&all.notes);
        Ok(all
            .levels
            .into_iter()
            .map(|level| Self { recipe, grown, scene: Some(level.scene), is_flat: false, slice: None })
            .collect())
    }

    /// The same, cut at a height above its foot, metres.
    #[must_use]
    pub fn cut(self, height_m: f32, thickness_m: f32) -> Self {
        let foot_m = self.grown.skeleton.positions.iter().map(|place| place.y).fold(f32::INFINITY, f32::min);
        Self { slice: Some(Slice { height_m: foot_m + height_m, thickness_m }), ..self }
    }

    /// Whether it is dressed.
    pub fn shows_surface(
        recipe: &Recipe,
        grown: &Grown,
        look: Option<PreviewLook>,
        level: Option<usize>,
    ) -> bool {
        let budget = recipe.preset.dressing.detail.finest() > 0;
        let has_looks = !grown.organs.shapes.is_empty() || recipe.preset.dressing.bark.is_described();
        let usual = has_looks || budget || level.is_some();
        look.map_or(usual, |look| look == PreviewLook::Surface)
    }

    /// A style with this tree's leaves.
    pub fn styled<'b>(&'b self, style: Style<'b>) -> Style<'b> {
        self.portrait().styled(style)
    }

    /// What is drawn of it.
    pub fn portrait(&self) -> Portrait<'_> {
        Portrait {
            skeleton: &self.grown.skeleton,
            organs: &self.grown.organs,
            leaf_colors: self.recipe.preset.dressing.foliage.turtle_colors(),
            scene: self.scene.as_ref(),
            is_flat: self.is_flat,
            slice: self.slice,
        }
    }

    /// Triangles of its surface, 0 where that is not shown.
    pub fn triangles(&self) -> u64 {
        let parts = self.scene.iter().flat_map(|scene| &scene.parts);
        parts.map(|part| part.mesh.triangles.len() as u64).sum()
    }

    /// Bytes that the tree takes, with its surface where that is shown.
    pub fn bytes(&self) -> u64 {
        self.recipe.inputs.bytes() + self.grown.bytes() + self.scene.as_ref().map_or(0, Scene::bytes)
    }

    /// Draws it in pixels.
    ///
    /// # Errors
    /// Those of the drawing.
    pub fn draw(
        &self,
        camera: &Camera,
        style: &Style<'_>,
        size: Size,
        monitor: &dyn Monitor,
    ) -> anyhow::Result<Picture> {
        let holding = Holding::new(monitor, self.bytes());
        Ok(self.portrait().draw(camera, style, size, &holding)?)
    }
}

/// A tree in one of its levels of detail, the finest where none is named.
fn at_level(
    recipe: &Recipe,
    grown: &Grown,
    level: Option<usize>,
    say: Say<'_>,
    monitor: &dyn Monitor,
) -> anyhow::Result<Scene> {
    let mut recipe = recipe.clone();
    let detail = &mut recipe.preset.dressing.detail;
    if level.is_none() {
        (detail.triangles, detail.lod_triangles) = (detail.finest(), vec![0.0]);
        (detail.lods, detail.billboard) = (1, 0);
    }
    let mut all = levels(&recipe, grown, monitor)?;
    say(&all.notes);
    let (level, count) = (level.unwrap_or(0), all.levels.len());
    if level >= count {
        let there = if count == 1 {
            "one level of detail, 0".to_owned()
        } else {
            format!("levels 0 to {}", count - 1)
        };
        return Err(usage(format!(
            "--lod {level}: this tree has {there}; ask for more, like --set lods={}",
            (level + 1).min(8)
        )));
    }
    Ok(all.levels.swap_remove(level).scene)
}
