//! How many bytes of pictures may be on their way, so that a key's answer never waits long behind them.
//!
//! After each piece of a picture the terminal is asked for its status ([`QUERY`]). Its reply says that
//! the piece has been read, and how long that took. What it took beyond the shortest round trip was
//! spent in queues, where the next key's answer would wait too. So the window of bytes that may be
//! unanswered grows while queues are short and shrinks when they get long, as in LEDBAT (RFC 6817) and
//! TCP Vegas (Brakmo and Peterson 1995); growth is that of slow start only as long as the spacing of
//! replies shows a link that is much faster.
//!
//! A terminal that never answers is recognised. It gets no more queries, and a fixed rate.
//!
//! Time comes from the caller.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::system::ANSWERS;

/// Asks for the terminal's status (DSR 5, ECMA-48 8.3.35); the reply is
/// [`Reply::Status`](crate::input::Reply::Status).
pub const QUERY: &[u8] = b"\x1b[5n";

/// Fewer bytes are a key's answer: they are neither counted nor asked after.
pub const KEY_SIZED: usize = 256;

/// The smallest window: what a link of 12.5 kB/s takes in 0.12 s.
const LEAST_WINDOW: usize = 1536;
/// The largest.
const MOST_WINDOW: usize = 1 << 20;
/// What a terminal on this machine gets before its first reply.
const LOCAL_WINDOW: usize = 256 << 10;
/// The smallest piece worth a separate frame and query.
const LEAST_PIECE: usize = 512;
/// Time in queues below which the window grows.
const SHORT_QUEUE: Duration = Duration::from_millis(10);
/// Time in queues above which it shrinks.
const LONG_QUEUE: Duration = Duration::from_millis(25);
/// How long the first reply may take, beside what the bytes take on a link of [`SLOW`].
const PATIENCE: Duration = Duration::from_millis(1500);
/// Bytes a second of the slowest link that is thought of.
const SLOW: f64 = 8192.0;
/// What a terminal that does not answer gets: bytes a second, and at once.
const MUTE_RATE: f64 = 65536.0;
const MUTE_PIECE: usize = 8192;
const MEBIBYTE: f64 = 1_048_576.0;
/// Replies of one measurement of the rate.
const RUN: u32 = 4;
/// How long a key's answer may wait behind text.
const TEXT_QUEUE: Duration = Duration::from_millis(40);
/// Of the known rate of a slow link, what pieces are sent with: usually a little less, since the largest rate of
/// late is known, and at the beginning of each cycle of pieces more, to find a faster one. As BBR does it (Cardwell et al. 2016).
const SLOWER: f64 = 0.85;
const FASTER: f64 = 1.25;
const CYCLE: u32 = 16;
/// Bytes a second from which no text is worth a pause.
const FAST: f64 = 262_144.0;
/// How long the shortest round trip is believed: routes change.
const MEMORY: Duration = Duration::from_secs(30);
/// How long a picture that comes in one piece may take.
const ATOMIC: Duration = Duration::from_millis(250);
/// Unanswered pieces one after the other, after which a terminal that once answered counts as mute.
const LOST_LIMIT: u32 = 3;

/// Decides when pictures are sent.
#[derive(Clone, Debug)]
pub struct Pacer {
    remote: bool,
    window: usize,
    /// What was asked after and not answered, the oldest first.
    unanswered: VecDeque<Piece>,
    in_flight: usize,
    answers: Answers,
    lost: u32,
    /// Replies that may still come to questions that were given up.
    stale: usize,
    trip: Shortest,
    last_trip: Option<Duration>,
    /// What a mebibyte takes on the link.
    mebibyte: Shortest,
    /// Replies that make the next measurement of that.
    run: Option<Run>,
    /// The last few times in queues, of which the least counts: replies come now and then late.
    queued: [Duration; 3],
    /// Whether queues have never been seen yet.
    starting: bool,
    /// When the last reply came, while others were awaited.
    last_reply: Option<Instant>,
    /// The window is not moved down again before this is answered.
    reduced_at: Option<Instant>,
    /// When a mute terminal may get the next piece.
    next: Option<Instant>,
    /// When what was sent is through a link of the rate that is known.
    clear_at: Option<Instant>,
    /// Pieces that were sent at that rate.
    paced: u32,
}

