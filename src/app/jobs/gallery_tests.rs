use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use glam::Vec2;
use linden::Quiet;
use linden::Skeleton;
use linden::monitor::Phase;
use linden_raster::extent::RINGS;
use linden_raster::{Paint, draw_skeleton};
use linden_terminal::{CellStyle, ColorDepth, Glyphs, Image};

use super::super::{Done, Lane, grow_shown};
use super::*;

const CELLS: (u16, u16) = (20, 10);

fn base(id: &str, set: &[(&str, &str)]) -> Arc<Recipe> {
    let mut preset = linden::preset::builtin(id).unwrap().load().unwrap();
    for (name, text) in set {
        preset.set(name, text).unwrap();
    }
    Arc::new(Recipe::new(preset))
}

fn request(base: Arc<Recipe>, knob: &'static str, values: Vec<Value>) -> GalleryRequest {
    GalleryRequest {
        base,
        knob,
        values,
        known: None,
        camera: Camera::orbit(20.0, 10.0),
        look: PictureLook::Skeleton(Paint::Wood),
        one_scale: false,
        cells: CELLS,
        medium: Medium {
            graphics: None,
            glyphs: Glyphs::Quadrants,
            colors: ColorDepth::True,
            background: [16, 16, 18],
            dark: true,
            cell_px: (10, 20),
            remote: false,
            landscape: false,
        },
    }
}

fn seeds(seeds: std::ops::Range<u64>) -> Vec<Value> {
    seeds.map(Value::Integer).collect()
}

fn painted(request: GalleryRequest) -> Vec<Thumbnail> {
    let given = RefCell::new(Vec::new());
    paint_gallery(request, &Quiet, &|thumbnail| given.borrow_mut().push(thumbnail));
    given.into_inner()
}

/// The last that was given for each index.
fn last(given: Vec<Thumbnail>) -> Vec<Result<SmallPicture, String>> {
    let mut results: Vec<Option<Result<SmallPicture, String>>> = Vec::new();
    for thumbnail in given {
        if results.len() <= thumbnail.index {
            results.resize_with(thumbnail.index + 1, || None);
        }
        results[thumbnail.index] = Some(thumbnail.result);
    }
    results.into_iter().map(Option::unwrap).collect()
}

fn skeleton_with(base: &Recipe, knob: &str, text: &str) -> Arc<Skeleton> {
    let mut recipe = base.clone();
    recipe.preset.set(knob, text).unwrap();
    grow(&recipe, &Quiet).unwrap().skeleton
}

/// The picture by the shortest way.
fn direct(skeleton: &Skeleton, frame: Extent) -> CellPicture {
    let camera = Camera { extent: Some(frame), ..Camera::orbit(20.0, 10.0) };
    // Two columns of parts a cell, and square: cells are twice as high as wide.
    let size = Size::new(40, 40).unwrap();
    let picture = draw_skeleton(skeleton, &camera, &Style::over_dark(), size, &Quiet).unwrap();
    let image = Image::new(40, 40, picture.rgba()).unwrap();
    CellPicture::draw(&image, CELLS.0, CELLS.1, &CellStyle::default(), usize::MAX)
}

#[test]
fn each_picture_is_what_its_recipe_gives_and_seeds_differ() {
    let base = base("fir", &[("points", "250")]);
    let given = painted(request(Arc::clone(&base), "seed", seeds(3..6)));
    assert_eq!(
        given.iter().map(|picture| picture.index).collect::<Vec<_>>(),
        [0, 1, 2],
        "in order, once each"
    );
    let pictures: Vec<_> = last(given).into_iter().map(Result::unwrap).collect();
    for (picture, seed) in pictures.iter().zip(3..) {
        let skeleton = skeleton_with(&base, "seed", &format!("{seed}"));
        assert_eq!(picture.cells, direct(&skeleton, Extent::of(&skeleton, &[]).unwrap()), "seed {seed}");
        assert_eq!(picture.nodes, skeleton.positions.len());
        let heights = skeleton.positions.iter().map(|p| f64::from(p.y));
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(y), high.max(y)));
        assert!((picture.size.height_m - (high - low)).abs() < 1e-4);
    }
    assert_ne!(pictures[0].cells, pictures[1].cells);
    assert_ne!(pictures[1].cells, pictures[2].cells);
}

