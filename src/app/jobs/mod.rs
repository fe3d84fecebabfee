//! Work in the background: growing, drawing, reading, exporting. Keys never wait for it.
//!
//! A [`Lane`] does one thing at a time and the newest request wins: what is under way is cancelled
//! inside its loops (through [`Monitor`]), and what it still says carries the number of a request
//! that is not waited for any more.

mod derive;
mod draw;
mod export;
mod forest;
mod gallery;
mod grow;
mod lane;
mod look;
mod measure;
mod painter;
mod relay;
mod subject;

pub use derive::{Derivation, DerivedWord, WordRequest, derive, short};
pub use draw::{Detail, DrawRequest, Marks, Medium, Painted, PictureLook};
pub use export::{ExportNews, ExportOrder, ExportSubject, WHOLE, run as run_export};
pub use forest::{FOREST_PITCH_DEG, FOREST_YAW_DEG, ShownForest, grow_shown_forest};
pub use gallery::{GalleryRequest, SmallPicture, Thumbnail, TreeSize, paint_gallery};
pub use grow::{Framed, Grower, ShownTree};
#[cfg(test)]
pub use grow::{grow_shown, stage};
pub use lane::{Answer, Done, HowFar, Lane, THREAD_PREFIX, Watcher};
pub use look::{Findings, Inquiry, TargetFinding, look};
pub use measure::{Measured, MeasuredFigures, measure};
pub use painter::{Painter, wind_strength};
pub use relay::Relay;
pub use subject::Subject;
