//! Checks of what is to be written: a scene that breaks a promise of its types is refused before a byte
//! is written.

use linden_pipeline::Monitor;
use linden_pipeline::scene::{Bounds, Material, Mesh, Part, Scene};
use linden_pipeline::skeleton::{NO_PARENT, Skeleton};
use linden_pipeline::stage::{Place, Stage};
use linden_pipeline::wind::{AxisPivot, Binding, PartWind};
use rayon::prelude::*;

use crate::ExportError;

/// Vertices or triangles per piece of parallel work.
const CHUNK: usize = 1 << 16;

/// Checks what a stage says beside its scenes: names, places, levels.
///
/// # Errors
/// [`ExportError::Scene`].
pub fn stage(stage: &Stage<'_>) -> Result<(), ExportError> {
    let fault = |problem: String| ExportError::Scene { what: "the stage".to_owned(), problem };
    let strange = |name: &str| name.is_empty() || name.chars().any(char::is_control);
    if strange(&stage.name) {
        return Err(fault("its name is empty or holds control characters".to_owned()));
    }
    if !is_line(&stage.recipe) {
        return Err(fault("its recipe is not one line of printable ASCII".to_owned()));
    }
    if stage.places.is_empty() {
        return Err(fault("nothing stands on it".to_owned()));
    }
    for (index, plant) in stage.plants.iter().enumerate() {
        if strange(&plant.name) {
            return Err(fault(format!("the name of plant {index} is empty or holds control characters")));
        }
        let levels = plant.levels().len();
        if levels == 0 || plant.seasons.iter().any(|season| season.levels.len() != levels) {
            return Err(fault(format!("the seasons of plant {index} differ in levels, or have none")));
        }
    }
    let mut stands = vec![false; stage.plants.len()];
    for place in &stage.places {
        if let Some(stands) = stands.get_mut(place.plant) {
            *stands = true;
        }
    }
    if let Some(index) = stands.iter().position(|stands| !stands) {
        return Err(fault(format!("plant {index} stands nowhere")));
    }
    for (index, place) in stage.places.iter().enumerate() {
        if place.plant >= stage.plants.len() {
            return Err(fault(format!(
                "place {index} is for plant {} of {}",
                place.plant,
                stage.plants.len()
            )));
        }
        let is_there = place.position.is_finite() && place.turn_rad.is_finite();
        if !is_there || !place.scale.is_finite() || place.scale <= 0.0 {
            return Err(fault(format!("place {index} is nowhere: {place:?}")));
        }
    }
    Ok(())
}

/// The scene of a stage that holds one tree; its finest level, and its first season: the skeleton is
/// the same in all of them.
///
/// # Errors
/// [`ExportError::Holds`] where there are several trees, and as [`scene`].
pub fn single_tree<'a>(
    stage: &Stage<'a>,
    format: &'static str,
    monitor: &dyn Monitor,
) -> Result<&'a Scene, ExportError> {
    self::stage(stage)?;
    let first = stage.plants.first().and_then(|plant| plant.levels().first());
    let Some(first) = first.filter(|_| stage.is_single()) else {
        let advice = "write its trees one by one, or the whole as glb or usda";
        return Err(ExportError::Holds { format, what: "several trees", advice });
    };
    bare(first.scene, monitor)?;
    Ok(first.scene)
}

/// The trees of a stage, each checked once, in their finest level and first season.
///
/// # Errors
/// As [`stage`](self::stage()) and [`scene`](self::scene()).
pub fn trees<'s, 'a>(
    stage: &'s Stage<'a>,
    monitor: &dyn Monitor,
) -> Result<Vec<(&'s Place, &'a Scene)>, ExportError> {
    self::stage(stage)?;
    for level in stage.plants.iter().filter_map(|plant| plant.levels().first()) {
        bare(level.scene, monitor)?;
    }
    Ok(stage.finest().collect())
}

fn is_line(text: &str) -> bool {
    text.bytes().all(|byte| (b' '..=b'~').contains(&byte))
}

/// Checks every number and index of a scene. Gives the box around each part on the way: smallest and
/// largest of the stored coordinates, exactly.
///
/// # Errors
/// [`ExportError::Scene`] and [`ExportError::Cancelled`].
pub fn scene(scene: &Scene, monitor: &dyn Monitor) -> Result<Vec<Bounds>, ExportError> {
    if scene.parts.is_empty() {
        let problem = "it has no parts".to_owned();
        return Err(ExportError::Scene { what: "the scene".to_owned(), problem });
    }
    bare(scene, monitor)
}

