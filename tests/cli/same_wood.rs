//! Whatever is put on it, the wood stays the same: by its hash, and bit by bit in the file that holds
//! nothing else.

use crate::program::{Folder, linden};

/// Small plants of the generators that have leaves.
const PLANTS: [(&str, &str); 4] = [
    ("date-palm", "lsystem"),
    ("dressed-honda-a", "lsystem"),
    ("dressed-fir", "colonization"),
    ("apple", "self-organizing"),
];

/// Hashes of wood do not hang on pictures, which `stats` draws to tell how large files are.
const PICTURES: [&str; 4] = ["--set", "bark_size=32", "--set", "leaf_size=32"];

/// Settings that are not the wood's.
const DRESSES: [&[&str]; 10] = [
    &["leaf_form=none"],
    &["leaf_form=card", "leaves_per_m=90", "leaf_outline=lobed"],
    &["leaf_keep=0.5"],
    &["season=0"],
    &["season=0.9"],
    &["lods=3", "billboard=2", "billboard_size=64", "card_size=128"],
    &["triangles=9000", "card_size=128"],
    &["wind=sway", "wind_strength=1"],
    &["wind=bones", "bones=1024"],
    &["wind=attributes", "lods=2", "card_size=128", "season=0.8", "leaf_length=0.2"],
];

fn pairs<'a>(dress: &[&'a str]) -> Vec<&'a str> {
    dress.iter().flat_map(|setting| ["--set", setting]).collect()
}

#[test]
fn leaves_levels_wind_and_seasons_leave_the_wood_as_it_is() {
    let folder = Folder::new();
    for (plant, generator) in PLANTS {
        let stats = folder.run(&[&["stats", plant, "--json"][..], &PICTURES].concat()).done().json();
        assert_eq!(stats["generator"], generator, "{plant}");
        assert!(stats["leaves"].as_u64().unwrap() > 0, "{plant}");
        for dress in DRESSES {
            // Evergreens have something to say of seasons.
            let said = folder.run(&[&["stats", plant, "--json"][..], &PICTURES, &pairs(dress)].concat());
            assert_eq!(said.code, Some(0), "{}", said.err);
            let dressed = said.json();
            assert_eq!(dressed["skeleton_hash"], stats["skeleton_hash"], "{plant} {dress:?}");
        }
    }
}

#[test]
fn the_skeletons_file_is_the_same_but_for_the_recipe() {
    let folder = Folder::new();
    for (plant, _) in PLANTS {
        let body = |args: &[&str]| {
            let line = ["export", plant, "--format", "ply-skeleton", "-o", "s.ply"];
            // Evergreens have something to say of seasons.
            let said = folder.run(&[&line[..], args].concat());
            assert_eq!(said.code, Some(0), "{}", said.err);
            let bytes = folder.read("s.ply");
            let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap();
            bytes[end..].to_vec()
        };
        let bare = body(&["--set", "leaf_form=none"]);
        assert!(bare.len() > 10_000, "{plant}");
        let dressed = ["--wind", "--lods", "3", "--seasons", "flush,late=0.9", "--set", "bark_size=32"];
        for args in [&["--set", "bark_size=32"][..], &dressed] {
            assert!(
                body(&[args, &["--set", "leaf_size=32", "--set", "card_size=128"]].concat()) == bare,
                "{plant} {args:?}"
            );
        }
    }
}

#[test]
fn a_dressed_windy_oak_in_levels_is_the_same_bytes_on_one_thread_and_two() {
    let folder = Folder::new();
    let export = |threads: &str| {
        let run = linden()
            .env("RAYON_NUM_THREADS", threads)
            .args(["export", "oak", "--triangles", "40000", "--lods", "3", "--billboard", "--wind=sway"])
            .args(["--seasons", "summer,late=0.9", "--set", "bark_size=64", "--set", "leaf_size=64"])
            .args(["--set", "billboard_size=128", "--set", "card_size=256"])
            .args(["-o", &format!("oak{threads}.glb"), "-o", &format!("oak{threads}.usda")])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let usda = String::from_utf8(folder.read(&format!("oak{threads}.usda"))).unwrap();
        // Pictures are named after the file.
        (folder.read(&format!("oak{threads}_late.glb")), usda.replace(&format!("oak{threads}_"), "oak_"))
    };
    let (one, two) = (export("1"), export("2"));
    assert!(one.1.contains("\"LOD3\"") && one.1.contains("timeSamples"), "dressed as asked");
    assert!(one == two, "one thread and two differ");
    let is_png = |name: &String| std::path::Path::new(name).extension().is_some_and(|ending| ending == "png");
    let png = |threads: &str| -> Vec<Vec<u8>> {
        let names = folder.names().into_iter();
        names
            .filter(|name| name.starts_with(&format!("oak{threads}_")) && is_png(name))
            .map(|name| folder.read(&name))
            .collect()
    };
    assert!(png("1").len() >= 4 && png("1") == png("2"));
}
