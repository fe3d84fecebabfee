//! The dialog on screens of all sizes.

use ratatui::style::Modifier;

use super::*;

#[test]
fn the_dialog_at_80_by_24() {
    let mut bench = ExportBench::new();
    bench.model.exporting = Exporting::default();
    bench.keys("e");
    insta::assert_snapshot!(bench.text(80, 24));
}

#[test]
fn the_dialog_at_three_sizes_in_three_themes() {
    for theme in [Theme::dark(), Theme::light(), Theme::plain(false)] {
        let mut bench = ExportBench::new();
        bench.model.config.theme = theme;
        fs::write(bench.at("older-c.glb"), "").unwrap();
        bench.keys("e");
        for (columns, rows) in [(60, 16), (80, 24), (160, 50)] {
            let (buffer, view) = bench.screen(columns, rows);
            let text = text_of(&buffer);
            for words in ["Export older-c", "[x] glb", "to ", "older-c.glb", "replaces a file"] {
                assert!(text.contains(words), "{columns}×{rows} {words}\n{text}");
            }
            // The row at the cursor looks unlike the others, in any theme.
            let rows: Vec<_> =
                view.regions.iter().filter(|(_, target)| matches!(target, Target::Dialog(Some(_)))).collect();
            let at = bench.dialog().spots().iter().position(|spot| *spot == bench.dialog().cursor).unwrap();
            let looks = |wanted: bool| {
                let cell =
                    rows.iter().find(|(_, target)| (*target == Target::Dialog(Some(at))) == wanted).unwrap();
                let cell = &buffer[(cell.0.right() - 1, cell.0.y)];
                (cell.bg, cell.modifier.contains(Modifier::REVERSED))
            };
            assert_ne!(looks(true), looks(false), "{columns}×{rows:?}");
        }
        bench.keys("x");
        for (columns, rows) in [(80, 24), (160, 50), (40, 12)] {
            let text = bench.text(columns, rows);
            assert!(text.contains("Replace the file?") && text.contains("n no"), "{text}");
            // Which file, and in which directory.
            assert!(text.contains("there already in DIR: older-c.glb") || rows == 12, "{text}");
        }
    }
}

#[test]
fn estimates_are_on_screen_for_what_is_ticked() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let tree = bench.model.tree.as_ref().unwrap();
    let shown = tree.shown.as_ref().unwrap();
    let estimate = bench.dialog().estimate(shown).unwrap();
    let scene = linden::dress::dress(&shown.recipe, &shown.grown, &linden::Quiet).unwrap();
    let triangles = scene.parts.iter().map(|part| part.mesh.triangles.len() as u64).sum::<u64>();
    assert_eq!(estimate.triangles, triangles);
    let text = bench.text(100, 30);
    // The table itself, and the pictures of the bark: what older files of this tree took, within a tenth.
    let said = text.lines().find_map(|line| line.split_once("2 500 triangles, about ")).map(|(_, rest)| rest);
    let size = said.and_then(|rest| rest.split_once(" KiB")).map(|(size, _)| size.to_owned());
    let kib: f64 = size.as_ref().and_then(|size| size.parse().ok()).unwrap_or_else(|| panic!("{text}"));
    assert!((700.0..860.0).contains(&kib), "{text}");
    // One of an older tree is not told.
    bench.model.tree.as_mut().unwrap().set("seed", "99", Instant::now()).unwrap();
    let text = bench.text(100, 30);
    assert!(text.contains("still growing") && !text.contains(&format!("about {kib} KiB")), "{text}");
}

#[test]
fn no_size_panics_and_the_cursor_stays_on_screen() {
    let mut bench = ExportBench::new();
    fs::write(bench.at("older-c.glb"), "").unwrap();
    let long = bench.at(&"木".repeat(70));
    let look = |bench: &mut ExportBench| {
        for columns in (1..24).chain([40, 79, 80, 111, 400]) {
            for rows in (1..14).chain([24, 120]) {
                let (buffer, view) = bench.screen(columns, rows);
                for (area, _) in &view.regions {
                    assert_eq!(buffer.area.intersection(*area), *area, "{columns}×{rows}");
                }
                if let Some(at) = view.cursor {
                    assert!(buffer.area.contains(at.into()), "{columns}×{rows} {at:?}");
                }
            }
        }
    };
    bench.keys("e");
    look(&mut bench);
    bench.keys("x");
    look(&mut bench);
    bench.go_to(ExportSpot::Target(place_of("glb")));
    bench.keys("enter");
    bench.retype(&long);
    look(&mut bench);
    bench.keys("enter");
    look(&mut bench);
    bench.keys("x");
    look(&mut bench);
}

#[test]
fn text_from_outside_cannot_drive_the_terminal() {
    let mut bench = ExportBench::new();
    let mut last = bench.model.exporting.to_session();
    last.targets = vec![format!("{}\u{202e}/x.glb", bench.at("\u{1b}[2J"))];
    bench.model.exporting.remember(&Session { export: last, ..Session::default() });
    bench.keys("e j j");
    for keys in ["", "enter", "enter", "x"] {
        bench.keys(keys);
        let text = bench.text(160, 60);
        assert!(!text.contains('\u{1b}') && !text.contains('\u{202e}'), "{text}");
        assert!(text.contains("u{1b}"), "{text}");
    }
}

#[test]
fn while_growth_is_paused_the_dialog_says_what_files_have() {
    let mut bench = ExportBench::new();
    bench.model.growth.step = Some(1);
    bench.keys("e");
    let text = bench.text(100, 30);
    assert!(text.contains("of the grown tree, not derivation 1 of 2: age=0.5 makes that one"), "{text}");
    bench.keys("esc y");
    assert!(
        bench.said().1.starts_with("copied, of the grown tree, not derivation 1 of 2"),
        "{:?}",
        bench.said()
    );
}

#[test]
fn a_list_that_is_longer_than_its_room_says_where_it_is() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    assert!(bench.text(100, 24).contains('┃'));
    assert!(!bench.text(100, 80).contains('┃'));
}

#[test]
fn the_footer_has_the_progress_whole() {
    let mut bench = ExportBench::new();
    bench.keys("e x");
    bench.send(Msg::Export(ExportNews::Progress { doing: Phase::Write, done: 420 }));
    for columns in [60, 80, 100] {
        assert!(bench.text(columns, 24).contains("42 %"), "{columns}");
    }
}

#[test]
fn the_keys_that_matter_stay_in_the_smallest_window() {
    let mut bench = ExportBench::new();
    bench.keys("e");
    let text = bench.text(40, 12);
    let footer = text.lines().last().unwrap();
    assert!(footer.contains("x Export") && footer.contains("Esc Close"), "{text}");
    fs::write(bench.at("older-c.glb"), "before").unwrap();
    bench.keys("x");
    let text = bench.text(40, 12);
    let footer = text.lines().last().unwrap();
    for hint in ["y Yes", "n No", "Esc Close"] {
        assert!(footer.contains(hint), "{text}");
    }
}
