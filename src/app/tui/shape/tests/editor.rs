//! The grammar in its editor.

use crate::tui::effect::Effect;

use super::*;

/// The open editor.
fn editor(bench: &FormBench) -> Option<&grammar::GrammarEditor> {
    bench.model.dialogs.top()
}

#[test]
fn the_grammar_is_edited_in_place_and_grows_as_it_is_typed() {
    let mut bench = FormBench::new("abop-a");
    let before = bench.tree().grammar().unwrap().clone();
    bench.keys("x");
    assert!(editor(&bench).is_some());
    bench.keys("down end").typed("[+F]");
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F]\n");
    // What cannot be read keeps the last good grammar, and says where.
    bench.typed("[+F");
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F]\n");
    let (buffer, view) = bench.paint(100, 30);
    let shown = text(&buffer);
    assert!(shown.contains("line 2, column 21: '[' opens a branch that is never closed"), "{shown}");
    let (x, y) = underlined(&buffer).unwrap();
    assert_eq!(buffer[(x, y)].symbol(), "[");
    assert_eq!(view.cursor, Some((x + 3, y)));
    // Done goes to the mistake instead of closing.
    bench.keys("ctrl-s");
    assert_eq!(editor(&bench).unwrap().text.cursor(), (1, 20));
    bench.keys("esc");
    assert!(bench.model.dialogs.is_empty() && bench.said().contains("last rules"));
    // The text is there again with its mistake; mended, it grows.
    bench.keys("x end").typed("]").keys("ctrl-s");
    assert!(bench.model.dialogs.is_empty());
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F][+F]\n");
    // Each editing is one step of undo.
    bench.keys("u u");
    assert!(*bench.tree().grammar().unwrap() == before && !bench.tree().can_undo());
    bench.keys("ctrl-r");
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-F]F[+F]\n");
}

#[test]
fn a_text_that_can_be_read_and_does_not_grow_is_told_while_it_is_typed() {
    let mut bench = FormBench::new("abop-a");
    bench.keys("x ctrl-home ctrl-k").typed("axiom = Q").grow();
    assert!(bench.tree().fault.is_some());
    let shown = |bench: &mut FormBench| text(&bench.paint(100, 30).0);
    let words = |screen: &str| screen.split_whitespace().collect::<Vec<_>>().join(" ");
    let screen = shown(&mut bench);
    assert!(screen.contains("Grammar ● ✗ does not grow"), "{screen}");
    assert!(words(&screen).contains("the string has no F or G"), "{screen}");
    // It is said there alone, and the keys stay in sight.
    assert!(screen.contains("^S Done"), "{screen}");
    assert!(bench.model.messages.iter().any(|said| said.text.contains("no F or G")));
    // What cannot even be read is told before that.
    bench.typed("[");
    let screen = shown(&mut bench);
    assert!(words(&screen).contains("line 1, column 10: '[' opens a branch"), "{screen}");
    bench.keys("backspace backspace").typed("F").grow();
    let screen = shown(&mut bench);
    assert!(screen.contains("Grammar ─") && !screen.contains("no F or G"), "{screen}");
    assert!(screen.contains("7 811 symbols"), "{screen}");
}

#[test]
fn the_editors_own_undo_revert_and_comments() {
    let mut bench = FormBench::new("abop-a");
    let before = bench.tree().grammar().unwrap().clone();
    bench.keys("x ctrl-u");
    assert_eq!(bench.said(), "Undo typing: nothing was typed");
    bench.keys("ctrl-end").typed("// mine\n\n");
    bench.send(Msg::Input(Event::Paste("G -> FF\r\nX -> G\n".to_owned())));
    assert_eq!(bench.tree().grammar().unwrap().productions().len(), 3);
    bench.keys("ctrl-u");
    assert_eq!(bench.tree().grammar().unwrap().productions().len(), 1);
    bench.keys("ctrl-r");
    assert_eq!(bench.tree().grammar().unwrap().productions().len(), 3);
    bench.keys("ctrl-x");
    assert!(*bench.tree().grammar().unwrap() == before);
    bench.keys("ctrl-u esc x");
    let text = editor(&bench).unwrap().text.as_str().to_owned();
    assert!(text.contains("// mine\n\nG -> FF\nX -> G\n"), "comments stay with the tree: {text}");
    // Keys that mean something outside are letters here, and nothing panics on any of them.
    bench.keys("q u E / : ? tab f1 f1 f12 insert alt-x");
    assert!(editor(&bench).is_some());
    bench.keys("ctrl-c");
    assert!(bench.model.dialogs.is_empty());
}

