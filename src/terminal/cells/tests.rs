use super::*;
use crate::grid::decode;

/// A cell as a terminal shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    character: char,
    ink: Option<[u8; 3]>,
    paper: Option<[u8; 3]>,
}

/// A terminal that knows printing, newline and colours; anything else panics.
fn interpret(text: &str) -> Vec<Vec<Shown>> {
    let mut lines = vec![vec![]];
    let (mut ink, mut paper) = (None, None);
    let mut rest = text.chars();
    while let Some(c) = rest.next() {
        match c {
            '\n' => lines.push(vec![]),
            '\u{1b}' => {
                assert_eq!(rest.next(), Some('['));
                let parameters: String = rest.by_ref().take_while(|&c| c != 'm').collect();
                let mut numbers = parameters.split(';').map(|n| n.parse::<u16>().unwrap());
                while let Some(n) = numbers.next() {
                    match n {
                        0 => (ink, paper) = (None, None),
                        39 => ink = None,
                        49 => paper = None,
                        30..=37 => ink = Some([n as u8 - 30; 3]),
                        90..=97 => ink = Some([n as u8 - 82; 3]),
                        40..=47 => paper = Some([n as u8 - 40; 3]),
                        100..=107 => paper = Some([n as u8 - 92; 3]),
                        38 | 48 => {
                            let color = match numbers.next() {
                                Some(2) => std::array::from_fn(|_| numbers.next().unwrap() as u8),
                                Some(5) => xterm(numbers.next().unwrap() as u8),
                                other => panic!("{other:?}"),
                            };
                            *(if n == 38 { &mut ink } else { &mut paper }) = Some(color);
                        }
                        other => panic!("unknown attribute {other}"),
                    }
                }
            }
            character => lines.last_mut().unwrap().push(Shown { character, ink, paper }),
        }
    }
    assert_eq!((ink, paper), (None, None), "the text must leave no colour set");
    assert_eq!(lines.pop(), Some(vec![]), "the text must end with a newline");
    lines
}

fn xterm(i: u8) -> [u8; 3] {
    match i {
        232.. => [(i - 232) * 10 + 8; 3],
        16.. => [(i - 16) / 36, (i - 16) / 6 % 6, (i - 16) % 6].map(|v| if v == 0 { 0 } else { v * 40 + 55 }),
        _ => panic!("{i} depends on the theme"),
    }
}

/// Whether a place (0..1 from the upper left) of a cell has ink, from the characters' Unicode names.
fn has_ink(character: char, x: f32, y: f32) -> bool {
    let (left, upper) = (x < 0.5, y < 0.5);
    match character {
        ' ' => false,
        '█' => true,
        '▀' => upper,
        '▄' => !upper,
        '▌' => left,
        '▐' => !left,
        '▘' => left && upper,
        '▝' => !left && upper,
        '▖' => left && !upper,
        '▗' => !left && !upper,
        '▚' => left == upper,
        '▞' => left != upper,
        '▛' => left || upper,
        '▜' => !left || upper,
        '▙' => left || !upper,
        '▟' => !left || !upper,
        other => panic!("{other} is no block"),
    }
}

/// Mean squared difference in linear light between a picture and what is shown of it.
fn error(lines: &[Vec<Shown>], image: &[u8], width: usize, height: usize) -> f64 {
    let (rows, columns) = (lines.len(), lines[0].len());
    let mut sum = 0.0;
    for y in 0..height {
        for x in 0..width {
            let (cx, cy) = (
                (x as f32 + 0.5) / width as f32 * columns as f32,
                (y as f32 + 0.5) / height as f32 * rows as f32,
            );
            let shown = lines[cy as usize][cx as usize];
            let color =
                if has_ink(shown.character, cx.fract(), cy.fract()) { shown.ink } else { shown.paper };
            let color = color.expect("an opaque picture sets all colours");
            for c in 0..3 {
                let d = decode(f32::from(color[c]) / 255.0)
                    - decode(f32::from(image[(y * width + x) * 4 + c]) / 255.0);
                sum += f64::from(d * d);
            }
        }
    }
    sum / (width * height) as f64
}

