//! `linden export --seasons`: which files there are, and what is in them.

use crate::program::{Folder, Said};

/// A small tree in leaf, with small pictures.
const SMALL: [&str; 6] = ["--set", "points=100", "--set", "bark_size=32", "--set", "leaf_size=32"];

fn export(folder: &Folder, preset: &str, args: &[&str]) -> Said {
    folder.run(&[&["export", preset][..], &SMALL, args].concat())
}

/// The names of files but for pictures and materials.
fn main_files(folder: &Folder) -> Vec<String> {
    let is_side = |name: &String| [".png", ".mtl"].iter().any(|ending| name.ends_with(ending));
    folder.names().into_iter().filter(|name| !is_side(name)).collect()
}

/// Positions of the wood and triangles of the leaves in an OBJ file.
fn wood_and_leaves(folder: &Folder, name: &str) -> (Vec<String>, usize) {
    let text = String::from_utf8(folder.read(name)).unwrap();
    let (mut wood, mut leaves, mut is_wood) = (Vec::new(), 0, false);
    for line in text.lines() {
        match line.split_once(' ') {
            Some(("o" | "g", part)) => is_wood = part.contains("wood"),
            Some(("v", point)) if is_wood => wood.push(point.to_owned()),
            Some(("f", _)) if !is_wood => leaves += 1,
            _ => {}
        }
    }
    (wood, leaves)
}

#[test]
fn usd_has_variants_and_other_formats_a_file_for_each_season() {
    let folder = Folder::new();
    let args = [
        "-o",
        "t.obj",
        "-o",
        "t.usda",
        "-o",
        "t.glb",
        "-o",
        "t-s.ply",
        "--format",
        "obj,usda,glb,ply-skeleton",
    ];
    let said = export(&folder, "dressed-simple", &[&["--seasons"][..], &args].concat());
    let note = "note: ply-skeleton holds the skeleton alone: bark_size, leaf_size and seasons change nothing in it\n";
    assert_eq!((said.code, said.err.as_str()), (Some(0), note));
    let seasons = ["autumn", "bare", "flush", "summer"];
    let mut expected = vec!["t-s.ply".to_owned(), "t.usda".to_owned()];
    expected.extend(seasons.iter().flat_map(|season| [format!("t_{season}.glb"), format!("t_{season}.obj")]));
    expected.sort();
    assert_eq!(main_files(&folder), expected);

    let in_season = |season: &str| wood_and_leaves(&folder, &format!("t_{season}.obj"));
    let (wood, leaves) = in_season("summer");
    assert!(wood.len() > 300 && leaves > 300, "{} {leaves}", wood.len());
    for season in seasons {
        assert!(in_season(season).0 == wood, "the wood of {season} is another");
        assert_eq!(in_season(season).1, if season == "bare" { 0 } else { leaves }, "{season}");
    }
    let usda = String::from_utf8(folder.read("t.usda")).unwrap();
    assert!(usda.contains("variantSet \"season\"") && usda.contains("string season = \"summer\""));
    assert!(seasons.iter().all(|season| usda.contains(&format!("\"{season}\" {{"))), "four variants");
}

/// All seasons of what is the same in all are one file; those that are named have a file each, as scripts count on.
#[test]
fn what_no_season_changes_is_written_once() {
    let folder = Folder::new();
    let said = export(&folder, "dressed-simple", &["--seasons", "--set", "evergreen=true", "-o", "t.glb"]);
    assert!(said.err.contains("written once"), "{}", said.err);
    assert_eq!((said.code, main_files(&folder)), (Some(0), vec!["t.glb".to_owned()]));
    let args = ["--seasons", "summer,bare", "--set", "evergreen=true", "-o", "u.glb"];
    let said = export(&folder, "dressed-simple", &args);
    assert!(said.err.contains("nothing on this plant changes with them\n"), "{}", said.err);
    let names = ["t.glb", "u_bare.glb", "u_summer.glb"].map(str::to_owned);
    assert_eq!((said.code, main_files(&folder)), (Some(0), names.to_vec()));
}

/// What is not loaded yet can be chosen from: the small layer names all variants.
#[test]
fn a_payload_is_chosen_before_it_is_loaded() {
    let folder = Folder::new();
    let names = |args: &[&str]| {
        let payload = ["--seasons", "summer,bloom=0.17", "--set", "usda.payload=true", "-o", "t.usda"];
        export(&folder, "dressed-simple", &[&payload[..], args].concat()).done();
        let text = String::from_utf8(folder.read("t.usda")).unwrap();
        let is_named = |line: &&str| line.starts_with('"') || line.starts_with("variantSet ");
        text.lines().map(str::trim).filter(is_named).map(str::to_owned).collect::<Vec<_>>()
    };
    let seasons = ["variantSet \"season\" = {", "\"summer\" {", "\"bloom\" {"];
    assert_eq!(names(&[]), seasons);
    let lod = [&["\"LOD0\" ("][..], &seasons, &["\"LOD1\" ("], &seasons].concat();
    assert_eq!(names(&["--lods", "2"]), [&["variantSet \"lod\" = {"], &lod[..]].concat());
}

