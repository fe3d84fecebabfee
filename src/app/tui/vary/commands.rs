//! The commands that vary trees, and those of the gallery.

use super::chance::has_chance;
use super::sweep::{SEED, SPREADS, USUAL_SPREAD, ValueSeries};
use super::{CONTEXT, Gallery, GalleryPage, Way, open, reroll, seed};
use crate::tui::command::Context;
use crate::tui::dialog::After;
use crate::tui::effect::Effects;
use crate::tui::model::{Command, Model, free, without_preset};
use crate::tui::shape;

fn has_no_chance(model: &Model) -> Option<String> {
    without_preset(model).or_else(|| {
        let is_certain = model.tree.as_ref().is_some_and(|tree| !has_chance(tree.preset()));
        is_certain.then(|| "nothing in this tree is left to chance".to_owned())
    })
}

fn has_no_seed(model: &Model, end: u64) -> Option<String> {
    let has_chance = if model.forest.is_some() { None } else { has_no_chance(model) };
    has_chance.or_else(|| (seed(model) == Some(end)).then(|| format!("there is no seed beyond {end}")))
}

fn cannot_sweep(model: &Model) -> Option<String> {
    let Some((row, current)) = shape::selected(model) else {
        return without_preset(model)
            .or_else(|| Some("the cursor is on the grammar; choose a knob".to_owned()));
    };
    if row.knob.name == SEED {
        return has_no_chance(model);
    }
    ValueSeries::of(&row.knob, &current, USUAL_SPREAD, 1).err()
}

/// The gallery on top.
fn gallery(model: &Model) -> Option<&Gallery> {
    model.dialogs.top()
}

/// Does something with the gallery on top.
fn with(model: &mut Model, act: impl FnOnce(&mut Gallery, &Model)) {
    model.with(|gallery: &mut Gallery, model| {
        act(gallery, model);
        After::Stays
    });
}

fn go(model: &mut Model, way: Way) {
    with(model, |gallery, model| gallery.go(model, way));
}

fn choose(model: &mut Model, cell: usize) {
    with(model, |gallery, model| gallery.choose(model, cell));
}

/// The page on screen.
fn page(model: &Model) -> Option<GalleryPage> {
    gallery(model)?.page(model).ok()
}

fn is_all(model: &Model) -> Option<String> {
    let is_all = page(model).is_none_or(|page| page.values.len() as u64 > page.series.last());
    is_all.then(|| "all there is is on this page".to_owned())
}

fn has_no_range(model: &Model) -> Option<String> {
    let is_number = |page: GalleryPage| {
        use linden::knob::Value;
        page.series != ValueSeries::Seeds
            && matches!(page.current, Value::Real(_) | Value::Steps(_) | Value::Integer(_))
    };
    (!page(model).is_some_and(is_number)).then(|| "only a sweep of numbers has a range".to_owned())
}

fn is_at_spread(model: &Model, end: usize, why: &str) -> Option<String> {
    has_no_range(model)
        .or_else(|| gallery(model).is_some_and(|gallery| gallery.spread == end).then(|| why.to_owned()))
}

/// A row that moves.
const fn moving(
    id: &'static str,
    keys: &'static [&'static str],
    title: &'static str,
    help: &'static str,
    hint: Option<u8>,
    run: fn(&mut Model, &mut Effects),
) -> Command {
    Command { id, context: CONTEXT, keys, title, help, hint, hindrance: free, run }
}

