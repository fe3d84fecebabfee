//! Rules that never apply, whatever grows: seen from the grammar alone.

use std::collections::{BTreeMap, BTreeSet};

use super::grammar::{Grammar, Module, Pattern, Production};

/// A symbol with a number of arguments, as rules tell modules apart.
type Class = (char, usize);

impl Grammar {
    /// What to say of each rule that never applies. Conditions and probabilities are not looked into: constants may
    /// turn a rule on and off.
    ///
    /// ```
    /// let grammar = linden_lsystem::Grammar::new("X", &["X -> F[+Y(1)]X", "Y -> F"])?;
    /// let note = "rule 2 (Y -> F) never applies: Y comes with 1 argument, and the rule takes none";
    /// assert_eq!(grammar.unused(), [note]);
    /// # Ok::<(), linden_lsystem::GrammarError>(())
    /// ```
    pub fn unused(&self) -> Vec<String> {
        let takers = self.takers();
        let known = self.reached(&takers);
        let why = |(index, rule)| Some((index, self.why_unused((index, rule), &takers, &known)?));
        let unused = self.productions().iter().enumerate().filter_map(why);
        unused.map(|(index, why)| format!("{} never applies: {why}", self.rule_shown(index))).collect()
    }

    /// The first rule for each module that takes it wherever it stands and whatever its arguments are.
    fn takers(&self) -> BTreeMap<Class, usize> {
        let mut takers = BTreeMap::new();
        for (index, rule) in self.productions().iter().enumerate() {
            if rule.condition.is_none() && !has_context(rule) {
                takers.entry(rule.predecessor.class()).or_insert(index);
            }
        }
        takers
    }

    /// The modules that can come up.
    fn reached(&self, takers: &BTreeMap<Class, usize>) -> BTreeSet<Class> {
        let class = |module: &Module| (module.symbol, module.arguments.len());
        // For each module the rules that wait for it, and for each rule how many modules it waits for.
        let mut waiting: BTreeMap<Class, Vec<usize>> = BTreeMap::new();
        let mut missing = vec![0_usize; self.productions().len()];
        for (index, rule) in self.productions().iter().enumerate() {
            if taken_before((index, rule), takers).is_some() || self.ignored_context(rule).is_some() {
                continue;
            }
            let wanted: BTreeSet<Class> =
                context(rule).chain([&rule.predecessor]).map(Pattern::class).collect();
            missing[index] = wanted.len();
            for class in wanted {
                waiting.entry(class).or_default().push(index);
            }
        }
        let mut known = BTreeSet::new();
        let mut front: Vec<Class> = self.axiom().iter().map(class).collect();
        while let Some(next) = front.pop() {
            if !known.insert(next) {
                continue;
            }
            for &index in waiting.get(&next).into_iter().flatten() {
                missing[index] -= 1;
                if missing[index] == 0 {
                    front.extend(self.productions()[index].successor.iter().map(class));
                }
            }
        }
        known
    }

    /// Why a rule does not apply where only the `known` modules come up.
    fn why_unused(
        &self,
        (index, rule): (usize, &Production),
        takers: &BTreeMap<Class, usize>,
        known: &BTreeSet<Class>,
    ) -> Option<String> {
        let class @ (symbol, taken) = rule.predecessor.class();
        if !known.contains(&class) {
            let given = known.range((symbol, 0)..=(symbol, usize::MAX)).map(|&(_, count)| count);
            let given: Vec<String> = given.map(arguments).collect();
            let taken = if taken == 0 { "none".to_owned() } else { taken.to_string() };
            return Some(match &given[..] {
                [] => format!("no {symbol} comes up"),
                given => format!("{symbol} comes with {}, and the rule takes {taken}", given.join(" or ")),
            });
        }
        if let Some(ignored) = self.ignored_context(rule) {
            return Some(format!("its context has {ignored}, which #ignore passes over"));
        }
        if let Some(pattern) = context(rule).find(|pattern| !known.contains(&pattern.class())) {
            let (symbol, count) = pattern.class();
            return Some(format!(
                "its context has {symbol} with {}, and no such {symbol} comes up",
                arguments(count)
            ));
        }
        let before = taken_before((index, rule), takers)?;
        Some(format!("{} takes every {symbol} before it", self.rule_shown(before)))
    }