#[test]
fn in_one_scale_all_end_in_the_frame_of_all() {
    let base = base("abop-a", &[("derivations", "3")]);
    let lengths = ["0.1", "0.2", "0.4"];
    let values = lengths.iter().map(|text| Value::Real(text.parse().unwrap())).collect();
    let request = GalleryRequest { one_scale: true, ..request(Arc::clone(&base), "segment_length", values) };
    let given = painted(request);
    // The largest comes last, so those before it are drawn again, in order, and it is not.
    assert_eq!(given.iter().map(|picture| picture.index).collect::<Vec<_>>(), [0, 1, 2, 0, 1]);
    let skeletons = lengths.map(|text| skeleton_with(&base, "segment_length", text));
    let extents: Vec<_> = skeletons.iter().map(|skeleton| Extent::of(skeleton, &[]).unwrap()).collect();
    let frame = around(&extents);
    for (result, skeleton) in last(given).into_iter().zip(&skeletons) {
        assert_eq!(result.unwrap().cells, direct(skeleton, frame));
    }
    // The smallest tree is as small as it is: a quarter of the largest.
    let rows = |skeleton: &Skeleton| {
        let picture = direct(skeleton, frame);
        let is_drawn =
            |row: &[linden_terminal::cells::PictureCell]| row.iter().any(|cell| cell.character != ' ');
        picture.cells().chunks(usize::from(CELLS.0)).filter(|row| is_drawn(row)).count()
    };
    assert!(
        rows(&skeletons[0]) * 3 <= rows(&skeletons[2]),
        "{} {}",
        rows(&skeletons[0]),
        rows(&skeletons[2])
    );
}

#[test]
fn the_frame_of_all_holds_every_one_of_them() {
    let mut state = 7_u64;
    let mut random = move |low: f32, high: f32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((state >> 40) as f32 / (1_u64 << 24) as f32)
    };
    for _ in 0..200 {
        let mut extents = Vec::new();
        for _ in 0..4 {
            let bottom = random(-1.0, 1.0);
            let height = if random(0.0, 1.0) < 0.1 { 0.0 } else { random(0.1, 9.0) };
            let mut radii = [0.0; RINGS];
            for radius in &mut radii {
                *radius = random(0.0, 3.0);
            }
            let (x, z) = (random(-1.0, 1.0), random(-1.0, 1.0));
            extents.push(Extent { x, z, bottom, top: bottom + height, radii, person: None });
        }
        let whole = around(&extents);
        for extent in &extents {
            for ring in 0..RINGS {
                // The middle of each ring, at its farthest from the whole's axis.
                let y = extent.bottom + extent.height() * (ring as f32 + 0.5) / RINGS as f32;
                let off = Vec2::new(extent.x - whole.x, extent.z - whole.z).length();
                let there = if whole.height() > 0.0 { (y - whole.bottom) / whole.height() } else { 0.0 };
                assert!((-1e-5..=1.0 + 1e-5).contains(&there));
                let there = ((there * RINGS as f32) as usize).min(RINGS - 1);
                assert!(
                    whole.radii[there] + 1e-4 >= extent.radii[ring] + off,
                    "{whole:?}\n{extent:?} {ring}"
                );
            }
        }
        assert_eq!(around(&extents[..1]), extents[0]);
    }
}

#[test]
fn what_is_too_large_or_cannot_grow_says_so_and_the_others_are_drawn() {
    let values = vec![Value::Integer(2), Value::Integer(60), Value::Integer(3)];
    let results = last(painted(request(base("abop-a", &[]), "derivations", values)));
    assert!(results[0].is_ok() && results[2].is_ok());
    let why = results[1].as_ref().unwrap_err();
    assert!(why.starts_with("too large for a small picture: ") && why.ends_with("symbols"), "{why}");

    let limited = base("abop-a", &[("symbol_limit", "100")]);
    let results = last(painted(request(limited, "derivations", vec![Value::Integer(1), Value::Integer(4)])));
    assert!(results[0].is_ok());
    assert!(results[1].as_ref().unwrap_err().ends_with("over its limit of 100"));

    let fir = base("fir", &[("points", "100")]);
    let values = vec![Value::Steps(3.0), Value::Steps(0.2), Value::Steps(4.0)];
    let results = last(painted(request(fir, "kill", values)));
    assert!(results[0].is_ok() && results[2].is_ok());
    assert!(!results[1].as_ref().unwrap_err().contains(';'), "short: {:?}", results[1]);

    let crowded = vec![Value::Integer(100_000_000)];
    let results = last(painted(request(base("fir", &[]), "points", crowded)));
    assert!(results[0].as_ref().unwrap_err().contains("100000000 points"));
}

