//! The time that a probe may take, and how its parts share it.

use std::time::{Duration, Instant};

/// Shares of the whole time by which each part is to be over: checks, pictures, frames. The rest is for writing.
const PARTS: [f64; 3] = [0.45, 0.65, 0.95];

/// A part of a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Hard cases.
    Checks,
    /// Pictures against their references.
    Pictures,
    /// Frames in turn.
    Frames,
}

/// The time since a probe began.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: Instant,
    limit: Duration,
}

impl Clock {
    /// Begins now.
    pub fn new(limit: Duration) -> Self {
        Self { start: Instant::now(), limit }
    }

    /// The time that the probe may take.
    pub fn limit(&self) -> Duration {
        self.limit
    }

    /// Since it began.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// When a part is to be over. What earlier parts leave is the later ones'.
    pub fn end(&self, part: Part) -> Instant {
        self.start + self.limit.mul_f64(PARTS[part as usize])
    }

    /// Whether there is time for more of a part.
    pub fn has_time(&self, part: Part) -> bool {
        Instant::now() < self.end(part)
    }

    /// When the next of `left` items of a part is to stop: twice its fair share, and never later than the part.
    pub fn turn(&self, part: Part, left: usize) -> Instant {
        let (now, end) = (Instant::now(), self.end(part));
        let share = end.saturating_duration_since(now).mul_f64((2.0 / left.max(1) as f64).min(1.0));
        now + share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_end_one_after_the_other_within_the_limit() {
        let clock = Clock::new(Duration::from_secs(600));
        let ends = [Part::Checks, Part::Pictures, Part::Frames].map(|part| clock.end(part));
        assert!(ends[0] < ends[1] && ends[1] < ends[2] && ends[2] < clock.start + clock.limit());
        assert!(clock.turn(Part::Checks, 1) <= ends[0] && clock.turn(Part::Checks, 10) < ends[0]);
        assert!(!Clock::new(Duration::ZERO).has_time(Part::Checks));
    }
}
