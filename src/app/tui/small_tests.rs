//! Every room at every small size: whatever has no room is not painted.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::testing::Bench;
use super::update::Msg;

/// Columns and rows up to which every size is tried.
const WIDEST: u16 = 34;
const HIGHEST: u16 = 16;

/// A room: its name, keys that lead there from the list, and letters typed there.
const ROOMS: [(&str, &str, &str); 17] = [
    ("list", "", ""),
    ("filter that matches", "/", "fir"),
    ("filter that matches nothing", "/", "zzzz"),
    ("filter that is kept", "/ z z q enter", ""),
    ("picture", "tab", ""),
    ("growth", "tab (", ""),
    ("form", "tab tab G", ""),
    ("form's line", "tab tab j j j j enter ctrl-u", "wrong"),
    ("grammar", "x", ""),
    ("grammar with a fault", "x", "]]"),
    ("save", "s", "/"),
    ("gallery", "v", ""),
    ("export", "e", ""),
    ("palette", ":", "e"),
    ("palette without a match", ":", "zzzz"),
    ("help", "?", ""),
    ("messages", "u m", ""),
];

#[test]
fn every_room_can_be_painted_at_every_size() {
    let mut faults = Vec::new();
    for (room, keys, letters) in ROOMS {
        let mut bench = Bench::grown(100, 30).without_pictures();
        bench.keys(keys).types(letters);
        for rows in 1..=HIGHEST {
            for columns in 1..=WIDEST {
                let painted = catch_unwind(AssertUnwindSafe(|| bench.msg(Msg::Resized(columns, rows))));
                if painted.is_err() {
                    faults.push(format!("{room} at {columns}×{rows}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
