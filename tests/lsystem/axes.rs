//! Axes by brackets (ABOP, section 1.6.1), against a parser of the derived string that knows nothing but
//! letters and brackets.

use linden::grow::grow as grow_recipe;
use linden::lsystem::{derive_string, grow};
use linden::preset::{LSystem, builtins};
use linden::recipe::Recipe;
use linden::skeleton::{Axis, AxisRule, Forks, Wood};
use linden::{Edge, NO_PARENT, Quiet, Skeleton};

/// Of each segment, in the order of the string: its axis, numbered as axes begin, and the order of that.
fn parsed(string: &str) -> Vec<(usize, u32)> {
    /// Which axis goes on here, and whether a bracket has opened since its last segment.
    #[derive(Clone, Copy)]
    struct Here {
        axis: Option<usize>,
        order: u32,
        is_bracketed: bool,
    }
    let mut here = Here { axis: None, order: 0, is_bracketed: false };
    let (mut stack, mut segments, mut axes, mut polygons) = (Vec::new(), Vec::new(), 0, 0);
    // Axes of stems that have begun at a foot without a segment so far share that foot.
    let mut letters = string.chars().peekable();
    while let Some(letter) = letters.next() {
        let mut argument = String::new();
        if letters.peek() == Some(&'(') {
            let mut depth = 0;
            for inner in letters.by_ref() {
                depth += i32::from(inner == '(') - i32::from(inner == ')');
                argument.push(inner);
                if depth == 0 {
                    break;
                }
            }
        }
        let first = argument.trim_matches(['(', ')']).split(',').next().unwrap_or("").to_owned();
        match letter {
            '{' => polygons += 1,
            '}' => polygons -= 1,
            '[' => {
                stack.push(here);
                here.is_bracketed = true;
            }
            ']' => here = stack.pop().unwrap(),
            '~' => {
                letters.next();
            }
            'f' if polygons == 0 && first != "0" => here = Here { axis: None, order: 0, is_bracketed: false },
            'F' | 'G' if polygons == 0 && first != "0" => {
                if here.axis.is_none() || here.is_bracketed {
                    here.order = if here.is_bracketed { here.order + 1 } else { 0 };
                    here.axis = Some(axes);
                    here.is_bracketed = false;
                    axes += 1;
                }
                segments.push((here.axis.unwrap(), here.order));
            }
            _ => {}
        }
    }
    segments
}

/// The same of a skeleton: nodes stand in the order in which their segments were drawn.
fn built(skeleton: &Skeleton) -> Vec<(usize, u32)> {
    let mut of_node = vec![(0, 0); skeleton.parents.len()];
    for (index, axis) in skeleton.axes.iter().enumerate() {
        for &node in skeleton.nodes_of(axis) {
            of_node[node as usize] = (index, axis.order);
        }
    }
    let ends = (0..of_node.len()).filter(|&node| skeleton.parents[node] != NO_PARENT);
    renumbered(ends.map(|node| of_node[node]))
}

/// With axes numbered as they first come up.
fn renumbered(segments: impl Iterator<Item = (usize, u32)>) -> Vec<(usize, u32)> {
    let mut seen = std::collections::BTreeMap::new();
    segments
        .map(|(axis, order)| {
            let next = seen.len();
            (*seen.entry(axis).or_insert(next), order)
        })
        .collect()
}

#[test]
fn all_grammars_have_the_axes_of_their_brackets() {
    let mut compared = 0;
    for row in builtins() {
        let preset = row.load().unwrap();
        let Some(lsystem) = preset.settings::<LSystem>() else { continue };
        let mut settings = lsystem.turtle(preset.seed());
        // A shrub's stems are one string each.
        if lsystem.stems > 1 {
            settings.habit = linden::lsystem::Stems::One;
        }
        let drawn = grow(&lsystem.grammar, &settings, &Quiet).unwrap();
        let string = derive_string(&lsystem.grammar, &settings).unwrap();
        let skeleton = Skeleton::build(drawn.branching, &Wood::default()).unwrap();
        let expected = renumbered(parsed(&string).into_iter());
        assert!(built(&skeleton) == expected, "{}", row.id);
        compared += 1;
    }
    assert!(compared > 40, "{compared}");
}

fn axes_of(axiom: &str) -> Vec<Axis> {
    Skeleton::build(crate::drawn(axiom, 45.0), &Wood::default()).unwrap().axes
}

#[test]
fn the_bracketed_branch_is_the_lateral_however_thick_it_is() {
    let axes = axes_of("!(1)F[+!(0.9)FFF]!(0.5)F");
    let said: Vec<_> = axes.iter().map(|axis| (axis.order, axis.parent, axis.len)).collect();
    assert_eq!(said, [(0, NO_PARENT, 3), (1, 1, 3)]);
}

