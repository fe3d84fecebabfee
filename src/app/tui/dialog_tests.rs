//! A dialog is one file: what it needs of the workbench, and what the workbench does with it.

use crossterm::event::{Event, KeyCode, KeyEvent, MouseButton, MouseEvent, MouseEventKind};
use linden_terminal::input::Shortcut;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::chrome::popup::popup;
use super::command::Context;
use super::dialog::{After, Dialog, Dialogs};
use super::effect::{Effect, Effects};
use super::layout::{Target, View};
use super::model::Model;
use super::testing::Bench;
use super::update::Msg;

/// Keeps what it is told, and paints it.
#[derive(Default)]
struct Diary {
    heard: Vec<String>,
}

impl Diary {
    fn hear(&mut self, model: &Model, what: String) -> After {
        assert!(model.dialogs.top::<Self>().is_none(), "it is off the stack while it acts");
        self.heard.push(what);
        After::Stays
    }
}

impl Dialog<Model> for Diary {
    fn context(&self) -> Context {
        Context::new(99, "diary", "In the diary")
    }

    fn paint(&self, model: &Model, body: Rect, buffer: &mut Buffer, view: &mut View) {
        let inner = popup(model, "Diary", body, buffer, view);
        for (i, (y, what)) in (inner.y..inner.bottom()).zip(&self.heard).enumerate() {
            view.regions.push((Rect { y, height: 1, ..inner }, Target::Dialog(Some(i))));
            buffer.set_stringn(inner.x, y, what, inner.width.into(), model.config.theme.popup);
        }
    }

    fn key(&mut self, model: &mut Model, key: KeyEvent, effects: &mut Effects) -> After {
        if key.code == KeyCode::Char('!') {
            effects.push(Effect::Redraw);
            model.dialogs.open(Self { heard: vec!["second".to_owned()] });
            return After::Closes;
        }
        self.hear(model, format!("key {}", Shortcut::from(key)))
    }

    fn paste(&mut self, model: &mut Model, text: &str, _effects: &mut Effects) -> After {
        self.hear(model, format!("paste {text}"))
    }

    fn click(&mut self, model: &mut Model, spot: usize, _mouse: MouseEvent, _effects: &mut Effects) -> After {
        self.hear(model, format!("click {spot}"))
    }

    fn wheel(&mut self, model: &mut Model, spot: Option<usize>, down: bool) {
        self.hear(model, format!("wheel {spot:?} {down}"));
    }

    fn cancel(&mut self, model: &mut Model, _effects: &mut Effects) {
        model.say(format!("{} entries", self.heard.len()));
    }
}

fn open() -> Bench {
    let mut bench = Bench::grown(100, 30).without_pictures();
    bench.model.dialogs.open(Diary::default());
    bench.msg(Msg::Tick);
    bench
}

fn heard(bench: &Bench) -> &[String] {
    &bench.model.dialogs.top::<Diary>().unwrap().heard
}

#[test]
fn a_dialog_hears_what_is_typed_pasted_and_done_with_the_mouse() {
    let mut bench = open();
    // Keys of the panes beneath mean nothing here.
    bench.keys("q j");
    bench.msg(Msg::Input(Event::Paste("two words".to_owned())));
    bench.mouse(MouseEventKind::Down(MouseButton::Left), 5, 2);
    bench.mouse(MouseEventKind::Down(MouseButton::Left), 5, 20);
    bench.mouse(MouseEventKind::ScrollDown, 5, 1);
    bench.mouse(MouseEventKind::ScrollUp, 5, 20);
    bench.mouse(MouseEventKind::Drag(MouseButton::Left), 5, 1);
    let expected = ["key q", "key j", "paste two words", "click 1", "wheel Some(0) true", "wheel None false"];
    assert_eq!(heard(&bench), expected);
    let screen = bench.screen();
    assert!(screen.contains("Diary") && screen.contains("paste two words"), "{screen}");
    assert!(bench.effects.is_empty() && bench.model.context().id() == "diary");
}

#[test]
fn a_dialog_opens_another_and_closes() {
    let mut bench = open();
    bench.keys("a !");
    assert_eq!(heard(&bench), ["second"]);
    assert!(matches!(bench.effects[..], [Effect::Redraw]));
    bench.keys("ctrl-c");
    assert!(bench.model.dialogs.is_empty());
    assert_eq!(bench.model.message.as_ref().unwrap().text, "1 entries");
}

#[test]
fn what_is_opened_meanwhile_lies_above() {
    let mut dialogs = Dialogs::<Model>::default();
    dialogs.open(Diary { heard: vec!["lower".to_owned()] });
    let (place, lower) = dialogs.take().unwrap();
    assert!(dialogs.is_empty() && dialogs.take().is_none());
    dialogs.open(Diary { heard: vec!["upper".to_owned()] });
    dialogs.put_back(place, lower);
    assert_eq!(dialogs.top::<Diary>().unwrap().heard, ["upper"]);
    assert_eq!(dialogs.find::<Diary>().unwrap().heard, ["lower"]);
    assert_eq!(dialogs.iter().count(), 2);
    dialogs.close::<Diary>();
    assert!(dialogs.last().is_none());
}

