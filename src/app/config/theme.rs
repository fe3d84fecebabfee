//! The styles of the workbench by role: `themes/NAME.toml`, and three that are built in.
//!
//! Two tables say everything: [`PALETTE`], the colours by name on dark and on light, and
//! [`ROLES`], what each role takes from it. Reading, the defaults, the example and the documentation
//! are made from them. The terminal's background is never painted over, except by selections,
//! inputs and dialogs.

use std::path::Path;

use linden::knob::{Kind, Value, excerpt};
use linden_terminal::ColorDepth;
use ratatui::style::{Color, Modifier, Style};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Complaint;
use super::dirs::{Dirs, NO_CONFIG};
use super::document::{TomlDocument, entries, text_of};

/// A colour of the built-in themes.
#[derive(Clone, Copy, Debug)]
pub struct Hue {
    /// What themes call it.
    pub name: &'static str,
    /// What it is for.
    pub help: &'static str,
    /// On a dark terminal, `#rrggbb`.
    pub dark: &'static str,
    /// On a light terminal, `#rrggbb`.
    pub light: &'static str,
    /// With 16 colours on a dark terminal, whose theme decides how they look. `Reset` is its text or background: a
    /// ground of unknown contrast is none, and what stands on it is marked as in `plain`.
    pub ansi: Color,
}

const fn hue(
    name: &'static str,
    help: &'static str,
    dark: &'static str,
    light: &'static str,
    ansi: Color,
) -> Hue {
    Hue { name, help, dark, light, ansi }
}

/// The colours of the built-in themes: bark, moss and leaves, a few blossoms for what must be seen.
///
/// On each ground below, and on terminals from `#101012` to `#1e1e2e` or from `#fafafa` to `#fdf6e3`,
/// all inks but `bark` and `moss` have a contrast of at least 4.5, as WCAG 2.2 asks of text (1.4.3);
/// `moss` has 3, as it asks of controls (1.4.11); `bark` only decorates.
pub const PALETTE: &[Hue] = &[
    hue("paper", "text", "#e6e4da", "#2a2d26", Color::Reset),
    hue("mist", "text of less weight", "#a9ae9f", "#565d4e", Color::Reset),
    hue("bark", "lines that only divide", "#555d50", "#b4baa6", Color::DarkGray),
    hue("moss", "lines that say where one is", "#84ad6b", "#4d7732", Color::Green),
    hue("leaf", "what stands out", "#a7d48a", "#35611c", Color::Green),
    hue("lichen", "success", "#8fd6b4", "#146245", Color::Green),
    hue("amber", "warnings and what moves", "#e8c57f", "#7a4c00", Color::Yellow),
    hue("rowan", "errors", "#f59a93", "#a31f2c", Color::Red),
    hue("heather", "what was changed", "#d6b0e6", "#723987", Color::Magenta),
    hue("sky", "keys and references", "#93cbdd", "#145a70", Color::Cyan),
    hue("soil", "ground of dialogs", "#20241e", "#f1f2e8", Color::Reset),
    hue("grass", "ground of the selection", "#34422d", "#cbdeb6", Color::Reset),
    hue("dusk", "ground of the selection elsewhere, and of inputs", "#2a2f28", "#e7eadd", Color::Reset),
];

/// What a role takes from the palette.
#[derive(Clone, Copy, Debug)]
pub struct Paint {
    /// Ink, a name of the palette.
    pub fg: Option<&'static str>,
    /// Ground, a name of the palette.
    pub bg: Option<&'static str>,
    /// Bold and the like.
    pub modifiers: Modifier,
}

const fn ink(name: &'static str) -> Paint {
    Paint { fg: Some(name), bg: None, modifiers: Modifier::empty() }
}

impl Paint {
    const fn on(self, name: &'static str) -> Self {
        Self { bg: Some(name), ..self }
    }

    const fn with(self, modifiers: Modifier) -> Self {
        Self { modifiers, ..self }
    }
}

/// One of [`ROLES`].
#[derive(Clone, Copy, Debug)]
pub struct Role {
    /// Its key in a theme.
    pub name: &'static str,
    /// What is drawn in it.
    pub help: &'static str,
    /// In the themes `dark` and `light`, whose colours are [`PALETTE`]'s.
    pub paint: Paint,
    /// In the theme `plain`, which has no colours.
    pub plain: Modifier,
    slot: fn(&mut Theme) -> &mut Style,
}

