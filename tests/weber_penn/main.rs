//! Weber and Penn's trees against the paper: a plain twin, closed forms, its table, and files of other programs.

mod files;
mod growth;
mod presets;
mod twin;
