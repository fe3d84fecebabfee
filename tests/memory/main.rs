//! Forecasts of memory against an allocator that counts: no stage takes more than it asked for, and
//! none asks for absurdly more than it takes.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "--nocapture shows the figures")]

use std::sync::atomic::{AtomicU64, Ordering};

use linden::dress::dress;
use linden::grow::{GrowError, Grown, grow};
use linden::input::read_picture;
use linden::memory::{Bytes, OverMemory, SLACK_BYTES};
use linden::monitor::Holding;
use linden::monitor::Phase;
use linden::picture::{Picture, PictureFormat};
use linden::preset::{Preset, builtin, builtins};
use linden::recipe::{Geometry, Input, Recipe};
use linden::scene::Scene;
use linden::surface::sweep;
use linden::{DVec3, Monitor, Quiet};
use linden_exporters::{Bundle, Options, REGISTRY};
use linden_raster::{Camera, Size, Style, Surface, draw_flat, draw_skeleton, draw_surface};
use linden_tests::presets::recipe;
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Notes the most that was asked for.
#[derive(Default)]
struct Forecasts {
    most: AtomicU64,
    limit: Option<u64>,
}

impl Monitor for Forecasts {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        self.limit.unwrap_or(u64::MAX)
    }

    fn admit(&self, doing: &'static str, bytes: u64, advice: &'static str) -> Result<(), OverMemory> {
        self.most.fetch_max(bytes, Ordering::Relaxed);
        let limit_bytes = self.memory_limit();
        if bytes > limit_bytes {
            return Err(OverMemory { doing, needs_bytes: bytes, limit_bytes, advice });
        }
        Ok(())
    }
}

/// What some work took at its peak beyond what was there before, and what it forecast; `held` bytes of
/// the forecast were there before.
fn measured<T>(held: u64, work: impl FnOnce(&Forecasts) -> T) -> (T, u64, u64) {
    let forecasts = Forecasts::default();
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let done = work(&forecasts);
    let peak = ALLOCATOR.peak_usage().saturating_sub(before) as u64;
    (done, held + peak, forecasts.most.into_inner())
}

/// Above this, careless forecasts show; below, what does not grow with the tree does.
const LARGE_BYTES: u64 = 32 << 20;

fn compare(what: &str, peak: u64, forecast: u64, faults: &mut Vec<String>) {
    let line = format!("{what}: peak {}, forecast {}", Bytes(peak), Bytes(forecast));
    println!("{line}, {:.2}", forecast as f64 / peak as f64);
    let careless = peak > LARGE_BYTES && forecast as f64 > 1.5 * peak as f64;
    if peak > forecast + SLACK_BYTES || careless {
        faults.push(line);
    }
}

/// Of the [`spread`], what is written too: long lists of each kind, and large pictures.
const WRITTEN: [&str; 3] = ["abop-a [", "abop-stochastic [", "simple ["];

fn turned(id: &str, settings: &[(&str, &str)]) -> Recipe {
    let mut recipe = recipe(builtin(id).unwrap());
    for (knob, value) in settings {
        recipe.preset.set(knob, value).unwrap();
    }
    recipe
}

/// Points on a helix about a stem, as a scanner might see them.
fn scan(count: u32) -> Recipe {
    let place = |i: u32| {
        let (t, turn) = (f64::from(i) / f64::from(count), f64::from(i) * 0.1);
        DVec3::new(0.2 * libm::cos(turn), 12.0 * t, 0.2 * libm::sin(turn))
    };
    let rows: Vec<String> = (0..count).map(place).map(|p| format!("{} {} {}", p.x, -p.z, p.y)).collect();
    let text = rows.join("\n");
    let input = Input::read("scan.xyz", text.as_bytes(), &Quiet).unwrap();
    assert!(matches!(&input.geometry, Geometry::Points(cloud) if cloud.positions.len() == count as usize));
    let preset = linden::preset::Preset::of("scan", linden::preset::ScanSettings::of("scan.xyz"));
    Recipe::with_files(preset, [("scan.xyz", input)].into_iter().collect())
}

/// Whole strings are in memory while the turtle draws the last one. The number of shoots doubles.
fn contexts(derivations: u32) -> Recipe {
    let preset = format!(
        "id = \"contexts\"\n[lsystem]\naxiom = \"FA\"\nrules = [\"F < A -> FA[+FA]\"]\n\
         derivations = {derivations}\n[surface]\nsides = 3\n[bark]\nbark_size = 64\n"
    );
    Recipe::new(Preset::from_toml(&preset).unwrap())
}

