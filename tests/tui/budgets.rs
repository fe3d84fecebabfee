//! What keys, pictures and rest cost in bytes: the budgets of a terminal on a network.
//!
//! | what | budget |
//! |---|---|
//! | a key that leaves the picture alone | 150 B |
//! | a draft over a network | 16 KB |
//! | a full picture over a network | 100 KB |
//! | another preset over a network, in characters | 16 KB |
//! | leaving a dialog over a network, in characters | 12 KB |
//! | rest | nothing, not even a wake-up |

use std::time::{Duration, Instant};

use crate::harness::{Answers, Home, Setup, Token, Workbench, find, tokens};

const KEY: usize = 150;
const DRAFT: usize = 16_000;
const FULL: usize = 100_000;
const ANOTHER_PRESET: usize = 16_000;
/// What the dialog lay on: the list or the form, and at most a good half of the picture, for lines of 60 characters.
const LEAVING: usize = 12_000;
/// Where there is room, the form explains the knob that the cursor is on, at length in a tall terminal: up
/// to fifteen lines of 36 columns, which a key that moves it asks for, and the way there.
const ABOUT: usize = 15 * (36 + 8);
/// What a frame costs beside its picture: the texts of a screen, cursor, modes, queries.
const TEXT: usize = 16_000;

const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

/// Presses a key, and what that cost until the program rests.
fn cost(workbench: &Workbench, key: &str) -> usize {
    let before = workbench.sent();
    workbench.keys(key);
    workbench.settle();
    workbench.sent() - before
}

/// Costs of keys, of which each has changed something.
fn costs(workbench: &Workbench, keys: &[&str]) -> Vec<usize> {
    keys.iter().map(|key| cost(workbench, key)).collect()
}

/// In all depths of colour, in a terminal of some size, where `about` bytes tell of the selected knob.
fn keys_cost_little(columns: u16, rows: u16, about: usize) {
    for colors in ["truecolor", "256", "16", "none"] {
        let home = Home::new();
        let workbench = Workbench::open(&home, columns, rows, &["open", "fir", "--colors", colors]);
        workbench.keys("\t\t");
        workbench.settle();
        for key in ["j", "k", "j", "k", "j", "k"] {
            let cost = cost(&workbench, key);
            println!("{columns}x{rows} {colors} {key}: {cost}");
            assert!((1..=KEY + about).contains(&cost), "{columns}x{rows} {colors} {key}: {cost}");
        }
    }
}

#[test]
fn keys_that_leave_the_picture_alone_cost_little_in_a_low_terminal() {
    keys_cost_little(120, 14, 0);
    keys_cost_little(80, 14, 0);
}

#[test]
fn keys_that_leave_the_picture_alone_cost_little_in_a_usual_terminal() {
    keys_cost_little(80, 24, ABOUT);
    keys_cost_little(120, 40, ABOUT);
}

#[test]
fn keys_that_leave_the_picture_alone_cost_little_in_a_large_terminal() {
    keys_cost_little(200, 60, ABOUT);
}

#[test]
fn letters_that_are_typed_cost_little() {
    let home = Home::new();
    let workbench = Workbench::open(&home, 120, 40, &["open", "fir"]);
    workbench.keys("s");
    workbench.settle();
    let typed = costs(&workbench, &["x", "y", "\x7f"]);
    assert!(typed.iter().all(|cost| (1..=KEY).contains(cost)), "{typed:?}");
}

#[test]
fn at_rest_nothing_is_sent_and_nothing_wakes() {
    for answers in [Answers::Mute, Answers::TrueColor, Answers::Kitty] {
        let home = Home::new();
        let workbench = Setup::new(120, 40).args(&["open", "fir"]).answers(answers).start(&home);
        workbench.wait_for_tree();
        workbench.keys("\t");
        // Until replies are no longer waited for.
        std::thread::sleep(Duration::from_secs(2));
        workbench.settle();
        let before = (workbench.sent(), workbench.process().switches(), workbench.process().ticks());
        std::thread::sleep(Duration::from_secs(2));
        let after = (workbench.sent(), workbench.process().switches(), workbench.process().ticks());
        assert_eq!(after, before, "{answers:?}: bytes, wake-ups, processor time");
    }
}

