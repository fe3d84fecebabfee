//! Which trees of a batch are worked on, and how such are named.

use crate::exit::say;

/// Some of the numbers from 0 to a count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// First, last and step of each stretch.
    stretches: Vec<[usize; 3]>,
}

impl Part {
    pub fn all(count: usize) -> Self {
        Self { stretches: count.checked_sub(1).map(|last| [0, last, 1]).into_iter().collect() }
    }

    /// Part `I/N` of a count: every `N`th from `I` on.
    pub fn shard(text: &str, count: usize) -> Result<Self, String> {
        let read = || format!("--shard {text}: a shard is I/N, like 0/4 to 3/4");
        let (i, n) = text.split_once('/').ok_or_else(read)?;
        let (i, n): (usize, usize) = (i.parse().map_err(|_| read())?, n.parse().map_err(|_| read())?);
        if i >= n {
            return Err(format!("--shard {text}: shards of {n} are 0/{n} to {}/{n}", n.max(1) - 1));
        }
        // More shards than trees leave some with nothing.
        let last = count.checked_sub(1).filter(|&last| i <= last);
        Ok(Self { stretches: last.map(|last| [i, last, n]).into_iter().collect() })
    }

    /// `0-99,200,300-400:10`, both ends included.
    pub fn only(text: &str, count: usize) -> Result<Self, String> {
        let read =
            |word: &str| format!("--only {word}: expected numbers and ranges like 0-99,200 or 0-999:10");
        let mut stretches = Vec::new();
        for word in text.split(',').map(str::trim) {
            let number = |text: &str| text.trim().parse::<usize>().map_err(|_| read(word));
            let (range, step) = match word.split_once(':') {
                Some((range, step)) => (range, number(step)?),
                None => (word, 1),
            };
            let (first, last) = match range.split_once('-') {
                Some((first, last)) => (number(first)?, number(last)?),
                None => (number(range)?, number(range)?),
            };
            if step == 0 || first > last {
                return Err(read(word));
            }
            if last >= count {
                return Err(format!("--only {word}: the manifest has {count} trees, numbered from 0"));
            }
            stretches.push([first, last, step]);
        }
        Ok(Self { stretches })
    }

    /// The numbers, each once where stretches do not overlap.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        self.stretches.iter().flat_map(|&[first, last, step]| (first..=last).step_by(step))
    }
}

/// Numbers in rising order as [`Part::only`] reads them; of many ranges the first ones.
pub fn ranges(numbers: &[usize]) -> String {
    const MOST: usize = 12;
    let mut stretches = numbers.chunk_by(|a, b| a + 1 == *b);
    let shown: Vec<String> = stretches
        .by_ref()
        .take(MOST)
        .map(|run| match run {
            [one] => one.to_string(),
            run => format!("{}-{}", run[0], run[run.len() - 1]),
        })
        .collect();
    let more = if stretches.next().is_some() { " and more" } else { "" };
    shown.join(",") + more
}

/// Says which trees something leaves out, and why.
pub fn say_left_out(what: &str, numbers: &[usize], why: &str) {
    if !numbers.is_empty() {
        let (count, trees) = (numbers.len(), if numbers.len() == 1 { "tree" } else { "trees" });
        say(&format!("note: {what} leaves out {count} {trees} {why}: {}", ranges(numbers)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only(text: &str) -> Vec<usize> {
        Part::only(text, 100).unwrap().numbers().collect()
    }

    #[test]
    fn ranges_are_inclusive_and_may_step() {
        assert_eq!(only("3"), [3]);
        assert_eq!(only("0-3, 98-99"), [0, 1, 2, 3, 98, 99]);
        assert_eq!(only("0-10:5"), [0, 5, 10]);
        for text in ["", "3-1", "0-3:0", "x", "0-100", "-3"] {
            assert!(Part::only(text, 100).is_err(), "{text}");
        }
    }

    #[test]
    fn shards_are_all_trees_each_once() {
        for (count, n) in [(10, 3), (2, 7), (0, 2), (7, 1)] {
            let mut all: Vec<usize> = (0..n)
                .flat_map(|i| Part::shard(&format!("{i}/{n}"), count).unwrap().numbers().collect::<Vec<_>>())
                .collect();
            all.sort_unstable();
            assert_eq!(all, (0..count).collect::<Vec<_>>());
        }
        assert!(
            Part::shard("3/3", 9).is_err() && Part::shard("1", 9).is_err() && Part::shard("0/0", 9).is_err()
        );
    }

    #[test]
    fn ranges_come_back() {
        let numbers = [0, 1, 2, 7, 9, 10];
        assert_eq!(ranges(&numbers), "0-2,7,9-10");
        assert_eq!(only(&ranges(&numbers)), numbers);
    }
}
