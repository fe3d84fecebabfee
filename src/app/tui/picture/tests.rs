use linden::monitor::Phase;

use super::*;
use crate::jobs::HowFar;
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
    let screen = bench.screen();
    assert!(screen.contains("drawing …") && !screen.contains("├─"), "without its scale: {screen}");
    bench.settle();
    let screen = bench.screen();
    assert!(!screen.contains("drawing …") && screen.contains("├─"), "{screen}");
    bench.keys("j");
    bench.load();
    bench.msg(Msg::Grown(Err("the grammar draws nothing".to_owned())));
    assert!(standing(&bench.model).is_none());
    assert!(bench.screen().contains("the grammar draws nothing"));
}

#[test]
fn the_first_picture_is_announced_while_it_is_drawn_unless_it_cannot_be() {
    let mut bench = Bench::grown(120, 40).without_pictures();
    bench.model.picture.painted = None;
    assert!(bench.screen().contains("drawing …"), "{}", bench.screen());
    bench.msg(Msg::NotPainted("too large".to_owned()));
    assert!(!bench.screen().contains("drawing …"), "{}", bench.screen());
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

#[test]
fn a_cut_is_looked_at_from_above_moved_and_said_with_its_thickness() {
    let mut bench = Bench::new(120, 40).with_plain("simple");
    let said = |bench: &Bench| bench.model.message.as_ref().map(|said| said.text.clone()).unwrap_or_default();
    bench.keys("]");
    assert!(said(&bench).contains("Z cuts it"), "{}", said(&bench));
    bench.keys("Z").settle();
    let shown = Arc::clone(bench.model.tree.as_ref().unwrap().shown.as_ref().unwrap());
    // Cylinders go from node to node: one of the stem holds the level.
    let thickness_cm = |height_m: f32| {
        let cylinders = shown.grown.skeleton.cylinders();
        let foot = shown.grown.skeleton.positions.iter().map(|place| place.y).fold(f32::INFINITY, f32::min);
        // How far along each the level is.
        let along =
            cylinders.iter().map(|one| (foot + height_m - one.start.y) / (one.length_m * one.direction.y));
        let held = cylinders.iter().zip(along).filter(|(_, along)| (0.0..1.0).contains(along));
        let radii_m =
            held.map(|(one, along)| one.end_radii_m[0] * (1.0 - along) + one.end_radii_m[1] * along);
        200.0 * radii_m.fold(0.0, f32::max)
    };
    let told = |bench: &Bench, height: &str| {
        let screen = bench.screen();
        let rest =
            screen.split(&format!("cut at {height} m · Ø ")).nth(1).unwrap_or_else(|| panic!("{screen}"));
        rest.split(" cm").next().unwrap().parse::<f32>().unwrap()
    };
    assert!((told(&bench, "1.30") - thickness_cm(1.3)).abs() < 0.06);
    bench.keys("] ]").settle();
    assert!((told(&bench, "1.50") - thickness_cm(1.5)).abs() < 0.06);
    assert!(!bench.model.picture.painted.as_ref().unwrap().shows_person);
    bench.keys("[").settle();
    told(&bench, "1.40");
    for _ in 0..400 {
        bench.keys("]");
    }
    bench.settle();
    // Not above its top.
    assert!(told(&bench, "7.51") < 5.0);
    bench.keys("Z").settle();
    assert!(!bench.screen().contains("cut at"));
    assert!(wanted(&bench.model).unwrap().slice.is_none());
}

#[test]
fn what_is_for_scans_is_left_out_of_the_looks_of_other_trees() {
    let mut bench = Bench::grown(120, 40);
    let mut seen = Vec::new();
    for _ in 0..PictureLook::ALL.len() {
        bench.keys("c");
        seen.push(bench.model.picture.look.name());
    }
    assert!(!seen.contains(&"source") && !seen.contains(&"distance") && seen.contains(&"light"), "{seen:?}");
    let forth = seen.clone();
    bench.keys("C");
    assert_eq!(bench.model.picture.look.name(), forth[forth.len() - 2], "and back");
}

#[test]
fn growing_says_which_tree_of_several_it_is_at() {
    let mut bench = Bench::grown(100, 30);
    let mut says = |among| {
        let how_far = HowFar { stage: Phase::Sweep, done: 1200, total: Some(3400), among };
        bench.model.tree.as_mut().unwrap().growing = Some(how_far);
        bench.screen()
    };
    let one = says(None);
    assert!(one.contains("surfacing 1 200 of 3 400 axes") && !one.contains("tree 3"), "{one}");
    let several = says(Some(("tree", 3, 24)));
    assert!(several.contains("tree 3 of 24: surfacing 1 200 of 3 400 axes"), "{several}");
}

#[test]
fn a_draft_comes_first_however_long_the_tree_grew() {
    let mut bench = Bench::grown(120, 40);
    bench.keys("j");
    bench.load();
    bench.wait(Duration::from_secs(5));
    let recipe = Arc::clone(bench.model.tree.as_ref().unwrap().wanted());
    let grown = crate::jobs::grow_shown(&recipe, &crate::jobs::Watcher::idle()).unwrap();
    bench.model.picture.fast = false;
    bench.msg(Msg::Grown(grown));
    assert_eq!(wanted(&bench.model).unwrap().detail, Detail::Draft);
    bench.settle();
    let painted = bench.model.picture.painted.as_ref().unwrap();
    assert_eq!(painted.request.detail, Detail::Full);
}

#[test]
fn over_a_network_a_draft_comes_first_of_large_trees_alone() {
    for (derivations, detail) in [("2", Detail::Full), ("6", Detail::Draft)] {
        let mut bench =
            Bench::on(120, 40, &[("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22")], "auto").with_tree();
        let tree = bench.model.tree.as_mut().unwrap();
        tree.set("derivations", derivations, Instant::now()).unwrap();
        let recipe = Arc::clone(tree.wanted());
        (bench.model.picture.is_of_before, bench.model.picture.fast) = (true, false);
        bench.wait(Duration::from_secs(5));
        let grown = crate::jobs::grow_shown(&recipe, &crate::jobs::Watcher::idle()).unwrap();
        bench.msg(Msg::Grown(grown));
        assert_eq!(wanted(&bench.model).unwrap().detail, detail, "{derivations} derivations");
    }
}

#[test]
fn the_picture_of_another_tree_is_greyed_but_not_on_a_network() {
    for (says, greys) in [(&[][..], true), (&[("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22")], false)] {
        let mut bench = Bench::on(120, 40, says, "auto").with_tree();
        bench.keys("j");
        bench.load();
        assert!(!is_grey(&bench.model), "what comes at once does not flicker");
        bench.wait(GREYS);
        assert_eq!(is_grey(&bench.model), greys);
        bench.settle();
        assert!(!is_grey(&bench.model));
    }
}
