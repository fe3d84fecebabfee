//! A manifest's text: TOML as people write it, or JSON Lines, one tree a line.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use linden_base::document::{Datum, Entry, Fault, List, Node, TextPlace};
use linden_base::knob::{did_you_mean, excerpt, nearest};

use super::draw::{self, Of};
use super::values::values;
use super::{Manifest, Sampling, Seeds, TreeKind, Values, Varied};

const TREES: List = List { key: "trees", heading: "[[trees]]", one: "kind", most: (1_000_000, "a manifest") };

/// What stands beside the trees.
const KEYS: [&str; 4] = ["formats", "options", "seed", "trees"];

/// What a kind of trees may say.
const TREE_KEYS: [&str; 9] =
    ["source", "seeds", "seed", "ages", "set", "define", "formats", "samples", "sampling"];

/// The most samples of a kind.
const MOST_SAMPLES: u64 = 100_000_000;

impl Manifest {
    /// Reads a manifest: JSON Lines where it begins with `{`, else TOML.
    ///
    /// # Errors
    /// What is wrong and where.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        if text.trim_start().starts_with('{') { Self::from_lines(text) } else { Self::from_toml(text) }
    }

    fn from_toml(text: &str) -> Result<Self, Fault> {
        let document = Node::from_toml(text)?;
        let Datum::Table(entries) = &document.datum else {
            return Err(Fault::new(document.place, "a manifest is a table of keys"));
        };
        let mut manifest = Self::default();
        for entry in entries {
            match entry.key.as_str() {
                "formats" => manifest.formats = texts(entry)?,
                "options" => {
                    for (name, value) in table(entry, "options of formats, like { \"glb.quantize\" = true }")?
                    {
                        manifest.options.insert(name.to_owned(), scalar(name, value)?);
                    }
                }
                "seed" => manifest.seed = whole(entry, 0, u64::MAX)?,
                "trees" => manifest.trees = TREES.read(&entry.node, kind)?,
                other => {
                    let meant = did_you_mean(nearest(other, KEYS));
                    let message = format!("a manifest has no '{}'{meant}", excerpt(other));
                    return Err(Fault::new(entry.place, message));
                }
            }
        }
        manifest.checked()
    }

    fn from_lines(text: &str) -> Result<Self, Fault> {
        let mut manifest = Self::default();
        for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let place = TextPlace { line: index + 1, column: 1 };
            let here = |fault: Fault| Fault { place: Some(place), ..fault };
            let node = Node::from_json(line).map_err(here)?;
            let Datum::Table(entries) = &node.datum else {
                return Err(here(
                    node.mismatch("the line", "an object like {\"source\": \"oak\", \"seed\": 7}"),
                ));
            };
            manifest.trees.push(kind(index + 1, entries, None).map_err(here)?);
        }
        manifest.checked()
    }

    fn checked(self) -> Result<Self, Fault> {
        if self.trees.is_empty() {
            return Err(Fault::new(None, "a manifest needs at least one [[trees]] with its source"));
        }
        let without = self.trees.iter().position(|kind| kind.formats.is_empty() && self.formats.is_empty());
        if let Some(index) = without {
            let message = format!("kind {} says no formats: formats = [\"glb\"]", index + 1);
            return Err(Fault::new(None, message));
        }
        Ok(self)
    }
}

/// One `[[trees]]`.
fn kind(number: usize, entries: &[Entry], place: Option<TextPlace>) -> Result<TreeKind, Fault> {
    let mut kind = TreeKind {
        source: String::new(),
        formats: Vec::new(),
        seeds: None,
        ages: Vec::new(),
        samples: 1,
        sampling: Sampling::default(),
        set: Vec::new(),
        define: Vec::new(),
    };
    for entry in entries {
        match entry.key.as_str() {
            "source" => entry.node.text("source")?.clone_into(&mut kind.source),
            "formats" => kind.formats = texts(entry)?,
            "seed" => kind.seeds = Some(Seeds::List(vec![whole(entry, 0, u64::MAX)?])),
            "seeds" => kind.seeds = Some(seeds(entry)?),
            "ages" => kind.ages = ages(entry)?,
            "samples" => kind.samples = whole(entry, 1, MOST_SAMPLES)?,
            "sampling" => {
                let word = entry.node.text("sampling")?;
                let found = Sampling::named(word);
                kind.sampling = found.ok_or_else(|| entry.node.mismatch("sampling", "random or latin"))?;
            }
            "set" => kind.set = varied(Of::Knob, entry, "knobs like { points = \"3000..6000\" }")?,
            "define" => {
                kind.define =
                    varied(Of::Constant, entry, "constants of the grammar like { r1 = [0.8, 0.9] }")?;
            }
            _ => return Err(TREES.unknown(number, entry, &TREE_KEYS)),
        }
    }
    if kind.source.trim().is_empty() {
        let message = format!("kind {number} needs a source: source = \"oak\"");
        return Err(Fault::new(place, message));
    }
    Ok(kind)
}

