//! The user's files: what is wrong with them is said with its place, and nothing keeps linden from
//! starting; what changes is read again.

use crate::harness::{End, Home, Setup, Workbench};

const GOOD: &str = "id = \"mine\"\nname = \"Mine\"\n[colonization]\ncrown = \"sphere\"\npoints = 200\n";

/// The page of messages.
fn messages(workbench: &Workbench) -> String {
    workbench.keys("m");
    let screen = workbench.wait_for_text("Messages");
    workbench.settle();
    let _ = screen;
    let text = workbench.screen().text();
    workbench.keys("q");
    workbench.settle();
    text
}

#[test]
fn what_is_broken_is_named_with_its_place() {
    for (file, text, place) in [
        ("config/config.toml", "mouse = true\nreload = maybe\n", "config.toml:2:10"),
        ("config/config.toml", "mouse = \"maybe\"\n", "config.toml:1:9"),
        ("config/keymap.toml", "[keys]\nhelp = [\"no such key\"]\n", "keymap.toml:2:9"),
        ("config/keymap.toml", "[keys\n", "keymap.toml:1:"),
        ("config/themes/moor.toml", "[colors]\n\nborder = \"#zz\"\n", "moor.toml:"),
        ("state/session.toml", "version = 1\nsource = = 3\n", "session.toml:2:"),
        ("config/presets/mine.toml", "id = \"mine\"\n[colonization]\ncrown = \"spere\"\n", "mine.toml:3:9"),
    ] {
        let home = Home::new();
        home.write(file, text);
        if file.contains("themes") {
            home.write("config/config.toml", "theme = \"moor\"\n");
        }
        let mut workbench = Setup::new(140, 40).start(&home);
        workbench.wait_for_tree();
        if file.contains("presets") {
            // In the list, where it lies; said when it is chosen.
            workbench.keys("G");
            workbench.wait_for_text("mine");
            workbench.settle();
        }
        let said = messages(&workbench) + &workbench.screen().text().replace(['│', '\n'], "");
        assert!(said.contains(place), "{file}: {place}\n{said}");
        // The rest works.
        workbench.keys("g");
        workbench.wait_for_tree();
        workbench.keys("q");
        assert_eq!(workbench.wait_exit(), End::Code(0));
    }
}

#[test]
fn folders_in_the_place_of_files_are_no_obstacle() {
    let home = Home::new();
    for name in
        ["config/config.toml/x", "config/keymap.toml/x", "state/session.toml/x", "config/presets/a.toml/x"]
    {
        home.write(name, "");
    }
    let mut workbench = Setup::new(140, 40).start(&home);
    workbench.wait_for_tree();
    let said = messages(&workbench);
    assert!(said.contains("config.toml") && said.contains("keymap.toml"), "{said}");
    workbench.keys("q");
    assert_eq!(workbench.wait_exit(), End::Code(0));
    // What is in the way is put aside.
    assert!(home.file("state/session.toml").is_file() && home.file("state/session.old.toml").is_dir());
}

#[test]
fn a_preset_that_changes_on_disk_changes_on_screen() {
    let home = Home::new();
    let path = home.write("config/presets/mine.toml", GOOD);
    let workbench = Setup::new(140, 40).args(&["open", path.to_str().unwrap()]).start(&home);
    workbench.wait_for_tree();
    let before = workbench.screen().row(0);
    home.write("config/presets/mine.toml", GOOD.replace("200", "321").replace("Mine", "Other"));
    let screen = workbench.wait_for("the new tree", |screen| {
        screen.row(0).contains("Other")
            && screen.knob("points").contains("321")
            && !screen.row(0).contains(&before)
    });
    assert!(!screen.text().contains("modified"));
    workbench.settle();
    let good = workbench.screen().row(0);
    // The last good tree stays where a new one cannot be read, and it is said where.
    home.write("config/presets/mine.toml", GOOD.replace("\"sphere\"", "\"spere\""));
    workbench.wait_for_text(".toml:4:9");
    workbench.settle();
    let screen = workbench.screen();
    assert_eq!(screen.row(0), good);
    assert!(screen.painted(40..90, 3..36) > 60, "{}", screen.text());
    // And back.
    home.write("config/presets/mine.toml", GOOD.replace("200", "222"));
    workbench.wait_for("the points", |screen| screen.knob("points").contains("222"));
    workbench.wait_for("the first name", |screen| screen.row(0).contains("Mine"));
}

#[test]
fn changes_that_were_made_here_are_kept_when_the_file_changes() {
    let home = Home::new();
    let path = home.write("config/presets/mine.toml", GOOD);
    let workbench = Setup::new(140, 40).args(&["open", path.to_str().unwrap()]).start(&home);
    workbench.wait_for_tree();
    workbench.keys("\t\tl");
    workbench.wait_for_text("modified");
    workbench.settle();
    home.write("config/presets/mine.toml", GOOD.replace("200", "321"));
    workbench.wait_for_text("your changes are kept");
    // And what was changed in the file alone is there, too.
    workbench.wait_for("the points", |screen| {
        screen.knob("points").contains("321") && screen.knob("seed").contains('2')
    });
}

#[test]
fn a_preset_that_is_put_into_the_folder_is_listed() {
    let home = Home::new();
    std::fs::create_dir_all(home.file("config/presets")).unwrap();
    // So high that the whole list is in sight.
    let workbench = Workbench::open(&home, 140, 200, &["open", "fir"]);
    assert!(!workbench.screen().text().contains("Yours"));
    home.write("config/presets/mine.toml", GOOD);
    workbench.wait_for_text("Yours");
    workbench.wait_for_text("mine");
    std::fs::remove_file(home.file("config/presets/mine.toml")).unwrap();
    workbench.wait_for("the list without it", |screen| !screen.text().contains("mine"));
}

#[test]
fn a_keymap_is_followed_and_followed_again() {
    let home = Home::new();
    home.write("config/keymap.toml", "[keys]\nhelp = [\"f5\"]\n");
    let workbench = Workbench::open(&home, 140, 40, &["open", "fir"]);
    workbench.keys("?");
    workbench.settle();
    assert!(!workbench.screen().text().contains("╭ Help"), "{}", workbench.screen().text());
    workbench.keys("\x1b[15~");
    workbench.wait_for_text("╭ Help");
    workbench.keys("\x1b");
    workbench.settle();
    home.write("config/keymap.toml", "[keys]\nhelp = [\"?\"]\n");
    std::thread::sleep(std::time::Duration::from_secs(1));
    workbench.settle();
    workbench.keys("?");
    workbench.wait_for_text("╭ Help");
}
