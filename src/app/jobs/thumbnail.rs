//! A picture of a gallery.

/// A picture of a gallery, ready for the screen.
#[derive(Debug)]
pub struct Thumbnail {}
