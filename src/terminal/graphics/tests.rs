use ratatui::buffer::Buffer;
use ratatui::style::Style;

use super::*;
use crate::screen::{Allowance, Composed, Frame, Screen, ScreenOptions};

/// A soft gradient with thousands of thin dark lines, as a tree before the sky.
fn tree(width: u32, height: u32) -> Vec<u8> {
    let mut rgba: Vec<u8> = (0..width * height)
        .flat_map(|i| {
            let (x, y) = (i % width, i / width);
            [(150 + x * 60 / width) as u8, (180 + y * 60 / height) as u8, 230, 255]
        })
        .collect();
    let mut state = 1_u32;
    let mut next = |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % below
    };
    for _ in 0..2500 {
        // From the middle outwards, more of them high up.
        let (mut x, mut y) =
            (width as f32 / 2.0 + next(width / 2) as f32 - width as f32 / 4.0, next(height * 3 / 4) as f32);
        let (dx, dy) = (next(200) as f32 / 100.0 - 1.0, next(100) as f32 / 100.0);
        let shade = 30 + next(50) as u8;
        for _ in 0..8 + next(24) {
            let at = (y.max(0.0) as u32).min(height - 1) * width + (x.max(0.0) as u32).min(width - 1);
            rgba[at as usize * 4..][..3].copy_from_slice(&[shade, shade - 10, shade / 2]);
            (x, y) = (x + dx, y + dy);
        }
    }
    rgba
}

fn graphic(protocol: Protocol, generation: u64, area: Rect) -> Graphic {
    let (width, height) = (u32::from(area.width) * 8, u32::from(area.height) * 16);
    let mut rgba = tree(width, height);
    rgba[3] = 0;
    let data = Arc::new(encode(protocol, &rgba, (width, height), area, usize::MAX).unwrap());
    Graphic { generation, area, layer: 0, data }
}

fn decode_png(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::ALPHA);
    let mut reader = decoder.read_info().unwrap();
    let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgba).unwrap();
    (info.width, info.height, rgba)
}

/// A terminal's side of kitty's protocol.
#[derive(Default, Debug)]
struct Kitty {
    /// The picture that is coming: number and base64.
    coming: Option<(u32, String)>,
    pictures: std::collections::BTreeMap<u32, Vec<u8>>,
    /// Number, columns, rows.
    placed: std::collections::BTreeMap<u32, (u16, u16)>,
    /// Whether there was a moment without a picture after the first one.
    flickered: bool,
    largest_chunk: usize,
    /// The picture that was placed last.
    last_placed: u32,
    /// Whether a synchronized update has begun.
    is_held_back: bool,
    text: String,
}

impl Kitty {
    fn read(&mut self, bytes: &[u8]) {
        let mut rest = std::str::from_utf8(bytes).unwrap();
        while let Some(at) = rest.find("\x1b_G") {
            self.say(&rest[..at]);
            let (command, after) = rest[at + 3..].split_once("\x1b\\").unwrap();
            rest = after;
            let (control, payload) = command.split_once(';').unwrap_or((command, ""));
            let keys: std::collections::BTreeMap<&str, &str> =
                control.split(',').map(|pair| pair.split_once('=').unwrap()).collect();
            let wants_reply = keys.get("a") == Some(&"p");
            assert_eq!(
                keys.get("q"),
                (!wants_reply).then_some(&"2"),
                "a reply to placements alone: {control}"
            );
            assert!(!self.is_held_back, "a picture in a synchronized update: {control}");
            let number = |key: &str| keys[key].parse::<u32>().unwrap();
            match keys.get("a").copied() {
                Some("t") => {
                    assert!(self.coming.is_none(), "one at a time");
                    assert_eq!((keys["f"], keys["t"]), ("100", "d"));
                    self.coming = Some((number("i"), String::new()));
                    self.chunk(payload, number("m"));
                }
                None => self.chunk(payload, number("m")),
                Some("p") => {
                    assert!(self.coming.is_none(), "no command between chunks");
                    assert!(self.pictures.contains_key(&number("i")));
                    assert_eq!(keys["C"], "1", "the cursor stays");
                    self.placed.insert(number("i"), (number("c") as u16, number("r") as u16));
                    self.last_placed = number("i");
                }
                Some("d") => {
                    assert!(self.coming.is_none(), "no command between chunks");
                    self.placed.remove(&number("i"));
                    if keys["d"] == "I" {
                        self.pictures.remove(&number("i"));
                    } else {
                        assert_eq!(keys["d"], "i");
                    }
                    self.flickered |= self.placed.is_empty();
                }
                other => panic!("{other:?}"),
            }
        }
        self.say(rest);
    }

