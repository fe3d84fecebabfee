use glam::{Vec2, Vec3};

use super::clusters::NONE;
use super::*;
use crate::detail::drawing::{Canvas, Pixels, Texture, View, draw};
use crate::detail::{Detail, Level, levels, year};
use crate::scene::Scene;
use crate::testing::{Subject, body};
use linden_base::monitor::Quiet;
use linden_pipeline::grow::Grown;

fn subject(id: &str, knobs: &[(&str, &str)]) -> (Subject, Grown) {
    let subject = Subject::builtin(id, knobs);
    let grown = subject.grow();
    (subject, grown)
}

fn dressed(subject: &Subject, grown: &Grown) -> Vec<Level> {
    subject.with(|specimen| levels(specimen, body(grown), &Quiet)).unwrap().levels
}

#[test]
fn pieces_hang_together_and_hold_every_organ_once() {
    for id in ["hazel", "drawn-ash", "abop-bush"] {
        let (subject, grown) = subject(id, &[]);
        let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
        let mut before = usize::MAX;
        for size_m in [0.1, 0.4, 1.5] {
            let detail = Detail { card_m: size_m, ..Detail::full(&subject.dressing.tubes) };
            let Pieces { cut, .. } = simplifier.pieces(&detail, &Quiet).unwrap();
            assert_eq!(cut.pieces.len(), simplifier.burden(&detail).count(size_m, &Quiet).unwrap());
            assert!(cut.pieces.len() < before, "{id}: larger pieces are fewer");
            before = cut.pieces.len();
            // A piece is what is below its node, down to the nodes of other pieces.
            for (node, &piece) in cut.piece_of.iter().enumerate() {
                let parent = grown.skeleton.parents[node];
                if piece == NONE || cut.pieces[piece as usize].0 as usize == node {
                    continue;
                }
                assert_eq!(cut.piece_of[parent as usize], piece, "{id}: {node}");
            }
            // Their boxes are no larger than asked for, but for what one node bears.
            let mut boxes =
                vec![(Vec3::INFINITY, Vec3::NEG_INFINITY, std::collections::BTreeSet::new()); before];
            for organ in 0..grown.organs.len() {
                let node = grown.organs.growth(organ).node;
                let piece = cut.piece_of[node as usize];
                assert_ne!(piece, NONE, "{id}: each organ is in one");
                let placed = organ - grown.organs.polygons.ends.len().min(organ);
                if organ < grown.organs.polygons.ends.len() {
                    continue;
                }
                let (low, high, nodes) = &mut boxes[piece as usize];
                let at = grown.organs.placed.positions[placed];
                (*low, *high) = (low.min(at), high.max(at));
                nodes.insert(node);
            }
            for (low, high, nodes) in boxes.iter().filter(|(_, _, nodes)| nodes.len() > 1) {
                assert!(low.distance(*high) <= size_m * 1.5, "{id} {size_m}: {nodes:?}");
            }
        }
    }
}

#[test]
fn what_hangs_is_shown_hanging() {
    let (subject, grown) = subject("weeping-willow", &[]);
    let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
    let detail = simplifier.within(5000, true, &Quiet).unwrap();
    let pieces = simplifier.pieces(&detail, &Quiet).unwrap();
    let deck = Deck::new(&pieces, &grown.skeleton, &grown.organs, (MOST_CARDS, true), &Quiet).unwrap();
    // Which way the leaves of each piece point, in sum.
    let mut sums = vec![Vec3::ZERO; pieces.cut.pieces.len()];
    let placed = &grown.organs.placed;
    for organ in 0..placed.len() {
        let piece = pieces.cut.piece_of[placed.growth.nodes[organ] as usize];
        let size_m = placed.sizes_m[organ];
        sums[piece as usize] += placed.headings[organ] * (size_m * size_m);
    }
    let (mut off, mut hanging) = (0, 0);
    for (piece, sum) in sums.iter().enumerate().filter(|(_, sum)| sum.normalize().y < -0.9) {
        // What its card shows of the piece that stands for it, as it hangs here.
        let card = deck.card_of[piece];
        let model = deck.prototypes[usize::from(card.prototype)] as usize;
        let (here, there) = (&deck.frames[piece], &deck.frames[model]);
        let mut local = there.turned(sums[model].normalize());
        if card.is_mirrored {
            local.x = -local.x;
        }
        let shown = here.side() * local.x + here.heading * local.y + here.up * local.z;
        hanging += 1;
        off += usize::from(shown.dot(sum.normalize()) < 0.7);
    }
    assert!(hanging > 500 && off * 50 < hanging, "{off} of {hanging}");
}

