//! What users bring: meshes, points, scans; well made, hostile, and from other programs.

#![allow(clippy::unwrap_used, reason = "what the tests share may fail them too")]
#![allow(clippy::format_push_string, clippy::format_collect, reason = "the files written here are small")]

mod clouds;
mod envelope;
mod obj;
mod ply;
mod reading;
mod scan;
mod scan_back;
mod scanner;
mod shapes;
mod xyz;
