//! How much wood the tubes hold.

/// A piece of a tube between two of its rings, or its end, as if it were round: with flare, collar, smoothing and taper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Index of the axis.
    pub axis: u32,
    /// Along the axis, metres.
    pub length_m: f64,
    /// Of the circles that have as much area as its lower end and its upper one, metres.
    pub radii_m: [f64; 2],
    /// Whether it is what closes the tube beyond its last ring: a bud, or a break as high as it is on average.
    pub is_end: bool,
}

impl Stretch {
    /// The volume of the frustum between its ends, cubic metres.
    pub fn volume_m3(&self) -> f64 {
        let radius_m = self.radius_m();
        std::f64::consts::PI * radius_m * radius_m * self.length_m
    }

    /// Of the cylinder that holds as much, metres.
    pub fn radius_m(&self) -> f64 {
        let [lower, upper] = self.radii_m;
        ((lower * lower + lower * upper + upper * upper) / 3.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::features_tests::ALL;
    use super::super::tests::{gnarled, tree, volume};
    use super::super::{Ends, Features, Junction, Tubes, survey, sweep};
    use glam::Vec3;
    use linden_base::monitor::Quiet;
    use linden_skeleton::{Branching, NO_PARENT, Skeleton, WidthSteps, Wood};

    fn held_m3(skeleton: &Skeleton, tubes: &Tubes) -> f64 {
        let mut held_m3 = 0.0;
        survey(skeleton, tubes, &mut |stretch| held_m3 += stretch.volume_m3(), &Quiet).unwrap();
        held_m3
    }

    /// Its mesh is a solid whose volume is known without any tube.
    #[test]
    fn stretches_hold_what_the_mesh_holds() {
        let cut = Features { ends: Ends::Cut, ..Features::default() };
        let flared = Features { flare: 0.8, flare_height_m: Some(1.0), ..cut };
        let positions =
            vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 3.0, Vec3::new(1.5, 2.0, 0.0), Vec3::new(0.4, 4.0, 0.0)];
        let parents = vec![NO_PARENT, 0, 1, 1, 2];
        let wood = Wood { tip_radius_m: Some(0.1), ..Wood::default() };
        let skeleton = tree(positions, parents, &wood);
        let [bud, broken] = [Ends::Bud, Ends::Broken].map(|ends| Features { ends, ..cut });
        let ridged = Features { flare_ridges: 5, ..flared };
        for features in [cut, flared, ridged, bud, broken, Features { collar: 0.5, ..cut }] {
            for (rings, width_smoothing) in [(1, 0.0), (1, 2.0), (4, 2.0)] {
                let tubes = Tubes { sides: 64, rings, width_smoothing, features, ..Tubes::default() };
                let meshed = volume(&sweep(&skeleton, &tubes, &Quiet).unwrap());
                let share = held_m3(&skeleton, &tubes) / meshed;
                assert!((share - 1.0).abs() < 0.005, "{share} with {tubes:?}");
            }
        }
    }

    #[test]
    fn steps_are_cylinders_to_the_last_digit() {
        // !(1)F!(0.5)F!(0.5)F, round a corner of a right angle.
        let branching = Branching {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 1.0, 0.0)],
            parents: vec![NO_PARENT, 0, 1, 2],
            births: vec![0; 4],
            radii: Some(vec![0.2, 0.2, 0.1, 0.1]),
            edges: None,
        };
        let wood = Wood { width_steps: WidthSteps::Cylinder, ..Wood::default() };
        let skeleton = Skeleton::build(branching, &wood).unwrap();
        let asked_m3 = std::f64::consts::PI * (0.04 + 0.01 + 0.01);
        let features = Features { ends: Ends::Cut, ..Features::default() };
        let tubes = Tubes { sides: 64, features, ..Tubes::default() };
        for found in [held_m3(&skeleton, &tubes), skeleton.measures().wood_volume_m3] {
            assert!((found / asked_m3 - 1.0).abs() < 1e-6, "{found}");
        }
        let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
        assert!((volume(&mesh) / asked_m3 - 1.0).abs() < 0.01, "{}", volume(&mesh));
        // A step is a flat ledge, not a cone: the normals of the walls stay across the axis.
        let straight = mesh.normals.iter().zip(&mesh.positions).filter(|(_, at)| at.x < 0.7 && at.y < 0.7);
        assert!(straight.clone().count() > 64);
        assert!(straight.map(|(normal, _)| normal.y).all(|y| y.abs() < 1e-5 || y == -1.0));
    }

    /// Everything that folds a tube, in steps.
    #[test]
    fn gnarled_wood_in_steps_stays_closed() {
        for seed in 0..40 {
            let skeleton = Skeleton { width_steps: WidthSteps::Cylinder, ..gnarled(seed) };
            for junction in [Junction::Overlap, Junction::Blend] {
                let tubes = Tubes { junction, ..Tubes::default() };
                let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
                let found = crate::surface::topology(&mesh, &Quiet).unwrap();
                assert_eq!((found.open_edges, found.degenerate, found.not_finite), (0, 0, 0), "seed {seed}");
                assert!(found.flipped * 10_000 < mesh.triangles.len(), "seed {seed}: {}", found.flipped);
                let counted = crate::surface::count(&skeleton, &tubes, &Quiet).unwrap();
                assert_eq!(counted.iter().map(|tube| tube.vertices).sum::<usize>(), mesh.positions.len());
            }
            let tubes = Tubes { features: ALL, width_smoothing: 0.0, ..Tubes::default() };
            let mesh = sweep(&skeleton, &tubes, &Quiet).unwrap();
            assert_eq!(crate::surface::topology(&mesh, &Quiet).unwrap().open_edges, 0, "seed {seed}");
        }
    }
}