/// Whether a terminal answers queries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answers {
    /// It was not asked yet, or has still time.
    Unknown,
    Yes,
    /// It gets no more queries.
    Never,
}

/// Replies that followed each other while the link was busy.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// When the reply before the first of them came.
    since: Instant,
    bytes: usize,
    replies: u32,
}

/// Bytes that were sent together.
#[derive(Clone, Copy, Debug)]
struct Piece {
    sent: Instant,
    bytes: usize,
}

/// The least of the last half minute to minute.
#[derive(Clone, Copy, Debug, Default)]
struct Shortest {
    before: Option<Duration>,
    now: Option<(Instant, Duration)>,
}

impl Shortest {
    fn add(&mut self, trip: Duration, now: Instant) {
        match &mut self.now {
            Some((since, least)) if now.duration_since(*since) < MEMORY => *least = trip.min(*least),
            slot => {
                self.before = slot.map(|(_, least)| least);
                *slot = Some((now, trip));
            }
        }
    }

    fn get(self) -> Option<Duration> {
        self.before.into_iter().chain(self.now.map(|(_, least)| least)).min()
    }
}

impl Pacer {
    /// For a terminal on another machine, or on this one.
    pub fn new(remote: bool) -> Self {
        Self {
            remote,
            window: if remote { LEAST_WINDOW } else { LOCAL_WINDOW },
            unanswered: VecDeque::new(),
            in_flight: 0,
            answers: if ANSWERS { Answers::Unknown } else { Answers::Never },
            lost: 0,
            stale: 0,
            trip: Shortest::default(),
            last_trip: None,
            mebibyte: Shortest::default(),
            run: None,
            queued: [Duration::MAX; 3],
            starting: true,
            last_reply: None,
            reduced_at: None,
            next: None,
            clear_at: None,
            paced: 0,
        }
    }

    /// How long the bytes that were sent still stand before a link that is known to be slow.
    fn backlog(&self, now: Instant) -> Duration {
        self.clear_at.map_or(Duration::ZERO, |at| at.saturating_duration_since(now))
    }

    /// The rate of a link that is known to be slow.
    fn slow_rate(&self) -> Option<f64> {
        // As long as no queue was ever seen, what was measured may be how fast pieces were sent.
        self.rate().filter(|rate| self.remote && !self.starting && !self.is_mute() && *rate < FAST)
    }

    /// How many bytes of pictures may be sent now in one piece: 0, or enough for a useful one.
    pub fn allowance(&mut self, now: Instant) -> usize {
        self.give_up(now);
        if self.is_mute() {
            return match self.next {
                _ if !self.remote => usize::MAX,
                Some(next) if next > now => 0,
                _ => MUTE_PIECE,
            };
        }
        // One after the other at the link's rate: a key's answer waits behind one piece, not behind a window.
        if self.slow_rate().is_some() && self.backlog(now) > Duration::ZERO {
            return 0;
        }
        // Many pieces are in flight, so that replies tell early, and the time that one takes by
        // itself is not taken for a queue.
        let piece = (self.window / 16).max(LEAST_PIECE);
        if self.window.saturating_sub(self.in_flight) < piece { 0 } else { piece }
    }

    /// How many bytes of text may be sent now beside what answers a key: as many as a link that is known to be
    /// slow takes in 40 ms; all where nothing of the kind is known. Nothing while other bytes stand
    /// before the link.
    pub fn text_allowance(&self, now: Instant) -> usize {
        match self.slow_rate() {
            None => usize::MAX,
            Some(_) if self.backlog(now) > Duration::ZERO => 0,
            Some(rate) => ((rate * TEXT_QUEUE.as_secs_f64()) as usize).max(LEAST_PIECE),
        }
    }

