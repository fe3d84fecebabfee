//! `[[colonization.part]]` in documents.

use linden_base::knob::Value;

use super::{Colonization, CrownPart, MOST_PARTS, Solid};
use crate::preset::Preset;
use linden_growth::Meet;

fn document(parts: &str) -> String {
    format!("id = \"a\"\n[colonization]\ncrown = \"sphere\"\n{parts}")
}

fn message(parts: &str) -> String {
    Preset::from_toml(&document(parts)).unwrap_err().to_string()
}

const ALL: &str = r#"
    [[colonization.part]]
    role = "subtract"
    crown = "cone"
    crown_height = 2
    at = [0, 1.5, 0]
    [[colonization.part]]
    role = "tree"
    crown = "revolution"
    profile_points = [[0, 1], [2, 3], [5, 0]]
    root = [6, 0, 1]
    trunk = 1
    [[colonization.part]]
    role = "obstacle"
    mesh = "rock.obj"
    meet = "stop"
    turn = -30
    scale = 0.5
    [[colonization.part]]
    role = "shade"
    crown = "dome"
    share = 0.5
"#;

#[test]
fn parts_survive_writing_and_reading() {
    let preset = Preset::from_toml(&document(ALL)).unwrap();
    let parts = &preset.settings::<Colonization>().unwrap().parts;
    assert_eq!(parts.len(), 4);
    assert_eq!(
        parts[0].solid,
        Solid::Shape {
            shape: "cone".into(),
            dimensions: vec![("crown_height", Value::Real(2.0)), ("crown_radius", Value::Real(5.0))]
        }
    );
    assert_eq!((parts[1].root, parts[1].trunk_m), (Some([6.0, 0.0, 1.0]), Some(1.0)));
    assert_eq!((parts[2].meet, parts[2].turn_deg, parts[2].scale), (Meet::Stop, -30.0, 0.5));
    assert_eq!(parts[3].share, 0.5);
    assert_eq!(
        parts.iter().map(CrownPart::describe).collect::<Vec<_>>(),
        ["subtract cone", "tree revolution", "obstacle 'rock.obj'", "shade dome"]
    );
    assert_eq!(preset.files(), ["rock.obj"]);
    let text = preset.to_toml().unwrap();
    let again = Preset::from_toml(&text).unwrap_or_else(|fault| panic!("{fault}: {text}"));
    assert_eq!(again, preset);
    let json = serde_json::to_string(&preset).unwrap();
    assert_eq!(Preset::from_json(&json).unwrap(), again);
}

#[test]
fn what_is_wrong_with_a_part_is_said_with_its_place() {
    for (parts, place, said) in [
        ("[[colonization.part]]\ncrown = \"dome\"", "5:1", "no 'role'; give it one of: add, subtract"),
        ("[[colonization.part]]\nrole = \"add\"", "5:1", "neither 'crown' nor 'mesh'"),
        ("[[colonization.part]]\nrole = \"ad\"\ncrown = \"dome\"", "5:8", "'ad' is not add | subtract"),
        ("[[colonization.part]]\nrole = \"add\"\ncrown = \"dom\"", "6:9", "'dom' is not"),
        (
            "[[colonization.part]]\nrole = \"add\"\ncrown = \"mesh\"",
            "6:9",
            "names it in place of a shape: mesh = \"rock.obj\"",
        ),
        (
            "[[colonization.part]]\nrole = \"tree\"\ncrown = \"dome\"\nroot = [3.6, 1e60, 0]",
            "7:8",
            "… is outside the range: x,y,z within ±1e9",
        ),
        ("[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"\nat = [0, 0, -2e9]", "7:6", "within ±1e9"),
        ("[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"\nmesh = \"a.obj\"", "7:1", "both"),
        ("[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"\nscael = 2", "7:1", "did you mean 'scale'"),
        (
            "[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"\ncrown_height = 2",
            "7:1",
            "part 1 has no 'crown_height'",
        ),
        (
            "[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"\nmeet = \"stop\"",
            "7:1",
            "of role add; it belongs to: obstacle",
        ),
        ("[[colonization.part]]\nrole = \"shade\"\ncrown = \"dome\"\nshare = 2", "7:9", "0 to 1"),
        ("[[colonization.part]]\nrole = \"tree\"\ncrown = \"dome\"", "5:1", "without a place"),
        ("part = 3", "4:8", "expected tables"),
        ("part = [3]", "4:9", "expected tables"),
    ] {
        let message = message(parts);
        assert!(message.starts_with(&format!("{place}: ")) && message.contains(said), "{parts}: {message}");
    }
    let many = "[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"\n".repeat(MOST_PARTS + 1);
    assert!(message(&many).contains("257 parts are more than the 256"));
    let scan = "id = \"a\"\n[colonization]\nscan = \"a.xyz\"\n[[colonization.part]]\nrole = \"add\"\ncrown = \"dome\"";
    let message = Preset::from_toml(scan).unwrap_err().to_string();
    assert!(message.contains("parts need a 'crown' or an 'envelope'"), "{message}");
}