    /// A symbol of a rule's contexts that these pass over.
    fn ignored_context(&self, rule: &Production) -> Option<char> {
        context(rule).map(|pattern| pattern.symbol).find(|symbol| self.ignored().contains(symbol))
    }
}

/// The modules of a rule's contexts.
fn context(rule: &Production) -> impl Iterator<Item = &Pattern> {
    rule.left.iter().chain(&rule.right).filter(|pattern| !matches!(pattern.symbol, '[' | ']'))
}

fn has_context(rule: &Production) -> bool {
    !(rule.left.is_empty() && rule.right.is_empty())
}

/// The rule that leaves nothing to another one. Rules with a context are tried before the others, and those in their
/// order; without a condition this one would share out its probability.
fn taken_before((index, rule): (usize, &Production), takers: &BTreeMap<Class, usize>) -> Option<usize> {
    let is_late = rule.condition.is_some() && !has_context(rule);
    takers.get(&rule.predecessor.class()).copied().filter(|&taker| is_late && taker < index)
}

/// A number of arguments, with its noun.
fn arguments(count: usize) -> String {
    match count {
        0 => "no argument".to_owned(),
        1 => "1 argument".to_owned(),
        count => format!("{count} arguments"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn unused(axiom: &str, rules: &[&str]) -> Vec<String> {
        Grammar::new(axiom, rules).unwrap().unused()
    }

    #[test]
    fn rules_for_what_never_comes_up_are_named() {
        for (axiom, rules, notes) in [
            (
                "F(1)",
                &["F -> FF"][..],
                &["rule 1 (F -> FF) never applies: F comes with 1 argument, and the rule takes none"][..],
            ),
            (
                "FF(1)",
                &["F(a,b) -> FF"],
                &[
                    "rule 1 (F(a,b) -> FF) never applies: F comes with no argument or 1 argument, and the rule takes 2",
                ],
            ),
            (
                "F",
                &["#define r 2", "Z -> FF", "F -> F(r)"],
                &["rule 2 (Z -> FF) never applies: no Z comes up"],
            ),
            // What only such a rule writes does not come up either.
            (
                "F",
                &["Y -> Z", "Z -> F"],
                &[
                    "rule 1 (Y -> Z) never applies: no Y comes up",
                    "rule 2 (Z -> F) never applies: no Z comes up",
                ],
            ),
            (
                "F",
                &["F < F -> FF", "F < A -> B", "A -> F"],
                &[
                    "rule 2 (F < A -> B) never applies: no A comes up",
                    "rule 3 (A -> F) never applies: no A comes up",
                ],
            ),
            (
                "FA",
                &["F > [+A(x)] -> FF"],
                &[
                    "rule 1 (F > [+A(x)] -> FF) never applies: its context has + with no argument, and no such + comes up",
                ],
            ),
            (
                "F+A",
                &["#ignore +", "+ < A -> F"],
                &["rule 2 (+ < A -> F) never applies: its context has +, which #ignore passes over"],
            ),
            (
                "F(1)",
                &["F(x) -> F(x)F", "F(x) : x > 1 -> F"],
                &["rule 2 (F(x) : x>1 -> F) never applies: rule 1 (F(x) -> F(x)F) takes every F before it"],
            ),
        ] {
            assert_eq!(unused(axiom, rules), notes, "{rules:?}");
        }
    }

    #[test]
    fn rules_that_can_apply_are_not() {
        for (axiom, rules) in [
            ("X", &["X -> F[+X]F[-X]+X", "F -> FF"][..]),
            // The turn of a condition or a probability may come by a constant.
            ("F", &["F : 0 -> A", "A -> F", "B -> (0) F", "F -> B", "B -> (1) A"]),
            ("F", &["F -> (0.5) FF", "F -> (0.5) F"]),
            // Contexts are tried first, wherever they stand.
            ("FA", &["A -> F", "F < A -> FA"]),
            ("A(1)", &["A(x) : x > 1 -> F", "A(x) -> A(x+1)"]),
        ] {
            assert_eq!(unused(axiom, rules), [""; 0], "{rules:?}");
        }
    }
}