    /// Whether [`QUERY`] is to be appended to this number of bytes.
    pub fn asks(&self, bytes: usize) -> bool {
        !self.is_mute() && bytes > KEY_SIZED
    }

    /// So many bytes were sent, with [`QUERY`] if [`Pacer::asks`] said so.
    pub fn sent(&mut self, bytes: usize, now: Instant) {
        if bytes <= KEY_SIZED {
            return;
        }
        if self.is_mute() {
            let from = self.next.map_or(now, |next| next.max(now));
            self.next = Some(from + Duration::from_secs_f64(bytes as f64 / MUTE_RATE));
            return;
        }
        if let Some(rate) = self.slow_rate() {
            // Some pieces follow faster, enough for a measurement: else no link would ever be found to be faster.
            let gain = if self.paced % CYCLE <= RUN { FASTER } else { SLOWER };
            self.paced = self.paced.wrapping_add(1);
            let takes = Duration::from_secs_f64(bytes as f64 / (rate * gain));
            self.clear_at = Some(self.clear_at.map_or(now, |at| at.max(now)) + takes);
        }
        self.unanswered.push_back(Piece { sent: now, bytes });
        self.in_flight += bytes;
    }

    /// The terminal has answered.
    pub fn acked(&mut self, now: Instant) {
        let Some(&piece) = self.unanswered.front() else {
            // To a question that was given up: it does answer, only slowly.
            self.stale = self.stale.saturating_sub(1);
            (self.answers, self.lost, self.next) = (Answers::Yes, 0, None);
            return;
        };
        let trip = now.duration_since(piece.sent);
        let least = self.trip.get();
        if self.stale > 0 && least.is_some_and(|least| trip < least * 6 / 10) {
            self.stale -= 1;
            return;
        }
        self.unanswered.pop_front();
        self.in_flight -= piece.bytes;
        self.trip.add(trip, now);
        self.last_trip = Some(trip);
        (self.answers, self.lost) = (Answers::Yes, 0);
        self.measure(piece, now);
        self.steer(piece, trip, now);
        self.last_reply = (!self.unanswered.is_empty()).then_some(now);
    }

    /// The rate from the time of some replies, each to what was already on its way when the one before came: then
    /// the link was busy with their pieces, unless one was sent late, which makes the result too small. So the
    /// largest of late counts; and several replies, since two that come together only look fast.
    fn measure(&mut self, piece: Piece, now: Instant) {
        let Some(last) = self.last_reply.filter(|&last| piece.sent <= last) else {
            self.run = None;
            return;
        };
        let run = self.run.get_or_insert(Run { since: last, bytes: 0, replies: 0 });
        run.bytes += piece.bytes;
        run.replies += 1;
        if run.replies < RUN {
            return;
        }
        let (bytes, since) = (run.bytes, run.since);
        self.run = None;
        // Replies that come together say no more than "fast".
        let seconds = now.duration_since(since).as_secs_f64().max(0.001);
        self.mebibyte.add(Duration::from_secs_f64(MEBIBYTE / bytes as f64 * seconds), now);
    }