#[test]
fn a_surface_is_strokes_first() {
    let base = base("abop-a", &[("derivations", "2")]);
    let row = |look| GalleryRequest { look, ..request(Arc::clone(&base), "angle", vec![Value::Real(20.0)]) };
    let strokes = last(painted(row(PictureLook::Skeleton(Paint::Wood))));
    let mut given = painted(row(PictureLook::Surface)).into_iter();
    let (first, second) = (given.next().unwrap(), given.next().unwrap());
    assert!(given.next().is_none());
    assert_eq!(first.result.unwrap().cells, strokes[0].as_ref().unwrap().cells);
    assert_ne!(second.result.unwrap().cells, strokes[0].as_ref().unwrap().cells);
}

/// Counts what is grown; cancelled when told so.
#[derive(Default)]
struct Counter {
    advances: AtomicUsize,
    is_cancelled: AtomicBool,
}

impl Monitor for Counter {
    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }

    fn advance(&self, stage: Phase, _: u64, _: Option<u64>) {
        if matches!(stage, Phase::Scatter | Phase::Derive | Phase::Turtle | Phase::Grow) {
            self.advances.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[test]
fn what_has_grown_is_not_grown_again() {
    let base = base("fir", &[("points", "250"), ("seed", "4")]);
    let (sender, answers) = mpsc::channel();
    let lane = Lane::start(
        "test",
        move |answer| drop(sender.send(answer)),
        |recipe: Arc<Recipe>, watcher, give| {
            give(grow_shown(&recipe, watcher).unwrap().unwrap());
        },
    )
    .unwrap();
    lane.submit(Arc::clone(&base));
    let known = answers
        .iter()
        .find_map(|answer| if let Done::Value(shown) = answer.done { Some(shown) } else { None });
    assert!(known.is_some());
    let advances = |known: Option<Arc<ShownTree>>, knob, values| {
        let counter = Counter::default();
        let given = RefCell::new(Vec::new());
        let request = GalleryRequest { known, ..request(Arc::clone(&base), knob, values) };
        paint_gallery(request, &counter, &|picture| given.borrow_mut().push(picture.result.unwrap().cells));
        (counter.advances.into_inner(), given.into_inner())
    };
    let (grown, fresh) = advances(None, "seed", seeds(4..5));
    let (none, again) = advances(known.clone(), "seed", seeds(4..5));
    assert!(grown > 0 && none == 0 && fresh == again);
    // Nor what only another surface covers.
    let (none, _) = advances(known.clone(), "sides", vec![Value::Integer(3), Value::Integer(9)]);
    assert_eq!(none, 0);
    let (some, _) = advances(known, "seed", seeds(5..6));
    assert!(some > 0);
}

#[test]
fn nobody_is_given_what_nobody_wants() {
    let counter = Counter::default();
    let given = AtomicUsize::new(0);
    paint_gallery(request(base("fir", &[("points", "100")]), "seed", seeds(0..9)), &counter, &|_| {
        // Three are wanted.
        if given.fetch_add(1, Ordering::Relaxed) == 2 {
            counter.is_cancelled.store(true, Ordering::Relaxed);
        }
    });
    assert_eq!(given.into_inner(), 3);
}

#[test]
fn pictures_of_pixels_come_once_over_a_network_and_cost_no_more_than_one() {
    let base = base("fir", &[("points", "250")]);
    for remote in [false, true] {
        for (look, one_scale) in [(PictureLook::Surface, false), (PictureLook::Skeleton(Paint::Wood), true)] {
            let mut request = request(Arc::clone(&base), "seed", seeds(3..7));
            (request.look, request.one_scale) = (look, one_scale);
            request.medium.graphics = Some(linden_terminal::Protocol::Kitty);
            (request.medium.remote, request.medium.landscape) = (remote, true);
            let given = painted(request);
            let bytes = |thumbnail: &Thumbnail| {
                let picture = thumbnail.result.as_ref().unwrap();
                picture.graphic.as_ref().map(|graphic| graphic.len())
            };
            let sent: Vec<usize> = given.iter().filter_map(bytes).collect();
            assert!(given.len() > 4 || one_scale);
            if remote {
                assert_eq!(sent.len(), 4, "the last of each");
                assert!(sent.iter().sum::<usize>() <= FULL_BYTES);
            } else {
                assert_eq!(sent.len(), given.len());
            }
            assert!(last(given).iter().all(|result| result.as_ref().unwrap().graphic.is_some()));
        }
    }
}
