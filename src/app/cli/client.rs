//! What a program reads of files: `linden show --for CLIENT`.

use linden_exporters::{Profile, REGISTRY};
use serde::Serialize;

use crate::exit::usage;

#[derive(Serialize)]
struct ShownProfile {
    id: &'static str,
    name: &'static str,
    formats: &'static [&'static str],
    /// `FORMAT.OPTION` and value, of all formats that it reads.
    options: Vec<(String, &'static str)>,
    knobs: &'static [(&'static str, &'static str)],
    unread: Vec<UnreadRow>,
    levels: &'static str,
    colliders: &'static str,
    wind: &'static str,
    #[serde(skip_serializing_if = "str::is_empty")]
    leaves: &'static str,
    axis: &'static str,
}

#[derive(Serialize)]
struct UnreadRow {
    option: &'static str,
    value: &'static str,
    becomes: &'static str,
}

/// Prints what a program is said to read.
pub fn show(id: &str, json: bool) -> anyhow::Result<()> {
    let profile = Profile::find(id).map_err(usage)?;
    let formats = REGISTRY.iter().map(|exporter| exporter.format());
    let formats = formats.filter(|format| profile.formats.contains(&format.id));
    let mut options = Vec::new();
    for format in formats {
        let of_format = profile.options_of(format);
        options.extend(of_format.map(|(name, value)| (format!("{}.{name}", format.id), value)));
    }
    let unread = profile.unread.iter();
    let shown = ShownProfile {
        id: profile.id,
        name: profile.name,
        formats: profile.formats,
        options,
        knobs: profile.knobs,
        unread: unread.map(|&(option, value, becomes)| UnreadRow { option, value, becomes }).collect(),
        levels: profile.levels,
        colliders: profile.colliders,
        wind: profile.wind,
        leaves: profile.leaves,
        axis: profile.axis,
    };
    if json { super::print_json(&shown) } else { super::print(&shown.page()) }
}

impl ShownProfile {
    fn page(&self) -> String {
        let mut text = format!("{} ({})\n", self.name, self.id);
        for (what, said) in [
            ("formats", self.formats.join(", ")),
            ("axis", self.axis.to_owned()),
            ("levels", self.levels.to_owned()),
            ("shapes for physics", self.colliders.to_owned()),
            ("wind", self.wind.to_owned()),
            ("light in leaves", self.leaves.to_owned()),
        ] {
            if said.is_empty() {
                continue;
            }
            text.push_str(&format!("  {what:20}{said}\n"));
        }
        text.push_str(&format!("\n--for {} sets\n", self.id));
        self.options.iter().for_each(|(name, value)| text.push_str(&format!("  {name}={value}\n")));
        self.knobs.iter().for_each(|(name, value)| text.push_str(&format!("  {name}={value}\n")));
        if !self.unread.is_empty() {
            text.push_str("\nnot read there\n");
        }
        for UnreadRow { option, value, becomes } in &self.unread {
            text.push_str(&format!("  {option}={value}: {becomes}\n"));
        }
        text
    }
}
