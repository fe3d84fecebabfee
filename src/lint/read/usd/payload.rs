//! Layers that hold no mesh, and have their model in another one: the small layer of an export with `payload`, and that
//! over the files of several ages. The payload is read in their place, with the variants that they choose.

use linden_base::monitor::Monitor;

use super::layer::Layer;
use super::{note_unseen, parse, read_layer};
use crate::asset::Asset;
use crate::read::{ADVICE, Beside, READING, ReadError, shown};

/// The most payloads within payloads: an age's file, and its own payload.
const MOST_WITHIN: usize = 4;

/// Reads a layer, or the payload that it has in place of meshes.
pub(super) fn read(
    asset: &mut Asset,
    mut layer: Layer,
    beside: &dyn Beside,
    monitor: &dyn Monitor,
) -> Result<(), ReadError> {
    let mut folder = String::new();
    for _ in 0..=MOST_WITHIN {
        read_layer(asset, &layer, &Within { folder: &folder, beside })?;
        let payloads = layer.payloads();
        let Some(file) = payloads.first().filter(|_| asset.meshes.is_empty()) else {
            note_unseen(asset, &layer);
            return Ok(());
        };
        let elsewhere = |why: &str| ReadError::Elsewhere { file: shown(file), why: why.to_owned() };
        if payloads.len() > 1 {
            return Err(elsewhere("and in others: name these files"));
        }
        if layer.has_places() {
            return Err(elsewhere("which it moves, turns or scales: name that file"));
        }
        let bytes = match (Within { folder: &folder, beside }).read(file) {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return Err(elsewhere("which is not there: put it there, or export anew")),
            Err(why) => return Err(elsewhere(&format!("which was not read: {why}"))),
        };
        monitor.admit(READING, 6 * bytes.len() as u64, ADVICE)?;
        let chosen = layer.selections();
        if let Some((way, _)) = file.rsplit_once('/') {
            folder += way;
            folder.push('/');
        }
        layer = parse(&bytes, monitor)?;
        layer.chosen = chosen;
    }
    Err(super::beyond(format!("its payloads have payloads, more than {MOST_WITHIN} in a row")))
}

/// Files as a layer in some folder names them.
struct Within<'a> {
    /// Nothing, or with a slash at its end.
    folder: &'a str,
    beside: &'a dyn Beside,
}

impl Beside for Within<'_> {
    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, String> {
        self.beside.read(&format!("{}{name}", self.folder))
    }
}
