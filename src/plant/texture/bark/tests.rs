use super::*;
use linden_base::color::decode;
use linden_base::color::{encode, luminance};
use linden_base::monitor::{Phase, Quiet};

fn pictures(style: BarkStyle, size_px: u32) -> BarkPictures {
    Bark { size_px, ..Bark::new(style, Key::new(11).named("bark")) }.draw(&Quiet).unwrap()
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [i32; 3] {
    let n = picture.width();
    let at = (((y % n) * n + x % n) * 4) as usize;
    [picture.rgba()[at], picture.rgba()[at + 1], picture.rgba()[at + 2]].map(i32::from)
}

/// Mean difference between a row and the next, or a column and the next, over all channels.
fn step(picture: &Picture, after: u32, by_row: bool) -> f64 {
    let n = picture.width();
    let at = |along: u32, across: u32| {
        if by_row { pixel(picture, along, across) } else { pixel(picture, across, along) }
    };
    let sum: i32 =
        (0..n).flat_map(|i| at(i, after).into_iter().zip(at(i, after + 1))).map(|(a, b)| (a - b).abs()).sum();
    f64::from(sum) / f64::from(3 * n)
}

#[test]
fn pictures_continue_across_their_edges() {
    const KEYS: u64 = 8;
    for (name, style, _) in BarkStyle::ALL {
        let mut ratios = [0.0; 4];
        for seed in 0..KEYS {
            let bark = Bark { size_px: 128, ..Bark::new(style, Key::new(seed)) };
            let BarkPictures { base_color, normal } = bark.draw(&Quiet).unwrap();
            let cases = [(&base_color, true), (&base_color, false), (&normal, true), (&normal, false)];
            for ((picture, by_row), ratio) in cases.into_iter().zip(&mut ratios) {
                let inside: Vec<f64> = (0..127).map(|i| step(picture, i, by_row)).collect();
                let (seam, most) = (step(picture, 127, by_row), inside.iter().copied().fold(0.0, f64::max));
                assert!(seam < 1.25 * most, "{name} {seed}: {seam}, inside at most {most}");
                *ratio += seam / (inside.iter().sum::<f64>() / 127.0) / KEYS as f64;
            }
        }
        // One seam may run along a furrow; on the whole they are like any other place.
        assert!(ratios.iter().all(|r| (0.65..1.35).contains(r)), "{name}: {ratios:?}");
    }
}

#[test]
fn normals_are_unit_and_point_out() {
    for (name, style, _) in BarkStyle::ALL {
        for p in pictures(style, 128).normal.rgba().chunks_exact(4) {
            let [x, y, z] = [p[0], p[1], p[2]].map(|c| f64::from(c) / 127.5 - 1.0);
            let length = libm::sqrt(x * x + y * y + z * z);
            assert!((length - 1.0).abs() < 0.012 && z > 0.0 && p[3] == 255, "{name}: {x} {y} {z}");
        }
    }
}

#[test]
fn green_points_up_the_slope_that_faces_up() {
    // A bump in the middle: its upper side (smaller rows) faces up, its right side faces right.
    let n = 33;
    let spots: Vec<Spot> = (0..n * n)
        .map(|i| {
            let (x, y) = ((i % n) as f32 / n as f32 - 0.5, (i / n) as f32 / n as f32 - 0.5);
            Spot { height: (1.0 - 6.0 * (x * x + y * y)).max(0.0), tint: Vec3::ONE }
        })
        .collect();
    let rgba = normals(|row, column| spots[row * n + column].height, (n, n), 0.2);
    let at = |x: usize, y: usize| [rgba[(y * n + x) * 4], rgba[(y * n + x) * 4 + 1]];
    assert!(at(16, 10)[1] > 140 && at(16, 22)[1] < 116, "{:?} {:?}", at(16, 10), at(16, 22));
    assert!(at(22, 16)[0] > 140 && at(10, 16)[0] < 116);
    // The top lies between two places: all but flat.
    assert!(at(16, 16).iter().all(|c| c.abs_diff(128) < 8));
}

#[test]
fn the_mean_is_the_colour_asked_for() {
    for (name, style, _) in BarkStyle::ALL {
        for color in [[112, 98, 84], [60, 40, 30], [200, 196, 190], [0, 0, 0], [90, 20, 120]] {
            let bark = Bark { color, size_px: 128, ..Bark::new(style, Key::new(2)) };
            let picture = bark.draw(&Quiet).unwrap().base_color;
            for c in 0..3 {
                let mean =
                    picture.rgba().chunks_exact(4).map(|p| decode(f32::from(p[c]) / 255.0)).sum::<f32>()
                        / (128.0 * 128.0);
                let found = encode(mean) * 255.0;
                assert!((found - f32::from(color[c])).abs() < 2.0, "{name} {color:?}: {found}");
            }
        }
    }
}

#[test]
fn ridges_run_up_and_lenticels_across() {
    // The structure function: how fast the colour changes along V and along U.
    let ratio = |style| {
        let picture = pictures(style, 256).base_color;
        let mean = |by_row| (0..256).map(|i| step(&picture, i, by_row)).sum::<f64>();
        mean(true) / mean(false)
    };
    assert!(ratio(BarkStyle::Ridged) < 0.8, "{}", ratio(BarkStyle::Ridged));
    assert!(ratio(BarkStyle::Smooth) > 1.3, "{}", ratio(BarkStyle::Smooth));
}

#[test]
fn furrows_are_darker_than_ridges() {
    for style in [BarkStyle::Ridged, BarkStyle::Plated, BarkStyle::Palm] {
        let surface = Surface::new(style, 1.0, Key::new(4));
        let mut spots = vec![Spot::default(); 64 * 64];
        for (i, row) in spots.chunks_exact_mut(64).enumerate() {
            surface.row(i as f32 / 64.0, row);
        }
        spots.sort_by(|a, b| a.height.total_cmp(&b.height));
        let light = |of: &[Spot]| of.iter().map(|s| s.tint.y).sum::<f32>() / of.len() as f32;
        let (low, high) = (light(&spots[..400]), light(&spots[3600..]));
        assert!(low < 0.5 * high, "{style:?}: {low} {high}");
    }
}

/// From afar a trunk shows the mean light of each row of its bark, one picture above the other.
#[test]
fn a_trunk_has_no_rings_of_light_and_dark() {
    const SIDE: usize = 128;
    let ring = |light: &[f32], wave: usize| {
        let mean = light.iter().sum::<f32>() / SIDE as f32;
        let part = |wave_at: fn(f32) -> f32| {
            let at = |i: usize| wave_at(std::f32::consts::TAU * wave as f32 * i as f32 / SIDE as f32);
            (0..SIDE).map(|i| light[i] * at(i)).sum::<f32>() * 2.0 / SIDE as f32
        };
        libm::hypotf(part(libm::cosf), part(libm::sinf)) / mean
    };
    let most = |light: Vec<f32>| (1..=3).map(|wave| ring(&light, wave)).fold(0.0, f32::max);
    for (name, style, _) in BarkStyle::ALL {
        let mut drawn_before = 0.0_f32;
        for seed in 0..6 {
            let bark = Bark { size_px: SIDE as u32, lenticels: 0.5, ..Bark::new(style, Key::new(seed)) };
            let surface = Surface::new(style, 1.0, bark.key);
            let mut spots = [Spot::default(); SIDE];
            let mut row = |i: usize| {
                surface.row(i as f32 / SIDE as f32, &mut spots);
                spots.iter().map(|spot| luminance(spot.tint.to_array())).sum()
            };
            drawn_before = drawn_before.max(most((0..SIDE).map(&mut row).collect()));
            let picture = bark.draw(&Quiet).unwrap().base_color;
            let light = |row: &[u8]| {
                row.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| luminance(linear([r, g, b]))).sum()
            };
            let found = most(picture.rgba().chunks_exact(4 * SIDE).map(light).collect());
            assert!(found < 0.03, "{name} {seed}: {found}");
        }
        // Culms have none, and the rows of palms are finer.
        let had_some = !matches!(style, BarkStyle::Culm | BarkStyle::Palm);
        assert!(!had_some || drawn_before > 0.05, "{name}: {drawn_before}");
    }
}

