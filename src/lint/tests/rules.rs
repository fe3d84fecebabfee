//! Each rule fires on its fault, and is silent on a model without one.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod model;

use std::collections::BTreeSet;

use glam::{Vec2, Vec3};
use linden_lint::{Aspect, Config, ConfigError, PROFILES, RULES, Severity, lint};
use model::{Model, Part, cards, solid};

/// With all rules on.
fn all_on() -> Config {
    let mut config = Config::default();
    for rule in RULES {
        config.set_level(rule.id, "warn").unwrap();
    }
    config
}

fn found(model: &Model, config: &Config) -> BTreeSet<&'static str> {
    lint(&model.read(), config).findings.iter().map(|finding| finding.rule).collect()
}

#[test]
fn a_model_without_faults_is_clean_and_all_of_it_is_looked_at() {
    let asset = Model::clean().read();
    let report = lint(&asset, &all_on());
    assert!(report.findings.is_empty() && report.not_looked_at.is_empty(), "{report:#?}");
    assert_eq!(report.numbers.triangles, [12 + 20, 12 + 4]);
    assert_eq!((report.numbers.draw_calls.as_slice(), asset.colliders.len()), (&[2, 2][..], 1));
    assert!((report.numbers.height_m.unwrap() - 3.0).abs() < 1e-6);
}

/// A fault: the rules that see it, and how it is made.
type Fault = (&'static [&'static str], &'static str, fn(&mut Model));

fn trunk(model: &mut Model) -> &mut Part {
    model.part("oak_trunk_LOD0")
}

/// Trunks, cards and colliders alike.
fn all(model: &mut Model, change: impl Fn(&mut Vec3)) {
    model.parts.iter_mut().flat_map(|part| &mut part.positions).for_each(change);
}

