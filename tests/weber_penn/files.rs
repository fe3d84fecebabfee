//! Files of Arbaro, Sapling and tree-gen, as they are saved.

use std::path::PathBuf;

use linden::weber_penn::{CrownShape, Dialect, ParameterFile, Program, read_parameters};

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("weber_penn/files").join(name)
}

fn read(name: &str) -> ParameterFile {
    let text = std::fs::read_to_string(path(name)).unwrap();
    read_parameters(&text).unwrap_or_else(|fault| panic!("{name}: {fault}"))
}

#[test]
fn arbaro_xml() {
    let file = read("rowan.xml");
    assert_eq!((file.program, file.species.as_deref()), (Program::Arbaro, Some("rowan")));
    let found = &file.settings;
    assert_eq!((found.shape, found.dialect, found.levels), (CrownShape::Spherical, Dialect::Arbaro, 3));
    assert_eq!((found.scale_m, found.scale_spread_m, found.base_size), (8.5, 0.5, 0.15));
    assert_eq!((found.trunk_scale, found.base_splits), (1.1, 1.0));
    assert_eq!(found.branches, [1.0, 24.0, 9.0, 5.0]);
    assert_eq!(found.down_angle_spread_deg, [0.0, -35.0, 0.0, 0.0]);
    assert_eq!(found.rotate_deg, [0.0, 120.0, -90.0, 120.0]);
    assert_eq!(found.branch_dist, [0.0, 0.5, 1.0, 1.0]);
    assert_eq!((found.leaf_quality, found.leaf_dist), (0.9, CrownShape::Cylindrical));
    let look = &file.look;
    assert_eq!((look.flare, look.lobes, look.lobe_depth, look.leaf_width), (0.8, 4.0, 0.05, 0.6));
    assert_eq!(
        file.notes,
        [
            "line 9: parameter 'ZScale' is in the paper's table without a formula and left out",
            "line 22: parameter 'Smooth' is of Arbaro's mesh and left out: sides and rings are for it",
            "line 37: parameter '2Wobble' is unknown and left out",
            "line 38: parameter 'Leavs' is unknown and left out (did you mean 'Leaves'?)",
        ]
    );
}

#[test]
fn arbaro_lines() {
    let file = read("rowan.cfg");
    assert_eq!((file.species.as_deref(), file.notes.len()), (Some("rowan"), 0));
    let (lines, xml) = (file.settings, read("rowan.xml").settings);
    assert_eq!((lines.shape, lines.scale_m, lines.base_splits), (xml.shape, xml.scale_m, xml.base_splits));
    assert_eq!(lines.rotate_deg, xml.rotate_deg);
}

#[test]
fn sapling() {
    let file = read("hazel-sapling.py");
    assert_eq!((file.program, file.seed), (Program::Sapling, Some(11)));
    let found = &file.settings;
    // Single precision as Blender prints it.
    assert_eq!((found.base_size, found.ratio, found.ratio_power), (0.1, 0.016, 1.2));
    assert_eq!((found.shape, found.dialect), (CrownShape::Hemispherical, Dialect::Paper));
    assert_eq!(found.branches, [1.0, 22.0, 8.0, 10.0]);
    assert_eq!(found.length, [0.8, 0.5, 0.4, 0.45]);
    assert_eq!(found.rotate_spread_deg, [15.0, 0.0, 0.0, 0.0]);
    assert_eq!((found.attraction_up, found.leaves, found.leaf_bend), (0.6, 0.0, 0.25), "showLeaves is False");
    // What it says of the envelope does not hold while prune is off.
    assert_eq!((found.prune_ratio, found.envelope.width), (0.0, 0.4));
    assert_eq!(file.notes.len(), 3, "{:?}", file.notes);
    assert!(file.notes[0].contains("'twigginess' is unknown"));
    assert!(file.notes[1].contains("leaves=9"));
    assert!(file.notes[2].contains("Blender's") && file.notes[2].contains("bevelRes"));
}

#[test]
fn what_sapling_has_and_the_paper_has_not_is_said_to_be_missing() {
    let text = "{'shape': '2', 'leaves': 5, 'showLeaves': True, 'minRadius': 0.01, 'nrings': 5, 'resU': 4}";
    let file = read_parameters(text).unwrap();
    assert_eq!(file.settings.leaves, 5.0);
    let [missing, view] = &file.notes[..] else { panic!("{:?}", file.notes) };
    assert!(missing.contains("linden does not have them") && missing.ends_with(": minRadius, nrings"));
    assert!(view.contains("Blender's") && view.ends_with(": resU"));
}

