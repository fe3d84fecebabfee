use super::blade::{Blade, BladeLook};
use super::*;
use linden_base::monitor::{Phase, Quiet};

fn key() -> Key {
    Key::new(3).named("leaf")
}

fn small(outline: Outline) -> LeafLook {
    LeafLook { size_px: 256, ..LeafLook::new(outline) }
}

/// A blade exactly as its numbers say.
fn exact(look: &LeafLook) -> Blade {
    BladeLook { variation: 0.0, ..BladeLook::of(look, look.outline) }.blade(key())
}

fn alpha(pictures: &LeafPictures, x: usize, y: usize) -> u8 {
    let picture = &pictures.base_color;
    picture.rgba()[(y * picture.width() as usize + x) * 4 + 3]
}

/// Turning points of a cyclic sequence that stand out by more than `least`: the maxima.
fn maxima(values: &[f32], least: f32) -> usize {
    let lowest = (0..values.len()).min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap();
    let (mut count, mut low, mut high, mut rising) = (0, values[lowest], values[lowest], true);
    for i in 0..=values.len() {
        let v = values[(lowest + i) % values.len()];
        if rising {
            high = high.max(v);
            if v < high - least {
                (count, rising, low) = (count + 1, false, v);
            }
        } else {
            low = low.min(v);
            if v > low + least {
                (rising, high) = (true, v);
            }
        }
    }
    count
}

#[test]
fn an_ellipse_has_the_area_of_an_ellipse() {
    for (width, petiole) in [(0.5, 0.0), (0.8, 0.0), (0.3, 0.0)] {
        let look = LeafLook {
            width,
            petiole,
            variants: 1,
            size_px: 1024,
            color_spread: 0.0,
            ..LeafLook::new(Outline::Elliptic)
        };
        let blade = exact(&look);
        let shoelace: f32 = (0..blade.outline.len())
            .map(|i| blade.outline[i].perp_dot(blade.outline[(i + 1) % blade.outline.len()]) / 2.0)
            .sum();
        let expected = std::f32::consts::FRAC_PI_4 * width;
        assert!((shoelace.abs() / expected - 1.0).abs() < 0.01, "{width}: {shoelace} {expected}");

        let drawn = look.draw(key(), &Quiet).unwrap();
        let cell = &drawn.cells[0];
        let covered = drawn.base_color.rgba().chunks_exact(4).filter(|p| p[3] >= 128).count() as f32;
        let unit_px = cell.unit.x * 1024.0;
        // The drawn leaf's own width varies by a tenth and its sides by a twentieth: measured from
        // the cell, which is a pixel larger on each side.
        let size = (cell.max - cell.min) * 1024.0 - Vec2::splat(2.0);
        let expected = std::f32::consts::FRAC_PI_4 * size.x * size.y;
        assert!((size.y / unit_px - 1.0).abs() < 0.01, "{size} {unit_px}");
        assert!((covered / expected - 1.0).abs() < 0.04, "{width}: {covered} {expected}");
    }
}

#[test]
fn lobes_are_as_many_as_asked_for() {
    for lobes in [3, 5, 7] {
        let oak = LeafLook { lobes, ..LeafLook::new(Outline::Lobed) };
        // The way from the midrib along one side: each lobe stands out, and so does none at the tip,
        // which lies on the midrib.
        let blade = exact(&oak);
        let tip = (0..blade.outline.len())
            .max_by(|&a, &b| blade.outline[a].y.total_cmp(&blade.outline[b].y))
            .unwrap();
        let right: Vec<f32> = blade.outline[..=tip].iter().map(|p| p.x).collect();
        let found = maxima(&right, 0.01);
        assert!(found == lobes as usize || found == lobes as usize + 1, "oak {lobes}: {found}");

        let maple = LeafLook { lobes, margin: Margin::Entire, ..LeafLook::new(Outline::Palmate) };
        let radii: Vec<f32> = exact(&maple).outline.iter().map(|p| p.length()).collect();
        assert_eq!(maxima(&radii, 0.03), lobes as usize, "maple {lobes}");
    }
}

#[test]
fn teeth_are_as_many_as_asked_for() {
    for (margin, teeth) in [(Margin::Serrate, 9), (Margin::Serrate, 24), (Margin::Crenate, 12)] {
        let look = LeafLook { margin, teeth, tooth_depth: 0.03, ..LeafLook::new(Outline::Elliptic) };
        let smooth = exact(&LeafLook { margin: Margin::Entire, ..look.clone() });
        let blade = exact(&look);
        // How far each corner is from the outline without teeth.
        let away: Vec<f32> = blade
            .outline
            .iter()
            .map(|p| smooth.outline.iter().map(|q| p.distance(*q)).fold(f32::INFINITY, f32::min))
            .collect();
        let found = maxima(&away, 0.006);
        // Those at the foot and the tip fade away.
        let expected = 2 * teeth as usize;
        assert!(found <= expected && found + 6 >= expected, "{margin:?} {teeth}: {found}");
    }
}