/// As [`scene`], also where nobody wanted a surface.
fn bare(scene: &Scene, monitor: &dyn Monitor) -> Result<Vec<Bounds>, ExportError> {
    let fault =
        |problem: &str| ExportError::Scene { what: "the scene".to_owned(), problem: problem.to_owned() };
    if scene.name.is_empty() || scene.name.chars().any(char::is_control) {
        return Err(fault("its name is empty or holds control characters"));
    }
    if !is_line(&scene.recipe) {
        return Err(fault("its recipe is not one line of printable ASCII"));
    }
    scene.materials.iter().try_for_each(check_material)?;
    check_skeleton(&scene.skeleton)
        .map_err(|problem| ExportError::Scene { what: "the skeleton".to_owned(), problem })?;
    scene.parts.iter().map(|part| check_part(scene, part, monitor)).collect()
}

/// As [`scene`], for what stands around plants.
///
/// # Errors
/// As [`scene`].
pub fn surroundings(
    name: &str,
    mesh: &Mesh,
    material: &Material,
    monitor: &dyn Monitor,
) -> Result<Bounds, ExportError> {
    check_material(material)?;
    check_mesh(mesh, &format!("'{name}'"), monitor)
}

fn check_material(material: &Material) -> Result<(), ExportError> {
    let fault = |problem| ExportError::Scene { what: format!("material '{}'", material.name), problem };
    let numbers = material.base_color.iter().chain([&material.roughness]);
    if let Some(x) = numbers.copied().find(|x| !(0.0..=1.0).contains(x)) {
        return Err(fault(format!("a colour or roughness is {x}, not 0 to 1")));
    }
    if let Some(cutout) = material.cutout.filter(|alpha| !(*alpha > 0.0 && *alpha < 1.0)) {
        return Err(fault(format!("it is cut out at an alpha of {cutout}, not between 0 and 1")));
    }
    for picture in material.pictures() {
        let pixels = u64::from(picture.width()) * u64::from(picture.height());
        if pixels == 0 || pixels.checked_mul(4) != Some(picture.rgba().len() as u64) {
            return Err(fault(format!(
                "a picture of {}×{} has {} bytes",
                picture.width(),
                picture.height(),
                picture.rgba().len()
            )));
        }
    }
    Ok(())
}

fn check_part(scene: &Scene, part: &Part, monitor: &dyn Monitor) -> Result<Bounds, ExportError> {
    let what = format!("part '{}'", part.name);
    if part.material >= scene.materials.len() {
        let problem = format!("it wants material {} of {}", part.material, scene.materials.len());
        return Err(ExportError::Scene { what, problem });
    }
    if let Some(problem) = part.wind.as_ref().and_then(|wind| check_wind(wind, part.mesh.positions.len())) {
        return Err(ExportError::Scene { what, problem });
    }
    check_mesh(&part.mesh, &what, monitor)
}

/// What is wrong with how a part with `count` vertices moves.
fn check_wind(wind: &PartWind, count: usize) -> Option<String> {
    let Some(bones) = &wind.bones else {
        let targets = wind.targets.iter().map(|target| target.offsets.len());
        let axes = wind.hierarchy.as_ref().map(|_| wind.axes.len());
        let mut lengths = [wind.motions.len(), wind.pivots.len()].into_iter().chain(axes).chain(targets);
        if let Some(length) = lengths.find(|length| *length != count) {
            return Some(format!("{count} vertices move in the wind by {length} entries"));
        }
        let all = wind.hierarchy.as_deref()?;
        let is_strange = |(index, axis): (usize, &AxisPivot)| axis.parent as usize > index;
        if all.iter().enumerate().any(is_strange) || wind.axes.iter().any(|axis| *axis as usize >= all.len())
        {
            return Some(
                "the axes that it moves with are not there, or not in the order of parents first".to_owned(),
            );
        }
        return None;
    };
    if wind.bindings.len() != count {
        return Some(format!("{} of {count} vertices are bound to joints", wind.bindings.len()));
    }
    let mut parents = bones.joints.iter().enumerate().map(|(index, joint)| (index, joint.parent));
    let is_strange =
        |(index, parent): (usize, Option<usize>)| parent.map_or(index > 0, |parent| parent >= index);
    if bones.joints.is_empty() || parents.any(is_strange) {
        return Some("its joints are not in the order of parents first".to_owned());
    }
    let is_strange = |binding: &Binding| {
        let sum: u32 = binding.weights.iter().map(|weight| u32::from(*weight)).sum();
        sum != 255 || binding.joints.iter().any(|joint| usize::from(*joint) >= bones.joints.len())
    };
    let at = wind.bindings.iter().position(is_strange)?;
    Some(format!("vertex {at} is bound to a joint that is not there, or not wholly"))
}

