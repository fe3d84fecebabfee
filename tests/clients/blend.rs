//! The plug-in linden-export-blend, as far as it can be run without Blender.

use std::path::Path;

use crate::outside::run;

#[test]
fn coarser_levels_are_hidden_in_the_scene_wherever_the_importer_puts_them() {
    run("blend.py", Path::new("."));
}
