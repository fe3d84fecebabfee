//! Inputs that once did not end, or not in any time that a user waits: too large for the corpus.

use linden::preset::builtin;

/// Those of a target, and what each is.
pub fn cases(target: &str) -> Vec<(&'static str, Vec<u8>)> {
    match target {
        "grammar" => vec![("a million signs", format!("F({}1)", "-".repeat(1_000_000)).into_bytes())],
        "text" => {
            let text = format!("axiom=F({}1)\nangle=90\nF=FF\n", "-".repeat(1_000_000));
            vec![("a million signs", text.into_bytes())]
        }
        // As scanners write rays that met nothing.
        "scan" => {
            let stem = include_str!("corpus/scan/stem.xyz");
            vec![("80000 rows without a return", format!("{stem}{}", "0 0 0\n".repeat(80_000)).into_bytes())]
        }
        "tree" => {
            let grove = builtin("grove").expect("it is built in").text;
            let beyond = grove.replacen("root = [3.6, 0, 1.2]", "root = [3.6, 1e60, 0]", 1);
            assert_ne!(beyond, grove, "its second tree stands elsewhere now");
            vec![("a root beyond all places", beyond.into_bytes())]
        }
        _ => Vec::new(),
    }
}