fn check_mesh(mesh: &Mesh, what: &str, monitor: &dyn Monitor) -> Result<Bounds, ExportError> {
    let fault = |problem| ExportError::Scene { what: what.to_owned(), problem };
    let count = mesh.positions.len();
    if mesh.normals.len() != count || mesh.uvs.len() != count {
        return Err(fault(format!(
            "{count} positions, {} normals and {} texture coordinates",
            mesh.normals.len(),
            mesh.uvs.len()
        )));
    }
    // OBJ counts from 1 and PLY's indices are signed.
    if count >= i32::MAX as usize {
        return Err(fault(format!(
            "{count} vertices are more than 31 bits can number; lower the resolution"
        )));
    }
    if mesh.triangles.is_empty() {
        return Err(fault("it has no triangles".to_owned()));
    }
    // A number whose exponent is all ones is infinite or none; `|` instead of an early exit lets the
    // compiler do eight at a time.
    let broken = |numbers: &[f32]| numbers.iter().fold(false, |any, x| any | !x.is_finite());
    let numbers_of = [
        ("position", bytemuck::cast_slice::<_, f32>(&mesh.positions), 3),
        ("normal", bytemuck::cast_slice(&mesh.normals), 3),
        ("texture coordinate", bytemuck::cast_slice(&mesh.uvs), 2),
    ];
    for (what, numbers, width) in numbers_of {
        monitor.check()?;
        if numbers.par_chunks(CHUNK).any(broken) {
            let at = numbers.iter().position(|x| !x.is_finite()).unwrap_or_default();
            return Err(fault(format!("a {what} is {} (vertex {})", numbers[at], at / width)));
        }
    }
    monitor.check()?;
    let largest =
        mesh.triangles.par_chunks(CHUNK).map(|t| t.iter().flatten().fold(0, |a, &b| a.max(b))).max();
    if let Some(index) = largest.filter(|&index| index as usize >= count) {
        return Err(fault(format!("a triangle names vertex {index} of {count}")));
    }
    monitor.check()?;
    mesh.positions
        .par_chunks(CHUNK)
        .filter_map(|chunk| Bounds::of(chunk.iter().copied()))
        .reduce_with(Bounds::union)
        .ok_or_else(|| fault("it has no vertices".to_owned()))
}