#[test]
fn tree_gen() {
    let file = read("alder.py");
    assert_eq!((file.program, file.species.as_deref()), (Program::TreeGen, Some("alder")));
    let found = &file.settings;
    assert_eq!((found.shape, found.base_size, found.base_splits), (CrownShape::Conical, 0.2, -2.0));
    assert_eq!((found.trunk_scale, found.attraction_up, found.leaves), (1.2, 0.7, 8.0));
    assert_eq!(found.branches, [1.0, 28.0, 8.0, 10.0]);
    assert_eq!(found.curve_res, [8.0, 5.0, 3.0, 1.0]);
    // Left out, so as the program has it.
    assert_eq!((found.ratio_power, &found.rotate_deg[..]), (1.2, &[0.0, 140.0, 140.0, 77.0][..]));
    let said = file.notes.join("\n");
    for (part, line) in [("'bend_v'", 17), ("'branch_dist'", 18), ("'sparkle' is unknown", 25)] {
        assert!(said.contains(part) && said.contains(&format!("line {line}:")), "{part}: {said}");
    }
    assert_eq!((file.look.leaf_outline, file.look.leaf_width, file.look.flare), ("ovate", 0.8, 0.4));
}

/// What is wrong is said with its place and its name.
#[test]
fn what_is_no_parameter_is_refused_with_its_place() {
    for (text, expected) in [
        (
            "<arbaro>\n <species name=\"a\">\n  <param name=\"1Length\" value=\"long\"/></species></arbaro>",
            "3:3: parameter '1Length': 'long' is no number",
        ),
        (
            "<arbaro><species>\n<param name=\"Levels\" value=\"2.5\"/></species></arbaro>",
            "2:1: parameter 'Levels': 2.5 is not a whole number from 1 to 8",
        ),
        (
            "<arbaro><param name=\"0CurveRes\" value=\"1e9\"/></arbaro>",
            "parameter '0CurveRes': 1000000000 is no value of curve_res",
        ),
        ("<arbaro><param name=\"Shape\" value=\"11\"/></arbaro>", "11 is no shape: 0 to 8 are"),
        ("<arbaro><param", "1:15: this XML is broken"),
        // Cut off: the end is where something is missing.
        ("<arbaro>\n <species name=\"a\">\n", "2:20: this XML is broken"),
        ("<arbaro><param value=\"1\"/></arbaro>", "a <param> has no name"),
        ("<svg/>", "this XML holds no <param>"),
        ("1DownAngle=60\nnonsense\n", "2:1: expected a line like 1DownAngle=60, found 'nonsense'"),
        ("{'levels': __import__('os').system('id')}", "1:12: expected a value, found '__import__"),
        ("{'levels': f'3'}", "expected a value, found"),
        ("{'levels': [[[[[[1]]]]]]}", "nested more than 4 deep"),
        ("{'levels': 3", "expected ',' or '}', found the end"),
        ("{'scale': 'large'}", "1:2: parameter 'scale': expected a number"),
        ("{'length': 3}", "parameter 'length': expected a tuple of numbers"),
        ("params = {'levels': 3 + 1}", "expected ',' or '}', found '+ 1}'"),
        ("params = {\n 'length': [1, 2,\n grow(), 3]}", "3:2: expected a value"),
    ] {
        let fault = read_parameters(text).unwrap_err().to_string();
        assert!(fault.contains(expected), "{text}\n  {fault}\n  {expected}");
    }
    let long = format!("{{'levels': 3{}}}", " ".repeat(linden::weber_penn::MAX_BYTES));
    assert!(read_parameters(&long).unwrap_err().to_string().contains("too many"));
    // Entities that would grow are no matter: a document type is refused.
    let entities = "<!DOCTYPE a [<!ENTITY b \"c\">]><arbaro>&b;</arbaro>";
    assert!(read_parameters(entities).is_err());
}

/// Files grow as they are, knobs can be turned, and notes reach whoever asked.
#[test]
fn files_grow_as_they_are() -> Result<(), linden::Error> {
    for name in ["rowan.xml", "rowan.cfg", "hazel-sapling.py", "alder.py"] {
        let tree = linden::read(path(name))?.set("levels", "2")?.set("max_nodes", "5000")?;
        let grown = tree.grow()?;
        assert!(grown.measures().height_m > 3.0, "{name}: {}", grown.measures().height_m);
        // The lines say nothing of leaves, and Arbaro then has none; Sapling's are switched off.
        let is_bare = ["rowan.cfg", "hazel-sapling.py"].contains(&name);
        assert_eq!(grown.grown().organs.is_empty(), is_bare, "{name}");
        if name == "rowan.xml" {
            assert!(
                grown.notes().iter().any(|note| note.contains("'2Wobble' is unknown")),
                "{:?}",
                grown.notes()
            );
        }
    }
    Ok(())
}
