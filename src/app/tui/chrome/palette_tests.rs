use super::Palette;
use crate::tui::chrome::prompt;
use crate::tui::effect::Effect;
use crate::tui::export::EXPORT_CONTEXT;
use crate::tui::testing::Bench;
use crate::tui::tree::TreePlace;

#[test]
fn formats_settings_and_files_are_within_reach() {
    let mut bench = Bench::grown(110, 34).without_pictures();
    bench.keys(":").types("usda").keys("enter");
    assert_eq!(bench.model.context(), EXPORT_CONTEXT);
    assert!(bench.screen().contains("[x] usda"), "{}", bench.screen());
    bench.keys("esc :").types("theme light");
    assert!(bench.screen().contains("becomes light"), "{}", bench.screen());
    bench.keys("enter");
    assert_eq!(bench.model.config.settings.theme, "light");
    assert!(matches!(bench.effects.last(), Some(Effect::ApplySettings)));
    // A setting without a value waits for one; a wrong one says what it takes.
    bench.keys(":").types("scale_bar").keys("enter");
    assert_eq!(bench.model.context(), prompt::CONTEXT);
    bench.types("maybe").keys("enter");
    assert!(bench.model.message.as_ref().is_some_and(|said| said.text.contains("scale_bar")));
    bench.keys("esc :").types("~/trees/oak.toml").keys("enter");
    let opened = bench.effects.last();
    assert!(matches!(opened, Some(Effect::Load(TreePlace::File(path))) if path.ends_with("trees/oak.toml")));
}

#[test]
fn ages_are_shown_one_after_the_other() {
    let mut bench = Bench::grown(110, 34).without_pictures();
    let text = "id = \"a\"\n[colonization]\ncrown = \"sphere\"\npoints = 60\n[bark]\nmoss = 0.5\n\
                [age.young]\nage = 0.3\nmoss = 0\n[age.half_grown]\nage = 0.6\n[age.grown]\n";
    let preset = linden::preset::Preset::from_toml(text).unwrap();
    bench.model.tree = Some(crate::tui::tree::Tree::new(
        TreePlace::File("a.toml".into()),
        linden::recipe::Recipe::new(preset),
    ));
    let knobs = |bench: &Bench| {
        let preset = bench.model.tree.as_ref().unwrap().preset();
        ["age", "moss"].map(|name| preset.text_of(&preset.find_knob(name).unwrap()).unwrap())
    };
    for (typed, expected) in [
        ("age young", ["0.3", "0"]),
        ("age half", ["0.6", "0.5"]),
        ("age young", ["0.3", "0"]),
        ("age grown", ["1", "0.5"]),
    ] {
        bench.keys(":").types(typed);
        assert!(bench.screen().contains("age half grown") || typed != "age half", "{}", bench.screen());
        bench.keys("enter");
        assert_eq!(knobs(&bench), expected, "{typed}");
    }
    // What was turned by hand besides stays.
    bench.model.tree.as_mut().unwrap().set("points", "70", std::time::Instant::now()).unwrap();
    bench.keys(":").types("age young").keys("enter");
    let preset = bench.model.tree.as_ref().unwrap().preset();
    assert_eq!(preset.text_of(&preset.find_knob("points").unwrap()).as_deref(), Some("70"));
}

#[test]
fn a_preset_is_found_by_what_is_told_of_it() {
    let mut bench = Bench::new(100, 30).without_pictures();
    bench.keys(":").types("crataegus");
    let palette = bench.model.dialogs.top::<Palette>().unwrap();
    assert_eq!(palette.found()[0].choice.title, "so-windswept");
}

#[test]
fn a_whole_name_comes_before_what_merely_has_its_letters() {
    for (typed, first) in
        [("fir", "fir"), ("season", "season"), ("seed", "seed"), ("age", "age"), ("PNG", "png")]
    {
        let mut bench = Bench::new(100, 30).without_pictures().with_plain("silver-birch");
        bench.keys(":").types(typed);
        let palette = bench.model.dialogs.top::<Palette>().unwrap();
        assert_eq!(palette.found()[0].choice.title, first, "{typed}");
    }
}

#[test]
fn an_age_that_the_plant_does_not_name_is_told_with_those_that_it_does() {
    let mut bench = Bench::new(110, 34).without_pictures().with_plain("silver-birch");
    let named: Vec<String> =
        bench.model.tree.as_ref().unwrap().preset().ages().iter().map(|age| age.name.clone()).collect();
    assert!(named.len() > 1);
    bench.keys(":").types("age ancient");
    let words = |bench: &Bench| bench.screen().split_whitespace().collect::<Vec<_>>().join(" ");
    for name in &named {
        assert!(words(&bench).contains(name), "while it is typed: {}", bench.screen());
    }
    bench.keys("enter");
    assert_eq!(bench.model.context(), prompt::CONTEXT, "it can be typed again");
    let said = bench.model.message.as_ref().unwrap().text.clone();
    assert!(said.contains("has no age 'ancient'") && named.iter().all(|name| said.contains(name)), "{said}");
    // What the answer offers is taken.
    let knob = |bench: &Bench, name: &str| {
        let preset = bench.model.tree.as_ref().unwrap().preset();
        preset.text_of(&preset.find_knob(name).unwrap()).unwrap()
    };
    let (opened_years, opened_age) = (knob(&bench, "years"), knob(&bench, "age"));
    assert!(opened_years != "9" && opened_age != "0.5", "{opened_years} {opened_age}");
    // One after the other: none stays when the next one is shown.
    for (typed, years, age) in [
        ("age 9y", "9", &*opened_age),
        ("age half=0.5", &*opened_years, "0.5"),
        ("age 9y", "9", &*opened_age),
        ("age grown", &*opened_years, &*opened_age),
    ] {
        bench.keys("ctrl-u").types(typed).keys("enter");
        assert!(bench.model.dialogs.is_empty(), "{typed}: {:?}", bench.model.message);
        assert_eq!((&*knob(&bench, "years"), &*knob(&bench, "age")), (years, age), "{typed}");
        bench.keys(":");
    }
    // A share alone is a value of the knob, as before.
    bench.keys("ctrl-u").types("age 0.7").keys("enter");
    assert_eq!(knob(&bench, "age"), "0.7");
    // A plant that names none is shown at typed ages all the same.
    let mut bench = Bench::new(110, 34).without_pictures().with_plain("so-hazel");
    let (opened_years, opened_age) = (knob(&bench, "years"), knob(&bench, "age"));
    for (typed, years, age) in [
        ("age half=0.5", &*opened_years, "0.5"),
        ("age 9y", "9", &*opened_age),
        ("age half=0.5", &*opened_years, "0.5"),
    ] {
        bench.keys(":").types(typed).keys("enter");
        assert_eq!((&*knob(&bench, "years"), &*knob(&bench, "age")), (years, age), "{typed}");
    }
}

#[test]
fn what_the_row_has_no_room_for_is_said_below_the_list() {
    let mut bench = Bench::grown(80, 24).without_pictures();
    bench.keys(":").types("copy command");
    let words = bench.screen().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("(through the terminal, so over SSH too)"), "{}", bench.screen());
}

#[test]
fn a_high_terminal_lists_more() {
    let rows = |rows: u16| {
        let mut bench = Bench::grown(120, rows).without_pictures();
        bench.keys(":");
        bench
            .model
            .regions
            .iter()
            .filter(|(_, target)| matches!(target, crate::tui::layout::Target::Dialog(Some(_))))
            .count()
    };
    assert!(rows(60) >= 40 && rows(24) >= 14 && rows(12) >= 5, "{} {} {}", rows(60), rows(24), rows(12));
}
