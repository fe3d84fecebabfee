//! Every view, as text at three sizes and as styles in every theme.

use std::fmt::Write as _;

use insta::assert_snapshot;

use super::testing::Bench;

/// Three panes, two, and one with tabs.
const SIZES: [(u16, u16); 3] = [(130, 34), (90, 24), (50, 14)];

/// One view at all sizes.
fn at_all_sizes(make: impl Fn(Bench) -> Bench) -> String {
    let mut text = String::new();
    for (columns, rows) in SIZES {
        let bench = make(Bench::new(columns, rows));
        let _ = write!(text, "{columns}×{rows}\n{}\n", uncounted(&bench));
    }
    text
}

/// The screen without the number of presets: one more is not another view.
fn uncounted(bench: &Bench) -> String {
    let count = bench.model.library.len().to_string();
    bench.screen().replace(&format!("of {count} ─"), &format!("of N {}", "─".repeat(count.len())))
}

/// The same with a tree and some keys.
fn after(keys: &'static str) -> String {
    at_all_sizes(|bench| {
        let mut bench = bench.with_tree();
        bench.keys(keys).settle();
        bench
    })
}

#[test]
fn nothing_is_chosen_yet() {
    assert_snapshot!(at_all_sizes(|bench| bench));
}

#[test]
fn the_list() {
    assert_snapshot!(after(""));
}

#[test]
fn the_list_filtered_while_the_filter_is_typed() {
    assert_snapshot!(at_all_sizes(|bench| {
        let mut bench = bench.with_tree();
        bench.keys("/").types("abst");
        bench
    }));
}

#[test]
fn the_picture_while_growth_is_scrubbed() {
    assert_snapshot!(after("tab c ("));
}

#[test]
fn the_form_with_a_knob_turned_and_typed() {
    assert_snapshot!(after("shift-tab j l enter"));
}

#[test]
fn help() {
    assert_snapshot!(after("?"));
}

#[test]
fn the_palette() {
    assert_snapshot!(at_all_sizes(|bench| {
        let mut bench = bench.with_tree();
        bench.keys(":").types("re");
        bench
    }));
}

#[test]
fn messages_of_every_weight() {
    assert_snapshot!(at_all_sizes(|bench| {
        let mut bench = bench.with_tree();
        bench.model.say("copied: linden export abop-a -o abop-a.glb");
        bench.model.say_warning("Undo: nothing was changed");
        bench.model.say_error(
            "/nowhere/config/keymap.toml:3:9: 'shft-tab' is no key; keys are written like q, G, ?, space, enter",
        );
        bench.keys("m");
        bench
    }));
}

#[test]
fn a_message_that_is_longer_than_the_footer() {
    assert_snapshot!(at_all_sizes(|bench| {
        let mut bench = bench.with_tree();
        bench.model.say_error("a long story of a file that could not be read, ".repeat(4));
        bench
    }));
}

#[test]
fn a_name_is_typed_to_save_by() {
    assert_snapshot!(after("s"));
}

#[test]
fn a_picture_fills_its_pane() {
    let bench = Bench::grown(100, 30);
    let area = super::picture::area(&bench.model).unwrap();
    let mut buffer = ratatui::buffer::Buffer::empty(ratatui::layout::Rect::new(0, 0, 100, 30));
    bench.drawn.put(&mut buffer, area);
    let is_drawn = |y: u16| (area.x..area.right()).any(|x| buffer[(x, y)].symbol() != " ");
    let rows = (area.y..area.bottom()).filter(|y| is_drawn(*y)).count();
    assert!(rows > usize::from(area.height) * 3 / 4, "{rows} of {}", area.height);
}

/// A screen with a bit of everything.
fn colorful(says: &[(&'static str, &str)], theme: &str) -> String {
    let mut bench = Bench::on(90, 24, says, theme).with_tree();
    bench.keys("shift-tab j l tab").settle();
    let panes = bench.styles();
    bench.keys(":").types("un");
    format!("{panes}\n{}", bench.styles())
}

#[test]
fn styles_on_dark() {
    assert_snapshot!(colorful(&[("COLORTERM", "truecolor")], "auto"));
}

#[test]
fn styles_on_light() {
    assert_snapshot!(colorful(&[("COLORTERM", "truecolor"), ("COLORFGBG", "0;15")], "auto"));
}

#[test]
fn styles_with_sixteen_colors() {
    assert_snapshot!(colorful(&[("TERM", "xterm")], "auto"));
}

#[test]
fn styles_without_colors() {
    let text = colorful(&[("NO_COLOR", "1")], "auto");
    assert!(!text.contains('#') && !text.contains(" on "), "no colour is set: {text}");
    assert_snapshot!(text);
}

#[test]
fn light_and_dark_show_the_same_text() {
    let screen = |says: &[(&'static str, &str)]| {
        let mut bench = Bench::on(100, 30, says, "auto").with_tree();
        bench.keys("?");
        bench.screen()
    };
    let dark = screen(&[("COLORTERM", "truecolor")]);
    assert_eq!(dark, screen(&[("COLORTERM", "truecolor"), ("COLORFGBG", "0;15")]));
    assert_eq!(dark, screen(&[("NO_COLOR", "1")]));
}

#[test]
fn from_one_cell_on_everything_can_be_painted() {
    for columns in (1..=24).chain([71, 72, 109, 110, 126, 150, 400]) {
        for rows in (1..=8).chain([20, 120]) {
            for keys in ["", "tab", "shift-tab enter", "?", ":", ": z z z", "m", "/", "/ z z z", "s", "("] {
                let mut bench = Bench::new(columns, rows);
                bench.keys(keys);
                bench.screen();
            }
        }
    }
}

#[test]
fn the_last_row_of_a_page_can_be_reached_at_every_size() {
    for (columns, rows) in [(200, 60), (130, 34), (90, 24), (60, 20), (40, 12), (20, 6)] {
        let mut bench = Bench::new(columns, rows);
        bench.model.say_warning(format!("{}last words", "long ago ".repeat(40)));
        bench.keys("m G");
        assert!(bench.screen().replace('\n', " ").contains("words"), "{columns}×{rows}:\n{}", bench.screen());
        let end = bench.screen();
        bench.keys("j pagedown");
        bench.model.message = None;
        assert_eq!(bench.screen(), end, "there is nothing below");
        bench.keys("g k pageup");
        bench.model.message = None;
        let top = bench.screen();
        bench.keys("k");
        bench.model.message = None;
        assert_eq!(bench.screen(), top, "there is nothing above");
    }
}
