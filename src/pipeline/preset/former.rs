//! Documents of earlier versions, read as what they mean today.
//!
//! A knob that was renamed has its earlier name as an alias in its row. What was moved as a whole stands
//! here.

use linden_base::document::{Datum, Entry, Node};
use toml_edit::DocumentMut;

/// Points stood in `[colonization]` under this key.
const POINTS: &str = "scan";

/// What else a crown may be: with one of these, the points are an error as they ever were.
const CROWNS: [&str; 2] = ["crown", "envelope"];

/// Makes today's document of an earlier one.
pub(super) fn renew(document: &mut Node) {
    let Datum::Table(entries) = &mut document.datum else { return };
    if entries.iter().any(|entry| entry.key == POINTS) {
        return;
    }
    let Some(table) = entries.iter_mut().find(|entry| entry.key == "colonization") else { return };
    let Datum::Table(keys) = &mut table.node.datum else { return };
    let is_crown = |entry: &Entry| CROWNS.contains(&entry.key.as_str());
    if keys.iter().any(is_crown) {
        return;
    }
    if let Some(points) = keys.iter_mut().find(|entry| entry.key == POINTS) {
        "file".clone_into(&mut points.key);
        POINTS.clone_into(&mut table.key);
    }
}

/// The same for a document that is to be edited.
pub(super) fn renew_text(document: &mut DocumentMut) {
    let is_former = document.get("colonization").and_then(|item| item.as_table_like()).is_some_and(|table| {
        table.contains_key(POINTS) && !CROWNS.iter().any(|crown| table.contains_key(crown))
    });
    if !is_former || document.contains_key(POINTS) {
        return;
    }
    let Some(mut item) = document.remove("colonization") else { return };
    if let Some(table) = item.as_table_like_mut()
        && let Some(file) = table.remove(POINTS)
    {
        table.insert("file", file);
    }
    document.insert(POINTS, item);
}

#[cfg(test)]
mod tests {
    use crate::preset::{Preset, ScanSettings};

    /// As recipes had scans before these had a table of their own: with all knobs of crowns.
    const FORMER: &str = "id = \"a\"\n\n# measured\n[colonization]\nscan = \"a.xyz\" # in spring\npoints = 2000\n\
                          crown_base = \"auto\"\nclumps = 0\nkill = \"4D\"\ncontract = false\nscale = 0.01\n";

    #[test]
    fn a_scan_among_the_crowns_is_read_as_a_scan() {
        let preset = Preset::from_toml(FORMER).unwrap();
        let scan = preset.settings::<ScanSettings>().unwrap();
        assert_eq!((scan.file.as_str(), scan.contract, scan.scale), ("a.xyz", false, Some(0.01)));
        assert_eq!(preset.files(), ["a.xyz"]);
        let json = r#"{"id":"a","colonization":{"scan":"a.xyz","points":2000,"shell_density":0.0}}"#;
        assert_eq!(Preset::from_json(json).unwrap().files(), ["a.xyz"]);
        let crown = "id = \"a\"\n[colonization]\ncrown = \"dome\"\ncontract = true\nstems = \"auto\"\n";
        assert!(Preset::from_toml(crown).is_ok(), "knobs of scans mean nothing to a crown");
        let both = "id = \"a\"\n[colonization]\ncrown = \"dome\"\nscan = \"a.xyz\"\n";
        let message = Preset::from_toml(both).unwrap_err().to_string();
        assert!(
            message.starts_with("4:1: there is no 'scan' in [colonization]; points have a table"),
            "{message}"
        );
    }

    #[test]
    fn such_a_document_is_edited_into_one_of_today() {
        let mut preset = Preset::from_toml(FORMER).unwrap();
        preset.set("kill", "5D").unwrap();
        let edited = preset.edit_toml(FORMER).unwrap();
        assert_eq!(Preset::from_toml(&edited).unwrap(), preset);
        assert!(edited.contains("[scan]") && edited.contains("file = \"a.xyz\""), "{edited}");
        assert!(edited.contains("kill = \"5D\"") && !edited.contains("colonization"), "{edited}");
    }
}
