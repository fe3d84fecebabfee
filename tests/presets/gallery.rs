//! The gallery says what the presets are: every word and number in it comes from here.

use std::fmt::Write as _;
use std::path::Path;

use linden::Quiet;
use linden::surface::survey;
use linden_tests::presets::{Plant, plants};

const HEAD: &str = "# The presets\n\n\
    Pictures: `presets/pictures/draw`. Words and numbers: \
    `LINDEN_UPDATE=1 cargo test -p linden-tests --test presets gallery`.\n";

/// After a change that is meant to change presets: the command above.
#[test]
fn the_gallery_shows_each_preset_as_it_is() {
    let presets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let mut page = HEAD.to_owned();
    let mut group = "";
    for Plant { recipe, grown, .. } in plants() {
        let preset = &recipe.preset;
        if preset.group != group {
            group = &preset.group;
            write!(page, "\n## {group}\n\n| | |\n|---|---|\n").unwrap();
        }
        let skeleton = &grown.skeleton;
        let surface = survey(skeleton, &preset.dressing.tubes, &mut |_| (), &Quiet).unwrap();
        let measures = skeleton.measures();
        let about = if preset.about.is_empty() { String::new() } else { format!("<br>{}", preset.about) };
        writeln!(
            page,
            "| ![{id}](pictures/gallery/{id}.png) | **{name}** (`{id}`)<br>{summary}. {source}.{about}<br>\
             {height:.2} m high, {nodes} nodes on {axes} axes of orders 0 to {order}, {triangles} triangles of wood{leaves} |",
            id = preset.id,
            name = preset.name,
            summary = preset.summary,
            source = preset.source.trim_end_matches('.'),
            height = measures.height_m,
            nodes = skeleton.positions.len(),
            axes = skeleton.axes.len(),
            order = measures.max_order,
            triangles = surface.triangles,
            leaves = match grown.organs.len() {
                0 => String::new(),
                leaves => format!(", {leaves} leaves and the like"),
            },
        )
        .unwrap();
        let picture = presets.join(format!("pictures/gallery/{}.png", preset.id));
        assert!(picture.is_file(), "{} has no picture: presets/pictures/draw", preset.id);
    }
    let gallery = presets.join("GALLERY.md");
    if std::env::var_os("LINDEN_UPDATE").is_some() {
        std::fs::write(&gallery, &page).unwrap();
    }
    let shown = std::fs::read_to_string(&gallery).unwrap();
    for (now, then) in page.lines().zip(shown.lines()) {
        assert_eq!(now, then, "the gallery says otherwise (see its head)");
    }
    assert_eq!(page.lines().count(), shown.lines().count(), "presets came or went (see the gallery's head)");
}
