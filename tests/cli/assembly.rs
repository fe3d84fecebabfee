//! What `batch --merge` makes of all trees: sheets of thumbnails, and files that name those of the trees.

use std::collections::BTreeSet;

use crate::program::{Folder, Said};

const MANIFEST: &str = r#"
formats = ["usda", "glb", "thumbnail"]

[[trees]]
source = "fir"
seeds = "1..3"
set = { points = [40, 60], bark_size = 16 }

[[trees]]
source = "own.txt"
formats = ["glb"]
set = { segment_length = 0.2 }

[[trees]]
source = "dressed-simple"
seeds = [1, 2]
formats = ["usdz", "thumbnail"]
set = { points = 30, bark_size = 16, leaf_size = 16 }
"#;
const TREES: usize = 6 + 1 + 2;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("m.toml", MANIFEST);
    folder.write("own.txt", "axiom=F\nangle=20\nnumber of derivations=2\nF=F[+F]F\n");
    folder
}

fn grow(folder: &Folder, args: &[&str]) {
    // A grammar has no units, which is said.
    let said = folder.run(&[&["batch"], args].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
}

fn grown() -> Folder {
    let folder = folder();
    grow(&folder, &["m.toml", "--out", "my out"]);
    folder
}

fn merge(folder: &Folder, further: &[&str]) -> Said {
    folder.run(&[&["batch", "m.toml", "--out", "my out", "--merge"], further].concat())
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).unwrap()
}

/// The files that an assembly of USD names, in its order.
fn payloads(text: &str) -> Vec<String> {
    let named =
        |line: &str| Some(line.trim().strip_prefix("prepend payload = @")?.strip_suffix('@')?.to_owned());
    text.lines().filter_map(named).collect()
}

fn tiles(tile: &serde_json::Value) -> Vec<serde_json::Value> {
    let mut found: Vec<_> = tile.get("content").map(|_| tile.clone()).into_iter().collect();
    found.extend(tile["children"].as_array().into_iter().flatten().flat_map(tiles));
    found
}

fn size(png: &[u8]) -> (u32, u32) {
    let reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    (reader.info().width, reader.info().height)
}