#[test]
fn the_top_of_a_tree_with_a_leader_is_shown_as_it_is() {
    for (id, has_leader) in [("norway-spruce", true), ("drawn-oak", false)] {
        let (subject, grown) = subject(id, &[]);
        let simplifier = Simplifier::new(&subject.dressing.tubes, body(&grown), &Quiet).unwrap();
        let detail = simplifier.within(5000, true, &Quiet).unwrap();
        let pieces = simplifier.pieces(&detail, &Quiet).unwrap();
        let deck = Deck::new(&pieces, &grown.skeleton, &grown.organs, (12, true), &Quiet).unwrap();
        assert!(pieces.cut.pieces.len() > 100 && deck.prototypes.len() <= 12, "{id}");
        // Where the highest leaf is.
        let placed = &grown.organs.placed;
        let highest =
            (0..placed.len()).max_by(|&a, &b| placed.positions[a].y.total_cmp(&placed.positions[b].y));
        let top = pieces.cut.piece_of[placed.growth.nodes[highest.unwrap()] as usize];
        let model = deck.prototypes[usize::from(deck.card_of[top as usize].prototype)];
        assert_eq!(model == top, has_leader, "{id}");
    }
}

#[test]
fn cards_are_lit_as_the_leaves_are_that_they_show() {
    for (id, is_dome) in [("dressed-fir", false), ("hazel", true)] {
        let (subject, grown) = subject(id, &[("triangles", "4000")]);
        assert_eq!(is_mostly_dome(&grown.organs), is_dome, "{id}");
        let scene = &dressed(&subject, &grown)[0].scene;
        let cards = scene.parts.iter().find(|part| part.name.contains("branches")).unwrap();
        let Mesh { positions, normals, triangles, .. } = &cards.mesh;
        let straight = triangles.iter().filter(|corners| {
            let [a, b, c] = corners.map(|corner| positions[corner as usize]);
            (b - a).cross(c - a).normalize().dot(normals[corners[0] as usize]) > 0.999
        });
        let share = straight.count() as f32 / triangles.len() as f32;
        assert!(if is_dome { share < 0.2 } else { share == 1.0 }, "{id}: {share}");
    }
}

/// What a scene covers, seen from a side without perspective: each pixel whether anything is there.
fn covered(scene: &Scene, toward: Vec3, low: Vec2, scale: f32, side: u32) -> Vec<bool> {
    let mut canvas = Canvas::new(Pixels::new(side, side));
    let view = View {
        origin: Vec3::ZERO,
        right: Vec3::Y.cross(toward).normalize(),
        up: Vec3::Y,
        toward,
        corner: Vec2::new(low.x, low.y + side as f32 / scale),
        scale,
        relief: 1.0,
        cuts_whole: false,
        first: Pixels::new(0, 0),
        size: Pixels::new(side, side),
    };
    for part in &scene.parts {
        let material = &scene.materials[part.material];
        draw(&mut canvas, &view, &part.mesh, material, Texture::of(material).as_ref(), &Quiet).unwrap();
    }
    canvas.samples.iter().map(|sample| sample.near_m > f32::NEG_INFINITY).collect()
}

#[test]
fn a_tree_of_cards_covers_what_the_tree_covers() {
    // Coarse pixels and open crowns: by chance alone an apple would come to 0.2, as thinned leaves do.
    for (id, budget, least) in [("hazel", "8000", 0.65), ("drawn-apple", "5000", 0.5)] {
        let (whole, grown) = subject(id, &[]);
        let (few, _) = subject(id, &[("triangles", budget)]);
        let (plain, _) = subject(id, &[("triangles", budget), ("branch_cards", "false")]);
        let [whole, few, plain] = [&whole, &few, &plain].map(|subject| dressed(subject, &grown));
        let bounds = linden_base::mesh::Bounds::of(
            whole[0].scene.parts.iter().flat_map(|part| part.mesh.positions.iter().copied()),
        );
        let size_m = bounds.unwrap().size().length();
        let side = 400;
        let scale = side as f32 / size_m;
        let low = Vec2::new(-size_m / 2.0, -0.2 * size_m);
        for degrees in [17.0_f32, 139.0] {
            let (sin, cos) = libm::sincosf(degrees.to_radians());
            let toward = Vec3::new(sin, 0.1, cos).normalize();
            let of = |levels: &[Level]| covered(&levels[0].scene, toward, low, scale, side);
            let (all, some, thinned) = (of(&whole), of(&few), of(&plain));
            let count = |of: &dyn Fn(bool, bool) -> bool, with: &[bool]| {
                all.iter().zip(with).filter(|(a, b)| of(**a, **b)).count() as f64
            };
            let iou = |with: &[bool]| count(&|a, b| a && b, with) / count(&|a, b| a || b, with);
            let share = some.iter().filter(|there| **there).count() as f64 / count(&|a, _| a, &some);
            assert!((0.85..1.15).contains(&share), "{id} {degrees}: {share}");
            assert!(iou(&some) > least, "{id} {degrees}: {}", iou(&some));
            assert!(iou(&some) > iou(&thinned) + 0.1, "{id}: {} {}", iou(&some), iou(&thinned));
        }
    }
}