/// Makes [`Theme`] and [`ROLES`] of one table.
macro_rules! roles {
    ($($name:ident: $help:literal, $paint:expr, $plain:expr;)*) => {
        /// A style for each role.
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub struct Theme {
            /// What it is called. From outside: show it through `printable`.
            pub name: String,
            /// Whether it is made for a light background.
            pub light: bool,
            $(#[doc = $help] pub $name: Style,)*
        }

        /// All roles.
        pub const ROLES: &[Role] = &[$(Role {
            name: stringify!($name),
            help: $help,
            paint: $paint,
            plain: $plain,
            slot: |theme| &mut theme.$name,
        }),*];

        impl Theme {
            /// A theme in which nothing has a style.
            fn bare(name: &str, light: bool) -> Self {
                Self { name: name.to_owned(), light, $($name: Style::new(),)* }
            }
        }
    };
}

const NONE: Modifier = Modifier::empty();
const BOLD: Modifier = Modifier::BOLD;
const DIM: Modifier = Modifier::DIM;
const ITALIC: Modifier = Modifier::ITALIC;
const UNDERLINED: Modifier = Modifier::UNDERLINED;
const REVERSED: Modifier = Modifier::REVERSED;

roles! {
    text: "text", ink("paper"), NONE;
    dim: "text of less weight: summaries, units, sources", ink("mist"), DIM;
    disabled: "commands that cannot be run now", ink("mist").with(ITALIC), DIM;
    title: "the title of a pane", ink("mist").with(BOLD), NONE;
    title_focused: "the title of the pane that has the focus", ink("leaf").with(BOLD), BOLD;
    heading: "the name of a group in a list or form", ink("leaf").with(BOLD), BOLD;
    border: "the frame of a pane", ink("bark"), DIM;
    border_focused: "the frame of the pane that has the focus", ink("moss"), BOLD;
    selected: "the chosen row", ink("paper").on("grass").with(BOLD), REVERSED;
    selected_unfocused: "the chosen row of a pane without the focus", ink("paper").on("dusk"), UNDERLINED;
    accent: "what stands out", ink("leaf"), BOLD;
    matched: "letters that a filter found", ink("amber").with(BOLD), BOLD.union(UNDERLINED);
    value: "the value of a knob", ink("paper"), NONE;
    modified: "a value that is not the preset's, and its mark", ink("heather").with(BOLD), BOLD;
    unit: "the unit and range of a knob", ink("mist"), DIM;
    ok: "what went well", ink("lichen"), NONE;
    info: "notices", ink("sky"), NONE;
    warning: "warnings", ink("amber"), BOLD;
    error: "errors and where they are", ink("rowan").with(BOLD), BOLD.union(UNDERLINED);
    path: "files and addresses", ink("sky").with(UNDERLINED), UNDERLINED;
    key: "keys in hints and help", ink("sky").with(BOLD), BOLD;
    hint: "what the keys in hints do", ink("mist"), NONE;
    tab: "a tab", ink("mist"), DIM;
    tab_active: "the tab that is open", ink("leaf").with(BOLD), REVERSED;
    gauge: "the done part of a bar", ink("leaf"), BOLD;
    gauge_track: "the rest of a bar", ink("bark"), DIM;
    busy: "that something is being worked on", ink("amber"), BOLD;
    scrollbar: "where a list is scrolled to", ink("moss"), NONE;
    popup: "text and ground of dialogs, the palette and help", ink("paper").on("soil"), NONE;
    popup_dim: "text of less weight in dialogs", ink("mist").on("soil"), DIM;
    popup_border: "the frame of a dialog", ink("moss").on("soil"), BOLD;
    popup_title: "the title of a dialog", ink("leaf").on("soil").with(BOLD), BOLD;
    button: "what can be pressed in a dialog", ink("paper").on("dusk"), NONE;
    button_focused: "what Enter presses in a dialog", ink("paper").on("grass").with(BOLD), REVERSED;
    input: "a line that is typed into", ink("paper").on("dusk"), UNDERLINED;
    input_cursor: "the place that is typed at", Paint { fg: None, bg: None, modifiers: REVERSED }, REVERSED;
    placeholder: "what stands in an empty line", ink("mist").on("dusk"), DIM;
    line_number: "numbers of lines in the grammar's editor", ink("mist"), DIM;
    symbol: "symbols in the grammar's editor", ink("paper"), NONE;
    operator: "turns, brackets and arrows in the grammar's editor", ink("sky"), NONE;
    number: "numbers in the grammar's editor", ink("amber"), NONE;
    comment: "comments in the grammar's editor", ink("mist").with(ITALIC), DIM;
    points: "attraction points over the picture", ink("amber"), NONE;
    crown: "the outline of a crown over the picture", ink("sky"), NONE;
    scale_bar: "the scale bar and its length", ink("mist"), NONE;
    person: "the person beside the tree", ink("mist"), NONE;
}

/// The built-in themes.
pub const BUILT_IN: [&str; 3] = ["dark", "light", "plain"];

impl Theme {
    /// The built-in theme for dark backgrounds.
    pub fn dark() -> Self {
        Self::paint("dark", false, &colors(false, ColorDepth::True))
    }

    /// The built-in theme for light backgrounds.
    #[cfg(test)]
    pub fn light() -> Self {
        Self::paint("light", true, &colors(true, ColorDepth::True))
    }

    /// The built-in theme without colours: bold, dim, underlined and reversed say it all.
    pub fn plain(light: bool) -> Self {
        let mut theme = Self::bare("plain", light);
        for role in ROLES {
            *(role.slot)(&mut theme) = Style::new().add_modifier(role.plain);
        }
        theme
    }

    /// `dark` or `light`, with these colours.
    fn paint(name: &str, light: bool, palette: &[(String, Color)]) -> Self {
        let color = |name: Option<&str>| {
            palette.iter().find(|(known, _)| Some(known.as_str()) == name).map(|(_, color)| *color)
        };
        let mut theme = Self::bare(name, light);
        for role in ROLES {
            let mut style = Style::new().add_modifier(role.paint.modifiers);
            style.fg = color(role.paint.fg);
            style.bg = color(role.paint.bg);
            let wants_mark = match role.paint.bg {
                Some(_) => style.bg == Some(Color::Reset),
                None => role.paint.fg.is_some() && style.fg == Some(Color::Reset),
            };
            if wants_mark {
                style.bg = None;
                style.add_modifier |= role.plain;
            }
            *(role.slot)(&mut theme) = style;
        }
        theme
    }

    /// The theme that was asked for: `auto`, a built-in one, or a file in `themes/`.
    ///
    /// `light` is whether the terminal's background is (see [`is_light`]); it decides what `auto` is.
    /// Without colours every theme is `plain`; with 16 the palette is the terminal's. What cannot be read
    /// is replaced by `auto`.
    pub fn load(dirs: &Dirs, name: &str, light: bool, depth: ColorDepth) -> (Self, Vec<Complaint>) {
        if depth == ColorDepth::None {
            return (Self::plain(light), Vec::new());
        }
        if let Some(theme) = Self::built_in(name, light, depth) {
            return (theme, Vec::new());
        }
        let auto = || Self::auto(light, depth);
        let file_name = format!("{name}.toml");
        let Some(dir) = dirs.themes() else {
            let complaint = format!("the theme '{}' cannot be read: {NO_CONFIG}", excerpt(name));
            return (auto(), vec![Complaint::new(Path::new(&file_name), complaint)]);
        };
        let file = dir.join(&file_name);
        // A name and nothing else: a theme lies in the directory of themes.
        if file.file_name() != Some(file_name.as_ref()) || file.parent() != Some(&dir) {
            let message = format!("'{}' is no name of a theme; write it without a path", excerpt(name));
            return (auto(), vec![Complaint::new(&dir, message)]);
        }
        if !file.exists() {
            let message =
                format!("there is no such theme; write one, or choose auto, {}", BUILT_IN.join(", "));
            return (auto(), vec![Complaint::new(&file, message)]);
        }
        match text_of(&file) {
            Ok(text) => Self::read(&file, &text, name, light, depth),
            Err(complaint) => (auto(), vec![complaint]),
        }
    }

    /// The theme in a text; `file` is for the complaints.
    pub fn read(
        file: &Path,
        text: &str,
        name: &str,
        light: bool,
        depth: ColorDepth,
    ) -> (Self, Vec<Complaint>) {
        let (mut document, root) = TomlDocument::parse(file, text);
        let entries = entries(&root);
        let mut base = "auto".to_owned();
        let mut own_colors: Option<&DeTable<'_>> = None;
        for (key, _, value) in &entries {
            match (*key, value.get_ref()) {
                ("extends", DeValue::String(found))
                    if found == "auto" || BUILT_IN.contains(&found.as_ref()) =>
                {
                    base = found.to_string();
                }
                ("extends", _) => document.mismatch("extends", value, "auto, dark, light or plain"),
                ("colors", _) => own_colors = document.table("colors", value),
                _ => {}
            }
        }
        let light = match base.as_str() {
            "light" => true,
            "dark" => false,
            _ => light,
        };
        let is_plain = base == "plain";
        let mut palette = if is_plain { Vec::new() } else { colors(light, depth) };
        if let Some(colors) = own_colors {
            read_colors(&mut document, colors, &mut palette);
        }
        let mut theme = if is_plain { Self::plain(light) } else { Self::paint(name, light, &palette) };
        name.clone_into(&mut theme.name);
        for (key, span, value) in &entries {
            if let Some(role) = ROLES.iter().find(|role| role.name == *key) {
                let style = (role.slot)(&mut theme);
                if !is_plain && value.get_ref().get("bg").is_some() {
                    // Marks that stand for a ground are for where there is none.
                    style.add_modifier = role.paint.modifiers;
                }
                restyle(&mut document, key, value, &palette, style);
            } else if !matches!(*key, "extends" | "colors") {
                let names = ROLES.iter().map(|role| role.name).chain(["extends", "colors"]);
                document.unknown(span, "role", key, names);
            }
        }
        (theme, document.finish())
    }

    fn built_in(name: &str, light: bool, depth: ColorDepth) -> Option<Self> {
        match name {
            "dark" => Some(Self::auto(false, depth)),
            "light" => Some(Self::auto(true, depth)),
            "plain" => Some(Self::plain(light)),
            "auto" => Some(Self::auto(light, depth)),
            _ => None,
        }
    }

    fn auto(light: bool, depth: ColorDepth) -> Self {
        Self::paint(if light { "light" } else { "dark" }, light, &colors(light, depth))
    }
}

/// The palette of a built-in theme.
fn colors(light: bool, depth: ColorDepth) -> Vec<(String, Color)> {
    let of = |hue: &Hue| match (depth, light) {
        (ColorDepth::Ansi16 | ColorDepth::None, false) => Some(hue.ansi),
        (ColorDepth::Ansi16 | ColorDepth::None, true) => Some(ansi_on_light(hue.ansi)),
        (_, true) => hex(hue.light),
        (_, false) => hex(hue.dark),
    };
    PALETTE.iter().filter_map(|hue| Some((hue.name.to_owned(), of(hue)?))).collect()
}

/// One of the 16 colours that can be read on a light ground in the place of one that cannot: green, cyan and yellow of
/// common palettes have a contrast of 2 there, less where bold makes them bright.
const fn ansi_on_light(ansi: Color) -> Color {
    match ansi {
        Color::Green | Color::Cyan => Color::Blue,
        // Errors are red, and warnings are none.
        Color::Yellow => Color::Magenta,
        other => other,
    }
}

/// The sixteen colours that a terminal's theme decides.
const ANSI: [(&str, Color); 16] = [
    ("black", Color::Black),
    ("red", Color::Red),
    ("green", Color::Green),
    ("yellow", Color::Yellow),
    ("blue", Color::Blue),
    ("magenta", Color::Magenta),
    ("cyan", Color::Cyan),
    ("white", Color::Gray),
    ("bright-black", Color::DarkGray),
    ("bright-red", Color::LightRed),
    ("bright-green", Color::LightGreen),
    ("bright-yellow", Color::LightYellow),
    ("bright-blue", Color::LightBlue),
    ("bright-magenta", Color::LightMagenta),
    ("bright-cyan", Color::LightCyan),
    ("bright-white", Color::White),
];

/// Reads `[colors]` into a palette. A name may stand for another one that is known before it.
fn read_colors(document: &mut TomlDocument<'_>, colors: &DeTable<'_>, palette: &mut Vec<(String, Color)>) {
    for (name, span, value) in entries(colors) {
        if name == "default" || name.starts_with('#') || ANSI.iter().any(|(ansi, _)| *ansi == name) {
            document
                .complain(&span, format!("'{}' means a colour already; choose another name", excerpt(name)));
            continue;
        }
        let Some(color) = read_color(document, name, value, palette) else { continue };
        match palette.iter_mut().find(|(known, _)| known == name) {
            Some((_, slot)) => *slot = color,
            None => palette.push((name.to_owned(), color)),
        }
    }
}

/// Reads a colour: `#rrggbb`, one of the sixteen, a name of the palette, or `default`.
fn read_color(
    document: &mut TomlDocument<'_>,
    key: &str,
    value: &Spanned<DeValue<'_>>,
    palette: &[(String, Color)],
) -> Option<Color> {
    let Some(text) = value.get_ref().as_str() else {
        document.mismatch(key, value, "a colour: \"#rrggbb\", a name, or \"default\"");
        return None;
    };
    if let Some(color) = hex(text) {
        return Some(color);
    }
    if text.starts_with('#') {
        document.complain(&value.span(), format!("'{}' is no colour; write it as #rrggbb", excerpt(text)));
        return None;
    }
    let named = palette.iter().map(|(name, color)| (name.as_str(), *color));
    let mut all = named.chain(ANSI).chain([("default", Color::Reset)]);
    let found = all.clone().find(|(name, _)| *name == text);
    if found.is_none() {
        document.unknown(&value.span(), "colour", text, all.by_ref().map(|(name, _)| name));
    }
    found.map(|(_, color)| color)
}

/// `#rrggbb`.
fn hex(text: &str) -> Option<Color> {
    match (Kind::Color { auto: false }).parse(text) {
        Ok(Value::Color([r, g, b])) => Some(Color::Rgb(r, g, b)),
        _ => None,
    }
}

/// What a role's table may hold beside `fg` and `bg`.
const MODIFIERS: [(&str, Modifier); 5] =
    [("bold", BOLD), ("dim", DIM), ("italic", ITALIC), ("underline", UNDERLINED), ("reverse", REVERSED)];

/// Reads a role: a colour, or a table of what differs from the theme that is extended.
fn restyle(
    document: &mut TomlDocument<'_>,
    role: &str,
    value: &Spanned<DeValue<'_>>,
    palette: &[(String, Color)],
    style: &mut Style,
) {
    let table = match value.get_ref() {
        DeValue::Table(table) => table,
        DeValue::String(_) => {
            if let Some(color) = read_color(document, role, value, palette) {
                style.fg = Some(color);
            }
            return;
        }
        _ => {
            return document.mismatch(
                role,
                value,
                "a colour, or a table like { fg = \"leaf\", bold = true }",
            );
        }
    };
    for (key, span, value) in entries(table) {
        let modifier = MODIFIERS.iter().find(|(name, _)| *name == key);
        match (key, modifier, value.get_ref()) {
            ("fg", ..) => style.fg = read_color(document, key, value, palette).or(style.fg),
            ("bg", ..) => style.bg = read_color(document, key, value, palette).or(style.bg),
            (_, Some((_, modifier)), DeValue::Boolean(on)) => style.add_modifier.set(*modifier, *on),
            (_, Some(_), _) => document.mismatch(key, value, "true or false"),
            (_, None, _) => {
                let names = ["fg", "bg"].into_iter().chain(MODIFIERS.iter().map(|(name, _)| *name));
                document.unknown(&span, "part of a style", key, names);
            }
        }
    }
}

/// A theme file that names every colour and role as `dark` has them, commented out.
pub fn example() -> String {
    let mut text = "# A theme of linden: themes/NAME.toml, chosen by theme = \"NAME\" in config.toml.\n\
                    # A line counts once its '#' is removed.\n\
                    # A colour is #rrggbb, one of the terminal's sixteen (red, bright-red, …), a name from\n\
                    # [colors], or default. A role is a colour, or what differs from the theme it extends:\n\
                    # { fg = \"leaf\", bg = \"soil\", bold = true, dim, italic, underline, reverse }\n\n\
                    # auto, dark, light or plain; auto is light or dark by the terminal's background\n\
                    #extends = \"dark\"\n"
        .to_owned();
    for role in ROLES {
        let mut parts = Vec::new();
        parts.extend(role.paint.fg.map(|name| format!("fg = \"{name}\"")));
        parts.extend(role.paint.bg.map(|name| format!("bg = \"{name}\"")));
        let modifiers = MODIFIERS.iter().filter(|(_, modifier)| role.paint.modifiers.contains(*modifier));
        parts.extend(modifiers.map(|(name, _)| format!("{name} = true")));
        text += &format!("\n# {}\n#{} = {{ {} }}\n", role.help, role.name, parts.join(", "));
    }
    text += "\n# The palette; the roles above follow it.\n[colors]\n";
    for hue in PALETTE {
        let (dark, light) = (hue.dark, hue.light);
        text += &format!("# {} (light: {light})\n#{} = \"{dark}\"\n", hue.help, hue.name);
    }
    text
}

#[cfg(test)]
#[path = "theme_tests.rs"]
mod tests;