fn table<'a>(entry: &'a Entry, expected: &str) -> Result<BTreeMap<&'a str, &'a Entry>, Fault> {
    let Datum::Table(entries) = &entry.node.datum else {
        return Err(entry.node.mismatch(&entry.key, &format!("a table of {expected}")));
    };
    Ok(entries.iter().map(|entry| (entry.key.as_str(), entry)).collect())
}

fn varied(of: Of, entry: &Entry, expected: &str) -> Result<Vec<Varied>, Fault> {
    let each = table(entry, expected)?.into_iter();
    let one = |(name, entry): (&str, &Entry)| {
        Ok(Varied { name: name.to_owned(), values: values_of(of, name, entry)? })
    };
    each.map(one).collect()
}

/// A list is each of its values, and so is a range with a step; what is drawn is text.
fn values_of(of: Of, name: &str, entry: &Entry) -> Result<Values, Fault> {
    if let Datum::List(nodes) = &entry.node.datum {
        if nodes.is_empty() {
            return Err(entry.node.mismatch(&excerpt(name), "at least one value"));
        }
        let each = nodes.iter().map(|node| scalar_of(name, node));
        return Ok(Values::Each(each.collect::<Result<_, _>>()?));
    }
    let text = scalar(name, entry)?;
    let fault = |message: String| Fault::new(entry.node.place, format!("'{}': {message}", excerpt(name)));
    if let Some(spread) = draw::spread(of, name, &text) {
        return Ok(Values::Drawn(spread.map_err(fault)?));
    }
    // Commas may belong to a value; a list is written as one.
    let is_range = text.contains(':');
    Ok(Values::Each(if is_range { values(&text).map_err(fault)? } else { vec![text] }))
}

fn scalar(name: &str, entry: &Entry) -> Result<String, Fault> {
    scalar_of(name, &entry.node)
}

/// A value as it would be typed.
fn scalar_of(name: &str, node: &Node) -> Result<String, Fault> {
    match &node.datum {
        Datum::Text(text) => Ok(text.clone()),
        Datum::Real(x) => Ok(x.to_string()),
        Datum::Integer(n) => Ok(n.to_string()),
        Datum::Switch(on) => Ok(on.to_string()),
        Datum::List(_) | Datum::Table(_) => {
            Err(node.mismatch(&excerpt(name), "a number, text, true or false"))
        }
    }
}

fn texts(entry: &Entry) -> Result<Vec<String>, Fault> {
    let Datum::List(nodes) = &entry.node.datum else {
        return Err(entry.node.mismatch(&entry.key, "a list like [\"glb\", \"qsm\"]"));
    };
    let texts = nodes.iter().map(|node| Ok(node.text(&entry.key)?.to_owned()));
    let texts: Vec<String> = texts.collect::<Result<_, Fault>>()?;
    distinct(&entry.key, nodes, &texts)?;
    Ok(texts)
}

/// Ages as `--age` names one: names, shares and years.
fn ages(entry: &Entry) -> Result<Vec<String>, Fault> {
    const EXPECTED: &str = "a list of ages like [\"young\", \"half=0.5\", \"10y\"]";
    let nodes = match &entry.node.datum {
        Datum::List(nodes) if !nodes.is_empty() => nodes,
        _ => return Err(entry.node.mismatch("ages", EXPECTED)),
    };
    let ages: Vec<String> = nodes.iter().map(|node| scalar_of("ages", node)).collect::<Result<_, _>>()?;
    // How many these are says the source, whose files may be others by the time that a part is grown.
    if let Some(at) = ages.iter().position(|age| age.trim() == "all" || age.contains(',')) {
        let message = format!("'ages': '{}' is not one age; name each: {EXPECTED}", excerpt(&ages[at]));
        return Err(Fault::new(nodes[at].place, message));
    }
    distinct("ages", nodes, &ages)?;
    Ok(ages)
}