#[test]
fn cells_do_not_touch_and_hold_all_that_is_drawn() {
    for (name, outline, _) in Outline::ALL {
        let look = small(outline);
        let twig = TwigLook { leaves: 5, ..TwigLook::default() };
        // Twigs of what is no leaf take long and show nothing new.
        let is_leaf = matches!(outline, Outline::Ovate | Outline::Palmate | Outline::Lanceolate);
        let twigs = is_leaf.then(|| look.draw_twig(&twig, key(), &Quiet).unwrap());
        for drawn in twigs.into_iter().chain([look.draw(key(), &Quiet).unwrap()]) {
            assert_eq!(drawn.cells.len(), 4);
            for (i, a) in drawn.cells.iter().enumerate() {
                assert!(
                    a.min.cmpge(Vec2::ZERO).all() && a.max.cmple(Vec2::ONE).all() && a.min.cmplt(a.max).all()
                );
                // Two smaller copies of the picture still have a pixel between neighbours.
                let gap = Vec2::splat(4.0 / 256.0);
                for b in &drawn.cells[i + 1..] {
                    let apart = (a.max + gap).cmple(b.min).any() || (b.max + gap).cmple(a.min).any();
                    assert!(apart, "{name}: {a:?} {b:?}");
                }
                assert!(a.outline.len() >= 3 && a.outline.len() <= 8);
                let inside = |p: Vec2| {
                    let last = a.outline.last().unwrap();
                    std::iter::once(last)
                        .chain(&a.outline)
                        .zip(&a.outline)
                        .all(|(f, t)| (t - f).perp_dot(p - f) > -1e-4)
                };
                assert!(inside(a.min.midpoint(a.max)));
                // Whatever is cut out lies in a cell, and in its outline.
                for y in 0..256 {
                    for x in 0..256 {
                        let uv = Vec2::new(x as f32 + 0.5, 255.5 - y as f32) / 256.0;
                        let is_within = uv.cmpge(a.min).all() && uv.cmple(a.max).all();
                        if is_within && alpha(&drawn, x, y) >= 128 {
                            assert!(inside(uv), "{name}: {uv} {:?}", a.outline);
                        }
                        let free = drawn.cells.iter().all(|c| uv.cmplt(c.min).any() || uv.cmpgt(c.max).any());
                        assert!(!free || alpha(&drawn, x, y) < 128, "{name}: {uv}");
                    }
                }
            }
        }
    }
}

#[test]
fn leaves_are_as_long_as_their_unit_and_begin_where_they_are_attached() {
    for outline in [Outline::Ovate, Outline::Rhombic, Outline::Lobed, Outline::Linear] {
        let drawn = small(outline).draw(key(), &Quiet).unwrap();
        for cell in &drawn.cells {
            assert!((cell.attach.y - cell.min.y).abs() < 0.02, "{outline:?}: {cell:?}");
            assert!(((cell.max.y - cell.attach.y) / cell.unit.y - 1.0).abs() < 0.06, "{outline:?}: {cell:?}");
        }
    }
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    for outline in [Outline::Palmate, Outline::Pine, Outline::Pinnate] {
        let draw = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| small(outline).draw_twig(&TwigLook::default(), key(), &Quiet).unwrap())
        };
        assert_eq!(draw(1), draw(2));
        assert_eq!(draw(1), draw(3));
        let other = small(outline).draw_twig(&TwigLook::default(), Key::new(4), &Quiet).unwrap();
        assert_ne!(draw(1).base_color, other.base_color);
    }
}

#[test]
fn seasons_turn_leaves_from_green_to_their_autumn_colours() {
    let mean = |season: f32, cell: usize| {
        let look = LeafLook { season, ..small(Outline::Palmate) };
        look.draw(key(), &Quiet).unwrap().cells[cell].color.map(i32::from)
    };
    let (flush, summer, autumn) = (mean(0.0, 0), mean(0.35, 0), mean(0.85, 0));
    assert!(summer[1] > summer[0] + 15, "green: {summer:?}");
    assert!(flush[1] > summer[1] + 15, "lighter: {flush:?} {summer:?}");
    assert!(autumn[0] > autumn[1] + 30, "red: {autumn:?}");
    // Some have turned while others have not.
    let spread = |season| {
        let hues = [0, 1, 2, 3].map(|cell| mean(season, cell)).map(|[red, green, _]| red - green);
        hues.iter().max().unwrap() - hues.iter().min().unwrap()
    };
    assert!(spread(0.66) > 3 * spread(0.35) && spread(0.66) > 20, "{} {}", spread(0.35), spread(0.66));
    // What has no autumn colours keeps its own.
    let evergreen = |season: f32| {
        LeafLook { season, autumn_colors: vec![], ..small(Outline::Ovate) }.draw(key(), &Quiet).unwrap()
    };
    assert_eq!(evergreen(0.35), evergreen(0.9));
}