/// A spread of generators, sizes and surfaces.
fn spread() -> Vec<(String, Recipe)> {
    let all = builtins().iter().map(|builtin| (builtin.id.to_owned(), recipe(builtin)));
    // Plants are large, and many grow alike: every second.
    let (plants, mut all): (Vec<_>, Vec<_>) = all.partition(|(_, recipe)| recipe.preset.group == "Plants");
    all.extend(plants.into_iter().step_by(2));
    let turns: [(&str, &[(&str, &str)]); 12] = [
        ("abop-a", &[("derivations", "8"), ("sides", "3"), ("bark_size", "64")]),
        ("abop-b", &[("derivations", "8"), ("sides", "5")]),
        ("abop-stochastic", &[("derivations", "10"), ("sides", "3"), ("bark_size", "64")]),
        ("abop-e", &[("derivations", "9"), ("bark_size", "64")]),
        ("fir", &[("points", "20000")]),
        ("fir", &[("points", "150000"), ("sides", "4")]),
        ("sphere", &[("points", "400000"), ("influence", "8D"), ("kill", "2D"), ("sides", "3")]),
        ("sphere", &[("points", "300000"), ("influence", "inf"), ("sides", "3")]),
        // Many nodes stand when the second wave's points see them all at once.
        ("sphere", &[("points", "60000"), ("influence", "inf"), ("waves", "2"), ("sides", "3")]),
        ("cypress", &[("points", "100000"), ("kill", "12D"), ("sides", "64")]),
        ("heart", &[("points", "200000")]),
        ("simple", &[("bark_size", "1024"), ("bark", "plated")]),
    ];
    all.extend(turns.map(|(id, settings)| (format!("{id} {settings:?}"), turned(id, settings))));
    let habits = [
        ("points", "20000"),
        ("attraction", "all"),
        ("gravitropism", "0.2 -0.1"),
        ("influence", "8D"),
        ("sides", "3"),
    ];
    all.push(("habits".to_owned(), turned("sphere", &habits)));
    all.push(("contexts".to_owned(), contexts(18)));
    all.push(("scan".to_owned(), scan(400_000)));
    all
}

