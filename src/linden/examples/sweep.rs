//! A hundred trees of a preset, with every number of each, as CSV: `cargo run --example sweep -- > table.csv`
//!
//! Five values of a knob and twenty seeds, grown and measured by all threads; the table is the same on any number.

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use linden::report::{NUMBERS, Report};
use rayon::prelude::*;

fn measured(radius_exponent: &str, seed: u64) -> Result<Report, linden::Error> {
    let simple = linden::tree("simple")?.seed(seed).set("points", "100")?;
    simple.set("radius_exponent", radius_exponent)?.grow()?.report()
}

fn main() -> Result<(), linden::Error> {
    let exponents = ["2", "2.25", "2.5", "2.75", "3"];
    let trees: Vec<(&str, u64)> =
        exponents.iter().flat_map(|&exponent| (1..=20).map(move |seed| (exponent, seed))).collect();
    // Collected in the order of the list.
    let reports: Vec<Report> =
        trees.par_iter().map(|&(exponent, seed)| measured(exponent, seed)).collect::<Result<_, _>>()?;
    let names: Vec<&str> = NUMBERS.iter().map(|number| number.name).collect();
    println!("radius_exponent,seed,{}", names.join(","));
    for ((exponent, seed), report) in trees.iter().zip(&reports) {
        let fields: Vec<String> = NUMBERS.iter().map(|number| (number.reading)(report).field()).collect();
        println!("{exponent},{seed},{}", fields.join(","));
    }
    Ok(())
}
