//! Binary USD: what text says, and files that are broken.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use linden_base::monitor::{Monitor, Phase, Quiet};
use linden_lint::{Asset, Config, NoFiles, ReadError, lint, read};

/// The text as usd-core writes it in binary.
const USDC: &[u8] = include_bytes!("model/season.usdc");
const USDA: &str = include_str!("model/season.usda");
const SECTIONS: [&str; 6] = ["TOKENS", "STRINGS", "FIELDS", "FIELDSETS", "PATHS", "SPECS"];

/// Eight megabytes: broken files take no more.
struct Poor;

impl Monitor for Poor {
    fn is_cancelled(&self) -> bool {
        false
    }

    fn advance(&self, _: Phase, _: u64, _: Option<u64>) {}

    fn memory_limit(&self) -> u64 {
        8 << 20
    }
}

fn said(bytes: &[u8]) -> String {
    let error = read("a.usd", bytes, &NoFiles, &Poor).map(|_| ()).unwrap_err();
    assert!(!matches!(error, ReadError::Cancelled(_)));
    error.to_string()
}

/// Reads and looks at what may be broken.
fn looked_at(bytes: &[u8]) -> bool {
    match read("a.usd", bytes, &NoFiles, &Poor) {
        Ok(asset) => {
            lint(&asset, &Config::default());
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Where the table of contents has a section, and where that begins.
fn entry(name: &str) -> (usize, usize) {
    let mut named = name.as_bytes().to_vec();
    named.push(0);
    // The table stands last.
    let at = USDC.windows(named.len()).rposition(|bytes| bytes == named).unwrap();
    (at, u64::from_le_bytes(USDC[at + 16..at + 24].try_into().unwrap()) as usize)
}

fn with(at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = USDC.to_vec();
    file[at..at + bytes.len()].copy_from_slice(bytes);
    file
}

#[test]
fn binary_usd_is_the_text() {
    let shown = |asset: &Asset| format!("{asset:#?}");
    let mut text = read("a.usd", USDA.as_bytes(), &NoFiles, &Quiet).unwrap();
    let binary = read("a.usd", USDC, &NoFiles, &Quiet).unwrap();
    assert_eq!(shown(&binary), shown(&text));
    let mut package = [b"PK\x03\x04".as_slice(), &[0; 14]].concat();
    package.extend([USDC.len() as u32; 2].map(u32::to_le_bytes).concat());
    package.extend([6, 0, 0, 0]);
    package.extend(b"a.usdc");
    package.extend(USDC);
    let packed = read("a.usdz", &package, &NoFiles, &Quiet).unwrap();
    text.name = "a.usdz".to_owned();
    assert_eq!(shown(&packed), shown(&text));
}

#[test]
fn other_versions_are_named() {
    for version in [[0, 3], [0, 17], [1, 0]] {
        let said = said(&with(8, &version));
        assert!(said.contains(&format!("version {}.{}.", version[0], version[1])), "{said}");
        assert!(said.contains("usdcat"), "{said}");
    }
}

#[test]
fn cut_files_are_errors() {
    assert!(said(b"PXR-USDC\0\x08").contains("the head of the file is shorter"));
    for length in 0..USDC.len() {
        assert!(!looked_at(&USDC[..length]), "{length} bytes");
    }
    for name in SECTIONS {
        let (at, start) = entry(name);
        for (what, place, number) in [
            ("ends behind the file's end", at + 16, USDC.len() as u64),
            ("ends behind the file's end", at + 16, u64::MAX),
            ("ends behind the file's end", at + 24, u64::MAX - start as u64),
            ("ends behind the file's end", at + 24, USDC.len() as u64),
            ("is shorter than it says", at + 24, 4),
        ] {
            let said = said(&with(place, &number.to_le_bytes()));
            assert!(said.contains(&format!("the section {name} {what}")), "{name} {number}: {said}");
        }
        let said = said(&with(at, b"X"));
        assert!(said.contains(&format!("the section {name} is missing")), "{said}");
    }
}

/// What a file counts is held against its bytes before memory is taken.
#[test]
fn huge_counts_are_errors() {
    for name in SECTIONS {
        let (_, start) = entry(name);
        // Those of what is in it, and of the bytes that it is packed into.
        for (at, count) in [(0, u64::MAX), (0, 1 << 40), (0, 1 << 25), (8, u64::MAX), (8, 1 << 40)] {
            assert!(!looked_at(&with(start + at, &count.to_le_bytes())), "{name} {at} {count}");
        }
    }
    let said = said(&with(16, &u64::MAX.to_le_bytes()));
    assert!(said.contains("the table of contents begins behind the end"), "{said}");
    assert!(matches!(read("a.usd", &run_of(8 << 20), &NoFiles, &Poor), Err(ReadError::Memory(_))));
    let error = read("a.usd", &run_of(64 << 20), &NoFiles, &Quiet).unwrap_err().to_string();
    assert!(error.contains("more than 128 times its bytes"), "{error}");
}

/// A file whose names are one long run: little that is much.
fn run_of(count: usize) -> Vec<u8> {
    let run = lz4_flex::block::compress(&vec![b'a'; count]);
    let mut file = with(16, &88_u64.to_le_bytes())[..88].to_vec();
    file.extend(1_u64.to_le_bytes());
    file.extend(b"TOKENS\0\0\0\0\0\0\0\0\0\0");
    file.extend([128, 25 + run.len() as u64].map(u64::to_le_bytes).concat());
    file.extend([1, count as u64, 1 + run.len() as u64].map(u64::to_le_bytes).concat());
    file.push(0);
    file.extend(run);
    file
}

/// Any byte may be any other.
#[test]
fn changed_bytes_are_never_a_panic() {
    let (mut well, mut refused) = (0, 0);
    let mut count = |file: &[u8]| if looked_at(file) { well += 1 } else { refused += 1 };
    for (at, byte) in USDC.iter().enumerate() {
        for change in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
            count(&with(at, &[byte ^ change]));
        }
        if at + 8 <= USDC.len() {
            for number in [0, u64::MAX, 1 << 62, i64::MAX as u64, 1 << 31] {
                count(&with(at, &number.to_le_bytes()));
            }
        }
        let mut without = USDC.to_vec();
        without.remove(at);
        count(&without);
    }
    assert!(well > 1000 && refused > 1000, "{well} {refused}");
}