/// Who asks for more pixels sees more than the same spots larger.
#[test]
fn a_large_picture_has_finer_grain() {
    for (name, style, _) in BarkStyle::ALL {
        let rough = |size_px: u32| {
            let surface = Surface::new(style, 1.0, Key::new(3)).fine(size_px, Key::new(3));
            let mut spots = vec![Spot::default(); 2048];
            surface.row(0.4, &mut spots);
            let bent = |three: &[Spot]| (2.0 * three[1].tint - three[0].tint - three[2].tint).length();
            spots.windows(3).map(bent).sum::<f32>()
        };
        assert_eq!(rough(16).to_bits(), rough(512).to_bits(), "{name}");
        assert!(rough(1024) > 1.05 * rough(512), "{name}: {} {}", rough(1024), rough(512));
        assert!(rough(2048) > 1.05 * rough(1024), "{name}: {} {}", rough(2048), rough(1024));
    }
}

/// Each base stands out towards its upper end, above the foot of those behind it.
#[test]
fn bases_of_leaves_overlap_like_shingles() {
    const SIDE: usize = 240;
    let surface = Surface::new(BarkStyle::Palm, 0.0, Key::new(6));
    let mut rows = vec![vec![Spot::default(); SIDE]; SIDE];
    for (i, row) in rows.iter_mut().enumerate() {
        surface.row(i as f32 / SIDE as f32, row);
    }
    // Going up it rises slowly and falls off fast: more of the way leads up.
    let steps = || (0..SIDE).flat_map(|x| (1..SIDE).map(move |y| (x, y)));
    let rise = |(x, y): (usize, usize)| rows[y][x].height - rows[y - 1][x].height;
    let up = steps().filter(|&at| rise(at) > 0.0).count() as f64;
    let share = up / steps().count() as f64;
    assert!(share > 0.6, "{share}");
}

