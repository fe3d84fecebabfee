//! The form and the editor at all sizes.

use crate::config::theme::Theme;

use super::*;

/// Whatever is on the form, at the sizes that a pane has.
#[test]
fn the_form_at_three_sizes() {
    let mut bench = FormBench::new("abop-stochastic");
    bench.on("derivations").keys("right");
    for (columns, rows) in [(38, 20), (20, 5), (60, 40)] {
        let (buffer, _) = bench.paint(columns, rows);
        insta::assert_snapshot!(format!("form_{columns}x{rows}"), text(&buffer));
    }
    let mut bench = FormBench::new("cypress");
    bench.on("profile").keys("enter");
    let (buffer, _) = bench.paint(44, 20);
    insta::assert_snapshot!("form_profile_typed", text(&buffer));
}

#[test]
fn the_editor_at_three_sizes() {
    let mut bench = FormBench::new("abop-stochastic");
    bench.keys("x ctrl-end").typed("// F -> λ is no rule\nF -> F[+(3)F");
    for (columns, rows) in [(38, 20), (20, 5), (60, 40)] {
        let (buffer, _) = bench.paint(columns, rows);
        insta::assert_snapshot!(format!("editor_{columns}x{rows}"), text(&buffer));
    }
}

#[test]
fn every_theme_shows_the_cursor_what_was_changed_and_what_is_wrong() {
    for theme in [Theme::dark(), Theme::light(), Theme::plain(false)] {
        let mut bench = FormBench::new("abop-a");
        bench.model.config.theme = theme;
        bench.on("derivations").keys("right").on("angle");
        let (buffer, _) = bench.paint(100, 40);
        let lines: Vec<String> = text(&buffer).lines().map(str::to_owned).collect();
        let y = |name: &str| lines.iter().position(|line| line.contains(name)).unwrap() as u16;
        let style = |name: &str, x: u16| buffer[(x, y(name))].style();
        // A usual knob, the one under the cursor, and the one that was turned: three looks, and marks.
        assert_ne!(style("segment_length", 3), style("angle ", 3));
        assert_ne!(style("segment_length", 21), style("derivations", 21));
        assert!(lines[usize::from(y("derivations"))].contains("●derivations"));
        bench.keys("x down end").typed("]");
        let (buffer, _) = bench.paint(100, 40);
        let (x, y) = underlined(&buffer).unwrap();
        assert_eq!(buffer[(x, y)].symbol(), "]");
    }
}

#[test]
fn nothing_panics_at_any_size() {
    for preset in ["abop-stochastic", "cypress"] {
        let mut bench = FormBench::new(preset);
        let scripts = ["", "enter", "esc x down end F [ ", "esc s", "/ u", "b"];
        for script in scripts {
            bench.keys(script);
            for columns in (1..40).chain([72, 110, 400]) {
                for rows in (1..14).chain([120]) {
                    bench.paint(columns, rows);
                }
            }
        }
    }
}

#[test]
fn what_a_file_says_does_not_reach_the_screen_raw() {
    let mut bench = FormBench::new("abop-a");
    bench.keys("x");
    bench.send(Msg::Input(Event::Paste("// \u{1b}[2J\u{202e}e\u{301}\u{200b}漢\n".to_owned())));
    let (buffer, _) = bench.paint(80, 24);
    let shown = text(&buffer);
    assert!(!shown.contains('\u{1b}') && !shown.contains('\u{202e}'), "{shown}");
    assert!(shown.contains("// ·[2J·e··漢"), "{shown}");
}

#[test]
fn a_line_is_painted_at_its_knob() {
    let mut bench = FormBench::new("fir");
    bench.on("points").keys("enter ctrl-u").typed("4321");
    bench.on("seed");
    let (buffer, _) = bench.paint(120, 60);
    let shown = text(&buffer);
    let row = shown.lines().find(|line| line.contains("4321")).unwrap();
    assert!(row.contains("points") && !row.contains("seed"), "{row}");
}
