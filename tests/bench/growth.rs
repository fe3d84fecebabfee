fn main() {
    use linden::colonization::*;
    use linden::random::Key;
    use linden::*;
    use std::time::Instant;
    for (n, infl) in
        [(10_000usize, 8.0f32), (100_000, 8.0), (100_000, 20.), (100_000, f32::INFINITY), (1_000_000, 8.0)]
    {
        let key = Key::new(1);
        let mut pts = vec![];
        let mut i = 0;
        while pts.len() < n {
            let k = key.child(i);
            i += 1;
            let p = Vec3::new(
                k.child(0).between(-1., 1.) as f32,
                k.child(1).between(-1., 1.) as f32,
                k.child(2).between(-1., 1.) as f32,
            );
            if p.length_squared() <= 1.0 {
                pts.push(p)
            }
        }
        let spacing = (4.18879 / n as f64).cbrt() as f32;
        let d = 0.5 * spacing;
        let rule = GrowthRule {
            step: d,
            influence: infl * d,
            kill: 2.0 * d,
            tropism: Vec3::ZERO,
            max_iterations: 100000,
            max_nodes: 10_000_000,
        };
        let start = Branching { positions: vec![Vec3::ZERO], parents: vec![NO_PARENT], births: vec![0] };
        for threads in [1] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut best = f64::MAX;
            let mut g = None;
            for _ in 0..3 {
                let t = Instant::now();
                g = Some(pool.install(|| grow(&pts, &start, &rule, &Quiet).unwrap()));
                best = best.min(t.elapsed().as_secs_f64());
            }
            let g = g.unwrap();
            println!(
                "{n} {infl} t{threads} nodes {} it {} un {} {:?} {:.4}s {:.0} ns/node",
                g.branching.positions.len(),
                g.iterations,
                g.unreached,
                g.stop,
                best,
                best * 1e9 / g.branching.positions.len() as f64
            );
        }
    }
}
