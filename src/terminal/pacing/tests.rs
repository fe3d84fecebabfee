use super::*;

const MS: Duration = Duration::from_millis(1);
const KEY: usize = 100;

/// A link with one queue before it and a terminal behind it that answers, or does not.
#[derive(Debug)]
struct Link {
    /// Bytes a millisecond.
    rate: f64,
    one_way: Duration,
    answers: bool,
    /// The most that a reply is late by, from no cause that bytes have.
    jitter: Duration,
    noise: u32,
    /// When the queue is empty again.
    free: Instant,
    /// When replies arrive.
    replies: VecDeque<Instant>,
}

impl Link {
    fn new(bytes_per_second: f64, round_trip: Duration, answers: bool, now: Instant) -> Self {
        let one_way = round_trip / 2;
        Self {
            rate: bytes_per_second / 1e3,
            one_way,
            answers,
            jitter: Duration::ZERO,
            noise: 7,
            free: now,
            replies: VecDeque::new(),
        }
    }

    fn takes(&self, bytes: usize) -> Duration {
        Duration::from_secs_f64(bytes as f64 / self.rate / 1e3)
    }

    fn send(&mut self, bytes: usize, asks: bool, now: Instant) {
        self.free = self.free.max(now) + self.takes(bytes);
        if asks && self.answers {
            // Replies do not overtake each other.
            self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let at = self.free + self.one_way * 2 + self.jitter * (self.noise >> 24) / 255;
            self.replies.push_back(self.replies.back().map_or(at, |&last| last.max(at)));
        }
    }
}

/// What a run showed.
#[derive(Debug)]
struct Run {
    /// The slowest answer to a key, at any millisecond.
    slowest_key: Duration,
    /// Bytes sent in each second.
    sent: Vec<usize>,
    pacer: Pacer,
    link: Link,
    now: Instant,
}

/// Sends pictures without end.
fn run(pacer: Pacer, link: Link, start: Instant, seconds: usize) -> Run {
    let mut run = Run { slowest_key: Duration::ZERO, sent: vec![0; seconds], pacer, link, now: start };
    for ms in 0..seconds as u32 * 1000 {
        let now = start + MS * ms;
        run.now = now;
        while run.link.replies.front().is_some_and(|&at| at <= now) {
            run.link.replies.pop_front();
            run.pacer.acked(now);
        }
        loop {
            let bytes = run.pacer.allowance(now).min(64 << 10);
            // A local terminal takes what it takes: the writer thread does not queue.
            if bytes == 0 || run.link.free.saturating_duration_since(now) > Duration::from_millis(400) {
                break;
            }
            let asks = run.pacer.asks(bytes);
            run.pacer.sent(bytes + if asks { QUERY.len() } else { 0 }, now);
            run.link.send(bytes + if asks { QUERY.len() } else { 0 }, asks, now);
            run.sent[ms as usize / 1000] += bytes;
        }
        // A key that arrives now: its answer goes behind all that was sent.
        let waits = run.link.free.saturating_duration_since(now) + run.link.takes(KEY);
        run.slowest_key = run.slowest_key.max(waits + run.link.one_way * 2);
    }
    run
}

fn pictures(bytes_per_second: f64, round_trip: u64, remote: bool, seconds: usize) -> Run {
    let now = Instant::now();
    let link = Link::new(bytes_per_second, Duration::from_millis(round_trip), true, now);
    run(Pacer::new(remote), link, now, seconds)
}

fn share(run: &Run, rate: f64) -> f64 {
    // Once started: after the first second.
    let later = &run.sent[1..];
    later.iter().sum::<usize>() as f64 / later.len() as f64 / rate
}

#[test]
fn keys_are_answered_in_time_on_a_slow_link() {
    let run = pictures(12_500.0, 150, true, 30);
    assert!(run.slowest_key <= Duration::from_millis(300), "{:?}", run.slowest_key);
    assert!(share(&run, 12_500.0) >= 0.6, "{}: {:?}", share(&run, 12_500.0), run.sent);
}

#[test]
fn a_large_text_does_not_open_the_window() {
    for (rate, round_trip, budget) in [(12_500.0, 150, 300), (125_000.0, 100, 150)] {
        let start = Instant::now();
        let mut link = Link::new(rate, Duration::from_millis(round_trip), true, start);
        let mut pacer = Pacer::new(true);
        pacer.sent(6000, start);
        link.send(6000, true, start);
        // From when the text is through.
        let begin = link.free;
        let run = run(pacer, link, begin, 20);
        assert!(run.slowest_key <= Duration::from_millis(budget), "{rate}: {:?}", run.slowest_key);
        assert!(share(&run, rate) >= 0.6, "{:?}", run.sent);
    }
}

#[test]
fn keys_are_answered_in_time_on_a_middling_link() {
    let run = pictures(125_000.0, 100, true, 30);
    assert!(run.slowest_key <= Duration::from_millis(150), "{:?}", run.slowest_key);
    assert!(share(&run, 125_000.0) >= 0.6, "{}: {:?}", share(&run, 125_000.0), run.sent);
}

#[test]
fn other_links_are_used_and_keys_do_not_wait() {
    for (rate, round_trip) in [
        (12_500.0, 150),
        (125_000.0, 100),
        (12_500.0, 20),
        (30_000.0, 300),
        (60_000.0, 60),
        (250_000.0, 40),
        (1e6, 30),
        (1e6, 200),
        (1e7, 10),
        (1e7, 80),
    ] {
        let run = pictures(rate, round_trip, true, 20);
        // The smallest window may be more than what is meant to queue.
        let most = (LEAST_WINDOW as f64 / rate * 1e3).max(60.0) as u64 + round_trip + 40;
        let share = share(&run, rate.min(MOST_WINDOW as f64 * 1e3 / (round_trip + 15) as f64));
        assert!(run.slowest_key <= Duration::from_millis(most), "{rate} {round_trip}: {:?}", run.slowest_key);
        assert!(share >= 0.5, "{rate} {round_trip}: {share} {:?}", run.sent);
    }
}