#[test]
fn levels_share_one_picture_and_each_card_shows_a_part_of_its_own() {
    let (subject, grown) =
        subject("drawn-ash", &[("triangles", "20000"), ("lods", "3"), ("card_size", "512")]);
    let levels = dressed(&subject, &grown);
    let pictures: Vec<_> = levels
        .iter()
        .map(|level| {
            let material = level.scene.materials.iter().find(|material| material.name == "branches").unwrap();
            material.base_color_picture.clone().unwrap()
        })
        .collect();
    assert!(pictures.iter().all(|picture| Arc::ptr_eq(picture, &pictures[0])));
    assert_eq!([pictures[0].width(), pictures[0].height()], [512; 2]);
    let mut rectangles = std::collections::BTreeSet::new();
    for level in &levels {
        let part = level.scene.parts.iter().find(|part| part.name == "branches").unwrap();
        assert!(part.mesh.uvs.iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0));
        for corners in part.mesh.uvs.chunks(4) {
            let pixel = |uv: Vec2| [(uv.x * 512.0).round() as i32, (uv.y * 512.0).round() as i32];
            rectangles.insert([pixel(corners[0]), pixel(corners[2])]);
        }
    }
    let rectangles: Vec<_> = rectangles.into_iter().collect();
    assert!(rectangles.len() > 40, "{}", rectangles.len());
    for (i, [a, b]) in rectangles.iter().enumerate() {
        for [c, d] in &rectangles[..i] {
            let apart = b[0] <= c[0] || d[0] <= a[0] || b[1] <= c[1] || d[1] <= a[1];
            assert!(apart, "{a:?} {b:?} and {c:?} {d:?}");
        }
    }
    // The organs stay those of the tree.
    assert!(levels.iter().all(|level| level.scene.organs.len() == grown.organs.len()));
}

#[test]
fn smaller_copies_of_the_picture_cover_as_much() {
    let (subject, grown) = subject("norway-spruce", &[("triangles", "8000")]);
    let levels = dressed(&subject, &grown);
    let material = levels[0].scene.materials.iter().find(|material| material.name == "branches").unwrap();
    let picture = material.base_color_picture.clone().unwrap();
    let side = picture.width() as usize;
    let alpha: Vec<f32> = picture.rgba().as_chunks::<4>().0.iter().map(|p| f32::from(p[3]) / 255.0).collect();
    // By the definition: the mean of squares, cut at one half.
    let share = |square: usize| {
        let n = side / square;
        let kept = (0..n * n).filter(|i| {
            let at = |k: usize| alpha[(i / n * square + k / square) * side + i % n * square + k % square];
            (0..square * square).map(at).sum::<f32>() >= 0.5 * (square * square) as f32
        });
        kept.count() as f64 / (n * n) as f64
    };
    let whole = share(1);
    assert!(whole > 0.1, "{whole}");
    let mean = [4, 8, 16].map(share).iter().sum::<f64>() / 3.0 / whole;
    assert!((0.8..1.25).contains(&mean), "{mean}");
}

/// Where one leaf is seen, all that passes a leaf passes; it gets less with each one behind, and through wood none does.
#[test]
fn less_light_passes_cards_where_more_leaves_lie_one_behind_another() {
    let picture_of = |knobs: &[(&str, &str)]| {
        let (subject, grown) = subject("drawn-ash", knobs);
        let levels = dressed(&subject, &grown);
        let material = levels[0].scene.materials.iter().find(|material| material.name == "branches").unwrap();
        let shown = material.base_color_picture.clone().unwrap();
        material.passing_picture.clone().map(|passing| {
            assert_eq!([passing.width(), passing.height()], [shown.width(), shown.height()]);
            let pixels = |picture: &linden_base::picture::Picture| picture.rgba().as_chunks::<4>().0.to_vec();
            let seen = pixels(&shown).into_iter().zip(pixels(&passing)).filter(|(color, _)| color[3] >= 128);
            seen.map(|(_, passes)| f64::from(passes[3]) / 255.0).collect::<Vec<_>>()
        })
    };
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let sized = ("triangles", "9000");
    let leaves = picture_of(&[sized]).unwrap();
    let (full, none) =
        (leaves.iter().filter(|x| **x > 0.9).count(), leaves.iter().filter(|x| **x < 0.1).count());
    assert!(full > leaves.len() / 20 && none > leaves.len() / 20, "{full} and {none} of {}", leaves.len());
    // Fewer leaves, more light.
    let few = picture_of(&[sized, ("leaf_keep", "0.3")]).unwrap();
    assert!(mean(&few) > mean(&leaves) + 0.05, "{} {}", mean(&few), mean(&leaves));
    assert!(picture_of(&[sized, ("leaf_translucency", "0")]).is_none());
}