fn check_skeleton(skeleton: &Skeleton) -> Result<(), String> {
    let count = skeleton.positions.len();
    if [skeleton.parents.len(), skeleton.radii.len(), skeleton.births.len()] != [count; 3] {
        return Err("its arrays differ in length".to_owned());
    }
    if let Some(node) =
        (0..count).find(|&i| !skeleton.positions[i].is_finite() || !skeleton.radii[i].is_finite())
    {
        return Err(format!("the position or radius of node {node} is not finite"));
    }
    let strange = |&node: &u32| node != NO_PARENT && node as usize >= count;
    let axes_end = |axis: &linden_pipeline::skeleton::Axis| u64::from(axis.first) + u64::from(axis.len);
    if skeleton.parents.iter().any(strange)
        || skeleton.axes.iter().any(|axis| strange(&axis.parent))
        || skeleton.axes.iter().any(|axis| axes_end(axis) > skeleton.axis_nodes.len() as u64)
        || skeleton.axis_nodes.iter().any(|&node| node as usize >= count)
    {
        return Err(format!("it names a node beyond its {count}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Vec2, Vec3};
    use linden_pipeline::foliage::DressedOrgans;
    use linden_pipeline::picture::Picture;
    use linden_pipeline::scene::{Material, Mesh};

    use super::*;
    use crate::{Bundle, Options, REGISTRY, bundle::test_output::Output};

    fn scene() -> Scene {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            triangles: vec![[0, 1, 2]],
        };
        let picture = Some(Arc::new(Picture::new(1, 1, vec![255; 4])));
        Scene {
            name: "leaflet".to_owned(),
            recipe: "{}".to_owned(),
            materials: vec![Material {
                name: "bark".to_owned(),
                base_color: [0.5; 3],
                base_color_picture: picture.clone(),
                normal_picture: picture,
                roughness: 1.0,
                double_sided: false,
                cutout: None,
                wrap: linden_pipeline::scene::Wrap::Repeat,
                translucency: None,
                passing_picture: None,
            }],
            parts: vec![Part::new("wood", 0, mesh)],
            skeleton: Arc::new(Skeleton {
                positions: vec![Vec3::ZERO, Vec3::Y],
                parents: vec![NO_PARENT, 0],
                radii: vec![0.1; 2],
                births: vec![0, 1],
                axes: vec![linden_pipeline::skeleton::Axis { order: 0, parent: NO_PARENT, first: 0, len: 2 }],
                axis_nodes: vec![0, 1],
                ..Skeleton::default()
            }),
            organs: DressedOrgans::default(),
            foot_in_file: None,
        }
    }

    type Break = (&'static str, fn(&mut Scene));

    #[test]
    fn every_format_refuses_every_broken_scene_before_writing() {
        let breakages: [Break; 16] = [
            ("cut out at an alpha of 1", |s| s.materials[0].cutout = Some(1.0)),
            ("part 'wood': a position is NaN (vertex 1)", |s| s.parts[0].mesh.positions[1].y = f32::NAN),
            ("part 'wood': a normal is inf (vertex 2)", |s| s.parts[0].mesh.normals[2].x = f32::INFINITY),
            ("a texture coordinate is -inf (vertex 0)", |s| s.parts[0].mesh.uvs[0].y = f32::NEG_INFINITY),
            ("names vertex 3 of 3", |s| s.parts[0].mesh.triangles[0][1] = 3),
            ("3 positions, 3 normals and 2 texture", |s| s.parts[0].mesh.uvs.truncate(2)),
            ("no triangles", |s| s.parts[0].mesh.triangles.clear()),
            ("material 1 of 1", |s| s.parts[0].material = 1),
            ("no parts", |s| s.parts.clear()),
            ("its name", |s| s.name = "a\nb".to_owned()),
            ("its recipe", |s| s.recipe = "{}\nv 0 0 0".to_owned()),
            ("a colour or roughness is NaN", |s| s.materials[0].roughness = f32::NAN),
            ("a picture of 7×1 has 4 bytes", |s| {
                s.materials[0].normal_picture = Some(Arc::new(Picture::new(7, 1, vec![0; 4])));
            }),
            ("the skeleton: the position or radius of node 1", |s| {
                Arc::make_mut(&mut s.skeleton).radii[1] = f32::NAN;
            }),
            ("beyond its 2", |s| Arc::make_mut(&mut s.skeleton).axes[0].len = 3),
            ("differ in length", |s| Arc::make_mut(&mut s.skeleton).births.truncate(1)),
        ];
        for exporter in REGISTRY {
            // The axial tree alone needs none.
            let has_surface = exporter.format().holds.surface;
            let breakages = breakages.into_iter().filter(|(what, _)| has_surface || *what != "no parts");
            for (expected, break_it) in breakages {
                let mut scene = scene();
                break_it(&mut scene);
                let output = Output::default();
                let mut bundle = Bundle::stream("test", output.clone());
                let options = Options::new(exporter.format());
                let said = exporter
                    .write(&Stage::of(&scene), &options, &mut bundle, &linden_pipeline::Quiet)
                    .unwrap_err()
                    .to_string();
                assert!(said.contains(expected), "{}: {said:?} lacks {expected:?}", exporter.format().id);
                assert!(output.bytes().is_empty());
            }
            let mut bundle = Bundle::stream("test", Output::default());
            let scene = scene();
            exporter
                .write(
                    &Stage::of(&scene),
                    &Options::new(exporter.format()),
                    &mut bundle,
                    &linden_pipeline::Quiet,
                )
                .unwrap();
        }
    }

    #[test]
    fn several_trees_are_no_single_one() {
        let scene = scene();
        let mut stage = Stage::of(&scene);
        assert!(single_tree(&stage, "any", &linden_pipeline::Quiet).is_ok());
        stage.places.push(Place { position: Vec3::X, ..Place::origin(0) });
        let said = single_tree(&stage, "any", &linden_pipeline::Quiet).unwrap_err().to_string();
        assert!(said.contains("several trees") && said.contains("glb"), "{said}");
        assert_eq!(trees(&stage, &linden_pipeline::Quiet).unwrap().len(), 2);
    }

    #[test]
    fn bounds_are_the_stored_numbers() {
        let bounds = super::scene(&scene(), &linden_pipeline::Quiet).unwrap();
        assert_eq!(bounds, [Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) }]);
    }
}
