//! The program that files are for: the options and knobs that suit it, as `--for` sets them.

use linden_exporters::{PROFILES, Profile};

use super::dialog::{ExportDialog, FormatChoice};
use super::knobs::ExportKnobs;

impl ExportDialog {
    /// Goes to the program after or before the one that is chosen; none stands before the first.
    pub fn nudge_client(&mut self, up: bool) {
        let at = self.client.and_then(|now| PROFILES.iter().position(|profile| profile.id == now.id));
        let places = PROFILES.len() + 1;
        let at = at.map_or(0, |at| at + 1);
        let next = (at + if up { 1 } else { places - 1 }) % places;
        self.set_client(next.checked_sub(1).map(|next| &PROFILES[next]));
    }

    /// Sets what suits a program in all formats that have it, as `--for` does: what was set by hand holds against it. What
    /// suited the one before is as by itself again.
    fn set_client(&mut self, client: Option<&'static Profile>) {
        for choice in &mut self.formats {
            let format = choice.exporter.format();
            for (name, _) in self.client.iter().flat_map(|before| before.options_of(format)) {
                if !choice.options.is_asked(name) {
                    choice.options.reset(name);
                }
            }
            for (name, value) in client.iter().flat_map(|client| client.options_of(format)) {
                if !choice.options.is_asked(name) {
                    // The table has values of their kinds.
                    let _ = choice.options.suit(name, value);
                }
            }
        }
        self.take_client(client);
    }

    /// The same where the options have it already.
    pub fn take_client(&mut self, client: Option<&'static Profile>) {
        self.client = client;
        if let Some(knobs) = &mut self.knobs {
            knobs.suit(client.map_or(&[], |client| client.knobs));
        }
    }

    /// What the program cannot read of the files, a sentence each.
    pub fn unread(&self) -> Vec<String> {
        let levels = self.knobs.as_ref().map_or(1, ExportKnobs::levels);
        let of = |client: &Profile, choice: &FormatChoice| {
            client.unread(choice.exporter.format(), &choice.options, levels)
        };
        self.client.iter().flat_map(|client| self.chosen().flat_map(|choice| of(client, choice))).collect()
    }

    /// What it is for, or what it reads.
    pub fn client_about(&self) -> String {
        match self.client {
            None => "for a program: options that suit it, in each format that has them".to_owned(),
            Some(client) => format!(
                "{}: reads {}; levels: {}; wind: {}",
                client.name,
                client.formats.join(", "),
                client.levels,
                client.wind
            ),
        }
    }
}

impl FormatChoice {
    /// The options that are not as `--for` sets them, or by themselves without it.
    pub fn turned(&self, client: Option<&'static Profile>) -> Vec<(&'static str, String)> {
        let format = self.exporter.format();
        let suited: Vec<_> = client.iter().flat_map(|client| client.options_of(format)).collect();
        let is_usual = |name: &str, default: &str| {
            let usual =
                suited.iter().find(|(suited, _)| *suited == name).map_or(default, |(_, value)| *value);
            let kind = format.options.iter().find(|spec| spec.knob.name == name).map(|spec| spec.knob.kind);
            kind.is_none_or(|kind| kind.parse(usual).ok().as_ref() == self.options.value(name))
        };
        let turned = format.options.iter().filter(|spec| !is_usual(spec.knob.name, spec.default));
        let value = |name| self.options.value(name).map(ToString::to_string).unwrap_or_default();
        turned.map(|spec| (spec.knob.name, value(spec.knob.name))).collect()
    }
}