#[test]
fn levels_come_behind_seasons_and_values_have_the_users_names() {
    let folder = Folder::new();
    let args =
        ["--seasons", "late=0.9,spring=0.05", "--lods", "2", "-o", "t.obj", "-o", "t.glb", "-o", "t.usdz"];
    export(&folder, "dressed-simple", &[&args[..], &["--set", "season=0.8"]].concat()).done();
    let expected = [
        "t.usdz",
        "t_late.glb",
        "t_late_LOD0.obj",
        "t_late_LOD1.obj",
        "t_spring.glb",
        "t_spring_LOD0.obj",
        "t_spring_LOD1.obj",
    ];
    assert_eq!(main_files(&folder), expected);
    for level in [0, 1] {
        let in_season = |season: &str| wood_and_leaves(&folder, &format!("t_{season}_LOD{level}.obj"));
        let (late, spring) = (in_season("late"), in_season("spring"));
        assert!(late.0 == spring.0, "level {level} has one wood");
        assert!(0 < late.1 && late.1 < spring.1, "{} {}", late.1, spring.1);
    }
    // Either file grows again as it is.
    let text = String::from_utf8(folder.read("t_late_LOD0.obj")).unwrap();
    let recipe = text.lines().find(|line| line.contains("{\"linden\"")).expect("a recipe");
    folder.write("late.json", &recipe[recipe.find('{').unwrap()..]);
    folder.run(&["export", "late.json", "-o", "again.obj"]).done();
    assert_eq!(wood_and_leaves(&folder, "again_LOD0.obj"), wood_and_leaves(&folder, "t_late_LOD0.obj"));
}

#[test]
fn a_stream_has_the_recipes_own_season_and_plants_without_seasons_are_told_of() {
    let folder = Folder::new();
    let said = export(&folder, "dressed-simple", &["--seasons", "bare,summer", "--format", "obj", "-o", "-"]);
    assert_eq!(said.code, Some(0));
    assert!(said.err.contains("one season") && said.err.contains("'summer'"), "{}", said.err);
    assert!(said.out.contains("leaves"), "not the bare one");
    let said =
        folder.run(&["export", "dressed-fir", "--seasons", "-o", "fir.usda", "--set", "evergreen=true"]);
    assert_eq!(said.code, Some(0));
    assert!(said.err.contains("nothing on this plant changes"), "{}", said.err);
    // What none of them shows is named, with a season that does.
    let seasons = |list: &str| {
        let said = export(&folder, "drawn-rowan", &["--seasons", list, "-o", "rowan.organs.csv"]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        (said.err.contains("blossom is there from 0.1 to 0.24"), said.err)
    };
    let (is_missed, said) = seasons("all");
    assert!(is_missed && said.contains("all,bloom=0.17"), "{said}");
    let (is_missed, said) = seasons("all,bloom=0.17");
    assert!(!is_missed, "{said}");
    let table = String::from_utf8(folder.read("rowan_bloom.organs.csv")).unwrap();
    assert!(table.contains("blossom"), "{}", &table[..300]);
}

/// What is the same in several files of an export is written once.
#[test]
fn levels_and_seasons_share_their_pictures() {
    let folder = Folder::new();
    let args = ["--seasons", "summer,autumn", "--lods", "2", "-o", "t.obj", "-o", "t.gltf", "-o", "t.usda"];
    export(&folder, "dressed-simple", &args).done();
    let pictures: Vec<String> = folder.names().into_iter().filter(|name| has_ending(name, "png")).collect();
    let mut contents: Vec<Vec<u8>> = pictures.iter().map(|name| folder.read(name)).collect();
    contents.sort();
    contents.dedup();
    // The same under two names only where a format calls it otherwise: nothing here.
    assert_eq!(contents.len(), pictures.len(), "{pictures:?}");
    for name in folder.names().iter().filter(|name| has_ending(name, "mtl")) {
        let text = String::from_utf8(folder.read(name)).unwrap();
        let files: Vec<&str> = text
            .lines()
            .filter(|line| ["map_Kd ", "map_d ", "norm "].iter().any(|key| line.starts_with(key)))
            .filter_map(|line| line.split_whitespace().nth(1))
            .collect();
        assert!(files.len() >= 5, "{name}: {text}");
        assert!(files.iter().all(|file| pictures.iter().any(|picture| picture == file)), "{name}: {files:?}");
    }
}

fn has_ending(name: &str, ending: &str) -> bool {
    std::path::Path::new(name).extension().is_some_and(|found| found == ending)
}

#[test]
fn spring_fall_and_winter_are_other_words() {
    let folder = Folder::new();
    let small = ["--set", "points=60", "--set", "bark_size=32", "--set", "leaf_size=32"];
    folder
        .run(
            &[&["export", "dressed-simple", "--seasons", "spring,fall,winter", "-o", "t.obj"][..], &small]
                .concat(),
        )
        .done();
    let wood_alone = |name: &str| wood_and_leaves(&folder, name).1 == 0;
    assert_eq!(["t_spring.obj", "t_fall.obj", "t_winter.obj"].map(wood_alone), [false, false, true]);
    let ply = |season: &str, name: &str| {
        let set = format!("season={season}");
        folder.run(&[&["export", "dressed-simple", "--set", &set, "-o", name][..], &small].concat()).done();
        folder.read(name)
    };
    for (word, other) in [("spring", "flush"), ("fall", "autumn"), ("winter", "bare")] {
        assert!(ply(word, "a.ply") == ply(other, "b.ply"), "{word}");
    }
}
