//! What a forester measures on a tree, for the table of truth and for comparison with it.

use linden_pipeline::Skeleton;

/// Upper limits of the classes of diameter, metres; the last class has none.
pub const CLASSES_M: [f64; 4] = [0.02, 0.05, 0.1, 0.2];

/// How the classes are called in tables.
pub const CLASS_NAMES: [&str; 5] = ["0_2cm", "2_5cm", "5_10cm", "10_20cm", "20cm_up"];

/// Length and volume of the wood of a class of diameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClassSizes {
    /// Metres.
    pub length_m: f64,
    /// Cubic metres.
    pub volume_m3: f64,
}

/// Measures of one tree, of its cylinders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeSizes {
    /// Highest node above the lowest.
    pub height_m: f64,
    /// Diameter of the thickest stem at breast height, 1.3 m along it.
    pub dbh_m: f64,
    /// By diameter: see [`CLASSES_M`].
    pub classes: [ClassSizes; 5],
}

impl TreeSizes {
    /// Measures a tree.
    pub fn of(skeleton: &Skeleton) -> Self {
        let measures = skeleton.measures();
        let mut classes = [ClassSizes::default(); 5];
        for cylinder in skeleton.cylinders() {
            let diameter_m = 2.0 * f64::from(cylinder.radius_m);
            let class = &mut classes[CLASSES_M.iter().filter(|&&limit| diameter_m >= limit).count()];
            class.length_m += f64::from(cylinder.length_m);
            class.volume_m3 += cylinder.volume_m3();
        }
        Self { height_m: measures.height_m, dbh_m: measures.trunk_diameter_m, classes }
    }

    /// Measures each tree of a skeleton that stands somewhere in another size than it grew in, in the order of their numbers.
    pub fn of_trees(skeleton: &Skeleton, scale: f32) -> Vec<Self> {
        match skeleton.tree_index() {
            None => vec![Self::scaled(skeleton, scale)],
            Some(index) => skeleton.split(&index).iter().map(|tree| Self::scaled(tree, scale)).collect(),
        }
    }

    /// Measures a tree that stands somewhere in another size than it grew in.
    pub fn scaled(skeleton: &Skeleton, scale: f32) -> Self {
        if scale == 1.0 {
            return Self::of(skeleton);
        }
        let mut scaled = skeleton.clone();
        scaled.positions.iter_mut().for_each(|position| *position *= scale);
        scaled.radii.iter_mut().for_each(|radius| *radius *= scale);
        Self::of(&scaled)
    }

    /// Of all classes.
    pub fn length_m(&self) -> f64 {
        self.classes.iter().map(|class| class.length_m).sum()
    }

    /// Of all classes.
    pub fn volume_m3(&self) -> f64 {
        self.classes.iter().map(|class| class.volume_m3).sum()
    }

    /// The names of [`TreeSizes::row`]'s columns, for CSV.
    pub fn header() -> String {
        let mut text = "height_m,dbh_m,length_m,volume_m3".to_owned();
        for name in CLASS_NAMES {
            text += &format!(",length_{name}_m,volume_{name}_m3");
        }
        text
    }

    /// Its numbers, for CSV.
    pub fn row(&self) -> String {
        let (length_m, volume_m3) = (self.length_m(), self.volume_m3());
        let mut text = format!("{:.4},{:.5},{length_m:.3},{volume_m3:.6}", self.height_m, self.dbh_m);
        for ClassSizes { length_m, volume_m3 } in self.classes {
            text += &format!(",{length_m:.3},{volume_m3:.6}");
        }
        text
    }
}