    fn say(&mut self, text: &str) {
        self.text.push_str(text);
        let ends = [text.rfind("\x1b[?2026h"), text.rfind("\x1b[?2026l")];
        self.is_held_back = if ends == [None, None] { self.is_held_back } else { ends[0] > ends[1] };
    }

    fn chunk(&mut self, payload: &str, more: u32) {
        self.largest_chunk = self.largest_chunk.max(payload.len());
        let (id, text) = self.coming.as_mut().expect("a chunk without a picture");
        text.push_str(payload);
        if more == 0 {
            let (id, bytes) = (*id, STANDARD.decode(text.as_bytes()));
            // A picture that was abandoned is thrown away.
            if let Some(bytes) = bytes.ok().filter(|bytes| bytes.ends_with(b"IEND\xae\x42\x60\x82")) {
                self.pictures.insert(id, bytes);
            }
            self.coming = None;
        } else {
            assert!(payload.len().is_multiple_of(4), "groups of base64 are whole");
        }
    }
}

const AREA: Rect = Rect::new(10, 1, 30, 12);

struct Rig {
    screen: Screen,
    buffer: Buffer,
    kitty: Kitty,
}

impl Rig {
    fn new() -> Self {
        let buffer = Buffer::empty(Rect::new(0, 0, 60, 16));
        let options = ScreenOptions { synchronized: true, ..ScreenOptions::default() };
        Self { screen: Screen::new(options), buffer, kitty: Kitty::default() }
    }

    fn show(&mut self, graphic: Option<&Graphic>, allowance: Allowance) -> Composed {
        self.show_all(graphic.cloned().as_slice(), allowance)
    }

    fn show_all(&mut self, graphics: &[Graphic], allowance: Allowance) -> Composed {
        let frame = Frame { buffer: &self.buffer, cursor: None, first: &[], late: &[AREA], graphics };
        self.screen.compose(&frame, allowance)
    }

    /// In pieces, to the end; how many there were.
    fn send(&mut self, graphic: Option<&Graphic>, paced: usize) -> usize {
        for n in 1..10_000 {
            let composed = self.show(graphic, Allowance { text: usize::MAX, paced, atomic: usize::MAX });
            self.kitty.read(&composed.bytes);
            if !composed.rest {
                return n;
            }
        }
        panic!("it never ends");
    }
}

#[test]
fn kitty_gets_the_picture_in_pieces_between_which_text_goes() {
    let picture = graphic(Protocol::Kitty, 1, AREA);
    let mut rig = Rig::new();
    for (n, letter) in ('a'..='z').enumerate() {
        rig.buffer.set_string(n as u16, 15, letter.to_string(), Style::new());
        let composed = rig.show(Some(&picture), Allowance { text: usize::MAX, paced: 700, atomic: 0 });
        assert!(composed.picture <= 700 || n == 0, "{}", composed.picture);
        assert!(String::from_utf8_lossy(&composed.bytes).contains(letter), "a key is answered at once");
        rig.kitty.read(&composed.bytes);
    }
    assert!(rig.kitty.coming.is_some() && rig.kitty.placed.is_empty());
    assert!(rig.send(Some(&picture), 700) > 1);
    assert_eq!(rig.kitty.placed.values().collect::<Vec<_>>(), [&(30, 12)]);
    let (width, height, rgba) = decode_png(rig.kitty.pictures.values().next().unwrap());
    let mut wanted = tree(240, 192);
    wanted[3] = 0;
    assert!((width, height) == (240, 192) && rgba == wanted, "bit by bit");
    assert!(rig.show(Some(&picture), Allowance::ALL).bytes.is_empty(), "it is sent once");
}