/// What sways needs a time range in the file over it: programs play nothing without.
#[test]
fn an_assembly_of_trees_that_sway_says_how_long() {
    let folder = Folder::new();
    let manifest = |wind: &str| {
        let sets = format!("set = {{ wind = \"{wind}\", points = 30, bark_size = 16 }}");
        format!("formats = [\"usda\"]\n[[trees]]\nsource = \"simple\"\nseeds = \"1..2\"\n{sets}\n")
    };
    for (wind, is_said) in [("sway", true), ("attributes", false)] {
        folder.write("m.toml", manifest(wind));
        let said = folder.run(&["batch", "m.toml", "--out", wind]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        folder.run(&["batch", "m.toml", "--out", wind, "--merge", "--usd", "w.usda"]).done();
        let whole = text(&folder, "w.usda");
        let time = |text: &str| {
            let lines = text.lines().filter(|line| line.contains("TimeCode"));
            lines.map(|line| line.trim().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(!time(&whole).is_empty(), is_said, "{wind}: {whole}");
        let of_tree = payloads(&whole).remove(0);
        assert_eq!(time(&whole), time(&text(&folder, of_tree.trim_start_matches("./"))), "{wind}");
    }
}

#[test]
fn assemblies_name_the_files_of_all_trees() {
    let folder = grown();
    let said =
        merge(&folder, &["--usd", "wood.usda", "--tiles", "my out/tileset.json", "--sheet", "sheet.png"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.out.contains("8 trees in wood.usda") && said.out.contains("8 trees on sheet.png"),
        "{}",
        said.out
    );
    // The grammar has no USD and no thumbnail, the last kind no glTF.
    for expected in [
        "--usd leaves out 1 tree not written as usda or usdc or usdz: 6",
        "--tiles leaves out 2 trees not written as glb or gltf: 7-8",
        "--sheet leaves out 1 tree without thumbnail: 6",
    ] {
        assert!(said.err.contains(expected), "{expected}: {}", said.err);
    }
    let wood = text(&folder, "wood.usda");
    let named = payloads(&wood);
    assert_eq!(named.len(), 8);
    assert!(
        named.iter().all(|file| file.starts_with("./my out/") && folder.file(file).is_file()),
        "{named:?}"
    );
    assert_eq!(named.iter().filter(|file| file.contains(".usdz")).count(), 2);
    let tileset: serde_json::Value = serde_json::from_str(&text(&folder, "my out/tileset.json")).unwrap();
    let tiles = tiles(&tileset["root"]);
    let numbers: BTreeSet<u64> = tiles.iter().map(|tile| tile["extras"]["index"].as_u64().unwrap()).collect();
    assert_eq!((tiles.len(), numbers), (7, (0..7).collect()));
    for tile in &tiles {
        assert!(folder.file("my out").join(tile["content"]["uri"].as_str().unwrap()).is_file(), "{tile}");
    }
    let index = text(&folder, "my out/index.jsonl");
    assert_eq!(index.lines().count(), TREES);
    // As they were made does not matter.
    let again = self::folder();
    for shard in ["1/2", "0/2"] {
        grow(&again, &["m.toml", "--out", "my out", "--shard", shard, "--jobs", "1"]);
    }
    let said =
        merge(&again, &["--usd", "wood.usda", "--tiles", "my out/tileset.json", "--sheet", "sheet.png"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    for name in ["wood.usda", "my out/tileset.json", "my out/index.jsonl", "sheet.png"] {
        assert!(folder.read(name) == again.read(name), "{name}");
    }
}

#[test]
fn a_sheet_is_of_thumbnails_that_carry_their_recipes() {
    let folder = grown();
    assert_eq!(merge(&folder, &[]).code, Some(0));
    let row: serde_json::Value =
        serde_json::from_str(text(&folder, "my out/index.jsonl").lines().next().unwrap()).unwrap();
    // The last of its main files, as the manifest has its formats.
    let thumbnail = row["key"].as_str().unwrap().rsplit(' ').next();
    assert_eq!(size(&folder.read(&format!("my out/{}", thumbnail.unwrap()))), (200, 240));
    let thumbnail = format!("my out/{}", thumbnail.unwrap());
    let recipe = folder.run(&["recipe", &thumbnail]).done().out;
    assert!(recipe.contains("\"fir\"") && recipe.contains("\"points\":40"), "{recipe}");
    merge(&folder, &["--sheet", "one.png", "--only", "0"]);
    merge(&folder, &["--sheet", "all.webp"]);
    let (width, height) = size(&folder.read("one.png"));
    assert!(width == 200 && (241..300).contains(&height), "{height}");
    // The sheet shows the thumbnail as it is.
    let pixels = |name: &str| {
        let mut reader = png::Decoder::new(std::io::Cursor::new(folder.read(name))).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        bytes
    };
    let (sheet, own) = (pixels("one.png"), pixels(&thumbnail));
    let pixel = sheet.len() / (width * height) as usize;
    let (sheet, own) = (sheet.chunks(pixel), own.chunks(own.len() / (200 * 240)));
    assert!(sheet.zip(own).all(|(a, b)| a[..3] == b[..3]));
    assert!(folder.read("all.webp").len() > 10_000);
}

#[test]
fn a_table_says_where_trees_stand() {
    let folder = grown();
    folder.write(
        "places.csv",
        "\u{feff}# measured by hand\nX, z ,y,turn,scale,tree,source,dbh\n\
         1,2,0.5,90,2,3,,0.4\n4,5,,,,,dressed-simple,\n6,7,,,,,\"dressed-simple\",\n8,9,,,,,dressed-simple,\n\
         10,11,,,,6,,\n12,13,,,,,,\n",
    );
    let said = merge(&folder, &["--usd", "my out/wood.usda", "--places", "places.csv"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("5 trees in my out/wood.usda"), "{}", said.out);
    assert!(
        said.err.contains("1 place of places.csv stays empty") && said.err.contains(": dbh"),
        "{}",
        said.err
    );
    let wood = text(&folder, "my out/wood.usda");
    let prims: Vec<&str> =
        wood.lines().filter_map(|line| line.trim().strip_prefix("def Xform \"tree_")).collect();
    // Trees of a source take turns; so do those of a line that names none.
    assert_eq!(prims, ["3\" (", "7\" (", "8\" (", "7_2\" (", "0\" ("]);
    for expected in ["translate = (1, 0.5, 2)", "rotateY = 90", "scale = (2, 2, 2)", "translate = (8, 0, 9)"]
    {
        assert!(wood.contains(expected), "{expected}");
    }
    // Two of one file are one in memory.
    assert_eq!(wood.matches("instanceable = true").count(), 2);
    assert!(payloads(&wood).iter().all(|file| folder.file("my out").join(file).is_file()));
}

#[test]
fn what_is_not_there_is_left_out() {
    let folder = folder();
    grow(&folder, &["m.toml", "--out", "my out", "--only", "1,4,8"]);
    let said = merge(&folder, &["--usd", "wood.usda"]);
    assert!(said.code == Some(1) && said.err.contains("6 are missing: --only 0,2-3,5-7"), "{}", said.err);
    assert_eq!(payloads(&text(&folder, "wood.usda")).len(), 3);
    let said = merge(&folder, &["--usd", "part.usda", "--only", "0-4"]);
    assert!(said.code == Some(1) && said.out.contains("2 trees in part.usda"), "{}", said.out);
}

#[test]
fn mistakes_are_told_and_nothing_is_written() {
    let folder = grown();
    folder.write("letters.csv", "x,z\n1,a\n");
    folder.write("beyond.csv", "x,z,tree\n1,2,9\n");
    folder.write("other.csv", "x,z,source\n1,2,yew\n");
    folder.write("flat.csv", "x,y\n1,2\n");
    folder.write("empty.csv", "x,z\n");
    folder.write(
        "none.toml",
        "formats = [\"qsm\"]\n[[trees]]\nsource = \"own.txt\"\nset = { segment_length = 0.2 }\n",
    );
    folder.write(
        "self.json",
        "{\"source\": \"own.txt\", \"formats\": [\"glb\"], \"set\": {\"segment_length\": 0.2}}\n",
    );
    grow(&folder, &["none.toml", "--out", "none"]);
    grow(&folder, &["self.json", "--out", "self"]);
    let before = folder.names();
    let with = |table: &str| {
        vec!["m.toml", "--out", "my out", "--merge", "--usd", "x.usda", "--places", table]
            .into_iter()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    for (args, code, expected) in [
        (with("letters.csv"), 2, "letters.csv:2: z is 'a'"),
        (with("beyond.csv"), 2, "no tree '9': they are numbered from 0 to 8"),
        (with("other.csv"), 2, "no source 'yew'"),
        (with("flat.csv"), 2, "no column 'z'"),
        (with("empty.csv"), 2, "has no places"),
        (with("gone.csv"), 1, "gone.csv"),
        (words("none.toml --out none --merge --usd x.usda"), 2, "add \"usda\" to the formats"),
        (words("none.toml --out none --merge --tiles x.json"), 2, "add \"glb\" to the formats"),
        (words("none.toml --out none --merge --sheet x.png"), 2, "add \"thumbnail\" to the formats"),
        (words("none.toml --out none --merge --only 0"), 2, "--only is for those of --sheet"),
        (words("none.toml --out none --merge --places letters.csv"), 2, "--usd and --tiles"),
        (words("none.toml --out none --usd x.usda"), 2, "--merge"),
        (words("self.json --out self --merge --tiles x.gltf"), 2, "name it like x.json"),
        (words("self.json --out self --merge --tiles gone/x.json"), 1, "mkdir -p"),
        (words("self.json --out self --merge --tiles self.json"), 1, "grown from that file"),
    ] {
        let args: Vec<&str> = ["batch"].into_iter().chain(args.iter().map(String::as_str)).collect();
        let said = folder.run(&args);
        assert!(
            said.code == Some(code) && said.err.contains(expected),
            "{args:?}: {:?} {}",
            said.code,
            said.err
        );
    }
    assert_eq!(folder.names(), before);
    for out in ["my out", "none", "self"] {
        assert!(!folder.file(out).join("index.jsonl").exists(), "{out}");
    }
}

#[test]
fn an_assembly_names_trees_of_binary_usd() {
    let folder = Folder::new();
    folder.write("m.toml", "formats = [\"usdc\"]\n[[trees]]\nsource = \"fir\"\nseeds = \"1..2\"\nset = { points = 40, bark_size = 16 }\n");
    grow(&folder, &["m.toml", "--out", "my out"]);
    let said = merge(&folder, &["--usd", "wood.usda"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let wood = text(&folder, "wood.usda");
    let named = payloads(&wood);
    assert!(named.len() == 2 && named.iter().all(|file| file.contains(".usdc")), "{named:?}");
    assert!(named.iter().all(|file| folder.file(file).is_file()), "{named:?}");
}
