//! What is said of a tree that grew, and should be known.

use linden_base::input::Geometry;
use linden_plant::foliage;
use linden_skeleton::generator::{Fit, Spread};
use linden_skeleton::{BREAST_HEIGHT_M, RadiusSource, Skeleton};

use crate::preset::{Form, Preset};
use crate::recipe::Recipe;
use crate::report::breast_fit;

/// What is said of a scan whose trunk shows no circle at breast height.
pub(super) fn trunk_note(skeleton: &Skeleton) -> Option<String> {
    let axes = skeleton.trunk();
    let nodes: Vec<u32> =
        axes.iter().flat_map(|&axis| skeleton.nodes_of(&skeleton.axes[axis as usize])).copied().collect();
    let source = |node: &u32| skeleton.fits.get(*node as usize).map(|fit| fit.source);
    if skeleton.fits.is_empty() {
        return None;
    }
    if !nodes.iter().any(|node| source(node) == Some(RadiusSource::Measured)) {
        return Some(
            "no circle was believed on the trunk: its diameter is a guess by the wood that it bears; give base_radius \
             if you know it"
                .to_owned(),
        );
    }
    let at_breast = breast_fit(skeleton, &nodes).filter(|_| is_higher_than_breast(skeleton, &nodes))?;
    let how = match at_breast.source {
        RadiusSource::Measured => return None,
        RadiusSource::Carried => "carried on from circles above and below",
        RadiusSource::Guessed => "a guess by circles elsewhere and the wood that it bears",
    };
    Some(format!("no circle was believed at breast height: the diameter there is {how}"))
}

/// Points are farther from the tree on average than this part of its height: in scans from four sides they are nearer than 0.01, also
/// where volumes are off by a third.
const FAR_PER_HEIGHT: f64 = 0.012;

/// What is said of a tree whose points lie far from it.
pub(super) fn far_note(skeleton: &Skeleton, fit: &Fit) -> Option<String> {
    let Spread { mean_m, p95_m } = fit.points_to_surface;
    let height_m = height_m(skeleton);
    (mean_m > FAR_PER_HEIGHT * height_m).then(|| {
        format!(
            "the points lie {mean_m:.2} m from the tree's surface on average (95 % within {p95_m:.2} m), far for a tree of {height_m:.1} m: \
             its volume and lengths are a guess; a denser scan from more sides comes nearer, leaf_points=paths for a tree in leaf"
        )
    })
}

/// No stem is thicker at breast height than this part of its tree's height.
const STOUTEST_PER_HEIGHT: f64 = 0.2;

/// What is said of a scan that is too stout for a tree.
pub(super) fn stout_note(skeleton: &Skeleton) -> Option<String> {
    let measures = skeleton.measures();
    let (dbh_m, height_m) = (measures.trunk_diameter_m, measures.height_m);
    let is_at_breast = measures.trunk_diameter_at_m == BREAST_HEIGHT_M;
    (is_at_breast && dbh_m > STOUTEST_PER_HEIGHT * height_m).then(|| {
        format!(
            "{dbh_m:.2} m at breast height are too thick for a tree of {height_m:.1} m: is it one tree, whole, and in the unit that scale= \
             says?"
        )
    })
}

fn height_m(skeleton: &Skeleton) -> f64 {
    let heights = || skeleton.positions.iter().map(|at| f64::from(at.y));
    heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)
}

fn is_higher_than_breast(skeleton: &Skeleton, trunk: &[u32]) -> bool {
    skeleton.climbed_m(trunk).last().is_some_and(|&climbed_m| climbed_m >= BREAST_HEIGHT_M)
}

/// What is to be known of a generator that the registry does not have: its table means nothing in a document.
pub(super) fn unregistered_note(preset: &Preset) -> Option<String> {
    let id = preset.grows_by().id();
    crate::generators::find(id).is_none().then(|| {
        format!(
            "the generator '{id}' is not registered: recipes and files of this tree cannot be read again; call \
             generators::register before anything else"
        )
    })
}

/// How the notes of [`mesh_notes`] begin.
pub(super) const MESH_NOTE: &str = "leaf_mesh: ";

/// What is to be known of the users' meshes of leaves.
pub(super) fn mesh_notes(recipe: &Recipe) -> Vec<String> {
    let kinds = recipe.preset.dressing.foliage.kinds().filter(|kind| kind.form == Form::Mesh);
    let note = |file: &String| match recipe.inputs.get(file).map(|input| &input.geometry) {
        Some(Geometry::Mesh(mesh)) => foliage::mesh_note(file, mesh),
        _ => None,
    };
    kinds.filter_map(|kind| kind.mesh.as_ref()).filter_map(note).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use linden_skeleton::{NO_PARENT, Wood};

    #[test]
    fn points_far_from_the_tree_and_stout_poles_are_noted() {
        let tree = |radius_m: f32| {
            let branching = linden_skeleton::Branching {
                positions: vec![Vec3::ZERO, 2.0 * Vec3::Y, 10.0 * Vec3::Y],
                parents: vec![NO_PARENT, 0, 1],
                births: vec![0; 3],
                radii: Some(vec![radius_m; 3]),
                edges: None,
            };
            Skeleton::build(branching, &Wood::default()).unwrap()
        };
        let fit = |mean_m: f64| {
            let spread = Spread { mean_m, p95_m: 2.0 * mean_m };
            Fit {
                points_to_surface: spread,
                points_to_axis: spread,
                axis_to_points: spread,
                surface_to_points: spread,
            }
        };
        assert_eq!(far_note(&tree(0.2), &fit(0.08)), None);
        assert!(far_note(&tree(0.2), &fit(0.14)).unwrap().contains("0.14 m from the tree's surface"));
        assert_eq!(stout_note(&tree(0.9)), None);
        assert!(stout_note(&tree(1.1)).unwrap().contains("2.20 m at breast height"));
    }
}