    fn steer(&mut self, piece: Piece, trip: Duration, now: Instant) {
        let least = self.trip.get().unwrap_or(trip);
        // What a piece takes by itself is no queue; the shortest trips have it for a small one.
        let rate = self.rate().unwrap_or(f64::INFINITY);
        let alone_s = piece.bytes.saturating_sub(LEAST_PIECE) as f64 / rate;
        let queued = trip.saturating_sub(least).saturating_sub(Duration::from_secs_f64(alone_s));
        self.queued.rotate_right(1);
        self.queued[0] = queued;
        let queued = self.queued.into_iter().min().unwrap_or(queued);
        self.starting &= queued < SHORT_QUEUE;
        if queued < SHORT_QUEUE {
            let full = rate * least.as_secs_f64();
            // A large text may have been more than the window: it proves nothing about pictures.
            let bytes = piece.bytes.min(self.window / 4);
            let growth = match self.window as f64 {
                window if self.starting && full.is_finite() && window * 2.0 < full => bytes,
                window if window < full * 0.8 => bytes / 4,
                _ => bytes / 8,
            };
            // Only a window that is used grows.
            if self.in_flight + piece.bytes + LEAST_PIECE >= self.window / 2 {
                self.window = (self.window + growth).min(MOST_WINDOW);
            }
        } else if queued > LONG_QUEUE && self.reduced_at.is_none_or(|at| piece.sent > at) {
            // To what was read in the shortest trip; once for all that is in flight.
            let share = (least + SHORT_QUEUE).as_secs_f64() / trip.as_secs_f64();
            self.window = ((self.window as f64 * share.max(0.5)) as usize).max(LEAST_WINDOW);
            self.reduced_at = Some(now);
        }
    }

    /// When questions that were not answered are given up.
    fn deadline(&self) -> Option<Instant> {
        let first = self.unanswered.front()?;
        let patience = self.trip.get().map_or(PATIENCE, |trip| (trip * 4).max(PATIENCE));
        Some(first.sent + patience + Duration::from_secs_f64(self.in_flight as f64 / SLOW))
    }

    fn give_up(&mut self, now: Instant) {
        if self.deadline().is_none_or(|deadline| deadline > now) {
            return;
        }
        self.stale += self.unanswered.len();
        self.unanswered.clear();
        self.in_flight = 0;
        self.last_reply = None;
        self.lost += 1;
        self.window = if self.remote { LEAST_WINDOW } else { self.window };
        if self.answers == Answers::Unknown || self.lost >= LOST_LIMIT {
            self.answers = Answers::Never;
        }
    }

    /// When an allowance may be more than now, without a reply.
    pub fn wake_at(&self) -> Option<Instant> {
        if self.is_mute() {
            return self.next;
        }
        let clear_at = self.slow_rate().and(self.clear_at);
        [clear_at, self.deadline()].into_iter().flatten().min()
    }

    /// The largest picture that may be sent in one piece now: what the link takes in a quarter of a
    /// second. 0 as long as other bytes are on their way or nothing is known of a remote link.
    pub fn atomic_allowance(&mut self, now: Instant) -> usize {
        self.give_up(now);
        if !self.remote || self.is_mute() {
            return usize::MAX;
        }
        match self.rate() {
            Some(rate) if self.unanswered.is_empty() => (rate * ATOMIC.as_secs_f64()) as usize,
            _ => 0,
        }
    }

    /// Whether a picture of `bytes` bytes may be sent in one piece now.
    pub fn fits_atomic(&mut self, bytes: usize, now: Instant) -> bool {
        bytes <= self.atomic_allowance(now)
    }

    /// Bytes that may be unanswered.
    pub const fn window(&self) -> usize {
        self.window
    }

    /// Bytes that are.
    pub const fn in_flight(&self) -> usize {
        self.in_flight
    }

    /// The last round trip, queues included.
    pub const fn round_trip(&self) -> Option<Duration> {
        self.last_trip
    }

    /// The shortest round trip of late.
    pub fn shortest_round_trip(&self) -> Option<Duration> {
        self.trip.get()
    }

    /// Bytes a second that the link takes, as far as that could be seen.
    pub fn rate(&self) -> Option<f64> {
        self.mebibyte.get().map(|time| MEBIBYTE / time.as_secs_f64())
    }

    /// Whether the terminal answers no queries.
    pub fn is_mute(&self) -> bool {
        self.answers == Answers::Never
    }
}

#[cfg(test)]
#[path = "pacing/tests.rs"]
mod tests;
