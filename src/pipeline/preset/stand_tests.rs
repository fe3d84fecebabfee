//! `[[self-organizing.tree]]` and `[[self-organizing.obstacle]]` in documents.

use super::{Neighbour, ObstacleSolid, Preset, SelfOrganizing};
use linden_growth::Meet;

fn document(trees: &str) -> String {
    format!("id = \"a\"\n[self-organizing]\nyears = 9\n{trees}")
}

#[test]
fn a_stand_survives_writing_and_reading() {
    let trees = "[[self-organizing.tree]]\nat = [3, 0, -1.5] # beside it\n[[self-organizing.tree]]\nat = \"-2,0,0.25\"\nfelled = 7\n";
    let text = document(trees);
    let preset = Preset::from_toml(&text).unwrap();
    let stand = |preset: &Preset| preset.settings::<SelfOrganizing>().unwrap().stand.clone();
    let felled = Neighbour { at: [-2.0, 0.25], felled_in: 7 };
    assert_eq!(stand(&preset), [Neighbour::at([3.0, -1.5]), felled]);
    let described = preset.generator.describe(&linden_base::input::Inputs::new());
    assert_eq!(described[0].lines, ["2 at 3, -1.5", "3 at -2, 0.25, felled in year 7"]);
    let written = preset.to_toml().unwrap();
    let again = Preset::from_toml(&written).unwrap_or_else(|fault| panic!("{fault}: {written}"));
    assert_eq!(again, preset);
    assert_eq!(Preset::from_json(&serde_json::to_string(&preset).unwrap()).unwrap(), preset);
    // Another knob leaves the trees as they were written; a tree of another age keeps its neighbours.
    let mut older = preset.clone();
    older.set("years", "12").unwrap();
    assert_eq!(older.edit_toml(&text).unwrap(), text.replace("years = 9", "years = 12"));
    let young = older.generator.at_step(4).unwrap();
    assert_eq!(young.downcast_ref::<SelfOrganizing>().unwrap().stand, stand(&preset));
}

#[test]
fn what_is_wrong_with_a_tree_of_a_stand_is_said_with_its_place() {
    for (trees, place, said) in [
        ("[[self-organizing.tree]]\n", "", "further tree 1 has no 'at': say where it stands"),
        (
            "[[self-organizing.tree]]\nat = [1, 2, 3]",
            "5:6",
            "at 1,2,3, but trees stand on the ground: y must be 0",
        ),
        ("[[self-organizing.tree]]\nat = [1, 2]", "5:6", "three numbers"),
        ("[[self-organizing.tree]]\nat = [1, 0, 2e9]", "5:6", "within ±1e9"),
        ("[[self-organizing.tree]]\nat = \"auto\"", "5:6", "'auto' is not"),
        ("[[self-organizing.tree]]\nta = [1, 0, 3]", "5:1", "no 'ta'; it may have: at, felled"),
        ("[[self-organizing.tree]]\nat = [1, 0, 3]\nfelled = 1.5", "6:10", "a whole number"),
        ("tree = 3", "4:8", "expected tables, each headed [[self-organizing.tree]]"),
    ] {
        let message = Preset::from_toml(&document(trees)).unwrap_err().to_string();
        let is_there = place.is_empty() || message.starts_with(&format!("{place}: "));
        assert!(is_there && message.contains(said), "{trees}: {message}");
    }
    let many = "[[self-organizing.tree]]\nat = [1, 0, 3]\n".repeat(10_000);
    let message = Preset::from_toml(&document(&many)).unwrap_err().to_string();
    assert!(
        message.contains("10000 further trees are more than the 9999 that a stand may have"),
        "{message}"
    );
}

#[test]
fn obstacles_survive_writing_and_reading() {
    let text = document(
        "[[self-organizing.obstacle]]\nbox = [0.3, 3, 8] # a wall\nat = [2, 0, 0]\nturn = -30\n\
         [[self-organizing.obstacle]]\ncrown = \"sphere\"\ncrown_radius = 0.5\nmeet = \"stop\"\n\
         [[self-organizing.obstacle]]\nmesh = \"rock.obj\"\nscale = 2\n",
    );
    let preset = Preset::from_toml(&text).unwrap();
    let obstacles = &preset.settings::<SelfOrganizing>().unwrap().obstacles;
    assert_eq!(obstacles[0].solid, ObstacleSolid::Box([0.3, 3.0, 8.0]));
    assert_eq!((obstacles[0].at, obstacles[0].turn_deg), (Some([2.0, 0.0, 0.0]), -30.0));
    let said: Vec<String> = obstacles.iter().map(super::Obstacle::describe).collect();
    assert_eq!(said, ["box", "sphere", "'rock.obj'"]);
    assert_eq!([0, 1, 2].map(|i| obstacles[i].meet), [Meet::Around, Meet::Stop, Meet::Around]);
    assert_eq!(obstacles[2].scale, 2.0);
    assert_eq!(preset.files(), ["rock.obj"]);
    let written = preset.to_toml().unwrap();
    let again = Preset::from_toml(&written).unwrap_or_else(|fault| panic!("{fault}: {written}"));
    assert_eq!(again, preset);
    assert_eq!(Preset::from_json(&serde_json::to_string(&preset).unwrap()).unwrap(), preset);
    let mut older = preset.clone();
    older.set("years", "12").unwrap();
    assert_eq!(older.edit_toml(&text).unwrap(), text.replace("years = 9", "years = 12"));
}

#[test]
fn what_is_wrong_with_an_obstacle_is_said_with_its_place() {
    for (keys, place, said) in [
        ("at = [1, 0, 0]", "5:1", "obstacle 1 has neither 'box', 'crown' nor 'mesh': say what it is"),
        ("box = [1, 2, 3]\ncrown = \"dome\"", "6:1", "both 'box' and 'crown'; keep one"),
        ("crown = \"dome\"\nmesh = \"a.obj\"", "6:1", "both 'crown' and 'mesh'"),
        ("box = [1, 0, 3]", "5:7", "is 1,0,3 m; its width, height and depth must be at least 0.001 m"),
        ("box = [1, -2, 3]", "5:7", "at least 0.001 m"),
        ("box = 3", "5:7", "box"),
        ("crown = \"rock.obj\"", "5:9", "names it in place of a shape: mesh"),
        ("crown = \"dome\"\nmeet = \"go\"", "6:8", "'go' is not around | stop"),
        ("crown = \"dome\"\nscael = 2", "6:1", "did you mean 'scale'"),
        ("box = [1, 2, 3]\ncrown_radius = 2", "6:1", "obstacle 1 has no 'crown_radius'"),
    ] {
        let text = document(&format!("[[self-organizing.obstacle]]\n{keys}\n"));
        let message = Preset::from_toml(&text).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{place}: ")) && message.contains(said), "{keys}: {message}");
    }
    let many = "[[self-organizing.obstacle]]\nbox = [1, 2, 3]\n".repeat(257);
    let message = Preset::from_toml(&document(&many)).unwrap_err().to_string();
    assert!(message.contains("257 obstacles are more than the 256 that a tree may have"), "{message}");
}