#[test]
fn chunks_are_no_larger_than_the_protocol_allows() {
    let mut rig = Rig::new();
    rig.send(Some(&graphic(Protocol::Kitty, 1, AREA)), usize::MAX);
    assert!(rig.kitty.largest_chunk <= 4096 && rig.kitty.pictures.len() == 1);
}

#[test]
fn a_new_picture_is_there_before_the_old_one_goes() {
    let mut rig = Rig::new();
    for generation in 1..4 {
        rig.send(Some(&graphic(Protocol::Kitty, generation, AREA)), 3000);
        assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (1, 1));
    }
    assert!(!rig.kitty.flickered);
}

#[test]
fn a_picture_that_is_overtaken_is_ended() {
    let mut rig = Rig::new();
    let (old, new) = (graphic(Protocol::Kitty, 1, AREA), graphic(Protocol::Kitty, 2, AREA));
    let composed = rig.show(Some(&old), Allowance { text: usize::MAX, paced: 3000, atomic: 0 });
    rig.kitty.read(&composed.bytes);
    assert!(rig.kitty.coming.is_some());
    rig.send(Some(&new), 3000);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (1, 1));
    // And one that the program's end overtakes.
    let mut rig = Rig::new();
    let composed = rig.show(Some(&old), Allowance { text: usize::MAX, paced: 3000, atomic: 0 });
    rig.kitty.read(&composed.bytes);
    rig.kitty.read(&rig.screen.farewell());
    assert!(rig.kitty.coming.is_none() && rig.kitty.pictures.is_empty());
}

#[test]
fn the_cells_beneath_are_blank_while_it_stands_and_come_back() {
    let mut rig = Rig::new();
    rig.buffer.set_string(12, 3, "draft", Style::new());
    rig.buffer.set_string(0, 0, "text", Style::new());
    let mut terminal = vt100::Parser::new(16.try_into().unwrap(), 60.try_into().unwrap(), 0);
    let picture = graphic(Protocol::Kitty, 1, AREA);
    let mut contents = |rig: &mut Rig, graphic: Option<&Graphic>, allowance| {
        let bytes = rig.show(graphic, allowance).bytes;
        rig.kitty.read(&bytes);
        terminal.process(&bytes);
        terminal.screen().contents()
    };
    assert!(
        contents(&mut rig, Some(&picture), Allowance { text: usize::MAX, paced: 900, atomic: 0 })
            .contains("draft")
    );
    assert_eq!(contents(&mut rig, Some(&picture), Allowance::ALL).trim(), "text");
    // A pop-up: no picture, its cells.
    let seen = contents(&mut rig, None, Allowance::ALL);
    assert!(seen.contains("draft") && rig.kitty.placed.is_empty());
}

#[test]
fn what_something_lay_over_is_placed_again_for_a_few_bytes() {
    let mut rig = Rig::new();
    for row in AREA.top()..AREA.bottom() {
        rig.buffer.set_string(AREA.x, row, "draft of the picture", Style::new());
    }
    let picture = graphic(Protocol::Kitty, 1, AREA);
    rig.send(Some(&picture), usize::MAX);
    rig.send(None, usize::MAX);
    assert_eq!((rig.kitty.placed.len(), rig.kitty.pictures.len()), (0, 1));
    let back = rig.show(Some(&picture), Allowance::ALL).bytes;
    rig.kitty.read(&back);
    assert_eq!((rig.kitty.placed.len(), rig.kitty.pictures.len()), (1, 1));
    // The picture's cells are blank again; none of it is sent.
    assert!(back.len() < 400 && !String::from_utf8_lossy(&back).contains("draft"), "{}", back.len());
    // Another picture instead: the terminal keeps one.
    rig.send(None, usize::MAX);
    rig.send(Some(&graphic(Protocol::Kitty, 2, AREA)), 3000);
    assert_eq!((rig.kitty.placed.len(), rig.kitty.pictures.len()), (1, 1));
    rig.send(None, usize::MAX);
    rig.kitty.read(&rig.screen.farewell());
    assert!(rig.kitty.pictures.is_empty());
}