static FAULTS: &[Fault] = &[
    (&["lod-chain"], "a level is missing", |model| {
        for part in &mut model.parts {
            part.name = part.name.replace("LOD1", "LOD2");
        }
    }),
    (&["lod-chain"], "a level saves nothing", |model| {
        *model.part("oak_leaves_LOD1") = Part { name: "oak_leaves_LOD1".to_owned(), ..cards("", 10) };
    }),
    (&["lod-chain"], "a level is smaller", |model| {
        let part = model.part("oak_leaves_LOD1");
        part.positions.iter_mut().for_each(|at| at.x *= 0.5);
    }),
    (&["degenerate"], "a corner twice", |model| trunk(model).triangles.push([0, 0, 1])),
    (&["degenerate"], "three corners on a line", |model| {
        let part = model.part("oak_leaves_LOD0");
        part.positions.extend([Vec3::new(0.0, 2.9, 0.0), Vec3::new(0.1, 2.9, 0.0), Vec3::new(0.2, 2.9, 0.0)]);
        part.normals.extend([Vec3::Z; 3]);
        part.uvs.extend([Vec2::splat(0.99); 3]);
        part.triangles.push([40, 41, 42]);
    }),
    (&["degenerate"], "a place that is no number", |model| {
        let part = model.part("oak_leaves_LOD0");
        part.positions.push(Vec3::NAN);
        part.normals.push(Vec3::Z);
        part.uvs.push(Vec2::ZERO);
    }),
    (&["duplicates", "uv-overlap"], "a card twice, seen from behind", |model| {
        model.part("oak_leaves_LOD0").triangles.push([2, 1, 0]);
    }),
    (&["non-manifold", "open-edges"], "a fin on an edge of the trunk", |model| {
        let fin = trunk(model);
        let [a, b] = [fin.positions[0], fin.positions[1]];
        fin.positions.extend([a, b, Vec3::new(0.3, 1.0, 0.3)]);
        let normal = (b - a).cross(Vec3::new(0.3, 1.0, 0.3) - a).normalize();
        fin.normals.extend([normal; 3]);
        fin.uvs.extend([[0.0, 0.0], [0.01, 0.0], [0.01, 0.01]].map(Vec2::from));
        fin.light.extend([[0.0, 0.0], [0.01, 0.0], [0.01, 0.01]].map(Vec2::from));
        fin.triangles.push([24, 25, 26]);
    }),
    (&["open-edges"], "a hole", |model| trunk(model).triangles.truncate(11)),
    (&["winding", "normals"], "a face that looks inwards", |model| trunk(model).triangles[3].swap(0, 1)),
    (&["winding", "normals"], "inside out", |model| {
        trunk(model).triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    }),
    (&["normals"], "no normals", |model| trunk(model).normals.clear()),
    (&["normals"], "normals that are too long", |model| {
        trunk(model).normals.iter_mut().for_each(|normal| *normal *= 1.1);
    }),
    (&["normals"], "normals of nothing", |model| trunk(model).normals[0] = Vec3::NAN),
    (&["normals"], "normals to the inside", |model| {
        trunk(model).normals.iter_mut().for_each(|normal| *normal = -*normal);
    }),
    (&["uv-missing"], "no texture coordinates", |model| trunk(model).uvs.clear()),
    (&["uv-missing"], "texture coordinates that are no numbers", |model| trunk(model).uvs[0] = Vec2::NAN),
    (&["uv-overlap"], "two cards with one cell", |model| {
        let part = model.part("oak_leaves_LOD0");
        for corner in 0..4 {
            part.uvs[corner] = part.uvs[corner + 4];
        }
    }),
    (&["lightmap-overlap"], "two sides with one cell", |model| {
        let part = trunk(model);
        for corner in 0..4 {
            part.light[corner] = part.light[corner + 4];
        }
    }),
    (&["lightmap-overlap"], "light outside of the picture", |model| {
        trunk(model).light.iter_mut().for_each(|uv| uv.x += 0.5);
    }),
    (&["texel-density"], "a picture too coarse", |model| model.pictures[0] = [32, 32]),
    (&["texture-size"], "a picture too large", |model| model.pictures[1] = [8192, 8192]),
    (&["texel-density"], "pictures too fine", |model| all(model, |at| *at *= 0.02)),
    (&["texture-size"], "no powers of two", |model| model.pictures[0] = [500, 1024]),
    (&["texture-missing"], "a picture that is not there", |model| {
        model.edit = |document| document["images"][0] = serde_json::json!({"uri": "bark.png"});
    }),
    (&["texture-missing"], "half a picture", |model| {
        model.edit = |document| {
            document["images"][0] = serde_json::json!({"uri": "data:image/png;base64,iVBORw0KGgo="});
        };
    }),
    (&["alpha-blend"], "blended leaves", |model| model.materials[1]["alphaMode"] = "BLEND".into()),
    (&["pivot"], "above the ground", |model| all(model, |at| at.y += 0.2)),
    (&["pivot"], "below the ground", |model| all(model, |at| at.y -= 0.6)),
    (&["pivot"], "beside the origin", |model| all(model, |at| at.z += 0.5)),
    (&["height", "texel-density"], "centimetres", |model| all(model, |at| *at *= 100.0)),
    (&["scale"], "a mirror", |model| {
        model.edit = |document| document["nodes"][1]["scale"] = serde_json::json!([-1.0, 1.0, 1.0]);
    }),
    (&["scale"], "unequal scales", |model| {
        model.edit = |document| document["nodes"][1]["scale"] = serde_json::json!([1.0, 1.0, 1.5]);
    }),
    (&["names"], "no name", |model| drop(model.materials[0].as_object_mut().unwrap().remove("name"))),
    (&["names"], "a name by itself", |model| model.materials[0]["name"] = "Material.001".into()),
    (&["names"], "a name twice", |model| model.materials[0]["name"] = "oak_leaves".into()),
    (&["collider"], "an open collider", |model| model.part("UCX_oak").triangles.truncate(11)),
];

#[test]
fn each_fault_is_seen_by_its_rule_and_by_no_other() {
    let config = all_on();
    for (rules, what, make) in FAULTS {
        let mut model = Model::clean();
        make(&mut model);
        let expected: BTreeSet<&str> = rules.iter().copied().collect();
        let report = lint(&model.read(), &config);
        let seen: BTreeSet<&str> = report.findings.iter().map(|finding| finding.rule).collect();
        assert_eq!(seen, expected, "{what}: {:#?}", report.findings);
    }
}