/// Refuses what stands twice in a list; more trees of a seed with values that are drawn are `samples`.
fn distinct<T: Ord + Display>(key: &str, nodes: &[Node], values: &[T]) -> Result<(), Fault> {
    let mut before = BTreeSet::new();
    match values.iter().position(|value| !before.insert(value)) {
        Some(at) => {
            let value = excerpt(&values[at].to_string());
            Err(Fault::new(nodes[at].place, format!("'{key}' has {value} twice; keep one")))
        }
        None => Ok(()),
    }
}

fn whole(entry: &Entry, least: u64, most: u64) -> Result<u64, Fault> {
    match entry.node.datum {
        Datum::Integer(n) if (least..=most).contains(&n) => Ok(n),
        Datum::Integer(n) => {
            let message = format!("'{}' is {n}, expected a whole number from {least} to {most}", entry.key);
            Err(Fault::new(entry.node.place, message))
        }
        _ => Err(entry.node.mismatch(&entry.key, &format!("a whole number from {least} to {most}"))),
    }
}

/// `"1..50"`, both included, or a list.
fn seeds(entry: &Entry) -> Result<Seeds, Fault> {
    const EXPECTED: &str = "seeds like \"1..50\", or a list of them";
    match &entry.node.datum {
        Datum::Integer(seed) => Ok(Seeds::List(vec![*seed])),
        Datum::List(nodes) if !nodes.is_empty() => {
            let each = nodes.iter().map(|node| match node.datum {
                Datum::Integer(seed) => Ok(seed),
                _ => Err(node.mismatch("seeds", "a whole number")),
            });
            let seeds: Vec<u64> = each.collect::<Result<_, _>>()?;
            distinct("seeds", nodes, &seeds)?;
            Ok(Seeds::List(seeds))
        }
        Datum::Text(text) => {
            let ends = text
                .split_once("..")
                .and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
            match ends {
                Some((first, last)) if first <= last => Ok(Seeds::Range(first, last)),
                Some((first, last)) => {
                    let message =
                        format!("'seeds': {first}..{last} ends before it begins; write {last}..{first}");
                    Err(Fault::new(entry.node.place, message))
                }
                _ => Err(entry.node.mismatch("seeds", EXPECTED)),
            }
        }
        _ => Err(entry.node.mismatch("seeds", EXPECTED)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANIFEST: &str = r#"
        formats = ["glb", "csv"]
        options = { "glb.quantize" = true }
        [[trees]]
        source = "fir"
        seeds = [7, 9]
        set = { points = [100, 200], kill = "1D" }
        [[trees]]
        source = "abop-honda-a"
        formats = ["obj"]
        define = { r1 = "0.7:0.9:0.1" }
        samples = 4
        sampling = "latin"
        set = { angle = "20..40.0" }
    "#;

    #[test]
    fn items_are_the_product_in_the_documents_order() {
        let manifest = Manifest::parse(MANIFEST).unwrap();
        assert_eq!((manifest.len(), manifest.options["glb.quantize"].as_str()), (4 + 12, "true"));
        let of = |number: usize| manifest.item(number).unwrap();
        let firs: Vec<_> =
            (0..4).map(|number| (of(number).seed.unwrap(), of(number).set[1].1.clone())).collect();
        assert_eq!(firs, [(7, "100".into()), (9, "100".into()), (7, "200".into()), (9, "200".into())]);
        assert_eq!(of(0).formats, ["glb", "csv"]);
        assert_eq!(
            (of(4).source, of(4).formats, of(4).seed),
            ("abop-honda-a", &["obj".to_owned()][..], None)
        );
        let constants: Vec<_> = (4..16).map(|number| of(number).define[0].1.clone()).collect();
        assert_eq!(constants[..5], ["0.7", "0.7", "0.7", "0.7", "0.8"]);
        // A hypercube: one angle in each quarter, for each constant.
        for four in [4, 8, 12] {
            let mut quarters: Vec<_> = (four..four + 4)
                .map(|number| ((of(number).set[0].1.parse::<f64>().unwrap() - 20.0) / 5.0) as u32)
                .collect();
            quarters.sort_unstable();
            assert_eq!(quarters, [0, 1, 2, 3]);
        }
        assert_eq!(manifest.item(16), None);
    }

    #[test]
    fn what_is_drawn_does_not_depend_on_other_kinds() {
        let alone =
            MANIFEST.replacen("source = \"fir\"", "source = \"larch\"", 1).replace("[7, 9]", "\"1..50\"");
        let (one, other) = (Manifest::parse(MANIFEST).unwrap(), Manifest::parse(&alone).unwrap());
        assert_eq!(other.len(), 112);
        for number in 0..12 {
            assert_eq!(one.item(4 + number).unwrap().set, other.item(100 + number).unwrap().set);
        }
    }

    #[test]
    fn each_tree_is_grown_at_all_ages_with_the_same_draws() {
        let aged = MANIFEST.replace("sampling = ", "ages = [\"young\", 0.5, \"10y\"]\nsampling = ");
        let (plain, aged) = (Manifest::parse(MANIFEST).unwrap(), Manifest::parse(&aged).unwrap());
        assert_eq!(aged.len(), 4 + 3 * 12);
        assert_eq!(aged.item(3).unwrap().age, None);
        for number in 0..12 {
            let tree = plain.item(4 + number).unwrap();
            for (at, age) in ["young", "0.5", "10y"].into_iter().enumerate() {
                let item = aged.item(4 + 3 * number + at).unwrap();
                assert_eq!(
                    (item.age, item.set, item.define),
                    (Some(age), tree.set.clone(), tree.define.clone())
                );
            }
        }
        let line = "{\"source\": \"oak\", \"ages\": [\"young\", \"half=0.5\"], \"formats\": [\"glb\"]}";
        assert_eq!(Manifest::parse(line).unwrap().len(), 2);
        for (ages, expected) in [
            ("[]", "a list of ages like"),
            ("\"young\"", "a list of ages like"),
            ("[\"young\", \"young\"]", "4:18: 'ages' has young twice"),
            ("[\"young\", \"all\"]", "4:18: 'ages': 'all' is not one age; name each"),
            ("[\"young,10y\"]", "'young,10y' is not one age"),
        ] {
            let text = format!("formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nages = {ages}\n");
            let said = Manifest::parse(&text).unwrap_err().to_string();
            assert!(said.contains(expected), "{ages}: {said}");
        }
    }

    #[test]
    fn lines_are_trees() {
        let lines = "{\"source\": \"oak\", \"seed\": 3, \"formats\": [\"glb\"]}\n\n\
                     {\"source\": \"fir\", \"set\": {\"points\": 200, \"space\": \"0,1,0\"}, \"formats\": [\"stl\"]}\n";
        let manifest = Manifest::parse(lines).unwrap();
        assert_eq!(manifest.len(), 2);
        assert_eq!(manifest.item(0).unwrap().seed, Some(3));
        let fir = manifest.item(1).unwrap();
        assert_eq!(fir.set, [("points", "200".to_owned()), ("space", "0,1,0".to_owned())]);
    }

    #[test]
    fn faults_are_told_with_their_place() {
        for (text, expected) in [
            ("formats = [\"glb\"]\n", "at least one [[trees]]"),
            ("[[trees]]\nsource = \"oak\"\n", "kind 1 says no formats"),
            ("formats = [\"glb\"]\n[[trees]]\nseeds = \"1..3\"\n", "kind 1 needs a source"),
            (
                "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nseed_s = 3\n",
                "4:1: kind 1 has no 'seed_s' (did you mean",
            ),
            (
                "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nseeds = \"3..1\"\n",
                "4:9: 'seeds': 3..1 ends before it begins; write 1..3",
            ),
            (
                "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nseeds = [1, 2, 1]\n",
                "4:16: 'seeds' has 1 twice",
            ),
            (
                "formats = [\"qsm\", \"glb\", \"qsm\"]\n[[trees]]\nsource = \"oak\"\n",
                "1:26: 'formats' has qsm twice",
            ),
            ("formats = \"glb\"\n", "a list like [\"glb\", \"qsm\"]"),
            (
                "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nsamples = 0\n",
                "4:11: 'samples' is 0, expected a whole number from 1 to",
            ),
            (
                "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nset = { points = \"9..1\" }\n",
                "the first number must be the smaller one",
            ),
            (
                "formats = [\"glb\"]\n[[trees]]\nsource = \"oak\"\nset = { points = [] }\n",
                "at least one value",
            ),
            ("format = [\"glb\"]\n", "1:1: a manifest has no 'format' (did you mean 'formats'?)"),
            ("{\"source\": \"oak\"}\n[]\n", "2:1: "),
        ] {
            let said = Manifest::parse(text).unwrap_err().to_string();
            assert!(said.contains(expected), "{text:?}: {said}");
        }
    }
}
