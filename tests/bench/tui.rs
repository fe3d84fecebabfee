//! The budgets of the workbench, measured on the real program: `cargo bench -p linden-cli --bench tui`.
//!
//! Beside each time stands what this machine needs for the same without the program: `cat` on the
//! same pseudo-terminal, shown by the same screen.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a bench that cannot go on stops")]
#![allow(clippy::print_stdout, reason = "its table is its result")]

#[path = "../tui/harness/mod.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod harness;
#[path = "../tui/links.rs"]
mod links;

use std::time::{Duration, Instant};

use harness::{Answers, Home, Setup, Token, Workbench, tokens};

/// Points of the tree that grows while keys are pressed: many seconds of work.
const GROWN: u32 = 1_000_000;

fn main() {
    println!("{:<58}{:>10}{:>10}{:>10}{:>12}", "", "budget", "median", "95 %", "baseline");
    first_frame();
    let baseline = echo();
    keys_while_growing(baseline);
    for (case, pane) in links::CASES.iter().flat_map(|case| ["form", "list"].map(|pane| (case, pane))) {
        let answers = links::answers(case, pane, 15);
        let name = format!("key to answer, {pane}, {}, a picture on its way", case.name);
        row(&name, Some(case.budget), answers.iter().map(|a| a.whole).collect(), Some(case.link.round_trip));
        row("  of that the program", None, answers.iter().map(|a| a.program).collect(), None);
        row("  of that in the queue", None, answers.iter().map(|a| a.queued).collect(), None);
    }
    bytes();
}

/// A line of the table: times in milliseconds.
fn row(name: &str, budget: Option<Duration>, mut times: Vec<Duration>, baseline: Option<Duration>) {
    times.sort_unstable();
    let ms = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1e3);
    let or_none = |time: Option<Duration>| time.map_or_else(String::new, ms);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    println!(
        "{name:<58}{:>10}{:>10}{:>10}{:>12}",
        or_none(budget),
        ms(at(0.5)),
        ms(at(0.95)),
        or_none(baseline)
    );
}

/// A line of the table: bytes.
fn byte_row(name: &str, budget: usize, mut counts: Vec<usize>) {
    counts.sort_unstable();
    let at = |share: f64| format!("{} B", counts[((counts.len() - 1) as f64 * share).round() as usize]);
    println!("{name:<58}{:>10}{:>10}{:>10}", format!("{budget} B"), at(0.5), at(0.95));
}

/// From the start of the process to the first frame; the baseline is `true`, started and ended.
fn first_frame() {
    let mut times = Vec::new();
    let mut bare = Vec::new();
    for _ in 0..15 {
        let home = Home::new();
        let workbench = Setup::new(120, 40).start(&home);
        let screen_is_there = |screen: &harness::Shown| screen.footer().contains("Quit");
        workbench.wait_for("a frame", screen_is_there);
        // When its last byte came: before the first query, which is a kitty graphics one.
        let bytes = workbench.bytes();
        let query = harness::find(&bytes, b"\x1b_Gi=31").unwrap_or(bytes.len());
        times.push(workbench.times_of(query - 1).0 - workbench.started);
        drop(workbench);
        let started = Instant::now();
        let mut other = Setup::new(120, 40).spawn(&home, "true", &[]);
        other.wait_exit();
        bare.push(started.elapsed());
    }
    bare.sort_unstable();
    row("first frame, 120x40", Some(Duration::from_millis(50)), times, Some(bare[bare.len() / 2]));
}

/// What a key takes there and back through `cat`, while another process grows such a tree.
fn echo() -> Duration {
    let home = Home::new();
    let grows = Workbench::while_it_grows(&home, GROWN);
    let cat = Setup::new(120, 40).spawn(&home, "sh", &["-c", "stty raw -echo; echo ready; exec cat"]);
    cat.wait_for_text("ready");
    let mut times = Vec::new();
    while times.len() < 100 && !grows.screen().row(0).contains("nodes") {
        times.push(answer_time(&cat, "x"));
        std::thread::sleep(Duration::from_millis(15));
    }
    row(&format!("  the same through cat, beside it ({} keys)", times.len()), None, times.clone(), None);
    times.sort_unstable();
    times[(times.len() - 1) * 95 / 100]
}

/// From a key to the last byte that follows it at once.
fn answer_time(workbench: &Workbench, key: &str) -> Duration {
    let sent = workbench.sent();
    let pressed = Instant::now();
    workbench.keys(key);
    while workbench.sent() == sent {
        std::hint::spin_loop();
        std::thread::sleep(Duration::from_micros(100));
        assert!(pressed.elapsed() < Duration::from_secs(30), "no answer");
    }
    workbench.times_of(sent).0.saturating_duration_since(pressed)
}