/// The rows.
pub const COMMANDS: &[Command] = &[
    Command {
        id: "seed-next",
        context: Context::GLOBAL,
        keys: &["n"],
        title: "New seed",
        help: "Grows another tree of the same kind: turns the seed to the next one",
        hint: Some(33),
        hindrance: |model| has_no_seed(model, u64::MAX),
        run: |model, _| reroll(model, true),
    },
    Command {
        id: "seed-previous",
        context: Context::GLOBAL,
        keys: &["N"],
        title: "Seed before",
        help: "Goes back along the seeds",
        hint: None,
        hindrance: |model| has_no_seed(model, 0),
        run: |model, _| reroll(model, false),
    },
    Command {
        id: "gallery",
        context: Context::GLOBAL,
        keys: &["v"],
        title: "Gallery",
        help: "Shows this tree from many seeds, to choose one",
        hint: Some(34),
        hindrance: has_no_chance,
        run: |model, _| open(model, SEED),
    },
    Command {
        id: "sweep",
        context: Context::GLOBAL,
        keys: &["V"],
        title: "Sweep",
        help: "Shows this tree with many values of the selected knob, to choose one",
        hint: Some(35),
        hindrance: cannot_sweep,
        run: |model, _| {
            if let Some((row, _)) = shape::selected(model) {
                open(model, row.knob.name);
            }
        },
    },
    moving(
        "gallery-take",
        &["enter", "space"],
        "Take it",
        "Takes the chosen tree; one undo leads back",
        Some(10),
        |model, _| {
            model.with(Gallery::take);
        },
    ),
    moving("gallery-close", &["esc", "q"], "Leave", "Leaves everything as it was", Some(11), Model::cancel),
    moving("gallery-left", &["left", "h"], "Left", "Chooses the picture on the left", None, |model, _| {
        go(model, Way::Left);
    }),
    moving(
        "gallery-right",
        &["right", "l"],
        "Choose",
        "Chooses the picture on the right",
        Some(12),
        |model, _| {
            go(model, Way::Right);
        },
    ),
    moving("gallery-up", &["up", "k"], "Up", "Chooses the picture above", None, |model, _| {
        go(model, Way::Up);
    }),
    moving("gallery-down", &["down", "j"], "Down", "Chooses the picture below", None, |model, _| {
        go(model, Way::Down);
    }),
    Command {
        id: "gallery-page-down",
        context: CONTEXT,
        keys: &["pagedown", "ctrl-d", "n"],
        title: "More",
        help: "Shows the next page: further seeds, further choices",
        hint: Some(14),
        hindrance: is_all,
        run: |model, _| with(model, |gallery, model| gallery.turn_page(model, true)),
    },
    Command {
        id: "gallery-page-up",
        context: CONTEXT,
        keys: &["pageup", "ctrl-u", "N"],
        title: "Page before",
        help: "Shows the page before",
        hint: None,
        hindrance: is_all,
        run: |model, _| with(model, |gallery, model| gallery.turn_page(model, false)),
    },
    moving(
        "gallery-home",
        &["0", "home"],
        "Back to what is set",
        "Chooses what the tree has now",
        None,
        |model, _| {
            with(model, Gallery::go_back);
        },
    ),
    moving(
        "gallery-scale",
        &["z"],
        "Scale",
        "Shows each tree as large as can be, or all in one scale",
        Some(16),
        |model, _| {
            with(model, |gallery, _| gallery.one_scale = !gallery.one_scale);
        },
    ),
    Command {
        id: "gallery-wider",
        context: CONTEXT,
        keys: &["+", "="],
        title: "Wider",
        help: "Widens the range of the sweep",
        hint: Some(17),
        hindrance: |model| is_at_spread(model, SPREADS.len() - 1, "no sweep is wider than this"),
        run: |model, _| with(model, |gallery, model| gallery.spread_by(model, true)),
    },
    Command {
        id: "gallery-narrower",
        context: CONTEXT,
        keys: &["-"],
        title: "Narrower",
        help: "Narrows the range of the sweep",
        hint: Some(18),
        hindrance: |model| is_at_spread(model, 0, "no sweep is narrower than this"),
        run: |model, _| with(model, |gallery, model| gallery.spread_by(model, false)),
    },
    moving("gallery-first", &["1"], "First picture", "Chooses the first picture", None, |m, _| {
        choose(m, 0);
    }),
    moving("gallery-second", &["2"], "Second picture", "Chooses the second picture", None, |m, _| {
        choose(m, 1);
    }),
    moving("gallery-third", &["3"], "Third picture", "Chooses the third picture", None, |m, _| {
        choose(m, 2);
    }),
    moving("gallery-fourth", &["4"], "Fourth picture", "Chooses the fourth picture", None, |m, _| {
        choose(m, 3);
    }),
    moving("gallery-fifth", &["5"], "Fifth picture", "Chooses the fifth picture", None, |m, _| {
        choose(m, 4);
    }),
    moving("gallery-sixth", &["6"], "Sixth picture", "Chooses the sixth picture", None, |m, _| {
        choose(m, 5);
    }),
    moving("gallery-seventh", &["7"], "Seventh picture", "Chooses the seventh picture", None, |m, _| {
        choose(m, 6);
    }),
    moving("gallery-eighth", &["8"], "Eighth picture", "Chooses the eighth picture", None, |m, _| {
        choose(m, 7);
    }),
    moving("gallery-ninth", &["9"], "Ninth picture", "Chooses the ninth picture", None, |m, _| {
        choose(m, 8);
    }),
];