#[test]
fn a_picture_that_the_terminal_lost_is_sent_again() {
    let mut rig = Rig::new();
    let picture = graphic(Protocol::Kitty, 1, AREA);
    rig.send(Some(&picture), usize::MAX);
    // As long as it has never answered, silence says nothing.
    assert!(rig.screen.awaits() && !rig.screen.is_read());
    assert!(!rig.screen.answered(rig.kitty.last_placed, true) && !rig.screen.awaits());
    let first = rig.kitty.last_placed;
    rig.send(Some(&graphic(Protocol::Kitty, 2, AREA)), usize::MAX);
    assert!(!rig.screen.answered(first, false), "that one is gone anyhow");
    // Now silence is a loss, and so is a refusal.
    assert!(rig.screen.is_read());
    rig.send(Some(&graphic(Protocol::Kitty, 2, AREA)), usize::MAX);
    assert!(rig.screen.answered(rig.kitty.last_placed, false));
    rig.send(Some(&graphic(Protocol::Kitty, 2, AREA)), usize::MAX);
    assert_eq!((rig.kitty.placed.len(), rig.kitty.pictures.len()), (1, 1));
    assert!(!rig.screen.answered(rig.kitty.last_placed, true) && !rig.screen.is_read());
}

#[test]
fn a_picture_that_is_lost_again_and_again_gives_way_to_cells() {
    let mut rig = Rig::new();
    rig.buffer.set_string(12, 3, "draft", Style::new());
    let picture = graphic(Protocol::Kitty, 1, AREA);
    let mut sent = 0;
    loop {
        rig.send(Some(&picture), usize::MAX);
        if rig.kitty.placed.is_empty() {
            break;
        }
        sent += 1;
        rig.screen.answered(rig.kitty.last_placed, false);
    }
    assert!(sent == 3 && rig.kitty.pictures.is_empty() && rig.kitty.text.contains("draft"), "{sent}");
    // The next one is tried.
    rig.send(Some(&graphic(Protocol::Kitty, 2, AREA)), usize::MAX);
    assert_eq!(rig.kitty.placed.len(), 1);
}

#[test]
fn a_picture_moves_without_being_sent_again() {
    let mut rig = Rig::new();
    let picture = graphic(Protocol::Kitty, 1, AREA);
    rig.send(Some(&picture), usize::MAX);
    let moved = Graphic { area: Rect::new(2, 2, 20, 9), ..picture };
    let bytes = rig.show(Some(&moved), Allowance::ALL).bytes;
    rig.kitty.read(&bytes);
    assert!(bytes.len() < 200, "{}", bytes.len());
    assert_eq!(rig.kitty.placed.values().collect::<Vec<_>>(), [&(20, 9)]);
}

#[test]
fn after_a_clear_the_picture_is_sent_again() {
    for protocol in [Protocol::Kitty, Protocol::Sixel, Protocol::Iterm2] {
        let mut rig = Rig::new();
        let picture = graphic(protocol, 1, AREA);
        rig.send(Some(&picture), usize::MAX);
        rig.screen.invalidate();
        let bytes = rig.show(Some(&picture), Allowance::ALL).bytes;
        assert!(bytes.len() > picture.data.len(), "{protocol:?}");
        rig.kitty.read(&bytes);
        assert!(rig.kitty.pictures.len() <= 1);
    }
}

#[test]
fn sixels_show_the_picture() {
    let rgba = tree(240, 196);
    let encoded = encode(Protocol::Sixel, &rgba, (240, 196), AREA, usize::MAX).unwrap();
    // 196 is cut to whole bands, and nothing moves on to the next one.
    assert_eq!(encoded.size(), (240, 192));
    assert!(!encoded.bytes.ends_with(b"-\x1b\\") && encoded.bytes.ends_with(b"\x1b\\"));
    let image = icy_sixel::SixelImage::decode(&encoded.bytes).unwrap();
    assert_eq!((image.width, image.height), (240, 192));
    let error: u64 = image
        .pixels
        .chunks_exact(4)
        .zip(rgba.chunks_exact(4))
        .map(|(a, b)| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>())
        .sum();
    let mean = error as f64 / (240.0 * 192.0 * 3.0);
    assert!(mean < 4.0, "mean difference {mean}");
}

