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

#[test]
fn levels_of_detail_are_gone_through_and_are_those_of_an_export() {
    let mut bench = Bench::new(120, 40).with("dressed-bush");
    bench.keys("D");
    let said = bench.model.message.clone().unwrap().text;
    assert!(said.contains("one level of detail"), "{said}");
    let now = bench.model.now;
    bench.model.tree.as_mut().unwrap().set("lods", "2", now).unwrap();
    bench.settle();
    let recipe = Arc::clone(bench.model.tree.as_ref().unwrap().wanted());
    let grown = linden::grow::grow(&recipe, &linden::Quiet).unwrap();
    let exported = linden::dress::levels(&recipe, &grown, &linden::Quiet).unwrap();
    let count = |level: usize| -> u64 {
        let parts = &exported.levels[level].scene.parts;
        parts.iter().map(|part| part.mesh.triangles.len() as u64).sum()
    };
    assert!(count(1) < count(0));
    for level in 0..2 {
        bench.keys("D").settle();
        let painted = bench.model.picture.painted.as_ref().unwrap();
        assert_eq!(painted.level, Some((level, count(level))));
        assert!(bench.screen().contains(&format!("level {level}: ")), "{}", bench.screen());
    }
    bench.keys("D").settle();
    assert_eq!(bench.model.picture.painted.as_ref().unwrap().level, None);
}

#[test]
fn what_stands_in_the_way_is_shown_and_framed_until_it_is_hidden() {
    let mut bench = Bench::new(120, 40).without_pictures().with_plain("around-the-stone");
    let shown = Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    let extent = |bench: &Bench| wanted(&bench.model).unwrap().camera.extent.unwrap();
    assert!(wanted(&bench.model).unwrap().obstructions && bench.screen().contains("· obstacle"));
    // The stone is as high as the tree, but for its branches above; what is framed holds all of it.
    let stone = &shown.obstructions[0].positions;
    let top = stone.iter().map(|place| place.y).fold(f32::NEG_INFINITY, f32::max);
    let low = stone.iter().map(|place| place.y).fold(f32::INFINITY, f32::min);
    assert!(extent(&bench).top >= top && extent(&bench).bottom <= low);
    bench.keys("W");
    assert!(!wanted(&bench.model).unwrap().obstructions && !bench.screen().contains("· obstacle"));
    assert_eq!(extent(&bench), shown.extent(Framed::Tree, true));
    assert!(bench.model.message.as_ref().unwrap().text.contains("hidden"));
    let mut bench = Bench::grown(120, 40);
    bench.keys("W");
    let said = bench.model.message.clone().unwrap().text;
    assert!(said.contains("nothing stands in the way here"), "{said}");
}
