//! Windows of any size, changed at any moment.

use linden::random::Key;
use linden::random::rand::RngExt;

use crate::harness::{End, Home, Setup, Workbench};

const SIZES: [(u16, u16); 16] = [
    (1, 1),
    (2, 1),
    (1, 40),
    (200, 2),
    (3, 3),
    (7, 5),
    (20, 4),
    (71, 24),
    (72, 24),
    (80, 24),
    (109, 30),
    (110, 30),
    (150, 12),
    (40, 120),
    (400, 120),
    (80, 3),
];

/// Keys that open and close everything, and move about.
const KEYS: [&str; 26] = [
    "j", "k", "\t", "l", "h", "?", "G", "g", "\x1b[6~", "\x1b", ":", "or", "\x1b[B", "\x7f", "\x1b", "/",
    "fi", "\x1b", "c", "t", "t", "m", "\x1b\x0c", "p", "P", "O",
];

/// Which panes' titles are in a row.
fn panes(row: &str) -> Vec<&'static str> {
    ["Presets", "Picture", "Shape"].into_iter().filter(|title| row.contains(title)).collect()
}

#[test]
fn panes_come_with_columns() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 109, 30, &["open", "fir"]);
    for (columns, rows, shown) in [
        (110, 30, &["Presets", "Picture", "Shape"][..]),
        (109, 30, &["Presets", "Picture"]),
        (56, 24, &["Presets", "Picture"]),
        (200, 60, &["Presets", "Picture", "Shape"]),
        (55, 24, &["Presets", "Picture", "Shape"]),
    ] {
        workbench.resize(columns, rows);
        workbench.settle();
        let screen = workbench.screen();
        // The headings, or the tabs.
        assert_eq!(panes(&screen.row(1)), shown, "{columns}x{rows}:\n{}", screen.text());
        let text = screen.row(rows - 2);
        if columns < 56 {
            // The list stands below the picture.
            assert!(text.starts_with(' ') && !screen.text().contains('│'), "{}", screen.text());
        } else {
            // Whatever the size: the rules run down to the footer.
            assert_eq!(
                text.chars().filter(|c| *c == '│').count(),
                shown.len() - 1,
                "{columns}x{rows}: {text}"
            );
        }
    }
}

#[test]
fn it_starts_at_any_size() {
    for (columns, rows) in SIZES {
        let home = Home::new();
        let mut workbench = Setup::new(columns, rows).args(&["open", "fir"]).start(&home);
        workbench.wait_for_bytes("a frame", |bytes| bytes.len() > 60);
        workbench.settle();
        workbench.keys("q");
        assert_eq!(workbench.wait_exit(), End::Code(0), "{columns}x{rows}");
    }
}

#[test]
fn every_dialog_bears_every_size() {
    let home = Home::new();
    let mut workbench = Workbench::open(&home, 80, 24, &["open", "fir"]);
    for opens in ["?", ":", "/fi", "s", "m"] {
        workbench.keys(opens);
        for (columns, rows) in SIZES {
            workbench.resize(columns, rows);
            workbench.keys("\x1b[B\x1b[A");
            std::thread::sleep(std::time::Duration::from_millis(15));
        }
        workbench.keys("\x03");
        workbench.resize(80, 24);
        workbench.settle();
        // Ctrl-C has closed what was open. Where nothing is, it leaves.
        assert!(panes(&workbench.screen().row(1)).len() == 2, "{opens:?}:\n{}", workbench.screen().text());
    }
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
}

#[test]
fn storms_of_sizes_and_keys_pass() {
    let mut chance = Key::new(7).rng();
    let mut next = move |below: usize| chance.random_range(0..below);
    let home = Home::new();
    let mut workbench = Workbench::open(&home, 80, 24, &["open", "fir"]);
    for _ in 0..300 {
        if next(3) == 0 {
            let (columns, rows) = if next(2) == 0 {
                SIZES[next(SIZES.len())]
            } else {
                (1 + next(220) as u16, 1 + next(70) as u16)
            };
            workbench.resize(columns, rows);
        }
        workbench.keys(KEYS[next(KEYS.len())]);
        // At any moment of what follows.
        std::thread::sleep(std::time::Duration::from_millis(next(12) as u64));
    }
    // Out of whatever is open.
    workbench.resize(80, 24);
    for _ in 0..3 {
        std::thread::sleep(std::time::Duration::from_millis(200));
        workbench.keys("\x1b");
    }
    std::thread::sleep(std::time::Duration::from_millis(200));
    workbench.keys("\x0c");
    workbench.wait_for("two panes", |screen| {
        screen.row(0).starts_with(" linden ")
            && panes(&screen.row(1)).len() == 2
            && screen.row(22).contains('│')
    });
    workbench.resize(120, 40);
    workbench.keys("q");
    std::thread::sleep(std::time::Duration::from_millis(300));
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
}

#[test]
fn a_size_that_no_screen_has_takes_no_more_than_a_large_screen() {
    let home = Home::new();
    let mut workbench = Workbench::open(&home, 80, 24, &["open", "fir"]);
    let sent = workbench.sent();
    workbench.claim(u16::MAX, u16::MAX);
    workbench.wait_for_bytes("a frame of the claimed size", |bytes| bytes.len() > sent + 10_000);
    workbench.settle();
    // 65535×65535 cells are 206 GB; the 1000×1000 that are used take 40 bytes each, a few times.
    let peak = workbench.process().peak_bytes();
    assert!((1..800_000_000).contains(&peak), "{peak} bytes");
    workbench.resize(80, 24);
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
}

#[test]
fn a_size_that_comes_while_the_program_starts_is_not_lost() {
    // Windows are given their size at any moment of it.
    for late_ms in (0..32).chain((32..80).step_by(4)) {
        let home = Home::new();
        let workbench = Setup::new(80, 24).args(&["open", "simple"]).start(&home);
        std::thread::sleep(std::time::Duration::from_millis(late_ms));
        workbench.resize(110, 36);
        workbench.wait_for(&format!("all 36 rows, asked for after {late_ms} ms"), |screen| {
            screen.row(35).contains("? Help") && screen.text().contains("Shape")
        });
    }
}

#[test]
fn redrawing_reads_the_size_though_nothing_told_of_it() {
    let home = Home::new();
    // Without a terminal of its own nobody sends it a signal.
    let workbench = Setup::new(80, 24).start_shell(&home, "setsid -w $LINDEN open simple");
    workbench.wait_for("a tree", |screen| screen.row(0).contains(" nodes"));
    workbench.resize(110, 36);
    workbench.keys("\x0c");
    workbench.wait_for("all 36 rows", |screen| screen.row(35).contains("? Help"));
}