#[test]
fn pictures_over_a_network_stay_within_their_budget() {
    for (columns, rows) in SIZES {
        for answers in [Answers::TrueColor, Answers::Plain] {
            let home = Home::new();
            let setup = Setup::new(columns, rows).over_ssh().answers(answers).args(&["open", "sphere"]);
            let workbench = setup.start(&home);
            workbench.wait_for_tree();
            workbench.keys("\t");
            workbench.settle();
            // A draft, then the full picture.
            let orbit = costs(&workbench, &["l", "k", "h"]);
            // All of the screen with the full picture.
            let whole = cost(&workbench, "\x0c");
            let drafts = drafts(&workbench);
            println!("{columns}x{rows} {answers:?}: orbit {orbit:?}, whole {whole}, drafts {drafts:?}");
            assert!(orbit.iter().all(|cost| *cost <= FULL + DRAFT), "{orbit:?}");
            assert!(whole <= FULL + TEXT, "{whole}");
            let median = drafts[drafts.len() / 2];
            assert!(median <= DRAFT, "{columns}x{rows} {answers:?}: {drafts:?}");
        }
    }
}

#[test]
fn another_preset_over_a_network_costs_little_in_characters() {
    for (columns, rows) in [(80, 24), (120, 40)] {
        let home = Home::new();
        let setup = Setup::new(columns, rows).over_ssh().answers(Answers::TrueColor).args(&["open", "oak"]);
        let workbench = setup.start(&home);
        workbench.wait_for_tree();
        workbench.settle();
        let mut before = workbench.screen().text();
        // In both directions: the last is a tree that has grown already.
        for key in ["j", "j", "j", "k"] {
            let cost = cost(&workbench, key);
            let text = workbench.screen().text();
            println!("{columns}x{rows} {key}: {cost}");
            assert!(text != before, "another preset is shown");
            assert!((1..=ANOTHER_PRESET).contains(&cost), "{columns}x{rows} {key}: {cost}");
            before = text;
        }
    }
}

#[test]
fn leaving_a_dialog_over_a_network_costs_little_in_characters() {
    for (columns, rows) in [(80, 24), (120, 40)] {
        for (colors, answers) in [("truecolor", Answers::TrueColor), ("256", Answers::Plain)] {
            let home = Home::new();
            let args = ["open", "drawn-oak", "--colors", colors];
            let setup = Setup::new(columns, rows).over_ssh().answers(answers).args(&args);
            let workbench = setup.start(&home);
            workbench.wait_for_tree();
            workbench.settle();
            for pane in ["list", "picture", "form"] {
                for (key, shows) in
                    [("?", "Help"), (":", "Commands"), ("e", "Export drawn-oak"), ("S", "Statistics")]
                {
                    workbench.keys(key);
                    workbench.wait_for_text(shows);
                    workbench.settle();
                    let cost = cost(&workbench, "\x1b");
                    assert!(!workbench.screen().text().contains(&format!(" {shows} ─")), "it is gone");
                    println!("{columns}x{rows} {colors} {pane} {key}: {cost}");
                    assert!((1..=LEAVING).contains(&cost), "{columns}x{rows} {colors} {pane} {key}: {cost}");
                }
                workbench.keys("\t");
                workbench.settle();
            }
        }
    }
}