/// Counts are held against limits exactly.
#[test]
fn budgets_count_what_is_there() {
    let model = Model::clean();
    for (rule, limit, value) in [
        ("triangles", "max", 32.0),
        ("draw-calls", "max", 2.0),
        ("materials", "max", 2.0),
        ("mesh-vertices", "max", 40.0),
        ("collider", "triangles", 12.0),
    ] {
        let mut config = all_on();
        config.set_limit(rule, limit, value).unwrap();
        assert_eq!(found(&model, &config), BTreeSet::new(), "{rule}");
        config.set_limit(rule, limit, value - 1.0).unwrap();
        let report = lint(&model.read(), &config);
        assert_eq!(report.findings.len(), 1, "{rule}");
        assert_eq!((report.findings[0].rule, report.findings[0].measured), (rule, Some(value)));
        assert_eq!(report.findings[0].limit, Some(value - 1.0));
    }
    let mut one = Model::clean();
    one.parts.truncate(2);
    let mut config = all_on();
    assert_eq!(found(&one, &config), BTreeSet::new());
    config.set_limit("lod-missing", "triangles", 31.0).unwrap();
    config.set_limit("collider", "required", 1.0).unwrap();
    assert_eq!(found(&one, &config), ["collider", "lod-missing"].into());
    assert_eq!(found(&model, &config), BTreeSet::new());
}

#[test]
fn every_rule_is_tried() {
    let tried: BTreeSet<&str> = FAULTS.iter().flat_map(|(rules, ..)| rules.iter().copied()).collect();
    let counted = ["triangles", "draw-calls", "materials", "mesh-vertices", "lod-missing"];
    for rule in RULES {
        assert!(tried.contains(rule.id) || counted.contains(&rule.id), "{}", rule.id);
    }
}

#[test]
fn foliage_may_be_what_wood_may_not() {
    // Crossed cards share an edge, look to both sides and are open.
    let mut model = Model::clean();
    let crossed = solid("oak_twigs_LOD0", Vec3::new(-0.5, 2.0, -0.5), Vec3::new(0.5, 2.5, 0.5));
    let mut triangles = crossed.triangles.clone();
    triangles.truncate(7);
    triangles[2].swap(0, 1);
    model.parts.push(Part { triangles, material: 1, ..crossed });
    let mut config = all_on();
    config.set_level("uv-overlap", "off").unwrap();
    config.set_level("lod-chain", "off").unwrap();
    assert_eq!(found(&model, &config), BTreeSet::new());
    model.parts.last_mut().unwrap().material = 0;
    // By its name it is foliage still.
    assert_eq!(found(&model, &config), BTreeSet::new());
    model.parts.last_mut().unwrap().name = "oak_branches_LOD0".to_owned();
    assert_eq!(found(&model, &config), ["normals", "open-edges", "winding"].into());
}

/// Edges of three and more faces among random triangles, by looking at every pair of corners.
#[test]
fn edges_are_those_that_counting_finds() {
    let mut state = 7_u32;
    let mut number = move |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) % below
    };
    for _ in 0..40 {
        let places: Vec<Vec3> = (0..7).map(|i| Vec3::new(i as f32, (i * i) as f32, (i % 3) as f32)).collect();
        let triangles: Vec<[u32; 3]> = (0..12).map(|_| [number(7), number(7), number(7)]).collect();
        let whole: BTreeSet<[u32; 3]> = triangles
            .iter()
            .map(|triangle| {
                let mut sorted = *triangle;
                sorted.sort_unstable();
                sorted
            })
            .filter(|[a, b, c]| a < b && b < c)
            .collect();
        let (mut many, mut one) = (0, 0);
        for a in 0..7 {
            for b in a + 1..7 {
                let faces = whole.iter().filter(|t| t.contains(&a) && t.contains(&b)).count();
                many += usize::from(faces > 2);
                one += usize::from(faces == 1);
            }
        }
        // Each corner a vertex of its own: they are one by their places.
        let positions = triangles.iter().flatten().map(|&corner| places[corner as usize]).collect();
        let corners = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let part = Part { name: "wood".to_owned(), positions, triangles: corners, ..Part::default() };
        let model = Model { parts: vec![part], ..Model::clean() };
        let report = lint(&model.read(), &all_on());
        let measured = |rule: &str| {
            let finding = report.findings.iter().find(|finding| finding.rule == rule);
            finding.map_or(0.0, |finding| finding.measured.unwrap()) as usize
        };
        assert_eq!((measured("non-manifold"), measured("open-edges")), (many, one), "{triangles:?}");
    }
}