#[test]
fn no_stage_takes_more_than_it_forecast() {
    let mut faults = Vec::new();
    pictures(&mut faults);
    // Threads, tables and the like are made once.
    let first = turned("fir", &[]);
    dress(&first, &grow(&first, &Quiet).unwrap(), &Quiet).unwrap();

    for (number, (what, recipe)) in spread().into_iter().enumerate() {
        let input = recipe.inputs.bytes();
        let (grown, peak, forecast) = measured(input, |monitor| grow(&recipe, monitor));
        compare(&format!("{what}: growing"), peak, forecast, &mut faults);
        let grown = grown.unwrap();
        // What comes next depends on sizes, surfaces and pictures: of the presets a third shows it.
        if number % 3 != 0 && number < builtins().len() {
            continue;
        }

        let (_, peak, forecast) =
            measured(0, |monitor| sweep(&grown.skeleton, &recipe.preset.dressing.tubes, monitor).unwrap());
        compare(&format!("{what}: sweeping"), peak, forecast, &mut faults);

        let held = input + grown.bytes();
        let (scene, peak, forecast) = measured(held, |monitor| dress(&recipe, &grown, monitor).unwrap());
        compare(&format!("{what}: dressing"), peak, forecast, &mut faults);

        // Drawing depends on sizes alone: of these presets a quarter shows it.
        if number % 12 == 0 || number >= builtins().len() {
            drawing(&what, &grown, &scene, &mut faults);
        }

        let half = grown.skeleton.births.iter().copied().max().unwrap_or(0) / 2;
        let (_, peak, forecast) = measured(grown.skeleton.bytes(), |monitor| {
            grown.skeleton.admit_until(&grown.wood, monitor).unwrap();
            grown.skeleton.until(half, &grown.wood, recipe.preset.wood_key())
        });
        // How many nodes are left is not known before, so that more is asked for than is taken.
        compare(&format!("{what}: until {half}"), peak, forecast.min(peak * 5 / 4), &mut faults);

        if !WRITTEN.iter().any(|start| what.starts_with(start)) {
            continue;
        }
        let target = tempfile::tempdir().unwrap();
        for exporter in REGISTRY {
            let format = exporter.format();
            let turned = [("compress", "meshopt"), ("picture_format", "jpeg"), ("picture_format", "webp")];
            let turned = turned.into_iter().filter(|_| format.id == "glb");
            for setting in [None].into_iter().chain(turned.map(Some)) {
                let scene = drop_pngs(&scene);
                let mut options = Options::new(format);
                if let Some((name, value)) = setting {
                    options.set(name, value).unwrap();
                }
                let (done, peak, forecast) = measured(scene.bytes(), |monitor| {
                    let mut bundle = Bundle::create(&target.path().join("tree.any")).unwrap();
                    exporter.write(&linden::stage::Stage::of(&scene), &options, &mut bundle, monitor)
                });
                done.unwrap();
                compare(&format!("{what}: writing {} {setting:?}", format.id), peak, forecast, &mut faults);
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));

    // What was forecast is refused one byte below, with both figures, and not much is taken before.
    let recipe = turned("abop-a", &[("derivations", "8")]);
    let (_, _, forecast) = measured(0, |monitor| grow(&recipe, monitor).unwrap());
    let limited = Forecasts { limit: Some(forecast - 1), ..Forecasts::default() };
    let refused = grow(&recipe, &limited).map(|_| ()).unwrap_err();
    assert!(matches!(&refused, GrowError::Memory(over) if over.needs_bytes == forecast), "{refused}");
    let exact = Forecasts { limit: Some(forecast), ..Forecasts::default() };
    assert!(grow(&recipe, &exact).is_ok());

    // A limit is kept where the need is unknown before: a tree of a million points within 8 MiB.
    let limit = 8 << 20;
    for recipe in [
        turned("sphere", &[("points", "1000000")]),
        turned("abop-stochastic", &[("derivations", "12")]),
        contexts(20),
        turned("sphere", &[("points", "20000"), ("influence", "inf"), ("kill", "1D"), ("step", "0.004")]),
    ] {
        let before = ALLOCATOR.current_usage();
        ALLOCATOR.reset_peak_usage();
        let limited = Forecasts { limit: Some(limit), ..Forecasts::default() };
        let refused = grow(&recipe, &limited).map(|_| ()).unwrap_err();
        let peak = ALLOCATOR.peak_usage().saturating_sub(before) as u64;
        assert!(refused.to_string().contains("more than the memory limit of 8.00 MiB"), "{refused}");
        assert!(peak <= limit + SLACK_BYTES, "{}: {refused}", Bytes(peak));
    }
}

/// Drawing by strokes, with its surface, and flat.
fn drawing(what: &str, grown: &Grown, scene: &Scene, faults: &mut Vec<String>) {
    let size = Size::new(900, 1200).unwrap();
    let held = grown.bytes() + scene.bytes();
    for draft in [false, true] {
        let style = Style { organs: Some(&grown.organs), draft, ..Style::studio() };
        let (camera, skeleton) = (Camera::default(), &*grown.skeleton);
        let (drawn, peak, forecast) = measured(0, |monitor| {
            draw_skeleton(skeleton, &camera, &style, size, &Holding::new(monitor, held)).map(drop)
        });
        drawn.unwrap();
        compare(&format!("{what}: drawing strokes, {draft}"), held + peak, forecast, faults);
        let (drawn, peak, forecast) = measured(0, |monitor| {
            let surface = Surface::from(scene);
            draw_surface(&surface, &camera, &style, size, &Holding::new(monitor, held)).map(drop)
        });
        drawn.unwrap();
        compare(&format!("{what}: drawing the surface, {draft}"), held + peak, forecast, faults);
    }

    let style = Style { organs: Some(&grown.organs), ..Style::paper() };
    let (drawn, peak, forecast) = measured(0, |monitor| {
        let monitor = Holding::new(monitor, held);
        draw_flat(&grown.skeleton, &Camera::default(), &style, size, &monitor).map(drop)
    });
    drawn.unwrap();
    compare(&format!("{what}: drawing flat"), held + peak, forecast, faults);
}

/// Writing and reading pictures of noise, which no format makes small.
fn pictures(faults: &mut Vec<String>) {
    let (width, height) = (1600, 1200);
    let pixels = u64::from(width * height);
    let noise = |seed: u32| {
        let mixed = seed.wrapping_mul(0x9e37_79b9);
        ((mixed ^ (mixed >> 15)).wrapping_mul(0x85eb_ca6b) >> 24) as u8
    };
    for alpha in [0, 255] {
        let rgba: Vec<u8> = (0..pixels as u32)
            .flat_map(|i| [noise(3 * i), noise(3 * i + 1), noise(3 * i + 2), alpha | noise(!i)])
            .collect();
        let picture = Picture::new(width, height, rgba);
        for format in PictureFormat::ALL {
            let (file, peak, _) = measured(0, |_| picture.preview(format, None).unwrap());
            let forecast = pixels * format.encoding_bytes_per_pixel();
            // What is written as PNG is drawn by the program, and its forecast measured at that.
            if format != PictureFormat::Png {
                compare(&format!("{} of noise, {alpha}: writing", format.name()), peak, forecast, faults);
            }
            read(&format!("{} of noise, {alpha}", format.name()), &file, faults);
        }
    }
    let mut deep = Vec::new();
    let mut encoder = png::Encoder::new(&mut deep, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.write_header().unwrap().write_image_data(&vec![7; 8 * pixels as usize]).unwrap();
    read("PNG of 16 bits", &deep, faults);
}

fn read(what: &str, file: &[u8], faults: &mut Vec<String>) {
    let (found, peak, forecast) = measured(0, |monitor| read_picture("", file, monitor));
    found.unwrap();
    compare(&format!("{what}: reading"), peak, forecast, faults);
}

/// The same scene with pictures that are not compressed yet.
fn drop_pngs(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for material in &mut scene.materials {
        for picture in [&mut material.base_color_picture, &mut material.normal_picture].into_iter().flatten()
        {
            let fresh =
                linden::picture::Picture::new(picture.width(), picture.height(), picture.rgba().to_vec());
            *picture = std::sync::Arc::new(fresh);
        }
    }
    scene
}