#[test]
fn colours_go_on_outside_the_leaf() {
    let drawn = small(Outline::Ovate).draw(key(), &Quiet).unwrap();
    for p in drawn.base_color.rgba().chunks_exact(4) {
        assert!(p[1] > 40 && p[1] > p[2], "green everywhere: {p:?}");
    }
    for p in drawn.normal.rgba().chunks_exact(4) {
        let [x, y, z] = [p[0], p[1], p[2]].map(|c| f64::from(c) / 127.5 - 1.0);
        assert!((libm::sqrt(x * x + y * y + z * z) - 1.0).abs() < 0.012 && z > 0.0, "{p:?}");
    }
}

#[test]
fn odd_wishes_are_met_or_refused() {
    let look = small(Outline::Ovate);
    let with = |change: &dyn Fn(&mut LeafLook)| {
        let mut changed = look.clone();
        change(&mut changed);
        changed.draw(key(), &Quiet)
    };
    assert_eq!(with(&|l| l.size_px = 0), Err(LeafError::Size(0)));
    assert_eq!(with(&|l| l.size_px = 4097), Err(LeafError::Size(4097)));
    assert_eq!(with(&|l| l.variants = 0), Err(LeafError::Variants(0)));
    assert_eq!(with(&|l| l.variants = 65), Err(LeafError::Variants(65)));
    for (_, outline, _) in Outline::ALL {
        for extreme in [0.0, 1e9, -3.0, f32::NAN, f32::INFINITY] {
            let odd = LeafLook {
                width: extreme,
                lobes: if extreme > 1.0 { u32::MAX } else { 0 },
                lobe_depth: extreme,
                margin: Margin::Doubly,
                teeth: if extreme > 1.0 { u32::MAX } else { 0 },
                tooth_depth: extreme,
                tip: extreme,
                petiole: extreme,
                vein_strength: extreme,
                colors: vec![],
                color_spread: extreme,
                season: extreme,
                variants: 2,
                size_px: 17,
                ..LeafLook::new(outline)
            };
            assert_eq!(odd.draw(key(), &Quiet).unwrap().cells.len(), 2, "{outline:?} {extreme}");
        }
    }
    let twig = TwigLook {
        leaves: u32::MAX,
        length_m: f32::NAN,
        leaf_length_m: -1.0,
        angle_deg: f32::NAN,
        ..TwigLook::default()
    };
    let tiny = LeafLook { size_px: 1, variants: 64, ..look };
    assert_eq!(tiny.draw_twig(&twig, key(), &Quiet).unwrap().cells.len(), 64);
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
    assert_eq!(small(Outline::Fern).draw(key(), &Stop), Err(LeafError::Cancelled(Cancelled)));
}

/// By Cauchy and Crofton: the mean width of strokes is twice their area by the length of their outlines.
#[test]
fn wider_needles_are_fewer_and_cover_as_much() {
    for outline in [Outline::Pine, Outline::Spruce, Outline::Larch] {
        let measured = |needle_scale: f32| {
            let look = LeafLook { size_px: 512, variants: 1, needle_scale, ..LeafLook::new(outline) };
            let pictures = look.draw(key(), &Quiet).unwrap();
            let is_covered = |x: usize, y: usize| alpha(&pictures, x, y) >= 128;
            let places = || (0..512).flat_map(|y| (0..512).map(move |x| (x, y)));
            let area = places().filter(|&(x, y)| is_covered(x, y)).count() as f64;
            let edges = places().map(|(x, y)| {
                let beside = x + 1 < 512 && is_covered(x, y) != is_covered(x + 1, y);
                let below = y + 1 < 512 && is_covered(x, y) != is_covered(x, y + 1);
                usize::from(beside) + usize::from(below)
            });
            let outlines = std::f64::consts::FRAC_PI_4 * edges.sum::<usize>() as f64;
            // In lengths of what is drawn.
            let unit = f64::from(pictures.cells[0].unit.y) * 512.0;
            (area / (unit * unit), 2.0 * area / outlines / unit)
        };
        let ((area, width), (as_much, wider)) = (measured(1.0), measured(2.0));
        assert!((0.85..1.15).contains(&(as_much / area)), "{outline:?}: {area} {as_much}");
        assert!(wider > 1.3 * width, "{outline:?}: {width} {wider}");
        let look = LeafLook { needle_scale: 2.0, ..LeafLook::new(outline) };
        assert_eq!(look.needle_width(), LeafLook::new(outline).needle_width().map(|width| 2.0 * width));
    }
    assert_eq!(LeafLook::new(Outline::Lobed).needle_width(), None);
}
