//! Lists the preset files, so that adding a preset is adding a file.
fn main() {}
