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
