//! What is drawn for a scene, and once.

use super::bark::bark;
use super::leaves::LEAVES;
use super::*;
use crate::Wanted;
use crate::moss;
use crate::testing::{Stop, Subject, body};
use glam::Vec3;
use linden_base::monitor::Quiet;
use linden_skeleton::AxisKind;

#[test]
fn what_is_drawn_ahead_is_not_drawn_again() {
    let subject = Subject::builtin(
        "drawn-oak",
        &[("points", "300"), ("leaf_size", "64"), ("limb_radius", "0.05"), ("moss", "0.5")],
    );
    let grown = subject.grow();
    subject.with(|specimen| {
        let pictures = |monitor: &dyn Monitor| {
            let (covers, _) = covers(specimen, &grown.organs, monitor)?;
            Ok::<_, DressError>((bark(specimen, monitor)?, thin_barks(specimen, monitor)?, covers))
        };
        assert!(matches!(pictures(&Stop), Err(DressError::Cancelled(_))));
        draw_ahead(specimen, &Quiet).unwrap();
        let found = pictures(&Stop).unwrap();
        // As they are drawn when nothing is there yet: bark, that of limbs, leaves.
        let anew = subject.dress(&grown).materials;
        assert_eq!((&found.0, &found.1[0].2), (&anew[0], &anew[1]));
        let leaves = found.2[0].as_ref().map(|cover| &cover.base_color);
        let worn = anew.iter().find(|material| material.name == LEAVES);
        assert!(leaves.is_some() && leaves == worn.and_then(|worn| worn.base_color_picture.as_ref()));
        let mossy = moss::materials(specimen, &found.0, &Stop).unwrap();
        assert!(mossy.len() == moss::STEPS.len() && mossy.iter().all(|mossy| anew.contains(mossy)));
    });
}

#[test]
fn lines_of_wood_have_the_thinnest_bark_and_dead_wood_its_own() {
    let barks = |knobs: &[(&str, &str)]| {
        let small = [("points", "300"), ("leaf_size", "64"), ("bark_size", "64"), ("dead_twigs", "0")];
        let subject = Subject::builtin("drawn-oak", &[&small[..], knobs].concat());
        let scene = subject.dress(&subject.grow());
        thinnest_barks(&scene.materials).map(|bark| bark.map_or(String::new(), |bark| bark.name.clone()))
    };
    assert_eq!(barks(&[]), ["bark", ""]);
    assert_eq!(barks(&[("limb_radius", "0.05")]), ["bark_limbs", ""]);
    let both = [("limb_radius", "0.05"), ("twig_radius", "0.01"), ("dead_twigs", "6")];
    assert_eq!(barks(&both), ["bark_twigs", "bark_dead"]);
    assert_eq!(thinnest_barks(&[]), [None, None]);
}

#[test]
fn dead_twigs_are_bare_and_shoots_have_leaves() {
    let small = [("points", "300"), ("leaf_size", "64"), ("bark_size", "64")];
    let of = |knobs: &[(&str, &str)]| {
        let subject = Subject::builtin("drawn-oak", &[&small[..], knobs].concat());
        let grown = subject.grow();
        let scene = subject.dress(&grown);
        (grown, scene)
    };
    let (before, bare) = of(&[("dead_twigs", "0"), ("epicormic", "0")]);
    let (after, scene) = of(&[("dead_twigs", "6"), ("epicormic", "2")]);
    let skeleton = &after.skeleton;
    let axis_of = skeleton.axis_of_nodes();
    let kind = |node: u32| skeleton.kind_of(axis_of[node as usize] as usize);
    let placed = &after.organs.placed;
    let on = |wanted: AxisKind| {
        (0..placed.len()).filter(|&organ| kind(placed.growth.nodes[organ]) == wanted).count()
    };
    assert_eq!(on(AxisKind::Dead), 0);
    assert!(on(AxisKind::Shoot) > 50, "{}", on(AxisKind::Shoot));
    // What grew has the leaves that it had, in the same places.
    let grown = (0..placed.len()).filter(|&organ| kind(placed.growth.nodes[organ]) == AxisKind::Grown);
    let places: Vec<Vec3> = grown.map(|organ| placed.positions[organ]).collect();
    assert_eq!(places, before.organs.placed.positions);
    // The dead have a colour of their own, and nothing else has.
    let dead = scene.parts.iter().find(|part| part.name == "wood_dead").unwrap();
    assert_eq!(scene.materials[dead.material].name, "bark_dead");
    let dead_axes = (0..skeleton.axes.len()).filter(|&axis| skeleton.kind_of(axis) == AxisKind::Dead);
    let nodes: usize = dead_axes.map(|axis| skeleton.axes[axis].len as usize).sum();
    assert!(dead.mesh.triangles.len() > 4 * nodes && !bare.materials.iter().any(|m| m.name == "bark_dead"));
    for at in dead.mesh.positions.iter().step_by(7) {
        let near = |node: &usize| {
            kind(*node as u32) == AxisKind::Dead && skeleton.positions[*node].distance(*at) < 0.7
        };
        assert!((0..skeleton.positions.len()).any(|node| near(&node)), "{at}");
    }
}

#[test]
fn what_nobody_wants_is_not_made() {
    let subject =
        Subject::builtin("drawn-oak", &[("points", "300"), ("leaf_size", "64"), ("limb_radius", "0.05")]);
    let grown = subject.grow();
    subject.with(|specimen| {
        let specimen = Specimen { wanted: Wanted::SKELETON, ..*specimen };
        // Not even where all that may be asked is whether to stop.
        let wardrobe = Wardrobe::new(&specimen, &grown.organs, &Stop).unwrap();
        let scene = wardrobe.dress(&specimen, body(&grown), None, &Stop).unwrap();
        assert!(scene.parts.is_empty() && scene.materials[0].base_color_picture.is_none());
        assert_eq!(scene.skeleton, grown.skeleton);
    });
}