/// Opaque, colours that change in all directions.
fn gradient(width: usize, height: usize) -> Vec<u8> {
    (0..width * height)
        .flat_map(|i| {
            let (x, y) = (i % width, i / width);
            [(x * 255 / width) as u8, (y * 255 / height) as u8, ((x + y) * 127 / width) as u8, 255]
        })
        .collect()
}

/// Opaque, each pixel different from its neighbours.
fn noise(width: u32, height: u32) -> Vec<u8> {
    let mut state = 12345_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..width * height).flat_map(|_| [next(), next(), next(), 255]).collect()
}

fn draw(
    rgba: &[u8],
    (w, h): (u32, u32),
    (columns, rows): (u16, u16),
    glyphs: Glyphs,
    colors: ColorDepth,
) -> String {
    let style = CellStyle { glyphs, colors, ..CellStyle::default() };
    draw_cells(&Image::new(w, h, rgba).unwrap(), columns, rows, &style)
}

#[test]
fn quadrants_are_nearer_than_halves() {
    for image in [gradient(64, 64), noise(64, 64)] {
        let of = |glyphs| {
            error(&interpret(&draw(&image, (64, 64), (32, 16), glyphs, ColorDepth::True)), &image, 64, 64)
        };
        let (quadrants, halves) = (of(Glyphs::Quadrants), of(Glyphs::Halves));
        assert!(quadrants < halves, "{quadrants} {halves}");
    }
    let image = gradient(64, 64);
    let quadrants = draw(&image, (64, 64), (32, 16), Glyphs::Quadrants, ColorDepth::True);
    let found = error(&interpret(&quadrants), &image, 64, 64);
    assert!(found < 0.001, "a soft gradient should be close: {found}");
}

#[test]
fn no_other_split_of_a_cell_is_better() {
    // Against all pairs of the cell's own parts' means, over cells of noise.
    let image = noise(32, 32);
    let text = draw(&image, (32, 32), (16, 16), Glyphs::Quadrants, ColorDepth::True);
    let lines = interpret(&text);
    for (row, line) in lines.iter().enumerate() {
        for (column, &shown) in line.iter().enumerate() {
            let pixel = |i: usize| -> [f32; 3] {
                let at = ((row * 2 + i / 2) * 32 + column * 2 + i % 2) * 4;
                std::array::from_fn(|c| decode(f32::from(image[at + c]) / 255.0))
            };
            let cost = |ink: [f32; 3], paper: [f32; 3], mask: usize| -> f32 {
                (0..4)
                    .map(|i| {
                        let color = if mask >> i & 1 == 1 { ink } else { paper };
                        (0..3).map(|c| (pixel(i)[c] - color[c]) * (pixel(i)[c] - color[c])).sum::<f32>()
                    })
                    .sum()
            };
            let best = (0..16_usize)
                .map(|mask| {
                    let side = |which: bool| -> [f32; 3] {
                        let of: Vec<_> =
                            (0..4).filter(|i| (mask >> i & 1 == 1) == which).map(pixel).collect();
                        std::array::from_fn(|c| of.iter().map(|p| p[c]).sum::<f32>() / of.len().max(1) as f32)
                    };
                    cost(side(true), side(false), mask)
                })
                .fold(f32::INFINITY, f32::min);
            let linear = |c: Option<[u8; 3]>| c.unwrap_or_default().map(|c| decode(f32::from(c) / 255.0));
            let mask = (0..4)
                .filter(|i| {
                    has_ink(shown.character, (i % 2) as f32 * 0.5 + 0.25, (i / 2) as f32 * 0.5 + 0.25)
                })
                .fold(0, |m, i| m | 1 << i);
            // Rounding to bytes costs a little.
            let found = cost(linear(shown.ink), linear(shown.paper), mask);
            assert!(found <= best + 1e-3, "{row} {column}: {found} {best}");
        }
    }
}