#[test]
fn enter_on_a_rule_opens_the_editor_there_and_r_gives_the_saved_grammar_back() {
    let mut bench = FormBench::new("abop-stochastic");
    bench.on("derivations").keys("k k");
    let rule = selected_rule(&bench.model).unwrap();
    assert!(selected(&bench.model).is_none() && rule >= 2);
    bench.keys("right");
    assert!(bench.said().contains("typed"));
    bench.keys("enter");
    let (line, column) = editor(&bench).unwrap().text.cursor();
    assert_eq!(line, rule);
    assert!(column > 5);
    bench.typed("F").keys("esc");
    assert!(bench.tree().is_modified());
    let (buffer, _) = bench.paint(100, 40);
    assert!(text(&buffer).contains("●F ->"), "{}", text(&buffer));
    bench.keys("r");
    assert!(!bench.tree().is_modified());
}

#[test]
fn the_mouse_selects_rows_opens_them_and_puts_the_cursor_into_the_text() {
    let mut bench = FormBench::new("abop-a");
    let (buffer, _) = bench.paint(100, 30);
    let lines: Vec<String> = text(&buffer).lines().map(str::to_owned).collect();
    let row = lines.iter().position(|line| line.contains("F -> F[+F]F[-F]F")).unwrap() as u16;
    bench.press(10, row);
    assert_eq!(selected_rule(&bench.model), Some(1));
    bench.press(10, row);
    assert!(editor(&bench).is_some());
    let (_, view) = bench.paint(100, 30);
    let (area, _) = *view
        .regions
        .iter()
        .rev()
        .find(|(_, target)| *target == crate::tui::layout::Target::Dialog(Some(grammar::TEXT)))
        .unwrap();
    bench.press(area.x + 3, area.y);
    assert_eq!(editor(&bench).unwrap().text.cursor(), (0, 3));
    bench.press(area.right() - 1, area.bottom() - 1);
    assert_eq!(editor(&bench).unwrap().text.cursor().0, 2);
}

#[test]
fn an_editor_of_ones_own_takes_the_text_and_loses_nothing() {
    let mut bench = FormBench::new("abop-a");
    bench.keys("E");
    let Some(Effect::Edit(handed)) = bench.effects.pop() else { panic!("no text was handed over") };
    assert!(handed.starts_with("// ") && handed.ends_with("axiom = F\nF -> F[+F]F[-F]F\n"), "{handed}");
    bench.send(Msg::Edited(Ok(handed.clone())));
    assert!(!bench.tree().is_modified() && bench.said() == "the grammar is as it was");
    bench.send(Msg::Edited(Ok(handed.replace("[-F]", "[-FF]"))));
    assert_eq!(bench.tree().grammar().unwrap().to_string(), "F\nF -> F[+F]F[-FF]F\n");
    assert!(bench.model.dialogs.is_empty());
    bench.keys("u");
    assert!(!bench.tree().is_modified() && !bench.tree().can_undo());
    // A mistake comes back into linden's editor, with the whole text.
    bench.send(Msg::Edited(Ok(handed.replace("[-F]", "[-F"))));
    let opened = editor(&bench).unwrap();
    assert_eq!(opened.text.as_str(), "axiom = F\nF -> F[+F]F[-FF\n");
    assert_eq!(opened.text.cursor(), (1, 11));
    assert!(!bench.tree().is_modified());
    bench.keys("alt-e");
    let Some(Effect::Edit(handed)) = bench.effects.pop() else { panic!("no text was handed over") };
    bench.send(Msg::Edited(Ok(handed.replace("[-FF", "[-F]F"))));
    assert!(editor(&bench).unwrap().fault.is_none());
    bench.send(Msg::Edited(Err("the editor ended with 1".to_owned())));
    assert!(editor(&bench).is_some());
}

#[test]
fn colonized_trees_say_that_they_have_no_grammar() {
    let mut bench = FormBench::new("fir");
    bench.keys("x");
    assert_eq!(bench.said(), "Edit grammar: 'fir' grows without a grammar");
    bench.keys("E");
    assert_eq!(bench.said(), "Edit in $EDITOR: the preset is built in; save it as one of your own first");
    assert!(bench.effects.is_empty());
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    std::fs::write(&path, linden::preset::builtin("fir").unwrap().text).unwrap();
    let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
    bench.keys("E");
    assert!(
        matches!(&bench.effects[..], [Effect::EditFile(edited)] if *edited == path),
        "{:?}",
        bench.effects
    );
    let mesh = dir.path().join("crown.obj");
    std::fs::write(&mesh, linden::preset::builtin_file("heart.obj").unwrap()).unwrap();
    let mut bench = FormBench::at(TreePlace::File(mesh), dir.path().to_owned());
    bench.keys("E");
    assert!(bench.said().contains("a mesh or a scan") && bench.effects.is_empty(), "{}", bench.said());
}

#[test]
fn a_grammar_of_any_length_is_listed_in_a_page() {
    let rules: Vec<String> = (0..5000)
        .map(|i| format!("{} -> {}", char::from_u32(0x4e00 + i).unwrap(), "F".repeat(900)))
        .collect();
    let grammar = linden::lsystem::Grammar::new("F", &rules).unwrap();
    let (listed, more) = grammar::lines(&grammar);
    assert_eq!((listed.len(), more), (101, 4900));
    assert!(listed.iter().all(|line| line.len() < 400));
}