#[test]
fn iterm2_gets_a_file_in_its_area() {
    let rgba = tree(240, 192);
    let encoded = encode(Protocol::Iterm2, &rgba, (240, 192), AREA, usize::MAX).unwrap();
    let text = String::from_utf8(encoded.bytes).unwrap();
    let (head, file) = text.strip_suffix('\x07').unwrap().split_once(':').unwrap();
    let keys: std::collections::BTreeMap<&str, &str> = head
        .strip_prefix("\x1b]1337;File=")
        .unwrap()
        .split(';')
        .map(|pair| pair.split_once('=').unwrap())
        .collect();
    let file = STANDARD.decode(file).unwrap();
    assert_eq!(keys["size"], file.len().to_string());
    assert_eq!((keys["inline"], keys["width"], keys["height"]), ("1", "30", "12"));
    assert_eq!(decode_png(&file), (240, 192, rgba));
}

#[test]
fn pictures_in_one_piece_wait_for_a_link_that_takes_them() {
    for protocol in [Protocol::Sixel, Protocol::Iterm2] {
        let mut rig = Rig::new();
        rig.buffer.set_string(12, 3, "draft", Style::new());
        let picture = graphic(protocol, 1, AREA);
        let small = rig.show(
            Some(&picture),
            Allowance { text: usize::MAX, paced: 5000, atomic: picture.data.len() - 1 },
        );
        assert!(small.bytes.len() < 200 && !small.rest, "the cells stay");
        assert!(String::from_utf8_lossy(&small.bytes).contains("draft"));
        let whole =
            rig.show(Some(&picture), Allowance { text: usize::MAX, paced: 5000, atomic: picture.data.len() });
        assert!(whole.bytes.len() > picture.data.len());
        // It stands, whatever the link does now.
        assert!(rig.show(Some(&picture), Allowance::NONE).bytes.is_empty());
        // Removed: all of its cells are painted.
        let gone = rig.show(None, Allowance::ALL).bytes;
        let mut terminal = vt100::Parser::new(16.try_into().unwrap(), 60.try_into().unwrap(), 0);
        for row in 0..16 {
            terminal.process(format!("\x1b[{};1H{}", row + 1, "#".repeat(60)).as_bytes());
        }
        terminal.process(&gone);
        for (x, y) in (0..60).flat_map(|x| (0..16).map(move |y| (x, y))) {
            let contents = terminal.screen().cell(y, x).unwrap().contents();
            assert_eq!(contents != "#", AREA.contains((x, y).into()), "{x} {y}: {contents:?}");
        }
    }
}

#[test]
fn a_full_picture_keeps_its_budget() {
    const BUDGET: usize = 100 << 10;
    let area = Rect::new(0, 0, 80, 45);
    let mut rgba = tree(640, 720);
    for transparent in [false, true] {
        if transparent {
            rgba.chunks_exact_mut(4).filter(|pixel| pixel[2] == 230).for_each(|pixel| pixel.fill(0));
        }
        for protocol in [Protocol::Kitty, Protocol::Iterm2, Protocol::Sixel] {
            let encoded = encode(protocol, &rgba, (640, 720), area, BUDGET).unwrap();
            assert!(encoded.len() <= BUDGET, "{protocol:?}: {}", encoded.len());
            assert!(encoded.size().0 >= 320, "{protocol:?}: {:?}", encoded.size());
        }
    }
    // Noise is made smaller until it fits.
    let mut state = 1_u32;
    let noise: Vec<u8> = (0..640 * 720 * 4)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    let encoded = encode(Protocol::Kitty, &noise, (640, 720), area, BUDGET).unwrap();
    assert!(encoded.len() <= BUDGET && encoded.size().0 < 640, "{:?}", encoded.size());
}

#[test]
fn sizes_that_lie_are_errors() {
    for protocol in [Protocol::Kitty, Protocol::Iterm2, Protocol::Sixel] {
        assert!(encode(protocol, &[0; 15], (2, 2), AREA, 1000).is_err());
        assert!(encode(protocol, &[], (0, 0), AREA, 1000).is_err());
        for (width, height) in [(1, 1), (1, 5), (7, 1), (3, 13)] {
            let rgba = vec![200; (width * height * 4) as usize];
            assert!(encode(protocol, &rgba, (width, height), AREA, 1).is_ok(), "{width}x{height}");
        }
    }
}