#[test]
fn transparency_leaves_the_terminal_alone() {
    let mut image = gradient(8, 8);
    for pixel in image.chunks_exact_mut(4).take(8 * 4 + 3) {
        pixel[3] = 0;
    }
    let lines = interpret(&draw(&image, (8, 8), (4, 4), Glyphs::Quadrants, ColorDepth::True));
    assert!(lines[0].is_empty() && lines[1].is_empty());
    // Row 2: three of its first pixels are transparent.
    assert_eq!((lines[2][0].character, lines[2][0].paper), ('▄', None));
    assert_eq!((lines[2][1].character, lines[2][1].paper), ('▟', None));
    assert!(lines[2][2].paper.is_some() || lines[2][2].character == '█');
}

#[test]
fn empty_cells_between_colours_have_no_paper() {
    // Two opaque cells with an empty one between them.
    let mut image = noise(6, 2);
    for y in 0..2 {
        for x in 2..4 {
            image[(y * 6 + x) * 4 + 3] = 0;
        }
    }
    let lines = interpret(&draw(&image, (6, 2), (3, 1), Glyphs::Quadrants, ColorDepth::True));
    assert_eq!(lines[0].len(), 3);
    assert_eq!((lines[0][1].character, lines[0][1].paper), (' ', None));
}

#[test]
fn equal_neighbours_cost_one_byte_each() {
    let image: Vec<u8> = [200, 100, 50, 255].repeat(40 * 2);
    let text = draw(&image, (40, 2), (20, 1), Glyphs::Quadrants, ColorDepth::True);
    assert_eq!(text, format!("\u{1b}[48;2;200;100;50m{}\u{1b}[0m\n", " ".repeat(20)));
}

#[test]
fn a_preview_keeps_its_byte_budget() {
    // The worst there is: every cell differs from its neighbours in both colours.
    let image = noise(128, 72);
    let size = |colors| draw(&image, (128, 72), (64, 36), Glyphs::Quadrants, colors).len();
    let cells = 64 * 36;
    // "ESC [38;2;r;g;b;48;2;r;g;bm" and a character of three bytes, with numbers of three digits.
    assert!(size(ColorDepth::True) <= cells * 39 + 36 * 5);
    assert!(size(ColorDepth::Ansi256) <= cells * 23 + 36 * 5);
    assert!(size(ColorDepth::Ansi16) <= cells * 12 + 36 * 5);
    // A tree-like picture, a third of it covered, stays near the budget of 20 KB.
    let mut tree = gradient(128, 72);
    for (i, pixel) in tree.chunks_exact_mut(4).enumerate() {
        let (x, y) = (i % 128, i / 128);
        if x.abs_diff(64) > y / 2 + 8 {
            pixel[3] = 0;
        }
    }
    let bytes = draw(&tree, (128, 72), (64, 36), Glyphs::Quadrants, ColorDepth::True).len();
    assert!((5_000..40_000).contains(&bytes), "{bytes}");
}

#[test]
fn without_colours_there_is_no_escape() {
    let mut image = noise(32, 32);
    for glyphs in [Glyphs::Quadrants, Glyphs::Halves, Glyphs::Braille] {
        let text = draw(&image, (32, 32), (16, 8), glyphs, ColorDepth::None);
        assert!(!text.contains('\u{1b}'), "{glyphs:?}");
        assert_eq!(text.lines().count(), 8);
        assert!(text.lines().all(|l| l.chars().count() <= 16));
        assert!(text.chars().any(|c| c != ' ' && c != '\n'), "{glyphs:?} shows something");
    }
    image.fill(0);
    assert_eq!(draw(&image, (32, 32), (16, 8), Glyphs::Braille, ColorDepth::None), "\n".repeat(8));
}

#[test]
fn braille_dots_are_where_the_light_is() {
    // One lit pixel at a time in one cell; dots by Unicode chapter 15: 1 2 3 7 left, 4 5 6 8 right.
    let expected = [['⠁', '⠈'], ['⠂', '⠐'], ['⠄', '⠠'], ['⡀', '⢀']];
    for (y, row) in expected.iter().enumerate() {
        for (x, &character) in row.iter().enumerate() {
            let mut image = vec![0; 2 * 4 * 4];
            image[(y * 2 + x) * 4..][..4].fill(255);
            assert_eq!(
                draw(&image, (2, 4), (1, 1), Glyphs::Braille, ColorDepth::None),
                format!("{character}\n")
            );
        }
    }
}

