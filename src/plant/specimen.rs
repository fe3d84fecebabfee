//! What is dressed: a grown tree, and how it is to look.

use std::sync::Arc;

use glam::DVec3;
use linden_base::input::{Geometry, Inputs, UserPicture};
use linden_base::random::Key;
use linden_skeleton::Skeleton;
use linden_skeleton::organs::Organs;

use crate::settings::Dressing;
use crate::texture::DrawnPictures;

/// What is made of a plant beside its axial tree: nothing is drawn and no mesh is made that nobody looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The meshes of wood and foliage.
    pub surface: bool,
    /// Leaves and other organs one by one, in the shapes that they are dressed in.
    pub organs: bool,
    /// The colours of the surface: pictures of bark.
    pub colors: bool,
}

impl Wanted {
    /// Everything.
    pub const ALL: Self = Self { surface: true, organs: true, colors: true };
    /// The axial tree alone.
    pub const SKELETON: Self = Self { surface: false, organs: false, colors: false };

    /// What either of two wants.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self {
            surface: self.surface || other.surface,
            organs: self.organs || other.organs,
            colors: self.colors || other.colors,
        }
    }
}

impl Default for Wanted {
    fn default() -> Self {
        Self::ALL
    }
}

/// How a tree is to look, with all that this needs.
#[derive(Clone, Copy)]
pub struct Specimen<'a> {
    /// Its name for people; printable.
    pub name: &'a str,
    /// The number that leaves and wind are drawn by.
    pub seed: u64,
    /// How it looks.
    pub dressing: &'a Dressing,
    /// The files that the dressing names.
    pub inputs: &'a Inputs,
    /// Pictures that were drawn before.
    pub drawn: &'a DrawnPictures,
    /// What is made of it.
    pub wanted: Wanted,
    /// The recipe's line as files carry it, of the tree in this dressing with these organs on it.
    pub recipe: &'a dyn Fn(&Dressing, &Organs) -> String,
}

impl<'a> Specimen<'a> {
    /// The same tree in another dressing.
    #[must_use]
    pub fn with(self, dressing: &'a Dressing) -> Self {
        Self { dressing, ..self }
    }

    /// The root of all random choices.
    pub(crate) const fn key(&self) -> Key {
        Key::new(self.seed)
    }

    /// A picture that the dressing names.
    pub(crate) fn picture(&self, file: &str) -> Option<&'a UserPicture> {
        match self.inputs.get(file).map(|input| &input.geometry) {
            Some(Geometry::Picture(picture)) => Some(picture),
            _ => None,
        }
    }
}

/// A grown tree: its wood and what grows on it.
#[derive(Clone, Copy)]
pub struct Body<'a> {
    /// The axial tree.
    pub skeleton: &'a Arc<Skeleton>,
    /// Leaves and other organs on it.
    pub organs: &'a Arc<Organs>,
    /// The organs that its generator placed: without the leaves of the dressing.
    pub given: &'a Arc<Organs>,
    /// Where its foot is in the file that it was grown from, as [`crate::scene::Scene::foot_in_file`].
    pub foot_in_file: Option<DVec3>,
}

impl Body<'_> {
    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let given = if Arc::ptr_eq(self.organs, self.given) { 0 } else { self.given.bytes() };
        self.skeleton.bytes() + self.organs.bytes() + given
    }
}