fn keys_while_growing(baseline: Duration) {
    let mut times = Vec::new();
    let home = Home::new();
    let workbench = Workbench::while_it_grows(&home, GROWN);
    workbench.keys("\t\t");
    workbench.wait_for("the form", |screen| screen.footer().contains("More"));
    for round in 0..200 {
        if workbench.screen().row(0).contains("nodes") {
            break;
        }
        times.push(cursor_time(&workbench, if round % 8 < 4 { "j" } else { "k" }));
        std::thread::sleep(Duration::from_millis(15));
    }
    let name = format!("key to bytes while a tree grows ({} keys)", times.len());
    row(&name, Some(Duration::from_millis(16)), times, Some(baseline));
}

/// From a key to the bytes that move the form's cursor. Progress is sent too, so the stream is looked
/// at byte by byte.
fn cursor_time(workbench: &Workbench, key: &str) -> Duration {
    let before = workbench.screen().form_cursor();
    let (sent, pressed) = (workbench.sent(), Instant::now());
    workbench.keys(key);
    workbench.wait_for("the cursor", |screen| screen.form_cursor() != before);
    let bytes = workbench.bytes();
    let mut parser = vt100::Parser::new(40.try_into().unwrap(), 120.try_into().unwrap(), 0);
    parser.process(&bytes[..sent]);
    let moves = (sent..bytes.len()).find(|at| {
        parser.process(&bytes[*at..=*at]);
        harness::form_cursor(parser.screen()) != before
    });
    workbench.times_of(moves.expect("the cursor moves")).0.saturating_duration_since(pressed)
}

fn bytes() {
    let cost = |workbench: &Workbench, key: &str| {
        let before = workbench.sent();
        workbench.keys(key);
        workbench.settle();
        workbench.sent() - before
    };
    let keys =
        |workbench: &Workbench, key: &[&str]| key.iter().map(|key| cost(workbench, key)).collect::<Vec<_>>();
    for (columns, rows) in [(80, 14), (80, 24), (120, 40), (200, 60)] {
        let home = Home::new();
        let workbench = Workbench::open(&home, columns, rows, &["open", "fir"]);
        workbench.keys("\t\t");
        workbench.settle();
        byte_row(
            &format!("a knob down, {columns}x{rows}, 256"),
            150,
            keys(&workbench, &["j", "j", "k", "j", "k"]),
        );
        workbench.keys(":");
        workbench.settle();
        byte_row(
            &format!("palette down, {columns}x{rows}, 256"),
            150,
            keys(&workbench, &["\x1b[B", "\x1b[B", "\x1b[A"]),
        );
        workbench.keys("\x1b");
        workbench.settle();
        workbench.keys("?");
        workbench.settle();
        byte_row(&format!("help scrolled, {columns}x{rows}, 256"), 150, keys(&workbench, &["j", "j", "k"]));
    }
    for (columns, rows) in [(80, 24), (120, 40), (200, 60)] {
        for (name, answers) in [("24 bits", Answers::TrueColor), ("256", Answers::Plain)] {
            let home = Home::new();
            let setup = Setup::new(columns, rows).over_ssh().answers(answers).args(&["open", "sphere"]);
            let workbench = setup.start(&home);
            workbench.wait_for_tree();
            workbench.keys("\t");
            workbench.settle();
            let name = format!("{columns}x{rows}, {name}, SSH");
            byte_row(
                &format!("orbit: draft and full picture, {name}"),
                116_000,
                keys(&workbench, &["l", "h", "k"]),
            );
            byte_row(&format!("whole screen, {name}"), 116_000, keys(&workbench, &["\x0c"]));
        }
        let home = Home::new();
        let setup = Setup::new(columns, rows).over_ssh().answers(Answers::Kitty).args(&["open", "sphere"]);
        let workbench = setup.start(&home);
        workbench.wait_for_tree();
        workbench.keys("\t");
        workbench.settle();
        let from = workbench.sent();
        let costs = keys(&workbench, &["l", "h", "k"]);
        let bytes = workbench.bytes_from(from);
        let pictures = tokens(&bytes)
            .0
            .iter()
            .filter(|t| matches!(t, Token::String(b'_', b) if b.starts_with(b"Ga=t")))
            .count();
        byte_row(&format!("orbit: {pictures} pictures of kitty's, {columns}x{rows}, SSH"), 116_000, costs);
    }
    let home = Home::new();
    let workbench = Workbench::open(&home, 120, 40, &["open", "fir"]);
    std::thread::sleep(Duration::from_secs(2));
    workbench.settle();
    let before = (workbench.sent(), workbench.process().switches());
    std::thread::sleep(Duration::from_secs(2));
    let after = (workbench.sent(), workbench.process().switches());
    println!(
        "{:<58}{:>10}{:>10}   wake-ups {}",
        "two seconds of rest",
        "0 B",
        format!("{} B", after.0 - before.0),
        after.1 - before.1
    );
}