#[test]
fn dark_on_light_is_drawn_too() {
    let style = CellStyle { glyphs: Glyphs::Braille, colors: ColorDepth::None, background: [255; 3] };
    let mut image = [255; 2 * 4 * 4];
    image[..3].fill(0);
    assert_eq!(draw_cells(&Image::new(2, 4, &image).unwrap(), 1, 1, &style), "⠁\n");
}

#[test]
fn shallow_colours_are_those_of_the_palette() {
    let image = gradient(64, 64);
    let shallow = error(
        &interpret(&draw(&image, (64, 64), (32, 16), Glyphs::Quadrants, ColorDepth::Ansi256)),
        &image,
        64,
        64,
    );
    assert!(shallow < 0.03, "{shallow}");
    // 16 colours: the interpreter gives the entry's number. A bright one is ink.
    let lines = interpret(&draw(&[255, 0, 0, 255], (1, 1), (1, 1), Glyphs::Halves, ColorDepth::Ansi16));
    assert_eq!((lines[0][0].character, lines[0][0].ink), ('█', Some([9; 3])));
}

#[test]
fn any_size_of_picture_and_area() {
    for (w, h) in [(1, 1), (3, 5), (100, 1)] {
        for area in [(0, 0), (1, 1), (7, 3)] {
            for glyphs in [Glyphs::Quadrants, Glyphs::Halves, Glyphs::Braille] {
                let text = draw(&noise(w, h), (w, h), area, glyphs, ColorDepth::True);
                assert_eq!(text.lines().count(), usize::from(area.1), "{w}x{h} {area:?}");
            }
        }
    }
    assert_eq!(square_pixels(64, 36, 0.5), (128, 144));
}

/// Opaque noise, noise with holes, and a soft gradient.
fn hard_pictures(width: u32, height: u32) -> [Vec<u8>; 3] {
    let mut holes = noise(width, height);
    for (i, pixel) in holes.chunks_exact_mut(4).enumerate() {
        pixel[3] = if (i * 7919) % 11 < 5 { 0 } else { 255 };
    }
    [noise(width, height), holes, gradient(width as usize, height as usize)]
}