#[test]
fn replies_that_are_now_and_then_late_do_not_starve_pictures() {
    for (rate, round_trip) in [(12_500.0, 150), (125_000.0, 100), (1e6, 40)] {
        let now = Instant::now();
        let mut link = Link::new(rate, Duration::from_millis(round_trip), true, now);
        link.jitter = MS * 20;
        let run = run(Pacer::new(true), link, now, 20);
        assert!(share(&run, rate) >= 0.5, "{rate} {round_trip}: {:?}", run.sent);
        let most = Duration::from_millis(round_trip) + MS * 150;
        assert!(run.slowest_key <= most, "{rate} {round_trip}: {:?}", run.slowest_key);
    }
}

#[test]
fn a_terminal_on_this_machine_is_not_held_back() {
    let run = pictures(20e6, 1, false, 4);
    assert!(share(&run, 20e6) >= 0.6, "{:?}", run.sent);
    assert!(run.slowest_key <= Duration::from_millis(60), "{:?}", run.slowest_key);
}

#[test]
fn a_mute_terminal_is_recognised() {
    let now = Instant::now();
    let link = Link::new(1e6, Duration::from_millis(100), false, now);
    let run = run(Pacer::new(true), link, now, 6);
    assert!(run.pacer.is_mute() && !run.pacer.asks(100_000));
    assert!(run.sent[0] <= LEAST_WINDOW, "careful until something is known: {:?}", run.sent);
    for &sent in &run.sent[3..] {
        assert!((60_000..=75_000).contains(&sent), "{:?}", run.sent);
    }
    let mut local = Pacer::new(false);
    local.sent(LOCAL_WINDOW, now);
    assert_eq!(local.allowance(now), 0);
    assert_eq!(local.allowance(now + Duration::from_mins(1)), usize::MAX);
}

#[test]
fn a_lost_reply_does_not_stall() {
    let start = Instant::now();
    let link = Link::new(50_000.0, Duration::from_millis(80), true, start);
    let mut first = run(Pacer::new(true), link, start, 3);
    let lost = first.link.replies.len();
    assert!(lost > 0);
    first.link.replies.clear();
    let second = run(first.pacer, first.link, first.now + MS, 8);
    assert!(!second.pacer.is_mute(), "one loss is no silence");
    assert!(second.sent[5..].iter().all(|&sent| sent > 30_000), "{:?}", second.sent);
}

#[test]
fn a_terminal_that_answers_late_is_heard() {
    let now = Instant::now();
    let mut pacer = Pacer::new(true);
    pacer.sent(1000, now);
    let late = now + Duration::from_secs(9);
    assert!(pacer.allowance(late) > 0 && pacer.is_mute());
    pacer.acked(late);
    assert!(!pacer.is_mute() && pacer.asks(1000));
}

#[test]
fn keys_are_not_asked_after() {
    let now = Instant::now();
    let mut pacer = Pacer::new(true);
    assert!(!pacer.asks(KEY_SIZED));
    pacer.sent(KEY_SIZED, now);
    assert_eq!((pacer.in_flight(), pacer.wake_at()), (0, None));
}

#[test]
fn a_picture_in_one_piece_must_fit() {
    let mut run = pictures(125_000.0, 100, true, 5);
    assert!(!run.pacer.fits_atomic(1, run.now), "others are on their way");
    for &at in &run.link.replies {
        run.pacer.acked(at);
    }
    let later = run.now + Duration::from_secs(1);
    assert!(
        run.pacer.fits_atomic(20_000, later) && !run.pacer.fits_atomic(60_000, later),
        "{:?}",
        run.pacer.rate()
    );
    assert!(!Pacer::new(true).fits_atomic(1, later), "nothing is known yet");
    assert!(Pacer::new(false).fits_atomic(1 << 30, later));
}

#[test]
fn text_waits_on_a_link_that_is_known_to_be_slow_and_nowhere_else() {
    let start = Instant::now();
    let at = |ms: u64| start + Duration::from_millis(ms);
    let known = |remote: bool, bytes_per_second: u64| {
        let mut pacer = Pacer::new(remote);
        assert_eq!(pacer.text_allowance(start), usize::MAX, "nothing is known yet");
        // Pieces of 1000 bytes that follow each other on a link with a round trip of 100 ms.
        for piece in 0..5 {
            pacer.sent(1000, at(piece));
        }
        for piece in 1..=5 {
            pacer.acked(at(100 + piece * 1000 * 1000 / bytes_per_second));
        }
        pacer
    };
    let mut slow = known(true, 12_500);
    let allowed = slow.text_allowance(at(600));
    assert!((512..1_000).contains(&allowed), "{allowed}");
    slow.sent(allowed, at(600));
    assert_eq!((slow.text_allowance(at(601)), slow.allowance(at(601))), (0, 0), "until that is through");
    let then = slow.wake_at().unwrap();
    assert!(then > at(620) && then < at(660), "{:?}", then.duration_since(start));
    assert!(slow.text_allowance(then) > 0 && slow.allowance(then) > 0);
    assert_eq!(known(true, 1_000_000).text_allowance(at(600)), usize::MAX);
    assert_eq!(known(false, 12_500).text_allowance(at(600)), usize::MAX);
}
