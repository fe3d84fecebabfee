use super::*;
use crate::tui::testing::Bench;
use crate::tui::update::Msg;

#[test]
fn the_last_picture_stands_until_the_next_is_there_and_goes_where_none_will_come() {
    let mut bench = Bench::grown(120, 40);
    let before = standing(&bench.model).unwrap().request.clone();
    bench.keys("j");
    bench.load();
    assert!(bench.model.tree.as_ref().unwrap().shown.is_none(), "the next tree has not grown yet");
    assert!(standing(&bench.model).unwrap().request.is_of(&before));
    assert!(bench.screen().contains("├─"), "with its scale");
    bench.msg(Msg::Grown(Err("the grammar draws nothing".to_owned())));
    assert!(standing(&bench.model).is_none());
    assert!(bench.screen().contains("the grammar draws nothing"));
}
