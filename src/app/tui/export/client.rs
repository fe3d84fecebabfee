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

    /// Sets what suits a program in all formats that have it. What suited the one before, and was not changed since, is as
    /// by itself again.
    fn set_client(&mut self, client: Option<&'static Profile>) {
        for choice in &mut self.formats {
            let format = choice.exporter.format();
            let before = self.client.iter().flat_map(|before| before.options_of(format));
            let unturned: Vec<_> = before.filter(|(name, value)| choice.is_set(name, value)).collect();
            for (name, _) in unturned {
                let usual = format.options.iter().find(|spec| spec.knob.name == name);
                let _ = choice.options.set(name, usual.map_or("", |spec| spec.default));
            }
            for (name, value) in client.iter().flat_map(|client| client.options_of(format)) {
                // The table has values of their kinds.
                let _ = choice.options.set(name, value);
            }
        }
        self.take_client(client);
    }

    /// The same where the options are what they were set to since.
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
    fn is_set(&self, name: &str, value: &str) -> bool {
        self.options.value(name).is_some_and(|set| set.to_string() == value)
    }

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
