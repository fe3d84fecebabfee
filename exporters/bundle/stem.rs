//! Names of side files, such that every reader finds them.
//!
//! A name with a space ends early for some OBJ readers, `#` starts a comment or a fragment, `@` and
//! `<UDIM>` mean something in USD, `%` and `\` in URIs; so names of side files are of letters, digits
//! and a few marks. Letters are any script's: all clients read UTF-8.

use std::path::Path;

/// File systems take 255 bytes for a name; this leaves room for what follows the stem.
const LONGEST: usize = 160;

/// The stem of a target, made plain. One that had to be changed gets a hash of what it was, so that
/// the side files of `fir #1` and `fir @1` are not the same.
pub(super) fn plain(target: &Path) -> String {
    let stem = target.file_stem().unwrap_or_default();
    let text = stem.to_string_lossy();
    let mut plain = plain_suffix(&text);
    while plain.len() > LONGEST {
        plain.pop();
    }
    if plain != text || plain.starts_with('.') {
        plain = format!("{}-{:08x}", plain.trim_start_matches('.'), fnv1a(stem.as_encoded_bytes()));
    }
    plain
}

/// `text` with `_` for everything that could mean something to a reader.
pub(super) fn plain_suffix(text: &str) -> String {
    text.chars().map(|c| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '_' }).collect()
}

/// FNV-1a, 32 bits (draft-eastlake-fnv).
fn fnv1a(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |hash, &byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_stay() {
        for name in ["fir", "fir.v2", "Linde-3_b+", "Ölbaum", "松"] {
            assert_eq!(plain(Path::new(&format!("{name}.obj"))), name);
        }
    }

    #[test]
    fn strange_names_become_plain_and_stay_apart() {
        let strange = ["a b", "a#b", "a@b", "a\nb", "a'b", "a\"b", "a%b", "a\\b", "a<b", "a\u{301}b", ".a"];
        let mut seen: Vec<_> = strange.iter().map(|s| plain(Path::new(&format!("{s}.obj")))).collect();
        for name in &seen {
            assert!(name.chars().all(|c| c.is_alphanumeric() || "-_".contains(c)), "{name}");
        }
        seen.sort();
        seen.dedup();
        assert_eq!(seen.len(), strange.len());
    }

    #[test]
    fn long_names_leave_room() {
        let name = plain(Path::new(&("木".repeat(80) + ".obj")));
        assert!(name.len() < 180 && name.starts_with('木'), "{name}");
    }

    #[test]
    fn the_hash_is_the_published_one() {
        assert_eq!(fnv1a(b""), 0x811c_9dc5);
        assert_eq!(fnv1a(b"foobar"), 0xbf9c_f968);
    }
}
