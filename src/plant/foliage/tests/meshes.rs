//! The forms of leaves and what they come to as meshes.

use super::*;

const FORMS: [&str; 6] = ["card", "cross", "curved", "twig", "fan", "tuft"];

#[test]
fn every_form_is_a_sound_mesh_of_one_unit() {
    let tree = twigs(1, 1);
    for form in FORMS {
        for outline in ["ovate", "lobed", "palmate", "pine", "blossom"] {
            let subject =
                recipe(&format!("leaf_form = \"{form}\"\nleaf_outline = \"{outline}\"\nleaf_size = 64"));
            let organs = grown(&subject, &tree);
            assert_eq!(organs.shapes.len(), 4, "{form}");
            for shape in organs.shapes.iter() {
                for mesh in [&shape.mesh, &shape.sketch] {
                    assert!(!mesh.triangles.is_empty(), "{form}");
                    for triangle in &mesh.triangles {
                        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
                        let normal = (b - a).cross(c - a);
                        assert!(normal.length() > 1e-7, "{form} {outline}: a triangle without area");
                        for &v in triangle {
                            assert!(
                                mesh.normals[v as usize].dot(normal) > 0.0,
                                "{form}: winding and normals"
                            );
                        }
                    }
                    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{form}");
                    let outside = mesh.uvs.iter().find(|uv| uv.min_element() < 0.0 || uv.max_element() > 1.0);
                    assert!(outside.is_none(), "{form} {outline}: {outside:?}");
                }
                let bounds = shape.mesh.bounds().unwrap();
                assert!((0.7..1.2).contains(&bounds.max.y), "{form} {outline}: {bounds:?}");
                assert!(bounds.min.y > -0.6, "{form} {outline}: {bounds:?}");
            }
        }
    }
}

/// Mean of triangles' areas times normals tells which side is up.
#[test]
fn blades_show_their_upper_side() {
    let tree = twigs(1, 1);
    for form in ["card", "curved", "twig", "fan"] {
        let organs = grown(&recipe(&format!("leaf_form = \"{form}\"")), &tree);
        let mesh = &organs.shapes[0].mesh;
        let sum: Vec3 = mesh.normals.iter().copied().sum();
        assert!(sum.normalize().z > 0.7, "{form}");
    }
}

#[test]
fn meshes_hold_every_leaf_where_it_is() {
    let tree = bent(1);
    let subject = recipe(
        "leaf_form = \"curved\"\nleaf_jitter = 40\nleaves_per_m = 3000\n[[foliage.also]]\nleaf_form = \"fan\"\nshare = 0.3",
    );
    let organs = grown(&subject, &tree);
    assert!(organs.len() > 4096, "several tasks");
    let all = meshes(&organs, 1, &Quiet).unwrap();
    assert_eq!(all.iter().map(|foliage| foliage.look).collect::<Vec<_>>(), [Look::Kind(0), Look::Kind(1)]);
    let (vertices, triangles) = organs.amount();
    assert_eq!(all.iter().map(|foliage| foliage.mesh.positions.len() as u64).sum::<u64>(), vertices);
    assert_eq!(all.iter().map(|foliage| foliage.mesh.triangles.len() as u64).sum::<u64>(), triangles);
    // One after the other, by the definition.
    for foliage in &all {
        let Look::Kind(kind) = foliage.look else { panic!("no grammar here") };
        let (mut at, mut corner) = (0, 0);
        for organ in (0..organs.len()).filter(|&i| usize::from(organs.shape(i).unwrap().kind) == kind) {
            let mesh = organs.mesh(organ);
            for (i, &local) in mesh.positions.iter().enumerate() {
                assert!(foliage.mesh.positions[at + i].distance(organs.place(organ, local)) < 1e-6);
                assert!(foliage.mesh.normals[at + i].distance(organs.turn(organ, mesh.normals[i])) < 1e-5);
                assert_eq!(foliage.mesh.uvs[at + i], mesh.uvs[i]);
            }
            for triangle in &mesh.triangles {
                assert_eq!(foliage.mesh.triangles[corner], triangle.map(|v| v + at as u32));
                corner += 1;
            }
            at += mesh.positions.len();
        }
        assert_eq!((at, corner), (foliage.mesh.positions.len(), foliage.mesh.triangles.len()));
    }
}

#[test]
fn instances_expand_to_what_is_baked() {
    let tree = twigs(20, 6);
    let mut subject =
        recipe("leaf_form = \"curved\"\nleaf_jitter = 40\nleaf_size_spread = 0.4\nleaf_up = -0.3");
    subject.recipe.preset.set_seed(5);
    let organs = grown(&subject, &tree);
    let baked = &meshes(&organs, 1, &Quiet).unwrap()[0];
    let dressed = DressedOrgans::new(Arc::clone(&organs), Arc::clone(&organs.shapes), Vec::new(), &[]);
    let instances = Instances::of(&dressed, baked.look);
    let copies = instances.copies();
    assert_eq!(copies.len(), organs.shapes.len());
    assert!(copies.len() > 1 && !instances.has_dome_normals());
    // Each variant's leaves in their order, as the baked ones are in that of all.
    let mut next = vec![0; copies.len()];
    let (mut vertex, mut triangle) = (0, 0);
    for &prototype in &organs.placed.prototypes {
        let variant = usize::from(prototype) - PROTOTYPES.len();
        let Copies { mesh, placements, .. } = &copies[variant];
        let placement = placements[next[variant]];
        next[variant] += 1;
        for (i, (&point, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
            let at = vertex + i;
            assert!(placement.point(point).distance(baked.mesh.positions[at]) < 2e-5);
            assert!((placement.rotation * normal).distance(baked.mesh.normals[at]) < 2e-6);
            assert_eq!(mesh.uvs[i], baked.mesh.uvs[at]);
        }
        for corners in &mesh.triangles {
            assert_eq!(corners.map(|v| v + vertex as u32), baked.mesh.triangles[triangle]);
            triangle += 1;
        }
        vertex += mesh.positions.len();
    }
    assert_eq!(vertex, baked.mesh.positions.len());
    assert!(copies.iter().zip(next).all(|(mesh_copies, count)| mesh_copies.placements.len() == count));
    let names: BTreeSet<&str> = copies.iter().map(|mesh_copies| mesh_copies.name.as_str()).collect();
    assert_eq!(names.len(), copies.len());
}

#[test]
fn dome_normals_and_the_fronts_of_leaves_point_out_of_the_crown() {
    let tree = twigs(300, 6);
    let subject = recipe("leaf_form = \"card\"\nleaf_jitter = 90\nleaf_normals = \"dome\"");
    let organs = grown(&subject, &tree);
    let mesh = &meshes(&organs, 1, &Quiet).unwrap()[0].mesh;
    let bounds = linden_base::mesh::Bounds::of(organs.placed.positions.iter().copied()).unwrap();
    let center = bounds.min.midpoint(bounds.max);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let face = (b - a).cross(c - a).normalize();
        let out = (a - center).normalize();
        let normal = mesh.normals[triangle[0] as usize];
        // Renderers turn the normals of backs round: what is seen from outside are fronts.
        assert!((normal.length() - 1.0).abs() < 1e-5 && normal.dot(out) > 0.5, "{}", normal.dot(out));
        assert!(face.dot(normal) > 0.0 && face.dot(out) > -0.3, "{face} {normal} {out}");
    }
}
