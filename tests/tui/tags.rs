//! Tags, and forests of the user's by id: in the workbench and on the command line.

use std::process::Command;

use crate::harness::{End, Home, PROGRAM, Workbench};

fn said(home: &Home, args: &[&str]) -> String {
    let output = Command::new(PROGRAM)
        .args(args)
        .env("LINDEN_CONFIG_DIR", home.file("config"))
        .env("LINDEN_STATE_DIR", home.file("state"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_preset_is_tagged_found_and_listed_by_its_tag() {
    let home = Home::new();
    home.write(
        "config/presets/mine.toml",
        "id = \"mine\"\ntags = [\"hedge\", \"own\"]\n[colonization]\ncrown = \"cone\"\npoints = 80\n",
    );
    let mut workbench = Workbench::open(&home, 140, 50, &["open", "fir"]);
    workbench.keys("#");
    workbench.wait_for_text("tags of fir");
    workbench.keys("hedge Dark, #no!\r");
    workbench.wait_for_text("is no tag");
    workbench.keys("\x15hedge Dark\r");
    workbench.wait_for_text("#hedge #dark");
    workbench.settle();
    // By the filter: the document's tag and the user's alike.
    workbench.keys("/#hedge");
    workbench.settle();
    let list = workbench.screen().columns(0, 30).join("\n");
    assert!(list.contains("fir") && list.contains("mine") && !list.contains("oak"), "{list}");
    workbench.keys(" mi\r");
    workbench.settle();
    let list = workbench.screen().columns(0, 30).join("\n");
    assert!(list.contains("mine") && !list.contains(" fir "), "{list}");
    workbench.keys("\x1b");
    workbench.settle();
    // By the palette.
    workbench.keys(":#dark");
    workbench.wait_for_text("preset");
    workbench.settle();
    workbench.keys("\r");
    workbench.wait_for("the fir", |screen| screen.row(0).contains("Fir"));
    workbench.settle();
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));

    let ids = |args: &[&str]| -> Vec<String> {
        let rows: serde_json::Value = serde_json::from_str(&said(&home, args)).unwrap();
        rows.as_array().unwrap().iter().map(|row| row["id"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(ids(&["list", "--json", "--tag", "hedge"]), ["fir", "mine"]);
    assert_eq!(ids(&["list", "--json", "--tag", "hedge", "--tag", "own"]), ["mine"]);
    assert!(ids(&["list", "--json", "--tag", "palm"]).is_empty());
    let rows: serde_json::Value = serde_json::from_str(&said(&home, &["list", "--json"])).unwrap();
    let tags =
        |id: &str| rows.as_array().unwrap().iter().find(|row| row["id"] == id).unwrap()["tags"].clone();
    assert_eq!((tags("fir"), tags("oak")), (serde_json::json!(["hedge", "dark"]), serde_json::json!([])));
    let page = said(&home, &["list", "--tag", "hedge"]);
    assert!(page.contains("#hedge  #dark") && page.contains("#hedge  #own"), "{page}");

    // And the next time.
    let workbench = Workbench::open(&home, 140, 50, &["open", "oak"]);
    workbench.keys("/#dark");
    workbench.settle();
    let list = workbench.screen().columns(0, 30).join("\n");
    assert!(list.contains("fir") && !list.contains("oak"), "{list}");
}

#[test]
fn forests_of_the_user_have_ids_as_presets_have() {
    let home = Home::new();
    home.write(
        "config/presets/copse.toml",
        "name = \"My copse\"\nsummary = \"two kinds\"\narea = 14\nspacing = 6\nseed = 4\n[[tree]]\npreset = \"older-c\"\n",
    );
    assert!(said(&home, &["show", "copse"]).contains("My copse"));
    let row = said(&home, &["list"]);
    let row = row.lines().find(|line| line.contains("copse")).unwrap().to_owned();
    assert!(row.contains("forest") && row.contains("two kinds"), "{row}");
    let by_id = home.file("id.glb");
    let by_file = home.file("file.glb");
    said(&home, &["forest", "copse", "-o", by_id.to_str().unwrap()]);
    let file = home.file("config/presets/copse.toml");
    said(&home, &["forest", file.to_str().unwrap(), "-o", by_file.to_str().unwrap()]);
    assert!(std::fs::read(by_id).unwrap() == std::fs::read(by_file).unwrap());
    let workbench = crate::harness::Setup::new(140, 50).args(&["open", "copse"]).start(&home);
    workbench.wait_for_text("of them grown");
    workbench.wait_for_text("Yours");
    assert!(workbench.screen().row(0).contains("My copse"), "{}", workbench.screen().text());
}
