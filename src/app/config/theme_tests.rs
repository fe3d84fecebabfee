use super::*;

/// The ends of what terminals have as background, beside the grounds of the theme itself.
const BACKGROUNDS: [[[u8; 3]; 4]; 2] = [
    [[0x10, 0x10, 0x12], [0x1e, 0x1e, 0x2e], [0x00, 0x00, 0x00], [0x1d, 0x20, 0x21]],
    [[0xfa, 0xfa, 0xfa], [0xfd, 0xf6, 0xe3], [0xff, 0xff, 0xff], [0xf5, 0xf5, 0xf5]],
];

fn rgb(color: Color) -> [u8; 3] {
    match color {
        Color::Rgb(r, g, b) => [r, g, b],
        other => panic!("{other} is no colour of the palette"),
    }
}

/// The style of a role.
fn style(theme: &Theme, role: &Role) -> Style {
    *(role.slot)(&mut theme.clone())
}

/// The contrast ratio of two colours, 1 to 21 (WCAG 2.2, "contrast ratio").
fn contrast(a: [u8; 3], b: [u8; 3]) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// Relative luminance, 0 to 1 (WCAG 2.2, "relative luminance").
fn luminance(rgb: [u8; 3]) -> f64 {
    let linear = rgb.map(|byte| {
        let c = f64::from(byte) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

fn read(text: &str) -> (Theme, Vec<Complaint>) {
    Theme::read(Path::new("themes/moor.toml"), text, "moor", false, ColorDepth::True)
}

#[test]
fn contrast_is_wcags() {
    assert!((contrast([0; 3], [255; 3]) - 21.0).abs() < 1e-9);
    assert!((contrast([10, 20, 30], [10, 20, 30]) - 1.0).abs() < 1e-9);
    // The grey that is known as the lightest to pass on white, and the next one, which fails.
    assert!(contrast([0x76; 3], [255; 3]) >= 4.5 && contrast([0x77; 3], [255; 3]) < 4.5);
}

#[test]
fn text_can_be_read_on_every_ground() {
    for (theme, backgrounds) in [Theme::dark(), Theme::light()].iter().zip(BACKGROUNDS) {
        let palette = colors(theme.light, ColorDepth::True);
        let color = |name: &str| rgb(palette.iter().find(|(known, _)| known == name).unwrap().1);
        let mut grounds = backgrounds.to_vec();
        grounds.extend(["soil", "grass", "dusk"].map(color));
        for hue in PALETTE.iter().filter(|hue| !["soil", "grass", "dusk"].contains(&hue.name)) {
            let least = match hue.name {
                "bark" => 1.3,
                "moss" => 3.0,
                _ => 4.5,
            };
            for ground in &grounds {
                let found = contrast(color(hue.name), *ground);
                assert!(found >= least, "{} {} on {ground:x?}: {found:.2}", theme.name, hue.name);
            }
        }
    }
}

#[test]
fn the_selection_is_seen_on_every_background() {
    for (light, backgrounds) in [false, true].into_iter().zip(BACKGROUNDS) {
        let palette = colors(light, ColorDepth::True);
        let color = |name: &str| rgb(palette.iter().find(|(known, _)| known == name).unwrap().1);
        for ground in backgrounds.into_iter().chain(["soil", "dusk"].map(color)) {
            let found = contrast(color("grass"), ground);
            assert!(found >= 1.15, "light {light} on {ground:x?}: {found:.2}");
        }
    }
}

#[test]
fn only_lines_and_bars_are_drawn_in_inks_too_faint_for_text() {
    let faint: Vec<&str> = ROLES
        .iter()
        .filter(|role| matches!(role.paint.fg, Some("bark" | "moss")))
        .map(|role| role.name)
        .collect();
    assert_eq!(faint, ["border", "border_focused", "gauge_track", "scrollbar", "popup_border"]);
}

#[test]
fn every_role_is_painted_from_the_palette() {
    let names: Vec<&str> = PALETTE.iter().map(|hue| hue.name).collect();
    for role in ROLES {
        for name in role.paint.fg.iter().chain(&role.paint.bg) {
            assert!(names.contains(name), "{}: {name}", role.name);
        }
        assert!(ANSI.iter().all(|(ansi, _)| !names.contains(ansi)));
        for theme in [Theme::dark(), Theme::light()] {
            let style = style(&theme, role);
            assert_eq!(style.fg.is_some(), role.paint.fg.is_some(), "{}", role.name);
            assert_eq!(style.bg.is_some(), role.paint.bg.is_some(), "{}", role.name);
        }
    }
}

#[test]
fn plain_has_no_colours_and_still_tells_what_matters() {
    let plain = Theme::plain(false);
    for role in ROLES {
        let style = style(&plain, role);
        assert_eq!((style.fg, style.bg), (None, None), "{}", role.name);
    }
    assert_ne!(plain.selected, plain.text);
    assert_ne!(plain.selected, plain.selected_unfocused);
    assert_ne!(plain.border, plain.border_focused);
    assert_ne!(plain.modified, plain.value);
    assert_ne!(plain.error, plain.text);
    let dirs = Dirs::default();
    assert_eq!(Theme::load(&dirs, "dark", false, ColorDepth::None), (plain, vec![]));
}

#[test]
fn sixteen_colours_can_be_read_on_white() {
    // xterm's, of text as it is and as bold makes it.
    let look = |ink: Color| match ink {
        Color::Reset => [[0; 3]; 2],
        Color::DarkGray => [[127; 3]; 2],
        Color::Red => [[205, 0, 0], [255, 0, 0]],
        Color::Blue => [[0, 0, 238], [92, 92, 255]],
        Color::Magenta => [[205, 0, 205], [255, 0, 255]],
        other => panic!("{other}: is it seen on white?"),
    };
    for (name, ink) in colors(true, ColorDepth::Ansi16) {
        for looks in look(ink) {
            let found = contrast(looks, [255; 3]);
            assert!(found >= 3.0, "{name} {ink}: {found:.2}");
        }
    }
}

#[test]
fn sixteen_colours_are_the_terminals_and_mark_what_has_no_ground() {
    for light in [false, true] {
        let (theme, _) = Theme::load(&Dirs::default(), "auto", light, ColorDepth::Ansi16);
        for role in ROLES {
            let style = style(&theme, role);
            let is_ansi = |color: Color| color == Color::Reset || ANSI.iter().any(|(_, ansi)| *ansi == color);
            assert!(style.fg.is_none_or(is_ansi) && style.bg.is_none(), "{}: {style:?}", role.name);
        }
        assert!(theme.selected.add_modifier.contains(REVERSED));
        assert!(theme.dim.add_modifier.contains(DIM) && theme.text.add_modifier.is_empty());
        assert_eq!(theme.error.fg, Some(Color::Red));
        assert_ne!(theme.warning.fg, theme.error.fg);
    }
    // What the user says counts there too.
    let text = "extends = \"dark\"\nhint = { bg = \"soil\" }\nselected_unfocused = { bg = \"green\" }\n\
                [colors]\ngrass = \"blue\"\n";
    let (theme, complaints) = Theme::read(Path::new("x"), text, "moor", false, ColorDepth::Ansi16);
    assert_eq!(complaints, []);
    assert_eq!(theme.selected.bg, Some(Color::Blue));
    assert!(!theme.selected.add_modifier.contains(REVERSED));
    assert_eq!(theme.selected_unfocused.bg, Some(Color::Green));
    assert!(!theme.selected_unfocused.add_modifier.contains(UNDERLINED));
}

#[test]
fn a_theme_differs_where_it_says_so() {
    let text = "extends = \"light\"\naccent = \"#010203\"\ntitle = { fg = \"bright-red\", bold = false, dim = true }\n\
                popup = { bg = \"default\" }\nborder = \"ash\"\n[colors]\nash = \"#808080\"\nleaf = \"ash\"\n";
    let (theme, complaints) = read(text);
    assert_eq!(complaints, []);
    let light = Theme::light();
    let ash = Color::Rgb(0x80, 0x80, 0x80);
    assert!(theme.light && theme.name == "moor");
    assert_eq!(theme.accent, light.accent.fg(Color::Rgb(1, 2, 3)));
    assert_eq!(theme.title, Style::new().fg(Color::LightRed).add_modifier(DIM));
    assert_eq!(theme.popup, light.popup.bg(Color::Reset));
    assert_eq!(theme.border, light.border.fg(ash));
    // What is painted with a colour of the palette follows it.
    assert_eq!(theme.heading, light.heading.fg(ash));
    assert_eq!(theme.error, light.error);
}

#[test]
fn what_is_wrong_is_said_with_its_place_and_the_rest_counts() {
    let text = "extends = \"drak\"\naccnt = \"red\"\ntext = \"#12345\"\ndim = \"leef\"\ntitle = { bld = true, fg = 3 }\n\
                ok = 1\nerror = \"blue\"\n[colors]\nred = \"#000000\"\nx = [\n";
    let (theme, complaints) = read(text);
    let mut lines: Vec<usize> = complaints.iter().map(|c| c.place.unwrap().0).collect();
    lines.dedup();
    lines.sort_unstable();
    lines.dedup();
    let of = |line: usize| complaints.iter().find(|c| c.place.unwrap().0 == line).unwrap().message.clone();
    for line in [1, 2, 3, 4, 5, 6, 9] {
        assert!(lines.contains(&line), "{line} of {complaints:?}");
    }
    assert!(of(2).contains("did you mean 'accent'"), "{}", of(2));
    assert!(of(3).contains("#rrggbb"), "{}", of(3));
    assert!(of(4).contains("did you mean 'leaf'"), "{}", of(4));
    assert!(of(5).contains("did you mean 'bold'"), "{}", of(5));
    assert!(of(9).contains("another name"), "{}", of(9));
    let mut expected = Theme::dark();
    expected.name = "moor".into();
    expected.error = expected.error.fg(Color::Blue);
    assert_eq!(theme, expected);
}

#[test]
fn themes_are_found_by_name_and_only_there() {
    let dir = tempfile::tempdir().unwrap();
    let dirs = Dirs { config: Some(dir.path().to_owned()), state: None, cache: None };
    std::fs::create_dir(dir.path().join("themes")).unwrap();
    std::fs::write(dir.path().join("themes/moor.toml"), "extends = \"plain\"\ntext = \"red\"").unwrap();
    std::fs::write(dir.path().join("secret.toml"), "").unwrap();
    let load = |name: &str| Theme::load(&dirs, name, true, ColorDepth::True);
    let (theme, complaints) = load("moor");
    assert_eq!((theme.text.fg, complaints), (Some(Color::Red), vec![]));
    assert_eq!(load("auto"), (Theme::light(), vec![]));
    for name in ["none", "../secret", "", "a/b", "/etc/passwd", ".."] {
        let (theme, complaints) = load(name);
        assert_eq!((theme, complaints.len()), (Theme::light(), 1), "{name}");
    }
    assert_eq!(Theme::load(&Dirs::default(), "moor", false, ColorDepth::True).1.len(), 1);
}

#[test]
fn the_example_is_commented_out_and_says_what_dark_is() {
    let text = example();
    let named = |mut theme: Theme| {
        theme.name = "moor".into();
        theme
    };
    assert_eq!(read(&text), (named(Theme::dark()), vec![]));
    let active: String = text
        .lines()
        .map(|line| match line.strip_prefix('#') {
            Some(text) if !text.starts_with(' ') => format!("{text}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    // On a light terminal, so that `extends` and the palette are seen to count.
    let (theme, complaints) = Theme::read(Path::new("x"), &active, "moor", true, ColorDepth::Ansi256);
    assert_eq!(complaints, []);
    assert_eq!(theme, named(Theme::dark()));
    assert!(ROLES.iter().all(|role| active.contains(&format!("\n{} = {{", role.name))));
}
