fn main() {
    use linden::colonization::*;
    use linden::random::Key;
    use linden::*;
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let infl: f32 = std::env::args().nth(2).unwrap().parse().unwrap();
    let reps: usize = std::env::args().nth(3).unwrap().parse().unwrap();
    let threads: usize = std::env::args().nth(4).unwrap_or("1".into()).parse().unwrap();
    let key = Key::new(1).named("ball");
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
        max_nodes: 100_000_000,
    };
    let start = Branching { positions: vec![Vec3::ZERO], parents: vec![NO_PARENT], births: vec![0] };
    let cpu = || {
        let mut s = 0.0;
        for t in std::fs::read_dir("/proc/self/task").unwrap() {
            let p = t.unwrap().path().join("schedstat");
            s += std::fs::read_to_string(p).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
        }
        s * 1e-9
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut v = vec![];
    let mut w = vec![];
    for _ in 0..reps {
        let c = cpu();
        let t = std::time::Instant::now();
        let g = pool.install(|| grow(&pts, &start, &rule, &Quiet).unwrap());
        v.push(cpu() - c);
        w.push(t.elapsed().as_secs_f64());
        if v.len() == 1 {
            print!("{} nodes {} it; ", g.branching.positions.len(), g.iterations)
        }
    }
    v.sort_by(f64::total_cmp);
    w.sort_by(f64::total_cmp);
    println!(
        "n {n} di {infl} thr {threads}: cpu min {:.4} med {:.4}; wall min {:.4}",
        v[0],
        v[reps / 2],
        w[0]
    );
}
