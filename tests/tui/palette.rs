//! Settings and files by name, through the real program.

use crate::harness::{Answers, Home, Setup, Workbench};

/// How light the letters of the figures in the title are, 0 to 255.
fn lightness(workbench: &Workbench) -> u32 {
    let [r, g, b] = workbench.screen().ink("seed 1").expect("it has a colour");
    (u32::from(r) + u32::from(g) + u32::from(b)) / 3
}

const CONFIG: &str = "theme = \"dark\" # mine\n";

#[test]
fn a_theme_is_set_by_name_and_stays_until_the_end() {
    let home = Home::new();
    let config = home.write("config/config.toml", CONFIG);
    let workbench = Setup::new(110, 40).answers(Answers::TrueColor).args(&["open", "fir"]).start(&home);
    workbench.wait_for_tree();
    let dark = lightness(&workbench);
    workbench.keys(":theme light");
    workbench.wait_for_text("becomes light");
    workbench.keys("\r");
    workbench.wait_for_text("theme is light until you leave");
    workbench.settle();
    let light = lightness(&workbench);
    assert!(light + 20 < dark, "letters on light paper are dark: {light}, they were {dark}");
    workbench.keys(":theme lihgt\r");
    workbench.wait_for_text("there is no such theme");
    assert_eq!(std::fs::read_to_string(config).unwrap(), CONFIG, "nothing is written");
}

#[test]
fn a_file_is_opened_by_its_path() {
    let home = Home::new();
    home.write(
        "mine.toml",
        "id = \"mine\"\nname = \"Mine alone\"\n[colonization]\ncrown = \"cone\"\npoints = 80\n",
    );
    let workbench = Workbench::open(&home, 140, 40, &["open", "fir"]);
    workbench.keys("\x0f");
    workbench.settle();
    workbench.keys("min\t");
    workbench.wait_for_text("mine.toml");
    workbench.keys("\r");
    workbench.wait_for("the file's tree", |screen| screen.row(0).contains("Mine alone"));
    workbench.wait_for_tree();
    assert!(workbench.screen().knob("points").contains("80"), "{}", workbench.screen().text());
    // One that is not there is said, and what is on screen stays.
    workbench.keys("\x0f");
    workbench.settle();
    workbench.keys("\x15gone.toml\r");
    workbench.wait_for_text("gone.toml");
    workbench.settle();
    workbench.keys("\x1b");
    workbench.settle();
    assert!(workbench.screen().row(0).contains("Mine alone"), "{}", workbench.screen().text());
}