/// What each frame of the turntable costs, in order of size: each is a draft.
fn drafts(workbench: &Workbench) -> Vec<usize> {
    // Between two of them the program rests.
    const PAUSE: Duration = Duration::from_millis(60);
    workbench.keys("t");
    workbench.wait_for_text("turning");
    let from = workbench.sent();
    let mut frames = vec![0];
    let mut last = Instant::now();
    std::thread::sleep(Duration::from_secs(4));
    for (at, bytes) in workbench.pieces_from(from) {
        if at.saturating_duration_since(last) > PAUSE {
            frames.push(0);
        }
        last = at;
        *frames.last_mut().unwrap() += bytes;
    }
    workbench.keys("t");
    workbench.settle();
    // The first and the last are not whole.
    let mut frames = frames[1..frames.len() - 1].to_vec();
    frames.sort_unstable();
    assert!(frames.len() >= 4, "it turns: {frames:?}");
    frames
}

/// Bytes of each picture of kitty's protocol, and of iTerm2's and sixels.
fn graphics(bytes: &[u8]) -> Vec<usize> {
    let mut pictures: Vec<usize> = Vec::new();
    for token in tokens(bytes).0 {
        match token {
            Token::String(b'_', body) if body.starts_with(b"G") => {
                let keys: &[u8] = body[1..].split(|byte| *byte == b';').next().unwrap_or_default();
                let continues = find(keys, b"a=").is_none();
                let transmits = find(keys, b"a=t").is_some();
                match pictures.last_mut() {
                    Some(last) if continues => *last += body.len() + 4,
                    _ if transmits => pictures.push(body.len() + 4),
                    _ => {}
                }
            }
            Token::String(b']', body) if body.starts_with(b"1337;") => pictures.push(body.len() + 4),
            Token::String(b'P', body)
                if body.iter().take(12).any(|byte| *byte == b'q') && !body.starts_with(b"$q") =>
            {
                pictures.push(body.len() + 4);
            }
            _ => {}
        }
    }
    pictures
}

/// Pictures of three keys, and all bytes that they cost.
fn three_keys(columns: u16, rows: u16, answers: Answers) -> (Vec<usize>, usize) {
    let home = Home::new();
    let setup = Setup::new(columns, rows).over_ssh().answers(answers).args(&["open", "sphere"]);
    let workbench = setup.start(&home);
    workbench.wait_for_tree();
    workbench.keys("\t");
    workbench.settle();
    let from = workbench.sent();
    for key in ["l", "l", "k"] {
        workbench.keys(key);
        workbench.settle();
    }
    let bytes = workbench.bytes_from(from);
    (graphics(&bytes), bytes.len())
}

#[test]
fn pictures_of_pixels_stay_within_their_budget_too() {
    // Where the machine is busy, answers come late, and over a link that seems slow a picture that cannot
    // be sent in pieces is not sent: its cells stay. Another start is then another measurement.
    const TRIES: usize = 8;
    for (columns, rows) in SIZES {
        for answers in [Answers::Kitty, Answers::Iterm2, Answers::Sixel] {
            let all_came = (0..TRIES).any(|_| {
                let (pictures, bytes) = three_keys(columns, rows, answers);
                println!("{columns}x{rows} {answers:?}: {pictures:?} of {bytes}");
                assert!(
                    pictures.iter().all(|bytes| *bytes <= FULL),
                    "{columns}x{rows} {answers:?}: {pictures:?}"
                );
                // Where pixels are not there yet, cells are.
                let most = 3 * (FULL + if answers == Answers::Sixel { 2 * DRAFT } else { DRAFT });
                assert!(bytes <= most, "{columns}x{rows} {answers:?}: {bytes}");
                // Sixels cannot be made smaller at will: where they are too large, cells are sent.
                if answers == Answers::Sixel {
                    return true;
                }
                if pictures.len() != 6 {
                    return false;
                }
                let drafts = pictures.iter().step_by(2);
                assert!(drafts.max() <= Some(&DRAFT), "{columns}x{rows} {answers:?}: {pictures:?}");
                true
            });
            assert!(all_came, "{columns}x{rows} {answers:?}: a draft and a picture for each key");
        }
    }
}