#[test]
fn any_picture_keeps_its_budget() {
    for (columns, rows) in [(64, 36), (200, 60), (400, 120), (1, 1), (400, 1)] {
        let (w, h) = (u32::from(columns) * 2, u32::from(rows) * 2);
        for (which, rgba) in hard_pictures(w, h).iter().enumerate() {
            let image = Image::new(w, h, rgba).unwrap();
            for colors in [ColorDepth::True, ColorDepth::Ansi256, ColorDepth::Ansi16, ColorDepth::None] {
                for glyphs in [Glyphs::Quadrants, Glyphs::Braille] {
                    if glyphs == Glyphs::Braille && matches!(colors, ColorDepth::Ansi16 | ColorDepth::Ansi256)
                    {
                        continue;
                    }
                    let style = CellStyle { glyphs, colors, ..CellStyle::default() };
                    for budget in [DRAFT_BUDGET, full_budget(columns, rows).max(1000)] {
                        let picture = CellPicture::draw(&image, columns, rows, &style, budget);
                        let bytes = paint_cost(&picture.buffer(), colors);
                        let what = format!("{columns}x{rows} picture {which} {colors:?} {glyphs:?}");
                        assert!(bytes <= budget, "{what}: {bytes} > {budget}");
                        assert!(
                            bytes > budget / 40 || bytes > 300 || columns == 1,
                            "{what}: nothing left: {bytes}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn a_smaller_budget_changes_colours_by_no_more_than_its_tolerance() {
    let image = gradient(128, 72);
    let image = Image::new(128, 72, &image).unwrap();
    let style = CellStyle::default();
    let quarters = |cell: &PictureCell| -> [[u8; 3]; 4] {
        let rgb = |color| match color {
            Some(Color::Rgb(r, g, b)) => [r, g, b],
            other => panic!("{other:?}"),
        };
        std::array::from_fn(|i| {
            let (x, y) = ((i % 2) as f32 * 0.5 + 0.25, (i / 2) as f32 * 0.5 + 0.25);
            if has_ink(cell.character, x, y) { rgb(cell.ink) } else { rgb(cell.paper) }
        })
    };
    let exact = CellPicture::draw(&image, 64, 36, &style, usize::MAX);
    assert_eq!(exact.tolerance(), 3);
    let mut last = 3;
    for budget in [16_000, 12_000, 8_000] {
        let picture = CellPicture::draw(&image, 64, 36, &style, budget);
        let tolerance = picture.tolerance();
        assert!(tolerance >= last && tolerance <= 80, "{budget}: {tolerance}");
        last = tolerance;
        for (a, b) in exact.cells().iter().zip(picture.cells()) {
            for (a, b) in quarters(a).into_iter().zip(quarters(b)) {
                // A cell's two colours become their mean, which then becomes a colour that is near.
                let most = 2 * tolerance + 3;
                assert!((0..3).all(|c| a[c].abs_diff(b[c]) <= most), "{budget}: {a:?} {b:?} {tolerance}");
            }
        }
    }
    assert!(last > 3);
}

#[test]
fn a_picture_is_put_into_its_area_alone() {
    let image = noise(8, 8);
    let picture =
        CellPicture::draw(&Image::new(8, 8, &image).unwrap(), 4, 4, &CellStyle::default(), usize::MAX);
    let mut before = Buffer::empty(Rect::new(0, 0, 10, 6));
    before.set_style(before.area, ratatui::style::Style::new().bg(Color::Blue));
    let mut buffer = before.clone();
    // Larger than the picture to the right, smaller below, beyond the screen.
    picture.put(&mut buffer, Rect::new(3, 4, 20, 3));
    for (x, y) in (0..10).flat_map(|x| (0..6).map(move |y| (x, y))) {
        let inside = (3..7).contains(&x) && (4..6).contains(&y);
        let cell = &buffer[(x, y)];
        if inside {
            let wanted = picture.cells()[usize::from(y - 4) * 4 + usize::from(x - 3)];
            assert_eq!(cell.symbol(), wanted.character.to_string());
            assert_eq!(wanted.paper.unwrap_or(cell.bg), cell.bg);
        } else {
            assert_eq!(cell, &before[(x, y)], "{x} {y}");
        }
    }
}

#[test]
fn what_a_buffer_shows_is_what_the_text_shows() {
    let mut image = gradient(32, 32);
    for pixel in image.chunks_exact_mut(4).skip(200).take(300) {
        pixel[3] = 0;
    }
    let image = Image::new(32, 32, &image).unwrap();
    let text = interpret(&draw_cells(&image, 16, 8, &CellStyle::default()));
    let picture = CellPicture::draw(&image, 16, 8, &CellStyle::default(), usize::MAX);
    for (row, line) in text.iter().enumerate() {
        for (column, shown) in line.iter().enumerate() {
            let cell = &picture.cells()[row * 16 + column];
            for at in [(0.2, 0.2), (0.8, 0.2), (0.2, 0.8), (0.8, 0.8)] {
                let here = if has_ink(shown.character, at.0, at.1) { shown.ink } else { shown.paper };
                let there = if has_ink(cell.character, at.0, at.1) { cell.ink } else { cell.paper };
                match (here, there) {
                    (None, None | Some(Color::Reset)) => {}
                    (Some(a), Some(Color::Rgb(r, g, b))) => {
                        assert!((0..3).all(|c| a[c].abs_diff([r, g, b][c]) <= 6), "{row} {column}");
                    }
                    other => panic!("{row} {column}: {other:?}"),
                }
            }
        }
    }
}
