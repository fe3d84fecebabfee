//! What a file shows of how it was written: the options that are seen in it, where [`Exporter::write`] would
//! otherwise have to be told them to write the same bytes again.

use std::io::{self, SeekFrom};

use linden_pipeline::stage::Surroundings;

use crate::{Exporter, Format, Options, Readable, recipe};

/// What is seen in a file.
#[derive(Clone, Debug)]
pub struct Traces {
    /// The options that it may have been written with, the most likely first: one set where all of them show.
    pub options: Vec<Options>,
    /// What its camera, sun, sky and ground were asked for with, where they are in it.
    pub setting: Option<Surroundings>,
    /// Whether several seasons or ages are in it.
    pub seasons: bool,
    /// Switches that show where they are on and change something, and do not show in it.
    pub idle: Vec<&'static str>,
}

impl Traces {
    /// Of a file of which nothing shows: the defaults.
    pub fn none(format: &'static Format) -> Self {
        Self { options: vec![Options::new(format)], setting: None, seasons: false, idle: Vec::new() }
    }

    /// With an option that shows.
    #[must_use]
    pub(crate) fn with(mut self, name: &str, value: &str) -> Self {
        for options in &mut self.options {
            // A name that the format lacks would be a fault in its module; the tests write all of them.
            let _ = options.set(name, value);
        }
        self
    }

    pub(crate) fn with_switch(self, name: &str, is_on: bool) -> Self {
        self.with(name, if is_on { "true" } else { "false" })
    }

    /// With a switch that shows where it is on and changes something. Where it does not, it is off, or changes nothing.
    #[must_use]
    pub(crate) fn with_shown(self, name: &'static str, shows: bool) -> Self {
        if shows {
            return self.with_switch(name, true);
        }
        let mut either = self.with_either(name);
        either.idle.push(name);
        either
    }

    /// Whether a file that these options give again says nothing of one of them: it was on or off.
    pub fn is_idle(&self, options: &Options, name: &str) -> bool {
        self.idle.contains(&name) && options.is_on(name)
    }

    /// With a switch that does not show: on or off.
    #[must_use]
    pub(crate) fn with_either(self, name: &str) -> Self {
        let off = self.clone().with_switch(name, false).options;
        let on = self.clone().with_switch(name, true).options;
        Self { options: on.into_iter().chain(off).collect(), ..self }
    }
}

/// The exporters that may have written a file that carries a recipe, those of its ending first.
///
/// # Errors
/// What reading failed with.
pub(crate) fn writers(
    exporters: &[&'static dyn Exporter],
    path: &std::path::Path,
    file: &mut dyn Readable,
) -> io::Result<Vec<&'static dyn Exporter>> {
    let mut found = Vec::new();
    for exporter in exporters {
        file.rewind()?;
        if exporter.recipe(file).is_ok_and(|found| found.is_some()) {
            found.push(*exporter);
        }
    }
    file.rewind()?;
    // A flavour of another format has that one's ending.
    let of_ending = |exporter: &&dyn Exporter| {
        let id = exporter.format().id;
        let family = id.split_once('-').and_then(|(family, _)| {
            exporters.iter().map(|other| other.format()).find(|format| format.id == family)
        });
        exporter.format().ending_of(path).or_else(|| family?.ending_of(path)).map_or(0, str::len)
    };
    found.sort_by_key(|exporter| std::cmp::Reverse(of_ending(exporter)));
    Ok(found)
}

/// Which of some beginnings lines of the file have, white space aside: a line has the first of them that it begins with.
/// Reads no further than it takes to see the last of them.
pub(crate) fn beginnings<const N: usize>(
    file: &mut dyn Readable,
    beginnings: [&str; N],
) -> io::Result<[bool; N]> {
    let mut seen = [false; N];
    let mut line = Vec::new();
    while seen.last() != Some(&true) && file.read_until(b'\n', &mut line)? > 0 {
        let text = line.trim_ascii_start();
        let first = beginnings.iter().position(|beginning| text.starts_with(beginning.as_bytes()));
        if let Some(seen) = first.and_then(|first| seen.get_mut(first)) {
            *seen = true;
        }
        line.clear();
    }
    Ok(seen)
}

/// What stands behind a beginning in the first line that has it, white space aside.
pub(crate) fn behind(file: &mut dyn Readable, beginning: &str) -> io::Result<Option<Vec<u8>>> {
    file.rewind()?;
    let mut line = Vec::new();
    while file.read_until(b'\n', &mut line)? > 0 {
        if let Some(rest) = line.trim_ascii().strip_prefix(beginning.as_bytes()) {
            return Ok(Some(rest.to_vec()));
        }
        line.clear();
    }
    Ok(None)
}

/// The last line of a text.
pub(crate) fn last_line(file: &mut dyn Readable) -> io::Result<Vec<u8>> {
    /// An axis of many nodes is one line.
    const MOST: u64 = 1 << 20;
    let length = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(length.saturating_sub(MOST)))?;
    let mut last = Vec::new();
    while let Some(line) = recipe::line(file)? {
        last = line;
    }
    Ok(last)
}