/// Six pictures side by side, of a layer above the first.
fn tiles(protocol: Protocol, first: u64) -> Vec<Graphic> {
    (0..6_u16)
        .map(|i| {
            let area = Rect::new(2 + i % 3 * 18, 1 + i / 3 * 7, 16, 6);
            Graphic { layer: 1, ..graphic(protocol, first + u64::from(i), area) }
        })
        .collect()
}

impl Rig {
    fn send_all(&mut self, graphics: &[Graphic], paced: usize) -> usize {
        let mut bytes = 0;
        for _ in 0..10_000 {
            let composed = self.show_all(graphics, Allowance { text: usize::MAX, paced, atomic: usize::MAX });
            self.kitty.read(&composed.bytes);
            bytes += composed.bytes.len();
            if !composed.rest {
                return bytes;
            }
        }
        panic!("it never ends");
    }
}

#[test]
fn several_pictures_stand_side_by_side_and_are_sent_once() {
    let mut rig = Rig::new();
    let tiles = tiles(Protocol::Kitty, 10);
    let pixels: usize = tiles.iter().map(|tile| tile.data.len()).sum();
    let sent = rig.send_all(&tiles, 3000);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (6, 6));
    assert!(sent < pixels / 10 * 11, "{sent} for {pixels}");
    // A frame around another one is text alone.
    rig.buffer.set_string(1, 0, "┏━━━━━━━━━━━━━━━━┓", Style::new());
    rig.buffer.set_string(19, 0, "╭────────────────╮", Style::new());
    let moved = rig.show_all(&tiles, Allowance::ALL).bytes;
    assert!(!moved.is_empty() && moved.len() < 200 && !moved.windows(3).any(|at| at == b"\x1b_G"));
    // Something over all of them, and away again: no pixel is sent.
    rig.send_all(&[], 3000);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (6, 0));
    let back = rig.send_all(&tiles, usize::MAX);
    assert!(rig.kitty.placed.len() == 6 && back < 1500, "{back}");
}

#[test]
fn a_gallery_lies_over_the_picture_and_leaves_nothing_behind() {
    let mut rig = Rig::new();
    let picture = graphic(Protocol::Kitty, 1, AREA);
    rig.send(Some(&picture), usize::MAX);
    rig.send_all(&tiles(Protocol::Kitty, 10), 3000);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (7, 6), "the first is kept");
    // Another page.
    rig.send_all(&tiles(Protocol::Kitty, 20), 3000);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (7, 6));
    // Fewer pictures, while one of them is on its way.
    let next = tiles(Protocol::Kitty, 30);
    rig.kitty.read(
        &rig.screen
            .compose(
                &Frame { buffer: &rig.buffer, cursor: None, first: &[], late: &[], graphics: &next },
                Allowance { text: usize::MAX, paced: 2000, atomic: 0 },
            )
            .bytes,
    );
    rig.send_all(&next[..2], 3000);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (3, 2));
    // Closed: the first picture again, and it alone, for a few bytes.
    let back = rig.send_all(std::slice::from_ref(&picture), usize::MAX);
    assert_eq!((rig.kitty.pictures.len(), rig.kitty.placed.len()), (1, 1));
    assert!(back < 600, "{back}");
}

#[test]
fn pictures_in_one_piece_come_one_by_one_as_the_link_takes_them() {
    for protocol in [Protocol::Sixel, Protocol::Iterm2] {
        let mut rig = Rig::new();
        let tiles = tiles(protocol, 1);
        let most = tiles.iter().map(|tile| tile.data.len()).max().unwrap();
        for n in 1..=tiles.len() {
            let sent = rig
                .show_all(&tiles, Allowance { text: usize::MAX, paced: 5000, atomic: most + 200 })
                .bytes
                .len();
            assert!(sent > most / 2 && sent < 2 * most, "{protocol:?} {n}: {sent} of {most}");
        }
        assert!(rig.show_all(&tiles, Allowance::ALL).bytes.is_empty(), "{protocol:?}");
        let fewer = rig.show_all(&tiles[..3], Allowance::ALL).bytes;
        assert!(!fewer.is_empty() && fewer.len() < 600, "{protocol:?}: {}", fewer.len());
    }
}
