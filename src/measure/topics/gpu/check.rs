//! A check: a property, an oracle that shares no code with what is tested, and what was found.

use std::time::Instant;

use crate::render::picture::RenderError;

/// A hard case whose answer depends on the graphics adapter.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// As it is listed and chosen.
    pub name: &'static str,
    /// Its numbers in the catalogue of hard cases, or what else it is part of.
    pub case: &'static str,
    /// The property that holds.
    pub property: &'static str,
    /// The oracle that says so.
    pub oracle: &'static str,
    /// The unit that is counted: `pixels`, `pictures`.
    pub unit: &'static str,
    /// The number of them that are looked at at least; fewer say nothing, unless time ran out.
    pub least: u64,
    /// Looks.
    pub run: fn(&mut Findings) -> Result<(), RenderError>,
}

/// The findings of a check so far.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The number of answers that were compared with the oracle's.
    pub tried: u64,
    /// The number of them that are wrong.
    pub wrong: u64,
    /// The first that is wrong.
    pub first: Option<String>,
    /// How far the adapter moves corners of triangles at most, pixels ([`crate::gpu::Gpu::snapping`]).
    pub snapping: f64,
    /// Whether time ran out before everything was looked at.
    pub is_cut: bool,
    until: Instant,
}

impl Findings {
    /// None yet, of an adapter that moves corners by so much; the check is to end soon after `until`.
    pub fn new(until: Instant, snapping: f64) -> Self {
        Self { snapping, tried: 0, wrong: 0, first: None, is_cut: false, until }
    }

    /// Compares one answer; `message` says what is wrong with it.
    pub fn ask(&mut self, is_right: bool, message: impl FnOnce() -> String) {
        self.tried += 1;
        if !is_right {
            self.wrong += 1;
            self.first.get_or_insert_with(message);
        }
    }

    /// Whether there is time for another round; asked between rounds, not before the first.
    pub fn goes_on(&mut self) -> bool {
        self.is_cut |= Instant::now() >= self.until;
        !self.is_cut
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn the_first_that_is_wrong_is_told_and_all_are_counted() {
        let mut found = Findings::new(Instant::now() + Duration::from_secs(60), 0.0);
        for i in 0..5 {
            found.ask(i % 2 == 0, || i.to_string());
        }
        assert!(found.goes_on());
        assert_eq!((found.tried, found.wrong, found.first.as_deref(), found.is_cut), (5, 2, Some("1"), false));
        let mut late = Findings::new(Instant::now(), 0.0);
        assert!(!late.goes_on() && late.is_cut);
    }
}