#[test]
fn an_axis_ends_where_all_is_bracketed() {
    let axes = axes_of("F[+F][-FF]");
    let said: Vec<_> = axes.iter().map(|axis| (axis.order, axis.parent, axis.len)).collect();
    assert_eq!(said, [(0, NO_PARENT, 2), (1, 1, 1), (1, 1, 2)]);
    // From one foot: what is not bracketed is the stem.
    let foot: Vec<_> = axes_of("[+F][-FF]FFF").iter().map(|axis| (axis.order, axis.len)).collect();
    assert_eq!(foot, [(0, 4), (1, 1), (1, 2)]);
}

#[test]
fn wood_runs_on_where_an_axis_ended() {
    let forks_of = |axiom: &str| {
        let skeleton = Skeleton::build(crate::drawn(axiom, 45.0), &Wood::default()).unwrap();
        let forks = Forks::new(&skeleton);
        let onward: Vec<u32> = (0..skeleton.axes.len() as u32).filter(|&axis| forks.runs_on(axis)).collect();
        let ends: Vec<u32> = (0..skeleton.parents.len() as u32).filter(|&node| forks.ends_at(node)).collect();
        (ends, onward)
    };
    // Into the thickest, else the straightest, else the first.
    assert_eq!(forks_of("!(1)F[+!(0.5)F][-!(0.6)FF]"), (vec![1], vec![2]));
    assert_eq!(forks_of("F[+F][+(10)F]"), (vec![1], vec![2]));
    assert_eq!(forks_of("F[+F][-F]"), (vec![1], vec![1]));
    assert_eq!(forks_of("F[+F]F[-F]F"), (vec![], vec![]));
    // A cone's frustum from the end of the stem: of radii 1/2 and 1/4 and of length 1.
    let branching = crate::drawn("!(1)F[+!(0.5)F][-!(0.4)F]", 45.0);
    let radii: Vec<f64> = branching.radii.iter().flatten().map(|&radius| f64::from(radius)).collect();
    let skeleton = Skeleton::build(branching, &Wood::default()).unwrap();
    let cylinder = skeleton.cylinders()[1];
    let (lower, upper, radius) = (radii[1], radii[2], f64::from(cylinder.radius_m));
    let frustum = (lower * lower + lower * upper + upper * upper) / 3.0;
    assert!((radius * radius / frustum - 1.0).abs() < 1e-5);
    assert_eq!(skeleton.cylinders()[2].end_radii_m, [skeleton.radii[3]; 2]);
}

#[test]
fn the_rule_can_be_asked_for() {
    let branching = crate::drawn("F[+FF[+F]F]F", 45.0);
    assert_eq!(branching.edges.as_ref().map(Vec::len), Some(branching.parents.len()));
    let by = |axes| {
        let wood = Wood { axes, ..Wood::default() };
        let skeleton = Skeleton::build(branching.clone(), &wood).unwrap();
        skeleton.nodes_of(&skeleton.axes[0]).len()
    };
    assert_eq!((by(AxisRule::Auto), by(AxisRule::Grammar), by(AxisRule::Thickest)), (3, 3, 5));
}

#[test]
fn two_nodes_cannot_continue_one_axis() {
    let mut branching = crate::drawn("F[+F]F", 45.0);
    branching.edges = Some(vec![Edge::Succeeds; 4]);
    assert!(Skeleton::build(branching, &Wood::default()).is_err());
}

/// How many axes there are of each order.
fn orders(skeleton: &Skeleton) -> Vec<usize> {
    let mut counts = Vec::new();
    for axis in &skeleton.axes {
        let order = axis.order as usize;
        counts.resize(counts.len().max(order + 1), 0);
        counts[order] += 1;
    }
    counts
}

#[test]
fn refinement_and_youth_keep_axes() {
    for id in ["abop-b", "abop-aono-a", "bush-3d", "italian-cypress", "abop-signal-d"] {
        let mut preset = linden::preset::builtin(id).unwrap().load().unwrap();
        preset.set("refine", "").unwrap();
        let plain = grow_recipe(&Recipe::new(preset.clone()), &Quiet).unwrap();
        preset.set("refine", "decimate relocate smooth subdivide").unwrap();
        let refined = grow_recipe(&Recipe::new(preset.clone()), &Quiet).unwrap();
        assert_ne!(plain.skeleton.positions.len(), refined.skeleton.positions.len(), "{id}");
        assert_eq!(orders(&plain.skeleton), orders(&refined.skeleton), "{id}");
        let last = plain.skeleton.births.iter().copied().max().unwrap();
        let young = plain.skeleton.until(last * 2 / 3, &plain.wood, preset.wood_key());
        let there = plain.skeleton.born_by(last * 2 / 3);
        let mut expected = vec![0; orders(&plain.skeleton).len()];
        for axis in &plain.skeleton.axes {
            let nodes = plain.skeleton.nodes_of(axis);
            expected[axis.order as usize] += usize::from(there[nodes[0] as usize]);
        }
        while expected.last() == Some(&0) {
            expected.pop();
        }
        assert_eq!(orders(&young), expected, "{id}");
    }
}