#[test]
fn cards_show_twigs_in_seasons_without_leaves() {
    let (subject, grown) = subject("oak", &[("triangles", "12000")]);
    let seasons = crate::season::Season::parse_list("summer,bare").unwrap();
    let year = subject.with(|specimen| year(specimen, body(&grown), &seasons, &Quiet)).unwrap();
    let cards = |season: usize| {
        let scene = &year.seasons[season].1[0].scene;
        let material = scene.materials.iter().find(|material| material.name == "branches").unwrap();
        (scene.parts.iter().map(|part| part.mesh.triangles.len()).sum::<usize>(), material.base_color)
    };
    let [(summer, green), (winter, brown)] = [cards(0), cards(1)];
    // Where there are no leaves, their triangles are for finer cards.
    assert!([summer, winter].iter().all(|count| (11_400..=12_000).contains(count)), "{summer} {winter}");
    assert!(green[1] > 1.5 * green[0], "{green:?}");
    assert!(brown[1] < 1.2 * brown[0], "{brown:?}");
    // What is seen past the leaves decides which wood stays: past those of summer, in winter too.
    let wood = |season: usize| {
        let scene = &year.seasons[season].1[0].scene;
        let parts = scene.parts.iter().filter(|part| part.name != "branches");
        parts.map(|part| (part.name.clone(), part.mesh.positions.clone())).collect::<Vec<_>>()
    };
    assert!(!wood(0).is_empty());
    assert_eq!(wood(0), wood(1));
}

#[test]
fn a_bare_tree_by_itself_has_cards_of_its_twigs_up_to_its_top() {
    let top_m = |scene: &Scene| {
        let corners = scene.parts.iter().flat_map(|part| &part.mesh.positions);
        corners.map(|at| at.y).fold(0.0, f32::max)
    };
    for season in ["bare", "0.97"] {
        let (subject, grown) = subject("oak", &[("triangles", "4000"), ("season", season)]);
        let levels = dressed(&subject, &grown);
        let scene = &levels[0].scene;
        let material = scene.materials.iter().find(|material| material.name == "branches").unwrap();
        let [red, green, _] = material.base_color;
        assert!(green < 1.2 * red, "{season}: {:?}", material.base_color);
        assert!((3800..=4000).contains(&scene.triangles()), "{season}: {}", scene.triangles());
        let (found, whole) =
            (top_m(scene), grown.skeleton.positions.iter().map(|at| at.y).fold(0.0, f32::max));
        assert!((found / whole - 1.0).abs() < 0.06, "{season}: {found} of {whole} m");
    }
}

/// The length of the outlines in a picture, pixels: edges of pixels along both axes are 4/π of it in the mean.
fn outline_px(alpha: &[bool], side: usize) -> f64 {
    let rows = alpha.chunks_exact(side);
    let across: usize =
        rows.clone().map(|row| row.windows(2).filter(|pair| pair[0] != pair[1]).count()).sum();
    let down: usize =
        rows.clone().zip(rows.skip(1)).map(|(a, b)| a.iter().zip(b).filter(|(a, b)| a != b).count()).sum();
    std::f64::consts::FRAC_PI_4 * (across + down) as f64
}

#[test]
fn sprays_of_needles_have_few_large_cards_with_ragged_outlines() {
    let (subject, grown) = subject("scots-pine", &[("triangles", "10000")]);
    let levels = dressed(&subject, &grown);
    let scene = &levels[0].scene;
    let material = scene.materials.iter().find(|material| material.name == "branches").unwrap();
    let picture = material.base_color_picture.clone().unwrap();
    let side = picture.width() as usize;
    let part = scene.parts.iter().find(|part| part.name == "branches").unwrap();
    let pixel = |uv: Vec2| [(uv.x * side as f32).round() as i32, (uv.y * side as f32).round() as i32];
    let corners = part.mesh.uvs.chunks(4).map(|corners| [pixel(corners[0]), pixel(corners[2])]);
    let cells: std::collections::BTreeSet<_> = corners.collect();
    assert!((24..=34).contains(&cells.len()), "{} cells", cells.len());
    let alpha: Vec<bool> = picture.rgba().as_chunks::<4>().0.iter().map(|pixel| pixel[3] >= 128).collect();
    let of_cell = outline_px(&alpha, side) / cells.len() as f64;
    // 64 cells of blots had 870 each.
    assert!(of_cell > 1700.0, "{of_cell} pixels of outline to a cell");
}