#[test]
fn the_same_bytes_from_the_same_key_only() {
    let draw =
        |seed| Bark { size_px: 64, ..Bark::new(BarkStyle::Ridged, Key::new(seed)) }.draw(&Quiet).unwrap();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| draw(1));
    assert_eq!(draw(1), alone);
    assert_ne!(draw(1), draw(2));
}

#[test]
fn the_picture_is_the_same_at_any_size() {
    // A pixel of a small picture is near the mean of those of the large one that it covers.
    let (small, large) =
        (pictures(BarkStyle::Smooth, 32).base_color, pictures(BarkStyle::Smooth, 256).base_color);
    let mut sum = 0;
    for y in 0..32 {
        for x in 0..32 {
            let mean = (0..64).map(|i| pixel(&large, x * 8 + i % 8, y * 8 + i / 8)[1]).sum::<i32>() / 64;
            sum += (mean - pixel(&small, x, y)[1]).abs();
        }
    }
    assert!(sum / 1024 < 8, "{}", sum / 1024);
}

#[test]
fn odd_wishes_are_met_or_refused() {
    let bark = Bark::new(BarkStyle::Plated, Key::new(1));
    for size_px in [0, Bark::MAX_SIZE_PX + 1, u32::MAX] {
        assert_eq!(Bark { size_px, ..bark }.draw(&Quiet), Err(BarkError::Size(size_px)));
    }
    for size_px in [1, 2, 7] {
        let drawn =
            Bark { size_px, relief: f32::NAN, roughness: f32::INFINITY, ..bark }.draw(&Quiet).unwrap();
        assert_eq!(drawn.normal.rgba().len(), (size_px * size_px * 4) as usize);
    }
}

#[test]
fn a_cancelled_monitor_stops_the_work() {
    struct Stop;
    impl Monitor for Stop {
        fn is_cancelled(&self) -> bool {
            true
        }
        fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}
    }
    assert_eq!(Bark::new(BarkStyle::Smooth, Key::new(1)).draw(&Stop), Err(BarkError::Cancelled(Cancelled)));
}
