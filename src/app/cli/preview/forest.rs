//! A forest's picture.

use std::sync::Arc;

use anyhow::Context;
use linden::picture::Picture;
use linden_raster::{Camera, Size, Style};
use linden_terminal::probe::Overrides;

use super::Preview;
use crate::cli::forest::resolved;
use crate::cli::outputs::list;
use crate::cli::placing::PictureTarget;
use crate::exit::usage;
use crate::jobs::{FOREST_PITCH_DEG, FOREST_YAW_DEG, ShownForest};
use crate::portrait::{FOREST_SIZE, PreviewLook, draw_forest};
use crate::progress::Progress;
use crate::source::forest::{ForestFile, ForestSource, turn};

impl Preview {
    /// Draws a forest, its surfaces.
    pub(super) fn forest(
        &self,
        file: ForestFile,
        overrides: &Overrides,
        progress: &Progress,
    ) -> anyhow::Result<()> {
        self.refuse_for_a_forest()?;
        let ForestSource { mut forest, files, .. } = resolved(file, progress)?;
        for (name, value) in self.growing.pairs()?.into_iter().chain(self.budget.pair()) {
            turn(&mut forest, &name, &value)?;
        }
        let target = self
            .output
            .as_deref()
            .map(|path| PictureTarget::open_or_svg(path, &forest.id, &self.placing))
            .transpose()?;
        if target.as_ref().is_some_and(PictureTarget::is_svg) {
            return Err(usage(
                "an SVG is a flat drawing of one tree; a forest's picture is .png, .jpg or .webp",
            ));
        }
        if let Some(target) = &target {
            target.spare(&files)?;
        }
        let file_size = self.size.unwrap_or(FOREST_SIZE);
        if let Some(target) = &target {
            target.admit(Size::new(file_size.0, file_size.1).map_err(usage)?, 0, progress)?;
        }
        let id = forest.id.clone();
        let shown = ShownForest::grow(&Arc::new(forest), progress).with_context(|| id.clone())?;
        if self.alone && shown.obstructions.is_empty() {
            crate::cli::notes(
                &["--alone changes nothing: nothing stands beside these trees".into()],
                progress,
            );
        }
        let held = shown.grown.bytes();
        let camera = Camera {
            zoom: self.zoom,
            eye_m: self.eye,
            extent: if self.alone { shown.extent } else { shown.beside },
            ..Camera::orbit(self.yaw.unwrap_or(FOREST_YAW_DEG), self.pitch.unwrap_or(FOREST_PITCH_DEG))
        };
        let draw = |style: Style<'static>, (width, height): (u32, u32)| -> anyhow::Result<Picture> {
            let obstructions = if self.alone { &[] } else { &shown.obstructions[..] };
            let haze_amount = self.fog.unwrap_or(style.haze_amount);
            let style = Style { obstructions, haze_amount, ..style };
            let size = Size::new(width, height).map_err(usage)?;
            draw_forest(&shown, &camera, style, self.background, size, progress).with_context(|| id.clone())
        };
        let Some(target) = target else { return self.show(overrides, progress, draw) };
        let picture = draw(Style::studio(), file_size)?;
        target.admit(Size::new(picture.width(), picture.height())?, held, progress)?;
        list(&target.write(&picture, Some(&shown.forest.to_line()), progress)?)
    }

    /// What a forest's picture has not.
    fn refuse_for_a_forest(&self) -> anyhow::Result<()> {
        self.growing.without_defines("a forest has several trees")?;
        self.growing.without_edits("a forest has several trees")?;
        self.growing.without_age("a forest has several trees")?;
        let given = [
            (self.look.is_some_and(|look| look != PreviewLook::Surface), "--look"),
            (self.color.is_some(), "--color"),
            (self.lod.is_some(), "--lod"),
            (self.points, "--points"),
            (self.outline, "--outline"),
            (self.person, "--person"),
        ];
        match given.into_iter().find(|(is_given, _)| *is_given) {
            Some((_, flag)) => Err(usage(format!(
                "{flag} is for one tree: a forest's picture shows the surfaces of its trees"
            ))),
            None => Ok(()),
        }
    }
}
