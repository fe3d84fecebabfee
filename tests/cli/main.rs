//! The program as scripts see it: what it prints, what it writes, with which code it ends.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot go on fails")]
mod ages;
mod assembly;
mod bad_input;
mod batch;
mod bench;
mod cache;
mod calibrate;
mod clients;
mod completions;
mod cylinders;
mod describe;
mod docs;
mod doctor;
mod edits;
mod effects;
mod figures;
mod forecasts;
mod forest;
mod interrupt;
mod jobs;
mod kills;
mod kinds;
mod lint;
mod pipes;
mod plots;
mod plugins;
mod program;
mod provenance;
mod reading;
mod same_wood;
mod scan;
mod seasons;
mod sweep;
mod user_pictures;
mod verify;
