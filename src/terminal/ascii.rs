//! A screen in ASCII, for terminals that show nothing else: `LANG=C`, `TERM=dumb`.
//!
//! Rules become `-`, `|` and `+`, marks become letters and signs, `é` becomes `e`. Every cell keeps its place:
//! what takes several letters is shown by its first.

use ratatui::buffer::Buffer;

use crate::screen::width;

/// What is shown for characters that no table of letters knows better.
const SIGNS: [(&str, char); 7] = [
    ("─━═░▒▓", '-'),
    ("│┃║▌▐", '|'),
    ("┌┐└┘├┤┬┴┼╭╮╯╰┏┓┗┛", '+'),
    ("●★✓▪•█", '*'),
    ("○·", '.'),
    ("▶▸›→", '>'),
    ("◀◂‹←", '<'),
];

/// Shows every cell in ASCII. Colours and attributes stay.
pub fn fold(buffer: &mut Buffer) {
    for cell in &mut buffer.content {
        if cell.symbol().is_ascii() {
            continue;
        }
        let is_wide = width(cell) > 1;
        let shown = match cell.symbol().chars().next() {
            Some(c) if !is_wide => ascii(c),
            // Two columns of one letter cannot be told from a word.
            _ => '?',
        };
        cell.set_char(shown);
    }
}

/// The ASCII character that stands for another one.
pub fn ascii(c: char) -> char {
    if c.is_ascii() {
        return c;
    }
    if let Some((_, sign)) = SIGNS.iter().find(|(all, _)| all.contains(c)) {
        return *sign;
    }
    match c {
        '↑' => '^',
        '↓' => 'v',
        '✗' => 'x',
        '…' => '~',
        '‖' => '=',
        '°' => 'd',
        _ => deunicode::deunicode_char(c)
            .and_then(|text| text.chars().next())
            .filter(|c| !c.is_ascii_control())
            .unwrap_or('?'),
    }
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;
    use ratatui::style::Style;

    use super::*;

    #[test]
    fn a_screen_keeps_its_places() {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 24, 1));
        buffer.set_string(0, 0, "─┬─ Bézier │ 木 ● 3×4 →…", Style::new());
        fold(&mut buffer);
        let text: String = buffer.content.iter().map(ratatui::buffer::Cell::symbol).collect();
        assert_eq!(text, "-+- Bezier | ?  * 3x4 >~");
    }

    #[test]
    fn every_character_has_one_that_can_be_typed() {
        for c in (0..=0x10_ffff_u32).filter_map(char::from_u32) {
            let shown = ascii(c);
            assert!(shown.is_ascii() && (c.is_ascii() || !shown.is_ascii_control()), "{c:?} is {shown:?}");
        }
    }
}
