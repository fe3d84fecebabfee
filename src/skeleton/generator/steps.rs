//! The steps in which trees grow.

/// Steps in which a tree grew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// How many.
    pub count: u32,
    /// What one of them is called, like `derivation`.
    pub unit: &'static str,
}

impl Steps {
    /// How many of `count` steps a tree has behind it after a share of its growth: one at least, where there are any.
    ///
    /// ```
    /// use linden_skeleton::generator::Steps;
    /// assert_eq!([0.0, 0.2, 0.21, 1.0].map(|age| Steps::after(age, 5)), [1, 1, 2, 5]);
    /// assert_eq!(Steps::after(0.3, 0), 0);
    /// ```
    pub fn after(age: f64, count: u32) -> u32 {
        // Shares of whole numbers come out a little above them.
        let step = libm::ceil(age * f64::from(count) - 1e-9) as u32;
        step.clamp(count.min(1), count)
    }

    /// The number of steps and the share of them that settings of `count` steps have for the tree at a step. What is not
    /// drawn yet has no age, and no tree is older than it is whole.
    ///
    /// ```
    /// use linden_skeleton::generator::Steps;
    /// let (count, age) = Steps::at(3, 7);
    /// assert_eq!((count, Steps::after(age, count)), (7, 3));
    /// assert_eq!([Steps::at(0, 7), Steps::at(9, 7)], [(0, 1.0), (9, 1.0)]);
    /// ```
    pub fn at(step: u32, count: u32) -> (u32, f64) {
        if (1..count).contains(&step) { (count, f64::from(step) / f64::from(count)) } else { (step, 1.0) }
    }
}
