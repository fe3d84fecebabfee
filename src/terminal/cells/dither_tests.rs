use super::*;

const DARK: [f32; 3] = [0.005; 3];
const LEAF: [u8; 3] = [78, 112, 52];
const LIT_LEAF: [u8; 3] = [128, 168, 84];
const BARK: [u8; 3] = [104, 84, 66];

fn light(srgb: [u8; 3]) -> [f32; 3] {
    srgb.map(|c| decode(f32::from(c) / 255.0))
}

/// How a large area of one colour looks from afar.
fn seen(colors: ColorDepth, srgb: [u8; 3]) -> [f32; 3] {
    let mut dither = Dither::new(colors).unwrap();
    let cell = [Light { rgb: light(srgb), alpha: 1.0 }; 4];
    let mut sum = [0.0; 3];
    for place in (0..64).map(|i| (i % 8, i / 8)) {
        let split = dither.split(&cell, DARK, place);
        for part in 0..4 {
            let shown = if split.drawn >> part & 1 == 1 { Some(split.ink) } else { split.paper };
            let shown = light(shown.expect("what is opaque has paper"));
            sum = std::array::from_fn(|c| sum[c] + shown[c] / 256.0);
        }
    }
    oklab_of_light(sum)
}

fn chroma([_, a, b]: [f32; 3]) -> f32 {
    libm::hypotf(a, b)
}

/// Degrees, of the circle of green-red and blue-yellow.
fn hue([_, a, b]: [f32; 3]) -> f32 {
    libm::atan2f(b, a).to_degrees()
}

#[test]
fn leaves_are_green_and_shaded_in_few_colours() {
    for colors in [ColorDepth::Ansi16, ColorDepth::Ansi256] {
        let [leaf, lit, bark] = [LEAF, LIT_LEAF, BARK].map(|srgb| seen(colors, srgb));
        assert!(chroma(leaf) > 0.05 && chroma(lit) > 0.05, "{colors:?}: {leaf:?} {lit:?}");
        for (srgb, found) in [(LEAF, leaf), (LIT_LEAF, lit)] {
            let off = (hue(found) - hue(oklab_of_light(light(srgb)))).abs();
            assert!(off < 15.0, "{colors:?} {srgb:?}: off by {off}");
        }
        assert!(lit[0] - leaf[0] > 0.1, "{colors:?}: light {lit:?} and shade {leaf:?}");
        assert!(leaf[1] < bark[1] - 0.03, "{colors:?}: leaf {leaf:?} and bark {bark:?}");
    }
}

#[test]
fn an_area_has_the_lightness_that_one_entry_cannot_show() {
    for colors in [ColorDepth::Ansi16, ColorDepth::Ansi256] {
        let palette = Mixes::new(colors);
        let (mut off, mut off_alone) = (0.0, 0.0);
        let mut before = -1.0;
        for grey in (16..=240).step_by(16) {
            let wanted = palette.wanted(light([grey; 3]));
            let found = seen(colors, [grey; 3])[0];
            assert!(found > before, "{colors:?} {grey}: {found} is no lighter than {before}");
            before = found;
            off += (found - wanted[0]).abs();
            let alone = palette.entries.iter().map(|entry| (entry.lab[0] - wanted[0]).abs());
            off_alone += alone.fold(f32::INFINITY, f32::min);
        }
        assert!(off < 0.6 * off_alone, "{colors:?}: {off} with pairs, {off_alone} with one entry");
    }
}

#[test]
fn what_is_drawn_before_the_terminals_own_background_is_seen() {
    for behind in [[0.0; 3], [0.96; 3]] {
        for colors in [ColorDepth::Ansi16, ColorDepth::Ansi256] {
            let mut dither = Dither::new(colors).unwrap();
            let background = oklab_of_light(behind);
            for srgb in [[20, 24, 18], LEAF, LIT_LEAF, BARK, [240; 3]] {
                for place in (0..16).map(|i| (i % 4, i / 4)) {
                    let ink = dither.one(light(srgb), behind, place);
                    let apart = difference(oklab_of_light(light(ink)), background);
                    assert!(apart > 0.04, "{colors:?} {srgb:?} at {place:?}: {ink:?}");
                }
            }
        }
    }
}

#[test]
fn bright_ones_of_the_16_stand_before_dark_ones() {
    let palette = Mixes::new(ColorDepth::Ansi16);
    let mut both = 0;
    for i in 0..512_u32 {
        let srgb = [i / 64, i / 8 % 8, i % 8].map(|c| (c * 36) as u8);
        for [paper, ink] in palette.square(palette.wanted(light(srgb))) {
            assert!(paper < 8 || paper == ink, "{srgb:?}: {paper} behind {ink}");
            both += usize::from(ink >= 8);
        }
    }
    assert!(both > 100, "bright ones are used: {both}");
}

#[test]
fn patterns_stand_still() {
    let mut dither = Dither::new(ColorDepth::Ansi16).unwrap();
    let cell = [Light { rgb: light(LEAF), alpha: 1.0 }; 4];
    for (column, row) in [(0, 0), (1, 0), (0, 1), (3, 2)] {
        let here = dither.split(&cell, DARK, (column, row));
        assert_eq!(here, Dither::new(ColorDepth::Ansi16).unwrap().split(&cell, DARK, (column + 4, row + 8)));
    }
    assert!(Dither::new(ColorDepth::True).is_none() && Dither::new(ColorDepth::None).is_none());
}
