//! A lane on which the newest request wins, but work that is nearly done may finish.
//!
//! Keys repeat thirty times a second. If each cancelled the work of the one before, a tree that takes
//! 50 ms would never be seen while a key is held. So a request waits while the one before is young,
//! and cancels it when it has become old. Work that has to be cancelled time and again gets longer each
//! time: work that takes longer than the patience is seen as well while a key is held, only later.

use std::time::{Duration, Instant};

use super::Lane;

/// A lane, and the request that waits for it.
pub struct Relay<R> {
    lane: Lane<R>,
    running: Option<(u64, Instant)>,
    waiting: Option<R>,
    patience: Duration,
    /// How often in a row work was cancelled by a newer request.
    overtaken: u32,
}

/// How often patience is doubled at most: the newest request waits no longer than that.
const MOST_DOUBLED: u32 = 2;

impl<R: Send + 'static> Relay<R> {
    /// A relay that lets work finish that is younger than `patience`.
    pub fn new(lane: Lane<R>, patience: Duration) -> Self {
        Self { lane, running: None, waiting: None, patience, overtaken: 0 }
    }

    /// Hands in a request.
    pub fn want(&mut self, request: R, now: Instant) {
        self.waiting = Some(request);
        self.advance(now);
    }

    /// The lane said that it finished a request.
    pub fn finished(&mut self, number: u64, now: Instant) {
        if self.running.is_some_and(|(running, _)| running == number) {
            self.running = None;
            self.overtaken = 0;
        }
        self.advance(now);
    }

    /// Submits what waits, if it has waited long enough.
    pub fn advance(&mut self, now: Instant) {
        let is_free = self.running.is_none_or(|(_, since)| now >= since + self.patience());
        if is_free && let Some(request) = self.waiting.take() {
            self.overtaken += u32::from(self.running.is_some());
            self.running = Some((self.lane.submit(request), now));
        }
    }

    /// Drops whatever is under way or waiting.
    pub fn cancel(&mut self) {
        self.waiting = None;
        self.running = None;
        self.overtaken = 0;
        self.lane.cancel();
    }

    /// Whether an answer is to a request that was not cancelled.
    pub fn is_current(&self, number: u64) -> bool {
        self.running.is_some_and(|(running, _)| running == number)
    }

    /// When [`Relay::advance`] should be called though nothing was said.
    pub fn wake_at(&self) -> Option<Instant> {
        let (_, since) = self.running.filter(|_| self.waiting.is_some())?;
        Some(since + self.patience())
    }

    /// How old work may become that is waited for.
    fn patience(&self) -> Duration {
        self.patience * (1 << self.overtaken.min(MOST_DOUBLED))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use linden::Monitor;

    use super::super::{Answer, Done};
    use super::*;

    #[test]
    fn young_work_finishes_and_old_work_is_cancelled() {
        let (sender, answers) = mpsc::channel();
        let (go, gate) = mpsc::channel::<()>();
        let (entered, is_in) = mpsc::channel::<()>();
        let lane = Lane::start(
            "test",
            move |answer: Answer<&'static str>| drop(sender.send(answer)),
            move |request: &'static str, watcher, give| {
                if request == "slow" {
                    entered.send(()).unwrap();
                    while !watcher.is_cancelled() {
                        std::thread::yield_now();
                    }
                    return;
                }
                gate.recv().unwrap();
                give(request);
            },
        )
        .unwrap();
        let mut relay = Relay::new(lane, Duration::from_secs(1));
        let start = Instant::now();
        relay.want("a", start);
        relay.want("b", start + Duration::from_millis(1));
        relay.want("c", start + Duration::from_millis(2));
        assert_eq!(relay.wake_at(), Some(start + Duration::from_secs(1)));
        let mut values = Vec::new();
        go.send(()).unwrap();
        go.send(()).unwrap();
        while values.len() < 2 {
            let answer = answers.recv().unwrap();
            match answer.done {
                Done::Value(value) => values.push(value),
                Done::Finished => relay.finished(answer.number, start + Duration::from_millis(3)),
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(values, ["a", "c"], "the first finished, the second was overtaken while it waited");

        let answer = answers.recv().unwrap();
        relay.finished(answer.number, start);
        assert!(relay.running.is_none() && relay.wake_at().is_none());
        relay.want("slow", start);
        is_in.recv().unwrap();
        go.send(()).unwrap();
        relay.want("d", start + Duration::from_millis(900));
        relay.advance(start + Duration::from_millis(1001));
        let values: Vec<_> = answers.iter().map(|answer| answer.done).take(2).collect();
        assert!(matches!(values[..], [Done::Finished, Done::Value("d")]), "{values:?}");
    }

    #[test]
    fn work_that_takes_longer_than_the_patience_ends_while_a_key_is_held() {
        // Time is counted here: the worker only tells what it was given.
        let lane = Lane::start("test", |_: Answer<()>| {}, |(): (), _, _| {}).unwrap();
        let mut relay = Relay::new(lane, Duration::from_millis(250));
        let start = Instant::now();
        let mut began = Vec::new();
        let mut last = None;
        // A key each 33 ms; the work takes 600 ms.
        for key in 0..60 {
            let now = start + Duration::from_millis(33 * key);
            relay.want((), now);
            let running = relay.running;
            if running != last {
                began.extend(running.map(|(_, since)| since.duration_since(start).as_millis()));
                last = running;
            }
            if let Some((number, since)) = running
                && now >= since + Duration::from_millis(600)
            {
                relay.finished(number, now);
                assert_eq!(began.len(), 3, "the third may end: {began:?}");
                assert_eq!(relay.patience(), Duration::from_millis(250), "then it is as before");
                return;
            }
        }
        panic!("nothing was seen: {began:?}");
    }
}