#[test]
fn dialogs_over_a_network_have_the_height_of_the_terminal_and_lines_that_are_read() {
    let says = [("COLORTERM", "truecolor"), ("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22")];
    for (columns, rows) in [(80, 24), (120, 40), (200, 60), (40, 12)] {
        let mut bench = Bench::on(columns, rows, &says, "auto").without_pictures().with_tree();
        for focus in ["", "tab", "tab tab"] {
            bench.keys(focus);
            let body = bench.model.popup_body();
            assert!(body.width >= 62.min(columns) && body.height >= rows - 3, "{columns}×{rows}: {body}");
            let picture = super::picture::area(&bench.model).unwrap_or_default();
            let hidden = picture.intersection(body).area();
            assert!(columns < 100 || hidden * 2 < picture.area(), "{columns}×{rows}: most of it stays");
            for key in ["e", ":", "?"] {
                bench.keys(key);
                let spots = bench.screen().lines().filter(|line| line.contains('│')).count();
                assert!(spots + 6 >= usize::from(rows), "{columns}×{rows} {key}: {}", bench.screen());
                bench.keys("esc");
            }
        }
    }
}

#[test]
fn what_is_said_above_a_line_takes_pixels_off_what_it_lies_over() {
    let mut bench = Bench::grown(80, 24).without_pictures();
    let picture = super::picture::area(&bench.model).unwrap();
    let hides = |bench: &Bench| bench.paint().1.covers.iter().any(|cover| cover.intersects(picture));
    bench.keys("s");
    assert!(!hides(&bench), "one row lies over the scale");
    bench.keys("ctrl-u").types(&format!("/{}x.toml", "some/folder/".repeat(9)));
    assert!(hides(&bench), "{}", bench.screen());
    let screen = bench.screen();
    let words = screen.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("goes to /some/folder") && screen.contains("folder/x.toml\n"), "{screen}");
}

#[test]
fn help_opens_in_every_mode_at_its_section_and_goes_back_to_it() {
    for (tree, open) in [
        ("abop-stochastic", "v"),
        ("abop-stochastic", "e"),
        ("abop-stochastic", "a"),
        ("abop-stochastic", "a w"),
        ("abop-stochastic", "d"),
        ("simple", "A"),
    ] {
        for key in ["?", "f1"] {
            let mut bench = Bench::new(120, 40).without_pictures().with_plain(tree);
            bench.keys(open);
            let (context, screen) = (bench.model.context(), bench.screen());
            assert!(!context.is_below_dialogs(), "{open}");
            assert!(screen.lines().last().unwrap().contains("? Help"), "{open}: {screen}");
            bench.keys(key);
            let page = bench.model.dialogs.top::<super::chrome::Page>().unwrap();
            let first = format!("{:?}", page.lines[0]);
            assert!(first.contains(context.title()), "{open}: {first}");
            bench.keys(key);
            assert_eq!((bench.model.context(), bench.screen()), (context, screen), "{open}");
        }
    }
    // Where text is typed a question mark is text, and F1 helps.
    for open in ["/", ":", "x", "a c"] {
        let mut bench = Bench::new(120, 40).without_pictures().with_plain("abop-stochastic");
        bench.keys(open);
        let depth = bench.model.dialogs.len();
        bench.keys("?");
        assert_eq!(bench.model.dialogs.len(), depth, "{open}");
        bench.keys("f1");
        assert!(bench.model.dialogs.top::<super::chrome::Page>().is_some(), "{open}");
        bench.keys("f1");
        assert_eq!(bench.model.dialogs.len(), depth, "{open}");
    }
}

#[test]
fn questions_have_their_answers_whole_on_narrow_screens() {
    use super::testing::form::{FormBench, text};
    use super::tree::TreePlace;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("presets/mine.toml");
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, "id = \"mine\"\n[colonization]\ncrown = \"sphere\"\npoints = 200\n").unwrap();
    for columns in [80, 60] {
        let mut bench = FormBench::at(TreePlace::File(path.clone()), dir.path().to_owned());
        bench.list(&dir.path().join("presets"));
        bench.model.library.select_place(&TreePlace::File(path.clone()));
        bench.on("points").keys("right E");
        let screen = text(&bench.paint(columns, 24).0);
        // Words that are wrapped are whole.
        let words = screen.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            words.contains("y writes your changes into the file first, n opens it without them"),
            "{screen}"
        );
        assert!(words.contains("save first? y or n"), "{screen}");
        bench.keys("esc");
        bench.model.focus_on(super::layout::Pane::Presets);
        bench.keys("delete");
        let screen = text(&bench.paint(columns, 24).0);
        let words = screen.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("remove 'mine'? y or n") && words.contains("not saved are lost"), "{screen}");
        bench.keys("esc");
        bench.model.exporting.running = Some(super::model::RunningExport {
            number: 1,
            name: "a-tree-with-a-long-name.glb +2".to_owned(),
            doing: None,
            done: 0,
        });
        bench.keys("q");
        let screen = text(&bench.paint(columns, 24).0);
        assert!(screen.contains("once more cancels the running export and leaves"), "{screen}");
        let welcome = super::chrome::footer::welcome(&bench.model);
        bench.model.say(welcome);
        let screen = text(&bench.paint(columns, 24).0);
        assert!(screen.contains("? all keys"), "{screen}");
        bench.model.message = None;
        assert!(text(&bench.paint(columns, 24).0).contains("a-tree"), "the gauge is back");
    }
}