#[test]
fn texels_per_metre_are_what_a_ruler_says() {
    // A card of 0.2 m on 0.2 of a picture of 256 pixels: 256 texels a metre; twice that when it is repeated twice.
    let density = |model: &Model| {
        let mut config = all_on();
        config.set_limit("texel-density", "max", 0.0).unwrap();
        config.set_limit("texel-density", "min", 0.0).unwrap();
        let report = lint(&model.read(), &config);
        let of_leaves =
            report.findings.into_iter().find(|finding| finding.place.as_deref() == Some("oak_leaves_LOD0"));
        of_leaves.unwrap().measured.unwrap()
    };
    let mut model = Model::clean();
    assert!((density(&model) - 256.0).abs() < 0.01, "{}", density(&model));
    model.materials[1]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        serde_json::json!({"KHR_texture_transform": {"scale": [2.0, 2.0]}});
    assert!((density(&model) - 512.0).abs() < 0.01);
    model.edit = |document| document["nodes"][1]["scale"] = serde_json::json!([4.0, 4.0, 4.0]);
    assert!((density(&model) - 128.0).abs() < 0.01);
}

#[test]
fn configurations_are_read_and_mistakes_in_them_named() {
    let config = Config::parse(
        "profile = \"mobile\"\n[rules]\nuv-overlap = \"off\"\npivot = { level = \"error\", aside = 2 }\nnames = \"warn\"\n",
    );
    let config = config.unwrap();
    let rule = |id: &str| RULES.iter().find(|rule| rule.id == id).unwrap();
    assert_eq!(config.profile(), "mobile");
    assert_eq!(
        (config.severity(rule("pivot")), config.limit(rule("pivot"), "aside")),
        (Severity::Error, 2.0)
    );
    assert_eq!(
        (config.severity(rule("names")), config.severity(rule("uv-overlap"))),
        (Severity::Warn, Severity::Off)
    );
    assert_eq!(config.limit(rule("triangles"), "max"), 10_000.0, "the profile's");
    let said = |text: &str| Config::parse(text).unwrap_err().to_string();
    assert!(said("profile = \"moblie\"").contains("did you mean 'mobile'?"));
    assert!(said("[rules]\npivto = \"off\"").contains("did you mean 'pivot'?"));
    assert!(said("[rules]\npivot = { asied = 2 }").contains("did you mean 'aside'?"));
    assert!(said("[rules]\npivot = \"fatal\"").contains("off, info, warn or error"));
    assert!(said("[rules]\npivot = { aside = \"2\" }").contains("numbers"));
    assert!(said("[rules]\npivot = { level = 2 }").contains("word"));
    assert!(matches!(Config::parse("[rules]\npivot = { aside = -1.0 }"), Err(ConfigError::Value { .. })));
    assert!(matches!(Config::parse("[rules]\npivot = { aside = nan }"), Err(ConfigError::Value { .. })));
    assert!(matches!(Config::parse("rule = 3"), Err(ConfigError::Document(_))));
    // Tables name what there is.
    for profile in PROFILES {
        for (id, name, _) in profile.limits {
            assert!(rule(id).limits.iter().any(|limit| limit.name == *name), "{} {id} {name}", profile.id);
        }
        assert!(profile.severities.iter().all(|(id, _)| RULES.iter().any(|rule| rule.id == *id)));
    }
    for rule in RULES {
        let limits: Vec<f64> = rule.limits.iter().map(|limit| config.limit(rule, limit.name)).collect();
        assert!(limits.iter().all(|limit| limit.is_finite()), "{}", rule.id);
    }
}

#[test]
fn what_is_not_said_is_not_passed() {
    let mut asset = Model::clean().read();
    asset.note(Aspect::Alpha, "no alpha modes");
    let report = lint(&asset, &all_on());
    let rules: BTreeSet<&str> = report.not_looked_at.iter().map(|unseen| unseen.rule).collect();
    assert_eq!(rules, ["alpha-blend", "non-manifold", "normals", "open-edges", "winding"].into());
    // Rules that are off have nothing to say.
    let mut config = all_on();
    config.set_level("alpha-blend", "off").unwrap();
    assert!(lint(&asset, &config).not_looked_at.iter().all(|unseen| unseen.rule != "alpha-blend"));
}
