//! The numbers of a tree against computations that know nothing of ours.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod hull;
mod topology;

#[test]
fn leaves_of_crossing_sheets_are_inclined_as_their_blades() {
    let inclination = |form: &str| {
        let tree = linden::tree("dressed-simple").unwrap().set("points", "100").unwrap();
        let report = tree.set("leaf_form", form).unwrap().grow().unwrap().report().unwrap();
        report.leaf_inclination_mean_deg.unwrap()
    };
    let card = inclination("card");
    for form in ["cross", "tuft"] {
        assert!((inclination(form) - card).abs() < 1e-3, "{form}: {} not {card}", inclination(form));
    }
    assert!((inclination("twig") - card).abs() > 1e-2, "its sheets are rolled to both sides");
}
